/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Lines on their way out: joined to polylines, with normals where the gradient gives none, and turned back
 * into the caller's coordinates. */

#include "mcor_plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Lines by their points: each point begins one line at most, and ends one. */
typedef struct mcor_joining
{
  int64_t count;        /* of lines */
  int32_t (*ends)[2];   /* [count] */
  int32_t *next, *last; /* [points]: where a line from, to each point leads; -1 */
  bool* done;           /* [points]: the line from it is in a polyline */
} mcor_joining;

static void mcor_free_joining(mcor_joining* j)
{
  free(j->ends);
  free(j->next);
  free(j->last);
  free(j->done);
}

/* Of a line that trimming has cut, two triangles may remain; see mcor_trim_cut. */
static mcor_status mcor_read_lines(
  mcor_context* context, const mcor_surface* surface, mcor_joining* j)
{
  const size_t points = (size_t)surface->point_count, lines = (size_t)surface->triangle_count;
  j->ends = malloc(lines * sizeof *j->ends + 1);
  j->next = malloc(points * sizeof *j->next + 1);
  j->last = malloc(points * sizeof *j->last + 1);
  j->done = calloc(points + 1, sizeof *j->done);
  MCOR_RETURN_IF(!j->ends || !j->next || !j->last || !j->done, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %zu lines could not be allocated.", lines);
  memset(j->next, 0xff, points * sizeof *j->next);
  memset(j->last, 0xff, points * sizeof *j->last);
  for (size_t i = 0; i < lines; ++i)
  {
    const int32_t* t = surface->triangles + 3 * i;
    if (t[0] == t[2])
    {
      continue; /* the second half of a quad that is a line */
    }
    const int32_t from = t[1] == t[2] ? t[0] : t[2], to = t[1];
    j->ends[j->count][0] = from;
    j->ends[j->count++][1] = to;
    j->next[from] = to;
    j->last[to] = from;
  }
  return MCOR_OK;
}

/* Follows the lines from a point; a closed polyline ends with its first point. */
static void mcor_follow_line(mcor_joining* j, int32_t from, mcor_surface* surface)
{
  int32_t* points = surface->line_points;
  int64_t to = surface->line_offsets[surface->line_count];
  points[to++] = from;
  for (int32_t at = from; j->next[at] >= 0 && !j->done[at]; at = j->next[at])
  {
    j->done[at] = true;
    points[to++] = j->next[at];
  }
  surface->line_offsets[++surface->line_count] = surface->line_point_count = to;
}

static mcor_status mcor_join_lines(mcor_context* context, mcor_joining* j, mcor_surface* surface)
{
  const size_t lines = (size_t)j->count;
  surface->line_points = malloc(2 * lines * sizeof *surface->line_points + 1);
  surface->line_offsets = malloc((lines + 1) * sizeof *surface->line_offsets);
  MCOR_RETURN_IF(!surface->line_points || !surface->line_offsets, context, MCOR_OUT_OF_CAPACITY,
    "Host memory for %zu lines could not be allocated.", lines);
  surface->line_offsets[0] = 0;
  /* Open ones from their ends, then closed ones, each from the first of its lines. */
  for (int closed = 0; closed < 2; ++closed)
  {
    for (int64_t i = 0; i < j->count; ++i)
    {
      const int32_t from = j->ends[i][0];
      if (!j->done[from] && (closed || j->last[from] < 0))
      {
        mcor_follow_line(j, from, surface);
      }
    }
  }
  return MCOR_OK;
}

/* Length, and the area that lines enclose if all are closed, about one of the points. */
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
      s->length += sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
      s->area += 0.5 * ((a[0] - x[0]) * (b[1] - x[1]) - (b[0] - x[0]) * (a[1] - x[1]));
    }
  }
  s->is_closed = closed;
  s->area = closed ? s->area : 0;
}

/* Normals from lines, which point to their right: of all points in a preview, else where the gradient
 * vanishes. The lengths of lines weigh them. */
static void mcor_line_normals(
  const mcor_context* context, const mcor_joining* j, mcor_surface* surface)
{
  const bool all = context->run.options->preview || context->run.options->triangle_normals;
  for (int64_t i = 0; i < surface->point_count && surface->normals; ++i)
  {
    float* n = surface->normals + 3 * i;
    if (!all && (n[0] != 0 || n[1] != 0))
    {
      continue;
    }
    const int64_t from = j->last[i] >= 0 ? j->last[i] : i, to = j->next[i] >= 0 ? j->next[i] : i;
    const double dx = surface->points[3 * to] - surface->points[3 * from],
                 dy = surface->points[3 * to + 1] - surface->points[3 * from + 1];
    const double length = sqrt(dx * dx + dy * dy);
    n[0] = length > 0 ? (float)(dy / length) : 1;
    n[1] = length > 0 ? (float)(-dx / length) : 0;
    n[2] = 0;
  }
}

mcor_status mcor_finish_lines(mcor_context* context, mcor_surface* surface)
{
  const mcor_plane* plane = &context->plane;
  mcor_joining joining = { 0 };
  mcor_status status = mcor_read_lines(context, surface, &joining);
  status = status == MCOR_OK ? mcor_join_lines(context, &joining, surface) : status;
  if (status == MCOR_OK)
  {
    mcor_line_normals(context, &joining, surface);
    mcor_measure_lines(surface);
    mcor_unflatten_doubles(plane, surface->points, surface->point_count, plane->at);
    mcor_unflatten_doubles(plane, surface->gradients, surface->point_count, 0);
    mcor_unflatten_floats(plane, surface->normals, surface->point_count);
    free(surface->triangles);
    free(surface->triangle_keys);
    surface->triangles = NULL;
    surface->triangle_keys = NULL;
    surface->triangle_count = 0;
  }
  mcor_free_joining(&joining);
  return status;
}
