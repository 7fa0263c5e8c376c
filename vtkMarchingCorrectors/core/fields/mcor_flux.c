/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Fluxes through sections: integrals of the Shepard means of velocity and density, over the area
 * where the weight sum is at least the level. The probe evaluates samples; the gauges find
 * crossings of the level. A piece of a section is divided until its parts together have the
 * integrals of the piece itself. */

#include "mcor_flux.h"
#include "mcor_plane.h"

#include <stdlib.h>
#include <string.h>

/* A section's accuracy is relative to its greatest speed and density, but at least to this share of
 * the greatest of all particles, because these set how means are rounded. */
#define MCOR_FLUX_FLOOR 0.0625
/* A sum may become this many times area times the greatest speed and density. Weights below 0, as
 * M'4 has, make sums a little larger than that product. */
#define MCOR_FLUX_ROOM 8
/* Cells treated together. */
#define MCOR_FLUX_TOGETHER 4096
/* Greatest difference between the integrals of a piece and its parts, relative to the piece's
 * area times the speeds of its section. A piece that is small beside the section may differ by
 * more (MCOR_FLUX_SMALL), because errors of many pieces cancel. */
#define MCOR_FLUX_TOLERANCE 2.5e-6
#define MCOR_FLUX_SMALL 0.125
/* The most divisions of a piece, and of an unclear piece. */
#define MCOR_FLUX_DEPTH 12
#define MCOR_FLUX_UNCLEAR_DEPTH 6

/* ---- speeds ---- */

/* Reduces the greatest speeds and densities of sections over all ranks. Ranks without particles
 * call it, too. */
static mcor_status mcor_scale_sections(mcor_flux_job* job)
{
  mcor_context* context = job->edges.context;
  for (int64_t s = 0; s < job->section_count; ++s)
  {
    mcor_flux_section* found = &job->found[s];
    double seen[2] = { found->speed, found->density };
    MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, seen, 2));
    found->speed = fmax(seen[0], job->speed_floor);
    found->density = fmax(seen[1], job->density_floor);
    MCOR_TRY(mcor_reduce_counts(context, MCOR_GREATEST, &found->reached, 1));
  }
  return MCOR_OK;
}

static mcor_status mcor_find_speeds(mcor_flux_job* job)
{
  const mcor_flux_field* field = &job->field;
  for (int64_t first = 0; first < job->cells.count; first += MCOR_GAUGE_BATCH)
  {
    const int64_t rest = job->cells.count - first;
    const int count = rest < MCOR_GAUGE_BATCH ? (int)rest : MCOR_GAUGE_BATCH;
    for (int i = 0; i < count; ++i)
    {
      const mcor_flux_cell* cell = &job->cells.of[first + i];
      const double* counts = job->patches.of[cell->patch].counts;
      field->at[i][0] = ((double)cell->u + 0.5) / counts[0];
      field->at[i][1] = job->is_plane ? 0 : ((double)cell->v + 0.5) / counts[1];
      field->at[i][2] = (double)cell->patch;
    }
    MCOR_TRY(mcor_sample_flux(job, count));
    for (int i = 0; i < count; ++i)
    {
      const mcor_patch* patch = &job->patches.of[job->cells.of[first + i].patch];
      mcor_flux_section* found = &job->found[patch->section];
      found->reached = found->reached || field->weight[i] != 0;
      if (field->weight[i] >= job->edges.level)
      {
        const double* velocity = field->velocity + (int64_t)i * job->velocity_components;
        found->speed = fmax(found->speed, sqrt(mcor_speed_along(job, i, velocity)));
        found->density = fmax(found->density, fabs(field->density[i]));
      }
    }
  }
  return mcor_scale_sections(job);
}

/* ---- division ---- */

