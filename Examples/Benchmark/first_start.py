#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""How long the first surface takes: whole processes, with empty caches; medians.

first_start.py PROGRAM [PARTICLES] [--runs N] [--device NAME]

first: the free surface. next: the same with another kernel. warm: the first once more.
"""
import argparse
import os
import statistics
import subprocess
import tempfile
import time

RUNS = (("first", []), ("next", ["--kernel", "wendland"]), ("warm", []))


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
    measure(parser.parse_args())


def measure(arguments):
    taken = {name: [] for name, _ in RUNS}
    for _ in range(arguments.runs):
        with tempfile.TemporaryDirectory() as folder:
            cache = os.path.join(folder, "pocl")
            os.mkdir(cache)
            environment = dict(os.environ, POCL_CACHE_DIR=cache,
                               XDG_CACHE_HOME=os.path.join(folder, "cache"))
            environment.pop("MCOR_CACHE_DIR", None)
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
