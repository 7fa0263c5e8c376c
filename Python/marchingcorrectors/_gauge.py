# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""gauge: where lines cross the free surface."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field as dataclass_field
from typing import TYPE_CHECKING, Any, Dict, List

import numpy as np

from . import _structs as c
from ._arrays import as_bytes, contiguous, statistics, take_rows
from ._call import called, of_particles, prepare
from ._library import InvalidArgument, lib
from ._options import GAUGE
from ._surface import Result
from ._units import Units

if TYPE_CHECKING:
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


def _as_lines(lines, units):
    """Names, and an array (lines, 2, 3)."""
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

    Solids do not count. The other arguments are those of isosurface().

    {options}
    """
    units = Units(positions)
    arguments = prepare(units, words)
    names, array = _as_lines(lines, units)
    arguments.set_iso_values(iso)
    structures = (c.mcor_gauge_line * max(len(array), 1))()
    for line, name, ends in zip(structures, names, array):
        getattr(line, "from")[:], line.to[:], line.name = ends[0], ends[1], as_bytes(name)
    with called(lib.mcor_gauge, c.mcor_gauges, arguments, structures, len(array)) as found:
        rows, crossings = take_rows(found.readings, found.count), take_rows(found.crossings, found.crossing_count)
        columns = {name: rows[name].copy() for name in ("first", "last", "depth", "place")}
        return Gauges(
            names=names, state=STATES[rows["state"]], outside=rows["outside"].astype(bool), **columns,
            crossings={name: crossings[row["first_crossing"]:][:row["crossing_count"]].copy() for name, row in zip(names, rows)},
            statistics=statistics(found.statistics))
