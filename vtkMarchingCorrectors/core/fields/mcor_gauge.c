/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Gauges: where lines cross the free surface. The probe evaluates the weight sums.
 *
 * Ranks share lines sample by sample. A rank owns the samples in cells of its box, the extrema at
 * these samples, and the crossings between each sample and the next. The rank has the particles
 * around two more samples on either side, so it finds the same crossings as one process does. */

#include "mcor_gauge.h"
#include "mcor_box.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_GAUGE_LEVEL 0.5
/* Samples treated together. */
#define MCOR_GAUGE_TOGETHER (1 << 20)
/* Steps beyond a box up to which the field is evaluated. */
#define MCOR_GAUGE_MARGIN 2.5
#define MCOR_GAUGE_STEP 0.25 /* in smallest scaled smoothing lengths */
#define MCOR_GAUGE_LEAST_STEPS 4
/* Most samples of one line. */
#define MCOR_GAUGE_MOST (1 << 26)

const char* mcor_gauge_state_name(mcor_gauge_state state)
{
  static const char* const names[MCOR_GAUGE_STATE_COUNT] = { "dry", "wet", "full" };
  return (unsigned)state < MCOR_GAUGE_STATE_COUNT ? names[state] : NULL;
}

/* ---- lines ---- */

/* Returns the length of a line. Avoids hypot, whose bits are not the same everywhere. */
static double mcor_gauge_length(const mcor_gauge_line* line)
{
  double way[3];
  mcor_subtract(line->to, line->from, way);
  return sqrt(mcor_dot(way, way));
}

mcor_gauge_label mcor_label_gauge(const char* name, int64_t number)
{
  mcor_gauge_label label;
  if (name)
  {
    snprintf(label.text, sizeof label.text, "'%.70s'", name);
  }
  else
  {
    snprintf(label.text, sizeof label.text, "number %lld", (long long)number);
  }
  return label;
}

/* Checks a line, and turns it into the plane z = 0, if the particles lie in a plane. */
static mcor_status mcor_take_line(mcor_gauge_job* job, int64_t number)
{
  mcor_context* context = job->base.context;
  const mcor_plane* plane = &context->plane;
  const mcor_gauge_line* given = &job->given[number];
  const mcor_gauge_label label = mcor_label_gauge(given->name, number);
  const double *from = given->from, *to = given->to, length = mcor_gauge_length(given);
  mcor_gauge_line* line = &job->lines[number];
  *line = *given;
  for (int a = 0; a < 3; ++a)
  {
    const int axis = mcor_plane_axis(plane, a);
    const double shift = a == 2 ? plane->at : 0;
    MCOR_FAIL_IF(!isfinite(from[a]) || !isfinite(to[a]), context, MCOR_INVALID_ARGUMENT,
      MCOR_SAY(GAUGE_NOT_FINITE), label.text, from[0], from[1], from[2], to[0], to[1], to[2]);
    line->from[a] = from[axis] - shift;
    line->to[a] = to[axis] - shift;
    mcor_add_range(
      &job->around, a, fmin(line->from[a], line->to[a]), fmax(line->from[a], line->to[a]));
  }
  MCOR_FAIL_IF(mcor_is_plane(context) && (line->from[2] != 0 || line->to[2] != 0), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(GAUGE_OUT_OF_PLANE), label.text,
    'x' + mcor_plane_axis(plane, 2), plane->at);
  MCOR_FAIL_IF(!(length > 0), context, MCOR_INVALID_ARGUMENT, MCOR_SAY(GAUGE_WITHOUT_LENGTH),
    label.text, from[0], from[1], from[2]);
  MCOR_FAIL_IF(
    !isfinite(length), context, MCOR_INVALID_ARGUMENT, MCOR_SAY(GAUGE_TOO_LONG), label.text);
  return MCOR_OK;
}

/* ---- samples ---- */

/* Returns the greatest distance between samples, L. */
static double mcor_gauge_step(double h_scale, double smoothing_length_min)
{
  return MCOR_GAUGE_STEP * h_scale * smoothing_length_min;
}

bool mcor_owns_point(const mcor_level_job* job, const double point[3])
{
  const mcor_lattice* lattice = &job->context->lattice;
  for (int a = 0; a < 3 && job->has_box; ++a)
  {
    double cell = floor(point[a] / lattice->edge[a] - (double)lattice->origin[a]);
    if (lattice->period[a] > 0)
    {
      cell -= floor((cell - lattice->period_first[a]) / lattice->period[a]) * lattice->period[a];
    }
    else
    {
      cell = fmin(fmax(cell, (double)lattice->first[a]), (double)lattice->last[a] - 1);
    }
    if (cell < job->owned[a][0] || cell >= job->owned[a][1])
    {
      return false;
    }
  }
  return true;
}

