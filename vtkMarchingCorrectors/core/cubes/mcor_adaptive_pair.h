/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_pair_h
#define mcor_adaptive_pair_h

/* Adaptive cubes: the cells of pairs [III-C]; see mcor_adaptive_pair.c. */

#include "mcor_internal.h"

/* Leaves the cells that pairs reach, of those in mesh.used; adaptive_pairs.seeds: those that pairs mark. iso: relative
 * to A0. */
mcor_status mcor_keep_reached(mcor_context* context, double iso);
void mcor_release_adaptive_pairs(mcor_context* context);

#endif
