/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Which edge of the adaptive lattice each vertex lies on, and whether the mesh joins them on faces as
 * it must. Here an edge is its number in oracle_adaptive. */

#include "oracle_compare_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
  ADAPTIVE_CANDIDATES = 16
};

/* Two valid cells that touch only in the edge. */
static int adaptive_pinched(const adaptive_edge* edge)
{
  return edge->quadrants == 6 || edge->quadrants == 9;
}

static void adaptive_note(compare_state* state, const char* what, const adaptive_edge* edge)
{
  const oracle_lattice* nodes = &state->reference->adaptive.nodes;
  const double cube = state->reference->adaptive.cube;
  compare_note(state,
    "%s edge at (%.9g, %.9g, %.9g) axis %d of %lld cubes, f - iso = %.3g and %.3g, weight %.3g and "
    "%.3g, valid cells %x",
    what, (double)edge->at[0] * cube, (double)edge->at[1] * cube, (double)edge->at[2] * cube,
    edge->axis, (long long)edge->length, nodes->value[edge->node[0]] - state->reference->limits.iso,
    nodes->value[edge->node[1]] - state->reference->limits.iso, nodes->trim_weight[edge->node[0]],
    nodes->trim_weight[edge->node[1]], edge->quadrants);
}

/* ---- vertices ---- */

static int adaptive_open(const compare_state* state, int64_t e)
{
  return state->edge_vertex[e] < 0 ||
    (state->second_vertex[e] < 0 && adaptive_pinched(&state->reference->adaptive.edges[e]));
}

/* Crossed edges without a vertex that a point may lie on, its ends included. Returns how many;
 * *axis: the one along which it is no node, or -1; -2: it is on no line of the lattice. */
static int adaptive_candidates(
  compare_state* state, const double point[3], int64_t candidates[ADAPTIVE_CANDIDATES], int* axis)
{
  oracle_adaptive* adaptive = (oracle_adaptive*)&state->reference->adaptive;
  double u[3];
  int off[3];
  int count = 0;
  *axis = -1;
  for (int a = 0; a < 3; ++a)
  {
    u[a] = point[a] / adaptive->cube;
    off[a] = fabs(u[a] - round(u[a])) > fmax(1e-12, 8.0 * DBL_EPSILON * fabs(u[a]));
    *axis = !off[a] ? *axis : *axis == -1 ? a : -2;
  }
  for (int a = 0; a < 3 && *axis != -2; ++a)
  {
    for (int level = 0; level <= adaptive->top && (*axis < 0 || *axis == a); ++level)
    {
      const double length = ldexp(1.0, level);
      const double last = floor((off[a] ? u[a] : round(u[a])) / length) * length;
      for (int before = 0; before < 2; ++before)
      {
        int64_t at[3] = { llround(u[0]), llround(u[1]), llround(u[2]) };
        at[a] = (int64_t)(before ? last - length : last);
        const int64_t* e = adaptive_map_find(&adaptive->edge_map, at, a, 0);
        if (e && (double)adaptive->edges[*e].length == length &&
          u[a] <= (double)at[a] + length + 1e-9 && adaptive->edges[*e].used &&
          adaptive_open(state, *e) && count < ADAPTIVE_CANDIDATES)
        {
          candidates[count++] = *e;
        }
      }
    }
  }
  return count;
}

static void adaptive_claim(compare_state* state, int64_t v, int64_t e)
{
  const adaptive_edge* edge = &state->reference->adaptive.edges[e];
  state->vertex_edge[v] = 3 * e + edge->axis;
  state->vertex_cube[v] = (double)edge->length * state->reference->adaptive.cube;
  if (state->edge_vertex[e] < 0)
  {
    state->edge_vertex[e] = v;
    ++state->result->matched;
  }
  else
  {
    state->second_vertex[e] = v;
    ++state->result->split;
  }
}

/* Whether rounding may have put a vertex there: an end of its edge, the nearest nodes on its line, is
 * as good as on the other side. */
