/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Arrays in OpenCL buffers of the caller's. The host checks and measures particles, so it maps these
 * buffers, by queues in their own contexts. */

#include "mcor_cl_memory.h"
#include "mcor_cl_call.h"
#include "mcor_input.h"

#include <stdint.h>

/* A buffer of the caller's that the host sees. */
typedef struct mcor_seen
{
  cl_mem memory;
  cl_command_queue queue;
  void* mapped;
  char* packed; /* values without what lies between them; NULL: they have nothing between them */
} mcor_seen;

static size_t mcor_size_of(mcor_type type)
{
  return type == MCOR_FLOAT64 ? sizeof(double) : sizeof(float);
}

static size_t mcor_components_of(const mcor_array* array)
{
  return array->components > 1 ? (size_t)array->components : 1;
}

/* Returns the bytes of one particle's values. */
static size_t mcor_width_of(const mcor_array* array)
{
  return mcor_size_of(array->type) * mcor_components_of(array);
}

/* Returns the bytes from one particle's values to the next one's. */
static size_t mcor_stride_of(const mcor_array* array)
{
  return array->stride ? array->stride : mcor_width_of(array);
}

/* Makes a queue in a buffer's own context, and finds the bytes that the array takes there. */
static mcor_status mcor_reach_memory(mcor_context* context, const mcor_array* array, int64_t count,
  cl_command_queue* queue, size_t* bytes)
{
  const cl_mem memory = array->memory;
  const size_t width = mcor_width_of(array), stride = mcor_stride_of(array);
  const size_t rest = (size_t)(count - 1);
  const char* name = array->name ? array->name : "array";
  cl_context own = NULL;
  size_t size = 0, found = 0;
  cl_device_id devices[64];
  cl_int error = clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof size, &size, NULL);
  MCOR_CL_TRY(context, error, "clGetMemObjectInfo");
  MCOR_FAIL_IF(stride < width || array->offset > size || size - array->offset < width ||
      (size - array->offset - width) / stride < rest,
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(MEMORY_TOO_SMALL), name, (long long)count, width,
    array->offset, stride, size);
  *bytes = rest * stride + width;
  MCOR_CL_TRY(context, clGetMemObjectInfo(memory, CL_MEM_CONTEXT, sizeof own, &own, NULL),
    "clGetMemObjectInfo");
  MCOR_CL_TRY(context, clGetContextInfo(own, CL_CONTEXT_DEVICES, sizeof devices, devices, &found),
    "clGetContextInfo");
  *queue = clCreateCommandQueue(own, devices[0], 0, &error);
  MCOR_CL_TRY(context, error, "clCreateCommandQueue");
  return MCOR_OK;
}

/* Copies rows of `width` bytes that begin every `stride` bytes. */
static void mcor_pack_rows(char* to, const char* from, size_t stride, size_t width, int64_t count)
{
  for (int64_t i = 0; i < count; ++i)
  {
    memcpy(to + (size_t)i * width, from + (size_t)i * stride, width);
  }
}

static mcor_status mcor_see(
  mcor_context* context, mcor_array* array, int64_t count, mcor_seen* seen)
{
  const size_t width = mcor_width_of(array), stride = mcor_stride_of(array);
  size_t bytes;
  MCOR_TRY(mcor_reach_memory(context, array, count, &seen->queue, &bytes));
  cl_int error;
  seen->memory = array->memory;
  seen->mapped = clEnqueueMapBuffer(
    seen->queue, seen->memory, CL_TRUE, CL_MAP_READ, array->offset, bytes, 0, NULL, NULL, &error);
  MCOR_CL_TRY(context, error, "clEnqueueMapBuffer");
  array->data = seen->mapped;
  if (stride != width || (uintptr_t)seen->mapped % mcor_size_of(array->type) != 0)
  {
    seen->packed = malloc((size_t)count * width);
    MCOR_TRY(mcor_allocated(context, seen->packed != NULL));
    mcor_pack_rows(seen->packed, seen->mapped, stride, width, count);
    array->data = seen->packed;
  }
  return MCOR_OK;
}

/* The arrays of an input, without its attributes. */
#define MCOR_INPUT_ARRAYS 8
static void mcor_list_arrays(mcor_input* input, mcor_array* arrays[MCOR_INPUT_ARRAYS])
{
  mcor_array* all[MCOR_INPUT_ARRAYS] = { &input->positions, &input->smoothing_length,
    &input->widening, &input->volume, &input->mass, &input->density, &input->scalar,
    &input->scalar_dot };
  memcpy(arrays, all, sizeof all);
}

