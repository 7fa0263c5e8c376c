/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection by particle pairs [III-C]. */

#include "mcor_internal.h"

/* Places the bricks that have nodes of cells between pairs, and lists these cells. iso: relative to
 * A0. */
mcor_status mcor_seed_pairs(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  const int particles =
    context->cl.lanes * MCOR_PAIR_VECTORS_OF(context->cl.lanes); /* of an item */
  const int items = (context->grid.count + particles - 1) / particles;
  const size_t bricks_of_blocks = (size_t)bricks->block_count * MCOR_BLOCK_BRICKS;
  mcor_buffer* pair_cells = &bricks->pair_cells;
  MCOR_TRY(mcor_fill(context, pair_cells, 0, bricks_of_blocks * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_seed", MCOR_HEAVY, items, MCOR_GRID_ARGS(context),
    MCOR_BUFFER(&context->grid.side_flags), MCOR_REAL(iso),
    MCOR_REAL(context->run.options->h_scale), MCOR_BLOCK_ARGS(context), MCOR_BUFFER(pair_cells)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_request", MCOR_LIGHT, bricks_of_blocks,
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(pair_cells), MCOR_BUFFER(&bricks->bits)));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(mcor_sign_nodes(context, iso, &bricks->now.known));
  MCOR_TRY(
    mcor_fill(context, &bricks->now.examined, 0, (size_t)bricks->now.count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_fill", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(pair_cells), MCOR_BUFFER(&bricks->now.cells)));
  mcor_release(context, pair_cells);
  return MCOR_OK;
}
