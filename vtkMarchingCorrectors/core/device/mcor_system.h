/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_system_h
#define mcor_system_h

/* Operating systems: everything that differs is in mcor_system_posix.c or mcor_system_windows.c.
 * Threads are pthreads everywhere: on Windows of MinGW's runtime. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The machine's processors; `usable`: those of them that the calling thread may use. At least 1. */
int mcor_system_processors(int* usable);
/* Bytes of the machine's memory; 0: not known. */
uint64_t mcor_system_memory(void);

/* `alignment`: a power of 2. NULL where there is no memory. */
void* mcor_system_allocate(size_t alignment, size_t bytes);
void mcor_system_release(void* memory);
/* Asks for large pages, where the system has such a question. */
void mcor_system_want_large_pages(void* memory, size_t bytes);

/* clGetPlatformIDs of the system's OpenCL loader, which stays open: drivers do not bear being closed.
 * NULL where there is none. */
typedef void (*mcor_function)(void);
/* Whether drivers can start: as many threads as the machine has processors, and map what they load. PoCL ends
 * the process where it cannot. */
bool mcor_system_bears_drivers(void);
mcor_function mcor_system_opencl(void);

#endif
