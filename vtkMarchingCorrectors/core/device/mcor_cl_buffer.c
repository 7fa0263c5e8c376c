/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Buffers of the device. */

#include "mcor_cl_call.h"

#include <math.h>

static void mcor_free_buffer(mcor_cl* cl, const mcor_buffer* buffer)
{
  clReleaseMemObject(buffer->mem);
  cl->bytes -= (int64_t)buffer->size;
}

void mcor_release(mcor_context* context, mcor_buffer* buffer)
{
  mcor_cl* cl = &context->cl;
  if (buffer->size >= MCOR_LARGE_ARRAY && cl->kept_count < MCOR_KEPT_BUFFERS)
  {
    cl->kept[cl->kept_count++] = *buffer;
    cl->kept_bytes += (int64_t)buffer->size;
  }
  else if (buffer->mem)
  {
    mcor_free_buffer(cl, buffer);
  }
  *buffer = (mcor_buffer){ 0 };
}

/* Takes buffer i out of the list of kept buffers. */
static mcor_buffer mcor_take_out(mcor_cl* cl, int i)
{
  const mcor_buffer buffer = cl->kept[i];
  cl->kept[i] = cl->kept[--cl->kept_count];
  cl->kept_bytes -= (int64_t)buffer.size;
  return buffer;
}

static void mcor_free_locked(mcor_cl* cl, mcor_locked* locked)
{
  if (locked->host)
  {
    clEnqueueUnmapMemObject(cl->queue, locked->mem, locked->host, 0, NULL, NULL);
  }
  if (locked->mem)
  {
    clReleaseMemObject(locked->mem);
  }
  *locked = (mcor_locked){ 0 };
}

void mcor_drop_kept(mcor_context* context, int64_t most)
{
  mcor_cl* cl = &context->cl;
  while (cl->kept_count > 0 && cl->bytes > most)
  {
    const mcor_buffer last = mcor_take_out(cl, cl->kept_count - 1);
    mcor_free_buffer(cl, &last);
  }
}

void mcor_drop_locked(mcor_context* context)
{
  mcor_cl* cl = &context->cl;
  for (int i = 0; i < MCOR_LOCKED_LIMIT; ++i)
  {
    if (!cl->locked[i].of)
    {
      mcor_free_locked(cl, &cl->locked[i]);
    }
  }
}

/* Returns how many bytes may be held, kept buffers included: an eighth more than this call or the
 * last one has needed, whichever needed more, but no more than the memory limit. */
static int64_t mcor_most_held(const mcor_cl* cl)
{
  const int64_t used = cl->used_peak > cl->used_before ? cl->used_peak : cl->used_before;
  const int64_t limit = (int64_t)cl->memory_limit;
  return used / 8 * 9 < limit ? used / 8 * 9 : limit;
}

void mcor_begin_buffers(mcor_context* context)
{
  mcor_cl* cl = &context->cl;
  cl->used_before = cl->used_peak;
  cl->used_peak = cl->bytes - cl->kept_bytes;
  mcor_drop_kept(context, mcor_most_held(cl));
  cl->bytes_peak = cl->bytes;
}

void mcor_release_all(mcor_context* context, mcor_buffer* const buffers[], size_t count)
{
  for (size_t i = 0; i < count; ++i)
  {
    mcor_release(context, buffers[i]);
  }
}

void mcor_release_each(mcor_context* context, mcor_buffer* buffers, size_t count)
{
  for (size_t i = 0; i < count; ++i)
  {
    mcor_release(context, buffers + i);
  }
}

