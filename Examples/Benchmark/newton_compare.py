#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the free surface by this package, by ParticleSurface of newton (1.8) and by the marching cubes of Warp, from the same
particles with cubes of the same size. Needs the packages marching-correctors, newton and NumPy.

  newton_compare.py [--sizes 60k] [--device cpu]     Warp's device, or that of marching-correctors

newton is set to isotropic kernels and to positions that are not smoothed. Its density is then the same sum of V W with the cubic spline; the volume V
is that of a cube, 8 r^3. So all three contour one field at 0.5. Warp's class takes values on a full grid: probe() computes them, and this time is not
counted. Each tool runs four times in a process of its own; the first run compiles, unless Warp has kept its kernels. Processor time is that of all
threads, the least of the last three runs. Distances of vertices from the surface are |f - 0.5| / |grad f| by probe().
"""
import argparse
import hashlib
import resource
import statistics
import subprocess
import sys
import time

import numpy
from devices import make_tank

ISO = 0.5


def by_marching_correctors(x, sizes, cube, device):
    import marchingcorrectors
    context = marchingcorrectors.Context(None if device == "cpu" else device)

    def run():
        surface = marchingcorrectors.free_surface(x, iso=ISO, cube_size=cube, context=context, **sizes)
        return surface.points, surface.triangles
    return run


def by_newton(x, sizes, cube, device):
    import newton.geometry
    import warp
    warp.config.quiet = True
    h, volume = sizes["smoothing_length"][0], sizes["mass"][0] / sizes["density"][0]
    maker = newton.geometry.ParticleSurface(voxel_size=cube, kernel_radius=2 * h, kernel_scale=0.5, threshold=ISO, smooth_lambda=0, device=device)

    def run():
        positions = warp.array(x, dtype=warp.vec3, device=device)
        radii = warp.full(len(x), 0.5 * volume ** (1 / 3), dtype=float, device=device)
        points, indices, _ = maker.extract(positions, radii).to_arrays()
        return points.numpy(), indices.numpy().reshape(-1, 3)
    return run


def by_warp(x, sizes, cube, device):
    import marchingcorrectors
    import warp
    warp.config.quiet = True
    low = cube * numpy.floor(x.min(0).astype(float) / cube - 3)
    count = numpy.ceil((x.max(0) - low) / cube).astype(int) + 4
    nodes = low + cube * numpy.stack(numpy.meshgrid(*map(numpy.arange, count), indexing="ij"), -1)
    field = marchingcorrectors.probe(x, nodes.reshape(-1, 3), **sizes).weight_sum.reshape(count).astype("f4")
    upper = low + cube * (count - 1)

    def run():
        points, indices = warp.MarchingCubes.extract(warp.array(field, device=device), ISO, lower=warp.vec3(*low), upper=warp.vec3(*upper))
        return points.numpy(), indices.numpy().reshape(-1, 3)
    return run


def measure(tool, count, device):
    import marchingcorrectors
    x, _, sizes = make_tank(count)
    cube = 0.5 * float(sizes["smoothing_length"][0])
    run, seconds, busy, hashes = TOOLS[tool](x, sizes, cube, device), [], [], set()
    for _ in range(4):
        begin, used = time.perf_counter(), time.process_time()
        points, triangles = map(numpy.ascontiguousarray, run())
        seconds.append(time.perf_counter() - begin)
        busy.append(time.process_time() - used)
        hashes.add(hashlib.sha256(points.tobytes() + triangles.tobytes()).hexdigest())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    found = marchingcorrectors.probe(x, points.astype(float), gradients=True, **sizes)
    distance = numpy.abs(found.weight_sum - ISO) / numpy.linalg.norm(found.weight_gradient, axis=1) / cube
    print(f"| {len(x):,} | {tool} | {len(triangles):,} | {seconds[0]:.1f} | {statistics.median(seconds[1:]):.2f} | {min(busy[1:]):.2f} | {memory:.0f} | "
          f"{distance.max():.1e} ({distance.mean():.1e}) | {'yes' if len(hashes) == 1 else 'no'} |", flush=True)


TOOLS = {"marching-correctors": by_marching_correctors, "newton": by_newton, "Warp, on a full grid": by_warp}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default="60k")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--tool", choices=TOOLS, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.tool:
        measure(arguments.tool, float(arguments.sizes), arguments.device)
        return
    print("| particles | | triangles | first, s | again, s | of a processor, s | memory, MiB | vertices off the surface, cubes: most (mean) | "
          "same mesh each time |\n|---|---|---|---|---|---|---|---|---|", flush=True)
    for size in arguments.sizes.split(","):
        count = float(size.replace("k", "e3").replace("M", "e6"))
        for tool in TOOLS:
            command = [sys.executable, __file__, "--tool", tool, "--sizes", str(count), "--device", arguments.device]
            subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
