# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads NumPy's .npz and .npy of plain arrays. Arrays of objects hold pickles, which are not opened."""
import io
import zipfile

import numpy as np

from .._library import warn
from ._particles import TIMES, FileError, check_claim, period_of_field, usual
from .tables import axes_of, body_of


def array_of(file, name, data):
    """Reads an array from the bytes of a .npy file."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}[version]
    shape, by_columns, kind = read(stream)
    if kind.hasobject:
        raise FileError(f"{file} is not opened: its array '{name}' holds Python's objects, which are pickles, which can run code. Let "
                        "the solver write HDF5 (PySPH: install h5py), or plain arrays.")
    count = int(np.prod(shape, dtype=object))
    if min(shape, default=0) < 0 or count * kind.itemsize > len(data) - stream.tell() or kind.itemsize == 0:
        raise FileError(f"{file}: its array '{name}' claims {shape} values, for which it is too short.")
    values = np.frombuffer(data, kind, count, stream.tell())
    return values.reshape(shape[::-1]).T if by_columns else values.reshape(shape)


def read_arrays(path):
    if path.suffix.lower() == ".npy":
        found = {"positions": array_of(path.name, path.stem, path.read_bytes())}
        if found["positions"].dtype.names:
            found = {name: found["positions"][name] for name in found["positions"].dtype.names}
    else:
        with zipfile.ZipFile(path) as packed:
            members = packed.infolist()
            check_claim(path.name, "its arrays together", sum(each.file_size for each in members), path.stat().st_size)
            found = {each.filename[:-4]: array_of(path.name, each.filename[:-4], packed.read(each)) for each in members
                     if each.filename.endswith(".npy")}
    places = [usual([name for name in found if found[name].ndim == 2], "position"), *(name for name in axes_of(found) if found[name].ndim == 1)]
    place = next((name for name in places if name is not None), None)
    count = -1 if place is None else len(found[place])
    plain = {name: np.ascontiguousarray(values, values.dtype.newbyteorder("=")) for name, values in found.items()
             if values.ndim in (1, 2) and len(values) == count}
    if place is not None and found[place].ndim == 2 and found[place].shape[1] == 2:
        plain[place] = np.pad(plain[place], ((0, 0), (0, 1)))  # The positions lie in a plane.
    body = body_of(path.name, {name: np.empty(0) for name in found} if place is None else plain)
    alone = {name: values for name, values in found.items() if name not in plain}
    time = next((values for name, values in alone.items() if name.lower() in ("t", *(each.lower() for each in TIMES))
                 and values.size == 1 and values.dtype.kind in "fiu"), None)
    others = [name for name, values in alone.items() if values is not time and name != "PeriodicBounds"]
    if others:
        warn(f"{path.name}: no value for each of {count} particles have {', '.join(others)[:200]}, which are left out.")
    return body._replace(time=None if time is None else float(np.ravel(time)[0]), period=period_of_field(alone))
