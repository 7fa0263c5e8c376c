/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_fault_h
#define core_fault_h

/* Lets OpenCL calls and allocations of the host fail when a test wants it: the linker puts functions of core_fault.c in
 * front of the real ones (CMakeLists.txt). With CORE_FILL=BYTE in the environment new buffers are filled with this
 * byte, so that reading unwritten memory changes results. CORE_SHADOWS is for oclgrind --uninitialized, which believes
 * that a buffer is as large as the host's last write, and that a new buffer is the one released before: with
 * CORE_SHADOWS no buffer is released, and each write by the host is repeated for the whole buffer. */

#include "core_fixture.h"

/* Makes the n-th OpenCL call from now on, counted from 0, fail with this error; -1: no call fails. */
void core_fail_call(int n, cl_int error);
/* Like core_fail_call, but calls that set a launch's argument, which are most calls, are not counted and never fail. */
void core_fail_command(int n, cl_int error);
/* Makes the n-th call of malloc, calloc or realloc from now on return NULL. */
void core_fail_allocation(int n);
void core_fail_nothing(void);
/* Returns the name of the call that has failed, or "". */
const char* core_failed_call(void);

/* Sets the log of a failed build. As with a real driver, a query returns the whole log or nothing. */
void core_set_build_log(const char* log);

/* Fails unless the context holds exactly `bytes` in `buffers` buffers after a run. */
void core_expect_nothing_held(mcor_context* context, int64_t bytes, int buffers);

#endif
