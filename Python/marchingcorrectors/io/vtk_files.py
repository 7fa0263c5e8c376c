# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads points and their arrays from VTK's files: XML (.vtp, .vtu, and the lists .pvtp, .pvtu, .pvd) and the legacy format (.vtk). VTK's
own readers trust the lengths in a damaged file, and crash, or give random values; these readers check all lengths against the file."""
import binascii
import bisect
import json
import re
import warnings
import zlib
from functools import partial
from urllib.parse import unquote_to_bytes
from xml.etree.ElementTree import TreeBuilder
from xml.parsers import expat

import numpy as np

from .._library import say, warn
from ._particles import TIMES, Body, FileError, by_name, check_claim, join_bodies, period_of_field

VERTICES = (1, 2)  # VTK's types of cells that are points
IS_BLANK = np.isin(np.arange(256), np.frombuffer(b" \t\n\v\f\r", np.uint8))


def parse_numbers(text, kind, count):
    """Reads the first `count` numbers of a text, which blanks separate. text: bytes or a memoryview. Returns the numbers, and where
    the last one ends. Raises ValueError. Time and memory depend only on the numbers that are read, not on the text behind them."""
    size = 16 * count + 64
    while True:  # Longer pieces are tried until one has `count` words.
        piece = bytes(text[:size])
        is_blank = np.append(IS_BLANK[np.frombuffer(piece, np.uint8)], len(piece) == len(text))
        ends = np.flatnonzero(is_blank[1:] & ~is_blank[:-1]) + 1
        if len(ends) >= count or len(piece) == len(text):
            break
        size *= 2
    if len(ends) < count:
        raise ValueError(f"{len(ends)} numbers where there should be {count}")
    end = int(ends[count - 1]) if count else 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # NumPy warns when it stops at a word that is no number.
        values = np.fromstring(piece[:end], kind, sep=" ") if count else np.empty(0, kind)
    if len(values) != count:
        raise ValueError("a word is no number")
    return values, end


def offsets_of(cells, count):
    """Returns where each cell begins in the list of the points of all cells, and this list. cells: for each cell, its number of points,
    then its points."""
    width = len(cells) // count if count else 0
    if count and width * count == len(cells) and (cells[::width] == width - 1).all():
        return np.arange(count + 1) * (width - 1), cells.reshape(count, width)[:, 1:].ravel()
    begins, at = [], 0
    while at < len(cells):
        begins.append(at)
        at += 1 + max(int(cells[at]), 0)
    begins = np.array(begins + [len(cells)], int)
    if at != len(cells) or len(begins) != count + 1:
        raise ValueError("a list of cells is damaged")
    return begins - np.arange(count + 1), np.delete(cells, begins[:-1])


def find_vertices(types, offsets, points, count):
    """Returns, for each point, the number of the first vertex cell that has the point, or -1."""
    cells = np.repeat(np.arange(len(types)), np.diff(offsets))
    used = np.isin(types, VERTICES)[cells] & (points >= 0) & (points < count)
    found = np.full(count, -1)
    found[points[used][::-1]] = cells[used][::-1]  # If several vertices use a point, the first counts.
    return found


def take_vertices(file, body, lists, cell_arrays):
    """If there are vertices and other cells, keeps only the vertices' points: the other points belong to a mesh. Arrays of cells then become
    arrays of the points, unless points have an array of that name. If all cells are vertices, and each point has one, arrays of cells become
    arrays of the points, too. Warns if points are left out. Returns the body; if there are cells, its is_mesh says whether none of them
    is a vertex.

    lists: pairs (types of cells, function); the function returns where each cell's points end in a list of points, and this list.
    cell_arrays: {name: function that returns the array}.
    """
    types, count = np.concatenate([np.zeros(0, int), *(types for types, _ in lists)]), len(body.points)
    is_vertex = np.isin(types, VERTICES)
    body = body._replace(is_mesh=not is_vertex.any()) if len(types) else body
    if not is_vertex.any() or is_vertex.all() and not cell_arrays:
        return body
    offsets, points = [np.zeros(1, int)], []
    for _, load in lists:
        ends, own = load()
        offsets.append(offsets[-1][-1] + ends)
        points.append(own)
    cell_of = find_vertices(types, np.concatenate(offsets), np.concatenate(points), count)
    if is_vertex.all() and (cell_of < 0).any():
        return body
    if not is_vertex.all():
        warn(say("MESH_NODES", count - np.count_nonzero(cell_of >= 0), count, " of ", file))
    taken, of_cells = np.flatnonzero(cell_of >= 0), {name: load() for name, load in cell_arrays.items()}
    of_cells = {name: array[cell_of[taken]] for name, array in of_cells.items() if len(array) == len(types)}
    return body._replace(points=body.points[taken],
                         arrays={**of_cells, **{name: array[taken] for name, array in body.arrays.items()}})


# -- XML --
# An array is text or base64 in its own element, or base64 or bytes in <AppendedData>. An offset in <AppendedData> counts from the byte
# behind the underscore. The number of an array's bytes stands before the bytes. Packed bytes have other numbers before them: the number of
# blocks, the size of a block, the size of the last block if it is shorter (else 0), and the packed size of each block.

KINDS = {**{f"{sign}Int{bits}": f"{sign[:1].lower() or 'i'}{bits // 8}" for sign in ("", "U") for bits in (8, 16, 32, 64)},
         "Float32": "f4", "Float64": "f8"}
CELLS = {"Verts": 1, "Lines": 3, "Polys": 7, "Strips": 6, "Cells": None}  # VTK orders its cells like this. The numbers are types of cells.
BASE64 = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/="


def decode_base64(text):
    """Returns the bytes of all base64 pieces of a text, joined. Each piece may end with padding."""
    text = text.translate(None, b" \t\r\n")
    if text.translate(None, BASE64):
        raise ValueError("letters that are not base64's")
    return b"".join(map(binascii.a2b_base64, re.findall(b"[^=]+=*", text)))


def unpack_lzma(packed, size):
    import lzma  # Some Pythons are built without it.

    return lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=2 ** 28).decompress(packed, size)


def unpack_lz4(packed, size):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOCore import vtkLZ4DataCompressor

    compressor = vtkLZ4DataCompressor()
    compressor.AddObserver("ErrorEvent", lambda *_: None)  # The result tells whether it failed.
    found = compressor.Uncompress(np.frombuffer(packed, np.uint8), len(packed), size)
    return b"" if found is None else vtk_to_numpy(found).tobytes()


UNPACK = {"vtkZLibDataCompressor": lambda packed, size: zlib.decompressobj().decompress(packed, size),
          "vtkLZMADataCompressor": unpack_lzma, "vtkLZ4DataCompressor": unpack_lz4}


def refuse(*_):
    raise ValueError("it has a document type")


def parse(data):
    """Returns the tree of elements. Takes text in large pieces, which XMLParser does not do."""
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
    """Lists the arrays of numbers in elements that are called `part`. count: how many tuples each array has; None: the
    array's NumberOfTuples tells."""
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
        """Returns where each cell's points end in a list of points, and this list."""
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
        """Returns the array's bytes, unpacked. The header before the bytes tells their number."""
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
    """Reads all points as one Body, which may be empty."""
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
    """Lists the files of a .pvtp or .pvtu, whose points together are one set."""
    names = [piece.get("Source") for piece in elements(path, "Piece") if piece.get("Source")]
    wanted = path.suffix[:1] + path.suffix[2:]
    odd = next((name for name in names if not name.lower().endswith(wanted.lower())), None)
    if not names or odd is not None:
        raise FileError(f"{path.name} lists no pieces." if odd is None else f"The piece {odd} of {path.name} is no {wanted} file.")
    return [path.parent / name for name in names]


