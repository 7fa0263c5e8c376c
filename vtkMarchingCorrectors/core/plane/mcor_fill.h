/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_fill_h
#define mcor_fill_h

/* Filling: in two dimensions, triangles of the region above the lowest iso value, divided by the lines of the
 * others. See mcor_fill_lines.c. */

#include "mcor_cap.h"
#include "mcor_table.h"

/* One iso value's lines, as trimming has left them. */
typedef struct mcor_fill_line
{
  double iso, value; /* relative to A0, as the device has it; the caller's */
  int iso_number;
  int vertex_count, cut_count;
  mcor_table edges;  /* vertices on lattice edges, by these */
  mcor_table joined; /* lowest nodes of ambiguous squares whose nodes above are joined */
  double *offset,
    *margin;       /* [vertex_count]: along the edge; how far inside of what trimming leaves */
  cl_ulong* cuts;  /* [cut_count], see mcor_trim.cl; ascending */
  int32_t* number; /* [vertex_count + cut_count], points of the surface; -1: dropped */
} mcor_fill_line;

/* A point where trimming ends what is filled, on a lattice edge between two corners of polygons. */
typedef struct mcor_fill_cut
{
  uint64_t key[2]; /* of the point: of its node, then axis << 32 | part of the edge */
  cl_int node[3];  /* lower node of the edge */
  int axis;
  double inside, outside;               /* places along the edge; the root is between them */
  double inside_margin, outside_margin; /* there */
  double at, margin;                    /* the best so far */
  int last;        /* 1: the end inside was moved last; 0: the other one; -1: none yet */
  int band, index; /* index: as triangles know it */
} mcor_fill_cut;

/* Corners: a node's index, node_count + that of a cut, or -1 - a point of the surface. */
typedef struct mcor_fill_triangle
{
  int32_t corner[3];
  int32_t band;
  uint64_t square;
} mcor_fill_triangle;

typedef struct mcor_filling
{
  mcor_fill_line* lines; /* [line_count], of the iso values that differ, ascending */
  int line_count;
  /* The plane, as seen from above; MCOR_CAP_VALID is in face.within. */
  mcor_cap_face face;
  double* value;   /* [face.node_count] */
  int32_t* band;   /* [face.node_count]: how many lines are not above the value there */
  int32_t* number; /* of nodes, and then cuts: where they are in the surface; -1: nowhere */
  mcor_table cut_of;
  mcor_fill_cut* cuts;
  int64_t cut_count, cut_room;
  mcor_fill_triangle* triangles;
  int64_t triangle_count, triangle_room;
} mcor_filling;

/* Before all else, where lines are to be filled: whether they can be, and what nodes are. */
mcor_status mcor_begin_fill(mcor_context* context);
/* After trimming, and as soon as the points of the surface are numbered: keeps what is to be known of the
 * lines of the iso value under way, where they are to be filled. */
mcor_status mcor_take_lines(mcor_context* context);
void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base);
void mcor_end_fill(mcor_context* context);
/* mcor_fill_points.c. After all iso values: adds triangles to the surface, behind those that stand for lines, of
 * which two corners are one. */
mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface);

/* mcor_fill_squares.c: the polygons, of one band each. */
mcor_status mcor_fill_squares(mcor_context* context, mcor_filling* fill);

/* Ascending in the order of nodes: by 4 x 4 of them, which are near each other. */
static inline uint64_t mcor_fill_node_key(const cl_int node[3])
{
  const cl_int u = node[0], v = node[1];
  return (uint64_t)(v >> 2) << 24 | (uint64_t)(u >> 2) << 4 | (uint64_t)((v & 3) << 2 | (u & 3));
}

#endif
