/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_native_h
#define mcor_native_h

/* The built-in device: an OpenCL platform inside this library. Its one device is the CPU, for which
 * the kernels were compiled with the library (CompileAhead.cmake). The platform has only the
 * functions of OpenCL that this library calls. Kernels are not timed. If processes share the CPU,
 * each process has a share of the threads. Each command is done when its call returns. */

#include "mcor_parallel.h"

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

/* Instruction sets: x86-64-v3 (AVX2) and -v4 (AVX-512). Other processors have only the base set. */
typedef enum mcor_instructions
{
  MCOR_INSTRUCTIONS_BASE, /* what the compiler assumes by default */
  MCOR_INSTRUCTIONS_V3,
  MCOR_INSTRUCTIONS_V4
} mcor_instructions;

/* Runs the work-items [first, last) of kernel `number` of a program; arguments: pointers to the
 * kernel's arguments. */
typedef void mcor_native_run(unsigned number, void* const* arguments, size_t first, size_t last);
typedef struct mcor_native_program
{
  /* What mcor_program_options writes, from "-DMCOR_PROGRAM" on. NULL ends the list of programs. */
  const char* options;
  mcor_instructions instructions;
  mcor_native_run* run;
  /* kernels: the names, each with a semicolon behind it. arguments: for each kernel a character per
   * argument (b: a buffer; 4, 8: a number of so many bytes), and a semicolon. */
  const char *kernels, *arguments;
} mcor_native_program;

/* All compiled programs; the build makes this list. */
extern const mcor_native_program mcor_native_programs[];

/* mcor_native_program.c. Returns the best instruction set of this processor and system for which
 * the library has programs; -1: none. */
int mcor_best_instructions(void);
/* Finds this processor's program with these options, as given to clBuildProgram; NULL: none. */
const mcor_native_program* mcor_find_program(const char* options);

/* Returns the built-in device's platform; NULL: the library has no programs for this processor. */
cl_platform_id mcor_native_platform(void);
/* Returns the threads of a context; these may be fewer than the device's units. */
mcor_pool* mcor_native_pool(cl_context context);

#endif
