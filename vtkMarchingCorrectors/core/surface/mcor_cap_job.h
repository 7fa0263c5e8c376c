/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_job_h
#define mcor_cap_job_h

/* Private to caps and filled regions: data that the host makes before they go to the mesh. */

#include "mcor_cap.h"

/* A bracket of the root of the trim margin along a line: its ends, the margins at the ends, and
 * which end moved last (-1: none). */
typedef struct mcor_bracket
{
  double at[2], margin[2];
  int last;
} mcor_bracket;

/* The line on which a cut moves, from one end (0) to the other (1). at: the cut's place. */
typedef struct mcor_cap_line
{
  int64_t vertex; /* index among the caps' vertices */
  double from[3], to[3];
  double at;
  mcor_bracket bracket;
  int moves; /* how often the cut has moved */
  bool done;
} mcor_cap_line;

typedef struct mcor_cap_triangle
{
  cl_int corner[3];
} mcor_cap_triangle;

typedef struct mcor_cap_job
{
  mcor_context* context;
  mcor_cap_points points;
  /* The surface's vertices by their lattice edge (lower node and axis); for a pinched edge, its
   * first vertex. */
  mcor_table edges[3];
  mcor_table nodes, cuts;
  MCOR_LIST(mcor_cap_vertex) vertices;
  MCOR_LIST(mcor_cap_line) lines; /* cuts in a plane that must be placed exactly */
  MCOR_LIST(mcor_cap_triangle) triangles;
  /* The number of each triangle's square, see mcor_triangle_cell.c. */
  MCOR_LIST(cl_ulong) cells;
  int64_t owned_count;
  const struct mcor_cap_square* square; /* the square that is being cut */
  cl_ulong number;                      /* the square's number */
  uint64_t lookups;                     /* number of vertices that it has looked up */
  /* Views of the surface's vertices, and of the edges of its cuts, ascending. */
  void *node, *offset, *quantity, *cut_edges;
  double threshold;
} mcor_cap_job;

/* A square of a side. node: its lowest node; above, margin: of its nodes in the order (0, 0), (1,
 * 0), (1, 1), (0, 1). */
typedef struct mcor_cap_square
{
  int axis, upper;
  cl_int node[3];
  bool above[4];
  double margin[4];
  bool is_joined; /* it is ambiguous, and joins its nodes above */
} mcor_cap_square;

/* mcor_cap_square.c. Begins a square. node: its lowest node; across: the side's axis. The square is
 * owned if it is in the box along the other axes. */
void mcor_begin_cap_square(mcor_cap_job* job, cl_ulong number, const cl_int node[3], int across);
/* Adds what trimming leaves of a square to the cap. */
mcor_status mcor_add_cap_square(mcor_cap_job* job, const mcor_cap_square* square);
/* Splits a position, in cubes, into a node and an offset. */
void mcor_put_cap_vertex(mcor_cap_vertex* vertex, const double at[3]);
/* Makes the line from one corner to another, and finds the point on it where a linear margin would
 * be 0. */
void mcor_begin_cap_line(
  const mcor_cap_corner* low, const mcor_cap_corner* high, mcor_cap_line* line, double at[3]);
/* Moves the cuts to where the trim margin is 0. */
mcor_status mcor_place_cap_cuts(mcor_cap_job* job);
void mcor_free_cap_job(mcor_cap_job* job);

#endif
