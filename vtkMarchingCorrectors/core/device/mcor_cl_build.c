/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Builds programs in threads while the host checks and stages particles. */

#include "mcor_cl_call.h"
#include "mcor_parallel.h"
#include "mcor_program.h"

#include <string.h>
#include <time.h>

/* A program to build ahead. It waits for a thread, is being built, or is done. */
typedef struct mcor_build_job
{
  cl_program program; /* NULL: it is not built ahead, or the run has taken it */
  char options[512];
  double size, seconds; /* length of the sources; how long building took */
  cl_int error;
  bool is_begun, is_done;
} mcor_build_job;

struct mcor_builder
{
  cl_device_id device;
  pthread_mutex_t lock; /* protects the jobs */
  pthread_cond_t done;
  pthread_t threads[MCOR_PROGRAM_COUNT];
  int thread_count;
  mcor_build_job jobs[MCOR_PROGRAM_COUNT];
};

/* The order in which a run needs programs. */
static const mcor_program mcor_build_order[] = { MCOR_PROGRAM_GRID, MCOR_PROGRAM_DENSITY,
  MCOR_PROGRAM_NODES, MCOR_PROGRAM_LEAVES, MCOR_PROGRAM_BRICKS, MCOR_PROGRAM_RARE,
  MCOR_PROGRAM_CHOICES, MCOR_PROGRAM_CELLS, MCOR_PROGRAM_VERTICES, MCOR_PROGRAM_SHAPE,
  MCOR_PROGRAM_TRIM, MCOR_PROGRAM_ATTRIBUTES };
#define MCOR_BUILT_AHEAD (sizeof mcor_build_order / sizeof *mcor_build_order)

/* Builds a job's program. The caller holds the lock, which is free while the driver compiles. */
static void mcor_run_job(struct mcor_builder* builder, mcor_build_job* job)
{
  job->is_begun = true;
  pthread_mutex_unlock(&builder->lock);
  const double begin = mcor_seconds();
  const cl_int error = clBuildProgram(job->program, 1, &builder->device, job->options, NULL, NULL);
  pthread_mutex_lock(&builder->lock);
  job->error = error;
  job->seconds = mcor_seconds() - begin;
  job->is_done = true;
  pthread_cond_broadcast(&builder->done);
}

static void* mcor_build_thread(void* data)
{
  struct mcor_builder* builder = data;
  pthread_mutex_lock(&builder->lock);
  for (size_t i = 0; i < MCOR_BUILT_AHEAD; ++i)
  {
    mcor_build_job* job = &builder->jobs[mcor_build_order[i]];
    if (job->program && !job->is_begun)
    {
      mcor_run_job(builder, job);
    }
  }
  pthread_mutex_unlock(&builder->lock);
  return NULL;
}

mcor_status mcor_build_ahead(mcor_context* context, const mcor_build* build, int programs)
{
  mcor_cl* cl = &context->cl;
  int threads = mcor_limit_threads(mcor_processors(1)), jobs = 0;
  if (mcor_is_native(cl) || threads < 2)
  {
    return MCOR_OK;
  }
  mcor_end_building(cl);
  MCOR_TRY(mcor_choose_build(context, build));
  struct mcor_builder* builder = cl->builder = calloc(1, sizeof *builder);
  MCOR_TRY(mcor_allocated(context, builder != NULL));
  builder->device = cl->device;
  pthread_mutex_init(&builder->lock, NULL);
  pthread_cond_init(&builder->done, NULL);
  for (size_t i = 0; i < MCOR_BUILT_AHEAD; ++i)
  {
    const mcor_program number = mcor_build_order[i];
    const int parts = mcor_parts_of(cl, number);
    mcor_build_job* job = &builder->jobs[number];
    const char* sources[MCOR_SOURCE_LIMIT];
    if (cl->programs[number] || !(parts & programs))
    {
      continue;
    }
    for (int s = mcor_program_sources(cl, parts, sources); s > 0; --s)
    {
      job->size += (double)strlen(sources[s - 1]);
    }
    mcor_program_options(cl, number, job->options, sizeof job->options);
    MCOR_TRY(mcor_make_program(context, number, &job->program));
    ++jobs;
  }
  threads = threads < jobs ? threads : jobs;
  while (builder->thread_count < threads &&
    pthread_create(&builder->threads[builder->thread_count], NULL, mcor_build_thread, builder) == 0)
  {
    ++builder->thread_count;
  }
  return MCOR_OK;
}

double mcor_build_rest(mcor_cl* cl)
{
  struct mcor_builder* builder = cl->builder;
  double known = 0, seconds = 0, rest = 0;
  if (builder)
  {
    pthread_mutex_lock(&builder->lock);
    for (int i = 0; i < MCOR_PROGRAM_COUNT; ++i)
    {
      const mcor_build_job* job = &builder->jobs[i];
      known += job->is_done ? job->size : 0;
      seconds += job->seconds;
      rest += job->is_done ? 0 : job->size;
    }
    rest /= builder->thread_count > 1 ? builder->thread_count : 1;
    pthread_mutex_unlock(&builder->lock);
  }
  return known > 0 ? rest * seconds / known : 0;
}

mcor_status mcor_await_program(
  mcor_context* context, mcor_program number, cl_program* program, cl_int* error)
{
  struct mcor_builder* builder = context->cl.builder;
  mcor_build_job* job = builder ? &builder->jobs[number] : NULL;
  if (!job || !job->program)
  {
    return MCOR_OK;
  }
  mcor_status status = MCOR_OK;
  pthread_mutex_lock(&builder->lock);
  if (!job->is_begun)
  {
    mcor_run_job(builder, job);
  }
  while (!job->is_done && status == MCOR_OK)
  {
    /* Reports about every second how long building may still take. */
    struct timespec until;
    timespec_get(&until, TIME_UTC);
    ++until.tv_sec;
    pthread_cond_timedwait(&builder->done, &builder->lock, &until);
    pthread_mutex_unlock(&builder->lock);
    status = mcor_ask(context, true);
    pthread_mutex_lock(&builder->lock);
  }
  if (job->is_done)
  {
    *program = job->program;
    *error = job->error;
    job->program = NULL;
  }
  pthread_mutex_unlock(&builder->lock);
  return status;
}

void mcor_end_building(mcor_cl* cl)
{
  struct mcor_builder* builder = cl->builder;
  if (!builder)
  {
    return;
  }
  pthread_mutex_lock(&builder->lock);
  for (int i = 0; i < MCOR_PROGRAM_COUNT; ++i)
  {
    builder->jobs[i].is_begun = true; /* no thread begins it any more */
  }
  pthread_mutex_unlock(&builder->lock);
  for (int t = 0; t < builder->thread_count; ++t)
  {
    pthread_join(builder->threads[t], NULL);
  }
  for (int i = 0; i < MCOR_PROGRAM_COUNT; ++i)
  {
    mcor_build_job* job = &builder->jobs[i];
    if (job->program && job->is_done && job->error == CL_SUCCESS)
    {
      cl->programs[i] = job->program;
    }
    else if (job->program)
    {
      clReleaseProgram(job->program);
    }
  }
  pthread_cond_destroy(&builder->done);
  pthread_mutex_destroy(&builder->lock);
  free(builder);
  cl->builder = NULL;
}
