/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mcor_table.h"

#include <stdlib.h>

static mcor_entry* mcor_entry_of(const mcor_table* map, uint64_t key)
{
  size_t at = (size_t)((key * UINT64_C(0x9E3779B97F4A7C15)) >> 20) & (map->capacity - 1);
  while (map->entries[at].value != 0 && map->entries[at].key != key)
  {
    at = (at + 1) & (map->capacity - 1);
  }
  return &map->entries[at];
}

uint64_t mcor_table_find(const mcor_table* map, uint64_t key)
{
  return map->capacity > 0 ? mcor_entry_of(map, key)->value : 0;
}

uint64_t* mcor_table_add(mcor_table* map, uint64_t key)
{
  if (2 * map->count >= map->capacity)
  {
    const mcor_table old = *map;
    map->capacity = old.capacity ? 2 * old.capacity : 256;
    map->entries = calloc(map->capacity, sizeof *map->entries);
    if (!map->entries)
    {
      *map = old;
      return NULL;
    }
    for (size_t i = 0; i < old.capacity; ++i)
    {
      if (old.entries[i].value != 0)
      {
        *mcor_entry_of(map, old.entries[i].key) = old.entries[i];
      }
    }
    free(old.entries);
  }
  mcor_entry* entry = mcor_entry_of(map, key);
  map->count += entry->value == 0;
  entry->key = key;
  return &entry->value;
}

void mcor_table_free(mcor_table* map)
{
  free(map->entries);
  *map = (mcor_table){ 0 };
}

int32_t mcor_table_number(mcor_table* map, uint64_t key, int32_t number)
{
  uint64_t* value = mcor_table_add(map, key);
  if (value && *value == 0)
  {
    *value = (uint64_t)number + 1;
  }
  return value ? (int32_t)(*value - 1) : -1;
}

int32_t mcor_find_number(const mcor_table* map, uint64_t key)
{
  return (int32_t)mcor_table_find(map, key) - 1;
}

int mcor_compare_keys(const void* a, const void* b)
{
  const uint64_t x = *(const uint64_t*)a, y = *(const uint64_t*)b;
  return (x > y) - (x < y);
}
