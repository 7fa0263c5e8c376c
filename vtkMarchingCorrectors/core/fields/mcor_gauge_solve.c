/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Crossings of the level along lines, from weight sums. All lines go through each step together,
 * so the device has many points at a time.
 *
 * Samples are a quarter of a smoothing length apart. The weight sum is as smooth as the kernel,
 * so it is almost a parabola over that distance. A parabola through three samples goes beyond
 * the middle one by at most an eighth of their differences. If the level is nearer than four
 * times that, the part is looked at more finely. */

#include "mcor_gauge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_GAUGE_FINER 16   /* sections of a part with an extremum */
#define MCOR_GAUGE_SECTIONS 8 /* sections of a part with a crossing */
/* Rounds, after which an extremum is known to 1e-7 of a smoothing length, a crossing to 1e-8. */
#define MCOR_GAUGE_EXTREMUM_ROUNDS 7
#define MCOR_GAUGE_SOLVE_ROUNDS 8
#define MCOR_GAUGE_NEAR 0.5

void mcor_free_gauge_parts(mcor_gauge_job* job)
{
  free(job->samples);
  free(job->records);
  free(job->changed.parts);
  free(job->suspects.parts);
  job->samples = NULL;
  job->records = NULL;
  job->changed = job->suspects = (mcor_gauge_parts){ 0 };
}

/* Evaluates weight sums at places on lines. */
static mcor_status mcor_gauge_weights(
  mcor_gauge_job* job, int64_t count, const int64_t* line, const double* place, double* weight)
{
  mcor_probe_run* run = job->run;
  double* points = (double*)run->points->data;
  memset(weight, 0, (size_t)count * sizeof *weight);
  for (int64_t first = 0; first < count; first += MCOR_GAUGE_BATCH)
  {
    const int64_t rest = count - first;
    const int n = rest < MCOR_GAUGE_BATCH ? (int)rest : MCOR_GAUGE_BATCH;
    for (int i = 0; i < 3 * n; ++i)
    {
      const mcor_gauge_line* l = &job->lines[line[first + i / 3]];
      const int a = i % 3;
      points[i] = l->from[a] + place[first + i / 3] * (l->to[a] - l->from[a]);
    }
    for (int i = 0; i < n && job->map; ++i)
    {
      double at[3];
      memcpy(at, points + 3 * i, sizeof at);
      job->map(job->map_data, at, points + 3 * i);
    }
    run->samples->weight_sum = weight + first;
    MCOR_TRY(mcor_report_launch(job->context));
    MCOR_TRY(mcor_probe_batch(run, 0, n));
  }
  return MCOR_OK;
}

/* Weight sums at evenly spaced places of a line. */
typedef struct mcor_gauge_row
{
  int64_t line, count;
  int64_t own_first, own_last; /* see mcor_gauge_samples; counted in this row */
  int64_t before;              /* number of places on the line before this row */
  double first, step,
    last; /* first: of the line's first place; step: between places; last: of this row's last place */
  const double* weight; /* [count] */
} mcor_gauge_row;

static double mcor_row_place(const mcor_gauge_row* row, int64_t i)
{
  return i + 1 == row->count ? row->last : row->first + (double)(row->before + i) * row->step;
}

/* Returns the distance of sample i from the level. */
static double mcor_row_distance(const mcor_gauge_job* job, const mcor_gauge_row* row, int64_t i)
{
  return fabs(row->weight[i] - job->level);
}

static bool mcor_row_above(const mcor_gauge_job* job, const mcor_gauge_row* row, int64_t i)
{
  return row->weight[i] >= job->level;
}

static mcor_status mcor_append_part(const mcor_gauge_job* job, mcor_gauge_parts* parts,
  const mcor_gauge_row* row, int64_t low, int64_t high)
{
  MCOR_TRY(mcor_make_room(
    job->context, (void**)&parts->parts, parts->count, &parts->capacity, sizeof *parts->parts));
  parts->parts[parts->count++] = (mcor_gauge_part){ .line = row->line,
    .low = mcor_row_place(row, low),
    .high = mcor_row_place(row, high),
    .low_weight = row->weight[low],
    .high_weight = row->weight[high] };
  return MCOR_OK;
}

/* Whether the weight sum may pass the level and come back next to sample i. Sample i must be
 * nearer to the level than its neighbours, and on their side of it. */
