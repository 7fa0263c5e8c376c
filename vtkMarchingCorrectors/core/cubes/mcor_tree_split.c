/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: the bricks that are split. A particle splits the bricks of the level above its
 * own that it reaches. A split brick splits the bricks of the next level that touch it. Leaves
 * around a split brick are therefore at most one level above its parts.
 *
 * The result is global: the particles of all ranks decide (mcor_measure_splits). A period is a
 * whole number of bricks of all levels, and a brick stands for its periodic images by its image
 * in the first period.
 *
 * Sets of bricks are kept and filled in clusters of 4^3: the bricks that a particle reaches, and
 * the bricks above a cluster, are masks. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"
#include "mcor_ranks.h"
#include "mcor_sph_kernel.h"
#include "mcor_tree.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* ---- Clusters ---- */

/* Adds bricks of a cluster. first: a multiple of 4, which may be off the lattice. Returns false
 * if memory ran out, or there are too many bricks. */
static bool mcor_split_cluster(
  const mcor_tree* tree, int level, const int first[3], uint64_t bricks, mcor_brick_set* set)
{
  const mcor_rung* rung = &tree->lattice->rungs[level];
  if (mcor_has_cluster(tree, level, first))
  {
    return mcor_set_add(set, mcor_cluster_key(rung, first), bricks);
  }
  bool made = true;
  for (int bit = 0; bit < 64 && made; ++bit)
  {
    const int brick[3] = { first[0] + (bit & 3), first[1] + (bit >> 2 & 3), first[2] + (bit >> 4) };
    int b[3];
    if ((bricks >> bit & 1) && mcor_place_brick(tree, level, brick, b))
    {
      made = mcor_set_add(set, mcor_cluster_key(rung, b), UINT64_C(1) << mcor_cluster_bit(b));
    }
  }
  return made;
}

/* Returns the mask of the first `count` of a cluster's four layers across an axis. */
static uint64_t mcor_layers(int axis, int count)
{
  static const uint64_t layers[3][5] = { { 0, 0x1111111111111111, 0x3333333333333333,
                                           0x7777777777777777, UINT64_MAX },
    { 0, 0x000f000f000f000f, 0x00ff00ff00ff00ff, 0x0fff0fff0fff0fff, UINT64_MAX },
    { 0, 0xffff, 0xffffffff, 0xffffffffffff, UINT64_MAX } };
  return layers[axis][count];
}

/* Adds 4^3 bricks, given as bits, from any brick `first` on. */
static bool mcor_split_cube(
  const mcor_tree* tree, int level, const int first[3], uint64_t bricks, mcor_brick_set* set)
{
  bool made = true;
  for (int d = 0; d < 8 && made; ++d)
  {
    uint64_t part = bricks;
    int cluster[3];
    for (int a = 0; a < 3; ++a)
    {
      const int by = first[a] & 3, shift = 2 * a, beyond = d >> a & 1;
      cluster[a] = first[a] - by + MCOR_CLUSTER * beyond;
      if (by > 0)
      {
        part = beyond ? part >> ((MCOR_CLUSTER - by) << shift) & mcor_layers(a, by)
                      : (part & mcor_layers(a, MCOR_CLUSTER - by)) << (by << shift);
      }
      part = by == 0 && beyond ? 0 : part;
    }
    made = part == 0 || mcor_split_cluster(tree, level, cluster, part, set);
  }
  return made;
}

/* ---- Bricks that particles split ---- */

typedef struct mcor_tree_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_tree* tree;
  int64_t begin;                             /* first particle of this loop */
  double reach;                              /* support radius of h = 1, in cubes */
  bool is_cube;                              /* the support is a cube */
  double edge[MCOR_TREE_LEVEL_LIMIT + 2][3]; /* edges of a level's bricks, in cubes */
  mcor_brick_set split[MCOR_SLICES][MCOR_TREE_LEVEL_LIMIT + 2];
  bool failed[MCOR_SLICES];
  /* Tables of bricks with particles, shared by all slices. A brick may take the place of another
   * one. */
  _Atomic uint64_t* around; /* key << 27
                             *
                             * which of the 3^3 bricks around the brick are split */
  _Atomic uint64_t* done;   /* for 2^3 bricks: key << 8
                             *
                             * which of them have all bricks around them split */
  uint64_t around_mask, done_mask;
  int64_t spared[MCOR_SLICES]; /* particles that split nothing new, less all others */
} mcor_tree_job;