static mcor_status mcor_enlarge(mcor_context* context, mcor_buffer* buffer, size_t bytes)
{
  mcor_cl* cl = &context->cl;
  const size_t size = (bytes + 255) / 256 * 256 + 256; /* a buffer is never empty */
  mcor_release(context, buffer);
  /* Takes the smallest kept buffer with enough room, of which at most an eighth stays unused. */
  int best = -1;
  for (int i = 0; i < cl->kept_count; ++i)
  {
    const size_t kept = cl->kept[i].size;
    if (kept >= bytes && kept - kept / 8 <= bytes && (best < 0 || kept < cl->kept[best].size))
    {
      best = i;
    }
  }
  if (best >= 0)
  {
    *buffer = mcor_take_out(cl, best);
    return MCOR_OK;
  }
  mcor_drop_kept(context, mcor_most_held(cl) - (int64_t)size);
  MCOR_FAIL_IF(size > cl->largest_buffer || (uint64_t)cl->bytes + size > cl->memory_limit, context,
    MCOR_OUT_OF_CAPACITY, MCOR_SAY(DEVICE_MEMORY_LIMIT), ldexp((double)size, -20),
    ldexp((double)cl->bytes, -20), ldexp((double)cl->memory_limit, -20), cl->device_name,
    ldexp((double)cl->largest_buffer, -20));
  cl_int error;
  buffer->mem = clCreateBuffer(cl->context, CL_MEM_READ_WRITE, size, NULL, &error);
  if (error != CL_SUCCESS)
  {
    buffer->mem = NULL;
    return mcor_fail(context,
      mcor_is_no_memory(error) || error == CL_INVALID_BUFFER_SIZE ? MCOR_OUT_OF_CAPACITY
                                                                  : MCOR_DEVICE_ERROR,
      MCOR_SAY(DEVICE_ALLOCATION), cl->device_name, (double)size / 1e6, mcor_cl_error_name(error));
  }
  buffer->size = size;
  cl->bytes += (int64_t)size;
  cl->bytes_peak = cl->bytes > cl->bytes_peak ? cl->bytes : cl->bytes_peak;
  if (cl->is_cpu && size >= MCOR_LARGE_ARRAY) /* here buffers are memory of the host */
  {
    void* memory;
    MCOR_TRY(mcor_map(context, buffer, size, true, &memory));
    mcor_use_large_pages(memory, size);
    MCOR_TRY(mcor_unmap(context, buffer, &memory));
  }
  return MCOR_OK;
}

mcor_status mcor_reserve(mcor_context* context, mcor_buffer* buffer, size_t bytes)
{
  mcor_cl* cl = &context->cl;
  const mcor_status status =
    buffer->mem && buffer->size >= bytes ? MCOR_OK : mcor_enlarge(context, buffer, bytes);
  const int64_t used = cl->bytes - cl->kept_bytes;
  cl->used_peak = used > cl->used_peak ? used : cl->used_peak;
  return status;
}

static mcor_status mcor_enqueue_read(mcor_context* context, const mcor_buffer* buffer,
  size_t offset, void* data, size_t bytes, bool waits)
{
  if (bytes > 0)
  {
    MCOR_CL_COMMAND(context, MCOR_COMMAND_READ, "", bytes,
      clEnqueueReadBuffer(
        context->cl.queue, buffer->mem, waits, offset, bytes, data, 0, NULL, MCOR_EVENT),
      "clEnqueueReadBuffer");
  }
  return MCOR_OK;
}

mcor_status mcor_read(
  mcor_context* context, const mcor_buffer* buffer, size_t offset, void* data, size_t bytes)
{
  return mcor_enqueue_read(context, buffer, offset, data, bytes, true);
}

/* Takes the smallest unused locked memory with enough room; if none is large enough, enlarges the
 * largest. A driver locks pages when a buffer is mapped for the first time, which takes 25 times as
 * long as the copy (H100: 0.57 and 0.02 ms for each MiB). Memory that is kept here stays locked. */
static mcor_status mcor_take_locked(mcor_context* context, size_t bytes, mcor_locked** taken)
{
  mcor_cl* cl = &context->cl;
  mcor_locked* best = NULL;
  for (mcor_locked* l = cl->locked; l < cl->locked + MCOR_LOCKED_LIMIT; ++l)
  {
    const bool is_better = !best ||
      (best->size < bytes ? l->size > best->size : l->size >= bytes && l->size < best->size);
    best = !l->of && is_better ? l : best;
  }
  MCOR_FAIL_IF(!best, context, MCOR_DEVICE_ERROR, MCOR_SAY(BUFFERS_MAPPED), MCOR_LOCKED_LIMIT);
  if (best->sent > 0) /* the driver may still copy what the memory held before */
  {
    MCOR_TRY(mcor_finish(context));
  }
  if (best->size < bytes)
  {
    const size_t more = bytes + bytes / 8, size = more < cl->largest_buffer ? more : bytes;
    cl_int error;
    mcor_free_locked(cl, best);
    best->mem = clCreateBuffer(cl->context, CL_MEM_ALLOC_HOST_PTR, size, NULL, &error);
    MCOR_CL_TRY(context, error, "clCreateBuffer");
    MCOR_CL_COMMAND(context, MCOR_COMMAND_LOCK, "", size,
      (best->host = clEnqueueMapBuffer(cl->queue, best->mem, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0,
         size, 0, NULL, MCOR_EVENT, &error),
        error),
      "clEnqueueMapBuffer");
    best->size = size;
  }
  *taken = best;
  return MCOR_OK;
}

