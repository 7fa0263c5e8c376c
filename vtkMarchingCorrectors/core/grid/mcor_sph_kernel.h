/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_sph_kernel_h
#define mcor_sph_kernel_h

/* The SPH smoothing kernels. This file is both included by the C core and compiled as OpenCL C: it
 * is the one place to change when a kernel is added (besides its name in mcor_sph_kernel, mcor.h).
 *
 * A kernel is W = norm / h^3 * w(q), q = r / h, with w written in truncated powers so that one
 * branch-free expression holds for all q >= 0, 0 beyond the support. A tensor kernel is
 * W = norm / h^3 * w(|x|/h) w(|y|/h) w(|z|/h). */

/* ENTRY(enumerator, name, support / h, norm, is a tensor product) */
#define MCOR_SPH_KERNEL_TABLE(ENTRY)                                                               \
  ENTRY(MCOR_CUBIC_SPLINE, cubic, 2, 0.31830988618379067154, 0)  /* 1 / pi */                      \
  ENTRY(MCOR_QUADRATIC, quadratic, 2, 0.07460387957432593864, 0) /* 15 / (64 pi) */                \
  ENTRY(MCOR_M_PRIME_4, mprime4, 2, 1.0, 1)                                                        \
  ENTRY(MCOR_QUINTIC_SPLINE, quintic, 3, 0.00265258238486492226, 0) /* 1 / (120 pi) */             \
  ENTRY(MCOR_WENDLAND_C2, wendland, 2, 0.41778172561622525639, 0)   /* 21 / (16 pi) */

#ifdef MCOR_W_ON_HOST
#include <math.h>
typedef double real, realv;
#define MCOR_FMA fma
#define MCOR_OF_Q static inline realv
#else
#define MCOR_OF_Q realv
#endif

#if defined(__OPENCL_VERSION__) || defined(MCOR_W_ON_HOST)

/* w(q), and its derivatives w'(q) and w''(q). Where w'' jumps it has the value of one side. */

/* With a = 2 - q and b = 1 - q where positive, 1/4 a^3 - b^3; as a - b = 1 where b is not 0, this
 * is a c + b^2 with c = 1/4 a^2 - b^2, and its derivative is -3 c. */
MCOR_OF_Q mcor_w_cubic(realv q)
{
  const realv d = (real)2 - q;
  const realv a = fmax(d, (realv)0), b = fmax(d - (real)1, (realv)0), b2 = b * b;
  return MCOR_FMA(a, MCOR_FMA((real)0.25, a * a, -b2), b2);
}

MCOR_OF_Q mcor_dw_cubic(realv q)
{
  const realv d = (real)2 - q;
  const realv a = fmax(d, (realv)0), b = fmax(d - (real)1, (realv)0);
  return (real)-3 * MCOR_FMA((real)0.25, a * a, -(b * b));
}

MCOR_OF_Q mcor_ddw_cubic(realv q)
{
  return MCOR_FMA((real)-6, fmax((real)1 - q, (realv)0), (real)1.5 * fmax((real)2 - q, (realv)0));
}

/* 3/16 q^2 - 3/4 q + 3/4 = 3/16 (2 - q)^2; the 3/16 is in the norm. */
MCOR_OF_Q mcor_w_quadratic(realv q)
{
  const realv a = fmax((real)2 - q, (realv)0);
  return a * a;
}

/* 0 where it has no direction: at 0, as far as positions of large supports are rounded. */
MCOR_OF_Q mcor_dw_quadratic(realv q)
{
  return q < (real)1e-6 ? (realv)0 : (real)-2 * fmax((real)2 - q, (realv)0);
}

MCOR_OF_Q mcor_ddw_quadratic(realv q)
{
  return q < (real)2 ? (realv)2 : (realv)0;
}

/* Per axis; 1 - 5/2 q^2 + 3/2 q^3 = 1/2 (2-q)^2 (1-q) - (1-q)^2 (1-2q). */
MCOR_OF_Q mcor_w_mprime4(realv q)
{
  const realv a = fmax((real)2 - q, (realv)0), b = fmax((real)1 - q, (realv)0);
  return MCOR_FMA((real)0.5 * a * a, (real)1 - q, -(b * b * MCOR_FMA((real)-2, q, (real)1)));
}

MCOR_OF_Q mcor_dw_mprime4(realv q)
{
  const realv a = fmax((real)2 - q, (realv)0), b = fmax((real)1 - q, (realv)0);
  return (real)2 * b * MCOR_FMA((real)-2, q, b + (real)1) - a * MCOR_FMA((real)0.5, a, (real)1 - q);
}

MCOR_OF_Q mcor_ddw_mprime4(realv q)
{
  const realv outer = MCOR_FMA((real)-3, q, (real)5), inner = MCOR_FMA((real)9, q, (real)-5);
  return q < (real)1 ? inner : q < (real)2 ? outer : (realv)0;
}

MCOR_OF_Q mcor_w_quintic(realv q)
{
  const realv a = fmax((real)3 - q, (realv)0), b = fmax((real)2 - q, (realv)0),
              c = fmax((real)1 - q, (realv)0);
  const realv a2 = a * a, b2 = b * b, c2 = c * c;
  return MCOR_FMA((real)15 * c2 * c2, c, MCOR_FMA((real)-6 * b2 * b2, b, a2 * a2 * a));
}

MCOR_OF_Q mcor_dw_quintic(realv q)
{
  const realv a = fmax((real)3 - q, (realv)0), b = fmax((real)2 - q, (realv)0),
              c = fmax((real)1 - q, (realv)0);
  const realv a2 = a * a, b2 = b * b, c2 = c * c;
  return (real)-5 * MCOR_FMA((real)15 * c2, c2, MCOR_FMA((real)-6 * b2, b2, a2 * a2));
}

MCOR_OF_Q mcor_ddw_quintic(realv q)
{
  const realv a = fmax((real)3 - q, (realv)0), b = fmax((real)2 - q, (realv)0),
              c = fmax((real)1 - q, (realv)0);
  return (real)20 * (a * a * a - (real)6 * b * b * b + (real)15 * c * c * c);
}

MCOR_OF_Q mcor_w_wendland(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a;
  return a2 * a2 * MCOR_FMA((real)2, q, (real)1);
}

MCOR_OF_Q mcor_dw_wendland(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0);
  return (real)-5 * q * a * a * a;
}

MCOR_OF_Q mcor_ddw_wendland(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0);
  return (real)2.5 * a * a * ((real)3 * q - (real)2 * a);
}

/* Lowest value of w: M'4 has a negative lobe, its minimum at q = 4/3. */
#define mcor_lowest_mprime4 ((real)-0.074074074074074074)
#define mcor_turning_mprime4 ((real)1.3333333333333333)

#endif
#endif