/* Appends the samples of a line where particles may reach it. The lattice must be known. */
static mcor_status mcor_plan_line(mcor_gauge_job* job, int64_t number)
{
  mcor_context* context = job->base.context;
  const mcor_gauge_line* line = &job->lines[number];
  const double step = mcor_gauge_step(context->run.options->h_scale, context->measure.h_min);
  const double steps = fmax(ceil(mcor_gauge_length(line) / step), MCOR_GAUGE_LEAST_STEPS);
  const mcor_measure* m = &context->measure;
  double clip[2] = { 0, 1 }; /* the part of the line that particles may reach */
  for (int a = 0; a < 3; ++a)
  {
    const double way = line->to[a] - line->from[a], margin = context->lattice.cube;
    const double low = m->low[a] - margin - line->from[a];
    const double high = m->high[a] + margin - line->from[a];
    if (context->lattice.period[a] > 0)
    {
      continue; /* along a period, particles may be anywhere */
    }
    if (way == 0)
    {
      clip[1] = low <= 0 && high >= 0 ? clip[1] : -1;
      continue;
    }
    clip[0] = fmax(clip[0], fmin(low / way, high / way));
    clip[1] = fmin(clip[1], fmax(low / way, high / way));
  }
  if (clip[0] > clip[1])
  {
    return MCOR_OK;
  }
  const double first = fmax(floor(clip[0] * steps) - 1, 0);
  const double last = fmin(ceil(clip[1] * steps) + 1, steps);
  const bool whole_is_countable =
    steps < 4e15; /* so that doubles can tell places on the line apart */
  MCOR_FAIL_IF(last - first >= MCOR_GAUGE_MOST || !whole_is_countable, context,
    MCOR_OUT_OF_CAPACITY, MCOR_SAY(GAUGE_SAMPLES), mcor_label_gauge(line->name, number).text,
    (whole_is_countable ? last - first : steps) + 1, context->measure.h_min,
    whole_is_countable ? (double)MCOR_GAUGE_MOST : 4e15);
  mcor_gauge_samples whole = {
    .line = number, .steps = (int64_t)steps, .first = (int64_t)first, .last = (int64_t)last
  };
  if (whole.last - whole.first < 2) /* a parabola needs three samples */
  {
    whole.first = whole.first >= 2 ? whole.last - 2 : 0;
    whole.last = whole.first + 2;
  }
  MCOR_APPEND(context, &job->samples, whole);
  return MCOR_OK;
}

/* ---- readings ---- */

/* Makes the reading of a line from its crossings, and turns the crossings from places into
 * lengths. */
static void mcor_read_line(
  const mcor_gauge_line* line, bool full, mcor_gauge_reading* r, double* crossings)
{
  double* at = crossings + r->first_crossing;
  const int64_t n = r->crossing_count;
  const double length = mcor_gauge_length(line);
  r->state = full ? MCOR_GAUGE_FULL : n > 0 ? MCOR_GAUGE_WET : MCOR_GAUGE_DRY;
  r->first = r->last = NAN;
  r->depth = 0;
  /* Crossings lead into and out of the fluid in turn. If `full`, the last one leads into it. */
  for (int64_t i = n - (full ? 0 : 1); i >= 0; i -= 2)
  {
    const double end = i < n ? at[i] : 1, begin = i > 0 ? at[i - 1] : 0;
    r->depth += (end - begin) * length;
    r->first = end;
    r->last = isnan(r->last) ? end : r->last;
  }
  mcor_point_between(line->from, line->to, r->last, r->place);
  r->first *= length;
  r->last *= length;
  for (int64_t i = 0; i < n; ++i)
  {
    at[i] *= length;
  }
}

static int mcor_compare_records(const void* a, const void* b)
{
  const mcor_gauge_place *left = a, *right = b;
  return left->line != right->line ? (left->line < right->line ? -1 : 1)
    : left->place != right->place  ? (left->place < right->place ? -1 : 1)
                                   : 0;
}

