/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* OpenCL's built-in functions that kernels use, defined for the built-in device by Clang's own
 * operations: the results are those of OpenCL drivers, bit by bit (test_core_native.c). */

#define MCOR_DEFINE __attribute__((overloadable, always_inline)) static inline

/* mcor_item is a parameter of each kernel, see CompileAhead.cmake. */
#define get_global_id(dimension) mcor_item

/* S: suffix of Clang's functions of T. */
#define MCOR_DEFINE_REAL(T, S)                                                                     \
  MCOR_DEFINE T fabs(T x)                                                                          \
  {                                                                                                \
    return __builtin_fabs##S(x);                                                                   \
  }                                                                                                \
  MCOR_DEFINE T sqrt(T x)                                                                          \
  {                                                                                                \
    return __builtin_sqrt##S(x);                                                                   \
  }                                                                                                \
  MCOR_DEFINE T floor(T x)                                                                         \
  {                                                                                                \
    return __builtin_floor##S(x);                                                                  \
  }                                                                                                \
  MCOR_DEFINE T ceil(T x)                                                                          \
  {                                                                                                \
    return __builtin_ceil##S(x);                                                                   \
  }                                                                                                \
  MCOR_DEFINE T fma(T a, T b, T c)                                                                 \
  {                                                                                                \
    return __builtin_fma##S(a, b, c);                                                              \
  }                                                                                                \
  MCOR_DEFINE T sign(T x)                                                                          \
  {                                                                                                \
    return x > 0 ? (T)1 : x < 0 ? (T)-1 : x == 0 ? x : (T)0;                                       \
  }                                                                                                \
  MCOR_DEFINE_RANGE(T, T)

/* These return the other argument if one is NaN. B: T, or a scalar for all lanes of T. */
#define MCOR_DEFINE_RANGE(T, B)                                                                    \
  MCOR_DEFINE T fmin(T a, B other)                                                                 \
  {                                                                                                \
    const T b = (T)other;                                                                          \
    return a < b || b != b ? a : b;                                                                \
  }                                                                                                \
  MCOR_DEFINE T fmax(T a, B other)                                                                 \
  {                                                                                                \
    const T b = (T)other;                                                                          \
    return a > b || b != b ? a : b;                                                                \
  }                                                                                                \
  MCOR_DEFINE T clamp(T x, B low, B high)                                                          \
  {                                                                                                \
    return fmin(fmax(x, low), high);                                                               \
  }

#define MCOR_DEFINE_INTEGER(T, B)                                                                  \
  MCOR_DEFINE T min(T a, B other)                                                                  \
  {                                                                                                \
    const T b = (T)other;                                                                          \
    return a < b ? a : b;                                                                          \
  }                                                                                                \
  MCOR_DEFINE T max(T a, B other)                                                                  \
  {                                                                                                \
    const T b = (T)other;                                                                          \
    return a > b ? a : b;                                                                          \
  }                                                                                                \
  MCOR_DEFINE T clamp(T x, B low, B high)                                                          \
  {                                                                                                \
    return min(max(x, low), high);                                                                 \
  }

/* L: suffix of Clang's functions of T; B: bits. */
#define MCOR_DEFINE_BITS(T, L, B)                                                                  \
  MCOR_DEFINE_INTEGER(T, T)                                                                        \
  MCOR_DEFINE T popcount(T x)                                                                      \
  {                                                                                                \
    return __builtin_popcount##L(x);                                                               \
  }                                                                                                \
  MCOR_DEFINE T clz(T x)                                                                           \
  {                                                                                                \
    return x ? __builtin_clz##L(x) : B;                                                            \
  }

MCOR_DEFINE_BITS(int, , 32)
MCOR_DEFINE_BITS(uint, , 32)
MCOR_DEFINE_BITS(long, l, 64)
MCOR_DEFINE_BITS(ulong, l, 64)
MCOR_DEFINE_INTEGER(int4, int4)
MCOR_DEFINE_REAL(float, f)
MCOR_DEFINE_REAL(double, )

MCOR_DEFINE uint abs(int x)
{
  return x < 0 ? -(uint)x : (uint)x;
}

#define MCOR_DEFINE_CONVERT(R, T)                                                                  \
  MCOR_DEFINE R convert_##R(T x)                                                                   \
  {                                                                                                \
    return (R)x;                                                                                   \
  }
MCOR_DEFINE_CONVERT(float, int)
MCOR_DEFINE_CONVERT(float, long)
MCOR_DEFINE_CONVERT(double, int)
MCOR_DEFINE_CONVERT(double, long)

#define MCOR_DEFINE_ATOMIC(T, NAME, FUNCTION, PARAMETER, VALUE)                                    \
  MCOR_DEFINE T atomic_##NAME(volatile __global T* p PARAMETER)                                    \
  {                                                                                                \
    return __sync_fetch_and_##FUNCTION((volatile __private T*)(size_t)p, VALUE);                   \
  }
