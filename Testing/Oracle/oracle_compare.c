/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <float.h>
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

double compare_trim_quantity(
  const compare_state* state, const double point[3], const oracle_sample* sample)
{
  if (state->options->boundary_detection != MCOR_BOUNDARY_EIGENVALUE)
  {
    return sample->trim_weight;
  }
  double eigenvalues[3];
  oracle_boundary_eigenvalues(&state->reference->field, point, eigenvalues);
  return eigenvalues[0];
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

/* ---- which lattice edge does a vertex lie on? ----------------------------------------------- */

/* The position alone decides: on an edge, two coordinates are integer multiples of the cube size.
 */
static int64_t compare_locate(const oracle_lattice* lattice, const double point[3])
{
  double u[3];
  double off[3];
  int axis = 0;
  double noise = 1e-12;
  for (int a = 0; a < 3; ++a)
  {
    u[a] = point[a] / lattice->cube;
    off[a] = fabs(u[a] - round(u[a]));
    noise = fmax(noise, 8.0 * DBL_EPSILON * fabs(u[a]));
  }
  for (int a = 1; a < 3; ++a)
  {
    axis = off[a] > off[axis] ? a : axis;
  }
  const int on_node = off[axis] <= noise;
  int64_t at[3];
  for (int a = 0; a < 3; ++a)
  {
    if (a != axis && off[a] > noise)
    {
      return COMPARE_OFF_LATTICE;
    }
    at[a] = (int64_t)(a == axis && !on_node ? floor(u[a]) : round(u[a])) - lattice->origin[a];
    if (at[a] < 0 || at[a] + 1 >= lattice->size[a])
    {
      return COMPARE_OFF_LATTICE;
    }
  }
  const int64_t node = oracle_node_index(lattice, at[0], at[1], at[2]);
  return on_node ? COMPARE_ON_NODE - node : 3 * node + axis;
}

static int compare_takes_second(const compare_state* state, int64_t e)
{
  return state->second_vertex[e] < 0 &&
    compare_pinched(&state->reference->lattice, state->reference->surface.edge[e]);
}

static void compare_claim(compare_state* state, int64_t vertex, int64_t edge)
{
  const int64_t e = oracle_find_edge(&state->reference->surface, edge);
  state->vertex_edge[vertex] = edge;
  if (e < 0)
  {
    return;
  }
  if (state->edge_vertex[e] < 0)
  {
    state->edge_vertex[e] = vertex;
    ++state->result->matched;
  }
  else if (compare_takes_second(state, e))
  {
    state->second_vertex[e] = vertex;
    ++state->result->split;
  }
  else
  {
    ++state->result->doubled;
    compare_note_edge(state, "two vertices on", edge);
  }
}

/* The crossed edges of a node that no vertex has claimed yet; returns how many. */
static int compare_open_edges(const compare_state* state, int64_t node, int64_t open[6])
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  int count = 0;
  for (int c = 0; c < 6; ++c)
  {
    const int64_t edge = 3 * (c < 3 ? node : node - step[c - 3]) + c % 3;
    const int64_t e = edge >= 0 ? oracle_find_edge(&state->reference->surface, edge) : -1;
    if (e >= 0 && state->edge_vertex[e] < 0)
    {
      open[count++] = edge;
    }
  }
  return count;
}

/* Whether a flagged vertex where no crossing is expected is a cut: not if the crossing there is up
 * to rounding, unless its weight says so. */
static int compare_is_cut(const compare_state* state, int64_t v, int close)
{
  const double* point = &state->surface->points[3 * v];
  oracle_sample sample;
  oracle_evaluate(&state->reference->field, NULL, point, &sample);
  const double quantity = compare_trim_quantity(state, point, &sample);
  return !close || fabs(quantity - state->options->vertex_threshold) <= 1e-4 ||
    state->surface->boundary_flag[v] == 2;
}

