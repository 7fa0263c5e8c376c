/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_tree_brick_h
#define mcor_tree_brick_h

/* Adaptive cubes: the bricks of all levels, their numbers, keys and places. */

#include "mcor_tree_set.h"

/* Where one level's bricks are among the keys. */
static inline uint64_t mcor_tree_key(const mcor_rung* rung, const int brick[3])
{
  return rung->base +
    ((uint64_t)brick[2] * (uint64_t)rung->n[1] + (uint64_t)brick[1]) * (uint64_t)rung->n[0] +
    (uint64_t)brick[0];
}

/* Bricks of a cluster along an axis. */
#define MCOR_CLUSTER 4

/* The key of a brick's cluster among those of its level, and the brick's bit there. */
static inline uint64_t mcor_cluster_key(const mcor_rung* rung, const int brick[3])
{
  const uint64_t nx = (uint64_t)(rung->n[0] + 3) / MCOR_CLUSTER;
  const uint64_t ny = (uint64_t)(rung->n[1] + 3) / MCOR_CLUSTER;
  return ((uint64_t)(brick[2] / MCOR_CLUSTER) * ny + (uint64_t)(brick[1] / MCOR_CLUSTER)) * nx +
    (uint64_t)(brick[0] / MCOR_CLUSTER);
}
static inline int mcor_cluster_bit(const int brick[3])
{
  return (brick[0] & 3) | (brick[1] & 3) << 2 | (brick[2] & 3) << 4;
}

/* The first brick of a cluster with a key. */
static inline void mcor_first_of_cluster(const mcor_rung* rung, uint64_t key, int brick[3])
{
  const uint64_t nx = (uint64_t)(rung->n[0] + 3) / MCOR_CLUSTER;
  const uint64_t ny = (uint64_t)(rung->n[1] + 3) / MCOR_CLUSTER;
  brick[0] = MCOR_CLUSTER * (int)(key % nx);
  brick[1] = MCOR_CLUSTER * (int)(key / nx % ny);
  brick[2] = MCOR_CLUSTER * (int)(key / nx / ny);
}

/* The level of a particle: the largest one up to `top` whose smallest h it has. */
int mcor_tree_level_of(double h, double h_min, int top);

/* The highest level of a run's leaves, 0 where its cubes are uniform. */
int mcor_tree_top(const mcor_measure* measure, const mcor_options* options);

/* Clusters, or pieces of work alike, of the host between two looks at whether to go on. */
#define MCOR_TREE_STEP 4096

/* Numbers the bricks of all levels up to the one above the highest leaves'. */
mcor_status mcor_number_bricks(mcor_context* context, mcor_tree* tree);
/* Where a brick is, or with a period its image there; false: it is off the lattice. */
bool mcor_place_brick(const mcor_tree* tree, int level, const int brick[3], int placed[3]);
bool mcor_tree_is_split(const mcor_tree* tree, int level, const int brick[3]);
/* Says that there are too many leaves, or no memory for more. */
mcor_status mcor_fail_leaves(mcor_context* context);

/* mcor_tree_split.c. All bricks that are to be split, by the particles of all ranks. */
mcor_status mcor_split_bricks(mcor_context* context, const mcor_input* input, mcor_tree* tree);

/* mcor_tree_key.c. The keys of all split bricks, ascending; to be freed. */
mcor_status mcor_list_splits(
  mcor_context* context, const mcor_tree* tree, uint64_t** keys, int64_t* count);
/* Splits the bricks with these keys. */
mcor_status mcor_take_splits(
  mcor_context* context, mcor_tree* tree, const uint64_t* keys, int64_t count);

#endif
