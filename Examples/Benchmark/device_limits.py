# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The limits of an OpenCL device: bytes copied and floating-point operations per second.

Every figure is the best of several runs: a limit is not a typical value. The arrays that are copied should be well above
the caches.
"""
import time

import numpy as np
import pyopencl as cl

RUNS = 7
GROUP_ITEMS = 64  # PoCL, left to choose, may make one group, for one core, of them all
FMA_ITEMS, FMA_ROUNDS, FMA_CHAINS = 4096, 8192, 8

# WIDE: as many floats as a vector register of a CPU has at most, 1 on a GPU. Eight chains of FMAs that do not wait for
# each other hide the latency of the unit; the sum keeps them from being removed.
SOURCE = """
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


def find(name, platform_name):
    """The device of these names; for the built-in one, which is this CPU, too, any."""
    for platform in cl.get_platforms():
        for device in platform.get_devices() if platform_name in ("built in", platform.name) else ():
            if name.startswith("built in") or device.name == name:
                return device
    raise SystemExit(f"benchmark.py: no OpenCL device {name} ({platform_name})")


def measure(name, platform_name, mebibytes):
    """`mebibytes`: of each of the two arrays that are copied."""
    device, size = find(name, platform_name), mebibytes << 20
    width = 16 if device.type & cl.device_type.CPU else 1
    context = cl.Context([device])
    queue = cl.CommandQueue(context)
    program = cl.Program(context, SOURCE).build(["-DWIDE=" + ("float16" if width == 16 else "float")])

    def buffer(size):
        made = cl.Buffer(context, cl.mem_flags.READ_WRITE, size)
        cl.enqueue_fill_buffer(queue, made, np.float32(0), 0, size).wait()
        return made

    def fastest(name, items, *arguments):
        """Seconds of a kernel's fastest launch; the first, which compiles, is not counted."""
        kernel, taken = cl.Kernel(program, name), []
        for _ in range(RUNS + 1):
            begin = time.perf_counter()
            kernel(queue, (items,), (GROUP_ITEMS,), *arguments).wait()
            taken.append(time.perf_counter() - begin)
        return min(taken[1:])

    items = FMA_ITEMS * (256 if width == 1 else 1)
    copied = fastest("copy", size // 16, buffer(size), buffer(size))
    added = fastest("multiply_add", items, np.int32(FMA_ROUNDS), np.float32(0.999), buffer(4 * items * width))
    return {"driver": f"{device.platform.version}, {device.driver_version}, {device.max_compute_units} compute units",
            "copy_bytes_per_second": 2 * size / copied,  # read and written
            "operations_per_second": 2 * FMA_CHAINS * FMA_ROUNDS * items * width / added}
