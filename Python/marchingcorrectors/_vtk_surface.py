# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A surface of the core as vtkPolyData, as vtkMarchingCorrectorsOutput builds it in C++."""
import ctypes

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import (vtkAbstractArray, vtkDataArray, vtkDoubleArray, vtkIdList, vtkPoints,
                                      vtkStringArray, vtkTypeInt64Array)
from vtkmodules.vtkCommonDataModel import vtkCellArray

from . import _structs as c
from ._arrays import statistics, take, take_all, take_lines
from ._library import lib
from ._vtk_particles import choose_array, is_real, name_of

COMPUTED = {"normals": "Normals", "gradients": "Gradients", "weight_sum": "WeightSum",
            "boundary_eigenvalue": "BoundaryEigenvalue", "correction_length": "CorrectionLength",
            "residual": "Residual", "boundary_flag": "BoundaryFlag"}


def computed_arrays(options):
    return [name for option, name in COMPUTED.items() if getattr(options, option)]


def add(data, name, values):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    data.AddArray(array)
    return array


def varies(array, on_surface):
    """Whether there is more of it than the noise of what is contoured. Colours are those of magnitudes."""
    if on_surface is None or on_surface.GetNumberOfTuples() == 0:
        return False
    kind = -1 if array.GetNumberOfComponents() > 1 else 0
    (low, high), (least, most) = on_surface.GetRange(kind), array.GetRange(kind)
    return high - low > 1e-3 * (most - least)


def build_mesh(surface, particles, output, as_float, iso_count):
    arrays = take_all("mcor_surface", surface,
                      {"point_count": surface.point_count, "triangle_count": surface.triangle_count})
    points, data = vtkPoints(), output.GetPointData()
    where = arrays["points"] if arrays["points"] is not None else np.empty((0, 3))
    points.SetData(numpy_to_vtk(where.astype(np.float32 if as_float else np.float64, copy=False), deep=True))
    output.SetPoints(points)
    build_triangles(arrays["triangles"], output)
    lines = take_lines(surface)
    build_lines(lines, output)
    if arrays["band_value"] is not None:
        of_lines = arrays["iso_value"][lines["line_points"][lines["line_offsets"][:-1]]] if surface.line_count else []
        add(output.GetCellData(), "BandValue", np.concatenate([of_lines, arrays["band_value"]]))
    build_carried(surface, particles, data, arrays["nearest_particle"])
    for option, name in COMPUTED.items():
        if arrays[option] is not None:
            add(data, name, arrays[option])
    if arrays["normals"] is not None and (surface.statistics.dimension != 2 or surface.band_value):  # lines were dark
        data.SetActiveNormals("Normals")
    if arrays["iso_value"] is not None:
        single = particles.scalar is not None and particles.scalar.GetDataTypeAsString() == "float"
        add(data, particles.iso_value_name, arrays["iso_value"].astype(np.float32 if single else np.float64))
    scalar = particles.scalar
    one = scalar is not None and particles.dot is None and iso_count == 1 and (
        scalar.GetNumberOfComponents() == 1 or particles.choice.ScalarComponent == -1)
    varying = [name_of(array) for array in particles.interpolated if varies(array, data.GetArray(name_of(array)))
               and not (one and name_of(array) == name_of(scalar))]
    best = choose_array(data, varying + [particles.iso_value_name])
    if best is not None:
        data.SetActiveScalars(name_of(best))


def build_triangles(triangles, output):
    """With ids as vtkContourFilter's: some filters take a mesh with others for non-manifold."""
    corners = np.empty(0) if triangles is None else triangles.ravel()
    output.SetPolys(build_cells(np.arange(0, len(corners) + 1, 3), corners))


def build_lines(lines, output):
    if lines["line_offsets"] is not None:
        output.SetLines(build_cells(lines["line_offsets"], lines["line_points"]))


def build_cells(first, corners):
    offsets, connectivity, cells = vtkTypeInt64Array(), vtkTypeInt64Array(), vtkCellArray()
    for array, values in ((offsets, first), (connectivity, corners)):
        array.SetNumberOfValues(len(values))
        vtk_to_numpy(array)[:] = values
    cells.SetData(offsets, connectivity)
    return cells


