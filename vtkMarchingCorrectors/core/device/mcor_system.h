/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_system_h
#define mcor_system_h

/* Operating systems: everything that differs is in mcor_system_posix.c or mcor_system_windows.c.
 * Threads are pthreads everywhere; on Windows they come with MinGW's runtime. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns the number of the machine's processors. *usable: how many of these the calling thread
 * may use. Both are at least 1. */
int mcor_system_processors(int* usable);
/* Returns the bytes of the machine's memory; 0: not known. */
uint64_t mcor_system_memory(void);

/* alignment: a power of 2. Returns NULL if memory ran out. */
void* mcor_system_allocate(size_t alignment, size_t bytes);
void mcor_system_release(void* memory);
/* Asks for large pages, where the system has them. Called before the first touch of a large array
 * of the host, or of a device that shares the host's memory. With pages of 4 kB, first touches take
 * a third of the time of a run with ten million particles. memory: may be NULL. */
#define MCOR_LARGE_ARRAY ((size_t)1 << 20)
void mcor_use_large_pages(void* memory, size_t bytes);

/* A function of any type. */
typedef void (*mcor_function)(void);
/* Whether drivers can start. A driver starts a thread for each of the machine's processors, and
 * maps its libraries; PoCL ends the process if it cannot do this. */
bool mcor_system_bears_drivers(void);
/* Returns clGetPlatformIDs of the system's OpenCL loader; NULL: there is none. The loader stays
 * open, as drivers do not survive being closed. */
mcor_function mcor_system_opencl(void);

/* If the loader can choose a version, compiles a function of long loops three times: for processors
 * with AVX-512, with AVX2, and without both. This saves half of the instructions, or more. The bits
 * are the same, as every operation is rounded by itself. Sanitizers are not ready when the loader
 * chooses, so with them a function is compiled once. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) &&       \
  !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__)
#define MCOR_VECTOR_LOOPS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define MCOR_VECTOR_LOOPS
#endif

#endif
