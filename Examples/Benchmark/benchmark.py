#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of marching-correctors; see README.md beside it.

  benchmark.py PROGRAM [--tables a,b] [--sizes 60k,670k] [--runs 5] [--markdown FILE] [--json FILE]

  a   isosurface of a scalar, against vtkSPHInterpolator + vtkFlyingEdges3D
  b   free surface with one attribute and normals, against splashsurf
  c   Tables I to V of the paper, each figure beside the paper's
  d   phases against the device's measured bandwidth and peak
  e   reuse for other iso values and scalars, growth with the number of particles, first start

Times are medians over --runs, in seconds. Every measurement is a process of its own; reading the
particles and writing the surface are not timed. Memory is the largest resident set of the process.
"""
import argparse
import json
import math
import pathlib
import os
import platform
import sys
import tempfile

import comparison
import limits
import paper_tables
import report
import reuse
import sets
from program import Program

TABLES = {"a": comparison.isosurface, "b": comparison.free_surface, "c": paper_tables.paper_tables,
          "d": limits.limits, "e": reuse.reuse}
MIDDLE = 670000
QUICK_SIZES = (4000, 8000)
QUICK_PAPER = {"rings": 20000, "tsunami": 6000, "dam": 6000}


class Benchmark:
    """What the tables need: particle sets, the program, how often, how large, where to write."""

    def __init__(self, arguments, folder):
        self.report = report.Report()
        self.sets = sets.Folder(arguments.sets or folder / "sets")
        self.quick = arguments.quick
        self.runs = arguments.runs or (1 if self.quick else 5)
        self.sizes = sorted(arguments.sizes or (QUICK_SIZES if self.quick else
                                                (60000, 670000, 3000000, 10000000)))
        # Tables d and e look at one size more closely.
        self.middle = MIDDLE if MIDDLE in self.sizes else self.sizes[-1]
        self.paper_counts = dict(QUICK_PAPER if self.quick else {}, **arguments.paper_sizes)
        self.limit = arguments.limit
        self.program = Program(arguments.program, arguments.device, self.runs, folder)

    def describe(self):
        """Machine, device, versions."""
        out = self.report
        found = self.program.run(self.sets.get(sets.tank(self.sizes[0])), comparison.ISOSURFACE)
        device = self.program.helper("benchmark-limits", found["device"], found["platform"], 1)
        facts = {"machine": report.machine(),
                 "device": f"{found['device']}, {device['compute_units']} compute units",
                 "platform": found["platform"],
                 "limits": f"measured through {device['platform_version']}, {device['driver_version']}",
                 "program": f"{found['name']}, on VTK {found['vtk']}",
                 "python": platform.python_version(), **versions(), "runs": self.runs}
        out.text("# Benchmark")
        out.text()
        for name, fact in facts.items():
            out.text(f"- {name}: {fact}")
        return facts


def versions():
    """Of what is compared, as far as this Python has it."""
    import vtk
    found = {"VTK compared": vtk.vtkVersion.GetVTKVersion(), "splashsurf": "not installed"}
    try:
        from importlib.metadata import PackageNotFoundError, version
        found["splashsurf"] = version("pysplashsurf")
    except PackageNotFoundError:
        pass
    return found


def find_nonsense(value, path="results"):
    """Paths of numbers that no measurement gives."""
    if isinstance(value, dict):
        return [bad for key, v in value.items() for bad in find_nonsense(v, f"{path}.{key}")]
    if isinstance(value, (list, tuple)):
        return [bad for i, v in enumerate(value) for bad in find_nonsense(v, f"{path}[{i}]")]
    if isinstance(value, (int, float)) and not math.isfinite(value):
        return [path]
    return [path] if path.endswith("seconds") and not value > 0 else []


def parse(argv):
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)

    def names(text):
        chosen = text.split(",")
        if not set(chosen) <= set(TABLES):
            raise argparse.ArgumentTypeError(f"tables are {', '.join(TABLES)}")
        return sorted(chosen)

    def counts(text):
        return tuple(sets.count_of(word) for word in text.split(","))

    def paper_counts(text):
        chosen = dict(word.split("=") for word in text.split(","))
        if not set(chosen) <= set(paper_tables.PAPER):
            raise argparse.ArgumentTypeError(f"sets are {', '.join(paper_tables.PAPER)}")
        return {name: sets.count_of(count) for name, count in chosen.items()}

    parser.add_argument("program", help="the program marching-correctors, in its build tree")
    parser.add_argument("--tables", type=names, default=sorted(TABLES), help="default: all")
    parser.add_argument("--sizes", type=counts, help="particles; default 60k,670k,3M,10M")
    parser.add_argument("--paper-sizes", type=paper_counts, default={}, metavar="SET=COUNT,...",
                        help="table c: rings=10M,tsunami=1.2M,dam=670k; 0 leaves a set out")
    parser.add_argument("--runs", type=int, help="timed runs of each (default 5)")
    parser.add_argument("--limit", type=float, default=900, metavar="SECONDS",
                        help="a competitor that would take longer is left out (default 900)")
    parser.add_argument("--quick", action="store_true", help="tiny sets, one run: a test")
    parser.add_argument("--device", help="OpenCL device, see marching-correctors --list-devices")
    parser.add_argument("--sets", type=pathlib.Path, metavar="FOLDER",
                        help="keep particle sets here, and use those that are there already")
    parser.add_argument("--markdown", type=pathlib.Path, help="write what is printed to this file")
    parser.add_argument("--json", type=pathlib.Path, help="write all results to this file")
    return parser.parse_args(argv)


def main():
    arguments = parse(sys.argv[1:])
    with tempfile.TemporaryDirectory(prefix="mcor-benchmark-") as folder:
        benchmark = Benchmark(arguments, pathlib.Path(folder))
        results = {"facts": benchmark.describe()}
        for name in arguments.tables:
            results[name] = TABLES[name](benchmark)
            # Also after an interruption, what has been measured is there.
            if arguments.markdown:
                arguments.markdown.write_text("\n".join(benchmark.report.lines) + "\n")
            if arguments.json:
                arguments.json.write_text(json.dumps(results, indent=2) + "\n")
    nonsense = find_nonsense(results)
    if nonsense:
        sys.exit("benchmark.py: impossible figures: " + ", ".join(nonsense))


if __name__ == "__main__":
    main()
