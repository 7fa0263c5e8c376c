# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the same files to the wheel's filter, its accessor, the C++ filter and the program. Warnings, errors, arrays, bits and statistics must be the
same. The C++ filter runs in the Python that it was built for."""
import itertools
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
import pyvista
from filter_report import COSTS, report_mesh

import marchingcorrectors as mc

sys.path.insert(0, str(Path(__file__).parents[1]))
from says import TEXTS, says  # noqa: E402

DATA = Path(os.environ["MCOR_TEST_DATA"])
REPORT = Path(__file__).with_name("filter_report.py")
N = 14


def codes_of(sentence):
    """Returns the codes of the core's sentences in this one, or the sentence itself if it is not the core's."""
    return [code for code in TEXTS if re.search(says(code), sentence)] or sentence


def lattice(folder, name, arrays, fields=(), positions=None, h=0.13):
    """Writes a file of particles, moved a little from a lattice."""
    x = np.stack(np.meshgrid(*[np.arange(N)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.1 if positions is None \
        else positions
    x = x + np.random.default_rng(1).normal(0, 0.004, x.shape) * (positions is None)
    particles = pyvista.PolyData(x.astype(np.float32))
    particles["SmoothingLength"] = np.full(len(x), h, np.float32)
    for array, make in arrays.items():
        particles[array] = make(x)
    for field, values in dict(fields).items():
        particles.field_data[field] = values
    particles.save(folder / name)
    return str(folder / name)


def distance(x):
    return np.linalg.norm(x - 0.65, axis=1).astype(np.float32)


def component(axis, kind=np.float32):
    return lambda x: (x[:, axis] - 0.65).astype(kind)


PARTS = {"vx": component(0), "vy": component(1), "vz": component(2)}


def make_cases(folder):
    plane = np.stack(np.meshgrid(np.arange(40.0), np.arange(40.0), [0.0], indexing="ij"), -1).reshape(-1, 3) * 0.1
    sizes = np.concatenate([plane, 4 * plane + [4.2, 0.0, 0.0]])
    two = {"R": distance, "wide": lambda x: np.where(x[:, 0] < 4.0, 0.13, 0.52)}
    dam, small = str(DATA / "dam_break_45k.vtp"), str(DATA / "double_dam_break_small.vtp")
    fluid = {"FluidArrayName": "ParticleType"}
    r = {"R": distance}
    return {
        "as it is": [small, "Speed", 1.5, {}],
        "with walls": [dam, "Velocity", 1.0, fluid],
        "unused type": [dam, "Pressure", 2000.0, {"Kernel": 4}],
        "free surface": [dam, "", 0.0, {**fluid, "FreeSurface": 1, "Solids": 2}],
        "iso value": [lattice(folder, "a.vtp", r), "R", 99.0, {}],
        "neighbours": [lattice(folder, "b.vtp", r, h=0.3), "R", 0.4, {}],
        "one volume": [lattice(folder, "v.vtp", r), "R", 0.4, {"ParticleVolume": 1e-3}],
        "few neighbours": [lattice(folder, "c.vtp", r, h=0.07), "R", 0.4, {}],
        "plane": [lattice(folder, "d.vtp", r, positions=plane), "R", 1.0, {"Dimension": 3}],
        "tilted plane": [lattice(folder, "u.vtp", r, positions=plane @ [[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]]
                                 @ [[1.0, 0.0, 0.0], [0.0, 0.8, 0.6], [0.0, -0.6, 0.8]]), "R", 1.0, {}],
        "units": [lattice(folder, "e.vtp", {**r, "Mass": lambda x: np.full(len(x), 1e-9),
                                            "Density": lambda x: np.ones(len(x))}), "R", 0.4, {}],
        "all trimmed": [lattice(folder, "f.vtp", r), "R", 0.4, {"VertexThreshold": 5.0}],
        "velocity": [lattice(folder, "g.vtp", PARTS), "Velocity", 0.4, {}],
        "velocity of doubles": [lattice(folder, "h.vtp", {**PARTS, "vy": component(1, np.float64)}), "vx", 0.1, {}],
        "velocity there": [lattice(folder, "i.vtp", {**PARTS, "Velocity": distance}), "Velocity", 0.4, {}],
        "two parts": [lattice(folder, "j.vtp", {"vx": component(0), "vy": component(1)}), "Velocity", 0.4, {}],
        "bad attribute": [lattice(folder, "k.vtp", {**r, "T": lambda x: np.where(x[:, 0] > 1.2, np.nan, 1.0)}),
                          "R", 0.4, {}],
        "no length": [lattice(folder, "l.vtp", {"Rhop": distance, "Idp": lambda x: np.arange(len(x))}), "Rhop", 0.4,
                      {"SmoothingLengthArrayName": "nonsuch"}],
        "period": [lattice(folder, "m.vtp", r, {"boxsize": [1.4, 0.0, 0.0]}), "R", 0.4, {"DetectPeriod": 1}],
        "period of SPH-EXA": [lattice(folder, "n.vtp", r, {"box": [-0.05, 1.35, 0, 9, -0.05, 1.35],
                                                           "boundaryType": [1, 0, 1]}),
                              "R", 0.6, {"DetectPeriod": 1, "Capping": 1}],
        "no period": [lattice(folder, "o.vtp", {**r, "ParticleType": lambda x: (x[:, 0] < 0.3).astype(np.int32)},
                              {"BoxSize": [-1.0]}), "R", 0.4, {"DetectPeriod": 1}],
        "lines": [lattice(folder, "p.vtp", r, positions=plane), "R", 1.0, {}],
        "lines of two sizes": [lattice(folder, "q.vtp", two, positions=sizes), "R", 4.5,
                               {"SmoothingLengthArrayName": "wide", "CubeSizeMode": 1}],
        "lines in a box, capped": [lattice(folder, "t.vtp", two, positions=sizes), "R", 4.5,
                                   {"SmoothingLengthArrayName": "wide", "CubeSizeMode": 1, "UseBox": 1, "Capping": 1,
                                    "Box": [-1.0, 5.1, -1.0, 3.0, -1.0, 1.0]}],
        "filled": [lattice(folder, "r.vtp", r, positions=plane), "R", 1.0, {"Filled": 1, "CubeSizeMode": 1}],
        "walls in another plane, ignored": [lattice(folder, "s.vtp", {**r, "Wall": lambda x: x[:, 0] < 0.25},
                                                    positions=plane + [0.0, 0.0, 1.0] * (plane[:, :1] < 0.25)),
                                            "R", 1.0, {"FluidArrayName": "Wall", "Solids": 1}],
    }


def make_found(folder):
    """Sets of all kinds of which nothing is said: {name: [file, what --list-arrays says, what warnings say]}."""
    def of(name, arrays, fields=(), positions=None, kind=np.float32):
        x = np.stack(np.meshgrid(*[np.arange(9)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.1 if positions is None else positions
        x = (x + np.random.default_rng(2).normal(0, 0.004, x.shape) * (positions is None)).astype(kind)
        particles = pyvista.PolyData(x)
        for array, make in arrays.items():
            particles[array] = make(x) if callable(make) else np.full(len(x), make)
        for field, values in dict(fields).items():
            particles.field_data[field] = values
        file = folder / f"found {name}.vtp"
        particles.save(file)
        return str(file)

    def kinds(*values, kind=np.int32):
        return lambda x: np.resize(np.repeat(np.array(values, kind), 7), len(x))

    plane = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0), [0.5], indexing="ij"), -1).reshape(-1, 3) * 0.1
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


WANTED = {"no period": "'ParticleType' is not used", "unused type": "'ParticleType' is not used.*44880 x 0, 55348 x 1", "iso value": "Iso value 99 is outside",
          "neighbours": "neighbours within its support", "few neighbours": "not in the unit", "plane": "lie in a plane",
          "tilted plane": "tilted in space",
          "units": "node threshold", "all trimmed": "vertex threshold 5", "bad attribute": "'T' is NaN"}


# Maps the filter's properties to the program's options.
OPTIONS = {
    "FluidArrayName": lambda name: ["--fluid", name + "=0"], "FreeSurface": lambda on: ["--free-surface"],
    "Solids": lambda number: ["--solids", ["weight", "ignore", "wall", "auto"][number]],
    "Kernel": lambda number: ["--kernel", {4: "wendland"}[number]], "Dimension": lambda number: ["--dimension", str(number)],
    "VertexThreshold": lambda value: ["--vertex-threshold", str(value)],
    "SmoothingLengthArrayName": lambda name: ["--smoothing-length", name],
    "DetectPeriod": lambda on: ["--periodic", "auto"], "Capping": lambda on: ["--capping"],
    "CubeSizeMode": lambda number: ["--cubes", ["uniform", "adaptive"][number]], "UseBox": lambda on: [],
    "Box": lambda sides: ["--box=" + ",".join(map(str, sides))], "Filled": lambda on: ["--filled"],
}


class Test(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.cases = make_cases(Path(cls.folder.name))
        cls.wheel = cls.run_report(sys.executable, {})
        assert "MarchingCorrectorsFilter" in cls.wheel["class"], cls.wheel["class"]

    @classmethod
    def run_report(cls, python, environment, cases=None):
        file = Path(cls.folder.name) / "cases.json"
        file.write_text(json.dumps(list(cls.cases.values()) if cases is None else cases))
        done = subprocess.run([python, str(REPORT), str(file)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, env={**os.environ, **environment})
        assert done.returncode == 0, done.stderr[-3000:]
        line, = [line for line in done.stdout.splitlines() if line.startswith("report:")]
        return json.loads(line[len("report:"):])

    def test_warnings(self):
        for name, found in zip(self.cases, self.wheel["cases"]):
            if name in WANTED:
                self.assertEqual(len(found["warnings"]), 1, (name, found["warnings"]))
                self.assertRegex(found["warnings"][0], WANTED[name])
            else:
                self.assertEqual(found["warnings"], [], name)
            fails = name in ("two parts", "no length", "no period")
            self.assertEqual(bool(found["error"]), fails, (name, found["error"]))
            empty = fails or name in ("iso value", "units", "all trimmed")
            self.assertEqual("points" in found, not empty, name)
        velocity = self.wheel["cases"][list(self.cases).index("velocity")]["arrays"]
        self.assertTrue(velocity["Velocity"].startswith("float32 ("), velocity)
        doubles = self.wheel["cases"][list(self.cases).index("velocity of doubles")]["arrays"]
        self.assertTrue(doubles["Velocity"].startswith("float64 ("), doubles)

    @unittest.skipUnless(os.environ.get("MCOR_TEST_VTK_PYTHON"), "the C++ filter was built without Python")
    def test_as_in_cxx(self):
        cxx = self.run_report(os.environ["MCOR_TEST_VTK_PYTHON"], {"PYTHONPATH": os.environ["MCOR_TEST_VTK_PATH"]})
        self.assertNotIn("MarchingCorrectorsFilter", cxx["class"])
        for name, found, expected in zip(self.cases, self.wheel["cases"], cxx["cases"]):
            for part in sorted({*found, *expected}):
                self.assertEqual(found.get(part), expected.get(part), f"{name}: {part}")

    def test_found(self):
        """All that is found where nothing is given: by the filters of both languages, and by the program."""
        folder = Path(self.folder.name)
        sets = make_found(folder)
        cases = [[file, "", None, {"DetectFluid": detects, "FreeSurface": free}] for file, _ in sets.values()
                 for detects, free in ((1, 0), (0, 1))]
        python = self.run_report(sys.executable, {}, cases)["cases"]
        if os.environ.get("MCOR_TEST_VTK_PYTHON"):
            cxx = self.run_report(os.environ["MCOR_TEST_VTK_PYTHON"], {"PYTHONPATH": os.environ["MCOR_TEST_VTK_PATH"]}, cases)
            for case, found, expected in zip(cases, python, cxx["cases"]):
                self.assertEqual(found, expected, case)
        for i, (name, (file, listed)) in enumerate(sets.items()):
            found, free = python[2 * i]["found"], python[2 * i + 1]
            if listed is None or not os.environ.get("MCOR_TEST_PROGRAM"):
                continue
            said = subprocess.run([os.environ["MCOR_TEST_PROGRAM"], "--list-arrays", file], stdout=subprocess.PIPE, check=True,
                                  text=True).stdout
            self.assertIn(listed, said, name)
            told = dict(line.split("  ", 1) for line in said.splitlines() if "  " in line)
            told = {key: value.strip() for key, value in told.items()}
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
            output, statistics = folder / "program.vtp", folder / "program.json"
            subprocess.run([os.environ["MCOR_TEST_PROGRAM"], file, str(output), "--free-surface", "--stats", str(statistics)],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=True)
            self.assertEqual([re.sub(r"^the surface is empty: | \(--[^)]*\)|: --[^)]*(?=\))", "", each).split(". ")[0]
                              for each in json.loads(statistics.read_text())["warnings"] if "may be a period" not in each],
                             [each.split(". ")[0] for each in free["warnings"]], name)
        self.assertEqual(len(sets), 35)

    @unittest.skipUnless(os.environ.get("MCOR_TEST_PROGRAM"), "the program was not built")
    def test_program(self):
        """The program gives the filter's sentence, and adds how to set its own options, and that a surface is empty."""
        folder = Path(self.folder.name)
        for (name, (file, scalar, value, properties)), found in zip(self.cases.items(), self.wheel["cases"]):
            if not {*properties} <= {*OPTIONS}:
                continue
            output, statistics = folder / "program.vtp", folder / "program.json"
            output.unlink(missing_ok=True)
            words = [word for key, setting in properties.items() for word in OPTIONS[key](setting)]
            words += [] if "FreeSurface" in properties else ["--scalar", scalar, f"--iso={value}"]
            done = subprocess.run([os.environ["MCOR_TEST_PROGRAM"], file, str(output), "--stats", str(statistics), *words],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 1 if found["error"] else 0, f"{name}: {done.stderr}")
            if found["error"]:
                self.assertIn(re.split(r"[.:] ", found["error"])[0], done.stderr, name)
                continue
            run = json.loads(statistics.read_text())
            for mine, its in itertools.zip_longest(run["warnings"], found["warnings"], fillvalue=""):
                self.assertEqual(codes_of(mine), codes_of(its), name)
            mesh = report_mesh(pyvista.read(output))
            for part in sorted({"arrays", "points", "triangles", "lines"} & {*mesh, *found}):
                self.assertEqual(mesh.get(part), found.get(part), f"{name}: {part}")
            told = {"".join(part.capitalize() for part in number.split("_")): np.ravel(value).tolist()
                    for group in ("parameters", "statistics") for number, value in run[group].items()}
            self.assertEqual({key: value for key, value in told.items() if key in found["fields"] or key not in COSTS},
                             {key: value for key, value in found["fields"].items() if key in told}, name)

    def test_accessor(self):
        """The accessor makes the filter's triangles, names and sentences."""
        words_of = {"Kernel": lambda value: {"sph_kernel": value}, "Dimension": lambda value: {"dimension": value},
                    "VertexThreshold": lambda value: {"vertex_threshold": value},
                    "FluidArrayName": lambda value: {"fluid": (value, 0)},
                    "DetectPeriod": lambda value: {"periodic": "auto"}, "Capping": lambda value: {"capping": True},
                    "ParticleVolume": lambda value: {"volume": value}, "Box": lambda sides: {"box": sides},
                    "CubeSizeMode": lambda number: {} if number else {"level_limit": 0},
                    "SmoothingLengthArrayName": lambda value: {"smoothing_length": value}}
        compared = 0
        for (name, (file, scalar, value, properties)), found in zip(self.cases.items(), self.wheel["cases"]):
            words = {}
            for key, setting in properties.items():
                words.update(words_of.get(key, lambda setting: {})(setting))
            if {"FreeSurface", "Solids", "Filled"} & {*properties}:
                continue
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                try:
                    surface = pyvista.read(file).sph.isosurface(scalar, value, **words)
                except mc.Error as error:
                    self.assertTrue(found["error"], f"{name}: {error}")
                    continue
            self.assertEqual(found["error"], "", name)
            sentences = [str(warning.message) for warning in caught]
            self.assertEqual(len(sentences), len(found["warnings"]), (name, sentences))
            for mine, its in zip(sentences, found["warnings"]):
                if name == "bad attribute":
                    self.assertRegex(mine, says("ARRAY_LEFT_OUT", "'T'"))
                elif name == "unused type":
                    self.assertEqual(mine.split(". If")[0], its.split(". If")[0])
                    self.assertIn("choose fluid=('ParticleType', VALUE) ", mine)
                else:
                    self.assertEqual(codes_of(mine), codes_of(its))
            mesh = report_mesh(surface)
            for part in ("triangles", "lines"):
                self.assertEqual(mesh.get(part), found.get(part), f"{name}: {part}")
            computed = {scalar, scalar + "_Magnitude", "Normals"}  # The filter has the iso value in these.
            self.assertEqual(set(surface.point_data.keys()) | computed, set(found["arrays"]) | computed, name)
            compared += 1
        self.assertGreater(compared, 12)


if __name__ == "__main__":
    unittest.main()
