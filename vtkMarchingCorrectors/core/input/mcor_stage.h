/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_stage_h
#define mcor_stage_h

#include "mcor_box.h"
#include "mcor_input.h"

/* The input in the device's form, in input order; solids that are not used left out. Arrays are
 * views of the buffers named like them. */
typedef struct mcor_staging
{
  int count;
  void* x[3];         /* fix */
  void *inv_h, *size; /* real; size: volume, mass, or 1, below 0 of solids */
  double size_scale;  /* see mcor_size_scale */
  void* level;        /* uint8_t */
} mcor_staging;

/* The factor of the input's volume or mass on the way to the device. */
double mcor_size_scale(mcor_context* context, const mcor_input* input);
mcor_status mcor_stage(mcor_context* context, const mcor_input* input, mcor_staging* staging);
mcor_status mcor_unmap_staging(mcor_context* context, mcor_staging* staging);

/* How many digits shorter than fixed-point numbers the positions of particles with a support are, see
 * MCOR_POINT_EXTENT; cube: as long as one is, or shorter. */
int mcor_spared_bits(const mcor_context* context, double support, double cube, int level);

/* ---- mcor_stage_chunk.c ---- */

/* Particles of a chunk in the staging arrays' units. */
typedef struct mcor_stage_chunk
{
  int count;
  double x[3][MCOR_CHUNK], h[MCOR_CHUNK], size[MCOR_CHUNK];
  int32_t source[MCOR_CHUNK];
} mcor_stage_chunk;

/* Where they are, and how large; count is set. reach: NULL, or what tells of a period. */
void mcor_read_stage_places(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_reach_box* reach, mcor_stage_chunk* chunk);
/* And their volumes or masses. */
void mcor_read_stage_chunk(const mcor_context* context, const mcor_input* input, int64_t first,
  const mcor_staging* staging, const mcor_reach_box* reach, mcor_stage_chunk* chunk);

/* A weight beyond would be infinite on the device. */
double mcor_weight_limit(const mcor_context* context);
/* Weight of particle i of a chunk on the device: large where the volume is huge against the smoothing
 * length. */
double mcor_stage_weight(const mcor_context* context, const mcor_stage_chunk* chunk, int i);
/* Input index of the first particle of a chunk whose weight is too large; -1 if there is none. The
 * largest one is kept. */
int64_t mcor_find_heavy(const mcor_context* context, const mcor_input* input,
  const mcor_stage_chunk* chunk, double* largest_weight);

/* To element `to` of the staging arrays; changes the chunk. */
void mcor_store_stage_chunk(const mcor_context* context, const mcor_input* input,
  mcor_stage_chunk* chunk, const mcor_staging* staging, int64_t to);
/* To `array` from element `first` on, in the device's precision. */
void mcor_store_reals(
  const mcor_context* context, void* array, int64_t first, const double* values, int count);

#endif
