/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Builds programs when they are first needed. Drivers keep what they have built, see devices.md. */

#include "mcor_cl_call.h"
#include "mcor_program.h"

#include <stdlib.h>

void mcor_drop_programs(mcor_cl* cl, int programs)
{
  int kept = 0;
  mcor_end_building(cl);
  for (int i = 0; i < cl->kernel_count; ++i)
  {
    if (1 << cl->kernels[i].program & programs)
    {
      clReleaseKernel(cl->kernels[i].kernel);
    }
    else
    {
      cl->kernels[kept++] = cl->kernels[i];
    }
  }
  cl->kernel_count = kept;
  for (int p = 0; p < MCOR_PROGRAM_COUNT; ++p)
  {
    if (cl->programs[p] && (1 << p & programs))
    {
      clReleaseProgram(cl->programs[p]);
      cl->programs[p] = NULL;
    }
  }
}

mcor_status mcor_make_program(mcor_context* context, mcor_program number, cl_program* program)
{
  const mcor_cl* cl = &context->cl;
  const char* sources[MCOR_SOURCE_LIMIT];
  const cl_uint count = (cl_uint)mcor_program_sources(cl, mcor_parts_of(cl, number), sources);
  cl_int error;
  *program = clCreateProgramWithSource(cl->context, count, sources, NULL, &error);
  MCOR_CL_TRY(context, error, "clCreateProgramWithSource");
  return MCOR_OK;
}

mcor_status mcor_need_program(mcor_context* context, mcor_program number)
{
  mcor_cl* cl = &context->cl;
  if (cl->programs[number])
  {
    return MCOR_OK;
  }
  MCOR_TRY(mcor_ask(context, !mcor_is_native(cl)));
  const double begin = mcor_seconds();
  char options[512];
  mcor_program_options(cl, number, options, sizeof options);
  cl_program program = NULL;
  cl_int error = CL_SUCCESS;
  MCOR_TRY(mcor_await_program(context, number, &program, &error));
  if (!program)
  {
    MCOR_TRY(mcor_make_program(context, number, &program));
    error = clBuildProgram(program, 1, &cl->device, options, NULL, NULL);
  }
  const double seconds = mcor_seconds() - begin;
  cl->build_seconds += seconds;
  MCOR_TRY(mcor_add_to_profile(context, MCOR_COMMAND_BUILD, "", 0, seconds, 0, NULL));
  if (error == CL_SUCCESS)
  {
    cl->programs[number] = program;
    return MCOR_OK;
  }
  if (mcor_is_native(cl))
  {
    char missing[MCOR_BUILD_NAME];
    clReleaseProgram(program);
    mcor_name_build(&cl->build, missing, sizeof missing);
    return mcor_fail(context, MCOR_DEVICE_ERROR, MCOR_SAY(NO_KERNELS_HERE), missing);
  }
  size_t size = 0;
  clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, 0, NULL, &size);
  char* log = calloc(size + 1, 1);
  if (log)
  {
    clGetProgramBuildInfo(program, cl->device, CL_PROGRAM_BUILD_LOG, size, log, NULL);
  }
  clReleaseProgram(program);
  mcor_fail(context, MCOR_DEVICE_ERROR, MCOR_SAY(DEVICE_BUILD), cl->device_name,
    mcor_cl_error_name(error), options, log ? log : "");
  free(log);
  mcor_blame_files(context);
  return MCOR_DEVICE_ERROR;
}

/* Returns how many evaluation points a work-item treats at once, the programs' MCOR_LANES. In
 * tests, the environment variable MCOR_LANES may set this number. */
static int mcor_choose_lanes(const mcor_cl* cl, mcor_type precision)
{
  const char* forced = mcor_test_setting("MCOR_LANES");
  const int number = forced ? atoi(forced) : 0;
  return number == 8 || number == 16              ? number
    : (forced && *forced) || !cl->is_cpu          ? 1
    : precision == MCOR_FLOAT64 || cl->width < 16 ? 8
                                                  : 16;
}

bool mcor_has_ahead(const mcor_cl* cl, const mcor_build* build)
{
  char options[512];
  mcor_cl tried = *cl;
  tried.build = *build;
  tried.lanes = mcor_choose_lanes(cl, build->precision);
  mcor_program_options(&tried, MCOR_PROGRAM_NODES, options, sizeof options);
  return mcor_find_program(options) != NULL;
}

mcor_status mcor_choose_build(mcor_context* context, const mcor_build* build)
{
  mcor_cl* cl = &context->cl;
  const bool is_double = build->precision == MCOR_FLOAT64;
  MCOR_FAIL_IF(is_double && !cl->has_fp64, context, MCOR_DEVICE_ERROR,
    MCOR_SAY(NO_DOUBLE_PRECISION), cl->device_name);
  const mcor_build* now = &cl->build;
  const int lanes = mcor_choose_lanes(cl, build->precision);
  const int without_field = 1 << MCOR_PROGRAM_ATTRIBUTES | 1 << MCOR_PROGRAM_DENSITY;
  const int without_solids = lanes == 1 ? MCOR_PARTS_PROBE : 0;
  const int changed = cl->lanes != lanes || now->precision != build->precision ? MCOR_PARTS_ALL
    : now->sph_kernel != build->sph_kernel ? MCOR_PARTS_FIELD | MCOR_PARTS_PROBE
    : now->solids != build->solids ? (MCOR_PARTS_FIELD | MCOR_PARTS_PROBE) & ~without_solids
    : now->field != build->field   ? MCOR_PARTS_FIELD & ~without_field
                                   : 0;
  if (changed)
  {
    mcor_drop_programs(cl, changed);
    cl->lanes = lanes;
    cl->build = *build;
    cl->real_size = is_double ? sizeof(cl_double) : sizeof(cl_float);
    cl->fix_size = is_double ? sizeof(cl_long) : sizeof(cl_int);
  }
  return MCOR_OK;
}
