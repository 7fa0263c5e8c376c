/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Widening: by how much each particle's smoothing length may grow so that the particle stays inside of the surface.
 *
 * c(s) = sum V_k W(x_j - x_k, s h_j) is the weight sum at particle j with its own length s h_j. The factor is the
 * greatest s in [1, widest] for which c(s) is at least `least`, between steps of 0.2 by linear interpolation. It
 * falls back to 1 where few neighbours are near: lone drops and threads would shrink. */
#define MCOR_WIDEN_STEP ((real)0.2f)

typedef struct
{
  real h_scale, widest, least; /* h_scale: of the grid's lengths, which are s h_j for s = h_scale */
  int plane;
  realv scale, inv_h; /* 1 / h_j, in the unit of positions, and in cubes */
  fixv x[3];
} mcor_widen_at;

/* Adds the particles within `share` of the supports of s h_j: c(s), and, unless NULL, the crowd
 * sum max(0, 1 - (r / 2 h_j)^3). Each lane has its own reach, so that its sum does not depend on the others. */
realv mcor_widen_sum(
  const mcor_grid* grid, int begin, int end, const mcor_widen_at* at, real s, real share, realv* crowd)
{
  const real inv_s = (real)1 / s;
  realv sum = 0;
  mcor_query query;
  mcor_tile tile;
  for (int row = begin, next; row < end; row = next)
  {
    real coarsest;
    next = row + mcor_query_particles(grid, &query, row, end, &coarsest);
    query.radius = (float)(MCOR_SUPPORT * s * share / (coarsest * at->h_scale)) * 1.0001f;
    const fixv lane = mcor_lane_index();
    const fixv inside = lane >= (fixv)(row - begin) && lane < (fixv)(next - begin);
    mcor_tile_init(&tile);
    for (bool first = true; mcor_tile_next(grid, &query, &tile, first); first = false)
    {
      for (int i = 0; i < tile.count; ++i)
      {
        const int k = MCOR_INDEX(&tile, i);
        const realv dx = MCOR_CONVERT_REALV(grid->px[k] - at->x[0]) * at->scale;
        const realv dy = MCOR_CONVERT_REALV(grid->py[k] - at->x[1]) * at->scale;
        const realv dz = MCOR_CONVERT_REALV(grid->pz[k] - at->x[2]) * at->scale;
        const realv q = mcor_sqrt(mcor_square(dx, dy, dz));
        const realv ratio = at->inv_h * (inv_s / grid->inv_h[k]);
        const realv size = grid->weight[k] * ratio * ratio * (at->plane ? (realv)1 : ratio);
        const realv w = mcor_weight(mcor_distance(dx, dy, dz, inv_s), inv_s);
        const fixv counts = inside && (MCOR_TENSOR || q < (realv)(MCOR_SUPPORT * s * share));
        sum = MCOR_FMA(counts ? size : (realv)0, w, sum);
        if (crowd)
        {
          const realv r = q * (real)0.5f;
          const realv near = fmax((real)1 - r * r * r, (realv)0);
          *crowd += inside && grid->weight[k] > 0 ? near : (realv)0;
        }
      }
    }
  }
  return sum;
}

/* The greatest s on the steps below `widest`, whose c is `above` and too low; lanes of `found` are done. */
realv mcor_widen_solve(
  const mcor_grid* grid, int begin, int end, const mcor_widen_at* at, realv above, fixv found)
{
  realv s = found ? (realv)at->widest : (realv)1;
  real upper = at->widest;
  for (int step = (int)ceil((at->widest - 1) / MCOR_WIDEN_STEP) - 1;
       step >= 0 && MCOR_ANY(!found); --step)
  {
    const real lower = 1 + (real)step * MCOR_WIDEN_STEP;
    const realv c = mcor_widen_sum(grid, begin, end, at, lower, 1, NULL);
    const fixv here = !found && c >= (realv)at->least;
    s = here ? MCOR_FMA((c - at->least) / (c - above), (realv)(upper - lower), (realv)lower) : s;
    found = found || here;
    above = c;
    upper = lower;
  }
  return s;
}

/* One work-item = MCOR_LANES sorted particles. Reads the grid. Writes each particle's factor. */
__kernel void mcor_widen_factors(MCOR_GRID_PARAMS, const real h_scale, const int plane,
  const real widest, const real least, const real crowd_from, const real crowd_to,
  __global real* factor)
{
  const mcor_grid grid = MCOR_GRID;
  const int begin = get_global_id(0) * MCOR_LANES;
  if (begin >= particle_count)
  {
    return;
  }
  const int end = min(begin + MCOR_LANES, particle_count);
  const realv inv_h = MCOR_LOAD(begin, p_inv_h) * h_scale;
  const mcor_widen_at at = { h_scale, widest, least, plane, grid.unit * inv_h, inv_h,
    { MCOR_LOAD_FIX(begin, px), MCOR_LOAD_FIX(begin, py), MCOR_LOAD_FIX(begin, pz) } };
  /* Terms are not negative, so that inside of the fluid a part of the sum, and of the particles, will do. */
  const real share = MCOR_TENSOR ? (real)1 : fmax((real)0.6f, 1 / widest);
  realv crowd = 0, c = mcor_widen_sum(&grid, begin, end, &at, widest, share, &crowd);
  fixv found = c >= (realv)least || mcor_lane_index() >= (fixv)(end - begin);
  if (share < 1 && MCOR_ANY(!found))
  {
    c = mcor_widen_sum(&grid, begin, end, &at, widest, 1, NULL);
    found = found || c >= (realv)least;
  }
  const realv s = mcor_widen_solve(&grid, begin, end, &at, c, found);
  const realv t = clamp((crowd - 1 - crowd_from) / (crowd_to - crowd_from), (realv)0, (realv)1);
  const realv result = MCOR_FMA(s - 1, t * t * (3 - 2 * t), (realv)1);
#if MCOR_LANES == 1
  factor[begin] = result;
#else
  MCOR_CAT(vstore, MCOR_LANES)(result, 0, factor + begin);
#endif
}
