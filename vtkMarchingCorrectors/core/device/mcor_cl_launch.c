/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Kernels and their launches. */

#include "mcor_cl_call.h"
#include "mcor_program.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Finds a kernel that was made before, or makes the kernel. */
static mcor_status mcor_find_kernel(mcor_context* context, const char* name, mcor_kernel** found)
{
  mcor_cl* cl = &context->cl;
  for (int i = 0; i < cl->kernel_count; ++i)
  {
    if (strcmp(cl->kernels[i].name, name) == 0)
    {
      *found = &cl->kernels[i];
      return MCOR_OK;
    }
  }
  MCOR_TRY(mcor_make_room(
    context, (void**)&cl->kernels, cl->kernel_count, &cl->kernel_room, sizeof *cl->kernels));
  mcor_kernel* kernel = *found = &cl->kernels[cl->kernel_count];
  *kernel = (mcor_kernel){ .program = mcor_program_of(cl, name) };
  snprintf(kernel->name, sizeof kernel->name, "%s", name);
  MCOR_TRY(mcor_need_program(context, kernel->program));
  cl_int error;
  kernel->kernel = clCreateKernel(cl->programs[kernel->program], name, &error);
  MCOR_CL_TRY(context, error, name);
  ++cl->kernel_count;
  return MCOR_OK;
}

/* A driver compiles if a kernel's first launch takes this much longer than the kernel itself. */
#define MCOR_COMPILE_SECONDS 0.01

/* Launches a kernel for the first time, alone, since drivers may compile it only now. The time of
 * the launch, without the time that the kernel runs, counts as building. */
static mcor_status mcor_enqueue_first(mcor_context* context, const mcor_kernel* kernel,
  const size_t* offset, const size_t* global, const size_t* group)
{
  mcor_cl* cl = &context->cl;
  cl_event event;
  MCOR_TRY(mcor_finish(context));
  const double begin = mcor_seconds();
  MCOR_CL_TRY(context,
    clEnqueueNDRangeKernel(
      cl->timed_queue, kernel->kernel, 1, offset, global, group, 0, NULL, &event),
    kernel->name);
  const cl_int error = clFinish(cl->timed_queue);
  const double seconds = mcor_seconds() - begin;
  const double running = error == CL_SUCCESS ? mcor_event_seconds(event) : -1;
  clReleaseEvent(event);
  MCOR_CL_TRY(context, error, kernel->name);
  if (running >= 0)
  {
    const double building = fmax(seconds - running, 0);
    cl->build_seconds += building;
    cl->compiles = building > MCOR_COMPILE_SECONDS;
    MCOR_TRY(mcor_add_to_profile(context, MCOR_COMMAND_BUILD, kernel->name, 0, building, 0, NULL));
  }
  return mcor_add_to_profile(
    context, MCOR_COMMAND_LAUNCH, kernel->name, 0, fmax(running, 0), fmax(running, 0), NULL);
}

/* The time that a part of a launch should take. Drivers of GPUs abort a launch that takes
 * seconds, and a user may want to cancel the run. A single work-item is never cut. */
#define MCOR_PART_SECONDS 0.04
#define MCOR_FIRST_PART 65536 /* work-items, on a GPU */
/* MCOR_PART_TERMS: in single precision, a part has at most this many terms of sums for each compute
 * unit of a CPU. MCOR_DOUBLE_TERMS: the same in double precision, in which a term takes longer.
 * These limits hold even if parts are done quickly, because the next work-items may have far more
 * to do. */
#define MCOR_PART_TERMS (1 << 21)
/* If a kernel's time is not known yet, its first part on a CPU with a driver has 1 /
 * MCOR_FIRST_SHARE of the work-items that a part may have. */
#define MCOR_FIRST_SHARE 32
#define MCOR_DOUBLE_TERMS (1 << 19)

/* Launches `count` work-items from `offset` on. Drivers may compile a kernel once more for
 * MCOR_LARGE_LAUNCH items or more, and once more if the first item is not 0. The built-in device
 * compiles nothing. */
static mcor_status mcor_enqueue_part(
  mcor_context* context, mcor_kernel* kernel, size_t offset, size_t count, size_t group)
{
  mcor_cl* cl = &context->cl;
  const size_t* from = offset > 0 ? &offset : NULL;
  bool* launched = &kernel->launched[offset > 0][count >= MCOR_LARGE_LAUNCH];
  *launched = *launched || mcor_is_native(cl);
  if (!*launched && cl->compiles)
  {
    MCOR_TRY(mcor_ask(context, true));
  }
  if (!*launched)
  {
    MCOR_TRY(mcor_enqueue_first(context, kernel, from, &count, &group));
    *launched = true;
    return MCOR_OK;
  }
  MCOR_CL_COMMAND(context, MCOR_COMMAND_LAUNCH, kernel->name, 0,
    clEnqueueNDRangeKernel(cl->queue, kernel->kernel, 1, from, &count, &group, 0, NULL, MCOR_EVENT),
    kernel->name);
  return MCOR_OK;
}

