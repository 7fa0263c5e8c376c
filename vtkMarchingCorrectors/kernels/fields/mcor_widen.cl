/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Widening: finds how much each particle's smoothing length may grow while the particle stays
 * inside the surface. core/fields/mcor_widen.c begins with the rule; this comment gives the reasons
 * for the rule.
 *
 * The taper, a number from 0 to 1, multiplies the growth of the length. The taper falls to 0 where
 * few neighbours are near: with longer lengths, lone drops and threads would shrink. `least` is the
 * weight sum that a particle needs: the iso value plus a margin. Without the margin, sheets would
 * get holes. At the surface of deep water, there are many neighbours, all on one side. The margin
 * is 0 there, and a particle may even be slightly outside, because each particle that has to be
 * inside would raise a bump. At the rim of a sheet, there are few neighbours, all on one side. The
 * margin is wider there: the neighbours' lengths may be longer, and a thread that hangs from the
 * rim would break. A particle in the corner of a tank has hardly more neighbours than a particle at
 * a rim, but these neighbours are widened. With its own length, the particle in the corner would
 * stick out as a knob, so the particle's factor goes most of the way to the mean factor of the
 * neighbours. A particle with more neighbours than in a corner, all on one side, is at the surface
 * of a drop, and keeps its length. */

/* The factors that are tried are this far apart. */
#define MCOR_WIDEN_STEP ((real)0.2f)

/* At the surface of deep water, the weight sum may be this far below the iso value. */
#define MCOR_WIDEN_OUTSIDE ((real)0.08f)

/* At the rim of a sheet, the margin above the iso value is wider by this share. */
#define MCOR_WIDEN_RIM ((real)0.5f)

/* Limits of the distance from a particle to the middle of its neighbours, in smoothing lengths.
 * Below the first limit, water is on both sides of the particle; beyond the second, on one side. */
#define MCOR_SIDED_FROM ((real)0.4f)
#define MCOR_SIDED_TO ((real)0.6f)

/* Particles j, one in each of the first `count` lanes. x: positions, in fixed-point units. */
typedef struct
{
  fixv x[3];
  realv inv_h, scale; /* 1 / h_j, with h_j in cubes, and in fixed-point units */
  int count, plane;
} mcor_widen_at;

/* One work-item = one sorted particle. Writes the particle's V norm (volume times the kernel's
 * norm), which is its weight times h^3. In a plane, writes V norm / h. */
__kernel void mcor_widen_sizes(const int count, const int plane, __global const real* inv_h,
  __global const real* weight, __global real* size)
{
  MCOR_ITEM(i, i < count);
  const real h = (real)1 / inv_h[i];
  size[i] = weight[i] * h * h * (plane ? (real)1 : h);
}

/* Fits the query's box to the particles from lane `from` on. Stops before a particle that is far
 * from the first, or that has a lower x than the particle before it, as at the end of a row. Sets
 * the query's radius to `support` times the largest smoothing length of these particles. Returns
 * the lane behind the last of them. */
int mcor_widen_place(
  const mcor_grid* grid, mcor_query* query, const mcor_widen_at* at, int from, real support)
{
  real coarsest = MCOR_GET(at->inv_h, from);
  const fix far = mcor_query_reach((float)(MCOR_SUPPORT / coarsest) * (float)grid->units);
  int next = from;
  for (bool near = true; near; next += near)
  {
    near = next < at->count &&
      (next == from || MCOR_GET_FIX(at->x[0], next) >= MCOR_GET_FIX(at->x[0], next - 1));
    for (int a = 0; a < 3 && near; ++a)
    {
      const fix from_first = MCOR_GET_FIX(at->x[a], next) - MCOR_GET_FIX(at->x[a], from);
      near = from_first <= far && from_first >= -far;
    }
    for (int a = 0; a < 3 && near; ++a)
    {
      const fix p = MCOR_GET_FIX(at->x[a], next);
      query->low[a] = next == from ? p : min(query->low[a], p);
      query->high[a] = next == from ? p : max(query->high[a], p);
    }
    coarsest = near ? fmin(coarsest, MCOR_GET(at->inv_h, next)) : coarsest;
  }
  mcor_query_place(grid, query, query->low);
  query->radius = (float)(support / coarsest) * 1.0001f;
  return next;
}

