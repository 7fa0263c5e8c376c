# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Table e: what a second surface costs, how time and memory grow, what the first start costs."""
import statistics
import tempfile

import numpy

import report
import sets
from comparison import CUBE, ISOSURFACE
from program import PHASES, sum_of

REUSE_STEPS = ("Swirl", 0, 0.4, "Pressure", 2500)
NO_SURFACE = ("--scalar", "Swirl", "--iso", 100, *CUBE)  # no particle has this value
PHASES_OF_SURFACE = [phase for phase in PHASES if phase not in ("input", "search_grid")]
CACHE_VARIABLES = ("POCL_CACHE_DIR", "CUDA_CACHE_PATH")  # where drivers keep built programs


def second_surface(benchmark):
    out = benchmark.report
    count = benchmark.middle
    out.text(f"### Another surface of the same particles ({sets.text_of(count)})")
    out.text()
    out.text("One filter throughout against a new one for each; seconds of Update(). All arrays "
             "interpolated. The surfaces are the same.")
    out.text()
    found = benchmark.program.helper(
        "benchmark-reuse", benchmark.sets.get(sets.tank(count)), benchmark.runs + 1,
        benchmark.program.device or "", *REUSE_STEPS)
    rows = []
    for step in found["steps"]:
        # The first repetition loads the OpenCL program.
        reused, fresh = ({name: statistics.median(times[1:]) for name, times in step[key].items()}
                         for key in ("reused", "fresh"))
        rows.append([step["name"], report.seconds(reused["all"]), report.seconds(fresh["all"]),
                     report.ratio(fresh["all"] / reused["all"]), report.seconds(reused["grid"]),
                     report.seconds(reused["seeds"]), report.seconds(fresh["seeds"])])
    out.table(["", "one filter", "new filter", "times as fast", "search grid, one filter",
               "seeds, one filter", "seeds, new filter"], rows)
    return found


def exponent(sizes, values):
    """Slope of the logarithms' least squares line; None where a value has no logarithm."""
    if min(values) <= 0:
        return None
    return float(numpy.polyfit(numpy.log(sizes), numpy.log(values), 1)[0])


def array_bytes(path):
    """Points, point arrays and triangles of a file, in memory."""
    data = sets.read(path)
    points = data.GetPointData()
    parts = [data.GetPoints().GetData(), data.GetPolys(),
             *(points.GetAbstractArray(i) for i in range(points.GetNumberOfArrays()))]
    return 1024 * sum(part.GetActualMemorySize() for part in parts)


def memory_limit(benchmark, path):
    """3 x input + 2 x output, in bytes."""
    benchmark.program.start(path, ISOSURFACE, 1)
    return 3 * array_bytes(path) + 2 * array_bytes(benchmark.program.surface)


def growth(benchmark):
    out = benchmark.report
    out.text("### Growth with the number of particles")
    out.text()
    out.text("The tank, Swirl = 0. Device memory without a surface is that of a run whose iso "
             "value no particle has. Peak memory is that of the process, libraries and all "
             "(some 130 MiB); input are the particles' arrays, output is the surface.")
    out.text()
    rows, results = [], []
    for count in benchmark.sizes:
        path = benchmark.sets.get(sets.tank(count))
        full = benchmark.program.run(path, ISOSURFACE)
        empty = benchmark.program.run(path, NO_SURFACE, runs=1)
        s = full["statistics"]
        row = {"particles": s["fluid_particles"], "cells": s["cells_used"],
               "grid_seconds": sum_of(full, "search_grid"),
               "input_seconds": sum_of(full, "input"),
               "rest_seconds": sum_of(full, *PHASES_OF_SURFACE),
               "particle_bytes": empty["statistics"]["device_bytes_peak"],
               "surface_bytes": s["device_bytes_peak"] - empty["statistics"]["device_bytes_peak"],
               "bytes": full["bytes"], "limit_bytes": memory_limit(benchmark, path)}
        results.append(row)
        rows.append([f"{row['particles']:,}", f"{row['cells']:,}",
                     report.seconds(row["input_seconds"]), report.seconds(row["grid_seconds"]),
                     report.seconds(row["rest_seconds"]), report.mebibytes(row["particle_bytes"]),
                     report.mebibytes(row["surface_bytes"]), report.mebibytes(row["bytes"]),
                     report.mebibytes(row["limit_bytes"])])
    header = ["particles", "cells used", "input", "search grid", "other phases",
              "device memory, no surface", "more with the surface", "peak memory",
              "3 x input + 2 x output"]
    exponents = {}
    if len(results) > 1:
        fits = (("input_seconds", "particles"), ("grid_seconds", "particles"),
                ("rest_seconds", "cells"), ("particle_bytes", "particles"),
                ("surface_bytes", "cells"), ("bytes", "particles"))
        for value, size in fits:
            slope = exponent([r[size] for r in results], [r[value] for r in results])
            exponents[f"{value} in {size}"] = slope
        rows.append(["exponent", ""] + [
            "-" if slope is None else f"{slope:.2f} in {name.split()[-1]}"
            for name, slope in exponents.items()] + [""])
    out.table(header, rows)
    return {"sizes": results, "exponents": exponents}


def first_start(benchmark):
    out = benchmark.report
    count = benchmark.middle
    out.text(f"### First start ever, and later starts ({sets.text_of(count)})")
    out.text()
    out.text("Process: from start to end, with reading the particles and writing the surface. "
             "First start ever: no built programs are cached (POCL_CACHE_DIR, CUDA_CACHE_PATH). PoCL "
             "compiles a kernel once more at its first launch, which counts in the phases.")
    out.text()
    path = benchmark.sets.get(sets.tank(count))
    starts = []
    for _ in range(benchmark.runs):
        with tempfile.TemporaryDirectory(prefix="mcor-cache-") as cache:
            environment = {name: cache for name in CACHE_VARIABLES}
            starts.append([benchmark.program.start(path, ISOSURFACE, 1, environment)
                           for _ in range(2)])
    rows, results = [], {}
    for i, name in enumerate(("first start ever", "later start")):
        seconds = [pair[i][1] for pair in starts]
        runs = [pair[i][0]["runs"][0] for pair in starts]
        build = [run["seconds"]["program_build"] for run in runs]
        row = {"process_seconds": statistics.median(seconds),
               "first_run_seconds": statistics.median(run["wall_seconds"] for run in runs),
               "program_build_seconds": statistics.median(build)}
        results[name] = row
        rows.append([name, *(report.seconds(value) for value in row.values())])
    warm = benchmark.program.run(path, ISOSURFACE)
    rows.append(["later run in the same process", "", report.seconds(warm["seconds"]),
                 report.seconds(warm["phases"]["program_build"])])
    out.table(["", "process", "run", "of it building or loading the program"], rows)
    return results


def reuse(benchmark):
    benchmark.report.heading("e. Reuse, growth, first start")
    return {"second_surface": second_surface(benchmark), "growth": growth(benchmark),
            "first_start": first_start(benchmark)}
