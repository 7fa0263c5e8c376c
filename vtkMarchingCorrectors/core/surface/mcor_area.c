/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Normals, area and volume of triangles [III-D.4].
 *
 * Area and volume are of the whole surface, or of parts whose sums are added later. Each term is
 * rounded to a unit in which the sums are exact. Therefore the sums have the same bits in any
 * order, and for any distribution of the triangles over ranks. */

#include "mcor_internal.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

#include <stdlib.h>

/* Returns a hash of an edge. In a closed surface, triangles use each edge once in each direction,
 * so the sum of the signed hashes is 0. With a hole, the sum is 0 only by chance, once in 2^64.
 * Multiples of the golden ratio distinguish pairs of numbers. */
static inline uint64_t mcor_edge_number(int64_t low, int64_t high)
{
  uint64_t x = (uint64_t)low * 0x9E3779B97F4A7C15u + (uint64_t)high;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/* Returns a unit, a power of two, in which a sum of `count` terms up to `most` needs at most 53
 * bits. */
static double mcor_exact_unit(double most, int64_t count)
{
  const double bound = most * (double)count;
  return bound > 0 && bound < 1e300 ? ldexp(1, ilogb(bound) + 1 - 53) : 1;
}

/* Rounds to a multiple of the unit. large: 1.5 * 2^52 units. */
static inline double mcor_round_term(double term, double large)
{
  return (term + large) - large;
}

/* Measures triangles in slices. A first job finds the largest area and volume of a triangle, which
 * decide the units of exact sums. A second job, with `sums` and these in `all`, finds the sums. */
typedef struct mcor_measure_job
{
  const mcor_surface* surface;
  const int64_t* numbers;
  bool sums;
  const mcor_measures* all;
  mcor_measures slices[MCOR_SLICES];
} mcor_measure_job;

static void mcor_measure_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_measure_job* job = data;
  const mcor_measures* all = job->all;
  const int64_t* numbers = job->numbers;
  const double large_area = 0x1.8p52 * mcor_exact_unit(all->area_most, all->triangle_count);
  const double large_volume = 0x1.8p52 * mcor_exact_unit(all->volume_most, all->triangle_count);
  mcor_measures found = { .area = 0 };
  uint64_t open = 0;
  for (int64_t t = first; t < last; ++t)
  {
    const int32_t* triangle = job->surface->triangles + 3 * t;
    double c[3][3], u[3], v[3], n[3];
    for (int i = 0; i < 3; ++i)
    {
      mcor_subtract(job->surface->points + 3 * (int64_t)triangle[i], all->origin, c[i]);
    }
    mcor_subtract(c[1], c[0], u);
    mcor_subtract(c[2], c[0], v);
    mcor_cross(u, v, n);
    /* Volume of the tetrahedron between the triangle and the origin. */
    const double area = 0.5 * sqrt(mcor_dot(n, n)), volume = mcor_dot(c[0], n) / 6;
    found.area_most = area > found.area_most ? area : found.area_most;
    found.volume_most = fabs(volume) > found.volume_most ? fabs(volume) : found.volume_most;
    found.area += mcor_round_term(area, large_area);
    found.volume += mcor_round_term(volume, large_volume);
    for (int i = 0; i < 3 && job->sums; ++i)
    {
      const int64_t p = triangle[i], q = triangle[(i + 1) % 3];
      const int64_t a = numbers ? numbers[p] : p, b = numbers ? numbers[q] : q;
      open += a < b ? mcor_edge_number(a, b) : 0 - mcor_edge_number(b, a);
    }
  }
  found.open = (int64_t)open;
  job->slices[slice] = found;
}

/* Finds the largest terms of all slices. If `sums` is set, finds the sums of the terms; `measures`
 * must then have the largest terms of all parts. context: NULL outside of a call. */
static mcor_status mcor_measure_slices(mcor_context* context, const mcor_surface* surface,
  const int64_t* numbers, bool sums, mcor_measures* measures)
{
  mcor_measure_job job = { .surface = surface, .numbers = numbers, .sums = sums, .all = measures };
  int slices;
  uint64_t open = 0;
  MCOR_TRY(mcor_parallel_run(
    context, surface->triangle_count, MCOR_HEAVY_GRAIN, mcor_measure_slice, &job, &slices));
  measures->area = measures->volume = 0;
  for (int i = 0; i < slices; ++i)
  {
    measures->area_most = fmax(measures->area_most, job.slices[i].area_most);
    measures->volume_most = fmax(measures->volume_most, job.slices[i].volume_most);
    measures->area += job.slices[i].area;
    measures->volume += job.slices[i].volume;
    open += (uint64_t)job.slices[i].open;
  }
  measures->open = (int64_t)open;
  return MCOR_OK;
}

