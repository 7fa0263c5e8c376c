/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_ranks_h
#define core_ranks_h

/* Runs ranks as threads of one process. */

#include "core_fixture.h"

#include <pthread.h>

#define CORE_MOST_RANKS 8

typedef struct core_world
{
  int count;
  pthread_mutex_t lock;
  pthread_cond_t all_came;
  int came, round, failed, left;      /* left: ranks that gave up and take part no longer */
  const void* value[CORE_MOST_RANKS]; /* what each rank shows in the present exchange */
  int64_t size[CORE_MOST_RANKS];
  mcor_status status[CORE_MOST_RANKS]; /* what each rank returned, and its last error */
  char error[CORE_MOST_RANKS][400];
} core_world;

typedef struct core_rank
{
  core_world* world;
  int number;
  void* gathered;
  mcor_context* context;
  mcor_ranks ranks; /* for options.ranks */
} core_rank;

/* What a rank does in its thread. */
typedef mcor_status (*core_rank_body)(core_rank* rank, void* data);

/* Runs `count` ranks until all have ended. After a rank has failed, exchanges of the other ranks fail. */
void core_run_ranks(int count, core_rank_body body, void* data, core_world* world);
/* Fails unless every rank has succeeded. */
void core_expect_ranks(const core_world* world, const char* name);

#endif
