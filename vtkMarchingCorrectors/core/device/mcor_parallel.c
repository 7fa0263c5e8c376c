/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Runs loops in threads, which sleep between two loops. The built-in device's threads serve the
 * loops of the host, too. With any other device, threads live for one call; without a context, for
 * one loop. */

#include "mcor_cl_call.h"

#include <fenv.h>
#include <stdlib.h>
#include <unistd.h>

#define MCOR_LOOP_THREADS 16 /* most threads for loops of the host without the built-in device */

int mcor_limit_threads(int usable)
{
  const char* text = getenv("MCOR_THREADS");
  const int limit = text ? atoi(text) : 0;
  return limit > 0 && limit < usable ? limit : usable;
}

int mcor_processors(int count)
{
  int usable = 1;
  const int all = mcor_system_processors(&usable);
  const int share = all / count < usable ? all / count : usable;
  return share < 1 ? 1 : share;
}

/* ---- Threads ---- */

/* Runs parts of the loop until none is left. Only the calling thread reports progress; the other
 * threads pass NULL as context. */
static mcor_status mcor_pool_work(mcor_pool* pool, mcor_context* context)
{
  const size_t last = pool->last, step = pool->step;
  mcor_status status = MCOR_OK;
  for (size_t i = atomic_fetch_add(&pool->next, step); i < last && status == MCOR_OK;
       i = atomic_fetch_add(&pool->next, step))
  {
    pool->body(pool->data, i, last - i < step ? last : i + step);
    status = context ? mcor_ask(context, false) : MCOR_OK;
    if (status != MCOR_OK)
    {
      atomic_store(&pool->next, last);
    }
  }
  return status;
}

static void* mcor_pool_thread(void* data)
{
  mcor_pool* pool = data;
  unsigned seen = 0;
  fesetenv(FE_DFL_ENV);
  pthread_mutex_lock(&pool->lock);
  while (!pool->ends)
  {
    if (!pool->open || pool->round == seen)
    {
      pthread_cond_wait(&pool->wake, &pool->lock);
      continue;
    }
    seen = pool->round;
    ++pool->active;
    pthread_mutex_unlock(&pool->lock);
    mcor_pool_work(pool, NULL);
    pthread_mutex_lock(&pool->lock);
    if (--pool->active == 0)
    {
      pthread_cond_signal(&pool->done);
    }
  }
  pthread_mutex_unlock(&pool->lock);
  return NULL;
}

void mcor_end_pool(mcor_pool* pool)
{
  if (pool->process == (long)getpid())
  {
    pthread_mutex_lock(&pool->lock);
    pool->ends = true;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    for (int t = 0; t < pool->count; ++t)
    {
      pthread_join(pool->all[t], NULL);
    }
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->lock);
  }
  free(pool->all);
  *pool = (mcor_pool){ 0 };
}

mcor_status mcor_pool_run(mcor_pool* pool, mcor_context* context, size_t first, size_t last,
  size_t step, mcor_pool_body* body, void* data)
{
  const bool shared = pool->threads > 1 && last - first > step;
  fenv_t environment;
  fegetenv(&environment);
  fesetenv(FE_DFL_ENV);
  if (shared && pool->process != (long)getpid()) /* this is the process' first loop */
  {
    free(pool->all);
    pool->all = malloc((size_t)pool->threads * sizeof *pool->all);
    pool->threads = pool->all ? pool->threads : 1; /* without memory, one thread */
    pool->process = (long)getpid();
    pool->count = pool->active = 0;
    pool->round = 0;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->done, NULL);
  }
  pool->body = body;
  pool->data = data;
  atomic_store(&pool->next, first);
  pool->last = last;
  pool->step = step;
  if (shared) /* opens the loop to waiting threads */
  {
    pthread_mutex_lock(&pool->lock);
    pool->open = true;
    ++pool->round;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
  }
  /* Makes further threads while work is left and the system allows it. */
  while (shared && pool->count + 1 < pool->threads && atomic_load(&pool->next) + step < last)
  {
    if (pthread_create(&pool->all[pool->count], NULL, mcor_pool_thread, pool) == 0)
    {
      ++pool->count;
    }
    else
    {
      pool->threads = pool->count + 1;
    }
  }
  const mcor_status status = mcor_pool_work(pool, context);
  /* Closes the loop. The loop is done when the calling thread finds no more work and all threads
   * that joined are back. A thread that wakes later finds the loop closed. */
  if (shared)
  {
    pthread_mutex_lock(&pool->lock);
    pool->open = false;
    while (pool->active > 0)
    {
      pthread_cond_wait(&pool->done, &pool->lock);
    }
    pthread_mutex_unlock(&pool->lock);
  }
  fesetenv(&environment);
  return status;
}

/* ---- Loops of the host ---- */

typedef struct mcor_loop
{
  int64_t count;
  int slices;
  mcor_slice_body body;
  void* data;
} mcor_loop;

static void mcor_run_slices(void* data, size_t first, size_t last)
{
  const mcor_loop* loop = data;
  for (int s = (int)first; s < (int)last; ++s)
  {
    loop->body(loop->data, s, loop->count * s / loop->slices, loop->count * (s + 1) / loop->slices);
  }
}

/* Runs the body for all slices. asks: whether the progress callback is asked and may cancel. */
static mcor_status mcor_run_loop(mcor_context* context, bool asks, int64_t count, int64_t grain,
  mcor_slice_body body, void* data, int* slices)
{
  mcor_pool own = { 0 };
  mcor_pool* pool = !context ? &own : context->cl.pool ? context->cl.pool : &context->pool;
  const int64_t most = count / grain;
  mcor_loop loop = { count,
    most > MCOR_SLICES ? MCOR_SLICES
      : most > 0       ? (int)most
                       : count > 0,
    body, data };
  if (pool->threads == 0 && loop.slices > 1)
  {
    const int usable = mcor_limit_threads(mcor_processors(1));
    pool->threads = usable < MCOR_LOOP_THREADS ? usable : MCOR_LOOP_THREADS;
  }
  const mcor_status status = mcor_pool_run(
    pool, asks ? context : NULL, 0, (size_t)loop.slices, 1, mcor_run_slices, &loop);
  mcor_end_pool(&own);
  if (slices)
  {
    *slices = loop.slices;
  }
  return status;
}

mcor_status mcor_parallel_run(mcor_context* context, int64_t count, int64_t grain,
  mcor_slice_body body, void* data, int* slices)
{
  return mcor_run_loop(context, true, count, grain, body, data, slices);
}

int mcor_parallel_for(
  mcor_context* context, int64_t count, int64_t grain, mcor_slice_body body, void* data)
{
  int slices;
  mcor_run_loop(context, false, count, grain, body, data, &slices);
  return slices;
}
