# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Passes NumPy arrays to the core, lets the core find the quantities among the arrays (mcor_find.h), and copies the core's results to
NumPy arrays."""
import contextlib
import ctypes
import os
from collections.abc import Mapping

import numpy as np

from . import _structs as c
from ._device_arrays import on_host
from ._library import ERRORS, Error, InvalidArgument, lib, take_sentence
from ._options import BOUNDS, ISOSURFACE, did_you_mean, kind_of, words_of
from ._units import plain, unit_of

ROLES = {name[len("MCOR_ROLE_"):].lower(): number for name, number in c.ENUMS["mcor_role"].items()
         if not name.endswith("_COUNT")}
WANTS = {name[len("MCOR_WANT_"):].lower(): number for name, number in c.ENUMS["mcor_want"].items()}
ELEMENTS = {np.dtype(word): number for number, word in enumerate(("f4", "f8", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"))}
OTHER = c.ENUMS["mcor_element"]["MCOR_ELEMENT_OTHER"]
FLOATS = {np.dtype(np.float32): c.ENUMS["mcor_type"]["MCOR_FLOAT32"],
          np.dtype(np.float64): c.ENUMS["mcor_type"]["MCOR_FLOAT64"]}
ABSENT = 2  # MCOR_ABSENT
QUANTITIES = ("smoothing_length", "volume", "mass", "density")
WORDS = {int: "whole number", float: "number"}
# Further words that these options take: NumPy's names of types, and mcor.h's names of kernels, such as "cubic_spline" for "cubic".
OTHER_WORDS = {"precision": {"float32": "single", "float64": "double"},
               "sph_kernel": dict(zip((name[len("MCOR_"):].lower() for name in c.ENUMS["mcor_sph_kernel"]),
                                      words_of("sph_kernel")))}


def as_array(values, role):
    """Returns np.asarray(values), or a copy of an array on a CUDA device. Raises InvalidArgument if this fails, or would lose
    a mask or a unit."""
    if np.ma.is_masked(values):
        raise InvalidArgument(f"The {role} has masked elements. Remove such particles, or fill them.")
    parts = values if isinstance(values, (list, tuple)) else [values]
    unit = next((unit_of(part) for part in parts if unit_of(part) is not None), None)
    if unit is not None:
        raise InvalidArgument(f"The {role} has the unit {unit}; it must be plain numbers here.")
    try:
        values = on_host(values, role)
        if hasattr(values, "__dlpack__") and not hasattr(values, "__array__"):
            return np.from_dlpack(values)
        array = np.asarray(values)
    except Error:
        raise
    except (TypeError, ValueError, RuntimeError, BufferError) as error:
        raise InvalidArgument(
            f"The {role} is not an array in this computer's memory that NumPy can take: {error}") from None
    if array.dtype == object and array.ndim == 0:
        raise InvalidArgument(f"The {role} is {'None' if values is None else 'a ' + type(values).__name__}; it must be an array or "
                              "a list.")
    return array


def contiguous(values, role):
    """Returns numbers as a contiguous, aligned array of floats or doubles. Copies them only if they are not such an array yet."""
    array = as_array(values, role)
    if array.dtype == object:  # A data frame with columns of several types gives such objects.
        with contextlib.suppress(TypeError, ValueError):
            array = array.astype(np.float64)
    if array.dtype.kind not in "fiub":
        raise InvalidArgument(f"The {role} does not hold numbers, but {array.dtype}.")
    if array.dtype not in FLOATS:
        array = array.astype(np.float64)
    array = np.ascontiguousarray(array)
    return array if array.flags.aligned else array.copy()


def as_points(values, role, shape):
    """Returns an array of shape (count, 3). An empty array may have any shape."""
    if isinstance(values, (str, os.PathLike)):
        raise InvalidArgument(f"The array of {role} is '{values}'. To read a file, give marchingcorrectors.io.read('{values}').")
    if hasattr(values, "columns") and len(values.columns) != 3:
        raise InvalidArgument(f"The array of {role} is a table of {len(values.columns)} columns. Give three of them, as "
                              "table[['x', 'y', 'z']].")
    array = contiguous(values, f"array of {role}")
    if array.ndim != 2 or array.shape[1] != 3:
        if len(array):
            remedy = " Give its transpose." if len(array) == 3 else " In two dimensions the third coordinate is a constant." \
                if array.shape[1:] == (2,) else ""
            raise InvalidArgument(f"{role.capitalize()} have the shape {shape}, not {array.shape}.{remedy}")
        array = array.reshape(0, 3)
    return array


def as_named(attributes):
    """Returns {name: array} of a mapping, or of a data frame's columns. Names become texts, and units are dropped. An array
    of objects, which data frames may have, becomes an array of texts or numbers."""
    if attributes is None:
        return {}
    if not isinstance(attributes, Mapping) and hasattr(attributes, "columns"):
        attributes = {name: attributes[name] for name in attributes.columns}
    if not isinstance(attributes, Mapping):
        raise InvalidArgument(f"attributes are {{name: array}} or a data frame, not a {type(attributes).__name__}.")
    arrays = {str(name): as_array(array if unit_of(array) is None else plain(array), f"attribute '{name}'")
              for name, array in attributes.items()}
    for name, array in arrays.items():
        if array.dtype == object:
            is_text = all(isinstance(each, str) for each in array.flat)
            try:
                arrays[name] = array.astype(str if is_text else float)
            except (TypeError, ValueError):
                arrays[name] = array.astype(str)
    return arrays


SUMMED = "Density"  # If there is no array of this name, its values are summed from the masses.


def as_bytes(text):
    """Encodes text for the core's messages; characters that UTF-8 cannot hold (in names of files, say) become "?"."""
    return text.encode(errors="replace")


