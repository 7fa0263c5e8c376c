/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <math.h>
#include <string.h>

/* The 4 edges of the face of `cell` towards -axis, in cyclic order. */
static void compare_face_edges(
  const oracle_lattice* lattice, int64_t node, int axis, int64_t edges[4])
{
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  edges[0] = 3 * node + u;
  edges[1] = 3 * (node + step[u]) + v;
  edges[2] = 3 * (node + step[v]) + u;
  edges[3] = 3 * node + v;
}

/* The crossed edges of a face, by number; -1 if one of them has no vertex. */
static int compare_face_crossings(
  const compare_state* state, const int64_t edges[4], int64_t crossings[4])
{
  int count = 0;
  for (int n = 0; n < 4; ++n)
  {
    const int64_t e = oracle_find_edge(&state->reference->surface, edges[n]);
    if (e >= 0)
    {
      if (state->edge_vertex[e] < 0)
      {
        return -1;
      }
      crossings[count++] = e;
    }
  }
  return count;
}

/* Sides of triangles from a vertex of one crossed edge to one of another. */
static int64_t compare_count_sides(const compare_state* state, int64_t from, int64_t to)
{
  const int64_t a[2] = { state->edge_vertex[from], state->second_vertex[from] };
  const int64_t b[2] = { state->edge_vertex[to], state->second_vertex[to] };
  int64_t count = 0;
  for (int n = 0; n < 4; ++n)
  {
    if (a[n & 1] >= 0 && b[n >> 1] >= 0)
    {
      count += mesh_count_directed(state->mesh, (int32_t)a[n & 1], (int32_t)b[n >> 1]);
    }
  }
  return count;
}

/* On a face with four crossings, whether the nodes above iso are joined: 0 or 1, or -1 where
 * that is within rounding. With topology by the field, the field at the bilinear interpolant's
 * saddle says. */
static int compare_face_joined(const compare_state* state, int64_t node, int axis)
{
  const oracle_reference* r = state->reference;
  const oracle_lattice* lattice = &r->lattice;
  const int64_t step[3] = { 1, lattice->size[0], lattice->size[0] * lattice->size[1] };
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const double value[4] = { lattice->value[node], lattice->value[node + step[u]],
    lattice->value[node + step[v]], lattice->value[node + step[u] + step[v]] };
  const oracle_decider decider = { &r->field, &r->limits, r->unit };
  double point[3];
  if (!r->by_field)
  {
    return 0;
  }
  oracle_node_position(lattice, node, point);
  return oracle_decide_face(&decider, value, point, lattice->edge, u, v);
}

/* Seen from the upper cell, the walk around the face through its edges 0 to 3 enters what is above on one crossed edge
 * and leaves it on another. The lower cell, if it is valid, has a triangle's side from the former to the latter, the
 * upper one a side back. On a face with four crossings the way goes around each node above, or, where these are joined,
 * around each node below. */
static int compare_face_connected(const compare_state* state, const int64_t crossings[4], int count,
  const int valid[2], const int64_t edges[4], int joined)
{
  for (int n = 0; n < count; ++n)
  {
    const int64_t e = crossings[n];
    const int64_t* nth = edges;
    while (*nth != state->reference->surface.edge[e])
    {
      ++nth;
    }
    int64_t ends[2];
    oracle_edge_ends(&state->reference->lattice, *nth, ends);
    const int64_t first = nth - edges < 2 ? ends[0] : ends[1]; /* on the walk */
    const int64_t other = crossings[(n + (joined ? count - 1 : 1)) % count];
    if (!(state->reference->lattice.flags[first] & ORACLE_NODE_ABOVE) &&
      (compare_count_sides(state, e, other) != valid[0] ||
        compare_count_sides(state, other, e) != valid[1]))
    {
      return 0;
    }
  }
  return 1;
}

/* With the paper's seeds a component may be missing though the crossings of a face have vertices:
 * those of another component that it touches in pinched edges. */
static int compare_cells_left_out(const compare_state* state, const int64_t crossings[4], int count)
{
  int left_out = state->options->seeds == MCOR_PAIRS;
  for (int n = 0; left_out && n < count; ++n)
  {
    left_out =
      compare_pinched(&state->reference->lattice, state->reference->surface.edge[crossings[n]]);
  }
  return left_out;
}

