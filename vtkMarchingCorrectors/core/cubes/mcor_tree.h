/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_tree_h
#define mcor_tree_h

/* Adaptive cubes: which leaves the lattice is divided into. A brick of level L is 4^3 cells of the edge
 * 2^L cubes. Leaves are the largest bricks that only particles with h >= 2^L x the smallest h reach,
 * then as many smaller ones as it takes for leaves that touch to differ by one level at most. What
 * they are depends on nothing but the particles. */

#include "mcor_tree_brick.h"

/* Of keys, where points or triangles have keys: the rest holds an edge, or a cell, of the brick. */
#define MCOR_TREE_KEY_BITS 55

/* Which bricks are split, over the particles of all ranks; none with one level. */
mcor_status mcor_measure_splits(
  mcor_context* context, const mcor_input* input, mcor_globals* globals);
/* The leaves in the box. */
mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input);
void mcor_release_tree(mcor_tree* tree);

#endif