static int adaptive_doubtful(const compare_state* state, const double point[3], int axis)
{
  const oracle_reference* reference = state->reference;
  oracle_adaptive* adaptive = (oracle_adaptive*)&reference->adaptive;
  for (int level = 0; level <= adaptive->top; ++level)
  {
    const double length = ldexp(1.0, level);
    for (int end = 0; end < (axis < 0 ? 1 : 2); ++end)
    {
      double p[3];
      int64_t at[3];
      for (int a = 0; a < 3; ++a)
      {
        const double u = point[a] / adaptive->cube;
        at[a] = a == axis ? (int64_t)((floor(u / length) + end) * length) : llround(u);
        p[a] = (double)at[a] * adaptive->cube;
      }
      const int64_t* node = adaptive_map_find(&adaptive->node_map, at, 0, 0);
      if (node &&
        (adaptive->nodes.flags[*node] & (ORACLE_NODE_CLOSE | ORACLE_NODE_MARGIN) ||
          fabs(adaptive->nodes.value[*node] - reference->limits.iso) <=
            oracle_rounding(&reference->field, p, reference->unit)))
      {
        return 1;
      }
    }
  }
  return 0;
}

/* A vertex that no open edge is left for: a cut; a second one on its edge; one too many. */
static void adaptive_leave(compare_state* state, int64_t v, int axis)
{
  const mcor_surface* surface = state->surface;
  const oracle_reference* reference = state->reference;
  const double* point = &surface->points[3 * v];
  if (state->trimmed && surface->boundary_flag && surface->boundary_flag[v])
  {
    state->vertex_edge[v] = COMPARE_TRIM_VERTEX;
  }
  else if (axis == -2)
  {
    ++state->result->off_lattice;
    compare_note(state, "vertex %lld at (%.17g, %.17g, %.17g) on no line of the lattice",
      (long long)v, point[0], point[1], point[2]);
  }
  else
  {
    /* Numbers from edge_count on: on edges that are not crossed. */
    state->vertex_edge[v] = 3 * reference->adaptive.edge_count + (axis < 0 ? 0 : axis);
    if (adaptive_doubtful(state, point, axis))
    {
      ++state->result->excused;
      return;
    }
    ++state->result->extra;
    compare_note(
      state, "extra vertex %lld at (%.9g, %.9g, %.9g)", (long long)v, point[0], point[1], point[2]);
  }
}

/* First vertices with one place to be, as long as there are any, then those with two, and so on. */
static void adaptive_assign(compare_state* state)
{
  const int64_t count = state->surface->point_count;
  int64_t candidates[ADAPTIVE_CANDIDATES];
  int axis;
  for (int64_t e = 0; e < state->reference->adaptive.edge_count; ++e)
  {
    state->edge_vertex[e] = state->second_vertex[e] = -1;
  }
  for (int64_t v = 0; v < count; ++v)
  {
    state->vertex_edge[v] = COMPARE_OFF_LATTICE;
    state->vertex_cube[v] = state->reference->adaptive.cube;
  }
  for (int most = 1; most <= ADAPTIVE_CANDIDATES;)
  {
    int64_t assigned = 0;
    for (int64_t v = 0; v < count; ++v)
    {
      if (state->vertex_edge[v] == COMPARE_OFF_LATTICE)
      {
        const int found =
          adaptive_candidates(state, &state->surface->points[3 * v], candidates, &axis);
        if (found > 0 && found <= most)
        {
          adaptive_claim(state, v, candidates[0]);
          ++assigned;
        }
      }
    }
    most = assigned > 0 ? 1 : most + 1;
  }
  for (int64_t v = 0; v < count; ++v)
  {
    if (state->vertex_edge[v] == COMPARE_OFF_LATTICE)
    {
      adaptive_candidates(state, &state->surface->points[3 * v], candidates, &axis);
      adaptive_leave(state, v, axis);
    }
  }
}

/* ---- missing edges ---- */

