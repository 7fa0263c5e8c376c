# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the filter's panel in the real window. Run it as paraview
--script=test_plugin_window.py."""
import os
import traceback

from paraview.simple import (GetActiveViewOrCreate, LoadPlugin, PointSource, Render, SetActiveSource,
                             Show, XMLPolyDataReader)


def show_panel(source, **properties):
    """Makes the filter the active source, so that ParaView builds its panel with all widgets and decorators."""
    extract = MarchingCorrectors(Input=source)  # noqa: F821, LoadPlugin made it
    SetActiveSource(extract)
    for name, value in properties.items():
        setattr(extract, name, value)
    Show(extract, GetActiveViewOrCreate("RenderView"))
    Render()
    assert extract.GetDataInformation().GetNumberOfCells() > 0


def main():
    LoadPlugin(os.environ["MCOR_TEST_PLUGIN"], remote=False, ns=globals())
    # These points have no arrays, so every list of arrays is empty.
    show_panel(PointSource(NumberOfPoints=2000, Radius=1.0), FreeSurface=1,
               EstimateSmoothingLength=1)
    # When the panel is built, this file's arrays are not known yet.
    data = os.path.join(os.environ["MCOR_TEST_DATA"], "double_dam_break_small.vtp")
    show_panel(XMLPolyDataReader(FileName=[data]), ContourBy=["POINTS", "Speed"], Preview=1)
    print("the panel works", flush=True)


# ParaView would keep its window open after the script, so the process is ended below.
status = 1
try:
    main()
    status = 0
except BaseException:
    traceback.print_exc()
os._exit(status)
