# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the core's arguments from VTK's data sets: from one set, or from all blocks joined to one set; the core finds the arrays. Makes a
vtkPolyData from a surface, and puts a run's results, settings and costs into a vtkFieldData, like vtkMarchingCorrectorsOutput."""
import ctypes
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkAbstractArray, vtkDataArray, vtkDoubleArray, vtkPoints, vtkStringArray, vtkTypeInt64Array
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkDataObject, vtkDataObjectTree, vtkPartitionedDataSet, vtkPointSet, vtkPolyData,
                                           vtkUnstructuredGrid)

from . import _structs as c
from ._arrays import QUANTITIES, ROLES, Arguments, as_bytes, list_named, name_priority, place_period, tells_of_walls
from ._library import InvalidArgument, lib, say
from ._options import camel
from .io.vtk_files import VERTICES, find_vertices

GHOSTS = "vtkGhostType"
# These options are not written to the field data, because users do not look for them, or because statistics show them.
NOT_TOLD = ("", "Dimension", "CubeSize", "WallShare")
WALL_BLOCK = "WallBlock"  # In blocks that are one set, this array says whether the block's name tells of walls.


def name_of(array):
    return (array.GetName() if array is not None else None) or ""


def abstract_arrays_of(data):
    return [data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays())]


def is_single(array):
    return array.GetDataTypeAsString() == "float"


def to_numpy(array):
    """Returns the array's values without a copy, or a copy if they are bits or do not lie in one piece."""
    if not array.HasStandardMemoryLayout() or array.GetDataTypeAsString() == "bit":
        copy = vtkDataArray.CreateDataArray(3 if array.GetDataTypeAsString() == "bit" else array.GetDataType())
        copy.DeepCopy(array)
        array = copy
    return vtk_to_numpy(array)


def named(data):
    """Returns (name, values) of all arrays, for the core. Arrays without numbers, such as texts, have a shape in place of values."""
    return [(array.GetName(), to_numpy(array) if isinstance(array, vtkDataArray) else SimpleNamespace(
        shape=(array.GetNumberOfTuples(), array.GetNumberOfComponents()))) for array in abstract_arrays_of(data)]


def choose_array(arrays):
    """Returns the array that is best to show if the user has chosen none; None if there is no such array."""
    best = lib.mcor_choose_view(*list_named([(array.GetName(), to_numpy(array)) for array in arrays]), -1, None)
    return None if best < 0 else arrays[best]


def varies(array, on_surface):
    """Whether the array varies on the surface by more than noise. Vectors count by their magnitudes."""
    if on_surface is None or on_surface.GetNumberOfTuples() == 0:
        return False
    kind = -1 if array.GetNumberOfComponents() > 1 else 0
    (low, high), (least, most) = on_surface.GetRange(kind), array.GetRange(kind)
    return high - low > 0.03 * (most - least)


def find_period(points):
    """Returns two values: the six bounds of the period that field data tell, or None; the nine numbers of a tilted cell, or None."""
    found, period, cell = [], (ctypes.c_double * 6)(), None
    for array in abstract_arrays_of(points.GetFieldData()):
        name = as_bytes(name_of(array))
        if isinstance(array, vtkDataArray) and lib.mcor_tells_of_period(name):
            numbers = to_numpy(array).ravel()
            cell = numbers.tolist() if len(numbers) == 9 else cell
            values = (ctypes.c_double * max(len(numbers), 1))(*numbers[:9])
            found.append(c.mcor_field_data(name=name, values=values, count=len(numbers)))
    count = lib.mcor_find_period((c.mcor_field_data * max(len(found), 1))(*found), len(found), period, None)
    bounds = place_period(period[:3], points.GetBounds()) if count == 3 else list(period) if count else None
    return bounds, None if bounds else cell


class Request(NamedTuple):
    """The point array to contour: its name, or the index of the active array. on_points: False for an array of cells."""
    name: str = ""
    on_points: bool = True
    active: int = -1


