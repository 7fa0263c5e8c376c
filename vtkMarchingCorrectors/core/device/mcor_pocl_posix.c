/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#ifndef _DEFAULT_SOURCE
#define _DEFAULT_SOURCE /* for statvfs, mkdtemp */
#endif

#include "mcor_cache.h"
#include "mcor_system.h"

#include <pwd.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

static const char* mcor_variable(const char* name)
{
  const char* value = getenv(name);
  return value && *value ? value : NULL;
}

/* Whether the folder is there, is this user's, and no link, and nobody else's to write to. */
static bool mcor_is_private(const char* path)
{
  struct stat status;
  return lstat(path, &status) == 0 && S_ISDIR(status.st_mode) && status.st_uid == geteuid() &&
    (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

/* In the user's home, as the system has it, else a temporary one. */
void mcor_own_pocl_folder(void)
{
  char path[MCOR_PATH_LIMIT], names[4096];
  struct passwd user, *found = NULL;
  if (mcor_variable("POCL_CACHE_DIR") || mcor_variable("XDG_CACHE_HOME") || mcor_variable("HOME"))
  {
    return;
  }
  bool made = getpwuid_r(geteuid(), &user, names, sizeof names, &found) == 0 && found &&
    mcor_is_private(found->pw_dir) &&
    snprintf(path, sizeof path, "%s/.cache/pocl/kcache", found->pw_dir) < (int)sizeof path &&
    mcor_make_folders(path) && access(path, W_OK | X_OK) == 0;
  if (!made)
  {
    snprintf(path, sizeof path, "/tmp/marching-correctors-%ld", (long)geteuid());
    made = mcor_system_make_folder(path) && mcor_is_private(path);
  }
  if (!made)
  {
    snprintf(path, sizeof path, "/tmp/marching-correctors-XXXXXX");
    made = mkdtemp(path) != NULL;
  }
  if (made)
  {
    setenv("POCL_CACHE_DIR", path, 1);
  }
}

void mcor_pocl_folder(char* path, size_t size)
{
  mcor_own_pocl_folder();
  const char* own = mcor_variable("POCL_CACHE_DIR");
  const char* shared = mcor_variable("XDG_CACHE_HOME");
  const char* home = mcor_variable("HOME");
  snprintf(path, size, "%s%s",
    own        ? own
      : shared ? shared
      : home   ? home
               : "/tmp",
    own                 ? ""
      : home && !shared ? "/.cache/pocl/kcache"
                        : "/pocl/kcache");
}

/* Bytes that PoCL needs there for one context, and somewhat more. */
#define MCOR_POCL_BYTES (8 << 20)

bool mcor_pocl_folder_fault(char* text, size_t size)
{
  char path[MCOR_PATH_LIMIT];
  struct statvfs disk;
  mcor_pocl_folder(path, sizeof path);
  const bool usable = mcor_make_folders(path) && access(path, W_OK | X_OK) == 0;
  if (!usable)
  {
    snprintf(text, size,
      "PoCL compiles kernels into the folder %s, which is not writable. Set POCL_CACHE_DIR to a "
      "writable folder.",
      path);
  }
  else if (statvfs(path, &disk) == 0 &&
    (uint64_t)disk.f_bavail * disk.f_frsize < (uint64_t)MCOR_POCL_BYTES)
  {
    snprintf(text, size,
      "PoCL compiles kernels into the folder %s, whose disk is full. Free some space, or set "
      "POCL_CACHE_DIR to another folder.",
      path);
  }
  else
  {
    return false;
  }
  return true;
}
