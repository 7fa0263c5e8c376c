# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads bytes of files: packed by gzip, numbers as text, and arrays that stay in a file until they are used."""
import os
import warnings
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ._particles import FileError

LIMIT = 1000  # Deflate cannot pack more densely.
IS_BLANK = np.isin(np.arange(256), np.frombuffer(b" \t\n\v\f\r", np.uint8))


def ending_of(path):
    """Returns the ending in small letters, without .gz: .csv for a.csv.gz."""
    path = Path(path.stem) if path.suffix.lower() == ".gz" else path
    return path.suffix.lower()


def inflate(path, data, least=None):
    """Unpacks data, or at least its first `least` bytes."""
    if not data.startswith(b"\x1f\x8b"):
        return data
    found, left = [], LIMIT * len(data) + 1024
    while data and left > 0 and (least is None or not found):  # Parallel programs write several parts, one behind the other.
        unpacker = zlib.decompressobj(31)
        try:
            found.append(unpacker.decompress(data, left if least is None else least))
        except zlib.error as error:
            raise FileError(f"{path.name} is damaged: {error}") from None
        if not unpacker.eof and least is None:
            raise FileError(f"{path.name} ends too early.")
        data, left = unpacker.unused_data, left - len(found[-1])
    return b"".join(found)


def read_bytes(path):
    return inflate(path, path.read_bytes())


def read_head(path):
    with open(path, "rb") as file:
        return inflate(path, file.read(4096), 200)


def parse_numbers(text, kind, count):
    """Returns the first `count` numbers, with blanks between them, of bytes or a memoryview, and where the last one ends.
    Raises ValueError. Time and memory depend only on the numbers that are read, not on the text behind them."""
    size = 16 * count + 64
    while True:  # Longer pieces are tried until one has `count` words.
        piece = bytes(text[:size])
        is_blank = np.append(IS_BLANK[np.frombuffer(piece, np.uint8)], len(piece) == len(text))
        ends = np.flatnonzero(is_blank[1:] & ~is_blank[:-1]) + 1
        if len(ends) >= count or len(piece) == len(text):
            break
        size *= 2
    if len(ends) < count:
        raise ValueError(f"{len(ends)} numbers where there should be {count}")
    end = int(ends[count - 1]) if count else 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # NumPy warns when it stops at a word that is no number.
        values = np.fromstring(piece[:end], kind, sep=" ") if count else np.empty(0, kind)
    if len(values) != count:
        raise ValueError("a word is no number")
    return values, end


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
