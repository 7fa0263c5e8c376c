/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Progress, phases, times and counts of a call. */

#include "mcor_plane.h"

#include <math.h>
#include <stdio.h>

mcor_status mcor_report(mcor_context* context, const char* doing, double fraction, double end)
{
  const mcor_options* options = context->run.options;
  context->run.doing = doing;
  context->run.fraction =
    fmax(fraction, context->run.fraction); /* a second attempt reports no less than the first did */
  context->run.fraction_end = end;
  context->run.report_time = mcor_seconds();
  context->run.building_told = false;
  MCOR_FAIL_IF(options->progress &&
      options->progress(options->progress_user, context->run.fraction, doing) != 0,
    context, MCOR_CANCELLED, MCOR_SAY(CANCELLED), doing);
  return MCOR_OK;
}

/* The number of launches to come is not known, so each report advances by a share of what is
 * left. */
#define MCOR_REPORT_STEP 0.125

mcor_status mcor_report_launch(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  if (!options || !options->progress ||
    mcor_seconds() - context->run.report_time < context->report_interval)
  {
    return MCOR_OK;
  }
  const double rest = fmax(context->run.fraction_end - context->run.fraction, 0);
  return mcor_report(context, context->run.doing, context->run.fraction + MCOR_REPORT_STEP * rest,
    context->run.fraction_end);
}

/* Seconds between two reports of how long building may still take. */
#define MCOR_REST_SECONDS 0.5

mcor_status mcor_observe_call(mcor_context* context, bool compiles)
{
  const mcor_options* options = context->run.options;
  if (!compiles)
  {
    return mcor_report_launch(context);
  }
  const double rest = mcor_build_rest(&context->cl), now = mcor_seconds();
  if (context->run.building_told && (rest == 0 || now - context->run.report_time < MCOR_REST_SECONDS))
  {
    return MCOR_OK;
  }
  char text[sizeof MCOR_BUILDING + 40] = MCOR_BUILDING;
  if (rest > 0)
  {
    snprintf(text, sizeof text, MCOR_BUILDING ", about %.0f s to come", ceil(rest));
  }
  context->run.building_told = true;
  context->run.report_time = now;
  MCOR_FAIL_IF(options->progress(options->progress_user, context->run.fraction, text) != 0, context,
    MCOR_CANCELLED, MCOR_SAY(CANCELLED_BUILDING));
  return MCOR_OK;
}

mcor_status mcor_begin_phase(mcor_context* context, mcor_phase phase, double fraction, double end)
{
  MCOR_TRY(mcor_finish(context));
  const double now = mcor_seconds();
  const double built = context->cl.build_seconds; /* time spent building is not part of the phase's seconds */
  context->run.statistics->seconds[context->run.phase] +=
    now - context->run.phase_begin - (built - context->run.phase_built);
  context->run.phase = phase;
  context->run.phase_begin = now;
  context->run.phase_built = built;
  return mcor_report(context, mcor_phase_name(phase), fraction, end);
}

double mcor_rounding(const mcor_context* context)
{
  return 0.5 * ldexp(context->lattice.cube, -context->lattice.fix_bits);
}

/* Fills in the numbers that are known only at the end. */
mcor_status mcor_finish_statistics(mcor_context* context)
{
  mcor_statistics* s = context->run.statistics;
  const mcor_measure* m = &context->measure;
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  const double n = context->run.correction_count;
  s->build_seconds = context->cl.build_seconds;
  s->fluid_particles = m->fluid_count;
  s->solid_particles = m->solid_count;
  s->lone_particles = m->lone_count;
  s->far_particles = m->far_count;
  s->far_first = m->far_first;
  s->particles_in_reach = context->grid.count;
  s->widening_min = m->widening_min;
  s->widening_max = m->widening_max;
  s->widening_mean = m->fluid_count > 0 ? ldexp((double)m->widening_sum, -23) / (double)m->fluid_count : 0;
  s->smoothing_length_min = m->h_min;
  s->smoothing_length_max = m->h_max;
  s->smoothing_length_median = m->h_median;
  s->neighbours_median = m->neighbours;
  s->spacing_median = m->spacing;
  s->filled_median = m->filled;
  for (int a = 0; a < 3; ++a)
  {
    s->fluid_extent[a] = m->x_high[a] < m->x_low[a] ? 0 : m->x_high[a] - m->x_low[a];
    s->plane_normal[a] = m->plane_normal[a];
    s->far_place[a] = m->far_place[a];
  }
  s->plane_extent = m->plane_extent;
  s->wall_share = m->solid_count > 0 && context->kept.uses_solids ? mcor_wall_share(context) : 0;
  s->dimension = context->space.axes;
  s->cube_size = fmin(lattice->edge[0], fmin(lattice->edge[1], lattice->edge[2]));
  s->position_error = sqrt(s->dimension) * mcor_rounding(context);
  s->highest_level = lattice->levels - 1;
  s->scalar_min = m->scalar_min;
  s->scalar_max = m->scalar_max;
  s->virtual_cells = 1;
  for (int a = 0; a < 3; ++a)
  {
    const int64_t first = box->is_part ? box->first[a] : lattice->first[a];
    const int64_t last = box->is_part ? box->last[a] : lattice->last[a];
    s->cube_edges[a] = lattice->edge[a];
    s->lattice_origin[a] = lattice->origin[a] + first;
    s->lattice_cells[a] = last > first ? last - first : 0;
    s->virtual_cells *= s->lattice_cells[a];
  }
  s->bricks = context->bricks.now.count;
  const mcor_buffer* known = &context->bricks.now.known;
  int nodes = 0;
  MCOR_TRY(mcor_count_bits(context, known, known, context->bricks.now.count, &nodes));
  s->nodes_evaluated = nodes / MCOR_BRICK_NODES * context->space.brick_nodes;
  mcor_unflatten_statistics(&context->plane, s);
  s->correction_count = (int64_t)n;
  s->correction_mean = n > 0 ? context->run.correction_sum / n : 0;
  s->correction_deviation = n > 0
    ? sqrt(fmax(context->run.correction_squares / n - s->correction_mean * s->correction_mean, 0))
    : 0;
  s->iterations_mean = s->vertices_corrected > 0
    ? (double)context->run.evaluations_counted / (double)s->vertices_corrected - 1
    : 0;
  s->device_bytes_peak = context->cl.bytes_peak;
  snprintf(s->device, sizeof s->device, "%s", context->cl.device_name);
  snprintf(s->platform, sizeof s->platform, "%s", context->cl.platform_name);
  return MCOR_OK;
}
