/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_period_h
#define oracle_period_h

/* Periodic boxes for oracle_reference.c and oracle_case.c: adds images as particles, finds the cells of one period, and
 * joins the surface with itself at opposite sides. */

#include "mcor.h"
#include "mesh_check.h"
#include "oracle.h"

#ifdef __cplusplus
extern "C"
{
#endif

  /* Returns whether the particles repeat along any axis. */
  int oracle_is_periodic(const mcor_options* options);

  /* Writes the edges of cubes along x, y, z; none is larger than `cube`. All get the largest edge that divides all
   * periods, if it is at least half of `cube`. Else an axis gets the largest edge that divides its own period; an axis
   * without a period gets the longest edge of the other axes. */
  void oracle_fit_edges(const mcor_options* options, double cube, double edge[3]);

  /* Moves the particles into the period, and adds all images that matter. An image reaches as far as its support (h
   * times `support`), or `margin` if this is larger; it matters if it reaches the period or two cubes around it.
   * Returns, for each particle, the particle of which it is an image; free the result. */
  int64_t* oracle_add_images(particle_set* particles, const mcor_options* options, double support,
    double margin, double cube);

  /* Writes the range of cells whose centres are in the period. Axes without a period stay unchanged. */
  void oracle_own_period(
    const mcor_options* options, const double edge[3], int64_t first[3], int64_t end[3]);

  typedef struct oracle_seam
  {
    int64_t joined;    /* edges of the border that match an edge a period away */
    int64_t open;      /* other border edges, without an explanation */
    int64_t torn;      /* edges with more than two triangles, or with two of unlike orientation */
    int64_t different; /* points that are not, bit for bit, equal to their partner a period away */
  } oracle_seam;

  /* Joins points of the surface that are a period apart, at opposite sides. Returns what does not match. edge: the
   * edges of cubes along x, y, z. */
  oracle_seam oracle_check_seam(const mcor_options* options, const double edge[3],
    const mcor_surface* surface, const mesh_report* mesh);

#ifdef __cplusplus
}
#endif

#endif
