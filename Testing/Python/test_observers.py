# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Observers of the progress never change the update that runs, whatever they do."""
import unittest

import numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData

from vtk_test import (
    POINTS, blocks_of, cube, on_progress, particles_of, points_of, run, sphere, statistic, statistics_of, surface_of, take_step)


def take_arrays(extract):
    data = extract.GetInputDataObject(0, 0).GetPointData()
    while data.GetNumberOfArrays():
        data.GetAbstractArray(0).SetName("another name, and no short one")
        data.RemoveArray(0)


class TestObservers(unittest.TestCase):
    def make(self):
        x = points_of(cube())
        extract = sphere(cube(Vector=x.astype(numpy.float32), Type=(x[:, 1] > 0.3).astype(numpy.uint8)))
        extract.SetFluidArrayName("Type")
        extract.ComputeWeightSumOn()
        for i, value in ((1, 0.5), (2, 0.7)):
            extract.SetValue(i, value)
        return extract

    def observed(self, extract, act):
        """Returns the surface of a run with an observer that acts at each call but the first. VTK makes the first call before the filter
        runs."""
        calls, acting = [], []

        def respond(made):
            calls.append(1)
            if len(calls) > 1 and not acting:
                acting.append(1)
                act(made)
                acting.pop()

        tag = on_progress(extract, respond)
        surface, _ = run(extract)
        extract.RemoveObserver(tag)
        self.assertGreater(len(calls), 3)
        return surface_of(surface)

    def test_changes(self):
        plain = self.make()
        expected, statistics = surface_of(run(plain)[0]), statistics_of(plain)
        self.assertGreater(len(expected["corners"]), 0)
        for name, change in {
                "values": lambda made: made.GenerateValues(2000, 0.1, 0.2),
                "one value": {"Value": (1, 0.9)},
                "scalar": {"InputArrayToProcess": (0, 0, 0, POINTS, "Vector"), "FreeSurface": 1},
                "names": {"FluidArrayName": "a name that is longer than the one that it replaces", "FluidValue": 77,
                          "Device": "none", "SmoothingLength": 3},
                "excluded": lambda made: made.AddExcludedArray("Volume"),
                "output": {"OutputPointsPrecision": 0, "ComputeNormals": 0, "ComputeWeightSum": 0, "InterpolateAttributes": 0,
                           "Preview": 1},
                "memory": lambda made: (made.ReleaseDeviceMemory(), made.KeepDeviceDataOff()),
                "arrays": take_arrays,
                "input": lambda made: made.SetInputData(vtkPolyData())}.items():
            with self.subTest(name):
                extract = self.make()
                found = self.observed(extract, lambda made, change=change: take_step(change, made))
                self.assertTrue(found == expected)
                self.assertEqual((statistics_of(extract), extract.GetErrorMessage()), (statistics, ""))

    def test_blocks(self):
        """If an observer removes or changes blocks, the output still has the surfaces of these blocks."""
        expected = surface_of(run(sphere())[0])
        for change in (lambda blocks: blocks.SetNumberOfBlocks(0), lambda blocks: blocks.GetBlock(1).Initialize(),
                       lambda blocks: blocks.GetBlock(1).GetPointData().RemoveArray("Radius")):
            blocks = blocks_of(cube(), cube())
            extract = sphere(blocks)
            on_progress(extract, lambda made, change=change, blocks=blocks: made.GetProgress() > 0.1 and change(blocks))
            output, told = run(extract, BlocksToApart=())
            self.assertEqual((told, extract.GetErrorMessage()), ([], ""))
            for i in range(2):
                self.assertTrue(surface_of(output.GetBlock(i)) == expected)

    def test_update_within(self):
        """VTK refuses an update within an update; the outer update does not change. A later update works."""
        extract, errors = self.make(), []
        expected = surface_of(run(extract)[0])
        extract.Modified()
        extract.GetExecutive().AddObserver("ErrorEvent", lambda *_: errors.append(1))
        self.assertTrue(self.observed(extract, lambda made: made.Update()) == expected)
        self.assertGreater(len(errors), 0)
        after = surface_of(run(extract, Value=(0, 0.65))[0])
        self.assertTrue(after != expected and len(after["corners"]) > 0)

    def test_release_within(self):
        """Memory that an observer releases is freed at the end of the update."""
        def peak(extract):
            surface, _ = run(extract, particles_of([[0.0, 0.0, 0.0]]), FluidArrayName="", SmoothingLength=0.1, FreeSurface=1)
            self.assertGreater(surface.GetNumberOfCells(), 0)
            return statistic(extract, "DeviceBytesPeak")

        extract = self.make()
        self.observed(extract, lambda made: made.ReleaseDeviceMemory())
        self.assertEqual(peak(extract), peak(self.make()))


if __name__ == "__main__":
    unittest.main()
