/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Seed cells [III-C]. */

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

/* Requests the bricks that the regions leave uncertain, and lists these regions. */
static mcor_status mcor_find_regions(mcor_context* context, mcor_buffer* list, int* listed)
{
  mcor_bricks* bricks = &context->bricks;
  const int regions = bricks->block_count * MCOR_BLOCK_REGIONS;
  mcor_buffer* list_count = &bricks->found;
  MCOR_TRY(mcor_reserve(context, list, (size_t)regions * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, list_count, 0, sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_regions", MCOR_HEAVY, regions, MCOR_GRID_ARGS(context),
    MCOR_INT(bricks->block_count), MCOR_BUFFER(&context->bricks.rungs),
    MCOR_BUFFER(&bricks->block_keys), MCOR_BUFFER(&bricks->block_states), MCOR_SEED_ARGS(context),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->seed_bits), MCOR_BUFFER(list),
    MCOR_BUFFER(list_count)));
  cl_int count;
  MCOR_TRY(mcor_read(context, list_count, 0, &count, sizeof count));
  *listed = count;
  return MCOR_OK;
}

/* Places the bricks that the regions leave uncertain, which are the seeds, and those that are known
 * from earlier iso values; lists these regions. */
static mcor_status mcor_test_regions(mcor_context* context, mcor_buffer* list, int* listed)
{
  mcor_bricks* bricks = &context->bricks;
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  MCOR_TRY(mcor_reserve(context, &bricks->states, (size_t)bricks->block_count * MCOR_BLOCK_BRICKS));
  MCOR_TRY(mcor_is_plane(context) ? mcor_find_seeds_in_plane(context)
                                  : mcor_find_regions(context, list, listed));
  MCOR_TRY(mcor_void_bricks(context));
  MCOR_TRY(mcor_copy(context, &bricks->seed_bits, &bricks->bits, 0, words * sizeof(cl_uint)));
  MCOR_TRY(mcor_request_known(context));
  return mcor_place_bricks(context);
}

/* Tests and evaluates, among the listed regions' bricks, those of which nothing is known; requests known ones alone. */
static mcor_status mcor_test_bricks(mcor_context* context, const mcor_buffer* list, int listed)
{
  mcor_bricks* bricks = &context->bricks;
  /* One item per region where one gathers for many lanes, else one per brick. */
  const size_t items = (size_t)listed * (context->cl.lanes == 1 ? 8 : 1);
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_bricks", MCOR_HEAVY, items, MCOR_GRID_ARGS(context),
    MCOR_BRICK_ARGS(context), MCOR_INT(listed), MCOR_BUFFER(list), MCOR_SEED_ARGS(context),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->now.known), MCOR_BUFFER(&bricks->now.value),
    MCOR_BUFFER(&bricks->now.weight), MCOR_BUFFER(&bricks->now.above),
    MCOR_BUFFER(&bricks->now.valid)));
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  MCOR_TRY(mcor_fill(context, &bricks->bits, 0, words * sizeof(cl_uint)));
  return mcor_request_known(context);
}

/* Places every brick whose nodes must be evaluated, and evaluates most of them; none in a plane, where bounds
 * on bricks cost more than their few nodes. */
static mcor_status mcor_place_complete(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer* list = &bricks->regions;
  int listed = 0;
  MCOR_TRY(mcor_test_regions(context, list, &listed));
  MCOR_TRY(mcor_count_seeds(context));
  MCOR_TRY(mcor_sign_nodes(context, &bricks->now.known));
  MCOR_TRY(mcor_is_plane(context) ? MCOR_OK : mcor_test_bricks(context, list, listed));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_request", MCOR_HEAVY,
    bricks->block_count * MCOR_BLOCK_BRICKS / 8, MCOR_BLOCK_ARGS(context),
    MCOR_BUFFER(&bricks->inactive), MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->bits)));
  MCOR_TRY(mcor_request_beside(context, &bricks->now.known));
  return mcor_place_bricks(context);
}

/* Ends with the bricks in place, and the values of their nodes. */
mcor_status mcor_select_seeds(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(mcor_find_side_flags(context));
  MCOR_TRY(mcor_make_blocks(context));
  if (mcor_uses_pairs(context))
  {
    return mcor_find_reached(context);
  }
  MCOR_TRY(mcor_place_complete(context));
  for (bool grown = true; grown;)
  {
    MCOR_TRY(mcor_evaluate_nodes(context));
    MCOR_TRY(mcor_sign_nodes(context, &bricks->need));
    ++context->run.statistics->march_rounds;
    MCOR_TRY(mcor_grow_bricks(context, &grown));
  }
  return mcor_fill(context, &bricks->cells, 0xff, (size_t)bricks->now.count * sizeof(cl_ulong));
}
