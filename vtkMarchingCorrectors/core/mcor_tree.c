/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the leaves. A brick is split where a particle of a lower level reaches it: each
 * particle splits those of the level above its own that it reaches, and a split brick those of the
 * next level that touch it. So all around it are leaves no more than a level above its parts.
 *
 * Which bricks are split is global: all particles decide, of all ranks (mcor_measure_splits), and around
 * a period, which is a whole number of bricks of all levels: a brick is known by its image in the
 * first period. Leaves are listed in the box alone. */

#include "mcor_tree.h"
#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_ranks.h"
#include "mcor_sph_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Levels ---- */

int mcor_tree_level_of(double h, double h_min, int top)
{
  int level = 0;
  while (level < top && h >= ldexp(h_min, level + 1))
  {
    ++level;
  }
  return level;
}

int mcor_tree_top(const mcor_measure* measure, const mcor_options* options)
{
  return options->cube_size_mode == MCOR_CUBES_ADAPTIVE
    ? mcor_tree_level_of(measure->h_max, measure->h_min, options->level_limit)
    : 0;
}

/* Of level 0. Those of all levels are a seventh more. */
#define MCOR_BRICK_LIMIT 0x1p63

/* Numbers the bricks of all levels up to the one above the highest leaves'. The lattice is a whole number
 * of these. */
static mcor_status mcor_number_bricks(mcor_context* context, mcor_tree* tree)
{
  const mcor_lattice* lattice = &context->lattice;
  uint64_t base = 0;
  double most = 1; /* bricks of all levels, nearly */
  tree->top = lattice->top;
  memcpy(tree->period, lattice->period, sizeof tree->period);
  memcpy(tree->period_first, lattice->period_first, sizeof tree->period_first);
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    mcor_rung* rung = &tree->rungs[l];
    uint64_t bricks = 1;
    for (int a = 0; a < 3; ++a)
    {
      const int above = MCOR_BRICK << (tree->top + 1);
      rung->n[a] = (int)((lattice->last[a] / above + 2) << (tree->top + 1 - l));
      bricks *= (uint64_t)rung->n[a];
      most *= l == 0 ? rung->n[a] : 1;
    }
    MCOR_RETURN_IF(most > MCOR_BRICK_LIMIT, context, MCOR_OUT_OF_CAPACITY,
      "The virtual grid is too large for adaptive cubes of %d levels. Choose fewer levels, or "
      "remove particles whose smoothing length is far from that of the others.",
      lattice->top + 1);
    rung->base = base;
    rung->unused = 0;
    base += bricks;
  }
  tree->key_limit = base;
  return MCOR_OK;
}

/* The key of a brick, with a period of its image there; false: it is off the lattice. */
static bool mcor_find_brick(const mcor_tree* tree, int level, const int brick[3], uint64_t* key)
{
  const mcor_rung* rung = &tree->rungs[level];
  bool within = true;
  int b[3];
  for (int a = 0; a < 3; ++a)
  {
    b[a] = brick[a];
    const int edge = MCOR_BRICK << level;
    if (tree->period[a] >= edge) /* divisions cost much here */
    {
      const int period = tree->period[a] / edge;
      const int first = tree->period_first[a] / edge, from = brick[a] - first;
      b[a] = (from % period + period) % period + first;
    }
    within = within && b[a] >= 0 && b[a] < rung->n[a];
  }
  *key = within ? mcor_tree_key(rung, b) : MCOR_NO_BRICK;
  return within;
}

bool mcor_tree_is_split(const mcor_tree* tree, int level, const int brick[3])
{
  uint64_t key;
  return level > 0 && mcor_find_brick(tree, level, brick, &key) &&
    mcor_set_has(&tree->split[level], key);
}

/* False where memory ran out. */
static bool mcor_split(const mcor_tree* tree, int level, const int brick[3], mcor_brick_set* set)
{
  uint64_t key;
  return !mcor_find_brick(tree, level, brick, &key) || mcor_set_add(set, key);
}

/* ---- Split bricks ---- */

