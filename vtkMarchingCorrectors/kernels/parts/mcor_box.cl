/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* A box of cells of the lattice; see mcor_box.c. */

/* One work-item = one brick, of any level. Keeps in `clipped` the cells that are in the box, or in
 * the ring around it. The ring has the cells whose distance from the box along each axis is at most
 * `ring` of their own edges. */
__kernel void mcor_box_clip(const int brick_count, __global const int4* bricks, MCOR_SIDES_PARAMS,
  const int ring, __global const ulong* cells, __global ulong* clipped)
{
  MCOR_ITEM(i, i < brick_count);
  const int by = ring ? (2 * ring + 1) << bricks[i].w : 0, end = ring ? by + 1 : 0;
  clipped[i] = cells[i] &
    mcor_cells_within(x0 - by, y0 - by, z0 - by, x1 + end, y1 + end, z1 + end, bricks[i]);
}
