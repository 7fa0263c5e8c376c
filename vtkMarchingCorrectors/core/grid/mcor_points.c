/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Groups the points where the field is evaluated: a group's points share the gathered particles. */

#include "mcor_internal.h"

/* Cuts points [first, first + count) into groups. */
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

/* Makes room for points and for the field at these points. */
mcor_status mcor_reserve_points(mcor_context* context, mcor_field_points* points, size_t count)
{
  const size_t reals = count * context->cl.real_size;
  MCOR_TRY(mcor_reserve(context, &points->node, count * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &points->offset, 4 * reals));
  MCOR_TRY(mcor_reserve(context, &points->value, reals));
  MCOR_TRY(mcor_reserve(context, &points->gradient, 4 * reals));
  return mcor_reserve(context, &points->weight, reals);
}

/* Cuts points [first, first + count) into groups, and evaluates the field at them. */
mcor_status mcor_evaluate_points(
  mcor_context* context, const mcor_field_points* points, int first, int count, int* group_count)
{
  MCOR_TRY(mcor_make_groups(context, &points->node, first, count, group_count));
  return MCOR_LAUNCH(context, "mcor_field_points", MCOR_HEAVY, *group_count,
    MCOR_GRID_ARGS(context), MCOR_INT(*group_count), MCOR_BUFFER(&context->points.groups),
    MCOR_BUFFER(&points->node), MCOR_REAL(context->run.iso.relative), MCOR_BUFFER(&points->offset),
    MCOR_BUFFER(&points->value), MCOR_BUFFER(&points->gradient), MCOR_BUFFER(&points->weight),
    MCOR_INT(0), MCOR_INT(0), MCOR_BUFFER(&points->value), MCOR_BUFFER(&points->weight));
}

/* Sorts the points of a batch by place, with points outside of all bricks last. Cuts the first
 * `inside` points into groups. */
mcor_status mcor_group_batch(
  mcor_context* context, mcor_point_batch* batch, int count, int inside, int* group_count)
{
  const cl_int *first = batch->first, *bricks = batch->bricks;
  const size_t n = (size_t)inside;
  const uint64_t keys =
    (uint64_t)bricks[0] * (uint64_t)bricks[1] * (uint64_t)bricks[2] * MCOR_BRICK_NODES;
  MCOR_TRY(mcor_reserve(context, &batch->keys, (size_t)count * sizeof(cl_ulong)));
  MCOR_TRY(
    MCOR_LAUNCH(context, "mcor_probe_key", MCOR_LIGHT, count, MCOR_INT(count), MCOR_INT(first[0]),
      MCOR_INT(first[1]), MCOR_INT(first[2]), MCOR_INT(bricks[0]), MCOR_INT(bricks[1]),
      MCOR_INT(bricks[2]), MCOR_BUFFER(&batch->in_node), MCOR_BUFFER(&batch->keys)));
  MCOR_TRY(mcor_sort(context, &batch->keys, &batch->order, count, keys + (inside < count ? 1 : 0)));
  MCOR_TRY(mcor_reserve(context, &batch->node, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_reserve(context, &batch->offset, n * 4 * context->cl.real_size));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_probe_order", MCOR_LIGHT, inside, MCOR_INT(inside),
    MCOR_BUFFER(&batch->order), MCOR_BUFFER(&batch->in_node), MCOR_BUFFER(&batch->in_offset),
    MCOR_BUFFER(&batch->node), MCOR_BUFFER(&batch->offset)));
  return mcor_make_groups(context, &batch->node, 0, inside, group_count);
}
