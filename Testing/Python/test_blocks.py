# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests composite data: blocks that are one set of particles, and blocks apart, each by itself. If blocks are apart, the output has each block's
surface in the block's place, and messages name the block."""
import unittest

import numpy
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet, vtkImageData, vtkMultiBlockDataSet, vtkOverlappingAMR, vtkPartitionedDataSet,
    vtkPartitionedDataSetCollection, vtkPolyData, vtkTable)

from vtk_test import (
    add, blocks_of, cube, on_progress, particles_of, points_of, run, says, sphere, statistic, statistics_of, surface_of, take,
    values_of)

APART = {"BlocksToApart": ()}


def broken():
    data = cube()
    values_of(data, "SmoothingLength")[17] = -1
    return data


def timed(data):
    data.GetFieldData().AddArray(particles_of([[0.0] * 3], TimeValue=numpy.array([0.5])).GetPointData().GetArray(0))
    return data


class TestApart(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.alone = surface_of(run(sphere())[0])

    def test_messages(self):
        """Extracts seven blocks: broken, good, an image, empty, missing, a group with a broken block that has no name, and good. Each
        broken block and the image give a message."""
        blocks = blocks_of(broken(), timed(cube()), vtkImageData(), vtkPolyData(), None, blocks_of(broken()), cube())
        for i, name in ((0, "first"), (2, "picture")):
            blocks.GetMetaData(i).Set(vtkCompositeDataSet.NAME(), name)
        extract = sphere(blocks)
        output, told = run(extract, **APART)
        message = extract.GetErrorMessage()
        self.assertEqual((len(told), output.GetNumberOfBlocks()), (3, 7))
        self.assertRegex(message, "^Block 'first', index 1: The smoothing length.*particle 17.*\nBlock index 7: The smoothing length")
        self.assertEqual(sum("Block 'picture'" in sentence for sentence in told), 1)
        self.assertEqual(output.GetMetaData(0).Get(vtkCompositeDataSet.NAME()), "first")
        self.assertEqual([output.GetBlock(i).GetNumberOfPoints() for i in (0, 2, 3)], [0, 0, 0])
        self.assertIsNone(output.GetBlock(4))
        for i in (1, 6):
            self.assertTrue(surface_of(output.GetBlock(i)) == self.alone)
        data = output.GetBlock(1).GetFieldData()
        self.assertTrue(data.HasArray("TimeValue") and data.HasArray("IsoValues"))
        # No error is left if data are good again, also with other kinds of output.
        blocks.SetBlock(0, cube())
        blocks.SetBlock(5, None)
        run(extract)
        self.assertEqual(extract.GetErrorMessage(), "")
        self.assertTrue(surface_of(run(extract, cube())[0]) == self.alone)

    def told_once(self, words, extract, **settings):
        """Tests that a run gives one message, which matches `words`, or none if there are no words."""
        told = run(extract, **settings)[1]
        self.assertEqual(len(told), 1 if words else 0, told)
        self.assertRegex("".join(told), words or "^$")

    def test_warnings(self):
        """A warning comes once in a run and names its block. Blocks whose names mean walls are mentioned, whether
        blocks are extracted apart or together."""
        extract = sphere(blocks_of(a=cube(), b=cube()))
        for _ in range(2):
            self.told_once("Block 'a', index 1: " + says("NEIGHBOURS_UNUSUAL", "Smoothing Length Is Support Radius"), extract, **APART,
                           SmoothingLength=0.26)
            extract.Modified()
        for apart, words in ((1, says("WALLS_IN_BLOCK", "Block 'PartBound', index 2 of 2", "Blocks together")),
                             (0, says("WALL_BLOCKS_UNUSED", "Fluid Array WallBlock"))):
            self.told_once(words, sphere(blocks_of(PartFluid=cube(), PartBound=cube())), Blocks=apart)
            self.told_once("", sphere(blocks_of(Bound1=cube(), Bound2=cube())), Blocks=apart)

    def test_partitions(self):
        """A partition without a name is called by the name of the data set that it belongs to."""
        walls, water, collection = vtkPartitionedDataSet(), vtkPartitionedDataSet(), vtkPartitionedDataSetCollection()
        walls.SetPartition(0, cube())
        water.SetPartition(0, cube())
        water.SetPartition(1, broken())
        collection.SetPartitionedDataSet(0, walls)
        collection.SetPartitionedDataSet(1, water)
        collection.GetMetaData(1).Set(vtkCompositeDataSet.NAME(), "water")
        extract = sphere(collection)
        output, _ = run(extract, **APART)
        self.assertIn("Block 'water', index 5: ", extract.GetErrorMessage())
        for i in range(2):
            self.assertTrue(surface_of(output.GetPartitionedDataSet(i).GetPartition(0)) == self.alone)
        left = output.GetPartitionedDataSet(1).GetPartition(1)
        self.assertFalse(left and left.GetNumberOfPoints())
        self.assertTrue(surface_of(run(extract, water)[0].GetPartition(0)) == self.alone)

    def test_sums(self):
        """The number of bricks is summed over all blocks, the memory's peak is the greatest of any block, and the progress never falls."""
        extract, seen = sphere(), [0]
        run(extract, **APART, KeepDeviceData=0)
        bricks, peak = statistic(extract, "Bricks"), statistic(extract, "DeviceBytesPeak")
        on_progress(extract, lambda made: seen.append(made.GetProgress()))
        run(extract, blocks_of(cube(), cube()))
        self.assertEqual(sorted(seen), seen)
        self.assertTrue(0.9 < seen[-1] <= 1)
        self.assertEqual((statistic(extract, "Bricks"), statistic(extract, "DeviceBytesPeak")), (2 * bricks, peak))
        self.assertEqual((extract.GetProgressScale(), extract.GetProgressShift()), (1, 0))

    def test_abort(self):
        """A run that is stopped in the second block has no surface, not even the first block's."""
        extract = sphere(blocks_of(cube(), cube()))
        on_progress(extract, lambda made: made.SetAbortExecute(made.GetProgress() > 0.6))
        output, told = run(extract, **APART)
        self.assertEqual((output.GetNumberOfPoints(), told, extract.GetErrorMessage()), (0, [], ""))

    def test_no_point_sets(self):
        """Data sets without explicit points (AMR, tables) are refused, and do not crash the filter."""
        amr, extract = vtkOverlappingAMR(), sphere()
        amr.Initialize(1, [1])
        messages = []
        extract.GetExecutive().AddObserver("ErrorEvent", lambda *_: messages.append(1))
        for data in (amr, vtkTable()):
            run(extract, data)
        self.assertGreater(len(messages), 0)
        self.assertEqual(run(extract, vtkMultiBlockDataSet())[0].GetNumberOfPoints(), 0)
        self.assertEqual(extract.GetErrorMessage(), "")
        self.assertTrue(run(extract, **APART)[0].IsA("vtkMultiBlockDataSet"))
        self.assertEqual(extract.GetErrorMessage(), "")


class TestTogether(unittest.TestCase):
    def test_one_set(self):
        """Blocks that are one set, in any order and beside empty blocks, give the bits that the undivided set gives. An array that one
        block lacks is left out, with a warning. The joined set is kept as long as the blocks stay the same."""
        data = cube()
        left = points_of(data)[:, 0] < 0.05
        first, second = take(data, ~left), timed(take(data, left))
        add(first, Own=numpy.ones(first.GetNumberOfPoints()))
        whole, extract = sphere(data), sphere(blocks_of(first, blocks_of(second), vtkPolyData(), vtkImageData()))
        for settings in ({}, {"Value": (0, 0.7)}):
            expected, (surface, told) = run(whole, **settings)[0], run(extract, **settings)
            self.assertEqual((len(told), extract.GetErrorMessage()), (1, ""))
            self.assertRegex(told[0], says("ARRAYS_NOT_SHARED", "Own"))
            self.assertTrue(surface_of(surface) == surface_of(expected))
            self.assertEqual(statistics_of(extract), statistics_of(whole))
        self.assertTrue(surface.GetFieldData().HasArray("TimeValue"))
        values_of(second, "Radius")[:] *= 2
        second.GetPointData().GetArray("Radius").Modified()
        extract.Modified()
        self.assertFalse(surface_of(run(extract)[0]) == surface_of(expected))
        self.assertTrue(run(extract, **APART)[0].IsA("vtkMultiBlockDataSet"))

    def test_arrays_that_differ(self):
        """An array that has one component in a block and two in another is left out, and so is one without values in a wall; a warning names
        them. An array of floats in a block and of integers in another is joined."""
        data = cube()
        left = points_of(data)[:, 0] < 0.05
        halves = take(data, left), take(data, ~left)
        for half, width, kind in zip(halves, (1, 2), (numpy.float32, numpy.int64)):
            add(half, Pair=numpy.ones((half.GetNumberOfPoints(), width)), Mixed=numpy.full(half.GetNumberOfPoints(), 7, kind))
        add(halves[0], None_=numpy.ones(0))
        surface, told = run(sphere(blocks_of(*halves)))
        self.assertEqual(len(told), 1)
        self.assertRegex(told[0], says("ARRAYS_NOT_SHARED", "None_, Pair"))
        self.assertFalse(surface.GetPointData().HasArray("Pair"))
        numpy.testing.assert_allclose(values_of(surface, "Mixed"), 7, rtol=1e-6)
        told = run(sphere(blocks_of(halves[0], Boundary=halves[1])), DetectFluid=1)[1]
        self.assertRegex("".join(told), says("ARRAYS_NOT_SHARED", "None_, Pair"))

    def test_walls(self):
        """One block has a name that means walls, and lacks the scalar. If the filter detects the fluid, this block counts as walls, else as fluid."""
        data = cube()
        wall = points_of(data)[:, 2] < -0.45
        walls = take(data, wall)
        walls.GetPointData().RemoveArray("Radius")
        walls.GetPointData().RemoveArray("Volume")
        extract = sphere(blocks_of(Boundary=walls, Fluid=take(data, ~wall)))
        surface, told = run(extract)
        self.assertEqual((len(told), extract.GetUsedFluid()), (1, ""))
        everywhere = surface.GetNumberOfCells()
        extract.DetectFluidOn()
        self.assertEqual(extract.GetNextFluid(), "WallBlock = 0")
        surface, told = run(extract)
        self.assertEqual((told, extract.GetUsedFluid()), ([], "WallBlock = 0"))
        self.assertFalse(surface.GetPointData().HasArray("WallBlock"))
        one = sphere(add(data, Kind=numpy.where(wall, 7, 4)))  # In one set an array tells walls.
        one.AddExcludedArray("Kind")
        self.assertTrue(surface_of(surface) == surface_of(run(one, FluidArrayName="Kind", FluidValue=4)[0]))
        self.assertGreater(surface.GetNumberOfCells(), 100)
        self.assertNotEqual(surface.GetNumberOfCells(), everywhere)
        self.assertGreater(len(run(extract, **APART)[1]), 0)  # Block by block, the walls are not seen.


if __name__ == "__main__":
    unittest.main()
