/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Gauges: where lines go through the free surface. The weight sums are the probe's. */

#include "mcor_gauge.h"
#include "mcor_input.h"
#include "mcor_plane.h"
#include "mcor_probe.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_GAUGE_LEVEL 0.5
#define MCOR_GAUGE_STEP 0.25 /* of the smallest scaled smoothing length */
#define MCOR_GAUGE_LEAST_STEPS 4
/* Points on the device at a time, samples of lines taken together, and of one line at most. */
#define MCOR_GAUGE_BATCH (1 << 18)
#define MCOR_GAUGE_TOGETHER (1 << 20)
#define MCOR_GAUGE_MOST (1 << 26)

const char* mcor_gauge_state_name(mcor_gauge_state state)
{
  static const char* const names[MCOR_GAUGE_STATE_COUNT] = { "dry", "wet", "full" };
  return (unsigned)state < MCOR_GAUGE_STATE_COUNT ? names[state] : NULL;
}

static mcor_status mcor_gauge_batch(
  mcor_probe_run* run, const mcor_gauge_job* job, int count, const int64_t* line, const double* at)
{
  double* points = (double*)run->points->data;
  for (int i = 0; i < count; ++i)
  {
    const mcor_gauge_line* l = &job->lines[line[i]];
    for (int a = 0; a < 3; ++a)
    {
      points[3 * i + a] = l->from[a] + at[i] * (l->to[a] - l->from[a]);
    }
    run->samples->weight_sum[i] = 0;
  }
  return mcor_probe_batch(run, 0, count);
}

/* On the device. */
static mcor_status mcor_gauge_weights(
  mcor_gauge_job* job, int64_t count, const int64_t* line, const double* place, double* weight)
{
  mcor_probe_run* run = job->data;
  for (int64_t first = 0; first < count; first += MCOR_GAUGE_BATCH)
  {
    const int64_t rest = count - first;
    const int n = rest < MCOR_GAUGE_BATCH ? (int)rest : MCOR_GAUGE_BATCH;
    MCOR_TRY(mcor_report_launch(job->context));
    MCOR_TRY(mcor_gauge_batch(run, job, n, line + first, place + first));
    for (int i = 0; i < n; ++i)
    {
      weight[first + i] = run->samples->weight_sum[i];
    }
  }
  return MCOR_OK;
}

/* ---- lines -------------------------------------------------------------------------------- */

static double mcor_gauge_length(const mcor_gauge_line* line)
{
  return hypot(
    hypot(line->to[0] - line->from[0], line->to[1] - line->from[1]), line->to[2] - line->from[2]);
}

static mcor_status mcor_check_line(
  mcor_context* context, const mcor_gauge_line* line, int64_t number)
{
  char name[64];
  snprintf(name, sizeof name, "number %lld", (long long)number);
  const char* which = line->name ? line->name : name;
  for (int a = 0; a < 3; ++a)
  {
    MCOR_RETURN_IF(!isfinite(line->from[a]) || !isfinite(line->to[a]), context,
      MCOR_INVALID_ARGUMENT,
      "Gauge %s has an end that is not finite, (%g, %g, %g) or (%g, %g, %g). Give it two points.",
      which, line->from[0], line->from[1], line->from[2], line->to[0], line->to[1], line->to[2]);
  }
  const double length = mcor_gauge_length(line);
  MCOR_RETURN_IF(!(length > 0) || !isfinite(length), context, MCOR_INVALID_ARGUMENT,
    "Gauge %s has no length: both its ends are at (%g, %g, %g). Give it two points.", which,
    line->from[0], line->from[1], line->from[2]);
  return MCOR_OK;
}

