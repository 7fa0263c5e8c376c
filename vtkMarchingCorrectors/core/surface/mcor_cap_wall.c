/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Caps at walls close the free surface where it ends at solids, that is, where the solids' share of
 * the weight becomes too great. In each such cell two kinds of edges appear: those that cutting the
 * cell's six faces leaves, as caps at sides cut squares, and those that trimming has left of the
 * surface's triangles. Together they form loops, and a cap fills each loop. A face is cut alike
 * seen from both of its cells, so caps fit each other, the caps at sides, and the surface. Their
 * vertices are cuts of lattice edges.
 *
 * The squares of these caps are numbered by cell, behind all squares of sides. */

#include "mcor_box.h"
#include "mcor_cap_job.h"
#include "mcor_vector.h"

#include <stdlib.h>

/* Marks the key of a cell as that of a cap at a wall. */
#define MCOR_WALL_CELL ((cl_ulong)1 << 61)

/* An edge that trimming has made, in the direction of its triangle, and its cell. */
typedef struct mcor_wall_edge
{
  cl_ulong cell;
  int32_t triangle, from, to;
} mcor_wall_edge;

/* Data of caps at walls. */
typedef struct mcor_wall_job
{
  mcor_cap_job* cap;
  mcor_cap_nodes nodes;
  mcor_wall_edge* edges;    /* sorted by cell, then triangle */
  int64_t edge_count, edge; /* edge: the first one of a cell that is still to come */
} mcor_wall_job;

/* A cell. Of its corners, numbered x + 2 y + 4 z: whether they are above, and their trim
 * margins. Of its faces, by axis, lower and upper: whether an ambiguous face joins its corners
 * above. */
typedef struct mcor_wall_cell
{
  cl_int node[3];
  cl_ulong key;
  bool is_used;
  bool above[8], joined[3][2];
  double margin[8];
} mcor_wall_cell;

/* ---- Edges that trimming has made ---- */

