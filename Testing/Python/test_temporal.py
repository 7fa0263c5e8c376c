# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles between stored steps: vtkSPHTemporalInterpolator against paths that are known."""
import math
import os
import pathlib
import random
import unittest
import xml.etree.ElementTree

import vtkmodules.vtkFiltersCore  # noqa: F401
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import (vtkDoubleArray, vtkFloatArray, vtkIdTypeArray, vtkIntArray,
                                      vtkObject, vtkPoints, vtkSMPTools, vtkStringArray)
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkMultiBlockDataSet, vtkPolyData,
                                           vtkUnstructuredGrid)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHTemporalInterpolator

XML = pathlib.Path(os.environ["MCOR_PLUGIN_XML"]) / "SPHTemporalInterpolator.xml"
RATE = 2.0  # of the rotation, radians per unit of time


def array(name, values, kind=vtkDoubleArray):
    result = kind()
    result.SetName(name)
    wide = bool(values) and isinstance(values[0], tuple)
    result.SetNumberOfComponents(len(values[0]) if wide else 1)
    for value in values:
        if wide:
            result.InsertNextTuple(value)
        else:
            result.InsertNextValue(value)
    return result


def make(positions, **arrays):
    points = vtkPoints()
    points.SetDataTypeToDouble()
    for x in positions:
        points.InsertNextPoint(x)
    particles = vtkPolyData()
    particles.SetPoints(points)
    for name, values in arrays.items():
        particles.GetPointData().AddArray(
            values if hasattr(values, "GetName") else array(name, values))
    return particles


