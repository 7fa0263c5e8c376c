/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Search grid: queries against all particles one by one, its order, estimates. */

#include "core_fixture.h"
#include "mcor_input.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define PARTICLES 600

/* Lists the particles that may reach each box; boxes: low, high. */
static const char source[] =
  "__kernel void test_query(MCOR_GRID_PARAMS, const int box_count, const real radius,\n"
  "  __global const fix* boxes, __global int* counts, __global int* lists)\n"
  "{\n"
  "  const int i = get_global_id(0);\n"
  "  if (i >= box_count)\n"
  "    return;\n"
  "  const mcor_grid grid = MCOR_GRID;\n"
  "  mcor_query query;\n"
  "  query.radius = radius;\n"
  "  for (int a = 0; a < 3; ++a)\n"
  "  {\n"
  "    query.low[a] = boxes[6 * i + a];\n"
  "    query.high[a] = boxes[6 * i + 3 + a];\n"
  "  }\n"
  "  mcor_query_place(&grid, &query, query.low);\n"
  "  int count = 0;\n"
  "  mcor_tile tile;\n"
  "  mcor_tile_init(&tile);\n"
  "  for (int round = 0; round < 2; ++round)\n"
  "    for (bool first = true; mcor_tile_next(&grid, &query, &tile, first); first = false)\n"
  "      for (int k = 0; k < tile.count; ++k)\n"
  "        if (count < 2 * particle_count)\n"
  "          lists[2 * i * particle_count + count++] = tile.list[k];\n"
  "  counts[i] = count;\n"
  "}\n";

/* The grid's particles, read back. */
typedef struct grid_copy
{
  int32_t x[3][PARTICLES];
  float inv_h[PARTICLES];
  double unit;
} grid_copy;

static grid_copy* copy_grid(mcor_context* context)
{
  grid_copy* copy = calloc(1, sizeof *copy);
  assert_non_null(copy);
  assert_int_equal(context->grid.count, PARTICLES);
  const mcor_buffer* axes[3] = { &context->grid.px, &context->grid.py, &context->grid.pz };
  for (int a = 0; a < 3; ++a)
  {
    CORE_OK(context, mcor_read(context, axes[a], 0, copy->x[a], sizeof copy->x[a]));
  }
  CORE_OK(context, mcor_read(context, &context->grid.inv_h, 0, copy->inv_h, sizeof copy->inv_h));
  copy->unit = ldexp(1, -context->lattice.fix_bits);
  return copy;
}

/* Distance of particle j to a box over its support (or the radius). */
static double reach_of(
  const grid_copy* g, int j, const int32_t* box, double support, double radius, int tensor)
{
  double sum = 0, most = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double below = (double)box[a] - g->x[a][j], above = (double)g->x[a][j] - box[3 + a];
    const double d = fmax(fmax(below, above), 0) * g->unit;
    sum += d * d;
    most = fmax(most, d);
  }
  return (tensor ? most : sqrt(sum)) / (radius >= 0 ? radius : support / (double)g->inv_h[j]);
}

static void check_box(const grid_copy* g, const int32_t* box, const int* list, int count,
  double support, double radius, int tensor)
{
  int listed[PARTICLES] = { 0 };
  CORE_CHECK(count % 2 == 0, "the second loop over the tiles differs: %d in all", count);
  for (int i = 0; i < count; ++i)
  {
    CORE_CHECK(list[i] >= 0 && list[i] < PARTICLES, "particle %d", list[i]);
    CORE_CHECK(list[i] == list[i % (count / 2)], "the second loop differs");
    ++listed[list[i]];
    CORE_CHECK(i == 0 || i == count / 2 || list[i - 1] < list[i], "out of order");
  }
  for (int j = 0; j < PARTICLES; ++j)
  {
    const double reach = reach_of(g, j, box, support, radius, tensor);
    CORE_CHECK(
      listed[j] == 2 || reach >= 1, "particle %d at %.9g of its support is missing", j, reach);
    CORE_CHECK(listed[j] == 0 || reach < 1.001, "particle %d at %.9g is listed", j, reach);
  }
}

