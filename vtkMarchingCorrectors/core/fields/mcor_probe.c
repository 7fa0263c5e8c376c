/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The probe: Shepard means or sums of particle arrays, and their gradients, at points of the
 * caller's choice. On the device an array is A' = (A - A0) s: A0 is the middle of the range of A,
 * and s is a power of 2. So single precision keeps the digits of an array with a large offset. */

#include "mcor_probe.h"
#include "mcor_box.h"
#include "mcor_plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The most points on the device at a time. Points near each other are evaluated together; in a
 * smaller batch of unordered points, fewer points would be near each other. */
#define MCOR_PROBE_BATCH (1 << 18)

/* Where the fluid's weight is not above this, a mean has no correct digits, and the point is not
 * valid. Equals MCOR_LEAST_SUM of mcor_attribute.cl. */
#define MCOR_LEAST_WEIGHT 1e-30

/* ---- points ---- */

bool mcor_bound_by_box(mcor_context* context, const mcor_options* options)
{
  if (!mcor_has_box(options))
  {
    return false;
  }
  memcpy(context->box.points, options->box, sizeof options->box);
  return context->box.of_points = true;
}

/* Reads positions of points [first, first + count) of the batch, relative to the lattice's origin
 * and in edges of the lattice's cells. */
static void mcor_read_points(
  const mcor_probe_run* run, int64_t first, int count, double at[3][MCOR_CHUNK])
{
  const mcor_lattice* lattice = &run->context->lattice;
  const mcor_box* box = &run->context->box;
  for (int a = 0; a < 3; ++a)
  {
    const double origin = (double)lattice->origin[a], step = (double)lattice->step[a];
    mcor_read_array(run->points, run->first + first, count, a, at[a]);
    for (int i = 0; i < count; ++i)
    {
      at[a][i] = at[a][i] / lattice->edge[a] - origin;
    }
    /* The gradient of MCOR_QUADRATIC is 0 exactly at a particle, but not nearby. So points are
     * rounded as particles are: a point at a particle stays exactly at the particle. */
    for (int i = 0; i < count && run->context->run.options->sph_kernel == MCOR_QUADRATIC; ++i)
    {
      at[a][i] = floor(at[a][i] * step + 0.5) / step;
    }
    /* Points at either end of a period count as within it. Along a period, points are rounded, so
     * that points that are a period apart get the same position. If a point is at an end that is
     * not in the box, it moves to the other end. */
    const double begin = lattice->period_first[a] * step, period = lattice->period[a] * step;
    for (int i = 0; i < count && period > 0; ++i)
    {
      const double fixed = floor(at[a][i] * step + 0.5);
      const bool beyond = !(fixed >= begin && fixed <= begin + period);
      const double within = beyond ? fixed - floor((fixed - begin) / period) * period : fixed;
      const bool off_lower = within == begin && box->first[a] > lattice->period_first[a];
      const bool off_upper =
        within == begin + period && box->last[a] < lattice->period_first[a] + lattice->period[a];
      at[a][i] = (within + (off_lower ? period : off_upper ? -period : 0)) / step;
    }
  }
}

/* Writes each point's node (the lower corner of its lattice cell) and the point's offset from this
 * node, in edges of the cell. Outside of the lattice, where no particle reaches, the node is -1. */
static void mcor_put_points(void* data, int slice, int64_t first, int64_t last)
{
  mcor_probe_run* run = data;
  const mcor_context* context = run->context;
  const mcor_lattice* lattice = &context->lattice;
  mcor_findings found = mcor_no_findings();
  double at[3][MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    mcor_read_points(run, begin, count, at);
    for (int i = 0; i < count; ++i)
    {
      bool located = true;
      for (int a = 0; a < 3; ++a)
      {
        const double x = at[a][i];
        located = located && x >= (double)lattice->first[a] && x <= (double)lattice->last[a];
      }
      found.sums[0] += located;
      for (int a = 0; a < 3; ++a)
      {
        const double x = located ? at[a][i] : -1;
        const cl_int node = (cl_int)x;
        ((cl_int*)run->view.node)[4 * (begin + i) + a] = node;
        mcor_put_real(context, run->view.offset, 4 * (begin + i) + a, x - node);
        found.least[a] = located ? fmin(found.least[a], node) : found.least[a];
        found.most[a] = fmax(found.most[a], node);
      }
    }
  }
  run->slices[slice] = found;
}

