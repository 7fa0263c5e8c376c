# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes tables a and b, which compare this program with other software on the wavy tank, with the cubic spline, the same
smoothing length, and cubes of half this length."""
from measure import CUBE_FACTOR, THRESHOLD, compete, mebibytes, need_surface, ratio, seconds_of, text_of

CUBE = ("--cube-factor", CUBE_FACTOR)
ISOSURFACE = ("--scalar", "Swirl", "--iso", 0, *CUBE)
FREE_SURFACE = ("--free-surface", "--iso", THRESHOLD, *CUBE)


def competitor_row(count, name, theirs, ours):
    """Returns a row with what the competitor took, or with why it was left out."""
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
    """Writes a table: run_ours(count) against the competitor `name` at every size. Returns both results of each size."""
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
