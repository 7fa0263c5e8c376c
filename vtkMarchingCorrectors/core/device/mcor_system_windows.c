/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "mcor_system.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <malloc.h>
#include <string.h>

int mcor_system_processors(int* usable)
{
  const DWORD all = GetActiveProcessorCount(ALL_PROCESSOR_GROUPS);
  DWORD_PTR own = 0, system = 0;
  *usable = 0;
  if (GetProcessAffinityMask(GetCurrentProcess(), &own, &system))
  {
    for (; own; own &= own - 1)
    {
      ++*usable;
    }
  }
  /* The mask is 0 where the process is in several groups of 64 processors. */
  *usable = *usable > 0 ? *usable : all > 0 ? (int)all : 1;
  return all > 0 ? (int)all : *usable;
}

uint64_t mcor_system_memory(void)
{
  MEMORYSTATUSEX status = { .dwLength = sizeof status };
  return GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}

void* mcor_system_allocate(size_t alignment, size_t bytes)
{
  return _aligned_malloc(bytes > 0 ? bytes : 1, alignment);
}

void mcor_system_release(void* memory)
{
  _aligned_free(memory);
}

/* Large pages need a right that users lack by default. */
void mcor_use_large_pages(void* memory, size_t bytes)
{
  (void)memory, (void)bytes;
}

/* Rejects Wine's own OpenCL.dll: its objects do not begin with tables of functions, which this
 * library needs. Wine's libraries name themselves behind their first 64 bytes, where other
 * libraries have a DOS program. */
mcor_function mcor_system_opencl(void)
{
  static const char mark[] = "Wine builtin DLL";
  const HMODULE loader = LoadLibraryExW(L"OpenCL.dll", NULL, LOAD_LIBRARY_SEARCH_SYSTEM32);
  return loader && memcmp((const char*)loader + 64, mark, sizeof mark - 1) != 0
    ? (mcor_function)(void*)GetProcAddress(loader, "clGetPlatformIDs")
    : NULL;
}

/* Tests nothing: PoCL, which ends a process if it cannot start, is hardly used on Windows. */
bool mcor_system_bears_drivers(void)
{
  return true;
}
