/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests gauges and fluxes on several ranks, which are threads. All values must equal the values of one process to the
 * last bit, whichever rank owns which part of a line or section. */

#include "core_ranks.h"

#define LINES 90
#define SECTIONS 4

/* Makes particles at random places, so sparse that there are holes. If has_solids is set later, every seventh particle
 * is a solid. */
static particle_set make_sparse(void)
{
  particle_set set = core_make_random(2500, 12, 0.6, 1.0, 5);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.volume[i] = 0.4;
    set.solid[i] = i % 7 == 0;
  }
  return set;
}

typedef struct gauge_job
{
  const particle_set* set;
  const mcor_gauge_line* lines;
  const mcor_section* sections; /* NULL: gauges are measured */
  int axis, periodic, volumes;  /* volumes: computed */
  mcor_globals globals;
  mcor_gauges gauges[CORE_MOST_RANKS + 1]; /* the last entry is one process alone */
  mcor_fluxes fluxes[CORE_MOST_RANKS + 1];
} gauge_job;

static mcor_options gauge_options(const gauge_job* job)
{
  mcor_options options = core_options(NULL);
  options.field = MCOR_WEIGHT_SUM;
  options.wall_share = MCOR_WALL_SHARE_MEASURED;
  if (job->periodic)
  {
    options.periodic[2 * job->axis] = -6;
    options.periodic[2 * job->axis + 1] = 6;
  }
  return options;
}

static mcor_input gauge_input(
  const gauge_job* job, const particle_set* set, mcor_array velocity_and_density[2])
{
  mcor_input input = core_input(set);
  if (job->volumes)
  {
    input.volume = (mcor_array){ 0 };
  }
  if (job->sections)
  {
    velocity_and_density[0] = core_array(set->position, 3);
    velocity_and_density[1] = core_array(set->smoothing_length, 1);
    input.attributes = velocity_and_density;
    input.attribute_count = 2;
  }
  return input;
}

static mcor_status read_all(mcor_context* context, gauge_job* job, const mcor_input* input,
  const mcor_options* options, int rank)
{
  return job->sections
    ? mcor_flux(context, input, options, job->sections, SECTIONS, &job->fluxes[rank])
    : mcor_gauge(context, input, options, job->lines, LINES, &job->gauges[rank]);
}

/* Returns the particles that the box between two sides needs: particles nearer than `reach` to the box or to its image
 * one period away. */
static particle_set take_near(const gauge_job* job, double low, double high, double reach)
{
  particle_set part = particle_set_make(job->set->count);
  part.count = 0;
  part.has_solids = job->set->has_solids;
  for (int64_t i = 0; i < job->set->count; ++i)
  {
    int is_near = 0;
    for (int image = -1; image <= 1; ++image)
    {
      const double at = job->set->position[3 * i + job->axis] + (job->periodic ? 12 * image : 0);
      is_near = is_near || (at > low - reach && at < high + reach);
    }
    if (is_near)
    {
      particle_set_append(&part, job->set, i);
    }
  }
  return part;
}

/* Measures gauges and fluxes in one rank's slab. Slabs differ in width, their sides lie between nodes of the lattice,
 * and the two outer slabs are infinite. */
static mcor_status gauge_part(core_rank* rank, void* data)
{
  gauge_job* job = data;
  const int r = rank->number, count = rank->world->count;
  mcor_options options = gauge_options(job);
  double sides[2];
  for (int s = 0; s < 2; ++s)
  {
    const int cut = r + s;
    sides[s] = cut == 0 ? -INFINITY
      : cut == count    ? INFINITY
                        : -6.1 + 12.2 * pow((double)cut / count, 1.5);
  }
  for (int side = 0; side < 6; ++side)
  {
    options.box[side] = side % 2 ? INFINITY : -INFINITY;
    options.box[side] = side / 2 == job->axis ? sides[side % 2] : options.box[side];
  }
  options.globals = &job->globals;
  options.ranks = &rank->ranks;
  const double reach = job->globals.measured.support_max * (job->volumes ? 3 : 1) +
    mcor_reach_margin(&options, &job->globals, 0);
  CORE_SET part = take_near(job, sides[0], sides[1], reach);
  mcor_array arrays[2];
  const mcor_input input = gauge_input(job, &part, arrays);
  return read_all(rank->context, job, &input, &options, r);
}

static int same_gauges(const mcor_gauges* a, const mcor_gauges* b)
{
  int same = a->count == b->count && a->crossing_count == b->crossing_count &&
    memcmp(a->crossings, b->crossings, (size_t)a->crossing_count * sizeof(double)) == 0;
  for (int64_t i = 0; i < a->count && same; ++i)
  {
    const mcor_gauge_reading *x = &a->readings[i], *y = &b->readings[i];
    same = x->state == y->state && !x->outside == !y->outside &&
      memcmp(&x->first, &y->first, 6 * sizeof(double)) == 0 &&
      x->first_crossing == y->first_crossing && x->crossing_count == y->crossing_count;
  }
  return same;
}

/* Makes random lines. Every third one is along `axis` through all boxes; line 1 crosses periods; line 2 is outside. */
static void make_lines(mcor_gauge_line* lines, int axis)
{
  uint64_t seed = 11;
  for (int i = 0; i < LINES; ++i)
  {
    lines[i] = (mcor_gauge_line){ .name = NULL };
    for (int a = 0; a < 3; ++a)
    {
      lines[i].from[a] = 16 * random_unit(&seed) - 8;
      lines[i].to[a] = i % 3 ? 16 * random_unit(&seed) - 8 : lines[i].from[a];
    }
    if (i % 3 == 0)
    {
      lines[i].from[axis] = -7;
      lines[i].to[axis] = 7.5;
    }
  }
  lines[1].to[axis] = 43;
  lines[2] = (mcor_gauge_line){ .from = { 100, 100, 100 }, .to = { 101, 102, 103 } };
}

