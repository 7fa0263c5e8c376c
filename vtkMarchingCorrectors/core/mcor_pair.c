/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection by particle pairs, and the growth from its cells [III-C, III-D.1]. */

#include "mcor_internal.h"

#define MCOR_PAIR_GROUPS 8 /* as in mcor_pair.cl */

static mcor_status mcor_mark(mcor_context* context, double iso, int mark_cells)
{
  mcor_bricks* bricks = &context->bricks;
  const int lanes = context->cl.lanes, groups = (context->grid.count + lanes - 1) / lanes;
  const int items = (groups + MCOR_PAIR_GROUPS - 1) / MCOR_PAIR_GROUPS;
  mcor_buffer* has_pairs = &context->scratch[3]; /* of groups, from one launch to the next */
  MCOR_TRY(mcor_reserve(context, has_pairs, (size_t)groups));
  return MCOR_LAUNCH(context, "mcor_pair_mark", MCOR_HEAVY, items, MCOR_GRID_ARGS(context),
    MCOR_BRICK_ARGS(context), MCOR_BUFFER(&context->grid.sides), MCOR_REAL(iso),
    MCOR_REAL(context->options->h_scale), MCOR_INT(mark_cells), MCOR_BUFFER(has_pairs),
    MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(&bricks->now.cells));
}

/* The bricks in which cells will be marked. iso: relative to A0. */
mcor_status mcor_mark_pairs(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  MCOR_TRY(mcor_reserve(context, &bricks->base, sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &bricks->now.cells, sizeof(cl_ulong)));
  return mcor_mark(context, iso, 0);
}

mcor_status mcor_mark_pair_cells(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  const size_t bytes = (size_t)bricks->now.count * sizeof(cl_ulong);
  MCOR_TRY(mcor_fill(context, &bricks->now.cells, 0, bytes));
  MCOR_TRY(mcor_fill(context, &bricks->now.examined, 0, bytes));
  return mcor_mark(context, iso, 1);
}

/* One round of growth; *grown is false when no cell was added. */
mcor_status mcor_grow_cells(mcor_context* context, bool* grown)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_buffer* flags = &context->scratch[1];
  cl_int flag;
  MCOR_TRY(mcor_fill(context, flags, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_grow", MCOR_LIGHT, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->neighbours), MCOR_BUFFER(&bricks->now.examined),
    MCOR_BUFFER(&bricks->fresh), MCOR_BUFFER(&bricks->now.above), MCOR_BUFFER(&bricks->now.valid),
    MCOR_BUFFER(&bricks->bits), MCOR_BUFFER(&bricks->now.cells), MCOR_BUFFER(flags)));
  MCOR_TRY(mcor_read(context, flags, 0, &flag, sizeof flag));
  *grown = flag != 0;
  return flag & 2 ? mcor_append_bricks(context) : MCOR_OK;
}
