/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: finds the bricks that are split. A particle splits the bricks that it reaches on
 * the level above its own. A split brick splits the bricks of the next higher level that touch it.
 * Leaves around a split brick are therefore at most one level above its parts.
 *
 * The result is global: the particles of all ranks decide (mcor_measure_splits). A period is a
 * whole number of bricks of every level. A brick in the first period stands for all its periodic
 * images.
 *
 * A set of bricks has a mask for each cluster of 4^3 bricks. The bricks that a particle reaches are
 * added as masks. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_sph_kernel.h"
#include "mcor_tree.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* ---- Bricks that particles split ---- */

typedef struct mcor_tree_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_tree* tree;
  double reach; /* support radius of h = 1, in cubes */
  bool is_cube; /* the support is a cube */
  /* Edges of a level's bricks, in cubes, and their inverses. */
  double edge[MCOR_TREE_LEVEL_LIMIT + 2][3], per_edge[MCOR_TREE_LEVEL_LIMIT + 2][3];
  mcor_brick_set split[MCOR_SLICES][MCOR_TREE_LEVEL_LIMIT + 2];
  atomic_bool failed;
} mcor_tree_job;

/* A particle, and the bricks that it may reach: `first` to `last`. The level of these bricks is one
 * above the particle's level. */
typedef struct mcor_splitter
{
  double x[3], reach; /* in cubes, from the lattice's origin */
  int level, first[3], last[3];
} mcor_splitter;

/* Returns the mask of those `bricks` of a cluster that a particle reaches. First drops layers of
 * bricks that are too far away along one axis, then compares the distances of the others. */
static uint64_t mcor_reached_bricks(
  const mcor_tree_job* job, const mcor_splitter* p, const int cluster[3], uint64_t bricks)
{
  const double most = p->reach * p->reach;
  double square[3][MCOR_CLUSTER];
  for (int i = 0; i < 3 * MCOR_CLUSTER; ++i)
  {
    const int a = i / MCOR_CLUSTER, layer = i % MCOR_CLUSTER;
    const double edge = job->edge[p->level][a], below = (cluster[a] + layer) * edge - p->x[a];
    const double above = p->x[a] - (cluster[a] + layer + 1) * edge;
    const double d = below > 0 ? below : above > 0 ? above : 0;
    square[a][layer] = d * d;
    bricks &= d * d <= most ? UINT64_MAX : ~(mcor_layers(a, 1) << (layer << 2 * a));
  }
  uint64_t reached = 0;
  for (uint64_t rest = bricks, i = 0; rest; rest >>= 1, ++i)
  {
    const double distance = square[0][i & 3] + square[1][i >> 2 & 3] + square[2][i >> 4];
    reached |= (rest & (distance <= most)) << i;
  }
  return reached;
}

/* Adds to the set the bricks that a particle reaches. *all: whether the set already had all bricks
 * from p->first to p->last; always false at the end of the lattice or of the period. Returns false
 * if the set could not take the bricks. */
static bool mcor_split_reached(
  const mcor_tree_job* job, const mcor_splitter* p, mcor_brick_set* set, bool* all)
{
  const mcor_tree* tree = job->tree;
  bool made = true;
  int c[3];
  *all = true;
  for (c[2] = p->first[2] & ~3; c[2] <= p->last[2] && made; c[2] += MCOR_CLUSTER)
  {
    for (c[1] = p->first[1] & ~3; c[1] <= p->last[1] && made; c[1] += MCOR_CLUSTER)
    {
      for (c[0] = p->first[0] & ~3; c[0] <= p->last[0] && made; c[0] += MCOR_CLUSTER)
      {
        const bool whole = mcor_has_cluster(tree, p->level, c);
        const uint64_t key = whole ? mcor_brick_key(&tree->lattice->rungs[p->level], c) : 0;
        uint64_t bricks = mcor_bricks_between(p->first, p->last, c);
        bricks &= whole ? ~mcor_table_find(&set->clusters, key) : UINT64_MAX;
        *all = *all && bricks == 0;
        bricks = bricks && !job->is_cube ? mcor_reached_bricks(job, p, c, bricks) : bricks;
        made = whole ? mcor_set_add(set, key, bricks) : true;
        for (int bit = 0; bit < 64 && made && !whole; ++bit)
        {
          const int brick[3] = { c[0] + (bit & 3), c[1] + (bit >> 2 & 3), c[2] + (bit >> 4) };
          made = !(bricks >> bit & 1) || mcor_set_add_brick(tree, p->level, brick, set);
        }
      }
    }
  }
  return made;
}

