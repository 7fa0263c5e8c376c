#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Adaptive cubes: the surface of a body whose particles are finer and finer towards one point.

graded.py DIRECTORY     (without a display: Testing/with-display.sh python3 graded.py ...)

Draws graded.png into DIRECTORY: the whole, and two looks from nearer, with the triangles' edges. The body
is a half-space below rings of waves, each half as high and as wide as the next one outside. PYTHONPATH
must name the directory of the package marchingcorrectors.
"""
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
# pylint: disable=wrong-import-position
from pictures import caption, mesh_actor, panel, poly_data, save  # noqa: E402
from marchingcorrectors import vtkMarchingCorrectors  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402

FINEST, SHARE = 0.002, 0.1  # a particle's spacing, and its growth with the distance from the point
WATER, LINE = (0.62, 0.80, 0.95), (0.25, 0.35, 0.6)


def height(points):
    """Of the waves: as wide and as high as they are far from the point."""
    distance = np.hypot(points[:, 0], points[:, 1]) + 0.5 * FINEST
    return 0.1 * distance * np.cos(2 * np.pi * np.log2(distance))


def particles():
    """Cubes, divided until they are fine enough for their distance: their centres, and their edges."""
    centres, edge, found = np.zeros((1, 3)), 2.0, []
    while len(centres):
        wanted = np.maximum(FINEST, SHARE * np.linalg.norm(centres, axis=1))
        done = edge <= wanted
        inside = done & (centres[:, 2] < height(centres)) & (np.linalg.norm(centres, axis=1) < 0.95)
        found.append(np.column_stack((centres[inside], np.full(inside.sum(), edge))))
        corners = np.stack(np.meshgrid(*[(-0.25, 0.25)] * 3), -1).reshape(-1, 3)
        centres = (centres[~done][:, None] + edge * corners).reshape(-1, 3)
        edge /= 2
    return np.concatenate(found)


def free_surface(data):
    extract = vtkMarchingCorrectors()
    extract.SetInputData(data)
    extract.FreeSurfaceOn()
    extract.SetCubeSizeModeToAdaptive()
    extract.Update()
    if extract.GetErrorMessage() or extract.GetOutput().GetNumberOfCells() == 0:
        sys.exit(extract.GetErrorMessage() or "the surface is empty")
    return extract.GetOutput(), extract.GetRunStatistics()


def look(surface, zoom, viewport):
    actor = mesh_actor(surface, *WATER)
    actor.GetProperty().EdgeVisibilityOn()
    actor.GetProperty().SetEdgeColor(*LINE)
    renderer = panel(viewport, actor, caption("all of it" if zoom == 1 else f"{zoom} times as near", 18, (12, 10)))
    camera = renderer.GetActiveCamera()
    camera.SetPosition(0, -0.9 / zoom, 1.2 / zoom)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(40)
    renderer.ResetCameraClippingRange()
    return renderer


def main(directory):
    rows = particles()
    # 1.5 edges: the kernel reaches across the step from one edge to the next.
    surface, statistics = free_surface(poly_data(rows[:, :3].copy(), SmoothingLength=1.5 * rows[:, 3], Volume=rows[:, 3] ** 3))
    by_level = vtk_to_numpy(statistics.GetArray("TrianglesOfLevel"))
    print(f"{len(rows)} particles of spacing {rows[:, 3].min():.2g} to {rows[:, 3].max():.2g}, "
          f"{surface.GetNumberOfCells()} triangles, by level: {', '.join(str(int(n)) for n in by_level)}")
    thirds = [(i / 3, 0, (i + 1) / 3, 1) for i in range(3)]
    save([look(surface, zoom, part) for zoom, part in zip((1, 6, 36), thirds)], (1350, 450),
         os.path.join(directory, "graded.png"))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
