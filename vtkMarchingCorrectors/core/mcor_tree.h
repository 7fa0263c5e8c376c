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

/* Of keys, where points have keys: the rest holds an edge of the brick. */
#define MCOR_TREE_KEY_BITS 55

/* More leaves than this are not made. Of the parts of each split brick, 8, all but those that are split
 * are leaves: seven more for each brick at least. */
#define MCOR_LEAF_LIMIT (INT32_MAX / 64)
#define MCOR_SPLIT_LIMIT (MCOR_LEAF_LIMIT / 7)

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

/* mcor_tree_set.c */
bool mcor_set_has(const mcor_brick_set* set, uint64_t key);
/* False where memory ran out, or there would be too many leaves: before the sets take much of either. */
bool mcor_set_add(mcor_brick_set* set, uint64_t key);
bool mcor_set_add_all(mcor_brick_set* set, const mcor_brick_set* other);
/* Whether the sets of all levels together make too many leaves. */
bool mcor_are_too_many(const mcor_brick_set* levels);
void mcor_set_free(mcor_brick_set* set);

bool mcor_tree_is_split(const mcor_tree* tree, int level, const int brick[3]);
/* Which bricks are split, over the particles of all ranks; none with one level. */
mcor_status mcor_measure_splits(
  mcor_context* context, const mcor_input* input, mcor_globals* globals);
/* The leaves in the box. */
mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input);
void mcor_release_tree(mcor_tree* tree);

#endif
