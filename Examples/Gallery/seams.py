#!/usr/bin/env pvbatch
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the free surface of the dam break by several processes, coloured by process, with seams and without.

    mpirun -n 3 pvbatch seams.py PLUGIN FOLDER      (without a display: Testing/with-display.sh mpirun ...)

Writes seams.png. Left: three slabs of particles, each with a surface of its own, as processes make
them without exchange of particles. Right: the surface that the processes share.
"""
import os
import sys

from paraview import servermanager, simple
from paraview.simple import (Calculator, ColorBy, CreateLayout, CreateRenderView, GetColorTransferFunction, LoadPlugin,
                             Render, SaveScreenshot, Show, Text, Threshold, XMLPolyDataReader)

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "Data", "dam_break_45k.vtp")
CUTS = (-1.0, 0.9, 1.7, 4.0)  # the ends of three slabs along x
# ParaView 5.12 gave the filter and its array other names.
PROCESS_IDS, NUMBER = ((simple.ProcessIds, "PointProcessIds") if hasattr(simple, "ProcessIds")
                       else (simple.ProcessIdScalars, "ProcessId"))
COLORS = [(0.35, 0.6, 0.85), (0.95, 0.7, 0.25), (0.45, 0.7, 0.4)]


def free_surface(particles):
    surface = MarchingCorrectors(Input=particles, FreeSurface=1, FluidArray="ParticleType")  # noqa: F821, the plugin's
    surface.UpdatePipeline()
    return surface


def slabs(particles):
    """Yields the surface of each slab, made from its particles alone."""
    along = Calculator(Input=particles, ResultArrayName="along", Function="coordsX")
    for low, high in zip(CUTS, CUTS[1:]):
        slab = Threshold(Input=along, Scalars=["POINTS", "along"], LowerThreshold=low, UpperThreshold=high - 1e-6,
                         ThresholdMethod="Between")
        yield free_surface(slab)


def view_of(caption):
    view = CreateRenderView(ViewSize=[800, 500], UseColorPaletteForBackground=0, Background=[1.0, 1.0, 1.0],
                            OrientationAxesVisibility=0)
    text = Show(Text(Text=caption), view)
    text.Color, text.FontSize = [0.0, 0.0, 0.0], 20
    return view


def look(view):
    Render(view)  # The first rendering places the camera.
    view.CameraPosition, view.CameraFocalPoint = [0.2, 2.2, 3.2], [1.5, 0.35, 0.0]
    view.CameraViewUp, view.CameraViewAngle = [0.0, 1.0, 0.0], 30
    Render(view)


def tell(name, surfaces):
    triangles = sum(surface.GetDataInformation().GetNumberOfCells() for surface in surfaces)
    print(f"{name}: {triangles} triangles", flush=True)
    return triangles


def main(plugin, folder):
    LoadPlugin(plugin, remote=False, ns=globals())
    particles = XMLPolyDataReader(FileName=[DATA])

    left = view_of("each process for itself")
    own = list(slabs(particles))
    for surface, color in zip(own, COLORS):
        shown = Show(surface, left)
        ColorBy(shown, None)
        shown.AmbientColor = shown.DiffuseColor = color

    right = view_of("shared")
    shared = free_surface(particles)
    shown = Show(PROCESS_IDS(Input=shared), right)
    ColorBy(shown, ("POINTS", NUMBER))
    table = GetColorTransferFunction(NUMBER)
    table.InterpretValuesAsCategories = 1
    table.Annotations = [word for i in range(len(COLORS)) for word in (str(i), str(i))]
    table.IndexedColors = [part for color in COLORS for part in color]

    layout = CreateLayout()
    layout.AssignView(layout.SplitHorizontal(0, 0.5), left)
    layout.AssignView(2, right)
    for view in (left, right):
        look(view)
    SaveScreenshot(os.path.join(folder, "seams.png"), layout, ImageResolution=[1600, 500])
    if tell("shared", [shared]) >= tell("each for itself", own):
        sys.exit("the slabs have no walls of their own at the seams")


if len(sys.argv) != 3:
    sys.exit(__doc__)
if servermanager.ActiveConnection.GetNumberOfDataPartitions() != len(COLORS):
    sys.exit(f"this wants {len(COLORS)} processes")
main(*sys.argv[1:])
