/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds the blocks: cubes of 8 x 8 x 8 bricks that may have surface (a brick has 4 x 4 x 4 nodes).
 * A few large cubes cover the whole lattice. Active cubes are divided into 8, level by level, down
 * to blocks. A cube is inactive if the cube and all cubes around it are void (no cell is valid
 * there) or certainly on one and the same side of the iso value. Then no crossed edge is in the
 * cube or leads out of it. Empty space costs next to nothing. Space that coarse particles fill with
 * values far from the iso value costs next to nothing, too.
 *
 * Cubes of one size are sorted by key, like blocks, so mcor_find_block finds them. */

#if MCOR_OF_LATTICE
/* One work-item = cube number i of the largest size. Writes the cube's key. */
__kernel void mcor_block_all(
  const int count, __global const mcor_rung* rungs, const int level, __global ulong* keys)
{
  MCOR_ITEM(i, i < count);
  keys[i] = rungs[level].base + (ulong)i;
}
#endif

#if MCOR_OF_FIELD
/* One work-item = one cube, 32 << level nodes long: cube index[item], or cube `item` if `index` is
 * NULL. Reads the particles that reach the cube. Writes the cube's state: on which sides of the iso
 * value its nodes may be. A cube without a node of a cell in the box first_x to last_z is void. */
__kernel void mcor_block_states(MCOR_GRID_PARAMS, const int count, __global const int* index,
  __global const mcor_rung* rungs, __global const ulong* keys, MCOR_SEED_PARAMS, MCOR_BOX_PARAMS,
  __global uchar* states)
{
  MCOR_ITEM(item, item < count);
  const int i = index ? index[item] : item;
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int4 cube = mcor_block_of_key(rungs, keys[i]);
  const int size = MCOR_BLOCK_CUBES << cube.w;
  mcor_query query = mcor_node_query(&grid, cube * (8 << cube.w), 0, size - 1, 1);
  mcor_tile tile;
  mcor_tile_init(&tile);
  states[i] = mcor_box_reaches(MCOR_BOX_ARGS, cube * size, size)
    ? (uchar)mcor_seed_state(&grid, &query, &tile, true, &limits)
    : MCOR_VOID;
}
#endif

#if MCOR_OF_LATTICE
/* One work-item = one cube. Reads the states of the cube and of its neighbours. Writes whether the
 * cube is inactive. A neighbour off the lattice, or in a larger, inactive cube, has no state. */
__kernel void mcor_block_find_inactive(
  MCOR_BLOCK_PARAMS, __global const uchar* states, __global uchar* inactive)
{
  MCOR_ITEM(i, i < block_count);
  const int4 cube = mcor_block_of_key(rungs, block_keys[i]);
  int seen = 1 << states[i];
  for (int d = 0; d < 27; ++d)
  {
    const int other = mcor_find_block(MCOR_BLOCK_ARGS, cube + mcor_around(d));
    seen |= other < 0 ? 0 : 1 << states[other];
  }
  const int both = 1 << MCOR_ABOVE | 1 << MCOR_BELOW;
  inactive[i] = (seen & both) != both && !(seen >> MCOR_EXAMINE & 1);
}

/* Returns child c (bits x, y, z) of a cube: one of the 8 cubes into which the cube is divided. */
int4 mcor_block_part(int4 cube, int c)
{
  return (int4)(2 * cube.x, 2 * cube.y, 2 * cube.z, cube.w - 1) + mcor_up(c);
}

/* One work-item = one cube. Writes how many children of the cube are on the lattice. An inactive
 * cube has no children. */
__kernel void mcor_block_count(const int count, __global const mcor_rung* rungs,
  __global const ulong* keys, __global const uchar* inactive, __global int* counts)
{
  MCOR_ITEM(i, i < count);
  const int4 cube = mcor_block_of_key(rungs, keys[i]);
  int children = 0;
  for (int c = 0; c < 8 && !inactive[i]; ++c)
  {
    children += mcor_has_block(rungs, mcor_block_part(cube, c));
  }
  counts[i] = children;
}

/* One work-item = one cube. Reads the prefix sums of the counts. Writes the keys of the cube's
 * children. */
__kernel void mcor_block_fill(const int count, __global const mcor_rung* rungs,
  __global const ulong* keys, __global const int* scanned, __global ulong* child_keys)
{
  MCOR_ITEM(i, i < count);
  const int4 cube = mcor_block_of_key(rungs, keys[i]);
  int to = scanned[i];
  for (int c = 0; c < 8 && to < scanned[i + 1]; ++c)
  {
    const int4 part = mcor_block_part(cube, c);
    if (mcor_has_block(rungs, part))
    {
      child_keys[to++] = mcor_block_key(rungs, part);
    }
  }
}

/* One work-item = one brick that has a slot, i.e. a place for its nodes' values. If these values
 * are known, requests a slot for the brick in the new set of bricks, too, to keep the values. */
__kernel void mcor_block_request_known(MCOR_BLOCK_PARAMS, const int brick_count,
  __global const int4* bricks, __global const ulong* known, __global uint* brick_bits)
{
  MCOR_ITEM(slot, slot < brick_count && known[slot]);
  mcor_request_brick(brick_bits, mcor_brick_number(MCOR_BLOCK_ARGS, bricks[slot]));
}
#endif
