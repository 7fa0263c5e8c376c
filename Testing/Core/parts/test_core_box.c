/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests boxes: the surfaces of boxes that divide the lattice must together equal the whole surface to the last bit.
 * Triangles are compared by their corners' coordinates and arrays, because each box numbers its points anew. */

#include "core_parts.h"

/* Makes a block whose smoothing lengths differ by a factor of 2, with solids. */
static particle_set make_block(void)
{
  particle_set set = core_make_block(14, 0.3, 8, core_ball);
  uint64_t seed = 4;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] *= 1 + random_unit(&seed);
    set.solid[i] = random_bits(&seed) % 8 == 0;
    set.scalar[i] += 10 * random_unit(&seed);
  }
  return set;
}

static void trimmed_surfaces(void** state)
{
  const double iso[2] = { -8, -30 };
  CORE_SET set = make_block();
  set.has_solids = 1;
  const mcor_array attributes[2] = { core_array(set.position, 3),
    core_array(set.smoothing_length, 1) };
  mcor_input input = core_input_with(&set, attributes, 2);
  mcor_options options = core_options(iso);
  options.iso_count = 2;
  core_ask_for_all(&options);
  core_check_cuts(*state, "two values, solids", &input, &options);
  options.wall_share = 0.4;
  options.triangle_normals = 1;
  input.volume = (mcor_array){ 0 };
  core_check_cuts(*state, "normals from triangles, computed volumes", &input, &options);
  options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
  options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
  options.vertex_threshold = 0.3;
  options.preview = 1;
  core_check_cuts(*state, "eigenvalue, preview", &input, &options);
}

/* Checks a noisy scalar, which makes ambiguous faces and pinched edges (edges with two vertices). */
static void rough_surfaces(void** state)
{
  const double iso = 0.1;
  CORE_SET set = make_block();
  uint64_t seed = 12;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = 2 * random_unit(&seed) - 1;
  }
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.h_scale = 0.5;
  options.node_threshold = 0.9;
  options.vertex_threshold = 0.92;
  core_ask_for_all(&options);
  options.triangle_normals = 1;
  core_check_cuts(*state, "noise", &input, &options);
  options.topology = MCOR_TOPOLOGY_FIELD;
  core_check_cuts(*state, "topology", &input, &options);
}

static void other_fields(void** state)
{
  const double half = 0.5, iso = -8;
  CORE_SET set = core_make_random(6000, 14, 0.3, 3, 7);
  mcor_input input = core_input(&set);
  input.volume = (mcor_array){ 0 };
  mcor_options options = core_options(&half);
  core_ask_for_all(&options);
  options.cube_size = 0.3;
  options.field = MCOR_WEIGHT_SUM;
  core_check_cuts(*state, "free surface", &input, &options);
  particle_set_free(&set);
  set = make_block();
  input = core_input(&set);
  input.volume = (mcor_array){ 0 };
  input.mass = core_array(set.volume, 1);
  options = core_options(&iso);
  core_ask_for_all(&options);
  options.sph_kernel = MCOR_M_PRIME_4;
  options.field = MCOR_SUM;
  core_check_cuts(*state, "sum, tensor kernel", &input, &options);
}

/* Checks the nearest particle where one large particle makes the surface. The nearest particle is often one of many
 * small particles, whose support ends before the box. */
static void nearest_particles(void** state)
{
  const double half = 0.5;
  CORE_SET set = core_make_random(60, 14, 0.3, 3, 7);
  uint64_t seed = 21;
  for (int64_t i = 0; i < set.count; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = i == 0 ? 0 : 4 * random_unit(&seed) - 2;
    }
    set.smoothing_length[i] = i == 0 ? 1 : 0.1;
    set.volume[i] = i == 0 ? 40 : 1e-6;
  }
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&half);
  core_ask_for_all(&options);
  options.field = MCOR_WEIGHT_SUM;
  options.cube_size = 0.12;
  options.level_limit = 0;
  core_check_cuts(*state, "nearest", &input, &options);
}

/* Returns an input with masses and without volumes, so that volumes are computed. The first attribute is the position.
 * The particles near some boxes have x of one sign, although the global range of x has both. */
static mcor_input input_of(const particle_set* set, mcor_array attributes[3])
{
  mcor_input input = core_input_with(set, attributes, 3);
  input.volume = (mcor_array){ 0 };
  input.mass = core_array(set->volume, 1);
  attributes[0] = core_array(set->position, 3);
  attributes[1] = (mcor_array){ .constant = 7, .type = MCOR_FLOAT64, .components = 1 };
  attributes[2] = core_array(set->scalar, 1);
  return input;
}

/* Measures global values once, and gives them to the call for each box, with only the particles
 * near the box. */
