/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* for sched_getaffinity, RTLD_DEFAULT, madvise */
#endif

#include "mcor_system.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <utime.h>

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

void mcor_system_want_large_pages(void* memory, size_t bytes)
{
#ifdef MADV_HUGEPAGE
  const size_t page = (size_t)sysconf(_SC_PAGESIZE);
  const size_t skipped = (page - (uintptr_t)memory % page) % page;
  if (bytes > skipped)
  {
    /* Only a request: where it is refused, pages stay small. */
    (void)madvise((char*)memory + skipped, (bytes - skipped) / page * page, MADV_HUGEPAGE);
  }
#else
  (void)memory, (void)bytes;
#endif
}

bool mcor_system_variable(const char* name, char value[MCOR_PATH_LIMIT])
{
  const char* found = getenv(name);
  return found && snprintf(value, MCOR_PATH_LIMIT, "%s", found) < MCOR_PATH_LIMIT;
}

bool mcor_system_cache_folder(char path[MCOR_PATH_LIMIT])
{
  const char* home = getenv("HOME");
  return home && *home && snprintf(path, MCOR_PATH_LIMIT, "%s/.cache", home) < MCOR_PATH_LIMIT;
}

bool mcor_system_make_folder(const char* path)
{
  return mkdir(path, 0700) == 0 || errno == EEXIST;
}

FILE* mcor_system_open_own(const char* path)
{
  const int descriptor = open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  struct stat status;
  const bool own = descriptor >= 0 && fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
    status.st_uid == geteuid();
  FILE* file = own ? fdopen(descriptor, "rb") : NULL;
  if (!file && descriptor >= 0)
  {
    close(descriptor);
  }
  return file;
}

FILE* mcor_system_create(const char* path)
{
  return fopen(path, "wbx");
}

bool mcor_system_move(const char* from, const char* to)
{
  return rename(from, to) == 0;
}

void mcor_system_remove(const char* path)
{
  remove(path);
}

void mcor_system_mark_used(const char* path)
{
  utime(path, NULL);
}

void mcor_system_remove_unused(const char* folder, const char* part, int days)
{
  const time_t oldest = time(NULL) - (time_t)days * 24 * 3600;
  char path[MCOR_PATH_LIMIT];
  struct stat status;
  DIR* directory = opendir(folder);
  for (struct dirent* entry = directory ? readdir(directory) : NULL; entry;
       entry = readdir(directory))
  {
    if (strstr(entry->d_name, part) &&
      snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) < (int)sizeof path &&
      lstat(path, &status) == 0 && S_ISREG(status.st_mode) && status.st_mtime < oldest)
    {
      remove(path);
    }
  }
  if (directory)
  {
    closedir(directory);
  }
}

mcor_function mcor_system_opencl(void)
{
  mcor_function found = NULL;
#ifndef __APPLE__ /* whose platform is of another kind: its objects do not begin with tables */
  /* The program may have one already, or a tool that is put in its place. */
  *(void**)&found = dlsym(RTLD_DEFAULT, "clGetPlatformIDs");
  void* loader = found ? NULL : dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
  if (loader)
  {
    *(void**)&found = dlsym(loader, "clGetPlatformIDs");
  }
#endif
  return found;
}
