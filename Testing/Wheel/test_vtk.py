# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""PyVista and VTK of PyPI: the accessor, the filter beside the functions."""
import os
import re
import unittest
from pathlib import Path

import numpy as np
import pyvista
from vtkmodules.vtkCommonDataModel import vtkDataObject

import marchingcorrectors as mc
from filter_report import report_mesh
from marchingcorrectors import vtkMarchingCorrectors

DATA = Path(os.environ["MCOR_TEST_DATA"])
DAM = DATA / "dam_break_45k.vtp"
POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
FLUID = ("ParticleType", 0)


def run_filter(particles, **properties):
    extract = vtkMarchingCorrectors()
    extract.SetInputData(particles)
    scalar = properties.pop("scalar", "Velocity")
    extract.SetInputArrayToProcess(0, 0, 0, POINTS, scalar)
    extract.SetValue(0, properties.pop("value", 1.0))
    for name, value in properties.items():
        getattr(extract, "Set" + name)(value)
    extract.Update()
    return extract, pyvista.wrap(extract.GetOutput())


class Test(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.dam = pyvista.read(DAM)

    def test_class_is_that_of_python(self):
        self.assertIn("MarchingCorrectorsFilter", vtkMarchingCorrectors.__module__)
        import marchingcorrectors

        self.assertIs(marchingcorrectors.vtkMarchingCorrectors, vtkMarchingCorrectors)

    def test_accessor(self):
        surface = self.dam.sph.isosurface("Velocity", 1.0, fluid=FLUID)
        extract, expected = run_filter(self.dam, FluidArrayName="ParticleType")
        found, wanted = report_mesh(surface), report_mesh(expected)
        for part in ("points", "triangles"):
            self.assertEqual(found[part], wanted[part])
        for name in ("Normals", "ParticleType", "Pressure"):
            self.assertEqual(found["arrays"][name], wanted["arrays"][name])
        self.assertEqual(extract.GetUsedSmoothingLengthArrayName(), "SmoothingLength")
        names = self.dam.sph.isosurface("Velocity", 1.0, fluid=FLUID, attributes=["Pressure"]).point_data.keys()
        self.assertEqual(sorted(names), ["Normals", "Pressure"])
        with self.assertRaisesRegex(mc.InvalidArgument, "'Speed'.*Velocity"):
            self.dam.sph.isosurface("Speed", 1.0)
        with self.assertRaisesRegex(mc.InvalidArgument, "no smoothing length. .*estimate_smoothing_length=True"):
            pyvista.PolyData(self.dam.points).sph.free_surface(volume=1e-5)

    def test_box_and_period(self):
        small = pyvista.read(DATA / "double_dam_break_small.vtp")
        x0, x1, *others = small.bounds
        for properties, words in (({"UseBox": 1, "Box": (x0, (x0 + x1) / 2, -9, 9, -9, 9)},
                                   {"box": (x0, (x0 + x1) / 2, -9, 9, -9, 9)}),
                                  ({"PeriodicBounds": (x0 - 0.05, x1, 0, 0, 0, 0)},
                                   {"periodic": (x0 - 0.05, x1, 0, 0, 0, 0)})):
            extract, found = run_filter(small, scalar="Speed", value=1.5, **properties)
            expected = small.sph.isosurface("Speed", 1.5, **words)
            self.assertEqual(extract.GetErrorMessage(), "")
            self.assertEqual(found.points.tobytes(), expected.points.tobytes())
            self.assertNotEqual(found.points.tobytes(), small.sph.isosurface("Speed", 1.5).points.tobytes())
            self.assertTrue(extract.GetRunStatistics().HasArray("Box" if "box" in words else "PeriodicBounds"))
        self.assertRegex(run_filter(small, scalar="Speed", DetectPeriod=1)[0].GetErrorMessage(), "give no period")

    def test_other_methods(self):
        self.assertGreater(self.dam.sph.free_surface(fluid=FLUID, attributes=[]).n_cells, 10000)
        line = pyvista.Line((1.0, 0.1, 0.5), (2.0, 0.1, 0.5), resolution=20)
        found = self.dam.sph.probe(line, fluid=FLUID)
        self.assertEqual(found.n_points, line.n_points)
        self.assertTrue(found["vtkValidPointMask"].any())
        inside = found["vtkValidPointMask"] == 1
        self.assertTrue((np.linalg.norm(found["Velocity"][inside], axis=1) < 20).all())
        derived = self.dam.sph.derivatives("Velocity", fluid=FLUID)
        fluid = np.asarray(self.dam["ParticleType"]) == 0
        self.assertEqual(derived["Gradients"].shape, (self.dam.n_points, 9))
        strength = np.linalg.norm(derived["Vorticity"], axis=1)[fluid]
        self.assertGreater(np.corrcoef(strength, np.asarray(self.dam["VorticityMagnitude"])[fluid])[0, 1], 0.5)

    def test_properties_are_those_of_cxx(self):
        folder = Path(os.environ["MCOR_TEST_SOURCES"]) / "vtkMarchingCorrectors"
        headers = [(folder / name).read_text() for name in ("vtkSPHAlgorithm.h", "vtkMarchingCorrectors.h")]
        classes = [header[header.index("\nclass VTK"):] for header in headers]
        text, public = "".join(classes), "".join(each.split("\nprotected:")[0] for each in classes)
        names = {"Set" + name for name in re.findall(r"vtkSet(?:Clamp|StdStringFromChar|Vector\d)?Macro\((\w+)", text)}
        names |= {"Get" + name for name in re.findall(r"vtkGet(?:CharFromStdString|Vector\d)?Macro\((\w+)", text)}
        for kind, name in re.findall(r"^  vtkSPH(\w+)Macro\((\w+)", text, re.M):
            names |= {"Set" + name, "Get" + name, *([name + "On", name + "Off"] if "Flag" in kind else [])}
        names |= set(re.findall(r"^  (?:static )?[\w:\*]+ \*?((?:Set|Get|Add|Clear|List|Release|Generate)\w+)\(",
                                public, re.M))
        self.assertGreater(len(names), 100)
        # The wheel's filter runs in one process; the others are what panels of the C++ plugin begin with.
        names -= {"GetNextBounds", "GetNextEstimate"}
        lacking = sorted(name for name in names if "Partition" not in name and not hasattr(vtkMarchingCorrectors, name))
        self.assertEqual(lacking, [], "add them to the plugin's XML, or to MarchingCorrectorsFilter.py")
        constants = {name: int(value) for name, value in re.findall(r"^    ([A-Z]\w+) = (-?\d+)\b", public, re.M)}
        self.assertEqual(constants.pop("BY_PARTICLES"), 0)  # of the partition
        self.assertGreater(len(constants), 25)
        self.assertEqual({name: getattr(vtkMarchingCorrectors, name, None) for name in constants}, constants)
        defaults = re.findall(r"^  (?:int|double|vtkTypeBool) (\w+) = ([-\w.]+);", "".join(headers), re.M)
        defaults += re.findall(r"^  vtkSPH(?:Value|Clamp|Flag)Macro\((\w+),(?: \w+,)? ([-\w.]+)[,)]", text, re.M)
        self.assertGreater(len(defaults), 50)
        for name, value in defaults:
            if name == "NextIsoValue":  # no number where there is no input, in both
                continue
            if value.replace(".", "").replace("e-", "").isdigit() and hasattr(vtkMarchingCorrectors, "Get" + name):
                self.assertEqual(getattr(vtkMarchingCorrectors(), "Get" + name)(), float(value), name)


if __name__ == "__main__":
    unittest.main()
