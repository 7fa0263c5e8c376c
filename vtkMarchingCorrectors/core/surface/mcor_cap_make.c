/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps close the surface at the sides of a period or box, around the region above the iso value.
 * Marching Cubes cuts each square of a side along lines between vertices of the surface. The cap
 * has the same lines and vertices; its other vertices are nodes. The cap of a trimmed surface is
 * trimmed, too: at the surface's cut vertices, and linearly within the side. A square is capped if
 * the cell beside it is valid. In two dimensions, cuts of lattice edges begin at the linear
 * estimate, and then move to where the trim margin is 0.
 *
 * The vertices of caps follow all other vertices of the mesh. They are numbered in the order in
 * which squares use them: by axis, by lower and upper side, then square by square. A call with a
 * box caps the squares of its own cells and of the ring around them, so that vertices have the same
 * keys and order as in the whole surface. */

#include "mcor_cap.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* A cut stays this far, as a share of its line, from the line's ends, like the surface's cuts. */
#define MCOR_CAP_CUT_MARGIN 1e-5
#define MCOR_CAP_ROOT 2e-5 /* with a margin below this, a cut counts as exact */

/* ---- Vertices ---- */

/* Splits a position, in cubes, into a node and an offset. */
static void mcor_put_cap_vertex(mcor_cap_vertex* vertex, const double at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    vertex->node[a] = (cl_int)floor(at[a]);
    vertex->offset[a] = at[a] - vertex->node[a];
  }
}

/* Finds the index of the vertex with this key. If there is none, makes the vertex at the place
 * `at`, in cubes. */
static mcor_status mcor_find_cap_vertex(mcor_cap_job* job, mcor_table* map, uint64_t key,
  const double at[3], mcor_cap_vertex vertex, int32_t* index)
{
  const int32_t next = (int32_t)job->vertices.count;
  *index = mcor_table_number(map, key, next);
  MCOR_TRY(mcor_allocated(job->context, *index >= 0));
  if (*index == next)
  {
    mcor_put_cap_vertex(&vertex, at);
    MCOR_APPEND(job->context, &job->vertices, vertex);
  }
  return MCOR_OK;
}

/* Returns the place on a line where a cut is tried next. If `halves` is set, it is the middle of
 * the bracket. Else it is where the margin would be 0 if it were linear in the bracket. */
static double mcor_cut_place(const mcor_cap_line* line, bool halves)
{
  const double* margin = line->margin;
  const double share = halves ? 0.5 : margin[0] / (margin[0] - margin[1]);
  const double at = line->end[0] + (line->end[1] - line->end[0]) * share;
  return fmin(fmax(at, MCOR_CAP_CUT_MARGIN), 1 - MCOR_CAP_CUT_MARGIN);
}

mcor_status mcor_find_cap_cut(mcor_cap_job* job, uint64_t key, const mcor_cap_corner* low,
  const mcor_cap_corner* high, mcor_cap_vertex vertex, mcor_cap_corner* cut)
{
  mcor_cap_line line = { .vertex = (int32_t)job->vertices.count,
    .end = { 0, 1 },
    .margin = { low->margin, high->margin },
    .last = -1 };
  memcpy(line.from, low->at, sizeof low->at);
  memcpy(line.to, high->at, sizeof high->at);
  line.at = mcor_cut_place(&line, false);
  *cut = (mcor_cap_corner){ .margin = 0 };
  mcor_point_between(line.from, line.to, line.at, cut->at);
  MCOR_TRY(mcor_find_cap_vertex(job, &job->cuts, key, cut->at, vertex, &cut->vertex));
  if (cut->vertex == line.vertex && job->context->space.axes == 2)
  {
    MCOR_APPEND(job->context, &job->lines, line);
  }
  return MCOR_OK;
}

/* ---- Corners of a square ---- */

/* Returns a vertex with the next key of the square that is being cut. */
static mcor_cap_vertex mcor_next_cap_vertex(mcor_cap_job* job, uint8_t flag)
{
  return (mcor_cap_vertex){ .flag = flag, .key = { job->number, ++job->lookups } };
}

/* Finds the node that is (u, v) nodes from the square's lowest node. In two dimensions, nodes that
 * differ only in z are one node. */
static void mcor_square_node(const mcor_cap_job* job, int u, int v, cl_int node[3])
{
  memcpy(node, job->lowest, sizeof job->lowest);
  node[job->side->across[0]] += u;
  node[job->side->across[1]] += v;
  node[2] = job->context->space.flat ? 0 : node[2];
}

