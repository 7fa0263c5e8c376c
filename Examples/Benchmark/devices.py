#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Which device suits a series of surfaces: the seconds of an update with new particles, in one context, on each.

  devices.py [--sizes 670k,10M] [DEVICE...]     numbers or parts of names; default: all that the Python package lists

Needs the package marching-correctors and NumPy alone. Medians of six updates after the first, which is given apart and
holds what a driver compiles. The surfaces of all devices are compared, to the last bit.
"""
import argparse
import hashlib
import statistics
import time

import marchingcorrectors
import numpy


def make_tank(count):
    """Makes a jittered lattice below waves. Returns positions, [n, 3]; a smooth scalar, [n]; h, mass and density."""
    spacing = (3 * 1.5 * 0.55 / count) ** (1 / 3)
    axes = [numpy.arange(spacing / 2, side, spacing) for side in (3.0, 1.5, 1.0)]
    x = numpy.stack(numpy.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    x += numpy.random.default_rng(477).uniform(-0.15, 0.15, x.shape) * spacing
    x = x[x[:, 2] < 0.55 + 0.12 * numpy.sin(4.1 * x[:, 0] + 0.7) * numpy.cos(2.9 * x[:, 1])].astype("f4")
    a, b = numpy.sin(14 * x), numpy.cos(14 * x)
    sizes = {"smoothing_length": 1.28 * spacing, "mass": 1000 * spacing**3, "density": 1000}
    return x, (a * numpy.roll(b, -1, 1)).sum(1), {name: numpy.full(len(x), size, "f4") for name, size in sizes.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("devices", nargs="*", metavar="DEVICE", default=list(range(len(marchingcorrectors.devices()))))
    parser.add_argument("--sizes", default="670k,10M")
    arguments = parser.parse_args()
    print("| particles | surface | device | triangles | first, s | update, s | bits |\n|---|---|---|---|---|---|---|")
    for size in arguments.sizes.split(","):
        x, swirl, sizes = make_tank(float(size.replace("k", "e3").replace("M", "e6")))
        for what in ("free", "scalar"):
            expected = None
            for device in arguments.devices:
                context, seconds = marchingcorrectors.Context(device), []
                for turn in range(7):
                    begin, moved = time.perf_counter(), x + numpy.float32(1e-4 * (turn % 2))
                    surface = (marchingcorrectors.free_surface(moved, context=context, **sizes) if what == "free" else
                               marchingcorrectors.isosurface(moved, swirl, 0, context=context, **sizes))
                    seconds.append(time.perf_counter() - begin)
                bits = hashlib.sha256(surface.points.tobytes() + surface.triangles.tobytes() + surface.normals.tobytes()).digest()
                expected = expected or bits
                print(f"| {len(x):,} | {what} | {device} | {len(surface.triangles):,} | {seconds[0]:.3f} | "
                      f"{statistics.median(seconds[1:]):.3f} | {'the same' if bits == expected else 'DIFFERENT'} |", flush=True)
                del context, surface


if __name__ == "__main__":
    main()
