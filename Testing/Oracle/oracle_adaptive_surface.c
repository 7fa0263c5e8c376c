/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cells, their crossed edges, and how these are joined. */

#include "oracle_adaptive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int adaptive_above(const oracle_adaptive* adaptive, int64_t node)
{
  return adaptive->nodes.flags[node] & ORACLE_NODE_ABOVE;
}

/* ---- edges ---- */

/* Which of the four quarters around an edge a cell takes: its middle, but a cell whose face the
 * edge runs across takes two. */
static int adaptive_quadrants(const adaptive_cell* cell, const int64_t at[3], int axis)
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
static int64_t adaptive_edge_between(
  oracle_adaptive* adaptive, const adaptive_cell* cell, int64_t node_a, int64_t node_b)
{
  const int64_t* a = &adaptive->node_at[3 * node_a];
  const int64_t* b = &adaptive->node_at[3 * node_b];
  const int axis = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
  const int swapped = a[axis] > b[axis];
  const int64_t* low = swapped ? b : a;
  int64_t* index = adaptive_map_find(&adaptive->edge_map, low, axis, 1);
  if (*index < 0)
  {
    adaptive->edges = adaptive_grow(
      adaptive->edges, adaptive->edge_count, &adaptive->edge_capacity, sizeof(adaptive_edge));
    adaptive_edge* edge = &adaptive->edges[adaptive->edge_count];
    memset(edge, 0, sizeof(*edge));
    memcpy(edge->at, low, sizeof(edge->at));
    edge->length = swapped ? a[axis] - b[axis] : b[axis] - a[axis];
    edge->axis = axis;
    edge->node[0] = swapped ? node_b : node_a;
    edge->node[1] = swapped ? node_a : node_b;
    edge->certain = 1;
    *index = adaptive->edge_count++;
  }
  if (cell->valid)
  {
    adaptive->edges[*index].quadrants |= adaptive_quadrants(cell, low, axis);
  }
  return *index;
}

/* ---- faces ---- */

/* Nodes of a cell around a square of its face: towards -axis or +axis, with the lowest corner at (u,
 * v) and 1 or 2 half-edges wide; counter-clockwise seen from outside. Returns how many. */
static int adaptive_ring(
  const adaptive_cell* cell, int axis, int side, const int lowest[2], int width, int64_t ring[8])
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

int oracle_decide_face(const oracle_decider* decider, const double value[4], const double corner[3],
  const double edge[3], int u, int v)
{
  const double sum = value[0] - value[2] - value[1] + value[3];
  double point[3] = { corner[0], corner[1], corner[2] };
  oracle_sample sample;
  point[u] += edge[u] * (value[0] - value[2]) / sum;
  point[v] += edge[v] * (value[0] - value[1]) / sum;
  oracle_evaluate(decider->field, NULL, point, &sample);
  /* Rounding of the value, and of the node values, which moves the point. */
  const double moved = fmax(edge[u], edge[v]) * decider->limits->close / fabs(sum);
  const double rounding = decider->limits->close +
    oracle_rounding(decider->field, point, decider->unit) +
    moved * (fabs(sample.gradient[u]) + fabs(sample.gradient[v]));
  if (fabs(sample.value - decider->limits->iso) <= rounding ||
    (decider->field->kind == ORACLE_SHEPARD && fabs(sample.weight) < 1e-9))
  {
    return -1;
  }
  return sample.value > decider->limits->iso;
}

/* Decides likewise for a face of a cell; as in the case table, 0, where the field does not
 * decide. */
static int adaptive_joined(oracle_adaptive* adaptive, const adaptive_cell* cell, int face)
{
  static const int stride[3] = { 1, 3, 9 };
  const int axis = face / 2, side = face % 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int64_t size = (int64_t)1 << cell->level;
  int64_t across[3] = { cell->at[0], cell->at[1], cell->at[2] };
  double value[4], corner[3];
  across[axis] += side ? size : -size;
  if (!adaptive->decider || !oracle_adaptive_is_plain(adaptive, cell->level, cell->at) ||
    !oracle_adaptive_is_plain(adaptive, cell->level, across))
  {
    return 0;
  }
  for (int n = 0; n < 4; ++n)
  {
    const int place = 2 * side * stride[axis] + 2 * (n & 1) * stride[u] + 2 * (n >> 1) * stride[v];
    value[n] = adaptive->nodes.value[cell->node[place]];
    for (int a = 0; a < 3 && n == 0; ++a)
    {
      corner[a] = (double)adaptive->node_at[3 * cell->node[place] + a] * adaptive->cube;
    }
  }
  const double cube = (double)size * adaptive->cube, edge[3] = { cube, cube, cube };
  return oracle_decide_face(adaptive->decider, value, corner, edge, u, v);
}