def request_of(algorithm, index, points):
    """Returns the request that the user has made by SetInputArrayToProcess()."""
    info, kind, data = algorithm.GetInputArrayInformation(index), vtkDataObject.FIELD_ATTRIBUTE_TYPE(), points.GetPointData()
    name = info.Get(vtkDataObject.FIELD_NAME()) or ""
    is_chosen, is_active = name not in ("", "(automatic)"), not name and info.Has(kind)
    if not is_chosen and not is_active:
        return Request()
    # Arrays of cells may have become the particles' arrays, see take_vertices().
    on_points = bool(is_chosen and data.HasArray(name)) or info.Get(vtkDataObject.FIELD_ASSOCIATION()) in (
        vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataObject.FIELD_ASSOCIATION_POINTS_THEN_CELLS)
    array = data.GetAbstractAttribute(info.Get(kind)) if on_points and is_active else None
    active = next((i for i, each in enumerate(abstract_arrays_of(data)) if each is array), -1)
    return Request(name if is_chosen else "", on_points, active)


# -- particles among the points of a set or of blocks --

def walk(tree, empty=False):
    """Yields the iterator at each node. empty: leaves without data are nodes, too."""
    at = tree.NewTreeIterator()
    at.VisitOnlyLeavesOff()
    at.SetSkipEmptyNodes(not empty)
    at.InitTraversal()
    while not at.IsDoneWithTraversal():
        yield at
        at.GoToNextItem()


def leaves_of(tree, empty=False):
    """Yields (data, name, flat index, iterator) of each leaf. A partition without a name has the name of its block."""
    whole, last = "", 0
    for at in walk(tree, empty):
        data, index = at.GetCurrentDataObject(), at.GetCurrentFlatIndex()
        own = at.GetCurrentMetaData().Get(vtkDataObjectTree.NAME()) if at.HasCurrentMetaData() else None
        if isinstance(data, vtkPartitionedDataSet):
            whole, last = own or "", index + data.GetNumberOfPartitions()
        if data is None or not data.IsA("vtkCompositeDataSet"):
            yield data, own or (whole if index <= last else ""), index, at


def copy_of(data):
    """Returns a shallow copy: a set with the same arrays, or a tree with the same blocks. Works before VTK 9.3, too."""
    made = data.NewInstance()
    getattr(made, "CompositeShallowCopy", made.ShallowCopy)(data)
    return made


def sets_of(data):
    """Lists the point sets that have points: the data set itself, or its blocks."""
    return [each for each in list_all(data) if isinstance(each, vtkPointSet) and each.GetNumberOfPoints() > 0]


def cells_of(points):
    """Returns the vtkCellArray with the vertices of poly data, or with all cells of an unstructured grid, else None; and the type of each
    cell of the data. The types of the cells in the vtkCellArray come first; the type of other cells may be 0."""
    if isinstance(points, vtkPolyData):
        vertices = points.GetNumberOfVerts()
        return points.GetVerts(), np.repeat([VERTICES[0], 0], [vertices, points.GetNumberOfCells() - vertices])
    if isinstance(points, vtkUnstructuredGrid) and points.GetNumberOfCells() > 0:
        try:
            return points.GetCells(), vtk_to_numpy(points.GetCellTypes())
        except TypeError:  # before VTK 9.6
            return points.GetCells(), vtk_to_numpy(points.GetCellTypesArray())
    return None, np.zeros(points.GetNumberOfCells(), int)


def add_values(data, count, chosen, made):
    """Adds to `made` the values `chosen` of each array that has `count` values, unless `made` has an array of the same
    name."""
    for i, array in enumerate(abstract_arrays_of(data)):
        if name_of(array) and not made.HasArray(name_of(array)) and array.GetNumberOfTuples() == count:
            add_nearest(made, name_of(array), array, chosen)
            attribute = data.IsArrayAnAttribute(i)
            if attribute >= 0 and made.GetAbstractAttribute(attribute) is None:
                made.SetActiveAttribute(name_of(array), attribute)


