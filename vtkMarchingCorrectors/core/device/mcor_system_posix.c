/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* for sched_getaffinity, RTLD_DEFAULT, madvise */
#endif

#include "mcor_system.h"

#include <dlfcn.h>
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

int mcor_system_processors(int* usable)
{
  const long all = sysconf(_SC_NPROCESSORS_ONLN);
  int count = 0;
#ifdef __linux__
  cpu_set_t set;
  count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0;
#endif
  *usable = count > 0 ? count : all > 0 ? (int)all : 1;
  return all > 0 ? (int)all : *usable;
}

uint64_t mcor_system_memory(void)
{
  const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
  return pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : 0;
}

void* mcor_system_allocate(size_t alignment, size_t bytes)
{
  return aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

void mcor_system_release(void* memory)
{
  free(memory);
}

void mcor_use_large_pages(void* memory, size_t bytes)
{
#ifdef MADV_HUGEPAGE
  const size_t page = (size_t)sysconf(_SC_PAGESIZE);
  const size_t skipped = (page - (uintptr_t)memory % page) % page;
  if (memory && bytes >= MCOR_LARGE_ARRAY)
  {
    /* This is only a request; if it is refused, pages stay small. */
    (void)madvise((char*)memory + skipped, (bytes - skipped) / page * page, MADV_HUGEPAGE);
  }
#else
  (void)memory, (void)bytes;
#endif
}

mcor_function mcor_system_opencl(void)
{
  mcor_function found = NULL;
#ifndef __APPLE__ /* objects of Apple's OpenCL do not begin with tables of functions */
  /* The program may have loaded OpenCL already, or a tool that replaces it. */
  *(void**)&found = dlsym(RTLD_DEFAULT, "clGetPlatformIDs");
  void* loader = found ? NULL : dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (loader)
  {
    *(void**)&found = dlsym(loader, "clGetPlatformIDs");
  }
#endif
  return found;
}

/* The address space that a driver needs for its libraries, which include a compiler. */
#define MCOR_DRIVER_BYTES ((size_t)256 << 20)

static void* mcor_wait_at_gate(void* gate)
{
  pthread_mutex_lock(gate);
  pthread_mutex_unlock(gate);
  return NULL;
}

bool mcor_system_bears_drivers(void)
{
  int usable, started = 0;
  const int wanted = mcor_system_processors(&usable);
  pthread_t* threads = malloc((size_t)wanted * sizeof *threads);
  void* space = mmap(NULL, MCOR_DRIVER_BYTES, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&gate);
  while (threads && space != MAP_FAILED && started < wanted &&
    pthread_create(&threads[started], NULL, mcor_wait_at_gate, &gate) == 0)
  {
    ++started;
  }
  pthread_mutex_unlock(&gate);
  for (int i = 0; i < started; ++i)
  {
    pthread_join(threads[i], NULL);
  }
  if (space != MAP_FAILED)
  {
    munmap(space, MCOR_DRIVER_BYTES);
  }
  free(threads);
  return started == wanted;
}