typedef struct mcor_tree_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_tree* tree;
  double reach; /* of a support radius in smoothing lengths, in cubes */
  bool is_cube; /* the support */
  mcor_brick_set split[MCOR_SLICES][MCOR_TREE_LEVEL_LIMIT + 2];
  bool failed[MCOR_SLICES];
} mcor_tree_job;

/* Distance from x to the brick's interval along an axis, squared. */
static double mcor_interval_distance2(double x, int brick, double edge)
{
  const double below = brick * edge - x, above = x - (brick + 1) * edge;
  const double d = below > 0 ? below : above > 0 ? above : 0;
  return d * d;
}

/* Splits the bricks of a level that are within `reach` of x, cubes from the lattice's origin. */
static bool mcor_split_reached(
  const mcor_tree_job* job, int level, const double x[3], double reach, mcor_brick_set* set)
{
  const double edge = ldexp(MCOR_BRICK, level);
  int first[3], last[3], b[3];
  for (int a = 0; a < 3; ++a)
  {
    first[a] = (int)ceil((x[a] - reach) / edge) - 1;
    last[a] = (int)floor((x[a] + reach) / edge);
  }
  for (b[2] = first[2]; b[2] <= last[2]; ++b[2])
  {
    const double z2 = job->is_cube ? 0 : mcor_interval_distance2(x[2], b[2], edge);
    for (b[1] = first[1]; b[1] <= last[1]; ++b[1])
    {
      const double y2 = job->is_cube ? 0 : mcor_interval_distance2(x[1], b[1], edge);
      for (b[0] = first[0]; b[0] <= last[0]; ++b[0])
      {
        const double x2 = job->is_cube ? 0 : mcor_interval_distance2(x[0], b[0], edge);
        if (x2 + y2 + z2 <= reach * reach && !mcor_split(job->tree, level, b, set))
        {
          return false;
        }
      }
    }
  }
  return true;
}

static void mcor_split_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_tree_job* job = data;
  const mcor_context* context = job->context;
  const mcor_lattice* lattice = &context->lattice;
  const double h_min = context->measure.h_min;
  mcor_array positions = job->input->positions;
  positions.components = 3;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK];
  for (int64_t begin = first; begin < last && !job->failed[slice]; begin += MCOR_CHUNK)
  {
    const int count = last - begin < MCOR_CHUNK ? (int)(last - begin) : MCOR_CHUNK;
    for (int a = 0; a < 3; ++a)
    {
      mcor_read_array(&positions, begin, count, a, x[a]);
    }
    mcor_read_smoothing_length(context, job->input, begin, count, h);
    for (int i = 0; i < count && !job->failed[slice]; ++i)
    {
      if (!mcor_is_used(context, job->input, begin + i))
      {
        continue;
      }
      const int level = mcor_tree_level_of(h[i], h_min, job->tree->top) + 1;
      double at[3];
      for (int a = 0; a < 3; ++a)
      {
        at[a] = x[a][i] / lattice->cube - (double)lattice->origin[a];
        const double from = at[a] - lattice->period_first[a], period = lattice->period[a];
        at[a] -= period > 0 ? floor(from / period) * period : 0;
      }
      job->failed[slice] =
        !mcor_split_reached(job, level, at, h[i] * job->reach, &job->split[slice][level]) ||
        mcor_are_too_many(job->split[slice]);
    }
  }
}

static bool mcor_is_tensor(mcor_sph_kernel kernel)
{
#define MCOR_ENTRY(id, name, support, norm, tensor) tensor,
  static const bool tensors[] = { MCOR_SPH_KERNEL_TABLE(MCOR_ENTRY) };
#undef MCOR_ENTRY
  return tensors[kernel];
}

/* The bricks that particles split. */
static bool mcor_split_by_particles(
  const mcor_context* context, const mcor_input* input, mcor_tree* tree)
{
  mcor_tree_job* job = calloc(1, sizeof *job);
  if (!job)
  {
    return false;
  }
  const mcor_options* options = context->options;
  job->context = context;
  job->input = input;
  job->tree = tree;
  job->reach = mcor_support_factor(options->sph_kernel) * options->h_scale / context->lattice.cube;
  job->is_cube = mcor_is_tensor(options->sph_kernel);
  const int slices = mcor_parallel_for(input->count, MCOR_HEAVY_GRAIN, mcor_split_slice, job);
  bool made = true;
  for (int s = 0; s < slices; ++s)
  {
    made = made && !job->failed[s];
    for (int l = 0; l <= tree->top + 1; ++l)
    {
      made = made && mcor_set_add_all(&tree->split[l], &job->split[s][l]) &&
        !mcor_are_too_many(tree->split);
      mcor_set_free(&job->split[s][l]);
    }
  }
  free(job);
  return made;
}

