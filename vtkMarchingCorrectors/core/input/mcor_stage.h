/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_stage_h
#define mcor_stage_h

#include "mcor_box.h"
#include "mcor_input.h"

/* One slice of the input, as it is staged. */
typedef struct mcor_stage_slice
{
  int64_t used, to; /* number of images that are staged; where they begin */
  int64_t heavy;    /* the first particle whose weight is too large, or -1 */
  bool changed;     /* values differ from the measured ones: another thread writes to the arrays */
  double largest_weight; /* if there is a heavy particle, its weight */
  double farthest;          /* the largest reach, in cubes, of the particles that reach the box */
} mcor_stage_slice;

/* The input in the device's form, in input order, without unused solids. The arrays are views of
 * the stage's buffers of the same names; NULL: the device fills the buffer, because all elements
 * are the same. */
#define MCOR_STAGE_VIEWS 6
typedef struct mcor_staging
{
  mcor_context* context;
  const mcor_input* input;
  int count;
  void* x[3];                           /* fix */
  void *inv_h, *size;                   /* real; size: volume, mass or 1, negative for solids */
  void* level;                          /* uint8_t */
  mcor_mapping views[MCOR_STAGE_VIEWS]; /* views of the six arrays above, once these are mapped */
  int view_count;
  int64_t begin;            /* the first particle of the portion that is being staged */
  double size_scale;        /* see mcor_size_scale */
  double h_max;             /* greatest measured length of a kernel, unscaled, rounded up */
  mcor_reach_box* reach;    /* NULL: all particles are needed */
  bool one_inv_h, one_size; /* whether all elements of these arrays are known to be the same */
  uint8_t* images;          /* by particle: whether an image is staged; NULL without reach */
  mcor_stage_slice slices[MCOR_SLICES];
} mcor_staging;

/* Returns the factor from the input's unit of volumes or masses to the device's unit. */
double mcor_size_scale(mcor_context* context, const mcor_input* input);
/* Stages the input. The caller has set context and input. */
mcor_status mcor_stage(mcor_staging* staging);

/* Returns how many of the lowest bits are always 0 in the fixed-point positions of particles with
 * this support, see MCOR_POINT_EXTENT. cube: the length of the smallest cubes, or less; level: the
 * level of the cubes around the particles. */
int mcor_spared_bits(const mcor_context* context, double support, double cube, int level);

#endif
