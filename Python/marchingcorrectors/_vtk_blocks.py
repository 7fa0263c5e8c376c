# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Blocks of composite data: what to call them, and all their particles as one set."""
from vtkmodules.vtkCommonCore import vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkDataObjectTree, vtkPartitionedDataSet, vtkPointSet, vtkPolyData

from . import _structs as c
from ._library import lib
from ._vtk_particles import WALL_BLOCK, name_of

WALL_WORDS = ("wall", "bound", "solid", "obstacle", "rigid")


def name_blocks(tree):
    """"Block 'name', index 2" of the leaves."""
    return ["Block " + (f"'{name}', " if name else "") + f"index {index}" for _, name, leaf, index in walk(tree) if leaf]


def tells_of_walls(name):
    return any(word in name.lower() for word in WALL_WORDS)


def find_walls(names):
    """A sentence where the names of some blocks, each taken by itself, tell of walls; else ""."""
    walls = [name for name in names if tells_of_walls(name)]
    if not walls or len(walls) == len(names):
        return ""
    return (f"{walls[0]} of {len(names)} seems to hold walls. Each block is taken by itself, so its particles do "
            "not affect the surfaces of the others. Set Blocks to Together.")


def walk(tree, empty=False):
    """(data, name, whether it is a leaf, flat index) of all nodes; partitions are called by the name of what they are
    parts of."""
    iterator = tree.NewTreeIterator()
    iterator.VisitOnlyLeavesOff()
    if empty:
        iterator.SkipEmptyNodesOff()
    whole, last = "", 0
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        index, data = iterator.GetCurrentFlatIndex(), iterator.GetCurrentDataObject()
        about = iterator.GetCurrentMetaData() if iterator.HasCurrentMetaData() else None
        own = about.Get(vtkDataObjectTree.NAME()) if about else None
        if isinstance(data, vtkPartitionedDataSet):
            whole, last = own or "", index + data.GetNumberOfPartitions()
        leaf = data is None or not data.IsA("vtkCompositeDataSet")
        yield data, own or (whole if index <= last else ""), leaf, index
        iterator.GoToNextItem()


def list_all(tree):
    """The data set, and all that it is made of."""
    return [tree, *(data for data, *_ in walk(tree))]


def has_array(block, like):
    array = block.GetPointData().GetAbstractArray(name_of(like))
    return array is not None and (array.GetDataType(), array.GetNumberOfComponents(), array.GetNumberOfTuples()) == (
        like.GetDataType(), like.GetNumberOfComponents(), block.GetNumberOfPoints())


def join_array(blocks, walls, like, total):
    """One after the other; None if a block lacks it that is no wall. What tells kinds of particles apart is not
    made up for walls either."""
    joined = like.NewInstance()
    joined.SetName(name_of(like))
    joined.SetNumberOfComponents(like.GetNumberOfComponents())
    joined.CopyComponentNames(like)
    joined.SetNumberOfTuples(total)
    at = 0
    kind = lib.mcor_name_priority(c.ENUMS["mcor_quantity"]["MCOR_PARTICLE_TYPE"], name_of(like).encode()) >= 0
    for block, wall in zip(blocks, walls):
        count = block.GetNumberOfPoints()
        if has_array(block, like):
            joined.InsertTuples(at, count, 0, block.GetPointData().GetAbstractArray(name_of(like)))
        elif not wall or kind or block.GetPointData().HasArray(name_of(like)):
            return None
        else:
            for i in range(count):
                joined.InsertTuple(at + i, 0, like)
        at += count
    return joined


def join_blocks(tree):
    """The points of all blocks with the point arrays that all of them have; which are of blocks with names that tell
    of walls, where some do."""
    leaves = [(data, tells_of_walls(name)) for data, name, leaf, _ in walk(tree, True) if leaf]
    some = len({wall for _, wall in leaves}) == 2
    sets = [(data, wall and some) for data, wall in leaves
            if isinstance(data, vtkPointSet) and data.GetNumberOfPoints() > 0]
    blocks, walls = [data for data, _ in sets], [wall for _, wall in sets]
    total = sum(block.GetNumberOfPoints() for block in blocks)
    joined, points = vtkPolyData(), vtkPoints()
    if any(block.GetPoints().GetDataType() != vtkPoints().GetDataType() for block in blocks):
        points.SetDataTypeToDouble()
    points.SetNumberOfPoints(total)
    at = 0
    for block in blocks:
        points.InsertPoints(at, block.GetNumberOfPoints(), 0, block.GetPoints())
        at += block.GetNumberOfPoints()
    joined.SetPoints(points)
    for block in blocks:
        data = block.GetPointData()
        for i in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(i)
            if name_of(array) and not joined.GetPointData().HasArray(name_of(array)):
                all_of_them = join_array(blocks, walls, array, total)
                if all_of_them is not None:
                    joined.GetPointData().AddArray(all_of_them)
    if some:
        marks = vtkUnsignedCharArray()
        marks.SetName(WALL_BLOCK)
        for block, wall in sets:
            for _ in range(block.GetNumberOfPoints()):
                marks.InsertNextValue(int(wall))
        joined.GetPointData().AddArray(marks)
    for data in reversed(list_all(tree)):  # of several arrays the first stays
        joined.GetFieldData().PassData(data.GetFieldData())
    return joined
