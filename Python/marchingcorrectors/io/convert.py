# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles as VTK's poly data, .vtp, and .pvd of several times."""
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from . import FileError, read
from ._particles import support_factor


def to_vtk(particles):
    """A vertex of each, as ParaView draws no bare points, and arrays as in the file; beside them SmoothingLength as this
    package means it (half of the support radius, of the quintic spline a third, of the quartic 2/5), Mass and ParticleType
    (0 fluid, 1 wall) where the file tells them in another way."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    def array(values, name):
        values = np.ascontiguousarray(values)
        values = values.astype(np.uint8) if values.dtype == bool else values
        if values.dtype.kind == "U":
            made = vtkStringArray()
            for word in values:
                made.InsertNextValue(word)
        else:
            made = numpy_to_vtk(values, deep=True)
        made.SetName(name)
        return made

    positions = particles.positions
    data, points = vtkPolyData(), vtkPoints()
    points.SetData(array(positions if positions.dtype.kind == "f" else positions.astype(float), "Points"))
    data.SetPoints(points)
    vertices, numbers = vtkCellArray(), np.arange(len(positions) + 1)
    vertices.SetData(array(numbers, "Offsets"), array(numbers[:-1], "Numbers"))
    data.SetVerts(vertices)
    arrays = {name: particles.arrays[name] for name in particles.arrays}
    h = particles.quantity("smoothing_length")
    if h is not None:
        if isinstance(particles.smoothing_length, str):
            arrays.pop(particles.smoothing_length)
        factor = support_factor(particles.kernel) if particles.support_radius else 1
        arrays["SmoothingLength"] = np.broadcast_to(np.asarray(h, float) / factor, len(positions))
    if isinstance(particles.mass, float):
        arrays.setdefault("Mass", np.full(len(positions), particles.mass))
    if particles.solid is not None and "Type" not in arrays:
        arrays["ParticleType"] = particles.solid.astype(np.uint8)
    for name, values in arrays.items():
        if values.ndim <= 2 and len(values) == len(positions):
            data.GetPointData().AddArray(array(values, name))
    field = {"TimeValue": None if particles.time is None else [float(particles.time)],
             "PeriodicBounds": particles.period}
    for name, values in field.items():
        if values is not None:
            data.GetFieldData().AddArray(array(np.asarray(values, float), name))
    return data


def write_vtp(particles, path):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetDataModeToBinary()
    writer.SetInputData(to_vtk(particles))
    if not writer.Write():
        raise FileError(f"{path} cannot be written.")


def convert(inputs, output):
    """Files into one .vtp, or one .vtp for each beside a .pvd, whose times are the files' (else 0, 1, ...)."""
    output = Path(output)
    if output.suffix.lower() not in (".vtp", ".pvd"):
        raise FileError(f"'{output}' must end in .vtp or .pvd.")
    if any(Path(each).resolve() == output.resolve() for each in inputs):
        raise FileError(f"{output.name} is a file to be read, too.")
    if output.suffix.lower() == ".vtp":
        write_vtp(read(inputs[0] if len(inputs) == 1 else inputs), output)
        return
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "<Collection>"]
    for i, each in enumerate(inputs):
        particles, name = read(each), f"{output.stem}_{i:04d}.vtp"
        write_vtp(particles, output.with_name(name))
        time = i if particles.time is None else particles.time
        lines.append(f'<DataSet timestep="{time!r}" part="0" file={quoteattr(name)}/>')
    output.write_text("\n".join(lines + ["</Collection>", "</VTKFile>", ""]))
