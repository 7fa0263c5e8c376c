#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tells whether CUDA's memory can become an OpenCL buffer of the same card without a copy: CUDA exports memory as a file descriptor,
cl_khr_external_memory_opaque_fd imports it. If so, arrays of CuPy or PyTorch could reach the kernels by one copy on the card. The code that follows
find_device() has not run on a card yet. The script takes CUDA's first card. It needs both drivers, and Python without packages.

Status 0: yes; 1: no, the last line says why.
"""
import os
import sys
from ctypes import CDLL, Structure, byref, c_byte, c_int, c_size_t, c_uint, c_uint64, c_void_p, create_string_buffer

DEVICE_NAME, DEVICE_EXTENSIONS, ALL_TYPES, READ_WRITE, OPAQUE_FD = 0x102B, 0x1030, 0xFFFFFFFF, 1, 0x2060
ON_DEVICE, PINNED, DESCRIPTOR, READ_AND_WRITE = 1, 1, 1, 3


class Properties(Structure):
    """CUmemAllocationProp of cuda.h."""

    _fields_ = [("type", c_int), ("handle_types", c_int), ("place_type", c_int), ("place", c_int), ("win32", c_void_p), ("flags", c_byte * 8)]


class Access(Structure):
    """CUmemAccessDesc of cuda.h."""

    _fields_ = [("place_type", c_int), ("place", c_int), ("flags", c_int)]


def no(what):
    print("no:", what)
    sys.exit(1)


def load(name):
    try:
        return CDLL(name)
    except OSError:
        return no(f"{name} was not found")


def call(library, name, *arguments):
    error = getattr(library, name)(*arguments) if hasattr(library, name) else "missing"
    if error:
        no(f"{name} ({error})")


def make(opencl, name, *arguments):
    """Calls a function of OpenCL whose last argument gets the error code. Returns the object that it makes, or ends the script."""
    if not hasattr(opencl, name):
        no(f"{name} (missing)")
    error, function = c_int(), getattr(opencl, name)
    function.restype = c_void_p
    made = c_void_p(function(*arguments, byref(error)))
    return no(f"{name} ({error.value})") if error.value else made


def find_device(opencl):
    """Prints, for each device, whether it can import memory from file descriptors. Returns the first device that can, or None."""
    found, platforms, devices, count = None, (c_void_p * 16)(), (c_void_p * 16)(), c_uint()
    opencl.clGetPlatformIDs(16, platforms, byref(count))
    for platform in platforms[:count.value]:
        count.value = 0
        opencl.clGetDeviceIDs(c_void_p(platform), c_uint64(ALL_TYPES), 16, devices, byref(count))
        for device in devices[:count.value]:
            name, extensions = create_string_buffer(256), create_string_buffer(16384)
            for what, text in ((DEVICE_NAME, name), (DEVICE_EXTENSIONS, extensions)):
                opencl.clGetDeviceInfo(c_void_p(device), what, c_size_t(len(text)), text, None)
            imports = b"cl_khr_external_memory_opaque_fd" in extensions.value
            print(f"{name.value.decode()}: cl_khr_external_memory_opaque_fd {'yes' if imports else 'no'}")
            found = found or (c_void_p(device) if imports else None)
    return found


def export_memory(cuda, pattern):
    """Makes CUDA memory that begins with a pattern. Returns its size and a file descriptor of it."""
    context, step, memory, address, descriptor = c_void_p(), c_size_t(), c_uint64(), c_uint64(), c_int(-1)
    wanted, access = Properties(PINNED, DESCRIPTOR, ON_DEVICE, 0), Access(ON_DEVICE, 0, READ_AND_WRITE)
    call(cuda, "cuDevicePrimaryCtxRetain", byref(context), 0)
    call(cuda, "cuCtxSetCurrent", context)
    call(cuda, "cuMemGetAllocationGranularity", byref(step), byref(wanted), 0)
    size = c_size_t(-(-len(pattern) // step.value) * step.value)
    call(cuda, "cuMemCreate", byref(memory), size, byref(wanted), c_uint64(0))
    call(cuda, "cuMemAddressReserve", byref(address), size, c_size_t(0), c_uint64(0), c_uint64(0))
    call(cuda, "cuMemMap", address, size, c_size_t(0), memory, c_uint64(0))
    call(cuda, "cuMemSetAccess", address, size, byref(access), c_size_t(1))
    call(cuda, "cuMemcpyHtoD_v2", address, pattern, c_size_t(len(pattern)))
    call(cuda, "cuMemExportToShareableHandle", byref(descriptor), memory, DESCRIPTOR, c_uint64(0))
    return size, descriptor.value


def main():
    opencl = load("libOpenCL.so.1")
    device, cuda = find_device(opencl), load("libcuda.so.1")
    call(cuda, "cuInit", 0)
    if not device:
        no("no OpenCL device imports file descriptors")
    pattern = os.urandom(4096)
    size, descriptor = export_memory(cuda, pattern)
    context = make(opencl, "clCreateContext", None, 1, byref(device), None, None)
    queue = make(opencl, "clCreateCommandQueueWithProperties", context, device, None)
    properties = (c_uint64 * 3)(OPAQUE_FD, descriptor, 0)
    buffer = make(opencl, "clCreateBufferWithProperties", context, properties, c_uint64(READ_WRITE), size, None)
    seen = create_string_buffer(len(pattern))
    call(opencl, "clEnqueueReadBuffer", queue, buffer, 1, c_size_t(0), c_size_t(len(pattern)), seen, 0, None, None)
    if seen.raw != pattern:
        no("OpenCL does not see what CUDA wrote")
    print("yes: OpenCL sees what CUDA wrote, without a copy")


if __name__ == "__main__":
    main()