/* The part of a line that particles may reach, as places on it; along periods they are everywhere. */
static void mcor_clip_line(const mcor_context* context, const mcor_gauge_line* line, double clip[2])
{
  const mcor_measure* m = &context->measure;
  clip[0] = 0;
  clip[1] = 1;
  for (int a = 0; a < 3; ++a)
  {
    const double way = line->to[a] - line->from[a];
    if (context->lattice.period[a] > 0)
    {
      continue;
    }
    const double margin = context->lattice.cube;
    const double low = m->low[a] - margin - line->from[a];
    const double high = m->high[a] + margin - line->from[a];
    if (way == 0)
    {
      clip[1] = low <= 0 && high >= 0 ? clip[1] : -1;
    }
    else
    {
      clip[0] = fmax(clip[0], fmin(low / way, high / way));
      clip[1] = fmin(clip[1], fmax(low / way, high / way));
    }
  }
}

static mcor_status mcor_plan_line(
  mcor_context* context, const mcor_gauge_line* line, int64_t number, mcor_gauge_samples* samples)
{
  const double step = MCOR_GAUGE_STEP * context->options->h_scale * context->measure.h_min;
  const double steps = fmax(ceil(mcor_gauge_length(line) / step), MCOR_GAUGE_LEAST_STEPS);
  double clip[2];
  mcor_clip_line(context, line, clip);
  const double first = fmax(floor(clip[0] * steps) - 1, 0);
  const double last = fmin(ceil(clip[1] * steps) + 1, steps);
  if (clip[0] > clip[1])
  {
    *samples = (mcor_gauge_samples){ .steps = 1, .first = 0, .last = -1 };
    return MCOR_OK;
  }
  MCOR_RETURN_IF(last - first >= MCOR_GAUGE_MOST || !(steps < 4e15), context, MCOR_OUT_OF_CAPACITY,
    "Gauge number %lld is to be sampled at %.3g points, a quarter of the smallest smoothing "
    "length, %g, apart; at most %d are possible. Shorten it.",
    (long long)number, last - first + 1, context->measure.h_min, MCOR_GAUGE_MOST);
  *samples = (mcor_gauge_samples){ (int64_t)steps, (int64_t)first, (int64_t)last };
  if (samples->last - samples->first < 2) /* a row of three, for parabolas */
  {
    samples->first = samples->first >= 2 ? samples->last - 2 : 0;
    samples->last = samples->first + 2;
  }
  return MCOR_OK;
}

/* ---- readings ----------------------------------------------------------------------------- */

/* From its crossings, still places on the line, what a line reads. */
static void mcor_read_line(const mcor_gauge_job* job, int64_t number)
{
  mcor_gauge_reading* r = &job->gauges->readings[number];
  const mcor_gauge_line* line = &job->lines[number];
  double* at = job->gauges->crossings + r->first_crossing;
  const int64_t n = r->crossing_count;
  const double length = mcor_gauge_length(line);
  const bool full = job->ends[number] >= job->level;
  r->state = full ? MCOR_GAUGE_FULL : n > 0 ? MCOR_GAUGE_WET : MCOR_GAUGE_DRY;
  r->first = r->last = NAN;
  r->depth = 0;
  /* Crossings alternate, and the line's end tells whether the last one led into the fluid. */
  for (int64_t i = n - (full ? 0 : 1); i >= 0; i -= 2)
  {
    const double end = i < n ? at[i] : 1, begin = i > 0 ? at[i - 1] : 0;
    r->depth += (end - begin) * length;
    r->first = end;
    r->last = isnan(r->last) ? end : r->last;
  }
  for (int a = 0; a < 3; ++a)
  {
    r->place[a] = line->from[a] + r->last * (line->to[a] - line->from[a]);
  }
  r->first *= length;
  r->last *= length;
  for (int64_t i = 0; i < n; ++i)
  {
    at[i] *= length;
  }
}

