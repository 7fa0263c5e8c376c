/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Large pages for large arrays: otherwise the first touch of each 4 kB is a third of the time that
 * ten million particles take. */

#include "mcor_internal.h"
#include "mcor_system.h"

void mcor_use_large_pages(void* memory, size_t bytes)
{
  if (bytes >= MCOR_LARGE_ARRAY)
  {
    mcor_system_want_large_pages(memory, bytes);
  }
}
