/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: makes the leaves, which are the parts of split bricks (mcor_tree_split.c) that
 * are not split themselves. All ranks know all split bricks, but make only leaves near their box. A
 * block is 8^3 bricks of one level: the parts of the 4^3 bricks of one cluster of the next higher
 * level. A block has a bit for each of its bricks; the bit is set if the brick is a leaf. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_tree.h"

#include <stdlib.h>
#include <string.h>

/* Most blocks: the bricks' numbers are ints. */
#define MCOR_TREE_BLOCK_LIMIT (INT32_MAX / MCOR_BLOCK_BRICKS)

/* Whether a brick, with a ring of cells of level `cell_level` around it, touches the box. */
static bool mcor_is_wanted(const mcor_box* box, int level, int cell_level, const int brick[3])
{
  bool wanted = true;
  for (int a = 0; a < 3 && box->is_part; ++a)
  {
    const int64_t edge = (int64_t)(2 * MCOR_BRICK) << level;
    const int64_t ring = (int64_t)(2 * mcor_level_ring(box->ring)) << cell_level;
    const int64_t low = brick[a] * edge;
    wanted = wanted && low + edge + ring >= box->halves[a] && low - ring <= box->halves[3 + a];
  }
  return wanted;
}

/* Adds a block of a level to a table of keys, if it is on the lattice and near the box. */
static mcor_status mcor_add_block(
  mcor_context* context, const mcor_tree* tree, int level, const int block[3], mcor_table* blocks)
{
  const mcor_rung* rung = &tree->lattice->rungs[level];
  const int brick[3] = { 8 * block[0], 8 * block[1], 8 * block[2] };
  bool exists = mcor_is_wanted(&context->box, level + 3, level + 4,
    block); /* a block is as large as a brick three levels higher */
  for (int a = 0; a < 3; ++a)
  {
    exists = exists && block[a] >= 0 && block[a] < rung->n[a];
  }
  if (exists)
  {
    uint64_t* value = mcor_table_add(blocks, mcor_brick_key(rung, brick) / MCOR_BLOCK_BRICKS);
    MCOR_TRY(mcor_leaves_fit(context, value && blocks->count <= MCOR_TREE_BLOCK_LIMIT));
    *value = 1;
  }
  return MCOR_OK;
}

/* Adds blocks of one level: each block that contains parts of split bricks of the next higher level
 * (or of periodic images of these bricks), and the blocks around each such block. These blocks
 * contain every leaf of the level, and every brick of the level with nodes that a leaf needs. */
