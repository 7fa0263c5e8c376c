# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The core's warnings arrive once in a run, and name their block; core_warning tests every warning."""
import unittest

import numpy

from test_filter import make_filter, make_particles
from vtk_test import blocks_of, run, says


class TestWarnings(unittest.TestCase):
    def check(self, words, extract, **settings):
        """Expects a run that gives one sentence, which matches, or none if words is None."""
        told = run(extract, **settings)[1]
        self.assertEqual(len(told), 1 if words else 0, told)
        if words:
            self.assertRegex(told[0], words)

    def test_nothing_is_wrong(self):
        self.check(None, make_filter())

    def test_iso_value(self):
        self.check(says("ISO_OUTSIDE", "7 is", "Radius, 0 to 0.86"), make_filter(iso=7))

    def test_once_in_a_run(self):
        extract = make_filter(blocks_of(a=make_particles(), b=make_particles()))
        for _ in range(2):
            self.check("Block 'a', index 1: " + says("NEIGHBOURS_UNUSUAL", "Smoothing Length Is Support Radius"), extract, BlocksToApart=(), SmoothingLength=0.26)
            extract.Modified()

    def test_walls_in_a_block(self):
        fluid = make_particles()
        for apart, words in ((1, says("WALLS_IN_BLOCK", "Block 'PartBound', index 2 of 2", "Blocks together")),
                             (0, says("WALL_BLOCKS_UNUSED", "Fluid Array WallBlock"))):
            self.check(words, make_filter(blocks_of(PartFluid=fluid, PartBound=fluid)), Blocks=apart)
            self.check(None, make_filter(blocks_of(Bound1=fluid, Bound2=fluid)), Blocks=apart)

    def test_unused_type(self):
        usual = numpy.arange(1331.0) % 2
        unknown = numpy.where(numpy.arange(1331) % 3, usual, -numpy.nan)
        for name, kinds, words in (
                ("ParticleType", usual, says("TYPE_UNUSED", "'ParticleType'", "666 x 0, 665 x 1")), ("Temperature", usual, None),
                ("ParticleType", unknown, says("TYPE_UNUSED", "444 x 0, 443 x 1, 444 x nan[.]", "of the fluid[.]"))):
            with self.subTest(name):
                particles = make_particles(**{name: kinds})
                self.check(words, make_filter(particles), InterpolateAttributes=0)
                self.check(None, make_filter(particles), FluidArrayName=name, FluidValue=1, Solids=0)  # The other particles lie everywhere.


if __name__ == "__main__":
    unittest.main()
