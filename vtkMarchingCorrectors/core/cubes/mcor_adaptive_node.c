/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the nodes of leaves where there may be surface (mcor_adaptive_seed.c), in slots. All cells of these
 * leaves are examined, and no more. Nodes that are certain have a side without a value; it is evaluated where a cell
 * is crossed that has them. */

#include "mcor_adaptive.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

/* Makes the blocks of all levels that have bricks whose nodes the leaves need, and requests these bricks. */
static mcor_status mcor_request_wanted(mcor_context* context)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_bricks* bricks = &context->bricks;
  const int count = adaptive->count, plane = mcor_is_plane(context);
  const uint64_t limit = mcor_tree_key_limit(&context->tree) / MCOR_BLOCK_BRICKS;
  int wanted;
  MCOR_TRY(mcor_reserve(context, &adaptive->wanted, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_count_blocks", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(plane), MCOR_BUFFER(&context->bricks.rungs), MCOR_BUFFER(&adaptive->cells),
    MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->wanted)));
  MCOR_TRY(mcor_scan(context, &adaptive->wanted, count, &wanted));
  MCOR_TRY(mcor_reserve(context, &bricks->child_keys, (size_t)wanted * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_fill_blocks", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(plane), MCOR_BUFFER(&context->bricks.rungs), MCOR_BUFFER(&adaptive->cells),
    MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->wanted),
    MCOR_BUFFER(&bricks->child_keys)));
  MCOR_TRY(mcor_unique(context, &bricks->child_keys, wanted, limit, &bricks->block_keys,
    &bricks->child_index, &bricks->block_count));
  MCOR_RELEASE(context, &bricks->child_keys, &bricks->child_index);
  mcor_release_sort(context);
  MCOR_TRY(mcor_index_keys(context, &bricks->block_keys, bricks->block_count, limit,
    &bricks->block_buckets, &bricks->block_shift));
  const size_t words = (size_t)bricks->block_count * MCOR_BLOCK_WORDS;
  MCOR_TRY(mcor_fill(context, &bricks->bits, 0, words * sizeof(cl_uint)));
  MCOR_TRY(mcor_fill(context, &bricks->seed_bits, 0, words * sizeof(cl_uint)));
  return MCOR_LAUNCH(context, "mcor_adaptive_request", MCOR_MEDIUM, count, MCOR_BLOCK_ARGS(context),
    MCOR_INT(count), MCOR_INT(plane), MCOR_BUFFER(&adaptive->cells), MCOR_BUFFER(&adaptive->finer),
    MCOR_BUFFER(&bricks->bits));
}

/* The first slot of each level, from that of its first block. */
static mcor_status mcor_find_slot_levels(mcor_context* context)
{
  const mcor_tree* tree = &context->tree;
  mcor_bricks* bricks = &context->bricks;
  const int blocks = bricks->block_count;
  void* view;
  MCOR_TRY(mcor_map(context, &bricks->block_keys, (size_t)blocks * sizeof(cl_ulong), false, &view));
  const cl_ulong* keys = view;
  int first[MCOR_TREE_LEVEL_LIMIT + 2];
  for (int l = 0, block = 0; l <= tree->top + 1; ++l)
  {
    while (block < blocks && keys[block] < tree->lattice->rungs[l].base)
    {
      ++block;
    }
    first[l] = block;
  }
  MCOR_TRY(mcor_unmap(context, &bricks->block_keys, &view));
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    MCOR_TRY(mcor_read(context, &bricks->base, (size_t)first[l] * MCOR_BLOCK_WORDS * sizeof(cl_int),
      &bricks->first_slot[l], sizeof(cl_int)));
  }
  return MCOR_OK;
}

/* Whether a proof is tried for slots: MCOR_LEAF_PROOFS of the kernels. */
static bool mcor_tries_proofs(const mcor_context* context)
{
  const mcor_options* options = context->run.options;
  return options->field == MCOR_WEIGHT_SUM && options->sph_kernel != MCOR_M_PRIME_4 &&
    context->cl.lanes > 1 && !mcor_is_plane(context);
}

/* Calls for all slots, level by level, each seen in its cells. */
static mcor_status mcor_evaluate_levels(mcor_context* context, bool prove)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  const mcor_brick_data* now = &context->bricks.now;
  for (int l = 0; l <= context->tree.top; ++l)
  {
    mcor_span span = { .first = context->bricks.first_slot[l],
      .end = context->bricks.first_slot[l + 1] };
    MCOR_TRY(mcor_view_level(context, l));
    MCOR_TRY(mcor_next_span(context, &span));
    while (span.count > 0)
    {
      MCOR_TRY(prove ? MCOR_LAUNCH(context, "mcor_adaptive_prove", MCOR_HEAVY, span.count,
                         MCOR_GRID_ARGS(context), MCOR_INT(span.first), MCOR_INT(span.count),
                         MCOR_BUFFER(&now->bricks), MCOR_BUFFER(&now->known),
                         MCOR_REAL(context->run.iso.relative), MCOR_BUFFER(&adaptive->proofs))
                     : mcor_evaluate_needed(context, span.first, span.count));
      MCOR_TRY(mcor_next_span(context, &span));
    }
  }
  return mcor_view_level(context, 0);
}

