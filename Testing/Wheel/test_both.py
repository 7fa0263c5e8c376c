# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the same files to the wheel's filter, its accessor, the C++ filter and the program. What they find, warnings, errors, arrays, bits and
statistics must be the same. The C++ filter runs in the Python that it was built for."""
import json
import os
import re
import subprocess
import sys
import unittest
import warnings
from pathlib import Path

import numpy as np
import pyvista
from filter_report import COSTS, report_mesh

import marchingcorrectors  # noqa: F401  It makes the accessor .sph.
from test_files import Case, says
from says import TEXTS  # after test_files, by which it is found

DATA = Path(os.environ["MCOR_TEST_DATA"])
REPORT = Path(__file__).with_name("filter_report.py")
PROGRAM, CXX = os.environ.get("MCOR_TEST_PROGRAM"), os.environ.get("MCOR_TEST_VTK_PYTHON")


def codes_of(sentences):
    """Returns the code of each sentence that is the core's, and other sentences as they are."""
    return [next((code for code in TEXTS if re.search(says(code), sentence)), sentence) for sentence in sentences]


def lattice(*sides):
    return np.stack(np.meshgrid(*map(np.arange, sides), indexing="ij"), -1).reshape(-1, 3) * 0.1


def write(folder, name, arrays, fields=(), positions=None, sides=9, kind=np.float32):
    """Writes a file of particles, by default moved a little from a lattice. arrays: {name: one value, or a function of the positions}."""
    x = lattice(*[sides] * 3) if positions is None else positions
    x = (x + np.random.default_rng(2).normal(0, 0.004, x.shape) * (positions is None)).astype(kind)
    particles = pyvista.PolyData(x)
    for array, make in arrays.items():
        particles[array] = make(x) if callable(make) else np.full(len(x), make)
    for field, values in dict(fields).items():
        particles.field_data[field] = values
    particles.save(folder / f"{name}.vtp")
    return str(folder / f"{name}.vtp")


def make_cases(folder):
    """Returns {name: (file, scalar, iso value, filter's properties, program's words, accessor's keywords, codes of warnings)}. Words or keywords are
    None if the interface lacks the option."""
    plane = lattice(40, 40, 1)
    sizes = np.concatenate([plane, 4 * plane + [4.2, 0.0, 0.0]])
    dam, small = str(DATA / "dam_break_45k.vtp"), str(DATA / "double_dam_break_small.vtp")
    r = {"R": lambda x: np.linalg.norm(x - 0.65, axis=1), "h": 0.13}
    two = {**r, "h": lambda x: np.where(x[:, 0] < 4.0, 0.13, 0.52)}
    box = [-1.0, 5.1, -1.0, 3.0, -1.0, 1.0]

    def of(name, arrays, **more):
        return write(folder, name, arrays, sides=14, **more)

    return {
        "as it is": (small, "Speed", 1.5, {}, "", {}, []),
        "with walls": (dam, "Velocity", 1.0, {"FluidArrayName": "ParticleType"}, "--fluid ParticleType=0", {"fluid": ("ParticleType", 0)}, []),
        "free surface": (dam, "", 0.0, {"FluidArrayName": "ParticleType", "FreeSurface": 1, "Solids": 2},
                         "--fluid ParticleType=0 --free-surface --solids wall", None, []),
        "unused type": (dam, "Pressure", 2000.0, {"Kernel": 4}, "--kernel wendland", {"sph_kernel": 4}, ["TYPE_UNUSED"]),
        "one volume": (of("a", r), "R", 0.4, {"ParticleVolume": 1e-3}, None, {"volume": 1e-3}, []),
        "plane": (of("b", r, positions=plane), "R", 1.0, {"Dimension": 3}, "--dimension 3", {"dimension": 3}, ["PLANE_IN_SPACE"]),
        "all trimmed": (of("c", r), "R", 0.4, {"VertexThreshold": 5.0}, "--vertex-threshold 5", {"vertex_threshold": 5.0}, ["ALL_TRIMMED"]),
        "bad attribute": (of("d", {**r, "T": lambda x: np.where(x[:, 0] > 1.2, np.nan, 1.0)}), "R", 0.4, {}, "", {}, ["ARRAY_LEFT_OUT"]),
        "period": (of("e", r, fields={"box": [-0.05, 1.35, 0, 9, -0.05, 1.35], "boundaryType": [1, 0, 1]}), "R", 0.6,
                   {"DetectPeriod": 1, "Capping": 1}, "--periodic auto --capping", {"periodic": "auto", "capping": True}, []),
        "box": (of("f", two, positions=sizes), "R", 4.5, {"CubeSizeMode": 1, "UseBox": 1, "Capping": 1, "Box": box},
                "--cubes adaptive --capping --box=" + ",".join(map(str, box)), {"box": box, "capping": True}, []),
        "filled": (of("g", r, positions=plane), "R", 1.0, {"Filled": 1, "CubeSizeMode": 1}, "--filled --cubes adaptive", None, []),
        "walls elsewhere": (of("i", {**r, "Wall": lambda x: x[:, 0] < 0.25}, positions=plane + [0.0, 0.0, 1.0] * (plane[:, :1] < 0.25)),
                            "R", 1.0, {"FluidArrayName": "Wall", "Solids": 1}, "--fluid Wall=0 --solids ignore", None, [])}


