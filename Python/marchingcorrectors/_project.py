# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""project: integrals along lines of sight."""
from __future__ import annotations

import ctypes
from dataclasses import dataclass, field as dataclass_field
from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, Union

import numpy as np

from . import _structs as c
from ._arrays import SUMMED, contiguous, number, set_option, statistics, take
from ._call import called, of_particles, prepare
from ._library import InvalidArgument, lib
from ._options import PROJECT
from ._surface import Result
from ._units import Units, without_unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._call import Keywords, Positions


@dataclass(eq=False, repr=False)
class Projection(Result):
    """An image of integrals along lines of sight; lengths have the unit of the positions (L)."""

    values: np.ndarray  #: (rows, columns) float64: means over pixels, scalar unit x L; the first row is the lowest
    extent: np.ndarray  #: (4,): left, right, lower and upper side, along the axes; as of matplotlib's imshow
    axes: np.ndarray  #: (3, 3): unit vectors along a row, from row to row, and the line of sight
    depth: float  #: where what is seen begins, along the line of sight
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    @property
    def pixel_area(self) -> float:
        """L^2. values.sum() * pixel_area is the mass in the image, where the values are column densities."""
        left, right, lower, upper = self.extent
        return float((right - left) * (upper - lower) / max(self.values.size, 1))

    def __repr__(self):
        rows, columns = self.values.shape
        return f"<Projection: {columns} x {rows} pixels>"


def _direction(direction):
    if isinstance(direction, str) and direction in ("x", "y", "z"):
        return [float(direction == axis) for axis in "xyz"]
    numbers = np.zeros(0 if isinstance(direction, str) else 3)
    if not isinstance(direction, (str, type(None))):
        numbers = np.ravel(contiguous(direction, "direction"))
    if len(numbers) != 3 or direction is not None and not numbers.any():
        raise InvalidArgument(f"direction is {direction!r}; it must be \"x\", \"y\", \"z\" or three numbers that are not all 0.")
    return numbers.tolist()


@of_particles(PROJECT, masses=True)
def project(positions: Positions, scalar: Optional[ArrayLike] = None, *,
            direction: Union[None, str, Sequence[float]] = None,
            resolution: int = 512,
            weighted_by: Optional[ArrayLike] = None,
            box: Optional[Sequence[float]] = None,
            **words: Unpack[Keywords]) -> Projection:
    """Column densities, or integrals of another scalar along lines of sight, as an image.

    Example: image = project(x, smoothing_length=h, mass=m, direction="z"); plt.imshow(image.values, origin="lower", extent=image.extent)

    Returns a Projection: values and extent of the image, exact means over pixels, so that all of the mass is there.

    scalar: what is integrated: (particles,), or (particles, components): then its magnitude, or one component. Without
        it, the density: the image is the mass of what is seen by area, which needs masses, or densities.
    direction: of the lines of sight: "x", "y", "z", or any three numbers; without it the constant axis of particles in
        a plane, else z.
    resolution: pixels along the longer side of the image.
    weighted_by: (particles,): the image is the mean of the scalar along the line of sight, with these weights; by the
        array of masses, the mean by mass. NaN where there is nothing.
    box: (x0, x1, y0, y1, z0, z1): what is seen; sides may be infinite. Along x, y or z, particles count, with all of
        their kernel, whose positions are in it along the line of sight. Without it the period, or all that particles
        reach.

    The other arguments are those of isosurface().

    {options}
    """
    units = Units(positions)
    volume, mass, density = map(words.get, ("volume", "mass", "density"))
    if isinstance(scalar, str) and scalar == SUMMED:  # of particles without that array: the sum of their masses
        scalar = None
    # Masses and densities that volumes are not made of.
    is_made = volume is None and mass is not None or isinstance(volume, str) and scalar is not None
    arguments = prepare(units, words if is_made else {**words, "mass": None, "density": None})
    if not is_made:
        arguments.set_quantities({"mass": without_unit(mass), "density": without_unit(density)})
    if scalar is not None:
        arguments.input.scalar = arguments.per_particle(without_unit(scalar), "scalar")
        if arguments.input.scalar.components == 1:
            arguments.input.scalar_component = 0
    view = c.mcor_view()
    view.direction[:] = _direction(direction)
    set_option(view, "box", "double[6]", units.lengths(box, "box"))
    view.resolution = number("resolution", "int", resolution)
    if weighted_by is not None:
        view.weight = arguments.input.mass if weighted_by is mass else arguments.per_particle(without_unit(weighted_by), "weight")
    with called(lib.mcor_project, c.mcor_projection, arguments, ctypes.byref(view)) as found:
        columns, rows = found.size
        values = take(found.values, (rows, columns))
        low, pixel = found.low, found.pixel
        return Projection(
            values=np.zeros((0, 0)) if values is None else values, axes=np.array(found.axes).reshape(3, 3), depth=low[2],
            extent=np.array([low[0], low[0] + columns * pixel[0], low[1], low[1] + rows * pixel[1]]),
            statistics=statistics(found.statistics))