/* Makes a corner at the square's node k. */
static mcor_status mcor_cap_node_corner(
  mcor_cap_job* job, int k, double margin, mcor_cap_corner* corner)
{
  cl_int node[3];
  mcor_square_node(job, mcor_corner_u(k), mcor_corner_v(k), node);
  *corner = (mcor_cap_corner){ .at = { node[0], node[1], node[2] }, .margin = margin };
  MCOR_TRY(mcor_find_cap_vertex(job, &job->nodes, mcor_cap_key(node), corner->at,
    mcor_next_cap_vertex(job, MCOR_CAP_FLAG), &corner->vertex));
  corner->vertex += job->context->mesh.vertex_count;
  return MCOR_OK;
}

/* Makes a corner at the surface's vertex on side k. If the edge has two vertices (it is pinched,
 * see mcor_cell_emit), takes the vertex of this square's cell. */
static mcor_status mcor_cap_edge_corner(mcor_cap_job* job, int k, mcor_cap_corner* corner)
{
  mcor_context* context = job->context;
  const int axis = job->side->across[k & 1], other = axis == 0 ? 1 : 0;
  cl_int node[3];
  mcor_square_node(job, k == 1, k == 2, node);
  int32_t vertex = mcor_find_number(&job->edges[axis], mcor_cap_key(node));
  MCOR_FAIL_IF(
    vertex < 0, context, MCOR_DEVICE_ERROR, MCOR_SAY(CAP_FAULT), node[0], node[1], node[2]);
  const cl_int* nodes = job->node;
  const bool pinched = vertex + 1 < context->mesh.march_count &&
    memcmp(nodes + 4 * (size_t)vertex, nodes + 4 * ((size_t)vertex + 1), 4 * sizeof *nodes) == 0;
  const int cell = job->lowest[other] - (other == job->side->axis && job->side->upper);
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

/* Finds the vertex where trimming cuts the line between two corners: the surface's cut vertex if
 * there is one, else a cut vertex of the cap. */
static mcor_status mcor_cap_cut(
  void* data, const mcor_cap_corner* p, const mcor_cap_corner* q, mcor_cap_corner* cut)
{
  mcor_cap_job* job = data;
  const mcor_mesh* mesh = &job->context->mesh;
  const mcor_cap_corner *low = p->vertex < q->vertex ? p : q, *high = low == p ? q : p;
  const int own = high->vertex < mesh->march_count
    ? mcor_find_cut(
        job->cut_edges, mesh->vertex_count - mesh->march_count, low->vertex, high->vertex)
    : -1;
  if (own >= 0)
  {
    *cut = (mcor_cap_corner){ .vertex = mesh->march_count + own };
    return MCOR_OK;
  }
  const uint64_t key = (uint64_t)low->vertex << 32 | (uint64_t)high->vertex;
  MCOR_TRY(mcor_find_cap_cut(job, key, low, high, mcor_next_cap_vertex(job, 2), cut));
  cut->vertex += mesh->vertex_count;
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

/* Adds a polygon as a fan of triangles. The polygon's corners are counter-clockwise, seen from the
 * upper end of the axis. */
static mcor_status mcor_add_cap_fan(void* data, const mcor_cap_corner* corners, int count)
{
  mcor_cap_job* job = data;
  const mcor_cap_nodes* side = job->side;
  if (job->context->space.flat)
  {
    /* In two dimensions, a cap is a line along the side, with the inside on its left. The line is
     * stored as a triangle whose last two corners are one vertex. Corners that differ only in z are
     * one vertex, too. */
    int other = 1;
    while (other < count - 1 && corners[other].vertex == corners[0].vertex)
    {
      ++other;
    }
    const int along = 1 - side->axis, forward = side->upper == along;
    const bool rises = corners[other].at[along] > corners[0].at[along];
    const int from = rises == forward ? 0 : other, to = other - from;
    return mcor_add_cap_triangle(job, corners[from].vertex, corners[to].vertex, corners[to].vertex);
  }
  for (int i = 1; i + 1 < count; ++i)
  {
    const int next = side->upper ? i : i + 1, last = 2 * i + 1 - next;
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
    return add(data, run, length);
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
      MCOR_TRY(add(data, run, length));
      length = 0;
    }
  }
  return MCOR_OK;
}

/* Adds what trimming leaves of a square to the cap. above: which nodes of the square are above the
 * iso value; margin: the nodes' trim margins. apart: the two nodes above, at opposite corners, are
 * in two polygons. */
static mcor_status mcor_add_cap_square(
  mcor_cap_job* job, const bool above[4], const double margin[4], bool apart)
{
  mcor_cap_corner corners[6];
  const mcor_cap_corner* polygon[6];
  int count = 0;
  for (int k = 0; k < 6; ++k)
  {
    polygon[k] = &corners[k];
  }
  for (int k = 0; k < 4; ++k)
  {
    if (apart && above[k])
    {
      MCOR_TRY(mcor_cap_edge_corner(job, (k + 3) % 4, &corners[count++]));
    }
    if (above[k])
    {
      MCOR_TRY(mcor_cap_node_corner(job, k, margin[k], &corners[count++]));
    }
    if (apart ? above[k] : above[k] != above[(k + 1) % 4])
    {
      MCOR_TRY(mcor_cap_edge_corner(job, k, &corners[count++]));
    }
    if (apart ? above[k] : k == 3)
    {
      MCOR_TRY(mcor_clip_polygon(polygon, count, 0, mcor_cap_cut, mcor_add_cap_fan, job));
      count = 0;
    }
  }
  return MCOR_OK;
}

/* Caps one square. The square's number is the key of its triangles, and is greater than the key of
 * any owned cell. Squares come in the order of their numbers. */
static mcor_status mcor_visit_cap_square(
  void* data, const mcor_cap_nodes* side, int64_t lowest, const cl_int node[3])
{
  mcor_cap_job* job = data;
  const mcor_box* box = &job->context->box;
  const mcor_cap_brick *of = side->bricks.of, *own = &of[lowest / MCOR_SIDE_NODES];
  const int face = mcor_side_bit(side, side->plane, lowest);
  const int cell = mcor_side_bit(side, side->plane - side->upper, lowest);
  const bool used = (side->upper ? &of[own->inner] : own)->used >> cell & 1;
  const bool joined = own->joined >> face & 1;
  bool above[4], owned = true;
  double margin[4];
  int total = 0;
  bool valid = true; /* without surface in the square, this says whether the cell beside it is
                      * valid */
  for (int k = 0; k < 4; ++k)
  {
    const int64_t at = mcor_corner_index(side, lowest, k);
    const mcor_cap_brick* brick = &of[at / MCOR_SIDE_NODES];
    const int bit = mcor_side_bit(side, side->plane, at);
    above[k] = brick->above >> bit & 1;
    margin[k] = side->margin[at];
    total += above[k];
    valid = valid && (brick->valid >> bit & 1) &&
      (of[brick->inner].valid >> mcor_side_bit(side, side->inner, at) & 1);
  }
  if (total == 0 || (total == 4 ? !valid : !used))
  {
    return MCOR_OK;
  }
  /* This call owns the square if it is in the box along the other axes. */
  for (int a = 0; a < job->context->space.axes; ++a)
  {
    owned = owned && (a == side->axis || (node[a] >= box->first[a] && node[a] < box->last[a]));
  }
  job->number = MCOR_CAP_SQUARE | (cl_ulong)(2 * side->axis + side->upper) << 42 |
    (cl_ulong)node[side->across[1]] << 21 | (cl_ulong)node[side->across[0]] |
    (owned ? 0 : MCOR_RING_CELL);
  job->lookups = 0;
  job->side = side;
  memcpy(job->lowest, node, sizeof job->lowest);
  return mcor_add_cap_square(job, above, margin, total == 2 && above[0] == above[2] && !joined);
}

/* ---- Moving cuts ---- */

/* The most steps in which a cut moves. They suffice, because every fourth step halves the
 * bracket. */
#define MCOR_PLACE_STEPS 100
/* A cut stays where it is if its trim margin is smaller in magnitude than this number, which is a
 * few units of rounding in single precision. */
#define MCOR_PLACE_ROOT 1e-6

/* Moves a cut within its bracket, unless its margin is 0 up to rounding. If an end of the bracket
 * stays in two successive moves, the margin at this end is halved, so that the end soon moves (the
 * Illinois method). */
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
  const int moved = (margin > 0) != (line->margin[0] > 0);
  line->end[moved] = line->at;
  line->margin[moved] = margin;
  line->margin[1 - moved] *= line->last == moved ? 0.5 : 1;
  line->last = moved;
  line->at = mcor_cut_place(line, ++line->moves % 4 == 0);
  line->done = line->at == before; /* the cut is at an end, or as exact as numbers allow */
  double at[3];
  mcor_point_between(line->from, line->to, line->at, at);
  mcor_put_cap_vertex(vertex, at);
}

