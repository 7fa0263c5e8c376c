# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes particles as VTK's poly data: .vtp, and .pvd for several times."""
import base64
import sys
import zlib
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from . import FileError, count_steps, read
from ._outputs import STEP_MARK, Outputs
from .._library import lib, warn
from .._options import words_of
from ._particles import find_kernel
from .vtk_files import KINDS

XML_NAMES = {numpy: name for name, numpy in KINDS.items()}
BLOCK = 1 << 20  # bytes that are packed at a time


def plain(values):
    """Returns the array in one piece, in a type that VTK has."""
    return np.ascontiguousarray(values, np.uint8 if values.dtype.kind == "b" else values.dtype.newbyteorder("="))


def describe(particles):
    """Returns positions, arrays as in the file, and field data. Adds arrays that the file tells in another way: SmoothingLength as this package
    means it (half of the support radius; a third for the quintic spline, 2/5 for the quartic), Mass, and ParticleType (0 fluid, 1 wall)."""
    positions, arrays = particles.positions, {name: particles.arrays[name] for name in particles.arrays}
    h = particles.quantity("smoothing_length")
    if h is not None:
        if isinstance(particles.smoothing_length, str):
            arrays.pop(particles.smoothing_length)
        kernel = find_kernel(particles.kernel)
        radius = lib.mcor_support_factor(words_of("sph_kernel")[kernel]) if kernel else 2.0  # as most kernels have
        factor = radius if particles.support_radius else 1
        arrays["SmoothingLength"] = np.broadcast_to(np.asarray(h, float) / factor, len(positions))
    if isinstance(particles.mass, float):
        arrays.setdefault("Mass", np.full(len(positions), particles.mass))
    if particles.solid is not None and "Type" not in arrays:
        arrays["ParticleType"] = particles.solid.astype(np.uint8)
    held = {}
    for name, values in arrays.items():
        if values.ndim in (1, 2) and len(values) == len(positions) and values.size >= len(values):
            if values.dtype.kind in "biuf" or (values.dtype.kind == "U" and values.ndim == 1):
                held[name] = values if values.dtype.kind == "U" else plain(values)
            else:
                warn(f"{particles.file}: the array '{name}' ({values.dtype}) is left out, as VTK has no such type.")
    field = {"TimeValue": None if particles.time is None else [float(particles.time)],
             "PeriodicBounds": particles.cell or particles.period}
    return (plain(positions if positions.dtype.kind == "f" else positions.astype(float)), held,
            {name: np.asarray(values, float) for name, values in field.items() if values is not None})


def to_vtk(particles):
    """Returns poly data with a vertex for each particle, because ParaView draws no points without cells."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    from .._vtk_surface import add, build_cells

    positions, arrays, field = describe(particles)
    data, numbers = vtkPolyData(), np.arange(len(positions) + 1)
    data.SetPoints(vtkPoints())
    data.GetPoints().SetData(numpy_to_vtk(positions, deep=True))
    data.SetVerts(build_cells(numbers, numbers[:-1]))
    for to, held in ((data.GetPointData(), arrays), (data.GetFieldData(), field)):
        for name, values in held.items():
            add(to, name, values)
    return data


def xml_array(name, values, more=""):
    """Returns the text of an array: the sizes of packed blocks, then the blocks, both in base64."""
    if values.dtype.kind == "U":
        kind, data = "String", "".join(value + "\0" for value in values.tolist()).encode()
    else:
        kind, data = XML_NAMES[values.dtype.str[1:]], np.ascontiguousarray(values).tobytes()
    blocks = [zlib.compress(data[i:i + BLOCK], 1) for i in range(0, len(data), BLOCK)]
    sizes = np.array([len(blocks), BLOCK, len(data) % BLOCK, *map(len, blocks)], np.uint64)
    text = (base64.b64encode(sizes.tobytes()) + base64.b64encode(b"".join(blocks))).decode()
    columns = values.shape[1] if values.ndim == 2 else 1
    return (f'<DataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{columns}"{more} format="binary">\n{text}\n'
            "</DataArray>\n")


def vtp_bytes(particles, mark=b""):
    """Returns the bytes of a .vtp file with the data of to_vtk(), made without VTK."""
    positions, arrays, field = describe(particles)
    count, numbers = len(positions), np.arange(len(positions) + 1)
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    inside = {"PointData": arrays, "Points": {"Points": positions}, "Verts": {"connectivity": numbers[:-1], "offsets": numbers[1:]}}
    piece = "".join(f"<{part}>\n{''.join(xml_array(name, values) for name, values in held.items())}</{part}>\n"
                    for part, held in inside.items())
    fields = "".join(xml_array(name, values, f' NumberOfTuples="{len(values)}"') for name, values in field.items())
    return (f'<?xml version="1.0"?>\n{mark.decode()}<VTKFile type="PolyData" version="1.0" byte_order="{order}" header_type="UInt64" '
            f'compressor="vtkZLibDataCompressor">\n<PolyData>\n<FieldData>\n{fields}</FieldData>\n'
            f'<Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">\n{piece}'
            "</Piece>\n</PolyData>\n</VTKFile>\n").encode()


def convert(inputs, output):
    """Writes files as one .vtp, or as a .pvd with one .vtp for each of their steps, at the files' times (else 0, 1, ...)."""
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
