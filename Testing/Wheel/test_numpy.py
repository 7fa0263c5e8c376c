# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the functions for NumPy: shapes, types, what is copied, errors, interrupts."""
import os
import signal
import sys
import threading
import unittest
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import marchingcorrectors as mc
from marchingcorrectors import _options, _structs
from marchingcorrectors._call import prepare

sys.path.insert(0, str(Path(__file__).parents[1]))
from says import says  # noqa: E402

N = 14
H, V = 0.13, 0.001


def lattice(dtype=np.float64):
    """Returns the positions of particles in a cube, moved a little from a lattice, and their distances from its
    centre."""
    random = np.random.default_rng(1)
    indices = np.stack(np.meshgrid(*[np.arange(N)] * 3, indexing="ij"), -1).reshape(-1, 3)
    positions = indices * 0.1 + random.normal(0, 0.004, (N ** 3, 3))
    return positions.astype(dtype), np.linalg.norm(positions - 0.65, axis=1).astype(dtype)


POSITIONS, DISTANCE = lattice()


def sphere(**more):
    return mc.isosurface(**{"positions": POSITIONS, "scalar": DISTANCE, "iso": 0.4, "smoothing_length": H, "volume": V, **more})


def quietly(function, *arguments, **words):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", mc.InputWarning)
        return function(*arguments, **words)


