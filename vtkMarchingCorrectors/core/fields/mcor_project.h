/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_project_h
#define mcor_project_h

/* The image of a projection, and the particles that are spread over it. */

#include "mcor_input.h"
#include "mcor_vector.h"

/* ---- mcor_column.c ----
 *
 * Integrates an SPH kernel along the line of sight, and finds which share of it projects onto a
 * rectangle. Lengths are in h. */

/* E(x, y): the share of the kernel that projects onto the rectangle from the table's lower corner,
 * or from the centre if is_odd, to (x, y). A rectangle's share is the mixed difference of E at its
 * corners, so the shares of rectangles side by side add up to 1, except for rounding. */
typedef struct mcor_column
{
  bool is_radial;  /* the kernel depends on the distance alone, as all but tensor kernels do */
  bool is_odd;     /* E is odd in x and y, so the table begins at the centre */
  int cells;       /* number of cells along x, and along y */
  double reach[2]; /* reach of the kernel along x and y */
  double highest;  /* column density at the centre, which is the greatest */
  double* nodes;   /* [cells + 1][cells + 1][4], y first: E, dE/dx, dE/dy, d2E/dxdy, in cells */
} mcor_column;

/* Where a side of a rectangle lies in the table: the cell, and the weights with which cubic Hermite
 * interpolation takes the value and the slope at both ends of the cell. */
typedef struct mcor_column_side
{
  int cell;
  double weight[4];
} mcor_column_side;

/* Returns how far a kernel of h = 1 reaches along a unit vector. */
double mcor_column_reach(mcor_sph_kernel kernel, const double along[3]);

/* Returns the table's cell, and the weights, for a rectangle's side at `at` (in h) along x (axis 0)
 * or y (axis 1). */
mcor_column_side mcor_side_of(const mcor_column* column, int axis, double at);
/* Writes E at `count` corners to `sums`: where each of `sides` along x meets `side` along y. */
void mcor_sum_corners(const mcor_column* column, const mcor_column_side* sides, int count,
  const mcor_column_side* side, double* sums);

/* ---- The image ---- */

/* A particle, or a periodic image of it, in pixels. V: its volume; A: the scalar or the density; B:
 * the weight of a mean. */
typedef struct mcor_splat
{
  double at[2];          /* position from the image's lower corner, in pixels */
  double pixel[2];       /* side of a pixel, in h */
  double amount[2];      /* V A; or, for a mean, V B A and V B; each divided by a pixel's area */
  int first[2], last[2]; /* first and last pixel that the particle reaches */
} mcor_splat;

typedef struct mcor_project_job
{
  mcor_context* context;
  const mcor_input* input;
  const mcor_view* view;
  mcor_projection* out;
  double axes[3][3]; /* out->axes, in the axes of the turned particles */
  bool is_aligned;   /* the image's axes are axes of the particles, too */
  bool places_only;  /* only the image's frame is wanted */
  double box[6];     /* the box in turned axes; sides that are not given are infinite */
  double period[3];  /* periods; 0: open */
  double* volumes;   /* computed volumes; else NULL */
  double h_scale;
  mcor_column column;
  int channels; /* 2 for a mean, else 1 */
  /* [channel][coarse, fine]: 3/2 of a power of 2. Adding such a unit to a number and subtracting it
   * again rounds the number to the unit's last digit. Then the rest is rounded by the fine unit. */
  double unit[2][2];
  double* sums;           /* [channels][2][pixels]: of the rounded numbers; of the rounded rests */
  int64_t first;          /* first of the particles of this step */
  int bands;              /* number of bands of rows of the image */
  pthread_mutex_t* locks; /* [bands]; NULL in the first pass */
  /* Work space of each slice: sides of a row's pixels, and E at the row's lower and upper corners. */
  mcor_column_side* sides; /* [MCOR_SLICES][size[0] + 1] */
  double* corners;         /* [MCOR_SLICES][2][size[0] + 1] */
  mcor_findings slices[MCOR_SLICES];
} mcor_project_job;

/* Whether the image shows the density, because there is no scalar. The density comes from masses
 * or, without masses, from volumes times densities. */
static inline bool mcor_projects_density(const mcor_input* input)
{
  return !input->scalar.data;
}

/* Whether a particle counts for the image: it is fluid, and view->counted, if given, marks it. */
static inline bool mcor_is_projected(const mcor_project_job* job, int64_t i)
{
  return !(job->input->solid && job->input->solid[i]) &&
    (!job->view->counted || job->view->counted[i]);
}

/* mcor_column.c. Makes the table. In two dimensions, the table holds integrals of the kernel
 * itself, not of its integral along the line of sight. least_pixel: the shorter side of a pixel /
 * the greatest h. The caller frees column->nodes, even after a failure. */
mcor_status mcor_make_column(
  const mcor_project_job* project, double least_pixel, mcor_column* column);

/* mcor_project_spread.c. Spreads all particles over the image, whose sides are known. Reports
 * progress, and makes out->values. */
mcor_status mcor_spread_particles(mcor_project_job* job);

#endif
