/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_job_h
#define mcor_cap_job_h

/* Private to the caps: what is made on the host before the mesh gets it. */

#include "mcor_cap.h"
#include "mcor_table.h"

/* The line that a cut is on, from one end, 0, to the other, 1: where the cut is; where it is not beyond, and how
 * far inside of what trimming leaves these places are. */
typedef struct mcor_cap_line
{
  int64_t vertex; /* among the caps' vertices */
  double from[3], to[3];
  double at, side[2], margin[2];
  int last, moves; /* of the two, that was moved; how often the cut was */
  bool done;
} mcor_cap_line;

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
  mcor_cap_points points;
  /* The surface's vertices, by lower node and axis of their edge; of a pinched one the first. */
  mcor_table edges[3];
  mcor_table nodes, cuts;
  mcor_cap_vertex* vertices;
  int64_t vertex_count, vertex_room;
  mcor_cap_line*
    lines; /* of cuts that are placed exactly: of caps at walls, or in two dimensions */
  int64_t line_count, line_room;
  cl_int* triangles;
  cl_ulong* cells; /* of the triangles, as in mcor_triangle_cell.c: squares, after all cells */
  int64_t triangle_count, triangle_room, cell_room, owned_count;
  cl_ulong square;  /* the one that is being capped */
  uint64_t lookups; /* of vertices, by that one */
  /* The surface's vertices, and the edges its own cuts are on, ascending. */
  void *node, *offset, *quantity, *cut_edges;
  double threshold;
  mcor_cap_border* border; /* where the cuts of squares are wanted, and not what is left of them */
} mcor_cap_job;

/* A square of a side, or of a cell's face: its lowest node, and of its nodes, in the order (0, 0), (1, 0), (1, 1),
 * (0, 1), which are above, and how far inside. */
typedef struct mcor_cap_square
{
  int axis, upper;
  cl_int node[3];
  bool above[4];
  double margin[4];
  bool is_joined; /* nodes above, where it is ambiguous */
} mcor_cap_square;

/* mcor_cap_square.c. Begins square `number`, or a cell of a cap at walls, by its lowest node; across: the axis of the
 * side, along which the box does not end; -1: none. */
void mcor_begin_cap_square(mcor_cap_job* job, cl_ulong number, const cl_int node[3], int across);
/* Adds what trimming leaves of a square to the cap. */
mcor_status mcor_add_cap_square(mcor_cap_job* job, const mcor_cap_square* square);
mcor_status mcor_add_cap_triangle(mcor_cap_job* job, const int32_t corners[3]);
mcor_status mcor_add_cap_border(mcor_cap_job* job, int32_t from, int32_t to);
/* Moves cuts to where trimming ends: those of caps at walls, where solids have their share, and of lines. */
mcor_status mcor_place_cap_cuts(mcor_cap_job* job);

/* ---- Caps at walls ---- */

/* A brick of nodes near both fluid and solids. */
typedef struct mcor_wall_brick
{
  cl_ulong key; /* of its first cell */
  cl_int at[3]; /* in bricks */
  bool has_fluid, is_known;
  /* Bits of nodes, and of the cells and faces whose lowest node is here. */
  cl_ulong above, used, joined[3];
  double margin[MCOR_BRICK_NODES]; /* of nodes above */
} mcor_wall_brick;

typedef struct mcor_wall
{
  mcor_table index; /* numbers of bricks */
  mcor_wall_brick* bricks;
  int64_t count, room;
  bool has_bricks; /* all that solids reach */
  int range[3][2]; /* nodes, from and to: of the box, the ring around it, and what is beside */
} mcor_wall;

/* mcor_cap_brick.c. The bricks where there may be caps, in the order of their keys. */
mcor_status mcor_load_wall(mcor_context* context, mcor_cap_points* points, mcor_wall* wall);
/* NULL: there is none. */
const mcor_wall_brick* mcor_find_wall_brick(const mcor_wall* wall, const int at[3]);
void mcor_free_wall(mcor_wall* wall);

/* mcor_cap_wall.c. Caps where the surface ends at solids. */
mcor_status mcor_cap_walls(mcor_cap_job* job);

#endif
