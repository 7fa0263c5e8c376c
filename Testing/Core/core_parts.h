/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_parts_h
#define core_parts_h

/* Surfaces of boxes that part the lattice, against the whole surface. */

#include "core_fixture.h"

/* Triangles of some surfaces, and pieces of lines, whose second end is there twice: the bytes of their corners, one
 * after the other. */
typedef struct core_triangles
{
  int64_t count;
  size_t width; /* bytes of a triangle */
  unsigned char* bytes;
} core_triangles;

/* Sorts records by their bytes. */
void core_sort_records(void* records, int64_t count, size_t width);
/* All that a point carries; returns where the next one goes. Keys number the bricks. */
unsigned char* core_put_point(
  unsigned char* to, const mcor_input* input, mcor_surface* s, int64_t i, bool keys);
void core_add_surface(core_triangles* triangles, const mcor_input* input, mcor_surface* s);
/* Sorts both; each triangle of one must be in the other, too, with all its bytes. */
void core_expect_same(const char* name, core_triangles* all, core_triangles* whole);

/* Planes that cut the lattice; ends are at infinity. */
typedef struct core_cut
{
  const char* name;
  int count[3];
  double at[3][3];
} core_cut;

#define CORE_CUTS 5
extern const core_cut core_cuts[CORE_CUTS];
/* One of a cut's boxes. */
void core_set_box(mcor_options* options, const core_cut* cut, const int at[3]);
/* Each cut's boxes make the whole surface, with all its points carry. */
void core_check_cuts(
  mcor_context* context, const char* name, const mcor_input* input, const mcor_options* options);

/* As core_check_cuts, with other cuts. */
void core_check_these_cuts(mcor_context* context, const char* name, const mcor_input* input,
  const mcor_options* options, const core_cut* cuts, int count);

/* Arrays and keys of points, to be compared. */
void core_ask_for_all(mcor_options* options);

/* Appends particle i of the set to `near`, which has room, if it is not farther than `margin` from the box. */
void core_add_near(
  particle_set* near, const particle_set* set, int64_t i, const double box[6], double margin);
/* All that are so near, in another order. */
particle_set core_take_near(const particle_set* set, const double box[6], double margin);

#endif
