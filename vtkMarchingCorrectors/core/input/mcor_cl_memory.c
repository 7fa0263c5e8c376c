/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Arrays in OpenCL buffers of the caller. The host checks and measures particles, so it maps the
 * buffers by queues in the buffers' own contexts. It copies an array if other bytes lie between the
 * values, or if the array does not begin at a multiple of its numbers' size. */

#include "mcor_cl_memory.h"
#include "mcor_cl_call.h"
#include "mcor_input.h"

/* A buffer of the caller, and where an array's values lie in it. A row has one particle's values
 * or, if no other bytes lie between particles, all values. Sizes and places are in bytes. */
typedef struct mcor_memory
{
  cl_command_queue queue; /* in the buffer's own context */
  cl_mem buffer;
  size_t first[3], rows[3]; /* first: place, 0, 0. rows: size of a row, number of rows, 1 */
  size_t stride;            /* from one row to the next */
  bool can_map;             /* the host can use the values where they are */
  bool is_mapped;           /* false: `values` are a copy */
  void* values;             /* what the host sees */
} mcor_memory;

static size_t mcor_size_of(mcor_type type)
{
  return type == MCOR_FLOAT64 ? sizeof(double) : sizeof(float);
}

/* Fails unless the array lies within its buffer. Makes memory->queue. */
static mcor_status mcor_reach_memory(
  mcor_context* context, const mcor_array* array, int64_t count, mcor_memory* memory)
{
  const size_t number = mcor_size_of(array->type), first = array->offset;
  const size_t width = number * (size_t)mcor_components(array);
  const size_t stride = array->stride ? array->stride : width, rest = (size_t)(count - 1);
  cl_context own = NULL;
  size_t size = 0, found = 0;
  cl_device_id devices[64];
  const bool is_one_row = stride == width;
  *memory = (mcor_memory){ .buffer = array->memory,
    .first = { first },
    .rows = { is_one_row ? width * (size_t)count : width, is_one_row ? 1 : (size_t)count, 1 },
    .stride = is_one_row ? 0 : stride,
    .can_map = is_one_row && first % number == 0 };
  cl_int error = clGetMemObjectInfo(memory->buffer, CL_MEM_SIZE, sizeof size, &size, NULL);
  MCOR_CL_TRY(context, error, "clGetMemObjectInfo");
  MCOR_FAIL_IF(stride < width || first > size || size - first < width ||
      (size - first - width) / stride < rest,
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(MEMORY_TOO_SMALL), mcor_array_name(array, "array"),
    (long long)count, width, first, stride, size);
  MCOR_CL_TRY(context, clGetMemObjectInfo(memory->buffer, CL_MEM_CONTEXT, sizeof own, &own, NULL),
    "clGetMemObjectInfo");
  MCOR_CL_TRY(context, clGetContextInfo(own, CL_CONTEXT_DEVICES, sizeof devices, devices, &found),
    "clGetContextInfo");
  memory->queue = clCreateCommandQueue(own, devices[0], 0, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  return MCOR_OK;
}

static mcor_status mcor_see(
  mcor_context* context, mcor_array* array, int64_t count, mcor_memory* seen)
{
  MCOR_TRY(mcor_reach_memory(context, array, count, seen));
  const size_t* rows = seen->rows;
  const size_t bytes = rows[0] * rows[1], none[3] = { 0 };
  cl_int error = CL_SUCCESS;
  if (seen->can_map)
  {
    seen->values = clEnqueueMapBuffer(seen->queue, seen->buffer, CL_TRUE, CL_MAP_READ,
      seen->first[0], bytes, 0, NULL, NULL, &error);
    seen->is_mapped = error == CL_SUCCESS;
  }
  else
  {
    seen->values = malloc(bytes);
    MCOR_TRY(mcor_allocated(context, seen->values != NULL));
    error = clEnqueueReadBufferRect(seen->queue, seen->buffer, CL_TRUE, seen->first, none, rows,
      seen->stride, 0, rows[0], 0, seen->values, 0, NULL, NULL);
  }
  MCOR_CL_TRY(context, error, seen->can_map ? "clEnqueueMapBuffer" : "clEnqueueReadBufferRect");
  array->data = seen->values;
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
    const mcor_memory* seen = sight->seen + i;
    if (seen->is_mapped)
    {
      clEnqueueUnmapMemObject(seen->queue, seen->buffer, seen->values, 0, NULL, NULL);
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
  MCOR_FAIL_IF(!context || !from || !to || count < 0 || (count > 0 && (!from->data || !to->memory)),
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(NULL_POINTER), "from->data and to->memory");
  const int components = mcor_components(from);
  MCOR_FAIL_IF(components != mcor_components(to), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(MEMORY_COMPONENTS), components, to->components);
  if (count == 0)
  {
    return MCOR_OK;
  }
  mcor_memory memory;
  MCOR_TRY(mcor_reach_memory(context, to, count, &memory));
  void* made;
  const void* values = mcor_convert(from, to->type, count * components, &made);
  const size_t none[3] = { 0 };
  mcor_status status = mcor_allocated(context, values != NULL);
  if (status == MCOR_OK)
  {
    /* A rectangle may be slower than a plain write, or may have a limit of its own. */
    const cl_int error = memory.rows[1] == 1
      ? clEnqueueWriteBuffer(memory.queue, memory.buffer, CL_TRUE, memory.first[0], memory.rows[0],
          values, 0, NULL, NULL)
      : clEnqueueWriteBufferRect(memory.queue, memory.buffer, CL_TRUE, memory.first, none,
          memory.rows, memory.stride, 0, memory.rows[0], 0, values, 0, NULL, NULL);
    status = error == CL_SUCCESS ? MCOR_OK : mcor_cl_fail(context, error, "clEnqueueWriteBuffer");
  }
  free(made);
  clReleaseCommandQueue(memory.queue);
  return status;
}
