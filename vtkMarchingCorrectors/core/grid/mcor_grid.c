/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The search grid [III-A]: levels, a counting sort, volumes; and the scalar in sorted order. */

#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_plane.h"
#include "mcor_stage.h"

#include <float.h>
#include <math.h>

/* Search cells per support radius. The paper's cells are as large as the support. Smaller cells fit
 * the round reach of a query better, but then a query reads more rows. With 2 cells per support, a
 * run took as long as with 1; with 3, it took longer. */
#define MCOR_CELLS_PER_SUPPORT 1

/* The most cells of a level along an axis, so that keys of all levels stay below 2^62. A level that
 * would need more cells has hardly any particles in each, so that larger cells are as good. */
#define MCOR_CELL_LIMIT (1 << 19)

/* Divides an axis into cells of a level. A cell is `cell` cubes long, or longer if whole cells
 * must fill a period. A period no longer than `cell` is one cell. */
static void mcor_divide_axis(const mcor_lattice* lattice, int axis, double cell, mcor_level* level)
{
  const int period = lattice->period[axis];
  const double edge = mcor_edge_of(lattice, axis), length = period * edge;
  const double last = (double)lattice->last[axis];
  level->period[axis] = level->side[axis] = level->period_cells[axis] = 0;
  if (period == 0)
  {
    level->inv_cell[axis] = (cl_float)(1 / ldexp(cell, lattice->fix_bits));
    level->cells[axis] = (cl_int)(last * edge / cell) + 2;
    return;
  }
  const int cells = cell < length ? (int)(length / cell) : 1;
  const int side = (lattice->period_first[axis] % period + period) % period;
  level->period[axis] = period * lattice->step[axis];
  level->side[axis] = side * lattice->step[axis];
  level->period_cells[axis] = cells;
  level->inv_cell[axis] = (cl_float)(cells / ldexp(length, lattice->fix_bits));
  level->cells[axis] = ((int)((last - side) / period) + 2) * cells + 1;
}

/* Makes the levels of the search grid, each for support radii that differ by up to a factor of 2;
 * levels without particles are left out. Renumbers the particles' levels, staging->level,
 * accordingly. Returns the number of search cells of all levels. */
static uint64_t mcor_make_levels(mcor_context* context, mcor_staging* staging)
{
  mcor_grid* grid = &context->grid;
  const mcor_lattice* lattice = &context->lattice;
  uint8_t* particle_level = staging->level;
  bool occurs[MCOR_LEVEL_LIMIT] = { false };
  uint8_t number[MCOR_LEVEL_LIMIT];
  const bool one = context->measure.support_min == context->measure.support_max;
  occurs[0] = one; /* all levels are 0 */
  for (int i = 0; i < staging->count && !one; ++i)
  {
    occurs[particle_level[i]] = true;
  }
  int64_t extent = 0;
  for (int a = 0; a < 3; ++a)
  {
    extent = lattice->last[a] > extent ? lattice->last[a] : extent;
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
    /* Enlarges the support a little: rounding, here and on the device, must not lose a particle. */
    const double support = context->measure.support_max / lattice->cube * ldexp(1.0001, -l);
    level->base = base;
    level->support = (cl_float)support;
    const double cell = fmax(support / MCOR_CELLS_PER_SUPPORT, (double)extent / MCOR_CELL_LIMIT);
    uint64_t cells = 1;
    for (int a = 0; a < 3; ++a)
    {
      mcor_divide_axis(lattice, a, cell, level);
      cells *= (uint64_t)level->cells[a];
    }
    base += cells;
  }
  for (int i = 0; i < staging->count && !one; ++i)
  {
    particle_level[i] = number[particle_level[i]];
  }
  return base;
}

/* Makes room for one element per particle, and writes zeros behind: vector loads may read there. */
static mcor_status mcor_reserve_padded(
  mcor_context* context, mcor_buffer* buffer, int count, size_t size)
{
  const size_t end = (size_t)count * size;
  return mcor_fill_range(context, buffer, 0, end, end + MCOR_PADDING * size);
}

