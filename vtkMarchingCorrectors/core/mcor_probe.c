/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The field at points of the caller's choice: Shepard means or sums of particle arrays, and their
 * gradients. On the device an array is A' = (A - A0) s, with A0 in the middle of its range, so that
 * single precision keeps the digits of one with a large offset. */

#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points that are on the device at a time. Of fewer, in no order, fewer are near each other: a
 * fourth takes a tenth longer. */
#define MCOR_PROBE_BATCH (1 << 20)

/* Fluid weight below which a mean has no digits, MCOR_LEAST_SUM of mcor_attribute.cl. */
#define MCOR_LEAST_WEIGHT 1e-30

typedef struct mcor_probe_run
{
  mcor_context* context;
  const mcor_input* input;
  const mcor_array* points;
  mcor_samples* samples;
  bool is_sum;
  mcor_point_batch batch;
  mcor_buffer weight, sums, weight_gradient, gradients;
  int64_t first;     /* point of the batch */
  int count, inside; /* points of the batch; those of them that particles may reach */
  int group_count;
} mcor_probe_run;

static void mcor_release_probe(mcor_probe_run* run)
{
  mcor_release_batch(run->context, &run->batch);
  MCOR_RELEASE(run->context, &run->weight, &run->sums, &run->weight_gradient, &run->gradients);
}

/* ---- points ------------------------------------------------------------------------------- */

/* Whether point i of the caller's is where particles may reach it; then its node and offset. */
static bool mcor_locate_point(
  const mcor_probe_run* run, int64_t i, int64_t node[3], double offset[3])
{
  const mcor_lattice* lattice = &run->context->lattice;
  mcor_array points = *run->points;
  points.components = 3;
  for (int a = 0; a < 3; ++a)
  {
    const double x = mcor_array_at(&points, i, a) / lattice->cube - (double)lattice->origin[a];
    if (!(x >= (double)lattice->first[a] && x <= (double)lattice->last[a]))
    {
      return false;
    }
    node[a] = (int64_t)x;
    offset[a] = x - (double)node[a];
  }
  return true;
}

/* A batch's points on their way to the device, and what each slice of them found. */
typedef struct mcor_point_job
{
  const mcor_probe_run* run;
  void *node, *offset; /* views */
  int inside[MCOR_SLICES];
  cl_int low[MCOR_SLICES][3], high[MCOR_SLICES][3]; /* of the nodes */
} mcor_point_job;

static void mcor_put_points(void* data, int slice, int64_t first, int64_t last)
{
  mcor_point_job* job = data;
  const mcor_probe_run* run = job->run;
  const bool single = run->context->cl.real_size == sizeof(float);
  cl_int low[3] = { CL_INT_MAX, CL_INT_MAX, CL_INT_MAX }, high[3] = { 0 };
  int inside = 0;
  for (int64_t i = first; i < last; ++i)
  {
    int64_t node[3] = { -1, -1, -1 };
    double offset[3] = { 0 };
    const bool located = mcor_locate_point(run, run->first + i, node, offset);
    inside += located;
    for (int a = 0; a < 3; ++a)
    {
      const cl_int n = located ? (cl_int)node[a] : -1;
      ((cl_int*)job->node)[4 * i + a] = n;
      low[a] = located && n < low[a] ? n : low[a];
      high[a] = n > high[a] ? n : high[a];
      if (single)
      {
        ((float*)job->offset)[4 * i + a] = (float)offset[a];
      }
      else
      {
        ((double*)job->offset)[4 * i + a] = offset[a];
      }
    }
  }
  job->inside[slice] = inside;
  memcpy(job->low[slice], low, sizeof low);
  memcpy(job->high[slice], high, sizeof high);
}

/* How many points particles may reach, and their bricks. */
static void mcor_bound_points(mcor_probe_run* run, const mcor_point_job* job, int slices)
{
  run->inside = 0;
  for (int s = 0; s < slices; ++s)
  {
    run->inside += job->inside[s];
  }
  for (int a = 0; a < 3; ++a)
  {
    cl_int low = CL_INT_MAX, high = 0;
    for (int s = 0; s < slices; ++s)
    {
      low = job->low[s][a] < low ? job->low[s][a] : low;
      high = job->high[s][a] > high ? job->high[s][a] : high;
    }
    run->batch.first[a] = low >> 2;
    run->batch.bricks[a] = (high >> 2) - (low >> 2) + 1;
  }
}