/* Makes the readings of all lines from the records of all ranks. */
static mcor_status mcor_read_lines(
  const mcor_gauge_job* job, const mcor_gauge_place* records, int64_t count)
{
  mcor_gauges* gauges = job->gauges;
  mcor_gauge_place* sorted = malloc((size_t)(count + 1) * sizeof *sorted);
  gauges->readings = calloc((size_t)job->line_count + 1, sizeof *gauges->readings);
  gauges->crossings = calloc((size_t)count + 1, sizeof *gauges->crossings);
  if (!sorted || !gauges->readings || !gauges->crossings)
  {
    free(sorted);
    return mcor_allocated(job->base.context, false);
  }
  if (count > 0)
  {
    memcpy(sorted, records, (size_t)count * sizeof *sorted);
  }
  qsort(sorted, (size_t)count, sizeof *sorted, mcor_compare_records);
  gauges->count = job->line_count;
  for (int64_t l = 0, i = 0; l < gauges->count; ++l)
  {
    mcor_gauge_reading* reading = &gauges->readings[l];
    bool full = false;
    *reading = (mcor_gauge_reading){ .outside = 1, .first_crossing = gauges->crossing_count };
    for (; i < count && sorted[i].line == l; ++i)
    {
      full = full || sorted[i].place == MCOR_GAUGE_ENDS_IN;
      reading->outside = reading->outside && sorted[i].place != MCOR_GAUGE_REACHED;
      if (sorted[i].place >= 0)
      {
        reading->crossing_count++;
        gauges->crossings[gauges->crossing_count++] = sorted[i].place;
      }
    }
    mcor_read_line(&job->given[l], full, reading, gauges->crossings);
  }
  free(sorted);
  return MCOR_OK;
}

/* ---- the call ---- */

/* Treats lines together, as many as have about MCOR_GAUGE_TOGETHER samples. */
static mcor_status mcor_gauge_all(mcor_level_job* base)
{
  mcor_gauge_job* job = (mcor_gauge_job*)base;
  const int64_t count = job->samples.count;
  for (int64_t first = 0, last; first < count; first = last)
  {
    int64_t points = 0;
    for (last = first; last < count && points < MCOR_GAUGE_TOGETHER; ++last)
    {
      points += job->samples.of[last].last - job->samples.of[last].first + 1;
    }
    MCOR_TRY(mcor_report(base->context, "gauges", 0.2 + 0.8 * (double)first / (double)count,
      0.2 + 0.8 * (double)last / (double)count));
    MCOR_TRY(mcor_gauge_samples_of(job, first, last));
  }
  return MCOR_OK;
}

/* The box bounds points at which the field is evaluated, not cells. */
mcor_status mcor_bound_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, double margin, const mcor_findings* around)
{
  mcor_context* context = job->context;
  const bool has_box = job->has_box;
  if (has_box && mcor_is_plane(context))
  {
    mcor_flatten_sides(&context->plane, job->box, job->box);
  }
  MCOR_FAIL_IF(has_box && margin > mcor_reach_margin(options, options->globals, 0), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(CUBE_TOO_SMALL_FOR_GAUGES), options->globals->measured.cube);
  for (int a = 0; a < 3; ++a)
  {
    context->box.points[2 * a] = has_box ? job->box[2 * a] - margin : around->least[a];
    context->box.points[2 * a + 1] = has_box ? job->box[2 * a + 1] + margin : around->most[a];
  }
  context->box.has_points = true;
  /* Other calls may reuse the search grid, unless it is cut to these points. */
  context->box.of_points = has_box || input->particles_version == 0 || context->run.far;
  return MCOR_OK;
}

/* The fluid ends where the weight sum T of fluid and solids is below the level, or where the
 * fluid's own sum F is below its share of T. The lowered sum is the lesser of T and of a sum that
 * equals the level where F is exactly this share of T. Far from solids, F equals T, and the lowered
 * sum is F. */
mcor_status mcor_sample_level(mcor_level_job* job, double* weight, int count)
{
  mcor_probe_run* run = job->run;
  const double share = mcor_fluid_share(job->context);
  memset(weight, 0, (size_t)count * sizeof *weight);
  run->samples->weight_sum = weight;
  run->weights_with_solids = job->with_solids;
  MCOR_TRY(mcor_report_launch(job->context));
  MCOR_TRY(mcor_probe_batch(run, 0, count));
  for (int i = 0; i < count && job->with_solids; ++i)
  {
    const double fluid = weight[i], all = job->with_solids[i];
    weight[i] = fluid == 0 || fluid == all
      ? fluid
      : fmin(all, job->level + (fluid - share * all) / (1 - share));
  }
  return MCOR_OK;
}

