/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Nodes of the virtual grid: their values, and on which side of the iso value they are. In two
 * dimensions, the nodes form two layers: in the plane and above it. Each node of the upper layer
 * gets the side of the node below it. */

#include "mcor_adaptive.h"

/* Evaluates the nodes that are needed and not known yet, in all bricks. */
mcor_status mcor_evaluate_nodes(mcor_context* context)
{
  mcor_bricks* bricks = &context->bricks;
  const int count = bricks->now.count, lanes = context->cl.lanes;
  const mcor_space* space = &context->space;
  /* If a work-item has several lanes, which share the gathered particles, it evaluates a brick;
   * else it evaluates a node. In a plane, a brick has 16 nodes, and a work-item evaluates one node
   * per lane. */
  const int items = space->flat || lanes == 1 ? space->brick_nodes / lanes : 1;
  MCOR_TRY(mcor_reserve(context, &bricks->need, (size_t)count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_brick_need", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->now.known), MCOR_INT(context->adaptive.count),
    MCOR_BUFFER(&context->adaptive.proofs), MCOR_BUFFER(&bricks->need)));
  return MCOR_LAUNCH_BY_LEVEL(context, space->evaluate, items,
    bricks->first_slot, bricks->first_slot + 1, MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->need), MCOR_BUFFER(&bricks->now.value), MCOR_BUFFER(&bricks->now.weight));
}

/* Finds on which side of the iso value the nodes are, and which are valid (of enough weight), in
 * all bricks with a bit in `evaluated`. The nodes with bits in `evaluated` become known. */
mcor_status mcor_sign_nodes(mcor_context* context, const mcor_buffer* evaluated)
{
  const mcor_brick_data* now = &context->bricks.now;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_node_sides", MCOR_MEDIUM, now->count, MCOR_INT(now->count),
    MCOR_BUFFER(evaluated), MCOR_BUFFER(&now->known), MCOR_BUFFER(&now->value),
    MCOR_BUFFER(&now->weight), MCOR_REAL(context->run.iso.relative),
    MCOR_REAL(context->run.options->node_threshold), MCOR_BUFFER(&now->above),
    MCOR_BUFFER(&now->valid)));
  return context->space.axes == 3
    ? MCOR_OK
    : MCOR_LAUNCH(context, "mcor_plane_spread", MCOR_LIGHT, now->count, MCOR_INT(now->count),
        MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid));
}

/* Frees the nodes' values, which only a later call could use again. */
void mcor_release_nodes(mcor_context* context)
{
  MCOR_RELEASE(context, &context->bricks.now.value, &context->bricks.now.weight);
  context->kept.nodes = false;
}
