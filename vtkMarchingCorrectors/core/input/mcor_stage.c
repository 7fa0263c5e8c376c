/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Copies the particles that a call needs from the caller's arrays to the device, in the device's
 * units and in input order. In a periodic box, copies their images, too. */

#include "mcor_stage.h"
#include "mcor_adaptive.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns the factor by which a particle's volume or mass is multiplied for the device: volumes are
 * then in cubes, masses are shares of the largest mass. Returns 1 if particles have neither volumes
 * nor masses; see the volume formulas of mcor_input. */
double mcor_size_scale(mcor_context* context, const mcor_input* input)
{
  const double cube = context->lattice.cube;
  const mcor_options* options = context->run.options;
  if (!mcor_needs_density(input))
  {
    /* In two dimensions, a volume is an area times `lift` times the particle's smoothing length,
     * see mcor_plane.h. */
    const double lift = context->space.flat
      ? mcor_kernel_of(options->sph_kernel)->plane_factor * options->h_scale
      : 1;
    return lift / (cube * cube * cube);
  }
  if (!mcor_is_given(&input->mass))
  {
    return 1;
  }
  const mcor_globals* globals = options->globals;
  return 1 / (globals ? globals->mass_max : mcor_largest(context, input, &input->mass, 0));
}

/* A chunk of particles and their periodic images. x: positions in fixed-point units; h: lengths in
 * unit L, without h_scale; size: volumes or masses in the device's unit. */
typedef struct mcor_stage_chunk
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], size[MCOR_CHUNK]; /* h: the kernel's length */
  uint8_t level[MCOR_CHUNK];                                /* of adaptive cubes */
  int32_t source[MCOR_CHUNK];
} mcor_stage_chunk;

/* Reads positions, kernel lengths and cube levels of a chunk of particles, whose count is set. */
MCOR_VECTOR_LOOPS static void mcor_read_stage_places(
  const mcor_staging* staging, int64_t first, mcor_stage_chunk* chunk)
{
  const mcor_context* context = staging->context;
  const mcor_lattice* lattice = &context->lattice;
  const mcor_reach_box* reach = staging->reach;
  const int count = chunk->count;
  double h[MCOR_CHUNK];
  mcor_read_positions(staging->input, first, count, chunk->x);
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a], scale = (double)lattice->step[a];
    double* x = chunk->x[a];
    for (int i = 0; i < count; ++i)
    {
      x[i] = (x[i] / lattice->edge[a] - origin) * scale;
    }
    for (int i = 0; i < count && reach && reach->period[a] > 0; ++i)
    {
      x[i] = mcor_wrap(reach, a, x[i]);
    }
  }
  mcor_read_smoothing_length(context, staging->input, first, count, h);
  mcor_widen_lengths(staging->input, first, count, h, chunk->h);
  memset(chunk->level, 0, (size_t)count);
  for (int i = 0; i < count && mcor_is_adaptive(lattice); ++i)
  {
    chunk->level[i] =
      (uint8_t)mcor_tree_level_of(h[i], context->measure.h_min, lattice->levels - 1);
  }
  for (int i = 0; i < count; ++i)
  {
    chunk->source[i] = (int32_t)(first + i);
  }
}

/* Lists in `images` which periodic images of particle i of a chunk are staged. The particle itself
 * counts as an image. Returns the number of staged images. */
static int mcor_images_of(
  const mcor_staging* staging, const mcor_stage_chunk* chunk, int i, mcor_images* images)
{
  *images = (mcor_images){ 0 };
  if (!mcor_is_used(staging->context, staging->input, chunk->source[i]))
  {
    return 0;
  }
  if (!staging->reach)
  {
    return 1;
  }
  double at[3];
  for (int a = 0; a < 3; ++a)
  {
    at[a] = chunk->x[a][i] * staging->reach->unit;
  }
  const double h = chunk->h[i] <= staging->h_max ? chunk->h[i] : staging->h_max;
  return mcor_list_images(
    staging->reach, at, mcor_reach_of(staging->reach, h, chunk->level[i]), images);
}

