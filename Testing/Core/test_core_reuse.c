/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Checks that data that a context keeps between calls never change a result. One parameter at a time is changed right
 * after a call, and changed back. Each time a new context must give the same result. */

#include "core_fixture.h"

/* A call, and the values that its parameters may change to. */
typedef struct reuse_call
{
  particle_set set, other; /* other: has as many particles as set */
  double iso[2];
  float* single; /* smoothing lengths of `set` */
  double* noise;
  mcor_array attributes[2];
  mcor_input input;
  mcor_options options;
} reuse_call;

/* Starting points of the tests: where the particles' sizes come from, and what is contoured. */
typedef enum reuse_base
{
  REUSE_ARRAYS, /* smoothing lengths and volumes as arrays */
  REUSE_CONSTANTS,
  REUSE_MASS,      /* mass and density as constants */
  REUSE_MASS_ONLY, /* masses as an array; solids count, and the surface ends at them */
  REUSE_VECTOR,    /* a component of the positions is contoured */
  REUSE_ROUGH,     /* ambiguous faces, and components without pairs */
  REUSE_FREE_SURFACE,
  REUSE_BASES
} reuse_base;

static void start_call(reuse_call* call)
{
  uint64_t seed = 21;
  *call = (reuse_call){ .set = core_make_block(8, 0.3, 3, core_ball),
    .other = core_make_block(8, 0.2, 4, core_slope) };
  const size_t n = (size_t)call->set.count;
  call->single = malloc(n * sizeof(float));
  call->noise = malloc(n * sizeof(double));
  assert_true(call->single && call->noise);
  for (size_t i = 0; i < n; ++i)
  {
    call->set.smoothing_length[i] *= 1 + 0.3 * random_unit(&seed);
    call->set.volume[i] *= 0.9 + 0.2 * random_unit(&seed);
    call->noise[i] = 2 * random_unit(&seed) - 1;
    call->set.solid[i] = i % 9 == 0;
    call->other.solid[i] = i % 7 == 0;
    call->single[i] = (float)call->set.smoothing_length[i];
  }
  call->set.has_solids = 1;
}

static void end_call(reuse_call* call)
{
  particle_set_free(&call->set);
  particle_set_free(&call->other);
  free(call->single);
  free(call->noise);
}

static void set_base(reuse_call* call, reuse_base base)
{
  const mcor_array one = { .constant = 1 }, large = { .constant = 1.4 };
  call->iso[0] = base == REUSE_FREE_SURFACE ? 0.5 : base == REUSE_VECTOR ? 1.5 : 0;
  call->iso[1] = 2.5;
  mcor_input* in = &call->input;
  *in = core_input(&call->set);
  in->particles_version = in->scalar_version = 100 + (uint64_t)base;
  in->ignore_solids = 1; /* one device program less to compile */
  if (base == REUSE_CONSTANTS)
  {
    in->smoothing_length = large;
    in->volume = one;
  }
  if (base == REUSE_MASS || base == REUSE_MASS_ONLY)
  {
    in->mass = base == REUSE_MASS ? one : core_array(call->set.volume, 1);
    in->density = base == REUSE_MASS ? one : (mcor_array){ 0 };
    in->volume = (mcor_array){ 0 };
    in->ignore_solids = base == REUSE_MASS;
  }
  if (base == REUSE_VECTOR)
  {
    in->scalar = in->positions;
  }
  if (base == REUSE_ROUGH)
  {
    in->scalar = core_array(call->noise, 1);
    in->smoothing_length = (mcor_array){ .constant = 0.8 };
  }
  call->attributes[0] = core_array(call->set.scalar, 1);
  call->attributes[1] = in->positions;
  in->attributes = call->attributes;
  in->attribute_count = 1;
  mcor_options* o = &call->options;
  *o = core_options(call->iso);
  o->field = base == REUSE_FREE_SURFACE ? MCOR_WEIGHT_SUM : MCOR_SHEPARD;
  o->wall_share = base == REUSE_MASS_ONLY ? 0.12 : 0;
  if (base == REUSE_ROUGH)
  {
    o->cube_size_factor = 0.7;
  }
  o->outputs |=
    MCOR_OUT_GRADIENTS | MCOR_OUT_WEIGHT_SUM | MCOR_OUT_CORRECTION_LENGTH | MCOR_OUT_RESIDUAL;
  o->outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_ISO_VALUE | MCOR_OUT_NEAREST_PARTICLE;
}

