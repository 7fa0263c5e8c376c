# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Shows SPH particles as a live surface in Blender: an object whose mesh is made for the shown step when the frame
changes."""
import json
import math
import os
import warnings

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ExportHelper, ImportHelper

from . import series

ENDINGS = ";".join("*" + ending for ending in series.ENDINGS)


# ---- The surface of a frame ----

def to_time(settings, scene, frame):
    """Returns the simulation's time at a frame of the scene."""
    rate = scene.render.fps / scene.render.fps_base
    return settings.steps[0].time + (frame - settings.first_frame) / rate * settings.speed


def find_step(settings, scene, frame):
    """Returns the last step that is not later than the frame's time; if all steps are later, the first one."""
    time, found = to_time(settings, scene, frame), settings.steps[0]
    margin = 1e-4 * settings.speed * scene.render.fps_base / scene.render.fps  # Times in files may have few digits.
    for step in settings.steps:
        if step.time > time + margin:
            break
        found = step
    return found


def words_of(settings):
    """Returns the settings that the mesh depends on, besides the step, as keyword arguments of series.make_surface()."""
    return {"smoothing_length": settings.smoothing_length, "fluid": settings.fluid, "scalar": settings.scalar, "iso": settings.iso,
            "smooth": settings.smooth, "cube_size_factor": round(settings.cube_factor, 6), "least_particles": settings.least_particles,
            "arrays": [each.name for each in settings.arrays if each.keep]}


def refresh(thing, scene):
    """Makes the mesh of the step at the scene's frame, unless the object has it already. Returns the error or the warnings as text, or ""."""
    settings = thing.sph
    if not len(settings.steps):
        return ""
    step, words = find_step(settings, scene, scene.frame_current), words_of(settings)
    path = bpy.path.abspath(step.path)
    key = json.dumps([path, step.number, settings.speed, words])
    if settings.shown == key:
        return settings.message
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            surface = series.make_surface(path, step.number, **words)
        settings.message = " ".join(str(each.message) for each in told)
    except (series.Error, OSError) as error:
        surface, settings.message = None, str(error)
        print(f"{thing.name}: {error}")  # In the background no panel shows the sentence.
    fill_mesh(thing.data, surface, settings.speed)
    settings.shown = key
    return settings.message


def fill_mesh(mesh, surface, speed):
    """Replaces the points, faces and attributes, but keeps the materials. speed: seconds of the simulation in a second of the scene."""
    mesh.clear_geometry()
    if surface is None or not len(surface.points):
        mesh.update()
        return
    mesh.vertices.add(len(surface.points))
    mesh.attributes["position"].data.foreach_set("vector", surface.points.astype("f4").ravel())
    if surface.lines:  # These particles lie in a plane.
        edges = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in surface.lines])
        mesh.edges.add(len(edges))
        mesh.edges.foreach_set("vertices", edges.ravel())
    triangles = surface.triangles
    mesh.loops.add(3 * len(triangles))
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(triangles), 3, dtype=np.int32))
    mesh.update(calc_edges=not surface.lines)
    if surface.normals is not None and len(triangles):
        mesh.normals_split_custom_set_from_vertices(surface.normals)
    velocity = series.find_velocity(surface.attributes)
    for name, values in surface.attributes.items():
        if name == velocity:  # Cycles blurs by the attribute "velocity" per second of the scene, which lasts `speed` seconds of the simulation.
            name, values = "velocity", values * speed
        is_vector = values.ndim == 2
        attribute = mesh.attributes.new(name, "FLOAT_VECTOR" if is_vector else "FLOAT", "POINT")
        attribute.data.foreach_set("vector" if is_vector else "value", values.astype("f4").ravel())


@persistent
def follow_frame(scene, *_):
    for thing in scene.objects:
        if thing.type == "MESH" and len(thing.sph.steps):
            refresh(thing, scene)


# ---- Properties ----

