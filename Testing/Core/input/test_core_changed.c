/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests calls during which other code writes to the input's arrays. The call must return, with a message if it noticed
 * the change, and the next call must work as if nothing had happened. */

#include "core_fixture.h"

#include <pthread.h>
#include <stdatomic.h>

enum
{
  KEEP,
  PERIODIC,
  IN_A_BOX,
  WITH_SOLIDS,
  CASES
};

typedef struct changed_call
{
  particle_set set;
  double *before, iso; /* before: the positions before the change */
  mcor_input input;
  mcor_options options;
} changed_call;

static void begin_call(changed_call* call, int which)
{
  call->set = core_make_block(12, 0.2, 3, core_ball);
  for (int64_t i = 0; i < call->set.count && which == WITH_SOLIDS; ++i)
  {
    call->set.solid[i] = call->set.position[3 * i] < -3;
    call->set.has_solids = 1;
  }
  call->before = core_copy(call->set.position, (size_t)call->set.count * 3 * sizeof(double));
  call->iso = 0;
  call->input = core_input(&call->set);
  call->options = core_options(&call->iso);
  const double box[6] = { -2, 3, -INFINITY, INFINITY, -1, 4 }, period[6] = { -6, 6, -6, 6, -6, 6 };
  if (which == IN_A_BOX)
  {
    memcpy(call->options.box, box, sizeof box);
  }
  memcpy(call->options.periodic, period, which == PERIODIC ? sizeof period : 0);
}

static void free_call(changed_call* call)
{
  particle_set_free(&call->set);
  free(call->before);
}

/* ---- Changed by the progress callback, at each launch in turn ---- */

enum
{
  FAR,
  ASIDE,
  NO_NUMBER,
  ONE_PLACE,
  LARGE,
  CHANGES
};

typedef struct changer
{
  changed_call* call;
  int kind, at, calls;
} changer;

static void change(const changer* c)
{
  const particle_set* set = &c->call->set;
  for (int64_t i = 0; i < set->count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      double* x = set->position + 3 * i + a;
      *x = c->kind == FAR      ? 1e6 * (double)(i % 7)
        : c->kind == ASIDE     ? *x + 5
        : c->kind == NO_NUMBER ? (i % 3 == 0 ? NAN : INFINITY)
        : c->kind == ONE_PLACE ? 0.25
                               : *x;
    }
    set->smoothing_length[i] *= c->kind == LARGE && i % 5 == 0 ? 1e9 : 1;
  }
}

static int change_once(void* user, double fraction, const char* phase)
{
  changer* c = user;
  (void)fraction;
  (void)phase;
  if (c->calls++ == c->at)
  {
    change(c);
  }
  return 0;
}

static void test_changes_at_each_launch(void** state)
{
  mcor_context* context = *state;
  const double interval = context->report_interval;
  int calls = 0;
  for (int which = 0; which < CASES; ++which)
  {
    for (int kind = 0; kind < CHANGES; ++kind)
    {
      for (int at = 0, done = 0; !done; at += 1 + at / 8)
      {
        CORE_OWNED(free_call) changed_call call;
        begin_call(&call, which);
        changer c = { &call, kind, at, 0 };
        call.options.progress = change_once;
        call.options.progress_user = &c;
        context->report_interval = 0; /* each launch */
        CORE_SURFACE surface;
        const mcor_status status = mcor_extract(context, &call.input, &call.options, &surface);
        CORE_CHECK(status == MCOR_OK || status == MCOR_INVALID_DATA ||
            status == MCOR_INVALID_ARGUMENT || status == MCOR_OUT_OF_CAPACITY,
          mcor_status_name(status), mcor_last_error(context));
        ++calls;
        done = c.calls <= at;
      }
    }
  }
  context->report_interval = interval;
  CORE_CHECK(calls > 200, calls);
}

/* ---- Changed between measuring and extracting ---- */

static void test_other_globals(void** state)
{
  mcor_context* context = *state;
  for (int kind = 0; kind < CHANGES; ++kind)
  {
    CORE_OWNED(free_call) changed_call call;
    begin_call(&call, KEEP);
    CORE_OWNED(mcor_free_globals) mcor_globals globals;
    CORE_SURFACE surface;
    CORE_OK(context, mcor_measure_globals(context, &call.input, &call.options, &globals));
    call.options.globals = &globals;
    CORE_OK(context, mcor_extract(context, &call.input, &call.options, &surface));
    mcor_free_surface(&surface);
    changer c = { &call, kind, 0, 0 };
    change(&c);
    const mcor_status status = mcor_extract(context, &call.input, &call.options, &surface);
    const bool within = kind == ONE_PLACE;
    CORE_CHECK(status == (within ? MCOR_OK : MCOR_INVALID_DATA), kind, mcor_last_error(context));
    const char* sentence = kind == NO_NUMBER ? "ARRAY_VALUE" : "ARRAYS_CHANGED";
    CORE_CHECK(within || core_told(context, sentence), kind, mcor_last_error(context));
  }
}

/* ---- Positions that another thread changes all the time ---- */

typedef struct writer
{
  changed_call* call;
  atomic_bool ends;
} writer;

static void* write_positions(void* data)
{
  writer* w = data;
  uint32_t random = 1;
  while (!atomic_load(&w->ends))
  {
    for (int64_t i = 0; i < 3 * w->call->set.count; ++i)
    {
      random = random * 1664525u + 1013904223u;
      ((volatile double*)w->call->set.position)[i] = w->call->before[i] + ldexp(random, -32) - 0.5;
    }
  }
  return NULL;
}

static void test_changes_all_the_time(void** state)
{
  mcor_context* context = *state;
  int noticed = 0;
  for (int which = 0; which < CASES; ++which)
  {
    CORE_OWNED(free_call) changed_call call;
    begin_call(&call, which);
    const uint64_t expected = core_hash_of(context, &call.input, &call.options);
    writer w = { .call = &call };
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, write_positions, &w), 0);
    for (int round = 0; round < 60; ++round)
    {
      CORE_SURFACE surface;
      const mcor_status status = mcor_extract(context, &call.input, &call.options, &surface);
      CORE_CHECK(status == MCOR_OK || status == MCOR_INVALID_DATA, mcor_status_name(status),
        mcor_last_error(context));
      noticed += core_told(context, "ARRAYS_CHANGED");
    }
    atomic_store(&w.ends, true);
    pthread_join(thread, NULL);
    memcpy(call.set.position, call.before, (size_t)call.set.count * 3 * sizeof(double));
    CORE_CHECK(core_hash_of(context, &call.input, &call.options) == expected, which);
  }
  print_message("%d calls of %d noticed\n", noticed, 60 * CASES);
}

CORE_MAIN(core_set_up, core_tear_down, test_other_globals, test_changes_at_each_launch,
  test_changes_all_the_time)
