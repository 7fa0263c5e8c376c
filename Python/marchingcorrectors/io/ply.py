# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads .ply: the vertices with all of their properties, which VTK's own reader leaves out."""
import re

import numpy as np

from .._library import say
from ._bytes import read_bytes
from ._particles import FileError
from .tables import body_of, check_width, columns_of

TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
         "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
         "float64": "f8"}
ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}


def read_ply(path):
    data = read_bytes(path)
    head = re.match(rb"ply\r?\n(.*?)end_header\r?\n", data[:1 << 20], re.DOTALL)
    if not head:
        raise FileError(f"{path.name} is no .ply file, or its beginning is damaged.")
    form, elements = None, []  # [name, count, [(property, type, or None of a list)]]
    for line in head[1].decode(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["format"] and len(words) > 1 and words[1] in ORDERS:
            form = words[1]
        elif words[:1] == ["element"] and len(words) == 3 and re.fullmatch("[0-9]{1,15}", words[2]):
            elements.append([words[1], int(words[2]), []])
        elif words[:1] == ["property"] and elements and (len(words) == 3 and words[1] in TYPES or words[1:2] == ["list"]):
            elements[-1][2].append((words[-1], TYPES.get(words[1])))
        elif words and words[0] not in ("comment", "obj_info"):
            raise FileError(say("PLY_HEAD", path.name, line))
    if form is None:
        raise FileError(f"{path.name} does not tell its format: ascii or binary.")
    at = head.end()
    for name, count, properties in elements:
        if not count and name != "vertex":
            continue
        if any(kind is None for _, kind in properties):
            raise FileError(say("PLY_LISTS", path.name, name))
        check_width(path.name, len(properties))
        if form == "ascii":
            end = at
            for _ in range(min(count, len(data)) if name != "vertex" else 0):
                end = data.find(b"\n", end) + 1 or len(data)
        else:
            kind = np.dtype([(str(i), ORDERS[form] + kind) for i, (_, kind) in enumerate(properties)])
            end = at + count * kind.itemsize
        if name == "vertex":
            break
        at = end
    else:
        raise FileError(f"{path.name} has no vertices.")
    names = [name for name, _ in properties]
    if len(set(names)) < len(names):
        raise FileError(say("PLY_NAMES", path.name))
    if form == "ascii":
        rows = [row for row in data[at:].decode(errors="replace").split("\n") if row.strip()][:count]
        columns = columns_of(path.name, rows, names)
    elif end <= len(data):
        rows = np.frombuffer(data, kind, count, at)
        columns = {name: rows[str(i)].astype(rows.dtype[i].newbyteorder("=")) for i, name in enumerate(names)}
    if form != "ascii" and end > len(data) or len(rows) < count:
        raise FileError(f"{path.name} ends too early: it claims {count} vertices.")
    return body_of(path.name, columns, is_mesh=True if any(name == "face" and many for name, many, _ in elements) else None)
