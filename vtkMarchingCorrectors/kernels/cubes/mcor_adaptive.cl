/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the nodes of leaves where there may be surface. They are kept in slots, of bricks of one
 * level as everywhere: those of a leaf, and those that hold the far ends of its cells and the finer
 * nodes. */

#if MCOR_OF_LATTICE
#define MCOR_WANTED_IN_PLANE (0xfUL | 0x1ffUL << 8)

/* Bricks whose nodes a leaf needs: of its level bits 0 to 7 (x, y, z up), of the finer one from bit 8
 * on, (x, y, z) 0 to 2 from its first one. Where a leaf beyond a far side is finer, that one has the
 * leaf's nodes there, too. In the plane, those of its layer. */
ulong mcor_adaptive_wanted(uint finer, int plane)
{
  ulong wanted = 0;
  for (int d = 0; d < 8; ++d)
  {
    const uint at = MCOR_DIRECTION(1 + (d & 1), 1 + (d >> 1 & 1), 1 + (d >> 2));
    wanted |= (finer >> at & 1) ? 0 : 1UL << d;
  }
  for (int d = 0; d < 27 && finer; ++d)
  {
    const int x = d % 3, y = d / 3 % 3, z = d / 9;
    if (finer >> d & 1)
    {
      for (int b = 0; b < 27; ++b)
      {
        const int bx = b % 3, by = b / 3 % 3, bz = b / 9;
        const bool beside = (x == 1 || bx == x) && (y == 1 || by == y) && (z == 1 || bz == z);
        wanted |= beside ? 1UL << (8 + b) : 0;
      }
    }
  }
  return plane ? wanted & MCOR_WANTED_IN_PLANE : wanted;
}

/* Key of the brick of bit `b` of these. */
ulong mcor_adaptive_wanted_key(__global const mcor_rung* rungs, int4 leaf, int b)
{
  const int f = b - 8;
  return b < 8
    ? mcor_adaptive_key(rungs, leaf.w, leaf.x + (b & 1), leaf.y + (b >> 1 & 1), leaf.z + (b >> 2))
    : mcor_adaptive_key(
        rungs, leaf.w - 1, 2 * leaf.x + f % 3, 2 * leaf.y + f / 3 % 3, 2 * leaf.z + f / 9);
}

/* One work-item = one leaf. Counts the bricks that it needs. */
__kernel void mcor_adaptive_count_wanted(
  const int count, const int plane, __global const uint* finer, __global int* counts)
{
  MCOR_ITEM(i, i < count);
  counts[i] = (int)popcount(mcor_adaptive_wanted(finer[i], plane));
}

/* One work-item = one leaf. Reads the scanned counts. Writes the keys of the bricks that it needs. */
__kernel void mcor_adaptive_fill_wanted(const int count, const int plane,
  __global const mcor_rung* rungs, __global const int4* cells, __global const uint* finer,
  __global const int* scanned, __global ulong* keys)
{
  MCOR_ITEM(i, i < count);
  int to = scanned[i];
  for (ulong rest = mcor_adaptive_wanted(finer[i], plane); rest; rest &= rest - 1)
  {
    keys[to++] = mcor_adaptive_wanted_key(rungs, cells[i], mcor_ctz(rest));
  }
}

/* One work-item = one slot. Writes its brick and level, given by its key. */
__kernel void mcor_adaptive_bricks(const int count, const int top, __global const mcor_rung* rungs,
  __global const ulong* keys, __global int4* bricks)
{
  MCOR_ITEM(i, i < count);
  int level = 0;
  const ulong key = keys[i] / MCOR_BLOCK_BRICKS;
  const int number = (int)(keys[i] % MCOR_BLOCK_BRICKS);
  while (level < top && key >= rungs[level + 1].base)
  {
    ++level;
  }
  const int4 block =
    mcor_block_of_key(key - rungs[level].base, rungs[level].n[0], rungs[level].n[1]);
  bricks[i] = (int4)(block.x * 8 + (number & 7), block.y * 8 + (number >> 3 & 7),
    block.z * 8 + (number >> 6), level);
}

