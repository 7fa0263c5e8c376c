/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core_fixture.h"

bool core_tells(const mcor_message* message, const char* words)
{
  char list[200];
  bool tells = message->text != NULL;
  snprintf(list, sizeof list, "%s", words);
  for (char* word = strtok(list, "|"); tells && word; word = strtok(NULL, "|"))
  {
    tells = strcmp(word, mcor_says_name(message->code)) == 0 || strstr(message->text, word);
  }
  return tells;
}

bool core_told(const mcor_context* context, const char* words)
{
  CORE_MESSAGE message = mcor_last_message(context);
  return core_tells(&message, words);
}

void core_free_context(mcor_context** context)
{
  mcor_free_context(*context);
}

void core_free_block(void* pointer)
{
  void* block;
  memcpy(&block, pointer, sizeof block);
  free(block);
}

int core_set_up(void** state)
{
  mcor_context* context = NULL;
  if (mcor_create_context(NULL, &context) != MCOR_OK)
  {
    print_error("%s\n", mcor_last_error(context));
    mcor_free_context(context);
    return -1;
  }
  *state = context;
  return 0;
}

int core_tear_down(void** state)
{
  mcor_free_context(*state);
  return 0;
}

void core_create_with(mcor_context** context, const char* variable, const char* value)
{
  const char* kept = getenv(variable);
  char* last = kept ? core_copy(kept, strlen(kept) + 1) : NULL;
  setenv(variable, value, 1);
  const mcor_status status = mcor_create_context(NULL, context);
  (*context)->pool.threads = mcor_limit_threads(mcor_processors(1)); /* else the first loop reads MCOR_THREADS */
  if (last)
  {
    setenv(variable, last, 1);
  }
  else
  {
    unsetenv(variable);
  }
  free(last);
  CORE_OK(*context, status);
}

void* core_copy(const void* data, size_t bytes)
{
  void* copy = malloc(bytes);
  assert_true(copy || bytes == 0);
  if (bytes > 0)
  {
    memcpy(copy, data, bytes);
  }
  return copy;
}

double core_ball(const double x[3])
{
  return 9 - x[0] * x[0] - x[1] * x[1] - x[2] * x[2];
}

double core_slope(const double x[3])
{
  return 0.7 * x[0] - 0.4 * x[1] + 0.5 * x[2] + 0.1;
}

particle_set core_make_block(
  int n, double jitter, uint64_t seed, double (*value)(const double x[3]))
{
  particle_set set = particle_set_make((int64_t)n * n * n);
  for (int i = 0; i < n * n * n; ++i)
  {
    double* x = set.position + 3 * i;
    const int at[3] = { i % n, i / n % n, i / n / n };
    for (int a = 0; a < 3; ++a)
    {
      x[a] = at[a] - 0.5 * (n - 1) + jitter * (2 * random_unit(&seed) - 1);
    }
    set.smoothing_length[i] = 1.3;
    set.volume[i] = 1;
    set.scalar[i] = value(x);
  }
  return set;
}

particle_set core_make_splash(int n, double jitter, uint64_t seed)
{
  const int block = n * n * n, side = 2 * n, sheet = block + side * side, thread = sheet + side;
  particle_set set = particle_set_make(thread + 4);
  for (int i = 0; i < set.count; ++i)
  {
    const int s = i - block;
    const double in_block[3] = { i % n, i / n % n, i / (n * n) },
                 in_sheet[3] = { s % side, s / side, n + 6 }, in_thread[3] = { i - sheet, -8, 0 },
                 drop[3] = { 8 * (i - thread), -20, 0 };
    const double* at = i < block ? in_block : i < sheet ? in_sheet : i < thread ? in_thread : drop;
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = at[a] + jitter * (random_unit(&seed) - 0.5);
    }
    set.volume[i] = 1;
    set.scalar[i] = core_slope(set.position + 3 * i) + random_unit(&seed);
  }
  return set;
}

particle_set core_make_graded(double ratio, double step)
{
  particle_set set = particle_set_make(60000);
  uint64_t seed = 5;
  int64_t n = 0;
  for (double r = 1; r < ratio; r *= 1 + 0.9 * step)
  {
    const int of_shell = (int)(4 * M_PI / (step * step));
    for (int i = 0; i < of_shell; ++i)
    {
      const double z = 1 - (2 * i + 1.0) / of_shell, s = sqrt(1 - z * z), w = 2.399963 * i;
      const double p[3] = { r * (s * cos(w) + 0.05 * step * random_unit(&seed)), r * s * sin(w),
        r * z };
      if (p[0] < 0.4 * r)
      {
        assert_true(n < set.count);
        memcpy(set.position + 3 * n, p, sizeof p);
        set.smoothing_length[n] = 1.2 * step * r;
        set.volume[n] = pow(step * r, 3);
        set.scalar[n++] = z + 0.2 * p[1] / r;
      }
    }
  }
  set.count = n;
  return set;
}

