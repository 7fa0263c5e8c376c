/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Other particle arrays at the surface's points [III-D.4]. */


/* A lower sum of weights has no digits that could be divided by. */
#define MCOR_LEAST_SUM ((real)1e-30f)

/* Sorted arrays, `stride` elements long, one after the other, at most MCOR_ATTRIBUTE_LIMIT. Their
 * means at a point lie one after the other, too. */
#define MCOR_ATTRIBUTE_PARAMS                                                                      \
  const int attribute_count, const int stride, __global const real *attributes, __global real *means

#define MCOR_ATTRIBUTE_ARGS attribute_count, stride, attributes, means

/* Values of an attribute at the particles of a reach, to be read by MCOR_VALUE. */
#if MCOR_PARTS == 1
#define MCOR_VALUE(values, i) (values)[i]
void mcor_attribute_load(const mcor_reach* reach, __global const real* attribute, real* values)
{
  for (int i = 0; i < reach->tile.count; ++i)
  {
    values[i] = attribute[reach->tile.list[i]];
  }
}
#else
#define MCOR_VALUE(values, i) mcor_each_lane(vload4(i, values))
void mcor_attribute_load(const mcor_reach* reach, __global const real* attribute, real* values)
{
  MCOR_ALIGNED real of_tile[MCOR_TILE + 16];
  for (int i = 0; i < reach->tile.count; ++i)
  {
    of_tile[i] = attribute[reach->tile.list[i]];
  }
  mcor_reach_pack(&reach->masks, of_tile, values);
}
#endif

/* Adds sum w_i A_i over the particles of a reach for up to MCOR_ATTRIBUTE_STEP attributes:
 * together, as a sum alone would wait for its last addition. weight: w_i in each lane. */
#define MCOR_ATTRIBUTE_STEP 4
void mcor_attribute_add(const mcor_reach* reach, __global const real* attributes, const int stride,
  int count, const realv* weight, realv sums[MCOR_ATTRIBUTE_STEP])
{
  real values[MCOR_ATTRIBUTE_STEP][MCOR_PARTS * (MCOR_TILE + 16)];
  for (int c = 0; c < count; ++c)
  {
    mcor_attribute_load(reach, attributes + c * (long)stride, values[c]);
  }
  const real *v1 = values[count > 1], *v2 = values[count > 2 ? 2 : 0],
             *v3 = values[count > 3 ? 3 : 0];
  realv s0 = sums[0], s1 = sums[1], s2 = sums[2], s3 = sums[3];
  for (int i = 0; i < MCOR_REACH_COUNT(reach); ++i)
  {
    s0 += weight[i] * MCOR_VALUE(values[0], i);
    s1 += weight[i] * MCOR_VALUE(v1, i);
    s2 += weight[i] * MCOR_VALUE(v2, i);
    s3 += weight[i] * MCOR_VALUE(v3, i);
  }
  sums[0] = s0;
  sums[1] = s1;
  sums[2] = s2;
  sums[3] = s3;
}

/* Sets reach->w at the points, as mcor_evaluate does. */
void mcor_reach_evaluate(
  const mcor_grid* grid, const mcor_query* query, const mcor_points* points, mcor_reach* reach)
{
  realv at[3], d[3], along[3], slope;
  mcor_points_relative(grid, query, points, at);
  for (int i = 0; i < MCOR_REACH_COUNT(reach); ++i)
  {
    mcor_points_from(
      at, points, MCOR_REACH(reach, x, i), MCOR_REACH(reach, y, i), MCOR_REACH(reach, z, i), d);
    const mcor_length length = mcor_length_of(d);
    reach->w[i] = mcor_weight_gradient(d, &length, MCOR_REACH(reach, inv_h, i), &slope, along);
  }
}

/* Writes the Shepard means of the attributes at a group of points; iso as for mcor_evaluate.
 * evaluated: that was last called for these points. */
