/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Cuts squares into polygons of one band each, and makes triangles of what trimming leaves of
 * them. Borders are run through with the inside on the left. */

#include "mcor_fill.h"

#include <math.h>
#include <stdlib.h>

/* A node, or a line's vertex, on the border of a square; and the part of the border from there
 * to the next one. */
typedef struct mcor_fill_corner
{
  int32_t ref; /* see mcor_fill_triangle */
  double margin;
  int level; /* the line's; -1: a node */
  int32_t vertex;
  bool falls; /* the border goes from above the line to below */
  int band;   /* the part's */
  bool done;  /* a polygon has it */
  /* Where the part is: number `part` on the edge of this lower node; its ends along the edge. */
  cl_int node[3];
  int axis, part;
  double from, to;
} mcor_fill_corner;

/* A corner of a polygon, and whether a line leads to the next one. */
typedef struct mcor_fill_side
{
  mcor_fill_corner* corner;
  bool is_line;
} mcor_fill_side;

/* Corners of a polygon, at most: nodes, and vertices of the two lines beside its band. */
#define MCOR_FILL_MOST 12

typedef struct mcor_fill_job
{
  mcor_context* context;
  mcor_filling* fill;
  uint64_t square;
  int64_t lowest;           /* index of its lowest node */
  mcor_fill_corner* border; /* [4 + 4 * line_count] */
  int count;
  cl_int u, v;
} mcor_fill_job;

static mcor_status mcor_does_not_fit(mcor_context* context, const mcor_fill_corner* at)
{
  return mcor_fail(context, MCOR_DEVICE_ERROR,
    "The filled region does not match the lines at node %d %d. Please report this.", at->node[0],
    at->node[1]);
}

/* ---- The border ---- */

/* Packs a lattice edge and the number of a part of it into a key. */
static uint64_t mcor_edge_part(const mcor_fill_corner* corner, int part)
{
  const cl_int edge[3] = { corner->node[0], corner->node[1], corner->axis };
  return mcor_cap_key(edge) ^ (uint64_t)part << 44;
}

static mcor_status mcor_add_vertex(mcor_fill_job* job, int level, mcor_fill_corner* corner)
{
  const mcor_fill_line* line = &job->fill->lines[level];
  const int32_t v = mcor_find_number(&line->edges, mcor_edge_part(corner, 0));
  if (v < 0 || (line->margin[v] > 0 && line->number[v] < 0))
  {
    return mcor_does_not_fit(job->context, corner);
  }
  corner->ref = -1 - line->number[v];
  corner->margin = line->margin[v];
  corner->level = level;
  corner->vertex = v;
  corner->from = line->offset[v];
  return MCOR_OK;
}

/* Adds side s to the border, without its last node. */
static mcor_status mcor_add_border_side(mcor_fill_job* job, int s)
{
  const mcor_filling* fill = job->fill;
  const mcor_cap_face* face = &fill->face;
  const int corner_u[4] = { 0, 1, 1, 0 }, corner_v[4] = { 0, 0, 1, 1 }, next = (s + 1) % 4;
  const int64_t begin = mcor_cap_index(face, job->u + corner_u[s], job->v + corner_v[s]),
                end = mcor_cap_index(face, job->u + corner_u[next], job->v + corner_v[next]);
  const int first = fill->band[begin], last = fill->band[end], parts = abs(last - first);
  for (int i = 0; i <= parts; ++i)
  {
    mcor_fill_corner* corner = &job->border[job->count++];
    *corner = (mcor_fill_corner){ .ref = (int32_t)begin,
      .margin = face->margin[begin],
      .level = -1,
      .falls = last < first,
      .band = last < first ? first - i : first + i,
      .node = { face->first[0] + job->u + (s == 1), face->first[1] + job->v + (s == 2), 0 },
      .axis = s & 1,
      .part = s < 2 ? i : parts - i,
      .from = s < 2 ? 0 : 1 };
    MCOR_TRY(
      i > 0 ? mcor_add_vertex(job, last < first ? first - i : first + i - 1, corner) : MCOR_OK);
    if (i > 0)
    {
      corner[-1].to = corner->from;
    }
    corner->to = s < 2 ? 1 : 0;
  }
  return MCOR_OK;
}

