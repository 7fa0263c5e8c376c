/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Gauges: where lines cross the free surface. All lines go through each step together, so the
 * device has many points at a time.
 *
 * Samples are at most a quarter of the smallest scaled smoothing length apart. Over this distance,
 * the weight sum is almost a parabola. If the middle one of three samples is an extremum, the
 * parabola's own extremum goes beyond this sample by at most an eighth of the greater difference
 * between the samples. To be safe, at least half of this difference is assumed. Where such an
 * extremum may be beyond the level, the line is sampled more finely.
 *
 * Ranks share lines sample by sample. A rank owns the samples in cells of its box, the extrema at
 * these samples, and the crossings between each sample and the next. The rank has the particles
 * around two more samples on either side, so it finds the same crossings as one process does. */

#include "mcor_level.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* About this many samples are treated together. */
#define MCOR_GAUGE_TOGETHER (1 << 20)
/* The field is evaluated up to this many steps beyond the box. */
#define MCOR_GAUGE_MARGIN 2.5
#define MCOR_GAUGE_STEP(options, h_min) (0.25 * (options)->h_scale * (h_min))
#define MCOR_GAUGE_LEAST_STEPS 4
/* MCOR_GAUGE_MOST: the most samples of a line that are evaluated. MCOR_GAUGE_MOST_STEPS: the most
 * steps of a whole line, so that doubles can tell its samples apart. */
#define MCOR_GAUGE_MOST (1 << 26)
#define MCOR_GAUGE_MOST_STEPS 4e15
#define MCOR_GAUGE_FINER 16   /* sections of a part with an extremum */
#define MCOR_GAUGE_SECTIONS 8 /* sections of a part with a crossing */
/* After these rounds, an extremum is known to 1e-7 of a smoothing length, a crossing to 1e-8. */
#define MCOR_GAUGE_EXTREMUM_ROUNDS 7
#define MCOR_GAUGE_SOLVE_ROUNDS 8
#define MCOR_GAUGE_NEAR 0.5

/* A part of a line between two places at which the weight sum is known. Places are numbers from 0,
 * the line's beginning, to 1, its end. */
typedef struct mcor_gauge_part
{
  int64_t line;
  double low, high;
  double low_weight, high_weight;
} mcor_gauge_part;

typedef MCOR_LIST(mcor_gauge_part) mcor_gauge_parts;

/* Weight sums at evenly spaced places of a line, from `first` to `last`, `step` apart. */
typedef struct mcor_gauge_row
{
  int64_t line, count;
  double first, step, last;
  /* If steps > 0, a line has this many steps, the row has the samples that particles may reach, and
   * place i is (sample + i) / steps. If steps is 0, the row divides a part of a line. */
  int64_t steps, sample;
  const double* weight; /* [count] */
} mcor_gauge_row;

/* A place on a line. In job->records, a place from 0 to 1 is where the line crosses the level. The
 * two places below 0 tell other facts about the line. */
#define MCOR_GAUGE_REACHED (-1.0) /* a particle reaches the line */
#define MCOR_GAUGE_ENDS_IN (-2.0) /* the line ends in fluid */
typedef struct mcor_gauge_place
{
  int64_t line;
  double place;
} mcor_gauge_place;

typedef MCOR_LIST(mcor_gauge_place) mcor_gauge_places;

typedef struct mcor_gauge_job
{
  mcor_level_job base;          /* must be first */
  const mcor_gauge_line* given; /* [line_count] */
  mcor_gauge_line* lines;       /* [line_count] `given`, in the device's coordinates */
  int64_t line_count;
  mcor_gauges* gauges;
  MCOR_LIST(mcor_gauge_row) samples;
  mcor_gauge_places records;
  mcor_gauge_parts changed;  /* parts whose ends are on different sides of the level */
  mcor_gauge_parts suspects; /* parts with an extremum that may be beyond the level */
  mcor_gauge_parts divided;  /* parts that are being divided */
  mcor_gauge_places inner;   /* where the field is evaluated */
  double* weights;           /* [inner.count] the weight sums at these places */
} mcor_gauge_job;

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

