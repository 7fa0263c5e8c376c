/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* From the caller's arrays to the device: particles and values, in input order. */

#include "mcor_stage.h"
#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_VIEWS 5

/* A buffer of the stage, and the host's view of it. */
typedef struct mcor_view
{
  mcor_buffer* buffer;
  void** data;
  size_t element; /* bytes per particle */
} mcor_view;

static void mcor_list_views(
  mcor_context* context, mcor_staging* staging, mcor_view views[MCOR_VIEWS])
{
  mcor_stage_data* s = &context->stage;
  const size_t fix = context->cl.fix_size, real = context->cl.real_size;
  views[0] = (mcor_view){ &s->xyz, &staging->xyz, 3 * fix };
  views[1] = (mcor_view){ &s->inv_h, &staging->inv_h, real };
  views[2] = (mcor_view){ &s->size, &staging->size, real };
  views[3] = (mcor_view){ &s->solid, &staging->solid, 1 };
  views[4] = (mcor_view){ &s->level, &staging->level, 1 };
}

static mcor_status mcor_map_staging(mcor_context* context, int64_t count, mcor_staging* staging)
{
  mcor_view views[MCOR_VIEWS];
  mcor_list_views(context, staging, views);
  for (int i = 0; i < MCOR_VIEWS; ++i)
  {
    const size_t bytes = (size_t)count * views[i].element;
    MCOR_TRY(mcor_reserve(context, views[i].buffer, bytes));
    MCOR_TRY(mcor_map(context, views[i].buffer, bytes, true, views[i].data));
  }
  return MCOR_OK;
}

mcor_status mcor_unmap_staging(mcor_context* context, mcor_staging* staging)
{
  mcor_view views[MCOR_VIEWS];
  mcor_status status = MCOR_OK;
  mcor_list_views(context, staging, views);
  for (int i = 0; i < MCOR_VIEWS; ++i)
  {
    const mcor_status unmapped = mcor_unmap(context, views[i].buffer, views[i].data);
    status = status == MCOR_OK ? unmapped : status;
  }
  return status;
}

static void mcor_store_reals(
  const mcor_context* context, void* array, int64_t first, const double* values, int count)
{
  if (context->cl.real_size == sizeof(float))
  {
    float* to = (float*)array + first;
    for (int i = 0; i < count; ++i)
    {
      to[i] = (float)values[i];
    }
  }
  else
  {
    memcpy((double*)array + first, values, (size_t)count * sizeof *values);
  }
}

/* One of three coordinates. Positions are never below the lattice's origin, so adding 1/2 and
 * truncating rounds them. */
static void mcor_store_fixed(const mcor_context* context, void* array, int64_t first, int axis,
  const double* values, int count)
{
  if (context->cl.fix_size == sizeof(int32_t))
  {
    int32_t* to = (int32_t*)array + 3 * first + axis;
    for (int i = 0; i < count; ++i)
    {
      to[3 * i] = (int32_t)(values[i] + 0.5);
    }
  }
  else
  {
    int64_t* to = (int64_t*)array + 3 * first + axis;
    for (int i = 0; i < count; ++i)
    {
      to[3 * i] = (int64_t)(values[i] + 0.5);
    }
  }
}

/* Which of the volume formulas of mcor_input holds, and each particle's share in it: the volume in
 * cubes, the mass over the largest one, or 1. */
double mcor_size_scale(const mcor_context* context, const mcor_input* input)
{
  const double cube = context->lattice.cube;
  if (input->has_volume || (input->has_mass && input->has_density))
  {
    return 1 / (cube * cube * cube);
  }
  if (!input->has_mass)
  {
    return 1;
  }
  const mcor_globals* globals = context->options->globals;
  return 1 / (globals ? globals->mass_max : mcor_largest(&input->mass, NULL, input->count, 0));
}

static void mcor_read_size(const mcor_input* input, int64_t first, int count, double* out)
{
  static const mcor_array one = { .constant = 1 };
  mcor_read_array(input->has_volume ? &input->volume
      : input->has_mass             ? &input->mass
                                    : &one,
    first, count, 0, out);
  if (!input->has_volume && input->has_mass && input->has_density)
  {
    double density[MCOR_CHUNK];
    mcor_read_array(&input->density, first, count, 0, density);
    for (int i = 0; i < count; ++i)
    {
      out[i] /= density[i];
    }
  }
}

