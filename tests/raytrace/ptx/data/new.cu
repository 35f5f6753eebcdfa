// Programs in the interface of OptiX 7 and 8 for test_optix7.py.
// scripts/ptx -rdc=true tests/raytrace/ptx/data/new.cu makes new.ptx.

typedef unsigned long long u64;

struct Params {
    float4* out;
    u64 handle;
};

extern "C" __constant__ Params optixLaunchParams;

#define ASK(type, constraint, name)                                         \
    __device__ inline type name() {                                         \
        type found;                                                         \
        asm volatile("call (%0), _optix_" #name ", ();" : constraint(found)); \
        return found;                                                       \
    }

ASK(unsigned, "=r", get_launch_index_x)
ASK(unsigned, "=r", get_hit_kind)
ASK(unsigned, "=r", read_primitive_idx)
ASK(unsigned, "=r", read_sbt_gas_idx)
ASK(unsigned, "=r", get_exception_code)
ASK(unsigned, "=r", get_exception_detail_1)
ASK(unsigned, "=r", get_remaining_trace_depth)
ASK(unsigned, "=r", get_attribute_0)
ASK(unsigned, "=r", get_attribute_1)
ASK(unsigned, "=r", read_instance_id)
ASK(unsigned, "=r", read_instance_idx)
ASK(unsigned, "=r", get_transform_list_size)
ASK(float, "=f", get_ray_tmax)

__device__ inline float4& out() { return optixLaunchParams.out[get_launch_index_x()]; }

__device__ inline unsigned payload(unsigned index) {
    unsigned found;
    asm volatile("call (%0), _optix_get_payload, (%1);" : "=r"(found) : "r"(index));
    return found;
}

__device__ inline void set_payload(unsigned index, unsigned value) {
    asm volatile("call _optix_set_payload, (%0, %1);" : : "r"(index), "r"(value));
}

// A ray from (x, y, 3) along -z with words 0, 9 and 31 of a payload of 32.
__device__ inline void trace(float x, float y, unsigned& p0, unsigned& p9, unsigned& p31) {
    unsigned q0, q9, q31, other;
    asm volatile(
        "call (%0,%3,%3,%3,%3,%3,%3,%3,%3,%1,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%3,%2),"
        "_optix_trace_typed_32,"
        "(%4,%5,%6,%7,%8,%9,%9,%10,%9,%11,%9,%12,%4,%4,%13,%4,%14,"
        "%15,%4,%4,%4,%4,%4,%4,%4,%4,%16,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%4,%17);"
        : "=r"(q0), "=r"(q9), "=r"(q31), "=r"(other)
        : "r"(0), "l"(optixLaunchParams.handle), "f"(x), "f"(y), "f"(3.0f), "f"(0.0f), "f"(-1.0f),
          "f"(1e20f), "r"(255), "r"(1), "r"(32), "r"(p0), "r"(p9), "r"(p31));
    p0 = q0, p9 = q9, p31 = q31;
}

// One ray a launch index, at x = index / 16 - 1, y = 0.25.
extern "C" __global__ void __raygen__typed() {
    unsigned a = 100, b = 200, c = 300;
    trace(get_launch_index_x() / 16.0f - 1, 0.25f, a, b, c);
    out() = make_float4(a, b, c, get_remaining_trace_depth());
}

extern "C" __global__ void __closesthit__typed() {
    set_payload(0, payload(0) + get_hit_kind());
    set_payload(9, payload(9) + read_primitive_idx() + 16 * read_instance_idx() + 256 * get_transform_list_size());
    set_payload(31, payload(31) + get_remaining_trace_depth() + read_instance_id());
}

extern "C" __global__ void __miss__typed() { set_payload(0, 7); }

// The corners of the triangle that was hit: their sum, and the weighted point's distance from the ray.
extern "C" __global__ void __closesthit__corners() {
    float v[9], u, w;
    asm volatile("call (%0,%1,%2,%3,%4,%5,%6,%7,%8), _optix_get_triangle_vertex_data, (%9, %10, %11, %12);"
                 : "=f"(v[0]), "=f"(v[1]), "=f"(v[2]), "=f"(v[3]), "=f"(v[4]), "=f"(v[5]), "=f"(v[6]),
                   "=f"(v[7]), "=f"(v[8])
                 : "l"(optixLaunchParams.handle), "r"(read_primitive_idx()), "r"(read_sbt_gas_idx()), "f"(0.0f));
    asm volatile("call (%0, %1), _optix_get_triangle_barycentrics, ();" : "=f"(u), "=f"(w));
    float x = (1 - u - w) * v[0] + u * v[3] + w * v[6], y = (1 - u - w) * v[1] + u * v[4] + w * v[7];
    set_payload(0, __float_as_uint(x));
    set_payload(9, __float_as_uint(y));
    set_payload(31, get_attribute_0() == __float_as_uint(u) && get_attribute_1() == __float_as_uint(w));
}

extern "C" __global__ void __raygen__corners() {
    unsigned a = 0, b = 0, c = 0;
    trace(get_launch_index_x() / 16.0f - 1, 0.25f, a, b, c);
    out() = make_float4(__uint_as_float(a), __uint_as_float(b), c, 0);
}

// Exceptions: thrown by a hit, caught with code and detail; what follows the trace does not run.
extern "C" __global__ void __closesthit__throws() {
    asm volatile("call _optix_throw_exception_2, (%0, %1, %2);"
                 :
                 : "r"(42), "r"(1), "r"(1000 + read_primitive_idx()));
    set_payload(0, 5);
}

extern "C" __global__ void __exception__caught() {
    out() = make_float4(-1, get_exception_code(), get_exception_detail_1(), 0);
}

// Callable programs: 0 adds, 1 multiplies; an index that there is not is an exception.
extern "C" __device__ float __direct_callable__add(float a, float b) { return a + b; }
extern "C" __device__ float __continuation_callable__times(float a, float b) { return a * b; }

typedef float (*Called)(float, float);

__device__ inline float direct(unsigned index, float a, float b) {
    u64 place;
    asm volatile("call (%0), _optix_call_direct_callable, (%1);" : "=l"(place) : "r"(index));
    return ((Called)place)(a, b);
}

__device__ inline float continuation(unsigned index, float a, float b) {
    u64 place;
    asm volatile("call (%0), _optix_call_continuation_callable, (%1);" : "=l"(place) : "r"(index));
    return ((Called)place)(a, b);
}

extern "C" __global__ void __raygen__calls() {
    unsigned x = get_launch_index_x();
    out() = make_float4(direct(0, x, 3), continuation(1, x, 0.5f), 0, 0);
}

extern "C" __global__ void __raygen__calls_nothing() {
    out() = make_float4(1, 0, 0, 0);
    out() = make_float4(direct(2 + get_launch_index_x(), 0, 0), 0, 0, 0);
}

// An intersection program: a unit square of side 2 at z = 0, told in three attributes.
extern "C" __global__ void __intersection__square() {
    float o[3], d[3];
    asm volatile("call (%0), _optix_get_object_ray_origin_x, ();" : "=f"(o[0]));
    asm volatile("call (%0), _optix_get_object_ray_origin_y, ();" : "=f"(o[1]));
    asm volatile("call (%0), _optix_get_object_ray_origin_z, ();" : "=f"(o[2]));
    asm volatile("call (%0), _optix_get_object_ray_direction_z, ();" : "=f"(d[2]));
    float t = -o[2] / d[2];
    int taken;
    asm volatile("call (%0), _optix_report_intersection_3, (%1, %2, %3, %4, %5);"
                 : "=r"(taken)
                 : "f"(t), "r"(9), "r"(__float_as_uint(o[0])), "r"(11), "r"(read_primitive_idx()));
    asm volatile("call (%0), _optix_report_intersection_1, (%1, %2, %3);"
                 : "=r"(taken)
                 : "f"(t + 1), "r"(3), "r"(0));  // farther: taken where the first one is not
}

extern "C" __global__ void __anyhit__left() {
    if (__uint_as_float(get_attribute_0()) > 0)
        asm volatile("call _optix_ignore_intersection, ();");
}

extern "C" __global__ void __closesthit__square() {
    unsigned kind;
    asm volatile("call (%0), _optix_get_primitive_type_from_hit_kind, (%1);" : "=r"(kind) : "r"(get_hit_kind()));
    set_payload(0, get_attribute_0());
    set_payload(9, get_hit_kind() + 100 * get_attribute_1());
    set_payload(31, kind == 0x2500 && get_ray_tmax() == 3);
}

extern "C" __global__ void box(int primitive, float* to) {
    to[0] = to[1] = -1, to[2] = -0.001f, to[3] = to[4] = 1, to[5] = 0.001f;
}
