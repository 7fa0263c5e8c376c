# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes a ball of particles, and writes it to files whose layouts need only NumPy."""
import struct
from pathlib import Path

import numpy as np

SPACING, H = 0.1, 0.13
LINE = np.arange(-9, 10) * SPACING
X = np.stack(np.meshgrid(LINE, LINE, LINE), -1).reshape(-1, 3)
X = X[np.linalg.norm(X, axis=1) < 0.9]
DENSITY = 2 - np.linalg.norm(X, axis=1)
MASS = DENSITY * SPACING ** 3
WALL = X[:, 2] < -0.5


def write_bi4(path, order="<", wide=False, double=True, period=0, time=0.75, positions=X):
    """Writes a .bi4 file as DualSPHysics' JBinaryData.cpp does. wide: counts of 64 bits. double: positions in double precision."""
    def pack(form, *values):
        return struct.pack(order + form, *values)

    def text(word):
        return pack("I", len(word.encode())) + word.encode()

    def value(name, kind, form, *values):
        return text(name) + pack("i", kind) + (text(values[0]) if kind == 1 else pack(form, *values))

    def array(name, kind, form, values):
        data = values.astype(order + form).tobytes()
        base = text("\nARRAY") + text(name) + pack("ii", 0, kind) + pack("QQ" if wide else "II", len(values), len(data))
        return pack("I", len(base)) + base + data

    def item(name, values, arrays, items):
        packed = text("\nVALUES") + pack("I", len(values)) + b"".join(values) if values else b""
        base = text("\nITEM\n") + text(name) + pack("ii", 0, 0) + text("%.7E") + text("%.15E")
        base += pack("III", len(arrays), len(items), len(packed))
        return pack("I", len(base)) + base + packed + b"".join(arrays) + b"".join(items)

    ids = np.empty(len(X), np.uint32)
    ids[WALL], ids[~WALL] = np.arange(WALL.sum()), WALL.sum() + np.arange((~WALL).sum())
    arrays = [array("Idp", 8, "u4", ids), array("Posd", 23, "f8", positions) if double else array("Pos", 22, "f4", positions),
              array("Vel", 22, "f4", X), array("Rhop", 11, "f4", 1000 * DENSITY)]
    part = item("PART_0003", [value("TimeStep", 12, "d", time), value("Npok", 8, "I", len(X))], arrays, [])
    values = [value("AppName", 1, "", "été"), value("Data2d", 2, "i", 0), value("Dp", 12, "d", SPACING),
              value("H", 12, "d", H), value("MassFluid", 12, "d", 1.0), value("Rhop0", 12, "d", 1000.0),
              value("CaseNfixed", 10, "Q", int(WALL.sum())), value("CaseNmoving", 10, "Q", 0),
              value("CaseNfloat", 10, "Q", 0), value("PeriActive", 7, "i", period),
              value("MapPosMin", 23, "3d", -2, -2, -2), value("MapPosMax", 23, "3d", 2, 2, 2)]
    head = b"#FileJBD JPartDataBi4".ljust(58) + b"\n\0" + bytes([(order == ">") + 10 * wide, wide, 0, 0])
    Path(path).write_bytes(head + item("JPartDataBi4", values, [], [part]))


def write_bgeo(path, pack=bytes):
    table = np.zeros(len(X), [("p", ">f4", 4), ("id", ">i4"), ("velocity", ">f4", 3)])
    table["p"][:, :3], table["p"][:, 3], table["id"], table["velocity"] = X, 1, np.arange(len(X)), X
    data = b"BgeoV" + struct.pack(">9i", 5, len(X), 0, 0, 0, 2, 0, 0, 0)
    for name, size, kind in ((b"id", 1, 1), (b"velocity", 3, 5)):
        data += struct.pack(">H", len(name)) + name + struct.pack(">Hi", size, kind) + bytes(4 * size)
    Path(path).write_bytes(pack(data + table.tobytes() + b"\0\xff"))
