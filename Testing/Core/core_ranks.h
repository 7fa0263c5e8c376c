/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_ranks_h
#define core_ranks_h

/* Threads as ranks. */

#include "mcor_parts.h"

#include <pthread.h>

#define CORE_MOST_RANKS 8

typedef struct core_world
{
  int count;
  pthread_mutex_t lock;
  pthread_cond_t all_came;
  int came, round, failed, left; /* left: ranks that gave up, and take no part any more */
  int64_t calls[CORE_MOST_RANKS];
  const void* value[CORE_MOST_RANKS]; /* of each rank's call that is under way */
  int64_t size[CORE_MOST_RANKS];
} core_world;

typedef struct core_rank
{
  core_world* world;
  int number;
  void* gathered;
  mcor_ranks ranks; /* for options.ranks */
} core_rank;

/* The work of a rank, in a thread of its own. */
typedef void (*core_rank_body)(core_rank* rank, void* data);

/* Runs `count` ranks to their ends. A rank whose body has called core_leave takes no part in what
 * others go on to exchange: they fail. */
void core_run_ranks(int count, core_rank_body body, void* data, core_world* world);
void core_leave(core_rank* rank);

#endif
