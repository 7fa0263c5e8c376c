/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cubes as fine as the particles are: the oracle's own levels against their definition, its adaptive
 * lattice against the uniform one where they must agree, then the library against it. */

#include "oracle_case.h"
#include "particle_sets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void expect(oracle_suite* suite, int condition, const char* name, const char* what)
{
  if (!condition)
  {
    printf("  FAILED: %s: %s\n", name, what);
    ++suite->failures;
  }
}

/* ---- the oracle itself ---- */

static int64_t size_of(const adaptive_brick* brick)
{
  return (int64_t)ADAPTIVE_BRICK << brick->level;
}

/* Bricks that touch differ by one level at most; one that no such brick and no particle keeps from
 * being larger is not there. */
static void check_levels(oracle_suite* suite, const char* name, const oracle_reference* reference)
{
  const oracle_adaptive* adaptive = &reference->adaptive;
  const oracle_particles* p = &reference->particles;
  const double least = oracle_smallest_h(p);
  int64_t uneven = 0, unfit = 0;
  for (int64_t a = 0; a < adaptive->brick_count; ++a)
  {
    const adaptive_brick* one = &adaptive->bricks[a];
    int fits = 1;
    for (int64_t b = 0; b < adaptive->brick_count; ++b)
    {
      const adaptive_brick* other = &adaptive->bricks[b];
      int touch = 1;
      for (int axis = 0; axis < 3; ++axis)
      {
        touch = touch && one->at[axis] <= other->at[axis] + size_of(other) &&
          other->at[axis] <= one->at[axis] + size_of(one);
      }
      uneven += touch && abs(one->level - other->level) > 1;
    }
    for (int64_t j = 0; fits && j < p->count; ++j)
    {
      double square = 0.0;
      for (int axis = 0; axis < 3; ++axis)
      {
        const double low = (double)one->at[axis] * adaptive->cube - p->position[3 * j + axis];
        const double d = fmax(0.0, fmax(low, -low - (double)size_of(one) * adaptive->cube));
        square += d * d;
      }
      const double support =
        oracle_support(reference->field.kernel) * reference->field.h_scale * p->smoothing_length[j];
      fits = one->level == 0 || sqrt(square) > support * (1.0 + 1e-12) ||
        p->smoothing_length[j] >= least * ldexp(1.0, one->level);
    }
    unfit += !fits;
  }
  expect(suite, uneven == 0, name, "bricks that touch differ by more than one level");
  expect(suite, unfit == 0, name, "a brick is too large for a particle");
  expect(suite, adaptive->top > 0 && adaptive->brick_count > 0, name, "it is not adaptive");
}

static int make_reference(oracle_suite* suite, const char* name, const particle_set* set,
  const mcor_options* options, oracle_reference* reference)
{
  char message[256];
  const mcor_input input = particle_set_input(set);
  const int made = oracle_create_reference(reference, &input, options, 60000000, message);
  expect(suite, made, name, message);
  return made;
}

/* Level 0 alone is the uniform lattice. */
static void check_uniform(
  oracle_suite* suite, const char* name, const particle_set* set, double iso)
{
  oracle_reference uniform;
  oracle_adaptive adaptive;
  mcor_options options = oracle_case_options(&iso);
  options.cube_size_factor = 1.0;
  if (!make_reference(suite, name, set, &options, &uniform))
  {
    return;
  }
  const int made =
    oracle_create_adaptive(&adaptive, &uniform.field, uniform.lattice.cube, 0, 60000000);
  expect(suite, made, name, "no memory");
  if (made)
  {
    int64_t used = 0, valid = 0;
    oracle_march_adaptive(&adaptive, &uniform.field, &uniform.limits, 0, uniform.unit);
    for (int64_t e = 0; e < adaptive.edge_count; ++e)
    {
      used += adaptive.edges[e].used;
    }
    for (int64_t c = 0; c < adaptive.cell_count; ++c)
    {
      valid += adaptive.cells[c].valid;
    }
    expect(suite, used == uniform.surface.edge_count, name, "not the uniform lattice's edges");
    expect(suite, valid == uniform.surface.cell_count, name, "not the uniform lattice's cells");
    expect(suite, used > 100, name, "too few edges for a test");
  }
  oracle_free_adaptive(&adaptive);
  oracle_free_reference(&uniform);
}