/* A change of one parameter. Versions only say whether arrays' contents changed; all else in the input or the options
 * may change without a new version. */
typedef struct reuse_step
{
  const char* name;
  reuse_base base;
  void (*change)(reuse_call* call);
  int same; /* the change does not change the surface */
} reuse_step;

#define STEP(name, statement)                                                                      \
  static void change_##name(reuse_call* c)                                                         \
  {                                                                                                \
    statement;                                                                                     \
  }

/* ---- steps for mcor_input, in the order of its members ---- */
STEP(count, c->input.count -= 100)
STEP(positions, c->input.positions = core_array(c->other.position, 3);
     c->input.particles_version = 8)
STEP(particles_unversioned, c->input.positions = core_array(c->other.position, 3);
     c->input.particles_version = 0)
STEP(smoothing_length, c->input.smoothing_length = (mcor_array){ .constant = 1.5 })
STEP(smoothing_length_constant, c->input.smoothing_length.constant = 1.5)
STEP(smoothing_length_array, c->input.smoothing_length = core_array(c->set.smoothing_length, 1))
STEP(smoothing_length_type, c->input.smoothing_length.data = c->single;
     c->input.smoothing_length.type = MCOR_FLOAT32)
STEP(support_radius, c->input.smoothing_length_is_support_radius = 1;
     c->options.node_threshold = c->options.vertex_threshold = 0)
STEP(estimate, c->input.estimate_smoothing_length = 1)
STEP(volume, c->input.volume = (mcor_array){ .constant = 0.9 })
STEP(volume_constant, c->input.volume.constant = 0.9)
STEP(volume_array, c->input.volume = core_array(c->set.volume, 1))
STEP(no_volume, c->input.volume = (mcor_array){ 0 })
STEP(mass, c->input.mass = core_array(c->set.volume, 1))
STEP(mass_constant, c->input.mass.constant = 0.9)
STEP(no_mass, c->input.mass = (mcor_array){ 0 })
STEP(density, c->input.density = core_array(c->set.volume, 1))
STEP(density_constant, c->input.density.constant = 1.1)
STEP(no_density, c->input.density = (mcor_array){ 0 })
STEP(scalar, c->input.scalar = core_array(c->other.scalar, 1); c->input.scalar_version = 8)
STEP(scalar_unversioned, c->input.scalar = core_array(c->other.scalar, 1);
     c->input.scalar_version = 0)
STEP(scalar_component, c->input.scalar_component = 1)
STEP(magnitude, c->input.scalar_component = MCOR_MAGNITUDE)
STEP(dot, c->input.scalar_dot = core_array(c->set.position, 3); c->iso[0] = 6)
STEP(no_solids, c->input.solid = NULL)
STEP(solids, c->input.solid = c->other.solid; c->input.particles_version = 8)
STEP(ignore_solids, c->input.ignore_solids = !c->input.ignore_solids)
STEP(attributes, c->input.attributes = c->attributes + 1)
STEP(attribute_count, c->input.attribute_count = 2)
/* ---- steps for mcor_options ---- */
STEP(sph_kernel, c->options.sph_kernel = MCOR_WENDLAND_C2)
STEP(field, c->options.field = MCOR_SUM)
STEP(weight_field, c->options.field = MCOR_WEIGHT_SUM; c->iso[0] = 0.5)
STEP(seeds, c->options.seeds = MCOR_PAIRS)
STEP(topology, c->options.topology = MCOR_TOPOLOGY_FIELD)
STEP(h_scale, c->options.h_scale = 0.8)
STEP(cube_size_factor, c->options.cube_size_factor = 0.8)
STEP(cube_size, c->options.cube_size = 0.7)
STEP(iso_value, c->iso[0] = 2.5)
STEP(iso_count, c->options.iso_count = 2)
STEP(node_threshold, c->options.node_threshold = 0.95)
STEP(boundary_detection, c->options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE)
STEP(vertex_threshold, c->options.vertex_threshold = 0.9)
STEP(wall_share, c->options.wall_share = 0.14)
STEP(no_wall_share, c->options.wall_share = 0)
STEP(preview, c->options.preview = 1)
STEP(compact, c->options.compact = 1)
STEP(widen, c->options.widen = 1.5)
STEP(smooth, c->options.smooth = 1; mcor_spell_out(&c->options))
STEP(tolerance, c->options.tolerance = 1e-2)
STEP(iteration_limit, c->options.iteration_limit = 1)
STEP(precision, c->options.precision = MCOR_FLOAT64)
STEP(memory_limit, c->options.memory_limit = INT64_C(1) << 40)
STEP(box, c->options.box[0] = c->options.box[2] = c->options.box[4] = -1.5;
     c->options.box[1] = c->options.box[3] = c->options.box[5] = 2.5)
