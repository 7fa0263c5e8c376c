/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Lets OpenCL calls, allocations of the host and callbacks of ranks fail one after the other. Each failure must give a
 * status, a message and an empty result, and leave no buffer. The next call on the same context must be right. */

#include "core_fault.h"

/* A call of the library. One after the other, its OpenCL calls and allocations are made to fail. */
typedef struct sweep
{
  /* Makes the call. If it succeeds, *hash becomes the hash of the result; if it fails, the result must be empty. */
  mcor_status (*call)(
    mcor_context* context, const struct sweep* s, const mcor_input* input, uint64_t* hash);
  mcor_input input;
  mcor_options options;
  mcor_array points;
  int point_count;
  uint64_t expected;
  int64_t bytes;
  bool arguments; /* setting arguments of launches fails, too */
  int step;
} sweep;

#define BUFFERS_KEPT 2 /* the tables that a context holds after creation */

static mcor_status extract(
  mcor_context* context, const sweep* s, const mcor_input* input, uint64_t* hash)
{
  CORE_SURFACE surface;
  const mcor_status status = mcor_extract(context, input, &s->options, &surface);
  *hash = core_hash(&surface);
  CORE_CHECK(status == MCOR_OK ? surface.triangle_count > 20
                               : !surface.points && !surface.triangles && !surface.attributes &&
        !surface.point_keys && !surface.triangle_keys && surface.point_count == 0,
    mcor_status_name(status), surface.triangle_count);
  return status;
}

static uint64_t hash_numbers(const double* values, int64_t count)
{
  return core_hash_bytes(CORE_HASH_OF_NOTHING, values, (size_t)count * sizeof *values);
}

static mcor_status probe(
  mcor_context* context, const sweep* s, const mcor_input* input, uint64_t* hash)
{
  CORE_SAMPLES samples;
  const mcor_status status =
    mcor_probe(context, input, &s->options, &s->points, s->point_count, &samples);
  const int64_t n = samples.count;
  CORE_CHECK(status == MCOR_OK
      ? n == s->point_count && samples.weight_sum && samples.values && samples.gradients
      : !samples.weight_sum && !samples.valid && !samples.values && !samples.gradients && n == 0,
    mcor_status_name(status), n);
  *hash = status != MCOR_OK ? 0
                            : hash_numbers(samples.weight_sum, n) +
      3 * hash_numbers(samples.values[0], n) + 5 * hash_numbers(samples.gradients[0], 3 * n);
  return status;
}

static mcor_status derive(
  mcor_context* context, const sweep* s, const mcor_input* input, uint64_t* hash)
{
  CORE_DERIVATIVES found;
  const mcor_status status =
    mcor_derive(context, input, &s->options, MCOR_GRADIENT_CORRECTED, &found);
  const int64_t n = found.count;
  CORE_CHECK(status == MCOR_OK ? n == input->count && found.gradients && found.corrected
                               : !found.gradients && !found.corrected && n == 0,
    mcor_status_name(status), n);
  *hash = status == MCOR_OK ? hash_numbers(found.gradients[0], 3 * n) : 0;
  return status;
}

static mcor_status gauge(
  mcor_context* context, const sweep* s, const mcor_input* input, uint64_t* hash)
{
  static const mcor_gauge_line lines[2] = { { .from = { 0.1, 0.2, -9 }, .to = { 0.1, 0.2, 9 } },
    { .from = { -3, 0, 0 }, .to = { 1, 1, 1 } } };
  CORE_GAUGES found;
  const mcor_status status = mcor_gauge(context, input, &s->options, lines, 2, &found);
  CORE_CHECK(status == MCOR_OK ? found.count == 2 && found.crossing_count == 3
                               : !found.readings && !found.crossings && found.count == 0,
    mcor_status_name(status), found.crossing_count);
  *hash = hash_numbers(found.crossings, found.crossing_count);
  return status;
}

