/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Threads live for one loop: there is no pool to be shared, ended, or lost in a fork. */

#include "mcor_parallel.h"
#include "mcor_internal.h"
#include "mcor_system.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

#define MCOR_LOOP_THREADS 16 /* at most, the calling one included */

int mcor_limit_threads(int usable)
{
  const char* text = getenv("MCOR_THREADS");
  const int limit = text ? atoi(text) : 0;
  return limit > 0 && limit < usable ? limit : usable;
}

static int mcor_slice_count(int64_t count, int64_t grain)
{
  const int64_t slices = count / grain;
  return slices > MCOR_SLICES ? MCOR_SLICES : slices > 0 ? (int)slices : count > 0;
}

typedef struct mcor_loop
{
  int64_t count;
  int slices;
  mcor_slice_body body;
  void* data;
  atomic_int next; /* slice */
} mcor_loop;

/* False: none is left. */
static bool mcor_run_slice(mcor_loop* loop)
{
  const int slices = loop->slices, s = atomic_fetch_add(&loop->next, 1);
  if (s < slices)
  {
    loop->body(loop->data, s, loop->count * s / slices, loop->count * (s + 1) / slices);
  }
  return s < slices;
}

static void* mcor_run_slices(void* data)
{
  while (mcor_run_slice(data))
  {
  }
  return NULL;
}

/* Progress is told by the calling thread alone. */
static mcor_status mcor_run_own_slices(mcor_context* context, mcor_loop* loop)
{
  mcor_status status = MCOR_OK;
  while (status == MCOR_OK && mcor_run_slice(loop))
  {
    status = context ? mcor_report_launch(context) : MCOR_OK;
  }
  if (status != MCOR_OK)
  {
    atomic_store(&loop->next, loop->slices);
  }
  return status;
}

int mcor_processors(int count)
{
  int usable = 1;
  const int all = mcor_system_processors(&usable);
  const int share = all / count < usable ? all / count : usable;
  return share < 1 ? 1 : share;
}

static int mcor_thread_limit(void)
{
  const int threads = mcor_limit_threads(mcor_processors(1));
  return threads < MCOR_LOOP_THREADS ? threads : MCOR_LOOP_THREADS;
}

mcor_status mcor_parallel_run(mcor_context* context, int64_t count, int64_t grain,
  mcor_slice_body body, void* data, int* slices)
{
  mcor_loop loop = {
    .count = count, .slices = mcor_slice_count(count, grain), .body = body, .data = data
  };
  atomic_init(&loop.next, 0);
  const int limit = loop.slices > 1 ? mcor_thread_limit() : 1;
  pthread_t threads[MCOR_LOOP_THREADS];
  int made = 0;
  /* Without a further thread, or when the first have done everything, these go on alone. */
  while (made + 1 < limit && atomic_load(&loop.next) + 1 < loop.slices &&
    pthread_create(&threads[made], NULL, mcor_run_slices, &loop) == 0)
  {
    ++made;
  }
  const mcor_status status = mcor_run_own_slices(context, &loop);
  for (int t = 0; t < made; ++t)
  {
    pthread_join(threads[t], NULL);
  }
  if (slices)
  {
    *slices = loop.slices;
  }
  return status;
}

int mcor_parallel_for(int64_t count, int64_t grain, mcor_slice_body body, void* data)
{
  int slices;
  mcor_parallel_run(NULL, count, grain, body, data, &slices);
  return slices;
}
