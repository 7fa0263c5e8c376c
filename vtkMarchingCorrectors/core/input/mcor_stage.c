/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Copies the particles that a call needs from the caller's arrays to the device, in input order;
 * in a periodic box their images, too. */

#include "mcor_stage.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_VIEWS 6

/* Views of the stage's buffers on the host. */
static void mcor_list_views(
  mcor_context* context, mcor_staging* staging, mcor_mapping views[MCOR_VIEWS])
{
  mcor_stage_data* s = &context->stage;
  const size_t count = (size_t)staging->count, fix = count * context->cl.fix_size,
               real = count * context->cl.real_size;
  views[0] = (mcor_mapping){ &s->x, fix, &staging->x[0] };
  views[1] = (mcor_mapping){ &s->y, fix, &staging->x[1] };
  views[2] = (mcor_mapping){ &s->z, fix, &staging->x[2] };
  views[3] = (mcor_mapping){ &s->inv_h, real, &staging->inv_h };
  views[4] = (mcor_mapping){ &s->size, real, &staging->size };
  views[5] = (mcor_mapping){ &s->level, count, &staging->level };
}

static mcor_status mcor_map_staging(mcor_context* context, mcor_staging* staging)
{
  mcor_stage_data* s = &context->stage;
  mcor_buffer* const buffers[MCOR_VIEWS] = { &s->x, &s->y, &s->z, &s->inv_h, &s->size, &s->level };
  mcor_mapping views[MCOR_VIEWS];
  mcor_list_views(context, staging, views);
  for (int i = 0; i < MCOR_VIEWS; ++i)
  {
    MCOR_TRY(mcor_reserve(context, buffers[i], views[i].bytes));
    MCOR_TRY(mcor_map(context, buffers[i], views[i].bytes, true, views[i].data));
  }
  return MCOR_OK;
}

mcor_status mcor_unmap_staging(mcor_context* context, mcor_staging* staging)
{
  mcor_mapping views[MCOR_VIEWS];
  mcor_list_views(context, staging, views);
  return mcor_unmap_all(context, views, MCOR_VIEWS, MCOR_OK);
}

/* Returns the factor from what a particle gives for its volume to what the device gets: the
 * volume in cubes (in two dimensions the area over the smoothing length), the mass over the
 * largest one, or 1; see the volume formulas of mcor_input. */
double mcor_size_scale(mcor_context* context, const mcor_input* input)
{
  const double cube = context->lattice.cube;
  const mcor_options* options = context->run.options;
  if (!mcor_needs_density(input))
  {
    /* An area becomes a volume by this factor times the smoothing length, see mcor_plane.h. */
    const double lift =
      context->space.flat ? mcor_plane_factor(options->sph_kernel) * options->h_scale : 1;
    return lift / (cube * cube * cube);
  }
  if (!mcor_is_given(&input->mass))
  {
    return 1;
  }
  const mcor_globals* globals = options->globals;
  return 1 / (globals ? globals->mass_max : mcor_largest(context, input, &input->mass, 0));
}

typedef struct mcor_stage_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_staging* staging;
  const mcor_reach_box* reach; /* NULL: all particles are needed */
  double h_max;                /* the largest support that was measured, with rounding */
  uint8_t* images;             /* by particle: whether an image is staged; NULL without reach */
  int64_t used[MCOR_SLICES];   /* images in each slice */
  int64_t to[MCOR_SLICES];     /* where each slice's images begin */
  int64_t heavy[MCOR_SLICES];  /* see mcor_find_heavy */
  bool changed
    [MCOR_SLICES]; /* particles differ from what was measured: another thread writes to the arrays */
  double largest_weight[MCOR_SLICES];
} mcor_stage_job;

/* Lists the images of particle i of a chunk that are staged. */
static int mcor_images_of(
  const mcor_stage_job* job, const mcor_stage_chunk* chunk, int i, mcor_images* images)
{
  *images = (mcor_images){ 0 };
  if (!mcor_is_used(job->context, job->input, chunk->source[i]))
  {
    return 0;
  }
  if (!job->reach)
  {
    return 1;
  }
  double at[3];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = chunk->x[a][i] * job->reach->unit;
  }
  const double h = chunk->h[i] <= job->h_max ? chunk->h[i] : job->h_max;
  return mcor_list_images(job->reach, at, mcor_reach_of(job->reach, h, chunk->level[i]), images);
}