static void adaptive_point(
  const compare_state* state, const adaptive_edge* edge, double t, double point[3])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const double along = axis == edge->axis ? t * (double)edge->length : 0.0;
    point[axis] = ((double)edge->at[axis] + along) * state->reference->adaptive.cube;
  }
}

static int adaptive_within_rounding(const compare_state* state, const adaptive_edge* edge)
{
  const oracle_reference* reference = state->reference;
  for (int end = 0; end < 2; ++end)
  {
    double p[3];
    adaptive_point(state, edge, end, p);
    if (fabs(reference->adaptive.nodes.value[edge->node[end]] - reference->limits.iso) <=
      oracle_rounding(&reference->field, p, reference->unit))
    {
      return 1;
    }
  }
  return 0;
}

static void adaptive_missing(compare_state* state, int64_t* present, int64_t* absent)
{
  const oracle_adaptive* adaptive = &state->reference->adaptive;
  oracle_comparison* result = state->result;
  for (int64_t e = 0; e < adaptive->edge_count; ++e)
  {
    const adaptive_edge* edge = &adaptive->edges[e];
    double start[3];
    if (!edge->used)
    {
      continue;
    }
    ++result->edges;
    adaptive_point(state, edge, 0.0, start);
    if (state->edge_vertex[e] >= 0)
    {
      present[edge->component] += !adaptive_pinched(edge);
    }
    else if (state->trimmed &&
      compare_rightly_trimmed(state, start, edge->axis, (double)edge->length * adaptive->cube))
    {
      ++result->trimmed;
    }
    else if (!edge->certain)
    {
      ++result->excused;
    }
    else if (adaptive_within_rounding(state, edge))
    {
      ++result->rounding;
    }
    else
    {
      ++result->missing;
      absent[edge->component] += !adaptive_pinched(edge);
      adaptive_note(state, "missing", edge);
    }
  }
  for (int64_t c = 0; c < adaptive->component_count; ++c)
  {
    result->components_missing += absent[c] > 0 && present[c] == 0;
    result->components_partial += absent[c] > 0 && present[c] > 0;
  }
}

/* ---- faces ---- */

/* Segments or sides of triangles, counted by the edges that they lead from and to. */
static int64_t adaptive_count(adaptive_map* map, int64_t from, int64_t to, int more)
{
  const int64_t at[3] = { from, to, 0 };
  int64_t* count = adaptive_map_find(map, at, 0, more);
  if (count && more)
  {
    *count = *count < 0 ? 1 : *count + 1;
  }
  return count ? *count : 0;
}

static int64_t adaptive_edge_of(const compare_state* state, int32_t vertex)
{
  const int64_t edge = state->vertex_edge[vertex];
  return edge >= 0 && edge / 3 < state->reference->adaptive.edge_count ? edge / 3 : -1;
}

static int adaptive_certain_pair(const compare_state* state, int64_t a, int64_t b)
{
  const adaptive_edge* edges = state->reference->adaptive.edges;
  return edges[a].certain && edges[b].certain && !(edges[a].doubtful && edges[b].doubtful);
}

/* Every segment is a side of one triangle for each cell that has it, in its direction. */
static void adaptive_compare_segments(
  compare_state* state, adaptive_map* wanted, adaptive_map* sides)
{
  const oracle_adaptive* adaptive = &state->reference->adaptive;
  for (int64_t s = 0; s < adaptive->segment_count; ++s)
  {
    adaptive_count(wanted, adaptive->segments[s].from, adaptive->segments[s].to, 1);
  }
  for (int64_t n = 0; n < state->mesh->side_count; ++n)
  {
    const mesh_edge* side = &state->mesh->side[n];
    const int64_t a = adaptive_edge_of(state, side->forward ? side->a : side->b);
    const int64_t b = adaptive_edge_of(state, side->forward ? side->b : side->a);
    if (a >= 0 && b >= 0)
    {
      adaptive_count(sides, a, b, 1);
    }
  }
  for (int64_t s = 0; s < adaptive->segment_count; ++s)
  {
    const int64_t from = adaptive->segments[s].from;
    const int64_t to = adaptive->segments[s].to;
    if (state->edge_vertex[from] < 0 || state->edge_vertex[to] < 0 ||
      !adaptive_certain_pair(state, from, to))
    {
      continue;
    }
    if (adaptive_count(sides, from, to, 0) != adaptive_count(wanted, from, to, 0) ||
      adaptive_count(sides, to, from, 0) != adaptive_count(wanted, to, from, 0))
    {
      ++state->result->segments_missing;
      adaptive_note(state, "not joined as it must be:", &adaptive->edges[from]);
    }
  }
}

