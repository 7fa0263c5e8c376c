/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests adaptive cubes in boxes: levels are measured in the whole set, and the boxes' surfaces make up the whole
 * surface to the last bit. */

#include "core_parts.h"

static mcor_options adaptive_options(const double* iso, mcor_field field)
{
  mcor_options options = core_options(iso);
  options.field = field;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  core_ask_for_all(&options);
  return options;
}

static void smooth_surfaces(void** state)
{
  static const double half = 0.5, isos[2] = { 0.2, -0.3 };
  CORE_SET set = core_make_graded(12, 0.4);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.solid[i] = set.position[3 * i] < -0.6 * set.smoothing_length[i] && i % 3 == 0;
  }
  const mcor_array attributes[2] = { core_array(set.position, 3), core_array(set.scalar, 1) };
  mcor_input input = core_input_with(&set, attributes, 2);
  mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
  core_check_cuts(*state, "free surface", &input, &options);
  set.has_solids = 1;
  input = core_input(&set);
  options = adaptive_options(isos, MCOR_SHEPARD);
  options.iso_count = 2;
  options.wall_share = 0.3;
  options.triangle_normals = 1;
  core_check_cuts(*state, "two values, solids, normals of triangles", &input, &options);
}

/* Checks surfaces of a noisy scalar on particles that are larger further out. Many triangles are of level 1, loops of
 * vertices lie flat in faces between levels, and some edges are pinched (have two vertices). */
static void rough_surfaces(void** state)
{
  static const double iso = 0.1;
  CORE_SET set = core_make_graded(12, 0.4);
  uint64_t seed = 7;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = 2 * random_unit(&seed) - 1;
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] += 0.6 * set.smoothing_length[i] * (random_unit(&seed) - 0.5);
    }
  }
  mcor_input input = core_input(&set);
  input.volume = (mcor_array){ 0 };
  mcor_options options = adaptive_options(&iso, MCOR_SHEPARD);
  options.cube_size_factor = 1.0;
  options.h_scale = 0.55;
  options.node_threshold = 0.45;
  options.vertex_threshold = 0.47;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  int64_t pinched = 0;
  for (int64_t i = 0; i < surface.point_count; ++i)
  {
    pinched += surface.point_keys[3 * i + 1] % 2 == 1;
  }
  CORE_CHECK(surface.statistics.triangles_of_level[1] > 500 && pinched > 0 &&
      surface.statistics.flat_loops > 0,
    surface.statistics.triangles_of_level[1], pinched, surface.statistics.flat_loops);
  core_check_cuts(*state, "noise, computed volumes", &input, &options);
  options.topology = MCOR_TOPOLOGY_FIELD;
  core_check_cuts(*state, "topology by field", &input, &options);
  input.volume = core_array(set.volume, 1);
  options.preview = 1;
  options.sph_kernel = MCOR_M_PRIME_4;
  core_check_cuts(*state, "M'4, preview", &input, &options);
}

/* Returns the particles whose supports reach the box enlarged on all sides by six cubes of the particle's level. */
static particle_set take_reaching(
  const particle_set* set, const double box[6], const mcor_globals* globals, double cube)
{
  particle_set near = particle_set_make(set->count);
  near.count = 0;
  for (int64_t i = set->count - 1; i >= 0; --i)
  {
    const double h = set->smoothing_length[i];
    const double level = floor(log2(h / globals->measured.h_min * (1 + 1e-12)));
    const double reach = 2 * h + 6 * cube * exp2(level);
    core_add_near(&near, set, i, box, reach);
  }
  return near;
}

/* Measures levels once, and gives them to the call for each box, with only the particles near the
 * box. */
static void given_levels(void** state)
{
  static const double iso = 0.2;
  CORE_SET set = core_make_graded(40, 0.3);
  mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&iso, MCOR_SHEPARD);
  /* Particles have other numbers in the box's input, so the nearest particle's number is not
   * compared. */
  options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE;
  mcor_globals globals;
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
  assert_true(globals.split_count > 10);
  mcor_surface surface = core_extract(*state, &input, &options);
  core_triangles whole = { 0 }, all = { 0 };
  core_add_surface(&whole, &input, &surface);
  mcor_free_surface(&surface);
  options.globals = &globals;
  int64_t fewest = set.count;
  for (int i = 0; i < 8; ++i)
  {
    const int at[3] = { i & 1, i >> 1 & 1, i >> 2 };
    core_set_box(&options, core_cuts + 3, at);
    CORE_SET near = take_reaching(&set, options.box, &globals, globals.measured.cube);
    fewest = near.count < fewest ? near.count : fewest;
    input = core_input(&near);
    surface = core_extract(*state, &input, &options);
    core_add_surface(&all, &input, &surface);
    mcor_free_surface(&surface);
  }
  assert_in_range(fewest, 1, set.count - 100);
  core_expect_same("eight boxes", &all, &whole);
  free(whole.bytes);
  free(all.bytes);
  /* Global values that were measured for uniform cubes lack the levels, so they must be refused. */
  mcor_free_globals(&globals);
  input = core_input(&set);
  options.globals = NULL;
  options.level_limit = 0;
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &globals));
  options.globals = &globals;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_INVALID_ARGUMENT);
  CORE_CHECK(core_told(*state, "GLOBALS_OF_UNIFORM_CUBES"), mcor_last_error(*state));
  mcor_free_globals(&globals);
}

/* Checks boxes whose sides cut large cubes. Such a box needs particles that are many small cubes away
 * from it. */
static void cuts_through_large_cubes(void** state)
{
  static const double half = 0.5;
  /* The cuts pass just beside the centres of cubes 64 times the smallest, which has an edge of 0.18. */
  static const core_cut cuts[] = { { "3 boxes far out", { 2, 0, 0 }, { { -86.41, -74.89 } } },
    { "6 boxes far out", { 0, 1, 2 }, { { 0 }, { -74.87 }, { -86.39, 74.87 } } } };
  CORE_SET set = core_make_graded(150, 0.3);
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
  /* With this output a box keeps all particles around it, so the test would always pass. */
  options.outputs &= ~(unsigned)MCOR_OUT_NEAREST_PARTICLE;
  core_check_these_cuts(*state, "large cubes", &input, &options, cuts, 2);
}

CORE_MAIN(core_set_up, core_tear_down, smooth_surfaces, rough_surfaces, given_levels,
  cuts_through_large_cubes)