/* Finds the corner at the other end of the line from corner i. A level has two corners on the
 * border, or four, which lines then join around what is below, or above. */
static int mcor_fill_mate(const mcor_fill_job* job, int i)
{
  const mcor_fill_corner* corners = job->border;
  const mcor_fill_line* line = &job->fill->lines[corners[i].level];
  const bool joined = mcor_find_number(&line->joined, (uint64_t)job->lowest) >= 0;
  const int step = corners[i].falls == joined ? 1 : job->count - 1;
  int mate = (i + step) % job->count;
  while (corners[mate].level != corners[i].level)
  {
    mate = (mate + step) % job->count;
  }
  return mate;
}

/* ---- Polygons ---- */

static mcor_status mcor_add_fan(mcor_fill_job* job, const int32_t* refs, int count, int band)
{
  mcor_filling* fill = job->fill;
  for (int i = 1; i + 1 < count; ++i)
  {
    MCOR_TRY(mcor_make_room(job->context, (void**)&fill->triangles, fill->triangle_count,
      &fill->triangle_room, sizeof *fill->triangles));
    fill->triangles[fill->triangle_count++] = (mcor_fill_triangle){
      .corner = { refs[0], refs[i], refs[i + 1] }, .band = band, .square = job->square
    };
  }
  return MCOR_OK;
}

/* Finds the point where trimming cuts a line. */
static mcor_status mcor_find_line_cut(
  mcor_fill_job* job, const mcor_fill_corner* p, const mcor_fill_corner* q, int32_t* ref)
{
  const mcor_fill_line* line = &job->fill->lines[p->level];
  const int cut = mcor_find_cut(line->cuts, line->cut_count, p->vertex, q->vertex);
  const int32_t number = cut < 0 ? -1 : line->number[line->vertex_count + cut];
  *ref = -1 - number;
  return number >= 0 ? MCOR_OK : mcor_does_not_fit(job->context, p);
}

/* Finds, or makes, the point where trimming cuts the border from corner p to q. */
static mcor_status mcor_find_border_cut(
  mcor_fill_job* job, const mcor_fill_corner* p, const mcor_fill_corner* q, int32_t* ref)
{
  mcor_filling* fill = job->fill;
  const int32_t index =
    mcor_table_number(&fill->cut_of, mcor_edge_part(p, p->part), (int32_t)fill->cut_count);
  MCOR_TRY(mcor_allocated(job->context, index >= 0));
  MCOR_TRY(mcor_make_room(
    job->context, (void**)&fill->cuts, fill->cut_count, &fill->cut_room, sizeof *fill->cuts));
  *ref = (int32_t)(fill->face.node_count + index);
  if (index == fill->cut_count)
  {
    const bool inside = p->margin > 0;
    fill->cuts[fill->cut_count++] =
      (mcor_fill_cut){ .key = { mcor_fill_node_key(p->node) | UINT64_C(1) << 62,
                         (uint64_t)p->axis << 32 | (uint32_t)p->part },
        .node = { p->node[0], p->node[1], 0 },
        .axis = p->axis,
        .inside = inside ? p->from : p->to,
        .outside = inside ? p->to : p->from,
        .inside_margin = inside ? p->margin : q->margin,
        .outside_margin = inside ? q->margin : p->margin,
        .margin = INFINITY,
        .last = -1,
        .band = p->band,
        .index = index };
  }
  return MCOR_OK;
}

/* Adds what trimming leaves of a polygon: each run of corners inside, between the cuts before
 * and behind it. */