static void compare_face(compare_state* state, const int64_t ijk[3], int axis)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const int64_t other[3] = { ijk[0] - (axis == 0), ijk[1] - (axis == 1), ijk[2] - (axis == 2) };
  const int valid[2] = { oracle_cell_valid(lattice, other[0], other[1], other[2]),
    oracle_cell_valid(lattice, ijk[0], ijk[1], ijk[2]) };
  const int possible = oracle_cell_possible(lattice, ijk[0], ijk[1], ijk[2]) +
    oracle_cell_possible(lattice, other[0], other[1], other[2]);
  const int certain = oracle_cell_certain(lattice, ijk[0], ijk[1], ijk[2]) +
    oracle_cell_certain(lattice, other[0], other[1], other[2]);
  int64_t edges[4];
  int64_t crossings[4];
  compare_face_edges(lattice, oracle_node_index(lattice, ijk[0], ijk[1], ijk[2]), axis, edges);
  for (int n = 0; n < 4; ++n)
  {
    if (compare_end_flag(lattice, edges[n], ORACLE_NODE_CLOSE))
    {
      return;
    }
  }
  const int count = compare_face_crossings(state, edges, crossings);
  if (count >= 2 && compare_cells_left_out(state, crossings, count))
  {
    return;
  }
  const int64_t node = oracle_node_index(lattice, ijk[0], ijk[1], ijk[2]);
  const int joined = count == 4 ? compare_face_joined(state, node, axis) : 0;
  if (valid[0] + valid[1] > 0 && possible == certain && count >= 2 &&
    !compare_face_connected(state, crossings, count, valid, edges, joined == 1) &&
    !(joined < 0 && compare_face_connected(state, crossings, count, valid, edges, 1)))
  {
    ++state->result->segments_missing;
    compare_note_edge(state, "not connected on the face of", edges[0]);
  }
}

void compare_faces(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  for (int64_t c = 0; c < state->reference->surface.cell_count; ++c)
  {
    const int64_t node = state->reference->surface.cell[c];
    const int64_t ijk[3] = { node % lattice->size[0], node / lattice->size[0] % lattice->size[1],
      node / lattice->size[0] / lattice->size[1] };
    for (int axis = 0; axis < 3; ++axis)
    {
      int64_t next[3] = { ijk[0], ijk[1], ijk[2] };
      compare_face(state, ijk, axis);
      next[axis] += 1;
      /* The far face is the near face of the next cell; visited here if that cell will not do it.
       */
      if (next[axis] + 1 < lattice->size[axis] &&
        !oracle_cell_valid(lattice, next[0], next[1], next[2]))
      {
        compare_face(state, next, axis);
      }
    }
  }
}

/* 1 if the two edges (the same one, too) have a cell in common that is not certainly valid. */
static int compare_at_invalid_cell(const oracle_lattice* lattice, int64_t edge, int64_t other)
{
  int64_t a[4][3];
  int64_t b[4][3];
  oracle_edge_cells(lattice, edge, a);
  oracle_edge_cells(lattice, other, b);
  for (int m = 0; m < 4; ++m)
  {
    for (int n = 0; n < 4; ++n)
    {
      if (memcmp(a[m], b[n], sizeof(a[m])) == 0 &&
        !oracle_cell_certain(lattice, a[m][0], a[m][1], a[m][2]))
      {
        return 1;
      }
    }
  }
  return 0;
}

void compare_boundary(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const mesh_report* mesh = state->mesh;
  for (int64_t s = 0; s < mesh->side_count; ++s)
  {
    const mesh_edge* side = &mesh->side[s];
    const mesh_edge* before = s > 0 ? side - 1 : NULL;
    const mesh_edge* after = s + 1 < mesh->side_count ? side + 1 : NULL;
    if ((before && before->a == side->a && before->b == side->b) ||
      (after && after->a == side->a && after->b == side->b))
    {
      continue;
    }
    int64_t a = state->vertex_edge[side->a];
    int64_t b = state->vertex_edge[side->b];
    const int cut_a = a == COMPARE_TRIM_VERTEX;
    const int cut_b = b == COMPARE_TRIM_VERTEX;
    a = cut_a ? b : a;
    b = cut_b ? a : b;
    if (!(cut_a && cut_b) && (a < 0 || b < 0 || !compare_at_invalid_cell(lattice, a, b)))
    {
      ++state->result->holes;
      compare_note(state, "open edge between vertices %d and %d", (int)side->a, (int)side->b);
    }
  }
}

void compare_count_unsettled(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  const int64_t nodes = oracle_node_count(lattice);
  for (int64_t n = 0; n < nodes; ++n)
  {
    state->result->unsettled += (lattice->flags[n] & ORACLE_NODE_CLOSE) &&
      (lattice->flags[n] & (ORACLE_NODE_VALID | ORACLE_NODE_MARGIN));
  }
  for (int64_t c = 0; c < state->reference->surface.cell_count; ++c)
  {
    const int64_t node = state->reference->surface.cell[c];
    state->result->unsettled += !oracle_cell_certain(lattice, node % lattice->size[0],
      node / lattice->size[0] % lattice->size[1], node / lattice->size[0] / lattice->size[1]);
  }
}

void compare_count_pinched(compare_state* state)
{
  for (int64_t e = 0; e < state->reference->surface.edge_count; ++e)
  {
    state->result->pinched_edges +=
      compare_pinched(&state->reference->lattice, state->reference->surface.edge[e]);
  }
}