def copy_at(address, kind, shape):
    """Returns a copy, which NumPy owns, of the numbers at this address."""
    size = int(np.prod(shape)) * kind.itemsize
    return np.frombuffer((ctypes.c_char * size).from_address(address), kind).reshape(shape).copy() if size else np.empty(shape, kind)


def list_named(arrays):
    """Returns the core's list of these arrays, and its length. arrays: {name: array}, or pairs. Of texts, the core gets only the shape."""
    pairs = list(arrays.items() if hasattr(arrays, "items") else arrays)
    named = (c.mcor_named * max(len(pairs), 1))()
    for each, (name, array) in zip(named, pairs):
        kind = np.dtype(np.uint8) if getattr(array, "dtype", None) == bool else getattr(array, "dtype", None)
        each.name, each.type = None if name is None else as_bytes(name), ELEMENTS.get(kind, OTHER)
        each.tuples, each.components = array.shape[0], int(np.prod(array.shape[1:], dtype=int))
        if each.type != OTHER and array.size:
            each.data = array.ctypes.data
            each.stride[0] = array.strides[0] if len(array) > 1 else 0
            each.stride[1] = array.strides[1] if array.ndim > 1 and array.shape[1] > 1 else 0
    return named, len(pairs)


def name_priority(name, quantity):
    """Returns 0 for the most usual name of a quantity, more for less usual ones, -1 for any other name."""
    return lib.mcor_name_priority(c.ENUMS["mcor_quantity"]["MCOR_" + quantity.upper()], as_bytes(name))


def tells_of_walls(name):
    """Returns whether a block or body of this name holds walls."""
    return bool(lib.mcor_tells_of_walls(as_bytes(name)))