/* Evaluates the nodes of all slots that are neither known nor certain; then the signs of all are known. */
static mcor_status mcor_evaluate_slots(mcor_context* context)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  const mcor_brick_data* now = &context->bricks.now;
  if (now->count == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_tries_proofs(context) ? mcor_evaluate_levels(context, true) : MCOR_OK);
  MCOR_TRY(mcor_reserve(context, &context->bricks.need, (size_t)now->count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_unknown", MCOR_LIGHT, now->count,
    MCOR_INT(now->count), MCOR_BUFFER(&now->known), MCOR_BUFFER(&adaptive->proofs),
    MCOR_BUFFER(&context->bricks.need)));
  MCOR_TRY(mcor_evaluate_levels(context, false));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_sign", MCOR_MEDIUM, now->count, MCOR_INT(now->count),
    MCOR_BUFFER(&adaptive->proofs), MCOR_BUFFER(&now->value), MCOR_BUFFER(&now->weight),
    MCOR_REAL(context->run.iso.relative), MCOR_REAL(context->run.options->node_threshold),
    MCOR_BUFFER(&now->known), MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid)));
  return mcor_spread_signs(context);
}

/* Finds the leaves in which there is surface, and evaluates what they need. */
static mcor_status mcor_complete_leaves(mcor_context* context)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_bricks* bricks = &context->bricks;
  const int count = adaptive->count;
  const size_t n = (size_t)bricks->now.count;
  MCOR_TRY(
    mcor_reserve(context, &adaptive->tables, (size_t)count * MCOR_LEAF_SLOTS * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &adaptive->mixed, (size_t)count));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_tables", MCOR_MEDIUM, count,
    MCOR_BRICK_ARGS(context), MCOR_INT(count), MCOR_INT(mcor_is_plane(context)),
    MCOR_BUFFER(&adaptive->cells), MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_need", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->finer), MCOR_BUFFER(&adaptive->tables),
    MCOR_BUFFER(&context->bricks.now.above), MCOR_BUFFER(&context->bricks.now.valid),
    MCOR_BUFFER(&adaptive->mixed), MCOR_BUFFER(&adaptive->proofs)));
  MCOR_TRY(mcor_evaluate_slots(context));
  MCOR_TRY(mcor_fill(context, &bricks->cells, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_fill(context, &bricks->plain, 0, n * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &bricks->leaf_of, n * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_adaptive_cells", MCOR_MEDIUM, count, MCOR_LEAF_ARGS(context),
    MCOR_BUFFER(&adaptive->mixed), MCOR_BUFFER(&bricks->cells), MCOR_BUFFER(&bricks->plain),
    MCOR_BUFFER(&bricks->leaf_of));
}

/* Slots of all nodes that the leaves where there may be surface need, with what is known of them. found:
 * of mcor_choose_leaves. */
static mcor_status mcor_place_leaves(mcor_context* context, const mcor_leaf_nodes* found)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_brick_data* now = &context->bricks.now;
  if (adaptive->count == 0)
  {
    mcor_release_brick_data(context, now);
    adaptive->dropped = found ? adaptive->evaluated : adaptive->dropped;
    return MCOR_OK;
  }
  MCOR_TRY(mcor_request_wanted(context));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(mcor_find_slot_levels(context));
  MCOR_TRY(mcor_reserve(context, &adaptive->proofs, (size_t)now->count));
  MCOR_TRY(mcor_take_leaf_nodes(context, found));
  if (found)
  {
    int taken;
    MCOR_TRY(mcor_count_bits(context, &now->known, &now->known, now->count, &taken));
    adaptive->dropped = adaptive->evaluated - taken;
  }
  return MCOR_OK;
}

/* Ends with all nodes of leaves where there may be surface. */
mcor_status mcor_select_leaves(mcor_context* context, const mcor_input* input)
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
  MCOR_TRY(mcor_find_side_flags(context));
  const bool at_once =
    context->cl.lanes > 1 && context->bricks.now.count == 0 && !mcor_is_plane(context);
  context->adaptive.dropped = context->bricks.now.count == 0 ? 0 : context->adaptive.dropped;
  mcor_leaf_nodes found = { 0 };
  mcor_status status = mcor_choose_leaves(context, at_once ? &found : NULL);
  if (status == MCOR_OK)
  {
    status = mcor_place_leaves(context, at_once ? &found : NULL);
  }
  MCOR_RELEASE(context, &found.value, &found.weight, &found.place, &found.part_value,
    &found.part_weight, &found.counts);
  MCOR_TRY(status);
  MCOR_TRY(mcor_evaluate_slots(context));
  return mcor_complete_leaves(context);
}

void mcor_release_adaptive(mcor_context* context)
{
  mcor_adaptive* g = &context->adaptive;
  MCOR_RELEASE(context, &g->leaves, &g->leaf_finer, &g->regions, &g->region_keys, &g->region_order,
    &g->states, &g->chosen, &g->proofs, &g->mixed, &g->cells, &g->finer, &g->wanted, &g->tables,
    &g->quadrants, &g->flat, &context->grid.view_levels, &context->grid.view_inv_h);
  mcor_release_tree(&context->tree);
}
