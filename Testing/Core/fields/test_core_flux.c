/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests fluxes. The flux of uniform flow is worked out by hand; the flux of other flow is compared with integrals over
 * values of mcor_probe and mcor_gauge. */

#include "core_fixture.h"

#define PI 3.14159265358979323846

/* Makes a pool of particles at spacing 1: 24 long along x and 16 along y. Its top slopes from z = 10 to z = 13.6. */
static particle_set make_pool(double jitter)
{
  particle_set set = particle_set_make(24 * 16 * 14);
  uint64_t seed = 5;
  int64_t n = 0;
  for (int i = 0; i < 24 * 16 * 14; ++i)
  {
    const double x[3] = { i % 24 + 0.5, i / 24 % 16 + 0.5, i / (24 * 16) + 0.5 };
    if (x[2] < 10 + 0.15 * x[0])
    {
      for (int a = 0; a < 3; ++a)
      {
        set.position[3 * n + a] = x[a] + jitter * (random_unit(&seed) - 0.5);
      }
      set.smoothing_length[n] = 1.3;
      set.volume[n++] = 1;
    }
  }
  set.count = n;
  return set;
}

/* Returns one slice of the pool as particles in the plane where coordinate `axis` is 8. The other two coordinates are x
 * and z of the pool, in this order. */
static particle_set make_slice(int axis)
{
  particle_set set = make_pool(0);
  int64_t n = 0;
  for (int64_t i = 0; i < set.count; ++i)
  {
    const double u = set.position[3 * i], v = set.position[3 * i + 2];
    if (set.position[3 * i + 1] < 1)
    {
      set.position[3 * n + axis] = 8;
      set.position[3 * n + (axis == 0 ? 1 : 0)] = u;
      set.position[3 * n++ + (axis == 2 ? 1 : 2)] = v;
    }
  }
  set.count = n;
  return set;
}

/* Particles with velocities and densities. */
typedef struct fluid
{
  particle_set set;
  double *velocity, *density;
  mcor_array attributes[2];
} fluid;

typedef void motion(const double x[3], double velocity[3], double* density);

static void move_uniform(const double x[3], double velocity[3], double* density)
{
  (void)x;
  memcpy(velocity, (double[3]){ 1, -2, 3 }, 3 * sizeof *velocity);
  *density = 1000;
}

static void move_anyhow(const double x[3], double velocity[3], double* density)
{
  velocity[0] = sin(0.7 * x[1]) + 0.2 * x[0];
  velocity[1] = cos(0.9 * x[2]) * x[0] / 10;
  velocity[2] = sin(0.5 * x[0] + 0.3 * x[1]) - 0.1 * x[2];
  *density = 1000 + 50 * sin(0.4 * x[2] + x[0]);
}

static fluid make_fluid(particle_set set, motion* move)
{
  fluid made = { .set = set,
    .velocity = malloc(3 * (size_t)set.count * sizeof(double)),
    .density = malloc((size_t)set.count * sizeof(double)) };
  for (int64_t i = 0; i < set.count; ++i)
  {
    move(set.position + 3 * i, made.velocity + 3 * i, made.density + i);
  }
  made.attributes[0] = core_array(made.velocity, 3);
  made.attributes[1] = core_array(made.density, 1);
  return made;
}

static void free_fluid(fluid* made)
{
  particle_set_free(&made->set);
  free(made->velocity);
  free(made->density);
}

static mcor_input fluid_input(const fluid* made)
{
  return core_input_with(&made->set, made->attributes, 2);
}

typedef struct shape
{
  mcor_section_shape kind;
  int count;
  double points[27], radius;
} shape;

static mcor_section section_of(const shape* of)
{
  return (mcor_section){
    .shape = of->kind, .points = of->points, .point_count = of->count, .radius = of->radius
  };
}

static mcor_flux_reading flux_of(
  mcor_context* context, const mcor_input* input, const mcor_options* options, const shape* of)
{
  const mcor_section section = section_of(of);
  CORE_FLUXES found;
  CORE_OK(context, mcor_flux(context, input, options, &section, 1, &found));
  assert_int_equal(found.count, 1);
  return found.readings[0];
}

