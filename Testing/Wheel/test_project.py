# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""project(): masses of particles along columns, against sums over particles far smaller and far larger than pixels."""
import pathlib
import tempfile
import unittest

import numpy as np
import pyvista

import marchingcorrectors as mc

RANDOM = np.random.default_rng(4)
X, M, H = RANDOM.random((3000, 3)), RANDOM.random(3000), np.full(3000, 1e-5)
WHOLE = {"box": (0, 1, 0, 1, 0, 1), "smoothing_length": H, "mass": M, "resolution": 16}


class Project(unittest.TestCase):
    def test_small_particles_are_counted(self):
        for direction, (u, v) in (("x", (1, 2)), ((0, -2, 0), (0, 2)), (None, (0, 1))):
            image = mc.project(X, direction=direction, **WHOLE)
            expected, _, _ = np.histogram2d(X[:, v], X[:, u], 16, [[0, 1], [0, 1]], weights=M)
            split = np.abs(image.values * image.pixel_area - expected) > 1e-12  # by particles on the sides of pixels
            self.assertLess(split.sum(), 20)
            self.assertAlmostEqual(image.values.sum() * image.pixel_area, M.sum(), delta=0.1)
            self.assertEqual(image.extent.tolist(), [0, 1, 0, 1])
            self.assertEqual(image.values.shape, (16, 16))
        self.assertEqual(repr(image), "<Projection: 16 x 16 pixels>")

    def test_all_of_the_mass(self):
        for kernel in ("cubic", "mprime4", "wendland_c6"):
            for direction in ("y", (1, 2, -3)):
                image = mc.project(X, smoothing_length=0.1, mass=M, direction=direction, resolution=50, sph_kernel=kernel)
                self.assertAlmostEqual(image.values.sum() * image.pixel_area / M.sum(), 1, delta=1e-8)
        turned = image.axes @ image.axes.T
        self.assertLess(np.abs(turned - np.eye(3)).max(), 1e-15)
        image = mc.project(X, smoothing_length=0.1, mass=M, periodic=(1, 1, 1), resolution=20)
        self.assertAlmostEqual(image.values.sum() * image.pixel_area / M.sum(), 1, delta=1e-8)
        self.assertLess(image.values.std() / image.values.mean(), 0.2)

    def test_scalars_and_weights(self):
        words = {**WHOLE, "smoothing_length": 0.2, "volume": 1 / 3000, "resolution": 9}
        ones = np.ones(3000)
        integral = mc.project(X, ones, **words).values
        self.assertAlmostEqual(integral[4, 4], 1, delta=0.1)
        weighted = mc.project(X, X[:, 0], weighted_by=M, **words).values
        self.assertTrue((np.diff(weighted.mean(axis=0)) > 0).all())
        by_mass = mc.project(X, X[:, 0], weighted_by=M, **{**words, "mass": M, "volume": M}).values
        self.assertAlmostEqual(np.abs(by_mass - weighted).max(), 0, delta=1e-12)
        vector = mc.project(X, X, scalar_component=1, **words).values
        self.assertTrue((mc.project(X, X[:, 1], **words).values == vector).all())

    def test_a_file(self):
        """Whose masses count even where there are volumes."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "particles.csv"
            np.savetxt(path, np.column_stack([X, M, H + 0.1, H + 1]), delimiter=",", header="x,y,z,Mass,h,Volume", comments="")
            image = mc.project(mc.io.read(path), resolution=10)
            mean = mc.project(mc.io.read(path), "Mass", weighted_by="Mass", resolution=10)
        self.assertAlmostEqual(image.values.sum() * image.pixel_area / M.sum(), 1, delta=1e-8)
        self.assertTrue(0.4 < np.nanmean(mean.values) < 0.8)

    def test_accessor(self):
        """Whose masses count even where there are volumes."""
        particles = pyvista.PolyData(X)
        x = np.asarray(particles.points)
        particles["Mass"], particles["h"], particles["Volume"] = M, H + 0.1, H + 1
        words = {"smoothing_length": H + 0.1, "mass": M, "volume": H + 1, "direction": "x", "resolution": 20}
        self.assertEqual(particles.sph.project(direction="x", resolution=20), mc.project(x, **words))
        self.assertEqual(particles.sph.project("Mass", weighted_by="Mass", direction="x", resolution=20),
                         mc.project(x, M, weighted_by=M, **words))

    def test_what_is_refused(self):
        for words, sentence in (({"direction": "w"}, "direction is 'w'"), ({"direction": (0, 0, 0)}, "not all 0"),
                                ({"mass": None}, "neither mass nor density"), ({"resolution": 0}, "at least 1"),
                                ({"box": (0, 1, 2)}, "six|6 numbers"), ({"box": (1, 0, 0, 1, 0, 1)}, "box along x"),
                                ({"weighted_by": X}, "3 components"), ({"scalar": M[:5]}, "shape")):
            with self.subTest(words), self.assertRaisesRegex(mc.Error, sentence):
                mc.project(X, **{**WHOLE, **words})
        with self.assertRaisesRegex(TypeError, "no option 'iso'"):
            mc.project(X, iso=1, **WHOLE)
        self.assertEqual(mc.project(np.empty((0, 3)), mass=1.0, smoothing_length=1.0).values.shape, (0, 0))


if __name__ == "__main__":
    unittest.main()
