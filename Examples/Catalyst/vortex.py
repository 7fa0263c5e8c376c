# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A ball of particles that a vortex draws out."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints

SPACING = 0.015


def ball():
    """Returns the positions of the particles at time 0."""
    axis = np.arange(0.0, 1.0, SPACING)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    return points[np.linalg.norm(points - (0.5, 0.72, 0.5), axis=1) < 0.15]


def velocity(points):
    """Returns the velocity of a vortex in the unit square, the same at each z; its divergence is 0."""
    x, y = np.pi * points[:, 0], np.pi * points[:, 1]
    return np.stack((2 * np.sin(x) ** 2 * np.sin(y) * np.cos(y), -2 * np.sin(y) ** 2 * np.sin(x) * np.cos(x), 0 * x), 1)


def advanced(points, time):
    """Returns the positions after some time, by the midpoint rule."""
    return points + time * velocity(points + 0.5 * time * velocity(points))


def fill(particles, points, numbers):
    """Gives an empty vtkPointSet the points and their arrays. numbers: the particles' ids."""
    particles.SetPoints(vtkPoints())
    particles.GetPoints().SetData(numpy_to_vtk(points, deep=1))
    constant = np.ones(len(points))
    for name, values in (("Velocity", velocity(points)), ("SmoothingLength", 1.3 * SPACING * constant),
                         ("Volume", SPACING ** 3 * constant), ("Idp", numbers)):
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name)
        particles.GetPointData().AddArray(array)
    return particles
