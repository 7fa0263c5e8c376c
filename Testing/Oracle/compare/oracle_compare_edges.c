/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds the edge of the lattice that each vertex lies on, and checks that the mesh joins the vertices on faces as the
 * oracle's segments do. An edge is named by its number in oracle_lattice. */

#include "oracle_compare_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum
{
  COMPARE_CANDIDATES = 16
};

/* Returns whether only two of the four cells around the edge are valid, and these lie opposite each
 * other. */
static int compare_pinched(const lattice_edge* edge)
{
  return edge->quadrants == 6 || edge->quadrants == 9;
}

static void compare_note_edge(compare_state* state, const char* what, const lattice_edge* edge)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const lattice_node *low = &lattice->nodes[edge->node[0]], *high = &lattice->nodes[edge->node[1]];
  double p[3];
  oracle_place(lattice, edge->at, p);
  compare_note(state,
    "%s edge at (%.9g, %.9g, %.9g) axis %d of %lld cubes, f - iso = %.3g and %.3g, weight %.3g and "
    "%.3g, fluid weight %.3g and %.3g, valid cells %x",
    what, p[0], p[1], p[2], edge->axis, (long long)edge->length,
    low->value - state->reference->limits.iso, high->value - state->reference->limits.iso,
    low->trim_weight, high->trim_weight, low->weight, high->weight, edge->quadrants);
}

/* ---- vertices ---- */

/* Finds the crossed edges, ends included, on which a point may lie, and which still lack a vertex. A pinched edge (see
 * compare_pinched) needs two vertices. Returns how many edges there are. *axis: the axis of the edge inside which the
 * point lies; -1: the point is on a node; -2: it is on no line of the lattice. */
static int compare_candidates(
  compare_state* state, const double point[3], int64_t candidates[COMPARE_CANDIDATES], int* axis)
{
  oracle_lattice* lattice = (oracle_lattice*)&state->reference->lattice;
  double u[3];
  int off[3];
  int count = 0;
  *axis = -1;
  for (int a = 0; a < 3; ++a)
  {
    u[a] = point[a] / lattice->edge[a];
    off[a] = fabs(u[a] - round(u[a])) > fmax(1e-12, 8.0 * DBL_EPSILON * fabs(u[a]));
    *axis = !off[a] ? *axis : *axis == -1 ? a : -2;
  }
  for (int a = 0; a < 3 && *axis != -2; ++a)
  {
    for (int level = 0; level <= lattice->top && (*axis < 0 || *axis == a); ++level)
    {
      const double length = ldexp(1.0, level);
      const double last = floor((off[a] ? u[a] : round(u[a])) / length) * length;
      for (int before = 0; before < 2; ++before)
      {
        int64_t at[3] = { llround(u[0]), llround(u[1]), llround(u[2]) };
        at[a] = (int64_t)(before ? last - length : last);
        const int64_t* e = oracle_map_find(&lattice->edge_map, at, a, 0);
        const lattice_edge* edge = e ? &lattice->edges[*e] : NULL;
        if (edge && (double)edge->length == length && u[a] <= (double)at[a] + length + 1e-9 &&
          edge->used && count < COMPARE_CANDIDATES &&
          (state->edge_vertex[*e] < 0 || (state->second_vertex[*e] < 0 && compare_pinched(edge))))
        {
          candidates[count++] = *e;
        }
      }
    }
  }
  return count;
}

