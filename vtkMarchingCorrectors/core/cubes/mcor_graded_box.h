/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_graded_box_h
#define mcor_graded_box_h

/* What the marching of leaves asks of the box; see mcor_graded_box.c. */

#include "mcor_internal.h"

/* Kernel arguments of MCOR_LEAF_BOX_PARAMS, with these sides; those of the box. */
#define MCOR_LEAF_SIDES_ARGS(c, sides)                                                             \
  MCOR_INT((c)->box.is_part), MCOR_INT((sides)[0]), MCOR_INT((sides)[1]), MCOR_INT((sides)[2]),    \
    MCOR_INT((sides)[3]), MCOR_INT((sides)[4]), MCOR_INT((sides)[5]),                              \
    MCOR_BUFFER(&(c)->graded.cells)
#define MCOR_LEAF_BOX_ARGS(c) MCOR_LEAF_SIDES_ARGS(c, (c)->box.halves)

mcor_status mcor_limit_leaves(mcor_context* context);
mcor_status mcor_count_owned(mcor_context* context, int* count);

#endif
