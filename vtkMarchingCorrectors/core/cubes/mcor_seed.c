/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Seed cells [III-C]: finds the bricks that the surface may reach, and evaluates their nodes. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_plane.h"

#include <float.h>
#include <math.h>

/* Returns the greatest relative rounding error of a Shepard mean of values that are all on one side
 * of the iso value. If n particles reach a point, the errors of the mean's two sums are at most (n
 * + 3) and (n + 1) unit roundoffs of the sum of the terms' absolute values, and the quotient adds
 * one. At most the particles of 27 cells of each level reach a point. */
double mcor_side_margin(const mcor_context* context)
{
  const mcor_grid* grid = &context->grid;
  const double reaching = fmin(27.0 * grid->level_count * grid->most_in_cell, grid->count);
  const double share =
    (2 * reaching + 16) * (context->cl.real_size == sizeof(float) ? FLT_EPSILON : DBL_EPSILON) / 2;
  return share < 0.5 ? share / (1 - share) : 1e30;
}

/* Requests each brick that is certainly on one side of the iso value, but touches a node on the
 * other side. Looks only at nodes of bricks with a bit in `fresh`. bricks.found: whether a
 * requested brick is new. */
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

/* Requests slots for all bricks with known nodes, so that they keep their values. */
static mcor_status mcor_request_known(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  return MCOR_LAUNCH(context, "mcor_block_request_known", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->now.known), MCOR_BUFFER(&bricks->bits));
}

/* Counts the seed cells. mcor_march.c subtracts used cells from seed_cells_not_intersected. */
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

/* Tests regions of 2^3 bricks. Requests the bricks that the surface may reach (their cells are the
 * seeds), and lists their regions. Gives slots to these bricks, and to all bricks that are known
 * from earlier iso values. Then tests the requested bricks one by one; on CPUs, also evaluates the
 * uncertain ones. In a plane, skips these tests: they cost more than evaluating a brick's nodes. */
static mcor_status mcor_test_seeds(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const mcor_box* box = &context->box;
  const int levels = context->lattice.levels;
  /* With several levels, the box sets no limit here, because only leaves near the box exist. */
  const int ring = box->is_part && levels == 1 ? box->ring : MCOR_ENDLESS_RING;
  const size_t blocks = (size_t)bricks->block_count, counts = (size_t)levels * sizeof(cl_int);
  /* The listed regions of level l are the elements first[l] to end[l] - 1 of bricks->regions. */
  int first[MCOR_TREE_LEVEL_LIMIT + 2], end[MCOR_TREE_LEVEL_LIMIT + 2];
  for (int l = 0; l <= levels; ++l)
  {
    first[l] = bricks->first_block[l] * MCOR_BLOCK_REGIONS;
  }
  MCOR_TRY(mcor_reserve(context, &bricks->states, blocks * MCOR_BLOCK_BRICKS));
  MCOR_TRY(mcor_reserve(context, &bricks->regions, blocks * MCOR_BLOCK_REGIONS * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &bricks->found, 0, counts));
  MCOR_TRY(MCOR_LAUNCH_BY_LEVEL(context, "mcor_seed_regions", 1, first, first + 1,
    MCOR_INT(context->space.region_depth), MCOR_BUFFER(&bricks->rungs),
    MCOR_BUFFER(&bricks->block_keys), MCOR_BUFFER(&bricks->block_states), MCOR_TREE_ARGS(context),
    MCOR_SEED_ARGS(context), MCOR_CELL_ARGS(box->first, box->last, ring),
    MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->seed_bits), MCOR_BUFFER(&bricks->regions),
    MCOR_BUFFER(&bricks->found)));
  MCOR_TRY(mcor_read(context, &bricks->found, 0, end, counts));
  for (int l = 0; l < levels; ++l)
  {
    end[l] += first[l];
  }
  MCOR_TRY(mcor_copy(
    context, &bricks->seed_bits, &bricks->bits, 0, blocks * MCOR_BLOCK_WORDS * sizeof(cl_uint)));
  MCOR_TRY(mcor_request_known(context));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(mcor_sign_nodes(context, &bricks->now.known));
  /* If a work-item has several lanes, which share the gathered particles, it treats a region, and
   * evaluates the region's bricks; else it treats a brick. */
  return context->space.flat
    ? MCOR_OK
    : MCOR_LAUNCH_BY_LEVEL(context, "mcor_seed_bricks", context->cl.lanes == 1 ? 8 : 1, first, end,
        MCOR_BRICK_ARGS(context), MCOR_TREE_ARGS(context), MCOR_BUFFER(&bricks->regions),
        MCOR_SEED_ARGS(context), MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->now.known),
        MCOR_BUFFER(&bricks->now.value), MCOR_BUFFER(&bricks->now.weight),
        MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid));
}