mcor_status mcor_place_cap_cuts(mcor_cap_job* job)
{
  int64_t left = job->lines.count;
  for (int step = 0; step < MCOR_PLACE_STEPS && left > 0; ++step)
  {
    mcor_cap_points points = { .take = mcor_move_cut, .data = job };
    mcor_status status = MCOR_OK;
    left = 0;
    for (int64_t i = 0; i < job->lines.count && status == MCOR_OK; ++i)
    {
      const mcor_cap_vertex* vertex = &job->vertices.of[job->lines.of[i].vertex];
      if (!job->lines.of[i].done)
      {
        status = mcor_add_cap_point(job->context, &points, vertex->node, vertex->offset, i);
        ++left;
      }
    }
    MCOR_TRY(mcor_end_cap_points(job->context, &points, status));
  }
  return MCOR_OK;
}

/* ---- The caps of all sides ---- */

/* Lists the surface's vertices that lie on the sides, in tables by the vertices' lattice edges. */
static mcor_status mcor_index_cap_edges(mcor_cap_job* job)
{
  const mcor_context* context = job->context;
  const cl_int* nodes = job->node;
  int plane[6];
  for (int i = 0; i < 6; ++i)
  {
    plane[i] = mcor_cap_plane(context, i / 2, i % 2);
  }
  for (int32_t v = 0; v < context->mesh.march_count; ++v)
  {
    const cl_int* node = nodes + 4 * (size_t)v;
    const int axis = node[3] & 3;
    bool on_side = false;
    for (int a = 0; a < 3; ++a)
    {
      on_side = on_side || (a != axis && (node[a] == plane[2 * a] || node[a] == plane[2 * a + 1]));
    }
    MCOR_TRY(mcor_allocated(
      job->context, !on_side || mcor_table_number(&job->edges[axis], mcor_cap_key(node), v) >= 0));
  }
  return MCOR_OK;
}

