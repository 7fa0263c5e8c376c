/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Projections: column integrals of the SPH sum, averaged over the pixels of an image. This file
 * sets the image's axes and sides, and makes the call. */

#include "mcor_project.h"
#include "mcor_plane.h"
#include "mcor_probe.h"

#include <stdlib.h>
#include <string.h>

#define MCOR_MOST_PIXELS 32768 /* along the longer side */
#define MCOR_MOST_PERIODS 2    /* longest support, in periods; more would need too many images */
#define MCOR_MOST_IMAGES 16    /* longest side of a box, in periods */
#define MCOR_MOST_LENGTHS 1e6  /* longest side of an image without a box, in largest scaled h */

/* ---- the image ---- */

/* Chooses the axes of the image. If the line of sight is along x, y or z, the image has the other
 * two axes, in alphabetical order. Otherwise z points up in the image, or y if the line of sight is
 * nearly along z. */
static mcor_status mcor_choose_axes(mcor_project_job* job)
{
  mcor_context* context = job->context;
  const mcor_plane* plane = &context->plane;
  double(*axes)[3] = (double(*)[3])job->out->axes;
  double sight[3];
  memcpy(sight, job->view->direction, sizeof sight);
  const double largest = fmax(fabs(sight[0]), fmax(fabs(sight[1]), fabs(sight[2])));
  MCOR_FAIL_IF(!isfinite(sight[0]) || !isfinite(sight[1]) || !isfinite(sight[2]), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(DIRECTION_NOT_FINITE), sight[0], sight[1], sight[2]);
  if (largest == 0)
  {
    sight[mcor_plane_axis(plane, 2)] = 1;
  }
  int across = -1;
  for (int a = 0; a < 3; ++a)
  {
    const bool is_along = sight[(a + 1) % 3] == 0 && sight[(a + 2) % 3] == 0;
    across = is_along ? a : across;
  }
  job->is_aligned = across >= 0;
  memset(axes, 0, sizeof job->out->axes);
  if (job->is_aligned)
  {
    axes[0][across == 0 ? 1 : 0] = 1;
    axes[1][across == 2 ? 1 : 2] = 1;
    axes[2][across] = 1;
  }
  else
  {
    for (int a = 0; a < 3; ++a)
    {
      axes[2][a] = sight[a] / largest;
    }
    mcor_normalise(axes[2]);
    const int up = fabs(axes[2][2]) > 0.9 ? 1 : 2;
    for (int a = 0; a < 3; ++a)
    {
      axes[1][a] = (a == up) - axes[2][up] * axes[2][a];
    }
    mcor_normalise(axes[1]);
    mcor_cross(axes[1], axes[2], axes[0]);
  }
  MCOR_FAIL_IF(mcor_is_plane(context) && axes[2][mcor_plane_axis(plane, 2)] != 1, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(DIRECTION_IN_PLANE), mcor_axis_letter(context, 2),
    mcor_axis_letter(context, 2));
  for (int i = 0; i < 9; ++i)
  {
    job->axes[i / 3][i % 3] = axes[i / 3][mcor_plane_axis(plane, i % 3)];
  }
  return MCOR_OK;
}

/* Finds seven ranges over the particles that count for the image. 0, 1: what they reach along the
 * image's axes; 2: their positions along the line of sight; 3 to 5: what they reach along x, y, z;
 * 6: lengths of their kernels, i.e. h times widening factor times h_scale. */
static void mcor_range_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_project_job* job = data;
  mcor_findings found = mcor_no_findings();
  double reach[6];
  for (int k = 0; k < 6; ++k)
  {
    const double unit[3] = { k == 3, k == 4, k == 5 };
    reach[k] = k == 2
      ? 0
      : mcor_column_reach(job->context->run.options->sph_kernel, k < 3 ? job->axes[k] : unit);
  }
  mcor_places p;
  for (; mcor_read_places(job->context, job->input, first, last, &p) > 0; first += p.count)
  {
    for (int i = 0; i < p.count; ++i)
    {
      if (!mcor_is_projected(job, first + i))
      {
        continue;
      }
      const double x[3] = { p.x[0][i], p.x[1][i], p.x[2][i] }, h = p.length[i] * job->h_scale;
      for (int k = 0; k < 6; ++k)
      {
        const double at = k < 3 ? mcor_dot(job->axes[k], x) : x[k - 3];
        mcor_add_range(&found, k, at - reach[k] * h, at + reach[k] * h);
      }
      mcor_add_range(&found, 6, h, h);
    }
  }
  job->slices[slice] = found;
}

