/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the nodes of leaves where there may be surface (mcor_adaptive_seed.c), in slots. All cells of these
 * leaves are examined, and no more. Nodes that are certain have a side without a value; it is evaluated where a cell
 * is crossed that has them. */

#include "mcor_adaptive.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

/* Keys of all bricks whose nodes the leaves need. */
static mcor_status mcor_want_bricks(mcor_context* context, int* slots)
{
  mcor_adaptive* adaptive = &context->adaptive;
  const mcor_tree* tree = &context->tree;
  const int count = adaptive->count;
  int wanted;
  MCOR_TRY(mcor_reserve(context, &adaptive->wanted, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_count_wanted", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->finer),
    MCOR_BUFFER(&adaptive->wanted)));
  MCOR_TRY(mcor_scan(context, &adaptive->wanted, count, &wanted));
  MCOR_TRY(mcor_reserve(context, &adaptive->requests, (size_t)wanted * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_fill_wanted", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->rungs), MCOR_BUFFER(&adaptive->cells),
    MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->wanted),
    MCOR_BUFFER(&adaptive->requests)));
  MCOR_TRY(mcor_unique(context, &adaptive->requests, wanted, tree->key_limit, &adaptive->keys,
    &adaptive->index, slots));
  MCOR_RELEASE(context, &adaptive->requests, &adaptive->index);
  mcor_release_sort(context);
  return mcor_index_keys(
    context, &adaptive->keys, *slots, tree->key_limit, &adaptive->buckets, &adaptive->bucket_shift);
}

/* The first slot of each level, from their keys. */
static mcor_status mcor_find_slot_levels(mcor_context* context, int slots)
{
  const mcor_tree* tree = &context->tree;
  mcor_adaptive* adaptive = &context->adaptive;
  void* view;
  MCOR_TRY(mcor_map(context, &adaptive->keys, (size_t)slots * sizeof(cl_ulong), false, &view));
  const cl_ulong* keys = view;
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    int low = 0, high = slots;
    while (low < high)
    {
      const int middle = low + (high - low) / 2;
      const bool before = keys[middle] / MCOR_BLOCK_BRICKS < tree->rungs[l].base;
      low = before ? middle + 1 : low;
      high = before ? high : middle;
    }
    context->bricks.first_slot[l] = low;
  }
  return mcor_unmap(context, &adaptive->keys, &view);
}

/* Slots for the bricks, of which nothing is known. */
static mcor_status mcor_fill_slots(mcor_context* context, int count)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_brick_data* now = &context->bricks.now;
  const size_t n = (size_t)count, real = context->cl.real_size;
  now->count = count;
  MCOR_TRY(mcor_reserve(context, &now->bricks, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &now->known, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &now->above, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &now->valid, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &now->value, n * 64 * real));
  MCOR_TRY(mcor_reserve(context, &now->weight, n * 64 * real));
  MCOR_TRY(mcor_reserve(context, &adaptive->proofs, n));
  return MCOR_LAUNCH(context, "mcor_adaptive_bricks", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_INT(context->tree.top), MCOR_BUFFER(&adaptive->rungs), MCOR_BUFFER(&adaptive->keys),
    MCOR_BUFFER(&now->bricks));
}

/* Takes over what is known of nodes from the last set of slots. */
static mcor_status mcor_move_nodes(mcor_context* context, const mcor_brick_data* last)
{
  const mcor_brick_data* now = &context->bricks.now;
  return MCOR_LAUNCH(context, "mcor_adaptive_move", MCOR_MEDIUM, last->count,
    MCOR_SLOT_ARGS(context), MCOR_INT(last->count), MCOR_BUFFER(&context->adaptive.rungs),
    MCOR_BUFFER(&last->bricks), MCOR_BUFFER(&last->known),
    MCOR_INT((int)(64 * context->cl.real_size / sizeof(cl_uint))), MCOR_BUFFER(&last->value),
    MCOR_BUFFER(&last->weight), MCOR_BUFFER(&now->known), MCOR_BUFFER(&now->value),
    MCOR_BUFFER(&now->weight));
}

/* Evaluates those nodes of slots of the level that is seen that are neither known nor certain. */
static mcor_status mcor_evaluate_span(mcor_context* context, double iso, const mcor_span* span)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  const mcor_brick_data* now = &context->bricks.now;
  const size_t count = (size_t)span->count, lanes = (size_t)context->cl.lanes;
  return mcor_is_plane(context)
    ? MCOR_LAUNCH(context, "mcor_adaptive_plane_nodes", MCOR_HEAVY, count * 16 / lanes,
        MCOR_GRID_ARGS(context), MCOR_INT(span->first), MCOR_INT(span->count),
        MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&now->known), MCOR_BUFFER(&adaptive->proofs),
        MCOR_BUFFER(&now->value), MCOR_BUFFER(&now->weight))
    : MCOR_LAUNCH(context, "mcor_adaptive_nodes", MCOR_HEAVY, count * (lanes == 1 ? 64 : 1),
        MCOR_GRID_ARGS(context), MCOR_INT(span->first), MCOR_INT(span->count),
        MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&now->known), MCOR_REAL(iso),
        MCOR_BUFFER(&adaptive->proofs), MCOR_BUFFER(&now->value), MCOR_BUFFER(&now->weight));
}

/* Evaluates the nodes of all slots that are neither known nor certain; then the signs of all are known. iso:
 * relative to A0. */