/* A cell's segments: next[n] follows edge[n] on its loop. */
typedef struct adaptive_links
{
  int count;
  int64_t edge[48], next[48];
} adaptive_links;

/* A segment leads from where the walk around a square enters "above" to where it leaves it. */
static void adaptive_link(oracle_adaptive* adaptive, const adaptive_cell* cell, const int64_t* ring,
  int count, adaptive_links* links)
{
  for (int n = 0; n < count; ++n)
  {
    const int64_t from = ring[n];
    int last = (n + 1) % count;
    if (adaptive_above(adaptive, from) || !adaptive_above(adaptive, ring[last]))
    {
      continue;
    }
    links->edge[links->count] = adaptive_edge_between(adaptive, cell, from, ring[last]);
    while (adaptive_above(adaptive, ring[(last + 1) % count]))
    {
      last = (last + 1) % count;
    }
    links->next[links->count++] =
      adaptive_edge_between(adaptive, cell, ring[last], ring[(last + 1) % count]);
  }
}

static int adaptive_ambiguous(const oracle_adaptive* adaptive, const int64_t* ring, int count)
{
  return count == 4 && !adaptive_above(adaptive, ring[0]) == !adaptive_above(adaptive, ring[2]) &&
    !adaptive_above(adaptive, ring[1]) == !adaptive_above(adaptive, ring[3]) &&
    !adaptive_above(adaptive, ring[0]) != !adaptive_above(adaptive, ring[1]);
}

/* Nodes above joined: each of the two below is cut off. */
static void adaptive_link_joined(oracle_adaptive* adaptive, const adaptive_cell* cell,
  const int64_t ring[4], adaptive_links* links)
{
  for (int n = 0; n < 4; ++n)
  {
    if (!adaptive_above(adaptive, ring[n]))
    {
      links->edge[links->count] = adaptive_edge_between(adaptive, cell, ring[n], ring[(n + 1) % 4]);
      links->next[links->count++] =
        adaptive_edge_between(adaptive, cell, ring[n], ring[(n + 3) % 4]);
    }
  }
}

/* On a face that is not split. */
static void adaptive_link_face(oracle_adaptive* adaptive, const adaptive_cell* cell, int face,
  const int64_t* ring, int count, adaptive_links* links)
{
  const int ambiguous = adaptive_ambiguous(adaptive, ring, count);
  const int joined = ambiguous ? adaptive_joined(adaptive, cell, face) : 0;
  if (joined > 0)
  {
    adaptive_link_joined(adaptive, cell, ring, links);
  }
  else
  {
    adaptive_link(adaptive, cell, ring, count, links);
  }
  for (int n = 0; n < 4 && joined < 0; ++n)
  {
    const int64_t edge = adaptive_edge_between(adaptive, cell, ring[n], ring[(n + 1) % 4]);
    adaptive->edges[edge].doubtful = 1;
  }
}

static void adaptive_link_cell(
  oracle_adaptive* adaptive, const adaptive_cell* cell, adaptive_links* links)
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
      const int count = adaptive_ring(cell, face / 2, face % 2, lowest, split ? 1 : 2, ring);
      if (split)
      {
        adaptive_link(adaptive, cell, ring, count, links);
      }
      else
      {
        adaptive_link_face(adaptive, cell, face, ring, count, links);
      }
    }
  }
}

static void adaptive_add_segment(oracle_adaptive* adaptive, int64_t from, int64_t to, int certain)
{
  adaptive->segments = adaptive_grow(adaptive->segments, adaptive->segment_count,
    &adaptive->segment_capacity, sizeof(adaptive_segment));
  const adaptive_segment segment = { from, to, certain };
  adaptive->segments[adaptive->segment_count++] = segment;
  adaptive->edges[from].used = adaptive->edges[to].used = 1;
}

/* Joins a valid cell's segments to loops; one of two is nothing. */
static void adaptive_close_loops(
  oracle_adaptive* adaptive, adaptive_cell* cell, const adaptive_links* links)
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
        adaptive_add_segment(adaptive, links->edge[loop[n]], links->next[loop[n]], cell->certain);
      }
    }
  }
  adaptive->triangle_count += cell->triangles;
}

/* ---- cells ---- */

