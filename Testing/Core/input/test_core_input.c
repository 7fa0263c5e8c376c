/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Checks that bad input of every kind gives its status, its message and an empty surface, and that the context goes on
 * working. */

#include "core_fixture.h"

/* A good call. A test makes one thing in it bad. */
typedef struct bad_call
{
  particle_set set;
  mcor_input input;
  mcor_options options;
  double* iso;    /* [2] */
  double* vector; /* [count][3] */
} bad_call;

static bad_call make_call(void)
{
  static const double iso[2] = { 0, 0.2 };
  bad_call call = { .set = core_make_block(4, 0, 1, core_slope) };
  call.input = core_input(&call.set);
  call.vector = core_copy(call.set.position, (size_t)call.set.count * 3 * sizeof(double));
  call.iso = core_copy(iso, sizeof iso);
  call.options = core_options(call.iso);
  return call;
}

static void free_call(bad_call* call)
{
  particle_set_free(&call->set);
  free(call->vector);
  free(call->iso);
}

/* Checks that the call fails with the status and a message in which core_told finds the words. */
static void expect(
  mcor_context* context, const bad_call* call, mcor_status status, const char* words)
{
  mcor_surface surface;
  memset(&surface, 0x5a, sizeof surface);
  const mcor_status got = mcor_extract(context, &call->input, &call->options, &surface);
  const char* error = mcor_last_error(context);
  CORE_CHECK(got == status, mcor_status_name(got), mcor_status_name(status), error);
  const mcor_surface empty = { 0 };
  assert_true(memcmp(&surface, &empty, sizeof empty) == 0);
  CORE_CHECK(core_told(context, words), words, error);
  CORE_CHECK(error[strlen(error) - 1] == '.', error);
}

/* Checks that a good call works after the failures. */
static void expect_good(mcor_context* context)
{
  CORE_OWNED(free_call) bad_call call = make_call();
  CORE_SURFACE surface = core_extract(context, &call.input, &call.options);
  assert_true(surface.triangle_count > 0);
  assert_string_equal(mcor_last_error(context), "");
}

#define BAD(context, status, words, ...)                                                           \
  do                                                                                               \
  {                                                                                                \
    CORE_OWNED(free_call) bad_call call = make_call();                                             \
    __VA_ARGS__;                                                                                   \
    expect(context, &call, status, words);                                                         \
  } while (0)

#define ARGUMENT(words, ...) BAD(*state, MCOR_INVALID_ARGUMENT, words, __VA_ARGS__)
#define DATA(words, ...) BAD(*state, MCOR_INVALID_DATA, words, __VA_ARGS__)
#define CAPACITY(words, ...) BAD(*state, MCOR_OUT_OF_CAPACITY, words, __VA_ARGS__)

static void test_types(void** state)
{
  ARGUMENT("ARRAY_TYPE|position", call.input.positions.type = (mcor_type)7);
  ARGUMENT("ARRAY_TYPE|scalar", call.input.scalar.type = (mcor_type)7);
  expect_good(*state);
}

/* Illegal values of options, and how many there are. NaN and infinity are tried with doubles alone. */
#define ABOVE_0 { 0, -1, NAN, INFINITY }, 4
#define AT_LEAST_0 { -1, NAN, INFINITY }, 3
#define FROM(low, high) { (low)-1, (high) + 1 }, 2
#define SHARE { -0.1, 1, NAN }, 3
#define WORD { -1, 99 }, 2
#define FLAG { 0 }, 0
#define OPTION(member, usual, legal, words, scope, Property)                                       \
  static void set_##member(mcor_options* options, double value)                                    \
  {                                                                                                \
    options->member = (__typeof__(options->member))_Generic(options->member, double                \
                                                            : value, default                       \
                                                            : (long)value);                        \
  }
#include "mcor_options.def"

