/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Has a kernel for each built-in function and type: r[i] = f(a[i], b[i], c[i]). These kernels are compiled ahead with
 * mcor_native.cl, and by a driver with the driver's own functions; test_core_native.c compares the results. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#define TRY(name, RESULT, A, B, value)                                                             \
  __kernel void try_##name(                                                                        \
    __global const A* a, __global const B* b, __global const B* c, __global RESULT* r)             \
  {                                                                                                \
    const int i = get_global_id(0);                                                                \
    r[i] = value;                                                                                  \
  }
#define TRY_RANGE(name, T, B)                                                                      \
  TRY(name##_fmin, T, T, B, fmin(a[i], b[i]))                                                      \
  TRY(name##_fmax, T, T, B, fmax(a[i], b[i]))                                                      \
  TRY(name##_clamp, T, T, B, clamp(a[i], fmin(b[i], c[i]), fmax(b[i], c[i])))
#define TRY_REAL(T)                                                                                \
  TRY(T##_fabs, T, T, T, fabs(a[i]))                                                               \
  TRY(T##_sqrt, T, T, T, sqrt(a[i]))                                                               \
  TRY(T##_floor, T, T, T, floor(a[i]))                                                             \
  TRY(T##_ceil, T, T, T, ceil(a[i]))                                                               \
  TRY(T##_sign, T, T, T, sign(a[i]))                                                               \
  TRY(T##_fma, T, T, T, fma(a[i], b[i], c[i]))                                                     \
  TRY_RANGE(T, T, T)
#define TRY_INTEGER(name, T, B)                                                                    \
  TRY(name##_min, T, T, B, min(a[i], b[i]))                                                        \
  TRY(name##_max, T, T, B, max(a[i], b[i]))                                                        \
  TRY(name##_clamp, T, T, B, clamp(a[i], min(b[i], c[i]), max(b[i], c[i])))
#define TRY_BITS(T)                                                                                \
  TRY_INTEGER(T, T, T)                                                                             \
  TRY(T##_popcount, T, T, T, popcount(a[i]))                                                       \
  TRY(T##_clz, T, T, T, clz(a[i]))
#define TRY_VECTOR(n, R, T, I, F)                                                                  \
  TRY_REAL(R)                                                                                      \
  TRY_RANGE(R##_with, R, T)                                                                        \
  TRY_INTEGER(I, I, I)                                                                             \
  TRY_INTEGER(I##_with, I, F)                                                                      \
  TRY(I##_any, int, I, F, any(a[i]))                                                               \
  TRY(I##_all, int, I, F, all(a[i]))                                                               \
  TRY(I##_any_of, int, I, I, any(a[i] < b[i]))                                                     \
  TRY(I##_all_of, int, I, I, all(a[i] < b[i]))                                                     \
  TRY(I##_convert, R, I, F, convert_##R(a[i]))                                                     \
  TRY(R##_memory, R, T, F, vload##n(i, a))                                                         \
  __kernel void try_##R##_store(                                                                   \
    __global const R* a, __global const R* b, __global const R* c, __global T* r)                  \
  {                                                                                                \
    const int i = get_global_id(0);                                                                \
    T own[3 * n];                                                                                  \
    vstore##n(a[i], 0, own + 1);                                                                   \
    vstore##n(vload##n(0, own + 1), i, r);                                                         \
  }                                                                                                \
  TRY(R##_choose, R, R, R, a[i] < b[i] && b[i] >= c[i] ? a[i] : c[i])

TRY_BITS(int)
TRY_BITS(uint)
TRY_BITS(long)
TRY_BITS(ulong)
TRY(int_abs, uint, int, int, abs(a[i]))
TRY(int_float, float, int, int, convert_float(a[i]))
TRY(long_float, float, long, int, convert_float(a[i]))
TRY(int_double, double, int, int, convert_double(a[i]))
TRY(long_double, double, long, int, convert_double(a[i]))
TRY_REAL(float)
TRY_REAL(float2)
TRY_REAL(double)
TRY_REAL(double2)
TRY_VECTOR(4, float4, float, int4, int)
TRY_VECTOR(8, float8, float, int8, int)
TRY_VECTOR(16, float16, float, int16, int)
TRY_VECTOR(4, double4, double, long4, long)
TRY_VECTOR(8, double8, double, long8, long)
TRY(uchar8_convert, int8, uchar8, int, convert_int8(a[i]))
TRY(int4_double, double4, int4, int, convert_double4(a[i]))

/* All work-items change the same five numbers, each number with another atomic function. */
#define TRY_ATOMIC(T)                                                                              \
  __kernel void try_##T##_atomic(                                                                  \
    __global const T* a, __global const T* b, __global const T* c, __global T* r)                  \
  {                                                                                                \
    const int i = get_global_id(0);                                                                \
    atomic_inc(r);                                                                                 \
    atomic_or(r + 1, a[i] & b[i] & c[i]);                                                          \
    atomic_and(r + 2, a[i] | b[i]);                                                                \
    atomic_min(r + 3, a[i]);                                                                       \
    atomic_max(r + 4, a[i]);                                                                       \
  }
TRY_ATOMIC(int)
TRY_ATOMIC(uint)