/* Checks a line, and copies it to job->lines. If the particles lie in a plane, turns the copy into
 * the plane z = 0. */
static mcor_status mcor_take_line(mcor_gauge_job* job, int64_t number)
{
  mcor_context* context = job->base.context;
  const mcor_plane* plane = &context->plane;
  const mcor_gauge_line* given = &job->given[number];
  const mcor_label label = mcor_label_of(given->name, number);
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
      &job->base.around, a, fmin(line->from[a], line->to[a]), fmax(line->from[a], line->to[a]));
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

/* Appends a row with the samples of a line that particles may reach. The lattice must be known. */
static mcor_status mcor_plan_line(mcor_gauge_job* job, int64_t number)
{
  mcor_context* context = job->base.context;
  const mcor_gauge_line* line = &job->lines[number];
  const mcor_measure* m = &context->measure;
  const double step = MCOR_GAUGE_STEP(context->run.options, m->h_min);
  const double steps = fmax(ceil(mcor_gauge_length(line) / step), MCOR_GAUGE_LEAST_STEPS);
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
    /* If `way` is 0, the quotients are infinite: the whole line is in reach, or no part of it. */
    clip[0] = fmax(clip[0], fmin(low / way, high / way));
    clip[1] = fmin(clip[1], fmax(low / way, high / way));
  }
  if (clip[0] > clip[1])
  {
    return MCOR_OK;
  }
  const double first = fmax(floor(clip[0] * steps) - 1, 0);
  const double last = fmin(ceil(clip[1] * steps) + 1, steps);
  const bool is_countable = steps < MCOR_GAUGE_MOST_STEPS;
  const double needed = is_countable ? last - first : steps;
  const double most = is_countable ? MCOR_GAUGE_MOST : MCOR_GAUGE_MOST_STEPS;
  MCOR_FAIL_IF(needed >= most, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(GAUGE_SAMPLES),
    mcor_label_of(line->name, number).text, needed + 1, m->h_min, most);
  const double n = last - first < 2 ? 2 : last - first; /* a parabola needs three samples */
  const double begin = fmax(fmin(first, last - n), 0), sample = begin / steps;
  MCOR_APPEND(context, &job->samples,
    (mcor_gauge_row){ number, (int64_t)n + 1, sample, 1 / steps, sample + n * (1 / steps),
      (int64_t)steps, (int64_t)begin, NULL });
  return MCOR_OK;
}

/* ---- crossings ---- */

