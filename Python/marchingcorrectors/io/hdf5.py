# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""HDF5 by h5py: which layout it is, and data sets that a file may be trusted with."""
import os

import numpy as np

from ._particles import FileError


def get(group, name):
    """A member of a group, or None. A link to another file is not followed."""
    import h5py

    link = group.get(name, getlink=True)
    if isinstance(link, h5py.ExternalLink):
        raise FileError(f"{os.path.basename(group.file.filename)}: '{name}' is a link to another file, which is not "
                        "followed.")
    return None if link is None else group.get(name)


def is_numbers(thing):
    import h5py

    return isinstance(thing, h5py.Dataset) and thing.dtype.kind in "fiub" and thing.dtype.subdtype is None


def check(data):
    """A data set's declared size costs nothing in a file: one that the file cannot hold is refused."""
    name, file = data.name, data.file.filename
    if not is_numbers(data):
        raise FileError(f"{os.path.basename(file)}: '{name}' does not hold numbers.")
    if data.external:
        raise FileError(f"{os.path.basename(file)}: '{name}' lies in another file, which is not opened.")
    bytes_there = os.path.getsize(file)
    if data.nbytes > 2 ** 24 and data.nbytes > 1000 * bytes_there and not data.is_virtual:
        raise FileError(f"{os.path.basename(file)}: '{name}' claims {data.nbytes} bytes, the file has {bytes_there}.")
    return data


def load(paths, place, count=None):
    """One array of several files, read into its place: no copy is made. count: the length it must have."""
    import h5py

    result, begin = None, 0
    for path, length in paths:
        with h5py.File(path, "r") as file:
            data = check(file[place])
            if data.shape[0] != length:
                raise FileError(f"{os.path.basename(path)}: '{place}' has {data.shape[0]} values for {length} particles.")
            if result is None:
                total = sum(length for _, length in paths)
                result = np.empty((total,) + data.shape[1:], data.dtype.newbyteorder("="))
            if length:
                data.read_direct(result, dest_sel=np.s_[begin:begin + length])
            begin += length
    return result


def read_hdf5(path, types):
    import h5py

    from . import gadget, phantom, pysph

    with h5py.File(path, "r") as file:
        names = set(file)
    if any(name.startswith("PartType") for name in names):
        return gadget.read_gadget(path, types)
    if types is not None:
        raise FileError(f"{path.name} is no snapshot of GADGET's layout: it has no types to choose.")
    if {"header", "particles"} <= names:
        return phantom.read_hdf5_dump(path)
    if {"solver_data", "particles"} <= names:
        return pysph.read_pysph(path)
    raise FileError(f"{path.name} is HDF5, but no layout that is known here: GADGET, GIZMO, AREPO and SWIFT have "
                    "PartType0, Phantom has header and particles, PySPH has solver_data and particles.")
