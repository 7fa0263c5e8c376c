# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads HDF5 by h5py: only data sets in this file."""
import math
import os
from typing import NamedTuple, Optional

import numpy as np

from ._particles import FileError, check_claim


KEEP_SIZE = (2, 3)  # These filters of HDF5 do not pack: they shuffle bytes, or add a checksum.


def get(group, place):
    """Returns a member of a group by its path, or None. No link is followed and no other file is opened, because a file
    could name any file that its reader may open."""
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

    return isinstance(thing, h5py.Dataset) and thing.shape is not None and thing.dtype.kind in "fiub" and \
        thing.dtype.subdtype is None


def data_set(group, place):
    """Opens a data set of numbers."""
    data = get(group, place)
    if data is None or not is_numbers(data):
        raise FileError(f"{os.path.basename(group.file.filename)}: '{place}' is missing, or does not hold numbers.")
    check_storage(data)
    return data


def check_storage(data):
    """Refuses sizes that the file cannot hold: HDF5 makes room for the data set, and for a chunk, which may be larger. A
    chunk that is packed twice is refused, because it could grow to any size."""
    path, properties = data.file.filename, data.id.get_create_plist()
    name, there = os.path.basename(path), os.path.getsize(path)
    chunk = math.prod(data.chunks or ()) * data.dtype.itemsize
    check_claim(name, f"'{data.name}'", max(data.nbytes, chunk), there)
    packing = [properties.get_filter(i)[0] for i in range(properties.get_nfilters())]
    if sum(code not in KEEP_SIZE for code in packing) > 1:
        raise FileError(f"{name}: '{data.name}' is packed more than once, which is not read.")


class Part(NamedTuple):
    """The particles of one group of one file for which `keep` is true (None: all)."""
    file: os.PathLike
    group: str
    count: int
    keep: Optional[np.ndarray] = None

    def size(self):
        return self.count if self.keep is None else int(np.count_nonzero(self.keep))

    def where(self, mask):
        return self if mask.all() else self._replace(keep=mask)


def load(parts, name):
    """Returns one array of several parts, each read into its place; a part without `keep` is not copied."""
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
    """Lists arrays of numbers with `count` rows."""
    check_claims([group])
    return [name for name in group if is_numbers(get(group, name)) and get(group, name).shape[:1] == (count,)]


def check_claims(groups):
    """Raises FileError if the file cannot hold all arrays of these groups together: many names may mean the same data."""
    claimed = sum(get(group, name).nbytes for group in groups for name in group if is_numbers(get(group, name)))
    for group in groups:
        path = group.file.filename
        check_claim(os.path.basename(path), f"'{group.name}'", claimed, os.path.getsize(path))