/* Marks the particles that may reach the box, by one test of each coordinate that the box
 * limits. The exact test of the images finds all of these, but for a few. */
static void mcor_mark_near(const mcor_stage_job* job, int64_t first, int count)
{
  const mcor_reach_box* reach = job->reach;
  const mcor_lattice* lattice = &job->context->lattice;
  mcor_array positions = job->input->positions;
  double x[MCOR_CHUNK], h[MCOR_CHUNK], length[MCOR_CHUNK];
  uint8_t* near = job->images + first;
  positions.components = 3;
  memset(near, 1, (size_t)count);
  mcor_read_smoothing_length(job->context, job->input, first, count, h);
  mcor_widen_lengths(job->input, first, count, h, length);
  for (int i = 0; i < count; ++i)
  {
    const int level = mcor_tree_level_of(h[i], reach->h_min, reach->top);
    h[i] = mcor_reach_of(reach, length[i], level) * lattice->cube;
  }
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a], rounding = 1 + reach->radius;
    const double low = (reach->low[a] - rounding) * lattice->cube + origin * lattice->edge[a];
    const double high = (reach->high[a] + rounding) * lattice->cube + origin * lattice->edge[a];
    const double edge = mcor_edge_of(lattice, a);
    if (reach->period[a] > 0 ||
      (reach->low[a] <= (double)lattice->first[a] * edge &&
        reach->high[a] >= (double)lattice->last[a] * edge))
    {
      continue;
    }
    mcor_read_array(&positions, first, count, a, x);
    for (int i = 0; i < count; ++i)
    {
      near[i] &= (x[i] + h[i] >= low) & (x[i] - h[i] <= high);
    }
  }
}

/* Gaps between marked particles up to this length are read, too, rather than jumped over. */
#define MCOR_STAGE_GAP 8

/* Finds the next run of particles to read at once, from *begin on; returns its length, 0 at the
 * end. */
static int mcor_next_run(const mcor_stage_job* job, int64_t* begin, int64_t last)
{
  const uint8_t* images = job->images;
  if (!images)
  {
    return last - *begin < MCOR_CHUNK ? (int)(last - *begin) : MCOR_CHUNK;
  }
  const uint8_t* next = *begin < last ? memchr(images + *begin, 1, (size_t)(last - *begin)) : NULL;
  *begin = next ? next - images : last;
  int count = 0;
  for (int i = 0; i < MCOR_CHUNK && *begin + i < last && i - count < MCOR_STAGE_GAP; ++i)
  {
    count = images[*begin + i] ? i + 1 : count;
  }
  return count;
}

/* Keeps the marks of particles with images that are staged; returns the number of these images. */
static int64_t mcor_count_images(mcor_stage_job* job, int64_t first, int64_t last)
{
  int64_t used = 0;
  mcor_stage_chunk chunk;
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    mcor_mark_near(job, begin, last - begin < MCOR_CHUNK ? (int)(last - begin) : MCOR_CHUNK);
  }
  for (int64_t begin = first; (chunk.count = mcor_next_run(job, &begin, last)) > 0;
       begin += chunk.count)
  {
    mcor_read_stage_places(job->context, job->input, begin, job->reach, &chunk);
    for (int i = 0; i < chunk.count; ++i)
    {
      mcor_images images;
      const int count = job->images[begin + i] ? mcor_images_of(job, &chunk, i, &images) : 0;
      job->images[begin + i] = count > 0;
      used += count;
    }
  }
  return used;
}

static void mcor_count_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_stage_job* job = data;
  int64_t used = job->reach ? mcor_count_images(job, first, last) : last - first;
  for (int64_t i = first; i < last && !job->reach && job->input->solid; ++i)
  {
    used -= !mcor_is_used(job->context, job->input, i);
  }
  job->used[slice] = used;
}

/* Whether a chunk's particles are within the measured bounds, on which everything that follows
 * relies. */