/* A side of one triangle must be a cut, or a segment with a cell on one side only. */
static void adaptive_boundary(compare_state* state, adaptive_map* wanted)
{
  const mesh_report* mesh = state->mesh;
  for (int64_t s = 0; s < mesh->side_count; ++s)
  {
    const mesh_edge* side = &mesh->side[s];
    const mesh_edge* before = s > 0 ? side - 1 : side + 1;
    const mesh_edge* after = s + 1 < mesh->side_count ? side + 1 : before;
    if ((before->a == side->a && before->b == side->b) ||
      (after->a == side->a && after->b == side->b))
    {
      continue;
    }
    const int64_t a = adaptive_edge_of(state, side->a);
    const int64_t b = adaptive_edge_of(state, side->b);
    int explained = a < 0 && b < 0;
    if (a >= 0 && b >= 0)
    {
      explained = !adaptive_certain_pair(state, a, b) ||
        adaptive_count(wanted, a, b, 0) + adaptive_count(wanted, b, a, 0) == 1;
    }
    else if (a >= 0 || b >= 0)
    {
      const adaptive_edge* edge = &state->reference->adaptive.edges[a >= 0 ? a : b];
      explained = !edge->certain || edge->quadrants != 15;
    }
    if (!explained)
    {
      ++state->result->holes;
      compare_note(state, "open edge between vertices %d and %d", (int)side->a, (int)side->b);
    }
  }
}

static void adaptive_totals(compare_state* state)
{
  const oracle_adaptive* adaptive = &state->reference->adaptive;
  oracle_comparison* result = state->result;
  for (int64_t e = 0; e < adaptive->edge_count; ++e)
  {
    result->unsettled += adaptive->edges[e].doubtful;
    result->pinched_edges += adaptive->edges[e].used && adaptive_pinched(&adaptive->edges[e]);
  }
  for (int64_t n = 0; n < adaptive->node_count; ++n)
  {
    const int flags = adaptive->nodes.flags[n];
    result->unsettled +=
      (flags & ORACLE_NODE_CLOSE) && (flags & (ORACLE_NODE_VALID | ORACLE_NODE_MARGIN));
  }
  for (int64_t c = 0; c < adaptive->cell_count; ++c)
  {
    result->unsettled += !adaptive->cells[c].certain;
  }
  /* A tunnel of loops of a and b sides has a + b triangles; the loops alone, a - 2 and b - 2. */
  const int64_t triangles = adaptive->triangle_count + 4 * state->surface->statistics.tunnels;
  if (!state->trimmed && result->unsettled == 0 && result->rounding == 0 &&
    state->surface->triangle_count != triangles)
  {
    ++result->segments_missing;
    compare_note(state, "%lld triangles, not %lld", (long long)state->surface->triangle_count,
      (long long)triangles);
  }
}

void compare_adaptive(compare_state* state, int64_t* present, int64_t* absent)
{
  adaptive_map wanted = { NULL, 0, 0 };
  adaptive_map sides = { NULL, 0, 0 };
  state->result->components = state->reference->adaptive.component_count;
  adaptive_assign(state);
  adaptive_missing(state, present, absent);
  adaptive_compare_segments(state, &wanted, &sides);
  adaptive_boundary(state, &wanted);
  adaptive_totals(state);
  adaptive_map_free(&wanted);
  adaptive_map_free(&sides);
}
