/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares the isolines of particles in a plane with a reference that evaluates all squares. */

#include "core_period.h"
#include "mcor_plane.h"
#include "plane_reference.h"

/* Extracts the lines of the input and compares them with the lines of the reference, which has the particles
 * field->set. Returns how many sides of squares are crossed. */
static int64_t compare(
  mcor_context* context, const mcor_input* input, const plane_field* field, int closed)
{
  const double iso = field->options->iso_values[0];
  CORE_SURFACE surface = core_extract(context, input, field->options);
  const int64_t edges = plane_compare(field, iso, &surface);
  plane_check_lines(field, &surface, closed);
  return edges;
}

static int64_t compare_set(
  mcor_context* context, const particle_set* set, const mcor_options* options, int axis, int closed)
{
  const mcor_input input = core_input(set);
  const plane_field field = { set, options, axis, NULL };
  return compare(context, &input, &field, closed);
}

/* Computes the areas of particles in a plane. The oracle's W is three-dimensional; W in the plane
 * is plane_factor h times as large. */
static void compute_volumes(particle_set* set, mcor_sph_kernel kernel)
{
  oracle_compute_volumes(set, (oracle_kernel)kernel, 2, NULL, NULL);
  for (int64_t i = 0; i < set->count; ++i)
  {
    set->volume[i] /= mcor_kernel_of(kernel)->plane_factor * set->smoothing_length[i];
  }
}

/* Checks random cases: all kernels, fields and precisions, noise, walls of all kinds, computed volumes, all options
 * that move lines. */
static void test_random_lines(void** state)
{
  const double shares[3] = { 0, 0.5, 0.8 };
  uint64_t seed = 11;
  for (int round = 0; round < 60; ++round)
  {
    const int axis = (int)(random_bits(&seed) % 3);
    CORE_SET set = plane_make(10 + (int)(random_bits(&seed) % 6), 0.45, 1 + 2 * random_unit(&seed),
      axis, 3 * random_unit(&seed), seed);
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = 2 * random_unit(&seed) - 1;
      set.solid[i] = random_bits(&seed) % 6 == 0;
    }
    const double iso = round % 3 == MCOR_WEIGHT_SUM ? 0.6 : 0.1;
    mcor_options options = plane_options(&iso);
    set.has_solids = round % 4 < 2;
    if (!set.has_solids)
    {
      memset(set.solid, 0, (size_t)set.count);
    }
    options.sph_kernel = (mcor_sph_kernel)(round / 3 % MCOR_SPH_KERNEL_COUNT);
    options.field = (mcor_field)(round % 3);
    options.precision =
      round / 3 < MCOR_SPH_KERNEL_COUNT || set.has_solids ? MCOR_FLOAT32 : MCOR_FLOAT64;
    options.cube_size_factor = 0.3 + 0.5 * random_unit(&seed);
    options.h_scale = round % 8 == 6 ? 0.8 : 1;
    options.vertex_threshold = round & 1 ? 0.5 : 0;
    options.topology = round & 2 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    options.boundary_detection =
      round % 5 == 3 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    options.wall_share = shares[round / 4 % 3];
    mcor_input input = core_input(&set);
    CORE_SET fluid = { 0 };
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.solid[i] ? (void)0 : particle_set_append(&fluid, &set, i);
    }
    if (round % 7 == 2)
    {
      compute_volumes(&set, options.sph_kernel);
      compute_volumes(&fluid, options.sph_kernel);
      input.volume = (mcor_array){ 0 };
    }
    input.ignore_solids = round % 8 == 1;
    const bool ends = set.has_solids && options.field == MCOR_WEIGHT_SUM &&
      options.wall_share > 0 && !input.ignore_solids; /* the free surface ends at walls */
    const bool fluid_alone =
      set.has_solids && (input.ignore_solids || (options.field == MCOR_WEIGHT_SUM && !ends));
    const plane_field field = { fluid_alone ? &fluid : &set, &options, axis, NULL };
    compare(*state, &input, &field, options.field == MCOR_WEIGHT_SUM && !ends);
  }
}

/* Checks lines with smoothing lengths that are estimated from particles about 1 apart. */
static void test_estimated_length(void** state)
{
  const double iso = 0.5;
  CORE_SET set = plane_make(16, 0.1, 1, 1, 2, 8);
  mcor_options options = plane_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  mcor_input input = core_input(&set);
  input.smoothing_length = (mcor_array){ 0 };
  input.estimate_smoothing_length = 1;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  const double h = surface.statistics.smoothing_length_min;
  CORE_CHECK(fabs(h - 1.3) < 0.1, h);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.smoothing_length[i] = h;
  }
  const plane_field field = { &set, &options, 1, NULL };
  assert_true(compare(*state, &input, &field, 1) > 60);
}

/* Checks squares of several sizes: smoothing lengths grow along u, or are mixed. Lines of the free surface are closed
 * across levels. */