/* Checks the area, the volume flux `flux`, and the mass flux for density 1000, each to within 1e-6. */
static void check_reading(
  const mcor_flux_reading* r, double area, double flux, const char* what, size_t number)
{
  const double scale = area * sqrt(14);
  CORE_CHECK(!r->outside && fabs(r->area - area) <= 1e-6 * area, what, number, r->area, area);
  CORE_CHECK(
    fabs(r->volume_flux - flux) <= 1e-6 * scale && fabs(r->mass_flux - 1000 * flux) <= 1e-3 * scale,
    what, number, r->volume_flux, r->mass_flux, flux);
  assert_true(fabs(r->velocity - r->volume_flux / r->area) < 1e-12);
}

/* Checks the flux of a uniform flow v = (1, -2, 3) of density 1000 through sections within the
 * fluid. */
static void test_uniform(void** state)
{
  const struct
  {
    shape section;
    double area, flux;
  } cases[] = {
    { { MCOR_SECTION_RECTANGLE, 3, { 5, 3, 3, 5, 9, 3, 5, 3, 8 }, 0 }, 30, 30 },
    { { MCOR_SECTION_RECTANGLE, 3, { 5, 3, 3, 5, 3, 8, 5, 9, 3 }, 0 }, 30, -30 },
    { { MCOR_SECTION_RECTANGLE, 3, { 4, 4, 4, 5.5, 4, 4, 4, 7, 6 }, 0 }, sqrt(29.25), 19.5 },
    { { MCOR_SECTION_DISC, 2, { 10, 8, 5, 0, 0, -7 }, 2.5 }, PI * 6.25, -3 * PI * 6.25 },
    { { MCOR_SECTION_DISC, 2, { 10, 8, 5, 1, 1, 1 }, 0.2 }, PI * 0.04, 2 / sqrt(3) * PI * 0.04 },
    { { MCOR_SECTION_BOX, 2, { 3, 3, 3, 9.3, 5, 7.1 }, 0 }, 2 * (12.6 + 8.2 + 25.83), 0 },
    { { MCOR_SECTION_TRIANGLES, 9,
        { 6, 6, 3, 11, 6, 3, 6, 10.2, 3, 6, 6, 3, 6, 6, 3, 7, 7, 7, 11, 6, 3, 11, 10.2, 3, 6, 10.2,
          3 },
        0 },
      21, 63 },
  };
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0.2), move_uniform);
  mcor_input input = fluid_input(&made);
  const mcor_options options = core_options(NULL);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    const mcor_flux_reading r = flux_of(*state, &input, &options, &cases[i].section);
    check_reading(&r, cases[i].area, cases[i].flux, "case", i);
  }
  input.attribute_count = 1;
  const mcor_flux_reading r = flux_of(*state, &input, &options, &cases[0].section);
  assert_true(isnan(r.mass_flux) && fabs(r.volume_flux - 30) < 1e-4);
}

/* If particles lie in a plane, a section is a line. Checks uniform flow in planes of constant x, y and z. Along the two
 * axes of the plane, the velocity is u = 1 and v = -2. */
