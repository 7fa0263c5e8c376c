/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Arrays in OpenCL buffers of the caller's. The host checks and measures particles, so it reads
 * these buffers, by queues in their own contexts. */

#include "mcor_cl_memory.h"
#include "mcor_cl_call.h"
#include "mcor_input.h"

static size_t mcor_size_of(mcor_type type)
{
  return type == MCOR_FLOAT64 ? sizeof(double) : sizeof(float);
}

/* Reads the values of an array's buffer to `to`, or writes them from `from`; the other one is NULL.
 * What lies between values stays. */
static mcor_status mcor_transfer(
  mcor_context* context, const mcor_array* array, int64_t count, void* to, const void* from)
{
  const cl_mem memory = array->memory;
  const size_t width = mcor_size_of(array->type) * (size_t)mcor_components(array);
  const size_t stride = array->stride ? array->stride : width, first = array->offset;
  const size_t rest = (size_t)(count - 1), bytes = (size_t)count * width;
  const size_t at[3] = { first, 0, 0 }, none[3] = { 0 }, region[3] = { width, (size_t)count, 1 };
  cl_context own = NULL;
  size_t size = 0, found = 0;
  cl_device_id devices[64];
  cl_int error = clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof size, &size, NULL);
  MCOR_CL_TRY(context, error, "clGetMemObjectInfo");
  MCOR_FAIL_IF(stride < width || first > size || size - first < width ||
      (size - first - width) / stride < rest,
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(MEMORY_TOO_SMALL), mcor_array_name(array, "array"),
    (long long)count, width, first, stride, size);
  MCOR_CL_TRY(context, clGetMemObjectInfo(memory, CL_MEM_CONTEXT, sizeof own, &own, NULL),
    "clGetMemObjectInfo");
  MCOR_CL_TRY(context, clGetContextInfo(own, CL_CONTEXT_DEVICES, sizeof devices, devices, &found),
    "clGetContextInfo");
  const cl_command_queue queue = clCreateCommandQueue(own, devices[0], 0, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  if (stride == width)
  {
    error = to ? clEnqueueReadBuffer(queue, memory, CL_TRUE, first, bytes, to, 0, NULL, NULL)
               : clEnqueueWriteBuffer(queue, memory, CL_TRUE, first, bytes, from, 0, NULL, NULL);
  }
  else
  {
    error = to ? clEnqueueReadBufferRect(
                   queue, memory, CL_TRUE, at, none, region, stride, 0, width, 0, to, 0, NULL, NULL)
               : clEnqueueWriteBufferRect(queue, memory, CL_TRUE, at, none, region, stride, 0,
                   width, 0, from, 0, NULL, NULL);
  }
  clReleaseCommandQueue(queue);
  MCOR_CL_TRY(context, error, to ? "clEnqueueReadBuffer" : "clEnqueueWriteBuffer");
  return MCOR_OK;
}

static bool mcor_is_unseen(const mcor_array* array)
{
  return array->memory && !array->data;
}

#define MCOR_INPUT_ARRAYS 8 /* without attributes */

mcor_status mcor_see_input(mcor_context* context, const mcor_input* input, mcor_sight* sight)
{
  *sight = (mcor_sight){ .input = *input };
  mcor_input* own = &sight->input;
  own->positions = mcor_positions_of(input);
  mcor_array* const arrays[MCOR_INPUT_ARRAYS] = { &own->positions, &own->smoothing_length,
    &own->widening, &own->volume, &own->mass, &own->density, &own->scalar, &own->scalar_dot };
  const bool has_attributes = input->attributes && input->attribute_count > 0;
  const int attributes = has_attributes ? input->attribute_count : 0;
  const int most = MCOR_INPUT_ARRAYS + attributes;
  bool some = false;
  for (int i = 0; i < most; ++i)
  {
    some = some ||
      mcor_is_unseen(
        i < MCOR_INPUT_ARRAYS ? arrays[i] : input->attributes + (i - MCOR_INPUT_ARRAYS));
  }
  if (!some || input->count <= 0)
  {
    return MCOR_OK;
  }
  sight->copies = calloc((size_t)most, sizeof *sight->copies);
  sight->attributes = calloc((size_t)attributes + 1, sizeof *sight->attributes);
  MCOR_TRY(mcor_allocated(context, sight->copies && sight->attributes));
  for (int i = 0; i < attributes; ++i)
  {
    sight->attributes[i] = input->attributes[i];
  }
  own->attributes = sight->attributes;
  for (int i = 0; i < most; ++i)
  {
    mcor_array* array =
      i < MCOR_INPUT_ARRAYS ? arrays[i] : sight->attributes + (i - MCOR_INPUT_ARRAYS);
    if (mcor_is_unseen(array))
    {
      const size_t values = (size_t)input->count * (size_t)mcor_components(array);
      void* copy = sight->copies[sight->count++] = malloc(values * mcor_size_of(array->type));
      MCOR_TRY(mcor_allocated(context, copy != NULL));
      mcor_use_large_pages(copy, values * mcor_size_of(array->type));
      MCOR_TRY(mcor_transfer(context, array, input->count, copy, NULL));
      array->data = copy;
    }
  }
  return MCOR_OK;
}

void mcor_end_sight(mcor_sight* sight)
{
  for (int i = 0; i < sight->count; ++i)
  {
    free(sight->copies[i]);
  }
  free(sight->copies);
  free(sight->attributes);
  *sight = (mcor_sight){ .count = 0 };
}

/* Returns values in the type of an array; *made: memory to free, or NULL. */
static const void* mcor_convert(const mcor_array* from, mcor_type type, int64_t values, void** made)
{
  *made = from->type == type ? NULL : malloc((size_t)values * mcor_size_of(type));
  for (int64_t i = 0; *made && i < values; ++i)
  {
    if (type == MCOR_FLOAT64)
    {
      ((double*)*made)[i] = (double)((const float*)from->data)[i];
    }
    else
    {
      ((float*)*made)[i] = (float)((const double*)from->data)[i];
    }
  }
  return from->type == type ? from->data : *made;
}

mcor_status mcor_store(
  mcor_context* context, const mcor_array* from, int64_t count, const mcor_array* to)
{
  if (!context)
  {
    return MCOR_INVALID_ARGUMENT;
  }
  MCOR_FAIL_IF(!from || !to || count < 0 || (count > 0 && (!from->data || !to->memory)), context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER), "from->data and to->memory");
  const int components = mcor_components(from);
  MCOR_FAIL_IF(components != mcor_components(to), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(MEMORY_COMPONENTS), components, to->components);
  if (count == 0)
  {
    return MCOR_OK;
  }
  void* made;
  const void* values = mcor_convert(from, to->type, count * components, &made);
  mcor_status status = mcor_allocated(context, values != NULL);
  MCOR_THEN(status, mcor_transfer(context, to, count, NULL, values));
  free(made);
  return status;
}
