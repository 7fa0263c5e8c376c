# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws pictures and compares them with baselines.

mode_images.py [MODE...]           each way in which the filters draw, by the Python package
pvpython mode_images.py            one picture that ParaView makes with the plugin
"""
import os
import sys

import numpy
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

DATA = os.path.join(os.environ["MCOR_TEST_DATA"], "dam_break_45k.vtp")
BASELINES, OUTPUT = os.environ["MCOR_TEST_BASELINES"], os.environ["MCOR_TEST_OUTPUT"]
THRESHOLD = 10.0  # the threshold of VTK's own image tests
PLUGIN_THRESHOLD = 30.0  # For ParaView's pictures: about the number of pixels that differ by more than a shift of one pixel.
MODES = ("Iso", "Speed", "FreeSurface", "Preview", "Untrimmed", "Wall", "Weight", "Slice", "Filled")
WEIGHT = ("WeightSum", 0.0, 1.0)
COLORS = {"Weight": WEIGHT, "Untrimmed": WEIGHT, "Speed": ("Velocity_Magnitude", 0.0, 3.0)}
PLANE = {"Origin": [0.0, 0.0, 0.1], "Point1": [3.22, 0.0, 0.1], "Point2": [0.0, 1.0, 0.1]}  # The plane is upright, along the tank.
RESOLUTION = 322, 100
SPEEDS = [0.5, 1.0, 1.5, 2.0, 2.5]
RADII = [0.6, -1.0, 0.3, 0.9]  # The least value is below all of the scalar's values.


def make_square():
    """Makes a square of particles in the plane y = 0.5."""
    from vtk_test import lattice, particles_of
    x = lattice(21, 1, 21, around_origin=True) + [0, 0.5, 0]
    return particles_of(x, SmoothingLength=numpy.full(441, 0.13), Volume=numpy.full(441, 0.01), Radius=numpy.hypot(x[:, 0], x[:, 2]))


def extract(mode):
    from marchingcorrectors import vtkMarchingCorrectors
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(DATA)
    if mode == "Slice":
        from marchingcorrectors import vtkSPHProbe
        plane, made = vtkPlaneSource(), vtkSPHProbe()
        for name, place in PLANE.items():
            getattr(plane, "Set" + name)(place)
        plane.SetResolution(*RESOLUTION)
        made.SetInputConnection(plane.GetOutputPort())
        made.SetInputConnection(1, reader.GetOutputPort())
    else:
        made = vtkMarchingCorrectors()
        made.SetInputDataObject(make_square()) if mode == "Filled" else made.SetInputConnection(reader.GetOutputPort())
        made.SetInputArrayToProcess(0, 0, 0, 0, "Radius" if mode == "Filled" else "Velocity")
        for i, value in enumerate(RADII if mode == "Filled" else SPEEDS if mode == "Speed" else [0.7]):
            made.SetValue(i, value)
        made.ComputeWeightSumOn()
        made.SetFilled(mode == "Filled")
        made.SetPreview(mode == "Preview")
        made.SetCubeSizeFactor(2.0 if mode == "Preview" else 0.5)
        made.SetTrim(mode != "Untrimmed")
        made.SetNodeThreshold(0.001 if mode == "Untrimmed" else 0.1)  # The low threshold shows where kernels end.
        made.SetFreeSurface(mode in ("Wall", "FreeSurface"))
        made.SetSolids(vtkMarchingCorrectors.SOLIDS_WALL if mode == "Wall" else vtkMarchingCorrectors.SOLIDS_AUTO)
        made.SetHScaleFactor(0.75 if mode == "Weight" else 1.0)
    if mode != "Filled":
        made.SetFluidArrayName("ParticleType")
    made.Update()
    return made.GetOutput()


def draw_by_plugin(path):
    from paraview import simple
    simple.LoadPlugin(os.environ["MCOR_TEST_PLUGIN"], remote=False, ns=globals())  # The plugin's filters become global names here.
    extract = globals()["MarchingCorrectors"](Input=simple.XMLPolyDataReader(FileName=[DATA]), FluidArray="ParticleType",
                                              FreeSurface=1)
    view = simple.CreateRenderView(ViewSize=[500, 300], UseColorPaletteForBackground=0, Background=[0.2, 0.2, 0.25],
                                   OrientationAxesVisibility=0)
    display = simple.Show(extract, view)
    simple.ColorBy(display, ("POINTS", "Velocity", "Magnitude"))
    simple.GetColorTransferFunction("Velocity").RescaleTransferFunction(0.0, 3.0)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0.6, 1.6, 3.2], [1.6, 0.3, 0.0], [0.0, 1.0, 0.0]
    simple.Render(view)
    simple.SaveScreenshot(path, view, ImageResolution=[500, 300])

    def drawn():
        simple.Render(view)
        return display.SMProxy.GetRepresentedDataInformation().GetNumberOfCells()

    # An update that fails draws nothing, and later updates draw again.
    before = drawn()
    extract.OnlyInABox, extract.BoxLength = 1, [0.0, 0.0, 0.0]
    assert drawn() == 0
    extract.OnlyInABox, extract.FreeSurfaceValue = 0, 0.3
    after = drawn()
    assert after == extract.GetDataInformation().GetNumberOfCells() and 0 < after != before, (before, after)
    simple.Delete(view)


def make_actor(surface, color_by, low, high, cells=False):
    colors = vtkLookupTable()
    colors.SetVectorModeToMagnitude()
    colors.SetHueRange(0.67, 0.0)
    colors.SetSaturationRange(0.5, 0.7)
    colors.SetRange(low, high)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetScalarModeToUseCellFieldData() if cells else mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(color_by)
    mapper.SetLookupTable(colors)
    mapper.UseLookupTableScalarRangeOn()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetInterpolationToPhong()
    return actor


def make_filled(surface):
    """Returns an actor for the bands, and one for the lines above them."""
    bands = make_actor(surface, "BandValue", 0.0, 1.0, cells=True)
    lines = vtkPolyData()
    lines.SetPoints(surface.GetPoints())
    lines.SetLines(surface.GetLines())
    mapper, over = vtkPolyDataMapper(), vtkActor()
    mapper.SetInputData(lines)
    over.SetMapper(mapper)
    over.GetProperty().SetColor(0.0, 0.0, 0.0)
    over.GetProperty().SetLineWidth(2.0)
    over.SetPosition(0.0, 0.01, 0.0)
    for actor in bands, over:
        actor.GetProperty().LightingOff()
    return bands, over


def draw(actors, path, size, zoom, *places):
    """Draws actors into a picture. places: the camera's position, the point that the camera looks at, and the upward direction."""
    renderer = vtkRenderer()
    for actor in actors:
        renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    for name, place in zip(("Position", "FocalPoint", "ViewUp"), places):
        getattr(camera, "Set" + name)(place)
    camera.SetParallelProjection(len(actors) > 1)
    renderer.ResetCamera()
    camera.Zoom(zoom)
    renderer.SetBackground(0.2, 0.2, 0.25)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
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


def main(modes):
    failed = []
    for mode in modes:
        name = f"Test{mode}Image.png"
        path = os.path.join(OUTPUT, "python_" + name)
        if mode == "Plugin":
            draw_by_plugin(path)
        elif mode == "Filled":
            draw(make_filled(extract(mode)), path, (300, 300), 1.3, (0.0, 5.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 1.0))
        else:
            actor = make_actor(extract(mode), *COLORS.get(mode, ("Velocity", 0.0, 3.0)))
            draw([actor], path, (500, 300), 1.4, (0.4, 1.5, 3.0), (1.6, 0.3, 0.0), (0.0, 1.0, 0.0))
        error, most = difference(path, os.path.join(BASELINES, name)), PLUGIN_THRESHOLD if mode == "Plugin" else THRESHOLD
        print("%s differs by %g (at most %g)" % (path, error, most))
        if error > most:
            failed.append(mode)
    sys.exit("not the baselines: " + ", ".join(failed) if failed else 0)


main(["Plugin"] if "MCOR_TEST_PLUGIN" in os.environ else sys.argv[1:] or MODES)