static void test_uniform_in_a_plane(void** state)
{
  const struct
  {
    shape section; /* the section in the plane of constant z */
    double area, flux;
  } cases[] = {
    { { MCOR_SECTION_LINES, 2, { 5, 3, 8, 5, 7, 8 }, 0 }, 4,
      4 }, /* the normal points to the right of upwards */
    { { MCOR_SECTION_LINES, 4, { 5, 3, 8, 9, 3, 8, 9, 3, 8, 9, 7, 8 }, 0 }, 8,
      8 + 4 }, /* -v is 2 */
    { { MCOR_SECTION_RECTANGLE, 3, { 5, 3, 7, 5, 7, 7, 5, 3, 9 }, 0 }, 4, 4 },
    { { MCOR_SECTION_DISC, 2, { 7, 6, 8, 1, 0, 0 }, 2 }, 4, 4 },
    { { MCOR_SECTION_DISC, 2, { 7, 6, 9.2, 0, -3, 0 }, 2 }, 3.2, 6.4 },
    { { MCOR_SECTION_BOX, 2, { 5, 3, 8, 9, 6, 8 }, 0 }, 14, 0 },
  };
  for (int axis = 0; axis < 3; ++axis)
  {
    const int to[3] = { axis == 0 ? 1 : 0, axis == 2 ? 1 : 2, axis };
    CORE_OWNED(free_fluid) fluid made = make_fluid(make_slice(axis), move_uniform);
    for (int64_t i = 0; i < made.set.count; ++i)
    {
      made.velocity[3 * i + to[0]] = 1;
      made.velocity[3 * i + to[1]] = -2;
      made.velocity[3 * i + to[2]] = 99;
    }
    mcor_input input = fluid_input(&made);
    const mcor_options options = core_options(NULL);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
    {
      shape turned = cases[i].section;
      for (int p = 0; p < 3 * turned.count; ++p)
      {
        turned.points[p / 3 * 3 + to[p % 3]] = cases[i].section.points[p];
      }
      /* For axis 1, `to` is an odd permutation, so a rectangle's normal (a cross product of edges) changes sign. */
      const double sign = turned.kind == MCOR_SECTION_RECTANGLE && axis == 1 ? -1 : 1;
      mcor_flux_reading r = flux_of(*state, &input, &options, &turned);
      check_reading(
        &r, cases[i].area, sign * cases[i].flux, "1 of 3 axes, case", 10 * (size_t)axis + i);
    }
    /* In a plane, velocities may have only two components. */
    for (int64_t i = 0; i < made.set.count; ++i)
    {
      memcpy(made.velocity + 2 * i, (double[2]){ 1, -2 }, 2 * sizeof(double));
    }
    made.attributes[0].components = 2;
    shape line = { MCOR_SECTION_LINES, 2, { 0 }, 0 };
    for (int p = 0; p < 6; ++p)
    {
      line.points[p / 3 * 3 + to[p % 3]] = cases[0].section.points[p];
    }
    mcor_flux_reading r = flux_of(*state, &input, &options, &line);
    check_reading(&r, 4, 4, "two components, axis", (size_t)axis);
  }
}

/* ---- integrals of samples ---- */

/* Gauss's three points on [-1, 1], and the share that each point has in the integral. */
static const double gauss_at[3] = { -0.7745966692414834, 0, 0.7745966692414834 };
static const double gauss_share[3] = { 5 / 18.0, 8 / 18.0, 5 / 18.0 };

/* Returns point i of n Gauss points: [low, high] has n / 3 parts of three points each. *share: the point's weight. */
static double gauss_point(double low, double high, int i, int n, double* share)
{
  const double part = (high - low) / (n / 3);
  *share = part * gauss_share[i % 3];
  return low + part * (i / 3 + 0.5 + 0.5 * gauss_at[i % 3]);
}

#define COLUMNS 360
#define ROWS 120

/* A section stands across the pool, from below the top to above it. The flux is compared with integrals over columns of
 * samples, up to the top that gauges find. */