/* Marks the particles of [first, last) that may reach the box. Reads only coordinates along axes
 * without a period. A later test of all periodic images is exact; few marked particles fail it. */
static void mcor_mark_near(const mcor_staging* staging, int64_t first, int64_t last)
{
  const mcor_reach_box* reach = staging->reach;
  const mcor_lattice* lattice = &staging->context->lattice;
  mcor_places p;
  for (; mcor_read_places(staging->context, staging->input, first, last, &p) > 0; first += p.count)
  {
    uint8_t* near = staging->images + first;
    memset(near, 1, (size_t)p.count);
    for (int i = 0; i < p.count; ++i)
    {
      const int level = mcor_tree_level_of(p.h[i], staging->context->measure.h_min, reach->top);
      p.length[i] = mcor_reach_of(reach, p.length[i], level) * lattice->cube;
    }
    for (int a = 0; a < 3; ++a)
    {
      const double origin = (double)lattice->origin[a] * lattice->edge[a],
                   rounding = 1 + reach->radius;
      const double low = (reach->low[a] - rounding) * lattice->cube + origin,
                   high = (reach->high[a] + rounding) * lattice->cube + origin;
      for (int i = 0; i < p.count && reach->period[a] == 0; ++i)
      {
        near[i] &= (p.x[a][i] + p.length[i] >= low) & (p.x[a][i] - p.length[i] <= high);
      }
    }
  }
}

/* Returns the length of the next chunk to read, which begins at *begin; 0 at the end. Advances
 * *begin past chunks without a marked particle. */
static int mcor_next_chunk(const mcor_staging* staging, int64_t* begin, int64_t last)
{
  int count = mcor_chunk_of(last - *begin);
  while (count > 0 && staging->images && !memchr(staging->images + *begin, 1, (size_t)count))
  {
    *begin += count;
    count = mcor_chunk_of(last - *begin);
  }
  return count;
}

/* Counts the particles and periodic images that a slice stages. Unmarks the particles of which no
 * image is staged. */
static void mcor_count_staged(void* data, int slice, int64_t first, int64_t last)
{
  mcor_staging* staging = data;
  mcor_stage_chunk chunk;
  int64_t used = 0;
  for (int64_t i = first; i < last && !staging->reach; ++i)
  {
    used += mcor_is_used(staging->context, staging->input, i);
  }
  if (staging->reach)
  {
    mcor_mark_near(staging, first, last);
  }
  for (int64_t begin = first;
       staging->reach && (chunk.count = mcor_next_chunk(staging, &begin, last)) > 0;
       begin += chunk.count)
  {
    mcor_read_stage_places(staging, begin, &chunk);
    for (int i = 0; i < chunk.count; ++i)
    {
      mcor_images images;
      const int count =
        staging->images[begin + i] ? mcor_images_of(staging, &chunk, i, &images) : 0;
      staging->images[begin + i] = count > 0;
      used += count;
    }
  }
  staging->slices[slice].used = used;
}

int mcor_spared_bits(const mcor_context* context, double support, double cube, int level)
{
  const int digits = context->run.options->precision == MCOR_FLOAT64 ? DBL_MANT_DIG : FLT_MANT_DIG;
  int exponent;
  frexp(1.0001 * support / cube + ldexp(MCOR_POINT_EXTENT, level), &exponent);
  const int bits = exponent + context->lattice.fix_bits - digits;
  return bits > 0 ? bits : 0;
}

/* Writes element i of an array of fixed-point numbers. No position is below the lattice's origin, so
 * adding 1/2 and truncating rounds. */
static inline void mcor_put_fix(const mcor_context* context, void* array, int64_t i, double x)
{
  if (context->cl.fix_size == sizeof(int32_t))
  {
    ((int32_t*)array)[i] = (int32_t)(x + 0.5);
    return;
  }
  ((int64_t*)array)[i] = (int64_t)(x + 0.5);
}

