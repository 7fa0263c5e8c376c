/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_compare_internal_h
#define oracle_compare_internal_h

/* Declarations that oracle_compare.c, oracle_compare_edges.c and oracle_compare_mesh.c share. oracle_compare.c calls
 * the other two files, which do not call each other. */

#include "oracle_compare.h"

enum
{
  COMPARE_OFF_LATTICE = -1,
  COMPARE_TRIM_VERTEX = -2
};

typedef struct compare_state
{
  const oracle_reference* reference;
  const mcor_options* options;
  const mcor_surface* surface;
  const mesh_report* mesh;
  int trimmed;
  oracle_comparison* result;
  /* For each point of the surface: the lattice edge that it lies on, as 3 * number + axis, or COMPARE_*. */
  int64_t* vertex_edge;
  /* For each crossed edge of the lattice: the number of the point on it, or -1. A pinched edge has a second point,
   * because only two opposite cells around it are valid, and their triangles share no point. */
  int64_t *edge_vertex, *second_vertex;
  double* gradient;    /* [point_count][3], by the oracle */
  double* vertex_cube; /* [point_count], length of the vertex's edge */
} compare_state;

/* ---- oracle_compare.c ---- */

/* Each returns how far inside of one limit of the trimmed surface a point is. The limits are the threshold of the
 * trimming weight or boundary eigenvalue; the end at solids, in the unit of the weight; and the least fluid weight of a
 * mean. compare_trim_margin returns the least of the three values. */
double compare_threshold_margin(
  const compare_state* state, const double point[3], const oracle_sample* sample);
double compare_wall_margin(const compare_state* state, const oracle_sample* sample);
double compare_fluid_margin(const compare_state* state, const oracle_sample* sample);
double compare_trim_margin(
  const compare_state* state, const double point[3], const oracle_sample* sample);
/* Returns whether trimming cuts away any of the places where the field crosses iso on an edge. */
int compare_rightly_trimmed(
  const compare_state* state, const double start[3], int axis, double length);
/* Keeps the description of the first fault. */
void compare_note(compare_state* state, const char* format, ...);

/* ---- oracle_compare_edges.c: the edge of each vertex, edges without a vertex, and sides of triangles ---- */

/* Counts, for each component of the oracle's surface, the crossed edges that have a vertex and those that lack one. */
void compare_edges(compare_state* state, int64_t* present, int64_t* absent);

/* ---- oracle_compare_mesh.c ---- */

void compare_vertices(compare_state* state);
void compare_orientation(compare_state* state);

#endif