STEP(periodic, c->options.periodic[0] = c->options.periodic[2] = -4;
     c->options.periodic[1] = c->options.periodic[3] = 4)
STEP(normals, c->options.outputs &= ~(unsigned)MCOR_OUT_NORMALS)
STEP(gradients, c->options.outputs &= ~(unsigned)MCOR_OUT_GRADIENTS)
STEP(weight_sum, c->options.outputs &= ~(unsigned)MCOR_OUT_WEIGHT_SUM)
STEP(boundary_eigenvalue, c->options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE)
STEP(correction_length, c->options.outputs &= ~(unsigned)MCOR_OUT_CORRECTION_LENGTH)
STEP(residual, c->options.outputs &= ~(unsigned)MCOR_OUT_RESIDUAL)
STEP(boundary_flag, c->options.outputs &= ~(unsigned)MCOR_OUT_BOUNDARY_FLAG)
STEP(iso_value_array, c->options.outputs &= ~(unsigned)MCOR_OUT_ISO_VALUE)
STEP(curvature, c->options.outputs |= MCOR_OUT_MEAN_CURVATURE | MCOR_OUT_GAUSS_CURVATURE)
STEP(nearest_particle, c->options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE)
STEP(triangle_normals, c->options.triangle_normals = 1)

#define AT(base, name)                                                                             \
  {                                                                                                \
#name, REUSE_##base, change_##name, 0                                                          \
  }
static const reuse_step steps[] = { AT(ARRAYS, count), AT(ARRAYS, positions),
  AT(ARRAYS, particles_unversioned), AT(ARRAYS, smoothing_length),
  AT(CONSTANTS, smoothing_length_constant), AT(CONSTANTS, smoothing_length_array),
  AT(ARRAYS, smoothing_length_type), AT(ARRAYS, support_radius), AT(CONSTANTS, support_radius),
  AT(ARRAYS, estimate), AT(ARRAYS, volume), AT(CONSTANTS, volume_constant),
  AT(CONSTANTS, volume_array), AT(ARRAYS, no_volume), AT(MASS, mass), AT(MASS, mass_constant),
  AT(MASS_ONLY, no_mass), AT(MASS, density), AT(MASS, density_constant), AT(MASS, no_density),
  AT(ARRAYS, scalar), AT(ARRAYS, scalar_unversioned), AT(VECTOR, scalar_component),
  AT(VECTOR, magnitude), AT(VECTOR, dot), AT(ARRAYS, no_solids), AT(ARRAYS, solids),
  AT(ARRAYS, ignore_solids), AT(MASS_ONLY, ignore_solids), AT(ARRAYS, attributes),
  AT(ARRAYS, attribute_count), AT(ARRAYS, sph_kernel), AT(ARRAYS, field), AT(ARRAYS, weight_field),
  AT(ROUGH, seeds), AT(ROUGH, topology), AT(ARRAYS, h_scale), AT(MASS_ONLY, h_scale),
  AT(FREE_SURFACE, h_scale), AT(ARRAYS, cube_size_factor), AT(ARRAYS, cube_size),
  AT(ARRAYS, iso_value), AT(ARRAYS, iso_count), AT(ARRAYS, node_threshold),
  AT(ARRAYS, boundary_detection), AT(ARRAYS, vertex_threshold), AT(MASS_ONLY, wall_share),
  AT(MASS_ONLY, no_wall_share), AT(ARRAYS, preview), AT(ARRAYS, compact), AT(ARRAYS, widen),
  AT(MASS_ONLY, widen), AT(FREE_SURFACE, smooth), AT(ARRAYS, tolerance),
  AT(ARRAYS, iteration_limit), AT(ARRAYS, precision),
  { "memory_limit", REUSE_ARRAYS, change_memory_limit, 1 }, AT(ARRAYS, periodic),
  AT(MASS_ONLY, periodic), AT(ARRAYS, box), AT(MASS_ONLY, box), AT(ROUGH, box), AT(ARRAYS, normals),
  AT(ARRAYS, gradients), AT(ARRAYS, weight_sum), AT(ARRAYS, boundary_eigenvalue),
  AT(ARRAYS, correction_length), AT(ARRAYS, residual), AT(ARRAYS, boundary_flag),
  AT(ARRAYS, iso_value_array), AT(ARRAYS, curvature), AT(ARRAYS, nearest_particle),
  AT(ARRAYS, triangle_normals) };

