/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_native_h
#define mcor_native_h

/* The built-in device: an OpenCL platform inside of this library, whose one device is the CPU, for which
 * the kernels were compiled with the library (CompileAhead.cmake). It has those functions of
 * OpenCL that are called for it: kernels are not timed, nor programs loaded, and a part of it is a number of
 * threads. All commands are done when their call returns. */

#include "mcor_parallel.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

/* Instruction sets: x86-64-v3 (AVX2) and -v4 (AVX-512); on other processors there is one. */
typedef enum mcor_instructions
{
  MCOR_INSTRUCTIONS_BASE, /* what the compiler takes for granted */
  MCOR_INSTRUCTIONS_V3,
  MCOR_INSTRUCTIONS_V4
} mcor_instructions;

/* A program compiled ahead. Its work-items [first, last) of kernel `number`; arguments: where each is. */
typedef void mcor_native_run(unsigned number, void* const* arguments, size_t first, size_t last);
typedef struct mcor_native_program
{
  const char*
    options; /* what mcor_program_options writes, from "-DMCOR_PROGRAM" on; NULL: the last */
  mcor_instructions instructions;
  mcor_native_run* run;
  /* The kernels' names, and their arguments, a letter each: b, a buffer, or 4 or 8, its bytes. Those of
   * one kernel end with a semicolon. */
  const char *kernels, *arguments;
} mcor_native_program;

/* Made by the build. */
extern const mcor_native_program mcor_native_programs[];

/* mcor_native_program.c. The best that this processor and its system have, of those for which programs are
 * compiled: a build may leave some out. -1: none. */
int mcor_best_instructions(void);
/* The program of these options for this processor; NULL: none. */
const mcor_native_program* mcor_find_program(const char* options);

/* NULL where this processor has none of the instruction sets. */
cl_platform_id mcor_native_platform(void);
/* Whether there is a program for these options, as given to clBuildProgram. */
bool mcor_native_has(const char* options);
/* The threads of a context, of which there may be fewer than the device has units. */
mcor_pool* mcor_native_pool(cl_context context);

#endif
