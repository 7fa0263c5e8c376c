/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_period_h
#define core_period_h

/* Makes particles of one period, for tests. */

#include "core_fixture.h"

/* Makes particles of spacing about 1 in the box from the origin to `length`. The scalar is periodic. */
particle_set core_make_period(const int length[3], uint64_t seed);
/* Returns the set with its images in the neighbouring periods, along the axes that have a period. */
particle_set core_add_images(const particle_set* set, const double period[6]);
mcor_options core_period_options(const double* iso, const double period[6]);
/* Stretches the set and the period by a different factor along each axis, so that no cube edge
 * divides two of the periods. With these factors, moving a position by a period rounds nothing. */
void core_stretch_period(particle_set* set, double period[6]);

#endif
