/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the nodes of leaves.
 *
 * A leaf is a brick of 4 x 4 x 4 cells of its level, (x, y, z; level). Its cells have the nodes of that
 * level, 5 along an edge, and where a leaf beside is finer those of the level below on its sides: 9
 * along an edge. Nodes are kept in slots, of bricks of one level as everywhere: those of a leaf, and
 * those that hold the far ends of its cells and the finer nodes. All lengths are in cells of the level,
 * as which the search grid is seen (mcor_view_level). */

/* Bits d = x + 3 y + 9 z, x, y, z 0 to 2: of the 27 bricks in and around a leaf, those that are
 * finer. */
#define MCOR_DIRECTION(x, y, z) ((x) + 3 * (y) + 9 * (z))

/* Key of a brick of a level. */
ulong mcor_graded_key(__global const mcor_rung* rungs, int level, int x, int y, int z)
{
  __global const mcor_rung* rung = rungs + level;
  return rung->base + ((ulong)z * rung->n[1] + y) * rung->n[0] + x;
}

/* One work-item = one element, with the padding. Writes inverse smoothing lengths in other cells. */
__kernel void mcor_graded_scale(
  const int count, __global const real* inv_h, const real factor, __global real* scaled)
{
  const int i = get_global_id(0);
  if (i < count)
  {
    scaled[i] = inv_h[i] * factor;
  }
}

/* One work-item = one leaf, of `count` from `first` on. Reads the particles that reach it, sides
 * included. Writes its state. */
__kernel void mcor_graded_states(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* leaves, MCOR_SEED_PARAMS, __global uchar* states)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  mcor_query query = mcor_seed_query(&grid, leaves[first + i], MCOR_BRICK);
  mcor_tile tile;
  mcor_tile_init(&tile);
  states[first + i] = (uchar)mcor_seed_state(&grid, &query, &tile, false, &limits);
}

#if MCOR_LANES > 1
/* One work-item = one region, of `count` from `first` on: the leaves that are parts of one brick, the
 * particles of which are gathered once. Reads the particles that reach it. Writes the leaves' states
 * and, of those to be examined, their nodes' values and weights. */
__kernel void mcor_graded_regions(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int* regions, __global const int4* leaves, MCOR_SEED_PARAMS,
  __global uchar* states, __global ulong* known, __global real* node_value,
  __global real* node_weight)
{
  const int region = first + get_global_id(0);
  if (region >= first + count)
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const mcor_seed_limits limits = MCOR_SEED_LIMITS;
  const int4 brick = leaves[regions[region]] / MCOR_REGION_BRICKS * MCOR_REGION_BRICKS;
  mcor_query query = mcor_seed_query(&grid, brick, MCOR_REGION_CUBES);
  mcor_tile wide, tile;
  mcor_tile_init(&wide);
  mcor_tile_next(&grid, &query, &wide, true);
  for (int i = regions[region]; i < regions[region + 1]; ++i)
  {
    query = mcor_seed_query(&grid, leaves[i], MCOR_BRICK);
    mcor_tile_init(&tile);
    if (wide.complete)
    {
      mcor_tile_narrow(&wide, &query, &tile);
    }
    states[i] = (uchar)mcor_seed_state(&grid, &query, &tile, false, &limits);
    known[i] = states[i] == MCOR_EXAMINE ? ~0UL : 0;
    if (known[i])
    {
      mcor_node_sums sums;
      mcor_node_sum(&grid, &query, &tile, &sums);
      mcor_node_store(&sums, node_value + 64L * i, node_weight + 64L * i);
    }
  }
}
#endif

/* One work-item = MCOR_ITEM_NODES nodes of a brick, from brick `first` on. Unless they are known, reads
 * the particles that reach them. Writes their values and weights. */
__kernel void mcor_graded_nodes(MCOR_GRID_PARAMS, const int first, const int count,
  __global const int4* bricks, __global const ulong* known, __global real* node_value,
  __global real* node_weight)
{
  const long node = (long)get_global_id(0) * MCOR_ITEM_NODES;
  if (node >= 64L * count || known[first + (int)(node / 64)])
  {
    return;
  }
  const mcor_grid grid = MCOR_GRID;
  const int slot = first + (int)(node / 64);
  mcor_query query = mcor_node_query(&grid, bricks[slot], (int)(node % 64), 1);
  mcor_node_sums sums;
  mcor_tile tile;
  mcor_tile_init(&tile);
  mcor_node_sum(&grid, &query, &tile, &sums);
  mcor_node_store(&sums, node_value + 64L * first + node, node_weight + 64L * first + node);
}