static mcor_status mcor_evaluate_slots(mcor_context* context, double iso)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  const mcor_brick_data* now = &context->bricks.now;
  for (int l = 0; l <= context->tree.top && now->count > 0; ++l)
  {
    mcor_span span = { .first = context->bricks.first_slot[l],
      .end = context->bricks.first_slot[l + 1] };
    MCOR_TRY(mcor_view_level(context, l));
    MCOR_TRY(mcor_next_span(context, &span));
    while (span.count > 0)
    {
      MCOR_TRY(mcor_evaluate_span(context, iso, &span));
      MCOR_TRY(mcor_next_span(context, &span));
    }
  }
  MCOR_TRY(mcor_view_level(context, 0));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_sign", MCOR_MEDIUM, now->count, MCOR_INT(now->count),
    MCOR_BUFFER(&adaptive->proofs), MCOR_BUFFER(&now->value), MCOR_BUFFER(&now->weight),
    MCOR_REAL(iso), MCOR_REAL(context->run.options->node_threshold), MCOR_BUFFER(&now->known),
    MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid)));
  return mcor_spread_signs(context);
}

/* Finds the leaves in which there is surface, and evaluates what they need. */
static mcor_status mcor_complete_leaves(mcor_context* context, double iso)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_bricks* bricks = &context->bricks;
  const int count = adaptive->count;
  const size_t n = (size_t)bricks->now.count;
  MCOR_TRY(
    mcor_reserve(context, &adaptive->tables, (size_t)count * MCOR_LEAF_SLOTS * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &adaptive->mixed, (size_t)count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_tables", MCOR_MEDIUM, count, MCOR_SLOT_ARGS(context),
    MCOR_INT(count), MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->rungs),
    MCOR_BUFFER(&adaptive->cells), MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_need", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables),
    MCOR_BUFFER(&context->bricks.now.above), MCOR_BUFFER(&context->bricks.now.valid),
    MCOR_BUFFER(&adaptive->mixed), MCOR_BUFFER(&adaptive->proofs)));
  MCOR_TRY(mcor_evaluate_slots(context, iso));
  MCOR_TRY(mcor_fill(context, &bricks->cells, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &bricks->plain, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &bricks->leaf_of, n * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_adaptive_cells", MCOR_MEDIUM, count, MCOR_LEAF_ARGS(context),
    MCOR_BUFFER(&adaptive->mixed), MCOR_BUFFER(&bricks->cells), MCOR_BUFFER(&bricks->plain),
    MCOR_BUFFER(&bricks->leaf_of));
}

/* Leaves whose nodes are evaluated along with their states: more take much memory. */
#define MCOR_LEAVES_AT_ONCE (1 << 19)

/* Slots of all nodes that the leaves where there may be surface need, with what is known of them. found:
 * of mcor_choose_leaves. */
static mcor_status mcor_place_leaves(mcor_context* context, const mcor_leaf_nodes* found)
{
  mcor_adaptive* adaptive = &context->adaptive;
  int slots = 0;
  if (adaptive->count > 0)
  {
    MCOR_TRY(mcor_want_bricks(context, &slots));
    MCOR_TRY(mcor_find_slot_levels(context, slots));
  }
  mcor_brick_data last = context->bricks.now;
  context->bricks.now = (mcor_brick_data){ 0 };
  mcor_status status = mcor_fill_slots(context, slots);
  status = status == MCOR_OK && slots > 0 ? mcor_take_leaf_nodes(context, found) : status;
  if (status == MCOR_OK && found)
  {
    int taken;
    const mcor_buffer* known = &context->bricks.now.known;
    status = mcor_count_bits(context, known, known, slots, &taken);
    adaptive->dropped = adaptive->evaluated - taken;
  }
  status = status == MCOR_OK && slots > 0 ? mcor_move_nodes(context, &last) : status;
  mcor_release_brick_data(context, &last);
  return status;
}

/* Ends with all nodes of leaves where there may be surface. iso: relative to A0. */
mcor_status mcor_select_leaves(mcor_context* context, const mcor_input* input, double iso)
{
  if (!context->tree.leaves)
  {
    MCOR_TRY(mcor_make_tree(context, input));
    MCOR_TRY(context->tree.leaf_count > 0 ? mcor_write_tree(context) : MCOR_OK);
  }
  context->adaptive.count = 0;
  ++context->run.statistics->march_rounds;
  if (context->tree.leaf_count == 0) /* none is in the box */
  {
    context->bricks.now.count = 0;
    return MCOR_OK;
  }
  MCOR_TRY(mcor_find_side_flags(context, iso));
  const bool at_once = context->cl.lanes > 1 && context->bricks.now.count == 0 &&
    context->tree.leaf_count <= MCOR_LEAVES_AT_ONCE && !mcor_is_plane(context);
  context->adaptive.dropped = context->bricks.now.count == 0 ? 0 : context->adaptive.dropped;
  mcor_leaf_nodes found = { 0 };
  mcor_status status = mcor_choose_leaves(context, iso, at_once ? &found : NULL);
  if (status == MCOR_OK)
  {
    status = mcor_place_leaves(context, at_once ? &found : NULL);
  }
  MCOR_RELEASE(context, &found.value, &found.weight);
  MCOR_TRY(status);
  MCOR_TRY(mcor_evaluate_slots(context, iso));
  return mcor_complete_leaves(context, iso);
}

void mcor_release_adaptive(mcor_context* context)
{
  mcor_adaptive* g = &context->adaptive;
  MCOR_RELEASE(context, &g->rungs, &g->leaves, &g->leaf_finer, &g->regions, &g->region_keys,
    &g->region_order, &g->states, &g->chosen, &g->proofs, &g->mixed, &g->cells, &g->finer,
    &g->wanted, &g->requests, &g->index, &g->keys, &g->buckets, &g->tables, &g->quadrants, &g->flat,
    &context->grid.view_levels, &context->grid.view_inv_h);
  mcor_release_tree(&context->tree);
}
