# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""gauge: levels on lines; flux: what flows through sections."""
from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass, field as dataclass_field
from typing import TYPE_CHECKING, Any, Dict, List

import numpy as np

from . import _structs as c
from ._arrays import as_bytes, contiguous, statistics, take_rows
from ._call import called, of_particles, prepare
from ._library import InvalidArgument, lib, say, warn
from ._options import GAUGE
from ._surface import Result
from ._units import Units, without_unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._call import Keywords, Positions

STATES = np.array(["dry", "wet", "full"])


@dataclass(eq=False, repr=False)
class Gauges(Result):
    """Readings of lines; lengths are from the line's beginning, unit of the positions (L). NaN where dry."""

    names: List[str]  #: of the lines; "0", "1", ... where none were given
    state: np.ndarray  #: (lines,) "dry": no fluid; "full": fluid at the line's end; "wet": else
    first: np.ndarray  #: (lines,) float64: where fluid first ends
    last: np.ndarray  #: (lines,) float64: where it last ends; at the line's end where full
    depth: np.ndarray  #: (lines,) float64: length in fluid
    place: np.ndarray  #: (lines, 3) float64: of `last`
    outside: np.ndarray  #: (lines,) bool: no particle reaches the line
    crossings: Dict[str, np.ndarray]  #: {name: float64}: where each line goes through the surface
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    def __repr__(self):
        counts = ", ".join(f"{int((self.state == state).sum())} {state}" for state in STATES)
        return f"<Gauges: {len(self.names)} lines, {counts}>"


def warn_of_dry(arguments, noun, names, outside):
    """Warns of places that no particle reaches. If there is no fluid, another warning says so."""
    dry = [name for name, is_dry in zip(names, outside) if is_dry and arguments.input.count]
    if dry:
        warn(say("PLACE_DRY", noun, dry[0]) if len(dry) == 1 else say("PLACES_DRY", len(dry), len(names), noun, dry[0]))


def _as_lines(lines, units):
    """Returns the lines' names, and an array (lines, 2, 3)."""
    names = [str(name) for name in lines] if isinstance(lines, Mapping) else None
    values = list(lines.values()) if isinstance(lines, Mapping) else lines
    array = contiguous(units.lengths(values, "array of lines"), "array of lines").astype(np.float64)
    if array.size == 0:
        array = array.reshape(0, 2, 3)
    if array.ndim == 2 and names is None:
        array = array[np.newaxis]
    if array.ndim != 3 or array.shape[1:] != (2, 3):
        raise InvalidArgument(f"Lines have the shape (lines, 2, 3), from and to each, not {array.shape}.")
    return names or [str(i) for i in range(len(array))], array


@of_particles(GAUGE)
def gauge(positions: Positions, lines: Any, iso: float = 0.5, **words: Unpack[Keywords]) -> Gauges:
    """Water levels: where straight lines cross the free surface, every crossing.

    Example: gauge(x, {"mast": ((0.5, 0, 0), (0.5, 1, 0))}, smoothing_length=h, mass=m, density=rho).last

    Returns Gauges: state, first, last, depth and place of each line, and all crossings by name.

    lines: (lines, 2, 3), L: from and to of each; or one line, (2, 3); or {name: (from, to)}.
    iso: the sum of the weights at which the fluid ends, above 0, as of free_surface().

    Solids count in the sum, and the fluid ends where they weigh more than it (wall_share). The other
    arguments are those of isosurface().

    {options}
    """
    units = Units(positions)
    arguments = prepare(units, words, nothing="all gauges are dry")
    names, array = _as_lines(lines, units)
    arguments.set_iso_values(iso)
    structures = (c.mcor_gauge_line * max(len(array), 1))()
    for line, name, ends in zip(structures, names, array):
        getattr(line, "from")[:], line.to[:], line.name = ends[0], ends[1], as_bytes(name)
    with called(lib.mcor_gauge, c.mcor_gauges, arguments, structures, len(array)) as found:
        rows, crossings = take_rows(found.readings, found.count), take_rows(found.crossings, found.crossing_count)
        columns = {name: rows[name].copy() for name in ("first", "last", "depth", "place")}
        warn_of_dry(arguments, "gauge", names, rows["outside"])
        return Gauges(
            names=names, state=STATES[rows["state"]], outside=rows["outside"].astype(bool), **columns,
            crossings={name: crossings[row["first_crossing"]:][:row["crossing_count"]].copy() for name, row in zip(names, rows)},
            statistics=statistics(found.statistics))


FORMS = ('(3, 3): a rectangle\'s corner and two ends; ("disc", centre, normal, radius); '
         '("box", six bounds); (n, 3, 3): triangles; (2, 3) or (n, 2, 3): lines in two dimensions')


@dataclass(eq=False, repr=False)
class Fluxes(Result):
    """Fluxes through the part of each section that is in fluid; units of positions (L), velocities and densities."""

    names: List[str]  #: of the sections; "0", "1", ... where none were given
    area: np.ndarray  #: (sections,) float64: of that part, L^2; in two dimensions a length
    volume_flux: np.ndarray  #: (sections,) float64: the integral of v . n
    mass_flux: np.ndarray  #: (sections,) float64: of rho v . n; NaN without densities
    velocity: np.ndarray  #: (sections,) float64: volume_flux / area; NaN where the area is 0
    outside: np.ndarray  #: (sections,) bool: no particle reaches the section
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    def __repr__(self):
        return f"<Fluxes: {len(self.names)} sections, {int((self.area > 0).sum())} in fluid>"


