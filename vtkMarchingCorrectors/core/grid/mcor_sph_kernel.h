/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_sph_kernel_h
#define mcor_sph_kernel_h

/* The SPH smoothing kernels, for the C core and, as OpenCL C, for devices: each has a row of the
 * table and three functions. CONTRIBUTING.md says where else a kernel has to be named.
 *
 * A kernel is W = norm / h^3 * w(q), q = r / h. w is one branch-free expression for all q >= 0, and
 * 0 beyond the support. A tensor kernel is W = norm / h^3 * w(|x|/h) w(|y|/h) w(|z|/h). All others
 * must be positive and fall with q. The rounding error of w must be at most 96 units of rounding.
 * The bounds of the field (mcor_bound.cl) rely on these two rules. All kernels use only operations
 * that every device rounds alike: no sine, no power, no exponential. */

/* A row has what the core knows of a kernel. Rows are in the order of mcor_sph_kernel:
 *
 *   enumerator, name, support / h, norm, whether it is a tensor product,
 *   variance in space, variance in the plane: the integral of x^2 W, in h^2
 *   c: in the plane, W = c h norm / h^3 * w(q) has the integral 1; a tensor kernel in the plane has
 *     w(|x|/h) w(|y|/h) in place of w(q)
 *   the usual numbers of neighbours in space and in the plane: texts that a warning quotes */
// clang-format off
#define MCOR_SPH_KERNEL_TABLE(ENTRY) \
  ENTRY(MCOR_CUBIC_SPLINE, cubic, 2.0, 0.31830988618379067154, 0, /* 1 / pi */ \
    3.0 / 10, 31.0 / 98, 10.0 / 7, "30 to 100", "12 to 40") \
  ENTRY(MCOR_QUADRATIC, quadratic, 2.0, 0.07460387957432593864, 0, /* 15 / (64 pi) */ \
    8.0 / 21, 2.0 / 5, 8.0 / 5, "30 to 100", "12 to 40") \
  ENTRY(MCOR_M_PRIME_4, mprime4, 2.0, 1.0, 1, \
    0.0, 0.0, 1.0, "30 to 60", "12 to 25") \
  ENTRY(MCOR_QUINTIC_SPLINE, quintic, 3.0, 0.00265258238486492226, 0, /* 1 / (120 pi) */ \
    7.0 / 15, 2771.0 / 5736, 420.0 / 239, "100 to 250", "30 to 80") \
  ENTRY(MCOR_WENDLAND_C2, wendland, 2.0, 0.41778172561622525639, 0, /* 21 / (16 pi) */ \
    4.0 / 15, 5.0 / 18, 4.0 / 3, "50 to 250", "15 to 60") \
  ENTRY(MCOR_QUARTIC_SPLINE, quartic, 2.5, 0.01591549430918953358, 0, /* 1 / (20 pi) */ \
    23.0 / 60, 9759.0 / 24416, 1920.0 / 1199, "60 to 200", "20 to 60") \
  ENTRY(MCOR_WENDLAND_C4, wendland_c4, 2.0, 0.61548200648818899379, 0, /* 495 / (256 pi) */ \
    8.0 / 39, 7.0 / 33, 64.0 / 55, "100 to 300", "25 to 80") \
  ENTRY(MCOR_WENDLAND_C6, wendland_c6, 2.0, 0.84861913015795755205, 0, /* 1365 / (512 pi) */ \
    1.0 / 6, 6.0 / 35, 256.0 / 245, "150 to 400", "35 to 100") \
  ENTRY(MCOR_SINC_6, sinc6, 2.0, 0.79044958943230289736, 0, \
    0.17139287862743, 0.17709595937597, 1.0635845764083532547, "60 to 200", "20 to 60")
// clang-format on

#ifdef MCOR_W_ON_HOST
#include <math.h>
typedef double real, realv;
#define MCOR_FMA fma
#define MCOR_OF_Q static inline realv
#else
#define MCOR_OF_Q realv
#endif

#if defined(__OPENCL_VERSION__) || defined(MCOR_W_ON_HOST)

/* w(q), and its derivatives w'(q) and w''(q). At a jump, w'' has the value of either side. */

