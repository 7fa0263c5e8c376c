/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef print_values_h
#define print_values_h

/* Prints values beside a condition that does not hold, each with the expression that it comes from. */

#include <inttypes.h>
#include <stdio.h>

#define PRINT_VALUES(...)                                                                          \
  fflush(stdout);                                                                                  \
  PRINT_EACH(PRINT_VALUE, __VA_ARGS__)

static inline void print_double(const char* name, double value)
{
  fprintf(stderr, "  %s = %.9g\n", name, value);
}

static inline void print_float(const char* name, float value)
{
  print_double(name, (double)value);
}

static inline void print_text(const char* name, const char* value)
{
  fprintf(stderr, "  %s = %s\n", name, value ? value : "NULL");
}

static inline void print_integer(const char* name, int64_t value)
{
  fprintf(stderr, "  %s = %" PRId64 "\n", name, value);
}

static inline void print_unsigned(const char* name, uint64_t value)
{
  fprintf(stderr, "  %s = %" PRIu64 "\n", name, value);
}

#define PRINT_VALUE(x)                                                                             \
  _Generic((x), float: print_float, double: print_double, char*: print_text,        \
    const char*: print_text, uint64_t: print_unsigned, default: print_integer)(#x, x);

/* PRINT_EACH(f, a, b, ...) is f(a) f(b) ..., for up to 24 values. */
#define PRINT_EACH(f, ...)                                                                         \
  PRINT_PICK(__VA_ARGS__, 24, 23, 22, 21, 20, 19, 18, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6,  \
    5, 4, 3, 2, 1, 0)                                                                              \
  (f, __VA_ARGS__)
#define PRINT_PICK(a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15, a16, a17,     \
  a18, a19, a20, a21, a22, a23, a24, n, ...)                                                       \
  PRINT_EACH_##n
#define PRINT_EACH_1(f, x) f(x)
#define PRINT_EACH_2(f, x, ...) f(x) PRINT_EACH_1(f, __VA_ARGS__)
#define PRINT_EACH_3(f, x, ...) f(x) PRINT_EACH_2(f, __VA_ARGS__)
#define PRINT_EACH_4(f, x, ...) f(x) PRINT_EACH_3(f, __VA_ARGS__)
#define PRINT_EACH_5(f, x, ...) f(x) PRINT_EACH_4(f, __VA_ARGS__)
#define PRINT_EACH_6(f, x, ...) f(x) PRINT_EACH_5(f, __VA_ARGS__)
#define PRINT_EACH_7(f, x, ...) f(x) PRINT_EACH_6(f, __VA_ARGS__)
#define PRINT_EACH_8(f, x, ...) f(x) PRINT_EACH_7(f, __VA_ARGS__)
#define PRINT_EACH_9(f, x, ...) f(x) PRINT_EACH_8(f, __VA_ARGS__)
#define PRINT_EACH_10(f, x, ...) f(x) PRINT_EACH_9(f, __VA_ARGS__)
#define PRINT_EACH_11(f, x, ...) f(x) PRINT_EACH_10(f, __VA_ARGS__)
#define PRINT_EACH_12(f, x, ...) f(x) PRINT_EACH_11(f, __VA_ARGS__)
#define PRINT_EACH_13(f, x, ...) f(x) PRINT_EACH_12(f, __VA_ARGS__)
#define PRINT_EACH_14(f, x, ...) f(x) PRINT_EACH_13(f, __VA_ARGS__)
#define PRINT_EACH_15(f, x, ...) f(x) PRINT_EACH_14(f, __VA_ARGS__)
#define PRINT_EACH_16(f, x, ...) f(x) PRINT_EACH_15(f, __VA_ARGS__)
#define PRINT_EACH_17(f, x, ...) f(x) PRINT_EACH_16(f, __VA_ARGS__)
#define PRINT_EACH_18(f, x, ...) f(x) PRINT_EACH_17(f, __VA_ARGS__)
#define PRINT_EACH_19(f, x, ...) f(x) PRINT_EACH_18(f, __VA_ARGS__)
#define PRINT_EACH_20(f, x, ...) f(x) PRINT_EACH_19(f, __VA_ARGS__)
#define PRINT_EACH_21(f, x, ...) f(x) PRINT_EACH_20(f, __VA_ARGS__)
#define PRINT_EACH_22(f, x, ...) f(x) PRINT_EACH_21(f, __VA_ARGS__)
#define PRINT_EACH_23(f, x, ...) f(x) PRINT_EACH_22(f, __VA_ARGS__)
#define PRINT_EACH_24(f, x, ...) f(x) PRINT_EACH_23(f, __VA_ARGS__)

#endif
