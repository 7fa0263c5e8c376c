# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Prints as JSON what the VTK filter (the wheel's or the C++ one, whichever is installed) says and makes of particle files.

    filter_report.py CASES.json
CASES: [[file, scalar, iso value, {property: value}]]; if the iso value is null, neither scalar nor iso value is chosen.
"""
import hashlib
import json
import re
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_STRING
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader, vtkXMLPolyDataReader

from marchingcorrectors import vtkMarchingCorrectors

# Properties that tell the filter's choices. Used...: what the last run used. Next...: the defaults for the next run.
FOUND = [f"Used{name}ArrayName" for name in ("SmoothingLength", "Volume", "Mass", "Density")] + [
    "UsedFluid", "UsedIsoValues", "IsoValueArrayName", "NextArray", "NextIsoValue", "NextScalarRange", "NextComponents",
    "NextDimension", "NextFluid", "NextCells"]
COSTS = ("Seconds", "Device", "Platform", "DeviceBytesPeak")  # These belong to one run, not to the surface.


def hash_of(array):
    if array.IsA("vtkStringArray"):
        return [array.GetValue(i) for i in range(array.GetNumberOfValues())]
    values = vtk_to_numpy(array)
    return f"{values.dtype} {values.shape} {hashlib.sha256(values.tobytes()).hexdigest()[:16]}"


def report_mesh(surface):
    """Returns hashes of a surface's parts."""
    data = surface.GetPointData()
    found = {"arrays": {data.GetArrayName(i): hash_of(data.GetAbstractArray(i)) for i in range(data.GetNumberOfArrays())}}
    if surface.GetNumberOfPoints():
        found["points"] = hash_of(surface.GetPoints().GetData())
        for part, cells in ("triangles", surface.GetPolys()), ("lines", surface.GetLines()):
            found[part] = hashlib.sha256(
                vtk_to_numpy(cells.GetConnectivityArray()).astype("i8").tobytes()).hexdigest()[:16]
    return found


def report_fields(data):
    """Returns field data by name: an array of numbers as a list, a text as a list of one."""
    arrays = [data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays())]
    return {array.GetName(): [array.GetValue(0)] if array.IsA("vtkStringArray") else vtk_to_numpy(array).ravel().tolist()
            for array in arrays if array.GetName() not in COSTS}


def report(file, scalar, value, properties):
    reader = vtkXMLMultiBlockDataReader() if file.endswith(".vtm") else vtkXMLPolyDataReader()
    extract, said = vtkMarchingCorrectors(), []
    reader.SetFileName(file)
    reader.Update()
    extract.SetInputData(reader.GetOutputDataObject(0))
    if value is not None:
        extract.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, scalar)
        extract.SetValue(0, value)
    for name, setting in properties.items():
        getattr(extract, "Set" + name)(setting)

    def keep(_, event, text):
        said.append(re.sub(r"(?s)^.*\(0x[0-9a-f]+\): ", "", text).strip())

    keep.CallDataType = VTK_STRING
    extract.AddObserver("WarningEvent", keep)
    extract.AddObserver("ErrorEvent", lambda *_: None)
    extract.Update()
    return {"warnings": said, "error": extract.GetErrorMessage(), **report_mesh(extract.GetOutput()),
            "smoothing length": extract.GetUsedSmoothingLength(), "volume": extract.GetUsedVolume(),
            "measures": extract.GetSurfaceMeasures(), "cells": f"{extract.GetEstimatedCells():.9g}",
            "fields": report_fields(extract.GetRunStatistics()),
            "found": {name: getattr(extract, "Get" + name)() for name in FOUND}}


def main():
    with open(sys.argv[1]) as file:
        cases = json.load(file)
    print("report:" + json.dumps({"class": vtkMarchingCorrectors.__module__,
                                  "cases": [report(*case) for case in cases]}))


if __name__ == "__main__":
    main()
