#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of marching-correctors; see README.md beside it.

  benchmark.py PROGRAM [--tables a,b] [--sizes 60k,670k] [--runs 5] [--particles FILE...] [-- OPTIONS OF THE PROGRAM]

Unless the docstring of a case says otherwise, times are medians over --runs, in seconds; each measurement of the program or of
other software is a process of its own; and reading the particles and writing the surface are not timed. Memory is the largest
resident set of the process. The docstring of a case says what the case measures and prints.
"""
import argparse
import collections
import json
import math
import pathlib
import platform
import sys
import tempfile

import cases
import paper_tables
import smooth
import tables
import vtk
from measure import Program, Report, Sets, count_of, machine

# sizes: numbers of particles; quick: the numbers of particles with --quick; runs: the usual value of --runs.
Case = collections.namedtuple("Case", "make title sizes quick runs", defaults=["670k", "6k", 3])
LARGE = "60k,670k,3M,10M"
CASES = {
    "a": Case(tables.isosurface, "isosurface of a scalar, against vtkSPHInterpolator + vtkFlyingEdges3D", LARGE, "4k,8k", 5),
    "b": Case(tables.free_surface, "free surface with one attribute and normals, against splashsurf", LARGE, "4k,8k", 5),
    "c": Case(paper_tables.paper_tables, "Tables I to V of the paper, each figure beside the paper's", LARGE, "4k,8k", 5),
    "adaptive": Case(cases.adaptive, "adaptive cubes against uniform ones; smoothing lengths 1:10 to 1:1000", "100k"),
    "cancel": Case(cases.cancel, "how long a run goes on after it is cancelled"),
    "distance": Case(cases.distance, "how far surfaces on adaptive and on uniform cubes are apart", "100k"),
    "plane": Case(cases.plane, "two dimensions, against vtkSPHInterpolator + vtkFlyingEdges2D", "1M"),
    "probe": Case(cases.probe, "a slice against vtkSPHInterpolator, and a volume", runs=5),
    "project": Case(cases.project, "column densities against sarracen; needs the wheel, and sarracen", "10k,100k", "1k,2k"),
    "ranks": Case(cases.ranks, "what processes under mpirun exchange, and a model of it", "50k,200k"),
    "smooth": Case(smooth.smooth, "how smooth free surfaces are, against splashsurf; with --particles processor times", runs=5),
    "walls": Case(cases.walls, "where surfaces end at walls"),
}
QUICK_PAPER = {"rings": 20000, "tsunami": 6000, "dam": 6000}


class Benchmark:
    """Holds what the cases need: the particle sets and their sizes, the program, the number of runs, and the report."""

    def __init__(self, arguments, folder):
        self.report, self.folder = Report(), folder
        self.sets = Sets(arguments.sets or folder / "sets")
        self.arguments, self.quick, self.limit = arguments, arguments.quick, arguments.limit
        self.files, self.more = arguments.particles, arguments.more
        self.paper_counts = dict(QUICK_PAPER if self.quick else {}, **arguments.paper_sizes)
        self.program = Program(arguments.program, arguments.device, 1, folder)
        self.choose("a")

    def choose(self, name):
        case, given = CASES[name], self.arguments
        self.runs = self.program.runs = given.runs or (1 if self.quick else case.runs)
        self.sizes = sorted(given.sizes or map(count_of, (case.quick if self.quick else case.sizes).split(",")))
        return case

    def describe(self):
        """Adds the machine, the device and the versions to the report. Returns {name: fact}."""
        found = self.program.run(self.sets.get("tank", self.sizes[0]), tables.ISOSURFACE)
        facts = {"machine": machine(), "device": found["device"], "platform": found["platform"],
                 "program": f"{found['name']}, on VTK {found['vtk']}", "python": platform.python_version(), **versions(),
                 "runs": self.runs}
        self.report.text("# Benchmark", "", *(f"- {name}: {fact}" for name, fact in facts.items()))
        return facts


def versions():
    """Returns the versions of VTK and splashsurf, with which this program is compared."""
    from importlib.metadata import PackageNotFoundError, version
    try:
        splashsurf = version("pysplashsurf")
    except PackageNotFoundError:
        splashsurf = "not installed"
    return {"VTK compared": vtk.vtkVersion.GetVTKVersion(), "splashsurf": splashsurf}


def find_nonsense(value, path="results"):
    """Returns the places, such as "results.a.seconds", of impossible figures: numbers that are not finite, and seconds that
    are not above 0."""
    if isinstance(value, dict):
        return [bad for key, v in value.items() for bad in find_nonsense(v, f"{path}.{key}")]
    if isinstance(value, (list, tuple)):
        return [bad for i, v in enumerate(value) for bad in find_nonsense(v, f"{path}[{i}]")]
    if isinstance(value, (int, float)) and not math.isfinite(value):
        return [path]
    return [path] if path.endswith("seconds") and not value > 0 else []


def parse(argv):
    def names(text):
        chosen = text.split(",")
        if not set(chosen) <= set(CASES):
            raise argparse.ArgumentTypeError(f"tables are {', '.join(CASES)}")
        return chosen

    def counts(text):
        return tuple(count_of(word) for word in text.split(","))

    def paper_counts(text):
        chosen = dict(word.split("=") for word in text.split(","))
        if not set(chosen) <= set(paper_tables.PAPER):
            raise argparse.ArgumentTypeError(f"sets are {', '.join(paper_tables.PAPER)}")
        return {name: count_of(count) for name, count in chosen.items()}

    own = argv[:argv.index("--")] if "--" in argv else argv
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n".join(f"  {name:9} {case.title}; {case.sizes} particles" for name, case in CASES.items()))
    parser.add_argument("program", help="the program marching-correctors")
    parser.add_argument("--tables", type=names, default=list("abc"), help="see below; default: a,b,c")
    parser.add_argument("--sizes", type=counts, help="particles")
    parser.add_argument("--paper-sizes", type=paper_counts, default={}, metavar="SET=COUNT,...",
                        help="table c: rings=10M,tsunami=1.2M,dam=670k; 0 leaves a set out")
    parser.add_argument("--particles", type=pathlib.Path, nargs="+", default=[], metavar="FILE",
                        help="for adaptive, cancel, distance, probe, smooth, walls")
    parser.add_argument("--runs", type=int, help="timed runs of each (default 5, or 3)")
    parser.add_argument("--seed", type=int, default=45, help="of the scenes of smooth (default 45)")
    parser.add_argument("--limit", type=float, default=900, metavar="SECONDS",
                        help="a competitor that would take longer is left out (default 900)")
    parser.add_argument("--quick", action="store_true", help="tiny sets, one run: a test")
    parser.add_argument("--device", help="OpenCL device, see marching-correctors --list-devices")
    parser.add_argument("--sets", type=pathlib.Path, metavar="FOLDER",
                        help="keep particle sets here, and use those that are there already")
    parser.add_argument("--markdown", type=pathlib.Path, help="write what is printed to this file")
    parser.add_argument("--json", type=pathlib.Path, help="write all results to this file")
    arguments = parser.parse_args(own)
    arguments.more = argv[len(own) + 1:]
    return arguments


def main():
    arguments, results = parse(sys.argv[1:]), {}
    with tempfile.TemporaryDirectory(prefix="mcor-benchmark-") as folder:
        benchmark = Benchmark(arguments, pathlib.Path(folder))
        if set(arguments.tables) & set("abc"):
            results["facts"] = benchmark.describe()
        for name in arguments.tables:
            results[name] = benchmark.choose(name).make(benchmark)
            # What has been measured is written, even after an interruption.
            if arguments.markdown:
                arguments.markdown.write_text("\n".join(benchmark.report.lines) + "\n")
            if arguments.json:
                arguments.json.write_text(json.dumps(results, indent=2) + "\n")
    nonsense = find_nonsense(results)
    if nonsense:
        sys.exit("benchmark.py: impossible figures: " + ", ".join(nonsense))


if __name__ == "__main__":
    main()
