/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Fluxes through sections: integrals of v . n and rho v . n over the area where the weight sum is
 * at least the level. v, rho: the Shepard means of velocity and density; n: the section's normal.
 * Each piece of a section is integrated in two ways. In fluid, two quadrature rules use the same
 * samples. A piece that the level crosses is once cut along one straight line, and once divided
 * into parts that are each cut in this way. If the two results differ, the piece is halved. */

#include "mcor_flux.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* The longest side that a cell may have, as a multiple of the smallest scaled smoothing length. */
#define MCOR_FLUX_CELL 0.75
/* MCOR_FLUX_MOST: the most cells near particles, in all sections together. MCOR_FLUX_MOST_ALONG:
 * the most cells along a side of a piece; doubles can then tell the corners of cells apart. */
#define MCOR_FLUX_MOST (1 << 24)
#define MCOR_FLUX_MOST_ALONG 1e15
/* A piece's accuracy is relative to the greatest speed and the greatest density in the piece. Each
 * of the two counts as at least this share of the greatest value among all particles, because this
 * greatest value decides how the device rounds means. */
#define MCOR_FLUX_FLOOR 0.0625
/* A sum has room for this many times the section's area, times the greatest speed and density if
 * they are in the sum. Weights below 0, as M'4 has, make sums a little larger than this product. */
#define MCOR_FLUX_ROOM 8
/* A piece is accurate enough if the results of two ways to integrate differ by at most
 * MCOR_FLUX_TOLERANCE * area * scale. The scale is the integrand's: 1, the piece's greatest speed,
 * or this speed times the greatest density. The area is the piece's or, if larger, MCOR_FLUX_SMALL
 * times the geometric mean of the piece's area and the section's area near particles, because
 * errors of many small pieces cancel. */
#define MCOR_FLUX_TOLERANCE 2.5e-6
#define MCOR_FLUX_SMALL 0.125
/* MCOR_FLUX_DEPTH: how often a cell is halved at most. MCOR_FLUX_UNCLEAR_DEPTH: how often a cell is
 * halved at most for the sole reason that the level may cross it between its samples. */
#define MCOR_FLUX_DEPTH 24
#define MCOR_FLUX_UNCLEAR_DEPTH 12
/* The second derivative of a weight is about 4 / h^2. So the weight between two samples may differ
 * from the weight at the nearest sample by this number times (longest side / h)^2. */
#define MCOR_FLUX_BEND 0.125

static const mcor_flux_form mcor_flux_forms[2] = {
  { 3, 7,
    { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0.5, 0.5, 0 }, { 0, 0.5, 0.5 }, { 0.5, 0, 0.5 },
      { 1 / 3.0, 1 / 3.0, 1 / 3.0 } },
    { { 0, 0, 0, 1 / 3.0, 1 / 3.0, 1 / 3.0, 0 },
      { 1 / 20.0, 1 / 20.0, 1 / 20.0, 2 / 15.0, 2 / 15.0, 2 / 15.0, 9 / 20.0 } },
    { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 }, { 3, 4, 5 } } },
  { 2, 5, { { 1, 0 }, { 0, 1 }, { 0.75, 0.25 }, { 0.25, 0.75 }, { 0.5, 0.5 } },
    { { 1 / 6.0, 1 / 6.0, 0, 0, 2 / 3.0 },
      { 7 / 90.0, 7 / 90.0, 32 / 90.0, 32 / 90.0, 12 / 90.0 } },
    { { 0, 2 }, { 2, 4 }, { 4, 3 }, { 3, 1 } } },
};

/* ---- pieces ---- */