static void test_half_out_of_the_water(void** state)
{
  const double x = 8.2, low = 5, y0 = 2, y1 = 14;
  const shape wall = { MCOR_SECTION_RECTANGLE, 3, { x, y0, low, x, y1, low, x, y0, 14 }, 0 };
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0.4), move_anyhow);
  const mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  options.precision = MCOR_FLOAT64;
  CORE_FREED mcor_gauge_line* lines = calloc(COLUMNS, sizeof *lines);
  CORE_FREED double* points = malloc(3 * COLUMNS * ROWS * sizeof(double));
  CORE_FREED double* share = malloc(COLUMNS * ROWS * sizeof(double));
  double width[COLUMNS], area = 0, flux = 0;
  for (int i = 0; i < COLUMNS; ++i)
  {
    const double y = gauss_point(y0, y1, i, COLUMNS, &width[i]);
    lines[i] = (mcor_gauge_line){ .from = { x, y, low }, .to = { x, y, 14 } };
  }
  CORE_GAUGES gauges;
  CORE_OK(*state, mcor_gauge(*state, &input, &options, lines, COLUMNS, &gauges));
  for (int i = 0; i < COLUMNS; ++i)
  {
    assert_int_equal(gauges.readings[i].crossing_count, 1);
    area += width[i] * gauges.readings[i].depth;
    for (int j = 0; j < ROWS; ++j)
    {
      double part, *to = points + 3 * (i * ROWS + j);
      memcpy(to, lines[i].from, 3 * sizeof(double));
      to[2] = gauss_point(low, low + gauges.readings[i].depth, j, ROWS, &part);
      share[i * ROWS + j] = width[i] * part;
    }
  }
  CORE_SAMPLES samples;
  const mcor_array where = core_array(points, 3);
  CORE_OK(*state, mcor_probe(*state, &input, &options, &where, COLUMNS * ROWS, &samples));
  for (int i = 0; i < COLUMNS * ROWS; ++i)
  {
    flux += share[i] * samples.values[0][3 * i] * samples.values[1][i];
  }
  const mcor_flux_reading r = flux_of(*state, &input, &options, &wall);
  CORE_CHECK(area > 60 && area < 84 && fabs(r.area - area) < 1e-6 * area, r.area, area);
  CORE_CHECK(fabs(r.mass_flux - flux) < 1e-6 * fabs(flux), r.mass_flux, flux);
}

/* A section through the whole pool must have the same flux if it extends far beyond the pool: its dry parts do not
 * change how exact the flux is. */
static void test_far_beyond_the_water(void** state)
{
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0.4), move_anyhow);
  const mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  options.precision = MCOR_FLOAT64;
  mcor_flux_reading r[2];
  for (int far = 0; far < 2; ++far)
  {
    const double low = far ? -5e4 : -3, y = far ? 5e4 : 19, z = far ? 5e4 : 16;
    const shape wall = { MCOR_SECTION_RECTANGLE, 3, { 8.2, low, low, 8.2, y, low, 8.2, low, z }, 0 };
    r[far] = flux_of(*state, &input, &options, &wall);
  }
  CORE_CHECK(fabs(r[1].area - r[0].area) < 1e-6 * r[0].area, r[0].area, r[1].area);
  CORE_CHECK(
    fabs(r[1].mass_flux - r[0].mass_flux) < 1e-2 * r[0].area, r[0].mass_flux, r[1].mass_flux);
}

/* A disc that dips a little into the water must have the same flux as many triangles from its centre to its rim. */
static void test_disc_at_the_surface(void** state)
{
  enum
  {
    CORNERS = 2048
  };
  const shape disc = { MCOR_SECTION_DISC, 2, { 8.2, 8, 11.5, 1, 0, 0 }, 0.8 };
  CORE_FREED double* points = malloc(9 * CORNERS * sizeof(double));
  const mcor_section fan = {
    .shape = MCOR_SECTION_TRIANGLES, .points = points, .point_count = 3 * CORNERS
  };
  for (int i = 0; i < 3 * CORNERS; ++i)
  {
    const double angle = 2 * PI * (i / 3 + i % 3 - 1) / CORNERS, radius = i % 3 ? disc.radius : 0;
    points[3 * i] = disc.points[0];
    points[3 * i + 1] = disc.points[1] + radius * cos(angle);
    points[3 * i + 2] = disc.points[2] + radius * sin(angle);
  }
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0.4), move_anyhow);
  const mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  options.precision = MCOR_FLOAT64;
  const mcor_flux_reading r = flux_of(*state, &input, &options, &disc);
  CORE_FLUXES found;
  CORE_OK(*state, mcor_flux(*state, &input, &options, &fan, 1, &found));
  const mcor_flux_reading* expected = found.readings;
  CORE_CHECK(
    r.area > 0.1 && r.area < 0.4 && fabs(r.area - expected->area) < 1e-5, r.area, expected->area);
  CORE_CHECK(
    fabs(r.volume_flux - expected->volume_flux) < 1e-5, r.volume_flux, expected->volume_flux);
}

