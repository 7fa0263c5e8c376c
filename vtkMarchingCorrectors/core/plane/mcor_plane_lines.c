/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Output of lines: joins them to polylines, makes normals if the gradient gives none, and turns
 * them back into the caller's coordinates. Triangles of filled regions follow the triangles that
 * stand for lines. */

#include "mcor_plane.h"

#include <math.h>
#include <stdlib.h>

/* The lines at a point: at most one begins there, and at most one ends. next: where the first one
 * ends; last: where the second one begins; -1: none. */
typedef struct mcor_line_ends
{
  int32_t next, last;
  bool done; /* the line that begins here is already in a polyline */
} mcor_line_ends;

/* Whether a triangle stands for a line: two of its corners are the same. Other triangles are
 * filled. */
static bool mcor_is_line(const int32_t* t)
{
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/* Reads the lines from triangles; trimming may leave two triangles of one line, see mcor_trim_cut.
 * The caller frees the ends, [point_count], even after a failure. */
static mcor_status mcor_read_lines(
  mcor_context* context, const mcor_surface* surface, mcor_line_ends** ends)
{
  mcor_line_ends* at = *ends = malloc((size_t)surface->point_count * sizeof *at + 1);
  MCOR_TRY(mcor_allocated(context, at));
  for (int64_t i = 0; i < surface->point_count; ++i)
  {
    at[i] = (mcor_line_ends){ -1, -1, false };
  }
  for (int64_t i = 0; i < surface->triangle_count; ++i)
  {
    const int32_t* t = surface->triangles + 3 * i;
    if (t[0] != t[2] && mcor_is_line(t)) /* skips the second half of a quad that stands for a
                                          * line */
    {
      const int32_t from = t[1] == t[2] ? t[0] : t[2], to = t[1];
      at[from].next = to;
      at[to].last = from;
    }
  }
  return MCOR_OK;
}

/* Makes open polylines from their beginnings on, then closed polylines, which begin and end with
 * their first point. Returns false if memory ran out. */
static bool mcor_join(mcor_line_ends* ends, mcor_surface* surface)
{
  const int64_t points = surface->point_count; /* there are no more lines than points */
  surface->line_points = malloc(2 * (size_t)points * sizeof *surface->line_points + 1);
  surface->line_offsets = malloc(((size_t)points + 1) * sizeof *surface->line_offsets);
  if (!surface->line_points || !surface->line_offsets)
  {
    return false;
  }
  surface->line_offsets[0] = 0;
  for (int64_t n = 0; n < 2 * points; ++n)
  {
    const int32_t first = (int32_t)(n % points), closed = n >= points;
    int64_t to = surface->line_point_count;
    if (ends[first].next < 0 || ends[first].done || (!closed && ends[first].last >= 0))
    {
      continue;
    }
    surface->line_points[to++] = first;
    for (int32_t at = first; ends[at].next >= 0 && !ends[at].done; at = ends[at].next)
    {
      ends[at].done = true;
      surface->line_points[to++] = ends[at].next;
    }
    surface->line_offsets[++surface->line_count] = surface->line_point_count = to;
  }
  return true;
}

/* Returns the area of a triangle; below 0 if it runs round clockwise. */
static double mcor_area_of(const double* a, const double* b, const double* c)
{
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

/* Measures the length, and the area: of the filled region or, if all lines are closed, of what they
 * enclose. Areas of lines count from one of the points. */
static void mcor_measure_lines(mcor_surface* surface)
{
  mcor_statistics* s = &surface->statistics;
  const double* x = surface->points;
  bool closed = surface->line_count > 0;
  s->length = s->area = s->volume = 0;
  for (int64_t l = 0; l < surface->line_count; ++l)
  {
    const int64_t first = surface->line_offsets[l], last = surface->line_offsets[l + 1] - 1;
    closed = closed && surface->line_points[first] == surface->line_points[last];
    for (int64_t i = first; i < last; ++i)
    {
      const double *a = x + 3 * (int64_t)surface->line_points[i],
                   *b = x + 3 * (int64_t)surface->line_points[i + 1];
      const double du = b[0] - a[0], dv = b[1] - a[1];
      s->length += sqrt(du * du + dv * dv);
      s->area += mcor_area_of(x, a, b);
    }
  }
  s->is_closed = closed;
  s->area = closed && !surface->band_value ? s->area : 0;
  for (int64_t t = 0; t < surface->triangle_count && surface->band_value; ++t)
  {
    const int32_t* corner = surface->triangles + 3 * t;
    s->area += mcor_area_of(
      x + 3 * (int64_t)corner[0], x + 3 * (int64_t)corner[1], x + 3 * (int64_t)corner[2]);
  }
}

/* Makes normals, to the right of the lines: at all points of a preview, or if the caller wants it;
 * else only where the gradient vanishes. */
mcor_status mcor_finish_line_normals(mcor_context* context, mcor_surface* surface)
{
  const bool all = context->run.options->preview || context->run.options->triangle_normals;
  mcor_line_ends* all_ends;
  const mcor_status status = mcor_read_lines(context, surface, &all_ends);
  for (int64_t i = 0; i < surface->point_count && status == MCOR_OK; ++i)
  {
    float* n = surface->normals + 3 * i;
    if (!all && (n[0] != 0 || n[1] != 0))
    {
      continue;
    }
    const mcor_line_ends ends = all_ends[i];
    const int64_t from = ends.last >= 0 ? ends.last : i, to = ends.next >= 0 ? ends.next : i;
    const double dx = surface->points[3 * to] - surface->points[3 * from],
                 dy = surface->points[3 * to + 1] - surface->points[3 * from + 1];
    const double length = sqrt(dx * dx + dy * dy);
    n[0] = length > 0 ? (float)(dy / length) : 1;
    n[1] = length > 0 ? (float)(-dx / length) : 0;
    n[2] = 0;
  }
  free(all_ends);
  return status;
}

mcor_status mcor_finish_lines(mcor_context* context, mcor_surface* surface)
{
  const mcor_plane* plane = &context->plane;
  mcor_line_ends* ends;
  mcor_status status = mcor_read_lines(context, surface, &ends);
  MCOR_THEN(status, mcor_allocated(context, mcor_join(ends, surface)));
  free(ends);
  MCOR_TRY(status);
  const bool filled = surface->band_value != NULL;
  int64_t count = 0;
  for (int64_t t = 0; t < surface->triangle_count && filled; ++t)
  {
    if (!mcor_is_line(surface->triangles + 3 * t))
    {
      mcor_move_triangle(surface, t, count++);
    }
  }
  if (!filled)
  {
    free(surface->triangles);
    free(surface->triangle_keys);
    surface->triangles = NULL;
    surface->triangle_keys = NULL;
  }
  surface->triangle_count = count;
  mcor_measure_lines(surface);
  mcor_unflatten_doubles(plane, surface->points, surface->point_count, plane->at);
  mcor_unflatten_doubles(plane, surface->gradients, surface->point_count, 0);
  for (int64_t i = 0; i < surface->point_count && surface->normals; ++i)
  {
    float* n = surface->normals + 3 * i; /* in filled regions, the plane's normal */
    n[0] = filled ? 0 : n[0];
    n[1] = filled ? 0 : n[1];
    n[2] = filled;
    mcor_turn_back(plane, n, sizeof *n);
  }
  return MCOR_OK;
}
