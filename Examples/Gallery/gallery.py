#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws README.md's picture of the dam break, the paper's figures with the data of this project, and adaptive cubes.

gallery.py DIRECTORY [NAME...]     (without a display: Testing/with-display.sh python3 gallery.py ...)

Names are those of the files without .png, which are listed at the end of this script; all of them if none is given.
PYTHONPATH must name the directory of the package marchingcorrectors. README.md beside this file shows the figures.
"""
import os
import sys

import numpy as np
import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersCore import vtkThreshold
from vtkmodules.vtkFiltersSources import vtkOutlineSource
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkDataSetMapper, vtkLightKit, vtkRenderer, vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHDerivatives

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Data")
sys.path.insert(0, DATA)
from make_particles import poly_data  # noqa: E402

RED, YELLOW, GREEN = (0.85, 0.15, 0.1), (0.95, 0.8, 0.15), (0.2, 0.65, 0.25)
WATER, ORANGE, LINE, WHITE = (0.45, 0.68, 0.9), (0.90, 0.45, 0.20), (0.1, 0.2, 0.5), (1, 1, 1)
# A camera has a position, a focus and an angle. TANK: the cameras that show the whole tank, by the number of panels in a row.
TANK = {n: ((-0.1, 2.4, 4.1), (1.62, 0.42, 0.0), angle) for n, angle in ((1, 27), (2, 38), (3, 52))}
NEAR = (1.2, 1.1, 1.7), (2.75, 0.3, -0.1), 26  # This camera looks at the water behind the obstacle.
EDGE = (0.3, 0.75, 0.4), (0.82, 0.44, 0.12), 22
README = (-0.35, 2.5, 4.4), (1.565, 0.45, 0.0), 31


def read():
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(os.path.join(DATA, "dam_break_45k.vtp"))
    reader.Update()
    return reader


def water(filter_, reader, array=None):
    """Returns the filter, set up for the fluid particles of the dam break and, if given, for the array."""
    filter_.SetInputConnection(reader.GetOutputPort())
    filter_.SetFluidArrayName("ParticleType")
    filter_.SetFluidValue(0)
    if array:
        filter_.SetInputArrayToProcess(0, 0, 0, 0, array)
    return filter_


def surface(reader, array=None, value=0, **properties):
    """With these properties, extracts an isosurface of the array or, without an array, the free surface. Returns the filter."""
    extract = water(vtkMarchingCorrectors(), reader, array)
    extract.SetFreeSurface(not array)
    if array:
        extract.SetValue(0, value)
    for name, given in properties.items():
        getattr(extract, "Set" + name)(given)
    extract.Update()
    if extract.GetOutput().GetNumberOfCells() == 0:
        sys.exit(extract.GetErrorMessage() or "the surface is empty")
    return extract


def actor_of(source, color, opacity=1.0, specular=0.25, power=30):
    mapper, actor = vtkDataSetMapper(), vtkActor()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*color)
    look.SetOpacity(opacity)
    look.SetSpecular(specular)
    look.SetSpecularPower(power)
    return actor


def colored(actor, array, table):
    mapper = actor.GetMapper()
    mapper.ScalarVisibilityOn()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(array)
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    return actor


def panel(actors, text, place, size, camera, up):
    """Makes a part of the window: the actors on white, and the text in letters of this size at this place, in pixels."""
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    caption = vtkTextActor()
    caption.SetInput(text)
    caption.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    caption.GetTextProperty().SetFontSize(size)
    caption.SetPosition(*place)
    for prop in (*actors, caption):
        renderer.AddViewProp(prop)
    position, focus, angle = camera
    view = renderer.GetActiveCamera()
    view.SetPosition(*position)
    view.SetFocalPoint(*focus)
    view.SetViewUp(*up)
    view.SetViewAngle(angle)
    renderer.ResetCameraClippingRange()
    return renderer


def in_tank(reader, panels, camera, place=(12, 370), size=18):
    """Makes panels, given as (text, actors...), each with the outline of the particles' bounds."""
    outline = vtkOutlineSource()
    outline.SetBounds(reader.GetOutput().GetBounds())
    renderers = []
    for text, *actors in panels:
        box = actor_of(outline, (0.6, 0.6, 0.6))
        box.GetProperty().LightingOff()
        renderers.append(panel([box, *actors], text, place, size, camera, (0, 1, 0)))
        vtkLightKit().AddLightsToRenderer(renderers[-1])
    return renderers


