# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A picture for each way in which the filter draws, against the baselines of TestModesImage.cxx.

mode_images.py                  through the filters' Python package
pvpython mode_images.py plugin  through the plugin: made by ParaView, drawn here
"""
import os
import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

DATA = os.path.join(os.environ["MCOR_TEST_DATA"], "dam_break_45k.vtp")
BASELINES, OUTPUT = os.environ["MCOR_TEST_BASELINES"], os.environ["MCOR_TEST_OUTPUT"]
THRESHOLD = 10.0  # VTK's own for its image tests
MODES = ("Iso", "Speed", "FreeSurface", "Preview", "Untrimmed", "Wall", "Weight", "Slice")
WEIGHT = ("WeightSum", 0.0, 1.0)
COLORS = {"Weight": WEIGHT, "Untrimmed": WEIGHT, "Speed": ("Velocity_Magnitude", 0.0, 3.0)}
SPEEDS = [0.5, 1.0, 1.5, 2.0, 2.5]


def make_plane(plane):
    plane.SetOrigin(0.0, 0.0, 0.1)
    plane.SetPoint1(3.22, 0.0, 0.1)
    plane.SetPoint2(0.0, 1.0, 0.1)
    plane.SetResolution(322, 100)


def by_package(mode):
    from marchingcorrectors import vtkMarchingCorrectors, vtkSPHProbe
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(DATA)
    plane = vtkPlaneSource()
    make_plane(plane)
    extract = vtkSPHProbe() if mode == "Slice" else vtkMarchingCorrectors()
    extract.SetFluidArrayName("ParticleType")
    if mode == "Slice":
        extract.SetInputConnection(plane.GetOutputPort())
        extract.SetSourceConnection(reader.GetOutputPort())
    else:
        extract.SetInputConnection(reader.GetOutputPort())
        extract.SetInputArrayToProcess(0, 0, 0, 0, "Velocity")
        extract.SetValue(0, 0.7)
        extract.ComputeWeightSumOn()
        extract.SetPreview(mode == "Preview")
        extract.SetCubeSizeFactor(2.0 if mode == "Preview" else 0.5)
        extract.SetTrim(mode != "Untrimmed")
        extract.SetNodeThreshold(0.001 if mode == "Untrimmed" else 0.1)
        extract.SetFreeSurface(mode in ("Wall", "FreeSurface"))
        extract.SetHScaleFactor(0.75 if mode == "Weight" else 1.0)
    if mode == "Wall":
        extract.SetSolids(vtkMarchingCorrectors.SOLIDS_WALL)
    if mode == "Speed":
        extract.GenerateValues(5, SPEEDS[0], SPEEDS[-1])
    extract.Update()
    return extract.GetOutput()


def by_plugin(mode):
    from paraview import servermanager, simple
    simple.LoadPlugin(os.environ["MCOR_TEST_PLUGIN"], remote=False, ns=globals())  # its filters come here
    reader = simple.XMLPolyDataReader(FileName=[DATA])
    if mode == "Slice":
        plane = simple.Plane(Origin=[0.0, 0.0, 0.1], Point1=[3.22, 0.0, 0.1], Point2=[0.0, 1.0, 0.1],
                             XResolution=322, YResolution=100)
        extract = globals()["SPHProbe"](Points=plane, Particles=reader, FluidArray="ParticleType",
                                        NaNOutsideOfTheFluid=0)
    else:
        extract = globals()["MarchingCorrectors"](
            Input=reader, ContourBy=["POINTS", "Velocity"], Isosurfaces=SPEEDS if mode == "Speed" else [0.7],
            FluidArray="ParticleType", ComputeWeightSum=1, Preview=int(mode == "Preview"),
            CubeSizeFactor=2.0 if mode == "Preview" else 0.5, Trim=int(mode != "Untrimmed"),
            NodeThreshold=0.001 if mode == "Untrimmed" else 0.1,
            FreeSurface=int(mode in ("Wall", "FreeSurface")),
            SmoothingLengthScale=0.75 if mode == "Weight" else 1.0)
    if mode == "Wall":
        extract.Solids = "End the surface at walls"
    return servermanager.Fetch(extract)


def draw(surface, color_by, low, high, path):
    """As CompareImage() in TestImage.h does."""
    colors = vtkLookupTable()
    colors.SetVectorModeToMagnitude()
    colors.SetHueRange(0.67, 0.0)
    colors.SetSaturationRange(0.5, 0.7)
    colors.SetRange(low, high)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(color_by)
    mapper.SetLookupTable(colors)
    mapper.UseLookupTableScalarRangeOn()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetInterpolationToPhong()
    renderer = vtkRenderer()
    renderer.AddActor(actor)
    renderer.SetBackground(0.2, 0.2, 0.25)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(0.4, 1.5, 3.0)
    camera.SetFocalPoint(1.6, 0.3, 0.0)
    camera.SetViewUp(0.0, 1.0, 0.0)
    renderer.ResetCamera()
    camera.Zoom(1.4)
    window = vtkRenderWindow()
    window.SetMultiSamples(0)
    window.SetSize(500, 300)
    window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()


def read(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def difference(path, baseline):
    compare = vtkImageDifference()
    compare.SetInputData(read(path))
    compare.SetImageData(read(baseline))
    compare.Update()
    return compare.GetThresholdedError()


def main(make, prefix):
    failed = []
    for mode in MODES:
        name = f"Test{mode}Image.png"
        path = os.path.join(OUTPUT, prefix + name)
        draw(make(mode), *COLORS.get(mode, ("Velocity", 0.0, 3.0)), path)
        error = difference(path, os.path.join(BASELINES, name))
        print("%s differs by %g (at most %g)" % (path, error, THRESHOLD))
        if error > THRESHOLD:
            failed.append(mode)
    sys.exit("not the baselines: " + ", ".join(failed) if failed else 0)


if sys.argv[1:] == ["plugin"]:
    main(by_plugin, "plugin_")
else:
    main(by_package, "python_")