/* Vertices on a node: first those with one open edge, as long as there are any, then the others. */
static void compare_assign_on_nodes(compare_state* state)
{
  for (int most = 1; most <= 6;)
  {
    int64_t assigned = 0;
    for (int64_t v = 0; v < state->surface->point_count; ++v)
    {
      int64_t open[6];
      if (state->vertex_edge[v] <= COMPARE_ON_NODE)
      {
        const int count = compare_open_edges(state, COMPARE_ON_NODE - state->vertex_edge[v], open);
        if (count > 0 && count <= most)
        {
          compare_claim(state, v, open[0]);
          ++assigned;
        }
      }
    }
    most = assigned > 0 ? 1 : most + 1;
  }
  for (int64_t v = 0; v < state->surface->point_count; ++v)
  {
    if (state->vertex_edge[v] <= COMPARE_ON_NODE)
    {
      /* No crossed edge is left for it: a cut, or to be judged as a vertex on an uncrossed edge. */
      const int64_t node = COMPARE_ON_NODE - state->vertex_edge[v];
      const int close = state->reference->lattice.flags[node] & ORACLE_NODE_CLOSE;
      const int cut = state->trimmed && state->surface->boundary_flag &&
        state->surface->boundary_flag[v] && compare_is_cut(state, v, close);
      state->vertex_edge[v] = cut ? COMPARE_TRIM_VERTEX : 3 * node;
    }
  }
}

static void compare_assign(compare_state* state)
{
  const mcor_surface* surface = state->surface;
  for (int64_t e = 0; e < state->reference->surface.edge_count; ++e)
  {
    state->edge_vertex[e] = state->second_vertex[e] = -1;
  }
  for (int64_t v = 0; v < surface->point_count; ++v)
  {
    const int64_t edge = compare_locate(&state->reference->lattice, &surface->points[3 * v]);
    /* On a crossed edge a flagged vertex is one at the border of invalid cells, else a cut. */
    const int64_t e = edge >= 0 ? oracle_find_edge(&state->reference->surface, edge) : -1;
    const int flagged = surface->boundary_flag && surface->boundary_flag[v];
    const int open = e >= 0 && (state->edge_vertex[e] < 0 || compare_takes_second(state, e));
    const int close =
      edge >= 0 && compare_end_flag(&state->reference->lattice, edge, ORACLE_NODE_CLOSE);
    const int cut = flagged && state->trimmed && edge > COMPARE_ON_NODE && !open &&
      compare_is_cut(state, v, close);
    state->vertex_edge[v] = cut ? COMPARE_TRIM_VERTEX : edge;
    if (state->vertex_edge[v] == COMPARE_OFF_LATTICE)
    {
      ++state->result->off_lattice;
      compare_note(state, "vertex %lld at (%.17g, %.17g, %.17g) on no lattice edge", (long long)v,
        surface->points[3 * v], surface->points[3 * v + 1], surface->points[3 * v + 2]);
    }
    else if (state->vertex_edge[v] >= 0)
    {
      compare_claim(state, v, edge);
    }
  }
  compare_assign_on_nodes(state);
}

/* ---- missing and extra edges ---------------------------------------------------------------- */

static int compare_any_cell(const oracle_lattice* lattice, int64_t edge,
  int (*test)(const oracle_lattice*, int64_t, int64_t, int64_t))
{
  int64_t cells[4][3];
  int count = 0;
  oracle_edge_cells(lattice, edge, cells);
  for (int c = 0; c < 4; ++c)
  {
    count += test(lattice, cells[c][0], cells[c][1], cells[c][2]);
  }
  return count;
}

int compare_end_flag(const oracle_lattice* lattice, int64_t edge, int flag)
{
  int64_t nodes[2];
  oracle_edge_ends(lattice, edge, nodes);
  return ((lattice->flags[nodes[0]] | lattice->flags[nodes[1]]) & flag) != 0;
}

static int compare_within_rounding(const oracle_reference* reference, int64_t edge)
{
  int64_t nodes[2];
  oracle_edge_ends(&reference->lattice, edge, nodes);
  for (int end = 0; end < 2; ++end)
  {
    double p[3];
    oracle_node_position(&reference->lattice, nodes[end], p);
    if (fabs(reference->lattice.value[nodes[end]] - reference->limits.iso) <=
      oracle_rounding(&reference->field, p, reference->unit))
    {
      return 1;
    }
  }
  return 0;
}

/* 1 if the surface crosses the edge at a place that trimming removes. */
static int compare_rightly_trimmed(const compare_state* state, int64_t edge)
{
  const oracle_reference* reference = state->reference;
  const double limit = state->options->vertex_threshold + 1e-5;
  const int pieces = 32;
  double p[3];
  double previous = 0.0;
  oracle_sample sample;
  oracle_edge_root(&reference->lattice, &reference->field, reference->limits.iso, edge, p, &sample);
  if (compare_trim_quantity(state, p, &sample) < limit)
  {
    return 1;
  }
  /* The edge may be crossed several times; the surface may have any of the crossings. */
  oracle_node_position(&reference->lattice, edge / 3, p);
  const double start = p[edge % 3];
  for (int piece = 0; piece <= pieces; ++piece)
  {
    p[edge % 3] = start + reference->lattice.cube * piece / pieces;
    oracle_evaluate(&reference->field, NULL, p, &sample);
    const double difference = sample.value - reference->limits.iso;
    if (piece > 0 && (difference >= 0.0) != (previous >= 0.0) &&
      compare_trim_quantity(state, p, &sample) < limit)
    {
      return 1;
    }
    previous = difference;
  }
  return 0;
}

