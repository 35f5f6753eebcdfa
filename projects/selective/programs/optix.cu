// The ray programs of the selective demo in the interface of OptiX 3 to 6, as the report's own
// projects have them. `scripts/ptx projects/selective/programs/optix.cu` makes optix.ptx.

#include "optix6.cuh"

VARIABLE(float3, eye, )
VARIABLE(float3, U, )
VARIABLE(float3, V, )
VARIABLE(float3, W, )
VARIABLE(float, fov, )
VARIABLE(unsigned, top_object, )
VARIABLE(int, Radiance, )
VARIABLE(int, Shadow, )

VARIABLE(float4, lightDirection, )
VARIABLE(float4, lightColor, )
VARIABLE(float4, clearColor, )
VARIABLE(int, samples, )
VARIABLE(int, maxDepth, )

VARIABLE(float4, diffuse, )
VARIABLE(float4, specular, )
VARIABLE(int, texCount, )
texture<float4, 2> tex0;

BUFFER(vertex_buffer)
BUFFER(index_buffer)
BUFFER(normal)
BUFFER(texCoord0)
BUFFER(output0)

struct Payload {
    float3 color;
    int depth;
};

VARIABLE(Ray, ray, rtCurrentRay)
VARIABLE(uint2, launch_index, rtLaunchIndex)
VARIABLE(uint2, launch_dim, rtLaunchDim)
VARIABLE(Payload, payload, rtPayload)
VARIABLE(float, t_hit, rtIntersectionDistance)
VARIABLE(float3, shading_normal, attribute shading_normal)
VARIABLE(float2, texCoord, attribute texCoord)

#define AMBIENT 0.3f
#define ALPHA_THRESHOLD 0.25f
#define EPSILON 1e-4f
#define FAR 1e27f

