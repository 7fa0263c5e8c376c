/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_period_h
#define oracle_period_h

/* Periodic boxes, for oracle_reference.c and oracle_case.c: the particles and images of them as plain
 * particles, one period's cells of the lattice, and the surface glued to itself. */

#include "mcor.h"
#include "mesh_check.h"
#include "oracle.h"

#ifdef __cplusplus
extern "C"
{
#endif

  /* Whether the particles repeat along any axis. */
  int oracle_is_periodic(const mcor_options* options);

  /* The largest cube, not larger than this one, that all periods are whole numbers of; where there is none of
   * more than half of it, of each period the largest edge that it is a whole number of. */
  void oracle_fit_edges(const mcor_options* options, double cube, double edge[3]);

  /* Takes the particles into the period, and adds all images whose support (h times `support`), or
   * `margin` if that is more, reaches it or what lies within two cubes of it. Returns what
   * particle i is an image of; to be freed. */
  int64_t* oracle_add_images(particle_set* particles, const mcor_options* options, double support,
    double margin, double cube);

  /* One period's cells: those with their centres in it. Axes without a period stay as they are. */
  void oracle_own_period(
    const mcor_options* options, const double edge[3], int64_t first[3], int64_t end[3]);

  typedef struct oracle_seam
  {
    int64_t joined;    /* edges of the border that are one with another, a period away */
    int64_t open;      /* other ones that nothing explains */
    int64_t torn;      /* that have more than two triangles, or two of unlike orientation */
    int64_t different; /* points that are not, bit for bit, what they are a period away */
  } oracle_seam;

  /* Glues opposite sides of the surface together: points that are a period apart become one. edge: of the
   * cubes. */
  oracle_seam oracle_check_seam(const mcor_options* options, const double edge[3],
    const mcor_surface* surface, const mesh_report* mesh);

#ifdef __cplusplus
}
#endif

#endif