static void given_globals(void** state)
{
  const double iso = 1;
  CORE_SET set = core_make_random(6000, 14, 0.7, 2, 17);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] += core_ball(set.position + 3 * i);
    set.solid[i] = i % 11 == 0;
  }
  set.has_solids = 1;
  mcor_array attributes[3];
  mcor_input input = input_of(&set, attributes);
  mcor_options options = core_options(&iso);
  core_ask_for_all(&options);
  /* Particles have other numbers in the box's input, so the nearest particle's number is not
   * compared. */
  options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE;
  mcor_globals globals;
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
  assert_int_equal(globals.component_count, 5);
  const double shift = globals.scalar_shift;
  mcor_surface surface = core_extract(*state, &input, &options);
  core_triangles whole = { 0 }, all = { 0 };
  core_add_surface(&whole, &input, &surface);
  mcor_free_surface(&surface);
  options.globals = &globals;
  const int none[3] = { 0, 0, 0 };
  int64_t fewest = set.count;
  for (int i = 0; i < 8; ++i)
  {
    const int at[3] = { i & 1, i >> 1 & 1, i >> 2 };
    core_set_box(&options, core_cuts + 3, at);
    CORE_SET near = core_take_near(&set, options.box, 8.5);
    fewest = near.count < fewest ? near.count : fewest;
    input = input_of(&near, attributes);
    input.particles_version = input.scalar_version = 1000 + (uint64_t)i;
    globals.scalar_shift = shift + 1; /* what was kept for the other shift is not used */
    surface = core_extract(*state, &input, &options);
    mcor_free_surface(&surface);
    globals.scalar_shift = shift;
    surface = core_extract(*state, &input, &options);
    core_add_surface(&all, &input, &surface);
    mcor_free_surface(&surface);
  }
  assert_in_range(fewest, 1, set.count - 100);
  core_expect_same("eight boxes", &all, &whole);
  input = input_of(&set, attributes);
  input.attribute_count = 2;
  core_set_box(&options, core_cuts + 3, none);
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(*state, "GLOBALS_OF_OTHER_ATTRIBUTES|5 "));
  mcor_free_globals(&globals);
  free(whole.bytes);
  free(all.bytes);
}

/* Checks that a small box reads only the particles that reach it, and that a box away from all particles has no
 * cells. */
static void small_boxes(void** state)
{
  const double iso = 0;
  CORE_SET set = core_make_block(24, 0.3, 8, core_ball);
  const mcor_input input = core_input_to_keep(&set);
  mcor_options options = core_options(&iso);
  CORE_SURFACE whole = core_extract(*state, &input, &options);
  assert_int_equal(whole.statistics.particles_in_reach, set.count);
  const double box[6] = { 2, 4, -1, 1, -1, 1 };
  memcpy(options.box, box, sizeof box);
  CORE_SURFACE part = core_extract(*state, &input, &options);
  assert_in_range(part.triangle_count, 10, whole.triangle_count / 4);
  assert_in_range(part.statistics.particles_in_reach, 10, set.count / 8);
  assert_in_range(part.statistics.nodes_evaluated, 10, whole.statistics.nodes_evaluated / 3);
  for (int64_t i = 0; i < 3 * part.point_count; ++i)
  {
    const int64_t a = i % 3;
    const double margin = 0.5001 * part.statistics.cube_size;
    assert_true(part.points[i] > box[2 * a] - margin && part.points[i] < box[2 * a + 1] + margin);
  }
  mcor_free_surface(&part);
  options.box[0] = 1000;
  options.box[1] = 1001;
  part = core_extract(*state, &input, &options);
  assert_int_equal(part.triangle_count, 0);
  assert_int_equal(part.point_count, 0);
  assert_int_equal(part.statistics.particles_in_reach, 0);
  assert_int_equal(part.statistics.virtual_cells, 0);
  assert_true(part.statistics.cube_size == whole.statistics.cube_size);
}

/* Checks that data kept from one box do not change the result of the next call. */
static void kept_particles(void** state)
{
  const double iso[2] = { 2, 4 };
  CORE_SET set = core_make_random(3000, 14, 0.8, 1.6, 9);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] += core_ball(set.position + 3 * i);
  }
  mcor_input kept = core_input_to_keep(&set), fresh = core_input(&set);
  mcor_options options = core_options(iso);
  for (int call = 0; call < 7; ++call)
  {
    options.box[0] = options.box[2] = options.box[4] = call == 1 ? 0 : -1;
    options.box[1] = options.box[3] = options.box[5] = call == 1 ? 0 : call == 6 ? 2.5 : 3;
    options.outputs = call >= 3 ? options.outputs | MCOR_OUT_NEAREST_PARTICLE
                                : options.outputs & ~(unsigned)MCOR_OUT_NEAREST_PARTICLE;
    options.iso_values = iso + (call == 2);
    CORE_SURFACE surface = core_extract(*state, &kept, &options);
    CORE_CONTEXT other = NULL;
    CORE_OK(other, mcor_create_context(NULL, &other));
    CORE_SURFACE expected = core_extract(other, &fresh, &options);
    CORE_CHECK(surface.triangle_count > 10 && core_hash(&surface) == core_hash(&expected), call,
      surface.triangle_count, expected.triangle_count);
  }
}