/* Writes the caller's points [first, last) to the device. */
static mcor_status mcor_upload_points(mcor_probe_run* run, int64_t first, int64_t last)
{
  mcor_context* context = run->context;
  const size_t n = (size_t)(last - first), real = context->cl.real_size;
  const mcor_mapping views[] = { { &run->batch.in_node, n * 4 * sizeof(cl_int), &run->view.node },
    { &run->batch.in_offset, n * 4 * real, &run->view.offset } };
  MCOR_TRY(mcor_reserve(context, &run->batch.in_node, views[0].bytes));
  MCOR_TRY(mcor_reserve(context, &run->batch.in_offset, views[1].bytes));
  int slices = 0;
  run->first = first;
  run->count = (int)n;
  mcor_status status = mcor_map(context, views[0].buffer, views[0].bytes, true, &run->view.node);
  MCOR_THEN(status, mcor_map(context, views[1].buffer, views[1].bytes, true, &run->view.offset));
  MCOR_THEN(status,
    mcor_parallel_run(context, run->count, MCOR_HEAVY_GRAIN, mcor_put_points, run, &slices));
  const mcor_findings found = mcor_merge_findings(run->slices, slices);
  run->inside = (int)found.sums[0];
  for (int a = 0; a < 3 && run->inside > 0; ++a) /* the box of the points' bricks */
  {
    run->batch.first[a] = (cl_int)found.least[a] >> 2;
    run->batch.bricks[a] = ((cl_int)found.most[a] >> 2) - run->batch.first[a] + 1;
  }
  return mcor_unmap_all(context, views, 2, status);
}

mcor_status mcor_place_particles(mcor_context* context, mcor_point_batch* batch, int first,
  int count, bool has_box, const int cells[3], const int end[3])
{
  const mcor_grid* grid = &context->grid;
  const size_t n = (size_t)count;
  MCOR_TRY(mcor_reserve(context, &batch->in_node, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &batch->in_offset, n * 4 * context->cl.real_size));
  MCOR_TRY(mcor_reserve(context, &context->points.flags, (n + 1) * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_derive_place", MCOR_LIGHT, count, MCOR_INT(first),
    MCOR_INT(count), MCOR_REAL(ldexp(1, context->lattice.fix_bits)), MCOR_EDGE_ARGS(context),
    MCOR_BUFFER(&grid->px), MCOR_BUFFER(&grid->py), MCOR_BUFFER(&grid->pz), MCOR_INT(has_box),
    MCOR_CELL_ARGS(cells, end, 0), MCOR_BUFFER(&batch->in_node), MCOR_BUFFER(&batch->in_offset),
    MCOR_BUFFER(&context->points.flags));
}

void mcor_release_probe(mcor_probe_run* run)
{
  MCOR_RELEASE_BEFORE(run->context, &run->batch, first);
  MCOR_RELEASE(run->context, &run->weight, &run->weight_with_solids, &run->sums,
    &run->weight_gradient, &run->gradients);
}

/* ---- evaluation ---- */

/* Writes a component of an attribute, and its gradient, to the caller's arrays. c: the component's
 * number on the device. i, to: the point's number in the batch, and in the caller's arrays. weight,
 * slope: the weight sum at the point, and its gradient.
 * The component's scale is a power of 2, so dividing by the scale is exact. */
static void mcor_put_component(
  const mcor_probe_run* run, int64_t i, int64_t to, int c, double weight, const double slope[3])
{
  const mcor_context* context = run->context;
  const mcor_attributes* attributes = &context->attributes;
  const mcor_component* component = &attributes->varying[attributes->first + c];
  const mcor_samples* samples = run->samples;
  const int attribute = component->attribute;
  const int64_t at = i * attributes->count + c,
                place =
                  to * mcor_components(&run->input->attributes[attribute]) + component->component;
  const double shift = component->shift, unscale = 1 / component->scale;
  const double sum = mcor_get_real(context, run->view.sums, at), mean = sum / weight;
  /* A mean that rounding took out of the range of the particles' values is moved to the end of the
   * range. Means with M'4, which is partly negative, may lie out of the range and stay there. */
  const bool is_between = !run->is_sum && context->run.options->sph_kernel != MCOR_M_PRIME_4;
  const double low = is_between ? component->low : -INFINITY;
  const double high = is_between ? component->high : INFINITY;
  const double value = run->is_sum ? sum * unscale + shift * weight : mean * unscale + shift;
  samples->values[attribute][place] = value < low ? low : value > high ? high : value;
  for (int a = 0; a < 3 && samples->gradients; ++a)
  {
    const double rise = mcor_get_real(context, run->view.gradients, 3 * at + a);
    samples->gradients[attribute][3 * place + a] =
      (run->is_sum ? rise / component->scale + shift * slope[a]
                   : (rise - mean * slope[a]) / weight / component->scale) /
      context->lattice.cube;
  }
}

static void mcor_put_samples(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_probe_run* run = data;
  const mcor_context* context = run->context;
  const mcor_samples* samples = run->samples;
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t to = run->first + ((const cl_int*)run->view.order)[i];
    const double weight = mcor_get_real(context, run->view.weight, i);
    const bool valid = weight >= context->run.options->node_threshold && weight > MCOR_LEAST_WEIGHT;
    double slope[3] = { 0 };
    samples->weight_sum[to] = weight;
    samples->valid[to] = valid;
    if (run->weights_with_solids)
    {
      run->weights_with_solids[to] = mcor_get_real(context, run->view.weight_with_solids, i);
    }
    for (int a = 0; a < 3 && samples->weight_gradient; ++a)
    {
      slope[a] = mcor_get_real(context, run->view.weight_gradient, 3 * i + a);
      samples->weight_gradient[3 * to + a] = slope[a] / context->lattice.cube;
    }
    for (int c = 0; c < context->attributes.count && valid; ++c)
    {
      mcor_put_component(run, i, to, c, weight, slope);
    }
  }
  (void)slice;
}

