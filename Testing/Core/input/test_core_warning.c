/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Checks that each fault of the input gives one warning with figures, and that sound input gives
 * none. */

#include "core_fixture.h"

typedef struct warning_call
{
  particle_set set;
  mcor_input input;
  mcor_options options;
  double iso[2];
} warning_call;

static void begin_call(warning_call* call)
{
  memset(call, 0, sizeof *call);
  call->set = core_make_block(10, 0.2, 3, core_ball);
  call->input = core_input(&call->set);
  call->options = core_options(call->iso);
}

/* Checks that the call gives only the warning `expected`, with this code and all of `words` (| separates them), or no
 * warning if `words` is NULL. Returns the number of warnings. */
static int check_call(mcor_context* context, warning_call* call, const char* name,
  mcor_warning expected, mcor_says code, const char* words)
{
  CORE_SURFACE surface = core_extract(context, &call->input, &call->options);
  int count = 0;
  for (int w = 0; w < MCOR_WARNING_COUNT; ++w)
  {
    CORE_MESSAGE message =
      mcor_describe_warning((mcor_warning)w, &call->input, &call->options, &surface);
    const char* text = message.text;
    count += text != NULL;
    CORE_CHECK((text != NULL) == (words && w == (int)expected), name, w, text ? text : "not given");
    CORE_CHECK(!text || message.code == code, name, mcor_says_name(message.code));
    CORE_CHECK(!text || core_tells(&message, words), name, words, text);
  }
  particle_set_free(&call->set);
  return count;
}