__device__ inline float3 operator+(float3 a, float3 b) { return make_float3(a.x + b.x, a.y + b.y, a.z + b.z); }
__device__ inline float3 operator-(float3 a, float3 b) { return make_float3(a.x - b.x, a.y - b.y, a.z - b.z); }
__device__ inline float3 operator*(float s, float3 a) { return make_float3(s * a.x, s * a.y, s * a.z); }
__device__ inline float3 operator*(float3 a, float3 b) { return make_float3(a.x * b.x, a.y * b.y, a.z * b.z); }
__device__ inline float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
__device__ inline float3 cross(float3 a, float3 b) {
    return make_float3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
__device__ inline float3 normalize(float3 a) { return rsqrtf(dot(a, a)) * a; }
__device__ inline float3 xyz(float4 a) { return make_float3(a.x, a.y, a.z); }

// PCG, a hash of one word: Jarzynski and Olano, "Hash Functions for GPU Rendering" (2020).
__device__ inline unsigned pcg(unsigned v) {
    unsigned state = v * 747796405u + 2891336453u;
    unsigned word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

__device__ inline float uniform(unsigned& state) {
    state = pcg(state);
    return (state >> 8) * (1.0f / 16777216.0f);
}

// Ray generation: one ray a sample, jittered inside its cell of a grid over the pixel.
extern "C" __global__ void pinhole_camera() {
    unsigned state = pcg(launch_index.x + pcg(launch_index.y));
    int side = (int)(sqrtf((float)samples) + 0.5f);
    side = side * side == samples ? side : 1;
    float3 sum = make_float3(0, 0, 0);
    for (int i = 0; i < samples; ++i) {
        float dx = samples > 1 ? (i % side + uniform(state)) / side : 0.5f;
        float dy = samples > 1 ? (i / side % side + uniform(state)) / side : 0.5f;
        float x = (launch_index.x + dx) / launch_dim.x * 2 - 1;
        float y = (launch_index.y + dy) / launch_dim.y * 2 - 1;
        float aspect = (float)launch_dim.x / launch_dim.y;
        Payload sent;
        sent.color = make_float3(0, 0, 0);
        sent.depth = 1;
        float3 towards = normalize(W + (x * fov * aspect) * U + (y * fov) * V);
        trace(top_object, eye, towards, Radiance, EPSILON, FAR, sent);
        sum = sum + sent.color;
    }
    sum = (1.0f / samples) * sum;
    element<float4>(output0, 2, launch_index.x, launch_index.y) = make_float4(sum.x, sum.y, sum.z, 1);
}

__device__ inline float3 facing() {
    float3 n = shading_normal;
    return dot(n, ray.direction) > 0 ? -1.0f * n : n;
}

__device__ inline float4 texel() {
    return texCount ? tex2D(tex0, texCoord.x, texCoord.y) : make_float4(1, 1, 1, 1);
}

// Paths longer than the greatest depth return 0; shadow rays are traced at any depth.
__device__ inline float3 sent_from_here(int type, float3 direction) {
    Payload sent;
    sent.color = make_float3(0, 0, 0);
    sent.depth = payload.depth + 1;
    float3 here = ray.origin + t_hit * ray.direction;
    if (type == Shadow || sent.depth <= maxDepth)
        trace(top_object, here, direction, type, 10 * EPSILON, FAR, sent);
    return sent.color;
}

// Closest hit: diffuse with a shadow ray, and the texture of unit 0.
extern "C" __global__ void shade() {
    float3 to_light = normalize(-1.0f * xyz(lightDirection));
    float cosine = fmaxf(dot(facing(), to_light), 0.0f);
    float seen = cosine > 0 ? sent_from_here(Shadow, to_light).x : 0.0f;
    float3 base = xyz(diffuse) * xyz(texel());
    float3 ambient = make_float3(AMBIENT, AMBIENT, AMBIENT);
    payload.color = base * ((cosine * seen) * xyz(lightColor) + ambient);
}

// Closest hit: the specular colour times the reflection, over a dark interior.
extern "C" __global__ void glass() {
    float3 n = facing();
    float3 mirrored = ray.direction - (2 * dot(ray.direction, n)) * n;
    payload.color = xyz(diffuse) + xyz(specular) * sent_from_here(Radiance, mirrored);
}

// Any hit: holes of the texture let rays through.
extern "C" __global__ void alpha_test() {
    if (texel().w <= ALPHA_THRESHOLD)
        ignore_intersection();
}

// Miss: the clear colour; for shadow rays, light.
extern "C" __global__ void sky() { payload.color = xyz(clearColor); }

extern "C" __global__ void unoccluded() { payload.color = make_float3(1, 1, 1); }

// Any hit of shadow rays: the first hit is enough.
extern "C" __global__ void occluded() { terminate_ray(); }

// Exception: the colour of a failed pixel.
extern "C" __global__ void exception() {
    element<float4>(output0, 2, launch_index.x, launch_index.y) = make_float4(1, 0, 1, 1);
}

__device__ inline float3 corner(char* buffer, int i) {
    return xyz(element<float4>(buffer, 1, element<unsigned>(index_buffer, 1, i)));
}

__device__ inline float3 between(char* buffer, int first, float beta, float gamma) {
    return (1 - beta - gamma) * corner(buffer, first) + beta * corner(buffer, first + 1) +
           gamma * corner(buffer, first + 2);
}

// Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (1997).
extern "C" __global__ void intersect(int primitive) {
    int first = 3 * primitive;
    float3 a = corner(vertex_buffer, first);
    float3 e1 = corner(vertex_buffer, first + 1) - a, e2 = corner(vertex_buffer, first + 2) - a;
    float3 p = cross(ray.direction, e2);
    float determinant = dot(e1, p);
    float3 s = ray.origin - a;
    float3 q = cross(s, e1);
    float beta = dot(s, p) / determinant, gamma = dot(ray.direction, q) / determinant;
    float t = dot(e2, q) / determinant;
    if (beta >= 0 && gamma >= 0 && beta + gamma <= 1 && potential_intersection(t)) {
        float3 n = between(normal, first, beta, gamma);
        shading_normal = normalize(dot(n, n) > 0 ? n : cross(e1, e2));
        float3 at = between(texCoord0, first, beta, gamma);
        texCoord = make_float2(at.x, at.y);
        report_intersection(0);
    }
}

extern "C" __global__ void bounds(int primitive, float* box) {
    float3 a = corner(vertex_buffer, 3 * primitive);
    float3 b = corner(vertex_buffer, 3 * primitive + 1), c = corner(vertex_buffer, 3 * primitive + 2);
    box[0] = fminf(fminf(a.x, b.x), c.x);
    box[1] = fminf(fminf(a.y, b.y), c.y);
    box[2] = fminf(fminf(a.z, b.z), c.z);
    box[3] = fmaxf(fmaxf(a.x, b.x), c.x);
    box[4] = fmaxf(fmaxf(a.y, b.y), c.y);
    box[5] = fmaxf(fmaxf(a.z, b.z), c.z);
}