/* Sorts the particles within each cell. Then puts the particles' arrays into this order, one after
 * the other, so that each array can take the memory that the array before has freed. An array whose
 * elements are all the same is in order already. */
static mcor_status mcor_move_particles(mcor_context* context, const mcor_staging* staging)
{
  mcor_grid* grid = &context->grid;
  mcor_stage_data* stage = &context->stage;
  const int count = grid->count;
  const size_t size = context->cl.fix_size;
  mcor_buffer* from[] = { &stage->y, &stage->z, &stage->inv_h, &stage->size };
  mcor_buffer* to[] = { &grid->py, &grid->pz, &grid->inv_h, &grid->trim_weight };
  cl_int most_in_cell = MCOR_USUAL_IN_CELL;
  MCOR_TRY(mcor_write(context, &stage->found, &most_in_cell, sizeof most_in_cell));
  MCOR_TRY(mcor_reserve_padded(context, &grid->px, count, size));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_order", MCOR_LIGHT, mcor_batches(context, count),
    MCOR_INT(count), MCOR_BUFFER(&grid->cell_keys), MCOR_BUFFER(&stage->x), MCOR_BUFFER(&stage->y),
    MCOR_BUFFER(&stage->z), MCOR_BUFFER(&stage->inv_h), MCOR_BUFFER(&stage->size),
    MCOR_BUFFER(&grid->order), MCOR_BUFFER(&grid->px), MCOR_BUFFER(&stage->found)));
  MCOR_TRY(mcor_read(context, &stage->found, 0, &most_in_cell, sizeof most_in_cell));
  grid->most_in_cell = most_in_cell;
  mcor_release(context, &stage->x);
  const bool is_moved[] = { true, true, !staging->one_inv_h, !staging->one_size };
  for (int i = 0; i < 4; ++i)
  {
    if (is_moved[i])
    {
      MCOR_TRY(mcor_reserve_padded(context, to[i], count, size));
      MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, count, MCOR_INT(count),
        MCOR_BUFFER(&grid->order), MCOR_BUFFER(from[i]), MCOR_BUFFER(to[i]), MCOR_INT(0)));
    }
    else
    {
      mcor_take_buffer(context, from[i], to[i]);
      MCOR_TRY(mcor_reserve_padded(context, to[i], count, size));
    }
    mcor_release(context, from[i]);
  }
  MCOR_TRY(mcor_reserve_padded(context, &grid->value, count, context->cl.real_size));
  return grid->has_solids
    ? mcor_reserve_padded(context, &grid->fluid_weight, count, context->cl.real_size)
    : MCOR_OK;
}

/* Makes the tables in which queries look up the particles of a search cell. The tables hold all
 * cells if there are few, else only the cells with particles. */
static mcor_status mcor_index_cells(mcor_context* context, uint64_t cells)
{
  mcor_grid* grid = &context->grid;
  mcor_buffer keys = grid->cell_keys;
  int count = grid->count;
  MCOR_TRY(mcor_reserve(context, &grid->cell_begins, sizeof(cl_int)));
  if (cells > mcor_most_buckets(count))
  {
    grid->cell_keys = (mcor_buffer){ 0 };
    const mcor_status status =
      mcor_list_runs(context, &keys, grid->count, &grid->cell_keys, &grid->cell_begins, &count);
    mcor_release(context, &keys);
    MCOR_TRY(status);
  }
  MCOR_TRY(
    mcor_index_keys(context, &grid->cell_keys, count, cells, &grid->buckets, &grid->bucket_shift));
  if (grid->bucket_shift == 0)
  {
    /* Each cell has a bucket, so the keys are not needed. Their memory is used for the values of
     * the scalar. */
    mcor_release(context, &context->stage.values);
    context->stage.values = grid->cell_keys;
    grid->cell_keys = (mcor_buffer){ 0 };
    MCOR_TRY(mcor_reserve(context, &grid->cell_keys, sizeof(cl_ulong)));
  }
  return MCOR_OK;
}

