# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The plugin in pvpython and pvbatch, or in the pvserver of with_pvserver.py. Renders nothing. Traces and states:
test_plugin_properties.py."""
import faulthandler
import os

from paraview import servermanager
from paraview.simple import Clip, Connect, Delete, Disconnect, GroupDatasets, LoadPlugin, PointSource, XMLPolyDataReader
from vtkmodules.vtkCommonCore import reference
import numpy

PLUGIN = os.environ["MCOR_TEST_PLUGIN"]
DATA = os.environ["MCOR_TEST_DATA"]


def names_offered(proxy, name):
    domain = proxy.SMProxy.GetProperty(name).FindDomain("vtkSMArrayListDomain")
    return [domain.GetString(i) for i in range(domain.GetNumberOfStrings())]


def check_panel(extract):
    vectors = {"Velocity", "Vorticity"}
    scalars = {"Density", "Lambda2", "Mass", "ParticleType", "Pressure", "SmoothingLength",
               "SmoothingLengthAdaptive", "VorticityMagnitude"}
    assert set(names_offered(extract, "SelectInputScalars")) == scalars | vectors | {"(automatic)"}
    assert list(extract.ContourBy)[-1] == "(automatic)"
    assert set(names_offered(extract, "SmoothingLengthArray")) == scalars | {"(automatic)"}
    assert set(names_offered(extract, "FluidArray")) == scalars | {"(automatic)"}
    assert set(names_offered(extract, "DotProductWith")) == vectors | {"(none)"}
    assert list(extract.DotProductWith)[-1] == "(none)"
    iterator = extract.SMProxy.NewPropertyIterator()
    iterator.Begin()
    while not iterator.IsAtEnd():
        documentation = iterator.GetProperty().GetDocumentation()
        text = documentation.GetDescription() if documentation else ""
        assert text and (iterator.GetKey() == "Input" or "Default:" in text), iterator.GetKey()
        iterator.Next()


def check_surfaces(extract):
    # Nothing need be chosen: velocities, their median in the fluid, which is found, to the walls.
    assert list(extract.Isosurfaces) == []
    extract.UpdatePipeline()
    extract.UpdatePropertyInformation()
    assert value_of(extract, "UsedFluid") == "ParticleType = 0"
    assert abs(float(value_of(extract, "UsedIsoValues")) - 1.06648) < 1e-5
    assert {extract.FieldData[i].Name for i in range(len(extract.FieldData))} == {"IsoValues", "TimeValue"}
    for name in ("Pressure", "Lambda2", "Velocity"):
        extract.ContourBy = ["POINTS", name]
        extract.UpdatePipeline()
        assert extract.GetDataInformation().GetNumberOfCells() > 0, name

    extract.FluidArray = "ParticleType"
    extract.Isosurfaces = [1.0]
    extract.UpdatePipeline()
    information = extract.GetDataInformation()
    speed = information.GetNumberOfCells()
    assert 8000 < speed < 20000, speed
    names = {extract.PointData[i].Name for i in range(len(extract.PointData))}
    assert {"Normals", "Velocity_Magnitude", "Pressure", "Velocity"} <= names, names

    assert set(names_offered(extract, "ExcludedArrays")) >= names - {"Normals", "Velocity_Magnitude"}
    assert list(extract.ExcludedArrays) == []
    extract.ExcludedArrays = ["Pressure", "Lambda2"]
    extract.UpdatePipeline()
    fewer = {extract.PointData[i].Name for i in range(len(extract.PointData))}
    assert fewer == names - {"Pressure", "Lambda2"}, fewer
    extract.ExcludedArrays = []

    extract.BoundaryDetection = "Eigenvalue"
    extract.UpdatePipeline()
    assert 0 < extract.GetDataInformation().GetNumberOfCells() < speed
    extract.BoundaryDetection = "Weight sum"

    extract.Isosurfaces = [1.0, 2.0]
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() > speed

    extract.FreeSurface = 1
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() > 100000


def value_of(proxy, name):
    """The value of a property by its name or label: a list, a text, or a number."""
    value = proxy.GetProperty(name)
    if hasattr(value, "__len__") and not isinstance(value, str):
        value = list(value) if len(value) != 1 or name == "Isosurfaces" else value[0]
    return str(value) if "Enumeration" in type(value).__name__ else value


def check_in_use(reader):
    """Checks what the panel tells after Apply, for walls left out, a component and a dot product."""
    extract = MarchingCorrectors(Input=reader)  # noqa: F821
    extract.FluidArray = "ParticleType"
    extract.ContourBy = ["POINTS", "Velocity"]
    shown = {}
    for choice in ("Magnitude", "Y", "dot product"):
        if choice == "dot product":
            extract.DotProductWith = ["POINTS", "Vorticity"]
        else:
            extract.Component = choice
        # Known before the run, and what the list of iso values offers.
        extract.UpdateVTKObjects()
        extract.UpdatePropertyInformation()
        ahead = value_of(extract, "NextScalarRange")
        offered = extract.SMProxy.GetProperty("ContourValues").FindDomain("vtkSMDoubleRangeDomain")
        assert ahead == [offered.GetMinimum(0, reference(0)), offered.GetMaximum(0, reference(0))], (choice, ahead)
        extract.UpdatePipeline()
        extract.UpdatePropertyInformation()
        assert numpy.allclose(ahead, value_of(extract, "FluidScalarRange"), rtol=1e-6), (choice, ahead)
        shown[choice] = value_of(extract, "FluidScalarRange")
        value = float(value_of(extract, "UsedIsoValues"))
        assert shown[choice][0] < value < shown[choice][1], (choice, shown, value)
    assert 0 < shown["Magnitude"][0] < shown["Magnitude"][1]
    assert shown["Y"][0] < 0 < shown["Y"][1] < shown["Magnitude"][1]
    assert shown["dot product"][0] < 0 and len({tuple(each) for each in shown.values()}) == 3
    assert value_of(extract, "UsedSmoothingLength") == "0.0236 (array SmoothingLength)"
    assert value_of(extract, "UsedVolume") == "array Mass / array Density"
    assert abs(value_of(extract, "UsedCubeSize") - 0.0118) < 1e-6
    assert value_of(extract, "SurfaceMeasures").startswith("area "), value_of(extract, "SurfaceMeasures")
    assert 1e5 < value_of(extract, "EstimatedCells") < 3e5
    assert value_of(extract, "NextCells") == value_of(extract, "EstimatedCells")
    Delete(extract)


def triangles(source):
    source.UpdatePipeline()
    return source.GetDataInformation().GetNumberOfCells()


def check_undo(extract):
    """Each change of a property can be undone and redone."""
    stack = servermanager.vtkSMUndoStack()
    builder = servermanager.vtkSMUndoStackBuilder()
    builder.SetUndoStack(stack)
    manager = servermanager.vtkSMProxyManager.GetProxyManager()
    manager.SetUndoStackBuilder(builder)
    def now():
        return [extract.CubeSizeFactor, extract.Trim, list(extract.Isosurfaces), str(extract.Kernel).strip("'")]

    # States are kept from now on: the first one is what the next change is told from.
    extract.CubeSizeFactor = 0.75
    before = now()
    builder.Begin("changes")
    extract.CubeSizeFactor, extract.Trim, extract.Isosurfaces, extract.Kernel = 1.0, 0, [3.0], "Quadratic"
    builder.EndAndPushToStack()
    assert stack.CanUndo()
    stack.Undo()
    assert now() == before, (now(), before)
    stack.Redo()
    assert now() == [1.0, 0, [3.0], "Quadratic"], now()
    manager.SetUndoStackBuilder(None)
    builder.SetUndoStack(None)


def check_refusal(extract):
    """An error leaves an empty output and a program that goes on."""
    extract.Device = "no such device"
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() == 0
    extract.Device = ""
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() > 0


def check_blocks(reader):
    """Blocks of one input are one set of particles, unless they are taken apart."""
    halves = [Clip(Input=reader, ClipType="Plane", Invert=side) for side in (0, 1)]
    for half in halves:
        half.ClipType.Origin, half.ClipType.Normal = [1.5, 0, 0], [1, 0, 0]
    split, counts, held = GroupDatasets(Input=halves), [], []
    for source, blocks in ((reader, "Together"), (split, "Together"), (split, "Apart")):
        extract = MarchingCorrectors(Input=source, FreeSurface=1, Blocks=blocks)  # noqa: F821
        counts.append(triangles(extract))
        if blocks == "Together":
            pieces = SPHPieces(Surface=extract, Particles=source)  # noqa: F821
            assert triangles(pieces) == counts[-1]
            table = pieces.SMProxy.GetOutputPort(1).GetDataInformation().GetRowDataInformation()
            held.append([tuple(table.GetArrayInformation(name).GetComponentRange(0))
                         for name in ("component", "particles", "mass")])
            Delete(pieces)
        Delete(extract)
    assert counts[0] == counts[1] < counts[2], counts
    assert held[0] == held[1] and 40000 < held[0][1][1] < 44880, held  # the walls are none of it


def check_plugin(remote):
    LoadPlugin(PLUGIN, remote=remote, ns=globals())
    reader = XMLPolyDataReader(FileName=[os.path.join(DATA, "dam_break_45k.vtp")])
    reader.UpdatePipeline()
    extract = MarchingCorrectors(Input=reader)  # noqa: F821, LoadPlugin made it
    check_panel(extract)
    check_surfaces(extract)
    check_refusal(extract)
    check_in_use(reader)
    check_blocks(reader)
    check_undo(extract)

    # Points without any array have a free surface, too.
    cloud = PointSource(NumberOfPoints=2000, Radius=1.0)
    bare = MarchingCorrectors(Input=cloud)  # noqa: F821
    bare.FreeSurface = 1
    bare.EstimateSmoothingLength = 1
    bare.UpdatePipeline()
    assert bare.GetDataInformation().GetNumberOfCells() > 0


def main():
    faulthandler.dump_traceback_later(500, file=2)  # where it stands, if it stands
    server = os.environ.get("MCOR_TEST_SERVER")
    if server:
        Connect(server.split(":")[0], int(server.split(":")[1]))
    check_plugin(remote=bool(server))
    if server:
        Disconnect()
    print("plugin works in", servermanager.vtkSMProxyManager.GetParaViewSourceVersion())


main()
