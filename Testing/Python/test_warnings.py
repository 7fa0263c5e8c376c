# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""One warning for each thing that may be wrong with the input, with figures, once in a run."""
import unittest

from vtkmodules.vtkCommonCore import VTK_STRING, vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkMultiBlockDataSet, vtkPolyData

import test_filter


def warnings_of(extract):
    found = []

    def keep(_, event, text):
        found.append(text)

    keep.CallDataType = VTK_STRING
    extract.AddObserver("WarningEvent", keep)
    extract.Update()
    return found


def blocks_of(**blocks):
    result = vtkMultiBlockDataSet()
    for i, (name, block) in enumerate(blocks.items()):
        result.SetBlock(i, block)
        result.GetMetaData(i).Set(vtkCompositeDataSet.NAME(), name)
    return result


def with_kinds(particles, name, kind):
    copy = vtkPolyData()
    copy.DeepCopy(particles)
    kinds = vtkDoubleArray()
    kinds.SetName(name)
    for i in range(copy.GetNumberOfPoints()):
        kinds.InsertNextValue(kind(i))
    copy.GetPointData().AddArray(kinds)
    return copy


class TestWarnings(unittest.TestCase):
    def setUp(self):
        self.particles = test_filter.make_particles()

    def test_nothing_is_wrong(self):
        self.assertEqual(warnings_of(test_filter.make_filter(self.particles)), [])

    def test_iso_value(self):
        found = warnings_of(test_filter.make_filter(self.particles, iso=7))
        self.assertEqual(len(found), 1)
        self.assertRegex(found[0], "Iso value 7 is outside the range of Radius, 0 to 0.86")

    def test_once_in_a_run(self):
        extract = test_filter.make_filter(blocks_of(a=self.particles, b=self.particles))
        extract.SetBlocksToApart()
        extract.SetSmoothingLength(0.26)
        for _ in range(2):
            found = warnings_of(extract)
            self.assertEqual(len(found), 1)
            self.assertRegex(found[0], "Block 'a', index 1: .* neighbours.*support radius")
            extract.RemoveAllObservers()
            extract.Modified()

    def test_walls_in_a_block(self):
        fluid = self.particles
        for apart, words in ((1, "Block 'PartBound', index 2 of 2 seems to hold walls.*Set Blocks to Together"),
                             (0, "The names of some blocks suggest walls.*'WallBlock'")):
            extract = test_filter.make_filter(blocks_of(PartFluid=fluid, PartBound=fluid))
            extract.SetBlocks(apart)
            found = warnings_of(extract)
            self.assertEqual(len(found), 1)
            self.assertRegex(found[0], words)
            extract = test_filter.make_filter(blocks_of(Bound1=fluid, Bound2=fluid))
            extract.SetBlocks(apart)
            self.assertEqual(warnings_of(extract), [])

    def test_likely_kernel(self):
        """Named where such particles are usual for another one."""
        for kernel, h, words in (("cubic", 0.24, "Or the kernel is wendland"), ("wendland", 0.24, None),
                                 ("cubic", 0.08, "Or the kernel is quintic"), ("cubic", 0.05, "neighbours.*unit")):
            with self.subTest(kernel=kernel, h=h):
                extract = test_filter.make_filter(self.particles)
                extract.SetKernelByName(kernel)
                extract.SetSmoothingLength(h)
                found = [text for text in warnings_of(extract) if "neighbours" in text]
                self.assertEqual(len(found), 1 if words else 0)
                if words:
                    self.assertRegex(found[0], words)
                    self.assertEqual("Or the kernel" in found[0], "Or" in words)

    def test_unused_type(self):
        for name, kind, words in [
            ("ParticleType", lambda i: i % 2, "'ParticleType' is not used.*666 x 0, 665 x 1"),
            ("Type", lambda i: 3 if i else 0, "'Type' is not used.*1 x 0, 1330 x 3"),
            ("Type", lambda i: 3, None),
            ("Type", lambda i: i, None),
            ("Temperature", lambda i: i % 2, None),
        ]:
            with self.subTest(name):
                particles = with_kinds(self.particles, name, kind)
                found = warnings_of(test_filter.make_filter(particles))
                self.assertEqual(len(found), 1 if words else 0)
                if words:
                    self.assertRegex(found[0], words)
                    extract = test_filter.make_filter(particles)
                    extract.SetFluidArrayName(name)
                    extract.SetFluidValue(3 if name == "Type" else 1)
                    extract.SetSolids(extract.SOLIDS_WEIGHT)  # they lie everywhere
                    self.assertEqual(warnings_of(extract), [])


if __name__ == "__main__":
    unittest.main()
