/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_program_h
#define mcor_program_h

/* Which kernel sources make up which program, and the options that they are compiled with. Nothing
 * here calls OpenCL. */

#include "mcor_cl.h"

#define MCOR_SOURCE_LIMIT 64

/* An OpenCL source. The build makes the list of all sources (kernels/programs.cmake). */
typedef struct mcor_kernel_source
{
  const char* text; /* NULL ends the list */
  int programs;     /* bits of mcor_program */
  enum
  {
    MCOR_ANY_FORM,
    MCOR_CPU_FORM,
    MCOR_GPU_FORM
  } form; /* the form of kernels that needs this source */
} mcor_kernel_source;
extern const mcor_kernel_source mcor_kernel_sources[];

/* Returns, as bits 1 << mcor_program, the programs whose kernels `program` contains. Without
 * cl->builds_sets, it contains only its own kernels. With cl->builds_sets, MCOR_PROGRAM_GRID,
 * _NODES and _PROBE contain all kernels of their set (see MCOR_PARTS_LATTICE), the others none. */
int mcor_parts_of(const mcor_cl* cl, mcor_program program);
/* Returns the program that has a kernel; the beginning of the kernel's name tells which. */
mcor_program mcor_program_of(const mcor_cl* cl, const char* kernel);
/* Lists the sources of a set of programs, in order; returns their number. */
int mcor_program_sources(const mcor_cl* cl, int programs, const char* sources[MCOR_SOURCE_LIMIT]);
/* Names a build for an error sentence: "the SPH kernel sinc6". */
#define MCOR_BUILD_NAME 80
void mcor_name_build(const mcor_build* build, char* text, size_t size);

/* Whether the built-in device has the programs of a build. */
bool mcor_has_ahead(const mcor_cl* cl, const mcor_build* build);
void mcor_program_options(const mcor_cl* cl, mcor_program program, char* text, size_t size);

#endif
