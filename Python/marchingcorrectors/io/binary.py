# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads solvers' binary files: GADGET's formats 1 and 2, DualSPHysics' .bi4, Houdini's .bgeo, as SPlisHSPlasH writes it, and Phantom's dumps."""
import itertools
import os
import re
import struct
from typing import NamedTuple

import numpy as np

from .._library import say
from ._particles import FileError, Particles, by_name, read_bytes


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


# GADGET: one file or several, which consist of Fortran's records. A record stands between two copies of its number of bytes. The first is a
# header of 256 bytes. Each other record is an array: of all types of particles in order, of the types that have no mass in the header, or
# of gas. In format 2, a record with the array's name comes before each record; in format 1, the order of the arrays tells their names.
HEADER = "6i6d2d2i6I2i4d"
LABELS = {"POS": "Coordinates", "VEL": "Velocities", "ID": "ParticleIDs", "MASS": "Masses", "U": "InternalEnergy",
          "RHO": "Density", "NE": "ElectronAbundance",
          "NH": "NeutralHydrogenAbundance", "HSML": "SmoothingLength", "POT": "Potential",
          "ACCE": "Acceleration"}
VECTORS = ("POS", "VEL", "ACCE")
TYPES = {"gas": 0, "dark_matter": 1, "disk": 2, "bulge": 3, "stars": 4, "black_holes": 5, "boundary": 5, "sinks": 3,
         "neutrinos": 6}


def files_of(path, count):
    """Lists all files of a snapshot that has several, NAME.0.hdf5, ..., or NAME.0, ...; else the one file. Raises FileError if one is
    missing."""
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
    """Lists the types of particles as numbers, gas being 0. types: a name or a number, a list of these, or None, which means gas."""
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


def bytes_at(file, place, count):
    file.seek(place)
    return file.read(count)


def order_of(head):
    """Returns the byte order, "<" or ">", in which the first record has 256 bytes, or 8 bytes that begin with "HEAD"; else None."""
    for order in "<>":
        size = struct.unpack_from(order + "I", head)[0] if len(head) >= 8 else 0
        if size == 256 or (size == 8 and head[4:8] == b"HEAD"):
            return order
    return None


