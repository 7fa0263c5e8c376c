# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""ParaView opens solvers' files by their endings, a series as time steps, and the filter follows. In pvpython.

    test_paraview_reader.py PLUGIN FILE...

FILE: a series, of which each holds another time.
"""
import inspect
import os
import sys
import tempfile

if not hasattr(inspect, "getargspec"):  # Debian 12's ParaView 5.11 cannot load any plugin in Python without
    inspect.getargspec = inspect.getfullargspec

from paraview import servermanager
from paraview import simple

simple.LoadPlugin(sys.argv[1], remote=False, ns=globals())
reader = simple.OpenDataFile(sys.argv[2:])  # by the ending alone, as File > Open does
assert reader is not None and "SPHParticleReader" in reader.GetXMLName(), reader
times = list(reader.TimestepValues)
assert len(times) == len(sys.argv) - 2 and times == sorted(set(times)), times
lowest = []
for time in times:
    reader.UpdatePipeline(time)
    data = servermanager.Fetch(reader)
    assert data.GetNumberOfPoints() > 1000, data
    assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == time
    lowest.append(data.GetBounds()[4])
assert len(set(lowest)) == len(times), lowest

surface = MarchingCorrectors(Input=reader)  # noqa: F821  by LoadPlugin
surface.FreeSurface = 1
cells = []
for time in times:
    surface.UpdatePipeline(time)
    cells.append(servermanager.Fetch(surface).GetNumberOfCells())
assert min(cells) > 300, cells

with tempfile.TemporaryDirectory() as folder:
    name = os.path.join(folder, "damaged.bi4")
    with open(name, "wb") as file:
        file.write(b"#File JPartDataBi4")
    damaged = SPHParticleReader(FileNames=[name])  # noqa: F821
    damaged.UpdatePipeline()
    assert servermanager.Fetch(damaged).GetNumberOfPoints() == 0
print("passed")