/* Offset of particle k from the particles j along an axis, in fixed-point units. */
#define MCOR_WIDEN_OFFSET(axis, position) MCOR_CONVERT_REALV(grid->position[k] - at->x[axis])

/* One walk over the particles makes the sums for at most this many factors s. */
#define MCOR_WIDEN_LEVELS 3

/* The crowd tells how many neighbours a particle j has, and where they are. r is the distance from
 * j to a fluid particle k. count: the sum of n = max(0, 1 - (r / (2 h_j))^3) over all k; offset:
 * the sum of n (x_k - x_j), in fixed-point units. */
typedef struct
{
  realv count, offset[3];
} mcor_crowd;

/* Finds weight sums at particles, one particle j in each lane. c[l]: the sums with the lengths
 * s[l] * h_j. s: `levels` factors, the largest first. A sum is over the particles closer to j than
 * reach * h_j, so it does not depend on other lanes. Also fills in `crowd` unless it is NULL. */
__attribute__((always_inline)) void mcor_widen_sum(const mcor_grid* grid,
  __global const real* sizes, const mcor_widen_at* at, const int levels, const real* s, real reach,
  realv* c, mcor_crowd* crowd)
{
  const realv scale2 = at->scale * at->scale;
  real inv_s[MCOR_WIDEN_LEVELS];
  realv part[MCOR_WIDEN_LEVELS];
  mcor_query query;
  mcor_tile tile;
  for (int l = 0; l < levels; ++l)
  {
    inv_s[l] = (real)1 / s[l];
  }
  for (int lane = 0, next; lane < at->count; lane = next)
  {
    mcor_crowd around = { 0, { 0, 0, 0 } };
    for (int l = 0; l < levels; ++l)
    {
      part[l] = 0;
    }
    next = mcor_widen_place(grid, &query, at, lane, reach);
    mcor_tile_init(&tile);
    for (bool first = true; mcor_tile_next(grid, &query, &tile, first); first = false)
    {
      for (int i = 0; i < tile.count; ++i)
      {
        const int k = MCOR_INDEX(&tile, i);
        const realv dx = MCOR_WIDEN_OFFSET(0, px), dy = MCOR_WIDEN_OFFSET(1, py),
                    dz = MCOR_WIDEN_OFFSET(2, pz);
        const realv q2 = mcor_square(dx, dy, dz) * scale2, q = mcor_sqrt(q2);
        const realv size = MCOR_TENSOR || !crowd || q < (realv)reach ? (realv)sizes[k] : (realv)0;
        for (int l = 0; l < levels; ++l)
        {
          const realv w =
            mcor_weight(MCOR_TENSOR ? mcor_distance(dx, dy, dz, at->scale * inv_s[l]) : q, inv_s[l]);
          part[l] = MCOR_FMA(size, w, part[l]);
        }
        if (crowd && sizes[k] > 0)
        {
          const realv near = fmax(MCOR_FMA(q2 * (real)-0.125f, q, (realv)1), (realv)0);
          around.count += near;
          around.offset[0] = MCOR_FMA(near, dx, around.offset[0]);
          around.offset[1] = MCOR_FMA(near, dy, around.offset[1]);
          around.offset[2] = MCOR_FMA(near, dz, around.offset[2]);
        }
      }
    }
    const fixv inside = mcor_lane_index() >= (fixv)lane && mcor_lane_index() < (fixv)next;
    for (int l = 0; l < levels; ++l)
    {
      const realv inv = at->inv_h * inv_s[l];
      c[l] = inside ? part[l] * inv * inv * (at->plane ? (realv)1 : inv) : c[l];
    }
    if (crowd)
    {
      crowd->count = inside ? around.count : crowd->count;
      for (int a = 0; a < 3; ++a)
      {
        crowd->offset[a] = inside ? around.offset[a] : crowd->offset[a];
      }
    }
  }
}

/* Returns a value that rises smoothly from 0 at x = from to 1 at x = to. */
realv mcor_widen_ramp(realv x, real from, real to)
{
  const realv t = clamp((x - from) / (to - from), (realv)0, (realv)1);
  return t * t * (3 - 2 * t);
}

