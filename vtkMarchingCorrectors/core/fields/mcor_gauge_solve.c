/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Crossings of the level along lines, from weight sums. All lines go through each step together,
 * so the device has many points at a time.
 *
 * Samples are a quarter of a smoothing length apart. The weight sum is as smooth as the kernel,
 * so it is almost a parabola over that distance. A parabola through three samples goes beyond
 * the middle one by at most an eighth of their differences. If the middle sample is nearer to the
 * level than four times this, the part is looked at more finely. */

#include "mcor_gauge.h"
#include "mcor_vector.h"

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
  free(job->samples.of);
  free(job->records.of);
  free(job->changed.of);
  free(job->suspects.of);
  free(job->divided.of);
  free(job->inner.of);
  free(job->weights);
}

/* Evaluates the weight sums at the inner places. */
static mcor_status mcor_gauge_weights(mcor_gauge_job* job)
{
  double* points = (double*)job->base.run->points->data;
  const int64_t count = job->inner.count;
  free(job->weights);
  job->weights = malloc(((size_t)count + 1) * sizeof *job->weights);
  MCOR_TRY(mcor_allocated(job->base.context, job->weights));
  for (int64_t first = 0; first < count; first += MCOR_GAUGE_BATCH)
  {
    const int64_t rest = count - first;
    const int n = rest < MCOR_GAUGE_BATCH ? (int)rest : MCOR_GAUGE_BATCH;
    for (int i = 0; i < n; ++i)
    {
      const mcor_gauge_place* at = &job->inner.of[first + i];
      const mcor_gauge_line* line = &job->lines[at->line];
      mcor_point_between(line->from, line->to, at->place, points + 3 * i);
    }
    MCOR_TRY(mcor_sample_level(&job->base, job->weights + first, n));
  }
  return MCOR_OK;
}

/* Weight sums at evenly spaced places of a line. */
typedef struct mcor_gauge_row
{
  int64_t line, count;
  const mcor_gauge_samples* samples; /* of a line; NULL: the row is of a part */
  double first, step, last;          /* the first place; the step; the last place */
  const double* weight;              /* [count] */
} mcor_gauge_row;

static double mcor_row_place(const mcor_gauge_row* row, int64_t i)
{
  return i + 1 == row->count ? row->last : row->first + (double)i * row->step;
}

/* Whether this call owns place i of a row. */
static bool mcor_owns_place(const mcor_gauge_job* job, const mcor_gauge_row* row, int64_t i)
{
  double point[3];
  if (!row->samples || !job->base.has_box)
  {
    return true;
  }
  const double place = (double)(row->samples->first + i) / (double)row->samples->steps;
  mcor_point_between(job->lines[row->line].from, job->lines[row->line].to, place, point);
  return mcor_owns_point(&job->base, point);
}

static mcor_status mcor_append_part(const mcor_gauge_job* job, mcor_gauge_parts* parts,
  const mcor_gauge_row* row, int64_t low, int64_t high)
{
  MCOR_APPEND(job->base.context, parts,
    (mcor_gauge_part){ row->line, mcor_row_place(row, low), mcor_row_place(row, high),
      row->weight[low], row->weight[high] });
  return MCOR_OK;
}

/* Whether the weight sum may pass the level and come back next to sample i. Sample i must be nearer
 * to the level than its neighbours, and on the same side of the level. */
static bool mcor_row_suspect(double level, const mcor_gauge_row* row, int64_t i)
{
  const int64_t last = row->count - 1, at = i == 0 ? 1 : i == last ? last - 1 : i;
  const double *weight = row->weight, here = fabs(weight[i] - level);
  double most = 0;
  for (int64_t j = i - 1; j <= i + 1; j += 2)
  {
    if (j >= 0 && j <= last)
    {
      const double there = fabs(weight[j] - level);
      if ((weight[j] >= level) != (weight[i] >= level) || there < here || (there == here && j < i))
      {
        return false;
      }
      most = fmax(most, there - here);
    }
  }
  const double bend = weight[at - 1] - 2 * weight[at] + weight[at + 1];
  return here <= MCOR_GAUGE_NEAR * fmax(most, fabs(bend)) && (most > 0 || bend != 0);
}

/* Appends the parts of a row with a crossing, and, if suspects is not NULL, the parts with an
 * extremum to look at. */
static mcor_status mcor_scan_row(
  mcor_gauge_job* job, const mcor_gauge_row* row, mcor_gauge_parts* suspects, bool* found)
{
  const double level = job->base.level;
  *found = false;
  for (int64_t i = 0; i < row->count; ++i)
  {
    const int64_t low = i > 0 ? i - 1 : 0, high = i + 1 < row->count ? i + 1 : i;
    const bool crossed = (row->weight[i] >= level) != (row->weight[high] >= level);
    const bool suspect = suspects && mcor_row_suspect(level, row, i);
    if ((crossed || suspect) && mcor_owns_place(job, row, i))
    {
      *found = *found || crossed;
      MCOR_TRY(crossed ? mcor_append_part(job, &job->changed, row, i, high) : MCOR_OK);
      MCOR_TRY(suspect ? mcor_append_part(job, suspects, row, low, high) : MCOR_OK);
    }
  }
  return MCOR_OK;
}