/* w = 1/4 a^3 - b^3 with a = max(2 - q, 0), b = max(1 - q, 0). Since a - b = 1 unless b = 0, this
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

/* w = 3/16 q^2 - 3/4 q + 3/4 = 3/16 (2 - q)^2. The norm contains the factor 3/16. */
MCOR_OF_Q mcor_w_quadratic(realv q)
{
  const realv a = fmax((real)2 - q, (realv)0);
  return a * a;
}

/* At q = 0 the gradient has no direction, so w' is 0 there. Up to q = 1e-6, w' is 0, too, because
 * positions of particles with large supports are rounded by about as much. */
MCOR_OF_Q mcor_dw_quadratic(realv q)
{
  return q < (real)1e-6 ? (realv)0 : (real)-2 * fmax((real)2 - q, (realv)0);
}

MCOR_OF_Q mcor_ddw_quadratic(realv q)
{
  return q < (real)2 ? (realv)2 : (realv)0;
}

/* w along one axis: 1/2 (2 - q)^2 (1 - q) up to q = 2, less (1 - q)^2 (1 - 2 q) up to q = 1. */
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

MCOR_OF_Q mcor_w_quartic(realv q)
{
  const realv a = fmax((real)2.5 - q, (realv)0), b = fmax((real)1.5 - q, (realv)0),
              c = fmax((real)0.5 - q, (realv)0);
  const realv a2 = a * a, b2 = b * b, c2 = c * c;
  return MCOR_FMA((real)10 * c2, c2, MCOR_FMA((real)-5 * b2, b2, a2 * a2));
}

MCOR_OF_Q mcor_dw_quartic(realv q)
{
  const realv a = fmax((real)2.5 - q, (realv)0), b = fmax((real)1.5 - q, (realv)0),
              c = fmax((real)0.5 - q, (realv)0);
  return (real)-4 * MCOR_FMA((real)10 * c * c, c, MCOR_FMA((real)-5 * b * b, b, a * a * a));
}

MCOR_OF_Q mcor_ddw_quartic(realv q)
{
  const realv a = fmax((real)2.5 - q, (realv)0), b = fmax((real)1.5 - q, (realv)0),
              c = fmax((real)0.5 - q, (realv)0);
  return (real)12 * MCOR_FMA((real)10 * c, c, MCOR_FMA((real)-5 * b, b, a * a));
}

MCOR_OF_Q mcor_w_wendland_c4(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a;
  return a2 * a2 * a2 *
    MCOR_FMA(q, MCOR_FMA((real)2.9166666666666667, q, (real)3), (real)1); /* 35 / 12 */
}

MCOR_OF_Q mcor_dw_wendland_c4(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a;
  return (real)-4.6666666666666667 * q * a2 * a2 * a * MCOR_FMA((real)2.5, q, (real)1); /* 14/3 */
}

MCOR_OF_Q mcor_ddw_wendland_c4(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a;
  return (real)-4.6666666666666667 * a2 * a2 *
    MCOR_FMA(q, MCOR_FMA((real)-8.75, q, (real)2), (real)1);
}

MCOR_OF_Q mcor_w_wendland_c6(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a, a4 = a2 * a2;
  return a4 * a4 * MCOR_FMA(q, MCOR_FMA(q, MCOR_FMA((real)4, q, (real)6.25), (real)4), (real)1);
}

MCOR_OF_Q mcor_dw_wendland_c6(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a, a4 = a2 * a2;
  return (real)-5.5 * q * (a4 * a2 * a) * MCOR_FMA(q, MCOR_FMA((real)4, q, (real)3.5), (real)1);
}

MCOR_OF_Q mcor_ddw_wendland_c6(realv q)
{
  const realv a = fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0), a2 = a * a;
  return (real)-5.5 * (a2 * a2 * a2) *
    MCOR_FMA(q, MCOR_FMA(q, MCOR_FMA((real)-20, q, (real)-3.75), (real)3), (real)1);
}

