/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: finds the leaves that may have surface.
 *
 * A leaf is a brick of 4 x 4 x 4 cells of its level. The cells of a leaf A have 5 nodes along each
 * edge of A. If a finer leaf touches A, the cells of A also have the finer nodes on the common
 * side, 9 along an edge. A owns only 4 nodes along an edge; the fifth belongs to the next leaf
 * towards larger x, y or z. If all these next leaves have the level of A, the states (mcor_seed.cl)
 * or node values of A and of these leaves tell on which sides of the iso value the nodes of A's
 * cells lie. If all nodes lie on one side, A has no surface.
 *
 * A leaf A is beside other levels if a finer leaf touches A, or if one of these next leaves is
 * larger. Then only A's own state counts: A has no surface if the state is certain and also holds
 * for the nodes on A's far sides (towards larger x, y or z). */

/* Returns the bits of the 8 bricks of a row. Each block has MCOR_BLOCK_ROWS rows. row: the row's
 * number among the rows of all blocks. */
#define MCOR_BLOCK_ROWS (MCOR_BLOCK_BRICKS / 8)
uint mcor_row_of(__global const uint* bits, int row)
{
  return bits[row >> 2] >> 8 * (row & 3) & 0xff;
}

/* Returns 10 bits, for the bricks x = -1 to 8: the 8 bricks of a row in a block, and the next brick
 * on either side, which is in another block. blocks: see mcor_seed_blocks; row: the number of the
 * row's first brick in the block. */
uint mcor_row_bits(int3 blocks, int row, __global const uint* bits)
{
  const int word = row >> 5, at = row & 31;
  uint found = blocks.x < 0 ? 0 : bits[blocks.x * MCOR_BLOCK_WORDS + word] >> (at + 7) & 1;
  found |= blocks.y < 0 ? 0 : (bits[blocks.y * MCOR_BLOCK_WORDS + word] >> at & 0xff) << 1;
  return found | (blocks.z < 0 ? 0 : (bits[blocks.z * MCOR_BLOCK_WORDS + word] >> at & 1) << 9);
}

/* One work-item = one row of 8 bricks of a block. Reads which bricks are leaves, and which are
 * split into finer bricks. Marks a leaf of the row as beside other levels if any brick around the
 * leaf is split, or if a neighbour at higher coordinates is neither a leaf nor split, because it
 * may be part of a larger leaf. In a plane, neighbours at higher z do not count. */
__kernel void mcor_leaf_compare(MCOR_BLOCK_PARAMS, const int plane, __global const uint* leaves,
  __global const uint* split, __global uint* beside)
{
  MCOR_ITEM(item, item < block_count * MCOR_BLOCK_ROWS && mcor_row_of(leaves, item) != 0);
  const int m = item * 8;
  const uint own = mcor_row_of(leaves, item);
  const int4 brick = mcor_brick_of_number(rungs, block_keys, m);
  const int3 blocks = mcor_seed_blocks(MCOR_BLOCK_ARGS, brick);
  /* Bit x of `finer`: any brick around brick x is split. Bit x of `all`: each neighbour of brick x
   * at higher coordinates is a leaf or split. */
  uint finer = 0, all = ~0u;
  for (int d = 0; d < 9; ++d)
  {
    const int4 other = brick + (int4)(0, d % 3 - 1, d / 3 - 1, 0);
    const int row = mcor_place_in_block(other);
    const bool within = other.y >> 3 == brick.y >> 3 && other.z >> 3 == brick.z >> 3;
    const int3 at = within ? blocks : mcor_seed_blocks(MCOR_BLOCK_ARGS, other);
    const uint bits = mcor_row_bits(at, row, split);
    finer |= bits | bits >> 1 | bits >> 2;
    if (d == 4 || d == 5 || (d > 6 && !plane)) /* y and z are 0 or 1 up */
    {
      const uint up = bits | mcor_row_bits(at, row, leaves);
      all &= up >> 1 & up >> 2;
    }
  }
  atomic_or(beside + (m >> 5), (own & (finer | ~all)) << (m & 31));
}

/* Parameters: which bricks are leaves, the states of bricks, and for each slot whether the values
 * of its nodes are known, which nodes are above the iso value, and which are valid. */
#define MCOR_KNOWN_PARAMS                                                                          \
  MCOR_BRICK_PARAMS, __global const uint *leaves, __global const uchar *states,                    \
    __global const ulong *known, __global const ulong *above, __global const ulong *valid
