/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The sparse virtual grid [III-B]. Blocks of 8 x 8 x 8 bricks exist where there may be surface.
 * A brick has a slot (values, masks) if it is needed. Blocks are sorted by key, bricks by block,
 * then z, y, x: a slot number is a count of bits, and depends on the set of bricks alone. */

#define MCOR_BLOCK_PARAMS                                                                          \
  const int block_count, const int block_shift, __global const mcor_rung *rungs,                   \
    __global const ulong *block_keys, __global const int *block_buckets

#define MCOR_BRICK_PARAMS                                                                          \
  MCOR_BLOCK_PARAMS, __global const uint *brick_bits, __global const int *brick_base

/* Blocks and bricks are positions among those of their level, and the level (w). */

/* Returns the key of a block. */
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

/* Returns the index of a block, or -1. */
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

/* Returns the block of a brick, and the brick's number among its MCOR_BLOCK_BRICKS. */
int4 mcor_block_of_brick(int4 brick)
{
  return (int4)(brick.x >> 3, brick.y >> 3, brick.z >> 3, brick.w);
}
int mcor_place_in_block(int4 brick)
{
  return (brick.z & 7) * 64 + (brick.y & 7) * 8 + (brick.x & 7);
}

/* Returns the number of a brick, counted through the MCOR_BLOCK_BRICKS of each block, or -1 if
 * its block does not exist. */
int mcor_brick_number(MCOR_BLOCK_PARAMS, int4 brick)
{
  const int block = mcor_find_block(MCOR_BLOCK_ARGS, mcor_block_of_brick(brick));
  return block < 0 ? -1 : block * MCOR_BLOCK_BRICKS + mcor_place_in_block(brick);
}

/* Returns the number of a brick a step, of -1 to 1 along each axis, from the one with number `own`;
 * mostly they share a block. */
MCOR_ONE_COPY int mcor_number_beside(MCOR_BLOCK_PARAMS, int own, int4 brick, int4 step)
{
  const int4 to = (brick & 7) + step;
  return (to.x | to.y | to.z) >> 3 == 0 ? own + step.x + 8 * step.y + 64 * step.z
                                        : mcor_brick_number(MCOR_BLOCK_ARGS, brick + step);
}

/* Whether the bit of the brick with number m is set. */
bool mcor_has_brick(__global const uint* bits, int number)
{
  return bits[number >> 5] >> (number & 31) & 1;
}

/* Returns the slot of the brick with number m, or -1. */
int mcor_slot_of_number(__global const uint* brick_bits, __global const int* brick_base, int number)
{
  if (number < 0)
  {
    return -1;
  }
  const uint bits = brick_bits[number >> 5], bit = 1u << (number & 31);
  return bits & bit ? brick_base[number >> 5] + (int)popcount(bits & (bit - 1)) : -1;
}

/* Returns the slot of a brick, or -1. */
MCOR_ONE_COPY int mcor_find_brick(MCOR_BRICK_PARAMS, int4 brick)
{
  return mcor_slot_of_number(brick_bits, brick_base, mcor_brick_number(MCOR_BLOCK_ARGS, brick));
}

#define MCOR_BRICK_ARGS MCOR_BLOCK_ARGS, brick_bits, brick_base

/* With several levels: which bricks are leaves, and which leaves are beside other levels, see
 * mcor_leaf_compare. */
#define MCOR_TREE_PARAMS                                                                           \
  const int has_leaves, __global const uint *leaves, __global const uint *beside
#define MCOR_TREE_ARGS has_leaves, leaves, beside

/* Returns the block with a key. */
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

/* Returns the brick with number m. */
MCOR_ONE_COPY int4 mcor_brick_of_number(
  __global const mcor_rung* rungs, __global const ulong* block_keys, int m)
{
  const int4 block = mcor_block_of_key(rungs, block_keys[m / MCOR_BLOCK_BRICKS]);
  return (int4)(8 * block.x, 8 * block.y, 8 * block.z, block.w) +
    (int4)(m & 7, m >> 3 & 7, m >> 6 & 7, 0);
}

/* Returns the key of a brick. Sorted keys are in the order of slots. */
ulong mcor_brick_key(__global const mcor_rung* rungs, int4 brick)
{
  return mcor_block_key(rungs, mcor_block_of_brick(brick)) * MCOR_BLOCK_BRICKS +
    (ulong)mcor_place_in_block(brick);
}

/* Requests the brick with number m. Returns true if nothing had requested it before. The brick
 * has no slot until the host has placed it. */
bool mcor_request_brick(__global uint* brick_bits, int m)
{
  const uint bit = 1u << (m & 31);
  return !(atomic_or(brick_bits + (m >> 5), bit) & bit);
}

/* Adds cells to the cells of a brick or leaf, 64 bits in two words. Returns which of them are
 * new. */
ulong mcor_add_cells(__global uint* cells, int at, ulong added)
{
  const uint low = (uint)added, high = (uint)(added >> 32);
  const uint new_low = low ? low & ~atomic_or(cells + 2L * at, low) : 0;
  const uint new_high = high ? high & ~atomic_or(cells + 2L * at + 1, high) : 0;
  return new_low | (ulong)new_high << 32;
}

