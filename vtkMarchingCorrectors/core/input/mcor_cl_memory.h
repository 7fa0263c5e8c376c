/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cl_memory_h
#define mcor_cl_memory_h

/* Inputs with arrays in OpenCL buffers of the caller, see mcor_array.memory. */

#include "mcor.h"

/* An input whose arrays the host can read. If all members are zero, there is no input yet. */
typedef struct mcor_sight
{
  mcor_input input;
  mcor_array* attributes; /* of this input */
  struct mcor_memory* seen; /* [count] */
  int count;
} mcor_sight;

/* Lets the host see an input's arrays. Call mcor_end_sight afterwards, even after a failure. */
mcor_status mcor_see_input(mcor_context* context, const mcor_input* input, mcor_sight* sight);
void mcor_end_sight(mcor_sight* sight);

#endif
