/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_tree_set_h
#define mcor_tree_set_h

/* Adaptive cubes: sets of bricks of one level, in clusters. */

#include "mcor_internal.h"

/* More leaves than this are not made. Of the parts of each split brick, 8, all but those that are split
 * are leaves: seven more for each brick at least. */
#define MCOR_LEAF_LIMIT (INT32_MAX / 64)
#define MCOR_SPLIT_LIMIT (MCOR_LEAF_LIMIT / 7)

/* Those bricks of a cluster that are in the set. */
uint64_t mcor_set_find(const mcor_brick_set* set, uint64_t key);
/* False where memory ran out, or there would be too many leaves: before the sets take much of either. */
bool mcor_set_add(mcor_brick_set* set, uint64_t key, uint64_t bricks);
bool mcor_set_add_all(mcor_brick_set* set, const mcor_brick_set* other);
/* Whether the sets of all levels together make too many leaves. */
bool mcor_are_too_many(const mcor_brick_set* levels);
void mcor_set_free(mcor_brick_set* set);

#endif