def list_series(path):
    """Reads a .vtk.series, ParaView's list of files and times. Returns {time: files} in the order of time."""
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
    """Returns {time: files} of a .pvd, in the order of time. A run that is repeated in a folder adds its steps again: the last entries
    count."""
    entries, again = {}, []
    for entry in elements(path, "DataSet"):
        try:
            time = float(entry.get("timestep") or 0)
            if not np.isfinite(time):
                raise ValueError
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


# -- the legacy format --

LEGACY_KINDS = {"unsigned_char": "u1", "char": "i1", "signed_char": "i1", "unsigned_short": "u2", "short": "i2", "unsigned_int": "u4",
         "int": "i4", "vtkidtype": "i4", "unsigned_long": "u8", "long": "i8", "float": "f4", "double": "f8",
         **{f"vtktype{sign}int{bits}": f"{'u' if sign else 'i'}{bits // 8}" for sign in ("u", "") for bits in (8, 16, 32, 64)}}
LEGACY_CELLS = {"VERTICES": 1, "LINES": 3, "POLYGONS": 7, "TRIANGLE_STRIPS": 6, "CELLS": 0}  # These are VTK's types of such cells.
LEGACY_COLUMNS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1, "EDGE_FLAGS": 1}


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
        """Returns the words of the next line that is not blank; [] at the end of the file. Skips METADATA."""
        while self.at < len(self.data):
            end = self.data.find(b"\n", self.at, self.at + 1000)
            end = min(len(self.data), self.at + 1000) if end < 0 else end
            words, self.at = self.data[self.at:end].split(), end + 1
            if words == [b"METADATA"]:  # These data end with an empty line.
                found = re.compile(rb"\n\r?\n").search(self.data, self.at)
                self.at = found.end() if found else len(self.data)
            elif words:
                return [word.decode(errors="replace") for word in words]
        return []

    def values(self, kind, count, columns=1):
        kind, count, columns = kind.lower(), int(count), int(columns)
        code, left = LEGACY_KINDS.get(kind), len(self.data) - self.at
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
        """Skips texts. With in_lines, each is a line. Otherwise, each follows its length; the length's first two bits tell how many bytes
        the length has: 8, 4, 2 or 1."""
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
        """Reads a section, whose first line has these words. Adds its arrays to the list `into`. Returns the list for the next section's arrays."""
        word, rest = words[0].upper(), words[1:]

        def put(name, *how):  # VTK writes %20 for a blank in a name.
            into.append((unquote_to_bytes(name).decode(errors="replace"), self.values(*how)))

        if word == "POINTS":
            self.points = self.values(rest[1], rest[0], 3)
        elif word in LEGACY_CELLS and not self.offsets:
            self.cells[word] = self.values("int", rest[1]), int(rest[0])
        elif word in LEGACY_CELLS:
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
                name, columns, count, kind = self.line()
                put(name, kind, count, columns)
        elif word == "SCALARS":
            if self.line()[0].upper() != "LOOKUP_TABLE":
                raise self.damaged()
            put(rest[0], rest[1], self.count, rest[2] if len(rest) > 2 else 1)
        elif word in LEGACY_COLUMNS:
            put(rest[0], rest[1], self.count, LEGACY_COLUMNS[word])
        elif word == "TEXTURE_COORDINATES":
            put(rest[0], rest[2], self.count, rest[1])
        elif word == "COLOR_SCALARS":
            put(rest[0], "float" if self.text else "unsigned_char", self.count, rest[1])
        elif word == "LOOKUP_TABLE":
            self.values("float" if self.text else "unsigned_char", rest[1], 4)
        else:
            raise self.damaged()
        return into


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
        lists = []
        for name, kind in LEGACY_CELLS.items():
            if name in legacy.cells and len(legacy.cells[name][0]):
                begins, ids = legacy.cells[name] if legacy.offsets else offsets_of(*legacy.cells[name])
                types = legacy.types if name == "CELLS" else np.full(len(begins) - 1, kind)
                lists.append((types, lambda begins=begins, ids=ids: (begins[1:], ids)))
        return take_vertices(path.name, body, lists, {name: lambda array=array: array for name, array in legacy.cell_arrays.items()})
    except (ValueError, IndexError):  # Damaged cells tell nothing.
        return body
