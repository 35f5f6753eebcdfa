// Ordinary arithmetic as nvcc compiles it, one kernel an expression, for test_gpu.py.
// Made by   nvcc -arch=compute_75 --ptx instructions.cu   (CUDA 13.0); with -DGPU it runs on a card,
// where on_gpu.py left h200.npz.

#include <cuda_fp16.h>

struct P { const float* a; const float* b; float* out; const int* ia; const int* ib; int* io; const double* da; double* dout; const long long* la; long long* lo; };
extern "C" __constant__ P optixLaunchParams;
#ifdef GPU
__device__ unsigned idx() { return blockIdx.x * blockDim.x + threadIdx.x; }
#else
__device__ unsigned idx() { unsigned x; asm volatile("call (%0), _optix_get_launch_index_x, ();" : "=r"(x)); return x; }
#endif
#define F1(name, expr) extern "C" __global__ void f_##name() { unsigned i = idx(); float x = optixLaunchParams.a[i], y = optixLaunchParams.b[i]; optixLaunchParams.out[i] = expr; }
F1(sin, sinf(x)) F1(cos, cosf(x)) F1(tan, tanf(x)) F1(asin, asinf(x)) F1(acos, acosf(x))
F1(atan, atanf(x)) F1(atan2, atan2f(x,y))
F1(exp, expf(x)) F1(exp2, exp2f(x)) F1(log, logf(x)) F1(log2, log2f(x)) F1(log10, log10f(x))
F1(pow, powf(fabsf(x),y)) F1(sqrt, sqrtf(x)) F1(rsqrt, rsqrtf(x)) F1(cbrt, cbrtf(x))
F1(sinh, sinhf(x)) F1(cosh, coshf(x)) F1(tanh, tanhf(x)) F1(erf, erff(x)) F1(fmod, fmodf(x,y))
F1(floor, floorf(x)) F1(ceil, ceilf(x)) F1(round, roundf(x)) F1(rint, rintf(x)) F1(trunc, truncf(x))
F1(min, fminf(x,y)) F1(max, fmaxf(x,y)) F1(abs, fabsf(x)) F1(copysign, copysignf(x,y))
F1(hypot, hypotf(x,y)) F1(div, x/y) F1(rcp, 1.0f/x) F1(fma, fmaf(x,y,x)) F1(sat, __saturatef(x))
F1(frac, x - floorf(x)) F1(ldexp, ldexpf(x, 3)) F1(isnan, isnan(x) ? 1.0f : isinf(y) ? 2.0f : 3.0f)
F1(fdim, fdimf(x,y)) F1(expm1, expm1f(x)) F1(log1p, log1pf(x)) F1(lgamma, lgammaf(fabsf(x)+0.5f))
F1(tgamma, tgammaf(fabsf(x)+0.5f)) F1(nextafter, nextafterf(x,y)) F1(remainder, remainderf(x,y))
F1(sincos, ({float s,c; sincosf(x,&s,&c); s*2+c;}))
F1(rn, __fadd_rn(x,y)+__fmul_rn(x,y)) F1(rz, __fadd_rz(x,y)) F1(ru, __fmul_ru(x,y))
F1(rd, __fdiv_rd(x,y)) F1(half, __half2float(__float2half(x)))
#define I1(name, expr) extern "C" __global__ void i_##name() { unsigned i = idx(); int x = optixLaunchParams.ia[i], y = optixLaunchParams.ib[i]; optixLaunchParams.io[i] = expr; }
I1(add, x+y) I1(sub, x-y) I1(mul, x*y) I1(div, y ? x/y : 0) I1(mod, y ? x%y : 0)
I1(udiv, y ? (int)((unsigned)x/(unsigned)y) : 0) I1(umod, y ? (int)((unsigned)x%(unsigned)y) : 0)
I1(shl, x << (y&31)) I1(shr, x >> (y&31)) I1(ushr, (int)((unsigned)x >> (y&31))) I1(and, x&y)
I1(or, x|y) I1(xor, x^y) I1(not, ~x) I1(neg, -x)
I1(lop, (x & y) | (~x & (y ^ 0x55aa55aa))) I1(popc, __popc(x)) I1(clz, __clz(x)) I1(ffs, __ffs(x))
I1(brev, (int)__brev(x)) I1(mulhi, __mulhi(x,y)) I1(umulhi, (int)__umulhi(x,y))
I1(perm, (int)__byte_perm(x,y,0x5410)) I1(fsl, (int)__funnelshift_l(x,y,7))
I1(fsr, (int)__funnelshift_r(x,y,9)) I1(fslc, (int)__funnelshift_lc(x,y,40)) I1(min, min(x,y))
I1(max, max(x,y)) I1(umin, (int)min((unsigned)x,(unsigned)y)) I1(abs, abs(x))
I1(sad, (int)__sad(x,y,3)) I1(hadd, __hadd(x,y)) I1(dp4a, __dp4a(x,y,5))
I1(f2i, __float2int_rz(__int_as_float(x))) I1(i2f, __float_as_int(__int2float_rn(x)) )
I1(f2ir, __float2int_rn(x*0.37f)) I1(sel, x > y ? x : y*3) I1(short, (short)x * (char)y)
I1(ushort, (unsigned short)x + (unsigned char)y) I1(bfe, (x >> 5) & 0x3ff)
I1(bfi, (x & ~0xff0) | ((y & 0xff) << 4)) I1(rot, (x << 13) | ((unsigned)x >> 19))
I1(mul24, __mul24(x,y))
extern "C" __global__ void i_switch() { unsigned i = idx(); int x = optixLaunchParams.ia[i]; int r; switch (x & 15) { case 0: r = 11; break; case 1: r = x * 3; break; case 2: r = x ^ 77; break; case 3: r = 5; break; case 4: r = x + 9; break; case 5: r = -x; break; case 6: r = 123; break; case 7: r = x >> 3; break; case 8: r = 8; break; default: r = 99; } optixLaunchParams.io[i] = r; }
extern "C" __global__ void i_local() { unsigned i = idx(); int x = optixLaunchParams.ia[i]; int t[16]; for (int k = 0; k < 16; ++k) t[k] = x * k + (k ^ x); optixLaunchParams.io[i] = t[x & 15] + t[(x >> 4) & 15]; }
__constant__ int table[8] = {3, 1, 4, 1, 5, 9, 2, 6};
__device__ float4 quad[2] = {{1,2,3,4},{5,6,7,8}};
extern "C" __global__ void i_table() { unsigned i = idx(); int x = optixLaunchParams.ia[i]; float4 q = quad[x & 1]; optixLaunchParams.io[i] = table[x & 7] + (int)(q.x + q.w); }
__device__ __noinline__ int rec(int n) { return n <= 1 ? 1 : (n * rec(n - 1)) ^ n; }
extern "C" __global__ void i_rec() { unsigned i = idx(); optixLaunchParams.io[i] = rec(optixLaunchParams.ia[i] & 15); }
__device__ __noinline__ int fa(int x) { return x + 1; }
__device__ __noinline__ int fb(int x) { return x * 7; }
typedef int (*Fn)(int);
__device__ Fn fns[2] = {fa, fb};
extern "C" __global__ void i_indirect() { unsigned i = idx(); int x = optixLaunchParams.ia[i]; optixLaunchParams.io[i] = fns[x & 1](x); }
struct Big { int a[5]; float f; };
__device__ __noinline__ Big make(int x) { Big b; for (int k = 0; k < 5; ++k) b.a[k] = x + k; b.f = x * 0.5f; return b; }
extern "C" __global__ void i_struct() { unsigned i = idx(); Big b = make(optixLaunchParams.ia[i]); optixLaunchParams.io[i] = b.a[0] ^ b.a[4] ^ (int)b.f; }
extern "C" __global__ void i_while() { unsigned i = idx(); unsigned x = optixLaunchParams.ia[i] & 0xffff; int n = 0; while (x > 1 && n < 500) { x = x & 1 ? 3 * x + 1 : x / 2; ++n; } optixLaunchParams.io[i] = n; }
extern "C" __global__ void i_atomic() { unsigned i = idx(); atomicAdd(&optixLaunchParams.io[i], optixLaunchParams.ia[i]); atomicMax(&optixLaunchParams.io[i], 5); atomicXor(&optixLaunchParams.io[i], 3); atomicCAS(&optixLaunchParams.io[i], 6, 9); atomicExch(&optixLaunchParams.io[i], optixLaunchParams.io[i] + 1); }
#define D1(name, expr) extern "C" __global__ void d_##name() { unsigned i = idx(); double x = optixLaunchParams.da[i]; optixLaunchParams.dout[i] = expr; }
D1(sin, sin(x)) D1(exp, exp(x*0.1)) D1(log, log(fabs(x)+1)) D1(sqrt, sqrt(fabs(x)))
D1(div, 1.0/(x+3.3)) D1(pow, pow(fabs(x)+0.1, 1.7)) D1(floor, floor(x))
D1(cvt, (double)(float)x + (int)x) D1(fma, fma(x,x,1.0)) D1(atan, atan(x))
D1(rsqrt, rsqrt(fabs(x)+1)) D1(rint, rint(x))
#define L1(name, expr) extern "C" __global__ void l_##name() { unsigned i = idx(); long long x = optixLaunchParams.la[i]; optixLaunchParams.lo[i] = expr; }
L1(mul, x*x) L1(div, x/7) L1(mod, x%1000003) L1(udiv, (long long)((unsigned long long)x/13))
L1(shl, x << 11) L1(shr, x >> 9) L1(hi, __mul64hi(x, x*3)) L1(popc, __popcll(x)) L1(clz, __clzll(x))
L1(ffs, __ffsll(x)) L1(brev, (long long)__brevll(x))
L1(cvt, (long long)(float)x + (long long)(double)x) L1(abs, llabs(x)) L1(min, x < -x ? x : -x)
#define R1(name, expr) F1(r_##name, expr)
R1(addz, __fadd_rz(x,y)) R1(addu, __fadd_ru(x,y)) R1(addd, __fadd_rd(x,y)) R1(mulz, __fmul_rz(x,y))
R1(mulu, __fmul_ru(x,y)) R1(muld, __fmul_rd(x,y)) R1(divz, __fdiv_rz(x,y)) R1(divu, __fdiv_ru(x,y))
R1(divd, __fdiv_rd(x,y)) R1(sqrtz, __fsqrt_rz(fabsf(x))) R1(sqrtu, __fsqrt_ru(fabsf(x)))
R1(fmaz, __fmaf_rz(x,y,x)) R1(fmau, __fmaf_ru(x,y,-x)) R1(fmad, __fmaf_rd(x,y,1.5f))
R1(rcpz, __frcp_rz(x)) R1(rcpu, __frcp_ru(x)) R1(i2fz, __int2float_rz(__float_as_int(x)))
R1(i2fu, __uint2float_ru(__float_as_int(x))) R1(i2fd, __int2float_rd(__float_as_int(y)))
R1(d2fz, __double2float_rz((double)x*1.1)) R1(d2fu, __double2float_ru((double)x*1.1))
R1(halfs, __half2float(__float2half_rn(x))) R1(copy, copysignf(y, x))
D1(addz, __dadd_rz(x, x*0.3)) D1(addu, __dadd_ru(x, x*0.3)) D1(mulz, __dmul_rz(x, x))
D1(muld, __dmul_rd(x, x)) D1(divz, __ddiv_rz(x, 3.3)) D1(sqrtu, __dsqrt_ru(fabs(x)))
extern "C" __global__ void i_dense() {
    unsigned i = idx();
    int x = optixLaunchParams.ia[i], r = 0;
    switch (x & 15) {
        case 0: r = fa(x); break; case 1: r = fb(x) * 3; break; case 2: r = rec(x & 7); break;
        case 3: r = make(x).a[2]; break; case 4: r = fa(fb(x)); break; case 5: r = x / 3; break;
        case 6: r = __popc(x); break; case 7: r = __clz(x); break; case 8: r = x % 10; break;
        case 9: r = fb(fa(x)); break; case 10: r = rec(5) + x; break; case 11: r = x * x; break;
        case 12: r = fa(x) ^ fb(x); break; case 13: r = -x; break; case 14: r = ~x; break;
        case 15: r = make(x).a[4] * 2; break;
    }
    optixLaunchParams.io[i] = r;
}
