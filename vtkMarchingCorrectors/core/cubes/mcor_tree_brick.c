/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: numbers, places, sets and keys of the bricks of all levels. */

#include "mcor_tree.h"

#include <stdlib.h>

int mcor_tree_level_of(double h, double h_min, int top)
{
  int level = 0;
  for (double next = 2 * h_min; level < top && h >= next; next *= 2)
  {
    ++level;
  }
  return level;
}

/* The largest number of bricks at level 0. All higher levels together add at most about a third of
 * this number. */
#define MCOR_BRICK_LIMIT 0x1p63

/* Along each axis, the lattice is covered by a whole number of bricks of level top + 1. */
mcor_status mcor_number_bricks(mcor_context* context, mcor_tree* tree)
{
  mcor_lattice* lattice = &context->lattice;
  uint64_t base = 0;
  double most = MCOR_BLOCK_BRICKS; /* becomes the number of bricks of level 0 */
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

mcor_status mcor_leaves_fit(mcor_context* context, bool fit)
{
  MCOR_FAIL_IF(!fit, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(LEAVES_TOO_MANY),
    context->lattice.cube, MCOR_LEAF_LIMIT);
  return MCOR_OK;
}

/* ---- Sets of bricks ---- */

bool mcor_set_add(mcor_brick_set* set, uint64_t key, uint64_t bricks)
{
  if (bricks == 0)
  {
    return true;
  }
  uint64_t* cluster = set->count > MCOR_SPLIT_LIMIT ? NULL : mcor_table_add(&set->clusters, key);
  if (cluster)
  {
    set->count += (size_t)__builtin_popcountll(bricks & ~*cluster);
    *cluster |= bricks;
  }
  return cluster != NULL;
}

bool mcor_set_add_brick(const mcor_tree* tree, int level, const int brick[3], mcor_brick_set* set)
{
  int placed[3];
  if (!mcor_place_brick(tree, level, brick, placed))
  {
    return true;
  }
  const uint64_t key = mcor_brick_key(&tree->lattice->rungs[level], placed);
  return mcor_set_add(set, mcor_cluster_of(key), UINT64_C(1) << mcor_cluster_bit(key));
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

/* ---- Keys of split bricks, by which other ranks and later calls know them ---- */

mcor_status mcor_list_splits(
  mcor_context* context, const mcor_tree* tree, uint64_t** keys, int64_t* count)
{
  size_t total = 0;
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    total += tree->split[l].count;
  }
  *keys = malloc((total + 1) * sizeof **keys);
  MCOR_TRY(mcor_allocated(context, *keys));
  *count = 0;
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    const mcor_table* clusters = &tree->split[l].clusters;
    for (size_t i = 0; i < clusters->capacity; ++i)
    {
      const uint64_t first = clusters->entries[i].key;
      for (uint64_t rest = clusters->entries[i].value, bit = 0; rest; rest >>= 1, ++bit)
      {
        if (rest & 1)
        {
          (*keys)[(*count)++] = first + (bit & 3) + 8 * (bit >> 2 & 3) + 64 * (bit >> 4);
        }
      }
    }
  }
  qsort(*keys, total, sizeof **keys, mcor_compare_keys);
  return mcor_report_launch(context);
}

void mcor_brick_of_key(const mcor_rung* rung, uint64_t key, int brick[3])
{
  const uint64_t block = key / MCOR_BLOCK_BRICKS - rung->base;
  const uint64_t nx = (uint64_t)rung->n[0], ny = (uint64_t)rung->n[1];
  const int number = (int)(key % MCOR_BLOCK_BRICKS);
  brick[0] = (int)(block % nx) * 8 + (number & 7);
  brick[1] = (int)(block / nx % ny) * 8 + (number >> 3 & 7);
  brick[2] = (int)(block / nx / ny) * 8 + (number >> 6);
}

mcor_status mcor_take_splits(
  mcor_context* context, mcor_tree* tree, const uint64_t* keys, int64_t count)
{
  int level = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    level = i > 0 && keys[i] < keys[i - 1] ? 0 : level;
    while (
      level <= tree->top && keys[i] / MCOR_BLOCK_BRICKS >= tree->lattice->rungs[level + 1].base)
    {
      ++level;
    }
    MCOR_FAIL_IF(keys[i] >= mcor_tree_key_limit(tree) || level == 0, context, MCOR_INVALID_ARGUMENT,
      MCOR_SAY(GLOBALS_OF_OTHER_OPTIONS));
    MCOR_TRY(mcor_leaves_fit(context,
      mcor_set_add(
        &tree->split[level], mcor_cluster_of(keys[i]), UINT64_C(1) << mcor_cluster_bit(keys[i]))));
    if (i % MCOR_TREE_STEP == 0)
    {
      MCOR_TRY(mcor_report_launch(context));
    }
  }
  return MCOR_OK;
}
