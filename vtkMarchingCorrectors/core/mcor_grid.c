/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Search grid [III-A]: levels, counting sort, volumes; and the scalar in sorted order. */

#include "mcor_input.h"
#include "mcor_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The paper's cells are as large as the support. Smaller ones fit the round reach of a query better
 * and need more rows: 2 took as long, 3 longer. */
#define MCOR_CELLS_PER_SUPPORT 1

/* The input in the device's form, in input order; solids that are not used left out. Arrays are views
 * of the scratch buffers named like them. */
typedef struct mcor_staging
{
  int count;
  void *xyz, *inv_h, *size; /* fix [count][3], real [count]; size: volume, mass, or 1 */
  double size_scale; /* see mcor_size_scale */
  void *solid, *level; /* uint8_t */
} mcor_staging;

enum
{
  MCOR_STAGE_XYZ, /* scratch buffers */
  MCOR_STAGE_INV_H,
  MCOR_STAGE_SIZE,
  MCOR_STAGE_SOLID,
  MCOR_STAGE_LEVEL,
  MCOR_STAGE_COUNT
};

static mcor_status mcor_map_staging(mcor_context* context, int64_t count, mcor_staging* staging)
{
  const size_t n = (size_t)count, real = context->cl.real_size;
  const size_t bytes[MCOR_STAGE_COUNT] = { n * 3 * context->cl.fix_size, n * real, n * real, n, n };
  void** const views[MCOR_STAGE_COUNT] = { &staging->xyz, &staging->inv_h, &staging->size,
    &staging->solid, &staging->level };
  for (int i = 0; i < MCOR_STAGE_COUNT; ++i)
  {
    MCOR_TRY(mcor_reserve(context, &context->scratch[i], bytes[i]));
    MCOR_TRY(mcor_map(context, &context->scratch[i], bytes[i], true, views[i]));
  }
  return MCOR_OK;
}

static mcor_status mcor_unmap_staging(mcor_context* context, mcor_staging* staging)
{
  void** const views[MCOR_STAGE_COUNT] = { &staging->xyz, &staging->inv_h, &staging->size,
    &staging->solid, &staging->level };
  mcor_status status = MCOR_OK;
  for (int i = 0; i < MCOR_STAGE_COUNT; ++i)
  {
    const mcor_status unmapped = mcor_unmap(context, &context->scratch[i], views[i]);
    status = status == MCOR_OK ? unmapped : status;
  }
  return status;
}

static void mcor_put_reals(
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
static void mcor_put_fixed(const mcor_context* context, void* array, int64_t first, int axis,
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
static double mcor_size_scale(const mcor_context* context, const mcor_input* input)
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
  double largest = 0;
  for (int64_t i = 0; i < input->count; ++i)
  {
    largest = fmax(largest, mcor_array_at(&input->mass, i, 0));
  }
  return 1 / largest;
}

static bool mcor_needs_density(const mcor_input* input)
{
  return !input->has_volume && !(input->has_mass && input->has_density);
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

static void mcor_read_stage_chunk(mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_staging* staging, mcor_stage_chunk* chunk)
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
  }
  mcor_read_smoothing_length(context, input, first, count, chunk->h);
  mcor_read_size(input, first, count, chunk->size);
  for (int i = 0; i < count; ++i)
  {
    chunk->size[i] *= staging->size_scale;
    chunk->source[i] = (int32_t)(first + i);
  }
}

/* A volume that is huge against the smoothing length would make infinite weights on the device. */
static mcor_status mcor_check_sizes(
  mcor_context* context, const mcor_input* input, const mcor_stage_chunk* chunk)
{
  const bool single = context->cl.real_size == sizeof(float);
  const double limit = single ? 1e30 : 1e290;
  const double scaled_cube = context->lattice.cube / context->options->h_scale;
  for (int i = 0; i < chunk->count && !mcor_needs_density(input); ++i)
  {
    const double inv_h = scaled_cube / chunk->h[i];
    MCOR_RETURN_IF(!(chunk->size[i] * inv_h * inv_h * inv_h < limit), context, MCOR_INVALID_DATA,
      "The volume of particle %lld is %.3g times the cube of its smoothing length, too much for %s "
      "precision. Correct it or remove such particles.",
      (long long)chunk->source[i], chunk->size[i] * inv_h * inv_h * inv_h,
      single ? "single" : "double");
  }
  return MCOR_OK;
}