static bool mcor_row_suspect(const mcor_gauge_job* job, const mcor_gauge_row* row, int64_t i)
{
  const int64_t last = row->count - 1, at = i == 0 ? 1 : i == last ? last - 1 : i;
  const double here = mcor_row_distance(job, row, i);
  const bool side = mcor_row_above(job, row, i);
  double most = 0;
  for (int64_t j = i - 1; j <= i + 1; j += 2)
  {
    if (j >= 0 && j <= last)
    {
      const double there = mcor_row_distance(job, row, j);
      if (mcor_row_above(job, row, j) != side || there < here || (there == here && j < i))
      {
        return false;
      }
      most = fmax(most, there - here);
    }
  }
  const double bend = row->weight[at - 1] - 2 * row->weight[at] + row->weight[at + 1];
  return here <= MCOR_GAUGE_NEAR * fmax(most, fabs(bend)) && (most > 0 || bend != 0);
}

/* Appends the parts of a row with a crossing, and, if suspects is not NULL, the parts with an
 * extremum to look at. */
static mcor_status mcor_scan_row(
  mcor_gauge_job* job, const mcor_gauge_row* row, mcor_gauge_parts* suspects, bool* found)
{
  *found = false;
  for (int64_t i = row->own_first; i <= row->own_last && i + 1 < row->count; ++i)
  {
    if (mcor_row_above(job, row, i) != mcor_row_above(job, row, i + 1))
    {
      *found = true;
      MCOR_TRY(mcor_append_part(job, &job->changed, row, i, i + 1));
    }
  }
  for (int64_t i = row->own_first; i <= row->own_last && suspects; ++i)
  {
    if (mcor_row_suspect(job, row, i))
    {
      const int64_t low = i > 0 ? i - 1 : 0, high = i + 1 < row->count ? i + 1 : i;
      MCOR_TRY(mcor_append_part(job, suspects, row, low, high));
    }
  }
  return MCOR_OK;
}

/* Weight sums inside of parts, at count - 1 places between the ends of each. Free with
 * mcor_free_inner. */
typedef struct mcor_gauge_inner
{
  double *place, *weight;
  int64_t* line;
} mcor_gauge_inner;

static void mcor_free_inner(mcor_gauge_inner* inner)
{
  free(inner->place);
  free(inner->weight);
  free(inner->line);
}

static mcor_status mcor_make_inner(const mcor_gauge_job* job, int64_t n, mcor_gauge_inner* inner)
{
  inner->place = calloc((size_t)(n + 1), sizeof *inner->place);
  inner->weight = malloc((size_t)(n + 1) * sizeof *inner->weight);
  inner->line = calloc((size_t)(n + 1), sizeof *inner->line);
  MCOR_TRY(mcor_allocated(job->context, inner->place && inner->weight && inner->line));
  return MCOR_OK;
}

static mcor_status mcor_evaluate_inner(
  mcor_gauge_job* job, const mcor_gauge_parts* parts, int count, mcor_gauge_inner* inner)
{
  const int64_t n = parts->count * (count - 1);
  MCOR_TRY(mcor_make_inner(job, n, inner));
  for (int64_t p = 0, at = 0; p < parts->count; ++p)
  {
    const mcor_gauge_part* part = &parts->parts[p];
    for (int i = 1; i < count; ++i, ++at)
    {
      inner->line[at] = part->line;
      inner->place[at] = part->low + (part->high - part->low) * i / count;
    }
  }
  return mcor_gauge_weights(job, n, inner->line, inner->place, inner->weight);
}

/* Divides parts into sections, and replaces them by the sections with a crossing or a suspect
 * extremum. A suspect with a crossing keeps the crossing alone, among the changed parts. one:
 * each part keeps its first crossing alone. */
static mcor_status mcor_look_closer(
  mcor_gauge_job* job, mcor_gauge_parts* parts, int sections, bool one)
{
  const bool suspects = parts == &job->suspects;
  const mcor_gauge_parts whole = *parts;
  mcor_gauge_inner inner = { 0 };
  *parts = (mcor_gauge_parts){ 0 };
  mcor_status status = mcor_evaluate_inner(job, &whole, sections, &inner);
  for (int64_t p = 0; p < whole.count && status == MCOR_OK; ++p)
  {
    const mcor_gauge_part* part = &whole.parts[p];
    double weight[MCOR_GAUGE_FINER + 1];
    weight[0] = part->low_weight;
    memcpy(weight + 1, inner.weight + p * (sections - 1), (size_t)(sections - 1) * sizeof *weight);
    weight[sections] = part->high_weight;
    const mcor_gauge_row row = { part->line, sections + 1, 0, sections, 0, part->low,
      (part->high - part->low) / sections, part->high, weight };
    const int64_t before = parts->count;
    bool found = false;
    status = mcor_scan_row(job, &row, suspects ? parts : NULL, &found);
    if (found && (suspects || one))
    {
      parts->count = suspects ? before : before + 1;
    }
  }
  mcor_free_inner(&inner);
  free(whole.parts);
  return status;
}

