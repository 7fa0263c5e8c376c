/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cells, their crossed edges, and how these are joined. */

#include "oracle_graded.h"

#include <stdlib.h>
#include <string.h>

static int graded_above(const oracle_graded* graded, int64_t node)
{
  return graded->nodes.flags[node] & ORACLE_NODE_ABOVE;
}

/* ---- edges ------------------------------------------------------------------------------------ */

/* Of the four quarters around an edge, which ones a cell takes: its middle, but a cell whose face the
 * edge runs across takes two. */
static int graded_quadrants(const graded_cell* cell, const int64_t at[3], int axis)
{
  const int64_t size = (int64_t)1 << cell->level;
  int quadrants = 0;
  for (int q = 0; q < 4; ++q)
  {
    int inside = 1;
    for (int side = 0; side < 2; ++side)
    {
      const int other = (axis + 1 + side) % 3;
      const int64_t offset = at[other] - cell->at[other];
      inside =
        inside && (q >> side & 1 ? offset >= 0 && offset < size : offset > 0 && offset <= size);
    }
    quadrants |= inside << q;
  }
  return quadrants;
}

/* The edge between two nodes of a cell, made where it is new. */
static int64_t graded_edge_between(
  oracle_graded* graded, const graded_cell* cell, int64_t node_a, int64_t node_b)
{
  const int64_t* a = &graded->node_at[3 * node_a];
  const int64_t* b = &graded->node_at[3 * node_b];
  const int axis = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
  const int swapped = a[axis] > b[axis];
  const int64_t* low = swapped ? b : a;
  int64_t* index = graded_map_find(&graded->edge_map, low, axis, 1);
  if (*index < 0)
  {
    graded->edges =
      graded_grow(graded->edges, graded->edge_count, &graded->edge_capacity, sizeof(graded_edge));
    graded_edge* edge = &graded->edges[graded->edge_count];
    memset(edge, 0, sizeof(*edge));
    memcpy(edge->at, low, sizeof(edge->at));
    edge->length = swapped ? a[axis] - b[axis] : b[axis] - a[axis];
    edge->axis = axis;
    edge->node[0] = swapped ? node_b : node_a;
    edge->node[1] = swapped ? node_a : node_b;
    edge->certain = 1;
    *index = graded->edge_count++;
  }
  if (cell->valid)
  {
    graded->edges[*index].quadrants |= graded_quadrants(cell, low, axis);
  }
  return *index;
}

/* ---- faces ------------------------------------------------------------------------------------ */

/* Nodes of a cell around a square of its face: towards -axis or +axis, with the lowest corner at (u,
 * v) and 1 or 2 half-edges wide; counter-clockwise seen from outside. Returns how many. */
static int graded_ring(
  const graded_cell* cell, int axis, int side, const int lowest[2], int width, int64_t ring[8])
{
  static const int walk[8][2] = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 2, 1 }, { 2, 2 }, { 1, 2 },
    { 0, 2 }, { 0, 1 } };
  const int stride[3] = { 1, 3, 9 };
  int count = 0;
  for (int n = 0; n < 8; ++n)
  {
    const int* step = walk[side ? n : 7 - n];
    if (width == 1 && (step[0] == 1 || step[1] == 1))
    {
      continue;
    }
    const int u = lowest[0] + step[0] * width / 2;
    const int v = lowest[1] + step[1] * width / 2;
    const int64_t node =
      cell->node[2 * side * stride[axis] + u * stride[(axis + 1) % 3] + v * stride[(axis + 2) % 3]];
    if (node >= 0)
    {
      ring[count++] = node;
    }
  }
  return count;
}

/* A cell's segments: next[n] follows edge[n] on its loop. */
typedef struct graded_links
{
  int count;
  int64_t edge[48], next[48];
} graded_links;

/* A segment leads from where the walk around a square enters "above" to where it leaves it. */
static void graded_link(oracle_graded* graded, const graded_cell* cell, const int64_t* ring,
  int count, graded_links* links)
{
  for (int n = 0; n < count; ++n)
  {
    const int64_t from = ring[n];
    int last = (n + 1) % count;
    if (graded_above(graded, from) || !graded_above(graded, ring[last]))
    {
      continue;
    }
    links->edge[links->count] = graded_edge_between(graded, cell, from, ring[last]);
    while (graded_above(graded, ring[(last + 1) % count]))
    {
      last = (last + 1) % count;
    }
    links->next[links->count++] =
      graded_edge_between(graded, cell, ring[last], ring[(last + 1) % count]);
  }
}

static void graded_link_cell(oracle_graded* graded, const graded_cell* cell, graded_links* links)
{
  static const int middle[6] = { 12, 14, 10, 16, 4, 22 };
  links->count = 0;
  for (int face = 0; face < 6; ++face)
  {
    const int split = cell->node[middle[face]] >= 0;
    for (int part = 0; part < (split ? 4 : 1); ++part)
    {
      const int lowest[2] = { part & 1, part >> 1 };
      int64_t ring[8];
      const int count = graded_ring(cell, face / 2, face % 2, lowest, split ? 1 : 2, ring);
      graded_link(graded, cell, ring, count, links);
    }
  }
}

static void graded_add_segment(oracle_graded* graded, int64_t from, int64_t to, int certain)
{
  graded->segments = graded_grow(
    graded->segments, graded->segment_count, &graded->segment_capacity, sizeof(graded_segment));
  const graded_segment segment = { from, to, certain };
  graded->segments[graded->segment_count++] = segment;
  graded->edges[from].used = graded->edges[to].used = 1;
}

