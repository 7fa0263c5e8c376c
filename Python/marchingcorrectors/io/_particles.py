# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles of a file, whose arrays are read when they are first used; and what all readers share."""
from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any, Callable, Dict, Iterator, NamedTuple, Optional, Sequence, Union

import numpy as np

from .. import _structs as c
from .._arrays import QUANTITIES, SUMMED, Found, list_named
from .._library import Error, InvalidArgument, lib, say, warn
from .._options import BOUNDS, did_you_mean

# A solver's name of its kernel, reduced to letters and digits, begins with one of these keys. If several keys fit, the first counts. PySPH calls
# Wendland C2 WendlandQuintic.
KERNELS = {"cubic": "cubic", "quartic": "quartic", "quintic": "quintic", "sinc6": "sinc6", "wendlandc2": "wendland",
           "wendlandc4": "wendland_c4", "wendlandc6": "wendland_c6", "wendlandquinticc4": "wendland_c4",
           "wendlandquinticc6": "wendland_c6", "wendlandquinticc": None, "wendlandquintic": "wendland"}

NAMES_ARRAYS = ("scalar", "scalar_dot", "velocity", "weighted_by", "solid", *QUANTITIES)  # These arguments may name an array.
GHOSTS = "vtkGhostType"
NO_VALUE = np.empty(0, np.float32)
TIMES = ("TimeValue", "TIME", "Time", "time")  # In VTK's files these are arrays of field data.


class FileError(Error, ValueError):
    """A file is damaged, empty, or in no format that is known here."""

    def __init__(self, sentence):
        """Makes the sentence one short line of printable letters, because it may contain names from a damaged file."""
        plain = "".join(letter if letter.isprintable() else "?" for letter in str(sentence))
        plain = plain if len(plain) <= 350 else plain[:170] + " ... " + plain[-170:]
        super().__init__(sentence if plain == sentence else plain)  # a sentence of the core keeps its code


class NoPoints(FileError):
    """A file holds no points. As a step of a film, it is a step without fluid."""


def find_kernel(name):
    """Returns the word of sph_kernel for the name that a file gives to its kernel, or None if the name is not known."""
    plain = "".join(letter for letter in str(name).lower() if letter.isalnum())
    return next((word for start, word in KERNELS.items() if plain.startswith(start)), None)


class Lazy(Mapping):
    """A mapping {name: array}. An array is read when it is first used, and then kept. read: {name: function}."""

    def __init__(self, read, file):
        self._read, self._kept, self._file = dict(read), {}, file

    def __getitem__(self, name):
        if name not in self._kept:
            if name not in self._read:
                raise KeyError(name)
            try:
                array = self._read[name]()
                kind = {np.dtype(np.float16): np.float32, np.dtype(np.longdouble): np.float64}.get(array.dtype, array.dtype)
                self._kept[name] = array.astype(kind, copy=False)  # This type is one that all functions take.
            except FileError:
                raise
            except MemoryError:
                raise FileError(f"{self._file}: there is not enough memory for the array '{name}'.") from None
            except Exception as error:
                raise FileError(f"{self._file}: the array '{name}' cannot be read: "
                                f"{' '.join(str(error).split())[:200]}") from None
        return self._kept[name]

    def __iter__(self):
        return iter(self._read)

    def __len__(self):
        return len(self._read)

    def __contains__(self, name):
        return name in self._read

    def __repr__(self):
        return f"<arrays: {', '.join(self) or 'none'}>"

    def __getstate__(self):
        """Lets pickle and copy take the arrays themselves, not the open file."""
        return {"_read": dict.fromkeys(self), "_kept": dict(self), "_file": self._file}