static int mcor_compare_wall_edges(const void* x, const void* y)
{
  const mcor_wall_edge *a = x, *b = y;
  return a->cell != b->cell ? (a->cell > b->cell) - (a->cell < b->cell)
                            : (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

/* Lists the border edges of the trimmed triangles: an edge between two cuts. */
static mcor_status mcor_load_wall_edges(mcor_wall_job* job)
{
  mcor_context* context = job->cap->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->triangle_count;
  void *triangles = NULL, *cells = NULL;
  const mcor_mapping mappings[] = { { &mesh->triangles, 3 * n * sizeof(cl_int), &triangles },
    { &context->box.cells, n * sizeof(cl_ulong), &cells } };
  if (n == 0)
  {
    return MCOR_OK;
  }
  job->edges = malloc(n * sizeof *job->edges);
  MCOR_TRY(mcor_allocated(context, job->edges));
  const mcor_status status = mcor_map_all(context, mappings, 2);
  for (int32_t i = 0; i < 3 * mesh->triangle_count && status == MCOR_OK; ++i)
  {
    const cl_int* corner = triangles;
    const int32_t t = i / 3, from = corner[i], to = corner[3 * t + (i + 1) % 3];
    if (from >= mesh->march_count && to >= mesh->march_count)
    {
      job->edges[job->edge_count++] =
        (mcor_wall_edge){ ((const cl_ulong*)cells)[t] & ~(MCOR_RING_CELL | MCOR_OTHERS_CELL), t,
          from, to };
    }
  }
  qsort(job->edges, (size_t)job->edge_count, sizeof *job->edges, mcor_compare_wall_edges);
  return mcor_unmap_all(context, mappings, 2, status);
}

/* ---- Cells ---- */

/* Loads a cell. Returns whether the surface ends there: all corners are near both fluid and solids,
 * and corners above, or vertices on the cell's edges, lie on both sides of that end. */
static bool mcor_load_wall_cell(const mcor_wall_job* job, int64_t number, mcor_wall_cell* cell)
{
  const mcor_cap_job* cap = job->cap;
  const mcor_cap_nodes* nodes = &job->nodes;
  const mcor_cap_brick* brick = &nodes->bricks.of[number / MCOR_BRICK_NODES];
  const int inner = (int)(number % MCOR_BRICK_NODES);
  bool near = true, inside = false, outside = false, is_crossed = false;
  *cell =
    (mcor_wall_cell){ .key = brick->key | (cl_ulong)inner, .is_used = brick->used >> inner & 1 };
  for (int a = 0; a < 3; ++a)
  {
    cell->node[a] = brick->at[a] * MCOR_BRICK + (inner >> 2 * a & 3);
    near = near && cell->node[a] >= nodes->range[a][0] && cell->node[a] < nodes->range[a][1];
  }
  for (int c = 0; c < 8; ++c)
  {
    int bit = 0, up = 0;
    for (int a = 0; a < 3; ++a)
    {
      const int at = (inner >> 2 * a & 3) + (c >> a & 1);
      up |= at >> 2 << a;
      bit |= (at & 3) << 2 * a;
    }
    const int32_t corner = brick->up[up];
    const mcor_cap_brick* of = &nodes->bricks.of[corner];
    near = near && corner > 0;
    cell->above[c] = of->above >> bit & 1;
    cell->margin[c] = nodes->margin[(int64_t)corner * MCOR_BRICK_NODES + bit];
    is_crossed = is_crossed || cell->above[c] != cell->above[0];
    inside = inside || (cell->above[c] && cell->margin[c] > 0);
    outside = outside || (cell->above[c] && !(cell->margin[c] > 0));
    for (int a = 0; a < 3; ++a)
    {
      if (c == 0 || c == 1 << a)
      {
        cell->joined[a][c != 0] = of->joined[a] >> bit & 1;
      }
    }
  }
  for (int e = 0; e < 24 && near && is_crossed && cell->is_used; ++e)
  {
    const int c = e / 3, a = e % 3;
    const cl_int node[3] = { cell->node[0] + (c & 1), cell->node[1] + (c >> 1 & 1),
      cell->node[2] + (c >> 2) };
    const int32_t v = (c >> a & 1) || cell->above[c] == cell->above[c | 1 << a]
      ? -1
      : mcor_find_number(&cap->edges[a], mcor_cap_key(node));
    const bool is_inside = v >= 0 && mcor_get_real(cap->context, cap->quantity, v) > cap->threshold;
    inside = inside || is_inside;
    outside = outside || (v >= 0 && !is_inside);
  }
  return near && inside && outside && (!is_crossed || cell->is_used);
}

/* ---- Loops ---- */

/* Fills a loop with the fan of least area, since loops are not flat, and may not be convex. */
static mcor_status mcor_fill_wall_loop(mcor_cap_job* job, const int32_t* loop, int count)
{
  const mcor_context* context = job->context;
  double at[MCOR_CAP_BORDER][3], least = INFINITY;
  int best = 0;
  for (int i = 0; i < 3 * count; ++i)
  {
    const int64_t v = 4 * (int64_t)loop[i / 3] + i % 3,
                  own = loop[i / 3] - context->mesh.vertex_count;
    at[i / 3][i % 3] = own >= 0
      ? job->vertices.of[own].node[i % 3] + job->vertices.of[own].offset[i % 3]
      : ((const cl_int*)job->node)[v] + mcor_get_real(context, job->offset, v);
  }
  for (int i = 0; i < count; ++i)
  {
    double area = 0;
    for (int k = 1; k + 1 < count; ++k)
    {
      double u[3], v[3], n[3];
      mcor_subtract(at[(i + k) % count], at[i], u);
      mcor_subtract(at[(i + k + 1) % count], at[i], v);
      mcor_cross(u, v, n);
      area += sqrt(mcor_dot(n, n));
    }
    best = area < least ? i : best;
    least = fmin(area, least);
  }
  for (int i = 1; i + 1 < count; ++i)
  {
    MCOR_TRY(mcor_add_cap_triangle(
      job, loop[best], loop[(best + i) % count], loop[(best + i + 1) % count]));
  }
  return MCOR_OK;
}

/* Cuts the faces of a cell, joins the edges that this leaves to loops, and fills them. */
static mcor_status mcor_cap_wall_cell(mcor_wall_job* job, const mcor_wall_cell* cell)
{
  mcor_cap_job* cap = job->cap;
  mcor_cap_border* border = cap->border;
  mcor_begin_cap_square(cap, MCOR_WALL_CELL | cell->key, cell->node, -1);
  border->count = 0;
  for (int side = 0; side < 6; ++side)
  {
    const int axis = side / 2, upper = side % 2;
    mcor_cap_square square = { .axis = axis,
      .upper = upper,
      .node = { cell->node[0], cell->node[1], cell->node[2] },
      .is_joined = cell->joined[axis][upper] };
    square.node[axis] += upper;
    int total = 0;
    for (int k = 0; k < 4; ++k)
    {
      const int c =
        upper << axis | mcor_corner_u(k) << (axis + 1) % 3 | mcor_corner_v(k) << (axis + 2) % 3;
      square.above[k] = cell->above[c];
      square.margin[k] = cell->margin[c];
      total += cell->above[c];
    }
    MCOR_TRY(
      total == 4 || (total > 0 && cell->is_used) ? mcor_add_cap_square(cap, &square) : MCOR_OK);
  }
  for (; job->edge < job->edge_count && job->edges[job->edge].cell <= cell->key; ++job->edge)
  {
    const mcor_wall_edge* edge = &job->edges[job->edge];
    MCOR_TRY(edge->cell == cell->key ? mcor_add_cap_border(cap, edge->to, edge->from) : MCOR_OK);
  }
  for (int start = 0; start < border->count; ++start)
  {
    int32_t loop[MCOR_CAP_BORDER];
    int count = 0;
    for (int next = start; next >= 0 && border->ends[next][0] >= 0;)
    {
      const int32_t to = border->ends[next][1];
      loop[count++] = border->ends[next][0];
      border->ends[next][0] = -1;
      for (next = border->count - 1; next >= 0 && border->ends[next][0] != to;)
      {
        --next;
      }
      MCOR_RETURN_IF(next < 0 && to != loop[0], cap->context, MCOR_DEVICE_ERROR,
        "A cap at a wall does not fit the surface in cell %d %d %d. Please report this.",
        cell->node[0], cell->node[1], cell->node[2]);
    }
    MCOR_TRY(count > 2 ? mcor_fill_wall_loop(cap, loop, count) : MCOR_OK);
  }
  return MCOR_OK;
}

mcor_status mcor_cap_walls(mcor_cap_job* cap)
{
  mcor_wall_job job = { .cap = cap };
  mcor_cap_border border = { .count = 0 };
  mcor_status status = mcor_load_cap_walls(cap->context, &cap->points, &job.nodes);
  MCOR_THEN(status, mcor_load_wall_edges(&job));
  cap->border = &border;
  for (int64_t i = MCOR_BRICK_NODES; i < job.nodes.node_count && status == MCOR_OK; ++i)
  {
    mcor_wall_cell cell;
    status = mcor_load_wall_cell(&job, i, &cell) ? mcor_cap_wall_cell(&job, &cell) : MCOR_OK;
    status = status == MCOR_OK && i % (1024 * MCOR_BRICK_NODES) == MCOR_BRICK_NODES - 1
      ? mcor_report_launch(cap->context)
      : status;
  }
  MCOR_THEN(status, mcor_place_cap_cuts(cap));
  cap->border = NULL;
  mcor_free_cap_nodes(&job.nodes);
  free(job.edges);
  return status;
}
