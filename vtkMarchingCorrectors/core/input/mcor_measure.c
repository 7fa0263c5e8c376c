/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Measures the particles for the other phases: ranges, bounds, neighbours; then the lattice. */

#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Neighbours: how many a fluid particle has, and how near the nearest one is ---- */

/* While all positions are measured, the neighbours of a few fluid particles are counted. These
 * watched particles suffice to notice wrong smoothing lengths. mcor_end_watch sets the measure's
 * neighbours, spacing, filled and h_median. */

#define MCOR_WATCH_ENTRIES 256

typedef struct mcor_watch
{
  /* Axes are cut into intervals that are longer than all supports are wide; intervals far apart
   * share an entry. Bit s of an entry: whether watched particle s may reach one of its intervals. */
  uint32_t entries[3][MCOR_WATCH_ENTRIES];
  double density; /* intervals per unit L */
  int count;
  const mcor_sample* sample;
  double support;
  int64_t neighbours[MCOR_SLICES][MCOR_WATCHED];
  double nearest[MCOR_SLICES][MCOR_WATCHED]; /* squared distance */
  bool has_normal;                           /* whether the watched particles lie in a plane */
  double normal[3];
} mcor_watch;

/* ---- A plane that is tilted in space ---- */

/* In smoothing lengths: particles count as lying in a plane if their extent along the normal is
 * below MCOR_THIN, and their extents within the plane are above MCOR_BROAD. */
#define MCOR_THIN 0.1
#define MCOR_BROAD 8

/* Finds the normal of the plane in which all watched particles lie, if they lie in one. The plane
 * goes through the first particle, the particle farthest from the first, and the particle farthest
 * from the line between these two. */
static void mcor_find_normal(mcor_watch* watch)
{
  double from[MCOR_WATCHED][3], along[3] = { 0 }, h = DBL_MAX, *normal = watch->normal;
  for (int s = 0; s < watch->count; ++s)
  {
    mcor_subtract(watch->sample[s].x, watch->sample[0].x, from[s]);
    h = fmin(h, watch->sample[s].h);
    if (mcor_dot(from[s], from[s]) > mcor_dot(along, along))
    {
      memcpy(along, from[s], sizeof along);
    }
  }
  for (int s = 0; s < watch->count; ++s)
  {
    double cross[3];
    mcor_cross(along, from[s], cross);
    if (mcor_dot(cross, cross) > mcor_dot(normal, normal))
    {
      memcpy(normal, cross, sizeof cross);
    }
  }
  const double length = sqrt(mcor_dot(along, along)), size = mcor_normalise(normal);
  watch->has_normal = length > MCOR_BROAD * h && size > MCOR_BROAD * h * length;
  for (int s = 0; s < watch->count && watch->has_normal; ++s)
  {
    watch->has_normal = fabs(mcor_dot(normal, from[s])) < MCOR_THIN * h;
  }
}

/* Returns the entry of the interval that holds x. */
static inline uint32_t* mcor_watch_entry(mcor_watch* watch, int axis, double x)
{
  const double interval = mcor_least(1e18, mcor_most(-1e18, x * watch->density));
  return &watch->entries[axis][(uint64_t)(int64_t)interval % MCOR_WATCH_ENTRIES];
}

/* For each watched particle, counts the chunk's particles within its support, and updates the
 * squared distance to the nearest of them at another place. low, high: the bounds of the chunk's
 * positions. */
static void mcor_watch_positions(
  mcor_watch* watch, int slice, const mcor_places* chunk, const double low[3], const double high[3])
{
  uint32_t some = 0; /* the watched particles that may reach the chunk */
  for (int s = 0; s < watch->count; ++s)
  {
    const double *at = watch->sample[s].x, reach = watch->support * watch->sample[s].h;
    bool is_near = true;
    for (int a = 0; a < 3; ++a)
    {
      is_near = is_near && low[a] - at[a] < reach && at[a] - high[a] < reach;
    }
    some |= (uint32_t)is_near << s;
  }
  for (int i = 0; i < (some ? chunk->count : 0); ++i)
  {
    const double x[3] = { chunk->x[0][i], chunk->x[1][i], chunk->x[2][i] };
    uint32_t near = some & *mcor_watch_entry(watch, 0, x[0]) & *mcor_watch_entry(watch, 1, x[1]) &
      *mcor_watch_entry(watch, 2, x[2]);
    for (; near; near &= near - 1)
    {
      const int s = __builtin_ctz(near);
      const double reach = watch->support * watch->sample[s].h;
      double from[3], *nearest = &watch->nearest[slice][s];
      mcor_subtract(x, watch->sample[s].x, from);
      const double square = mcor_dot(from, from);
      watch->neighbours[slice][s] += square < reach * reach;
      *nearest = square > 0 && square < *nearest ? square : *nearest;
    }
  }
}

