/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds cells, their crossed edges, and how faces join the crossings. */

#include "oracle_lattice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int lattice_above(const oracle_lattice* lattice, int64_t node)
{
  return lattice->nodes[node].flags & LATTICE_ABOVE;
}

/* ---- edges ---- */

/* Returns which of the four quarters around an edge a cell fills, as bits: one quarter, or two if the edge lies within
 * a face of the cell. */
static int lattice_quadrants(const lattice_cell* cell, const int64_t at[3], int axis)
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

/* Returns the edge between two nodes of a cell, and creates it if it is new. */
static int64_t lattice_edge_between(
  oracle_lattice* lattice, const lattice_cell* cell, int64_t node_a, int64_t node_b)
{
  const int64_t* a = lattice->nodes[node_a].at;
  const int64_t* b = lattice->nodes[node_b].at;
  const int axis = a[0] != b[0] ? 0 : a[1] != b[1] ? 1 : 2;
  const int swapped = a[axis] > b[axis];
  const int64_t* low = swapped ? b : a;
  int64_t* index = oracle_map_find(&lattice->edge_map, low, axis, 1);
  if (*index < 0)
  {
    lattice->edges = oracle_grow(
      lattice->edges, lattice->edge_count, &lattice->edge_capacity, sizeof(lattice_edge));
    lattice_edge* edge = &lattice->edges[lattice->edge_count];
    memset(edge, 0, sizeof(*edge));
    memcpy(edge->at, low, sizeof(edge->at));
    edge->length = swapped ? a[axis] - b[axis] : b[axis] - a[axis];
    edge->axis = axis;
    edge->node[0] = swapped ? node_b : node_a;
    edge->node[1] = swapped ? node_a : node_b;
    edge->certain = 1;
    edge->component = -1;
    *index = lattice->edge_count++;
  }
  if (cell->valid)
  {
    lattice->edges[*index].quadrants |= lattice_quadrants(cell, low, axis);
  }
  return *index;
}

/* ---- faces ---- */

/* Lists the nodes around a square of a cell's face, counter-clockwise seen from outside. The face is towards -axis
 * (side 0) or +axis (side 1). The square's lowest corner is at (u, v) = lowest, and its width is 1 or 2 half-edges.
 * Returns how many nodes there are. */
static int lattice_ring(
  const lattice_cell* cell, int axis, int side, const int lowest[2], int width, int64_t ring[8])
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

/* Returns whether the nodes above iso are joined on a face: 0 or 1, or -1 if rounding decides. value: at the face's
 * corners (0, 0), (1, 0), (0, 1), (1, 1) of u and v; corner: the place of corner (0, 0). */
