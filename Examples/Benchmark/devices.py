#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tells which device suits a series of surfaces: prints the seconds of an update with new particles, in one context, for each device.

  devices.py [--sizes 670k,10M] [--profile] [DEVICE...]     numbers or parts of names; default: all that the Python package lists

Needs the package marching-correctors and NumPy alone. The seconds are medians of six updates. The first update,
which includes what a driver compiles, is given apart. The surfaces of all devices are compared, to the last bit. --profile adds, for each
phase of the update with the median time, the seconds of the host and of the device, and the kernels that take longest; measuring
each command makes updates a little slower.
"""
import argparse
import collections
import csv
import hashlib
import os
import statistics
import tempfile
import time

import marchingcorrectors
import numpy


def make_tank(count):
    """Makes a jittered lattice below waves. Returns positions, [n, 3]; a smooth scalar, [n]; and {name: [n]} of h, mass and density."""
    spacing = (3 * 1.5 * 0.55 / count) ** (1 / 3)
    axes = [numpy.arange(spacing / 2, side, spacing) for side in (3.0, 1.5, 1.0)]
    x = numpy.stack(numpy.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    x += numpy.random.default_rng(477).uniform(-0.15, 0.15, x.shape) * spacing
    x = x[x[:, 2] < 0.55 + 0.12 * numpy.sin(4.1 * x[:, 0] + 0.7) * numpy.cos(2.9 * x[:, 1])].astype("f4")
    a, b = numpy.sin(14 * x), numpy.cos(14 * x)
    sizes = {"smoothing_length": 1.28 * spacing, "mass": 1000 * spacing**3, "density": 1000}
    return x, (a * numpy.roll(b, -1, 1)).sum(1), {name: numpy.full(len(x), size, "f4") for name, size in sizes.items()}


def show_profile(path, call):
    """Prints the profile of one call as a table, and the call's slowest kernels. The host's time of a phase leaves out OpenCL's functions,
    because those that read wait for the device. Times of kernels and transfers are the device's."""
    totals = collections.defaultdict(lambda: collections.Counter(dict.fromkeys(("phase", "build"), 0)))
    kernels = collections.Counter()
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            if int(row["call"]) != call:
                continue
            command, phase, host, device = row["command"], totals[row["phase"]], float(row["host_seconds"]), float(row["device_seconds"])
            for key, value in (("", host), (" count", int(row["count"])), (" bytes", int(row["bytes"])), (" device", device)):
                phase[command + key] += value
            phase["calls"] += host if command not in ("phase", "build") else 0
            if command == "launch":
                kernels[row["kernel"]] += device
    totals["all"] = sum(totals.values(), collections.Counter())
    print("\n| phase | ms | host, ms | launches | kernels, ms | waits, copies | their ms | up, MB | up, ms | down, MB | down, ms |"
          "\n|---|---|---|---|---|---|---|---|---|---|---|")
    for name, of in totals.items():
        waits, waited = [sum(of[command + key] for command in ("wait", "write", "read")) for key in (" count", "")]
        print(f"| {name} | {1e3 * of['phase']:.1f} | {1e3 * (of['phase'] - of['calls']):.1f} | {of['launch count']} | "
              f"{1e3 * of['launch device']:.1f} | {waits} | {1e3 * waited:.1f} | {1e-6 * of['write bytes']:.1f} | "
              f"{1e3 * of['write device']:.1f} | {1e-6 * of['read bytes']:.1f} | {1e3 * of['read device']:.1f} |")
    print("\nKernels, ms: " + ", ".join(f"{name} {1e3 * seconds:.1f}" for name, seconds in kernels.most_common(8)) + "\n", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("devices", nargs="*", metavar="DEVICE", default=list(range(len(marchingcorrectors.devices()))))
    parser.add_argument("--sizes", default="670k,10M")
    parser.add_argument("--profile", action="store_true")
    arguments = parser.parse_args()
    folder = tempfile.TemporaryDirectory()
    profile = os.path.join(folder.name, "profile.csv")
    if arguments.profile:
        os.environ["MCOR_PROFILE"] = profile
    print("| particles | surface | device | triangles | first, s | update, s | bits |\n|---|---|---|---|---|---|---|")
    for size in arguments.sizes.split(","):
        x, swirl, sizes = make_tank(float(size.replace("k", "e3").replace("M", "e6")))
        for what in ("free", "scalar"):
            expected = None
            for device in arguments.devices:
                open(profile, "w").close()
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
                if arguments.profile:
                    show_profile(profile, seconds.index(statistics.median_high(seconds[1:]), 1))
                del context, surface


if __name__ == "__main__":
    main()