/* Hashes the surface, and its numbers of seed cells and used cells. */
static uint64_t hash_of(mcor_context* context, const reuse_call* call, const char* step)
{
  CORE_SURFACE surface = core_extract(context, &call->input, &call->options);
  const mcor_statistics* s = &surface.statistics;
  CORE_CHECK(surface.triangle_count > 0, step);
  CORE_CHECK(s->seed_cells > s->seed_cells_not_intersected, step);
  const uint64_t hash = core_hash(&surface) + 1000003 * (uint64_t)s->seed_cells +
    7919 * (uint64_t)s->seed_cells_not_intersected + (uint64_t)s->cells_used;
  return hash;
}

/* Returns the hash of the same call in a new context. */
static uint64_t fresh_hash(const reuse_call* call, const char* step)
{
  CORE_CONTEXT context = NULL;
  CORE_OK(context, mcor_create_context(NULL, &context));
  reuse_call alone = *call;
  alone.input.particles_version = alone.input.scalar_version = 0;
  const uint64_t hash = hash_of(context, &alone, step);
  return hash;
}

/* Runs the step's base, then twice the changed call, then the base again. Returns 1 if a result is wrong, or
 * equals the base's although the change must matter. */
static int check_step(
  mcor_context* context, reuse_call* call, const reuse_step* step, const uint64_t* base)
{
  set_base(call, step->base);
  const int warm = hash_of(context, call, step->name) == base[step->base];
  step->change(call);
  const uint64_t expected = fresh_hash(call, step->name);
  const int first = hash_of(context, call, step->name) == expected;
  const int again = hash_of(context, call, step->name) == expected;
  set_base(call, step->base);
  const int back = hash_of(context, call, step->name) == base[step->base];
  const int changes = step->same || expected != base[step->base];
  if (!(warm && first && again && back && changes))
  {
    print_error("base %d, %s: before %d, changed %d, again %d, back %d; another surface %d\n",
      (int)step->base, step->name, warm, first, again, back, changes);
    return 1;
  }
  return 0;
}

static void test_one_change_at_a_time(void** state)
{
  reuse_call call;
  uint64_t base[REUSE_BASES];
  int wrong = 0;
  start_call(&call);
  for (int b = 0; b < REUSE_BASES; ++b)
  {
    set_base(&call, (reuse_base)b);
    base[b] = fresh_hash(&call, "base");
  }
  for (size_t i = 0; i < sizeof steps / sizeof steps[0]; ++i)
  {
    wrong += check_step(*state, &call, steps + i, base);
  }
  CORE_CHECK(wrong == 0, wrong);
  end_call(&call);
}

static int stop_in(void* user, double fraction, const char* phase)
{
  (void)fraction;
  return strcmp(phase, (const char*)user) == 0;
}

/* Makes a call fail: for kind 0 when options are checked, else in phase `kind`. */
static void fail_call(mcor_context* context, const reuse_call* call, int kind)
{
  mcor_options options = call->options;
  char phase[40];
  snprintf(phase, sizeof phase, "%s", mcor_phase_name((mcor_phase)kind));
  options.iteration_limit = kind == 0 ? 0 : options.iteration_limit;
  options.progress = kind == 0 ? NULL : stop_in;
  options.progress_user = phase;
  mcor_surface surface = { 0 };
  const mcor_status status = mcor_extract(context, &call->input, &options, &surface);
  assert_int_equal(status, kind == 0 ? MCOR_INVALID_ARGUMENT : MCOR_CANCELLED);
  assert_true(!surface.points && surface.point_count == 0);
}

