/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Turns sections into triangles or, in two dimensions, into lines. */

#include "mcor_flux.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <string.h>

/* A disc becomes a polygon with the disc's area. The corners are MCOR_DISC_RADIUS radii away from
 * the centre; the angle between successive corners has this cosine and sine. */
#define MCOR_DISC_CORNERS 128
#define MCOR_DISC_RADIUS 1.0002008339103527
#define MCOR_DISC_COSINE 0.9987954562051724
#define MCOR_DISC_SINE 0.049067674327418015

/* Returns -1 if the triangles form a closed surface with normals inwards, else 1. */
static double mcor_orientation(const double* points, int64_t count)
{
  double volume = 0;
  uint64_t open = 0; /* 0 if each edge occurs as often in one direction as in the other */
  for (int64_t i = 0; i < count; i += 3)
  {
    double corner[3][3], product[3];
    uint64_t hash[3];
    for (int c = 0; c < 3; ++c)
    {
      for (int a = 0; a < 3; ++a)
      {
        corner[c][a] = points[3 * (i + c) + a] - points[a] + 0.0; /* -0 becomes 0 */
      }
      hash[c] = mcor_hash_position(corner[c]);
    }
    mcor_cross(corner[1], corner[2], product);
    volume += mcor_dot(corner[0], product);
    for (int c = 0; c < 3; ++c)
    {
      const uint64_t from = hash[c], to = hash[(c + 1) % 3];
      open += from * to * (from - to);
    }
  }
  return open == 0 && volume < 0 ? -1 : 1;
}

mcor_label mcor_label_section(const mcor_flux_job* job, int64_t number)
{
  return mcor_label_of(job->sections[number].name, number);
}

/* Appends to section `number` the triangle x, y, z or, if y = z, the line from x to y. Corners and
 * normal are in the caller's coordinates. normal: has length 1. */
static mcor_status mcor_add_triangle(mcor_flux_job* job, int64_t number, const double x[3],
  const double y[3], const double z[3], const double normal[3])
{
  const double* corners[3] = { x, y, z };
  mcor_flux_piece piece = { .section = number };
  for (int i = 0; i < 9; ++i)
  {
    const int c = i / 3, a = i % 3;
    const double at = corners[c][mcor_plane_axis(job->plane, a)] - (a == 2 ? job->plane->at : 0);
    piece.corner[c][a] = at;
    mcor_add_range(&job->base.around, a, at, at);
  }
  for (int c = 0, axis = 0; axis < 3; ++axis)
  {
    /* A velocity of two components lacks the component across the plane. */
    if (job->velocity_components == 3 || axis != job->across)
    {
      piece.normal[c++] = normal[axis];
    }
  }
  mcor_measure_piece(job, &piece);
  job->found[number].area += piece.size;
  MCOR_APPEND(job->base.context, &job->pieces, piece);
  return MCOR_OK;
}

static mcor_status mcor_leaves_plane(const mcor_flux_job* job, int64_t number)
{
  return mcor_fail(job->base.context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_OUT_OF_PLANE),
    mcor_label_section(job, number).text, 'x' + job->across, job->plane->at);
}

/* Appends the line from `corner` to corner + along. */
static mcor_status mcor_add_line(mcor_flux_job* job, int64_t number, const double corner[3],
  const double along[3], const double normal[3])
{
  const double end[3] = { corner[0] + along[0], corner[1] + along[1], corner[2] + along[2] };
  return mcor_add_triangle(job, number, corner, end, end, normal);
}

/* Appends a rectangle or, in two dimensions, the line along which the rectangle crosses the plane,
 * if it does. Fails in two dimensions unless one edge is parallel to the plane and the other edge
 * is perpendicular to the plane. */
