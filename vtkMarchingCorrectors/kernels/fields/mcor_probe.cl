/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The field at points that the caller gives: weight sums, sums of particle arrays, and their
 * gradients. Every sum adds its particles in the order of the search grid, so a point's bits do not
 * depend on other points. */

/* One work-item = one point. Reads the point's node; node x is below 0 if no particle reaches the
 * point. Writes a sort key that puts points of a cell, and cells of a brick, next to each other,
 * and points that no particle reaches last. first_x, ...: the first brick. */
__kernel void mcor_probe_key(const int count, const int first_x, const int first_y,
  const int first_z, const int bricks_x, const int bricks_y, const int bricks_z,
  __global const int4* node, __global ulong* keys)
{
  MCOR_ITEM(i, i < count);
  const int4 n = node[i];
  const ulong z = (n.z >> 2) - first_z, y = (n.y >> 2) - first_y, x = (n.x >> 2) - first_x;
  const ulong brick =
    n.x < 0 ? (ulong)bricks_z * bricks_y * bricks_x : (z * bricks_y + y) * bricks_x + x;
  keys[i] =
    n.x < 0 ? brick << 6 : brick << 6 | (ulong)((n.z & 3) << 4 | (n.y & 3) << 2 | (n.x & 3));
}

/* One work-item = one point in sorted order. Reads the nodes and offsets of points in input order.
 * Writes them in sorted order. */
__kernel void mcor_probe_order(const int count, __global const int* order,
  __global const int4* node, __global const real4* offset, __global int4* sorted_node,
  __global real4* sorted_offset)
{
  MCOR_ITEM(i, i < count);
  sorted_node[i] = node[order[i]];
  sorted_offset[i] = offset[order[i]];
}

/* Writes the sums at a group of points. */
void mcor_probe_put(const mcor_points* points, realv weight, const realv* sums,
  __global real* weight_sum, MCOR_ATTRIBUTE_PARAMS)
{
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const long v = points->index[lane];
    if (v >= 0)
    {
      weight_sum[v] = MCOR_GET(weight, lane);
    }
    for (int c = 0; c < MCOR_ATTRIBUTE_LIMIT; ++c) /* constant limit: sums stay in registers */
    {
      if (c < attribute_count && v >= 0)
      {
        means[v * attribute_count + c] = MCOR_GET(sums[c], lane);
      }
    }
  }
}

/* Writes the sums at a group of points, from particles that are gathered for this group alone. */
void mcor_probe_alone(const mcor_grid* grid, mcor_query* query, const mcor_points* points,
  mcor_reach* reach, __global real* weight_sum, MCOR_ATTRIBUTE_PARAMS)
{
  realv sums[MCOR_ATTRIBUTE_LIMIT], w;
  for (int c = 0; c < MCOR_ATTRIBUTE_LIMIT; ++c)
  {
    sums[c] = 0;
  }
  mcor_attribute_sums(
    grid, query, points, 0, reach, false, attribute_count, stride, attributes, sums, &w);
  mcor_probe_put(points, w, sums, weight_sum, MCOR_ATTRIBUTE_ARGS);
}

#if MCOR_LANES == 1
/* One work-item = one group, which is one point. Writes the weight sum at this point, and for each
 * array the sum of weight times value over the particles. On CPUs, this kernel is in
 * mcor_probe_lanes.cl. */
__kernel void mcor_probe_sums(
  MCOR_GROUP_PARAMS, __global const real4* offset, __global real* weight_sum, MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_GROUP_ITEM(0);
  mcor_probe_alone(&grid, &query, &points, &reach, weight_sum, MCOR_ATTRIBUTE_ARGS);
}
#endif

/* One work-item = one group of points. Writes the gradients of the weight sums, and of the sums of
 * weight times array for at most MCOR_ARRAY_STEP arrays from `first_array` on. The unit of length
 * is a cube. */
__kernel void mcor_probe_gradients(MCOR_GROUP_PARAMS, __global const real4* offset,
  const int first_array, __global real* weight_gradient, const int attribute_count,
  const int stride, __global const real* attributes, __global real* gradients)
{
  MCOR_GROUP_ITEM(0);
  const int count = min(attribute_count - first_array, MCOR_ARRAY_STEP);
  __global const real* arrays[MCOR_ARRAY_STEP];
  mcor_values values;
  realv weight_slope[3] = { 0, 0, 0 }, slopes[MCOR_ARRAY_STEP][3];
  realv at[3], d[3], along[3], slope;
  mcor_points_relative(&grid, &query, &points, at);
  for (int c = 0; c < MCOR_ARRAY_STEP; ++c)
  {
    /* Beyond the last array, the weights are read: any finite values will do. */
    arrays[c] = c < count ? attributes + (first_array + c) * (long)stride : p_weight;
    slopes[c][0] = slopes[c][1] = slopes[c][2] = 0;
  }
  for (bool first = true; mcor_reach_next(&grid, &query, &points, 0, &reach, first); first = false)
  {
    mcor_values_load(&reach, arrays, &values);
    for (int i = 0; i < MCOR_REACH_COUNT(&reach); ++i)
    {
      MCOR_REACH_FROM(at, &points, &reach, i, d);
      const mcor_length length = mcor_length_of(d);
      mcor_weight_gradient(d, &length, MCOR_REACH(&reach, inv_h, i), &slope, along);
      const realv m = MCOR_REACH(&reach, weight, i) * slope;
      for (int a = 0; a < 3; ++a)
      {
        const realv g = m * along[a];
        weight_slope[a] += g;
        for (int c = 0; c < MCOR_ARRAY_STEP; ++c)
        {
          slopes[c][a] = MCOR_FMA(g, MCOR_VALUE_OF(&values, &reach, c, i), slopes[c][a]);
        }
      }
    }
  }
  for (int lane = 0; lane < MCOR_LANES; ++lane)
  {
    const long v = points.index[lane];
    for (int a = 0; a < 3 && v >= 0; ++a)
    {
      weight_gradient[3 * v + a] = MCOR_GET(weight_slope[a], lane);
      for (int c = 0; c < count; ++c)
      {
        gradients[(v * attribute_count + first_array + c) * 3 + a] = MCOR_GET(slopes[c][a], lane);
      }
    }
  }
}
