/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests caps, which close the surface at the sides of periods and boxes. The surface's own points and triangles must
 * not change. */

#include "core_parts.h"
#include "core_period.h"
#include "mcor_vector.h"

/* Fails unless the surface with caps begins with all points and triangles of the surface without caps. */
static void cap_check_prefix(const mcor_surface* open, const mcor_surface* closed)
{
  const size_t points = (size_t)open->point_count, triangles = (size_t)open->triangle_count;
  assert_true(closed->point_count >= open->point_count);
  assert_memory_equal(open->points, closed->points, points * 3 * sizeof(double));
  assert_memory_equal(open->normals, closed->normals, points * 3 * sizeof(float));
  assert_memory_equal(open->triangles, closed->triangles, triangles * 3 * sizeof *open->triangles);
  assert_int_equal(closed->triangle_count - open->triangle_count, closed->statistics.cap_triangles);
  assert_true(closed->statistics.residual_max == open->statistics.residual_max);
}

/* Fails unless the closed surface has the same volume as the region between `planes` where the oracle's field is above
 * iso. Random samples measure this region. */
static void cap_check_volume(const mcor_surface* closed, const particle_set* set,
  const mcor_options* options, const double planes[6])
{
  enum
  {
    SAMPLES = 20000
  };
  CORE_FIELD field =
    oracle_make_field(set, (oracle_kernel)options->sph_kernel, (oracle_kind)options->field, 1);
  uint64_t seed = 3;
  int inside = 0;
  for (int i = 0; i < SAMPLES; ++i)
  {
    double at[3];
    oracle_sample sample;
    for (int a = 0; a < 3; ++a)
    {
      at[a] = planes[2 * a] + random_unit(&seed) * (planes[2 * a + 1] - planes[2 * a]);
    }
    oracle_evaluate(&field, NULL, at, &sample);
    inside += sample.value >= options->iso_values[0];
  }
  const double part = (double)inside / SAMPLES;
  const double whole = (planes[1] - planes[0]) * (planes[3] - planes[2]) * (planes[5] - planes[4]);
  const double expected = whole * part, error = whole * sqrt(part * (1 - part) / SAMPLES);
  CORE_CHECK(fabs(closed->statistics.volume - expected) < 4 * error + 1e-9 * whole,
    closed->statistics.volume, expected, error);
}

/* ---- Caps at sides ---- */

typedef struct cap_case
{
  mcor_sph_kernel kernel;
  mcor_field field;
  double iso;
  int open;                     /* bits: axes without a period */
  double threshold, eigenvalue; /* options.vertex_threshold, options.eigenvalue_threshold */
  mcor_topology topology;
  mcor_type precision;
} cap_case;

/* Checks points that only caps have: they lie on `planes`, with the oracle's values and normals that point outwards. */
static void check_points(const particle_set* all, const mcor_options* options,
  const mcor_surface* open, const mcor_surface* closed, const double planes[6])
{
  CORE_FIELD field = oracle_make_field(all, (oracle_kernel)options->sph_kernel, ORACLE_SHEPARD, 1);
  for (int64_t p = open->point_count; p < closed->point_count; ++p)
  {
    const double* x = closed->points + 3 * p;
    double out = 0;
    oracle_sample sample;
    for (int i = 0; i < 6; ++i)
    {
      out +=
        fabs(x[i / 2] - planes[i]) < 1e-6 ? (i % 2 ? 1 : -1) * closed->normals[3 * p + i / 2] : 0;
    }
    oracle_evaluate(&field, NULL, x, &sample);
    CORE_CHECK(out > 0.7, p, x[0], x[1], x[2], out);
    assert_true(closed->boundary_flag[p] == 8 || closed->boundary_flag[p] == 2);
    CORE_CHECK(fabs(closed->weight_sum[p] - sample.weight) < 1e-5 * (1 + sample.weight) &&
        (options->field == MCOR_WEIGHT_SUM || fabs(closed->attributes[0][p] - sample.value) < 1e-5),
      p, closed->weight_sum[p], sample.weight);
  }
}

/* Checks that a period's two caps across each axis are alike: as many triangles face up as down, with the same total
 * area. */
static void check_opposite_caps(const mcor_surface* open, const mcor_surface* s)
{
  double area[3][2] = { { 0 } };
  int64_t count[3][2] = { { 0 } };
  for (int64_t t = open->triangle_count; t < s->triangle_count; ++t)
  {
    const int32_t* c = s->triangles + 3 * t;
    double u[3], v[3], n[3];
    mcor_subtract(s->points + 3 * c[1], s->points + 3 * c[0], u);
    mcor_subtract(s->points + 3 * c[2], s->points + 3 * c[0], v);
    mcor_cross(u, v, n);
    int most = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
    most = fabs(n[2]) > fabs(n[most]) ? 2 : most;
    area[most][n[most] > 0] += 0.5 * fabs(n[most]);
    ++count[most][n[most] > 0];
  }
  for (int a = 0; a < 3; ++a)
  {
    CORE_CHECK(count[a][0] == count[a][1] && fabs(area[a][0] - area[a][1]) <= 1e-9 * area[a][0], a,
      count[a][0], count[a][1], area[a][0], area[a][1]);
  }
}

/* Returns whether the surface ends at a point, because it is trimmed there or because the weight is
 * low. */
static int ends_at(const mcor_surface* s, int32_t p)
{
  return s->boundary_flag[p] % 8 != 0 || s->weight_sum[p] < 0.5f;
}

/* Checks a surface with caps against the same surface without caps. is_closed: nothing is trimmed,
 * so the surface must be closed. */