static int same_fluxes(const mcor_fluxes* a, const mcor_fluxes* b)
{
  int same = a->count == b->count;
  for (int64_t i = 0; i < a->count && same; ++i)
  {
    same = !a->readings[i].outside == !b->readings[i].outside &&
      memcmp(&a->readings[i].area, &b->readings[i].area, 4 * sizeof(double)) == 0;
  }
  return same;
}

/* Checks that any number of ranks gets the same gauges and fluxes as one process. */
static void check_ranks(mcor_context* context, gauge_job* job, int kind)
{
  const mcor_gauges* gauges = &job->gauges[CORE_MOST_RANKS];
  const mcor_fluxes* fluxes = &job->fluxes[CORE_MOST_RANKS];
  mcor_array arrays[2];
  const mcor_input input = gauge_input(job, job->set, arrays);
  mcor_options options = gauge_options(job);
  CORE_OK(context, read_all(context, job, &input, &options, CORE_MOST_RANKS));
  CORE_OK(context, mcor_measure_globals(context, &input, &options, &job->globals));
  CORE_CHECK(job->sections
      ? fluxes->readings[0].area > 20 && fluxes->readings[3].outside
      : gauges->crossing_count > 80 && gauges->readings[2].outside && !gauges->readings[0].outside,
    gauges->crossing_count);
  for (int count = 1; count <= CORE_MOST_RANKS; count += job->sections ? 1 + count / 3 : 1)
  {
    core_world world;
    core_run_ranks(count, gauge_part, job, &world);
    core_expect_ranks(&world, job->sections ? "fluxes" : "gauges");
    for (int r = 0; r < count; ++r)
    {
      const int same =
        job->sections ? same_fluxes(&job->fluxes[r], fluxes) : same_gauges(&job->gauges[r], gauges);
      CORE_CHECK(same, kind, r, count);
      mcor_free_fluxes(&job->fluxes[r]);
      mcor_free_gauges(&job->gauges[r]);
    }
  }
  mcor_free_fluxes(&job->fluxes[CORE_MOST_RANKS]);
  mcor_free_gauges(&job->gauges[CORE_MOST_RANKS]);
  mcor_free_globals(&job->globals);
}

static void test_same_bits(void** state)
{
  CORE_SET set = make_sparse();
  for (int kind = 0; kind < 6; ++kind)
  {
    mcor_gauge_line lines[LINES];
    gauge_job job = { .set = &set,
      .lines = lines,
      .axis = kind % 3,
      .periodic = kind >= 3,
      .volumes = kind == 1 || kind == 5 };
    set.has_solids = kind % 2;
    make_lines(lines, job.axis);
    check_ranks(*state, &job, kind);
  }
}

/* Any number of ranks gives the same fluxes as one process. Sections cross all ranks' boxes, reach beyond the period,
 * lie in few boxes, or lie outside the fluid. */
static void test_same_fluxes(void** state)
{
  static const double points[SECTIONS][9] = { { -7, -6.5, 1, 7, -6, 2, -7, 7, -1 },
    { 0.3, 1, 0.2, 1, 3, -2 }, { -1, -2, -0.5, 9, 5, 1.5 },
    { 99, 99, 99, 99, 98, 99, 99, 99, 98 } };
  const mcor_section sections[SECTIONS] = {
    { .shape = MCOR_SECTION_RECTANGLE, .points = points[0], .point_count = 3 },
    { .shape = MCOR_SECTION_DISC, .points = points[1], .point_count = 2, .radius = 4.4 },
    { .shape = MCOR_SECTION_BOX, .points = points[2], .point_count = 2 },
    { .shape = MCOR_SECTION_TRIANGLES, .points = points[3], .point_count = 3 }
  };
  CORE_SET set = make_sparse();
  for (int kind = 0; kind < 4; ++kind)
  {
    set.has_solids = kind % 2;
    gauge_job job = { .set = &set,
      .sections = sections,
      .axis = kind % 3,
      .periodic = kind >= 2,
      .volumes = kind == 1 };
    check_ranks(*state, &job, kind);
  }
}

/* Checks the error if cubes are so small that the particles around a box are missing. */
static void test_small_cubes(void** state)
{
  CORE_SET set = make_sparse();
  mcor_gauge_line line = { .from = { 0, 0, -7 }, .to = { 0, 0, 7 } };
  gauge_job job = { .set = &set, .lines = &line };
  mcor_array arrays[2];
  const mcor_input input = gauge_input(&job, &set, arrays);
  mcor_options options = gauge_options(&job);
  options.cube_size = 0.05;
  CORE_OK(*state, mcor_measure_globals(*state, &input, &options, &job.globals));
  options.globals = &job.globals;
  options.box[1] = options.box[3] = options.box[5] = 3;
  mcor_gauges gauges;
  assert_int_equal(mcor_gauge(*state, &input, &options, &line, 1, &gauges), MCOR_INVALID_ARGUMENT);
  assert_true(core_told(*state, "CUBE_TOO_SMALL_FOR_GAUGES"));
  mcor_free_globals(&job.globals);
}

CORE_MAIN(core_set_up, core_tear_down, test_same_bits, test_same_fluxes, test_small_cubes)
