/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_period.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double period_length(const mcor_options* options, int axis)
{
  return options->periodic[2 * axis + 1] - options->periodic[2 * axis];
}

int oracle_is_periodic(const mcor_options* options)
{
  return period_length(options, 0) > 0.0 || period_length(options, 1) > 0.0 ||
    period_length(options, 2) > 0.0;
}

/* ---- the cube size ---- */

static double period_fit_cube(const mcor_options* options, double cube)
{
  double best = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = period_length(options, axis);
    for (double n = 1.0; length > 0.0 && length / n > 0.5 * cube; n += 1.0)
    {
      const double trial = length / n;
      int fits = trial <= cube * (1.0 + 1e-9) && trial > best;
      for (int other = 0; other < 3; ++other)
      {
        const double cubes = period_length(options, other) / trial;
        fits = fits && fabs(cubes - round(cubes)) <= 1e-9 * cubes;
      }
      best = fits ? trial : best;
    }
  }
  return best;
}

void oracle_fit_edges(const mcor_options* options, double cube, double edge[3])
{
  const double fitted = oracle_is_periodic(options) ? period_fit_cube(options, cube) : cube;
  double longest = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = fmax(period_length(options, axis), 0.0);
    edge[axis] = fitted;
    if (fitted == 0.0 && length > 0.0)
    {
      edge[axis] = length / ceil(length / cube * (1.0 - 1e-9));
    }
    longest = fmax(longest, edge[axis]);
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    edge[axis] = edge[axis] > 0.0 ? edge[axis] : longest;
  }
}

/* ---- particles ---- */

int64_t* oracle_add_images(
  particle_set* particles, const mcor_options* options, double support, double margin, double cube)
{
  const int64_t own = particles->count;
  int64_t capacity = own;
  int64_t* source = oracle_allocate(own, sizeof(int64_t));
  for (int64_t i = 0; i < 3 * own; ++i) /* moves each coordinate into the period */
  {
    const double length = period_length(options, (int)(i % 3));
    double* x = &particles->position[i];
    *x -= length > 0.0 ? floor((*x - options->periodic[2 * (i % 3)]) / length) * length : 0.0;
  }
  for (int64_t p = 0; p < own; ++p)
  {
    const double reach = fmax(support * particles->smoothing_length[p], margin) + 2.0 * cube;
    source[p] = p;
    for (int n = 0; n < 343; ++n)
    {
      const int image[3] = { n % 7 - 3, n / 7 % 7 - 3, n / 49 - 3 };
      int matters = n != 171; /* the particle itself always matters */
      double x[3];
      for (int axis = 0; axis < 3; ++axis)
      {
        const double *side = &options->periodic[2 * axis], length = period_length(options, axis);
        x[axis] = particles->position[3 * p + axis] + image[axis] * length;
        matters = matters &&
          (length > 0.0 ? x[axis] >= side[0] - reach && x[axis] <= side[1] + reach
                        : image[axis] == 0);
      }
      if (matters)
      {
        source = oracle_grow(source, particles->count, &capacity, sizeof(int64_t));
        source[particles->count] = p;
        particle_set_append(particles, particles, p);
        memcpy(&particles->position[3 * (particles->count - 1)], x, sizeof(x));
      }
    }
  }
  return source;
}

void oracle_own_period(
  const mcor_options* options, const double edge[3], int64_t first[3], int64_t end[3])
{
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = period_length(options, axis);
    if (length > 0.0)
    {
      first[axis] = (int64_t)ceil(options->periodic[2 * axis] / edge[axis] - 0.5);
      end[axis] = first[axis] + (int64_t)round(length / edge[axis]);
    }
  }
}

/* ---- joining the surface with itself ---- */

/* A point of the surface's border, moved into the first period. at: its place, as whole multiples of 2^-27 of a cube's
 * edge, so that rounding errors do not show. */
typedef struct seam_point
{
  int64_t at[3];
  int32_t point;
} seam_point;

typedef struct seam_edge
{
  int32_t a, b; /* the points that stand for the ends, a < b */
  int forward, flagged;
} seam_edge;

static int seam_compare_points(const void* x, const void* y)
{
  const seam_point *p = x, *q = y;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (p->at[axis] != q->at[axis])
    {
      return p->at[axis] < q->at[axis] ? -1 : 1;
    }
  }
  return (p->point > q->point) - (p->point < q->point);
}

static int seam_compare_edges(const void* x, const void* y)
{
  const seam_edge *p = x, *q = y;
  return p->a != q->a ? (p->a < q->a ? -1 : 1) : (p->b > q->b) - (p->b < q->b);
}

