/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests the option `compact`, which merges vertices near one lattice node. The mesh is as sound as
 * without `compact`, with fewer and better triangles, and residuals are at most 1.5 times as large.
 * The surfaces of boxes together make the whole surface. */

#include "core_parts.h"
#include "core_period.h"

static particle_set make_splash(double jitter, uint64_t seed)
{
  particle_set set = core_make_splash(10, jitter, seed);
  for (int64_t i = 0; i < 3 * set.count; ++i)
  {
    set.position[i] -= 5;
    set.smoothing_length[i / 3] = 1.2;
  }
  return set;
}

static particle_set make_smooth(void)
{
  return make_splash(0.3, 1);
}

static particle_set make_rough(void)
{
  return make_splash(0.9, 2);
}

static particle_set make_noise(void)
{
  particle_set set = core_make_random(3000, 14, 0.5, 1.1, 7);
  uint64_t seed = 12;
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = 2 * random_unit(&seed) - 1;
    set.volume[i] = 0.5;
  }
  return set;
}

static particle_set make_graded(void)
{
  return core_make_graded(8, 0.4);
}

static particle_set make_wall(void)
{
  particle_set set = core_make_block(10, 0.4, 3, core_slope);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.solid[i] = set.position[3 * i] < -2;
  }
  set.has_solids = 1;
  return set;
}

static particle_set make_period(void)
{
  const int length[3] = { 12, 10, 11 };
  return core_make_period(length, 4);
}

/* Makes random particles, all in one plane. */
static particle_set make_plane(void)
{
  particle_set set = core_make_random(900, 14, 0.5, 0.8, 9);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.position[3 * i + 1] = 2;
    set.volume[i] = 0.25;
  }
  return set;
}

typedef struct compact_case
{
  const char* name;
  particle_set (*make)(void);
  mcor_field field;
  double iso[2]; /* the second differs only in cases with two iso values */
  double cube;
  int levels, capping;
  mcor_topology topology;
  mcor_type precision;
  double period[6];
  double share, sharp; /* upper limits: triangles / triangles without `compact`; the
                          share of triangles with an angle below 20 degrees */
} compact_case;

static const compact_case cases[] = {
  { "splash", make_smooth, MCOR_WEIGHT_SUM, { 0.5, 0.5 }, 0.5, 0, 0, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0 }, 0.8, 0.001 },
  { "rough splash", make_rough, MCOR_WEIGHT_SUM, { 0.5, 0.4 }, 0.4, 0, 0, MCOR_TOPOLOGY_FIELD,
    MCOR_FLOAT32, { 0 }, 0.8, 0.0002 },
  { "in double precision", make_rough, MCOR_WEIGHT_SUM, { 0.5, 0.5 }, 0.6, 0, 0,
    MCOR_TOPOLOGY_TABLE, MCOR_FLOAT64, { 0 }, 0.8, 0.002 },
  { "scalar", make_smooth, MCOR_SHEPARD, { 8, 4 }, 0.4, 0, 0, MCOR_TOPOLOGY_TABLE, MCOR_FLOAT32,
    { 0 }, 0.65, 0.2 },
  { "noise", make_noise, MCOR_SHEPARD, { 0.1, 0.1 }, 0.9, 0, 0, MCOR_TOPOLOGY_FIELD, MCOR_FLOAT32,
    { 0 }, 0.85, 0.4 },
  { "sum of noise", make_noise, MCOR_SUM, { 0.3, 0.3 }, 0.7, 0, 0, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0 }, 0.7, 0.168 },
  { "levels", make_graded, MCOR_WEIGHT_SUM, { 0.5, 0.5 }, 0.5, 4, 0, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0 }, 0.7, 0.002 },
  { "walls", make_wall, MCOR_WEIGHT_SUM, { 0.5, 0.5 }, 0.5, 0, MCOR_CAP_NONE, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0 }, 0.9, 0.1 },
  { "period", make_period, MCOR_SHEPARD, { 0.1, 0.1 }, 0.5, 0, MCOR_CAP_PERIOD, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0, 12, 0, 10, 0, 11 }, 0.85, 0.06 },
  { "lines", make_plane, MCOR_WEIGHT_SUM, { 0.5, 0.5 }, 0.5, 0, 0, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0 }, 0.85, 0 },
  { "lines of levels", make_plane, MCOR_WEIGHT_SUM, { 0.5, 0.3 }, 0.5, 3, 0, MCOR_TOPOLOGY_TABLE,
    MCOR_FLOAT32, { 0 }, 0.85, 0 },
};

