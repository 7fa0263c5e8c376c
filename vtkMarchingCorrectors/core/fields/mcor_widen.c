/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Widening: longer smoothing lengths, which make a smoother surface, as far as they leave each particle inside of it.
 * A surface with widening is that of the widened lengths, with the cubes and volumes of the original ones: two calls
 * make the factors, then mcor_extract runs as for any array of smoothing lengths. */

#include "mcor_widen.h"
#include "mcor_box.h"
#include "mcor_input.h"
#include "mcor_plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How much more than the iso value the weight sum is at a particle whose length was widened. */
#define MCOR_WIDEN_MARGIN 0.1

/* Neighbours, by their nearness, below which a length is not widened, and from which on it fully is: a thread has
 * 2 in space, a sheet 6; in the plane a line has 2. */
#define MCOR_CROWD_FROM 2.2
#define MCOR_CROWD_TO 4.5
#define MCOR_CROWD_IN_PLANE 0.31 /* times these */

typedef struct mcor_widen_run
{
  mcor_widening* out;
  double iso;
  float* factor; /* [count], before the mean */
} mcor_widen_run;

/* Whether each sorted particle is in the period, as its images are not. */
static mcor_status mcor_find_originals(mcor_context* context, cl_int* originals)
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_grid* grid = &context->grid;
  const int n = grid->count;
  int first[3], last[3];
  mcor_point_batch batch = { 0 };
  for (int a = 0; a < 3; ++a)
  {
    first[a] = lattice->period[a] > 0 ? lattice->period_first[a] : INT32_MIN;
    last[a] = lattice->period[a] > 0 ? first[a] + lattice->period[a] : INT32_MAX;
  }
  mcor_status status = mcor_reserve(context, &batch.in_node, (size_t)n * 4 * sizeof(cl_int));
  status = status == MCOR_OK
    ? mcor_reserve(context, &batch.in_offset, (size_t)n * 4 * context->cl.real_size)
    : status;
  status = status == MCOR_OK
    ? mcor_reserve(context, &context->points.flags, ((size_t)n + 1) * sizeof(cl_int))
    : status;
  status = status == MCOR_OK
    ? MCOR_LAUNCH(context, "mcor_derive_place", MCOR_LIGHT, n, MCOR_INT(0), MCOR_INT(n),
        MCOR_REAL(ldexp(1, lattice->fix_bits)), MCOR_EDGE_ARGS(context), MCOR_BUFFER(&grid->px),
        MCOR_BUFFER(&grid->py), MCOR_BUFFER(&grid->pz), MCOR_INT(1),
        MCOR_CELL_ARGS(first, last, 0, 0), MCOR_BUFFER(&batch.in_node),
        MCOR_BUFFER(&batch.in_offset), MCOR_BUFFER(&context->points.flags))
    : status;
  status = status == MCOR_OK
    ? mcor_read(context, &context->points.flags, 0, originals, (size_t)n * sizeof(cl_int))
    : status;
  mcor_release_batch(context, &batch);
  return status;
}

/* Volumes that were computed, from the weights. */
static void mcor_keep_volumes(const mcor_context* context, const mcor_input* input,
  const mcor_options* options, const cl_int* order, const cl_int* originals, const void* weight,
  const void* inv_h, double* volume)
{
  const bool plane = mcor_is_plane(context);
  const double cube = context->lattice.cube,
               norm = mcor_kernel_norm(options->sph_kernel) *
    (plane ? mcor_plane_factor(options->sph_kernel) : 1);
  for (int64_t i = 0; i < input->count; ++i)
  {
    volume[i] = 1; /* of solids that are not on the device: not read */
  }
  for (int i = 0; i < context->grid.count; ++i)
  {
    const double h = 1 / mcor_get_real(context, inv_h, i);
    if (originals[i])
    {
      volume[mcor_source_of(context, order[i])] = mcor_get_real(context, weight, i) / norm * h * h *
        (plane ? cube * cube : h * cube * cube * cube);
    }
  }
}

static mcor_status mcor_read_factors(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_widen_run* run, const mcor_buffer* factor)
{
  const mcor_grid* grid = &context->grid;
  const size_t n = (size_t)grid->count, real = context->cl.real_size;
  void *factors = malloc(n * real + 1), *weight = malloc(n * real + 1),
       *inv_h = malloc(n * real + 1);
  cl_int *order = malloc(n * sizeof *order + 1), *originals = malloc(n * sizeof *originals + 1);
  mcor_status status = mcor_allocated(context, factors && weight && inv_h && order && originals);
  status = status == MCOR_OK ? mcor_read(context, factor, 0, factors, n * real) : status;
  status = status == MCOR_OK ? mcor_read(context, &grid->trim_weight, 0, weight, n * real) : status;
  status = status == MCOR_OK ? mcor_read(context, &grid->inv_h, 0, inv_h, n * real) : status;
  status =
    status == MCOR_OK ? mcor_read(context, &grid->order, 0, order, n * sizeof *order) : status;
  status = status == MCOR_OK ? mcor_find_originals(context, originals) : status;
  for (size_t i = 0; i < n && status == MCOR_OK; ++i)
  {
    const int64_t to = mcor_source_of(context, order[i]);
    if (originals[i] && !(input->solid && input->solid[to]))
    {
      run->factor[to] = (float)mcor_get_real(context, factors, (int64_t)i);
    }
  }
  if (status == MCOR_OK && run->out->volume)
  {
    mcor_keep_volumes(context, input, options, order, originals, weight, inv_h, run->out->volume);
  }
  free(factors);
  free(weight);
  free(inv_h);
  free(order);
  free(originals);
  return status;
}

