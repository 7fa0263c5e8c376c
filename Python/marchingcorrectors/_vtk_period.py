# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The period that particles' field data tell of, as the core finds it."""
import ctypes

from . import _structs as c
from ._arrays import place_period
from ._library import lib

_int = ctypes.POINTER(ctypes.c_int)
lib.mcor_find_period.restype = ctypes.c_int
lib.mcor_find_period.argtypes = [ctypes.POINTER(c.mcor_field_data), ctypes.c_int,
                                 ctypes.POINTER(ctypes.c_double), _int]
lib.mcor_tells_of_period.restype, lib.mcor_tells_of_period.argtypes = ctypes.c_int, [ctypes.c_char_p]
NO_PERIOD = ("The field data of the particles give no period: there is no array PeriodicBounds, BoxSize, or box "
             "with boundaryType.")


def find_period(particles):
    """Six bounds, of a VTK data set; None where none is told."""
    data, arrays, kept = particles.GetFieldData(), [], []
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        name = ((array.GetName() if array else "") or "").encode(errors="replace")
        if array and lib.mcor_tells_of_period(name) and array.GetNumberOfValues() <= 6:
            components = array.GetNumberOfComponents()
            values = [array.GetComponent(v // components, v % components) for v in range(array.GetNumberOfValues())]
            kept.append((ctypes.c_double * max(len(values), 1))(*values))
            arrays.append(c.mcor_field_data(name=name, values=kept[-1], count=len(values)))
    period = (ctypes.c_double * 6)()
    count = lib.mcor_find_period((c.mcor_field_data * max(len(arrays), 1))(*arrays), len(arrays), period, None)
    if count == 3:
        return place_period(period[:3], particles.GetBounds())
    return list(period) if count else None
