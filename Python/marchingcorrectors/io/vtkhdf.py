# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads one step of VTK's .vtkhdf: points of poly data or an unstructured grid, and their arrays. An array has its steps one
after the other. Steps tells where each step begins: its parts (PartOffsets, NumberOfParts), its points (PointOffsets),
and, if this differs, an array's values (PointDataOffsets)."""
import numpy as np

from ._particles import Body, FileError, choose_step
from .hdf5 import check_claims, data_set, get, is_numbers


def integers(group, place):
    data = data_set(group, place)
    if data.dtype.kind not in "iu":
        raise FileError(f"'{place}' does not hold whole numbers.")
    return np.ravel(data[()]).tolist()


def read_vtkhdf(path, step):
    import h5py

    with h5py.File(path, "r") as file:
        root = get(file, "VTKHDF")
        kind = root.attrs.get("Type", b"")
        kind = kind.decode(errors="replace") if isinstance(kind, bytes) else str(kind)
        if kind not in ("PolyData", "UnstructuredGrid"):
            raise FileError(f"{path.name} holds data of the type '{kind}', not particles (PolyData or UnstructuredGrid).")
        parts, offset, times = integers(root, "NumberOfPoints"), 0, None
        steps, arrays = get(root, "Steps"), get(root, "PointData")
        if steps is not None:
            times = [float(time) for time in np.ravel(data_set(steps, "Values")[()])]
            i = choose_step(path.name, step, times)
            first, offset = integers(steps, "PartOffsets")[i], integers(steps, "PointOffsets")[i]
            count = integers(steps, "NumberOfParts")[i] if get(steps, "NumberOfParts") is not None else 1
            if min(first, count, offset) < 0 or first + count > len(parts):
                raise FileError(f"{path.name} has no parts {first} to {first + count} of step {i}.")
            parts = parts[first:first + count]
        total, found = sum(parts), {}

        def values(data, begin):
            if min(parts, default=0) < 0 or begin < 0 or begin + total > data.shape[0]:
                raise FileError(f"{path.name}: '{data.name}' has {data.shape[0]} values, not {total} from {begin} on.")
            return data[begin:begin + total]

        points = values(data_set(root, "Points"), offset)
        names = [name for name in arrays or () if is_numbers(get(arrays, name)) and len(get(arrays, name).shape) in (1, 2)]
        check_claims([arrays] if names else [])
        for name in names:
            begin = offset
            if steps is not None and get(steps, f"PointDataOffsets/{name}") is not None:
                begin = integers(steps, f"PointDataOffsets/{name}")[i]
            found[name] = values(data_set(arrays, name), begin)
    return Body(points, found, None if times is None else times[i], times=times)
