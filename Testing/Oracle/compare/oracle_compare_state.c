/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
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

/* Least trimming weight at the nodes of a cell; NaN outside the lattice. */
static double compare_least_weight(const oracle_lattice* lattice, const int64_t ijk[3])
{
  double least = INFINITY;
  for (int c = 0; c < 8; ++c)
  {
    const int64_t at[3] = { ijk[0] + (c & 1), ijk[1] + (c >> 1 & 1), ijk[2] + (c >> 2) };
    for (int axis = 0; axis < 3; ++axis)
    {
      if (at[axis] < 0 || at[axis] >= lattice->size[axis])
      {
        return NAN;
      }
    }
    least = fmin(least, lattice->trim_weight[oracle_node_index(lattice, at[0], at[1], at[2])]);
  }
  return least;
}

void compare_note_edge(compare_state* state, const char* what, int64_t edge)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  int64_t nodes[2];
  int64_t cells[4][3];
  double p[3];
  double w[4];
  oracle_edge_ends(lattice, edge, nodes);
  oracle_edge_cells(lattice, edge, cells);
  oracle_node_position(lattice, nodes[0], p);
  for (int c = 0; c < 4; ++c)
  {
    w[c] = compare_least_weight(lattice, cells[c]);
  }
  compare_note(state,
    "%s edge at (%.9g, %.9g, %.9g) axis %d, f - iso = %.3g and %.3g, fluid weight %.3g and %.3g,"
    " least weight of its cells %.4g %.4g %.4g %.4g",
    what, p[0], p[1], p[2], (int)(edge % 3),
    lattice->value[nodes[0]] - state->reference->limits.iso,
    lattice->value[nodes[1]] - state->reference->limits.iso, lattice->weight[nodes[0]],
    lattice->weight[nodes[1]], w[0], w[1], w[2], w[3]);
}

int compare_end_flag(const oracle_lattice* lattice, int64_t edge, int flag)
{
  int64_t nodes[2];
  oracle_edge_ends(lattice, edge, nodes);
  return ((lattice->flags[nodes[0]] | lattice->flags[nodes[1]]) & flag) != 0;
}

int compare_pinched(const oracle_lattice* lattice, int64_t edge)
{
  int64_t cells[4][3];
  int valid[4];
  oracle_edge_cells(lattice, edge, cells);
  for (int c = 0; c < 4; ++c)
  {
    valid[c] = oracle_cell_valid(lattice, cells[c][0], cells[c][1], cells[c][2]);
  }
  /* Cells 0 and 3, 1 and 2 are diagonal to each other. */
  return valid[0] == valid[3] && valid[1] == valid[2] && valid[0] != valid[1];
}