/* Merges what all slices and ranks have found, and sets the medians in context->measure. */
static mcor_status mcor_end_watch(mcor_context* context, mcor_watch* watch, int slices)
{
  mcor_measure* m = &context->measure;
  const mcor_space* space = &context->space;
  int64_t* neighbours = watch->neighbours[0];
  double count[MCOR_WATCHED], spacing[MCOR_WATCHED], filled[MCOR_WATCHED], h[MCOR_WATCHED],
    *nearest = watch->nearest[0];
  for (int slice = 1; slice < slices; ++slice)
  {
    for (int s = 0; s < watch->count; ++s)
    {
      neighbours[s] += watch->neighbours[slice][s];
      nearest[s] = fmin(nearest[s], watch->nearest[slice][s]);
    }
  }
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, neighbours, watch->count));
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_LEAST, nearest, watch->count));
  for (int s = 0; s < watch->count; ++s)
  {
    const double reach = watch->support * watch->sample[s].h, distance = sqrt(nearest[s]);
    count[s] = (double)neighbours[s];
    filled[s] = count[s] * watch->sample[s].volume / space->ball / mcor_power(reach, space->axes);
    spacing[s] = distance < reach ? distance : 0;
    h[s] = watch->sample[s].h;
  }
  m->neighbours = mcor_median_of(count, watch->count);
  m->spacing = mcor_median_of(spacing, watch->count);
  m->filled = mcor_median_of(filled, watch->count);
  m->h_median = mcor_median_of(h, watch->count);
  return MCOR_OK;
}

/* ---- All particles ---- */

/* Indices in the mcor_findings of all particles: first the indices of ranges, then of sums. */
enum
{
  MCOR_REACHES = 0, /* positions minus and plus support radii: x, y, z */
  MCOR_PLACES = 3,  /* positions of fluid particles: x, y, z */
  MCOR_LENGTHS = 6, /* smoothing lengths of fluid particles */
  MCOR_KERNELS = 7, /* lengths of the kernels of all particles in use */
  MCOR_SCALARS = 8,
  MCOR_SPOTS = 9,      /* positions of all particles in use: x, y, z */
  MCOR_FACTORS = 12,   /* widening factors of fluid particles */
  MCOR_OFF_PLANE = 13, /* distances from the watched particles' plane, along its normal */

  MCOR_FLUID = 0, /* counts of particles: sum k is for part k of a chunk */
  MCOR_SOLIDS = 1,
  MCOR_FACTOR_SUM = 2,
  MCOR_LONE = 3 /* fluid particles that would have no surface if they were alone */
};

/* The most that one particle's widening factor adds to the sum of factors. */
#define MCOR_MOST_FACTOR 256.0

/* Adds to `r` the ranges of a chunk's fluid or, if `solids`, of its solids. reach: the support
 * radius of a kernel of length 1. low, high: the bounds of the chunk's positions. If all kernels
 * are equally long, the ranges MCOR_REACHES follow from these bounds, because rounding keeps the
 * order of numbers. */