class Results(unittest.TestCase):
    def test_sphere(self):
        surface = sphere()
        radius = np.linalg.norm(surface.points - 0.65, axis=1)
        self.assertGreater(len(surface.triangles), 500)
        self.assertLess(np.abs(radius - 0.4).max(), 0.03)
        # Normals point to lower values, here to the centre.
        inwards = np.einsum("ij,ij->i", surface.normals, 0.65 - surface.points)
        self.assertGreater(inwards.min(), 0)
        self.assertEqual((surface.points.dtype, surface.triangles.dtype, surface.normals.dtype),
                         (np.float64, np.int32, np.float32))
        self.assertLess(surface.triangles.max(), len(surface.points))

    def test_arrays_own_their_memory(self):
        surface = sphere(attributes={"x": POSITIONS})
        for array in (surface.points, surface.triangles, surface.normals, surface.attributes["x"]):
            self.assertTrue(array.flags.owndata and array.flags.writeable)

    def test_every_array_on_request(self):
        wanted = ("gradients weight_sum boundary_eigenvalue correction_length residual boundary_flag iso_value "
                  "nearest_particle mean_curvature gauss_curvature point_keys").split()
        surface = sphere(**dict.fromkeys(wanted, True), triangle_keys=True)
        for name in wanted:
            self.assertEqual(len(getattr(surface, name)), len(surface.points), name)
            self.assertIsNone(getattr(sphere(), name))
        self.assertEqual((surface.point_keys.shape, surface.point_keys.dtype), ((len(surface.points), 3), np.uint64))
        self.assertEqual(len(np.unique(surface.point_keys, axis=0)), len(surface.points))
        self.assertEqual(surface.triangle_keys.shape, (len(surface.triangles), 2))
        self.assertIsNone(sphere(normals=False).normals)

    def test_options_reach_the_core(self):
        for name, (numbers, _, _) in _structs.OPTIONS.items():
            if name not in ("periodic", "box", "capping"):
                kind = _options.Options.__annotations__[name]
                for value, number in {True: 1}.items() if kind is bool else numbers.items() if numbers else {3: 3}.items():
                    options = prepare(POSITIONS, {"smoothing_length": H, name: value}).options
                    self.assertEqual(getattr(options, name), number, name)

    def test_attributes(self):
        identifiers = np.arange(N ** 3) + 7
        surface = sphere(attributes={"where": POSITIONS, "id": identifiers, "one": np.ones(N ** 3, np.float32)})
        self.assertLess(np.abs(surface.attributes["where"] - surface.points).max(), 0.03)
        np.testing.assert_allclose(surface.attributes["one"], 1, rtol=1e-6)
        nearest = surface.attributes["id"] - 7
        self.assertEqual(surface.attributes["id"].dtype, identifiers.dtype)
        some = slice(None, None, 37)
        distances = np.linalg.norm(surface.points[some, None] - POSITIONS[None], axis=2)
        np.testing.assert_array_equal(nearest[some], distances.argmin(axis=1))
        self.assertIsNone(surface.nearest_particle)

    def test_attribute_that_is_not_finite(self):
        bad = DISTANCE.copy()
        bad[17] = np.nan
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            surface = sphere(attributes={"bad": bad, "good": DISTANCE})
        self.assertEqual(surface.left_out, {"bad": 17})
        self.assertEqual(list(surface.attributes), ["good"])
        self.assertIn("'bad'", str(caught[0].message))

    def test_left_out(self):
        """Particles that `within` or `only` leaves out change nothing, whatever their values are."""
        kind = np.arange(N ** 3) % 4
        near = POSITIONS[:, 0] < 0.7
        for more, present in (({"within": (-np.inf, 0.7, -1, 2, -1, 2)}, near),
                              ({"only": kind > 0}, kind > 0), ({"only": {"kind": (1, 3)}}, kind > 0),
                              ({"only": {"kind": (0, np.int8(2)), "high": True}}, (kind < 3) & (DISTANCE > 0.3)),
                              ({"only": {"kind": [1, 3]}, "within": np.array([-1, 0.7, -1, 2, -1, 2])}, near & (kind > 0))):
            x, d, h = (np.where(present if array.ndim == 1 else present[:, None], array, np.nan)
                       for array in (POSITIONS, DISTANCE, np.full(N ** 3, H)))
            x[~present & ~near] = 1e9
            given = {"smoothing_length": h, "volume": V, "attributes": {"kind": kind, "high": DISTANCE > 0.3, "d": d}, **more}
            alone = {"smoothing_length": H, "volume": V, "attributes": {"kind": kind[present], "d": d[present]}}
            found = mc.isosurface(x, d, 0.4, **given)
            expected = mc.isosurface(x[present], d[present], 0.4, **alone)
            self.assertGreater(len(expected.triangles), 100)
            for name in ("kind", "d"):
                self.assertEqual(found.attributes[name].tobytes(), expected.attributes[name].tobytes(), more)
            self.assertEqual(found.points.tobytes(), expected.points.tobytes(), more)
            self.assertEqual(quietly(mc.free_surface, x, periodic=(1.4, 0, 0), **given).points.tobytes(),
                             quietly(mc.free_surface, x[present], periodic=(1.4, 0, 0), **alone).points.tobytes(), more)
            samples = mc.probe(x, POSITIONS[:9], **given), mc.probe(x[present], POSITIONS[:9], **alone)
            self.assertEqual(*[each.values["d"].tobytes() for each in samples], more)
            gradients = mc.derivatives(x, **given).gradients["d"]
            self.assertEqual(gradients.shape, (N ** 3, 3))
            self.assertEqual(gradients[present].tobytes(), mc.derivatives(x[present], **alone).gradients["d"].tobytes(), more)
        line, level = ((0.65, 0.65, 0.65), (3, 0.65, 0.65)), {"smoothing_length": H, "volume": V}
        self.assertEqual(mc.gauge(POSITIONS, line, within=(-1, 1, -1, 2, -1, 2), **level).last,
                         mc.gauge(POSITIONS[POSITIONS[:, 0] <= 1], line, **level).last)
        self.assertLess(mc.gauge(POSITIONS, line, only=near, **level).last[0], 0.2)
        solid = np.full(N ** 3, 2, np.uint8)  # This is the core's number for particles that are left out.
        solid[near] = 0
        self.assertEqual(sphere(solid=solid), sphere(solid=~near))

    def test_iso_value_about_the_median(self):
        surface = mc.isosurface(POSITIONS, DISTANCE, smoothing_length=H, volume=V, outputs="iso_value")
        value, = set(surface.iso_value)
        self.assertEqual(surface.points.tobytes(), sphere(iso=value).points.tobytes())
        self.assertLess(abs(value - np.median(DISTANCE)), 0.1)

    def test_outputs(self):
        named = sphere(outputs=("residual", "gradients"))
        self.assertEqual(named, sphere(residual=True, gradients=True))
        self.assertEqual(sphere(outputs="residual", normals=False), sphere(residual=True, normals=False))
        self.assertEqual(mc.probe(POSITIONS, POSITIONS[:5], outputs=["gradients"], smoothing_length=H, attributes={"d": DISTANCE}),
                         mc.probe(POSITIONS, POSITIONS[:5], gradients=True, smoothing_length=H, attributes={"d": DISTANCE}))
        for outputs, words in (("residual", "outputs names 'residual'. Outputs are gradients"), (3, "outputs names 3")):
            with self.assertRaisesRegex(mc.InvalidArgument, words):
                mc.probe(POSITIONS, POSITIONS[:5], outputs=outputs, smoothing_length=H, attributes={"d": DISTANCE})

    def test_component_of_a_number(self):
        with self.assertRaisesRegex(mc.InvalidArgument, "scalar_component is for vectors"):
            sphere(scalar_component=1)

    def test_widening(self):
        """Smoothing lengths multiplied by the factors of widening(), with the volumes of the original lengths, make the same
        surface as `widen` if cubes have one size."""
        for given in ({}, {"volume": 1e-3}):
            words = {"cube_size": H / 2, **given}
            factors, volume = mc.widening(POSITIONS, smoothing_length=H, return_volume=True, **words)
            self.assertEqual(factors.tobytes(), mc.widening(POSITIONS, smoothing_length=H, **words).tobytes())
            self.assertEqual((factors.max(), volume is None), (2, "volume" in given))
            wide = mc.free_surface(POSITIONS, smoothing_length=H, widen=2, **words)
            plain = mc.free_surface(POSITIONS, smoothing_length=factors * H, level_limit=0, **{"volume": volume, **words})
            self.assertEqual(wide.points.tobytes(), plain.points.tobytes())
            self.assertEqual((wide.statistics["widening_min"], wide.statistics["widening_max"]), (factors.min(), 2))
        self.assertEqual(mc.probe(POSITIONS, POSITIONS[:9], smoothing_length=H, widen=2), mc.probe(POSITIONS, POSITIONS[:9], smoothing_length=H, smooth=True))

    def test_lines(self):
        flat = np.stack(np.meshgrid(np.arange(N) * 0.1, [0.5], np.arange(N) * 0.1, indexing="ij"), -1).reshape(-1, 3)
        distance = np.hypot(flat[:, 0] - 0.65, flat[:, 2] - 0.65)
        surface = mc.isosurface(flat, distance, 0.4, smoothing_length=H, volume=0.01, weight_sum=True)
        line, = surface.lines
        self.assertEqual((surface.statistics["dimension"], surface.triangles.shape), (2, (0, 3)))
        self.assertEqual(line[0], line[-1])
        self.assertEqual(sorted(line[1:]), list(range(len(surface.points))))
        self.assertTrue((surface.points[:, 1] == 0.5).all())
        filled = mc.isosurface(flat, distance, (0.4, 0.2), smoothing_length=H, volume=0.01, filled=True)
        self.assertEqual((len(filled.lines), sorted(set(filled.band_value))), (2, [0.2, 0.4]))
        self.assertEqual((len(filled.band_value), filled.line_values().tolist()), (len(filled.triangles), [0.4, 0.2]))
        self.assertIn(f"2 lines, {len(filled.triangles)} triangles", repr(filled))
        self.assertIsNone(surface.band_value)
        space = quietly(mc.isosurface, flat, distance, 0.4, smoothing_length=H, volume=0.01, dimension=3)
        self.assertEqual(space.lines, [])
        with self.assertRaisesRegex(mc.InvalidData, says("NOT_IN_PLANE")):
            sphere(dimension=2)

    def test_empty(self):
        surface = mc.isosurface(np.empty((0, 3)), np.empty(0), iso=1, smoothing_length=1.0)
        self.assertEqual((surface.points.shape, surface.triangles.shape), ((0, 3), (0, 3)))
        self.assertEqual(len(quietly(sphere, iso=99).triangles), 0)
        everything = quietly(sphere, iso=99, point_keys=True, triangle_keys=True, nearest_particle=True)
        self.assertEqual((everything.point_keys.shape, everything.triangle_keys.shape), ((0, 3), (0, 2)))
        for nothing in (np.empty((0, 3)), []):
            self.assertEqual(len(mc.probe(POSITIONS, nothing, smoothing_length=H).valid), 0)

    def test_probe_and_derivatives(self):
        linear = POSITIONS @ [1.0, 2.0, 3.0]
        found = mc.probe(POSITIONS, [[0.65, 0.65, 0.65], [9, 9, 9]], smoothing_length=H, volume=V,
                         attributes={"a": linear, "v": POSITIONS}, gradients=True)
        self.assertEqual(found.valid.tolist(), [True, False])
        self.assertTrue(np.isnan(found.values["v"][1]).all() and np.isnan(found.gradients["a"][1]).all())
        grid = mc.probe(POSITIONS, POSITIONS[:12].reshape(3, 4, 3), smoothing_length=H, volume=V,
                        attributes={"a": linear, "v": POSITIONS.astype(np.float32)}, gradients=True)
        flat = mc.probe(POSITIONS, POSITIONS[:12], smoothing_length=H, volume=V, attributes={"a": linear}, gradients=True)
        self.assertEqual((grid.valid.shape, grid.values["v"].shape, grid.gradients["v"].shape, grid.values["v"].dtype),
                         ((3, 4), (3, 4, 3), (3, 4, 3, 3), np.float32))
        np.testing.assert_array_equal(grid.values["a"].ravel(), flat.values["a"])
        np.testing.assert_array_equal(grid.weight_gradient.reshape(-1, 3), flat.weight_gradient)
        self.assertAlmostEqual(found.values["a"][0], 3.9, delta=0.05)
        self.assertEqual((found.values["v"].shape, found.gradients["a"].shape, found.gradients["v"].shape),
                         ((2, 3), (2, 3), (2, 3, 3)))
        derived = mc.derivatives(POSITIONS, {"a": linear, "v": POSITIONS}, smoothing_length=H, volume=V)
        inside = derived.corrected
        np.testing.assert_allclose(derived.gradients["a"][inside], np.tile([1, 2, 3], (inside.sum(), 1)), atol=1e-3)
        np.testing.assert_allclose(mc.flow(derived.gradients["v"])["divergence"][inside], 3, atol=1e-3)
        standard = mc.derivatives(POSITIONS, {"a": linear}, smoothing_length=H, volume=V, form="standard")
        self.assertFalse(standard.corrected.any())


