# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particle files written by hand, as ASCII: no VTK between a test and the bytes that it means."""
import itertools
import math

SPACING = 0.1


def lattice(n=10):
    """A block of n^3 particles around the origin: positions and the arrays a simulation writes."""
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


def text_of(values):
    flat = (v for value in values for v in (value if isinstance(value, tuple) else (value,)))
    return " ".join("nan" if v != v else repr(v) for v in flat)


def components(values):
    return len(values[0]) if values and isinstance(values[0], tuple) else 1


def xml_array(name, values, kind="Float64", width=None):
    width = width or components(values)
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" '
            f'format="ascii">{text_of(values)}</DataArray>')


def string_array(name, texts):
    codes = " ".join(" ".join(str(ord(c)) for c in text) + " 0" for text in texts)
    return f'<Array type="String" Name="{name}" format="ascii">{codes}</Array>'


def write_vtp(path, points, arrays, extra=""):
    """`extra` is more XML for the point data."""
    data = "".join(xml_array(name, values) for name, values in arrays.items())
    path.write_text(
        '<?xml version="1.0"?><VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">'
        f'<PolyData><Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="0" '
        f'NumberOfStrips="0" NumberOfPolys="0"><PointData>{data}{extra}</PointData>'
        f'<Points>{xml_array("Points", points, width=3)}</Points></Piece></PolyData></VTKFile>')


def write_vtu(path, points, arrays, cells=None):
    """An unstructured grid of vertices, as many SPH codes write, or of cells: (type, points)."""
    cells = [(1, [i]) for i in range(len(points))] if cells is None else cells
    count = len(cells)
    ends = list(itertools.accumulate(len(ids) for _, ids in cells))
    cells = (xml_array("connectivity", [i for _, ids in cells for i in ids], "Int64") + xml_array("offsets", ends, "Int64") +
             xml_array("types", [kind for kind, _ in cells], "UInt8"))
    data = "".join(xml_array(name, values) for name, values in arrays.items())
    path.write_text(
        '<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" '
        f'byte_order="LittleEndian"><UnstructuredGrid><Piece NumberOfPoints="{len(points)}" '
        f'NumberOfCells="{count}"><PointData>{data}</PointData>'
        f'<Points>{xml_array("Points", points, width=3)}</Points><Cells>{cells}</Cells></Piece>'
        '</UnstructuredGrid></VTKFile>')


def write_legacy(path, points, arrays):
    """Scalars and vectors as a simulation writes them, several of each."""
    lines = ["# vtk DataFile Version 3.0", "particles", "ASCII", "DATASET POLYDATA",
             f"POINTS {len(points)} double", text_of(points), f"POINT_DATA {len(points)}"]
    for name, values in arrays.items():
        if components(values) == 3:
            lines += [f"VECTORS {name} double", text_of(values)]
        else:
            lines += [f"SCALARS {name} double 1", "LOOKUP_TABLE default", text_of(values)]
    path.write_text("\n".join(lines) + "\n")


def drop_at(time, n=10, numbers=None, velocity=2.0):
    """The block at a time at which it falls and turns around the z axis: positions and arrays.
    `numbers` are the particles that are there, in the order of the file."""
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


def write_pvd(path, entries):
    """entries: (time, file) each; those of one time are parts of one set."""
    entries = list(entries)
    parts = [sum(time == other for other, _ in entries[:i]) for i, (time, _) in enumerate(entries)]
    path.write_text('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1"><Collection>' + "".join(
        f'<DataSet timestep="{time}" group="" part="{part}" file="{name}"/>'
        for part, (time, name) in zip(parts, entries)) +
        '</Collection></VTKFile>')
