/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests caps of particles in a plane: lines along sides of periods and boxes, where there is fluid at the side. */

#include "plane_reference.h"

/* A call, and the coordinates of its capped sides on the plane's two axes. A side is infinite if it
 * has no cap. */
typedef struct caps_case
{
  const particle_set* set;
  mcor_options options;
  int axis;
  double side[4]; /* low u, high u, low v, high v */
} caps_case;

static double caps_at(const caps_case* c, const mcor_surface* s, int32_t p, int a)
{
  return s->points[3 * (int64_t)p + (c->axis + 1 + a) % 3];
}

/* Returns the number of the side (index in c->side) that points p and q both lie on, or -1. */
static int caps_side_of(const caps_case* c, const mcor_surface* s, int32_t p, int32_t q)
{
  for (int i = 0; i < 4; ++i)
  {
    if (fabs(caps_at(c, s, p, i / 2) - c->side[i]) < 1e-6 &&
      fabs(caps_at(c, s, q, i / 2) - c->side[i]) < 1e-6)
    {
      return i;
    }
  }
  return -1;
}

/* Returns the distance from p to q along side i: positive if the inside is on the left of this way, else negative. */
static double caps_length(const caps_case* c, const mcor_surface* s, int i, int32_t p, int32_t q)
{
  const int along = 1 - i / 2;
  const double forward = caps_at(c, s, q, along) - caps_at(c, s, p, along);
  return (i % 2 == along) == 1 ? forward : -forward;
}

/* Adds to length[i] how much of side i the triangles of a filled region cover. */
static void caps_filled(const caps_case* c, const mcor_surface* s, double length[4])
{
  for (int64_t t = 0; t < 3 * s->triangle_count; ++t)
  {
    const int32_t p = s->triangles[t], q = s->triangles[t - t % 3 + (t + 1) % 3];
    const int side = caps_side_of(c, s, p, q);
    if (side >= 0)
    {
      length[side] += caps_length(c, s, side, p, q);
    }
  }
}

static void caps_lines(const caps_case* c, const mcor_surface* s, double length[4])
{
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    for (int64_t i = s->line_offsets[l]; i + 1 < s->line_offsets[l + 1]; ++i)
    {
      const int32_t p = s->line_points[i], q = s->line_points[i + 1];
      const int side = caps_side_of(c, s, p, q);
      if (side >= 0)
      {
        const double part = caps_length(c, s, side, p, q);
        CORE_CHECK(part > 0, side, -part);
        length[side] += part;
      }
    }
  }
}

/* Sets the case's sides: sides of the period, or the sides of the cells that a box owns. */
static void caps_place(caps_case* c, const mcor_surface* s)
{
  const mcor_options* o = &c->options;
  const double cube = s->statistics.cube_size;
  for (int i = 0; i < 4; ++i)
  {
    const int from = 2 * ((c->axis + 1 + i / 2) % 3) + i % 2;
    const double period = o->periodic[from - i % 2 + 1] - o->periodic[from - i % 2];
    const double box = o->box[from];
    const int has_box = box != 0 && !isinf(box);
    const double low = cube * (double)s->statistics.lattice_origin[from / 2];
    c->side[i] = has_box ? ceil(box / cube - 0.5) * cube
      : period > 0       ? low + i % 2 * period
                         : INFINITY;
  }
}

/* Checks that capped lines begin with the points of the lines without caps, unchanged; that caps are as long as the
 * filled part of sides; and that, if nothing is trimmed, caps close the lines around the filled area. Returns the
 * length of all caps. */