def build_carried(surface, particles, data, nearest):
    for i, array in enumerate(particles.interpolated):
        if surface.attributes and surface.attributes[i]:
            components = array.GetNumberOfComponents()
            values = take(surface.attributes[i], (surface.point_count, components))
            single = array.GetDataTypeAsString() == "float"
            made = add(data, name_of(array), (values[:, 0] if components == 1 else values).astype(
                np.float32 if single else np.float64, copy=False))
            made.CopyComponentNames(array)
    if nearest is None:
        return
    for array in particles.from_nearest:
        made = from_nearest(array, nearest)
        made.SetName(name_of(array))
        made.CopyComponentNames(array)
        data.AddArray(made)


def from_nearest(array, nearest):
    if isinstance(array, vtkDataArray) and array.GetDataTypeAsString() != "bit":
        return numpy_to_vtk(vtk_to_numpy(array)[nearest], deep=True, array_type=array.GetDataType())
    made, ids = vtkAbstractArray.CreateArray(array.GetDataType()), vtkIdList()
    made.SetNumberOfComponents(array.GetNumberOfComponents())
    made.SetNumberOfTuples(len(nearest))
    ids.SetNumberOfIds(len(nearest))
    for i, particle in enumerate(nearest.tolist()):
        ids.SetId(i, particle)
    array.GetTuples(ids, made)
    return made


def left_out(surface, particles):
    for i, array in enumerate(particles.interpolated):
        particle = surface.attribute_not_finite[i] if surface.attribute_not_finite else -1
        if particle >= 0:
            yield (f"The point array '{name_of(array)}' is NaN or infinite at particle {particle} and was left "
                   "out of the surface. Correct its values, or exclude it.")


# -- field data --

def add_real(data, name, *values):
    array = vtkDoubleArray()
    array.SetNumberOfComponents(len(values))
    array.InsertNextTuple(values)
    array.SetName(name)
    data.AddArray(array)


def add_count(data, name, *values):
    array = vtkTypeInt64Array()
    array.SetNumberOfComponents(len(values))
    array.SetNumberOfTuples(1)
    for i, value in enumerate(values):
        array.SetValue(i, int(value))
    array.SetName(name)
    data.AddArray(array)


def add_text(data, name, text):
    array = vtkStringArray()
    array.InsertNextValue(text or "")
    array.SetName(name)
    data.AddArray(array)


def add_levels(data, name, counts):
    """Counts of adaptive cubes, up to the last level that has any."""
    counts = list(counts)
    while len(counts) > 1 and counts[-1] == 0:
        counts.pop()
    array = numpy_to_vtk(np.array(counts, np.int64), deep=True)
    array.SetName(name)
    data.AddArray(array)


def add_iso_values(data, options):
    array = numpy_to_vtk(np.ctypeslib.as_array(options.iso_values, (options.iso_count,)) if options.iso_count
                         else np.empty(0), deep=True)
    array.SetName("IsoValues")
    data.AddArray(array)


def add_run(data, surface, particles, arguments):
    """What a run found, used and cost."""
    s = statistics(surface.statistics)
    add_text(data, "Device", s["device"])
    add_text(data, "Platform", s["platform"])
    add_statistics(data, s, surface, arguments.options)
    add_iso_values(data, arguments.options)
    add_parameters(data, particles, arguments, s["wall_share"])
    add_run_statistics(data, surface)


def add_statistics(data, s, surface, options):
    plane = s["dimension"] == 2
    when = {"always": True, "is_run": False, "is_plane": plane, "has_levels": options.level_limit > 0,
            "has_scalar": options.field != c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"], "has_caps": options.capping > 0,
            "has_area": not plane or s["is_closed"] or options.filled, "has_volume": not plane and s["is_closed"]}
    for _, condition, member, name in c.STATISTICS:
        if name and when[condition]:
            values = s[member] if isinstance(s[member], tuple) else (s[member],)
            if len(values) > 3:
                add_levels(data, name, values)
            else:
                (add_real if isinstance(values[0], float) else add_count)(data, name, *values)
    add_real(data, "SmoothingLengthRange", s["smoothing_length_min"], s["smoothing_length_max"])
    if when["has_scalar"]:
        add_real(data, "ScalarRange", s["scalar_min"], s["scalar_max"])
    add_count(data, "Points", surface.point_count)
    add_count(data, "Triangles", surface.triangle_count)
    if plane:
        add_count(data, "Lines", surface.line_count)


