/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cl_call_h
#define mcor_cl_call_h

/* What the files that call OpenCL (mcor_cl_*.c) share: errors, the profile, programs, and kinds of
 * drivers. Only these files include this header. */

#include "mcor_internal.h"
#include "mcor_native.h"

#include <stdlib.h>
#include <string.h>

#define MCOR_CL_TRY(context, call, what)                                                           \
  do                                                                                               \
  {                                                                                                \
    const cl_int mcor_cl_error_ = (call);                                                          \
    if (mcor_cl_error_ != CL_SUCCESS)                                                              \
    {                                                                                              \
      return mcor_cl_fail(context, mcor_cl_error_, what);                                          \
    }                                                                                              \
  } while (0)

/* mcor_cl_profile.c. What a profile counts: launches, waits for the device, bytes to the device and
 * from it, copies and fills on it, buffers that the host sees, memory that a driver locks, and
 * builds. */
typedef enum mcor_command
{
  MCOR_COMMAND_LAUNCH,
  MCOR_COMMAND_WAIT,
  MCOR_COMMAND_WRITE,
  MCOR_COMMAND_READ,
  MCOR_COMMAND_COPY,
  MCOR_COMMAND_MAP,
  MCOR_COMMAND_LOCK,
  MCOR_COMMAND_BUILD
} mcor_command;
/* Opens the profile that MCOR_PROFILE in the environment names, if it is set. */
mcor_status mcor_open_profile(mcor_context* context);
/* Starts the clock of a command. Returns where OpenCL is to write the command's event. */
cl_event* mcor_begin_profiled(struct mcor_profile* profile);
mcor_status mcor_end_profiled(
  mcor_context* context, mcor_command command, const char* name, size_t bytes);
/* Counts one more command in the profile. host, device: how many seconds the command took there.
 * event: NULL, or an event; when the command is done, the profile adds the event's time to the
 * seconds of the device, and releases the event. */
mcor_status mcor_add_to_profile(mcor_context* context, mcor_command command, const char* name,
  int64_t bytes, double host, double device, cl_event event);
/* Returns the seconds between start and end of a command; -1: the driver does not tell. */
double mcor_event_seconds(cl_event event);

/* Runs an OpenCL command, and counts it in the profile if there is one. `call` passes MCOR_EVENT as
 * its event, which is NULL without a profile. */
#define MCOR_CL_COMMAND(context, command, name, bytes, call, what)                                 \
  do                                                                                               \
  {                                                                                                \
    cl_event* const MCOR_EVENT =                                                                   \
      (context)->cl.profile ? mcor_begin_profiled((context)->cl.profile) : NULL;                   \
    MCOR_CL_TRY(context, call, what);                                                              \
    if (MCOR_EVENT)                                                                                \
    {                                                                                              \
      MCOR_TRY(mcor_end_profiled(context, command, name, bytes));                                  \
    }                                                                                              \
  } while (0)

/* mcor_cl_error.c */
const char* mcor_cl_error_name(cl_int error);
/* Whether an error means that memory ran out. Drivers that allocate late report it in any call. */
bool mcor_is_no_memory(cl_int error);
/* Sets the error sentence about OpenCL's function `what`, which failed. Returns the status. */
mcor_status mcor_cl_fail(mcor_context* context, cl_int error, const char* what);
#define MCOR_POCL_HINT                                                                             \
  "PoCL needs a folder of its own to compile in, writable and with free space: set "               \
  "POCL_CACHE_DIR "                                                                                \
  "to one (else it is ~/.cache/pocl)."
/* If the device is PoCL, adds to the error sentence that PoCL's folder may be the cause. */
void mcor_blame_files(mcor_context* context);

static inline bool mcor_is_pocl(const char* platform_name)
{
  return strcmp(platform_name, "Portable Computing Language") == 0;
}

/* Returns a variable of the environment that only tests set; NULL in builds without tests. */
static inline const char* mcor_test_setting(const char* name)
{
#ifdef MCOR_TESTING
  return getenv(name);
#else
  (void)name;
  return NULL;
#endif
}

static inline mcor_status mcor_ask(mcor_context* context, bool compiles)
{
  return context->cl.observer ? context->cl.observer(context, compiles) : MCOR_OK;
}

static inline bool mcor_is_native(const mcor_cl* cl)
{
  return cl->platform == mcor_native_platform();
}

/* mcor_cl_program.c. Builds a program unless it is built. */
mcor_status mcor_need_program(mcor_context* context, mcor_program number);
/* Drops a set of programs, and their kernels. */
void mcor_drop_programs(mcor_cl* cl, int programs);
#define MCOR_PARTS_ALL ((1 << MCOR_PROGRAM_COUNT) - 1)
mcor_status mcor_make_program(mcor_context* context, mcor_program number, cl_program* program);

/* mcor_cl_build.c. Takes a program that is built ahead: waits until it is built, or builds it if no
 * thread has begun to. *error: OpenCL's result of the build. *program and *error do not change if
 * the program is not built ahead, or if the user cancels the call. */
mcor_status mcor_await_program(
  mcor_context* context, mcor_program number, cl_program* program, cl_int* error);

#endif