/* Evaluates the weight sums at samples of lines, line after line. */
static mcor_status mcor_evaluate_samples(
  mcor_gauge_job* job, int64_t first, int64_t last, mcor_gauge_inner* inner)
{
  int64_t n = 0;
  for (int64_t l = first; l < last; ++l)
  {
    n += job->samples[l].last - job->samples[l].first + 1;
  }
  MCOR_TRY(mcor_make_inner(job, n, inner));
  n = 0;
  for (int64_t l = first; l < last; ++l)
  {
    const mcor_gauge_samples* samples = &job->samples[l];
    for (int64_t i = samples->first; i <= samples->last; ++i, ++n)
    {
      inner->line[n] = samples->line;
      inner->place[n] = (double)i / (double)samples->steps;
    }
  }
  return mcor_gauge_weights(job, n, inner->line, inner->place, inner->weight);
}

static mcor_status mcor_append_record(mcor_gauge_job* job, int64_t line, double place)
{
  MCOR_TRY(mcor_make_room(job->context, (void**)&job->records, job->record_count, &job->record_room,
    sizeof *job->records));
  job->records[job->record_count++] = (mcor_gauge_record){ line, place };
  return MCOR_OK;
}

static mcor_status mcor_scan_samples(
  mcor_gauge_job* job, int64_t first, int64_t last, const mcor_gauge_inner* inner)
{
  int64_t at = 0;
  for (int64_t l = first; l < last; ++l)
  {
    const mcor_gauge_samples* s = &job->samples[l];
    const double begin = (double)s->begin / (double)s->steps, step = 1 / (double)s->steps;
    const mcor_gauge_row row = { s->line, s->last - s->first + 1, s->own_first - s->first,
      s->own_last - s->first, s->first - s->begin, begin, step,
      begin + (double)(s->last - s->begin) * step, inner->weight + at };
    bool found, reached = false;
    MCOR_TRY(mcor_scan_row(job, &row, &job->suspects, &found));
    for (int64_t i = row.own_first; i <= row.own_last; ++i)
    {
      reached = reached || row.weight[i] != 0;
    }
    MCOR_TRY(reached ? mcor_append_record(job, s->line, MCOR_GAUGE_REACHED) : MCOR_OK);
    const bool ends_in = s->own_last == s->steps && mcor_row_above(job, &row, row.own_last);
    MCOR_TRY(ends_in ? mcor_append_record(job, s->line, MCOR_GAUGE_ENDS_IN) : MCOR_OK);
    at += row.count;
  }
  return MCOR_OK;
}

double mcor_crossing_of(const mcor_gauge_job* job, const mcor_gauge_part* part)
{
  const double rise = part->high_weight - part->low_weight;
  const double share = rise != 0 ? (job->level - part->low_weight) / rise : 0.5;
  return part->low + (part->high - part->low) * fmin(fmax(share, 0), 1);
}

/* Only the first round may find several crossings in a part; later ones would be rounding. */
mcor_status mcor_solve_crossings(mcor_gauge_job* job, int rounds, bool one)
{
  for (int round = 0; round < rounds && job->changed.count > 0; ++round)
  {
    MCOR_TRY(mcor_look_closer(job, &job->changed, MCOR_GAUGE_SECTIONS, one || round > 0));
  }
  return MCOR_OK;
}

mcor_status mcor_gauge_samples_of(mcor_gauge_job* job, int64_t first, int64_t last)
{
  mcor_gauge_inner inner = { 0 };
  job->changed.count = job->suspects.count = 0;
  mcor_status status = mcor_evaluate_samples(job, first, last, &inner);
  status = status == MCOR_OK ? mcor_scan_samples(job, first, last, &inner) : status;
  mcor_free_inner(&inner);
  MCOR_TRY(status);
  for (int round = 0; round < MCOR_GAUGE_EXTREMUM_ROUNDS && job->suspects.count > 0; ++round)
  {
    MCOR_TRY(mcor_look_closer(job, &job->suspects, MCOR_GAUGE_FINER, false));
  }
  MCOR_TRY(mcor_solve_crossings(job, MCOR_GAUGE_SOLVE_ROUNDS, false));
  for (int64_t p = 0; p < job->changed.count; ++p)
  {
    const mcor_gauge_part* part = &job->changed.parts[p];
    MCOR_TRY(mcor_append_record(job, part->line, mcor_crossing_of(job, part)));
  }
  return MCOR_OK;
}