/* Drops particles that are not used. */
static void mcor_pack_stage_chunk(
  const mcor_context* context, const mcor_input* input, mcor_stage_chunk* chunk)
{
  int to = 0;
  for (int i = 0; i < chunk->count; ++i)
  {
    if (mcor_is_used(context, input, chunk->source[i]))
    {
      for (int a = 0; a < 3; ++a)
      {
        chunk->x[a][to] = chunk->x[a][i];
      }
      chunk->h[to] = chunk->h[i];
      chunk->size[to] = chunk->size[i];
      chunk->source[to++] = chunk->source[i];
    }
  }
  chunk->count = to;
}

static void mcor_put_stage_chunk(
  mcor_context* context, const mcor_input* input, mcor_stage_chunk* chunk, mcor_staging* staging)
{
  const mcor_measure* m = &context->measure;
  const double h_scale = context->options->h_scale, scaled_cube = context->lattice.cube / h_scale;
  const double reach = mcor_support_factor(context->options->sph_kernel) * h_scale;
  const int to = staging->count;
  uint8_t *solid = (uint8_t*)staging->solid + to, *level = (uint8_t*)staging->level + to;
  for (int a = 0; a < 3; ++a)
  {
    mcor_put_fixed(context, staging->xyz, to, a, chunk->x[a], chunk->count);
  }
  mcor_put_reals(context, staging->size, to, chunk->size, chunk->count);
  for (int i = 0; i < chunk->count; ++i)
  {
    solid[i] = input->solid && input->solid[chunk->source[i]];
    level[i] = m->support_min < m->support_max
      ? (uint8_t)mcor_level_of(m->support_max, chunk->h[i] * reach)
      : 0;
    chunk->h[i] = scaled_cube / chunk->h[i];
  }
  mcor_put_reals(context, staging->inv_h, to, chunk->h, chunk->count);
  memcpy(context->source + to, chunk->source, (size_t)chunk->count * sizeof chunk->source[0]);
  staging->count += chunk->count;
}