/* Takes the caller's points [first, last) to the device. */
static mcor_status mcor_upload_points(mcor_probe_run* run, int64_t first, int64_t last)
{
  mcor_context* context = run->context;
  const size_t n = (size_t)(last - first), real = context->cl.real_size;
  mcor_point_job job = { .run = run };
  MCOR_TRY(mcor_reserve(context, &run->batch.in_node, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &run->batch.in_offset, n * 4 * real));
  mcor_status status =
    mcor_map(context, &run->batch.in_node, n * 4 * sizeof(cl_int), true, &job.node);
  if (status == MCOR_OK)
  {
    status = mcor_map(context, &run->batch.in_offset, n * 4 * real, true, &job.offset);
  }
  run->first = first;
  run->count = (int)n;
  if (status == MCOR_OK)
  {
    const int slices = mcor_parallel_for(run->count, MCOR_HEAVY_GRAIN, mcor_put_points, &job);
    mcor_bound_points(run, &job, slices);
  }
  const mcor_status unmapped[] = { mcor_unmap(context, &run->batch.in_node, &job.node),
    mcor_unmap(context, &run->batch.in_offset, &job.offset) };
  for (int i = 0; i < 2; ++i)
  {
    status = status == MCOR_OK ? unmapped[i] : status;
  }
  return status;
}

/* ---- evaluation --------------------------------------------------------------------------- */

/* What the device made of a batch. */
typedef struct mcor_probe_views
{
  void *order, *weight, *sums, *weight_gradient, *gradients;
} mcor_probe_views;

typedef struct mcor_probe_job
{
  const mcor_probe_run* run;
  mcor_probe_views views;
  double threshold;
} mcor_probe_job;

/* Component c of those on the device at point i of the batch, which is the caller's point `to`. */
static void mcor_put_sample(const mcor_probe_job* job, int64_t i, int c, double weight, int64_t to)
{
  const mcor_context* context = job->run->context;
  const mcor_attributes* attributes = &context->attributes;
  const mcor_component* component = &attributes->varying[attributes->first + c];
  const mcor_samples* samples = job->run->samples;
  const int width = mcor_components(&job->run->input->attributes[component->attribute]);
  const int64_t at = i * attributes->count + c, element = to * width + component->component;
  const bool is_sum = job->run->is_sum;
  const double sum = mcor_get_real(context, job->views.sums, at);
  const double mean = sum / weight;
  samples->values[component->attribute][element] = is_sum
    ? sum / component->scale + component->shift * weight
    : mean / component->scale + component->shift;
  for (int a = 0; a < 3 && samples->gradients; ++a)
  {
    const double slope = mcor_get_real(context, job->views.gradients, 3 * at + a);
    const double weight_slope = mcor_get_real(context, job->views.weight_gradient, 3 * i + a);
    samples->gradients[component->attribute][3 * element + a] =
      (is_sum ? slope / component->scale + component->shift * weight_slope
              : (slope - mean * weight_slope) / weight / component->scale) /
      context->lattice.cube;
  }
}

static void mcor_put_samples(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_probe_job* job = data;
  const mcor_probe_run* run = job->run;
  const mcor_context* context = run->context;
  const cl_int* order = job->views.order;
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t to = run->first + order[i];
    const double weight = mcor_get_real(context, job->views.weight, i);
    const bool valid = weight >= job->threshold && weight > MCOR_LEAST_WEIGHT;
    run->samples->weight_sum[to] = weight;
    run->samples->valid[to] = valid;
    for (int a = 0; a < 3 && run->samples->weight_gradient; ++a)
    {
      run->samples->weight_gradient[3 * to + a] =
        mcor_get_real(context, job->views.weight_gradient, 3 * i + a) / context->lattice.cube;
    }
    for (int c = 0; c < context->attributes.count && valid; ++c)
    {
      mcor_put_sample(job, i, c, weight, to);
    }
  }
  (void)slice;
}

