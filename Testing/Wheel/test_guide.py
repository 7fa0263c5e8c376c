# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the guide's pages for Python: the blocks of python.md as they stand, and the recipes of readers-python.md on files in each code's layout.
Runs mypy --strict and pyright on their blocks and on a user's program: types are known, and mistakes are found. Runs the notebook of
Examples/Notebook in its own folder, as people do: it must print the texts and draw the pictures that are stored in it.

    test_guide.py write
stores what the notebook prints and draws now. Look at the pictures then.
"""
import base64
import io
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import nbformat
import numpy as np
import pyvista
from nbclient import NotebookClient
from PIL import Image
from python_page import run_blocks
from solver_files import SPACING
from test_files import DENSITY, MASS, X, write_gadget, write_phantom

SOURCES = Path(os.environ["MCOR_TEST_SOURCES"])
NOTEBOOK = SOURCES / "Examples" / "Notebook" / "dam_break.ipynb"
FENCE = re.compile(r"^```python(?: (\S+))?\n(.*?)^```$", re.M | re.S)


def blocks(page):
    return FENCE.findall((SOURCES / "Documentation" / "Guide" / page).read_text(encoding="utf-8"))


def recipes():
    scope = {}
    for _, text in blocks("readers-python.md"):
        exec(text, scope)
    return scope


DP = 0.0236


class Test(unittest.TestCase):
    def assert_ball(self, points, radius, tolerance=0.05):
        self.assertGreater(len(points), 300)
        self.assertLess(np.abs(np.linalg.norm(points, axis=1) - radius).max(), tolerance)

    def test_python_page(self):
        surface = run_blocks(SOURCES / "Documentation" / "Guide" / "python.md")  # It is a closed ball, whose normals point outwards.
        self.assert_ball(surface.points, np.sqrt(-np.log(0.7)))
        self.assertTrue(surface.statistics["is_closed"])
        self.assertGreater(np.einsum("ij,ij->i", surface.normals, surface.points).min(), 0)

    def test_files_page_and_the_package_page(self):
        with h5py.File("snapshot.hdf5", "w") as file:
            file.create_group("Header").attrs["Time"] = 0.5
            gas = file.create_group("PartType0")
            gas["Coordinates"], gas["Velocities"], gas["Density"] = X, X, 1e-4 / 1.5 * DENSITY
            gas["Masses"], gas["SmoothingLength"] = 1e-4 / 1.5 * MASS, np.full(len(X), 0.26)
        for page in ("files.md", "../../Python/README.md"):
            scope = {}
            for _, text in blocks(page):
                exec(text, scope)
            self.assert_ball(scope["surface"].points, 0.5)

    def test_gadget_and_swift(self):
        for swift in (False, True):
            for arepo in (False, True):
                write_gadget("snapshot.hdf5", swift=swift)
                if arepo:
                    with h5py.File("snapshot.hdf5", "a") as file:
                        del file["PartType0/SmoothingLengths" if swift else "PartType0/SmoothingLength"]
                found = recipes()["density_surface"]("snapshot.hdf5", 1.5)
                self.assert_ball(found.points, 0.5)
                if not arepo:
                    self.assertAlmostEqual(found.statistics["smoothing_length_min"], 0.13)

    def test_phantom(self):
        write_phantom("dump.h5")
        points = recipes()["density_surface"]("dump.h5", 1.5).points
        self.assert_ball(points, 0.5, tolerance=0.06)
        self.assertAlmostEqual(points[:, 0].min(), -0.5, delta=0.06)

    def test_dualsphysics(self):
        """On a dam break with walls, the recipe gives more drops a body of their own, and leaves fewer particles outside of the surface,
        than one volume for all particles."""
        particles = pyvista.read(SOURCES / "Examples" / "Data" / "dam_break_45k.vtp")
        bare = pyvista.PolyData(particles.points)
        bare["Rhop"] = particles["Density"]
        bare["Type"] = np.where(particles["ParticleType"] == 0, 3, 0).astype(np.uint8)
        bare.save("PartFluid.vtk")
        words = {"fluid": ("Type", 3), "smoothing_length": 1.2 * 3 ** 0.5 * DP, "sph_kernel": "wendland_c2"}
        (bodies, outside), (few, many) = self.measure(
            "DualSPHysics", pyvista.read("PartFluid.vtk"), lambda file: recipes()["dualsphysics"](file, DP), DP ** 3, words)
        self.assertGreater(bodies, 10 * few)
        self.assertLess(outside, 0.7 * many)

    def test_splishsplash(self):
        """On particles of a real run, the recipe leaves far fewer particles outside of the surface than one volume for all particles."""
        particles = pyvista.read(SOURCES / "Examples" / "Data" / "double_dam_break_small.vtp")
        bare = pyvista.PolyData(particles.points)
        bare["velocity"] = particles["Velocity"]
        bare.save("ParticleData_Fluid_26.vtk")
        (_, outside), (_, many) = self.measure(
            "SPlisHSPlasH", pyvista.read("ParticleData_Fluid_26.vtk"), lambda file: recipes()["splishsplash"](file, 0.025),
            0.8 * 0.05 ** 3, {"smoothing_length": 0.05})
        self.assertLess(outside, 0.01 * many)

    def test_splash(self):
        """Each recipe makes one body of each drop of one or two particles beside a block."""
        drops = np.array([[1.5 + i, 0.0, k] for i in range(4) for k in range(3)])
        particles = pyvista.PolyData(np.concatenate([X, drops, drops[::2] + [0, 0, SPACING]]))
        particles["Rhop"], particles["Mass"] = np.full((2, particles.n_points), 1000.0)
        particles["Type"] = np.full(particles.n_points, 3, np.uint8)
        for name, size in (("dualsphysics", SPACING), ("splishsplash", SPACING / 2)):
            self.assertEqual(bodies_of(recipes()[name](particles, size)), 1 + len(drops), name)

    def measure(self, name, file, recipe, volume, words):
        """Makes two surfaces: by a recipe, and with one volume for all particles. Returns (number of bodies, number of particles outside
        of the surface) of each surface."""
        rows = []
        for surface, more in ((recipe(file), {}), (file.sph.free_surface(volume=volume, **words), {"volume": volume})):
            weights = file.sph.probe(pyvista.PolyData(file.points), attributes=[], **words, **more)["WeightSum"]
            fluid = np.asarray(file["Type"]) == 3 if "Type" in file.point_data else np.ones(file.n_points, bool)
            rows.append((bodies_of(surface), int((weights[fluid] < 0.5).sum())))
        print(f"{name}: bodies and particles outside: computed {rows[0]}, one volume {rows[1]}")
        return rows


def bodies_of(surface):
    return int(surface.connectivity()["RegionId"].max()) + 1


BEGIN = """
import numpy as np
import marchingcorrectors as mc
x = np.zeros((3, 3))
"""
KNOWN = {"mc.isosurface(x, x[:, 0], 0.5, smoothing_length=1.0)": "Surface",
         "mc.free_surface(x, estimate_smoothing_length=True).points": "ndarray",
         "mc.probe(x, x, smoothing_length=1.0, attributes={'x': x})": "Samples",
         "mc.derivatives(x, {'x': x}, smoothing_length=1.0)": "Derivatives",
         "mc.project(x, mass=1.0, smoothing_length=1.0)": "Projection",
         "mc.gauge(x, {'mast': ([0, 0, 0], [0, 0, 1])}, smoothing_length=1.0)": "Gauges",
         "mc.flux(x, x, ('box', (0, 1, 0, 1, 0, 1)), smoothing_length=1.0)": "Fluxes",
         "mc.isosurface(mc.io.read('a.h5'), 'Density', 1.0, attributes=['Velocities'])": "Surface",
         "mc.io.read(['a.vtk', 'b.vtk'])['Density']": "ndarray",
         "mc.free_surface(x, smoothing_length=1.0).to_pyvista()": "PolyData",
         "mc.devices()": "list", "mc.Context('pocl')": "Context"}
WRONG = ("mc.isosurface(x, x[:, 0], 0.5, smoothing_lenght=1.0)", "mc.free_surfaces(x)",
         "mc.free_surface(x, smoothing_length=1.0, sph_kernel='wenland')")
PAGES = ("python.md", "files.md", "readers-python.md", "slices-and-derived-fields.md", "../../README.md",
         "../../Python/README.md")


def check(programs):
    """Returns what mypy --strict and pyright say of {file: text}, each as [(file, line, kind, sentence)]."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in programs.items():
            (Path(folder) / name).write_text(text)
        # Other packages may lack types, and functions in the guide need no annotations.
        words = ["--strict", "--disable-error-code=import-untyped", "--disable-error-code=no-untyped-def"]
        mypy = subprocess.run([sys.executable, "-m", "mypy", *words, *programs], cwd=folder, stdout=subprocess.PIPE, text=True)
        pyright = subprocess.run([sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "--outputjson", "."], cwd=folder, stdout=subprocess.PIPE,
                                 text=True).stdout
    found = re.findall(r"^(\w+\.py):(\d+): (error|note): (.*)", mypy.stdout, re.M)
    others = json.loads(pyright[pyright.index("{"):])["generalDiagnostics"]
    return ([(file, int(line), kind, text) for file, line, kind, text in found],
            [(Path(each["file"]).name, each["range"]["start"]["line"] + 1, each["severity"], each["message"])
             for each in others])