def save(renderers, size, path):
    window, image, writer = vtkRenderWindow(), vtkWindowToImageFilter(), vtkPNGWriter()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
    for i, renderer in enumerate(renderers):
        renderer.SetViewport(i / len(renderers), 0, (i + 1) / len(renderers), 1)
        renderer.UseFXAAOn()
        window.AddRenderer(renderer)
    window.Render()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer.SetFileName(path)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    print(path)


def speed_colors():
    """Returns a table of colours by speed: from dark blue at rest over light blue to white from 2.5 m/s on."""
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    table.SetTableRange(0.0, 2.5)
    table.SetVectorModeToMagnitude()
    at = np.linspace(0, 1, 256)
    for i, color in enumerate(zip(*(np.interp(at, (0, 0.45, 1), stops)
                                    for stops in ((0.05, 0.15, 0.95), (0.18, 0.55, 0.98), (0.45, 0.80, 1.0))))):
        table.SetTableValue(i, *color, 1.0)
    return table


def dam_break():
    reader, fluid = read(), vtkThreshold()
    fluid.SetInputConnection(reader.GetOutputPort())
    fluid.SetInputArrayToProcess(0, 0, 0, 0, "ParticleType")
    fluid.SetLowerThreshold(0)
    fluid.SetUpperThreshold(0)
    particles = colored(actor_of(fluid, WHITE, specular=0), "Velocity", speed_colors())
    particles.GetProperty().SetRepresentationToPoints()
    particles.GetProperty().SetPointSize(4)
    particles.GetProperty().RenderPointsAsSpheresOn()
    free, iso = surface(reader, Smooth=1), surface(reader, "Velocity", 1.0)
    whole, faint = (colored(actor_of(free, WHITE, opacity, 0.35, 40), "Velocity", speed_colors()) for opacity in (1.0, 0.2))
    return in_tank(reader, [
        ("particles", particles), ("free surface, smooth", whole),
        ("isosurface of the speed, 1 m/s", actor_of(iso, ORANGE, specular=0.3), faint)], README, (24, 474), 28), (1950, 520)


# Each panel has a text and surfaces. A surface is a tuple: array (None: the free surface), iso value, colour, opacity, factor of h.
FIGURES = {
    "figure_1": (TANK[1], [("pressure 500, 1500, 3000 Pa in the free surface", ("Pressure", 500.0, RED), ("Pressure", 1500.0, YELLOW),
                            ("Pressure", 3000.0, GREEN), (None, 0, WATER, 0.25))]),
    "figure_6": (TANK[1], [("vorticity 5 / s", ("Vorticity", 5.0, ORANGE))]),
    "figure_7": (TANK[2], [(f"lambda2 {value:g} / s^2", ("Lambda2", value, RED), (None, 0, WATER, 0.15))
                           for value in (-150.0, -50.0)]),
    "figure_8": (TANK[3], [(f"vorticity {value:g} / s", ("Vorticity", value, ORANGE, 0.35)) for value in (10.0, 1.0, 0.1)]),
    "figure_9": (NEAR, [("pressure 1500 Pa, h", ("Pressure", 1500.0, YELLOW)),
                        ("0.5 h: noise", ("Pressure", 1500.0, YELLOW, 1.0, 0.5))])}


def figure(name):
    """Draws a figure of FIGURES. Vorticity and Lambda2 are computed; the file's own arrays of these names are not used."""
    reader, (camera, panels) = read(), FIGURES[name]
    derived = water(vtkSPHDerivatives(), reader, "Velocity")

    def actor(array, value, color, opacity=1.0, scale=1.0):
        source = derived if array in ("Vorticity", "Lambda2") else reader
        return actor_of(surface(source, array, value, HScaleFactor=scale), color, opacity)

    return in_tank(reader, [(text, *(actor(*each) for each in surfaces)) for text, *surfaces in panels], camera)


def figure_4():
    reader, panels = read(), []
    for trim, text in ((0, "not trimmed"), (1, "trimmed")):
        actor = actor_of(surface(reader, "Velocity", 1.0, Trim=trim), LINE)
        actor.GetProperty().SetRepresentationToWireframe()
        actor.GetProperty().LightingOff()
        panels.append((text, actor))
    return in_tank(reader, panels, EDGE)


