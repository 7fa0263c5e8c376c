/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_parts_h
#define core_parts_h

/* Compares the surfaces of boxes that divide the lattice with the whole surface. */

#include "core_fixture.h"

/* The triangles of several surfaces, as records of bytes. A record has the triangle's key, if it has one, then all
 * arrays of its three corners. A piece of a line is kept as a triangle that has the second end twice. */
typedef struct core_triangles
{
  int64_t count;
  size_t width; /* bytes of a triangle */
  unsigned char* bytes;
} core_triangles;

/* Sorts records by their bytes. */
void core_sort_records(void* records, int64_t count, size_t width);
/* Writes all arrays of a point, with its key if `keys` is set, and returns where the next point goes. */
unsigned char* core_put_point(
  unsigned char* to, const mcor_input* input, mcor_surface* s, int64_t i, bool keys);
void core_add_surface(core_triangles* triangles, const mcor_input* input, mcor_surface* s);
/* Sorts `all` and `whole`, and fails unless they have the same triangles, byte for byte. */
void core_expect_same(const char* name, core_triangles* all, core_triangles* whole);

/* Planes that cut the lattice into boxes; the outer boxes reach to infinity. */
typedef struct core_cut
{
  const char* name;
  int count[3];
  double at[3][3];
} core_cut;

#define CORE_CUTS 5
extern const core_cut core_cuts[CORE_CUTS];
/* Sets options->box to one box of a cut. */
void core_set_box(mcor_options* options, const core_cut* cut, const int at[3]);
/* Extracts the boxes of each of core_cuts, and fails unless the boxes' surfaces make up the whole surface, bit for bit,
 * with all arrays of points. */
void core_check_cuts(
  mcor_context* context, const char* name, const mcor_input* input, const mcor_options* options);

/* Does what core_check_cuts does, with the caller's cuts in place of core_cuts. */
void core_check_these_cuts(mcor_context* context, const char* name, const mcor_input* input,
  const mcor_options* options, const core_cut* cuts, int count);

/* Makes calls write keys, and all arrays of points except the boundary eigenvalue and curvatures. */
void core_ask_for_all(mcor_options* options);

/* Appends particle i of the set to `near` unless the particle is `margin` or farther from the box along an axis. */
void core_add_near(
  particle_set* near, const particle_set* set, int64_t i, const double box[6], double margin);
/* Returns all particles within `margin` of the box, in reverse order. */
particle_set core_take_near(const particle_set* set, const double box[6], double margin);

#endif