static int mcor_level_of(double support_max, double support)
{
  const int level = support < support_max ? ilogb(support_max / support) : 0;
  return level < 0 ? 0 : level >= MCOR_LEVEL_LIMIT ? MCOR_LEVEL_LIMIT - 1 : level;
}

/* Particles of a chunk in the staging arrays' units. */
typedef struct mcor_stage_chunk
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], size[MCOR_CHUNK];
  int32_t source[MCOR_CHUNK];
} mcor_stage_chunk;

/* Where they are, and how large. reach: NULL, or what tells of a period. */
static void mcor_read_stage_places(const mcor_context* context, const mcor_input* input,
  int64_t first, const mcor_reach_box* reach, mcor_stage_chunk* chunk)
{
  const mcor_lattice* lattice = &context->lattice;
  const double scale = ldexp(1, lattice->fix_bits);
  const int count = chunk->count;
  mcor_array positions = input->positions;
  positions.components = 3;
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a];
    double* x = chunk->x[a];
    mcor_read_array(&positions, first, count, a, x);
    for (int i = 0; i < count; ++i)
    {
      x[i] = (x[i] / lattice->cube - origin) * scale;
    }
    for (int i = 0; i < count && reach && reach->period[a] > 0; ++i)
    {
      x[i] = mcor_wrap(reach, a, x[i]);
    }
  }
  mcor_read_smoothing_length(context, input, first, count, chunk->h);
  for (int i = 0; i < count; ++i)
  {
    chunk->source[i] = (int32_t)(first + i);
  }
}

static void mcor_read_stage_chunk(const mcor_context* context, const mcor_input* input,
  int64_t first, const mcor_staging* staging, const mcor_reach_box* reach, mcor_stage_chunk* chunk)
{
  mcor_read_stage_places(context, input, first, reach, chunk);
  mcor_read_size(input, first, chunk->count, chunk->size);
  for (int i = 0; i < chunk->count; ++i)
  {
    chunk->size[i] *= staging->size_scale;
  }
}

/* A weight beyond would be infinite on the device. */
static double mcor_weight_limit(const mcor_context* context)
{
  return context->cl.real_size == sizeof(float) ? 1e30 : 1e290;
}

/* Weight of particle i of a chunk on the device: large where the volume is huge against the smoothing
 * length. */
static double mcor_stage_weight(const mcor_context* context, const mcor_stage_chunk* chunk, int i)
{
  const double inv_h = context->lattice.cube / context->options->h_scale / chunk->h[i];
  return chunk->size[i] * inv_h * inv_h * inv_h;
}

/* Input index of the first particle of a chunk whose weight is too large; -1 if there is none. The
 * largest one is kept. */
static int64_t mcor_find_heavy(const mcor_context* context, const mcor_input* input,
  const mcor_stage_chunk* chunk, double* largest_weight)
{
  const double limit = mcor_weight_limit(context);
  for (int i = 0; i < chunk->count && !mcor_needs_density(input); ++i)
  {
    const double weight = mcor_stage_weight(context, chunk, i);
    if (!(weight < limit))
    {
      return chunk->source[i];
    }
    *largest_weight = weight > *largest_weight ? weight : *largest_weight;
  }
  return -1;
}

typedef struct mcor_stage_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_staging* staging;
  const mcor_reach_box* reach; /* NULL: all particles are needed */
  uint8_t* images;             /* of each particle, whether any is staged; NULL without reach */
  int64_t used[MCOR_SLICES];   /* particles in each slice */
  int64_t to[MCOR_SLICES];     /* where the first of them goes */
  int64_t heavy[MCOR_SLICES];  /* see mcor_find_heavy */
  double largest_weight[MCOR_SLICES];
} mcor_stage_job;

/* The images of particle i of a chunk that are staged. */
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
  return mcor_list_images(job->reach, at, mcor_reach_of(job->reach, chunk->h[i]), images);
}

/* How many digits shorter than fixed-point numbers the positions of particles with a support are, see
 * MCOR_POINT_EXTENT. */
