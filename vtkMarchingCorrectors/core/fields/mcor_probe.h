/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_probe_h
#define mcor_probe_h

/* A call of mcor_probe that is under way. */

#include "mcor_input.h"

typedef struct mcor_probe_run
{
  mcor_context* context;
  const mcor_input* input;
  const mcor_array* points; /* of three components */
  int64_t point_count;
  mcor_samples* samples;
  bool is_sum;
  double* weights_with_solids; /* weight sums of fluid and solids at the points; NULL: not wanted */
  mcor_point_batch batch;
  mcor_buffer weight, weight_with_solids, sums, weight_gradient, gradients;
  struct /* views of the batch, and of the device's results */
  {
    void *node, *offset, *order, *weight, *weight_with_solids, *sums, *weight_gradient, *gradients;
  } view;
  mcor_findings slices[MCOR_SLICES]; /* nodes of points that particles may reach, and how many */
  int64_t first;                     /* first point of the batch */
  int count, inside; /* numbers of points in the batch: all; those in reach */
} mcor_probe_run;

/* If the options have a box, restricts the present call to particles near the box. Returns whether
 * there is a box. */
bool mcor_bound_by_box(mcor_context* context, const mcor_options* options);

/* Writes sorted particles [first, first + count) to the batch as points. points.flags tells whether
 * each particle is in the box, i.e. in the cells from `cells` to `end`; particles outside of the
 * box get node -1. Without has_box, all particles count as inside. */
mcor_status mcor_place_particles(mcor_context* context, mcor_point_batch* batch, int first,
  int count, bool has_box, const int cells[3], const int end[3]);

/* Evaluates at points [first, last) the attributes that the device holds. Writes run->samples. */
mcor_status mcor_probe_batch(mcor_probe_run* run, int64_t first, int64_t last);
void mcor_release_probe(mcor_probe_run* run);
/* For each attribute, makes an array of zeros, [count][components][numbers]; NULL for attributes
 * with not_finite >= 0. Free *arrays with mcor_free_arrays, even after a failure. */
mcor_status mcor_make_arrays(mcor_context* context, const mcor_input* input,
  const int64_t* not_finite, int64_t count, int numbers, double*** arrays);
void mcor_free_arrays(double** arrays, int count);
/* Ends a call that makes no surface. */
mcor_status mcor_finish_field(mcor_context* context);

/* mcor_widen.c. Makes *volume: the computed volumes [count], in unit L^3 or, in two dimensions,
 * L^2. They come from the weights in the search grid. Particles that are not on the device or not
 * in the box get 1. The caller frees *volume, even after a failure. */
mcor_status mcor_read_volumes(mcor_context* context, const mcor_input* input, double** volume);

#endif