/* Checks that each illegal value is refused with a message that names the option. */
static void test_options(void** state)
{
  static const struct
  {
    const char* name;
    void (*set)(mcor_options* options, double value);
    bool is_double;
    double bad[4];
    int count;
  } rows[] = {
#define OPTION(member, usual, legal, words, scope, Property)                                       \
  { #member, set_##member,                                                                         \
    _Generic(((mcor_options*)NULL)->member, double                                                 \
             : true, default                                                                       \
             : false),                                                                             \
    legal },
#include "mcor_options.def"
  };
  for (size_t r = 0; r < sizeof rows / sizeof rows[0]; ++r)
  {
    for (int i = 0; i < rows[r].count; ++i)
    {
      if (rows[r].is_double || isfinite(rows[r].bad[i]))
      {
        ARGUMENT(rows[r].name, rows[r].set(&call.options, rows[r].bad[i]));
      }
    }
  }
  ARGUMENT("OPTION_ILLEGAL|{sph_kernel}|-1", call.options.sph_kernel = (mcor_sph_kernel)-1);
  ARGUMENT("OPTION_NOT_A_WORD|{field}|3", call.options.field = (mcor_field)3);
  ARGUMENT("OPTION_ILLEGAL|{h_scale}|above 0", call.options.h_scale = 0);
  ARGUMENT("OPTION_ILLEGAL|{wall_share}|below 1", call.options.wall_share = 1);
  ARGUMENT("OPTION_ILLEGAL|{node_threshold}|at least 0", call.options.node_threshold = -1);
  ARGUMENT(
    "OPTION_ILLEGAL|{cube_size}|inf|at least 0 and finite", call.options.cube_size = INFINITY);
  ARGUMENT("OPTION_ILLEGAL|{iteration_limit}|0|1 |255", call.options.iteration_limit = 0);
  ARGUMENT("OPTION_ILLEGAL|{iteration_limit}|256|255", call.options.iteration_limit = 256);
  ARGUMENT("ISO_COUNT|-1", call.options.iso_count = -1);
  ARGUMENT("ISO_COUNT|is 1", call.options.iso_values = NULL);
  ARGUMENT("ATTRIBUTE_COUNT|-1", call.input.attribute_count = -1);
  ARGUMENT("ATTRIBUTES_NULL|2", call.input.attribute_count = 2);
  ARGUMENT("ISO_NOT_FINITE| 1 ", call.options.iso_count = 2; call.iso[1] = NAN);
  ARGUMENT("ISO_NOT_FINITE| 0 ", call.iso[0] = -INFINITY);
  ARGUMENT("ISO_OF_FREE_SURFACE|0.5", call.options.field = MCOR_WEIGHT_SUM);
  static const double boxes[][6] = { { 1, 0, 0, 1, 0, 1 }, { 0, 1, 2, 2, 0, 1 },
    { 0, 1, 0, 1, 0, NAN }, { 0, 1, 0, 1, NAN, 1 }, { INFINITY, INFINITY, 0, 1, 0, 1 } };
  static const char* const along[] = { "BOX_ILLEGAL|along x", "BOX_ILLEGAL|along y",
    "BOX_ILLEGAL|along z", "BOX_ILLEGAL|along z", "BOX_ILLEGAL|along x" };
  for (int i = 0; i < 5; ++i)
  {
    ARGUMENT(along[i], memcpy(call.options.box, boxes[i], sizeof boxes[i]));
  }
  expect_good(*state);
}

static int reduce_none(void* user, mcor_reduction reduction, double* values, int count)
{
  (void)user, (void)reduction, (void)values, (void)count;
  return 0;
}

/* MCOR_PAIRS serves only comparisons with the paper, so other features refuse it. */
static void test_pairs(void** state)
{
  const mcor_ranks ranks = { .reduce_doubles = reduce_none };
  const double levels[4] = { 1, 1, 1, 5 };
  ARGUMENT("PAIRS_WITH|{box}", call.options.seeds = MCOR_PAIRS; call.options.box[1] = 1);
  ARGUMENT("PAIRS_WITH|{capping}", call.options.seeds = MCOR_PAIRS;
           call.options.capping = MCOR_CAP_PERIOD);
  ARGUMENT("PAIRS_WITH|Several processes", call.options.seeds = MCOR_PAIRS;
           call.options.ranks = &ranks);
  ARGUMENT(
    "PAIRS_WITH_LEVELS|up to 3", call.options.seeds = MCOR_PAIRS;
    call.options.level_limit = MCOR_CUBE_LEVELS - 1;
    for (int64_t i = 0; i < call.set.count; ++i) call.set.smoothing_length[i] *= levels[i % 4]);
  expect_good(*state);
}

