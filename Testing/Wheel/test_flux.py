# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""flux(): of uniform flow by hand, of others against what probe() finds, and what is no section."""
import os
import tempfile
import unittest

import numpy as np
import pyvista

import marchingcorrectors as mc

H, V = 0.13, 0.001
X = np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.1
WORDS = {"smoothing_length": H, "volume": V}
UNIFORM = np.tile([1.0, -2.0, 3.0], (len(X), 1))
DISC = ("disc", (0.5, 0.5, 0.5), (0, 0, 2), 0.2)
WALL = np.array([[0.5, 0.2, 0.2], [0.5, 0.8, 0.2], [0.5, 0.2, 0.7]])


class Flux(unittest.TestCase):
    def test_uniform(self):
        cube = pyvista.Cube(center=(0.5, 0.5, 0.5), x_length=0.3, y_length=0.3, z_length=0.3).triangulate()
        triangles = cube.points[cube.faces.reshape(-1, 4)[:, 1:]].astype(float)
        sections = {"disc": DISC, "wall": WALL, "box": ("box", (0.3, 0.6, 0.3, 0.7, 0.2, 0.6)), "cube": triangles,
                    "far": WALL + 90}
        found = mc.flux(X, UNIFORM, sections, density=1000.0, **WORDS)
        self.assertEqual(found.names, list(sections))
        np.testing.assert_allclose(found.area, [0.04 * np.pi, 0.3, 0.24 + 0.24 + 0.32, 0.54, 0], rtol=1e-6)
        np.testing.assert_allclose(found.volume_flux, [0.12 * np.pi, 0.3, 0, 0, 0], atol=1e-6)
        np.testing.assert_allclose(found.mass_flux, 1000 * found.volume_flux, atol=1e-3)
        np.testing.assert_allclose(found.velocity[:2], [3, 1], rtol=1e-6)
        self.assertEqual(found.outside.tolist(), [False] * 4 + [True])
        self.assertTrue(np.isnan(found.velocity[4]))
        self.assertEqual(repr(found), "<Fluxes: 5 sections, 4 in fluid>")
        one = mc.flux(X, UNIFORM, DISC, mass=2.0, **WORDS)
        self.assertEqual((one.names, one.area[0]), (["0"], found.area[0]))
        np.testing.assert_allclose(one.mass_flux, 2000 * one.volume_flux)
        self.assertTrue(np.isnan(mc.flux(X, UNIFORM, WALL, **WORDS).mass_flux[0]))
        self.assertEqual(mc.flux(X, UNIFORM, [], **WORDS).area.shape, (0,))

    def test_against_samples(self):
        """A swirl through a wall, by Gauss's rule."""
        velocity = np.stack([np.sin(7 * X[:, 1]), np.cos(9 * X[:, 2]), X[:, 0]], -1)
        density = 1000 + 50 * np.sin(8 * X[:, 2])
        at, share = np.polynomial.legendre.leggauss(3)
        n = 60
        s, w = ((np.arange(n)[:, None] + 0.5 + 0.5 * at) / n).ravel(), np.tile(share / 2 / n, n)
        points = WALL[0] + s[:, None, None] * (WALL[1] - WALL[0]) + s[:, None] * (WALL[2] - WALL[0])
        samples = mc.probe(X, points.reshape(-1, 3), attributes={"v": velocity, "rho": density}, precision="double", **WORDS)
        expected = 0.3 * (np.outer(w, w).ravel() * samples.values["v"][:, 0] * samples.values["rho"]).sum()
        found = mc.flux(X, velocity, WALL, density=density, **WORDS).mass_flux[0]
        self.assertLess(abs(found - expected), 1e-6 * 0.3 * 1050)

    def test_plane(self):
        flat = X[np.isclose(X[:, 2], 0.5)] * [1, 1, 0]
        for velocity in (UNIFORM[:len(flat)], UNIFORM[:len(flat), :2]):
            found = mc.flux(flat, velocity, {"up": [(0.5, 0.3, 0), (0.5, 0.7, 0)]}, smoothing_length=H, volume=0.01)
            np.testing.assert_allclose([found.area[0], found.volume_flux[0]], 0.4, rtol=1e-6)

    def test_accessor(self):
        particles = pyvista.PolyData(X)
        particles["Velocity"], particles["rho"] = UNIFORM, np.full(len(X), 1000.0)
        expected = mc.flux(X.astype(particles.points.dtype), UNIFORM, {"a": DISC}, density=1000.0, **WORDS)
        self.assertEqual(particles.sph.flux({"a": DISC}, **WORDS), expected)
        sphere = pyvista.Sphere(radius=0.3, center=(0.5, 0.5, 0.5))
        inwards = pyvista.PolyData(sphere.points, sphere.faces.reshape(-1, 4)[:, [0, 1, 3, 2]].ravel())
        for surface in (sphere, inwards):
            found = particles.sph.flux({"ball": surface}, X - 0.5, **WORDS)
            self.assertLess(abs(found.volume_flux[0] - 3 * sphere.volume), 1e-3)  # outwards

    def test_a_file(self):
        """Its masses and volumes make densities."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "particles.csv")
            np.savetxt(path, np.column_stack([X, UNIFORM, np.tile([H, V, 1000 * V], (len(X), 1))]), delimiter=",", comments="",
                       header="x,y,z,vx,vy,vz,h,Volume,Mass")
            found = mc.flux(mc.io.read(path), "Velocity", WALL)
        np.testing.assert_allclose([found.volume_flux[0], found.mass_flux[0]], [0.3, 300], rtol=1e-5)

    def test_what_is_no_section(self):
        for sections, sentence in (([WALL[0]], "'0' has the shape"), ({"bow": WALL * 0}, "'bow' has no area"),
                                   (WALL * np.nan, "not finite"), (("ring", 1), "begins with 'ring'"),
                                   (("box", (1, 2, 3)), r"where it is \(6,\)"), (WALL[:2], "is a line")):
            with self.assertRaisesRegex(mc.InvalidArgument, sentence):
                mc.flux(X, UNIFORM, sections, **WORDS)
        with self.assertRaisesRegex(mc.InvalidArgument, "one iso value above 0"):
            mc.flux(X, UNIFORM, WALL, 0, **WORDS)
        with self.assertRaisesRegex(mc.InvalidArgument, "The velocity has 1 components"):
            mc.flux(X, UNIFORM[:, 0], WALL, **WORDS)
        with self.assertRaisesRegex(mc.InvalidData, "velocity is NaN or infinite at particle 0"):
            mc.flux(X, UNIFORM * np.nan, WALL, **WORDS)


if __name__ == "__main__":
    unittest.main()