void mcor_attribute_group(const mcor_grid* grid, mcor_query* query, const mcor_points* points,
  real iso, mcor_reach* reach, bool evaluated, MCOR_ATTRIBUTE_PARAMS)
{
  realv sums[MCOR_ATTRIBUTE_LIMIT], w = 0;
  const bool known = evaluated && reach->tile.complete;
  for (int c = 0; c < MCOR_ATTRIBUTE_LIMIT; ++c)
  {
    sums[c] = 0;
  }
  for (bool first = true; mcor_reach_next(grid, query, points, iso, reach, first); first = false)
  {
    realv weight[MCOR_TILE];
    if (!known)
    {
      mcor_reach_evaluate(grid, query, points, reach);
    }
    for (int i = 0; i < MCOR_REACH_COUNT(reach); ++i)
    {
      weight[i] = MCOR_REACH(reach, weight, i) * reach->w[i];
      w += weight[i];
    }
    for (int c = 0; c < attribute_count; c += MCOR_ATTRIBUTE_STEP)
    {
      mcor_attribute_add(reach, attributes + c * (long)stride, stride,
        min(attribute_count - c, MCOR_ATTRIBUTE_STEP), weight, sums + c);
    }
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const real weight = MCOR_GET(w, lane);
    const long v = points->index[lane];
    for (int c = 0; c < attribute_count && v >= 0; ++c)
    {
      means[v * attribute_count + c] =
        fabs(weight) > MCOR_LEAST_SUM ? MCOR_GET(sums[c], lane) / weight : (real)0;
    }
  }
}

#if MCOR_OF_FIELD
/* One work-item = one group of points. Writes the means there. */
__kernel void mcor_attribute_means(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* node, __global const real4* offset,
  MCOR_ATTRIBUTE_PARAMS)
{
  const int group = get_global_id(0);
  if (group >= group_count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_reach reach;
  mcor_group_load(&grid, groups[group], groups[group + 1], node, offset, 0, &points, &query);
  mcor_tile_init(&reach.tile);
  mcor_attribute_group(&grid, &query, &points, 0, &reach, false, MCOR_ATTRIBUTE_ARGS);
}

/* Updates each point's nearest fluid particle from those that reach the query's box. */
void mcor_attribute_nearer(
  const mcor_grid* grid, mcor_query* query, const mcor_points* points, realv* least, fixv* index)
{
  realv at[3], d[3];
  mcor_points_relative(grid, query, points, at);
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(grid, query, &tile, first); first = false)
  {
    for (int i = 0; i < tile.count; ++i)
    {
      if (MCOR_SOLIDS && tile.weight[i] == 0)
      {
        continue;
      }
      mcor_points_from(at, points, tile.x[i], tile.y[i], tile.z[i], d);
      const realv r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
      *index = r2 < *least ? (fixv)tile.list[i] : *index;
      *least = fmin(*least, r2);
    }
  }
}

/* One work-item = one group of points. Writes the nearest fluid particle, among those that reach
 * the points first; where smoothing lengths differ, others may be nearer that do not. The weight's
 * iso value may be so low that none reaches a point: one then reaches an end of its lattice
 * edge. */
__kernel void mcor_attribute_nearest(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* node, __global const real4* offset,
  const int uniform, __global const int* order, __global int* nearest)
{
  const int group = get_global_id(0);
  if (group >= group_count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_group_load(&grid, groups[group], groups[group + 1], node, offset, 0, &points, &query);
  realv least = MAXFLOAT;
  fixv index = -1;
  mcor_attribute_nearer(&grid, &query, &points, &least, &index);
  const bool none = MCOR_ANY(index < 0);
  if (none || !uniform)
  {
    real farthest = 0;
    for (int lane = 0; lane < MCOR_LANES; ++lane)
    {
      farthest = fmax(farthest, MCOR_GET_FIX(index, lane) >= 0 ? MCOR_GET(least, lane) : (real)0);
    }
    query.radius = (float)sqrt(farthest) * 1.0001f;
    query.radius = none ? fmax(query.radius, levels[0].support + 2) : query.radius;
    mcor_attribute_nearer(&grid, &query, &points, &least, &index);
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const int v = points.index[lane], j = (int)MCOR_GET_FIX(index, lane);
    if (v >= 0)
    {
      nearest[v] = j < 0 ? -1 : order[j];
    }
  }
}
#endif
