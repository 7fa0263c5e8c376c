/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection by particle pairs [III-C].
 *
 * Adaptive cubes: a pair is what it is for uniform ones. On the lattice of each level the cells on the line
 * between its particles are found by one rule; a cell of a leaf is marked
 * where it is found on its own level's lattice. From there the surface grows through crossed faces: a
 * whole face, with the finer nodes on its edges, or a quarter of one with smaller cells beyond. So what
 * is marked, and reached, depends on nothing but the particles.
 *
 * All leaves where there may be surface have their nodes evaluated, as for complete seeds; others have no
 * cell that could be used. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_pair_rounds.h"
#include "mcor_plane.h"

/* Work-items that look for pairs. */
static size_t mcor_pair_items(const mcor_context* context)
{
  const int particles = context->cl.lanes * MCOR_PAIR_VECTORS_OF(context->cl.lanes); /* of one */
  return (size_t)((context->grid.count + particles - 1) / particles);
}

/* Places the bricks that have nodes of cells between pairs, and lists these cells. iso: relative to
 * A0. */
mcor_status mcor_seed_pairs(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  const size_t bricks_of_blocks = (size_t)bricks->block_count * MCOR_BLOCK_BRICKS;
  mcor_buffer* pair_cells = &bricks->pair_cells;
  MCOR_TRY(mcor_fill(context, pair_cells, 0, bricks_of_blocks * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_seed", MCOR_HEAVY, mcor_pair_items(context),
    MCOR_GRID_ARGS(context), MCOR_BUFFER(&context->grid.side_flags), MCOR_REAL(iso),
    MCOR_REAL(context->run.options->h_scale), MCOR_BLOCK_ARGS(context), MCOR_BUFFER(pair_cells)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_request", MCOR_LIGHT, bricks_of_blocks,
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(pair_cells), MCOR_BUFFER(&bricks->bits)));
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(mcor_sign_nodes(context, iso, &bricks->now.known));
  MCOR_TRY(
    mcor_fill(context, &bricks->now.examined, 0, (size_t)bricks->now.count * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_fill", MCOR_MEDIUM, bricks->now.count,
    MCOR_BLOCK_ARGS(context), MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(pair_cells), MCOR_BUFFER(&bricks->now.cells)));
  mcor_release(context, pair_cells);
  return MCOR_OK;
}

/* ---- Adaptive cubes: leaves by their place ---- */

/* Leaves where there may be surface, and the bricks that they are parts of, by their keys. */
static mcor_status mcor_find_places(mcor_context* context)
{
  mcor_adaptive* adaptive = &context->adaptive;
  mcor_adaptive_pairs* pairs = &context->adaptive_pairs;
  const int count = adaptive->count, top = context->tree.top;
  const int64_t keys = (int64_t)count * (top + 1);
  MCOR_RETURN_IF(keys > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "Pairs as seeds are limited to %d bricks times levels of adaptive cubes; here are %d bricks on "
    "%d "
    "levels. Use complete seeds, or a larger cube size.",
    MCOR_COUNT_LIMIT, count, top + 1);
  MCOR_TRY(mcor_reserve(context, &adaptive->requests, (size_t)keys * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_pair_keys", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_INT(top), MCOR_BUFFER(&adaptive->rungs), MCOR_BUFFER(&adaptive->cells),
    MCOR_BUFFER(&adaptive->requests)));
  MCOR_TRY(mcor_unique(context, &adaptive->requests, (int)keys, context->tree.key_limit,
    &pairs->place_keys, &adaptive->index, &pairs->place_count));
  MCOR_TRY(
    mcor_fill(context, &pairs->place_leaves, 0xff, (size_t)pairs->place_count * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_pair_places", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_INT(top), MCOR_BUFFER(&adaptive->index), MCOR_BUFFER(&pairs->place_leaves)));
  MCOR_RELEASE(context, &adaptive->requests, &adaptive->index);
  mcor_release_sort(context);
  return MCOR_OK;
}

#define MCOR_PLACE_ARGS(c)                                                                         \
  MCOR_INT((c)->adaptive_pairs.place_count), MCOR_BUFFER(&(c)->adaptive.rungs),                    \
    MCOR_BUFFER(&(c)->adaptive_pairs.place_keys), MCOR_BUFFER(&(c)->adaptive_pairs.place_leaves)

/* ---- Cells ---- */

/* Marks the cells between pairs. */
static mcor_status mcor_mark_pairs(mcor_context* context, double iso)
{
  mcor_adaptive_pairs* pairs = &context->adaptive_pairs;
  MCOR_TRY(
    mcor_fill(context, &pairs->reached, 0, (size_t)context->adaptive.count * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, "mcor_adaptive_pair_seed", MCOR_HEAVY, mcor_pair_items(context),
    MCOR_GRID_ARGS(context), MCOR_BUFFER(&context->grid.side_flags), MCOR_REAL(iso),
    MCOR_REAL(context->run.options->h_scale), MCOR_PLACE_ARGS(context), MCOR_INT(context->tree.top),
    MCOR_BUFFER(&pairs->reached));
}

/* One round of growth; *grown is false when no cell was added. */
static mcor_status mcor_grow_reached(mcor_context* context, bool* grown)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  mcor_adaptive_pairs* pairs = &context->adaptive_pairs;
  const mcor_brick_data* now = &context->bricks.now;
  cl_int flag;
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_pair_grow", MCOR_MEDIUM, adaptive->count,
    MCOR_INT(adaptive->count), MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->finer),
    MCOR_BUFFER(&adaptive->tables), MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid),
    MCOR_BUFFER(&adaptive->mixed), MCOR_BUFFER(&adaptive->cells), MCOR_PLACE_ARGS(context),
    MCOR_BUFFER(&pairs->domain), MCOR_BUFFER(&pairs->grown), MCOR_BUFFER(&pairs->reached),
    MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *grown = flag != 0;
  ++context->run.statistics->march_rounds;
  return MCOR_OK;
}