/* A failed call may have other data, with new version numbers. Later calls with the failed call's data, and later calls
 * with the earlier data, must give the right results. */
static void test_failed_calls(void** state)
{
  mcor_context* context = *state;
  reuse_call call;
  start_call(&call);
  set_base(&call, REUSE_ARRAYS);
  const uint64_t before = fresh_hash(&call, "before");
  for (int parts = 1; parts <= 3; ++parts) /* 1: other particles, 2: another scalar, 3: both */
  {
    for (int kind = 0; kind < MCOR_PHASE_COUNT; ++kind)
    {
      if (kind == MCOR_PHASE_SEARCH_GRID && !(parts & 1))
      {
        continue; /* this part has not changed */
      }
      set_base(&call, REUSE_ARRAYS);
      assert_true(hash_of(context, &call, "before") == before);
      if (parts & 1)
      {
        change_positions(&call);
      }
      if (parts & 2)
      {
        change_scalar(&call);
      }
      const uint64_t expected = fresh_hash(&call, "after");
      fail_call(context, &call, kind);
      CORE_CHECK(hash_of(context, &call, "after") == expected, parts, kind);
      if (kind != MCOR_PHASE_SEARCH_GRID) /* the search grid exists now */
      {
        fail_call(context, &call, kind);
      }
      set_base(&call, REUSE_ARRAYS);
      CORE_CHECK(hash_of(context, &call, "back") == before, parts, kind);
    }
  }
  end_call(&call);
}

/* Makes calls that together use all the buffers that a context may hold. */
static void extract_all(mcor_context* context, reuse_call* call)
{
  for (int kind = 0; kind < 16; ++kind)
  {
    set_base(call, kind & 1 ? REUSE_MASS_ONLY : REUSE_ARRAYS);
    call->input.ignore_solids = !(kind & 1);
    call->input.attribute_count = 2;
    call->options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
    call->options.iso_count = 2;
    call->options.seeds = kind & 2 ? MCOR_PAIRS : MCOR_COMPLETE;
    call->options.topology = kind & 4 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    call->options.boundary_detection =
      kind & 8 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    hash_of(context, call, "every option");
  }
}

/* After mcor_release_memory a context holds only tables whose size does not depend on the input. */
static void test_release(void** state)
{
  CORE_CONTEXT context = NULL;
  reuse_call call;
  CORE_OK(context, mcor_create_context(NULL, &context));
  const int64_t at_first = context->cl.bytes;
  start_call(&call);
  set_base(&call, REUSE_ARRAYS);
  hash_of(context, &call, "release");
  assert_true(context->cl.bytes > at_first);
  mcor_release_memory(context);
  assert_int_equal(context->cl.bytes, at_first);
  extract_all(context, &call);
  mcor_release_memory(context);
  assert_int_equal(context->cl.bytes, at_first);
  set_base(&call, REUSE_ARRAYS);
  fail_call(context, &call, MCOR_PHASE_TRIMMING);
  mcor_release_memory(context);
  assert_int_equal(context->cl.bytes, at_first);
  mcor_release_memory(context);
  set_base(&call, REUSE_ARRAYS);
  assert_true(hash_of(context, &call, "after") == fresh_hash(&call, "fresh"));
  end_call(&call);
}

/* Checks that a change of global values changes the result, even if all else stays. */
static void test_globals(void** state)
{
  reuse_call call;
  mcor_globals globals;
  start_call(&call);
  set_base(&call, REUSE_MASS_ONLY);
  call.options.wall_share = MCOR_WALL_SHARE_MEASURED;
  CORE_OK(*state, mcor_measure_globals(*state, &call.input, &call.options, &globals));
  call.options.globals = &globals;
  uint64_t last = 0;
  for (int k = 0; k < 3; ++k)
  {
    globals.measured.wall_share = k == 1 ? 0.3 : 0.6;
    const uint64_t hash = hash_of(*state, &call, "wall share");
    CORE_CHECK(hash == fresh_hash(&call, "fresh") && hash != last, k);
    last = hash;
  }
  mcor_free_globals(&globals);
  end_call(&call);
}

CORE_MAIN(core_set_up, core_tear_down, test_one_change_at_a_time, test_failed_calls, test_release,
  test_globals)
