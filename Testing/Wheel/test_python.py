# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests what people meet at a prompt: signatures and help, misspelt names, repr and ==, warnings, units, data frames, DLPack, progress bars, files,
copies."""
import contextlib
import copy
import inspect
import io
import os
import pickle
import re
import subprocess
import sys
import tempfile
import typing
import unittest
import warnings
from pathlib import Path
from unittest import mock

import meshio
import numpy as np
import pandas
import pint
import pyvista
import trimesh
import unyt

import marchingcorrectors as mc
from marchingcorrectors import _options, _structs
from test_files import Case
from test_numpy import DISTANCE, H, POSITIONS, V, quietly, says, sphere

COUNT = len(POSITIONS)


def caught(function, *arguments, **words):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        function(*arguments, **words)
    return found


class Signatures(unittest.TestCase):
    def functions(self):
        sph = pyvista.PolyData(POSITIONS).sph
        return [mc.isosurface, mc.free_surface, mc.probe, mc.derivatives, mc.gauge, mc.flux, mc.project,
                mc.widening, sph.isosurface, sph.free_surface, sph.probe, sph.derivatives, sph.gauge, sph.flux, sph.project]

    def test_options_are_those_of_the_header(self):
        """Every option of the core is a keyword, except counts and options that have another form in Python."""
        numbers = {name for struct in ("mcor_options", "mcor_input") for name in _structs.KINDS[struct]}
        numbers.update(name[len("MCOR_OUT_"):].lower() for name in _structs.ENUMS["mcor_output"])
        others = {name for name in numbers if name.endswith("_count") or name in (
            "count", "outputs", "positions", "smoothing_length", "volume", "mass", "density", "scalar", "scalar_dot",
            "widening", "progress")}
        self.assertEqual(set(_options.Options.__annotations__), numbers - others,
                         "add a row to core/mcor_options.def")
        self.assertEqual(set(_options.WORDS), set(_options.Options.__annotations__))
        for name, hint in _options.Options.__annotations__.items():
            if _options.kind_of(name) in _structs.ENUMS:
                words = _options.words_of(name)
                self.assertEqual(list(typing.get_args(hint)), list(words), name)
                self.assertIn(_options.default_of(name), words, name)

    def test_every_parameter_is_shown_and_explained(self):
        for function in self.functions():
            parameters = inspect.signature(function).parameters
            self.assertGreater(len(parameters), 15, function)
            text = inspect.getdoc(function) + ("" if "isosurface()" not in inspect.getdoc(function)
                                               else inspect.getdoc(mc.isosurface))
            heads = [re.findall(r"\w+", line.split(":")[0]) for line in text.split("\n") if ":" in line]
            for name, parameter in parameters.items():
                self.assertNotEqual(parameter.kind, parameter.VAR_KEYWORD, function)
                self.assertTrue(any(name in words for words in heads), f"{function} does not explain {name}")
            self.assertNotIn("MCOR", text)
            for word in ("Example: ", "Returns "):
                self.assertIn(f"\n{word}", inspect.getdoc(function), function)
            self.assertNotIn("{options}", text)
        self.assertEqual(inspect.signature(mc.isosurface).parameters["sph_kernel"].default, "cubic")
        self.assertEqual(inspect.signature(mc.isosurface).parameters["precision"].default, "single")
        self.assertNotIn("capping", inspect.signature(mc.probe).parameters)
        self.assertNotRegex(inspect.getdoc(mc.probe), "Compact|Widening")  # the panel's words

    def test_shown_defaults_are_the_defaults(self):
        """A call with all defaults that the signature shows gives the same result as a call without them."""
        shown = {name: parameter.default for name, parameter in inspect.signature(mc.isosurface).parameters.items()
                 if name in _options.ISOSURFACE}
        again = sphere(**shown)
        self.assertEqual(again, sphere())
        self.assertEqual(again.statistics["cells_used"], sphere().statistics["cells_used"])

    def test_misspelt(self):
        sph = pyvista.PolyData(POSITIONS).sph
        for call, words, right in (
                (sphere, {"smoothing_lenght": 1}, "'smoothing_length'"), (sphere, {"kernel": "cubic"}, "'sph_kernel'"),
                (sphere, {"attribute": {}}, "'attributes'"), (sphere, {"h": 1}, "'smoothing_length'"),
                (sphere, {"spacing": 1}, r"'volume', which is spacing\*\*3"), (sphere, {"vertex_treshold": 1}, "'vertex_threshold'"),
                (sph.free_surface, {"smoothing_length": H, "fluids": 1}, "'fluid'"),
                (sph.free_surface, {"estimate_smoothing": True}, "'estimate_smoothing_length'")):
            with self.assertRaisesRegex(TypeError, rf"no option '{list(words)[-1]}'\. Did you mean {right}\?"):
                call(**words)
        with self.assertRaisesRegex(TypeError, r"probe\(\) has no option 'capping'"):
            mc.probe(POSITIONS, POSITIONS, smoothing_length=H, capping=True)
        for word in ("wendland_c2", "Wendland C2", "WENDLAND"):
            self.assertEqual(sphere(sph_kernel=word), sphere(sph_kernel="wendland"))
        for word, same in (("Wendland C4", "wendland_c4"), ("sinc_6", "sinc6"), ("quartic spline", "quartic")):
            self.assertEqual(sphere(sph_kernel=word), sphere(sph_kernel=same))
            self.assertNotEqual(sphere(sph_kernel=word), sphere())


class Objects(unittest.TestCase):
    def test_repr(self):
        surface = sphere(attributes={"a": DISTANCE, "b": POSITIONS}, weight_sum=True)
        self.assertEqual(repr(surface), f"<Surface: {len(surface.points)} points, {len(surface.triangles)} triangles; "
                         "arrays: normals; weight_sum; attributes of a, b>")
        found = mc.probe(POSITIONS, POSITIONS[:5] + 99, smoothing_length=H, attributes={"a": DISTANCE})
        self.assertRegex(repr(found), "^<Samples: 5 points, 0 of them valid; arrays: weight_sum; values of a")
        derived = mc.derivatives(POSITIONS, {"a": DISTANCE}, smoothing_length=H)
        self.assertRegex(repr(derived), rf"^<Derivatives: {COUNT} particles, \d+ of them corrected")
        for thing in (surface, found, derived, mc.Context()):
            self.assertLess(len(repr(thing)), 200)

    def test_equal(self):
        one, same, other = sphere(attributes={"a": DISTANCE}), sphere(attributes={"a": DISTANCE}), sphere()
        self.assertTrue(one == same and not one != same)
        self.assertTrue(one != other and not one == other)
        same.points[0] += 1
        self.assertFalse(one == same)
        self.assertFalse(one == "a surface")
        where = mc.probe(POSITIONS, POSITIONS, smoothing_length=H)
        self.assertEqual(where, mc.probe(POSITIONS, POSITIONS, smoothing_length=H))
        self.assertEqual(pickle.loads(pickle.dumps(one)), one)

    def test_module(self):
        self.assertLessEqual({"io", "vtkMarchingCorrectors", "isosurface"}, set(dir(mc)))
        self.assertNotIn("_functions", dir(mc))
        script = ("import sys; sys.modules['vtkmodules'] = None; import marchingcorrectors as mc\n"
                  "assert not hasattr(mc, 'vtkMarchingCorrectors')\n"
                  "try: from marchingcorrectors import vtkMarchingCorrectors\n"
                  "except ImportError as error: assert 'VTK was not found' in str(error), error\n"
                  "else: raise AssertionError")
        subprocess.run([sys.executable, "-c", script], check=True)

    def test_particles_of_files(self):
        with tempfile.TemporaryDirectory() as folder:
            data = pyvista.PolyData(POSITIONS)
            data["distance"], data["Type"] = DISTANCE, np.arange(COUNT) % 2
            data["vx"], data["vy"], data["vz"] = (POSITIONS - 0.65).T
            data.save(Path(folder) / "a.vtk")
            particles = mc.io.read(Path(folder) / "a.vtk")
            again = pickle.loads(pickle.dumps(copy.deepcopy(particles)))
        for each in (particles, again):
            np.testing.assert_array_equal(each["distance"], DISTANCE)
            self.assertEqual((list(each), "distance" in each, len(each)), (["distance", "Type", "vx", "vy", "vz", "Velocity"], True, COUNT))
            self.assertIn("distance", repr(each.arrays))
        found = mc.isosurface(again, "distance", 0.4, smoothing_length=H, volume=V, solid=np.zeros(COUNT, bool))
        np.testing.assert_allclose(found.points, sphere().points, atol=1e-6)
        joined = mc.isosurface(again, "Velocity", 0.4, smoothing_length=H, volume=V, solid=np.zeros(COUNT, bool),
                               attributes=["Velocity"])
        np.testing.assert_allclose(np.linalg.norm(joined.attributes["Velocity"], axis=1), 0.4, atol=0.03)
        with self.assertRaisesRegex(mc.InvalidArgument, says("NO_SMOOTHING_LENGTH", "", "", "Point arrays: distance, Type")):
            mc.free_surface(particles)
        told = caught(mc.free_surface, particles, smoothing_length=H, volume=V)
        self.assertIn("choose fluid=('Type', VALUE)", str(told[0].message))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            left = [mc.free_surface(particles, smoothing_length=H, volume=V, only={"Type": 1}),
                    mc.free_surface(particles, smoothing_length=H, volume=V, only={"Type": (1, 3), "distance": (0, 9)}),
                    mc.free_surface(POSITIONS[1::2].astype(particles.positions.dtype), smoothing_length=H, volume=V)]
            shown = [data.sph.free_surface(smoothing_length=H, volume=V, only={"Type": 1}),
                     data.sph.free_surface(smoothing_length=H, volume=V, only={"Type": (1, 1)}, within=(-1, 2, -1, 2, -1, 2))]
            rows = data.sph.derivatives("Velocity", smoothing_length=H, volume=V, only={"Type": 1})
            gauges = [each(((0.6, 0.6, 0.6), (0.6, 0.6, 2)), smoothing_length=H, volume=V, only={"Type": 1}).last[0]
                      for each in (data.sph.gauge, lambda *line, **words: mc.gauge(particles, *line, **words))]
        for each in left[:2] + shown:
            self.assertEqual(np.asarray(each.points).tobytes(), left[2].points.tobytes())
        for fluid in (("Type", 1), "Type=1", {"Type": 1.0}, (particles["Type"], 1)):  # The same words mean the same fluid in all functions.
            words = {"smoothing_length": H, "volume": V, "fluid": fluid}
            line, disc = ((0.6, 0.6, 0.6), (0.6, 0.6, 2)), ("disc", (0.6, 0.6, 0.6), (1, 0, 0), 0.2)
            x, solid = particles.positions, {"smoothing_length": H, "volume": V, "solid": particles["Type"] != 1}
            attributes = {"attributes": {"Type": particles["Type"]}}
            self.assertEqual(mc.free_surface(particles, **words), mc.free_surface(x, **solid))
            self.assertEqual(mc.free_surface(x, **words, **attributes), mc.free_surface(x, **solid, **attributes))
            self.assertEqual(data.sph.free_surface(**words).points.tobytes(), mc.free_surface(x, **solid).points.tobytes())
            for name, arguments in (("gauge", [line]), ("flux", [particles["Velocity"], disc]), ("project", [particles["distance"]])):
                expected = getattr(mc, name)(x, *arguments, **solid)
                self.assertEqual(getattr(mc, name)(particles, *arguments, **words), expected)
                if name != "flux":
                    self.assertEqual(getattr(data.sph, name)(*arguments, **words), expected)
            self.assertEqual(data.sph.flux(disc, particles["Velocity"], **words), mc.flux(x, particles["Velocity"], disc, **solid))
        with self.assertRaisesRegex(mc.Error, "has no array 'Typ'. Did you mean 'Type'"):
            mc.free_surface(particles, smoothing_length=H, volume=V, fluid=("Typ", 1))
        boundary = pyvista.PolyData(POSITIONS)
        boundary["IsWall"] = (np.arange(COUNT) % 2).astype(np.int32)
        found = boundary.sph.free_surface(smoothing_length=H, volume=V, fluid="auto")
        self.assertEqual(found.points.tobytes(), boundary.sph.free_surface(smoothing_length=H, volume=V, fluid="IsWall=0").points.tobytes())
        self.assertEqual((rows.n_points, len(rows["Gradients"]), gauges[0]), (COUNT, COUNT, gauges[1]))
        self.assertEqual(set(shown[0]["Type"]), {1})
        for call in (lambda **words: mc.free_surface(particles, smoothing_length=H, **words),
                     lambda **words: data.sph.free_surface(smoothing_length=H, **words)):
            with self.assertRaisesRegex(ValueError, "'Typ'.*Did you mean 'Type'.*rrays: distance, Type"):
                call(only={"Typ": 1})
        self.assertEqual(quietly(mc.gauge, again, [[[0.6, 0.6, -1], [0.6, 0.6, 2]]], smoothing_length="distance").names, ["0"])

    def test_context_is_not_copied(self):
        """A context cannot be copied: a copy would release the same device twice."""
        with mc.Context() as context:
            for make in (copy.copy, copy.deepcopy, pickle.dumps):
                with self.assertRaisesRegex(TypeError, "copied or pickled"):
                    make(context)
            self.assertEqual(sphere(context=context), sphere())


class Warned(unittest.TestCase):
    def test_nothing(self):
        self.assertEqual(caught(sphere), [])

    def test_of_the_core(self):
        for words, code in (({"iso": 99.0}, "ISO_OUTSIDE"), ({"smoothing_length": 0.5}, "NEIGHBOURS_UNUSUAL"), ({"volume": V / 1000}, "NODES_DISCARD_ALL")):
            found = caught(sphere, **words)
            self.assertEqual({w.category for w in found}, {mc.InputWarning})
            self.assertEqual(found[0].message.code, code)  # Another warning says that the surface is empty.
        with warnings.catch_warnings():
            warnings.simplefilter("error", mc.InputWarning)
            with self.assertRaises(mc.InputWarning):
                sphere(iso=99.0)
        self.assertGreater(len(sphere().triangles), 500)

    def test_calls_without_a_surface(self):
        words = {"periodic": (1.1, 0, 0), "smoothing_length": H}
        for call in (lambda: mc.probe(POSITIONS, POSITIONS[:9], **words), lambda: mc.derivatives(POSITIONS, {"x": POSITIONS[:, 0]}, **words),
                     lambda: mc.gauge(POSITIONS, [[0, 0, -9], [0, 0, 9]], **words)):
            self.assertRegex(" ".join(str(each.message) for each in caught(call)), "^" + says("PERIOD_EXCEEDED", "1.1"))

    def test_what_is_not_used(self):
        for words, sentence in (({"estimate_smoothing_length": True}, "smoothing length is not used"),
                                ({"density": 1.0, "volume": None}, says("DENSITY_WITHOUT_MASS")),
                                ({"mass": 1.0}, says("SIZE_BESIDE_VOLUME", "mass is")), ({"mass": 1.0, "density": 1.0}, says("SIZE_BESIDE_VOLUME", "mass and density")),
                                ({"cube_size": 0.1, "cube_size_factor": 1}, "cube_size_factor is not used, because cube_size is given"),
                                ({"preview": True, "tolerance": 0.1}, "tolerance is not used, because preview is given"),
                                ({"field": "weight_sum", "iso": 0.5}, 'scalar is not used, because field is "weight_sum"'),
                                ({"scalar_version": 1}, "scalar_version is not used without a context")):
            found = caught(sphere, **words)
            self.assertEqual(len(found), 1, [str(each.message) for each in found])
            self.assertRegex(str(found[0].message), sentence)
        told = caught(sphere, smoothing_length=1.0, smoothing_length_is_support_radius=True)
        self.assertEqual(told[0].message.code, "NEIGHBOURS_UNUSUAL")

    def test_at_the_callers_line(self):
        particles = pyvista.PolyData(POSITIONS)
        particles["a"] = DISTANCE
        for call in (lambda: mc.isosurface(POSITIONS, DISTANCE, 99.0, smoothing_length=H, volume=V),
                     lambda: particles.sph.isosurface("a", 99.0, smoothing_length=H, volume=V)):
            self.assertEqual([w.filename for w in caught(call)], [__file__])


class Inputs(unittest.TestCase):

    def test_data_frames(self):
        frame = pandas.DataFrame(POSITIONS, columns=list("xyz"))
        frame["distance"], frame["id"] = DISTANCE, np.arange(COUNT)
        found = mc.isosurface(frame[["x", "y", "z"]], frame["distance"], 0.4, smoothing_length=H, volume=V,
                              attributes=frame[["distance", "id"]])
        self.assertEqual(found, sphere(attributes={"distance": DISTANCE, "id": np.arange(COUNT)}))
        frame["kind"] = "é"  # With this column the table is one of objects.
        rows, fluid = frame.values, {"smoothing_length": H, "volume": V}
        found = mc.isosurface(rows[:, :3], rows[:, 3], 0.4, attributes={"distance": rows[:, 3], "kind": frame["kind"]}, **fluid)
        self.assertEqual(found, sphere(attributes={"distance": DISTANCE, "kind": np.full(COUNT, "é")}))
        self.assertEqual(set(found.to_pyvista()["kind"]), {"é"})
        with self.assertRaisesRegex(mc.InvalidArgument, r"a table of 6 columns. .*table\[\['x', 'y', 'z'\]\]"):
            mc.free_surface(frame, **fluid)
        with self.assertRaisesRegex(mc.InvalidArgument, "numbers, but object"):
            mc.isosurface(rows[:, :3], rows[:, 5], 0.4, **fluid)

    def test_dlpack(self):
        class Tensor:
            """An array that has only the two methods that DLPack requires."""

            def __init__(self, array):
                self.array = array

            def __dlpack__(self, **words):
                return self.array.__dlpack__(**words)

            def __dlpack_device__(self):
                return self.array.__dlpack_device__()

        class Elsewhere(Tensor):
            def __dlpack_device__(self):
                return (2, 0)

            def __dlpack__(self, **words):
                raise BufferError("it is on a GPU")

        found = mc.isosurface(Tensor(POSITIONS), Tensor(DISTANCE), 0.4, smoothing_length=H, volume=V)
        self.assertEqual(found, sphere())
        with self.assertRaisesRegex(mc.InvalidArgument, "scalar is not an array in"):
            mc.isosurface(POSITIONS, Elsewhere(DISTANCE), 0.4, smoothing_length=H)

    def test_units(self):
        """Arguments may mix metres and centimetres, with pint and with unyt."""
        registry = pint.UnitRegistry()
        for metre, centimetre, kilogram, gram, second in (
                (registry.m, registry.cm, registry.kg, registry.g, registry.s),
                (unyt.m, unyt.cm, unyt.kg, unyt.g, unyt.s)):
            words = {"smoothing_length": 100 * H * centimetre, "attributes": {"a": DISTANCE * second}}
            found = mc.isosurface(POSITIONS * metre, DISTANCE * metre, 40.0 * centimetre,
                                  volume=1e6 * V * centimetre ** 3, **words)
            np.testing.assert_allclose(found.points, sphere().points, atol=1e-6)
            self.assertIs(type(found.points), np.ndarray)
            found = mc.isosurface(POSITIONS * metre, DISTANCE * metre, [0.4 * metre], mass=1.0 * gram,
                                  density=1.0 * kilogram / metre ** 3, **words)
            np.testing.assert_allclose(found.points, sphere().points, atol=1e-6)
            where = mc.probe(POSITIONS * metre, 100 * POSITIONS * centimetre, volume=V * metre ** 3, **words)
            plain = mc.probe(POSITIONS, POSITIONS, volume=V, smoothing_length=H, attributes={"a": DISTANCE})
            np.testing.assert_allclose(where.values["a"], plain.values["a"], atol=1e-6)
            for wrong in ({"smoothing_length": H}, {"smoothing_length": H * second}, {"cube_size": 0.1},
                          {"iso": 0.4 * second}, {"iso": 0.4}, {"volume": V}, {"box": (0, 1) * 3},
                          {"mass": 1.0 * gram, "density": 1.0}, {"tolerance": 1e-6 * metre}):
                with self.assertRaises(mc.InvalidArgument, msg=str(wrong)):
                    mc.isosurface(POSITIONS * metre, DISTANCE * metre, **{"iso": 0.4 * metre, **words, **wrong})
            with self.assertRaisesRegex(mc.InvalidArgument, "length has the unit .* positions has none"):
                sphere(smoothing_length=H * metre)
            with self.assertRaisesRegex(mc.InvalidArgument, "iso value"):
                sphere(iso=0.4 * metre)
        with self.assertRaisesRegex(mc.InvalidArgument, "cannot be converted"):
            mc.free_surface(POSITIONS * unyt.m, smoothing_length=H * registry.m)

    def test_period_of_three_lengths(self):
        words = {"smoothing_length": H, "volume": V}
        x = POSITIONS - POSITIONS.min(axis=0)
        self.assertEqual(mc.free_surface(x, periodic=(1.4, 1.4, 0), **words),
                         mc.free_surface(x, periodic=(0, 1.4, 0, 1.4, 0, 0), **words))
        with self.assertRaisesRegex(mc.InvalidArgument, "three lengths, 0 along"):
            mc.free_surface(x, periodic=(1, 2), **words)
        tilted = pyvista.PolyData(x)
        tilted.field_data["PeriodicBounds"] = [1.4, 0, 0, 0.5, 1.4, 0, 0, 0, 1.4]
        for period, error in (("auto", says("CELL_TILTED")), ("all", 'it must be "auto"')):
            with self.assertRaisesRegex(mc.InvalidArgument, error):
                tilted.sph.free_surface(periodic=period, **words)
        with self.assertWarnsRegex(mc.InputWarning, says("CELL_TILTED")):
            tilted.sph.free_surface(**words)


class Bars(unittest.TestCase):
    def test_tqdm(self):
        screen = io.StringIO()
        with contextlib.redirect_stderr(screen):
            found = sphere(progress=True)
        self.assertEqual(found, sphere())
        self.assertRegex(screen.getvalue(), r"output: 100%")

    def test_of_the_caller(self):
        from tqdm import tqdm

        with tqdm(total=1.0, file=io.StringIO(), mininterval=0) as bar:
            found = sphere(progress=lambda fraction, phase: bar.update(fraction - bar.n))
            self.assertAlmostEqual(bar.n, 1.0)
        self.assertEqual(found, sphere())

    def test_without_tqdm(self):
        script = ("import sys; sys.modules['tqdm'] = None; import test_numpy; test_numpy.sphere(progress=True)")
        done = subprocess.run([sys.executable, "-c", script], stderr=subprocess.PIPE, text=True,
                              cwd=Path(__file__).parent)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"(?s)^ +\d+ % \w.*\n +\d+ % output *\n$")

    def test_what_is_no_callback(self):
        self.assertEqual(sphere(progress=False), sphere())
        with self.assertRaisesRegex(mc.InvalidArgument, "progress is 'yes'; it must be True"):
            sphere(progress="yes")


class Files(Case):
    def setUp(self):
        super().setUp()
        self.surface = sphere(weight_sum=True, attributes={"speed": DISTANCE, "where": POSITIONS,
                                                           "id": np.arange(COUNT)})

    def save(self, name, surface=None):
        path = self.at(name)
        found = caught((surface or self.surface).save, path)
        return path, [str(w.message) for w in found]

    def test_npz(self):
        path, _ = self.save("a.npz")
        with np.load(path) as arrays:
            self.assertEqual(arrays["points"].tobytes(), self.surface.points.tobytes())
            self.assertEqual(arrays["attributes/id"].tolist(), self.surface.attributes["id"].tolist())

    def test_home(self):
        with mock.patch.dict(os.environ, HOME=str(self.folder), USERPROFILE=str(self.folder)):
            for name in ("a.vtp", "a.npz"):
                self.surface.save(f"~/{name}")
                self.assertTrue(self.at(name).exists())

    def test_share(self):
        """A file system that does not tell its size is not taken for a full one."""
        with mock.patch("shutil.disk_usage", return_value=(0, 0, 0)):
            self.assertEqual(self.save("a.vtp")[1], [])

    def test_meshes(self):
        for name in ("a.vtp", "a.vtk", "a.vtu", "a.xdmf"):
            path, sentences = self.save(name)
            mesh = meshio.read(path) if name == "a.xdmf" else pyvista.read(path)
            points = mesh.points
            np.testing.assert_allclose(points, self.surface.points, atol=1e-6, err_msg=name)
            corners = mesh.cells_dict["triangle"] if name == "a.xdmf" else \
                mesh.cells_dict[5] if name == "a.vtu" else mesh.faces.reshape(-1, 4)[:, 1:]
            self.assertEqual(corners.tolist(), self.surface.triangles.tolist(), name)
            data = mesh.point_data
            np.testing.assert_allclose(data["speed"], self.surface.attributes["speed"], err_msg=name)
            np.testing.assert_allclose(data["where"], self.surface.attributes["where"], err_msg=name)
            self.assertEqual(sentences, [])

    def test_ply_holds_all(self):
        path, _ = self.save("a.ply")
        mesh = meshio.read(path)
        self.assertEqual(mesh.points.tobytes(), self.surface.points.tobytes())
        self.assertEqual(mesh.cells_dict["triangle"].tolist(), self.surface.triangles.tolist())
        np.testing.assert_array_equal(mesh.point_data["speed"], self.surface.attributes["speed"])
        np.testing.assert_array_equal(mesh.point_data["where_y"], self.surface.attributes["where"][:, 1])
        np.testing.assert_array_equal(mesh.point_data["id"], self.surface.attributes["id"])
        np.testing.assert_array_equal(mesh.point_data["nz"], self.surface.normals[:, 2])
        loaded = trimesh.load(path, process=False)
        self.assertEqual(len(loaded.faces), len(self.surface.triangles))

    def test_formats_without_arrays(self):
        empty = quietly(sphere, iso=99.0)
        for name in ("a.stl", "a.obj", "a.off"):
            with self.assertRaisesRegex(mc.InvalidArgument, rf"{name} was not written"):
                self.save(name, empty)
        for name in ("a.stl", "a.obj"):
            path, sentences = self.save(name)
            self.assertRegex("".join(sentences), r"no arrays: WeightSum, id, speed, where")
            self.assertEqual(len(trimesh.load(path).faces), len(self.surface.triangles))
            self.assertEqual(self.save(name, sphere())[1], [])
        for name, sentence in (("a", "no ending"), ("a.dae", "a.dae was not written, because no format of that ending")):
            with self.assertRaisesRegex(mc.InvalidArgument, sentence):
                self.surface.save(self.at(name))

    def test_other_libraries(self):
        mesh = self.surface.to_trimesh()
        self.assertEqual(mesh.faces.tolist(), self.surface.triangles.tolist())
        self.assertEqual(mesh.vertices.tolist(), self.surface.points.tolist())
        np.testing.assert_allclose(mesh.vertex_attributes["speed"], self.surface.attributes["speed"])
        self.assertTrue(mc.free_surface(POSITIONS, smoothing_length=H).to_trimesh().is_watertight)
        mesh = self.surface.to_meshio()
        self.assertEqual(mesh.cells_dict["triangle"].tolist(), self.surface.triangles.tolist())
        np.testing.assert_array_equal(mesh.point_data["WeightSum"], self.surface.weight_sum)

    def test_empty(self):
        words = {"attributes": {"a": DISTANCE, "v": POSITIONS, "id": np.arange(COUNT)}, "point_keys": True,
                 "triangle_keys": True}
        empty, full = quietly(sphere, iso=99.0, **words), sphere(**words)
        mesh = empty.to_pyvista()
        self.assertEqual((mesh.n_points, mesh.n_cells), (0, 0))
        self.assertEqual(sorted(mesh.point_data.keys()), sorted(full.to_pyvista().point_data.keys()))
        self.assertEqual(mesh.GetPointData().GetArray("v").GetNumberOfComponents(), 3)
        self.assertEqual(full.to_pyvista().cell_data["TriangleKeys"].shape, (full.triangles.shape[0], 2))
        self.assertEqual(len(empty.to_trimesh().faces), 0)
        self.assertEqual(len(empty.to_meshio().points), 0)
        for name in ("a.npz", "a.ply", "a.vtp"):
            path, _ = self.save(name, empty)
            if name != "a.npz":
                self.assertEqual(pyvista.read(path).n_cells, 0)


if __name__ == "__main__":
    unittest.main()
