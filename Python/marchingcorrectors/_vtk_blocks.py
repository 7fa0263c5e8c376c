# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Blocks of composite data: what to call them, and all their particles as one set."""
from vtkmodules.vtkCommonCore import vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkDataObjectTree, vtkPartitionedDataSet, vtkPointSet, vtkPolyData

from . import _structs as c
from ._library import lib
from ._vtk_particles import WALL_BLOCK, name_of

WALL_WORDS = ("wall", "bound", "solid", "obstacle", "rigid")


def walk(tree, empty=False):
    """(data, name, whether it is a leaf, flat index) of all nodes; partitions are called by the name of what they are
    parts of."""
    iterator, whole, last = tree.NewTreeIterator(), "", 0
    iterator.VisitOnlyLeavesOff()
    iterator.SetSkipEmptyNodes(not empty)
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        index, data = iterator.GetCurrentFlatIndex(), iterator.GetCurrentDataObject()
        about = iterator.GetCurrentMetaData() if iterator.HasCurrentMetaData() else None
        own = about.Get(vtkDataObjectTree.NAME()) if about else None
        if isinstance(data, vtkPartitionedDataSet):
            whole, last = own or "", index + data.GetNumberOfPartitions()
        yield data, own or (whole if index <= last else ""), data is None or not data.IsA("vtkCompositeDataSet"), index
        iterator.GoToNextItem()


def name_blocks(tree):
    """"Block 'name', index 2" of the leaves."""
    return ["Block " + (f"'{name}', " if name else "") + f"index {index}" for _, name, leaf, index in walk(tree) if leaf]


def list_all(tree):
    """The data set, and all that it is made of."""
    return [tree, *(data for data, *_ in walk(tree))]


def tells_of_walls(name):
    return any(word in name.lower() for word in WALL_WORDS)


def find_walls(names):
    """A sentence where the names of some blocks, each taken by itself, tell of walls; else ""."""
    walls = [name for name in names if tells_of_walls(name)]
    if not walls or len(walls) == len(names):
        return ""
    return (f"{walls[0]} of {len(names)} seems to hold walls. Each block is taken by itself, so its particles do "
            "not affect the surfaces of the others. Set Blocks to Together.")


def join_array(sets, like, joined):
    """One after the other; not if a block lacks it that is no wall. What tells kinds of particles apart is not made up
    for walls either."""
    made, name = like.NewInstance(), name_of(like)
    made.SetName(name)
    made.SetNumberOfComponents(like.GetNumberOfComponents())
    made.CopyComponentNames(like)
    made.SetNumberOfTuples(joined.GetNumberOfPoints())
    at, is_type = 0, lib.mcor_name_priority(c.ENUMS["mcor_quantity"]["MCOR_PARTICLE_TYPE"], name.encode()) >= 0
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
    """The points of all blocks with the point arrays that all of them have; which are of blocks with names that tell
    of walls, where some do."""
    leaves = [(data, tells_of_walls(name)) for data, name, leaf, _ in walk(tree, True) if leaf]
    some = len({wall for _, wall in leaves}) == 2
    sets = [(data, wall and some) for data, wall in leaves
            if isinstance(data, vtkPointSet) and data.GetNumberOfPoints() > 0]
    joined, points, marks = vtkPolyData(), vtkPoints(), vtkUnsignedCharArray()
    if any(block.GetPoints().GetDataType() != points.GetDataType() for block, _ in sets):
        points.SetDataTypeToDouble()
    marks.SetName(WALL_BLOCK)
    for block, wall in sets:
        points.InsertPoints(points.GetNumberOfPoints(), block.GetNumberOfPoints(), 0, block.GetPoints())
        for _ in range(block.GetNumberOfPoints()):
            marks.InsertNextValue(int(wall))
    joined.SetPoints(points)
    for block, _ in sets:
        data = block.GetPointData()
        for array in map(data.GetAbstractArray, range(data.GetNumberOfArrays())):
            if name_of(array) and not joined.GetPointData().HasArray(name_of(array)):
                join_array(sets, array, joined)
    if some:
        joined.GetPointData().AddArray(marks)
    for data in reversed(list_all(tree)):  # of several arrays the first stays
        joined.GetFieldData().PassData(data.GetFieldData())
    return joined