def _as_section(section, name, units):
    """Returns a section's kind of shape, points (n, 3) and radius."""
    def numbers(values, shape):
        array = contiguous(values, "section").astype(np.float64)
        if array.shape != shape:
            raise InvalidArgument(f"Section '{name}' has an array of the shape {array.shape} where it is {shape}. A section is "
                                  f"{FORMS}.")
        return array

    kinds = c.ENUMS["mcor_section_shape"]
    if isinstance(section, (tuple, list)) and len(section) and isinstance(section[0], str):
        lengths = [units.lengths(each, "section") for each in section[1:2] + section[3:]]
        if section[0] == "disc" and len(section) == 4:
            points = [numbers(lengths[0], (3,)), numbers(without_unit(section[2]), (3,))]
            return kinds["MCOR_SECTION_DISC"], np.stack(points), float(numbers(lengths[1], (1,))[0])
        if section[0] == "box" and len(section) == 2:
            return kinds["MCOR_SECTION_BOX"], np.ascontiguousarray(numbers(lengths[0], (6,)).reshape(3, 2).T), 0.0
        raise InvalidArgument(f"Section '{name}' begins with '{section[0]}'. A section is {FORMS}.")
    array = contiguous(units.lengths(section, "section"), "section").astype(np.float64)
    shape = {(3, 3): "RECTANGLE", (2, 3): "LINES"}.get(array.shape)
    if array.ndim == 3 and array.shape[1:] in ((3, 3), (2, 3)):
        shape = "TRIANGLES" if array.shape[1] == 3 else "LINES"
    if shape is None:
        raise InvalidArgument(f"Section '{name}' has the shape {array.shape}. A section is {FORMS}.")
    return kinds["MCOR_SECTION_" + shape], array.reshape(-1, 3), 0.0


def _as_sections(sections, units):
    """Returns names and structures, and the arrays that must stay alive as long as the structures."""
    is_one = isinstance(sections, np.ndarray) or (
        isinstance(sections, (tuple, list)) and len(sections) > 0 and (isinstance(sections[0], str) or np.ndim(sections) == 2))
    if not is_one and not isinstance(sections, (Mapping, tuple, list)):
        raise InvalidArgument(f"The sections are of the type {type(sections).__name__}; they must be one section, a list of them or "
                              f"{{name: section}}. A section is {FORMS}.")
    given = [sections] if is_one else list(sections.values()) if isinstance(sections, Mapping) else list(sections)
    names = [str(name) for name in sections] if isinstance(sections, Mapping) else [str(i) for i in range(len(given))]
    made, kept = (c.mcor_section * max(len(given), 1))(), []
    for structure, section, name in zip(made, given, names):
        structure.shape, points, structure.radius = _as_section(section, name, units)
        kept.append(points)
        structure.points = points.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        structure.point_count, structure.name = len(points), as_bytes(name)
    return names, made, kept


@of_particles(GAUGE)
def flux(positions: Positions, velocity: ArrayLike, sections: Any, iso: float = 0.5, **words: Unpack[Keywords]) -> Fluxes:
    """Fluxes through sections, to 1e-5 of the largest flux that the velocities there allow.

    Example: flux(x, v, {"gate": ("disc", (1, 0, 0), (1, 0, 0), 0.2)}, smoothing_length=h, mass=m, density=rho).mass_flux

    Returns Fluxes: area, volume_flux, mass_flux and velocity of each section.

    velocity: (particles, 3), L per unit of time; in two dimensions (particles, 2) will do.
    sections: one, a list of them, or {name: section}. A section is (3, 3): a rectangle's corner and two
        ends, whose cross product is the normal; ("disc", centre, normal, radius); ("box", six bounds): its
        sides, with normals outwards; (n, 3, 3): triangles, with normals by the right-hand rule,
        or outwards if they are a closed surface; in two dimensions (2, 3) or (n, 2, 3): lines, with normals
        to their right.
    iso: the sum of the weights at which the fluid ends, above 0, as of free_surface().
    density: (particles,) or one value, for mass fluxes; or mass and volume, which give it.

    Solids count in the sum, and the fluid ends where they weigh more than it (wall_share); the means are those of the
    fluid. The other arguments are those of isosurface().

    {options}
    """
    units = Units(positions)
    arguments = prepare(units, words, wants=["flow"], nothing="nothing flows", velocity=velocity)
    names, array, _kept = _as_sections(sections, units)
    arguments.set_iso_values(iso)
    with called(lib.mcor_flux, c.mcor_fluxes, arguments, array, len(names)) as found:
        rows = take_rows(found.readings, found.count)
        columns = {name: rows[name].copy() for name in ("area", "volume_flux", "mass_flux", "velocity")}
        warn_of_dry(arguments, "section", names, rows["outside"])
        return Fluxes(names=names, outside=rows["outside"].astype(bool), **columns, statistics=statistics(found.statistics))
