# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""HDF5 by h5py: data sets of this file alone."""
import os
from typing import NamedTuple, Optional

import numpy as np

from ._particles import FileError


def get(group, place):
    """A member of a group by its path, or None. No link is followed, and nothing that lies in other files is opened: a
    file could name any of the reader's."""
    import h5py

    file = os.path.basename(group.file.filename)
    for name in place.strip("/").split("/"):
        link = group.get(name, getlink=True) if isinstance(group, h5py.Group) else None
        if link is None:
            return None
        if not isinstance(link, h5py.HardLink):
            raise FileError(f"{file}: '{name}' is a link, which is not followed.")
        group = group[name]
    if isinstance(group, h5py.Dataset) and (group.is_virtual or group.external):
        raise FileError(f"{file}: '{place}' lies in other files, which are not opened. Give these files themselves.")
    return group


def is_numbers(thing):
    import h5py

    return isinstance(thing, h5py.Dataset) and thing.dtype.kind in "fiub" and thing.dtype.subdtype is None


def data_set(group, place):
    """A data set of numbers. Its declared size costs nothing in a file: one that the file cannot hold is refused."""
    data = get(group, place)
    if data is None or not is_numbers(data):
        raise FileError(f"{os.path.basename(group.file.filename)}: '{place}' is missing, or does not hold numbers.")
    name, file = data.name, data.file.filename
    bytes_there = os.path.getsize(file)
    if data.nbytes > 2 ** 24 and data.nbytes > 1000 * bytes_there:
        raise FileError(f"{os.path.basename(file)}: '{name}' claims {data.nbytes} bytes, the file has {bytes_there}.")
    return data


class Part(NamedTuple):
    """Some of an array's particles: those of one group of one file that keep (None: all) marks."""
    file: os.PathLike
    group: str
    count: int
    keep: Optional[np.ndarray] = None

    def size(self):
        return self.count if self.keep is None else int(np.count_nonzero(self.keep))

    def where(self, mask):
        return self if mask.all() else self._replace(keep=mask)


def load(parts, name):
    """One array of several parts, each read into its place: where all of a part are kept, no copy is made."""
    import h5py

    result, begin = None, 0
    for part in parts:
        with h5py.File(part.file, "r") as file:
            data = data_set(file, f"{part.group}/{name}")
            if data.shape[:1] != (part.count,):
                raise FileError(f"{os.path.basename(part.file)}: '{data.name}' has the shape {data.shape} for {part.count} "
                                "particles.")
            if result is None:
                shape = (sum(each.size() for each in parts),) + data.shape[1:]
                result = np.empty(shape, data.dtype.newbyteorder("="))
            end = begin + part.size()
            if part.keep is not None:
                result[begin:end] = data[()][part.keep]
            elif part.count:
                data.read_direct(result, dest_sel=np.s_[begin:end])
            begin = end
    return result


def names_of(group, count):
    """Arrays of numbers with so many rows."""
    return [name for name in group if is_numbers(get(group, name)) and get(group, name).shape[:1] == (count,)]