static void check_caps(
  mcor_context* context, const particle_set* set, mcor_options options, int is_closed)
{
  const mcor_array attribute = core_array(set->scalar, 1);
  const mcor_input input = core_input_with(set, &attribute, 1);
  double planes[6];
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_WEIGHT_SUM;
  const int capping = options.capping;
  options.capping = MCOR_CAP_NONE;
  CORE_SURFACE open = core_extract(context, &input, &options);
  options.capping = capping;
  CORE_SURFACE closed = core_extract(context, &input, &options);
  CORE_SET all = core_add_images(set, options.periodic);
  for (int i = 0; i < 6; ++i) /* the sides of a box's cells, or of a period; else infinite */
  {
    const double edge = closed.statistics.cube_edges[i / 2], *period = options.periodic + i / 2 * 2;
    const double begin = ceil(period[0] / edge - 0.5) * edge, box = options.box[i];
    planes[i] = box != 0 && !isinf(box) ? ceil(box / edge - 0.5) * edge
      : period[0] < period[1]           ? begin + i % 2 * (period[1] - period[0])
                                        : (i % 2 ? INFINITY : -INFINITY);
  }
  cap_check_prefix(&open, &closed);
  check_points(&all, &options, &open, &closed, planes);
  CORE_REPORT report = core_check_mesh(&closed);
  for (int64_t i = 0; i < report.side_count; ++i)
  {
    const mesh_edge* side = report.side + i;
    CORE_CHECK(side->sharing == 2 || (ends_at(&closed, side->a) && ends_at(&closed, side->b)),
      side->a, side->b);
  }
  CORE_CHECK(
    !is_closed || (closed.statistics.is_closed == (report.edges > 0) && report.boundary_edges == 0),
    report.boundary_edges, report.edges);
  if (is_closed)
  {
    for (int i = 0; i < 6; ++i) /* there is nothing beyond a side */
    {
      planes[i] = isinf(planes[i]) ? (i % 2 ? 13 : -10) : planes[i];
    }
    cap_check_volume(&closed, &all, &options, planes);
  }
  if (is_closed && capping == MCOR_CAP_PERIOD)
  {
    check_opposite_caps(&open, &closed);
  }
}

/* Checks caps of periods, with cubes of one edge, and with a different edge along each axis. */
static void test_periods(void** state)
{
  static const cap_case cases[] = {
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.9, 0, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, -0.4, 0, 0.5, 0, MCOR_TOPOLOGY_FIELD, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.2, 0, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT64 },
    { MCOR_QUARTIC_SPLINE, MCOR_SHEPARD, -0.2, 0, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SUM, 0.3, 0, 0.5, 0, MCOR_TOPOLOGY_FIELD, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, -9, 0, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 9, 0, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_WEIGHT_SUM, 0.5, 4, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_WENDLAND_C2, MCOR_WEIGHT_SUM, 0.4, 6, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT64 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.2, 4, 0.5, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, -0.4, 3, 0.7, 0, MCOR_TOPOLOGY_FIELD, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, -0.4, 4, 0.3, 0.3, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
    { MCOR_CUBIC_SPLINE, MCOR_SHEPARD, 0.2, 4, 0, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32 },
  };
  const int length[3] = { 12, 10, 10 };
  for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; ++i)
  {
    const cap_case* at = cases + i / 2;
    double period[6] = { 0, 12, 0, 10, 0, 10 };
    CORE_SET set = core_make_period(length, 3);
    i % 2 ? core_stretch_period(&set, period) : (void)0;
    for (int side = 0; side < 6; ++side)
    {
      period[side] = at->open >> side / 2 & 1 ? 0 : period[side];
    }
    mcor_options options = core_period_options(&at->iso, period);
    options.sph_kernel = at->kernel;
    options.field = at->field;
    options.cube_size_factor = 0.6;
    options.vertex_threshold = at->threshold;
    options.topology = at->topology;
    options.precision = at->precision;
    options.boundary_detection =
      at->eigenvalue > 0 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    options.capping = MCOR_CAP_PERIOD;
    check_caps(*state, &set, options, at->open == 0 || at->field == MCOR_WEIGHT_SUM);
  }
}

/* Checks caps of boxes, alone and in a period. The fluid is a lattice with holes in it. The surface of a box that lies
 * within the fluid has the volume of the box's cells. */
static void test_boxes(void** state)
{
  static const double iso = 0.5, period[6] = { -8, 8, 0, 0, 0, 0 };
  static const double boxes[][6] = { { -3.3, 4.1, -5.2, 3.7, -6.6, 2.9 },
    { -INFINITY, 1.3, -INFINITY, INFINITY, -INFINITY, INFINITY },
    { 0.4, INFINITY, -2.2, INFINITY, -INFINITY, 5.05 }, { -3, 3.2, -2, 2, -1, 4 } };
  CORE_SET set = core_make_block(16, 0, 1, core_slope);
  int64_t n = 0;
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double* x = set.position + 3 * i;
    if (sin(0.7 * x[0]) + sin(0.8 * x[1]) + sin(0.6 * x[2] + 1) > -0.8)
    {
      memmove(set.position + 3 * n, x, 3 * sizeof *x);
      set.scalar[n++] = set.scalar[i];
    }
  }
  set.count = n;
  for (int i = 0; i < 8; ++i)
  {
    mcor_options options = core_options(&iso);
    options.field = MCOR_WEIGHT_SUM;
    options.capping = MCOR_CAP_BOX;
    memcpy(options.box, boxes[i / 2], sizeof options.box);
    memcpy(options.periodic, period, i % 2 ? sizeof period : 0);
    for (int64_t j = 0; j < set.count; ++j)
    {
      set.volume[j] = i < 6 ? 1 : 1000; /* the holes have fluid, too */
    }
    check_caps(*state, &set, options, 1);
  }
}

CORE_MAIN(core_set_up, core_tear_down, test_periods, test_boxes)
