# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Table d: how far each phase is from what the device can do at all.

A phase cannot be faster than the bytes it must move over the measured bandwidth, nor than the
floating-point operations it must make over the measured peak: its limit is the longer of the two.
Bandwidth and peak are those of benchmark-limits (a copy; chains of FMAs, two operations each) on
the same device.

The model counts what the method asks for, not what this implementation does:

- Bytes: an array that a phase needs is read once, one that it leaves is written once. Caches serve
  all other accesses. A particle is POSITION, 1 / h, weight and scalar, in single precision.
- Operations: evaluations as marching-correctors counts them, times particles in the support, times
  operations per particle of the formulas (cubic spline; +, -, *, max and a square root are one
  each). Particles in the support: volume of the support over the mean volume of a particle, inside
  the fluid; at the free surface there are fewer, so that this is a little too high.
- Seeds: the bound over a brick of 4^3 nodes, for the bricks that remain, and the values of their
  nodes.
- Not counted: finding the particles in reach, sorting, Marching Cubes, bricks that the seeds' bound
  excludes. These are part of a phase's distance from its limit.
"""
import math

import competitors
import report
import sets
from comparison import ISOSURFACE

FLOAT = 4
POSITION = 3 * FLOAT
PARTICLE = POSITION + 3 * FLOAT
CALLER_ARRAYS = POSITION + 4 * FLOAT  # positions, smoothing length, mass, density, scalar
NODE = 2 * FLOAT                      # value and weight
VERTEX = 6 * FLOAT                    # its edge (lattice node, axis), its values at both ends
CORRECTED = 9 * FLOAT                 # offset, gradient, value, weight, length
TRIANGLE = 3 * FLOAT
ATTRIBUTES = 4                        # the tank's arrays but for the scalar

# Operations per particle and evaluation.
DISTANCE = 8 + 1 + 1              # 3 differences, sum of squares, square root, times 1 / h
KERNEL = 10                       # 1/4 max(2 - q, 0)^3 - max(1 - q, 0)^3
SLOPE = 5                         # 3 max(1 - q, 0)^2 - 3/4 max(2 - q, 0)^2, squares as in KERNEL
NODE_OPERATIONS = DISTANCE + KERNEL + 4
GRADIENT_OPERATIONS = DISTANCE + KERNEL + SLOPE + 2 + 3 + 2 * 8  # slope / r, vector, two sums of 4
ATTRIBUTE_OPERATIONS = 2 + 2 * ATTRIBUTES  # the last evaluation has the weights
BOUND_OPERATIONS = 3 * 3 + DISTANCE + KERNEL + 4  # per axis |x|, -+ half size, max; two sums


def support_volume(h):
    return 4 / 3 * math.pi * (2 * h) ** 3


def reach_volume(h, edge):
    """Of all points within 2 h of a cube."""
    r = 2 * h
    return edge ** 3 + 6 * r * edge ** 2 + 3 * math.pi * r * r * edge + support_volume(h)


def mean_volume(particles):
    """Of a particle, from arrays Mass and Density."""
    from vtk.util.numpy_support import vtk_to_numpy
    data = particles.GetPointData()
    mass, density = (vtk_to_numpy(data.GetArray(name)) for name in ("Mass", "Density"))
    return float((mass / density).mean())


def work(result, volume):
    """Bytes and operations of each phase."""
    s = result["statistics"]
    n, vertices, triangles = s["fluid_particles"], s["points"], s["triangles"]
    marched, marched_triangles = s["vertices_corrected"], s["triangles_before_trimming"]
    h, cube = s["smoothing_length_range"][0], result["parameters"]["cube_size"]
    neighbours = support_volume(h) / volume
    brick_particles = reach_volume(h, 3 * cube) / volume
    near = min(n, s["bricks"] * (4 * cube) ** 3 / volume)  # bricks of 4^3 cells
    surface = vertices * (6 + ATTRIBUTES) * FLOAT + triangles * (3 + 1) * 8  # as VTK stores it
    return {
        "input": (n * (CALLER_ARRAYS + PARTICLE), 0),
        "search_grid": (n * 2 * PARTICLE, 0),
        "seeds": (n * PARTICLE + s["nodes_evaluated"] * NODE,
                  s["bricks"] * brick_particles * BOUND_OPERATIONS +
                  s["nodes_evaluated"] * neighbours * NODE_OPERATIONS),
        "extraction": (s["nodes_evaluated"] * NODE + marched * VERTEX +
                       marched_triangles * TRIANGLE, 0),
        "correction": (near * PARTICLE + n * ATTRIBUTES * FLOAT +
                       marched * (VERTEX + CORRECTED + ATTRIBUTES * FLOAT),
                       s["newton_evaluations"] * neighbours * GRADIENT_OPERATIONS +
                       marched * neighbours * ATTRIBUTE_OPERATIONS),
        "trimming": (marched * FLOAT + (marched_triangles + triangles) * TRIANGLE, 0),
        "output": (vertices * (CORRECTED + ATTRIBUTES * FLOAT) + triangles * TRIANGLE + surface, 0)}


def limits(benchmark):
    out = benchmark.report
    count = benchmark.middle
    out.heading(f"d. Phases against the limits of the device ({sets.text_of(count)})")
    path = benchmark.sets.get(sets.tank(count))
    result = benchmark.program.run(path, ISOSURFACE)
    device = benchmark.program.helper("benchmark-limits", result["device"], result["platform"],
                                      64 if benchmark.quick else 1024)
    bandwidth, peak = device["copy_bytes_per_second"], device["operations_per_second"]
    volume = mean_volume(sets.read(path))
    out.text(f"Measured: copy {bandwidth / 1e9:.1f} GB/s, FMA {peak / 1e9:.0f} Gflop/s. Cube size "
             f"{competitors.CUBE_FACTOR:g} h, {result['statistics']['nodes_evaluated']:,} nodes, "
             f"{result['statistics']['newton_evaluations']:,} evaluations of the correction, "
             f"{support_volume(result['statistics']['smoothing_length_range'][0]) / volume:.0f} "
             "particles in a support.")
    out.text()
    rows, table = [], {}
    for phase, (size, operations) in work(result, volume).items():
        measured = result["phases"][phase]
        limit = max(size / bandwidth, operations / peak)
        table[phase] = {"seconds": measured, "bytes": size, "operations": operations,
                        "limit_seconds": limit}
        rows.append([phase.replace("_", " "), f"{1e3 * measured:.1f}", f"{size / 1e6:.1f}",
                     f"{1e3 * size / bandwidth:.2f}", f"{operations / 1e9:.2f}",
                     f"{1e3 * operations / peak:.2f}", report.ratio(measured / limit)])
    total, limit = (sum(t[key] for t in table.values()) for key in ("seconds", "limit_seconds"))
    rows.append(["all", f"{1e3 * total:.1f}", "", "", "", "", report.ratio(total / limit)])
    out.table(["phase", "ms", "MB", "MB at copy speed, ms", "Gflop", "Gflop at peak, ms",
               "times the limit"], rows)
    return {"device": device, "phases": table}
