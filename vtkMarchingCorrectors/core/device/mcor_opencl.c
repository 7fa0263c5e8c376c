/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds OpenCL at run time. The platforms are the built-in one, and the ones that the system's
 * loader lists. Without a loader there are no drivers; this is not an error. */

#include "mcor_opencl.h"
#include "mcor_native.h"
#include "mcor_system.h"

/* The type of clGetPlatformIDs, whose name differs between headers. */
typedef cl_int(CL_API_CALL* mcor_platform_lister)(cl_uint, cl_platform_id*, cl_uint*);

cl_uint mcor_list_platforms(cl_uint room, cl_platform_id* platforms)
{
  cl_platform_id own = mcor_native_platform();
  const mcor_platform_lister list = (mcor_platform_lister)mcor_system_opencl();
  cl_uint native = 0, found = 0;
  if (own && room > 0)
  {
    platforms[native++] = own;
  }
  if (!list || room == native || list(room - native, platforms + native, &found) != CL_SUCCESS)
  {
    found = 0;
  }
  return native + (found < room - native ? found : room - native);
}
