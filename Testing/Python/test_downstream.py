# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Users' filters behind the surface: a closed surface, and one with a trimmed border."""
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
        self.assertEqual(ours.IsStorage64Bit(), wanted.IsStorage64Bit())
        self.assertEqual(ours.GetConnectivityArray().GetDataType(),
                         wanted.GetConnectivityArray().GetDataType())

    def test_edges(self):
        self.assertGreater(self.closed.GetNumberOfCells(), 1000)
        self.assertEqual(self.count_edges(self.closed, "BoundaryEdges"), 0)
        self.assertEqual(self.count_edges(self.closed, "NonManifoldEdges"), 0)
        self.assertGreater(self.open.GetNumberOfCells(), 100)
        self.assertGreater(self.count_edges(self.open, "BoundaryEdges"), 20)
        self.assertEqual(self.count_edges(self.open, "NonManifoldEdges"), 0)

    def test_subdivision(self):
        for surface in (self.closed, self.open):
            for kind in (vtkLinearSubdivisionFilter, vtkLoopSubdivisionFilter,
                         vtkButterflySubdivisionFilter):
                with self.subTest(kind.__name__):
                    finer = self.apply(surface, kind, ("SetNumberOfSubdivisions", 1))
                    self.assertEqual(finer.GetNumberOfCells(), 4 * surface.GetNumberOfCells())

    def test_smoothing(self):
        for surface in (self.closed, self.open):
            for kind in (vtkSmoothPolyDataFilter, vtkWindowedSincPolyDataFilter):
                with self.subTest(kind.__name__):
                    smooth = self.apply(surface, kind, ("SetNumberOfIterations", 10))
                    self.assertEqual(smooth.GetNumberOfCells(), surface.GetNumberOfCells())
                    self.assertEqual(smooth.GetNumberOfPoints(), surface.GetNumberOfPoints())

    def test_decimation(self):
        for kind in (vtkDecimatePro, vtkQuadricDecimation):
            with self.subTest(kind.__name__):
                fewer = self.apply(self.closed, kind, ("SetTargetReduction", 0.5))
                ratio = fewer.GetNumberOfCells() / self.closed.GetNumberOfCells()
                self.assertTrue(0.4 < ratio < 0.6, ratio)
                self.assertEqual(self.count_edges(fewer, "NonManifoldEdges"), 0)

    def test_connectivity(self):
        part = self.apply(self.closed, vtkPolyDataConnectivityFilter,
                          ("SetExtractionModeToLargestRegion",))
        self.assertEqual(part.GetNumberOfCells(), self.closed.GetNumberOfCells())

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
