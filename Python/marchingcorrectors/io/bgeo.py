# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads Houdini's .bgeo of version 5, which SPlisHSPlasH writes by partio: points and their attributes, plain or gzipped.
The file, big endian: "BgeoV", version, numbers of points, primitives, groups of points and of primitives, attributes of
points, vertices, primitives, detail; attributes of points (name, size, type, defaults); points: x, y, z, w, attributes."""
import struct

import numpy as np

from ._bytes import read_bytes
from ._particles import FileError, Particles, by_name

TYPES = {0: ">f4", 1: ">i4", 5: ">f4"}  # float, int, vector

def read_bgeo(path):
    data = read_bytes(path)
    try:
        if data[:5] != b"BgeoV":
            raise FileError(f"{path.name} is no .bgeo of Houdini's version 5.")
        version, points, _, _, _, attributes = struct.unpack_from(">6i", data, 5)
        if version != 5:
            raise FileError(f"{path.name} is a .bgeo of version {version}; 5 is read.")
        at, fields = 41, [("position", ">f4", 4)]
        for i in range(attributes):
            length, = struct.unpack_from(">H", data, at)
            name = data[at + 2:at + 2 + length].decode(errors="replace")
            at += 2 + length
            size, kind = struct.unpack_from(">Hi", data, at)
            at += 6 + 4 * size
            if kind not in TYPES or not 0 < size <= 64:
                raise FileError(f"{path.name}: the attribute '{name}' has the type {kind}, which is not read.")
            fields.append((name, TYPES[kind], size))
    except struct.error:
        raise FileError(f"{path.name} ends too early.") from None
    kind = np.dtype([(str(i), form, (size,)) for i, (_, form, size) in enumerate(fields)])
    if points <= 0 or at + points * kind.itemsize > len(data):
        raise FileError(f"{path.name} claims {points} points, for which it is too short." if points > 0 else
                        f"{path.name} has no points.")
    table = np.frombuffer(data, kind, points, at)

    def column(i, size):
        return lambda: np.ascontiguousarray(table[str(i)][:, 0] if size == 1 else table[str(i)]).astype(
            fields[i][1].replace(">", "="))

    arrays = by_name(path.name, ((name, column(i, size)) for i, (name, _, size) in enumerate(fields) if i))
    return Particles(path.name, "bgeo", lambda: np.ascontiguousarray(table["0"][:, :3]).astype("=f4"), arrays,
                     density="density" if "density" in arrays else None, up="y")
