/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_program_h
#define mcor_program_h

/* Which kernel sources make which program, and what they are compiled for. No OpenCL calls. */

#include "mcor_cl.h"

#define MCOR_SOURCE_LIMIT 32

/* The sources of a program, in order; returns how many. */
int mcor_program_sources(
  const mcor_cl* cl, mcor_program program, const char* sources[MCOR_SOURCE_LIMIT]);
/* False where a look into the program for this kernel, which builds it, is in vain. */
bool mcor_program_may_have(mcor_program program, const char* kernel);
void mcor_program_options(const mcor_cl* cl, mcor_program program, char* text, size_t size);

#endif