#define SILENT(statement)                                                                          \
  do                                                                                               \
  {                                                                                                \
    warning_call call;                                                                             \
    begin_call(&call);                                                                             \
    statement;                                                                                     \
    assert_int_equal(                                                                              \
      check_call(*state, &call, #statement, MCOR_WARNING_COUNT, MCOR_SAYS_NOTHING, NULL), 0);      \
  } while (0)

#define WARNED(kind, code, words, statement)                                                       \
  do                                                                                               \
  {                                                                                                \
    warning_call call;                                                                             \
    begin_call(&call);                                                                             \
    statement;                                                                                     \
    assert_int_equal(check_call(*state, &call, #statement, kind, MCOR_SAYS_##code, words), 1);     \
  } while (0)

/* Writes a word for a slot of a message. Returns whether the slot is known; an unknown slot stays as it is. */
static int word_of(void* user, const char* name, const char* value, char* word, size_t size)
{
  (void)user;
  snprintf(word, size, "<%s|%s>", name, value);
  return strcmp(name, "unknown") != 0;
}

static void expect_filled(const char* text, mcor_word word, const char* expected)
{
  char* filled = mcor_fill_slots(text, word, NULL);
  assert_string_equal(filled, expected);
  free(filled);
}

static void test_slots(void** state)
{
  expect_filled(
    "a {cube_size} b {unknown}, {x y z}.", word_of, "a <cube_size|> b {unknown}, <x|y z>.");
  expect_filled("{cube_size} {precision double}", NULL, "cube_size precision=double");
  expect_filled("{cube_size} {precision double} {field sum} {smoothing_length}", mcor_label_word,
    "Cube Size Field Precision double Shepard Normalization off Smoothing Length Array");
  expect_filled("{} { cube_size} {Cube} {no_option} {cube_size", NULL,
    "{} { cube_size} {Cube} {no_option} {cube_size");
  char text[600] = "{fluid ";
  memset(text + 7, 'x', 590);
  text[597] = '}';
  expect_filled(text, NULL, text);
  assert_null(mcor_fill_slots(NULL, NULL, NULL));
  for (int code = 0; code < MCOR_SAYS_COUNT; ++code)
  {
    CORE_FREED char* text_in_c = mcor_fill_slots(mcor_says_text((mcor_says)code), NULL, NULL);
    CORE_FREED char* label =
      mcor_fill_slots(mcor_says_text((mcor_says)code), mcor_label_word, NULL);
    CORE_CHECK(
      strncmp(label, "{%s}", 4) == 0 || (!strpbrk(text_in_c, "{}") && !strpbrk(label, "{}")),
      label);
  }
  assert_null(mcor_says_text(MCOR_SAYS_COUNT));
}

static const mcor_array half = { .constant = 0.65 }, twice = { .constant = 2.6 },
                        wide = { .constant = 2.1 }, far_off = { .constant = 0.0013 };

/* Moves every other particle close to the particle before it, as near as particles of a gas may be. */
static void pair_up(particle_set* set)
{
  for (int64_t i = 3; i + 2 < 3 * set->count; i += 6)
  {
    for (int a = 0; a < 3; ++a)
    {
      set->position[i + a] = set->position[i - 3 + a] + (a == 0 ? 0.3 : 0);
    }
  }
}

static void test_neighbours(void** state)
{
  SILENT((void)call);
  SILENT(call.options.sph_kernel = MCOR_QUINTIC_SPLINE);
  SILENT(call.options.sph_kernel = MCOR_M_PRIME_4);
  SILENT(call.options.h_scale = 0.5);
  SILENT(call.options.field = MCOR_WEIGHT_SUM; call.iso[0] = 0.5);
  SILENT(call.input.estimate_smoothing_length = 1);
  SILENT(call.input.smoothing_length = twice; call.input.smoothing_length_is_support_radius = 1);
  SILENT(call.options.sph_kernel = MCOR_WENDLAND_C6; call.input.smoothing_length = wide);
  SILENT(pair_up(&call.set)); /* the number of neighbours is a usual one */
  WARNED(MCOR_WARN_NEIGHBOURS, NEIGHBOURS_UNUSUAL, "quartic|60 to 200|1 to 1.7|wendland",
         call.options.sph_kernel = MCOR_QUARTIC_SPLINE;
         call.input.smoothing_length = wide);
  WARNED(MCOR_WARN_NEIGHBOURS, NEIGHBOURS_UNUSUAL,
    "2.6|30 to 100|cubic|{smoothing_length_is_support_radius}",
    call.input.smoothing_length = twice);
  WARNED(MCOR_WARN_NEIGHBOURS, NEIGHBOURS_UNUSUAL, "is 0.65|not the support radius",
         call.input.smoothing_length_is_support_radius = 1;
         call.options.vertex_threshold = 0);
  WARNED(MCOR_WARN_NEIGHBOURS, NEIGHBOURS_UNUSUAL,
    "is 0.65|unit of the positions; {estimate_smoothing_length} and {volume computed}",
         call.input.smoothing_length = half;
         call.options.vertex_threshold = 0);
  WARNED(
    MCOR_WARN_NEIGHBOURS, NEIGHBOURS_UNUSUAL,
    "1 neighbour within|no other particle|unit of the positions", call.input.smoothing_length = far_off;
    call.options.cube_size = 1; call.options.node_threshold = 0; call.options.vertex_threshold = 0);
  /* For an empty surface, one warning must tell the cause. */
  WARNED(MCOR_WARN_NEIGHBOURS, NEIGHBOURS_UNUSUAL, "is 0.0013", call.input.smoothing_length = far_off;
         call.options.cube_size = 1);
  WARNED(MCOR_WARN_NEIGHBOURS, VOLUMES_TOO_LARGE, "{volume}",
    call.input.volume = (mcor_array){ .constant = 1000 });
  WARNED(MCOR_WARN_NEIGHBOURS, ALL_AT_ONE_POINT, "1000",
    memset(call.set.position, 0, 3000 * sizeof(double)));
  SILENT(call.input.smoothing_length = twice; call.input.count = 60; call.iso[0] = -30;
         call.options.vertex_threshold = 0); /* nothing is unusual here */
  /* Without any neighbour, the warning suggests no SPH kernel. */
  warning_call alone;
  begin_call(&alone);
  alone.input.smoothing_length = far_off;
  alone.options.cube_size = 1;
  CORE_SURFACE surface = core_extract(*state, &alone.input, &alone.options);
  CORE_MESSAGE message =
    mcor_describe_warning(MCOR_WARN_NEIGHBOURS, &alone.input, &alone.options, &surface);
  assert_non_null(message.text);
  assert_null(strstr(message.text, "wendland"));
  particle_set_free(&alone.set);
}

/* Puts the particles into rows and columns, 1.1 apart along x and z. Along y they have seven places, `height` apart. */
static void flatten(particle_set* set, double height)
{
  for (int64_t i = 0; i < set->count; ++i)
  {
    set->position[3 * i] = 1.1 * (double)(i % 32);
    set->position[3 * i + 1] = height * (double)(i % 7);
    set->position[3 * i + 2] = 1.1 * (double)(i / 32);
  }
}

/* Flattens the set and turns it about the z axis. The last `off` particles lie a smoothing length off the plane. */
static void tilt(particle_set* set, double height, int off)
{
  flatten(set, height);
  for (int64_t i = 0; i < set->count; ++i)
  {
    double* x = set->position + 3 * i;
    const double u = x[0], v = x[1] + (i >= set->count - off ? 1.3 : 0);
    x[0] = 0.8 * u - 0.6 * v + 3;
    x[1] = 0.6 * u + 0.8 * v - 5;
  }
}

static void test_tilted_plane(void** state)
{
  WARNED(MCOR_WARN_PLANE, PLANE_TILTED, "(0.6, -0.8, |{dimension 3}", tilt(&call.set, 0, 0);
         call.options.vertex_threshold = 0);
  WARNED(MCOR_WARN_PLANE, PLANE_TILTED, "is 0.0", tilt(&call.set, 0.003, 0);
         call.options.vertex_threshold = 0);
  SILENT(tilt(&call.set, 0, 0); call.options.vertex_threshold = 0; call.options.dimension = 3);
  SILENT(tilt(&call.set, 0.2, 0); call.options.vertex_threshold = 0);
  SILENT(tilt(&call.set, 0, 1); call.options.vertex_threshold = 0);
  SILENT(tilt(&call.set, 0, 0); call.input.count = 90; call.iso[0] = -30;
         call.options.vertex_threshold = 0);
}

static void test_plane(void** state)
{
  WARNED(MCOR_WARN_PLANE, PLANE_IN_SPACE, "along y|0 times", flatten(&call.set, 0);
         call.options.vertex_threshold = 0; call.options.dimension = 3);
  SILENT(flatten(&call.set, 0)); /* the particles are two-dimensional */
  WARNED(MCOR_WARN_PLANE, PLANE_IN_SPACE, "along y|is 0.06", flatten(&call.set, 0.01);
         call.options.vertex_threshold = 0);
  SILENT(flatten(&call.set, 0.2); call.options.vertex_threshold = 0);
  SILENT(flatten(&call.set, 0.01); /* so few particles give no warning */
         for (int i = 0; i < 81; ++i) {
           call.set.position[3 * i] = 1.5 * (i % 9);
           call.set.position[3 * i + 2] = 1.5 * (i / 9);
         } call.input.count = 81;
         call.iso[0] = -30; call.options.vertex_threshold = 0);
}

static void test_iso_value(void** state)
{
  WARNED(MCOR_WARN_ISO_VALUE, ISO_OUTSIDE, "100|scalar", call.iso[0] = 100);
  WARNED(MCOR_WARN_ISO_VALUE, ISO_OUTSIDE, "-1000|Height|to 8.", call.input.scalar.name = "Height";
         call.iso[0] = 0; call.iso[1] = -1000; call.options.iso_count = 2);
  WARNED(MCOR_WARN_ISO_VALUE, ISO_OUTSIDE, "100 (and 1 more)", call.iso[0] = 100;
         call.iso[1] = -1000; call.options.iso_count = 2);
  WARNED(MCOR_WARN_ISO_VALUE, ISO_OUTSIDE, "100", call.iso[0] = 100; call.options.field = MCOR_SUM);
  WARNED(MCOR_WARN_TRIMMED, ISO_NOT_REACHED, "{node_threshold 0}", call.iso[0] = 8.4;
         call.options.field = MCOR_SUM);
}

static void test_precision(void** state)
{
  WARNED(MCOR_WARN_PRECISION, GRID_TOO_LONG_FOR_SINGLE, "{precision double}",
         call.options.level_limit = MCOR_CUBE_LEVELS - 1;
         call.set.smoothing_length[5] = 1.3 / 40000);
  SILENT(call.options.level_limit = MCOR_CUBE_LEVELS - 1; call.set.smoothing_length[5] = 1.3 / 4000);
  SILENT(call.options.level_limit = MCOR_CUBE_LEVELS - 1; call.options.precision = MCOR_FLOAT64;
         call.set.smoothing_length[5] = 1.3 / 4000);
  SILENT(call.options.level_limit = MCOR_CUBE_LEVELS - 1; call.set.smoothing_length[5] = 1.3 / 100);
}

/* Makes a block of particles with a noisy scalar, and a smaller block beside it. */
static particle_set far_apart(double smaller)
{
  uint64_t seed = 3;
  CORE_SET large = core_make_block(6, 0.2, 3, core_slope),
           small = core_make_block(6, 0.2, 4, core_slope);
  particle_set set = particle_set_make(2 * large.count);
  for (int64_t i = 0; i < set.count; ++i)
  {
    const particle_set* from = i < large.count ? &large : &small;
    const int64_t n = i % large.count;
    const double size = from == &large ? 1 : smaller;
    for (int a = 0; a < 3; ++a)
    {
      set.position[3 * i + a] = size * from->position[3 * n + a] + (from == &large ? 0 : 40.03);
    }
    set.smoothing_length[i] = size * from->smoothing_length[n];
    set.volume[i] = size * size * size * from->volume[n];
    set.scalar[i] = random_unit(&seed);
  }
  return set;
}

/* Checks that residual_max is at least the greatest residual, computed in double precision, and at most four times as
 * large, even if positions are coarsely rounded. */
static void check_told_residual(mcor_context* context, const particle_set* set, mcor_field field)
{
  const double iso = 0.5;
  mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.field = field;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  const mcor_array points = { .data = surface.points, .type = MCOR_FLOAT64, .components = 3 };
  CORE_SAMPLES exact;
  options.precision = MCOR_FLOAT64;
  input.attributes = &input.scalar;
  input.attribute_count = 1;
  CORE_OK(context, mcor_probe(context, &input, &options, &points, surface.point_count, &exact));
  const double* value = field == MCOR_WEIGHT_SUM ? exact.weight_sum : exact.values[0];
  const double told = surface.statistics.residual_max;
  double worst = 0;
  for (int64_t v = 0; v < surface.point_count; ++v)
  {
    worst = fmax(worst, fabs(value[v] - iso));
  }
  CORE_CHECK(surface.point_count > 1000 && worst <= told + 2e-6 && told <= 4 * worst, field,
    surface.point_count, worst, told);
}

static void test_told_residual(void** state)
{
  static const double sizes[] = { 1.0 / 100, 1.0 / 4000, 1.0 / 10000 };
  for (int i = 0; i < 3; ++i)
  {
    CORE_SET set = far_apart(sizes[i]); /* Memory must not grow with the finest cubes between the blocks. */
    check_told_residual(*state, &set, MCOR_WEIGHT_SUM);
    check_told_residual(*state, &set, MCOR_SHEPARD);
  }
}

static void test_tolerance(void** state)
{
  SILENT(call.options.tolerance = 1e-9; call.options.preview = 1);
  WARNED(MCOR_WARN_TOLERANCE, OFF_ISO_VALUE, "{precision double}", call.options.tolerance = 1e-9);
  WARNED(MCOR_WARN_TOLERANCE, OFF_ISO_VALUE, "{iteration_limit}", call.options.iteration_limit = 1);
  SILENT(call.options.tolerance = 1e-9; call.options.precision = MCOR_FLOAT64);
  warning_call call; /* a residual that rounding explains gives no warning */
  begin_call(&call);
  call.options.tolerance = 1e-6;
  CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
  for (int i = 0; i < 2; ++i)
  {
    surface.statistics.vertices_above_tolerance = 2;
    surface.statistics.residual_max =
      (i ? 2e-5 : 2e-6) * (surface.statistics.scalar_max - surface.statistics.scalar_min);
    CORE_MESSAGE message =
      mcor_describe_warning(MCOR_WARN_TOLERANCE, &call.input, &call.options, &surface);
    CORE_CHECK((message.text != NULL) == (i == 1), mcor_says_name(message.code));
  }
  particle_set_free(&call.set);
}

static void test_trimmed(void** state)
{
  WARNED(MCOR_WARN_TRIMMED, ALL_TRIMMED, "triangles|weight sum|threshold 3",
    call.options.vertex_threshold = 3);
  WARNED(MCOR_WARN_TRIMMED, ALL_TRIMMED, "eigenvalue|threshold 3|{vertex_threshold 0.3}",
         call.options.vertex_threshold = 3;
         call.options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE);
  WARNED(MCOR_WARN_TRIMMED, ALL_TRIMMED, "threshold 0.5, or|wall share 0.01",
         call.options.wall_share = 0.01;
         call.set.has_solids = 1; for (int i = 0; i < 1000; ++i) call.set.solid[i] = i % 2 == 0;
         call.input = core_input(&call.set));
  WARNED(MCOR_WARN_TRIMMED, ALL_TRIMMED_BY_WALLS, "wall share 0.01",
         call.options.field = MCOR_WEIGHT_SUM;
         call.iso[0] = 0.4; call.options.wall_share = 0.01; call.set.has_solids = 1;
         for (int i = 0; i < 1000; ++i) call.set.solid[i] = i % 2 == 0;
         call.input = core_input(&call.set));
  WARNED(MCOR_WARN_TRIMMED, NODES_DISCARD_ALL, "0.1|0.00",
    call.input.volume = (mcor_array){ .constant = 0.001 });
}

/* There is no text for a number that is no warning, and none for a warning on the input if the input is NULL. */
static void test_without_input(void** state)
{
  warning_call call;
  begin_call(&call);
  CORE_SURFACE surface = core_extract(*state, &call.input, &call.options);
  assert_null(mcor_describe_warning(MCOR_WARNING_COUNT, &call.input, &call.options, &surface).text);
  assert_null(mcor_describe_warning(MCOR_WARN_PLANE, NULL, &call.options, &surface).text);
  particle_set_free(&call.set);
}

static void test_single_points(void** state)
{
  assert_null(mcor_describe_single_points(0, 0.5).text);
  assert_null(mcor_describe_single_points(INFINITY, 0.5).text);
  assert_null(mcor_describe_single_points(1e6, 6.25).text);
  CORE_MESSAGE message = mcor_describe_single_points(1e6, 6.24);
  assert_int_equal(message.code, MCOR_SAYS_POINTS_SINGLE);
  assert_non_null(strstr(message.text, "1e+06 to steps of 0.062, and cubes are 6.2:"));
}

CORE_MAIN(core_set_up, core_tear_down, test_slots, test_neighbours, test_plane, test_tilted_plane,
  test_iso_value, test_trimmed, test_tolerance, test_precision, test_told_residual,
  test_without_input, test_single_points)