/* One work-item = one slot. Enters the bricks of its level up from it, and it, into each other's lists, see
 * mcor_brick_neighbours. */
__kernel void mcor_adaptive_neighbours(MCOR_SLOT_PARAMS, __global const mcor_rung* rungs,
  __global const int4* bricks, __global int* neighbours)
{
  MCOR_ITEM(slot, slot < slot_count);
  const int4 own = bricks[slot];
  __global const mcor_rung* rung = rungs + own.w;
  for (int d = 1; d < 8; ++d)
  {
    const int x = own.x + (d & 1), y = own.y + (d >> 1 & 1), z = own.z + (d >> 2);
    const int other = x >> 3 < rung->n[0] && y >> 3 < rung->n[1] && z >> 3 < rung->n[2]
      ? mcor_adaptive_find(MCOR_SLOT_ARGS, mcor_adaptive_key(rungs, own.w, x, y, z))
      : -1;
    if (other >= 0)
    {
      neighbours[slot * 14L + d - 1] = other;
      neighbours[other * 14L + d + 6] = slot;
    }
  }
}

/* One work-item = one leaf. Writes the slots of the bricks that it needs, -1 for others. */
__kernel void mcor_adaptive_tables(MCOR_SLOT_PARAMS, const int count, const int plane,
  __global const mcor_rung* rungs, __global const int4* cells, __global const uint* finer,
  __global int* tables)
{
  MCOR_ITEM(i, i < count);
  const ulong wanted = mcor_adaptive_wanted(finer[i], plane);
  for (int b = 0; b < MCOR_LEAF_SLOTS; ++b)
  {
    tables[i * (long)MCOR_LEAF_SLOTS + b] = wanted >> b & 1
      ? mcor_adaptive_find(MCOR_SLOT_ARGS, mcor_adaptive_wanted_key(rungs, cells[i], b))
      : -1;
  }
}

#endif

#if MCOR_OF_ADAPTIVE
/* One work-item = MCOR_ITEM_NODES nodes of a brick, from brick `first` on. Unless they are known, or
 * certain, reads the particles that reach them; tries the proof first where it was not tried.
 * Writes their values and weights, or the proof. */
__kernel void mcor_adaptive_nodes(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* bricks, __global const ulong* known, const real iso, __global uchar* proofs,
  __global real* node_value, __global real* node_weight)
{
  const long node = (long)get_global_id(0) * MCOR_ITEM_NODES;
  const int slot = first + (int)(node / 64);
  if (node >= 64L * count || known[slot] || MCOR_IS_CERTAIN(proofs[slot]))
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
#if MCOR_LEAF_PROOFS
  if (proofs[slot] == MCOR_UNTRIED)
  {
    mcor_query close = mcor_node_query(&grid, bricks[slot], 0, MCOR_INSIDE_SHARE);
    mcor_tile tile;
    mcor_tile_init(&tile);
    proofs[slot] = mcor_brick_is_inside(&grid, &close, &tile, iso) ? MCOR_ABOVE : MCOR_EXAMINE;
    if (MCOR_IS_CERTAIN(proofs[slot]))
    {
      return;
    }
  }
#endif
  mcor_query query = mcor_node_query(&grid, bricks[slot], (int)(node % 64), 1);
  mcor_node_sums sums;
  mcor_tile tile;
  mcor_tile_init(&tile);
  mcor_node_sum(&grid, &query, &tile, &sums);
  mcor_node_store(&sums, node_value + 64L * first + node, node_weight + 64L * first + node);
}

/* One work-item = one slot. Writes which of its nodes are above the iso value and which are valid; of those
 * that are certain all may be. Others are known from now on. */
__kernel void mcor_adaptive_sign(const int slot_count, __global const uchar* proofs,
  __global const real* node_value, __global const real* node_weight, const real iso,
  const real node_threshold, __global ulong* known, __global ulong* above, __global ulong* valid)
{
  MCOR_ITEM(slot, slot < slot_count);
  if (!known[slot] && MCOR_IS_CERTAIN(proofs[slot]))
  {
    above[slot] = proofs[slot] == MCOR_ABOVE ? ~0UL : 0;
    valid[slot] = proofs[slot] == MCOR_VOID ? 0 : ~0UL;
    return;
  }
  known[slot] = ~0UL;
  const ulong2 signs =
    mcor_node_signs(node_value + slot * 64L, node_weight + slot * 64L, iso, node_threshold);
  above[slot] = signs.x;
  valid[slot] = signs.y;
}
#endif