static bool mcor_is_unseen(const mcor_array* array)
{
  return array->memory && !array->data;
}

mcor_status mcor_see_input(mcor_context* context, const mcor_input* input, mcor_sight* sight)
{
  *sight = (mcor_sight){ .input = *input };
  sight->input.positions = mcor_positions_of(input);
  const bool has_attributes = input->count > 0 && input->attributes && input->attribute_count > 0;
  const int attributes = has_attributes ? input->attribute_count : 0;
  mcor_array* arrays[MCOR_INPUT_ARRAYS];
  mcor_list_arrays(&sight->input, arrays);
  bool some = false;
  for (int i = 0; i < MCOR_INPUT_ARRAYS; ++i)
  {
    some = some || mcor_is_unseen(arrays[i]);
  }
  for (int i = 0; i < attributes; ++i)
  {
    some = some || mcor_is_unseen(input->attributes + i);
  }
  if (!some || input->count <= 0)
  {
    return MCOR_OK;
  }
  const size_t most = MCOR_INPUT_ARRAYS + (size_t)attributes;
  sight->seen = calloc(most, sizeof *sight->seen);
  sight->attributes = calloc((size_t)attributes + 1, sizeof *sight->attributes);
  MCOR_TRY(mcor_allocated(context, sight->seen && sight->attributes));
  for (size_t i = 0; i < most; ++i)
  {
    mcor_array* array =
      i < MCOR_INPUT_ARRAYS ? arrays[i] : sight->attributes + (i - MCOR_INPUT_ARRAYS);
    if (i >= MCOR_INPUT_ARRAYS)
    {
      *array = input->attributes[i - MCOR_INPUT_ARRAYS];
    }
    if (mcor_is_unseen(array))
    {
      MCOR_TRY(mcor_see(context, array, input->count, &sight->seen[sight->count++]));
    }
  }
  sight->input.attributes = sight->attributes;
  return MCOR_OK;
}

void mcor_end_sight(mcor_sight* sight)
{
  for (int i = 0; i < sight->count; ++i)
  {
    const mcor_seen* seen = sight->seen + i;
    if (seen->mapped)
    {
      clEnqueueUnmapMemObject(seen->queue, seen->memory, seen->mapped, 0, NULL, NULL);
      clFinish(seen->queue);
    }
    if (seen->queue)
    {
      clReleaseCommandQueue(seen->queue);
    }
    free(seen->packed);
  }
  free(sight->seen);
  free(sight->attributes);
  *sight = (mcor_sight){ .count = 0 };
}

/* Returns values in the type of an array; *made: memory to free, or NULL. */
static const void* mcor_convert(const mcor_array* from, mcor_type type, int64_t values, void** made)
{
  *made = NULL;
  if (from->type == type)
  {
    return from->data;
  }
  *made = malloc((size_t)values * mcor_size_of(type));
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
  return *made;
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
  const size_t components = mcor_components_of(from);
  MCOR_FAIL_IF(components != mcor_components_of(to), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(MEMORY_COMPONENTS), (int)components, to->components);
  if (count == 0)
  {
    return MCOR_OK;
  }
  cl_command_queue queue = NULL;
  size_t bytes;
  MCOR_TRY(mcor_reach_memory(context, to, count, &queue, &bytes));
  void* made;
  const void* values = mcor_convert(from, to->type, count * (int64_t)components, &made);
  const size_t width = mcor_width_of(to), stride = mcor_stride_of(to);
  const size_t at[3] = { to->offset, 0, 0 }, none[3] = { 0 },
               region[3] = { width, (size_t)count, 1 };
  mcor_status status = mcor_allocated(context, values != NULL);
  if (status == MCOR_OK)
  {
    const cl_int error = stride == width
      ? clEnqueueWriteBuffer(queue, to->memory, CL_TRUE, to->offset, bytes, values, 0, NULL, NULL)
      : clEnqueueWriteBufferRect(
          queue, to->memory, CL_TRUE, at, none, region, stride, 0, width, 0, values, 0, NULL, NULL);
    status = error == CL_SUCCESS ? MCOR_OK : mcor_cl_fail(context, error, "clEnqueueWriteBuffer");
  }
  free(made);
  clReleaseCommandQueue(queue);
  return status;
}
