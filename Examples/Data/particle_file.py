# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles as a .vtp file, for the scripts beside this one."""
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray


def poly_data(positions, arrays):
    """positions: [n, 3]; arrays: of n values or vectors, by name. Types stay as they are."""
    particles = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(positions, deep=1))
    particles.SetPoints(points)
    vertices = vtk.vtkCellArray()  # without them ParaView shows nothing
    vertices.SetData(1, numpy_to_vtkIdTypeArray(numpy.arange(len(positions)), deep=1))
    particles.SetVerts(vertices)
    for name, values in arrays.items():
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name)
        particles.GetPointData().AddArray(array)
    return particles


def write(path, particles):
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(particles)
    writer.SetDataModeToBinary()  # appended data cannot be read by every ParaView, see README.md
    writer.SetHeaderTypeToUInt64()
    writer.Write()