/* Writes a chunk to the staging arrays, from element `to` on; changes the chunk. */
MCOR_VECTOR_LOOPS static void mcor_store_stage_chunk(
  const mcor_staging* staging, mcor_stage_chunk* chunk, const double* inv_h, int64_t to)
{
  const mcor_context* context = staging->context;
  const uint8_t* solid = staging->input->solid;
  const mcor_measure* m = &context->measure;
  const int count = chunk->count, top = context->lattice.levels - 1;
  const double h_scale = context->run.options->h_scale, cube = context->lattice.cube;
  const double reach = mcor_support_factor(context->run.options->sph_kernel) * h_scale;
  /* Rounds positions if evaluations do not use all their digits, see mcor_spared_bits. */
  const bool are_rounded = mcor_spared_bits(context, m->support_max, cube, top) > 0;
  double unit = 1;
  for (int i = 0; i < count && are_rounded; ++i)
  {
    const bool is_like_last =
      i > 0 && chunk->h[i] == chunk->h[i - 1] && chunk->level[i] == chunk->level[i - 1];
    unit = is_like_last
      ? unit
      : ldexp(1, mcor_spared_bits(context, chunk->h[i] * reach, cube, chunk->level[i]));
    for (int a = 0; a < 3; ++a)
    {
      chunk->x[a][i] = unit * floor(chunk->x[a][i] / unit + 0.5);
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    for (int i = 0; i < count; ++i)
    {
      mcor_put_fix(context, staging->x[a], to + i, chunk->x[a][i]);
    }
  }
  for (int i = 0; i < count && solid; ++i)
  {
    chunk->size[i] = solid[chunk->source[i]] ? -chunk->size[i] : chunk->size[i];
  }
  for (int i = 0; i < count && staging->size; ++i)
  {
    mcor_put_real(context, staging->size, to + i, chunk->size[i]);
  }
  if (staging->level)
  {
    uint8_t* level = (uint8_t*)staging->level + to;
    memset(level, 0, (size_t)count);
    for (int i = 0; i < count && m->support_min < m->support_max; ++i)
    {
      const double support = chunk->h[i] * reach;
      const int of = support < m->support_max ? ilogb(m->support_max / support) : 0;
      level[i] = (uint8_t)(of < 0 ? 0 : of >= MCOR_LEVEL_LIMIT ? MCOR_LEVEL_LIMIT - 1 : of);
    }
  }
  for (int i = 0; i < count && staging->inv_h; ++i)
  {
    mcor_put_real(context, staging->inv_h, to + i, inv_h[i]);
  }
  if (context->source)
  {
    memcpy(context->source + to, chunk->source, (size_t)count * sizeof chunk->source[0]);
  }
}

/* Returns the weight above which numbers on the device may become infinite. */
static double mcor_weight_limit(const mcor_context* context)
{
  return context->cl.real_size == sizeof(float) ? 1e30 : 1e290;
}

/* Stages a chunk from element *to on, and advances *to. If a weight in the chunk is too large, or a
 * particle is beyond the measured bounds, stages neither this chunk nor any later chunk. A particle
 * is beyond the bounds, on which all later steps rely, only if the caller's arrays have changed. */
static void mcor_stage_chunk_at(
  const mcor_staging* staging, mcor_stage_slice* slice, mcor_stage_chunk* chunk, int64_t* to)
{
  const mcor_context* context = staging->context;
  const mcor_lattice* lattice = &context->lattice;
  const double limit = mcor_weight_limit(context),
               scaled_cube = lattice->cube / context->run.options->h_scale;
  const int count = chunk->count, weighed = mcor_needs_density(staging->input) ? 0 : count;
  double inv_h[MCOR_CHUNK], weight[MCOR_CHUNK];
  bool changed = slice->changed || *to + count > slice->to + slice->used ||
    !mcor_is_all_within(chunk->h, count, DBL_TRUE_MIN, staging->h_max);
  for (int a = 0; a < 3 && !changed; ++a)
  {
    const double high = (double)lattice->last[a] * (double)lattice->step[a];
    changed = !mcor_is_all_within(chunk->x[a], count, 0, high);
  }
  slice->changed = changed;
  if (changed || slice->heavy >= 0 || count == 0)
  {
    return;
  }
  /* Usually all lengths of a chunk are the same, so one division is enough. */
  const double h = chunk->h[0], inverse = scaled_cube / h;
  const bool are_same = mcor_is_all_within(chunk->h, count, h, h);
  for (int i = 0; i < count; ++i)
  {
    inv_h[i] = are_same ? inverse : scaled_cube / chunk->h[i];
  }
  for (int i = 0; i < weighed; ++i)
  {
    weight[i] = chunk->size[i] * inv_h[i] * inv_h[i] * inv_h[i]; /* too large if the volume is huge */
  }
  const bool heavy = !mcor_is_all_within(weight, weighed, 0, limit);
  double unused = DBL_MAX;
  mcor_widen_range(weight, weighed, &unused, &slice->largest_weight);
  for (int i = 0; i < weighed && heavy && slice->heavy < 0; ++i)
  {
    slice->heavy = weight[i] <= limit ? -1 : chunk->source[i];
    slice->largest_weight = weight[i];
  }
  if (!heavy)
  {
    mcor_store_stage_chunk(staging, chunk, inv_h, *to);
    *to += count;
  }
}

/* Adds the images of a chunk's particles to `out`, and stages `out` whenever it is full. */
static void mcor_stage_images(const mcor_staging* staging, mcor_stage_slice* slice,
  const mcor_stage_chunk* chunk, mcor_stage_chunk* out, int64_t* to)
{
  mcor_images images = { 0 };
  double period[3] = { 0 };
  bool one = staging->images != NULL; /* without periods, each marked particle has one image */
  for (int a = 0; a < 3 && staging->reach; ++a)
  {
    period[a] = ldexp(staging->reach->period[a], staging->reach->fix_bits);
    one = one && staging->reach->period[a] == 0;
  }
  for (int i = 0; i < chunk->count; ++i)
  {
    const bool none = staging->images && !staging->images[chunk->source[i]];
    const int count = none ? 0 : one ? 1 : mcor_images_of(staging, chunk, i, &images);
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
        mcor_stage_chunk_at(staging, slice, out, to);
        out->count = 0;
      }
    }
  }
}

