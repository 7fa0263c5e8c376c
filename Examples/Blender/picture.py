# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Renders a splash with Cycles, without and with motion blur: OUT/splash.png, OUT/splash_blurred.png.

    python picture.py EXTENSION.zip OUT      in an environment with bpy (Blender as a module), NumPy and VTK
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import mathutils

zip_file, out = (os.path.abspath(name) for name in sys.argv[1:])
maker = Path(__file__).resolve().parents[1] / "Data" / "make_particles.py"
folder = tempfile.TemporaryDirectory()
subprocess.run([sys.executable, maker, "splash", "40000", f"{folder.name}/splash_%04d.vtp", "--steps", "8"], check=True)

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default", enable_on_install=True, overwrite=True)
scene = bpy.context.scene
scene.render.fps = 50  # the steps are 0.02 s apart
scene.frame_set(1)
bpy.ops.import_scene.sph_particles(directory=folder.name, files=[{"name": f"splash_{i:04d}.vtp"} for i in range(8)])
water = bpy.context.object

material = bpy.data.materials.new("water")
material.use_nodes = True
values = material.node_tree.nodes["Principled BSDF"].inputs
values["Base Color"].default_value = (0.03, 0.22, 0.42, 1)
values["Roughness"].default_value = 0.08
water.data.materials.append(material)

world = scene.world = bpy.data.worlds.new("sky")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.75, 0.85, 1, 1)
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy, sun.rotation_euler = 3, (0.7, 0.1, 0.5)
camera = scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location = (0.15, -1.55, 0.75)
camera.rotation_euler = (mathutils.Vector((0, 0, 0.04)) - camera.location).to_track_quat("-Z", "Y").to_euler()
for thing in (sun, camera):
    scene.collection.objects.link(thing)

scene.frame_set(7)
scene.render.engine = "CYCLES"
scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 64, False
scene.render.resolution_x, scene.render.resolution_y = 640, 360
scene.render.motion_blur_shutter = 1
for blurs, name in ((False, "splash.png"), (True, "splash_blurred.png")):
    scene.render.use_motion_blur = blurs
    scene.render.filepath = os.path.join(out, name)
    bpy.ops.render.render(write_still=True)
