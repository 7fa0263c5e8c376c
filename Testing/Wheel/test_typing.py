# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs mypy --strict and pyright on a user's program and on the guide's blocks: types are known, and mistakes are found."""
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from test_guide import blocks

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
        # Other packages have no types, and functions in the guide need none.
        words = ["--strict", "--disable-error-code=import-untyped", "--disable-error-code=no-untyped-def"]
        mypy = subprocess.run([sys.executable, "-m", "mypy", *words, *programs], cwd=folder, stdout=subprocess.PIPE, text=True)
        pyright = subprocess.run([sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "--outputjson", "."], cwd=folder, stdout=subprocess.PIPE,
                                 text=True).stdout
    found = re.findall(r"^(\w+\.py):(\d+): (error|note): (.*)", mypy.stdout, re.M)
    others = json.loads(pyright[pyright.index("{"):])["generalDiagnostics"]
    return ([(file, int(line), kind, text) for file, line, kind, text in found],
            [(Path(each["file"]).name, each["range"]["start"]["line"] + 1, each["severity"], each["message"])
             for each in others])


class Test(unittest.TestCase):
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


if __name__ == "__main__":
    unittest.main()
