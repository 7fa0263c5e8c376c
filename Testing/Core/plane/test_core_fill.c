/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests filled regions and bands between iso values for particles in a plane. */

#include "core_parts.h"
#include "plane_reference.h"

/* ---- What holds for any filled region ---- */

typedef struct fill_report
{
  double area;     /* of all triangles */
  double enclosed; /* area within the lines of the lowest iso value; 0 if one of these lines is open */
  double inverted; /* area of triangles that run round in the wrong direction */
  int64_t loose;   /* edges on the border that are not lines */
  double loose_length;
} fill_report;

/* An edge from one point to another. of_line: it belongs to an iso value's line, else to a triangle of a band. */
typedef struct fill_edge
{
  int32_t from, to;
  int of_line;
  double value;
} fill_edge;

static int fill_compare(const void* x, const void* y)
{
  const fill_edge *a = x, *b = y;
  const int32_t low[2] = { a->from < a->to ? a->from : a->to, b->from < b->to ? b->from : b->to };
  const int32_t high[2] = { a->from < a->to ? a->to : a->from, b->from < b->to ? b->to : b->from };
  const int by_low = (low[0] > low[1]) - (low[0] < low[1]);
  return by_low ? by_low : (high[0] > high[1]) - (high[0] < high[1]);
}

static double fill_cross(
  const plane_field* f, const mcor_surface* s, int32_t a, int32_t b, int32_t c)
{
  const int u = (f->axis + 1) % 3, v = (f->axis + 2) % 3;
  const double *p = s->points + 3 * (int64_t)a, *q = s->points + 3 * (int64_t)b,
               *r = s->points + 3 * (int64_t)c;
  return 0.5 * ((q[u] - p[u]) * (r[v] - p[v]) - (r[u] - p[u]) * (q[v] - p[v]));
}

/* Checks all edges between the same two points, and adds to the report. */
static void fill_check_edge(const plane_field* f, const mcor_surface* s, const fill_edge* edges,
  int64_t count, double least, fill_report* report)
{
  const fill_edge *sides[2] = { NULL }, *line = NULL;
  for (int64_t i = 0; i < count; ++i)
  {
    const fill_edge* e = edges + i;
    const int way = e->from < e->to;
    CORE_CHECK(!(e->of_line ? line != NULL : sides[way] != NULL), e->from, e->to);
    line = e->of_line ? e : line;
    sides[way] = e->of_line ? sides[way] : e;
  }
  if (line && !sides[0] && !sides[1])
  {
    /* Of several equal iso values, only one has bands at its line. This line has none: its value must occur again. */
    int times = 0;
    for (int i = 0; i < f->options->iso_count; ++i)
    {
      times += f->options->iso_values[i] == line->value;
    }
    CORE_CHECK(times > 1, line->from, line->to, line->value);
    return;
  }
  if (line)
  {
    const fill_edge *left = sides[line->from < line->to], *right = sides[line->from > line->to];
    CORE_CHECK(left && left->value == line->value, line->from, line->to, line->value);
    CORE_CHECK(line->value == least ? right == NULL : right && right->value < line->value,
      line->from, line->to, line->value);
    return;
  }
  CORE_CHECK(
    !sides[0] || !sides[1] || sides[0]->value == sides[1]->value, sides[0]->value, sides[1]->value);
  if (!sides[0] || !sides[1])
  {
    const double *a = s->points + 3 * (int64_t)edges->from, *b = s->points + 3 * (int64_t)edges->to;
    ++report->loose;
    report->loose_length += sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
  }
}

/* Checks a filled region. Each edge inside has two triangles, and each edge on the border has one. All triangles have
 * the same orientation. Lines of the lowest iso value are on the border; each other line lies between the band above
 * its value and the band below it. No other edge separates two bands. */
