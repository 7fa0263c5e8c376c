/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Curvature of the surface on which a field f has the value that it has at a point, from the
 * gradient g and the Hessian H of the SPH sum there. With the normal n = -g / |g|, which points to
 * lower values,
 *
 *   2 mean = div n = (g . H g - |g|^2 tr H) / |g|^3        Gaussian = g . adj(H) g / |g|^4
 *
 * so that both are those of a sphere of radius R, 1 / R and 1 / R^2, around higher values. */

/* A sum and its derivatives; per cube. */
typedef struct
{
  realv value, gradient[3];
  mcor_symmetric hessian;
} mcor_bent;

/* Derivatives of W / norm * h^3 at offset u. */
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
  w->gradient[0] = slope[0] * k[1] * k[2];
  w->gradient[1] = slope[1] * k[2] * k[0];
  w->gradient[2] = slope[2] * k[0] * k[1];
  w->hessian.xx = bend[0] * k[1] * k[2];
  w->hessian.yy = bend[1] * k[2] * k[0];
  w->hessian.zz = bend[2] * k[0] * k[1];
  w->hessian.xy = slope[0] * slope[1] * k[2];
  w->hessian.yz = slope[1] * slope[2] * k[0];
  w->hessian.zx = slope[2] * slope[0] * k[1];
#else
  const realv r2 = mcor_square(u[0], u[1], u[2]), inv_r = mcor_rsqrt(r2), q = r2 * inv_r * inv_h;
  const realv n[3] = { u[0] * inv_r, u[1] * inv_r, u[2] * inv_r };
  const realv slope = MCOR_DW(q) * inv_h, bend = MCOR_DDW(q) * inv_h * inv_h;
  /* At a particle itself, W bends alike along all axes. */
  const fixv here = q < (real)1e-4f;
  const realv across = here ? bend : slope * inv_r, along = bend - across;
  w->value = MCOR_W(q);
  w->gradient[0] = slope * n[0];
  w->gradient[1] = slope * n[1];
  w->gradient[2] = slope * n[2];
  w->hessian.xx = MCOR_FMA(along * n[0], n[0], across);
  w->hessian.yy = MCOR_FMA(along * n[1], n[1], across);
  w->hessian.zz = MCOR_FMA(along * n[2], n[2], across);
  w->hessian.xy = along * n[0] * n[1];
  w->hessian.yz = along * n[1] * n[2];
  w->hessian.zx = along * n[2] * n[0];
#endif
}

void mcor_bent_add(mcor_bent* sum, realv m, const mcor_bent* w)
{
  sum->value = MCOR_FMA(m, w->value, sum->value);
  for (int a = 0; a < 3; ++a)
  {
    sum->gradient[a] = MCOR_FMA(m, w->gradient[a], sum->gradient[a]);
  }
  sum->hessian.xx = MCOR_FMA(m, w->hessian.xx, sum->hessian.xx);
  sum->hessian.yy = MCOR_FMA(m, w->hessian.yy, sum->hessian.yy);
  sum->hessian.zz = MCOR_FMA(m, w->hessian.zz, sum->hessian.zz);
  sum->hessian.xy = MCOR_FMA(m, w->hessian.xy, sum->hessian.xy);
  sum->hessian.yz = MCOR_FMA(m, w->hessian.yz, sum->hessian.yz);
  sum->hessian.zx = MCOR_FMA(m, w->hessian.zx, sum->hessian.zx);
}

/* The derivatives of the quotient g = f / w, times the weight:
 * (f / w)'' w = f'' - g w'' - g' w' - w' g'. */
void mcor_bent_divide(mcor_bent* f, const mcor_bent* w)
{
  const realv inv_w = (real)1 / (fabs(w->value) < (real)1e-12f ? (realv)1 : w->value);
  const realv mean = f->value * inv_w;
  realv g[3];
  mcor_bent_add(f, -mean, w);
  for (int a = 0; a < 3; ++a)
  {
    g[a] = f->gradient[a] * inv_w;
  }
  f->hessian.xx -= (real)2 * g[0] * w->gradient[0];
  f->hessian.yy -= (real)2 * g[1] * w->gradient[1];
  f->hessian.zz -= (real)2 * g[2] * w->gradient[2];
  f->hessian.xy -= g[0] * w->gradient[1] + g[1] * w->gradient[0];
  f->hessian.yz -= g[1] * w->gradient[2] + g[2] * w->gradient[1];
  f->hessian.zx -= g[2] * w->gradient[0] + g[0] * w->gradient[2];
}

