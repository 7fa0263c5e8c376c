/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds, for the squares of all levels that particles reach, which pieces of their sides are crossed, and how lines
 * join the crossings. */

#include "plane_reference.h"

#include "oracle_lattice.h"

typedef struct plane_node
{
  int above, valid, close; /* close: rounding may decide the side */
} plane_node;

/* A side of a square, or a half of one, between a node above iso and a node below iso. */
typedef struct plane_edge
{
  int64_t at[2], length; /* lower end; in the smallest squares */
  int axis, rising;
  /* valid: a square at the edge is valid. close: rounding may decide a node of such a square. */
  int valid, close;
  int found;
  int64_t next; /* the edge where the line that begins here ends, or -1 */
} plane_edge;

/* The squares that the oracle's lattice has in the plane z = 0: each brick has 4 x 4 squares of the brick's level. */
typedef struct plane_squares
{
  const plane_field* field;
  double iso, cube;
  oracle_lattice lattice;
  plane_node* nodes;
  plane_edge* edges;
  int64_t node_count, node_capacity, edge_count, edge_capacity;
  int64_t ambiguous, doubtful; /* ambiguous squares; squares where rounding may decide */
} plane_squares;

static const plane_node* plane_node_at(plane_squares* s, int64_t x, int64_t y)
{
  const int64_t at[3] = { x, y, 0 };
  int64_t* place = oracle_map_find(&s->lattice.node_map, at, 0, 1);
  if (*place >= 0)
  {
    return s->nodes + *place;
  }
  const mcor_options* o = s->field->options;
  const plane_sample p = plane_evaluate(s->field, (double)x * s->cube, (double)y * s->cube);
  const int lacks = o->field == MCOR_SHEPARD && p.fluid < 1e-3;
  *place = s->node_count;
  s->nodes = oracle_grow(s->nodes, s->node_count + 1, &s->node_capacity, sizeof *s->nodes);
  plane_node* n = s->nodes + s->node_count++;
  n->above = (lacks ? 0 : p.value) >= s->iso;
  n->valid = o->field == MCOR_WEIGHT_SUM || (lacks ? -1 : p.weight) >= o->node_threshold;
  n->close = fabs(p.value - s->iso) < 4e-6 * plane_range(s->field) ||
    (o->field != MCOR_WEIGHT_SUM && fabs(p.weight - o->node_threshold) < 2e-6) ||
    (o->field == MCOR_SHEPARD && fabs(p.fluid - 1e-3) < 1e-6);
  return n;
}

/* Returns the number of the edge between nodes a and b. If it is new, adds it as an edge that is not yet valid. */
static int64_t plane_edge_at(
  plane_squares* s, const int64_t a[2], const int64_t b[2], int a_is_above)
{
  const int axis = a[1] == b[1] ? 0 : 1, forward = b[axis] > a[axis];
  const int64_t* low = forward ? a : b;
  const int64_t at[3] = { low[0], low[1], 0 };
  int64_t* place = oracle_map_find(&s->lattice.edge_map, at, axis, 1);
  if (*place < 0)
  {
    *place = s->edge_count;
    s->edges = oracle_grow(s->edges, s->edge_count + 1, &s->edge_capacity, sizeof *s->edges);
    s->edges[s->edge_count++] = (plane_edge){ .at = { low[0], low[1] },
      .length = llabs(b[axis] - a[axis]),
      .axis = axis,
      .rising = forward != a_is_above,
      .next = -1 };
  }
  return *place;
}

/* Adds a square, unless its centre is outside the field's region. Its nodes are visited counter-clockwise. half: bits
 * of the sides (below, right, above, left) that have a node in their middle. */
