/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void compare_note(compare_state* state, const char* format, ...)
{
  if (state->result->first[0] == '\0')
  {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(state->result->first, sizeof(state->result->first), format, arguments);
    va_end(arguments);
  }
}

double compare_wall_margin(const compare_state* state, const oracle_sample* sample)
{
  const double share = state->options->wall_share;
  return share > 0.0 && !state->reference->particles.ignore_solids
    ? share * sample->trim_weight - (sample->trim_weight - sample->weight)
    : INFINITY;
}

double compare_threshold_margin(
  const compare_state* state, const double point[3], const oracle_sample* sample)
{
  double eigenvalues[3] = { sample->trim_weight, 0.0, 0.0 };
  if (state->reference->field.kind == ORACLE_WEIGHT)
  {
    return INFINITY;
  }
  if (state->options->boundary_detection == MCOR_BOUNDARY_EIGENVALUE)
  {
    oracle_boundary_eigenvalues(&state->reference->field, point, eigenvalues);
  }
  return eigenvalues[0] - state->options->vertex_threshold;
}

double compare_fluid_margin(const compare_state* state, const oracle_sample* sample)
{
  return state->reference->field.kind == ORACLE_SHEPARD
    ? sample->weight - state->reference->limits.least_at_vertices
    : INFINITY;
}

double compare_trim_margin(
  const compare_state* state, const double point[3], const oracle_sample* sample)
{
  return fmin(
    fmin(compare_threshold_margin(state, point, sample), compare_wall_margin(state, sample)),
    compare_fluid_margin(state, sample));
}

int compare_rightly_trimmed(
  const compare_state* state, const double start[3], int axis, double length)
{
  const oracle_reference* reference = state->reference;
  const int pieces = 32;
  double previous = 0.0;
  for (int piece = 0; piece <= pieces; ++piece)
  {
    oracle_sample sample;
    double p[3] = { start[0], start[1], start[2] };
    p[axis] = start[axis] + length * piece / pieces;
    oracle_evaluate(&reference->field, NULL, p, &sample);
    const double difference = oracle_side(&reference->field, &sample, reference->limits.iso);
    if (piece > 0 && (difference >= 0.0) != (previous >= 0.0))
    {
      double low = (piece - 1.0) / pieces;
      double high = (double)piece / pieces;
      for (int step = 0; step < 50; ++step)
      {
        p[axis] = start[axis] + length * 0.5 * (low + high);
        oracle_evaluate(&reference->field, NULL, p, &sample);
        const int as_high = (oracle_side(&reference->field, &sample, reference->limits.iso) >=
                              0.0) == (difference >= 0.0);
        *(as_high ? &high : &low) = 0.5 * (low + high);
      }
      if (compare_trim_margin(state, p, &sample) < 1e-5)
      {
        return 1;
      }
    }
    previous = difference;
  }
  return 0;
}

void oracle_compare(const oracle_reference* reference, const mcor_options* options,
  const mcor_surface* surface, const mesh_report* mesh, int trimmed, oracle_comparison* comparison)
{
  const int64_t points = surface->point_count, edges = reference->lattice.edge_count;
  const int64_t components = reference->lattice.component_count;
  compare_state state = { reference, options, surface, mesh, trimmed, comparison,
    oracle_allocate(points, sizeof(int64_t)), oracle_allocate(edges, sizeof(int64_t)),
    oracle_allocate(edges, sizeof(int64_t)), oracle_allocate(points, 3 * sizeof(double)),
    oracle_allocate(points, sizeof(double)) };
  int64_t* count = oracle_allocate(2 * components, sizeof(int64_t));
  memset(comparison, 0, sizeof(*comparison));
  compare_edges(&state, count, count + components);
  compare_vertices(&state);
  compare_orientation(&state);
  free(state.vertex_edge);
  free(state.edge_vertex);
  free(state.second_vertex);
  free(state.gradient);
  free(state.vertex_cube);
  free(count);
}
