/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "mcor_pool.h"

#include <fenv.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

struct mcor_pool
{
  pthread_mutex_t running; /* of the loop that is run */
  pthread_mutex_t lock;    /* of what follows */
  pthread_cond_t wake, done;
  bool open, ends; /* there is a loop to join; the threads are to end */
  unsigned round;  /* number of the loop */
  int active;      /* threads that have joined it */
  /* The loop. */
  mcor_pool_body* body;
  void* data;
  atomic_size_t next;
  size_t last, step;
  int count; /* of threads, without the caller's */
  pthread_t threads[];
};

static void mcor_pool_work(mcor_pool* pool)
{
  const size_t last = pool->last, step = pool->step;
  for (size_t i = atomic_fetch_add(&pool->next, step); i < last;
       i = atomic_fetch_add(&pool->next, step))
  {
    pool->body(pool->data, i, last - i < step ? last : i + step);
  }
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
    mcor_pool_work(pool);
    pthread_mutex_lock(&pool->lock);
    if (--pool->active == 0)
    {
      pthread_cond_signal(&pool->done);
    }
  }
  pthread_mutex_unlock(&pool->lock);
  return NULL;
}

mcor_pool* mcor_make_pool(int threads)
{
  mcor_pool* pool = calloc(1, sizeof *pool + (size_t)threads * sizeof pool->threads[0]);
  if (!pool)
  {
    return NULL;
  }
  pthread_mutex_init(&pool->running, NULL);
  pthread_mutex_init(&pool->lock, NULL);
  pthread_cond_init(&pool->wake, NULL);
  pthread_cond_init(&pool->done, NULL);
  while (pool->count + 1 < threads &&
    pthread_create(&pool->threads[pool->count], NULL, mcor_pool_thread, pool) == 0)
  {
    ++pool->count;
  }
  return pool;
}

void mcor_free_pool(mcor_pool* pool)
{
  if (!pool)
  {
    return;
  }
  pthread_mutex_lock(&pool->lock);
  pool->ends = true;
  pthread_cond_broadcast(&pool->wake);
  pthread_mutex_unlock(&pool->lock);
  for (int t = 0; t < pool->count; ++t)
  {
    pthread_join(pool->threads[t], NULL);
  }
  pthread_cond_destroy(&pool->done);
  pthread_cond_destroy(&pool->wake);
  pthread_mutex_destroy(&pool->lock);
  pthread_mutex_destroy(&pool->running);
  free(pool);
}

/* The loop is done when the caller's thread finds no more to do and those that joined it are back: one
 * that wakes later finds it closed. */
static void mcor_pool_share(mcor_pool* pool)
{
  pthread_mutex_lock(&pool->lock);
  pool->open = true;
  ++pool->round;
  pthread_cond_broadcast(&pool->wake);
  pthread_mutex_unlock(&pool->lock);
  mcor_pool_work(pool);
  pthread_mutex_lock(&pool->lock);
  pool->open = false;
  while (pool->active > 0)
  {
    pthread_cond_wait(&pool->done, &pool->lock);
  }
  pthread_mutex_unlock(&pool->lock);
}

void mcor_pool_run(
  mcor_pool* pool, size_t first, size_t last, size_t step, mcor_pool_body* body, void* data)
{
  fenv_t environment;
  fegetenv(&environment);
  fesetenv(FE_DFL_ENV);
  if (pool->count == 0 || last - first <= step)
  {
    body(data, first, last);
  }
  else
  {
    pthread_mutex_lock(&pool->running);
    pool->body = body;
    pool->data = data;
    atomic_store(&pool->next, first);
    pool->last = last;
    pool->step = step;
    mcor_pool_share(pool);
    pthread_mutex_unlock(&pool->running);
  }
  fesetenv(&environment);
}
