# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that vtkSPHTemporalInterpolator moves particles between stored steps on known paths."""
import math
import unittest

import numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkIdTypeArray, vtkSMPTools, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHTemporalInterpolator
from vtk_test import add, blocks_of, lattice, particles_of, points_of, run, says, values_of

RATE = 2.0  # The rotation is in radians per unit of time.
START = lattice(7, 7, 7, around_origin=True)


def turned(time):
    """Returns the places and velocities of the particles of START at this time. The particles turn around the z axis and fall."""
    c, s = math.cos(RATE * time), math.sin(RATE * time)
    x, y, z = START.T
    a, b = c * x - s * y, s * x + c * y
    return (numpy.stack([a, b, z - 0.5 * time ** 2], axis=1),
            numpy.stack([-RATE * b, RATE * a, numpy.full(len(a), -time)], axis=1))


def rotating(time, numbers=range(343), ids=numpy.int64):
    """Returns the particles with these numbers, in this order; Heat is linear in time."""
    numbers = numpy.array(numbers)
    places, velocities = turned(time)
    return particles_of(places[numbers], Velocity=velocities[numbers], Idp=numbers.astype(ids), Heat=numbers + 10.0 * time,
                        Kind=(numbers % 2 + 2 * (time > 0)).astype(numpy.int32), SmoothingLength=numpy.full(len(numbers), 0.13),
                        Volume=numpy.full(len(numbers), 1e-3))


def few(places, ids, velocities, **arrays):
    return particles_of(numpy.array(places, float), id=numpy.array(ids, numpy.int32), Velocity=numpy.array(velocities, float),
                        **{name: numpy.array(values, float) for name, values in arrays.items()})


