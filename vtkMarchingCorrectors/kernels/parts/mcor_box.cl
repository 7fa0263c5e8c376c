/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* A box of cells of the lattice; see mcor_box.c. */

#if MCOR_OF_LATTICE
/* Cells from `first` to before `last`, by axis. */
#define MCOR_BOX_PARAMS                                                                            \
  const int first_x, const int first_y, const int first_z, const int last_x, const int last_y,     \
    const int last_z
#define MCOR_BOX_ARGS first_x, first_y, first_z, last_x, last_y, last_z

/* Whether any of the box's cells has a node in a cube of nodes. node: the cube's first node; size:
 * the cube's length in nodes. */
bool mcor_box_reaches(MCOR_BOX_PARAMS, int4 node, int size)
{
  return node.x + size > first_x && node.x <= last_x && node.y + size > first_y &&
    node.y <= last_y && node.z + size > first_z && node.z <= last_z;
}

/* One work-item = one cube, 32 << level nodes long. Makes the cube void if it has no node of the
 * box's cells. */
__kernel void mcor_box_void_cubes(const int count, __global const mcor_rung* rungs,
  __global const ulong* keys, MCOR_BOX_PARAMS, __global uchar* states)
{
  MCOR_ITEM(i, i < count);
  const int4 cube = mcor_block_of_key(rungs, keys[i]);
  const int size = MCOR_BLOCK_CUBES << cube.w;
  if (!mcor_box_reaches(MCOR_BOX_ARGS, cube * size, size))
  {
    states[i] = MCOR_VOID;
  }
}

/* One work-item = one brick of a block. If the brick has no node of the box's cells, makes it void,
 * and removes its request for a slot. */
__kernel void mcor_box_void_bricks(const int block_count, __global const mcor_rung* rungs,
  __global const ulong* block_keys, MCOR_BOX_PARAMS, __global uchar* states,
  __global uint* brick_bits)
{
  MCOR_ITEM(m, m < block_count * MCOR_BLOCK_BRICKS);
  const int4 brick = mcor_brick_of_number(rungs, block_keys, m);
  if (!mcor_box_reaches(MCOR_BOX_ARGS, brick * MCOR_BRICK, MCOR_BRICK))
  {
    states[m] = MCOR_VOID;
    atomic_and(brick_bits + (m >> 5), ~(1u << (m & 31)));
  }
}

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
#endif