static mcor_status flux(
  mcor_context* context, const sweep* s, const mcor_input* input, uint64_t* hash)
{
  static const double points[9] = { -3, -0.5, 0, 3, -0.5, 0, -3, 1, 1 };
  const mcor_section section = { .points = points, .point_count = 3 };
  mcor_input moving = *input;
  const mcor_array velocity = moving.positions;
  moving.attributes = &velocity;
  CORE_FLUXES found;
  const mcor_status status = mcor_flux(context, &moving, &s->options, &section, 1, &found);
  CORE_CHECK(status == MCOR_OK ? found.count == 1 && found.readings[0].area > 1
                               : !found.readings && found.count == 0,
    mcor_status_name(status), found.count);
  *hash = status == MCOR_OK ? hash_numbers(&found.readings[0].area, 2) : 0;
  return status;
}

/* callbacks: how often callbacks of the only rank were called. fail_callback: the call that fails, from 0; -1: none. */
static int callbacks, fail_callback = -1;

static int reduce_doubles(void* user, mcor_reduction reduction, double* values, int count)
{
  (void)user, (void)reduction, (void)values, (void)count;
  return callbacks++ == fail_callback;
}

static int reduce_counts(void* user, mcor_reduction reduction, int64_t* values, int count)
{
  (void)user, (void)reduction, (void)values, (void)count;
  return callbacks++ == fail_callback;
}

static int gather(void* user, const void* records, int64_t count, size_t width, const void** all,
  int64_t* all_count)
{
  (void)user, (void)width;
  *all = records;
  *all_count = count;
  return callbacks++ == fail_callback;
}

static const mcor_ranks alone = { .reduce_doubles = reduce_doubles,
  .reduce_counts = reduce_counts,
  .gather = gather };

/* Does one rank's work: measures together with all ranks, then extracts the rank's box. */
static mcor_status extract_as_rank(
  mcor_context* context, const sweep* s, const mcor_input* input, uint64_t* hash)
{
  mcor_globals globals;
  sweep box = *s;
  mcor_status status = mcor_measure_globals(context, input, &s->options, &globals);
  box.options.globals = &globals;
  *hash = 0;
  if (status == MCOR_OK)
  {
    status = extract(context, &box, input, hash);
  }
  else
  {
    assert_true(!globals.components && globals.component_count == 0);
  }
  mcor_free_globals(&globals);
  return status;
}

static void expect_right(mcor_context* context, const sweep* s)
{
  uint64_t hash;
  CORE_OK(context, s->call(context, s, &s->input, &hash));
  CORE_CHECK(hash == s->expected, core_failed_call());
}

/* The call has failed because of a fault. Checks that its message has `words` or tells of an allocation, that it has
 * left no buffers behind, and that the next call is right. */
static void expect_sound(mcor_context* context, const sweep* s, const char* words)
{
  const char* sentence = mcor_last_error(context);
  CORE_CHECK(strstr(sentence, words) || strstr(sentence, "could not allocate"), core_failed_call(),
    sentence);
  core_expect_nothing_held(context, s->bytes, BUFFERS_KEPT);
  expect_right(context, s);
}

/* Returns the input with new versions, so that arrays kept on the device are not used again, but may be released for
 * room. */
static mcor_input with_other_versions(const sweep* s, int n)
{
  mcor_input input = s->input;
  input.particles_version += 1 + (uint64_t)n;
  input.scalar_version += 1 + (uint64_t)n;
  return input;
}

/* Lets every step-th OpenCL call fail, one in each run. Returns the number of calls, rounded up to a multiple of step.
 * kept: buffers on the device may be released, so a call that lacks memory must succeed at its second attempt. */
static int sweep_calls(mcor_context* context, const sweep* s, cl_int error, int kept)
{
  const mcor_status expected = error == CL_INVALID_COMMAND_QUEUE ? MCOR_DEVICE_ERROR
    : kept                                                       ? MCOR_OK
                                                                 : MCOR_OUT_OF_CAPACITY;
  int n = 0;
  for (;; n += s->step)
  {
    uint64_t hash;
    kept ? expect_right(context, s) : core_expect_nothing_held(context, s->bytes, BUFFERS_KEPT);
    const mcor_input input = with_other_versions(s, n);
    (s->arguments ? core_fail_call : core_fail_command)(n, error);
    const mcor_status status = s->call(context, s, &input, &hash);
    core_fail_nothing();
    if (!core_failed_call()[0])
    {
      CORE_OK(context, status);
      break;
    }
    CORE_CHECK(status == expected, n, core_failed_call(), error, mcor_status_name(status),
      mcor_status_name(expected), mcor_last_error(context));
    if (status == MCOR_OK)
    {
      CORE_CHECK(hash == s->expected, core_failed_call());
    }
    else
    {
      expect_sound(context, s, "failed with CL_");
    }
  }
  return n;
}

