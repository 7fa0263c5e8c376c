/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Gives slots, i.e. places for values and masks, to the bricks that need them [III-B]. The
 * functions for a brick's number and slot are in mcor_virtual_grid.cl. */

/* One work-item = one word, which has a bit for each of 32 bricks. Writes how many bits are set. */
__kernel void mcor_brick_count(
  const int word_count, __global const uint* brick_bits, __global int* counts)
{
  MCOR_ITEM(word, word < word_count);
  counts[word] = (int)popcount(brick_bits[word]);
}

/* One work-item = one word, which has a bit for each of 32 bricks. Reads the bits and the prefix
 * sums of their counts. For each brick whose bit is set, writes to the brick's slot the coordinates
 * and the seed cells. All cells of a brick are seeds if its bit in seed_bits is set, else none. */
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

/* One work-item = one brick. Finds its upper neighbours: neighbour d = 1 to 7 is one brick up along
 * x (if bit 0 of d is set), y (bit 1) and z (bit 2). Writes the neighbour's slot to entry d - 1 of
 * this brick, and this brick's slot to entry d + 6 of the neighbour. Other entries stay -1. */
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

/* One work-item = one brick. Writes which of the brick's nodes are to be evaluated: all nodes if
 * their values are not known yet, else none. With several levels, a void brick is never evaluated,
 * and a brick certainly above or below the iso value is evaluated only if mcor_leaf_need marked its
 * slot. */
__kernel void mcor_brick_need(const int brick_count, __global const ulong* known,
  const int leaf_count, __global const uchar* proofs, __global ulong* need)
{
  MCOR_ITEM(slot, slot < brick_count);
  const int state = leaf_count > 0 ? proofs[slot] : MCOR_EXAMINE;
  const bool idle = state == MCOR_VOID || (MCOR_IS_CERTAIN(state) && need[slot] == 0);
  need[slot] = known[slot] || idle ? 0 : ~0UL;
}

/* One work-item = one brick of the old set of bricks with slots. If the new set has this brick,
 * too, copies the brick's data to its slot in the new set. words: how many 4-byte words the values
 * of a brick's nodes take. The values of a brick's nodes are either all known or all unknown. */
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
