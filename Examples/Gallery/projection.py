#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the picture of the guide's page on projections: a disc galaxy's column density, face on and from the side, and
beside it what counting particles in pixels gives.

projection.py DIRECTORY

PYTHONPATH must name the directory of the package marchingcorrectors. Writes DIRECTORY/projection.png.
"""
import os
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
# pylint: disable=wrong-import-position
from marchingcorrectors import vtkSPHProjection  # noqa: E402
from pictures import poly_data  # noqa: E402

COUNT, SIZE, SIDE, DECADES = 60000, 480, 1.0, 3.5
COLOURS = np.array([[0, 0, 4], [51, 13, 103], [136, 34, 106], [211, 67, 58], [249, 142, 9], [252, 255, 164]])


def galaxy():
    """Gas in two spiral arms, thin in the middle; arrays h and m."""
    random = np.random.default_rng(5)
    radius = 0.22 * random.gamma(2, size=COUNT)
    angle = random.uniform(0, 2 * np.pi, COUNT)
    angle -= 0.42 * np.sin(2 * (angle - 4 * np.log(radius + 0.05)))
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle),
                       0.03 * (0.4 + radius) * random.normal(size=COUNT)], -1)
    return poly_data(places, m=np.full(COUNT, 1 / COUNT)), places


def seen(particles, direction, height):
    """The column density, rows upwards."""
    look = vtkSPHProjection()
    look.SetInputData(particles)
    look.EstimateSmoothingLengthOn()
    look.SetSmoothingLengthEstimate(look.ESTIMATE_NEIGHBORS)
    look.SetDirection(direction)
    look.SetResolution(SIZE)
    look.UseBoxOn()
    look.SetBox(-SIDE, SIDE, -SIDE, SIDE, -height, height)
    look.Update()
    image = look.GetImage()
    columns, rows = [n for n in image.GetDimensions() if n > 1]
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns)


def painted(values, highest):
    """Logarithmic colours."""
    with np.errstate(divide="ignore"):
        t = np.clip(1 + np.log10(values / highest) / DECADES, 0, 1) * (len(COLOURS) - 1)
    low = np.minimum(t.astype(int), len(COLOURS) - 2)
    return (COLOURS[low] + (t - low)[..., None] * (COLOURS[low + 1] - COLOURS[low])).astype(np.uint8)


def main():
    particles, places = galaxy()
    face = seen(particles, (0, 0, 1), SIDE)
    edge = seen(particles, (0, 1, 0), 0.3 * SIDE)
    rows = []
    for values, (x, y), high in ((edge, (0, 2), 0.3 * SIDE), (face, (0, 1), SIDE)):
        counted, _, _ = np.histogram2d(places[:, y], places[:, x], values.shape, [[-high, high], [-SIDE, SIDE]])
        counted *= (SIZE / (2 * SIDE)) ** 2 / COUNT
        gap = np.full((len(values), 8, 3), 255, np.uint8)
        rows += [np.concatenate([painted(values, face.max()), gap, painted(counted, face.max())], 1)]
    pixels = np.concatenate([rows[0], np.full((8, *rows[0].shape[1:]), 255, np.uint8), rows[1]])
    image = vtkImageData()
    image.SetDimensions(pixels.shape[1], pixels.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels.reshape(-1, 3), deep=True))
    writer = vtkPNGWriter()
    writer.SetFileName(os.path.join(sys.argv[1], "projection.png"))
    writer.SetInputData(image)
    writer.Write()


main()
