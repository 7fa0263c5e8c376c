/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef cap_check_h
#define cap_check_h

/* Facts that hold for any surface with caps, whatever they close. */

#include "core_fixture.h"

/* Fails unless the surface without caps is the beginning of the one with caps, which are the rest of it. */
void cap_check_prefix(const mcor_surface* open, const mcor_surface* closed);
/* Fails unless the volume is that between `planes` where the field is above the iso value, and solids have no more than
 * the wall share, if there is one, of all weight: the oracle's, at random places. */
void cap_check_volume(const mcor_surface* closed, const particle_set* set,
  const mcor_options* options, const double planes[6]);

#endif
