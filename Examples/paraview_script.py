# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""ParaView, Python: an isosurface of the speed of a dam break inside its free surface, as a picture.

pvpython paraview_script.py PLUGIN PICTURE.png      (without a display: Testing/with-display.sh pvpython ...)

PLUGIN is MarchingCorrectors.so, in the build tree or where it was installed.
"""
import os
import sys

from paraview.simple import (ColorBy, GetColorTransferFunction, GetScalarBar, LoadPlugin, Render,
                             SaveScreenshot, Show, XMLPolyDataReader, GetActiveViewOrCreate)


def extract_surfaces(particles):
    """Returns the free surface and the isosurface of the speed. LoadPlugin() adds MarchingCorrectors to this script's names."""
    surface = MarchingCorrectors(Input=particles)  # noqa: F821
    surface.FluidArray = "ParticleType"  # 0 is fluid, 1 is wall
    surface.FreeSurface = 1

    fast = MarchingCorrectors(Input=particles)  # noqa: F821
    fast.FluidArray = "ParticleType"
    fast.ContourBy = ["POINTS", "Velocity"]  # A vector is contoured by its magnitude.
    fast.Isosurfaces = [1.0]  # m/s
    return surface, fast


def draw(surface, fast, picture):
    view = GetActiveViewOrCreate("RenderView")
    view.ViewSize = [1200, 600]
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0

    water = Show(surface, view)
    water.Opacity = 0.25
    ColorBy(water, None)
    water.AmbientColor = water.DiffuseColor = [0.35, 0.6, 0.85]

    # Every other array of the particles was interpolated to the surface.
    inside = Show(fast, view)
    ColorBy(inside, ("POINTS", "Pressure"))
    colors = GetColorTransferFunction("Pressure")
    colors.RescaleTransferFunction(0.0, 4000.0)
    bar = GetScalarBar(colors, view)
    bar.Title = "Pressure (Pa)"
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
    inside.SetScalarBarVisibility(view, True)

    Render(view)  # The first rendering places the camera.
    view.CameraPosition = [-0.35, 2.5, 4.1]
    view.CameraFocalPoint = [1.72, 0.43, 0.0]
    view.CameraViewUp = [0.0, 1.0, 0.0]
    view.CameraViewAngle = 24
    Render(view)
    SaveScreenshot(picture, view, ImageResolution=view.ViewSize)


def main(plugin, picture):
    LoadPlugin(plugin, remote=False, ns=globals())
    data = os.path.join(os.path.dirname(os.path.abspath(__file__)), "Data", "dam_break_45k.vtp")
    surface, fast = extract_surfaces(XMLPolyDataReader(FileName=[data]))
    draw(surface, fast, picture)
    for name, source in (("free surface", surface), ("speed 1 m/s", fast)):
        triangles = source.GetDataInformation().GetNumberOfCells()
        print("%s: %d triangles" % (name, triangles))
        if triangles == 0:
            sys.exit("the surface is empty")


if len(sys.argv) != 3:
    sys.exit(__doc__)
main(*sys.argv[1:])
