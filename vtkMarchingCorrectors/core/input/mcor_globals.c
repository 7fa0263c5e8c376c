/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Measures all particles, for later calls that have only some of the particles. */

#include "mcor_input.h"
#include "mcor_plane.h"
#include "mcor_tree.h"

#include <stdlib.h>

mcor_status mcor_measure_components(
  mcor_context* context, const mcor_input* input, mcor_globals* globals)
{
  const size_t count = mcor_count_components(input);
  globals->components = calloc(count + 1, sizeof *globals->components);
  MCOR_TRY(mcor_allocated(context, globals->components));
  for (int a = 0; a < input->attribute_count; ++a)
  {
    const mcor_array* array = &input->attributes[a];
    /* Finds the least index, on any rank, of a particle where the attribute is not finite. */
    int64_t not_finite =
      mcor_find_illegal(context, array, input->solid, MCOR_SKIP_SOLIDS, input->count, false);
    not_finite = not_finite < 0 ? INT64_MAX : not_finite;
    MCOR_TRY(mcor_reduce_counts(context, MCOR_LEAST, &not_finite, 1));
    not_finite = not_finite == INT64_MAX ? -1 : not_finite;
    for (int c = 0; c < mcor_components(array); ++c)
    {
      mcor_global_component* found = &globals->components[globals->component_count++];
      found->not_finite = not_finite;
      if (not_finite >= 0)
      {
        continue;
      }
      mcor_findings all =
        mcor_find_range(context, array, input->solid, MCOR_SKIP_SOLIDS, input->count, c);
      const mcor_findings with_solids = input->solid && !(all.least[0] < all.most[0])
        ? mcor_find_range(context, array, NULL, MCOR_SKIP_SOLIDS, input->count, c)
        : all;
      mcor_add_range(&all, 1, with_solids.least[0], with_solids.most[0]);
      MCOR_TRY(mcor_reduce_findings(context, &all));
      found->low = all.least[0];
      found->high = all.most[0];
      found->varies = all.least[1] < all.most[1];
      found->largest = found->varies ? mcor_largest_of(found->low, found->high) : 0;
    }
  }
  return MCOR_OK;
}

static mcor_status mcor_measure_all(
  mcor_context* context, const mcor_input* input, const mcor_options* options, void* data)
{
  mcor_globals* globals = data;
  mcor_free_globals(globals); /* a failed attempt may have left data here */
  context->kept.grid = context->kept.value = context->kept.nodes = false;
  context->kept.uses_solids = context->run.uses_solids;
  MCOR_TRY(mcor_check_input(context, input, options));
  int64_t particles = input->count;
  MCOR_TRY(mcor_reduce_counts(context, MCOR_SUM_OF, &particles, 1));
  MCOR_FAIL_IF(particles == 0, context, MCOR_INVALID_DATA, MCOR_SAY(NOTHING_TO_MEASURE));
  MCOR_TRY(mcor_measure_input(context, input, options));
  MCOR_TRY(mcor_measure_wall(context, input));
  globals->measured = context->measure;
  globals->mass_max =
    mcor_is_given(&input->mass) ? mcor_largest(context, input, &input->mass, 0) : 0;
  MCOR_TRY(mcor_reduce_doubles(context, MCOR_GREATEST, &globals->mass_max, 1));
  if (options->field == MCOR_SHEPARD)
  {
    MCOR_TRY(mcor_find_median(context, input, &globals->scalar_shift));
  }
  MCOR_TRY(mcor_measure_splits(context, input, globals));
  MCOR_TRY(mcor_measure_components(context, input, globals));
  mcor_turn_measure(&globals->measured, true);
  return MCOR_OK;
}

/* Fills *globals: for a surface if `surface` is set, else for calls that contour nothing. */
static mcor_status mcor_measure_for(mcor_context* context, const mcor_input* input,
  const mcor_options* options, bool surface, mcor_globals* globals)
{
  MCOR_FAIL_IF(!context || !globals, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "globals");
  *globals = (mcor_globals){ 0 };
  MCOR_FAIL_IF(!input || !options, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER),
    "input and options");
  mcor_options own = *options;
  own.globals = NULL;
  const bool uses_solids =
    surface ? mcor_uses_solids(input, options) : mcor_evaluate_without_scalar(input, &own);
  own.ranks = options->ranks; /* mcor_evaluate_without_scalar drops the ranks */
  mcor_statistics statistics = { 0 };
  const mcor_status status =
    mcor_run_call(context, input, &own, uses_solids, &statistics, mcor_measure_all, globals);
  return MCOR_OR_FREE(status, mcor_free_globals, globals);
}

mcor_status mcor_measure_globals(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_globals* globals)
{
  return mcor_measure_for(context, input, options, true, globals);
}

mcor_status mcor_measure_probe_globals(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_globals* globals)
{
  return mcor_measure_for(context, input, options, false, globals);
}

void mcor_free_globals(mcor_globals* globals)
{
  if (globals)
  {
    free(globals->components);
    free(globals->splits);
    *globals = (mcor_globals){ 0 };
  }
}
