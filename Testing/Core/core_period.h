/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_period_h
#define core_period_h

/* Particles of one period, for tests. */

#include "core_fixture.h"

/* Particles of spacing 1 in a box at the origin with sides of these lengths; the scalar repeats. */
particle_set core_make_period(const int length[3], uint64_t seed);
/* The set and its images in all 27 periods, or those along the axes that have one. */
particle_set core_add_images(const particle_set* set, const double period[6]);
mcor_options core_period_options(const double* iso, const double period[6]);
/* So that no cube divides two of the periods, by numbers that keep positions exact a period away. */
void core_stretch_period(particle_set* set, double period[6]);

#endif
