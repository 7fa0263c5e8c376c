# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests PyVista's accessor, and that the wheel's filter has the C++ filter's methods and defaults. PyVista and VTK come from PyPI."""
import os
import re
import unittest
from pathlib import Path

import numpy as np
import pyvista
from vtkmodules.vtkCommonDataModel import vtkDataObject

import marchingcorrectors as mc
from marchingcorrectors import vtkMarchingCorrectors

DATA = Path(os.environ["MCOR_TEST_DATA"])
DAM = DATA / "dam_break_45k.vtp"
POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
FLUID = ("ParticleType", 0)


class Test(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.dam = pyvista.read(DAM)

    def test_class_is_that_of_python(self):
        self.assertIn("MarchingCorrectorsFilter", vtkMarchingCorrectors.__module__)
        import marchingcorrectors

        self.assertIs(marchingcorrectors.vtkMarchingCorrectors, vtkMarchingCorrectors)

    def test_accessor(self):
        names = self.dam.sph.isosurface("Velocity", 1.0, fluid=FLUID, attributes=["Pressure"]).point_data.keys()
        self.assertEqual(sorted(names), ["Normals", "Pressure"])
        with self.assertRaisesRegex(mc.InvalidArgument, "'Speed'.*Velocity"):
            self.dam.sph.isosurface("Speed", 1.0)
        with self.assertRaisesRegex(mc.InvalidArgument, "no smoothing length. .*estimate_smoothing_length=True"):
            pyvista.PolyData(self.dam.points).sph.free_surface(volume=1e-5)

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
        self.assertTrue((derived["Vorticity"][fluid] != 0).any())

    def test_keywords(self):
        """Properties also have the names that VTK 9.4 gives them (snake_case), and are keywords of the constructor."""
        surface = vtkMarchingCorrectors(free_surface=1, cube_size_factor=0.75, h_scale_factor=1.5, box=(0, 1, 0, 2, 0, 3))
        self.assertEqual((surface.GetFreeSurface(), surface.CubeSizeFactor, surface.GetHScaleFactor(), surface.box),
                         (1, 0.75, 1.5, (0, 1, 0, 2, 0, 3)))
        before = surface.GetMTime()
        surface.fluid_array_name = "ParticleType"
        self.assertGreater(surface.GetMTime(), before)
        self.assertEqual((surface.GetFluidArrayName(), surface.used_cube_size), ("ParticleType", 0.0))
        for name in ("Widening", "widening"):
            with self.assertRaises(ValueError):
                setattr(surface, name, "a")
            before = surface.GetMTime()
            setattr(surface, name, surface.GetWidening() + 1)
            self.assertGreater(surface.GetMTime(), before)
        self.assertEqual((surface.GetWidening(), surface.Widening), (3, 3))
        surface.AddOnly("h", 0, 1)
        surface.ExcludedArrays = ["h"]
        self.assertEqual((surface.Only, surface.ExcludedArrays, surface.GetExcludedArray(0)), ([("h", 0, 1)], ["h"], "h"))
        with self.assertRaises(AttributeError):
            surface.used_cube_size = 1.0
        with self.assertRaisesRegex(AttributeError, "'cube'"):
            vtkMarchingCorrectors(cube=1.0)
        with self.assertRaisesRegex(AttributeError, "'Update'"):  # a method, which must not be replaced
            vtkMarchingCorrectors(Update=1)

    def test_properties_are_those_of_cxx(self):
        folder = Path(os.environ["MCOR_TEST_SOURCES"]) / "vtkMarchingCorrectors"
        headers = [(folder / name).read_text() for name in ("vtkSPHAlgorithm.h", "vtkMarchingCorrectors.h")]
        classes = [header[header.index("\nclass VTK"):] for header in headers]
        text, public = "".join(classes), "".join(each.split("\nprotected:")[0] for each in classes)
        names = {"Set" + name for name in re.findall(r"vtkSet(?:Clamp|StdStringFromChar|Vector\d)?Macro\((\w+)", text)}
        names |= {"Get" + name for name in re.findall(r"vtkGet(?:CharFromStdString|Vector\d)?Macro\((\w+)", text)}
        for kind, name in re.findall(r"^  vtkSPH(\w+)Macro\((\w+)", text, re.M):
            names |= {"Get" + name, *(["Set" + name] if kind != "Told" else []),
                      *([name + "On", name + "Off"] if "Flag" in kind else [])}
        names |= set(re.findall(r"^  (?:static )?[\w:\*]+ \*?((?:Set|Get|Add|Clear|List|Release|Generate)\w+)\(",
                                public, re.M))
        self.assertGreater(len(names), 100)
        # The wheel's filter lacks methods for ranks, and methods that only C++ or the panels of the C++ plugin use.
        names -= {"GetNextBounds", "GetNextDensest", "GetNextEstimate", "SetWord"}
        lacking = sorted(name for name in names if not hasattr(vtkMarchingCorrectors, name))
        self.assertEqual(lacking, [])  # What is lacking belongs in the plugin's XML, or in MarchingCorrectorsFilter.py.
        constants = {name: int(value) for name, value in re.findall(r"^    ([A-Z]\w+) = (-?\d+)\b", public, re.M)}
        self.assertGreater(len(constants), 25)
        self.assertEqual({name: getattr(vtkMarchingCorrectors, name, None) for name in constants}, constants)
        defaults = re.findall(r"^  (?:int|double|vtkTypeBool) (\w+) = ([-\w.]+);", "".join([*headers, (folder / "vtkSPHParticlesChoice.h").read_text()]), re.M)
        defaults += re.findall(r"^  vtkSPH(?:Value|Clamp|Flag)Macro\((\w+),(?: \w+,)? ([-\w.]+)[,)]", text, re.M)
        self.assertGreater(len(defaults), 50)
        for name, value in defaults:
            if name == "NextIsoValue":  # Without input both have no number.
                continue
            if value.replace(".", "").replace("e-", "").isdigit() and hasattr(vtkMarchingCorrectors, "Get" + name):
                self.assertEqual(getattr(vtkMarchingCorrectors(), "Get" + name)(), float(value), name)


if __name__ == "__main__":
    unittest.main()
