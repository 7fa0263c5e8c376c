/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: cells of the box. Leaves that reach it are examined, but of their cells those alone
 * are used that are in the box or its ring: those that would be in it if they were a cell larger all
 * around. See mcor_box.c. */

#include "mcor_graded_box.h"

/* Limits the cells that may be used; box.clipped: those in the box, where there is one. */
mcor_status mcor_limit_leaves(mcor_context* context)
{
  const mcor_graded* graded = &context->graded;
  const size_t bytes = (size_t)graded->count * sizeof(cl_ulong);
  mcor_buffer *used = &context->mesh.used, *clipped = &context->box.clipped;
  if (!context->box.is_part)
  {
    return mcor_fill(context, used, 0xff, bytes);
  }
  MCOR_TRY(mcor_reserve(context, used, bytes));
  MCOR_TRY(mcor_reserve(context, clipped, bytes));
  return MCOR_LAUNCH(context, "mcor_graded_limit", MCOR_MEDIUM, graded->count,
    MCOR_LEAF_BOX_ARGS(context), MCOR_INT(graded->count), MCOR_BUFFER(used), MCOR_BUFFER(clipped));
}

/* Counts the used cells in the box; bit_counts end with those before each leaf. */
mcor_status mcor_count_owned(mcor_context* context, int* count)
{
  const mcor_graded* graded = &context->graded;
  const mcor_buffer* used = &context->mesh.used;
  mcor_buffer* clipped = &context->box.clipped;
  if (!context->box.is_part)
  {
    return mcor_count_bits(context, used, used, graded->count, count);
  }
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_graded_clip", MCOR_MEDIUM, graded->count,
    MCOR_LEAF_BOX_ARGS(context), MCOR_INT(graded->count), MCOR_BUFFER(used), MCOR_BUFFER(clipped)));
  return mcor_count_bits(context, clipped, clipped, graded->count, count);
}