/* Checks that impossible global values, which mcor_measure_globals never gives, are refused. */
static void impossible_globals(void** state)
{
  const double iso = 0;
  CORE_SET set = core_make_block(5, 0.2, 3, core_ball);
  const mcor_array attribute = core_array(set.scalar, 1);
  const mcor_input input = core_input_with(&set, &attribute, 1);
  mcor_options options = core_options(&iso);
  CORE_OWNED(mcor_free_globals) mcor_globals measured;
  CORE_SURFACE surface;
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &measured));
#define IMPOSSIBLE(change)                                                                         \
  do                                                                                               \
  {                                                                                                \
    mcor_globals globals = measured;                                                               \
    globals.change;                                                                                \
    options.globals = &globals;                                                                    \
    assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_INVALID_ARGUMENT);     \
    CORE_CHECK(!surface.points && mcor_last_error(*state)[0], #change);                            \
  } while (0)
  IMPOSSIBLE(components = NULL);
  IMPOSSIBLE(component_count = -1);
  IMPOSSIBLE(split_count = -1);
  IMPOSSIBLE(measured.fluid_count = -1);
  IMPOSSIBLE(measured.low[1] = NAN);
  IMPOSSIBLE(measured.high[2] = -100);
  IMPOSSIBLE(measured.h_min = 0);
  IMPOSSIBLE(measured.h_max = 1e-3);
  IMPOSSIBLE(measured.support_max = 0.01);
  IMPOSSIBLE(scalar_shift = INFINITY);
  IMPOSSIBLE(measured.wall_share = NAN);
#undef IMPOSSIBLE
  options.globals = &measured;
  CORE_OK(*state, mcor_extract(*state, &input, &options, &surface));
}

/* Makes the particles of one period, centred at the origin. Some are so light that the surface and its caps are
 * trimmed. */
static particle_set make_period(void)
{
  particle_set set = particle_set_make(512);
  uint64_t seed = 21;
  for (int64_t i = 0; i < set.count; ++i)
  {
    double* x = set.position + 3 * i;
    const int64_t at[3] = { i % 8, i / 8 % 8, i / 64 };
    set.scalar[i] = 0;
    for (int a = 0; a < 3; ++a)
    {
      x[a] = (double)at[a] - 3.5 + 0.4 * (2 * random_unit(&seed) - 1);
      set.scalar[i] += sin(0.25 * 3.14159265 * x[a] + a);
    }
    set.smoothing_length[i] = 1.1 * (1 + 0.4 * random_unit(&seed));
    set.volume[i] = x[0] + x[1] > 2.5 ? 0.01 : 1;
    set.solid[i] = x[2] > 2.2;
  }
  return set;
}

/* Checks caps: the cap squares of a cell belong to the box that owns the cell, and points on the seams between boxes
 * match, even where they are trimmed. */
static void check_caps(mcor_context* context, const double around[6])
{
  const double iso[2] = { 0.2, -0.4 }, half = 0.5;
  CORE_SET set = make_period();
  for (int64_t i = 0; i < 3 * set.count; ++i)
  {
    set.position[i] *= around[2 * (i % 3) + 1] / 4;
  }
  const mcor_array position = core_array(set.position, 3);
  mcor_input input = core_input_with(&set, &position, 1);
  mcor_options options = core_options(iso);
  options.iso_count = 2;
  options.cube_size = 0.4;
  options.capping = 1;
  memcpy(options.periodic, around, sizeof options.periodic);
  core_ask_for_all(&options);
  core_check_cuts(context, "caps, trimmed", &input, &options);
  options.topology = MCOR_TOPOLOGY_FIELD;
  options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
  options.vertex_threshold = 0.3;
  options.triangle_normals = 1;
  options.periodic[4] = options.periodic[5] = 0;
  set.has_solids = 1;
  input = core_input(&set);
  options.wall_share = 0.4;
  core_check_cuts(context, "caps, eigenvalue, walls", &input, &options);
  options.field = MCOR_WEIGHT_SUM;
  options.iso_values = &half;
  options.iso_count = 1;
  options.wall_share = 0;
  core_check_cuts(context, "caps, free surface", &input, &options);
}

static void caps(void** state)
{
  const double around[6] = { -4, 4, -4, 4, -4, 4 },
               unequal[6] = { -4, 4, -4.13, 4.13, -3.91, 3.91 };
  check_caps(*state, around);
  check_caps(*state, unequal);
}

CORE_MAIN(core_set_up, core_tear_down, trimmed_surfaces, rough_surfaces, other_fields,
  nearest_particles, kept_particles, caps, given_globals, impossible_globals, small_boxes)
