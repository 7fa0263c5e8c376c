/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: which leaves there may be surface in. Of each, bounds of the sums or a proof from the
 * particles nearby tell whether all its nodes are on one side of the iso value, or of too low a weight, or
 * their values do. A leaf is left out where it and the leaves up from it agree. Particles are gathered for
 * all parts of a brick at once. */

#include "mcor_adaptive.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

#include <stdlib.h>
#include <string.h>

/* ---- What is finer around leaves ---- */

/* Bricks of a level in and around a region, bits x + 4 y + 16 z from the one below its first, that are
 * split. */
static uint64_t mcor_split_around(const mcor_tree* tree, int level, const int first[3])
{
  uint64_t split = 0;
  for (int i = 0; i < 64; ++i)
  {
    const int b[3] = { first[0] + (i & 3) - 1, first[1] + (i >> 2 & 3) - 1,
      first[2] + (i >> 4) - 1 };
    split |= (uint64_t)mcor_tree_is_split(tree, level, b) << i;
  }
  return split;
}

/* Which of the seven bricks up from one are parts of larger leaves, or of none. A bit for each octant in which
 * the bricks are beside the region's, see mcor_find_finer_slice. */
static unsigned mcor_coarse_around(const mcor_tree* tree, int level, const int first[3])
{
  unsigned coarse = 0;
  for (int d = 1; d < 8; ++d)
  {
    const int parent[3] = { first[0] / 2 + (d & 1), first[1] / 2 + (d >> 1 & 1),
      first[2] / 2 + (d >> 2) };
    coarse |= (unsigned)!mcor_tree_is_split(tree, level + 1, parent) << d;
  }
  return coarse;
}

/* Whether a leaf, its place in its region as bits of `at`, is beside these. */
static bool mcor_is_beside_coarse(unsigned coarse, int at)
{
  bool beside = false;
  for (int d = 1; d < 8; ++d)
  {
    beside = beside || ((coarse >> d & 1) && (at & d) == d);
  }
  return beside;
}

typedef struct mcor_finer_job
{
  mcor_tree* tree;
  int64_t begin; /* the first region of this loop */
} mcor_finer_job;

static void mcor_find_finer_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_finer_job* job = data;
  mcor_tree* tree = job->tree;
  (void)slice;
  for (int64_t r = job->begin + first; r < job->begin + last; ++r)
  {
    const cl_int* leaf = tree->leaves + 4 * (int64_t)tree->regions[r];
    const int begin[3] = { leaf[0] & ~1, leaf[1] & ~1, leaf[2] & ~1 };
    const uint64_t split = leaf[3] > 0 ? mcor_split_around(tree, leaf[3], begin) : 0;
    const unsigned coarse = mcor_coarse_around(tree, leaf[3], begin);
    for (cl_int i = tree->regions[r]; i < tree->regions[r + 1]; ++i, leaf += 4)
    {
      const int x = leaf[0] & 1, y = leaf[1] & 1, z = leaf[2] & 1, at = x + 4 * y + 16 * z;
      cl_uint finer = mcor_is_beside_coarse(coarse, x + 2 * y + 4 * z) ? MCOR_COARSER_UP : 0;
      for (int d = 0; d < 27 && split; ++d)
      {
        finer |= (cl_uint)(split >> (at + d % 3 + 4 * (d / 3 % 3) + 16 * (d / 9)) & 1) << d;
      }
      tree->finer[i] = finer;
    }
  }
}

/* Regions between two reports. */
#define MCOR_FINER_STEP 32768

/* Which of the bricks around each leaf are finer, see MCOR_DIRECTION. */
static mcor_status mcor_find_finer(mcor_context* context)
{
  mcor_tree* tree = &context->tree;
  tree->finer = malloc(((size_t)tree->leaf_count + 1) * sizeof *tree->finer);
  MCOR_TRY(mcor_allocated(context, tree->finer));
  for (mcor_finer_job job = { tree, 0 }; job.begin < tree->region_count;
       job.begin += MCOR_FINER_STEP)
  {
    const int64_t rest = tree->region_count - job.begin;
    mcor_parallel_for(context, rest < MCOR_FINER_STEP ? rest : MCOR_FINER_STEP,
      MCOR_HEAVY_GRAIN / 8, mcor_find_finer_slice, &job);
    MCOR_TRY(mcor_report_launch(context));
  }
  return MCOR_OK;
}

/* ---- The tree on the device ---- */