/* Sorts particles by search cell, then within each cell, and moves them into that order. */
static mcor_status mcor_sort_particles(mcor_context* context, mcor_staging* staging)
{
  mcor_grid* grid = &context->grid;
  const size_t n = (size_t)staging->count;
  mcor_stage_data* stage = &context->stage;
  const uint64_t cells = mcor_make_levels(context, staging);
  const int count = grid->count;
  MCOR_TRY(mcor_unmap_all(context, staging->views, staging->view_count, MCOR_OK));
  MCOR_TRY(mcor_write(
    context, &grid->level_buffer, grid->levels, (size_t)grid->level_count * sizeof(mcor_level)));
  MCOR_TRY(mcor_reserve(context, &grid->cell_keys, n * sizeof(cl_ulong)));
  bool is_simple = grid->level_count == 1;
  for (int a = 0; a < 3; ++a)
  {
    is_simple = is_simple && context->lattice.period[a] == 0;
  }
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_key", MCOR_LIGHT, mcor_batches(context, count),
    MCOR_INT(count), MCOR_INT(is_simple), MCOR_BUFFER(&grid->level_buffer),
    MCOR_BUFFER(&stage->level), MCOR_BUFFER(&stage->x), MCOR_BUFFER(&stage->y),
    MCOR_BUFFER(&stage->z), MCOR_BUFFER(&grid->cell_keys)));
  MCOR_TRY(mcor_sort(context, &grid->cell_keys, &grid->order, count, cells));
  MCOR_RELEASE_EACH(context, &context->sort);
  MCOR_TRY(mcor_move_particles(context, staging));
  return mcor_index_cells(context, cells);
}

/* At a particle without neighbours on one side, the density sum is too low; so it is multiplied by
 * 1 + MCOR_ONE_SIDED * D^2, see mcor_density_factor. With 5/3, the uppermost layer of a lattice at
 * rest has its true volume within 0.7 %, for all kernels and smoothing lengths. */
#define MCOR_ONE_SIDED (5.0 / 3)

/* Computes the volume of each particle j, m_j / ((1 + 5/3 D^2) sum_k m_k W(x_j - x_k, h_j)). m: the
 * masses, or 1 if they are unknown. h_j: not scaled by h_scale. D: see mcor_density_factor. */
static mcor_status mcor_compute_volumes(mcor_context* context, const mcor_input* input)
{
  mcor_grid* grid = &context->grid;
  const int count = grid->count;
  const size_t bytes = ((size_t)count + MCOR_PADDING) * context->cl.real_size;
  mcor_buffer *density = &context->stage.density, *without = &context->stage.found;
  MCOR_TRY(mcor_reserve(context, density, bytes));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_density", MCOR_HEAVY,
    (count + context->cl.lanes - 1) / context->cl.lanes, MCOR_GRID_ARGS(context),
    MCOR_REAL(context->run.options->h_scale), MCOR_INT(context->space.flat),
    MCOR_REAL(MCOR_ONE_SIDED *
      mcor_kernel_of(context->run.options->sph_kernel)->variance[context->space.flat]),
    MCOR_BUFFER(&grid->trim_weight), MCOR_BUFFER(density)));
  double low[3], high[3];
  cl_int first = INT32_MAX;
  mcor_find_evaluated(context, low, high);
  MCOR_TRY(mcor_write(context, without, &first, sizeof first));
  /* mcor_grid_weight divides by the third power of its argument h_scale. In two dimensions it must
   * divide by scale^2, so the argument is the cube root of scale^2. */
  const double scale = context->run.options->h_scale;
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_grid_weight", MCOR_LIGHT, count, MCOR_INT(count),
    MCOR_REAL(context->space.flat ? mcor_cube_root(scale * scale) : scale),
    MCOR_BUFFER(&grid->order), MCOR_BUFFER(density),
    MCOR_REAL(ldexp(1, -context->lattice.fix_bits)), MCOR_BUFFER(&grid->px), MCOR_BUFFER(&grid->py),
    MCOR_BUFFER(&grid->pz), MCOR_BUFFER(&grid->inv_h), MCOR_REAL(low[0]), MCOR_REAL(low[1]),
    MCOR_REAL(low[2]), MCOR_REAL(high[0]), MCOR_REAL(high[1]), MCOR_REAL(high[2]),
    MCOR_BUFFER(mcor_fluid_weight(grid)), MCOR_BUFFER(&grid->trim_weight), MCOR_BUFFER(without)));
  MCOR_TRY(mcor_read(context, without, 0, &first, sizeof first));
  if (first == INT32_MAX)
  {
    return MCOR_OK;
  }
  const long long particle = mcor_source_of(context, first);
  const bool single = context->cl.real_size == sizeof(float);
  const double mass = mcor_is_given(&input->mass)
    ? mcor_array_at(&input->mass, particle, 0) * mcor_size_scale(context, input)
    : 1;
  MCOR_FAIL_IF(mass < (single ? (double)FLT_MIN : DBL_MIN), context, MCOR_INVALID_DATA,
    MCOR_SAY(MASS_TOO_SMALL), particle, mass, single ? "single" : "double");
  return mcor_fail(context, MCOR_INVALID_DATA, MCOR_SAY(VOLUME_OF_KERNEL), particle,
    mcor_sph_kernel_name(context->run.options->sph_kernel));
}