/* Whether sizes are areas: in two dimensions, volumes are areas unless they are computed. An area
 * times the smoothing length becomes a volume, see mcor_size_scale. */
static bool mcor_are_areas(const mcor_staging* staging)
{
  return staging->context->space.flat && !mcor_needs_density(staging->input);
}

static void mcor_stage_particles(void* data, int number, int64_t first, int64_t last)
{
  mcor_staging* staging = data;
  mcor_stage_slice* slice = &staging->slices[number];
  first += staging->begin;
  last += staging->begin;
  if (!staging->context->source) /* all particles are staged, once each */
  {
    slice->to = first;
    slice->used = last - first;
  }
  int64_t to = slice->to, begin = first;
  mcor_stage_chunk chunk, out;
  const bool are_areas = mcor_are_areas(staging);
  slice->heavy = -1;
  out.count = 0;
  while (
    slice->heavy < 0 && !slice->changed && (chunk.count = mcor_next_chunk(staging, &begin, last)) > 0)
  {
    const int read = chunk.count;
    mcor_read_stage_places(staging, begin, &chunk);
    mcor_read_size(staging->input, begin, read, chunk.size);
    for (int i = 0; i < read; ++i)
    {
      chunk.size[i] *= staging->size_scale;
      chunk.size[i] *= are_areas ? chunk.h[i] : 1;
    }
    if (staging->input->solid || staging->reach)
    {
      mcor_stage_images(staging, slice, &chunk, &out, &to);
    }
    else
    {
      mcor_stage_chunk_at(staging, slice, &chunk, &to);
    }
    begin += read;
  }
  mcor_stage_chunk_at(staging, slice, &out, &to);
  slice->changed = slice->changed || (slice->heavy < 0 && to != slice->to + slice->used);
}

