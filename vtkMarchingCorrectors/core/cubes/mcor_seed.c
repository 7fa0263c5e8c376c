/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Seed cells [III-C]. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_pair.h"
#include "mcor_plane.h"

/* Requests bricks beside those with `fresh` nodes, which these show to be needed. */
static mcor_status mcor_request_beside(mcor_context* context, const mcor_buffer* fresh)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer* grown = &bricks->found;
  MCOR_TRY(mcor_fill(context, grown, 0, sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_seed_grow", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(fresh), MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(grown));
}

/* Evaluated bricks may show that a brick left out must be evaluated too; see mcor_seed.cl. */
static mcor_status mcor_grow_bricks(mcor_context* context, bool* grown)
{
  cl_int flag;
  MCOR_TRY(mcor_request_beside(context, &context->bricks.need));
  MCOR_TRY(mcor_read(context, &context->bricks.found, 0, &flag, sizeof flag));
  *grown = flag != 0;
  return *grown ? mcor_place_bricks(context) : MCOR_OK;
}

/* Counts the cells that are seeds: those of all bricks that the regions leave uncertain, whatever of them is known from
 * earlier iso values. Later, those that the surface uses are taken off. */
static mcor_status mcor_count_seeds(mcor_context* context)
{
  mcor_buffer* seeds = &context->bricks.seeds;
  int count;
  MCOR_TRY(mcor_keep_squares(context, seeds));
  MCOR_TRY(mcor_count_cells(context, seeds, seeds, &count));
  context->run.statistics->seed_cells += count;
  context->run.statistics->seed_cells_not_intersected += count;
  return MCOR_OK;
}

/* Requests the bricks that the regions leave uncertain, which are the seeds. Lists these regions, level by level:
 * listed[l + 1], where those of a level end. */
static mcor_status mcor_test_regions(mcor_context* context, mcor_buffer* list, cl_int* listed)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer* list_count = &bricks->found;
  const int regions = bricks->block_count * MCOR_BLOCK_REGIONS;
  MCOR_TRY(mcor_reserve(context, &bricks->states, (size_t)bricks->block_count * MCOR_BLOCK_BRICKS));
  MCOR_TRY(mcor_reserve(context, list, (size_t)regions * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, list_count, 0, sizeof(cl_int)));
  for (int l = 0; l <= context->lattice.top; ++l)
  {
    const int first = bricks->first_block[l] * MCOR_BLOCK_REGIONS;
    const int count = bricks->first_block[l + 1] * MCOR_BLOCK_REGIONS - first;
    MCOR_TRY(mcor_view_level(context, l));
    MCOR_TRY(MCOR_LAUNCH(context, mcor_is_plane(context) ? "mcor_plane_seeds" : "mcor_seed_regions",
      MCOR_HEAVY, count, MCOR_GRID_ARGS(context), MCOR_INT(first), MCOR_INT(count),
      MCOR_BUFFER(&bricks->rungs), MCOR_BUFFER(&bricks->block_keys),
      MCOR_BUFFER(&bricks->block_states), MCOR_TREE_ARGS(context), MCOR_SEED_ARGS(context),
      MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->seed_bits), MCOR_BUFFER(list),
      MCOR_BUFFER(list_count)));
    MCOR_TRY(mcor_read(context, list_count, 0, &listed[l + 1], sizeof *listed));
  }
  return mcor_view_level(context, 0);
}

/* Tests, and in a CPU's form evaluates, the bricks of these regions of which nothing is known. */
static mcor_status mcor_test_bricks(
  mcor_context* context, const mcor_buffer* list, const cl_int* listed)
{
  mcor_bricks* bricks = &context->bricks;
  for (int l = 0; l <= context->lattice.top; ++l)
  {
    const int count = listed[l + 1] - listed[l];
    /* One item per region where one gathers for many lanes, else one per brick. */
    const size_t items = (size_t)count * (context->cl.lanes == 1 ? 8 : 1);
    MCOR_TRY(mcor_view_level(context, l));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_bricks", MCOR_HEAVY, items, MCOR_GRID_ARGS(context),
      MCOR_BRICK_ARGS(context), MCOR_TREE_ARGS(context), MCOR_INT(listed[l]), MCOR_INT(count),
      MCOR_BUFFER(list), MCOR_SEED_ARGS(context), MCOR_BUFFER(&bricks->states),
      MCOR_BUFFER(&bricks->now.known), MCOR_BUFFER(&bricks->now.value),
      MCOR_BUFFER(&bricks->now.weight), MCOR_BUFFER(&bricks->now.above),
      MCOR_BUFFER(&bricks->now.valid)));
  }
  return mcor_view_level(context, 0);
}