static void test_missing_arrays(void** state)
{
  ARGUMENT("NO_POSITIONS", call.input.positions.data = NULL);
  ARGUMENT("LENGTH_MISSING", call.input.smoothing_length = (mcor_array){ .data = NULL });
  ARGUMENT("SCALAR_MISSING", call.input.scalar.data = NULL);
  CAPACITY("PARTICLES_TOO_MANY|-1", call.input.count = -1);
  CAPACITY("PARTICLES_TOO_MANY", call.input.count = INT64_C(1) << 31);
  expect_good(*state);
}

static void test_components(void** state)
{
  ARGUMENT(
    "SCALAR_COMPONENT|Component 3|flow|0 to 2", call.input.scalar = core_array(call.vector, 3);
    call.input.scalar.name = "flow"; call.input.scalar_component = 3);
  ARGUMENT("SCALAR_COMPONENT|-2|0 to 2", call.input.scalar = core_array(call.vector, 3);
           call.input.scalar_component = -2);
  ARGUMENT("DOT_COMPONENTS|3|1", call.input.scalar = core_array(call.vector, 3);
           call.input.scalar_dot = core_array(call.set.scalar, 1));
  ARGUMENT("ARRAY_COMPONENTS|smoothing length|hsml|3 |have 1",
           call.input.smoothing_length = core_array(call.vector, 3);
           call.input.smoothing_length.name = "hsml");
  ARGUMENT("ARRAY_COMPONENTS|volume array has -1 |have 1.", call.input.volume.components = -1);
  ARGUMENT("ARRAY_COMPONENTS|scalar|-2 ", call.input.scalar.components = -2);
  expect_good(*state);
}

