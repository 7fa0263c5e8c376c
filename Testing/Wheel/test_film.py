# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests films in USD files, which usd-core reads back."""
import os
import re
import signal
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np
import pyvista
from pxr import Usd, UsdGeom, UsdValidation

import marchingcorrectors as mc
from marchingcorrectors import io
from marchingcorrectors._film import between
from marchingcorrectors._usd import Film, Spray
from solver_files import write_bgeo
from test_files import Case

PROGRAM = os.environ.get("MCOR_TEST_PROGRAM")
DX, SPIN, WORDS = 0.05, 2.0, ["--smoothing-length", "0.065", "--mass", "0.125", "--density", "1000"]


def drop(time=0.0, radius=8, at=(0.0, 0.0, 0.0)):
    """Returns the places and velocities of the particles of a drop that spins around z."""
    line = np.arange(-radius, radius + 1) * DX
    sites = np.stack(np.meshgrid(line, line, line), -1).reshape(-1, 3)
    sites = sites[(sites ** 2).sum(axis=1) < (radius * DX) ** 2]
    c, s = np.cos(SPIN * time), np.sin(SPIN * time)
    points = sites @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    return points + at, SPIN * np.stack([-points[:, 1], points[:, 0], 0 * points[:, 0]], axis=1)


def errors(stage):
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    return [error.GetMessage() for error in UsdValidation.ValidationContext(validators).Validate(stage)]


