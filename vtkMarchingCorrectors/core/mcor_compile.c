/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The program marching-correctors-compile, see mcor_ahead.h. It reads a request from its standard
 * input, says nothing, and ends when that input does, or when all is compiled. */

#define _GNU_SOURCE

#include "mcor_ahead.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Whatever a compiler does, there is an end. */
#define MCOR_COMPILE_SECONDS 120

/* Whoever asked is still there. */
static bool mcor_is_wanted(void)
{
  struct pollfd input = { .fd = STDIN_FILENO, .events = POLLIN };
  return poll(&input, 1, 0) == 0;
}

/* Kernels are linked by the small linker beside this program, see mcor_link.c. */
static void mcor_use_own_linker(void)
{
  char path[1024] = "";
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 64);
  char* const end = length > 0 ? strrchr(path, '/') : NULL;
  if (end)
  {
    strcpy(end, "/marching-correctors-linker");
    setenv("COMPILER_PATH", path, 0);
  }
}

int main(void)
{
  static char request[MCOR_AHEAD_BYTES + 1];
  const struct rlimit no_core = { 0, 0 };
  const ssize_t length = read(STDIN_FILENO, request, MCOR_AHEAD_BYTES);
  if (length <= 0 || fork() != 0)
  {
    return 0; /* detached: nobody has to wait for the rest */
  }
  const long files = sysconf(_SC_OPEN_MAX);
  for (int i = STDERR_FILENO + 1; i < (files > 0 && files < 65536 ? (int)files : 65536); ++i)
  {
    close(i); /* what others wait to be closed */
  }
  mcor_use_own_linker();
  setrlimit(RLIMIT_CORE, &no_core);
  alarm(MCOR_COMPILE_SECONDS);
  mcor_compile_ahead(request, mcor_is_wanted);
  _exit(0); /* without the time that drivers take to clean up */
}
