#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Adaptive cubes against uniform ones, and sets that only adaptive ones can treat.

  adaptive.py PROGRAM [PARTICLES -- OPTIONS OF THE PROGRAM] [--runs N]

With PARTICLES: triangles, and seconds of both, in turn. Without: seconds of a whole process, from its start to the
written surface, for 100,000 particles of Examples/Data/make_graded.py with smoothing lengths 1:10, 1:100, 1:1000.
Seconds are by the clock and of all processors; building of OpenCL programs is done before. Medians.
"""
import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

DATA = pathlib.Path(__file__).resolve().parent.parent / "Data"


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(arguments, particles, folder, options, repeat):
    """Seconds by the clock and of processors, the statistics of each run."""
    stats = folder / "stats.json"
    before = time.perf_counter(), processor_seconds()
    subprocess.run([arguments.program, particles, folder / "surface.vtp", "--quiet", "--repeat",
                    str(repeat), "--stats", stats, *options], check=True)
    seconds = time.perf_counter() - before[0], processor_seconds() - before[1]
    return seconds, json.loads(stats.read_text())


def compare(arguments, options, folder):
    """Each process extracts twice; its second surface is timed, the processors' time is a difference."""
    modes, took, triangles = ("uniform", "adaptive"), {}, {}
    for turn in range(arguments.runs + 1):  # the first one builds the programs
        for mode in modes:
            given = ["--cubes", mode, *options]
            once, _ = run(arguments, arguments.particles, folder, given, 1)
            twice, stats = run(arguments, arguments.particles, folder, given, 2)
            triangles[mode] = stats["statistics"]["triangles"]
            if turn > 0:
                took.setdefault(mode, []).append((stats["runs"][1]["wall_seconds"], twice[1] - once[1]))
    for mode in modes:
        wall, processor = (statistics.median(t[i] for t in took[mode]) for i in (0, 1))
        print(f"{mode:9}{triangles[mode]:>10} triangles {wall:8.3f} s, processors {processor:.3f} s")
    ratio = [statistics.median(u[i] / a[i] for u, a in zip(took["uniform"], took["adaptive"]))
             for i in (0, 1)]
    print(f"triangles {triangles['uniform'] / triangles['adaptive']:.1f} times fewer, "
          f"{ratio[0]:.1f} times faster, processors {ratio[1]:.1f}")


def whole_processes(arguments, options, folder):
    for ratio in (10, 100, 1000):
        particles = folder / f"graded_{ratio}.vtp"
        subprocess.run([sys.executable, DATA / "make_graded.py", "100000", particles, "--ratio",
                        str(ratio)], check=True, stdout=subprocess.DEVNULL)
        given = ["--cubes", "adaptive", *(options or ["--free-surface"])]
        runs = [run(arguments, particles, folder, given, 1) for _ in range(arguments.runs + 1)]
        wall, processor = (statistics.median(seconds[i] for seconds, _ in runs[1:]) for i in (0, 1))
        found = runs[-1][1]["statistics"]
        print(f"1:{ratio:<6}{found['fluid_particles']:>8} particles {found['triangles']:>9} triangles "
              f"{wall:8.3f} s, processors {processor:.3f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("particles", nargs="?")
    parser.add_argument("--runs", type=int, default=3)
    own = sys.argv[1:sys.argv.index("--")] if "--" in sys.argv else sys.argv[1:]
    arguments, options = parser.parse_args(own), sys.argv[len(own) + 2:]
    with tempfile.TemporaryDirectory() as folder:
        measure = compare if arguments.particles else whole_processes
        measure(arguments, options, pathlib.Path(folder))


if __name__ == "__main__":
    main()
