# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests vtkMarchingCorrectors: points against brute force; arrays, their names and types, field data, statistics; what the filter tells before a run.
test_input.py tests its input."""
import math
import unittest

import numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkDataSetAttributes, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkMassProperties
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource

from marchingcorrectors import vtkMarchingCorrectors
from vtk_test import (
    COUNT, H, POINTS, SPACING, blocks_of, cube, lattice, on_progress, particles_of, points_of, run, says, sphere,
    statistic, statistics_of, sums_at, values_of)

X = lattice(11, 11, 11, around_origin=True)
RADIUS = numpy.linalg.norm(X, axis=1)
CELLS = 1331 * (SPACING / 0.065) ** 3  # On this lattice a particle takes 0.1^3.


def make_particles(chosen=slice(None), **arrays):
    """Returns the chosen particles. Radius is the distance from the origin."""
    return particles_of(X[chosen], Radius=RADIUS[chosen], hsml=numpy.full(len(X[chosen]), 1.3 * SPACING), **arrays)


def make_filter(particles=None, scalar="Radius", iso=0.3):
    return sphere(make_particles() if particles is None else particles, scalar, iso)


def normals_of(surface):
    """Returns the triangles' normals, computed from their corners."""
    corners = points_of(surface).astype(float)[corners_of(surface)]
    return numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def corners_of(surface):
    return numpy.array(memoryview(surface.GetPolys().GetConnectivityArray())).reshape(-1, 3)


class FilterTest(unittest.TestCase):
    def good(self, extract, data=None, **settings):
        """Returns the surface of a run that prints nothing."""
        surface, told = run(extract, data, **settings)
        self.assertEqual((told, extract.GetErrorMessage()), ([], ""))
        return surface

    def has(self, surface, there, missing=""):
        data = surface.GetPointData()
        self.assertEqual([name for name in there.split() if not data.HasArray(name)], [])
        self.assertEqual([name for name in missing.split() if data.HasArray(name)], [])


