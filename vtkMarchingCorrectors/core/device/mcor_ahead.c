/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

#if !defined(_WIN32) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* for pipe2 */
#endif

#include "mcor_ahead.h"
#include "mcor_cache.h"
#include "mcor_internal.h"
#include "mcor_kept.h"
#include "mcor_program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef _WIN32
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#define MCOR_PATH_LIMIT 1024

int mcor_list_ahead(
  const mcor_build* build, int64_t particles, mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT])
{
  enum
  {
    ALL = 3,
    FREE = 1,  /* the free surface: nothing is trimmed */
    SCALAR = 2 /* all others */
  };
  /* items: work-items for each particle, about; 0: few enough whatever the input is. */
  static const struct
  {
    const char* name;
    mcor_program program;
    mcor_load load;
    int items, surfaces;
  } all[] = { { "mcor_grid_key", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 1, ALL },
    { "mcor_sort_count", MCOR_PROGRAM_LATTICE, MCOR_HEAVY, 0, ALL },
    { "mcor_scan_fill", MCOR_PROGRAM_LATTICE, MCOR_HEAVY, 0, ALL },
    { "mcor_sort_fill", MCOR_PROGRAM_LATTICE, MCOR_HEAVY, 0, ALL },
    { "mcor_grid_order", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 0, ALL },
    { "mcor_bucket_fill", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 0, ALL },
    { "mcor_grid_gather_value", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 1, SCALAR },
    { "mcor_grid_order_value", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 1, SCALAR },
    { "mcor_seed_side_flags", MCOR_PROGRAM_FIELD, MCOR_MEDIUM, 0, SCALAR },
    { "mcor_block_all", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_block_states", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, ALL },
    { "mcor_block_find_inactive", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_seed_regions", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, ALL },
    { "mcor_brick_count", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_brick_fill", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_sign", MCOR_PROGRAM_FIELD, MCOR_MEDIUM, 0, ALL },
    { "mcor_seed_bricks", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, ALL },
    { "mcor_block_request_known", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_seed_request", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_seed_grow", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_brick_move", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_bits", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_brick_neighbours", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_need", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_nodes", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, ALL },
    { "mcor_march_classify", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_count", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_vertices", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_march_triangles", MCOR_PROGRAM_LATTICE, MCOR_MEDIUM, 0, ALL },
    { "mcor_grid_gather_value", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 1, FREE },
    { "mcor_group_count", MCOR_PROGRAM_FIELD, MCOR_MEDIUM, 0, ALL },
    { "mcor_scan_sum", MCOR_PROGRAM_LATTICE, MCOR_HEAVY, 0, ALL },
    { "mcor_scan_top", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 0, ALL },
    { "mcor_group_fill", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 2, ALL },
    { "mcor_correct_vertices", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, ALL },
    { "mcor_trim_count", MCOR_PROGRAM_FIELD, MCOR_MEDIUM, 0, SCALAR },
    { "mcor_trim_edges", MCOR_PROGRAM_FIELD, MCOR_MEDIUM, 0, SCALAR },
    { "mcor_unique_count", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 0, SCALAR },
    { "mcor_unique_fill", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 0, SCALAR },
    { "mcor_trim_fill", MCOR_PROGRAM_FIELD, MCOR_MEDIUM, 0, SCALAR },
    { "mcor_trim_linear", MCOR_PROGRAM_FIELD, MCOR_LIGHT, 0, SCALAR },
    { "mcor_trim_solve_weight", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, SCALAR },
    { "mcor_trim_used", MCOR_PROGRAM_LATTICE, MCOR_LIGHT, 6, ALL },
    { "mcor_attribute_nearest", MCOR_PROGRAM_FIELD, MCOR_HEAVY, 0, ALL } };
  const int surface = build->field == MCOR_WEIGHT_SUM ? FREE : SCALAR;
  int count = 0;
  for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
  {
    if (all[i].surfaces & surface)
    {
      kernels[count++] = (mcor_ahead_kernel){ all[i].name, all[i].program, all[i].load,
        all[i].items * particles >= MCOR_LARGE_LAUNCH };
    }
  }
  return count;
}

mcor_status mcor_compile_ahead(char* request, bool (*wanted)(void))
{
  mcor_context* context = NULL;
  int numbers[4], length = 0;
  char* const device = strtok(request, "\n");
  char* line = strtok(NULL, "\n");
  if (!line || sscanf(line, "%d %d %d %d", numbers, numbers + 1, numbers + 2, numbers + 3) != 4)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  const mcor_build build = { .sph_kernel = (mcor_sph_kernel)numbers[0],
    .field = (mcor_field)numbers[1],
    .precision = (mcor_type)numbers[2],
    .solids = numbers[3] != 0 };
  mcor_status status = mcor_create_context(device, &context);
  if (status == MCOR_OK)
  {
    mcor_guess_build(context, &build);
  }
  while (status == MCOR_OK && wanted() && (line = strtok(NULL, "\n")))
  {
    if (sscanf(line, "%d %d %d %n", numbers, numbers + 1, numbers + 2, &length) == 3)
    {
      const mcor_ahead_kernel kernel = { line + length, (mcor_program)numbers[0],
        (mcor_load)numbers[1], numbers[2] != 0 };
      status = mcor_compile_kernel(context, &kernel);
    }
  }
  mcor_free_context(context);
  return status;
}

#ifdef _WIN32

void mcor_begin_ahead(mcor_context* context, const mcor_build* build, const mcor_input* input)
{
  (void)context;
  (void)build;
  (void)input;
}

void mcor_end_ahead(mcor_context* context, bool succeeded)
{
  (void)context;
  (void)succeeded;
}

#else

/* The path of the program that compiles; false where there is none. */
static bool mcor_find_compiler(char path[MCOR_PATH_LIMIT])
{
  const char* own = getenv("MCOR_COMPILER");
  if (own)
  {
    snprintf(path, MCOR_PATH_LIMIT, "%s", own);
    return *own && access(path, X_OK) == 0;
  }
  return mcor_library_path("marching-correctors-compile", path, MCOR_PATH_LIMIT) &&
    access(path, X_OK) == 0;
}

int mcor_write_request(const mcor_cl* cl, const mcor_build* build, const mcor_ahead_kernel* kernels,
  int count, char text[MCOR_AHEAD_BYTES])
{
  int length = snprintf(text, MCOR_AHEAD_BYTES, "%d\n%d %d %d %d\n", cl->device_number,
    (int)build->sph_kernel, (int)build->field, (int)build->precision, (int)build->solids);
  /* The lattice's are this process's first. */
  for (int p = MCOR_PROGRAM_FIELD; p >= MCOR_PROGRAM_LATTICE; --p)
  {
    for (int i = count; i-- > 0 && length < MCOR_AHEAD_BYTES - 80;)
    {
      if (kernels[i].program == (mcor_program)p)
      {
        length += snprintf(text + length, (size_t)(MCOR_AHEAD_BYTES - length), "%d %d %d %s\n", p,
          (int)kernels[i].load, (int)kernels[i].large, kernels[i].name);
      }
    }
  }
  return length;
}

bool mcor_ready_file(
  const mcor_cl* cl, const mcor_build* build, const char* request, char path[MCOR_PATH_LIMIT])
{
  char folder[MCOR_PATH_LIMIT];
  mcor_cache_key key = mcor_device_key(cl);
  mcor_cl guess = *cl;
  guess.build = *build;
  guess.lanes = 8;
  for (int p = MCOR_PROGRAM_LATTICE; p <= MCOR_PROGRAM_FIELD; ++p)
  {
    const char* sources[MCOR_SOURCE_LIMIT];
    const int count = mcor_program_sources(&guess, (mcor_program)p, sources);
    for (int i = 0; i < count; ++i)
    {
      mcor_cache_add(&key, sources[i]);
    }
  }
  mcor_cache_add(&key, request);
  const char* lanes = getenv("MCOR_LANES");
  mcor_cache_add(&key, lanes ? lanes : "");
  mcor_pocl_folder(folder, sizeof folder);
  return snprintf(path, MCOR_PATH_LIMIT, "%s/marching-correctors-%016llx.ready", folder,
           (unsigned long long)key.words[0]) < MCOR_PATH_LIMIT;
}

/* Starts the program with the request to read, and leaves the end of its input to this process: it
 * stops when that is closed, by us or by our end. It detaches itself at once, so that there is a
 * child to wait for only here. */
static int mcor_start_compiler(const char* path, const char* request, int length)
{
  int ends[2];
  pid_t child = -1;
  char* arguments[] = { (char*)path, NULL };
  sigset_t none, all;
  if (pipe2(ends, O_CLOEXEC) != 0)
  {
    return -1;
  }
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_init(&attributes);
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  /* Fits into the pipe: nothing waits. */
  const bool started = write(ends[1], request, (size_t)length) == length &&
    posix_spawn(&child, path, &files, &attributes, arguments, environ) == 0;
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  close(ends[0]);
  while (started && waitpid(child, NULL, 0) < 0 && errno == EINTR)
  {
  }
  if (!started)
  {
    close(ends[1]);
    return -1;
  }
  return ends[1];
}

/* Particles that take part, about. */
static int64_t mcor_count_ahead(const mcor_build* build, const mcor_input* input)
{
  int64_t count = input->count;
  for (int64_t i = 0; input->solid && !build->solids && i < input->count; ++i)
  {
    count -= input->solid[i] != 0;
  }
  return count;
}

void mcor_begin_ahead(mcor_context* context, const mcor_build* build, const mcor_input* input)
{
  mcor_ahead* ahead = &context->ahead;
  char compiler[MCOR_PATH_LIMIT], request[MCOR_AHEAD_BYTES];
  mcor_ahead_kernel kernels[MCOR_AHEAD_LIMIT];
  if (!mcor_can_compile_ahead(&context->cl, build))
  {
    return;
  }
  const int count = mcor_list_ahead(build, mcor_count_ahead(build, input), kernels);
  const int length = mcor_write_request(&context->cl, build, kernels, count, request);
  char ready[MCOR_PATH_LIMIT];
  if (mcor_ready_file(&context->cl, build, request, ready) && access(ready, F_OK) != 0 &&
    !mcor_take_kept(ready) && mcor_find_compiler(compiler))
  {
    ahead->input = mcor_start_compiler(compiler, request, length);
    ahead->started = ahead->input >= 0;
    snprintf(ahead->ready, sizeof ahead->ready, "%s", ready);
  }
}

void mcor_end_ahead(mcor_context* context, bool succeeded)
{
  mcor_ahead* ahead = &context->ahead;
  if (!ahead->started)
  {
    return;
  }
  close(ahead->input);
  ahead->started = false;
  FILE* file = succeeded ? fopen(ahead->ready, "w") : NULL;
  if (file)
  {
    fclose(file);
  }
}

#endif
