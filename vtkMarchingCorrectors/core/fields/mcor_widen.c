/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Widening: longer smoothing lengths make a smoother surface, as long as each particle stays inside
 * of the surface. mcor_widen makes the factors; mcor_extract takes them with its input.
 *
 * The rule. All sums are over fluid particles k; ramp(x, a, b) rises from 0 at a to 1 at b as
 * t^2 (3 - 2 t).
 *
 *   c(s)  = sum V_k W(x_j - x_k, s h_j)      the weight sum at particle j with its length times s
 *   n_k   = max(0, 1 - (r_jk / 2 h_j)^3), k other than j; N = sum n_k: the neighbours of j
 *   m     = |sum n_k (x_k - x_j)| / (max(N, 1) h_j): how far the neighbours' middle is from j
 *   taper = ramp(N, 2.2, 4.5)
 *   sided = ramp(m, 0.4, 0.6) (1.5 ramp(N, 4.5, 6) - 0.5)
 *   least = iso + 0.1 (1 - sided) - 0.08 max(sided, 0) ramp(c(widest), iso - 0.16, iso - 0.08)
 *   s     = the greatest in [1, widest] with c(s) >= least; 1 if there is none. Steps go down from
 *           widest through ..., 1.4, 1.2, 1; c is taken as linear between steps
 *   f     = 1 + (s - 1) taper
 *   mean  = the Shepard mean of f at particle j, with the lengths h
 *   the factor = max(1, min(f, mean)); where f = 1 and sided > 0:
 *           1 + 4 sided (1 - sided) (max(1, mean) - 1)
 *
 * widest: options.widen. iso: the iso value of the free surface, the greatest of several; 0.5 for
 * scalars. In the plane, the limits of N are multiplied by 0.31. */

#include "mcor_box.h"
#include "mcor_plane.h"
#include "mcor_probe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* At a widened particle with neighbours on both sides, the weight sum is above the iso value by at
 * least this number. */
#define MCOR_WIDEN_MARGIN 0.1

/* Numbers of neighbours, weighted by nearness. With fewer than the first number, a particle's
 * length is not widened; from the second number on, it is fully widened. A particle in a thread has
 * about 2 neighbours, in a sheet about 6; in two dimensions, in a line, about 2. */
#define MCOR_CROWD_FROM 2.2
#define MCOR_CROWD_TO 4.5
#define MCOR_CROWD_IN_PLANE 0.31 /* in the plane both numbers are multiplied by this */

/* ---- The device ---- */

typedef struct mcor_widen_run
{
  const mcor_context* context;
  const mcor_input* input;
  mcor_widening* out;
  double widest, iso;
  mcor_buffer sizes, factor, limited, wanted, list, outside;
  mcor_point_batch batch;
  /* For each sorted particle: whether it is in the box and is no periodic image. NULL: yes for
   * all. */
  cl_int* originals;
  void *order, *weight, *inv_h; /* views */
  void *factors, *is_outside;   /* views; NULL if only volumes are wanted */
} mcor_widen_run;

static void mcor_release_run(mcor_context* context, mcor_widen_run* run)
{
  MCOR_RELEASE(
    context, &run->sizes, &run->factor, &run->limited, &run->wanted, &run->list, &run->outside);
  MCOR_RELEASE_BEFORE(context, &run->batch, first);
  free(run->originals);
  run->originals = NULL;
}

/* Finds the factors of the sorted particles, and which particles are outside of the surface with
 * these factors. run->limited first holds `least`, the weight sum that each particle needs, then
 * the factors. */
