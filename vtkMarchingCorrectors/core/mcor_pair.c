/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection by particle pairs, and the growth from its cells [III-C, III-D.1]. */

#include "mcor_internal.h"

/* Places the bricks that have nodes of cells between pairs, and marks these cells. iso: relative to
 * A0. */
mcor_status mcor_mark_pairs(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  const int particles = context->cl.lanes * MCOR_PAIR_GROUPS; /* of an item */
  const int items = (context->grid.count + particles - 1) / particles;
  const size_t marks = (size_t)bricks->block_count * MCOR_BLOCK_BRICKS;
  mcor_buffer* marked = &context->scratch[3];
  MCOR_TRY(mcor_fill(context, marked, 0, marks * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_mark", MCOR_HEAVY, items, MCOR_GRID_ARGS(context),
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(&context->grid.sides), MCOR_REAL(iso),
    MCOR_REAL(context->options->h_scale), MCOR_BUFFER(marked)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_ask", MCOR_LIGHT, marks, MCOR_BLOCK_ARGS(context),
    MCOR_BUFFER(marked), MCOR_BUFFER(&bricks->bits)));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(mcor_sign_nodes(context, iso, &bricks->now.known));
  MCOR_TRY(
    mcor_fill(context, &bricks->now.examined, 0, (size_t)bricks->now.count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_take", MCOR_LIGHT, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(marked), MCOR_BUFFER(&bricks->now.cells)));
  mcor_release(context, marked);
  return MCOR_OK;
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
