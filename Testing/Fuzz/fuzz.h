/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef fuzz_h
#define fuzz_h

#include "mcor_internal.h"
#include "mcor_parts.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

typedef struct fuzz_bytes
{
  const uint8_t* at;
  size_t left;
} fuzz_bytes;

/* The input that is being tested. A failing check writes it to the file that FUZZ_FOUND in the environment names,
 * because OpenCL drivers take the signal from which the fuzzer would learn of the failure. */
extern fuzz_bytes fuzz_input;
/* Writes the input, and aborts. */
void fuzz_fail(const char* condition, const char* where, int line);

#define FUZZ_CHECK(condition)                                                                      \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      fuzz_fail(#condition, __FILE__, __LINE__);                                                   \
    }                                                                                              \
  } while (0)

/* fuzz_byte returns the next byte, and 0 at the end. The other functions make numbers from bytes; some numbers are
 * strange. */
unsigned fuzz_byte(fuzz_bytes* bytes);
double fuzz_scale(fuzz_bytes* bytes);
double fuzz_positive(fuzz_bytes* bytes);
double fuzz_value(fuzz_bytes* bytes);
double fuzz_side(fuzz_bytes* bytes);

#define FUZZ_ARRAYS 8

/* The parts of one call; every array is a heap block of exactly its size. */
typedef struct fuzz_call
{
  mcor_input input;
  mcor_options options;
  mcor_array attributes[2];
  double iso[2];
  void* arrays[FUZZ_ARRAYS];
} fuzz_call;

double* fuzz_array(fuzz_call* call, int slot, size_t count);

mcor_context* fuzz_context(const fuzz_call* call, int forgetful);
/* Returns whether all values are finite. width: bytes of each, 4 for floats, 8 for doubles. */
int fuzz_finite(const void* values, int64_t count, size_t width);
void fuzz_check_bits(const void* a, const void* b, size_t bytes);
void fuzz_check_same(const mcor_surface* a, const mcor_surface* b);
void fuzz_check_failure(const mcor_context* context, mcor_status status);

/* In fuzz_modules.c. fuzz_regions sets box, period, walls and cubes of the call. fuzz_flatten moves
 * the call's particles into a plane. fuzz_other_calls and fuzz_gauge make other calls with the same
 * particles: global values, ranks, probe, derivatives, gauges. */
void fuzz_regions(unsigned modules, fuzz_bytes* bytes, fuzz_call* call);
void fuzz_flatten(unsigned how, fuzz_bytes* bytes, fuzz_call* call);
void fuzz_other_calls(unsigned modules, fuzz_bytes* bytes, fuzz_call* call);
void fuzz_gauge(fuzz_bytes* bytes, const fuzz_call* call);

#endif