/* For uniform cubes. Evaluates uncertain bricks, and any two neighbouring bricks of which one is
 * certainly above the iso value and one certainly below it. Then, round by round, evaluates each
 * brick that is certainly on one side and touches a node on the other side. */
static mcor_status mcor_complete_bricks(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_request", MCOR_HEAVY,
    bricks->block_count * MCOR_BLOCK_BRICKS / 8, MCOR_BLOCK_ARGS(context),
    MCOR_BUFFER(&bricks->inactive), MCOR_BUFFER(&bricks->states), MCOR_BUFFER(&bricks->bits)));
  MCOR_TRY(mcor_request_beside(context, &bricks->now.known));
  for (cl_int grown = 1; grown;)
  {
    MCOR_TRY(mcor_place_bricks(context));
    MCOR_TRY(mcor_evaluate_nodes(context));
    MCOR_TRY(mcor_sign_nodes(context, &bricks->need));
    ++context->run.statistics->march_rounds;
    MCOR_TRY(mcor_request_beside(context, &bricks->need));
    MCOR_TRY(mcor_read(context, &bricks->found, 0, &grown, sizeof grown));
  }
  return MCOR_OK;
}

/* Gives slots (places for node values) to the needed bricks, and evaluates their nodes. Finds which
 * cells the surface may cross, and which cells are plain (no finer brick touches them). */
mcor_status mcor_select_seeds(mcor_context* context, const mcor_input* input)
{
  mcor_bricks* bricks = &context->bricks;
  const bool adaptive = mcor_is_adaptive(&context->lattice), pairs = mcor_uses_pairs(context);
  mcor_grid* grid = &context->grid;
  const int runs = grid->count / MCOR_SIDE_PARTICLES + 1;
  context->adaptive.count = 0;
  MCOR_TRY(mcor_reserve(context, &grid->side_flags, (size_t)runs));
  if (context->run.options->field != MCOR_WEIGHT_SUM) /* else particles have no values */
  {
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_seed_side_flags", MCOR_MEDIUM, runs, MCOR_INT(grid->count),
      MCOR_BUFFER(mcor_fluid_weight(grid)),
      MCOR_BUFFER(&grid->value), MCOR_REAL(mcor_side_margin(context)),
      MCOR_REAL(context->run.iso.relative), MCOR_BUFFER(&grid->side_flags)));
  }
  if (adaptive)
  {
    MCOR_TRY(mcor_begin_leaves(context, input));
  }
  else
  {
    MCOR_TRY(mcor_make_blocks(context));
  }
  const size_t bits = (size_t)bricks->block_count * MCOR_BLOCK_WORDS * sizeof(cl_uint);
  MCOR_TRY(mcor_fill(context, &bricks->bits, 0, bits));
  MCOR_TRY(mcor_fill(context, &bricks->seed_bits, 0, bits));
  if (!pairs)
  {
    MCOR_TRY(mcor_test_seeds(context));
    if (adaptive)
    {
      MCOR_TRY(mcor_choose_leaves(context));
    }
    else
    {
      MCOR_TRY(mcor_count_seeds(context));
    }
    MCOR_TRY(mcor_fill(context, &bricks->bits, 0, bits));
  }
  MCOR_TRY(mcor_request_known(context));
  if (adaptive)
  {
    MCOR_TRY(mcor_complete_leaves(context));
    return mcor_count_seeds(context);
  }
  if (pairs)
  {
    MCOR_TRY(mcor_find_reached(context));
  }
  else
  {
    MCOR_TRY(mcor_complete_bricks(context));
  }
  const size_t cells = (size_t)bricks->now.count * sizeof(cl_ulong);
  MCOR_TRY(mcor_fill(context, &bricks->plain, 0xff, cells));
  return pairs ? mcor_count_seeds(context) : mcor_fill(context, &bricks->cells, 0xff, cells);
}