static void plane_add_square(plane_squares* s, int64_t x, int64_t y, int64_t size, int half)
{
  static const int corner[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 0, 0 } };
  const double centre[2] = { ((double)x + 0.5 * (double)size) * s->cube,
    ((double)y + 0.5 * (double)size) * s->cube };
  const double* region = s->field->region;
  if (region &&
    (centre[0] < region[0] || centre[0] >= region[1] || centre[1] < region[2] ||
      centre[1] >= region[3]))
  {
    return;
  }
  int64_t at[9][2], edge[8];
  plane_node node[9];
  int count = 0, valid = 1, close = 0;
  for (int side = 0; side < 4; ++side)
  {
    for (int k = 0; k < 1 + (half >> side & 1); ++k, ++count)
    {
      const int* c = corner[side];
      const int* d = corner[side + 1];
      at[count][0] = x + (k ? (c[0] + d[0]) * (size / 2) : c[0] * size);
      at[count][1] = y + (k ? (c[1] + d[1]) * (size / 2) : c[1] * size);
      node[count] = *plane_node_at(s, at[count][0], at[count][1]);
      valid = valid && node[count].valid;
      close = close || node[count].close;
    }
  }
  memcpy(at[count], at[0], sizeof at[0]);
  node[count] = node[0];
  s->doubtful += close;
  s->ambiguous += valid && count == 4 && node[0].above == node[2].above &&
    node[1].above == node[3].above && node[0].above != node[1].above;
  for (int i = 0; i < count; ++i)
  {
    edge[i] =
      node[i].above == node[i + 1].above ? -1 : plane_edge_at(s, at[i], at[i + 1], node[i].above);
    if (edge[i] >= 0)
    {
      s->edges[edge[i]].valid |= valid;
      s->edges[edge[i]].close |= close;
    }
  }
  /* A line cuts off each run of nodes above iso. In the order of the nodes, the line begins at the crossing behind the
   * run, and ends at the crossing before the run. */
  for (int i = 0; i < count && valid; ++i)
  {
    if (edge[i] >= 0 && node[i].above)
    {
      int to = (i + count - 1) % count;
      while (edge[to] < 0)
      {
        to = (to + count - 1) % count;
      }
      s->edges[edge[i]].next = edge[to];
    }
  }
}

static void plane_add_leaf(plane_squares* s, const lattice_brick* leaf)
{
  static const int beside[4][2] = { { 0, -1 }, { 1, 0 }, { 0, 1 }, { -1, 0 } };
  const int64_t size = INT64_C(1) << leaf->level;
  int finer[4];
  for (int side = 0; side < 4; ++side)
  {
    const int64_t at[3] = { leaf->at[0] + 4 * size * beside[side][0],
      leaf->at[1] + 4 * size * beside[side][1], 0 };
    finer[side] = oracle_is_split(&s->lattice, leaf->level, at);
  }
  for (int i = 0; i < 16; ++i)
  {
    const int x = i % 4, y = i / 4;
    const int half = (y == 0 && finer[0]) | (x == 3 && finer[1]) << 1 | (y == 3 && finer[2]) << 2 |
      (x == 0 && finer[3]) << 3;
    plane_add_square(s, leaf->at[0] + x * size, leaf->at[1] + y * size, size, half);
  }
}

static void plane_add_squares(plane_squares* s)
{
  const plane_field* f = s->field;
  const double edge[3] = { s->cube, s->cube, s->cube };
  CORE_SET flat = { 0 };
  for (int64_t i = 0; i < f->set->count; ++i)
  {
    const double x[3] = { plane_u(f, i, 0), plane_u(f, i, 1), 0 };
    particle_set_add(&flat, x, f->set->smoothing_length[i], 0, 0);
  }
  const oracle_field reach = { .particles = &flat,
    .kernel = (oracle_kernel)f->options->sph_kernel,
    .h_scale = f->options->h_scale };
  oracle_create_lattice(&s->lattice, &reach, edge, f->options->level_limit, 0);
  for (int64_t b = 0; b < s->lattice.brick_count; ++b)
  {
    if (s->lattice.bricks[b].at[2] == 0)
    {
      plane_add_leaf(s, &s->lattice.bricks[b]);
    }
  }
}

/* Returns whether the vertex at the edge's crossing is trimmed away: by the trimming limits, or because there is too
 * little fluid for a mean. */
static int plane_is_trimmed(const plane_squares* s, const plane_edge* e)
{
  const mcor_options* o = s->field->options;
  const double least = o->field == MCOR_WEIGHT_SUM ? -1
    : o->field != MCOR_SHEPARD                     ? 0
    : o->sph_kernel == MCOR_M_PRIME_4              ? 0.05
                                                   : 1e-3;
  double low = 0, high = 1;
  plane_sample p = { 0 };
  for (int k = 0; k < 50; ++k)
  {
    const double t = 0.5 * (low + high), along = t * (double)e->length;
    p = plane_evaluate(s->field, ((double)e->at[0] + (e->axis == 0 ? along : 0)) * s->cube,
      ((double)e->at[1] + (e->axis == 1 ? along : 0)) * s->cube);
    const int before = e->rising ? p.value < s->iso : p.value >= s->iso;
    low = before ? t : low;
    high = before ? high : t;
  }
  return p.margin < 1e-4 || (o->field != MCOR_WEIGHT_SUM && p.fluid < least + 1e-5);
}