mcor_status mcor_write_tree(mcor_context* context)
{
  const mcor_tree* tree = &context->tree;
  mcor_adaptive* adaptive = &context->adaptive;
  const size_t leaves = (size_t)tree->leaf_count, regions = (size_t)tree->region_count;
  MCOR_TRY(mcor_find_finer(context));
  MCOR_TRY(mcor_write(context, &adaptive->leaves, tree->leaves, leaves * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_write(context, &adaptive->leaf_finer, tree->finer, leaves * sizeof(cl_uint)));
  MCOR_TRY(mcor_write(context, &adaptive->regions, tree->regions, (regions + 1) * sizeof(cl_int)));
  MCOR_TRY(mcor_write(
    context, &context->bricks.rungs, tree->lattice->rungs, (size_t)(tree->top + 3) * sizeof tree->lattice->rungs[0]));
  MCOR_TRY(mcor_reserve(context, &adaptive->region_keys, regions * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_region_keys", MCOR_LIGHT, regions,
    MCOR_INT((int)regions), MCOR_BUFFER(&context->bricks.rungs), MCOR_BUFFER(&adaptive->regions),
    MCOR_BUFFER(&adaptive->leaves), MCOR_BUFFER(&adaptive->region_keys)));
  MCOR_TRY(mcor_sort(
    context, &adaptive->region_keys, &adaptive->region_order, tree->region_count, mcor_tree_key_limit(tree)));
  mcor_release_sort(context);
  return MCOR_OK;
}

#define MCOR_REGION_ARGS(c)                                                                        \
  MCOR_INT((c)->tree.region_count), MCOR_BUFFER(&(c)->bricks.rungs),                               \
    MCOR_BUFFER(&(c)->adaptive.regions), MCOR_BUFFER(&(c)->adaptive.leaves),                       \
    MCOR_BUFFER(&(c)->adaptive.region_keys), MCOR_BUFFER(&(c)->adaptive.region_order)

/* ---- States ---- */

/* Leaf by leaf, or in the plane by region. */
static mcor_status mcor_find_states(mcor_context* context)
{
  const mcor_tree* tree = &context->tree;
  mcor_adaptive* adaptive = &context->adaptive;
  const bool plane = mcor_is_plane(context);
  const int* begin = plane ? tree->first_region : tree->first_leaf;
  for (int l = 0; l <= tree->top; ++l)
  {
    const int first = begin[l], count = begin[l + 1] - first;
    MCOR_TRY(mcor_view_level(context, l));
    MCOR_TRY(plane ? MCOR_LAUNCH(context, "mcor_adaptive_plane_regions", MCOR_HEAVY, count,
                       MCOR_GRID_ARGS(context), MCOR_INT(first), MCOR_INT(count),
                       MCOR_BUFFER(&adaptive->regions), MCOR_BUFFER(&adaptive->leaves),
                       MCOR_BUFFER(&adaptive->leaf_finer), MCOR_SEED_ARGS(context),
                       MCOR_BUFFER(&adaptive->states))
                   : MCOR_LAUNCH(context, "mcor_adaptive_states", MCOR_HEAVY, count,
                       MCOR_GRID_ARGS(context), MCOR_INT(first), MCOR_INT(count),
                       MCOR_BUFFER(&adaptive->leaves), MCOR_BUFFER(&adaptive->leaf_finer),
                       MCOR_SEED_ARGS(context), MCOR_BUFFER(&adaptive->states)));
  }
  return mcor_view_level(context, 0);
}

/* Regions whose leaves' values are kept as if all were evaluated. */
#define MCOR_PART_REGIONS 512

/* Takes the values of a part's leaves, [first, first + count), that are evaluated. */
static mcor_status mcor_pack_values(
  mcor_context* context, int first, int count, mcor_leaf_nodes* found)
{
  int added;
  const mcor_adaptive* adaptive = &context->adaptive;
  MCOR_TRY(mcor_reserve(context, &found->counts, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_count_values", MCOR_LIGHT, count, MCOR_INT(first),
    MCOR_INT(count), MCOR_BUFFER(&adaptive->states), MCOR_BUFFER(&found->counts)));
  MCOR_TRY(mcor_scan(context, &found->counts, count, &added));
  if (found->count + added > found->room)
  {
    const size_t bytes = 64 * context->cl.real_size, old = (size_t)found->count * bytes;
    found->room = found->count + added + found->room / 4;
    MCOR_TRY(mcor_extend(context, &found->value, old, (size_t)found->room * bytes));
    MCOR_TRY(mcor_extend(context, &found->weight, old, (size_t)found->room * bytes));
  }
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_pack_values", MCOR_MEDIUM, count, MCOR_INT(first),
    MCOR_INT(count), MCOR_INT(found->count), MCOR_BUFFER(&found->counts),
    MCOR_INT((int)(64 * context->cl.real_size / sizeof(cl_uint))), MCOR_BUFFER(&found->part_value),
    MCOR_BUFFER(&found->part_weight), MCOR_BUFFER(&found->place), MCOR_BUFFER(&found->value),
    MCOR_BUFFER(&found->weight)));
  found->count += added;
  return MCOR_OK;
}