/* Requests the bricks of which nodes are known. */
static mcor_status mcor_request_known(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  return MCOR_LAUNCH(context, "mcor_block_request_known", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->now.known), MCOR_BUFFER(&bricks->bits));
}

/* Requests the bricks, of one level, whose states show that their nodes must be evaluated. */
static mcor_status mcor_request_uncertain(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_request", MCOR_HEAVY,
    bricks->block_count * MCOR_BLOCK_BRICKS / 8, MCOR_BLOCK_ARGS(context),
    MCOR_BUFFER(&bricks->inactive), MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->bits)));
  return mcor_request_beside(context, &bricks->now.known);
}

/* Places every brick whose nodes must be evaluated, and evaluates most of them; none in a plane, where bounds
 * on bricks cost more than their few nodes. While they are tested, all bricks that the regions leave uncertain have
 * places, and those that are known from earlier iso values. */
static mcor_status mcor_place_complete(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer* list = &bricks->regions;
  const bool levels = mcor_is_adaptive(context);
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  cl_int listed[MCOR_TREE_LEVEL_LIMIT + 2] = { 0 };
  MCOR_TRY(mcor_test_regions(context, list, listed));
  MCOR_TRY(levels ? MCOR_OK : mcor_void_bricks(context)); /* leaves are in the box */
  MCOR_TRY(mcor_copy(context, &bricks->seed_bits, &bricks->bits, 0, words * sizeof(cl_uint)));
  MCOR_TRY(mcor_request_known(context));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(levels ? MCOR_OK : mcor_count_seeds(context));
  MCOR_TRY(mcor_sign_nodes(context, &bricks->now.known));
  MCOR_TRY(mcor_is_plane(context) ? MCOR_OK : mcor_test_bricks(context, list, listed));
  MCOR_TRY(levels ? mcor_choose_leaves(context) : MCOR_OK);
  MCOR_TRY(mcor_fill(context, &bricks->bits, 0, words * sizeof(cl_uint)));
  MCOR_TRY(mcor_request_known(context));
  MCOR_TRY(levels ? mcor_request_leaves(context) : mcor_request_uncertain(context));
  return mcor_place_bricks(context);
}

/* Ends with the bricks in place, and the values of their nodes. */
mcor_status mcor_select_seeds(mcor_context* context, const mcor_input* input)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(mcor_find_side_flags(context));
  MCOR_TRY(
    mcor_is_adaptive(context) ? mcor_begin_leaves(context, input) : mcor_make_blocks(context));
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  MCOR_TRY(mcor_fill(context, &bricks->bits, 0, words * sizeof(cl_uint)));
  MCOR_TRY(mcor_fill(context, &bricks->seed_bits, 0, words * sizeof(cl_uint)));
  if (mcor_uses_pairs(context))
  {
    MCOR_TRY(mcor_request_known(context));
    return mcor_find_reached(context);
  }
  MCOR_TRY(mcor_place_complete(context));
  if (mcor_is_adaptive(context))
  {
    ++context->run.statistics->march_rounds;
    return mcor_complete_leaves(context);
  }
  for (bool grown = true; grown;)
  {
    MCOR_TRY(mcor_evaluate_nodes(context));
    MCOR_TRY(mcor_sign_nodes(context, &bricks->need));
    ++context->run.statistics->march_rounds;
    MCOR_TRY(mcor_grow_bricks(context, &grown));
  }
  return mcor_fill(context, &bricks->cells, 0xff, (size_t)bricks->now.count * sizeof(cl_ulong));
}
