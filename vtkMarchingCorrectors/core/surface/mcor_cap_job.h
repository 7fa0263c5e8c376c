/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_job_h
#define mcor_cap_job_h

/* Private to the caps: what is made on the host (mcor_cap.c) before the mesh gets it
 * (mcor_cap_mesh.c). */

#include "mcor_cap.h"
#include "mcor_cap_map.h"

/* A vertex only caps have. */
typedef struct mcor_cap_vertex
{
  cl_int node[4];
  double offset[3];
  bool is_cut;
  uint64_t key[2]; /* the first square that met it, and when it did */
} mcor_cap_vertex;

typedef struct mcor_cap_job
{
  mcor_context* context;
  int old_count; /* vertices of the mesh */
  /* The surface's vertices, by lower node and axis of their edge; of a pinched one the first. */
  mcor_cap_map edges[3];
  mcor_cap_map nodes, cuts;
  mcor_cap_vertex* vertices;
  int64_t vertex_count, vertex_room;
  cl_int* triangles;
  cl_ulong* cells; /* of the triangles, as in mcor_triangle_cell.c: squares, after all cells */
  int64_t triangle_count, triangle_room, cell_room, owned_count;
  cl_ulong square;  /* the one that is being capped */
  uint64_t lookups; /* of vertices, by that one */
  /* The surface's vertices, and the edges its own cuts are on, ascending. */
  void *node, *offset, *quantity, *distinct;
  double threshold;
} mcor_cap_job;

/* mcor_cap_mesh.c */
mcor_status mcor_no_cap_memory(mcor_context* context);

/* Appends the caps' vertices and triangles to the mesh. iso: relative to A0. */
mcor_status mcor_append_caps(mcor_cap_job* job, double iso);

#endif
