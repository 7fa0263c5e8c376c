# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads VTK's XML files (.vtp, .vtu, and lists of them: .pvtp, .pvtu, .pvd): points and their arrays, of all pieces. VTK's own
reader believes the lengths in a damaged file, and ends Python; here all lengths are checked. An array is text, or base64 in
the file, or base64 or bytes at an offset behind an underscore in <AppendedData>. Bytes begin with their number; packed
bytes begin with the number of blocks, the bytes of a block, the bytes of the last block if it is shorter (else 0), and the
packed bytes of each block."""
import binascii
import bisect
import json
import lzma
import re
import zlib
from functools import partial
from xml.etree.ElementTree import TreeBuilder
from xml.parsers import expat

import numpy as np

from .._library import say, warn
from ._cells import take_vertices
from ._particles import TIMES, Body, FileError, by_name, check_claim, join_bodies, period_of_field
from ._bytes import parse_numbers

KINDS = {**{f"{sign}Int{bits}": f"{sign[:1].lower() or 'i'}{bits // 8}" for sign in ("", "U") for bits in (8, 16, 32, 64)},
         "Float32": "f4", "Float64": "f8"}
CELLS = {"Verts": 1, "Lines": 3, "Polys": 7, "Strips": 6, "Cells": None}  # These are in the order of VTK's cells, with types of such cells.
BASE64 = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/="


def decode_base64(text):
    """Decodes one base64 piece after the other, each with padding at its end."""
    text = text.translate(None, b" \t\r\n")
    if text.translate(None, BASE64):
        raise ValueError("letters that are not base64's")
    return b"".join(map(binascii.a2b_base64, re.findall(b"[^=]+=*", text)))


def unpack_lz4(packed, size):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOCore import vtkLZ4DataCompressor

    compressor = vtkLZ4DataCompressor()
    compressor.AddObserver("ErrorEvent", lambda *_: None)  # The result tells whether it failed.
    found = compressor.Uncompress(np.frombuffer(packed, np.uint8), len(packed), size)
    return b"" if found is None else vtk_to_numpy(found).tobytes()


UNPACK = {"vtkZLibDataCompressor": lambda packed, size: zlib.decompressobj().decompress(packed, size),
          "vtkLZMADataCompressor": lambda packed, size: lzma.LZMADecompressor(
              lzma.FORMAT_XZ, memlimit=2 ** 28).decompress(packed, size),
          "vtkLZ4DataCompressor": unpack_lz4}


def refuse(*_):
    raise ValueError("it has a document type")


def parse(data):
    """Returns the tree of elements. Takes text in large pieces, as XMLParser does not."""
    tree, parser = TreeBuilder(), expat.ParserCreate()
    parser.buffer_text, parser.buffer_size, parser.StartDoctypeDeclHandler = True, 1 << 20, refuse
    parser.StartElementHandler, parser.EndElementHandler, parser.CharacterDataHandler = tree.start, tree.end, tree.data
    parser.Parse(data, True)
    return tree.close()


class Array:
    """Holds a DataArray's attributes, and its text."""

    def __init__(self, element, count):
        self.name, self.format = element.get("Name", ""), element.get("format", "ascii")
        self.kind, self.columns = KINDS[element.get("type")], int(element.get("NumberOfComponents", 1))
        self.count = int(element.get("NumberOfTuples", 1)) if count is None else count
        self.offset = int(element.get("offset", 0))
        self.text = "".join([element.text or "", *(child.tail or "" for child in element)])
        if self.count < 0 or not 0 < self.columns <= 1000:
            raise ValueError(f"the array '{self.name}' has {self.count} values of {self.columns} numbers")

    def bytes(self):
        return self.count * self.columns * np.dtype(self.kind).itemsize


def arrays_in(element, part, count):
    """Lists the arrays of numbers in the parts of this name. count: the number of their values; None: they tell it."""
    return [Array(each, 0 if each.get("Name") == "connectivity" and part in CELLS else count) for inside in element.iter(part)
            for each in inside.findall("DataArray") if each.get("type") in KINDS]