static void mcor_measure_chunk(const mcor_places* chunk, bool solids, double reach,
  const double low[3], const double high[3], mcor_findings* r)
{
  double least = DBL_MAX, most = -DBL_MAX;
  mcor_widen_range(chunk->length, chunk->count, &least, &most);
  mcor_add_range(r, MCOR_KERNELS, least, most);
  if (!solids)
  {
    mcor_widen_range(chunk->h, chunk->count, &r->least[MCOR_LENGTHS], &r->most[MCOR_LENGTHS]);
  }
  for (int a = 0; a < 3 && chunk->count > 0; ++a)
  {
    double below[MCOR_CHUNK], above[MCOR_CHUNK], unused[2] = { -DBL_MAX, DBL_MAX };
    mcor_add_range(r, MCOR_SPOTS + a, low[a], high[a]);
    if (!solids)
    {
      mcor_add_range(r, MCOR_PLACES + a, low[a], high[a]);
    }
    if (least == most)
    {
      mcor_add_range(r, MCOR_REACHES + a, low[a] - least * reach, high[a] + least * reach);
      continue;
    }
    for (int i = 0; i < chunk->count; ++i)
    {
      const double support = chunk->length[i] * reach;
      below[i] = chunk->x[a][i] - support;
      above[i] = chunk->x[a][i] + support;
    }
    mcor_widen_range(below, chunk->count, &r->least[MCOR_REACHES + a], &unused[0]);
    mcor_widen_range(above, chunk->count, &unused[1], &r->most[MCOR_REACHES + a]);
  }
}

/* Moves the solids of a chunk to `solids`, and drops absent particles. solid: the marks of the
 * chunk's particles, or NULL. */
static void mcor_part_chunk(const uint8_t* solid, mcor_places* chunk, mcor_places* solids)
{
  const int count = chunk->count;
  solids->count = 0;
  chunk->count = solid ? 0 : count;
  for (int i = 0; i < count && solid; ++i)
  {
    mcor_places* to = solid[i] ? solids : chunk;
    for (int a = 0; a < 3; ++a)
    {
      to->x[a][to->count] = chunk->x[a][i];
    }
    to->h[to->count] = chunk->h[i];
    to->length[to->count] = chunk->length[i];
    to->count += solid[i] != MCOR_ABSENT;
  }
}

typedef struct mcor_measuring
{
  const mcor_context* context;
  const mcor_input* input;
  double reach; /* support radius / smoothing length */
  double peak;  /* W(0) of a kernel of length 1; 0: lone particles are not counted */
  double level; /* the lowest iso value */
  mcor_watch watch;
  mcor_findings slices[MCOR_SLICES];
} mcor_measuring;

static void mcor_measure_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_measuring* job = data;
  const mcor_context* context = job->context;
  const mcor_input* input = job->input;
  const bool has_scalar = context->run.options->field != MCOR_WEIGHT_SUM,
             is_widened = mcor_is_given(&input->widening), has_normal = job->watch.has_normal;
  const double origin = has_normal ? mcor_dot(job->watch.normal, job->watch.sample[0].x) : 0;
  mcor_findings r = mcor_no_findings();
  mcor_places part[2]; /* the chunk's fluid, then its solids */
  double value[MCOR_CHUNK];
  for (int count; (count = mcor_read_places(context, input, first, last, part)) > 0; first += count)
  {
    const uint8_t* solid = input->solid ? input->solid + first : NULL;
    mcor_read_scalar(input, first, has_scalar ? count : 0, value);
    for (int i = 0; i < count && has_scalar; ++i)
    {
      if (!solid || !solid[i])
      {
        mcor_add_range(&r, MCOR_SCALARS, value[i], value[i]);
        r.first = !isfinite(value[i]) && first + i < r.first ? first + i : r.first;
      }
    }
    for (int i = 0; i < count && is_widened; ++i)
    {
      if (!solid || !solid[i])
      {
        const double factor = mcor_array_at(&input->widening, first + i, 0);
        mcor_add_range(&r, MCOR_FACTORS, factor, factor);
        r.sums[MCOR_FACTOR_SUM] += (int64_t)ldexp(fmin(factor, MCOR_MOST_FACTOR), 23);
      }
    }
    mcor_read_size(input, first, job->peak > 0 ? count : 0, value);
    for (int i = 0; i < count && job->peak > 0; ++i)
    {
      const double weight =
        value[i] * job->peak / mcor_power(part[0].length[i], context->space.axes);
      r.sums[MCOR_LONE] += !(solid && solid[i]) && weight < job->level;
    }
    mcor_part_chunk(solid, &part[0], &part[1]);
    for (int k = 0; k < 2; ++k)
    {
      double low[3], high[3];
      for (int a = 0; a < 3; ++a)
      {
        low[a] = DBL_MAX;
        high[a] = -DBL_MAX;
        mcor_widen_range(part[k].x[a], part[k].count, &low[a], &high[a]);
      }
      r.sums[k] += part[k].count;
      if (k == 0 || !input->ignore_solids)
      {
        mcor_watch_positions(&job->watch, slice, &part[k], low, high);
        for (int i = 0; i < part[k].count && has_normal; ++i)
        {
          const double x[3] = { part[k].x[0][i], part[k].x[1][i], part[k].x[2][i] };
          const double off = mcor_dot(job->watch.normal, x) - origin;
          mcor_add_range(&r, MCOR_OFF_PLANE, off, off);
        }
      }
      if (k == 0 || context->kept.uses_solids)
      {
        mcor_measure_chunk(&part[k], k == 1, job->reach, low, high, &r);
      }
    }
  }
  job->slices[slice] = r;
}