static fill_report fill_check(const plane_field* field, const mcor_surface* s)
{
  fill_report report = { 0 };
  assert_true(s->band_value && s->iso_value && s->triangle_count > 0);
  double least = INFINITY;
  for (int i = 0; i < field->options->iso_count; ++i)
  {
    least = fmin(least, field->options->iso_values[i]);
  }
  CORE_FREED fill_edge* edges =
    malloc((size_t)(3 * s->triangle_count + s->line_point_count + 1) * sizeof *edges);
  assert_non_null(edges);
  int64_t count = 0;
  for (int64_t i = 0; i < 3 * s->triangle_count; ++i)
  {
    const int64_t t = i / 3;
    edges[count++] =
      (fill_edge){ s->triangles[i], s->triangles[3 * t + (i + 1) % 3], 0, s->band_value[t] };
  }
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    for (int64_t i = s->line_offsets[l]; i + 1 < s->line_offsets[l + 1]; ++i)
    {
      const int32_t from = s->line_points[i];
      edges[count++] = (fill_edge){ from, s->line_points[i + 1], 1, s->iso_value[from] };
    }
  }
  qsort(edges, (size_t)count, sizeof *edges, fill_compare);
  for (int64_t i = 0, next; i < count; i = next)
  {
    next = i + 1;
    while (next < count && fill_compare(edges + i, edges + next) == 0)
    {
      ++next;
    }
    fill_check_edge(field, s, edges + i, next - i, least, &report);
  }
  for (int64_t t = 0; t < s->triangle_count; ++t)
  {
    const int32_t* c = s->triangles + 3 * t;
    const double area = fill_cross(field, s, c[0], c[1], c[2]);
    report.area += area;
    report.inverted -= area < 0 ? area : 0;
  }
  int closed = 1;
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    const int32_t* p = s->line_points + s->line_offsets[l];
    const int64_t n = s->line_offsets[l + 1] - s->line_offsets[l];
    closed = closed && (p[0] == p[n - 1] || s->iso_value[p[0]] != least);
    for (int64_t i = 0; i + 1 < n && s->iso_value[p[0]] == least; ++i)
    {
      report.enclosed += fill_cross(field, s, 0, p[i], p[i + 1]);
    }
  }
  report.enclosed = closed ? report.enclosed : 0;
  CORE_CHECK(
    fabs(s->statistics.area - report.area) < 1e-9 * report.area, s->statistics.area, report.area);
  return report;
}

/* Fails unless each point lies where its data say: on an iso value, on a threshold, or between two iso values. */
static void fill_check_points(const plane_field* f, const mcor_surface* s)
{
  const mcor_options* o = f->options;
  int64_t nodes = 0;
  for (int64_t p = 0; p < s->point_count; ++p)
  {
    const double u = s->points[3 * p + (f->axis + 1) % 3], v = s->points[3 * p + (f->axis + 2) % 3];
    const plane_sample at = plane_evaluate(f, u, v);
    const double scale = 1 + fabs(at.value), value = s->iso_value[p] + s->residual[p];
    CORE_CHECK(s->points[3 * p + f->axis] == f->set->position[f->axis], p);
    CORE_CHECK(fabs(at.value - value) < 3e-5 * scale, p, value, at.value);
    CORE_CHECK(fabs(at.weight - s->weight_sum[p]) < 1e-4, s->weight_sum[p], at.weight);
    CORE_CHECK(s->normals[3 * p + f->axis] == 1, p);
    if (s->boundary_flag[p] == 8)
    {
      ++nodes;
      double next = INFINITY;
      for (int i = 0; i < o->iso_count; ++i)
      {
        next = o->iso_values[i] > s->iso_value[p] ? fmin(next, o->iso_values[i]) : next;
      }
      CORE_CHECK(at.value > s->iso_value[p] - 3e-5 * scale && at.value < next + 3e-5 * scale,
        at.value, s->iso_value[p], next);
      CORE_CHECK(o->field == MCOR_WEIGHT_SUM || o->boundary_detection ||
          at.weight > o->vertex_threshold - 1e-4,
        at.weight);
    }
    CORE_CHECK(s->boundary_flag[p] != 1 || o->wall_share != 0 || o->boundary_detection ||
        fabs(at.weight - o->vertex_threshold) < 1e-4,
      at.weight);
  }
  assert_true(nodes > 0);
}

