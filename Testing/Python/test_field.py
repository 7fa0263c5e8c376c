# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""vtkSPHDerivatives and vtkSPHProbe from Python: weird input first, then what users do."""
import math
import pathlib
import unittest

import numpy
from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE, VTK_VERTEX, vtkDataObject, vtkImageData, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersGeneral import vtkImageDataToPointSet
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHDerivatives, vtkSPHProbe
from vtk_test import add, bytes_of, particles_of, points_of, run, values_of

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
DATA = pathlib.Path(__file__).resolve().parents[2] / "Examples" / "Data"


def off_lattice(n, jitter):
    """n^3 places in [0, 1]^3, each so far off those of a lattice, in its spacings."""
    at = numpy.stack(numpy.meshgrid(*[numpy.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5
    return (at + jitter * numpy.random.default_rng(n).uniform(-1, 1, at.shape)) / n


def make_vortex(n):
    """A Taylor-Green vortex in [0, 1]^3."""
    places = off_lattice(n, 0.1).astype(numpy.float32)
    x, y = 2 * numpy.pi * places[:, :2].T
    velocity = numpy.stack([numpy.cos(x) * numpy.sin(y), -numpy.sin(x) * numpy.cos(y), 0 * x], axis=1)
    return particles_of(places, Velocity=velocity, h=numpy.full(n ** 3, 1.3 / n, numpy.float32))


def derive(particles, name="Velocity"):
    filter_ = vtkSPHDerivatives()
    filter_.SetInputArrayToProcess(0, 0, 0, POINTS, name)
    return run(filter_, particles)[0]


def vortex_errors(n):
    """Root mean squares of the errors of vorticity, Q and lambda2 inside, over the largest values."""
    data = derive(make_vortex(n))
    places = points_of(data)
    x, y = 2 * numpy.pi * places[:, :2].T
    # In units of 2 pi: J = [[-a, b, 0], [-b, a, 0], [0, 0, 0]]
    a, b = numpy.sin(x) * numpy.sin(y), numpy.cos(x) * numpy.cos(y)
    inside = numpy.all((places > 0.2) & (places < 0.8), axis=1)
    scale = 2 * numpy.pi
    found = (values_of(data, "Vorticity")[:, 2] / scale, values_of(data, "Q-criterion") / scale ** 2,
             values_of(data, "Lambda2") / scale ** 2)
    return [numpy.sqrt(((each - expected)[inside] ** 2).mean())
            for each, expected in zip(found, (-2 * b, b * b - a * a, a * a - b * b))]


def gradient_error(n, jitter):
    """The largest error of the corrected gradient of sin(3x) cos(2y) + z^2 inside [0, 1]^3, of n^3 particles."""
    at = off_lattice(n, jitter)
    x, y, z = at.T
    found = values_of(derive(particles_of(at, F=numpy.sin(3 * x) * numpy.cos(2 * y) + z ** 2, h=numpy.full(n ** 3, 1.3 / n),
                                          Volume=numpy.full(n ** 3, n ** -3.0)), "F"), "Gradients")
    exact = numpy.stack([3 * numpy.cos(3 * x) * numpy.cos(2 * y), -2 * numpy.sin(3 * x) * numpy.sin(2 * y), 2 * z], -1)
    inside = numpy.all((at > 0.3) & (at < 0.7), axis=1)
    return abs(found - exact)[inside].max()


class TestOrder(unittest.TestCase):
    def test_of_gradients(self):
        """Errors are of second order where particles lie on a lattice, else of first order, as those of corrected SPH gradients are."""
        self.assertGreater(math.log2(gradient_error(10, 0) / gradient_error(20, 0)), 1.8)
        self.assertGreater(math.log2(gradient_error(10, 0.1) / gradient_error(20, 0.1)), 0.9)


class TestPeriod(unittest.TestCase):
    """The Taylor-Green vortex repeats: its period is given, or found in the field data."""

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

    def test_derivatives_at_sides(self):
        derivatives = self.make_filters(make_vortex(16))[2]
        derivatives.CorrectGradientsOff()  # which are far off where neighbors are missing
        worst = []
        for sides in ((0,) * 6, (0, 1) * 3):
            data, _ = run(derivatives, PeriodicBounds=sides)
            x, y = 2 * numpy.pi * points_of(data)[:, :2].T
            worst.append(abs(values_of(data, "Vorticity")[:, 2] / (4 * numpy.pi) + numpy.cos(x) * numpy.cos(y)).max())
        self.assertGreater(worst[0], 0.4)
        self.assertLess(worst[1], 0.2)

    def test_points_a_period_apart(self):
        image, _ = run(self.make_filters(make_vortex(16))[0], PeriodicBounds=(0, 1) * 3)
        self.assertTrue((values_of(image, "vtkValidPointMask") == 1).all())
        for name in ("Velocity", "WeightSum"):
            plane = values_of(image, name).reshape(9, 9, -1)
            self.assertTrue((plane[4:8] == plane[:4]).all() and (plane[8] == plane[0]).all(), name)
            self.assertTrue((plane[:, 4:8] == plane[:, :4]).all() and (plane[:, 8] == plane[:, 0]).all(), name)

    def test_found_in_field_data(self):
        def content(data):
            return bytes_of(data) if data.IsA("vtkPointSet") else values_of(data, "WeightSum").tobytes()

        particles = make_vortex(12)
        size = particles_of([[0.0] * 3], BoxSize=numpy.ones(1)).GetPointData().GetArray("BoxSize")
        for filter_ in self.make_filters(particles):
            expected = content(run(filter_, PeriodicBounds=(0, 1) * 3)[0])
            _, told = run(filter_, PeriodicBounds=(0,) * 6, DetectPeriod=1)
            self.assertIn("give no period", filter_.GetErrorMessage())
            self.assertTrue(told)
            particles.GetFieldData().AddArray(size)
            filter_.Modified()
            found, told = run(filter_)
            self.assertEqual((told, filter_.GetErrorMessage() or ""), ([], ""))
            self.assertEqual(content(found), expected)
            particles.GetFieldData().RemoveArray("BoxSize")


class TestDerivatives(unittest.TestCase):
    def test_something_weird(self):
        data, told = run(vtkSPHDerivatives(), vtkPolyData())
        self.assertEqual((data.GetNumberOfPoints(), told), (0, []))

    def test_error_is_a_sentence(self):
        filter_ = vtkSPHDerivatives()
        filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Nonsense")
        run(filter_, make_vortex(5))
        self.assertRegex(filter_.GetErrorMessage(), "'Nonsense'.*Velocity, h")

    def test_taylor_green(self):
        """Twice as fine, about a quarter of the error."""
        coarse, fine = vortex_errors(12), vortex_errors(24)
        for name, a, b in zip(("vorticity", "Q", "lambda2"), coarse, fine):
            self.assertGreater(math.log2(a / b), 1.6, f"{name}: {a}, {b}")
            self.assertLess(b, 0.1, name)

    def test_chain(self):
        """Derived arrays can be contoured."""
        extract = vtkMarchingCorrectors()
        extract.SetInputArrayToProcess(0, 0, 0, POINTS, "Lambda2")
        surface, _ = run(extract, derive(make_vortex(20)), Value=(0, -15))
        self.assertGreater(surface.GetNumberOfCells(), 100)
        self.assertTrue(surface.GetPointData().HasArray("Vorticity"))

    def test_stored_arrays(self):
        """The file's own Vorticity and Lambda2, made by another program from the same velocities with
        1.3 times the smoothing length; zeros where it found too few neighbors."""
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(DATA / "dam_break_45k.vtp"))
        reader.Update()
        stored = vtkPolyData()
        stored.DeepCopy(reader.GetOutput())
        filter_ = vtkSPHDerivatives()
        filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Velocity")
        ours, _ = run(filter_, reader.GetOutput(), FluidArrayName="ParticleType", HScaleFactor=1.3)
        for name in ("Vorticity", "Lambda2"):
            found, theirs = (values_of(data, name).reshape(stored.GetNumberOfPoints(), -1) for data in (ours, stored))
            length = numpy.linalg.norm(theirs, axis=1)
            distances = numpy.linalg.norm(found - theirs, axis=1)[length > 0] / length[length > 0]
            self.assertGreater(len(distances), 42000)
            self.assertLess(numpy.median(distances), 1e-5, name)
            self.assertLess(numpy.quantile(distances, 0.99), 1e-4, name)


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

    def test_slice(self):
        probe = self.make()
        image, _ = run(probe)
        self.assertEqual(image.GetDimensions(), (8, 8, 1))
        self.assertTrue((values_of(image, "vtkValidPointMask") == 1).all())
        x, y = 2 * numpy.pi * numpy.array([image.GetPoint(i)[:2] for i in range(64)]).T
        self.assertLess(abs(values_of(image, "Velocity")[:, 0] - numpy.cos(x) * numpy.sin(y)).max(), 0.15)
        self.assertEqual(probe.GetUsedSmoothingLengthArrayName(), "h")

    def test_points_of_an_image(self):
        """They are computed row by row, in chunks: the same bits as at points that are stored."""
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

    def test_changed_arrays(self):
        """Arrays that a probe keeps are not taken for others."""
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

    def test_source(self):
        probe = self.make()
        self.assertEqual(probe.GetSource().GetNumberOfPoints(), 12 ** 3)
        self.assertIsNone(vtkSPHProbe().GetSource())
        image, _ = run(probe, SmoothingLengthArrayName="Nonsense")
        self.assertIn("'Nonsense'", probe.GetErrorMessage())
        self.assertEqual(image.GetNumberOfPoints(), 0)

    def test_particles_among_meshes(self):
        """Vertices beside other cells are the particles; derivatives come with these, in the class of the input."""
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


if __name__ == "__main__":
    unittest.main()
