# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads GADGET's binary formats 1 and 2, in one file or several: records of Fortran, each between two copies of its number of bytes.
First a header of 256 bytes; then a record for each array: of all types of particles in order, of the types without a mass in
the header, or of gas. In format 2, a record with the array's name comes before each; in format 1, the order tells the names."""
import re
import struct

import numpy as np

from .._library import say
from ._particles import FileError, Particles, by_name
from ._bytes import RawArray, state_of

HEADER = "6i6d2d2i6I2i4d"
LABELS = {"POS": "Coordinates", "VEL": "Velocities", "ID": "ParticleIDs", "MASS": "Masses", "U": "InternalEnergy",
          "RHO": "Density", "NE": "ElectronAbundance",
          "NH": "NeutralHydrogenAbundance", "HSML": "SmoothingLength", "POT": "Potential",
          "ACCE": "Acceleration"}
VECTORS = ("POS", "VEL", "ACCE")
TYPES = {"gas": 0, "dark_matter": 1, "disk": 2, "bulge": 3, "stars": 4, "black_holes": 5, "boundary": 5, "sinks": 3,
         "neutrinos": 6}


def files_of(path, count):
    """Lists all files of a snapshot that has several, NAME.0.hdf5, ..., or NAME.0, ..."""
    found = re.fullmatch(r"(.*)\.(\d+)(\.h(?:df)?5|)", path.name)
    if count <= 1 or not found:  # Some whole files say 0.
        return [path]
    if count > 65536:
        raise FileError(f"{path.name} claims to be one of {count} files.")
    files = [path.with_name(f"{found[1]}.{i}{found[3]}") for i in range(count)]
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        raise FileError(f"{path.name} is one of {count} files of a snapshot; {missing[0]} is missing.")
    return files


def numbers_of(types):
    """Returns the numbers of types of particles; None means gas."""
    types = 0 if types is None else types
    chosen = [types] if isinstance(types, (str, int)) else list(types)
    numbers = []
    for kind in chosen:
        if isinstance(kind, str) and kind not in TYPES:
            raise FileError(f"There is no type '{kind}': {', '.join(TYPES)}, or a number.")
        numbers.append(TYPES[kind] if isinstance(kind, str) else int(kind))
    return numbers


def no_particles(path, types):
    return FileError(f"{path.name} has no particles of type {', '.join(map(str, types))}.")


def is_gadget_binary(head):
    return order_of(head) is not None


def order_of(head):
    """Returns the byte order, from the first record: the header, or a name of four letters and a number."""
    for order in "<>":
        size = struct.unpack_from(order + "I", head)[0] if len(head) >= 8 else 0
        if size == 256 or (size == 8 and head[4:8] == b"HEAD"):
            return order
    return None


