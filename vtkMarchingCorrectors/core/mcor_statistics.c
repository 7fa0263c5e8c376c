/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Where a call is: phases, progress, times and counts. */

#include "mcor_internal.h"

#include <math.h>
#include <stdio.h>

mcor_status mcor_begin_phase(mcor_context* context, mcor_phase phase, double fraction)
{
  const mcor_options* options = context->options;
  MCOR_TRY(mcor_finish(context));
  const double now = mcor_seconds();
  context->statistics->seconds[context->phase] += now - context->phase_begin;
  context->phase = phase;
  context->phase_begin = now;
  context->fraction = fraction;
  context->building_told = false;
  MCOR_RETURN_IF(options->progress &&
      options->progress(options->progress_user, fraction, mcor_phase_name(phase)) != 0,
    context, MCOR_CANCELLED, "The extraction was cancelled before phase \"%s\".",
    mcor_phase_name(phase));
  return MCOR_OK;
}

/* Numbers that are known at the end. */
mcor_status mcor_finish_statistics(mcor_context* context)
{
  mcor_statistics* s = context->statistics;
  const mcor_measure* m = &context->measure;
  const mcor_lattice* lattice = &context->lattice;
  const double n = context->correction_count;
  s->build_seconds = context->cl.build_seconds;
  s->fluid_particles = m->fluid_count;
  s->solid_particles = m->solid_count;
  s->smoothing_length_min = m->h_min;
  s->smoothing_length_max = m->h_max;
  s->cube_size = lattice->cube;
  s->scalar_min = m->scalar_min;
  s->scalar_max = m->scalar_max;
  s->virtual_cells = 1;
  for (int a = 0; a < 3; ++a)
  {
    s->lattice_origin[a] = lattice->origin[a] + lattice->first[a];
    s->lattice_cells[a] = lattice->last[a] - lattice->first[a];
    s->virtual_cells *= s->lattice_cells[a];
  }
  s->bricks = context->bricks.now.count;
  int nodes = 0;
  MCOR_TRY(mcor_count_bits(context, &context->bricks.now.known, context->bricks.now.count, &nodes));
  s->nodes_evaluated = nodes;
  s->correction_mean = n > 0 ? context->correction_sum / n : 0;
  s->correction_deviation = n > 0
    ? sqrt(fmax(context->correction_squares / n - s->correction_mean * s->correction_mean, 0))
    : 0;
  s->iterations_mean = s->vertices_corrected > 0
    ? (double)s->newton_evaluations / (double)s->vertices_corrected - 1
    : 0;
  s->device_bytes_peak = context->cl.bytes_peak;
  snprintf(s->device, sizeof s->device, "%s", context->cl.device_name);
  snprintf(s->platform, sizeof s->platform, "%s", context->cl.platform_name);
  return MCOR_OK;
}
