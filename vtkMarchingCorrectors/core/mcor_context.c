/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The life of a context, and how every call on it runs. */

#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_cl_memory.h"
#include "mcor_input.h"
#include "mcor_plane.h"

#include <stdlib.h>

void mcor_set_default_options(mcor_options* options)
{
  if (!options)
  {
    return;
  }
  *options = (mcor_options){
    .outputs = MCOR_OUT_NORMALS,
#define OPTION(member, usual, legal, words, scope, property) .member = usual,
#include "mcor_options.def"
  };
}

void mcor_spell_out(mcor_options* options)
{
  if (options && options->smooth)
  {
    options->compact |= !options->filled; /* a filled region needs the points on all edges */
    options->widen = options->widen == 1 ? 2 : options->widen;
  }
}

mcor_status mcor_check_spelled_out(mcor_context* context, const mcor_options* options)
{
  MCOR_FAIL_IF(options->smooth &&
      ((!options->compact && !options->filled) || options->widen == 1), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(SMOOTH_NOT_SPELLED_OUT));
  return MCOR_OK;
}

/* Seconds between progress reports: short enough that cancelling is answered at once, long
 * enough that reports cost nothing. */
#define MCOR_REPORT_SECONDS 0.03

mcor_status mcor_create_context(const char* device, mcor_context** context)
{
  return mcor_create_shared_context(device, 0, 1, context);
}

mcor_status mcor_create_shared_context(
  const char* device, int place, int count, mcor_context** context)
{
  if (!context)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  *context = calloc(1, sizeof **context);
  if (!*context)
  {
    return MCOR_OUT_OF_CAPACITY;
  }
  (*context)->report_interval = MCOR_REPORT_SECONDS;
  mcor_status status = place >= 0 && place < count
    ? mcor_open_device(*context, device, place, count)
    : mcor_fail(*context, MCOR_INVALID_ARGUMENT, MCOR_SAY(PLACE_ILLEGAL), place, count - 1);
  MCOR_THEN(status, mcor_upload_case_table(*context));
  (*context)->created = status == MCOR_OK;
  return status;
}

void mcor_release_memory(mcor_context* context)
{
  if (!context)
  {
    return;
  }
  MCOR_RELEASE_EACH(context, &context->stage);
  MCOR_RELEASE_EACH(context, &context->sort);
  mcor_release_grid(context);
  MCOR_RELEASE_BEFORE(context, &context->bricks, now);
  mcor_release_brick_data(context, &context->bricks.now);
  MCOR_RELEASE_BEFORE(context, &context->mesh, march_count);
  mcor_release_attributes(context);
  MCOR_RELEASE(context, &context->box.cells, &context->box.clipped);
  mcor_release_adaptive(context);
  MCOR_RELEASE_EACH(context, &context->points);
  MCOR_RELEASE_EACH(context, &context->topology);
  MCOR_RELEASE_EACH(context, &context->trim);
  MCOR_RELEASE_EACH(context, &context->pairs);
  mcor_release(context, &context->scan_sums);
  mcor_drop_kept(context, 0);
  mcor_drop_locked(context);
  free(context->source);
  context->source = NULL;
  free(context->attributes.varying);
  context->attributes.varying = NULL;
  context->attributes.varying_count = 0;
}

void mcor_release_all_data(mcor_context* context)
{
  mcor_release_memory(context);
  MCOR_RELEASE(context, &context->cases, &context->case_rows);
  mcor_drop_kept(context, 0);
}

void mcor_free_context(mcor_context* context)
{
  if (!context)
  {
    return;
  }
  mcor_release_all_data(context);
  mcor_close_device(context);
  mcor_close_profile(context);
  mcor_end_pool(&context->pool);
  free(context);
}

/* Turns arrays that have the same value for all particles into constants, so that these arrays are
 * not read again. */
static void mcor_find_constants(mcor_context* context, mcor_input* input)
{
  mcor_array* const arrays[] = { &input->smoothing_length, &input->volume, &input->mass,
    &input->density };
  for (int k = 0; k < (input->count > 0 ? 4 : 0); ++k)
  {
    mcor_array* array = arrays[k];
    const double first = mcor_array_at(array, 0, 0);
    if (array->data && first > 0 && mcor_array_at(array, input->count / 2, 0) == first &&
      mcor_array_at(array, input->count - 1, 0) == first)
    {
      const mcor_findings found =
        mcor_find_range(context, array, NULL, MCOR_SKIP_ABSENT, input->count, 0);
      array->constant = first;
      array->data = found.least[0] < found.most[0] ? array->data : NULL;
    }
  }
}

/* Prepares the search grid and the scalar for these options. Reuses what is still valid of the last
 * call. */