class Types(unittest.TestCase):
    def test_types(self):
        pages = {re.sub(r"\W", "_", page) + ".py": "\n".join(text for _, text in blocks(page)) for page in PAGES}
        self.assertTrue(all(pages.values()), pages)
        for said in check({"known.py": BEGIN + "".join(f"reveal_type({each})\n" for each in KNOWN),
                           "wrong.py": BEGIN + "\n".join(WRONG) + "\n", **pages}):
            errors = [each for each in said if each[2] == "error"]
            self.assertEqual([each[:2] for each in errors], [("wrong.py", line) for line in (5, 6, 7)], errors)
            told = [text for file, _, _, text in said if file == "known.py"]
            self.assertEqual(len(told), len(KNOWN), told)
            for (program, kind), text in zip(KNOWN.items(), told):
                self.assertIn(kind.lower(), text.lower(), program)


def texts(cell):
    """Returns the texts that the cell prints and shows, without what drivers write to stderr."""
    return "".join(output["text"] if output.output_type == "stream" else output.get("data", {}).get("text/plain", "")
                   for output in cell.get("outputs", []) if output.get("name") != "stderr"
                   and "image/png" not in output.get("data", {}))


def pictures(cell):
    return [np.asarray(Image.open(io.BytesIO(base64.b64decode(output["data"]["image/png"]))).convert("RGB"), float)
            for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]


