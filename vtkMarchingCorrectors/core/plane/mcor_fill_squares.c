/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cuts squares into polygons of one band each, trims them, makes triangles of the rest, and adds
 * these to the surface, with the points that lines lack. Borders are followed with the inside on
 * the left. */

#include "mcor_box.h"
#include "mcor_fill.h"

#include <stdlib.h>
#include <string.h>

/* A node, or a line's vertex, on the border of a square; and the part of the border from there to
 * the next corner. */
typedef struct mcor_fill_corner
{
  mcor_cap_corner corner; /* must be the first member; vertex: a corner of mcor_fill_triangle */
  int level;              /* level of the line; -1: the corner is a node */
  bool begins_line;       /* in the current polygon, a line leads to the next corner */
  int32_t vertex;
  bool falls; /* at this corner, the border goes from above the line to below it */
  int band;   /* band of this part of the border */
  bool done;  /* a polygon has this part */
  /* The part is number `part` of the edge along `axis` from this lower node. */
  cl_int node[3];
  int axis, part;
} mcor_fill_corner;

typedef struct mcor_fill_job
{
  mcor_context* context;
  mcor_filling* fill;
  uint64_t square;
  int64_t lowest;           /* number of the square's lowest node */
  cl_int node[2];           /* the lowest node */
  mcor_fill_corner* border; /* [4 + 4 * line_count] */
  int count;
  int band; /* band of the current polygon */
} mcor_fill_job;

static mcor_status mcor_does_not_fit(mcor_context* context, const mcor_fill_corner* at)
{
  return mcor_fail(context, MCOR_DEVICE_ERROR, MCOR_SAY(FILLED_FAULT), at->node[0], at->node[1]);
}

/* ---- The border ---- */

/* Packs a lattice edge, and the number of a part of the edge, into a key. */
static uint64_t mcor_edge_part(const mcor_fill_corner* corner, int part)
{
  const cl_int edge[3] = { corner->node[0], corner->node[1], corner->axis };
  return mcor_cap_key(edge) ^ (uint64_t)part << 44;
}

/* Adds side s to the border, without its last node. */
static mcor_status mcor_add_border_side(mcor_fill_job* job, int s)
{
  const mcor_filling* fill = job->fill;
  const int64_t begin = mcor_corner_index(&fill->nodes, job->lowest, s),
                end = mcor_corner_index(&fill->nodes, job->lowest, (s + 1) % 4);
  const int first = fill->band[begin], last = fill->band[end], parts = abs(last - first);
  for (int i = 0; i <= parts; ++i)
  {
    mcor_fill_corner* corner = &job->border[job->count++];
    *corner = (mcor_fill_corner){
      .corner = { .vertex = (int32_t)begin,
        .at = { job->node[0] + mcor_corner_u(s), job->node[1] + mcor_corner_v(s) },
        .margin = fill->nodes.margin[begin] },
      .level = -1,
      .falls = last < first,
      .band = last < first ? first - i : first + i,
      .node = { job->node[0] + (s == 1), job->node[1] + (s == 2), 0 },
      .axis = s & 1,
      .part = s < 2 ? i : parts - i
    };
    if (i > 0) /* the corner is a line's vertex */
    {
      corner->level = last < first ? first - i : first + i - 1;
      const mcor_fill_line* line = &fill->lines[corner->level];
      const int32_t v = mcor_find_number(&line->edges, mcor_edge_part(corner, 0));
      if (v < 0 || (line->margin[v] > 0 && line->number[v] < 0))
      {
        return mcor_does_not_fit(job->context, corner);
      }
      corner->corner.vertex = -1 - line->number[v];
      corner->corner.margin = line->margin[v];
      corner->vertex = v;
      corner->corner.at[corner->axis] = corner->node[corner->axis] + line->offset[v];
    }
  }
  return MCOR_OK;
}

/* ---- Polygons ---- */

static mcor_status mcor_add_fill_fan(void* data, const mcor_cap_corner* corners, int count)
{
  mcor_fill_job* job = data;
  for (int i = 1; i + 1 < count; ++i)
  {
    MCOR_APPEND(job->context, &job->fill->triangles,
      (mcor_fill_triangle){
        { corners[0].vertex, corners[i].vertex, corners[i + 1].vertex }, job->band, job->square });
  }
  return MCOR_OK;
}

/* Finds the point where trimming has cut a line; or, on the border, finds or makes the point where
 * trimming cuts the lattice edge. */
