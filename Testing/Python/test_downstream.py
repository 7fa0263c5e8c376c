# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs users' filters on a closed surface, and on one with a trimmed border."""
import unittest

from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPlane
from vtkmodules.vtkFiltersCore import (vtkCleanPolyData, vtkClipPolyData, vtkContourFilter, vtkDecimatePro, vtkFeatureEdges,
                                       vtkPolyDataConnectivityFilter, vtkQuadricDecimation, vtkSmoothPolyDataFilter,
                                       vtkStripper, vtkTriangleFilter, vtkWindowedSincPolyDataFilter)
from vtkmodules.vtkFiltersModeling import (vtkButterflySubdivisionFilter, vtkFillHolesFilter, vtkLinearSubdivisionFilter,
                                           vtkLoopSubdivisionFilter)
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource

from marchingcorrectors import vtkMarchingCorrectors
from vtk_test import SPACING, lattice, particles_of, run

COUNT = 11


def extract(free_surface):
    places = lattice(COUNT, COUNT, COUNT, around_origin=True)
    source = vtkMarchingCorrectors()
    source.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "Height")
    return run(source, particles_of(places, Height=places[:, 2]), SmoothingLength=1.3 * SPACING, FreeSurface=free_surface,
               Value=(0, 0.05))[0]  # With other values vtkFillHolesFilter gives up where the border is nearly straight.


class TestDownstream(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.closed, cls.open = extract(True), extract(False)

    def apply(self, surface, kind, *calls):
        """Returns the output of a filter that must not complain. calls: (method, argument), ..."""
        step = kind()
        for name, *arguments in calls:
            getattr(step, name)(*arguments)
        output, told = run(step, surface)
        self.assertEqual(told, [], kind.__name__)
        return output

    def count_edges(self, surface, kind):
        calls = [(name + ("On" if name == kind else "Off"),)
                 for name in ("BoundaryEdges", "NonManifoldEdges", "FeatureEdges", "ManifoldEdges")]
        return self.apply(surface, vtkFeatureEdges, *calls).GetNumberOfCells()

    def test_cells_are_those_of_contour(self):
        contour = vtkContourFilter()
        image = vtkRTAnalyticSource()
        image.SetWholeExtent(-5, 5, -5, 5, -5, 5)
        contour.SetInputConnection(image.GetOutputPort())
        contour.SetValue(0, 150.0)
        contour.Update()
        wanted, ours = contour.GetOutput().GetPolys(), self.closed.GetPolys()
        self.assertGreater(wanted.GetNumberOfCells(), 0)
        self.assertEqual(*((cells.IsStorage64Bit(), cells.GetConnectivityArray().GetDataType()) for cells in (ours, wanted)))

    def test_edges(self):
        for surface, is_open in (self.closed, False), (self.open, True):
            self.assertGreater(surface.GetNumberOfCells(), 100)
            self.assertEqual(self.count_edges(surface, "BoundaryEdges") > 20 * is_open, is_open)
            self.assertEqual(self.count_edges(surface, "NonManifoldEdges"), 0)

    def test_counts(self):
        """Each filter makes from `low` to `high` cells of each cell: on the closed surface and, if `both`, on the open one."""
        for kind, call, low, high, both in (
                *((kind, ("SetNumberOfSubdivisions", 1), 4, 4, True) for kind in (
                    vtkLinearSubdivisionFilter, vtkLoopSubdivisionFilter, vtkButterflySubdivisionFilter)),
                *((kind, ("SetNumberOfIterations", 10), 1, 1, True) for kind in (vtkSmoothPolyDataFilter, vtkWindowedSincPolyDataFilter)),
                *((kind, ("SetTargetReduction", 0.5), 0.4, 0.6, False) for kind in (vtkDecimatePro, vtkQuadricDecimation)),
                (vtkPolyDataConnectivityFilter, ("SetExtractionModeToLargestRegion",), 1, 1, False)):
            for surface in (self.closed, self.open)[:1 + both]:
                with self.subTest(kind.__name__):
                    made = self.apply(surface, kind, call)
                    self.assertTrue(low <= made.GetNumberOfCells() / surface.GetNumberOfCells() <= high)
                    self.assertEqual(self.count_edges(made, "NonManifoldEdges"), 0)

    def test_fill_holes(self):
        filled = self.apply(self.open, vtkFillHolesFilter, ("SetHoleSize", 100.0))
        self.assertEqual(self.count_edges(filled, "BoundaryEdges"), 0)

    def test_clip(self):
        plane = vtkPlane()
        plane.SetNormal(1.0, 0.3, 0.0)
        half = self.apply(self.closed, vtkClipPolyData, ("SetClipFunction", plane))
        self.assertTrue(0 < half.GetNumberOfCells() < self.closed.GetNumberOfCells())
        self.assertAlmostEqual(half.GetBounds()[1], self.closed.GetBounds()[1])

    def test_rewriting(self):
        """vtkCleanPolyData rewrites cells but loses none: no triangle becomes a line or a point."""
        for surface in (self.closed, self.open):
            cells = surface.GetNumberOfCells()
            clean = self.apply(surface, vtkCleanPolyData, ("SetTolerance", 0.0))
            self.assertEqual(clean.GetNumberOfPolys(), cells)
            self.assertEqual(clean.GetNumberOfPoints(), surface.GetNumberOfPoints())
            strips = self.apply(surface, vtkStripper)
            self.assertTrue(0 < strips.GetNumberOfStrips() < cells)
            triangles = self.apply(strips, vtkTriangleFilter)
            self.assertEqual(triangles.GetNumberOfPolys(), cells)


if __name__ == "__main__":
    unittest.main()
