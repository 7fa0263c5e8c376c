/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Gauges: where lines cross the free surface. The probe evaluates the weight sums. */

#include "mcor_gauge.h"
#include "mcor_plane.h"
#include "mcor_ranks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_GAUGE_LEVEL 0.5
/* Samples treated together. */
#define MCOR_GAUGE_TOGETHER (1 << 20)
/* Steps beyond a box up to which the field is evaluated: see mcor_gauge_line.c. */
#define MCOR_GAUGE_MARGIN 2.5

const char* mcor_gauge_state_name(mcor_gauge_state state)
{
  static const char* const names[MCOR_GAUGE_STATE_COUNT] = { "dry", "wet", "full" };
  return (unsigned)state < MCOR_GAUGE_STATE_COUNT ? names[state] : NULL;
}

/* Treats lines together, as many as have about MCOR_GAUGE_TOGETHER samples. */
static mcor_status mcor_gauge_all(mcor_gauge_job* job)
{
  const int64_t count = job->samples.count;
  for (int64_t first = 0, last; first < count; first = last)
  {
    int64_t points = 0;
    for (last = first; last < count && points < MCOR_GAUGE_TOGETHER; ++last)
    {
      points += job->samples.of[last].last - job->samples.of[last].first + 1;
    }
    MCOR_TRY(mcor_report(job->context, "gauges", 0.2 + 0.8 * (double)first / (double)count,
      0.2 + 0.8 * (double)last / (double)count));
    MCOR_TRY(mcor_gauge_samples_of(job, first, last));
  }
  return MCOR_OK;
}

/* ---- the call ---- */

/* The box is one of points, not of cells. */
mcor_status mcor_bound_level(mcor_context* context, const mcor_input* input,
  const mcor_options* options, const double* box, double margin, const mcor_findings* around)
{
  MCOR_RETURN_IF(box && margin > mcor_reach_margin(options, options->globals, 0), context,
    MCOR_INVALID_ARGUMENT,
    "The cube size %g is too small for gauges and fluxes over ranks: a box would lack particles "
    "that they need. Leave the cube size at its default.",
    options->globals->measured.cube);
  for (int a = 0; a < 3; ++a)
  {
    context->box.points[2 * a] = box ? box[2 * a] - margin : around->least[a];
    context->box.points[2 * a + 1] = box ? box[2 * a + 1] + margin : around->most[a];
  }
  context->box.has_points = true;
  /* Other calls may reuse the search grid, unless it is cut to these points. */
  context->box.of_points = box || input->particles_version == 0 || context->run.far;
  return MCOR_OK;
}

mcor_status mcor_run_points(
  mcor_gauge_job* job, const mcor_input* input, mcor_status (*work)(mcor_gauge_job*))
{
  mcor_context* context = job->context;
  double* places = malloc(3 * (size_t)MCOR_GAUGE_BATCH * sizeof *places);
  uint8_t* valid = malloc(MCOR_GAUGE_BATCH);
  mcor_samples samples = { .valid = valid };
  const mcor_array points = { .data = places, .type = MCOR_FLOAT64, .components = 3 };
  mcor_probe_run run = {
    .context = context, .input = input, .points = &points, .samples = &samples
  };
  job->run = &run;
  mcor_status status = mcor_allocated(context, places && valid);
  MCOR_THEN(status, mcor_load_attributes(context, input, 0));
  MCOR_THEN(status, work(job));
  mcor_release_probe(&run);
  free(places);
  free(valid);
  return status;
}

/* Makes the records from the particles of this rank. */
static mcor_status mcor_gauge_particles(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_gauge_job* job)
{
  context->attributes.kept = 0;
  MCOR_TRY(mcor_list_components(context, input, false, NULL));
  if (input->count == 0 || job->line_count == 0)
  {
    return MCOR_OK;
  }
  mcor_findings around = mcor_no_findings();
  for (int64_t i = 0; i < 3 * job->line_count; ++i)
  {
    const mcor_gauge_line* line = &job->lines[i / 3];
    const double from = line->from[i % 3], to = line->to[i % 3];
    mcor_add_range(&around, (int)(i % 3), fmin(from, to), fmax(from, to));
  }
  const double margin = job->box
    ? MCOR_GAUGE_MARGIN * mcor_gauge_step(options->h_scale, options->globals->measured.h_min)
    : 0;
  MCOR_TRY(mcor_bound_level(context, input, options, job->box, margin, &around));
  MCOR_TRY(mcor_prepare(context, input, options));
  for (int64_t i = 0; i < job->line_count && context->grid.count > 0; ++i)
  {
    MCOR_TRY(mcor_plan_line(job, i));
  }
  return context->grid.count > 0 ? mcor_run_points(job, input, mcor_gauge_all) : MCOR_OK;
}

