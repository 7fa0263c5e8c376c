/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The built-in functions that kernels use, declared as in Clang's opencl-c.h. PoCL reads that
 * header before every program: 18,000 lines, which take longer than all of ours, and again when
 * a compiled program is loaded. The host makes PoCL skip it (MCOR_DECLARES_BUILTINS,
 * -D_OPENCL_H_); if that fails, it does not. */

#if MCOR_DECLARES_BUILTINS
#define MCOR_BUILTIN __attribute__((overloadable, const))
#define MCOR_BUILTIN_READS __attribute__((overloadable, pure))
#define MCOR_BUILTIN_ACTS __attribute__((overloadable))

size_t MCOR_BUILTIN get_global_id(uint);
size_t MCOR_BUILTIN get_local_id(uint);
void __attribute__((overloadable, convergent)) barrier(uint);

#define MCOR_DECLARE_REAL(T)                                                                       \
  T MCOR_BUILTIN fabs(T);                                                                          \
  T MCOR_BUILTIN sqrt(T);                                                                          \
  T MCOR_BUILTIN floor(T);                                                                         \
  T MCOR_BUILTIN ceil(T);                                                                          \
  T MCOR_BUILTIN sign(T);                                                                          \
  T MCOR_BUILTIN fmin(T, T);                                                                       \
  T MCOR_BUILTIN fmax(T, T);                                                                       \
  T MCOR_BUILTIN fma(T, T, T);                                                                     \
  T MCOR_BUILTIN clamp(T, T, T);

#define MCOR_DECLARE_INTEGER(T)                                                                    \
  T MCOR_BUILTIN min(T, T);                                                                        \
  T MCOR_BUILTIN max(T, T);                                                                        \
  T MCOR_BUILTIN clamp(T, T, T);

/* Vectors R of numbers T, and with masks I of integers F. */
#define MCOR_DECLARE_VECTOR(n, R, T, I, F)                                                         \
  MCOR_DECLARE_REAL(R)                                                                             \
  MCOR_DECLARE_INTEGER(I)                                                                          \
  R MCOR_BUILTIN fmin(R, T);                                                                       \
  R MCOR_BUILTIN fmax(R, T);                                                                       \
  R MCOR_BUILTIN clamp(R, T, T);                                                                   \
  I MCOR_BUILTIN min(I, F);                                                                        \
  I MCOR_BUILTIN max(I, F);                                                                        \
  int MCOR_BUILTIN any(I);                                                                         \
  int MCOR_BUILTIN all(I);                                                                         \
  R MCOR_BUILTIN convert_##R(I);                                                                   \
  MCOR_DECLARE_MEMORY(n, R, T)                                                                     \
  MCOR_DECLARE_MEMORY(n, I, F)

#define MCOR_DECLARE_MEMORY(n, R, T)                                                               \
  R MCOR_BUILTIN_READS vload##n(size_t, __global const T*);                                        \
  R MCOR_BUILTIN_READS vload##n(size_t, __private const T*);                                       \
  void MCOR_BUILTIN_ACTS vstore##n(R, size_t, __global T*);                                        \
  void MCOR_BUILTIN_ACTS vstore##n(R, size_t, __private T*);

#define MCOR_DECLARE_ATOMIC(T)                                                                     \
  T MCOR_BUILTIN_ACTS atomic_inc(volatile __global T*);                                            \
  T MCOR_BUILTIN_ACTS atomic_or(volatile __global T*, T);                                          \
  T MCOR_BUILTIN_ACTS atomic_and(volatile __global T*, T);                                         \
  T MCOR_BUILTIN_ACTS atomic_min(volatile __global T*, T);                                         \
  T MCOR_BUILTIN_ACTS atomic_max(volatile __global T*, T);

#define MCOR_DECLARE_BITS(T)                                                                       \
  MCOR_DECLARE_INTEGER(T)                                                                          \
  T MCOR_BUILTIN popcount(T);                                                                      \
  T MCOR_BUILTIN clz(T);

MCOR_DECLARE_BITS(int)
MCOR_DECLARE_BITS(uint)
MCOR_DECLARE_BITS(long)
MCOR_DECLARE_BITS(ulong)
MCOR_DECLARE_INTEGER(int4)
uint MCOR_BUILTIN abs(int);
MCOR_DECLARE_ATOMIC(int)
MCOR_DECLARE_ATOMIC(uint)
MCOR_DECLARE_REAL(float)
MCOR_DECLARE_REAL(float2)
float MCOR_BUILTIN convert_float(int);
float MCOR_BUILTIN convert_float(long);
MCOR_DECLARE_VECTOR(4, float4, float, int4, int)
MCOR_DECLARE_VECTOR(8, float8, float, int8, int)
MCOR_DECLARE_VECTOR(16, float16, float, int16, int)
int8 MCOR_BUILTIN convert_int8(uchar8);
#ifdef cl_khr_fp64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
MCOR_DECLARE_REAL(double)
MCOR_DECLARE_REAL(double2)
double MCOR_BUILTIN convert_double(int);
double MCOR_BUILTIN convert_double(long);
double4 MCOR_BUILTIN convert_double4(int4);
MCOR_DECLARE_VECTOR(4, double4, double, long4, long)
MCOR_DECLARE_VECTOR(8, double8, double, long8, long)
MCOR_DECLARE_VECTOR(16, double16, double, long16, long)
#endif
#endif
