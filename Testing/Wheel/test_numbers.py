# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests gauge(), flux() and project(). Results for a block of particles are known by hand; results for other particles are compared with
probe() and counts. PyVista's methods and files must give the same. Wrong calls are refused."""
import unittest

import numpy as np
import pyvista

import marchingcorrectors as mc
from test_files import Case
from test_numpy import H, V, says

X = np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), -1).reshape(-1, 3) * 0.1
WORDS = {"smoothing_length": H, "volume": V}
UP = np.array([[0.52, 0.55, -1.0], [0.52, 0.55, 2.0]])
UNIFORM = np.tile([1.0, -2.0, 3.0], (len(X), 1))
DISC = ("disc", (0.5, 0.5, 0.5), (0, 0, 2), 0.2)
WALL = np.array([[0.5, 0.2, 0.2], [0.5, 0.8, 0.2], [0.5, 0.2, 0.7]])
# Random particles, far smaller than pixels.
RANDOM = np.random.default_rng(4)
POINTS, M, SMALL = RANDOM.random((3000, 3)), RANDOM.random(3000), np.full(3000, 1e-5)
WHOLE = {"box": (0, 1, 0, 1, 0, 1), "smoothing_length": SMALL, "mass": M, "resolution": 16}


class Gauge(unittest.TestCase):
    def test_readings(self):
        lines = {"mast": UP, "inside": UP * [1, 1, 0.1] + [0, 0, 0.2], "far": UP + 90}
        with self.assertWarnsRegex(mc.InputWarning, says("PLACE_DRY", "gauge", "far")):
            found = mc.gauge(X, lines, **WORDS)
        with self.assertWarnsRegex(mc.InputWarning, says("PLACES_DRY", "2", "3", "gauge", "mast")):
            mc.gauge(X, {**lines, "mast": UP - 90}, **WORDS)
        self.assertEqual(found.names, ["mast", "inside", "far"])
        self.assertEqual(found.state.tolist(), ["wet", "full", "dry"])
        self.assertEqual(found.outside.tolist(), [False, False, True])
        self.assertLess(abs(found.place[0, 2] - 1.15), 0.005)
        self.assertAlmostEqual(found.last[0], found.place[0, 2] + 1)
        self.assertAlmostEqual(found.depth[1], 0.3)
        self.assertEqual([len(each) for each in found.crossings.values()], [2, 0, 0])
        weight = mc.probe(X, UP[:1] + np.outer(found.crossings["mast"], [0, 0, 1]), **WORDS).weight_sum
        self.assertLess(np.abs(weight - 0.5).max(), 1e-4)
        self.assertTrue(np.isnan(found.place[2]).all() and np.isnan(found.last[2]) and found.depth[2] == 0)
        self.assertEqual(repr(found), "<Gauges: 3 lines, 1 dry, 1 wet, 1 full>")
        self.assertEqual(found, mc.gauge(X, lines, **WORDS))
        one = mc.gauge(X, UP, **WORDS)
        self.assertEqual((one.names, one.last.tolist()), (["0"], found.last[:1].tolist()))
        self.assertEqual(mc.gauge(X, [], **WORDS).place.shape, (0, 3))


class Flux(unittest.TestCase):
    def test_uniform(self):
        cube = pyvista.Cube(center=(0.5, 0.5, 0.5), x_length=0.3, y_length=0.3, z_length=0.3).triangulate()
        triangles = cube.points[cube.faces.reshape(-1, 4)[:, 1:]].astype(float)
        sections = {"disc": DISC, "wall": WALL, "box": ("box", (0.3, 0.6, 0.3, 0.7, 0.2, 0.6)), "cube": triangles,
                    "far": WALL + 90}
        with self.assertWarnsRegex(mc.InputWarning, says("PLACE_DRY", "section", "far")):
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
        for sections, more, sentence in (
                (("disc", (0, 0, 0), (1, 0), 1), {}, r"'0' has an array of the shape \(2,\) where it is \(3,\)"),
                (("disc", (0, 0, 0), "x", 1), {}, "does not hold numbers"), (3, {}, "of the type int; they must be one section"),
                ({"a": None}, {}, "section is None"), (DISC, {"mass": "a"}, "mass is 'a', which is not a number"),
                (DISC, {"mass": np.ones(3)}, r"The mass has the shape \(3,\); for 1728 particles")):
            with self.assertRaisesRegex(mc.InvalidArgument, sentence):
                mc.flux(X, UNIFORM, sections, **WORDS, **more)


class Project(unittest.TestCase):
    def test_directions(self):
        """Tests directions and sums; core_project compares the pixels."""
        for direction in ("x", (0, -2, 0), None):
            image = mc.project(POINTS, direction=direction, **WHOLE)
            self.assertAlmostEqual(image.values.sum() * image.pixel_area, M.sum(), delta=0.1)
            self.assertEqual((image.extent.tolist(), image.values.shape), ([0, 1, 0, 1], (16, 16)))
        self.assertEqual(repr(image), "<Projection: 16 x 16 pixels>")


