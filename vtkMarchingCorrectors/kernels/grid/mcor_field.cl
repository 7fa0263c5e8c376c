/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* A particle's contribution to the SPH field at a point. */

/* Roots. CPU vector units take longer for a square root and a division than for the rest of a
 * kernel sum. So the root is made from an integer guess y, whose error e = 1 - x y^2 is below 0.07:
 *
 *   1 / sqrt(x) = y / sqrt(1 - e) = y (1 + e p(e))
 *
 * with p a minimax polynomial (error 2.4e-8). The result is off by about 1 ulp, and the same on
 * every device, unlike OpenCL's rsqrt. Double precision uses sqrt, which is correctly rounded. */
#if !MCOR_DOUBLE
realv mcor_rsqrt_guess(realv x)
{
  return MCOR_AS_REALV((fixv)0x5f375a86 - (MCOR_AS_FIXV(x) >> 1));
}

/* Returns p(e), the polynomial in the comment above. */
realv mcor_rsqrt_series(realv e)
{
  const realv p = MCOR_FMA(e, (real)0.2740815f, (real)0.31393823f);
  return MCOR_FMA(e, MCOR_FMA(e, p, (real)0.37500035f), (real)0.49999833f);
}

/* Returns 1 / sqrt(x), finite at 0. */
realv mcor_rsqrt(realv x)
{
  const realv y = mcor_rsqrt_guess(x), e = MCOR_FMA(-(x * y), y, (real)1);
  return MCOR_FMA(e * y, mcor_rsqrt_series(e), y);
}

realv mcor_sqrt(realv x)
{
  const realv y = mcor_rsqrt_guess(x), r = x * y, e = MCOR_FMA(-r, y, (real)1);
  return MCOR_FMA(e * r, mcor_rsqrt_series(e), r);
}
#else
realv mcor_rsqrt(realv x)
{
  return (real)1 / sqrt(fmax(x, (realv)1e-30f));
}

realv mcor_sqrt(realv x)
{
  return sqrt(x);
}
#endif

realv mcor_square(realv x, realv y, realv z)
{
  return MCOR_FMA(z, z, MCOR_FMA(y, y, x * x));
}

/* W / norm * h^3 at offset (dx, dy, dz) is made in two steps, mcor_distance and mcor_weight. A loop
 * makes the first step for MCOR_STEP particles, then another loop makes the second step for all of
 * them, because a CPU cannot look ahead over both steps. */
#define MCOR_STEP (MCOR_LANES == 1 ? 1 : 32)

/* Returns the distance; for a tensor kernel, the weight itself. */
realv mcor_distance(realv dx, realv dy, realv dz, realv inv_h)
{
#if MCOR_TENSOR
  return MCOR_W(fabs(dx) * inv_h) * MCOR_W(fabs(dy) * inv_h) * MCOR_W(fabs(dz) * inv_h);
#else
  return mcor_sqrt(mcor_square(dx, dy, dz));
#endif
}

realv mcor_weight(realv distance, realv inv_h)
{
#if MCOR_TENSOR
  return distance;
#else
  return MCOR_W(distance * inv_h);
#endif
}

/* W / norm * h^3 and its gradient with respect to the offset d are also made in two steps,
 * mcor_length_of and mcor_weight_gradient. */
typedef struct
{
  realv r2, inv_r;
} mcor_length;

mcor_length mcor_length_of(const realv d[3])
{
#if MCOR_TENSOR
  const realv r2 = 0, inv_r = 0; /* not needed */
#else
  const realv r2 = mcor_square(d[0], d[1], d[2]), inv_r = mcor_rsqrt(r2);
#endif
  const mcor_length length = { r2, inv_r };
  return length;
}

/* Returns the weight. Its gradient is slope * along; the caller can multiply the slope by other
 * factors, which costs less than multiplying a vector. */
realv mcor_weight_gradient(
  const realv d[3], const mcor_length* length, realv inv_h, realv* slope, realv along[3])
{
#if MCOR_TENSOR
  const realv q[3] = { fabs(d[0]) * inv_h, fabs(d[1]) * inv_h, fabs(d[2]) * inv_h };
  const realv w[3] = { MCOR_W(q[0]), MCOR_W(q[1]), MCOR_W(q[2]) };
  *slope = 1;
  along[0] = sign(d[0]) * MCOR_DW(q[0]) * w[1] * w[2] * inv_h;
  along[1] = sign(d[1]) * MCOR_DW(q[1]) * w[0] * w[2] * inv_h;
  along[2] = sign(d[2]) * MCOR_DW(q[2]) * w[0] * w[1] * inv_h;
  return w[0] * w[1] * w[2];
#else
  /* At r = 0, inv_r is finite and d is 0, so the gradient is 0. The quadratic kernel's slope is not
   * 0 there, but its gradient is defined as 0. */
  const realv per_r = length->inv_r * inv_h, q = length->r2 * per_r;
  *slope = MCOR_DW(q) * per_r;
  along[0] = d[0];
  along[1] = d[1];
  along[2] = d[2];
  return MCOR_W(q);
#endif
}
