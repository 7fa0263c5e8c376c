/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests inputs at the limits: far apart or at one point, scalars of any magnitude, thresholds exactly met. */

#include "core_fixture.h"

/* Checks that drops far apart from each other are all found: keys of search cells must not
 * overflow. */
static void test_far_apart(void** state)
{
  enum
  {
    DROPS = 40
  };
  const double iso = 0.5;
  CORE_SET set = particle_set_make(DROPS);
  uint64_t seed = 5;
  for (int i = 0; i < DROPS; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      /* Drops lie on nodes of the lattice. The first and the last lie in its opposite corners. */
      const double at = i == 0 ? 0 : i == DROPS - 1 ? 1 : random_unit(&seed);
      set.position[3 * i + a] = floor(1000000 * at);
    }
    set.smoothing_length[i] = 0.1;
    set.volume[i] = 0.003;
  }
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.cube_size = 1;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.point_count, 6 * DROPS);
  assert_int_equal(surface.triangle_count, 8 * DROPS);
}

/* Before scaling (h_scale), smoothing lengths reach far beyond the lattice. Pairs and computed volumes use the lengths
 * before scaling. Both precisions must give the same number of triangles. */
static void test_far_reach(void** state)
{
  const double iso = 0;
  CORE_SET set = core_make_block(6, 0.2, 7, core_slope);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] = 130;
  }
  for (int kind = 0; kind < 2; ++kind)
  {
    mcor_input input = core_input(&set);
    mcor_options options = core_options(&iso);
    input.volume = kind ? input.volume : (mcor_array){ 0 };
    options.seeds = kind ? MCOR_PAIRS : MCOR_COMPLETE;
    options.h_scale = 0.01;
    options.cube_size = 0.1;
    options.node_threshold = 1e-4;
    options.vertex_threshold = 1e-3;
    int64_t triangles[2];
    for (int p = 0; p < 2; ++p)
    {
      options.precision = p ? MCOR_FLOAT64 : MCOR_FLOAT32;
      CORE_SURFACE surface = core_extract(*state, &input, &options);
      triangles[p] = surface.triangle_count;
    }
    CORE_CHECK(
      triangles[0] > 100 && triangles[0] == triangles[1], kind, triangles[0], triangles[1]);
  }
}

/* Checks that the unit of the scalar changes no number of points or cut vertices, and that the exact position of every
 * cut vertex is found in any unit. */
static void test_magnitude(void** state)
{
  const double units[2][4] = { { 1, 1e-28, 1e22, 1e29 }, { 1, 1e-160, 1e160, 1e280 } };
  CORE_SET set = core_make_block(8, 0.2, 3, core_slope);
  for (int p = 0; p < 2; ++p)
  {
    int64_t points = 0, cut = 0;
    for (int u = 0; u < 4; ++u)
    {
      const double iso = 0;
      CORE_FREED double* scaled = core_copy(set.scalar, (size_t)set.count * sizeof(double));
      for (int64_t i = 0; i < set.count; ++i)
      {
        scaled[i] *= units[p][u];
      }
      mcor_input input = core_input(&set);
      input.scalar = core_array(scaled, 1);
      mcor_options options = core_options(&iso);
      options.precision = p ? MCOR_FLOAT64 : MCOR_FLOAT32;
      CORE_SURFACE surface = core_extract(*state, &input, &options);
      points = u == 0 ? surface.point_count : points;
      cut = u == 0 ? surface.statistics.trim_vertices : cut;
      CORE_CHECK(surface.point_count == points && surface.statistics.trim_vertices == cut &&
          cut > 50 && surface.statistics.trim_vertices_linear == 0,
        p, units[p][u], surface.point_count, surface.statistics.trim_vertices,
        surface.statistics.trim_vertices_linear);
    }
  }
}

/* Checks thresholds that exactly equal the weight of a vertex. */
static void test_exact_threshold(void** state)
{
  const double iso = 0;
  CORE_SET set = core_make_block(7, 0.35, 9, core_slope);
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_WEIGHT_SUM;
  options.vertex_threshold = 0;
  CORE_SURFACE whole = core_extract(*state, &input, &options);
  int thresholds = 0;
  for (int64_t v = 0; v < whole.point_count; v += 3)
  {
    options.vertex_threshold = (double)whole.weight_sum[v];
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    CORE_REPORT report = core_check_mesh(&surface);
    thresholds += surface.triangle_count > 0;
  }
  CORE_CHECK(thresholds > 50, thresholds);
}

