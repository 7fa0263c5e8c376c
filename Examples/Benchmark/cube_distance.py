#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""How far the surface on adaptive cubes is from that on uniform ones, and back.

cube_distance.py PROGRAM PARTICLES [--every N] -- OPTIONS OF THE PROGRAM

There: from vertices on adaptive cubes to the nearest vertex on uniform ones, in the smallest cube: it is
the same crossing of the same line of the lattice, unless the finer cubes have none there. Back: from
vertices on uniform cubes (every N-th) to the adaptive surface, in the cube of the place. Levels are
worked out here from the particles' SmoothingLength, all of which take part; cubic spline, no scale.
"""
import argparse
import json
import os
import subprocess
import tempfile

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticPointLocator
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

SUPPORT = 2  # of the cubic spline, in smoothing lengths
SIDES = np.stack(np.meshgrid(*[(-1, 0, 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def keys(bricks):
    """One number for each brick."""
    shifted = bricks.astype(np.int64) + (1 << 20)
    return shifted[:, 0] << 42 | shifted[:, 1] << 21 | shifted[:, 2]


def bricks_of(keys_):
    mask = (1 << 21) - 1
    return np.stack([keys_ >> 42, keys_ >> 21 & mask, keys_ & mask], axis=1) - (1 << 20)


def split_bricks(positions, lengths, cube):
    """For each level from 1 on the keys of bricks that smaller ones take the place of."""
    level = np.floor(np.log2(lengths / lengths.min() * (1 + 1e-12))).astype(int)
    split = [np.empty(0, np.int64)]
    for finer in range(level.max()):
        size = 4 * cube * 2 ** (finer + 1)
        parents = bricks_of(split[-1])
        touched = ((parents[:, None] + SIDES) >> 1).reshape(-1, 3)
        x, support = positions[level == finer], SUPPORT * lengths[level == finer]
        near = np.floor(x / size).astype(np.int64)[:, None] + SIDES
        away = np.maximum(np.maximum(near * size - x[:, None], x[:, None] - (near + 1) * size), 0)
        reached = near[(away ** 2).sum(axis=2) <= support[:, None] ** 2]
        split.append(np.unique(keys(np.concatenate([touched, reached]))))
    return split


def cubes_at(points, split, cube):
    level = np.full(len(points), len(split) - 1)
    for at in range(len(split) - 1, 0, -1):
        brick = np.floor(points / (4 * cube * 2 ** at)).astype(np.int64)
        level[(level == at) & np.isin(keys(brick), split[at])] = at - 1
    return cube * 2.0 ** level


def there(adaptive, uniform):
    locator = vtkStaticPointLocator()
    locator.SetDataSet(uniform)
    locator.BuildLocator()
    found = points_of(uniform)
    return np.array([np.linalg.norm(found[locator.FindClosestPoint(x)] - x)
                     for x in points_of(adaptive)])


def back(points, adaptive):
    bare = vtkPolyData()
    bare.SetPoints(adaptive.GetPoints())
    bare.SetPolys(adaptive.GetPolys())
    distance, result = vtkImplicitPolyDataDistance(), vtkDoubleArray()
    distance.SetInput(bare)
    distance.FunctionValue(numpy_to_vtk(np.ascontiguousarray(points), deep=True), result)
    return np.abs(vtk_to_numpy(result))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("particles")
    parser.add_argument("--every", type=int, default=1)
    arguments, options = parser.parse_known_args()
    options = [option for option in options if option != "--"]
    surface = {}
    with tempfile.TemporaryDirectory() as folder:
        for mode in ("uniform", "adaptive"):
            path, stats = (os.path.join(folder, mode + ending) for ending in (".vtp", ".json"))
            subprocess.run([arguments.program, arguments.particles, path, "--cubes", mode, "--stats",
                            stats, *options], check=True, stdout=subprocess.DEVNULL)
            surface[mode] = read(path)
            print(f"{mode:9}{surface[mode].GetNumberOfCells():>10} triangles")
        with open(stats, encoding="utf-8") as file:
            cube = json.load(file)["parameters"]["cube_size"]
    particles = read(arguments.particles)
    lengths = vtk_to_numpy(particles.GetPointData().GetArray("SmoothingLength")).astype(float)
    split = split_bricks(points_of(particles), lengths, cube)
    off = there(surface["adaptive"], surface["uniform"]) / cube
    print(f"there: {np.mean(off <= 0.05):.4%} within 0.05 of the smallest cube; "
          f"99.9 % within {np.quantile(off, 0.999):.3g}")
    points = points_of(surface["uniform"])[::arguments.every]
    off = back(points, surface["adaptive"]) / cubes_at(points, split, cube)
    print(f"back: {np.mean(off <= 0.15):.4%} within 0.15, {np.mean(off <= 0.35):.4%} within 0.35 of "
          f"the local cube; 99 % within {np.quantile(off, 0.99):.3g}, 99.9 % within "
          f"{np.quantile(off, 0.999):.3g}")


if __name__ == "__main__":
    main()
