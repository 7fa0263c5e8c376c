# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes particles and blocks, runs filters, and collects what they say, for the tests of VTK's filters."""
import sys
from pathlib import Path

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_STRING
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet, vtkDataObject, vtkMultiBlockDataSet

from marchingcorrectors import vtkMarchingCorrectors

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[1] / "Mpi")]
from particle_pieces import add, arrays_of, particles_of, take  # noqa: E402, F401
from says import says  # noqa: E402, F401

SPACING, H = 0.1, 0.13
COUNT = 21 ** 3  # particles of cube()
POINTS = vtkDataObject.FIELD_ASSOCIATION_POINTS


def lattice(*sides, around_origin=False):
    """Returns places SPACING apart in a block. sides: how many along x, y and z. x varies slowest."""
    places = numpy.stack(numpy.meshgrid(*map(numpy.arange, sides), indexing="ij"), -1).reshape(-1, 3).astype(float)
    return SPACING * (places - (numpy.array(sides) - 1) / 2 * around_origin)


def cube(kind=float, **arrays):
    """Returns 21^3 particles in [-1, 1]^3, moved a little from a lattice so that no two neighbourhoods are alike. Radius is the distance
    from the centre."""
    places = lattice(21, 21, 21, around_origin=True)
    places = (places + 0.1 * SPACING * numpy.random.default_rng(21).uniform(-1, 1, places.shape)).astype(kind)
    return particles_of(places, SmoothingLength=numpy.full(COUNT, H), Volume=numpy.full(COUNT, SPACING ** 3),
                        Radius=numpy.linalg.norm(places.astype(float), axis=1), **arrays)


def sphere(data=None, scalar="Radius", iso=0.6):
    """Returns a filter whose surface in the cube is about a sphere."""
    extract = vtkMarchingCorrectors()
    extract.SetInputDataObject(cube() if data is None else data)
    extract.SetInputArrayToProcess(0, 0, 0, POINTS, scalar)
    extract.SetValue(0, iso)
    return extract


def sums_at(particles, values, places):
    """Returns, at each place, the weight sum and the sum of a scalar, with the textbooks' cubic spline and no code of
    the core."""
    x, volume = points_of(particles), values_of(particles, "Volume")
    found = []
    for place in numpy.asarray(places, float):
        q = numpy.linalg.norm(x - place, axis=1) / H
        near = q < 2
        q = q[near]
        w = volume[near] * numpy.where(q < 1, 1 - 1.5 * q ** 2 + 0.75 * q ** 3, 0.25 * (2 - q) ** 3) / numpy.pi / H ** 3
        found.append((w.sum(), w @ values[near]))
    return numpy.array(found).T


def blocks_of(*blocks, **named):
    """Returns a data set of blocks: first the blocks without names, then those with names."""
    result = vtkMultiBlockDataSet()
    for i, block in enumerate((*blocks, *named.values())):
        result.SetBlock(i, block)
    for i, name in enumerate(named, len(blocks)):
        result.GetMetaData(i).Set(vtkCompositeDataSet.NAME(), name)
    return result


def take_step(step, extract, *data):
    """Applies a step to the filter. The step is a function, or a dictionary of settings."""
    if callable(step):
        step(extract, *data)
        return
    for name, value in step.items():
        getattr(extract, "Set" + name)(*(value if isinstance(value, tuple) else (value,)))


def run(made, data=None, **settings):
    """Runs the filter. Returns its output, and the messages of its errors and warnings in their order. A setting that is a tuple has
    several arguments."""
    told, tags = [], []

    def keep(_, event, text):
        told.append(text)

    keep.CallDataType = VTK_STRING
    for event in ("ErrorEvent", "WarningEvent"):
        tags.append(made.AddObserver(event, keep))
    if data is not None:
        made.SetInputDataObject(data)
    take_step(settings, made)
    made.Update()
    for tag in tags:
        made.RemoveObserver(tag)
    return made.GetOutputDataObject(0) if made.GetNumberOfOutputPorts() else None, told


def values_of(data, name):
    """Returns a point array as a NumPy array."""
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def bytes_of(data):
    """Returns the bytes of the points and of all their arrays."""
    return [bytes(memoryview(array)) for array in (data.GetPoints().GetData(), *arrays_of(data))]


def surface_of(data):
    """Returns the bytes of a surface's points, triangles and point arrays, by name."""
    return {"points": points_of(data).tobytes(), "corners": vtk_to_numpy(data.GetPolys().GetConnectivityArray()).tobytes(),
            **{array.GetName(): bytes(memoryview(array)) for array in arrays_of(data)}}


def statistics_of(extract):
    """Returns the run's statistics without its costs, which may differ in another run for the same surface."""
    data = extract.GetRunStatistics()
    arrays = [data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays())]
    return [(array.GetName(), [array.GetVariantValue(i).ToString() for i in range(array.GetNumberOfValues())])
            for array in arrays if array.GetName() not in ("Seconds", "DeviceBytesPeak", "ParticlesInReach", "Bricks",
                                                           "NodesEvaluated", "MarchRounds")]


def statistic(extract, name):
    return extract.GetRunStatistics().GetAbstractArray(name).GetVariantValue(0).ToDouble()


def on_progress(extract, act):
    """Calls act(extract) at each progress event of later runs. Returns the observer's number."""
    return extract.AddObserver("ProgressEvent", lambda *_: act(extract))


def aborted(extract):
    """Returns the output of a run that is stopped at its first progress event."""
    tag = on_progress(extract, lambda made: made.SetAbortExecute(1))
    extract.Modified()
    output, told = run(extract)
    extract.RemoveObserver(tag)
    extract.SetAbortExecute(0)
    assert (told, extract.GetErrorMessage()) == ([], ""), told
    return output