/* Position of a brick of a level with a key. */
static void mcor_brick_of_key(const mcor_rung* rung, uint64_t key, int brick[3])
{
  const uint64_t number = key - rung->base, nx = (uint64_t)rung->n[0], ny = (uint64_t)rung->n[1];
  brick[0] = (int)(number % nx);
  brick[1] = (int)(number / nx % ny);
  brick[2] = (int)(number / nx / ny);
}

/* Splits the bricks above that touch a split one: its parent, and those beyond the parent's sides that it
 * lies at. */
static bool mcor_split_above(mcor_tree* tree, int level)
{
  const mcor_brick_set* set = &tree->split[level];
  bool made = true;
  for (size_t i = 0; i < set->capacity && made; ++i)
  {
    if (set->slots[i] == MCOR_NO_BRICK)
    {
      continue;
    }
    int brick[3], b[3];
    mcor_brick_of_key(&tree->rungs[level], set->slots[i], brick);
    for (int d = 0; d < 8 && made; ++d)
    {
      for (int a = 0; a < 3; ++a)
      {
        b[a] = brick[a] / 2 + (d >> a & 1) * (brick[a] % 2 ? 1 : -1);
      }
      made = mcor_split(tree, level + 1, b, &tree->split[level + 1]);
    }
  }
  return made;
}

/* ---- Leaves ---- */

/* Room for eight more leaves. False: too many, or no memory. */
static bool mcor_extend_leaves(mcor_tree* tree, size_t* room)
{
  const size_t most = (size_t)tree->leaf_count + 8;
  if (most <= *room)
  {
    return true;
  }
  if (most > MCOR_LEAF_LIMIT)
  {
    return false;
  }
  cl_int* leaves = realloc(tree->leaves, 2 * most * 4 * sizeof *leaves);
  tree->leaves = leaves ? leaves : tree->leaves;
  cl_int* regions = realloc(tree->regions, (2 * most + 1) * sizeof *regions);
  tree->regions = regions ? regions : tree->regions;
  *room = leaves && regions ? 2 * most : *room;
  return leaves && regions;
}

/* Whether a brick, with a ring of a cell around it, is in the box. */
static bool mcor_is_wanted(const mcor_box* box, int level, int cell_level, const int brick[3])
{
  bool wanted = true;
  for (int a = 0; a < 3 && box->is_part; ++a)
  {
    const int64_t edge = (int64_t)(2 * MCOR_BRICK) << level, ring = INT64_C(2) << cell_level;
    const int64_t low = brick[a] * edge;
    wanted = wanted && low + edge + ring >= box->halves[a] && low - ring <= box->halves[3 + a];
  }
  return wanted;
}

/* Lists the parts of a split brick that are not split and in the box. */
static void mcor_list_parts(mcor_tree* tree, const mcor_box* box, int level, const int parent[3])
{
  const int first = tree->leaf_count;
  for (int d = 0; d < 8; ++d)
  {
    const int b[3] = { 2 * parent[0] + (d & 1), 2 * parent[1] + (d >> 1 & 1),
      2 * parent[2] + (d >> 2) };
    if (!mcor_tree_is_split(tree, level, b) && mcor_is_wanted(box, level, level, b))
    {
      cl_int* leaf = tree->leaves + 4 * (size_t)tree->leaf_count++;
      leaf[0] = b[0];
      leaf[1] = b[1];
      leaf[2] = b[2];
      leaf[3] = level;
    }
  }
  if (tree->leaf_count > first)
  {
    tree->regions[tree->region_count++] = first;
  }
}

