/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Tests MCOR_PAIRS: the line between two particles on different sides of iso marks every cell that it crosses, and
 * rounding loses no cell. The oracle checks that MCOR_COMPLETE misses no crossed edge. */

#include "core_fixture.h"
#include "mcor_vector.h"

#define NO_BRICK 4

/* The cells that the last extraction by pairs of particles (MCOR_PAIRS) marked. cell: for each cell of the lattice, 1
 * (marked), 0 (not marked) or NO_BRICK (the cell's brick was not evaluated). */
typedef struct marked_cells
{
  int low[3], size[3];
  uint8_t* cell;
  int count, hits; /* hits: marked cells that the surface uses */
} marked_cells;

static uint8_t* find_cell(const marked_cells* m, const int at[3])
{
  int64_t index = 0;
  for (int a = 2; a >= 0; --a)
  {
    CORE_CHECK(at[a] >= m->low[a] && at[a] < m->low[a] + m->size[a], at[a], a);
    index = index * m->size[a] + at[a] - m->low[a];
  }
  return m->cell + index;
}

static marked_cells read_cells(mcor_context* context)
{
  marked_cells m = { .count = 0 };
  const int bricks = context->bricks.now.count;
  CORE_FREED cl_int* brick = oracle_allocate(bricks + 1, 4 * sizeof *brick);
  CORE_FREED uint64_t* cells = oracle_allocate(bricks + 1, 2 * sizeof *cells);
  const uint64_t* used = cells + bricks;
  CORE_OK(context,
    mcor_read(context, &context->bricks.now.bricks, 0, brick, (size_t)bricks * 4 * sizeof *brick));
  CORE_OK(
    context, mcor_read(context, &context->bricks.seeds, 0, cells, (size_t)bricks * sizeof *cells));
  CORE_OK(context,
    mcor_read(context, &context->mesh.used, 0, cells + bricks, (size_t)bricks * sizeof *cells));
  size_t total = 1;
  for (int a = 0; a < 3; ++a)
  {
    m.low[a] = (int)context->lattice.origin[a];
    m.size[a] = 32 * context->lattice.blocks[a];
    total *= (size_t)m.size[a];
  }
  m.cell = malloc(total);
  assert_non_null(m.cell);
  memset(m.cell, NO_BRICK, total);
  for (int b = 0; b < bricks; ++b)
  {
    for (int c = 0; c < 64; ++c)
    {
      const int marked = cells[b] >> c & 1;
      const int at[3] = { m.low[0] + 4 * brick[4 * b] + c % 4,
        m.low[1] + 4 * brick[4 * b + 1] + c / 4 % 4, m.low[2] + 4 * brick[4 * b + 2] + c / 16 };
      *find_cell(&m, at) = (uint8_t)marked;
      m.count += marked;
      m.hits += marked && used[b] >> c & 1;
    }
  }
  return m;
}

/* Walks along a segment in small steps. Every cell that the segment crosses by more than rounding must be marked or
 * have NO_BRICK. Marked cells on the segment, or within rounding of it, get the value 2. */
static void check_line(marked_cells* m, const double p[3], const double q[3], double cube)
{
  enum
  {
    STEPS = 40000
  };
  for (int i = 0; i <= STEPS; ++i)
  {
    int at[3], others[3];
    int inside = 1;
    for (int a = 0; a < 3; ++a)
    {
      const double x = (p[a] + (q[a] - p[a]) * i / STEPS) / cube;
      at[a] = (int)floor(x);
      const double f = x - at[a];
      others[a] = f < 1e-3 ? at[a] - 1 : f > 1 - 1e-3 ? at[a] + 1 : at[a];
      inside = inside && f > 2e-5 && f < 1 - 2e-5;
    }
    CORE_CHECK(!inside || *find_cell(m, at), at[0], at[1], at[2], i, STEPS);
    for (int c = 0; c < 8; ++c)
    {
      const int near[3] = { c & 1 ? others[0] : at[0], c & 2 ? others[1] : at[1],
        c & 4 ? others[2] : at[2] };
      uint8_t* cell = find_cell(m, near);
      *cell = *cell == 1 ? 2 : *cell;
    }
  }
}

/* Extracts with MCOR_PAIRS. Two particles are a pair if only one scalar is below 0, and their distance is below the
 * larger of their smoothing lengths. Exactly the cells on the lines of all pairs must be marked, to within rounding. */
static void check_pairs(mcor_context* context, const particle_set* set, double cube)
{
  const double iso = 0;
  const mcor_input input = core_input(set);
  mcor_options options = core_options(&iso);
  options.seeds = MCOR_PAIRS;
  options.node_threshold = 0;
  options.cube_size = cube;
  CORE_SURFACE surface = core_extract(context, &input, &options);
  marked_cells m = read_cells(context);
  assert_int_equal(surface.statistics.seed_cells, m.count);
  assert_int_equal(surface.statistics.seed_cells_not_intersected, m.count - m.hits);
  assert_true(m.count > 0);
  int pairs = 0;
  for (int64_t j = 0; j < set->count; ++j)
  {
    for (int64_t k = 0; k < j; ++k)
    {
      const double *p = set->position + 3 * j, *q = set->position + 3 * k;
      const double h = fmax(set->smoothing_length[j], set->smoothing_length[k]);
      double d[3];
      mcor_subtract(p, q, d);
      if ((set->scalar[j] >= 0) != (set->scalar[k] >= 0) && mcor_dot(d, d) < h * h)
      {
        check_line(&m, p, q, cube);
        ++pairs;
      }
    }
  }
  assert_true(pairs > 0);
  const int64_t total = (int64_t)m.size[0] * m.size[1] * m.size[2];
  for (int64_t i = 0; i < total; ++i)
  {
    CORE_CHECK(m.cell[i] != 1, i);
  }
  free(m.cell);
}