particle_set core_make_random(int64_t count, double size, double h_min, double h_max, uint64_t seed)
{
  particle_set set = particle_set_make(count);
  for (int64_t i = 0; i < count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = size * (random_unit(&seed) - 0.5);
    }
    const double h = h_min * pow(h_max / h_min, random_unit(&seed));
    set.smoothing_length[i] = h;
    set.volume[i] = (0.2 + random_unit(&seed)) * h * h * h;
    set.scalar[i] = 2 * random_unit(&seed) - 1;
  }
  return set;
}

mcor_input core_input_with(const particle_set* set, const mcor_array* attributes, int count)
{
  mcor_input input = core_input(set);
  input.attributes = attributes;
  input.attribute_count = count;
  return input;
}

mcor_input core_input_to_keep(const particle_set* set)
{
  static uint64_t version = 0;
  mcor_input input = core_input(set);
  input.particles_version = input.scalar_version = ++version;
  return input;
}

mcor_options core_options(const double* iso)
{
  mcor_options options;
  mcor_set_default_options(&options);
  options.wall_share = 0;  /* surfaces do not end at solids, unless a test asks for it */
  options.level_limit = 0; /* cubes have one size, unless a test asks for levels */
  options.iso_values = iso;
  options.iso_count = iso != NULL;
  return options;
}

int64_t* core_make_order(int64_t count, uint64_t seed)
{
  int64_t* order = oracle_allocate(count, sizeof *order);
  for (int64_t i = 0; i < count; ++i)
  {
    const int64_t j = (int64_t)(random_bits(&seed) % (uint64_t)(i + 1));
    order[i] = order[j];
    order[j] = i;
  }
  return order;
}

particle_set core_permute(const particle_set* set, const int64_t* order)
{
  particle_set result = particle_set_make(set->count);
  result.has_solids = set->has_solids;
  result.count = 0;
  for (int64_t i = 0; i < set->count; ++i)
  {
    particle_set_append(&result, set, order[i]);
  }
  return result;
}

mcor_status core_extract_widened(mcor_context* context, const mcor_input* input,
  const mcor_options* options, mcor_surface* surface)
{
  mcor_input own = *input;
  mcor_widening widening = { 0 };
  mcor_status status = MCOR_OK;
  if (options->widen != 1)
  {
    status = mcor_widen(context, input, options, &widening);
    own.widening = core_array(widening.factor, 1);
    own.volume = widening.volume ? core_array(widening.volume, 1) : own.volume;
  }
  MCOR_THEN(status, mcor_extract(context, &own, options, surface));
  mcor_add_widening(&surface->statistics, &widening.statistics);
  mcor_free_widening(&widening);
  return status;
}

mcor_surface core_extract(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  mcor_surface surface = { 0 };
  CORE_OK(context, core_extract_widened(context, input, options, &surface));
  return surface;
}

uint64_t core_hash_of(mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  CORE_SURFACE surface = core_extract(context, input, options);
  assert_true(surface.triangle_count > 0);
  return core_hash(&surface);
}

static mesh_report check_mesh(const mcor_surface* surface, bool may_coincide)
{
  mesh_report report;
  mesh_check(
    surface->points, surface->point_count, surface->triangles, surface->triangle_count, &report);
  for (int fault = 0; fault < MESH_FAULT_COUNT; ++fault)
  {
    CORE_CHECK((may_coincide && fault == MESH_COINCIDENT_POINT) || report.faults[fault] == 0,
      report.faults[fault], mesh_fault_name(fault), report.first[fault]);
  }
  return report;
}

mesh_report core_check_mesh(const mcor_surface* surface)
{
  return check_mesh(surface, false);
}

mesh_report core_check_pinched_mesh(const mcor_surface* surface)
{
  return check_mesh(surface, true);
}

void core_check_flags(const mcor_surface* surface)
{
  CORE_REPORT report = core_check_mesh(surface);
  CORE_FREED uint8_t* on_boundary = oracle_allocate(surface->point_count + 1, 1);
  for (int64_t s = 0; s < report.side_count; ++s)
  {
    const mesh_edge* e = report.side + s;
    if (e->sharing == 1)
    {
      on_boundary[e->a] = on_boundary[e->b] = 1;
    }
  }
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    CORE_CHECK((surface->boundary_flag[i] != 0) == on_boundary[i], i, surface->boundary_flag[i],
      on_boundary[i]);
  }
}