static bool mcor_is_as_measured(const mcor_stage_job* job, const mcor_stage_chunk* chunk)
{
  const mcor_lattice* lattice = &job->context->lattice;
  int outside = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double high = (double)lattice->last[a] * (double)lattice->step[a];
    for (int i = 0; i < chunk->count; ++i)
    {
      outside |= !(chunk->x[a][i] >= 0 && chunk->x[a][i] <= high);
    }
  }
  for (int i = 0; i < chunk->count; ++i)
  {
    outside |= !(chunk->h[i] > 0 && chunk->h[i] <= job->h_max);
  }
  return !outside;
}

/* Stages a chunk from element *to on, and advances *to. Stops at a particle that is too heavy,
 * or that has changed. */
static void mcor_stage_chunk_at(
  mcor_stage_job* job, int slice, mcor_stage_chunk* chunk, int64_t* to)
{
  job->changed[slice] = job->changed[slice] ||
    *to + chunk->count > job->to[slice] + job->used[slice] || !mcor_is_as_measured(job, chunk);
  if (job->changed[slice])
  {
    return;
  }
  if (job->heavy[slice] < 0)
  {
    job->heavy[slice] =
      mcor_find_heavy(job->context, job->input, chunk, &job->largest_weight[slice]);
  }
  if (job->heavy[slice] < 0)
  {
    mcor_store_stage_chunk(job->context, job->input, chunk, job->staging, *to);
    *to += chunk->count;
  }
}

/* Adds the staged images of a chunk's particles to `out`, which is staged whenever it is full. */
static void mcor_stage_images(
  mcor_stage_job* job, int slice, const mcor_stage_chunk* chunk, mcor_stage_chunk* out, int64_t* to)
{
  mcor_images images = { 0 };
  double period[3] = { 0 };
  bool one = job->images != NULL; /* image number of each particle in `out` */
  for (int a = 0; a < 3 && job->reach; ++a)
  {
    period[a] = ldexp(job->reach->period[a], job->reach->fix_bits);
    one = one && job->reach->period[a] == 0;
  }
  for (int i = 0; i < chunk->count; ++i)
  {
    const bool none = job->images && !job->images[chunk->source[i]];
    const int count = none ? 0 : one ? 1 : mcor_images_of(job, chunk, i, &images);
    int k[3] = { images.first[0], images.first[1], images.first[2] };
    for (int n = 0; n < count; ++n)
    {
      for (int a = 0; a < 3; ++a)
      {
        out->x[a][out->count] = chunk->x[a][i] + k[a] * period[a];
      }
      out->h[out->count] = chunk->h[i];
      out->level[out->count] = chunk->level[i];
      out->size[out->count] = chunk->size[i];
      out->source[out->count++] = chunk->source[i];
      for (int a = 0; a < 3 && ++k[a] > images.last[a]; ++a)
      {
        k[a] = images.first[a];
      }
      if (out->count == MCOR_CHUNK)
      {
        mcor_stage_chunk_at(job, slice, out, to);
        out->count = 0;
      }
    }
  }
}

static void mcor_stage_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_stage_job* job = data;
  int64_t to = job->to[slice];
  mcor_stage_chunk chunk, out;
  job->heavy[slice] = -1;
  job->changed[slice] = false;
  out.count = 0;
  int64_t begin = first;
  while (job->heavy[slice] < 0 && !job->changed[slice] &&
    (chunk.count = mcor_next_run(job, &begin, last)) > 0)
  {
    const int read = chunk.count;
    mcor_read_stage_chunk(job->context, job->input, begin, job->staging, job->reach, &chunk);
    if (job->input->solid || job->reach)
    {
      mcor_stage_images(job, slice, &chunk, &out, &to);
    }
    else
    {
      mcor_stage_chunk_at(job, slice, &chunk, &to);
    }
    begin += read;
  }
  mcor_stage_chunk_at(job, slice, &out, &to);
  job->changed[slice] =
    job->changed[slice] || (job->heavy[slice] < 0 && to != job->to[slice] + job->used[slice]);
}

