/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_table_h
#define mcor_table_h

/* A hash table from keys to values other than 0. A table that is all zero is empty. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct mcor_entry
{
  uint64_t key, value; /* value 0: the entry is free */
} mcor_entry;

typedef struct mcor_table
{
  mcor_entry* entries; /* [capacity], a power of 2 */
  size_t capacity, count;
} mcor_table;

/* Returns the key's value; 0 if the key is missing. */
uint64_t mcor_table_find(const mcor_table* map, uint64_t key);
/* Returns the place of the key's value. The value is 0 if the key is new, and must be set before
 * the table is used again. NULL: memory ran out. */
uint64_t* mcor_table_add(mcor_table* map, uint64_t key);
void mcor_table_free(mcor_table* map);

/* For tables whose values are numbers from 0 on. Returns the key's number; a new key gets `number`.
 * -1: memory ran out. */
int32_t mcor_table_number(mcor_table* map, uint64_t key, int32_t number);
/* Returns the key's number; -1: it has none. */
int32_t mcor_find_number(const mcor_table* map, uint64_t key);

/* Compares two uint64_t, for qsort and bsearch. */
int mcor_compare_keys(const void* a, const void* b);

#endif
