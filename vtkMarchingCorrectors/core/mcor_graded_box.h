/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_graded_box_h
#define mcor_graded_box_h

/* What the marching of leaves asks of the box; see mcor_graded_box.c. */

#include "mcor_internal.h"

/* Kernel arguments of MCOR_LEAF_BOX_PARAMS. */
#define MCOR_LEAF_BOX_ARGS(c)                                                                      \
  MCOR_INT((c)->box.is_part), MCOR_INT((c)->box.halves[0]), MCOR_INT((c)->box.halves[1]),          \
    MCOR_INT((c)->box.halves[2]), MCOR_INT((c)->box.halves[3]), MCOR_INT((c)->box.halves[4]),      \
    MCOR_INT((c)->box.halves[5]), MCOR_BUFFER(&(c)->graded.cells)

mcor_status mcor_limit_leaves(mcor_context* context);
mcor_status mcor_count_owned(mcor_context* context, int* count);

#endif
