#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Seconds for gauges, and for the free surface of the same particles, whole processes that read them both.

    gauges.py PROGRAM [--particles 670k] [--gauges 1000] [--runs 3] [--sets FOLDER]

Ends with an error where the gauges take longer."""
import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

from sets import Folder, count_of, read, tank

SIDE = 1000  # so many gauges at most along an axis


def seconds_of(command, runs):
    """The median; a process before loads the OpenCL program."""
    taken = []
    for _ in range(runs + 1):
        begin = time.perf_counter()
        subprocess.run(list(map(str, command)), check=True, stdout=subprocess.DEVNULL)
        taken.append(time.perf_counter() - begin)
    return statistics.median(taken[1:])


def write_gauges(path, count, bounds):
    """Upright ones, evenly over the particles; z is up."""
    columns = max(1, min(SIDE, round(count ** 0.5)))
    rows = -(-count // columns)
    with path.open("w", encoding="utf-8") as file:
        for i in range(count):
            place = [bounds[2 * a] + (n + 0.5) / of * (bounds[2 * a + 1] - bounds[2 * a])
                     for a, n, of in ((0, i % columns, columns), (1, i // columns, rows))]
            low, high = bounds[4], bounds[5] + 0.1 * (bounds[5] - bounds[4])
            file.write(f"g{i}={place[0]!r},{place[1]!r},{low!r}:{place[0]!r},{place[1]!r},{high!r}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--particles", type=count_of, default=670000)
    parser.add_argument("--gauges", type=int, default=1000)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--sets", type=pathlib.Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        particles = Folder(given.sets or folder).get(tank(given.particles))
        write_gauges(folder / "gauges.txt", given.gauges, read(particles).GetBounds())
        gauges = seconds_of([given.program, particles, folder / "levels.csv", "--gauges", folder / "gauges.txt"], given.runs)
        surface = seconds_of([given.program, particles, folder / "surface.vtp", "--free-surface"], given.runs)
        levels = (folder / "levels.csv").read_text().count(",wet,")
    print(f"{given.gauges} gauges ({levels} wet) on {given.particles} particles: {gauges:.2f} s; the free surface: {surface:.2f} s")
    return 0 if gauges < surface and levels > given.gauges / 2 else 1


if __name__ == "__main__":
    sys.exit(main())
