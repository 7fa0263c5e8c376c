/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cuts one square of a cap: along the lines between the surface's own vertices (see
 * mcor_cap_make.c), and where the surface is trimmed. In two dimensions, cuts of lattice edges
 * begin at the linear estimate, and then move to where the trim margin is 0. */

#include "mcor_cap_job.h"
#include "mcor_vector.h"

#include <string.h>

/* A cut stays this far from the ends of its line, like the surface's cuts. */
#define MCOR_CAP_CUT_MARGIN 1e-5
#define MCOR_CAP_ROOT 2e-5 /* with a margin below this, a cut counts as exact */

/* ---- Vertices ---- */

void mcor_put_cap_vertex(mcor_cap_vertex* vertex, const double at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    vertex->node[a] = (cl_int)floor(at[a]);
    vertex->offset[a] = at[a] - vertex->node[a];
  }
}

/* Finds the vertex with this key, or makes it. */
static mcor_status mcor_find_cap_vertex(
  mcor_cap_job* job, mcor_table* map, uint64_t key, const double at[3], uint8_t flag, int32_t* v)
{
  mcor_context* context = job->context;
  const int32_t next = (int32_t)(job->context->mesh.vertex_count + job->vertices.count);
  ++job->lookups;
  *v = mcor_table_number(map, key, next);
  MCOR_TRY(mcor_allocated(context, *v >= 0));
  if (*v != next)
  {
    return MCOR_OK;
  }
  MCOR_FAIL_IF(next >= MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(CAP_VERTICES));
  mcor_cap_vertex vertex = { .flag = flag, .key = { job->number, job->lookups } };
  mcor_put_cap_vertex(&vertex, at);
  MCOR_APPEND(context, &job->vertices, vertex);
  return MCOR_OK;
}

/* Finds the node that is (u, v) nodes from the square's lowest node. In two dimensions, nodes that
 * differ only in z are one node. */
static void mcor_square_node(
  const mcor_cap_job* job, const mcor_cap_square* square, int u, int v, cl_int node[3])
{
  memcpy(node, square->node, sizeof square->node);
  node[(square->axis + 1) % 3] += u;
  node[(square->axis + 2) % 3] += v;
  node[2] = job->context->space.flat ? 0 : node[2];
}

/* Makes a corner at the surface's vertex on side k. If the edge is pinched (see mcor_cell_emit),
 * takes the vertex on the side of this square's cell. */
static mcor_status mcor_cap_edge_corner(
  mcor_cap_job* job, const mcor_cap_square* square, int k, mcor_cap_corner* corner)
{
  mcor_context* context = job->context;
  const int axis = (square->axis + 1 + (k & 1)) % 3, other = axis == 0 ? 1 : 0;
  cl_int node[3];
  mcor_square_node(job, square, k == 1, k == 2, node);
  int32_t vertex = mcor_find_number(&job->edges[axis], mcor_cap_key(node));
  MCOR_FAIL_IF(
    vertex < 0, context, MCOR_DEVICE_ERROR, MCOR_SAY(CAP_FAULT), node[0], node[1], node[2]);
  const cl_int* nodes = job->node;
  const bool pinched = vertex + 1 < context->mesh.march_count &&
    memcmp(nodes + 4 * (size_t)vertex, nodes + 4 * ((size_t)vertex + 1), 4 * sizeof *nodes) == 0;
  const int cell = square->node[other] - (other == square->axis && square->upper);
  vertex += pinched && node[other] > cell;
  corner->vertex = vertex;
  corner->margin =
    job->quantity ? mcor_get_real(context, job->quantity, vertex) - job->threshold : INFINITY;
  for (int a = 0; a < 3; ++a)
  {
    corner->at[a] = node[a] + mcor_get_real(context, job->offset, 4 * (int64_t)vertex + a);
  }
  return MCOR_OK;
}

/* Returns the share of the way between the ends at which a linear margin would be 0. */
static double mcor_bracket_share(const mcor_bracket* b)
{
  return b->margin[0] / (b->margin[0] - b->margin[1]);
}

