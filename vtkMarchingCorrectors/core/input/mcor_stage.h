/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_stage_h
#define mcor_stage_h

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

/* What the input's volume or mass is multiplied by on the way to the device. */
double mcor_size_scale(const mcor_context* context, const mcor_input* input);
mcor_status mcor_stage(mcor_context* context, const mcor_input* input, mcor_staging* staging);
mcor_status mcor_unmap_staging(mcor_context* context, mcor_staging* staging);

/* How many digits shorter than fixed-point numbers the positions of particles with a support are, see
 * MCOR_POINT_EXTENT; cube: as long as one is, or shorter. */
int mcor_spared_bits(const mcor_context* context, double support, double cube, int level);

#endif