class TestPoints(FilterTest):
    def residual(self, extract, mean=True):
        """Returns the largest difference between the field and the iso value 0.6 at every thirteenth point of the surface. The field is summed by
        brute force."""
        surface = self.surface = run(extract)[0]
        self.assertGreater(surface.GetNumberOfPoints(), 1000)
        particles = extract.GetInput()
        weight, total = sums_at(particles, values_of(particles, "Radius"), points_of(surface)[::13])
        return abs((total / weight if mean else total) - 0.6).max()

    def test_sphere(self):
        """The scalar Radius grows outwards. Normals point to lower values, as vtkContourFilter's do, and triangles face as the normals
        do."""
        extract = sphere()
        self.assertLess(self.residual(extract), 1e-5 * math.sqrt(3))
        normals = values_of(self.surface, "Normals")[corners_of(self.surface)[:, 0]]
        self.assertTrue(((normals * normals_of(self.surface)).sum(axis=1) >= 0).all())
        self.assertTrue(((normals * points_of(self.surface)[corners_of(self.surface)[:, 0]]).sum(axis=1) <= 0).all())
        extract.ShepardNormalizationOff()
        self.assertLess(self.residual(extract, mean=False), 1e-5 * math.sqrt(3))

    def test_several_values(self):
        extract = sphere()
        extract.GenerateValues(3, 0.3, 0.7)
        every = self.good(extract).GetNumberOfCells()
        each = [self.good(extract, NumberOfContours=1, Value=(0, value)).GetNumberOfCells() for value in (0.3, 0.5, 0.7)]
        self.assertTrue(every == sum(each) > 0)
        extract.SetFreeSurfaceValue(0, 0.3)
        extract.SetFreeSurfaceValue(1, 0.6)
        self.assertEqual(set(values_of(self.good(extract, FreeSurface=1), "IsoValue")), {0.3, 0.6})

    def test_value_that_is_not_given(self):
        """The default iso value is known before the run; core_name tests how it is chosen. A NaN stands for an empty row of the panel's
        list."""
        extract = sphere()
        for settings, value in (({"NumberOfContours": 0}, extract.GetNextIsoValue()), ({"NumberOfContours": 1, "Value": (0, math.nan)}, extract.GetNextIsoValue()),
                                ({"FreeSurface": 1, "NumberOfFreeSurfaceValues": 0}, 0.5)):
            values = self.good(extract, **settings).GetFieldData().GetArray("IsoValues")
            self.assertEqual((values.GetNumberOfTuples(), values.GetValue(0)), (1, value))

    def test_free_surface_of_bare_points(self):
        extract = vtkMarchingCorrectors()
        surface = self.good(extract, particles_of(X), EstimateSmoothingLength=1, FreeSurface=1)
        self.assertGreater(surface.GetNumberOfCells(), 100)
        self.assertAlmostEqual(statistic(extract, "SmoothingLengthRange"), H, delta=0.03)

    def test_by_neighbours(self):
        """Results of sums over neighbours are kept for the next run, and computed anew for other particles."""
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
        """With Trim off the surface goes on beyond the weight sum 0.5, down to the node threshold."""
        extract = make_filter(iso=0.52)
        least = [values_of(self.good(extract, Trim=trim, ComputeWeightSum=1), "WeightSum").min() for trim in (1, 0)]
        self.assertAlmostEqual(least[0], 0.5, 3)
        self.assertTrue(0.05 < least[1] < 0.4, least)

    def make_plane(self):
        """Makes a filter on 21^2 particles in the plane y = 0.5, with three iso values, the least of which lies below all values."""
        places = lattice(21, 1, 21, around_origin=True) + [0, 0.5, 0]
        extract = sphere(particles_of(places, SmoothingLength=numpy.full(441, H), Volume=numpy.full(441, SPACING ** 2),
                                      Radius=numpy.hypot(*places[:, ::2].T)))
        for i, value in ((1, -1), (2, 0.3)):
            extract.SetValue(i, value)
        return extract

    def test_bands(self):
        """Triangles and lines carry the value at which their band begins."""
        extract = self.make_plane()
        surface = run(extract)[0]
        self.assertEqual((surface.GetNumberOfPolys(), surface.GetCellData().HasArray("BandValue")), (0, False))
        self.has(surface, "Normals")
        self.assertIsNone(surface.GetPointData().GetNormals())  # With normals, lines would be lit.
        surface = run(extract, Filled=1)[0]
        bands = numpy.array(surface.GetCellData().GetArray("BandValue"))
        self.assertEqual((surface.GetNumberOfLines(), len(bands)), (2, surface.GetNumberOfCells()))
        self.assertEqual([surface.GetCell(i).GetCellDimension() for i in (0, 1, 2, len(bands) - 1)], [1, 1, 2, 2])
        self.assertEqual(set(bands), {-1, 0.3, 0.6})
        self.assertEqual(set(values_of(surface, "IsoValue")), {-1, 0.3, 0.6})
        self.assertGreater(values_of(surface, "Radius").max(), 0.9)  # The contoured array keeps the field's values.
        areas = numpy.linalg.norm(normals_of(surface), axis=1) / 2
        self.assertAlmostEqual(areas[bands[2:] == 0.3].sum(), 0.27 * math.pi, delta=0.02)
        space = sphere()
        self.assertEqual(run(space, Filled=1)[0].GetNumberOfCells(), 0)
        self.assertIn("two dimensions", space.GetErrorMessage())