/* Lets each allocation of the host fail, one in each run, and returns the number of allocations.
 * The library may succeed without some of them. */
static int sweep_allocations(mcor_context* context, const sweep* s)
{
  int n = 0;
  for (;; ++n)
  {
    uint64_t hash;
    const mcor_input input = with_other_versions(s, n);
    mcor_release_memory(context);
    core_fail_allocation(n);
    const mcor_status status = s->call(context, s, &input, &hash);
    core_fail_nothing();
    CORE_CHECK(status == MCOR_OK || (core_failed_call()[0] && status == MCOR_OUT_OF_CAPACITY), n,
      core_failed_call(), mcor_status_name(status), mcor_last_error(context));
    if (status == MCOR_OK)
    {
      CORE_CHECK(hash == s->expected, n);
    }
    else
    {
      expect_sound(context, s, "emory");
    }
    if (!core_failed_call()[0])
    {
      break;
    }
  }
  return n;
}

/* Keeps in `s` the hash of the right result, and how many bytes a context holds after a release of memory. */
static void begin_sweep(mcor_context* context, sweep* s)
{
  s->input.particles_version = s->input.scalar_version = 1000000;
  CORE_OK(context, s->call(context, s, &s->input, &s->expected));
  mcor_release_memory(context);
  s->bytes = context->cl.bytes;
}

/* Does what test_every_call_fails_once does, for a smaller run: each OpenCL call fails once with a device error, every
 * step-th call fails for lack of memory, and each allocation of the host fails. */
static void sweep_room(mcor_context* context, sweep* s, int step, int least_calls)
{
  begin_sweep(context, s);
  s->step = 1;
  const int calls = sweep_calls(context, s, CL_INVALID_COMMAND_QUEUE, 0);
  CORE_CHECK(calls > least_calls, calls);
  s->step = step;
  sweep_calls(context, s, CL_MEM_OBJECT_ALLOCATION_FAILURE, 0);
  if (!s->options.ranks) /* ranks do not try again */
  {
    sweep_calls(context, s, CL_MEM_OBJECT_ALLOCATION_FAILURE, 1);
  }
  const int allocations = sweep_allocations(context, s);
  CORE_CHECK(allocations > 1, allocations);
  print_message("%d calls, %d allocations\n", calls, allocations);
}

static double flat(const double x[3])
{
  return x[2];
}

/* Lets calls fail in a run with MCOR_PAIRS and MCOR_TOPOLOGY_FIELD that also writes an attribute, the boundary
 * eigenvalue and the nearest particles. */
static void test_every_call_fails_once(void** state)
{
  mcor_context* context = *state;
  static const double iso = 0.3;
  CORE_SET set = core_make_block(6, 0.3, 3, flat);
  const mcor_array attribute = core_array(set.smoothing_length, 1);
  set.smoothing_length[7] *= 1.5;
  sweep s = { .call = extract,
    .input = core_input_with(&set, &attribute, 1),
    .options = core_options(&iso),
    .arguments = true,
    .step = 1 };
  s.options.topology = MCOR_TOPOLOGY_FIELD;
  s.options.seeds = MCOR_PAIRS;
  s.options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE | MCOR_OUT_NEAREST_PARTICLE;
  begin_sweep(context, &s);
  const int calls = sweep_calls(context, &s, CL_INVALID_COMMAND_QUEUE, 0);
  CORE_CHECK(calls > 500, calls);
  s.step = 3;
  sweep_calls(context, &s, CL_MEM_OBJECT_ALLOCATION_FAILURE, 0);
  s.step = 7;
  sweep_calls(context, &s, CL_MEM_OBJECT_ALLOCATION_FAILURE, 1);
  s.step = 37;
  sweep_calls(context, &s, CL_OUT_OF_RESOURCES, 1);
  sweep_calls(context, &s, CL_OUT_OF_HOST_MEMORY, 1);
  sweep_allocations(context, &s);
}