mcor_status mcor_make_grid(mcor_context* context, const mcor_input* input)
{
  mcor_grid* grid = &context->grid;
  mcor_staging staging = { .context = context, .input = input };
  mcor_status status = mcor_stage(&staging);
  MCOR_THEN(status, mcor_begin_phase(context, MCOR_PHASE_SEARCH_GRID, 0.1, 0.15));
  grid->count = staging.count;
  context->attributes.kept = 0; /* kept attributes are in another order */
  if (staging.count > 0)
  {
    MCOR_THEN(status, mcor_sort_particles(context, &staging));
  }
  MCOR_TRY(mcor_unmap_all(context, staging.views, staging.view_count, status));
  if (staging.count > 0 && mcor_needs_density(input))
  {
    return mcor_compute_volumes(context, input);
  }
  return staging.count == 0
    ? MCOR_OK
    : MCOR_LAUNCH(context, "mcor_grid_weigh", MCOR_LIGHT, grid->count, MCOR_INT(grid->count),
        MCOR_REAL(mcor_kernel_of(context->cl.build.sph_kernel)->norm), MCOR_BUFFER(&grid->inv_h),
        MCOR_BUFFER(mcor_fluid_weight(grid)), MCOR_BUFFER(&grid->trim_weight));
}

typedef struct mcor_value_job
{
  const mcor_context* context;
  const mcor_input* input;
  const mcor_array* array;
  int component;
  double shift, scale;
  bool fixed;
  void* values;
} mcor_value_job;

static void mcor_store_value_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_value_job* job = data;
  const mcor_input* input = job->input;
  const double shift = job->shift, scale = job->scale;
  const bool single = job->context->cl.fix_size == sizeof(int32_t);
  int n = 0;
  for (int64_t begin = first; begin < last; begin += n)
  {
    const int64_t from = mcor_source_of(job->context, begin);
    const int count = mcor_chunk_of(input->count - from);
    double chunk[MCOR_CHUNK], used[MCOR_CHUNK];
    job->array ? mcor_read_array(job->array, from, count, job->component, chunk)
               : mcor_read_scalar(input, from, count, chunk);
    /* The periodic images of a particle follow one another, and have the same value. */
    for (n = 0; n < MCOR_CHUNK && begin + n < last &&
         mcor_source_of(job->context, begin + n) < from + count;
         ++n)
    {
      used[n] = (chunk[mcor_source_of(job->context, begin + n) - from] - shift) * scale;
    }
    /* Values of solids play no part, whatever they are. */
    for (int i = 0; i < n && input->solid; ++i)
    {
      used[i] = input->solid[mcor_source_of(job->context, begin + i)] ? 0 : used[i];
    }
    for (int i = 0; i < n && job->fixed; ++i)
    {
      if (single)
      {
        ((int32_t*)job->values)[begin + i] = (int32_t)lrint(used[i]);
      }
      else
      {
        ((int64_t*)job->values)[begin + i] = (int64_t)llrint(used[i]);
      }
    }
    for (int i = 0; i < n && !job->fixed; ++i)
    {
      mcor_put_real(job->context, job->values, begin + i, used[i]);
    }
  }
  (void)slice;
}