/* Fills in what the nodes say; 0 where the surface does not cross the cell, or cannot. */
static int adaptive_judge(const oracle_adaptive* adaptive, adaptive_cell* cell)
{
  int above = 0;
  int count = 0;
  int possible = 1;
  cell->valid = cell->certain = 1;
  for (int n = 0; n < 27; ++n)
  {
    if (cell->node[n] >= 0)
    {
      const int flags = adaptive->nodes.flags[cell->node[n]];
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

typedef void adaptive_visit(oracle_adaptive* adaptive, adaptive_cell* cell);

static void adaptive_visit_cells(oracle_adaptive* adaptive, adaptive_visit* visit)
{
  for (int64_t b = 0; b < adaptive->brick_count; ++b)
  {
    const adaptive_brick* brick = &adaptive->bricks[b];
    for (int c = 0; c < 64; ++c)
    {
      adaptive_cell cell;
      memset(&cell, 0, sizeof(cell));
      cell.level = brick->level;
      cell.at[0] = brick->at[0] + ((int64_t)(c & 3) << brick->level);
      cell.at[1] = brick->at[1] + ((int64_t)(c >> 2 & 3) << brick->level);
      cell.at[2] = brick->at[2] + ((int64_t)(c >> 4) << brick->level);
      oracle_adaptive_nodes(adaptive, brick, cell.at, 0, cell.node);
      visit(adaptive, &cell);
    }
  }
}

static void adaptive_march_cell(oracle_adaptive* adaptive, adaptive_cell* cell)
{
  if (!adaptive_judge(adaptive, cell))
  {
    return;
  }
  adaptive_links links;
  adaptive_link_cell(adaptive, cell, &links);
  if (cell->valid)
  {
    adaptive_close_loops(adaptive, cell, &links);
  }
  adaptive->cells = adaptive_grow(
    adaptive->cells, adaptive->cell_count, &adaptive->cell_capacity, sizeof(adaptive_cell));
  adaptive->cells[adaptive->cell_count++] = *cell;
}

/* Where a cell might be another, or not be, its edges are not certain, crossed or not as it is. */
static void adaptive_doubt_cell(oracle_adaptive* adaptive, adaptive_cell* cell)
{
  adaptive_judge(adaptive, cell);
  for (int n = 0; n < 27 && !cell->certain; ++n)
  {
    static const int stride[3] = { 1, 3, 9 };
    for (int axis = 0; axis < 3 && cell->node[n] >= 0; ++axis)
    {
      const int64_t* found =
        adaptive_map_find(&adaptive->edge_map, &adaptive->node_at[3 * cell->node[n]], axis, 0);
      if (found && n / stride[axis] % 3 < 2)
      {
        adaptive->edges[*found].certain = 0;
      }
    }
  }
}

static int64_t adaptive_root(adaptive_edge* edges, int64_t n)
{
  while (edges[n].component != n)
  {
    edges[n].component = edges[edges[n].component].component;
    n = edges[n].component;
  }
  return n;
}

/* Components of edges that segments connect; -1: of no loop. */
static void adaptive_unite(oracle_adaptive* adaptive)
{
  adaptive_edge* edges = adaptive->edges;
  for (int64_t e = 0; e < adaptive->edge_count; ++e)
  {
    edges[e].component = e;
  }
  for (int64_t s = 0; s < adaptive->segment_count; ++s)
  {
    const int64_t a = adaptive_root(edges, adaptive->segments[s].from);
    const int64_t b = adaptive_root(edges, adaptive->segments[s].to);
    edges[a > b ? a : b].component = a > b ? b : a;
  }
  for (int64_t e = 0; e < adaptive->edge_count; ++e)
  {
    const int64_t root = edges[e].component;
    edges[e].component = !edges[e].used ? -1
      : root == e                       ? adaptive->component_count++
                                        : edges[root].component;
  }
}

void oracle_march_adaptive(oracle_adaptive* adaptive, const oracle_field* field,
  const oracle_limits* limits, int by_field, double unit)
{
  const oracle_decider decider = { field, limits, unit };
  adaptive_map_free(&adaptive->edge_map);
  adaptive->cell_count = adaptive->edge_count = adaptive->segment_count = 0;
  adaptive->component_count = adaptive->triangle_count = 0;
  oracle_classify(&adaptive->nodes, field->kind, limits);
  adaptive->decider = by_field ? &decider : NULL;
  adaptive_visit_cells(adaptive, adaptive_march_cell);
  adaptive->decider = NULL;
  adaptive_visit_cells(adaptive, adaptive_doubt_cell);
  adaptive_unite(adaptive);
}