/* Evaluates the weight sums at the places job->inner, and writes them to job->weights. */
static mcor_status mcor_gauge_weights(mcor_gauge_job* job)
{
  double* points = (double*)job->base.run->points->data;
  const int64_t count = job->inner.count;
  free(job->weights);
  job->weights = malloc(((size_t)count + 1) * sizeof *job->weights);
  MCOR_TRY(mcor_allocated(job->base.context, job->weights));
  for (int64_t first = 0; first < count; first += MCOR_LEVEL_BATCH)
  {
    const int64_t rest = count - first;
    const int n = rest < MCOR_LEVEL_BATCH ? (int)rest : MCOR_LEVEL_BATCH;
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

static double mcor_row_place(const mcor_gauge_row* row, int64_t i)
{
  return i + 1 == row->count ? row->last : row->first + (double)i * row->step;
}

/* Whether this call owns place i of a row. In a row of samples, a call with a box owns the places
 * in the box's cells. Otherwise the call owns all places. */
static bool mcor_owns_place(const mcor_gauge_job* job, const mcor_gauge_row* row, int64_t i)
{
  double point[3];
  if (row->steps == 0 || !job->base.has_box)
  {
    return true;
  }
  const double place = (double)(row->sample + i) / (double)row->steps;
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

/* Returns whether the weight sum may cross the level twice near sample i. For this, sample i must
 * be on the same side of the level as its neighbours, at most as far from the level as they are,
 * and so near that an extremum may be beyond the level (see the top of this file). */
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

/* Looks at the places of a row that this call owns. Appends to job->changed the parts in which the
 * line crosses the level. If `suspects` is not NULL, appends to `suspects` the parts with an
 * extremum that may be beyond the level. */
static mcor_status mcor_scan_row(
  mcor_gauge_job* job, const mcor_gauge_row* row, mcor_gauge_parts* suspects)
{
  const double level = job->base.level;
  for (int64_t i = 0; i < row->count; ++i)
  {
    const int64_t low = i > 0 ? i - 1 : 0, high = i + 1 < row->count ? i + 1 : i;
    const bool crossed = (row->weight[i] >= level) != (row->weight[high] >= level);
    const bool suspect = suspects && mcor_row_suspect(level, row, i);
    const bool owned = (crossed || suspect) && mcor_owns_place(job, row, i);
    if (owned && crossed)
    {
      MCOR_TRY(mcor_append_part(job, &job->changed, row, i, high));
    }
    if (owned && suspect)
    {
      MCOR_TRY(mcor_append_part(job, suspects, row, low, high));
    }
  }
  return MCOR_OK;
}

/* Divides each part of `parts` into sections, and removes the part. If `parts` is job->changed,
 * puts the sections with a crossing there (one: only the first). If `parts` is job->suspects,
 * appends the sections with a crossing to job->changed; if there are none, puts into job->suspects
 * the two sections beside each extremum that may be beyond the level. */
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
    const mcor_gauge_row row = { part->line, sections + 1, part->low,
      (part->high - part->low) / sections, part->high, 0, 0, weight };
    const int64_t before = parts->count, crossings = job->changed.count;
    MCOR_TRY(mcor_scan_row(job, &row, suspects ? parts : NULL));
    if (job->changed.count > crossings && (suspects || one))
    {
      parts->count = suspects ? before : before + 1;
    }
  }
  return MCOR_OK;
}

/* Evaluates rows [first, last) of job->samples. Appends three kinds of records to job->records:
 * places where lines cross the level, lines that particles reach, and lines that end in fluid. */
static mcor_status mcor_find_crossings(mcor_gauge_job* job, int64_t first, int64_t last)
{
  job->changed.count = job->suspects.count = job->inner.count = 0;
  for (int64_t l = first; l < last; ++l)
  {
    const mcor_gauge_row* row = &job->samples.of[l];
    for (int64_t i = row->sample; i < row->sample + row->count; ++i)
    {
      MCOR_APPEND(job->base.context, &job->inner,
        (mcor_gauge_place){ row->line, (double)i / (double)row->steps });
    }
  }
  MCOR_TRY(mcor_gauge_weights(job));
  const double* weight = job->weights;
  for (int64_t l = first; l < last; ++l)
  {
    mcor_gauge_row* row = &job->samples.of[l];
    const int64_t end = row->count - 1;
    bool reached = false;
    row->weight = weight;
    MCOR_TRY(mcor_scan_row(job, row, &job->suspects));
    for (int64_t i = 0; i <= end && !reached; ++i)
    {
      reached = weight[i] != 0;
    }
    if (reached)
    {
      MCOR_APPEND(
        job->base.context, &job->records, (mcor_gauge_place){ row->line, MCOR_GAUGE_REACHED });
    }
    if (row->sample + end == row->steps && weight[end] >= job->base.level &&
      mcor_owns_place(job, row, end))
    {
      MCOR_APPEND(
        job->base.context, &job->records, (mcor_gauge_place){ row->line, MCOR_GAUGE_ENDS_IN });
    }
    weight += row->count;
  }
  for (int round = 0; round < MCOR_GAUGE_EXTREMUM_ROUNDS && job->suspects.count > 0; ++round)
  {
    MCOR_TRY(mcor_look_closer(job, &job->suspects, MCOR_GAUGE_FINER, false));
  }
  /* Only the first round may find several crossings in a part. In later rounds, several crossings
   * would come from rounding. */
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

/* ---- readings ---- */

/* Makes the reading of a line from its crossings, and turns the crossings from places into
 * distances from the line's beginning. full: the line ends in fluid. */
static void mcor_read_line(
  const mcor_gauge_line* line, bool full, mcor_gauge_reading* r, double* crossings)
{
  double* at = crossings + r->first_crossing;
  const int64_t n = r->crossing_count;
  const double length = mcor_gauge_length(line);
  r->state = full ? MCOR_GAUGE_FULL : n > 0 ? MCOR_GAUGE_WET : MCOR_GAUGE_DRY;
  r->first = r->last = NAN;
  r->depth = 0;
  /* Crossings lead into and out of the fluid in turn. If `full`, the last crossing leads into the
   * fluid. */
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
  const int by_line = (left->line > right->line) - (left->line < right->line);
  return by_line ? by_line : (left->place > right->place) - (left->place < right->place);
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

/* Treats the lines in groups of about MCOR_GAUGE_TOGETHER samples. */
static mcor_status mcor_gauge_all(mcor_level_job* base)
{
  mcor_gauge_job* job = (mcor_gauge_job*)base;
  for (int64_t i = 0; i < job->line_count; ++i)
  {
    MCOR_TRY(mcor_plan_line(job, i));
  }
  const int64_t count = job->samples.count;
  for (int64_t first = 0, last; first < count; first = last)
  {
    int64_t points = 0;
    for (last = first; last < count && points < MCOR_GAUGE_TOGETHER; ++last)
    {
      points += job->samples.of[last].count;
    }
    MCOR_TRY(mcor_report(base->context, "gauges", 0.2 + 0.8 * (double)first / (double)count,
      0.2 + 0.8 * (double)last / (double)count));
    MCOR_TRY(mcor_find_crossings(job, first, last));
  }
  return MCOR_OK;
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
  MCOR_THEN(status, mcor_check_input(context, input, options));
  for (int64_t i = 0; i < job.line_count; ++i)
  {
    MCOR_THEN(status, mcor_take_line(&job, i));
  }
  MCOR_THEN(status, mcor_list_components(context, input, false, NULL));
  if (input->count > 0 && job.line_count > 0)
  {
    const double margin = options->globals
      ? MCOR_GAUGE_MARGIN * MCOR_GAUGE_STEP(options, options->globals->measured.h_min)
      : 0;
    MCOR_THEN(status, mcor_run_level(&job.base, input, options, margin, mcor_gauge_all));
  }
  MCOR_THEN(status,
    mcor_gather_records(
      context, job.records.of, job.records.count, sizeof *job.records.of, &all, &count));
  MCOR_THEN(status, mcor_read_lines(&job, all, count));
  free(job.lines);
  free(job.samples.of);
  free(job.records.of);
  free(job.changed.of);
  free(job.suspects.of);
  free(job.divided.of);
  free(job.inner.of);
  free(job.weights);
  return status;
}

mcor_status mcor_gauge(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_gauge_line* lines, int64_t count, mcor_gauges* gauges)
{
  MCOR_FAIL_IF(!context || !gauges, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "gauges");
  *gauges = (mcor_gauges){ 0 };
  MCOR_FAIL_IF(!input || !options || count < 0 || (count > 0 && !lines), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_OR_NEGATIVE), "lines");
  mcor_input without = *input;
  without.attribute_count = 0;
  mcor_gauge_job job = {
    .base.context = context, .given = lines, .line_count = count, .gauges = gauges
  };
  const mcor_status status =
    mcor_call_level(&job.base, &without, options, "Gauges", mcor_run_gauge, &gauges->statistics);
  return MCOR_OR_FREE(status, mcor_free_gauges, gauges);
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
