/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_results_h
#define oracle_results_h

/* The committed table of results, Testing/Regression/results.csv: one row per case, counts that
 * must not change unnoticed, and the residual for the record. Several programs share the table;
 * each touches the rows of its own cases only. */

#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

  enum
  {
    RESULTS_COUNTS = 8
  };

  extern const char* const results_names[RESULTS_COUNTS];

  typedef struct results_row
  {
    char name[96];
    int64_t counts[RESULTS_COUNTS];
    double residual;
  } results_row;

  typedef struct results_table
  {
    results_row* row;
    int64_t count, capacity;
    char path[1024];
  } results_table;

  /* A file that does not exist is an empty table. 0 if a row cannot be read. */
  int results_load(results_table* table, const char* path);
  /* Sorted by name. 0 if the file cannot be written. */
  int results_save(const results_table* table);
  void results_free(results_table* table);

  const results_row* results_find(const results_table* table, const char* name);
  int results_set(results_table* table, const results_row* row); /* 0 if memory ran out */

#ifdef __cplusplus
}
#endif

#endif
