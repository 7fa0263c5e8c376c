/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sums at one node per work-item; mcor_node.cl describes the interface. */

int mcor_group_of(int n)
{
  return 0;
}

int mcor_lane_of(int n)
{
  return 0;
}

void mcor_node_sum(const mcor_grid* grid, mcor_query* query, mcor_tile* tile, mcor_node_sums* sums)
{
  const real x = (real)(query->low[0] - query->origin[0]) * grid->unit;
  const real y = (real)(query->low[1] - query->origin[1]) * grid->unit;
  const real z = (real)(query->low[2] - query->origin[2]) * grid->unit;
  sums->s = sums->w = sums->t = 0;
  for (bool begin = true; mcor_tile_next(grid, query, tile, begin); begin = false)
  {
    mcor_sums_add(tile, x, y, z, sums);
  }
}
