/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh_check.h"
#include "oracle.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char* mesh_fault_name(mesh_fault fault)
{
  static const char* const names[MESH_FAULT_COUNT] = { "bad index", "bad coordinate",
    "repeated index", "zero area", "duplicate triangle", "non-manifold edge", "orientation clash",
    "non-manifold vertex", "isolated point", "coincident point" };
  return fault < MESH_FAULT_COUNT ? names[fault] : "unknown";
}

/* Counts a fault. For the first fault of each kind, keeps the numbers of the two points or
 * triangles. */
static void mesh_add_fault(mesh_report* report, mesh_fault fault, int64_t one, int64_t other)
{
  if (report->faults[fault]++ == 0)
  {
    snprintf(
      report->first[fault], sizeof(report->first[fault]), "%" PRId64 ", %" PRId64, one, other);
  }
}

void mesh_free_report(mesh_report* report)
{
  free(report->side);
  free(report->component);
  memset(report, 0, sizeof(*report));
}

/* ---- triangles one by one ---- */

static void mesh_measure_triangle(
  const double* points, const int32_t* triangle, int64_t t, mesh_report* report)
{
  const double *a = &points[3 * triangle[0]], *b = &points[3 * triangle[1]],
               *c = &points[3 * triangle[2]];
  double u[3], v[3], uu = 0.0, vv = 0.0, ww = 0.0;
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
  {
    mesh_add_fault(report, MESH_REPEATED_INDEX, t, triangle[0]);
    return;
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    u[axis] = b[axis] - a[axis];
    v[axis] = c[axis] - a[axis];
    uu += u[axis] * u[axis];
    vv += v[axis] * v[axis];
    ww += pow(u[axis] - v[axis], 2.0);
  }
  const double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
    u[0] * v[1] - u[1] * v[0] };
  const double area = 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  const double share = area / fmax(uu, fmax(vv, ww));
  report->area += area;
  for (int axis = 0; axis < 3; ++axis)
  {
    /* Coordinates are relative to one point of the mesh, so that a large offset costs no digits. */
    report->volume += (a[axis] - points[axis]) * n[axis] / 6.0;
  }
  report->slimmest = t == 0 ? share : fmin(report->slimmest, share);
  if (!(share > 1e-12))
  {
    mesh_add_fault(report, MESH_ZERO_AREA, t, triangle[0]);
  }
}

/* ---- sides ---- */

