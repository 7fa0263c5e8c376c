# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""One warning for each thing that may be wrong with the input, with figures, once in a run."""
import unittest

import numpy

from test_filter import make_filter, make_particles
from vtk_test import blocks_of, run


class TestWarnings(unittest.TestCase):
    def check(self, words, extract, **settings):
        """One sentence with these words; None: not a word."""
        told = run(extract, **settings)[1]
        self.assertEqual(len(told), 1 if words else 0, told)
        if words:
            self.assertRegex(told[0], words)

    def test_nothing_is_wrong(self):
        self.check(None, make_filter())

    def test_iso_value(self):
        self.check("Iso value 7 is outside the range of Radius, 0 to 0.86", make_filter(iso=7))

    def test_once_in_a_run(self):
        extract = make_filter(blocks_of(a=make_particles(), b=make_particles()))
        for _ in range(2):
            self.check("Block 'a', index 1: .* neighbours.*support radius", extract, BlocksToApart=(), SmoothingLength=0.26)
            extract.Modified()

    def test_walls_in_a_block(self):
        fluid = make_particles()
        for apart, words in ((1, "Block 'PartBound', index 2 of 2 seems to hold walls.*Set Blocks to Together"),
                             (0, "The names of some blocks suggest walls.*'WallBlock'")):
            self.check(words, make_filter(blocks_of(PartFluid=fluid, PartBound=fluid)), Blocks=apart)
            self.check(None, make_filter(blocks_of(Bound1=fluid, Bound2=fluid)), Blocks=apart)

    def test_likely_kernel(self):
        """Named where such particles are usual for another one."""
        for kernel, h, words in (("cubic", 0.24, "Or the kernel is wendland"), ("wendland", 0.24, None),
                                 ("cubic", 0.08, "Or the kernel is quintic"), ("cubic", 0.05, "neighbours.*unit")):
            with self.subTest(kernel=kernel, h=h):
                found = [text for text in run(make_filter(), KernelByName=kernel, SmoothingLength=h)[1] if "neighbours" in text]
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
                particles = make_particles(**{name: numpy.array([kind(i) for i in range(1331)], float)})
                self.check(words, make_filter(particles))
                if words:
                    extract = make_filter(particles)
                    self.check(None, extract, FluidArrayName=name, FluidValue=3 if name == "Type" else 1,
                               Solids=extract.SOLIDS_WEIGHT)  # they lie everywhere


if __name__ == "__main__":
    unittest.main()
