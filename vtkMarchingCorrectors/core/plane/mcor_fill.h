/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_fill_h
#define mcor_fill_h

/* Filling: in two dimensions, triangles of the region above the least iso value, divided by the lines of the
 * others. See mcor_fill_region.c. */

#include "mcor_cap.h"
#include "mcor_table.h"

/* Nodes of one brick that marching has evaluated, bits x + 4 y. */
typedef struct mcor_fill_brick
{
  cl_int x, y; /* in bricks */
  uint16_t known, above, valid;
} mcor_fill_brick;

/* One iso value's lines, as trimming has left them. */
typedef struct mcor_fill_line
{
  double iso, value; /* relative to A0, as the device has it; the caller's */
  int brick_count, vertex_count, cut_count;
  mcor_fill_brick* bricks;
  mcor_table edges;  /* vertices on lattice edges, by these */
  mcor_table joined; /* ambiguous squares whose nodes above are joined */
  double *offset,
    *margin;       /* [vertex_count]: along the edge; how far inside of what trimming leaves */
  cl_ulong* cuts;  /* [cut_count], see mcor_trim.cl; ascending */
  int32_t* number; /* [vertex_count + cut_count], points of the surface; -1: dropped */
} mcor_fill_line;

/* A point where trimming ends what is filled, on a lattice edge between two corners of polygons. */
typedef struct mcor_fill_cut
{
  uint64_t key[2];                      /* see mcor_fill_node_key; axis << 32 | part of the edge */
  cl_int u, v, axis;                    /* lower node of the edge */
  double inside, outside;               /* places along the edge; the root is between them */
  double inside_margin, outside_margin; /* there */
  double at, margin;                    /* the best so far */
  int band, index;                      /* index: as triangles know it */
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
  mcor_fill_line* lines; /* [line_count], of the iso values as the caller gives them */
  int line_count;
  int* levels; /* [level_count], lines that differ, by ascending iso value */
  int level_count;
  /* Nodes; state: MCOR_CAP_VALID. Band: how many levels are not above the value there. */
  mcor_cap_face face;
  int64_t node_count;
  int32_t *band, *number; /* [node_count]; number: of those that are used, -1 of others */
  mcor_table cut_of;
  mcor_fill_cut* cuts;
  int32_t* cut_number; /* [cut_count] */
  int64_t cut_count, cut_room;
  mcor_fill_triangle* triangles;
  int64_t triangle_count, triangle_room;
} mcor_filling;

/* mcor_fill_lines.c. Before all else, where lines are to be filled: whether they can be. */
mcor_status mcor_begin_fill(mcor_context* context);
/* After trimming, and as soon as the points of the surface are numbered: keeps what is to be known of the
 * lines of the iso value under way, where they are to be filled. iso: relative to A0. */
mcor_status mcor_take_lines(mcor_context* context, double iso);
void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base);
void mcor_end_fill(mcor_context* context);
/* After all iso values: adds triangles to the surface, behind those that stand for lines, of which two
 * corners are one. */
mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface);

/* mcor_fill_nodes.c, mcor_fill_squares.c, mcor_fill_points.c: the steps. */
mcor_status mcor_find_bands(mcor_context* context, mcor_filling* fill);
mcor_status mcor_fill_squares(mcor_context* context, mcor_filling* fill);
mcor_status mcor_append_fill(
  mcor_context* context, mcor_filling* fill, const mcor_input* input, mcor_surface* surface);

/* Of a lattice edge by its lower node, and of a node or square (axis 0): not 0. */
static inline uint64_t mcor_fill_key(cl_int u, cl_int v, int axis)
{
  return (uint64_t)u | (uint64_t)v << 21 | (uint64_t)axis << 42 | UINT64_C(1) << 63;
}

/* Ascending in the order of nodes: by 4 x 4 of them, which are near each other. */
static inline uint64_t mcor_fill_node_key(cl_int u, cl_int v)
{
  return (uint64_t)(v >> 2) << 24 | (uint64_t)(u >> 2) << 4 | (uint64_t)((v & 3) << 2 | (u & 3));
}

#endif
