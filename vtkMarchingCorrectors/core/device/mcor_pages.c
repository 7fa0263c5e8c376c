/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Large pages for large arrays: otherwise the first touch of each 4 kB is a third of the time that
 * ten million particles take. */

#if defined(__linux__) && !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* for madvise */
#endif

#include "mcor_internal.h"

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

void mcor_use_large_pages(void* memory, size_t bytes)
{
#ifdef MADV_HUGEPAGE
  const size_t page = (size_t)sysconf(_SC_PAGESIZE);
  const size_t skipped = (page - (uintptr_t)memory % page) % page;
  if (bytes >= MCOR_LARGE_ARRAY)
  {
    /* Only a request: where it is refused, pages stay small. */
    (void)madvise((char*)memory + skipped, (bytes - skipped) / page * page, MADV_HUGEPAGE);
  }
#else
  (void)memory;
  (void)bytes;
#endif
}