void mcor_begin_cap_line(
  const mcor_cap_corner* low, const mcor_cap_corner* high, mcor_cap_line* line, double at[3])
{
  *line = (mcor_cap_line){ .bracket = { { 0, 1 }, { low->margin, high->margin }, -1 } };
  memcpy(line->from, low->at, sizeof low->at);
  memcpy(line->to, high->at, sizeof high->at);
  line->at =
    fmin(fmax(mcor_bracket_share(&line->bracket), MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
  mcor_point_between(line->from, line->to, line->at, at);
}

/* Finds the vertex where trimming cuts the line between two corners: the surface's cut, else a cut
 * of the cap, with the line along which it will move. */
static mcor_status mcor_cap_cut(
  void* data, const mcor_cap_corner* p, const mcor_cap_corner* q, mcor_cap_corner* cut)
{
  mcor_cap_job* job = data;
  const mcor_mesh* mesh = &job->context->mesh;
  const mcor_cap_corner *low = p->vertex < q->vertex ? p : q, *high = low == p ? q : p;
  const int own = high->vertex < mesh->march_count
    ? mcor_find_cut(job->cut_edges, job->context->mesh.vertex_count - mesh->march_count,
        low->vertex, high->vertex)
    : -1;
  *cut = (mcor_cap_corner){ .margin = 0 };
  if (own >= 0)
  {
    cut->vertex = mesh->march_count + own;
    return MCOR_OK;
  }
  mcor_cap_line line;
  mcor_begin_cap_line(low, high, &line, cut->at);
  const int64_t before = job->vertices.count;
  const uint64_t key = (uint64_t)low->vertex << 32 | (uint64_t)high->vertex;
  MCOR_TRY(mcor_find_cap_vertex(job, &job->cuts, key, cut->at, 2, &cut->vertex));
  if (job->context->space.axes == 3 || job->vertices.count == before)
  {
    return MCOR_OK;
  }
  line.vertex = before;
  MCOR_APPEND(job->context, &job->lines, line);
  return MCOR_OK;
}

/* ---- Polygons ---- */

static mcor_status mcor_add_cap_triangle(mcor_cap_job* job, int32_t a, int32_t b, int32_t c)
{
  MCOR_APPEND(job->context, &job->triangles, (mcor_cap_triangle){ { a, b, c } });
  MCOR_APPEND(job->context, &job->cells, job->number);
  job->owned_count += !(job->number & MCOR_RING_CELL);
  return MCOR_OK;
}

/* Adds a polygon as a fan. Its corners are counter-clockwise, seen from the upper end of the
 * axis. */
static mcor_status mcor_add_cap_fan(
  void* data, const mcor_cap_corner* corners, int count, bool is_cut)
{
  mcor_cap_job* job = data;
  const mcor_cap_square* square = job->square;
  (void)is_cut;
  if (job->context->space.flat)
  {
    /* In two dimensions the cap is a line along the side, with the inside on its left: a triangle
     * whose last two corners are one vertex. Corners that differ only in z are one vertex, too. */
    int other = 1;
    while (other < count - 1 && corners[other].vertex == corners[0].vertex)
    {
      ++other;
    }
    const int along = 1 - square->axis, forward = square->upper == along;
    const bool rises = corners[other].at[along] > corners[0].at[along];
    const int from = rises == forward ? 0 : other, to = other - from;
    return mcor_add_cap_triangle(job, corners[from].vertex, corners[to].vertex, corners[to].vertex);
  }
  for (int i = 1; i + 1 < count; ++i)
  {
    const int next = square->upper ? i : i + 1, last = 2 * i + 1 - next;
    MCOR_TRY(
      mcor_add_cap_triangle(job, corners[0].vertex, corners[next].vertex, corners[last].vertex));
  }
  return MCOR_OK;
}

mcor_status mcor_clip_polygon(const mcor_cap_corner* const corners[], int count, int first,
  mcor_clip_side cut, mcor_add_clipped add, void* data)
{
  mcor_cap_corner run[MCOR_POLYGON_MOST + 2];
  int start = 0, length = 0;
  while (start < count && corners[start]->margin > 0)
  {
    ++start;
  }
  for (int i = 0; i < count && start == count; ++i)
  {
    run[length++] = *corners[(first + i) % count];
  }
  if (start == count)
  {
    return add(data, run, length, false);
  }
  for (int i = 1; i <= count; ++i)
  {
    const mcor_cap_corner *before = corners[(start + i - 1) % count],
                          *corner = corners[(start + i) % count];
    const bool inside = corner->margin > 0;
    if (inside != (before->margin > 0))
    {
      MCOR_TRY(cut(data, before, corner, &run[length++]));
    }
    if (inside)
    {
      run[length++] = *corner;
    }
    else if (length > 0)
    {
      MCOR_TRY(add(data, run, length, true));
      length = 0;
    }
  }
  return MCOR_OK;
}

void mcor_begin_cap_square(mcor_cap_job* job, cl_ulong number, const cl_int node[3], int across)
{
  const mcor_box* box = &job->context->box;
  bool owned = true;
  for (int a = 0; a < job->context->space.axes; ++a)
  {
    owned = owned && (a == across || (node[a] >= box->first[a] && node[a] < box->last[a]));
  }
  job->number = MCOR_CAP_SQUARE | number | (owned ? 0 : MCOR_RING_CELL);
  job->lookups = 0;
}

mcor_status mcor_add_cap_square(mcor_cap_job* job, const mcor_cap_square* square)
{
  const bool* above = square->above;
  const int total = above[0] + above[1] + above[2] + above[3];
  const bool apart = total == 2 && above[0] == above[2] && !square->is_joined;
  mcor_cap_corner corners[6];
  const mcor_cap_corner* polygon[6];
  int count = 0;
  job->square = square;
  for (int k = 0; k < 6; ++k)
  {
    polygon[k] = &corners[k];
  }
  for (int k = 0; k < 4; ++k)
  {
    if (apart && above[k])
    {
      MCOR_TRY(mcor_cap_edge_corner(job, square, (k + 3) % 4, &corners[count++]));
    }
    if (above[k])
    {
      mcor_cap_corner* corner = &corners[count++];
      cl_int node[3];
      mcor_square_node(job, square, mcor_corner_u(k), mcor_corner_v(k), node);
      for (int a = 0; a < 3; ++a)
      {
        corner->at[a] = node[a];
      }
      corner->margin = square->margin[k];
      MCOR_TRY(mcor_find_cap_vertex(
        job, &job->nodes, mcor_cap_key(node), corner->at, MCOR_CAP_FLAG, &corner->vertex));
    }
    if (apart ? above[k] : above[k] != above[(k + 1) % 4])
    {
      MCOR_TRY(mcor_cap_edge_corner(job, square, k, &corners[count++]));
    }
    if (apart ? above[k] : k == 3)
    {
      MCOR_TRY(mcor_clip_polygon(polygon, count, 0, mcor_cap_cut, mcor_add_cap_fan, job));
      count = 0;
    }
  }
  return MCOR_OK;
}

/* ---- Moving cuts ---- */

/* Most steps. They suffice, because every fourth step halves the bracket. */
#define MCOR_PLACE_STEPS 100
/* With a margin below this, a few units of rounding in single precision, a cut stays. */
#define MCOR_PLACE_ROOT 1e-6

/* Moves a cut within its bracket, unless its margin is 0 up to rounding. If an end of the bracket
 * stays twice, its margin is halved, so that it moves, too (the Illinois method). */
static void mcor_move_cut(
  const mcor_context* context, const mcor_cap_points* points, int64_t i, void* data)
{
  mcor_cap_job* job = data;
  mcor_cap_line* line = &job->lines.of[points->to[i]];
  mcor_cap_vertex* vertex = &job->vertices.of[line->vertex];
  const double margin = mcor_cap_margin(context, points, i), before = line->at;
  vertex->flag = fabs(margin) < MCOR_CAP_ROOT ? 1 : 2;
  line->done = fabs(margin) < MCOR_PLACE_ROOT;
  if (line->done)
  {
    return;
  }
  mcor_bracket* bracket = &line->bracket;
  const int moved = (margin > 0) != (bracket->margin[0] > 0);
  bracket->at[moved] = line->at;
  bracket->margin[moved] = margin;
  bracket->margin[1 - moved] *= bracket->last == moved ? 0.5 : 1;
  bracket->last = moved;
  const double share = ++line->moves % 4 == 0 ? 0.5 : mcor_bracket_share(bracket);
  const double s = bracket->at[0] + (bracket->at[1] - bracket->at[0]) * share;
  line->at = fmin(fmax(s, MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
  line->done = line->at == before; /* the cut is at an end, or as exact as numbers allow */
  double at[3];
  mcor_point_between(line->from, line->to, line->at, at);
  mcor_put_cap_vertex(vertex, at);
}

mcor_status mcor_place_cap_cuts(mcor_cap_job* job)
{
  mcor_cap_points* points = &job->points;
  points->take = mcor_move_cut;
  points->data = job;
  int64_t left = job->lines.count;
  for (int step = 0; step < MCOR_PLACE_STEPS && left > 0; ++step)
  {
    left = 0;
    for (int64_t i = 0; i < job->lines.count; ++i)
    {
      const mcor_cap_vertex* vertex = &job->vertices.of[job->lines.of[i].vertex];
      if (!job->lines.of[i].done)
      {
        MCOR_TRY(mcor_add_cap_point(job->context, points, vertex->node, vertex->offset, i));
      }
      left += !job->lines.of[i].done;
    }
    MCOR_TRY(mcor_take_cap_points(job->context, points));
  }
  return MCOR_OK;
}
