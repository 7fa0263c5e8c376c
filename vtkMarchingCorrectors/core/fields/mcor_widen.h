/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_widen_h
#define mcor_widen_h

#include "mcor_internal.h"

/* Reads the volumes that were computed, [count], unit L^3, from the search grid's weights; 1 where
 * a particle is not on the device, or not in the box. */
mcor_status mcor_read_volumes(mcor_context* context, const mcor_input* input, double* volume);

#endif
