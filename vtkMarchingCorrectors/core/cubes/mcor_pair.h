/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_pair_h
#define mcor_pair_h

/* The paper's seeds [III-C]. */

#include "mcor_adaptive.h"

/* Ends with the cells that pairs reach in bricks.cells, all of whose nodes are evaluated; bricks.seeds: those that pairs
 * mark. */
mcor_status mcor_find_reached(mcor_context* context);
void mcor_release_pairs(mcor_context* context);

#endif
