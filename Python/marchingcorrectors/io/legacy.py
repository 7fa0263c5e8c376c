# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads VTK's legacy files (.vtk): points and their arrays. VTK's own reader gives random values if a text file ends too
early, and reads any memory that damaged lists of cells point to; here all lengths are checked against the rest of the file."""
import re
from urllib.parse import unquote_to_bytes

import numpy as np

from ._cells import offsets_of, take_vertices
from ._particles import TIMES, Body, FileError, by_name, period_of_field
from ._bytes import parse_numbers

KINDS = {"unsigned_char": "u1", "char": "i1", "signed_char": "i1", "unsigned_short": "u2", "short": "i2", "unsigned_int": "u4",
         "int": "i4", "vtkidtype": "i4", "unsigned_long": "u8", "long": "i8", "float": "f4", "double": "f8",
         **{f"vtktype{sign}int{bits}": f"{'u' if sign else 'i'}{bits // 8}" for sign in ("u", "") for bits in (8, 16, 32, 64)}}
LISTS = {"VERTICES": 1, "LINES": 3, "POLYGONS": 7, "TRIANGLE_STRIPS": 6, "CELLS": 0}  # These are VTK's types of such cells.
COLUMNS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1, "EDGE_FLAGS": 1}


class Legacy:
    def __init__(self, path):
        self.name, self.data, self.at = path.name, path.read_bytes(), 0
        self.points, self.arrays, self.field, self.cell_arrays = None, [], [], []  # Arrays are pairs (name, values).
        self.cells, self.types = {}, None  # {name: (values, number)}
        head = re.match(rb"# vtk DataFile Version (\d+)\.\d+[^\n]*\n[^\n]*\n(ASCII|BINARY)\s*?\n"
                        rb"DATASET +(POLYDATA|UNSTRUCTURED_GRID)\s*?\n", self.data)
        if not head:
            raise FileError(f"{self.name} is no file of VTK's with particles (poly data or an unstructured grid), or its "
                            "beginning is damaged.")
        self.at, self.text, self.offsets = head.end(), head[2] == b"ASCII", int(head[1]) > 4
        into = self.field
        while True:
            words = self.line()
            if not words:
                break
            into = self.section(words, into)
        if self.points is None or not len(self.points) or (self.types is None) != (head[3] == b"POLYDATA"):
            raise self.damaged()
        self.arrays, self.field, self.cell_arrays = by_name(self.name, self.arrays), dict(self.field), dict(self.cell_arrays)

    def damaged(self):
        return FileError(f"{self.name} has no points, ends too early, or is damaged (at byte {self.at}).")

    def line(self):
        """Returns the words of the next line that has some."""
        while self.at < len(self.data):
            end = self.data.find(b"\n", self.at, self.at + 1000)
            end = min(len(self.data), self.at + 1000) if end < 0 else end
            words, self.at = self.data[self.at:end].split(), end + 1
            if words:
                return [word.decode(errors="replace") for word in words]
        return []

    def values(self, kind, count, columns=1):
        kind, count, columns = kind.lower(), int(count), int(columns)
        code, left = KINDS.get(kind), len(self.data) - self.at
        if kind in ("string", "utf8_string", "variant"):
            return self.skip_strings(count * columns, self.text or kind == "variant")
        if kind == "bit" and not self.text:
            return self.values("unsigned_char", (count * columns + 7) // 8)[:0]
        if code is None or count < 0 or not 0 < columns <= 1000:
            raise self.damaged()
        size = count * columns * (2 if self.text else np.dtype(code).itemsize)
        if size > left + self.text:  # As text, each number has a digit and a blank; the last has no blank.
            raise self.damaged()
        if self.text:
            values, end = parse_numbers(memoryview(self.data)[self.at:], code, count * columns)
            self.at += end
        else:
            values = np.frombuffer(self.data, ">" + code, count * columns, self.at).astype(code)
            self.at += size
        return values.reshape(count, columns) if columns > 1 else values

    def skip_strings(self, count, in_lines):
        """Skips texts: in text files, one on each line; in others, each behind its length, whose first two bits tell its own size: 8, 4, 2 or 1 bytes."""
        for _ in range(count):
            if in_lines:
                self.at = self.data.find(b"\n", self.at) + 1 or len(self.data) + 1
            else:
                size = 8 >> (self.data[self.at] >> 6)
                self.at += size + (int.from_bytes(self.data[self.at:self.at + size], "big") & (1 << (8 * size - 2)) - 1)
            if self.at > len(self.data):
                raise self.damaged()
        return np.empty(0)

    def section(self, words, into):
        """Reads the section that these words begin. into: where its arrays go. Returns where the next section's arrays go."""
        word, rest = words[0].upper(), words[1:]

        def put(name, *how):  # VTK writes %20 for a blank in a name.
            into.append((unquote_to_bytes(name).decode(errors="replace"), self.values(*how)))

        if word == "POINTS":
            self.points = self.values(rest[1], rest[0], 3)
        elif word in LISTS and not self.offsets:
            self.cells[word] = self.values("int", rest[1]), int(rest[0])
        elif word in LISTS:
            self.cells[word] = [self.values(self.line()[1], count) for count in rest[:2]]
        elif word == "CELL_TYPES":
            self.types = self.values("int", rest[0])
        elif word in ("POINT_DATA", "CELL_DATA"):
            self.count = int(rest[0])
            if word == "POINT_DATA" and (self.points is None or self.count != len(self.points)):
                raise self.damaged()
            return self.arrays if word == "POINT_DATA" else self.cell_arrays
        elif word == "FIELD":
            for _ in range(int(rest[1])):
                name, columns, count, kind = self.next_array()
                put(name, kind, count, columns)
        elif word == "SCALARS":
            if self.line()[0].upper() != "LOOKUP_TABLE":
                raise self.damaged()
            put(rest[0], rest[1], self.count, rest[2] if len(rest) > 2 else 1)
        elif word in COLUMNS:
            put(rest[0], rest[1], self.count, COLUMNS[word])
        elif word == "TEXTURE_COORDINATES":
            put(rest[0], rest[2], self.count, rest[1])
        elif word == "COLOR_SCALARS":
            put(rest[0], "float" if self.text else "unsigned_char", self.count, rest[1])
        elif word == "LOOKUP_TABLE":
            self.values("float" if self.text else "unsigned_char", rest[1], 4)
        elif word == "METADATA":
            self.skip_metadata()
        else:
            raise self.damaged()
        return into

    def next_array(self):
        words = self.line()
        if words == ["METADATA"]:
            self.skip_metadata()
            words = self.line()
        return words

    def skip_metadata(self):
        """Skips metadata, which end with an empty line."""
        end = re.compile(rb"\n\r?\n").search(self.data, self.at)
        self.at = end.end() if end else len(self.data)


