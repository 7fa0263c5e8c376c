/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* On which side of the iso value particles are, as far as rounding leaves no doubt. */

#include "mcor_internal.h"

#include <float.h>
#include <math.h>

/* How far rounding may move a Shepard mean of values that are all on one side: of n particles that
 * reach a point, the two sums are off by (n + 3) and (n + 1) unit roundoffs of their absolute terms
 * at most, the quotient by another one. A point is reached from 27 cells of each level. */
double mcor_side_margin(const mcor_context* context)
{
  const mcor_grid* grid = &context->grid;
  const double reaching = fmin(27.0 * grid->level_count * grid->most_in_cell, grid->count);
  const double share =
    (2 * reaching + 16) * (context->cl.real_size == sizeof(float) ? FLT_EPSILON : DBL_EPSILON) / 2;
  return share < 0.5 ? share / (1 - share) : 1e30;
}

/* The sides of the iso value on which particles are, where the field has values at particles. */
mcor_status mcor_find_side_flags(mcor_context* context)
{
  mcor_grid* grid = &context->grid;
  const int runs = grid->count / MCOR_SIDE_PARTICLES + 1;
  MCOR_TRY(mcor_reserve(context, &grid->side_flags, (size_t)runs));
  return context->run.options->field == MCOR_WEIGHT_SUM
    ? MCOR_OK
    : MCOR_LAUNCH(context, "mcor_seed_side_flags", MCOR_MEDIUM, runs, MCOR_INT(grid->count),
        MCOR_BUFFER(grid->has_solids ? &grid->fluid_weight : &grid->trim_weight),
        MCOR_BUFFER(&grid->value), MCOR_REAL(mcor_side_margin(context)),
        MCOR_REAL(context->run.iso.relative), MCOR_BUFFER(&grid->side_flags));
}
