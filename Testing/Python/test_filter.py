# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The wrapped filter: weird input first, then what Python users do."""
import math
import pathlib
import tempfile
import re
import unittest

from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints, vtkObject
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, VTK_VERTEX, vtkCompositeDataSet, vtkDataObject,
                                           vtkMultiBlockDataSet, vtkPolyData, vtkUnstructuredGrid)
from vtkmodules.vtkFiltersCore import vtkMassProperties
from vtkmodules.vtkFiltersGeneral import vtkTableToPolyData
from vtkmodules.vtkIOInfovis import vtkDelimitedTextReader

from marchingcorrectors import vtkMarchingCorrectors

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS


def make_particles(count=11, spacing=0.1):
    """A lattice of count^3 particles around the origin; Radius is the distance from it."""
    points = vtkPoints()
    radius = vtkDoubleArray()
    radius.SetName("Radius")
    length = vtkDoubleArray()
    length.SetName("hsml")
    half = (count - 1) / 2
    for i in range(count ** 3):
        x = [(n - half) * spacing for n in (i % count, i // count % count, i // count ** 2)]
        points.InsertNextPoint(x)
        radius.InsertNextValue(math.sqrt(sum(c * c for c in x)))
        length.InsertNextValue(1.3 * spacing)
    particles = vtkPolyData()
    particles.SetPoints(points)
    particles.GetPointData().AddArray(radius)
    particles.GetPointData().AddArray(length)
    return particles


def make_filter(particles, scalar="Radius", iso=0.3):
    result = vtkMarchingCorrectors()
    result.SetInputData(particles)
    result.SetInputArrayToProcess(0, 0, 0, POINTS, scalar)
    result.SetValue(0, iso)
    return result


class TestFilter(unittest.TestCase):
    def test_something_weird(self):
        extract = make_filter(vtkPolyData())
        extract.Update()
        self.assertEqual(extract.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(extract.GetErrorMessage(), "")

    def test_error_is_a_sentence(self):
        vtkObject.GlobalWarningDisplayOff()
        extract = make_filter(make_particles(), "Nonsense")
        extract.Update()
        vtkObject.GlobalWarningDisplayOn()
        self.assertEqual(extract.GetOutput().GetNumberOfPoints(), 0)
        self.assertIn("'Nonsense'", extract.GetErrorMessage())
        self.assertIn("Radius", extract.GetErrorMessage())

    def read_table(self, particles, digits):
        """The particles after a table of numbers with so many digits, by VTK's reader."""
        data = particles.GetPointData()
        rows = [[*particles.GetPoint(i), data.GetArray("Radius").GetValue(i), data.GetArray("hsml").GetValue(i)]
                for i in range(particles.GetNumberOfPoints())]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "particles.csv"
            file.write_text("x,y,z,Radius,hsml\n" + "".join(
                ",".join(f"{value:.{digits}g}" for value in row) + "\n" for row in rows))
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
        exact = vtkPoints()  # the table's points are doubles
        exact.SetDataTypeToDouble()
        exact.DeepCopy(particles.GetPoints())
        particles.SetPoints(exact)

        def extract(input_):
            filter_ = make_filter(input_)
            filter_.Update()
            surface = filter_.GetOutput()
            arrays = (surface.GetPoints().GetData(), surface.GetPolys().GetConnectivityArray(),
                      surface.GetPointData().GetNormals(), surface.GetPointData().GetArray("hsml"))
            return [memoryview(array).tobytes() for array in arrays], surface
        expected, surface = extract(particles)
        self.assertGreater(surface.GetNumberOfPoints(), 100)
        self.assertEqual(extract(self.read_table(particles, 17))[0], expected)
        rounded, near = extract(self.read_table(particles, 9))
        self.assertNotEqual(rounded[0], expected[0])
        self.assertEqual(rounded[1], expected[1])
        for i in range(surface.GetNumberOfPoints()):
            self.assertLess(math.dist(near.GetPoint(i), surface.GetPoint(i)), 1e-6)

    def test_isosurface(self):
        extract = make_filter(make_particles())
        extract.Update()
        surface = extract.GetOutput()
        self.assertEqual(extract.GetUsedSmoothingLengthArrayName(), "hsml")
        self.assertGreater(surface.GetNumberOfPoints(), 100)
        for i in range(surface.GetNumberOfPoints()):
            self.assertAlmostEqual(math.dist(surface.GetPoint(i), (0, 0, 0)), 0.28, delta=0.03)
        self.assertTrue(surface.GetPointData().HasArray("Radius"))
        self.assertIsNone(surface.GetPointData().GetScalars())  # nothing varies: one iso value, one hsml
        self.assertIsNotNone(surface.GetPointData().GetNormals())

    def test_free_surface_of_bare_points(self):
        particles = vtkPolyData()
        particles.SetPoints(make_particles().GetPoints())
        extract = vtkMarchingCorrectors()
        extract.SetInputData(particles)
        extract.EstimateSmoothingLengthOn()
        extract.FreeSurfaceOn()
        extract.Update()
        surface = extract.GetOutput()
        self.assertGreater(surface.GetNumberOfCells(), 100)
        h = extract.GetRunStatistics().GetArray("SmoothingLengthRange").GetValue(0)
        self.assertAlmostEqual(h, 0.13, delta=0.03)

    def test_in_place_change_is_seen(self):
        particles = make_particles()
        extract = make_filter(particles)
        extract.Update()
        before = extract.GetOutput().GetBounds()[1]
        radius = particles.GetPointData().GetArray("Radius")
        for i in range(radius.GetNumberOfValues()):
            radius.SetValue(i, 0.75 * radius.GetValue(i))
        particles.Modified()
        extract.Update()
        self.assertGreater(extract.GetOutput().GetBounds()[1], before + 0.05)

    def test_density_alone_is_not_used(self):
        particles = make_particles()
        density = vtkDoubleArray()
        density.SetName("rho")
        density.SetNumberOfValues(particles.GetNumberOfPoints())
        density.Fill(1000)
        particles.GetPointData().AddArray(density)
        extract = make_filter(particles)
        extract.Update()
        self.assertEqual(extract.GetUsedDensityArrayName(), "")
        extract.SetMass(1.0)
        extract.Update()
        self.assertEqual(extract.GetUsedDensityArrayName(), "rho")
        extract.SetInputData(vtkPolyData())
        extract.Update()
        self.assertEqual(extract.GetUsedDensityArrayName(), "")

    def test_fluid_has_one_component(self):
        extract = make_filter(make_particles())
        pair = vtkDoubleArray()
        pair.SetName("Pair")
        pair.SetNumberOfComponents(2)
        pair.SetNumberOfTuples(extract.GetInput().GetNumberOfPoints())
        pair.Fill(0)
        extract.GetInput().GetPointData().AddArray(pair)
        extract.SetFluidArrayName("Pair")
        vtkObject.GlobalWarningDisplayOff()
        extract.Update()
        vtkObject.GlobalWarningDisplayOn()
        self.assertIn("'Pair' has 2 components", extract.GetErrorMessage())

    def test_cost_is_no_part_of_the_output(self):
        extract = make_filter(make_particles())
        extract.Update()
        run, data = extract.GetRunStatistics(), extract.GetOutput().GetFieldData()
        seconds = run.GetArray("Seconds")
        names = [seconds.GetComponentName(i) for i in range(seconds.GetNumberOfComponents())]
        self.assertEqual((names[0], names[-1]), ("input", "total"))
        self.assertGreater(seconds.GetComponent(0, len(names) - 1), 0)
        self.assertTrue(run.HasArray("Triangles"))
        self.assertEqual([data.GetArrayName(i) for i in range(data.GetNumberOfArrays())], ["IsoValues"])
        self.assertIn(f"Triangles: {extract.GetOutput().GetNumberOfCells()}\n", extract.GetStatistics())

    def test_excluded_arrays(self):
        extract = make_filter(make_particles())
        extract.Update()
        self.assertTrue(extract.GetOutput().GetPointData().HasArray("hsml"))
        extract.AddExcludedArray("hsml")
        extract.Update()
        self.assertEqual(extract.GetExcludedArray(0), "hsml")
        self.assertFalse(extract.GetOutput().GetPointData().HasArray("hsml"))
        self.assertEqual(extract.GetUsedSmoothingLengthArrayName(), "hsml")

    def test_blocks(self):
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, make_particles())
        blocks.SetBlock(1, make_particles())
        blocks.GetBlock(1).GetPointData().RemoveArray("Radius")
        blocks.GetMetaData(1).Set(vtkCompositeDataSet.NAME(), "bare")
        extract = vtkMarchingCorrectors()
        extract.SetInputDataObject(blocks)
        extract.SetBlocksToApart()
        extract.SetInputArrayToProcess(0, 0, 0, POINTS, "Radius")
        extract.SetValue(0, 0.3)
        vtkObject.GlobalWarningDisplayOff()
        extract.Update()
        vtkObject.GlobalWarningDisplayOn()
        self.assertRegex(extract.GetErrorMessage(), "^Block 'bare', index 2: .*'Radius'")
        surfaces = extract.GetOutputDataObject(0)
        self.assertGreater(surfaces.GetBlock(0).GetNumberOfCells(), 100)
        self.assertEqual(surfaces.GetBlock(1).GetNumberOfCells(), 0)

    def test_blocks_together(self):
        """One set of particles: a cut goes unseen. Walls, by the names of blocks, may lack the scalar."""
        def part(keep):
            whole, points = make_particles(), vtkPoints()
            points.SetDataType(whole.GetPoints().GetDataType())
            taken = vtkPolyData()
            taken.GetPointData().CopyAllocate(whole.GetPointData())
            for i in range(whole.GetNumberOfPoints()):
                if keep(whole.GetPoint(i)):
                    taken.GetPointData().CopyData(whole.GetPointData(), i, points.InsertNextPoint(whole.GetPoint(i)))
            taken.SetPoints(points)
            return taken

        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, part(lambda x: x[0] < 0.04))
        blocks.SetBlock(1, part(lambda x: x[0] >= 0.04))
        together, whole = make_filter(blocks), make_filter(make_particles())
        together.Update()
        whole.Update()
        self.assertEqual(together.GetOutput().GetNumberOfCells(), whole.GetOutput().GetNumberOfCells())
        self.assertEqual(together.GetOutput().GetBounds(), whole.GetOutput().GetBounds())

        blocks.GetBlock(0).GetPointData().RemoveArray("Radius")
        blocks.GetMetaData(0).Set(vtkCompositeDataSet.NAME(), "Walls")
        blocks.GetMetaData(1).Set(vtkCompositeDataSet.NAME(), "Water")
        together.DetectFluidOn()
        self.assertEqual(together.GetNextFluid(), "WallBlock = 0")
        together.Update()
        self.assertEqual((together.GetErrorMessage(), together.GetUsedFluid()), ("", "WallBlock = 0"))
        self.assertGreater(together.GetOutput().GetNumberOfCells(), 100)
        self.assertFalse(together.GetOutput().GetPointData().HasArray("WallBlock"))

    def make_mesh(self, particles, arrays):
        """Hexahedra, between points of their own, before the particles' vertices, if there are any; with the particles'
        arrays for all cells, or all points."""
        grid, points = vtkUnstructuredGrid(), vtkPoints()
        grid.SetPoints(points)
        corners = [points.InsertNextPoint(i & 1, i >> 1 & 1, i >> 2) for i in (0, 1, 3, 2, 4, 5, 7, 6)]
        for _ in range(2):
            grid.InsertNextCell(VTK_HEXAHEDRON, 8, corners)
        count = particles.GetNumberOfPoints() if particles else 0
        for i in range(count):
            grid.InsertNextCell(VTK_VERTEX, 1, [points.InsertNextPoint(particles.GetPoint(i))])
        for array in (particles.GetPointData().GetArray(i) for i in range(2 if count else 0)):
            values = vtkDoubleArray()
            values.SetName(array.GetName())
            for _ in range(2 if arrays == "cells" else 8):
                values.InsertNextValue(-1.0)  # which no smoothing length may be
            for i in range(count):
                values.InsertNextValue(array.GetValue(i))
            (grid.GetCellData() if arrays == "cells" else grid.GetPointData()).AddArray(values)
        return grid

    def test_particles_among_meshes(self):
        """Vertices beside other cells are the particles; so they are where blocks have either."""
        particles = make_particles()
        expected = make_filter(particles)
        expected.Update()
        mesh = self.make_mesh(None, "points")
        for arrays in ("points", "cells"):
            grid = self.make_mesh(particles, arrays)
            blocks = vtkMultiBlockDataSet()
            blocks.SetBlock(0, mesh)
            blocks.SetBlock(1, grid)
            for data in (grid, blocks):
                extract, warnings = make_filter(data), []
                if arrays == "cells":
                    extract.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "Radius")
                extract.AddObserver("WarningEvent", lambda *_, w=warnings: w.append(1))
                extract.Update()
                self.assertEqual((extract.GetErrorMessage(), len(warnings)), ("", 1))
                self.assertEqual(extract.GetOutput().GetNumberOfPoints(), expected.GetOutput().GetNumberOfPoints())
                self.assertEqual(extract.GetOutput().GetBounds(), expected.GetOutput().GetBounds())
                first = extract.GetOutput().GetPointData().GetArray("hsml").GetValue(0)
                self.assertAlmostEqual(first, 0.13)
        bare = make_filter(mesh)  # no vertices at all: all points are particles
        bare.EstimateSmoothingLengthOn()
        bare.FreeSurfaceOn()
        bare.Update()
        self.assertGreater(bare.GetOutput().GetNumberOfCells(), 0)

    def test_by_neighbours(self):
        """Sums over neighbours that are kept for the next run are made anew for other particles."""
        particles = make_particles(7)
        extract = make_filter(particles, "Density", 0.5)
        extract.EstimateSmoothingLengthOn()
        extract.SetSmoothingLengthEstimate(1)
        extract.SetMass(1e-3)
        found = []
        for iso in (0.5, 0.6, 0.5):
            extract.SetValue(0, iso)
            extract.Update()
            self.assertEqual(extract.GetErrorMessage(), "")
            found.append((extract.GetOutput().GetNumberOfPoints(), extract.GetOutput().GetBounds()))
        self.assertGreater(found[0][0], 50)
        self.assertEqual(found[0], found[2])
        self.assertNotEqual(found[0], found[1])
        particles.GetPoints().SetPoint(0, -3.0, 0.0, 0.0)
        particles.GetPoints().Modified()
        extract.Update()
        self.assertNotEqual(extract.GetOutput().GetNumberOfPoints(), found[0][0])

    def test_trim(self):
        """Off, the surface goes on beyond the weight sum 0.5, up to the node threshold."""
        extract = make_filter(make_particles(), iso=0.52)
        extract.ComputeWeightSumOn()
        weights = {}
        for trim in (True, False):
            extract.SetTrim(trim)
            extract.Update()
            weights[trim] = extract.GetOutput().GetPointData().GetArray("WeightSum").GetRange()[0]
        self.assertAlmostEqual(weights[True], 0.5, 3)
        self.assertLess(weights[False], 0.4)
        self.assertGreater(weights[False], 0.05)

    def test_what_was_used(self):
        particles = make_particles()
        extract = make_filter(particles)
        extract.Update()
        self.assertEqual(extract.GetFluidScalarRange(), particles.GetPointData().GetArray("Radius").GetRange())
        self.assertEqual(extract.GetUsedIsoValues(), "0.3")
        self.assertEqual(extract.GetUsedSmoothingLength(), "0.13 (array hsml)")
        self.assertEqual(extract.GetUsedVolume(), "computed from the positions")
        self.assertAlmostEqual(extract.GetUsedCubeSize(), 0.065)
        area, volume = map(float, re.fullmatch("area (.*), volume (.*)", extract.GetSurfaceMeasures()).groups())
        masses = vtkMassProperties()
        masses.SetInputData(extract.GetOutput())
        self.assertAlmostEqual(area / masses.GetSurfaceArea(), 1, delta=1e-5)
        self.assertAlmostEqual(-volume / masses.GetVolume(), 1, delta=1e-5)  # values are above outside
        # A particle on this lattice takes 0.1^3.
        self.assertAlmostEqual(extract.GetEstimatedCells(), 1331 * (0.1 / 0.065) ** 3, 3)
        extract.SetSmoothingLength(0.26)
        extract.SetSmoothingLengthArrayName("(none)")
        extract.SmoothingLengthIsSupportRadiusOn()
        extract.SetMass(2)
        extract.SetDensity(2000)
        extract.SetValue(1, 0.4)
        extract.Update()
        self.assertEqual(extract.GetUsedIsoValues(), "0.3, 0.4")
        self.assertEqual(extract.GetUsedSmoothingLength(), "0.13 (given, support radius)")
        self.assertEqual(extract.GetUsedVolume(), "2 / 2000")
        self.assertAlmostEqual(extract.GetEstimatedCells(), 1331 * (0.1 / 0.065) ** 3, 3)
        extract.SetInputData(vtkPolyData())
        extract.Update()
        self.assertEqual(extract.GetUsedIsoValues(), "")
        self.assertEqual(extract.GetEstimatedCells(), 0)

    def test_range_is_that_of_the_fluid(self):
        particles = make_particles()
        kind = vtkDoubleArray()
        kind.SetName("Kind")
        radius = particles.GetPointData().GetArray("Radius")
        for i in range(particles.GetNumberOfPoints()):
            kind.InsertNextValue(0 if radius.GetValue(i) < 0.45 else 1)
        particles.GetPointData().AddArray(kind)
        extract = make_filter(particles)
        extract.SetFluidArrayName("Kind")
        inside = [radius.GetValue(i) for i in range(particles.GetNumberOfPoints()) if not kind.GetValue(i)]
        self.assertEqual(extract.GetNextScalarRange(), (min(inside), max(inside)))
        extract.Update()
        self.assertEqual(extract.GetFluidScalarRange(), (min(inside), max(inside)))

    def test_what_the_next_update_takes(self):
        """Known without a run, for any scalar, with and without walls, box and blocks."""
        particles = make_particles()
        extract = vtkMarchingCorrectors()
        self.assertEqual((extract.GetNextScalarRange(), extract.GetNextCells()), ((0, 0), 0))
        extract.SetInputData(particles)
        cells = 1331 * (0.1 / 0.065) ** 3
        self.assertEqual(extract.GetNextArray(), "Radius")  # the one that varies
        self.assertEqual(extract.GetNextComponents(), 1)
        self.assertAlmostEqual(extract.GetNextCells(), cells, 3)
        extract.SetInputArrayToProcess(0, 0, 0, 0, "Radius")
        low, high = particles.GetPointData().GetArray("Radius").GetRange()
        self.assertEqual(extract.GetNextScalarRange(), (low, high))
        array = particles.GetPointData().GetArray("Radius")
        radii = sorted(array.GetValue(i) for i in range(array.GetNumberOfValues()))
        self.assertEqual(extract.GetNextIsoValue(), radii[(len(radii) - 1) // 2])
        extract.FreeSurfaceOn()
        self.assertEqual(extract.GetNextScalarRange(), (0, 0))
        extract.FreeSurfaceOff()
        extract.SetCubeSizeFactor(0.25)
        self.assertAlmostEqual(extract.GetNextCells(), 8 * cells, 3)
        extract.UseBoxOn()
        extract.SetBox(-9, 9, -9, 9, -9, particles.GetCenter()[2] + 0.05)  # 6 of 11 layers
        self.assertAlmostEqual(extract.GetNextCells(), 8 * cells * 6 / 11, 3)
        extract.UseBoxOff()
        particles.GetPointData().GetArray("Radius").SetValue(0, 7.0)
        particles.GetPointData().GetArray("Radius").Modified()
        particles.Modified()
        self.assertEqual(extract.GetNextScalarRange(), (low, 7.0))
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, make_particles())
        blocks.SetBlock(1, particles)
        extract.SetInputData(blocks)
        self.assertEqual(extract.GetNextScalarRange(), (low, 7.0))
        self.assertAlmostEqual(extract.GetNextCells(), 2 * 8 * cells, 3)
        self.assertEqual(extract.GetFluidScalarRange(), (0, 0))  # nothing ran

    def test_huge_run_is_announced(self):
        """Before it begins: here it is ended at its first sign of progress."""
        extract = make_filter(make_particles())
        extract.SetCubeSize(1e-4)
        warnings = []
        extract.AddObserver("WarningEvent", lambda *_: warnings.append(extract.GetEstimatedCells()))
        extract.AddObserver("ProgressEvent", lambda *_: extract.SetAbortExecute(len(warnings)))
        extract.Update()
        self.assertEqual(len(warnings), 1)
        self.assertAlmostEqual(warnings[0], 1331e9, -6)

    def test_enumerations(self):
        extract = vtkMarchingCorrectors()
        self.assertEqual(extract.GetValue(0), 0)
        self.assertEqual(extract.GetFreeSurfaceValue(), 0.5)
        extract.SetNumberOfFreeSurfaceValues(0)
        self.assertEqual(extract.GetFreeSurfaceValue(), 0.5)
        extract.SetIterationLimit(1000)
        self.assertEqual(extract.GetIterationLimit(), 255)
        self.assertEqual(extract.GetKernel(), vtkMarchingCorrectors.CUBIC_SPLINE)
        self.assertTrue(extract.SetKernelByName("quintic"))
        self.assertEqual(extract.GetKernel(), vtkMarchingCorrectors.QUINTIC_SPLINE)
        extract.SetSeedModeToPairs()
        self.assertEqual(extract.GetSeedMode(), vtkMarchingCorrectors.PAIRS)
        self.assertEqual(extract.GetTopology(), vtkMarchingCorrectors.TOPOLOGY_TABLE)
        extract.SetTopologyToField()
        self.assertEqual(extract.GetTopology(), vtkMarchingCorrectors.TOPOLOGY_FIELD)
        extract.SetBoundaryDetectionToEigenvalue()
        self.assertEqual(extract.GetBoundaryDetection(), vtkMarchingCorrectors.EIGENVALUE)
        extract.SetBoundaryDetectionToWeightSum()
        self.assertEqual(extract.GetBoundaryDetection(), vtkMarchingCorrectors.WEIGHT_SUM)
        self.assertIn(":", vtkMarchingCorrectors.ListDevices())
        self.assertIn("Cube Size Factor: 0.5", str(extract))


if __name__ == "__main__":
    unittest.main()