def make_found(folder):
    """Makes files in which programs must find smoothing lengths, volumes, fluid and so on. Returns {name: [file, words that --list-arrays
    prints, or None]}."""
    def of(name, *arrays, **more):
        return write(folder, "found " + name, *arrays, **more)

    def kinds(*values, kind=np.int32):
        return lambda x: np.resize(np.repeat(np.array(values, kind), 7), len(x))

    plane = lattice(20, 20, 1) + [0.0, 0.0, 0.05]
    h, v, speed = {"h": 0.13}, {"Volume": 1e-3}, {"Speed": lambda x: x[:, 0]}
    m, rho, vector = {"Mass": 1.0}, {"Density": 1000.0}, {"Velocity": lambda x: x * [1, 2, 3]}
    parts = {"vx": lambda x: x[:, 0], "vy": lambda x: x[:, 1], "vz": lambda x: x[:, 2]}
    ids = {"Idp": lambda x: np.arange(len(x))}
    water, wall = of("water", {**h, **speed}), of("wall", {**h, "Mass": 2.0}, positions=plane)
    blocks = pyvista.MultiBlock({"water": pyvista.read(water), "Boundary": pyvista.read(wall)})
    blocks.save(folder / "blocks.vtm")
    sets = {
        "positions": ({}, "smoothing length  none"), "h": (h, "smoothing length  h"),
        "names": ({"Smoothing-Length": 0.13, "particle_volume": 1e-3, **speed}, "volume            particle_volume"),
        "ranks of names": ({"h": 0.2, "hsml": 0.13, "vol": 9.0, "Volume": 1e-3}, "smoothing length  hsml"),
        "volumes": ({**h, **v, **speed}, "volume            Volume"),
        "mass": ({**h, **m, **speed}, "computed from the positions and Mass"),
        "mass and density": ({**h, **m, **rho, **speed}, "Mass / Density"),
        "mass beside volumes": ({**h, **m, **rho, **v}, "volume            Volume"),
        "density alone": ({**h, **rho}, "computed from the positions\n"),
        "vector as mass": ({**h, "Mass": lambda x: x}, "computed from the positions\n"),
        "integers": ({"h": lambda x: np.full(len(x), 1, np.int16), "Volume": lambda x: np.full(len(x), 1, np.uint8),
                      "level": lambda x: (10 * x[:, 0]).astype(np.int64)}, "volume            Volume"),
        "floats and doubles": ({"h": lambda x: np.full(len(x), 0.13, np.float32), **m, "Rho": lambda x: np.full(
            len(x), 1e3, np.float32), "T": lambda x: x[:, 1].astype(np.float32)}, "Mass / Rho"),
        "parts of velocity": ({**h, **parts}, "velocity          vx, vy, vz as Velocity"),
        "parts beside a vector": ({**h, **parts, "vel": lambda x: x}, "velocity          vel"),
        "whole parts": ({**h, **parts, "vy": lambda x: np.arange(len(x))}, "velocity          none"),
        "velocity": ({**h, **vector, **ids}, "velocity          Velocity"), "ids": ({**h, **ids}, "velocity          none"),
        "constants": ({**h, "a": 1.0, "b": 2.0}, "fluid             all particles"),
        "text": ({**h, "name": lambda x: np.array(["gas"] * len(x))}, "not numbers"),
        "DualSPHysics": ({**ids, "Vel": lambda x: x, "Rhop": 1000.0, "Type": kinds(0, 1, 2, 3, kind=np.uint8)}, "fluid             Type = 3"),
        "fluid of two types": ({**h, **speed, "ParticleType": kinds(0, 1)}, "fluid             ParticleType = 0"),
        "is fluid": ({**h, **speed, "is_fluid": kinds(0, 1, kind=np.float64)}, "fluid             is_fluid = 1"),
        "types of three": ({**h, **speed, "Type": kinds(1, 2, 4)}, "fluid             all particles"),
        "one type": ({**h, **speed, "Type": kinds(3)}, "fluid             all particles"),
        "many types": ({**h, **speed, "Type": lambda x: np.arange(len(x)) % 9}, "fluid             all particles"),
        "halves": ({**h, **speed, "ptype": kinds(0, 0.5, 1, kind=np.float64)}, "fluid             all particles"),
        "no number as a type": ({**h, **speed, "type": kinds(0, np.nan, 1, kind=np.float32)}, "fluid             all particles"),
        "two arrays of types": ({**h, **speed, "Type": kinds(1, 2), "IsWall": kinds(0, 1)}, "fluid             IsWall = 0"),
        "PySPH": ({**h, "rho": 1e3, "m": 1.0, "gid": lambda x: np.arange(len(x)), "p": lambda x: x[:, 2]}, "m / rho"),
        "GADGET": ({"SmoothingLength": 0.13, "Masses": 1.0, "Density": 1e3, "ParticleIDs": lambda x: np.arange(len(x))},
                   "period            2,2,2 (field data BoxSize", {"BoxSize": [2.0]}),
        "SPH-EXA": ({**h, **parts}, "period            0,2,0,0,0,0", {"box": [0.0, 2, 0, 2, 0, 2], "boundaryType": [1, 0, 0]}),
        "six bounds": ({**h, **speed}, "field data PeriodicBounds", {"PeriodicBounds": [0, 2, 0, 0, 0, 0]}),
        "no period": ({**h, **speed}, "period            none", {"BoxSize": [-1.0]}),
        "plane": ({**h, **speed}, "dimension         2", (), plane),
    }
    return {**{name: [of(name, one[0], *one[2:]), one[1]] for name, one in sets.items()},
            "blocks": [str(folder / "blocks.vtm"), None]}


