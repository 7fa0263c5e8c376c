# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the plugin over several processes: in pvbatch under mpirun, or in a pvserver. The pieces that the
processes write must together be what one process alone wrote. Renders nothing.

    test_paraview.py 1 FOLDER         first: writes particles in pieces, and the surfaces of one process
    test_paraview.py RANKS FOLDER     then: compares the surfaces of RANKS processes with them
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
# pylint: disable=wrong-import-position
import numpy as np  # noqa: E402
from paraview import servermanager, simple  # noqa: E402
from paraview.simple import (Connect, Disconnect, LoadPlugin, SaveData,  # noqa: E402
                             XMLPartitionedPolydataReader, XMLPolyDataReader)
from particle_pieces import arrays_of, difference, read, write_pieces  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402

PARTICLES = os.path.join(os.environ["MCOR_TEST_DATA"], "double_dam_break_small.vtp")
# In ParaView 5.12 this filter and its array got other names.
PROCESS_IDS, NUMBER = ((simple.ProcessIds, "PointProcessIds") if hasattr(simple, "ProcessIds")
                       else (simple.ProcessIdScalars, "ProcessId"))
CASES = {
    "free": {"FreeSurface": 1},
    "speed": {"ContourBy": ["POINTS", "Speed"], "Isosurfaces": [1.2, 2.0], "Topology": "Field", "ComputeWeightSum": 1},
    "middle": {"ContourBy": ["POINTS", "Speed"], "CubeSizeMode": "Uniform"},  # the range's middle is the same on all ranks
    "box": {"FreeSurface": 1, "OnlyInABox": 1, "BoxPosition": [-0.4, -10, -0.2], "BoxLength": [0.91, 10.33, 10.2]},
}


def extract(particles, name):
    surface = MarchingCorrectors(Input=particles, **CASES[name])  # noqa: F821, LoadPlugin made it
    surface.UpdatePipeline()
    return surface


def probe(particles):
    """Makes the derivatives of the speed, then probes the field at the particles' own places."""
    derived = SPHDerivatives(Input=particles, Array=["POINTS", "Speed"])  # noqa: F821
    found = SPHProbe(Points=derived, Particles=derived)  # noqa: F821
    found.UpdatePipeline()
    return found


# DataMode is "Binary", because VTK 9.1 with a recent expat cannot read small files of appended data.
def write_alone(folder):
    write_pieces(PARTICLES, folder, 5)
    particles = XMLPolyDataReader(FileName=[PARTICLES])
    for name in CASES:
        SaveData(os.path.join(folder, f"{name}_1.vtp"), proxy=extract(particles, name), DataMode="Binary")
    SaveData(os.path.join(folder, "probe_1.vtp"), proxy=probe(particles), DataMode="Binary")


def in_order(data):
    """Returns arrays by name, sorted by the points' coordinates, because pieces have points in another order."""
    points = vtk_to_numpy(data.GetPoints().GetData())
    order = np.lexsort(points.T)
    return {array.GetName(): vtk_to_numpy(array)[order] for array in [data.GetPoints().GetData(), *arrays_of(data)]}


def check_probe(folder, ranks, particles):
    file = os.path.join(folder, f"probe_{ranks}.pvtp")
    SaveData(file, proxy=probe(particles), DataMode="Binary")
    alone, union = in_order(read(os.path.join(folder, "probe_1.vtp"))), in_order(read(file))
    assert set(alone) == set(union) and {"WeightSum", "Gradients"} <= set(alone), (alone.keys(), union.keys())
    for name, values in alone.items():
        assert values.tobytes() == union[name].tobytes(), name
    print(f"probe: {len(alone['WeightSum'])} points of {ranks} processes", flush=True)


def check_ranks(folder, ranks):
    assert servermanager.ActiveConnection.GetNumberOfDataPartitions() == ranks
    particles = XMLPartitionedPolydataReader(FileName=[os.path.join(folder, "pieces.pvtp")])
    for name in CASES:
        surface = extract(particles, name)
        colored = PROCESS_IDS(Input=surface)
        file = os.path.join(folder, f"{name}_{ranks}.pvtp")
        SaveData(file, proxy=colored, DataMode="Binary")
        alone, union = read(os.path.join(folder, f"{name}_1.vtp")), read(file)
        assert alone.GetNumberOfPolys() > 1000, name
        problem = difference(union, alone)
        assert not problem, (name, problem)
        # The points name all processes as owners, and points on seams appear in two pieces.
        owners = np.unique(vtk_to_numpy(union.GetPointData().GetArray(NUMBER)))
        assert list(owners) == list(range(ranks)), owners
        shared = union.GetNumberOfPoints() - alone.GetNumberOfPoints()
        assert shared > 0
        assert surface.GetDataInformation().GetNumberOfCells() == alone.GetNumberOfPolys()
        print(f"{name}: {alone.GetNumberOfPolys()} triangles of {ranks} processes, {shared} points on seams", flush=True)
    check_probe(folder, ranks, particles)


def main(ranks, folder):
    server = os.environ.get("MCOR_TEST_SERVER")
    if server:
        Connect(server.split(":")[0], int(server.split(":")[1]))
    LoadPlugin(os.environ["MCOR_TEST_PLUGIN"], remote=bool(server), ns=globals())
    os.makedirs(folder, exist_ok=True)
    if ranks == 1:
        write_alone(folder)
    else:
        check_ranks(folder, ranks)
    if server:
        Disconnect()


main(int(sys.argv[1]), sys.argv[2])