/* Bricks whose nodes a leaf needs: of its level bits 0 to 7 (x, y, z up), of the finer one from bit 8
 * on, (x, y, z) 0 to 2 from its first one. Where a leaf beyond a far side is finer, that one has the
 * leaf's nodes there, too. */
ulong mcor_graded_wanted(uint finer)
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
  return wanted;
}

/* Key of the brick of bit `b` of these. */
ulong mcor_graded_wanted_key(__global const mcor_rung* rungs, int4 leaf, int b)
{
  const int f = b - 8;
  return b < 8
    ? mcor_graded_key(rungs, leaf.w, leaf.x + (b & 1), leaf.y + (b >> 1 & 1), leaf.z + (b >> 2))
    : mcor_graded_key(
        rungs, leaf.w - 1, 2 * leaf.x + f % 3, 2 * leaf.y + f / 3 % 3, 2 * leaf.z + f / 9);
}

/* One work-item = one leaf. Counts the bricks that it needs. */
__kernel void mcor_graded_count_wanted(
  const int count, __global const uint* finer, __global int* counts)
{
  const int i = get_global_id(0);
  if (i < count)
  {
    counts[i] = (int)popcount(mcor_graded_wanted(finer[i]));
  }
}

/* One work-item = one leaf. Reads the scanned counts. Writes the keys of the bricks that it needs. */
__kernel void mcor_graded_fill_wanted(const int count, __global const mcor_rung* rungs,
  __global const int4* cells, __global const uint* finer, __global const int* scanned,
  __global ulong* keys)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  int to = scanned[i];
  for (ulong rest = mcor_graded_wanted(finer[i]); rest; rest &= rest - 1)
  {
    keys[to++] = mcor_graded_wanted_key(rungs, cells[i], mcor_ctz(rest));
  }
}

/* One work-item = one slot. Writes its brick and level, given by its key. */
__kernel void mcor_graded_bricks(const int count, const int top, __global const mcor_rung* rungs,
  __global const ulong* keys, __global int4* bricks)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  int level = 0;
  while (level < top && keys[i] >= rungs[level + 1].base)
  {
    ++level;
  }
  const ulong number = keys[i] - rungs[level].base;
  const int4 block = mcor_block_of_key(number, rungs[level].n[0], rungs[level].n[1]);
  bricks[i] = (int4)(block.x, block.y, block.z, level);
}

#define MCOR_SLOT_PARAMS                                                                           \
  const int slot_count, const int bucket_shift, __global const ulong *keys,                        \
    __global const int *buckets
#define MCOR_SLOT_ARGS slot_count, bucket_shift, keys, buckets

/* Slot of a brick with a key, or -1. */
int mcor_graded_find(MCOR_SLOT_PARAMS, ulong key)
{
  const ulong bucket = key >> bucket_shift;
  const int low = mcor_find_key(keys, buckets[bucket], buckets[bucket + 1], key);
  return low < slot_count && keys[low] == key ? low : -1;
}

/* One work-item = one leaf. Writes the slots of the bricks that it needs, -1 for others. */
__kernel void mcor_graded_tables(MCOR_SLOT_PARAMS, const int count, __global const mcor_rung* rungs,
  __global const int4* cells, __global const uint* finer, __global int* tables)
{
  const int i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  const ulong wanted = mcor_graded_wanted(finer[i]);
  for (int b = 0; b < MCOR_LEAF_SLOTS; ++b)
  {
    tables[i * (long)MCOR_LEAF_SLOTS + b] = wanted >> b & 1
      ? mcor_graded_find(MCOR_SLOT_ARGS, mcor_graded_wanted_key(rungs, cells[i], b))
      : -1;
  }
}

/* One work-item = one slot of the old set. Moves what is known of it to its slot in the new set, if it
 * has one. words: of 4 bytes, that the values of a brick's nodes take. */
__kernel void mcor_graded_move(MCOR_SLOT_PARAMS, const int old_count,
  __global const mcor_rung* rungs, __global const int4* old_bricks, __global const ulong* old_known,
  const int words, __global const uint* old_value, __global const uint* old_weight,
  __global ulong* known, __global uint* node_value, __global uint* node_weight)
{
  const int old = get_global_id(0);
  if (old >= old_count || !old_known[old])
  {
    return;
  }
  const int4 b = old_bricks[old];
  const int slot = mcor_graded_find(MCOR_SLOT_ARGS, mcor_graded_key(rungs, b.w, b.x, b.y, b.z));
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
