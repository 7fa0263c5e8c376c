/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: chooses the leaves (mcor_tree.h) that are marched, and gives slots (places for
 * node values) to the bricks whose nodes these leaves need. The seeds (mcor_seed.c) find the states
 * of all leaves. Leaves that may have surface are listed; only their cells are examined. Nodes that
 * are certainly on one side of the iso value have no value at first, and are evaluated if a crossed
 * cell has them. */

#include "mcor_adaptive.h"
#include "mcor_tree.h"

#include <string.h>

mcor_status mcor_begin_leaves(mcor_context* context, const mcor_input* input)
{
  mcor_tree* tree = &context->tree;
  mcor_bricks* bricks = &context->bricks;
  const mcor_rung* rungs = context->lattice.rungs;
  if (tree->block_keys)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_make_tree(context, input));
  const size_t blocks = (size_t)tree->block_count;
  const size_t bytes = blocks * MCOR_BLOCK_WORDS * sizeof(cl_uint);
  bricks->block_count = tree->block_count;
  memcpy(bricks->first_block, tree->first_block, sizeof tree->first_block);
  MCOR_TRY(mcor_write(context, &bricks->rungs, rungs, (size_t)(tree->top + 3) * sizeof rungs[0]));
  MCOR_TRY(mcor_write(context, &bricks->block_keys, tree->block_keys, blocks * sizeof(cl_ulong)));
  MCOR_TRY(mcor_write(context, &bricks->leaves, tree->leaves, bytes));
  MCOR_TRY(mcor_write(context, &bricks->split, tree->is_split, bytes));
  MCOR_TRY(mcor_fill(context, &bricks->beside, 0, bytes));
  if (blocks == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_index_keys(context, &bricks->block_keys, tree->block_count,
    rungs[tree->top + 2].base, &bricks->block_buckets, &bricks->block_shift));
  return MCOR_LAUNCH(context, "mcor_leaf_compare", MCOR_MEDIUM, blocks * MCOR_BLOCK_BRICKS / 8,
    MCOR_BLOCK_ARGS(context), MCOR_INT(context->space.flat), MCOR_BUFFER(&bricks->leaves),
    MCOR_BUFFER(&bricks->split), MCOR_BUFFER(&bricks->beside));
}

mcor_status mcor_choose_leaves(mcor_context* context)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_bricks* bricks = &context->bricks;
  const mcor_brick_data* now = &bricks->now;
  const int words = bricks->block_count * MCOR_BLOCK_WORDS;
  MCOR_TRY(mcor_fill(context, &adaptive->chosen, 0, (size_t)words * sizeof(cl_uint)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_leaf_choose", MCOR_MEDIUM,
    (size_t)bricks->block_count * MCOR_BLOCK_BRICKS / 8, MCOR_BRICK_ARGS(context),
    MCOR_BUFFER(&bricks->leaves), MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&now->known),
    MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid), MCOR_INT(context->space.flat),
    MCOR_BUFFER(&bricks->beside), MCOR_BUFFER(&adaptive->chosen)));
  MCOR_TRY(mcor_reserve(context, &adaptive->scanned, ((size_t)words + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_count", MCOR_MEDIUM, words, MCOR_INT(words),
    MCOR_BUFFER(&adaptive->chosen), MCOR_BUFFER(&adaptive->scanned)));
  MCOR_TRY(mcor_scan(context, &adaptive->scanned, words, &adaptive->count));
  const size_t count = (size_t)adaptive->count;
  MCOR_TRY(mcor_reserve(context, &adaptive->cells, count * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &adaptive->finer, count * sizeof(cl_uint)));
  return MCOR_LAUNCH(context, "mcor_leaf_list", MCOR_MEDIUM, words, MCOR_BLOCK_ARGS(context),
    MCOR_BUFFER(&adaptive->chosen), MCOR_BUFFER(&adaptive->scanned), MCOR_BUFFER(&bricks->split),
    MCOR_BUFFER(&adaptive->cells), MCOR_BUFFER(&adaptive->finer));
}

mcor_status mcor_complete_leaves(mcor_context* context)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_bricks* bricks = &context->bricks;
  const mcor_brick_data* now = &bricks->now;
  const int count = adaptive->count;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_leaf_request", MCOR_MEDIUM, count, MCOR_BLOCK_ARGS(context),
    MCOR_INT(count), MCOR_INT(context->space.flat), MCOR_BUFFER(&adaptive->cells),
    MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&bricks->bits)));
  MCOR_TRY(mcor_place_bricks(context));
  ++context->run.statistics->march_rounds;
  const size_t n = (size_t)now->count;
  MCOR_TRY(mcor_reserve(context, &adaptive->proofs, n));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_leaf_take", MCOR_MEDIUM, now->count, MCOR_BLOCK_ARGS(context),
    MCOR_INT(now->count), MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&bricks->leaves),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&now->known), MCOR_BUFFER(&adaptive->proofs),
    MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid)));
  MCOR_TRY(mcor_fill(context, &bricks->need, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_evaluate_nodes(context));
  MCOR_TRY(mcor_sign_nodes(context, &bricks->need));
  MCOR_TRY(
    mcor_reserve(context, &adaptive->tables, (size_t)count * MCOR_LEAF_SLOTS * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &adaptive->mixed, (size_t)count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_leaf_tables", MCOR_MEDIUM, count, MCOR_BRICK_ARGS(context),
    MCOR_INT(count), MCOR_INT(context->space.flat), MCOR_BUFFER(&adaptive->cells),
    MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_leaf_need", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(context->space.flat), MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables),
    MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid), MCOR_BUFFER(&adaptive->mixed),
    MCOR_BUFFER(&bricks->need)));
  MCOR_TRY(mcor_evaluate_nodes(context));
  MCOR_TRY(mcor_sign_nodes(context, &bricks->need));
  MCOR_TRY(mcor_fill(context, &bricks->cells, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &bricks->plain, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &bricks->leaf_of, n * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_leaf_cells", MCOR_MEDIUM, count, MCOR_LEAF_ARGS(context),
    MCOR_BUFFER(&adaptive->mixed), MCOR_BUFFER(&bricks->cells), MCOR_BUFFER(&bricks->plain),
    MCOR_BUFFER(&bricks->leaf_of)));
  return mcor_copy(context, &bricks->cells, &bricks->seeds, 0, n * sizeof(cl_ulong));
}

void mcor_release_adaptive(mcor_context* context)
{
  MCOR_RELEASE_BEFORE(context, &context->adaptive, count);
  mcor_release_tree(&context->tree);
}