mcor_status mcor_run_points(
  mcor_level_job* job, const mcor_input* input, mcor_status (*work)(mcor_level_job*))
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
  job->with_solids =
    mcor_ends_at_solids(context) ? malloc(MCOR_GAUGE_BATCH * sizeof *places) : NULL;
  for (int a = 0; a < 3 && job->has_box; ++a)
  {
    const mcor_lattice* lattice = &context->lattice;
    const bool periodic = lattice->period[a] > 0;
    double* cells = job->owned[a];
    cells[0] = periodic ? lattice->period_first[a] : (double)lattice->first[a];
    cells[1] = periodic ? cells[0] + lattice->period[a] : (double)lattice->last[a];
    mcor_place_sides(lattice, a, job->box, cells);
  }
  mcor_status status =
    mcor_allocated(context, places && valid && (job->with_solids || !mcor_ends_at_solids(context)));
  MCOR_THEN(status, mcor_load_attributes(context, input, 0));
  MCOR_THEN(status, work(job));
  mcor_release_probe(&run);
  free(places);
  free(valid);
  free(job->with_solids);
  return status;
}

/* Makes the records from the particles of this rank. */
static mcor_status mcor_gauge_particles(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_gauge_job* job)
{
  MCOR_TRY(mcor_check_input(context, input, options));
  for (int64_t i = 0; i < job->line_count; ++i)
  {
    MCOR_TRY(mcor_take_line(job, i));
  }
  MCOR_TRY(mcor_list_components(context, input, false, NULL));
  if (input->count == 0 || job->line_count == 0)
  {
    return MCOR_OK;
  }
  const double margin = options->globals
    ? MCOR_GAUGE_MARGIN * mcor_gauge_step(options->h_scale, options->globals->measured.h_min)
    : 0;
  MCOR_TRY(mcor_bound_level(&job->base, input, options, margin, &job->around));
  MCOR_TRY(mcor_prepare(context, input, options));
  for (int64_t i = 0; i < job->line_count && context->grid.count > 0; ++i)
  {
    MCOR_TRY(mcor_plan_line(job, i));
  }
  return context->grid.count > 0 ? mcor_run_points(&job->base, input, mcor_gauge_all) : MCOR_OK;
}

static mcor_status mcor_run_gauge(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_gauge_job job = *(const mcor_gauge_job*)data;
  const void* all = NULL;
  int64_t count = 0;
  mcor_free_gauges(job.gauges); /* results of an earlier attempt */
  job.lines = malloc((size_t)job.line_count * sizeof *job.lines + 1);
  mcor_status status = mcor_allocated(context, job.lines);
  MCOR_THEN(status, mcor_gauge_particles(context, input, options, &job));
  MCOR_THEN(status,
    mcor_gather_records(
      context, job.records.of, job.records.count, sizeof *job.records.of, &all, &count));
  MCOR_THEN(status, mcor_read_lines(&job, all, count));
  mcor_free_gauge_parts(&job);
  free(job.lines);
  return status != MCOR_OK || input->count == 0 || job.line_count == 0 ? status
                                                                       : mcor_finish_field(context);
}

mcor_status mcor_call_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, mcor_statistics* statistics)
{
  mcor_input given = *input;
  mcor_options own = *options;
  job->level =
    options->iso_count > 0 && options->iso_values ? options->iso_values[0] : MCOR_GAUGE_LEVEL;
  MCOR_FAIL_IF(options->iso_count > 1 || !(job->level > 0) || !isfinite(job->level), job->context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(FLUID_LEVEL), job->who);
  if (own.wall_share == MCOR_WALL_SHARE_AUTO)
  {
    own.wall_share = MCOR_WALL_SHARE_MEASURED;
  }
  mcor_evaluate_without_scalar(&given, &own);
  own.ranks = options->globals ? options->ranks : NULL;
  own.outputs = 0;
  own.node_threshold = 0;
  job->has_box = mcor_has_box(&own);
  if (job->has_box)
  {
    memcpy(job->box, own.box, sizeof own.box);
    memset(own.box, 0, sizeof own.box);
    given.particles_version = 0; /* a grid cut by another box must not be reused */
  }
  return mcor_run_call(
    job->context, &given, &own, mcor_uses_solids(input, &own), statistics, job->body, job);
}

mcor_status mcor_gauge(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_gauge_line* lines, int64_t count, mcor_gauges* gauges)
{
  if (!context || !gauges)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *gauges = (mcor_gauges){ 0 };
  MCOR_FAIL_IF(!input || !options || count < 0 || (count > 0 && !lines), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_OR_NEGATIVE), "lines");
  mcor_input without = *input;
  without.attribute_count = 0;
  mcor_gauge_job job = { .base = { .context = context, .who = "Gauges", .body = mcor_run_gauge },
    .given = lines,
    .line_count = count,
    .gauges = gauges,
    .around = mcor_no_findings() };
  const mcor_status status = mcor_call_level(&job.base, &without, options, &gauges->statistics);
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