/* waits: the host may read the buffer when this function returns; else only after mcor_finish. */
static mcor_status mcor_map_view(mcor_context* context, const mcor_buffer* buffer, size_t bytes,
  bool write, bool waits, void** data)
{
  mcor_cl* cl = &context->cl;
  const size_t some = bytes > 0 ? bytes : 1;
  *data = NULL;
  if (!buffer->mem && bytes == 0) /* an empty surface may have no such array */
  {
    return MCOR_OK;
  }
  if (cl->is_apart)
  {
    mcor_locked* locked = NULL;
    MCOR_TRY(mcor_take_locked(context, some, &locked));
    locked->written = write ? bytes : 0;
    locked->sent = write || waits ? 0 : bytes;
    if (!write)
    {
      MCOR_TRY(mcor_enqueue_read(context, buffer, 0, locked->host, bytes, waits));
    }
    locked->of = buffer->mem;
    *data = locked->host;
    return MCOR_OK;
  }
  cl_int error;
  void* mapped = NULL;
  MCOR_CL_COMMAND(context, MCOR_COMMAND_MAP, "", bytes,
    (mapped = clEnqueueMapBuffer(cl->queue, buffer->mem, waits,
       write ? CL_MAP_WRITE_INVALIDATE_REGION : CL_MAP_READ, 0, some, 0, NULL, MCOR_EVENT, &error),
      error),
    "clEnqueueMapBuffer");
  *data = mapped;
  return MCOR_OK;
}

mcor_status mcor_map(
  mcor_context* context, const mcor_buffer* buffer, size_t bytes, bool write, void** data)
{
  return mcor_map_view(context, buffer, bytes, write, true, data);
}

/* Returns the locked memory at a mapped address; NULL: there is none. */
static mcor_locked* mcor_find_locked(mcor_cl* cl, const void* mapped)
{
  mcor_locked* l = cl->locked;
  while (l < cl->locked + MCOR_LOCKED_LIMIT && !(l->of && l->host == mapped))
  {
    ++l;
  }
  return l < cl->locked + MCOR_LOCKED_LIMIT ? l : NULL;
}

mcor_status mcor_send(mcor_context* context, const void* data, size_t bytes)
{
  mcor_locked* l = mcor_find_locked(&context->cl, data);
  if (l && bytes > l->sent)
  {
    const size_t begin = l->sent, more = bytes - begin;
    l->sent = bytes;
    MCOR_CL_COMMAND(context, MCOR_COMMAND_WRITE, "", more,
      clEnqueueWriteBuffer(context->cl.queue, l->of, CL_FALSE, begin, more,
        (const char*)data + begin, 0, NULL, MCOR_EVENT),
      "clEnqueueWriteBuffer");
    MCOR_CL_TRY(context, clFlush(context->cl.queue), "clFlush");
  }
  return MCOR_OK;
}

mcor_status mcor_unmap(mcor_context* context, const mcor_buffer* buffer, void** data)
{
  mcor_cl* cl = &context->cl;
  void* const mapped = *data;
  mcor_locked* locked = mcor_find_locked(cl, mapped);
  *data = NULL;
  if (locked)
  {
    const mcor_status status = mcor_send(context, mapped, locked->written);
    locked->of = NULL;
    return status;
  }
  if (mapped)
  {
    MCOR_CL_TRY(context, clEnqueueUnmapMemObject(cl->queue, buffer->mem, mapped, 0, NULL, NULL),
      "clEnqueueUnmapMemObject");
  }
  return MCOR_OK;
}

static mcor_status mcor_map_views(
  mcor_context* context, const mcor_mapping* mappings, int count, bool waits)
{
  for (int i = 0; i < count; ++i)
  {
    const mcor_mapping* m = mappings + i;
    MCOR_TRY(mcor_map_view(context, m->buffer, m->bytes, false, waits, m->data));
  }
  return MCOR_OK;
}

mcor_status mcor_map_all(mcor_context* context, const mcor_mapping* mappings, int count)
{
  return mcor_map_views(context, mappings, count, true);
}

mcor_status mcor_begin_mapping(mcor_context* context, const mcor_mapping* mappings, int count)
{
  return mcor_map_views(context, mappings, count, false);
}