class Inputs(unittest.TestCase):
    def test_all_kinds_of_arrays(self):
        expected = sphere().points
        others = {"a list": POSITIONS.tolist(), "Fortran order": np.asfortranarray(POSITIONS),
                  "every second": np.repeat(POSITIONS, 2, axis=0)[::2], "big end first": POSITIONS.astype(">f8")}
        for name, positions in others.items():
            found = mc.isosurface(positions, DISTANCE, iso=0.4, smoothing_length=H, volume=V).points
            self.assertEqual(found.tobytes(), expected.tobytes(), name)
        halves = mc.isosurface(POSITIONS.astype(np.float32), DISTANCE.astype(np.float16), iso=0.4,
                               smoothing_length=np.full(N ** 3, H, np.float32), volume=V)
        self.assertGreater(len(halves.triangles), 500)

    def test_right_arrays_are_not_copied(self):
        for dtype in (np.float32, np.float64):
            positions, distance = lattice(dtype)
            arguments = prepare(positions, {"smoothing_length": H, "volume": distance}, {"a": distance})
            self.assertEqual(arguments.input.positions.data, positions.ctypes.data)
            self.assertEqual(arguments.input.volume.data, distance.ctypes.data)
            self.assertEqual(arguments.input.attributes[0].data, distance.ctypes.data)

    def test_odd_bytes(self):
        def unaligned(array):
            return np.frombuffer(b"0" + array.tobytes(), np.uint8)[1:].view(array.dtype).reshape(array.shape)

        found = mc.isosurface(unaligned(POSITIONS), unaligned(DISTANCE), iso=0.4, smoothing_length=H, volume=V,
                              attributes={"name\udc80": unaligned(POSITIONS), "nul\0": DISTANCE})
        self.assertEqual(found.points.tobytes(), sphere().points.tobytes())
        self.assertEqual(list(found.attributes), ["name\udc80", "nul\0"])


