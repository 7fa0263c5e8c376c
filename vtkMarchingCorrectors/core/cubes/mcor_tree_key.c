/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: keys of split bricks, which number the bricks of all levels. Other ranks and
 * later calls receive split bricks as keys. */

#include "mcor_tree.h"

#include <stdlib.h>

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
    const mcor_rung* rung = &tree->lattice->rungs[l];
    for (size_t i = 0; i < clusters->capacity; ++i)
    {
      int first[3];
      mcor_first_of_cluster(rung, clusters->entries[i].key, first);
      for (uint64_t rest = clusters->entries[i].value, bit = 0; rest; rest >>= 1, ++bit)
      {
        const int b[3] = { first[0] + (int)(bit & 3), first[1] + (int)(bit >> 2 & 3),
          first[2] + (int)(bit >> 4) };
        if (rest & 1)
        {
          (*keys)[(*count)++] = mcor_brick_key(rung, b);
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
    const mcor_rung* rung = &tree->lattice->rungs[level];
    int b[3];
    mcor_brick_of_key(rung, keys[i], b);
    if (!mcor_set_add_brick(&tree->split[level], rung, b))
    {
      MCOR_TRY(mcor_fail_leaves(context));
    }
    if (i % MCOR_TREE_STEP == 0)
    {
      MCOR_TRY(mcor_report_launch(context));
    }
  }
  return MCOR_OK;
}