/* Measures the particles of all ranks. A scalar that is not finite is reported only by the rank of
 * its particle. */
static mcor_status mcor_measure_particles(mcor_context* context, const mcor_input* input)
{
  mcor_measure* m = &context->measure;
  const mcor_options* options = context->run.options;
  const mcor_sample_list* fluid = &context->samples[0];
  mcor_measuring job = { .context = context,
    .input = input,
    .watch = { .count = fluid->count < MCOR_WATCHED ? fluid->count : MCOR_WATCHED,
      .sample = fluid->of,
      .support = mcor_support_factor(options->sph_kernel) },
    .reach = mcor_support_factor(options->sph_kernel) * options->h_scale,
    .level = options->iso_count > 0 ? DBL_MAX : 0.5 };
  int slices;
  if (options->field == MCOR_WEIGHT_SUM && !mcor_needs_density(input))
  {
    const mcor_kernel_row* kernel = mcor_kernel_of(options->sph_kernel);
    const int axes = context->space.axes;
    const double along = mcor_w_of(options->sph_kernel, 0);
    job.peak = kernel->norm * (axes == 2 ? kernel->plane_factor : 1) *
      (kernel->is_tensor ? mcor_power(along, axes) : along) / mcor_power(options->h_scale, axes);
  }
  for (int k = 0; k < options->iso_count; ++k)
  {
    job.level = fmin(job.level, options->iso_values[k]);
  }
  double widest = 0;
  for (int n = 0; n < job.watch.count; ++n)
  {
    widest = fmax(widest, fmin(DBL_MAX, job.watch.support * fluid->of[n].h));
  }
  job.watch.density = 1 / (2.01 * widest);
  for (int n = 0; n < 3 * job.watch.count; ++n)
  {
    const double at = fluid->of[n / 3].x[n % 3];
    *mcor_watch_entry(&job.watch, n % 3, at - widest) |= UINT32_C(1) << n / 3;
    *mcor_watch_entry(&job.watch, n % 3, at + widest) |= UINT32_C(1) << n / 3;
  }
  for (int n = 0; n < MCOR_SLICES * MCOR_WATCHED; ++n)
  {
    job.watch.nearest[n / MCOR_WATCHED][n % MCOR_WATCHED] = DBL_MAX;
  }
  if (context->space.axes == 3)
  {
    mcor_find_normal(&job.watch);
  }
  MCOR_TRY(
    mcor_parallel_run(context, input->count, MCOR_HEAVY_GRAIN, mcor_measure_slice, &job, &slices));
  mcor_findings found = mcor_merge_findings(job.slices, slices);
  const mcor_findings* r = &found;
  MCOR_TRY(mcor_end_watch(context, &job.watch, slices));
  MCOR_TRY(mcor_reduce_findings(context, &found));
  m->fluid_count = r->sums[MCOR_FLUID];
  m->solid_count = r->sums[MCOR_SOLIDS];
  for (int a = 0; a < 3; ++a)
  {
    m->low[a] = r->least[MCOR_REACHES + a];
    m->high[a] = r->most[MCOR_REACHES + a];
    m->x_low[a] = r->least[MCOR_PLACES + a];
    m->x_high[a] = r->most[MCOR_PLACES + a];
  }
  m->h_min = r->least[MCOR_LENGTHS];
  m->h_max = r->most[MCOR_LENGTHS];
  m->support_min = r->least[MCOR_KERNELS] * job.reach;
  m->support_max = r->most[MCOR_KERNELS] * job.reach;
  m->widening_sum = r->sums[MCOR_FACTOR_SUM];
  m->widening_min = m->widening_sum > 0 ? r->least[MCOR_FACTORS] : 0;
  m->widening_max = m->widening_sum > 0 ? r->most[MCOR_FACTORS] : 0;
  m->lone_count = r->sums[MCOR_LONE];
  m->scalar_min = r->least[MCOR_SCALARS];
  m->scalar_max = r->most[MCOR_SCALARS];
  m->not_finite = r->first;
  const double extent = r->most[MCOR_OFF_PLANE] - r->least[MCOR_OFF_PLANE];
  if (job.watch.has_normal && extent < MCOR_THIN * m->h_median)
  {
    memcpy(m->plane_normal, job.watch.normal, sizeof m->plane_normal);
    m->plane_extent = extent;
  }
  if (context->run.far)
  {
    mcor_cut_bounds(context, r->least + MCOR_SPOTS, r->most + MCOR_SPOTS);
  }
  return MCOR_OK;
}