void mcor_measure_terms(const mcor_surface* surface, mcor_measures* measures)
{
  measures->triangle_count = surface->triangle_count;
  measures->area_most = measures->volume_most = 0;
  mcor_measure_slices(NULL, surface, NULL, false, measures);
}

void mcor_measure_sums(const mcor_surface* surface, const int64_t* numbers, mcor_measures* measures)
{
  mcor_measure_slices(NULL, surface, numbers, true, measures);
}

void mcor_keep_measures(const mcor_measures* measures, mcor_statistics* statistics)
{
  statistics->is_closed = measures->open == 0 && measures->triangle_count > 0;
  statistics->area = measures->area;
  statistics->volume = statistics->is_closed ? measures->volume : 0;
}

/* The volume is the sum of the tetrahedra from one point to all triangles. This point is the
 * surface's first point, because the coordinates' origin may be far away. Lines are measured in
 * mcor_plane.c. */
mcor_status mcor_measure_surface(mcor_context* context, mcor_surface* surface)
{
  mcor_measures measures = { .triangle_count = surface->triangle_count };
  if (surface->line_offsets)
  {
    return MCOR_OK;
  }
  for (int d = 0; d < 3 && surface->point_count > 0; ++d)
  {
    measures.origin[d] = surface->points[d];
  }
  MCOR_TRY(mcor_measure_slices(context, surface, NULL, false, &measures));
  MCOR_TRY(mcor_measure_slices(context, surface, NULL, true, &measures));
  mcor_keep_measures(&measures, &surface->statistics);
  return MCOR_OK;
}

/* ---- Normals ---- */

/* Triangles between two progress reports. */
#define MCOR_NORMAL_STEP (1 << 18)

/* Makes normals from triangles. In a preview, or with triangle_normals, makes the normals of all
 * points, else only of points where the gradient vanishes. A triangle adds the cross product of two
 * of its edges, so it counts by its area. Runs on one thread: the order in which a point's
 * triangles are added must not change. */
mcor_status mcor_finish_normals(mcor_context* context, mcor_surface* surface)
{
  const bool all = context->run.options->preview || context->run.options->triangle_normals;
  int exponent = 0;
  frexp(context->lattice.cube, &exponent);
  const double scale = ldexp(1, -exponent); /* scales lengths to about 1 */
  if (!all && context->run.normals_lacking == 0)
  {
    return MCOR_OK;
  }
  double* sums = calloc((size_t)surface->point_count * 3 + 1, sizeof *sums);
  mcor_status status = mcor_allocated(context, sums);
  for (int64_t i = 0; i < surface->triangle_count && status == MCOR_OK; ++i)
  {
    const int32_t* t = surface->triangles + 3 * i;
    double u[3], v[3], n[3];
    for (int a = 0; a < 3; ++a)
    {
      const double corner = surface->points[3 * (int64_t)t[0] + a];
      u[a] = (surface->points[3 * (int64_t)t[1] + a] - corner) * scale;
      v[a] = (surface->points[3 * (int64_t)t[2] + a] - corner) * scale;
    }
    mcor_cross(u, v, n);
    for (int c = 0; c < 9; ++c)
    {
      sums[3 * (int64_t)t[c / 3] + c % 3] += n[c % 3];
    }
    status = i % MCOR_NORMAL_STEP == 0 ? mcor_report_launch(context) : MCOR_OK;
  }
  for (int64_t i = 0; i < surface->point_count && status == MCOR_OK; ++i)
  {
    float* n = surface->normals + 3 * i;
    const double *s = sums + 3 * i, length = sqrt(mcor_dot(s, s));
    const bool wanted = all || mcor_lacks_normal(n);
    for (int a = 0; a < 3 && wanted; ++a)
    {
      n[a] = length > 0 ? (float)(s[a] / length) : (a == 2 ? 1.0f : 0.0f);
    }
  }
  free(sums);
  return status;
}