/* Checks that the message on a bad element names the array and the particle. */
static void test_bad_elements(void** state)
{
  const double bad[] = { NAN, INFINITY, -INFINITY, 0, -1 };
  const char* const how[] = { "(NaN)", "infinite", "infinite", "not above 0", "not above 0" };
  DATA("VOLUME_TOO_LARGE|particle 2|single", call.set.volume[2] = 1e35);
  for (int i = 0; i < 5; ++i)
  {
    char words[100];
    snprintf(words, sizeof words, "ARRAY_VALUE|smoothing length|hsml|particle 63|%s", how[i]);
    DATA(words, call.set.smoothing_length[63] = bad[i]; call.input.smoothing_length.name = "hsml");
    snprintf(words, sizeof words, "ARRAY_VALUE|volume|particle 7|%s", how[i]);
    DATA(words, call.set.volume[7] = bad[i]);
    snprintf(words, sizeof words, "ARRAY_VALUE|mass|particle 8|%s", how[i]);
    DATA(words, call.input.volume = (mcor_array){ 0 };
         call.input.mass = core_array(call.set.volume, 1); call.set.volume[8] = bad[i]);
    snprintf(words, sizeof words, "ARRAY_VALUE|density|particle 9|%s", how[i]);
    DATA(words, call.input.volume = (mcor_array){ 0 };
         call.input.mass = core_array(call.set.smoothing_length, 1);
         call.input.density = core_array(call.set.volume, 1); call.set.volume[9] = bad[i]);
    snprintf(words, sizeof words, "CONSTANT_VALUE|smoothing length|%s", how[i]);
    if (bad[i] != 0)
    {
      DATA(words, call.input.smoothing_length = (mcor_array){ .constant = bad[i] });
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    char words[100];
    snprintf(words, sizeof words, "ARRAY_VALUE|position|particle 63|%s", how[i]);
    DATA(words, call.set.position[191] = bad[i]);
    snprintf(words, sizeof words, "ARRAY_VALUE|scalar|p|particle 0|%s", how[i]);
    DATA(words, call.set.scalar[0] = bad[i]; call.input.scalar.name = "p");
    snprintf(words, sizeof words, "particle 1|%s", how[i]);
    DATA(words, call.vector[5] = bad[i]; call.input.scalar = core_array(call.vector, 3);
         call.input.scalar_dot = core_array(call.vector, 3));
  }
  expect_good(*state);
}

static void test_particles(void** state)
{
  DATA("NO_FLUID|64", call.set.has_solids = 1; memset(call.set.solid, 1, 64);
       call.input.solid = call.set.solid);
  DATA("ESTIMATE_AT_ONE_POINT", call.input.estimate_smoothing_length = 1;
       memset(call.set.position, 0, 64 * 3 * sizeof(double)));
  expect_good(*state);
}

/* Sets one coordinate of nine particles to `to`. Nine are more than may be left out. */
static void move_far(bad_call* call, int axis, double to)
{
  for (int i = 0; i < 9; ++i)
  {
    call->set.position[3 * i + axis] = to;
  }
}

/* Checks that lattices that do not fit are refused, with a message that says what to do. */
static void test_lattice_limits(void** state)
{
  CAPACITY("GRID_TOO_LONG|along x;", move_far(&call, 0, 1e9));
  CAPACITY("GRID_TOO_LONG|along z;", move_far(&call, 2, -1e300));
  CAPACITY("1e-09|larger {cube_size}", call.options.cube_size = 1e-9);
  CAPACITY(
    "PARTICLES_TOO_FAR|1e+15|{within}",
    for (int64_t i = 0; i < 3 * call.set.count; ++i) { call.set.position[i] += 1e15; });
  CAPACITY("cube size", call.options.cube_size_factor = 1e-300);
  CAPACITY("cube size", call.set.smoothing_length[5] = 1e-30);
  CAPACITY("cube size", call.set.smoothing_length[5] = 1e300);
  CAPACITY("cube size", call.options.h_scale = 1e30);
  expect_good(*state);
}

static void test_null_arguments(void** state)
{
  mcor_context* context = *state;
  CORE_OWNED(free_call) bad_call call = make_call();
  mcor_surface surface = { .point_count = 3 };
  assert_int_equal(mcor_extract(NULL, &call.input, &call.options, &surface), MCOR_INVALID_ARGUMENT);
  assert_int_equal(mcor_extract(context, &call.input, &call.options, NULL), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(context, "NULL_POINTER|surface must not"));
  assert_int_equal(mcor_extract(context, NULL, &call.options, &surface), MCOR_INVALID_ARGUMENT);
  assert_int_equal(surface.point_count, 0);
  assert_int_equal(mcor_extract(context, &call.input, NULL, &surface), MCOR_INVALID_ARGUMENT);
  assert_non_null(strstr(mcor_last_error(context), "NULL"));
  assert_int_equal(mcor_create_context(NULL, NULL), MCOR_INVALID_ARGUMENT);
  assert_int_equal(mcor_list_devices(NULL), MCOR_INVALID_ARGUMENT);
  assert_true(strlen(mcor_last_error(NULL)) > 0);
  mcor_set_default_options(NULL);
  mcor_free_context(NULL);
  mcor_free_surface(NULL);
  mcor_release_memory(NULL);
  expect_good(context);
}

/* Checks that no particles, no iso value, an iso value outside the range, or one particle give an
 * empty surface and no error. */
static void test_empty_results(void** state)
{
  for (int kind = 0; kind < 5; ++kind)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    call.iso[0] = kind == 2 ? 1e30 : kind == 3 ? -100 : call.set.scalar[0];
    call.options.iso_count = kind != 1;
    call.input.count = kind == 0 ? 0 : kind == 4 ? 1 : call.input.count;
    CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
    CORE_CHECK(
      surface.point_count == 0 && surface.triangle_count == 0, kind, surface.triangle_count);
  }
  expect_good(*state);
}