/* w = s^6 with s = sin(x) / x, x = pi q / 2. As s is even and 0 at q = 2, s = t p(t) with t = 1 -
 * q^2 / 4, p(0) = 1/2, p'(0) = 3/8. p is so smooth that a polynomial is enough; sines cannot be
 * used, because their bits differ between devices. The other coefficients are fitted to s / t from
 * t = 0 to 1 for the least relative error, one after the other, with the earlier ones rounded. The
 * error of w is below 5e-10 in single and 1e-16 in double precision; the slopes are the
 * polynomial's, with errors below 3e-9 and 1e-15. Rounding adds relative errors of w up to 1.5e-6
 * and 3e-15, as with the quintic spline. FIRST takes the coefficients of the highest two powers. */
#if defined(MCOR_W_ON_HOST) || MCOR_DOUBLE
#define MCOR_SINC(FIRST, NEXT)                                                                     \
  FIRST(1.518996494692584e-10, 5.733052293908227e-09)                                              \
  NEXT(1.946080165689168e-07)                                                                      \
  NEXT(5.194313757397573e-06)                                                                      \
  NEXT(0.00010610604804013208)                                                                     \
  NEXT(0.0015887054461093402)                                                                      \
  NEXT(0.01641655205516161)                                                                        \
  NEXT(0.106883241643963)                                                                          \
  NEXT(0.375)                                                                                      \
  NEXT(0.5)
#else
#define MCOR_SINC(FIRST, NEXT)                                                                     \
  FIRST(5.836395e-06f, 0.00010533832f)                                                             \
  NEXT(0.001589126f)                                                                               \
  NEXT(0.01641645f)                                                                                \
  NEXT(0.10688325f)                                                                                \
  NEXT(0.375f)                                                                                     \
  NEXT(0.5f)
#endif

#define MCOR_SINC_A(q) fmax(MCOR_FMA((real)-0.5, q, (real)1), (realv)0)
#define MCOR_SINC_FIRST(last, before) realv p = MCOR_FMA((real)last, t, (real)before);
#define MCOR_SINC_NEXT(c) p = MCOR_FMA(p, t, (real)c);
/* Macros with _D also compute d = p'; macros with _E compute d and e = p'' / 2, too. */
#define MCOR_SINC_FIRST_D(last, before)                                                            \
  realv d = (realv)(real)last;                                                                     \
  MCOR_SINC_FIRST(last, before)
#define MCOR_SINC_NEXT_D(c)                                                                        \
  d = MCOR_FMA(d, t, p);                                                                           \
  MCOR_SINC_NEXT(c)
#define MCOR_SINC_FIRST_E(last, before)                                                            \
  realv e = (realv)0;                                                                              \
  MCOR_SINC_FIRST_D(last, before)
#define MCOR_SINC_NEXT_E(c)                                                                        \
  e = MCOR_FMA(e, t, d);                                                                           \
  MCOR_SINC_NEXT_D(c)

MCOR_OF_Q mcor_w_sinc6(realv q)
{
  const realv a = MCOR_SINC_A(q), t = a * ((real)2 - a);
  MCOR_SINC(MCOR_SINC_FIRST, MCOR_SINC_NEXT)
  const realv s = t * p, s3 = s * s * s;
  return s3 * s3;
}

MCOR_OF_Q mcor_dw_sinc6(realv q)
{
  const realv a = MCOR_SINC_A(q), t = a * ((real)2 - a);
  MCOR_SINC(MCOR_SINC_FIRST_D, MCOR_SINC_NEXT_D)
  const realv s = t * p, s2 = s * s;
  return (real)-3 * q * (s2 * s2 * s) * MCOR_FMA(t, d, p);
}

MCOR_OF_Q mcor_ddw_sinc6(realv q)
{
  const realv a = MCOR_SINC_A(q), t = a * ((real)2 - a), q2 = q * q;
  MCOR_SINC(MCOR_SINC_FIRST_E, MCOR_SINC_NEXT_E)
  const realv s = t * p, s2 = s * s, slope = MCOR_FMA(t, d, p), bend = MCOR_FMA(t, e, d);
  return s2 * s2 *
    MCOR_FMA((real)7.5 * q2, slope * slope, (real)3 * s * MCOR_FMA(q2, bend, -slope));
}

/* The lowest value of w, and its q: M'4 has a negative lobe with its minimum at q = 4/3. */
#define mcor_lowest_mprime4 ((real)-0.074074074074074074)
#define mcor_turning_mprime4 ((real)1.3333333333333333)

#endif
#endif
