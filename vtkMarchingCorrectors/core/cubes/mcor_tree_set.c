/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Adaptive cubes: sets of bricks. */

#include "mcor_tree_set.h"

#include <stdlib.h>
#include <string.h>

static size_t mcor_set_place(const mcor_brick_set* set, uint64_t key)
{
  size_t at = (size_t)((key * UINT64_C(0x9E3779B97F4A7C15)) >> 20) & (set->capacity - 1);
  while (set->slots[at].bricks != 0 && set->slots[at].key != key)
  {
    at = (at + 1) & (set->capacity - 1);
  }
  return at;
}

uint64_t mcor_set_find(const mcor_brick_set* set, uint64_t key)
{
  return set->capacity > 0 ? set->slots[mcor_set_place(set, key)].bricks : 0;
}

static bool mcor_set_grow(mcor_brick_set* set)
{
  const mcor_brick_set old = *set;
  set->capacity = old.capacity ? 2 * old.capacity : 256;
  set->slots = calloc(set->capacity, sizeof *set->slots);
  if (!set->slots)
  {
    *set = old;
    return false;
  }
  for (size_t i = 0; i < old.capacity; ++i)
  {
    if (old.slots[i].bricks != 0)
    {
      set->slots[mcor_set_place(set, old.slots[i].key)] = old.slots[i];
    }
  }
  free(old.slots);
  return true;
}

static size_t mcor_bit_count(uint64_t bits)
{
  size_t count = 0;
  for (; bits; bits &= bits - 1)
  {
    ++count;
  }
  return count;
}

bool mcor_set_add(mcor_brick_set* set, uint64_t key, uint64_t bricks)
{
  if (bricks == 0)
  {
    return true;
  }
  if (set->count > MCOR_SPLIT_LIMIT || (2 * set->clusters >= set->capacity && !mcor_set_grow(set)))
  {
    return false;
  }
  mcor_cluster* cluster = set->slots + mcor_set_place(set, key);
  set->clusters += cluster->bricks == 0;
  set->count += mcor_bit_count(bricks & ~cluster->bricks);
  cluster->key = key;
  cluster->bricks |= bricks;
  return true;
}

bool mcor_set_add_all(mcor_brick_set* set, const mcor_brick_set* other)
{
  bool added = true;
  for (size_t i = 0; i < other->capacity && added; ++i)
  {
    added = mcor_set_add(set, other->slots[i].key, other->slots[i].bricks);
  }
  return added;
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
