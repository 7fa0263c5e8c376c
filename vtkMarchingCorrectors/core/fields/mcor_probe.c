/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The probe: Shepard means or sums of particle arrays, and their gradients, at points of the
 * caller's choice. On the device an array is A' = (A - A0) s, with A0 in the middle of its
 * range: single precision then keeps the digits of an array with a large offset. */

#include "mcor_probe.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points on the device at a time. In a smaller batch of unordered points, fewer points are near each
 * other. */
#define MCOR_PROBE_BATCH (1 << 18)

/* Fluid weight below which a mean has no digits; MCOR_LEAST_SUM in mcor_attribute.cl. */
#define MCOR_LEAST_WEIGHT 1e-30

void mcor_release_probe(mcor_probe_run* run)
{
  mcor_release_batch(run->context, &run->batch);
  MCOR_RELEASE(run->context, &run->weight, &run->weight_with_solids, &run->sums,
    &run->weight_gradient, &run->gradients);
}

/* ---- evaluation ---- */

typedef struct mcor_probe_job
{
  const mcor_probe_run* run;
  /* Views of the device's results. */
  void *order, *weight, *weight_with_solids, *sums, *weight_gradient, *gradients;
  double threshold;
} mcor_probe_job;

/* Writes component c of the attributes on the device, and its gradient, at point i of the batch,
 * which is point `to` of the caller. weight, slope: the weight sum there, and its gradient. The
 * component's scale is a power of 2, so dividing by the scale is exact. */
static void mcor_put_component(
  const mcor_probe_job* job, int64_t i, int64_t to, int c, double weight, const double slope[3])
{
  const mcor_context* context = job->run->context;
  const mcor_attributes* attributes = &context->attributes;
  const mcor_component* component = &attributes->varying[attributes->first + c];
  const mcor_samples* samples = job->run->samples;
  const int attribute = component->attribute;
  const int64_t at = i * attributes->count + c,
                place = to * mcor_components(&job->run->input->attributes[attribute]) +
    component->component;
  const double shift = component->shift, unscale = 1 / component->scale;
  const double sum = mcor_get_real(context, job->sums, at), mean = sum / weight;
  const bool is_sum = job->run->is_sum;
  /* Rounding must not take a mean out of the range of its values. With M'4, which is partly
   * negative, a mean may lie out of the range anyway. */
  const bool is_between = !is_sum && context->run.options->sph_kernel != MCOR_M_PRIME_4;
  const double low = is_between ? component->low : -INFINITY;
  const double high = is_between ? component->high : INFINITY;
  const double value = is_sum ? sum * unscale + shift * weight : mean * unscale + shift;
  samples->values[attribute][place] = value < low ? low : value > high ? high : value;
  for (int a = 0; a < 3 && samples->gradients; ++a)
  {
    const double rise = mcor_get_real(context, job->gradients, 3 * at + a);
    samples->gradients[attribute][3 * place + a] =
      (is_sum ? rise / component->scale + shift * slope[a]
              : (rise - mean * slope[a]) / weight / component->scale) /
      context->lattice.cube;
  }
}

static void mcor_put_samples(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_probe_job* job = data;
  const mcor_probe_run* run = job->run;
  const mcor_context* context = run->context;
  const mcor_samples* samples = run->samples;
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t to = run->first + ((const cl_int*)job->order)[i];
    const double weight = mcor_get_real(context, job->weight, i);
    const bool valid = weight >= job->threshold && weight > MCOR_LEAST_WEIGHT;
    double slope[3] = { 0 };
    samples->weight_sum[to] = weight;
    samples->valid[to] = valid;
    if (run->weights_with_solids)
    {
      run->weights_with_solids[to] = mcor_get_real(context, job->weight_with_solids, i);
    }
    for (int a = 0; a < 3 && samples->weight_gradient; ++a)
    {
      slope[a] = mcor_get_real(context, job->weight_gradient, 3 * i + a);
      samples->weight_gradient[3 * to + a] = slope[a] / context->lattice.cube;
    }
    for (int c = 0; c < context->attributes.count && valid; ++c)
    {
      mcor_put_component(job, i, to, c, weight, slope);
    }
  }
  (void)slice;
}

