# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads DualSPHysics' Part_0000.bi4. Head of 64 bytes: title (60), byte order (1: big; +10 with 64-bit sizes), sizes of 64
bits (0, 1). Then an item: size of its definition, "\\nITEM\\n", name, hidden, values hidden, two formats, numbers of arrays and
items, bytes of values; "\\nVALUES", number, (name, type, value); arrays, each: size of its definition, "\\nARRAY", name,
hidden, type, count, bytes, data; items. Text: length, letters. Arrays stay in the file until they are used."""
import os

import numpy as np

from .._library import say
from ._particles import FileError, Particles, by_name
from ._bytes import RawArray, state_of

PLAIN = {2: "i4", 3: "i1", 4: "u1", 5: "i2", 6: "u2", 7: "i4", 8: "u4", 9: "i8", 10: "u8", 11: "f4", 12: "f8",
         20: "i4", 21: "u4", 22: "f4", 23: "f8"}
TEXT, DEPTH = 1, 8


class Reader:
    """Reads the file. Before it uses a length, it checks that the rest of the file is as long."""

    def __init__(self, file, path):
        self.file, self.path, self.name, self.state = file, path, path.name, state_of(file)
        self.size = self.state[1]
        head = file.read(64)
        order = head[60] if len(head) == 64 else 9
        if order % 10 > 1:
            raise FileError(f"{self.name} has a damaged head.")
        self.order, self.wide = "<>"[order % 10], head[61] == 1

    def check(self, size):
        if size > self.size - self.file.tell():
            raise FileError(say("FILE_ENDS", self.name, self.file.tell()))

    def take(self, size):
        self.check(size)
        return self.file.read(size)

    def number(self, kind="u4", count=1):
        kind = np.dtype(self.order + kind)
        values = np.frombuffer(self.take(kind.itemsize * count), kind, count)
        return values[0].item() if count == 1 else values.tolist()

    def text(self):
        return self.take(self.number()).decode(errors="replace")

    def expect(self, code):
        if self.text() != code:
            raise FileError(f"{self.name} is damaged before byte {self.file.tell()}.")

    def value(self):
        name, kind = self.text(), self.number()
        if kind == TEXT:
            return name, self.text()
        if kind not in PLAIN:
            raise FileError(f"{self.name} has a value of the unknown type {kind}.")
        return name, self.number(PLAIN[kind], 3 if kind >= 20 else 1)

    def array(self):
        self.number()
        self.expect("\nARRAY")
        name, _, kind = self.text(), self.number(), self.number()
        count, size = self.number("u8" if self.wide else "u4"), self.number("u8" if self.wide else "u4")
        self.check(size)
        begin = self.file.tell()
        self.file.seek(size, os.SEEK_CUR)
        if kind not in PLAIN:
            return name, None
        dtype, columns = np.dtype(self.order + PLAIN[kind]), 3 if kind >= 20 else 1
        if count * columns * dtype.itemsize != size:
            raise FileError(f"{self.name}: the array '{name}' has {size} bytes for {count} values.")
        return name, RawArray(self.path, self.state, begin, dtype, count, columns)

    def item(self, depth=0):
        """Returns (values, arrays, [items])."""
        if depth > DEPTH:
            raise FileError(f"{self.name} is damaged: too deep a nest of items.")
        self.number()
        self.expect("\nITEM\n")
        self.text(), self.number(), self.number(), self.text(), self.text()
        arrays, items, size = self.number(), self.number(), self.number()
        values = {}
        if size:
            self.expect("\nVALUES")
            values = dict(self.value() for _ in range(self.number()))
        found = by_name(self.name, (self.array() for _ in range(arrays)))
        return values, found, [self.item(depth + 1) for _ in range(items)]


def read_bi4(path):
    with open(path, "rb") as file:
        values, arrays, items = Reader(file, path).item()
    for more, found, _ in items:
        values, arrays = {**values, **more}, {**arrays, **{k: v for k, v in found.items() if v is not None}}
    positions = arrays.pop("Posd", arrays.pop("Pos", None))
    ids = arrays.get("Idpd", arrays.get("Idp"))
    if positions is None or not positions.count:
        raise FileError(f"{path.name} has no positions (Pos, Posd): it is no file of particles.")
    arrays = {name: array for name, array in arrays.items() if array is not None and array.count == positions.count}
    read, solid = {name: array.load for name, array in arrays.items()}, None
    if ids is not None and "CaseNfixed" in values and ids.count == positions.count:
        ends = np.cumsum([values.get(f"CaseN{kind}", 0) for kind in ("fixed", "moving", "float")])
        types = np.searchsorted(ends, ids.load(), side="right").astype(np.uint8)
        read["Type"], solid = lambda: types, types != 3
    density = next((name for name in ("Rhop", "Rho") if name in arrays), None)
    h = values.get("H", 0)
    return Particles(
        path.name, "DualSPHysics", positions.load, read,
        smoothing_length=h if h > 0 else None, mass=values.get("MassFluid") or None, density=density,
        rho0=values.get("Rhop0", values.get("RhopZero")), solid=solid if solid is not None and solid.any() else None,
        kernel="Wendland C2", dimension=2 if values.get("Data2d") else 3, period=period_of(values),
        time=values.get("TimeStep"), parameters=values)


def period_of(values):
    """Returns the period by PeriActive, or PeriMode: 1 x, 2 y, 3 xy, 4 z, 5 xz, 6 yz. Shifted periods (PeriXinc along another axis) do not count."""
    axes = {1: "x", 2: "y", 3: "xy", 4: "z", 5: "xz", 6: "yz"}.get(values.get("PeriActive", values.get("PeriMode", 0)), "")
    low, high = values.get("MapPosMin"), values.get("MapPosMax")
    if not axes or not low or not high:
        return None
    for axis in axes:
        step = values.get(f"Peri{axis.upper()}inc", [0, 0, 0])
        if any(step[other] for other in range(3) if other != "xyz".index(axis)):
            return None
    return [bound for i in range(3) for bound in ((low[i], high[i]) if "xyz"[i] in axes else (0.0, 0.0))]