mcor_status mcor_unmap_all(
  mcor_context* context, const mcor_mapping* mappings, int count, mcor_status status)
{
  for (int i = 0; i < count; ++i)
  {
    const mcor_status unmapped = mcor_unmap(context, mappings[i].buffer, mappings[i].data);
    MCOR_THEN(status, unmapped);
  }
  return status;
}

/* Returns how many of `bytes` to fill or copy before the next report: 32 MiB (10 ms) at most. */
static size_t mcor_step_of(size_t bytes)
{
  const size_t most = (size_t)1 << 25;
  return bytes < most ? bytes : most;
}

mcor_status mcor_fill(mcor_context* context, mcor_buffer* buffer, uint8_t byte, size_t bytes)
{
  return mcor_fill_range(context, buffer, byte, 0, bytes);
}

static mcor_status mcor_fill_bytes(mcor_context* context, mcor_buffer* buffer,
  const void* pattern, size_t width, size_t first, size_t last)
{
  MCOR_TRY(mcor_reserve(context, buffer, last));
  for (size_t at = first, bytes; at < last; at += bytes)
  {
    bytes = mcor_step_of(last - at);
    MCOR_CL_COMMAND(context, MCOR_COMMAND_COPY, "", bytes,
      clEnqueueFillBuffer(
        context->cl.queue, buffer->mem, pattern, width, at, bytes, 0, NULL, MCOR_EVENT),
      "clEnqueueFillBuffer");
    MCOR_TRY(mcor_ask(context, false));
  }
  return MCOR_OK;
}

mcor_status mcor_fill_range(
  mcor_context* context, mcor_buffer* buffer, uint8_t byte, size_t first, size_t last)
{
  return mcor_fill_bytes(context, buffer, &byte, sizeof byte, first, last);
}

mcor_status mcor_fill_reals(mcor_context* context, mcor_buffer* buffer, double value, size_t count)
{
  const size_t width = context->cl.real_size;
  double pattern;
  mcor_put_real(context, &pattern, 0, value);
  return mcor_fill_bytes(context, buffer, &pattern, width, 0, count * width);
}

mcor_status mcor_copy(
  mcor_context* context, const mcor_buffer* from, mcor_buffer* to, size_t to_offset, size_t bytes)
{
  for (size_t at = 0, step; at < bytes; at += step)
  {
    step = mcor_step_of(bytes - at);
    MCOR_CL_COMMAND(context, MCOR_COMMAND_COPY, "", step,
      clEnqueueCopyBuffer(
        context->cl.queue, from->mem, to->mem, at, to_offset + at, step, 0, NULL, MCOR_EVENT),
      "clEnqueueCopyBuffer");
    MCOR_TRY(mcor_ask(context, false));
  }
  return MCOR_OK;
}

void mcor_take_buffer(mcor_context* context, mcor_buffer* from, mcor_buffer* to)
{
  mcor_release(context, to);
  *to = *from;
  *from = (mcor_buffer){ 0 };
}

mcor_status mcor_extend(mcor_context* context, mcor_buffer* buffer, size_t old, size_t bytes)
{
  if (buffer->size >= bytes || old == 0)
  {
    return mcor_reserve(context, buffer, bytes);
  }
  mcor_buffer bigger = { 0 };
  mcor_status status = mcor_reserve(context, &bigger, bytes);
  MCOR_THEN(status, mcor_copy(context, buffer, &bigger, 0, old));
  mcor_release(context, status == MCOR_OK ? buffer : &bigger);
  if (status == MCOR_OK)
  {
    *buffer = bigger;
  }
  return status;
}

mcor_status mcor_append_bytes(
  mcor_context* context, mcor_buffer* buffer, size_t old, const void* data, size_t bytes)
{
  MCOR_TRY(mcor_extend(context, buffer, old, old + bytes));
  if (bytes > 0)
  {
    MCOR_CL_COMMAND(context, MCOR_COMMAND_WRITE, "", bytes,
      clEnqueueWriteBuffer(
        context->cl.queue, buffer->mem, CL_TRUE, old, bytes, data, 0, NULL, MCOR_EVENT),
      "clEnqueueWriteBuffer");
  }
  return MCOR_OK;
}

mcor_status mcor_write(mcor_context* context, mcor_buffer* buffer, const void* data, size_t bytes)
{
  return mcor_append_bytes(context, buffer, 0, data, bytes);
}
