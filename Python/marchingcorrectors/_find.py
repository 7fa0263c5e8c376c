# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Asks the core to find quantities among named arrays, see mcor_find.h."""
import ctypes

import numpy as np

from . import _structs as c
from ._library import lib, take_sentence

ROLES = {name[len("MCOR_ROLE_"):].lower(): number for name, number in c.ENUMS["mcor_role"].items()
         if not name.endswith("_COUNT")}
WANTS = {name[len("MCOR_WANT_"):].lower(): number for name, number in c.ENUMS["mcor_want"].items()}
ELEMENTS = {np.dtype(word): number for number, word in enumerate(("f4", "f8", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"))}
OTHER = c.ENUMS["mcor_element"]["MCOR_ELEMENT_OTHER"]


def as_bytes(text):
    """Encodes text for the core's messages; characters that UTF-8 cannot hold (in names of files, say) become "?"."""
    return text.encode(errors="replace")


def copy_at(address, kind, shape):
    """Returns an array that NumPy owns, of the numbers at this address."""
    size = int(np.prod(shape)) * kind.itemsize
    return np.frombuffer((ctypes.c_char * size).from_address(address), kind).reshape(shape).copy() if size else np.empty(shape, kind)


def list_named(arrays):
    """Makes the core's list of arrays from {name: array}, or from pairs. An array without numbers is listed with its shape alone."""
    pairs = list(arrays.items() if hasattr(arrays, "items") else arrays)
    named = (c.mcor_named * max(len(pairs), 1))()
    for each, (name, array) in zip(named, pairs):
        kind = np.dtype(np.uint8) if getattr(array, "dtype", None) == bool else getattr(array, "dtype", None)
        each.name, each.type = None if name is None else as_bytes(name), ELEMENTS.get(kind, OTHER)
        each.tuples, each.components = array.shape[0], int(np.prod(array.shape[1:], dtype=int))
        if each.type != OTHER and array.size:
            each.data = array.ctypes.data
            each.stride[0] = array.strides[0] if len(array) > 1 else 0
            each.stride[1] = array.strides[1] if array.ndim > 1 and array.shape[1] > 1 else 0
    return named, len(pairs)


def name_priority(name, quantity):
    """Returns 0 for the most usual name of a quantity, more for less usual ones, -1 for any other name."""
    return lib.mcor_name_priority(c.ENUMS["mcor_quantity"]["MCOR_" + quantity.upper()], as_bytes(name))


def tells_of_walls(name):
    """Returns whether a block or body of this name holds walls."""
    return bool(lib.mcor_tells_of_walls(as_bytes(name)))


class Found:
    """Holds an mcor_found, as `found`, and the arrays that it borrows.

    wants: names of mcor_want; names: {role: name}; values: {role: number}; only: (name, low, high); taken, excluded: names;
    words: further members of mcor_request.
    """

    def __init__(self, positions, arrays, wants, names=None, values=None, only=(), taken=(), excluded=(), **words):
        pairs = list(arrays.items() if hasattr(arrays, "items") else arrays)
        request = c.mcor_request(wants=sum(WANTS[name] for name in wants), active=-1)
        for role, name in (names or {}).items():
            request.names[ROLES[role]] = as_bytes(name or "")
        for role, value in (values or {}).items():
            request.values[ROLES[role]] = value
        for name, value in words.items():
            if isinstance(getattr(request, name), ctypes.Array):
                getattr(request, name)[:] = value
            else:
                setattr(request, name, value)
        ranges = (c.mcor_only * max(len(only), 1))(*((as_bytes(name), low, high) for name, low, high in only))
        request.only, request.only_count = ranges, len(only)
        request.taken, request.excluded = as_bytes("\n".join(taken)), as_bytes("\n".join(excluded))
        self.found, self._kept = c.mcor_found(), (positions, pairs, ranges)
        named, count = list_named(pairs)
        status = lib.mcor_find_input(ctypes.byref(request), list_named([(None, positions)])[0], named, count, None,
                                     ctypes.byref(self.found))
        self.error, self.unused_type, self.unused = (
            take_sentence(getattr(self.found, name)) for name in ("error", "unused_type", "unused"))
        if status and not self.error:
            raise MemoryError

    def __del__(self):
        if hasattr(self, "found"):
            lib.mcor_free_found(ctypes.byref(self.found))

    def text(self, member):
        return (getattr(self.found, member) or b"").decode(errors="replace")

    def which(self, role):
        """Returns the index of the array with this role, or None. Arrays that the core made are behind the given ones."""
        index = self.found.which[ROLES[role]]
        return None if index < 0 else index

    def name(self, role):
        """Returns the name of the role's array, even if the array is not used; "" if there is none."""
        return (self.found.views[ROLES[role]].name or b"").decode(errors="replace")

    def attributes(self):
        return self.found.attributes[:self.found.input.attribute_count]

    def nearest(self):
        return self.found.nearest[:self.found.nearest_count]

    def made(self, i):
        """Returns (name, a copy of the array)."""
        made = self.found.made[i]
        kind = next(dtype for dtype, number in ELEMENTS.items() if number == made.type)
        return made.name.decode(), copy_at(made.data, kind, (made.tuples, made.components)[:1 + (made.components > 1)])
