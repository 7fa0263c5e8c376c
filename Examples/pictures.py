# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles, meshes and panels, for the scripts that draw pictures."""
import os

import vtkmodules.vtkInteractionStyle  # noqa: F401
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "Data", "dam_break_45k.vtp")


def read(path=DATA):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader


def poly_data(points, **arrays):
    """Particles with arrays, as they are."""
    data = vtkPolyData()
    data.SetPoints(vtkPoints())
    data.GetPoints().SetData(numpy_to_vtk(points, deep=True))
    for name, values in arrays.items():
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def mesh_actor(mesh, *color):
    """A mesh in one colour, or in those of its mapper, where there is none."""
    mapper, actor = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputData(mesh)
    actor.SetMapper(mapper)
    if color:
        mapper.ScalarVisibilityOff()
        actor.GetProperty().SetColor(*color)
    return actor


def caption(text, size, place, color=(0, 0, 0)):
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.GetTextProperty().SetColor(*color)
    actor.GetTextProperty().SetFontSize(size)
    actor.SetPosition(*place)
    return actor


def panel(viewport, *props):
    """A white part of the window."""
    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1, 1, 1)
    for prop in props:
        renderer.AddViewProp(prop)
    return renderer


def save(renderers, size, path, samples=0):
    """Without samples, edges are smoothed by FXAA."""
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(samples)
    window.SetSize(*size)
    for renderer in renderers:
        renderer.SetUseFXAA(not samples)
        window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.SetReadFrontBuffer(bool(samples))
    writer = vtkPNGWriter()
    writer.SetFileName(str(path))
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    print(path)
