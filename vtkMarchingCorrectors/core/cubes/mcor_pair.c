/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The paper's seed selection by particle pairs [III-C].
 *
 * On the lattice of each level the cells on the line between the particles of a pair are found by one rule; a cell is
 * marked where it is found on its own level's lattice. From there the surface grows through crossed faces: a
 * whole face, with the finer nodes on its edges, or a quarter of one with smaller cells beyond. So what
 * is marked, and reached, depends on nothing but the particles.
 *
 * Of uniform cubes only the bricks are evaluated that have nodes of reached cells. Of adaptive ones all leaves where
 * there may be surface are, as for complete seeds; others have no cell that could be used. */

#include "mcor_pair.h"
#include "mcor_box.h"
#include "mcor_plane.h"

/* Work-items that look for pairs. */
static size_t mcor_pair_items(const mcor_context* context)
{
  const int particles = context->cl.lanes * MCOR_PAIR_VECTORS_OF(context->cl.lanes); /* of one */
  return (size_t)((context->grid.count + particles - 1) / particles);
}

/* ---- Bricks by their place ---- */

/* With levels: bricks with cells that may be used, and the bricks that they are parts of, by their keys. */
static mcor_status mcor_find_places(mcor_context* context)
{
  const mcor_bricks* bricks = &context->bricks;
  mcor_pairs* pairs = &context->pairs;
  const int count = bricks->now.count, top = context->lattice.top;
  const int64_t keys = (int64_t)count * (top + 1);
  MCOR_RETURN_IF(keys > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "Pair seeds need bricks times levels of adaptive cubes to be at most %d; here there are %d "
    "bricks on %d levels. Use complete seeds, or a larger cube size.",
    MCOR_COUNT_LIMIT, count, top + 1);
  MCOR_TRY(mcor_reserve(context, &pairs->keys, (size_t)keys * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_keys", MCOR_LIGHT, count, MCOR_INT(count), MCOR_INT(top),
    MCOR_BUFFER(&context->adaptive.rungs), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->cells), MCOR_BUFFER(&pairs->keys)));
  MCOR_TRY(mcor_unique(context, &pairs->keys, (int)keys, context->tree.key_limit + 1,
    &pairs->place_keys, &pairs->index, &pairs->place_count));
  MCOR_TRY(
    mcor_fill(context, &pairs->place_slots, 0xff, (size_t)pairs->place_count * sizeof(cl_int)));
  MCOR_TRY(
    MCOR_LAUNCH(context, "mcor_pair_places", MCOR_LIGHT, count, MCOR_INT(count), MCOR_INT(top),
      MCOR_BUFFER(&pairs->index), MCOR_BUFFER(&bricks->cells), MCOR_BUFFER(&pairs->place_slots)));
  MCOR_RELEASE(context, &pairs->keys, &pairs->index);
  mcor_release_sort(context);
  return mcor_index_keys(context, &pairs->place_keys, pairs->place_count,
    context->tree.key_limit + 1, &pairs->buckets, &pairs->bucket_shift);
}

#define MCOR_PLACE_ARGS(c)                                                                         \
  MCOR_BLOCK_ARGS(c), MCOR_INT(mcor_is_adaptive(c)), MCOR_INT((c)->pairs.place_count),             \
    MCOR_INT((c)->pairs.bucket_shift), MCOR_BUFFER(&(c)->pairs.place_keys),                        \
    MCOR_BUFFER(&(c)->pairs.buckets), MCOR_BUFFER(&(c)->adaptive.rungs),                           \
    MCOR_BUFFER(&(c)->pairs.place_slots)

/* ---- Cells ---- */

/* Marks the cells between pairs. */
static mcor_status mcor_mark_pairs(mcor_context* context, double iso)
{
  mcor_pairs* pairs = &context->pairs;
  const size_t bytes = mcor_count_places(context) * sizeof(cl_ulong);
  MCOR_TRY(mcor_fill(context, &pairs->reached, 0, bytes));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_seed", MCOR_HEAVY, mcor_pair_items(context),
    MCOR_GRID_ARGS(context), MCOR_BUFFER(&context->grid.side_flags), MCOR_REAL(iso),
    MCOR_REAL(context->run.options->h_scale), MCOR_PLACE_ARGS(context),
    MCOR_INT(context->lattice.top), MCOR_BUFFER(&pairs->reached)));
  MCOR_TRY(mcor_reserve(context, &pairs->marked, bytes));
  MCOR_TRY(mcor_copy(context, &pairs->reached, &pairs->marked, 0, bytes));
  return mcor_fill(context, &pairs->grown, 0, bytes);
}