static mcor_status mcor_add_polygon(
  mcor_fill_job* job, const mcor_fill_side* sides, int count, int band)
{
  int start = 0, length = 0;
  while (start < count && sides[start].corner->margin > 0)
  {
    ++start;
  }
  const bool whole = start == count;
  int32_t run[MCOR_FILL_MOST + 2];
  for (int i = 1; i <= count; ++i)
  {
    const mcor_fill_side* before = &sides[(start + i - 1) % count];
    const mcor_fill_corner *p = before->corner, *q = sides[(start + i) % count].corner;
    const bool inside = q->margin > 0;
    if (inside != (p->margin > 0))
    {
      MCOR_TRY(before->is_line ? mcor_find_line_cut(job, p, q, &run[length])
                               : mcor_find_border_cut(job, p, q, &run[length]));
      ++length;
    }
    if (inside)
    {
      run[length++] = q->ref;
    }
    else
    {
      MCOR_TRY(mcor_add_fan(job, run, length, band));
      length = 0;
    }
  }
  return whole ? mcor_add_fan(job, run, length, band) : MCOR_OK;
}

/* Adds the polygon that has the border's part from corner i on. */
static mcor_status mcor_add_polygon_from(mcor_fill_job* job, int i)
{
  mcor_fill_side sides[MCOR_FILL_MOST];
  const int band = job->border[i].band;
  int count = 0;
  for (int at = i; !job->border[at].done;)
  {
    const int next = (at + 1) % job->count;
    const bool meets_line = job->border[next].level >= 0;
    if (count + 1 + meets_line > MCOR_FILL_MOST || job->border[at].band != band)
    {
      return mcor_does_not_fit(job->context, &job->border[at]);
    }
    job->border[at].done = true;
    sides[count++] = (mcor_fill_side){ &job->border[at], false };
    if (meets_line)
    {
      sides[count++] = (mcor_fill_side){ &job->border[next], true };
    }
    at = meets_line ? mcor_fill_mate(job, next) : next;
  }
  return mcor_add_polygon(job, sides, count, band);
}

/* ---- Squares ---- */

/* Whether all nodes are valid, and any is above the lowest level. */
static bool mcor_is_filled(const mcor_filling* fill, int u, int v)
{
  bool valid = true, above = false;
  for (int c = 0; c < 4; ++c)
  {
    const int64_t node = mcor_cap_index(&fill->face, u + (c & 1), v + (c >> 1));
    valid = valid && (fill->face.within[node] & MCOR_CAP_VALID);
    above = above || fill->band[node] > 0;
  }
  return valid && above;
}

static mcor_status mcor_visit_fill_square(void* data, const mcor_cap_face* face, int u, int v)
{
  mcor_fill_job* job = data;
  job->u = u;
  job->v = v;
  job->square = (uint64_t)(face->first[1] + v) << 21 | (uint64_t)(face->first[0] + u);
  job->lowest = mcor_cap_index(face, u, v);
  job->count = 0;
  const int sides = mcor_is_filled(job->fill, u, v) ? 4 : 0;
  for (int s = 0; s < sides; ++s)
  {
    MCOR_TRY(mcor_add_border_side(job, s));
  }
  for (int i = 0; i < job->count; ++i)
  {
    MCOR_TRY(
      job->border[i].band > 0 && !job->border[i].done ? mcor_add_polygon_from(job, i) : MCOR_OK);
  }
  return MCOR_OK;
}

mcor_status mcor_fill_squares(mcor_context* context, mcor_filling* fill)
{
  mcor_fill_job job = { .context = context, .fill = fill };
  job.border = malloc((4 + 4 * (size_t)fill->line_count) * sizeof *job.border);
  MCOR_TRY(mcor_allocated(context, job.border));
  const mcor_status status =
    mcor_visit_cap_squares(context, &fill->face, mcor_visit_fill_square, &job);
  free(job.border);
  return status;
}
