/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_fill_h
#define mcor_fill_h

/* Filling, in two dimensions: makes triangles of the region above the lowest iso value, divided by
 * the lines of the other iso values. See mcor_fill_lines.c. */

#include "mcor_cap.h"

/* The lines of one iso value, after trimming. */
typedef struct mcor_fill_line
{
  double iso, value; /* iso: relative to A0, as on the device; value: the caller's iso value */
  int iso_number;
  int vertex_count, cut_count;
  mcor_table edges;        /* the line's vertices by lattice edge */
  mcor_table joined;       /* lowest nodes of ambiguous squares that join their nodes above */
  double *offset, *margin; /* [vertex_count]: position along the edge; trim margin */
  cl_ulong* cuts;          /* [cut_count], see mcor_trim.cl; ascending */
  int32_t* number;         /* [vertex_count + cut_count]: number of the surface's point; -1: none */
} mcor_fill_line;

/* corner: a node's index; or node_count + a cut's index; or -1 - the index of a surface's point. */
typedef struct mcor_fill_triangle
{
  int32_t corner[3];
  int32_t band;
  uint64_t square;
} mcor_fill_triangle;

typedef struct mcor_filling
{
  mcor_fill_line* lines; /* [line_count], ascending by iso value, without repetitions */
  int line_count;
  mcor_cap_nodes nodes; /* the plane's nodes, kept like nodes of an upper cap side */
  double* value;        /* [nodes.node_count] */
  int32_t* band;        /* [nodes.node_count]: number of iso values that the node reaches */
  int32_t* number;      /* points of the surface at nodes, then at cuts; -1: none */
  mcor_cap_job cap;     /* vertices: points where trimming ends the region */
  MCOR_LIST(mcor_fill_triangle) triangles;
} mcor_filling;

/* Runs first. If lines are to be filled, checks that they can be, and evaluates the nodes. */
mcor_status mcor_begin_fill(mcor_context* context);
/* mcor_take_lines keeps the trimmed lines of the current iso value; mcor_number_lines notes the
 * numbers of their points. Both do nothing if lines are not filled. */
mcor_status mcor_take_lines(mcor_context* context);
void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base);
void mcor_end_fill(mcor_context* context);
/* mcor_fill_squares.c. Runs after all iso values. Appends the filled triangles to the triangles
 * that stand for lines. */
mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface);

/* Packs a node into a key that ascends by squares of 4 x 4, so that successive nodes are near
 * each other. */
static inline uint64_t mcor_fill_node_key(const cl_int node[3])
{
  const cl_int u = node[0], v = node[1];
  return (uint64_t)(v >> 2) << 24 | (uint64_t)(u >> 2) << 4 | (uint64_t)((v & 3) << 2 | (u & 3));
}

#endif