/* Checks single pairs whose line is along an axis, through edges or corners of cells, within one cell, or random. */
static void test_line(void** state)
{
  static const double ends[][6] = { { 0.5, 0.5, 0.5, 17.5, 0.5, 0.5 },
    { 0.25, 7.5, 0.5, 0.25, -9.75, 0.5 }, { 3, 3, 3, 3, 3, 14 }, { 0, 0, 0, 12, 12, 12 },
    { 11.5, 11.5, 11.5, -3.5, -3.5, -3.5 }, { 0.5, 0.5, 0.25, 9.5, 9.5, 0.25 },
    { 0.1, 0.2, 0.3, 0.8, 0.7, 0.6 }, { -5, 2, 8, 7, -4, 2 }, { 1, 1, 1, 13, 5, 3 },
    { -0.001, 4, 4, 0.001, 4, 4 } };
  uint64_t seed = 6;
  for (int i = 0; i < 40; ++i)
  {
    CORE_SET set = particle_set_make(2);
    double d[3];
    for (int c = 0; c < 6; ++c)
    {
      set.position[c] = 0.125 * (i < 10 ? ends[i][c] : 15 * random_unit(&seed));
    }
    mcor_subtract(set.position, set.position + 3, d);
    for (int j = 0; j < 2; ++j)
    {
      set.smoothing_length[j] = 1.01 * sqrt(mcor_dot(d, d));
      set.volume[j] = 1;
      set.scalar[j] = j ? 1 : -1;
    }
    check_pairs(*state, &set, 0.125);
  }
}

/* Checks random sets: the larger smoothing length of two particles decides whether they are a pair. */
static void test_pairs(void** state)
{
  for (uint64_t seed = 1; seed <= 4; ++seed)
  {
    CORE_SET set = core_make_random(25, 2, 0.4, seed % 2 ? 0.4 : 1.2, seed + 20);
    set.smoothing_length[7] = 0.8;
    check_pairs(*state, &set, 0.07);
  }
}

/* The particles of a pair are the greatest allowed distance of 1.0001 h apart, to within rounding. The OpenCL code for
 * CPUs and the code for GPUs group particles differently, and must find the same number of cells. */
static void test_pairs_in_each_form(void** state)
{
  const double iso = 0;
  CORE_SET set = particle_set_make(2 * 20 * 20 * 10);
  uint64_t seed = 8;
  for (int64_t i = 0; i < set.count; ++i)
  {
    const int64_t pair = i / 2;
    const double apart = i % 2 ? 1.0001 + 4e-5 * (random_unit(&seed) - 0.5) : 0;
    set.position[3 * i] = 15 * (double)(pair % 20) + apart;
    set.position[3 * i + 1] = 15 * (double)(pair / 20 % 20);
    set.position[3 * i + 2] = 15 * (double)(pair / 400);
    set.smoothing_length[i] = set.volume[i] = 1;
    set.scalar[i] = i % 2 ? 1 : -1;
  }
  const mcor_input input = core_input(&set);
  mcor_options options = core_options(&iso);
  options.seeds = MCOR_PAIRS;
  options.node_threshold = 0;
  int64_t cells[2];
  for (int form = 0; form < 2; ++form)
  {
    CORE_CONTEXT context = NULL;
    core_create_with(&context, "MCOR_DEVICE_FORM", form ? "gpu" : "cpu");
    CORE_SURFACE surface = core_extract(context, &input, &options);
    cells[form] = surface.statistics.seed_cells;
  }
  assert_true(cells[0] > 1000 && cells[0] < 11000);
  assert_int_equal(cells[0], cells[1]);
}

/* Where all particles have the iso value, rounding may put the mean on either side. The surface must be the same
 * whether or not an extraction with another iso value evaluated the nodes before. */
static void test_rounding(void** state)
{
  const double iso[2] = { 0.4, 0.3 };
  CORE_SET set = core_make_block(16, 0.2, 3, core_slope);
  for (int64_t i = 0; i < set.count; ++i)
  {
    set.scalar[i] = set.position[3 * i] < -2 ? iso[1] : 50 + set.scalar[i];
  }
  const mcor_input input = core_input_to_keep(&set);
  uint64_t hash[2];
  for (int fresh = 0; fresh < 2; ++fresh)
  {
    CORE_CONTEXT context = NULL;
    assert_int_equal(mcor_create_context(NULL, &context), MCOR_OK);
    for (int i = fresh; i < 2; ++i)
    {
      const mcor_options options = core_options(&iso[i]);
      CORE_SURFACE surface = core_extract(context, &input, &options);
      assert_true(surface.triangle_count > 0);
      hash[fresh] = core_hash(&surface);
    }
  }
  assert_true(hash[0] == hash[1]);
}

CORE_MAIN(
  core_set_up, core_tear_down, test_line, test_pairs, test_pairs_in_each_form, test_rounding)
