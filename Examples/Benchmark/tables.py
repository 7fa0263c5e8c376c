# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tables a, b, d and e, on the wavy tank: against what one would use otherwise, with the cubic spline, the same smoothing
length and the same cube size, half of it; against the device's limits; reuse and growth."""
import math
import statistics
import time

import numpy as np
from measure import (CUBE_FACTOR, PHASES, THRESHOLD, array_of, compete, mebibytes, need_surface, points_of, ratio, read,
                     seconds_of, sum_of, text_of)

CUBE = ("--cube-factor", CUBE_FACTOR)
ISOSURFACE = ("--scalar", "Swirl", "--iso", 0, *CUBE)
FREE_SURFACE = ("--free-surface", "--iso", THRESHOLD, *CUBE)


def competitor_row(count, name, theirs, ours):
    """A row of what was measured, ours too, or of what was left out."""
    head = [text_of(count), theirs.get("name", name)]
    if "left_out" not in theirs:
        every = theirs["all"]
        return head + [seconds_of(theirs["seconds"]), f"{seconds_of(min(every))} .. {seconds_of(max(every))}", len(every),
                       f"{theirs['triangles']:,}", mebibytes(theirs["bytes"]), ratio(theirs["seconds"] / ours["seconds"]),
                       ratio(theirs["bytes"] / ours["bytes"])]
    if "estimated_seconds" not in theirs:
        return head + ["-", "left out", 0, "", "", "", ""]
    took, size = theirs["estimated_seconds"], theirs["estimated_bytes"]
    return head + [f"(about {took:.0f})", "left out", 0, "", f"(about {mebibytes(size)})",
                   f"({ratio(took / ours['seconds'])})", f"({ratio(size / ours['bytes'])})"]


def compare(benchmark, name, run_ours):
    """One table: run_ours(count) against competitor `name` at every size."""
    out, rows, notes, results, smaller = benchmark.report, [], [], [], None
    for count in benchmark.sizes:
        ours = need_surface(run_ours(count), f"tank of {count}")
        actual = ours["statistics"]["fluid_particles"]
        theirs = compete(name, benchmark.sets.get("tank", count), actual, benchmark.runs, benchmark.limit, smaller)
        if "left_out" in theirs:
            notes.append(f"- {text_of(count)}: {name} {theirs['left_out']}.")
        else:
            smaller = need_surface(theirs, f"{name}, tank of {count}")
        rows += [[*competitor_row(count, "", ours, ours)[:-2], "1", "1"], competitor_row(count, name, theirs, ours)]
        phases = ", ".join(f"{phase.replace('_', ' ')} {took:.3f}" for phase, took in ours["phases"].items())
        notes.append(f"- {text_of(count)}: {actual:,} particles; marching-correctors' first run {ours['first']:.3f} s; "
                     f"phases (s): {phases}.")
        results.append({"particles": actual, "ours": ours, "theirs": theirs})
    out.table(["particles", "", "seconds", "fastest .. slowest", "runs", "triangles", "peak memory", "time ratio",
               "memory ratio"], rows)
    out.text(*notes)
    return results


def isosurface(benchmark):
    benchmark.report.heading(
        "a. Isosurface of a scalar against vtkSPHInterpolator + vtkFlyingEdges3D",
        "Swirl = 0. marching-correctors: complete seeds, corrected vertices, normals, trimmed, the 4 other arrays "
        "interpolated (three are constant).", "VTK: this scalar alone, linear vertices, no normals, not trimmed.")
    return compare(benchmark, "vtk", lambda count: benchmark.program.run(benchmark.sets.get("tank", count), ISOSURFACE))


def free_surface(benchmark):
    benchmark.report.heading(
        "b. Free surface with one attribute and normals against splashsurf",
        "Weight sum 0.5. marching-correctors: complete seeds, corrected vertices. splashsurf: linear vertices.")

    def run_ours(count):
        path, constants = benchmark.sets.get_with_one_array("tank", count, "Swirl")
        return benchmark.program.run(path, (*FREE_SURFACE, *constants))

    return compare(benchmark, "splashsurf", run_ours)


