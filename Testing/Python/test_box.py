# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests real data sets: a box beside them, how large surfaces are, and where they end at walls. oracle_data tests their points, core_box tests
boxes."""
import pathlib
import unittest

from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from marchingcorrectors import vtkMarchingCorrectors
from vtk_test import run, statistic, surface_of

DATA = pathlib.Path(__file__).resolve().parents[2] / "Examples" / "Data"


def read(name):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(DATA / name))
    reader.Update()
    return reader.GetOutput()


class TestBox(unittest.TestCase):
    def test_nothing_there(self):
        """A box far away has no surface, and that is no error."""
        extract, particles = vtkMarchingCorrectors(), read("bunny_splash_small.vtp")
        surface, told = run(extract, particles, FreeSurface=1, UseBox=1, Box=(50, 51, 0, 1, 0, 1))
        self.assertEqual((surface.GetNumberOfCells(), told), (0, []))
        self.assertTrue(surface.GetPointData().HasArray("Velocity"))
        self.assertEqual(len(run(extract, Box=(1, 0, 0, 1, 0, 1))[1]), 1)


class TestWalls(unittest.TestCase):
    def test_dam_break(self):
        arrays = {"OutputPointsPrecision": 1, "ComputeBoundaryFlag": 1, "ComputeWeightSum": 1, "FluidArrayName": "ParticleType",
                  "InputArrayToProcess": (0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "Velocity"), "Value": (0, 1.0)}
        extract, by_hand, data = vtkMarchingCorrectors(), vtkMarchingCorrectors(), read("dam_break_45k.vtp")
        self.assertEqual(extract.GetSolids(), extract.SOLIDS_AUTO)
        behind = run(extract, data, **arrays, Solids=extract.SOLIDS_WEIGHT)[0].GetNumberOfCells()
        self.assertEqual((extract.GetUsedMassArrayName(), extract.GetUsedDensityArrayName()), ("Mass", "Density"))
        self.assertEqual(statistic(extract, "SolidParticles"), 55348)
        self.assertTrue(8000 < behind < 20000)
        # By default a scalar's surface ends at the walls, so a part of it is missing.
        ending = run(extract, Solids=extract.SOLIDS_AUTO)[0]
        self.assertTrue(behind / 2 < ending.GetNumberOfCells() < behind)
        self.assertTrue(surface_of(ending) == surface_of(run(by_hand, data, **arrays, Solids=extract.SOLIDS_WALL)[0]))
        trimmed = run(extract, Solids=extract.SOLIDS_WEIGHT, BoundaryDetectionToEigenvalue=(), VertexThreshold=0.3,
                      ComputeBoundaryEigenvalue=1)[0]
        self.assertTrue(8000 < trimmed.GetNumberOfCells() < 20000)
        self.assertTrue(trimmed.GetPointData().HasArray("BoundaryEigenvalue"))
        closed = run(extract, FreeSurface=1)[0]
        x0, x1, _, _, z0, z1 = closed.GetBounds()
        self.assertTrue(closed.GetNumberOfCells() > 100000 and x0 > -0.05 and x1 < 3.27 and z0 > -0.55 and z1 < 0.55)
        before = surface_of(closed)
        self.assertTrue(surface_of(run(extract, Solids=extract.SOLIDS_AUTO)[0]) == before)  # The free surface stays as it was.


if __name__ == "__main__":
    unittest.main()