static int mesh_compare_sides(const void* x, const void* y)
{
  const mesh_edge* p = x;
  const mesh_edge* q = y;
  if (p->a != q->a)
  {
    return p->a < q->a ? -1 : 1;
  }
  if (p->b != q->b)
  {
    return p->b < q->b ? -1 : 1;
  }
  return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

/* ---- union-find: corners are joined to fans, triangles to components ---- */

static int64_t mesh_root(int64_t* parent, int64_t n)
{
  while (parent[n] != n)
  {
    parent[n] = parent[parent[n]];
    n = parent[n];
  }
  return n;
}

static void mesh_unite(int64_t* parent, int64_t a, int64_t b)
{
  a = mesh_root(parent, a);
  b = mesh_root(parent, b);
  parent[a > b ? a : b] = a > b ? b : a;
}

static int64_t mesh_corner(const int32_t* triangles, int64_t t, int32_t point)
{
  return 3 * t + (triangles[3 * t] == point ? 0 : triangles[3 * t + 1] == point ? 1 : 2);
}

/* Checks all groups of triangle sides that lie on the same edge. */
static void mesh_check_edges(
  const int32_t* triangles, mesh_report* report, int64_t* corner_parent, int64_t* parent)
{
  mesh_edge* const end = report->side + report->side_count;
  for (mesh_edge *first = report->side, *next = first; first < end; first = next)
  {
    int forward = 0;
    for (; next < end && next->a == first->a && next->b == first->b; ++next)
    {
      forward += next->forward;
      mesh_unite(parent, first->triangle, next->triangle);
      mesh_unite(corner_parent, mesh_corner(triangles, first->triangle, first->a),
        mesh_corner(triangles, next->triangle, first->a));
      mesh_unite(corner_parent, mesh_corner(triangles, first->triangle, first->b),
        mesh_corner(triangles, next->triangle, first->b));
    }
    const int64_t count = next - first;
    for (mesh_edge* side = first; side < next; ++side)
    {
      side->sharing = count;
    }
    ++report->edges;
    report->boundary_edges += count == 1;
    if (count > 2)
    {
      mesh_add_fault(report, MESH_NON_MANIFOLD_EDGE, first->a, first->b);
    }
    else if (count == 2 && forward != 1)
    {
      mesh_add_fault(report, MESH_ORIENTATION_CLASH, first->a, first->b);
    }
  }
}

static void mesh_check_fans(
  const int32_t* triangles, mesh_report* report, int64_t* corner_parent, int64_t* fan)
{
  int64_t used = 0;
  for (int64_t p = 0; p < report->points; ++p)
  {
    fan[p] = -1;
  }
  for (int64_t c = 0; c < 3 * report->triangles; ++c)
  {
    const int64_t root = mesh_root(corner_parent, c);
    int64_t* at = &fan[triangles[c]];
    used += *at == -1;
    if (*at >= 0 && *at != root)
    {
      mesh_add_fault(report, MESH_NON_MANIFOLD_VERTEX, triangles[c], c / 3);
      *at = -2; /* marks the point as counted */
    }
    else if (*at == -1)
    {
      *at = root;
    }
  }
  for (int64_t p = 0; p < report->points; ++p)
  {
    if (fan[p] == -1)
    {
      mesh_add_fault(report, MESH_ISOLATED_POINT, p, p);
    }
  }
  report->euler = used - report->edges + report->triangles;
}

/* ---- duplicates ---- */

static int mesh_compare_triples(const void* x, const void* y)
{
  const double* p = x;
  const double* q = y;
  for (int c = 0; c < 3; ++c)
  {
    if (p[c] != q[c])
    {
      return p[c] < q[c] ? -1 : 1;
    }
  }
  return (p[3] > q[3]) - (p[3] < q[3]);
}

/* Sorts the triples, and counts a fault for each triple that equals the one before it. quads: [count][4]; each row is
 * a triple, then the number of its point or triangle. */
static void mesh_check_triples(double* quads, int64_t count, mesh_fault fault, mesh_report* report)
{
  qsort(quads, (size_t)count, 4 * sizeof(double), mesh_compare_triples);
  for (int64_t n = 1; n < count; ++n)
  {
    const double* p = &quads[4 * n - 4];
    if (p[0] == p[4] && p[1] == p[5] && p[2] == p[6])
    {
      mesh_add_fault(report, fault, (int64_t)p[3], (int64_t)p[7]);
    }
  }
}

static void mesh_check_duplicates(
  const double* points, const int32_t* triangles, mesh_report* report)
{
  const int64_t most = report->points > report->triangles ? report->points : report->triangles;
  double* quads = oracle_allocate(most, 4 * sizeof(double));
  for (int64_t p = 0; p < report->points; ++p)
  {
    memcpy(&quads[4 * p], &points[3 * p], 3 * sizeof(double));
    quads[4 * p + 3] = (double)p;
  }
  mesh_check_triples(quads, report->points, MESH_COINCIDENT_POINT, report);
  for (int64_t t = 0; t < report->triangles; ++t)
  {
    const double a = triangles[3 * t];
    const double b = triangles[3 * t + 1];
    const double c = triangles[3 * t + 2];
    quads[4 * t] = fmin(a, fmin(b, c));
    quads[4 * t + 2] = fmax(a, fmax(b, c));
    quads[4 * t + 1] = a + b + c - quads[4 * t] - quads[4 * t + 2];
    quads[4 * t + 3] = (double)t;
  }
  mesh_check_triples(quads, report->triangles, MESH_DUPLICATE_TRIANGLE, report);
  free(quads);
}

void mesh_check(const double* points, int64_t point_count, const int32_t* triangles,
  int64_t triangle_count, mesh_report* report)
{
  memset(report, 0, sizeof(*report));
  report->points = point_count;
  report->triangles = triangle_count;
  for (int64_t p = 0; p < point_count; ++p)
  {
    if (!isfinite(points[3 * p]) || !isfinite(points[3 * p + 1]) || !isfinite(points[3 * p + 2]))
    {
      mesh_add_fault(report, MESH_BAD_COORDINATE, p, p);
    }
  }
  for (int64_t c = 0; c < 3 * triangle_count; ++c)
  {
    if (triangles[c] < 0 || triangles[c] >= point_count)
    {
      mesh_add_fault(report, MESH_BAD_INDEX, c / 3, triangles[c]);
    }
  }
  if (report->faults[MESH_BAD_COORDINATE] + report->faults[MESH_BAD_INDEX] > 0)
  {
    return;
  }
  int64_t* corner_parent = oracle_allocate(3 * triangle_count, sizeof(int64_t));
  int64_t* fan = oracle_allocate(point_count, sizeof(int64_t));
  int64_t* component = oracle_allocate(triangle_count, sizeof(int64_t));
  report->side_count = 3 * triangle_count;
  report->side = oracle_allocate(report->side_count, sizeof(mesh_edge));
  report->component = component;
  mesh_check_duplicates(points, triangles, report);
  for (int64_t t = 0; t < triangle_count; ++t)
  {
    mesh_measure_triangle(points, &triangles[3 * t], t, report);
    component[t] = t;
    for (int64_t c = 3 * t; c < 3 * t + 3; ++c)
    {
      const int32_t from = triangles[c], to = triangles[c == 3 * t + 2 ? 3 * t : c + 1];
      const int forward = from < to;
      report->side[c] = (mesh_edge){ forward ? from : to, forward ? to : from, t, forward, 0 };
      corner_parent[c] = c;
    }
  }
  qsort(report->side, (size_t)report->side_count, sizeof(mesh_edge), mesh_compare_sides);
  mesh_check_edges(triangles, report, corner_parent, component);
  mesh_check_fans(triangles, report, corner_parent, fan);
  for (int64_t t = 0; t < triangle_count; ++t)
  {
    component[t] = component[t] == t ? report->components++ : component[component[t]];
  }
  free(corner_parent);
  free(fan);
}