# Table d. A phase cannot be faster than the bytes it must move over the measured bandwidth, nor than the floating-point
# operations it must make over the measured peak: its limit is the longer of the two. The model counts what the method
# asks for, not what this implementation does:
#
# - Bytes: an array that a phase needs is read once, one that it leaves is written once. Caches serve all other accesses.
#   A particle is POSITION, 1 / h, weight and scalar, in single precision.
# - Operations: evaluations as marching-correctors counts them, times particles in the support, times operations per
#   particle of the formulas (cubic spline; +, -, *, max and a square root are one each). Particles in the support: volume
#   of the support over the mean volume of a particle, inside the fluid; at the free surface there are fewer, so that this
#   is a little too high.
# - Seeds: the bound over a brick of 4^3 nodes, for the bricks that remain, and the values of their nodes.
# - Not counted: finding the particles in reach, sorting, Marching Cubes, bricks that the seeds' bound excludes. These are
#   part of a phase's distance from its limit.
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
DISTANCE = 8 + 1 + 1                  # 3 differences, sum of squares, square root, times 1 / h
KERNEL = 10                           # 1/4 max(2 - q, 0)^3 - max(1 - q, 0)^3
SLOPE = 5                             # 3 max(1 - q, 0)^2 - 3/4 max(2 - q, 0)^2, squares as in KERNEL
NODE_OPERATIONS = DISTANCE + KERNEL + 4
GRADIENT_OPERATIONS = DISTANCE + KERNEL + SLOPE + 2 + 3 + 2 * 8  # slope / r, vector, two sums of 4
ATTRIBUTE_OPERATIONS = 2 + 2 * ATTRIBUTES                        # the last evaluation has the weights
BOUND_OPERATIONS = 3 * 3 + DISTANCE + KERNEL + 4                 # per axis |x|, -+ half size, max; two sums


def support_volume(h):
    return 4 / 3 * math.pi * (2 * h) ** 3


def work(result, volume):
    """Bytes and operations of each phase; `volume` is a particle's mean one."""
    s = result["statistics"]
    n, vertices, triangles = s["fluid_particles"], s["points"], s["triangles"]
    marched, marched_triangles = s["vertices_corrected"], s["triangles_before_trimming"]
    h, cube = s["smoothing_length_range"][0], result["parameters"]["cube_size"]
    neighbours, r, edge = support_volume(h) / volume, 2 * h, 3 * cube
    # The volume of all points within 2 h of a brick.
    reach = edge ** 3 + 6 * r * edge ** 2 + 3 * math.pi * r * r * edge + support_volume(h)
    near = min(n, s["bricks"] * (4 * cube) ** 3 / volume)  # bricks of 4^3 cells
    surface = vertices * (6 + ATTRIBUTES) * FLOAT + triangles * (3 + 1) * 8  # as VTK stores it
    return {
        "input": (n * (CALLER_ARRAYS + PARTICLE), 0),
        "search_grid": (n * 2 * PARTICLE, 0),
        "seeds": (n * PARTICLE + s["nodes_evaluated"] * NODE,
                  s["bricks"] * reach / volume * BOUND_OPERATIONS + s["nodes_evaluated"] * neighbours * NODE_OPERATIONS),
        "extraction": (s["nodes_evaluated"] * NODE + marched * VERTEX + marched_triangles * TRIANGLE, 0),
        "correction": (near * PARTICLE + n * ATTRIBUTES * FLOAT + marched * (VERTEX + CORRECTED + ATTRIBUTES * FLOAT),
                       s["newton_evaluations"] * neighbours * GRADIENT_OPERATIONS +
                       marched * neighbours * ATTRIBUTE_OPERATIONS),
        "trimming": (marched * FLOAT + (marched_triangles + triangles) * TRIANGLE, 0),
        "output": (vertices * (CORRECTED + ATTRIBUTES * FLOAT) + triangles * TRIANGLE + surface, 0)}