/* Returns the number of the edge that a point is on, or -1 if it is on none. */
static int64_t plane_edge_of(plane_squares* s, double u, double v)
{
  const double x[2] = { u / s->cube, v / s->cube };
  const double off[2] = { fabs(x[0] - floor(x[0] + 0.5)), fabs(x[1] - floor(x[1] + 0.5)) };
  const int axis = off[0] > off[1] ? 0 : 1;
  CORE_CHECK(off[!axis] < 1e-9, u, v);
  for (int l = 0; l <= s->lattice.top; ++l)
  {
    int64_t at[3] = { 0, 0, 0 };
    at[axis] = (int64_t)floor(ldexp(x[axis], -l)) * (INT64_C(1) << l);
    at[!axis] = (int64_t)floor(x[!axis] + 0.5);
    const int64_t* edge = oracle_map_find(&s->lattice.edge_map, at, axis, 0);
    if (edge && s->edges[*edge].length == INT64_C(1) << l)
    {
      return *edge;
    }
  }
  return -1;
}

/* Checks that lines lead from edge to edge as the squares say; edges at which rounding may decide are left out. With
 * MCOR_TOPOLOGY_FIELD, checks the number of ambiguous squares instead. */
static void plane_compare_lines(
  const plane_squares* s, const int64_t* of, const mcor_surface* surface)
{
  int64_t lines = 0, same = 0;
  for (int64_t l = 0; l < surface->line_count; ++l)
  {
    for (int64_t i = surface->line_offsets[l]; i + 1 < surface->line_offsets[l + 1]; ++i)
    {
      const int64_t from = of[surface->line_points[i]], to = of[surface->line_points[i + 1]];
      if (from >= 0 && to >= 0 && !s->edges[from].close && !s->edges[to].close)
      {
        ++lines;
        same += s->edges[from].next == to;
      }
    }
  }
  const int by_field = s->field->options->topology == MCOR_TOPOLOGY_FIELD;
  CORE_CHECK(lines == same || by_field, same, lines);
  CORE_CHECK(!by_field || s->lattice.top > 0 || s->doubtful > 0 || s->field->region ||
      surface->statistics.ambiguous_faces == s->ambiguous,
    s->ambiguous, surface->statistics.ambiguous_faces);
}

int64_t plane_compare(const plane_field* field, double iso, const mcor_surface* surface)
{
  plane_squares s = { .field = field, .iso = iso, .cube = surface->statistics.cube_size };
  const double range = plane_range(field);
  int64_t crossed = 0, found = 0;
  CORE_FREED int64_t* of = oracle_allocate((surface->point_count + 1), sizeof *of);
  plane_add_squares(&s);
  assert_int_equal(surface->statistics.highest_level, s.lattice.top);
  for (int64_t p = 0; p < surface->point_count; ++p)
  {
    const double u = surface->points[3 * p + (field->axis + 1) % 3];
    const double v = surface->points[3 * p + (field->axis + 2) % 3];
    const plane_sample at = plane_evaluate(field, u, v);
    const int cut = surface->boundary_flag[p] & 3;
    CORE_CHECK(cut == 2 || fabs(at.value - iso) < 1e-5 * range, p, at.value - iso);
    CORE_CHECK(cut != 1 || at.fluid < 0.06 || fabs(at.margin) < 1e-4, p, at.margin);
    CORE_CHECK(cut || at.margin > -1e-4, p, at.margin);
    of[p] = cut ? -1 : plane_edge_of(&s, u, v);
    if (!cut)
    {
      plane_edge* e = of[p] >= 0 ? s.edges + of[p] : NULL;
      CORE_CHECK(e && (e->valid || e->close), p);
      CORE_CHECK(!e->found, of[p]);
      e->found = 1;
    }
  }
  for (int64_t i = 0; i < s.edge_count; ++i)
  {
    plane_edge* e = s.edges + i;
    if (e->valid && !e->close && !plane_is_trimmed(&s, e))
    {
      ++crossed;
      found += e->found;
    }
  }
  CORE_CHECK(found == crossed, crossed, found);
  plane_compare_lines(&s, of, surface);
  oracle_free_lattice(&s.lattice);
  free(s.nodes);
  free(s.edges);
  return crossed;
}