/* Returns the area of the region above iso, by sampling n x n points. */
static double fill_sample_area(const plane_field* f, double iso, int n)
{
  double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  for (int64_t i = 0; i < f->set->count; ++i)
  {
    for (int a = 0; a < 2; ++a)
    {
      const double x = f->set->position[3 * i + (f->axis + 1 + a) % 3];
      low[a] = fmin(low[a], x - 3);
      high[a] = fmax(high[a], x + 3);
    }
  }
  int64_t inside = 0;
  for (int64_t i = 0; i < (int64_t)n * n; ++i)
  {
    const plane_sample at =
      plane_evaluate(f, low[0] + (high[0] - low[0]) * ((double)(i % n) + 0.5) / n,
        low[1] + (high[1] - low[1]) * ((double)(i / n) + 0.5) / n);
    inside += at.value >= iso &&
      (f->options->field == MCOR_WEIGHT_SUM || at.weight >= f->options->vertex_threshold);
  }
  return (double)inside / ((double)n * n) * (high[0] - low[0]) * (high[1] - low[1]);
}

/* ---- Cases ---- */

static mcor_options fill_options(const double* isos, int count)
{
  mcor_options options = core_options(isos);
  options.iso_count = count;
  options.filled = 1;
  options.outputs |= MCOR_OUT_BOUNDARY_FLAG | MCOR_OUT_RESIDUAL | MCOR_OUT_WEIGHT_SUM;
  return options;
}

static fill_report extract(mcor_context* context, const particle_set* set,
  const mcor_options* options, int axis, mcor_surface* surface)
{
  const mcor_input input = core_input(set);
  const plane_field field = { set, options, axis, NULL };
  *surface = core_extract(context, &input, options);
  return fill_check(&field, surface);
}

static void check_close(double a, double b, double tolerance, const char* what)
{
  CORE_CHECK(fabs(a - b) <= tolerance * fabs(b), what, a, b);
}

/* The region inside the free surface's lines is filled, and these lines are its whole border. */
static void test_free_surface(void** state)
{
  const double iso = 0.5;
  const mcor_sph_kernel kernels[3] = { MCOR_CUBIC_SPLINE, MCOR_M_PRIME_4, MCOR_WENDLAND_C2 };
  for (int k = 0; k < 3; ++k)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      CORE_SET set = plane_make(12, 0.3, 1.4, axis, 2 * axis - 3, (uint64_t)(1 + k));
      mcor_options options = fill_options(&iso, 1);
      options.field = MCOR_WEIGHT_SUM;
      options.sph_kernel = kernels[k];
      options.precision = axis == 2 && k == 0 ? MCOR_FLOAT64 : MCOR_FLOAT32;
      options.preview = axis == 1 && k == 0;
      CORE_SURFACE surface;
      const fill_report report = extract(*state, &set, &options, axis, &surface);
      const plane_field field = { &set, &options, axis, NULL };
      assert_int_equal(report.loose, 0);
      check_close(report.area, report.enclosed, 1e-9, "enclosed");
      check_close(report.area, fill_sample_area(&field, iso, 100), 2e-2, "sampled");
      CORE_CHECK(report.inverted == 0, report.inverted);
      options.preview ? (void)0 : fill_check_points(&field, &surface);
    }
  }
}

/* The areas of all bands add up to the area above the lowest iso value, whatever the order of the
 * values. */