/* Splits the bricks that one particle reaches. home: the brick in which the particle lies. done: a
 * cache of keys of bricks whose neighbours are all split already. Most particles lie in such a
 * brick, and reach no farther than its neighbours, so they are skipped. Returns false if the set
 * could not take the bricks. */
static bool mcor_split_by_particle(
  mcor_tree_job* job, int slice, mcor_splitter* p, uint64_t done[MCOR_BLOCK_BRICKS])
{
  const mcor_rung* rung = &job->tree->lattice->rungs[p->level];
  const double *edge = job->edge[p->level], *per_edge = job->per_edge[p->level];
  const int axes = job->context->space.axes;
  bool near = !job->is_cube, all;
  int home[3] = { 0 };
  for (int a = 0; a < axes; ++a)
  {
    home[a] = (int)(p->x[a] * per_edge[a]);
    near = near && p->reach < 0.999 * edge[a];
  }
  const uint64_t key = mcor_brick_key(rung, home);
  uint64_t* place = &done[key % MCOR_BLOCK_BRICKS];
  if (near && *place == key)
  {
    return true;
  }
  for (int a = 0; a < axes; ++a)
  {
    p->first[a] = near ? home[a] - 1 : (int)ceil((p->x[a] - p->reach) * per_edge[a]) - 1;
    p->last[a] = near ? home[a] + 1 : (int)((p->x[a] + p->reach) * per_edge[a]);
  }
  const bool made = mcor_split_reached(job, p, &job->split[slice][p->level], &all);
  *place = near && all ? key : *place;
  return made;
}

static void mcor_split_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_tree_job* job = data;
  const mcor_context* context = job->context;
  const mcor_lattice* lattice = &context->lattice;
  /* Reaches are limited to the longest measured one, as other threads may change the arrays. */
  const double longest = 1.000001 * context->measure.support_max / lattice->cube;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], length[MCOR_CHUNK];
  uint64_t done[MCOR_BLOCK_BRICKS] = { 0 };
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    mcor_read_positions(job->input, begin, count, x);
    mcor_read_smoothing_length(context, job->input, begin, count, h);
    mcor_widen_lengths(job->input, begin, count, h, length);
    for (int a = 0; a < 3; ++a)
    {
      const double origin = (double)lattice->origin[a], end = (double)lattice->last[a],
                   period = lattice->period[a], edge = mcor_edge_of(lattice, a);
      for (int i = 0; i < count; ++i)
      {
        double at = x[a][i] / lattice->edge[a] - origin;
        at -= period > 0 ? floor((at - lattice->period_first[a]) / period) * period : 0;
        at = at > 0 ? at : 0;
        x[a][i] = (at < end ? at : end) * edge;
      }
    }
    for (int i = 0; i < count && !job->failed; ++i)
    {
      const double reach = length[i] * job->reach;
      mcor_splitter p = { .x = { x[0][i], x[1][i], x[2][i] },
        .reach = reach <= longest ? reach : longest,
        .level = mcor_tree_level_of(h[i], context->measure.h_min, job->tree->top) + 1 };
      if (mcor_is_used(context, job->input, begin + i) &&
        !mcor_split_by_particle(job, slice, &p, done))
      {
        job->failed = true;
      }
    }
  }
}

