/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests a context over several calls: reuse, order of the input, devices, statistics. */

#include "core_parts.h"

#include <ctype.h>
#include <signal.h>
#include <sys/resource.h>

/* Several iso values in one call give the same surfaces as calls for single values. */
static void test_several_iso_values(void** state)
{
  CORE_SET set = core_make_block(9, 0.3, 3, core_ball);
  const double iso[3] = { 5, 0, 2.5 };
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(iso);
  core_ask_for_all(&options);
  options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
  options.iso_count = 3;
  CORE_SURFACE all = core_extract(*state, &input, &options);
  int64_t point = 0, triangle = 0;
  options.iso_count = 1;
  for (int i = 0; i < 3; ++i)
  {
    options.iso_values = iso + i;
    CORE_SURFACE one = core_extract(*state, &input, &options);
    assert_true(point + one.point_count <= all.point_count &&
      triangle + one.triangle_count <= all.triangle_count);
    assert_memory_equal(
      all.points + 3 * point, one.points, (size_t)one.point_count * 3 * sizeof(double));
    assert_memory_equal(
      all.normals + 3 * point, one.normals, (size_t)one.point_count * 3 * sizeof(float));
    for (int64_t t = 0; t < 3 * one.triangle_count; ++t)
    {
      assert_int_equal(all.triangles[3 * triangle + t], one.triangles[t] + point);
    }
    for (int64_t p = 0; p < one.point_count; ++p)
    {
      CORE_CHECK(all.iso_value[point + p] == iso[i], all.iso_value[point + p]);
    }
    point += one.point_count;
    triangle += one.triangle_count;
  }
  assert_int_equal(point, all.point_count);
  assert_int_equal(triangle, all.triangle_count);
}

typedef struct permuted_case
{
  const char* name;
  mcor_field field;
  mcor_type precision;
  mcor_seed_mode seeds;
  /* Where volumes come from: 0 an array, 1 mass / density, 2 mass alone, 3 the positions. */
  int volumes;
  int solids, coincident, estimate, topology, levels;
  mcor_boundary_detection boundary;
  double wall_share;
} permuted_case;

static const permuted_case permuted_cases[] = { { .name = "volume array" },
  { .name = "pairs", .seeds = MCOR_PAIRS }, { .name = "mass and density", .volumes = 1 },
  { .name = "mass", .volumes = 2 },
  { .name = "mass, double", .volumes = 2, .precision = MCOR_FLOAT64 },
  { .name = "no volume", .volumes = 3 }, { .name = "sum", .field = MCOR_SUM },
  { .name = "free surface", .field = MCOR_WEIGHT_SUM }, { .name = "solids", .solids = 1 },
  { .name = "coincident", .coincident = 1 },
  { .name = "coincident, no volume", .volumes = 3, .coincident = 1 },
  { .name = "coincident fluid and solid", .solids = 1, .coincident = 1 },
  { .name = "estimated smoothing length", .estimate = 1 },
  { .name = "free surface at solids", .field = MCOR_WEIGHT_SUM, .solids = 1, .wall_share = 0.3 },
  { .name = "topology by the field", .topology = 1 }, { .name = "adaptive", .levels = 1 },
  { .name = "eigenvalue", .solids = 1, .boundary = MCOR_BOUNDARY_EIGENVALUE },
  { .name = "eigenvalue, coincident, double",
    .coincident = 1,
    .precision = MCOR_FLOAT64,
    .boundary = MCOR_BOUNDARY_EIGENVALUE } };

static particle_set make_permuted_set(const permuted_case* at)
{
  particle_set set = core_make_block(9, 0.35, 11, core_ball);
  uint64_t seed = 17;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] *= 1 + (at->levels ? 3 : 0.7) * random_unit(&seed);
    set.scalar[i] += at->topology ? 9 * random_unit(&seed) : 0;
    set.volume[i] *= 1 + 0.3 * random_unit(&seed);
    set.solid[i] = random_bits(&seed) % 7 == 0;
    const int64_t twin = i - 1 - (int64_t)(random_bits(&seed) % 40);
    if (at->coincident && twin >= 0 && i % 3 == 0)
    {
      memcpy(set.position + 3 * i, set.position + 3 * twin, 3 * sizeof(double));
      set.smoothing_length[i] = set.smoothing_length[twin];
      set.volume[i] = set.volume[twin];
    }
  }
  set.has_solids = at->solids;
  return set;
}