def lists_of(legacy):
    """Returns the lists of cells as take_vertices() takes them, in the order of VTK's cells."""
    lists = []
    for name in LISTS:
        if name in legacy.cells and len(legacy.cells[name][0]):
            begins, ids = legacy.cells[name] if legacy.offsets else offsets_of(*legacy.cells[name])
            types = legacy.types if name == "CELLS" else np.full(len(begins) - 1, LISTS[name])
            lists.append((types, lambda begins=begins, ids=ids: (begins[1:], ids)))
    return lists


def read_legacy(path):
    try:
        legacy = Legacy(path)
    except (FileError, MemoryError):
        raise
    except Exception:  # Some words are no numbers, or there are too few.
        raise FileError(f"{path.name} is damaged, or ends too early.") from None
    count = len(legacy.points)
    time = next((legacy.field[name] for name in TIMES if name in legacy.field), ())
    body = Body(legacy.points, {name: array for name, array in legacy.arrays.items() if len(array) == count},
                float(np.ravel(time)[0]) if len(time) else None, period_of_field(legacy.field))
    try:
        return take_vertices(path.name, body, lists_of(legacy), {name: lambda array=array: array for name, array in legacy.cell_arrays.items()})
    except (ValueError, IndexError):  # Damaged cells tell nothing.
        return body