mcor_status mcor_probe_batch(mcor_probe_run* run, int64_t first, int64_t last)
{
  mcor_context* context = run->context;
  const mcor_grid* grid = &context->grid;
  MCOR_TRY(mcor_upload_points(run, first, last));
  if (run->inside == 0)
  {
    return MCOR_OK;
  }
  const size_t n = (size_t)run->inside, real = context->cl.real_size,
               arrays = (size_t)context->attributes.count;
  int groups;
  MCOR_TRY(mcor_group_batch(context, &run->batch, run->count, run->inside, &groups));
  MCOR_TRY(mcor_reserve(context, &run->sums, n * arrays * real));
  const int cluster = MCOR_CLUSTER_OF(context->cl.lanes);
  for (int solids = 0; solids <= (run->weights_with_solids != NULL); ++solids)
  {
    mcor_buffer* sum = solids ? &run->weight_with_solids : &run->weight;
    const mcor_buffer* weight = solids ? &grid->trim_weight : mcor_fluid_weight(grid);
    MCOR_TRY(mcor_reserve(context, sum, n * real));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_sums", MCOR_HEAVY, (groups + cluster - 1) / cluster,
      MCOR_WEIGHTED_GRID_ARGS(context, weight), MCOR_INT(groups),
      MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&run->batch.node),
      MCOR_BUFFER(&run->batch.offset), MCOR_BUFFER(sum),
      MCOR_INT(solids ? 0 : context->attributes.count), MCOR_INT(grid->count),
      MCOR_BUFFER(&context->attributes.sorted), MCOR_BUFFER(&run->sums)));
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
  const size_t solids = run->weights_with_solids ? n * real : 0;
  const size_t slopes = run->samples->weight_gradient ? n * 3 * real : 0;
  const mcor_mapping views[] = { { &run->batch.order, n * sizeof(cl_int), &run->view.order },
    { &run->weight, n * real, &run->view.weight },
    { &run->sums, n * arrays * real, &run->view.sums },
    { &run->weight_with_solids, solids, &run->view.weight_with_solids },
    { &run->weight_gradient, slopes, &run->view.weight_gradient },
    { &run->gradients, slopes * arrays, &run->view.gradients } };
  const int count = sizeof views / sizeof *views;
  mcor_status status = mcor_map_all(context, views, count);
  MCOR_THEN(
    status, mcor_parallel_run(context, run->inside, MCOR_HEAVY_GRAIN, mcor_put_samples, run, NULL));
  return mcor_unmap_all(context, views, count, status);
}