static mcor_status mcor_find_factors(mcor_context* context, mcor_widen_run* run)
{
  const mcor_grid* grid = &context->grid;
  const int n = grid->count, lanes = context->cl.lanes, plane = mcor_is_plane(context);
  const int groups = (n + lanes - 1) / lanes;
  const double crowd = plane ? MCOR_CROWD_IN_PLANE : 1;
  const size_t bytes = ((size_t)n + MCOR_PADDING) * context->cl.real_size;
  int listed;
  MCOR_TRY(mcor_reserve(context, &run->sizes, bytes));
  MCOR_TRY(mcor_reserve(context, &run->factor, bytes));
  MCOR_TRY(mcor_reserve(context, &run->limited, bytes));
  MCOR_TRY(mcor_reserve(context, &run->wanted, ((size_t)n + 1) * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &run->outside, (size_t)n * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_widen_sizes", MCOR_LIGHT, n, MCOR_INT(n), MCOR_INT(plane),
    MCOR_BUFFER(&grid->inv_h), MCOR_BUFFER(mcor_fluid_weight(grid)), MCOR_BUFFER(&run->sizes)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_widen_try", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(plane), MCOR_REAL(run->widest), MCOR_REAL(run->iso), MCOR_REAL(MCOR_WIDEN_MARGIN),
    MCOR_REAL(crowd * MCOR_CROWD_FROM), MCOR_REAL(crowd * MCOR_CROWD_TO), MCOR_BUFFER(&run->sizes),
    MCOR_BUFFER(&run->factor), MCOR_BUFFER(&run->limited), MCOR_BUFFER(&run->wanted)));
  MCOR_TRY(mcor_scan(context, &run->wanted, n, &listed));
  if (listed > 0)
  {
    MCOR_TRY(mcor_reserve(context, &run->list, ((size_t)listed + 1) * sizeof(cl_int)));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_group_fill", MCOR_LIGHT, n + 1, MCOR_INT(0), MCOR_INT(n),
      MCOR_BUFFER(&run->wanted), MCOR_BUFFER(&run->list)));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_widen_solve", MCOR_HEAVY, (listed + lanes - 1) / lanes,
      MCOR_GRID_ARGS(context), MCOR_INT(plane), MCOR_REAL(run->widest), MCOR_REAL(run->iso),
      MCOR_REAL(MCOR_WIDEN_MARGIN), MCOR_BUFFER(&run->limited), MCOR_BUFFER(&run->sizes),
      MCOR_INT(listed), MCOR_BUFFER(&run->list), MCOR_BUFFER(&run->factor),
      MCOR_BUFFER(&run->outside)));
  }
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_widen_limit", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_REAL(run->widest), MCOR_REAL(run->iso), MCOR_REAL(MCOR_WIDEN_MARGIN),
    MCOR_BUFFER(&run->factor), MCOR_BUFFER(&run->limited)));
  return MCOR_LAUNCH(context, "mcor_widen_check", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(plane), MCOR_REAL(run->widest), MCOR_REAL(run->iso), MCOR_BUFFER(&run->sizes),
    MCOR_BUFFER(&run->limited), MCOR_BUFFER(&run->wanted), MCOR_BUFFER(&run->outside));
}

/* If the factors are wanted, writes them in the input's order, and marks the particles outside of
 * the surface. If volumes are wanted, writes the volumes, which follow from the weights. */
static void mcor_put_factors(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_widen_run* run = data;
  const mcor_context* context = run->context;
  const mcor_widening* out = run->out;
  const mcor_sph_kernel kernel = context->run.options->sph_kernel;
  const bool plane = mcor_is_plane(context);
  const double cube = context->lattice.cube,
               norm =
                 mcor_kernel_of(kernel)->norm * (plane ? mcor_kernel_of(kernel)->plane_factor : 1);
  for (int64_t i = first; i < last; ++i)
  {
    const int64_t to = mcor_source_of(context, ((const cl_int*)run->order)[i]);
    if (run->originals && !run->originals[i])
    {
      continue;
    }
    if (run->factors && !(run->input->solid && run->input->solid[to]))
    {
      out->factor[to] = mcor_get_real(context, run->factors, i);
      out->outside[to] = ((const cl_int*)run->is_outside)[i] != 0;
    }
    if (out->volume)
    {
      const double h = 1 / mcor_get_real(context, run->inv_h, i);
      out->volume[to] = mcor_get_real(context, run->weight, i) / norm * h * h *
        (plane ? cube * cube : h * cube * cube * cube);
    }
  }
  (void)slice;
}

/* Copies from the device to run->out the factors and the volumes, each if it is wanted. Also counts
 * the particles outside of the surface. */
static mcor_status mcor_deliver_factors(
  mcor_context* context, const mcor_input* input, mcor_widen_run* run)
{
  mcor_grid* grid = &context->grid;
  const size_t n = (size_t)grid->count, real = n * context->cl.real_size;
  const int count = run->out->factor ? 5 : 3;
  run->context = context;
  run->input = input;
  const mcor_mapping views[] = { { &grid->order, n * sizeof(cl_int), &run->order },
    { &grid->trim_weight, real, &run->weight }, { &grid->inv_h, real, &run->inv_h },
    { &run->limited, real, &run->factors },
    { &run->outside, n * sizeof(cl_int), &run->is_outside } };
  int first[3], last[3];
  if (mcor_bound_particles(context, first, last))
  {
    run->originals = malloc(n * sizeof(cl_int));
    MCOR_TRY(mcor_allocated(context, run->originals));
    MCOR_TRY(mcor_place_particles(context, &run->batch, 0, grid->count, true, first, last));
    MCOR_TRY(mcor_read(context, &context->points.flags, 0, run->originals, n * sizeof(cl_int)));
  }
  mcor_status status = mcor_map_all(context, views, count);
  MCOR_THEN(
    status, mcor_parallel_run(context, grid->count, MCOR_HEAVY_GRAIN, mcor_put_factors, run, NULL));
  for (int64_t i = 0; i < input->count && run->out->outside; ++i)
  {
    context->run.statistics->widening_outside += run->out->outside[i];
  }
  return mcor_unmap_all(context, views, count, status);
}

