# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles as VTK's poly data, .vtp, and .pvd of several times."""
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from .._warnings import warn
from . import FileError, count_steps, read
from ._outputs import STEP_MARK, Outputs
from ._particles import support_factor


def plain(values):
    """Returns the array in a type that VTK has: half precision becomes single, long double double."""
    values = np.asarray(values)
    kind, size = values.dtype.kind, values.dtype.itemsize
    if kind == "f" and size not in (4, 8):
        return values.astype(np.float32 if size < 4 else np.float64)
    return np.ascontiguousarray(values, np.uint8 if kind == "b" else values.dtype.newbyteorder("="))


def to_vtk(particles):
    """A vertex of each, as ParaView draws no bare points, and arrays as in the file; beside them SmoothingLength as this
    package means it (half of the support radius, of the quintic spline a third, of the quartic 2/5), Mass and ParticleType
    (0 fluid, 1 wall) where the file tells them in another way."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    from .._vtk_surface import add, build_cells

    positions = particles.positions
    data, numbers = vtkPolyData(), np.arange(len(positions) + 1)
    data.SetPoints(vtkPoints())
    data.GetPoints().SetData(numpy_to_vtk(plain(positions if positions.dtype.kind == "f" else positions.astype(float)), deep=True))
    data.SetVerts(build_cells(numbers, numbers[:-1]))
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
        if values.ndim in (1, 2) and len(values) == len(positions) and values.size >= len(values):
            if values.dtype.kind in "biuf" or (values.dtype.kind == "U" and values.ndim == 1):
                add(data.GetPointData(), name, plain(values))
            else:
                warn(f"{particles.file}: the array '{name}' ({values.dtype}) is left out, as VTK has no such type.")
    field = {"TimeValue": None if particles.time is None else [float(particles.time)],
             "PeriodicBounds": particles.cell or particles.period}
    for name, values in field.items():
        if values is not None:
            add(data.GetFieldData(), name, np.asarray(values, float))
    return data


def vtp_bytes(particles, mark=b""):
    """In memory: on a full disk VTK's writers end in a crash, or without a word."""
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    data = to_vtk(particles)
    for arrays in (data.GetPointData(), data.GetFieldData()):
        for i in range(arrays.GetNumberOfArrays()):
            each = arrays.GetAbstractArray(i)
            each.SetName(escape(each.GetName(), {'"': "&quot;"}))  # VTK's writers put names into XML as they are
    writer = vtkXMLPolyDataWriter()
    writer.WriteToOutputStringOn()
    writer.SetDataModeToBinary()
    writer.SetInputData(data)
    written = writer.Write() and writer.GetOutputString()
    if not written:
        raise FileError(f"{particles.file} could not be converted: VTK's writer gave up.")
    written = written if isinstance(written, bytes) else written.encode()
    return written.replace(b"?>", b"?>\n" + mark, 1) if mark else written


def convert(inputs, output):
    """Files into one .vtp, or one .vtp for each of their steps beside a .pvd, whose times are the files' (else 0, 1, ...)."""
    output = Path(output)
    if output.suffix.lower() not in (".vtp", ".pvd"):
        raise FileError(f"'{output}' must end in .vtp or .pvd.")
    if output.suffix.lower() == ".vtp":
        with Outputs(inputs, [output]) as files:
            particles = read(inputs[0] if len(inputs) == 1 else inputs)
            files.write(output, vtp_bytes(particles))
        if len(particles.times or ()) > 1:
            warn(f"{particles.file} has {len(particles.times)} steps, and {output.name} the first: a .pvd file holds all.")
        return
    sources = [(each, i) for each in inputs for i in range(count_steps(each))]
    steps = [output.with_name(f"{output.stem}_{i:04d}.vtp") for i in range(len(sources))]
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "<Collection>"]
    with Outputs(inputs, [output], steps) as files:
        for i, ((each, number), step) in enumerate(zip(sources, steps)):
            particles = read(each, step=number)
            files.write(step, vtp_bytes(particles, STEP_MARK))
            time = float(i if particles.time is None else particles.time)
            lines.append(f'<DataSet timestep="{time!r}" part="0" file={quoteattr(step.name)}/>')
        files.write(output, "\n".join(lines + ["</Collection>", "</VTKFile>", ""]).encode())