def limits(benchmark):
    out, count = benchmark.report, benchmark.middle
    try:
        import device_limits
    except ImportError:
        out.text("", "d. is left out: it needs pyopencl.", "")
        return None
    path = benchmark.sets.get("tank", count)
    result = benchmark.program.run(path, ISOSURFACE)
    device = device_limits.measure(result["device"], result["platform"], 64 if benchmark.quick else 1024)
    bandwidth, peak = device["copy_bytes_per_second"], device["operations_per_second"]
    particles, s = read(path), result["statistics"]
    volume = float((array_of(particles, "Mass") / array_of(particles, "Density")).mean())
    out.heading(f"d. Phases against the limits of the device ({text_of(count)})",
                f"Measured through {device['driver']}: copy {bandwidth / 1e9:.1f} GB/s, FMA {peak / 1e9:.0f} Gflop/s. "
                f"Cube size {CUBE_FACTOR:g} h, "
                f"{s['nodes_evaluated']:,} nodes, {s['newton_evaluations']:,} evaluations of the correction, "
                f"{support_volume(s['smoothing_length_range'][0]) / volume:.0f} particles in a support.")
    rows, table = [], {}
    for phase, (size, operations) in work(result, volume).items():
        measured, limit = result["phases"][phase], max(size / bandwidth, operations / peak)
        table[phase] = {"seconds": measured, "bytes": size, "operations": operations, "limit_seconds": limit}
        rows.append([phase.replace("_", " "), f"{1e3 * measured:.1f}", f"{size / 1e6:.1f}",
                     f"{1e3 * size / bandwidth:.2f}", f"{operations / 1e9:.2f}", f"{1e3 * operations / peak:.2f}",
                     ratio(measured / limit)])
    total, limit = (sum(t[key] for t in table.values()) for key in ("seconds", "limit_seconds"))
    rows.append(["all", f"{1e3 * total:.1f}", "", "", "", "", ratio(total / limit)])
    out.table(["phase", "ms", "MB", "MB at copy speed, ms", "Gflop", "Gflop at peak, ms", "times the limit"], rows)
    return {"device": device, "phases": table}


REUSE_STEPS = (("first run", "Swirl", 0), ("other iso value", "Swirl", 0.4), ("first iso value again", "Swirl", 0),
               ("other scalar", "Pressure", 2500))


def update(filter_, step):
    """Seconds of Update(), and of two phases."""
    filter_.SetInputArrayToProcess(0, 0, 0, 0, step[1])
    filter_.SetValue(0, step[2])
    begin = time.perf_counter()
    filter_.Update()
    taken = time.perf_counter() - begin
    if filter_.GetErrorMessage() or filter_.GetOutput().GetNumberOfCells() == 0:
        raise SystemExit(f"benchmark.py: {step[0]}: no surface: {filter_.GetErrorMessage()}")
    phases = filter_.GetRunStatistics().GetArray("Seconds")
    named = {phases.GetComponentName(i): phases.GetComponent(0, i) for i in range(phases.GetNumberOfComponents())}
    return {"all": taken, "grid": named["search grid"], "seeds": named["seeds"]}


def second_surface(benchmark):
    """One filter whose iso value and scalar change, against a new filter for each change."""
    from marchingcorrectors import vtkMarchingCorrectors
    out, count, times = benchmark.report, benchmark.middle, {}
    out.heading(f"Another surface of the same particles ({text_of(count)})",
                "One filter throughout against a new one for each; seconds of Update(). All arrays interpolated. The "
                "surfaces are the same.", mark="###")
    particles = read(benchmark.sets.get("tank", count))

    def make():
        made = vtkMarchingCorrectors()
        made.SetDevice(benchmark.program.device or "")
        made.SetInputData(particles)
        return made

    for run in range(benchmark.runs + 1):
        filters = {"reused": make()}
        for step in REUSE_STEPS:
            filters["fresh"] = make()
            for name, filter_ in filters.items():
                used = update(filter_, step)
                if run > 0:  # the first one loads the OpenCL program
                    times.setdefault(step[0], {}).setdefault(name, []).append(used)
            surfaces = [filter_.GetOutput() for filter_ in filters.values()]
            if len({s.GetNumberOfCells() for s in surfaces}) > 1 or len({points_of(s).tobytes() for s in surfaces}) > 1:
                raise SystemExit(f"benchmark.py: {step[0]}: reuse changes the surface")
    rows = []
    for step, taken in times.items():
        reused, fresh = ({key: statistics.median(used[key] for used in taken[name]) for key in ("all", "grid", "seeds")}
                         for name in ("reused", "fresh"))
        rows.append([step, seconds_of(reused["all"]), seconds_of(fresh["all"]), ratio(fresh["all"] / reused["all"]),
                     seconds_of(reused["grid"]), seconds_of(reused["seeds"]), seconds_of(fresh["seeds"])])
    out.table(["", "one filter", "new filter", "times as fast", "search grid, one filter", "seeds, one filter",
               "seeds, new filter"], rows)
    return times


