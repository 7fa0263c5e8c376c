/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums at one point, in the form for GPUs; see mcor_probe.cl. */

/* One work-item = one group, which is one point. Writes its weight sum, and the sums of weight
 * times array over the particles. */
__kernel void mcor_probe_sums(MCOR_GRID_PARAMS, const int group_count, __global const int* groups,
  __global const int4* node, __global const real4* offset, __global real* weight_sum,
  MCOR_ATTRIBUTE_PARAMS)
{
  MCOR_ITEM(group, group < group_count);
  const mcor_grid grid = MCOR_GRID;
  mcor_points points;
  mcor_query query;
  mcor_reach reach;
  mcor_group_load(&grid, groups[group], groups[group + 1], node, offset, 0, &points, &query);
  mcor_tile_init(&reach.tile);
  mcor_probe_alone(&grid, &query, &points, &reach, weight_sum, MCOR_ATTRIBUTE_ARGS);
}