class Steps(VTKPythonAlgorithmBase):
    """A reader of the data in {time: data}. `read` lists the times that were read; times in `broken` fail."""

    def __init__(self, steps):
        kind = next(iter(steps.values())).GetClassName()
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=kind)
        self.steps = dict(sorted(steps.items()))
        self.read = []
        self.broken = ()

    def RequestInformation(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        times = list(self.steps)
        info.Set(Pipeline.TIME_STEPS(), times, len(times))
        info.Set(Pipeline.TIME_RANGE(), [times[0], times[-1]], 2)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        time = info.Get(Pipeline.UPDATE_TIME_STEP()) if info.Has(Pipeline.UPDATE_TIME_STEP()) \
            else next(iter(self.steps))
        self.read.append(time)
        if time in self.broken:
            return 0
        output = self.GetOutputDataObject(0)
        output.ShallowCopy(self.steps[time])
        output.GetInformation().Set(output.DATA_TIME_STEP(), time)
        return 1


def interpolator(steps):
    source = steps if isinstance(steps, Steps) else Steps(steps)
    result = vtkSPHTemporalInterpolator()
    result.SetInputConnection(source.GetOutputPort())
    result.source = source  # The result keeps its source alive.
    return result


class TestTemporal(unittest.TestCase):
    def told(self, film, time, **settings):
        """Returns the filter's messages in an update to this time."""
        film.UpdateInformation()
        film.GetOutputInformation(0).Set(Pipeline.UPDATE_TIME_STEP(), time)
        return run(film, **settings)[1]

    def at(self, film, time, **settings):
        """Returns the output at this time, which must come without an error."""
        self.told(film, time, **settings)
        self.assertEqual(film.GetErrorMessage(), "")
        return film.GetOutputDataObject(0)

    def refuse(self, film, time, words, **settings):
        self.told(film, time, **settings)
        self.assertRegex(film.GetErrorMessage(), words)

    def farthest(self, particles, time):
        return numpy.linalg.norm(points_of(particles) - turned(time)[0][values_of(particles, "Idp")], axis=1).max()

    def assert_points(self, particles, places):
        self.assertEqual(points_of(particles).tolist(), [list(map(float, place)) for place in places])

    # ---- Odd input ----

    def test_no_particles(self):
        none = particles_of(numpy.empty((0, 3)))
        for first, times in ((none, {0.0: 0, 0.3: 0, 1.0: 0}), (rotating(0.0), {0.3: 343, 0.7: 0})):
            film = interpolator({0.0: first, 1.0: none})
            self.assertEqual({time: self.at(film, time).GetNumberOfPoints() for time in times}, times)

    def test_no_steps(self):
        """Particles without times are passed on, whatever time is requested."""
        fixed = vtkSPHTemporalInterpolator()
        self.assertEqual(run(fixed, rotating(0.0))[0].GetNumberOfPoints(), 343)
        self.assertEqual(self.at(fixed, 0.7).GetNumberOfPoints(), 343)

    def test_outside(self):
        film = interpolator({0.0: rotating(0.0), 1.0: rotating(1.0)})
        self.assert_points(self.at(film, -5.0), turned(0.0)[0])
        self.assert_points(self.at(film, 5.0), turned(1.0)[0])

    # Paths

    def test_stored_steps(self):
        film = interpolator({t: rotating(t) for t in (0.0, 0.1, 0.2)})
        for time, stored in film.source.steps.items():
            for near in (time, time * (1 + 1e-13)):
                output = self.at(film, near)
                self.assert_points(output, points_of(stored))
                self.assertTrue((values_of(output, "Heat") == values_of(stored, "Heat")).all())

    def test_hermite(self):
        """Errors of interpolated positions fall with the fourth power of the step; without velocities they fall with the second power."""
        errors, linear = [], []
        for step in (0.4, 0.2, 0.1):
            film = interpolator({0.0: rotating(0.0), step: rotating(step)})
            errors.append(max(self.farthest(self.at(film, s * step), s * step) for s in (0.2, 0.5, 0.8)))
            linear.append(self.farthest(self.at(film, 0.5 * step, UseVelocities=0), 0.5 * step))
        for list_, order in ((errors, 4), (linear, 2)):
            for coarse, fine in zip(list_, list_[1:]):
                self.assertAlmostEqual(math.log2(coarse / fine), order, delta=0.1)
        self.assertLess(errors[-1], 3e-6)
        self.assertGreater(linear[-1], 1e-3)

    def test_formula(self):
        """Compares a few particles, which have random velocities, with the formula of Hermite interpolation, also at times
        that are no simple fraction of the interval."""
        x0, x1, v0, v1 = numpy.random.default_rng(1).uniform(-1, 1, (4, 5, 3))
        film = interpolator({1.0: few(x0, range(5), v0), 3.0: few(x1, range(5), v1)})
        for time in (1.3, 2.0, 2.9):
            s, output = (time - 1.0) / 2.0, self.at(film, time)
            expected = ((1 + 2 * s) * (1 - s) ** 2 * x0 + s * (1 - s) ** 2 * 2 * v0 + s * s * (3 - 2 * s) * x1
                        + s * s * (s - 1) * 2 * v1)
            numpy.testing.assert_allclose(points_of(output), expected, rtol=0, atol=1e-14)
            numpy.testing.assert_allclose(values_of(output, "Velocity"), (1 - s) * v0 + s * v1, rtol=0, atol=1e-14)

    def test_values(self):
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        for time in (0.05, 0.1, 0.15):
            output, stored = self.at(film, time), rotating(0.0 if time < 0.1 else 0.2)
            numpy.testing.assert_allclose(values_of(output, "Heat"), numpy.arange(343) + 10.0 * time, rtol=0, atol=1e-10)
            for name in ("Volume", "Kind", "Idp"):
                self.assertTrue((values_of(output, name) == values_of(stored, name)).all())
            self.assertEqual(values_of(output, "Kind").dtype, numpy.int32)

    def test_order(self):
        """Particle numbers may be in any order and of any type. The interpolated particles are the same."""
        expected = self.at(interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)}), 0.05)
        paths = points_of(expected)[numpy.argsort(values_of(expected, "Idp"))]
        rng = numpy.random.default_rng(10)
        for kind in (numpy.int64, numpy.int32, numpy.float32, numpy.float64):
            orders = rng.permutation(343), rng.permutation(343)
            film = interpolator({0.0: rotating(0.0, orders[0], kind), 0.2: rotating(0.2, orders[1], kind)})
            for time, order in ((0.15, orders[1]), (0.05, orders[0])):
                output = self.at(film, time)
                self.assertEqual(values_of(output, "Idp").tolist(), order.tolist())
                self.assertLess(numpy.linalg.norm(points_of(output) - turned(time)[0][order], axis=1).max(), 3e-5)
            self.assertTrue((points_of(output) == paths[order]).all())

    def test_leaving_and_entering(self):
        """Particle 1 is only in the first step, particle 9 only in the second. Each exists in its half of the interval,
        and moves by its velocity."""
        film = interpolator({
            0.0: few([(0, 0, 0), (1, 0, 0)], [0, 1], [(1, 0, 0), (0, 1, 0)], Heat=[0, 5]),
            1.0: few([(7, 0, 0), (1, 0, 0)], [9, 0], [(0, 0, 2), (1, 0, 0)], Heat=[7, 1])})
        for time, places, heat, ids in ((0.25, [(0.25, 0, 0), (1, 0.25, 0)], [0.25, 5], [0, 1]),
                                        (0.75, [(7, 0, -0.5), (0.75, 0, 0)], [7, 0.75], [9, 0])):
            output = self.at(film, time)
            self.assert_points(output, places)
            self.assertEqual((values_of(output, "Heat").tolist(), values_of(output, "id").tolist()), (heat, ids))
        self.assertEqual(self.at(film, 0.5).GetPoint(0), (7, 0, -1.0))
        self.assert_points(self.at(film, 0.25, UseVelocities=0), [(0.25, 0, 0), (1, 0, 0)])

    def test_time_scale(self):
        """Two steps have the times 0 and 1 but are 0.1 apart by their velocities. A warning proposes the time scale 0.1."""
        numbered = interpolator({0.0: rotating(0.0), 1.0: rotating(0.1)})
        warning, = self.told(numbered, 0.5)
        self.assertIn("0.1003", warning)  # tan(0.1) / 0.1 times what the velocities say
        self.assertIn("Choose Time Scale 0.1, or", warning)  # The remedy comes first, as a window cuts lines off.
        self.assertGreater(self.farthest(numbered.GetOutput(), 0.05), 1e-3)
        self.assertEqual(self.told(numbered, 0.6), [])  # said once
        self.assertAlmostEqual(numbered.GetMotionRatio(), 0.1003, 4)
        self.assertEqual(self.told(numbered, 0.5, TimeScale=0.1), [])
        self.assertLess(self.farthest(numbered.GetOutput(), 0.05), 3e-6)
        three = interpolator({0.0: rotating(0.0), 1.0: rotating(0.1), 2.0: rotating(0.2)})
        # If the same time scale would suit several intervals, only the first one gives a warning, until the filter changes.
        self.assertEqual([len(self.told(three, time)) for time in (0.5, 1.5, 0.4)], [1, 0, 0])
        self.assertEqual([len(self.told(three, time, TimeScale=0.9)) for time in (0.5, 1.5)], [1, 0])
        alone = interpolator({  # Each particle is in one step only, and moves by its velocity alone.
            0.0: few([(0, 0, 0), (1, 0, 0)], [0, 1], [(0, 0, 0), (0, 1, 0)]),
            1.0: few([(7, 0, 0), (0, 0, 0)], [9, 0], [(0, 0, 2), (0, 0, 0)])})
        self.assert_points(self.at(alone, 0.25, TimeScale=0.125), [(0, 0, 0), (1, 0.03125, 0)])
        self.assert_points(self.at(alone, 0.75), [(7, 0, -0.0625), (0, 0, 0)])
        self.refuse(numbered, 0.5, "The time scale must be greater than 0", TimeScale=0.0)

    def test_velocities_that_are_not_finite(self):
        """A warning names velocities that are not finite, before they make positions NaN."""
        for wrong in (math.nan, math.inf):
            film = interpolator({time: few([(0, 0, 0), (1, 0, 0)], [0, 1], [(1, 0, 0), (0, wrong if time else 0, 0)])
                                 for time in (0.0, 1.0)})
            warning, = self.told(film, 0.75)
            self.assertRegex(warning, says("STEP_NOT_FINITE", "'Velocity'", "particle 1", "time 1"))
            self.assert_points(film.GetOutput(), [(0, 0, 0), (1, 0, 0)])

    def test_threads_change_nothing(self):
        """The number of threads changes nothing. There are so many particles that several threads have work."""
        rng, count = numpy.random.default_rng(4), 30000
        steps = {}
        for time in (0.0, 0.2):
            order = rng.permutation(count)
            places, velocities = rng.random((2, count, 3))
            places[:, 1], velocities[:, 1] = 0.1 * order, 0.1 * numpy.arange(count)
            steps[time] = particles_of(places, Idp=order, Heat=0.3 * order, Velocity=velocities)
        found = []
        for threads in (0, 1):  # 0 means as many threads as there are processors.
            vtkSMPTools.Initialize(threads)
            film = interpolator(steps)
            told = self.told(film, 0.07)
            output = film.GetOutput()
            found.append((points_of(output).tobytes(), *(values_of(output, name).tobytes() for name in ("Velocity", "Heat")),
                          [sentence[sentence.index("): "):] for sentence in told]))
        vtkSMPTools.Initialize(0)
        self.assertEqual(output.GetNumberOfPoints(), count)
        self.assertTrue(found[0] == found[1])

    # ---- The pipeline ----

    def test_each_step_is_read_once(self):
        film = interpolator({t: rotating(t) for t in (0.0, 0.1, 0.2)})
        for time in (0.0, 0.02, 0.05, 0.08, 0.1, 0.13, 0.2):
            self.at(film, time)
        self.assertEqual(film.source.read, [0.0, 0.1, 0.2])

    def test_offered_times(self):
        film = interpolator({t: rotating(0.0) for t in (0.0, 0.1, 0.4)})
        for factor, times in ((1, [0.0, 0.1, 0.4]), (2, [0.0, 0.05, 0.1, 0.25, 0.4])):
            film.SetResampleFactor(factor)
            film.UpdateInformation()
            information = film.GetOutputInformation(0)
            self.assertEqual([round(t, 12) for t in information.Get(Pipeline.TIME_STEPS())], times)
        self.assertEqual(information.Get(Pipeline.TIME_RANGE()), (0.0, 0.4))

    def test_changed_input(self):
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        self.at(film, 0.1)
        heat = film.source.steps[0.2].GetPointData().GetArray("Heat")
        heat.Fill(100.0)
        heat.Modified()
        film.source.Modified()
        self.assertEqual(values_of(self.at(film, 0.1), "Heat")[0], 50.0)

    def test_surface(self):
        """Compares the velocities on a surface between two steps with known values."""
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        extract = vtkMarchingCorrectors()
        extract.SetInputConnection(film.GetOutputPort())
        extract.FreeSurfaceOn()
        extract.UpdateTimeStep(0.1)
        surface = extract.GetOutput()
        self.assertGreater(surface.GetNumberOfCells(), 100)
        self.assertLess(abs(values_of(surface, "Velocity")[:, 2] + 0.1).max(), 1e-5)  # All particles fall at the same speed.

    def test_types_of_data(self):
        """Unstructured grids become poly data, and blocks stay blocks. If the input has cells, each particle gets a
        vertex in the output."""
        def grid(time):
            result = vtkUnstructuredGrid()
            result.ShallowCopy(rotating(time))
            cells = vtkCellArray()
            for i in range(343):
                cells.InsertNextCell(1, [i])
            result.SetCells(1, cells)
            return result
        grids = interpolator({t: grid(t) for t in (0.0, 0.2)})
        for time in (0.0, 0.1):
            output = self.at(grids, time)
            self.assertTrue(output.IsA("vtkPolyData"))
            self.assertEqual((output.GetNumberOfVerts(), output.GetNumberOfCells()), (343, 343))
        self.assertLess(self.farthest(output, 0.1), 1e-4)
        film = interpolator({t: blocks_of(rotating(t, range(100)), None, None, rotating(t, range(100, 343))) for t in (0.0, 0.1)})
        output = self.at(film, 0.05)
        self.assertEqual([output.GetBlock(i) and output.GetBlock(i).GetNumberOfPoints() for i in range(4)],
                         [100, None, None, 243])
        for i in (0, 3):
            self.assertLess(self.farthest(output.GetBlock(i), 0.05), 3e-6)

    # ---- Refusals and warnings ----

    def test_no_numbers(self):
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        for step in film.source.steps.values():
            step.GetPointData().RemoveArray("Idp")
        self.assertEqual(self.at(film, 0.0).GetNumberOfPoints(), 343)
        self.refuse(film, 0.1, "matched between two steps by their ids.*Velocity, Heat")
        self.assertEqual(film.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(self.at(film, 0.2).GetNumberOfPoints(), 343)
        self.refuse(film, 0.1, "no point array 'Number'.*at time 0", IdArrayName="Number")
        self.refuse(film, 0.1, "'Velocity'.*3 components", IdArrayName="Velocity")
        values_of(film.source.steps[0.2], "Heat")[7] = 0.5  # At time 0 this number is whole.
        film.source.Modified()
        self.refuse(film, 0.1, "'Heat' of particle 7 in the step at time 0.2 is 0.5", IdArrayName="Heat")

    def test_global_ids(self):
        """The array of particle numbers may have an unusual name if it is the active global ids."""
        steps = {}
        for time in (0.0, 0.2):
            steps[time], ids = rotating(time), vtkIdTypeArray()
            ids.DeepCopy(steps[time].GetPointData().GetArray("Idp"))
            steps[time].GetPointData().RemoveArray("Idp")
            ids.SetName("Numbers")
            steps[time].GetPointData().SetGlobalIds(ids)
        film = interpolator(steps)
        self.at(film, 0.1)
        self.assertEqual(film.GetUsedIdArrayName(), "Numbers")

    def test_twins(self):
        for steps, index, words in ((0, 200, "Particles 17 and 200.*the same number 17"),
                                    (1, 200, "Particles 17 and 200.*the same number 17"),
                                    (slice(None), slice(None), "the same number 17")):
            film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
            for step in numpy.atleast_1d(numpy.array([0.0, 0.2])[steps]):
                values_of(film.source.steps[step], "Idp")[index] = 17
            self.refuse(film, 0.1, words)

    def test_velocity(self):
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        self.at(film, 0.1)
        self.assertEqual(film.GetUsedVelocityArrayName(), "Velocity")
        self.refuse(film, 0.1, "(?=.*'Heat')(?=.*velocity).*must have 3", VelocityArrayName="Heat")
        self.at(film, 0.1, VelocityArrayName="(automatic)", UseVelocities=0)
        self.assertEqual(film.GetUsedVelocityArrayName(), "")
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        film.source.steps[0.2].GetPointData().RemoveArray("Velocity")
        self.assertGreater(self.farthest(self.at(film, 0.1), 0.1), 1e-3)  # linear

    def test_lost_arrays(self):
        other, names = rotating(0.2), vtkStringArray()
        other.GetPointData().RemoveArray("Heat")
        names.SetNumberOfValues(343)
        film = interpolator({0.0: rotating(0.0), 0.2: add(other, Names=names)})
        warning, = self.told(film, 0.05)
        self.assertIn(": Heat, Names.", warning)
        for time in (0.05, 0.15):
            data = self.at(film, time).GetPointData()
            self.assertFalse(data.HasArray("Heat") or data.HasArray("Names"))

    def test_failing_reader(self):
        """If the reader fails at one step, the other steps work as before."""
        film = interpolator({t: rotating(t) for t in (0.0, 0.1, 0.2)})

        def break_at(*times):
            film.source.broken = times
            film.source.Modified()

        for broken in (0.0, 0.1):
            break_at(broken)
            self.told(film, 0.05)
            self.assertEqual(film.GetOutput().GetNumberOfPoints(), 0)
            break_at()
            self.told(film, 0.17)
            if film.GetErrorMessage():
                self.assertIn("update once more", film.GetErrorMessage())
            self.assertLess(self.farthest(self.at(film, 0.17), 0.17), 3e-6)


if __name__ == "__main__":
    unittest.main()
