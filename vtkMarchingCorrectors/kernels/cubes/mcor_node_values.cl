/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluates nodes by the functions of mcor_node.cl, and finds their sides of the iso value. */

/* One work-item = MCOR_ITEM_NODES nodes of one of the `count` bricks from slot `first` on. If the
 * nodes are needed, writes their values and weights. */
__kernel void mcor_node_values(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* bricks, __global const ulong* need, __global real* node_value,
  __global real* node_weight)
{
  const long first_node = 64L * first + (long)get_global_id(0) * MCOR_ITEM_NODES;
  const int slot = (int)(first_node / 64);
  if (slot >= first + count || need[slot] == 0)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  mcor_query query = mcor_node_query(
    &grid, bricks[slot], mcor_place_of((int)(first_node % 64)), MCOR_ITEM_EXTENT, 1);
  mcor_node_sums sums[MCOR_NODE_GROUPS];
  mcor_tile tile;
  mcor_tile_init(&tile);
  mcor_node_sum(&grid, &query, &tile, sums);
  mcor_node_store(sums, node_value + first_node, node_weight + first_node);
}

/* One work-item = one brick. Treats only bricks whose nodes were `evaluated`: reads the nodes'
 * values, marks the nodes as known, and writes which nodes are above the iso value, and which are
 * valid. */
__kernel void mcor_node_sides(const int brick_count, __global const ulong* evaluated,
  __global ulong* known, __global const real* node_value, __global const real* node_weight,
  const real iso, const real node_threshold, __global ulong* above, __global ulong* valid)
{
  MCOR_ITEM(slot, slot < brick_count && evaluated[slot]);
  known[slot] |= evaluated[slot];
  const ulong2 signs =
    mcor_node_signs(node_value + slot * 64L, node_weight + slot * 64L, iso, node_threshold);
  above[slot] = signs.x;
  valid[slot] = signs.y;
}