mcor_status mcor_probe_batch(mcor_probe_run* run, int64_t first, int64_t last)
{
  mcor_context* context = run->context;
  MCOR_TRY(mcor_upload_points(run, first, last));
  if (run->inside == 0)
  {
    return MCOR_OK;
  }
  const size_t n = (size_t)run->inside, real = context->cl.real_size,
               arrays = (size_t)context->attributes.count;
  int groups;
  MCOR_TRY(mcor_group_batch(context, &run->batch, run->count, run->inside, &groups));
  MCOR_TRY(mcor_reserve(context, &run->weight, n * real));
  MCOR_TRY(mcor_reserve(context, &run->sums, n * arrays * real));
  const int cluster = MCOR_CLUSTER_OF(context->cl.lanes);
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_sums", MCOR_HEAVY, (groups + cluster - 1) / cluster,
    MCOR_GRID_ARGS(context), MCOR_INT(groups), MCOR_BUFFER(&context->points.groups),
    MCOR_BUFFER(&run->batch.node), MCOR_BUFFER(&run->batch.offset), MCOR_BUFFER(&run->weight),
    MCOR_ATTRIBUTE_ARGS(context, &run->sums)));
  if (run->weights_with_solids)
  {
    MCOR_TRY(mcor_reserve(context, &run->weight_with_solids, n * real));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_sums", MCOR_HEAVY, (groups + cluster - 1) / cluster,
      MCOR_WEIGHTED_GRID_ARGS(context, &context->grid.trim_weight), MCOR_INT(groups),
      MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&run->batch.node),
      MCOR_BUFFER(&run->batch.offset), MCOR_BUFFER(&run->weight_with_solids), MCOR_INT(0),
      MCOR_INT(0), MCOR_BUFFER(&context->attributes.sorted), MCOR_BUFFER(&run->sums)));
  }
  if (run->samples->weight_gradient)
  {
    MCOR_TRY(mcor_reserve(context, &run->weight_gradient, n * 3 * real));
    MCOR_TRY(mcor_reserve(context, &run->gradients, n * 3 * arrays * real));
    for (int array = 0; array == 0 || array < context->attributes.count; array += MCOR_ARRAY_STEP)
    {
      MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_gradients", MCOR_HEAVY, groups,
        MCOR_GRID_ARGS(context), MCOR_INT(groups), MCOR_BUFFER(&context->points.groups),
        MCOR_BUFFER(&run->batch.node), MCOR_BUFFER(&run->batch.offset), MCOR_INT(array),
        MCOR_BUFFER(&run->weight_gradient), MCOR_ATTRIBUTE_ARGS(context, &run->gradients)));
    }
  }
  MCOR_TRY(mcor_finish(context));
  MCOR_TRY(mcor_report_launch(context));
  mcor_probe_job job = { .run = run, .threshold = context->run.options->node_threshold };
  const size_t solids = run->weights_with_solids ? n * real : 0;
  const size_t slopes = run->samples->weight_gradient ? n * 3 * real : 0;
  const mcor_mapping views[] = { { &run->batch.order, n * sizeof(cl_int), &job.order },
    { &run->weight, n * real, &job.weight }, { &run->sums, n * arrays * real, &job.sums },
    { &run->weight_with_solids, solids, &job.weight_with_solids },
    { &run->weight_gradient, slopes, &job.weight_gradient },
    { &run->gradients, slopes * arrays, &job.gradients } };
  const int count = sizeof views / sizeof *views;
  mcor_status status = mcor_map_all(context, views, count);
  MCOR_THEN(status,
    mcor_parallel_run(context, run->inside, MCOR_HEAVY_GRAIN, mcor_put_samples, &job, NULL));
  return mcor_unmap_all(context, views, count, status);
}

/* Whether the device holds this call's attributes already. */
static bool mcor_has_attributes(const mcor_context* context, const mcor_input* input)
{
  return input->attributes_version != 0 && context->attributes.kept == input->attributes_version;
}

/* Evaluates all arrays at all points: one group of arrays after the other, for one batch of points
 * after the other. */