class BinaryFile:
    """Reads the header, and finds where arrays lie. arrays: {label: RawArray}."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.file, self.path, self.state = file, path, state_of(file)
            head = file.read(8)
            self.order = order_of(head)
            if self.order is None:
                raise FileError(f"{path.name} is no file of GADGET's.")
            self.named = head[4:8] == b"HEAD"
            file.seek(0)
            self.read_header()
            self.arrays = by_name(path.name, self.read_arrays())
        if "POS" not in self.arrays:
            raise FileError(f"{path.name} has no positions.")

    def record(self):
        """Returns where the next record begins, and its number of bytes; None at the end."""
        before = self.file.read(4)
        if not before:
            return None
        begin = self.file.tell()
        size = struct.unpack(self.order + "I", before)[0] if len(before) == 4 else self.state[1]
        if begin + size + 4 > self.state[1]:
            raise FileError(say("FILE_ENDS", self.path.name, begin))
        self.file.seek(begin + size)
        if self.file.read(4) != before:
            raise FileError(say("RECORD_ENDS", self.path.name, begin))
        return begin, size

    def label(self):
        """Returns the name of the next array, in format 2, or None at the end."""
        found = self.record()
        if found is None:
            return None
        self.file.seek(found[0])
        text = self.file.read(8)[:4].decode("latin-1").strip()
        self.file.seek(found[0] + found[1] + 4)
        return text

    def read_header(self):
        if self.named:
            self.label()
        begin, size = self.record() or (0, 0)
        if size != 256:
            raise FileError(f"{self.path.name} has a damaged header.")
        self.file.seek(begin)
        values = struct.unpack(self.order + HEADER, self.file.read(struct.calcsize("<" + HEADER)))
        self.file.seek(begin + size + 4)
        self.counts, self.masses, (self.time, self.redshift) = values[:6], values[6:12], values[12:14]
        self.has_cooling, self.files = values[22], values[23]
        self.box_size, self.hubble_parameter = values[24], values[27]
        if min(self.counts) < 0:
            raise FileError(f"{self.path.name} claims {min(self.counts)} particles of a type.")

    def read_arrays(self):
        """Yields (label, RawArray) of each array that is known, or has a fitting size."""
        total, gas = sum(self.counts), self.counts[0]
        with_masses = sum(count for count, mass in zip(self.counts, self.masses) if not mass)
        counts = {**dict.fromkeys(("POS", "VEL", "ID", "POT", "ACCE"), total), "MASS": with_masses}
        order = iter(["POS", "VEL", "ID", *["MASS"] * bool(with_masses), "U", "RHO", *["NE", "NH"] * bool(self.has_cooling),
                      "HSML"])
        while True:
            label = self.label() if self.named else next(order, None)
            found = self.record() if label is not None else None
            if found is None:
                return
            begin, size = found
            count, columns = counts.get(label, gas), 3 if label in VECTORS else 1
            width = size // (count * columns) if count else 0
            if width * count * columns != size or width not in (4, 8):
                if label in counts:
                    raise FileError(f"{self.path.name}: '{label}' has {size} bytes for {count} particles.")
                continue
            kind = np.dtype(f"{self.order}{'u' if label == 'ID' else 'f'}{width}")
            yield label, RawArray(self.path, self.state, begin, kind, count, columns)

    def load(self, label, kind):
        """Returns one array of the particles of type `kind`."""
        if label == "MASS" and self.masses[kind]:
            return np.full(self.counts[kind], self.masses[kind])
        if label not in self.arrays:
            raise FileError(f"{self.path.name} has no {LABELS.get(label, label)}.")
        array = self.arrays[label]
        if label == "MASS":
            begin = sum(count for count, mass in zip(self.counts[:kind], self.masses) if not mass)
        else:
            begin = sum(self.counts[:kind]) if array.count == sum(self.counts) else 0
        return array.rows(begin, self.counts[kind]).load()

    def labels_of(self, kind):
        """Returns the arrays that particles of a type have."""
        whole, gas = sum(self.counts), self.counts[0]
        return [label for label, array in self.arrays.items() if label in ("POS", "MASS") or array.count == whole
                or (kind == 0 and array.count == gas)]


def read_gadget_binary(path, types):
    wanted = numbers_of(types)
    first = BinaryFile(path)
    files = [first if each == path else BinaryFile(each) for each in files_of(path, first.files)]
    parts = [(file, kind) for kind in wanted if 0 <= kind < 6 for file in files if file.counts[kind]]
    if not parts:
        raise no_particles(path, wanted)
    labels = [label for label in parts[0][0].labels_of(parts[0][1])
              if all(label in file.labels_of(kind) for file, kind in parts)]
    labels += [] if "MASS" in labels else ["MASS"]

    def load(label):
        return np.concatenate([file.load(label, kind) for file, kind in parts])

    arrays = {LABELS.get(label, label): lambda label=label: load(label) for label in labels if label != "POS"}
    return Particles(
        path.name, "GADGET", lambda: load("POS"), arrays, support_radius=True, mass="Masses",
        smoothing_length="SmoothingLength" if "SmoothingLength" in arrays else None,
        density="Density" if "Density" in arrays else None, time=first.time,
        parameters={"time": first.time, "redshift": first.redshift, "hubble_parameter": first.hubble_parameter,
                    "box_size": [first.box_size] * 3, "scale_factor": 1 / (1 + first.redshift) if first.redshift > 0 else None,
                    "types": wanted})