class Test(Case):
    def report(self, cases):
        """Returns the report of the wheel's filter on the cases. If there is a C++ filter, its report must be equal."""
        file, reports = self.folder / "cases.json", []
        file.write_text(json.dumps(cases))
        for python, environment in ((sys.executable, {}), (CXX, {"PYTHONPATH": os.environ.get("MCOR_TEST_VTK_PATH", "")}))[:2 if CXX else 1]:
            done = subprocess.run([python, str(REPORT), str(file)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                  env={**os.environ, **environment})
            self.assertEqual(done.returncode, 0, done.stderr[-3000:])
            line, = [line for line in done.stdout.splitlines() if line.startswith("report:")]
            reports.append(json.loads(line[len("report:"):]))
            self.assertEqual("MarchingCorrectorsFilter" in reports[-1]["class"], python != CXX)
        for case, *found in zip(cases, *(report["cases"] for report in reports)):
            self.assertEqual(found[0], found[-1], case)
        return reports[0]["cases"]

    def run_program(self, *words):
        done = subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_found(self):
        """If no option names an array, the filters of both languages and the program find the same fluid, arrays and dimension."""
        sets = make_found(self.folder)
        cases = [[file, "", None, {"DetectFluid": detects, "FreeSurface": free}] for file, _ in sets.values()
                 for detects, free in ((1, 0), (0, 1))]
        # What is found does not depend on what is missing or illegal.
        mass, types = (sets[name][0] for name in ("mass", "fluid of two types"))
        cases += [[mass, "Speed", 0.5, {"EstimateSmoothingLength": 1, "SmoothingLengthEstimate": 1, "NeighborRatio": ratio}] for ratio in (-float("inf"), -1.0, 0.0)]
        cases += [[types, "none", 0.0, {"DetectFluid": 1}], [types, "Speed", 0.5, {"FluidArrayName": "none"}]]
        python = self.report(cases)
        for i, (name, (file, listed)) in enumerate(sets.items()):
            found, free = python[2 * i]["found"], python[2 * i + 1]
            if listed is None or not PROGRAM:
                continue
            said = self.run_program("--list-arrays", file)
            self.assertIn(listed, said, name)
            told = {key: value.strip() for key, value in (line.split("  ", 1) for line in said.splitlines() if "  " in line)}
            fluid = found["NextFluid"]
            self.assertEqual(told["fluid"], f"{fluid} (give --fluid {fluid.replace(' ', '')})" if fluid else "all particles", name)
            self.assertEqual(told["smoothing length"].startswith("none"), bool(free["error"]), name)
            if free["error"]:
                continue
            self.assertEqual(told["dimension"], str(found["NextDimension"]), name)
            self.assertEqual(told["smoothing length"], found["UsedSmoothingLengthArrayName"], name)
            arrays = [found[f"Used{quantity}ArrayName"] for quantity in ("Volume", "Mass", "Density")]
            self.assertEqual(told["volume"], arrays[0] or (arrays[2] and " / ".join(arrays[1:]))
                             or "computed from the positions" + (arrays[1] and f" and {arrays[1]}"), name)
            statistics = self.folder / "program.json"
            self.run_program(file, self.folder / "program.vtp", "--free-surface", "--stats", statistics)
            told = [each for each in json.loads(statistics.read_text())["warnings"] if "may be a period" not in each]
            self.assertEqual(codes_of(told), codes_of(free["warnings"]), name)
        self.assertEqual(len(sets), 35)

    def test_given(self):
        """The same options give the same results in all interfaces."""
        cases = make_cases(self.folder)
        for (name, (file, scalar, value, properties, words, keywords, codes)), found in zip(
                cases.items(), self.report([case[:4] for case in cases.values()])):
            with self.subTest(name):
                self.assertEqual((codes_of(found["warnings"]), found["error"]), (codes, ""))
                self.assertEqual("points" in found, name != "all trimmed")
                if words is not None and PROGRAM:
                    self.check_program([file, *words.split(), *(["--scalar", scalar, f"--iso={value}"] if scalar else [])], found)
                if keywords is not None:
                    with warnings.catch_warnings(record=True) as caught:
                        warnings.simplefilter("always")
                        surface = pyvista.read(file).sph.isosurface(scalar, value, **{"level_limit": 0, **keywords} if "box" != name else keywords)
                    self.assertEqual(codes_of([str(each.message) for each in caught]), codes)
                    self.assertEqual({part: found.get(part) for part in ("triangles", "lines")},
                                     {part: report_mesh(surface).get(part) for part in ("triangles", "lines")})
                    computed = {scalar, scalar + "_Magnitude", "Normals"}  # In these arrays the filter has the iso value.
                    self.assertEqual(set(surface.point_data.keys()) | computed, set(found["arrays"]) | computed)

    def check_program(self, words, found):
        output, statistics = self.folder / "program.vtp", self.folder / "program.json"
        self.run_program(*words, output, "--stats", statistics)
        run, mesh = json.loads(statistics.read_text()), report_mesh(pyvista.read(output))
        self.assertEqual(codes_of(run["warnings"]), codes_of(found["warnings"]))
        for part in {"arrays", "points", "triangles", "lines"} & {*mesh, *found}:
            self.assertEqual(mesh.get(part), found.get(part), part)
        told = {"".join(part.capitalize() for part in number.split("_")): np.ravel(value).tolist()
                for group in ("parameters", "statistics") for number, value in run[group].items()}
        self.assertEqual({key: value for key, value in told.items() if key in found["fields"] or key not in COSTS},
                         {key: value for key, value in found["fields"].items() if key in told})


if __name__ == "__main__":
    unittest.main()
