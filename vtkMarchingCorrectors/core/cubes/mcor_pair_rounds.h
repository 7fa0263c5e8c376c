/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_pair_rounds_h
#define mcor_pair_rounds_h

/* Pairs' cells grow from box to box; see mcor_pair_rounds.c. */

#include "mcor_internal.h"

/* Goes on from `count` cells of this box that others have reached: int4, the level last. *fresh: whether one is
 * new. */
typedef mcor_status (*mcor_take)(
  mcor_context* context, const cl_int* cells, int count, bool* fresh);

/* *grown is false when no box has a new cell. take: of adaptive cubes; NULL: of uniform ones. */
mcor_status mcor_exchange_cells(mcor_context* context, mcor_take take, bool* grown);
mcor_status mcor_attend_growth(mcor_context* context);
mcor_status mcor_attend_rounds(mcor_context* context, int first);
void mcor_end_rounds(mcor_context* context);

#endif
