# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes lattice.vtkhdf (an unstructured grid), lattice_poly.vtkhdf, film.vtkhdf (three steps) and the files that point to other files. The script
needs h5py."""
import pathlib

import h5py
import numpy

import particle_files as files

HERE = pathlib.Path(__file__).resolve().parent


def fill_cells(group, count):
    group["NumberOfCells"] = numpy.array([count])
    group["NumberOfConnectivityIds"] = numpy.array([count])
    group["Connectivity"] = numpy.arange(count)
    group["Offsets"] = numpy.arange(count + 1)


def write(path, kind, version, side=3):
    points, arrays = files.lattice(side)
    with h5py.File(path, "w", libver="earliest") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = numpy.array(version, "i8")
        root.attrs.create("Type", kind, dtype=h5py.string_dtype("ascii", len(kind)))
        root["NumberOfPoints"] = numpy.array([len(points)])
        root["Points"] = numpy.array(points)
        if kind == b"PolyData":
            for name in ("Vertices", "Lines", "Polygons", "Strips"):
                fill_cells(root.create_group(name), len(points) if name == "Vertices" else 0)
        else:
            fill_cells(root, len(points))
            root["Types"] = numpy.ones(len(points), "u1")
        for name, values in arrays.items():
            root[f"PointData/{name}"] = numpy.array(values, "u1" if name == "Kind" else "f8")


write(HERE / "lattice.vtkhdf", b"UnstructuredGrid", (1, 0))
write(HERE / "lattice_poly.vtkhdf", b"PolyData", (2, 0))


def write_film(path):
    """Writes three steps: lattices of 3, 0 and 2 points along each side. The last step has two parts. The array Kind is stored only
    once."""
    sides, parts = (3, 0, 2), ([27], [0], [5, 3])
    lattices = [files.lattice(side) if side else ([], {}) for side in sides]
    begins = numpy.cumsum([0, *(len(points) for points, _ in lattices)])
    with h5py.File(path, "w", libver="earliest") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = numpy.array((2, 0), "i8")
        root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", 8))
        root["NumberOfPoints"] = numpy.concatenate(parts)
        root["Points"] = numpy.concatenate([points for points, _ in lattices if points])
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = 3
        steps["Values"], steps["PointOffsets"] = numpy.array([0.0, 0.5, 2.0]), begins[:3]
        steps["PartOffsets"], steps["NumberOfParts"] = numpy.array([0, 1, 2]), numpy.array([1, 1, 2])
        for name in lattices[0][1]:
            values = [arrays[name] for _, arrays in lattices if arrays]
            root[f"PointData/{name}"] = numpy.array(values[0], "u1") if name == "Kind" else numpy.concatenate(values)
            steps[f"PointDataOffsets/{name}"] = numpy.zeros(3, int) if name == "Kind" else begins[:3]


write_film(HERE / "film.vtkhdf")

for name in ("link", "storage", "virtual"):
    write(HERE / f"{name}.vtkhdf", b"UnstructuredGrid", (1, 0), 2)
    with h5py.File(HERE / f"{name}.vtkhdf", "a", libver="earliest") as file:
        arrays = file["VTKHDF/PointData"]
        if name == "link":
            arrays["Secret"] = h5py.ExternalLink("other.h5", "Secret")
        elif name == "storage":
            arrays.create_dataset("Secret", (8,), "u1", external=[("secret", 0, 8)])
        else:
            layout = h5py.VirtualLayout((8,), "u1")
            layout[:] = h5py.VirtualSource("other.h5", "Secret", (8,))
            arrays.create_virtual_dataset("Secret", layout)
