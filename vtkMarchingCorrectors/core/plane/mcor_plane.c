/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Two dimensions: turns coordinates into the plane and back; joins lines to polylines, and makes
 * their normals if the gradient gives none. In surface->triangles, a line is a triangle with two
 * equal corners. Triangles of filled regions come after the lines. */

#include "mcor_plane.h"
#include "mcor_adaptive.h"
#include "mcor_input.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Turning ---- */

typedef struct mcor_flatten_job
{
  const mcor_plane* plane;
  mcor_array positions;
  bool are_points; /* `positions` are points, which may lie off the plane */
  double* flat;
} mcor_flatten_job;

static void mcor_flatten_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_flatten_job* job = data;
  double x[MCOR_CHUNK];
  for (int64_t begin = first; begin < last; begin += MCOR_CHUNK)
  {
    const int count = mcor_chunk_of(last - begin);
    for (int a = 0; a < 3; ++a)
    {
      mcor_read_array(&job->positions, begin, count, mcor_plane_axis(job->plane, a), x);
      for (int i = 0; i < count; ++i)
      {
        const bool off = job->are_points && x[i] != job->plane->at;
        job->flat[3 * (begin + i) + a] = a < 2 ? x[i] : off ? NAN : 0;
      }
    }
  }
  (void)slice;
}

void mcor_flatten_sides(const mcor_plane* plane, const double from[6], double to[6])
{
  double sides[6];
  for (int i = 0; i < 6; ++i)
  {
    sides[i] = from[2 * mcor_plane_axis(plane, i / 2) + i % 2];
  }
  if (mcor_has_sides(from) && !isnan(sides[4]) && !isnan(sides[5]) && sides[4] <= sides[5])
  {
    /* A flat box contains the plane in which it lies. */
    const bool inside = sides[4] <= plane->at && (plane->at < sides[5] || plane->at == sides[4]);
    sides[4] = inside ? -INFINITY : DBL_MAX;
    sides[5] = INFINITY;
  }
  memcpy(to, sides, sizeof sides);
}

mcor_status mcor_flatten_positions(mcor_context* context, const mcor_array* positions,
  int64_t count, bool are_points, mcor_array* turned, double** flat)
{
  *flat = malloc((size_t)count * 3 * sizeof(double) + 1);
  MCOR_FAIL_IF(!*flat, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(HOST_MEMORY_FOR), (long long)count,
    are_points ? "points" : "particles");
  mcor_flatten_job job = { &context->plane, *positions, are_points, *flat };
  job.positions.components = 3;
  mcor_parallel_for(context, count, MCOR_LIGHT_GRAIN, mcor_flatten_slice, &job);
  *turned = (mcor_array){ .data = *flat, .type = MCOR_FLOAT64, .components = 3 };
  return MCOR_OK;
}

mcor_status mcor_flatten(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat)
{
  const mcor_plane* plane = &context->plane;
  mcor_options* o = &flat->options;
  MCOR_FAIL_IF(options->capping && options->filled, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(CAPPING_WITH_FILLED));
  if (options->filled) /* pairs may miss lines that bound a filled region */
  {
    o->seeds = MCOR_COMPLETE;
    o->level_limit = 0;
    o->outputs |= MCOR_OUT_ISO_VALUE;
  }
  mcor_flatten_sides(plane, options->box, o->box);
  for (int i = 0; i < 6; ++i) /* a period across the plane has no meaning */
  {
    o->periodic[i] = i < 4 ? options->periodic[2 * mcor_plane_axis(plane, i / 2) + i % 2] : 0;
  }
  o->outputs &= ~(unsigned)MCOR_OUT_GAUSS_CURVATURE; /* lines have no Gaussian curvature */
  if (options->globals)
  {
    flat->globals = *options->globals;
    mcor_turn_measure(&flat->globals.measured, false);
    o->globals = &flat->globals;
  }
  if (options->ranks)
  {
    flat->ranks = *options->ranks;
    mcor_flatten_sides(plane, options->ranks->whole_box, flat->ranks.whole_box);
    o->ranks = &flat->ranks;
  }
  const bool is_flat = plane->axis == 3 && plane->at == 0;
  return is_flat || !mcor_has_positions(input)
    ? MCOR_OK
    : mcor_flatten_positions(
        context, &input->positions, input->count, false, &flat->input.positions, &flat->positions);
}

