/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Lines of gauges: their samples, and their readings.
 *
 * Ranks share lines sample by sample. A rank owns the samples in cells of its box. It also looks
 * at two more on either side, so it finds there the same as one process does. */

#include "mcor_box.h"
#include "mcor_gauge.h"
#include "mcor_vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_GAUGE_STEP 0.25 /* in smallest scaled smoothing lengths */
#define MCOR_GAUGE_LEAST_STEPS 4
/* Most samples of one line. */
#define MCOR_GAUGE_MOST (1 << 26)

/* ---- lines ---- */

/* Returns the length of a line. hypot does not have the same bits everywhere. */
static double mcor_gauge_length(const mcor_gauge_line* line)
{
  double way[3], most = 0, sum = 0;
  int exponent;
  mcor_subtract(line->to, line->from, way);
  for (int a = 0; a < 3; ++a)
  {
    most = fmax(most, fabs(way[a]));
  }
  frexp(most, &exponent);
  for (int a = 0; a < 3; ++a)
  {
    way[a] = ldexp(way[a], -exponent);
    sum += way[a] * way[a];
  }
  return ldexp(sqrt(sum), exponent);
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

mcor_status mcor_check_line(mcor_context* context, const mcor_gauge_line* line, int64_t number)
{
  const mcor_gauge_label label = mcor_label_gauge(line->name, number);
  const double *from = line->from, *to = line->to, length = mcor_gauge_length(line);
  for (int a = 0; a < 3; ++a)
  {
    MCOR_RETURN_IF(!isfinite(from[a]) || !isfinite(to[a]), context, MCOR_INVALID_ARGUMENT,
      "Gauge %s has an end that is not finite, (%g, %g, %g) or (%g, %g, %g). Give it two points.",
      label.text, from[0], from[1], from[2], to[0], to[1], to[2]);
  }
  MCOR_RETURN_IF(!(length > 0), context, MCOR_INVALID_ARGUMENT,
    "Gauge %s has no length: both its ends are at (%g, %g, %g). Give it two points.", label.text,
    from[0], from[1], from[2]);
  MCOR_RETURN_IF(!isfinite(length), context, MCOR_INVALID_ARGUMENT,
    "Gauge %s is too long for its length to be a number. Shorten it.", label.text);
  return MCOR_OK;
}

/* ---- samples ---- */

double mcor_gauge_step(double h_scale, double smoothing_length_min)
{
  return MCOR_GAUGE_STEP * h_scale * smoothing_length_min;
}

/* Appends own samples with up to two neighbours on either side. */
static mcor_status mcor_append_samples(
  mcor_gauge_job* job, const mcor_gauge_samples* whole, int64_t own_first, int64_t own_last)
{
  mcor_gauge_samples samples = *whole;
  samples.begin = whole->first;
  samples.own_first = own_first;
  samples.own_last = own_last;
  samples.first = own_first - 2 > whole->first ? own_first - 2 : whole->first;
  samples.last = own_last + 2 < whole->last ? own_last + 2 : whole->last;
  MCOR_APPEND(job->context, &job->samples, samples);
  return MCOR_OK;
}

void mcor_own_cells(const mcor_context* context, const double* box, double cells[3][2])
{
  const mcor_lattice* lattice = &context->lattice;
  for (int a = 0; a < 3; ++a)
  {
    const bool periodic = lattice->period[a] > 0;
    cells[a][0] = periodic ? lattice->period_first[a] : (double)lattice->first[a];
    cells[a][1] = periodic ? cells[a][0] + lattice->period[a] : (double)lattice->last[a];
    mcor_place_sides(lattice, a, box, cells[a]);
  }
}

bool mcor_owns_point(const mcor_context* context, const double point[3], double cells[3][2])
{
  const mcor_lattice* lattice = &context->lattice;
  for (int a = 0; a < 3; ++a)
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
    if (cell < cells[a][0] || cell >= cells[a][1])
    {
      return false;
    }
  }
  return true;
}

static mcor_status mcor_append_owned(mcor_gauge_job* job, const mcor_gauge_samples* whole)
{
  double cells[3][2], point[3];
  mcor_own_cells(job->context, job->box, cells);
  const mcor_gauge_line* line = &job->lines[whole->line];
  int64_t begin = -1;
  for (int64_t i = whole->first; i <= whole->last + 1; ++i)
  {
    mcor_point_between(line->from, line->to, (double)i / (double)whole->steps, point);
    const bool owned = i <= whole->last && mcor_owns_point(job->context, point, cells);
    if (owned && begin < 0)
    {
      begin = i;
    }
    else if (!owned && begin >= 0)
    {
      MCOR_TRY(mcor_append_samples(job, whole, begin, i - 1));
      begin = -1;
    }
  }
  return MCOR_OK;
}

mcor_status mcor_plan_line(mcor_gauge_job* job, int64_t number)
{
  mcor_context* context = job->context;
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
      continue; /* along a period, particles are everywhere */
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
  const bool whole_is_countable = steps < 4e15; /* doubles can then tell places on it apart */
  MCOR_RETURN_IF(last - first >= MCOR_GAUGE_MOST || !whole_is_countable, context,
    MCOR_OUT_OF_CAPACITY,
    "Gauge %s needs %.3g sample points, one every quarter of the smallest smoothing length %g; the "
    "limit is %.3g. Shorten the gauge.",
    mcor_label_gauge(line->name, number).text, (whole_is_countable ? last - first : steps) + 1,
    context->measure.h_min, whole_is_countable ? (double)MCOR_GAUGE_MOST : 4e15);
  mcor_gauge_samples whole = {
    .line = number, .steps = (int64_t)steps, .first = (int64_t)first, .last = (int64_t)last
  };
  if (whole.last - whole.first < 2) /* a parabola needs three samples */
  {
    whole.first = whole.first >= 2 ? whole.last - 2 : 0;
    whole.last = whole.first + 2;
  }
  return job->box ? mcor_append_owned(job, &whole)
                  : mcor_append_samples(job, &whole, whole.first, whole.last);
}

/* ---- readings ---- */

/* Makes the reading of a line from its crossings, which are places before and lengths after. */
static void mcor_read_line(
  const mcor_gauge_line* line, bool full, mcor_gauge_reading* r, double* crossings)
{
  double* at = crossings + r->first_crossing;
  const int64_t n = r->crossing_count;
  const double length = mcor_gauge_length(line);
  r->state = full ? MCOR_GAUGE_FULL : n > 0 ? MCOR_GAUGE_WET : MCOR_GAUGE_DRY;
  r->first = r->last = NAN;
  r->depth = 0;
  /* Crossings alternate. The end of the line tells whether the last one led into the fluid. */
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

mcor_status mcor_read_lines(
  const mcor_gauge_job* job, const mcor_gauge_place* records, int64_t count)
{
  mcor_gauges* gauges = job->gauges;
  mcor_gauge_place* sorted = malloc((size_t)(count + 1) * sizeof *sorted);
  gauges->readings = calloc((size_t)job->line_count + 1, sizeof *gauges->readings);
  gauges->crossings = calloc((size_t)count + 1, sizeof *gauges->crossings);
  if (!sorted || !gauges->readings || !gauges->crossings)
  {
    free(sorted);
    return mcor_allocated(job->context, false);
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
    mcor_read_line(&job->lines[l], full, reading, gauges->crossings);
  }
  free(sorted);
  return MCOR_OK;
}
