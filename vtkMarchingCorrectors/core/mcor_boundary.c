/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The boundary eigenvalue, see mcor_boundary.cl. */

#include "mcor_internal.h"

/* Evaluates it at `count` points. */
mcor_status mcor_evaluate_boundary(mcor_context* context, const mcor_buffer* node,
  const mcor_buffer* offset, int count, mcor_buffer* eigenvalue)
{
  int groups;
  MCOR_TRY(mcor_reserve(context, eigenvalue, (size_t)count * context->cl.real_size));
  MCOR_TRY(mcor_make_groups(context, node, 0, count, &groups));
  return MCOR_LAUNCH(context, "mcor_boundary_points", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->groups), MCOR_BUFFER(node), MCOR_BUFFER(offset),
    MCOR_BUFFER(eigenvalue));
}
