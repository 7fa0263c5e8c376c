# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particle files in the binary forms that VTK reads, written without VTK."""
import base64
import struct
import zlib

from particle_files import components


def flat(values):
    return [x for value in values for x in (value if isinstance(value, tuple) else (value,))]


def packed(values, order="<"):
    numbers = flat(values)
    return struct.pack(f"{order}{len(numbers)}d", *numbers)


def inline(data):
    return base64.b64encode(struct.pack("<I", len(data)) + data)


def compressed(data):
    body = zlib.compress(data)
    header = struct.pack("<4I", 1, len(data), 0, len(body))
    return base64.b64encode(header) + base64.b64encode(body)


def unpacked(text):
    """Unpacks an array that VTK has packed with LZ4: a header of four numbers, then one block of sequences, each of bytes to
    copy from the block and of bytes to repeat from what is there already."""
    blocks, _, _, _ = struct.unpack("<4I", base64.b64decode(text[:24])[:16])
    assert blocks == 1
    block, at, data = base64.b64decode(text[24:]), 0, bytearray()

    def length(short):
        nonlocal at
        total = short
        while short in (15, 255):
            short = block[at]
            total, at = total + short, at + 1
            short = 255 if short == 255 else 0
        return total

    while at < len(block):
        token, at = block[at], at + 1
        literals = length(token >> 4)
        data += block[at:at + literals]
        at += literals
        if at < len(block):
            back, at = block[at] | block[at + 1] << 8, at + 2
            for _ in range(length(token & 15) + 4):
                data.append(data[-back])
    return bytes(data)


def cells(count):
    """Cells of an unstructured grid, one per particle: name, type, data."""
    return [("connectivity", "Int64", struct.pack(f"<{count}q", *range(count))),
            ("offsets", "Int64", struct.pack(f"<{count}q", *range(1, count + 1))),
            ("types", "UInt8", bytes([1] * count))]


def xml(points, arrays, kind="PolyData", form="inline"):
    """kind: PolyData, UnstructuredGrid; form: inline, compressed, appended (raw)."""
    appended = b""

    def array(name, type_name, width, data):
        nonlocal appended
        start = (f'<DataArray type="{type_name}" Name="{name}" NumberOfComponents="{width}" '
                 'format="').encode()
        if form != "appended":
            text = inline(data) if form == "inline" else compressed(data)
            return start + b'binary">' + text + b"</DataArray>\n"
        offset = len(appended)
        appended += struct.pack("<I", len(data)) + data
        return start + b'appended" offset="%d"/>\n' % offset

    count = len(points)
    body = b"".join([b"<PointData>\n",
                     *(array(n, "Float64", components(v), packed(v)) for n, v in arrays.items()),
                     b"</PointData>\n<Points>\n", array("Points", "Float64", 3, packed(points)),
                     b"</Points>\n"])
    counts = 'NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0"'
    if kind == "UnstructuredGrid":
        counts = f'NumberOfCells="{count}"'
        body += b"<Cells>\n" + b"".join(array(n, t, 1, d) for n, t, d in cells(count)) + b"</Cells>\n"
    compressor = ' compressor="vtkZLibDataCompressor"' if form == "compressed" else ""
    tail = b'<AppendedData encoding="raw">\n_' + appended + b"\n</AppendedData>\n" if appended else b""
    return (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian" '
            f'header_type="UInt32"{compressor}>\n<{kind}>\n<Piece NumberOfPoints="{count}" {counts}>\n'
            ).encode() + body + f"</Piece>\n</{kind}>\n".encode() + tail + b"</VTKFile>\n"


def legacy(points, arrays):
    """Scalars, vectors and a field, big endian as all binary legacy files."""
    count = len(points)
    parts = [b"# vtk DataFile Version 3.0\nparticles\nBINARY\nDATASET POLYDATA\n",
             b"POINTS %d double\n" % count, packed(points, ">"), b"\nPOINT_DATA %d\n" % count]
    for name, values in list(arrays.items())[:2]:
        parts += [f"SCALARS {name} double 1\nLOOKUP_TABLE default\n".encode(), packed(values, ">"), b"\n"]
    rest = list(arrays.items())[2:]
    parts.append(b"FIELD FieldData %d\n" % len(rest))
    for name, values in rest:
        parts += [f"{name} {components(values)} {count} double\n".encode(), packed(values, ">"), b"\n"]
    return b"".join(parts)


def all_forms(points, arrays):
    """Name of a file and its bytes, for each form."""
    forms = {}
    for form in ("inline", "compressed", "appended"):
        forms[form + ".vtp"] = xml(points, arrays, "PolyData", form)
        forms[form + ".vtu"] = xml(points, arrays, "UnstructuredGrid", form)
    return {**forms, "binary.vtk": legacy(points, arrays)}
