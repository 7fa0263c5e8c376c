# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""gauge(): what is read of lines, and what is no line."""
import unittest

import numpy as np
import pyvista

import marchingcorrectors as mc

H, V = 0.13, 0.001
POSITIONS = np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.1
UP = np.array([[0.52, 0.55, -1.0], [0.52, 0.55, 2.0]])
WORDS = {"smoothing_length": H, "volume": V}


class Gauge(unittest.TestCase):
    def test_readings(self):
        found = mc.gauge(POSITIONS, {"mast": UP, "inside": UP * [1, 1, 0.1] + [0, 0, 0.2], "far": UP + 90}, **WORDS)
        self.assertEqual(found.names, ["mast", "inside", "far"])
        self.assertEqual(found.state.tolist(), ["wet", "full", "dry"])
        self.assertEqual(found.outside.tolist(), [False, False, True])
        self.assertLess(abs(found.place[0, 2] - 1.15), 0.005)
        self.assertAlmostEqual(found.last[0], found.place[0, 2] + 1)
        self.assertAlmostEqual(found.depth[1], 0.3)
        self.assertEqual([len(each) for each in found.crossings.values()], [2, 0, 0])
        weight = mc.probe(POSITIONS, UP[:1] + np.outer(found.crossings["mast"], [0, 0, 1]), **WORDS).weight_sum
        self.assertLess(np.abs(weight - 0.5).max(), 1e-4)
        self.assertTrue(np.isnan(found.place[2]).all() and np.isnan(found.last[2]) and found.depth[2] == 0)
        self.assertEqual(repr(found), "<Gauges: 3 lines, 1 dry, 1 wet, 1 full>")
        self.assertEqual(found, mc.gauge(POSITIONS, {"mast": UP, "inside": UP * [1, 1, 0.1] + [0, 0, 0.2],
                                                     "far": UP + 90}, **WORDS))
        one = mc.gauge(POSITIONS, UP, **WORDS)
        self.assertEqual((one.names, one.last.tolist()), (["0"], found.last[:1].tolist()))
        self.assertEqual(mc.gauge(POSITIONS, [], **WORDS).place.shape, (0, 3))

    def test_accessor(self):
        particles = pyvista.PolyData(POSITIONS)
        self.assertEqual(particles.sph.gauge({"mast": UP}, **WORDS), mc.gauge(POSITIONS, {"mast": UP}, **WORDS))

    def test_what_is_no_line(self):
        for lines, sentence in ((UP[0], "shape"), ({"bow": UP * 0}, "bow' has no length"), (UP * np.nan, "not finite")):
            with self.assertRaisesRegex(mc.InvalidArgument, sentence):
                mc.gauge(POSITIONS, lines, **WORDS)
        for iso in (0, -1, (0.2, 0.5)):
            with self.assertRaisesRegex(mc.InvalidArgument, "one iso value above 0"):
                mc.gauge(POSITIONS, UP, iso, **WORDS)
        with self.assertRaisesRegex(TypeError, "no option 'capping'"):
            mc.gauge(POSITIONS, UP, capping=True, **WORDS)


if __name__ == "__main__":
    unittest.main()