class Found:
    """Holds an mcor_found, as `found`, and the arrays that it borrows."""

    def __init__(self, positions):
        self.positions, self.count, self.found = positions, len(positions), c.mcor_found()

    def find(self, arrays, wants, names=None, values=None, only=(), taken=(), excluded=(), **words):
        """Lets the core find, among the arrays, what a call needs. Returns self. arrays: {name: array}, or pairs. wants: what is needed, by
        names of mcor_want. names: {role: name of the array to use}. values: {role: one number for all particles}. only: a list of (array's
        name, low, high); other particles are left out. taken: names of arrays that the call computes. excluded: names of other arrays that
        must not become attributes. words: further members of mcor_request. `error` says what is missing. Raises MemoryError."""
        pairs = list(arrays.items() if hasattr(arrays, "items") else arrays)
        request = c.mcor_request(wants=sum(WANTS[name] for name in wants), active=-1)
        for role, name in (names or {}).items():
            request.names[ROLES[role]] = as_bytes(name or "")
        for role, value in (values or {}).items():
            request.values[ROLES[role]] = value
        for name, value in words.items():
            if isinstance(getattr(request, name), ctypes.Array):
                getattr(request, name)[:] = value
            else:
                setattr(request, name, value)
        ranges = (c.mcor_only * max(len(only), 1))(*((as_bytes(name), low, high) for name, low, high in only))
        request.only, request.only_count = ranges, len(only)
        request.taken, request.excluded = as_bytes("\n".join(taken)), as_bytes("\n".join(excluded))
        self._borrowed, (named, count) = (pairs, ranges), list_named(pairs)
        status = lib.mcor_find_input(ctypes.byref(request), list_named([(None, self.positions)])[0], named, count, None,
                                     ctypes.byref(self.found))
        self.error, self.unused_type, self.unused = (
            take_sentence(getattr(self.found, name)) for name in ("error", "unused_type", "unused"))
        if status and not self.error:
            raise MemoryError
        return self

    def __del__(self):
        if hasattr(self, "found"):
            lib.mcor_free_found(ctypes.byref(self.found))

    def text(self, member):
        return (getattr(self.found, member) or b"").decode(errors="replace")

    def name(self, role):
        """Returns the name of the role's array, even if the array is not used; "" if there is none."""
        return (self.found.views[ROLES[role]].name or b"").decode(errors="replace")

    def made(self, i):
        """Returns the name, and a copy, of the i-th array that the core has made."""
        made = self.found.made[i]
        kind = next(dtype for dtype, number in ELEMENTS.items() if number == made.type)
        return made.name.decode(), copy_at(made.data, kind, (made.tuples, made.components)[:1 + (made.components > 1)])


