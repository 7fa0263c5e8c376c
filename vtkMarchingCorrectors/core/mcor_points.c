/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Points where the field is evaluated, in groups that share a gather. */

#include "mcor_internal.h"

/* Cuts points [first, first + count) into groups that are evaluated together. */
mcor_status mcor_make_groups(
  mcor_context* context, const mcor_buffer* node, int first, int count, int* group_count)
{
  mcor_points* points = &context->points;
  const int chunk = MCOR_GROUPED_POINTS_OF(context->cl.lanes);
  MCOR_TRY(mcor_reserve(context, &points->flags, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_group_count", MCOR_MEDIUM, (count + chunk - 1) / chunk,
    MCOR_INT(first), MCOR_INT(count), MCOR_BUFFER(node), MCOR_BUFFER(&points->flags)));
  MCOR_TRY(mcor_scan(context, &points->flags, count, group_count));
  MCOR_TRY(mcor_reserve(context, &points->groups, ((size_t)*group_count + 1) * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_group_fill", MCOR_LIGHT, count + 1, MCOR_INT(first),
    MCOR_INT(count), MCOR_BUFFER(&points->flags), MCOR_BUFFER(&points->groups));
}

void mcor_release_points(mcor_context* context)
{
  MCOR_RELEASE(context, &context->points.flags, &context->points.groups);
}
