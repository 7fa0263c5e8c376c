# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes files of particles, steps, pieces and points in the forms that VTK reads. All bytes are made here without VTK, so that a test knows exactly
what it reads."""
import base64
import itertools
import math
import struct
import zlib

SPACING = 0.1
CODES = {"Float64": "d", "Int64": "q", "UInt8": "B"}


def lattice(n=10):
    """Returns a block of n^3 particles around the origin: positions, and the arrays that a simulation writes."""
    offset = (n - 1) / 2
    points = [
        ((i - offset) * SPACING, (j - offset) * SPACING, (k - offset) * SPACING)
        for k in range(n) for j in range(n) for i in range(n)
    ]
    count = len(points)
    arrays = {
        "SmoothingLength": [1.3 * SPACING] * count,
        "Mass": [1000 * SPACING ** 3] * count,
        "Density": [1000.0] * count,
        "Radius": [math.sqrt(x * x + y * y + z * z) for x, y, z in points],
        "Velocity": [tuple(p) for p in points],
        "Kind": [0 if p[0] < 0.2 else 1 for p in points],
    }
    return points, arrays


def drop_at(time, n=10, numbers=None, velocity=2.0):
    """Returns the positions and arrays of the block at a time. The block falls, and turns around the z axis with the angular velocity
    `velocity`. numbers: the numbers of the particles to return, in this order."""
    points, arrays = lattice(n)
    angle = velocity * time
    c, s = math.cos(angle), math.sin(angle)
    numbers = list(range(len(points))) if numbers is None else numbers
    moved = [(c * points[i][0] - s * points[i][1], s * points[i][0] + c * points[i][1],
              points[i][2] - 0.5 * time * time) for i in numbers]
    arrays = {name: [values[i] for i in numbers] for name, values in arrays.items()}
    arrays["Velocity"] = [(-velocity * p[1], velocity * p[0], -time) for p in moved]
    arrays["Idp"] = numbers
    return moved, arrays


def flat(values):
    return [v for value in values for v in (value if isinstance(value, tuple) else (value,))]


def text_of(values):
    return " ".join("nan" if v != v else repr(v) for v in flat(values))


def components(values):
    return len(values[0]) if values and isinstance(values[0], tuple) else 1


def packed(values, order="<", kind="Float64"):
    numbers = flat(values)
    return struct.pack(f"{order}{len(numbers)}{CODES[kind]}", *numbers)


def xml_array(name, values, kind="Float64", width=None, form='format="ascii"', text=None):
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width or components(values)}" {form}>'
            f'{text_of(values) if text is None else text}</DataArray>\n')


def xml(points, arrays, kind="PolyData", form="ascii", cells=None, extra=""):
    """Returns the bytes of an XML file. kind: PolyData, or UnstructuredGrid. cells: a (type, points) for each cell; by default vertices, as
    many SPH codes write. form: ascii, inline, compressed or appended (raw). extra: more XML for the point data."""
    appended = b""

    def array(name, values, kind="Float64", width=None):
        nonlocal appended
        data = b"" if form == "ascii" else packed(values, kind=kind)
        size = struct.pack("<I", len(data))
        if form == "ascii":
            return xml_array(name, values, kind, width)
        if form == "appended":
            offset, appended = len(appended), appended + size + data
            return xml_array(name, values, kind, width, f'format="appended" offset="{offset}"', "")
        body = zlib.compress(data)
        text = (base64.b64encode(size + data) if form == "inline" else
                base64.b64encode(struct.pack("<4I", 1, len(data), 0, len(body))) + base64.b64encode(body))
        return xml_array(name, values, kind, width, 'format="binary"', text.decode())

    data = "".join(array(name, values) for name, values in arrays.items()) + extra
    place = array("Points", points, width=3)
    counts = 'NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0"'
    body = f"<PointData>\n{data}</PointData>\n<Points>\n{place}</Points>\n"
    if kind == "UnstructuredGrid":
        cells = [(1, [i]) for i in range(len(points))] if cells is None else cells
        ends = list(itertools.accumulate(len(ids) for _, ids in cells))
        counts = f'NumberOfCells="{len(cells)}"'
        body += ("<Cells>\n" + array("connectivity", [i for _, ids in cells for i in ids], "Int64") + array("offsets", ends, "Int64") +
                 array("types", [shape for shape, _ in cells], "UInt8") + "</Cells>\n")
    packing = ' header_type="UInt32"' + ' compressor="vtkZLibDataCompressor"' * (form == "compressed")
    head = (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian"{packing}>\n<{kind}>\n'
            f'<Piece NumberOfPoints="{len(points)}" {counts}>\n{body}</Piece>\n</{kind}>\n').encode()
    tail = b'<AppendedData encoding="raw">\n_' + appended + b"\n</AppendedData>\n" if appended else b""
    return head + tail + b"</VTKFile>\n"


def write_vtp(path, points, arrays, extra=""):
    path.write_bytes(xml(points, arrays, extra=extra))


def add_field(path, name, values):
    """Adds an array of field data to a .vtp file."""
    array = xml_array(name, values, form=f'format="ascii" NumberOfTuples="{len(values)}"')
    path.write_text(path.read_text().replace("<PolyData>", f"<PolyData><FieldData>{array}</FieldData>"))


def write_vtu(path, points, arrays, cells=None):
    path.write_bytes(xml(points, arrays, "UnstructuredGrid", cells=cells))


def legacy(points, arrays=(), form="ASCII", fields=0, before="", cells=""):
    """Returns the bytes of a legacy file. The last `fields` arrays are stored in a field, the other ones as scalars and vectors. Binary
    numbers are big endian. before, cells: text before and after the points."""
    write = (lambda values: text_of(values).encode()) if form == "ASCII" else (lambda values: packed(values, ">"))
    parts = [f"# vtk DataFile Version 3.0\nparticles\n{form}\nDATASET POLYDATA\n{before}POINTS {len(points)} double\n".encode(),
             write(points), f"\n{cells}".encode()]
    parts += [f"POINT_DATA {len(points)}\n".encode()] if arrays else []
    for i, (name, values) in enumerate(dict(arrays).items()):
        field = len(arrays) - fields
        head = f"FIELD FieldData {fields}\n" if i == field else ""
        head += (f"{name} {components(values)} {len(points)} double\n" if i >= field else
                 f"VECTORS {name} double\n" if components(values) == 3 else
                 f"SCALARS {name} double 1\nLOOKUP_TABLE default\n")
        parts += [head.encode(), write(values), b"\n"]
    return b"".join(parts)


def write_legacy(path, points, arrays, **more):
    path.write_bytes(legacy(points, arrays, **more))


def columns(points, arrays, mark):
    """Returns the names of columns, and rows of numbers. A vector has three columns, each named by the vector's name,
    `mark`, and x, y or z."""
    names = ["x", "y", "z", *(name + (mark + "xyz"[c] if components(values) > 1 else "")
                              for name, values in arrays.items() for c in range(components(values)))]
    return names, [list(p) + flat(values[i] for values in arrays.values()) for i, p in enumerate(points)]


def ply(points, arrays, form):
    names, rows = columns(points, arrays, "_")
    head = [f"ply\nformat {form} 1.0\nelement vertex {len(points)}", *(f"property double {name}" for name in names), "end_header\n"]
    return "\n".join(head).encode() + b"".join(
        text_of(row).encode() + b"\n" if form == "ascii" else packed(row, "<" if "little" in form else ">") for row in rows)


def table(points, arrays):
    names, rows = columns(points, arrays, ":")
    names = [name.replace(":x", ":0").replace(":y", ":1").replace(":z", ":2") for name in names]
    return ("\n".join(",".join(map(str, row)) for row in [names, *rows]) + "\n").encode()


def all_forms(points, arrays):
    """Returns a dictionary from file name to the file's bytes, with one file for each form in which these functions
    write particles."""
    forms = {f"{form}.{ending}": xml(points, arrays, kind, form) for form in ("ascii", "inline", "compressed", "appended")
             for ending, kind in (("vtp", "PolyData"), ("vtu", "UnstructuredGrid"))}
    forms = {**forms, "table.csv": table(points, arrays), "ascii.ply": ply(points, arrays, "ascii"),
             **{f"{end}.ply": ply(points, arrays, f"binary_{end}_endian") for end in ("little", "big")}}
    return {**forms, "ascii.vtk": legacy(points, arrays), "binary.vtk": legacy(points, arrays, "BINARY", len(arrays) - 2)}


def write_gadget(path, points, arrays, chosen, order="<", named=False, count=1):
    """Writes one of the `count` files of a GADGET snapshot: the gas particles `chosen` (numbers), and three stars. named: write format 2."""
    def record(data):
        return struct.pack(order + "I", len(data)) + data + struct.pack(order + "I", len(data))

    def reals(values):
        return struct.pack(f"{order}{len(values)}d", *values)

    n, stars = len(chosen), 3
    header = struct.pack(order + "6i6d2d2i6I2i4d", n, 0, 0, 0, stars, 0, *[0] * 6, 0.25, 3, 0, 0, n, 0, 0, 0, stars, 0, 0,
                         count, 8, 0.3, 0.7, 0.7)
    blocks = [("HEAD", header.ljust(256, b"\0")), ("POS", reals([x for i in chosen for x in points[i]] + [9.0] * 3 * stars)),
              ("VEL", reals([0.0] * 3 * (n + stars))), ("ID", struct.pack(f"{order}{n + stars}I", *range(n + stars))),
              ("MASS", reals([arrays["Mass"][i] for i in chosen] + [1.0] * stars)), ("U", reals([1.0] * n)),
              ("RHO", reals([arrays["Density"][i] for i in chosen])),
              ("HSML", reals([2 * arrays["SmoothingLength"][i] for i in chosen]))]
    data = b""
    for label, block in blocks:
        data += record(label.ljust(4).encode() + struct.pack(order + "I", len(block) + 8)) if named else b""
        data += record(block)
    path.write_bytes(data)


def write_pvd(path, entries):
    """Writes a .pvd file. entries: a (time, file) for each file. Files with the same time are parts of one set of
    particles."""
    entries = list(entries)
    parts = [sum(time == other for other, _ in entries[:i]) for i, (time, _) in enumerate(entries)]
    path.write_text('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>' + "".join(
        f'<DataSet timestep="{time}" group="" part="{part}" file="{name}"/>'
        for part, (time, name) in zip(parts, entries)) +
        '</Collection></VTKFile>')


def write_pieces(path, names):
    """Writes a .pvtp or .pvtu file that lists these pieces."""
    kind = {".pvtp": "PPolyData", ".pvtu": "PUnstructuredGrid"}[path.suffix]
    path.write_text(f'<?xml version="1.0"?><VTKFile type="{kind}"><{kind} GhostLevel="0">' +
                    "".join(f'<Piece Source="{name}"/>' for name in names) + f"</{kind}></VTKFile>")


def write_image(path, extent, origin="0 0 0", spacing="1 1 1"):
    """Writes a grid of points without arrays. extent: for a .vti file its extent, for a .vtk file the number of points along each axis."""
    path.write_text(
        f'<?xml version="1.0"?><VTKFile type="ImageData" version="0.1" byte_order="LittleEndian"><ImageData WholeExtent="{extent}" '
        f'Origin="{origin}" Spacing="{spacing}"><Piece Extent="{extent}"></Piece></ImageData></VTKFile>'
        if path.suffix == ".vti" else "# vtk DataFile Version 3.0\nimage\nASCII\nDATASET STRUCTURED_POINTS\n"
        f"DIMENSIONS {extent}\nORIGIN {origin}\nSPACING {spacing}\n")
