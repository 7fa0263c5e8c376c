/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests periods. Results are compared with results without a period for the same particles and all their images.
 * Opposite sides of the surface are compared with each other. */

#include "core_period.h"
#include "oracle_period.h"

#define PI 3.14159265358979323846

/* Returns the number of the surface's point that is within 1e-4 of x, or -1. */
static int64_t find_point(const mcor_surface* s, const double x[3])
{
  for (int64_t i = 0; i < s->point_count; ++i)
  {
    const double* p = s->points + 3 * i;
    if (fabs(p[0] - x[0]) < 1e-4 && fabs(p[1] - x[1]) < 1e-4 && fabs(p[2] - x[2]) < 1e-4)
    {
      return i;
    }
  }
  return -1;
}

/* Checks that both surfaces have the same number of triangles, and that each point has a partner in the other surface
 * with about the same normal. */
static void check_same(const char* name, const mcor_surface* s, const mcor_surface* expected)
{
  CORE_CHECK(s->triangle_count == expected->triangle_count &&
      s->point_count == expected->point_count && s->triangle_count > 300,
    name, s->triangle_count, s->point_count, expected->triangle_count, expected->point_count);
  for (int64_t i = 0; i < s->point_count; ++i)
  {
    const int64_t other = find_point(expected, s->points + 3 * i);
    CORE_CHECK(other >= 0, name, s->points[3 * i], s->points[3 * i + 1], s->points[3 * i + 2]);
    for (int a = 0; a < 3; ++a)
    {
      assert_true(fabs(s->normals[3 * i + a] - expected->normals[3 * other + a]) < 1e-3);
    }
  }
}

/* Checks that the surface has the same points on opposite sides, to the last bit, unless they are
 * trimmed. */
static void check_sides(const char* name, const mcor_surface* s, const mcor_options* options)
{
  CORE_REPORT report = core_check_mesh(s);
  const oracle_seam seam = oracle_check_seam(options, s->statistics.cube_edges, s, &report);
  CORE_CHECK(seam.joined > 20 && seam.open == 0 && seam.torn == 0 && seam.different == 0, name,
    seam.joined, seam.open, seam.torn, seam.different);
}

static void check_images(
  mcor_context* context, const char* name, const particle_set* set, const mcor_options* options)
{
  const mcor_input input = core_input(set);
  CORE_SURFACE surface = core_extract(context, &input, options);
  check_sides(name, &surface, options);
  CORE_SET all = core_add_images(set, options->periodic);
  const mcor_input other = core_input(&all);
  mcor_options plain = *options;
  memset(plain.periodic, 0, sizeof plain.periodic);
  plain.seeds = MCOR_COMPLETE; /* growth from pairs also finds all of the surface */
  plain.cube_size = surface.statistics.cube_size;
  plain.level_limit = surface.statistics.highest_level;
  for (int a = 0; a < 3; ++a)
  {
    const int open = options->periodic[2 * a] == options->periodic[2 * a + 1];
    plain.box[2 * a] = open ? -INFINITY : options->periodic[2 * a];
    plain.box[2 * a + 1] = open ? INFINITY : options->periodic[2 * a + 1];
  }
  CORE_SURFACE expected = core_extract(context, &other, &plain);
  check_same(name, &surface, &expected);
}

/* With MCOR_PAIRS, the surface starts between particles on different sides of the iso value. Here such pairs are in one
 * place alone, away from the period's sides. From there the surface must grow through the sides until it is whole. */
static void pairs_grow_around(void** state)
{
  const double iso = 0.2, along[6] = { 0, 12, 0, 8, 0, 0 };
  const int slab[3] = { 12, 8, 10 };
  CORE_SET set = core_make_period(slab, 6);
  mcor_options options = core_period_options(&iso, along);
  options.seeds = MCOR_PAIRS;
  options.h_scale = 2;
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double x = set.position[3 * i];
    set.smoothing_length[i] = x > 1.5 && x < 3.5 ? 1.05 : 0.6;
    set.scalar[i] = sin(2 * PI * (x / 12 + set.position[3 * i + 1] / 8));
  }
  check_images(*state, "pairs", &set, &options);
}

