# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The real data sets: surfaces of boxes, which together are the whole surface, byte for byte; how large surfaces are, and where
they end at walls. The oracle has their points (oracle_data)."""
import itertools
import math
import pathlib
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
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


def triangles(surface):
    """Bytes of the points of each, with all of their arrays."""
    if surface.GetNumberOfCells() == 0:
        return []
    data = surface.GetPointData()
    arrays = [surface.GetPoints().GetData(), *map(data.GetArray, range(data.GetNumberOfArrays()))]
    columns = [vtk_to_numpy(array).reshape(array.GetNumberOfTuples(), -1).view(numpy.uint8) for array in arrays]
    ids = vtk_to_numpy(surface.GetPolys().GetConnectivityArray())
    return [corners.tobytes() for corners in numpy.concatenate(columns, axis=1)[ids.reshape(-1, 3)]]


def parts(cuts):
    """The intervals that planes cut an axis into."""
    sides = [-math.inf, *cuts, math.inf]
    return list(zip(sides, sides[1:]))


class TestBox(unittest.TestCase):
    def check(self, extract, *cuts):
        """cuts: the planes along x, y and z."""
        extract.ComputeBoundaryFlagOn()
        extract.ComputeWeightSumOn()
        extract.UseBoxOff()
        extract.Update()
        whole = sorted(triangles(extract.GetOutput()))
        self.assertGreater(len(whole), 1000)
        together, shares = [], []
        extract.UseBoxOn()
        for x, y, z in itertools.product(*map(parts, cuts)):
            extract.SetBox(*x, *y, *z)
            extract.Update()
            shares.append(extract.GetRunStatistics().GetArray("ParticlesInReach").GetValue(0))
            together += triangles(extract.GetOutput())
        self.assertEqual(len(together), len(whole))
        self.assertTrue(sorted(together) == whole)
        return shares

    def test_dam_break(self):
        """Walls, trimming, smoothing lengths that differ; two iso values."""
        extract = vtkMarchingCorrectors()
        extract.SetInputData(read("dam_break_45k.vtp"))
        extract.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "Velocity")
        extract.SetFluidArrayName("ParticleType")
        extract.SetSmoothingLengthArrayName("SmoothingLengthAdaptive")
        extract.SetValue(0, 1.0)
        extract.SetValue(1, 1.7)
        shares = self.check(extract, [0.5, 0.52, 2.4], [], [])
        self.assertLess(shares[1], 0.2 * 100228)
        extract.SetTopologyToField()
        self.check(extract, [1.61], [0.123], [0.5])

    def test_free_surfaces(self):
        """Computed volumes: those of particles in reach depend on others farther away."""
        extract = vtkMarchingCorrectors()
        extract.FreeSurfaceOn()
        for name, middle in (("double_dam_break_small.vtp", 0.2), ("bunny_splash_small.vtp", 0.1)):
            particles = read(name)
            for array in ("Mass", "Density"):
                particles.GetPointData().RemoveArray(array)
            extract.SetInputData(particles)
            with self.subTest(name):
                self.check(extract, [middle], [], [])
                self.check(extract, [middle], [0.1], [0.07])
                self.check(extract, [-99, 99], [0.13, 0.14], [])

    def test_nothing_there(self):
        """Far away there is no surface, and nothing to complain about."""
        extract, particles = vtkMarchingCorrectors(), read("bunny_splash_small.vtp")
        surface, told = run(extract, particles, FreeSurface=1, UseBox=1, Box=(50, 51, 0, 1, 0, 1))
        self.assertEqual((surface.GetNumberOfCells(), told), (0, []))
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
        # By default a scalar's surface ends at the walls, and only there is less of it.
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
        self.assertTrue(surface_of(run(extract, Solids=extract.SOLIDS_AUTO)[0]) == before)  # the free surface goes on as it did


if __name__ == "__main__":
    unittest.main()