/* The factors before the mean, and what else of the original lengths the surface needs. The search grid is that of
 * the widest lengths. */
static mcor_status mcor_run_widen(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_widen_run* run = data;
  mcor_widening* out = run->out;
  mcor_buffer factor = { 0 };
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_TRY(mcor_prepare(context, input, options));
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_SEARCH_GRID, 0.2, 0.8));
  const int n = context->grid.count, lanes = context->cl.lanes;
  const double crowd = mcor_is_plane(context) ? MCOR_CROWD_IN_PLANE : 1;
  mcor_status status =
    mcor_reserve(context, &factor, ((size_t)n + MCOR_PADDING) * context->cl.real_size);
  status = status == MCOR_OK && n > 0
    ? MCOR_LAUNCH(context, "mcor_widen_factors", MCOR_HEAVY, (n + lanes - 1) / lanes,
        MCOR_GRID_ARGS(context), MCOR_REAL(options->h_scale), MCOR_INT(mcor_is_plane(context)),
        MCOR_REAL(options->h_scale), MCOR_REAL(run->iso + MCOR_WIDEN_MARGIN),
        MCOR_REAL(crowd * MCOR_CROWD_FROM), MCOR_REAL(crowd * MCOR_CROWD_TO), MCOR_BUFFER(&factor))
    : status;
  status =
    status == MCOR_OK && n > 0 ? mcor_read_factors(context, input, options, run, &factor) : status;
  mcor_release(context, &factor);
  MCOR_TRY(status);
  for (int64_t i = 0; i < input->count; i += MCOR_CHUNK)
  {
    const int64_t rest = input->count - i;
    mcor_read_smoothing_length(
      context, input, i, rest < MCOR_CHUNK ? (int)rest : MCOR_CHUNK, out->smoothing_length + i);
  }
  out->smoothing_length_range[0] = context->measure.h_min;
  out->smoothing_length_range[1] = context->measure.h_max;
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* Takes the lower of each factor and the mean around it; and whether the particle was inside. */
static mcor_status mcor_limit_by_mean(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_widen_run* run)
{
  mcor_widening* out = run->out;
  const mcor_array factor = { .data = run->factor, .type = MCOR_FLOAT32, .name = "Widening" };
  mcor_input own = *input;
  mcor_samples samples;
  own.attributes = &factor;
  own.attribute_count = 1;
  if (out->volume)
  {
    own.volume = (mcor_array){ .data = out->volume, .type = MCOR_FLOAT64 };
  }
  mcor_array points = input->positions;
  points.components = 3;
  const mcor_status status = mcor_probe(context, &own, options, &points, input->count, &samples);
  int64_t sum = 0, fluid = 0;
  out->least = INFINITY;
  out->greatest = 0;
  for (int64_t i = 0; i < input->count && status == MCOR_OK; ++i)
  {
    double s = run->factor[i];
    if (!(input->solid && input->solid[i]))
    {
      s = samples.valid[i] ? fmax(fmin(s, (double)(float)samples.values[0][i]), 1) : s;
      out->least = fmin(out->least, s);
      out->greatest = fmax(out->greatest, s);
      sum += (int64_t)ldexp(s, 23); /* exact, in any order */
      ++fluid;
    }
    out->factor[i] = s;
    out->smoothing_length[i] *= s;
  }
  out->mean = fluid > 0 ? ldexp((double)sum, -23) / (double)fluid : 1;
  out->least = fluid > 0 ? out->least : 1;
  out->greatest = fluid > 0 ? out->greatest : 1;
  mcor_free_samples(&samples);
  return status;
}

