# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The wrapped filter: weird input first, then what Python users do."""
import pathlib
import re
import tempfile
import unittest

import numpy
from vtkmodules.vtkCommonDataModel import VTK_HEXAHEDRON, VTK_VERTEX, vtkDataObject, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkMassProperties
from vtkmodules.vtkFiltersGeneral import vtkTableToPolyData
from vtkmodules.vtkIOInfovis import vtkDelimitedTextReader

from marchingcorrectors import vtkMarchingCorrectors
from vtk_test import SPACING, add, blocks_of, bytes_of, lattice, particles_of, points_of, run, values_of

X = lattice(11, 11, 11, around_origin=True)
RADIUS = numpy.linalg.norm(X, axis=1)
CELLS = 1331 * (SPACING / 0.065) ** 3  # a particle on this lattice takes 0.1^3


def make_particles(chosen=slice(None), **arrays):
    """Radius is the distance from the origin."""
    return particles_of(X[chosen], Radius=RADIUS[chosen], hsml=numpy.full(len(X[chosen]), 1.3 * SPACING), **arrays)


def make_filter(particles=None, scalar="Radius", iso=0.3):
    result = vtkMarchingCorrectors()
    result.SetInputData(make_particles() if particles is None else particles)
    result.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, scalar)
    result.SetValue(0, iso)
    return result