def drop(n=7, spacing=0.1):
    half = (n - 1) / 2
    return [tuple((index - half) * spacing for index in (i % n, i // n % n, i // n ** 2))
            for i in range(n ** 3)]


def turned(x, time):
    """Where x is at this time, rotating around the z axis while falling, and its velocity."""
    c, s = math.cos(RATE * time), math.sin(RATE * time)
    a, b = c * x[0] - s * x[1], s * x[0] + c * x[1]
    return (a, b, x[2] - 0.5 * time ** 2), (-RATE * b, RATE * a, -time)


def rotating(time, numbers=None, spacing=0.1, **kinds):
    """The particles with these numbers, in that order; Heat is linear in time."""
    start = drop(spacing=spacing)
    numbers = range(len(start)) if numbers is None else numbers
    state = [turned(start[i], time) for i in numbers]
    return make([x for x, _ in state], Velocity=[v for _, v in state],
                Idp=array("Idp", list(numbers), kinds.get("ids", vtkIdTypeArray)),
                Heat=[i + 10.0 * time for i in numbers],
                Kind=array("Kind", [i % 2 + 2 * (time > 0) for i in numbers], vtkIntArray),
                SmoothingLength=[1.3 * spacing] * len(state), Volume=[spacing ** 3] * len(state))


class Steps(VTKPythonAlgorithmBase):
    """A reader: {time: data}; which times were read stands in `read`, those in `broken` fail."""

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
    result.source = source  # kept alive with it
    return result


def positions(particles):
    return [particles.GetPoint(i) for i in range(particles.GetNumberOfPoints())]


def values(particles, name):
    found = particles.GetPointData().GetAbstractArray(name)
    return [found.GetValue(i) for i in range(found.GetNumberOfValues())]


class TestTemporal(unittest.TestCase):
    def at(self, filter_, time):
        filter_.UpdateTimeStep(time)
        self.assertEqual(filter_.GetErrorMessage(), "")
        return filter_.GetOutput()

    def messages(self, filter_, time):
        """What the filter reports at this time: (errors, warnings)."""
        found = {"ErrorEvent": [], "WarningEvent": []}
        tags = []
        for event, texts in found.items():
            def observe(_, __, text, texts=texts):
                texts.append(text)
            observe.CallDataType = "string0"
            tags.append(filter_.AddObserver(event, observe))
        filter_.UpdateTimeStep(time)
        for tag in tags:
            filter_.RemoveObserver(tag)
        return found["ErrorEvent"], found["WarningEvent"]

    def refuse(self, filter_, time, *parts):
        vtkObject.GlobalWarningDisplayOff()
        filter_.UpdateTimeStep(time)
        vtkObject.GlobalWarningDisplayOn()
        for part in parts:
            self.assertIn(part, filter_.GetErrorMessage())

    def farthest(self, particles, time):
        start = drop()
        return max(math.dist(x, turned(start[int(number)], time)[0])
                   for x, number in zip(positions(particles), values(particles, "Idp")))

    # Something weird

    def test_no_particles(self):
        empty = interpolator({0.0: make([]), 1.0: make([])})
        for time in (0.0, 0.3, 1.0):
            self.assertEqual(self.at(empty, time).GetNumberOfPoints(), 0)
        some = interpolator({0.0: rotating(0.0), 1.0: make([])})
        self.assertEqual(self.at(some, 0.3).GetNumberOfPoints(), 343)
        self.assertEqual(self.at(some, 0.7).GetNumberOfPoints(), 0)

    def test_no_steps(self):
        """Particles without a time are passed on, whatever time is asked for."""
        fixed = vtkSPHTemporalInterpolator()
        fixed.SetInputData(rotating(0.0))
        fixed.Update()
        self.assertEqual(fixed.GetOutput().GetNumberOfPoints(), 343)
        self.assertEqual(self.at(fixed, 0.7).GetNumberOfPoints(), 343)

    def test_outside(self):
        film = interpolator({0.0: rotating(0.0), 1.0: rotating(1.0)})
        self.assertEqual(positions(self.at(film, -5.0)), positions(rotating(0.0)))
        self.assertEqual(positions(self.at(film, 5.0)), positions(rotating(1.0)))

    # Paths

    def test_stored_steps(self):
        steps = {t: rotating(t) for t in (0.0, 0.1, 0.2)}
        film = interpolator(steps)
        for time, stored in steps.items():
            for near in (time, time * (1 + 1e-13)):
                output = self.at(film, near)
                self.assertEqual(positions(output), positions(stored))
                self.assertEqual(values(output, "Heat"), values(stored, "Heat"))

    def test_hermite(self):
        """Positions converge with the fourth power of the step; linear ones with the second."""
        errors, linear = [], []
        for step in (0.4, 0.2, 0.1):
            film = interpolator({0.0: rotating(0.0), step: rotating(step)})
            errors.append(max(self.farthest(self.at(film, s * step), s * step)
                              for s in (0.2, 0.5, 0.8)))
            film.UseVelocitiesOff()
            linear.append(self.farthest(self.at(film, 0.5 * step), 0.5 * step))
        for list_, order in ((errors, 4), (linear, 2)):
            for coarse, fine in zip(list_, list_[1:]):
                self.assertAlmostEqual(math.log2(coarse / fine), order, delta=0.1)
        self.assertLess(errors[-1], 3e-6)
        self.assertGreater(linear[-1], 1e-3)

    def test_formula(self):
        """A few particles with any velocities, at a time that is no fraction of the interval."""
        rng = random.Random(1)
        def triple():
            return tuple(rng.uniform(-1, 1) for _ in range(3))
        x0, x1, v0, v1 = ([triple() for _ in range(5)] for _ in range(4))
        film = interpolator({1.0: make(x0, Velocity=v0, Idp=[float(i) for i in range(5)]),
                             3.0: make(x1, Velocity=v1, Idp=[float(i) for i in range(5)])})
        for time in (1.3, 2.0, 2.9):
            s = (time - 1.0) / 2.0
            h = ((1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2, s * s * (3 - 2 * s), s * s * (s - 1))
            output = self.at(film, time)
            for i, x in enumerate(positions(output)):
                for c in range(3):
                    expected = (h[0] * x0[i][c] + h[1] * 2 * v0[i][c] + h[2] * x1[i][c] +
                                h[3] * 2 * v1[i][c])
                    self.assertAlmostEqual(x[c], expected, delta=1e-14)
            velocities = values(output, "Velocity")
            for i in range(15):
                self.assertAlmostEqual(velocities[i], (1 - s) * v0[i // 3][i % 3] + s * v1[i // 3][i % 3],
                                       delta=1e-14)

    def test_values(self):
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        for time in (0.05, 0.1, 0.15):
            output = self.at(film, time)
            for i, heat in enumerate(values(output, "Heat")):
                self.assertAlmostEqual(heat, i + 10.0 * time, delta=1e-10)
            self.assertEqual(values(output, "Volume"), values(rotating(0.0), "Volume"))
            stored = rotating(0.0 if time < 0.1 else 0.2)
            self.assertEqual(values(output, "Kind"), values(stored, "Kind"))
            self.assertEqual(output.GetPointData().GetArray("Kind").GetClassName(), "vtkIntArray")
            self.assertEqual(values(output, "Idp"), values(stored, "Idp"))

    def test_order(self):
        """Shuffled numbers of any type give the same particles."""
        expected = self.at(interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)}), 0.05)
        paths = dict(zip(values(expected, "Idp"), positions(expected)))
        for seed, kind in enumerate((vtkIdTypeArray, vtkIntArray, vtkFloatArray, vtkDoubleArray)):
            orders = [list(range(343)), list(range(343))]
            for k, order in enumerate(orders):
                random.Random(10 * seed + k).shuffle(order)
            film = interpolator({0.0: rotating(0.0, orders[0], ids=kind),
                                 0.2: rotating(0.2, orders[1], ids=kind)})
            for time in (0.05, 0.15):
                output = self.at(film, time)
                self.assertEqual(values(output, "Idp"), orders[0 if time < 0.1 else 1])
                self.assertLess(self.farthest(output, time), 3e-5)
            for number, x in zip(values(self.at(film, 0.05), "Idp"), positions(film.GetOutput())):
                self.assertEqual(x, paths[number])

    def test_leaving_and_entering(self):
        """Particle 1 leaves, 9 enters: each is there in its half of the interval, and moves."""
        film = interpolator({
            0.0: make([(0, 0, 0), (1, 0, 0)], id=array("id", [0, 1], vtkIntArray),
                      Velocity=[(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], Heat=[0.0, 5.0]),
            1.0: make([(7, 0, 0), (1, 0, 0)], id=array("id", [9, 0], vtkIntArray),
                      Velocity=[(0.0, 0.0, 2.0), (1.0, 0.0, 0.0)], Heat=[7.0, 1.0])})
        early = self.at(film, 0.25)
        self.assertEqual(positions(early), [(0.25, 0, 0), (1, 0.25, 0)])
        self.assertEqual(values(early, "Heat"), [0.25, 5.0])
        late = self.at(film, 0.75)
        self.assertEqual(positions(late), [(7, 0, -0.5), (0.75, 0, 0)])
        self.assertEqual(values(late, "Heat"), [7.0, 0.75])
        self.assertEqual(values(late, "id"), [9, 0])
        self.assertEqual(self.at(film, 0.5).GetPoint(0), (7, 0, -1.0))
        film.UseVelocitiesOff()
        self.assertEqual(positions(self.at(film, 0.25)), [(0.25, 0, 0), (1, 0, 0)])

    def test_time_scale(self):
        """Steps numbered 0 and 1 that are 0.1 apart."""
        numbered = interpolator({0.0: rotating(0.0), 1.0: rotating(0.1)})
        errors, warnings = self.messages(numbered, 0.5)
        self.assertEqual(errors, [])
        self.assertEqual(len(warnings), 1)
        self.assertIn("0.1003", warnings[0])  # tan(0.1) / 0.1 of what the velocities say
        self.assertGreater(self.farthest(numbered.GetOutput(), 0.05), 1e-3)
        self.assertEqual(self.messages(numbered, 0.6), ([], []))  # said once
        numbered.SetTimeScale(0.1)
        self.assertEqual(self.messages(numbered, 0.5), ([], []))
        self.assertLess(self.farthest(numbered.GetOutput(), 0.05), 3e-6)
        alone = interpolator({  # in one step each: they move by their velocities alone
            0.0: make([(0, 0, 0), (1, 0, 0)], id=array("id", [0, 1], vtkIntArray),
                      Velocity=[(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)]),
            1.0: make([(7, 0, 0), (0, 0, 0)], id=array("id", [9, 0], vtkIntArray),
                      Velocity=[(0.0, 0.0, 2.0), (0.0, 0.0, 0.0)])})
        alone.SetTimeScale(0.125)
        self.assertEqual(positions(self.at(alone, 0.25)), [(0, 0, 0), (1, 0.03125, 0)])
        self.assertEqual(positions(self.at(alone, 0.75)), [(7, 0, -0.0625), (0, 0, 0)])
        numbered.SetTimeScale(0.0)
        self.refuse(numbered, 0.5, "The time scale must be greater than 0")

    def test_velocities_that_are_not_finite(self):
        """Are named as such: not as positions, which they would make NaN."""
        for wrong in (math.nan, math.inf):
            steps = {time: make([(0, 0, 0), (1, 0, 0)], id=array("id", [0, 1], vtkIntArray),
                                Velocity=[(1.0, 0.0, 0.0), (0.0, wrong if time else 0.0, 0.0)])
                     for time in (0.0, 1.0)}
            film = interpolator(steps)
            errors, warnings = self.messages(film, 0.75)
            self.assertEqual(errors, [])
            self.assertEqual(len(warnings), 1)
            self.assertIn("'Velocity' is NaN or infinite at particle 1 in the step at time 1", warnings[0])
            self.assertEqual(positions(film.GetOutput()), [(0, 0, 0), (1, 0, 0)])

    def test_threads_change_nothing(self):
        """Of so many particles that there is work for several threads."""
        rng = random.Random(4)
        count = 30000
        steps = []
        for _ in range(2):
            order = list(range(count))
            rng.shuffle(order)
            steps.append(make([(rng.random(), i * 0.1, 0.0) for i in order],
                              Idp=array("Idp", order, vtkIdTypeArray), Heat=[0.3 * i for i in order],
                              Velocity=[(rng.random(), 0.1 * i, 0.0) for i in range(count)]))
        found = []
        for threads in (0, 1):  # 0: as many as there are
            vtkSMPTools.Initialize(threads)
            film = interpolator({0.0: steps[0], 0.2: steps[1]})
            errors, warnings = self.messages(film, 0.07)
            output = film.GetOutput()
            found.append((positions(output), values(output, "Velocity"), values(output, "Heat"),
                          errors, [w[w.index("): "):] for w in warnings]))
        vtkSMPTools.Initialize(0)
        self.assertEqual(len(found[0][0]), count)
        self.assertTrue(found[0] == found[1])

    # The pipeline

    def test_each_step_is_read_once(self):
        steps = Steps({t: rotating(t) for t in (0.0, 0.1, 0.2)})
        film = interpolator(steps)
        for time in (0.0, 0.02, 0.05, 0.08, 0.1, 0.13, 0.2):
            self.at(film, time)
        self.assertEqual(steps.read, [0.0, 0.1, 0.2])

    def test_offered_times(self):
        film = interpolator({t: rotating(0.0) for t in (0.0, 0.1, 0.4)})
        def offered():
            film.UpdateInformation()
            info = film.GetOutputInformation(0)
            return [round(t, 12) for t in info.Get(Pipeline.TIME_STEPS())]
        self.assertEqual(offered(), [0.0, 0.1, 0.4])
        film.SetResampleFactor(2)
        self.assertEqual(offered(), [0.0, 0.05, 0.1, 0.25, 0.4])
        self.assertEqual(film.GetOutputInformation(0).Get(Pipeline.TIME_RANGE()), (0.0, 0.4))

    def test_changed_input(self):
        first, second = rotating(0.0), rotating(0.2)
        film = interpolator({0.0: first, 0.2: second})
        self.at(film, 0.1)
        second.GetPointData().GetArray("Heat").Fill(100.0)
        second.GetPointData().GetArray("Heat").Modified()
        film.source.Modified()
        self.assertEqual(values(self.at(film, 0.1), "Heat")[0], 50.0)

    def test_surface(self):
        """A surface between two steps, with the exact mean of the velocities."""
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        extract = vtkMarchingCorrectors()
        extract.SetInputConnection(film.GetOutputPort())
        extract.FreeSurfaceOn()
        extract.SetPrecision(extract.DOUBLE_PRECISION)
        extract.UpdateTimeStep(0.1)
        surface, particles = extract.GetOutput(), film.GetOutput()
        self.assertGreater(surface.GetNumberOfCells(), 100)
        place, velocity = positions(particles), values(particles, "Velocity")
        found = values(surface, "Velocity")
        h = 0.13
        # All volumes are the same, so the mean is without them.
        for i in range(0, surface.GetNumberOfPoints(), 37):
            total, weight = [0.0] * 3, 0.0
            for j, x in enumerate(place):
                q = math.dist(x, surface.GetPoint(i)) / h
                w = 1 - 1.5 * q ** 2 + 0.75 * q ** 3 if q < 1 else 0.25 * max(0, 2 - q) ** 3
                weight += w
                total = [t + w * velocity[3 * j + c] for c, t in enumerate(total)]
            for c in range(3):
                self.assertAlmostEqual(found[3 * i + c], total[c] / weight, delta=1e-12)

    def test_types_of_data(self):
        """Unstructured grids and blocks; a vertex for each particle where the input has cells."""
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

        def blocks(time):
            result = vtkMultiBlockDataSet()
            result.SetBlock(0, rotating(time, range(100)))
            result.SetBlock(3, rotating(time, range(100, 343)))
            return result
        film = interpolator({t: blocks(t) for t in (0.0, 0.1)})
        film.UpdateTimeStep(0.05)
        self.assertEqual(film.GetErrorMessage(), "")
        output = film.GetOutputDataObject(0)
        self.assertEqual([output.GetBlock(i) and output.GetBlock(i).GetNumberOfPoints()
                          for i in range(4)], [100, None, None, 243])
        for i in (0, 3):
            self.assertLess(self.farthest(output.GetBlock(i), 0.05), 3e-6)

    # What is refused or told

    def test_no_numbers(self):
        def without(time):
            result = rotating(time)
            result.GetPointData().RemoveArray("Idp")
            return result
        film = interpolator({0.0: without(0.0), 0.2: without(0.2)})
        self.assertEqual(self.at(film, 0.0).GetNumberOfPoints(), 343)
        self.refuse(film, 0.1, "matched between two steps by their ids", "Velocity, Heat")
        self.assertEqual(film.GetOutput().GetNumberOfPoints(), 0)
        self.assertEqual(self.at(film, 0.2).GetNumberOfPoints(), 343)
        film.SetIdArrayName("Number")
        self.refuse(film, 0.1, "no point array 'Number'", "at time 0")
        film.SetIdArrayName("Velocity")
        self.refuse(film, 0.1, "'Velocity'", "3 components")
        film.SetIdArrayName("Heat")  # whole at time 0
        film.source.steps[0.2].GetPointData().GetArray("Heat").SetValue(7, 0.5)
        film.source.Modified()
        self.refuse(film, 0.1, "'Heat' of particle 7 in the step at time 0.2 is 0.5")

    def test_global_ids(self):
        """Arrays of no usual name, which are the active global ids."""
        steps = {t: rotating(t) for t in (0.0, 0.2)}
        for particles in steps.values():
            ids = particles.GetPointData().GetArray("Idp")
            ids.SetName("Numbers")
            particles.GetPointData().SetGlobalIds(ids)
        film = interpolator(steps)
        self.at(film, 0.1)
        self.assertEqual(film.GetUsedIdArrayName(), "Numbers")

    def test_twins(self):
        for step in (0, 1):
            with self.subTest(step):
                steps = [rotating(0.0), rotating(0.2)]
                steps[step].GetPointData().GetArray("Idp").SetValue(200, 17)
                self.refuse(interpolator({0.0: steps[0], 0.2: steps[1]}), 0.1,
                            "Particles 17 and 200", "the same number 17")
        steps = [rotating(0.0), rotating(0.2)]
        for particles in steps:
            particles.GetPointData().GetArray("Idp").Fill(0)
        self.refuse(interpolator({0.0: steps[0], 0.2: steps[1]}), 0.1, "the same number 0")

    def test_velocity(self):
        film = interpolator({0.0: rotating(0.0), 0.2: rotating(0.2)})
        self.at(film, 0.1)
        self.assertEqual(film.GetUsedVelocityArrayName(), "Velocity")
        film.SetVelocityArrayName("Heat")
        self.refuse(film, 0.1, "'Heat'", "velocity", "must have 3")
        film.SetVelocityArrayName("(automatic)")
        film.UseVelocitiesOff()
        self.at(film, 0.1)
        self.assertEqual(film.GetUsedVelocityArrayName(), "")
        other = rotating(0.2)
        other.GetPointData().RemoveArray("Velocity")
        film = interpolator({0.0: rotating(0.0), 0.2: other})
        self.messages(film, 0.1)
        self.assertGreater(self.farthest(film.GetOutput(), 0.1), 1e-3)  # linear

    def test_lost_arrays(self):
        other = rotating(0.2)
        other.GetPointData().RemoveArray("Heat")
        other.GetPointData().AddArray(array("Names", ["x"] * 343, vtkStringArray))
        film = interpolator({0.0: rotating(0.0), 0.2: other})
        errors, warnings = self.messages(film, 0.05)
        self.assertEqual((errors, len(warnings)), ([], 1))
        self.assertIn("left out between them: Heat, Names.", warnings[0])
        for time in (0.05, 0.15):
            self.assertFalse(self.at(film, time).GetPointData().HasArray("Heat"))
            self.assertFalse(self.at(film, time).GetPointData().HasArray("Names"))

    def test_failing_reader(self):
        """After a step that could not be read the others are as they were."""
        steps = Steps({t: rotating(t) for t in (0.0, 0.1, 0.2)})
        film = interpolator(steps)
        vtkObject.GlobalWarningDisplayOff()
        for broken in (0.0, 0.1):
            steps.broken = (broken,)
            steps.Modified()
            film.UpdateTimeStep(0.05)
            self.assertEqual(film.GetOutput().GetNumberOfPoints(), 0)
            steps.broken = ()
            steps.Modified()
            film.UpdateTimeStep(0.17)
            if film.GetErrorMessage():
                self.assertIn("update once more", film.GetErrorMessage())
                film.UpdateTimeStep(0.17)
            self.assertEqual(film.GetErrorMessage(), "")
            self.assertLess(self.farthest(film.GetOutput(), 0.17), 3e-6)
        vtkObject.GlobalWarningDisplayOn()


class TestPluginXml(unittest.TestCase):
    """ParaView's properties reach the class, and have its defaults."""

    def test_properties(self):
        proxy = xml.etree.ElementTree.parse(XML).find(".//SourceProxy")
        self.assertEqual(proxy.get("class"), "vtkSPHTemporalInterpolator")
        settable = [e for e in proxy if e.get("command")]
        self.assertEqual({e.get("command") for e in settable},
                         {"SetInputConnection", *(f"Set{name}" for name in (
                             "IdArrayName", "VelocityArrayName", "UseVelocities", "TimeScale",
                             "ResampleFactor"))})
        for element in settable:
            self.assertTrue(element.findtext("Documentation").strip())
            if element.get("default_values"):
                film = vtkSPHTemporalInterpolator()
                name = element.get("command")[3:]
                default = getattr(film, "Get" + name)()
                text = element.get("default_values").replace("(automatic)", "")
                self.assertEqual(type(default)(text), default)
                other = "Other" if isinstance(default, str) else type(default)(default == 0) or 3
                getattr(film, "Set" + name)(other)
                self.assertEqual(getattr(film, "Get" + name)(), other)


if __name__ == "__main__":
    unittest.main()
