/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_ahead_h
#define mcor_ahead_h

/* Kernels compiled ahead, in a second process. No OpenCL calls.
 *
 * PoCL compiles each kernel when it is first launched, one after the other in one process, and keeps
 * it in files that all processes share. Where a surface is about to be the first of its kind, the
 * program marching-correctors-compile, beside the library that holds this code, is started; it
 * compiles what the surface will need, the last first, while this process comes from the other end.
 * MCOR_COMPILER is the path of that program; where it is empty, and where there is no such program,
 * nothing is started, and nothing else changes. */

#include "mcor_cl.h"

/* Of a context: the second process. All zero: there is none. */
typedef struct mcor_ahead
{
  bool started;
  int input;        /* the process ends when this is closed */
  char ready[1024]; /* path of the file that says that it need not be started again */
} mcor_ahead;

#define MCOR_AHEAD_LIMIT 64   /* kernels */
#define MCOR_AHEAD_BYTES 4096 /* of a request */

/* The kernels that a surface of `particles` particles needs, in the order of their use; returns how
 * many. Options that are rarely used need some more. */
int mcor_list_ahead(
  const mcor_build* build, int64_t particles, mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT]);

/* The text that the second process reads, see mcor_compile_ahead; its length. */
int mcor_write_request(const mcor_cl* cl, const mcor_build* build, const mcor_ahead_kernel* kernels,
  int count, char text[MCOR_AHEAD_BYTES]);
/* Path of the file in PoCL's folder that says that these kernels were compiled: it goes when they go. */
bool mcor_ready_file(
  const mcor_cl* cl, const mcor_build* build, const char* request, char path[1024]);

/* Before a call: starts the second process, unless a call like it has succeeded on this machine. */
void mcor_begin_ahead(mcor_context* context, const mcor_build* build, const mcor_input* input);
/* After it: ends the process, soon. */
void mcor_end_ahead(mcor_context* context, bool succeeded);

/* The second process: compiles what a request says until `wanted` returns false. */
mcor_status mcor_compile_ahead(char* request, bool (*wanted)(void));

#endif