/* Joins a valid cell's segments to loops; one of two is nothing. */
static void graded_close_loops(oracle_graded* graded, graded_cell* cell, const graded_links* links)
{
  int seen[48] = { 0 };
  for (int first = 0; first < links->count; ++first)
  {
    int loop[48];
    int length = 0;
    for (int n = first; !seen[n];)
    {
      int following = 0;
      seen[n] = 1;
      loop[length++] = n;
      while (links->edge[following] != links->next[n])
      {
        ++following;
      }
      n = following;
    }
    if (length > 2)
    {
      ++cell->loops;
      cell->triangles += length - 2;
      for (int n = 0; n < length; ++n)
      {
        graded_add_segment(graded, links->edge[loop[n]], links->next[loop[n]], cell->certain);
      }
    }
  }
  graded->triangle_count += cell->triangles;
}

/* ---- cells ------------------------------------------------------------------------------------ */

/* Fills in what the nodes say; 0 where the surface does not cross the cell, or cannot. */
static int graded_judge(const oracle_graded* graded, graded_cell* cell)
{
  int above = 0;
  int count = 0;
  int possible = 1;
  cell->valid = cell->certain = 1;
  for (int n = 0; n < 27; ++n)
  {
    if (cell->node[n] >= 0)
    {
      const int flags = graded->nodes.flags[cell->node[n]];
      const int margin = (flags & ORACLE_NODE_MARGIN) != 0;
      const int valid = (flags & ORACLE_NODE_VALID) != 0;
      above += (flags & ORACLE_NODE_ABOVE) != 0;
      ++count;
      cell->valid = cell->valid && valid;
      cell->certain = cell->certain && !margin && !(flags & ORACLE_NODE_CLOSE);
      possible = possible && (valid || margin);
    }
  }
  return above > 0 && above < count && possible;
}

typedef void graded_visit(oracle_graded* graded, graded_cell* cell);

static void graded_visit_cells(oracle_graded* graded, graded_visit* visit)
{
  for (int64_t b = 0; b < graded->brick_count; ++b)
  {
    const graded_brick* brick = &graded->bricks[b];
    for (int c = 0; c < 64; ++c)
    {
      graded_cell cell;
      memset(&cell, 0, sizeof(cell));
      cell.level = brick->level;
      cell.at[0] = brick->at[0] + ((int64_t)(c & 3) << brick->level);
      cell.at[1] = brick->at[1] + ((int64_t)(c >> 2 & 3) << brick->level);
      cell.at[2] = brick->at[2] + ((int64_t)(c >> 4) << brick->level);
      oracle_graded_nodes(graded, brick, cell.at, 0, cell.node);
      visit(graded, &cell);
    }
  }
}

static void graded_march_cell(oracle_graded* graded, graded_cell* cell)
{
  if (!graded_judge(graded, cell))
  {
    return;
  }
  graded_links links;
  graded_link_cell(graded, cell, &links);
  if (cell->valid)
  {
    graded_close_loops(graded, cell, &links);
  }
  graded->cells =
    graded_grow(graded->cells, graded->cell_count, &graded->cell_capacity, sizeof(graded_cell));
  graded->cells[graded->cell_count++] = *cell;
}

/* Where a cell might be another, or not be, its edges are not certain, crossed or not as it is. */
static void graded_doubt_cell(oracle_graded* graded, graded_cell* cell)
{
  graded_judge(graded, cell);
  for (int n = 0; n < 27 && !cell->certain; ++n)
  {
    static const int stride[3] = { 1, 3, 9 };
    for (int axis = 0; axis < 3 && cell->node[n] >= 0; ++axis)
    {
      const int64_t* found =
        graded_map_find(&graded->edge_map, &graded->node_at[3 * cell->node[n]], axis, 0);
      if (found && n / stride[axis] % 3 < 2)
      {
        graded->edges[*found].certain = 0;
      }
    }
  }
}

static int64_t graded_root(graded_edge* edges, int64_t n)
{
  while (edges[n].component != n)
  {
    edges[n].component = edges[edges[n].component].component;
    n = edges[n].component;
  }
  return n;
}

/* Components of edges that segments connect; -1: of no loop. */
static void graded_unite(oracle_graded* graded)
{
  graded_edge* edges = graded->edges;
  for (int64_t e = 0; e < graded->edge_count; ++e)
  {
    edges[e].component = e;
  }
  for (int64_t s = 0; s < graded->segment_count; ++s)
  {
    const int64_t a = graded_root(edges, graded->segments[s].from);
    const int64_t b = graded_root(edges, graded->segments[s].to);
    edges[a > b ? a : b].component = a > b ? b : a;
  }
  for (int64_t e = 0; e < graded->edge_count; ++e)
  {
    const int64_t root = edges[e].component;
    edges[e].component = !edges[e].used ? -1
      : root == e                       ? graded->component_count++
                                        : edges[root].component;
  }
}

void oracle_march_graded(
  oracle_graded* graded, const oracle_field* field, const oracle_limits* limits)
{
  graded_map_free(&graded->edge_map);
  graded->cell_count = graded->edge_count = graded->segment_count = 0;
  graded->component_count = graded->triangle_count = 0;
  oracle_classify(&graded->nodes, field->kind, limits);
  graded_visit_cells(graded, graded_march_cell);
  graded_visit_cells(graded, graded_doubt_cell);
  graded_unite(graded);
}