#define MCOR_KNOWN_ARGS MCOR_BRICK_ARGS, leaves, states, known, above, valid

/* Returns on which sides of the iso value valid nodes of leaf m lie. With d = 0, all nodes of the
 * leaf count. With another d, only the nodes count that leaf m shares with the leaf one step down
 * along the axes in d (bits x, y, z). If the nodes' values are not known, returns the leaf's state.
 * If brick m is no leaf, returns MCOR_EXAMINE. */
int mcor_leaf_sides(MCOR_KNOWN_PARAMS, int m, int d)
{
  if (m < 0 || !mcor_has_brick(leaves, m))
  {
    return MCOR_EXAMINE;
  }
  const int slot = mcor_slot_of_number(brick_bits, brick_base, m);
  if (slot < 0 || !known[slot])
  {
    return states[m] & MCOR_EXAMINE;
  }
  const ulong its = valid[slot] & mcor_on_sides(~d & 1, ~d >> 1 & 1, ~d >> 2 & 1);
  return (its & above[slot] ? MCOR_ABOVE : 0) | (its & ~above[slot] ? MCOR_BELOW : 0);
}

/* One work-item = one row of 8 bricks of a block. Chooses the leaves in the row whose cells may
 * have nodes on both sides of the iso value. */
__kernel void mcor_leaf_choose(
  MCOR_KNOWN_PARAMS, const int plane, __global const uint* beside, __global uint* chosen)
{
  MCOR_ITEM(item, item < block_count * MCOR_BLOCK_ROWS && mcor_row_of(leaves, item) != 0);
  const int m = item * 8;
  const uint own = mcor_row_of(leaves, item);
  const int4 first = mcor_brick_of_number(rungs, block_keys, m);
  uint found = 0;
  for (uint rest = own; rest; rest &= rest - 1)
  {
    const int x = mcor_ctz(rest), at = m + x;
    const int4 brick = first + (int4)(x, 0, 0, 0);
    const int slot = mcor_slot_of_number(brick_bits, brick_base, at);
    const bool evaluated = slot >= 0 && known[slot], is_beside = mcor_has_brick(beside, at);
    /* open: the leaf is beside other levels and may have surface, because its nodes are evaluated,
     * its state is uncertain, or its state does not hold for the nodes on its far sides. */
    const bool open =
      evaluated || states[at] == MCOR_EXAMINE ? is_beside : (states[at] & MCOR_OPEN_SIDES) != 0;
    int sides = mcor_leaf_sides(MCOR_KNOWN_ARGS, at, 0);
    for (int d = 1; d < (plane ? 4 : 8) && !is_beside && sides != MCOR_EXAMINE; ++d)
    {
      sides |= mcor_leaf_sides(
        MCOR_KNOWN_ARGS, mcor_number_beside(MCOR_BLOCK_ARGS, at, brick, mcor_up(d)), d);
    }
    /* No branch may depend on `sides` after the loop: LLVM 18 would move code into such a branch,
     * and PoCL 6.0 would end the process ("Instruction Combining did not reach a fixpoint"). */
    found |= (uint)(open | (sides == MCOR_EXAMINE)) << x;
  }
  atomic_or(chosen + (m >> 5), found << (m & 31));
}

/* One work-item = one word of 32 bricks. Reads the prefix sums of the counts of chosen leaves.
 * Writes the chosen leaves in order, and for each leaf, as bits MCOR_DIRECTION, which bricks around
 * it are split. */
__kernel void mcor_leaf_list(MCOR_BLOCK_PARAMS, __global const uint* chosen,
  __global const int* scanned, __global const uint* split, __global int4* cells,
  __global uint* finer)
{
  MCOR_ITEM(word, word < block_count * MCOR_BLOCK_WORDS);
  int to = scanned[word];
  for (uint bits = chosen[word]; bits; bits &= bits - 1, ++to)
  {
    const int m = word * 32 + mcor_ctz(bits);
    const int4 leaf = mcor_brick_of_number(rungs, block_keys, m);
    uint found = 0;
    for (int d = 0; d < 27; ++d)
    {
      const int other = mcor_number_beside(MCOR_BLOCK_ARGS, m, leaf, mcor_around(d));
      found |= (uint)(other >= 0 && mcor_has_brick(split, other)) << d;
    }
    cells[to] = leaf;
    finer[to] = found;
  }
}
