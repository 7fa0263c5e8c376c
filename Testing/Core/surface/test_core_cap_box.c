/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps at the sides of a box: they close what it cuts, and leave the surface's own points and triangles as they are. */

#include "cap_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double iso = 0.5;

static mcor_options box_options(int capping, const double box[6])
{
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.capping = capping;
  memcpy(options.box, box, sizeof options.box);
  return options;
}

/* Where the sides of its cells are. */
static void find_planes(const double box[6], double cube, double planes[6])
{
  for (int s = 0; s < 6; ++s)
  {
    planes[s] = isinf(box[s]) ? box[s] : ceil(box[s] / cube - 0.5) * cube;
  }
}

/* Fluid of a lattice, and holes in it. */
static core_set make_sponge(void)
{
  core_set set = core_make_set(16 * 16 * 16);
  int64_t n = 0;
  for (int i = 0; i < 16 * 16 * 16; ++i)
  {
    const double x[3] = { i % 16 - 7.5, i / 16 % 16 - 7.5, i / 256 - 7.5 };
    if (sin(0.7 * x[0]) + sin(0.8 * x[1]) + sin(0.6 * x[2] + 1) > -0.8)
    {
      memcpy(set.position + 3 * n, x, sizeof x);
      set.smoothing_length[n] = 1.3;
      set.volume[n++] = 1;
    }
  }
  set.count = n;
  return set;
}

/* Points of caps alone are on planes; their normals point out. */
static void check_caps(const mcor_surface* open, const mcor_surface* closed, const double planes[6])
{
  for (int64_t p = open->point_count; p < closed->point_count; ++p)
  {
    double out = -1;
    for (int s = 0; s < 6; ++s)
    {
      if (fabs(closed->points[3 * p + s / 2] - planes[s]) < 1e-6)
      {
        out = fmax(out, (s % 2 ? 1 : -1) * closed->normals[3 * p + s / 2]);
      }
    }
    CORE_CHECK(out > 0.5, "point %lld at %g %g %g: its normal points out by %g", (long long)p,
      closed->points[3 * p], closed->points[3 * p + 1], closed->points[3 * p + 2], out);
  }
}

static void check_box(
  mcor_context* context, const core_set* set, const double box[6], const double periodic[6])
{
  const mcor_input input = core_input(set);
  mcor_options options = box_options(MCOR_CAP_NONE, box);
  options.level_limit = 0; /* as with caps */
  options.outputs |= MCOR_OUT_NORMALS;
  memcpy(options.periodic, periodic, sizeof options.periodic);
  mcor_surface open, closed;
  CORE_OK(context, mcor_extract(context, &input, &options, &open));
  options.capping = MCOR_CAP_BOX;
  CORE_OK(context, mcor_extract(context, &input, &options, &closed));
  assert_true(!open.statistics.is_closed);
  CORE_CHECK(
    closed.statistics.is_closed, "%lld triangles are open", (long long)closed.triangle_count);
  cap_check_prefix(&open, &closed);
  double planes[6];
  find_planes(box, closed.statistics.cube_size, planes);
  for (int s = 0; s < 6; ++s) /* beyond the block there is nothing */
  {
    planes[s] = isinf(planes[s]) ? (s % 2 ? 10 : -10) : planes[s];
    if (isinf(box[s]) && periodic[1] > 0 && s < 2) /* a period begins at a node */
    {
      const double cube = closed.statistics.cube_size;
      planes[s] = ceil(periodic[0] / cube - 0.5) * cube + s * (periodic[1] - periodic[0]);
    }
  }
  check_caps(&open, &closed, planes);
  if (periodic[1] == 0)
  {
    cap_check_volume(&closed, set, planes, iso, 1);
  }
  mcor_free_surface(&open);
  mcor_free_surface(&closed);
}

static void test_sponge(void** state)
{
  core_set set = make_sponge();
  const double none[6] = { 0 }, period[6] = { -8, 8, 0, 0, 0, 0 };
  const double boxes[][6] = { { -3.3, 4.1, -5.2, 3.7, -6.6, 2.9 },
    { -INFINITY, 1.3, -INFINITY, INFINITY, -INFINITY, INFINITY },
    { 0.4, INFINITY, -2.2, INFINITY, -INFINITY, 5.05 } };
  for (size_t b = 0; b < sizeof boxes / sizeof boxes[0]; ++b)
  {
    check_box(*state, &set, boxes[b], none);
    check_box(*state, &set, boxes[b], period);
  }
  core_free_set(&set);
}

/* A box within the fluid: all its sides, and nothing else. */
static void test_inside(void** state)
{
  core_set set = make_sponge();
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] = 1000; /* holes, too, are fluid */
  }
  const mcor_input input = core_input(&set);
  const double box[6] = { -3, 3.2, -2, 2, -1, 4 };
  const mcor_options options = box_options(MCOR_CAP_BOX, box);
  mcor_surface surface;
  CORE_OK(*state, mcor_extract(*state, &input, &options, &surface));
  const double cube = surface.statistics.cube_size;
  double planes[6], volume = 1;
  find_planes(box, cube, planes);
  for (int a = 0; a < 3; ++a)
  {
    volume *= planes[2 * a + 1] - planes[2 * a];
  }
  assert_true(surface.statistics.is_closed);
  assert_int_equal(surface.triangle_count, surface.statistics.cap_triangles);
  CORE_CHECK(fabs(surface.statistics.volume / volume - 1) < 1e-9, "volume %.12g, cells' %.12g",
    surface.statistics.volume, volume);
  mcor_free_surface(&surface);
  core_free_set(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_sponge),
    cmocka_unit_test(test_inside) };
  return cmocka_run_group_tests(tests, core_set_up, core_tear_down);
}