def run(notebook):
    NotebookClient(notebook, timeout=900, kernel_name="python3",
                   resources={"metadata": {"path": str(NOTEBOOK.parent)}}).execute()
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if output.get("name") != "stderr"]
    return notebook


class Notebook(unittest.TestCase):
    def test_notebook(self):
        kept, now, drawn = nbformat.read(NOTEBOOK, 4), run(nbformat.read(NOTEBOOK, 4)), 0
        for old, new in zip(kept.cells, now.cells):
            self.assertEqual(texts(new), texts(old))
            self.assertEqual(len(pictures(new)), len(pictures(old)))
            for picture, expected in zip(pictures(new), pictures(old)):
                self.assertEqual(picture.shape, expected.shape)
                differ = np.mean(np.abs(picture - expected).max(axis=2) > 40)  # Renderers and fonts differ a little.
                background = np.mean((picture == picture[0, 0]).all(axis=2))
                self.assertTrue(differ < 0.05 and 0.3 < background < 0.97, (differ, background))
                drawn += 1
        self.assertTrue(drawn == 3 and NOTEBOOK.stat().st_size < 200_000, (drawn, NOTEBOOK.stat().st_size))


if __name__ == "__main__":
    if sys.argv[1:] == ["write"]:
        metadata = nbformat.read(NOTEBOOK, 4).metadata
        made = run(nbformat.read(NOTEBOOK, 4))
        made.metadata = metadata
        nbformat.write(made, NOTEBOOK)
    else:
        unittest.main()