static mcor_status mcor_stage(mcor_context* context, const mcor_input* input, mcor_staging* staging)
{
  staging->size_scale = mcor_size_scale(context, input);
  free(context->source);
  context->source = malloc((size_t)input->count * sizeof(int32_t));
  MCOR_RETURN_IF(!context->source, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld particles could not be allocated.", (long long)input->count);
  MCOR_TRY(mcor_map_staging(context, input->count, staging));
  mcor_stage_chunk chunk;
  for (int64_t first = 0; first < input->count; first += MCOR_CHUNK)
  {
    const int64_t rest = input->count - first;
    chunk.count = rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
    mcor_read_stage_chunk(context, input, first, staging, &chunk);
    if (input->solid)
    {
      mcor_pack_stage_chunk(context, input, &chunk);
    }
    MCOR_TRY(mcor_check_sizes(context, input, &chunk));
    mcor_put_stage_chunk(context, input, &chunk, staging);
  }
  return MCOR_OK;
}

/* One level for each factor of 2 of support radius that occurs; renumbers staging->level. Returns
 * the number of search cells of all levels. */
static uint64_t mcor_make_levels(mcor_context* context, mcor_staging* staging)
{
  mcor_grid* grid = &context->grid;
  const mcor_lattice* lattice = &context->lattice;
  uint8_t* particle_level = staging->level;
  bool occurs[MCOR_LEVEL_LIMIT] = { false };
  uint8_t number[MCOR_LEVEL_LIMIT];
  for (int i = 0; i < staging->count; ++i)
  {
    occurs[particle_level[i]] = true;
  }
  uint64_t base = 0;
  grid->level_count = 0;
  for (int l = 0; l < MCOR_LEVEL_LIMIT; ++l)
  {
    if (!occurs[l])
    {
      continue;
    }
    number[l] = (uint8_t)grid->level_count;
    mcor_level* level = &grid->levels[grid->level_count++];
    /* A little more than the support: rounding, here and on the device, must not lose a particle. */
    const double support = context->measure.support_max / lattice->cube * ldexp(1.0001, -l);
    level->base = base;
    level->support = (cl_float)support;
    const double cell = support / MCOR_CELLS_PER_SUPPORT;
    level->inv_cell = (cl_float)(1 / ldexp(cell, lattice->fix_bits));
    level->unused = 0;
    uint64_t cells = 1;
    for (int a = 0; a < 3; ++a)
    {
      level->cells[a] = (cl_int)((double)lattice->last[a] / cell) + 2;
      cells *= (uint64_t)level->cells[a];
    }
    base += cells;
  }
  for (int i = 0; i < staging->count; ++i)
  {
    particle_level[i] = number[particle_level[i]];
  }
  return base;
}

static mcor_status mcor_reserve_particles(mcor_context* context, int count)
{
  mcor_grid* grid = &context->grid;
  const size_t n = (size_t)count + MCOR_PADDING;
  mcor_buffer* fixes[] = { &grid->px, &grid->py, &grid->pz };
  mcor_buffer* reals[] = { &grid->inv_h, &grid->trim_weight, &grid->value };
  for (int i = 0; i < 3; ++i)
  {
    /* Zeroed, as vector loads read the padding. */
    MCOR_TRY(mcor_fill(context, fixes[i], 0, n * context->cl.fix_size));
    MCOR_TRY(mcor_fill(context, reals[i], 0, n * context->cl.real_size));
  }
  return grid->has_solids ? mcor_fill(context, &grid->fluid_weight, 0, n * context->cl.real_size)
                          : MCOR_OK;
}

/* Sorts by search cell, then within a cell, and moves the particles into that order. */
static mcor_status mcor_sort_particles(mcor_context* context, mcor_staging* staging)
{
  mcor_grid* grid = &context->grid;
  const size_t n = (size_t)staging->count;
  const mcor_buffer *xyz = &context->scratch[MCOR_STAGE_XYZ],
                    *inv_h = &context->scratch[MCOR_STAGE_INV_H],
                    *size = &context->scratch[MCOR_STAGE_SIZE],
                    *solid = &context->scratch[MCOR_STAGE_SOLID],
                    *level = &context->scratch[MCOR_STAGE_LEVEL];
  const uint64_t cells = mcor_make_levels(context, staging);
  const int count = grid->count = staging->count;
  MCOR_TRY(mcor_unmap_staging(context, staging));
  MCOR_TRY(mcor_write(
    context, &grid->level_buffer, grid->levels, (size_t)grid->level_count * sizeof(mcor_level)));
  MCOR_TRY(mcor_reserve(context, &grid->cell_keys, n * sizeof(cl_ulong)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_key", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&grid->level_buffer), MCOR_BUFFER(level), MCOR_BUFFER(xyz),
    MCOR_BUFFER(&grid->cell_keys)));
  MCOR_TRY(mcor_sort(context, &grid->cell_keys, &grid->order, count, cells));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_order", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&grid->cell_keys), MCOR_BUFFER(xyz), MCOR_BUFFER(inv_h), MCOR_BUFFER(size),
    MCOR_BUFFER(solid), MCOR_BUFFER(&grid->order)));
  MCOR_TRY(mcor_index_keys(
    context, &grid->cell_keys, count, cells, &grid->buckets, &grid->bucket_shift));
  MCOR_TRY(mcor_reserve_particles(context, count));
  return MCOR_LAUNCH(context, "mcor_grid_gather", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&grid->order), MCOR_BUFFER(xyz), MCOR_BUFFER(inv_h), MCOR_BUFFER(size),
    MCOR_BUFFER(solid), MCOR_BUFFER(&grid->px), MCOR_BUFFER(&grid->py), MCOR_BUFFER(&grid->pz),
    MCOR_BUFFER(&grid->inv_h),
    MCOR_BUFFER(grid->has_solids ? &grid->fluid_weight : &grid->trim_weight),
    MCOR_BUFFER(&grid->trim_weight));
}