/* Returns the squared distance from x to the brick's interval along an axis. edge: of the brick. */
static double mcor_interval_distance2(double x, int brick, double edge)
{
  const double below = brick * edge - x, above = x - (brick + 1) * edge;
  const double d = below > 0 ? below : above > 0 ? above : 0;
  return d * d;
}

/* A particle and the bricks of a level within its reach: from `first` to `last`. */
typedef struct mcor_reached
{
  double x[3], edge[3], reach; /* in cubes, x from the lattice's origin */
  bool is_cube;
  int first[3], last[3];
} mcor_reached;

/* Returns the bricks of a cluster that are reached. */
static uint64_t mcor_reached_bricks(const mcor_reached* reached, const int cluster[3])
{
  double square[3][MCOR_CLUSTER];
  int first[3], last[3];
  for (int a = 0; a < 3; ++a)
  {
    first[a] = reached->first[a] > cluster[a] ? reached->first[a] - cluster[a] : 0;
    last[a] = reached->last[a] - cluster[a];
    last[a] = last[a] < MCOR_CLUSTER ? last[a] : MCOR_CLUSTER - 1;
    for (int i = first[a]; i <= last[a]; ++i)
    {
      square[a][i] = reached->is_cube
        ? 0
        : mcor_interval_distance2(reached->x[a], cluster[a] + i, reached->edge[a]);
    }
  }
  uint64_t bricks = 0;
  for (int z = first[2]; z <= last[2]; ++z)
  {
    for (int y = first[1]; y <= last[1]; ++y)
    {
      for (int x = first[0]; x <= last[0]; ++x)
      {
        const bool in =
          square[0][x] + square[1][y] + square[2][z] <= reached->reach * reached->reach;
        bricks |= (uint64_t)in << (x + 4 * y + 16 * z);
      }
    }
  }
  return bricks;
}

/* Returns the place of a key in a table of mask + 1 places. */
static uint64_t mcor_place_of(uint64_t key, uint64_t mask)
{
  return (key * UINT64_C(0x9E3779B97F4A7C15)) >> 32 & mask;
}

/* Returns which of the 3^3 bricks around `home` are within `reach` of x, which lies in `home`. */
static uint32_t mcor_reached_around(
  const double x[3], const int home[3], const double edge[3], double reach, bool plane)
{
  double square[3][3];
  for (int a = 0; a < 3; ++a)
  {
    const double below = x[a] - home[a] * edge[a], above = (home[a] + 1) * edge[a] - x[a];
    square[a][0] = below * below;
    square[a][1] = 0;
    square[a][2] = above * above;
  }
  uint32_t bricks = 0;
  for (int z = plane ? 1 : 0; z < (plane ? 2 : 3); ++z)
  {
    for (int y = 0; y < 3; ++y)
    {
      for (int column = 0; column < 3; ++column)
      {
        const bool in = square[0][column] + square[1][y] + square[2][z] <= reach * reach;
        bricks |= (uint32_t)in << (column + 3 * y + 9 * z);
      }
    }
  }
  return bricks;
}

/* Turns a mask of 3^3 bricks into the lowest ones of 4^3. */
static uint64_t mcor_widen_27(uint32_t bricks)
{
  uint64_t wide = 0;
  for (int row = 0; row < 9; ++row)
  {
    wide |= (uint64_t)(bricks >> 3 * row & 7) << (row / 3 * 16 + row % 3 * 4);
  }
  return wide;
}

/* Splits the bricks of a level that are within `reach` of x. Nearly all particles reach no
 * farther than the bricks around their own, and other particles there have split these already;
 * the tables tell. If successive particles are far apart, looking this up costs more than it
 * saves, and stops. */