static mcor_status mcor_probe_all(mcor_probe_run* run)
{
  mcor_context* context = run->context;
  const int64_t points = run->samples->count;
  const int arrays = context->attributes.varying_count;
  const double rounds = ceil(fmax(arrays, 1) / MCOR_ATTRIBUTE_LIMIT);
  double done = 0.2;
  for (int array = 0; array == 0 || array < arrays; array += MCOR_ATTRIBUTE_LIMIT)
  {
    if (!mcor_has_attributes(context, run->input))
    {
      MCOR_TRY(mcor_load_attributes(context, run->input, array));
    }
    for (int64_t first = 0, last; first < points; first = last)
    {
      const double before = done;
      last = points - first < MCOR_PROBE_BATCH ? points : first + MCOR_PROBE_BATCH;
      done += 0.8 * (double)(last - first) / (double)points / rounds;
      MCOR_TRY(mcor_report(context, "probe", before, done));
      MCOR_TRY(mcor_probe_batch(run, first, last));
    }
  }
  return MCOR_OK;
}

mcor_status mcor_make_arrays(mcor_context* context, const mcor_input* input,
  const int64_t* not_finite, int64_t count, int numbers, double*** arrays)
{
  *arrays = calloc((size_t)input->attribute_count + 1, sizeof **arrays);
  bool complete = *arrays;
  for (int a = 0; a < input->attribute_count && complete; ++a)
  {
    const size_t width = (size_t)numbers * (size_t)mcor_components(&input->attributes[a]);
    (*arrays)[a] = not_finite[a] < 0 ? calloc((size_t)count + 1, width * sizeof(double)) : NULL;
    complete = (*arrays)[a] || not_finite[a] >= 0;
  }
  return mcor_allocated(context, complete);
}

void mcor_free_arrays(double** arrays, int count)
{
  for (int a = 0; a < count && arrays; ++a)
  {
    free(arrays[a]);
  }
  free(arrays);
}

/* Lists the components of the attributes, and allocates the results. Points that no particle
 * reaches keep the zeros. */
static mcor_status mcor_make_samples(
  mcor_context* context, const mcor_input* input, bool gradients, mcor_samples* s)
{
  const size_t n = (size_t)s->count + 1,
               numbers = ((size_t)input->attribute_count + 1) * sizeof(int64_t);
  s->weight_sum = calloc(n, sizeof(double));
  s->valid = calloc(n, 1);
  s->weight_gradient = gradients ? calloc(n, 3 * sizeof(double)) : NULL;
  s->attribute_not_finite = malloc(numbers);
  s->attribute_count = input->attribute_count;
  MCOR_TRY(mcor_allocated(context,
    s->weight_sum && s->valid && s->attribute_not_finite && (s->weight_gradient || !gradients)));
  memset(s->attribute_not_finite, -1, numbers);
  if (!context->kept.grid || !mcor_same_particles(input, &context->kept.input) ||
    context->run.options->globals || input->attribute_count != context->kept.input.attribute_count)
  {
    context->attributes.kept = 0;
  }
  if (!mcor_has_attributes(context, input))
  {
    MCOR_TRY(mcor_list_components(context, input, false, s->attribute_not_finite));
  }
  MCOR_TRY(mcor_make_arrays(context, input, s->attribute_not_finite, s->count, 1, &s->values));
  return gradients
    ? mcor_make_arrays(context, input, s->attribute_not_finite, s->count, 3, &s->gradients)
    : MCOR_OK;
}

