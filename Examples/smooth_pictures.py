#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the picture of smooth surfaces in the guide: smooth_pictures.py PROGRAM OUTPUT.png

Needs vtk, numpy and pysplashsurf. Without a display: Testing/with-display.sh python3 smooth_pictures.py ...
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pysplashsurf
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray
from vtkmodules.vtkRenderingCore import vtkCamera, vtkLightKit

from pictures import DATA, caption, mesh_actor, panel, poly_data, read, save

SIZE = (560, 520)


def extract(program, *words):
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "surface.vtp"
        subprocess.run([program, DATA, output, "--free-surface", "--fluid", "ParticleType=0", "--no-attributes", "--quiet", *words],
                       check=True)
        return read(output).GetOutput()


def splashsurf():
    """Its recommended settings, with cubes of half a particle radius."""
    particles = read().GetOutput()
    fluid = vtk_to_numpy(particles.GetPointData().GetArray("ParticleType")) == 0
    x = vtk_to_numpy(particles.GetPoints().GetData())[fluid].astype(np.float32)
    mass, density = (vtk_to_numpy(particles.GetPointData().GetArray(name))[fluid] for name in ("Mass", "Density"))
    radius = 0.5 * float(np.median(mass / density)) ** (1 / 3)
    mesh, _ = pysplashsurf.reconstruction_pipeline(
        x, particle_radius=radius, smoothing_length=2.0, cube_size=0.5, iso_surface_threshold=0.6, mesh_smoothing_weights=True,
        mesh_smoothing_weights_normalization=13.0, mesh_smoothing_iters=25, normals_smoothing_iters=10, mesh_cleanup=True,
        compute_normals=True)
    normals = np.asarray(mesh.point_attributes["normals"], np.float32) if hasattr(mesh, "point_attributes") else None
    mesh = getattr(mesh, "mesh", mesh)
    points, triangles = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.triangles, np.int64)
    data, cells = poly_data(points), vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(triangles.ravel(), deep=1))
    data.SetPolys(cells)
    if normals is not None:
        data.GetPointData().SetNormals(numpy_to_vtk(normals, deep=1))
    return data


def main():
    program, picture = sys.argv[1:]
    meshes = [("as it is", extract(program)), ("--smooth", extract(program, "--smooth")), ("splashsurf", splashsurf())]
    camera, renderers = vtkCamera(), []
    bounds = meshes[0][1].GetBounds()
    focus = [bounds[0] + 0.7 * (bounds[1] - bounds[0]), bounds[2] + 0.4 * (bounds[3] - bounds[2]), 0.5 * (bounds[4] + bounds[5])]
    size = bounds[1] - bounds[0]
    camera.SetFocalPoint(*focus)
    camera.SetPosition(focus[0] - 0.25 * size, focus[1] + 0.35 * size, focus[2] + 0.8 * size)
    camera.SetViewUp(0, 1, 0)
    camera.SetViewAngle(20)
    for i, (name, mesh) in enumerate(meshes):
        actor = mesh_actor(mesh, 0.36, 0.60, 0.85)
        actor.GetProperty().SetSpecular(0.4)
        actor.GetProperty().SetSpecularPower(40)
        renderer = panel((i / len(meshes), 0, (i + 1) / len(meshes), 1), actor,
                         caption(f"{name}: {mesh.GetNumberOfPolys():,} triangles", 20, (12, 10)))
        renderer.SetActiveCamera(camera)
        vtkLightKit().AddLightsToRenderer(renderer)
        renderer.ResetCameraClippingRange()
        renderers.append(renderer)
    save(renderers, (SIZE[0] * len(meshes), SIZE[1]), picture)


if __name__ == "__main__":
    main()
