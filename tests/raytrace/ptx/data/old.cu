// Programs in the interface of OptiX 3 to 6 for tests/raytrace/ptx/host/test_optix_environment.py.
// scripts/ptx tests/raytrace/ptx/data/old.cu makes old.ptx.

#include "../../../../projects/selective/programs/optix6.cuh"

VARIABLE(float3, eye, )
VARIABLE(float3, U, )
VARIABLE(float3, V, )
VARIABLE(float3, W, )
VARIABLE(float, fov, )
VARIABLE(unsigned, top_object, )
VARIABLE(int, First, )
VARIABLE(int, Second, )
VARIABLE(float4, diffuse, )
texture<float4, 2> pixels;

BUFFER(vertex_buffer)
BUFFER(index_buffer)
BUFFER(output0)
BUFFER(extra)
BUFFER(numbers)

VARIABLE(Ray, ray, rtCurrentRay)
VARIABLE(uint2, launch_index, rtLaunchIndex)
VARIABLE(uint2, launch_dim, rtLaunchDim)
VARIABLE(float4, payload, rtPayload)
VARIABLE(float, t_hit, rtIntersectionDistance)
VARIABLE(float4, told, attribute told)

__device__ inline float4& pixel() { return element<float4>(output0, 2, launch_index.x, launch_index.y); }

__device__ inline float4 look(int type, float4 start) {
    float x = ((launch_index.x + 0.5f) / launch_dim.x * 2 - 1) * fov * launch_dim.x / launch_dim.y;
    float y = ((launch_index.y + 0.5f) / launch_dim.y * 2 - 1) * fov;
    float3 d = make_float3(W.x + x * U.x + y * V.x, W.y + x * U.y + y * V.y, W.z + x * U.z + y * V.z);
    float4 sent = start;
    trace(top_object, eye, d, type, 0.0f, 1e27f, sent);
    return sent;
}

extern "C" __global__ void camera() { pixel() = look(First, make_float4(0, 0, 0, 0)); }

// The second ray type counts hits by its any-hit program, which ignores them.
extern "C" __global__ void counter() { pixel() = look(Second, make_float4(0, 0, 0, 0)); }

extern "C" __global__ void count() {
    payload.x += 1;
    payload.y += t_hit;
    ignore_intersection();
}

extern "C" __global__ void distance() { payload = make_float4(t_hit, told.x, told.y, ray.tmax - t_hit); }

extern "C" __global__ void colour() { payload = make_float4(diffuse.x, diffuse.y, diffuse.z, 1); }

extern "C" __global__ void nothing() { payload.w = -1; }

// Sends its own ray again from a little before the hit, without end.
extern "C" __global__ void again() {
    float4 sent = payload;
    trace(top_object, ray.origin, ray.direction, First, 0.0f, 1e27f, sent);
    payload = make_float4(9, 9, 9, 9);
}

extern "C" __global__ void throws() {
    float4 seen = make_float4(launch_index.x, launch_index.y, launch_dim.x, launch_dim.y);
    if (launch_index.x % 2)
        asm volatile("call _rt_throw, (%0);" : : "r"(1024 + launch_index.y));
    pixel() = seen;
}

extern "C" __global__ void beyond() {
    pixel() = make_float4(1, 1, 1, 1);
    element<float4>(output0, 2, launch_index.x + 1, launch_index.y) = make_float4(2, 2, 2, 2);
}

extern "C" __global__ void exception() {
    unsigned code;
    asm volatile("call (%0), _rt_get_exception_code, ();" : "=r"(code));
    pixel() = make_float4(-1, code, 0, 0);
}

// Reads a texture by texels and a buffer of the same one, and writes a second output.
extern "C" __global__ void copies() {
    float4 seen = tex2D(pixels, launch_index.x, launch_index.y);
    float4 held = element<float4>(numbers, 2, launch_index.x, launch_index.y);
    size_t w, h, d, none;
    asm volatile("call (%0, %1, %2, %3), _rt_buffer_get_size_64, (%4, %5, %6);"
                 : "=l"(w), "=l"(h), "=l"(d), "=l"(none)
                 : "l"((char*)output0), "r"(2), "r"(16));
    pixel() = make_float4(seen.x, held.x, w, h);
    element<float4>(extra, 2, launch_index.x, launch_index.y) = make_float4(seen.y, 0.25f, 0.5f, 1);
}

extern "C" __global__ void prints() {
    if (launch_index.x == 3 && launch_index.y < 2)
        printf("at %u %u: %5.2f %s 100%% %lld\n", launch_index.x, launch_index.y, 1.5f, "text",
               -(1ll << 40));
    pixel() = make_float4(0, 0, 0, 0);
}

__device__ inline float4 corner(int i) {
    return element<float4>(vertex_buffer, 1, element<unsigned>(index_buffer, 1, i));
}

// A sphere of radius 0.5 around the first corner; both of its hits are reported, the far one first.
extern "C" __global__ void sphere(int primitive) {
    float4 c = corner(3 * primitive);
    float3 o = make_float3(ray.origin.x - c.x, ray.origin.y - c.y, ray.origin.z - c.z);
    float3 d = ray.direction;
    float a = d.x * d.x + d.y * d.y + d.z * d.z, b = o.x * d.x + o.y * d.y + o.z * d.z;
    float rest = b * b - a * (o.x * o.x + o.y * o.y + o.z * o.z - 0.25f);
    if (rest < 0)
        return;
    float root = sqrtf(rest);
    for (int side = 1; side >= -1; side -= 2) {
        float t = (-b + side * root) / a;
        if (potential_intersection(t)) {
            told = make_float4(primitive, side, 0, 0);
            report_intersection(0);
        }
    }
}

extern "C" __global__ void box(int primitive, float* out) {
    float4 c = corner(3 * primitive);
    out[0] = c.x - 0.5f, out[1] = c.y - 0.5f, out[2] = c.z - 0.5f;
    out[3] = c.x + 0.5f, out[4] = c.y + 0.5f, out[5] = c.z + 0.5f;
}
