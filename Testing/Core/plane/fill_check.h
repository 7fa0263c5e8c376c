/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef fill_check_h
#define fill_check_h

/* Facts that hold for any filled region. */

#include "plane_reference.h"

typedef struct fill_report
{
  double area,
    enclosed; /* of triangles; of the lines of the lowest iso value, if all are closed, else 0 */
  double inverted; /* of triangles that run round the other way */
  int64_t loose;   /* edges on the border that are no lines */
  double loose_length;
} fill_report;

/* Fails unless two triangles, or one and the border, are at each edge, all round alike; all lines of the least
 * iso value are on the border, all others between the bands beside them; and there are no other edges
 * between bands. */
fill_report fill_check(const plane_field* field, const mcor_surface* surface);
/* Fails unless points are where they say they are: on an iso value, on a threshold, or between. */
void fill_check_points(const plane_field* field, const mcor_surface* surface);
/* The area by sampling, n x n points. */
double fill_sample(const plane_field* field, double iso, int n);

#endif
