# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the extension in Blender itself (bpy): the zip is installed; a series is imported, saved, opened and rendered."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HOLDER = tempfile.TemporaryDirectory()
os.environ["BLENDER_USER_RESOURCES"] = HOLDER.name  # The settings of the person who runs the test stay untouched.

import bpy
import mathutils
import numpy as np
import pyvista

import marchingcorrectors as mc

FOLDER = Path(HOLDER.name)
SOURCES = Path(os.environ["MCOR_TEST_SOURCES"])
WHEEL, = (Path.cwd() / "dist").glob("*.whl")  # in_environment.py starts tests beside the folder of the wheel.
VELOCITY = 5.0  # along x


def setUpModule():
    unittest.addModuleCleanup(HOLDER.cleanup)
    side = np.arange(-0.75, 0.8, 0.1)
    ball = np.stack(np.meshgrid(side, side, side), -1).reshape(-1, 3)
    ball = ball[np.linalg.norm(ball, axis=1) < 0.8]
    for i in range(12):  # step_10 comes after step_9.
        alone = np.array([[3.0 + VELOCITY * i / 24, 0, 0]]) if i == 7 else np.empty((0, 3))
        data = pyvista.PolyData(np.concatenate([ball * (1 + 0.02 * i) + [VELOCITY * i / 24, 0, 0], alone]).astype("f4"))
        data["Speed"] = np.full(data.n_points, VELOCITY, "f4")
        data["vel"] = np.tile(np.float32([VELOCITY, 0, 0]), (data.n_points, 1))
        data["h"] = np.full(data.n_points, 0.13, "f4")
        data.field_data["TimeValue"] = [i / 24]
        data.save(FOLDER / f"step_{i}.vtp")
    subprocess.run([sys.executable, SOURCES / "Examples" / "Blender" / "build.py", WHEEL, FOLDER / "sph.zip"], check=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(filepath=str(FOLDER / "sph.zip"), repo="user_default", enable_on_install=True,
                                             overwrite=True)


def numbers(mesh, name, components=0):
    attribute = mesh.attributes[name]
    values = np.empty(len(attribute.data) * max(components, 1), "f4")
    attribute.data.foreach_get("vector" if components else "value", values)
    return values.reshape(-1, components) if components else values


class Blender(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.preferences.addon_enable(module="bl_ext.user_default.sph_surfaces")
        self.scene = bpy.context.scene
        self.scene.render.fps = 24
        self.scene.frame_set(1)

    def import_steps(self, count=12, **words):
        names = [{"name": f"step_{i}.vtp"} for i in reversed(range(count))]
        self.assertEqual(bpy.ops.import_scene.sph_particles(directory=str(FOLDER), files=names, **words), {"FINISHED"})
        return bpy.context.object

    def surface_of(self, i, **words):
        particles = mc.io.read(FOLDER / f"step_{i}.vtp")
        return mc.free_surface(particles, smooth=True, attributes=["vel"], **words)

    def test_frames(self):
        """The mesh of a frame equals the surface that the package makes of the same step, with its normals and
        velocities."""
        thing = self.import_steps()
        for frame in (1, 3, 11, 12, 40):
            self.scene.frame_set(frame)
            expected, mesh = self.surface_of(min(frame - 1, 11)), thing.data
            np.testing.assert_array_equal(numbers(mesh, "position", 3), expected.points.astype("f4"))
            corners = np.empty(len(mesh.loops), np.int32)
            mesh.loops.foreach_get("vertex_index", corners)
            np.testing.assert_array_equal(corners.reshape(-1, 3), expected.triangles)
            np.testing.assert_allclose(numbers(mesh, "velocity", 3), expected.attributes["vel"], atol=1e-6)
            normals = np.empty((len(mesh.loops), 3), "f4")
            mesh.corner_normals.foreach_get("vector", normals.ravel())
            self.assertLess(np.abs(normals - expected.normals[corners]).max(), 2e-3)

    def test_speed(self):
        """In slow motion each step lasts for several frames, and velocities are per second of the scene."""
        thing = self.import_steps(speed=0.5)
        self.scene.frame_set(5)
        np.testing.assert_array_equal(numbers(thing.data, "position", 3), self.surface_of(2).points.astype("f4"))
        self.assertAlmostEqual(numbers(thing.data, "velocity", 3)[0, 0], VELOCITY / 2, places=4)
        thing.sph.first_frame = 5
        np.testing.assert_array_equal(numbers(thing.data, "position", 3), self.surface_of(0).points.astype("f4"))

    def test_once(self):
        """The mesh of a frame is computed once. A changed setting computes it anew."""
        thing = self.import_steps(3)
        before = thing.data.vertices[0].co.copy()
        thing.data.vertices[0].co.x += 1
        self.scene.frame_set(1)
        self.assertNotEqual(thing.data.vertices[0].co, before)
        thing.sph.arrays["Speed"].keep = True
        self.assertEqual(thing.data.vertices[0].co, before)
        np.testing.assert_allclose(numbers(thing.data, "Speed"), VELOCITY, rtol=1e-6)

    def test_pieces(self):
        thing = self.import_steps(8)
        self.scene.frame_set(8)
        count = len(thing.data.vertices)
        thing.sph.least_particles = 8
        self.assertLess(len(thing.data.vertices), count)
        self.assertLess(max(vertex.co.x for vertex in thing.data.vertices), 3)

    def test_saved(self):
        thing = self.import_steps()
        self.scene.frame_set(4)
        count = len(thing.data.vertices)
        bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "a.blend"))
        bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "a.blend"))
        thing, = (each for each in bpy.data.objects if each.type == "MESH")
        self.assertEqual(len(thing.data.vertices), count)
        bpy.context.scene.frame_set(6)
        np.testing.assert_array_equal(numbers(thing.data, "position", 3), self.surface_of(5).points.astype("f4"))

    def test_errors(self):
        """An import that fails reports an error. If a later change of a setting causes an error, the panel shows its message."""
        with self.assertRaisesRegex(RuntimeError, "no file"):
            bpy.ops.import_scene.sph_particles(filepath=str(FOLDER / "none.vtp"))
        thing = self.import_steps(3)
        thing.sph.fluid = "Speed=1"
        self.assertIn("fluid", thing.sph.message)
        self.assertEqual(len(thing.data.vertices), 0)
        thing.sph.fluid = ""
        self.assertEqual(thing.sph.message, "")

    def test_usd(self):
        """The exported USD film has the same meshes as the frames, at the scene's frame rate."""
        from pxr import Usd, UsdGeom

        thing = self.import_steps(4, speed=0.5)
        self.assertEqual(bpy.ops.export_scene.sph_usd(filepath=str(FOLDER / "film.usdc")), {"FINISHED"})
        stage = Usd.Stage.Open(str(FOLDER / "film.usdc"))
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/film/surface"))
        self.assertEqual(mesh.GetPointsAttr().GetTimeSamples(), [0, 2, 4, 6])
        self.scene.frame_set(5)
        np.testing.assert_array_equal(np.array(mesh.GetPointsAttr().Get(4)), numbers(thing.data, "position", 3))
        np.testing.assert_allclose(np.array(mesh.GetVelocitiesAttr().Get(4)), numbers(thing.data, "velocity", 3), rtol=1e-6)

    def test_rendered(self):
        """Motion blur smears the ball along its velocity."""
        self.import_steps()
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        camera.location = (0.8, -6, 0)
        camera.rotation_euler = (mathutils.Vector((0.8, 0, 0)) - camera.location).to_track_quat("-Z", "Y").to_euler()
        world = bpy.data.worlds.new("world")
        world.color = (1, 1, 1)
        self.scene.collection.objects.link(camera)
        self.scene.camera, self.scene.world = camera, world
        render = self.scene.render
        render.engine, self.scene.cycles.samples, self.scene.cycles.device = "CYCLES", 16, "CPU"
        render.resolution_x, render.resolution_y, render.film_transparent = 160, 90, True
        render.motion_blur_shutter = 0.9
        for frame in (3, 6):
            alpha = {}
            for blur in (False, True):
                self.scene.frame_set(frame)
                render.use_motion_blur = blur
                render.filepath = str(FOLDER / "frame.png")
                bpy.ops.render.render(write_still=True)
                image = bpy.data.images.load(render.filepath, check_existing=False)
                alpha[blur] = np.array(image.pixels[:]).reshape(90, 160, 4)[..., 3]
            width = {blur: (a[45] > 0.05).sum() for blur, a in alpha.items()}
            height = {blur: (a > 0.05).any(axis=1).sum() for blur, a in alpha.items()}
            self.assertGreater(width[True], width[False] + 3)
            self.assertLessEqual(abs(int(height[True]) - int(height[False])), 1)


if __name__ == "__main__":
    unittest.main()