/* Fills the arrays of which all elements are the same, see mcor_staging. */
static mcor_status mcor_fill_same(const mcor_staging* staging)
{
  mcor_context* context = staging->context;
  mcor_stage_data* s = &context->stage;
  const size_t count = (size_t)staging->count;
  const double h = context->measure.h_min;
  if (!staging->inv_h)
  {
    MCOR_TRY(mcor_fill_reals(
      context, &s->inv_h, context->lattice.cube / context->run.options->h_scale / h, count));
  }
  if (!staging->size)
  {
    double size;
    mcor_read_size(staging->input, 0, 1, &size);
    size *= staging->size_scale;
    MCOR_TRY(mcor_fill_reals(context, &s->size, size * (mcor_are_areas(staging) ? h : 1), count));
  }
  return staging->level ? MCOR_OK : mcor_fill(context, &s->level, 0, count);
}

/* Reserves room for the particles that are staged. */
static mcor_status mcor_make_stage_room(mcor_staging* staging)
{
  mcor_context* context = staging->context;
  mcor_stage_data* s = &context->stage;
  const bool chooses = staging->input->solid || staging->reach;
  int slices = 0;
  int64_t total = chooses ? 0 : staging->input->count;
  MCOR_TRY(mcor_parallel_run(context, chooses ? staging->input->count : 0, MCOR_HEAVY_GRAIN,
    mcor_count_staged, staging, &slices));
  for (int i = 0; i < slices; ++i)
  {
    staging->slices[i].to = total;
    total += staging->slices[i].used;
  }
  MCOR_FAIL_IF(total > MCOR_PARTICLE_LIMIT, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(IMAGES_TOO_MANY), (long long)total, MCOR_PARTICLE_LIMIT);
  const size_t count = (size_t)total, bytes = count * sizeof(int32_t);
  const size_t fix = count * context->cl.fix_size, real = count * context->cl.real_size;
  staging->count = (int)total;
  free(context->source);
  context->source = NULL;
  if (chooses)
  {
    context->source = malloc(bytes + 1);
    MCOR_TRY(mcor_allocated(context, context->source));
    mcor_use_large_pages(context->source, bytes);
  }
  mcor_buffer* const buffers[] = { &s->x, &s->y, &s->z, &s->inv_h, &s->size, &s->level };
  const mcor_mapping views[] = { { &s->x, fix, &staging->x[0] }, { &s->y, fix, &staging->x[1] },
    { &s->z, fix, &staging->x[2] }, { &s->inv_h, real, &staging->inv_h },
    { &s->size, real, &staging->size }, { &s->level, count, &staging->level } };
  const bool same[MCOR_STAGE_VIEWS] = { false, false, false, staging->one_inv_h, staging->one_size,
    context->measure.support_min == context->measure.support_max };
  memcpy(staging->views, views, sizeof views);
  staging->view_count = MCOR_STAGE_VIEWS;
  for (int i = 0; i < MCOR_STAGE_VIEWS && count > 0; ++i)
  {
    /* Buffers are padded as in the search grid, which may take over a buffer, see
     * mcor_move_particles. */
    const size_t padded = views[i].bytes + MCOR_PADDING * context->cl.real_size;
    MCOR_TRY(mcor_reserve(context, buffers[i], padded));
    if (!context->cl.is_apart || !same[i])
    {
      MCOR_TRY(mcor_map(context, buffers[i], views[i].bytes, true, views[i].data));
    }
  }
  return context->cl.is_apart && count > 0 ? mcor_fill_same(staging) : MCOR_OK;
}

/* Fails if particles could not be staged. */
static mcor_status mcor_check_staged(const mcor_staging* staging, int slices)
{
  mcor_context* context = staging->context;
  for (int i = 0; i < slices; ++i)
  {
    const mcor_stage_slice* slice = &staging->slices[i];
    MCOR_FAIL_IF(slice->changed, context, MCOR_INVALID_DATA, MCOR_SAY(ARRAYS_CHANGED),
      context->run.options->globals ? ", or options.globals was measured over other particles"
                                    : "");
    MCOR_FAIL_IF(slice->heavy >= 0, context, MCOR_INVALID_DATA, MCOR_SAY(VOLUME_TOO_LARGE),
      (long long)slice->heavy, slice->largest_weight,
      context->cl.real_size == sizeof(float) ? "single" : "double");
    context->largest_weight = fmax(context->largest_weight, slice->largest_weight);
  }
  return MCOR_OK;
}

/* How many particles are staged at a time for a device with memory of its own. Meanwhile the
 * particles staged before are copied. */
