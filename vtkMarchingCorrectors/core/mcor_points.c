/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Points where the field is evaluated, in groups that share a gather. */

#include "mcor_internal.h"

/* Cuts points [first, first + count) into groups that are evaluated together. */
mcor_status mcor_make_groups(
  mcor_context* context, const mcor_buffer* node, int first, int count, int* group_count)
{
  mcor_buffer* flags = &context->scratch[0];
  MCOR_TRY(mcor_reserve(context, flags, ((size_t)count + 1) * sizeof(cl_int)));
  MCOR_TRY(MCOR_LAUNCH(context, "mcor_group_count", MCOR_LIGHT,
    (count + MCOR_GROUP_CHUNK - 1) / MCOR_GROUP_CHUNK, MCOR_INT(first), MCOR_INT(count),
    MCOR_BUFFER(node), MCOR_BUFFER(flags)));
  MCOR_TRY(mcor_scan(context, flags, count, group_count));
  MCOR_TRY(mcor_reserve(context, &context->groups, ((size_t)*group_count + 1) * sizeof(cl_int)));
  return MCOR_LAUNCH(context, "mcor_group_fill", MCOR_LIGHT, count + 1, MCOR_INT(first),
    MCOR_INT(count), MCOR_BUFFER(flags), MCOR_BUFFER(&context->groups));
}
