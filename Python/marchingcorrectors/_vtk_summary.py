# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What a run of the VTK filter found and used, in words for a panel, and what a run may take."""
import ctypes

from . import _structs as c
from ._library import lib
from ._warnings import take_text


def estimate_cells(given, options):
    """given: what the particles are for the core."""
    least = lib.mcor_least_smoothing_length(ctypes.byref(given.input))
    return lib.mcor_estimate_cells(ctypes.byref(given.input), ctypes.byref(options), least)


class Summary:
    """Of the last run; the part of the filter that tells about it."""

    def clear_summary(self):
        self.FluidScalarRange, self.UsedIsoValues, self.IsoValueArrayName = (0.0, 0.0), "", ""
        self.UsedSmoothingLength, self.UsedVolume = "", ""
        self.UsedCubeSize = self.EstimatedCells = 0.0
        self.SurfaceMeasures = ""

    def summarize(self, arguments, iso_value_name, surface):
        given, options, statistics = arguments.input, arguments.options, surface.statistics
        if options.field != c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]:
            self.FluidScalarRange = (statistics.scalar_min, statistics.scalar_max)
        self.UsedIsoValues = ", ".join(f"{options.iso_values[i]:g}" for i in range(options.iso_count))
        self.IsoValueArrayName = iso_value_name if options.iso_value else ""
        self.UsedSmoothingLength = take_text(lib.mcor_describe_smoothing_length(
            ctypes.byref(given), ctypes.byref(statistics)))
        self.UsedVolume = take_text(lib.mcor_describe_volume(ctypes.byref(given)))
        self.UsedCubeSize = statistics.cube_size
        self.SurfaceMeasures = take_text(lib.mcor_describe_measures(ctypes.byref(statistics)))


class Box:
    """The part of the filter that draws the cells in a box alone, or has particles repeat."""

    Box, PeriodicBounds = (0.0, 1.0) * 3, (0.0,) * 6

    def SetBox(self, *sides):
        self._set_sides("Box", sides)

    def SetPeriodicBounds(self, *sides):
        self._set_sides("PeriodicBounds", sides)

    def _set_sides(self, name, sides):
        sides = tuple(float(side) for side in (sides[0] if len(sides) == 1 else sides))
        if len(sides) != 6:
            raise TypeError(f"{name} has six sides: x0, x1, y0, y1, z0, z1")
        if sides != getattr(self, name):
            setattr(self, name, sides)
            self.Modified()

    def SetPanelBoxPosition(self, x, y, z):
        b = self.Box
        self.SetBox(x, x + b[1] - b[0], y, y + b[3] - b[2], z, z + b[5] - b[4])

    def SetPanelBoxLength(self, x, y, z):
        b = self.Box
        self.SetBox(b[0], b[0] + x, b[2], b[2] + y, b[4], b[4] + z)