#if MCOR_OF_LATTICE
/* One work-item = one word of 32 bricks. Counts its bricks. */
__kernel void mcor_brick_count(
  const int word_count, __global const uint* brick_bits, __global int* counts)
{
  MCOR_ITEM(word, word < word_count);
  counts[word] = (int)popcount(brick_bits[word]);
}

/* One work-item = one word of 32 bricks. Reads bits and scanned counts. Writes the coordinates of
 * each brick to its slot, and its cells where it is chosen as seed. */
__kernel void mcor_brick_fill(
  MCOR_BRICK_PARAMS, __global const uint* seed_bits, __global int4* bricks, __global ulong* seeds)
{
  MCOR_ITEM(word, word < block_count * MCOR_BLOCK_WORDS);
  int slot = brick_base[word];
  for (uint bits = brick_bits[word]; bits; bits &= bits - 1)
  {
    const int b = 31 - (int)clz(bits & -bits);
    bricks[slot] = mcor_brick_of_number(rungs, block_keys, word * 32 + b);
    seeds[slot++] = seed_bits[word] >> b & 1 ? ~0UL : 0;
  }
}

/* One work-item = one brick. Finds its 7 upper neighbours (offset bits 1 x, 2 y, 4 z: entry
 * offset - 1), and becomes their lower one (entry offset + 6). Entries are -1 before. */
__kernel void mcor_brick_neighbours(
  MCOR_BRICK_PARAMS, const int brick_count, __global const int4* bricks, __global int* neighbours)
{
  MCOR_ITEM(slot, slot < brick_count);
  const int4 brick = bricks[slot];
  const int own = mcor_brick_number(MCOR_BLOCK_ARGS, brick);
  for (int d = 1; d < 8; ++d)
  {
    const int other = mcor_slot_of_number(
      brick_bits, brick_base, mcor_number_beside(MCOR_BLOCK_ARGS, own, brick, mcor_up(d)));
    if (other >= 0)
    {
      neighbours[slot * 14L + d - 1] = other;
      neighbours[other * 14L + d + 6] = slot;
    }
  }
}

/* Whether a slot's state is certain, so that no node's value is needed. */
#define MCOR_IS_CERTAIN(state) ((state) < MCOR_EXAMINE)

/* One work-item = one brick. Writes whether its nodes are to be evaluated, all or none: they are
 * unless they are known. With leaves of several levels, those of certain slots are only if they
 * were needed before (mcor_leaf_need); values below the node threshold never are. */
__kernel void mcor_brick_need(const int brick_count, __global const ulong* known,
  const int leaf_count, __global const uchar* proofs, __global ulong* need)
{
  MCOR_ITEM(slot, slot < brick_count);
  const int state = leaf_count > 0 ? proofs[slot] : MCOR_EXAMINE;
  const bool idle = state == MCOR_VOID || (MCOR_IS_CERTAIN(state) && need[slot] == 0);
  need[slot] = known[slot] || idle ? 0 : ~0UL;
}

/* One work-item = one brick of the old set. Moves its data to its slot in the new set, if it has
 * one. words: 4-byte words that the values of a brick's nodes take; they are known all or none. */
__kernel void mcor_brick_move(MCOR_BRICK_PARAMS, const int old_count,
  __global const int4* old_bricks, __global const ulong* old_known, __global const ulong* old_above,
  __global const ulong* old_valid, const int words, __global const uint* old_value,
  __global const uint* old_weight, __global ulong* known, __global ulong* above,
  __global ulong* valid, __global uint* node_value, __global uint* node_weight)
{
  MCOR_ITEM(old, old < old_count);
  const int slot = mcor_find_brick(MCOR_BRICK_ARGS, old_bricks[old]);
  if (slot < 0)
  {
    return;
  }
  known[slot] = old_known[old];
  above[slot] = old_above[old];
  valid[slot] = old_valid[old];
  for (int n = 0; n < words && old_known[old]; ++n)
  {
    node_value[slot * (long)words + n] = old_value[old * (long)words + n];
    node_weight[slot * (long)words + n] = old_weight[old * (long)words + n];
  }
}
#endif

/* A box [x0, x1) x ..., in halves of the smallest cubes. */
#define MCOR_SIDES_PARAMS                                                                          \
  const int x0, const int y0, const int z0, const int x1, const int y1, const int z1
#define MCOR_SIDES_ARGS x0, y0, z0, x1, y1, z1

/* Keeps a brick's cells, of its level, whose centres are in the box. */
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

/* Gathers a mask of a brick and of its 7 upper (first = 0) or lower (first = 7) neighbours. */
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

/* Returns the nodes or cells of a brick on some of its sides. x, y, z: 0 the first layer along the
 * axis, 2 the last one, 1 all. */
ulong mcor_on_sides(int x, int y, int z)
{
  return (x == 1 ? ~0UL : MCOR_LOW_X << (x == 0 ? 0 : 3)) &
    (y == 1 ? ~0UL : MCOR_LOW_Y << (y == 0 ? 0 : 12)) &
    (z == 1 ? ~0UL : MCOR_LOW_Z << (z == 0 ? 0 : 48));
}

/* Whether any of these cells of a brick has nodes in its upper neighbour d (bits x, y, z; 0 is
 * itself). */
bool mcor_cells_reach(ulong cells, int d)
{
  return (cells & mcor_on_sides(1 + (d & 1), 1 + (d >> 1 & 1), 1 + (d >> 2))) != 0;
}
