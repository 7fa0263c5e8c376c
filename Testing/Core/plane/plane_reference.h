/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef plane_reference_h
#define plane_reference_h

/* A reference for particles in a plane: the field in double precision, at all nodes of squares that are as fine as the
 * particles. The plane lies across `axis` (0 x, 1 y, 2 z) at the coordinate `at`. The other two coordinates, in cyclic
 * order, are u and v. */

#include "core_fixture.h"

typedef struct plane_field
{
  const particle_set* set;
  const mcor_options* options;
  int axis;
  const double* region; /* [4] or NULL: squares have their centres from [0] to [1] along u, from [2] to [3] along v */
} plane_field;

typedef struct plane_sample
{
  double value, gradient[2]; /* of the field, not relative to the iso value */
  double fluid, weight;      /* weight: the weight that trimming uses */
  double fluid_slope[2], weight_slope[2];
  double margin; /* how far inside of the trimmed surface */
} plane_sample;

/* Returns coordinate u (a = 0) or v (a = 1) of particle i. */
double plane_u(const plane_field* field, int64_t i, int a);
/* Returns the range of the field's values. */
double plane_range(const plane_field* field);
/* Evaluates the field at (u, v). The kernel in the plane is the oracle's kernel times h and the library's plane_factor;
 * test_core_plane checks that its integral is 1. */
plane_sample plane_evaluate(const plane_field* field, double u, double v);

/* Compares the surface with the squares of all levels (plane_squares.c): vertices on sides of squares with the crossed
 * sides, how lines join these vertices, and all vertices with the field. The test fails if a vertex is missing, or if
 * there is one too many. Returns how many sides are crossed. */
int64_t plane_compare(const plane_field* field, double iso, const mcor_surface* surface);
/* Checks the lines' directions, length and normals, and that each point is used once. closed: all lines must be
 * closed. */
void plane_check_lines(const plane_field* field, const mcor_surface* surface, int closed);

/* Returns options for one iso value and lines that are not trimmed. */
mcor_options plane_options(const double* iso);

/* Makes n x n particles of spacing 1 around the origin, displaced by up to `jitter` in the plane. Smoothing lengths are
 * from 1.3 to 1.3 * spread, volumes 1. */
particle_set plane_make(int n, double jitter, double spread, int axis, double at, uint64_t seed);

#endif
