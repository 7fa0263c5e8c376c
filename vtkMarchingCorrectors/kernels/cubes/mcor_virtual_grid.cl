/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The sparse virtual grid [III-B]. Blocks of 8 x 8 x 8 bricks, each with 4 x 4 x 4 nodes, exist
 * where the surface may be. A brick that is needed has a slot for the values and masks of its
 * nodes. Blocks are sorted by key. Bricks are sorted by block, then by z, y, x. The number of a
 * brick's slot is the number of needed bricks before this brick. */

#define MCOR_BLOCK_PARAMS                                                                          \
  const int block_count, const int block_shift, __global const mcor_rung *rungs,                   \
    __global const ulong *block_keys, __global const int *block_buckets

#define MCOR_BRICK_PARAMS                                                                          \
  MCOR_BLOCK_PARAMS, __global const uint *brick_bits, __global const int *brick_base

/* Numbers the 27 places (x, y, z) with x, y, z from 0 to 2. Place (1, 1, 1) is a leaf, and the
 * other places are the bricks around it. Or place (1, 1, 1) is the inside of a leaf, and the other
 * places are its faces, edges and corners. */
#define MCOR_DIRECTION(x, y, z) ((x) + 3 * (y) + 9 * (z))

/* Whether a brick's nodes need no values, because its state tells that all are above the iso value,
 * all are below it, or all have too low weights (MCOR_VOID). */
#define MCOR_IS_CERTAIN(state) ((state) < MCOR_EXAMINE)

/* A block or brick is an int4. x, y, z: its position in blocks or bricks of its level; w: its
 * level. */

ulong mcor_block_key(__global const mcor_rung* rungs, int4 block)
{
  __global const mcor_rung* rung = rungs + block.w;
  return rung->base + ((ulong)block.z * rung->n[1] + block.y) * rung->n[0] + block.x;
}

/* Whether the block is on the lattice. */
bool mcor_has_block(__global const mcor_rung* rungs, int4 block)
{
  __global const mcor_rung* rung = rungs + block.w;
  return block.x >= 0 && block.y >= 0 && block.z >= 0 && block.x < rung->n[0] &&
    block.y < rung->n[1] && block.z < rung->n[2];
}

/* Returns the index of a block, or -1 if the block does not exist. */
int mcor_find_block(MCOR_BLOCK_PARAMS, int4 block)
{
  if (!mcor_has_block(rungs, block))
  {
    return -1;
  }
  const ulong key = mcor_block_key(rungs, block);
  const ulong bucket = key >> block_shift;
  const int low = mcor_find_key(block_keys, block_buckets[bucket], block_buckets[bucket + 1], key);
  return low < block_count && block_keys[low] == key ? low : -1;
}

#define MCOR_BLOCK_ARGS block_count, block_shift, rungs, block_keys, block_buckets

/* mcor_block_of_brick returns the block of a brick, mcor_place_in_block the brick's number in the
 * block. */
int4 mcor_block_of_brick(int4 brick)
{
  return (int4)(brick.x >> 3, brick.y >> 3, brick.z >> 3, brick.w);
}
int mcor_place_in_block(int4 brick)
{
  return (brick.z & 7) * 64 + (brick.y & 7) * 8 + (brick.x & 7);
}

/* Returns the number of a brick, or -1 if its block does not exist. The bricks of block i have the
 * numbers from i * MCOR_BLOCK_BRICKS on. */
int mcor_brick_number(MCOR_BLOCK_PARAMS, int4 brick)
{
  const int block = mcor_find_block(MCOR_BLOCK_ARGS, mcor_block_of_brick(brick));
  return block < 0 ? -1 : block * MCOR_BLOCK_BRICKS + mcor_place_in_block(brick);
}

/* Returns the number of the brick that is one `step` (-1 to 1 along each axis) from `brick`, which
 * has number `own`. Mostly both bricks are in one block, and no block is looked up. */
