/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_pool_h
#define mcor_pool_h

/* Threads that wait, asleep, for loops to share with the thread that runs them. */

#include <stddef.h>

typedef struct mcor_pool mcor_pool;

/* Elements [first, last) of a loop. */
typedef void mcor_pool_body(void* data, size_t first, size_t last);

/* For `threads` threads, the calling one included: there are fewer where the system gives no more. NULL:
 * no memory. */
mcor_pool* mcor_make_pool(int threads);
/* Ends its threads. NULL is none. */
void mcor_free_pool(mcor_pool* pool);
/* Runs the body for elements [first, last), `step` at once, in any order; waits for all. Calls from
 * several threads wait for each other. Every thread computes as C does by default, whatever the
 * caller has set (rounding, denormal numbers). */
void mcor_pool_run(
  mcor_pool* pool, size_t first, size_t last, size_t step, mcor_pool_body* body, void* data);

#endif