#if MCOR_OF_LATTICE
/* Marks a slot whose nodes' values are needed after all; of those below the node threshold they never
 * are. */
void mcor_leaf_ask(__global uchar* proofs, int slot)
{
  if (slot >= 0 && (proofs[slot] == MCOR_ABOVE || proofs[slot] == MCOR_BELOW))
  {
    proofs[slot] = MCOR_EXAMINE;
  }
}

/* The same of those that crossed cells of a leaf need, which has no finer ones around it; whether there are
 * any. */
bool mcor_leaf_ask_plain(__global const int* slots, __global const ulong* above,
  __global const ulong* valid, __global uchar* proofs)
{
  ulong a[8], v[8];
  for (int d = 0; d < 8; ++d)
  {
    a[d] = above[slots[d]];
    v[d] = valid[slots[d]];
  }
  mcor_cell_corners(a);
  mcor_cell_corners(v);
  const ulong crossed = mcor_cell_some(a) & ~mcor_cell_all(a) & mcor_cell_all(v);
  for (int d = 0; d < 8 && crossed; ++d)
  {
    if (mcor_cells_reach(crossed, d))
    {
      mcor_leaf_ask(proofs, slots[d]);
    }
  }
  return crossed != 0;
}

/* One work-item = one leaf. Writes whether its cells have nodes on both sides: if not, there is no surface.
 * Then values are needed, of slots that were certain, too. */
__kernel void mcor_adaptive_need(const int count, const int plane, __global const uint* finer,
  __global const int* tables, __global const ulong* above, __global const ulong* valid,
  __global uchar* mixed, __global uchar* proofs)
{
  MCOR_ITEM(i, i < count);
  __global const int* slots = tables + i * (long)MCOR_LEAF_SLOTS;
  if (finer[i] == 0 && !plane)
  {
    mixed[i] = mcor_leaf_ask_plain(slots, above, valid, proofs);
    return;
  }
  int sides = 0;
  for (int b = 0; b < MCOR_LEAF_SLOTS && sides != MCOR_EXAMINE; ++b)
  {
    const ulong a = slots[b] < 0 ? 0 : above[slots[b]], v = slots[b] < 0 ? 0 : valid[slots[b]];
    sides |= (a & v ? MCOR_ABOVE : 0) | (~a & v ? MCOR_BELOW : 0);
  }
  mixed[i] = sides == MCOR_EXAMINE;
  for (int b = 0; b < MCOR_LEAF_SLOTS && sides == MCOR_EXAMINE; ++b)
  {
    mcor_leaf_ask(proofs, slots[b]);
  }
}

/* One work-item = one slot of the old set. Moves what is known of it to its slot in the new set, if it
 * has one. words: of 4 bytes, that the values of a brick's nodes take. */
__kernel void mcor_adaptive_move(MCOR_SLOT_PARAMS, const int old_count,
  __global const mcor_rung* rungs, __global const int4* old_bricks, __global const ulong* old_known,
  const int words, __global const uint* old_value, __global const uint* old_weight,
  __global ulong* known, __global uint* node_value, __global uint* node_weight)
{
  MCOR_ITEM(old, old < old_count && old_known[old]);
  const int4 b = old_bricks[old];
  const int slot = mcor_adaptive_find(MCOR_SLOT_ARGS, mcor_adaptive_key(rungs, b.w, b.x, b.y, b.z));
  if (slot < 0)
  {
    return;
  }
  known[slot] = old_known[old];
  for (int n = 0; n < words; ++n)
  {
    node_value[slot * (long)words + n] = old_value[old * (long)words + n];
    node_weight[slot * (long)words + n] = old_weight[old * (long)words + n];
  }
}
#endif
