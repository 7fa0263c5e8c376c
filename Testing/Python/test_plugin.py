# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the plugin in pvpython and pvbatch, or with the pvserver of with_pvserver.py. Renders nothing. test_plugin_properties.py tests traces and
states."""
import faulthandler
import math
import os
import tempfile

from paraview import servermanager
from paraview.simple import (Clip, Connect, Delete, Disconnect, GetAnimationScene, GroupDatasets, LoadPlugin, Plane,
                             PlotDataOverTime, PointSource, Wavelet, XMLPolyDataReader)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import reference, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
import numpy

PLUGIN = os.environ["MCOR_TEST_PLUGIN"]
DATA = os.environ["MCOR_TEST_DATA"]


SIDE, SPACING, RATE = 11, 0.1, 0.5  # These are for particles that turn.


def names_offered(proxy, name):
    domain = proxy.SMProxy.GetProperty(name).FindDomain("vtkSMArrayListDomain")
    return {domain.GetString(i) for i in range(domain.GetNumberOfStrings())}


def check_panel(extract):
    vectors = {"Velocity", "Vorticity"}
    scalars = {"Density", "Lambda2", "Mass", "ParticleType", "Pressure", "SmoothingLength",
               "SmoothingLengthAdaptive", "VorticityMagnitude"}
    assert names_offered(extract, "SelectInputScalars") == scalars | vectors | {"(automatic)"}
    assert list(extract.ContourBy)[-1] == "(automatic)"
    assert names_offered(extract, "SmoothingLengthArray") == scalars | {"(automatic)"}
    assert names_offered(extract, "FluidArray") == scalars | {"(automatic)"}
    assert names_offered(extract, "DotProductWith") == vectors | {"(none)"}
    assert list(extract.DotProductWith)[-1] == "(none)"
    iterator = extract.SMProxy.NewPropertyIterator()
    iterator.Begin()
    while not iterator.IsAtEnd():
        documentation = iterator.GetProperty().GetDocumentation()
        text = documentation.GetDescription() if documentation else ""
        assert text and (iterator.GetKey() == "Input" or "Default:" in text), iterator.GetKey()
        iterator.Next()


def check_surfaces(extract):
    # The default is the free surface. If FreeSurface is 0, the filter detects the fluid, and contours the velocities at their median in the
    # fluid. The surface then ends at the walls.
    assert list(extract.Isosurfaces) == []
    extract.UpdatePipeline()
    extract.UpdatePropertyInformation()
    assert float(value_of(extract, "UsedIsoValues")) == 0.5
    assert extract.GetDataInformation().GetNumberOfCells() > 100000
    extract.FreeSurface = 0
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

    assert names_offered(extract, "ExcludedArrays") >= names - {"Normals", "Velocity_Magnitude"}
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
    """Returns the value of the property with this name or label: a list, a text, or a number."""
    value = proxy.GetProperty(name)
    if hasattr(value, "__len__") and not isinstance(value, str):
        value = list(value) if len(value) != 1 or name == "Isosurfaces" else value[0]
    return str(value) if "Enumeration" in type(value).__name__ else value


def check_in_use(reader):
    """Tests what the panel shows after Apply: with walls left out, for a component, and for a dot product."""
    extract = MarchingCorrectors(Input=reader)  # noqa: F821
    extract.FluidArray = "ParticleType"
    extract.ContourBy = ["POINTS", "Velocity"]
    shown = {}
    for choice in ("Magnitude", "Y", "dot product"):
        if choice == "dot product":
            extract.DotProductWith = ["POINTS", "Vorticity"]
        else:
            extract.Component = choice
        # The range and the number of cells are known before the run. The list of iso values offers the same range.
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
    """Several changes of properties can be undone and redone in one step."""
    stack = servermanager.vtkSMUndoStack()
    builder = servermanager.vtkSMUndoStackBuilder()
    builder.SetUndoStack(stack)
    manager = servermanager.vtkSMProxyManager.GetProxyManager()
    manager.SetUndoStackBuilder(builder)
    def now():
        return [extract.CubeSizeFactor, extract.Trim, list(extract.Isosurfaces), str(extract.Kernel).strip("'")]

    # Undo keeps states from this first change on, so that undoing the next change leads back to this one.
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
    """An error gives an empty output, and the program goes on."""
    extract.Device = "no such device"
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() == 0
    extract.Device = ""
    extract.UpdatePipeline()
    assert extract.GetDataInformation().GetNumberOfCells() > 0


def check_blocks(reader):
    """The blocks of one input are one set of particles, unless they are extracted apart."""
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
    assert held[0] == held[1] and 40000 < held[0][1][1] < 44880, held  # The walls are not contoured.


def check_plugin():
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


def turned(time):
    """Returns the points and velocities of a lattice that turns around the z axis."""
    x, y, z = (numpy.mgrid[0:SIDE, 0:SIDE, 0:SIDE].reshape(3, -1) - SIDE // 2) * SPACING
    c, s = math.cos(RATE * time), math.sin(RATE * time)
    x, y = c * x - s * y, s * x + c * y
    return numpy.stack((x, y, z), 1), RATE * numpy.stack((-y, x, 0 * z), 1)


def write_step(path, time, order):
    """Writes the particles at this time to a file, in this order. Height is z; particles at the lowest z (Kind 0) are walls, all others fluid."""
    points, velocities = turned(time)
    particles = vtkPolyData()
    particles.SetPoints(vtkPoints())
    particles.GetPoints().SetData(numpy_to_vtk(points[order], deep=1))
    constant = numpy.ones(len(points))
    lowest = points[:, 2] < points[:, 2].min() + 0.5 * SPACING
    for name, values in (("Velocity", velocities), ("Height", points[:, 2].copy()), ("Idp", numpy.arange(len(points))),
                         ("Kind", numpy.where(lowest, 0, 1)),
                         ("SmoothingLength", 1.3 * SPACING * constant), ("Volume", SPACING ** 3 * constant)):
        array = numpy_to_vtk(values[order], deep=1)
        array.SetName(name)
        particles.GetPointData().AddArray(array)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(path)
    writer.SetDataModeToBinary()  # small appended data fail with VTK 9.1 and a recent expat
    writer.SetInputData(particles)
    assert writer.Write()


def arrays_of(proxy, time=None):
    proxy.UpdatePipeline(*([] if time is None else [time]))
    data = servermanager.Fetch(proxy)
    values = data.GetPointData()
    found = {values.GetArrayName(i): vtk_to_numpy(values.GetArray(i)) for i in range(values.GetNumberOfArrays())}
    return data, found


def check_probe(reader, plane):
    """A probe's points come from one input. The particles, and the names that the panel offers, come from the other."""
    probe = SPHProbe(Points=plane, Particles=reader)  # noqa: F821, LoadPlugin made it
    data, found = arrays_of(probe)
    assert data.IsA("vtkPolyData") and data.GetNumberOfPoints() == 21 * 21
    assert names_offered(probe, "ExcludedArrays") >= {"Velocity", "Height", "Idp"}
    assert names_offered(probe, "SmoothingLengthArray") >= {"(automatic)", "SmoothingLength"}
    assert names_offered(probe, "FluidArray") >= {"(automatic)", "Kind"}
    assert {"Velocity", "Height", "WeightSum", "vtkValidPointMask"} <= set(found) and "Idp" not in found
    points = vtk_to_numpy(data.GetPoints().GetData())
    inside = numpy.abs(points[:, :2]).max(1) < 0.25  # Here the whole support of the kernel is within the particles.
    outside = numpy.abs(points[:, :2]).max(1) > 0.8
    assert inside.sum() > 20 and outside.sum() > 20
    assert abs(found["WeightSum"][inside] - 1).max() < 0.02 and found["WeightSum"][outside].max() == 0
    assert found["vtkValidPointMask"][inside].all() and not found["vtkValidPointMask"][outside].any()
    expected = RATE * numpy.stack((-points[:, 1], points[:, 0], 0 * points[:, 0]), 1)
    assert abs(found["Velocity"] - expected)[inside].max() < 0.01

    probe.ExcludedArrays = ["Velocity"]
    probe.ComputeGradients = 1
    names = set(arrays_of(probe)[1])
    assert {"Height_Gradient", "WeightSum_Gradient"} <= names and "Velocity" not in names, names
    probe.Points = Wavelet(WholeExtent=[-2, 2] * 3)
    data, found = arrays_of(probe)
    assert data.IsA("vtkImageData") and {"RTData", "Height"} <= set(found)
    probe.Points = GroupDatasets(Input=[plane, plane])
    probe.UpdatePipeline()
    blocks = probe.GetDataInformation()
    assert blocks.GetCompositeDataClassName() == "vtkMultiBlockDataSet"
    assert blocks.GetNumberOfPoints() == 2 * 21 * 21 and probe.PointData.GetArray("Height")
    Delete(probe)