static mcor_status mcor_add_rectangle(mcor_flux_job* job, int64_t number, const double corner[3],
  const double edges[2][3], const double normal[3])
{
  if (!job->is_plane)
  {
    double ends[3][3]; /* of both edges, and of their sum */
    for (int a = 0; a < 3; ++a)
    {
      ends[0][a] = corner[a] + edges[0][a];
      ends[1][a] = corner[a] + edges[1][a];
      ends[2][a] = ends[0][a] + edges[1][a];
    }
    MCOR_TRY(mcor_add_triangle(job, number, corner, ends[0], ends[1], normal));
    return mcor_add_triangle(job, number, ends[2], ends[1], ends[0], normal);
  }
  const int w = job->across, u = (w + 1) % 3, v = (w + 2) % 3;
  const double at = job->plane->at;
  for (int e = 0; e < 2; ++e)
  {
    const double *line = edges[e], *through = edges[1 - e];
    if (line[w] == 0 && through[u] == 0 && through[v] == 0 && (line[u] != 0 || line[v] != 0))
    {
      const double low = corner[w] + fmin(through[w], 0), high = corner[w] + fmax(through[w], 0);
      double begin[3] = { corner[0], corner[1], corner[2] };
      begin[w] = at;
      return low <= at && at <= high ? mcor_add_line(job, number, begin, line, normal) : MCOR_OK;
    }
  }
  return mcor_leaves_plane(job, number);
}

/* Finds the edges that begin at a triangle's first corner, and the triangle's unit normal times
 * `sign`. Returns false if the triangle has no area. */
static bool mcor_find_edges(const double x[9], double sign, double edges[2][3], double normal[3])
{
  mcor_subtract(x + 3, x, edges[0]);
  mcor_subtract(x + 6, x, edges[1]);
  mcor_cross(edges[0], edges[1], normal);
  for (int a = 0; a < 3; ++a)
  {
    normal[a] *= sign;
  }
  return mcor_normalise(normal) > 0;
}

/* Appends a disc or, in two dimensions, the line along which the disc crosses the plane, if it
 * does. Fails in two dimensions unless the disc is perpendicular to the plane. */
static mcor_status mcor_add_disc(
  mcor_flux_job* job, int64_t number, const double centre[3], const double normal[3], double radius)
{
  double corner[MCOR_DISC_CORNERS][3], axes[2][3], axis[3] = { 0 };
  double cosine = MCOR_DISC_RADIUS * radius, sine = 0;
  int least = 0;
  if (job->is_plane)
  {
    const int w = job->across;
    const double off = job->plane->at - centre[w],
                 half = sqrt(fmax(radius * radius - off * off, 0));
    double begin[3], along[3];
    axis[w] = 1;
    mcor_cross(axis, normal, along);
    for (int a = 0; a < 3; ++a)
    {
      begin[a] = a == w ? job->plane->at : centre[a] - half * along[a];
      along[a] *= 2 * half;
    }
    return normal[w] != 0 ? mcor_leaves_plane(job, number)
      : half > 0          ? mcor_add_line(job, number, begin, along, normal)
                          : MCOR_OK;
  }
  for (int a = 1; a < 3; ++a)
  {
    least = fabs(normal[a]) < fabs(normal[least]) ? a : least;
  }
  axis[least] = 1;
  mcor_cross(normal, axis, axes[0]);
  mcor_normalise(axes[0]);
  mcor_cross(normal, axes[0], axes[1]);
  for (int i = 0; i < MCOR_DISC_CORNERS; ++i)
  {
    for (int a = 0; a < 3; ++a)
    {
      corner[i][a] = centre[a] + cosine * axes[0][a] + sine * axes[1][a];
    }
    const double last = cosine;
    cosine = MCOR_DISC_COSINE * last - MCOR_DISC_SINE * sine;
    sine = MCOR_DISC_SINE * last + MCOR_DISC_COSINE * sine;
  }
  /* The largest triangles come first: two that form a square, then one on each side of the square,
   * and so on. */
  for (int step = MCOR_DISC_CORNERS / 4; step > 0; step /= 2)
  {
    for (int i = 0; i < MCOR_DISC_CORNERS; i += 2 * step)
    {
      MCOR_TRY(mcor_add_triangle(job, number, corner[i], corner[i + step],
        corner[(i + 2 * step) % MCOR_DISC_CORNERS], normal));
    }
  }
  return MCOR_OK;
}

/* Appends the pieces of a section, whose number of points is checked already. *has_size becomes
 * false if the section has no area or, if it consists of lines, no length. In two dimensions, a
 * rectangle, disc or box has a size even if it does not cross the plane. */