void mcor_measure_piece(const mcor_flux_job* job, mcor_flux_piece* piece)
{
  double ways[3][3], product[3], longest = -1;
  for (int c = 0; c < (job->is_plane ? 1 : 3); ++c)
  {
    mcor_subtract(piece->corner[(c + 1) % 3], piece->corner[c], ways[c]);
    const double square = mcor_dot(ways[c], ways[c]);
    piece->side = square > longest ? c : piece->side;
    longest = fmax(longest, square);
  }
  piece->size = piece->length = sqrt(longest);
  if (!job->is_plane)
  {
    mcor_cross(ways[0], ways[2], product);
    piece->size = 0.5 * sqrt(mcor_dot(product, product));
  }
}

/* Appends the halves of a piece to job->parts. If halving hardly shortens the longest side, appends
 * nothing, and *is_halved becomes false: far from the origin, doubles may not tell the middle of a
 * side from its ends. */
static mcor_status mcor_halve_piece(
  mcor_flux_job* job, const mcor_flux_piece* piece, bool* is_halved)
{
  mcor_flux_piece halves[2] = { *piece, *piece };
  const int side = piece->side, next = (side + 1) % 3;
  double middle[3], ways[2][3];
  mcor_point_between(piece->corner[side], piece->corner[next], 0.5, middle);
  mcor_subtract(middle, piece->corner[side], ways[0]);
  mcor_subtract(piece->corner[next], middle, ways[1]);
  *is_halved =
    sqrt(fmax(mcor_dot(ways[0], ways[0]), mcor_dot(ways[1], ways[1]))) < 0.75 * piece->length;
  memcpy(halves[0].corner[next], middle, sizeof middle);
  memcpy(halves[1].corner[side], middle, sizeof middle);
  for (int i = 0; i < 2 && *is_halved; ++i)
  {
    mcor_measure_piece(job, &halves[i]);
    MCOR_APPEND(job->base.context, &job->parts, halves[i]);
  }
  return MCOR_OK;
}

/* Writes the place of sample k of a piece to `point`. */
static void mcor_place_sample(
  const mcor_flux_form* form, const mcor_flux_piece* piece, int k, double point[3])
{
  const double* place = form->place[k];
  for (int a = 0; a < 3; ++a)
  {
    point[a] = place[0] * piece->corner[0][a] + place[1] * piece->corner[1][a] +
      place[2] * piece->corner[2][a];
  }
}

/* Fills job->batch with pieces, and sets *count to their number; 0: all pieces are done. Halves
 * pieces that are longer than a cell. Drops pieces that are far from all particles, and cells that
 * belong to another rank. */
static mcor_status mcor_take_pieces(mcor_flux_job* job, int* count)
{
  mcor_context* context = job->base.context;
  const mcor_measure* measure = &context->measure;
  const mcor_lattice* lattice = &context->lattice;
  const int most = MCOR_LEVEL_BATCH / job->form->points;
  const double cell = MCOR_FLUX_CELL * job->smoothing_length;
  for (*count = 0; *count < most && (job->parts.count > 0 || job->next < job->pieces.count);)
  {
    mcor_flux_piece piece =
      job->parts.count > 0 ? job->parts.of[--job->parts.count] : job->pieces.of[job->next++];
    if (piece.depth == 0)
    {
      const double cells = piece.length / cell, margin = piece.length + lattice->cube;
      double middle[3];
      bool is_near = true, is_halved = false;
      mcor_place_sample(job->form, &piece, job->form->points - 1, middle);
      for (int a = 0; a < 3; ++a) /* along a period, particles may be anywhere */
      {
        is_near = is_near &&
          (lattice->period[a] > 0 ||
            (middle[a] >= measure->low[a] - margin && middle[a] <= measure->high[a] + margin));
      }
      MCOR_FAIL_IF(is_near && cells > MCOR_FLUX_MOST_ALONG, context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(SECTION_CELLS_ALONG), mcor_label_section(job, piece.section).text, cells,
        measure->h_min, MCOR_FLUX_MOST_ALONG);
      if (is_near && cells > 1)
      {
        MCOR_TRY(mcor_halve_piece(job, &piece, &is_halved));
      }
      const bool is_cell = is_near && !is_halved;
      job->found[piece.section].near += is_cell && job->is_counting ? piece.size : 0;
      if (!is_cell || !mcor_owns_point(&job->base, middle))
      {
        continue;
      }
      MCOR_FAIL_IF(++job->cells > MCOR_FLUX_MOST, context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(SECTION_CELLS), mcor_label_section(job, piece.section).text, MCOR_FLUX_MOST, cell);
      piece.depth = 1;
    }
    job->batch[(*count)++] = piece;
  }
  return MCOR_OK;
}

