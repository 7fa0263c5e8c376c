/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Surfaces of adaptive cubes: closed across levels, the same whatever the order, the form of the
 * kernels and what a context has kept, and those of uniform cubes where there is one level. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static mcor_options adaptive_options(const double* iso, mcor_field field)
{
  mcor_options options = core_options(iso);
  options.field = field;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  return options;
}

static int levels_used(const mcor_surface* surface)
{
  int levels = 0;
  int64_t cells = 0, triangles = 0;
  for (int l = 0; l < MCOR_CUBE_LEVELS; ++l)
  {
    levels += surface->statistics.cells_of_level[l] > 0;
    cells += surface->statistics.cells_of_level[l];
    triangles += surface->statistics.triangles_of_level[l];
  }
  assert_int_equal(cells, surface->statistics.cells_used);
  assert_int_equal(triangles, surface->statistics.triangles_before_trimming);
  return levels;
}

static void closed_across_levels(void** state)
{
  static const double half = 0.5;
  const double ratios[] = { 10, 200 };
  for (int i = 0; i < 2; ++i)
  {
    core_set set = core_make_graded(ratios[i], 0.3);
    const mcor_input input = core_input(&set);
    const mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
    mcor_surface surface = core_extract(*state, &input, &options);
    assert_in_range(levels_used(&surface), i == 0 ? 3 : 6, 9);
    mesh_report report = core_check_mesh(&surface);
    assert_int_equal(report.boundary_edges, 0);
    assert_int_equal(surface.statistics.vertices_above_tolerance, 0);
    mesh_free_report(&report);
    mcor_free_surface(&surface);
    core_free_set(&set);
  }
}

/* Whether every vertex is on the surface and where the trim boundary is flagged, all levels alike. */
static void trimmed(void** state)
{
  static const double isos[2] = { 0.1, 0.3 };
  core_set set = core_make_graded(30, 0.3);
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(isos, MCOR_SHEPARD);
  options.iso_count = 2;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_RESIDUAL | MCOR_OUT_WEIGHT_SUM;
  mcor_surface surface = core_extract(*state, &input, &options);
  assert_in_range(levels_used(&surface), 3, 9);
  core_check_flags(&surface);
  assert_int_equal(surface.statistics.vertices_above_tolerance, 0);
  int64_t cuts = 0, linear = 0;
  for (int64_t i = 0; i < surface.point_count; ++i)
  {
    if (surface.boundary_flag[i] == 1)
    {
      ++cuts;
      CORE_CHECK(fabs(surface.weight_sum[i] - 0.5) < 2e-5, "weight %g", surface.weight_sum[i]);
    }
    linear += surface.boundary_flag[i] == 2;
  }
  assert_true(cuts > 20 * linear && cuts > 100);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

static void one_level_is_uniform(void** state)
{
  static const double iso = 0;
  core_set set = core_make_block(9, 0.3, 3, core_ball);
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&iso, MCOR_SHEPARD);
  mcor_surface adaptive = core_extract(*state, &input, &options);
  options.level_limit = 0;
  mcor_surface uniform = core_extract(*state, &input, &options);
  assert_true(core_hash(&adaptive) == core_hash(&uniform) && uniform.point_count > 100);
  mcor_free_surface(&adaptive);
  mcor_free_surface(&uniform);
  core_free_set(&set);
}

/* Vertices of adaptive cubes are roots on lines of the finest lattice: the uniform surface passes
 * there. */
static void roots_of_the_finest_lattice(void** state)
{
  static const double half = 0.5;
  core_set set = core_make_graded(6, 0.4);
  const mcor_input input = core_input(&set);
  const mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
  mcor_surface surface = core_extract(*state, &input, &options);
  const double cube = surface.statistics.cube_size;
  for (int64_t i = 0; i < surface.point_count; ++i)
  {
    int whole = 0;
    for (int a = 0; a < 3; ++a)
    {
      const double at = surface.points[3 * i + a] / cube;
      whole += fabs(at - floor(at + 0.5)) < 1e-9;
    }
    CORE_CHECK(whole >= 2, "point %d is on no line", (int)i);
  }
  mcor_free_surface(&surface);
  core_free_set(&set);
}

static void order_form_and_reuse(void** state)
{
  static const double half = 0.5, isos[2] = { 0.3, 0.1 };
  core_set set = core_make_graded(12, 0.4);
  int64_t* order = core_make_order(set.count, 9);
  core_set shuffled = core_permute(&set, order);
  mcor_input input = core_input_to_keep(&set);
  const mcor_input other = core_input(&shuffled);
  mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
  mcor_surface surface = core_extract(*state, &input, &options);
  const uint64_t hash = core_hash(&surface);
  const int64_t seeds = surface.statistics.seed_cells;
  assert_in_range(seeds, surface.statistics.cells_used,
    64 * (int64_t)((mcor_context*)*state)->adaptive.count - 1);
  mcor_free_surface(&surface);
  surface = core_extract(*state, &other, &options);
  assert_true(core_hash(&surface) == hash);
  mcor_free_surface(&surface);
  const char* forms[] = { "cpu", "gpu" };
  for (int f = 0; f < 2; ++f)
  {
    mcor_context* context;
    core_create_form(&context, forms[f]);
    surface = core_extract(context, &input, &options);
    assert_true(core_hash(&surface) == hash);
    assert_int_equal(
      surface.statistics.seed_cells, seeds); /* though the one form evaluates earlier */
    mcor_free_surface(&surface);
    mcor_free_context(context);
  }
  options = adaptive_options(isos, MCOR_SHEPARD);
  surface = core_extract(*state, &input, &options); /* keeps what the next one uses */
  mcor_free_surface(&surface);
  options.iso_values = isos + 1;
  mcor_surface reused = core_extract(*state, &input, &options);
  input.particles_version = input.scalar_version = 0;
  surface = core_extract(*state, &input, &options);
  assert_true(core_hash(&surface) == core_hash(&reused) && surface.point_count > 100);
  assert_int_equal(surface.statistics.seed_cells, reused.statistics.seed_cells);
  mcor_free_surface(&surface);
  mcor_free_surface(&reused);
  free(order);
  core_free_set(&set);
  core_free_set(&shuffled);
}