def add_quantity(data, name, array):
    """The array's name, or the value for all particles where it was used."""
    add_text(data, name + "Array", (array.name or b"").decode())
    if not array.data and array.constant:
        add_real(data, name, array.constant)


def add_parameters(data, particles, arguments, wall_share):
    o, core, choice = arguments.options, arguments.input, particles.choice
    add_text(data, "Field", ("shepard", "sum", "weight_sum")[o.field])
    add_text(data, "Scalar", particles.scalar_name)
    add_text(data, "SmoothingLengthArray", (core.smoothing_length.name or b"").decode())
    add_count(data, "SmoothingLengthIsSupportRadius", core.smoothing_length_is_support_radius)
    add_count(data, "EstimateSmoothingLength", core.estimate_smoothing_length)
    add_text(data, "VolumeArray", (core.volume.name or b"").decode())
    add_quantity(data, "Mass", core.mass)
    add_quantity(data, "Density", core.density)
    add_text(data, "FluidArray", choice.FluidArrayName if particles.fluid is not None else "")
    if particles.fluid is not None:
        add_real(data, "FluidValue", choice.FluidValue)
        add_count(data, "IgnoreSolids", core.ignore_solids)
        add_real(data, "WallShare", wall_share)
    add_text(data, "Kernel", lib.mcor_sph_kernel_name(o.sph_kernel).decode())
    add_text(data, "SeedMode", ("complete", "pairs")[o.seeds])
    add_text(data, "Topology", ("table", "field")[o.topology])
    add_text(data, "Precision", ("single", "double")[o.precision])
    add_real(data, "CubeSizeFactor", o.cube_size_factor)
    add_text(data, "CubeSizeMode", "adaptive" if o.level_limit else "uniform")
    add_count(data, "CubeLevelLimit", o.level_limit)
    add_count(data, "Filled", o.filled)
    if any(o.box):
        add_real(data, "Box", *o.box)
    periodic = any(o.periodic[2 * axis] < o.periodic[2 * axis + 1] for axis in range(3))
    if periodic:
        add_real(data, "PeriodicBounds", *o.periodic)
    if periodic or o.capping:
        add_count(data, "Capping", o.capping > 0)
    add_real(data, "HScaleFactor", o.h_scale)
    add_real(data, "NodeThreshold", o.node_threshold)
    add_text(data, "BoundaryDetection", ("weight_sum", "eigenvalue")[o.boundary_detection])
    add_real(data, "VertexThreshold", o.vertex_threshold)
    add_real(data, "Tolerance", o.tolerance)
    add_count(data, "IterationLimit", o.iteration_limit)
    add_count(data, "Preview", o.preview)


def add_run_statistics(run, surface):
    """Sums over the blocks of composite data."""
    s = statistics(surface.statistics)
    seconds = {**s["seconds"], "program build": s["build_seconds"]}
    seconds["total"] = sum(seconds.values())
    array = run.GetArray("Seconds")
    if array is None:
        add_real(run, "Seconds", *[0.0] * len(seconds))
        array = run.GetArray("Seconds")
    for i, (name, value) in enumerate(seconds.items()):
        array.SetComponentName(i, name)
        array.SetComponent(0, i, array.GetComponent(0, i) + value)

    for how, when, member, name in c.STATISTICS:
        if when == "is_run":
            before = run.GetArray(name).GetComponent(0, 0) if run.HasArray(name) and how != "SAME" else 0
            add_it = add_real if how == "SAME" else add_count
            add_it(run, name, max(before, s[member]) if how == "MOST" else before + s[member])


def describe(run):
    """A line "Name: values" for each array."""
    lines = []
    for i in range(run.GetNumberOfArrays()):
        array = run.GetAbstractArray(i)
        values = ", ".join(array.GetVariantValue(v).ToString() for v in range(array.GetNumberOfValues()))
        lines.append(f"{array.GetName()}: {values}\n")
    return "".join(lines)
