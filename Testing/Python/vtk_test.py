# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles, blocks of them, and a run with all that it says, for the tests of VTK's filters."""
import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_STRING, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkMultiBlockDataSet, vtkPolyData

SPACING = 0.1


def lattice(*sides, around_origin=False):
    """Places SPACING apart in a block with so many on its sides, x running slowest."""
    places = numpy.stack(numpy.meshgrid(*map(numpy.arange, sides), indexing="ij"), -1).reshape(-1, 3).astype(float)
    return SPACING * (places - (numpy.array(sides) - 1) / 2 * around_origin)


def add(data, **arrays):
    """Point arrays of these names: {name: values, or a vtkAbstractArray}."""
    for name, values in arrays.items():
        array = values if hasattr(values, "GetName") else numpy_to_vtk(numpy.ascontiguousarray(values), deep=1)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def particles_of(points, **arrays):
    result = vtkPolyData()
    result.SetPoints(vtkPoints())
    result.GetPoints().SetData(numpy_to_vtk(numpy.ascontiguousarray(points), deep=1))
    return add(result, **arrays)


def blocks_of(*blocks, **named):
    """Blocks without names, and with them."""
    result = vtkMultiBlockDataSet()
    for i, block in enumerate((*blocks, *named.values())):
        result.SetBlock(i, block)
    for i, name in enumerate(named, len(blocks)):
        result.GetMetaData(i).Set(vtkCompositeDataSet.NAME(), name)
    return result


def run(made, data=None, **settings):
    """The output, and the sentences of errors and warnings in the order in which they came. A setting that is a tuple has
    several arguments."""
    told, tags = [], []

    def keep(_, event, text):
        told.append(text)

    keep.CallDataType = VTK_STRING
    for event in ("ErrorEvent", "WarningEvent"):
        tags.append(made.AddObserver(event, keep))
    if data is not None:
        made.SetInputData(data)
    for name, value in settings.items():
        getattr(made, "Set" + name)(*(value if isinstance(value, tuple) else (value,)))
    made.Update()
    for tag in tags:
        made.RemoveObserver(tag)
    return made.GetOutputDataObject(0) if made.GetNumberOfOutputPorts() else None, told


def values_of(data, name):
    """A point array as NumPy's."""
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def bytes_of(data):
    """Bytes of the points and all their arrays."""
    arrays = [data.GetPointData().GetArray(i) for i in range(data.GetPointData().GetNumberOfArrays())]
    return [bytes(memoryview(array)) for array in (data.GetPoints().GetData(), *arrays)]
