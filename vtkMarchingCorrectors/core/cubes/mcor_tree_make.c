/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the leaves, those parts of split bricks (mcor_tree_split.c) that are not split
 * themselves. Which bricks are split is global; leaves are listed in the box alone. */

#include "mcor_box.h"
#include "mcor_tree.h"

#include <stdlib.h>

/* Room for eight more leaves. False: too many, or no memory. */
static bool mcor_extend_leaves(mcor_tree* tree, size_t* room)
{
  const size_t most = (size_t)tree->leaf_count + 8;
  if (most <= *room)
  {
    return true;
  }
  if (most > MCOR_LEAF_LIMIT)
  {
    return false;
  }
  cl_int* leaves = realloc(tree->leaves, 2 * most * 4 * sizeof *leaves);
  tree->leaves = leaves ? leaves : tree->leaves;
  cl_int* regions = realloc(tree->regions, (2 * most + 1) * sizeof *regions);
  tree->regions = regions ? regions : tree->regions;
  *room = leaves && regions ? 2 * most : *room;
  return leaves && regions;
}

/* Whether a brick, with a ring of a cell around it, is in the box. */
static bool mcor_is_wanted(const mcor_box* box, int level, int cell_level, const int brick[3])
{
  bool wanted = true;
  for (int a = 0; a < 3 && box->is_part; ++a)
  {
    const int64_t edge = (int64_t)(2 * MCOR_BRICK) << level, ring = INT64_C(2) << cell_level;
    const int64_t low = brick[a] * edge;
    wanted = wanted && low + edge + ring >= box->halves[a] && low - ring <= box->halves[3 + a];
  }
  return wanted;
}

/* Lists the parts of a split brick that are not split and in the box. */
static void mcor_list_parts(mcor_tree* tree, const mcor_box* box, int level, const int parent[3])
{
  const int first = tree->leaf_count, parts = tree->is_plane ? 4 : 8;
  for (int d = 0; d < parts; ++d)
  {
    const int b[3] = { 2 * parent[0] + (d & 1), 2 * parent[1] + (d >> 1 & 1),
      2 * parent[2] + (d >> 2) };
    if (!mcor_tree_is_split(tree, level, b) && mcor_is_wanted(box, level, level, b))
    {
      cl_int* leaf = tree->leaves + 4 * (size_t)tree->leaf_count++;
      leaf[0] = b[0];
      leaf[1] = b[1];
      leaf[2] = b[2];
      leaf[3] = level;
    }
  }
  if (tree->leaf_count > first)
  {
    tree->regions[tree->region_count++] = first;
  }
}

/* Lists the leaves of one level in a split brick of the next, and in its images. */
static mcor_status mcor_list_in_images(
  mcor_context* context, mcor_tree* tree, int level, const int brick[3], size_t* room)
{
  for (int image = 0; image < 27; ++image)
  {
    const int by[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
    bool exists = true;
    int parent[3];
    for (int a = 0; a < 3; ++a)
    {
      const int period = tree->lattice->period[a] / (MCOR_BRICK << (level + 1));
      exists = exists && (by[a] == 0 || period > 0);
      parent[a] = brick[a] + by[a] * period;
    }
    if (exists && mcor_is_wanted(&context->box, level + 1, level, parent))
    {
      MCOR_TRY(mcor_extend_leaves(tree, room) ? MCOR_OK : mcor_fail_leaves(context));
      mcor_list_parts(tree, &context->box, level, parent);
    }
  }
  return MCOR_OK;
}

/* Lists the leaves of one level: the parts of split bricks, and of their images, that are not split. */
static mcor_status mcor_list_leaves(mcor_context* context, mcor_tree* tree, int level, size_t* room)
{
  const mcor_brick_set* set = &tree->split[level + 1];
  for (size_t i = 0; i < set->clusters.capacity; ++i)
  {
    const mcor_entry cluster = set->clusters.entries[i];
    int first[3];
    mcor_first_of_cluster(&tree->lattice->rungs[level + 1], cluster.key, first);
    for (int bit = 0; bit < 64 && cluster.value >> bit; ++bit)
    {
      const int brick[3] = { first[0] + (bit & 3), first[1] + (bit >> 2 & 3),
        first[2] + (bit >> 4) };
      MCOR_TRY(cluster.value >> bit & 1 ? mcor_list_in_images(context, tree, level, brick, room)
                                        : MCOR_OK);
    }
    MCOR_TRY(i % MCOR_TREE_STEP == 0 ? mcor_report_launch(context) : MCOR_OK);
  }
  return MCOR_OK;
}

mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input)
{
  mcor_tree* tree = &context->tree;
  const mcor_globals* globals = context->run.options->globals;
  mcor_release_tree(tree);
  if (globals)
  {
    MCOR_RETURN_IF(!globals->splits, context, MCOR_INVALID_ARGUMENT,
      "options.globals was measured for uniform cubes. Measure it with the same options.");
    MCOR_TRY(mcor_number_bricks(context, tree));
    MCOR_TRY(mcor_take_splits(context, tree, globals->splits, globals->split_count));
  }
  else
  {
    MCOR_TRY(mcor_split_bricks(context, input, tree));
  }
  const bool keys = context->run.options->outputs & (MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS);
  MCOR_RETURN_IF(keys && mcor_tree_key_limit(tree) >> MCOR_TREE_KEY_BITS > 0, context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large for point keys, with cube size %g and %d levels of adaptive "
    "cubes. Use a larger cube size, or fewer levels.",
    context->lattice.cube, tree->top + 1);
  size_t room = 0;
  MCOR_TRY(mcor_extend_leaves(tree, &room) ? MCOR_OK : mcor_fail_leaves(context));
  for (int l = 0; l <= tree->top; ++l)
  {
    tree->first_leaf[l] = tree->leaf_count;
    tree->first_region[l] = tree->region_count;
    MCOR_TRY(mcor_list_leaves(context, tree, l, &room));
    tree->first_leaf[l + 1] = tree->leaf_count;
    tree->first_region[l + 1] = tree->region_count;
  }
  tree->regions[tree->region_count] = tree->leaf_count;
  return MCOR_OK;
}

mcor_status mcor_measure_splits(
  mcor_context* context, const mcor_input* input, mcor_globals* globals)
{
  mcor_tree tree = { 0 };
  if (context->lattice.top == 0)
  {
    return MCOR_OK;
  }
  mcor_status status = mcor_split_bricks(context, input, &tree);
  status = status == MCOR_OK
    ? mcor_list_splits(context, &tree, &globals->splits, &globals->split_count)
    : status;
  mcor_release_tree(&tree);
  return status;
}

void mcor_release_tree(mcor_tree* tree)
{
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    mcor_table_free(&tree->split[l].clusters);
  }
  free(tree->leaves);
  free(tree->finer);
  free(tree->regions);
  *tree = (mcor_tree){ 0 };
}