static int lattice_decide_face(const oracle_decider* decider, const double value[4],
  const double corner[3], const double edge[3], int u, int v)
{
  const double sum = value[0] - value[2] - value[1] + value[3];
  double point[3] = { corner[0], corner[1], corner[2] };
  oracle_sample sample;
  point[u] += edge[u] * (value[0] - value[2]) / sum;
  point[v] += edge[v] * (value[0] - value[1]) / sum;
  oracle_evaluate(decider->field, NULL, point, &sample);
  /* The value has its own rounding error, and rounding of the nodes' values moves the saddle point. */
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

/* Returns what lattice_decide_face returns for a face of a cell. If the field does not decide the face, returns 0, as
 * the case table has it. */
static int lattice_joined(oracle_lattice* lattice, const lattice_cell* cell, int face)
{
  static const int stride[3] = { 1, 3, 9 };
  const int axis = face / 2, side = face % 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int64_t size = (int64_t)1 << cell->level;
  int64_t across[3] = { cell->at[0], cell->at[1], cell->at[2] };
  double value[4], corner[3];
  across[axis] += side ? size : -size;
  if (!lattice->decider || !oracle_is_plain(lattice, cell->level, cell->at) ||
    !oracle_is_plain(lattice, cell->level, across))
  {
    return 0;
  }
  for (int n = 0; n < 4; ++n)
  {
    const int place = 2 * side * stride[axis] + 2 * (n & 1) * stride[u] + 2 * (n >> 1) * stride[v];
    const lattice_node* node = &lattice->nodes[cell->node[place]];
    value[n] = node->value;
    if (n == 0)
    {
      oracle_place(lattice, node->at, corner);
    }
  }
  const double edge[3] = { (double)size * lattice->edge[0], (double)size * lattice->edge[1],
    (double)size * lattice->edge[2] };
  return lattice_decide_face(lattice->decider, value, corner, edge, u, v);
}

/* The segments of a cell: segment n leads from the crossed edge edge[n] to the crossed edge next[n]. */
typedef struct lattice_links
{
  int count;
  int64_t edge[48], next[48];
} lattice_links;

/* Links the crossings around a square, whose nodes are visited in order. A segment leads from the crossing before a run
 * of nodes above iso to the crossing behind this run. If the two nodes above iso are joined, each segment cuts off one
 * of the two nodes below instead. */
static void lattice_link(oracle_lattice* lattice, const lattice_cell* cell, const int64_t* ring,
  int count, int joined, lattice_links* links)
{
  for (int n = 0; n < count; ++n)
  {
    const int64_t from = ring[n];
    int last = (n + 1) % count;
    if (lattice_above(lattice, from) || !lattice_above(lattice, ring[last]))
    {
      continue;
    }
    links->edge[links->count] = lattice_edge_between(lattice, cell, from, ring[last]);
    while (!joined && lattice_above(lattice, ring[(last + 1) % count]))
    {
      last = (last + 1) % count;
    }
    links->next[links->count++] = joined
      ? lattice_edge_between(lattice, cell, from, ring[(n + count - 1) % count])
      : lattice_edge_between(lattice, cell, ring[last], ring[(last + 1) % count]);
  }
}

static int lattice_ambiguous(const oracle_lattice* lattice, const int64_t* ring, int count)
{
  return count == 4 && !lattice_above(lattice, ring[0]) == !lattice_above(lattice, ring[2]) &&
    !lattice_above(lattice, ring[1]) == !lattice_above(lattice, ring[3]) &&
    !lattice_above(lattice, ring[0]) != !lattice_above(lattice, ring[1]);
}

/* Adds each pair of a square's crossed edges to `pairs`, which counts the valid cells that have the pair. */
static void lattice_add_pairs(oracle_lattice* lattice, oracle_map* pairs, const lattice_cell* cell,
  const int64_t* ring, int count)
{
  int64_t edge[8];
  int edges = 0;
  for (int n = 0; n < count; ++n)
  {
    if (!lattice_above(lattice, ring[n]) != !lattice_above(lattice, ring[(n + 1) % count]))
    {
      edge[edges++] = lattice_edge_between(lattice, cell, ring[n], ring[(n + 1) % count]);
    }
  }
  for (int n = 0; n < edges * edges; ++n)
  {
    const int64_t pair[3] = { edge[n % edges], edge[n / edges], 0 };
    if (pair[0] < pair[1])
    {
      int64_t* cells = oracle_map_find(pairs, pair, 0, 1);
      *cells = (*cells > 0 ? *cells : 0) + cell->valid;
    }
  }
}

/* Links the crossings on a face, or on a quarter of a split face. */
static void lattice_link_square(oracle_lattice* lattice, const lattice_cell* cell, int face,
  int split, const int64_t* ring, int count, lattice_links* links)
{
  const int ambiguous = !split && lattice_ambiguous(lattice, ring, count);
  const int joined = ambiguous ? lattice_joined(lattice, cell, face) : 0;
  int doubtful = joined < 0;
  for (int n = 0; n < count; ++n)
  {
    doubtful = doubtful || (lattice->nodes[ring[n]].flags & LATTICE_CLOSE) != 0;
  }
  lattice_link(lattice, cell, ring, count, joined > 0, links);
  if (!cell->certain || doubtful)
  {
    lattice_add_pairs(
      lattice, cell->certain ? &lattice->either : &lattice->doubts, cell, ring, count);
  }
}

static void lattice_link_cell(
  oracle_lattice* lattice, const lattice_cell* cell, lattice_links* links)
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
      const int count = lattice_ring(cell, face / 2, face % 2, lowest, split ? 1 : 2, ring);
      lattice_link_square(lattice, cell, face, split, ring, count, links);
    }
  }
}

