/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_tree_h
#define mcor_tree_h

/* Adaptive cubes: the leaves that the lattice is divided into. A brick of level L is 4^3 cells,
 * each 2^L cubes long. It may be a leaf if every particle that reaches it has h >= 2^L times the
 * smallest h. Leaves are as large as this allows; then more bricks are split until leaves that
 * touch differ by one level at most. The leaves depend on the particles alone. */

#include "mcor_internal.h"

/* MCOR_LEAF_LIMIT: the most leaves. MCOR_SPLIT_LIMIT: the most split bricks. A split brick has 8
 * parts (in a plane, 4). A part is a leaf or is split, too. So each split brick adds seven leaves
 * (in a plane, three). */
#define MCOR_LEAF_LIMIT (INT32_MAX / 64)
#define MCOR_SPLIT_LIMIT (MCOR_LEAF_LIMIT / 7)

/* mcor_tree_brick.c. Adds bricks of a cluster of 4^3 bricks to a set. key: the key of the cluster's
 * first brick; bricks: the mask of the bricks to add. Returns false if memory ran out, or if the
 * set already has more than MCOR_SPLIT_LIMIT bricks. */
bool mcor_set_add(mcor_brick_set* set, uint64_t key, uint64_t bricks);
/* Whether the sets of all levels together would make too many leaves. */
bool mcor_are_too_many(const mcor_brick_set* levels);

/* Number of bricks of a cluster along an axis. */
#define MCOR_CLUSTER 4

/* mcor_cluster_of returns, from a brick's key, the key of the brick's cluster; mcor_cluster_bit
 * returns the number of the brick's bit in the cluster's mask. */
static inline uint64_t mcor_cluster_of(uint64_t key)
{
  return key & ~UINT64_C(0xdb); /* x, y and z have three bits each */
}
static inline int mcor_cluster_bit(uint64_t key)
{
  return (int)((key & 3) | (key >> 3 & 3) << 2 | (key >> 6 & 3) << 4);
}

/* A cluster has four layers across an axis. Returns the mask of the first `count` layers. */
static inline uint64_t mcor_layers(int axis, int count)
{
  static const uint64_t layers[3][5] = { { 0, 0x1111111111111111, 0x3333333333333333,
                                           0x7777777777777777, UINT64_MAX },
    { 0, 0x000f000f000f000f, 0x00ff00ff00ff00ff, 0x0fff0fff0fff0fff, UINT64_MAX },
    { 0, 0xffff, 0xffffffff, 0xffffffffffff, UINT64_MAX } };
  return layers[axis][count];
}
/* Returns the mask of a cluster's bricks between `first` and `last`; there must be at least one.
 * cluster: the position of the cluster's first brick. */
static inline uint64_t mcor_bricks_between(
  const int first[3], const int last[3], const int cluster[3])
{
  uint64_t bricks = UINT64_MAX;
  for (int a = 0; a < 3; ++a)
  {
    const int low = first[a] - cluster[a], end = last[a] - cluster[a] + 1;
    bricks &=
      mcor_layers(a, end < MCOR_CLUSTER ? end : MCOR_CLUSTER) & ~mcor_layers(a, low > 0 ? low : 0);
  }
  return bricks;
}

/* Returns the level of a particle: the largest level L up to `top` with 2^L h_min <= h. */
int mcor_tree_level_of(double h, double h_min, int top);

/* How many clusters or other elements the host treats between two reports of progress. */
#define MCOR_TREE_STEP 4096

/* Begins a tree of the lattice, and numbers the blocks of all levels up to the level above the
 * highest leaves. */
mcor_status mcor_number_bricks(mcor_context* context, mcor_tree* tree);
/* Returns a number above the keys of all bricks. */
static inline uint64_t mcor_tree_key_limit(const mcor_tree* tree)
{
  return tree->lattice->rungs[tree->top + 2].base * MCOR_BLOCK_BRICKS;
}
/* Sets `placed` to the position of a brick or, with a period, of its image in the first period.
 * Returns false if the brick is off the lattice. */
bool mcor_place_brick(const mcor_tree* tree, int level, const int brick[3], int placed[3]);
/* Whether all bricks of a cluster are on the lattice or, with a period, in the first period. first:
 * the position of the cluster's first brick. */
bool mcor_has_cluster(const mcor_tree* tree, int level, const int first[3]);
/* Adds a brick, or its image in the first period, to a set, unless the brick is off the lattice.
 * Returns false if memory ran out, or if the set is too large, see mcor_set_add. */
bool mcor_set_add_brick(const mcor_tree* tree, int level, const int brick[3], mcor_brick_set* set);
/* Fails if `fit` is false: there are too many leaves, or memory for them ran out. */
mcor_status mcor_leaves_fit(mcor_context* context, bool fit);

/* mcor_tree_split.c. Finds all split bricks, from the particles of all ranks. */
mcor_status mcor_split_bricks(mcor_context* context, const mcor_input* input, mcor_tree* tree);

/* mcor_tree_brick.c. Lists the keys of all split bricks, ascending. Free them with free(). */
mcor_status mcor_list_splits(
  mcor_context* context, const mcor_tree* tree, uint64_t** keys, int64_t* count);
void mcor_brick_of_key(const mcor_rung* rung, uint64_t key, int brick[3]);
/* Splits the bricks with these keys. Fails if a key belongs to no brick of this tree's lattice, or
 * to one of level 0, which cannot be split. */
mcor_status mcor_take_splits(
  mcor_context* context, mcor_tree* tree, const uint64_t* keys, int64_t count);

/* How many bits a brick's key takes in the key of a point or triangle. The other bits tell the edge
 * or the cell of the brick. */
#define MCOR_TREE_KEY_BITS 55

/* Lists in `globals` all split bricks, from the particles of all ranks; with one level, none. */
mcor_status mcor_measure_splits(
  mcor_context* context, const mcor_input* input, mcor_globals* globals);
/* Makes the leaves near the box, and the blocks of all bricks whose nodes the leaves may need. */
mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input);
void mcor_release_tree(mcor_tree* tree);

#endif
