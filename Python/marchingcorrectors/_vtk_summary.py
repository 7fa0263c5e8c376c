# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What a run of the VTK filter found and used, in words for a panel, and what a run may take."""
import ctypes

import numpy as np

from . import _structs as c
from ._library import lib
from ._vtk_particles import to_numpy

HUGE_CELLS = 1e9


def estimate_cells(particles, given, options):
    """About how many cubes, in a plane squares, of the virtual grid the fluid (in the box, if there is one) fills: a particle takes
    (h / 1.3)^3. given: what they are for the core."""
    choice = particles.choice
    estimated = bool(choice.EstimateSmoothingLength)
    fluid = np.ones(particles.count, bool) if particles.solid is None else ~particles.solid
    if not fluid.any() or (estimated and options.cube_size > 0):
        return 0.0
    value = 1.0 if estimated else particles.values["smoothing_length"]
    h = np.full(particles.count, value) if isinstance(value, float) else to_numpy(value)[:, 0]
    h = h[fluid].astype(np.float64)
    drawn = is_drawn(to_numpy(particles.positions), options)[fluid]
    plane = lib.mcor_find_dimension(ctypes.byref(given.input), None, options.dimension) == 2
    if options.level_limit:  # cubes are larger where particles are
        h /= 2 ** np.minimum(np.floor(np.log2(h / h.min())), options.level_limit)
    radius = bool(choice.SmoothingLengthIsSupportRadius) and not estimated
    per_length = 1 / lib.mcor_support_factor(options.sph_kernel) if radius else 1.0
    size = options.cube_size if options.cube_size > 0 else options.cube_size_factor * float(h.min()) * per_length
    power = 2 if plane else 3
    return float((h[drawn] ** power).sum()) * (per_length / 1.3) ** power / size ** power if size > 0 else 0.0


def is_drawn(positions, options):
    """Which particles are where cells are drawn."""
    low, high = np.array(options.box[:]).reshape(3, 2).T
    return ((positions >= low) & ((positions < high) | (positions == low))).all(1) | (not any(options.box))


def is_given(array):
    return bool(array.data or array.constant)


def describe(array):
    return "array " + (array.name or b"").decode() if array.data else f"{array.constant:g}"


def describe_smoothing_length(given, statistics):
    text = f"{statistics.smoothing_length_min:g}"
    if statistics.smoothing_length_max > statistics.smoothing_length_min:
        text += f" to {statistics.smoothing_length_max:g}"
    if given.estimate_smoothing_length:
        return text + " (estimated)"
    how = describe(given.smoothing_length) if given.smoothing_length.data else "given"
    return f"{text} ({how}{', support radius' if given.smoothing_length_is_support_radius else ''})"


def describe_volume(given):
    if is_given(given.volume):
        return describe(given.volume)
    if is_given(given.mass):
        return f"{describe(given.mass)} / {describe(given.density) if is_given(given.density) else 'density summed from it'}"
    return "computed from the positions"


def describe_measures(statistics):
    if statistics.dimension == 2 and statistics.length > 0:
        return f"two dimensions: length {statistics.length:g}" + (
            f", area {statistics.area:g}" if statistics.area > 0 else "; open, so that it has no area")
    if statistics.area <= 0:
        return ""
    return f"area {statistics.area:g}" + (f", volume {statistics.volume:g}" if statistics.is_closed
                                          else "; open, so that it has no volume")


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
        self.UsedSmoothingLength = describe_smoothing_length(given, statistics)
        self.UsedVolume, self.UsedCubeSize = describe_volume(given), statistics.cube_size
        self.SurfaceMeasures = describe_measures(statistics)

    def GetFluidScalarRange(self):
        return self.FluidScalarRange

    def GetUsedIsoValues(self):
        return self.UsedIsoValues

    def GetIsoValueArrayName(self):
        return self.IsoValueArrayName

    def GetUsedSmoothingLength(self):
        return self.UsedSmoothingLength

    def GetUsedVolume(self):
        return self.UsedVolume

    def GetUsedCubeSize(self):
        return self.UsedCubeSize

    def GetSurfaceMeasures(self):
        return self.SurfaceMeasures

    def GetEstimatedCells(self):
        return self.EstimatedCells


class Box:
    """The part of the filter that draws the cells in a box alone, or has particles repeat."""

    Box, PeriodicBounds = (0.0, 1.0) * 3, (0.0,) * 6

    def SetBox(self, *sides):
        self._set_sides("Box", sides)

    def GetBox(self):
        return self.Box

    def SetPeriodicBounds(self, *sides):
        self._set_sides("PeriodicBounds", sides)

    def GetPeriodicBounds(self):
        return self.PeriodicBounds

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
