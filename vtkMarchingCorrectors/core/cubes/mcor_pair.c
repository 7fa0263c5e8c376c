/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection by particle pairs [III-C].
 *
 * The cells on the line between the particles of a pair are marked. From the marked cells, other
 * cells are reached through crossed faces, and from one end of a period to the other. Which cells
 * are marked and reached depends only on the particles, the lattice and the iso value. Only bricks
 * with nodes of reached cells are evaluated.
 *
 * Pairs are for comparisons with the paper: all cubes have one size, and one process makes the
 * whole surface. */

#include "mcor_box.h"

/* Returns the number of bricks in all blocks. Each brick has a mask of reached cells, which is
 * indexed by the brick's number, because most bricks have no slot (place for node values). */
static size_t mcor_count_places(const mcor_context* context)
{
  return (size_t)context->bricks.block_count * MCOR_BLOCK_BRICKS;
}

/* Marks the cells between the two particles of each pair. */
static mcor_status mcor_mark_pairs(mcor_context* context)
{
  mcor_pairs* pairs = &context->pairs;
  const size_t bytes = mcor_count_places(context) * sizeof(cl_ulong);
  const int particles =
    /* number of particles of one work-item */
    context->cl.lanes * MCOR_PAIR_VECTORS_OF(context->cl.lanes);
  MCOR_TRY(mcor_fill(context, &pairs->reached, 0, bytes));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_seed", MCOR_HEAVY,
    (context->grid.count + particles - 1) / particles, MCOR_GRID_ARGS(context),
    MCOR_BUFFER(&context->grid.side_flags), MCOR_REAL(context->run.iso.relative),
    MCOR_REAL(context->run.options->h_scale), MCOR_BLOCK_ARGS(context),
    MCOR_BUFFER(&pairs->reached)));
  MCOR_TRY(mcor_reserve(context, &pairs->marked, bytes));
  MCOR_TRY(mcor_copy(context, &pairs->reached, &pairs->marked, 0, bytes));
  return mcor_fill(context, &pairs->grown, 0, bytes);
}

/* Gives slots (places for node values) to the bricks with nodes of reached cells, and evaluates
 * them. *placed: false if there was nothing to do: no brick is new, and it is not the first
 * call. */
static mcor_status mcor_place_reached(mcor_context* context, bool first, bool* placed)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_pairs* pairs = &context->pairs;
  cl_int flag;
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_request", MCOR_LIGHT, mcor_count_places(context),
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&bricks->bits),
    MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *placed = flag != 0 || first;
  if (!*placed)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_place_bricks(context));
  if (first)
  {
    MCOR_TRY(mcor_sign_nodes(context, &bricks->now.known));
  }
  MCOR_TRY(mcor_evaluate_nodes(context));
  return mcor_sign_nodes(context, &bricks->need);
}

/* Adds the periodic images of reached cells. *reached: whether any image is new. */
static mcor_status mcor_wrap_reached(mcor_context* context, bool* reached)
{
  const mcor_lattice* lattice = &context->lattice;
  mcor_pairs* pairs = &context->pairs;
  const int *period = lattice->period, *first = lattice->period_first;
  cl_int flag = 0;
  if (period[0] + period[1] + period[2] > 0)
  {
    MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_wrap", MCOR_LIGHT, mcor_count_places(context),
      MCOR_BLOCK_ARGS(context), MCOR_INT(context->box.ring), MCOR_INT(first[0]), MCOR_INT(first[1]),
      MCOR_INT(first[2]), MCOR_INT(period[0]), MCOR_INT(period[1]), MCOR_INT(period[2]),
      MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&pairs->found)));
    MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  }
  *reached = flag != 0;
  return MCOR_OK;
}

mcor_status mcor_find_reached(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_pairs* pairs = &context->pairs;
  if (mcor_count_places(context) == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_mark_pairs(context));
  for (bool first = true, more = true; more; first = false)
  {
    bool placed;
    MCOR_TRY(mcor_place_reached(context, first, &placed));
    if (placed)
    {
      /* Cells are reached only where nodes have right values: in the period, whose particles are on
       * the device, and in the ring of cells around the period. */
      MCOR_TRY(mcor_find_neighbours(context));
      MCOR_TRY(
        mcor_fill(context, &pairs->domain, 0xff, (size_t)bricks->now.count * sizeof(cl_ulong)));
      MCOR_TRY(mcor_clip_near(context, &pairs->domain));
    }
    for (cl_int grown = 1; grown;)
    {
      const mcor_brick_data* now = &bricks->now;
      MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof grown));
      MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_grow", MCOR_MEDIUM, now->count, MCOR_INT(now->count),
        MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid),
        MCOR_BUFFER(&now->bricks), MCOR_BLOCK_ARGS(context), MCOR_BUFFER(&pairs->domain),
        MCOR_BUFFER(&pairs->grown), MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&pairs->found)));
      MCOR_TRY(mcor_read(context, &pairs->found, 0, &grown, sizeof grown));
      ++context->run.statistics->march_rounds;
    }
    more = placed;
    if (!more)
    {
      MCOR_TRY(mcor_wrap_reached(context, &more));
    }
  }
  const int count = bricks->now.count;
  MCOR_TRY(mcor_reserve(context, &bricks->cells, (size_t)count * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, "mcor_pair_fill", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->now.bricks), MCOR_BLOCK_ARGS(context), MCOR_BUFFER(&pairs->reached),
    MCOR_BUFFER(&pairs->marked), MCOR_BUFFER(&bricks->cells), MCOR_BUFFER(&bricks->seeds));
}