/* Divides parts into sections, and replaces them by the sections with a crossing or a suspect
 * extremum. If a suspect part has crossings, they become changed parts, and its suspect extrema are
 * dropped. one: each part keeps only its first crossing. */
static mcor_status mcor_look_closer(
  mcor_gauge_job* job, mcor_gauge_parts* parts, int sections, bool one)
{
  const bool suspects = parts == &job->suspects;
  const mcor_gauge_parts whole = *parts;
  *parts = job->divided;
  job->divided = whole;
  parts->count = job->inner.count = 0;
  for (int64_t p = 0; p < whole.count; ++p)
  {
    const mcor_gauge_part* part = &whole.of[p];
    for (int i = 1; i < sections; ++i)
    {
      MCOR_APPEND(job->base.context, &job->inner,
        (mcor_gauge_place){ part->line, part->low + (part->high - part->low) * i / sections });
    }
  }
  MCOR_TRY(mcor_gauge_weights(job));
  for (int64_t p = 0; p < whole.count; ++p)
  {
    const mcor_gauge_part* part = &whole.of[p];
    double weight[MCOR_GAUGE_FINER + 1];
    weight[0] = part->low_weight;
    memcpy(weight + 1, job->weights + p * (sections - 1), (size_t)(sections - 1) * sizeof *weight);
    weight[sections] = part->high_weight;
    const mcor_gauge_row row = { part->line, sections + 1, NULL, part->low,
      (part->high - part->low) / sections, part->high, weight };
    const int64_t before = parts->count;
    bool found = false;
    MCOR_TRY(mcor_scan_row(job, &row, suspects ? parts : NULL, &found));
    if (found && (suspects || one))
    {
      parts->count = suspects ? before : before + 1;
    }
  }
  return MCOR_OK;
}

mcor_status mcor_gauge_samples_of(mcor_gauge_job* job, int64_t first, int64_t last)
{
  job->changed.count = job->suspects.count = job->inner.count = 0;
  for (int64_t l = first; l < last; ++l)
  {
    const mcor_gauge_samples* s = &job->samples.of[l];
    for (int64_t i = s->first; i <= s->last; ++i)
    {
      MCOR_APPEND(job->base.context, &job->inner,
        (mcor_gauge_place){ s->line, (double)i / (double)s->steps });
    }
  }
  MCOR_TRY(mcor_gauge_weights(job));
  const double* weight = job->weights;
  for (int64_t l = first; l < last; ++l)
  {
    const mcor_gauge_samples* s = &job->samples.of[l];
    const double begin = (double)s->first / (double)s->steps, step = 1 / (double)s->steps;
    const int64_t end = s->last - s->first;
    const mcor_gauge_row row = { s->line, end + 1, s, begin, step, begin + (double)end * step,
      weight };
    bool found, reached = false;
    MCOR_TRY(mcor_scan_row(job, &row, &job->suspects, &found));
    for (int64_t i = 0; i <= end && !reached; ++i)
    {
      reached = weight[i] != 0;
    }
    if (reached)
    {
      MCOR_APPEND(
        job->base.context, &job->records, (mcor_gauge_place){ s->line, MCOR_GAUGE_REACHED });
    }
    if (s->last == s->steps && weight[end] >= job->base.level && mcor_owns_place(job, &row, end))
    {
      MCOR_APPEND(
        job->base.context, &job->records, (mcor_gauge_place){ s->line, MCOR_GAUGE_ENDS_IN });
    }
    weight += row.count;
  }
  for (int round = 0; round < MCOR_GAUGE_EXTREMUM_ROUNDS && job->suspects.count > 0; ++round)
  {
    MCOR_TRY(mcor_look_closer(job, &job->suspects, MCOR_GAUGE_FINER, false));
  }
  /* Only the first round may find several crossings in a part; later ones would be rounding. */
  for (int round = 0; round < MCOR_GAUGE_SOLVE_ROUNDS && job->changed.count > 0; ++round)
  {
    MCOR_TRY(mcor_look_closer(job, &job->changed, MCOR_GAUGE_SECTIONS, round > 0));
  }
  for (int64_t p = 0; p < job->changed.count; ++p)
  {
    const mcor_gauge_part* part = &job->changed.of[p];
    const double rise = part->high_weight - part->low_weight;
    const double share = rise != 0 ? (job->base.level - part->low_weight) / rise : 0.5;
    const double place = part->low + (part->high - part->low) * fmin(fmax(share, 0), 1);
    MCOR_APPEND(job->base.context, &job->records, (mcor_gauge_place){ part->line, place });
  }
  return MCOR_OK;
}