/* Lines together, as many as are worth it. */
static mcor_status mcor_gauge_all(mcor_gauge_job* job)
{
  const int64_t count = job->gauges->count;
  for (int64_t first = 0, last; first < count; first = last)
  {
    int64_t points = 0;
    for (last = first; last < count && points < MCOR_GAUGE_TOGETHER; ++last)
    {
      points += job->samples[last].last - job->samples[last].first + 1;
    }
    MCOR_TRY(mcor_report(job->context, "gauges", 0.2 + 0.8 * (double)first / (double)count,
      0.2 + 0.8 * (double)last / (double)count));
    MCOR_TRY(mcor_gauge_lines(job, first, last));
  }
  return MCOR_OK;
}

/* ---- the call ----------------------------------------------------------------------------- */

typedef struct mcor_gauge_call
{
  const mcor_gauge_line* lines;
  int64_t count;
  double level;
  bool uses_solids;
  mcor_gauges* gauges;
} mcor_gauge_call;

static void mcor_bound_gauges(mcor_context* context, const mcor_gauge_call* call, double* ends)
{
  for (int64_t i = 0; i < call->count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      ends[6 * i + a] = call->lines[i].from[a];
      ends[6 * i + 3 + a] = call->lines[i].to[a];
    }
  }
  const mcor_array points = { .data = ends, .type = MCOR_FLOAT64, .components = 3 };
  mcor_bound_probe(context, &points, 2 * call->count);
}

/* With the search grid made, and room for a batch. */
static mcor_status mcor_gauge_on_grid(
  mcor_context* context, const mcor_input* input, mcor_gauge_job* job, double* room)
{
  const int64_t count = job->gauges->count;
  for (int64_t i = 0; i < count; ++i)
  {
    MCOR_TRY(mcor_plan_line(context, &job->lines[i], i, &job->samples[i]));
  }
  uint8_t* valid = malloc(MCOR_GAUGE_BATCH);
  MCOR_RETURN_IF(!valid, context, MCOR_OUT_OF_CAPACITY, "Host memory ran out.");
  mcor_samples samples = { .weight_sum = room + 3 * (int64_t)MCOR_GAUGE_BATCH, .valid = valid };
  const mcor_array points = { .data = room, .type = MCOR_FLOAT64, .components = 3 };
  mcor_probe_run run = {
    .context = context, .input = input, .points = &points, .samples = &samples
  };
  job->data = &run;
  mcor_status status = mcor_load_attributes(context, input, 0);
  status = status == MCOR_OK ? mcor_gauge_all(job) : status;
  mcor_release_probe(&run);
  free(valid);
  return status;
}