class Particles:
    """Positions, arrays, and what the functions of this package want to know.

    smoothing_length, volume, mass, density: the name of an array, one value, or None. support_radius: whether
    the smoothing length is the radius at which the kernel ends. h_factor: the factor by which quantity() multiplies
    the smoothing length. solid: None, or for each particle whether it is a wall. cell: nine numbers, the
    sides of a tilted cell, which cannot be used as a period. times: all times of a file that holds several.
    up: the axis that points up, if the layout tells it, else "z". parameters: all else that the file says
    (time, units, box_size, scale_factor, ...), as it stands in the file; no value is applied.
    """

    smoothing_length: Union[None, str, float] = None
    mass: Union[None, str, float] = None
    volume: Union[None, str, float] = None
    density: Union[None, str, float] = None
    kernel: Optional[str] = None
    rho0: Optional[float] = None
    support_radius, h_factor, dimension, up = False, 1.0, 3, "z"
    solid: Optional[np.ndarray] = None
    period: Optional[Sequence[float]] = None
    cell: Optional[Sequence[float]] = None
    time: Optional[float] = None
    times: Optional[Sequence[float]] = None

    def __init__(self, file: Any, layout: str, positions: Callable[[], Any], arrays: Mapping[str, Callable[[], Any]],
                 **more: Any) -> None:
        self.file, self.layout = str(file), layout
        self._positions = Lazy({"": positions}, file)
        self.arrays: Mapping[str, np.ndarray] = Lazy(arrays, file)
        self.parameters: Dict[str, Any] = {}
        vars(self).update(more)

    @property
    def positions(self) -> np.ndarray:
        positions = self._positions[""]
        if positions.ndim != 2 or positions.shape[1] != 3 or positions.dtype.kind not in "fiu":
            raise FileError(f"{self.file}: positions have the shape {positions.shape} and the type {positions.dtype}.")
        return positions

    def __len__(self) -> int:
        return len(self.positions)

    def __iter__(self) -> Iterator[str]:
        """Returns the names of the arrays."""
        return iter(self.arrays)

    def __contains__(self, name: object) -> bool:
        return name in self.arrays

    def __getitem__(self, name: str) -> np.ndarray:
        return self.array(name)

    def __repr__(self) -> str:
        return f"<Particles of {self.file} ({self.layout}): arrays: {', '.join(self.arrays) or 'none'}>"

    def array(self, name: str) -> np.ndarray:
        if name not in self.arrays:
            raise FileError(f"{self.file} has no array '{name}'.{did_you_mean(name, self.arrays)} Arrays: "
                            f"{', '.join(self.arrays) or 'none'}.")
        return self.arrays[name]

    def quantity(self, name):
        value = getattr(self, name)
        value = self.array(value) if isinstance(value, str) else value
        if np.ndim(value) and np.shape(value) != (len(self),):
            raise FileError(f"{self.file}: the array '{getattr(self, name)}' has the shape {np.shape(value)}, where {name} "
                            f"is one number for each of {len(self)} particles.")
        if name == "smoothing_length" and value is not None and self.h_factor != 1:
            value = value * self.h_factor
        return value

    def words(self, given):
        """Returns keywords of the functions for NumPy arrays, with arrays in place of names; given arguments take precedence. The core chooses among
        volume, mass and density. Adds `source`: these particles, whose arrays `fluid` and `only` may name."""
        words = {**given, "source": self, "positions": self.positions}
        for name in NAMES_ARRAYS:
            text = words.get(name)
            if isinstance(text, str) and (name, text) != ("volume", "computed") and not (
                    (name, text) == ("scalar", SUMMED) and SUMMED not in self):
                words[name] = self.array(text)
        if not words.get("estimate_smoothing_length") and words.get("smoothing_length") is None:
            words["smoothing_length"] = self.quantity("smoothing_length")
            if words["smoothing_length"] is not None:
                words.setdefault("smoothing_length_is_support_radius", self.support_radius)
            elif len(self):
                names = {name: NO_VALUE for name in self.arrays}
                raise InvalidArgument(Found(np.empty((len(self), 3))).find(names, ["sizes"]).error)
        if words.get("solid") is None and words.get("fluid") is None and self.solid is not None:
            words["solid"] = self.solid
        if isinstance(words.get("periodic"), str):
            if words["periodic"] != "auto":
                raise InvalidArgument(f"periodic is '{words['periodic']}'; it must be \"auto\", {BOUNDS}, or three lengths.")
            if self.cell is not None:
                raise InvalidArgument(f"{say('CELL_TILTED')} Leave periodic out.")
            if self.period is None:
                raise InvalidArgument(say("NO_PERIOD"))
            words["periodic"] = self.period
        if self.period is not None:
            words.setdefault("periodic", self.period)
        if self.cell is not None and words.get("periodic") is None:
            warn(f"{self.file}: {say('CELL_TILTED')}")
        if self.kernel and "sph_kernel" not in words:
            known = find_kernel(self.kernel)
            if known:
                words["sph_kernel"] = known
            else:
                warn(f"The kernel of {self.file} is '{self.kernel}', which is not among those here: the cubic spline "
                     "is taken. Give sph_kernel.")
        names = words.get("attributes")
        names = [names] if isinstance(names, str) else names
        if isinstance(names, (list, tuple)):
            words["attributes"] = {name: self.array(name) for name in names}
        return words


def usual(names, quantity):
    """Returns the one of `names` that is most usual for a quantity; None if none is usual."""
    named, count = list_named([(name, NO_VALUE) for name in names])
    best = lib.mcor_find_named(named, count, c.ENUMS["mcor_quantity"]["MCOR_" + quantity.upper()], 1, 0)
    return None if best < 0 else names[best]