/* The section touches the fluid with one corner only, exactly at the level. The wet area is 0 or small, not NaN. */
static void test_corner_on_the_level(void** state)
{
  const shape wall = { MCOR_SECTION_RECTANGLE, 3, { 8.2, 6, 11.5, 8.2, 7, 13.5, 8.2, 6, 13.5 }, 0 };
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0), move_anyhow);
  const mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  CORE_SAMPLES samples;
  const mcor_array corner = core_array(wall.points, 3);
  CORE_OK(*state, mcor_probe(*state, &input, &options, &corner, 1, &samples));
  const double level = samples.weight_sum[0];
  options.iso_values = &level;
  options.iso_count = 1;
  const mcor_flux_reading r = flux_of(*state, &input, &options, &wall);
  CORE_CHECK(level > 0.05 && level < 0.9 && r.area >= 0 && r.area < 1e-3, level, r.area);
}

/* A section's flux has the same bits if it is measured alone or among others, and if particles stay on the device. */
static void test_same_bits(void** state)
{
  static const shape shapes[] = { { MCOR_SECTION_RECTANGLE, 3,
                                    { 8.2, 2, 5, 8.2, 19, 5, 8.2, 2, 14 }, 0 },
    { MCOR_SECTION_DISC, 2, { 10, 8, 10, 1, 2, -1 }, 5 },
    { MCOR_SECTION_BOX, 2, { -3, 3, 3, 9.3, 5, 17.1 }, 0 } };
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0.4), move_anyhow);
  mcor_input input = fluid_input(&made);
  const mcor_options options = core_options(NULL);
  const mcor_section sections[3] = { section_of(&shapes[0]), section_of(&shapes[1]),
    section_of(&shapes[2]) };
  CORE_FLUXES all;
  CORE_OK(*state, mcor_flux(*state, &input, &options, sections, 3, &all));
  for (int i = 0; i < 3; ++i)
  {
    input.particles_version = input.attributes_version = (uint64_t)i % 2;
    const mcor_flux_reading one = flux_of(*state, &input, &options, &shapes[i]);
    assert_true(one.area == all.readings[i].area && one.mass_flux == all.readings[i].mass_flux &&
      one.volume_flux == all.readings[i].volume_flux && one.area > 1);
  }
}

/* A section beyond a side of the period must measure the fluid's image there. */
static void test_period(void** state)
{
  shape wall = { MCOR_SECTION_RECTANGLE, 3, { 22.25, 2, 5, 22.25, 9, 5, 26.25, 2, 9 }, 0 };
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0.4), move_anyhow);
  const mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  options.periodic[1] = 24;
  const mcor_flux_reading here = flux_of(*state, &input, &options, &wall);
  for (int p = 0; p < 9; p += 3)
  {
    wall.points[p] -= 48;
  }
  const mcor_flux_reading there = flux_of(*state, &input, &options, &wall);
  CORE_CHECK(fabs(here.area - 7 * sqrt(32)) < 1e-4 && here.mass_flux == there.mass_flux, here.area,
    here.mass_flux, there.mass_flux);
  /* At 1e18, the corners of a cell are the same number in double precision. The call must still
   * succeed. */
  for (int p = 0; p < 9; p += 3)
  {
    wall.points[p] = p == 3 ? 1e18 : 1e18 + 256;
  }
  flux_of(*state, &input, &options, &wall);
}

/* A channel has walls of solids beyond y = 0 and y = 12, and the fluid begins one spacing away from the walls. With
 * solids the fluid ends where fluid and solids weigh the same, a quarter of a spacing inside the channel's sides;
 * without solids it ends half a spacing beyond its last particles. The solids have no velocities. */
