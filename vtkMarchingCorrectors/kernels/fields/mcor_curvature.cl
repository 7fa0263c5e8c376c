/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Curvature at a point: the curvature of the field's iso surface through this point. It is computed
 * from the gradient g and the Hessian H of the field at the point. With the normal n = -g / |g|,
 * which points to lower values,
 *
 *   2 mean = div n = (g . H g - |g|^2 tr H) / |g|^3        Gaussian = g . adj(H) g / |g|^4
 *
 * For a sphere of radius R around higher values, the mean is 1 / R, the Gaussian 1 / R^2. */

/* A sum and its derivatives; the unit of length is a cube. Elements of the Hessian: xx, yy, zz, xy,
 * yz, zx. */
typedef struct
{
  realv value, gradient[3], hessian[6];
} mcor_bent;

/* Finds W / norm * h^3 and its derivatives at offset u. */
void mcor_weight_hessian(const realv u[3], realv inv_h, mcor_bent* w)
{
#if MCOR_TENSOR
  realv k[3], slope[3], bend[3];
  for (int a = 0; a < 3; ++a)
  {
    const realv q = fabs(u[a]) * inv_h;
    k[a] = MCOR_W(q);
    slope[a] = sign(u[a]) * MCOR_DW(q) * inv_h;
    bend[a] = MCOR_DDW(q) * inv_h * inv_h;
  }
  w->value = k[0] * k[1] * k[2];
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    w->gradient[a] = slope[a] * k[b] * k[c];
    w->hessian[a] = bend[a] * k[b] * k[c];
    w->hessian[3 + a] = slope[a] * slope[b] * k[c];
  }
#else
  const realv r2 = mcor_square(u[0], u[1], u[2]), inv_r = mcor_rsqrt(r2), q = r2 * inv_r * inv_h;
  const realv n[3] = { u[0] * inv_r, u[1] * inv_r, u[2] * inv_r };
  const realv slope = MCOR_DW(q) * inv_h, bend = MCOR_DDW(q) * inv_h * inv_h;
  /* At a particle itself, the second derivative of W is the same along all axes. */
  const fixv here = q < (real)1e-4f;
  const realv across = here ? bend : slope * inv_r, along = bend - across;
  w->value = MCOR_W(q);
  for (int a = 0; a < 3; ++a)
  {
    w->gradient[a] = slope * n[a];
    w->hessian[a] = MCOR_FMA(along * n[a], n[a], across);
    w->hessian[3 + a] = along * n[a] * n[(a + 1) % 3];
  }
#endif
}

void mcor_bent_add(mcor_bent* sum, realv m, const mcor_bent* w)
{
  sum->value = MCOR_FMA(m, w->value, sum->value);
  for (int a = 0; a < 3; ++a)
  {
    sum->gradient[a] = MCOR_FMA(m, w->gradient[a], sum->gradient[a]);
    sum->hessian[a] = MCOR_FMA(m, w->hessian[a], sum->hessian[a]);
    sum->hessian[3 + a] = MCOR_FMA(m, w->hessian[3 + a], sum->hessian[3 + a]);
  }
}

/* Replaces the derivatives of f by the derivatives of the quotient g = f / w, times w: (f / w)'' w
 * = f'' - g w'' - g' w' - w' g'. */
void mcor_bent_divide(mcor_bent* f, const mcor_bent* w)
{
  const realv inv_w = (real)1 / (fabs(w->value) < (real)1e-12f ? (realv)1 : w->value);
  const realv mean = f->value * inv_w;
  mcor_bent_add(f, -mean, w);
  const realv g[3] = { f->gradient[0] * inv_w, f->gradient[1] * inv_w, f->gradient[2] * inv_w };
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3;
    f->hessian[a] -= (real)2 * g[a] * w->gradient[a];
    f->hessian[3 + a] -= g[a] * w->gradient[b] + g[b] * w->gradient[a];
  }
}

