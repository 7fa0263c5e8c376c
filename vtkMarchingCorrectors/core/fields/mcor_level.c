/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds weight sums for gauges and fluxes, by the functions of mcor_probe.c. */

#include "mcor_level.h"
#include "mcor_box.h"
#include "mcor_plane.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MCOR_USUAL_LEVEL 0.5

mcor_label mcor_label_of(const char* name, int64_t number)
{
  mcor_label label;
  snprintf(label.text, sizeof label.text, "number %lld", (long long)number);
  if (name)
  {
    snprintf(label.text, sizeof label.text, "'%.70s'", name);
  }
  return label;
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

/* Let T be the weight sum of fluid and solids, F the fluid's own sum, and `share` the least share
 * of T that the fluid must have. The fluid ends where T is below the level, or F below share T. The
 * lowered sum is the lesser of T and level + (F - share T) / (1 - share); the second number equals
 * the level where F is exactly share T. If F is 0, or equals T, the lowered sum is F. */
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

mcor_status mcor_run_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, double margin, mcor_status (*work)(mcor_level_job*))
{
  mcor_context* context = job->context;
  const bool has_box = job->has_box;
  if (has_box && mcor_is_plane(context))
  {
    mcor_flatten_sides(&context->plane, job->box, job->box);
  }
  MCOR_FAIL_IF(has_box && margin > mcor_reach_margin(options, options->globals, 0), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(CUBE_TOO_SMALL_FOR_GAUGES), options->globals->measured.cube);
  for (int a = 0; a < 3; ++a) /* the box bounds points at which the field is evaluated, not cells */
  {
    context->box.points[2 * a] = has_box ? job->box[2 * a] - margin : job->around.least[a];
    context->box.points[2 * a + 1] = has_box ? job->box[2 * a + 1] + margin : job->around.most[a];
  }
  context->box.has_points = true;
  /* Only particles near these points are used, unless later calls may reuse the search grid. */
  context->box.of_points = has_box || input->particles_version == 0 || context->run.far;
  MCOR_TRY(mcor_prepare(context, input, options));
  if (context->grid.count == 0)
  {
    return mcor_finish_field(context);
  }
  for (int a = 0; a < 3 && has_box; ++a)
  {
    mcor_place_sides(&context->lattice, a, job->box, job->owned[a]);
  }
  const bool ends_at_solids = mcor_ends_at_solids(context);
  double* places = malloc(3 * (size_t)MCOR_LEVEL_BATCH * sizeof *places);
  mcor_samples samples = { .valid = malloc(MCOR_LEVEL_BATCH) };
  const mcor_array points = { .data = places, .type = MCOR_FLOAT64, .components = 3 };
  mcor_probe_run run = {
    .context = context, .input = input, .points = &points, .samples = &samples
  };
  job->run = &run;
  job->with_solids = ends_at_solids ? malloc(MCOR_LEVEL_BATCH * sizeof *places) : NULL;
  mcor_status status =
    mcor_allocated(context, places && samples.valid && (job->with_solids || !ends_at_solids));
  MCOR_THEN(status, mcor_load_attributes(context, input, 0));
  MCOR_THEN(status, work(job));
  mcor_release_probe(&run);
  free(places);
  free(samples.valid);
  free(job->with_solids);
  return status != MCOR_OK ? status : mcor_finish_field(context);
}

mcor_status mcor_call_level(mcor_level_job* job, const mcor_input* input,
  const mcor_options* options, const char* who, mcor_body body, mcor_statistics* statistics)
{
  mcor_input given = *input;
  mcor_options own = *options;
  job->level =
    options->iso_count > 0 && options->iso_values ? options->iso_values[0] : MCOR_USUAL_LEVEL;
  MCOR_FAIL_IF(options->iso_count > 1 || !(job->level > 0) || !isfinite(job->level), job->context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(FLUID_LEVEL), who);
  job->around = mcor_no_findings();
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
    job->context, &given, &own, mcor_uses_solids(input, &own), statistics, body, job);
}