def array_bytes(path):
    """Points, point arrays and triangles of a file, in memory."""
    data = read(path)
    points = data.GetPointData()
    parts = [data.GetPoints().GetData(), data.GetPolys(),
             *(points.GetAbstractArray(i) for i in range(points.GetNumberOfArrays()))]
    return 1024 * sum(part.GetActualMemorySize() for part in parts)


# A row of the growth: its heading, how it is told, and what it should grow with.
GROWTH = {
    "input_seconds": ("input", seconds_of, "particles"),
    "grid_seconds": ("search grid", seconds_of, "particles"),
    "rest_seconds": ("other phases", seconds_of, "cells"),
    "particle_bytes": ("device memory, no surface", mebibytes, "particles"),
    "surface_bytes": ("more with the surface", mebibytes, "cells"),
    "bytes": ("peak memory", mebibytes, "particles"),
    "limit_bytes": ("3 x input + 2 x output", mebibytes, None),
}


def growth(benchmark):
    out, results, exponents = benchmark.report, [], {}
    out.heading("Growth with the number of particles",
                "The tank, Swirl = 0. Device memory without a surface is that of a run whose iso value no particle has. "
                "Peak memory is that of the process, libraries and all (some 130 MiB); input are the particles' arrays, "
                "output is the surface.", mark="###")
    for count in benchmark.sizes:
        path = benchmark.sets.get("tank", count)
        full = benchmark.program.run(path, ISOSURFACE)
        empty = benchmark.program.run(path, ("--scalar", "Swirl", "--iso", 100, *CUBE), 1)["statistics"]
        benchmark.program.start(path, ISOSURFACE)
        s = full["statistics"]
        results.append({
            "particles": s["fluid_particles"], "cells": s["cells_used"], "input_seconds": sum_of(full, "input"),
            "grid_seconds": sum_of(full, "search_grid"), "rest_seconds": sum_of(full, *PHASES[2:]),
            "particle_bytes": empty["device_bytes_peak"],
            "surface_bytes": s["device_bytes_peak"] - empty["device_bytes_peak"], "bytes": full["bytes"],
            "limit_bytes": 3 * array_bytes(path) + 2 * array_bytes(benchmark.program.surface)})
    rows = [[f"{row['particles']:,}", f"{row['cells']:,}", *(tell(row[key]) for key, (_, tell, _) in GROWTH.items())]
            for row in results]
    for key, (_, _, size) in GROWTH.items() if len(results) > 1 else ():
        values = [row[key] for row in results]
        # The slope of the logarithms' least squares line.
        exponents[f"{key} in {size}"] = float(np.polyfit(np.log([row[size] for row in results]), np.log(values), 1)[0]) \
            if size and min(values) > 0 else None
    if exponents:
        rows.append(["exponent", "", *(f"{slope:.2f} in {name.split()[-1]}" if slope is not None else "-"
                                       for name, slope in exponents.items())])
    out.table(["particles", "cells used", *(heading for heading, _, _ in GROWTH.values())], rows)
    return {"sizes": results, "exponents": exponents}


def reuse(benchmark):
    benchmark.report.heading("e. Reuse and growth")
    return {"second_surface": second_surface(benchmark), "growth": growth(benchmark)}
