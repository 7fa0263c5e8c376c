# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a picture in ParaView with the plugin and compares it with a baseline."""
import os
import sys

from paraview import simple
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader

DATA = os.path.join(os.environ["MCOR_TEST_DATA"], "dam_break_45k.vtp")
BASELINE = os.path.join(os.environ["MCOR_TEST_BASELINES"], "TestPluginImage.png")
THRESHOLD = 30.0  # This is about the number of pixels that differ by more than a shift of one pixel.


def draw_by_plugin(path):
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


def read(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def main(path):
    draw_by_plugin(path)
    compare = vtkImageDifference()
    compare.SetInputData(read(path))
    compare.SetImageData(read(BASELINE))
    compare.Update()
    error = compare.GetThresholdedError()
    sys.exit("%s differs by %g (at most %g)" % (path, error, THRESHOLD) if error > THRESHOLD else 0)


main(os.path.join(os.environ["MCOR_TEST_OUTPUT"], "python_TestPluginImage.png"))