class OtherParticles(Case):
    def particles(self, x, columns):
        """Returns the particles as PyVista's accessor, the same particles as read from a file, and their positions."""
        data = pyvista.PolyData(x)
        for name, values in columns.items():
            data[name] = values
        data.save(self.at("particles.vtp"))
        return data.sph, mc.io.read(self.at("particles.vtp")), np.asarray(data.points)

    def test_gauge_and_flux(self):
        """gauge() and flux() compute densities from the masses and volumes of files and of PyVista's points."""
        sph, file, x = self.particles(X, {"Velocity": UNIFORM, "h": np.full(len(X), H), "Volume": np.full(len(X), V),
                                          "Mass": np.full(len(X), 1000 * V)})
        lines, sections = {"mast": UP}, {"a": DISC}
        expected = mc.gauge(x, lines, **WORDS), mc.flux(x, UNIFORM, sections, mass=1000 * V, **WORDS)
        self.assertGreater(expected[1].mass_flux[0], 100)
        self.assertEqual((sph.gauge(lines), sph.flux(sections)), expected)
        self.assertEqual((mc.gauge(file, lines), mc.flux(file, "Velocity", sections)), expected)

    def test_flux_through_triangles(self):
        sph, _, _ = self.particles(X, {})
        sphere = pyvista.Sphere(radius=0.3, center=(0.5, 0.5, 0.5))
        inwards = pyvista.PolyData(sphere.points, sphere.faces.reshape(-1, 4)[:, [0, 1, 3, 2]].ravel())
        for surface in (sphere, inwards):
            found = sph.flux({"ball": surface}, X - 0.5, **WORDS)
            self.assertLess(abs(found.volume_flux[0] - 3 * sphere.volume), 1e-3)  # outwards

    def test_project(self):
        """Projections use masses even if there are volumes."""
        sph, file, x = self.particles(POINTS, {"Mass": M, "h": SMALL + 0.1, "Volume": SMALL + 1})
        words = {"smoothing_length": SMALL + 0.1, "mass": M, "volume": SMALL + 1, "direction": "x", "resolution": 10}
        for given, scalars in (({}, ()), ({"weighted_by": "Mass"}, ("Mass",))):
            arrays = {name: M for name in given}, [M for _ in scalars]
            expected = mc.project(x, *arrays[1], **arrays[0], **words)
            self.assertEqual(sph.project(*scalars, direction="x", resolution=10, **given), expected)
            self.assertEqual(mc.project(file, *scalars, direction="x", resolution=10, **given), expected)


class Refused(unittest.TestCase):
    def check(self, call, error, cases):
        for words, sentence in cases:
            with self.subTest(words), self.assertRaisesRegex(error, sentence):
                call(**words)

    def test_gauge(self):
        def gauge(lines=UP, iso=0.5, **more):
            mc.gauge(X, lines, iso, **WORDS, **more)

        self.check(gauge, mc.InvalidArgument, [
            ({"lines": UP[0]}, "shape"), ({"lines": {"bow": UP * 0}}, "bow' has no length"), ({"lines": UP * np.nan}, "not finite"),
            *(({"iso": iso}, "one iso value above 0") for iso in (0, -1, (0.2, 0.5)))])
        self.check(gauge, TypeError, [({"capping": True}, "no option 'capping'")])

    def test_flux(self):
        def flux(sections=WALL, velocity=UNIFORM, iso=0.5):
            mc.flux(X, velocity, sections, iso, **WORDS)

        self.check(flux, mc.InvalidArgument, [
            ({"sections": [WALL[0]]}, "'0' has the shape"), ({"sections": {"bow": WALL * 0}}, "'bow' has no area"),
            ({"sections": WALL * np.nan}, "not finite"), ({"sections": ("ring", 1)}, "begins with 'ring'"),
            ({"sections": ("box", (1, 2, 3))}, r"where it is \(6,\)"), ({"sections": WALL[:2]}, "is a line"),
            ({"iso": 0}, "one iso value above 0"), ({"velocity": UNIFORM[:, 0]}, "The velocity has 1 components")])
        self.check(flux, mc.InvalidData, [({"velocity": UNIFORM * np.nan}, says("FLUX_NOT_FINITE", "velocity", "particle 0"))])

    def test_project(self):
        def project(**words):
            mc.project(POINTS, **{**WHOLE, **words})

        self.check(project, mc.Error, [
            ({"direction": "w"}, "direction is 'w'"), ({"direction": (0, 0, 0)}, "not all 0"),
            ({"mass": None}, "neither mass nor density"), ({"resolution": 0}, "at least 1"), ({"box": (0, 1, 2)}, "6 numbers"),
            ({"box": (1, 0, 0, 1, 0, 1)}, "box along x"), ({"weighted_by": POINTS}, "3 components"), ({"scalar": M[:5]}, "shape")])
        self.check(project, TypeError, [({"iso": 1}, "no option 'iso'")])
        self.assertEqual(mc.project(np.empty((0, 3)), mass=1.0, smoothing_length=1.0).values.shape, (0, 0))


if __name__ == "__main__":
    unittest.main()