/* Adds a segment. It belongs to the cell that will be added next. */
static void lattice_add_segment(oracle_lattice* lattice, int64_t from, int64_t to, int certain)
{
  lattice->segments = oracle_grow(
    lattice->segments, lattice->segment_count, &lattice->segment_capacity, sizeof(lattice_segment));
  const lattice_segment segment = { from, to, lattice->cell_count };
  lattice->segments[lattice->segment_count++] = segment;
  lattice->edges[from].used = 1;
  lattice->edges[from].sure |= certain;
}

/* Joins the segments of a valid cell to loops. A loop of two segments is dropped. */
static void lattice_close_loops(
  oracle_lattice* lattice, lattice_cell* cell, const lattice_links* links)
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
        lattice_add_segment(lattice, links->edge[loop[n]], links->next[loop[n]], cell->certain);
      }
    }
  }
  lattice->triangle_count += cell->triangles;
}

/* ---- cells ---- */

/* Fills in the cell's flags from its nodes. Returns 0 if the surface cannot cross the cell. */
static int lattice_classify_cell(const oracle_lattice* lattice, lattice_cell* cell)
{
  int above = 0;
  int close = 0;
  int count = 0;
  int possible = 1;
  cell->valid = cell->certain = 1;
  for (int n = 0; n < 27; ++n)
  {
    if (cell->node[n] >= 0)
    {
      const int flags = lattice->nodes[cell->node[n]].flags;
      const int margin = (flags & LATTICE_MARGIN) != 0;
      const int valid = (flags & LATTICE_VALID) != 0;
      above += (flags & LATTICE_ABOVE) != 0;
      close += (flags & LATTICE_CLOSE) != 0;
      ++count;
      cell->valid = cell->valid && valid;
      cell->certain = cell->certain && !margin;
      possible = possible && (valid || margin);
    }
  }
  /* A cell with more than 8 nodes may lose a loop if one node changes its side, because a loop of two edges is dropped.
   * So it is certain only if no node is within rounding of iso. */
  cell->certain = cell->certain && (count == 8 || close == 0);
  return above > 0 && above < count && possible;
}

typedef void lattice_visit(oracle_lattice* lattice, lattice_cell* cell);

static void lattice_visit_cells(oracle_lattice* lattice, lattice_visit* visit)
{
  for (int64_t b = 0; b < lattice->brick_count; ++b)
  {
    for (int c = 0; c < 64; ++c)
    {
      lattice_cell cell;
      int there = 1;
      oracle_cell_at(lattice, b, c, 0, &cell);
      for (int axis = 0; axis < 3; ++axis)
      {
        there =
          there && cell.at[axis] >= lattice->first[axis] && cell.at[axis] < lattice->end[axis];
      }
      if (there)
      {
        visit(lattice, &cell);
      }
    }
  }
}

static void lattice_march_cell(oracle_lattice* lattice, lattice_cell* cell)
{
  if (!lattice_classify_cell(lattice, cell))
  {
    return;
  }
  lattice_links links;
  lattice_link_cell(lattice, cell, &links);
  if (cell->valid)
  {
    lattice_close_loops(lattice, cell, &links);
  }
  lattice->cells =
    oracle_grow(lattice->cells, lattice->cell_count, &lattice->cell_capacity, sizeof(lattice_cell));
  lattice->cells[lattice->cell_count++] = *cell;
}

