/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_compare_internal_h
#define oracle_compare_internal_h

/* oracle_compare.c calls what compares edges (oracle_compare_edges.c), vertices and triangles
 * (_mesh.c) and what the mesh does on the faces of the lattice (_faces.c); these call what they share
 * (_state.c), and not each other. */

#include "oracle_compare.h"

enum
{
  COMPARE_OFF_LATTICE = -1,
  COMPARE_TRIM_VERTEX = -2,
  COMPARE_ON_NODE = -3 /* and lower: on node -3 - value; which of its edges is open */
};

typedef struct compare_state
{
  const oracle_reference* reference;
  const mcor_options* options;
  const mcor_surface* surface;
  const mesh_report* mesh;
  int trimmed;
  oracle_comparison* result;
  /* [point_count], an edge of the lattice (3 * number + axis) or COMPARE_*. */
  int64_t* vertex_edge;
  /* [edge_count] of the oracle's surface, a point or -1. A pinched edge has a second vertex, as
   * each of its two cells has a fan of its own. */
  int64_t *edge_vertex, *second_vertex;
  double* gradient;    /* [point_count][3], by the oracle */
  double* vertex_cube; /* [point_count], length of the vertex's edge */
} compare_state;

/* ---- oracle_compare_state.c ---- */

/* How far a point is inside of what trimming leaves: of the threshold of the trimming weight or the
 * boundary eigenvalue; of where the surface ends at solids, in the unit of the weight; of both. */
double compare_threshold_margin(
  const compare_state* state, const double point[3], const oracle_sample* sample);
double compare_wall_margin(const compare_state* state, const oracle_sample* sample);
double compare_fluid_margin(const compare_state* state, const oracle_sample* sample);
double compare_trim_margin(
  const compare_state* state, const double point[3], const oracle_sample* sample);
/* Whether any of the places where the field passes iso on an edge is trimmed away. */
int compare_rightly_trimmed(
  const compare_state* state, const double start[3], int axis, double length);
/* The first fault is kept in words. */
void compare_note(compare_state* state, const char* format, ...);
void compare_note_edge(compare_state* state, const char* what, int64_t edge);
/* 1 if either end of the edge has the flag. */
int compare_end_flag(const oracle_lattice* lattice, int64_t edge, int flag);
/* 1 if two valid cells touch only in this edge. */
int compare_pinched(const oracle_lattice* lattice, int64_t edge);

/* ---- oracle_compare_edges.c: which edge each vertex lies on, then what that leaves out ---- */

void compare_assign(compare_state* state);
/* present, absent: of each component, and one more; counted up. */
void compare_missing(compare_state* state, int64_t* present, int64_t* absent);
void compare_extra(compare_state* state);

/* ---- oracle_compare_adaptive.c: these and those on faces, for cubes of several sizes ---- */

void compare_adaptive(compare_state* state, int64_t* present, int64_t* absent);

/* ---- oracle_compare_mesh.c ---- */

void compare_vertices(compare_state* state);
int compare_orientation(compare_state* state); /* 0 if memory ran out */

/* ---- oracle_compare_faces.c ---- */

void compare_faces(compare_state* state);
void compare_boundary(compare_state* state);
void compare_count_pinched(compare_state* state);
void compare_count_unsettled(compare_state* state);

#endif
