/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_stage_h
#define mcor_stage_h

#include "mcor_box.h"
#include "mcor_input.h"

/* The input in the device's form, in input order, without unused solids. The arrays are views of
 * the buffers of the same names. */
typedef struct mcor_staging
{
  int count;
  void* x[3];         /* fix */
  void *inv_h, *size; /* real; size: volume, mass or 1, negative for solids */
  double size_scale;  /* see mcor_size_scale */
  void* level;        /* uint8_t */
} mcor_staging;

/* Returns the factor from the input's volume or mass to the device's. */
double mcor_size_scale(mcor_context* context, const mcor_input* input);
mcor_status mcor_stage(mcor_context* context, const mcor_input* input, mcor_staging* staging);
mcor_status mcor_unmap_staging(mcor_context* context, mcor_staging* staging);

/* Returns how many digits shorter than fixed-point numbers the positions of particles with this
 * support are, see MCOR_POINT_EXTENT. cube: a cube's length, or less. */
int mcor_spared_bits(const mcor_context* context, double support, double cube, int level);

/* ---- mcor_stage_chunk.c ---- */

/* A chunk of particles, in the units of the staging arrays. */
typedef struct mcor_stage_chunk
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], size[MCOR_CHUNK]; /* h: the kernel's length */
  uint8_t level[MCOR_CHUNK]; /* of adaptive cubes */
  int32_t source[MCOR_CHUNK];
} mcor_stage_chunk;

/* Reads positions and smoothing lengths of a chunk whose count is set. reach: NULL, or the box
 * and period. */
void mcor_read_stage_places(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_reach_box* reach, mcor_stage_chunk* chunk);
/* Reads their volumes or masses, too. */
void mcor_read_stage_chunk(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_staging* staging, const mcor_reach_box* reach, mcor_stage_chunk* chunk);

/* Returns the weight above which the device's numbers would be infinite. */
double mcor_weight_limit(const mcor_context* context);
/* Returns the weight of particle i of a chunk on the device: large where the volume is huge
 * against the smoothing length. */
double mcor_stage_weight(const mcor_context* context, const mcor_stage_chunk* chunk, int i);
/* Returns the input index of the first particle of a chunk whose weight is too large, else -1.
 * Keeps the largest weight. */
int64_t mcor_find_heavy(const mcor_context* context, const mcor_input* input,
  const mcor_stage_chunk* chunk, double* largest_weight);

/* Writes a chunk to element `to` of the staging arrays; changes the chunk. */
void mcor_store_stage_chunk(const mcor_context* context, const mcor_input* input,
  mcor_stage_chunk* chunk, const mcor_staging* staging, int64_t to);
/* Writes numbers to `array` from element `first` on, in the device's precision. */
void mcor_store_reals(
  const mcor_context* context, void* array, int64_t first, const double* values, int count);

#endif
