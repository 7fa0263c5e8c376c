/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_parallel_h
#define mcor_parallel_h

/* Loops in several threads: loops of the host, on processors that the calling thread may use,
 * and launches on the built-in device. */

#include "mcor.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#define MCOR_SLICES 32 /* most slices of a loop */

/* The least number of elements for which starting a thread (about 30 us) is worth it. Heavy: an
 * element takes 10 ns; light: 1 ns; memory: elements are only read from memory. */
#define MCOR_HEAVY_GRAIN 8192
#define MCOR_LIGHT_GRAIN 65536
#define MCOR_MEMORY_GRAIN 262144

/* Treats elements [first, last) of a loop. */
typedef void (*mcor_slice_body)(void* data, int slice, int64_t first, int64_t last);

/* Runs the body once for every slice of [0, count), in any order, in several threads, and waits for
 * all. Slices depend on `count` and `grain` (their least size) alone; so a loop that sums by slice,
 * and then over slices in order, has the same result with any number of threads. Returns the number
 * of slices. context: its threads are used, but its progress callback is not asked; NULL: threads
 * are made for this loop. */
int mcor_parallel_for(
  mcor_context* context, int64_t count, int64_t grain, mcor_slice_body body, void* data);

/* Runs the body as mcor_parallel_for does, but also asks the context's progress callback, which may
 * cancel the call; then some slices do not run. *slices becomes the number of all slices, unless
 * `slices` is NULL. If the context is NULL or not in a call, no callback is asked. A body must not
 * use loops or launches of the same context. */
mcor_status mcor_parallel_run(mcor_context* context, int64_t count, int64_t grain,
  mcor_slice_body body, void* data, int* slices);

/* Returns how many processors one process may use if `count` processes share the machine's
 * processors: at most as many as the calling thread may use, and at least 1. */
int mcor_processors(int count);

/* Returns how many threads to use on `usable` processors. If MCOR_THREADS in the environment is a
 * number above 0, no more than this number are used. */
int mcor_limit_threads(int usable);

/* Treats elements [first, last) of a loop without slices. */
typedef void mcor_pool_body(void* data, size_t first, size_t last);

/* Threads that sleep until the calling thread has a loop to share with them. They are created when
 * a loop needs them. A pool that is all zero, except for `threads`, has no threads yet. */
typedef struct mcor_pool
{
  int threads;    /* the most threads, the calling one included; 0: not decided */
  int count;      /* how many exist */
  pthread_t* all; /* [threads - 1] */
  long process; /* the process with these threads (one made by fork has none of them); 0: none */
  pthread_mutex_t lock; /* protects open, ends, round and active */
  pthread_cond_t wake, done;
  bool open, ends; /* open: there is a loop to join; ends: the threads must end */
  unsigned round;  /* counts the loops */
  int active;      /* threads in the loop */
  /* What the present loop does. */
  mcor_pool_body* body;
  void* data;
  atomic_size_t next;
  size_t last, step;
} mcor_pool;

/* Runs the body for the elements [first, last), `step` at a time, in any order, and waits for all.
 * Every thread computes with C's default rounding and denormal numbers, whatever the caller has
 * set. context: its progress callback is asked between steps; may be NULL. */
mcor_status mcor_pool_run(mcor_pool* pool, mcor_context* context, size_t first, size_t last,
  size_t step, mcor_pool_body* body, void* data);
/* Ends the threads of a pool, which is then all zero. */
void mcor_end_pool(mcor_pool* pool);

#endif