/* Particles at 0.9999, 1 and 1.0001 of their support around targets, and anywhere. */
static core_set make_set(double support, double h_ratio)
{
  static const double factors[3] = { 0.9999, 1, 1.0001 };
  core_set set = core_make_random(PARTICLES, 6, 2.0 / h_ratio, 2, 77);
  uint64_t seed = 78;
  for (int i = 1; i < PARTICLES * 2 / 3; ++i)
  {
    double d[3], length = 0;
    for (int a = 0; a < 3; ++a)
    {
      d[a] = i % 7 == 0 ? (a == i % 3) : 2 * random_unit(&seed) - 1;
      length += d[a] * d[a];
    }
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] =
        d[a] / sqrt(length) * factors[i % 3] * support * set.smoothing_length[i];
    }
  }
  return set;
}

static void check_queries(
  mcor_context* context, mcor_sph_kernel kernel, double h_ratio, double radius)
{
  enum
  {
    BOXES = 60
  };
  const double support = mcor_support_factor(kernel);
  const int tensor = kernel == MCOR_M_PRIME_4;
  core_set set = make_set(support, h_ratio);
  const double iso = 100; /* no surface: the grid is all that is wanted */
  const mcor_input input = core_input_to_keep(&set);
  mcor_options options = core_options(&iso);
  options.seeds = MCOR_PAIRS;
  options.sph_kernel = kernel;
  mcor_surface surface = core_extract(context, &input, &options);
  core_extend_program(context, source);
  grid_copy* g = copy_grid(context);
  int32_t boxes[BOXES][6];
  uint64_t seed = 5;
  for (int b = 0; b < BOXES; ++b)
  {
    const int i = (int)(random_bits(&seed) % PARTICLES);
    for (int a = 0; a < 3; ++a)
    {
      const double target = -(double)context->lattice.origin[a] / g->unit;
      const int size = b % 4 < 2 ? 0 : (int)(random_unit(&seed) * 8 / g->unit);
      boxes[b][a] = b == 0 || b % 4 == 1 ? (int32_t)target : g->x[a][i];
      boxes[b][3 + a] = boxes[b][a] + size;
    }
  }
  mcor_buffer box_buffer = { 0 }, counts = { 0 }, lists = { 0 };
  const size_t list_bytes = BOXES * 2 * PARTICLES * sizeof(int);
  CORE_OK(context, mcor_write(context, &box_buffer, boxes, sizeof boxes));
  CORE_OK(context, mcor_reserve(context, &counts, BOXES * sizeof(int)));
  CORE_OK(context, mcor_reserve(context, &lists, list_bytes));
  CORE_OK(context,
    MCOR_LAUNCH(context, "test_query", MCOR_HEAVY, BOXES, MCOR_GRID_ARGS(context), MCOR_INT(BOXES),
      MCOR_REAL(radius), MCOR_BUFFER(&box_buffer), MCOR_BUFFER(&counts), MCOR_BUFFER(&lists)));
  int count[BOXES];
  int* list = malloc(list_bytes);
  assert_non_null(list);
  CORE_OK(context, mcor_read(context, &counts, 0, count, sizeof count));
  CORE_OK(context, mcor_read(context, &lists, 0, list, list_bytes));
  int some = 0;
  for (int b = 0; b < BOXES; ++b)
  {
    check_box(g, boxes[b], list + b * 2 * PARTICLES, count[b], support, radius, tensor);
    some += count[b] > 0;
  }
  CORE_CHECK(some > BOXES / 2, "only %d boxes are reached", some);
  mcor_release(context, &box_buffer);
  mcor_release(context, &counts);
  mcor_release(context, &lists);
  mcor_free_surface(&surface);
  core_free_set(&set);
  free(list);
  free(g);
}

