/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the cells of pairs [III-C]. A pair is what it is for uniform cubes. On the lattice of each
 * level the cells on the line between its particles are found by one rule; a cell of a leaf is marked
 * where it is found on its own level's lattice. From there the surface grows through crossed faces: a
 * whole face, with the finer nodes on its edges, or a quarter of one with smaller cells beyond. So what
 * is marked, and reached, depends on nothing but the particles.
 *
 * All leaves where there may be surface have their nodes evaluated, as for complete seeds; others have no
 * cell that could be used. */

#include "mcor_graded_pair.h"
#include "mcor_box.h"
#include "mcor_tree.h"

#include <stdlib.h>

/* ---- Leaves by their place ---- */

/* A brick by its key: number of its leaf, or -1. */
typedef struct mcor_place
{
  uint64_t key;
  cl_int leaf;
} mcor_place;

static int mcor_compare_places(const void* a, const void* b)
{
  const uint64_t x = ((const mcor_place*)a)->key, y = ((const mcor_place*)b)->key;
  return (x > y) - (x < y);
}

/* Bricks that leaves are parts of, by level. */
typedef struct mcor_above
{
  mcor_brick_set sets[MCOR_TREE_LEVEL_LIMIT + 2];
} mcor_above;

/* False where memory ran out. */
static bool mcor_add_above(
  const mcor_tree* tree, const cl_int* leaves, int count, mcor_above* above)
{
  for (int i = 0; i < count; ++i)
  {
    const cl_int* leaf = leaves + 4 * (int64_t)i;
    int brick[3] = { leaf[0], leaf[1], leaf[2] };
    for (int level = leaf[3] + 1; level <= tree->top; ++level)
    {
      for (int a = 0; a < 3; ++a)
      {
        brick[a] /= 2;
      }
      const uint64_t key = mcor_cluster_key(&tree->rungs[level], brick);
      const uint64_t bit = UINT64_C(1) << mcor_cluster_bit(brick);
      if (mcor_set_find(&above->sets[level], key) & bit)
      {
        break;
      }
      if (!mcor_set_add(&above->sets[level], key, bit))
      {
        return false;
      }
    }
  }
  return true;
}

static size_t mcor_count_above(const mcor_above* above)
{
  size_t count = 0;
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    count += above->sets[l].count;
  }
  return count;
}

/* Lists the bricks of a set; returns where the next place goes. */
static mcor_place* mcor_list_set(const mcor_rung* rung, const mcor_brick_set* set, mcor_place* to)
{
  for (size_t i = 0; i < set->capacity; ++i)
  {
    int first[3];
    mcor_first_of_cluster(rung, set->slots[i].key, first);
    for (int bit = 0; bit < 64; ++bit)
    {
      const int brick[3] = { first[0] + (bit & 3), first[1] + (bit >> 2 & 3),
        first[2] + (bit >> 4) };
      if (set->slots[i].bricks >> bit & 1)
      {
        *to++ = (mcor_place){ mcor_tree_key(rung, brick), -1 };
      }
    }
  }
  return to;
}

static void mcor_list_places(const mcor_tree* tree, const cl_int* leaves, int count,
  const mcor_above* above, mcor_place* places)
{
  mcor_place* to = places;
  for (int i = 0; i < count; ++i)
  {
    const cl_int* leaf = leaves + 4 * (int64_t)i;
    *to++ = (mcor_place){ mcor_tree_key(&tree->rungs[leaf[3]], leaf), i };
  }
  for (int level = 1; level <= tree->top; ++level)
  {
    to = mcor_list_set(&tree->rungs[level], &above->sets[level], to);
  }
  qsort(places, (size_t)(to - places), sizeof *places, mcor_compare_places);
}

/* Takes the places, sorted, to the device. */
static mcor_status mcor_write_places(mcor_context* context, const mcor_place* places, size_t count)
{
  mcor_graded_pairs* pairs = &context->graded_pairs;
  void *keys, *leaves;
  pairs->place_count = (int)count;
  MCOR_TRY(mcor_reserve(context, &pairs->place_keys, count * sizeof(cl_ulong)));
  MCOR_TRY(mcor_reserve(context, &pairs->place_leaves, count * sizeof(cl_int)));
  MCOR_TRY(mcor_map(context, &pairs->place_keys, count * sizeof(cl_ulong), true, &keys));
  for (size_t i = 0; i < count; ++i)
  {
    ((cl_ulong*)keys)[i] = places[i].key;
  }
  MCOR_TRY(mcor_unmap(context, &pairs->place_keys, &keys));
  MCOR_TRY(mcor_map(context, &pairs->place_leaves, count * sizeof(cl_int), true, &leaves));
  for (size_t i = 0; i < count; ++i)
  {
    ((cl_int*)leaves)[i] = places[i].leaf;
  }
  return mcor_unmap(context, &pairs->place_leaves, &leaves);
}