/* One work-item = MCOR_LANES sorted particles. Reads the grid and sizes. Writes to `least` the
 * weight sum that each particle needs. Writes a particle's factor if the weight sum suffices with
 * the widest factor, or if the taper (see the top of this file) is 0. For all other particles,
 * writes 1 to `wanted`, and the taper in place of the factor. */
__kernel void mcor_widen_try(MCOR_GRID_PARAMS, const int plane, const real widest, const real iso,
  const real margin, const real crowd_from, const real crowd_to, __global const real* sizes,
  __global real* factor, __global real* least, __global int* wanted)
{
  MCOR_ITEM(item, (long)item * MCOR_LANES < particle_count);
  const mcor_grid grid = MCOR_GRID;
  const int begin = item * MCOR_LANES;
  const realv inv_h = MCOR_LOAD(begin, p_inv_h);
  const mcor_widen_at at = {
    { MCOR_LOAD_FIX(begin, px), MCOR_LOAD_FIX(begin, py), MCOR_LOAD_FIX(begin, pz) }, inv_h,
    grid.unit * inv_h, min(MCOR_LANES, particle_count - begin), plane
  };
  /* Only tensor kernels have negative terms. With other kernels, the nearest particles alone make
   * the sum large enough inside the fluid, so particles farther away are left out. */
  const real reach = MCOR_TENSOR ? MCOR_SUPPORT * widest
                                 : fmax(MCOR_SUPPORT * widest * (real)0.54f, (real)2);
  mcor_crowd crowd = { 1, { 0, 0, 0 } };
  realv c = 0;
  mcor_widen_sum(&grid, sizes, &at, 1, &widest, reach, &c, &crowd);
  const realv others = crowd.count - 1; /* without the particle itself */
  const realv taper = mcor_widen_ramp(others, crowd_from, crowd_to);
  const realv middle = mcor_sqrt(mcor_square(crowd.offset[0], crowd.offset[1], crowd.offset[2])) *
    at.scale / fmax(others, (realv)1);
  const realv deep = mcor_widen_ramp(others, crowd_to, (real)(4 / 3.0f) * crowd_to);
  const realv sided = mcor_widen_ramp(middle, MCOR_SIDED_FROM, MCOR_SIDED_TO) *
    MCOR_FMA((realv)(1 + MCOR_WIDEN_RIM), deep, (realv)-MCOR_WIDEN_RIM);
  const realv needed = MCOR_FMA((realv)margin, 1 - sided, (realv)iso);
  const fixv known = c >= needed || taper <= (realv)0;
  const realv result = known ? MCOR_FMA((realv)(widest - 1), taper, (realv)1) : taper;
  for (int lane = 0; lane < at.count; ++lane)
  {
    factor[begin + lane] = MCOR_GET(result, lane);
    least[begin + lane] = MCOR_GET(needed, lane);
    wanted[begin + lane] = !MCOR_GET_FIX(known, lane);
  }
}

/* One work-item = MCOR_LANES listed particles. Reads each particle's taper from `factor`, and from
 * `least` the weight sum that the particle needs. Replaces the taper by the particle's factor.
 * Writes to `outside` whether the weight sum is below the iso value even with the widest factor. */
