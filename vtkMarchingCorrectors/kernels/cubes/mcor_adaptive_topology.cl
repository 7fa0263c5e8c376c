/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes, topology by the field. A cell is plain where no finer leaf touches it, not even its
 * corner. The field decides on the faces between two plain cells of one level, and on tunnels in plain
 * cells, as on the uniform lattice; all other ambiguous faces are as in the case table. Which faces these are
 * is up to the leaves alone, so that cells on both sides agree. Slots are seen as the uniform lattice's
 * bricks: plain cells have all their nodes in slots of their level. */

/* One work-item = one leaf. Writes of its slot which cells are plain, and which of these are used; enters
 * it and the slots up from it into each other's lists, see mcor_brick_neighbours. */
__kernel void mcor_adaptive_plain(const int count, __global const uint* finer,
  __global const int* tables, __global const ulong* used, __global int* neighbours,
  __global ulong* plain, __global ulong* plain_used)
{
  MCOR_ITEM(i, i < count);
  __global const int* slots = tables + i * (long)MCOR_LEAF_SLOTS;
  const int slot = slots[0];
  const ulong cells = ~mcor_leaf_hanging_cells(mcor_leaf_hanging(finer[i]));
  plain[slot] = cells;
  plain_used[slot] = cells & used[i];
  for (int d = 1; d < 8; ++d)
  {
    if (slots[d] >= 0)
    {
      neighbours[slot * 14L + d - 1] = slots[d];
      neighbours[slots[d] * 14L + d + 6] = slot;
    }
  }
}

/* One work-item = one leaf. Reads all decisions. Adds to its number of triangles what its plain cells have
 * more or fewer than by the case table; writes the number of their tunnels. */
__kernel void mcor_adaptive_recount(const int count, __global const int* tables,
  MCOR_DECISION_PARAMS, __global const ulong* above, __global const ulong* used,
  __global const uchar* case_table, __global int* triangle_count, __global int* tunnel_count)
{
  MCOR_ITEM(i, i < count);
  const int slot = tables[i * (long)MCOR_LEAF_SLOTS];
  ulong m[8];
  int tunnels = 0;
  mcor_brick_masks(above, neighbours, slot, 0, m);
  mcor_cell_corners(m);
  triangle_count[i] +=
    mcor_cells_count(m, case_table, MCOR_DECISION_ARGS, slot, used[slot], &tunnels) -
    mcor_cells_count(m, case_table, 0, 0, 0, 0, 0, slot, used[slot], &tunnels);
  tunnel_count[i] = tunnels;
}