/* Growth stays where nodes have right values: in the box whose particles are on the device, and the ring
 * around it. */
static mcor_status mcor_limit_growth(mcor_context* context)
{
  mcor_adaptive_pairs* pairs = &context->adaptive_pairs;
  const int count = context->adaptive.count;
  const size_t bytes = (size_t)count * sizeof(cl_ulong);
  MCOR_TRY(mcor_reserve(context, &pairs->grown, bytes));
  MCOR_TRY(mcor_fill(context, &pairs->domain, 0xff, bytes));
  MCOR_TRY(mcor_clip_near(context, &pairs->domain));
  return mcor_fill(context, &pairs->grown, 0, bytes);
}

/* Of mcor_exchange_cells. */
static mcor_status mcor_take_reached(
  mcor_context* context, const cl_int* cells, int count, bool* fresh)
{
  mcor_adaptive_pairs* pairs = &context->adaptive_pairs;
  cl_int flag;
  MCOR_TRY(mcor_write(context, &pairs->heard, cells, (size_t)count * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_pair_take", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&pairs->heard), MCOR_PLACE_ARGS(context), MCOR_BUFFER(&pairs->reached),
    MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *fresh = flag != 0;
  return MCOR_OK;
}

mcor_status mcor_keep_reached(mcor_context* context, double iso)
{
  mcor_adaptive_pairs* pairs = &context->adaptive_pairs;
  const int count = context->adaptive.count;
  const size_t bytes = (size_t)count * sizeof(cl_ulong);
  MCOR_TRY(mcor_find_places(context));
  MCOR_TRY(mcor_mark_pairs(context, iso));
  MCOR_TRY(mcor_reserve(context, &pairs->seeds, bytes));
  MCOR_TRY(mcor_copy(context, &pairs->reached, &pairs->seeds, 0, bytes));
  MCOR_TRY(mcor_limit_growth(context));
  mcor_end_rounds(context);
  for (bool grown = true; grown;)
  {
    MCOR_TRY(mcor_grow_reached(context, &grown));
    MCOR_TRY(grown ? MCOR_OK : mcor_exchange_cells(context, mcor_take_reached, &grown));
  }
  return MCOR_LAUNCH(context, "mcor_adaptive_pair_keep", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&context->mesh.used));
}

void mcor_release_adaptive_pairs(mcor_context* context)
{
  mcor_adaptive_pairs* p = &context->adaptive_pairs;
  MCOR_RELEASE(context, &p->place_keys, &p->place_leaves, &p->reached, &p->seeds, &p->domain,
    &p->grown, &p->heard, &p->found);
}