/* Makes the pieces of cells [first, last). */
static mcor_status mcor_begin_pieces(mcor_flux_job* job, int64_t first, int64_t last)
{
  job->pieces.count = 0;
  for (int64_t i = first; i < last; ++i)
  {
    const mcor_flux_cell* cell = &job->cells.of[i];
    const mcor_patch* patch = &job->patches.of[cell->patch];
    const double u[2] = { (double)cell->u / patch->counts[0],
      (double)(cell->u + 1) / patch->counts[0] };
    const double v[2] = { (double)cell->v / patch->counts[1],
      (double)(cell->v + 1) / patch->counts[1] };
    const double middle[2] = { 0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]) };
    const double size = job->is_plane ? u[1] - u[0] : 0.5 * (u[1] - u[0]) * (v[1] - v[0]);
    const double low = job->is_plane ? 0 : v[0];
    mcor_flux_piece piece = { .patch = cell->patch,
      .corner = { { u[0], low }, { u[1], low }, { u[0], v[1] } },
      .area = size * mcor_patch_measure(patch, middle) };
    MCOR_APPEND(job->edges.context, &job->pieces, piece);
    /* A triangle patch has no second piece beyond its diagonal. */
    if (!job->is_plane &&
      (patch->shape != MCOR_PATCH_TRIANGLE || (double)(cell->u + cell->v + 2) <= patch->counts[0]))
    {
      const double corner[3][2] = { { u[1], v[1] }, { u[0], v[1] }, { u[1], v[0] } };
      memcpy(piece.corner, corner, sizeof corner);
      MCOR_APPEND(job->edges.context, &job->pieces, piece);
    }
  }
  return MCOR_OK;
}

/* Whether the parts of a piece may replace it in the sum. Sets `sum` to the sum of the parts. */
static bool mcor_is_settled(const mcor_flux_job* job, const mcor_flux_piece* piece,
  const mcor_flux_piece* parts, double sum[MCOR_FLUX_SUMS])
{
  const mcor_flux_section* section = &job->found[job->patches.of[piece->patch].section];
  const double tolerance = MCOR_FLUX_TOLERANCE *
    fmax(piece->area, MCOR_FLUX_SMALL * sqrt(piece->area) * sqrt(section->area));
  const double scale[MCOR_FLUX_SUMS] = { 1, section->speed, section->speed * section->density };
  bool settled = true;
  memset(sum, 0, MCOR_FLUX_SUMS * sizeof *sum);
  for (int part = 0; part < job->form->parts; ++part)
  {
    settled = settled && !(parts[part].unclear && parts[part].depth < MCOR_FLUX_UNCLEAR_DEPTH);
    for (int s = 0; s < MCOR_FLUX_SUMS; ++s)
    {
      sum[s] += parts[part].sum[s];
    }
  }
  for (int s = 0; s < MCOR_FLUX_SUMS; ++s)
  {
    settled = settled && fabs(sum[s] - piece->sum[s]) <= tolerance * scale[s];
  }
  return settled || parts[0].depth >= MCOR_FLUX_DEPTH;
}

/* Divides the pieces into their parts until they are settled, and adds them to their sections. */
static mcor_status mcor_settle_pieces(mcor_flux_job* job)
{
  const int divided = job->form->parts;
  while (job->pieces.count > 0)
  {
    job->parts.count = 0;
    for (int64_t i = 0; i < divided * job->pieces.count; ++i)
    {
      const mcor_flux_piece* whole = &job->pieces.of[i / divided];
      mcor_flux_piece part = *whole;
      ++part.depth;
      for (int c = 0; c < 3; ++c)
      {
        double at[3];
        mcor_place_point(job, whole, job->form->part[i % divided][c], at);
        memcpy(part.corner[c], at, sizeof part.corner[c]);
      }
      MCOR_APPEND(job->edges.context, &job->parts, part);
    }
    MCOR_TRY(mcor_measure_pieces(job, &job->parts));
    mcor_flux_piece* parts = job->parts.of;
    int64_t left = 0;
    for (int64_t i = 0; i < job->pieces.count; ++i)
    {
      const mcor_flux_piece* piece = &job->pieces.of[i];
      mcor_flux_section* found = &job->found[job->patches.of[piece->patch].section];
      double sum[MCOR_FLUX_SUMS];
      if (!mcor_is_settled(job, piece, &parts[divided * i], sum))
      {
        memmove(&parts[left], &parts[divided * i], (size_t)divided * sizeof *parts);
        left += divided;
        continue;
      }
      for (int s = 0; s < MCOR_FLUX_SUMS; ++s)
      {
        found->sum[s] += llrint(fmin(fmax(sum[s] / found->unit[s], -0x1p62), 0x1p62));
      }
    }
    const mcor_flux_pieces settled = job->pieces;
    job->pieces = job->parts;
    job->pieces.count = left;
    job->parts = settled;
  }
  return MCOR_OK;
}