static double caps_check(mcor_context* context, caps_case* c, int is_trimmed)
{
  const mcor_input input = core_input(c->set);
  mcor_options options = c->options;
  options.level_limit = 0;
  options.capping = 0;
  CORE_SURFACE open = core_extract(context, &input, &options);
  options.filled = 1;
  CORE_SURFACE filled = core_extract(context, &input, &options);
  CORE_SURFACE capped = core_extract(context, &input, &c->options);
  double expected[4] = { 0 }, length[4] = { 0 }, all = 0;
  caps_place(c, &open);
  caps_filled(c, &filled, expected);
  caps_lines(c, &capped, length);
  for (int i = 0; i < 4; ++i)
  {
    CORE_CHECK(fabs(length[i] - expected[i]) < 2e-4, i, length[i], expected[i]);
    all += length[i];
  }
  CORE_CHECK(fabs(capped.statistics.length - open.statistics.length - all) < 1e-4,
    capped.statistics.length, open.statistics.length, all);
  assert_true(capped.point_count >= open.point_count);
  assert_memory_equal(
    capped.points, open.points, (size_t)open.point_count * 3 * sizeof *open.points);
  for (int64_t p = open.point_count; p < capped.point_count; ++p)
  {
    const float* n = capped.normals + 3 * p;
    double out = 0;
    for (int i = 0; i < 4; ++i)
    {
      out = caps_side_of(c, &capped, (int32_t)p, (int32_t)p) >= 0 &&
          fabs(caps_at(c, &capped, (int32_t)p, i / 2) - c->side[i]) < 1e-6
        ? fmax(out, (i % 2 ? 1 : -1) * n[(c->axis + 1 + i / 2) % 3])
        : out;
    }
    CORE_CHECK(out > 0.7, p, out);
    CORE_CHECK(capped.boundary_flag[p] == 8 || (is_trimmed && capped.boundary_flag[p] == 1), p,
      capped.boundary_flag[p]);
  }
  if (!is_trimmed)
  {
    assert_true(capped.statistics.is_closed);
    CORE_CHECK(
      fabs(capped.statistics.area - filled.statistics.area) < 1e-6 * filled.statistics.area,
      capped.statistics.area, filled.statistics.area);
  }
  return all;
}

static void set_sides(double sides[6], int axis, double u0, double u1, double v0, double v1)
{
  const double given[4] = { u0, u1, v0, v1 };
  for (int i = 0; i < 4; ++i)
  {
    sides[2 * ((axis + 1 + i / 2) % 3) + i % 2] = given[i];
  }
}

/* Checks caps of periods along one axis or both, of boxes, and of boxes in a period. */
static void test_sides(void** state)
{
  double all = 0;
  for (int round = 0; round < 36; ++round)
  {
    const int axis = round % 3, where = round / 3 % 4;
    const mcor_field field = (mcor_field)(round / 12);
    const double iso = field == MCOR_SUM ? 0.35 : field == MCOR_SHEPARD ? 0.1 : 0.9;
    CORE_SET set = plane_make(12, 0.45, 1.4, axis, 3, (uint64_t)(round + 1));
    uint64_t seed = (uint64_t)round + 77;
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = field == MCOR_SUM ? random_unit(&seed) : 2 * random_unit(&seed) - 1;
    }
    caps_case c = { .set = &set, .options = plane_options(&iso), .axis = axis };
    c.options.field = field;
    c.options.cube_size = 0.5;
    c.options.topology = round % 2 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    c.options.precision = round % 5 == 4 ? MCOR_FLOAT64 : MCOR_FLOAT32;
    c.options.node_threshold = 0;
    if (where != 1)
    {
      set_sides(c.options.periodic, axis, -6, 6, where == 3 ? 0 : -6, where == 3 ? 0 : 6);
    }
    if (where == 1 || where == 2)
    {
      set_sides(
        c.options.box, axis, -3.1, 2.4, where == 2 ? -6 : -4.6, where == 2 ? 1.2 : INFINITY);
      c.options.box[2 * axis] = -INFINITY;
      c.options.box[2 * axis + 1] = INFINITY;
    }
    c.options.capping = where == 1 || where == 2 ? MCOR_CAP_BOX : MCOR_CAP_PERIOD;
    /* With a period along both axes fluid is everywhere; else lines of a scalar end where the fluid ends. */
    const int ends = field != MCOR_WEIGHT_SUM && (where == 1 || where == 3);
    all += caps_check(*state, &c, ends);
  }
  CORE_CHECK(all > 36 * 5, all);
}