static mcor_status mcor_add_parts(
  mcor_context* context, const mcor_tree* tree, int level, mcor_table* blocks)
{
  const mcor_brick_set* set = &tree->split[level + 1];
  for (size_t i = 0; i < set->clusters.capacity; ++i)
  {
    const mcor_entry cluster = set->clusters.entries[i];
    int first[3];
    if (i % MCOR_TREE_STEP == 0)
    {
      MCOR_TRY(mcor_report_launch(context));
    }
    if (cluster.value == 0)
    {
      continue;
    }
    mcor_brick_of_key(&tree->lattice->rungs[level + 1], cluster.key, first);
    for (int image = 0; image < 27; ++image)
    {
      const int by[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
      bool exists = true;
      int low[3], high[3], at[3];
      for (int a = 0; a < 3; ++a)
      {
        const int period = tree->period[level + 1][a];
        const int begin = first[a] + by[a] * period;
        exists = exists && (by[a] == 0 || period > 0);
        low[a] = begin / MCOR_CLUSTER - 1;
        high[a] = exists ? (begin + MCOR_CLUSTER - 1) / MCOR_CLUSTER + 1 : low[a] - 1;
      }
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
      {
        for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
        {
          for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
          {
            MCOR_TRY(mcor_add_block(context, tree, level, at, blocks));
          }
        }
      }
    }
  }
  return MCOR_OK;
}

/* Returns which bricks of a cluster are split. */
static uint64_t mcor_split_of_cluster(const mcor_tree* tree, int level, const int first[3])
{
  const mcor_table* clusters = &tree->split[level].clusters;
  const mcor_rung* rung = &tree->lattice->rungs[level];
  if (level == 0 || mcor_has_cluster(tree, level, first))
  {
    return level == 0 ? 0 : mcor_table_find(clusters, mcor_brick_key(rung, first));
  }
  uint64_t split = 0;
  for (int i = 0; i < 64; ++i)
  {
    const int brick[3] = { first[0] + (i & 3), first[1] + (i >> 2 & 3), first[2] + (i >> 4) };
    int b[3];
    if (mcor_place_brick(tree, level, brick, b))
    {
      const uint64_t key = mcor_brick_key(rung, b);
      split |= (mcor_table_find(clusters, mcor_cluster_of(key)) >> mcor_cluster_bit(key) & 1) << i;
    }
  }
  return split;
}

/* Finds which bricks of a block are split, and which are leaves near the box. Returns the number of
 * these leaves. */
static int mcor_fill_block(const mcor_tree* tree, const mcor_box* box, int level, uint64_t key,
  cl_uint leaves[MCOR_BLOCK_WORDS], cl_uint split[MCOR_BLOCK_WORDS])
{
  int first[3], count = 0;
  mcor_brick_of_key(&tree->lattice->rungs[level], key * MCOR_BLOCK_BRICKS, first);
  const int parent[3] = { first[0] / 2, first[1] / 2, first[2] / 2 };
  const uint64_t parents = mcor_split_of_cluster(tree, level + 1, parent);
  uint64_t parts[8];
  for (int d = 0; d < 8; ++d)
  {
    const int cluster[3] = { first[0] + 4 * (d & 1), first[1] + 4 * (d >> 1 & 1),
      first[2] + 4 * (d >> 2) };
    parts[d] = mcor_split_of_cluster(tree, level, cluster);
  }
  memset(leaves, 0, MCOR_BLOCK_WORDS * sizeof *leaves);
  memset(split, 0, MCOR_BLOCK_WORDS * sizeof *split);
  for (int row = 0; row < 64 && parents != 0; ++row)
  {
    const int y = row & 7, z = row >> 3, shift = 4 * (y & 3) + 16 * (z & 3);
    const uint64_t* along = &parts[(y >> 2) << 1 | (z >> 2) << 2];
    const cl_uint is_split =
      (cl_uint)(along[0] >> shift & 15) | (cl_uint)(along[1] >> shift & 15) << 4;
    const cl_uint above = (cl_uint)(parents >> (4 * (y >> 1) + 16 * (z >> 1)) & 15);
    const cl_uint spread = (above & 1) | (above & 2) << 1 | (above & 4) << 2 | (above & 8) << 3;
    cl_uint is_leaf = tree->is_plane && z > 0 ? 0 : 3 * spread & ~is_split;
    for (int x = 0; x < 8 && box->is_part; ++x)
    {
      const int brick[3] = { first[0] + x, first[1] + y, first[2] + z };
      is_leaf &= mcor_is_wanted(box, level, level, brick) ? UINT32_MAX : ~(1u << x);
    }
    split[row >> 2] |= is_split << 8 * (row & 3);
    leaves[row >> 2] |= is_leaf << 8 * (row & 3);
    count += __builtin_popcount(is_leaf);
  }
  return count;
}

/* Lists the blocks of a table, sorted by key, with their leaves. */
static mcor_status mcor_list_blocks(
  mcor_context* context, mcor_tree* tree, const mcor_table* blocks)
{
  const size_t n = blocks->count;
  tree->block_keys = malloc((n + 1) * sizeof *tree->block_keys);
  tree->leaves = malloc((n + 1) * MCOR_BLOCK_WORDS * sizeof *tree->leaves);
  tree->is_split = malloc((n + 1) * MCOR_BLOCK_WORDS * sizeof *tree->is_split);
  MCOR_TRY(mcor_allocated(context, tree->block_keys && tree->leaves && tree->is_split));
  for (size_t i = 0; i < blocks->capacity; ++i)
  {
    if (blocks->entries[i].value != 0)
    {
      tree->block_keys[tree->block_count++] = blocks->entries[i].key;
    }
  }
  qsort(tree->block_keys, n, sizeof *tree->block_keys, mcor_compare_keys);
  int level = 0;
  for (size_t i = 0; i < n; ++i)
  {
    const size_t words = i * MCOR_BLOCK_WORDS;
    for (; tree->block_keys[i] >= tree->lattice->rungs[level + 1].base; ++level)
    {
      tree->first_block[level + 1] = (int)i;
    }
    tree->leaf_count += mcor_fill_block(tree, &context->box, level, tree->block_keys[i],
      tree->leaves + words, tree->is_split + words);
    if (i % MCOR_TREE_STEP == 0)
    {
      MCOR_TRY(mcor_report_launch(context));
    }
  }
  for (; level <= tree->top; ++level)
  {
    tree->first_block[level + 1] = (int)n;
  }
  return mcor_leaves_fit(context, tree->leaf_count <= MCOR_LEAF_LIMIT);
}

mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input)
{
  mcor_tree* tree = &context->tree;
  const mcor_globals* globals = context->run.options->globals;
  mcor_release_tree(tree);
  if (globals)
  {
    MCOR_FAIL_IF(
      !globals->splits, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(GLOBALS_OF_UNIFORM_CUBES));
    MCOR_TRY(mcor_number_bricks(context, tree));
    MCOR_TRY(mcor_take_splits(context, tree, globals->splits, globals->split_count));
  }
  else
  {
    MCOR_TRY(mcor_split_bricks(context, input, tree));
  }
  const bool keys = context->run.options->outputs & (MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS);
  MCOR_FAIL_IF(keys && mcor_tree_key_limit(tree) >> MCOR_TREE_KEY_BITS > 0, context,
    MCOR_OUT_OF_CAPACITY, MCOR_SAY(GRID_TOO_LARGE_FOR_KEYS), context->lattice.cube, tree->top + 1);
  mcor_table blocks = { 0 };
  mcor_status status = MCOR_OK;
  for (int l = 0; l <= tree->top && status == MCOR_OK; ++l)
  {
    status = mcor_add_parts(context, tree, l, &blocks);
  }
  MCOR_THEN(status, mcor_list_blocks(context, tree, &blocks));
  mcor_table_free(&blocks);
  return status;
}

mcor_status mcor_measure_splits(
  mcor_context* context, const mcor_input* input, mcor_globals* globals)
{
  mcor_tree tree = { 0 };
  if (!mcor_is_adaptive(&context->lattice))
  {
    return MCOR_OK;
  }
  mcor_status status = mcor_split_bricks(context, input, &tree);
  MCOR_THEN(status, mcor_list_splits(context, &tree, &globals->splits, &globals->split_count));
  mcor_release_tree(&tree);
  return status;
}

void mcor_release_tree(mcor_tree* tree)
{
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    mcor_table_free(&tree->split[l].clusters);
  }
  free(tree->block_keys);
  free(tree->leaves);
  free(tree->is_split);
  *tree = (mcor_tree){ 0 };
}