/* Turns the lines and the box into the plane z = 0. */
static mcor_status mcor_flatten_lines(mcor_gauge_job* job, mcor_gauge_line* lines, double box[6])
{
  const mcor_plane* plane = &job->context->plane;
  const int w = mcor_plane_axis(plane, 2);
  for (int64_t i = 0; i < job->line_count; ++i)
  {
    const mcor_gauge_line* line = &job->lines[i];
    const bool off = isfinite(line->from[w]) && isfinite(line->to[w]) &&
      (line->from[w] != plane->at || line->to[w] != plane->at);
    MCOR_RETURN_IF(off, job->context, MCOR_INVALID_ARGUMENT,
      "Gauge %s leaves the plane %c = %.9g of the particles. Give both ends that coordinate.",
      mcor_label_gauge(line->name, i).text, 'x' + w, plane->at);
    lines[i] = *line;
    for (int a = 0; a < 3; ++a)
    {
      const double shift = a == 2 ? plane->at : 0;
      lines[i].from[a] = line->from[mcor_plane_axis(plane, a)] - shift;
      lines[i].to[a] = line->to[mcor_plane_axis(plane, a)] - shift;
    }
  }
  job->lines = lines;
  if (job->box)
  {
    mcor_flatten_sides(plane, job->box, box);
    job->box = box;
  }
  return MCOR_OK;
}

static mcor_status mcor_run_gauge(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_gauge_job job = *(const mcor_gauge_job*)data;
  mcor_gauge_line* flat = malloc((size_t)job.line_count * sizeof *flat + 1);
  double box[6];
  const void* all = NULL;
  int64_t count = 0;
  mcor_free_gauges(job.gauges); /* results of an earlier attempt */
  mcor_status status = mcor_allocated(context, flat);
  if (mcor_is_plane(context))
  {
    MCOR_THEN(status, mcor_flatten_lines(&job, flat, box));
  }
  MCOR_THEN(status, mcor_check_input(context, input, options));
  for (int64_t i = 0; i < job.line_count; ++i)
  {
    MCOR_THEN(status, mcor_check_line(context, &job.lines[i], i));
  }
  MCOR_THEN(status, mcor_gauge_particles(context, input, options, &job));
  MCOR_THEN(status,
    mcor_gather(context, job.records.of, job.records.count, sizeof *job.records.of, &all, &count));
  MCOR_THEN(status, mcor_read_lines(&job, all, count));
  for (int64_t i = 0; i < job.gauges->count; ++i)
  {
    double* place = job.gauges->readings[i].place; /* NaN where dry */
    mcor_unflatten_doubles(&context->plane, place, 1, place[2] + context->plane.at);
  }
  mcor_free_gauge_parts(&job);
  free(flat);
  return status != MCOR_OK || input->count == 0 || job.line_count == 0 ? status
                                                                       : mcor_finish_field(context);
}

mcor_status mcor_begin_level(mcor_context* context, const mcor_options* options, const char* who,
  mcor_input* input, mcor_options* own, double* level, const double** box)
{
  *level =
    options->iso_count > 0 && options->iso_values ? options->iso_values[0] : MCOR_GAUGE_LEVEL;
  MCOR_RETURN_IF(options->iso_count > 1 || !(*level > 0) || !isfinite(*level), context,
    MCOR_INVALID_ARGUMENT,
    "%s need one iso value above 0, the weight sum at which the fluid ends; 0.5 is usual.", who);
  *own = *options;
  mcor_evaluate_without_scalar(input, own);
  own->ranks = options->globals ? options->ranks : NULL;
  own->outputs = 0;
  own->node_threshold = 0;
  if (mcor_has_box(own))
  {
    *box = options->box;
    memset(own->box, 0, sizeof own->box);
    input->particles_version = 0; /* a grid cut by another box must not be reused */
  }
  return MCOR_OK;
}

mcor_status mcor_gauge(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_gauge_line* lines, int64_t count, mcor_gauges* gauges)
{
  if (!context || !gauges)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *gauges = (mcor_gauges){ 0 };
  MCOR_RETURN_IF(!input || !options || count < 0 || (count > 0 && !lines), context,
    MCOR_INVALID_ARGUMENT,
    "input, options and lines must not be NULL, and count must not be negative.");
  mcor_input without = *input;
  mcor_options own;
  mcor_gauge_job job = {
    .context = context, .lines = lines, .line_count = count, .gauges = gauges
  };
  without.attribute_count = 0;
  MCOR_TRY(mcor_begin_level(context, options, "Gauges", &without, &own, &job.level, &job.box));
  const mcor_status status = mcor_run_call(context, &without, &own, mcor_uses_solids(input, &own),
    &gauges->statistics, mcor_run_gauge, &job);
  if (status != MCOR_OK)
  {
    mcor_free_gauges(gauges);
  }
  return status;
}

void mcor_free_gauges(mcor_gauges* gauges)
{
  if (gauges)
  {
    free(gauges->readings);
    free(gauges->crossings);
    *gauges = (mcor_gauges){ .statistics = gauges->statistics };
  }
}