/* Measures bounds and ranges, then the lattice. */
mcor_status mcor_measure_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  mcor_measure* m = &context->measure;
  *m = (mcor_measure){ .plane = context->plane, .not_finite = INT64_MAX };
  if (options->globals)
  {
    *m = options->globals->measured;
    return mcor_measure_lattice(context, options);
  }
  MCOR_TRY(mcor_choose_samples(
    context, input, input->estimate_smoothing_length ? MCOR_SAMPLES : MCOR_WATCHED));
  if (input->estimate_smoothing_length)
  {
    MCOR_TRY(mcor_estimate_smoothing_length(context, input, &m->h_estimate));
  }
  MCOR_TRY(mcor_measure_particles(context, input));
  MCOR_FAIL_IF(
    m->fluid_count == 0, context, MCOR_INVALID_DATA, MCOR_SAY(NO_FLUID), (long long)m->solid_count);
  if (options->field == MCOR_WEIGHT_SUM)
  {
    m->scalar_min = 0;
    m->scalar_max = 1;
  }
  /* A magnitude, or a dot product, may overflow although its components are finite. */
  const char* name = mcor_array_name(&input->scalar, "scalar");
  MCOR_FAIL_IF(m->not_finite < INT64_MAX && input->scalar_dot.data, context, MCOR_INVALID_DATA,
    MCOR_SAY(DOT_TOO_LARGE), name, mcor_array_name(&input->scalar_dot, "scalar"),
    (long long)m->not_finite);
  MCOR_FAIL_IF(m->not_finite < INT64_MAX, context, MCOR_INVALID_DATA, MCOR_SAY(MAGNITUDE_TOO_LARGE),
    name, (long long)m->not_finite);
  return mcor_measure_lattice(context, options);
}

/* Error sentences name smoothing lengths that differ from the median by more than this factor. */
#define MCOR_OUTLIER 100

void mcor_blame_outlier(mcor_context* context, const mcor_input* input)
{
  const mcor_measure* m = &context->measure;
  const double below = m->h_median / m->h_min, above = m->h_max / m->h_median;
  const double outlier = below > above ? m->h_min : m->h_max;
  if (!(m->h_median > 0) || m->fluid_count < 2 || !(fmax(below, above) > MCOR_OUTLIER))
  {
    return;
  }
  for (int64_t i = 0; i < input->count; ++i)
  {
    double h;
    mcor_read_smoothing_length(context, input, i, 1, &h);
    if (h == outlier && !(input->solid && input->solid[i]))
    {
      const size_t length = strlen(context->error);
      snprintf(context->error + length, sizeof context->error - length,
        " Particle %lld has a smoothing length of %g; the median is %g.", (long long)i, outlier,
        m->h_median);
      return;
    }
  }
}