/* ---- integrals ---- */

static mcor_status mcor_sample_pieces(mcor_flux_job* job, int count)
{
  const int points = job->form->points, samples = count * points;
  double* points_at = (double*)job->base.run->points->data;
  double* values[2] = { job->velocity, job->density };
  for (int i = 0; i < samples; ++i)
  {
    mcor_place_sample(job->form, &job->batch[i / points], i % points, points_at + 3 * i);
  }
  memset(values[0], 0, (size_t)samples * (size_t)job->velocity_components * sizeof(double));
  memset(values[1], 0, (size_t)samples * sizeof(double));
  job->base.run->samples->values = values;
  return mcor_sample_level(&job->base, job->weight, samples);
}

/* Adds to `sum` the integrals over the part of a triangle or line that is in fluid. corner: numbers
 * of the samples at its corners. size: its area or length. Between the corners, weights and values
 * count as linear. Returns whether the level cuts the triangle or line. */
static bool mcor_add_cut(const mcor_flux_job* job, const int* corner, const double* weight,
  double value[][MCOR_FLUX_SUMS], double size, double sum[MCOR_FLUX_SUMS])
{
  /* Index: bit c tells that corner c is in fluid. Entry: the corner that is alone on its side of
   * the level; 0 if none is. */
  static const int lone_corner[8] = { 0, 0, 1, 2, 2, 1, 0, 0 };
  const int corners = job->form->corners;
  const double level = job->base.level;
  int inside = 0;
  for (int c = 0; c < corners; ++c)
  {
    inside |= weight[corner[c]] >= level ? 1 << c : 0;
  }
  const int lone = corners == 3 ? lone_corner[inside] : 0, from = corner[lone];
  const bool is_cut = inside != 0 && inside != (1 << corners) - 1;
  /* mean: means over the triangle or line. tip: means over the part that the level cuts off at
   * corner `from`. share: this part's share of the size. */
  double tip[MCOR_FLUX_SUMS], mean[MCOR_FLUX_SUMS], share = is_cut ? 1 : 0;
  for (int s = 0; s < MCOR_FLUX_SUMS; ++s)
  {
    tip[s] = mean[s] = value[from][s] / corners;
  }
  for (int c = 1; c < corners; ++c)
  {
    const int to = corner[(lone + c) % corners];
    const double at = is_cut ? (level - weight[from]) / (weight[to] - weight[from]) : 0;
    share *= at;
    for (int s = 0; s < MCOR_FLUX_SUMS; ++s)
    {
      mean[s] += value[to][s] / corners;
      tip[s] += (value[from][s] + at * (value[to][s] - value[from][s])) / corners;
    }
  }
  for (int s = 0; s < MCOR_FLUX_SUMS && inside != 0; ++s)
  {
    const double cut = share * tip[s];
    sum[s] += size * (is_cut && inside >> lone & 1 ? cut : mean[s] - cut);
  }
  return is_cut;
}

/* Integrates a piece in two ways: adds the simpler result to sum[0], the better one to sum[1].
 * weight, value: at the piece's samples. Returns whether the level separates the corners. */
