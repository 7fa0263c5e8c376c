/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* mcor_extract: the phases in order. Numbers in brackets, here and in the phases' files, are
 * sections of the paper named in mcor.h. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_compact.h"
#include "mcor_input.h"
#include "mcor_plane.h"

/* Returns whether cubes may have several sizes. Looks at the smoothing lengths of about a thousand
 * particles. */
static bool mcor_may_be_adaptive(const mcor_input* input, const mcor_options* options)
{
  double low = INFINITY, high = 0;
  for (int64_t i = 0; i < input->count && options->level_limit > 0; i += 1 + input->count / 1024)
  {
    const double h = mcor_array_at(&input->smoothing_length, i, 0);
    low = fmin(low, h);
    high = fmax(high, h);
  }
  return low > 0 && high >= 2 * low;
}

bool mcor_has_solids(const mcor_input* input, const mcor_options* options)
{
  const mcor_globals* globals = options->globals;
  bool has = globals && globals->measured.solid_count > 0;
  for (int64_t i = 0; i < input->count && input->solid && !globals && !has; ++i)
  {
    has = input->solid[i] != 0 && input->solid[i] != MCOR_ABSENT;
  }
  return has && mcor_uses_solids(input, options);
}

int mcor_list_programs(const mcor_context* context, const mcor_input* input,
  const mcor_options* options, bool has_solids)
{
  const bool pairs = mcor_wants_pairs(options);
  bool has_sides = mcor_has_box(options);
  for (int a = 0; a < 3; ++a)
  {
    has_sides = has_sides || options->periodic[2 * a] < options->periodic[2 * a + 1];
  }
  const unsigned shape =
    MCOR_OUT_BOUNDARY_EIGENVALUE | MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_GAUSS_CURVATURE;
  const struct
  {
    mcor_program program;
    bool is_needed;
  } rows[] = { { MCOR_PROGRAM_GRID, true }, { MCOR_PROGRAM_BRICKS, true },
    { MCOR_PROGRAM_NODES, true }, { MCOR_PROGRAM_CELLS, true }, { MCOR_PROGRAM_VERTICES, true },
    { MCOR_PROGRAM_TRIM, options->field != MCOR_WEIGHT_SUM || has_solids },
    { MCOR_PROGRAM_DENSITY, mcor_needs_density(input) },
    { MCOR_PROGRAM_ATTRIBUTES,
      (options->outputs & MCOR_OUT_NEAREST_PARTICLE) != 0 ||
        mcor_count_components(input) > MCOR_ATTRIBUTE_LIMIT },
    { MCOR_PROGRAM_LEAVES, mcor_may_be_adaptive(input, options) },
    { MCOR_PROGRAM_CHOICES, pairs || has_sides || options->topology == MCOR_TOPOLOGY_FIELD },
    { MCOR_PROGRAM_RARE, pairs || mcor_is_plane(context) },
    { MCOR_PROGRAM_SHAPE,
      (options->outputs & shape) != 0 || options->capping ||
        options->boundary_detection == MCOR_BOUNDARY_EIGENVALUE } };
  int programs = 0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i)
  {
    programs |= rows[i].is_needed << rows[i].program;
  }
  return programs;
}

/* Begins to build the programs that the surface needs. The built-in device has them already. */
static mcor_status mcor_begin_building(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  if (context->cl.pool)
  {
    return MCOR_OK;
  }
  const bool has_solids = mcor_has_solids(input, options);
  const mcor_build build = mcor_build_of(options, has_solids);
  return mcor_build_ahead(context, &build, mcor_list_programs(context, input, options, has_solids));
}

