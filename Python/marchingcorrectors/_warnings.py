# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the core's warnings as Python's warnings."""
import ctypes
import sys
import warnings

from . import _structs as c
from ._library import Error, lib, take_sentence


class InputWarning(UserWarning):
    """Something about the particles or options is legal, but hardly what was meant.

    code: the name of the core's sentence, such as "ISO_OUTSIDE"; "" for one of this package.
    """

    code = Error.code


def warn(sentence):
    """Warns at the caller's line, the first one outside of this package."""
    level, frame = 1, sys._getframe(0)
    while frame is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(sentence, InputWarning, stacklevel=level)


def describe_warnings(arguments, surface):
    """Returns {number: sentence} of what the core finds strange in a surface's input."""
    found = {}
    for number in range(c.ENUMS["mcor_warning"]["MCOR_WARNING_COUNT"]):
        sentence = take_sentence(lib.mcor_describe_warning(
            number, ctypes.byref(arguments.input), ctypes.byref(arguments.options), ctypes.byref(surface)))
        if sentence:
            found[number] = sentence
    return found


def warn_of_particles(arguments, statistics):
    """Gives the warnings that do not need a surface."""
    kinds, found = c.ENUMS["mcor_warning"], describe_warnings(arguments, c.mcor_surface(statistics=statistics))
    for kind in ("MCOR_WARN_FAR", "MCOR_WARN_PERIOD", "MCOR_WARN_COARSE"):
        if kinds[kind] in found:
            warn(found[kinds[kind]])
