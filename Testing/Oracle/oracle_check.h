/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef oracle_check_h
#define oracle_check_h

#include "print_values.h"

/* A failed check prints its place and condition and is counted; the program goes on. */
#define ORACLE_CHECK(condition, ...)                                                               \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      fprintf(stderr, "%s:%d: failed: %s\n", __FILE__, __LINE__, #condition);                      \
      PRINT_VALUES(__VA_ARGS__)                                                                    \
      ++oracle_failures;                                                                           \
    }                                                                                              \
  } while (0)

static int oracle_failures = 0;

#endif
