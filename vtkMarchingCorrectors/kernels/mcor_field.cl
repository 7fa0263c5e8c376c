/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What a particle adds to the SPH field at a point. */

/* Roots. CPU vector units take longer for a square root and a division than for all the rest of a
 * kernel sum. From an integer guess y, whose error e = 1 - x y^2 is below 0.07, and
 *
 *   1 / sqrt(x) = y / sqrt(1 - e) = y (1 + e p(e))
 *
 * with p a minimax polynomial (2.4e-8), come results that are the same on every CPU, to 1 ulp or
 * so. */
#if MCOR_CPU && !MCOR_DOUBLE
realv mcor_rsqrt_guess(realv x)
{
  return MCOR_AS_REALV((fixv)0x5f375a86 - (MCOR_AS_FIXV(x) >> 1));
}

/* p(e) */
realv mcor_rsqrt_series(realv e)
{
  const realv p = (real)0.31393823f + e * (real)0.2740815f;
  return (real)0.49999833f + e * ((real)0.37500035f + e * p);
}

/* 1 / sqrt(x), finite at 0. */
realv mcor_rsqrt(realv x)
{
  const realv y = mcor_rsqrt_guess(x), e = (real)1 - (x * y) * y;
  return y + (e * y) * mcor_rsqrt_series(e);
}

realv mcor_sqrt(realv x)
{
  const realv y = mcor_rsqrt_guess(x), r = x * y, e = (real)1 - r * y;
  return r + (e * r) * mcor_rsqrt_series(e);
}
#else
realv mcor_rsqrt(realv x)
{
  return rsqrt(fmax(x, (realv)1e-30f));
}

realv mcor_sqrt(realv x)
{
  return sqrt(x);
}
#endif

/* W / norm * h^3 at offset (dx, dy, dz). In two steps, to be made for MCOR_STEP particles in turn:
 * as a chain, they take longer than a CPU can look ahead. */
#define MCOR_STEP (MCOR_LANES == 1 ? 1 : 32)

/* Of a tensor kernel, the weight itself. */
realv mcor_distance(realv dx, realv dy, realv dz, realv inv_h)
{
#if MCOR_TENSOR
  return MCOR_W(fabs(dx) * inv_h) * MCOR_W(fabs(dy) * inv_h) * MCOR_W(fabs(dz) * inv_h);
#else
  return mcor_sqrt(dx * dx + dy * dy + dz * dz);
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

/* The same, and the gradient with respect to (dx, dy, dz); again in two steps. */
typedef struct
{
  realv x, y, z, r2, inv_r;
} mcor_offset;

mcor_offset mcor_offset_of(const realv d[3])
{
#if MCOR_TENSOR
  const realv r2 = 0, inv_r = 0; /* not needed */
#else
  const realv r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], inv_r = mcor_rsqrt(r2);
#endif
  const mcor_offset offset = { d[0], d[1], d[2], r2, inv_r };
  return offset;
}

realv mcor_weight_gradient(const mcor_offset* d, realv inv_h, realv* gx, realv* gy, realv* gz)
{
#if MCOR_TENSOR
  const realv qx = fabs(d->x) * inv_h, qy = fabs(d->y) * inv_h, qz = fabs(d->z) * inv_h;
  const realv wx = MCOR_W(qx), wy = MCOR_W(qy), wz = MCOR_W(qz);
  *gx = sign(d->x) * MCOR_DW(qx) * wy * wz * inv_h;
  *gy = sign(d->y) * MCOR_DW(qy) * wx * wz * inv_h;
  *gz = sign(d->z) * MCOR_DW(qz) * wx * wy * inv_h;
  return wx * wy * wz;
#else
  /* 1 / r being finite at r = 0, the gradient is 0 there: for the quadratic kernel, whose slope is
   * not, by definition. */
  const realv q = d->r2 * (d->inv_r * inv_h);
  const realv slope = MCOR_DW(q) * (d->inv_r * inv_h);
  *gx = slope * d->x;
  *gy = slope * d->y;
  *gz = slope * d->z;
  return MCOR_W(q);
#endif
}
