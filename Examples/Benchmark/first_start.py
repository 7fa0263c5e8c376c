#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""How long the first surface takes: whole processes, with empty caches; medians.

first_start.py PROGRAM [PARTICLES] [--runs N] [--device NAME]
first_start.py WHEEL.whl [--runs N]

first: the free surface. next: the same with another kernel. warm: the first once more.
Of a wheel, from import to the free surface of 45,000 generated particles, in a new environment that has the
wheel and NumPy alone; installing them is not timed.
"""
import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
import venv

RUNS = (("first", []), ("next", ["--kernel", "wendland"]), ("warm", []))

IN_PYTHON = """
import time
begin = time.perf_counter()
import numpy, marchingcorrectors
spacing = 1 / 60
places = numpy.stack(numpy.meshgrid(*map(numpy.arange, (60, 30, 25)), indexing="ij"), -1).reshape(-1, 3)
surface = marchingcorrectors.free_surface(places * spacing, smoothing_length=1.3 * spacing, volume=spacing ** 3)
assert len(surface.triangles) > 1000
print(time.perf_counter() - begin)
"""


def seconds(command, environment):
    start = time.perf_counter()
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("particles", nargs="?",
                        default=os.path.join(here, "..", "Data", "dam_break_45k.vtp"))
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--device", default="built in")
    arguments = parser.parse_args()
    if arguments.program.endswith(".whl"):
        measure_wheel(arguments)
    else:
        measure(arguments)


def measure_wheel(arguments):
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = os.path.join(folder, "bin", "python")
        subprocess.run([python, "-m", "pip", "install", "-q", arguments.program], check=True, stdout=sys.stderr)
        taken = [float(subprocess.run([python, "-c", IN_PYTHON], check=True, capture_output=True, text=True).stdout)
                 for _ in range(arguments.runs)]
    print(f"import to first surface {statistics.median(taken):.2f} s  ({', '.join(f'{t:.2f}' for t in taken)})")


def measure(arguments):
    taken = {name: [] for name, _ in RUNS}
    for _ in range(arguments.runs):
        with tempfile.TemporaryDirectory() as folder:
            cache = os.path.join(folder, "pocl")
            os.mkdir(cache)
            environment = dict(os.environ, POCL_CACHE_DIR=cache,
                               XDG_CACHE_HOME=os.path.join(folder, "cache"))
            for name, options in RUNS:
                taken[name].append(seconds(
                    [arguments.program, arguments.particles, os.path.join(folder, "o.vtp"),
                     "--free-surface", "--fluid", "ParticleType=0",
                     "--device", arguments.device, *options], environment))
    for name, _ in RUNS:
        print(f"{name:6} {statistics.median(taken[name]):.2f} s  "
              f"({', '.join(f'{t:.2f}' for t in taken[name])})")


if __name__ == "__main__":
    main()
