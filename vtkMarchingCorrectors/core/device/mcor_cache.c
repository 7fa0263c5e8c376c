/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#if !defined(_WIN32) && !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* for mkdir, statvfs, mkdtemp */
#endif

#include "mcor_cache.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef _WIN32
#include <direct.h>
#include <errno.h>
#else
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <utime.h>
#endif

#define MCOR_PATH_LIMIT 1024

/* FNV-1a. */
static uint64_t mcor_cache_hash(uint64_t hash, const void* data, size_t size)
{
  const unsigned char* bytes = data;
  for (size_t i = 0; i < size; ++i)
  {
    hash = (hash ^ bytes[i]) * 0x100000001B3u;
  }
  return hash;
}

void mcor_cache_add(mcor_cache_key* key, const char* text)
{
  static const uint64_t start[2] = { 0xCBF29CE484222325u, 0x9E3779B97F4A7C15u };
  for (int w = 0; w < 2; ++w)
  {
    const uint64_t hash = key->words[w] ? key->words[w] : start[w];
    key->words[w] = mcor_cache_hash(hash, text, strlen(text) + 1);
    /* Makes the second word another function of the text. */
    key->words[w] ^= w ? key->words[w] >> 29 : 0;
  }
}

static bool mcor_make_folder(const char* path)
{
#ifdef _WIN32
  return _mkdir(path) == 0 || errno == EEXIST;
#else
  return mkdir(path, 0700) == 0 || errno == EEXIST;
#endif
}

/* Makes a path's folders; false where one is missing then. */
static bool mcor_make_folders(const char* path)
{
  char part[MCOR_PATH_LIMIT];
  bool made = true;
  for (size_t i = 0; path[i] && i + 1 < sizeof part; ++i)
  {
    part[i] = path[i];
    part[i + 1] = '\0';
    if (i > 0 && (path[i + 1] == '/' || path[i + 1] == '\0'))
    {
      made = mcor_make_folder(part);
    }
  }
  return made;
}

static const char* mcor_variable(const char* name)
{
  const char* value = getenv(name);
  return value && *value ? value : NULL;
}

/* The cache's folder; false where there is none. */
static bool mcor_cache_folder(char path[MCOR_PATH_LIMIT])
{
  const char* own = getenv("MCOR_CACHE_DIR");
  const char* shared = mcor_variable("XDG_CACHE_HOME");
#ifdef _WIN32
  const char* home = mcor_variable("LOCALAPPDATA");
  const char* under = "/marching-correctors";
#else
  const char* home = mcor_variable("HOME");
  const char* under = "/.cache/marching-correctors";
#endif
  if ((own && !*own) || (!own && !shared && !home))
  {
    return false;
  }
  const int length = own ? snprintf(path, MCOR_PATH_LIMIT, "%s", own)
    : shared             ? snprintf(path, MCOR_PATH_LIMIT, "%s/marching-correctors", shared)
                         : snprintf(path, MCOR_PATH_LIMIT, "%s%s", home, under);
  return length < MCOR_PATH_LIMIT - 100; /* room for a file's name */
}

/* The file begins with these. */
typedef struct mcor_cache_header
{
  char mark[8];
  mcor_cache_key key;
  uint64_t size, hash; /* of the data */
} mcor_cache_header;

static mcor_cache_header mcor_make_header(const mcor_cache_key* key, const void* data, size_t size)
{
  mcor_cache_header header = { "mcor\r\n1", *key, size,
    mcor_cache_hash(key->words[0], data, size) };
  return header;
}

static bool mcor_file_name(const mcor_cache_key* key, char path[MCOR_PATH_LIMIT])
{
  if (!mcor_cache_folder(path))
  {
    return false;
  }
  const size_t length = strlen(path);
  snprintf(path + length, MCOR_PATH_LIMIT - length, "/%016" PRIx64 "%016" PRIx64 ".program",
    key->words[0], key->words[1]);
  return true;
}

#ifdef _WIN32

static void mcor_mark_used(const char* path)
{
  (void)path;
}

static void mcor_remove_unused(const char* folder)
{
  (void)folder;
}

static FILE* mcor_open_own(const char* path)
{
  return fopen(path, "rb");
}

#else

/* Opens a file to read, of this user and no link: what is in it, is run. */
static FILE* mcor_open_own(const char* path)
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

