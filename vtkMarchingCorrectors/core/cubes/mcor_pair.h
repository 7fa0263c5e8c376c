/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_pair_h
#define mcor_pair_h

/* The paper's seeds [III-C]. */

#include "mcor_adaptive.h"

/* Ends with the cells that pairs reach in pairs.cells, all of whose nodes are evaluated; pairs.seeds: those that pairs
 * mark. iso: relative to A0. */
mcor_status mcor_find_reached(mcor_context* context, double iso);
/* Places of bricks, by which reached cells are noted, see MCOR_PLACE_PARAMS. */
static inline size_t mcor_count_places(const mcor_context* context)
{
  const mcor_bricks* bricks = &context->bricks;
  return mcor_is_adaptive(context) ? (size_t)bricks->now.count
                                   : (size_t)bricks->block_count * MCOR_BLOCK_BRICKS;
}
void mcor_release_pairs(mcor_context* context);

/* mcor_pair_rounds.c: these cells grow from box to box. */

/* Goes on from `count` cells of this box that others have reached: int4, the level last. *fresh: whether one is
 * new. */
typedef mcor_status (*mcor_take)(
  mcor_context* context, const cl_int* cells, int count, bool* fresh);
/* *grown is false when no box has a new cell. take: NULL where this box has no places. */
mcor_status mcor_exchange_cells(mcor_context* context, mcor_take take, bool* grown);
mcor_status mcor_attend_growth(mcor_context* context);
mcor_status mcor_attend_rounds(mcor_context* context, int first);
void mcor_end_rounds(mcor_context* context);

#endif