static bool mcor_integrate_piece(const mcor_flux_job* job, const double* weight,
  double value[][MCOR_FLUX_SUMS], double size, double sum[2][MCOR_FLUX_SUMS])
{
  static const int corners[3] = { 0, 1, 2 };
  const mcor_flux_form* form = job->form;
  bool is_inside = true;
  for (int k = 0; k < form->points; ++k)
  {
    is_inside = is_inside && weight[k] >= job->base.level;
  }
  if (!is_inside)
  {
    for (int part = 0; part < MCOR_FLUX_PARTS; ++part)
    {
      mcor_add_cut(job, form->part[part], weight, value, size / MCOR_FLUX_PARTS, sum[1]);
    }
    return mcor_add_cut(job, corners, weight, value, size, sum[0]);
  }
  for (int i = 0; i < 2 * MCOR_FLUX_SUMS * form->points; ++i)
  {
    const int rule = i % 2, s = i / 2 % MCOR_FLUX_SUMS, k = i / (2 * MCOR_FLUX_SUMS);
    sum[rule][s] += size * form->share[rule][k] * value[k][s];
  }
  return false;
}

/* Adds a piece's integrals to its section, or halves the piece if halving may change the integrals.
 * first: the number of the piece's first sample. */
static mcor_status mcor_settle_piece(mcor_flux_job* job, mcor_flux_piece* piece, int first)
{
  mcor_flux_section* found = &job->found[piece->section];
  const double *weight = job->weight + first, *density = job->density + first;
  const double size = piece->size, level = job->base.level;
  const double tolerance =
    MCOR_FLUX_TOLERANCE * fmax(size, MCOR_FLUX_SMALL * sqrt(size) * sqrt(found->near));
  double value[MCOR_FLUX_POINTS][MCOR_FLUX_SUMS], sum[2][MCOR_FLUX_SUMS] = { { 0 } };
  double nearest = INFINITY, speed = job->speed_floor, dense = job->density_floor;
  bool is_reached = false;
  for (int k = 0; k < job->form->points; ++k)
  {
    const double* velocity = job->velocity + (int64_t)(first + k) * job->velocity_components;
    double along = 0, square = 0;
    for (int c = 0; c < job->velocity_components; ++c)
    {
      along += velocity[c] * piece->normal[c];
      square += velocity[c] * velocity[c];
    }
    value[k][0] = 1;
    value[k][1] = along;
    value[k][2] = density[k] * along;
    speed = fmax(speed, sqrt(square));
    dense = fmax(dense, fabs(density[k]));
    nearest = fmin(nearest, weight[0] >= level ? weight[k] - level : level - weight[k]);
    is_reached = is_reached || weight[k] != 0;
  }
  const bool is_cut = mcor_integrate_piece(job, weight, value, size, sum);
  const double length = piece->length / job->smoothing_length;
  const bool may_be_cut = !is_cut && nearest < MCOR_FLUX_BEND * length * length;
  bool is_settled = !may_be_cut || piece->depth > MCOR_FLUX_UNCLEAR_DEPTH, is_halved = false;
  /* How large each integral over the piece may be per unit of area. */
  const double scale[MCOR_FLUX_SUMS] = { 1, speed, speed * dense };
  for (int s = 0; s < MCOR_FLUX_SUMS; ++s)
  {
    is_settled = is_settled && fabs(sum[1][s] - sum[0][s]) <= tolerance * scale[s];
  }
  if (!is_settled && piece->depth++ <= MCOR_FLUX_DEPTH)
  {
    MCOR_TRY(mcor_halve_piece(job, piece, &is_halved));
  }
  for (int s = 0; s < MCOR_FLUX_SUMS && !is_halved; ++s)
  {
    found->sum[s] += llrint(fmin(fmax(sum[1][s] / found->unit[s], -0x1p62), 0x1p62));
  }
  found->sum[MCOR_FLUX_SUMS] += is_reached && !is_halved;
  return MCOR_OK;
}

/* Adds up the pieces of all sections. The first pass only counts cells and adds up their areas. It
 * fails if there are too many cells, before any cell is evaluated. */