class Films(Case):
    def setUp(self):
        super().setUp()
        self.stages = []

    def at(self, name):
        return str(self.folder / name)

    def write_steps(self, times=(0.0, 0.1, 0.2), radius=8):
        paths = []
        for i, time in enumerate(times):
            points, velocities = drop(time, radius)
            data = pyvista.PolyData(points)
            data["Velocity"], data["id"], data["Big"] = velocities, np.arange(len(points)), np.full(len(points), 2 ** 40)
            data.field_data["TimeValue"] = [time]
            paths.append(self.at(f"step_{i + 9}.vtp"))  # step_10 comes after step_9
            data.save(paths[-1])
        return paths

    def run_it(self, *words, status=0):
        done = subprocess.run([sys.executable, "-m", "marchingcorrectors", *words], cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def open(self, name):
        stage = Usd.Stage.Open(self.at(name))
        self.stages.append(stage)  # Its prims end with it.
        self.assertEqual(errors(stage), [])
        self.assertEqual(stage.GetDefaultPrim().GetPath(), "/film")
        return stage, {prim.GetName(): prim for prim in stage.Traverse()}

    def values(self, prim, name, code):
        return np.array(prim.GetAttribute(name).Get(code))

    def test_steps(self):
        """Each time sample of the USD file holds the surface that mc.free_surface() makes of the step. Velocities are the field's values at
        the surface's points."""
        paths = self.write_steps()
        empty = pyvista.PolyData()
        empty.field_data["TimeValue"] = [0.3]
        empty.save(self.at("step_12.vtp"))
        said = self.run_it("surface", *sorted(paths), self.at("step_12.vtp"), "film.usdc", *WORDS, "--fps", "100",
                           "--up", "y", "--meters-per-unit", "0.01")
        self.assertRegex(said, "'Big' is left out of film.usdc")
        stage, prims = self.open("film.usdc")
        self.assertEqual((stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond(), stage.GetFramesPerSecond()),
                         (0, 30, 100, 100))
        self.assertEqual((UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)), ("Y", 0.01))
        mesh = prims["surface"]
        self.assertEqual(mesh.GetAttribute("subdivisionScheme").Get(), "none")
        np.testing.assert_allclose(mesh.GetAttribute("points").GetTimeSamples(), [0, 10, 20, 30])
        for path, code in zip(paths, (0, 10, 20)):
            particles = io.read(path)
            surface = mc.free_surface(particles, smoothing_length=0.065, mass=0.125, density=1000, attributes=["Velocity", "id"])
            points = self.values(mesh, "points", code)
            np.testing.assert_array_equal(points, surface.points.astype("f4"))
            np.testing.assert_array_equal(self.values(mesh, "faceVertexIndices", code), surface.triangles.ravel())
            self.assertEqual(set(self.values(mesh, "faceVertexCounts", code)), {3})
            self.assertEqual(3 * len(self.values(mesh, "faceVertexCounts", code)), surface.triangles.size)
            np.testing.assert_array_equal(self.values(mesh, "normals", code), surface.normals)
            np.testing.assert_allclose(self.values(mesh, "primvars:Velocity", code), surface.attributes["Velocity"], rtol=1e-6)
            np.testing.assert_array_equal(self.values(mesh, "primvars:id", code), surface.attributes["id"])
            np.testing.assert_allclose(self.values(mesh, "extent", code), [points.min(axis=0), points.max(axis=0)])
            velocities = self.values(mesh, "velocities", code)
            np.testing.assert_allclose(velocities, surface.attributes["Velocity"], rtol=1e-5)
            field = mc.probe(particles, surface.points, smoothing_length=0.065, mass=0.125, density=1000, attributes=["Velocity"])
            np.testing.assert_allclose(velocities, field.values["Velocity"], atol=1e-5)
            exact = SPIN * np.stack([-points[:, 1], points[:, 0], 0 * points[:, 0]], axis=1)
            self.assertLess(np.abs(velocities - exact).max(), 0.7 * DX * SPIN)  # The mean on one side belongs to a place farther inside.
        for name in ("points", "faceVertexCounts", "faceVertexIndices", "normals", "velocities", "primvars:id"):
            self.assertEqual(len(mesh.GetAttribute(name).Get(30)), 0, name)
        self.assertNotIn("primvars:Big", [each.GetName() for each in mesh.GetAttributes()])

    def test_between_steps(self):
        """Tests frames between two steps, with particles that move on circles. Slow motion has a mesh for each frame,
        and velocities per second of the film."""
        self.write_steps(times=(0.0, 0.1))
        steps = [self.at(f"step_{i}.vtp") for i in (9, 10)]
        self.run_it("surface", *steps, "a.usdc", *WORDS, "--times", "0.03,0:0.1:0.05", "--fps", "100")
        self.run_it("surface", *steps, "b.usdc", *WORDS, "--slow", "2", "--fps", "20")
        first, second = (self.open(name)[1]["surface"] for name in ("a.usdc", "b.usdc"))
        self.assertEqual(first.GetAttribute("points").GetTimeSamples(), [0, 3, 5, 10])
        self.assertEqual(second.GetAttribute("points").GetTimeSamples(), [0, 1, 2, 3, 4])
        np.testing.assert_array_equal(self.values(first, "points", 5), self.values(second, "points", 2))
        np.testing.assert_array_equal(self.values(first, "velocities", 5), 2 * self.values(second, "velocities", 2))
        self.assertEqual(self.values(first, "primvars:id", 3).tolist(), np.round(self.values(first, "primvars:id", 3)).tolist())
        for code in (3, 5):
            points, velocities = drop(code / 100)
            made = between(io.read(steps[0]), io.read(steps[1]), 0.0, 0.1, code / 100)
            np.testing.assert_allclose(made.positions, points, atol=1e-5)  # Points that move on straight lines would be off by 0.002.
            np.testing.assert_allclose(made["Velocity"], velocities, atol=0.005)
            surface = mc.free_surface(made, smoothing_length=0.065, mass=0.125, density=1000)
            np.testing.assert_array_equal(self.values(first, "points", code), surface.points.astype("f4"))
        few = io.Particles("few", "made", lambda: points[5:], {"id": lambda: np.arange(5, len(points)), "Velocity": lambda: velocities[5:]})
        self.assertEqual([len(between(io.read(steps[0]), few, 0.0, 0.1, time)) for time in (0.04, 0.06)], [len(points), len(points) - 5])
        for words, sentence in ((["--times", "0,0.3"], "0.3 lies beyond the last step"), (["--times", "-1,0"], "-1 lies before the first")):
            self.assertRegex(self.run_it("surface", *steps, "c.usdc", *WORDS, *words, status=1), sentence)
        for times in ("0:0.1:0", "0.2:0:0.1", "nan"):
            self.assertRegex(self.run_it("surface", *steps, "c.usdc", *WORDS, "--times", times, status=2), "--times: it must be T")
        data = pyvista.read(steps[0])
        data.point_data.remove("id")
        data.save(steps[0])
        self.assertRegex(self.run_it("surface", *steps, "c.usdc", *WORDS, "--times", "0.05", status=1), "step_9.vtp has no ids")

    def test_steps_without_particles(self):
        """A file without points is a step without fluid. If the first step of a list cannot be read, the others are made."""
        first, *_ = self.write_steps(times=[0.0])
        pyvista.PolyData().save(self.at("step_99.vtp"))
        self.run_it("surface", first, "step_99.vtp", "a.usdc", *WORDS, "--time-step", "1", "--fps", "1")
        Path(self.at("run.pvd")).write_text('<VTKFile type="Collection"><Collection>' + "".join(
            f'<DataSet timestep="{time}" file="{name}"/>' for time, name in enumerate(("gone.vtp", "step_9.vtp", "step_99.vtp"))) +
            "</Collection></VTKFile>")
        self.assertRegex(self.run_it("surface", "run.pvd", "b.usdc", *WORDS, "--fps", "1", status=1), "gone.vtp.*\\n(.*\\n)*.*lacks 1 of 3 steps")
        for name, codes in (("a.usdc", [0, 1]), ("b.usdc", [1, 2])):
            points = self.open(name)[1]["surface"].GetAttribute("points")
            self.assertEqual((points.GetTimeSamples(), len(points.Get(codes[0])) > 0, len(points.Get(codes[1]))), (codes, True, 0))

    def test_convert(self):
        """Converting the program's surfaces, given as a list or one by one, makes the same film as the command `surface`."""
        paths = self.write_steps()
        words = ["--smooth", *WORDS]
        if PROGRAM:
            subprocess.run([PROGRAM, *paths, self.at("film.pvd"), "--free-surface", *words, "--quiet"], check=True)
        else:
            self.skipTest("there is no program")
        self.run_it("surface", *paths, "one.usdc", *words)
        self.run_it("convert", "film.pvd", "two.usdc")
        self.run_it("convert", *(f"film_{i:04d}.vtp" for i in range(3)), "three.usda", "--time-step", "0.1", "--velocity", "Velocity")
        self.assertTrue(Path(self.at("three.usda")).read_bytes().startswith(b"#usda"))
        films = [self.open(name)[1]["surface"] for name in ("one.usdc", "two.usdc", "three.usda")]
        for name in ("points", "faceVertexIndices", "velocities", "normals", "primvars:id", "primvars:Widening"):
            for film in films[1:]:
                times = films[0].GetAttribute(name).GetTimeSamples()
                np.testing.assert_allclose(film.GetAttribute(name).GetTimeSamples(), times)
                self.assertEqual(len(times), 3)
                for time in times:
                    np.testing.assert_array_equal(self.values(film, name, time), self.values(films[0], name, time))
        self.assertRegex(self.run_it("convert", *paths, "no.usdc", status=1), "no triangles and no lines.*\n.*"
                         "no.usdc was not written")
        self.assertRegex(self.run_it("convert", "film_0000.vtp", "film.pvd", "film_0000.vtp", status=1), "would overwrite")

    def test_spray(self):
        """Particles in drops of fewer than N particles (--spray N, by default 8), and particles without a surface, become balls of
        spray. Larger drops and a bubble stay in the surface."""
        points = drop()[0]
        points = points[np.linalg.norm(points, axis=1) > 0.15]
        small = np.array([[0, 0, 0], [DX, 0, 0], [0, DX, 0]]) + [0.9, 0, 0]
        large = drop(radius=3, at=(0, 0.9, 0))[0]
        lone = np.array([[0.0, 0, 0.9]])
        every = np.concatenate([points, small, large, lone])
        data = pyvista.PolyData(every)
        data["Velocity"], data["Idp"] = every + 1, 100 + np.arange(len(every))
        data.save(self.at("in.vtp"))
        count = len(every)
        wanted = [*range(len(points), len(points) + 3), count - 1]
        ball, given = (6 / np.pi) ** (1 / 3) * DX, ["--volume", str(1.5 * DX ** 3)]  # With this volume small drops have no surface.
        for i, (words, there, width) in enumerate(((["--spray"], wanted, ball), (["--spray", "1"], [], ball),
                                                   (["--spray", "200"], [*range(len(points), count)], ball),
                                                   (["--spray", "1", *given], wanted, 1.5 ** (1 / 3) * ball))):
            self.run_it("surface", "in.vtp", f"film{i}.usdc", "--smoothing-length", str(1.3 * DX), *words)
            _, prims = self.open(f"film{i}.usdc")
            spray = prims["spray"]
            ids = self.values(spray, "ids", 0) - 100
            np.testing.assert_allclose(self.values(spray, "points", 0), every[ids], atol=1e-6)
            np.testing.assert_allclose(self.values(spray, "velocities", 0), every[ids] + 1, atol=1e-6)
            np.testing.assert_allclose(self.values(spray, "widths", 0), width, rtol=1e-6)
            self.assertEqual(ids.tolist(), there)
            mesh = self.values(prims["surface"], "points", 0)
            self.assertEqual((mesh[:, 0] > 0.7).any(), not there)
            self.assertEqual((mesh[:, 1] > 0.7).any(), len(there) < 5)
            self.assertTrue((np.linalg.norm(mesh, axis=1) < 0.2).any())
            self.assertEqual(len(np.unique(self.values(prims["surface"], "faceVertexIndices", 0))), len(mesh))
        for words, sentence in ((["8", "--scalar", "Idp", "--iso", "1"], "leave --scalar out"), (["0"], "from 1 on")):
            self.assertRegex(self.run_it("surface", "in.vtp", "no.usdc", *WORDS, "--spray", *words, status=1), sentence)

    def test_lines(self):
        line = np.arange(8) * 0.1
        points = np.stack(np.meshgrid(line, line, [0.0]), -1).reshape(-1, 3)
        with Film(self.at("lines.usdc"), slow=2) as film:
            for i in range(2):
                surface = mc.free_surface(points * (1 + i), smoothing_length=0.13 * (1 + i), attributes={"velocity": points})
                film.add(surface, i)
        _, prims = self.open("lines.usdc")
        curves = prims["lines"]
        self.assertNotIn("surface", prims)
        self.assertEqual([each.GetTypeName() for each in prims.values()], ["Xform", "BasisCurves"])
        self.assertEqual(self.values(curves, "curveVertexCounts", 48).tolist(), [len(each) for each in surface.lines])
        points, width = surface.points[surface.line_points], self.values(curves, "widths", 48)[0]
        np.testing.assert_allclose(self.values(curves, "points", 48), points, rtol=1e-6)
        np.testing.assert_allclose(self.values(curves, "extent", 48), [points.min(axis=0) - width / 2, points.max(axis=0) + width / 2],
                                   rtol=1e-6)
        self.assertTrue(0 < width < 0.1)
        np.testing.assert_allclose(2 * self.values(curves, "velocities", 48), surface.attributes["velocity"][surface.line_points], rtol=1e-6)
        self.assertFalse(curves.HasAttribute("primvars:velocity"))  # Blender would use it instead of the film's velocities.

    def test_save(self):
        """save() writes one surface as a film, and keeps arrays whose names USD does not allow, under other names."""
        points, velocities = drop()
        surface = mc.free_surface(points, smoothing_length=0.065, attributes={
            "a b": points[:, 0], "a_b": points[:, 1], "V": velocities, "matrix": np.zeros((len(points), 9)), "2": points[:, :2]})
        for name in ("a.usdc", "a.usda", "a.usd"):
            surface.save(self.at(name))
            mesh = self.open(name)[1]["surface"]
            np.testing.assert_allclose(self.values(mesh, "primvars:a_b", 0), surface.attributes["a b"], rtol=1e-6)
            np.testing.assert_allclose(self.values(mesh, "primvars:a_b_", 0), surface.attributes["a_b"], rtol=1e-6)
            np.testing.assert_allclose(self.values(mesh, "velocities", 0), surface.attributes["V"], rtol=1e-6)
            self.assertEqual(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("matrix").GetElementSize(), 9)
            self.assertEqual(self.values(mesh, "primvars:_2", 0).shape, (len(surface.points), 2))

    def test_changing_arrays(self):
        """An array that a step lacks has no value at its time, instead of the value of the step before."""
        points, velocities = drop(radius=3)
        with Film(self.at("a.usdc")) as film:
            for time, attributes in enumerate(({"a": points[:, 0]}, {"b": points[:, 0], "v": velocities}, {"a": points[:, 0]})):
                surface = mc.free_surface(points, smoothing_length=0.065, attributes=attributes)
                film.add(surface, time, spray=Spray(points[:time], np.ones(time)) if time else None)
        _, prims = self.open("a.usdc")
        for name, known in (("primvars:a", [True, False, True]), ("primvars:b", [False, True, False]),
                            ("velocities", [False, True, False])):
            found = [prims["surface"].GetAttribute(name).Get(24 * time) for time in range(3)]
            self.assertEqual([each is not None for each in found], known, name)
        self.assertEqual([len(self.values(prims["spray"], "points", 24 * time)) for time in range(3)], [0, 1, 2])

    def test_interrupted(self):
        """If Ctrl-C ends a film, the file holds the steps that were made. After any other error, the old file is there."""
        points = drop(radius=3)[0]
        surface = mc.free_surface(points, smoothing_length=0.065)
        Path(self.at("b.usdc")).write_text("old")
        with self.assertRaises(ZeroDivisionError), Film(self.at("b.usdc")) as film:
            film.add(surface, 0)
            film.add(surface, 1 / 0)
        self.assertEqual(Path(self.at("b.usdc")).read_text(), "old")

        def halt(*_):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt), Film(self.at("b.usdc")) as film:
            film.add(surface, 0)
            film.add(surface, 1)
            film._parts["surface"].make = halt  # Half of the step is written here.
            surface.attributes = {"late": surface.points[:, 0]}
            film.add(surface, 2)
        mesh = self.open("b.usdc")[1]["surface"]
        self.assertEqual(mesh.GetAttribute("points").GetTimeSamples(), [0, 24])
        self.assertEqual(mesh.GetAttribute("faceVertexIndices").GetTimeSamples(), [0, 24])

    def test_signal(self):
        paths = self.write_steps(np.arange(200) * 0.1, radius=4)
        run = subprocess.Popen([sys.executable, "-m", "marchingcorrectors", "surface", *paths, "film.usdc", *WORDS], cwd=self.folder,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(3):
            run.stdout.readline()
        run.send_signal(signal.SIGINT)
        run.communicate()
        self.assertEqual(run.returncode, 130)
        made = self.open("film.usdc")[1]["surface"].GetAttribute("points").GetTimeSamples()
        self.assertTrue(3 <= len(made) < 200, made)
        self.assertEqual([each for each in os.listdir(self.folder) if each.startswith(".")], [])

    def test_sentences(self):
        paths = self.write_steps(times=(0.0, 0.1))
        os.link(paths[0], self.at("link.usdc"))
        for words, sentence in ((["surface", *paths, "link.usdc", *WORDS], "link.usdc would overwrite the input"),
                                (["surface", paths[0], "a.ply", *WORDS, "--fps", "25"], "--fps is for films"),
                                (["surface", paths[0], "a.ply", *WORDS, "--spray"], "--spray is for films"),
                                (["surface", *paths, "a.usdc", *WORDS, "--velocity", "Velocty"], "Did you mean 'Velocity'"),
                                (["surface", *paths, "a.usdc", *WORDS, "--velocity", "id"], "'id' cannot be the velocity"),
                                (["surface", *paths, "a.usdc", *WORDS, "--fps", "0"], "fps is 0.0; it must be a number greater"),
                                (["surface", *paths, "a.usdc", *WORDS, "--time-step", "0"], "does not come after that of the step before"),
                                (["convert", paths[0], "a.vtp", "--up", "y"], "--up is for films")):
            self.assertRegex(self.run_it(*words, status=1), sentence)
        Path(self.at("step_10.vtp")).write_text("damaged")
        self.assertRegex(self.run_it("surface", *paths, "a.usdc", *WORDS, status=1),
                         r"step 1 \(step_10.vtp\): .*\n.*a.usdc lacks 1 of 2 steps")
        self.assertEqual(self.open("a.usdc")[1]["surface"].GetAttribute("points").GetTimeSamples(), [0])
        done = subprocess.run([sys.executable, "-c", "import sys; sys.modules['pxr'] = None\nfrom marchingcorrectors.__main__ import main\n"
                               f"sys.exit(main(['surface', {paths[0]!r}, 'b.usdc']))"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.assertEqual((done.returncode, done.stderr), (
            1, "marchingcorrectors: b.usdc needs the package usd-core, the extra [usd] of this one: pip install usd-core.\n"))

    def test_page(self):
        """Runs the commands of the guide's page on Blender, with the steps that the guide's page on films makes."""
        guide = Path(os.environ["MCOR_TEST_SOURCES"]) / "Documentation" / "Guide"
        steps = re.search(r"^```python steps.py\n(.*?)^```$", (guide / "films.md").read_text(), re.M | re.S)[1]
        subprocess.run([sys.executable, "-c", steps], cwd=self.folder, check=True)
        commands = re.findall(r"^    venv/bin/python -m marchingcorrectors (.*)$", (guide / "blender.md").read_text(), re.M)
        self.assertEqual([each.split()[0] for each in commands], ["surface", "convert", "convert"])
        film, line = self.at("film.usdc"), commands[0]
        for i, line in enumerate(commands):
            if i == 1:
                if not PROGRAM:
                    break
                subprocess.run(f"{PROGRAM} drop_*.vtk film.pvd --free-surface --quiet --time-step 0.1 " + " ".join(commands[0].split()[3:10]),
                               shell=True, cwd=self.folder, check=True)
            subprocess.run(f"{sys.executable} -m marchingcorrectors {line}", shell=True, cwd=self.folder, check=True,
                           stdout=subprocess.DEVNULL)
            os.rename(film, self.at(f"film{i}.usdc"))
            stage, prims = self.open(f"film{i}.usdc")
            self.assertEqual(stage.GetEndTimeCode(), 4.8)
            self.assertEqual(len(prims["surface"].GetAttribute("velocities").GetTimeSamples()), 3)

    def test_up(self):
        """The film's up axis is y if the solver of the input file uses y."""
        write_bgeo(self.at("in.bgeo"))
        self.run_it("surface", "in.bgeo", "film.usdc", "--smoothing-length", "estimate")
        stage, prims = self.open("film.usdc")
        self.assertEqual(UsdGeom.GetStageUpAxis(stage), "Y")
        self.assertGreater(len(self.values(prims["surface"], "velocities", 0)), 100)


if __name__ == "__main__":
    unittest.main()