__kernel void mcor_widen_solve(MCOR_GRID_PARAMS, const int plane, const real widest, const real iso,
  const real margin, __global const real* least, __global const real* sizes, const int listed,
  __global const int* list, __global real* factor, __global int* outside)
{
  MCOR_ITEM(item, (long)item * MCOR_LANES < listed);
  const mcor_grid grid = MCOR_GRID;
  const int begin = item * MCOR_LANES;
  const int count = min(MCOR_LANES, listed - begin);
  fix x[3][MCOR_LANES];
  real of_h[MCOR_LANES], share[MCOR_LANES], sum[MCOR_LANES];
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int i = list[begin + min(lane, count - 1)];
    x[0][lane] = px[i];
    x[1][lane] = py[i];
    x[2][lane] = pz[i];
    of_h[lane] = p_inv_h[i];
    share[lane] = factor[i];
    sum[lane] = least[i];
  }
  const realv inv_h = MCOR_LOAD(0, of_h);
  const mcor_widen_at at = {
    { MCOR_LOAD(0, x[0]), MCOR_LOAD(0, x[1]), MCOR_LOAD(0, x[2]) }, inv_h,
    grid.unit * inv_h, count, plane
  };
  realv needed = MCOR_LOAD(0, sum), with_widest = 0;
  mcor_widen_sum(
    &grid, sizes, &at, 1, &widest, MCOR_SUPPORT * widest, &with_widest, NULL);
  const realv sided = fmax((iso + margin - needed) / margin, (realv)0);
  needed -= sided * MCOR_WIDEN_OUTSIDE *
    mcor_widen_ramp(with_widest, iso - 2 * MCOR_WIDEN_OUTSIDE, iso - MCOR_WIDEN_OUTSIDE);
  fixv found = mcor_lane_index() >= (fixv)count || with_widest >= needed;
  realv s = with_widest >= needed ? (realv)widest : (realv)1, above = with_widest;
  real upper = widest;
  for (int step = (int)ceil((widest - 1) / MCOR_WIDEN_STEP) - 1; step >= 0 && MCOR_ANY(!found);
       step -= MCOR_WIDEN_LEVELS)
  {
    real level[MCOR_WIDEN_LEVELS];
    realv c[MCOR_WIDEN_LEVELS];
    for (int l = 0; l < MCOR_WIDEN_LEVELS; ++l)
    {
      level[l] = 1 + (real)max(step - l, 0) * MCOR_WIDEN_STEP;
      c[l] = 0;
    }
    mcor_widen_sum(
      &grid, sizes, &at, MCOR_WIDEN_LEVELS, level, MCOR_SUPPORT * level[0], c, NULL);
    for (int l = 0; l < MCOR_WIDEN_LEVELS; ++l)
    {
      const fixv here = !found && c[l] >= needed;
      s = here ? level[l] + (c[l] - needed) / (c[l] - above) * (upper - level[l]) : s;
      found = found || here;
      above = c[l];
      upper = level[l];
    }
  }
  s = MCOR_FMA(s - 1, MCOR_LOAD(0, share), (realv)1);
  for (int lane = 0; lane < count; ++lane)
  {
    factor[list[begin + lane]] = MCOR_GET(s, lane);
    outside[list[begin + lane]] = MCOR_GET(with_widest, lane) < iso;
  }
}

/* Whether all particles that may reach the query's box have the widest factor, so that the mean
 * factor in the box is the widest factor. Nearly all groups of particles are deep inside the fluid,
 * where the answer is yes. */
bool mcor_widen_is_plain(
  const mcor_grid* grid, mcor_query* query, __global const real* factor, real widest)
{
  bool plain = true;
  for (bool some = mcor_query_next_level(grid, query, 0);
       some && plain && mcor_query_next_row(grid, query);)
  {
    for (int k = query->begin; k < query->end && plain; k += MCOR_LANES)
    {
      const fixv beyond = mcor_lane_index() >= (fixv)(query->end - k);
      plain = !MCOR_ANY(!(beyond || MCOR_LOAD(k, factor) == (realv)widest));
    }
    query->begin = query->end;
  }
  return plain;
}

/* One work-item = MCOR_LANES sorted particles. Reads factors, and from `limited` the weight sum
 * that each particle needs. Writes new factors to `limited`. If the mean factor around a particle
 * is lower than the particle's factor, the factor becomes the mean, but at least 1. A factor of 1
 * becomes 1 + share * (mean - 1), where `share` is above 0 only for a particle in a corner. The
 * mean is computed as `widest` less the mean of (widest - factor), so it is exact if all factors
 * are `widest`. */