/* Of uniform cubes: gives slots to the bricks that have nodes of reached cells, and evaluates these. *placed: whether
 * some had none. */
static mcor_status mcor_place_reached(mcor_context* context, double iso, bool first, bool* placed)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_pairs* pairs = &context->pairs;
  cl_int flag;
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_request", MCOR_LIGHT, mcor_count_places(context),
    MCOR_BLOCK_ARGS(context), MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&bricks->bits),
    MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *placed = flag != 0 || first;
  if (!*placed)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_place_bricks(context));
  MCOR_TRY(first ? mcor_sign_nodes(context, iso, &bricks->now.known) : MCOR_OK);
  MCOR_TRY(mcor_evaluate_nodes(context));
  return mcor_sign_nodes(context, iso, &bricks->need);
}

/* What growth needs of slots. It stays where nodes have right values: in the box whose particles are on the device,
 * and the ring around it. */
static mcor_status mcor_begin_growth(mcor_context* context)
{
  mcor_buffer* domain = &context->pairs.domain;
  MCOR_TRY(mcor_find_neighbours(context));
  MCOR_TRY(mcor_fill(context, domain, 0xff, (size_t)context->bricks.now.count * sizeof(cl_ulong)));
  return mcor_clip_near(context, domain);
}

/* One round of growth; *grown is false when no cell was added. */
static mcor_status mcor_grow_reached(mcor_context* context, bool* grown)
{
  const mcor_bricks* bricks = &context->bricks;
  mcor_pairs* pairs = &context->pairs;
  cl_int flag;
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_grow", MCOR_MEDIUM, bricks->now.count,
    MCOR_INT(bricks->now.count), MCOR_BUFFER(&bricks->neighbours), MCOR_LEAF_ARGS(context),
    MCOR_BUFFER(&bricks->plain), MCOR_BUFFER(&bricks->leaf_of), MCOR_BUFFER(&bricks->now.bricks),
    MCOR_BUFFER(&bricks->cells), MCOR_PLACE_ARGS(context), MCOR_BUFFER(&pairs->domain),
    MCOR_BUFFER(&pairs->grown), MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *grown = flag != 0;
  ++context->run.statistics->march_rounds;
  return MCOR_OK;
}

/* Of mcor_exchange_cells. */
static mcor_status mcor_take_reached(
  mcor_context* context, const cl_int* cells, int count, bool* fresh)
{
  mcor_pairs* pairs = &context->pairs;
  cl_int flag;
  MCOR_TRY(mcor_write(context, &pairs->heard, cells, (size_t)count * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_pair_take", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&pairs->heard), MCOR_PLACE_ARGS(context), MCOR_BUFFER(&pairs->reached),
    MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *fresh = flag != 0;
  return MCOR_OK;
}

mcor_status mcor_find_reached(mcor_context* context, double iso)
{
  mcor_bricks* bricks = &context->bricks;
  mcor_pairs* pairs = &context->pairs;
  const bool adaptive = mcor_is_adaptive(context);
  if (mcor_count_places(context) == 0)
  {
    return mcor_attend_growth(context);
  }
  MCOR_TRY(adaptive ? mcor_find_places(context) : MCOR_OK);
  MCOR_TRY(mcor_mark_pairs(context, iso));
  mcor_end_rounds(context);
  for (bool first = true, more = true; more; first = false)
  {
    bool placed = false;
    MCOR_TRY(adaptive ? MCOR_OK : mcor_place_reached(context, iso, first, &placed));
    MCOR_TRY(first || placed ? mcor_begin_growth(context) : MCOR_OK);
    for (bool grown = true; grown;)
    {
      MCOR_TRY(mcor_grow_reached(context, &grown));
    }
    more = placed;
    MCOR_TRY(more ? MCOR_OK : mcor_exchange_cells(context, mcor_take_reached, &more));
  }
  const int count = bricks->now.count;
  MCOR_TRY(mcor_reserve(context, &pairs->cells, (size_t)count * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &pairs->seeds, (size_t)count * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, "mcor_pair_fill", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&bricks->now.bricks), MCOR_PLACE_ARGS(context), MCOR_BUFFER(&pairs->reached),
    MCOR_BUFFER(&pairs->marked), MCOR_BUFFER(&pairs->cells), MCOR_BUFFER(&pairs->seeds));
}

void mcor_release_pairs(mcor_context* context)
{
  mcor_pairs* p = &context->pairs;
  MCOR_RELEASE(context, &p->keys, &p->index, &p->place_keys, &p->buckets, &p->place_slots,
    &p->reached, &p->marked, &p->cells, &p->seeds, &p->domain, &p->grown, &p->heard, &p->found);
}