static mcor_status mcor_add_fluxes(mcor_level_job* base)
{
  mcor_flux_job* job = (mcor_flux_job*)base;
  mcor_context* context = base->context;
  const size_t n = MCOR_LEVEL_BATCH;
  double all_cells = 1;
  job->smoothing_length = context->run.options->h_scale * context->measure.h_min;
  job->batch = malloc(n / (size_t)job->form->points * sizeof *job->batch);
  job->weight = malloc(5 * n * sizeof *job->weight);
  MCOR_TRY(mcor_allocated(context, job->batch && job->weight));
  job->velocity = job->weight + n;
  job->density = job->velocity + 3 * n;
  for (int pass = 0; pass < 2; ++pass)
  {
    job->is_counting = pass == 0;
    all_cells += job->cells;
    job->cells = 0;
    job->next = 0;
    for (int count = 1; count > 0;)
    {
      MCOR_TRY(job->is_counting
          ? mcor_report_launch(context)
          : mcor_report(context, "flux", 0.2 + 0.8 * job->cells / all_cells, 1));
      MCOR_TRY(mcor_take_pieces(job, &count));
      if (job->is_counting || count == 0)
      {
        continue;
      }
      MCOR_TRY(mcor_sample_pieces(job, count));
      for (int i = 0; i < count; ++i)
      {
        MCOR_TRY(mcor_settle_piece(job, &job->batch[i], i * job->form->points));
      }
    }
  }
  return MCOR_OK;
}

/* ---- the call ---- */

/* Sets speed_floor and density_floor (see MCOR_FLUX_FLOOR), and the unit of each sum, from the
 * ranges of velocity and density. Sums are whole numbers of their units. */
static mcor_status mcor_scale_flux(mcor_flux_job* job)
{
  mcor_context* context = job->base.context;
  double largest[2] = { 0 };
  for (int i = 0; i < context->attributes.varying_count; ++i)
  {
    const mcor_component* component = &context->attributes.varying[i];
    const double most = mcor_largest_of(component->low, component->high);
    largest[component->attribute] += component->attribute == 0 ? most * most : most;
  }
  const double speed = sqrt(largest[0]);
  job->speed_floor = MCOR_FLUX_FLOOR * speed;
  job->density_floor = MCOR_FLUX_FLOOR * largest[1];
  for (int64_t i = 0; i < MCOR_FLUX_SUMS * job->section_count; ++i)
  {
    mcor_flux_section* found = &job->found[i / MCOR_FLUX_SUMS];
    const int s = (int)(i % MCOR_FLUX_SUMS);
    const double most = found->area * (s > 0 ? speed : 1) * (s > 1 ? largest[1] : 1);
    int exponent = 0;
    MCOR_FAIL_IF(
      !isfinite(most), context, MCOR_INVALID_DATA, MCOR_SAY(FLUX_TOO_LARGE), speed, largest[1]);
    frexp(MCOR_FLUX_ROOM * most, &exponent);
    found->unit[s] = ldexp(1, exponent > -900 ? exponent - 62 : -962);
  }
  return MCOR_OK;
}

static mcor_status mcor_read_fluxes(mcor_flux_job* job, mcor_fluxes* fluxes)
{
  fluxes->readings = calloc((size_t)job->section_count + 1, sizeof *fluxes->readings);
  MCOR_TRY(mcor_allocated(job->base.context, fluxes->readings));
  fluxes->count = job->section_count;
  for (int64_t s = 0; s < job->section_count; ++s)
  {
    mcor_flux_section* found = &job->found[s];
    mcor_flux_reading* reading = &fluxes->readings[s];
    MCOR_TRY(mcor_reduce_counts(job->base.context, MCOR_SUM_OF, found->sum, MCOR_FLUX_SUMS + 1));
    reading->outside = found->sum[MCOR_FLUX_SUMS] == 0;
    reading->area = (double)found->sum[0] * found->unit[0];
    reading->volume_flux = (double)found->sum[1] * found->unit[1];
    reading->mass_flux = job->has_density ? (double)found->sum[2] * found->unit[2] : NAN;
    reading->velocity = reading->area > 0 ? reading->volume_flux / reading->area : NAN;
  }
  return MCOR_OK;
}