static void test_probe_and_derive(void** state)
{
  static const double at[12] = { 0, 0, 0, 1, 0.3, 0.2, 99, 0, 0, -1, -1.2, 0.1 };
  CORE_SET set = core_make_block(5, 0.3, 3, flat);
  double* points = core_copy(at, sizeof at);
  const mcor_array attribute = core_array(set.scalar, 1);
  sweep s = { .call = probe,
    .input = core_input_with(&set, &attribute, 1),
    .options = core_options(NULL),
    .points = core_array(points, 3),
    .point_count = 4 };
  s.options.iso_count = 0;
  s.options.outputs |= MCOR_OUT_GRADIENTS;
  sweep_room(*state, &s, 3, 40);
  s.call = derive;
  sweep_room(*state, &s, 3, 40);
  s.call = gauge;
  sweep_room(*state, &s, 3, 40);
  s.call = flux;
  sweep_room(*state, &s, 3, 40);
  free(points);
}

/* Lets calls fail in a run that fills the band between two iso values in a plane. */
static void test_filled(void** state)
{
  static const double isos[2] = { -1e9, 0.5 };
  CORE_SET set = core_make_block(8, 0.1, 3, flat);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.position[3 * i + 2] = 0;
    set.scalar[i] = set.position[3 * i];
    set.volume[i] = 0.125;
  }
  sweep filled = { .call = extract, .input = core_input(&set), .options = core_options(isos) };
  filled.options.iso_count = 2;
  filled.options.filled = 1;
  filled.options.outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
  sweep_room(*state, &filled, 23, 100);
}

/* Lets calls fail in runs with a box, a period, caps or walls. Each run has steps that the other runs lack. */
static void test_regions(void** state)
{
  static const double iso = 0.3, half = 0.5;
  CORE_SET set = core_make_block(8, 0.1, 3, flat);
  sweep box = { .call = extract, .input = core_input(&set), .options = core_options(&iso) };
  sweep period = box, wall = box;
  const double sides[6] = { -9, 0.4, -9, 9, -9, 9 };
  box.options.outputs |= MCOR_OUT_POINT_KEYS | MCOR_OUT_TRIANGLE_KEYS;
  memcpy(box.options.box, sides, sizeof sides);
  sweep_room(*state, &box, 23, 100);
  period.options.periodic[0] = -4;
  period.options.periodic[1] = 4;
  period.options.seeds = MCOR_PAIRS;
  sweep_room(*state, &period, 23, 100);
  period.options.capping = 1;
  period.options.seeds = MCOR_COMPLETE;
  sweep_room(*state, &period, 23, 100);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.solid[i] = set.position[3 * i] > 1;
  }
  set.has_solids = 1;
  wall.input.solid = set.solid;
  wall.options.wall_share = 0.5;
  wall.options.field = MCOR_WEIGHT_SUM;
  wall.options.iso_values = &half;
  sweep_room(*state, &wall, 23, 100);
}

static void test_adaptive_cubes(void** state)
{
  static const double half = 0.5;
  CORE_SET set = core_make_block(5, 0.1, 3, flat);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] = set.position[3 * i] > 0 ? 2.7 : 1.3;
    set.volume[i] = set.position[3 * i] > 0 ? 4 : 1;
  }
  sweep s = { .call = extract, .input = core_input(&set), .options = core_options(&half) };
  s.options.field = MCOR_WEIGHT_SUM;
  s.options.level_limit = MCOR_CUBE_LEVELS - 1;
  sweep_room(*state, &s, 7, 150);
  s.options.field = MCOR_SHEPARD;
  s.options.periodic[0] = -8;
  s.options.periodic[1] = 8;
  sweep_room(*state, &s, 11, 100);
}