def piece_of(element):
    """Returns {"Points": arrays, ..., "count": number of points, "counts": numbers of cells}."""
    count, counts = int(element.attrib["NumberOfPoints"]), {name: int(element.get(f"NumberOf{name}", 0)) for name in CELLS}
    many = {"Points": count, "PointData": count, "CellData": sum(counts.values()), **counts}
    return {**{name: arrays_in(element, name, many[name]) for name in many}, "count": count, "counts": counts}


class XmlFile:
    def __init__(self, path):
        self.data = path.read_bytes()
        appended = re.search(rb"<AppendedData\b([^>]*)>\s*_", self.data)
        self.begin = appended.end() if appended else len(self.data)
        self.is_raw = bool(appended and re.search(rb"encoding\s*=\s*[\"']raw", appended[1]))
        self.file = parse(self.data[:appended.start()] + b"</VTKFile>" if appended else self.data)
        self.offsets = sorted(int(each.get("offset", 0)) for each in self.file.iter("DataArray"))
        if self.file.get("type") not in ("PolyData", "UnstructuredGrid"):
            raise ValueError("it holds no poly data and no unstructured grid")
        self.order = ">" if self.file.get("byte_order") == "BigEndian" else "<"
        self.header = np.dtype(self.order + ("u8" if self.file.get("header_type") == "UInt64" else "u4"))
        self.pieces, self.field = [piece_of(each) for each in self.file.iter("Piece")], arrays_in(self.file, "FieldData", None)
        self.check = lambda arrays: check_claim(path.name, "one of the arrays, or all together,",
                                                sum(array.bytes() for array in arrays), len(self.data))
        self.check([array for piece in self.pieces for part in ("Points", "PointData", "CellData", *CELLS)
                    for array in piece[part]] + self.field)

    def values(self, array):
        if array.format == "ascii":
            values, _ = parse_numbers(array.text.encode(), array.kind, array.count * array.columns)
        else:
            values = np.frombuffer(self.bytes_of(array), self.order + array.kind).astype(array.kind)
        return values.reshape(array.count, array.columns) if array.columns > 1 else values

    def cells(self, arrays):
        """Returns where the points of each cell end, and these points."""
        ends, connectivity = self.values(arrays["offsets"]), arrays["connectivity"]
        connectivity.count = int(ends[-1])
        self.check([connectivity])
        return ends, self.values(connectivity)

    def body(self, file, piece):
        """Returns the particles of a piece."""
        arrays = by_name(file, ((array.name, array) for array in piece["PointData"]))
        body = Body(self.values(piece["Points"][0]), {name: self.values(array) for name, array in arrays.items()})
        try:
            lists = []
            for name in filter(piece["counts"].get, CELLS):
                own = {array.name: array for array in piece[name]}
                types = self.values(own["types"]) if name == "Cells" else np.full(own["offsets"].count, CELLS[name])
                lists.append((types, partial(self.cells, own)))
            return take_vertices(file, body, lists, {array.name: partial(self.values, array) for array in piece["CellData"]})
        except (ValueError, LookupError):  # Damaged cells tell nothing.
            return body

    def bytes_of(self, array):
        """Returns the array's bytes, by the header before them."""
        if array.format == "binary":
            data = decode_base64(array.text.encode())
        else:
            begin = self.begin + array.offset
            after = bisect.bisect(self.offsets, array.offset)
            end = self.begin + self.offsets[after] if after < len(self.offsets) else len(self.data)
            data = memoryview(self.data)[begin:end]
            data = data if self.is_raw else decode_base64(bytes(data).partition(b"<")[0])
        width, wanted = self.header.itemsize, array.bytes()

        def numbers(count, at=0):
            return np.frombuffer(data, self.header, count, at * width).tolist()

        packed = self.file.get("compressor")
        if not packed:
            found = data[width:width + wanted]
            if numbers(1) != [wanted] or len(found) != wanted:
                raise ValueError(f"it has not the {wanted} bytes that its points want")
            return found
        if packed not in UNPACK:
            raise ValueError(f"its packing is unknown ({packed})")
        blocks, size, last = numbers(3)
        sizes, at, found = numbers(blocks, 3), (3 + blocks) * width, []
        if blocks * size - (size - last if last else 0) != wanted or last > size:
            raise ValueError(f"it has not the {wanted} bytes that its points want")
        for i, length in enumerate(sizes):
            plain = last if last and i == blocks - 1 else size
            found.append(UNPACK[packed](bytes(data[at:at + length]), plain))
            if len(found[-1]) != plain:
                raise ValueError(f"its block {i} is damaged")
            at += length
        return b"".join(found)


