/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The smoothing length of particles that have none. */

#include "mcor_input.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The order of samples by a hash of their position, so that input order does not matter. */
typedef struct mcor_sample
{
  uint64_t hash;
  double x[3];
} mcor_sample;

static uint64_t mcor_hash_position(const double x[3])
{
  uint64_t hash = 0x9E3779B97F4A7C15u;
  for (int a = 0; a < 3; ++a)
  {
    uint64_t bits;
    memcpy(&bits, x + a, sizeof bits);
    hash = (hash ^ bits) * 0xBF58476D1CE4E5B9u;
    hash ^= hash >> 31;
  }
  return hash;
}

static int mcor_compare_double(const void* a, const void* b)
{
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}

#define MCOR_SAMPLES 256
#define MCOR_SAMPLE_NEIGHBOURS 32

/* Distance from x to its 32nd nearest other particle, or the farthest if there are fewer. */
static double mcor_neighbour_distance(const mcor_input* input, const double x[3], double* nearest)
{
  int found = 0;
  for (int64_t i = 0; i < input->count; ++i)
  {
    double d2 = 0;
    for (int a = 0; a < 3; ++a)
    {
      const double d = mcor_array_at(&input->positions, i, a) - x[a];
      d2 += d * d;
    }
    if (found < MCOR_SAMPLE_NEIGHBOURS + 1 || d2 < nearest[found - 1])
    {
      int to = found < MCOR_SAMPLE_NEIGHBOURS + 1 ? found++ : found - 1;
      for (; to > 0 && nearest[to - 1] > d2; --to)
      {
        nearest[to] = nearest[to - 1];
      }
      nearest[to] = d2;
    }
  }
  return sqrt(nearest[found - 1]) * cbrt(4.0 / 3.0 * 3.14159265358979323846 / found);
}

/* 1.3 times the median, over a sample of particles, of the spacing of a lattice that has as many
 * particles within the distance of the 32nd neighbour. */
double mcor_estimate_smoothing_length(const mcor_input* input)
{
  mcor_sample samples[MCOR_SAMPLES];
  int count = 0;
  const int64_t affordable = 1 + 300000000 / (input->count + 1);
  const int most = (int)(affordable < 16 ? 16
      : affordable > MCOR_SAMPLES        ? MCOR_SAMPLES
                                         : affordable);
  mcor_array positions = input->positions;
  positions.components = 3;
  mcor_input view = *input;
  view.positions = positions;
  for (int64_t i = 0; i < input->count; ++i)
  {
    mcor_sample sample;
    for (int a = 0; a < 3; ++a)
    {
      sample.x[a] = mcor_array_at(&positions, i, a);
    }
    sample.hash = mcor_hash_position(sample.x);
    if (count == most && sample.hash >= samples[count - 1].hash)
    {
      continue;
    }
    int to = count < most ? count++ : count - 1;
    for (; to > 0 && samples[to - 1].hash > sample.hash; --to)
    {
      samples[to] = samples[to - 1];
    }
    samples[to] = sample;
  }
  double spacing[MCOR_SAMPLES], nearest[MCOR_SAMPLE_NEIGHBOURS + 2];
  for (int s = 0; s < count; ++s)
  {
    spacing[s] = mcor_neighbour_distance(&view, samples[s].x, nearest);
  }
  qsort(spacing, (size_t)count, sizeof spacing[0], mcor_compare_double);
  return 1.3 * spacing[count / 2];
}
