/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares surfaces with the oracle's, on cubes that are as fine as the particles. core_tree checks the levels of cubes
 * by their definition. */

#include "oracle_case.h"
#include "particle_sets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What solids do, as in the program's --solids. */
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
  particle_set (*make)(double ratio);
  double ratio, iso;
  mcor_field field;
  mcor_type precision;
  adaptive_solids solids;
} adaptive_entry;

static const char* const solids_names[] = { "", "/weight", "/ignore", "/wall" };

static void run_entry(oracle_suite* suite, const adaptive_entry* entry)
{
  particle_set set = entry->make(entry->ratio);
  oracle_case at;
  memset(&at, 0, sizeof(at));
  at.input = core_input(&set);
  at.options = oracle_case_options(&entry->iso);
  at.options.field = entry->field;
  at.options.precision = entry->precision;
  at.options.level_limit = MCOR_CUBE_LEVELS - 1;
  at.input.ignore_solids = entry->solids == SOLIDS_IGNORE;
  at.options.wall_share = entry->solids == SOLIDS_WALL ? 0.5 : 0.0;
  snprintf(at.name, sizeof(at.name), "adaptive/%s/%g/%s/%s%s%s", entry->name, entry->ratio,
    entry->field == MCOR_WEIGHT_SUM ? "weight"
      : entry->field == MCOR_SUM    ? "sum"
                                    : "shepard",
    mcor_sph_kernel_name(at.options.sph_kernel), entry->precision == MCOR_FLOAT64 ? "/double" : "",
    solids_names[entry->solids]);
  oracle_run_case(suite, &at);
  particle_set_free(&set);
}

int main(int argc, char** argv)
{
  static const adaptive_entry entries[] = {
    { "drops", particle_set_drops, 10, 0.5, .field = MCOR_WEIGHT_SUM },
    { "drops", particle_set_drops, 100, 0.5, .field = MCOR_WEIGHT_SUM },
    { "drops", particle_set_drops, 1000, 0.5, .field = MCOR_WEIGHT_SUM },
    { "drops", particle_set_drops, 1000, 0.5, .field = MCOR_WEIGHT_SUM, .precision = MCOR_FLOAT64 },
    { "drops", particle_set_drops, 10, 0.1, .field = MCOR_SHEPARD },
    { "drops", particle_set_drops, 100, 0.1, .field = MCOR_SUM },
    { "medium", particle_set_medium, 10, 0.0, .field = MCOR_SHEPARD },
    { "medium", particle_set_medium, 100, 0.0, .field = MCOR_SHEPARD },
    { "medium", particle_set_medium, 1000, 0.0, .field = MCOR_SHEPARD },
    { "medium", particle_set_medium, 1000, 0.1, .field = MCOR_SUM },
    { "basin", particle_set_basin, 4, 0, .field = MCOR_SHEPARD, .solids = SOLIDS_WEIGHT },
    { "basin", particle_set_basin, 4, 0, .field = MCOR_SHEPARD, .solids = SOLIDS_IGNORE },
    { "basin", particle_set_basin, 4, 0, .field = MCOR_SHEPARD, .solids = SOLIDS_WALL },
    { "basin", particle_set_basin, 4, 0, .field = MCOR_SHEPARD, .precision = MCOR_FLOAT64,
      .solids = SOLIDS_WALL },
    { "basin", particle_set_basin, 4, 0.5, .field = MCOR_WEIGHT_SUM, .solids = SOLIDS_WEIGHT },
    { "basin", particle_set_basin, 4, 0.5, .field = MCOR_WEIGHT_SUM, .solids = SOLIDS_WALL },
    { "basin", particle_set_basin, 2.2, 0, .field = MCOR_SHEPARD, .solids = SOLIDS_WALL },
    { "basin", particle_set_basin, 4, 0.1, .field = MCOR_SUM, .solids = SOLIDS_WALL },
  };
  oracle_suite suite;
  if (!oracle_begin_suite(&suite, argc, argv))
  {
    return 1;
  }
  for (size_t n = 0; n < sizeof(entries) / sizeof(*entries); ++n)
  {
    run_entry(&suite, &entries[n]);
  }
  return oracle_end_suite(&suite);
}
