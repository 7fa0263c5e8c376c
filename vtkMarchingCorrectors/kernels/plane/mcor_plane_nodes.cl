/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluates the field at nodes in the plane. Values have the same bits as in mcor_node_values. */

/* MCOR_PLANE_ITEMS work-items share the 16 nodes of a brick in the plane. The nodes of one
 * work-item lie in MCOR_PLANE_ROWS rows along x. */
#define MCOR_PLANE_ITEMS (16 / MCOR_LANES)
#define MCOR_PLANE_ROWS (MCOR_LANES == 1 ? 1 : MCOR_LANES / 4)

/* One work-item = MCOR_LANES nodes of one of the `count` bricks from slot `first` on. If the nodes
 * are needed, writes their values and weights. The nodes one layer up in z get the same values and
 * weights, see mcor_plane_spread. */
__kernel void mcor_plane_nodes(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* bricks, __global const ulong* need, __global real* node_value,
  __global real* node_weight)
{
  const long item = get_global_id(0);
  const int slot = first + (int)(item / MCOR_PLANE_ITEMS);
  if (slot >= first + count || need[slot] == 0)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const int node = (int)(item % MCOR_PLANE_ITEMS) * MCOR_LANES;
  const int4 extent = (int4)(MCOR_LANES == 1 ? 0 : MCOR_BRICK - 1, MCOR_PLANE_ROWS - 1, 0, 0);
  mcor_query query = mcor_node_query(&grid, bricks[slot], mcor_place_of(node), extent, 1);
  real at[3];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = (real)(query.low[a] - query.origin[a]) * grid.unit;
  }
  const fixv lane = mcor_lane_index();
  const realv x = at[0] + MCOR_CONVERT_REALV(lane & 3) * grid.edge[0];
  const realv y = at[1] + MCOR_CONVERT_REALV(lane >> 2) * grid.edge[1];
  mcor_node_sums sums = { 0, 0, 0 };
  mcor_tile tile;
  mcor_tile_init(&tile);
  for (bool begin = true; mcor_tile_next(&grid, &query, &tile, begin); begin = false)
  {
    mcor_sums_add(&tile, x, y, at[2], &sums);
  }
  __global real *value = node_value + slot * 64L + node, *weight = node_weight + slot * 64L + node;
  for (int n = 0; n < MCOR_LANES; ++n)
  {
    mcor_sums_store(&sums, n, value + n, weight + n);
    value[n + 16] = value[n];
    weight[n + 16] = weight[n];
  }
}
