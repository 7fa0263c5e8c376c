#!/usr/bin/env pvpython
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A film of a drop in a vortex, with frames between the stored steps.

    pvpython film.py PLUGIN FOLDER      (without a display: Testing/with-display.sh pvpython ...)

Stores five steps (drop_0.vtp, ..., drop.pvd) and writes a frame for each step, and three frames between
two steps: film.0000.png, ..., film.0016.png. film.png shows five frames: two of stored steps, and the three between them.
"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, os.pardir, "Catalyst"))
# pylint: disable=wrong-import-position
import numpy as np  # noqa: E402
from paraview.simple import (ColorBy, CreateRenderView, GetAnimationScene, GetColorTransferFunction, LoadPlugin,  # noqa: E402
                             PVDReader, Render, SaveAnimation, Show)
from vtkmodules.vtkCommonDataModel import vtkPolyData  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkImageAppend  # noqa: E402
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter  # noqa: E402
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter  # noqa: E402
from vortex import advanced, ball, fill  # noqa: E402

STEPS, BETWEEN, INTERVAL = 5, 3, 0.25
FRAMES = (STEPS - 1) * (BETWEEN + 1) + 1


def store(folder):
    """Writes the steps as a solver would, each with its particles in another order. Returns the name of the .pvd file."""
    points, names = ball(), []
    for step in range(STEPS):
        order = np.random.default_rng(step).permutation(len(points))
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(os.path.join(folder, f"drop_{step}.vtp"))
        writer.SetDataModeToBinary()
        writer.SetInputData(fill(vtkPolyData(), points[order], order))
        writer.Write()
        names.append(f'<DataSet timestep="{step * INTERVAL}" file="drop_{step}.vtp"/>')
        for _ in range(10):
            points = advanced(points, INTERVAL / 10)
    file = os.path.join(folder, "drop.pvd")
    with open(file, "w", encoding="ascii") as stream:
        stream.write(f'<VTKFile type="Collection" version="0.1"><Collection>{"".join(names)}</Collection></VTKFile>\n')
    return file


def animate(file):
    """Returns the scene, whose frames are the interpolator's time steps, and its view."""
    film = SPHTemporalInterpolator(Input=PVDReader(FileName=file), ResampleFactor=BETWEEN + 1)  # noqa: F821, the plugin's
    surface = MarchingCorrectors(Input=film, FreeSurface=1, Smooth=1)  # noqa: F821
    view = CreateRenderView(ViewSize=[360, 360], UseColorPaletteForBackground=0, Background=[1.0, 1.0, 1.0],
                            OrientationAxesVisibility=0)
    shown = Show(surface, view)
    ColorBy(shown, ("POINTS", "Velocity", "Magnitude"))
    GetColorTransferFunction("Velocity").RescaleTransferFunction(0.0, 1.0)
    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    assert len(list(scene.TimeKeeper.TimestepValues)) == FRAMES
    Render(view)  # The first rendering places the camera.
    view.CameraPosition, view.CameraFocalPoint = [0.5, 0.5, 2.6], [0.5, 0.5, 0.5]
    view.CameraViewUp, view.CameraViewAngle = [0.0, 1.0, 0.0], 26
    return scene, view


def frame(folder, number):
    reader = vtkPNGReader()
    reader.SetFileName(os.path.join(folder, f"film.{number:04d}.png"))
    reader.Update()
    return reader.GetOutput()


def strip(folder, numbers):
    row = vtkImageAppend()
    for number in numbers:
        row.AddInputData(frame(folder, number))
    writer = vtkPNGWriter()
    writer.SetInputConnection(row.GetOutputPort())
    writer.SetFileName(os.path.join(folder, "film.png"))
    writer.Write()


def main(plugin, folder):
    LoadPlugin(plugin, remote=False, ns=globals())
    scene, view = animate(store(folder))
    SaveAnimation(os.path.join(folder, "film.png"), view, scene=scene, FrameWindow=[0, FRAMES - 1])
    first = 2 * (BETWEEN + 1)
    strip(folder, range(first, first + BETWEEN + 2))
    pixels = {bytes(memoryview(frame(folder, i).GetPointData().GetScalars())) for i in range(FRAMES)}
    print(len(pixels), "different frames")
    if len(pixels) != FRAMES:
        sys.exit("frames are alike")


if len(sys.argv) != 3:
    sys.exit(__doc__)
main(*sys.argv[1:])