def read_xml(path):
    """Reads the points; there may be none."""
    try:
        file = XmlFile(path)
        bodies = [file.body(path.name, piece) for piece in file.pieces if piece["count"]]
        field = {array.name: file.values(array).ravel() for array in file.field if array.name in (*TIMES, "PeriodicBounds")}
        time = next((array for name, array in field.items() if name in TIMES), ())
        body = join_bodies(bodies or [Body(np.empty((0, 3)), {})])
    except (FileError, ImportError, MemoryError):
        raise
    except Exception as error:
        raise FileError(f"{path.name} has no points, ends too early, or is damaged: {error}.") from None
    return body._replace(time=float(time[0]) if len(time) else None, period=period_of_field(field))


def elements(path, tag):
    """Returns all elements of this name."""
    try:
        return list(parse(path.read_bytes()).iter(tag))
    except (expat.ExpatError, ValueError) as error:
        raise FileError(f"{path.name} is no XML, or damaged: {error}.") from None


def list_pieces(path):
    """Reads .pvtp and .pvtu: a list of files whose points are one set."""
    names = [piece.get("Source") for piece in elements(path, "Piece") if piece.get("Source")]
    wanted = path.suffix[:1] + path.suffix[2:]
    odd = next((name for name in names if not name.lower().endswith(wanted.lower())), None)
    if not names or odd is not None:
        raise FileError(f"{path.name} lists no pieces." if odd is None else f"The piece {odd} of {path.name} is no {wanted} file.")
    return [path.parent / name for name in names]


def list_series(path):
    """Reads .vtk.series, ParaView's list of files and times, as {time: files} in the order of time."""
    try:
        entries = json.loads(path.read_bytes())["files"]
        found = sorted(((float(each["time"] + 0), each["name"] + "") for each in entries), key=lambda pair: pair[0])
    except (ValueError, KeyError, TypeError, RecursionError):
        found = []
    if not found or not np.isfinite([time for time, _ in found]).all() or not all(name for _, name in found):
        raise FileError(say("NO_SERIES", path.name)) from None
    times = {}
    for time, file in found:
        times.setdefault(time, []).append(path.parent / file)
    return times


def list_times(path):
    """Reads .pvd as {time: files} in their order. A run that is repeated in a folder adds its steps again: the last entries count."""
    entries, again = {}, []
    for entry in elements(path, "DataSet"):
        try:
            time = float(entry.get("timestep") or 0)
        except ValueError:
            raise FileError(f"{path.name}: the time '{entry.get('timestep')}' is no number.") from None
        if not entry.get("file"):
            raise FileError(f"{path.name} has an entry that names no file.")
        file, part = entry.get("file"), (entry.get("group", ""), entry.get("part")) if entry.get("part") else None
        same = next((key for key in entries if key[0] == time and (entries[key] == file or (part and key[1] == part))), None)
        if same:
            again.append(time)
        entries[same or (time, part or file)] = file
    if again:
        warn(say("LISTED_TWICE", path.name, len(again), "files" if len(again) > 1 else "file", f"{min(again):g}"))
    times = {}
    for (time, _), file in sorted(entries.items(), key=lambda pair: pair[0][0]):
        times.setdefault(time, []).append(path.parent / file)
    if not times:
        raise FileError(f"{path.name} lists no files.")
    return times