/* Turns three numbers of `width` bytes back to the caller's axes, in place. */
static void mcor_turn_back(const mcor_plane* plane, void* numbers, size_t width)
{
  char from[3 * sizeof(double)], *to = numbers;
  memcpy(from, numbers, 3 * width);
  for (int a = 0; a < 3; ++a)
  {
    memcpy(to + (size_t)mcor_plane_axis(plane, a) * width, from + (size_t)a * width, width);
  }
}

void mcor_unflatten_doubles(
  const mcor_plane* plane, double* numbers, int64_t count, double constant)
{
  for (int64_t i = 0; i < count && numbers && plane->axis > 0; ++i)
  {
    numbers[3 * i + 2] = constant;
    mcor_turn_back(plane, numbers + 3 * i, sizeof *numbers);
  }
}

/* Exchanges the axes of edges and ranges. Along the plane's normal, x_low and x_high become the
 * plane's coordinate (0 in its own axes); low and high lie the largest support away from it. */
void mcor_turn_measure(mcor_measure* measure, bool back)
{
  const mcor_measure from = *measure;
  const double at = back ? from.plane.at : 0;
  for (int a = 0; a < 3 && from.plane.axis > 0; ++a)
  {
    const int axis = mcor_plane_axis(&from.plane, a), f = back ? a : axis, t = back ? axis : a;
    measure->low[t] = a < 2 ? from.low[f] : at - from.support_max;
    measure->high[t] = a < 2 ? from.high[f] : at + from.support_max;
    measure->x_low[t] = a < 2 ? from.x_low[f] : at;
    measure->x_high[t] = a < 2 ? from.x_high[f] : at;
    measure->edge[t] = from.edge[f];
    measure->cut_high[t] = a < 2 ? from.cut_high[f] : at + from.support_max;
  }
}

void mcor_unflatten_statistics(const mcor_plane* plane, mcor_statistics* s)
{
  if (plane->axis == 0)
  {
    return;
  }
  mcor_turn_back(plane, s->fluid_extent, sizeof *s->fluid_extent);
  mcor_turn_back(plane, s->far_place, sizeof *s->far_place);
  s->far_place[plane->axis - 1] = plane->at;
  mcor_turn_back(plane, s->lattice_origin, sizeof *s->lattice_origin);
  mcor_turn_back(plane, s->lattice_cells, sizeof *s->lattice_cells);
}

/* ---- Marching squares, see mcor_plane.cl ---- */

mcor_status mcor_keep_squares(mcor_context* context, mcor_buffer* cells)
{
  const int count = context->bricks.now.count;
  return !mcor_is_plane(context) ? MCOR_OK
                                 : MCOR_LAUNCH(context, "mcor_plane_squares", MCOR_LIGHT, count,
                                     MCOR_INT(count), MCOR_BUFFER(cells));
}

/* ---- Lines ---- */

/* The lines at a point. At most one line begins here, and at most one ends here. next: where the
 * line that begins here ends; last: where the line that ends here begins; -1: no such line. */
typedef struct mcor_line_ends
{
  int32_t next, last;
  bool done; /* the line that begins here is already in a polyline */
} mcor_line_ends;

/* Whether a triangle stands for a line: two of its corners are the same. Other triangles belong to
 * filled regions. */
static bool mcor_is_line(const int32_t* t)
{
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/* Writes to *ends, [point_count], the ends of lines at each point. If trimming left two triangles
 * of one line (see mcor_trim_cut), skips one. The caller frees *ends, even after a failure. */
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
    if (t[0] != t[2] && mcor_is_line(t)) /* skips the second half of a quad of one line */
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

/* Returns the area of a triangle; below 0 if its corners run clockwise. */
static double mcor_area_of(const double* a, const double* b, const double* c)
{
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

/* Measures the length and the area. The area is that of the filled region; without filling, the
 * area that the lines enclose, or 0 if a line is open. Each line adds the signed area of the
 * triangle that it forms with the surface's first point. */
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

/* Makes normals from lines, to the right of the lines. In a preview, or with triangle_normals,
 * makes the normals of all points, else only of points where the gradient vanishes. */
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