class TestArrays(FilterTest):
    def make_particles(self, **arrays):
        names = vtkStringArray()
        for i in range(COUNT):
            names.InsertNextValue(f"particle {i}")
        data = cube(Position=points_of(cube()).astype(numpy.float32), Id=numpy.arange(COUNT), Name=names,
                    **{vtkDataSetAttributes.GhostArrayName(): numpy.ones(COUNT, numpy.uint8)}, **arrays)
        data.GetPointData().GetArray("Position").SetComponentName(1, "Height")
        time = vtkDoubleArray()
        time.SetName("TimeValue")
        time.InsertNextValue(0.9)
        data.GetFieldData().AddArray(time)
        return data

    def test_attributes(self):
        particles = self.make_particles()
        extract = sphere(particles)
        surface = self.good(extract)
        self.has(surface, "Radius Volume", vtkDataSetAttributes.GhostArrayName())
        data, x = surface.GetPointData(), points_of(surface)[::53]
        self.assertEqual(data.GetArray("Position").GetComponentName(1), "Height")
        self.assertEqual([values_of(surface, name).dtype for name in ("Position", "Volume", "Id")], ["f4", "f8", "i8"])
        nearest = [numpy.linalg.norm(points_of(particles) - place, axis=1).argmin() for place in x]
        self.assertEqual(values_of(surface, "Id")[::53].tolist(), nearest)
        names = data.GetAbstractArray("Name")
        self.assertEqual([names.GetValue(53 * i) for i in range(len(x))], [f"particle {i}" for i in nearest])
        for c in range(3):
            weight, total = sums_at(particles, values_of(particles, "Position")[:, c].astype(float), x)
            self.assertLess(abs(values_of(surface, "Position")[::53, c] - total / weight).max(), 1e-5)
        self.has(self.good(extract, InterpolateAttributes=0), "Radius", "Position Id")

    def test_left_out(self):
        """The surface lacks an array if the user excludes it or, with a warning, if it is not finite somewhere in the fluid."""
        wall = points_of(cube())[:, 0] < -0.9
        broken = numpy.where(wall, math.inf, 1)
        particles = self.make_particles(Broken=numpy.ones((COUNT, 3)), BrokenWall=broken, Wall=wall.astype(float))
        values_of(particles, "Broken")[COUNT // 2, 1] = math.nan
        extract = sphere(particles)
        surface, told = run(extract, FluidArrayName="Wall")
        self.assertEqual(len(told), 1)
        self.assertRegex(told[0], says("ARRAY_LEFT_OUT", f"'Broken'.* {COUNT // 2} "))
        self.has(surface, "BrokenWall Position Radius", "Broken")
        time = extract.GetMTime()
        for name in ("Broken", "Id", "Name", "Volume", "no such array"):
            extract.AddExcludedArray(name)
        self.assertGreater(extract.GetMTime(), time)
        self.assertEqual((extract.GetNumberOfExcludedArrays(), *map(extract.GetExcludedArray, (1, 5, -1))), (5, "Id", None, None))
        self.has(self.good(extract), "Position Radius", "Id Name Volume")
        self.assertEqual(extract.GetUsedVolumeArrayName(), "Volume")
        extract.ClearExcludedArrays()
        self.has(run(extract)[0], "Id")

    def test_names(self):
        """A computed array keeps its name even if an array of the input, or the contoured array, has the same name."""
        radius = values_of(cube(), "Radius").astype(numpy.float32)
        particles = cube(Normals=radius, WeightSum=radius, IsoValue=radius)
        extract = sphere(particles)

        def extracted(scalar, **settings):
            """Returns the surface, the names of the arrays that hold the iso value at all points, and all names."""
            surface = self.good(extract, InputArrayToProcess=(0, 0, 0, POINTS, scalar), **settings)
            data = surface.GetPointData()
            names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
            iso = [name for name in names if len(set(map(str, values_of(surface, name)))) == 1
                   and abs(values_of(surface, name) - 0.6).max() < 1e-6]
            return surface, iso, names

        for scalar, expected in (("Radius", ["Radius"]), ("Normals", ["IsoValue"])):
            surface, iso, names = extracted(scalar)
            self.assertEqual(surface.GetPointData().GetNormals().GetName(), "Normals")
            self.assertEqual((names.count("Normals"), names.count("IsoValue"), iso), (1, 1, expected))
            self.assertIn(("Scalar", [scalar]), statistics_of(extract))
        surface, iso, _ = extracted("WeightSum", ComputeWeightSum=1)
        self.assertEqual((iso, values_of(surface, "WeightSum").max() > 0.9), (["IsoValue"], True))
        # If normals and weight sums are not computed, the input's arrays of these names are carried like all others,
        # and the surface has no normals.
        surface, _, _ = extracted("Radius", ComputeNormals=0, ComputeWeightSum=0)
        self.assertIsNone(surface.GetPointData().GetNormals())
        self.assertEqual(values_of(surface, "Normals").ndim, 1)
        self.assertAlmostEqual(values_of(surface, "WeightSum")[0], 0.6, delta=0.05)
        self.assertEqual(extracted("Normals")[1], ["Normals"])
        self.assertGreater(values_of(extracted("Normals", ComputeScalars=0)[0], "Normals").max(), 0.6)
        # By default, active scalars without a name are contoured.
        unnamed, untold = vtkDoubleArray(), vtkMarchingCorrectors()
        unnamed.DeepCopy(particles.GetPointData().GetArray("Radius"))
        unnamed.SetName(None)
        particles.GetPointData().SetScalars(unnamed)
        surface = self.good(untold, particles, Value=(0, 0.6))
        self.assertLess(abs(values_of(surface, "IsoValue") - 0.6).max(), 1e-6)

    def test_computed(self):
        extract = sphere(self.make_particles())
        wanted = "Gradients WeightSum BoundaryEigenvalue Curvature CorrectionLength Residual BoundaryFlag"
        surface = self.good(extract, **{f"Compute{name}": 1 for name in wanted.split()})
        self.has(surface, "Normals GaussCurvature " + wanted.replace("Curvature", "MeanCurvature"))
        self.assertAlmostEqual(values_of(surface, "MeanCurvature").mean() * 0.6, -1, delta=0.05)  # The surface encloses lower values.
        self.assertEqual((values_of(surface, "Radius").dtype, set(values_of(surface, "Radius"))), ("f8", {0.6}))
        extract.SetInputArrayToProcess(0, 0, 0, POINTS, "Position")
        self.has(run(extract)[0], "Position_Magnitude Position")
        self.has(run(extract, ScalarComponent=1, Value=(0, 0.05))[0], "Position_Height")
        surface, _ = run(extract, ComputeNormals=0, ComputeScalars=0)
        self.has(surface, "", "Position_Height")
        self.assertIsNone(surface.GetPointData().GetNormals())

    def test_coarse_points(self):
        """A warning tells that float coordinates are too coarse for the surface: their steps are 0.0625, the cubes 0.065."""
        extract, far = sphere(), particles_of(points_of(cube()) - [0, 1e6, 0]).GetPoints()
        self.good(extract, OutputPointsPrecision=0)
        extract.GetInput().SetPoints(far)
        for precision, count in ((1, 0), (2, 0), (0, 1)):
            surface, told = run(extract, OutputPointsPrecision=precision)
            self.assertEqual((len(told), surface.GetNumberOfCells() > 100), (count, True))

    def test_statistics(self):
        """The surface's field data do not hold the costs of the run, because another run for the same surface may have
        other costs."""
        self.assertEqual(vtkMarchingCorrectors().GetRunStatistics().GetNumberOfArrays(), 0)
        extract = sphere(self.make_particles())
        surface = self.good(extract, OutputPointsPrecision=1)
        data, found = surface.GetFieldData(), dict(statistics_of(extract))
        self.assertEqual({data.GetArrayName(i): data.GetArray(i).GetValue(0) for i in range(data.GetNumberOfArrays())},
                         {"TimeValue": 0.9, "IsoValues": 0.6})  # More arrays would fill ParaView's menus of colours.
        for name, value in {"Kernel": "cubic", "Field": "shepard", "SeedMode": "complete", "Topology": "table",
                            "BoundaryDetection": "weight_sum", "Scalar": "Radius", "SmoothingLengthArray": "SmoothingLength",
                            "VolumeArray": "Volume", "MassArray": "", "IsoValues": "0.6", "FluidParticles": "9261",
                            "AmbiguousFaces": "0", "CubeSize": "0.065", "Triangles": str(surface.GetNumberOfCells()),
                            "Points": str(surface.GetNumberOfPoints())}.items():
            self.assertEqual(found[name], [value], name)
        numbers = {name: statistic(extract, name) for name in ("VirtualCells", "CellsUsed", "CorrectionMax", "CorrectionMean",
                                                               "CorrectionStandardDeviation", "Area", "Volume")}
        self.assertTrue(numbers["VirtualCells"] > numbers["CellsUsed"] > 0)
        self.assertTrue(numbers["CorrectionMax"] >= numbers["CorrectionMean"] > 0 < numbers["CorrectionStandardDeviation"])
        self.assertNotEqual(found["Device"], [""])
        self.assertIn(f"Triangles: {surface.GetNumberOfCells()}\n", extract.GetStatistics())
        seconds = kept = extract.GetRunStatistics().GetArray("Seconds")
        names = [seconds.GetComponentName(i) for i in range(seconds.GetNumberOfComponents())]
        self.assertEqual((names[:2], names[-1]), (["input", "search grid"], "total"))
        self.assertGreater(seconds.GetComponent(0, len(names) - 1), 0)
        for name in ("DeviceBytesPeak", "Bricks", "NodesEvaluated", "MarchRounds"):
            self.assertEqual((statistic(extract, name) > 0, data.HasArray(name)), (True, 0))
        # vtkMassProperties measures the same area and volume. A surface that is cut off has no volume.
        masses = vtkMassProperties()
        masses.SetInputData(surface)
        self.assertAlmostEqual(numbers["Area"] / masses.GetSurfaceArea(), 1, delta=1e-5)
        self.assertAlmostEqual(-numbers["Volume"] / masses.GetVolume(), 1, delta=1e-5)  # Values above are outside.
        self.assertRegex(extract.GetSurfaceMeasures(), "^area [0-9.]+, volume -[0-9.]+$")
        self.good(extract, Box=(-2, 0, -2, 2, -2, 2), UseBox=1)
        self.assertFalse(extract.GetRunStatistics().HasArray("Volume"))
        self.assertTrue(0.3 < statistic(extract, "Area") / numbers["Area"] < 0.7)
        run(extract, vtkPolyData())
        self.assertEqual(extract.GetRunStatistics().GetNumberOfArrays(), 0)
        self.assertGreater(kept.GetNumberOfComponents(), 2)

    def test_cells_are_those_of_contour(self):
        contour, image = vtkContourFilter(), vtkRTAnalyticSource()
        image.SetWholeExtent(-5, 5, -5, 5, -5, 5)
        contour.SetInputConnection(image.GetOutputPort())
        contour.SetValue(0, 150.0)
        contour.Update()
        wanted, ours = contour.GetOutput().GetPolys(), self.good(sphere()).GetPolys()
        self.assertGreater(wanted.GetNumberOfCells(), 0)
        self.assertEqual(*((cells.IsStorage64Bit(), cells.GetConnectivityArray().GetDataType()) for cells in (ours, wanted)))

    def test_active_scalars(self):
        self.assertIsNone(self.good(make_filter()).GetPointData().GetScalars())  # No array varies: there is one iso value and one smoothing length.


class TestTold(FilterTest):
    def test_what_was_used(self):
        extract = make_filter()
        self.good(extract)
        self.assertEqual(extract.GetFluidScalarRange(), (RADIUS.min(), RADIUS.max()))
        self.assertEqual(extract.GetUsedIsoValues(), "0.3")
        self.assertEqual(extract.GetUsedSmoothingLength(), "0.13 (array hsml)")
        self.assertEqual((extract.GetUsedVolumeArrayName(), extract.GetUsedMassArrayName()), ("", ""))
        self.assertAlmostEqual(extract.GetUsedCubeSize(), 0.065)
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
        """The array, its range, the iso value and the number of cells are known without a run, with and without a box and blocks."""
        particles, ends = make_particles(), (RADIUS.min(), RADIUS.max())
        extract = vtkMarchingCorrectors()
        self.assertEqual((extract.GetNextScalarRange(), extract.GetNextCells()), ((0, 0), 0))
        extract.SetInputData(particles)
        self.assertEqual((extract.GetNextArray(), extract.GetNextComponents()), ("Radius", 1))  # This is the array that varies.
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
        extract.SetBox(-9, 9, -9, 9, -9, 0.05)  # The box holds 6 of 11 layers.
        self.assertAlmostEqual(extract.GetNextCells(), 8 * CELLS * 6 / 11, 3)
        extract.UseBoxOff()
        values_of(particles, "Radius")[0] = 7.0
        particles.GetPointData().GetArray("Radius").Modified()
        particles.Modified()
        self.assertEqual(extract.GetNextScalarRange(), (ends[0], 7.0))
        extract.SetInputData(blocks_of(make_particles(), particles))
        self.assertEqual(extract.GetNextScalarRange(), (ends[0], 7.0))
        self.assertAlmostEqual(extract.GetNextCells(), 2 * 8 * CELLS, 3)
        self.assertEqual(extract.GetFluidScalarRange(), (0, 0))  # Nothing has run yet.

    def test_huge_run_is_announced(self):
        """The warning about many cells comes before the run begins. This run is stopped as soon as the warning has
        come."""
        extract = make_filter()
        warnings = []
        extract.AddObserver("WarningEvent", lambda *_: warnings.append(extract.GetEstimatedCells()))
        on_progress(extract, lambda made: made.SetAbortExecute(len(warnings)))
        extract.SetCubeSize(1e-4)
        extract.Update()
        self.assertEqual(len(warnings), 1)
        self.assertAlmostEqual(warnings[0], 1331e9, -6)

    def test_state(self):
        extract = vtkMarchingCorrectors()
        self.assertEqual((extract.GetNumberOfContours(), extract.GetValue(0), extract.GetFreeSurfaceValue()), (0, 0, 0.5))
        extract.SetNumberOfFreeSurfaceValues(0)
        self.assertEqual(extract.GetFreeSurfaceValue(), 0.5)
        for name, settings in (("Value", (0, 1.0)), ("FreeSurfaceValue", (0.4,))):
            time = extract.GetMTime()
            getattr(extract, f"Set{name}")(*settings)
            self.assertGreater(extract.GetMTime(), time)
        extract.SetIterationLimit(1000)
        self.assertEqual(extract.GetIterationLimit(), 255)
        self.assertTrue(extract.SetKernelByName("quintic"))
        self.assertFalse(extract.SetKernelByName("no such kernel") or extract.SetKernelByName(None))
        self.assertEqual((extract.GetKernel(), extract.GetKernelName()), (vtkMarchingCorrectors.QUINTIC_SPLINE, "quintic"))
        for name, before, word, after in (("SeedMode", "COMPLETE", "Pairs", "PAIRS"),
                                          ("Topology", "TOPOLOGY_TABLE", "Field", "TOPOLOGY_FIELD"),
                                          ("BoundaryDetection", "WEIGHT_SUM", "Eigenvalue", "EIGENVALUE"),
                                          ("Kernel", "QUINTIC_SPLINE", "CubicSpline", "CUBIC_SPLINE")):
            self.assertEqual(getattr(extract, "Get" + name)(), getattr(vtkMarchingCorrectors, before))
            getattr(extract, f"Set{name}To{word}")()
            self.assertEqual(getattr(extract, "Get" + name)(), getattr(vtkMarchingCorrectors, after))
        self.assertIn(":", vtkMarchingCorrectors.ListDevices())
        for words in ("Cube Size Factor: 0.5", "Kernel: (cubic|0)", "Boundary Detection: (eigenvalue|1)", "Vertex Threshold: 0.5",
                      "Iteration Limit: 255"):  # The class in the wheel prints numbers.
            self.assertRegex(str(extract), words + "\n")

    def test_mode(self):
        """If the user chooses nothing, the filter makes the free surface, unless particles fill their bounds and are not known as a liquid."""
        x = lattice(20, 12, 8)
        there = x[(x[:, 2] < 0.4) | (x[:, 0] < 1)]  # a dam
        varying = 0.13 * (1 + 0.3 * numpy.sin(x[:, 0]))
        water, gas = {"Density": numpy.full(len(x), 1000.0)}, {"Density": numpy.exp(x[:, 0])}
        for points, arrays, is_free in ((there, {}, True), (x, {}, False), (x, water, True), (x, gas, False),
                                        (x, {**water, "h": varying}, False)):
            extract = vtkMarchingCorrectors()
            particles = particles_of(points, **{"h": numpy.full(len(points), 0.13), "Height": points[:, 2] + 2, **arrays})
            surface, told = run(extract, particles)
            used = (extract.GetFluidScalarRange() == (0, 0), extract.GetNextFreeSurface() == 1, extract.GetFreeSurface())
            self.assertEqual((used, told), ((is_free, is_free, -1), []))
            self.assertGreater(surface.GetNumberOfCells(), 0)
            run(extract, InputArrayToProcess=(0, 0, 0, 0, "Height"))
            self.assertNotEqual(extract.GetFluidScalarRange(), (0, 0))  # an array was chosen
        run(extract, FreeSurface=1)
        self.assertEqual(extract.GetFluidScalarRange(), (0, 0))
        extract = vtkMarchingCorrectors()
        extract.SetValue(0, 2.2)  # a value was given
        run(extract, particles_of(there, h=numpy.full(len(there), 0.13), Height=there[:, 2] + 2))
        self.assertNotEqual(extract.GetFluidScalarRange(), (0, 0))


if __name__ == "__main__":
    unittest.main()