static uint64_t permuted_hash(
  mcor_context* context, const permuted_case* at, const particle_set* set)
{
  const double inside = at->boundary == MCOR_BOUNDARY_EIGENVALUE || at->levels ? -10 : 1;
  const double iso = at->field == MCOR_WEIGHT_SUM ? 0.5 : inside;
  const mcor_array none = { 0 };
  mcor_input input = core_input(set);
  input.mass = at->volumes == 1 || at->volumes == 2 ? input.volume : none;
  input.density = at->volumes == 1 ? input.smoothing_length : none;
  input.volume = at->volumes == 0 ? input.volume : none;
  input.estimate_smoothing_length = at->estimate;
  mcor_options options = core_options(&iso);
  core_ask_for_all(&options);
  options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
  options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE;
  options.field = at->field;
  options.precision = at->precision;
  options.seeds = at->seeds;
  options.boundary_detection = at->boundary;
  options.wall_share = at->wall_share;
  options.topology = at->topology ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
  options.level_limit = at->levels ? MCOR_CUBE_LEVELS - 1 : 0;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  assert_true(surface.triangle_count > 0);
  assert_true(at->boundary == MCOR_BOUNDARY_WEIGHT_SUM ||
    surface.statistics.trim_vertices > surface.statistics.trim_vertices_linear);
  return core_hash(&surface);
}

/* Five other orders of the particles give the same bits. */
static void test_order_of_input(void** state)
{
  for (size_t c = 0; c < sizeof permuted_cases / sizeof permuted_cases[0]; ++c)
  {
    const permuted_case* at = permuted_cases + c;
    CORE_SET set = make_permuted_set(at);
    const uint64_t expected = permuted_hash(*state, at, &set);
    for (uint64_t seed = 1; seed <= 5; ++seed)
    {
      CORE_FREED int64_t* order = core_make_order(set.count, seed);
      CORE_SET permuted = core_permute(&set, order);
      CORE_CHECK(permuted_hash(*state, at, &permuted) == expected, at->name, seed);
    }
  }
}

/* With a memory limit below the peak, a call fails with a message. A limit at the peak suffices, even if the context
 * keeps buffers from other particles. */
