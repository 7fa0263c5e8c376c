# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs marching-correctors and its helpers, and takes medians of what they report."""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

PHASES = ("input", "search_grid", "seeds", "extraction", "correction", "trimming", "output")


class Program:
    """marching-correctors; results are kept, so that tables may share a run."""

    def __init__(self, path, device, runs, folder):
        self.path = pathlib.Path(path).resolve()
        self.device = device
        self.runs = runs
        self.folder = folder
        self.surface = folder / "surface.vtp"  # of the last run
        self.known = {}

    def run(self, path, options, runs=None):
        """Medians of the timed runs: one process that extracts the surface once more than it is
        timed, each time from scratch but for the OpenCL program. The first, which loads that, is apart.
        A process before it builds the program, if that is not cached: the compiler takes memory."""
        runs = runs or self.runs
        key = (str(path), tuple(map(str, options)), runs)
        if key not in self.known:
            self.known[key] = self.measure(path, options, runs)
        return self.known[key]

    def measure(self, path, options, runs):
        print(f"marching-correctors {path.name} {' '.join(map(str, options))}", file=sys.stderr)
        self.start(path, options, 1)
        found = self.start(path, options, runs + 1)[0]
        first, *rest = found["runs"]
        seconds = [run["wall_seconds"] for run in rest]
        return {
            "name": found["program"], "vtk": found["vtk"], "device": found["device"],
            "platform": found["platform"], "parameters": found["parameters"],
            "seconds": statistics.median(seconds), "all": seconds, "first": first["wall_seconds"],
            "phases": {name: statistics.median(run["seconds"][name] for run in rest)
                       for name in (*PHASES, "program_build")},
            "statistics": found["statistics"], "triangles": found["statistics"]["triangles"],
            "bytes": found["peak_resident_bytes"]}

    def start(self, path, options, repeat, environment=None):
        """One process; its report, and the seconds from its start to its end."""
        report = self.folder / "statistics.json"
        device = ["--device", self.device] if self.device else []
        begin = time.perf_counter()
        process = subprocess.run(
            [self.path, path, self.surface, *map(str, options), *device, "--quiet",
             "--repeat", str(repeat), "--stats", report],
            stderr=subprocess.PIPE, text=True, env={**os.environ, **(environment or {})})
        seconds = time.perf_counter() - begin
        if process.returncode != 0:
            sys.exit(f"benchmark.py: {path.name} {' '.join(map(str, options))}: {process.stderr}")
        return json.loads(report.read_text()), seconds

    def helper(self, name, *arguments):
        """What a helper program reports; it is built beside marching-correctors."""
        helper = self.path.parent / name
        if not helper.exists():
            raise FileNotFoundError(f"{helper} is missing; the examples' build makes it")
        output = subprocess.run([helper, *map(str, arguments)], check=True, capture_output=True,
                                text=True).stdout
        return json.loads(output)


def need_surface(result, what):
    """The result; the benchmark ends where a measurement gave no surface."""
    if result["triangles"] == 0:
        sys.exit(f"benchmark.py: {what}: no surface")
    return result


def sum_of(result, *names):
    return sum(result["phases"][name] for name in names)