uint64_t core_hash_bytes(uint64_t hash, const void* data, size_t bytes)
{
  for (size_t i = 0; data && i < bytes; ++i)
  {
    hash = (hash ^ ((const unsigned char*)data)[i]) * 0x100000001B3u;
  }
  return hash;
}

uint64_t core_hash(const mcor_surface* surface)
{
  mcor_surface s = *surface;
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS];
  const size_t n = (size_t)s.point_count;
  uint64_t hash = core_hash_bytes(CORE_HASH_OF_NOTHING, &s.point_count, sizeof s.point_count);
  hash = core_hash_bytes(hash, s.triangles, (size_t)s.triangle_count * 3 * sizeof(int32_t));
  hash = core_hash_bytes(hash, s.line_points, (size_t)s.line_point_count * sizeof(int32_t));
  mcor_list_surface_arrays(&s, arrays);
  for (int a = 0; a < MCOR_SURFACE_ARRAYS; ++a)
  {
    hash = core_hash_bytes(hash, *arrays[a].array, n * arrays[a].width);
  }
  hash = core_hash_bytes(hash, &s.attribute_count, sizeof s.attribute_count);
  for (int a = 0; a < s.attribute_count; ++a)
  {
    /* An attribute has at least n numbers. Only its first n are hashed, however many components it
     * has. */
    hash = core_hash_bytes(hash, s.attributes[a], n * sizeof(double));
  }
  return hash;
}

void core_build(
  mcor_context* context, mcor_sph_kernel kernel, mcor_field field, mcor_type precision)
{
  mcor_build build;
  memset(&build, 0, sizeof build);
  build.sph_kernel = kernel;
  build.field = field;
  build.precision = precision;
  CORE_OK(context, mcor_choose_build(context, &build));
}

void core_extend_program(mcor_context* context, const char* source)
{
  mcor_cl* cl = &context->cl;
  const char* sources[MCOR_SOURCE_LIMIT + 1];
  if (strcmp(cl->platform_name, "built in") == 0)
  {
    fail_msg("%s", "This test adds kernels, which needs a driver's compiler: set MCOR_DEVICE=pocl");
  }
  /* A kernel that calls mcor_topology_* or mcor_cell_* needs the sources of the lattice's programs. Any other kernel
   * needs the sources of the field's programs. */
  const bool of_lattice = strstr(source, "mcor_topology_") || strstr(source, "mcor_cell_");
  const cl_uint count =
    (cl_uint)mcor_program_sources(cl, of_lattice ? MCOR_PARTS_LATTICE : MCOR_PARTS_FIELD, sources);
  char options[512];
  mcor_program_options(
    cl, of_lattice ? MCOR_PROGRAM_GRID : MCOR_PROGRAM_NODES, options, sizeof options);
  sources[count] = source;
  cl_int error;
  cl_program program = clCreateProgramWithSource(cl->context, count + 1, sources, NULL, &error);
  assert_int_equal(error, CL_SUCCESS);
  error = clBuildProgram(program, 1, &cl->device, options, NULL, NULL);
  if (error != CL_SUCCESS)
  {
    char log[4000] = "";
    clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, sizeof log - 1, log, NULL);
    clReleaseProgram(program);
    fail_msg("build error %d: %s", (int)error, log);
  }
  for (const char* at = strstr(source, "__kernel void "); at; at = strstr(at, "__kernel void "))
  {
    at += strlen("__kernel void ");
    char name[sizeof cl->kernels[0].name] = "";
    memcpy(name, at, strcspn(at, "("));
    bool known = false;
    for (int i = 0; i < cl->kernel_count; ++i)
    {
      known = known || strcmp(cl->kernels[i].name, name) == 0;
    }
    if (!known)
    {
      CORE_OK(context,
        mcor_make_room(
          context, (void**)&cl->kernels, cl->kernel_count, &cl->kernel_room, sizeof *cl->kernels));
      mcor_kernel* kernel = &cl->kernels[cl->kernel_count++];
      *kernel = (mcor_kernel){ .program = MCOR_PROGRAM_NODES };
      strcpy(kernel->name, name);
      kernel->kernel = clCreateKernel(program, name, &error);
      assert_int_equal(error, CL_SUCCESS);
    }
  }
  clReleaseProgram(program); /* the kernels keep the program alive */
}