/* Adds up all cells. */
static mcor_status mcor_add_fluxes(mcor_gauge_job* edges)
{
  mcor_flux_job* job = (mcor_flux_job*)edges;
  const size_t n = MCOR_GAUGE_BATCH;
  const double count = (double)job->cells.count;
  double* samples = malloc(8 * n * sizeof *samples);
  MCOR_TRY(mcor_allocated(edges->context, samples));
  double *weight = samples + 3 * n, *velocity = weight + n, *density = velocity + 3 * n;
  job->field =
    (mcor_flux_field){ (double(*)[3])samples, weight, velocity, density, { velocity, density } };
  MCOR_TRY(mcor_find_speeds(job));
  for (int64_t first = 0, last; first < job->cells.count; first = last)
  {
    const int64_t rest = job->cells.count - first;
    last = first + (rest < MCOR_FLUX_TOGETHER ? rest : MCOR_FLUX_TOGETHER);
    MCOR_TRY(mcor_report(
      edges->context, "flux", 0.2 + 0.8 * (double)first / count, 0.2 + 0.8 * (double)last / count));
    MCOR_TRY(mcor_begin_pieces(job, first, last));
    MCOR_TRY(mcor_measure_pieces(job, &job->pieces));
    MCOR_TRY(mcor_settle_pieces(job));
  }
  return MCOR_OK;
}

/* ---- the call ---- */

/* Sets the floors of speed and density, and the units in which sums are whole numbers, from the
 * ranges of velocity and density. */
static mcor_status mcor_scale_flux(mcor_flux_job* job)
{
  mcor_context* context = job->edges.context;
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
  for (int64_t s = 0; s < job->section_count; ++s)
  {
    mcor_flux_section* found = &job->found[s];
    const double most[MCOR_FLUX_SUMS] = { found->area, found->area * speed,
      found->area * speed * largest[1] };
    for (int k = 0; k < MCOR_FLUX_SUMS; ++k)
    {
      MCOR_FAIL_IF(!isfinite(most[k]), context, MCOR_INVALID_DATA, MCOR_SAY(FLUX_TOO_LARGE), speed,
        largest[1]);
      int exponent = 0;
      frexp(MCOR_FLUX_ROOM * most[k], &exponent);
      found->unit[k] = ldexp(1, exponent > -900 ? exponent - 62 : -962);
    }
  }
  return MCOR_OK;
}

static mcor_status mcor_read_fluxes(mcor_flux_job* job, mcor_fluxes* fluxes)
{
  fluxes->readings = calloc((size_t)job->section_count + 1, sizeof *fluxes->readings);
  MCOR_TRY(mcor_allocated(job->edges.context, fluxes->readings));
  fluxes->count = job->section_count;
  for (int64_t s = 0; s < job->section_count; ++s)
  {
    mcor_flux_section* found = &job->found[s];
    mcor_flux_reading* reading = &fluxes->readings[s];
    MCOR_TRY(mcor_reduce_counts(job->edges.context, MCOR_SUM_OF, found->sum, MCOR_FLUX_SUMS));
    reading->outside = !found->reached;
    reading->area = (double)found->sum[0] * found->unit[0];
    reading->volume_flux = (double)found->sum[1] * found->unit[1];
    reading->mass_flux = job->has_density ? (double)found->sum[2] * found->unit[2] : NAN;
    reading->velocity = reading->area > 0 ? reading->volume_flux / reading->area : NAN;
  }
  return MCOR_OK;
}

