#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the pictures of README.md.

readme_pictures.py DIRECTORY      (without a display: Testing/with-display.sh python3 readme_pictures.py ...)

PYTHONPATH must name the directory of the package marchingcorrectors.
"""
import os
import sys

from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersCore import vtkThreshold
from vtkmodules.vtkFiltersSources import vtkOutlineSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkDataSetMapper, vtkLightKit

import pictures
from marchingcorrectors import vtkMarchingCorrectors

SPEEDS = (0.0, 2.5)  # m/s, of the colours


def speed_colors():
    """Deep blue, cyan, white: slow water to spray."""
    stops = [(0.0, (0.05, 0.18, 0.45)), (0.45, (0.15, 0.55, 0.80)), (1.0, (0.95, 0.98, 1.0))]
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    table.SetTableRange(*SPEEDS)
    table.SetVectorModeToMagnitude()
    for i in range(256):
        t = i / 255
        (low, a), (high, b) = next((p, q) for p, q in zip(stops, stops[1:]) if t <= q[0])
        u = (t - low) / (high - low)
        table.SetTableValue(i, *(x + u * (y - x) for x, y in zip(a, b)), 1.0)
    return table


def colored_by_speed(algorithm):
    mapper = vtkDataSetMapper()
    mapper.SetInputConnection(algorithm.GetOutputPort())
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("Velocity")
    mapper.SetLookupTable(speed_colors())
    mapper.UseLookupTableScalarRangeOn()
    actor = vtkActor()
    actor.SetMapper(mapper)
    return actor


def particle_actor(reader):
    fluid = vtkThreshold()
    fluid.SetInputConnection(reader.GetOutputPort())
    fluid.SetInputArrayToProcess(0, 0, 0, 0, "ParticleType")
    fluid.SetLowerThreshold(0)
    fluid.SetUpperThreshold(0)
    actor = colored_by_speed(fluid)
    actor.GetProperty().SetRepresentationToPoints()
    actor.GetProperty().SetPointSize(4)
    actor.GetProperty().RenderPointsAsSpheresOn()
    return actor


def surface_filter(reader):
    surface = vtkMarchingCorrectors()
    surface.SetInputConnection(reader.GetOutputPort())
    surface.SetFluidArrayName("ParticleType")
    surface.SetFluidValue(0)
    return surface


def need_surface(surface):
    surface.Update()
    if surface.GetOutput().GetNumberOfCells() == 0:
        sys.exit(surface.GetErrorMessage() or "the surface is empty")


def free_surface_actor(reader, opacity=1.0):
    surface = surface_filter(reader)
    surface.FreeSurfaceOn()
    surface.SmoothOn()
    need_surface(surface)
    actor = colored_by_speed(surface)
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetSpecular(0.35)
    actor.GetProperty().SetSpecularPower(40)
    return actor


def isosurface_actor(reader):
    surface = surface_filter(reader)
    surface.SetInputArrayToProcess(0, 0, 0, 0, "Velocity")
    surface.SetValue(0, 1.0)
    need_surface(surface)
    actor = vtkActor()
    mapper = vtkDataSetMapper()
    mapper.SetInputConnection(surface.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.90, 0.45, 0.20)
    actor.GetProperty().SetSpecular(0.3)
    actor.GetProperty().SetSpecularPower(30)
    return actor


def outline_actor(reader):
    outline = vtkOutlineSource()
    outline.SetBounds(reader.GetOutput().GetBounds())
    mapper = vtkDataSetMapper()
    mapper.SetInputConnection(outline.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.6, 0.6, 0.6)
    actor.GetProperty().LightingOff()
    return actor


def panel(reader, actors, caption, viewport):
    renderer = pictures.panel(viewport, outline_actor(reader), *actors,
                              pictures.caption(caption, 28, (24, 474), (0.1, 0.1, 0.1)))
    lights = vtkLightKit()
    lights.AddLightsToRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(-0.35, 2.5, 4.4)
    camera.SetFocalPoint(1.565, 0.45, 0.0)
    camera.SetViewUp(0, 1, 0)
    camera.SetViewAngle(31)
    renderer.ResetCameraClippingRange()
    return renderer


def main(directory):
    reader = pictures.read()
    third = 1 / 3
    pictures.save([
        panel(reader, [particle_actor(reader)], "particles", (0, 0, third, 1)),
        panel(reader, [free_surface_actor(reader)], "free surface, smooth", (third, 0, 2 * third, 1)),
        panel(reader, [isosurface_actor(reader), free_surface_actor(reader, 0.2)],
              "isosurface of the speed, 1 m/s", (2 * third, 0, 1, 1)),
    ], (1950, 520), os.path.join(directory, "dam_break.png"))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
