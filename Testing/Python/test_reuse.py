# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Data that are kept on the device between runs never change a result, and can be released. A run that is aborted, or short of device memory, leaves
an empty output and a filter that works."""
import unittest

import numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from marchingcorrectors import vtkMarchingCorrectors
from vtk_test import (
    COUNT, H, POINTS, aborted, cube, particles_of, points_of, run, says, sphere, statistic, statistics_of, surface_of, take_step,
    values_of)


def move(told):
    def change(_, data):
        data.GetPoints().SetPoint(COUNT // 3, *(points_of(data)[COUNT // 3] + [0.03, 0, 0]))
        told(data).Modified()
    return change


def grow(_, data):
    values_of(data, "Other")[:] *= numpy.float32(1.1)
    data.GetPointData().GetArray("Other").Modified()


# Changes of arrays, versions and settings, one after the other; core_reuse tests more settings.
STEPS = (
    {}, {"Value": (0, 0.5)}, {"InputArrayToProcess": (0, 0, 0, POINTS, "Other")}, {"CubeLevelLimit": 1},
    {"CubeSizeModeToUniform": ()}, {"CubeSizeModeToAdaptive": ()}, {"Box": (-2, 0.1, -0.2, 0.6, -2, 2), "UseBox": 1}, {"UseBox": 0},
    {"FreeSurface": 1}, {"FreeSurface": 0}, move(lambda data: data), move(lambda data: data.GetPoints()), grow,
    {"SmoothingLength": 0.15}, {"FluidArrayName": "Type"}, {"FluidValue": 1}, {"FluidArrayName": "Sort"},
    lambda extract, _: extract.ReleaseDeviceMemory(), {"KeepDeviceData": 0}, {"Value": (0, 0.35)}, {"KeepDeviceData": 1, "Device": "0"},
    lambda extract, _: extract.Modified(), {"Widening": 2}, {"Value": (0, 0.4)}, {"Kernel": 4}, {"SmoothingLength": 0.14},
    {"FreeSurface": 1}, {"FreeSurfaceValue": 0.4}, {"Widening": 1})


class TestReuse(unittest.TestCase):
    def test_steps(self):
        """Compares a filter that makes all changes one after the other with a new filter after each change."""
        x = points_of(cube())
        data = cube(Other=(values_of(cube(), "Radius") + 0.1 * x[:, 0]).astype(numpy.float32),
                    Type=(x[:, 1] > 0.3).astype(numpy.float32), Sort=(x[:, 1] > 0.2).astype(numpy.float32))
        values_of(data, "SmoothingLength")[:] *= numpy.select([x[:, 0] > 0.3, x[:, 0] > -0.3], [4, 2], 1)  # There are three levels.
        lasting, before = sphere(data), None
        for last, step in enumerate(STEPS):
            take_step(step, lasting, data)
            fresh, ignored = sphere(data), vtkPolyData()
            ignored.DeepCopy(data)  # The particles have been changed already.
            for each in STEPS[:last + 1]:
                take_step(each, fresh, ignored)
            with self.subTest(last):
                kept, new = surface_of(run(lasting)[0]), surface_of(run(fresh)[0])
                self.assertTrue(kept == new)
                self.assertEqual(statistics_of(lasting), statistics_of(fresh))
                self.assertEqual(lasting.GetErrorMessage(), fresh.GetErrorMessage())
                if step and not (callable(step) or "KeepDeviceData" in step):
                    self.assertFalse(new == before)
                before = new

    def test_widening(self):
        """The widening factors and the search grid are kept for another iso value, but not for moved particles."""
        phases, data = [], cube()
        extract = sphere(data)
        extract.SetWidening(2)
        extract.AddObserver("ProgressEvent", lambda *_: phases.append(extract.GetProgressText()))
        for change, makes_grid in (({}, True), ({"Value": (0, 0.4)}, False), (move(lambda data: data), True)):
            phases.clear()
            take_step(change, extract, data)
            run(extract)
            with self.subTest(change):
                self.assertEqual("search grid" in phases, makes_grid)

    def test_abort(self):
        extract = sphere()
        self.assertEqual(aborted(extract).GetNumberOfPoints(), 0)
        extract.Modified()
        self.assertTrue(surface_of(run(extract)[0]) == surface_of(run(sphere())[0]))

    def test_release(self):
        """The peak memory of a run for one particle includes what the filter has kept from a run for many particles,
        unless it was released."""
        particle, data = particles_of([[0.0, 0.0, 0.0]]), cube()

        def peak(first, change=lambda extract: None):
            extract = vtkMarchingCorrectors()
            run(extract, first, SmoothingLength=H, FreeSurface=1)
            change(extract)
            self.assertGreater(run(extract, particle)[0].GetNumberOfPoints(), 0)
            return statistic(extract, "DeviceBytesPeak")

        alone = peak(particle)
        self.assertGreater(peak(data), alone)
        self.assertEqual(peak(data, lambda extract: extract.ReleaseDeviceMemory()), alone)
        self.assertEqual(peak(data, lambda extract: run(extract, KeepDeviceData=0)), alone)

    def test_memory_limit(self):
        extract = sphere()
        expected = surface_of(run(extract, CubeSize=0.02)[0])
        self.assertGreater(statistic(extract, "DeviceBytesPeak"), 2 << 20)
        surface, told = run(extract, DeviceMemoryLimit=1)
        self.assertEqual((surface.GetNumberOfPoints(), len(told)), (0, 1))
        self.assertRegex(extract.GetErrorMessage(), says("DEVICE_MEMORY_LIMIT"))
        self.assertTrue(surface_of(run(extract, DeviceMemoryLimit=1000)[0]) == expected)
        self.assertEqual(extract.GetErrorMessage(), "")


if __name__ == "__main__":
    unittest.main()