static void test_ranks(void** state)
{
  mcor_context* context = *state;
  static const double iso = 0.3;
  CORE_SET set = core_make_block(6, 0.3, 3, flat);
  sweep s = { .call = extract_as_rank, .input = core_input(&set), .options = core_options(&iso) };
  s.options.ranks = &alone;
  const double sides[6] = { -9, 9, -9, 9, -9, 9 };
  memcpy(s.options.box, sides, sizeof sides);
  sweep_room(context, &s, 23, 100);
  callbacks = 0;
  expect_right(context, &s);
  const int count = callbacks;
  CORE_CHECK(count > 5, count);
  for (int n = 0; n < count; ++n)
  {
    uint64_t hash;
    const mcor_input input = with_other_versions(&s, n);
    callbacks = 0;
    fail_callback = n;
    const mcor_status status = s.call(context, &s, &input, &hash);
    fail_callback = -1;
    CORE_CHECK(status == MCOR_CANCELLED && callbacks == n + 1, n, count, callbacks,
      mcor_status_name(status));
    expect_sound(context, &s, "Another rank");
  }
}

/* Extends a small buffer to a large one, which is also mapped, to get large pages. Each OpenCL call fails once. */
static void test_extend(void** state)
{
  mcor_context* context = *state;
  mcor_release_memory(context);
  const int64_t bytes = context->cl.bytes;
  int n = 0;
  for (;; ++n)
  {
    mcor_buffer buffer = { 0 };
    CORE_OK(context, mcor_fill(context, &buffer, 1, 1000));
    core_fail_call(n, CL_MEM_OBJECT_ALLOCATION_FAILURE);
    const mcor_status status = mcor_extend(context, &buffer, 1000, 2 * MCOR_LARGE_ARRAY);
    core_fail_nothing();
    assert_int_equal(status, core_failed_call()[0] ? MCOR_OUT_OF_CAPACITY : MCOR_OK);
    uint8_t last = 0;
    CORE_OK(context, mcor_read(context, &buffer, 999, &last, 1));
    assert_int_equal(last, 1);
    mcor_release(context, &buffer);
    core_expect_nothing_held(context, bytes, BUFFERS_KEPT);
    if (status == MCOR_OK)
    {
      break;
    }
  }
  assert_int_equal(n, 4); /* the calls are create, map, unmap and copy */
}

/* On a device with memory of its own, a copy to the host's locked memory fails. The locked memory must be released. */
static void test_read_fails(void** state)
{
  mcor_context* context = *state;
  mcor_release_memory(context);
  const int64_t bytes = context->cl.bytes;
  mcor_buffer buffer = { 0 };
  void* view = NULL;
  context->cl.is_apart = true;
  CORE_OK(context, mcor_fill(context, &buffer, 1, 1000));
  CORE_OK(context, mcor_map(context, &buffer, 1000, false, &view)); /* locks memory */
  CORE_OK(context, mcor_unmap(context, &buffer, &view));
  core_fail_call(0, CL_INVALID_COMMAND_QUEUE);
  const mcor_status status = mcor_map(context, &buffer, 1000, false, &view);
  core_fail_nothing();
  context->cl.is_apart = false;
  mcor_release(context, &buffer);
  CORE_CHECK(status == MCOR_DEVICE_ERROR && !view, mcor_status_name(status), core_failed_call());
  core_expect_nothing_held(context, bytes, BUFFERS_KEPT);
}

/* When a program does not build, the message says so and quotes the beginning of the build log, however long the log
 * is. */
static void test_build_fails(void** state)
{
  mcor_context* context = *state;
  const mcor_build build = { .sph_kernel = MCOR_WENDLAND_C2 };
  char log[20000];
  memset(log, '.', sizeof log - 1);
  memcpy(log, "line 7: no such thing", 21);
  log[sizeof log - 1] = '\0';
  core_set_build_log(log);
  core_fail_call(0, CL_BUILD_PROGRAM_FAILURE);
  CORE_OK(context, mcor_choose_build(context, &build));
  const mcor_status status = MCOR_LAUNCH(context, "mcor_seed_regions", MCOR_HEAVY, 1, MCOR_INT(0));
  core_fail_nothing();
  assert_int_equal(status, MCOR_DEVICE_ERROR);
  assert_non_null(strstr(mcor_last_error(context), "CL_BUILD_PROGRAM_FAILURE"));
  assert_non_null(strstr(mcor_last_error(context), "mcor_w_wendland"));
  assert_non_null(strstr(mcor_last_error(context), "line 7: no such thing"));
}