/* Whether the device holds this call's attributes already. */
static bool mcor_has_attributes(const mcor_context* context, const mcor_input* input)
{
  return input->attributes_version != 0 && context->attributes.kept == input->attributes_version;
}

/* Evaluates all arrays at all points. Each group of arrays is evaluated at all batches of points
 * before the next group is loaded. */
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

/* Lists the components of the attributes, and allocates the results as zeros. At points that no
 * particle reaches, the zeros stay. */
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

mcor_status mcor_finish_field(mcor_context* context)
{
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* Runs a call of mcor_probe. In two dimensions, turns the points into the plane z = 0, and the
 * gradients back to the caller's axes. */
static mcor_status mcor_run_probe(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_probe_run run = *(const mcor_probe_run*)data;
  mcor_samples* s = run.samples;
  mcor_attributes* attributes = &context->attributes;
  double* flat = NULL;
  run.input = input;
  mcor_free_samples(s); /* results of an earlier attempt */
  s->count = run.point_count;
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_TRY(mcor_make_samples(context, input, options->outputs & MCOR_OUT_GRADIENTS, s));
  if (input->count == 0 || s->count == 0)
  {
    return MCOR_OK;
  }
  mcor_array points = *run.points;
  points.components = 3;
  if (mcor_is_plane(context))
  {
    MCOR_TRY(mcor_flatten_positions(context, run.points, s->count, true, &points, &flat));
  }
  run.points = &points;
  if (!mcor_bound_by_box(context, options))
  {
    /* Only particles near the points are used, unless later calls may reuse the search grid. */
    for (int a = 0; a < 3; ++a)
    {
      const mcor_findings found =
        mcor_find_range(context, &points, NULL, MCOR_SKIP_SOLIDS, s->count, a);
      context->box.points[2 * a] = found.least[0];
      context->box.points[2 * a + 1] = found.most[0];
    }
    context->box.has_points = true;
    context->box.of_points = input->particles_version == 0 || context->run.far;
  }
  mcor_status status = mcor_prepare(context, input, options);
  MCOR_THEN(status, mcor_begin_phase(context, MCOR_PHASE_CORRECTION, 0.2, 0.2));
  if (context->grid.count > 0)
  {
    MCOR_THEN(status, mcor_probe_all(&run));
  }
  mcor_release_probe(&run);
  free(flat);
  /* The attributes stay on the device for the next probe if they have a version, if all of them fit
   * at once and are finite, and if this call has no globals. */
  bool all = attributes->varying_count <= MCOR_ATTRIBUTE_LIMIT && !options->globals;
  for (int a = 0; a < input->attribute_count; ++a)
  {
    all = all && s->attribute_not_finite[a] < 0;
  }
  attributes->kept = all ? input->attributes_version : 0;
  if (attributes->kept == 0)
  {
    mcor_release(context, &attributes->sorted);
  }
  MCOR_TRY(status);
  mcor_unflatten_doubles(&context->plane, s->weight_gradient, s->count, 0);
  for (int a = 0; a < s->attribute_count && s->gradients; ++a)
  {
    const int64_t width = mcor_components(&input->attributes[a]);
    mcor_unflatten_doubles(&context->plane, s->gradients[a], s->count * width, 0);
  }
  return mcor_finish_field(context);
}

/* Sets the options of a call that evaluates arrays but no scalar: the field becomes the weight sum,
 * and there are no iso values, caps, larger cubes or ranks. The box stays only with globals.
 * Returns whether the call uses solids: it does if the caller's field is not the weight sum, solids
 * are not ignored, and the device computes volumes, for which solids count. */
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
  MCOR_FAIL_IF(!context || !samples, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "samples");
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
  return MCOR_OR_FREE(status, mcor_free_samples, samples);
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