/* Lists the leaves of one level: the parts of split bricks, and of their images, that are not split. */
static bool mcor_list_leaves(mcor_tree* tree, const mcor_box* box, int level, size_t* room)
{
  const mcor_brick_set* set = &tree->split[level + 1];
  bool made = true;
  for (size_t i = 0; i < set->capacity && made; ++i)
  {
    int brick[3], parent[3];
    if (set->slots[i] == MCOR_NO_BRICK)
    {
      continue;
    }
    mcor_brick_of_key(&tree->rungs[level + 1], set->slots[i], brick);
    for (int image = 0; image < 27 && made; ++image)
    {
      const int by[3] = { image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1 };
      bool exists = true;
      for (int a = 0; a < 3; ++a)
      {
        const int period = tree->period[a] / (MCOR_BRICK << (level + 1));
        exists = exists && (by[a] == 0 || period > 0);
        parent[a] = brick[a] + by[a] * period;
      }
      if (exists && mcor_is_wanted(box, level + 1, level, parent))
      {
        made = mcor_extend_leaves(tree, room);
        if (made)
        {
          mcor_list_parts(tree, box, level, parent);
        }
      }
    }
  }
  return made;
}

/* About how many leaves there will be at least: a particle has about the volume of (h / 1.3)^3, and the
 * cubes of its level there. */
static double mcor_guess_leaves(const mcor_context* context, const mcor_input* input)
{
  const double brick = MCOR_BRICK * context->lattice.cube;
  double leaves = 0, h[MCOR_CHUNK];
  for (int64_t begin = 0; begin < input->count; begin += MCOR_CHUNK)
  {
    const int64_t rest = input->count - begin;
    const int count = rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
    mcor_read_smoothing_length(context, input, begin, count, h);
    for (int i = 0; i < count; ++i)
    {
      const int level = mcor_tree_level_of(h[i], context->measure.h_min, context->lattice.top);
      const double bricks = h[i] / 1.3 / ldexp(brick, level);
      leaves += mcor_is_used(context, input, begin + i) ? bricks * bricks * bricks : 0;
    }
  }
  return leaves;
}

/* ---- Split bricks of all particles ---- */

static int mcor_compare_keys(const void* a, const void* b)
{
  const uint64_t x = *(const uint64_t*)a, y = *(const uint64_t*)b;
  return (x > y) - (x < y);
}

/* The keys of all split bricks, ascending. */
static mcor_status mcor_list_splits(
  mcor_context* context, const mcor_tree* tree, uint64_t** keys, int64_t* count)
{
  size_t total = 0;
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    total += tree->split[l].count;
  }
  *keys = malloc((total + 1) * sizeof **keys);
  *count = 0;
  MCOR_RETURN_IF(!*keys, context, MCOR_OUT_OF_CAPACITY, "Host memory ran out.");
  for (int l = 0; l <= tree->top + 1; ++l)
  {
    for (size_t i = 0; i < tree->split[l].capacity; ++i)
    {
      const uint64_t key = tree->split[l].slots[i];
      if (key != MCOR_NO_BRICK)
      {
        (*keys)[(*count)++] = key;
      }
    }
  }
  qsort(*keys, total, sizeof **keys, mcor_compare_keys);
  return MCOR_OK;
}

/* The same from their keys. */
static mcor_status mcor_take_splits(
  mcor_context* context, mcor_tree* tree, const uint64_t* keys, int64_t count)
{
  int level = 0;
  for (int64_t i = 0; i < count; ++i)
  {
    level = i > 0 && keys[i] < keys[i - 1] ? 0 : level;
    while (level <= tree->top && keys[i] >= tree->rungs[level + 1].base)
    {
      ++level;
    }
    MCOR_RETURN_IF(keys[i] >= tree->key_limit || level == 0, context, MCOR_INVALID_ARGUMENT,
      "The given global values were measured with other options: a brick of adaptive cubes is not "
      "on the lattice.");
    MCOR_RETURN_IF(!mcor_set_add(&tree->split[level], keys[i]), context, MCOR_OUT_OF_CAPACITY,
      "Host memory for %lld bricks of adaptive cubes ran out.", (long long)count);
  }
  return MCOR_OK;
}

