/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* This library replaces CUDA's driver in tests without a card. It has the functions that the Python
 * package calls, with the host's memory in place of the device's. It counts copies and locked
 * blocks, and refuses what a driver refuses: calls without a context, copies to unlocked memory. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum
{
  BLOCKS = 64,
  INVALID_VALUE = 1,
  INVALID_CONTEXT = 201
};

int fake_copies, fake_locks, fake_synchronized, fake_of_pool, fake_fails;
size_t fake_bytes;
static int depth, device_context;
static struct
{
  char* memory;
  size_t size;
} locked[BLOCKS];

int cuInit(unsigned flags)
{
  return flags ? INVALID_VALUE : 0;
}

int cuGetErrorString(int error, const char** text)
{
  *text = error == INVALID_CONTEXT ? "invalid device context" : "invalid argument";
  return 0;
}

int cuPointerGetAttribute(void* value, int attribute, uint64_t address)
{
  if (!address || fake_fails)
  {
    return INVALID_VALUE;
  }
  if (attribute == 9)
  {
    *(int*)value = 0;
    return 0;
  }
  *(void**)value = fake_of_pool ? NULL : &device_context;
  return attribute == 1 ? 0 : INVALID_VALUE;
}

int cuDevicePrimaryCtxRetain(void** context, int device)
{
  *context = &device_context;
  return device == 0 ? 0 : INVALID_VALUE;
}

int cuCtxPushCurrent_v2(void* context)
{
  depth += context == &device_context;
  return context == &device_context ? 0 : INVALID_CONTEXT;
}

int cuCtxPopCurrent_v2(void** context)
{
  *context = &device_context;
  return depth-- > 0 ? 0 : INVALID_CONTEXT;
}

int cuMemHostAlloc(void** memory, size_t size, unsigned flags)
{
  int i = 0;
  while (i < BLOCKS && locked[i].memory)
  {
    ++i;
  }
  if (depth < 1 || i == BLOCKS || flags != 1)
  {
    return INVALID_CONTEXT;
  }
  *memory = locked[i].memory = malloc(size);
  locked[i].size = size;
  memset(*memory, 0xff, size);
  ++fake_locks;
  return 0;
}

int cuMemFreeHost(void* memory)
{
  for (int i = 0; i < BLOCKS; ++i)
  {
    if (locked[i].memory == memory)
    {
      free(memory);
      locked[i].memory = NULL;
      --fake_locks;
      return 0;
    }
  }
  return INVALID_VALUE;
}

int cuStreamSynchronize(void* stream)
{
  fake_synchronized = (int)(intptr_t)stream;
  return depth > 0 ? 0 : INVALID_CONTEXT;
}

int cuMemcpyDtoH_v2(void* to, uint64_t from, size_t size)
{
  for (int i = 0; depth > 0 && i < BLOCKS; ++i)
  {
    if (locked[i].memory == to && size <= locked[i].size)
    {
      memcpy(to, (const void*)(uintptr_t)from, size);
      ++fake_copies;
      fake_bytes += size;
      return 0;
    }
  }
  return INVALID_VALUE;
}
