# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""vtkSPHDerivatives and vtkSPHProbe from Python: weird input first, then what users do.

test_field.py DATA: the folder with dam_break_45k.vtp.
"""
import math
import pathlib
import sys
import unittest

import numpy
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkObject, vtkPoints
from vtkmodules.vtkCommonDataModel import (VTK_TRIANGLE, VTK_VERTEX, vtkDataObject, vtkImageData, vtkPolyData,
                                           vtkUnstructuredGrid)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkFiltersGeneral import vtkImageDataToPointSet
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHDerivatives, vtkSPHProbe

POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS
DATA = pathlib.Path(sys.argv.pop() if len(sys.argv) > 1 else ".")


def make_vortex(n):
    """A Taylor-Green vortex in [0, 1]^3, n^3 particles off their lattice."""
    particles, points = vtkPolyData(), vtkPoints()
    velocity, length = vtkFloatArray(), vtkFloatArray()
    velocity.SetName("Velocity")
    velocity.SetNumberOfComponents(3)
    length.SetName("h")
    state = 1
    for i in range(n ** 3):
        place = []
        for k in (i % n, i // n % n, i // n ** 2):
            state = (state * 1664525 + 1013904223) % 2 ** 32
            place.append((k + 0.5 + 0.2 * (state / 2 ** 32 - 0.5)) / n)
        x, y = (2 * math.pi * c for c in place[:2])
        points.InsertNextPoint(place)
        velocity.InsertNextTuple3(math.cos(x) * math.sin(y), -math.sin(x) * math.cos(y), 0)
        length.InsertNextValue(1.3 / n)
    particles.SetPoints(points)
    particles.GetPointData().AddArray(velocity)
    particles.GetPointData().AddArray(length)
    return particles


def derive(particles):
    filter_ = vtkSPHDerivatives()
    filter_.SetInputData(particles)
    filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Velocity")
    filter_.Update()
    return filter_.GetOutput()


def vortex_errors(n):
    """Root mean squares of the errors of vorticity, Q and lambda2 inside, over the largest values."""
    data = derive(make_vortex(n))
    arrays = [data.GetPointData().GetArray(name) for name in ("Vorticity", "Q-criterion", "Lambda2")]
    sums, count = [0.0, 0.0, 0.0], 0
    for i in range(data.GetNumberOfPoints()):
        place = data.GetPoint(i)
        if not all(0.2 < c < 0.8 for c in place):
            continue
        x, y = (2 * math.pi * c for c in place[:2])
        # In units of 2 pi: J = [[-a, b, 0], [-b, a, 0], [0, 0, 0]]
        a, b = math.sin(x) * math.sin(y), math.cos(x) * math.cos(y)
        expected = (-2 * b, b * b - a * a, a * a - b * b)
        scale = 2 * math.pi
        found = (arrays[0].GetComponent(i, 2) / scale, arrays[1].GetValue(i) / scale ** 2,
                 arrays[2].GetValue(i) / scale ** 2)
        for k in range(3):
            sums[k] += (found[k] - expected[k]) ** 2
        count += 1
    return [math.sqrt(s / count) for s in sums]


def gradient_error(n, jitter):
    """The largest error of the corrected gradient of sin(3x) cos(2y) + z^2 inside [0, 1]^3, of n^3 particles."""
    rng = numpy.random.default_rng(n)
    at = (numpy.stack(numpy.meshgrid(*[numpy.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) / n
    at += jitter / n * rng.uniform(-1, 1, at.shape)
    x, y, z = at.T
    particles, points = vtkPolyData(), vtkPoints()
    points.SetData(numpy_to_vtk(at, deep=1))
    particles.SetPoints(points)
    for name, values in (("F", numpy.sin(3 * x) * numpy.cos(2 * y) + z ** 2), ("h", numpy.full(n ** 3, 1.3 / n)),
                         ("Volume", numpy.full(n ** 3, n ** -3.0))):
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name)
        particles.GetPointData().AddArray(array)
    derivatives = vtkSPHDerivatives()
    derivatives.SetInputData(particles)
    derivatives.SetInputArrayToProcess(0, 0, 0, POINTS, "F")
    derivatives.Update()
    found = vtk_to_numpy(derivatives.GetOutput().GetPointData().GetArray("Gradients"))
    exact = numpy.stack([3 * numpy.cos(3 * x) * numpy.cos(2 * y), -2 * numpy.sin(3 * x) * numpy.sin(2 * y), 2 * z], -1)
    inside = numpy.all((at > 0.3) & (at < 0.7), axis=1)
    return abs(found - exact)[inside].max()


def bytes_of(data):
    """Of the points and all their arrays."""
    arrays = [data.GetPointData().GetArray(i) for i in range(data.GetPointData().GetNumberOfArrays())]
    return [bytes(memoryview(array)) for array in (data.GetPoints().GetData(), *arrays)]


class TestOrder(unittest.TestCase):
    def test_of_gradients(self):
        """Of second order where particles lie on a lattice, else of first order, as corrected SPH gradients are."""
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
            derivatives.SetPeriodicBounds(*sides)
            derivatives.Update()
            data = derivatives.GetOutput()
            vorticity = data.GetPointData().GetArray("Vorticity")
            worst.append(max(
                abs(vorticity.GetComponent(i, 2) / (4 * math.pi)
                    + math.cos(2 * math.pi * data.GetPoint(i)[0]) * math.cos(2 * math.pi * data.GetPoint(i)[1]))
                for i in range(data.GetNumberOfPoints())))
        self.assertGreater(worst[0], 0.4)
        self.assertLess(worst[1], 0.2)

    def test_points_a_period_apart(self):
        probe = self.make_filters(make_vortex(16))[0]
        probe.SetPeriodicBounds(*(0, 1) * 3)
        probe.Update()
        data = probe.GetOutput().GetPointData()
        self.assertEqual(data.GetArray("vtkValidPointMask").GetRange(), (1, 1))
        for name in ("Velocity", "WeightSum"):
            array = data.GetArray(name)
            for i in range(81):
                x, y = i % 9, i // 9
                self.assertEqual(array.GetTuple(i), array.GetTuple(x % 4 + 9 * (y % 4)), (name, i))

    def test_found_in_field_data(self):
        particles = make_vortex(12)
        for filter_ in self.make_filters(particles):
            filter_.SetPeriodicBounds(*(0, 1) * 3)
            filter_.Update()
            expected = bytes_of(filter_.GetOutput()) if filter_.GetOutput().IsA("vtkPointSet") else None
            weight = filter_.GetOutput().GetPointData().GetArray("WeightSum")
            filter_.SetPeriodicBounds(*(0,) * 6)
            filter_.DetectPeriodOn()
            errors = []
            filter_.AddObserver("ErrorEvent", lambda *_, errors=errors: errors.append(1))
            filter_.Update()
            self.assertIn("give no period", filter_.GetErrorMessage())
            self.assertTrue(errors)
            size = vtkFloatArray()
            size.SetName("BoxSize")
            size.InsertNextValue(1)
            particles.GetFieldData().AddArray(size)
            filter_.Modified()
            filter_.Update()
            self.assertEqual(filter_.GetErrorMessage() or "", "")
            if expected:
                self.assertEqual(bytes_of(filter_.GetOutput()), expected)
            else:
                found = filter_.GetOutput().GetPointData().GetArray("WeightSum")
                self.assertEqual(bytes(memoryview(found)), bytes(memoryview(weight)))
            particles.GetFieldData().RemoveArray("BoxSize")


class TestDerivatives(unittest.TestCase):
    def test_something_weird(self):
        filter_ = vtkSPHDerivatives()
        filter_.SetInputData(vtkPolyData())
        filter_.Update()
        self.assertEqual(filter_.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(filter_.GetErrorMessage(), "")

    def test_error_is_a_sentence(self):
        filter_ = vtkSPHDerivatives()
        filter_.SetInputData(make_vortex(5))
        filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Nonsense")
        vtkObject.GlobalWarningDisplayOff()
        filter_.Update()
        vtkObject.GlobalWarningDisplayOn()
        self.assertRegex(filter_.GetErrorMessage(), "'Nonsense'.*Velocity, h")

    def test_taylor_green(self):
        """Twice as fine, about a quarter of the error."""
        coarse, fine = vortex_errors(12), vortex_errors(24)
        for name, a, b in zip(("vorticity", "Q", "lambda2"), coarse, fine):
            self.assertGreater(math.log2(a / b), 1.6, f"{name}: {a}, {b}")
            self.assertLess(b, 0.1, name)

    def test_chain(self):
        """What is derived can be contoured."""
        extract = vtkMarchingCorrectors()
        extract.SetInputData(derive(make_vortex(20)))
        extract.SetInputArrayToProcess(0, 0, 0, POINTS, "Lambda2")
        extract.SetValue(0, -15)
        extract.Update()
        self.assertGreater(extract.GetOutput().GetNumberOfCells(), 100)
        self.assertTrue(extract.GetOutput().GetPointData().HasArray("Vorticity"))

    def test_stored_arrays(self):
        """The file's own Vorticity and Lambda2, made by another program from the same velocities with
        1.3 times the smoothing length; zeros where it found too few neighbors."""
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(DATA / "dam_break_45k.vtp"))
        reader.Update()
        stored = vtkPolyData()
        stored.DeepCopy(reader.GetOutput())
        filter_ = vtkSPHDerivatives()
        filter_.SetInputData(reader.GetOutput())
        filter_.SetInputArrayToProcess(0, 0, 0, POINTS, "Velocity")
        filter_.SetFluidArrayName("ParticleType")
        filter_.SetHScaleFactor(1.3)
        filter_.Update()
        ours, theirs = filter_.GetOutput().GetPointData(), stored.GetPointData()
        for name, components in (("Vorticity", 3), ("Lambda2", 1)):
            a, b = ours.GetArray(name), theirs.GetArray(name)
            distances = []
            for i in range(stored.GetNumberOfPoints()):
                x, y = a.GetTuple(i), b.GetTuple(i)
                if any(y):
                    distances.append(math.dist(x, y) / math.hypot(*y))
            distances.sort()
            self.assertGreater(len(distances), 42000)
            self.assertEqual(a.GetNumberOfComponents(), components)
            self.assertLess(distances[len(distances) // 2], 1e-5, name)
            self.assertLess(distances[len(distances) * 99 // 100], 1e-4, name)


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
        probe.Update()
        image = probe.GetOutput()
        self.assertEqual(image.GetDimensions(), (8, 8, 1))
        data = image.GetPointData()
        self.assertEqual(data.GetArray("vtkValidPointMask").GetRange(), (1, 1))
        for i in range(image.GetNumberOfPoints()):
            x, y = (2 * math.pi * c for c in image.GetPoint(i)[:2])
            speed = math.cos(x) * math.sin(y)
            self.assertAlmostEqual(data.GetArray("Velocity").GetComponent(i, 0), speed, delta=0.15)
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
        probe = self.make()
        results = []
        for points in (image, convert.GetOutput()):
            probe.SetInputData(points)
            probe.Update()
            data = probe.GetOutput().GetPointData()
            results.append([vtk_to_numpy(data.GetArray(name)).tobytes() for name in ("WeightSum", "Velocity")])
            self.assertEqual(data.GetArray("vtkValidPointMask").GetRange(), (0, 1))
        self.assertTrue(results[0] == results[1])

    def test_changed_arrays(self):
        """What a probe keeps of the arrays is not taken for others."""
        probe = self.make()
        probe.Update()
        particles = probe.GetSource()
        velocity = particles.GetPointData().GetArray("Velocity")
        before = probe.GetOutput().GetPointData().GetArray("Velocity").GetTuple(20)
        twice = vtkFloatArray()
        twice.DeepCopy(velocity)
        for i in range(velocity.GetNumberOfTuples()):
            twice.SetTuple3(i, *(2 * x for x in velocity.GetTuple(i)))
        particles.GetPointData().AddArray(twice)
        probe.Update()
        after = probe.GetOutput().GetPointData().GetArray("Velocity").GetTuple(20)
        self.assertEqual(after, tuple(2 * x for x in before))
        probe.AddExcludedArray("h")
        probe.Update()
        self.assertEqual(probe.GetOutput().GetPointData().GetArray("Velocity").GetTuple(20), after)

    def test_source(self):
        probe = self.make()
        self.assertEqual(probe.GetSource().GetNumberOfPoints(), 12 ** 3)
        self.assertIsNone(vtkSPHProbe().GetSource())
        probe.SetSmoothingLengthArrayName("Nonsense")
        vtkObject.GlobalWarningDisplayOff()
        probe.Update()
        vtkObject.GlobalWarningDisplayOn()
        self.assertIn("'Nonsense'", probe.GetErrorMessage())
        self.assertEqual(probe.GetOutput().GetNumberOfPoints(), 0)

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
        without = vtkPolyData()
        without.SetPoints(vtkPoints())
        without.GetPointData().CopyAllocate(particles.GetPointData())
        for i in range(3, count):
            without.GetPointData().CopyData(particles.GetPointData(), i,
                                            without.GetPoints().InsertNextPoint(particles.GetPoint(i)))
        expected = derive(without)
        vtkObject.GlobalWarningDisplayOff()
        found = derive(mesh)
        vtkObject.GlobalWarningDisplayOn()
        self.assertEqual((found.GetClassName(), found.GetNumberOfCells()), ("vtkUnstructuredGrid", count - 3))
        self.assertEqual(bytes_of(found), bytes_of(expected))


if __name__ == "__main__":
    unittest.main()