static mcor_status mcor_flux_input(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flux_job* job)
{
  int64_t not_finite[2] = { -1, -1 };
  const int axes = context->space.axes, components = mcor_components(&input->attributes[0]);
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
  for (int64_t s = 0; s < job->section_count; ++s)
  {
    /* A line needs the plane of the particles, which a rank without particles does not know. */
    const bool has_place =
      input->count > 0 || job->is_plane || job->sections[s].shape != MCOR_SECTION_LINES;
    MCOR_TRY(has_place ? mcor_add_section(job, s) : MCOR_OK);
  }
  MCOR_TRY(mcor_scale_flux(job));
  if (input->count == 0 || job->section_count == 0)
  {
    return mcor_scale_sections(job);
  }
  const double margin = job->edges.box
    ? MCOR_FLUX_CELL * options->h_scale * options->globals->measured.h_min +
      0.5 * options->globals->measured.cube
    : 0;
  MCOR_TRY(mcor_bound_level(context, input, options, job->edges.box, margin, &job->around));
  MCOR_TRY(mcor_prepare(context, input, options));
  if (context->grid.count == 0)
  {
    return mcor_scale_sections(job);
  }
  MCOR_TRY(mcor_list_flux_cells(job));
  return mcor_run_points(&job->edges, input, mcor_add_fluxes);
}

static mcor_status mcor_run_flux(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_flux_job job = *(const mcor_flux_job*)data;
  mcor_fluxes* fluxes = job.fluxes;
  double box[6];
  job.is_plane = context->space.flat;
  job.plane = &context->plane;
  job.across = mcor_plane_axis(job.plane, 2);
  job.form = &mcor_flux_forms[context->space.flat];
  job.edges.map_data = &job;
  if (job.edges.box && job.is_plane)
  {
    mcor_flatten_sides(&context->plane, job.edges.box, box);
    job.edges.box = box;
  }
  mcor_free_fluxes(fluxes); /* results of an earlier attempt */
  job.found = calloc((size_t)job.section_count + 1, sizeof *job.found);
  mcor_status status = mcor_allocated(context, job.found);
  MCOR_THEN(status, mcor_flux_input(context, input, options, &job));
  MCOR_THEN(status, mcor_read_fluxes(&job, fluxes));
  mcor_free_gauge_parts(&job.edges);
  free(job.found);
  free(job.patches.of);
  free(job.cells.of);
  free(job.field.at);
  free(job.pieces.of);
  free(job.parts.of);
  free(job.inside.of);
  free(job.cuts.of);
  free(job.lines.of);
  return status != MCOR_OK || input->count == 0 || job.section_count == 0
    ? status
    : mcor_finish_field(context);
}

mcor_status mcor_flux(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const mcor_section* sections, int64_t count, mcor_fluxes* fluxes)
{
  if (!context || !fluxes)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *fluxes = (mcor_fluxes){ 0 };
  MCOR_FAIL_IF(!input || !options || count < 0 || (count > 0 && !sections), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_OR_NEGATIVE), "sections");
  MCOR_FAIL_IF((input->attribute_count != 1 && input->attribute_count != 2) || !input->attributes,
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(FLUX_ATTRIBUTES), input->attribute_count);
  mcor_input given = *input;
  mcor_options own;
  mcor_flux_job job = { .edges = { .context = context, .map = mcor_map_patch },
    .sections = sections,
    .section_count = count,
    .fluxes = fluxes,
    .velocity_components = mcor_components(&input->attributes[0]),
    .has_density = input->attribute_count == 2,
    .around = mcor_no_findings() };
  MCOR_TRY(
    mcor_begin_level(context, options, "Fluxes", &given, &own, &job.edges.level, &job.edges.box));
  const mcor_status status = mcor_run_call(
    context, &given, &own, mcor_uses_solids(input, &own), &fluxes->statistics, mcor_run_flux, &job);
  if (status != MCOR_OK)
  {
    mcor_free_fluxes(fluxes);
  }
  return status;
}

void mcor_free_fluxes(mcor_fluxes* fluxes)
{
  if (fluxes)
  {
    free(fluxes->readings);
    *fluxes = (mcor_fluxes){ .statistics = fluxes->statistics };
  }
}