/* Checks that many particles at one place are sorted fast, and that the scalar of an earlier call leaves no trace. */
static void test_coincident(void** state)
{
  enum
  {
    PARKED = 200000
  };
  const double iso = 0.1;
  CORE_SET block = core_make_block(8, 0.2, 3, core_slope);
  CORE_SET set = particle_set_make(block.count + PARKED);
  uint64_t seed = 11;
  for (int64_t i = 0; i < set.count; ++i)
  {
    /* The block's particles come in pairs, each pair at one place. All other particles lie together at another place,
     * where a simulation parks unused particles. */
    const int64_t twin = i < block.count ? i / 2 * 2 : 0;
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = i < block.count ? block.position[3 * twin + a] : 30;
    }
    set.smoothing_length[i] = 1.3;
    set.volume[i] = i < block.count ? 0.5 : 1.0 / PARKED;
    set.scalar[i] = i < block.count ? (i % 2 ? -1 : 1) : random_unit(&seed) - 2;
  }
  CORE_FREED double* other = core_copy(set.scalar, (size_t)set.count * sizeof(double));
  for (int64_t i = 0; i < block.count; ++i)
  {
    other[i] = set.position[3 * (i / 2 * 2)];
  }
  mcor_input input = core_input_to_keep(&set);
  mcor_options options = core_options(&iso);
  options.outputs |= MCOR_OUT_NEAREST_PARTICLE;
  CORE_SURFACE first = core_extract(*state, &input, &options);
  input.scalar = core_array(other, 1);
  ++input.scalar_version;
  CORE_SURFACE reused = core_extract(*state, &input, &options);
  mcor_release_memory(*state);
  CORE_SURFACE fresh = core_extract(*state, &input, &options);
  CORE_CHECK(fresh.point_count > 50, fresh.point_count);
  assert_int_equal(core_hash(&reused), core_hash(&fresh));
}

/* Values equal iso over a whole region, to within rounding. Nodes that were evaluated for another iso value must not
 * change the result. */
static void test_plateau(void** state)
{
  const double plateau = (double)0.3f;
  CORE_SET set = core_make_block(16, 0.2, 3, core_slope);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = set.position[3 * i] < 1 ? 0 : plateau;
  }
  mcor_input input = core_input(&set);
  for (int k = 0; k < 5; ++k)
  {
    const double isos[2] = { plateau, plateau - 3e-8 * k };
    mcor_options options = core_options(isos);
    int64_t alone = 0;
    for (int i = 0; i < 2; ++i)
    {
      options.iso_values = isos + i;
      CORE_SURFACE surface = core_extract(*state, &input, &options);
      alone += surface.triangle_count;
    }
    options.iso_values = isos;
    options.iso_count = 2;
    CORE_SURFACE both = core_extract(*state, &input, &options);
    CORE_CHECK(both.triangle_count == alone, 3e-8 * k, both.triangle_count, alone);
  }
}

/* If an SPH kernel has negative lobes, weights at a particle may sum to 0 or less, which gives no volume. */
static void test_no_density(void** state)
{
  const double iso = 0.5;
  CORE_SET set = particle_set_make(17);
  for (int i = 0; i < 17; ++i)
  {
    memset(set.position + 3 * i, 0, 3 * sizeof(double));
    set.smoothing_length[i] = 1;
    set.scalar[i] = i % 2;
    if (i > 0)
    {
      /* At this distance from particle 0 the kernel is -1/16. */
      set.position[3 * i + (i - 1) % 3] = (i - 1) / 3 % 2 ? 1.5 : -1.5;
    }
  }
  mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  input.volume = (mcor_array){ 0 };
  options.sph_kernel = MCOR_M_PRIME_4;
  CORE_SURFACE surface = { 0 };
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_INVALID_DATA);
  assert_non_null(strstr(mcor_last_error(*state), "volume of particle 0"));
  options.sph_kernel = MCOR_CUBIC_SPLINE;
  surface = core_extract(*state, &input, &options);
}

/* With smoothing lengths from 1 to 1024, and cubes that suit the smallest, the lattice has 10^12 cells. The surface
 * must be closed, and the value at all vertices must be iso. */
static void test_wide_range(void** state)
{
  const particle_set_entry* entry = particle_set_find("variable_1024");
  CORE_SET set = particle_set_of(entry);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&entry->iso);
  options.node_threshold = options.vertex_threshold = 0; /* closed */
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  CORE_REPORT report = core_check_mesh(&surface);
  assert_true(surface.triangle_count > 5000 && surface.statistics.virtual_cells > 1000000000000);
  assert_true(report.boundary_edges == 0 && report.components == 1 && report.euler == 2);
  CORE_FIELD field = oracle_make_field(&set, ORACLE_CUBIC_SPLINE, ORACLE_SHEPARD, 1);
  const double range = oracle_scalar_range(&set);
  for (int64_t v = 0; v < surface.point_count; ++v)
  {
    oracle_sample sample;
    oracle_evaluate(&field, NULL, surface.points + 3 * v, &sample);
    CORE_CHECK(
      fabs(sample.value - entry->iso) <= 5e-6 * range, v, sample.value - entry->iso, range);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_far_apart, test_far_reach, test_magnitude,
  test_exact_threshold, test_coincident, test_plateau, test_no_density, test_wide_range)
