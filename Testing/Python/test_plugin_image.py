# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A picture made through the plugin against its baseline. Numeric sibling: test_plugin.py."""
import os
import sys

from paraview.simple import (ColorBy, CreateRenderView, GetColorTransferFunction, LoadPlugin,
                             Render, SaveScreenshot, Show, XMLPolyDataReader)
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

NAME = "TestPluginImage.png"
BASELINE = os.path.join(os.environ["MCOR_TEST_BASELINES"], NAME)
OUTPUT = os.path.join(os.environ["MCOR_TEST_OUTPUT"], NAME)
# The limit of vtkImageDifference, which tolerates shifts of a pixel: about the number of pixels that differ.
THRESHOLD = 30.0


def draw():
    LoadPlugin(os.environ["MCOR_TEST_PLUGIN"], remote=False, ns=globals())
    data = os.path.join(os.environ["MCOR_TEST_DATA"], "dam_break_45k.vtp")
    reader = XMLPolyDataReader(FileName=[data])
    reader.UpdatePipeline()
    extract = MarchingCorrectors(Input=reader)  # noqa: F821, LoadPlugin made it
    extract.FluidArray = "ParticleType"
    extract.FreeSurface = 1
    view = CreateRenderView(ViewSize=[500, 300])
    view.UseColorPaletteForBackground = 0
    view.Background = [0.2, 0.2, 0.25]
    view.OrientationAxesVisibility = 0
    display = Show(extract, view)
    ColorBy(display, ("POINTS", "Velocity", "Magnitude"))
    GetColorTransferFunction("Velocity").RescaleTransferFunction(0.0, 3.0)
    view.CameraPosition = [0.6, 1.6, 3.2]
    view.CameraFocalPoint = [1.6, 0.3, 0.0]
    view.CameraViewUp = [0.0, 1.0, 0.0]
    Render(view)
    SaveScreenshot(OUTPUT, view, ImageResolution=[500, 300])
    check_after_failure(extract, display, view)


def check_after_failure(extract, display, view):
    """An update that fails draws nothing; what follows it is drawn."""
    def drawn():
        Render(view)
        return display.SMProxy.GetRepresentedDataInformation().GetNumberOfCells()
    before = drawn()
    extract.OnlyInABox, extract.BoxLength = 1, [0.0, 0.0, 0.0]
    assert drawn() == 0
    extract.OnlyInABox, extract.FreeSurfaceValue = 0, 0.3
    after = drawn()
    assert after == extract.GetDataInformation().GetNumberOfCells() and 0 < after != before, (before, after)


def read(name):
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()


def main():
    draw()
    if not os.path.exists(BASELINE):
        sys.exit("there is no baseline; the picture is " + OUTPUT)
    difference = vtkImageDifference()
    difference.SetInputData(read(OUTPUT))
    difference.SetImageData(read(BASELINE))
    difference.Update()
    error = difference.GetThresholdedError()
    print("picture differs by %g (at most %g)" % (error, THRESHOLD))
    if error > THRESHOLD:
        writer = vtkPNGWriter()
        writer.SetInputConnection(difference.GetOutputPort())
        writer.SetFileName(OUTPUT.replace(".png", ".diff.png"))
        writer.Write()
        sys.exit("the picture is not the baseline: " + OUTPUT)


main()