/* Caps end where trimming ends the fluid: by weight, by eigenvalue, at walls. */
static void test_trimmed_sides(void** state)
{
  const double iso = -1e3;
  for (int mode = 0; mode < 9; ++mode)
  {
    const int axis = mode % 3;
    CORE_SET set = plane_make(14, 0.25, 1.2, axis, -2, (uint64_t)(4 + mode));
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.solid[i] = set.position[3 * i + (axis + 2) % 3] < -4;
    }
    set.has_solids = mode / 3 == 2;
    caps_case c = { .set = &set, .options = plane_options(&iso), .axis = axis };
    c.options.boundary_detection =
      mode / 3 == 1 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    c.options.vertex_threshold = mode / 3 == 1 ? 0.75 : 0.5;
    c.options.wall_share = mode / 3 == 2 ? 0.5 : 0;
    c.options.node_threshold = 0.02;
    c.options.capping = MCOR_CAP_BOX;
    set_sides(c.options.box, axis, -3.1, 2.4, -INFINITY, INFINITY);
    c.options.box[2 * axis] = -3;
    c.options.box[2 * axis + 1] = 3;
    const double all = caps_check(*state, &c, 1);
    CORE_CHECK(all > 18 && all < 32, mode, all);
  }
}

/* Each of several iso values has caps of its own. No bit depends on the order of the particles. */
static void test_values_and_order(void** state)
{
  const double isos[2] = { 0.9, 0.6 };
  CORE_SET set = plane_make(12, 0.45, 1.3, 2, 0, 6);
  const mcor_input input = core_input(&set);
  mcor_options options = plane_options(isos);
  options.field = MCOR_WEIGHT_SUM;
  options.capping = MCOR_CAP_BOX;
  set_sides(options.box, 2, -3, 3, -2, 2);
  options.box[4] = -INFINITY;
  options.box[5] = INFINITY;
  double area[2];
  for (int i = 0; i < 2; ++i)
  {
    options.iso_values = isos + i;
    CORE_SURFACE one = core_extract(*state, &input, &options);
    area[i] = one.statistics.area;
  }
  options.iso_values = isos;
  options.iso_count = 2;
  CORE_SURFACE both = core_extract(*state, &input, &options);
  const double sum = both.statistics.area;
  CORE_CHECK(fabs(sum - area[0] - area[1]) < 1e-9 * sum, sum, area[0] + area[1]);
  CORE_FREED int64_t* order = core_make_order(set.count, 6);
  CORE_SET other = core_permute(&set, order);
  const mcor_input permuted = core_input(&other);
  CORE_SURFACE again = core_extract(*state, &permuted, &options);
  assert_int_equal(core_hash(&both), core_hash(&again));
}

static void test_what_is_not_capped(void** state)
{
  const double iso = 0.5;
  CORE_SET set = plane_make(8, 0.2, 1, 1, 0, 1);
  const mcor_input input = core_input(&set);
  mcor_options options = plane_options(&iso);
  CORE_SURFACE surface;
  options.capping = MCOR_CAP_PERIOD;
  options.filled = 1;
  CORE_FAILS(*state, MCOR_INVALID_ARGUMENT, mcor_extract(*state, &input, &options, &surface),
    "CAPPING_WITH_FILLED");
  options.filled = 0;
  options.field = MCOR_WEIGHT_SUM;
  surface = core_extract(*state, &input, &options); /* there is nothing to close */
  assert_true(surface.statistics.is_closed && surface.statistics.cap_triangles == 0);
  mcor_free_surface(&surface);
  options.capping = MCOR_CAP_BOX;
  set_sides(options.box, 1, 100, 101, 100, 101);
  options.box[2] = -1;
  options.box[3] = 1;
  surface = core_extract(*state, &input, &options);
  assert_int_equal(surface.line_count, 0);
}

CORE_MAIN(core_set_up, core_tear_down, test_sides, test_trimmed_sides, test_values_and_order,
  test_what_is_not_capped)
