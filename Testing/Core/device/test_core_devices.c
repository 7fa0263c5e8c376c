/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Processes of one machine take devices in turn, and each takes a share of the CPU. In this test PoCL shows one device
 * twice. */

#include "core_fixture.h"
#include "mcor_parallel.h"

enum
{
  PROCESSES = 5
};

static void test_turns_and_shares(void** state)
{
  CORE_SET set = core_make_block(7, 0.3, 3, core_ball);
  const double iso = 2;
  const mcor_input input = core_input(&set);
  const mcor_options options = core_options(&iso);
  mcor_context* context = *state;
  mcor_surface surface = core_extract(context, &input, &options);
  const uint64_t expected = core_hash(&surface);
  const int first = context->cl.device_number, units = context->cl.units;
  assert_true(surface.triangle_count > 100);
  mcor_free_surface(&surface);
  for (int place = 0; place < PROCESSES; ++place)
  {
    /* Three processes have the first device, two the second. */
    const int share = mcor_processors(place % 2 ? 2 : 3);
    CORE_OK(context, mcor_create_shared_context(NULL, place, PROCESSES, &context));
    assert_int_equal(context->cl.device_number, first + place % 2);
    assert_int_equal(context->cl.units, share < units ? share : units);
    surface = core_extract(context, &input, &options);
    assert_true(core_hash(&surface) == expected);
    mcor_free_surface(&surface);
    mcor_free_context(context);
  }
}

/* A device named by its number is always taken. Devices that share a name are taken in turn. */
static void test_named_device(void** state)
{
  mcor_context* context = *state;
  const int first = context->cl.device_number;
  const char number[] = { (char)('0' + first + 1), '\0' };
  for (int place = 0; place < 3; ++place)
  {
    CORE_OK(context, mcor_create_shared_context(number, place, 3, &context));
    assert_int_equal(context->cl.device_number, first + 1);
    mcor_free_context(context);
    CORE_OK(context, mcor_create_shared_context("pocl", place, 3, &context));
    assert_int_equal(context->cl.device_number, first + place % 2);
    mcor_free_context(context);
  }
}

static void test_no_such_place(void** state)
{
  CORE_CONTEXT context;
  assert_int_equal(mcor_create_shared_context(NULL, 2, 2, &context), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(context, "PLACE_ILLEGAL|2"));
}

typedef struct building
{
  int told;
  bool cancels;
} building;

static int on_progress(void* user, double fraction, const char* phase)
{
  building* b = user;
  (void)fraction;
  const bool is_building = strncmp(phase, MCOR_BUILDING, sizeof MCOR_BUILDING - 1) == 0;
  const char* rest = phase + sizeof MCOR_BUILDING - 1;
  int seconds;
  assert_true(!is_building || !*rest || sscanf(rest, ", about %d s to come", &seconds) == 1);
  b->told += is_building;
  return is_building && b->cancels;
}

/* Extracts in a new context, and checks that the run has built exactly the programs that mcor_list_programs names. Only
 * the program for trimming may be missing, because the surface may have no border. */
static void check_programs(const mcor_input* input, const mcor_options* options)
{
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context("pocl", &context));
  CORE_SURFACE surface = core_extract(context, input, options);
  assert_true(surface.triangle_count > 20);
  const int wanted = mcor_list_programs(context, input, options, false);
  int built = 1 << MCOR_PROGRAM_TRIM;
  for (int p = 0; p < MCOR_PROGRAM_COUNT; ++p)
  {
    built |= (context->cl.programs[p] != NULL) << p;
  }
  CORE_CHECK(built == (wanted | 1 << MCOR_PROGRAM_TRIM), "programs %x were used, not %x", (unsigned)built, (unsigned)wanted);
}

/* mcor_list_programs must name the programs that a run uses: with MCOR_PAIRS; with a box; with adaptive cubes,
 * curvature and nearest particles. */
static void test_programs_of_runs(void** state)
{
  CORE_SET set = core_make_block(7, 0.3, 3, core_ball);
  const double iso = 2;
  const mcor_input input = core_input(&set);
  const mcor_options plain = core_options(&iso);
  mcor_options options = plain;
  setenv("MCOR_THREADS", "1", 1); /* nothing is built ahead, so only what is used is built */
  options.seeds = MCOR_PAIRS;
  check_programs(&input, &options);
  options = plain;
  for (int a = 0; a < 6; ++a)
  {
    options.box[a] = a % 2 ? 4 : a == 4 ? 0 : -4;
  }
  check_programs(&input, &options);
  set.smoothing_length[0] *= 2;
  const mcor_input adaptive = core_input(&set);
  options = plain;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  options.outputs |= MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_NEAREST_PARTICLE;
  check_programs(&adaptive, &options);
  unsetenv("MCOR_THREADS");
}

/* Checks runs whose programs other threads build ahead. The call may be cancelled meanwhile, and no building thread may
 * outlive the call. */
static void test_building_ahead(void** state)
{
  CORE_SET set = core_make_block(7, 0.3, 3, core_ball);
  const double iso = 2;
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  CORE_SURFACE expected = core_extract(*state, &input, &options);
  building b = { 0, true };
  options.progress = on_progress;
  options.progress_user = &b;
  setenv("MCOR_THREADS", "2", 1); /* even if there is only one processor */
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context("pocl", &context));
  mcor_surface none;
  CORE_FAILS(context, MCOR_CANCELLED, mcor_extract(context, &input, &options, &none), "CANCELLED_BUILDING");
  assert_int_equal(b.told, 1);
  assert_null(context->cl.builder);
  b.cancels = false;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  assert_true(core_hash(&surface) == core_hash(&expected));
  assert_null(context->cl.builder);
  assert_int_equal(context->pool.count, 0);
  unsetenv("MCOR_THREADS");
}

/* If global values were measured with solids, a part of the particles counts as having solids, even if it has none: the
 * whole and its parts need the same programs. Ignored solids do not count. */
static void test_solids_of_parts(void** state)
{
  CORE_SET set = core_make_block(7, 0.3, 3, core_ball);
  const double iso = 2;
  mcor_input whole = core_input(&set), part = whole;
  mcor_options options = core_options(&iso);
  mcor_globals globals;
  set.solid[0] = 1;
  whole.solid = set.solid;
  CORE_OK(*state, mcor_measure_globals(*state, &whole, &options, &globals));
  assert_true(mcor_has_solids(&whole, &options) && !mcor_has_solids(&part, &options));
  options.globals = &globals;
  assert_true(mcor_has_solids(&part, &options));
  part.ignore_solids = 1;
  assert_false(mcor_has_solids(&part, &options));
  mcor_free_globals(&globals);
}

int main(void)
{
  setenv("POCL_DEVICES", "pthread pthread", 1);
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_turns_and_shares),
    cmocka_unit_test(test_named_device), cmocka_unit_test(test_no_such_place),
    cmocka_unit_test(test_programs_of_runs), cmocka_unit_test(test_solids_of_parts),
    cmocka_unit_test(test_building_ahead) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
