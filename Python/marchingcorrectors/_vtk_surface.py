# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Builds a surface as vtkPolyData, and a run's results, settings and costs as field data, as vtkMarchingCorrectorsOutput does."""
import ctypes

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkAbstractArray, vtkDataArray, vtkIdList, vtkPoints, vtkStringArray, vtkTypeInt64Array
from vtkmodules.vtkCommonDataModel import vtkCellArray

from . import _structs as c
from ._arrays import QUANTITIES
from ._options import camel

# These options of mcor_options are left out: users do not look for them, or statistics tell them.
NOT_TOLD = ("", "Dimension", "CubeSize", "WallShare")


def add(data, name, values):
    """Adds an array of these values; one text, number or tuple gives one tuple."""
    values = np.asarray(values)
    if values.dtype.kind == "U":
        array = vtkStringArray()
        for text in values.ravel().tolist():
            array.InsertNextValue(text)
    else:
        array = numpy_to_vtk(values.astype(np.uint8) if values.dtype == bool else values, deep=True)
    array.SetName(name)
    data.AddArray(array)
    return array


def build_cells(first, corners):
    """Returns cells with ids of vtkContourFilter's type; with other types, some filters think a mesh is not a manifold."""
    offsets, connectivity, cells = vtkTypeInt64Array(), vtkTypeInt64Array(), vtkCellArray()
    for array, values in ((offsets, first), (connectivity, corners)):
        array.SetNumberOfValues(len(values))
        vtk_to_numpy(array)[:] = values
    cells.SetData(offsets, connectivity)
    return cells


def build_mesh(output, surface, arrays):
    """Puts points and cells of a Surface into the output. arrays: {name: array} for the points."""
    points, data = vtkPoints(), output.GetPointData()
    points.SetData(numpy_to_vtk(surface.points, deep=True))
    output.SetPoints(points)
    corners = surface.triangles.ravel()
    output.SetPolys(build_cells(np.arange(0, len(corners) + 1, 3), corners))
    if surface.line_offsets is not None:
        output.SetLines(build_cells(surface.line_offsets, surface.line_points))
    if surface.band_value is not None:
        add(output.GetCellData(), "BandValue",
            np.concatenate([surface.line_values() if len(surface.points) else [], surface.band_value]))
    elif surface.triangle_keys is not None and surface.line_offsets is None:
        add(output.GetCellData(), "TriangleKeys", surface.triangle_keys)
    for name, values in arrays.items():
        add(data, name, values)
    if "Normals" in arrays and (surface.line_offsets is None or surface.band_value is not None):  # With normals, lines would be dark.
        data.SetActiveNormals("Normals")


def add_nearest(data, name, array, nearest):
    """Adds an array of any type: the values of the particles with the numbers `nearest`."""
    if isinstance(array, vtkDataArray) and array.GetDataTypeAsString() != "bit":
        made = numpy_to_vtk(vtk_to_numpy(array)[nearest], deep=True, array_type=array.GetDataType())
    else:
        made, ids = vtkAbstractArray.CreateArray(array.GetDataType()), vtkIdList()
        made.SetNumberOfComponents(array.GetNumberOfComponents())
        made.SetNumberOfTuples(len(nearest))
        for particle in nearest.tolist():
            ids.InsertNextId(particle)
        array.GetTuples(ids, made)
    made.SetName(name)
    made.CopyComponentNames(array)
    data.AddArray(made)


# -- field data --

def add_run(run, found, particles, arguments):
    """Adds a run's results, settings and costs. Costs add up over blocks."""
    s, o = found.statistics, arguments.options
    for name in ("Device", "Platform"):
        add(run, name, s[name.lower()])
    plane, shut = s["dimension"] == 2, s["is_closed"]
    when = {"always": True, "is_plane": plane, "has_levels": o.level_limit > 0, "is_widened": s["widening_max"] > 0,
            "has_scalar": particles.scalar is not None,
            "has_caps": o.capping > 0, "has_area": not plane or shut or o.filled, "has_volume": not plane and shut}
    for how, condition, member, name in c.STATISTICS:
        value = s[member]
        if condition == "is_run":
            before = run.GetArray(name).GetComponent(0, 0) if run.HasArray(name) and how != "SAME" else 0
            add(run, name, [type(value)(max(before, value) if how == "MOST" else before + value)])
        elif name and when[condition] and isinstance(value, tuple) and len(value) > 3:  # These are counts of levels.
            add(run, name, value[:max(1 + np.max(np.nonzero(value), initial=0), 1)])
        elif name and when[condition]:
            add(run, name, [value])
    for name in ["smoothing_length"] + ["scalar"] * when["has_scalar"]:
        add(run, camel(name) + "Range", [[s[name + "_min"], s[name + "_max"]]])
    for name, count in (("Points", found.points), ("Triangles", found.triangles), ("Lines", found.lines if plane else None)):
        if count is not None:
            add(run, name, [len(count)])
    seconds = {**s["seconds"], "program build": s["build_seconds"]}
    seconds["total"] = sum(seconds.values())
    before = vtk_to_numpy(run.GetArray("Seconds")) if run.HasArray("Seconds") else 0
    array = add(run, "Seconds", np.array([list(seconds.values())]) + before)
    for i, name in enumerate(seconds):
        array.SetComponentName(i, name)
    add_iso_values(run, o)
    add_parameters(run, particles, arguments, s["wall_share"])


def add_iso_values(data, options):
    add(data, "IsoValues", np.array(options.iso_values[:options.iso_count], float))


def add_parameters(data, particles, arguments, wall_share):
    o, given, has_fluid = arguments.options, arguments.input, particles.fluid is not None
    for name in QUANTITIES:
        array = getattr(given, name)
        add(data, camel(name) + "Array", (array.name or b"").decode())
        if name != "smoothing_length" and not array.data and array.constant:
            add(data, "ParticleVolume" if name == "volume" else camel(name), [array.constant])
    for name in ("smoothing_length_is_support_radius", "estimate_smoothing_length", *["ignore_solids"] * has_fluid):
        add(data, camel(name), [getattr(given, name)])
    add(data, "Scalar", particles.scalar_name)
    add(data, "FluidArray", particles.name("fluid"))
    if has_fluid:
        add(data, "FluidValue", [particles.found.fluid_value])
        add(data, "WallShare", [wall_share])
    add(data, "CubeSizeMode", "adaptive" if o.level_limit else "uniform")
    if o.capping or any(low < high for low, high in zip(o.periodic[::2], o.periodic[1::2])):
        add(data, "Capping", [int(o.capping > 0)])
    for member, (words, _, name) in c.OPTIONS.items():
        value, name = getattr(o, member), "Field" if member == "field" else name
        if isinstance(value, ctypes.Array):
            if any(low < high for low, high in zip(value[::2], value[1::2])):
                add(data, name, [value[:]])
        elif name not in NOT_TOLD:
            add(data, name, {number: word for word, number in words.items()}.get(value, [value]))


def describe(run):
    """Returns a line "Name: values" for each array."""
    lines = []
    for i in range(run.GetNumberOfArrays()):
        array = run.GetAbstractArray(i)
        values = ", ".join(array.GetVariantValue(v).ToString() for v in range(array.GetNumberOfValues()))
        lines.append(f"{array.GetName()}: {values}\n")
    return "".join(lines)