def check_slices(reader):
    """SPH Slice, SPH Line and SPH Volume need only particles: the panel's default places fit them."""
    cut = SPHSlice(Input=reader)  # noqa: F821
    data, found = arrays_of(cut)
    points = vtk_to_numpy(data.GetPoints().GetData())
    low, high = numpy.array(reader.GetDataInformation().GetBounds()).reshape(3, 2).T
    assert numpy.allclose(list(cut.Origin), (low + high) / 2), cut.Origin
    assert abs(points[:, 2] - cut.Origin[2]).max() < 1e-12
    assert data.GetNumberOfCells() > 100 and data.GetPointData().GetScalars().GetName() == "Velocity"
    assert numpy.isnan(found["Height"][found["vtkValidPointMask"] == 0]).all()
    assert abs(found["Velocity"][:, 2][found["vtkValidPointMask"] == 1]).max() < 1e-3
    cut.Resolution = 20
    assert arrays_of(cut)[0].GetNumberOfPoints() <= 400
    Delete(cut)
    line = SPHLine(Input=reader, Resolution=50)  # noqa: F821
    data, found = arrays_of(line)
    assert data.GetNumberOfPoints() == 50 and abs(found["arc_length"][-1] - numpy.linalg.norm(high - low)) < 1e-6
    Delete(line)
    volume = SPHVolume(Input=reader, WeightThreshold=0.4)  # noqa: F821
    data, found = arrays_of(volume)  # The output is drawn as a volume of about a million cubes.
    assert data.IsA("vtkImageData") and 0.8e6 < data.GetNumberOfPoints() < 1.3e6, data.GetDimensions()
    assert not numpy.isnan(found["Height"]).any()
    volume.Dimensions = [20, 21, 22]
    volume.NaNOutsideOfTheFluid = 1
    data, found = arrays_of(volume)
    assert data.GetDimensions() == (20, 21, 22)
    assert 0 < numpy.isnan(found["Height"]).sum() < data.GetNumberOfPoints()
    Delete(volume)