def changed(settings, context):
    refresh(settings.id_data, context.scene)


class Step(bpy.types.PropertyGroup):
    path: StringProperty(subtype="FILE_PATH")
    number: IntProperty(description="Which of the file's steps")
    time: FloatProperty(description="Time in the simulation")


class Array(bpy.types.PropertyGroup):
    keep: BoolProperty(name="Keep", description="Carry this array to the surface, as an attribute of its points",
                       update=lambda self, context: changed(self.id_data.sph, context))


def shared(**more):
    """Returns the properties that an object and the dialog of its import have in common."""
    return {
        "smoothing_length": StringProperty(
            name="Smoothing Length", **more, description="An array's name, a length, 'estimate' (from the particle spacing) or "
            "'neighbours' (for each particle). Empty: the file's own"),
        "fluid": StringProperty(name="Fluid", **more, description="ARRAY=VALUE: particles with this value are fluid, others are walls. "
                                "Empty: as the file tells"),
        "scalar": StringProperty(name="Scalar", **more, description="The array to contour. Empty: the free surface"),
        "iso": FloatProperty(name="Iso Value", default=0.5, **more,
                             description="Value of the scalar on the surface; of the free surface, 0.5 is usual"),
        "smooth": BoolProperty(name="Smooth", default=True, **more,
                               description="A smooth surface of well-shaped triangles, for pictures"),
        "cube_factor": FloatProperty(name="Cube Factor", default=0.5, min=0.05, soft_max=1, **more, description="Size of the triangles: "
                                     "the edge of a cube by the smallest smoothing length"),
        "least_particles": IntProperty(name="Least Particles", min=0, **more,
                                       description="Pieces around fewer particles are left out; 0: none"),
        "speed": FloatProperty(name="Speed", default=1, min=1e-6, soft_max=10, **more,
                               description="Seconds of the simulation in a second of the scene; below 1: slow motion")}


class Settings(bpy.types.PropertyGroup):
    steps: CollectionProperty(type=Step)
    arrays: CollectionProperty(type=Array)
    shown: StringProperty(options={"HIDDEN"})  # This says what the mesh was made of.
    message: StringProperty(options={"HIDDEN"})
    first_frame: IntProperty(name="First Frame", default=1, update=changed, description="The frame at which the first step is shown")
    __annotations__.update(shared(update=changed))


# ---- Operators ----

