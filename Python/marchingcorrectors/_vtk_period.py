# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The period that particles' field data tell of."""
import math


def find_period(particles):
    """Six bounds; None where none is told. Of an array PeriodicBounds, of BoxSize (GADGET, SWIFT), or of box where
    boundaryType says that it repeats (SPH-EXA); whatever the case."""
    data = particles.GetFieldData()
    bounds = values_of(data, "PeriodicBounds", 6)
    if are_periods(bounds):
        return bounds
    for lengths in (values_of(data, "BoxSize", 3), 3 * values_of(data, "BoxSize", 1)):
        if are_periods([side for length in lengths for side in (0.0, length)]):
            return place(lengths, particles.GetBounds())
    kinds = values_of(data, "boundaryType", 3)  # 0: open, 1: periodic, 2: fixed
    bounds = [side if kinds and kinds[i // 2] == 1 else 0.0 for i, side in enumerate(values_of(data, "box", 6))]
    return bounds if are_periods(bounds) else None


def values_of(data, name, count):
    """The values of a numeric array, in whatever tuples; none where there is none of so many values."""
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        if array and (array.GetName() or "").lower() == name.lower() and array.GetNumberOfValues() == count:
            components = array.GetNumberOfComponents()
            return [array.GetComponent(v // components, v % components) for v in range(count)]
    return []


def are_periods(bounds):
    """Whether there are periods, of which some may be 0."""
    lengths = [high - low for low, high in zip(bounds[::2], bounds[1::2])]
    return all(math.isfinite(length) and length >= 0 for length in lengths) and any(lengths)


def place(lengths, extent):
    """Bounds of these lengths in which the particles lie: from 0 on or around 0 if they can."""
    bounds = []
    for length, low, high in zip(lengths, extent[::2], extent[1::2]):
        rounding = 1e-6 * length
        begins = [begin for begin in (0.0, -0.5 * length)
                  if low >= begin - rounding and high <= begin + length + rounding]
        begin = 0.0 if length == 0 else begins[0] if begins else low
        bounds += [begin, begin + length]
    return bounds