/* Sets smoothing lengths that grow, up to `most`, with the distance from the nearest image of (0, 0, middle). */
static void grade_lengths(particle_set* set, double side, double middle, double most)
{
  for (int64_t p = 0; p < set->count; ++p)
  {
    const double* x = set->position + 3 * p;
    const double dx = fmin(x[0], side - x[0]), dy = fmin(x[1], side - x[1]), dz = x[2] - middle;
    set->smoothing_length[p] = fmin(0.6 * exp2(sqrt(dx * dx + dy * dy + dz * dz) / 2.5), most);
  }
}

/* Checks adaptive cubes: levels match across the period's sides, even if the finest particles are at a side. If a
 * period is no whole number of large cubes, fewer levels are used. */
static void adaptive_cubes(void** state)
{
  const double iso = 0.2, half = 0.5;
  const int length[3] = { 16, 16, 8 }, cube[3] = { 14, 14, 14 };
  const double along[6] = { 0, 16, 0, 16, 0, 0 }, around[6] = { 0, 14, 0, 14, 0, 14 };
  for (int i = 0; i < 3; ++i)
  {
    CORE_SET set = core_make_period(i < 2 ? length : cube, 5);
    grade_lengths(&set, i < 2 ? 16 : 14, 4, 3.3);
    mcor_options options = core_period_options(i == 1 ? &half : &iso, i < 2 ? along : around);
    options.level_limit = MCOR_CUBE_LEVELS - 1;
    options.cube_size = 0.3;
    options.field = i == 1 ? MCOR_WEIGHT_SUM : MCOR_SHEPARD;
    options.precision = i == 1 ? MCOR_FLOAT64 : MCOR_FLOAT32;
    options.node_threshold = options.vertex_threshold = i == 0 ? 0.1 : 0;
    const mcor_input input = core_input(&set);
    mcor_surface surface = core_extract(*state, &input, &options);
    assert_int_equal(surface.statistics.highest_level, i < 2 ? 2 : 1);
    assert_true(surface.statistics.cells_of_level[1] > 100);
    mcor_free_surface(&surface);
    if (i == 0) /* caps need cubes of one size */
    {
      options.capping = 1;
      surface = core_extract(*state, &input, &options);
      assert_int_equal(surface.statistics.highest_level, 0);
      assert_true(surface.statistics.cap_triangles > 0);
      mcor_free_surface(&surface);
      options.capping = 0;
    }
    check_images(*state, i == 0 ? "adaptive" : i == 1 ? "free" : "fewer levels", &set, &options);
  }
}

/* Checks that particles moved by some periods make the same surface. The coordinates have so few bits that nothing is
 * rounded. */
static void particles_elsewhere(void** state)
{
  const double iso = 0.2, around[6] = { 0, 8, 0, 8, 0, 8 };
  const int cube[3] = { 8, 8, 8 };
  CORE_SET set = core_make_period(cube, 7);
  const mcor_options options = core_period_options(&iso, around);
  const mcor_input input = core_input(&set);
  for (int64_t i = 0; i < 3 * set.count; ++i)
  {
    set.position[i] = floor(set.position[i] * 1024) / 1024;
  }
  const uint64_t expected = core_hash_of(*state, &input, &options);
  for (int64_t i = 0; i < 3 * set.count; ++i)
  {
    set.position[i] += 8 * (double)(i % 5 - 2);
  }
  assert_true(core_hash_of(*state, &input, &options) == expected);
}

/* Checks that cubes fit periods of different lengths, and that impossible periods are refused with
 * a message. */
