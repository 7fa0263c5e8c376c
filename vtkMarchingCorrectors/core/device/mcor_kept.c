/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#if !defined(_WIN32) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* for dladdr */
#endif

#include "mcor_kept.h"
#include "mcor_cache.h"
#include "mcor_internal.h"

#ifdef _WIN32

bool mcor_take_kept(const char* ready)
{
  (void)ready;
  return false;
}

#else

#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MCOR_PATH_LIMIT 1024

bool mcor_library_path(const char* name, char* path, size_t size)
{
  Dl_info info = { 0 };
  if (dladdr((const void*)(uintptr_t)&mcor_library_path, &info) == 0 || !info.dli_fname)
  {
    return false;
  }
  const char* slash = strrchr(info.dli_fname, '/');
  const int folder = slash ? (int)(slash - info.dli_fname) : 0;
  return folder > 0 && snprintf(path, size, "%.*s/%s", folder, info.dli_fname, name) < (int)size;
}

bool mcor_kept_folder(char* path, size_t size)
{
  const char* own = getenv("MCOR_KERNEL_DIR");
  return own ? *own && snprintf(path, size, "%s", own) < (int)size
             : mcor_library_path("marching-correctors-kernels", path, size);
}

static bool mcor_join(char path[MCOR_PATH_LIMIT], const char* folder, const char* name)
{
  return snprintf(path, MCOR_PATH_LIMIT, "%s/%s", folder, name) < MCOR_PATH_LIMIT;
}

static bool mcor_copy_file(const char* from, const char* to)
{
  char bytes[1 << 16];
  size_t count = 0;
  FILE* source = fopen(from, "rb");
  FILE* target = source ? fopen(to, "wbx") : NULL;
  bool good = target != NULL;
  while (good && (count = fread(bytes, 1, sizeof bytes, source)) > 0)
  {
    good = fwrite(bytes, 1, count, target) == count;
  }
  good = good && !ferror(source);
  if (source)
  {
    fclose(source);
  }
  return (!target || fclose(target) == 0) && good;
}

typedef bool (*mcor_entry_function)(const char* from, const char* to, const char* name);

/* Calls a function for all that is in a folder; `to` stands for that folder elsewhere. */
static bool mcor_each_entry(const char* from, const char* to, mcor_entry_function function)
{
  DIR* directory = opendir(from);
  bool good = directory != NULL;
  for (struct dirent* entry = directory ? readdir(directory) : NULL; entry && good;
       entry = readdir(directory))
  {
    char source[MCOR_PATH_LIMIT], target[MCOR_PATH_LIMIT];
    good = entry->d_name[0] == '.' ||
      (mcor_join(source, from, entry->d_name) && mcor_join(target, to, entry->d_name) &&
        function(source, target, entry->d_name));
  }
  if (directory)
  {
    closedir(directory);
  }
  return good;
}

static bool mcor_is_folder(const char* path)
{
  struct stat status;
  return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

static bool mcor_copy_tree(const char* from, const char* to, const char* name)
{
  (void)name;
  return mcor_is_folder(from) ? mkdir(to, 0700) == 0 && mcor_each_entry(from, to, mcor_copy_tree)
                              : mcor_copy_file(from, to);
}

static bool mcor_remove_tree(const char* path, const char* to, const char* name)
{
  (void)to;
  (void)name;
  return mcor_is_folder(path) ? mcor_each_entry(path, path, mcor_remove_tree) && rmdir(path) == 0
                              : remove(path) == 0;
}

/* Copies a program: whole, or not at all; one that is there already stays. */
static bool mcor_copy_program(const char* from, const char* to, const char* name)
{
  char beside[MCOR_PATH_LIMIT];
  if (access(to, F_OK) == 0)
  {
    return true;
  }
  if (snprintf(beside, sizeof beside, "%s.%ld", to, (long)getpid()) >= (int)sizeof beside)
  {
    return false;
  }
  const bool good = mcor_copy_tree(from, beside, name) && rename(beside, to) == 0;
  if (!good)
  {
    mcor_remove_tree(beside, NULL, NULL);
  }
  return good || access(to, F_OK) == 0; /* another process may have been faster */
}

/* PoCL's folder holds folders, by the first letters of their programs' names. */
static bool mcor_copy_programs(const char* from, const char* to, const char* name)
{
  if (strlen(name) != 2 || !mcor_is_folder(from))
  {
    return true;
  }
  mkdir(to, 0700);
  return mcor_each_entry(from, to, mcor_copy_program);
}

static bool mcor_copy_ready(const char* from, const char* to, const char* name)
{
  const char* end = strstr(name, ".ready");
  return !end || end[6] != '\0' || access(to, F_OK) == 0 || mcor_copy_file(from, to);
}

bool mcor_take_kept(const char* ready)
{
  char kept[MCOR_PATH_LIMIT], pocl[MCOR_PATH_LIMIT], path[MCOR_PATH_LIMIT];
  const char* name = strrchr(ready, '/');
  mcor_pocl_folder(pocl, sizeof pocl);
  return name && mcor_kept_folder(kept, sizeof kept) && mcor_join(path, kept, name + 1) &&
    access(path, F_OK) == 0 && mcor_each_entry(kept, pocl, mcor_copy_programs) &&
    mcor_each_entry(kept, pocl, mcor_copy_ready);
}

/* PoCL writes for its user alone. */
static bool mcor_share_entry(const char* path, const char* to, const char* name)
{
  (void)to;
  (void)name;
  return mcor_is_folder(path)
    ? chmod(path, 0755) == 0 && mcor_each_entry(path, path, mcor_share_entry)
    : chmod(path, 0644) == 0;
}

bool mcor_share_kept(const char* folder)
{
  return mcor_share_entry(folder, NULL, NULL);
}

#endif
