/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <float.h>
#include <math.h>

/* ---- which lattice edge does a vertex lie on? ---- */

/* The position alone decides: on an edge, two coordinates are integer multiples of the edges. */
static int64_t compare_locate(const oracle_lattice* lattice, const double point[3])
{
  double u[3];
  double off[3];
  int axis = 0;
  double noise = 1e-12;
  for (int a = 0; a < 3; ++a)
  {
    u[a] = point[a] / lattice->edge[a];
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
  return !close || fabs(compare_trim_margin(state, point, &sample)) <= 1e-4 ||
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

void compare_assign(compare_state* state)
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

/* ---- missing and extra edges ---- */

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

static int compare_edge_trimmed(const compare_state* state, int64_t edge)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  double start[3];
  oracle_node_position(lattice, edge / 3, start);
  return compare_rightly_trimmed(state, start, (int)(edge % 3), lattice->edge[edge % 3]);
}

void compare_missing(compare_state* state, int64_t* present, int64_t* absent)
{
  const oracle_reference* reference = state->reference;
  oracle_comparison* result = state->result;
  for (int64_t e = 0; e < reference->surface.edge_count; ++e)
  {
    const int64_t edge = reference->surface.edge[e];
    /* Such an edge says nothing of components: a pinched edge may be there for the sake of
     * another component. */
    const int64_t component = compare_pinched(&reference->lattice, edge)
      ? reference->surface.component_count
      : reference->surface.edge_component[e];
    if (state->edge_vertex[e] >= 0)
    {
      ++present[component];
    }
    else if (state->trimmed && compare_edge_trimmed(state, edge))
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

void compare_extra(compare_state* state)
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
