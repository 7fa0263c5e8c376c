/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core_ranks.h"

/* Ends a round of waiting if all ranks that have not left are waiting. The caller holds the lock. */
static void end_round_where_all_came(core_world* world)
{
  if (world->came > 0 && world->came >= world->count - world->left)
  {
    world->came = 0;
    world->failed = world->left > 0;
    ++world->round;
    pthread_cond_broadcast(&world->all_came);
  }
}

/* Waits until all ranks that take part have come here. Returns nonzero if a rank has left. */
static int wait_for_all(core_world* world)
{
  pthread_mutex_lock(&world->lock);
  const int round = world->round;
  ++world->came;
  end_round_where_all_came(world);
  while (world->round == round)
  {
    pthread_cond_wait(&world->all_came, &world->lock);
  }
  const int failed = world->failed; /* the state when the round ended; other ranks may have left
                                     * since */
  pthread_mutex_unlock(&world->lock);
  return failed;
}

static void leave(core_world* world)
{
  pthread_mutex_lock(&world->lock);
  ++world->left;
  end_round_where_all_came(world);
  pthread_mutex_unlock(&world->lock);
}

/* Lets all ranks read a value of this rank until the next call of wait_for_all. Returns nonzero if
 * a rank has left. */
static int show(core_rank* rank, const void* value, int64_t size)
{
  rank->world->value[rank->number] = value;
  rank->world->size[rank->number] = size;
  return wait_for_all(rank->world);
}

/* Defines a function that reduces numbers of one type over all ranks. Each rank adds in another order, because the
 * library's results must not depend on the order. */
#define RANKS_REDUCE(name, type)                                                                   \
  static int name(void* user, mcor_reduction reduction, type* values, int count)                   \
  {                                                                                                \
    core_rank* rank = user;                                                                        \
    type* result = malloc((size_t)count * sizeof *result);                                         \
    int failed = !result || show(rank, values, count);                                             \
    for (int r = 0; r < rank->world->count && !failed; ++r)                                        \
    {                                                                                              \
      const int from = (r + rank->number) % rank->world->count;                                    \
      const type* other = rank->world->value[from];                                                \
      failed = failed || rank->world->size[from] != count;                                         \
      for (int i = 0; i < count && !failed; ++i)                                                   \
      {                                                                                            \
        const type last = r == 0 ? other[i] : result[i];                                           \
        const int take = reduction == MCOR_LEAST ? other[i] < last : other[i] > last;              \
        result[i] = r > 0 && reduction == MCOR_SUM_OF ? last + other[i] : take ? other[i] : last;  \
      }                                                                                            \
    }                                                                                              \
    failed = wait_for_all(rank->world) || failed;                                                  \
    if (!failed)                                                                                   \
    {                                                                                              \
      memcpy(values, result, (size_t)count * sizeof *result);                                      \
    }                                                                                              \
    free(result);                                                                                  \
    return failed;                                                                                 \
  }
RANKS_REDUCE(reduce_doubles, double)
RANKS_REDUCE(reduce_counts, int64_t)

static int gather(void* user, const void* records, int64_t count, size_t width, const void** all,
  int64_t* all_count)
{
  core_rank* rank = user;
  int failed = show(rank, records, count);
  int64_t total = 0;
  for (int r = 0; r < rank->world->count && !failed; ++r)
  {
    total += rank->world->size[r];
  }
  free(rank->gathered);
  rank->gathered = malloc((size_t)total * width + 1);
  char* to = rank->gathered;
  failed = failed || !to;
  for (int r = 0; r < rank->world->count && !failed; ++r)
  {
    const int from = (r + rank->number) % rank->world->count;
    const size_t bytes = (size_t)rank->world->size[from] * width;
    if (bytes > 0)
    {
      memcpy(to, rank->world->value[from], bytes);
    }
    to += bytes;
  }
  *all = rank->gathered;
  *all_count = total;
  return wait_for_all(rank->world) || failed;
}

typedef struct core_thread
{
  core_rank rank;
  core_rank_body body;
  void* data;
} core_thread;

static void* run_rank(void* data)
{
  core_thread* thread = data;
  core_rank* rank = &thread->rank;
  core_world* world = rank->world;
  mcor_status* status = &world->status[rank->number];
  *status = mcor_create_context(NULL, &rank->context);
  MCOR_THEN(*status, thread->body(rank, thread->data));
  snprintf(
    world->error[rank->number], sizeof world->error[0], "%s", mcor_last_error(rank->context));
  if (*status != MCOR_OK)
  {
    leave(world);
  }
  mcor_free_context(rank->context);
  free(rank->gathered);
  return NULL;
}

void core_run_ranks(int count, core_rank_body body, void* data, core_world* world)
{
  core_thread threads[CORE_MOST_RANKS];
  pthread_t ids[CORE_MOST_RANKS];
  *world = (core_world){ .count = count };
  pthread_mutex_init(&world->lock, NULL);
  pthread_cond_init(&world->all_came, NULL);
  for (int r = 0; r < count; ++r)
  {
    threads[r] =
      (core_thread){ .rank = { .world = world, .number = r }, .body = body, .data = data };
    threads[r].rank.ranks = (mcor_ranks){ .reduce_doubles = reduce_doubles,
      .reduce_counts = reduce_counts,
      .gather = gather,
      .user = &threads[r].rank };
    if (pthread_create(&ids[r], NULL, run_rank, &threads[r]) != 0)
    {
      abort();
    }
  }
  for (int r = 0; r < count; ++r)
  {
    pthread_join(ids[r], NULL);
  }
  pthread_mutex_destroy(&world->lock);
  pthread_cond_destroy(&world->all_came);
}

void core_expect_ranks(const core_world* world, const char* name)
{
  for (int r = 0; r < world->count; ++r)
  {
    CORE_CHECK(world->status[r] == MCOR_OK, name, r, world->count, world->error[r]);
  }
}