/* Of a lattice on which values are above in one half and below in the other, nodes are evaluated between
 * both alone, and where the weight is low; those of leaves that are certain next to these where an edge is
 * crossed. */
static void few_nodes_are_evaluated(void** state)
{
  static const double iso = 0.1;
  mcor_context* context = *state;
  core_set set = core_make_graded(16, 0.4);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = set.position[3 * i + 2] > 0.3 ? 1 : -1;
  }
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&iso, MCOR_SHEPARD);
  mcor_surface surface = core_extract(context, &input, &options);
  const int64_t nodes = surface.statistics.nodes_evaluated;
  assert_in_range(nodes, 64, 38 * (int64_t)context->tree.leaf_count); /* of 64 */
  assert_true(surface.statistics.cells_used > 100);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

/* Two groups whose sizes, and distance, differ by thousands: nothing is of the size of the finest
 * lattice between. */
static void far_apart(void** state)
{
  static const double half = 0.5;
  core_set set = core_make_set(2 * 216);
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double size = i < 216 ? 1 : 4000;
    const int64_t k = i % 216, at[3] = { k % 6, k / 6 % 6, k / 36 };
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = size * ((double)at[a] + (a == 0 && i >= 216 ? 6 : 0));
    }
    set.smoothing_length[i] = 1.3 * size;
    set.volume[i] = size * size * size;
  }
  const mcor_input input = core_input(&set);
  const mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
  mcor_surface surface = core_extract(*state, &input, &options);
  mesh_report report = core_check_mesh(&surface);
  assert_int_equal(report.components, 2);
  assert_int_equal(report.boundary_edges, 0);
  assert_true(surface.triangle_count < 20000);
  mesh_free_report(&report);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

/* Boxes side by side share no triangle and leave none out. */
static void boxes_make_the_whole(void** state)
{
  static const double iso = 0.2;
  core_set set = core_make_graded(12, 0.4);
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&iso, MCOR_SHEPARD);
  mcor_surface whole = core_extract(*state, &input, &options);
  int64_t triangles = 0, cells = 0;
  double area = 0;
  for (int part = 0; part < 4; ++part)
  {
    const double box[6] = { part & 1 ? -2.3 : -INFINITY, part & 1 ? INFINITY : -2.3, -INFINITY,
      INFINITY, part & 2 ? 0.7 : -INFINITY, part & 2 ? INFINITY : 0.7 };
    memcpy(options.box, box, sizeof box);
    mcor_surface surface = core_extract(*state, &input, &options);
    assert_true(surface.triangle_count > 0 && surface.triangle_count < whole.triangle_count);
    mesh_report report = core_check_mesh(&surface);
    triangles += surface.triangle_count;
    cells += surface.statistics.cells_used;
    area += report.area;
    assert_in_range(levels_used(&surface), 1, 9);
    mesh_free_report(&report);
    mcor_free_surface(&surface);
  }
  mesh_report report = core_check_mesh(&whole);
  assert_int_equal(triangles, whole.triangle_count);
  assert_int_equal(cells, whole.statistics.cells_used);
  CORE_CHECK(fabs(area - report.area) < 1e-9 * report.area, "area %g, %g", area, report.area);
  mesh_free_report(&report);
  mcor_free_surface(&whole);
  core_free_set(&set);
}

/* Cubes far smaller than all particles: a sentence, at once. */
static void too_many_leaves(void** state)
{
  static const double half = 0.5;
  mcor_context* context = *state;
  core_set set = core_make_graded(12, 0.4);
  const mcor_input input = core_input(&set);
  mcor_options options = adaptive_options(&half, MCOR_WEIGHT_SUM);
  options.cube_size_factor = 0.002;
  mcor_surface surface = { 0 };
  assert_int_equal(mcor_extract(context, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  CORE_CHECK(strstr(mcor_last_error(context), "too large"), "%s", mcor_last_error(context));
  core_free_set(&set);
}

static void refusal(void** state)
{
  static const double iso = 0;
  mcor_context* context = *state;
  core_set set = core_make_block(4, 0, 1, core_ball);
  const mcor_input input = core_input(&set);
  mcor_surface surface = { 0 };
  mcor_options options = adaptive_options(&iso, MCOR_SHEPARD);
  options.level_limit = MCOR_CUBE_LEVELS;
  assert_int_equal(mcor_extract(context, &input, &options, &surface), MCOR_INVALID_ARGUMENT);
  CORE_CHECK(strstr(mcor_last_error(context), "level limit"), "%s", mcor_last_error(context));
  assert_int_equal(surface.point_count, 0);
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(closed_across_levels),
    cmocka_unit_test(trimmed), cmocka_unit_test(one_level_is_uniform),
    cmocka_unit_test(roots_of_the_finest_lattice), cmocka_unit_test(order_form_and_reuse),
    cmocka_unit_test(few_nodes_are_evaluated), cmocka_unit_test(far_apart),
    cmocka_unit_test(boxes_make_the_whole), cmocka_unit_test(too_many_leaves),
    cmocka_unit_test(refusal) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