static void test_bands(void** state)
{
  const double isos[7] = { 3, -60, 5.5, -20, 3, 1e9, 0 };
  CORE_SET set = plane_make(20, 0.2, 1.2, 1, 4, 3);
  mcor_options options = fill_options(isos, 7);
  mcor_surface surface;
  const plane_field field = { &set, &options, 1, NULL };
  const fill_report all = extract(*state, &set, &options, 1, &surface);
  fill_check_points(&field, &surface);
  CORE_CHECK(all.inverted == 0, all.inverted);
  double bands[3] = { 0 };
  for (int64_t t = 0; t < surface.triangle_count; ++t)
  {
    const double* p[3];
    for (int c = 0; c < 3; ++c)
    {
      p[c] = surface.points + 3 * (int64_t)surface.triangles[3 * t + c];
    }
    const double u[2] = { (p[0][2] + p[1][2] + p[2][2]) / 3, (p[0][0] + p[1][0] + p[2][0]) / 3 };
    const double value = plane_evaluate(&field, u[0], u[1]).value, band = surface.band_value[t];
    const double next = band == -60 ? -20 : band == -20 ? 0 : band == 0 ? 3 : band == 3 ? 5.5 : 1e9;
    CORE_CHECK(value > band - 1 && value < next + 1, value, band, next);
    const double area = 0.5 *
      fabs((p[1][2] - p[0][2]) * (p[2][0] - p[0][0]) - (p[2][2] - p[0][2]) * (p[1][0] - p[0][0]));
    bands[band >= 3 ? 2 : band >= 0 ? 1 : 0] += area;
  }
  mcor_free_surface(&surface);
  const double single[3] = { -60, 0, 3 };
  double area[4] = { 0 };
  for (int i = 0; i < 3; ++i)
  {
    options.iso_values = single + i;
    options.iso_count = 1;
    area[i] = extract(*state, &set, &options, 1, &surface).area;
    mcor_free_surface(&surface);
  }
  check_close(all.area, area[0], 1e-9, "all bands");
  for (int i = 0; i < 3; ++i)
  {
    check_close(bands[i], area[i] - area[i + 1], 1e-9, "a band");
  }
}

/* Filled regions end where trimming ends them: by weight, by eigenvalue, at walls. */
static void test_trimming(void** state)
{
  const double isos[3] = { -1e3, -2.2, 3.1 };
  for (int mode = 0; mode < 6; ++mode)
  {
    CORE_SET set = plane_make(16, 0.25, 1, 0, 2, (uint64_t)(4 + mode));
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = set.position[3 * i + 1] + 0.3 * set.position[3 * i + 2];
      set.solid[i] = set.position[3 * i + 2] < -4;
    }
    set.has_solids = mode >= 3;
    mcor_options options = fill_options(isos, 3);
    options.boundary_detection = mode == 1 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    options.vertex_threshold = mode == 1 ? 0.75 : mode == 2 ? 0.8 : 0.5;
    options.wall_share = mode == 3 ? 0 : mode == 4 ? 0.5 : MCOR_WALL_SHARE_AUTO;
    options.outputs |= mode == 1 ? MCOR_OUT_BOUNDARY_EIGENVALUE : 0;
    options.node_threshold = 0.02;
    CORE_SURFACE surface;
    const plane_field field = { &set, &options, 0, NULL };
    const fill_report report = extract(*state, &set, &options, 0, &surface);
    fill_check_points(&field, &surface);
    int64_t cuts = 0;
    for (int64_t p = 0; p < surface.point_count; ++p)
    {
      cuts += surface.boundary_flag[p] == 1;
      CORE_CHECK(!surface.boundary_eigenvalue || surface.boundary_flag[p] != 1 ||
          fabs(surface.boundary_eigenvalue[p] - 0.75) < 1e-4,
        surface.boundary_eigenvalue[p]);
    }
    CORE_CHECK(cuts > 40 && report.loose > 40, cuts, report.loose);
    CORE_CHECK(report.inverted == 0, report.inverted);
    if (mode == 0 || mode == 2)
    {
      check_close(report.area, fill_sample_area(&field, isos[0], 150), 2e-2, "sampled");
    }
    CORE_CHECK(mode < 4 || report.area < 16 * 12.5, report.area);
  }
}

