# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests python -m marchingcorrectors surface, gauge, slice, line: they write what the program writes, and refuse wrong options."""
import csv
import os
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np
import pyvista
from test_files import Case
from says import says  # after test_files, by which it is found

DAM = str(Path(os.environ["MCOR_TEST_DATA"]) / "dam_break_45k.vtp")
PROGRAM = os.environ.get("MCOR_TEST_PROGRAM")
FLUID = ["--fluid", "ParticleType=0"]


class Command(Case):
    def run_it(self, command, name, *words, program=(), status=0, given=DAM):
        """Runs the wheel's command and the program. Returns the paths of the files that they wrote. program: options that only the program
        gets; None: the program is not run."""
        path, other = (str(self.at(each)) for each in (name, "program_" + name))
        done = subprocess.run([sys.executable, "-m", "marchingcorrectors", command, given, path, *words],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, status, done.stderr)
        self.said = done.stderr
        if PROGRAM and status == 0 and program is not None:
            subprocess.run([PROGRAM, given, other, *words, *program], check=True, stdout=subprocess.DEVNULL)
        return path, other if PROGRAM else path

    def test_surface(self):
        for words, program in (([], ["--free-surface"]), (["--scalar", "Velocity", "--iso", "1,2", "--kernel", "wendland"], []),
                               (["--scalar", "Pressure"], [])):
            mine, its = map(pyvista.read, self.run_it("surface", "a.vtp", *FLUID, *words, program=program))
            self.assertGreater(mine.n_cells, 10000)
            self.assertEqual((mine.points.tobytes(), mine.faces.tolist()), (its.points.tobytes(), its.faces.tolist()))
            np.testing.assert_array_equal(mine["Velocity"], its["Velocity"])

    def test_ply(self):
        """The .ply file equals the program's byte for byte, with and without arrays."""
        for words in (["--free-surface"], ["--free-surface", "--smooth", "--iso", "0.4,0.5", "--curvature"],
                      ["--scalar", "Velocity", "--iso", "1"], ["--no-attributes", "--free-surface"], ["--scalar", "Pressure", "--iso", "500,900"],
                      ["--scalar", "Velocity", "--component", "1", "--iso", "-0.1,0.1"], ["--scalar", "Velocity", "--iso", "1,2"]):
            mine, its = (Path(path).read_bytes() for path in self.run_it("surface", "a.ply", *FLUID, "--cube-factor", "2", *words))
            self.assertEqual(b"property float Velocity_z\n" in mine, words[0] != "--no-attributes")
            self.assertTrue(mine == its, words)

    def test_lines(self):
        """Tables and .obj files of lines hold what the program's hold. A surface cannot be written as a
        table."""
        line = np.arange(20) * 0.1
        data = pyvista.PolyData(np.stack(np.meshgrid(line, line, [0.0]), -1).reshape(-1, 3))
        data["R"], data["V"] = np.linalg.norm(data.points - [0.9, 0.9, 0], axis=1), data.points
        data["=f"] = data["R"]
        given = str(self.at("in.vtp"))
        data.save(given)
        paths = self.run_it("surface", "a.csv", "--smoothing-length", "0.13", "--scalar", "R", "--iso", "0.4,0.6", given=given)
        mine, its = (Path(path).read_bytes() for path in paths)
        self.assertEqual(mine.splitlines()[0], its.splitlines()[0])
        self.run_it("surface", "a.ply", "--smoothing-length", "0.13", "--scalar", "R", status=1, given=given)
        self.assertIn("a.ply was not written, because .ply holds no lines", self.said)
        words = ["--smoothing-length", "0.13", "--scalar", "R"]
        for more, kinds in ((["--filled"], {"v", "vn", "f"}), ([], {"v", "l"})):
            mine, its = ([line.split() for line in Path(path).read_text().splitlines()] for path in self.run_it(
                "surface", "a.obj", *words, "--iso", "0.4,0.6", *more, given=given))
            for rows in (mine, its):
                self.assertEqual({row[0] for row in rows if row} - {"#"}, kinds)
            self.assertEqual(*([row[1:] for row in rows if row and row[0] in "lf"] for rows in (mine, its)))
        paths = self.run_it("surface", "a.csv", "--smoothing-length", "0.13", "--scalar", "R", "--iso", "0.4", given=given)
        mine, its = (list(csv.reader(Path(path).read_text().splitlines())) for path in paths)
        mine, its = ({column[0]: column[1:] for column in zip(*table)} for table in (mine, its))
        self.assertEqual(set(mine), set(its))
        self.assertLess({"Line", "X", "Y", "Z", "V:0", "V:2", "R", "'=f", "Normals:1"}, set(mine))
        for name, column in mine.items():
            found, wanted = ([float(value) for value in each] for each in (column, its[name]))
            if name == "R":  # At points the array is a mean, on the line the iso value.
                np.testing.assert_allclose(found, wanted, rtol=1e-6)
            else:
                self.assertEqual(found, wanted, name)
        self.assertGreater(len(mine["Line"]), 20)
        self.run_it("surface", "b.csv", *FLUID, status=1)
        self.assertIn("but this is a surface", self.said)

    def test_period_and_curvature(self):
        """The period comes from the file's field data. Points and curvatures equal the program's."""
        line = np.arange(12) * 0.1
        data = pyvista.PolyData(np.stack(np.meshgrid(line, line, line[:6]), -1).reshape(-1, 3))
        data.field_data["PeriodicBounds"] = [0, 1.2, 0, 1.2, 0, 0]
        for name in ("in.vtp", "in.vtk"):
            given = str(self.at(name))
            data.save(given)
            words = ["--smoothing-length", "0.13", "--periodic", "auto", "--curvature"]
            mine, its = map(pyvista.read, self.run_it("surface", "a.vtp", *words, program=["--free-surface"], given=given))
            self.assertEqual(mine.points.tobytes(), its.points.tobytes())
            self.assertAlmostEqual(mine.bounds[1] - mine.bounds[0], 1.2)
            np.testing.assert_array_equal(mine["MeanCurvature"], its["MeanCurvature"])

    def test_left_out(self):
        """Particles outside of ranges and bounds are left out. If an array has several ranges, a value in any one of them passes. A
        particle must pass for all arrays and bounds."""
        words = ["--within", "-inf,2,0.05,inf,-inf,inf", "--only", "Density=0:990", "--only", "Density=1000:2000", "--only",
                 "ParticleType=0"]
        mine, its = map(pyvista.read, self.run_it("surface", "a.vtp", *words, program=["--free-surface"]))
        self.assertGreater(mine.n_cells, 100)
        self.assertEqual(mine.points.tobytes(), its.points.tobytes())

    def test_particle_distance(self):
        """--dp and --coefh give h and volumes to DualSPHysics' particles without mass and density."""
        line = np.arange(16) * 0.02
        data = pyvista.PolyData(np.stack(np.meshgrid(line, line, line), -1).reshape(-1, 3))
        data["Idp"] = np.arange(data.n_points)
        data.save(self.at("in.vtk"))
        path, _ = self.run_it("gauge", "a.csv", "--dp", "0.02", "--coefh", "1.2", "--kernel", "wendland", "--gauge",
                              "up=0.15,0.15,-1:0.15,0.15,1", given=str(self.at("in.vtk")))
        with open(path) as file:
            self.assertAlmostEqual(float(next(csv.DictReader(file))["z"]), 0.31, delta=0.001)  # The level is half a spacing above the particles.

    def test_tables(self):
        words = [*FLUID, "--gauge", "tank=0.5,-0.05,0:0.5,1,0", "--gauge", "front=2.9,-0.05,0:2.9,1,0"]
        mine, its = (list(csv.DictReader(Path(path).read_text().splitlines())) for path in self.run_it("gauge", "a.csv", *words))
        self.assertEqual([row["gauge"] for row in mine], ["tank", "front"])
        for one, other in zip(mine, its):
            for name in one:
                self.assertEqual(one[name] == "", other[name] == "", name)
                if name in ("first", "depth", "crossings", "y") and one[name]:
                    self.assertAlmostEqual(float(one[name]), float(other[name]), places=6)

    def test_film(self):
        """A gauge measures all steps of a file, each at its time."""
        line, path = np.arange(-4, 5) * 0.1, self.at("in.xyz")
        block = np.stack(np.meshgrid(line, line, line), -1).reshape(-1, 3)
        path.write_text("".join(f"{len(block)}\nProperties=pos:R:3 Time={0.5 * i}\n"
                                + "".join(f"{x} {y} {z + 0.2 * i}\n" for x, y, z in block) for i in range(2)))
        words = ["--smoothing-length", "0.13", "--gauge", "up=0,0,-1:0,0,2"]
        mine, its = (list(csv.DictReader(Path(table).read_text().splitlines()))
                     for table in self.run_it("gauge", "a.csv", *words, given=str(path)))
        self.assertEqual([(row["time"], round(float(row["z"]), 1)) for row in mine], [("0.0", 0.5), ("0.5", 0.7)])
        for one, other in zip(mine, its):
            self.assertAlmostEqual(float(one["z"]), float(other["z"]), places=6)

    def test_fields(self):
        mine, its = map(pyvista.read, self.run_it("slice", "a.vti", *FLUID, "--slice", "z=0", "--resolution", "80"))
        self.assertEqual(mine.dimensions, its.dimensions)
        valid = mine["vtkValidPointMask"] == 1
        self.assertGreater(valid.sum(), 100)
        np.testing.assert_array_equal(valid, its["vtkValidPointMask"] == 1)
        np.testing.assert_allclose(mine["Velocity"][valid], its["Velocity"][valid], rtol=1e-4, atol=1e-4)
        mine, its = map(pyvista.read, self.run_it("line", "a.vtp", *FLUID, "--line", "-1,0,0,3,0,0", "--resolution", "50"))
        np.testing.assert_allclose(mine.points, its.points, atol=1e-6)
        np.testing.assert_array_equal(mine["vtkValidPointMask"], its["vtkValidPointMask"])
        self.run_it("line", "a.vtp", *FLUID, "--line", "9,9,9,10,10,10", "--quiet")
        self.assertRegex(self.said, "^marchingcorrectors: warning: " + says("POINTS_DRY") + "\n$")

    def test_sentences(self):
        for words, sentence in ((["--field", "sum"], "--field is not for the free surface"),
                                (["--mass", "Msas"], "Did you mean 'Mass'"),
                                (["--periodic", "auto"], "give no period: .* Give --periodic in numbers"),
                                (["--dp", "1", "--smoothing-length", "1"], "leave one of them out"), (["--coefh", "1"], "--coefh needs --dp"),
                                (["--wall-share", "0.5", "--solids", "weight"], "--wall-share is for surfaces that end at walls"),
                                ([*FLUID, "--memory-limit", "1"], "Choose a larger --cube-size")):
            self.run_it("surface", "a.ply", *words, status=1)
            self.assertRegex(self.said, rf"^marchingcorrectors: .*{sentence}.*\n$")
        self.run_it("surface", "a.usdc", *FLUID, "--memory-limit", "1", status=1)
        self.assertRegex(self.said, "step 0 .*Choose a larger --cube-size")
        for words, sentence in ((["--screenshot", "a.png"], "--screenshot is for the program marching-correctors, not for surface; leave it out"),
                                (["--iso", "1", "--iso", "2"], "--iso is given twice"), (["--fps", "24", "--fps", "25"], "--fps is given twice"),
                                (["--cube-size", "abc"], "--cube-size: it must be a number, not 'abc'"),
                                (["--attributes", "Mass", "--no-attributes"], "--no-attributes: not allowed with argument --attributes"),
                                (["--within", "0,1;2"], "--within: it must be X0,X1,Y0,Y1,Z0,Z1, not '0,1;2'"),
                                (["--slice", "z=0"], "--slice is for slice, not for surface"),
                                (["--threads", "0"], "a whole number from 1, not '0'"), (["--memory-limit", "x"], "a whole number from 1, not 'x'"),
                                (["--smoth"], "there is no option --smoth. Did you mean '--smooth'?")):
            self.run_it("surface", "a.ply", *words, status=2)
            self.assertIn(sentence, self.said)
        self.run_it("gauge", "a.vtp", "--gauge", "a=0,0,0:0,0,1", *FLUID, status=1)
        self.assertIn("a .csv file, not 'a.vtp'", self.said)
        for command, place, sentence in (("slice", "z=0", "a .vti or .npz file, not 'a.x'"), ("line", "0,0,0,1,0,0", "a .vtp, .csv or .npz file, not 'a.x'")):
            self.run_it(command, "a.x", f"--{command}={place}", "--resolution", "9", *FLUID, status=1)
            self.assertIn(sentence, self.said)
        self.run_it("gauge", "a.csv", *["--gauge", "a=0,0,0:0,0,1"] * 2, *FLUID, status=1)
        self.assertIn("'a'", self.said)
        for points in ("0,0,0", "0,0,1,0,0,1"):
            self.run_it("line", "a.npz", "--line", points, *FLUID, status=1)
            self.assertIn("different points", self.said)
        self.run_it("slice", "a.npz", "--slice", "z=nan", status=2)
        self.assertIn("--slice: it must be AXIS=PLACE, not 'z=nan'", self.said)
        done = subprocess.run([sys.executable, "-m", "marchingcorrectors", "convert", "--help"], stdout=subprocess.PIPE, text=True)
        self.assertEqual((done.returncode, "--time-step" in done.stdout), (0, True))
        self.run_it("surface", "a.ply", "--preview", program=["--free-surface"])
        self.assertIn("--fluid ParticleType=VALUE", self.said)
        for words in (["--preview", "--tolerance", "0.1"], ["--cube-size", "0.1", "--cube-factor", "1"]):
            self.run_it("surface", "a.npz", *FLUID, *words, program=None)
            self.assertIn(f"{words[-2]} is not used, because {words[0]} is given", self.said)


if __name__ == "__main__":
    unittest.main()
