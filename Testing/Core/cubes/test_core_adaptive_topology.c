/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes, topology by the field: noise on several levels is a manifold however faces and cells
 * are decided, and where one level is alone the decisions are those of uniform cubes. */

#include "core_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double noise(const double x[3])
{
  uint64_t seed = 0;
  memcpy(&seed, x, sizeof seed);
  return 2 * random_unit(&seed) - 1;
}

/* Blocks of noise beside each other, each of half the size of the one before. */
static core_set make_noise(int blocks, int n)
{
  core_set set = core_make_set((int64_t)blocks * n * n * n);
  double size = 1, begin = 0;
  for (int b = 0; b < blocks; ++b, begin += size * n, size /= 2)
  {
    core_set block = core_make_block(n, 0.4, 3 + (uint64_t)b, noise);
    for (int64_t i = 0; i < block.count; ++i)
    {
      const int64_t to = b * block.count + i;
      for (int a = 0; a < 3; ++a)
      {
        set.position[3 * to + a] =
          size * block.position[3 * i + a] + (a == 0 ? begin + 0.5 * size * n : 0);
      }
      set.smoothing_length[to] = 0.8 * size;
      set.volume[to] = size * size * size;
      set.scalar[to] = block.scalar[i];
    }
    core_free_set(&block);
  }
  return set;
}

static mcor_options noise_options(const double* iso, double cube_factor)
{
  mcor_options options = core_options(iso);
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  options.cube_size_factor = cube_factor;
  options.topology = MCOR_TOPOLOGY_FIELD;
  options.vertex_threshold = 0;
  return options;
}

/* The same vertices as by the table, connected in another way. */
static void noise_on_levels(void** state)
{
  static const double iso = 0.01, factors[] = { 1, 1.6 };
  core_set set = make_noise(3, 12);
  const mcor_input input = core_input(&set);
  for (int i = 0; i < 4; ++i)
  {
    mcor_options options = noise_options(&iso, factors[i & 1]);
    options.precision = i < 2 ? MCOR_FLOAT32 : MCOR_FLOAT64;
    mcor_surface field = core_extract(*state, &input, &options);
    options.topology = MCOR_TOPOLOGY_TABLE;
    mcor_surface table = core_extract(*state, &input, &options);
    mesh_report by_field = core_check_pinched_mesh(&field),
                by_table = core_check_pinched_mesh(&table);
    core_check_decisions(&field.statistics);
    assert_true(field.statistics.triangles_of_level[0] > 100);
    assert_true(field.statistics.triangles_of_level[1] > 100);
    assert_int_equal(table.statistics.ambiguous_faces, 0);
    assert_int_equal(table.point_count, field.point_count);
    assert_memory_equal(table.points, field.points, (size_t)table.point_count * 3 * sizeof(double));
    assert_int_equal(by_table.boundary_edges, by_field.boundary_edges);
    mesh_free_report(&by_field);
    mesh_free_report(&by_table);
    mcor_free_surface(&field);
    mcor_free_surface(&table);
  }
  core_free_set(&set);
}

/* Trimmed, in any order and form, and in boxes. */
static void order_form_and_boxes(void** state)
{
  static const double iso = 0.01;
  core_set set = make_noise(3, 8);
  int64_t* order = core_make_order(set.count, 9);
  core_set shuffled = core_permute(&set, order);
  const mcor_input input = core_input(&set), other = core_input(&shuffled);
  mcor_options options = noise_options(&iso, 1);
  options.vertex_threshold = 0.5;
  mcor_surface whole = core_extract(*state, &input, &options);
  const uint64_t hash = core_hash(&whole);
  mesh_report report = core_check_pinched_mesh(&whole);
  mesh_free_report(&report);
  const char* forms[] = { "cpu", "gpu" };
  for (int f = 0; f < 2; ++f)
  {
    mcor_context* context;
    core_create_form(&context, forms[f]);
    mcor_surface surface = core_extract(context, &other, &options);
    assert_true(core_hash(&surface) == hash);
    mcor_free_surface(&surface);
    mcor_free_context(context);
  }
  int64_t triangles = 0, joined = 0;
  for (int part = 0; part < 2; ++part)
  {
    const double box[6] = { part ? 7.3 : -INFINITY, part ? INFINITY : 7.3, -INFINITY, INFINITY,
      -INFINITY, INFINITY };
    memcpy(options.box, box, sizeof box);
    mcor_surface surface = core_extract(*state, &input, &options);
    triangles += surface.triangle_count;
    joined += surface.statistics.joined_faces;
    mcor_free_surface(&surface);
  }
  assert_int_equal(triangles, whole.triangle_count);
  assert_true(joined >= whole.statistics.joined_faces); /* those between both twice */
  mcor_free_surface(&whole);
  free(order);
  core_free_set(&set);
  core_free_set(&shuffled);
}

/* Far from the second size, what the field decides does not depend on whether there is one. */
static void one_level_alone(void** state)
{
  static const double iso = 0.01;
  core_set set = make_noise(1, 12), both = core_make_set(set.count + 1);
  for (int64_t i = 0; i <= set.count; ++i)
  {
    const int64_t from = i < set.count ? i : 0;
    memcpy(both.position + 3 * i, set.position + 3 * from, 3 * sizeof(double));
    both.smoothing_length[i] = set.smoothing_length[from];
    both.volume[i] = set.volume[from];
    both.scalar[i] = set.scalar[from];
  }
  both.position[3 * set.count] += 100;
  both.smoothing_length[set.count] *= 4;
  const mcor_input input = core_input(&set), adaptive = core_input(&both);
  const mcor_options options = noise_options(&iso, 1);
  mcor_surface one = core_extract(*state, &input, &options);
  mcor_surface two = core_extract(*state, &adaptive, &options);
  const mcor_statistics *s = &one.statistics, *t = &two.statistics;
  core_check_decisions(t);
  assert_int_equal(s->highest_level, 0);
  assert_int_equal(t->highest_level, 2);
  assert_int_equal(s->ambiguous_faces, t->ambiguous_faces);
  assert_int_equal(s->joined_faces, t->joined_faces);
  assert_int_equal(s->ambiguous_cells, t->ambiguous_cells);
  assert_int_equal(s->tunnels, t->tunnels);
  assert_int_equal(one.triangle_count, two.triangle_count);
  mesh_report report = core_check_pinched_mesh(&one), other = core_check_pinched_mesh(&two);
  CORE_CHECK(
    fabs(report.area - other.area) < 1e-6 * report.area, "area %g, %g", report.area, other.area);
  mesh_free_report(&report);
  mesh_free_report(&other);
  mcor_free_surface(&one);
  mcor_free_surface(&two);
  core_free_set(&set);
  core_free_set(&both);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(noise_on_levels),
    cmocka_unit_test(order_form_and_boxes), cmocka_unit_test(one_level_alone) };
  return cmocka_run_group_tests_name("adaptive_topology", tests, core_set_up, core_tear_down);
}