/* Returns an array of `count` ones; NULL: memory ran out. */
static double* mcor_make_ones(int64_t count)
{
  double* ones = malloc((size_t)(count > 0 ? count : 0) * sizeof *ones + 1);
  for (int64_t i = 0; i < count && ones; ++i)
  {
    ones[i] = 1;
  }
  return ones;
}

mcor_status mcor_read_volumes(mcor_context* context, const mcor_input* input, double** volume)
{
  *volume = mcor_make_ones(input->count);
  mcor_widening out = { .volume = *volume };
  mcor_widen_run run = { .out = &out };
  MCOR_TRY(mcor_allocated(context, *volume));
  const mcor_status status =
    context->grid.count > 0 ? mcor_deliver_factors(context, input, &run) : MCOR_OK;
  mcor_release_run(context, &run);
  return status;
}

/* Finds the widening factors of all particles. The box limits the call only if options->globals is
 * given; else it only tells mcor_leave_out_far which particles are too far away to matter. Without
 * particles, nothing is measured, so the statistics are not filled in. */
static mcor_status mcor_run_widen(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_widen_run* run = data;
  mcor_options own = *options;
  if (!options->globals)
  {
    memset(own.box, 0, sizeof own.box);
  }
  context->kept.grid = context->kept.value = context->kept.nodes = false;
  context->run.widest = run->widest;
  context->run.options = &own;
  mcor_status status = mcor_check_input(context, input, &own);
  if (input->count > 0)
  {
    mcor_bound_by_box(context, &own);
    MCOR_THEN(status, mcor_prepare(context, input, &own));
    if (context->grid.count > 0)
    {
      MCOR_THEN(status, mcor_begin_phase(context, MCOR_PHASE_SEARCH_GRID, 0.2, 0.8));
      MCOR_THEN(status, mcor_find_factors(context, run));
      MCOR_THEN(status, mcor_deliver_factors(context, input, run));
    }
    MCOR_THEN(status, mcor_finish_field(context));
  }
  mcor_release_run(context, run);
  context->run.options = options;
  return status;
}

/* ---- The call ---- */

mcor_status mcor_widen(mcor_context* context, const mcor_input* input, const mcor_options* options,
  mcor_widening* widening)
{
  MCOR_FAIL_IF(!context || !widening, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "widening");
  *widening = (mcor_widening){ 0 };
  MCOR_FAIL_IF(!input || !options, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "input and options");
  MCOR_TRY(mcor_check_spelled_out(context, options));
  MCOR_FAIL_IF(!(options->widen >= 1 && options->widen <= 4), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(WIDENING_ILLEGAL), options->widen);
  mcor_widen_run run = { .out = widening, .widest = options->widen, .iso = 0.5 };
  for (int i = 0; i < options->iso_count && options->field == MCOR_WEIGHT_SUM; ++i)
  {
    run.iso = i == 0 ? options->iso_values[0] : fmax(run.iso, options->iso_values[i]);
  }
  widening->count = input->count;
  widening->factor = mcor_make_ones(input->count);
  widening->outside = calloc((size_t)(input->count > 0 ? input->count : 0) + 1, 1);
  /* Particles that are not on the device keep the volume 1, which nobody reads. */
  widening->volume = mcor_needs_density(input) ? mcor_make_ones(input->count) : NULL;
  mcor_status status = mcor_allocated(context,
    widening->factor && widening->outside && (widening->volume || !mcor_needs_density(input)));
  /* Leaves out what the factors do not depend on. */
  mcor_input particles = *input;
  mcor_options own = *options;
  particles.widening = (mcor_array){ 0 };
  particles.attribute_count = 0;
  own.widen = 1;
  own.compact = own.smooth = 0;
  own.node_threshold = 0;
  own.outputs = 0;
  mcor_evaluate_without_scalar(&particles, &own);
  memcpy(own.box, options->box, sizeof own.box);
  MCOR_THEN(status,
    mcor_run_call(context, &particles, &own, mcor_uses_solids(input, options),
      &widening->statistics, mcor_run_widen, &run));
  context->kept.grid = context->kept.value = context->kept.nodes = false;
  return MCOR_OR_FREE(status, mcor_free_widening, widening);
}

void mcor_free_widening(mcor_widening* widening)
{
  if (widening)
  {
    free(widening->factor);
    free(widening->volume);
    free(widening->outside);
    *widening = (mcor_widening){ 0 };
  }
}

void mcor_add_widening(mcor_statistics* surface, const mcor_statistics* widening)
{
  surface->widening_outside = widening->widening_outside;
  surface->build_seconds += widening->build_seconds;
  for (int p = 0; p < MCOR_PHASE_COUNT; ++p)
  {
    surface->seconds[p] += widening->seconds[p];
  }
}