mcor_status mcor_widen(mcor_context* context, const mcor_input* input, const mcor_options* options,
  mcor_widening* widening)
{
  if (!context || !widening)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *widening = (mcor_widening){ 0 };
  MCOR_RETURN_IF(
    !input || !options, context, MCOR_INVALID_ARGUMENT, "input and options must not be NULL.");
  MCOR_RETURN_IF(options->ranks || options->globals, context, MCOR_INVALID_ARGUMENT,
    "Widening needs all particles in one process. Run one process, or widen the smoothing lengths "
    "beforehand.");
  MCOR_RETURN_IF(!(options->widen >= 1 && options->widen <= 4), context,
    MCOR_INVALID_ARGUMENT, "The widening is %g; it must be at least 1 and at most 4.",
    options->widen);
  const size_t n = (size_t)(input->count > 0 ? input->count : 0);
  mcor_widen_run run = { .out = widening, .factor = malloc(n * sizeof(float) + 1) };
  widening->count = input->count;
  widening->factor = malloc(n * sizeof(double) + 1);
  widening->smoothing_length = malloc(n * sizeof(double) + 1);
  widening->volume = mcor_needs_density(input) ? malloc(n * sizeof(double) + 1) : NULL;
  const bool complete = run.factor && widening->factor && widening->smoothing_length &&
    (widening->volume || !mcor_needs_density(input));
  for (size_t i = 0; i < n && run.factor; ++i)
  {
    run.factor[i] = 1;
  }
  run.iso = 0.5;
  for (int i = 0; i < options->iso_count && options->field == MCOR_WEIGHT_SUM; ++i)
  {
    run.iso = i == 0 ? options->iso_values[0] : fmax(run.iso, options->iso_values[i]);
  }
  mcor_options own = *options;
  mcor_input particles = *input;
  own.widen = 1;
  own.outputs = 0;
  own.h_scale = options->widen;
  own.node_threshold = 0;
  memset(own.box, 0, sizeof own.box);
  const bool uses_solids = mcor_uses_solids(input, options);
  mcor_evaluate_without_scalar(input, &own);
  particles.particles_version = particles.scalar_version = particles.attributes_version = 0;
  particles.attribute_count = 0;
  mcor_status status = mcor_allocated(context, complete);
  status = status == MCOR_OK ? mcor_run_call(context, &particles, &own, uses_solids,
                                 &widening->statistics, mcor_run_widen, &run)
                             : status;
  own.h_scale = 1;
  status = status == MCOR_OK ? mcor_limit_by_mean(context, &particles, &own, &run) : status;
  free(run.factor);
  if (status != MCOR_OK)
  {
    mcor_free_widening(widening);
  }
  return status;
}

void mcor_free_widening(mcor_widening* widening)
{
  if (widening)
  {
    free(widening->factor);
    free(widening->smoothing_length);
    free(widening->volume);
    *widening = (mcor_widening){ 0 };
  }
}

/* The last attribute is the widening's own array. */
static void mcor_take_widening(mcor_surface* surface)
{
  const int last = --surface->attribute_count;
  surface->widening = surface->attributes[last];
  surface->attributes[last] = NULL;
}

mcor_status mcor_extract_widened(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface)
{
  mcor_widening widening;
  MCOR_TRY(mcor_widen(context, input, options, &widening));
  const size_t count = (size_t)(input->attribute_count > 0 ? input->attribute_count : 0);
  mcor_array* attributes = malloc((count + 1) * sizeof *attributes);
  mcor_input own = *input;
  mcor_options plain = *options;
  for (size_t a = 0; a < count && attributes; ++a)
  {
    attributes[a] = input->attributes[a];
  }
  own.smoothing_length = (mcor_array){
    .data = widening.smoothing_length, .type = MCOR_FLOAT64, .name = input->smoothing_length.name
  };
  own.smoothing_length_is_support_radius = own.estimate_smoothing_length = 0;
  if (widening.volume)
  {
    own.volume = (mcor_array){ .data = widening.volume, .type = MCOR_FLOAT64 };
  }
  own.particles_version = 0; /* which stands for the original lengths */
  plain.widen = 1;
  plain.cube_size = options->cube_size > 0
    ? options->cube_size
    : options->cube_size_factor * widening.smoothing_length_range[0];
  if (widening.smoothing_length_range[0] == widening.smoothing_length_range[1])
  {
    plain.level_limit = 0;
  }
  mcor_status status = mcor_allocated(context, attributes != NULL);
  if (status == MCOR_OK)
  {
    attributes[count] =
      (mcor_array){ .data = widening.factor, .type = MCOR_FLOAT64, .name = "Widening" };
    own.attributes = attributes;
    own.attribute_count = (int)count + 1;
    status = mcor_extract(context, &own, &plain, surface);
  }
  if (status == MCOR_OK)
  {
    mcor_statistics *s = &surface->statistics, *of_h = &widening.statistics;
    mcor_take_widening(surface);
    s->smoothing_length_min = of_h->smoothing_length_min;
    s->smoothing_length_max = of_h->smoothing_length_max;
    s->smoothing_length_median = of_h->smoothing_length_median;
    s->neighbours_median = of_h->neighbours_median;
    s->filled_median = of_h->filled_median;
    s->widening_min = widening.least;
    s->widening_mean = widening.mean;
    s->widening_max = widening.greatest;
    s->build_seconds += of_h->build_seconds;
    for (int p = 0; p < MCOR_PHASE_COUNT; ++p)
    {
      s->seconds[p] += of_h->seconds[p];
    }
  }
  free(attributes);
  mcor_free_widening(&widening);
  return status;
}
