/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_column_h
#define mcor_column_h

/* Columns of an SPH kernel, seen along a line of sight: how much of it, which is 1 in all, projects
 * onto a rectangle. Lengths are in h. */

#include "mcor_internal.h"

/* E(x, y): the share of the kernel that projects onto the rectangle from a corner of the table,
 * or the centre, to (x, y). A rectangle has the mixed difference of E at its corners, so
 * rectangles side by side add up to 1 exactly, but for rounding. */
typedef struct mcor_column
{
  bool is_radial;  /* as all kernels but products are */
  bool is_odd;     /* E is odd in x and y: tabulated from the centre on */
  int cells;       /* along x, and along y */
  double reach[2]; /* of the kernel along x and y */
  double highest;  /* column density at the centre, the greatest */
  double* nodes;   /* [cells + 1][cells + 1][4], y first: E, dE/dx, dE/dy, d2E/dxdy, in cells */
} mcor_column;

/* The side of a rectangle: a cubic Hermite interpolant's cell, and weights of value and slope at
 * both ends. */
typedef struct mcor_column_side
{
  int cell;
  double weight[4];
} mcor_column_side;

/* Returns the reach of a kernel of h = 1 along a unit vector. */
double mcor_column_reach(mcor_sph_kernel kernel, const double along[3]);

/* axes: unit vectors along x and y of the image and the line of sight. is_plane: the kernel of two
 * dimensions, as it is. least_pixel: the side of a pixel, in the greatest h. Free with
 * mcor_free_column, whatever the status. */
mcor_status mcor_make_column(mcor_context* context, mcor_sph_kernel kernel, bool is_plane,
  const double axes[3][3], double least_pixel, mcor_column* column);
void mcor_free_column(mcor_column* column);

/* Finds a side at `at` along x (axis 0) or y. */
mcor_column_side mcor_side_of(const mcor_column* column, int axis, double at);
/* Finds E at the corners that `count` sides along x share with one along y. */
void mcor_sum_corners(const mcor_column* column, const mcor_column_side* sides, int count,
  const mcor_column_side* side, double* sums);

#endif