static bool mcor_split_reached(
  mcor_tree_job* job, int slice, int level, const double x[3], double reach)
{
  mcor_brick_set* set = &job->split[slice][level];
  const bool plane = job->tree->is_plane;
  const mcor_rung* rung = &job->tree->lattice->rungs[level];
  int home[3];
  bool near = job->done && !job->is_cube && job->spared[slice] > -4 * MCOR_HEAVY_GRAIN;
  for (int a = 0; a < 3; ++a)
  {
    home[a] = plane && a == 2 ? 0 : (int)(x[a] / job->edge[level][a]);
    near = near && reach < 0.999 * job->edge[level][a];
  }
  const int corner[3] = { home[0] & ~1, home[1] & ~1, home[2] & ~1 };
  const uint64_t corner_key = mcor_brick_key(rung, corner);
  const uint64_t bit = 1u << ((home[0] & 1) | (home[1] & 1) << 1 | (home[2] & 1) << 2);
  _Atomic uint64_t* at = near ? job->done + mcor_place_of(corner_key, job->done_mask) : NULL;
  uint64_t done = near ? atomic_load_explicit(at, memory_order_relaxed) : 0;
  done = done >> 8 == corner_key ? done : corner_key << 8;
  if (near && (done & bit))
  {
    ++job->spared[slice];
    return true;
  }
  if (near)
  {
    --job->spared[slice];
    const uint64_t all = plane ? 0x3fe00 : 0x7ffffff, key = mcor_brick_key(rung, home);
    _Atomic uint64_t* place = job->around + mcor_place_of(key, job->around_mask);
    const uint64_t last = atomic_load_explicit(place, memory_order_relaxed);
    const uint64_t known = last >> 27 == key ? last & all : 0;
    const int below[3] = { home[0] - 1, home[1] - 1, home[2] - 1 };
    const uint64_t found =
      known == all ? all : known | mcor_reached_around(x, home, job->edge[level], reach, plane);
    if (found != known &&
      !mcor_split_cube(job->tree, level, below, mcor_widen_27((uint32_t)(found & ~known)), set))
    {
      return false;
    }
    if (found != known)
    {
      atomic_store_explicit(place, key << 27 | found, memory_order_relaxed);
    }
    if (found == all)
    {
      atomic_store_explicit(at, done | bit, memory_order_relaxed);
    }
    return true;
  }
  mcor_reached reached = { .reach = reach, .is_cube = job->is_cube };
  for (int a = 0; a < 3; ++a)
  {
    const bool flat = plane && a == 2;
    reached.x[a] = x[a];
    reached.edge[a] = job->edge[level][a];
    reached.first[a] = flat ? 0 : (int)ceil((x[a] - reach) / reached.edge[a]) - 1;
    reached.last[a] = flat ? 0 : (int)floor((x[a] + reach) / reached.edge[a]);
  }
  const int* first = reached.first;
  int c[3];
  for (c[2] = first[2] & ~3; c[2] <= reached.last[2]; c[2] += MCOR_CLUSTER)
  {
    for (c[1] = first[1] & ~3; c[1] <= reached.last[1]; c[1] += MCOR_CLUSTER)
    {
      for (c[0] = first[0] & ~3; c[0] <= reached.last[0]; c[0] += MCOR_CLUSTER)
      {
        const uint64_t bricks = mcor_reached_bricks(&reached, c);
        if (bricks != 0 && !mcor_split_cluster(job->tree, level, c, bricks, set))
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
  const double longest = 1.000001 * context->measure.support_max / lattice->cube;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], length[MCOR_CHUNK];
  const int64_t end = job->begin + last;
  for (int64_t begin = job->begin + first; begin < end && !job->failed[slice]; begin += MCOR_CHUNK)
  {
    const int count = end - begin < MCOR_CHUNK ? (int)(end - begin) : MCOR_CHUNK;
    mcor_read_positions(job->input, begin, count, x);
    mcor_read_smoothing_length(context, job->input, begin, count, h);
    mcor_widen_lengths(job->input, begin, count, h, length);
    for (int i = 0; i < count && !job->failed[slice]; ++i)
    {
      if (!mcor_is_used(context, job->input, begin + i))
      {
        continue;
      }
      /* The reach is limited to the longest measured one, in case other threads write to the
       * arrays meanwhile. */
      const int level = mcor_tree_level_of(h[i], h_min, job->tree->top) + 1;
      const double support = length[i] * job->reach;
      const double reach = support <= longest ? support : longest;
      double at[3];
      for (int a = 0; a < 3; ++a)
      {
        at[a] = x[a][i] / lattice->edge[a] - (double)lattice->origin[a];
        const double from = at[a] - lattice->period_first[a], period = lattice->period[a];
        at[a] -= period > 0 ? floor(from / period) * period : 0;
        const double inside = at[a] > 0 ? at[a] : 0, end_of_lattice = (double)lattice->last[a];
        at[a] = (inside < end_of_lattice ? inside : end_of_lattice) * mcor_edge_of(lattice, a);
      }
      const size_t before = job->split[slice][level].count;
      job->failed[slice] = !mcor_split_reached(job, slice, level, at, reach) ||
        (job->split[slice][level].count > before && mcor_are_too_many(job->split[slice]));
    }
  }
}

/* Returns the particles of a slice: all slices of a loop together take about 0.1 s. */
static int64_t mcor_split_grain(const mcor_tree_job* job)
{
  const mcor_measure* measure = &job->context->measure;
  const double largest = fmax(2 * measure->h_min, ldexp(measure->h_max, -job->tree->top));
  const double cluster = 2 * MCOR_BRICK * MCOR_CLUSTER; /* edge, at the level above the lowest */
  const double widest =
    measure->support_max / job->context->lattice.cube / (job->reach * measure->h_max);
  const double along = 2 * job->reach * widest * largest / cluster + 2;
  const double grain = 8 * MCOR_HEAVY_GRAIN / (along * along * (job->tree->is_plane ? 1 : along));
  return grain < 1 ? 1 : grain < MCOR_HEAVY_GRAIN ? (int64_t)grain : MCOR_HEAVY_GRAIN;
}

/* Finds the bricks that particles split, in slices. */
static mcor_status mcor_split_in_slices(mcor_context* context, mcor_tree_job* job)
{
  const int64_t grain = mcor_split_grain(job), step = MCOR_SLICES * grain;
  const int64_t particles = job->input->count;
  for (job->begin = 0; job->begin < particles; job->begin += step)
  {
    const int64_t rest = particles - job->begin;
    mcor_parallel_for(context, rest < step ? rest : step, grain, mcor_split_slice, job);
    for (int s = 0; s < MCOR_SLICES; ++s)
    {
      MCOR_TRY(job->failed[s] ? mcor_fail_leaves(context) : MCOR_OK);
    }
    MCOR_TRY(mcor_report_launch(context));
  }
  return MCOR_OK;
}

static mcor_status mcor_join_slices(
  mcor_context* context, const mcor_tree_job* job, mcor_tree* tree)
{
  for (int s = 0; s < MCOR_SLICES; ++s)
  {
    for (int l = 0; l <= tree->top + 1; ++l)
    {
      const bool made = mcor_set_add_all(&tree->split[l], &job->split[s][l]);
      MCOR_TRY(made && !mcor_are_too_many(tree->split) ? MCOR_OK : mcor_fail_leaves(context));
    }
    MCOR_TRY(mcor_report_launch(context));
  }
  return MCOR_OK;
}

static mcor_status mcor_split_by_particles(
  mcor_context* context, const mcor_input* input, mcor_tree* tree)
{
  mcor_tree_job* job = calloc(1, sizeof *job);
  MCOR_TRY(mcor_allocated(context, job));
  const mcor_options* options = context->run.options;
  job->context = context;
  job->input = input;
  job->tree = tree;
  job->reach = mcor_support_factor(options->sph_kernel) * options->h_scale / context->lattice.cube;
  job->is_cube = mcor_is_tensor(options->sph_kernel);
  for (int i = 0; i < 3 * (tree->top + 2); ++i)
  {
    job->edge[i / 3][i % 3] = ldexp(MCOR_BRICK * mcor_edge_of(&context->lattice, i % 3), i / 3);
  }
  /* The tables only save time, so they may be missing. */
  const uint64_t places = input->count < 1 << 20 ? 1 << 16 : 1 << 18;
  const bool fits = mcor_tree_key_limit(tree) >> (64 - 27) == 0;
  job->around = fits ? calloc(places, sizeof *job->around) : NULL;
  job->done = job->around ? calloc(places / 4, sizeof *job->done) : NULL;
  job->around_mask = places - 1;
  job->done_mask = places / 4 - 1;
  mcor_status status = mcor_split_in_slices(context, job);
  status = status == MCOR_OK ? mcor_join_slices(context, job, tree) : status;
  for (int s = 0; s < MCOR_SLICES; ++s)
  {
    for (int l = 0; l <= tree->top + 1; ++l)
    {
      mcor_table_free(&job->split[s][l].clusters);
    }
  }
  free((void*)job->around);
  free((void*)job->done);
  free(job);
  return status;
}

/* ---- Bricks above split ones ---- */

/* Returns which of four bricks above along an axis touch bricks of a cluster. The first of the
 * four is the one below the first parent. Brick i touches brick i / 2 and the nearest other one. */
static uint64_t mcor_spread_layers(int axis, uint64_t bricks)
{
  const int step = 1 << 2 * axis;
  const uint64_t layer = mcor_layers(axis, 1), low = bricks & layer,
                 second = bricks >> step & layer, third = bricks >> 2 * step & layer,
                 high = bricks >> 3 * step & layer;
  return low | (low | second | third) << step | (second | third | high) << 2 * step |
    high << 3 * step;
}

/* Splits the bricks above that touch a split one: its parent, and the bricks beyond the sides of
 * the parent at which it lies. */
static mcor_status mcor_split_above(mcor_context* context, mcor_tree* tree, int level)
{
  const mcor_brick_set* set = &tree->split[level];
  for (size_t i = 0; i < set->clusters.capacity; ++i)
  {
    if (set->clusters.entries[i].value != 0)
    {
      int first[3];
      uint64_t above = set->clusters.entries[i].value;
      mcor_first_of_cluster(&tree->lattice->rungs[level], set->clusters.entries[i].key, first);
      for (int a = 0; a < (tree->is_plane ? 2 : 3); ++a)
      {
        first[a] = first[a] / 2 - 1;
        above = mcor_spread_layers(a, above);
      }
      const bool made = mcor_split_cube(tree, level + 1, first, above, &tree->split[level + 1]);
      MCOR_TRY(made ? MCOR_OK : mcor_fail_leaves(context));
    }
    MCOR_TRY(i % MCOR_TREE_STEP == 0 ? mcor_report_launch(context) : MCOR_OK);
  }
  return mcor_are_too_many(tree->split) ? mcor_fail_leaves(context) : MCOR_OK;
}

/* ---- All ---- */

/* Fails if there will be too many leaves. A particle has about the volume (h / 1.3)^3, in the
 * plane the area (h / 1.3)^2, filled with cubes of its level. */
static mcor_status mcor_guess_leaves(mcor_context* context, const mcor_input* input)
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
      const int level =
        mcor_tree_level_of(h[i], context->measure.h_min, context->lattice.levels - 1);
      const double bricks = h[i] / 1.3 / ldexp(brick, level);
      const double third = mcor_is_plane(context) ? 1 : bricks;
      leaves += mcor_is_used(context, input, begin + i) ? bricks * bricks * third : 0;
    }
    MCOR_TRY(mcor_report_launch(context));
  }
  MCOR_RETURN_IF(leaves > MCOR_LEAF_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "The virtual grid is too large: with cube size %g the particles fill about %.3g bricks of %d "
    "adaptive cubes; the limit is %d. Use a larger cube size.",
    context->lattice.cube, leaves, MCOR_BRICK_NODES, MCOR_LEAF_LIMIT);
  return MCOR_OK;
}

/* Adds the bricks that other ranks' particles split. */
static mcor_status mcor_join_ranks(mcor_context* context, mcor_tree* tree)
{
  uint64_t* own = NULL;
  const void* all;
  int64_t count;
  mcor_status status = mcor_list_splits(context, tree, &own, &count);
  status = status == MCOR_OK ? mcor_gather(context, own, count, sizeof *own, &all, &count) : status;
  status = status == MCOR_OK ? mcor_take_splits(context, tree, all, count) : status;
  free(own);
  return status;
}

mcor_status mcor_split_bricks(mcor_context* context, const mcor_input* input, mcor_tree* tree)
{
  MCOR_TRY(mcor_guess_leaves(context, input));
  MCOR_TRY(mcor_number_bricks(context, tree));
  MCOR_TRY(mcor_split_by_particles(context, input, tree));
  MCOR_TRY(context->run.options->ranks ? mcor_join_ranks(context, tree) : MCOR_OK);
  for (int l = 1; l <= tree->top; ++l)
  {
    MCOR_TRY(mcor_split_above(context, tree, l));
  }
  return MCOR_OK;
}
