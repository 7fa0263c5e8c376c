/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_compare_internal.h"

#include <math.h>
#include <string.h>

/* ---- orientation ---- */

/* Corner of a cell (0..7) at the lower or upper end of an edge; -1 if it is none of the cell's. */
static int compare_corner(
  const oracle_lattice* lattice, const int64_t ijk[3], int64_t edge, int upper)
{
  int64_t nodes[2];
  oracle_edge_ends(lattice, edge, nodes);
  for (int c = 0; c < 8; ++c)
  {
    if (oracle_node_index(lattice, ijk[0] + (c & 1), ijk[1] + (c >> 1 & 1), ijk[2] + (c >> 2)) ==
      nodes[upper])
    {
      return c;
    }
  }
  return -1;
}

/* On a face that both edges belong to and that has no other crossing, seen from outside the cell,
 * the surface goes from where a counter-clockwise walk enters "above" to where it leaves it. 1: the
 * side from one edge to the other goes that way, -1: the other way, 0: there is no such face. */
static int compare_side_direction(
  const oracle_lattice* lattice, const int64_t ijk[3], int64_t from, int64_t to)
{
  const int corner[4] = { compare_corner(lattice, ijk, from, 0),
    compare_corner(lattice, ijk, from, 1), compare_corner(lattice, ijk, to, 0),
    compare_corner(lattice, ijk, to, 1) };
  for (int face = 0; face < 6; ++face)
  {
    const int axis = face / 2;
    const int side = face % 2;
    const int u = 1 << (axis + 1) % 3;
    const int v = 1 << (axis + 2) % 3;
    /* Counter-clockwise seen from outside. */
    const int walk[4] = { side << axis, side << axis | (side ? u : v), side << axis | u | v,
      side << axis | (side ? v : u) };
    int above[4];
    int crossings = 0;
    int inside = 1;
    for (int n = 0; n < 4; ++n)
    {
      inside = inside && corner[n] >= 0 && (corner[n] >> axis & 1) == side;
      above[n] = lattice->flags[oracle_node_index(lattice, ijk[0] + (walk[n] & 1),
                   ijk[1] + (walk[n] >> 1 & 1), ijk[2] + (walk[n] >> 2))] &
        ORACLE_NODE_ABOVE;
    }
    for (int n = 0; n < 4; ++n)
    {
      crossings += above[n] != above[(n + 1) % 4];
    }
    for (int n = 0; inside && crossings == 2 && n < 4; ++n)
    {
      const int next = walk[(n + 1) % 4];
      if ((walk[n] == corner[0] && next == corner[1]) ||
        (walk[n] == corner[1] && next == corner[0]))
      {
        return !above[n] && above[(n + 1) % 4] ? 1 : -1;
      }
    }
  }
  return 0;
}

/* The one cell that has all three edges; 0 if there is none, or more than one. */
static int compare_common_cell(
  const oracle_lattice* lattice, const int64_t edges[3], int64_t ijk[3])
{
  int64_t cells[4][3];
  int found = 0;
  oracle_edge_cells(lattice, edges[0], cells);
  for (int c = 0; c < 4; ++c)
  {
    if (oracle_cell_valid(lattice, cells[c][0], cells[c][1], cells[c][2]) &&
      compare_corner(lattice, cells[c], edges[1], 0) >= 0 &&
      compare_corner(lattice, cells[c], edges[1], 1) >= 0 &&
      compare_corner(lattice, cells[c], edges[2], 0) >= 0 &&
      compare_corner(lattice, cells[c], edges[2], 1) >= 0)
    {
      memcpy(ijk, cells[c], sizeof(cells[c]));
      ++found;
    }
  }
  return found == 1;
}

/* Exact, by the signs of the nodes, for all triangles that trimming left whole. */
void compare_inverted(compare_state* state)
{
  const oracle_lattice* lattice = &state->reference->lattice;
  for (int64_t t = 0; t < state->surface->triangle_count; ++t)
  {
    int64_t edges[3];
    int64_t ijk[3];
    int inverted = 0;
    int close = 0;
    for (int c = 0; c < 3; ++c)
    {
      edges[c] = state->vertex_edge[state->surface->triangles[3 * t + c]];
      close = close || edges[c] < 0 || compare_end_flag(lattice, edges[c], ORACLE_NODE_CLOSE);
    }
    if (close || !compare_common_cell(lattice, edges, ijk))
    {
      continue;
    }
    for (int c = 0; c < 3; ++c)
    {
      inverted = inverted || compare_side_direction(lattice, ijk, edges[c], edges[(c + 1) % 3]) < 0;
    }
    state->result->inverted_triangles += inverted;
    if (inverted)
    {
      compare_note(state, "triangle %lld is inside out", (long long)t);
    }
  }
}

/* ---- faces ---- */

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

/* Triangles with a side between the vertices of two crossed edges. */
static int64_t compare_count_sides(const compare_state* state, int64_t e0, int64_t e1)
{
  const int64_t a[2] = { state->edge_vertex[e0], state->second_vertex[e0] };
  const int64_t b[2] = { state->edge_vertex[e1], state->second_vertex[e1] };
  int64_t count = 0;
  for (int n = 0; n < 4; ++n)
  {
    if (a[n & 1] >= 0 && b[n >> 1] >= 0)
    {
      count += mesh_count_sides(state->mesh, (int32_t)a[n & 1], (int32_t)b[n >> 1]);
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

/* Two crossings: connected, once for each valid cell at the face. Four: in one of two ways. */
static int compare_face_connected(const compare_state* state, const int64_t crossings[4], int count,
  int64_t cells, int64_t node, int axis)
{
  if (count == 2)
  {
    return compare_count_sides(state, crossings[0], crossings[1]) == cells;
  }
  const int joined = compare_face_joined(state, node, axis);
  const int lowest_above = (state->reference->lattice.flags[node] & ORACLE_NODE_ABOVE) != 0;
  for (int way = 0; way < 2; ++way)
  {
    /* Way 1 goes around the lowest node. */
    if ((joined < 0 || way == (joined != lowest_above)) &&
      compare_count_sides(state, crossings[way], crossings[way + 1]) == cells &&
      compare_count_sides(state, crossings[way + 2], crossings[(way + 3) % 4]) == cells)
    {
      return 1;
    }
  }
  return 0;
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
  const int valid = oracle_cell_valid(lattice, ijk[0], ijk[1], ijk[2]) +
    oracle_cell_valid(lattice, other[0], other[1], other[2]);
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
  if (valid > 0 && possible == certain && count >= 2 &&
    !compare_face_connected(
      state, crossings, count, valid, oracle_node_index(lattice, ijk[0], ijk[1], ijk[2]), axis))
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
