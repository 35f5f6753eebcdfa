// Variables and calls of OptiX 3 to 6 as programs of this folder use them: the description of a
// variable in a module (its bytes and its semantic), and the calls that a renderer serves.

#pragma once

struct TypeInfo {
    unsigned magic, bytes;
};

// A variable that is bound by its name, or by its semantic if it has one.
#define VARIABLE(type, name, semantic)                                                        \
    namespace rti_internal_typeinfo {                                                         \
    __device__ TypeInfo name = {0x00796152u, sizeof(type)};                                   \
    }                                                                                         \
    namespace rti_internal_semantic {                                                         \
    __device__ char name[] = #semantic;                                                       \
    }                                                                                         \
    __device__ type name;

// Buffers have no type of their own: each access gives the size of an element.
#define BUFFER(name) __device__ char name[1];

struct Ray {
    float3 origin, direction;
    unsigned type;
    float tmin, tmax;
};

template <class T>
__device__ T& element(char* buffer, unsigned dimensions, size_t i, size_t j = 0) {
    size_t found, none = 0;
    asm volatile("call (%0), _rt_buffer_get_64, (%1, %2, %3, %4, %5, %6, %7);"
                 : "=l"(found)
                 : "l"(buffer), "r"(dimensions), "r"((unsigned)sizeof(T)), "l"(i), "l"(j), "l"(none), "l"(none));
    return *(T*)found;
}

template <class T>
__device__ void trace(unsigned object, float3 o, float3 d, unsigned type, float tmin, float tmax, T& payload) {
    asm volatile("call _rt_trace_64, (%0, %1, %2, %3, %4, %5, %6, %7, %8, %9, %10, %11);"
                 :
                 : "r"(object), "f"(o.x), "f"(o.y), "f"(o.z), "f"(d.x), "f"(d.y), "f"(d.z), "r"(type),
                   "f"(tmin), "f"(tmax), "l"(&payload), "r"((unsigned)sizeof(T))
                 : "memory");
}

__device__ inline bool potential_intersection(float t) {
    int may;
    asm volatile("call (%0), _rt_potential_intersection, (%1);" : "=r"(may) : "f"(t));
    return may;
}

__device__ inline bool report_intersection(unsigned material) {
    int taken;
    asm volatile("call (%0), _rt_report_intersection, (%1);" : "=r"(taken) : "r"(material) : "memory");
    return taken;
}

__device__ inline void ignore_intersection() { asm volatile("call _rt_ignore_intersection, ();"); }

__device__ inline void terminate_ray() { asm volatile("call _rt_terminate_ray, ();"); }
