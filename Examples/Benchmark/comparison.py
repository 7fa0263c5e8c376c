# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tables a and b: marching-correctors against what one would use otherwise, on the wavy tank.

All use the cubic spline, the same smoothing length and the same cube size, half of it.
"""
import competitors
import report
import sets
from program import need_surface

CUBE = ("--cube-factor", competitors.CUBE_FACTOR)
ISOSURFACE = ("--scalar", "Swirl", "--iso", 0, *CUBE)
FREE_SURFACE = ("--free-surface", "--iso", competitors.THRESHOLD, *CUBE)


def spread(result):
    return f"{report.seconds(min(result['all']))} .. {report.seconds(max(result['all']))}"


def our_row(count, ours):
    return [sets.text_of(count), ours["name"], report.seconds(ours["seconds"]), spread(ours),
            len(ours["all"]), f"{ours['triangles']:,}", report.mebibytes(ours["bytes"]), "1", "1"]


def their_row(count, name, theirs, ours):
    if "left_out" not in theirs:
        return [sets.text_of(count), theirs["name"], report.seconds(theirs["seconds"]),
                spread(theirs), len(theirs["all"]), f"{theirs['triangles']:,}",
                report.mebibytes(theirs["bytes"]),
                report.ratio(theirs["seconds"] / ours["seconds"]),
                report.ratio(theirs["bytes"] / ours["bytes"])]
    if "estimated_seconds" not in theirs:
        return [sets.text_of(count), name, "-", "left out", 0, "", "", "", ""]
    time, size = theirs["estimated_seconds"], theirs["estimated_bytes"]
    return [sets.text_of(count), name, f"(about {time:.0f})", "left out", 0, "",
            f"(about {report.mebibytes(size)})", f"({report.ratio(time / ours['seconds'])})",
            f"({report.ratio(size / ours['bytes'])})"]


def compare(benchmark, name, run_ours):
    """One table: run_ours(set) against competitor `name` at every size."""
    out, rows, notes, results, smaller = benchmark.report, [], [], [], None
    for count in benchmark.sizes:
        which = sets.tank(count)
        ours = need_surface(run_ours(which), which.name)
        actual = ours["statistics"]["fluid_particles"]
        theirs = competitors.measure(name, benchmark.sets.get(which), actual, benchmark.runs,
                                     benchmark.limit, smaller)
        if "left_out" in theirs:
            notes.append(f"{sets.text_of(count)}: {name} {theirs['left_out']}.")
        else:
            smaller = need_surface(theirs, f"{name}, {which.name}")
        rows += [our_row(count, ours), their_row(count, name, theirs, ours)]
        results.append({"particles": actual, "ours": ours, "theirs": theirs})
    out.table(["particles", "", "seconds", "fastest .. slowest", "runs", "triangles", "peak memory",
               "time ratio", "memory ratio"], rows)
    for note in notes:
        out.text(f"- {note}")
    for count, result in zip(benchmark.sizes, results):
        ours = result["ours"]
        phases = ", ".join(f"{phase.replace('_', ' ')} {time:.3f}"
                           for phase, time in ours["phases"].items())
        out.text(f"- {sets.text_of(count)}: {result['particles']:,} particles; "
                 f"marching-correctors' first run {ours['first']:.3f} s; phases (s): {phases}.")
    return results


def isosurface(benchmark):
    out = benchmark.report
    out.heading("a. Isosurface of a scalar against vtkSPHInterpolator + vtkFlyingEdges3D")
    out.text("Swirl = 0. marching-correctors: complete seeds, corrected vertices, normals, "
             "trimmed, the 4 other arrays interpolated (three are constant).")
    out.text("VTK: this scalar alone, linear vertices, no normals, not trimmed.")
    out.text()
    return compare(benchmark, "vtk",
                   lambda which: benchmark.program.run(benchmark.sets.get(which), ISOSURFACE))


def free_surface(benchmark):
    out = benchmark.report
    out.heading("b. Free surface with one attribute and normals against splashsurf")
    out.text("Weight sum 0.5. marching-correctors: complete seeds, corrected vertices. "
             "splashsurf: linear vertices.")
    out.text()

    def run_ours(which):
        path, constants = benchmark.sets.get_with_one_array(which, "Swirl")
        return benchmark.program.run(path, (*FREE_SURFACE, *constants))

    return compare(benchmark, "splashsurf", run_ours)
