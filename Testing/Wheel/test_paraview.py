# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The filter in Python as a plugin of ParaView: the panel's properties, a surface, a sentence. In pvpython.

    test_paraview.py FOLDER_OF_THE_ENVIRONMENT
"""
import glob
import inspect
import os
import sys

if not hasattr(inspect, "getargspec"):  # Debian 12's ParaView 5.11 cannot load any plugin in Python without
    inspect.getargspec = inspect.getfullargspec

plugins = glob.glob(sys.argv[1] + "/venv/lib/python3*/site-packages/marchingcorrectors/MarchingCorrectorsFilter.py")
if not plugins:
    print("Skipped: no wheel was built; wheel.build says why.")
    sys.exit(77)

from paraview import servermanager
from paraview import simple

simple.LoadPlugin(plugins[0], remote=False, ns=globals())
reader = simple.XMLPolyDataReader(FileName=[os.environ["MCOR_TEST_DATA"] + "/dam_break_45k.vtp"])
surface = MarchingCorrectors(Input=reader)  # noqa: F821  by LoadPlugin
assert len(surface.ListProperties()) > 40, surface.ListProperties()
surface.ContourBy = ["POINTS", "Velocity"]
surface.Isosurfaces = [1.0]
surface.FluidArray = "ParticleType"
surface.UpdatePipeline()
data = servermanager.Fetch(surface)
assert (data.GetNumberOfPoints(), data.GetNumberOfCells()) == (7904, 13362), data
assert data.GetPointData().GetNormals() and data.GetPointData().HasArray("Pressure")
assert data.GetFieldData().GetArray("IsoValues").GetValue(0) == 1.0
assert not data.GetFieldData().HasArray("SmoothingLengthArray")  # statistics are the filter's
surface.FreeSurface = 1
surface.UpdatePipeline()
assert servermanager.Fetch(surface).GetNumberOfCells() == 176740
surface.SmoothingLengthArray = "Nonsense"
surface.UpdatePipeline()
assert servermanager.Fetch(surface).GetNumberOfCells() == 0
print("passed")
