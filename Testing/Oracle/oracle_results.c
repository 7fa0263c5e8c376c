/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle_results.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char* const results_names[RESULTS_COUNTS] = { "edges", "components", "vertices", "triangles",
  "trimmed_vertices", "trimmed_triangles", "trim_vertices", "pairs_vertices" };

void results_free(results_table* table)
{
  free(table->row);
  memset(table, 0, sizeof(*table));
}

static results_row* results_at(const results_table* table, const char* name)
{
  for (int64_t n = 0; n < table->count; ++n)
  {
    if (strcmp(table->row[n].name, name) == 0)
    {
      return &table->row[n];
    }
  }
  return NULL;
}

const results_row* results_find(const results_table* table, const char* name)
{
  return results_at(table, name);
}

int results_set(results_table* table, const results_row* row)
{
  results_row* at = results_at(table, row->name);
  if (!at)
  {
    if (table->count == table->capacity)
    {
      const int64_t capacity = 2 * table->capacity + 64;
      results_row* grown = realloc(table->row, (size_t)capacity * sizeof(*grown));
      if (!grown)
      {
        return 0;
      }
      table->row = grown;
      table->capacity = capacity;
    }
    at = &table->row[table->count++];
  }
  *at = *row;
  return 1;
}

static int results_read_row(const char* line, results_row* row)
{
  memset(row, 0, sizeof(*row));
  const char* comma = strchr(line, ',');
  if (!comma || (size_t)(comma - line) >= sizeof(row->name))
  {
    return 0;
  }
  memcpy(row->name, line, (size_t)(comma - line));
  for (int n = 0; n <= RESULTS_COUNTS; ++n)
  {
    char* end;
    if (*comma != ',')
    {
      return 0;
    }
    if (n < RESULTS_COUNTS)
    {
      row->counts[n] = strtoll(comma + 1, &end, 10);
    }
    else
    {
      row->residual = strtod(comma + 1, &end);
    }
    if (end == comma + 1)
    {
      return 0;
    }
    comma = end;
  }
  return 1;
}

int results_load(results_table* table, const char* path)
{
  memset(table, 0, sizeof(*table));
  snprintf(table->path, sizeof(table->path), "%s", path);
  FILE* file = fopen(path, "r");
  if (!file)
  {
    return 1;
  }
  char line[512];
  int good = 1;
  int first = 1; /* the line of names */
  while (good && fgets(line, sizeof(line), file))
  {
    results_row row;
    good = first || (results_read_row(line, &row) && results_set(table, &row));
    first = 0;
  }
  fclose(file);
  return good;
}

static int results_compare_names(const void* a, const void* b)
{
  return strcmp(((const results_row*)a)->name, ((const results_row*)b)->name);
}

int results_save(const results_table* table)
{
  FILE* file = fopen(table->path, "w");
  if (!file)
  {
    return 0;
  }
  if (table->count > 0)
  {
    qsort(table->row, (size_t)table->count, sizeof(*table->row), results_compare_names);
  }
  fputs("case", file);
  for (int c = 0; c < RESULTS_COUNTS; ++c)
  {
    fprintf(file, ",%s", results_names[c]);
  }
  fputs(",residual\n", file);
  for (int64_t n = 0; n < table->count; ++n)
  {
    fputs(table->row[n].name, file);
    for (int c = 0; c < RESULTS_COUNTS; ++c)
    {
      fprintf(file, ",%lld", (long long)table->row[n].counts[c]);
    }
    fprintf(file, ",%.2g\n", table->row[n].residual);
  }
  return fclose(file) == 0;
}
