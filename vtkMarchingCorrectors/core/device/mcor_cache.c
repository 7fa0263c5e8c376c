/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#include "mcor_cache.h"
#include "mcor_system.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define MCOR_UNUSED_DAYS 90

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

bool mcor_make_folders(const char* path)
{
  char part[MCOR_PATH_LIMIT];
  bool made = true;
  for (size_t i = 0; path[i] && i + 1 < sizeof part; ++i)
  {
    part[i] = path[i];
    part[i + 1] = '\0';
    if (i > 0 && (path[i + 1] == '/' || path[i + 1] == '\0'))
    {
      made = mcor_system_make_folder(part);
    }
  }
  return made;
}

/* The cache's folder; false where there is none. */
static bool mcor_cache_folder(char path[MCOR_PATH_LIMIT])
{
  const size_t room = MCOR_PATH_LIMIT - 100; /* for a file's name */
  if (mcor_system_variable("MCOR_CACHE_DIR", path))
  {
    return *path && strlen(path) < room;
  }
  const bool shared = mcor_system_variable("XDG_CACHE_HOME", path) && *path;
  if (!shared && !mcor_system_cache_folder(path))
  {
    return false;
  }
  const size_t length = strlen(path);
  return length < room &&
    length + (size_t)snprintf(path + length, MCOR_PATH_LIMIT - length, "/marching-correctors") <
    room;
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

void* mcor_cache_load(const mcor_cache_key* key, size_t* size)
{
  char path[MCOR_PATH_LIMIT];
  mcor_cache_header header;
  FILE* file = mcor_file_name(key, path) ? mcor_system_open_own(path) : NULL;
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
  mcor_system_mark_used(path);
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
    file = mcor_system_create(temporary);
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
  mcor_system_remove_unused(folder, ".program", MCOR_UNUSED_DAYS);
  FILE* file = mcor_open_beside(path, temporary);
  if (!file)
  {
    return;
  }
  const mcor_cache_header header = mcor_make_header(key, data, size);
  const bool written =
    fwrite(&header, sizeof header, 1, file) == 1 && fwrite(data, 1, size, file) == size;
  const bool closed = fclose(file) == 0;
  if (!written || !closed || !mcor_system_move(temporary, path))
  {
    mcor_system_remove(temporary);
  }
}
