/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Arrays in OpenCL buffers of the caller. The host checks and measures particles, so it maps the
 * buffers by queues in the buffers' own contexts. It copies an array if other bytes lie between the
 * values, or if the array does not begin at a multiple of its numbers' size. */

#include "mcor_cl_memory.h"
#include "mcor_cl_call.h"
#include "mcor_input.h"

/* A buffer of the caller that the host sees. */
typedef struct mcor_seen
{
  cl_command_queue queue;
  cl_mem mapped; /* NULL: values are a copy */
  void* values;
} mcor_seen;

static size_t mcor_size_of(mcor_type type)
{
  return type == MCOR_FLOAT64 ? sizeof(double) : sizeof(float);
}

/* Returns the bytes of one particle's values. */
static size_t mcor_width_of(const mcor_array* array)
{
  return mcor_size_of(array->type) * (size_t)mcor_components(array);
}

/* Returns the bytes from one particle's values to the next one's. */
static size_t mcor_stride_of(const mcor_array* array)
{
  return array->stride ? array->stride : mcor_width_of(array);
}

/* Fails unless the array lies within its buffer. Makes a queue in the buffer's own context. */
static mcor_status mcor_reach_memory(
  mcor_context* context, const mcor_array* array, int64_t count, cl_command_queue* queue)
{
  const cl_mem memory = array->memory;
  const size_t width = mcor_width_of(array), stride = mcor_stride_of(array);
  const size_t first = array->offset, rest = (size_t)(count - 1);
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
  *queue = clCreateCommandQueue(own, devices[0], 0, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  return MCOR_OK;
}

static mcor_status mcor_see(
  mcor_context* context, mcor_array* array, int64_t count, mcor_seen* seen)
{
  const size_t width = mcor_width_of(array), stride = mcor_stride_of(array);
  const size_t at[3] = { array->offset, 0, 0 }, none[3] = { 0 }, bytes = (size_t)count * width;
  const size_t rows[3] = { width, (size_t)count, 1 };
  cl_int error;
  MCOR_TRY(mcor_reach_memory(context, array, count, &seen->queue));
  if (stride == width && array->offset % mcor_size_of(array->type) == 0)
  {
    array->data = seen->values = clEnqueueMapBuffer(
      seen->queue, array->memory, CL_TRUE, CL_MAP_READ, *at, bytes, 0, NULL, NULL, &error);
    MCOR_CL_TRY(context, error, "clEnqueueMapBuffer");
    seen->mapped = array->memory;
    return MCOR_OK;
  }
  array->data = seen->values = malloc(bytes);
  MCOR_TRY(mcor_allocated(context, seen->values != NULL));
  error = clEnqueueReadBufferRect(seen->queue, array->memory, CL_TRUE, at, none, rows, stride, 0,
    width, 0, seen->values, 0, NULL, NULL);
  MCOR_CL_TRY(context, error, "clEnqueueReadBufferRect");
  return MCOR_OK;
}

mcor_status mcor_see_input(mcor_context* context, const mcor_input* input, mcor_sight* sight)
{
  *sight = (mcor_sight){ .input = *input };
  mcor_input* own = &sight->input;
  own->positions = mcor_positions_of(input);
  mcor_array* const arrays[] = { &own->positions, &own->smoothing_length, &own->widening,
    &own->volume, &own->mass, &own->density, &own->scalar, &own->scalar_dot };
  const int fixed = (int)(sizeof arrays / sizeof *arrays);
  const bool has_attributes = input->count > 0 && input->attributes && input->attribute_count > 0;
  const int attributes = has_attributes ? input->attribute_count : 0;
  sight->seen = calloc((size_t)(fixed + attributes), sizeof *sight->seen);
  sight->attributes = calloc((size_t)attributes + 1, sizeof *sight->attributes);
  MCOR_TRY(mcor_allocated(context, sight->seen && sight->attributes));
  for (int i = 0; i < attributes; ++i)
  {
    sight->attributes[i] = input->attributes[i];
    own->attributes = sight->attributes;
  }
  for (int i = 0; i < fixed + attributes && input->count > 0; ++i)
  {
    mcor_array* array = i < fixed ? arrays[i] : sight->attributes + (i - fixed);
    if (array->memory && !array->data)
    {
      MCOR_TRY(mcor_see(context, array, input->count, &sight->seen[sight->count++]));
    }
  }
  return MCOR_OK;
}

void mcor_end_sight(mcor_sight* sight)
{
  for (int i = 0; i < sight->count; ++i)
  {
    const mcor_seen* seen = sight->seen + i;
    if (seen->mapped)
    {
      clEnqueueUnmapMemObject(seen->queue, seen->mapped, seen->values, 0, NULL, NULL);
      clFinish(seen->queue);
    }
    else
    {
      free(seen->values);
    }
    if (seen->queue)
    {
      clReleaseCommandQueue(seen->queue);
    }
  }
  free(sight->seen);
  free(sight->attributes);
  *sight = (mcor_sight){ .count = 0 };
}

/* Returns an array's values, converted to `type`; NULL: memory ran out. *made: memory that the
 * caller frees, or NULL if the array's own values are returned. */
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
  cl_command_queue queue = NULL;
  MCOR_TRY(mcor_reach_memory(context, to, count, &queue));
  void* made;
  const void* values = mcor_convert(from, to->type, count * components, &made);
  const size_t width = mcor_width_of(to), stride = mcor_stride_of(to);
  const size_t at[3] = { to->offset, 0, 0 }, none[3] = { 0 }, bytes = (size_t)count * width;
  const size_t rows[3] = { width, (size_t)count, 1 };
  mcor_status status = mcor_allocated(context, values != NULL);
  if (status == MCOR_OK)
  {
    const cl_int error = stride == width
      ? clEnqueueWriteBuffer(queue, to->memory, CL_TRUE, *at, bytes, values, 0, NULL, NULL)
      : clEnqueueWriteBufferRect(
          queue, to->memory, CL_TRUE, at, none, rows, stride, 0, width, 0, values, 0, NULL, NULL);
    status = error == CL_SUCCESS ? MCOR_OK : mcor_cl_fail(context, error, "clEnqueueWriteBuffer");
  }
  free(made);
  clReleaseCommandQueue(queue);
  return status;
}
