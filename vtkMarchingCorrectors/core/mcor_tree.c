/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the leaves. A brick is split where a particle of a lower level reaches it: each
 * particle splits those of the level above its own that it reaches, and a split brick those of the
 * next level that touch it. So all around it are leaves no more than a level above its parts. */

#include "mcor_tree.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_sph_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Sets of bricks ---- */

static size_t mcor_set_place(const mcor_brick_set* set, uint64_t key)
{
  size_t at = (size_t)((key * UINT64_C(0x9E3779B97F4A7C15)) >> 20) & (set->capacity - 1);
  while (set->slots[at] != MCOR_NO_BRICK && set->slots[at] != key)
  {
    at = (at + 1) & (set->capacity - 1);
  }
  return at;
}

static bool mcor_set_has(const mcor_brick_set* set, uint64_t key)
{
  return set->capacity > 0 && set->slots[mcor_set_place(set, key)] == key;
}

static bool mcor_set_grow(mcor_brick_set* set)
{
  const mcor_brick_set old = *set;
  const size_t capacity = old.capacity ? 2 * old.capacity : 1024;
  uint64_t* slots = malloc(capacity * sizeof *slots);
  if (!slots)
  {
    return false;
  }
  memset(slots, 0xff, capacity * sizeof *slots);
  *set = (mcor_brick_set){ slots, capacity, old.count };
  for (size_t i = 0; i < old.capacity; ++i)
  {
    if (old.slots[i] != MCOR_NO_BRICK)
    {
      slots[mcor_set_place(set, old.slots[i])] = old.slots[i];
    }
  }
  free(old.slots);
  return true;
}

/* More leaves than this are not made. Of the parts of each split brick, 8, all but those that are split
 * are leaves: seven more for each brick at least. */
#define MCOR_LEAF_LIMIT (INT32_MAX / 64)
#define MCOR_SPLIT_LIMIT (MCOR_LEAF_LIMIT / 7)

/* False where memory ran out, or there would be too many leaves: before the sets take much of either. */
static bool mcor_set_add(mcor_brick_set* set, uint64_t key)
{
  if (set->count > MCOR_SPLIT_LIMIT || (2 * set->count >= set->capacity && !mcor_set_grow(set)))
  {
    return false;
  }
  const size_t at = mcor_set_place(set, key);
  set->count += set->slots[at] != key;
  set->slots[at] = key;
  return true;
}

/* Whether the sets of all levels together make too many leaves. */
static bool mcor_are_too_many(const mcor_brick_set* levels)
{
  size_t count = 0;
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    count += levels[l].count;
  }
  return count > MCOR_SPLIT_LIMIT;
}

static void mcor_set_free(mcor_brick_set* set)
{
  free(set->slots);
  *set = (mcor_brick_set){ 0 };
}

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
 * of these. False where there are too many for numbers. */
static bool mcor_number_bricks(const mcor_lattice* lattice, mcor_tree* tree)
{
  uint64_t base = 0;
  double most = 1; /* bricks of all levels, nearly */
  tree->top = lattice->top;
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
    if (most > MCOR_BRICK_LIMIT)
    {
      return false;
    }
    rung->base = base;
    rung->unused = 0;
    base += bricks;
  }
  tree->key_limit = base;
  return true;
}

bool mcor_tree_is_split(const mcor_tree* tree, int level, const int brick[3])
{
  return level > 0 && mcor_set_has(&tree->split[level], mcor_tree_key(&tree->rungs[level], brick));
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
  const mcor_rung* rung = &job->tree->rungs[level];
  const double edge = ldexp(MCOR_BRICK, level);
  int first[3], last[3], b[3];
  for (int a = 0; a < 3; ++a)
  {
    first[a] = (int)fmax(ceil((x[a] - reach) / edge) - 1, 0);
    last[a] = (int)fmin(floor((x[a] + reach) / edge), rung->n[a] - 1);
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
        if (x2 + y2 + z2 <= reach * reach && !mcor_set_add(set, mcor_tree_key(rung, b)))
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
      }
      job->failed[slice] =
        !mcor_split_reached(job, level, at, h[i] * job->reach, &job->split[slice][level]) ||
        mcor_are_too_many(job->split[slice]);
    }
  }
}

