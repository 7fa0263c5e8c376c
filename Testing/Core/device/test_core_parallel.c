/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Checks that loops in several threads visit every element once, and that their results do not depend on the number of
 * threads. */

#include "core_fixture.h"
#include "mcor_input.h"
#include "mcor_parallel.h"

#include <pthread.h>

/* Counts how often a loop visits its elements and slices. */
typedef struct visits
{
  int64_t count;
  uint8_t* elements;
  int64_t sizes[MCOR_SLICES];
  int strange; /* visits of slices that do not exist */
} visits;

static void visit(void* data, int slice, int64_t first, int64_t last)
{
  visits* v = data;
  if (slice < 0 || slice >= MCOR_SLICES || first < 0 || last > v->count || first >= last)
  {
    v->strange = 1;
    return;
  }
  v->sizes[slice] += last - first;
  for (int64_t i = first; i < last; ++i)
  {
    ++v->elements[i];
  }
}

/* Returns whether a loop visits every element and slice once. */
static bool is_complete(int64_t count, int64_t grain)
{
  visits v = { .count = count, .elements = calloc((size_t)count + 1, 1) };
  bool good = v.elements != NULL;
  const int slices = good ? mcor_parallel_for(NULL, count, grain, visit, &v) : 0;
  int64_t sum = 0;
  for (int s = 0; s < MCOR_SLICES; ++s)
  {
    good = good && (v.sizes[s] > 0) == (s < slices) &&
      (s >= slices || slices == 1 || v.sizes[s] >= grain);
    sum += v.sizes[s];
  }
  for (int64_t i = 0; good && i < count; ++i)
  {
    good = v.elements[i] == 1;
  }
  free(v.elements);
  return good && sum == count && !v.strange;
}

static bool are_all_complete(void)
{
  const int64_t grains[] = { 1, 7, 1000 };
  bool good = true;
  for (int g = 0; g < 3; ++g)
  {
    const int64_t grain = grains[g];
    const int64_t counts[] = { 0, 1, grain - 1, grain, grain + 1, 2 * grain - 1, 2 * grain,
      2 * grain + 1, MCOR_SLICES * grain - 1, MCOR_SLICES * grain, 100 * grain + 13, 300007 };
    for (size_t c = 0; c < sizeof counts / sizeof counts[0]; ++c)
    {
      good = is_complete(counts[c], grain) && good;
    }
  }
  return good;
}

static void test_every_element_once(void** state)
{
  assert_true(are_all_complete());
}

static void* check_all(void* good)
{
  *(bool*)good = are_all_complete();
  return NULL;
}

typedef struct cancelled_loop
{
  int asked, asked_most;
} cancelled_loop;

static int ask(void* user, double fraction, const char* phase)
{
  cancelled_loop* loop = user;
  (void)fraction, (void)phase;
  return loop->asked++ == loop->asked_most;
}

/* After each slice a loop asks whether to go on. A cancelled loop leaves out the slices that no thread has begun: with
 * one thread, all later slices. */
static void test_cancelled(void** state)
{
  CORE_CONTEXT context = NULL;
  const double iso = 0;
  const int64_t count = MCOR_SLICES * 64;
  core_create_with(&context, "MCOR_THREADS", "1");
  mcor_options options = core_options(&iso);
  options.progress = ask;
  context->run.options = &options;
  context->run.doing = "a loop";
  context->cl.observer = mcor_observe_call;
  context->report_interval = 0;
  for (int most = 0; most < 3; ++most)
  {
    visits v = { .count = count, .elements = calloc((size_t)count, 1) };
    cancelled_loop loop = { .asked_most = most };
    int slices = 0, made = 0;
    assert_non_null(v.elements);
    options.progress_user = &loop;
    const mcor_status status = mcor_parallel_run(context, count, 64, visit, &v, &slices);
    for (int s = 0; s < MCOR_SLICES; ++s)
    {
      made += v.sizes[s] == 64;
    }
    assert_int_equal(slices, MCOR_SLICES);
    assert_int_equal(status, MCOR_CANCELLED);
    assert_int_equal(loop.asked, most + 1);
    assert_int_equal(made, most + 1);
    assert_false(v.strange);
    free(v.elements);
  }
}

static void test_several_at_once(void** state)
{
  pthread_t threads[4];
  bool good[4] = { false };
  for (int t = 0; t < 4; ++t)
  {
    assert_int_equal(pthread_create(&threads[t], NULL, check_all, &good[t]), 0);
  }
  for (int t = 0; t < 4; ++t)
  {
    assert_int_equal(pthread_join(threads[t], NULL), 0);
    assert_true(good[t]);
  }
}

/* If several particles are bad, the message names the first one, whichever a thread finds first. */
static void test_first_bad_particle(void** state)
{
  const double iso = 0, bad[3] = { 1e35, -1, NAN };
  const mcor_options options = core_options(&iso);
  for (int kind = 0; kind < 3; ++kind)
  {
    CORE_SET set = core_make_block(40, 0.2, 3, core_ball);
    assert_true(set.count > 4 * MCOR_HEAVY_GRAIN);
    for (int64_t i = 30007; i < set.count; i += 5000)
    {
      (kind < 2 ? set.volume : set.scalar)[i] = bad[kind];
    }
    const mcor_input input = core_input(&set);
    mcor_surface surface;
    CORE_FAILS(*state, MCOR_INVALID_DATA, mcor_extract(*state, &input, &options, &surface),
      "particle 30007 ");
  }
}

/* Ranges cover the values of the fluid alone. If all particles are solids, the range is empty. Some slices may have no
 * fluid. */
static void test_ranges(void** state)
{
  const int64_t count = 4 * MCOR_MEMORY_GRAIN;
  CORE_FREED float* values = malloc((size_t)count * sizeof *values);
  CORE_FREED uint8_t* solid = malloc((size_t)count);
  assert_true(values && solid);
  for (int64_t i = 0; i < count; ++i)
  {
    values[i] = (float)i;
    solid[i] = i < count / 2 || i % 7 == 0;
  }
  const mcor_array array = { .data = values, .type = MCOR_FLOAT32 };
  const mcor_input input = { .count = count };
  mcor_findings found = mcor_find_range(NULL, &array, solid, MCOR_SKIP_SOLIDS, count, 0);
  assert_true(found.least[0] == (double)(count / 2) && found.most[0] == (double)(count - 1));
  assert_true(mcor_largest(NULL, &input, &array, 0) == (double)(count - 1));
  values[3] = -1e9f;
  assert_true(mcor_largest(NULL, &input, &array, 0) == 1e9);
  memset(solid, 1, (size_t)count);
  found = mcor_find_range(NULL, &array, solid, MCOR_SKIP_SOLIDS, count, 0);
  assert_true(found.least[0] > found.most[0]);
  assert_true(mcor_largest_of(found.least[0], found.most[0]) == 0);
}

CORE_MAIN(core_set_up, core_tear_down, test_every_element_once, test_several_at_once,
  test_cancelled, test_first_bad_particle, test_ranges)
