# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""SPH Probe, SPH Derivatives and SPH Temporal Interpolator in pvpython, or in the pvserver of
with_pvserver.py. Renders nothing. Traces and states: test_plugin_properties.py."""
import faulthandler
import math
import os
import tempfile

from paraview import servermanager
from paraview.simple import (Connect, Delete, Disconnect, GetAnimationScene, GroupDatasets, LoadPlugin, Plane,
                             PlotDataOverTime, Wavelet, XMLPolyDataReader)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
import numpy

PLUGIN = os.environ["MCOR_TEST_PLUGIN"]
DATA = os.environ["MCOR_TEST_DATA"]
SIDE, SPACING, RATE = 11, 0.1, 0.5
def turned(time):
    """A lattice, turned around the z axis: points and velocities."""
    x, y, z = (numpy.mgrid[0:SIDE, 0:SIDE, 0:SIDE].reshape(3, -1) - SIDE // 2) * SPACING
    c, s = math.cos(RATE * time), math.sin(RATE * time)
    x, y = c * x - s * y, s * x + c * y
    return numpy.stack((x, y, z), 1), RATE * numpy.stack((-y, x, 0 * z), 1)


def write_step(path, time, order):
    """Particles in this order. Height is z; all but those at the lowest z, of Kind 0, are fluid."""
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


def strings_offered(proxy, name):
    domain = proxy.SMProxy.GetProperty(name).FindDomain("vtkSMArrayListDomain")
    return {domain.GetString(i) for i in range(domain.GetNumberOfStrings())}


def arrays_of(proxy, time=None):
    proxy.UpdatePipeline(*([] if time is None else [time]))
    data = servermanager.Fetch(proxy)
    values = data.GetPointData()
    found = {values.GetArrayName(i): vtk_to_numpy(values.GetArray(i)) for i in range(values.GetNumberOfArrays())}
    return data, found


def check_probe(reader, plane):
    """The points come from one input, the particles and the names in the panel from the other."""
    probe = SPHProbe(Points=plane, Particles=reader)  # noqa: F821, LoadPlugin made it
    data, found = arrays_of(probe)
    assert data.IsA("vtkPolyData") and data.GetNumberOfPoints() == 21 * 21
    assert strings_offered(probe, "ExcludedArrays") >= {"Velocity", "Height", "Idp"}
    assert strings_offered(probe, "SmoothingLengthArray") >= {"(automatic)", "SmoothingLength"}
    assert strings_offered(probe, "FluidArray") >= {"(automatic)", "Kind"}
    assert {"Velocity", "Height", "WeightSum", "vtkValidPointMask"} <= set(found) and "Idp" not in found
    points = vtk_to_numpy(data.GetPoints().GetData())
    inside = numpy.abs(points[:, :2]).max(1) < 0.25  # the kernel's support is whole there
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
    """Particles in, and the panel's own place: nothing else need be chosen."""
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
    data, found = arrays_of(volume)  # to be drawn as a volume, with about a million cubes
    assert data.IsA("vtkImageData") and 0.8e6 < data.GetNumberOfPoints() < 1.3e6, data.GetDimensions()
    assert not numpy.isnan(found["Height"]).any()
    volume.Dimensions = [20, 21, 22]
    volume.NaNOutsideOfTheFluid = 1
    data, found = arrays_of(volume)
    assert data.GetDimensions() == (20, 21, 22)
    assert 0 < numpy.isnan(found["Height"]).sum() < data.GetNumberOfPoints()
    Delete(volume)


def check_gauge(reader):
    """A line upright through the particles, over time as the guide says."""
    gauge = SPHGauge(Particles=reader, Point1=[0.0, 0.0, 0.0], Point2=[0.0, 0.0, 1.0])  # noqa: F821
    assert list(gauge.Point1) == [0.0, 0.0, 0.0] and list(gauge.Point2) == [0.0, 0.0, 1.0]  # not the bounds
    gauge.Point1 = [0.0, 0.0, -1.0]
    over_time = PlotDataOverTime(Input=gauge, FieldAssociation="Rows", OnlyReportSelectionStatistics=0)
    over_time.UpdatePipeline()
    rows = over_time.GetDataInformation().GetRowDataInformation()
    names = [rows.GetArrayInformation(i).GetName() for i in range(rows.GetNumberOfArrays())]
    depth = next(rows.GetArrayInformation(name) for name in names if name.startswith("depth"))
    height = (SIDE - 1) * SPACING  # of the lattice, and half a spacing on either side
    assert depth.GetNumberOfTuples() == 2 and abs(depth.GetComponentRange(0)[1] - height - SPACING) < 0.1 * SPACING, (
        depth.GetNumberOfTuples(), depth.GetComponentRange(0))
    Delete(over_time)
    Delete(gauge)


def check_flux(reader):
    """One Apply: through the middle of a body that turns, nothing flows in sum."""
    flux = SPHFlux(Particles=reader)  # noqa: F821
    flux.UpdatePipeline(reader.TimestepValues[0])  # when the body is along the axes
    assert numpy.allclose(flux.Origin, 0, atol=1e-6) and abs(flux.Radius - (SIDE - 1) * SPACING) < 1e-6, (flux.Origin, flux.Radius)
    rows = flux.GetDataInformation().GetRowDataInformation()
    value = {name: rows.GetArrayInformation(name).GetComponentRange(0)[0] for name in ("area", "volume_flux", "velocity")}
    assert abs(value["area"] - (SIDE * SPACING) ** 2) < 0.02 * value["area"] and abs(value["volume_flux"]) < 1e-3, value
    Delete(flux)


def check_derivatives(reader):
    derive = SPHDerivatives(Input=reader)  # noqa: F821
    assert strings_offered(derive, "SelectInputArray") >= {"Velocity", "Height"}
    assert list(derive.Array) == ["POINTS", "Velocity"]  # though no array is active, nor this the first
    found = arrays_of(derive)[1]
    # The corrected gradient of a rotation is exact, the end of the fluid included.
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
    assert strings_offered(film, "IdArray") >= {"(automatic)", "Idp"}
    assert strings_offered(film, "VelocityArray") >= {"(automatic)", "Velocity"}
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
    # Files with one step pass through.
    film = SPHTemporalInterpolator(Input=reader)  # noqa: F821
    assert (arrays_of(film)[1]["Velocity"] == found["Velocity"]).all()


def main():
    faulthandler.dump_traceback_later(500, file=2)  # where it stands, if it stands
    server = os.environ.get("MCOR_TEST_SERVER")
    if server:
        Connect(server.split(":")[0], int(server.split(":")[1]))
    LoadPlugin(PLUGIN, remote=bool(server), ns=globals())
    with tempfile.TemporaryDirectory() as folder:
        steps = [os.path.join(folder, f"step_{i}.vtp") for i in range(2)]
        numbers = numpy.arange(SIDE ** 3)
        write_step(steps[0], 0.0, numbers)
        write_step(steps[1], 1.0, numbers[::-1])
        reader = XMLPolyDataReader(registrationName="particles", FileName=steps)
        plane = Plane(registrationName="plane", Origin=[-1.0, -1.0, 0.0], Point1=[1.0, -1.0, 0.0],
                      Point2=[-1.0, 1.0, 0.0], XResolution=20, YResolution=20)
        check_probe(reader, plane)
        check_slices(reader)
        check_gauge(reader)
        check_flux(reader)
        check_derivatives(reader)
        check_interpolator(reader)
    check_real_data()
    if server:
        Disconnect()
    print("the field's filters work in", servermanager.vtkSMProxyManager.GetParaViewSourceVersion())


main()