def take_vertices(data, have=None):
    """Returns the particles of a data set, or of each of its blocks, as vtkSPHTakeVertices() in C++ does, but as a vtkPolyData
    without cells. Returns the data set itself if nothing has to change. have: whether any block has vertices; None: looks for them."""
    if have is None:
        have = any(np.isin(cells_of(points)[1], VERTICES).any() for points in sets_of(data))
    if isinstance(data, vtkDataObjectTree):
        made = data
        for block, _, _, at in leaves_of(data):
            taken = take_vertices(block, have)
            if taken is not block:
                made = copy_of(data) if made is data else made
                made.SetDataSet(at, taken)
        return made
    count = data.GetNumberOfPoints() if isinstance(data, vtkPointSet) else 0
    if count == 0 or data.GetNumberOfCells() == 0:
        return data
    (cells, types), found = cells_of(data), np.full(count, -1)
    is_vertex = np.isin(types, VERTICES)
    is_mesh = have and not is_vertex.all()
    if not is_mesh and not (is_vertex.any() and data.GetCellData().GetNumberOfArrays()):
        return data
    if is_vertex.any():
        offsets = vtk_to_numpy(cells.GetOffsetsArray())
        offsets = np.append(offsets, np.full(len(types) + 1 - len(offsets), offsets[-1]))
        found = find_vertices(types, offsets, vtk_to_numpy(cells.GetConnectivityArray()), count)
    chosen = np.flatnonzero(found >= 0)
    if not is_mesh and len(chosen) < count:
        return data
    particles = vtkPolyData()
    particles.SetPoints(vtkPoints())
    particles.GetPoints().SetData(numpy_to_vtk(vtk_to_numpy(data.GetPoints().GetData())[chosen], deep=True))
    add_values(data.GetPointData(), count, chosen, particles.GetPointData())
    add_values(data.GetCellData(), len(types), found[chosen], particles.GetPointData())  # These are arrays of the vertices.
    particles.SetFieldData(data.GetFieldData())
    return particles


def describe_mesh(data, taken):
    """Returns a sentence if points of the data are no particles, else ""."""
    left, count = (sum(points.GetNumberOfPoints() for points in sets_of(each)) for each in (taken, data))
    return say("MESH_NODES", count - left, count, "", "") if left < count else ""


def list_all(data):
    """Lists the data set itself and all its blocks, at any depth."""
    return [data, *(at.GetCurrentDataObject() for at in walk(data))] if isinstance(data, vtkDataObjectTree) else [data]


def join_array(sets, like, joined):
    """Joins an array's values, one block after the other, as doubles if their types differ, and adds the array to `joined`. Walls that lack
    the array get the first values of `like`. Adds nothing if a fluid block lacks the array, if a block of walls lacks an array that tells
    kinds of particles apart, or if a block's array of this name has another size, or another type and one of the two holds no numbers."""
    name, parts, at = name_of(like), [], 0
    is_type = name_priority(name, "particle_type") >= 0
    for block, wall in sets:
        array, count = block.GetPointData().GetAbstractArray(name), block.GetNumberOfPoints()
        is_left_out = array is None and wall and not is_type
        if not is_left_out and (array is None or (array.GetNumberOfComponents(), array.GetNumberOfTuples()) != (
                like.GetNumberOfComponents(), count) or array.GetDataType() != like.GetDataType() and not (array.IsNumeric() and like.IsNumeric())):
            return
        parts.append((array, count))
    differ = any(array is not None and array.GetDataType() != like.GetDataType() for array, _ in parts)
    made = vtkDoubleArray() if differ else like.NewInstance()
    made.SetName(name)
    made.SetNumberOfComponents(like.GetNumberOfComponents())
    made.CopyComponentNames(like)
    made.SetNumberOfTuples(joined.GetNumberOfPoints())
    for array, count in parts:
        if array is not None:
            made.InsertTuples(at, count, 0, array)
        for i in range(count if array is None else 0):
            made.InsertTuple(at + i, 0, like)
        at += count
    joined.GetPointData().AddArray(made)


def join_blocks(tree):
    """Returns the points of all blocks, with the point arrays that all of them have, or that only walls lack. If the names of
    some blocks, but not of all, tell of walls, the array WALL_BLOCK marks the points of walls."""
    leaves = [(data, tells_of_walls(name)) for data, name, *_ in leaves_of(tree, True)]
    some = len({wall for _, wall in leaves}) == 2
    sets = [(data, wall and some) for data, wall in leaves
            if isinstance(data, vtkPointSet) and data.GetNumberOfPoints() > 0]
    joined, points = vtkPolyData(), vtkPoints()
    if any(block.GetPoints().GetDataType() != points.GetDataType() for block, _ in sets):
        points.SetDataTypeToDouble()
    for block, _ in sets:
        points.InsertPoints(points.GetNumberOfPoints(), block.GetNumberOfPoints(), 0, block.GetPoints())
    joined.SetPoints(points)
    for block, _ in sets:
        for array in abstract_arrays_of(block.GetPointData()):
            if name_of(array) and not joined.GetPointData().HasArray(name_of(array)):
                join_array(sets, array, joined)
    if some:
        marks = np.array([wall for _, wall in sets], bool)
        add(joined.GetPointData(), WALL_BLOCK, np.repeat(marks, np.array([each.GetNumberOfPoints() for each, _ in sets], int)))
    for data in reversed(list_all(tree)):  # If several arrays have one name, the first stays.
        joined.GetFieldData().PassData(data.GetFieldData())
    return joined