class Refused(unittest.TestCase):
    def check(self, error, *cases, call=sphere, **common):
        """Checks calls that fail. Each of `cases` has a pattern of the message, followed by dictionaries of keywords; a call
        with any of these dictionaries must fail with this message."""
        for sentence, *several in cases:
            for words in several:
                with self.subTest(str(words)[:80]), self.assertRaisesRegex(error, sentence):
                    call(**{**common, **words})

    def test_arguments(self):
        text, masked, nothing = np.array(["a"] * N ** 3), np.ma.masked_greater(DISTANCE, 0.9), np.zeros((N ** 3, 0))
        self.check(mc.InvalidArgument,
                   ("smoothing length", {"smoothing_length": -1.0}), ("estimate", {"smoothing_length": None}),
                   ("scalar has the shape", {"scalar": DISTANCE[:-1]}, {"scalar": nothing}),
                   (r"\(particles, 3\), .*third coordinate is a constant", {"positions": POSITIONS[:, :2]}),
                   (r"\(particles, 3\)", {"positions": nothing}), ("Give its transpose", {"positions": POSITIONS.T}),
                   (r"positions is 'a.vtp'. To read a file, give .*io.read\('a.vtp'\)", {"positions": "a.vtp"}),
                   ("positions is None; it must be an array", {"positions": None}), ("is a set;", {"scalar": {1}}),
                   ("has the shape", {"smoothing_length": nothing}, {"volume": nothing}, {"attributes": {"a": nothing}},
                    {"scalar_dot": nothing}),  # The core reads 0 components as 1.
                   ("The iso value is nan; it must be a finite number", {"iso": np.nan}),
                   ("The iso value is inf", {"iso": [0.4, np.inf]}),
                   ("wendland", {"sph_kernel": "gaussian"}), ("'residual'.*Outputs are normals", {"outputs": "residul"}),
                   ("'residual', but residual is False", {"outputs": ["residual"], "residual": False}), ("does not hold numbers", {"volume": text}),
                   ("periodic is .*; it must be six bounds .*, or three lengths", {"periodic": True}, {"periodic": "auto"}),
                   ("not 'wendlnd'. Did you mean 'wendland'?", {"sph_kernel": "wendlnd"}),
                   ("", {"smoothing_length": "abc"}, {"iso": "x"}, {"iso": 1j}, {"iso": [[0.3, 0.4], [0.5, 0.6]]},
                    {"volume": [[1, 2], [3]]}, {"volume": masked}, {"attributes": {"a": masked}}, {"solid": text},
                    {"attributes": [DISTANCE]}, {"box": "abcdef"}, {"box": [None] * 6}, {"context": 3}))
        for name in ("smoothing_length", "volume", "mass", "density"):
            mass = {"volume": None, "mass": None if name == "volume" else 1.0}
            self.check(mc.InvalidArgument, (f"{name.replace('_', ' ')} is .*; .* greater than 0",
                                            *({**mass, name: value} for value in (0, 0.0, -1, np.nan))))
        probe = {"call": mc.probe, "positions": POSITIONS, "smoothing_length": H}
        self.check(mc.InvalidArgument, (r"\(\.\.\., 3\)", {"points": nothing}), ("", {"points": "x"}), **probe)
        self.check(mc.InvalidArgument, ("", {"gradients": "x"}), call=mc.flow)

    def test_numbers_out_of_range(self):
        self.check(mc.InvalidArgument, ("", *(
            {name: value} for name, values in (
                ("iteration_limit", (2 ** 32 + 5, 3.7, np.inf, None)), ("memory_limit", (2 ** 70,)),
                ("particles_version", (2 ** 64, -1)), ("sph_kernel", (None, [1])), ("field", (2 ** 32,)), ("tolerance", ("x",)),
                ("h_scale", (None,)), ("precision", (object(),))) for value in values)))
        self.assertGreater(len(sphere(iteration_limit=np.float64(30), memory_limit=2 ** 40).triangles), 500)

    def test_data_and_devices(self):
        bad, zeros = POSITIONS.copy(), np.full(N ** 3, H)
        bad[5, 1], zeros[11] = np.nan, 0
        self.check(mc.InvalidData, ("5", {"positions": bad}), ("smoothing length.* 11 ", {"smoothing_length": zeros}))
        self.check(mc.OutOfCapacity, ("(?i)memory|cube", {"memory_limit": 1000}))
        self.check(mc.DeviceError, (says("NO_SUCH_DEVICE", "nonsuch"), {"device": "nonsuch"}), ("", {"device": "\udc80"}))
        self.assertGreater(len(sphere().triangles), 500)  # The library works as before.

    def test_what_leaves_particles_out(self):
        wall = np.arange(N ** 3) % 4
        self.check((mc.InvalidArgument, mc.InvalidData),
                   ("six bounds", {"within": (0, 1)}, {"within": (0, np.nan, 0, 1, 0, 1)}),
                   ("lower ones first", {"within": (1, 0, 0, 1, 0, 1)}), ("within does not hold numbers", {"within": "abcdef"}),
                   ("Did you mean 'wall'.*Attributes: wall, x", {"only": {"walls": 1}}), ("not a number", {"only": {"wall": "a"}}),
                   ("lowest and the highest", {"only": {"wall": (1, 2, 3)}}), ("lower value", {"only": {"wall": (3, 1)}}),
                   ("is nan; it must be a number", {"only": {"wall": np.nan}}),
                   ("'x'.*one number for each", {"only": {"x": 1}}), ("True or False for each of 2744", {"only": wall}),
                   attributes={"wall": wall, "x": POSITIONS})
        for words in ({"within": (5, 6, 5, 6, 5, 6)}, {"only": wall < 0}, {"fluid": ("wall", 9)}, {"fluid": (wall, 9)}, {"solid": wall >= 0}):
            with self.assertWarnsRegex(mc.InputWarning, says("NOTHING_WITHOUT_FLUID", "No particle (is|has) .*", "no surface")):
                self.assertEqual(len(sphere(attributes={"wall": wall}, **words).points), 0)
            with self.assertRaisesRegex(mc.InvalidData, "^No particle (is|has) .*, so there is no fluid"):
                mc.derivatives(POSITIONS, {"wall": wall}, smoothing_length=H, **words)
            with self.assertWarnsRegex(mc.InputWarning, "so there is no fluid and all gauges are dry"):
                found = mc.gauge(POSITIONS, ((0, 0, 0), (1, 1, 1)), smoothing_length=H, **{"only": wall < 0})
            self.assertEqual(found.state.tolist(), ["dry"])
        for only, words in (({"kind": "c"}, "left by kind=c, so"), (wall < 0, "left by only, so")):
            with self.assertWarnsRegex(mc.InputWarning, words):
                sphere(attributes={"kind": np.where(wall, "a", "b")}, only=only)
        with mc.Context() as context, self.assertWarnsRegex(mc.InputWarning, "so there is no fluid"):
            sphere(only=wall < 0, widen=2, context=context)
        for kind in (">i4", "i4"):
            marks = {"ParticleType": (wall > 1).astype(kind)}
            self.assertEqual(sphere(fluid="auto", attributes=marks), sphere(fluid="ParticleType=0", attributes=marks))
        with self.assertWarnsRegex(mc.InputWarning, "No array clearly tells .* fluid names an array"):
            sphere(fluid="auto")
        self.check(mc.InvalidArgument, ("Attributes: none", {"only": {"wall": 1}}, {"fluid": "wall=1"}), ("solid and fluid both", {
            "solid": wall, "fluid": ("wall", 1)}), *((r'it must be \("NAME", VALUE\)', {"fluid": fluid}) for fluid in ("wall", 3, ("wall",), {})),
                   ("value of fluid is 'x'", {"fluid": "wall=x"}), call=mc.gauge, positions=POSITIONS,
                   lines=((0, 0, 0), (1, 1, 1)), smoothing_length=H)


