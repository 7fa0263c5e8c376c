#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What calling from Python costs: isosurface() on NumPy arrays beside marching-correctors itself, on the
same particles and device, by turns; and pysplashsurf's free surface beside free_surface().

    python_wheel.py PROGRAM [--particles 670000] [--runs 9] [--sets FOLDER]

Runs in an environment with marching-correctors[vtk] and, if it is to be compared, pysplashsurf.
Reading the particles is not timed. The surfaces must be the same to the last bit.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

import competitors
import marchingcorrectors
import sets

CASES = {
    "Swirl = 1.2": (["--scalar", "Swirl", "--iso", "1.2"], "Swirl", 1.2),
    "free surface": (["--free-surface"], None, 0.5),
}


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = {data.GetPointData().GetArrayName(i): vtk_to_numpy(data.GetPointData().GetArray(i))
              for i in range(data.GetPointData().GetNumberOfArrays())}
    return vtk_to_numpy(data.GetPoints().GetData()), arrays


def run_program(program, path, options, output):
    """Seconds of the second of two runs in a row in a process of its own: the first loads the OpenCL program."""
    report = output.with_suffix(".json")
    subprocess.run([program, path, output, *options, "--quiet", "--repeat", "2", "--stats", report], check=True)
    return json.loads(report.read_text())["runs"][1]["wall_seconds"]


def run_python(positions, arrays, scalar, iso, context):
    begin = time.perf_counter()
    words = {"smoothing_length": arrays["SmoothingLength"], "mass": arrays["Mass"], "density": arrays["Density"],
             "attributes": arrays, "context": context}
    surface = marchingcorrectors.free_surface(positions, iso=iso, **words) if scalar is None else \
        marchingcorrectors.isosurface(positions, arrays[scalar], iso=iso, **words)
    return time.perf_counter() - begin, surface


def compare(title, program, path, data, context, runs, folder):
    options, scalar, iso = CASES[title]
    output = folder / "surface.vtp"
    seconds = {"program": [], "python": []}
    run_python(*data, scalar, iso, context)  # compiles
    for _ in range(runs):
        seconds["program"].append(run_program(program, path, options, output))
        run_python(*data, scalar, iso, context)  # as the program's first
        elapsed, surface = run_python(*data, scalar, iso, context)
        seconds["python"].append(elapsed)
        context.release_memory()
    points, _ = read(output)
    same = points.tobytes() == surface.points.astype(points.dtype).tobytes()
    medians = {name: statistics.median(values) for name, values in seconds.items()}
    ratio = statistics.median(b / a for a, b in zip(seconds["program"], seconds["python"]))
    print(f"| {title} | {len(surface.triangles):,} | {medians['program']:.3f} | {medians['python']:.3f} | {ratio:.3f} "
          f"| {'the same' if same else 'DIFFERENT'} |", flush=True)
    return same


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--particles", type=int, default=670000)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--sets", type=pathlib.Path, help="keeps the particles for the next time")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = sets.Folder(arguments.sets or folder).get(sets.tank(arguments.particles))
        data = read(path)
        context = marchingcorrectors.Context()
        print(f"{len(data[0]):,} particles, {marchingcorrectors.devices()[0]}, {os.cpu_count()} processors, medians "
              f"of {arguments.runs} pairs\n")
        print("| | triangles | program, s | Python, s | Python / program | points |\n|---|---|---|---|---|---|")
        same = [compare(title, arguments.program, path, data, context, arguments.runs, folder) for title in CASES]
        other = competitors.measure("splashsurf", path, len(data[0]), max(1, arguments.runs // 3), 900, None)
    if "left_out" in other:
        print(f"\nsplashsurf: {other['left_out']}")
    else:
        print(f"\n{other['name']}, free surface, one attribute, normals, same cube size: {other['triangles']:,} "
              f"triangles, {other['seconds']:.3f} s")
    raise SystemExit(0 if all(same) else "The surfaces differ.")


if __name__ == "__main__":
    main()
