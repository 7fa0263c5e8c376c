/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Fluxes through sections: integrals of the Shepard means of velocity and density, over the area
 * where the weight sum is at least the level. The probe evaluates samples; the gauges find
 * crossings of the level. */

#include "mcor_flux.h"
#include "mcor_plane.h"
#include "mcor_ranks.h"

#include <stdlib.h>
#include <string.h>

/* Least speed and density to which a section's accuracy is relative, as a share of the greatest
 * ones of all particles: means are exact to the rounding of those. */
#define MCOR_FLUX_FLOOR 0.0625
/* Room of sums above the largest one that means allow. Weights below 0, as M'4 has, make sums a
 * little larger. */
#define MCOR_FLUX_ROOM 8

/* ---- the call ---- */

/* Sets from the ranges of velocity and density: the floors of speed and density, and the units
 * in which sums are whole numbers. */
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
      MCOR_RETURN_IF(!isfinite(most[k]), context, MCOR_INVALID_DATA,
        "Fluxes would be too large for a number: velocities go to %g, densities to %g. Use other "
        "units.",
        speed, largest[1]);
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
  MCOR_RETURN_IF(components != 3 && components != axes, context, MCOR_INVALID_ARGUMENT,
    "The velocity has %d components; it must have 3%s.", components,
    axes == 2 ? ", or 2 in two dimensions" : "");
  MCOR_RETURN_IF(input->attribute_count == 2 && mcor_components(&input->attributes[1]) != 1,
    context, MCOR_INVALID_ARGUMENT, "The density has %d components; it must have 1.",
    mcor_components(&input->attributes[1]));
  MCOR_TRY(mcor_list_components(context, input, false, not_finite));
  for (int a = 0; a < input->attribute_count; ++a)
  {
    MCOR_RETURN_IF(not_finite[a] >= 0, context, MCOR_INVALID_DATA,
      "The %s is NaN or infinite at particle %lld. Correct its values, or leave the particle out.",
      a == 0 ? "velocity" : "density", (long long)not_finite[a]);
  }
  for (int64_t s = 0; s < job->section_count; ++s)
  {
    MCOR_TRY(mcor_add_section(job, s));
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
  MCOR_RETURN_IF(!input || !options || count < 0 || (count > 0 && !sections), context,
    MCOR_INVALID_ARGUMENT,
    "input, options and sections must not be NULL, and count must not be negative.");
  MCOR_RETURN_IF((input->attribute_count != 1 && input->attribute_count != 2) || !input->attributes,
    context, MCOR_INVALID_ARGUMENT,
    "The input has %d attributes; fluxes need the velocity, and take the density as the second.",
    input->attribute_count);
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
