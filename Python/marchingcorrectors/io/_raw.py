# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Arrays that stay in a file, as bytes, until they are used."""
import os
from typing import NamedTuple

import numpy as np

from ._particles import FileError


def state_of(file):
    """Returns a mark that changes when the file is written anew."""
    status = os.fstat(file.fileno())
    return status.st_ino, status.st_size, status.st_mtime_ns


class RawArray(NamedTuple):
    """Where an array lies in a file."""
    path: os.PathLike
    state: tuple
    begin: int
    kind: np.dtype
    count: int
    columns: int = 1

    def load(self):
        with open(self.path, "rb") as file:
            values = np.fromfile(file, self.kind, self.count * self.columns, offset=self.begin)
            if state_of(file) != self.state:
                raise FileError(f"{self.path.name} was written anew after it had been opened: read it once more.")
        values = values.astype(self.kind.newbyteorder("="), copy=False)
        return values.reshape(self.count, self.columns) if self.columns > 1 else values

    def rows(self, begin, count):
        width = self.columns * self.kind.itemsize
        return self._replace(begin=self.begin + begin * width, count=count)