def check_gauge(reader):
    """A gauge's line runs upright through the particles, and is read over time as in the guide."""
    gauge = SPHGauge(Particles=reader, Point1=[0.0, 0.0, 0.0], Point2=[0.0, 0.0, 1.0])  # noqa: F821
    assert list(gauge.Point1) == [0.0, 0.0, 0.0] and list(gauge.Point2) == [0.0, 0.0, 1.0]  # These are not the bounds of the particles.
    gauge.Point1 = [0.0, 0.0, -1.0]
    over_time = PlotDataOverTime(Input=gauge, FieldAssociation="Rows", OnlyReportSelectionStatistics=0)
    over_time.UpdatePipeline()
    rows = over_time.GetDataInformation().GetRowDataInformation()
    names = [rows.GetArrayInformation(i).GetName() for i in range(rows.GetNumberOfArrays())]
    depth = next(rows.GetArrayInformation(name) for name in names if name.startswith("depth"))
    height = (SIDE - 1) * SPACING  # The fluid ends half a spacing beyond the lattice on either side.
    assert depth.GetNumberOfTuples() == 2 and abs(depth.GetComponentRange(0)[1] - height - SPACING) < 0.1 * SPACING, (
        depth.GetNumberOfTuples(), depth.GetComponentRange(0))
    Delete(over_time)
    Delete(gauge)


def check_flux(reader):
    """SPH Flux needs only particles: its default section fits them. Through the middle of a body that turns, the inflow equals the outflow."""
    flux = SPHFlux(Particles=reader)  # noqa: F821
    flux.UpdatePipeline(reader.TimestepValues[0])  # the body lies along the axes then
    assert numpy.allclose(flux.Origin, 0, atol=1e-6) and abs(flux.Radius - (SIDE - 1) * SPACING) < 1e-6, (flux.Origin, flux.Radius)
    rows = flux.GetDataInformation().GetRowDataInformation()
    value = {name: rows.GetArrayInformation(name).GetComponentRange(0)[0] for name in ("area", "volume_flux", "velocity")}
    assert abs(value["area"] - (SIDE * SPACING) ** 2) < 0.02 * value["area"] and abs(value["volume_flux"]) < 1e-3, value
    Delete(flux)