static void test_memory_limit(void** state)
{
  mcor_context* context = *state;
  CORE_SET big = core_make_block(16, 0.2, 3, core_slope);
  CORE_SET set = core_make_block(8, 0.2, 3, core_slope);
  const double iso = 0;
  mcor_input input = core_input(&set), big_input = core_input(&big);
  mcor_options options = core_options(&iso);
  mcor_release_memory(context);
  mcor_surface surface = core_extract(context, &input, &options);
  const uint64_t expected = core_hash(&surface);
  const int64_t peak = surface.statistics.device_bytes_peak;
  mcor_free_surface(&surface);
  options.memory_limit = peak / 2;
  mcor_release_memory(context);
  assert_int_equal(mcor_extract(context, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  assert_null(surface.points);
  assert_true(core_told(context, "DEVICE_MEMORY_LIMIT"));
  mcor_options unlimited = core_options(&iso);
  big_input.particles_version = big_input.scalar_version = 7; /* kept */
  surface = core_extract(context, &big_input, &unlimited);
  assert_true(surface.statistics.device_bytes_peak > peak);
  mcor_free_surface(&surface);
  options.memory_limit = peak;
  assert_true(core_hash_of(context, &input, &options) == expected);
}

/* A large buffer that was released is used for the next request of about its size. Other kept buffers are freed if the
 * context would otherwise hold more than this call or the last call needs. A memory limit always holds. */
static void test_kept_buffers(void** state)
{
  mcor_context* context = *state;
  mcor_cl* cl = &context->cl;
  const size_t size = 3 * MCOR_LARGE_ARRAY;
  mcor_buffer a = { 0 }, b = { 0 }, small = { 0 };
  cl->memory_limit = cl->device_memory;
  mcor_release_memory(context);
  mcor_begin_buffers(context);
  mcor_begin_buffers(context);
  const int64_t tables = cl->bytes;
  CORE_OK(context, mcor_reserve(context, &a, size));
  CORE_OK(context, mcor_reserve(context, &small, size / 4));
  const cl_mem first = a.mem;
  mcor_release(context, &a);
  mcor_release(context, &small);
  assert_true(!a.mem && cl->bytes > tables);
  CORE_OK(context, mcor_reserve(context, &small, size / 4));
  assert_true(small.mem != first);
  CORE_OK(context, mcor_reserve(context, &b, size / 10 * 9));
  assert_true(b.mem == first && b.size >= size);
  CORE_OK(context, mcor_reserve(context, &a, size));
  assert_true(a.mem && a.mem != b.mem);
  mcor_release(context, &a);
  mcor_release(context, &b);
  mcor_release(context, &small);
  const int64_t held = cl->bytes;
  mcor_begin_buffers(context);
  assert_int_equal(cl->bytes, held);
  CORE_OK(context, mcor_reserve(context, &a, 2 * size));
  CORE_CHECK(cl->bytes <= held / 8 * 9, cl->bytes, held);
  mcor_release(context, &a);
  mcor_begin_buffers(context); /* a call that needs nothing */
  mcor_begin_buffers(context);
  assert_int_equal(cl->bytes, tables);
  CORE_OK(context, mcor_reserve(context, &a, size));
  mcor_release(context, &a);
  cl->memory_limit = (uint64_t)tables + size;
  CORE_OK(context, mcor_reserve(context, &small, size / 4));
  assert_int_equal(cl->bytes, tables + (int64_t)small.size);
  mcor_release(context, &small);
  mcor_release_memory(context);
  assert_int_equal(cl->bytes, tables);
}

static void test_devices(void** state)
{
  char* list = NULL;
  assert_int_equal(mcor_list_devices(&list), MCOR_OK);
  CORE_CHECK(strncmp(list, "0: ", 3) == 0, list);
  free(list);
  const char* const unknown[] = { "no such device", "99999", "-1", "1e9" };
  for (int i = 0; i < 4; ++i)
  {
    CORE_CONTEXT context = NULL;
    assert_int_equal(mcor_create_context(unknown[i], &context), MCOR_DEVICE_ERROR);
    assert_non_null(context);
    assert_non_null(strstr(mcor_last_error(context), unknown[i]));
    const mcor_input input = { 0 };
    const mcor_options options = core_options(NULL);
    mcor_surface surface = { 0 };
    assert_int_equal(mcor_extract(context, &input, &options, &surface), MCOR_DEVICE_ERROR);
  }
  /* A device may be named by a part of its name, in capitals or small letters. */
  const mcor_context* context_of_default = *state;
  char upper[128], lower[128];
  size_t n = 0;
  for (; context_of_default->cl.device_name[n]; ++n)
  {
    upper[n] = (char)toupper((unsigned char)context_of_default->cl.device_name[n]);
    lower[n] = (char)tolower((unsigned char)context_of_default->cl.device_name[n]);
  }
  upper[n] = lower[n] = '\0';
  const char* const known[] = { "", "0", NULL, upper, lower + 1 };
  for (int i = 0; i < 5; ++i)
  {
    CORE_CONTEXT context = NULL;
    CORE_OK(context, mcor_create_context(known[i], &context));
  }
}

static void test_names(void** state)
{
  for (int s = 0; s <= MCOR_CANCELLED; ++s)
  {
    CORE_CHECK(!strstr(mcor_status_name((mcor_status)s), "unknown"), s);
  }
  assert_string_equal(mcor_status_name((mcor_status)99), "unknown status");
  assert_string_equal(mcor_status_name((mcor_status)-1), "unknown status");
  assert_string_equal(mcor_phase_name((mcor_phase)99), "unknown phase");
  assert_string_equal(mcor_phase_name(MCOR_PHASE_TRIMMING), "trimming");
}

/* Checks statistics that are known beforehand, and relations between them. */
static void test_statistics(void** state)
{
  CORE_SET set = core_make_block(10, 0, 3, core_ball);
  set.has_solids = 1;
  memset(set.solid, 1, 100); /* the lowest layer */
  const double iso = 0;
  const mcor_input input = core_input(&set);
  const mcor_options options = core_options(&iso);
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  const mcor_statistics* s = &surface.statistics;
  assert_int_equal(s->fluid_particles, 900);
  assert_int_equal(s->solid_particles, 100);
  CORE_CHECK(fabs(s->cube_size - 0.65) < 1e-12, s->cube_size);
  assert_true(s->smoothing_length_min == 1.3 && s->smoothing_length_max == 1.3);
  assert_true(s->virtual_cells == s->lattice_cells[0] * s->lattice_cells[1] * s->lattice_cells[2]);
  const int64_t hits = s->seed_cells - s->seed_cells_not_intersected;
  CORE_CHECK(hits > 0 && hits <= s->cells_used && s->cells_used <= s->seed_cells, s->cells_used,
    s->seed_cells);
  assert_true(s->triangles_before_trimming >= s->cells_used);
  CORE_CHECK(s->correction_max >= s->correction_mean && s->correction_mean > 0 &&
      s->correction_max <= s->cube_size,
    s->correction_mean, s->correction_max);
  CORE_CHECK(
    s->iterations_max >= 1 && s->iterations_mean > 0 && s->iterations_mean <= s->iterations_max,
    s->iterations_mean, s->iterations_max);
  CORE_CHECK(s->vertices_above_tolerance == 0, s->vertices_above_tolerance, s->residual_max);
  assert_true(s->device[0] && s->platform[0]);
}

/* cl.lanes, the width of vectors in kernels, follows from the registers that the device's compiler uses, not from the
 * width that the device reports. */
static void test_lanes(void** state)
{
  mcor_context* context = *state;
  if (!context->cl.is_cpu || getenv("MCOR_LANES") ||
    strcmp(context->cl.platform_name, "built in") == 0)
  {
    skip();
  }
  core_build(context, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT32);
  const char* source = "#ifndef __AVX512F__\n#error none\n#endif\n__kernel void k(void) {}\n";
  cl_int error;
  cl_program program = clCreateProgramWithSource(context->cl.context, 1, &source, NULL, &error);
  assert_int_equal(error, CL_SUCCESS);
  const bool wide = clBuildProgram(program, 1, &context->cl.device, "", NULL, NULL) == CL_SUCCESS;
  clReleaseProgram(program);
  assert_int_equal(context->cl.lanes, wide ? 16 : 8);
  core_build(context, MCOR_CUBIC_SPLINE, MCOR_SHEPARD, MCOR_FLOAT64);
  assert_int_equal(context->cl.lanes, 8);
}

static int on_building(void* user, double fraction, const char* phase)
{
  int* calls = user;
  (void)fraction;
  *calls += strstr(phase, "building the OpenCL program") != NULL;
  return 0;
}

/* If a driver builds programs for a context's first run with an SPH kernel, a progress message says so; a later run
 * builds nothing. The built-in device's programs are built ahead, so there is no message. */
static void test_build(void** state)
{
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  CORE_SET set = core_make_block(8, 0.2, 3, core_slope);
  const double iso = 0;
  mcor_options options = core_options(&iso);
  int told = 0;
  options.progress = on_building;
  options.progress_user = &told;
  const mcor_input input = core_input(&set);
  for (int run = 0; run < 3; ++run)
  {
    options.sph_kernel = run == 2 ? MCOR_QUADRATIC : MCOR_CUBIC_SPLINE;
    told = 0;
    CORE_SURFACE surface = core_extract(context, &input, &options);
    const bool tells = run != 1 && strcmp(context->cl.platform_name, "built in") != 0;
    CORE_CHECK((surface.statistics.build_seconds > 0) == (run != 1) && (told > 0) == tells, run,
      surface.statistics.build_seconds, told);
  }
}

/* What a profile says of one call. */
typedef struct profiled
{
  double phases[MCOR_PHASE_COUNT], commands[MCOR_PHASE_COUNT]; /* seconds */
  int64_t bytes, corrections, gathers;
  double correction_seconds;
} profiled;

static void read_profile(const char* path, int64_t wanted, profiled* found)
{
  char line[256];
  FILE* file = fopen(path, "r");
  assert_non_null(file);
  *found = (profiled){ .bytes = 0 };
  assert_non_null(fgets(line, sizeof line, file));
  assert_string_equal(line, "call,phase,command,kernel,count,bytes,host_seconds,device_seconds\n");
  while (fgets(line, sizeof line, file))
  {
    long long call, count, bytes;
    char phase[32], command[16], kernel[64];
    double host, device;
    int number = 0;
    int length = 0;
    assert_int_equal(sscanf(line, "%lld,%31[^,],%15[^,],%n", &call, phase, command, &length), 3);
    const size_t name = strcspn(line + length, ","); /* which may be empty */
    snprintf(kernel, sizeof kernel, "%.*s", (int)name, line + length);
    assert_int_equal(
      sscanf(line + length + name, ",%lld,%lld,%lf,%lf", &count, &bytes, &host, &device), 4);
    while (strcmp(phase, mcor_phase_name((mcor_phase)number)) != 0)
    {
      ++number;
    }
    if (call != wanted)
    {
      continue;
    }
    const bool is_phase = strcmp(command, "phase") == 0;
    found->phases[number] += is_phase ? host : 0;
    found->commands[number] += is_phase || strcmp(command, "build") == 0 ? 0 : host;
    found->bytes += bytes;
    found->gathers += strcmp(kernel, "mcor_grid_gather_value") == 0 ? count : 0;
    if (strcmp(kernel, "mcor_correct_vertices") == 0 && strcmp(command, "launch") == 0)
    {
      found->corrections += count;
      found->correction_seconds += device;
    }
  }
  fclose(file);
}

/* A profile has the seconds of each phase and of the phase's commands on the device. The surface stays the same. If
 * all volumes are the same, they are not sorted. */
static void test_profile(void** state)
{
  const char* path = "core_context_profile.csv";
  CORE_SET set = core_make_block(9, 0.3, 3, core_ball);
  const double iso = 2.5;
  const mcor_input input = core_input(&set);
  const mcor_options options = core_options(&iso);
  CORE_SURFACE usual = core_extract(*state, &input, &options);
  const uint64_t expected = core_hash(&usual);
  assert_true(usual.triangle_count > 100);
  CORE_CONTEXT context = NULL;
  remove(path);
  core_create_with(&context, "MCOR_PROFILE", path);
  for (int call = 0; call < 3; ++call)
  {
    set.volume[1] = call < 2 ? 1 : 0.9; /* a corner, where no surface is */
    CORE_SURFACE surface = core_extract(context, &input, &options);
    assert_true(core_hash(&surface) == expected);
    profiled found;
    read_profile(path, call, &found);
    assert_true(found.gathers == (call < 2 ? 3 : 4) || call == 0); /* y, z, the scalar */
    for (int p = 0; p < MCOR_PHASE_COUNT; ++p)
    {
      CORE_CHECK(fabs(found.phases[p] - surface.statistics.seconds[p]) < 1e-8, "phase %d: %g s", p,
        found.phases[p]);
      /* The seconds of a phase leave out the building of programs, so a launch may take longer than its phase. */
      CORE_CHECK(found.commands[p] > 0 &&
          found.commands[p] < found.phases[p] + surface.statistics.build_seconds + 0.01,
        "phase %d: %g s of commands in %g s", p, found.commands[p], found.phases[p]);
    }
    assert_true(found.bytes > 12 * input.count);
    CORE_CHECK(found.corrections > 0 && found.correction_seconds > 0, "%lld corrections, %g s",
      (long long)found.corrections, found.correction_seconds);
  }
  CORE_CONTEXT again = NULL;
  setenv("MCOR_PROFILE", path, 1);
  CORE_OK(again, mcor_create_context(NULL, &again)); /* appends to the table */
  remove(path);
  FILE* other = fopen(path, "w");
  assert_non_null(other);
  fputs("x,y,z\n1,2,3\n", other);
  fclose(other);
  CORE_CONTEXT refused = NULL;
  assert_int_equal(mcor_create_context(NULL, &refused), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(refused, "PROFILE_FILE|core_context_profile.csv|it holds something else"));
  remove(path);
  /* A call fails if its row of the profile does not fit on the disk. */
  CORE_CONTEXT full = NULL;
  CORE_OK(full, mcor_create_context(NULL, &full));
  /* Drivers also write files when they build programs, so this run builds them before the limit holds. */
  CORE_SURFACE built = core_extract(full, &input, &options);
  struct rlimit limit, small = { .rlim_cur = 200 };
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
  small.rlim_max = limit.rlim_max;
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  mcor_surface lost;
  const mcor_status not_written = mcor_extract(full, &input, &options, &lost);
  const bool told = core_told(full, "PROFILE_FILE|core_context_profile.csv") && lost.point_count == 0;
  mcor_options tiny = options; /* a call that fails anyway tells its own reason */
  tiny.memory_limit = 1000;
  const mcor_status failed = mcor_extract(full, &input, &tiny, &lost);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
  assert_int_equal(not_written, MCOR_INVALID_ARGUMENT);
  assert_true(told);
  assert_int_equal(failed, MCOR_OUT_OF_CAPACITY);
  assert_true(core_told(full, "DEVICE_MEMORY_LIMIT"));
  CORE_SURFACE kept = core_extract(full, &input, &options);
  assert_true(core_hash(&kept) == expected);
  remove(path);
  setenv("MCOR_PROFILE", "/dev/full", 1);
  CORE_CONTEXT no_space = NULL;
  assert_int_equal(mcor_create_context(NULL, &no_space), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(no_space, "PROFILE_FILE|/dev/full|No space left"));
  setenv("MCOR_PROFILE", "/nonexistent/profile.csv", 1);
  CORE_CONTEXT none = NULL;
  const mcor_status status = mcor_create_context(NULL, &none);
  unsetenv("MCOR_PROFILE");
  assert_int_equal(status, MCOR_INVALID_ARGUMENT);
  assert_true(core_told(none, "PROFILE_FILE|/nonexistent/profile.csv"));
}

CORE_MAIN(core_set_up, core_tear_down, test_several_iso_values, test_order_of_input,
  test_memory_limit, test_kept_buffers, test_devices, test_names, test_lanes, test_build,
  test_statistics, test_profile)
