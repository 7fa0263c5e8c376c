#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""VTK, Python: the free surface and an isosurface of the speed of a dam break.

extract_surface.py Data/dam_break_45k.vtp free_surface.vtp speed.vtp

PYTHONPATH must name the directory of the package marchingcorrectors, in the build tree or where it
was installed.
"""
import sys

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

from marchingcorrectors import vtkMarchingCorrectors


def write(algorithm, name):
    """Runs the pipeline, writes the surface to the file `name`, and returns it. Exits if the surface is empty."""
    writer = vtkXMLPolyDataWriter()
    writer.SetInputConnection(algorithm.GetOutputPort())
    writer.SetFileName(name)
    writer.Write()
    surface = algorithm.GetOutput()
    if algorithm.GetErrorMessage() or surface.GetNumberOfCells() == 0:
        sys.exit(f"{name}: {algorithm.GetErrorMessage() or 'the surface is empty'}")
    print(f"{name}: {surface.GetNumberOfPoints()} points, {surface.GetNumberOfCells()} triangles")
    return surface


def main(particles, free_surface, speed):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(particles)

    # Smoothing length, mass and density are found by their names.
    surface = vtkMarchingCorrectors()
    surface.SetInputConnection(reader.GetOutputPort())
    surface.SetFluidArrayName("ParticleType")  # 0 is fluid, 1 is wall.
    surface.SetFluidValue(0)
    surface.FreeSurfaceOn()
    write(surface, free_surface)

    # The same filter runs again, and keeps what depends on the particles alone.
    surface.FreeSurfaceOff()
    # A vector is contoured by its magnitude.
    surface.SetInputArrayToProcess(0, 0, 0, 0, "Velocity")
    surface.SetValue(0, 1.0)  # m/s
    mesh = write(surface, speed)

    # Every other point array was interpolated to the surface. The filter has the statistics.
    pressure = mesh.GetPointData().GetArray("Pressure").GetRange()
    cells = surface.GetRunStatistics().GetArray("CellsUsed").GetValue(0)
    print(f"pressure on it: {pressure[0]:.0f} .. {pressure[1]:.0f} Pa; {cells:.0f} cells used")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