static mcor_status mcor_gauge_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  const mcor_gauge_call* call = data;
  mcor_gauges* gauges = call->gauges;
  const size_t n = (size_t)call->count;
  mcor_free_gauges(gauges); /* of an attempt before */
  MCOR_TRY(mcor_check_input(context, input, options));
  for (int64_t i = 0; i < call->count; ++i)
  {
    MCOR_TRY(mcor_check_line(context, &call->lines[i], i));
  }
  gauges->readings = calloc(n + 1, sizeof *gauges->readings);
  gauges->crossings = calloc(1, sizeof *gauges->crossings);
  mcor_gauge_job job = { .context = context,
    .evaluate = mcor_gauge_weights,
    .level = call->level,
    .lines = call->lines,
    .gauges = gauges,
    .samples = calloc(n + 1, sizeof *job.samples),
    .ends = calloc(n + 1, sizeof *job.ends) };
  /* Of a batch its points and weights; before, the ends of lines. */
  double* room = calloc(6 * n + 4 * (size_t)MCOR_GAUGE_BATCH, sizeof *room);
  mcor_status status = gauges->readings && gauges->crossings && job.samples && job.ends && room
    ? MCOR_OK
    : mcor_fail(context, MCOR_OUT_OF_CAPACITY,
        "Host memory for %lld gauges could not be allocated.", (long long)n);
  gauges->count = status == MCOR_OK ? call->count : 0;
  context->attributes.kept = 0;
  status = status == MCOR_OK ? mcor_list_components(context, input, NULL) : status;
  if (status == MCOR_OK && input->count > 0 && n > 0)
  {
    if (input->particles_version == 0)
    {
      mcor_bound_gauges(context, call, room); /* no other call takes the search grid */
    }
    status = mcor_prepare(context, input, options, call->uses_solids);
    status = status == MCOR_OK && context->grid.count > 0
      ? mcor_gauge_on_grid(context, input, &job, room)
      : status;
  }
  for (int64_t i = 0; i < gauges->count && status == MCOR_OK; ++i)
  {
    gauges->readings[i].outside |= context->grid.count == 0 || input->count == 0;
    mcor_read_line(&job, i);
  }
  mcor_free_gauge_parts(&job);
  free(job.samples);
  free(job.ends);
  free(room);
  if (status != MCOR_OK || input->count == 0 || n == 0)
  {
    return status;
  }
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* In two dimensions, lines in the plane are turned, and the places on them are turned back. */
static mcor_status mcor_run_gauge(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_gauge_call call = *(const mcor_gauge_call*)data;
  const mcor_plane* plane = &context->plane;
  if (!mcor_is_plane(context) || call.count == 0)
  {
    return mcor_gauge_input(context, input, options, &call);
  }
  mcor_gauge_line* lines = malloc((size_t)call.count * sizeof *lines);
  MCOR_RETURN_IF(!lines, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %lld gauges could not be allocated.", (long long)call.count);
  mcor_status status = MCOR_OK;
  for (int64_t i = 0; i < call.count && status == MCOR_OK; ++i)
  {
    const mcor_gauge_line* line = &call.lines[i];
    const int w = mcor_plane_axis(plane, 2);
    const bool off = isfinite(line->from[w]) && isfinite(line->to[w]) &&
      (line->from[w] != plane->at || line->to[w] != plane->at);
    lines[i] = *line;
    for (int a = 0; a < 3; ++a)
    {
      const double shift = a == 2 ? plane->at : 0;
      lines[i].from[a] = line->from[mcor_plane_axis(plane, a)] - shift;
      lines[i].to[a] = line->to[mcor_plane_axis(plane, a)] - shift;
    }
    if (off)
    {
      status = mcor_fail(context, MCOR_INVALID_ARGUMENT,
        "Gauge %lld leaves the plane %c = %.9g of the particles. Give both ends that coordinate.",
        (long long)i, 'x' + w, plane->at);
    }
  }
  call.lines = lines;
  status = status == MCOR_OK ? mcor_gauge_input(context, input, options, &call) : status;
  for (int64_t i = 0; i < call.gauges->count && status == MCOR_OK; ++i)
  {
    mcor_unflatten_doubles(plane, call.gauges->readings[i].place, 1, plane->at);
  }
  free(lines);
  return status;
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
    MCOR_INVALID_ARGUMENT, "Input, options or lines are missing.");
  const double level =
    options->iso_count > 0 && options->iso_values ? options->iso_values[0] : MCOR_GAUGE_LEVEL;
  MCOR_RETURN_IF(options->iso_count > 1 || !(level > 0) || !isfinite(level), context,
    MCOR_INVALID_ARGUMENT,
    "Gauges need one iso value above 0, the weight sum at which the fluid ends; 0.5 is usual.");
  mcor_options own = *options;
  own.field = MCOR_WEIGHT_SUM;
  const bool uses_solids = mcor_uses_solids(input, &own);
  mcor_evaluate_without_scalar(input, &own);
  memset(own.box, 0, sizeof own.box);
  own.globals = NULL;
  own.gradients = 0;
  own.node_threshold = 0;
  mcor_input without = *input;
  without.attributes = NULL;
  without.attribute_count = 0;
  mcor_gauge_call call = { lines, count, level, uses_solids, gauges };
  const mcor_status status =
    mcor_run_call(context, &without, &own, &gauges->statistics, mcor_run_gauge, &call);
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
