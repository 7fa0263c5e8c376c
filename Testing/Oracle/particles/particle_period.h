/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef particle_period_h
#define particle_period_h

/* Particles of a periodic box whose density is known in closed form. */

#include "mcor.h"
#include "oracle.h"

/* Lengths of the box, which begins at 0. Whole numbers, of particles too. */
extern const double particle_period_lengths[3];

/* Jittered; the scalar is the density, the smoothing length goes with it. Positions are multiples of
 * 2^-16, so that shifts by multiples of 1/2 leave them exact. */
particle_set particle_period_make(uint64_t seed);

/* Sets the period along all axes but those named. */
void particle_period_set(mcor_options* options, const char* open);
/* Stretches particles and periods, each axis by another factor: no cube then divides two periods. */
void particle_period_stretch(particle_set* particles, mcor_options* options);

#endif