#define MCOR_STAGE_PORTION (1 << 18)

static mcor_status mcor_stage_all(mcor_staging* staging)
{
  mcor_context* context = staging->context;
  const mcor_options* options = context->run.options;
  MCOR_TRY(mcor_make_stage_room(staging));
  /* A computed volume is at most 100 h^3 / norm, see MCOR_LEAST_DENSITY. */
  context->largest_weight =
    mcor_needs_density(staging->input) ? 100 * pow(options->h_scale, -3) : 0;
  MCOR_FAIL_IF(!(context->largest_weight < mcor_weight_limit(context)), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(H_SCALE_TOO_SMALL), options->h_scale);
  const int64_t all = staging->count > 0 ? staging->input->count : 0;
  const bool sends = context->cl.is_apart && !context->source;
  for (int64_t end = 0; staging->begin < all; staging->begin = end)
  {
    int slices;
    end = sends && all - staging->begin > MCOR_STAGE_PORTION ? staging->begin + MCOR_STAGE_PORTION
                                                             : all;
    MCOR_TRY(mcor_parallel_run(context, end - staging->begin, MCOR_HEAVY_GRAIN,
      mcor_stage_particles, staging, &slices));
    MCOR_TRY(mcor_check_staged(staging, slices));
    for (int v = 0; sends && v < MCOR_STAGE_VIEWS - 1; ++v) /* levels are renumbered later */
    {
      const size_t width = staging->views[v].bytes / (size_t)staging->count;
      MCOR_TRY(mcor_send(context, *staging->views[v].data, (size_t)end * width));
    }
  }
  return MCOR_OK;
}

static void mcor_find_reaching(void* data, int slice, int64_t first, int64_t last)
{
  mcor_staging* staging = data;
  mcor_stage_chunk chunk;
  double farthest = 0;
  for (; (chunk.count = mcor_chunk_of(last - first)) > 0; first += chunk.count)
  {
    mcor_read_stage_places(staging, first, &chunk);
    for (int i = 0; i < chunk.count; ++i)
    {
      const double support = mcor_reach_of(staging->reach, chunk.h[i], chunk.level[i]);
      mcor_images images;
      if (support > farthest && mcor_images_of(staging, &chunk, i, &images) > 0)
      {
        farthest = support;
      }
    }
  }
  staging->slices[slice].farthest = farthest;
}

mcor_status mcor_stage(mcor_staging* staging)
{
  mcor_context* context = staging->context;
  const mcor_options* options = context->run.options;
  const mcor_input* input = staging->input;
  const mcor_measure* m = &context->measure;
  const bool one_volume = !input->volume.data && !input->mass.data && !input->density.data;
  mcor_reach_box reach;
  /* If there are solids, it is not known whether all lengths and sizes are the same: solids'
   * lengths are not measured, and solids' sizes are negative. */
  staging->one_inv_h = !input->solid && !mcor_is_given(&input->widening) && m->h_min == m->h_max;
  staging->one_size = !input->solid && one_volume && (staging->one_inv_h || !context->space.flat);
  staging->size_scale = mcor_size_scale(context, input);
  staging->h_max =
    1.000001 * m->support_max / options->h_scale / mcor_support_factor(options->sph_kernel);
  if (mcor_find_reach(context, &reach))
  {
    staging->reach = &reach;
    const double widest = context->run.widest;
    const bool computes = mcor_needs_density(input);
    const bool widens = mcor_reach_around(options, computes, widest, 1, 2) > 0;
    const int slices = widens
      ? mcor_parallel_for(context, input->count, MCOR_HEAVY_GRAIN, mcor_find_reaching, staging)
      : 0;
    double farthest = 0;
    for (int s = 0; s < slices; ++s)
    {
      farthest = fmax(farthest, staging->slices[s].farthest);
    }
    reach.radius = mcor_reach_around(options, computes, widest, farthest, 2);
    staging->images = malloc((size_t)input->count + 1);
    MCOR_TRY(mcor_allocated(context, staging->images));
  }
  const mcor_status status = mcor_stage_all(staging);
  free(staging->images);
  return status;
}
