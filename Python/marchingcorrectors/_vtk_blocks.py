# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the particles among the points of a data set or of blocks, and joins all blocks to one set."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (vtkDataObjectTree, vtkPartitionedDataSet, vtkPointSet, vtkPolyData,
                                           vtkUnstructuredGrid)

from ._find import name_priority, tells_of_walls
from ._library import say
from ._vtk_particles import WALL_BLOCK, name_of
from ._vtk_surface import add, add_nearest
from .io.vtk_files import VERTICES, find_vertices


def walk(tree, empty=False):
    """Yields the iterator at each node. empty: also at leaves without data."""
    at = tree.NewTreeIterator()
    at.VisitOnlyLeavesOff()
    at.SetSkipEmptyNodes(not empty)
    at.InitTraversal()
    while not at.IsDoneWithTraversal():
        yield at
        at.GoToNextItem()


def leaves_of(tree, empty=False):
    """Yields (data, name, flat index, iterator) of each leaf. Partitions have the name of their block."""
    whole, last = "", 0
    for at in walk(tree, empty):
        data, index = at.GetCurrentDataObject(), at.GetCurrentFlatIndex()
        own = at.GetCurrentMetaData().Get(vtkDataObjectTree.NAME()) if at.HasCurrentMetaData() else None
        if isinstance(data, vtkPartitionedDataSet):
            whole, last = own or "", index + data.GetNumberOfPartitions()
        if data is None or not data.IsA("vtkCompositeDataSet"):
            yield data, own or (whole if index <= last else ""), index, at


def copy_of(data):
    """Returns another set with the same arrays, or another tree with the same blocks, also before VTK 9.3."""
    made = data.NewInstance()
    getattr(made, "CompositeShallowCopy", made.ShallowCopy)(data)
    return made


def sets_of(data):
    """Lists the point sets that have points: the data set itself, or its blocks."""
    return [each for each in list_all(data) if isinstance(each, vtkPointSet) and each.GetNumberOfPoints() > 0]


def cells_of(points):
    """Returns the list of cells that has the vertices, and the types of all cells. The cells of this list are numbered
    first."""
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
    """Adds the arrays that have `count` values, with the values `chosen`, unless `made` has an array of the same
    name."""
    for i, array in enumerate(map(data.GetAbstractArray, range(data.GetNumberOfArrays()))):
        if name_of(array) and not made.HasArray(name_of(array)) and array.GetNumberOfTuples() == count:
            add_nearest(made, name_of(array), array, chosen)
            attribute = data.IsArrayAnAttribute(i)
            if attribute >= 0 and made.GetAbstractAttribute(attribute) is None:
                made.SetActiveAttribute(name_of(array), attribute)


def take_vertices(data, have=None):
    """Returns the particles of a data set, or of each of its blocks, as vtkSPHTakeVertices() in C++; the data set itself if
    nothing changes."""
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
    """Joins an array's values, one block after the other. Returns None if a fluid block lacks the array, or a block of walls lacks an array
    that tells kinds of particles apart."""
    made, name = like.NewInstance(), name_of(like)
    made.SetName(name)
    made.SetNumberOfComponents(like.GetNumberOfComponents())
    made.CopyComponentNames(like)
    made.SetNumberOfTuples(joined.GetNumberOfPoints())
    at, is_type = 0, name_priority(name, "particle_type") >= 0
    for block, wall in sets:
        array, count = block.GetPointData().GetAbstractArray(name), block.GetNumberOfPoints()
        if array is None and wall and not is_type:
            for i in range(count):
                made.InsertTuple(at + i, 0, like)
        elif array is None or (array.GetDataType(), array.GetNumberOfComponents(), array.GetNumberOfTuples()) != (
                like.GetDataType(), like.GetNumberOfComponents(), count):
            return
        else:
            made.InsertTuples(at, count, 0, array)
        at += count
    joined.GetPointData().AddArray(made)


def join_blocks(tree):
    """Returns the points of all blocks, with the point arrays that all of them have. If the names of some blocks, but not
    of all, tell of walls, an array marks their points."""
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
        data = block.GetPointData()
        for array in map(data.GetAbstractArray, range(data.GetNumberOfArrays())):
            if name_of(array) and not joined.GetPointData().HasArray(name_of(array)):
                join_array(sets, array, joined)
    if some:
        marks = np.array([wall for _, wall in sets], bool)
        add(joined.GetPointData(), WALL_BLOCK, np.repeat(marks, np.array([each.GetNumberOfPoints() for each, _ in sets], int)))
    for data in reversed(list_all(tree)):  # If several arrays have one name, the first stays.
        joined.GetFieldData().PassData(data.GetFieldData())
    return joined