/* The same where particles are gathered for many lanes, with the values of nodes if `found`, as all their
 * particles are at hand. */
static mcor_status mcor_find_region_states(mcor_context* context, mcor_leaf_nodes* found)
{
  const mcor_tree* tree = &context->tree;
  mcor_adaptive* adaptive = &context->adaptive;
  const mcor_leaf_nodes none = { 0 };
  for (int l = 0; l <= tree->top; ++l)
  {
    MCOR_TRY(mcor_view_level(context, l));
    for (int part = tree->first_region[l], end; part < tree->first_region[l + 1]; part = end)
    {
      const int rest = tree->first_region[l + 1] - part;
      end = part + (found && rest > MCOR_PART_REGIONS ? MCOR_PART_REGIONS : rest);
      const int first = tree->regions[part], count = tree->regions[end] - first;
      mcor_span span = { .first = part, .end = end };
      MCOR_TRY(mcor_next_span(context, &span));
      while (span.count > 0)
      {
        MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_regions", MCOR_HEAVY, span.count,
          MCOR_GRID_ARGS(context), MCOR_INT(span.first), MCOR_INT(span.count),
          MCOR_BUFFER(&adaptive->regions), MCOR_BUFFER(&adaptive->leaves),
          MCOR_BUFFER(&adaptive->leaf_finer), MCOR_SEED_ARGS(context), MCOR_INT(found != NULL),
          MCOR_INT(first), MCOR_BUFFER(&adaptive->states),
          MCOR_BUFFER(found ? &found->part_value : &none.value),
          MCOR_BUFFER(found ? &found->part_weight : &none.weight)));
        MCOR_TRY(mcor_next_span(context, &span));
      }
      MCOR_TRY(found ? mcor_pack_values(context, first, count, found) : MCOR_OK);
    }
  }
  return mcor_view_level(context, 0);
}

/* ---- The leaves to examine ---- */

/* A leaf by its key, to be sorted. */
typedef struct mcor_keyed_leaf
{
  uint64_t key;
  size_t leaf;
} mcor_keyed_leaf;

static int mcor_compare_leaves(const void* a, const void* b)
{
  const uint64_t x = ((const mcor_keyed_leaf*)a)->key, y = ((const mcor_keyed_leaf*)b)->key;
  return (x > y) - (x < y);
}

/* Sorts the leaves that are to be examined, which are in the order of their levels, and takes them and
 * what is beside them to the device. */
static mcor_status mcor_write_examined(
  mcor_context* context, mcor_keyed_leaf* examined, cl_int (*cells)[4], cl_uint* finer)
{
  const mcor_tree* tree = &context->tree;
  mcor_adaptive* adaptive = &context->adaptive;
  const size_t n = (size_t)adaptive->count;
  for (int l = 0; l <= tree->top; ++l)
  {
    const int first = adaptive->first_leaf[l], count = adaptive->first_leaf[l + 1] - first;
    qsort(examined + first, (size_t)count, sizeof *examined, mcor_compare_leaves);
    MCOR_TRY(mcor_report_launch(context));
  }
  for (size_t i = 0; i < n; ++i)
  {
    memcpy(cells[i], tree->leaves + 4 * examined[i].leaf, sizeof cells[i]);
    finer[i] = tree->finer[examined[i].leaf] & (MCOR_COARSER_UP - 1);
  }
  MCOR_TRY(mcor_write(context, &adaptive->cells, cells, n * sizeof *cells));
  return mcor_write(context, &adaptive->finer, finer, n * sizeof *finer);
}