static void lengths(void** state)
{
  const struct
  {
    double period[6], edge[3];
    mcor_status status;
    const char* words; /* words of the refusal */
  } cases[] = { { { 0, 8, 0, 8, 0, 8 }, { 8.0 / 13, 8.0 / 13, 8.0 / 13 }, MCOR_OK, NULL },
    { { 0, 8, 0, 6, 0, 0 }, { 0.5, 0.5, 0.5 }, MCOR_OK, NULL },
    { { -4, 4, 0, 10, -1, 11 }, { 0.5, 0.5, 0.5 }, MCOR_OK, NULL },
    { { 0, 8, 0, 8.123456, 0, 0 }, { 8.0 / 13, 8.123456 / 13, 8.123456 / 13 }, MCOR_OK, NULL },
    { { 0.1, 8.1, -3, 6.000001, 0, 8.123456 }, { 8.0 / 13, 9.000001 / 14, 8.123456 / 13 }, MCOR_OK,
      NULL },
    { { 0, 1e12, 0, 8, 0, 0 }, { 0 }, MCOR_OUT_OF_CAPACITY, "along x" },
    { { -1.7e308, 1.7e308, 0, 8, 0, 0 }, { 0 }, MCOR_OUT_OF_CAPACITY, "along x" },
    { { 0, 5e-324, 0, 0, 0, 0 }, { 0 }, MCOR_INVALID_ARGUMENT, "PERIOD_TOO_SHORT" },
    { { 0, 0.5, 0, 8, 0, 8 }, { 0 }, MCOR_INVALID_ARGUMENT, "PERIOD_TOO_SHORT|along x is 0.5" },
    { { 0, 8, 0, -1, 0, 8 }, { 0 }, MCOR_INVALID_ARGUMENT, "PERIOD_ILLEGAL|along y" },
    { { 0, NAN, 0, 8, 0, 8 }, { 0 }, MCOR_INVALID_ARGUMENT, "along x" } };
  const double iso = 0.2;
  const int cube[3] = { 8, 8, 8 };
  CORE_SET set = core_make_period(cube, 5);
  mcor_input input = core_input(&set);
  input.smoothing_length = (mcor_array){ .constant = 1.3 };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    const mcor_options options = core_period_options(&iso, cases[i].period);
    CORE_SURFACE surface = { 0 };
    const mcor_status status = mcor_extract(*state, &input, &options, &surface);
    assert_int_equal(status, cases[i].status);
    if (cases[i].words)
    {
      CORE_CHECK(core_told(*state, cases[i].words), mcor_last_error(*state));
      continue;
    }
    const double* edge = cases[i].edge;
    assert_true(fabs(surface.statistics.cube_size - fmin(edge[0], fmin(edge[1], edge[2]))) < 1e-12);
    for (int a = 0; a < 3; ++a)
    {
      const double period = cases[i].period[2 * a + 1] - cases[i].period[2 * a];
      assert_true(fabs(surface.statistics.cube_edges[a] - edge[a]) < 1e-12);
      assert_true(
        period == 0 || fabs((double)surface.statistics.lattice_cells[a] * edge[a] - period) < 1e-9);
    }
  }
}

/* Checks adaptive cubes that have a different edge along each axis. The surface must be closed except at the sides,
 * where each point must have a partner. Residuals must be below 1e-5, the area within 2 % of uniform cubes' area. */
static void adaptive_unequal(void** state)
{
  const double iso = 0.2, half = 0.5;
  const int length[3] = { 16, 16, 16 };
  for (int i = 0; i < 3; ++i)
  {
    double around[6] = { 0, 16, 0, 16, 0, 16 };
    CORE_SET set = core_make_period(length, 5);
    grade_lengths(&set, 16, 8, 3);
    core_stretch_period(&set, around);
    around[4] = i == 0 ? around[4] : 0;
    around[5] = i == 0 ? around[5] : 0;
    mcor_options options = core_period_options(i == 1 ? &half : &iso, around);
    options.level_limit = MCOR_CUBE_LEVELS - 1;
    options.cube_size = 0.3;
    options.field = i == 1 ? MCOR_WEIGHT_SUM : MCOR_SHEPARD;
    options.precision = i == 2 ? MCOR_FLOAT64 : MCOR_FLOAT32;
    const mcor_input input = core_input(&set);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    const double* edge = surface.statistics.cube_edges;
    assert_true(edge[0] != edge[1] && (i > 0 || edge[1] != edge[2]));
    assert_true(surface.statistics.highest_level >= 1);
    const int64_t* cells = surface.statistics.cells_of_level;
    const int levels = (cells[0] > 20) + (cells[1] > 20) + (cells[2] > 20);
    CORE_CHECK(levels >= (i == 1 ? 1 : 2), cells[0], cells[1], cells[2]);
    CORE_CHECK(surface.statistics.residual_max < 1e-5, surface.statistics.residual_max);
    check_sides("adaptive, unequal", &surface, &options);
    options.level_limit = 0;
    CORE_SURFACE uniform = core_extract(*state, &input, &options);
    const double area = surface.statistics.area, expected = uniform.statistics.area;
    CORE_CHECK(fabs(area / expected - 1) < 0.02, area, expected);
  }
}

