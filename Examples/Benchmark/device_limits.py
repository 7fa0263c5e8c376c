# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The limits of an OpenCL device: bytes copied and floating-point operations per second.

Every figure is the best of several runs: a limit is not a typical value. The arrays that are copied should be well above
the caches.
"""
import ctypes
import time
from ctypes import byref, c_char_p, c_float, c_int, c_size_t, c_uint, c_ulong, c_void_p, sizeof

RUNS = 7
GROUP_ITEMS = 64  # PoCL, left to choose, may make one group, for one core, of them all
FMA_ITEMS, FMA_ROUNDS, FMA_CHAINS = 4096, 8192, 8

# WIDE: as many floats as a vector register of a CPU has at most, 1 on a GPU. Eight chains of FMAs that do not wait for
# each other hide the latency of the unit; the sum keeps them from being removed.
SOURCE = b"""
__kernel void copy(__global const float4* restrict a, __global float4* restrict b)
{ b[get_global_id(0)] = a[get_global_id(0)]; }
__kernel void multiply_add(const int rounds, const float f, __global WIDE* out)
{
  const WIDE m = (WIDE)f, c = (WIDE)(1 - f);
  WIDE x0 = get_global_id(0), x1 = x0 + 1, x2 = x0 + 2, x3 = x0 + 3;
  WIDE x4 = x0 + 4, x5 = x0 + 5, x6 = x0 + 6, x7 = x0 + 7;
  for (int i = 0; i < rounds; ++i)
  {
    x0 = fma(x0, m, c); x1 = fma(x1, m, c); x2 = fma(x2, m, c); x3 = fma(x3, m, c);
    x4 = fma(x4, m, c); x5 = fma(x5, m, c); x6 = fma(x6, m, c); x7 = fma(x7, m, c);
  }
  out[get_global_id(0)] = x0 + x1 + x2 + x3 + x4 + x5 + x6 + x7;
}
"""
PLATFORM_VERSION, PLATFORM_NAME = 0x0901, 0x0902
DEVICE_TYPE, DEVICE_UNITS, DEVICE_NAME, DRIVER_VERSION, DEVICE_PLATFORM = 0x1000, 0x1002, 0x102B, 0x102D, 0x1031
CPU, ANY_TYPE, READ_WRITE = 2, 0xFFFFFFFF, 1


class Device:
    """One device, by the names of it and its platform, with the program."""

    def __init__(self, name, platform_name):
        self.library = ctypes.CDLL("libOpenCL.so.1")
        self.handle = self.find(name, platform_name)
        kind = self.info("Device", self.handle, DEVICE_TYPE, c_ulong).value
        self.width = 16 if kind & CPU else 1
        self.context = self.make("Context", None, 1, byref(self.handle), None, None)
        self.queue = self.make("CommandQueue", self.context, self.handle, c_ulong(0))
        self.program = self.make("ProgramWithSource", self.context, 1, byref(c_char_p(SOURCE)), None)
        options = b"-DWIDE=float16" if self.width == 16 else b"-DWIDE=float"
        self.call("clBuildProgram", self.program, 1, byref(self.handle), options, None, None)

    def call(self, name, *arguments):
        error = getattr(self.library, name)(*arguments)
        if error:
            raise SystemExit(f"benchmark.py: {name}: OpenCL error {error}")

    def make(self, what, *arguments):
        create, error = getattr(self.library, "clCreate" + what), c_int()
        create.restype = c_void_p
        made = create(*arguments, byref(error))
        if error.value:
            raise SystemExit(f"benchmark.py: clCreate{what}: OpenCL error {error.value}")
        return c_void_p(made)

    def info(self, kind, handle, what, type_=None):
        """A text, or a value of this type."""
        value = type_() if type_ else ctypes.create_string_buffer(512)
        self.call(f"clGet{kind}Info", handle, what, c_size_t(sizeof(value)), byref(value), None)
        return value if type_ else value.value.decode()

    def find(self, name, platform_name):
        platforms, devices, count = (c_void_p * 64)(), (c_void_p * 64)(), c_uint()
        self.call("clGetPlatformIDs", 64, platforms, byref(count))
        for platform in map(c_void_p, platforms[:count.value]):
            if platform_name not in ("built in", self.info("Platform", platform, PLATFORM_NAME)) or \
                    self.library.clGetDeviceIDs(platform, c_ulong(ANY_TYPE), 64, devices, byref(count)):
                continue  # one without devices
            for device in map(c_void_p, devices[:count.value]):
                if name.startswith("built in") or self.info("Device", device, DEVICE_NAME) == name:
                    return device  # any is this CPU, too
        raise SystemExit(f"benchmark.py: no OpenCL device {name} ({platform_name})")

    def buffer(self, size):
        made = self.make("Buffer", self.context, c_ulong(READ_WRITE), c_size_t(size), None)
        self.call("clEnqueueFillBuffer", self.queue, made, byref(c_float()), c_size_t(4), c_size_t(0), c_size_t(size), 0,
                  None, None)
        self.call("clFinish", self.queue)
        return made

    def fastest(self, name, items, *arguments):
        """Seconds of a kernel's fastest launch; the first, which compiles, is not counted."""
        kernel, taken = self.make("Kernel", self.program, name), []
        for i, argument in enumerate(arguments):
            self.call("clSetKernelArg", kernel, i, c_size_t(sizeof(argument)), byref(argument))
        for _ in range(RUNS + 1):
            begin = time.perf_counter()
            self.call("clEnqueueNDRangeKernel", self.queue, kernel, 1, None, byref(c_size_t(items)),
                      byref(c_size_t(GROUP_ITEMS)), 0, None, None)
            self.call("clFinish", self.queue)
            taken.append(time.perf_counter() - begin)
        return min(taken[1:])


def measure(name, platform_name, mebibytes):
    """`mebibytes`: of each of the two arrays that are copied."""
    device, size = Device(name, platform_name), mebibytes << 20
    platform = device.info("Device", device.handle, DEVICE_PLATFORM, c_void_p)
    items = FMA_ITEMS * (256 if device.width == 1 else 1)
    copied = device.fastest(b"copy", size // 16, device.buffer(size), device.buffer(size))
    added = device.fastest(b"multiply_add", items, c_int(FMA_ROUNDS), c_float(0.999), device.buffer(4 * items * device.width))
    return {"platform_version": device.info("Platform", platform, PLATFORM_VERSION),
            "driver_version": device.info("Device", device.handle, DRIVER_VERSION),
            "compute_units": device.info("Device", device.handle, DEVICE_UNITS, c_uint).value,
            "copy_bytes_per_second": 2 * size / copied,  # read and written
            "operations_per_second": 2 * FMA_CHAINS * FMA_ROUNDS * items * device.width / added}
