/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_plane_h
#define mcor_plane_h

/* Two dimensions. Particles that share one coordinate lie, for all phases, in the plane z = 0: the caller's
 * coordinates are turned at the border, (u, v, w) with w the constant one, and turned back in the result.
 * There the sums of three dimensions are those of two, if a particle's weight is c h times what it is (c:
 * mcor_plane_factor). The lattice is one layer of cells above the plane; what its nodes in the plane are
 * counts for those above, so that lines are where the surface of three dimensions would cross the plane.
 * Until they are handed over, lines are triangles whose last two corners are one. */

#include "mcor_internal.h"

/* The caller's input and options, turned. */
typedef struct mcor_flat
{
  mcor_input input;
  mcor_options options;
  mcor_globals globals;
  mcor_ranks ranks;
  void* positions;
} mcor_flat;

static inline bool mcor_is_plane(const mcor_context* context)
{
  return context->plane.axis > 0;
}

/* Finds whether the particles lie in a plane, into context->plane, and turns what lies in one. */
mcor_status mcor_flatten(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat);
/* Points turned likewise, in *flat, to be freed: those off the plane become NaN. */
mcor_status mcor_flatten_points(mcor_context* context, const mcor_array* points, int64_t count,
  mcor_array* turned, double** flat);
/* The sides of a box, turned: of a plane inside all, else nothing. */
void mcor_flatten_sides(const mcor_plane* plane, const double from[6], double to[6]);
/* Turns the measures over all particles, or turns them back. */
void mcor_turn_measure(mcor_measure* measure, bool back);
/* Turns the numbers of the lattice and the extent back. */
void mcor_unflatten_statistics(const mcor_plane* plane, mcor_statistics* statistics);

/* The axis of the caller along which turned coordinate a goes; a = 2: the constant one. */
static inline int mcor_plane_axis(const mcor_plane* plane, int a)
{
  return (plane->axis + a) % 3;
}
/* The letter of that axis, of the call under way. */
static inline char mcor_axis_letter(const mcor_context* context, int a)
{
  return "xyz"[mcor_plane_axis(&context->plane, a)];
}

/* Turns three numbers of `width` bytes back, in place; the same of [count][3], where the constant coordinate becomes
 * `constant`. */
void mcor_turn_back(const mcor_plane* plane, void* numbers, size_t width);
void mcor_unflatten_doubles(
  const mcor_plane* plane, double* numbers, int64_t count, double constant);

/* Normalisation of the SPH kernel in two dimensions over that in three. */
double mcor_plane_factor(mcor_sph_kernel kernel);

/* Marching squares: what nodes in the plane are, those above are too; nothing else is a brick. */
mcor_status mcor_spread_signs(mcor_context* context);
mcor_status mcor_find_seeds_in_plane(mcor_context* context);
/* Keeps of all cells those that are squares. */
mcor_status mcor_keep_squares(mcor_context* context, mcor_buffer* cells);

/* mcor_plane_lines.c: normals from lines where the gradient gives none, while all of the box's ring are there. */
mcor_status mcor_finish_line_normals(mcor_context* context, mcor_surface* surface);
/* Makes the polylines of the surface from the lines that its triangles stand for, and
 * turns all back. */
mcor_status mcor_finish_lines(mcor_context* context, mcor_surface* surface);

#endif