static int mcor_spared_bits(const mcor_context* context, double support, int level)
{
  const int digits = context->cl.real_size == sizeof(float) ? FLT_MANT_DIG : DBL_MANT_DIG;
  int exponent;
  frexp(1.0001 * support / context->lattice.cube + ldexp(MCOR_POINT_EXTENT, level), &exponent);
  const int bits = exponent + context->lattice.fix_bits - digits;
  return bits > 0 ? bits : 0;
}

/* Rounds positions to what evaluations make of them. reach: of a support radius in smoothing
 * lengths. */
static void mcor_round_positions(const mcor_context* context, double reach, mcor_stage_chunk* chunk)
{
  for (int i = 0; i < chunk->count; ++i)
  {
    const int level = mcor_tree_level_of(chunk->h[i], context->measure.h_min, context->lattice.top);
    const double unit = ldexp(1, mcor_spared_bits(context, chunk->h[i] * reach, level));
    for (int a = 0; a < 3; ++a)
    {
      chunk->x[a][i] = unit * floor(chunk->x[a][i] / unit + 0.5);
    }
  }
}

/* To element `to` of the staging arrays. */
static void mcor_store_stage_chunk(const mcor_context* context, const mcor_input* input,
  mcor_stage_chunk* chunk, const mcor_staging* staging, int64_t to)
{
  const mcor_measure* m = &context->measure;
  const double h_scale = context->options->h_scale, scaled_cube = context->lattice.cube / h_scale;
  const double reach = mcor_support_factor(context->options->sph_kernel) * h_scale;
  uint8_t *solid = (uint8_t*)staging->solid + to, *level = (uint8_t*)staging->level + to;
  if (mcor_spared_bits(context, m->support_max, context->lattice.top) > 0)
  {
    mcor_round_positions(context, reach, chunk);
  }
  for (int a = 0; a < 3; ++a)
  {
    mcor_store_fixed(context, staging->xyz, to, a, chunk->x[a], chunk->count);
  }
  mcor_store_reals(context, staging->size, to, chunk->size, chunk->count);
  for (int i = 0; i < chunk->count; ++i)
  {
    solid[i] = input->solid && input->solid[chunk->source[i]];
    level[i] = m->support_min < m->support_max
      ? (uint8_t)mcor_level_of(m->support_max, chunk->h[i] * reach)
      : 0;
    chunk->h[i] = scaled_cube / chunk->h[i];
  }
  mcor_store_reals(context, staging->inv_h, to, chunk->h, chunk->count);
  memcpy(context->source + to, chunk->source, (size_t)chunk->count * sizeof chunk->source[0]);
}

/* Marks the particles of a chunk that cannot reach anything, by one look at each coordinate: most of
 * those that the exact look at images would find. */
static void mcor_find_far(const mcor_reach_box* reach, const mcor_stage_chunk* chunk, uint8_t* far)
{
  memset(far, 0, (size_t)chunk->count);
  for (int a = 0; a < 3; ++a)
  {
    const double low = reach->low[a] - reach->radius - 1, high = reach->high[a] + reach->radius + 1;
    for (int i = 0; i < chunk->count && reach->period[a] == 0; ++i)
    {
      const double at = chunk->x[a][i] * reach->unit, support = chunk->h[i] * reach->support;
      far[i] |= (at + support < low) | (at - support > high);
    }
  }
}

static void mcor_count_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_stage_job* job = data;
  int64_t used = 0;
  mcor_stage_chunk chunk;
  uint8_t far[MCOR_CHUNK];
  for (int64_t begin = first; begin < last && job->reach; begin += MCOR_CHUNK)
  {
    chunk.count = last - begin < MCOR_CHUNK ? (int)(last - begin) : MCOR_CHUNK;
    mcor_read_stage_places(job->context, job->input, begin, job->reach, &chunk);
    mcor_find_far(job->reach, &chunk, far);
    for (int i = 0; i < chunk.count; ++i)
    {
      mcor_images images;
      const int count = far[i] ? 0 : mcor_images_of(job, &chunk, i, &images);
      job->images[begin + i] = count > 0;
      used += count;
    }
  }
  for (int64_t i = first; i < last && !job->reach; ++i)
  {
    used += mcor_is_used(job->context, job->input, i);
  }
  job->used[slice] = used;
}