static mcor_status mcor_cut_fill_side(
  void* data, const mcor_cap_corner* from, const mcor_cap_corner* to, mcor_cap_corner* cut)
{
  mcor_fill_job* job = data;
  mcor_filling* fill = job->fill;
  const mcor_fill_corner *p = (const mcor_fill_corner*)from, *q = (const mcor_fill_corner*)to;
  if (p->begins_line)
  {
    const mcor_fill_line* line = &fill->lines[p->level];
    const int found = mcor_find_cut(line->cuts, line->cut_count, p->vertex, q->vertex);
    const int32_t number = found < 0 ? -1 : line->number[line->vertex_count + found];
    cut->vertex = -1 - number;
    return number >= 0 ? MCOR_OK : mcor_does_not_fit(job->context, p);
  }
  const bool inside = from->margin > 0;
  const int32_t nodes = (int32_t)fill->nodes.node_count;
  const mcor_cap_vertex vertex = { .band = p->band,
    .number = nodes + (int32_t)fill->cap.vertices.count,
    .key = { mcor_fill_node_key(p->node) | UINT64_C(1) << 62,
      (uint64_t)p->axis << 32 | (uint32_t)p->part },
    .flag = 2 };
  MCOR_TRY(mcor_find_cap_cut(
    &fill->cap, mcor_edge_part(p, p->part), inside ? from : to, inside ? to : from, vertex, cut));
  cut->vertex += nodes;
  return MCOR_OK;
}

/* Adds the polygon whose first corner is corner i of the border. */
static mcor_status mcor_add_polygon(mcor_fill_job* job, int i)
{
  const mcor_cap_corner* corners[MCOR_POLYGON_MOST];
  int count = 0;
  job->band = job->border[i].band;
  for (int at = i; !job->border[at].done;)
  {
    mcor_fill_corner *corner = &job->border[at], *next = &job->border[(at + 1) % job->count];
    const bool meets_line = next->level >= 0;
    if (count + 1 + meets_line > MCOR_POLYGON_MOST || corner->band != job->band)
    {
      return mcor_does_not_fit(job->context, corner);
    }
    corner->done = true;
    corner->begins_line = false;
    corners[count++] = &corner->corner;
    at = (at + 1) % job->count;
    if (meets_line)
    {
      next->begins_line = true;
      corners[count++] = &next->corner;
      /* Goes to the other end of the line. A level has two corners on the border, or four. Lines
       * join four corners around the parts below or around the parts above. */
      const int level = next->level;
      const bool joined =
        mcor_find_number(&job->fill->lines[level].joined, (uint64_t)job->lowest) >= 0;
      const int step = next->falls == joined ? 1 : job->count - 1;
      do
      {
        at = (at + step) % job->count;
      } while (job->border[at].level != level);
    }
  }
  return mcor_clip_polygon(corners, count, 1, mcor_cut_fill_side, mcor_add_fill_fan, job);
}

/* ---- Squares ---- */

/* A square is filled if all its nodes are valid, and any of them is above the lowest level. */
static mcor_status mcor_visit_fill_square(
  void* data, const mcor_cap_nodes* nodes, int64_t lowest, const cl_int node[3])
{
  mcor_fill_job* job = data;
  bool valid = true, above = false;
  for (int k = 0; k < 4; ++k)
  {
    const int64_t at = mcor_corner_index(nodes, lowest, k);
    valid = valid && (nodes->bricks.of[at / MCOR_SIDE_NODES].valid >> at % MCOR_SIDE_NODES & 1);
    above = above || job->fill->band[at] > 0;
  }
  job->square = (uint64_t)node[1] << 21 | (uint64_t)node[0];
  job->lowest = lowest;
  job->node[0] = node[0];
  job->node[1] = node[1];
  job->count = 0;
  for (int s = 0; s < 4 && valid && above; ++s)
  {
    MCOR_TRY(mcor_add_border_side(job, s));
  }
  for (int i = 0; i < job->count; ++i)
  {
    if (job->border[i].band > 0 && !job->border[i].done)
    {
      MCOR_TRY(mcor_add_polygon(job, i));
    }
  }
  return MCOR_OK;
}

/* ---- Points ---- */

static int mcor_compare_cuts(const void* x, const void* y)
{
  const uint64_t *a = ((const mcor_cap_vertex*)x)->key, *b = ((const mcor_cap_vertex*)y)->key;
  const int i = a[0] == b[0];
  return (a[i] > b[i]) - (a[i] < b[i]);
}

/* Makes the points that lines lack, and numbers them in the surface: first the nodes that triangles
 * use, then the cuts. They are appended as a mesh of their own, as if they were vertices of caps,
 * and get the iso values and residuals of their bands. */