/* Finds the mean and the Gaussian curvature. In a plane, *mean is the line's curvature, and *gauss
 * is 0. Both curvatures are 0 if the gradient vanishes. The field is scaled first, because a square
 * of its gradient may underflow or overflow. */
void mcor_bend_of(const mcor_bent* f, bool plane, realv* mean, realv* gauss)
{
  realv g[3], h[6];
  const realv most =
    fmax(fabs(f->gradient[0]), fmax(fabs(f->gradient[1]), plane ? (realv)0 : fabs(f->gradient[2])));
  const realv inv = (real)1 / (most > 0 ? most : (realv)1);
  for (int a = 0; a < 3; ++a)
  {
    g[a] = f->gradient[a] * inv;
    h[a] = f->hessian[a] * inv;
    h[3 + a] = f->hessian[3 + a] * inv;
  }
  if (plane)
  {
    g[2] = h[2] = h[4] = h[5] = 0;
  }
  const realv g2 = mcor_square(g[0], g[1], g[2]), inv_g = mcor_rsqrt(g2);
  const realv n[3] = { g[0] * inv_g, g[1] * inv_g, g[2] * inv_g };
  const realv bent = n[0] * (h[0] * n[0] + (real)2 * h[3] * n[1]) +
    n[1] * (h[1] * n[1] + (real)2 * h[4] * n[2]) + n[2] * (h[2] * n[2] + (real)2 * h[5] * n[0]);
  *mean = (plane ? inv_g : (real)0.5 * inv_g) * (bent - (h[0] + h[1] + h[2]));
  *gauss = inv_g * inv_g *
    (n[0] * n[0] * (h[1] * h[2] - h[4] * h[4]) + n[1] * n[1] * (h[2] * h[0] - h[5] * h[5]) +
      n[2] * n[2] * (h[0] * h[1] - h[3] * h[3]) +
      (real)2 *
        (n[0] * n[1] * (h[4] * h[5] - h[3] * h[2]) + n[1] * n[2] * (h[5] * h[3] - h[4] * h[0]) +
          n[2] * n[0] * (h[3] * h[4] - h[5] * h[1])));
  *mean = most > 0 ? *mean : (realv)0;
  *gauss = most > 0 && !plane ? *gauss : (realv)0;
}

/* One work-item = one group of points. Writes the mean and the Gaussian curvature at each point;
 * the unit of length is a cube. iso: the iso value; for a Shepard mean, less A0, the shift of the
 * particles' values. */
__kernel void mcor_curvature_points(MCOR_GROUP_PARAMS, __global const real4* offset,
  const real iso, const int plane, __global real* curvature)
{
  MCOR_GROUP_ITEM(0);
  mcor_bent f = { 0, { 0, 0, 0 }, { 0, 0, 0, 0, 0, 0 } }, w = f, sum;
  realv at[3], u[3], mean, gauss;
  mcor_points_relative(&grid, &query, &points, at);
  for (bool first = true; mcor_reach_next(&grid, &query, &points, iso, &reach, first); first = false)
  {
    for (int i = 0; i < MCOR_REACH_COUNT(&reach); ++i)
    {
      MCOR_REACH_FROM(at, &points, &reach, i, u);
      mcor_weight_hessian(u, MCOR_REACH(&reach, inv_h, i), &sum);
#if MCOR_FIELD != MCOR_SUM
      mcor_bent_add(&w, MCOR_REACH(&reach, weight, i), &sum);
#endif
#if MCOR_FIELD != MCOR_WEIGHT_SUM
      mcor_bent_add(&f, MCOR_REACH_TERM(&reach, i, iso), &sum);
#endif
    }
  }
#if MCOR_FIELD == MCOR_SHEPARD
  mcor_bent_divide(&f, &w);
#elif MCOR_FIELD == MCOR_WEIGHT_SUM
  f = w;
#endif
  mcor_bend_of(&f, plane, &mean, &gauss);
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const long v = points.index[lane];
    if (v >= 0)
    {
      curvature[2 * v] = MCOR_GET(mean, lane);
      curvature[2 * v + 1] = MCOR_GET(gauss, lane);
    }
  }
}