def check_derivatives(reader):
    derive = SPHDerivatives(Input=reader)  # noqa: F821
    assert names_offered(derive, "SelectInputArray") >= {"Velocity", "Height"}
    assert list(derive.Array) == ["POINTS", "Velocity"]  # No array is active, and this is not the first one.
    found = arrays_of(derive)[1]
    # The corrected gradient of a rotation is exact, even at the end of the fluid.
    assert found["GradientsCorrected"].all() and "StrainRate" not in found
    assert abs(found["Vorticity"] - [0, 0, 2 * RATE]).max() < 1e-4
    assert abs(found["Divergence"]).max() < 1e-4
    assert abs(found["Q-criterion"] - RATE ** 2).max() < 1e-4 and abs(found["Lambda2"] + RATE ** 2).max() < 1e-4
    derive.Array = ["POINTS", "Height"]
    found = arrays_of(derive)[1]
    assert abs(found["Gradients"] - [0, 0, 1]).max() < 1e-4 and "Vorticity" not in found
    Delete(derive)


def check_interpolator(reader):
    film = SPHTemporalInterpolator(Input=reader)  # noqa: F821
    assert names_offered(film, "IdArray") >= {"(automatic)", "Idp"}
    assert names_offered(film, "VelocityArray") >= {"(automatic)", "Velocity"}
    film.ResampleFactor = 4
    film.UpdatePipelineInformation()
    assert list(film.TimestepValues) == [0.0, 0.25, 0.5, 0.75, 1.0], film.TimestepValues
    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    assert list(scene.TimeKeeper.TimestepValues) == [0.0, 0.25, 0.5, 0.75, 1.0]
    for time in (0.0, 0.25, 0.7, 1.0):
        data, found = arrays_of(film, time)
        points = vtk_to_numpy(data.GetPoints().GetData())
        assert abs(points - turned(time)[0][found["Idp"]]).max() < 1e-3, time
    film.UseVelocities = 0
    data, found = arrays_of(film, 0.5)
    off = abs(vtk_to_numpy(data.GetPoints().GetData()) - turned(0.5)[0][found["Idp"]]).max()
    assert 5e-3 < off < 0.05, off
    Delete(film)


def check_real_data():
    reader = XMLPolyDataReader(FileName=[os.path.join(DATA, "dam_break_45k.vtp")])
    plane = Plane(Origin=[0.0, 0.0, 0.1], Point1=[3.22, 0.0, 0.1], Point2=[0.0, 1.0, 0.1], XResolution=80,
                  YResolution=25)
    probe = SPHProbe(Points=plane, Particles=reader, FluidArray="ParticleType")  # noqa: F821
    mask = arrays_of(probe)[1]["vtkValidPointMask"]
    assert 0.1 < mask.mean() < 0.4, mask.mean()
    derive = SPHDerivatives(Input=reader, FluidArray="ParticleType")  # noqa: F821
    found = arrays_of(derive)[1]
    wall = found["ParticleType"] != 0
    assert not found["Vorticity"][wall].any() and found["Vorticity"][~wall].any()
    # A file with a single step passes through the interpolator unchanged.
    film = SPHTemporalInterpolator(Input=reader)  # noqa: F821
    assert (arrays_of(film)[1]["Velocity"] == found["Velocity"]).all()


def check_field_filters():
    """Tests SPH Probe, SPH Slice, SPH Line, SPH Volume, SPH Gauge, SPH Flux, SPH Derivatives and SPH Temporal Interpolator."""
    with tempfile.TemporaryDirectory() as folder:
        steps = [os.path.join(folder, f"step_{i}.vtp") for i in range(2)]
        numbers = numpy.arange(SIDE ** 3)
        write_step(steps[0], 0.0, numbers)
        write_step(steps[1], 1.0, numbers[::-1])
        reader = XMLPolyDataReader(registrationName="particles", FileName=steps)
        plane = Plane(registrationName="plane", Origin=[-1.0, -1.0, 0.0], Point1=[1.0, -1.0, 0.0],
                      Point2=[-1.0, 1.0, 0.0], XResolution=20, YResolution=20)
        check_probe(reader, plane)
        for check in (check_slices, check_gauge, check_flux, check_derivatives, check_interpolator):
            check(reader)
    check_real_data()


def main():
    faulthandler.dump_traceback_later(500, file=2)  # If the test hangs, this shows where.
    server = os.environ.get("MCOR_TEST_SERVER")
    if server:
        Connect(server.split(":")[0], int(server.split(":")[1]))
    LoadPlugin(PLUGIN, remote=bool(server), ns=globals())
    check_field_filters()  # This comes first, because a scene has the times of all readers.
    check_plugin()
    if server:
        Disconnect()
    print("plugin works in", servermanager.vtkSMProxyManager.GetParaViewSourceVersion())


main()
