#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a film of a splash in one .usdc file with the program's series of .vtp files: time, sizes, and peak memory.

    film.py PROGRAM [--steps 50,300] [--spacing 0.02]

The Python that runs it has the package with its extra [usd].
"""
import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np


def splash(spacing, seconds):
    """Returns positions and velocities: of a tank with a wave that runs outwards from the middle, and of drops that fly from it."""
    line = np.arange(0, 1, spacing)
    tank = np.stack(np.meshgrid(line, line, np.arange(0, 0.3, spacing)), -1).reshape(-1, 3)
    radius = np.hypot(tank[:, 0] - 0.5, tank[:, 1] - 0.5)
    share, phase = 0.2 * tank[:, 2] * np.exp(-3 * radius), 12 * radius - 8 * seconds
    still = np.zeros(len(tank))
    points = tank + np.stack([still, still, share * np.cos(phase)], axis=1)
    velocities = np.stack([still, still, 8 * share * np.sin(phase)], axis=1)
    random = np.random.default_rng(1)
    start = random.normal(size=(len(tank) // 30, 3)) * [1, 1, 0.5] + [0, 0, 2.5]
    origin = np.array([0.5, 0.5, 0.3]) + random.normal(size=start.shape) * [0.1, 0.1, 0.0]
    fall = np.array([0, 0, -9.81 * seconds])
    return np.concatenate([points, origin + start * seconds + fall * seconds / 2]), np.concatenate([velocities, start + fall])


def write(path, points, velocities, seconds):
    """Writes the particles of one step as a binary .vtk file. seconds: the step's time."""
    count = len(points)
    parts = ["# vtk DataFile Version 3.0\nsplash\nBINARY\nDATASET POLYDATA\nFIELD FieldData 1\nTimeValue 1 1 double\n",
             np.array([seconds], ">f8"), f"\nPOINTS {count} float\n", points.astype(">f4"), f"\nPOINT_DATA {count}\n"
             "VECTORS Velocity float\n", velocities.astype(">f4"), "\nSCALARS id int\nLOOKUP_TABLE default\n", np.arange(count).astype(">i4")]
    path.write_bytes(b"".join(part.encode() if isinstance(part, str) else part.tobytes() for part in parts))


def measure(command):
    """Returns (processor seconds, peak MiB) of a process."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{' '.join(command[:6])} ... failed")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--steps", default="50,300")
    parser.add_argument("--spacing", type=float, default=0.02)
    given = parser.parse_args()
    words = ["--smooth", "--smoothing-length", str(1.2 * given.spacing), "--mass", str(1000 * given.spacing ** 3), "--density", "1000"]
    print("| steps | particles | | seconds of a processor | MiB of files | MiB of memory |\n|---|---|---|---|---|---|")
    for count in map(int, given.steps.split(",")):
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder) / f"step_{i:04d}.vtk" for i in range(count)]
            for i, path in enumerate(paths):
                write(path, *splash(given.spacing, i * 0.6 / 50 % 0.6), i / 24)
            steps = [str(path) for path in paths]
            for name, command in ((".usdc", [sys.executable, "-m", "marchingcorrectors", "surface", *steps, folder + "/film.usdc", *words]),
                                  (".vtp", [given.program, *steps, folder + "/film.pvd", "--free-surface", *words])):
                seconds, memory = measure(command)
                size = sum(path.stat().st_size for path in Path(folder).glob("film*" + name)) / 2 ** 20
                print(f"| {count} | {len(splash(given.spacing, 0.0)[0])} | {name} | {seconds:.1f} | {size:.1f} | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
