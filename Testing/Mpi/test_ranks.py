# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests, run by mpirun, that ranks together make bit for bit what rank 0 makes alone, however particles and points are spread over the ranks.

    test_ranks.py FOLDER_OF_DATA surfaces|samples [some | CASE]     some: spreads each case in one way only; the ways take turns
"""
import math
import os
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI
from particle_pieces import add, arrays_of, particles_of, read, take
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataSetAttributes, vtkPolyData
from vtkmodules.vtkParallelMPI import vtkMPIController
from vtkmodules.vtkParallelMPI4Py import vtkMPI4PyCommunicator

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHComponents, vtkSPHDerivatives, vtkSPHProbe

sys.path.insert(0, str(Path(__file__).parents[1] / "Python"))
from vtk_test import take_step  # noqa: E402

COMM = MPI.COMM_WORLD
RANK, COUNT = COMM.Get_rank(), COMM.Get_size()
CONTROLLER = vtkMPIController()
CONTROLLER.SetCommunicator(vtkMPI4PyCommunicator.ConvertToVTK(COMM))
FOLDER, WANTED = sys.argv[1], "".join(sys.argv[3:])
SOME = WANTED == "some"
DAMS, DAM = "double_dam_break_small", "dam_break_45k"  # The second one has walls, and smoothing lengths that differ.
DOUBLE = vtkMarchingCorrectors.DOUBLE_PRECISION
INDEX = "TestIndex"

# ---- How particles are spread over ranks ----


def slab(at, count):
    """Returns which of `count` slabs each place is in. Places are from 0 to 1; NaN counts as the first slab."""
    return np.minimum(np.nan_to_num(at * count, nan=0).astype(int), count - 1)


def random_rank(index, count):
    """Returns a rank below `count` for each index. Ranks look random but are the same on every machine."""
    bits = (index * 2654435761) & 0xffffffff
    bits ^= bits >> 15
    return (((bits * 2246822519) & 0xffffffff) >> 8) % count


# Each function takes the particles' numbers, and their places within the bounds, from 0 to 1, and returns each particle's rank, below `count`.
WAYS = {
    "scattered at random": lambda index, at, count: random_rank(index, count),
    "all on one rank": lambda index, at, count: np.full(len(index), count - 1),
    "slabs through the surface": lambda index, at, count: slab(at[:, 1], count),
    "slabs thinner than a support": lambda index, at, count: np.nan_to_num(at[:, 0] * 200).astype(int) % count,
    "ranks without particles": lambda index, at, count: 2 * slab(at[:, 2], (count + 1) // 2),
    "copies marked as duplicates": lambda index, at, count: slab(at[:, 0], count)}


def ways_of(number):
    """Returns the ways in which the particles of the case with this number are spread over ranks."""
    return [list(WAYS)[number % len(WAYS)]] if SOME else list(WAYS)


def take_part(whole, way, rank=RANK, count=COUNT):
    """Returns the particles of one rank. In ways named "copies", several ranks have the same particles."""
    x, bounds = vtk_to_numpy(whole.GetPoints().GetData()), np.reshape(whole.GetBounds(), (3, 2))
    index = np.arange(len(x), dtype=np.int64)
    own = WAYS[way](index, (x - bounds[:, 0]) / (bounds[:, 1] - bounds[:, 0] + 1e-9), count) == rank
    copied = own | (index % 5 == rank % 5) if way.startswith("copies") else own
    part = take(whole, np.flatnonzero(copied))
    if way.startswith("copies"):
        marks = np.where(own[copied], 0, vtkDataSetAttributes.DUPLICATEPOINT).astype(np.uint8)
        add(part, **{vtkDataSetAttributes.GhostArrayName(): marks})
    return part


def values_of(data):
    """Returns the points, and all point arrays by their names."""
    return {"": vtk_to_numpy(data.GetPoints().GetData()), **{a.GetName(): vtk_to_numpy(a) for a in arrays_of(data)}}


def same(found, expected):
    return found.dtype == expected.dtype and found.tobytes() == expected.tobytes()


# ---- Surfaces ----

FREE, SPEED, FLUID = {"FreeSurface": 1}, {"Scalar": "Speed", "Values": [2.0]}, {"FluidArrayName": "ParticleType"}
VARIED = {"Scalar": "Velocity", "Values": [1.0], **FLUID, "SmoothingLengthArrayName": "SmoothingLengthAdaptive", "CubeSizeFactor": 0.8,
          "CubeSizeMode": 1}
# The particles of PLANE have larger areas and smoothing lengths on one side.
LINES = {"Scalar": "Speed", "Values": [2.0, 1.0], "SmoothingLengthArrayName": "h", "VolumeArrayName": "area", "CubeSizeFactor": 0.2,
         "ComputeBoundaryFlag": 1, "CubeSizeMode": 1}
COMPUTED, PERIODS = {"DetectArrays": 0}, {"PeriodicBounds": (-1, 1, 0, 0, -1, 0.5)}
NEIGHBOURS = {"EstimateSmoothingLength": 1, "SmoothingLengthEstimate": vtkMarchingCorrectors.ESTIMATE_NEIGHBORS}
EIGENVALUE = {"BoundaryDetection": vtkMarchingCorrectors.EIGENVALUE}
FIELD = {"Topology": vtkMarchingCorrectors.TOPOLOGY_FIELD}
BOX = {"UseBox": 1, "Box": (-0.7, 0.6, -10, 10, 0, 1)}
PLANE, MESH, TWO_SIZES = "in a plane", "beside a mesh", "two sizes"  # These particles are made of the dams, or without a file.
SURFACES = {
    "free surface": (DAMS, FREE),
    "trimmed": (DAMS, SPEED),
    "beside a mesh": (MESH, SPEED),
    "two values, topology of the field, all arrays": (DAMS, {
        **SPEED, "Values": [2.0, 1.2], **FIELD, **{f"Compute{name}": 1 for name in (
            "Gradients", "WeightSum", "BoundaryEigenvalue", "BoundaryFlag", "CorrectionLength")}}),
    "value in the middle of the range, eigenvalue, double precision": ("bunny_splash_small", {
        **SPEED, "Values": [math.nan], **EIGENVALUE, "Precision": DOUBLE}),
    "array, value and fluid that are found": (DAM, {"DetectFluid": 1}),
    "computed volumes, estimated smoothing length": (DAMS, {**FREE, **COMPUTED, "EstimateSmoothingLength": 1}),
    "lengths by neighbours": (DAMS, {**FREE, **COMPUTED, **NEIGHBOURS}),
    "lengths and densities by neighbours, periods": (TWO_SIZES, {
        "Scalar": "Density", "Values": [6500.0], "Mass": 1, **COMPUTED, **NEIGHBOURS, "PeriodicBounds": (0, 0, 0, 1.3, 0, 1.25)}),
    "M'4, computed volumes, scaled": (DAMS, {**FREE, **COMPUTED, "SmoothingLength": 0.06, "KernelByName": "mprime4", "HScaleFactor": 0.9}),
    "box, preview": (DAMS, {**SPEED, "Preview": 1, "UseBox": 1, "Box": (-0.4, 0.51, -10, 0.33, -0.2, 10)}),
    "fewer bricks than ranks": (DAM, {**FREE, **FLUID, "CubeSize": 0.12, "UseBox": 1, "Box": (0, 3, 0, 0.96, 0, 0.96)}),
    "periods": (DAMS, {**FREE, "CubeSize": 0.025, **PERIODS}),
    "periods that the particles tell of": (DAMS, {**FREE, "CubeSize": 0.025, "DetectPeriod": 1}),
    "periods that no cube divides": (DAMS, {**FREE, "CubeSize": 0.025, "PeriodicBounds": (-1, 1, 0, 0, -1, 0.4717)}),
    "walls": (DAM, {"Scalar": "Velocity", "Values": [1.0], **FLUID, "Solids": vtkMarchingCorrectors.SOLIDS_WALL, "CubeSizeFactor": 1}),
    "adaptive cubes": (DAM, VARIED),
    "adaptive cubes, periods": (DAM, {**VARIED, "PeriodicBounds": (0, 0, 0, 1, 0, 0)}),
    "smoothing lengths that differ": (DAM, {**VARIED, "CubeSizeMode": 0, "CubeSizeFactor": 1}),
    "smooth": (DAMS, {**FREE, "Smooth": 1}),
    "widened, computed volumes, periods": (DAMS, {**SPEED, **COMPUTED, "EstimateSmoothingLength": 1, "Widening": 1.7,
                                                  "PeriodicBounds": (0, 0, 0, 1, 0, 0)}),
    "widened, adaptive cubes": (DAM, {**VARIED, "Widening": 2}),
    "computed volumes of large particles beside small ones": (TWO_SIZES, {**FREE, **COMPUTED, "SmoothingLengthArrayName": "h"}),
    "lines": (PLANE, LINES),
    "lines, uniform squares, computed areas, eigenvalue": (PLANE, {
        **LINES, "VolumeArrayName": None, **COMPUTED, "CubeSizeMode": 0, **EIGENVALUE, "VertexThreshold": 0.1, "ComputeBoundaryEigenvalue": 1}),
    "lines, topology of the field, double precision": (PLANE, {**LINES, **FIELD, "Precision": DOUBLE}),
    "lines, free surface, periods, capped": (PLANE, {**LINES, **FREE, "PeriodicBounds": (-1, 1, -0.2, 0.9, 0, 0), "Capping": 1}),
    "lines, box in a period, capped": (PLANE, {**LINES, "PeriodicBounds": (0, 0, -0.2, 0.9, 0, 0), **BOX, "Capping": 1}),
    "lines, flat box": (PLANE, {**LINES, "UseBox": 1, "Box": (-0.7, 0.6, -10, 10, 0.5, 0.5), "Capping": 1}),
    "filled, flat box": (PLANE, {**LINES, "Filled": 1, "UseBox": 1, "Box": (-0.7, 0.6, -10, 0.4, 0.5, 0.5)}),
    "filled": (PLANE, {**LINES, "Filled": 1}),
    "filled, period and box": (PLANE, {**LINES, "Filled": 1, "PeriodicBounds": (0, 0, -0.2, 0.9, 0, 0), **BOX})}

# Statistics that describe the surface do not depend on how ranks share the work. Statistics in EXACT must be equal; all others may differ
# by rounding.
EXACT = ("Area", "Volume", "Length")
STATISTICS = (*EXACT, "CellsUsed", "TrianglesBeforeTrimming", "CorrectionMean", "CorrectionMax", "CorrectionStandardDeviation",
              "VerticesCorrected", "VerticesAboveTolerance", "IterationsMean", "IterationsMax", "TrimVertices", "TrimVerticesLinear",
              "WideningOutside")


def make_two_sizes():
    """Makes small particles for x < 2 and large ones beyond, whose supports hold many small particles. A rank without large particles must
    learn from the other ranks how far away its particles are needed."""
    points, lengths = [], []
    for size, first, along in (0.05, 0.0, 40), (0.8, 2.0, 1):
        x, y, z = np.indices((along, *[round(1.2 / size)] * 2)).reshape(3, -1)
        shift = 0.2 * np.sin(1.3 * x + 2.1 * y + 0.7 * z)
        points.append(np.stack([first + size * (x + 0.5 + shift), size * (y + 0.5 - shift), size * (z + 0.5)], axis=1))
        lengths.append(np.full(len(x), 1.2 * size))
    return particles_of(np.concatenate(points), h=np.concatenate(lengths))


def make_particles(file):
    if file == TWO_SIZES:
        return make_two_sizes()
    particles = read(os.path.join(FOLDER, (DAMS if file in (PLANE, MESH) else file) + ".vtp"))
    bounds = numpy_to_vtk(np.array([-1.0, 1, 0, 0, -1, 0.5]), deep=1)  # The bounds matter only where they are used.
    bounds.SetName("PeriodicBounds")
    particles.GetFieldData().AddArray(bounds)
    if file == PLANE:
        x = vtk_to_numpy(particles.GetPoints().GetData())
        x[:, 2] = 0.5
        h = 0.04 * 2.0 ** (x[:, 0].astype(float) + 1)
        add(particles, h=h, area=0.2 * h * h)
    return particles


def take_beside_mesh(particles, way):
    """Returns the particles of one rank, with vertices. The last rank has a mesh's triangles instead, without
    vertices."""
    is_mesh, cells = RANK == COUNT - 1, vtkCellArray()
    own = take_part(particles, way, RANK % (COUNT - 1), COUNT - 1)
    for i in range(own.GetNumberOfPoints() - 2 * is_mesh):
        cells.InsertNextCell(3 if is_mesh else 1, [i, i + 1, i + 2][:3 if is_mesh else 1])
    (own.SetPolys if is_mesh else own.SetVerts)(cells)
    return own


def extract(settings, particles, controller):
    """Returns the surface, and what the filter reports: ranges and numbers of cells of this run and of the next one,
    and statistics."""
    made, settings = vtkMarchingCorrectors(), dict(settings)
    made.SetController(controller)
    if "Scalar" in settings:
        made.SetInputArrayToProcess(0, 0, 0, 0, settings.pop("Scalar"))
        for i, value in enumerate(settings.pop("Values")):
            made.SetValue(i, value)
    take_step(settings, made)
    made.SetInputData(particles)
    made.Update()
    run = made.GetRunStatistics()
    told = {name: run.GetArray(name).GetComponent(0, 0) if run.HasArray(name) else -1.0 for name in STATISTICS}
    for name in ("FluidScalarRange", "NextScalarRange", "EstimatedCells", "NextCells"):
        told.update(((name, i), value) for i, value in enumerate(np.ravel(getattr(made, "Get" + name)())))
    # For sums over neighbours a rank may hold other ranks' particles only around its own box.
    held = run.GetArray("RankNeighbors")
    told["holds too many"] = held is not None and held.GetComponent(0, RANK) > 0.6 * COMM.allreduce(particles.GetNumberOfPoints())
    return made.GetOutput(), told


def cells_of(surface, ids=None):
    """Returns the lines as lists of point numbers, and the triangles as rows of point numbers. ids: other numbers for
    the points."""
    ids = np.arange(surface.GetNumberOfPoints()) if ids is None else ids
    lines, triangles = surface.GetLines(), vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    ends = vtk_to_numpy(lines.GetOffsetsArray())[1:-1] if lines.GetNumberOfCells() else []
    return [line.tolist() for line in np.split(ids[vtk_to_numpy(lines.GetConnectivityArray())], ends) if len(line)], ids[triangles]


def part_of(surface):
    """Returns what a rank's surface has, or None if it has no points: the names of its arrays of ids, its point arrays, cell ids and
    cells."""
    if surface.GetNumberOfPoints() == 0:
        return None
    names = [data.GetGlobalIds() and data.GetGlobalIds().GetName() for data in (surface.GetPointData(), surface.GetCellData())]
    values = values_of(surface)
    cells = vtk_to_numpy(surface.GetCellData().GetArray("GlobalCellIds"))
    return names, values, cells, cells_of(surface, values["GlobalPointIds"])


def compare_surfaces(whole, parts):
    """Returns what differs between a whole surface and its parts: they must have the same points under the same numbers with all arrays,
    and the same triangles and lines, each of them once."""
    expected, (lines, triangles) = values_of(whole), cells_of(whole)
    seen, cells = [np.empty(0, int)], [np.empty(0, int)]
    for rank, part in enumerate(parts):
        if part is None:
            continue
        names, values, numbers, (own_lines, own_triangles) = part
        points = values.pop("GlobalPointIds")
        if names != ["GlobalPointIds", "GlobalCellIds"] or set(values) != set(expected):
            return f"rank {rank}: arrays {names} {sorted(values)}"
        wrong = [name for name, found in values.items() if not same(found, expected[name][points])]
        is_line = numbers < len(lines)
        if wrong or own_lines != [lines[i] for i in numbers[is_line]] or not np.array_equal(
                own_triangles, triangles[numbers[~is_line] - len(lines)]):
            return f"rank {rank}: {wrong or 'cells'}"
        seen.append(points)
        cells.append(numbers)
    if not np.array_equal(np.unique(np.concatenate(seen)), np.arange(whole.GetNumberOfPoints())):
        return "points are missing"
    if not np.array_equal(np.sort(np.concatenate(cells)), np.arange(len(lines) + len(triangles))):
        return "cells are missing, or there twice"
    return "" if whole.GetNumberOfPoints() > 200 else "too few points"


def compare_told(whole, all_told):
    """Returns the names of values that a run on all ranks and a run of rank 0 alone report differently, and "EstimatedCells" if it is not
    above 0."""
    unknown = [("NextScalarRange", i) for i in range(2) if whole["NextScalarRange", 1] == 0]  # One process does not sum densities ahead.
    return [name for told in all_told for name, value in told.items() if name[0] == "EstimatedCells" and value <= 0
            or name not in unknown and abs(value - whole[name]) > (0 if name in EXACT else 1e-12 * abs(whole[name]))]


def check_surface(number, name, file, settings):
    """Tests one case of surfaces. On rank 0 it returns what differs on any rank, on other ranks nothing."""
    particles, problems = make_particles(file), []
    whole, told = extract(settings, particles, None) if RANK == 0 else (None, None)
    for way in ways_of(number):
        own, own_told = extract(settings, (take_beside_mesh if file == MESH else take_part)(particles, way), CONTROLLER)
        parts, all_told = COMM.gather(part_of(own)), COMM.gather(own_told)
        if RANK == 0:
            problem = compare_surfaces(whole, parts) or compare_told(told, all_told)
            print(f"{name}, {way}: {problem or 'same'}", flush=True)
            problems += [problem] if problem else []
    return problems


# ---- Samples of the field: at points, and at the particles themselves ----

DERIVE = {"InputArrayToProcess": (0, 0, 0, 0, "Velocity"), "ComputeStrainRate": 1}
H = {**COMPUTED, "SmoothingLength": 0.06}
SOLIDS = {"SmoothingLengthArrayName": "SmoothingLengthAdaptive", **FLUID}
# {name: (file, axis, class, settings)}. Particles are moved into a plane across the axis, unless it is None.
SAMPLES = {
    "plane": (DAMS, None, vtkSPHProbe, {"ComputeGradients": 1}),
    "sum, computed volumes, M'4": (DAMS, None, vtkSPHProbe, {"ShepardNormalization": 0, **H, "KernelByName": "mprime4", "HScaleFactor": 0.9}),
    "solids, smoothing lengths that differ, double precision": (DAM, None, vtkSPHProbe, {**SOLIDS, "Precision": DOUBLE, "ComputeGradients": 1}),
    "periods": (DAMS, None, vtkSPHProbe, {**PERIODS, "ComputeGradients": 1}),
    "two dimensions, periods, also across the plane": (DAMS, 1, vtkSPHProbe, {
        **H, "PeriodicBounds": (-1, 1, 0, 0.6, -1, 0.5), "ComputeGradients": 1}),
    "derivatives": (DAMS, None, vtkSPHDerivatives, DERIVE),
    "derivatives, periods, computed volumes": (DAMS, None, vtkSPHDerivatives, {**DERIVE, **PERIODS, **H}),
    "derivatives, estimated smoothing length, computed volumes": (DAMS, None, vtkSPHDerivatives, {
        **DERIVE, "InputArrayToProcess": (0, 0, 0, 0, "Speed"), "CorrectGradients": 0, **COMPUTED, "EstimateSmoothingLength": 1}),
    "derivatives, solids, smoothing lengths that differ": (DAM, None, vtkSPHDerivatives, {**DERIVE, **SOLIDS}),
    "derivatives, two dimensions, estimated smoothing length": (DAMS, 2, vtkSPHDerivatives, {
        **DERIVE, **COMPUTED, "EstimateSmoothingLength": 1, "ComputeLambda2": 1})}


def make_points(particles, name, constant):
    """Makes a lattice of points, somewhat larger than the particles' bounds, and some NaN points. If the particles lie in a plane, so do
    most points."""
    low, high = np.reshape(particles.GetBounds(), (3, 2)).T
    cell = np.indices((1 if name == "plane" else 27, 29, 31)).reshape(3, -1)[::-1].T
    share = 1.2 * cell / [30, 28, 26] - 0.1
    if name == "plane":
        share[:, 2] = 0.25
    at, k = low + share * (high - low), np.arange(len(cell))
    if constant is not None:
        at[:, constant] += np.where(k % 7 == 3, 0.01 * (k % 5), 0)
    at[k % 501 == 7, 1] = math.nan
    return particles_of(at, **{INDEX: k})


def sample(kind, settings, particles, points, controller):
    made = kind()
    made.SetController(controller)
    take_step(settings, made)
    made.SetInputDataObject(points if kind is vtkSPHProbe else particles)
    if kind is vtkSPHProbe:
        made.SetSourceData(particles)
    made.Update()
    return values_of(made.GetOutput())


def check_sample(number, name, file, constant, kind, settings):
    """Tests one case of a probe or of derivatives. Returns what differs on this rank."""
    particles = read(os.path.join(FOLDER, file + ".vtp"))
    add(particles, **{INDEX: np.arange(particles.GetNumberOfPoints())})
    if constant is not None:
        vtk_to_numpy(particles.GetPoints().GetData())[:, constant] = 0.7
    points, problems = make_points(particles, name, constant), []
    whole = sample(kind, settings, particles, points, None)
    if np.count_nonzero(whole.get("vtkValidPointMask", whole.get("Gradients"))) <= 50:
        problems.append("there is nothing to compare with")
    for way in ways_of(number):
        own, at = take_part(particles, way), take_part(points, list(WAYS)[(list(WAYS).index(way) + 2) % (len(WAYS) - 1)])
        given = values_of(at if kind is vtkSPHProbe else own)
        found = sample(kind, settings, own, at, CONTROLLER)
        counts = given.get(vtkDataSetAttributes.GhostArrayName(), np.zeros(len(given[""]))) == 0
        numbers = given[INDEX][counts]
        wrong = [array for array, values in whole.items() if array not in found or not same(found[array][counts], values[numbers])]
        seen = np.concatenate(COMM.allgather(numbers))
        wrong += [] if np.array_equal(np.sort(seen), np.arange(len(whole[""]))) else ["points are missing"]
        print(f"{name}, {way}, rank {RANK}: {wrong or 'same'}", flush=True)
        problems += wrong
    return problems


def check_without_points():
    """A probe whose input is missing on the last rank fails on all ranks, and no rank waits for it."""
    probe, nothing = vtkSPHProbe(), vtkPolyData()
    probe.SetController(CONTROLLER)
    probe.SetSourceData(nothing)
    if RANK + 1 < COUNT:
        probe.SetInputDataObject(nothing)
    probe.Update()
    return [] if "points" in probe.GetErrorMessage() else ["no error where points are missing"]


def check_named():
    """If a particle of the last rank has an illegal mass or position, all ranks name the particle by its number on that rank."""
    problems = []
    for is_mass in False, True:
        own, filter_ = take_part(make_two_sizes(), "scattered at random"), vtkMarchingCorrectors()
        mass = np.ones(own.GetNumberOfPoints())
        add(own, m=mass)
        if RANK == COUNT - 1:
            (vtk_to_numpy(own.GetPointData().GetArray("m")) if is_mass else vtk_to_numpy(own.GetPoints().GetData())[:, 0])[5] = -1 if is_mass else math.nan
        take_step(NEIGHBOURS, filter_)
        filter_.SetInputArrayToProcess(0, 0, 0, 0, "Density")
        filter_.SetController(CONTROLLER)
        filter_.SetInputData(own)
        filter_.Update()
        said = filter_.GetErrorMessage()
        problems += [] if said.startswith(f"Rank {COUNT - 1}: ") and "article 5 " in said else [f"not named: {said}"]
    return problems


def check_few():
    """The smoothing lengths that a few particles get from their neighbours do not change if other ranks have no particles."""
    problems, whole = [], make_two_sizes()
    for count in 1, 2, 9:
        few = take(whole, np.arange(count))
        (_, alone), (_, told) = (extract({**FREE, **COMPUTED, **NEIGHBOURS}, particles, controller) for particles, controller in (
            (few, None), (few if RANK == 0 else take(whole, []), CONTROLLER)))
        problems += [] if told["Area"] == alone["Area"] else [f"{count} particles: {told['Area']} for {alone['Area']}"]
    return problems


def check_sent():
    """Arrays that a run does not need stay on their ranks."""
    sent = []
    for count in 0, 6:
        own, derive = take_part(make_particles(DAMS), "scattered at random"), vtkSPHDerivatives()
        add(own, **{f"Other{i}": vtk_to_numpy(own.GetPoints().GetData()) for i in range(count)})
        sample(lambda made=derive: made, DERIVE, own, None, CONTROLLER)
        sent.append(np.sum(vtk_to_numpy(derive.GetRunStatistics().GetArray("RankBytesSent"))))
    return [] if 0 < sent[1] < 1.1 * sent[0] else [f"{sent} bytes"]


def check_pieces():
    """The fluid is found over all ranks, so the pieces of a surface hold as many fluid particles as with one process."""
    particles, counts = make_particles(DAM), []
    alone = [(particles, None)] if RANK == 0 else []
    for own, controller in [*alone, (take_part(particles, "scattered at random"), CONTROLLER)]:
        pieces = vtkSPHComponents()
        pieces.SetController(controller)
        pieces.SetDetectFluid(1)
        pieces.SetInputData(0, extract(FREE, own, controller)[0])
        pieces.SetInputData(1, own)
        pieces.Update()
        counts.append(np.nansum(vtk_to_numpy(pieces.GetTable().GetColumnByName("particles"))))
    return [] if RANK > 0 or 0 < counts[0] == counts[1] else [f"pieces of {counts} particles"]


def main():
    cases, check, problems = ((SURFACES, check_surface, check_named() + check_few() + check_pieces()) if sys.argv[2] == "surfaces" else
                              (SAMPLES, check_sample, check_without_points() + check_sent()))
    for number, (name, case) in enumerate(cases.items()):
        problems += check(number, name, *case) if SOME or WANTED in name else []
    problems = COMM.allreduce(problems)
    sys.exit(1 if problems else 0)


try:
    main()
except Exception:
    sys.excepthook(*sys.exc_info())
    COMM.Abort(1)  # Otherwise other ranks would wait for this one.