/* Stages a chunk from element *to on, which moves to where the next one goes; not after a particle
 * that is too heavy. */
static void mcor_stage_chunk_at(
  mcor_stage_job* job, int slice, mcor_stage_chunk* chunk, int64_t* to)
{
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

/* The same for the images that are staged of a chunk's particles. */
static void mcor_stage_images(
  mcor_stage_job* job, int slice, const mcor_stage_chunk* chunk, int64_t* to)
{
  mcor_stage_chunk out;
  mcor_images images = { 0 };
  double period[3] = { 0 };
  for (int a = 0; a < 3 && job->reach; ++a)
  {
    period[a] = ldexp(job->reach->period[a], job->reach->fix_bits);
  }
  out.count = 0;
  for (int i = 0; i < chunk->count; ++i)
  {
    const bool none = job->images && !job->images[chunk->source[i]];
    const int count = none ? 0 : mcor_images_of(job, chunk, i, &images);
    int k[3] = { images.first[0], images.first[1], images.first[2] };
    for (int n = 0; n < count; ++n)
    {
      for (int a = 0; a < 3; ++a)
      {
        out.x[a][out.count] = chunk->x[a][i] + k[a] * period[a];
      }
      out.h[out.count] = chunk->h[i];
      out.size[out.count] = chunk->size[i];
      out.source[out.count++] = chunk->source[i];
      for (int a = 0; a < 3 && ++k[a] > images.last[a]; ++a)
      {
        k[a] = images.first[a];
      }
      if (out.count == MCOR_CHUNK)
      {
        mcor_stage_chunk_at(job, slice, &out, to);
        out.count = 0;
      }
    }
  }
  mcor_stage_chunk_at(job, slice, &out, to);
}

/* Particles that are read along with those that are staged rather than jumped over. */
#define MCOR_STAGE_GAP 8

/* The next run of particles to be read at once, from *begin on; returns its length, at the end 0. */
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

static void mcor_stage_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_stage_job* job = data;
  int64_t to = job->to[slice];
  mcor_stage_chunk chunk;
  job->heavy[slice] = -1;
  int64_t begin = first;
  while (job->heavy[slice] < 0 && (chunk.count = mcor_next_run(job, &begin, last)) > 0)
  {
    const int read = chunk.count;
    mcor_read_stage_chunk(job->context, job->input, begin, job->staging, job->reach, &chunk);
    if (job->input->solid || job->reach)
    {
      mcor_stage_images(job, slice, &chunk, &to);
    }
    else
    {
      mcor_stage_chunk_at(job, slice, &chunk, &to);
    }
    begin += read;
  }
}

static mcor_status mcor_refuse_heavy(
  mcor_context* context, const mcor_input* input, const mcor_staging* staging, int64_t i)
{
  mcor_stage_chunk chunk = { .count = 1 };
  mcor_read_stage_chunk(context, input, i, staging, NULL, &chunk);
  return mcor_fail(context, MCOR_INVALID_DATA,
    "The volume of particle %lld is %.3g times the cube of its smoothing length, too much for %s "
    "precision. Correct it or remove such particles.",
    (long long)i, mcor_stage_weight(context, &chunk, 0),
    context->cl.real_size == sizeof(float) ? "single" : "double");
}