static mcor_status mcor_list_examined(mcor_context* context)
{
  const mcor_tree* tree = &context->tree;
  mcor_adaptive* adaptive = &context->adaptive;
  const size_t n = (size_t)tree->leaf_count;
  uint8_t* chosen = malloc(n + 1);
  MCOR_TRY(mcor_allocated(context, chosen));
  mcor_status status = mcor_read(context, &adaptive->chosen, 0, chosen, n);
  size_t count = 0, evaluated = 0;
  for (size_t i = 0; i < n && status == MCOR_OK; ++i)
  {
    count += chosen[i] & MCOR_CHOSEN;
    evaluated += (chosen[i] & MCOR_CHOSEN_EVALUATED) != 0;
  }
  mcor_keyed_leaf* examined = malloc((count + 1) * sizeof *examined);
  cl_int(*cells)[4] = malloc((count + 1) * sizeof *cells);
  cl_uint* finer = malloc((count + 1) * sizeof *finer);
  adaptive->count = (int)count;
  adaptive->evaluated = MCOR_BRICK_NODES * (int)evaluated;
  status = status == MCOR_OK ? mcor_allocated(context, examined && cells && finer) : status;
  if (status == MCOR_OK)
  {
    size_t to = 0;
    memset(adaptive->first_leaf, 0, sizeof adaptive->first_leaf);
    for (size_t i = 0; i < n; ++i)
    {
      if (chosen[i] & MCOR_CHOSEN)
      {
        const cl_int* leaf = tree->leaves + 4 * i;
        examined[to++] = (mcor_keyed_leaf){ mcor_brick_key(&tree->lattice->rungs[leaf[3]], leaf), i };
        adaptive->first_leaf[leaf[3] + 1] = (int)to;
      }
    }
    for (int l = 0; l <= tree->top; ++l) /* levels without any */
    {
      const int first = adaptive->first_leaf[l];
      adaptive->first_leaf[l + 1] =
        adaptive->first_leaf[l + 1] > first ? adaptive->first_leaf[l + 1] : first;
    }
    status = mcor_write_examined(context, examined, cells, finer);
  }
  free(chosen);
  free(examined);
  free(cells);
  free(finer);
  return status;
}

mcor_status mcor_choose_leaves(mcor_context* context, mcor_leaf_nodes* found)
{
  mcor_adaptive* adaptive = &context->adaptive;
  const mcor_tree* tree = &context->tree;
  const size_t n = (size_t)tree->leaf_count;
  MCOR_TRY(mcor_reserve(context, &adaptive->states, n * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &adaptive->chosen, n));
  if (found)
  {
    const size_t part = n < 8 * MCOR_PART_REGIONS ? n : 8 * MCOR_PART_REGIONS;
    MCOR_TRY(mcor_reserve(context, &found->part_value, part * 64 * context->cl.real_size));
    MCOR_TRY(mcor_reserve(context, &found->part_weight, part * 64 * context->cl.real_size));
    MCOR_TRY(mcor_reserve(context, &found->place, n * sizeof(cl_int)));
  }
  MCOR_TRY(context->cl.lanes == 1 || mcor_is_plane(context)
      ? mcor_find_states(context)
      : mcor_find_region_states(context, found));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_adaptive_choose", MCOR_MEDIUM, tree->region_count,
    MCOR_REGION_ARGS(context), MCOR_INT(mcor_is_plane(context)), MCOR_BUFFER(&adaptive->leaf_finer),
    MCOR_BUFFER(&adaptive->states), MCOR_BUFFER(&adaptive->chosen)));
  return mcor_list_examined(context);
}

mcor_status mcor_take_leaf_nodes(mcor_context* context, const mcor_leaf_nodes* found)
{
  const mcor_adaptive* adaptive = &context->adaptive;
  const mcor_brick_data* now = &context->bricks.now;
  const mcor_leaf_nodes none = { 0 };
  const mcor_leaf_nodes* from = found ? found : &none;
  return MCOR_LAUNCH(context, "mcor_adaptive_take", MCOR_MEDIUM, now->count,
    MCOR_REGION_ARGS(context), MCOR_INT(now->count), MCOR_BUFFER(&now->bricks),
    MCOR_BUFFER(&adaptive->states),
    MCOR_INT(found ? (int)(64 * context->cl.real_size / sizeof(cl_uint)) : 0),
    MCOR_BUFFER(&from->place), MCOR_BUFFER(&from->value), MCOR_BUFFER(&from->weight),
    MCOR_BUFFER(&adaptive->proofs), MCOR_BUFFER(&now->known), MCOR_BUFFER(&now->value),
    MCOR_BUFFER(&now->weight));
}
