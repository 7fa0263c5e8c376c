# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A sample of the oracle's random cases: their particles as NumPy arrays through isosurface(), the surface back to
the oracle.

    test_oracle.py LIBRARY RESULTS [COUNT]

With MCOR_TEST_WHOLE, of a wheel with all kernels: all on the built-in device.
"""
import ctypes
import os
import sys
import tempfile
import traceback

import numpy as np

WHOLE = "MCOR_TEST_WHOLE" in os.environ
EMPTY = tempfile.TemporaryDirectory()
if WHOLE:
    os.environ["OCL_ICD_VENDORS"] = EMPTY.name  # no driver of the system's

import marchingcorrectors as mc
from marchingcorrectors import _structs as c
from marchingcorrectors._options import ISOSURFACE, OUTPUTS

TYPES = {0: ctypes.c_float, 1: ctypes.c_double}
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
seen = {"calls": 0, "triangles": 0}


def array_of(view, count):
    if not view.data:
        return view.constant
    components = max(view.components, 1)
    values = (TYPES[view.type] * (count * components)).from_address(view.data)
    array = np.frombuffer(values, dtype=TYPES[view.type]).reshape(count, components)
    return array[:, 0] if components == 1 else array


def keywords(given, options):
    """Everything that the structures say, as a user would write it."""
    words, count = {}, given.count
    for name, kind in [*c.KINDS["mcor_options"].items(), *OUTPUTS.items()]:
        if name in ISOSURFACE and "[" not in str(kind):
            words[name] = getattr(options, name)
    for name in ("smoothing_length_is_support_radius", "estimate_smoothing_length", "scalar_component",
                 "ignore_solids"):
        words[name] = getattr(given, name)
    if not given.estimate_smoothing_length:
        words["smoothing_length"] = array_of(given.smoothing_length, count)
    for name in ("volume", "mass", "density"):
        view = getattr(given, name)
        if view.data or view.constant:
            words[name] = array_of(view, count)
    if given.solid:
        words["solid"] = np.ctypeslib.as_array(given.solid, (count,))
    words["scalar"] = None
    words["attributes"] = {str(i): array_of(given.attributes[i], count) for i in range(given.attribute_count)}
    if options.field != c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]:
        words["scalar"] = array_of(given.scalar, count)
        if given.scalar_dot.data:
            words["scalar_dot"] = array_of(given.scalar_dot, count)
    words["iso"] = [options.iso_values[i] for i in range(options.iso_count)]
    return words


def give(array, kind):
    """A copy that mcor_free_surface() can free."""
    array = np.ascontiguousarray(array)
    assert array.itemsize == ctypes.sizeof(kind), (array.dtype, kind)
    memory = libc.malloc(max(array.nbytes, 1))
    ctypes.memmove(memory, array.ctypes.data, array.nbytes)
    return ctypes.cast(memory, ctypes.POINTER(kind))


def hand_back(surface, found):
    ctypes.memset(ctypes.addressof(surface), 0, ctypes.sizeof(surface))
    surface.point_count, surface.triangle_count = len(found.points), len(found.triangles)
    for name, kind in c.mcor_surface._fields_:
        array = getattr(found, name, None)
        if isinstance(array, np.ndarray):
            setattr(surface, name, give(array, kind._type_))
    for name, _ in c.mcor_statistics._fields_:
        value = found.statistics[name]
        if name == "seconds":
            value = list(value.values())
        if isinstance(value, (list, tuple)):
            getattr(surface.statistics, name)[:] = value
        else:
            setattr(surface.statistics, name, value.encode() if isinstance(value, str) else value)


@ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(c.mcor_input), ctypes.POINTER(c.mcor_options),
                  ctypes.POINTER(c.mcor_surface))
def extract(given, options, surface):
    try:
        positions = array_of(given.contents.positions, given.contents.count)
        # Points of float32 positions would be rounded.
        found = mc.isosurface(positions.astype(np.float64), **keywords(given.contents, options.contents))
        hand_back(surface.contents, found)
        seen["calls"] += 1
        seen["triangles"] += len(found.triangles)
        assert found.statistics["platform"] == "built in" or not WHOLE
        return 0
    except BaseException:
        traceback.print_exc()
        return 1


def main():
    library = ctypes.CDLL(sys.argv[1])
    count = sys.argv[3] if len(sys.argv) > 3 else "4"
    words = [b"oracle", b"--results", sys.argv[2].encode(), b"--first", b"1", b"--count", count.encode()]
    status = library.oracle_run(extract, len(words), (ctypes.c_char_p * (len(words) + 1))(*words))
    print(f"{seen['calls']} extractions through Python, {seen['triangles']} triangles, on {mc.devices()[0]}")
    assert seen["calls"] >= 6 and seen["triangles"] > 1000, seen
    sys.exit(status)


if __name__ == "__main__":
    main()