static void test_error_names(void** state)
{
  mcor_context* context = *state;
  mcor_buffer buffer = { 0 };
  static const struct
  {
    cl_int code;
    const char* name;
  } names[] = { { -12, "CL_MAP_FAILURE" }, { -15, "CL_COMPILE_PROGRAM_FAILURE" },
    { -17, "CL_LINK_PROGRAM_FAILURE" }, { -45, "CL_INVALID_PROGRAM_EXECUTABLE" },
    { -68, "CL_INVALID_DEVICE_PARTITION_COUNT" }, { -1001, "CL_PLATFORM_NOT_FOUND_KHR" } };
  for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
  {
    CORE_OK(context, mcor_reserve(context, &buffer, 1));
    core_fail_call(0, names[i].code);
    assert_int_equal(mcor_fill(context, &buffer, 0, 1), MCOR_DEVICE_ERROR);
    core_fail_nothing();
    CORE_CHECK(strstr(mcor_last_error(context), names[i].name), mcor_last_error(context));
  }
  /* OpenCL 1.2 has the codes -1 to -19 and -30 to -68. */
  for (cl_int code = -68; code < 0; ++code)
  {
    core_fail_call(0, code);
    mcor_fill(context, &buffer, 0, 1);
    core_fail_nothing();
    CORE_CHECK((code < -19 && code > -30) || strstr(mcor_last_error(context), "with CL_"), code,
      mcor_last_error(context));
  }
  mcor_release(context, &buffer);
}

/* When a context cannot be made, its message says why, and a run on it fails. */
static void test_no_context(void** state)
{
  static const double iso = 0;
  CORE_SET set = core_make_block(4, 0, 1, core_slope);
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  for (int n = 0, done = 0; !done; ++n)
  {
    CORE_CONTEXT context = NULL;
    core_fail_call(n, CL_OUT_OF_RESOURCES);
    const mcor_status status = mcor_create_context(NULL, &context);
    core_fail_nothing();
    done = !core_failed_call()[0];
    CORE_CHECK(done == (status == MCOR_OK), n, mcor_status_name(status));
    CORE_CHECK(!done || n >= 2, n);
    if (!done)
    {
      mcor_surface surface = { .point_count = 7 };
      mcor_release_memory(context);
      assert_int_equal(mcor_extract(context, &input, &options, &surface), MCOR_DEVICE_ERROR);
      CORE_CHECK(strstr(mcor_last_error(context), "CL_OUT_OF_RESOURCES"), core_failed_call(),
        mcor_last_error(context));
      assert_int_equal(surface.point_count, 0);
    }
  }
}

/* Lets a call fail because a second device, which it needs, does not start. Writing a profile (MCOR_PROFILE) must do no
 * harm. */
static void test_profile_without_device(void** state)
{
  const char* path = "core_fault_profile.csv";
  static const double iso = 2;
  (void)state;
  CORE_SET set = core_make_block(4, 0, 1, core_slope);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.precision = MCOR_FLOAT64;
  options.sph_kernel = MCOR_QUARTIC_SPLINE;
  const char* device = getenv("MCOR_DEVICE");
  char* named = core_copy(device ? device : "", device ? strlen(device) + 1 : 1);
  unsetenv("MCOR_DEVICE");
  setenv("MCOR_PROFILE", path, 1);
  CORE_CONTEXT context = NULL;
  CORE_SURFACE surface;
  CORE_OK(context, mcor_create_context(NULL, &context));
  core_fail_command(0, CL_DEVICE_NOT_AVAILABLE);
  const mcor_status status = mcor_extract(context, &input, &options, &surface);
  core_fail_nothing();
  /* If the built-in device lacks kernels, a second device is needed, and its clCreateContext fails. Else another call
   * fails. */
  const bool is_replaced = strcmp(core_failed_call(), "clCreateContext") == 0;
  CORE_CHECK(!is_replaced || (status == MCOR_DEVICE_ERROR && core_told(context, "clCreateContext")),
    mcor_status_name(status), mcor_last_error(context));
  unsetenv("MCOR_PROFILE");
  setenv("MCOR_DEVICE", named, 1);
  free(named);
  remove(path);
}

CORE_MAIN(core_set_up, core_tear_down, test_no_context, test_profile_without_device,
  test_every_call_fails_once, test_probe_and_derive, test_regions, test_filled, test_adaptive_cubes,
  test_ranks, test_extend, test_read_fails, test_build_fails, test_error_names)
