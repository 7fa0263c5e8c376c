/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* mcor_extract: the phases in order. Section numbers in brackets, here and in the phases' files,
 * are those of the paper named in mcor.h. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_compact.h"
#include "mcor_fill.h"
#include "mcor_plane.h"

/* Appends the surface of one iso value. */
static mcor_status mcor_extract_iso(
  mcor_context* context, const mcor_input* input, int i, mcor_surface* surface)
{
  const mcor_options* options = context->run.options;
  const bool last = i + 1 == options->iso_count;
  const double value = options->iso_values[i];
  context->run.iso = (mcor_iso){ i, value, value - context->value_shift };
  const double begin = 0.15 + 0.85 * i / options->iso_count, step = 0.85 / options->iso_count;
  /* [III-B, III-C] */
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_SEEDS, begin, begin + 0.2 * step));
  MCOR_TRY(mcor_select_seeds(context, input));
  /* [III-D.1] */
  MCOR_TRY(
    mcor_begin_phase(context, MCOR_PHASE_EXTRACTION, begin + 0.2 * step, begin + 0.5 * step));
  MCOR_TRY(mcor_march(context));
  if (last && input->scalar_version == 0)
  {
    mcor_release_nodes(context);
  }
  /* [III-D.2] */
  MCOR_TRY(
    mcor_begin_phase(context, MCOR_PHASE_CORRECTION, begin + 0.5 * step, begin + 0.7 * step));
  if (context->mesh.march_count > 0 || mcor_makes_caps(context))
  {
    MCOR_TRY(mcor_load_attributes(context, input, 0));
  }
  MCOR_TRY(mcor_correct(context));
  /* [III-D.3] */
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_TRIMMING, begin + 0.7 * step, begin + 0.8 * step));
  MCOR_TRY(mcor_trim(context));
  MCOR_TRY(mcor_cap(context));
  MCOR_TRY(options->compact && mcor_compacts_late(context) ? mcor_compact(context) : MCOR_OK);
  MCOR_TRY(mcor_take_lines(context));
  /* [III-D.4] */
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, begin + 0.8 * step, begin + step));
  mcor_release(context, &context->attributes.sorted);
  if (last && input->particles_version == 0 && !mcor_output_evaluates(context) && !options->filled)
  {
    mcor_release_grid(context);
  }
  return mcor_append_output(context, input, false, surface);
}

static mcor_status mcor_extract_all(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* result)
{
  mcor_surface* surface = result;
  mcor_free_surface(surface); /* left by a failed attempt */
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_RETURN_IF(options->ranks && !options->globals, context, MCOR_INVALID_ARGUMENT,
    "options.ranks is set, but options.globals is not. Call mcor_measure_globals on all ranks "
    "first.");
  MCOR_TRY(mcor_begin_surface(context, input, surface));
  if (input->count == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_prepare(context, input, options)); /* [III-A] */
  MCOR_TRY(context->grid.count > 0 ? mcor_check_caps(context) : MCOR_OK);
  MCOR_RETURN_IF(options->filled && options->compact, context, MCOR_INVALID_ARGUMENT,
    "Filling needs the points on all edges of the virtual grid, which a compact contour lacks. Turn "
    "one of them off.");
  MCOR_RETURN_IF(options->filled && !mcor_is_plane(context), context, MCOR_INVALID_ARGUMENT,
    "Filling is for two dimensions, but these particles do not lie in a plane. Turn filling off.");
  MCOR_RETURN_IF(mcor_uses_pairs(context) && mcor_is_adaptive(&context->lattice), context,
    MCOR_INVALID_ARGUMENT,
    "Pair seeds need cubes of one size, and here cubes have up to %d. Choose uniform cubes, or "
    "complete seeds.",
    context->lattice.levels);
  MCOR_TRY(context->grid.count > 0 ? mcor_begin_fill(context) : MCOR_OK);
  for (int i = 0; i < options->iso_count && context->grid.count > 0; ++i)
  {
    MCOR_TRY(mcor_extract_iso(context, input, i, surface));
  }
  MCOR_TRY(mcor_fill_lines(context, input, surface));
  if (surface->normals)
  {
    MCOR_TRY(mcor_is_plane(context) ? mcor_finish_line_normals(context, surface)
                                    : mcor_finish_normals(context, surface));
  }
  MCOR_TRY(mcor_crop_surface(context, input, surface));
  MCOR_TRY(mcor_is_plane(context) ? mcor_finish_lines(context, surface) : MCOR_OK);
  MCOR_TRY(mcor_measure_surface(context, surface));
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* Reports the progress of a further run inside a run that is nearly done. */
static int mcor_report_end(void* user, double fraction, const char* phase)
{
  const mcor_options* options = user;
  (void)fraction;
  return options->progress(options->progress_user, 1, phase);
}

/* Finds whether the node threshold is why a surface is empty, by a run without it. A failure of
 * that run is ignored. */
static void mcor_count_below_threshold(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_statistics* statistics)
{
  mcor_surface surface = { 0 };
  mcor_options own = *options;
  mcor_input without = *input;
  if (own.progress)
  {
    own.progress = mcor_report_end;
    own.progress_user = (void*)(uintptr_t)options;
  }
  own.node_threshold = 0;
  own.preview = 1;
  own.outputs = 0;
  own.capping = own.filled = own.compact = 0;
  without.attribute_count = 0;
  if (mcor_run_call(context, &without, &own, mcor_uses_solids(input, options), &surface.statistics,
        mcor_extract_all, &surface) == MCOR_OK)
  {
    statistics->triangles_below_threshold = surface.statistics.triangles_before_trimming;
  }
  mcor_free_surface(&surface);
  context->kept.value = context->kept.nodes = false;
}

mcor_status mcor_extract(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface)
{
  if (!context || !surface)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *surface = (mcor_surface){ 0 };
  MCOR_RETURN_IF(
    !input || !options, context, MCOR_INVALID_ARGUMENT, "input and options must not be NULL.");
  MCOR_TRY(mcor_check_spelled_out(context, options));
  MCOR_RETURN_IF(options->widen != 1 && !mcor_is_given(&input->widening), context,
    MCOR_INVALID_ARGUMENT,
    "options.widen is %g, but input.widening is missing: the factors that mcor_widen finds.",
    options->widen);
  const mcor_status status = mcor_run_call(context, input, options,
    mcor_uses_solids(input, options), &surface->statistics, mcor_extract_all, surface);
  const mcor_statistics* s = &surface->statistics;
  bool may_exist = false;
  for (int i = 0; status == MCOR_OK && i < options->iso_count; ++i)
  {
    may_exist = may_exist || options->field != MCOR_SHEPARD ||
      (options->iso_values[i] >= s->scalar_min && options->iso_values[i] <= s->scalar_max);
  }
  if (may_exist && s->triangles_before_trimming == 0 && s->fluid_particles > 0 &&
    options->field != MCOR_WEIGHT_SUM && options->node_threshold > 0 &&
    !options->ranks && !options->globals)
  {
    mcor_count_below_threshold(context, input, options, &surface->statistics);
  }
  if (status != MCOR_OK)
  {
    mcor_free_surface(surface);
  }
  return status;
}