/* Filled regions of random fields have no gaps, even with noise, walls, and all options that move lines. */
static void test_random(void** state)
{
  uint64_t seed = 21;
  double area = 0, inverted = 0;
  for (int round = 0; round < 40; ++round)
  {
    const int axis = (int)(random_bits(&seed) % 3), count = 1 + (int)(random_bits(&seed) % 5);
    CORE_SET set = plane_make(10 + (int)(random_bits(&seed) % 6), 0.45, 1 + 2 * random_unit(&seed),
      axis, 3 * random_unit(&seed), seed);
    double isos[5];
    for (int64_t i = 0; i < set.count; ++i)
    {
      set.scalar[i] = 2 * random_unit(&seed) - 1;
      set.solid[i] = random_bits(&seed) % 6 == 0;
    }
    mcor_options options = fill_options(isos, count);
    options.field = (mcor_field)(round % 3);
    for (int i = 0; i < count; ++i)
    {
      isos[i] = options.field == MCOR_WEIGHT_SUM
        ? 0.2 + random_unit(&seed)
        : (i > 0 ? 2 : 0.4) * random_unit(&seed) - (i > 0 ? 1 : 0.4);
    }
    set.has_solids = round % 4 == 1 && options.field != MCOR_WEIGHT_SUM;
    options.sph_kernel = (mcor_sph_kernel)(random_bits(&seed) % (MCOR_WENDLAND_C2 + 1));
    options.cube_size_factor = 0.3 + 0.5 * random_unit(&seed);
    options.vertex_threshold = round & 1 ? 0.5 : 0;
    options.topology = round & 2 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
    options.boundary_detection =
      round % 7 == 3 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    CORE_SURFACE surface;
    const fill_report report = extract(*state, &set, &options, axis, &surface);
    assert_true(options.field != MCOR_WEIGHT_SUM || report.loose == 0);
    area += report.area;
    inverted += report.inverted;
  }
  /* A noisy field may cross two iso values more than once on one edge, which turns a few triangles
   * round. */
  CORE_CHECK(inverted < 1e-4 * area, inverted, area);
}

/* The results of boxes side by side make up the whole result: the same triangles and lines, with all arrays of their
 * points. */
static void test_boxes(void** state)
{
  static const core_cut cuts[] = { { "4 boxes", { 0, 1, 1 }, { { 0 }, { 0.1 }, { -0.7 } } },
    { "thin ones", { 0, 2, 0 }, { { 0 }, { 1.1, 1.3 } } } };
  const double isos[2] = { -8, 2 };
  CORE_SET set = plane_make(14, 0.3, 1.3, 0, 4, 9);
  mcor_options options = fill_options(isos, 2);
  const mcor_input input = core_input(&set);
  core_ask_for_all(&options);
  core_check_these_cuts(*state, "filled", &input, &options, cuts, 2);
}

/* A period is filled from side to side; with fluid everywhere, the whole period is filled. */
static void test_period(void** state)
{
  const double isos[2] = { -1e3, 2 };
  CORE_SET set = plane_make(12, 0.2, 1.2, 1, 0.5, 2);
  mcor_options options = fill_options(isos, 2);
  const double period[6] = { -6, 6, 0, 0, -6, 6 };
  memcpy(options.periodic, period, sizeof period);
  CORE_SURFACE surface;
  const fill_report report = extract(*state, &set, &options, 1, &surface);
  check_close(report.area, 144, 1e-9, "a period");
  check_close(report.loose_length, 48, 1e-9, "its sides");
  mcor_free_surface(&surface);
  options.periodic[0] = options.periodic[1] = 0;
  const fill_report strip = extract(*state, &set, &options, 1, &surface);
  CORE_CHECK(fabs(strip.area - 144) < 8, strip.area);
}

/* No bit depends on options.seeds, on the order of particles, or on kept data. */
static void test_bits(void** state)
{
  const double isos[2] = { -3, 4 };
  CORE_SET set = plane_make(12, 0.3, 1.5, 2, 2, 5);
  CORE_FREED int64_t* order = core_make_order(set.count, 6);
  CORE_SET other = core_permute(&set, order);
  mcor_options options = fill_options(isos, 2);
  uint64_t hash[5];
  for (int i = 0; i < 5; ++i)
  {
    options.seeds = i == 1 ? MCOR_PAIRS : MCOR_COMPLETE;
    mcor_input input = i >= 3 ? core_input_to_keep(&set) : core_input(i == 2 ? &other : &set);
    CORE_SURFACE surface = core_extract(*state, &input, &options);
    hash[i] = core_hash_bytes(
      core_hash(&surface), surface.band_value, (size_t)surface.triangle_count * sizeof(double));
  }
  for (int i = 1; i < 5; ++i)
  {
    CORE_CHECK(hash[i] == hash[0], i);
  }
}

