/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compares the library with the oracle on random particles and options.
 *
 *   test_oracle_random FIRST_SEED COUNT [--adaptive]
 */

#include "oracle_case.h"
#include "particle_sets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double pick(uint64_t* state, const double* values, int count)
{
  return values[random_bits(state) % (uint64_t)count];
}

/* Seeds below this number use only the first five kernels: such seeds found faults when there were no other kernels. */
#define SEEDS_OF_FIVE_KERNELS 1000

static void fill_options(oracle_case* at, uint64_t* state, uint64_t kernels, double* iso)
{
  static const double scales[] = { 1.0, 1.0, 0.75, 0.5 };
  static const double factors[] = { 0.5, 0.5, 0.7, 1.0, 1.3 };
  static const double node_thresholds[] = { 0.1, 0.1, 0.0, 0.3 };
  static const double isos[] = { 0.0, 1.0, 0.3, -0.4, 0.05 };
  at->options = oracle_case_options(iso);
  at->options.sph_kernel = (mcor_sph_kernel)(random_bits(state) % kernels);
  at->options.field = (mcor_field)(random_bits(state) % 3);
  at->options.h_scale = pick(state, scales, 4);
  at->options.cube_size_factor = pick(state, factors, 5);
  at->options.node_threshold = pick(state, node_thresholds, 4);
  at->options.precision = random_bits(state) % 4 == 0 ? MCOR_FLOAT64 : MCOR_FLOAT32;
  *iso = at->options.field == MCOR_WEIGHT_SUM ? 0.2 + random_unit(state) : pick(state, isos, 5);
  if (at->options.field == MCOR_SUM && *iso == 0.0)
  {
    *iso = 0.02; /* at 0, all empty space would equal the iso value */
  }
  at->input.ignore_solids = random_bits(state) % 2 == 0;
  if (random_bits(state) % 4 == 0)
  {
    at->input.volume = (mcor_array){ 0 };
  }
  at->options.topology = random_bits(state) % 2 == 0 ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
  at->skip_pairs = at->options.field == MCOR_WEIGHT_SUM;
  at->rough = at->random = 1;
  if (random_bits(state) % 3 == 0)
  {
    static const double thresholds[] = { 0.2, 0.3, 0.5, 0.75 };
    at->options.boundary_detection = MCOR_BOUNDARY_EIGENVALUE;
    at->options.outputs |= MCOR_OUT_BOUNDARY_EIGENVALUE;
    at->options.vertex_threshold = pick(state, thresholds, 4);
  }
  /* A free surface with computed volumes gets no wall_share, with which these volumes would depend on the solids. */
  if (!at->input.ignore_solids && (at->options.field != MCOR_WEIGHT_SUM || at->input.volume.data))
  {
    static const double shares[] = { 0.0, 0.5, 0.8 };
    at->options.wall_share = pick(state, shares, 3);
  }
}

/* Returns whether there is any fluid. Without fluid the library gives an error instead of a
 * surface. */
static int has_fluid(const mcor_input* input)
{
  int64_t solids = 0;
  for (int64_t j = 0; input->solid && j < input->count; ++j)
  {
    solids += input->solid[j] != 0;
  }
  return input->count > solids;
}

static void run_seed(oracle_suite* suite, uint64_t seed, int adaptive)
{
  particle_set set = particle_set_random(seed);
  oracle_case at;
  double iso;
  uint64_t state = seed ^ 0x5DEECE66Du;
  memset(&at, 0, sizeof(at));
  at.input = core_input(&set);
  fill_options(&at, &state, seed < SEEDS_OF_FIVE_KERNELS ? 5 : MCOR_SPH_KERNEL_COUNT, &iso);
  if (adaptive)
  {
    at.options.level_limit = MCOR_CUBE_LEVELS - 1;
  }
  snprintf(at.name, sizeof(at.name), "random/%llu/%s/f%d%s", (unsigned long long)seed,
    mcor_sph_kernel_name(at.options.sph_kernel), (int)at.options.field,
    adaptive ? "/adaptive" : "");
  if (has_fluid(&at.input))
  {
    oracle_run_case(suite, &at);
  }
  particle_set_free(&set);
}

int main(int argc, char** argv)
{
  oracle_suite suite;
  if (argc < 3 || !oracle_begin_suite(&suite, 1, argv))
  {
    return 1;
  }
  const uint64_t first = strtoull(argv[1], NULL, 10), count = strtoull(argv[2], NULL, 10);
  for (uint64_t seed = first; seed < first + count; ++seed)
  {
    run_seed(&suite, seed, argc > 3);
  }
  return oracle_end_suite(&suite);
}