static seam_point seam_place(
  const mcor_options* options, const double edge[3], const mcor_surface* surface, int32_t point)
{
  seam_point place = { { 0 }, point };
  int64_t first[3] = { 0 }, end[3] = { 0 };
  oracle_own_period(options, edge, first, end);
  for (int axis = 0; axis < 3; ++axis)
  {
    const double low = (double)first[axis], cubes = (double)(end[axis] - first[axis]);
    double u = surface->points[3 * (int64_t)point + axis] / edge[axis];
    u -= cubes > 0.0 ? floor((u - low + 1e-9) / cubes) * cubes : 0.0;
    place.at[axis] = (int64_t)floor((u - low) * 0x1p27 + 0.5);
  }
  return place;
}

static int seam_differ(const float* values, int32_t a, int32_t b, size_t components)
{
  return values &&
    memcmp(&values[components * (size_t)a], &values[components * (size_t)b],
      components * sizeof(float)) != 0;
}

/* Returns whether two joined points differ in any array, or in a coordinate by anything but a period. */
static int seam_points_differ(
  const mcor_options* options, const mcor_surface* s, int32_t a, int32_t b)
{
  int differ = seam_differ(s->normals, a, b, 3) || seam_differ(s->weight_sum, a, b, 1) ||
    seam_differ(s->boundary_eigenvalue, a, b, 1) || seam_differ(s->residual, a, b, 1) ||
    seam_differ(s->correction_length, a, b, 1) ||
    (s->boundary_flag && s->boundary_flag[a] != s->boundary_flag[b]);
  for (int axis = 0; axis < 3; ++axis)
  {
    const double x = s->points[3 * (int64_t)a + axis], y = s->points[3 * (int64_t)b + axis];
    const double length = period_length(options, axis);
    differ = differ || (x != y && !(length > 0.0 && fabs(x - y) > 0.5 * length)) ||
      (s->gradients && s->gradients[3 * (int64_t)a + axis] != s->gradients[3 * (int64_t)b + axis]);
  }
  return differ;
}

/* Sets one[p]: the one point that stands for all points joined with p. */
static void seam_glue(const mcor_options* options, const mcor_surface* surface, seam_point* places,
  int64_t count, int32_t* one, oracle_seam* seam)
{
  qsort(places, (size_t)count, sizeof(*places), seam_compare_points);
  for (int64_t n = 0; n < count; ++n)
  {
    const seam_point* before = n > 0 ? &places[n - 1] : NULL;
    const int32_t point = places[n].point;
    if (before && before->point == point)
    {
      continue;
    }
    one[point] = point;
    if (before && memcmp(before->at, places[n].at, sizeof(before->at)) == 0)
    {
      one[point] = one[before->point];
      seam->different += seam_points_differ(options, surface, one[point], point);
    }
  }
}

static void seam_count(seam_edge* edges, int64_t count, oracle_seam* seam)
{
  qsort(edges, (size_t)count, sizeof(*edges), seam_compare_edges);
  for (int64_t first = 0, next = 0; first < count; first = next)
  {
    int forward = 0;
    for (next = first;
         next < count && edges[next].a == edges[first].a && edges[next].b == edges[first].b; ++next)
    {
      forward += edges[next].forward;
    }
    const int64_t sides = next - first;
    seam->joined += sides == 2;
    seam->open += sides == 1 && !edges[first].flagged;
    seam->torn += sides > 2 || (sides == 2 && forward != 1);
  }
}

oracle_seam oracle_check_seam(const mcor_options* options, const double edge[3],
  const mcor_surface* surface, const mesh_report* mesh)
{
  const int64_t n = mesh->boundary_edges;
  seam_edge* edges = oracle_allocate(n, sizeof(*edges));
  seam_point* places = oracle_allocate(2 * n, sizeof(*places));
  int32_t* one = oracle_allocate(surface->point_count, sizeof(*one));
  int64_t count = 0;
  oracle_seam seam = { 0 };
  for (int64_t s = 0; s < mesh->side_count; ++s)
  {
    const mesh_edge* side = &mesh->side[s];
    if (side->sharing == 1)
    {
      const uint8_t* flag = surface->boundary_flag;
      edges[count] =
        (seam_edge){ side->a, side->b, side->forward, flag && flag[side->a] && flag[side->b] };
      places[2 * count] = seam_place(options, edge, surface, side->a);
      places[2 * count + 1] = seam_place(options, edge, surface, side->b);
      ++count;
    }
  }
  seam_glue(options, surface, places, 2 * count, one, &seam);
  for (int64_t e = 0; e < count; ++e)
  {
    const int32_t a = one[edges[e].a], b = one[edges[e].b];
    edges[e].forward = (edges[e].forward != 0) == (a < b);
    edges[e].a = a < b ? a : b;
    edges[e].b = a < b ? b : a;
  }
  seam_count(edges, count, &seam);
  free(edges);
  free(places);
  free(one);
  return seam;
}
