/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Windows' functions for UTF-16: those for bytes know no names beyond one code page. */

#include "mcor_cache.h"
#include "mcor_system.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <fcntl.h>
#include <io.h>
#include <malloc.h>
#include <string.h>
#include <wchar.h>

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

/* They take a right that users do not have by default. */
void mcor_system_want_large_pages(void* memory, size_t bytes)
{
  (void)memory, (void)bytes;
}

/* A UTF-16 text from UTF-8; false where it does not fit, or is none. */
static bool mcor_widen(const char* text, wchar_t wide[MCOR_PATH_LIMIT])
{
  return MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, wide, MCOR_PATH_LIMIT) > 0;
}

static bool mcor_narrow(const wchar_t* wide, char text[MCOR_PATH_LIMIT])
{
  return WideCharToMultiByte(CP_UTF8, 0, wide, -1, text, MCOR_PATH_LIMIT, NULL, NULL) > 0;
}

bool mcor_system_variable(const char* name, char value[MCOR_PATH_LIMIT])
{
  wchar_t wide_name[MCOR_PATH_LIMIT], wide[MCOR_PATH_LIMIT] = L"";
  SetLastError(ERROR_SUCCESS); /* an empty one is 0 letters, and no error */
  const DWORD length =
    mcor_widen(name, wide_name) ? GetEnvironmentVariableW(wide_name, wide, MCOR_PATH_LIMIT) : 0;
  for (wchar_t* at = wcschr(wide, L'\\'); at && length < MCOR_PATH_LIMIT; at = wcschr(at, L'\\'))
  {
    *at = L'/';
  }
  return length < MCOR_PATH_LIMIT && (length > 0 || GetLastError() == ERROR_SUCCESS) &&
    mcor_narrow(wide, value);
}

bool mcor_system_cache_folder(char path[MCOR_PATH_LIMIT])
{
  return mcor_system_variable("LOCALAPPDATA", path) && *path;
}

bool mcor_system_make_folder(const char* path)
{
  wchar_t wide[MCOR_PATH_LIMIT];
  return mcor_widen(path, wide) &&
    (CreateDirectoryW(wide, NULL) || GetLastError() == ERROR_ALREADY_EXISTS);
}

/* The user's folder is the user's alone: no owner is asked for. */
FILE* mcor_system_open_own(const char* path)
{
  wchar_t wide[MCOR_PATH_LIMIT];
  if (!mcor_widen(path, wide))
  {
    return NULL;
  }
  /* Others may remove it, or move another file in its place, meanwhile. */
  HANDLE handle =
    CreateFileW(wide, GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
      OPEN_EXISTING, FILE_FLAG_OPEN_REPARSE_POINT, NULL);
  if (handle == INVALID_HANDLE_VALUE)
  {
    return NULL;
  }
  BY_HANDLE_FILE_INFORMATION file;
  const DWORD others = FILE_ATTRIBUTE_REPARSE_POINT | FILE_ATTRIBUTE_DIRECTORY;
  const bool plain =
    GetFileInformationByHandle(handle, &file) && (file.dwFileAttributes & others) == 0;
  const int descriptor = plain ? _open_osfhandle((intptr_t)handle, _O_RDONLY | _O_BINARY) : -1;
  FILE* opened = descriptor >= 0 ? _fdopen(descriptor, "rb") : NULL;
  if (!opened && descriptor >= 0)
  {
    _close(descriptor);
  }
  else if (!opened)
  {
    CloseHandle(handle);
  }
  return opened;
}

FILE* mcor_system_create(const char* path)
{
  wchar_t wide[MCOR_PATH_LIMIT];
  return mcor_widen(path, wide) ? _wfopen(wide, L"wbx") : NULL;
}

bool mcor_system_move(const char* from, const char* to)
{
  wchar_t wide_from[MCOR_PATH_LIMIT], wide_to[MCOR_PATH_LIMIT];
  return mcor_widen(from, wide_from) && mcor_widen(to, wide_to) &&
    MoveFileExW(wide_from, wide_to, MOVEFILE_REPLACE_EXISTING);
}

void mcor_system_remove(const char* path)
{
  wchar_t wide[MCOR_PATH_LIMIT];
  if (mcor_widen(path, wide))
  {
    DeleteFileW(wide);
  }
}

void mcor_system_mark_used(const char* path)
{
  wchar_t wide[MCOR_PATH_LIMIT];
  FILETIME now;
  HANDLE file = mcor_widen(path, wide)
    ? CreateFileW(wide, FILE_WRITE_ATTRIBUTES,
        FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL, OPEN_EXISTING, 0, NULL)
    : INVALID_HANDLE_VALUE;
  if (file != INVALID_HANDLE_VALUE)
  {
    GetSystemTimeAsFileTime(&now);
    SetFileTime(file, NULL, NULL, &now);
    CloseHandle(file);
  }
}

static uint64_t mcor_ticks(FILETIME time)
{
  return (uint64_t)time.dwHighDateTime << 32 | time.dwLowDateTime;
}

void mcor_system_remove_unused(const char* folder, const char* part, int days)
{
  char path[MCOR_PATH_LIMIT], name[MCOR_PATH_LIMIT];
  wchar_t pattern[MCOR_PATH_LIMIT];
  WIN32_FIND_DATAW entry;
  FILETIME now;
  GetSystemTimeAsFileTime(&now);
  const uint64_t limit = (uint64_t)days * 24 * 3600 * 10000000u; /* 100 ns each */
  const bool fits = snprintf(path, sizeof path, "%s/*", folder) < (int)sizeof path;
  HANDLE search =
    fits && mcor_widen(path, pattern) ? FindFirstFileW(pattern, &entry) : INVALID_HANDLE_VALUE;
  const DWORD others = FILE_ATTRIBUTE_REPARSE_POINT | FILE_ATTRIBUTE_DIRECTORY;
  for (BOOL more = search != INVALID_HANDLE_VALUE; more; more = FindNextFileW(search, &entry))
  {
    if ((entry.dwFileAttributes & others) == 0 && mcor_narrow(entry.cFileName, name) &&
      strstr(name, part) && mcor_ticks(entry.ftLastWriteTime) + limit < mcor_ticks(now) &&
      snprintf(path, sizeof path, "%s/%s", folder, name) < (int)sizeof path)
    {
      mcor_system_remove(path);
    }
  }
  if (search != INVALID_HANDLE_VALUE)
  {
    FindClose(search);
  }
}

/* Objects of Wine's own OpenCL.dll do not begin with tables of functions, by which all others are called.
 * Libraries of Wine's say what they are behind their first 64 bytes, where others have a program of DOS. */
static bool mcor_is_wines_own(HMODULE library)
{
  static const char mark[] = "Wine builtin DLL";
  return memcmp((const char*)library + 64, mark, sizeof mark - 1) == 0;
}

mcor_function mcor_system_opencl(void)
{
  const HMODULE loader = LoadLibraryExW(L"OpenCL.dll", NULL, LOAD_LIBRARY_SEARCH_SYSTEM32);
  return loader && !mcor_is_wines_own(loader)
    ? (mcor_function)(void*)GetProcAddress(loader, "clGetPlatformIDs")
    : NULL;
}

/* PoCL is not for Windows. */
void mcor_own_pocl_folder(void) {}

void mcor_pocl_folder(char* path, size_t size)
{
  snprintf(path, size, "%s", "");
}

bool mcor_pocl_folder_fault(char* text, size_t size)
{
  (void)text, (void)size;
  return false;
}