def describe_lost(blocks, joined):
    """Returns a sentence that names the arrays of blocks that join_blocks() did not take, or ""."""
    lost = {name_of(array) for block in sets_of(blocks) for array in abstract_arrays_of(block.GetPointData())
            if name_of(array) and not joined.GetPointData().HasArray(name_of(array))} - {GHOSTS}
    return say("ARRAYS_NOT_SHARED", ", ".join(sorted(lost))) if lost else ""


# -- quantities --

class Particles(Arguments):
    """Arguments whose quantities the core finds among the point arrays. If something is missing, raises InvalidArgument, whose member
    `particles` has what was found.

    choice: a copy of the filter's properties. wants: names of mcor_want. requests: two, for the scalar and for the second
    vector of a dot product.
    """

    def __init__(self, choice, points, wants, requests=(Request(), Request()), taken=(), options=None):
        super().__init__(to_numpy(points.GetPoints().GetData()), options)
        (scalar, dot), data, component = requests, points.GetPointData(), choice.ScalarComponent
        self.choice, self.points, self._arrays, self._summed = choice, points, abstract_arrays_of(data), {}
        names = {name: getattr(choice, camel(name) + "ArrayName") for name in (*QUANTITIES, "fluid")}
        chosen = data.GetAbstractArray(scalar.name) if scalar.name else None if scalar.active < 0 else self._arrays[scalar.active]
        label = chosen.GetComponentName(component) if chosen is not None and component >= 0 else None
        self.find(
            named(data), wants, {**names, "scalar": scalar.name, "scalar_dot": dot.name},
            {name: getattr(choice, camel(name)) for name in ("smoothing_length", "mass", "density")},
            only=choice.Only, taken=taken, excluded=choice.ExcludedArrays, find=choice.DetectArrays, active=scalar.active,
            lengths_by_neighbours=choice.SmoothingLengthEstimate, find_fluid=choice.DetectFluid, has_iso_values=choice.ComputeScalars,
            **{name: getattr(choice, camel(name)) for name in (
                "compute_volumes", "particle_volume", "estimate_smoothing_length", "smoothing_length_is_support_radius", "fluid_value",
                "ignore_solids", "free_surface", "scalar_component", "within", "filled")},
            label=None if label is None else as_bytes(label),
            not_on_points=(not scalar.on_points) << ROLES["scalar"] | (not dot.on_points) << ROLES["scalar_dot"])
        made = [self._wrap(*self.made(i)) if self.found.made[i].name else None for i in range(2)]
        self._arrays += made  # The core numbers the arrays that it made behind the others.
        self.scalar, self.dot = self.array_for("scalar"), self.array_for("scalar_dot")
        try:
            if self.error:
                raise InvalidArgument(self.error)
            self.sum_over_neighbours(choice.NeighborRatio)
        except InvalidArgument as error:
            error.particles = self
            raise
        self.scalar = self._summed.get("Density", self.scalar)
        self.interpolated, self.from_nearest = (
            {name_of(self._arrays[i]): self._arrays[i] for i in indices[:count]} for indices, count in (
                (self.found.attributes, self.input.attribute_count), (self.found.nearest, self.found.nearest_count)))
        self.kinds = {name: ((array.GetNumberOfComponents(),) if array.GetNumberOfComponents() > 1 else (),
                             c.ENUMS["mcor_type"]["MCOR_FLOAT32" if is_single(array) else "MCOR_FLOAT64"])
                      for name, array in self.interpolated.items()}
        self.scalar_name, self.iso_value_name = self.text("scalar_name"), self.text("iso_value_name")
        whole = self.scalar is not None and self.dot is None and (self.scalar.GetNumberOfComponents() == 1 or component < 0)
        # The name of the contoured array: a scalar, or a vector whose magnitude is contoured. None for a component or a dot product.
        self.contoured = name_of(self.scalar) if whole else None

    @staticmethod
    def _wrap(name, values):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        return array

    def array_for(self, role):
        index = self.found.which[ROLES[role]]
        return None if index < 0 else self._arrays[index]

    @property
    def fluid(self):
        return self.array_for("fluid")

    @property
    def used(self):
        """Returns {quantity: array} of the arrays that the run uses."""
        summed = dict(self._summed)
        if self.input.density.data != self.input.scalar.data:
            summed.pop("Density", None)  # It is the scalar alone.
        return {name: summed[camel(name)] if camel(name) in summed else self.array_for(name) for name in QUANTITIES}

    def describe_fluid(self):
        return "" if self.fluid is None else f"{name_of(self.fluid)} = {self.found.fluid_value:g}"

    def sums(self, name, function, *more):
        """Returns what Arguments.sums() returns. Keeps these sums for the next run, which computes new ones only if the particles, or the
        options on which the sums depend, have changed."""
        key = (*self.signatures()[0], self.options.sph_kernel, self.options.dimension, *self.options.periodic, *more)
        if self.choice.Made.get(name, (None,))[0] != key:
            self.choice.Made[name] = key, self._wrap(name, super().sums(name, function, *more))
        self._summed[name] = self.choice.Made[name][1]
        return to_numpy(self._summed[name])

    def has_free_surface(self):
        """Returns whether a user who chooses no array and no iso value sees the free surface. The core gets the densities, which
        tell a liquid, even if no volumes are made from them."""
        given = c.mcor_input.from_buffer_copy(self.input)
        given.density = self.found.views[ROLES["density"]]
        return lib.mcor_has_free_surface(ctypes.byref(given), None)

    def estimate_cells(self):
        given = ctypes.byref(self.input)
        return lib.mcor_estimate_cells(given, ctypes.byref(self.options), lib.mcor_least_smoothing_length(given))

    def signatures(self):
        """Returns three marks. The first changes if the particles change, the second with the scalar, the third with the options on which
        the factors of smoothing lengths depend. The first mark also has the data set's time, because users change arrays in place, and
        then call only the data set's Modified()."""

        def sign(thing):
            return None if thing is None else (thing.__this__, thing.GetMTime())

        choice, given, options = self.choice, self.input, self.options
        particles = [sign(thing) for thing in (self.points, self.points.GetPoints().GetData(), self.fluid, *self.used.values())]
        particles += [self.found.fluid_value, choice.Kernel, *(getattr(given, name).constant for name in QUANTITIES),
                      given.smoothing_length_is_support_radius, given.estimate_smoothing_length, given.ignore_solids,
                      tuple(choice.Within), *choice.Only]
        is_free = options.field == c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
        values = [options.wall_share, *(options.iso_values[:options.iso_count] if is_free else [])]
        for name, (_, scope, _) in c.OPTIONS.items():
            value = getattr(options, name)
            values += [] if scope == ["SURFACE", "KEEPS"] else value[:] if isinstance(value, ctypes.Array) else [value]
        return particles, [sign(self.scalar), sign(self.dot), given.scalar_component], values


