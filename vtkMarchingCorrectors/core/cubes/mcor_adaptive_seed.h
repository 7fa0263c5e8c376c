/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_seed_h
#define mcor_adaptive_seed_h

/* Adaptive cubes: the leaves where there may be surface. */

#include "mcor_internal.h"

/* What is known of the nodes of all leaves, while slots are made. */
typedef struct mcor_leaf_nodes
{
  mcor_buffer value, weight; /* of those to examine; empty if they are not evaluated */
} mcor_leaf_nodes;

/* Takes the tree to the device. */
mcor_status mcor_write_tree(mcor_context* context);

/* Finds the leaves that may have surface: adaptive.count, cells, finer. iso: relative to A0. found: their
 * nodes' values are kept there; NULL: they are not evaluated. */
mcor_status mcor_choose_leaves(mcor_context* context, double iso, mcor_leaf_nodes* found);

/* Takes over to the slots what was found. */
mcor_status mcor_take_leaf_nodes(mcor_context* context, const mcor_leaf_nodes* found);

#endif
