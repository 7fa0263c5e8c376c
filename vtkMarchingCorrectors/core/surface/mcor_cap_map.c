/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mcor_cap_map.h"

#include <stdlib.h>

static size_t mcor_cap_slot(const mcor_cap_map* map, uint64_t key)
{
  uint64_t hash = key * UINT64_C(0x9E3779B97F4A7C15);
  size_t slot = (size_t)(hash ^ hash >> 32) & (map->capacity - 1);
  while (map->keys[slot] != 0 && map->keys[slot] != key)
  {
    slot = (slot + 1) & (map->capacity - 1);
  }
  return slot;
}

static bool mcor_grow_cap_map(mcor_cap_map* map)
{
  mcor_cap_map grown = { .capacity = map->capacity > 0 ? 2 * map->capacity : 1024,
    .count = map->count };
  grown.keys = calloc(grown.capacity, sizeof *grown.keys);
  grown.numbers = calloc(grown.capacity, sizeof *grown.numbers);
  for (size_t i = 0; i < map->capacity && grown.keys && grown.numbers; ++i)
  {
    if (map->keys[i] != 0)
    {
      const size_t slot = mcor_cap_slot(&grown, map->keys[i]);
      grown.keys[slot] = map->keys[i];
      grown.numbers[slot] = map->numbers[i];
    }
  }
  const bool enough = grown.keys && grown.numbers;
  free(enough ? map->keys : grown.keys);
  free(enough ? map->numbers : grown.numbers);
  *map = enough ? grown : *map;
  return enough;
}

int32_t mcor_cap_number(mcor_cap_map* map, uint64_t key, int32_t number)
{
  if (2 * (map->count + 1) > map->capacity && !mcor_grow_cap_map(map))
  {
    return -1;
  }
  const size_t slot = mcor_cap_slot(map, key);
  if (map->keys[slot] == 0)
  {
    map->keys[slot] = key;
    map->numbers[slot] = number;
    ++map->count;
  }
  return map->numbers[slot];
}

int32_t mcor_find_cap_number(const mcor_cap_map* map, uint64_t key)
{
  const size_t slot = map->capacity > 0 ? mcor_cap_slot(map, key) : 0;
  return map->capacity > 0 && map->keys[slot] == key ? map->numbers[slot] : -1;
}

void mcor_free_cap_map(mcor_cap_map* map)
{
  free(map->keys);
  free(map->numbers);
}