static void test_walls(void** state)
{
  const shape across = { MCOR_SECTION_RECTANGLE, 3, { 8.2, 0, 5, 8.2, 12, 5, 8.2, 0, 9 }, 0 };
  const mcor_gauge_line line = { .from = { 8.2, -2, 7.1 }, .to = { 8.2, 14, 7.1 } };
  particle_set set = particle_set_make(16 * 17 * 14);
  for (int64_t n = 0; n < set.count; ++n)
  {
    const int row = (int)(n / 16 % 17);
    set.solid[n] = row < 3 || row >= 14;
    set.position[3 * n] = (double)(n % 16) + 0.5;
    set.position[3 * n + 1] = row < 3 ? row - 2.5 : row < 14 ? row - 2 : row - 1.5;
    set.position[3 * n + 2] = (double)(n / (16 * 17)) + 0.5;
    set.smoothing_length[n] = 1.3;
    set.volume[n] = 1;
  }
  set.has_solids = 1;
  CORE_OWNED(free_fluid) fluid made = make_fluid(set, move_uniform);
  for (int64_t n = 0; n < set.count; ++n)
  {
    made.velocity[3 * n] = set.solid[n] ? NAN : 1;
  }
  mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  options.wall_share = MCOR_WALL_SHARE_AUTO;
  for (int alone = 0; alone < 2; ++alone)
  {
    const double begin = alone ? 0.5 : 0.25, width = 12 - 2 * begin, error = alone ? 5e-3 : 1e-4;
    input.ignore_solids = alone;
    const mcor_flux_reading r = flux_of(*state, &input, &options, &across);
    CORE_CHECK(fabs(r.area - 4 * width) < 4 * error && fabs(r.volume_flux - r.area) < 1e-5, r.area,
      4 * width, r.volume_flux);
    CORE_GAUGES gauges;
    CORE_OK(*state, mcor_gauge(*state, &input, &options, &line, 1, &gauges));
    const double* at = gauges.crossings;
    CORE_CHECK(gauges.crossing_count == 2 && fabs(at[0] - 2 - begin) < error &&
        fabs(at[1] - 14 + begin) < error,
      gauges.crossing_count, at[0], at[1]);
  }
}

/* Checks that the call fails with a message in which core_told finds the words. */
static void refuse(mcor_context* context, const mcor_input* input, const mcor_options* options,
  const shape* of, const char* words)
{
  mcor_fluxes fluxes;
  const mcor_section section = section_of(of);
  CORE_CHECK(mcor_flux(context, input, options, &section, 1, &fluxes) != MCOR_OK, words);
  CORE_CHECK(core_told(context, words), mcor_last_error(context));
  assert_true(fluxes.count == 0 && !fluxes.readings);
}