#define MCOR_COMMA ,
MCOR_DEFINE_ATOMIC(int, inc, add, , 1)
MCOR_DEFINE_ATOMIC(int, or, or, MCOR_COMMA int v, v)
MCOR_DEFINE_ATOMIC(int, and, and, MCOR_COMMA int v, v)
MCOR_DEFINE_ATOMIC(int, min, min, MCOR_COMMA int v, v)
MCOR_DEFINE_ATOMIC(int, max, max, MCOR_COMMA int v, v)
MCOR_DEFINE_ATOMIC(uint, inc, add, , 1)
MCOR_DEFINE_ATOMIC(uint, or, or, MCOR_COMMA uint v, v)
MCOR_DEFINE_ATOMIC(uint, and, and, MCOR_COMMA uint v, v)
MCOR_DEFINE_ATOMIC(uint, min, umin, MCOR_COMMA uint v, v)
MCOR_DEFINE_ATOMIC(uint, max, umax, MCOR_COMMA uint v, v)

/* Vectors R of n numbers T. Clang makes one instruction of such a loop; a loop with a choice
 * would become branches. */
#define MCOR_EACH_LANE(R, n, value)                                                                \
  R r;                                                                                             \
  for (int i = 0; i < n; ++i)                                                                      \
  {                                                                                                \
    r[i] = value;                                                                                  \
  }                                                                                                \
  return r
#define MCOR_DEFINE_REALS(n, R, T)                                                                 \
  MCOR_DEFINE R fabs(R x)                                                                          \
  {                                                                                                \
    MCOR_EACH_LANE(R, n, fabs((T)x[i]));                                                           \
  }                                                                                                \
  MCOR_DEFINE R sqrt(R x)                                                                          \
  {                                                                                                \
    MCOR_EACH_LANE(R, n, sqrt((T)x[i]));                                                           \
  }                                                                                                \
  MCOR_DEFINE R floor(R x)                                                                         \
  {                                                                                                \
    MCOR_EACH_LANE(R, n, floor((T)x[i]));                                                          \
  }                                                                                                \
  MCOR_DEFINE R ceil(R x)                                                                          \
  {                                                                                                \
    MCOR_EACH_LANE(R, n, ceil((T)x[i]));                                                           \
  }                                                                                                \
  MCOR_DEFINE R sign(R x)                                                                          \
  {                                                                                                \
    return x > 0 ? (R)1 : x < 0 ? (R)-1 : x == 0 ? x : (R)0;                                       \
  }                                                                                                \
  MCOR_DEFINE R fma(R a, R b, R c)                                                                 \
  {                                                                                                \
    MCOR_EACH_LANE(R, n, fma((T)a[i], (T)b[i], (T)c[i]));                                          \
  }                                                                                                \
  MCOR_DEFINE_RANGE(R, R)                                                                          \
  MCOR_DEFINE_RANGE(R, T)

#define MCOR_DEFINE_MEMORY_IN(n, R, T, SPACE)                                                      \
  MCOR_DEFINE R vload##n(size_t i, SPACE const T* p)                                               \
  {                                                                                                \
    return *(SPACE const R##_loose*)(p + n * i);                                                   \
  }                                                                                                \
  MCOR_DEFINE void vstore##n(R v, size_t i, SPACE T* p)                                            \
  {                                                                                                \
    *(SPACE R##_loose*)(p + n * i) = v;                                                            \
  }
#define MCOR_DEFINE_MEMORY(n, R, T)                                                                \
  typedef R R##_loose __attribute__((aligned(sizeof(T)), may_alias));                              \
  MCOR_DEFINE_MEMORY_IN(n, R, T, __global)                                                         \
  MCOR_DEFINE_MEMORY_IN(n, R, T, __private)

/* Vectors with masks I of integers F. */
#define MCOR_DEFINE_VECTOR(n, R, T, I, F)                                                          \
  MCOR_DEFINE_REALS(n, R, T)                                                                       \
  MCOR_DEFINE_INTEGER(I, F)                                                                        \
  MCOR_DEFINE int any(I x)                                                                         \
  {                                                                                                \
    F r = 0;                                                                                       \
    for (int i = 0; i < n; ++i)                                                                    \
    {                                                                                              \
      r |= x[i];                                                                                   \
    }                                                                                              \
    return r < 0;                                                                                  \
  }                                                                                                \
  MCOR_DEFINE int all(I x)                                                                         \
  {                                                                                                \
    F r = -1;                                                                                      \
    for (int i = 0; i < n; ++i)                                                                    \
    {                                                                                              \
      r &= x[i];                                                                                   \
    }                                                                                              \
    return r < 0;                                                                                  \
  }                                                                                                \
  MCOR_DEFINE R convert_##R(I x)                                                                   \
  {                                                                                                \
    return __builtin_convertvector(x, R);                                                          \
  }                                                                                                \
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

MCOR_DEFINE int8 convert_int8(uchar8 x)
{
  return __builtin_convertvector(x, int8);
}
MCOR_DEFINE double4 convert_double4(int4 x)
{
  return __builtin_convertvector(x, double4);
}