class Neighbours(unittest.TestCase):
    """Tests smoothing lengths that are estimated for each particle."""

    def test_densities(self):
        """If the scalar "Density" is missing, it is summed from masses; core_neighbour_sums compares the sums. Particles that are left out
        do not change the sums."""
        x = np.random.default_rng(3).normal(size=(200, 3))
        more = np.concatenate([x, [[np.nan, 0, 0], [50, 0, 0]]])
        words = dict(field="sum", node_threshold=0, vertex_threshold=0, estimate_smoothing_length="neighbours", mass=1.0)
        first = quietly(mc.isosurface, x, "Density", 0.5, **words)
        again = quietly(mc.isosurface, more, "Density", 0.5, only=np.arange(202) < 200, **words)
        self.assertGreater(len(first.points), 100)
        self.assertEqual(first.points.tobytes(), again.points.tobytes())

    def test_words(self):
        ranges = {}
        for word in ("neighbours", "neighbors", "neighbours=1.3", "neighbours=1.1"):
            found = quietly(mc.free_surface, POSITIONS, estimate_smoothing_length=word).statistics
            ranges[word] = found["smoothing_length_min"], found["smoothing_length_max"]
        self.assertEqual(len(set(ranges.values())), 2)
        self.assertAlmostEqual(ranges["neighbours"][0], H, delta=0.05 * H)  # inside
        self.assertGreater(ranges["neighbours"][1], 1.2 * H)  # Lengths are larger at corners.
        self.assertLess(ranges["neighbours=1.1"][0], 0.9 * ranges["neighbours"][0])
        with self.assertRaisesRegex(mc.InvalidArgument, "The scalar is 'Speed'"):
            mc.isosurface(POSITIONS, "Speed", 1)
        for word, sentence in (("nearest", "it must be True, \"neighbours\""), ("neighbours=x", "not a number"),
                               ("neighbours=0.5", says("ETA_ILLEGAL", "0.5")), ("neighbours=0", says("ETA_ILLEGAL", "0"))):
            with self.assertRaisesRegex(mc.InvalidArgument, sentence):
                mc.free_surface(POSITIONS, estimate_smoothing_length=word)


