/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_parallel_h
#define mcor_parallel_h

/* Loops in several threads: of the host, on all processors that the calling thread may use, and the
 * built-in device's launches. */

#include "mcor.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
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
 * of slices. context: whose threads take part; it is not asked whether to go on. NULL: threads are made for this
 * loop. */
int mcor_parallel_for(
  mcor_context* context, int64_t count, int64_t grain, mcor_slice_body body, void* data);

/* Runs the body within a call, which may be cancelled between slices: then some are left out. `slices`
 * becomes their number; NULL: not wanted. A context that is NULL, or in no call, is not asked. A
 * body makes no loops, and no launches, of the same context. */
mcor_status mcor_parallel_run(mcor_context* context, int64_t count, int64_t grain,
  mcor_slice_body body, void* data, int* slices);

/* The share of one of `count` processes in the machine's processors, of those that the calling thread
 * may use; at least 1. */
int mcor_processors(int count);

/* The threads to use where there are processors for `usable`: not more than the environment's
 * MCOR_THREADS, if that is a number above 0. */
int mcor_limit_threads(int usable);

/* Elements [first, last) of a loop without slices. */
typedef void mcor_pool_body(void* data, size_t first, size_t last);

/* Threads that wait, asleep, for loops to share with the thread that runs them; made as loops need them. All
 * zero but for `threads`: there are none yet. */
typedef struct mcor_pool
{
  int threads;    /* at most, the calling one included */
  int count;      /* made so far */
  pthread_t* all; /* [threads - 1] */
  long process;   /* whose they are: a process made by fork has none of them; 0: there are none */
  pthread_mutex_t lock; /* of what follows */
  pthread_cond_t wake, done;
  bool open, ends; /* there is a loop to join; the threads are to end */
  unsigned round;  /* number of the loop */
  int active;      /* threads that have joined it */
  /* The loop. */
  mcor_pool_body* body;
  void* data;
  atomic_size_t next;
  size_t last, step;
} mcor_pool;

/* Runs the body for elements [first, last), `step` at once, in any order; waits for all. Every thread computes
 * as C does by default, whatever the caller has set (rounding, denormal numbers). context: as above. */
mcor_status mcor_pool_run(mcor_pool* pool, mcor_context* context, size_t first, size_t last,
  size_t step, mcor_pool_body* body, void* data);
/* Ends its threads. */
void mcor_end_pool(mcor_pool* pool);

#endif