def usual_quantities(names):
    return {quantity: usual(names, quantity) for quantity in QUANTITIES}


def add_velocity(read, names):
    """Adds the vector "Velocity" to `read`, {name: function}, if vx, vy and vz are among the names."""
    if {"vx", "vy", "vz"} <= set(names) and "Velocity" not in read:
        read["Velocity"] = lambda: np.stack([read[name]() for name in ("vx", "vy", "vz")], axis=1)


def by_name(file, pairs):
    """Returns {name: thing}. If several things have the same name, warns, and takes the last one, as VTK does."""
    found, twice = {}, None
    for name, thing in pairs:
        twice = twice or (name if name in found else None)
        found[name] = thing
    if twice is not None:
        warn(f"{file} has several arrays '{twice}'; the last one is taken.")
    return found


class Body(NamedTuple):
    """The points of a file at one of its times. times: the times of all steps; None if the file has no steps. is_mesh: whether the points
    belong to a mesh, that is, there are cells, but no vertices; None if there are no cells."""
    points: np.ndarray
    arrays: Dict[str, np.ndarray]
    time: Optional[float] = None
    period: Optional[Sequence[float]] = None
    times: Optional[Sequence[float]] = None
    is_mesh: Optional[bool] = None


def shared_arrays(bodies):
    """Lists the arrays that all bodies have, with as many components. Warns of all others."""
    first = bodies[0].arrays
    shared = [name for name in first if name != GHOSTS and all(
        name in body.arrays and body.arrays[name].shape[1:] == first[name].shape[1:] for body in bodies)]
    lost = sorted({name for body in bodies for name in body.arrays} - {GHOSTS, *shared})
    if lost:
        warn(say("ARRAYS_NOT_SHARED", ", ".join(lost)))
    return shared


def join_bodies(bodies):
    """Joins several bodies to one, with the arrays that all non-empty bodies have. Leaves out points that belong to another body (vtkGhostType),
    and points of meshes if other bodies have vertices."""
    meshes = [body for body in bodies if body.is_mesh] if any(body.is_mesh is False for body in bodies) else []
    if meshes:
        warn(f"{sum(len(body.points) for body in meshes)} points of pieces without vertices are nodes of meshes and no "
             "particles, as other pieces have vertices.")
        bodies = [body for body in bodies if not body.is_mesh]
    parts = [body for body in bodies if len(body.points)] or list(bodies[:1])
    if len(parts) > 1 or GHOSTS in parts[0].arrays:
        own = [np.flatnonzero(np.asarray(body.arrays.get(GHOSTS, np.zeros(len(body.points), int))).astype(int) & 1 == 0)
               for body in parts]
        arrays = {name: np.concatenate([body.arrays[name][mine] for body, mine in zip(parts, own)]) for name in shared_arrays(parts)}
        return parts[0]._replace(points=np.concatenate([body.points[mine] for body, mine in zip(parts, own)]), arrays=arrays)
    return parts[0]


def ending_of(path):
    """Returns the ending in small letters, without .gz: .csv for a.csv.gz."""
    return (path.with_suffix("") if path.suffix.lower() == ".gz" else path).suffix.lower()


def inflate(path, data, least=None):
    """Unpacks gzipped data: all bytes or, if `least` is given, at most the first `least` bytes. Returns data that are not gzipped unchanged."""
    if not data.startswith(b"\x1f\x8b"):
        return data
    found, left = [], 1000 * len(data) + 1024  # Deflate cannot pack more densely.
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


def choose_step(file, step, times):
    """Returns the number of a step, from 0 on; -1 means the last step, as in lists."""
    if not -len(times) <= step < len(times):
        raise FileError(f"{file} has no step {step}: it has {len(times)} of them.")
    return step % len(times)


def period_of_field(field):
    """Returns the numbers of the array PeriodicBounds, which convert writes: six bounds, or nine for a tilted cell. Returns
    None without a period."""
    bounds = np.ravel(field.get("PeriodicBounds", ()))
    return bounds.tolist() if len(bounds) in (6, 9) and np.isfinite(bounds).all() and bounds.any() else None


def check_claim(file, thing, claimed, there):
    """Refuses a declared size that the file cannot hold even if it is packed 1000 to 1, because a damaged file may declare any size."""
    if claimed > 2 ** 24 + 1000 * there:
        raise FileError(f"{file}: {thing} claims {claimed} bytes, the file has {there}. It is damaged.")


def join(parts):
    parts = [np.asarray(part) for part in parts]
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
