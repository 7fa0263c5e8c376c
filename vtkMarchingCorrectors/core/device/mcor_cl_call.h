/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cl_call_h
#define mcor_cl_call_h

/* Only for the files mcor_cl_*.c, which call OpenCL. It also says what is special about some
 * drivers. */

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

/* mcor_cl_error.c */
const char* mcor_cl_error_name(cl_int error);
/* Whether an error means that memory ran out. Drivers that allocate late report it in any later
 * call. */
bool mcor_is_no_memory(cl_int error);
/* Sets the error sentence about a call that failed. */
mcor_status mcor_cl_fail(mcor_context* context, cl_int error, const char* what);
#define MCOR_POCL_HINT                                                                             \
  "PoCL needs a folder of its own to compile in, writable and with free space: set "               \
  "POCL_CACHE_DIR "                                                                                \
  "to one (else it is ~/.cache/pocl)."
/* If the device is PoCL, adds to the error sentence which of its files may be the cause. */
void mcor_blame_files(mcor_context* context);

/* Returns the platform whose first device is the default. */
#define MCOR_DEFAULT_PLATFORM "Portable Computing Language"

/* Returns a variable of the environment that only tests set; other builds do not read it. */
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

/* mcor_cl_program.c */
/* Builds a program unless it is built. */
mcor_status mcor_need_program(mcor_context* context, mcor_program number);
/* Drops all programs and their kernels, or only the ones that depend on the variant. */
void mcor_drop_programs(mcor_cl* cl, bool all);

#endif
