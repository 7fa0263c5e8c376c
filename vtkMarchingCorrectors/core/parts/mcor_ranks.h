/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_ranks_h
#define mcor_ranks_h

/* Exchange between ranks, by the functions of options.ranks. A process alone has all values
 * already. */

#include "mcor_internal.h"

/* Turns the result of a function of options.ranks into a status. */
mcor_status mcor_heard(mcor_context* context, int failed);

mcor_status mcor_reduce_doubles(
  mcor_context* context, mcor_reduction reduction, double* values, int count);
mcor_status mcor_reduce_counts(
  mcor_context* context, mcor_reduction reduction, int64_t* values, int count);
/* Gathers the records of all ranks, valid until the next gathering; alone, they are the
 * caller's. */
mcor_status mcor_gather(mcor_context* context, const void* records, int64_t count, size_t width,
  const void** all, int64_t* all_count);

#endif