/* Finds the sides and the pixels of the image. Along each axis, the image shows the box or, without
 * a box, the period; if there is neither, the image shows all that particles reach. *is_empty: the
 * image has no extent. */
static mcor_status mcor_place_image(mcor_project_job* job, bool* is_empty)
{
  mcor_context* context = job->context;
  mcor_projection* out = job->out;
  mcor_statistics* s = context->run.statistics;
  const double* periodic = context->run.options->periodic;
  const int w = mcor_plane_axis(&context->plane, 2);
  const double support = mcor_support_factor(context->run.options->sph_kernel);
  bool is_bounded = false;
  const bool is_given = mcor_has_sides(job->view->box);
  int slices;
  MCOR_TRY(mcor_parallel_run(
    context, job->input->count, MCOR_HEAVY_GRAIN, mcor_range_slice, job, &slices));
  mcor_findings found = mcor_merge_findings(job->slices, slices);
  const double *low = found.least, *high = found.most;
  MCOR_TRY(mcor_reduce_findings(context, &found));
  for (int a = 0; a < 3; ++a)
  {
    const int axis = mcor_plane_axis(&context->plane, a);
    const double from = is_given ? job->view->box[2 * axis] : -INFINITY,
                 to = is_given ? job->view->box[2 * axis + 1] : INFINITY;
    if (!(from < to) && !(from == to && job->axes[2][a] == 1))
    {
      return mcor_refuse_sides(context, a, from, to);
    }
    job->period[a] = periodic[2 * a + 1] - periodic[2 * a];
    const bool is_periodic = job->period[a] > 0;
    MCOR_FAIL_IF(is_periodic && high[6] * support > MCOR_MOST_PERIODS * job->period[a], context,
      MCOR_INVALID_ARGUMENT, MCOR_SAY(PERIOD_TOO_SHORT), 'x' + axis, job->period[a],
      high[6] * support);
    const bool is_across = a >= context->space.axes; /* in two dimensions the image is the plane */
    for (int i = 2 * a; i < 2 * a + 2; ++i)
    {
      const double given = i % 2 ? to : from, end = i % 2 ? INFINITY : -INFINITY;
      job->box[i] = is_across ? end : isfinite(given) ? given : is_periodic ? periodic[i] : end;
      is_bounded = is_bounded || isfinite(job->box[i]);
    }
    MCOR_FAIL_IF(
      is_periodic && job->box[2 * a + 1] - job->box[2 * a] > MCOR_MOST_IMAGES * job->period[a],
      context, MCOR_INVALID_ARGUMENT, MCOR_SAY(BOX_OF_PERIODS), 'x' + axis, job->box[2 * a],
      job->box[2 * a + 1], MCOR_MOST_IMAGES);
  }
  double from[3] = { low[0], low[1], low[2] }, to[3] = { high[0], high[1], high[2] };
  for (int k = 0; k < 3 && is_bounded; ++k)
  {
    from[k] = to[k] = 0;
    for (int a = 0; a < 3; ++a)
    {
      const int fallback = k == 2 && job->is_aligned ? 2 : 3 + a;
      const double side[2] = { isfinite(job->box[2 * a]) ? job->box[2 * a] : low[fallback],
        isfinite(job->box[2 * a + 1]) ? job->box[2 * a + 1] : high[fallback] };
      from[k] += fmin(job->axes[k][a] * side[0], job->axes[k][a] * side[1]);
      to[k] += fmax(job->axes[k][a] * side[0], job->axes[k][a] * side[1]);
    }
  }
  /* Without particles, there is an image only if the box determines it. */
  const double extent[2] = { to[0] - from[0], to[1] - from[1] };
  *is_empty = !(extent[0] > 0 && extent[1] > 0 && isfinite(extent[0]) && isfinite(extent[1]));
  const int longer = extent[1] > extent[0];
  MCOR_FAIL_IF(!is_given && high[6] > 0 && extent[longer] > MCOR_MOST_LENGTHS * high[6], context,
    MCOR_INVALID_DATA, MCOR_SAY(IMAGE_TOO_LARGE), extent[longer], extent[longer] / high[6]);
  for (int k = 0; k < 2 && !*is_empty; ++k)
  {
    const double pixels = k == longer
      ? job->view->resolution
      : floor(job->view->resolution * (extent[k] / extent[longer]) + 0.5);
    out->size[k] = pixels < 1 ? 1 : (int)pixels;
    out->pixel[k] = extent[k] / out->size[k];
    out->low[k] = from[k];
  }
  out->low[2] = from[2] + context->plane.at * out->axes[6 + w];
  s->dimension = context->run.options->dimension;
  s->smoothing_length_min = low[6] <= high[6] ? low[6] / job->h_scale : 0;
  s->smoothing_length_max = low[6] <= high[6] ? high[6] / job->h_scale : 0;
  return MCOR_OK;
}