static mcor_status mcor_deliver_samples(mcor_probe_run* run)
{
  mcor_context* context = run->context;
  const size_t n = (size_t)run->inside, real = context->cl.real_size,
               arrays = (size_t)context->attributes.count;
  mcor_probe_job job = { .run = run, .threshold = context->options->node_threshold };
  struct
  {
    const mcor_buffer* buffer;
    size_t bytes;
    void** view;
  } const views[] = { { &run->batch.order, n * sizeof(cl_int), &job.views.order },
    { &run->weight, n * real, &job.views.weight },
    { &run->sums, n * arrays * real, &job.views.sums },
    { &run->weight_gradient, n * 3 * real, &job.views.weight_gradient },
    { &run->gradients, n * 3 * arrays * real, &job.views.gradients } };
  const int count = run->samples->weight_gradient ? 5 : 3;
  mcor_status status = MCOR_OK;
  for (int i = 0; i < count && status == MCOR_OK; ++i)
  {
    status = mcor_map(context, views[i].buffer, views[i].bytes, false, views[i].view);
  }
  if (status == MCOR_OK)
  {
    mcor_parallel_for(run->inside, MCOR_HEAVY_GRAIN, mcor_put_samples, &job);
  }
  for (int i = 0; i < count; ++i)
  {
    const mcor_status unmapped = mcor_unmap(context, views[i].buffer, views[i].view);
    status = status == MCOR_OK ? unmapped : status;
  }
  return status;
}

/* The arrays on the device, at the points [first, last). */
static mcor_status mcor_probe_batch(mcor_probe_run* run, int64_t first, int64_t last)
{
  mcor_context* context = run->context;
  MCOR_TRY(mcor_upload_points(run, first, last));
  if (run->inside == 0)
  {
    return MCOR_OK;
  }
  const size_t n = (size_t)run->inside, real = context->cl.real_size,
               arrays = (size_t)context->attributes.count;
  MCOR_TRY(mcor_group_batch(context, &run->batch, run->count, run->inside, &run->group_count));
  MCOR_TRY(mcor_reserve(context, &run->weight, n * real));
  MCOR_TRY(mcor_reserve(context, &run->sums, n * arrays * real));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_sums", MCOR_HEAVY, run->group_count,
    MCOR_GRID_ARGS(context), MCOR_INT(run->group_count), MCOR_BUFFER(&context->points.groups),
    MCOR_BUFFER(&run->batch.node), MCOR_BUFFER(&run->batch.offset), MCOR_BUFFER(&run->weight),
    MCOR_ATTRIBUTE_ARGS(context, &run->sums)));
  if (run->samples->weight_gradient)
  {
    MCOR_TRY(mcor_reserve(context, &run->weight_gradient, n * 3 * real));
    MCOR_TRY(mcor_reserve(context, &run->gradients, n * 3 * arrays * real));
    for (int array = 0; array == 0 || array < context->attributes.count; array += MCOR_ARRAY_STEP)
    {
      MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_gradients", MCOR_HEAVY, run->group_count,
        MCOR_GRID_ARGS(context), MCOR_INT(run->group_count), MCOR_BUFFER(&context->points.groups),
        MCOR_BUFFER(&run->batch.node), MCOR_BUFFER(&run->batch.offset), MCOR_INT(array),
        MCOR_BUFFER(&run->weight_gradient), MCOR_ATTRIBUTE_ARGS(context, &run->gradients)));
    }
  }
  MCOR_TRY(mcor_finish(context));
  MCOR_TRY(mcor_report_launch(context));
  return mcor_deliver_samples(run);
}

/* All arrays, some at a time, at all points, some at a time. */
static mcor_status mcor_probe_all(mcor_probe_run* run)
{
  mcor_context* context = run->context;
  const int64_t points = run->samples->count;
  const int arrays = context->attributes.varying_count;
  const double rounds = ceil(fmax(arrays, 1) / MCOR_ATTRIBUTE_LIMIT);
  double done = 0.2;
  for (int array = 0; array == 0 || array < arrays; array += MCOR_ATTRIBUTE_LIMIT)
  {
    MCOR_TRY(mcor_load_attributes(context, run->input, array));
    for (int64_t first = 0; first < points; first += MCOR_PROBE_BATCH)
    {
      const int64_t rest = points - first,
                    count = rest < MCOR_PROBE_BATCH ? rest : MCOR_PROBE_BATCH;
      const double begin = done;
      done += 0.8 * (double)count / (double)points / rounds;
      MCOR_TRY(mcor_report(context, "probe", begin, done));
      MCOR_TRY(mcor_probe_batch(run, first, first + count));
    }
  }
  return MCOR_OK;
}

/* Zeros; not NULL where there are none. */
static void* mcor_zeros(size_t count, size_t size)
{
  return calloc(count + 1, size);
}

