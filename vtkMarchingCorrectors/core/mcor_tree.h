/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_tree_h
#define mcor_tree_h

/* Adaptive cubes: which leaves the lattice is divided into. A brick of level L is 4^3 cells of the edge
 * 2^L cubes. Leaves are the largest bricks that only particles with h >= 2^L x the smallest h reach,
 * then as many smaller ones as it takes for leaves that touch to differ by one level at most. What
 * they are depends on nothing but the particles. */

#include "mcor_internal.h"

#define MCOR_NO_BRICK UINT64_MAX

/* Where one level's bricks are among the keys. */
static inline uint64_t mcor_tree_key(const mcor_rung* rung, const int brick[3])
{
  return rung->base +
    ((uint64_t)brick[2] * (uint64_t)rung->n[1] + (uint64_t)brick[1]) * (uint64_t)rung->n[0] +
    (uint64_t)brick[0];
}

/* The level of a particle: the largest one up to `top` whose smallest h it has. */
int mcor_tree_level_of(double h, double h_min, int top);

/* The highest level of a run's leaves, 0 where its cubes are uniform. */
int mcor_tree_top(const mcor_measure* measure, const mcor_options* options);

bool mcor_tree_is_split(const mcor_tree* tree, int level, const int brick[3]);
mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input);
void mcor_release_tree(mcor_tree* tree);

#endif