class TestFilter(unittest.TestCase):
    def good(self, extract, data=None, **settings):
        """The surface of a run that says nothing."""
        surface, told = run(extract, data, **settings)
        self.assertEqual((told, extract.GetErrorMessage()), ([], ""))
        return surface

    def assert_same(self, found, expected):
        """As many cells in the same place."""
        self.assertGreater(found.GetNumberOfCells(), 100)
        self.assertEqual((found.GetNumberOfPoints(), found.GetNumberOfCells(), found.GetBounds()),
                         (expected.GetNumberOfPoints(), expected.GetNumberOfCells(), expected.GetBounds()))

    def test_something_weird(self):
        self.assertEqual(self.good(make_filter(vtkPolyData())).GetNumberOfPoints(), 0)

    def test_error_is_a_sentence(self):
        extract = make_filter(scalar="Nonsense")
        surface, told = run(extract)
        self.assertEqual((surface.GetNumberOfPoints(), len(told)), (0, 1))
        self.assertRegex(extract.GetErrorMessage(), "'Nonsense'.*Radius")

    def read_table(self, particles, digits):
        """The particles after a table of numbers with so many digits, by VTK's reader."""
        rows = numpy.column_stack([points_of(particles), values_of(particles, "Radius"), values_of(particles, "hsml")])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "particles.csv"
            numpy.savetxt(file, rows, f"%.{digits}g", ",", header="x,y,z,Radius,hsml", comments="")
            reader, points = vtkDelimitedTextReader(), vtkTableToPolyData()
            reader.SetFileName(str(file))
            reader.SetHaveHeaders(True)
            reader.SetDetectNumericColumns(True)
            points.SetInputConnection(reader.GetOutputPort())
            for axis in "xyz":
                getattr(points, f"Set{axis.upper()}Column")(axis)
            points.Update()
        return points.GetOutput()

    def test_csv(self):
        """A table of numbers in full gives the same surface to the last bit; one with fewer digits one as near as they are."""
        particles = make_particles()
        surface = self.good(make_filter(particles))
        whole = self.good(make_filter(self.read_table(particles, 17)))
        self.assertEqual(bytes_of(whole), bytes_of(surface))
        near = self.good(make_filter(self.read_table(particles, 9)))
        self.assert_same(near, near)
        self.assertNotEqual(bytes_of(near), bytes_of(surface))
        for other in (whole, near):
            self.assertEqual(*(bytes(memoryview(each.GetPolys().GetConnectivityArray())) for each in (other, surface)))
        self.assertLess(abs(points_of(near) - points_of(surface)).max(), 1e-6)

    def test_isosurface(self):
        extract = make_filter()
        surface = self.good(extract)
        self.assertEqual(extract.GetUsedSmoothingLengthArrayName(), "hsml")
        self.assertGreater(surface.GetNumberOfPoints(), 100)
        self.assertLess(abs(numpy.linalg.norm(points_of(surface), axis=1) - 0.28).max(), 0.03)
        self.assertTrue(surface.GetPointData().HasArray("Radius"))
        self.assertIsNone(surface.GetPointData().GetScalars())  # nothing varies: one iso value, one hsml
        self.assertIsNotNone(surface.GetPointData().GetNormals())

    def test_free_surface_of_bare_points(self):
        extract = vtkMarchingCorrectors()
        surface = self.good(extract, particles_of(X), EstimateSmoothingLength=1, FreeSurface=1)
        self.assertGreater(surface.GetNumberOfCells(), 100)
        h = extract.GetRunStatistics().GetArray("SmoothingLengthRange").GetValue(0)
        self.assertAlmostEqual(h, 0.13, delta=0.03)

    def test_in_place_change_is_seen(self):
        particles = make_particles()
        extract = make_filter(particles)
        before = self.good(extract).GetBounds()[1]
        values_of(particles, "Radius")[:] *= 0.75
        particles.Modified()
        self.assertGreater(self.good(extract).GetBounds()[1], before + 0.05)

    def test_density_alone_is_not_used(self):
        extract = make_filter(make_particles(rho=numpy.full(1331, 1000.0)))
        for data, mass, used in ((None, 0.0, ""), (None, 1.0, "rho"), (vtkPolyData(), 1.0, "")):
            self.good(extract, data, Mass=mass)
            self.assertEqual(extract.GetUsedDensityArrayName(), used)

    def test_fluid_has_one_component(self):
        extract = make_filter(make_particles(Pair=numpy.zeros((1331, 2))))
        run(extract, FluidArrayName="Pair")
        self.assertIn("'Pair' has 2 components", extract.GetErrorMessage())

    def test_cost_is_no_part_of_the_output(self):
        extract = make_filter()
        surface = self.good(extract)
        statistics, data = extract.GetRunStatistics(), surface.GetFieldData()
        seconds = statistics.GetArray("Seconds")
        names = [seconds.GetComponentName(i) for i in range(seconds.GetNumberOfComponents())]
        self.assertEqual((names[0], names[-1]), ("input", "total"))
        self.assertGreater(seconds.GetComponent(0, len(names) - 1), 0)
        self.assertTrue(statistics.HasArray("Triangles"))
        self.assertEqual([data.GetArrayName(i) for i in range(data.GetNumberOfArrays())], ["IsoValues"])
        self.assertIn(f"Triangles: {surface.GetNumberOfCells()}\n", extract.GetStatistics())

    def test_excluded_arrays(self):
        extract = make_filter()
        self.assertTrue(self.good(extract).GetPointData().HasArray("hsml"))
        extract.AddExcludedArray("hsml")
        self.assertFalse(self.good(extract).GetPointData().HasArray("hsml"))
        self.assertEqual((extract.GetExcludedArray(0), extract.GetUsedSmoothingLengthArrayName()), ("hsml", "hsml"))

    def test_blocks(self):
        bare = make_particles()
        bare.GetPointData().RemoveArray("Radius")
        extract = make_filter(blocks_of(make_particles(), bare=bare))
        surfaces, told = run(extract, BlocksToApart=())
        self.assertEqual(len(told), 1)
        self.assertRegex(extract.GetErrorMessage(), "^Block 'bare', index 2: .*'Radius'")
        self.assertGreater(surfaces.GetBlock(0).GetNumberOfCells(), 100)
        self.assertEqual(surfaces.GetBlock(1).GetNumberOfCells(), 0)

    def test_blocks_together(self):
        """One set of particles: a cut goes unseen. Walls, by the names of blocks, may lack the scalar."""
        left = X[:, 0] < 0.04
        halves = make_particles(left), make_particles(~left)
        self.assert_same(self.good(make_filter(blocks_of(*halves))), self.good(make_filter()))
        halves[0].GetPointData().RemoveArray("Radius")
        together = make_filter(blocks_of(Walls=halves[0], Water=halves[1]))
        together.DetectFluidOn()
        self.assertEqual(together.GetNextFluid(), "WallBlock = 0")
        surface = self.good(together)
        self.assertEqual(together.GetUsedFluid(), "WallBlock = 0")
        self.assertGreater(surface.GetNumberOfCells(), 100)
        self.assertFalse(surface.GetPointData().HasArray("WallBlock"))

    def make_mesh(self, particles, arrays):
        """Hexahedra, between points of their own, before the particles' vertices, if there are any; with the particles'
        arrays for all cells, or all points."""
        places = numpy.array([(i & 1, i >> 1 & 1, i >> 2) for i in (0, 1, 3, 2, 4, 5, 7, 6)], float)
        grid = vtkUnstructuredGrid()
        grid.SetPoints(particles_of(numpy.concatenate([places, X] if particles else [places])).GetPoints())
        for _ in range(2):
            grid.InsertNextCell(VTK_HEXAHEDRON, 8, list(range(8)))
        for i in range(len(X) if particles else 0):
            grid.InsertNextCell(VTK_VERTEX, 1, [8 + i])
        nodes = numpy.full(2 if arrays == "cells" else 8, -1.0)  # which no smoothing length may be
        of_all = add(vtkPolyData(), **{name: numpy.concatenate([nodes, values_of(particles, name)])
                                       for name in (("Radius", "hsml") if particles else ())}).GetPointData()
        (grid.GetCellData() if arrays == "cells" else grid.GetPointData()).ShallowCopy(of_all)
        return grid

    def test_particles_among_meshes(self):
        """Vertices beside other cells are the particles; so they are where blocks have either."""
        particles = make_particles()
        expected, mesh = self.good(make_filter(particles)), self.make_mesh(None, "points")
        for arrays in ("points", "cells"):
            grid = self.make_mesh(particles, arrays)
            for data in (grid, blocks_of(mesh, grid)):
                extract = make_filter(data)
                if arrays == "cells":
                    extract.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "Radius")
                surface, told = run(extract)
                self.assertEqual((extract.GetErrorMessage(), len(told)), ("", 1))
                self.assert_same(surface, expected)
                self.assertAlmostEqual(values_of(surface, "hsml")[0], 0.13)
        bare = make_filter(mesh)  # no vertices at all: all points are particles
        self.assertGreater(run(bare, EstimateSmoothingLength=1, FreeSurface=1)[0].GetNumberOfCells(), 0)

    def test_by_neighbours(self):
        """Sums over neighbours that are kept for the next run are made anew for other particles."""
        particles = particles_of(lattice(7, 7, 7))
        extract = make_filter(particles, "Density", 0.5)
        found = []
        for iso in (0.5, 0.6, 0.5):
            surface = self.good(extract, EstimateSmoothingLength=1, SmoothingLengthEstimate=1, Mass=1e-3, Value=(0, iso))
            found.append((surface.GetNumberOfPoints(), surface.GetBounds()))
        self.assertGreater(found[0][0], 50)
        self.assertEqual(found[0], found[2])
        self.assertNotEqual(found[0], found[1])
        particles.GetPoints().SetPoint(0, -3.0, 0.0, 0.0)
        particles.GetPoints().Modified()
        self.assertNotEqual(run(extract)[0].GetNumberOfPoints(), found[0][0])

    def test_trim(self):
        """Off, the surface goes on beyond the weight sum 0.5, up to the node threshold."""
        extract = make_filter(iso=0.52)
        least = [values_of(self.good(extract, Trim=trim, ComputeWeightSum=1), "WeightSum").min() for trim in (1, 0)]
        self.assertAlmostEqual(least[0], 0.5, 3)
        self.assertTrue(0.05 < least[1] < 0.4, least)

    def test_what_was_used(self):
        extract = make_filter()
        surface = self.good(extract)
        self.assertEqual(extract.GetFluidScalarRange(), (RADIUS.min(), RADIUS.max()))
        self.assertEqual(extract.GetUsedIsoValues(), "0.3")
        self.assertEqual(extract.GetUsedSmoothingLength(), "0.13 (array hsml)")
        self.assertEqual(extract.GetUsedVolume(), "computed from the positions")
        self.assertAlmostEqual(extract.GetUsedCubeSize(), 0.065)
        area, volume = map(float, re.fullmatch("area (.*), volume (.*)", extract.GetSurfaceMeasures()).groups())
        masses = vtkMassProperties()
        masses.SetInputData(surface)
        self.assertAlmostEqual(area / masses.GetSurfaceArea(), 1, delta=1e-5)
        self.assertAlmostEqual(-volume / masses.GetVolume(), 1, delta=1e-5)  # values are above outside
        self.assertAlmostEqual(extract.GetEstimatedCells(), CELLS, 3)
        run(extract, SmoothingLength=0.26, SmoothingLengthArrayName="(none)", SmoothingLengthIsSupportRadius=1, Mass=2,
            Density=2000, Value=(1, 0.4))
        self.assertEqual(extract.GetUsedIsoValues(), "0.3, 0.4")
        self.assertEqual(extract.GetUsedSmoothingLength(), "0.13 (given, support radius)")
        self.assertEqual(extract.GetUsedVolume(), "2 / 2000")
        self.assertAlmostEqual(extract.GetEstimatedCells(), CELLS, 3)
        run(extract, vtkPolyData())
        self.assertEqual((extract.GetUsedIsoValues(), extract.GetEstimatedCells()), ("", 0))

    def test_range_is_that_of_the_fluid(self):
        extract = make_filter(make_particles(Kind=(RADIUS >= 0.45).astype(float)))
        extract.SetFluidArrayName("Kind")
        inside = RADIUS[RADIUS < 0.45]
        self.assertEqual(extract.GetNextScalarRange(), (inside.min(), inside.max()))
        self.good(extract)
        self.assertEqual(extract.GetFluidScalarRange(), (inside.min(), inside.max()))

    def test_what_the_next_update_takes(self):
        """Known without a run, for any scalar, with and without walls, box and blocks."""
        particles, ends = make_particles(), (RADIUS.min(), RADIUS.max())
        extract = vtkMarchingCorrectors()
        self.assertEqual((extract.GetNextScalarRange(), extract.GetNextCells()), ((0, 0), 0))
        extract.SetInputData(particles)
        self.assertEqual((extract.GetNextArray(), extract.GetNextComponents()), ("Radius", 1))  # the one that varies
        self.assertAlmostEqual(extract.GetNextCells(), CELLS, 3)
        extract.SetInputArrayToProcess(0, 0, 0, 0, "Radius")
        self.assertEqual(extract.GetNextScalarRange(), ends)
        self.assertEqual(extract.GetNextIsoValue(), numpy.sort(RADIUS)[665])
        extract.FreeSurfaceOn()
        self.assertEqual(extract.GetNextScalarRange(), (0, 0))
        extract.FreeSurfaceOff()
        extract.SetCubeSizeFactor(0.25)
        self.assertAlmostEqual(extract.GetNextCells(), 8 * CELLS, 3)
        extract.UseBoxOn()
        extract.SetBox(-9, 9, -9, 9, -9, 0.05)  # 6 of 11 layers
        self.assertAlmostEqual(extract.GetNextCells(), 8 * CELLS * 6 / 11, 3)
        extract.UseBoxOff()
        values_of(particles, "Radius")[0] = 7.0
        particles.GetPointData().GetArray("Radius").Modified()
        particles.Modified()
        self.assertEqual(extract.GetNextScalarRange(), (ends[0], 7.0))
        extract.SetInputData(blocks_of(make_particles(), particles))
        self.assertEqual(extract.GetNextScalarRange(), (ends[0], 7.0))
        self.assertAlmostEqual(extract.GetNextCells(), 2 * 8 * CELLS, 3)
        self.assertEqual(extract.GetFluidScalarRange(), (0, 0))  # nothing ran

    def test_huge_run_is_announced(self):
        """Before it begins: here it is ended at its first sign of progress."""
        extract = make_filter()
        warnings = []
        extract.AddObserver("WarningEvent", lambda *_: warnings.append(extract.GetEstimatedCells()))
        extract.AddObserver("ProgressEvent", lambda *_: extract.SetAbortExecute(len(warnings)))
        extract.SetCubeSize(1e-4)
        extract.Update()
        self.assertEqual(len(warnings), 1)
        self.assertAlmostEqual(warnings[0], 1331e9, -6)

    def test_enumerations(self):
        extract = vtkMarchingCorrectors()
        self.assertEqual((extract.GetValue(0), extract.GetFreeSurfaceValue()), (0, 0.5))
        extract.SetNumberOfFreeSurfaceValues(0)
        self.assertEqual(extract.GetFreeSurfaceValue(), 0.5)
        extract.SetIterationLimit(1000)
        self.assertEqual(extract.GetIterationLimit(), 255)
        self.assertTrue(extract.SetKernelByName("quintic"))
        self.assertEqual(extract.GetKernel(), vtkMarchingCorrectors.QUINTIC_SPLINE)
        for name, before, word, after in (("SeedMode", "COMPLETE", "Pairs", "PAIRS"),
                                          ("Topology", "TOPOLOGY_TABLE", "Field", "TOPOLOGY_FIELD"),
                                          ("BoundaryDetection", "WEIGHT_SUM", "Eigenvalue", "EIGENVALUE"),
                                          ("Kernel", "QUINTIC_SPLINE", "CubicSpline", "CUBIC_SPLINE")):
            self.assertEqual(getattr(extract, "Get" + name)(), getattr(vtkMarchingCorrectors, before))
            getattr(extract, f"Set{name}To{word}")()
            self.assertEqual(getattr(extract, "Get" + name)(), getattr(vtkMarchingCorrectors, after))
        self.assertIn(":", vtkMarchingCorrectors.ListDevices())
        self.assertIn("Cube Size Factor: 0.5", str(extract))


if __name__ == "__main__":
    unittest.main()
