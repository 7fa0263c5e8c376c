/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_job_h
#define mcor_cap_job_h

/* Private to the caps: what is made on the host (mcor_cap_make.c) before the mesh gets it
 * (mcor_cap_mesh.c). */

#include "mcor_cap.h"
#include "mcor_table.h"

#include <math.h>

/* The line that a cut is on, from one end, 0, to the other, 1: where the cut is; where it is not beyond, and how
 * far inside of what trimming leaves these places are. */
typedef struct mcor_cap_line
{
  double from[3], to[3];
  double at, side[2], margin[2];
  double left; /* margin where it was last */
  int last;    /* of the two, that was moved */
} mcor_cap_line;

/* A vertex only caps have. */
typedef struct mcor_cap_vertex
{
  cl_int node[4];
  double offset[3];
  bool is_cut;
  uint64_t key[2]; /* the first square that met it, and when it did */
  bool is_placed;  /* on a line, exactly: of a cap at walls, or in two dimensions */
  mcor_cap_line line;
} mcor_cap_vertex;

/* Edges that cutting the squares around a cell leaves, from one vertex to another: of a cap at walls. */
#define MCOR_CAP_BORDER 64
typedef struct mcor_cap_border
{
  int count;
  int32_t ends[MCOR_CAP_BORDER][2];
} mcor_cap_border;

typedef struct mcor_cap_job
{
  mcor_context* context;
  int old_count; /* vertices of the mesh */
  /* The surface's vertices, by lower node and axis of their edge; of a pinched one the first. */
  mcor_table edges[3];
  mcor_table nodes, cuts;
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
  mcor_cap_border* border; /* where the cuts of squares are wanted, and not what is left of them */
} mcor_cap_job;

/* Of a node; the virtual grid has not more than 2^20 + 64 along an axis. */
static inline uint64_t mcor_cap_key(const cl_int node[3])
{
  return (uint64_t)node[0] | (uint64_t)node[1] << 21 | (uint64_t)node[2] << 42 | UINT64_C(1) << 63;
}

/* Square (u, v) of a side. */
mcor_status mcor_cap_square(mcor_cap_job* job, const mcor_cap_face* face, int u, int v);
mcor_status mcor_add_cap_triangle(mcor_cap_job* job, const int32_t corners[3]);
mcor_status mcor_add_cap_border(mcor_cap_job* job, int32_t from, int32_t to);

/* A cut keeps off the ends of its line, as those of the surface do. */
#define MCOR_CAP_CUT_MARGIN 1e-5
#define MCOR_CAP_ROOT 2e-5 /* how near to 0 a margin is a root */

/* At a place of the virtual grid, in cubes. */
static inline void mcor_put_cap_vertex(mcor_cap_vertex* vertex, const double at[3])
{
  for (int a = 0; a < 3; ++a)
  {
    vertex->node[a] = (cl_int)floor(at[a]);
    vertex->offset[a] = at[a] - vertex->node[a];
  }
}

/* mcor_cap_place.c. Moves cuts to where trimming ends: those of caps at walls, where solids have their share, and of
 * lines. */
mcor_status mcor_place_cap_cuts(mcor_cap_job* job, double iso, mcor_cap_points* points);

/* mcor_cap_mesh.c. Appends the caps' vertices and triangles to the mesh. iso: relative to A0. */
mcor_status mcor_append_caps(mcor_cap_job* job, double iso);

/* ---- Caps at walls ---- */

/* A brick of nodes near both fluid and solids. */
typedef struct mcor_wall_brick
{
  cl_ulong key; /* of its first cell */
  cl_int at[3]; /* in bricks */
  bool has_fluid, is_known;
  /* Of nodes, and of the cells and faces that have their lowest node here. */
  cl_ulong above, used, joined[3];
  double margin[MCOR_BRICK_NODES]; /* of nodes above */
} mcor_wall_brick;

typedef struct mcor_wall
{
  mcor_table index; /* numbers of bricks */
  mcor_wall_brick* bricks;
  int64_t count, room;
  int first[3], end[3]; /* nodes: of the box, the ring around it, and what is beside */
} mcor_wall;

/* mcor_cap_brick.c. The bricks where there may be caps, in the order of their keys. */
mcor_status mcor_load_wall(
  mcor_context* context, double iso, mcor_cap_points* points, mcor_wall* wall);
/* NULL: there is none. */
const mcor_wall_brick* mcor_find_wall_brick(const mcor_wall* wall, const int at[3]);
void mcor_free_wall(mcor_wall* wall);

/* mcor_cap_wall.c. Caps where the surface ends at solids. */
mcor_status mcor_cap_walls(mcor_cap_job* job, double iso, mcor_cap_points* points);

#endif
