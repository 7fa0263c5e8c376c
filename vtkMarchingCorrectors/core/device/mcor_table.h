/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_table_h
#define mcor_table_h

/* Values, which are not 0, by keys: a hash table. All zero: it is empty. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct mcor_entry
{
  uint64_t key, value; /* value 0: free */
} mcor_entry;

typedef struct mcor_table
{
  mcor_entry* entries; /* [capacity], a power of 2 */
  size_t capacity, count;
} mcor_table;

/* 0: there is none. */
uint64_t mcor_table_find(const mcor_table* map, uint64_t key);
/* The value of a key, 0 where it is new, which is to be set before the map is used again. NULL: memory ran
 * out. */
uint64_t* mcor_table_add(mcor_table* map, uint64_t key);
void mcor_table_free(mcor_table* map);

/* Numbers from 0 on by keys. That of a key; `number` where it has none yet. -1: memory ran out. */
int32_t mcor_table_number(mcor_table* map, uint64_t key, int32_t number);
/* -1: it has none. */
int32_t mcor_find_number(const mcor_table* map, uint64_t key);

#endif