class Runs(unittest.TestCase):
    def test_context_keeps_particles(self):
        with mc.Context() as context:
            first = sphere(context=context, particles_version=1, scalar_version=1)
            again = sphere(context=context, particles_version=1, scalar_version=1)
            self.assertEqual(first.points.tobytes(), again.points.tobytes())
            self.assertEqual(first.points.tobytes(), sphere().points.tobytes())
            context.release_memory()
        with self.assertRaises(mc.DeviceError):
            sphere(context=context)

    def test_progress(self):
        seen = []
        sphere(progress=lambda fraction, phase: seen.append((fraction, phase)))
        self.assertTrue(seen and all(0 <= fraction <= 1 and phase for fraction, phase in seen))
        for end in (False, np.bool_(False)):
            with self.assertRaises(mc.Cancelled):
                sphere(progress=lambda fraction, phase, end=end: end)
        for go_on in (True, None, 0, 1, np.bool_(True)):  # tqdm's update() returns True.
            self.assertEqual(sphere(progress=lambda fraction, phase, answer=go_on: answer), sphere())

        def fail(fraction, phase):
            raise LookupError("mine")

        with self.assertRaisesRegex(LookupError, "mine"):
            sphere(progress=fail)

    def test_callback_that_uses_its_own_context(self):
        """A callback must not use its own context, which would wait for itself; using the context is refused."""
        with mc.Context() as context:
            for use in (context.close, context.release_memory, lambda: sphere(context=context)):
                with self.assertRaisesRegex(mc.InvalidArgument, "callback"):
                    sphere(context=context, progress=lambda fraction, phase: use())
            with mc.Context() as other:
                inner = []
                sphere(context=context, progress=lambda fraction, phase: None if inner else inner.append(
                    sphere(context=other)))
            self.assertEqual(inner[0].points.tobytes(), sphere(context=context).points.tobytes())
        with self.assertRaisesRegex(mc.InvalidArgument, "callback"):
            sphere(progress=lambda fraction, phase: sphere())

    def test_interrupt(self):
        handler = signal.getsignal(signal.SIGINT)
        calls = []

        def interrupt(fraction, phase):
            calls.append(phase)
            if len(calls) == 2:
                os.kill(os.getpid(), signal.SIGINT)

        total = []
        sphere(progress=lambda fraction, phase: total.append(phase))
        with self.assertRaises(KeyboardInterrupt):
            sphere(progress=interrupt)
        self.assertLess(len(calls), len(total))  # it ended early
        self.assertIs(signal.getsignal(signal.SIGINT), handler)

    def test_interrupt_without_callback(self):
        positions = np.random.default_rng(3).random((150000, 3))
        timer = threading.Timer(0.15, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(1000):
                mc.isosurface(positions, positions[:, 0], iso=0.5, smoothing_length=0.03)

    def test_other_threads_go_on(self):
        ticks, done = [], threading.Event()

        def tick():
            while not done.wait(0.001):
                ticks.append(None)

        thread = threading.Thread(target=tick)
        positions = np.random.default_rng(3).random((100000, 3))
        mc.isosurface(positions, positions[:, 0], iso=0.5, smoothing_length=0.03)  # compiled
        thread.start()
        before = len(ticks)
        mc.isosurface(positions, positions[:, 0], iso=0.5, smoothing_length=0.03)
        during = len(ticks) - before
        done.set()
        thread.join()
        self.assertGreater(during, 5)

    def test_threads(self):
        expected = sphere().points.tobytes()
        with ThreadPoolExecutor(4) as pool:
            found = list(pool.map(lambda _: sphere().points.tobytes(), range(4)))
        self.assertEqual(found, [expected] * 4)

    def test_forked_child_is_told(self):
        sphere()
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                sphere()
            except mc.DeviceError as error:
                os.write(writer, str(error).encode())
            finally:
                os._exit(0)
        os.close(writer)
        self.assertIn(b"forked", os.read(reader, 1000))
        os.waitpid(child, 0)


if __name__ == "__main__":
    unittest.main()