MCOR_ONE_COPY int mcor_number_beside(MCOR_BLOCK_PARAMS, int own, int4 brick, int4 step)
{
  const int4 to = (brick & 7) + step;
  return (to.x | to.y | to.z) >> 3 == 0 ? own + step.x + 8 * step.y + 64 * step.z
                                        : mcor_brick_number(MCOR_BLOCK_ARGS, brick + step);
}

/* Whether the bit of the brick with this number is set. */
bool mcor_has_brick(__global const uint* bits, int number)
{
  return bits[number >> 5] >> (number & 31) & 1;
}

/* Returns the slot of the brick with this number, or -1 if the brick has no slot. */
int mcor_slot_of_number(__global const uint* brick_bits, __global const int* brick_base, int number)
{
  if (number < 0)
  {
    return -1;
  }
  const uint bits = brick_bits[number >> 5], bit = 1u << (number & 31);
  return bits & bit ? brick_base[number >> 5] + (int)popcount(bits & (bit - 1)) : -1;
}

/* Returns the slot of a brick, or -1 if the brick has no slot. */
MCOR_ONE_COPY int mcor_find_brick(MCOR_BRICK_PARAMS, int4 brick)
{
  return mcor_slot_of_number(brick_bits, brick_base, mcor_brick_number(MCOR_BLOCK_ARGS, brick));
}

#define MCOR_BRICK_ARGS MCOR_BLOCK_ARGS, brick_bits, brick_base

/* has_leaves: whether cubes have several levels. Then `leaves` has a bit for each brick that is a
 * leaf, and `beside` for each leaf that is next to leaves of other levels, see
 * mcor_leaf_compare. */
#define MCOR_TREE_PARAMS                                                                           \
  const int has_leaves, __global const uint *leaves, __global const uint *beside
#define MCOR_TREE_ARGS has_leaves, leaves, beside

int4 mcor_block_of_key(__global const mcor_rung* rungs, ulong key)
{
  int level = 0;
  while (key >= rungs[level + 1].base)
  {
    ++level;
  }
  const ulong number = key - rungs[level].base;
  const int nx = rungs[level].n[0], ny = rungs[level].n[1];
  return (int4)((int)(number % nx), (int)(number / nx % ny), (int)(number / nx / ny), level);
}

MCOR_ONE_COPY int4 mcor_brick_of_number(
  __global const mcor_rung* rungs, __global const ulong* block_keys, int m)
{
  const int4 block = mcor_block_of_key(rungs, block_keys[m / MCOR_BLOCK_BRICKS]);
  return (int4)(8 * block.x, 8 * block.y, 8 * block.z, block.w) +
    (int4)(m & 7, m >> 3 & 7, m >> 6 & 7, 0);
}

/* Returns the key of a brick. Slots are in the order of these keys. */
ulong mcor_brick_key(__global const mcor_rung* rungs, int4 brick)
{
  return mcor_block_key(rungs, mcor_block_of_brick(brick)) * MCOR_BLOCK_BRICKS +
    (ulong)mcor_place_in_block(brick);
}

/* Requests the brick with number m. Returns whether this is the first request for the brick. The
 * brick has no slot until the host has given slots to all requested bricks. */
bool mcor_request_brick(__global uint* brick_bits, int m)
{
  const uint bit = 1u << (m & 31);
  return !(atomic_or(brick_bits + (m >> 5), bit) & bit);
}

/* Adds cells to set number `at` of `cells`. Each set belongs to a brick or leaf, and has a bit for
 * each of the 64 cells, in two words. Returns the cells that the set did not have before. */
ulong mcor_add_cells(__global uint* cells, int at, ulong added)
{
  const uint low = (uint)added, high = (uint)(added >> 32);
  const uint new_low = low ? low & ~atomic_or(cells + 2L * at, low) : 0;
  const uint new_high = high ? high & ~atomic_or(cells + 2L * at + 1, high) : 0;
  return new_low | (ulong)new_high << 32;
}