static bool mcor_set_add_all(mcor_brick_set* set, const mcor_brick_set* other)
{
  bool added = true;
  for (size_t i = 0; i < other->capacity && added; ++i)
  {
    added = other->slots[i] == MCOR_NO_BRICK || mcor_set_add(set, other->slots[i]);
  }
  return added;
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
  const mcor_rung* above = &tree->rungs[level + 1];
  bool made = true;
  for (size_t i = 0; i < set->capacity && made; ++i)
  {
    if (set->slots[i] == MCOR_NO_BRICK)
    {
      continue;
    }
    int brick[3];
    mcor_brick_of_key(&tree->rungs[level], set->slots[i], brick);
    for (int d = 0; d < 8 && made; ++d)
    {
      int b[3];
      bool within = true;
      for (int a = 0; a < 3; ++a)
      {
        b[a] = brick[a] / 2 + (d >> a & 1) * (brick[a] % 2 ? 1 : -1);
        within = within && b[a] >= 0 && b[a] < above->n[a];
      }
      made = !within || mcor_set_add(&tree->split[level + 1], mcor_tree_key(above, b));
    }
  }
  return made;
}

/* ---- Leaves ---- */

/* Lists the leaves of one level: the parts of split bricks that are not split. */
static bool mcor_list_leaves(mcor_tree* tree, int level, size_t* room)
{
  const mcor_brick_set* set = &tree->split[level + 1];
  const size_t most = (size_t)tree->leaf_count + 8 * set->count;
  if (most > MCOR_LEAF_LIMIT)
  {
    return false;
  }
  if (most > *room)
  {
    cl_int* leaves = realloc(tree->leaves, 2 * most * 4 * sizeof *leaves);
    if (!leaves)
    {
      return false;
    }
    tree->leaves = leaves;
    cl_int* regions = realloc(tree->regions, (2 * most + 1) * sizeof *regions);
    if (!regions)
    {
      return false;
    }
    tree->regions = regions;
    *room = 2 * most;
  }
  for (size_t i = 0; i < set->capacity; ++i)
  {
    if (set->slots[i] == MCOR_NO_BRICK)
    {
      continue;
    }
    int parent[3];
    mcor_brick_of_key(&tree->rungs[level + 1], set->slots[i], parent);
    const int first = tree->leaf_count;
    for (int d = 0; d < 8; ++d)
    {
      const int b[3] = { 2 * parent[0] + (d & 1), 2 * parent[1] + (d >> 1 & 1),
        2 * parent[2] + (d >> 2) };
      if (!mcor_tree_is_split(tree, level, b))
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
  return true;
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

mcor_status mcor_make_tree(mcor_context* context, const mcor_input* input)
{
  mcor_tree* tree = &context->tree;
  mcor_release_tree(tree);
  const double guess = mcor_guess_leaves(context, input);
  MCOR_RETURN_IF(guess > MCOR_LEAF_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large: with cube size %g the particles fill about %.3g bricks of %d "
    "adaptive cubes, and %d is the limit. Use a larger cube size.",
    context->lattice.cube, guess, MCOR_BRICK_NODES, MCOR_LEAF_LIMIT);
  MCOR_RETURN_IF(!mcor_number_bricks(&context->lattice, tree), context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large for adaptive cubes of %d levels. Choose fewer levels, or remove "
    "particles whose smoothing length is far from that of the others.",
    context->lattice.top + 1);
  bool made = mcor_split_by_particles(context, input, tree);
  size_t room = 0;
  for (int l = 1; l <= tree->top && made; ++l)
  {
    made = mcor_split_above(tree, l) && !mcor_are_too_many(tree->split);
  }
  for (int l = 0; l <= tree->top && made; ++l)
  {
    tree->first_leaf[l] = tree->leaf_count;
    tree->first_region[l] = tree->region_count;
    made = mcor_list_leaves(tree, l, &room);
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