static mcor_options options_of(const compact_case* at)
{
  mcor_options options = core_options(at->iso);
  options.iso_count = at->iso[0] != at->iso[1] ? 2 : 1;
  options.field = at->field;
  options.cube_size_factor = at->cube;
  options.level_limit = at->levels;
  options.capping = at->capping;
  options.topology = at->topology;
  options.precision = at->precision;
  options.wall_share = at->make == make_wall ? 0.3 : 0;
  memcpy(options.periodic, at->period, sizeof options.periodic);
  core_ask_for_all(&options);
  return options;
}

/* Counts the triangles with an angle below 20 degrees, and the triangles whose normal points away
 * from the mean normal of their points. */
static void measure(const mcor_surface* s, int64_t* sharp, int64_t* turned)
{
  *sharp = *turned = 0;
  for (int64_t t = 0; t < s->triangle_count; ++t)
  {
    const int32_t* corner = s->triangles + 3 * t;
    double side[3][3], cosine = -1, n[3], along = 0;
    for (int c = 0; c < 3; ++c)
    {
      for (int a = 0; a < 3; ++a)
      {
        side[c][a] =
          s->points[3 * (int64_t)corner[(c + 1) % 3] + a] - s->points[3 * (int64_t)corner[c] + a];
      }
    }
    for (int c = 0; c < 3; ++c)
    {
      const double *u = side[c], *v = side[(c + 2) % 3];
      const double dot = -(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]);
      cosine = fmax(cosine,
        dot /
          sqrt(
            (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])));
    }
    for (int a = 0; a < 3; ++a)
    {
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      n[a] = side[0][b] * side[1][c] - side[0][c] * side[1][b];
      for (int k = 0; k < 3; ++k)
      {
        along += n[a] * s->normals[3 * (int64_t)corner[k] + a];
      }
    }
    *sharp += cosine > cos(20 * M_PI / 180);
    *turned += !(along > 0);
  }
}

static int64_t count_drops(const mcor_surface* s)
{
  int64_t closed = 0;
  for (int64_t l = 0; l < s->line_count; ++l)
  {
    closed += s->line_points[s->line_offsets[l]] == s->line_points[s->line_offsets[l + 1] - 1];
  }
  return closed;
}

/* Hashes the coordinates of all flagged points. Their order does not change the hash. */
static uint64_t hash_border(const mcor_surface* s)
{
  uint64_t sum = 0;
  for (int64_t i = 0; i < s->point_count; ++i)
  {
    sum += s->boundary_flag[i]
      ? core_hash_bytes(CORE_HASH_OF_NOTHING, s->points + 3 * i, 3 * sizeof(double))
      : 0;
  }
  return sum;
}

static void check_triangles(
  const compact_case* at, const mcor_surface* without, const mcor_surface* with)
{
  CORE_REPORT before = core_check_pinched_mesh(without), after = core_check_pinched_mesh(with);
  int64_t sharp, turned, sharp_before, turned_before;
  measure(without, &sharp_before, &turned_before);
  measure(with, &sharp, &turned);
  CORE_CHECK(after.boundary_edges == before.boundary_edges &&
      after.components == before.components && after.euler == before.euler,
    at->name, after.boundary_edges, after.components, after.euler);
  CORE_CHECK(hash_border(with) == hash_border(without), at->name);
  CORE_CHECK((double)after.triangles < at->share * (double)before.triangles, at->name,
    after.triangles, before.triangles);
  CORE_CHECK(turned <= turned_before, at->name, turned);
  CORE_CHECK(
    (double)sharp <= at->sharp * (double)after.triangles, at->name, sharp, after.triangles);
}

static mcor_input input_of(
  const compact_case* at, const particle_set* set, const mcor_array* attribute)
{
  mcor_input input = core_input_with(set, attribute, 1);
  input.volume =
    at->make == make_smooth || at->make == make_rough ? (mcor_array){ 0 } : input.volume;
  return input;
}

/* Compares each case with the contour without `compact`. If the case is in space and has no period,
 * also compares its surface with the joined surfaces of boxes. */
static void surfaces(void** state)
{
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i)
  {
    const compact_case* at = cases + i;
    CORE_SET set = at->make();
    const mcor_array attribute = core_array(set.position, 3);
    const mcor_input input = input_of(at, &set, &attribute);
    mcor_options options = options_of(at);
    CORE_SURFACE without = core_extract(*state, &input, &options);
    options.compact = 1;
    CORE_SURFACE with = core_extract(*state, &input, &options);
    const mcor_statistics *s = &with.statistics, *old = &without.statistics;
    if (with.line_offsets)
    {
      CORE_CHECK((double)with.point_count < at->share * (double)without.point_count, at->name,
        with.point_count, without.point_count);
      CORE_CHECK(
        with.line_count == without.line_count && count_drops(&with) == count_drops(&without),
        at->name);
    }
    else
    {
      check_triangles(at, &without, &with);
    }
    CORE_CHECK(s->residual_max <= 1.5 * old->residual_max &&
        s->vertices_above_tolerance <= old->vertices_above_tolerance,
      at->name, s->residual_max, old->residual_max, s->vertices_above_tolerance);
    if (at->period[1] == 0 && at->make != make_plane)
    {
      core_check_cuts(*state, at->name, &input, &options);
      options.triangle_normals = 1;
      core_check_these_cuts(*state, at->name, &input, &options, core_cuts + 3, 1);
    }
  }
}

