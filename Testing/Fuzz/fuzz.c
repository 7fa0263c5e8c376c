/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Makes numbers from bytes, keeps contexts for later calls, and has the checks that all targets
 * share. */

#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

fuzz_bytes fuzz_input;

void fuzz_fail(const char* condition, const char* where, int line)
{
  fprintf(stderr, "%s:%d: not true: %s\n", where, line, condition);
  const char* name = getenv("FUZZ_FOUND");
  FILE* file = name ? fopen(name, "wb") : NULL;
  if (file)
  {
    fwrite(fuzz_input.at, 1, fuzz_input.left, file);
    fclose(file);
  }
  abort();
}

unsigned fuzz_byte(fuzz_bytes* bytes)
{
  if (bytes->left == 0)
  {
    return 0;
  }
  --bytes->left;
  return *bytes->at++;
}

/* Returns a factor: usually 1, sometimes one that nobody should use. */
double fuzz_scale(fuzz_bytes* bytes)
{
  static const double scales[] = { 1e-30, 1e30, 1e-9, 1e9, 1e-300, 1e300, 1e-20, 1e20 };
  const unsigned b = fuzz_byte(bytes);
  return b < 248 ? 1 : scales[b - 248];
}

double fuzz_positive(fuzz_bytes* bytes)
{
  static const double odd[] = { 0, -1, NAN, INFINITY, 1e-40, 1e38, 1e-7, 1e4 };
  const unsigned b = fuzz_byte(bytes);
  return b < 248 ? 0.25 + 0.25 * (b % 8) : odd[b - 248];
}

/* Returns a value, usually one of nine, so that equal values are frequent; sometimes an odd one. */
double fuzz_value(fuzz_bytes* bytes)
{
  static const double odd[] = { NAN, INFINITY, -INFINITY, 1e30, -1e30, 1e-30, 0.1, 1e300 };
  const unsigned b = fuzz_byte(bytes);
  return b < 248 ? (int)(b % 9) * 0.25 - 1 : odd[b - 248];
}

double fuzz_side(fuzz_bytes* bytes)
{
  static const double odd[] = { NAN, INFINITY, -INFINITY, 1e30, -1e30, 1e-30, 1e300, -1e300 };
  const unsigned b = fuzz_byte(bytes);
  return b < 248 ? 0.25 * (int)(b % 24) - 1 : odd[b - 248];
}

double* fuzz_array(fuzz_call* call, int slot, size_t count)
{
  call->arrays[slot] = malloc(count * sizeof(double) + (count == 0));
  FUZZ_CHECK(call->arrays[slot]);
  return call->arrays[slot];
}

/* Returns a context for the call's device program. Each program has two contexts, which are made
 * once, because making one takes longer than a call. forgetful: returns the one whose kept data are
 * released before each call. */
mcor_context* fuzz_context(const fuzz_call* call, int forgetful)
{
  static mcor_context* contexts[2][2][3][2];
  const mcor_options* o = &call->options;
  mcor_context** context = &contexts[forgetful][o->sph_kernel == MCOR_M_PRIME_4]
                                    [o->field < 3 ? o->field : 0][call->input.solid != NULL];
  if (!*context && mcor_create_context(NULL, context) != MCOR_OK)
  {
    fprintf(stderr, "%s\n", mcor_last_error(*context));
    exit(1);
  }
  if (forgetful)
  {
    mcor_release_memory(*context);
  }
  return *context;
}

int fuzz_finite(const void* values, int64_t count, size_t width)
{
  for (int64_t i = 0; values && i < count; ++i)
  {
    if (!isfinite(width == sizeof(float) ? ((const float*)values)[i] : ((const double*)values)[i]))
    {
      return 0;
    }
  }
  return 1;
}

/* Checks the status and message of a call that failed. A device error is a fault: it would mean
 * that a kernel or a launch is wrong. */
void fuzz_check_failure(const mcor_context* context, mcor_status status)
{
  const char* message = mcor_last_error(context);
  if (status <= MCOR_OK || status >= MCOR_CANCELLED || status == MCOR_DEVICE_ERROR || !message[0])
  {
    fprintf(stderr, "status %d, \"%s\"\n", (int)status, message);
    fuzz_fail("a failure has a sentence, and is none of the device", __FILE__, __LINE__);
  }
}

void fuzz_check_bits(const void* a, const void* b, size_t bytes)
{
  FUZZ_CHECK(!a == !b);
  FUZZ_CHECK(!a || bytes == 0 || memcmp(a, b, bytes) == 0);
}

void fuzz_check_same(const mcor_surface* one, const mcor_surface* other)
{
  mcor_surface a = *one, b = *other;
  mcor_surface_array arrays[MCOR_SURFACE_ARRAYS], others[MCOR_SURFACE_ARRAYS];
  FUZZ_CHECK(a.point_count == b.point_count && a.triangle_count == b.triangle_count);
  const mcor_statistics *p = &a.statistics, *q = &b.statistics;
  FUZZ_CHECK(p->seed_cells == q->seed_cells && p->cells_used == q->cells_used);
  FUZZ_CHECK(p->seed_cells_not_intersected == q->seed_cells_not_intersected);
  const size_t n = (size_t)a.point_count, t = (size_t)a.triangle_count;
  fuzz_check_bits(a.triangles, b.triangles, t * 3 * sizeof(int32_t));
  FUZZ_CHECK(a.line_count == b.line_count && a.line_point_count == b.line_point_count);
  fuzz_check_bits(a.line_offsets, b.line_offsets, ((size_t)a.line_count + 1) * sizeof(int64_t));
  fuzz_check_bits(a.line_points, b.line_points, (size_t)a.line_point_count * sizeof(int32_t));
  fuzz_check_bits(a.band_value, b.band_value, t * sizeof(double));
  fuzz_check_bits(a.triangle_keys, b.triangle_keys, t * MCOR_TRIANGLE_KEY * sizeof(uint64_t));
  mcor_list_surface_arrays(&a, arrays);
  mcor_list_surface_arrays(&b, others);
  for (int i = 0; i < MCOR_SURFACE_ARRAYS; ++i)
  {
    fuzz_check_bits(*arrays[i].array, *others[i].array, n * arrays[i].width);
  }
  FUZZ_CHECK(a.attribute_count == b.attribute_count);
  for (int i = 0; i < a.attribute_count; ++i)
  {
    fuzz_check_bits(a.attributes[i], b.attributes[i], n * (i ? 3 : 1) * sizeof(double));
  }
}