static void compare_missing(compare_state* state, int64_t* present, int64_t* absent)
{
  const oracle_reference* reference = state->reference;
  oracle_comparison* result = state->result;
  for (int64_t e = 0; e < reference->surface.edge_count; ++e)
  {
    const int64_t edge = reference->surface.edge[e];
    /* Of no use for components: a pinched edge may be there for the sake of another component. */
    const int64_t component = compare_pinched(&reference->lattice, edge)
      ? reference->surface.component_count
      : reference->surface.edge_component[e];
    if (state->edge_vertex[e] >= 0)
    {
      ++present[component];
    }
    else if (state->trimmed && compare_rightly_trimmed(state, edge))
    {
      ++result->trimmed;
    }
    else if (compare_end_flag(&reference->lattice, edge, ORACLE_NODE_CLOSE) ||
      !compare_any_cell(&reference->lattice, edge, oracle_cell_certain))
    {
      ++result->excused;
    }
    else if (compare_within_rounding(reference, edge))
    {
      ++result->rounding;
    }
    else
    {
      ++result->missing;
      ++absent[component];
      compare_note_edge(state, "missing", edge);
    }
  }
  for (int64_t c = 0; c < reference->surface.component_count; ++c)
  {
    result->components_missing += absent[c] > 0 && present[c] == 0;
    result->components_partial += absent[c] > 0 && present[c] > 0;
  }
}

static void compare_extra(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  oracle_comparison* result = state->result;
  for (int64_t v = 0; v < state->surface->point_count; ++v)
  {
    const int64_t edge = state->vertex_edge[v];
    if (edge < 0 || oracle_find_edge(&state->reference->surface, edge) >= 0)
    {
      continue;
    }
    int64_t nodes[2];
    oracle_edge_ends(lattice, edge, nodes);
    const int crossed =
      ((lattice->flags[nodes[0]] ^ lattice->flags[nodes[1]]) & ORACLE_NODE_ABOVE) != 0;
    const int possible = compare_any_cell(lattice, edge, oracle_cell_possible) > 0;
    if (possible && (crossed || compare_end_flag(lattice, edge, ORACLE_NODE_CLOSE)))
    {
      ++result->excused;
    }
    else if (possible && compare_within_rounding(state->reference, edge))
    {
      ++result->rounding;
    }
    else
    {
      ++result->extra;
      compare_note_edge(state, "extra", edge);
    }
  }
}

int oracle_compare(const oracle_reference* reference, const mcor_options* options,
  const mcor_surface* surface, const mesh_report* mesh, int trimmed, oracle_comparison* comparison)
{
  memset(comparison, 0, sizeof(*comparison));
  const size_t points = (size_t)surface->point_count + 1;
  const size_t components = (size_t)reference->surface.component_count + 1;
  compare_state state = { reference, options, surface, mesh, trimmed, comparison,
    malloc(points * sizeof(int64_t)),
    malloc(((size_t)reference->surface.edge_count + 1) * sizeof(int64_t)),
    malloc(((size_t)reference->surface.edge_count + 1) * sizeof(int64_t)),
    malloc(3 * points * sizeof(double)) };
  int64_t* count = calloc(2 * components, sizeof(int64_t));
  int enough =
    state.vertex_edge && state.edge_vertex && state.second_vertex && state.gradient && count;
  if (enough)
  {
    comparison->edges = reference->surface.edge_count;
    comparison->components = reference->surface.component_count;
    compare_assign(&state);
    compare_missing(&state, count, count + components);
    compare_extra(&state);
    compare_vertices(&state);
    compare_count_pinched(&state);
    compare_count_unsettled(&state);
    compare_boundary(&state);
    compare_faces(&state);
    compare_inverted(&state);
    enough = compare_orientation(&state);
  }
  free(state.vertex_edge);
  free(state.edge_vertex);
  free(state.second_vertex);
  free(state.gradient);
  free(count);
  return enough;
}
