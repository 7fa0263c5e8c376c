/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sets of cells and nodes of a brick. */

/* Parameters of a box [x0, x1) x [y0, y1) x [z0, z1), in halves of the smallest cubes. */
#define MCOR_SIDES_PARAMS                                                                          \
  const int x0, const int y0, const int z0, const int x1, const int y1, const int z1
#define MCOR_SIDES_ARGS x0, y0, z0, x1, y1, z1

/* Returns the cells of a brick whose centres are in the box. Cells are of the brick's level. */
ulong mcor_cells_within(MCOR_SIDES_PARAMS, int4 brick)
{
  ulong cells = ~0UL;
  for (int i = 0; i < MCOR_BRICK; ++i)
  {
    const int4 at = (2 * (brick * MCOR_BRICK + i) + 1) << brick.w;
    cells &= at.x >= x0 && at.x < x1 ? ~0UL : ~(MCOR_LOW_X << i);
    cells &= at.y >= y0 && at.y < y1 ? ~0UL : ~(MCOR_LOW_Y << 4 * i);
    cells &= at.z >= z0 && at.z < z1 ? ~0UL : ~(MCOR_LOW_Z << 16 * i);
  }
  return cells;
}

/* Writes a brick's mask to out[0], and the masks of its 7 upper (first = 0) or lower (first = 7)
 * neighbours to out[1] to out[7]. A neighbour without a slot gets the mask 0. */
MCOR_ONE_COPY void mcor_brick_masks(
  __global const ulong* masks, __global const int* neighbours, int slot, int first, ulong* out)
{
  out[0] = masks[slot];
  for (int d = 1; d < 8; ++d)
  {
    const int other = neighbours[slot * 14L + first + d - 1];
    out[d] = other < 0 ? 0 : masks[other];
  }
}

/* Returns a mask of the nodes or cells in some layers of a brick. x, y, z: 0 takes the first layer
 * along the axis, 1 all layers, 2 the last. */
ulong mcor_on_sides(int x, int y, int z)
{
  return (x == 1 ? ~0UL : MCOR_LOW_X << (x == 0 ? 0 : 3)) &
    (y == 1 ? ~0UL : MCOR_LOW_Y << (y == 0 ? 0 : 12)) &
    (z == 1 ? ~0UL : MCOR_LOW_Z << (z == 0 ? 0 : 48));
}

/* Whether any of these cells of a brick has nodes in the upper neighbour d (bits x, y, z; 0: the
 * brick itself). */
bool mcor_cells_reach(ulong cells, int d)
{
  return (cells & mcor_on_sides(1 + (d & 1), 1 + (d >> 1 & 1), 1 + (d >> 2))) != 0;
}
