# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads files that may be packed by gzip."""
import zlib
from pathlib import Path

from ._particles import FileError

LIMIT = 1000  # Deflate cannot pack more densely.


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
