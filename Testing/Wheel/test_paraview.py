# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the plugin that is written in Python, in ParaView's pvpython. The filter must have the panel's properties, make
a surface, and be empty for a wrong array name. The reader must know solvers' files by their endings, and give the filter all steps
of a series.

    test_paraview.py FOLDER_OF_THE_ENVIRONMENT
"""
import atexit
import glob
import inspect
import os
import shutil
import sys
import tempfile

import numpy as np
from solver_files import X, write_bi4

if not hasattr(inspect, "getargspec"):  # Debian 12's ParaView 5.11 cannot load any plugin in Python without
    inspect.getargspec = inspect.getfullargspec

plugins = glob.glob(sys.argv[1] + "/venv/lib/python3*/site-packages/marchingcorrectors/MarchingCorrectorsFilter.py")
if not plugins:
    print("Skipped: no wheel was built; wheel.build tells why.")
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

line = np.arange(-6, 7) * 0.1
cube = np.stack(np.meshgrid(line, line, line), -1).reshape(-1, 3)
folder = tempfile.mkdtemp()
atexit.register(shutil.rmtree, folder, True)
names = [os.path.join(folder, f"Part_{i:04d}.bi4") for i in range(3)]
for i, name in enumerate(names):
    write_bi4(name, time=0.25 * i, positions=X * [1, 1, 1 + 0.1 * i])
reader = simple.OpenDataFile(names)  # by the ending alone, as File > Open does
assert reader is not None and "SPHParticleReader" in reader.GetXMLName(), reader
times = list(reader.TimestepValues)
assert times == [0.0, 0.25, 0.5], times
lowest = []
for time in times:
    reader.UpdatePipeline(time)
    data = servermanager.Fetch(reader)
    assert data.GetNumberOfVerts() == data.GetNumberOfPoints() > 1000, data  # bare points would not be drawn
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

# The reader also reads tables, and files that hold several times.
with open(os.path.join(folder, "steps.xyz"), "w") as file:
    for i in range(3):
        file.write(f"{len(cube)}\nProperties=species:S:1:pos:R:3:h:R:1 Time={0.5 * i}\n")
        file.writelines(f"O {x} {y} {z * (1 + 0.1 * i)} 0.13\n" for x, y, z in cube)
with open(os.path.join(folder, "steps.dump"), "w") as file:
    for i in range(3):
        file.write(f"ITEM: TIMESTEP\n{i}\nITEM: NUMBER OF ATOMS\n{len(cube)}\nITEM: ATOMS x y z h\n")
        file.writelines(f"{x} {y} {z * (1 + 0.1 * i)} 0.13\n" for x, y, z in cube)
with open(os.path.join(folder, "table.csv"), "w") as file:
    file.write('"Points:0","Points:1","Points:2","h"\n' + "".join(f"{x},{y},{z},0.13\n" for x, y, z in cube))
for name, wanted in (("steps.xyz", [0, 0.5, 1]), ("steps.dump", [0, 1, 2]), ("table.csv", [0])):
    reader = SPHParticleReader(FileNames=[os.path.join(folder, name)])  # noqa: F821
    times = np.ravel(reader.TimestepValues).tolist()
    assert times == wanted, (name, times)
    surface = MarchingCorrectors(Input=reader)  # noqa: F821
    surface.FreeSurface = 1
    for i, time in enumerate(times):
        surface.UpdatePipeline(time)
        data = servermanager.Fetch(reader)
        assert abs(data.GetBounds()[5] - 0.6 * (1 + 0.1 * i)) < 1e-6 and data.GetNumberOfVerts() == len(cube), data
        assert servermanager.Fetch(surface).GetNumberOfCells() > 300

damaged = os.path.join(folder, "damaged.bi4")
with open(damaged, "wb") as file:
    file.write(b"#FileJBD JPartDataBi4")
reader = SPHParticleReader(FileNames=[damaged])  # noqa: F821
reader.UpdatePipeline()
assert servermanager.Fetch(reader).GetNumberOfPoints() == 0
print("passed")