/* Launches all work-items in parts, which should take MCOR_PART_SECONDS each. On a CPU, a part has
 * the fewer work-items, the more particles reach a point (cl->terms). On the built-in device, parts
 * cost nothing, so each launch begins with small parts. With a driver, a launch begins with the
 * kernel's last part size, because drivers may compile the kernel once more for a second part. */
static mcor_status mcor_enqueue_cut(
  mcor_context* context, mcor_kernel* kernel, mcor_load load, size_t global, size_t group)
{
  const mcor_cl* cl = &context->cl;
  const double units = cl->units,
               terms = cl->real_size == sizeof(cl_double) ? MCOR_DOUBLE_TERMS : MCOR_PART_TERMS;
  double limit = cl->is_cpu ? terms * units / fmax(cl->terms, 1) : INFINITY;
  double part = kernel->part > 0 ? kernel->part
    : cl->is_cpu                 ? limit / MCOR_FIRST_SHARE
                                 : MCOR_FIRST_PART;
  if (mcor_is_native(cl))
  {
    limit = load == MCOR_HEAVY ? fmin(2048 * units, limit)
      : load == MCOR_MEDIUM    ? 16384 * units
                               : (1 << 20) * units;
    part = (load == MCOR_HEAVY ? 32 : load == MCOR_MEDIUM ? 1024 : 1 << 17) * units;
  }
  part = fmin(part, limit);
  size_t count = 0;
  for (size_t offset = 0; offset < global; offset += count)
  {
    const size_t rest = (global - offset) / group;
    const size_t groups = part < (double)group ? 1 : (size_t)(part / (double)group);
    count = (groups < rest ? groups : rest) * group;
    if (count == global)
    {
      return mcor_enqueue_part(context, kernel, 0, count, group);
    }
    MCOR_TRY(mcor_finish(context));
    const double begin = mcor_seconds(), built = cl->build_seconds;
    MCOR_TRY(mcor_enqueue_part(context, kernel, offset, count, group));
    MCOR_TRY(mcor_finish(context));
    const double seconds = mcor_seconds() - begin - (cl->build_seconds - built);
    part = seconds < MCOR_PART_SECONDS / 2 && groups < rest ? fmin(2 * part, limit)
      : seconds > 2 * MCOR_PART_SECONDS ? fmax(part * MCOR_PART_SECONDS / seconds, (double)group)
                                        : part;
    kernel->part = part;
    MCOR_TRY(mcor_ask(context, false));
  }
  return MCOR_OK;
}

mcor_status mcor_launch(mcor_context* context, const char* name, mcor_load load, size_t items,
  const mcor_arg* args, size_t arg_count)
{
  mcor_cl* cl = &context->cl;
  if (items == 0)
  {
    return MCOR_OK;
  }
  if (load == MCOR_HEAVY && cl->observer)
  {
    MCOR_TRY(mcor_finish(context)); /* the time must not include earlier launches */
  }
  MCOR_TRY(mcor_ask(context, false));
  mcor_kernel* kernel = NULL;
  MCOR_TRY(mcor_find_kernel(context, name, &kernel));
  cl_uint wanted = 0;
  clGetKernelInfo(kernel->kernel, CL_KERNEL_NUM_ARGS, sizeof wanted, &wanted, NULL);
  MCOR_FAIL_IF(arg_count != wanted, context, MCOR_DEVICE_ERROR, MCOR_SAY(KERNEL_ARGUMENTS), name,
    (unsigned)wanted, arg_count);
  for (size_t i = 0; i < arg_count; ++i)
  {
    const mcor_arg* arg = args + i;
    const cl_float single = (cl_float)arg->real;
    const void* const value = arg->kind == MCOR_ARG_BUFFER ? (const void*)&arg->buffer->mem
      : arg->kind == MCOR_ARG_INT                          ? (const void*)&arg->integer
      : cl->real_size == sizeof single                     ? (const void*)&single
                                                           : &arg->real;
    const size_t size = arg->kind == MCOR_ARG_BUFFER ? sizeof(cl_mem)
      : arg->kind == MCOR_ARG_INT                    ? sizeof(cl_int)
                                                     : cl->real_size;
    MCOR_CL_TRY(context, clSetKernelArg(kernel->kernel, (cl_uint)i, size, value), name);
  }
  const size_t group = cl->is_cpu && load != MCOR_LIGHT ? 1 : 64;
  const size_t global = (items + group - 1) / group * group;
  const bool watched = cl->observer != NULL;
  const bool is_cut = load == MCOR_HEAVY ? !cl->is_cpu || watched : watched && mcor_is_native(cl);
  return is_cut ? mcor_enqueue_cut(context, kernel, load, global, group)
                : mcor_enqueue_part(context, kernel, 0, global, group);
}

mcor_status mcor_finish(mcor_context* context)
{
  MCOR_CL_COMMAND(context, MCOR_COMMAND_WAIT, "", 0, clFinish(context->cl.queue), "clFinish");
  /* All copies are done. `sent` is still needed where the host writes, see mcor_send. */
  for (mcor_locked* l = context->cl.locked; l < context->cl.locked + MCOR_LOCKED_LIMIT; ++l)
  {
    l->sent = l->of && l->written > 0 ? l->sent : 0;
  }
  return MCOR_OK;
}