static void test_oracle(oracle_suite* suite)
{
  particle_set set;
  oracle_reference reference;
  double iso = 0.0;
  mcor_options options = oracle_case_options(&iso);
  options.cube_size_factor = 1.0;
  options.level_limit = MCOR_CUBE_LEVELS - 1;
  if (particle_set_medium(&set, 10.0))
  {
    if (make_reference(suite, "medium/10/levels", &set, &options, &reference))
    {
      check_levels(suite, "medium/10/levels", &reference);
      oracle_free_reference(&reference);
    }
  }
  particle_set_free(&set);
  if (particle_set_drops(&set, 2.0))
  {
    check_uniform(suite, "drops/2/uniform", &set, 0.1);
  }
  particle_set_free(&set);
  if (particle_set_drops(&set, 100.0))
  {
    if (make_reference(suite, "drops/100/levels", &set, &options, &reference))
    {
      check_levels(suite, "drops/100/levels", &reference);
      oracle_free_reference(&reference);
    }
  }
  particle_set_free(&set);
}

/* ---- the library ---- */

/* What solids do, as the program's --solids. */
typedef enum adaptive_solids
{
  SOLIDS_NONE,
  SOLIDS_WEIGHT,
  SOLIDS_IGNORE,
  SOLIDS_WALL
} adaptive_solids;

typedef struct adaptive_entry
{
  const char* name;
  int (*make)(particle_set* set, double ratio);
  double ratio, iso;
  mcor_field field;
  mcor_sph_kernel kernel;
  mcor_type precision;
  adaptive_solids solids;
} adaptive_entry;

static const char* const solids_names[] = { "", "/weight", "/ignore", "/wall" };

static void run_entry(oracle_suite* suite, const adaptive_entry* entry)
{
  particle_set set;
  oracle_case at;
  memset(&at, 0, sizeof(at));
  if (!entry->make(&set, entry->ratio))
  {
    expect(suite, 0, entry->name, "no memory");
    return;
  }
  at.input = particle_set_input(&set);
  at.options = oracle_case_options(&entry->iso);
  at.options.field = entry->field;
  at.options.sph_kernel = entry->kernel;
  at.options.precision = entry->precision;
  at.options.level_limit = MCOR_CUBE_LEVELS - 1;
  at.input.ignore_solids = entry->solids == SOLIDS_IGNORE;
  at.options.wall_share = entry->solids == SOLIDS_WALL ? 0.5 : 0.0;
  snprintf(at.name, sizeof(at.name), "adaptive/%s/%g/%s/%s%s%s", entry->name, entry->ratio,
    entry->field == MCOR_WEIGHT_SUM ? "weight"
      : entry->field == MCOR_SUM    ? "sum"
                                    : "shepard",
    mcor_sph_kernel_name(entry->kernel), entry->precision == MCOR_FLOAT64 ? "/double" : "",
    solids_names[entry->solids]);
  oracle_run_case(suite, &at);
  particle_set_free(&set);
}

int main(int argc, char** argv)
{
  static const adaptive_entry entries[] = {
    { "drops", particle_set_drops, 10, 0.5, MCOR_WEIGHT_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "drops", particle_set_drops, 100, 0.5, MCOR_WEIGHT_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "drops", particle_set_drops, 1000, 0.5, MCOR_WEIGHT_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "drops", particle_set_drops, 1000, 0.5, MCOR_WEIGHT_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT64,
      SOLIDS_NONE },
    { "drops", particle_set_drops, 10, 0.1, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "drops", particle_set_drops, 100, 0.1, MCOR_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "medium", particle_set_medium, 10, 0.0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "medium", particle_set_medium, 100, 0.0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "medium", particle_set_medium, 1000, 0.0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "medium", particle_set_medium, 1000, 0.1, MCOR_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_NONE },
    { "basin", particle_set_basin, 4, 0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_WEIGHT },
    { "basin", particle_set_basin, 4, 0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_IGNORE },
    { "basin", particle_set_basin, 4, 0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_WALL },
    { "basin", particle_set_basin, 4, 0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT64,
      SOLIDS_WALL },
    { "basin", particle_set_basin, 4, 0.5, MCOR_WEIGHT_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_WEIGHT },
    { "basin", particle_set_basin, 4, 0.5, MCOR_WEIGHT_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_WALL },
    { "basin", particle_set_basin, 2.2, 0, MCOR_SHEPARD, MCOR_CUBIC_SPLINE, MCOR_FLOAT32,
      SOLIDS_WALL },
    { "basin", particle_set_basin, 4, 0.1, MCOR_SUM, MCOR_CUBIC_SPLINE, MCOR_FLOAT32, SOLIDS_WALL },
  };
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, argc, argv))
  {
    return 1;
  }
  if (!suite.filter)
  {
    test_oracle(&suite);
  }
  for (size_t n = 0; n < sizeof(entries) / sizeof(*entries); ++n)
  {
    run_entry(&suite, &entries[n]);
  }
  return oracle_end_suite(&suite);
}
