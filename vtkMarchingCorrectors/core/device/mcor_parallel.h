/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_parallel_h
#define mcor_parallel_h

/* Loops of the host on all processors that the calling thread may use. */

#include "mcor.h"

#include <stdint.h>

#define MCOR_SLICES 32 /* at most */

/* Elements that are worth a thread, which takes about 30 us to start: where one takes about 10 ns;
 * 1 ns; or as long as memory takes. */
#define MCOR_HEAVY_GRAIN 8192
#define MCOR_LIGHT_GRAIN 65536
#define MCOR_MEMORY_GRAIN 262144

/* Elements [first, last) of a loop. */
typedef void (*mcor_slice_body)(void* data, int slice, int64_t first, int64_t last);

/* Runs the body once for every slice of [0, count), in any order, in several threads; waits for
 * all. Where the slices are depends on `count` and `grain`, their least size, alone: what a loop
 * adds up for each and then in order is the same whatever the number of threads. Returns the number
 * of slices. */
int mcor_parallel_for(int64_t count, int64_t grain, mcor_slice_body body, void* data);

/* The same in a call, which asks between slices whether it is cancelled: then some are left out. `slices`
 * becomes their number; NULL: not wanted. A context that is NULL, or in no call, is not asked. */
mcor_status mcor_parallel_run(mcor_context* context, int64_t count, int64_t grain,
  mcor_slice_body body, void* data, int* slices);

/* The share of one of `count` processes in the machine's processors, of those that the calling thread
 * may use; at least 1. */
int mcor_processors(int count);

/* The threads to use where there are processors for `usable`: not more than the environment's
 * MCOR_THREADS, if that is a number above 0. */
int mcor_limit_threads(int usable);

#endif
