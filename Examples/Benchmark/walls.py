#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Where surfaces end at walls, for each choice of --solids: distance of their border from the first layer
of wall particles, in smoothing lengths (below 0: behind it), and the share of points behind it.

    walls.py PROGRAM FILE...

Walls are the planes of the solid particles' bounding box, and the box around the solids that stand on its
floor. A file without solids gets a layer of them, one particle spacing outside of the fluid."""
import argparse
import pathlib
import subprocess
import tempfile

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

CHOICES = {
    "weight": ["--solids", "weight"],
    "ignore": ["--solids", "ignore"],
    "wall, share 0.5": ["--solids", "wall", "--wall-share", "0.5"],
    "wall, share 0.85": ["--solids", "wall", "--wall-share", "0.85"],
    "wall, measured": ["--solids", "wall"],
}
NEAR = 1.5  # of the border, what is so near to a wall, in smoothing lengths, ends there


def read(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name)).astype(float)


def positions(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


class Walls:
    """The planes of a tank, and a box that stands in it; y is up."""

    def __init__(self, solid, h):
        self.low, self.high = solid.min(axis=0), solid.max(axis=0)
        inside = self.tank(solid) > h
        self.box = (solid[inside].min(axis=0), solid[inside].max(axis=0)) if inside.any() else None

    def tank(self, points):
        sides = [points[:, a] - self.low[a] for a in range(3)]
        sides += [self.high[a] - points[:, a] for a in range(3)]
        return numpy.min(sides, axis=0)

    def distance(self, points):
        """From the wall; below 0 behind it."""
        tank = self.tank(points)
        if self.box is None:
            return tank
        low, high = self.box
        low = numpy.where(numpy.arange(3) == 1, self.low, low)
        beside = numpy.max(numpy.maximum(low - points, points - high), axis=1)
        around = numpy.linalg.norm(
            numpy.maximum(0, numpy.maximum(low - points, points - high)), axis=1)
        return numpy.minimum(tank, numpy.where(beside > 0, around, beside))


def layer(low, high, step):
    """Particles on the planes of a box."""
    counts = numpy.ceil((high - low) / step).astype(int)
    grid = [numpy.linspace(low[a], high[a], counts[a] + 1) for a in range(3)]
    x, y, z = numpy.meshgrid(*grid, indexing="ij")
    points = numpy.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)
    on = (points == low).any(axis=1) | (points == high).any(axis=1)
    return points[on]


def add_walls(data, path):
    """Writes the particles with a layer of solids, of the fluid's volume, around them."""
    fluid, h = positions(data), array(data, "SmoothingLength")
    spacing = h.min()
    solid = layer(fluid.min(axis=0) - spacing, fluid.max(axis=0) + spacing, spacing)
    points = numpy.concatenate([fluid, solid])
    made = vtk.vtkPolyData()
    made.SetPoints(vtk.vtkPoints())
    made.GetPoints().SetData(numpy_to_vtk(points, deep=1))
    count = len(solid)
    columns = {
        "SmoothingLength": (h, spacing),
        "Volume": (array(data, "Mass") / 1000, spacing ** 3),
        "Speed": (array(data, "Speed"), 0),
        "ParticleType": (numpy.zeros(len(fluid)), 1),
    }
    for name, (values, of_solids) in columns.items():
        column = numpy_to_vtk(numpy.concatenate([values, numpy.full(count, of_solids)]), deep=1)
        column.SetName(name)
        made.GetPointData().AddArray(column)
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(made)
    writer.SetDataModeToBinary()
    writer.Write()


def border(surface):
    """Points on edges that one triangle alone has."""
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.BoundaryEdgesOn()
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    found = edges.GetOutput()
    return positions(found) if found.GetNumberOfPoints() else numpy.zeros((0, 3))


def measure(program, path, what, choice, walls, h, scratch):
    out = scratch / "surface.vtp"
    command = [program, str(path), str(out), *what, "--fluid", "ParticleType=0", *choice, "--quiet"]
    subprocess.run(command, check=True)
    surface = read(out)
    ends = walls.distance(border(surface)) / h
    ends = ends[ends < NEAR]
    behind = (walls.distance(positions(surface)) < -0.01 * h).mean()
    if len(ends) == 0:
        return "no border there", behind
    quarters = numpy.percentile(ends, [5, 50, 95])
    return "%+.2f (%+.2f to %+.2f)" % (quarters[1], quarters[0], quarters[2]), behind


def report(program, path, scratch):
    data = read(path)
    if not data.GetPointData().HasArray("ParticleType"):
        path, original = scratch / pathlib.Path(path).name, path
        add_walls(data, path)
        data = read(path)
        print(f"{original}, with walls")
    else:
        print(path)
    solid = array(data, "ParticleType") != 0
    h = numpy.median(array(data, "SmoothingLength")[~solid])
    walls = Walls(positions(data)[solid], h)
    has_pressure = data.GetPointData().HasArray("Pressure")
    scalar = ["--scalar", "Pressure", "--iso", "1000"] if has_pressure else ["--scalar", "Speed", "--iso", "1.5"]
    for what in (scalar, ["--free-surface"]):
        print("  " + " ".join(what))
        for name, choice in CHOICES.items():
            if "measured" in name and "--free-surface" in what:
                continue  # 0.5 there
            ends, behind = measure(program, path, what, choice, walls, h, scratch)
            print(f"    {name:18} border at {ends:28} {100 * behind:5.1f} % of the points behind")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program", help="marching-correctors")
    parser.add_argument("files", nargs="+", help="particle files")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        for path in options.files:
            report(options.program, path, pathlib.Path(scratch))


if __name__ == "__main__":
    main()