static void compare_claim(compare_state* state, int64_t v, int64_t e)
{
  const lattice_edge* edge = &state->reference->lattice.edges[e];
  state->vertex_edge[v] = 3 * e + edge->axis;
  state->vertex_cube[v] = (double)edge->length * state->reference->lattice.edge[edge->axis];
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

static int compare_within_rounding(const compare_state* state, const lattice_node* node)
{
  const oracle_reference* reference = state->reference;
  double p[3];
  oracle_place(&reference->lattice, node->at, p);
  return fabs(node->value - reference->limits.iso) <=
    oracle_rounding(&reference->field, p, reference->unit);
}

/* The place of a vertex that could not be matched with a crossed edge: a node, or an edge of any size. */
typedef struct compare_place
{
  int taken; /* a crossed edge here has its vertices already */
  int
    crossed; /* an edge here has ends on both sides, and rounding decides whether a cell at it is valid */
  int close;    /* a value here is close to iso */
  int rounding; /* a value here is within the bound on rounding */
} compare_place;

static compare_place compare_find_place(const compare_state* state, const double point[3], int axis)
{
  oracle_lattice* lattice = (oracle_lattice*)&state->reference->lattice;
  compare_place place = { 0 };
  for (int level = 0; level <= lattice->top; ++level)
  {
    const int64_t length = (int64_t)1 << level;
    const lattice_node* end[2] = { NULL, NULL };
    for (int side = 0; side < 2; ++side)
    {
      int64_t at[3];
      for (int a = 0; a < 3; ++a)
      {
        const double u = point[a] / lattice->edge[a];
        at[a] = a == axis ? ((int64_t)floor(u / (double)length) + side) * length : llround(u);
      }
      const int64_t* node = oracle_map_find(&lattice->node_map, at, 0, 0);
      end[side] = node ? &lattice->nodes[*node] : NULL;
    }
    const int usable = LATTICE_VALID | LATTICE_MARGIN;
    if (!end[0] || !end[1] || !(end[0]->flags & usable) || !(end[1]->flags & usable))
    {
      continue;
    }
    const int64_t* e = axis < 0 ? NULL : oracle_map_find(&lattice->edge_map, end[0]->at, axis, 0);
    const int crossed = e && lattice->edges[*e].length == length;
    place.taken |= crossed && lattice->edges[*e].used;
    place.crossed |= crossed && !lattice->edges[*e].used;
    place.close |= ((end[0]->flags | end[1]->flags) & LATTICE_CLOSE) != 0;
    place.rounding |=
      compare_within_rounding(state, end[0]) || compare_within_rounding(state, end[1]);
  }
  return place;
}

/* The vertex lies at no expected crossing. Returns whether trimming made the vertex: its boundary flag is not 0. If
 * rounding decides whether there is a crossing (close), the flag must be 2 (placed linearly), or the trim margin 0. */
static int compare_is_cut(const compare_state* state, int64_t v, int close)
{
  const mcor_surface* surface = state->surface;
  const double* point = &surface->points[3 * v];
  oracle_sample sample;
  if (!state->trimmed || !surface->boundary_flag || !surface->boundary_flag[v])
  {
    return 0;
  }
  oracle_evaluate(&state->reference->field, NULL, point, &sample);
  return !close || fabs(compare_trim_margin(state, point, &sample)) <= 1e-4 ||
    surface->boundary_flag[v] == 2;
}

/* Judges a vertex that could not be matched with a crossed edge: trimming made it, rounding excuses it, or it is a
 * fault (off the lattice, the second vertex on its edge, or on an edge that is not crossed). */
static void compare_unmatched(compare_state* state, int64_t v, int axis)
{
  const double* point = &state->surface->points[3 * v];
  const compare_place none = { 0 };
  const compare_place place = axis == -2 ? none : compare_find_place(state, point, axis);
  if (compare_is_cut(state, v, place.close))
  {
    state->vertex_edge[v] = COMPARE_TRIM_VERTEX;
    return;
  }
  if (axis == -2)
  {
    ++state->result->off_lattice;
    compare_note(state, "vertex %lld at (%.17g, %.17g, %.17g) on no line of the lattice",
      (long long)v, point[0], point[1], point[2]);
    return;
  }
  /* Edge numbers of at least edge_count stand for edges that are not crossed. */
  state->vertex_edge[v] = 3 * state->reference->lattice.edge_count + (axis < 0 ? 0 : axis);
  if (!place.taken && (place.crossed || place.close))
  {
    ++state->result->excused;
  }
  else if (!place.taken && place.rounding)
  {
    ++state->result->rounding;
  }
  else
  {
    ++*(place.taken ? &state->result->doubled : &state->result->extra);
    compare_note(state, "%s vertex %lld at (%.9g, %.9g, %.9g)", place.taken ? "second" : "extra",
      (long long)v, point[0], point[1], point[2]);
  }
}

/* Assigns vertices to edges: first vertices that fit one edge only, as long as there are any, then vertices that fit
 * two edges, and so on. */
static void compare_assign(compare_state* state)
{
  const int64_t count = state->surface->point_count;
  int64_t candidates[COMPARE_CANDIDATES];
  int axis;
  for (int64_t e = 0; e < state->reference->lattice.edge_count; ++e)
  {
    state->edge_vertex[e] = state->second_vertex[e] = -1;
  }
  for (int64_t v = 0; v < count; ++v)
  {
    state->vertex_edge[v] = COMPARE_OFF_LATTICE;
    state->vertex_cube[v] = state->reference->lattice.cube;
  }
  for (int most = 1; most <= COMPARE_CANDIDATES;)
  {
    int64_t assigned = 0;
    for (int64_t v = 0; v < count; ++v)
    {
      if (state->vertex_edge[v] == COMPARE_OFF_LATTICE)
      {
        const int found =
          compare_candidates(state, &state->surface->points[3 * v], candidates, &axis);
        if (found > 0 && found <= most)
        {
          compare_claim(state, v, candidates[0]);
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
      compare_candidates(state, &state->surface->points[3 * v], candidates, &axis);
      compare_unmatched(state, v, axis);
    }
  }
}

/* ---- missing edges ---- */

static void compare_missing(compare_state* state, int64_t* present, int64_t* absent)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  oracle_comparison* result = state->result;
  for (int64_t e = 0; e < lattice->edge_count; ++e)
  {
    const lattice_edge* edge = &lattice->edges[e];
    const lattice_node *low = &lattice->nodes[edge->node[0]],
                       *high = &lattice->nodes[edge->node[1]];
    double start[3];
    if (!edge->used)
    {
      continue;
    }
    ++result->edges;
    oracle_place(lattice, edge->at, start);
    if (state->edge_vertex[e] >= 0)
    {
      present[edge->component] += !compare_pinched(edge);
    }
    else if (state->trimmed &&
      compare_rightly_trimmed(
        state, start, edge->axis, (double)edge->length * lattice->edge[edge->axis]))
    {
      ++result->trimmed;
    }
    else if (!edge->sure || (low->flags | high->flags) & LATTICE_CLOSE)
    {
      ++result->excused;
    }
    else if (compare_within_rounding(state, low) || compare_within_rounding(state, high))
    {
      ++result->rounding;
    }
    else
    {
      ++result->missing;
      absent[edge->component] += !compare_pinched(edge);
      compare_note_edge(state, "missing", edge);
    }
  }
  for (int64_t c = 0; c < lattice->component_count; ++c)
  {
    result->components_missing += absent[c] > 0 && present[c] == 0;
    result->components_partial += absent[c] > 0 && present[c] > 0;
  }
}

/* ---- faces ---- */

/* Returns the map's count of segments or triangle sides from one edge to another. more: adds 1 to the count first. */
static int64_t compare_count(oracle_map* map, int64_t from, int64_t to, int more)
{
  const int64_t at[3] = { from, to, 0 };
  int64_t* count = oracle_map_find(map, at, 0, more);
  if (count && more)
  {
    *count = *count < 0 ? 1 : *count + 1;
  }
  return count ? *count : 0;
}

static int64_t compare_edge_of(const compare_state* state, int32_t vertex)
{
  const int64_t edge = state->vertex_edge[vertex];
  return edge >= 0 && edge / 3 < state->reference->lattice.edge_count ? edge / 3 : -1;
}

/* Returns the value that the map has for a pair of edges, or -1. */
static int64_t compare_pair(const oracle_map* pairs, int64_t a, int64_t b)
{
  const int64_t pair[3] = { a < b ? a : b, a < b ? b : a, 0 };
  const int64_t* value = oracle_map_find((oracle_map*)pairs, pair, 0, 0);
  return value ? *value : -1;
}

/* Checks the oracle's segments. A segment leads from one crossed edge to another on a cell's face. For each cell that
 * has the segment, exactly one triangle must have a side with the segment's ends and direction. */
static void compare_segments(compare_state* state, oracle_map* wanted, oracle_map* sides)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  for (int64_t s = 0; s < lattice->segment_count; ++s)
  {
    compare_count(wanted, lattice->segments[s].from, lattice->segments[s].to, 1);
  }
  for (int64_t n = 0; n < state->mesh->side_count; ++n)
  {
    const mesh_edge* side = &state->mesh->side[n];
    const int64_t a = compare_edge_of(state, side->forward ? side->a : side->b);
    const int64_t b = compare_edge_of(state, side->forward ? side->b : side->a);
    if (a >= 0 && b >= 0)
    {
      compare_count(sides, a, b, 1);
    }
  }
  for (int64_t s = 0; s < lattice->segment_count; ++s)
  {
    const int64_t from = lattice->segments[s].from;
    const int64_t to = lattice->segments[s].to;
    /* Segments are left out if rounding decides them or if, with MCOR_PAIRS, both edges are pinched: pairs may miss a
     * component of the surface, though its pinched edges have vertices of another component. */
    const int may_lack = state->options->seeds == MCOR_PAIRS &&
      compare_pinched(&lattice->edges[from]) && compare_pinched(&lattice->edges[to]);
    if (state->edge_vertex[from] < 0 || state->edge_vertex[to] < 0 || may_lack ||
      compare_pair(&lattice->doubts, from, to) >= 0 ||
      compare_pair(&lattice->either, from, to) >= 0)
    {
      continue;
    }
    if (compare_count(sides, from, to, 0) != compare_count(wanted, from, to, 0) ||
      compare_count(sides, to, from, 0) != compare_count(wanted, to, from, 0))
    {
      ++state->result->segments_missing;
      compare_note_edge(state, "not joined as it must be:", &lattice->edges[from]);
    }
  }
}

/* Checks each triangle side that no second triangle shares. It must have one of three causes: trimming made both ends;
 * trimming made one end, and a cell at the other end's edge is not valid; or the side is a segment of only one cell. */
static void compare_boundary(compare_state* state, oracle_map* wanted)
{
  const mesh_report* mesh = state->mesh;
  for (int64_t s = 0; s < mesh->side_count; ++s)
  {
    const mesh_edge* side = &mesh->side[s];
    if (side->sharing != 1)
    {
      continue;
    }
    const int64_t a = compare_edge_of(state, side->a);
    const int64_t b = compare_edge_of(state, side->b);
    int explained = a < 0 && b < 0;
    if (a >= 0 && b >= 0)
    {
      /* Rounding may decide how a face is joined, but both of its cells join it in the same way. */
      const oracle_lattice* lattice = &state->reference->lattice;
      const int64_t either = compare_pair(&lattice->either, a, b);
      const int64_t cells =
        either >= 0 ? either : compare_count(wanted, a, b, 0) + compare_count(wanted, b, a, 0);
      explained = cells == 1 || compare_pair(&lattice->doubts, a, b) >= 0;
    }
    else if (a >= 0 || b >= 0)
    {
      const lattice_edge* edge = &state->reference->lattice.edges[a >= 0 ? a : b];
      explained = !edge->certain || edge->quadrants != 15;
    }
    if (!explained)
    {
      ++state->result->holes;
      compare_note(state, "open edge between vertices %d and %d", (int)side->a, (int)side->b);
    }
  }
}

void compare_edges(compare_state* state, int64_t* present, int64_t* absent)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  oracle_comparison* result = state->result;
  oracle_map wanted = { NULL, 0, 0 }, sides = { NULL, 0, 0 };
  result->components = lattice->component_count;
  compare_assign(state);
  compare_missing(state, present, absent);
  compare_segments(state, &wanted, &sides);
  compare_boundary(state, &wanted);
  oracle_map_free(&wanted);
  oracle_map_free(&sides);
  for (int64_t n = 0; n < lattice->node_count; ++n)
  {
    const int flags = lattice->nodes[n].flags;
    result->unsettled += (flags & LATTICE_CLOSE) && (flags & (LATTICE_VALID | LATTICE_MARGIN));
  }
  for (int64_t c = 0; c < lattice->cell_count; ++c)
  {
    result->unsettled += !lattice->cells[c].certain;
  }
  /* Compares the numbers of triangles. Two loops of a and b sides have a - 2 and b - 2 triangles; a tunnel between them
   * has a + b, which is 4 more. */
  const int64_t triangles = lattice->triangle_count + 4 * state->surface->statistics.tunnels;
  if (!state->trimmed && state->options->seeds != MCOR_PAIRS &&
    lattice->doubts.count + lattice->either.count == 0 && result->unsettled == 0 &&
    result->rounding == 0 && state->surface->triangle_count != triangles)
  {
    ++result->segments_missing;
    compare_note(state, "%lld triangles, not %lld", (long long)state->surface->triangle_count,
      (long long)triangles);
  }
}