class Arguments(Found):
    """Fills the core's structures for one call, and keeps alive the arrays that the core borrows."""

    def __init__(self, positions, options=None):
        super().__init__(as_points(positions, "positions", "(particles, 3)"))
        self.kept, self.kinds, self.widening, self.input, self.options = [], {}, None, self.found.input, options
        if options is None:
            self.options = c.mcor_options()
            lib.mcor_set_default_options(ctypes.byref(self.options))

    def view(self, array, name):
        self.kept.append(array if array.size else np.empty(array.shape, array.dtype))  # NULL would mean a constant.
        return c.mcor_array(type=FLOATS[array.dtype], components=1 if array.ndim < 2 else array.shape[1],
                            data=self.kept[-1].ctypes.data, name=as_bytes(name) if name else None)

    def per_particle(self, values, role, name=None):
        """Returns a view of an array of the shape (particles,) or (particles, components)."""
        return self.view(self.shaped(values, role), name or role)

    def shaped(self, values, role):
        array = contiguous(values, role)
        if array.ndim not in (1, 2) or len(array) != self.count or 0 in array.shape[1:]:
            raise InvalidArgument(f"The {role} has the shape {array.shape}; for {self.count} particles it is "
                                  f"({self.count},) or ({self.count}, components).")
        return array

    def marks(self, solid, keyword="solid"):
        """Returns `solid`, one number for each particle, as an array. keyword: the name of `solid` in the error."""
        marks = as_array(solid, f"array of {keyword}")
        if marks.dtype.kind not in "fiub" or marks.shape != (self.count,):
            raise InvalidArgument(f"The array of {keyword}, of {marks.dtype}, has the shape {marks.shape}; it must have one number for "
                                  f"each of {self.count} particles.")
        return marks if marks.dtype in ELEMENTS or marks.dtype == bool else marks.astype(float)

    def set_attributes(self, attributes):
        """Sets the attributes, {name: array}. The core's results have the same order."""
        views = [self.per_particle(values, f"attribute '{name}'", str(name))
                 for name, values in attributes.items()]
        self.set_views(views)
        self.kinds = {name: (() if np.ndim(values) == 1 else (view.components,), view.type)
                      for view, (name, values) in zip(views, attributes.items())}

    def set_views(self, views):
        self.kept.append((c.mcor_array * max(len(views), 1))(*views))
        self.input.attributes, self.input.attribute_count = self.kept[-1], len(views)

    def set_widening(self, factors, volumes, of_surface):
        """Sets the factors of the smoothing lengths, and the volumes unless they are None. of_surface: the factors also become the
        last attribute, which has no entry in `kinds`."""
        self.input.widening = self.view(factors, "Widening")
        if volumes is not None:
            self.input.volume = self.view(volumes, None)
        if of_surface:
            self.set_views([*self.input.attributes[:len(self.kinds)], self.input.widening])

    def set_iso_values(self, values):
        values = contiguous(values, "list of iso values").astype(np.float64)
        if values.ndim != 1:
            raise InvalidArgument(f"Iso values are one number or a list of them, not of the shape {values.shape}.")
        for value in values[~np.isfinite(values)]:
            raise InvalidArgument(f"The iso value is {value}; it must be a finite number.")
        self.kept.append(values)
        self.options.iso_values = values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        self.options.iso_count = len(values)

    def set_options(self, words):
        """Sets options by their names in mcor.h, which were checked before."""
        for name in ISOSURFACE:
            if name in words:
                target = self.options if hasattr(self.options, name) else self.input
                value = self.bounds_of_period(words[name]) if name == "periodic" else words[name]
                set_option(target, name, kind_of(name), value)
        if self.options.capping and any(self.options.box):
            self.options.capping = 2  # MCOR_CAP_BOX
        lib.mcor_spell_out(ctypes.byref(self.options))

    def sum_over_neighbours(self, ratio):
        """Computes the smoothing lengths and the densities if the core lacks them. ratio: the `eta` of mcor_find_smoothing_lengths()."""
        for name, is_needed, function, more, take_it in (
                ("SmoothingLength", self.found.needs_lengths, lib.mcor_find_smoothing_lengths, [ratio], lib.mcor_take_lengths),
                ("Density", self.found.needs_densities, lib.mcor_sum_densities, [], lib.mcor_take_densities)):
            if is_needed and self.input.count:
                self.kept.append(self.sums(name, function, *more))
                take_it(ctypes.byref(self.found), self.kept[-1].ctypes.data_as(ctypes.POINTER(ctypes.c_double)))

    def sums(self, name, function, *more):
        """Returns the array (particles,) that a function of the core sums over neighbours. The function gets the masses that were
        found, even if the input does not use them."""
        given, values, why = c.mcor_input.from_buffer_copy(self.input), np.empty(self.count), c.mcor_message()
        given.mass = self.found.views[ROLES["mass"]]
        status = function(ctypes.byref(given), ctypes.byref(self.options), *more, self.count,
                          values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), ctypes.byref(why))
        sentence = take_sentence(why)
        if status:
            raise ERRORS.get(status, Error)(sentence)
        return values

    def bounds_of_period(self, period):
        """Returns the six bounds of a period; None if the period is None. The particles tell where a period of three lengths begins."""
        if isinstance(period, (bool, str)) or period is not None and np.size(period) not in (3, 6):
            raise InvalidArgument(f"periodic is {period!r}; it must be {BOUNDS}, or three lengths, 0 along axes that are not "
                                  "periodic.")
        if period is None or np.size(period) == 6:
            return period
        lengths = np.ravel(contiguous(period, "list of numbers of periodic")).astype(np.float64)
        extent = [0.0] * 6
        positions = self.positions
        if self.input.solid and self.count:
            positions = positions[np.ctypeslib.as_array(self.input.solid, (self.count,)) != ABSENT]
        if len(positions):
            extent = np.stack([positions.min(axis=0), positions.max(axis=0)], axis=1).ravel().tolist()
        return place_period(lengths, extent)


def place_period(lengths, extent):
    bounds = (ctypes.c_double * 6)()
    lib.mcor_place_period((ctypes.c_double * 3)(*lengths), (ctypes.c_double * 6)(*extent), bounds)
    return list(bounds)


def set_option(target, name, kind, value):
    """Sets an option of the core. An option that is an array, such as box, is set only if the value is not None."""
    if "[" not in kind:
        converted = number(name, kind, value)
        setattr(target, name, converted)
        if kind != "double" and getattr(target, name) != converted:  # ctypes would drop higher bits.
            raise InvalidArgument(f"{name} is {value}, which is out of its range.")
        return
    if value is not None:
        values = np.ravel(contiguous(value, f"list of numbers of {name}"))
        if len(values) != len(getattr(target, name)):
            raise InvalidArgument(f"{name} has {len(getattr(target, name))} numbers, not {len(values)}.")
        if name == "box" and not values.any():
            raise InvalidArgument("The box has no extent: all of its numbers are 0.")
        getattr(target, name)[:] = values.tolist()