mcor_status mcor_prepare(
  mcor_context* context, const mcor_input* given, const mcor_options* options)
{
  mcor_input own = *given, *input = &own;
  mcor_check_reuse(context, given, options);
  if (!context->kept.grid)
  {
    mcor_find_constants(context, input);
  }
  context->kept.uses_solids = context->run.uses_solids;
  if (!context->kept.value)
  {
    MCOR_TRY(mcor_measure_input(context, input, options));
  }
  MCOR_TRY(mcor_measure_wall(context, input));
  const mcor_measure* m = &context->measure;
  context->cl.terms =
    fmin(m->neighbours * pow(options->h_scale, 3), (double)(m->fluid_count + m->solid_count));
  mcor_place_box(context, options);
  context->grid.has_solids = context->measure.solid_count > 0 && context->run.uses_solids;
  const mcor_build build = mcor_build_of(options, context->grid.has_solids);
  MCOR_TRY(mcor_choose_build(context, &build));
  if (!context->kept.grid)
  {
    mcor_release_adaptive(context);
    mcor_release_grid(context); /* makes room for this call's particles */
    MCOR_TRY(mcor_make_grid(context, input));
  }
  if (!context->kept.value)
  {
    MCOR_TRY(mcor_set_scalar(context, input));
  }
  MCOR_RELEASE_EACH(context, &context->stage);
  MCOR_RELEASE_EACH(context, &context->sort);
  if (!context->kept.nodes)
  {
    mcor_release_brick_data(context, &context->bricks.now);
  }
  context->kept.grid = context->kept.value = context->kept.nodes = true;
  return MCOR_OK;
}

/* Runs a call. With globals, leaves out the particles that were left out as far away when the
 * globals were measured. Without globals, runs the body again without far particles if the lattice
 * around all particles is too long. After a failure, or if particles were left out, later calls
 * reuse nothing. */
static mcor_status mcor_try_call(mcor_context* context, const mcor_input* input,
  const mcor_options* options, bool uses_solids, mcor_statistics* statistics, mcor_body body,
  void* result)
{
  context->error[0] = '\0';
  context->run = (mcor_run){ .options = options,
    .uses_solids = uses_solids,
    .statistics = statistics,
    .phase = MCOR_PHASE_INPUT,
    .phase_begin = mcor_seconds(),
    .doing = mcor_phase_name(MCOR_PHASE_INPUT),
    .fraction = context->run.fraction,
    .fraction_end = 0.1,
    .report_time = mcor_seconds() };
  context->cl.build_seconds = 0;
  context->cl.observer = options->progress ? mcor_observe_call : NULL;
  context->grid.view = 0;
  mcor_begin_buffers(context);
  mcor_flat flat;
  mcor_status status = mcor_find_plane(context, input, options, &flat);
  if (status == MCOR_OK && mcor_is_plane(context))
  {
    status = mcor_flatten(context, input, options, &flat);
  }
  context->run.options = &flat.options;
  if (!options->globals)
  {
    mcor_move_period(&flat.options);
  }
  mcor_far far = { 0 };
  if (status == MCOR_OK && flat.options.globals && flat.options.globals->measured.far_count > 0)
  {
    status = mcor_leave_out_again(context, &flat.input, &flat.options, &far);
    flat.input.solid = far.solid;
  }
  MCOR_THEN(status, body(context, &flat.input, &flat.options, result));
  if (status == MCOR_OUT_OF_CAPACITY && context->run.is_too_long && !options->globals)
  {
    status = mcor_leave_out_far(context, &flat.input, &far);
    flat.input.solid = status == MCOR_OK ? far.solid : flat.input.solid;
    context->run.far = status == MCOR_OK ? &far : NULL;
    MCOR_THEN(status, body(context, &flat.input, &flat.options, result));
  }
  if (status == MCOR_OUT_OF_CAPACITY)
  {
    mcor_blame_outlier(context, &flat.input);
  }
  mcor_end_building(&context->cl);
  mcor_end_pool(&context->pool);
  status = mcor_write_profile(context, statistics, status);
  const bool is_all = !far.solid;
  mcor_keep_call(context, &flat.input, &flat.options);
  free(flat.positions);
  free(far.solid);
  context->cl.observer = NULL;
  context->run = (mcor_run){ .fraction = context->run.fraction };
  context->box.of_points = context->box.has_points = false; /* later calls have other points, or
                                                             * none */
  if (status != MCOR_OK || !is_all)
  {
    context->kept.grid = context->kept.value = context->kept.nodes = false;
  }
  return status;
}

mcor_status mcor_run_call(mcor_context* context, const mcor_input* input,
  const mcor_options* options, bool uses_solids, mcor_statistics* statistics, mcor_body body,
  void* result)
{
  if (!context->created)
  {
    return MCOR_DEVICE_ERROR; /* the error sentence says why */
  }
  mcor_cl* cl = &context->cl;
  const uint64_t limit = options->memory_limit > 0 ? (uint64_t)options->memory_limit : UINT64_MAX;
  const int64_t held = cl->bytes;
  cl->memory_limit = limit < cl->device_memory ? limit : cl->device_memory;
  context->run.fraction = 0;
  mcor_sight sight;
  mcor_status status = mcor_see_input(context, input, &sight);
  if (status == MCOR_OK)
  {
    status = mcor_try_call(context, &sight.input, options, uses_solids, statistics, body, result);
    if (status == MCOR_OUT_OF_CAPACITY)
    {
      mcor_release_memory(context);
      if (held > cl->bytes && !options->ranks) /* a second attempt would need all ranks */
      {
        status =
          mcor_try_call(context, &sight.input, options, uses_solids, statistics, body, result);
      }
    }
    if (status == MCOR_OUT_OF_CAPACITY)
    {
      mcor_release_memory(context); /* lets a smaller input find room */
    }
  }
  mcor_end_sight(&sight);
  return status;
}