/* Marks the edges of a cell as uncertain if rounding may decide whether the cell is used. */
static void lattice_doubt_edges(oracle_lattice* lattice, lattice_cell* cell)
{
  lattice_classify_cell(lattice, cell);
  for (int n = 0; n < 27 && !cell->certain; ++n)
  {
    static const int stride[3] = { 1, 3, 9 };
    for (int axis = 0; axis < 3 && cell->node[n] >= 0; ++axis)
    {
      const int64_t* found =
        oracle_map_find(&lattice->edge_map, lattice->nodes[cell->node[n]].at, axis, 0);
      if (found && n / stride[axis] % 3 < 2)
      {
        lattice->edges[*found].certain = 0;
      }
    }
  }
}

static int64_t lattice_root(lattice_cell* cells, int64_t n)
{
  while (cells[n].component != n)
  {
    cells[n].component = cells[cells[n].component].component;
    n = cells[n].component;
  }
  return n;
}

/* Numbers the components: sets of cells that are connected by common segments. Gives each edge the component of one of
 * its cells. */
static void lattice_unite(oracle_lattice* lattice)
{
  oracle_map seen = { NULL, 0, 0 };
  lattice_cell* cells = lattice->cells;
  for (int64_t c = 0; c < lattice->cell_count; ++c)
  {
    cells[c].component = c;
  }
  for (int64_t s = 0; s < lattice->segment_count; ++s)
  {
    const lattice_segment* segment = &lattice->segments[s];
    const int up = segment->from < segment->to;
    const int64_t pair[3] = { up ? segment->from : segment->to, up ? segment->to : segment->from,
      0 };
    int64_t* other = oracle_map_find(&seen, pair, 0, 1);
    *other = *other < 0 ? segment->cell : *other;
    const int64_t a = lattice_root(cells, segment->cell);
    const int64_t b = lattice_root(cells, *other);
    cells[a > b ? a : b].component = a > b ? b : a;
  }
  /* A root is the lowest cell of its component, so one ascending pass numbers the components. */
  for (int64_t c = 0; c < lattice->cell_count; ++c)
  {
    const int64_t root = cells[c].component;
    cells[c].component = root != c ? cells[root].component
      : cells[c].loops > 0         ? lattice->component_count++
                                   : -1;
  }
  for (int64_t s = 0; s < lattice->segment_count; ++s)
  {
    lattice->edges[lattice->segments[s].from].component =
      cells[lattice->segments[s].cell].component;
  }
  oracle_map_free(&seen);
}

void oracle_march(oracle_lattice* lattice, const oracle_field* field, const oracle_limits* limits,
  int by_field, double unit)
{
  const oracle_decider decider = { field, limits, unit };
  oracle_map_free(&lattice->edge_map);
  oracle_map_free(&lattice->doubts);
  oracle_map_free(&lattice->either);
  lattice->cell_count = lattice->edge_count = lattice->segment_count = 0;
  lattice->component_count = lattice->triangle_count = 0;
  const int of_weight = field->kind == ORACLE_WEIGHT, of_mean = field->kind == ORACLE_SHEPARD;
  for (int64_t n = 0; n < lattice->node_count; ++n)
  {
    lattice_node* node = &lattice->nodes[n];
    const double difference = node->value - limits->iso;
    const int valid = of_weight ||
      (node->trim_weight >= limits->node_threshold &&
        (!of_mean || node->weight >= limits->least_weight));
    const int margin = !of_weight &&
      (fabs(node->trim_weight - limits->node_threshold) <= limits->margin ||
        (of_mean && fabs(node->weight - limits->least_weight) <= limits->margin));
    node->flags = (difference >= 0.0 ? LATTICE_ABOVE : 0) | (valid ? LATTICE_VALID : 0) |
      (fabs(difference) <= limits->close ? LATTICE_CLOSE : 0) | (margin ? LATTICE_MARGIN : 0);
  }
  lattice->decider = by_field ? &decider : NULL;
  lattice_visit_cells(lattice, lattice_march_cell);
  lattice->decider = NULL;
  lattice_visit_cells(lattice, lattice_doubt_edges);
  lattice_unite(lattice);
}
