/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Turns OpenCL's errors into words. */

#include "mcor_cl_call.h"

#include <stdio.h>
#include <string.h>

/* The names of OpenCL's error codes, which are negative: element i is the name of code -i. */
#define MCOR_NAMED(code) [-(code)] = #code
static const char* const mcor_error_names[] = { MCOR_NAMED(CL_DEVICE_NOT_FOUND),
  MCOR_NAMED(CL_DEVICE_NOT_AVAILABLE), MCOR_NAMED(CL_COMPILER_NOT_AVAILABLE),
  MCOR_NAMED(CL_MEM_OBJECT_ALLOCATION_FAILURE), MCOR_NAMED(CL_OUT_OF_RESOURCES),
  MCOR_NAMED(CL_OUT_OF_HOST_MEMORY), MCOR_NAMED(CL_PROFILING_INFO_NOT_AVAILABLE),
  MCOR_NAMED(CL_MEM_COPY_OVERLAP), MCOR_NAMED(CL_IMAGE_FORMAT_MISMATCH),
  MCOR_NAMED(CL_IMAGE_FORMAT_NOT_SUPPORTED), MCOR_NAMED(CL_BUILD_PROGRAM_FAILURE),
  MCOR_NAMED(CL_MAP_FAILURE), MCOR_NAMED(CL_MISALIGNED_SUB_BUFFER_OFFSET),
  MCOR_NAMED(CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST), MCOR_NAMED(CL_COMPILE_PROGRAM_FAILURE),
  MCOR_NAMED(CL_LINKER_NOT_AVAILABLE), MCOR_NAMED(CL_LINK_PROGRAM_FAILURE),
  MCOR_NAMED(CL_DEVICE_PARTITION_FAILED), MCOR_NAMED(CL_KERNEL_ARG_INFO_NOT_AVAILABLE),
  MCOR_NAMED(CL_INVALID_VALUE), MCOR_NAMED(CL_INVALID_DEVICE_TYPE), MCOR_NAMED(CL_INVALID_PLATFORM),
  MCOR_NAMED(CL_INVALID_DEVICE), MCOR_NAMED(CL_INVALID_CONTEXT),
  MCOR_NAMED(CL_INVALID_QUEUE_PROPERTIES), MCOR_NAMED(CL_INVALID_COMMAND_QUEUE),
  MCOR_NAMED(CL_INVALID_HOST_PTR), MCOR_NAMED(CL_INVALID_MEM_OBJECT),
  MCOR_NAMED(CL_INVALID_IMAGE_FORMAT_DESCRIPTOR), MCOR_NAMED(CL_INVALID_IMAGE_SIZE),
  MCOR_NAMED(CL_INVALID_SAMPLER), MCOR_NAMED(CL_INVALID_BINARY),
  MCOR_NAMED(CL_INVALID_BUILD_OPTIONS), MCOR_NAMED(CL_INVALID_PROGRAM),
  MCOR_NAMED(CL_INVALID_PROGRAM_EXECUTABLE), MCOR_NAMED(CL_INVALID_KERNEL_NAME),
  MCOR_NAMED(CL_INVALID_KERNEL_DEFINITION), MCOR_NAMED(CL_INVALID_KERNEL),
  MCOR_NAMED(CL_INVALID_ARG_INDEX), MCOR_NAMED(CL_INVALID_ARG_VALUE),
  MCOR_NAMED(CL_INVALID_ARG_SIZE), MCOR_NAMED(CL_INVALID_KERNEL_ARGS),
  MCOR_NAMED(CL_INVALID_WORK_DIMENSION), MCOR_NAMED(CL_INVALID_WORK_GROUP_SIZE),
  MCOR_NAMED(CL_INVALID_WORK_ITEM_SIZE), MCOR_NAMED(CL_INVALID_GLOBAL_OFFSET),
  MCOR_NAMED(CL_INVALID_EVENT_WAIT_LIST), MCOR_NAMED(CL_INVALID_EVENT),
  MCOR_NAMED(CL_INVALID_OPERATION), MCOR_NAMED(CL_INVALID_GL_OBJECT),
  MCOR_NAMED(CL_INVALID_BUFFER_SIZE), MCOR_NAMED(CL_INVALID_MIP_LEVEL),
  MCOR_NAMED(CL_INVALID_GLOBAL_WORK_SIZE), MCOR_NAMED(CL_INVALID_PROPERTY),
  MCOR_NAMED(CL_INVALID_IMAGE_DESCRIPTOR), MCOR_NAMED(CL_INVALID_COMPILER_OPTIONS),
  MCOR_NAMED(CL_INVALID_LINKER_OPTIONS), MCOR_NAMED(CL_INVALID_DEVICE_PARTITION_COUNT) };

const char* mcor_cl_error_name(cl_int error)
{
  const int count = (int)(sizeof mcor_error_names / sizeof *mcor_error_names);
  const char* name = error <= 0 && error > -count ? mcor_error_names[-error] : NULL;
  return error == -1001 ? "CL_PLATFORM_NOT_FOUND_KHR" : name ? name : "an OpenCL error";
}

bool mcor_is_no_memory(cl_int error)
{
  return error == CL_MEM_OBJECT_ALLOCATION_FAILURE || error == CL_OUT_OF_RESOURCES ||
    error == CL_OUT_OF_HOST_MEMORY;
}

void mcor_blame_files(mcor_context* context)
{
  const size_t length = strlen(context->error);
  if (mcor_is_pocl(context->cl.platform_name))
  {
    snprintf(context->error + length, sizeof context->error - length, " %s",
      MCOR_POCL_HINT " If a process was killed while PoCL compiled, remove that folder.");
  }
}

mcor_status mcor_cl_fail(mcor_context* context, cl_int error, const char* what)
{
  const char *device = context->cl.device_name, *name = mcor_cl_error_name(error);
  const mcor_status status = mcor_is_no_memory(error)
    ? mcor_fail(
        context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(DEVICE_MEMORY), device, what, name, (int)error)
    : mcor_fail(context, MCOR_DEVICE_ERROR, MCOR_SAY(DEVICE_CALL), device, what, name, (int)error);
  if (error == CL_INVALID_KERNEL_NAME) /* all names are right, so it is the driver's fault */
  {
    mcor_blame_files(context);
  }
  return status;
}
