/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The program marching-correctors-compile, see mcor_ahead.h. It reads a request from its standard
 * input, says nothing, and ends when that input does, or when all is compiled. With
 * `--keep [SPH KERNEL]...`, it compiles the kernels that all users of a machine share, see mcor_kept.h,
 * for these SPH kernels or for all of them. */

#define _GNU_SOURCE

#include "mcor_ahead.h"
#include "mcor_kept.h"
#include "mcor_sph_kernel.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

/* Whatever a compiler does, there is an end. */
#define MCOR_COMPILE_SECONDS 120

/* Whoever asked is still there. */
static bool mcor_is_wanted(void)
{
  struct pollfd input = { .fd = STDIN_FILENO, .events = POLLIN };
  return poll(&input, 1, 0) == 0;
}

/* Path of what is beside this program. */
static bool mcor_find_beside(const char* name, char path[1024])
{
  const ssize_t length = readlink("/proc/self/exe", path, 1024 - 64);
  path[length > 0 ? length : 0] = '\0';
  char* const end = strrchr(path, '/');
  if (end)
  {
    strcpy(end + 1, name);
  }
  return end != NULL;
}

/* Kernels are linked by the small linker beside this program, see mcor_link.c. */
static void mcor_use_own_linker(void)
{
  char path[1024];
  if (mcor_find_beside("marching-correctors-linker", path))
  {
    setenv("COMPILER_PATH", path, 0);
  }
}

/* Bits of the SPH kernels that are named; all of them if none is; 0 where a name is unknown. */
static unsigned mcor_named_kernels(int count, char** names)
{
#define MCOR_ENTRY(id, name, support, norm, tensor) #name,
  static const char* const known[] = { MCOR_SPH_KERNEL_TABLE(MCOR_ENTRY) };
#undef MCOR_ENTRY
  const unsigned all = (1u << MCOR_SPH_KERNEL_COUNT) - 1;
  unsigned kernels = count == 0 ? all : 0;
  for (int i = 0; i < count; ++i)
  {
    int k = 0;
    while (k < MCOR_SPH_KERNEL_COUNT && strcmp(names[i], known[k]) != 0)
    {
      ++k;
    }
    if (k == MCOR_SPH_KERNEL_COUNT)
    {
      fprintf(stderr, "marching-correctors-compile: there is no SPH kernel %s.\n", names[i]);
      return 0;
    }
    kernels |= 1u << k;
  }
  return kernels;
}

static int mcor_keep_kernels(unsigned sph_kernels)
{
  mcor_context* context = NULL;
  char folder[1024];
  const char* own = getenv("MCOR_KERNEL_DIR");
  const bool known = own ? *own && snprintf(folder, sizeof folder, "%s", own) < (int)sizeof folder
                         : mcor_find_beside("marching-correctors-kernels", folder);
  if (!known || (mkdir(folder, 0755) != 0 && access(folder, W_OK | X_OK) != 0))
  {
    fprintf(stderr, "marching-correctors-compile: %s cannot be written.\n",
      known ? folder : "MCOR_KERNEL_DIR");
    return 1;
  }
  setenv("POCL_CACHE_DIR", folder, 1);
  mcor_use_own_linker();
  mcor_status status = mcor_create_context(NULL, &context);
  if (status == MCOR_OK)
  {
    printf("Compiling the usual surfaces' kernels into %s ...\n", folder);
    fflush(stdout);
    status = mcor_keep(context, sph_kernels, folder);
  }
  if (status != MCOR_OK)
  {
    fprintf(stderr, "marching-correctors-compile: %s\n", mcor_last_error(context));
  }
  mcor_free_context(context);
  return status != MCOR_OK;
}

int main(int count, char** arguments)
{
  static char request[MCOR_AHEAD_BYTES + 1];
  const struct rlimit no_core = { 0, 0 };
  if (count > 1 && strcmp(arguments[1], "--keep") == 0)
  {
    const unsigned sph_kernels = mcor_named_kernels(count - 2, arguments + 2);
    return sph_kernels ? mcor_keep_kernels(sph_kernels) : 2;
  }
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
