/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_fault_h
#define core_fault_h

/* OpenCL calls, and allocations of the host, that fail when a test wants it: the linker puts these in
 * front of the real ones (CMakeLists.txt). CORE_FILL=BYTE in the environment: new buffers are filled with
 * this byte, so that reading what was never written changes results. CORE_SHADOWS: for oclgrind
 * --uninitialized, which takes a buffer for as large as what the host wrote last, and a new one for the one
 * released before: here none is released, and what the host has written to is written once more as a whole. */

#include "core_fixture.h"

/* The n-th call from now on, counted from 0, fails with this error; none: -1. */
void core_fail_call(int n, cl_int error);
/* Likewise, but arguments of launches, which are most of the calls, never fail. */
void core_fail_command(int n, cl_int error);
/* Likewise for malloc, calloc and realloc. */
void core_fail_allocation(int n);
void core_fail_nothing(void);
/* The call that has failed, "" if none has. */
const char* core_failed_call(void);

/* The log of a build that failed. Like real ones, it is not handed over in part. */
void core_set_build_log(const char* log);

/* Fails unless the context holds nothing of a run: these are what it keeps. */
void core_expect_nothing_held(mcor_context* context, int64_t bytes, int buffers);

#endif
