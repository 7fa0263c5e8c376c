/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_plane_h
#define mcor_plane_h

/* Two dimensions. Particles that share one coordinate lie in the plane z = 0 for all phases. A call
 * first turns the caller's coordinates to (u, v, w) with a constant w, and turns its results back
 * at the end. In the plane, sums in three dimensions equal sums in two, because each particle's
 * weight is multiplied by c h (c: plane_factor). The lattice is one layer of cells above the plane,
 * and its upper nodes copy the lower nodes, so that lines lie where the surface in three dimensions
 * would cross the plane. Until the output, a line is a triangle with two equal corners. */

#include "mcor_internal.h"

/* The caller's input and options, turned into the plane. */
typedef struct mcor_flat
{
  mcor_input input;
  mcor_options options;
  mcor_globals globals;
  mcor_ranks ranks;
  double* positions;
} mcor_flat;

static inline bool mcor_is_plane(const mcor_context* context)
{
  return context->plane.axis > 0;
}

/* Finds whether the particles lie in a plane, sets context->plane and `space`, and copies input and
 * options to *flat. */
mcor_status mcor_find_plane(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat);
/* Turns the copies of input and options, in *flat, into the plane z = 0. */
mcor_status mcor_flatten(
  mcor_context* context, const mcor_input* input, const mcor_options* options, mcor_flat* flat);
/* Turns positions into the plane. *turned becomes an array of the values *flat, which the caller
 * frees. are_points: the positions are points, not particles; points off the plane become NaN. */
mcor_status mcor_flatten_positions(mcor_context* context, const mcor_array* positions,
  int64_t count, bool are_points, mcor_array* turned, double** flat);
/* Turns the sides of a box into the plane's axes. Across the plane, the box becomes infinite if it
 * contains the plane, else empty. */
void mcor_flatten_sides(const mcor_plane* plane, const double from[6], double to[6]);
/* Turns the measures of all particles into the plane's axes or, if `back` is set, back. */
void mcor_turn_measure(mcor_measure* measure, bool back);
/* Turns the statistics that belong to axes (lattice, extent, far_place) back to the caller's
 * axes. */
void mcor_unflatten_statistics(const mcor_plane* plane, mcor_statistics* statistics);

/* Returns the caller's axis of turned coordinate a; a = 2 is the constant coordinate. */
static inline int mcor_plane_axis(const mcor_plane* plane, int a)
{
  return (plane->axis + a) % 3;
}
/* The current call may have turned the axes. Returns the caller's letter, x, y or z, for axis a. */
static inline char mcor_axis_letter(const mcor_context* context, int a)
{
  return "xyz"[mcor_plane_axis(&context->plane, a)];
}

/* Turns [count][3] numbers back to the caller's axes; the constant coordinate of each becomes
 * `constant`. */
void mcor_unflatten_doubles(
  const mcor_plane* plane, double* numbers, int64_t count, double constant);

/* Keeps only the cells that are squares of the plane. */
mcor_status mcor_keep_squares(mcor_context* context, mcor_buffer* cells);

/* Where the gradient gives no normal, makes a normal at right angles to the lines at the point. The
 * lines in the ring of cells around the box must not be removed yet. */
mcor_status mcor_finish_line_normals(mcor_context* context, mcor_surface* surface);
/* Makes the surface's polylines from the triangles that stand for lines, and turns the surface back
 * to the caller's axes. */
mcor_status mcor_finish_lines(mcor_context* context, mcor_surface* surface);

/* mcor_fill.c. If options.filled is set, mcor_begin_fill checks that the filled regions have an
 * end, and evaluates the field at the nodes. */
mcor_status mcor_begin_fill(mcor_context* context);
/* mcor_take_lines keeps the trimmed lines of the current iso value; mcor_number_lines notes the
 * numbers of their points. Both do nothing if lines are not filled. */
mcor_status mcor_take_lines(mcor_context* context);
void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base);
void mcor_end_fill(mcor_context* context);
/* Appends the triangles of the filled regions to the surface, after its lines, which are stored as
 * triangles until the output. Call it once, after the last iso value. */
mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface);

#endif
