/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Other particle arrays at the surface's points [III-D.4]. */

#define MCOR_ATTRIBUTE_LIMIT 8

/* A lower sum of weights has no digits that could be divided by. */
#define MCOR_LEAST_SUM ((real)1e-30f)

/* One work-item = one group of points. Reads `attribute_count` (at most MCOR_ATTRIBUTE_LIMIT) sorted
 * arrays, one after the other. Writes their Shepard means. */
__kernel void mcor_attribute_means(MCOR_GRID_PARAMS, const int group_count,
  __global const int* groups, __global const int4* node, __global const real4* offset,
  const int attribute_count, const int stride, __global const real* attributes, __global real* out)
{
  const int group = get_global_id(0);
  if (group >= group_count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_group_load(&grid, groups, group, node, offset, 0, &points, &query);
  realv at[3], d[3], sums[MCOR_ATTRIBUTE_LIMIT], w = 0;
  mcor_points_relative(&grid, &query, &points, at);
  for (int c = 0; c < attribute_count; ++c)
  {
    sums[c] = 0;
  }
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)
  {
    realv weight[MCOR_TILE];
    for (int i = 0; i < tile.count; ++i)
    {
      mcor_points_from(at, &points, tile.x[i], tile.y[i], tile.z[i], d);
      const realv planar = mcor_planar(d[0], d[1], tile.inv_h[i]);
      const realv height = mcor_height(d[2], (realv)tile.inv_h[i]);
      weight[i] = tile.weight[i] * mcor_weight(planar, height, tile.inv_h[i]);
      w += weight[i];
    }
    for (int c = 0; c < attribute_count; ++c)
    {
      realv sum = sums[c];
      for (int i = 0; i < tile.count; ++i)
      {
        sum += weight[i] * attributes[c * (long)stride + tile.list[i]];
      }
      sums[c] = sum;
    }
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const real weight = MCOR_GET(w, lane);
    const long v = points.index[lane];
    for (int c = 0; c < attribute_count && v >= 0; ++c)
    {
      out[v * attribute_count + c] =
        fabs(weight) > MCOR_LEAST_SUM ? MCOR_GET(sums[c], lane) / weight : (real)0;
    }
  }
}

/* Updates each point's nearest fluid particle from those that reach the query's box. */
void mcor_attribute_nearer(const mcor_grid* grid, mcor_query* query, const mcor_points* points,
  realv* least, fixv* index)
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

/* One work-item = one group of points. Writes the nearest fluid particle, among those that reach the
 * points first; where smoothing lengths differ, others may be nearer that do not. The weight's iso
 * value may be so low that none reaches a point: one then reaches an end of its lattice edge. */
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
  mcor_group_load(&grid, groups, group, node, offset, 0, &points, &query);
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
