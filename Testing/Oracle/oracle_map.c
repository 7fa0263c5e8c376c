/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_lattice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void* oracle_checked(void* block, size_t bytes)
{
  if (!block && bytes > 0)
  {
    fprintf(stderr, "out of memory for %zu bytes\n", bytes);
    abort();
  }
  return block;
}

void* oracle_allocate(int64_t count, size_t size)
{
  return oracle_checked(calloc((size_t)count, size), (size_t)count * size);
}

void* oracle_grow(void* array, int64_t count, int64_t* capacity, size_t size)
{
  if (count < *capacity)
  {
    return array;
  }
  *capacity = *capacity > 0 ? 2 * *capacity : 1024;
  return oracle_checked(realloc(array, (size_t)*capacity * size), (size_t)*capacity * size);
}

static int64_t oracle_map_slot(const oracle_map* map, const int64_t at[3], int64_t tag)
{
  uint64_t hash = (uint64_t)tag;
  for (int axis = 0; axis < 3; ++axis)
  {
    hash = (hash ^ (uint64_t)at[axis]) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 29;
  }
  int64_t slot = (int64_t)(hash & (uint64_t)(map->capacity - 1));
  for (;; slot = (slot + 1) & (map->capacity - 1))
  {
    const int64_t* held = &map->slots[5 * slot];
    if (held[4] < 0 || (held[0] == at[0] && held[1] == at[1] && held[2] == at[2] && held[3] == tag))
    {
      return slot;
    }
  }
}

static void oracle_map_grow(oracle_map* map)
{
  const oracle_map old = *map;
  map->capacity = old.capacity > 0 ? 2 * old.capacity : 1024;
  map->slots = oracle_allocate(map->capacity, 5 * sizeof(int64_t));
  memset(map->slots, 0xff, (size_t)map->capacity * 5 * sizeof(int64_t));
  for (int64_t n = 0; n < old.capacity; ++n)
  {
    const int64_t* held = &old.slots[5 * n];
    if (held[4] >= 0)
    {
      memcpy(&map->slots[5 * oracle_map_slot(map, held, held[3])], held, 5 * sizeof(int64_t));
    }
  }
  free(old.slots);
}

int64_t* oracle_map_find(oracle_map* map, const int64_t at[3], int64_t tag, int add)
{
  if (2 * map->count >= map->capacity)
  {
    oracle_map_grow(map);
  }
  int64_t* held = &map->slots[5 * oracle_map_slot(map, at, tag)];
  if (held[4] < 0)
  {
    if (!add)
    {
      return NULL;
    }
    memcpy(held, at, 3 * sizeof(int64_t));
    held[3] = tag;
    ++map->count;
  }
  return &held[4];
}

void oracle_map_free(oracle_map* map)
{
  free(map->slots);
  memset(map, 0, sizeof(*map));
}