/* Checks scalars whose range is greater than the precision allows. */
static void test_endless_range(void** state)
{
  static const struct
  {
    double most;
    mcor_type precision;
    bool is_good;
  } cases[] = { { 1.7e308, MCOR_FLOAT32, false }, { 1.7e308, MCOR_FLOAT64, false },
    { 1e200, MCOR_FLOAT32, false }, { 1e200, MCOR_FLOAT64, true }, { 1e30, MCOR_FLOAT32, true } };
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    call.options.precision = cases[k].precision;
    for (int64_t i = 0; i < call.set.count; ++i)
    {
      call.set.scalar[i] = i % 2 ? cases[k].most : -cases[k].most;
    }
    if (!cases[k].is_good)
    {
      expect(*state, &call, MCOR_INVALID_DATA, "too large for|precision");
      continue;
    }
    CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
    CORE_CHECK(surface.triangle_count > 0, cases[k].most);
    for (int64_t i = 0; i < 3 * surface.point_count; ++i)
    {
      CORE_CHECK(isfinite(surface.normals[i]), cases[k].most);
    }
  }
  expect_good(*state);
}

/* Checks that an attribute with a value that is not finite is left out with a warning, and that the other attributes do
 * not change. */
static void test_bad_attributes(void** state)
{
  const double bad[] = { NAN, INFINITY, -INFINITY };
  for (int k = 0; k < 3; ++k)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    const mcor_array attributes[] = { core_array(call.set.volume, 1), core_array(call.vector, 3),
      { .constant = bad[k] }, core_array(call.set.scalar, 1) };
    call.input.attributes = attributes;
    call.input.attribute_count = 4;
    CORE_SURFACE good = core_extract(*state, &call.input, &call.options);
    call.vector[3 * 21 + 2] = call.vector[3 * 40] = bad[k];
    CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
    const size_t n = (size_t)surface.point_count;
    CORE_CHECK(n > 20 && good.point_count == (int64_t)n, n);
    const int64_t expected[] = { -1, 21, 0, -1 };
    for (int a = 0; a < 4; ++a)
    {
      assert_int_equal(surface.attribute_not_finite[a], expected[a]);
      assert_int_equal(surface.attributes[a] == NULL, expected[a] >= 0);
    }
    assert_int_equal(good.attribute_not_finite[1], -1);
    assert_memory_equal(good.attributes[0], surface.attributes[0], n * sizeof(double));
    assert_memory_equal(good.attributes[3], surface.attributes[3], n * sizeof(double));
  }
  expect_good(*state);
}

/* Checks that values of the scalar and of attributes at solids do not matter. */
static void test_values_of_solids(void** state)
{
  const double values[] = { 0.5, NAN, INFINITY, -1e300 };
  uint64_t expected = 0;
  for (int k = 0; k < 4; ++k)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    for (int64_t i = 0; i < call.set.count; ++i)
    {
      call.set.solid[i] = i % 3 == 0;
      call.set.scalar[i] = i % 3 == 0 ? values[k] : call.set.scalar[i];
      call.vector[3 * i + 1] = i % 3 == 0 ? values[k] : call.vector[3 * i + 1];
    }
    call.input.solid = call.set.solid;
    const mcor_array attribute = core_array(call.vector, 3);
    call.input.attributes = &attribute;
    call.input.attribute_count = 1;
    CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
    expected = k == 0 ? core_hash(&surface) : expected;
    CORE_CHECK(surface.point_count > 20 && core_hash(&surface) == expected, values[k]);
    assert_int_equal(surface.attribute_not_finite[0], -1);
  }
}

/* Gives each particle a vector of magnitude unit * (scalar + 10). */
static void make_vectors(bad_call* call, double unit)
{
  for (int64_t i = 0; i < call->set.count; ++i)
  {
    const double s = unit * (call->set.scalar[i] + 10);
    call->vector[3 * i] = 0.6 * s;
    call->vector[3 * i + 1] = i % 2 ? -0.8 * s : 0.8 * s;
    call->vector[3 * i + 2] = 0;
  }
  call->input.scalar = core_array(call->vector, 3);
  call->input.scalar.name = "flow";
  call->input.scalar_component = MCOR_MAGNITUDE;
  call->iso[0] = 10 * unit;
  call->options.precision = MCOR_FLOAT64;
}

/* Checks magnitudes whose squares overflow or vanish. */
static void test_magnitudes(void** state)
{
  const double units[] = { 1, 0x1p530, 0x1p-560, 0x1p-900 };
  int64_t points = 0;
  for (int k = 0; k < 4; ++k)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    make_vectors(&call, units[k]);
    CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
    points = k == 0 ? surface.point_count : points;
    CORE_CHECK(points > 20 && surface.point_count == points, units[k], surface.point_count, points);
    const double most = surface.statistics.scalar_max / units[k];
    CORE_CHECK(most > 10 && most < 20, units[k], most);
  }
}

