#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Two dimensions: an isoline of particles in a plane, against vtkSPHInterpolator with a kernel of two dimensions on the same
lattice, and vtkFlyingEdges2D. And the first line ever, from a cold start with an empty cache.

    plane.py marching-correctors [--particles 1000000] [--runs 3]

Figures are seconds of processors, of all threads, and in brackets of the clock; reading the particles is not among them, but
for the cold start. Medians of the runs."""
import argparse
import json
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import competitors
import sets

sys.path.insert(0, str(sets.GENERATORS))

SMOOTHING_LENGTH = 1.3  # the spacing is 1
ISO = 0.2


def make(path, count):
    """A jittered lattice with a scalar that winds."""
    import numpy

    import particle_file
    side = round(count ** 0.5)
    j, i = numpy.mgrid[0:side, 0:side]
    random = numpy.random.default_rng(1)
    x = numpy.zeros((side * side, 3), dtype=numpy.float32)
    for a, lattice in enumerate((i, j)):
        x[:, a] = lattice.ravel() + 0.3 * (random.random(side * side) - 0.5)
    u, v = x[:, 0] / side, x[:, 1] / side
    swirl = numpy.sin(6 * numpy.pi * u) * numpy.sin(4 * numpy.pi * v) + 0.2 * numpy.sin(20 * u + 13 * v)
    ones = numpy.ones(side * side, numpy.float32)
    arrays = {"Swirl": swirl.astype(numpy.float32), "Mass": ones, "Density": ones}
    particle_file.write(str(path), particle_file.poly_data(x, arrays))


def run_vtk(path):
    """In a process of its own: prints what it took."""
    import vtk
    particles = sets.read(path)
    image = competitors.lattice(particles, competitors.CUBE_FACTOR * SMOOTHING_LENGTH, 2)
    begin, cpu = time.perf_counter(), time.process_time()
    field = competitors.interpolator(particles, image, SMOOTHING_LENGTH, 2)
    contour = vtk.vtkFlyingEdges2D()
    contour.SetInputConnection(field.GetOutputPort())
    contour.SetInputArrayToProcess(0, 0, 0, 0, "Swirl")
    contour.SetValue(0, ISO)
    contour.Update()
    print(json.dumps({"seconds": time.perf_counter() - begin, "cpu": time.process_time() - cpu,
                      "cells": contour.GetOutput().GetNumberOfCells()}))


def children_cpu():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run_program(program, path, folder, repeat, environment=None):
    """Statistics, and seconds of processors and of the clock for all of the process."""
    statistics_file, before, begin = folder / "statistics.json", children_cpu(), time.perf_counter()
    subprocess.run([program, path, folder / "line.vtp", "--scalar", "Swirl", "--iso", str(ISO), "--smoothing-length",
                    str(SMOOTHING_LENGTH), "--no-attributes", "--quiet", "--repeat", str(repeat), "--stats", statistics_file], check=True,
                   env=environment)
    seconds, cpu = time.perf_counter() - begin, children_cpu() - before
    return json.loads(statistics_file.read_text()), cpu, seconds


def measure_program(program, path, folder):
    """Of a surface: of six of them less one, so that reading does not count."""
    more = 5
    _, once, once_seconds = run_program(program, path, folder, 1)
    found, many, many_seconds = run_program(program, path, folder, 1 + more)
    return {"seconds": (many_seconds - once_seconds) / more, "cpu": (many - once) / more, "cells": found["statistics"]["triangles_before_trimming"]}


def cold_start(program, folder):
    """Of 100,000 particles, everything: process, file in and out, kernels."""
    path = folder / "cold.vtp"
    make(path, 100000)
    environment = dict(os.environ, XDG_CACHE_HOME=str(folder / "empty"), POCL_CACHE_DIR=str(folder / "empty"))
    _, cpu, seconds = run_program(program, path, folder, 1, environment)
    return {"seconds": seconds, "cpu": cpu}


def median(runs, what):
    return statistics.median(run[what] for run in runs)


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "vtk":
        run_vtk(sys.argv[2])
        return
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--particles", type=int, default=1000000)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path = folder / "plane.vtp"
        make(path, options.particles)
        own, others = [], []
        for _ in range(options.runs):
            own.append(measure_program(options.program, path, folder))
            done = subprocess.run([sys.executable, __file__, "vtk", path], check=True, capture_output=True, text=True)
            others.append(json.loads(done.stdout))
        if not re.fullmatch(r"[1-9]\d*", str(own[0]["cells"])) or not others[0]["cells"]:
            raise SystemExit("no line was found")
        for label, runs in ("marching-correctors", own), ("vtkSPHInterpolator + vtkFlyingEdges2D", others):
            print(f"{label:38} {median(runs, 'cpu'):8.2f} s ({median(runs, 'seconds'):.2f} s), {runs[0]['cells']} lines")
        print(f"ratio {median(others, 'cpu') / median(own, 'cpu'):.1f}")
        cold = cold_start(options.program, folder)
        print(f"first line of 100,000 particles {cold['cpu']:.2f} s ({cold['seconds']:.2f} s)")


if __name__ == "__main__":
    main()
