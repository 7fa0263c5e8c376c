# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Arrays with units, of pint, unyt or astropy: all lengths are converted to the unit of the positions. If one argument
has a unit and another has none, both are refused, because nobody can know what was meant."""
from ._library import InvalidArgument


def unit_of(thing):
    """Returns the unit of an array, or None."""
    unit = getattr(thing, "units", None)
    unit = getattr(thing, "unit", None) if unit is None else unit
    return unit if unit is not None and callable(getattr(thing, "to", None)) else None


def plain(thing):
    """Returns the numbers of an array, in its own unit."""
    for name in ("magnitude", "value"):
        if hasattr(thing, name):
            return getattr(thing, name)
    return thing


def without_unit(thing):
    return thing if unit_of(thing) is None else plain(thing)


def convert(thing, unit, role, reference):
    """Returns the numbers of `thing` in `unit`; None means no unit. role, reference: names of `thing` and of the array with
    this unit, for messages."""
    if isinstance(thing, (list, tuple)) and any(unit_of(part) is not None for part in thing):
        return [convert(part, unit, role, reference) for part in thing]
    own = unit_of(thing)
    if thing is None or own is None and unit is None:
        return thing
    if own is None or unit is None:
        with_unit, bare = (role, reference) if unit is None else (reference, role)
        raise InvalidArgument(f"The {with_unit} has the unit {own if unit is None else unit}, the {bare} has none. "
                              "Give both with units, or both as plain numbers.")
    try:
        return plain(thing.to(unit))
    except Exception as error:  # Each library has its own exception.
        raise InvalidArgument(f"The {role} in {own} cannot be converted to {unit}: {error}") from None


class Units:
    """Makes plain numbers of the arguments of one call."""

    def __init__(self, positions):
        self.length = unit_of(positions)
        self.positions = without_unit(positions)

    def lengths(self, thing, role, power=1):
        return convert(thing, self.length if self.length is None or power == 1 else self.length ** power, role,
                       "array of positions")

    def quantities(self, given):
        """Returns {smoothing_length, volume, mass, density}; volume and mass / density are in the positions' unit cubed."""
        mass, density = given["mass"], given["density"]
        if mass is not None and density is not None:
            own = unit_of(mass)
            if own is None or unit_of(density) is None:
                density = convert(density, own, "density", "mass")
            else:
                density = self.lengths(density, "density", 0) if self.length is None else \
                    convert(density, own / self.length ** 3, "density", "mass")
        return {"smoothing_length": self.lengths(given["smoothing_length"], "smoothing length"),
                "volume": self.lengths(given["volume"], "volume", 3),
                "mass": without_unit(mass), "density": without_unit(density)}

    def options(self, words):
        """Returns the options, with the lengths cube_size, box and periodic as plain numbers in the positions' unit."""
        return {name: self.lengths(value, name) if name in ("box", "periodic") or name == "cube_size" and value
                else value for name, value in words.items()}


def scalar_and_iso(scalar, scalar_dot, iso):
    """Returns the three arguments as plain numbers. iso is then in the unit of the scalar, or of the dot product."""
    unit, other = unit_of(scalar), unit_of(scalar_dot)
    if scalar_dot is not None and (unit is None) != (other is None):
        convert(scalar_dot, unit, "second vector of the dot product", "scalar")  # This call raises the refusal.
    if unit is not None and other is not None:
        unit = unit * other
    return without_unit(scalar), without_unit(scalar_dot), convert(iso, unit, "iso value", "scalar")