/* Leaves where there may be surface, and what they are parts of, by their keys. */
static mcor_status mcor_find_places(mcor_context* context)
{
  const mcor_graded* graded = &context->graded;
  const size_t leaves = (size_t)graded->count;
  mcor_above above = { 0 };
  void* view;
  MCOR_TRY(mcor_map(context, &graded->cells, leaves * 4 * sizeof(cl_int), false, &view));
  const bool added = mcor_add_above(&context->tree, view, graded->count, &above);
  const size_t count = leaves + mcor_count_above(&above);
  mcor_place* places = added ? malloc(count * sizeof *places) : NULL;
  if (places)
  {
    mcor_list_places(&context->tree, view, graded->count, &above, places);
  }
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    mcor_set_free(&above.sets[l]);
  }
  mcor_status status = mcor_unmap(context, &graded->cells, &view);
  if (status == MCOR_OK)
  {
    status = places ? mcor_write_places(context, places, count)
                    : mcor_fail(context, MCOR_OUT_OF_CAPACITY, "Host memory ran out.");
  }
  free(places);
  return status;
}

#define MCOR_PLACE_ARGS(c)                                                                         \
  MCOR_INT((c)->graded_pairs.place_count), MCOR_BUFFER(&(c)->graded.rungs),                        \
    MCOR_BUFFER(&(c)->graded_pairs.place_keys), MCOR_BUFFER(&(c)->graded_pairs.place_leaves)

/* ---- Cells ---- */

/* Marks the cells between pairs. */
static mcor_status mcor_mark_pairs(mcor_context* context, double iso)
{
  mcor_graded_pairs* pairs = &context->graded_pairs;
  const int particles =
    context->cl.lanes * MCOR_PAIR_VECTORS_OF(context->cl.lanes); /* of an item */
  const int items = (context->grid.count + particles - 1) / particles;
  MCOR_TRY(
    mcor_fill(context, &pairs->reached, 0, (size_t)context->graded.count * sizeof(cl_ulong)));
  return MCOR_LAUNCH(context, "mcor_graded_pair_seed", MCOR_HEAVY, items, MCOR_GRID_ARGS(context),
    MCOR_BUFFER(&context->grid.side_flags), MCOR_REAL(iso), MCOR_REAL(context->options->h_scale),
    MCOR_PLACE_ARGS(context), MCOR_INT(context->tree.top), MCOR_BUFFER(&pairs->reached));
}

/* One round of growth; *grown is false when no cell was added. */
static mcor_status mcor_grow_reached(mcor_context* context, bool* grown)
{
  const mcor_graded* graded = &context->graded;
  mcor_graded_pairs* pairs = &context->graded_pairs;
  const mcor_brick_data* now = &context->bricks.now;
  cl_int flag;
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_graded_pair_grow", MCOR_MEDIUM, graded->count,
    MCOR_INT(graded->count), MCOR_BUFFER(&graded->finer), MCOR_BUFFER(&graded->tables),
    MCOR_BUFFER(&now->above), MCOR_BUFFER(&now->valid), MCOR_BUFFER(&graded->mixed),
    MCOR_BUFFER(&graded->cells), MCOR_PLACE_ARGS(context), MCOR_BUFFER(&pairs->domain),
    MCOR_BUFFER(&pairs->grown), MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *grown = flag != 0;
  ++context->statistics->march_rounds;
  return MCOR_OK;
}

/* Growth stays where nodes have right values: in the box whose particles are on the device, and the ring
 * around it. */
static mcor_status mcor_limit_growth(mcor_context* context)
{
  mcor_graded_pairs* pairs = &context->graded_pairs;
  const int count = context->graded.count;
  const size_t bytes = (size_t)count * sizeof(cl_ulong);
  MCOR_TRY(mcor_reserve(context, &pairs->grown, bytes));
  MCOR_TRY(mcor_fill(context, &pairs->domain, 0xff, bytes));
  MCOR_TRY(mcor_clip_near(context, &pairs->domain));
  return mcor_fill(context, &pairs->grown, 0, bytes);
}

mcor_status mcor_take_reached(mcor_context* context, const cl_int* cells, int count, bool* fresh)
{
  mcor_graded_pairs* pairs = &context->graded_pairs;
  cl_int flag;
  MCOR_TRY(mcor_write(context, &pairs->heard, cells, (size_t)count * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_fill(context, &pairs->found, 0, sizeof flag));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_graded_pair_take", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&pairs->heard), MCOR_PLACE_ARGS(context), MCOR_BUFFER(&pairs->reached),
    MCOR_BUFFER(&pairs->found)));
  MCOR_TRY(mcor_read(context, &pairs->found, 0, &flag, sizeof flag));
  *fresh = flag != 0;
  return MCOR_OK;
}

mcor_status mcor_keep_reached(mcor_context* context, double iso)
{
  mcor_graded_pairs* pairs = &context->graded_pairs;
  const int count = context->graded.count;
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
    MCOR_TRY(grown ? MCOR_OK : mcor_exchange_cells(context, &grown));
  }
  return MCOR_LAUNCH(context, "mcor_graded_pair_keep", MCOR_MEDIUM, count, MCOR_INT(count),
    MCOR_BUFFER(&pairs->reached), MCOR_BUFFER(&context->mesh.used));
}

void mcor_release_graded_pairs(mcor_context* context)
{
  mcor_graded_pairs* p = &context->graded_pairs;
  MCOR_RELEASE(context, &p->place_keys, &p->place_leaves, &p->reached, &p->seeds, &p->domain,
    &p->grown, &p->heard, &p->found);
}
