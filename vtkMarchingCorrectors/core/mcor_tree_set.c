/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: sets of bricks. */

#include "mcor_tree.h"

#include <stdlib.h>
#include <string.h>

static size_t mcor_set_place(const mcor_brick_set* set, uint64_t key)
{
  size_t at = (size_t)((key * UINT64_C(0x9E3779B97F4A7C15)) >> 20) & (set->capacity - 1);
  while (set->slots[at] != MCOR_NO_BRICK && set->slots[at] != key)
  {
    at = (at + 1) & (set->capacity - 1);
  }
  return at;
}

bool mcor_set_has(const mcor_brick_set* set, uint64_t key)
{
  return set->capacity > 0 && set->slots[mcor_set_place(set, key)] == key;
}

static bool mcor_set_grow(mcor_brick_set* set)
{
  const mcor_brick_set old = *set;
  const size_t capacity = old.capacity ? 2 * old.capacity : 1024;
  uint64_t* slots = malloc(capacity * sizeof *slots);
  if (!slots)
  {
    return false;
  }
  memset(slots, 0xff, capacity * sizeof *slots);
  *set = (mcor_brick_set){ slots, capacity, old.count };
  for (size_t i = 0; i < old.capacity; ++i)
  {
    if (old.slots[i] != MCOR_NO_BRICK)
    {
      slots[mcor_set_place(set, old.slots[i])] = old.slots[i];
    }
  }
  free(old.slots);
  return true;
}

bool mcor_set_add(mcor_brick_set* set, uint64_t key)
{
  if (set->count > MCOR_SPLIT_LIMIT || (2 * set->count >= set->capacity && !mcor_set_grow(set)))
  {
    return false;
  }
  const size_t at = mcor_set_place(set, key);
  set->count += set->slots[at] != key;
  set->slots[at] = key;
  return true;
}

bool mcor_are_too_many(const mcor_brick_set* levels)
{
  size_t count = 0;
  for (int l = 0; l < MCOR_TREE_LEVEL_LIMIT + 2; ++l)
  {
    count += levels[l].count;
  }
  return count > MCOR_SPLIT_LIMIT;
}

void mcor_set_free(mcor_brick_set* set)
{
  free(set->slots);
  *set = (mcor_brick_set){ 0 };
}

bool mcor_set_add_all(mcor_brick_set* set, const mcor_brick_set* other)
{
  bool added = true;
  for (size_t i = 0; i < other->capacity && added; ++i)
  {
    added = other->slots[i] == MCOR_NO_BRICK || mcor_set_add(set, other->slots[i]);
  }
  return added;
}