static mcor_status mcor_make_fill_points(
  mcor_context* context, mcor_filling* fill, const mcor_input* input, mcor_surface* surface)
{
  mcor_cap_job* cap = &fill->cap;
  const size_t refs = (size_t)(fill->nodes.node_count + cap->vertices.count);
  fill->number = malloc(refs * sizeof *fill->number);
  MCOR_TRY(mcor_allocated(context, fill->number));
  memset(fill->number, 0xff, refs * sizeof *fill->number);
  const int64_t base = surface->point_count;
  int64_t nodes = 0;
  for (int64_t i = 0; i < 3 * fill->triangles.count; ++i)
  {
    const int32_t ref = fill->triangles.of[i / 3].corner[i % 3];
    if (ref >= 0 && ref < fill->nodes.node_count && fill->number[ref] < 0)
    {
      fill->number[ref] = 0;
      ++nodes;
    }
  }
  const int64_t count = nodes + cap->vertices.count;
  MCOR_FAIL_IF(count > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(FILLED_TOO_LARGE),
    (long long)count, MCOR_COUNT_LIMIT);
  if (count == 0)
  {
    return MCOR_OK;
  }
  mcor_cap_vertex *vertices = malloc((size_t)count * sizeof *vertices), *vertex = vertices;
  MCOR_TRY(mcor_allocated(context, vertices));
  for (int32_t n = 0; vertex < vertices + nodes; ++n)
  {
    if (fill->number[n] == 0)
    {
      *vertex = (mcor_cap_vertex){ .band = fill->band[n], .number = n, .flag = MCOR_CAP_FLAG };
      mcor_cap_node(&fill->nodes, n, vertex->node);
      vertex->key[0] = mcor_fill_node_key(vertex->node);
      ++vertex;
    }
  }
  for (int64_t i = 0; i < cap->vertices.count; ++i)
  {
    *vertex++ = cap->vertices.of[i];
  }
  qsort(vertices + nodes, (size_t)cap->vertices.count, sizeof *vertices, mcor_compare_cuts);
  for (int64_t i = 0; i < count; ++i)
  {
    fill->number[vertices[i].number] = (int32_t)(base + i);
  }
  mcor_mesh* mesh = &context->mesh;
  mesh->march_count = mesh->vertex_count = mesh->cap_first = mesh->triangle_count = 0;
  context->run.iso = (mcor_iso){ .number = context->run.options->iso_count };
  mcor_status status = mcor_load_attributes(context, input, 0);
  MCOR_THEN(status, mcor_reserve_vertices(context, (int)count));
  MCOR_THEN(status, mcor_append_cap_vertices(context, vertices, count));
  mcor_release(context, &context->attributes.sorted);
  MCOR_THEN(status, mcor_append_output(context, input, true, surface));
  for (int64_t i = base; i < surface->point_count && status == MCOR_OK; ++i)
  {
    const mcor_fill_line* line = &fill->lines[vertices[i - base].band - 1];
    if (surface->iso_value)
    {
      surface->iso_value[i] = line->value;
    }
    if (surface->residual)
    {
      surface->residual[i] = (float)(surface->residual[i] - line->iso);
    }
  }
  free(vertices);
  return status;
}

/* ---- All of it ---- */

mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  mcor_filling* fill = context->run.fill;
  if (!fill)
  {
    return MCOR_OK;
  }
  free(fill->value); /* no longer needed: the bands are known */
  fill->value = NULL;
  mcor_fill_job job = { .context = context, .fill = fill };
  job.border = malloc((4 + 4 * (size_t)fill->line_count) * sizeof *job.border);
  MCOR_TRY(mcor_allocated(context, job.border));
  const mcor_status status =
    mcor_visit_cap_squares(context, &fill->nodes, mcor_visit_fill_square, &job);
  free(job.border);
  MCOR_TRY(status);
  if (!context->run.options->preview)
  {
    MCOR_TRY(mcor_place_cap_cuts(&fill->cap));
  }
  MCOR_TRY(mcor_make_fill_points(context, fill, input, surface));
  const int64_t first = surface->triangle_count, count = fill->triangles.count;
  MCOR_TRY(mcor_grow(context, (void**)&surface->triangles, first, count, 3 * sizeof(int32_t)));
  MCOR_TRY(mcor_grow(context, (void**)&surface->band_value, 0, count, sizeof(double)));
  MCOR_TRY(mcor_extend_kept(context, count, surface));
  for (int64_t t = 0; t < count; ++t)
  {
    const mcor_fill_triangle* from = &fill->triangles.of[t];
    for (int c = 0; c < 3; ++c)
    {
      const int32_t ref = from->corner[c];
      surface->triangles[3 * (first + t) + c] = ref < 0 ? -1 - ref : fill->number[ref];
    }
    surface->band_value[t] = fill->lines[from->band - 1].value;
    mcor_keep_cell(context, surface, first + t, context->run.options->iso_count, from->square);
  }
  surface->triangle_count += count;
  return MCOR_OK;
}
