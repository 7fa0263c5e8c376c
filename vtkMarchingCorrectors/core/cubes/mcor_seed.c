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

/* Regions by level: those listed of a level are from first[l] to before end[l]. */
typedef struct mcor_region_list
{
  int first[MCOR_TREE_LEVEL_LIMIT + 2], end[MCOR_TREE_LEVEL_LIMIT + 2];
} mcor_region_list;

/* Requests the bricks that the regions leave uncertain, which are the seeds, and lists these regions. */
static mcor_status mcor_test_regions(mcor_context* context, mcor_region_list* listed)
{
  mcor_bricks* bricks = &context->bricks;
  const int levels = context->lattice.levels;
  const size_t blocks = (size_t)bricks->block_count, counts = (size_t)levels * sizeof(cl_int);
  for (int l = 0; l <= levels; ++l)
  {
    listed->first[l] = bricks->first_block[l] * MCOR_BLOCK_REGIONS;
  }
  MCOR_TRY(mcor_reserve(context, &bricks->states, blocks * MCOR_BLOCK_BRICKS));
  MCOR_TRY(mcor_reserve(context, &bricks->regions, blocks * MCOR_BLOCK_REGIONS * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &bricks->found, 0, counts));
  MCOR_TRY(MCOR_LAUNCH_BY_LEVEL(context, "mcor_seed_regions", 1, listed->first, listed->first + 1,
    MCOR_INT(mcor_is_plane(context) ? 0 : MCOR_REGION_BRICKS * MCOR_BRICK),
    MCOR_BUFFER(&bricks->rungs), MCOR_BUFFER(&bricks->block_keys),
    MCOR_BUFFER(&bricks->block_states), MCOR_TREE_ARGS(context), MCOR_SEED_ARGS(context),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->seed_bits), MCOR_BUFFER(&bricks->regions),
    MCOR_BUFFER(&bricks->found)));
  MCOR_TRY(mcor_read(context, &bricks->found, 0, listed->end, counts));
  for (int l = 0; l < levels; ++l)
  {
    listed->end[l] += listed->first[l];
  }
  return MCOR_OK;
}

/* Tests, and in a CPU's form evaluates, the bricks of these regions of which nothing is known. */
static mcor_status mcor_test_bricks(mcor_context* context, const mcor_region_list* listed)
{
  mcor_bricks* bricks = &context->bricks;
  /* One item per region where one gathers for many lanes, else one per brick. */
  return MCOR_LAUNCH_BY_LEVEL(context, "mcor_seed_bricks", context->cl.lanes == 1 ? 8 : 1,
    listed->first, listed->end, MCOR_BRICK_ARGS(context), MCOR_TREE_ARGS(context),
    MCOR_BUFFER(&bricks->regions), MCOR_SEED_ARGS(context), MCOR_BUFFER(&bricks->states),
    MCOR_BUFFER(&bricks->now.known), MCOR_BUFFER(&bricks->now.value),
    MCOR_BUFFER(&bricks->now.weight), MCOR_BUFFER(&bricks->now.above),
    MCOR_BUFFER(&bricks->now.valid));
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

/* Counts the seeds, of which those that the surface uses are taken off later. */
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

/* Places all bricks that the regions leave uncertain, whose cells are the seeds, and those that are known from earlier
 * iso values. Finds states of the former, and evaluates most of them; none in a plane, where bounds on bricks cost
 * more than their few nodes. */
static mcor_status mcor_test_seeds(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_region_list listed;
  MCOR_TRY(mcor_test_regions(context, &listed));
  MCOR_TRY(mcor_void_bricks(context));
  MCOR_TRY(mcor_copy(context, &bricks->seed_bits, &bricks->bits, 0,
    (size_t)bricks->block_count * MCOR_BLOCK_WORDS * sizeof(cl_uint)));
  MCOR_TRY(mcor_request_known(context));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(mcor_sign_nodes(context, &bricks->now.known));
  return mcor_is_plane(context) ? MCOR_OK : mcor_test_bricks(context, &listed);
}

/* Evaluates the bricks of cubes of one size that must be, and those that these show to be needed. */
static mcor_status mcor_complete_bricks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(mcor_request_uncertain(context));
  MCOR_TRY(mcor_place_bricks(context));
  for (bool grown = true; grown;)
  {
    MCOR_TRY(mcor_evaluate_nodes(context));
    MCOR_TRY(mcor_sign_nodes(context, &bricks->need));
    ++context->run.statistics->march_rounds;
    MCOR_TRY(mcor_grow_bricks(context, &grown));
  }
  return MCOR_OK;
}

/* Ends with the bricks in place, and the values of their nodes; which cells may be used, and are plain. */
mcor_status mcor_select_seeds(mcor_context* context, const mcor_input* input)
{
  mcor_bricks* bricks = &context->bricks;
  const bool adaptive = mcor_is_adaptive(&context->lattice), pairs = mcor_uses_pairs(context);
  context->adaptive.count = 0;
  MCOR_TRY(mcor_find_side_flags(context));
  MCOR_TRY(adaptive ? mcor_begin_leaves(context, input) : mcor_make_blocks(context));
  const size_t bits = (size_t)bricks->block_count * MCOR_BLOCK_WORDS * sizeof(cl_uint);
  MCOR_TRY(mcor_fill(context, &bricks->bits, 0, bits));
  MCOR_TRY(mcor_fill(context, &bricks->seed_bits, 0, bits));
  if (!pairs)
  {
    MCOR_TRY(mcor_test_seeds(context));
    MCOR_TRY(adaptive ? mcor_choose_leaves(context) : mcor_count_seeds(context));
    MCOR_TRY(mcor_fill(context, &bricks->bits, 0, bits));
  }
  MCOR_TRY(mcor_request_known(context));
  if (adaptive)
  {
    MCOR_TRY(mcor_complete_leaves(context));
    return mcor_count_seeds(context);
  }
  MCOR_TRY(pairs ? mcor_find_reached(context) : mcor_complete_bricks(context));
  const size_t cells = (size_t)bricks->now.count * sizeof(cl_ulong);
  MCOR_TRY(mcor_fill(context, &bricks->plain, 0xff, cells));
  return pairs ? mcor_count_seeds(context) : mcor_fill(context, &bricks->cells, 0xff, cells);
}