/* V = m / sum_k m_k W(x_j - x_k, h_j), own and unscaled h; m = 1 where no mass is known. */
static mcor_status mcor_compute_volumes(mcor_context* context)
{
  mcor_grid* grid = &context->grid;
  const int count = grid->count;
  const size_t bytes = ((size_t)count + MCOR_PADDING) * context->cl.real_size;
  mcor_buffer *size = &context->scratch[MCOR_STAGE_SIZE],
              *solid = &context->scratch[MCOR_STAGE_SOLID],
              *mass = &context->scratch[MCOR_STAGE_LEVEL], *density = &context->scratch[5];
  MCOR_TRY(mcor_reserve(context, mass, bytes));
  MCOR_TRY(mcor_reserve(context, density, bytes));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_BUFFER(&grid->order), MCOR_BUFFER(size), MCOR_BUFFER(mass),
    MCOR_INT(0)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_density", MCOR_HEAVY,
    (count + context->cl.lanes - 1) / context->cl.lanes, MCOR_GRID_ARGS(context),
    MCOR_REAL(context->options->h_scale), MCOR_BUFFER(mass), MCOR_BUFFER(density)));
  return MCOR_LAUNCH(context, "mcor_grid_weight", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_REAL(context->options->h_scale), MCOR_BUFFER(&grid->order), MCOR_BUFFER(solid),
    MCOR_BUFFER(mass), MCOR_BUFFER(density),
    MCOR_BUFFER(grid->has_solids ? &grid->fluid_weight : &grid->trim_weight),
    MCOR_BUFFER(&grid->trim_weight));
}

mcor_status mcor_make_grid(mcor_context* context, const mcor_input* input)
{
  mcor_staging staging = { 0 };
  mcor_status status = mcor_stage(context, input, &staging);
  if (status == MCOR_OK)
  {
    status = mcor_begin_phase(context, MCOR_PHASE_SEARCH_GRID, 0.1);
  }
  if (status == MCOR_OK)
  {
    status = mcor_sort_particles(context, &staging);
  }
  const mcor_status unmapped = mcor_unmap_staging(context, &staging);
  MCOR_TRY(status);
  MCOR_TRY(unmapped);
  return mcor_needs_density(input) ? mcor_compute_volumes(context) : MCOR_OK;
}

/* One component of an array, or the scalar where `array` is NULL, less `shift`, times `scale`: from the
 * caller's order to the sorted one, to element to_offset. */
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, mcor_buffer* to,
  int to_offset)
{
  const mcor_grid* grid = &context->grid;
  const size_t bytes = (size_t)grid->count * context->cl.real_size;
  mcor_buffer* raw = &context->scratch[0];
  void* values;
  MCOR_TRY(mcor_reserve(context, raw, bytes));
  MCOR_TRY(mcor_map(context, raw, bytes, true, &values));
  int done = 0;
  for (int64_t first = 0; first < input->count; first += MCOR_CHUNK)
  {
    const int64_t rest = input->count - first;
    const int count = rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK;
    double chunk[MCOR_CHUNK], used[MCOR_CHUNK];
    array ? mcor_read_array(array, first, count, component, chunk)
          : mcor_read_scalar(input, first, count, chunk);
    int n = 0;
    for (; done + n < grid->count && context->source[done + n] < first + count; ++n)
    {
      used[n] = (chunk[context->source[done + n] - first] - shift) * scale;
    }
    mcor_put_reals(context, values, done, used, n);
    done += n;
  }
  MCOR_TRY(mcor_unmap(context, raw, &values));
  return MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->order), MCOR_BUFFER(raw), MCOR_BUFFER(to),
    MCOR_INT(to_offset));
}

/* A Shepard mean shifts with its values. A - A0 with A0 where most values are keeps the digits of a
 * scalar with a large offset, and of one with a few huge peaks. */
mcor_status mcor_set_scalar(mcor_context* context, const mcor_input* input)
{
  mcor_grid* grid = &context->grid;
  const mcor_field field = context->options->field;
  context->value_shift = field == MCOR_SHEPARD ? mcor_scalar_median(context, input) : 0;
  if (field == MCOR_WEIGHT_SUM)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_sort_values(context, input, NULL, 0, context->value_shift, 1, &grid->value, 0));
  return MCOR_LAUNCH(context, "mcor_grid_order_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->px), MCOR_BUFFER(&grid->py), MCOR_BUFFER(&grid->pz),
    MCOR_BUFFER(&grid->inv_h),
    MCOR_BUFFER(grid->has_solids ? &grid->fluid_weight : &grid->trim_weight),
    MCOR_BUFFER(&grid->trim_weight), MCOR_BUFFER(&grid->value), MCOR_BUFFER(&grid->order));
}
