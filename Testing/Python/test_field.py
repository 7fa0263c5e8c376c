# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests vtkSPHDerivatives, vtkSPHProbe and vtkSPHResample: first with odd input, then against brute force and known fields."""
import math
import unittest

import numpy
from vtkmodules.vtkCommonDataModel import (
    VTK_TRIANGLE, VTK_VERTEX, vtkImageData, vtkPointSet, vtkPolyData, vtkRectilinearGrid, vtkUnstructuredGrid)
from vtkmodules.vtkFiltersGeneral import vtkImageDataToPointSet

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHDerivatives, vtkSPHProbe, vtkSPHResample
from vtk_test import (
    COUNT, H, POINTS, aborted, add, blocks_of, bytes_of, cube, particles_of, points_of, run, says, take, values_of)


def off_lattice(n, jitter):
    """Returns n^3 places in [0, 1]^3: a lattice, with each coordinate changed by up to `jitter` spacings."""
    at = numpy.stack(numpy.meshgrid(*[numpy.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5
    return (at + jitter * numpy.random.default_rng(n).uniform(-1, 1, at.shape)) / n


def make_vortex(n):
    """Makes a Taylor-Green vortex in [0, 1]^3."""
    places = off_lattice(n, 0.1).astype(numpy.float32)
    x, y = 2 * numpy.pi * places[:, :2].T
    velocity = numpy.stack([numpy.cos(x) * numpy.sin(y), -numpy.sin(x) * numpy.cos(y), 0 * x], axis=1)
    return particles_of(places, Velocity=velocity, h=numpy.full(n ** 3, 1.3 / n, numpy.float32))


def derive(particles):
    filter_ = vtkSPHDerivatives()
    filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Velocity")
    return run(filter_, particles)[0]


class TestPeriod(unittest.TestCase):
    """Tests a period that is given, or found in the field data, with the Taylor-Green vortex, which repeats. core_period_fields tests the
    field."""

    def make_filters(self, particles):
        plane = vtkImageData()
        plane.SetDimensions(9, 9, 1)
        plane.SetOrigin(-0.5, -0.5, 0)
        plane.SetSpacing(0.25, 0.25, 1)
        probe, surface, derivatives = vtkSPHProbe(), vtkMarchingCorrectors(), vtkSPHDerivatives()
        probe.SetInputData(plane)
        probe.SetSourceData(particles)
        for filter_ in (surface, derivatives):
            filter_.SetInputData(particles)
            filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Velocity")
        surface.SetValue(0, 0.5)
        return probe, surface, derivatives

    def test_found_in_field_data(self):
        def content(data):
            return bytes_of(data) if data.IsA("vtkPointSet") else values_of(data, "WeightSum").tobytes()

        particles = make_vortex(12)
        size = particles_of([[0.0] * 3], BoxSize=numpy.ones(1)).GetPointData().GetArray("BoxSize")
        cell = particles_of([[0.0] * 3], PeriodicBounds=numpy.array([1.0, 0, 0, 0.5, 1, 0, 0, 0, 1])).GetPointData().GetArray("PeriodicBounds")
        for filter_ in self.make_filters(particles):
            plain, expected = (content(run(filter_, PeriodicBounds=bounds)[0]) for bounds in ((0,) * 6, (0, 1) * 3))
            self.assertNotEqual(plain, expected)
            _, told = run(filter_, PeriodicBounds=(0,) * 6, DetectPeriod=1)
            self.assertRegex(filter_.GetErrorMessage(), says("NO_PERIOD"))
            self.assertTrue(told)
            particles.GetFieldData().AddArray(cell)
            filter_.Modified()
            run(filter_)
            self.assertRegex(filter_.GetErrorMessage(), says("CELL_TILTED"))
            particles.GetFieldData().RemoveArray("PeriodicBounds")
            particles.GetFieldData().AddArray(size)
            filter_.Modified()
            found, told = run(filter_)
            self.assertEqual((told, filter_.GetErrorMessage() or ""), ([], ""))
            self.assertEqual(content(found), expected)
            particles.GetFieldData().RemoveArray("BoxSize")


class TestDerivatives(unittest.TestCase):
    def test_refused(self):
        """Each fault gives a message and an empty output. An empty input is no fault."""
        data, told = run(vtkSPHDerivatives(), vtkPolyData())
        self.assertEqual((data.GetNumberOfPoints(), told), (0, []))
        broken, bare = cube(), cube()
        values_of(broken, "Radius")[5] = math.nan
        bare.GetPointData().RemoveArray("SmoothingLength")
        alone = particles_of(points_of(cube()), SmoothingLength=numpy.full(COUNT, H))  # No array varies.
        for particles, name, words in ((cube(), "Nonsense", says("NO_SUCH_ARRAY", "'Nonsense'")), (alone, None, says("NO_ARRAY")),
                                       (broken, "Radius", "particle 5"), (bare, "Radius", says("NO_SMOOTHING_LENGTH"))):
            made = vtkSPHDerivatives()
            data, told = run(made, particles, **({"InputArrayToProcess": (0, 0, 0, POINTS, name)} if name else {}))
            self.assertEqual((data.GetNumberOfPoints(), len(told)), (0, 1))
            self.assertRegex(made.GetErrorMessage(), words)

    def test_linear(self):
        """Derivatives of a rotation and of a shear are exact."""
        rotation = numpy.array([[0, -0.5, -0.2], [0.5, 0, -0.3], [0.2, 0.3, 0]])  # w = (0.3, -0.2, 0.5)
        shear = numpy.array([[0.0, 2, 0], [0, 0, 0], [0, 0, 0]])
        for j, lambda2 in ((rotation, -0.38), (shear, 0)):  # A rotation has lambda2 = -|w|^2; a shear has 0, since S S + O O is 0.
            for precision, kind, tolerance in ((1, "f8", 1e-12), (0, "f4", 1e-5)):
                data, _ = run(vtkSPHDerivatives(), cube(Velocity=(points_of(cube()) @ j.T + 7).astype(kind)), Precision=precision,
                              ComputeStrainRate=1, InputArrayToProcess=(0, 0, 0, POINTS, "Velocity"))
                self.assertEqual(values_of(data, "Gradients").dtype, kind)
                self.assertEqual(set(values_of(data, "GradientsCorrected")), {1})
                for name, expected in (
                        ("Gradients", j.ravel()), ("Divergence", 0), ("StrainRate", (j + j.T).ravel() / 2),
                        ("Vorticity", [j[2, 1] - j[1, 2], j[0, 2] - j[2, 0], j[1, 0] - j[0, 1]]),
                        ("Q-criterion", -0.5 * (j * j.T).sum()), ("Lambda2", lambda2)):
                    self.assertLess(abs(values_of(data, name) - expected).max(), 4 * tolerance, name)

    def test_solids(self):
        """Derivatives are 0 on walls, and walls do not count for the fluid. Arrays of the input stay, unless ReplaceArrays is on."""
        x = points_of(cube())
        solid = x[:, 2] < -0.5
        velocity = numpy.stack([numpy.where(solid, math.nan, 2 * x[:, 1]), *0 * x[:, 1:].T], axis=1)
        particles = cube(Velocity=velocity, Type=numpy.where(solid, 4, 1).astype(numpy.uint8), Lambda2=numpy.full(COUNT, 17.0))
        made = vtkSPHDerivatives()  # Its array is Velocity.
        data, _ = run(made, particles, FluidArrayName="Type", FluidValue=1, ResultArrayName="Slope", ComputeQCriterion=0)
        self.assertLess(abs(values_of(data, "Slope")[:, 1] - numpy.where(solid, 0, 2)).max(), 1e-5)
        self.assertEqual(values_of(data, "SlopeCorrected").tolist(), (~solid).astype(int).tolist())
        self.assertLess(abs(values_of(data, "Lambda2_SPH")[~solid]).max(), 1e-4)
        arrays = data.GetPointData()
        self.assertFalse(arrays.HasArray("Q-criterion") or arrays.HasArray("StrainRate"))
        self.assertIs(arrays.GetArray("Type"), particles.GetPointData().GetArray("Type"))
        self.assertEqual(set(values_of(particles, "Lambda2")), {17})
        replaced = run(made, ReplaceArrays=1)[0].GetPointData()
        self.assertFalse(replaced.HasArray("Lambda2_SPH"))
        self.assertLess(replaced.GetArray("Lambda2").GetRange()[1], 1)
        data, told = run(made, FluidValue=2)
        self.assertEqual((len(told), made.GetErrorMessage(), data.GetNumberOfPoints()), (1, "", COUNT))

    def test_found_fluid(self):
        """Every filter finds the fluid as SPH Contour does."""
        particles, probe = cube(ParticleType=(points_of(cube())[:, 2] < -0.45).astype(numpy.int32)), vtkSPHProbe()
        probe.SetSourceData(particles)
        for made, data in ((vtkSPHDerivatives(), particles), (probe, cube())):
            told, = run(made, data)[1]
            self.assertRegex(told, says("TYPE_UNUSED", "'ParticleType'"))
            self.assertEqual(made.GetUsedFluid(), "")
            self.assertEqual((run(made, DetectFluid=1)[1], made.GetUsedFluid()), ([], "ParticleType = 0"))

    def test_outputs(self):
        """Tests input of another class, the standard form of the gradient, and a run that is stopped."""
        grid, made = vtkUnstructuredGrid(), vtkSPHDerivatives()
        grid.SetPoints(cube().GetPoints())
        grid.GetPointData().ShallowCopy(cube().GetPointData())
        data, _ = run(made, grid, InputArrayToProcess=(0, 0, 0, POINTS, "Radius"), CorrectGradients=0)
        self.assertEqual((data.GetClassName(), set(values_of(data, "GradientsCorrected"))), ("vtkUnstructuredGrid", {0}))
        self.assertFalse(data.GetPointData().HasArray("Vorticity") or data.GetPointData().HasArray("Lambda2"))
        self.assertEqual(aborted(made).GetNumberOfPoints(), 0)

    def test_derivatives(self):
        """Particles stay in their blocks, and particles of different blocks are neighbours."""
        data = cube()
        left = points_of(data)[:, 0] < 0.05
        outputs = []
        for each in (data, blocks_of(take(data, left), None, take(data, ~left))):
            derivatives = vtkSPHDerivatives()
            derivatives.SetInputArrayToProcess(0, 0, 0, POINTS, "Radius")
            outputs.append(run(derivatives, each)[0])
        whole, blocks = outputs
        self.assertIsNone(blocks.GetBlock(1))
        for i, chosen in ((0, left), (2, ~left)):
            self.assertEqual(values_of(blocks.GetBlock(i), "Gradients").tobytes(), values_of(whole, "Gradients")[chosen].tobytes())
            self.assertTrue(blocks.GetBlock(i).GetPointData().HasArray("Radius"))


class TestProbe(unittest.TestCase):
    def make(self):
        image = vtkImageData()
        image.SetDimensions(8, 8, 1)
        image.SetSpacing(0.1, 0.1, 1)
        image.SetOrigin(0.15, 0.15, 0.5)
        probe = vtkSPHProbe()
        probe.SetInputData(image)
        probe.SetSourceData(make_vortex(12))
        return probe

    def test_points_of_an_image(self):
        """Points of an image are computed row by row, in chunks; stored points give the same bits."""
        image = vtkImageData()
        image.SetExtent(3, 1033, -5, 511, 7, 8)  # more than one chunk of points
        image.SetSpacing(0.0011, 0.0009, 0.3)
        image.SetOrigin(0.7, 0.1, -1.9)
        image.SetDirectionMatrix(0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1)
        convert = vtkImageDataToPointSet()
        convert.SetInputData(image)
        convert.Update()
        self.assertEqual(convert.GetOutput().GetPoint(540000), image.GetPoint(540000))
        results = []
        for points in (image, convert.GetOutput()):
            found, _ = run(self.make(), points)
            results.append([values_of(found, name).tobytes() for name in ("WeightSum", "Velocity")])
            self.assertEqual(set(values_of(found, "vtkValidPointMask")), {0, 1})
        self.assertTrue(results[0] == results[1])

    def test_point_sets(self):
        """A vtkPointSet, points without cells, works alone and as a block, though VTK 9.1 cannot make an object of this
        class by its name."""
        points = vtkPointSet()
        points.ShallowCopy(self.make().GetSource())
        for filter_ in (self.make(), vtkSPHDerivatives()):
            filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Velocity")
            expected = bytes_of(run(filter_, self.make().GetSource())[0])
            blocks, _ = run(filter_, blocks_of(points), Blocks=vtkSPHProbe.APART)
            for found in (run(filter_, points)[0], blocks.GetBlock(0)):
                self.assertEqual(found.GetClassName(), "vtkPointSet")
                self.assertTrue(bytes_of(found) == expected)

    def test_changed_arrays(self):
        """A probe keeps arrays between runs, but does not use them if an array was replaced or changed."""
        probe = self.make()
        before = values_of(run(probe)[0], "Velocity").copy()
        velocity = probe.GetSource().GetPointData().GetArray("Velocity")
        twice = velocity.NewInstance()
        twice.DeepCopy(velocity)
        add(probe.GetSource(), Velocity=twice)
        values_of(probe.GetSource(), "Velocity")[:] *= 2
        after = values_of(run(probe)[0], "Velocity").copy()
        self.assertTrue((after == 2 * before).all())
        probe.AddExcludedArray("h")
        self.assertTrue((values_of(run(probe)[0], "Velocity") == after).all())

    def probe(self, points, particles, **settings):
        self.made = vtkSPHProbe()
        self.made.SetSourceData(particles)
        return run(self.made, points, **settings)[0]

    def places(self, count):
        """Returns `count` places in and around the cube; every fiftieth place is far away."""
        places = numpy.random.default_rng(7).uniform(-1.3, 1.3, (count, 3))
        places[::50] *= 4e5
        return places

    def test_bits(self):
        """No bit depends on the order of points, their class, whether device data are kept, or whether particles are in blocks."""
        particles, places = cube(), self.places(5000)
        expected = self.probe(particles_of(places), particles)
        back = self.probe(particles_of(places[::-1]), particles, KeepDeviceData=0)
        for name in ("Radius", "WeightSum"):
            self.assertEqual(values_of(back, name)[::-1].tobytes(), values_of(expected, name).tobytes())
        image, grid = vtkImageData(), vtkRectilinearGrid()
        image.SetExtent(-5, 5, 2, 12, 0, 0)
        image.SetSpacing(0.125, 0.125, 0.125)
        grid.SetExtent(image.GetExtent())
        for axis, values in (("X", range(-5, 6)), ("Y", range(2, 13)), ("Z", [0])):
            getattr(grid, f"Set{axis}Coordinates")(add(vtkPolyData(), x=0.125 * numpy.array(values, float)).GetPointData().GetArray(0))
        both = self.probe(blocks_of(image, grid), particles)
        self.assertEqual(*(values_of(both.GetBlock(i), "Radius").tobytes() for i in range(2)))
        self.assertEqual((both.GetBlock(0).GetExtent(), values_of(both.GetBlock(0), "WeightSum")[20] > 0.5),
                         (image.GetExtent(), True))
        halves = [take(particles, slice(half, None, 2)) for half in range(2)]
        halves[1].GetPointData().RemoveArray("Radius")  # An array is used only if all blocks have it.
        joined = self.probe(particles_of(places), blocks_of(*halves))
        self.assertEqual(values_of(joined, "WeightSum").tobytes(), values_of(expected, "WeightSum").tobytes())
        self.assertFalse(joined.GetPointData().HasArray("Radius"))

    def test_solids(self):
        places = self.places(500)
        particles = cube(Type=(points_of(cube())[:, 0] > 0).astype(int))
        data = self.probe(particles_of(places), particles, FluidArrayName="Type")
        self.assertFalse(values_of(data, "WeightSum")[places[:, 0] > 0.3].any())
        self.assertGreater(values_of(data, "WeightSum").max(), 0.9)
        self.assertFalse(data.GetPointData().HasArray("Type"))

    def test_refused(self):
        """The filter gives empty results or errors, and does not crash: without points, without particles, with input
        that cannot be used, and if it is stopped."""
        data = self.probe(particles_of(self.places(100)), vtkPolyData())
        self.assertEqual((values_of(data, "vtkValidPointMask").tolist(), self.made.GetErrorMessage()), ([0] * 100, ""))
        data = self.probe(vtkPolyData(), cube())
        self.assertEqual((data.GetPointData().GetArray("Radius").GetNumberOfTuples(), self.made.GetErrorMessage()), (0, ""))
        for port, word in ((0, "points"), (1, "particles")):
            forgotten = vtkSPHProbe()
            forgotten.SetInputDataObject(1 - port, cube())
            self.assertEqual((len(run(forgotten)[1]), word in forgotten.GetErrorMessage()), (1, True))
        particles = cube()
        values_of(particles, "Radius")[3] = math.nan
        self.assertFalse(self.probe(particles_of(self.places(100)), particles).GetPointData().HasArray("Radius"))
        data, told = run(self.made, InterpolateAttributes=0, ValidPointMaskArrayName="Mask")
        self.assertEqual((data.GetPointData().GetNumberOfArrays(), data.GetPointData().HasArray("Mask"), told), (2, 1, []))
        data, told = run(self.made, SmoothingLengthArrayName="Nonsense")
        self.assertEqual((data.GetNumberOfPoints(), len(told), "'Nonsense'" in told[0]), (0, 1, True))
        self.made.SetSmoothingLengthArrayName("")
        self.assertEqual(aborted(self.made).GetNumberOfPoints(), 0)
        self.assertIs(self.made.GetSource(), particles)
        self.assertIsNone(vtkSPHProbe().GetSource())

    def test_particles_among_meshes(self):
        """If there are vertices beside other cells, the vertices' points are the particles. Derivatives are made for these points alone.
        The output has the input's class."""
        particles, mesh = make_vortex(8), vtkUnstructuredGrid()
        count = particles.GetNumberOfPoints()
        mesh.SetPoints(particles.GetPoints())
        mesh.GetPointData().ShallowCopy(particles.GetPointData())
        mesh.Allocate(count + 1)
        mesh.InsertNextCell(VTK_TRIANGLE, 3, [0, 1, 2])
        for i in range(3, count):
            mesh.InsertNextCell(VTK_VERTEX, 1, [i])
        expected = derive(particles_of(points_of(particles)[3:], Velocity=values_of(particles, "Velocity")[3:],
                                       h=values_of(particles, "h")[3:]))
        found = derive(mesh)
        self.assertEqual((found.GetClassName(), found.GetNumberOfCells()), ("vtkUnstructuredGrid", count - 3))
        self.assertEqual(bytes_of(found), bytes_of(expected))


class TestResample(unittest.TestCase):
    """Tests slices, lines and volumes: where their points are, the probe's values at them, and NaN outside."""

    def setUp(self):
        self.particles, self.made = cube(Velocity=points_of(cube()) + 3), vtkSPHResample()
        run(self.made, self.particles, Resolution=41, WeightThreshold=0.4)  # With this threshold the fluid ends before the points do.

    def check_values(self, **settings):
        made, _ = run(self.made, **settings)
        self.assertEqual(self.made.GetErrorMessage(), "")
        probe, bare = vtkSPHProbe(), made.NewInstance()
        bare.CopyStructure(made)
        probe.SetSourceData(self.particles)
        expected, _ = run(probe, bare, WeightThreshold=0.4)
        self.assertEqual(values_of(made, "WeightSum").tobytes(), values_of(expected, "WeightSum").tobytes())
        self.assertEqual(made.GetPointData().GetScalars().GetName(), "Velocity")
        valid = values_of(made, "vtkValidPointMask") != 0
        self.assertEqual(values_of(made, "Radius")[valid].tolist(), values_of(expected, "Radius")[valid].tolist())
        self.assertTrue(numpy.isnan(values_of(made, "Radius")[~valid]).all())
        self.assertTrue(10 < valid.sum() < len(valid))
        return made

    def test_slice(self):
        made = self.check_values(Normal=(0, 2, 0))
        low, high = points_of(made).min(axis=0), points_of(made).max(axis=0)
        self.assertTrue(41 * 40 <= made.GetNumberOfPoints() <= 41 * 41)
        self.assertTrue(abs(low[1]) < 0.02 and low[1] == high[1] and -1.2 < low[0] < -1 and 1 < high[2] < 1.2)
        self.assertTrue(900 < made.GetNumberOfCells() < 40 * 39)  # Quads end where the fluid ends.
        self.assertGreaterEqual(run(self.made, OnlyFluid=0)[0].GetNumberOfCells(), 40 * 39)
        # All points of an inclined slice lie in one plane. This plane cuts off a corner of the cube.
        x = points_of(self.check_values(FitBounds=0, Origin=(0.5, 0.5, 0.5), Normal=(1, 1, 1)))
        self.assertLess(abs(x.sum(axis=1) - 1.5).max(), 1e-12)
        self.assertTrue(x[:, 0].min() < 0 and x[:, 0].max() > 1)
        made, told = run(self.made, Origin=(5, 0, 0), Normal=(1, 0, 0))  # The plane lies beside the fluid.
        self.assertEqual((made.GetNumberOfPoints(), told), (0, []))

    def test_line(self):
        made = self.check_values(Shape=vtkSPHResample.LINE, FitBounds=0, Point1=(-2, 0.1, 0.1), Point2=(2, 0.1, 0.1))
        self.assertEqual((made.GetNumberOfPoints(), made.GetNumberOfLines()), (41, 1))
        self.assertLess(abs(values_of(made, "arc_length") - 0.1 * numpy.arange(41)).max(), 1e-12)
        self.assertTrue(2 < run(self.made, FitBounds=1)[0].GetLength() < 2.3)

    def test_volume(self):
        made = self.check_values(Shape=vtkSPHResample.VOLUME, Dimensions=(20, 10, 5))
        self.assertEqual(made.GetDimensions(), (20, 10, 5))
        self.assertTrue(made.GetBounds()[0] < -1 and made.GetBounds()[5] > 1)
        made, _ = run(self.made, FitBounds=0, Bounds=(0, 3, 0, 0.5, -0.5, 0.5), NaNOutside=0, NullValue=-9)
        self.assertRegex(str(self.made), r"\n +NaN Outside: 0\n *Null Value: -9\n")
        self.assertEqual((made.GetBounds()[1], values_of(made, "Radius").min()), (3, -9))
        self.assertTrue(run(self.made, Shape=vtkSPHResample.SLICE)[0].IsA("vtkPolyData"))  # The output has another class.

    def test_inputs(self):
        """Walls count neither in the field nor in the bounds. Blocks are one set. Without particles there is no
        error."""
        add(self.particles, ParticleType=(points_of(self.particles)[:, 0] > 0.05).astype(int))
        made, _ = run(self.made, blocks_of(self.particles), DetectFluid=1)
        self.assertEqual(self.made.GetUsedFluid(), "ParticleType = 0")
        self.assertTrue(points_of(made)[:, 0].max() < 0.2 and made.GetNumberOfCells() > 0)
        made, told = run(self.made, vtkPolyData())
        self.assertEqual((made.GetNumberOfPoints(), self.made.GetErrorMessage()), (0, ""))


if __name__ == "__main__":
    unittest.main()