# -- surfaces, and field data --

def add(data, name, values):
    """Adds an array of these values, with a tuple for each row, and returns the array. A text gives one tuple."""
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
    """Adds an array called `name`: for each particle number in `nearest`, the value of `array`, which may have any type."""
    if isinstance(array, vtkDataArray) and array.GetDataTypeAsString() != "bit":
        made = numpy_to_vtk(vtk_to_numpy(array)[nearest], deep=True, array_type=array.GetDataType())
    else:
        made = vtkAbstractArray.CreateArray(array.GetDataType())
        made.SetNumberOfComponents(array.GetNumberOfComponents())
        made.SetNumberOfTuples(len(nearest))
        for i, particle in enumerate(nearest.tolist()):
            made.SetTuple(i, particle, array)
    made.SetName(name)
    made.CopyComponentNames(array)
    data.AddArray(made)


def add_run(run, found, particles):
    """Adds a run's results, settings and costs. If there are several blocks, their costs are summed; of peaks, the greatest one is kept."""
    s, o = found.statistics, particles.options
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
    add_parameters(run, particles, s["wall_share"])


def add_iso_values(data, options):
    add(data, "IsoValues", np.array(options.iso_values[:options.iso_count], float))


def add_parameters(data, particles, wall_share):
    o, given, has_fluid = particles.options, particles.input, particles.fluid is not None
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
