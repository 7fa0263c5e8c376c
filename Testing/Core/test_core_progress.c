/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests progress reports, and runs that a report's callback cancels. */

#include "core_fixture.h"

typedef struct cancel_at
{
  int calls, stop_at; /* stop_at < 0: never */
  double last;
  char phases[200];
} cancel_at;

static int on_progress(void* user, double fraction, const char* phase)
{
  cancel_at* c = user;
  CORE_CHECK(fraction >= c->last && fraction <= 1, fraction, c->last);
  c->last = fraction;
  snprintf(c->phases + strlen(c->phases), sizeof c->phases - strlen(c->phases), "%s;", phase);
  return c->calls++ == c->stop_at;
}

/* Makes a call of this kind (0: surface, 1: probe, 2: derivatives), and frees the result. */
static mcor_status run_kind(
  mcor_context* context, int kind, const mcor_input* input, const mcor_options* options)
{
  mcor_surface surface;
  mcor_samples samples;
  mcor_derivatives derivatives;
  mcor_status status;
  switch (kind)
  {
    case 0:
      status = mcor_extract(context, input, options, &surface);
      mcor_free_surface(&surface);
      return status;
    case 1:
      status = mcor_probe(context, input, options, &input->positions, input->count, &samples);
      mcor_free_samples(&samples);
      return status;
    default:
      status = mcor_derive(context, input, options, MCOR_GRADIENT_CORRECTED, &derivatives);
      mcor_free_derivatives(&derivatives);
      return status;
  }
}

/* If each launch reports, there are many reports, and the fraction never falls. After a report whose callback asks to
 * stop, there is no other report. */
static void test_cancel_between_launches(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_block(8, 0.2, 3, core_slope);
  const double iso = 0, interval = context->report_interval;
  const mcor_array attribute = core_array(set.scalar, 1);
  const mcor_input input = core_input_with(&set, &attribute, 1);
  mcor_options options = core_options(&iso);
  options.progress = on_progress;
  for (int kind = 0; kind < 3; ++kind)
  {
    options.iso_count = kind == 0;
    cancel_at phases = { .stop_at = -1 }, launches = phases, again = phases;
    context->report_interval = INFINITY;
    options.progress_user = &phases;
    CORE_OK(context, run_kind(context, kind, &input, &options)); /* builds */
    context->report_interval = 0;
    mcor_release_memory(context); /* larger buffers of earlier calls would save some copies */
    options.progress_user = &launches;
    CORE_OK(context, run_kind(context, kind, &input, &options));
    CORE_CHECK(launches.calls > phases.calls + 10, kind, launches.calls);
    assert_true(launches.last == 1);
    for (int stop = 0; stop < launches.calls; stop += 1 + stop / 4)
    {
      cancel_at at = { .stop_at = stop };
      options.progress_user = &at;
      const mcor_status status = run_kind(context, kind, &input, &options);
      CORE_CHECK(status == MCOR_CANCELLED && at.calls == stop + 1, kind, stop,
        mcor_status_name(status), at.calls);
    }
    mcor_release_memory(context);
    options.progress_user = &again;
    CORE_OK(context, run_kind(context, kind, &input, &options));
    assert_int_equal(again.calls, launches.calls);
  }
  context->report_interval = interval;
}

/* Counts the calls in each phase. */
static int count_phase(void* user, double fraction, const char* phase)
{
  (void)fraction;
  for (int p = 0; p < MCOR_PHASE_COUNT; ++p)
  {
    ((int*)user)[p] += strcmp(phase, mcor_phase_name((mcor_phase)p)) == 0;
  }
  return 0;
}

/* Each phase reports at several places, where the run can be cancelled. Loops of the host and copies report, too, so
 * that phases with few launches also report often enough. (The built-in device reports somewhat more often than
 * drivers.) */
static void test_all_phases_ask(void** state)
{
  mcor_context* context = *state;
  const bool built_in = strcmp(context->cl.platform_name, "built in") == 0;
  CORE_SET set = core_make_block(12, 0.2, 3, core_slope);
  const double iso = 0, interval = context->report_interval;
  const int expected[MCOR_PHASE_COUNT] = { [MCOR_PHASE_INPUT] = 3,
    [MCOR_PHASE_SEARCH_GRID] = 23,
    [MCOR_PHASE_SEEDS] = built_in ? 40 : 36,
    [MCOR_PHASE_EXTRACTION] = 14,
    [MCOR_PHASE_CORRECTION] = 5,
    [MCOR_PHASE_TRIMMING] = 30,
    [MCOR_PHASE_OUTPUT] = 11 };
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  context->report_interval = 0;
  options.progress = count_phase;
  for (int levels = 0; levels < 2; ++levels)
  {
    int calls[MCOR_PHASE_COUNT] = { 0 };
    options.level_limit = levels;
    options.progress_user = calls;
    mcor_release_memory(context);
    core_hash_of(context, &input, &options);
    for (int p = 0; p < MCOR_PHASE_COUNT; ++p)
    {
      CORE_CHECK(calls[p] >= expected[p], mcor_phase_name((mcor_phase)p), calls[p]);
    }
  }
  context->report_interval = interval;
}

/* If sums have very many terms, a launch is cut into parts. Each part reports. No bit changes. */
static void test_long_launches_are_cut(void** state)
{
  mcor_context* context = *state;
  CORE_SET set = core_make_block(16, 0.2, 3, core_slope);
  const double half = 0.5, interval = context->report_interval;
  const int units = context->cl.units;
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&half);
  options.field = MCOR_WEIGHT_SUM;
  options.h_scale = 5;
  options.level_limit = 0;
  options.progress = on_progress;
  cancel_at whole = { .stop_at = -1 }, cut = whole;
  context->cl.units = 1 << 30;
  options.progress_user = &whole;
  const uint64_t expected = core_hash_of(context, &input, &options); /* builds */
  whole = (cancel_at){ .stop_at = -1 };
  context->report_interval = 0;
  core_hash_of(context, &input, &options);
  context->cl.units = 1;
  options.progress_user = &cut;
  assert_true(core_hash_of(context, &input, &options) == expected);
  context->cl.units = units;
  if (context->cl.is_cpu)
  {
    CORE_CHECK(cut.calls >= whole.calls + 4, cut.calls, whole.calls);
  }
  context->report_interval = interval;
}

CORE_MAIN(core_set_up, core_tear_down, test_cancel_between_launches, test_all_phases_ask,
  test_long_launches_are_cut)
