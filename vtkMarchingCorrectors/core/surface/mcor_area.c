/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Area and volume of the whole surface, or of parts of it that are added up later. Each term is
 * rounded to a unit in which the sums are exact. The sums are therefore the same to the last bit
 * in any order, and however the triangles are spread over ranks. */

#include "mcor_internal.h"
#include "mcor_parallel.h"
#include "mcor_vector.h"

/* Hashes an edge. A closed surface runs through each edge once each way, so the sum of the
 * signed hashes is 0. Of a surface with a hole it is 0 by chance once in 2^64. Multiples of the
 * golden ratio keep pairs of numbers apart. */
static inline uint64_t mcor_edge_number(int64_t low, int64_t high)
{
  uint64_t x = (uint64_t)low * 0x9E3779B97F4A7C15u + (uint64_t)high;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/* Adds a triangle's area, and its volume about the origin. */
static inline void mcor_measure_triangle(
  const mcor_surface* surface, const double origin[3], int64_t t, double* area, double* volume)
{
  double c[3][3], u[3], v[3], n[3];
  for (int i = 0; i < 3; ++i)
  {
    mcor_subtract(surface->points + 3 * (int64_t)surface->triangles[3 * t + i], origin, c[i]);
  }
  mcor_subtract(c[1], c[0], u);
  mcor_subtract(c[2], c[0], v);
  mcor_cross(u, v, n);
  *area = 0.5 * sqrt(mcor_dot(n, n));
  *volume = mcor_dot(c[0], n) / 6;
}

/* Finds a power of two that leaves 53 bits for the sum of so many terms. */
static double mcor_exact_unit(double most, int64_t count)
{
  const double bound = most * (double)count;
  return bound > 0 && bound < 1e300 ? ldexp(1, ilogb(bound) + 1 - 53) : 1;
}

/* Rounds to a multiple of the unit whose 1.5 * 2^52 multiple is `large`. */
static inline double mcor_round_term(double term, double large)
{
  return (term + large) - large;
}

/* Sums of each slice of the triangles, as exact as the sums over parts. */
typedef struct mcor_measure_job
{
  const mcor_surface* surface;
  const int64_t* numbers;
  const mcor_measures* all;
  mcor_measures slices[MCOR_SLICES];
} mcor_measure_job;

static void mcor_terms_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_measure_job* job = data;
  double areas = 0, volumes = 0; /* the largest */
  for (int64_t t = first; t < last; ++t)
  {
    double area, volume;
    mcor_measure_triangle(job->surface, job->all->origin, t, &area, &volume);
    areas = area > areas ? area : areas;
    volumes = fabs(volume) > volumes ? fabs(volume) : volumes;
  }
  job->slices[slice] = (mcor_measures){ .area_most = areas, .volume_most = volumes };
}

static void mcor_sums_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_measure_job* job = data;
  const mcor_measures* all = job->all;
  const int64_t* numbers = job->numbers;
  const double large_area = 0x1.8p52 * mcor_exact_unit(all->area_most, all->triangle_count);
  const double large_volume = 0x1.8p52 * mcor_exact_unit(all->volume_most, all->triangle_count);
  double areas = 0, volumes = 0;
  uint64_t open = 0;
  for (int64_t t = first; t < last; ++t)
  {
    const int32_t* triangle = job->surface->triangles + 3 * t;
    double area, volume;
    mcor_measure_triangle(job->surface, all->origin, t, &area, &volume);
    areas += mcor_round_term(area, large_area);
    volumes += mcor_round_term(volume, large_volume);
    for (int i = 0; i < 3; ++i)
    {
      const int64_t p = triangle[i], q = triangle[(i + 1) % 3];
      const int64_t a = numbers ? numbers[p] : p, b = numbers ? numbers[q] : q;
      open += a < b ? mcor_edge_number(a, b) : 0 - mcor_edge_number(b, a);
    }
  }
  job->slices[slice] = (mcor_measures){ .area = areas, .volume = volumes, .open = (int64_t)open };
}

/* Adds up the sums of all slices, and finds the largest of their terms. context: NULL outside of a
 * call. */
static mcor_status mcor_measure_slices(mcor_context* context, const mcor_surface* surface,
  const int64_t* numbers, mcor_slice_body slice, mcor_measures* measures)
{
  mcor_measure_job job = { .surface = surface, .numbers = numbers, .all = measures };
  int slices;
  uint64_t open = 0;
  MCOR_TRY(
    mcor_parallel_run(context, surface->triangle_count, MCOR_HEAVY_GRAIN, slice, &job, &slices));
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
  mcor_measure_slices(NULL, surface, NULL, mcor_terms_slice, measures);
}

void mcor_measure_sums(const mcor_surface* surface, const int64_t* numbers, mcor_measures* measures)
{
  mcor_measure_slices(NULL, surface, numbers, mcor_sums_slice, measures);
}

void mcor_keep_measures(const mcor_measures* measures, mcor_statistics* statistics)
{
  statistics->is_closed = measures->open == 0 && measures->triangle_count > 0;
  statistics->area = measures->area;
  statistics->volume = statistics->is_closed ? measures->volume : 0;
}

/* Takes volumes about one of the points, since coordinates may be large. Lines are measured
 * where they are joined. */
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
  MCOR_TRY(mcor_measure_slices(context, surface, NULL, mcor_terms_slice, &measures));
  MCOR_TRY(mcor_measure_slices(context, surface, NULL, mcor_sums_slice, &measures));
  mcor_keep_measures(&measures, &surface->statistics);
  return MCOR_OK;
}