/* Mean and Gaussian curvature; of a line in a plane its curvature, and 0. 0 where the gradient
 * vanishes. The field is scaled first: a square of its gradient may vanish, or overflow. */
void mcor_bend_of(const mcor_bent* f, bool plane, realv* mean, realv* gauss)
{
  realv g[3];
  const realv most =
    fmax(fabs(f->gradient[0]), fmax(fabs(f->gradient[1]), plane ? (realv)0 : fabs(f->gradient[2])));
  const realv inv = (real)1 / (most > 0 ? most : (realv)1);
  for (int a = 0; a < 3; ++a)
  {
    g[a] = f->gradient[a] * inv;
  }
  mcor_symmetric h = f->hessian;
  h.xx *= inv;
  h.yy *= inv;
  h.zz *= inv;
  h.xy *= inv;
  h.yz *= inv;
  h.zx *= inv;
  if (plane)
  {
    g[2] = h.zz = h.yz = h.zx = 0;
  }
  const realv g2 = mcor_square(g[0], g[1], g[2]), inv_g = mcor_rsqrt(g2);
  const realv n[3] = { g[0] * inv_g, g[1] * inv_g, g[2] * inv_g };
  const realv bent = n[0] * (h.xx * n[0] + (real)2 * h.xy * n[1]) +
    n[1] * (h.yy * n[1] + (real)2 * h.yz * n[2]) + n[2] * (h.zz * n[2] + (real)2 * h.zx * n[0]);
  *mean = (plane ? inv_g : (real)0.5 * inv_g) * (bent - (h.xx + h.yy + h.zz));
  *gauss = inv_g * inv_g *
    (n[0] * n[0] * (h.yy * h.zz - h.yz * h.yz) + n[1] * n[1] * (h.zz * h.xx - h.zx * h.zx) +
      n[2] * n[2] * (h.xx * h.yy - h.xy * h.xy) +
      (real)2 *
        (n[0] * n[1] * (h.yz * h.zx - h.xy * h.zz) + n[1] * n[2] * (h.zx * h.xy - h.yz * h.xx) +
          n[2] * n[0] * (h.xy * h.yz - h.zx * h.yy)));
  *mean = most > 0 ? *mean : (realv)0;
  *gauss = most > 0 && !plane ? *gauss : (realv)0;
}

/* One work-item = one group of points. iso: relative to A0 for the Shepard mean. Writes their
 * curvatures, two numbers each; per cube. */
__kernel void mcor_curvature_points(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* node, __global const real4* offset,
  const real iso, const int plane, __global real* curvature)
{
  MCOR_ITEM(group, group < group_count);
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_reach reach;
  mcor_bent f, w, sum;
  realv at[3], u[3], mean, gauss;
  w.value = w.gradient[0] = w.gradient[1] = w.gradient[2] = 0;
  w.hessian.xx = w.hessian.yy = w.hessian.zz = w.hessian.xy = w.hessian.yz = w.hessian.zx = 0;
  f = w;
  mcor_group_load(&grid, groups[group], groups[group + 1], node, offset, 0, &points, &query);
  mcor_points_relative(&grid, &query, &points, at);
  mcor_tile_init(&reach.tile);
  for (bool first = true; mcor_reach_next(&grid, &query, &points, iso, &reach, first); first = false)
  {
    for (int i = 0; i < MCOR_REACH_COUNT(&reach); ++i)
    {
      mcor_points_from(at, &points, MCOR_REACH(&reach, x, i), MCOR_REACH(&reach, y, i),
        MCOR_REACH(&reach, z, i), u);
      mcor_weight_hessian(u, MCOR_REACH(&reach, inv_h, i), &sum);
#if MCOR_FIELD != 1
      mcor_bent_add(&w, MCOR_REACH(&reach, weight, i), &sum);
#endif
#if MCOR_FIELD != 2
      mcor_bent_add(&f, MCOR_REACH_TERM(&reach, i, iso), &sum);
#endif
    }
  }
#if MCOR_FIELD == 0
  mcor_bent_divide(&f, &w);
#elif MCOR_FIELD == 2
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