def convert(to, name, value):
    if unit_of(value) is not None:
        raise InvalidArgument(f"The {name} has the unit {unit_of(value)}; it must be a plain number.")
    try:
        result = to(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidArgument(f"The {name} is {value!r}, which is not a {WORDS[to]}.") from None
    if to is int and result != value:
        raise InvalidArgument(f"The {name} is {value!r}, which is not a {WORDS[to]}.")
    return result


def number(name, kind, value):
    """Returns an option's value for the core. The user gives a word, the word's number, or any other number."""
    words = words_of(name)
    if isinstance(value, str) and (words or kind in c.ENUMS):
        word = value.lower().replace(" ", "_").replace("-", "_")
        word = OTHER_WORDS.get(name, {}).get(word, word)
        if word in words:
            return words[word]
        if kind in c.ENUMS:
            raise InvalidArgument(f"{name} is one of {', '.join(words)}, not '{value}'.{did_you_mean(word, words)}")
    if kind not in c.ENUMS:
        return convert(float if kind == "double" else int, name, value)
    if kind == "mcor_type" and not isinstance(value, (int, np.integer)):
        try:
            return FLOATS.get(np.dtype(value), -1)
        except TypeError:
            pass
    return convert(int, name, value)


def find_iso_value(given):
    """Returns the range of the scalar at fluid particles, and the default iso value; None if no value is finite. given: mcor_input"""
    ends, value = (ctypes.c_double * 2)(), ctypes.c_double()
    found = lib.mcor_find_iso_value(ctypes.byref(given), None, ends, ctypes.byref(value))
    return (tuple(ends), value.value) if found else None


def values_of(view, count):
    """Returns a copy of the numbers of an mcor_array, (count,). If it has no numbers, returns its constant; None if it has no constant."""
    if not view.data:
        return view.constant or None
    return copy_at(view.data, next(dtype for dtype, number in FLOATS.items() if number == view.type), (count,))


def take(pointer, shape):
    """Returns a copy of the core's array, or None if there is none."""
    return copy_at(ctypes.addressof(pointer.contents), np.dtype(pointer._type_), shape) if pointer else None


def take_rows(pointer, count):
    """Returns a copy of `count` structures of the core as a structured array."""
    return take(pointer, (count,)) if count else np.empty(0, pointer._type_)


def take_all(result):
    """Returns {name: array} of a result, without the arrays that have one entry for each attribute."""
    arrays = {}
    for name, (count, *columns) in c.SHAPES[type(result).__name__].items():
        if count != "attribute_count":
            size = result.line_count + 1 if count == "offset_count" else getattr(result, count)
            arrays[name] = take(getattr(result, name), (size, *columns))
    return arrays


def take_each(pointers, arguments, shape, more=()):
    """Returns {name: array} of the attributes that the core did not leave out. An array is float32 if the given attribute is.
    Its shape is `shape`, then the attribute's components, then `more`. pointers: the core's arrays; NULL in some empty results."""
    arrays = {}
    for i, (name, (components, kind)) in enumerate(arguments.kinds.items()):
        values = take(pointers[i], shape + components + more) if pointers else None
        if values is None and not all(shape):
            values = np.empty(shape + components + more)
        if values is not None:
            arrays[name] = values.astype(np.float32) if kind == FLOATS[np.dtype(np.float32)] else values
    return arrays


def left_out(result, arguments):
    """Returns {name: the first particle at which the attribute is not finite}."""
    return {name: int(result.attribute_not_finite[i]) for i, name in enumerate(arguments.kinds)
            if result.attribute_not_finite and result.attribute_not_finite[i] >= 0}


def statistics(struct):
    """Returns mcor_statistics as a dict, in which "seconds" is a dict by phase."""
    values = {}
    for name, kind in struct._fields_:
        value = getattr(struct, name)
        if name == "seconds":
            value = {lib.mcor_phase_name(i).decode(): seconds for i, seconds in enumerate(value)}
        elif isinstance(value, bytes):
            value = value.decode(errors="replace")
        elif isinstance(value, ctypes.Array):
            value = tuple(value)
        values[name] = value
    return values