/* At a node in the filled region, attributes equal the values that a probe finds there. */
static void test_attributes(void** state)
{
  mcor_context* context = *state;
  const double isos[2] = { -20, 1 };
  CORE_SET set = plane_make(10, 0.3, 1.2, 0, 1, 8);
  enum
  {
    ARRAYS = 5
  };
  mcor_array attributes[ARRAYS];
  CORE_FREED double* values = oracle_allocate(set.count * 3 * ARRAYS, sizeof *values);
  for (int64_t i = 0; i < set.count * 3 * ARRAYS; ++i)
  {
    values[i] = i < set.count * 3 ? 7 : sin((double)i);
  }
  for (int a = 0; a < ARRAYS; ++a)
  {
    attributes[a] = core_array(values + set.count * 3 * a, 3);
  }
  const mcor_input input = core_input_with(&set, attributes, ARRAYS);
  mcor_options options = fill_options(isos, 2);
  options.outputs |= MCOR_OUT_NEAREST_PARTICLE | MCOR_OUT_GRADIENTS;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  CORE_SAMPLES samples;
  const mcor_array points = core_array(surface.points, 3);
  CORE_OK(context, mcor_probe(context, &input, &options, &points, surface.point_count, &samples));
  for (int64_t p = 0; p < surface.point_count; ++p)
  {
    CORE_CHECK(surface.nearest_particle[p] >= 0 && surface.nearest_particle[p] < set.count, p);
    for (int i = 0; i < 3 * ARRAYS; ++i)
    {
      const double at = surface.attributes[i / 3][3 * p + i % 3];
      CORE_CHECK(fabs(at - samples.values[i / 3][3 * p + i % 3]) < 1e-4, p, at,
        samples.values[i / 3][3 * p + i % 3]);
    }
  }
}

/* Extracts a surface that must have no triangles. */
static void expect_nothing(
  mcor_context* context, const mcor_input* input, const mcor_options* options)
{
  CORE_SURFACE surface = core_extract(context, input, options);
  assert_true(surface.triangle_count == 0 && surface.point_count == 0);
}

static void test_what_is_not_filled(void** state)
{
  const double iso = -1;
  CORE_SET set = plane_make(8, 0.2, 1, 2, 0, 1);
  const mcor_input input = core_input(&set);
  mcor_options options = fill_options(&iso, 1);
  CORE_SURFACE surface;
  options.field = MCOR_SUM;
  options.node_threshold = 0;
  CORE_FAILS(*state, MCOR_INVALID_ARGUMENT, mcor_extract(*state, &input, &options, &surface),
    "REGION_WITHOUT_END");
  assert_true(surface.triangle_count == 0 && !surface.points);
  options.node_threshold = 0.1;
  options.dimension = 3;
  CORE_FAILS(*state, MCOR_INVALID_ARGUMENT, mcor_extract(*state, &input, &options, &surface),
    "FILLED_IN_SPACE");
  options.dimension = 0;
  extract(*state, &set, &options, 2, &surface);
  mcor_input nothing = input;
  nothing.count = 0;
  expect_nothing(*state, &nothing, &options);
  const double beside[6] = { 100, 101, -1, 1, -1, 1 }; /* the box lies beside all particles */
  memcpy(options.box, beside, sizeof beside);
  expect_nothing(*state, &input, &options);
  memset(options.box, 0, sizeof options.box);
  options.iso_count = 0;
  expect_nothing(*state, &input, &options);
  options.iso_count = 1;
  options.filled = 0;
  CORE_SURFACE lines = core_extract(*state, &input, &options);
  assert_true(!lines.band_value && !lines.triangles && !lines.iso_value);
}

CORE_MAIN(core_set_up, core_tear_down, test_free_surface, test_bands, test_trimming, test_random,
  test_boxes, test_period, test_bits, test_attributes, test_what_is_not_filled)