/* Room for the results. Points that no particle reaches keep the zeros. */
static mcor_status mcor_make_samples(
  mcor_context* context, const mcor_input* input, bool gradients, mcor_samples* s)
{
  const size_t n = (size_t)s->count;
  s->weight_sum = mcor_zeros(n, sizeof(double));
  s->valid = mcor_zeros(n, 1);
  s->weight_gradient = gradients ? mcor_zeros(n, 3 * sizeof(double)) : NULL;
  bool complete = s->weight_sum && s->valid && (s->weight_gradient || !gradients);
  for (int a = 0; a < input->attribute_count && complete; ++a)
  {
    if (s->attribute_not_finite[a] >= 0)
    {
      continue;
    }
    const size_t width = (size_t)mcor_components(&input->attributes[a]);
    s->values[a] = mcor_zeros(n, width * sizeof(double));
    complete = s->values[a] != NULL;
    if (gradients && complete)
    {
      s->gradients[a] = mcor_zeros(n, 3 * width * sizeof(double));
      complete = s->gradients[a] != NULL;
    }
  }
  MCOR_RETURN_IF(!complete, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld points could not be allocated.", (long long)s->count);
  return MCOR_OK;
}

/* The tables of the attributes. */
static mcor_status mcor_make_tables(
  mcor_context* context, const mcor_input* input, bool gradients, mcor_samples* s)
{
  const size_t arrays = (size_t)input->attribute_count;
  s->values = mcor_zeros(arrays, sizeof(double*));
  s->gradients = gradients ? mcor_zeros(arrays, sizeof(double*)) : NULL;
  s->attribute_not_finite = mcor_zeros(arrays, sizeof(int64_t));
  s->attribute_count = input->attribute_count;
  MCOR_RETURN_IF(!s->values || (gradients && !s->gradients) || !s->attribute_not_finite, context,
    MCOR_OUT_OF_CAPACITY, "Host memory ran out.");
  return mcor_list_components(context, input, s->attribute_not_finite);
}

typedef struct mcor_probe_call
{
  const mcor_array* points;
  int64_t count;
  bool is_sum, uses_solids;
  mcor_samples* samples;
} mcor_probe_call;

static mcor_status mcor_run_probe(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  const mcor_probe_call* call = data;
  mcor_samples* samples = call->samples;
  const bool gradients = options->gradients;
  mcor_free_samples(samples); /* of an attempt before */
  samples->count = call->count;
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_TRY(mcor_make_tables(context, input, gradients, samples));
  MCOR_TRY(mcor_make_samples(context, input, gradients, samples));
  if (input->count == 0 || call->count == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_prepare(context, input, options, call->uses_solids));
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_CORRECTION, 0.2, 0.2));
  mcor_probe_run run = { .context = context,
    .input = input,
    .points = call->points,
    .samples = samples,
    .is_sum = call->is_sum };
  const mcor_status status = mcor_probe_all(&run);
  mcor_release_probe(&run);
  mcor_release(context, &context->attributes.sorted);
  MCOR_TRY(status);
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* What evaluates arrays, but no scalar, runs as for the free surface: without solids, but where these
 * count in computed volumes. Sets the options; returns whether solids are used. */
bool mcor_evaluate_without_scalar(const mcor_input* input, mcor_options* options)
{
  const bool uses_solids =
    options->field != MCOR_WEIGHT_SUM && !input->ignore_solids && mcor_needs_density(input);
  options->field = MCOR_WEIGHT_SUM;
  options->iso_count = 0;
  options->has_box = 0;
  options->globals = NULL;
  options->ranks = NULL;
  for (int i = 0; i < 6; ++i)
  {
    options->periodic[i] = 0;
  }
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
  MCOR_RETURN_IF(!input || !options || count < 0 || (count > 0 && (!points || !points->data)),
    context, MCOR_INVALID_ARGUMENT, "Input, options or points are missing.");
  mcor_options own = *options;
  mcor_probe_call call = { points, count, options->field == MCOR_SUM,
    mcor_evaluate_without_scalar(input, &own), samples };
  const mcor_status status =
    mcor_run_call(context, input, &own, &samples->statistics, mcor_run_probe, &call);
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
  for (int a = 0; a < samples->attribute_count; ++a)
  {
    free(samples->values ? samples->values[a] : NULL);
    free(samples->gradients ? samples->gradients[a] : NULL);
  }
  free(samples->values);
  free(samples->gradients);
  free(samples->attribute_not_finite);
  free(samples->weight_sum);
  free(samples->weight_gradient);
  free(samples->valid);
  *samples = (mcor_samples){ 0 };
}