static void test_adaptive_lines(void** state)
{
  uint64_t seed = 21;
  int deep = 0;
  for (int round = 0; round < 30; ++round)
  {
    const int axis = round % 3, mixed = round % 2;
    CORE_SET set = particle_set_make(220);
    for (int64_t i = 0; i < set.count; ++i)
    {
      double* x = set.position + 3 * i;
      const double u = random_unit(&seed), v = random_unit(&seed);
      const double h = pow(mixed ? 16 : 24, mixed ? random_unit(&seed) : u);
      x[axis] = 3;
      x[(axis + 1) % 3] = (mixed ? 40 : 30 * pow(24, u)) * (mixed ? u : 0.1);
      x[(axis + 2) % 3] = 3 + 2.5 * (mixed ? 8 : h) * (v - 0.5);
      set.smoothing_length[i] = h;
      set.volume[i] = 0.6 * h * h;
      set.scalar[i] = 2 * random_unit(&seed) - 1;
      set.solid[i] = random_bits(&seed) % 6 == 0;
    }
    const double iso = round % 3 == MCOR_WEIGHT_SUM ? 0.6 : 0.1;
    mcor_options options = plane_options(&iso);
    options.level_limit = round % 5 == 4 ? 2 : MCOR_CUBE_LEVELS - 1;
    set.has_solids = round % 4 == 1 && round % 3 != MCOR_WEIGHT_SUM;
    options.sph_kernel = round % 7 == 6 ? MCOR_M_PRIME_4 : MCOR_CUBIC_SPLINE;
    options.field = (mcor_field)(round % 3);
    options.cube_size_factor = 0.4 + 0.4 * random_unit(&seed);
    options.vertex_threshold = round & 1 ? 0.5 : 0;
    options.topology = round & 4 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    CORE_CHECK(
      compare_set(*state, &set, &options, axis, options.field == MCOR_WEIGHT_SUM) > 20, round);
    mcor_input input = core_input(&set);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    int levels = 0;
    for (int l = 0; l < MCOR_CUBE_LEVELS; ++l)
    {
      levels += surface.statistics.cells_of_level[l] > 2;
    }
    CORE_CHECK(levels > 1, round, levels);
    deep += levels > 2;
  }
  assert_true(deep > 10);
}

/* Checks squares of one size and of several in periods, and in boxes of a period. The reference has all images as
 * particles. */
static void test_periods(void** state)
{
  const double period = 32, ends[2] = { -16, 16 };
  uint64_t seed = 5;
  int several = 0;
  for (int round = 0; round < 18; ++round)
  {
    const int axis = round % 3, both = round % 2, boxed = round % 4 == 3, uniform = round % 5 == 4;
    CORE_SET set = particle_set_make(120);
    for (int64_t i = 0; i < set.count; ++i)
    {
      double* x = set.position + 3 * i;
      const double u = i < 2 ? (double)i : random_unit(&seed);
      const double h = pow(5, u);
      x[axis] = -2;
      x[(axis + 1) % 3] = 16 * u * (random_bits(&seed) % 2 ? 1 : -1);
      x[(axis + 2) % 3] = (both ? period : 12) * (random_unit(&seed) - 0.5);
      set.smoothing_length[i] = h;
      set.volume[i] = 2 * h * h;
      set.scalar[i] = 2 * random_unit(&seed) - 1;
      set.solid[i] = random_bits(&seed) % 7 == 0;
    }
    const double iso = round % 3 == MCOR_WEIGHT_SUM ? 0.6 : 0.1;
    mcor_options options = plane_options(&iso);
    set.has_solids = round % 6 == 1 && round % 3 != MCOR_WEIGHT_SUM;
    options.sph_kernel = round % 7 == 6 ? MCOR_M_PRIME_4 : (mcor_sph_kernel)(round % 5 ? 0 : 4);
    options.field = (mcor_field)(round / 3 % 3 == axis ? MCOR_SHEPARD : round % 3);
    options.cube_size = 0.5;
    options.level_limit = uniform ? 0 : MCOR_CUBE_LEVELS - 1;
    options.vertex_threshold = round & 1 ? 0.5 : 0;
    options.topology = round & 4 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    double region[4] = { -16, 16, both ? -16 : -INFINITY, both ? 16 : INFINITY };
    for (int a = 0; a < 1 + both; ++a)
    {
      memcpy(options.periodic + 2 * ((axis + 1 + a) % 3), ends, sizeof ends);
    }
    if (boxed)
    {
      const double box[4] = { -9.2, 20, -INFINITY, 3.4 };
      for (int i = 0; i < 4; ++i)
      {
        options.box[2 * ((axis + 1 + i / 2) % 3) + i % 2] = box[i];
        /* Along the first axis the box crosses a side of the period, so the library moves the period until it holds the
         * box. */
        region[i] = i < 2 ? box[i] : i % 2 ? fmin(region[i], box[i]) : fmax(region[i], box[i]);
      }
      options.box[2 * axis] = -INFINITY;
      options.box[2 * axis + 1] = INFINITY;
    }
    CORE_SET all = core_add_images(&set, options.periodic);
    const plane_field field = { &all, &options, axis, region };
    const mcor_input input = core_input(&set);
    CORE_CHECK(compare(*state, &input, &field, 0) > 20, round);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    CORE_CHECK(surface.statistics.highest_level == (uniform ? 0 : 2), round,
      surface.statistics.highest_level);
    several += surface.statistics.cells_of_level[0] > 2 && surface.statistics.cells_of_level[1] > 2;
  }
  assert_true(several > 10);
}

/* One particle, or particles on a line, count as lying in a plane if the caller says so. */
static void test_points_and_rows(void** state)
{
  const double iso = 0.1;
  for (int count = 1; count < 12; count += 10)
  {
    CORE_SET set = particle_set_make(count);
    for (int i = 0; i < count; ++i)
    {
      set.position[3 * i] = i;
      set.smoothing_length[i] = 1.3;
      set.volume[i] = 1;
    }
    mcor_options options = plane_options(&iso);
    mcor_input input = core_input(&set);
    options.field = MCOR_WEIGHT_SUM;
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.dimension, 3);
    options.dimension = 2;
    compare_set(*state, &set, &options, 2, 1);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_random_lines, test_estimated_length,
  test_adaptive_lines, test_periods, test_points_and_rows)