static mcor_status mcor_probe_points(mcor_probe_run* run, const mcor_options* options)
{
  mcor_context* context = run->context;
  const mcor_input* input = run->input;
  mcor_samples* samples = run->samples;
  const bool gradients = options->outputs & MCOR_OUT_GRADIENTS;
  mcor_free_samples(samples); /* results of an earlier attempt */
  samples->count = run->point_count;
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_TRY(mcor_make_samples(context, input, gradients, samples));
  if (input->count == 0 || samples->count == 0)
  {
    return MCOR_OK;
  }
  if (!mcor_bound_by_box(context, options))
  {
    /* Lets the call use only particles near the caller's finite points. */
    mcor_array points = *run->points;
    points.components = 3;
    for (int a = 0; a < 3; ++a)
    {
      mcor_find_range(
        context, &points, NULL, MCOR_SKIP_SOLIDS, samples->count, a, context->box.points + 2 * a);
    }
    context->box.has_points = true;
    context->box.of_points = input->particles_version == 0 || context->run.far;
  }
  MCOR_TRY(mcor_prepare(context, input, options));
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_CORRECTION, 0.2, 0.2));
  const mcor_status status = context->grid.count > 0 ? mcor_probe_all(run) : MCOR_OK;
  mcor_release_probe(run);
  /* Keeps the attributes on the device for the next probe, if all of them fit at once. */
  mcor_attributes* attributes = &context->attributes;
  bool all = attributes->varying_count <= MCOR_ATTRIBUTE_LIMIT && !options->globals;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    all = all && samples->attribute_not_finite[a] < 0;
  }
  attributes->kept = all ? input->attributes_version : 0;
  if (attributes->kept == 0)
  {
    mcor_release(context, &attributes->sorted);
  }
  MCOR_TRY(status);
  return mcor_finish_field(context);
}

mcor_status mcor_finish_field(mcor_context* context)
{
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* Runs a call. In two dimensions, turns the points into the plane z = 0, and the gradients back. */
static mcor_status mcor_run_probe(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_probe_run run = *(const mcor_probe_run*)data;
  const mcor_plane* plane = &context->plane;
  mcor_samples* s = run.samples;
  mcor_array points = { 0 };
  double* flat = NULL;
  run.input = input;
  if (mcor_is_plane(context) && run.point_count > 0)
  {
    MCOR_TRY(mcor_flatten_points(context, run.points, run.point_count, &points, &flat));
    run.points = &points;
  }
  const mcor_status status = mcor_probe_points(&run, options);
  free(flat);
  MCOR_TRY(status);
  mcor_unflatten_doubles(plane, s->weight_gradient, s->count, 0);
  for (int a = 0; a < s->attribute_count && s->gradients; ++a)
  {
    const int64_t width = mcor_components(&input->attributes[a]);
    mcor_unflatten_doubles(plane, s->gradients[a], s->count * width, 0);
  }
  return MCOR_OK;
}

/* Sets the options of a call that evaluates arrays but no scalar. Such a call runs as for the
 * free surface: without solids, unless they count in computed volumes. Returns whether solids
 * are used. */
bool mcor_evaluate_without_scalar(const mcor_input* input, mcor_options* options)
{
  const bool uses_solids =
    options->field != MCOR_WEIGHT_SUM && !input->ignore_solids && mcor_needs_density(input);
  options->field = MCOR_WEIGHT_SUM;
  options->iso_count = 0;
  if (!options->globals)
  {
    memset(options->box, 0, sizeof options->box);
  }
  options->capping = 0;
  options->level_limit = 0;
  options->ranks = NULL;
  return uses_solids;
}

mcor_status mcor_probe(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_array* points, int64_t count, mcor_samples* samples)
{
  if (!context || !samples)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *samples = (mcor_samples){ 0 };
  MCOR_FAIL_IF(!input || !options || count < 0 || (count > 0 && (!points || !points->data)),
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_OR_NEGATIVE), "points");
  mcor_options own = *options;
  const bool uses_solids = mcor_evaluate_without_scalar(input, &own);
  mcor_probe_run run = { .context = context,
    .points = points,
    .point_count = count,
    .samples = samples,
    .is_sum = options->field == MCOR_SUM };
  const mcor_status status =
    mcor_run_call(context, input, &own, uses_solids, &samples->statistics, mcor_run_probe, &run);
  if (status != MCOR_OK)
  {
    mcor_free_samples(samples);
  }
  return status;
}

void mcor_free_samples(mcor_samples* samples)
{
  if (!samples)
  {
    return;
  }
  mcor_free_arrays(samples->values, samples->attribute_count);
  mcor_free_arrays(samples->gradients, samples->attribute_count);
  free(samples->attribute_not_finite);
  free(samples->weight_sum);
  free(samples->weight_gradient);
  free(samples->valid);
  *samples = (mcor_samples){ 0 };
}