/* All bricks that are to be split, by the particles of all ranks. */
static mcor_status mcor_split_bricks(
  mcor_context* context, const mcor_input* input, mcor_tree* tree)
{
  const double guess = mcor_guess_leaves(context, input);
  MCOR_RETURN_IF(guess > MCOR_LEAF_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large: with cube size %g the particles fill about %.3g bricks of %d "
    "adaptive cubes, and %d is the limit. Use a larger cube size.",
    context->lattice.cube, guess, MCOR_BRICK_NODES, MCOR_LEAF_LIMIT);
  MCOR_TRY(mcor_number_bricks(context, tree));
  bool made = mcor_split_by_particles(context, input, tree);
  if (made && context->options->ranks)
  {
    uint64_t* own = NULL;
    const void* all;
    int64_t count;
    mcor_status status = mcor_list_splits(context, tree, &own, &count);
    if (status == MCOR_OK)
    {
      status = mcor_gather(context, own, count, sizeof *own, &all, &count);
    }
    if (status == MCOR_OK)
    {
      status = mcor_take_splits(context, tree, all, count);
    }
    free(own);
    MCOR_TRY(status);
  }
  for (int l = 1; l <= tree->top && made; ++l)
  {
    made = mcor_split_above(tree, l) && !mcor_are_too_many(tree->split);
  }
  MCOR_RETURN_IF(!made, context, MCOR_OUT_OF_CAPACITY,
    "Adaptive cubes have more than %d leaves, or more than host memory has room for. Use a larger "
    "cube size.",
    MCOR_LEAF_LIMIT);
  return MCOR_OK;
}

mcor_status mcor_measure_splits(
  mcor_context* context, const mcor_input* input, mcor_globals* globals)
{
  mcor_tree tree = { 0 };
  if (context->lattice.top == 0)
  {
    return MCOR_OK;
  }
  mcor_status status = mcor_split_bricks(context, input, &tree);
  if (status == MCOR_OK)
  {
    status = mcor_list_splits(context, &tree, &globals->splits, &globals->split_count);
  }
  mcor_release_tree(&tree);
  return status;
}

mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input)
{
  mcor_tree* tree = &context->tree;
  const mcor_globals* globals = context->options->globals;
  mcor_release_tree(tree);
  if (globals)
  {
    MCOR_RETURN_IF(!globals->splits, context, MCOR_INVALID_ARGUMENT,
      "The given global values were measured for uniform cubes. Measure them with the same "
      "options.");
    MCOR_TRY(mcor_number_bricks(context, tree));
    MCOR_TRY(mcor_take_splits(context, tree, globals->splits, globals->split_count));
  }
  else
  {
    MCOR_TRY(mcor_split_bricks(context, input, tree));
  }
  MCOR_RETURN_IF(context->options->point_keys && tree->key_limit >> MCOR_TREE_KEY_BITS > 0, context,
    MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large for points with numbers, with cube size %g and %d levels of "
    "adaptive cubes. Use a larger cube size, or fewer levels.",
    context->lattice.cube, tree->top + 1);
  size_t room = 0;
  bool made = mcor_extend_leaves(tree, &room);
  for (int l = 0; l <= tree->top && made; ++l)
  {
    tree->first_leaf[l] = tree->leaf_count;
    tree->first_region[l] = tree->region_count;
    made = mcor_list_leaves(tree, &context->box, l, &room);
    tree->first_leaf[l + 1] = tree->leaf_count;
    tree->first_region[l + 1] = tree->region_count;
  }
  MCOR_RETURN_IF(!made, context, MCOR_OUT_OF_CAPACITY,
    "Adaptive cubes have more than %d leaves, or more than host memory has room for. Use a larger "
    "cube size.",
    MCOR_LEAF_LIMIT);
  tree->regions[tree->region_count] = tree->leaf_count;
  return MCOR_OK;
}

void mcor_release_tree(mcor_tree* tree)
{
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    mcor_set_free(&tree->split[l]);
  }
  free(tree->leaves);
  free(tree->finer);
  free(tree->regions);
  *tree = (mcor_tree){ 0 };
}