class BinaryFile:
    """Reads the header, and finds where arrays lie. arrays: {label: RawArray}."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.path, self.state, head = path, state_of(file), file.read(8)
            self.order, is_named = order_of(head), head[4:8] == b"HEAD"
            if self.order is None:
                raise FileError(f"{path.name} is no file of GADGET's.")
            records = self.records(file)
            begin, size = next(itertools.islice(records, int(is_named), None), (0, 0))
            if size != 256:
                raise FileError(f"{path.name} has a damaged header.")
            values = struct.unpack(self.order + HEADER, bytes_at(file, begin, struct.calcsize("<" + HEADER)))
            self.counts, self.masses, (self.time, self.redshift) = values[:6], values[6:12], values[12:14]
            self.files, self.box_size, self.hubble_parameter = values[23], values[24], values[27]
            if min(self.counts) < 0:
                raise FileError(f"{path.name} claims {min(self.counts)} particles of a type.")
            with_masses = sum(count for count, mass in zip(self.counts, self.masses) if not mass)
            labels = ["POS", "VEL", "ID", *["MASS"] * bool(with_masses), "U", "RHO", *["NE", "NH"] * bool(values[22]), "HSML"]
            blocks = zip(labels, records)
            if is_named:
                blocks = ((bytes_at(file, begin, 4).decode("latin-1").strip(), record) for (begin, _), record in zip(records, records))
            self.arrays = by_name(path.name, self.read_arrays(blocks, with_masses))
        if "POS" not in self.arrays:
            raise FileError(f"{path.name} has no positions.")

    def records(self, file):
        """Yields where each record begins, and its number of bytes."""
        begin = 4
        while begin - 4 < self.state[1]:
            before = bytes_at(file, begin - 4, 4)
            size = struct.unpack(self.order + "I", before)[0] if len(before) == 4 else self.state[1]
            if begin + size + 4 > self.state[1]:
                raise FileError(say("FILE_ENDS", self.path.name, begin))
            if bytes_at(file, begin + size, 4) != before:
                raise FileError(say("RECORD_ENDS", self.path.name, begin))
            yield begin, size
            begin += size + 8

    def read_arrays(self, blocks, with_masses):
        """Yields (label, RawArray) of each array whose size fits the number of particles. If a size does not fit, skips the array; but raises
        FileError if the array is MASS, or one that all types have."""
        counts = {**dict.fromkeys(("POS", "VEL", "ID", "POT", "ACCE"), sum(self.counts)), "MASS": with_masses}
        for label, (begin, size) in blocks:
            count, columns = counts.get(label, self.counts[0]), 3 if label in VECTORS else 1
            width = size // (count * columns) if count else 0
            if width * count * columns == size and width in (4, 8):
                kind = np.dtype(f"{self.order}{'u' if label == 'ID' else 'f'}{width}")
                yield label, RawArray(self.path, self.state, begin, kind, count, columns)
            elif label in counts:
                raise FileError(f"{self.path.name}: '{label}' has {size} bytes for {count} particles.")

    def holds(self, label, kind):
        """Returns whether an array has values of particles of type `kind`."""
        return not self.masses[kind] if label == "MASS" else kind == 0 or self.arrays[label].count == sum(self.counts)

    def load(self, label, kind):
        """Returns one array of the particles of type `kind`."""
        if label == "MASS" and self.masses[kind]:
            return np.full(self.counts[kind], self.masses[kind])
        if label not in self.arrays:
            raise FileError(f"{self.path.name} has no {LABELS.get(label, label)}.")
        begin = sum(self.counts[other] for other in range(kind) if self.holds(label, other))
        return self.arrays[label].rows(begin, self.counts[kind]).load()

    def labels_of(self, kind):
        """Returns the labels of the arrays that particles of type `kind` have."""
        return [label for label in self.arrays if label == "MASS" or self.holds(label, kind)]


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


# DualSPHysics: Part_0000.bi4. A file begins with 64 bytes. Bytes 0 to 59: title. Byte 60: byte order, 0 little or 1 big, plus 10 if sizes
# have 64 bits. Byte 61: 1 if sizes have 64 bits. One item follows. An item consists, in this order, of:
#   the size of its definition; the text "\nITEM\n"; its name; two flags (it is hidden, its values are hidden); two texts of formats;
#   the number of its arrays; the number of its items; the size of its values in bytes;
#   unless this size is 0: the text "\nVALUES", the number of its values, and the name, type and value of each value;
#   its arrays; its items.
# An array consists of: the size of its definition; the text "\nARRAY"; its name; a flag (it is hidden); its type; the number of its
# values; their size in bytes; the values. A text consists of its length and its letters. Arrays stay in the file until they are used.
PLAIN = {2: "i4", 3: "i1", 4: "u1", 5: "i2", 6: "u2", 7: "i4", 8: "u4", 9: "i8", 10: "u8", 11: "f4", 12: "f8",
         20: "i4", 21: "u4", 22: "f4", 23: "f8"}
TEXT, DEPTH = 1, 8


class Reader:
    """Reads a .bi4 file. A length is used only if the rest of the file is at least as long."""

    def __init__(self, file, path):
        self.file, self.path, self.name, self.state = file, path, path.name, state_of(file)
        self.size = self.state[1]
        head = file.read(64)
        order = head[60] if len(head) == 64 else 9
        if order % 10 > 1:
            raise FileError(f"{self.name} has a damaged head.")
        self.order, self.wide = "<>"[order % 10], head[61] == 1

    def check(self, size):
        if size > self.size - self.file.tell():
            raise FileError(say("FILE_ENDS", self.name, self.file.tell()))

    def take(self, size):
        self.check(size)
        return self.file.read(size)

    def number(self, kind="u4", count=1):
        kind = np.dtype(self.order + kind)
        values = np.frombuffer(self.take(kind.itemsize * count), kind, count)
        return values[0].item() if count == 1 else values.tolist()

    def text(self):
        return self.take(self.number()).decode(errors="replace")

    def expect(self, code):
        if self.text() != code:
            raise FileError(f"{self.name} is damaged before byte {self.file.tell()}.")

    def value(self):
        name, kind = self.text(), self.number()
        if kind == TEXT:
            return name, self.text()
        if kind not in PLAIN:
            raise FileError(f"{self.name} has a value of the unknown type {kind}.")
        return name, self.number(PLAIN[kind], 3 if kind >= 20 else 1)

    def array(self):
        self.number()
        self.expect("\nARRAY")
        name, _, kind = self.text(), self.number(), self.number()
        count, size = self.number("u8" if self.wide else "u4"), self.number("u8" if self.wide else "u4")
        self.check(size)
        begin = self.file.tell()
        self.file.seek(size, os.SEEK_CUR)
        if kind not in PLAIN:
            return name, None
        dtype, columns = np.dtype(self.order + PLAIN[kind]), 3 if kind >= 20 else 1
        if count * columns * dtype.itemsize != size:
            raise FileError(f"{self.name}: the array '{name}' has {size} bytes for {count} values.")
        return name, RawArray(self.path, self.state, begin, dtype, count, columns)

    def item(self, depth=0):
        """Reads an item. Returns its (values, arrays, [items])."""
        if depth > DEPTH:
            raise FileError(f"{self.name} is damaged: too deep a nest of items.")
        self.number()
        self.expect("\nITEM\n")
        self.text(), self.number(), self.number(), self.text(), self.text()
        arrays, items, size = self.number(), self.number(), self.number()
        values = {}
        if size:
            self.expect("\nVALUES")
            values = dict(self.value() for _ in range(self.number()))
        found = by_name(self.name, (self.array() for _ in range(arrays)))
        return values, found, [self.item(depth + 1) for _ in range(items)]


def read_bi4(path):
    with open(path, "rb") as file:
        values, arrays, items = Reader(file, path).item()
    for more, found, _ in items:
        values, arrays = {**values, **more}, {**arrays, **{k: v for k, v in found.items() if v is not None}}
    positions = arrays.pop("Posd", arrays.pop("Pos", None))
    ids = arrays.get("Idpd", arrays.get("Idp"))
    if positions is None or not positions.count:
        raise FileError(f"{path.name} has no positions (Pos, Posd): it is no file of particles.")
    arrays = {name: array for name, array in arrays.items() if array is not None and array.count == positions.count}
    read, solid = {name: array.load for name, array in arrays.items()}, None
    if ids is not None and "CaseNfixed" in values and ids.count == positions.count:
        ends = np.cumsum([values.get(f"CaseN{kind}", 0) for kind in ("fixed", "moving", "float")])
        types = np.searchsorted(ends, ids.load(), side="right").astype(np.uint8)
        read["Type"], solid = lambda: types, types != 3
    density = next((name for name in ("Rhop", "Rho") if name in arrays), None)
    h = values.get("H", 0)
    return Particles(
        path.name, "DualSPHysics", positions.load, read,
        smoothing_length=h if h > 0 else None, mass=values.get("MassFluid") or None, density=density,
        rho0=values.get("Rhop0", values.get("RhopZero")), solid=solid if solid is not None and solid.any() else None,
        kernel="Wendland C2", dimension=2 if values.get("Data2d") else 3, period=bi4_period(values),
        time=values.get("TimeStep"), parameters=values)


def bi4_period(values):
    """Returns the six bounds of the period, or None. PeriActive, else PeriMode, tells the axes: 1 x, 2 y, 3 xy, 4 z, 5 xz, 6 yz. Shifted
    periods (PeriXinc along another axis) do not count."""
    axes = {1: "x", 2: "y", 3: "xy", 4: "z", 5: "xz", 6: "yz"}.get(values.get("PeriActive", values.get("PeriMode", 0)), "")
    low, high = values.get("MapPosMin"), values.get("MapPosMax")
    if not axes or not low or not high:
        return None
    for axis in axes:
        step = values.get(f"Peri{axis.upper()}inc", [0, 0, 0])
        if any(step[other] for other in range(3) if other != "xyz".index(axis)):
            return None
    return [bound for i in range(3) for bound in ((low[i], high[i]) if "xyz"[i] in axes else (0.0, 0.0))]


# Houdini: .bgeo of version 5, plain or gzipped, big endian. A file consists, in this order, of: the text "BgeoV"; the version; the numbers
# of points, primitives, groups of points, groups of primitives, and attributes of points, of vertices, of primitives and of the whole; the
# name, size, type and defaults of each attribute of points; x, y, z, w and the attributes of each point. The rest is not read.
BGEO_TYPES = {0: ">f4", 1: ">i4", 5: ">f4"}  # float, int, vector


def read_bgeo(path):
    data = read_bytes(path)
    try:
        if data[:5] != b"BgeoV":
            raise FileError(f"{path.name} is no .bgeo of Houdini's version 5.")
        version, points, _, _, _, attributes = struct.unpack_from(">6i", data, 5)
        if version != 5:
            raise FileError(f"{path.name} is a .bgeo of version {version}; 5 is read.")
        at, fields = 41, [("position", ">f4", 4)]
        for i in range(attributes):
            length, = struct.unpack_from(">H", data, at)
            name = data[at + 2:at + 2 + length].decode(errors="replace")
            at += 2 + length
            size, kind = struct.unpack_from(">Hi", data, at)
            at += 6 + 4 * size
            if kind not in BGEO_TYPES or not 0 < size <= 64:
                raise FileError(f"{path.name}: the attribute '{name}' has the type {kind}, which is not read.")
            fields.append((name, BGEO_TYPES[kind], size))
    except struct.error:
        raise FileError(f"{path.name} ends too early.") from None
    kind = np.dtype([(str(i), form, (size,)) for i, (_, form, size) in enumerate(fields)])
    if points <= 0 or at + points * kind.itemsize > len(data):
        raise FileError(f"{path.name} claims {points} points, for which it is too short." if points > 0 else
                        f"{path.name} has no points.")
    table = np.frombuffer(data, kind, points, at)

    def column(i, size):
        return lambda: np.ascontiguousarray(table[str(i)][:, 0] if size == 1 else table[str(i)]).astype(
            fields[i][1].replace(">", "="))

    arrays = by_name(path.name, ((name, column(i, size)) for i, (name, _, size) in enumerate(fields) if i))
    return Particles(path.name, "bgeo", lambda: np.ascontiguousarray(table["0"][:, :3]).astype("=f4"), arrays,
                     density="density" if "density" in arrays else None, up="y")


# Phantom: native dumps, which the package sarracen reads. Accreted particles (h <= 0) are left out; gas that is inactive in a step
# (itype -1) counts as gas.
def make_phantom(path, is_alive, array, positions, names, values):
    if not is_alive:
        raise FileError(f"{path.name} has no gas that is alive.")
    factor, mass = float(values.get("hfact", [1.2])[0]), float(values["massoftype"][0])

    def density():
        with np.errstate(over="ignore", divide="ignore"):  # In damaged files these are infinite.
            ratio = factor / array("h").astype(float)
            return mass * (ratio * ratio * ratio)

    arrays = {name: lambda n=name: array(n) for name in names if name != "itype"}  # The particles that are left are gas.
    arrays.setdefault("density", density)
    return Particles(path.name, "Phantom", positions, arrays, smoothing_length="h", mass=mass,
                     density="density", time=float(values["time"][0]) if "time" in values else None,
                     parameters={name: value.tolist() for name, value in values.items()})


def read_phantom_dump(path):
    try:
        import sarracen
    except ImportError:  # The package scikit-learn, which sarracen does not require, is imported by another name.
        raise FileError(f"{path.name} is a dump of Phantom's own format, which the packages sarracen and scikit-learn read: "
                        "pip install sarracen scikit-learn.") from None

    frames = sarracen.read_phantom(str(path), separate_types=None)
    frame = frames[frames["itype"].abs() == 1] if "itype" in frames else frames
    frame = frame[(frame["h"] > 0)].dropna(subset=["x", "y", "z"])
    values = {name: np.ravel(value) for name, value in frames.params.items() if np.isscalar(value) or np.size(value) == 1}
    names = [name for name in frame if name not in ("x", "y", "z", "mass") and frame[name].dtype.kind in "fiub"]
    return make_phantom(path, len(frame) > 0, lambda name: frame[name].to_numpy(),
                lambda: np.ascontiguousarray(frame[["x", "y", "z"]].to_numpy(float)), names,
                {name: value for name, value in values.items() if value.dtype.kind in "fiub"})