static mcor_status mcor_add_shape(mcor_flux_job* job, int64_t number, bool* has_size)
{
  const mcor_section* section = &job->sections[number];
  const double *x = section->points, *end = x + 3 * section->point_count;
  const int w = job->across, first = w == 0 ? 1 : 0, second = w == 2 ? 1 : 2;
  double edges[2][3], normal[3] = { 0 }, sign;
  switch (section->shape)
  {
    case MCOR_SECTION_RECTANGLE:
      *has_size = mcor_find_edges(x, 1, edges, normal);
      return *has_size ? mcor_add_rectangle(job, number, x, (const double(*)[3])edges, normal)
                       : MCOR_OK;
    case MCOR_SECTION_DISC:
      memcpy(normal, x + 3, sizeof normal);
      *has_size = mcor_normalise(normal) > 0 && section->radius > 0;
      return *has_size ? mcor_add_disc(job, number, x, normal, section->radius) : MCOR_OK;
    case MCOR_SECTION_BOX:
      for (int side = 0; side < 6; ++side)
      {
        const int a = side / 2, is_high = side % 2;
        const bool is_across = job->is_plane && a == w;
        double corner[3] = { x[0], x[1], x[2] }, outwards[3] = { 0 };
        *has_size = *has_size && (x[a] < x[3 + a] || (is_across && x[a] == x[3 + a]));
        corner[a] = x[3 * is_high + a];
        outwards[a] = is_high ? 1 : -1;
        memset(edges, 0, sizeof edges);
        for (int e = 1; e < 3; ++e)
        {
          const int along = (a + e) % 3;
          edges[is_high ? e - 1 : 2 - e][along] = x[3 + along] - x[along];
        }
        if (!is_across && *has_size)
        {
          MCOR_TRY(mcor_add_rectangle(job, number, corner, (const double(*)[3])edges, outwards));
        }
      }
      return MCOR_OK;
    case MCOR_SECTION_TRIANGLES:
      sign = mcor_orientation(x, section->point_count);
      for (; x < end; x += 9)
      {
        if (job->is_plane)
        {
          return mcor_leaves_plane(job, number);
        }
        if (mcor_find_edges(x, sign, edges, normal))
        {
          MCOR_TRY(mcor_add_triangle(job, number, x, x + 3, x + 6, normal));
        }
      }
      *has_size = job->found[number].area > 0;
      return MCOR_OK;
    default:
      MCOR_FAIL_IF(!job->is_plane, job->base.context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(SECTION_IS_LINE), mcor_label_section(job, number).text);
      for (; x < end; x += 6)
      {
        double along[3];
        mcor_subtract(x + 3, x, along);
        normal[w] = 0;
        normal[first] = along[second];
        normal[second] = -along[first];
        if (x[w] != job->plane->at || x[3 + w] != job->plane->at)
        {
          return mcor_leaves_plane(job, number);
        }
        if (mcor_normalise(normal) > 0)
        {
          MCOR_TRY(mcor_add_line(job, number, x, along, normal));
        }
      }
      *has_size = job->found[number].area > 0;
      return MCOR_OK;
  }
}

mcor_status mcor_add_section(mcor_flux_job* job, int64_t number)
{
  static const int points[MCOR_SECTION_SHAPE_COUNT] = { 3, 2, 2, 3, 2 };
  mcor_context* context = job->base.context;
  const mcor_section* section = &job->sections[number];
  const mcor_label label = mcor_label_section(job, number);
  const int64_t n = section->point_count;
  const unsigned shape = (unsigned)section->shape;
  const bool is_list = shape == MCOR_SECTION_TRIANGLES || shape == MCOR_SECTION_LINES;
  bool has_size = true;
  MCOR_FAIL_IF(shape >= MCOR_SECTION_SHAPE_COUNT || !section->points || n <= 0 ||
      (is_list ? n % points[shape] != 0 : n != points[shape]),
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_POINTS), label.text, (long long)n);
  for (const double* p = section->points; p < section->points + 3 * n; p += 3)
  {
    MCOR_FAIL_IF(!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]), context,
      MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_NOT_FINITE), label.text, p[0], p[1], p[2]);
  }
  MCOR_TRY(mcor_add_shape(job, number, &has_size));
  MCOR_FAIL_IF(
    !has_size, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_WITHOUT_AREA), label.text);
  MCOR_FAIL_IF(!isfinite(job->found[number].area), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(SECTION_TOO_LARGE), label.text);
  return MCOR_OK;
}
