/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#if defined(__linux__) && !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* for clock_gettime */
#endif

#include "mcor_internal.h"
#include "mcor_sph_kernel.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

const char* mcor_status_name(mcor_status status)
{
  static const char* const names[] = { "ok", "invalid argument", "invalid data", "out of capacity",
    "device error", "cancelled" };
  return (unsigned)status < sizeof names / sizeof names[0] ? names[status] : "unknown status";
}

const char* mcor_phase_name(mcor_phase phase)
{
  static const char* const names[MCOR_PHASE_COUNT] = { "input", "search grid", "seeds",
    "extraction", "correction", "trimming", "output" };
  return (unsigned)phase < MCOR_PHASE_COUNT ? names[phase] : "unknown phase";
}

#define MCOR_ENTRY(id, name, support, norm, tensor, variance, plane, c, usual, usual_in_plane)     \
  { #name, #norm, #support, { usual, usual_in_plane }, support, norm, { variance, plane }, c,      \
    tensor },
static const mcor_kernel_row mcor_kernel_table[] = { MCOR_SPH_KERNEL_TABLE(MCOR_ENTRY) };
#undef MCOR_ENTRY
_Static_assert(sizeof mcor_kernel_table / sizeof mcor_kernel_table[0] == MCOR_SPH_KERNEL_COUNT,
  "a row for each kernel");

int mcor_find_sph_kernel(const char* name)
{
  for (int k = 0; name && k < MCOR_SPH_KERNEL_COUNT; ++k)
  {
    if (strcmp(name, mcor_kernel_table[k].name) == 0)
    {
      return k;
    }
  }
  return -1;
}

const char* mcor_sph_kernel_name(mcor_sph_kernel kernel)
{
  return (unsigned)kernel < MCOR_SPH_KERNEL_COUNT ? mcor_kernel_table[kernel].name : NULL;
}

double mcor_support_factor(mcor_sph_kernel kernel)
{
  return (unsigned)kernel < MCOR_SPH_KERNEL_COUNT ? mcor_kernel_table[kernel].support : 0;
}

const mcor_kernel_row* mcor_kernel_of(mcor_sph_kernel kernel)
{
  return &mcor_kernel_table[kernel];
}

mcor_status mcor_fail(
  mcor_context* context, mcor_status status, mcor_says code, const char* format, ...)
{
  va_list args;
  va_start(args, format);
  if (context)
  {
    context->code = code;
    vsnprintf(context->error, sizeof context->error, format, args);
  }
  va_end(args);
  return status;
}

mcor_status mcor_allocated(mcor_context* context, bool complete)
{
  return complete ? MCOR_OK : mcor_fail(context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(HOST_MEMORY));
}

mcor_status mcor_make_room(
  mcor_context* context, void** array, int64_t count, int64_t* room, size_t width)
{
  if (count < *room)
  {
    return MCOR_OK;
  }
  const int64_t more = 2 * *room + 1024;
  void* grown = realloc(*array, (size_t)more * width);
  *array = grown ? grown : *array;
  *room = grown ? more : *room;
  return mcor_allocated(context, grown);
}

const char* mcor_last_error(const mcor_context* context)
{
  if (!context)
  {
    return mcor_says_text(MCOR_SAYS_HOST_MEMORY);
  }
  char* told = (char*)context->told; /* may change: it only repeats the failure */
  mcor_fill_text(context->error, NULL, NULL, told, sizeof context->told);
  return told;
}

mcor_message mcor_last_message(const mcor_context* context)
{
  return !context     ? mcor_say(MCOR_SAY(HOST_MEMORY))
    : *context->error ? mcor_say(context->code, "%s", context->error)
                      : MCOR_NO_MESSAGE;
}

double mcor_seconds(void)
{
  struct timespec now;
#ifdef CLOCK_MONOTONIC
  clock_gettime(CLOCK_MONOTONIC, &now);
#else
  timespec_get(&now, TIME_UTC);
#endif
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