/* Checks a period that is 48 cubes long except for rounding in the last digit. */
static void rounded_length(void** state)
{
  static const double around[6] = { 0, 0.1 * 3 * 16, 0, 0.1 * 3 * 16, 0, 0.1 * 3 * 16 };
  const double iso = 0.5;
  CORE_SET set = core_make_random(60, 4, 0.3, 0.3, 4);
  const mcor_input input = core_input(&set);
  mcor_options options = core_period_options(&iso, around);
  assert_true(around[1] / 0.1 > 48);
  options.field = MCOR_WEIGHT_SUM;
  options.cube_size = 0.1;
  CORE_SURFACE surface = core_extract(*state, &input, &options);
  CORE_CHECK(fabs(surface.statistics.cube_size - 0.1) < 1e-9, surface.statistics.cube_size);
}

/* Checks sides with very many nodes. Caps may take memory and time only where particles reach a side. A call that would
 * take all memory, or hours, must be refused at its start. */
static void large_sides(void** state)
{
  const double iso = 0.5, half = 0.5;
  CORE_SET set = core_make_random(200, 1, 0.05, 0.05, 9);
  mcor_input input = core_input(&set);
  const double around[6] = { -0.5, 0.5, -0.5, 0.5, -0.5, 0.5 };
  mcor_options options = core_period_options(&half, around);
  CORE_SURFACE surface;
  options.field = MCOR_WEIGHT_SUM;
  options.capping = 1;
  options.cube_size = 1e-4;
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  assert_true(core_told(*state, "CAP_NODES"));
  options.capping = 0;
  options.iso_values = &iso;
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.volume[j] = 0.02;
  }
  assert_int_equal(mcor_extract(*state, &input, &options, &surface), MCOR_OUT_OF_CAPACITY);
  assert_true(core_told(*state, "BLOCKS_TOO_MANY"));
  /* There are 40,000 nodes along a side. */
  options.capping = 1;
  options.cube_size = 2.5e-5;
  for (int64_t j = 0; j < set.count; ++j)
  {
    set.smoothing_length[j] = 5e-5;
    set.volume[j] = 4e-13;
    set.position[3 * j] = j % 2 ? 0.5 : set.position[3 * j];
  }
  surface = core_extract(*state, &input, &options);
  CORE_CHECK(surface.statistics.cap_triangles > 1000, surface.statistics.cap_triangles);
  CORE_REPORT report;
  mesh_check(
    surface.points, surface.point_count, surface.triangles, surface.triangle_count, &report);
  assert_int_equal(report.boundary_edges, 0);
}

/* Checks that a box across a side of the period has the same surface if the period is moved so that no side cuts the
 * box. */
static void test_box_across(void** state)
{
  static const double periods[2][6] = { { 0, 12, -3, 7, 0, 11 }, { -6, 6, -5, 5, 0, 11 } };
  static const double box[6] = { -4, 4, -4.5, 4.5, 2, 9 };
  const int length[3] = { 12, 10, 11 };
  const double iso = 0.1;
  CORE_SET set = core_make_period(length, 4);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  memcpy(options.box, box, sizeof box);
  memcpy(options.periodic, periods[0], sizeof periods[0]);
  CORE_SURFACE across = core_extract(*state, &input, &options);
  memcpy(options.periodic, periods[1], sizeof periods[1]);
  CORE_SURFACE moved = core_extract(*state, &input, &options);
  assert_true(across.triangle_count > 1000 && core_hash(&across) == core_hash(&moved));
  options.box[1] = 9; /* The box is longer than the period, which therefore stays. */
  mcor_move_period(&options);
  assert_true(options.periodic[0] == -6 && options.periodic[1] == 6);
}

CORE_MAIN(core_set_up, core_tear_down, pairs_grow_around, adaptive_cubes, adaptive_unequal,
  particles_elsewhere, lengths, rounded_length, large_sides, test_box_across)
