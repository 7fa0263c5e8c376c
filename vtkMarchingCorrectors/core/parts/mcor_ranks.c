/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Exchange between ranks in a call. Ranks exchange only data that do not depend on which rank has
 * which particles: least and greatest values, exact sums, and records that are then sorted or used
 * as a set. */

#include "mcor_internal.h"

/* Fails with MCOR_CANCELLED if a callback of options.ranks has returned nonzero. */
static mcor_status mcor_heard(mcor_context* context, int failed)
{
  MCOR_FAIL_IF(failed != 0, context, MCOR_CANCELLED, MCOR_SAY(RANK_FAILED));
  return MCOR_OK;
}

/* Makes no callback if count is 0, e.g. without fluid, when there are no samples. All ranks have
 * the same count. */
mcor_status mcor_reduce_doubles(
  mcor_context* context, mcor_reduction reduction, double* values, int count)
{
  const mcor_ranks* ranks = context->run.options->ranks;
  return ranks && count > 0
    ? mcor_heard(context, ranks->reduce_doubles(ranks->user, reduction, values, count))
    : MCOR_OK;
}

mcor_status mcor_reduce_counts(
  mcor_context* context, mcor_reduction reduction, int64_t* values, int count)
{
  const mcor_ranks* ranks = context->run.options->ranks;
  return ranks && count > 0
    ? mcor_heard(context, ranks->reduce_counts(ranks->user, reduction, values, count))
    : MCOR_OK;
}

mcor_status mcor_gather_records(mcor_context* context, const void* records, int64_t count,
  size_t width, const void** all, int64_t* all_count)
{
  const mcor_ranks* ranks = context->run.options->ranks;
  *all = records;
  *all_count = count;
  return ranks
    ? mcor_heard(context, ranks->gather(ranks->user, records, count, width, all, all_count))
    : MCOR_OK;
}