static void test_query(void** state)
{
  static const double ratios[] = { 1, 3, 100 };
  for (int r = 0; r < 3; ++r)
  {
    check_queries(*state, MCOR_CUBIC_SPLINE, ratios[r], -1);
    check_queries(*state, MCOR_M_PRIME_4, ratios[r], -1);
    check_queries(*state, MCOR_CUBIC_SPLINE, ratios[r], 3);
    check_queries(*state, MCOR_CUBIC_SPLINE, ratios[r], 0.01);
  }
}

/* Roots of cubes are exact, others within two units of rounding, and all have the bits that
 * IEEE's operations give. */
static void test_cube_root(void** state)
{
  (void)state;
  uint64_t seed = 34;
  for (int i = 0; i < 10000; ++i)
  {
    const double root = ldexp(1 + random_unit(&seed), (int)(600 * random_unit(&seed)) - 300);
    const double found = mcor_cube_root(root * root * root);
    CORE_CHECK(fabs(found / root - 1) < 2 * DBL_EPSILON, "%.17g, not %.17g", found, root);
    const double whole = i + 1;
    CORE_CHECK(mcor_cube_root(whole * whole * whole) == whole, "of %g cubed", whole);
  }
  const double volume = 4.0 / 3.0 * 3.14159265358979323846;
  CORE_CHECK(mcor_cube_root(volume / 33) == 0x1.01501895415edp-1, "other bits");
  CORE_CHECK(mcor_cube_root(volume / 2) == 0x1.47894e24991b8p+0, "other bits");
}

/* 1.3 times the spacing of a lattice, most of whose particles are far from its faces. */
static void test_estimate(void** state)
{
  const double spacings[] = { 1, 1e-3, 250 };
  for (int s = 0; s < 3; ++s)
  {
    core_set set = core_make_block(30, 0, 1, core_ball);
    for (int64_t i = 0; i < 3 * set.count; ++i)
    {
      set.position[i] *= spacings[s];
    }
    const double iso = 9;
    mcor_input input = core_input(&set);
    input.volume = (mcor_array){ 0 };
    input.estimate_smoothing_length = 1;
    const mcor_options options = core_options(&iso);
    mcor_surface surface = core_extract(*state, &input, &options);
    const double h = surface.statistics.smoothing_length_min / spacings[s];
    CORE_CHECK(
      fabs(h / 1.3 - 1) < 0.02 && surface.statistics.smoothing_length_max / spacings[s] == h,
      "estimated smoothing length %g spacings", h);
    mcor_free_surface(&surface);
    core_free_set(&set);
  }
}

/* Arrays of the grid that must not depend on the order of the input, a row for each. */
typedef struct sorted_set
{
  int count;
  int32_t* x[3];
  float *inv_h, *weight, *value;
  int32_t* order;
} sorted_set;

static void* read_array(mcor_context* context, const mcor_buffer* buffer, int count)
{
  void* data = malloc((size_t)count * 4);
  assert_non_null(data);
  CORE_OK(context, mcor_read(context, buffer, 0, data, (size_t)count * 4));
  return data;
}

static sorted_set sort_set(mcor_context* context, const core_set* set)
{
  const double iso = 2000; /* above all scalars, no surface: the grid is all that is wanted */
  const mcor_input input = core_input_to_keep(set);
  mcor_options options = core_options(&iso);
  options.seeds = MCOR_PAIRS;
  options.cube_size = 0.5;
  mcor_surface surface = core_extract(context, &input, &options);
  mcor_free_surface(&surface);
  const mcor_grid* g = &context->grid;
  const int n = g->count;
  return (sorted_set){ n,
    { read_array(context, &g->px, n), read_array(context, &g->py, n),
      read_array(context, &g->pz, n) },
    read_array(context, &g->inv_h, n), read_array(context, &g->trim_weight, n),
    read_array(context, &g->value, n), read_array(context, &g->order, n) };
}

static void free_sorted(sorted_set* s)
{
  void* const arrays[] = { s->x[0], s->x[1], s->x[2], s->inv_h, s->weight, s->value, s->order };
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; ++i)
  {
    free(arrays[i]);
  }
}

