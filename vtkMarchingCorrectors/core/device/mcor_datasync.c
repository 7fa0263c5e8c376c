/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Part of programs of our own, in place of the C library's function, also for the libraries that they
 * load. PoCL waits for the disk for each kernel that it writes into its cache, some ten milliseconds: a
 * tenth of the first surface's time. Here the data are on their way when this returns, and nobody waits;
 * what would be lost if the machine went off in that moment can be compiled again. The surfaces
 * that the command line program writes are synchronised by fsync. */

#define _GNU_SOURCE

#include <fcntl.h>
#include <unistd.h>

int fdatasync(int descriptor)
{
  (void)sync_file_range(descriptor, 0, 0, SYNC_FILE_RANGE_WRITE);
  return 0;
}