/* Returns whether the surface has a point with exactly these coordinates. */
static int has_point(const mcor_surface* s, const double* point)
{
  int has = 0;
  for (int64_t i = 0; i < s->point_count && !has; ++i)
  {
    has = memcmp(s->points + 3 * i, point, 3 * sizeof *point) == 0;
  }
  return has;
}

/* Checks points at least four cubes inside the period: caps leave nearly all of them unchanged. */
static void away_from_caps(void** state)
{
  const compact_case* at = cases;
  while (at->make != make_period)
  {
    ++at;
  }
  CORE_SET set = at->make();
  const mcor_input input = core_input(&set);
  mcor_options options = options_of(at);
  options.compact = 1;
  CORE_SURFACE capped = core_extract(*state, &input, &options);
  options.capping = MCOR_CAP_NONE;
  options.level_limit = 0; /* A run with caps has one level, too. */
  CORE_SURFACE open = core_extract(*state, &input, &options);
  int far = 0, same = 0;
  for (int64_t i = 0; i < open.point_count; ++i)
  {
    bool is_far = true;
    for (int a = 0; a < 3; ++a)
    {
      const double x = open.points[3 * i + a], away = 4 * open.statistics.cube_size;
      is_far = is_far && x > at->period[2 * a] + away && x < at->period[2 * a + 1] - away;
    }
    far += is_far;
    same += is_far && has_point(&capped, open.points + 3 * i);
  }
  CORE_CHECK(far > 100 && same > 0.95 * far, same, far);
}

/* Checks boxes in a period whose particles have smoothing lengths from 0.5 to 2.4. */
static void boxes_in_period(void** state)
{
  const double iso = 0.5, period[6] = { 0, 14, 0, 14, 0, 14 };
  CORE_SET set = core_make_random(1500, 14, 0.5, 2.4, 9);
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.field = MCOR_WEIGHT_SUM;
  options.compact = 1;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  memcpy(options.periodic, period, sizeof period);
  core_check_these_cuts(*state, "levels, period", &input, &options, core_cuts, 2);
}

/* Checks a surface whose loops over triangles are divided among threads. One thread must make the same bits. */
static void many_slices(void** state)
{
  compact_case large = cases[0];
  large.cube = 0.08;
  large.share = 0.85;
  CORE_SET set = large.make();
  const mcor_array attribute = core_array(set.position, 3);
  const mcor_input input = input_of(&large, &set, &attribute);
  mcor_options options = options_of(&large);
  CORE_SURFACE without = core_extract(*state, &input, &options);
  options.compact = 1;
  CORE_SURFACE with = core_extract(*state, &input, &options);
  CORE_CHECK(without.triangle_count > 2 * MCOR_LIGHT_GRAIN, without.triangle_count);
  check_triangles(&large, &without, &with);
  CORE_CONTEXT context = NULL;
  core_create_with(&context, "MCOR_THREADS", "1");
  CORE_SURFACE one = core_extract(context, &input, &options);
  assert_true(core_hash(&one) == core_hash(&with));
}

/* With unequal periods, the edges of cubes differ a little, and are shorter than the device's unit of length. With
 * equal periods, the edges are as long as this unit. The mean move of vertices must be nearly equal in both cases. */
static void unequal_edges(void** state)
{
  const double iso = 0.1, period[6] = { 0, 12, 0, 12, 0, 12 };
  const int length[3] = { 12, 12, 12 };
  CORE_SET set = core_make_period(length, 4);
  const mcor_input input = core_input(&set);
  mcor_options options = core_period_options(&iso, period);
  options.compact = 1;
  options.cube_size = 0.76;
  options.periodic[1] += 1.2e-5;
  options.periodic[3] += 3.6e-5;
  CORE_SURFACE unequal = core_extract(*state, &input, &options);
  options.periodic[1] = options.periodic[3] = 12;
  CORE_SURFACE equal = core_extract(*state, &input, &options);
  const double mean = unequal.statistics.correction_mean, usual = equal.statistics.correction_mean;
  CORE_CHECK(unequal.triangle_count == equal.triangle_count && fabs(mean - usual) < 1e-3 * usual,
    unequal.triangle_count, equal.triangle_count, mean, usual);
}

CORE_MAIN(core_set_up, core_tear_down, surfaces, boxes_in_period, away_from_caps, many_slices,
  unequal_edges)