def figure_5():
    """Draws surfaces that are green where the sum of the kernels is 1, and red where it is 0.5 or less."""
    reader, table = read(), vtkLookupTable()
    table.SetTableRange(0.5, 1.0)
    table.SetHueRange(0.0, 0.33)
    table.SetSaturationRange(0.85, 0.85)
    table.SetValueRange(0.9, 0.75)
    return in_tank(reader, [
        (text, colored(actor_of(surface(reader, "Pressure", 1500.0, HScaleFactor=scale, ComputeWeightSum=1), GREEN), "WeightSum", table))
        for scale, text in ((1.0, "pressure 1500 Pa, h"), (0.75, "0.75 h"), (0.5, "0.5 h"))], TANK[3])


FINEST, SHARE = 0.002, 0.1  # The spacing is at most SHARE times the distance from the origin, or FINEST.


def graded_particles():
    """Returns the centres and edges of cubes that are divided until they are fine enough for their distance from the origin. The cubes
    fill half a ball below ring-shaped waves; each wave is half as high and as wide as the next wave outside."""
    centres, edge, found = np.zeros((1, 3)), 2.0, []
    while len(centres):
        far, beside = np.linalg.norm(centres, axis=1), np.hypot(centres[:, 0], centres[:, 1]) + 0.5 * FINEST
        done = edge <= np.maximum(FINEST, SHARE * far)
        inside = done & (centres[:, 2] < 0.1 * beside * np.cos(2 * np.pi * np.log2(beside))) & (far < 0.95)
        found.append(np.column_stack((centres[inside], np.full(inside.sum(), edge))))
        corners = np.stack(np.meshgrid(*[(-0.25, 0.25)] * 3), -1).reshape(-1, 3)
        centres = (centres[~done][:, None] + edge * corners).reshape(-1, 3)
        edge /= 2
    return np.concatenate(found)


def graded():
    """Draws adaptive cubes: the whole surface, and two views from nearer, with the triangles' edges."""
    rows, renderers, extract = graded_particles(), [], vtkMarchingCorrectors()
    # The smoothing length is 1.5 edges, so that kernels reach across the step from one size of cubes to the next.
    extract.SetInputData(poly_data(rows[:, :3].copy(), {"SmoothingLength": 1.5 * rows[:, 3], "Volume": rows[:, 3] ** 3}))
    extract.FreeSurfaceOn()
    extract.SetCubeSizeModeToAdaptive()
    extract.Update()
    if extract.GetOutput().GetNumberOfCells() == 0:
        sys.exit(extract.GetErrorMessage() or "the surface is empty")
    by_level = vtk_to_numpy(extract.GetRunStatistics().GetArray("TrianglesOfLevel"))
    print(f"{len(rows)} particles of spacing {rows[:, 3].min():.2g} to {rows[:, 3].max():.2g}, "
          f"{extract.GetOutput().GetNumberOfCells()} triangles, by level: {', '.join(str(int(n)) for n in by_level)}")
    for zoom in (1, 6, 36):
        actor = actor_of(extract, (0.62, 0.80, 0.95), specular=0)
        actor.GetProperty().EdgeVisibilityOn()
        actor.GetProperty().SetEdgeColor(0.25, 0.35, 0.6)
        renderers.append(panel([actor], "all of it" if zoom == 1 else f"{zoom} times as near", (12, 10), 18,
                               ((0, -0.9 / zoom, 1.2 / zoom), (0, 0, 0), 40), (0, 0, 1)))
    return renderers, (1350, 450)


PICTURES = {**{name: lambda name=name: figure(name) for name in FIGURES}, "figure_4": figure_4, "figure_5": figure_5,
            "dam_break": dam_break, "graded": graded}


def main(directory, names):
    for name in names or PICTURES:
        if name not in PICTURES:
            sys.exit(f"there is no picture {name}; there are {', '.join(PICTURES)}")
        drawn = PICTURES[name]()
        renderers, size = drawn if isinstance(drawn, tuple) else (drawn, (1100, 400))
        save(renderers, size, os.path.join(directory, f"{name}.png"))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