/* Checks vectors with finite components whose magnitude or dot product is infinite, and a finite dot product
 * whose single products are infinite. */
static void test_bad_products(void** state)
{
  const double far = 1.7e308;
  DATA("MAGNITUDE_TOO_LARGE|flow|particle 21", make_vectors(&call, 1);
       call.vector[63] = call.vector[64] = call.vector[90] = call.vector[91] = far);
  DATA("DOT_TOO_LARGE|flow and force|particle 21", make_vectors(&call, 1); call.vector[64] = 1e200;
       call.input.scalar_dot = call.input.scalar; call.input.scalar_dot.name = "force");
  DATA("DOT_TOO_LARGE|particle 1", make_vectors(&call, 1); call.options.precision = MCOR_FLOAT32;
       call.vector[3] = 1e250; call.vector[4] = 1e249; call.input.scalar_dot = call.input.scalar);
  /* A plain sum of the products would be inf - inf, but the result is finite. */
  CORE_OWNED(free_call) bad_call call = make_call();
  make_vectors(&call, 1);
  CORE_FREED double* other = core_copy(call.vector, (size_t)call.set.count * 3 * sizeof(double));
  call.input.scalar_dot = core_array(other, 3);
  call.iso[0] = 100;
  call.vector[3] = call.vector[4] = other[3] = 1e200;
  other[4] = -1e200;
  CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
  CORE_CHECK(surface.point_count > 20 && surface.statistics.scalar_min == 0, surface.point_count,
    surface.statistics.scalar_min);
  for (int64_t i = 0; i < 3 * surface.point_count; ++i)
  {
    assert_true(isfinite(surface.points[i]) && isfinite(surface.normals[i]));
  }
  expect_good(*state);
}

/* Checks that the message on values too small for a computed volume does not blame the SPH kernel. */
static void test_computed_volumes(void** state)
{
  DATA("MASS_TOO_SMALL|particle 5", call.input.volume = (mcor_array){ 0 };
       call.input.mass = core_array(call.set.volume, 1); call.set.volume[5] = 5e-324;
       call.set.position[15] = 40);
  ARGUMENT(
    "H_SCALE_TOO_SMALL|1e-13", call.input.volume = (mcor_array){ 0 }; call.options.h_scale = 1e-13;
    call.input.smoothing_length = (mcor_array){ .constant = 1.3e13 }; call.options.cube_size = 0.5);
  expect_good(*state);
}

/* Checks that positions times 2^-300 and 2^300 give the same surface, equally scaled, with the same normals of its
 * triangles. Smoothing lengths are estimated. More extreme factors must be refused. */
static void test_units_of_length(void** state)
{
  const double units[] = { 1, 0x1p-300, 0x1p300, 0x1p-340, 0x1p340 };
  CORE_SURFACE first = { 0 };
  for (int k = 0; k < 5; ++k)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    for (int64_t i = 0; i < 3 * call.set.count; ++i)
    {
      call.set.position[i] *= units[k];
    }
    call.input.volume = (mcor_array){ 0 };
    call.input.estimate_smoothing_length = 1;
    call.options.triangle_normals = 1;
    if (k > 2)
    {
      expect(*state, &call, MCOR_OUT_OF_CAPACITY, "cube size|between|unit of length");
      continue;
    }
    mcor_surface surface = core_extract(*state, &call.input, &call.options);
    CORE_CHECK(surface.point_count > 20, surface.point_count);
    for (int64_t i = 0; k > 0 && i < 3 * surface.point_count; ++i)
    {
      CORE_CHECK(surface.points[i] == first.points[i] * units[k], units[k]);
      CORE_CHECK(surface.normals[i] == first.normals[i], units[k]);
    }
    k == 0 ? (void)(first = surface) : mcor_free_surface(&surface);
  }
  expect_good(*state);
}

/* Checks that iso values and thresholds too large for the device's numbers give an empty surface
 * and no error. */