#define MCOR_UNUSED_DAYS 90

/* The file's time is that of its last use. */
static void mcor_mark_used(const char* path)
{
  utime(path, NULL);
}

/* Removes what nobody has used for a long time, and what a process left that was ended. */
static void mcor_remove_unused(const char* folder)
{
  const time_t oldest = time(NULL) - (time_t)MCOR_UNUSED_DAYS * 24 * 3600;
  char path[MCOR_PATH_LIMIT];
  struct stat status;
  DIR* directory = opendir(folder);
  for (struct dirent* entry = directory ? readdir(directory) : NULL; entry;
       entry = readdir(directory))
  {
    if (strstr(entry->d_name, ".program") &&
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

#endif

void* mcor_cache_load(const mcor_cache_key* key, size_t* size)
{
  char path[MCOR_PATH_LIMIT];
  mcor_cache_header header;
  FILE* file = mcor_file_name(key, path) ? mcor_open_own(path) : NULL;
  unsigned char* data = NULL;
  if (file && fread(&header, sizeof header, 1, file) == 1 && header.size < (uint64_t)1 << 31)
  {
    data = malloc((size_t)header.size + 1);
  }
  /* One byte more is asked for: a longer file is not the one that was written. */
  const bool whole = data && fread(data, 1, (size_t)header.size + 1, file) == header.size;
  if (file)
  {
    fclose(file);
  }
  const mcor_cache_header expected =
    mcor_make_header(key, whole ? data : NULL, whole ? (size_t)header.size : 0);
  if (!whole || memcmp(&header, &expected, sizeof header) != 0)
  {
    free(data);
    return NULL;
  }
  mcor_mark_used(path);
  *size = (size_t)header.size;
  return data;
}

/* Opens a file beside `path` that nobody else has. */
static FILE* mcor_open_beside(const char* path, char temporary[MCOR_PATH_LIMIT])
{
  FILE* file = NULL;
  for (unsigned i = 0; i < 100 && !file; ++i)
  {
    const uint64_t number = (uint64_t)time(NULL) * 1000003u + (uint64_t)clock() * 101u + i;
    snprintf(temporary, MCOR_PATH_LIMIT, "%s.%" PRIx64, path, number);
    file = fopen(temporary, "wbx");
  }
  return file;
}

void mcor_cache_store(const mcor_cache_key* key, const void* data, size_t size)
{
  char folder[MCOR_PATH_LIMIT], path[MCOR_PATH_LIMIT], temporary[MCOR_PATH_LIMIT];
  if (!mcor_cache_folder(folder) || !mcor_make_folders(folder) || !mcor_file_name(key, path))
  {
    return;
  }
  mcor_remove_unused(folder);
  FILE* file = mcor_open_beside(path, temporary);
  if (!file)
  {
    return;
  }
  const mcor_cache_header header = mcor_make_header(key, data, size);
  const bool written =
    fwrite(&header, sizeof header, 1, file) == 1 && fwrite(data, 1, size, file) == size;
  const bool closed = fclose(file) == 0;
  if (!written || !closed || rename(temporary, path) != 0)
  {
    remove(temporary);
  }
}

#ifdef _WIN32

bool mcor_pocl_folder_fault(char* text, size_t size)
{
  (void)text;
  (void)size;
  return false;
}

#else

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
  if (getpwuid_r(geteuid(), &user, names, sizeof names, &found) == 0 && found &&
    mcor_is_private(found->pw_dir) &&
    snprintf(path, sizeof path, "%s/.cache/pocl/kcache", found->pw_dir) < (int)sizeof path &&
    mcor_make_folders(path) && access(path, W_OK | X_OK) == 0)
  {
    setenv("POCL_CACHE_DIR", path, 1);
    return;
  }
  snprintf(path, sizeof path, "/tmp/marching-correctors-%ld", (long)geteuid());
  if (mcor_make_folder(path) && mcor_is_private(path))
  {
    setenv("POCL_CACHE_DIR", path, 1);
    return;
  }
  snprintf(path, sizeof path, "/tmp/marching-correctors-XXXXXX");
  if (mkdtemp(path))
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
    own ? own
      : shared ? shared
      : home ? home
             : "/tmp",
    own ? ""
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

#endif
