/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: numbers, places and sets of the bricks of all levels. */

#include "mcor_tree.h"

#include <math.h>

int mcor_tree_level_of(double h, double h_min, int top)
{
  int level = 0;
  for (double next = 2 * h_min; level < top && h >= next; next *= 2)
  {
    ++level;
  }
  return level;
}

/* Most bricks of level 0. All levels together have a seventh more. */
#define MCOR_BRICK_LIMIT 0x1p63

/* The lattice consists of whole bricks of the highest level. */
mcor_status mcor_number_bricks(mcor_context* context, mcor_tree* tree)
{
  mcor_lattice* lattice = &context->lattice;
  uint64_t base = 0;
  double most = MCOR_BLOCK_BRICKS; /* becomes nearly the number of bricks of all levels */
  tree->lattice = lattice;
  tree->top = lattice->levels - 1;
  tree->is_plane = context->space.flat;
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    mcor_rung* rung = &lattice->rungs[l];
    uint64_t blocks = 1;
    for (int a = 0; a < 3; ++a)
    {
      const int above = MCOR_BRICK << (tree->top + 1);
      const int64_t along = (lattice->last[a] / above + 2) << (tree->top + 1 - l);
      rung->n[a] = tree->is_plane && a == 2 ? 1 : (int)((along + 7) >> 3);
      blocks *= (uint64_t)rung->n[a];
      most *= l == 0 ? rung->n[a] : 1;
      tree->period[l][a] = lattice->period[a] / (MCOR_BRICK << l);
      tree->period_first[l][a] = lattice->period_first[a] / (MCOR_BRICK << l);
    }
    MCOR_FAIL_IF(most > MCOR_BRICK_LIMIT, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(LEVELS_TOO_MANY),
      lattice->levels);
    rung->base = base;
    rung->unused = 0;
    base += blocks;
  }
  lattice->rungs[tree->top + 2].base = base;
  return MCOR_OK;
}

bool mcor_place_brick(const mcor_tree* tree, int level, const int brick[3], int placed[3])
{
  const mcor_rung* rung = &tree->lattice->rungs[level];
  bool within = true;
  for (int a = 0; a < 3; ++a)
  {
    const int period = tree->period[level][a], first = tree->period_first[level][a];
    const int from = brick[a] - first;
    placed[a] = period > 0 ? (from % period + period) % period + first : brick[a];
    within = within && placed[a] >= 0 && placed[a] >> 3 < rung->n[a];
  }
  return within;
}

bool mcor_has_cluster(const mcor_tree* tree, int level, const int first[3])
{
  bool within = true;
  for (int a = 0; a < 3; ++a)
  {
    const int period = tree->period[level][a];
    const int begin = period > 0 ? tree->period_first[level][a] : 0;
    const int end = period > 0 ? begin + period : 8 * tree->lattice->rungs[level].n[a];
    within = within && first[a] >= begin && first[a] + MCOR_CLUSTER <= end;
  }
  return within;
}

mcor_status mcor_fail_leaves(mcor_context* context)
{
  return mcor_fail(context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(LEAVES_TOO_MANY), context->lattice.cube,
    MCOR_LEAF_LIMIT);
}

/* ---- Sets of bricks ---- */

int mcor_bit_count(uint64_t bits)
{
  int count = 0;
  for (; bits; bits &= bits - 1)
  {
    ++count;
  }
  return count;
}

bool mcor_set_add(mcor_brick_set* set, uint64_t key, uint64_t bricks)
{
  if (bricks == 0)
  {
    return true;
  }
  uint64_t* cluster = set->count > MCOR_SPLIT_LIMIT ? NULL : mcor_table_add(&set->clusters, key);
  if (cluster)
  {
    set->count += (size_t)mcor_bit_count(bricks & ~*cluster);
    *cluster |= bricks;
  }
  return cluster != NULL;
}

bool mcor_set_add_brick(mcor_brick_set* set, const mcor_rung* rung, const int brick[3])
{
  return mcor_set_add(set, mcor_cluster_key(rung, brick), UINT64_C(1) << mcor_cluster_bit(brick));
}

bool mcor_are_too_many(const mcor_brick_set* levels)
{
  size_t count = 0;
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    count += levels[l].count;
  }
  return count > MCOR_SPLIT_LIMIT;
}