static void test_far_options(void** state)
{
  const double far[] = { 1e36, 1e39, 1e308 };
  for (int k = 0; k < 24; ++k)
  {
    CORE_OWNED(free_call) bad_call call = make_call();
    call.iso[0] = k < 12 ? (k % 2 ? -1 : 1) * far[k % 3] : 0;
    call.options.node_threshold = k >= 12 && k % 2 ? far[k % 3] : 0.1;
    call.options.vertex_threshold = k >= 12 && k % 2 == 0 ? far[k % 3] : 0.5;
    call.options.boundary_detection =
      k % 4 / 2 ? MCOR_BOUNDARY_EIGENVALUE : MCOR_BOUNDARY_WEIGHT_SUM;
    call.options.field = k / 6 % 2 ? MCOR_SUM : MCOR_SHEPARD;
    CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
    CORE_CHECK(surface.triangle_count == 0, k, surface.triangle_count);
  }
  expect_good(*state);
}

static void repeat(bad_call* call, double length, double from)
{
  for (int a = 0; a < 3; ++a)
  {
    call->options.periodic[2 * a + 1] = length;
  }
  for (int64_t i = 0; i < 3 * call->set.count; ++i)
  {
    call->set.position[i] += from;
  }
}

/* Checks that the message names the cause: an extreme smoothing length, far places, or an unsuitable period. */
static void test_outliers(void** state)
{
  CAPACITY("GRID_TOO_LONG|along x;|Particle 7 has a smoothing length of 1.3e-06|median is 1.3",
    call.set.smoothing_length[7] = 1.3e-6);
  CAPACITY("GRID_TOO_LONG|along x;|Particle 7 has a smoothing length of 1.3e+06|median is 1.3",
    call.set.smoothing_length[7] = 1.3e6);
  CAPACITY("PERIOD_TOO_LONG|Particle 7 has a smoothing length of 1.3e-06",
           call.set.smoothing_length[7] = 1.3e-6;
           repeat(&call, 10, 0));
  CAPACITY("PARTICLES_TOO_FAR|1e+15|{within}", repeat(&call, 10, 1e15));
  ARGUMENT("CUBE_TOO_LARGE_FOR_PERIOD|size 4 |10 along x|1.5", call.options.cube_size = 4;
           repeat(&call, 10, 0));
  ARGUMENT("PERIOD_TOO_SHORT", repeat(&call, 3, 0));
  expect_good(*state);
}

/* Checks when a free surface is suggested: if a cube is full of particles, only for a liquid or if there are solids; if
 * a part of one octant is empty, always. There are enough particles for several threads. */
static void test_free_surface_comes_first(void** state)
{
  CORE_SET set = core_make_block(54, 0.2, 5, core_slope);
  mcor_input input = core_input(&set);
  input.volume = (mcor_array){ 0 };
  assert_int_equal(mcor_has_free_surface(&input, NULL), 0);
  input.density = core_array(set.volume, 1); /* all 1: a liquid */
  assert_int_equal(mcor_has_free_surface(&input, NULL), 1);
  set.smoothing_length[0] *= 1.01;
  assert_int_equal(mcor_has_free_surface(&input, NULL), 0);
  input.solid = set.solid;
  set.solid[set.count - 1] = 1;
  assert_int_equal(mcor_has_free_surface(&input, NULL), 1);
  set.solid[set.count - 1] = MCOR_ABSENT;
  assert_int_equal(mcor_has_free_surface(&input, NULL), 0);
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double* x = set.position + 3 * i;
    set.solid[i] = x[0] > 0 && x[1] > 0 && x[2] > 0 && x[2] < 25 ? MCOR_ABSENT : 0;
  }
  assert_int_equal(mcor_has_free_surface(&input, NULL), 1);
  (void)state;
}

CORE_MAIN(core_set_up, core_tear_down, test_free_surface_comes_first, test_types, test_options,
  test_pairs, test_missing_arrays, test_components, test_bad_elements, test_particles,
  test_lattice_limits, test_null_arguments, test_empty_results, test_endless_range,
  test_values_of_solids, test_bad_attributes, test_magnitudes, test_bad_products,
  test_computed_volumes, test_units_of_length, test_far_options, test_outliers)
