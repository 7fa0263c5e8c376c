# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The plugin in pvpython and pvbatch, or with --server PROGRAM in a pvserver. Renders nothing."""
import os
import subprocess
import sys

from paraview import servermanager
from paraview.simple import (Connect, Disconnect, LoadPlugin, PointSource, XMLPolyDataReader)

PLUGIN = os.environ["MCOR_TEST_PLUGIN"]
DATA = os.environ["MCOR_TEST_DATA"]


def connect_to_new_server(program):
    """Starts a server on a free port. The server waits for one client, and ends with it."""
    port = 20000 + os.getpid() % 20000
    server = subprocess.Popen([program, "--server-port=%d" % port], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True)
    for line in server.stdout:
        if "Accepting connection" in line:
            break
    Connect("localhost", port)
    return server


def names_offered(proxy, name):
    domain = proxy.SMProxy.GetProperty(name).FindDomain("vtkSMArrayListDomain")
    return [domain.GetString(i) for i in range(domain.GetNumberOfStrings())]


def check_panel(extract):
    vectors = {"Velocity", "Vorticity"}
    scalars = {"Density", "Lambda2", "Mass", "ParticleType", "Pressure", "SmoothingLength",
               "SmoothingLengthAdaptive", "VorticityMagnitude"}
    assert set(names_offered(extract, "SelectInputScalars")) == scalars | vectors
    assert set(names_offered(extract, "SmoothingLengthArray")) == scalars | {"(automatic)"}
    assert set(names_offered(extract, "FluidArray")) == scalars | {"(none)"}
    assert set(names_offered(extract, "DotProductWith")) == vectors | {"(none)"}
    iterator = extract.SMProxy.NewPropertyIterator()
    iterator.Begin()
    while not iterator.IsAtEnd():
        documentation = iterator.GetProperty().GetDocumentation()
        text = documentation.GetDescription() if documentation else ""
        assert text and (iterator.GetKey() == "Input" or "Default:" in text), iterator.GetKey()
        iterator.Next()


def check_surfaces(extract):
    # Choosing a scalar is enough: without an iso value, the middle of its range is taken.
    assert list(extract.Isosurfaces) == []
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


def check_refusal(extract):
    """An error leaves an empty output and a program that goes on."""
    extract.Device = "no such device"
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() == 0
    extract.Device = ""
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() > 0


def check_plugin(remote):
    LoadPlugin(PLUGIN, remote=remote, ns=globals())
    reader = XMLPolyDataReader(FileName=[os.path.join(DATA, "dam_break_45k.vtp")])
    reader.UpdatePipeline()
    extract = MarchingCorrectors(Input=reader)  # noqa: F821, LoadPlugin made it
    check_panel(extract)
    check_surfaces(extract)
    check_refusal(extract)

    # Points without any array have a free surface, too.
    cloud = PointSource(NumberOfPoints=2000, Radius=1.0)
    bare = MarchingCorrectors(Input=cloud)  # noqa: F821
    bare.FreeSurface = 1
    bare.EstimateSmoothingLength = 1
    bare.UpdatePipeline()
    assert bare.GetDataInformation().GetNumberOfCells() > 0


def main():
    if "--server" not in sys.argv:
        check_plugin(remote=False)
    else:
        server = connect_to_new_server(sys.argv[sys.argv.index("--server") + 1])
        try:
            check_plugin(remote=True)
            Disconnect()
        finally:
            server.terminate()
            server.wait()
    print("plugin works in", servermanager.vtkSMProxyManager.GetParaViewSourceVersion())


main()