class ImportParticles(bpy.types.Operator, ImportHelper):
    """Import particles of SPH as an object whose mesh follows the frame; several files are the steps of a film"""
    bl_idname, bl_label, bl_options = "import_scene.sph_particles", "Import SPH Particles", {"REGISTER", "UNDO"}
    filter_glob: StringProperty(default=ENDINGS, options={"HIDDEN"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    time_step: FloatProperty(name="Time Step", min=0, description="Seconds between the steps of files that tell no times; 0: one step a frame")
    up: EnumProperty(name="Up", items=(("AUTO", "By File", "Y is up for SPlisHSPlasH's .bgeo, Z for all others"),
                                       ("Z", "Z", "Z is up"), ("Y", "Y", "Y is up")))
    __annotations__.update(shared())

    def execute(self, context):
        names = [os.path.join(self.directory, each.name) for each in self.files if each.name] or [self.filepath]
        scene = context.scene
        try:
            steps = series.list_steps(names, self.time_step or scene.render.fps_base / scene.render.fps)
            first = series.read(steps[0].path, step=steps[0].number)
        except (series.Error, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        thing = bpy.data.objects.new(bpy.path.display_name_from_filepath(names[0]), bpy.data.meshes.new("SPH Surface"))
        if (first.up.upper() if self.up == "AUTO" else self.up) == "Y":
            thing.rotation_euler.x = math.pi / 2
        settings = thing.sph
        for name in shared():
            setattr(settings, name, getattr(self, name))
        settings.first_frame = scene.frame_current
        if not self.smoothing_length and first.smoothing_length is None:
            settings.smoothing_length = "estimate"
            self.report({"INFO"}, "The files tell no smoothing length: one is estimated from the particle spacing")
        names = series.list_arrays(first)
        kept = series.find_velocity({name: first[name] for name in names})
        for name in names:
            array = settings.arrays.add()
            array.name, array.keep = name, name == kept
        for each in steps:  # This comes last: without steps, changed settings make no surface.
            step = settings.steps.add()
            step.path, step.number, step.time = str(each.path), each.number, each.time
        context.collection.objects.link(thing)
        for each in context.selected_objects:
            each.select_set(False)
        thing.select_set(True)
        context.view_layer.objects.active = thing
        message = refresh(thing, scene)
        if message:
            self.report({"WARNING"}, message)
        return {"FINISHED"}


class WriteUsd(bpy.types.Operator, ExportHelper):
    """Write the steps of this object as one file of USD, with their velocities, for Houdini, Omniverse and others"""
    bl_idname, bl_label = "export_scene.sph_usd", "Write USD"
    filename_ext = ".usdc"
    filter_glob: StringProperty(default="*.usdc;*.usda;*.usd", options={"HIDDEN"})

    @classmethod
    def poll(cls, context):
        return context.object is not None and len(context.object.sph.steps) > 0

    def execute(self, context):
        thing, render = context.object, context.scene.render
        settings = thing.sph
        steps = [series.Step(bpy.path.abspath(step.path), step.number, step.time) for step in settings.steps]
        try:
            series.write_usd(self.filepath, steps, render.fps / render.fps_base, settings.speed, "y" if thing.rotation_euler.x else "z",
                             words_of(settings))
        except (series.Error, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class Panel(bpy.types.Panel):
    bl_idname, bl_label = "OBJECT_PT_sph_surface", "SPH Surface"
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "object"

    @classmethod
    def poll(cls, context):
        return context.object is not None and len(context.object.sph.steps) > 0

    def draw(self, context):
        layout, settings = self.layout, context.object.sph
        layout.use_property_split = True
        if settings.message:
            for line in range(0, len(settings.message), 60):
                layout.label(text=settings.message[line:line + 60], icon="NONE" if line else "ERROR")
        for name in ("smoothing_length", "fluid", "scalar", "iso", "smooth", "cube_factor", "least_particles"):
            layout.prop(settings, name)
        column = layout.column(heading="Arrays")
        for each in settings.arrays:
            column.prop(each, "keep", text=each.name)
        layout.prop(settings, "first_frame")
        layout.prop(settings, "speed")
        step = find_step(settings, context.scene, context.scene.frame_current)
        layout.label(text=f"{len(settings.steps)} steps; {os.path.basename(step.path)} at {step.time:g} s")
        layout.operator(WriteUsd.bl_idname)


class DropParticles(bpy.types.FileHandler):
    bl_idname, bl_label = "SPH_FH_particles", "SPH Particles"
    bl_import_operator, bl_file_extensions = ImportParticles.bl_idname, ";".join(series.ENDINGS)

    @classmethod
    def poll_drop(cls, context):
        return context.area is not None and context.area.type == "VIEW_3D"


CLASSES = (Step, Array, Settings, ImportParticles, WriteUsd, Panel, DropParticles)


def show_in_menu(menu, _):
    menu.layout.operator(ImportParticles.bl_idname, text="SPH Particles (.vtk, .vtp, .bgeo, .hdf5, ...)")


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Object.sph = bpy.props.PointerProperty(type=Settings)
    bpy.types.TOPBAR_MT_file_import.append(show_in_menu)
    bpy.app.handlers.frame_change_pre.append(follow_frame)


def unregister():
    bpy.app.handlers.frame_change_pre.remove(follow_frame)
    bpy.types.TOPBAR_MT_file_import.remove(show_in_menu)
    del bpy.types.Object.sph
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
    series.end()