static mcor_status mcor_run_flux(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_flux_job job = *(const mcor_flux_job*)data;
  int64_t not_finite[2] = { -1, -1 };
  const int axes = context->space.axes, components = job.velocity_components;
  job.is_plane = mcor_is_plane(context);
  job.plane = &context->plane;
  job.across = mcor_plane_axis(job.plane, 2);
  job.form = &mcor_flux_forms[job.is_plane];
  mcor_free_fluxes(job.fluxes); /* results of an earlier attempt */
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_FAIL_IF(components != 3 && components != axes, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(VELOCITY_COMPONENTS), components, axes == 2 ? ", or 2 in two dimensions" : "");
  MCOR_FAIL_IF(input->attribute_count == 2 && mcor_components(&input->attributes[1]) != 1, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(DENSITY_COMPONENTS), mcor_components(&input->attributes[1]));
  MCOR_TRY(mcor_list_components(context, input, false, not_finite));
  for (int a = 0; a < input->attribute_count; ++a)
  {
    MCOR_FAIL_IF(not_finite[a] >= 0, context, MCOR_INVALID_DATA, MCOR_SAY(FLUX_NOT_FINITE),
      a == 0 ? "velocity" : "density", (long long)not_finite[a]);
  }
  job.found = calloc((size_t)job.section_count + 1, sizeof *job.found);
  mcor_status status = mcor_allocated(context, job.found);
  for (int64_t s = 0; s < job.section_count && status == MCOR_OK; ++s)
  {
    /* A line needs the plane of the particles, which a rank without particles does not know. */
    const bool has_place =
      input->count > 0 || job.is_plane || job.sections[s].shape != MCOR_SECTION_LINES;
    status = has_place ? mcor_add_section(&job, s) : MCOR_OK;
  }
  MCOR_THEN(status, mcor_scale_flux(&job));
  if (input->count > 0 && job.section_count > 0)
  {
    const double margin = options->globals
      ? MCOR_FLUX_CELL * options->h_scale * options->globals->measured.h_min +
        0.5 * options->globals->measured.cube
      : 0;
    MCOR_THEN(status, mcor_run_level(&job.base, input, options, margin, mcor_add_fluxes));
  }
  MCOR_THEN(status, mcor_read_fluxes(&job, job.fluxes));
  free(job.found);
  free(job.pieces.of);
  free(job.parts.of);
  free(job.batch);
  free(job.weight);
  return status;
}

mcor_status mcor_flux(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_section* sections, int64_t count, mcor_fluxes* fluxes)
{
  MCOR_FAIL_IF(!context || !fluxes, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "fluxes");
  *fluxes = (mcor_fluxes){ 0 };
  MCOR_FAIL_IF(!input || !options || count < 0 || (count > 0 && !sections), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_OR_NEGATIVE), "sections");
  MCOR_FAIL_IF((input->attribute_count != 1 && input->attribute_count != 2) || !input->attributes,
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(FLUX_ATTRIBUTES), input->attribute_count);
  mcor_flux_job job = { .base.context = context,
    .sections = sections,
    .section_count = count,
    .fluxes = fluxes,
    .velocity_components = mcor_components(&input->attributes[0]),
    .has_density = input->attribute_count == 2 };
  const mcor_status status =
    mcor_call_level(&job.base, input, options, "Fluxes", mcor_run_flux, &fluxes->statistics);
  return MCOR_OR_FREE(status, mcor_free_fluxes, fluxes);
}

void mcor_free_fluxes(mcor_fluxes* fluxes)
{
  if (fluxes)
  {
    free(fluxes->readings);
    *fluxes = (mcor_fluxes){ .statistics = fluxes->statistics };
  }
}