static mcor_status mcor_refuse_heavy(
  mcor_context* context, const mcor_input* input, const mcor_staging* staging, int64_t i)
{
  mcor_stage_chunk chunk = { .count = 1 };
  mcor_read_stage_chunk(context, input, i, staging, NULL, &chunk);
  return mcor_fail(context, MCOR_INVALID_DATA,
    "The volume of particle %lld is %.3g times the cube of its smoothing length, too large for %s "
    "precision. Correct the volume, or remove such particles.",
    (long long)i, mcor_stage_weight(context, &chunk, 0),
    context->cl.real_size == sizeof(float) ? "single" : "double");
}

/* Reserves room for the particles that the job stages. */
static mcor_status mcor_make_stage_room(
  mcor_context* context, mcor_stage_job* job, mcor_staging* staging)
{
  const int64_t count = job->input->count;
  int slices;
  int64_t total = 0;
  MCOR_TRY(mcor_parallel_run(context, count, MCOR_HEAVY_GRAIN, mcor_count_slice, job, &slices));
  for (int s = 0; s < slices; ++s)
  {
    job->to[s] = total;
    total += job->used[s];
  }
  MCOR_RETURN_IF(total > MCOR_PARTICLE_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "Including periodic images there are %lld particles; the limit is %d.", (long long)total,
    MCOR_PARTICLE_LIMIT);
  staging->count = (int)total;
  const size_t bytes = (size_t)staging->count * sizeof(int32_t);
  free(context->source);
  context->source = NULL;
  if (job->input->solid || job->reach)
  {
    context->source = malloc(bytes + 1);
    MCOR_TRY(mcor_allocated(context, context->source));
    mcor_use_large_pages(context->source, bytes);
  }
  return staging->count > 0 ? mcor_map_staging(context, staging) : MCOR_OK;
}

static mcor_status mcor_stage_particles(
  mcor_context* context, mcor_stage_job* job, mcor_staging* staging)
{
  const mcor_input* input = job->input;
  MCOR_TRY(mcor_make_stage_room(context, job, staging));
  int slices;
  MCOR_TRY(mcor_parallel_run(context, staging->count > 0 ? input->count : 0, MCOR_HEAVY_GRAIN,
    mcor_stage_slice, job, &slices));
  /* A computed volume is at most 100 h^3 / norm, see MCOR_LEAST_DENSITY. */
  context->largest_weight =
    mcor_needs_density(input) ? 100 * pow(context->run.options->h_scale, -3) : 0;
  MCOR_RETURN_IF(!(context->largest_weight < mcor_weight_limit(context)), context,
    MCOR_INVALID_ARGUMENT,
    "The h scale factor is %g, too small for computed volumes. Provide volumes, or choose a larger "
    "factor.",
    context->run.options->h_scale);
  for (int s = 0; s < slices; ++s)
  {
    MCOR_RETURN_IF(job->changed[s], context, MCOR_INVALID_DATA,
      "The particle arrays were changed during the call%s. No other thread may write to them until "
      "the call returns.",
      context->run.options->globals ? ", or options.globals was measured over other particles"
                                    : "");
    if (job->heavy[s] >= 0)
    {
      return mcor_refuse_heavy(context, input, staging, job->heavy[s]);
    }
    context->largest_weight = fmax(context->largest_weight, job->largest_weight[s]);
  }
  return MCOR_OK;
}

mcor_status mcor_stage(mcor_context* context, const mcor_input* input, mcor_staging* staging)
{
  mcor_stage_job job = { .context = context, .input = input, .staging = staging };
  staging->size_scale = mcor_size_scale(context, input);
  job.h_max = 1.000001 * context->measure.support_max / context->run.options->h_scale /
    mcor_support_factor(context->run.options->sph_kernel);
  mcor_reach_box reach;
  if (mcor_find_reach(context, input, &reach))
  {
    job.reach = &reach;
    job.images = malloc((size_t)input->count);
    MCOR_TRY(mcor_allocated(context, job.images));
  }
  const mcor_status status = mcor_stage_particles(context, &job, staging);
  free(job.images);
  return status;
}

void mcor_release_stage(mcor_context* context)
{
  mcor_stage_data* s = &context->stage;
  MCOR_RELEASE(context, &s->x, &s->y, &s->z, &s->inv_h, &s->size, &s->level, &s->density,
    &s->values, &s->flags, &s->keys, &s->found);
}