/* Makes the surface of iso value number i, and appends it to `surface`. */
static mcor_status mcor_extract_iso(
  mcor_context* context, const mcor_input* input, int i, mcor_surface* surface)
{
  const mcor_options* options = context->run.options;
  const bool last = i + 1 == options->iso_count;
  const double value = options->iso_values[i];
  context->run.iso = (mcor_iso){ i, value, value - context->value_shift };
  const double begin = 0.15 + 0.85 * i / options->iso_count, step = 0.85 / options->iso_count;
  /* Seeds [III-B, III-C]. */
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_SEEDS, begin, begin + 0.2 * step));
  MCOR_TRY(mcor_select_seeds(context, input));
  /* Marching cubes [III-D.1]. */
  MCOR_TRY(
    mcor_begin_phase(context, MCOR_PHASE_EXTRACTION, begin + 0.2 * step, begin + 0.5 * step));
  MCOR_TRY(mcor_march(context));
  if (last && input->scalar_version == 0)
  {
    mcor_release_nodes(context);
  }
  /* Correction [III-D.2]. */
  MCOR_TRY(
    mcor_begin_phase(context, MCOR_PHASE_CORRECTION, begin + 0.5 * step, begin + 0.7 * step));
  if (context->mesh.march_count > 0 || mcor_makes_caps(context))
  {
    MCOR_TRY(mcor_load_attributes(context, input, 0));
  }
  MCOR_TRY(mcor_correct(context));
  /* Trimming, caps, compaction and filling [III-D.3]. */
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_TRIMMING, begin + 0.7 * step, begin + 0.8 * step));
  MCOR_TRY(mcor_trim(context));
  context->mesh.cap_first = context->mesh.vertex_count;
  context->mesh.cap_triangle_first = context->mesh.triangle_count;
  if (mcor_makes_caps(context))
  {
    MCOR_TRY(mcor_cap(context));
  }
  if (options->compact)
  {
    MCOR_TRY(mcor_compact(context));
  }
  if (options->filled)
  {
    MCOR_TRY(mcor_take_lines(context));
  }
  /* Output [III-D.4]. */
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, begin + 0.8 * step, begin + step));
  mcor_release(context, &context->attributes.sorted);
  if (last && input->particles_version == 0 && !mcor_output_evaluates(context) && !options->filled)
  {
    mcor_release_grid(context);
  }
  return mcor_append_output(context, input, false, surface);
}

static mcor_status mcor_extract_all(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface)
{
  MCOR_TRY(mcor_check_input(context, input, options));
  MCOR_FAIL_IF(options->ranks && !options->globals, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(RANKS_WITHOUT_GLOBALS));
  MCOR_TRY(mcor_begin_surface(context, input, surface));
  if (input->count == 0)
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_begin_building(context, input, options));
  MCOR_TRY(mcor_prepare(context, input, options)); /* [III-A] */
  MCOR_FAIL_IF(options->filled && options->compact, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(FILLED_WITH_COMPACT));
  MCOR_FAIL_IF(options->filled && !mcor_is_plane(context), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(FILLED_IN_SPACE));
  MCOR_FAIL_IF(mcor_uses_pairs(context) && mcor_is_adaptive(&context->lattice), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(PAIRS_WITH_LEVELS), context->lattice.levels);
  const bool has_particles = context->grid.count > 0; /* the particles that reach the box */
  if (has_particles && options->filled)
  {
    MCOR_TRY(mcor_begin_fill(context));
  }
  for (int i = 0; i < options->iso_count && has_particles; ++i)
  {
    MCOR_TRY(mcor_extract_iso(context, input, i, surface));
  }
  if (options->filled)
  {
    MCOR_TRY(mcor_fill_lines(context, input, surface));
  }
  if (surface->normals && mcor_is_plane(context))
  {
    MCOR_TRY(mcor_finish_line_normals(context, surface));
  }
  else if (surface->normals)
  {
    MCOR_TRY(mcor_finish_normals(context, surface));
  }
  MCOR_TRY(mcor_crop_surface(context, input, surface));
  if (mcor_is_plane(context))
  {
    MCOR_TRY(mcor_finish_lines(context, surface));
  }
  MCOR_TRY(mcor_measure_surface(context, surface));
  MCOR_TRY(mcor_begin_phase(context, MCOR_PHASE_OUTPUT, 1, 1));
  return mcor_finish_statistics(context);
}

/* Makes the surface, then frees what the phases keep on the host. */
static mcor_status mcor_extract_body(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* result)
{
  mcor_surface* surface = result;
  mcor_free_surface(surface); /* a failed attempt may have left data here */
  const mcor_status status = mcor_extract_all(context, input, options, surface);
  mcor_end_box(context);
  if (options->capping || options->filled)
  {
    mcor_end_caps(context);
    mcor_end_fill(context);
  }
  return status;
}

mcor_status mcor_extract(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface)
{
  MCOR_FAIL_IF(!context || !surface, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "surface");
  *surface = (mcor_surface){ 0 };
  MCOR_FAIL_IF(!input || !options, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "input and options");
  MCOR_TRY(mcor_check_spelled_out(context, options));
  MCOR_FAIL_IF(options->widen != 1 && !mcor_is_given(&input->widening), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(WIDENING_MISSING), options->widen);
  const mcor_status status = mcor_run_call(context, input, options,
    mcor_uses_solids(input, options), &surface->statistics, mcor_extract_body, surface);
  return MCOR_OR_FREE(status, mcor_free_surface, surface);
}