static mcor_status mcor_split_by_particles(
  mcor_context* context, const mcor_input* input, mcor_tree* tree)
{
  const mcor_options* options = context->run.options;
  mcor_tree_job* job = malloc(sizeof *job);
  MCOR_TRY(mcor_allocated(context, job));
  *job = (mcor_tree_job){ .context = context, .input = input, .tree = tree };
  job->reach = mcor_support_factor(options->sph_kernel) * options->h_scale / context->lattice.cube;
  job->is_cube = mcor_kernel_of(options->sph_kernel)->is_tensor;
  for (int i = 0; i < 3 * (tree->top + 2); ++i)
  {
    job->edge[i / 3][i % 3] = ldexp(MCOR_BRICK * mcor_edge_of(&context->lattice, i % 3), i / 3);
    job->per_edge[i / 3][i % 3] = 1 / job->edge[i / 3][i % 3];
  }
  mcor_status status =
    mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_split_slice, job, NULL);
  for (int s = 0; s < MCOR_SLICES; ++s)
  {
    for (int l = 1; l <= tree->top + 1; ++l)
    {
      mcor_table* clusters = &job->split[s][l].clusters;
      bool made = !job->failed;
      for (size_t i = 0; i < clusters->capacity && made && status == MCOR_OK; ++i)
      {
        const mcor_entry* entry = &clusters->entries[i];
        made = mcor_set_add(&tree->split[l], entry->key, entry->value);
      }
      MCOR_THEN(status, mcor_leaves_fit(context, made && !mcor_are_too_many(tree->split)));
      MCOR_THEN(status, mcor_report_launch(context));
      mcor_table_free(clusters);
    }
  }
  free(job);
  return status;
}

/* ---- Bricks above split ones ---- */

/* Splits, level by level, the bricks of the next higher level that touch a split brick: the split
 * brick's parent, and the parent's neighbours that touch the split brick. */
static mcor_status mcor_split_above(mcor_context* context, mcor_tree* tree)
{
  for (int level = 1; level <= tree->top; ++level)
  {
    const mcor_table* clusters = &tree->split[level].clusters;
    for (size_t i = 0; i < clusters->capacity; ++i)
    {
      const mcor_entry cluster = clusters->entries[i];
      int first[3];
      if (i % MCOR_TREE_STEP == 0)
      {
        MCOR_TRY(mcor_report_launch(context));
      }
      if (cluster.value == 0)
      {
        continue;
      }
      mcor_brick_of_key(&tree->lattice->rungs[level], cluster.key, first);
      for (int bit = 0; bit < 64 << context->space.axes; ++bit)
      {
        const int b = bit & 63, d = bit >> 6; /* bit a of d: the parent's neighbour on axis a */
        int above[3];
        if (!(cluster.value >> b & 1))
        {
          continue;
        }
        for (int a = 0; a < 3; ++a)
        {
          const int at = first[a] + (b >> 2 * a & 3);
          above[a] = at / 2 + (d >> a & 1) * (at & 1 ? 1 : -1);
        }
        MCOR_TRY(mcor_leaves_fit(
          context, mcor_set_add_brick(tree, level + 1, above, &tree->split[level + 1])));
      }
    }
    MCOR_TRY(mcor_leaves_fit(context, !mcor_are_too_many(tree->split)));
  }
  return MCOR_OK;
}

mcor_status mcor_split_bricks(mcor_context* context, const mcor_input* input, mcor_tree* tree)
{
  MCOR_TRY(mcor_number_bricks(context, tree));
  MCOR_TRY(mcor_split_by_particles(context, input, tree));
  if (context->run.options->ranks) /* adds bricks that other ranks' particles split */
  {
    uint64_t* own = NULL;
    const void* all;
    int64_t count;
    mcor_status status = mcor_list_splits(context, tree, &own, &count);
    MCOR_THEN(status, mcor_gather_records(context, own, count, sizeof *own, &all, &count));
    MCOR_THEN(status, mcor_take_splits(context, tree, all, count));
    free(own);
    MCOR_TRY(status);
  }
  return mcor_split_above(context, tree);
}
