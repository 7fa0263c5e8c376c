/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Memory of the host. */

#include "mcor_internal.h"
#include "mcor_system.h"

#include <stdlib.h>

mcor_status mcor_allocated(mcor_context* context, bool complete)
{
  return complete ? MCOR_OK : mcor_fail(context, MCOR_OUT_OF_CAPACITY, "Host memory ran out.");
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

/* Asks for large pages. Without them, the first touch of each 4 kB of large arrays takes a third
 * of the time of a run with ten million particles. */
void mcor_use_large_pages(void* memory, size_t bytes)
{
  if (bytes >= MCOR_LARGE_ARRAY)
  {
    mcor_system_want_large_pages(memory, bytes);
  }
}