/* Room for the particles that the job stages. */
static mcor_status mcor_make_room(mcor_context* context, mcor_stage_job* job, mcor_staging* staging)
{
  const int64_t count = job->input->count;
  const int slices = mcor_parallel_for(count, MCOR_HEAVY_GRAIN, mcor_count_slice, job);
  int64_t total = 0;
  for (int s = 0; s < slices; ++s)
  {
    job->to[s] = total;
    total += job->used[s];
  }
  MCOR_RETURN_IF(total > MCOR_PARTICLE_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    "With their images there are %lld particles; %d is the limit.", (long long)total,
    MCOR_PARTICLE_LIMIT);
  staging->count = (int)total;
  const size_t bytes = (size_t)staging->count * sizeof(int32_t);
  free(context->source);
  context->source = malloc(bytes + 1);
  MCOR_RETURN_IF(!context->source, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %d particles could not be allocated.", staging->count);
  mcor_use_large_pages(context->source, bytes);
  return staging->count > 0 ? mcor_map_staging(context, staging->count, staging) : MCOR_OK;
}

static mcor_status mcor_stage_particles(
  mcor_context* context, mcor_stage_job* job, mcor_staging* staging)
{
  const mcor_input* input = job->input;
  MCOR_TRY(mcor_make_room(context, job, staging));
  const int slices = staging->count > 0
    ? mcor_parallel_for(input->count, MCOR_HEAVY_GRAIN, mcor_stage_slice, job)
    : 0;
  /* A computed volume is at most 100 h^3 / norm, see MCOR_LEAST_DENSITY. */
  context->largest_weight =
    mcor_needs_density(input) ? 100 * pow(context->options->h_scale, -3) : 0;
  MCOR_RETURN_IF(!(context->largest_weight < mcor_weight_limit(context)), context,
    MCOR_INVALID_ARGUMENT,
    "The h scale factor is %g, too little for computed volumes. Give volumes, or choose a larger "
    "one.",
    context->options->h_scale);
  for (int s = 0; s < slices; ++s)
  {
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
  mcor_reach_box reach;
  if (mcor_find_reach(context, input, &reach))
  {
    job.reach = &reach;
    job.images = malloc((size_t)input->count);
    MCOR_RETURN_IF(!job.images, context, MCOR_OUT_OF_CAPACITY,
      "Host memory for %lld particles could not be allocated.", (long long)input->count);
  }
  const mcor_status status = mcor_stage_particles(context, &job, staging);
  free(job.images);
  return status;
}

typedef struct mcor_value_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_array* array;
  int component;
  double shift, scale;
  void* values;
} mcor_value_job;

static void mcor_store_value_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_value_job* job = data;
  const mcor_input* input = job->input;
  const int32_t* source = job->context->source;
  const double shift = job->shift, scale = job->scale;
  int n = 0;
  for (int64_t begin = first; begin < last; begin += n)
  {
    const int64_t from = source[begin], rest = input->count - from;
    const int count = rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
    double chunk[MCOR_CHUNK], used[MCOR_CHUNK];
    job->array ? mcor_read_array(job->array, from, count, job->component, chunk)
               : mcor_read_scalar(input, from, count, chunk);
    /* Images of a particle stand side by side. */
    for (n = 0; n < MCOR_CHUNK && begin + n < last && source[begin + n] < from + count; ++n)
    {
      used[n] = (chunk[source[begin + n] - from] - shift) * scale;
    }
    /* Those of solids play no part, whatever they are. */
    for (int i = 0; i < n && input->solid; ++i)
    {
      used[i] = input->solid[source[begin + i]] ? 0 : used[i];
    }
    mcor_store_reals(job->context, job->values, begin, used, n);
  }
  (void)slice;
}

/* One component of an array, or the scalar where `array` is NULL, less `shift`, times `scale`: from
 * the caller's order to the sorted one, to row `to_row`, one value per particle long. */
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, mcor_buffer* to, int to_row)
{
  const mcor_grid* grid = &context->grid;
  const size_t bytes = (size_t)grid->count * context->cl.real_size;
  mcor_buffer* raw = &context->stage.values;
  mcor_value_job job = { context, input, array, component, shift, scale, NULL };
  MCOR_TRY(mcor_reserve(context, raw, bytes));
  MCOR_TRY(mcor_map(context, raw, bytes, true, &job.values));
  mcor_parallel_for(grid->count, MCOR_LIGHT_GRAIN, mcor_store_value_slice, &job);
  MCOR_TRY(mcor_unmap(context, raw, &job.values));
  return MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->order), MCOR_BUFFER(raw), MCOR_BUFFER(to),
    MCOR_INT(to_row));
}

void mcor_release_stage(mcor_context* context)
{
  mcor_stage_data* s = &context->stage;
  MCOR_RELEASE(context, &s->xyz, &s->inv_h, &s->size, &s->solid, &s->level, &s->mass, &s->density,
    &s->values, &s->flags, &s->keys, &s->found);
}
