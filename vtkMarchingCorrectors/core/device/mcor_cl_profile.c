/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* What a call costs, by phase: seconds, launches of each kernel, waits, transfers. The variable
 * MCOR_PROFILE in the environment names the table to which each call is appended. */

#include "mcor_cl_call.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* Commands of one kind and name within one phase. */
typedef struct mcor_profile_row
{
  mcor_phase phase;
  mcor_command command;
  char name[48]; /* of the kernel; "" for other commands */
  int64_t count, bytes;
  double host, device; /* seconds within OpenCL's calls, and on the device */
} mcor_profile_row;

/* A command that may still run. */
typedef struct mcor_profile_event
{
  cl_event event;
  int64_t row;
} mcor_profile_event;

struct mcor_profile
{
  FILE* file;
  char* path;
  int64_t call; /* counts the calls of this context */
  MCOR_LIST(mcor_profile_row) rows;
  MCOR_LIST(mcor_profile_event) pending;
  cl_event event; /* of the command under way */
  double begin;
};

static const char mcor_profile_head[] =
  "call,phase,command,kernel,count,bytes,host_seconds,device_seconds\n";

/* Fails if a write to the file failed. errno must be 0 before the first write. */
static mcor_status mcor_flush_profile(mcor_context* context)
{
  const struct mcor_profile* profile = context->cl.profile;
  const bool failed = fflush(profile->file) != 0 || ferror(profile->file);
  clearerr(profile->file);
  MCOR_FAIL_IF(
    failed, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(PROFILE_FILE), profile->path, strerror(errno));
  return MCOR_OK;
}

mcor_status mcor_open_profile(mcor_context* context)
{
  const char* path = getenv("MCOR_PROFILE");
  if (!path || !*path)
  {
    return MCOR_OK;
  }
  struct mcor_profile* profile = context->cl.profile = calloc(1, sizeof *profile);
  MCOR_TRY(mcor_allocated(context, profile && (profile->path = malloc(strlen(path) + 1))));
  strcpy(profile->path, path);
  profile->file = fopen(path, "a+");
  MCOR_FAIL_IF(
    !profile->file, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(PROFILE_FILE), path, strerror(errno));
  char begin[sizeof mcor_profile_head] = "";
  rewind(profile->file);
  const bool is_new = !fgets(begin, sizeof begin, profile->file) || !*begin; /* empty or device */
  MCOR_FAIL_IF(!is_new && strcmp(begin, mcor_profile_head) != 0, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(PROFILE_FILE), path, "it holds something else");
  fseek(profile->file, 0, SEEK_END);
  errno = 0;
  fputs(is_new ? mcor_profile_head : "", profile->file);
  return mcor_flush_profile(context);
}

cl_event* mcor_begin_profiled(struct mcor_profile* profile)
{
  profile->event = NULL;
  profile->begin = mcor_seconds();
  return &profile->event;
}

double mcor_event_seconds(cl_event event)
{
  cl_ulong start = 0, end = 0;
  const bool known = clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start,
                       &start, NULL) == CL_SUCCESS &&
    clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, NULL) == CL_SUCCESS;
  return known ? 1e-9 * (double)(end - start) : -1;
}

/* Adds the device's seconds of pending commands to their rows, and releases the events. */
static void mcor_take_events(struct mcor_profile* profile)
{
  for (int64_t i = 0; i < profile->pending.count; ++i)
  {
    const mcor_profile_event* pending = profile->pending.of + i;
    profile->rows.of[pending->row].device += fmax(mcor_event_seconds(pending->event), 0);
    clReleaseEvent(pending->event);
  }
  profile->pending.count = 0;
}

void mcor_close_profile(mcor_context* context)
{
  struct mcor_profile* profile = context->cl.profile;
  if (profile)
  {
    mcor_take_events(profile);
    if (profile->file)
    {
      fclose(profile->file);
    }
    free(profile->path);
    free(profile->rows.of);
    free(profile->pending.of);
    free(profile);
    context->cl.profile = NULL;
  }
}

mcor_status mcor_add_to_profile(mcor_context* context, mcor_command command, const char* name,
  int64_t bytes, double host, double device, cl_event event)
{
  struct mcor_profile* profile = context->cl.profile;
  mcor_profile_row new = { .phase = context->run.phase, .command = command };
  int64_t i = 0;
  if (!profile)
  {
    return MCOR_OK;
  }
  snprintf(new.name, sizeof new.name, "%s", name);
  while (i < profile->rows.count &&
    (profile->rows.of[i].phase != new.phase || profile->rows.of[i].command != command ||
      strcmp(profile->rows.of[i].name, new.name) != 0))
  {
    ++i;
  }
  if (i == profile->rows.count)
  {
    MCOR_APPEND(context, &profile->rows, new);
  }
  mcor_profile_row* row = profile->rows.of + i;
  row->count += 1;
  row->bytes += bytes;
  row->host += host;
  row->device += device;
  if (event)
  {
    MCOR_APPEND(context, &profile->pending, (mcor_profile_event){ event, i });
  }
  return MCOR_OK;
}

mcor_status mcor_end_profiled(
  mcor_context* context, mcor_command command, const char* name, size_t bytes)
{
  struct mcor_profile* profile = context->cl.profile;
  const double host = mcor_seconds() - profile->begin;
  const double device = mcor_is_native(&context->cl) ? host : 0;
  MCOR_TRY(
    mcor_add_to_profile(context, command, name, (int64_t)bytes, host, device, profile->event));
  if (command == MCOR_COMMAND_WAIT)
  {
    mcor_take_events(profile);
  }
  return MCOR_OK;
}

mcor_status mcor_write_profile(
  mcor_context* context, const mcor_statistics* statistics, mcor_status status)
{
  static const char* const names[] = { "launch", "wait", "write", "read", "copy", "map", "lock",
    "build" };
  struct mcor_profile* profile = context->cl.profile;
  if (!profile)
  {
    return status;
  }
  if (context->cl.queue) /* NULL: no device could be started */
  {
    clFinish(context->cl.queue);
  }
  mcor_take_events(profile);
  errno = 0;
  for (int p = 0; p < MCOR_PHASE_COUNT; ++p)
  {
    fprintf(profile->file, "%lld,%s,phase,,1,0,%.9f,0\n", (long long)profile->call,
      mcor_phase_name((mcor_phase)p), statistics->seconds[p]);
  }
  for (int64_t i = 0; i < profile->rows.count; ++i)
  {
    const mcor_profile_row* row = profile->rows.of + i;
    fprintf(profile->file, "%lld,%s,%s,%s,%lld,%lld,%.9f,%.9f\n", (long long)profile->call,
      mcor_phase_name(row->phase), names[row->command], row->name, (long long)row->count,
      (long long)row->bytes, row->host, row->device);
  }
  profile->rows.count = 0;
  ++profile->call;
  return status == MCOR_OK ? mcor_flush_profile(context) : status;
}