/* ---- the call ---- */

static mcor_status mcor_run_project(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_project_job copy = *(const mcor_project_job*)data, *job = &copy;
  const mcor_view* view = job->view;
  job->input = input;
  job->h_scale = options->h_scale;
  mcor_free_projection(job->out); /* results of an earlier attempt */
  mcor_options checked = *options;
  checked.field = mcor_projects_density(input) || job->places_only ? MCOR_WEIGHT_SUM : MCOR_SUM;
  MCOR_TRY(mcor_check_input(context, input, &checked));
  MCOR_FAIL_IF(view->resolution < 1 || view->resolution > MCOR_MOST_PIXELS, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(RESOLUTION_ILLEGAL), view->resolution, MCOR_MOST_PIXELS);
  MCOR_FAIL_IF(view->weight.memory && !view->weight.data, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(WEIGHT_IN_BUFFER), mcor_array_name(&view->weight, ""));
  MCOR_FAIL_IF(view->weight.data && mcor_components(&view->weight) != 1, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(WEIGHT_COMPONENTS), mcor_array_name(&view->weight, "weight"),
    mcor_components(&view->weight));
  MCOR_FAIL_IF(!job->places_only && mcor_projects_density(input) && !mcor_is_given(&input->mass) &&
      !mcor_is_given(&input->density),
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NO_COLUMN_DENSITY));
  /* Makes the search grid if volumes are computed, or a smoothing length is estimated. Otherwise
   * the search grid is not needed, and mcor_check_reuse forgets data that earlier calls kept of
   * other particles. */
  const bool computes = mcor_needs_density(input) && !job->places_only &&
    (!mcor_projects_density(input) || !mcor_is_given(&input->mass) || job->channels == 2);
  bool is_empty = true;
  mcor_status status = MCOR_OK;
  if (!computes && !input->estimate_smoothing_length)
  {
    mcor_check_reuse(context, input, options);
  }
  else if (input->count > 0)
  {
    mcor_bound_by_box(context, options);
    status = mcor_prepare(context, input, options);
    if (computes)
    {
      MCOR_THEN(status, mcor_read_volumes(context, input, &job->volumes));
    }
  }
  MCOR_THEN(status, mcor_begin_phase(context, MCOR_PHASE_CORRECTION, 0.2, 0.3));
  MCOR_THEN(status, mcor_choose_axes(job));
  MCOR_THEN(status, mcor_place_image(job, &is_empty));
  if (!is_empty && !job->places_only)
  {
    MCOR_THEN(status, mcor_spread_particles(job));
  }
  MCOR_THEN(status, mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  free(job->column.nodes);
  free(job->sums);
  for (int i = 0; i < job->bands; ++i)
  {
    pthread_mutex_destroy(&job->locks[i]);
  }
  free(job->locks);
  free(job->sides);
  free(job->corners);
  free(job->volumes);
  return status;
}

static mcor_status mcor_call_project(mcor_context* context, const mcor_input* input,
  const mcor_options* options, const mcor_view* view, bool places_only, mcor_projection* projection)
{
  MCOR_FAIL_IF(!context || !projection, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "projection");
  *projection = (mcor_projection){ 0 };
  MCOR_FAIL_IF(!input || !options || !view, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "input, options and view");
  mcor_options own = *options;
  mcor_input without = *input;
  without.attributes = NULL;
  without.attribute_count = 0;
  const bool uses_solids = mcor_evaluate_without_scalar(input, &own);
  own.ranks = options->ranks;
  mcor_project_job job = { .context = context,
    .view = view,
    .out = projection,
    .places_only = places_only,
    .channels = view->weight.data ? 2 : 1 };
  const mcor_status status = mcor_run_call(
    context, &without, &own, uses_solids, &projection->statistics, mcor_run_project, &job);
  return MCOR_OR_FREE(status, mcor_free_projection, projection);
}

mcor_status mcor_project(mcor_context* context, const mcor_input* input,
  const mcor_options* options, const mcor_view* view, mcor_projection* projection)
{
  return mcor_call_project(context, input, options, view, false, projection);
}

mcor_status mcor_place_view(mcor_context* context, const mcor_input* input,
  const mcor_options* options, const mcor_view* view, mcor_projection* projection)
{
  return mcor_call_project(context, input, options, view, true, projection);
}

void mcor_free_projection(mcor_projection* projection)
{
  if (projection)
  {
    free(projection->values);
    *projection = (mcor_projection){ .statistics = projection->statistics };
  }
}
