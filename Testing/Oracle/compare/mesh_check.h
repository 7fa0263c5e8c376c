/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mesh_check_h
#define mesh_check_h

/* Checks whether a triangle mesh is an oriented manifold with boundary. Every kind of fault is
 * counted, and the first item of each kind is named. */

#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

  typedef struct mesh_edge
  {
    int32_t a, b;     /* point indices, a < b */
    int64_t triangle; /* the triangle that has this edge */
    int forward;      /* 1 if the triangle goes from a to b */
    int64_t sharing;  /* how many triangles have this edge */
  } mesh_edge;

  typedef enum mesh_fault
  {
    MESH_BAD_INDEX = 0,       /* a triangle names a point that does not exist */
    MESH_BAD_COORDINATE,      /* NaN or infinite */
    MESH_REPEATED_INDEX,      /* a triangle names a point twice */
    MESH_ZERO_AREA,           /* three different points, no area */
    MESH_DUPLICATE_TRIANGLE,  /* the same three points as another triangle */
    MESH_NON_MANIFOLD_EDGE,   /* more than two triangles */
    MESH_ORIENTATION_CLASH,   /* two triangles go through their edge in the same direction */
    MESH_NON_MANIFOLD_VERTEX, /* its triangles do not form one fan */
    MESH_ISOLATED_POINT,      /* in no triangle */
    MESH_COINCIDENT_POINT,    /* the coordinates of another point, bit for bit */
    MESH_FAULT_COUNT
  } mesh_fault;

  typedef struct mesh_report
  {
    int64_t faults[MESH_FAULT_COUNT];
    /* For each kind of fault, the numbers of the points or triangles of the first one, as text. */
    char first[MESH_FAULT_COUNT][48];
    int64_t points, triangles, edges; /* edges: each undirected edge counts once */
    int64_t boundary_edges;           /* edges with one triangle */
    int64_t components;               /* parts of triangles that are connected over edges */
    int64_t euler;                    /* used points - edges + triangles */
    double area;
    double slimmest; /* the least of area over the square of the longest side */
    double volume;   /* the volume that outward oriented triangles enclose; it means something only
                      * without a boundary */
    /* All triangle sides, sorted by (a, b, triangle); [3 * triangles]. */
    mesh_edge* side;
    int64_t side_count;
    int64_t* component; /* [triangles], 0 .. components - 1 */
  } mesh_report;

  /* points: [point_count][3]; triangles: [triangle_count][3]. After bad indices or coordinates
   * nothing else is checked. Free the report with mesh_free_report. */
  void mesh_check(const double* points, int64_t point_count, const int32_t* triangles,
    int64_t triangle_count, mesh_report* report);
  void mesh_free_report(mesh_report* report);

  const char* mesh_fault_name(mesh_fault fault);

#ifdef __cplusplus
}
#endif

#endif
