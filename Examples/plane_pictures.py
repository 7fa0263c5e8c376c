#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws bands of pressure, and those of VTK's own filters below, for the guide's page on two dimensions.

plane_pictures.py FLUME.vtp BANDS.vtp PICTURE.png

FLUME.vtp: of Examples/Data/make_wave.py. BANDS.vtp: of marching-correctors, with --filled. VTK's way is vtkSPHInterpolator with
a kernel of two dimensions, on an image as fine as the squares are, then vtkBandedPolyDataContourFilter. Needs VTK's Python
modules, and without a display Testing/with-display.sh.
"""
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkFiltersModeling import vtkBandedPolyDataContourFilter
from vtkmodules.vtkFiltersPoints import vtkSPHCubicKernel, vtkSPHInterpolator

from pictures import mesh_actor, panel, poly_data, read, save


def fluid_of(particles):
    """The particles of type 0, with the arrays that the interpolation needs."""
    data = particles.GetPointData()
    kept = vtk_to_numpy(data.GetArray("Type")) == 0
    return poly_data(vtk_to_numpy(particles.GetPoints().GetData())[kept], **{
        name: vtk_to_numpy(data.GetArray(name))[kept] for name in ("Pressure", "SmoothingLength", "Density", "Mass")})


def interpolate(particles, square):
    """The field on an image of the plane; 0 where no particle reaches."""
    bounds = particles.GetBounds()
    image = vtkImageData()
    image.SetOrigin(bounds[0] - 4 * square, bounds[2], bounds[4] - 4 * square)
    image.SetSpacing(square, square, square)
    image.SetDimensions(int((bounds[1] - bounds[0]) / square) + 9, 1, int((bounds[5] - bounds[4]) / square) + 9)
    kernel = vtkSPHCubicKernel()
    kernel.SetDimension(2)
    kernel.SetSpatialStep(particles.GetPointData().GetArray("SmoothingLength").GetValue(0))
    field = vtkSPHInterpolator()
    field.SetInputData(image)
    field.SetSourceData(particles)
    field.SetKernel(kernel)
    field.SetDensityArrayName("Density")
    field.SetMassArrayName("Mass")
    field.Update()
    field.GetOutput().GetPointData().SetActiveScalars("Pressure")
    flat = vtkGeometryFilter()
    flat.SetInputConnection(field.GetOutputPort())
    flat.Update()
    return flat.GetOutput()


def banded(flat, values):
    bands = vtkBandedPolyDataContourFilter()
    bands.SetInputData(flat)
    bands.SetScalarModeToValue()
    for i, value in enumerate(values + [1e9]):
        bands.SetValue(i, value)
    bands.GenerateContourEdgesOn()
    bands.ClippingOn()
    bands.Update()
    return bands.GetOutput(), bands.GetOutput(1)


def actor_of(data, colors=None, array=None):
    actor = mesh_actor(data)
    mapper = actor.GetMapper()
    actor.GetProperty().LightingOff()
    actor.GetProperty().SetColor(0.1, 0.1, 0.1)
    actor.GetProperty().SetLineWidth(1.5)
    if colors:
        mapper.SetScalarModeToUseCellFieldData()
        mapper.SelectColorArray(array)
        mapper.SetLookupTable(colors)
        mapper.UseLookupTableScalarRangeOn()
    else:
        mapper.ScalarVisibilityOff()
        actor.SetPosition(0, -0.01, 0)  # towards the eye
    return actor


def lines_of(filled):
    lines = vtkPolyData()
    lines.SetPoints(filled.GetPoints())
    lines.SetLines(filled.GetLines())
    return lines


def draw(panels, colors, bounds, name):
    renderers = []
    for i, (bands, lines, array) in enumerate(panels):
        renderer = panel((0, 0.5 - 0.5 * i, 1, 1 - 0.5 * i), actor_of(bands, colors, array), actor_of(lines))
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        middle = [0.5 * (bounds[2 * a] + bounds[2 * a + 1]) for a in range(3)]
        camera.SetFocalPoint(middle)
        camera.SetPosition(middle[0], middle[1] - 5, middle[2])
        camera.SetViewUp(0, 0, 1)
        camera.SetParallelScale(0.54 * (bounds[1] - bounds[0]) * 330 / 1100)
        renderer.ResetCameraClippingRange()
        renderers.append(renderer)
    save(renderers, (1100, 2 * 330), name, samples=8)


def main():
    flume, filled, name = sys.argv[1:]
    particles, ours = fluid_of(read(flume).GetOutput()), read(filled).GetOutput()
    bands = ours.GetCellData().GetArray("BandValue")
    values = sorted({bands.GetValue(i) for i in range(bands.GetNumberOfValues())})
    square = 0.5 * particles.GetPointData().GetArray("SmoothingLength").GetValue(0)
    other, edges = banded(interpolate(particles, square), values)
    colors = vtkLookupTable()
    colors.SetNumberOfTableValues(len(values))
    colors.SetHueRange(0.6, 0.05)
    colors.SetSaturationRange(0.45, 0.65)
    colors.SetTableRange(values[1] - (values[2] - values[1]), values[-1])
    colors.Build()
    draw([(ours, lines_of(ours), "BandValue"), (other, edges, "Scalars")], colors, particles.GetBounds(), name)


if __name__ == "__main__":
    main()