/* Every particle once, its scalar with it; a cell's particles by x; coincident ones by scalar. */
static void check_sorted(mcor_context* context, const core_set* set, const sorted_set* s)
{
  uint8_t* seen = calloc((size_t)set->count, 1);
  assert_non_null(seen);
  assert_int_equal(s->count, set->count);
  int descents = 0;
  for (int i = 0; i < s->count; ++i)
  {
    const int j = s->order[i];
    CORE_CHECK(j >= 0 && j < s->count && !seen[j], "place %d has particle %d", i, j);
    seen[j] = 1;
    CORE_CHECK(s->value[i] == (float)(set->scalar[j] - context->value_shift),
      "place %d has the scalar %g, not that of particle %d", i, (double)s->value[i], j);
    if (i > 0)
    {
      descents += s->x[0][i] < s->x[0][i - 1];
      const int same = s->x[0][i] == s->x[0][i - 1] && s->x[1][i] == s->x[1][i - 1] &&
        s->x[2][i] == s->x[2][i - 1] && s->weight[i] == s->weight[i - 1];
      CORE_CHECK(!same || s->value[i - 1] <= s->value[i],
        "coincident particles at place %d are not sorted", i);
    }
  }
  CORE_CHECK(descents < 16, "x descends %d times in at most 16 cells", descents);
  free(seen);
}

static void check_same_order(const sorted_set* a, const sorted_set* b)
{
  for (int i = 0; i < a->count; ++i)
  {
    CORE_CHECK(a->x[0][i] == b->x[0][i] && a->x[1][i] == b->x[1][i] && a->x[2][i] == b->x[2][i] &&
        a->inv_h[i] == b->inv_h[i] && a->weight[i] == b->weight[i] && a->value[i] == b->value[i],
      "place %d depends on the order of the input", i);
  }
}

/* `count` particles, all in few cells, `coincident` of them at one place. */
static void check_crowd(mcor_context* context, int count, int coincident)
{
  core_set set = core_make_random(count + 40, 0.5, 2, 2, (uint64_t)(count + coincident));
  uint64_t seed = 9;
  for (int i = 0; i < count + 40; ++i)
  {
    set.scalar[i] = (double)(random_bits(&seed) % 1000);
    set.volume[i] = i % 3 ? 1 : 2;
    for (int a = 0; a < 3; ++a)
    {
      double* x = set.position + 3 * i + a;
      *x = i < coincident ? 0.1 : i < count ? floor(*x * 30) / 30 : *x + 3;
      set.volume[i] = i < coincident ? 1 : set.volume[i];
    }
  }
  sorted_set sorted = sort_set(context, &set);
  check_sorted(context, &set, &sorted);
  int64_t* order = core_make_order(set.count, 4);
  core_set permuted = core_permute(&set, order);
  sorted_set other = sort_set(context, &permuted);
  check_same_order(&sorted, &other);
  free_sorted(&sorted);
  free_sorted(&other);
  core_free_set(&permuted);
  core_free_set(&set);
  free(order);
}

/* Cells with more particles than one work-item sorts, and more coincident ones. */
static void test_crowds(void** state)
{
  static const int counts[][2] = { { 63, 0 }, { 64, 64 }, { 65, 65 }, { 129, 129 }, { 128, 0 },
    { 257, 0 }, { 1000, 130 }, { 1000, 1000 }, { 5000, 700 }, { 20000, 0 }, { 20000, 9000 } };
  mcor_context* gpu = NULL;
  core_create_form(&gpu, "gpu");
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i)
  {
    check_crowd(*state, counts[i][0], counts[i][1]);
    check_crowd(gpu, counts[i][0], counts[i][1]);
  }
  mcor_free_context(gpu);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_query),
    cmocka_unit_test(test_cube_root), cmocka_unit_test(test_estimate),
    cmocka_unit_test(test_crowds) };
  return cmocka_run_group_tests_name("grid", tests, core_set_up, core_tear_down);
}