__kernel void mcor_widen_limit(MCOR_GRID_PARAMS, const real widest, const real iso,
  const real margin, __global const real* factor, __global real* limited)
{
  MCOR_ITEM(item, (long)item * MCOR_LANES < particle_count);
  const mcor_grid grid = MCOR_GRID;
  const int begin = item * MCOR_LANES;
  const int end = min(begin + MCOR_LANES, particle_count);
  const realv own = MCOR_LOAD(begin, factor);
  const fixv x[3] = { MCOR_LOAD_FIX(begin, px), MCOR_LOAD_FIX(begin, py),
    MCOR_LOAD_FIX(begin, pz) };
  realv lacks = 0, weights = 0;
  mcor_query query;
  mcor_tile tile;
  for (int row = begin, next; row < end; row = next)
  {
    real coarsest;
    next = row + mcor_query_particles(&grid, &query, row, end, &coarsest);
    query.radius = -1;
    if (mcor_widen_is_plain(&grid, &query, factor, widest))
    {
      continue;
    }
    const fixv lane = mcor_lane_index();
    const fixv inside = lane >= (fixv)(row - begin) && lane < (fixv)(next - begin);
    realv lack = 0, weight = 0;
    mcor_tile_init(&tile);
    for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)
    {
      for (int i = 0; i < tile.count; ++i)
      {
        const int k = MCOR_INDEX(&tile, i);
        const realv dx = MCOR_CONVERT_REALV(px[k] - x[0]) * grid.unit,
                    dy = MCOR_CONVERT_REALV(py[k] - x[1]) * grid.unit,
                    dz = MCOR_CONVERT_REALV(pz[k] - x[2]) * grid.unit;
        const realv w = p_weight[k] *
          mcor_weight(mcor_distance(dx, dy, dz, p_inv_h[k]), (realv)p_inv_h[k]);
        weight += w;
        lack = MCOR_FMA(w, (realv)(widest - factor[k]), lack);
      }
    }
    lacks = inside ? lack : lacks;
    weights = inside ? weight : weights;
  }
  const realv mean = weights > (realv)0 ? widest - lacks / weights : own;
  const realv sided = fmax((iso + margin - MCOR_LOAD(begin, limited)) / margin, (realv)0);
  const realv share = fmax(4 * sided * (1 - sided), (realv)0);
  const realv lowered = fmax(fmin(own, mean), (realv)1);
  const realv result =
    own == (realv)1 ? MCOR_FMA(share, fmax(mean, (realv)1) - 1, (realv)1) : lowered;
  MCOR_STORE(result, begin, limited);
}

/* One work-item = MCOR_LANES sorted particles. Reads the factors; from `listed`, which particles
 * mcor_widen_solve has treated; and what it has written to `outside`. Writes to `outside` whether
 * each particle is inside with its own length (the weight sum is at least the iso value), but
 * outside with the length times the factor (the weight sum is below the iso value). */
__kernel void mcor_widen_check(MCOR_GRID_PARAMS, const int plane, const real widest, const real iso,
  __global const real* sizes, __global const real* factor, __global const int* listed,
  __global int* outside)
{
  MCOR_ITEM(item, (long)item * MCOR_LANES < particle_count);
  const mcor_grid grid = MCOR_GRID;
  const int begin = item * MCOR_LANES;
  const int count = min(MCOR_LANES, particle_count - begin);
  const realv s = MCOR_LOAD(begin, factor), inv_h = MCOR_LOAD(begin, p_inv_h), one = 1;
  fixv open = s > one && s < (realv)widest;
  for (int lane = 0; lane < count; ++lane)
  {
    const int i = begin + lane;
    const bool left = listed[i] != listed[i + 1] && outside[i];
    open = mcor_lane_index() == (fixv)lane && left ? s > one : open;
  }
  open = open && mcor_lane_index() < (fixv)count;
  for (int way = 0; way < 2 && MCOR_ANY(open); ++way)
  {
    const realv inv = way == 0 ? inv_h / s : inv_h;
    const mcor_widen_at at = {
      { MCOR_LOAD_FIX(begin, px), MCOR_LOAD_FIX(begin, py), MCOR_LOAD_FIX(begin, pz) }, inv,
      grid.unit * inv, count, plane
    };
    const real level = 1;
    realv c = 0;
    mcor_widen_sum(&grid, sizes, &at, 1, &level, MCOR_SUPPORT, &c, NULL);
    open = open && (way == 0 ? c < (realv)iso : c >= (realv)iso);
  }
  for (int lane = 0; lane < count; ++lane)
  {
    outside[begin + lane] = MCOR_GET_FIX(open, lane) != 0;
  }
}
