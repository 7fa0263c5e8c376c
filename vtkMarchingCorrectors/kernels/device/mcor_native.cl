/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The built-in functions of OpenCL that kernels use, made of Clang's operations, for the built-in
 * device, which needs no OpenCL driver. Their results have the same bits as the results of OpenCL
 * drivers (test_core_native.c). */

#define MCOR_DEFINE __attribute__((overloadable, always_inline)) static inline

/* mcor_item is a parameter of each kernel, see CompileAhead.cmake. */
#define get_global_id(dimension) mcor_item

#define MCOR_FUNCTION(R, name, parameters, value)                                                  \
  MCOR_DEFINE R name parameters                                                                    \
  {                                                                                                \
    return value;                                                                                  \
  }

/* S: the suffix of the names of Clang's functions for type T. */
#define MCOR_DEFINE_REAL(T, S)                                                                     \
  MCOR_FUNCTION(T, fabs, (T x), __builtin_fabs##S(x))                                              \
  MCOR_FUNCTION(T, sqrt, (T x), __builtin_sqrt##S(x))                                              \
  MCOR_FUNCTION(T, floor, (T x), __builtin_floor##S(x))                                            \
  MCOR_FUNCTION(T, ceil, (T x), __builtin_ceil##S(x))                                              \
  MCOR_FUNCTION(T, fma, (T a, T b, T c), __builtin_fma##S(a, b, c))                                \
  MCOR_DEFINE_SIGN(T)                                                                              \
  MCOR_DEFINE_RANGE(T, T)
#define MCOR_DEFINE_SIGN(T)                                                                        \
  MCOR_FUNCTION(T, sign, (T x), x > 0 ? (T)1 : x < 0 ? (T)-1 : x == 0 ? x : (T)0)

/* fmin and fmax return the other argument if one is NaN. B: the type of the second argument: T, or
 * a scalar type, whose value counts for all lanes of T. */
#define MCOR_DEFINE_RANGE(T, B)                                                                    \
  MCOR_FUNCTION(T, fmin, (T a, B b), a < (T)b || (T)b != (T)b ? a : (T)b)                          \
  MCOR_FUNCTION(T, fmax, (T a, B b), a > (T)b || (T)b != (T)b ? a : (T)b)                          \
  MCOR_FUNCTION(T, clamp, (T x, B low, B high), fmin(fmax(x, low), high))

#define MCOR_DEFINE_INTEGER(T, B)                                                                  \
  MCOR_FUNCTION(T, min, (T a, B b), a < (T)b ? a : (T)b)                                           \
  MCOR_FUNCTION(T, max, (T a, B b), a > (T)b ? a : (T)b)                                           \
  MCOR_FUNCTION(T, clamp, (T x, B low, B high), min(max(x, low), high))

/* L: the suffix of the names of Clang's functions for type T; B: the number of bits of T. */
#define MCOR_DEFINE_BITS(T, L, B)                                                                  \
  MCOR_DEFINE_INTEGER(T, T)                                                                        \
  MCOR_FUNCTION(T, popcount, (T x), __builtin_popcount##L(x))                                      \
  MCOR_FUNCTION(T, clz, (T x), x ? __builtin_clz##L(x) : B)

MCOR_DEFINE_BITS(int, , 32)
MCOR_DEFINE_BITS(uint, , 32)
MCOR_DEFINE_BITS(long, l, 64)
MCOR_DEFINE_BITS(ulong, l, 64)
MCOR_DEFINE_INTEGER(int4, int4)
MCOR_DEFINE_REAL(float, f)
MCOR_DEFINE_REAL(double, )
MCOR_FUNCTION(uint, abs, (int x), x < 0 ? -(uint)x : (uint)x)
MCOR_FUNCTION(float, convert_float, (int x), (float)x)
MCOR_FUNCTION(float, convert_float, (long x), (float)x)
MCOR_FUNCTION(double, convert_double, (int x), (double)x)
MCOR_FUNCTION(double, convert_double, (long x), (double)x)

#define MCOR_ATOMIC(T, operation, p, v)                                                            \
  __sync_fetch_and_##operation((volatile __private T*)(size_t)p, v)
#define MCOR_DEFINE_ATOMICS(T, least, most)                                                        \
  MCOR_FUNCTION(T, atomic_inc, (volatile __global T * p), MCOR_ATOMIC(T, add, p, 1))               \
  MCOR_FUNCTION(T, atomic_or, (volatile __global T * p, T v), MCOR_ATOMIC(T, or, p, v))            \
  MCOR_FUNCTION(T, atomic_and, (volatile __global T * p, T v), MCOR_ATOMIC(T, and, p, v))          \
  MCOR_FUNCTION(T, atomic_min, (volatile __global T * p, T v), MCOR_ATOMIC(T, least, p, v))        \
  MCOR_FUNCTION(T, atomic_max, (volatile __global T * p, T v), MCOR_ATOMIC(T, most, p, v))
MCOR_DEFINE_ATOMICS(int, min, max)
MCOR_DEFINE_ATOMICS(uint, umin, umax)

/* Defines a function for vectors R of n numbers, by a loop over the numbers. Clang makes one
 * instruction of such a loop, but makes branches if the loop has a conditional. */
#define MCOR_LANES_FUNCTION(n, R, name, parameters, value)                                         \
  MCOR_DEFINE R name parameters                                                                    \
  {                                                                                                \
    R r;                                                                                           \
    for (int i = 0; i < n; ++i)                                                                    \
    {                                                                                              \
      r[i] = value;                                                                                \
    }                                                                                              \
    return r;                                                                                      \
  }
#define MCOR_DEFINE_REALS(n, R, T)                                                                 \
  MCOR_LANES_FUNCTION(n, R, fabs, (R x), fabs((T)x[i]))                                            \
  MCOR_LANES_FUNCTION(n, R, sqrt, (R x), sqrt((T)x[i]))                                            \
  MCOR_LANES_FUNCTION(n, R, floor, (R x), floor((T)x[i]))                                          \
  MCOR_LANES_FUNCTION(n, R, ceil, (R x), ceil((T)x[i]))                                            \
  MCOR_LANES_FUNCTION(n, R, fma, (R a, R b, R c), fma((T)a[i], (T)b[i], (T)c[i]))                  \
  MCOR_DEFINE_SIGN(R)                                                                              \
  MCOR_DEFINE_RANGE(R, R)                                                                          \
  MCOR_DEFINE_RANGE(R, T)

#define MCOR_DEFINE_MEMORY_IN(n, R, T, SPACE)                                                      \
  MCOR_FUNCTION(R, vload##n, (size_t i, SPACE const T* p), *(SPACE const R##_loose*)(p + n * i))   \
  MCOR_DEFINE void vstore##n(R v, size_t i, SPACE T* p)                                            \
  {                                                                                                \
    *(SPACE R##_loose*)(p + n * i) = v;                                                            \
  }
#define MCOR_DEFINE_MEMORY(n, R, T)                                                                \
  typedef R R##_loose __attribute__((aligned(sizeof(T)), may_alias));                              \
  MCOR_DEFINE_MEMORY_IN(n, R, T, __global)                                                         \
  MCOR_DEFINE_MEMORY_IN(n, R, T, __private)

/* Defines `any` or `all`: whether any, or all, of the n integers (type F) in a mask are below 0. */
#define MCOR_DEFINE_TOGETHER(n, I, F, name, first, operator)                                       \
  MCOR_DEFINE int name(I x)                                                                        \
  {                                                                                                \
    F r = first;                                                                                   \
    for (int i = 0; i < n; ++i)                                                                    \
    {                                                                                              \
      r operator x[i];                                                                             \
    }                                                                                              \
    return r < 0;                                                                                  \
  }

/* Defines all functions for vectors R of n numbers of type T. The masks of these vectors are
 * vectors I of n integers of type F. */
#define MCOR_DEFINE_VECTOR(n, R, T, I, F)                                                          \
  MCOR_DEFINE_REALS(n, R, T)                                                                       \
  MCOR_DEFINE_INTEGER(I, F)                                                                        \
  MCOR_DEFINE_TOGETHER(n, I, F, any, 0, |=)                                                        \
  MCOR_DEFINE_TOGETHER(n, I, F, all, -1, &=)                                                       \
  MCOR_FUNCTION(R, convert_##R, (I x), __builtin_convertvector(x, R))                              \
  MCOR_DEFINE_MEMORY(n, R, T)                                                                      \
  MCOR_DEFINE_MEMORY(n, I, F)

MCOR_DEFINE_REALS(2, float2, float)
MCOR_DEFINE_REALS(2, double2, double)
MCOR_DEFINE_VECTOR(4, float4, float, int4, int)
MCOR_DEFINE_VECTOR(8, float8, float, int8, int)
MCOR_DEFINE_INTEGER(int8, int8)
MCOR_DEFINE_VECTOR(16, float16, float, int16, int)
MCOR_DEFINE_INTEGER(int16, int16)
MCOR_DEFINE_VECTOR(4, double4, double, long4, long)
MCOR_DEFINE_INTEGER(long4, long4)
MCOR_DEFINE_VECTOR(8, double8, double, long8, long)
MCOR_DEFINE_INTEGER(long8, long8)
MCOR_DEFINE_VECTOR(16, double16, double, long16, long)
MCOR_DEFINE_INTEGER(long16, long16)

MCOR_FUNCTION(int8, convert_int8, (uchar8 x), __builtin_convertvector(x, int8))
MCOR_FUNCTION(double4, convert_double4, (int4 x), __builtin_convertvector(x, double4))
