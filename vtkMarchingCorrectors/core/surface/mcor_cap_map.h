/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cap_map_h
#define mcor_cap_map_h

/* Numbers by keys, a hash table. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct mcor_cap_map
{
  uint64_t* keys; /* [capacity], a power of 2; 0: free */
  int32_t* numbers;
  size_t capacity, count;
} mcor_cap_map;

/* The number of a key, which is not 0; `number`, 0 or more, where it has none yet. -1: memory ran
 * out. */
int32_t mcor_cap_number(mcor_cap_map* map, uint64_t key, int32_t number);
/* -1: it has none. */
int32_t mcor_find_cap_number(const mcor_cap_map* map, uint64_t key);
void mcor_free_cap_map(mcor_cap_map* map);

#endif
