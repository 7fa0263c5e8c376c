# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes particles in pieces, and compares surfaces that come in pieces."""
import os

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter, vtkXMLPPolyDataReader


def read(file):
    reader = vtkXMLPPolyDataReader() if file.endswith(".pvtp") else vtkXMLPolyDataReader()
    reader.SetFileName(file)
    reader.Update()
    return reader.GetOutput()


def corners(surface):
    """Returns the triangles as rows of three point numbers."""
    return vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def arrays_of(surface):
    values = surface.GetPointData()
    return [values.GetArray(i) for i in range(values.GetNumberOfArrays())]


def add(data, **arrays):
    """Adds point arrays to the data, and returns it. arrays: {name: values, or a vtkAbstractArray}."""
    for name, values in arrays.items():
        array = values if hasattr(values, "GetName") else numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def particles_of(points, **arrays):
    result = vtkPolyData()
    result.SetPoints(vtkPoints())
    result.GetPoints().SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    return add(result, **arrays)


def take(whole, chosen):
    """Returns the chosen points, with their arrays and the whole's field data, but without cells."""
    arrays = {array.GetName(): vtk_to_numpy(array)[chosen] for array in arrays_of(whole)}
    part = particles_of(vtk_to_numpy(whole.GetPoints().GetData())[chosen], **arrays)
    part.SetFieldData(whole.GetFieldData())
    return part


def write(part, file):
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToBinary()
    writer.SetFileName(file)
    writer.SetInputData(part)
    assert writer.Write()


def xml_array(array):
    kind = {"float": "Float32", "double": "Float64", "int": "Int32", "unsigned char": "UInt8"}
    name, components = array.GetName() or "Points", array.GetNumberOfComponents()
    return f'<PDataArray type="{kind[array.GetDataTypeAsString()]}" Name="{name}" NumberOfComponents="{components}"/>'


def write_pieces(source, folder, count):
    """Writes the particles of a file to `count` files, each particle to a random one. Returns the .pvtp file that lists
    them."""
    whole = read(source)
    owner = np.random.default_rng(7).integers(0, count, whole.GetNumberOfPoints())
    for piece in range(count):
        write(take(whole, np.flatnonzero(owner == piece)), os.path.join(folder, f"piece_{piece}.vtp"))
    point_data = "".join(xml_array(array) for array in arrays_of(whole))
    pieces = "".join(f'<Piece Source="piece_{i}.vtp"/>' for i in range(count))
    file = os.path.join(folder, "pieces.pvtp")
    with open(file, "w", encoding="ascii") as stream:
        stream.write('<?xml version="1.0"?>\n<VTKFile type="PPolyData" version="1.0"><PPolyData GhostLevel="0">'
                     f'<PPointData>{point_data}</PPointData><PPoints>{xml_array(whole.GetPoints().GetData())}</PPoints>'
                     f'{pieces}</PPolyData></VTKFile>\n')
    return file


def difference(union, alone):
    """Returns the name of what differs, bit for bit, between the union of the pieces and the surface of one process, or
    ''."""
    numbers = vtk_to_numpy(union.GetPointData().GetArray("GlobalPointIds"))
    if not np.array_equal(np.unique(numbers), np.arange(alone.GetNumberOfPoints())):
        return "the numbers of the points"
    places = vtk_to_numpy(union.GetCellData().GetArray("GlobalCellIds"))
    if not np.array_equal(np.unique(places), np.arange(alone.GetNumberOfPolys())):
        return "the numbers of the triangles"
    if not np.array_equal(numbers[corners(union)], corners(alone)[places]):
        return "the triangles"
    pairs = [("Points", union.GetPoints().GetData(), alone.GetPoints().GetData())]
    pairs += [(a.GetName(), union.GetPointData().GetArray(a.GetName()), a) for a in arrays_of(alone)]
    for name, found, expected in pairs:
        if found is None or vtk_to_numpy(found).tobytes() != vtk_to_numpy(expected)[numbers].tobytes():
            return name
    return ""