static mcor_status mcor_append_caps(mcor_cap_job* job)
{
  mcor_context* context = job->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t old = (size_t)mesh->triangle_count, more = (size_t)job->triangles.count;
  const size_t width = 3 * sizeof(cl_int), cell = sizeof(cl_ulong);
  if (more == 0)
  {
    return MCOR_OK;
  }
  MCOR_FAIL_IF(old + more > MCOR_COUNT_LIMIT / 3, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(CAPS_TOO_LARGE), old + more, MCOR_COUNT_LIMIT / 3);
  MCOR_TRY(
    mcor_append_bytes(context, &mesh->triangles, old * width, job->triangles.of, more * width));
  MCOR_TRY(mcor_append_bytes(context, &context->box.cells, old * cell, job->cells.of, more * cell));
  mesh->triangle_count += (int)more;
  context->run.statistics->cap_triangles += job->owned_count;
  return mcor_append_cap_vertices(context, job->vertices.of, job->vertices.count);
}

void mcor_free_cap_job(mcor_cap_job* job)
{
  for (int a = 0; a < 3; ++a)
  {
    mcor_table_free(&job->edges[a]);
  }
  mcor_table_free(&job->nodes);
  mcor_table_free(&job->cuts);
  free(job->vertices.of);
  free(job->lines.of);
  free(job->triangles.of);
  free(job->cells.of);
}

mcor_status mcor_cap(mcor_context* context)
{
  mcor_cap_job job = { .context = context,
    .threshold = mcor_real_of(context, mcor_trim_threshold(context)) };
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->march_count, all = (size_t)mesh->vertex_count,
               real = context->cl.real_size;
  const mcor_mapping views[] = { { &mesh->node, all * 4 * sizeof(cl_int), &job.node },
    { &mesh->offset, all * 4 * real, &job.offset },
    { mcor_trim_quantity(context), n * real, &job.quantity },
    { &mesh->cut_edges, (all - n) * sizeof(cl_ulong), &job.cut_edges } };
  /* A mesh that is not trimmed has no cuts. */
  const int mapped = n == 0 ? 0 : all > n ? 4 : mcor_is_trimmed(context) ? 3 : 2;
  mcor_status status = mcor_map_all(context, views, mapped);
  MCOR_THEN(status, mcor_index_cap_edges(&job));
  /* Caps the lower and the upper side of each axis, if this call's box has them. */
  for (int i = 0; i < 6 && status == MCOR_OK; ++i)
  {
    mcor_cap_nodes nodes = { 0 };
    if (mcor_has_cap_side(context, i / 2, i % 2))
    {
      status = mcor_load_cap_side(context, i / 2, i % 2, &nodes);
      MCOR_THEN(status, mcor_visit_cap_squares(context, &nodes, mcor_visit_cap_square, &job));
    }
    mcor_free_cap_nodes(&nodes);
  }
  const bool places = context->space.axes == 2 && !context->run.options->preview;
  status = status == MCOR_OK && places ? mcor_place_cap_cuts(&job) : status;
  status = mcor_unmap_all(context, views, mapped, status);
  MCOR_THEN(status, mcor_append_caps(&job));
  mcor_free_cap_job(&job);
  return status;
}