static void test_weird(void** state)
{
  static const struct
  {
    shape section;
    const char* words;
  } cases[] = {
    { { MCOR_SECTION_RECTANGLE, 3, { 1, 2, 3, 1, 2, 5, 1, 2, 9 }, 0 },
      "SECTION_WITHOUT_AREA|number 0" },
    { { MCOR_SECTION_RECTANGLE, 2, { 1, 2, 3, 1, 2, 5 }, 0 }, "SECTION_POINTS|has 2 " },
    { { MCOR_SECTION_RECTANGLE, 3, { 1, NAN, 3, 1, 2, 5, 4, 4, 4 }, 0 }, "SECTION_NOT_FINITE" },
    { { MCOR_SECTION_RECTANGLE, 3, { 1, 2, 3, 1e200, 2, 5, 4, 1e200, 4 }, 0 },
      "SECTION_TOO_LARGE" },
    { { MCOR_SECTION_RECTANGLE, 3, { 1, 2, 3, 1e30, 2, 5, 4, 1e30, 4 }, 0 },
      "SECTION_CELLS_ALONG" },
    { { MCOR_SECTION_DISC, 2, { 1, 2, 3, 0, 0, 0 }, 1 }, "SECTION_WITHOUT_AREA" },
    { { MCOR_SECTION_DISC, 2, { 1, 2, 3, 0, 0, 1 }, 0 }, "SECTION_WITHOUT_AREA" },
    { { MCOR_SECTION_BOX, 2, { 1, 2, 3, 1, 5, 5 }, 0 }, "SECTION_WITHOUT_AREA" },
    { { MCOR_SECTION_TRIANGLES, 3, { 1, 2, 3, 1, 2, 3, 5, 6, 7 }, 0 }, "SECTION_WITHOUT_AREA" },
    { { MCOR_SECTION_TRIANGLES, 4, { 0 }, 0 }, "SECTION_POINTS|has 4 " },
    { { MCOR_SECTION_LINES, 2, { 1, 2, 3, 4, 5, 6 }, 0 }, "SECTION_IS_LINE" },
    { { (mcor_section_shape)9, 2, { 0 }, 0 }, "SECTION_POINTS" },
  };
  CORE_OWNED(free_fluid) fluid made = make_fluid(make_pool(0), move_uniform);
  mcor_input input = fluid_input(&made);
  mcor_options options = core_options(NULL);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    refuse(*state, &input, &options, &cases[i].section, cases[i].words);
  }
  const shape good = { MCOR_SECTION_RECTANGLE, 3, { 5, 3, 3, 5, 9, 3, 5, 3, 8 }, 0 };
  const shape far = { MCOR_SECTION_RECTANGLE, 3, { 105, 3, 3, 105, 9, 3, 105, 3, 8 }, 0 };
  const double zero = 0;
  options.iso_values = &zero;
  options.iso_count = 1;
  refuse(*state, &input, &options, &good, "FLUID_LEVEL|Fluxes");
  options.iso_count = 0;
  made.density[7] = NAN;
  refuse(*state, &input, &options, &good, "FLUX_NOT_FINITE|density|particle 7.");
  made.density[7] = 1000;
  /* The error comes before any cell is measured, because measuring would take minutes. */
  made.set.smoothing_length[7] = 1e-3;
  refuse(*state, &input, &options, &good, "SECTION_CELLS|number 0");
  made.set.smoothing_length[7] = 1.3;
  made.attributes[0].components = 1;
  refuse(*state, &input, &options, &good, "VELOCITY_COMPONENTS|1 ");
  made.attributes[0].components = 3;
  input.attribute_count = 0;
  refuse(*state, &input, &options, &good, "FLUX_ATTRIBUTES");
  input.attribute_count = 2;
  mcor_flux_reading r = flux_of(*state, &input, &options, &far);
  assert_true(
    r.outside && r.area == 0 && r.volume_flux == 0 && r.mass_flux == 0 && isnan(r.velocity));
  input.count = 0;
  r = flux_of(*state, &input, &options, &good);
  assert_true(r.outside && r.area == 0);
  CORE_FLUXES fluxes;
  CORE_OK(*state, mcor_flux(*state, &input, &options, NULL, 0, &fluxes));
  assert_int_equal(fluxes.count, 0);
  CORE_OWNED(free_fluid) fluid slice = make_fluid(make_slice(1), move_uniform);
  input = fluid_input(&slice);
  const shape off[3] = { { MCOR_SECTION_LINES, 2, { 5, 3, 3, 5, 3, 8 }, 0 },
    { MCOR_SECTION_RECTANGLE, 3, { 5, 3, 3, 5, 9, 4, 5, 3, 8 }, 0 },
    { MCOR_SECTION_DISC, 2, { 5, 3, 3, 0, 1, 1 }, 2 } };
  for (int i = 0; i < 3; ++i)
  {
    refuse(*state, &input, &options, &off[i], "is not a line in the plane y = 8 of the particles");
  }
  const shape point = { MCOR_SECTION_LINES, 4, { 5, 8, 3, 5, 8, 3, 6, 8, 3, 6, 8, 3 }, 0 };
  refuse(*state, &input, &options, &point, "SECTION_WITHOUT_AREA");
}

CORE_MAIN(core_set_up, core_tear_down, test_uniform, test_uniform_in_a_plane,
  test_half_out_of_the_water, test_far_beyond_the_water, test_disc_at_the_surface,
  test_corner_on_the_level, test_same_bits, test_period, test_walls, test_weird)
