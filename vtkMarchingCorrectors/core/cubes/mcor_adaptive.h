/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_h
#define mcor_adaptive_h

/* Adaptive cubes: what takes the place of seeds and march. */

#include "mcor_internal.h"

/* The leaves where there may be surface, with their nodes' values; then their vertices and
 * triangles. iso: relative to A0. */
mcor_status mcor_select_leaves(mcor_context* context, const mcor_input* input, double iso);
mcor_status mcor_march_leaves(mcor_context* context, double iso);
void mcor_release_adaptive(mcor_context* context);

#endif