/* Writes (A - shift) * scale of each particle, in the grid's order, as real or fixed-point numbers,
 * to row `to_row` of `to`. A is one component of `array`, or the scalar if `array` is NULL. */
mcor_status mcor_sort_values(mcor_context* context, const mcor_input* input,
  const mcor_array* array, int component, double shift, double scale, bool fixed, mcor_buffer* to,
  int to_row)
{
  const mcor_grid* grid = &context->grid;
  const size_t bytes = (size_t)grid->count * context->cl.real_size;
  mcor_buffer* raw = &context->stage.values;
  mcor_value_job job = { context, input, array, component, shift, scale, fixed, NULL };
  MCOR_TRY(mcor_reserve(context, raw, bytes));
  MCOR_TRY(mcor_map(context, raw, bytes, true, &job.values));
  const mcor_status status =
    mcor_parallel_run(context, grid->count, MCOR_LIGHT_GRAIN, mcor_store_value_slice, &job, NULL);
  MCOR_TRY(mcor_unmap(context, raw, &job.values));
  MCOR_TRY(status);
  return MCOR_LAUNCH(context, "mcor_grid_gather_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->order), MCOR_BUFFER(raw), MCOR_BUFFER(to),
    MCOR_INT(to_row));
}

/* Copies the scalar A, less a shift A0, to the sorted particles. With a weight sum, only sets A0 to
 * 0. For a Shepard mean, A0 is near A's median, else 0. The mean of A - A0 is the mean of A less
 * A0, and A - A0 keeps the digits of a scalar with a large offset or a few huge peaks. */
mcor_status mcor_set_scalar(mcor_context* context, const mcor_input* input)
{
  mcor_grid* grid = &context->grid;
  const mcor_field field = context->run.options->field;
  context->value_shift = 0;
  if (grid->count == 0 || field == MCOR_WEIGHT_SUM)
  {
    return MCOR_OK;
  }
  if (field == MCOR_SHEPARD && context->run.options->globals)
  {
    context->value_shift = context->run.options->globals->scalar_shift;
  }
  else if (field == MCOR_SHEPARD)
  {
    MCOR_TRY(mcor_find_median(context, input, &context->value_shift));
  }
  const bool single = context->cl.real_size == sizeof(float);
  const double low = context->measure.scalar_min, high = context->measure.scalar_max;
  const double most = fmax(high - context->value_shift, context->value_shift - low);
  MCOR_FAIL_IF(!(most * fmax(context->largest_weight, 1) < (single ? 1e33 : 1e290)), context,
    MCOR_INVALID_DATA, MCOR_SAY(SCALAR_TOO_LARGE), low, high, single ? "single" : "double",
    single ? "Choose {precision double}" : "Use another unit");
  MCOR_TRY(
    mcor_sort_values(context, input, NULL, 0, context->value_shift, 1, false, &grid->value, 0));
  /* Orders particles that differ in the scalar only. */
  return MCOR_LAUNCH(context, "mcor_grid_order_value", MCOR_LIGHT, grid->count,
    MCOR_INT(grid->count), MCOR_BUFFER(&grid->px), MCOR_BUFFER(&grid->py), MCOR_BUFFER(&grid->pz),
    MCOR_BUFFER(&grid->inv_h), MCOR_BUFFER(mcor_fluid_weight(grid)),
    MCOR_BUFFER(&grid->trim_weight), MCOR_BUFFER(&context->stage.values),
    MCOR_BUFFER(&grid->value), MCOR_BUFFER(&grid->order));
}

void mcor_release_grid(mcor_context* context)
{
  MCOR_RELEASE_BEFORE(context, &context->grid, count);
  context->kept.grid = context->kept.value = context->kept.nodes = false;
}
