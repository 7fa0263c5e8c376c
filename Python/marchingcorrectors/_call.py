# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The parts that the functions share: keywords, particles of files in place of positions, and one call of the core."""
from __future__ import annotations

import contextlib
import ctypes
import functools
import inspect
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Tuple, Union, cast

import numpy as np

from . import _structs as c
from ._arrays import ELEMENTS, QUANTITIES, Arguments, as_array, contiguous, convert, name_priority, number, take
from ._library import Context, InvalidArgument, InvalidData, default_context, fill_slots, lib, say, warn, warn_of_particles
from ._options import BOUNDS, OUTPUTS, Function, Options, check_names, did_you_mean, kind_of, show
from ._units import Units, without_unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Protocol

    from .io import Particles

    class Frame(Protocol):
        """A table of columns, such as a data frame of pandas."""

        @property
        def columns(self) -> Any: ...

        def __getitem__(self, name: Any, /) -> Any: ...

    Positions = Union[ArrayLike, Particles]
    Progress = Union[bool, Callable[[float, str], Any]]
    Attributes = Union[Mapping[str, ArrayLike], Frame, Sequence[str]]
    Fluid = Union[str, Tuple[str, float], Mapping[str, float]]
    Only = Union[Mapping[str, Union[float, Tuple[float, float]]], ArrayLike]


class Keywords(Options, total=False):
    """The keywords of the functions. Each function has the keywords below and some of the Options; `outputs` only if it has outputs to choose."""

    fluid: Optional[Fluid]
    solid: Optional[ArrayLike]
    smoothing_length: Optional[ArrayLike]
    volume: Optional[ArrayLike]
    mass: Optional[ArrayLike]
    density: Optional[ArrayLike]
    outputs: Union[None, str, Sequence[str]]
    within: Optional[ArrayLike]
    only: Optional[Only]
    context: Optional[Context]
    device: Union[None, str, int]
    progress: Optional[Progress]


def own_keywords(kind: Any, options: Sequence[str] = tuple(OUTPUTS)) -> dict[str, Any]:
    """Returns {name: type} of the keywords in the class `kind`. Leaves out the core's options. Also leaves out `outputs` if
    `options` names no output."""
    return {name: each for name, each in kind.__annotations__.items() if name not in Options.__annotations__
            and (name != "outputs" or not OUTPUTS.keys().isdisjoint(options))}


def of_particles(options: Sequence[str]) -> Callable[[Function], Function]:
    """Returns a decorator that adds the keywords of Keywords and these options to a function's signature and docstring.

    Positions may be particles of io.read(). Names then mean the file's arrays, and smoothing length, mass, walls, kernel
    and period come from the file unless they are given.
    """
    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)

        @functools.wraps(function)
        def call(positions: Any, *arguments: Any, **words: Any) -> Any:
            check_names(call, words, options)
            if "outputs" in words:
                words["outputs"] = _list_outputs(words, options)
            if hasattr(positions, "words"):
                given = signature.bind(positions, *arguments, **words).arguments
                more = given.pop("words", {})
                return function(**given.pop("positions").words({**given, **more}))
            return function(positions, *arguments, **words)

        show(call, own_keywords(Keywords, options), options)
        return cast(Function, call)

    return decorate


def prepare(positions, words, attributes=None, named=None, wants=(), nothing="no surface", **roles):
    """Returns the core's arguments. Their `units` serve the caller to convert other lengths and quantities. words: the call's keywords.
    named: the arrays that `fluid` and `only` may name; by default the attributes. wants: names of mcor_want. nothing: the warning's text
    if there is no fluid; None: a missing fluid raises an error. roles: arrays, by the names of their roles in mcor_role."""
    options, attributes = dict(words), attributes or {}
    source = options.pop("source", None)
    given = {name: options.pop(name, None) for name in own_keywords(Keywords)}
    options.update((name, True) for name in given.pop("outputs") or ())
    for name, other in (("cube_size_factor", "cube_size"), ("tolerance", "preview"), ("iteration_limit", "preview"),
                        ("smoothing_length_is_support_radius", "estimate_smoothing_length")):
        if options.get(name) and options.get(other):
            warn(fill_slots("", f"{{{name}}} is not used, because {{{other}}} is given. Leave one of them out.".encode()))
    versions = [name for name in options if name.endswith("_version") and options[name]]
    if versions and given["context"] is None:
        warn(f"{versions[0]} is not used without a context, which keeps particles between calls. Give context=Context().")
    units = Units(positions)
    arguments = Finder(units.positions, source, attributes if named is None else named)
    arguments.units, arguments.context, arguments.device, arguments.progress = units, given["context"], given["device"], given["progress"]
    given.update(units.quantities(given), within=units.lengths(given["within"], "within"))
    arguments.add_sizes({**{role: given[role] for role in QUANTITIES}, **roles}, options.pop("estimate_smoothing_length", False))
    arguments.add_fluid(given["solid"], given["fluid"])
    arguments.add_choice(given["within"], given["only"])
    arguments.request["scalar_component"] = -1  # This means the magnitude.
    arguments.request.update((name, number(name, kind_of(name), options.pop(name))) for name in (
        "smoothing_length_is_support_radius", "scalar_component", "ignore_solids") if name in options)
    arguments.complete(wants, units.options(options), nothing)
    if arguments.request["scalar_component"] != -1 and arguments.input.scalar.components == 1:
        raise InvalidArgument("scalar_component is for vectors, and the scalar has one component; leave it out.")
    if "flow" not in wants:
        arguments.set_attributes(attributes)
    return arguments


class Ranges(list):
    """A list of pairs (name, value or (low, high)), in place of the dictionary `only`. If pairs share a name, a particle must fit one
    of them."""


class Finder(Arguments):
    """Arguments that are arrays of NumPy. The core finds volumes, fluid, particles to leave out, and the scalar among the given arrays
    and a file's arrays. source: the file's particles, or None. `fluid` and `only` name arrays of the file; without a file, attributes."""

    def __init__(self, positions, source, attributes):
        super().__init__(positions)
        self.source = source
        self.others = attributes if source is None else source.arrays
        self.named, self.names, self.values, self.ranges, self.texts, self.looks = {}, {}, {}, [], [], False
        self.request = {"find": source is not None}

    def add(self, name, array):
        """Adds the array to `named` under a name that no other array has there. Returns this name."""
        while name in self.named and self.named[name] is not array:
            name += "'"
        self.named[name] = array
        return name

    def array_of(self, name):
        if self.source is not None:
            return self.source.array(name)
        if name not in self.others:
            raise InvalidArgument(f"There is no array '{name}' among the attributes.{did_you_mean(name, self.others)} "
                                  f"Attributes: {', '.join(self.others) or 'none'}.")
        return self.others[name]

    def take(self, keyword, name, kinds="fiub"):
        array = as_array(without_unit(self.array_of(name)), f"array '{name}' of {keyword}")
        if array.shape != (self.count,) or array.dtype.kind not in kinds:
            raise InvalidArgument(f"{keyword} names the array '{name}', of {array.dtype} and of the shape {array.shape}; it must "
                                  "have one number for each particle.")
        return array if array.dtype in ELEMENTS or array.dtype.kind not in "fiu" else contiguous(array, name)

    def add_sizes(self, given, estimate):
        """Adds the quantities and the scalar to the request. given: {role: array, value or None}; the scalar may also be a
        name. estimate: the keyword estimate_smoothing_length."""
        self.ratio = None
        if isinstance(estimate, str):
            name, equals, ratio = estimate.partition("=")
            if name not in ("neighbours", "neighbors"):
                raise InvalidArgument(f"estimate_smoothing_length is '{estimate}'; it must be True, \"neighbours\" or \"neighbours=ETA\".")
            self.ratio = convert(float, "ETA of neighbours", ratio) if equals else 1.3
        self.request.update(lengths_by_neighbours=self.ratio is not None, estimate_smoothing_length=self.ratio is not None or number(
            "estimate_smoothing_length", "int", estimate), compute_volumes=isinstance(given["volume"], str) and given["volume"] == "computed")
        for role, array in given.items():
            words = role.replace("_", " ")
            if role == "volume" and self.request["compute_volumes"] or array is None:
                continue
            if isinstance(array, str) and role == "scalar":
                self.names[role] = array
                continue
            array = as_array(array, words)
            if array.ndim == 0 and role in QUANTITIES:
                self.values[role] = convert(float, words, array.item())
                if not self.values[role] > 0:
                    raise InvalidArgument(f"The {words} is {self.values[role]:g}; it must be greater than 0.")
            else:
                self.names[role] = self.add(words, self.shaped(array, words))
        for role in ("volume", "mass", "density") if self.source else ():
            array = None if role in self.names or role in self.values else self.source.quantity(role)
            if array is not None:
                name, array = getattr(self.source, role), array if np.ndim(array) else np.full(self.count, array)
                is_usual = isinstance(name, str) and name_priority(name, role) == 0
                self.add(name if is_usual else role, self.shaped(array, role))
        if not self.count and "smoothing_length" not in self.names:
            self.values["smoothing_length"] = 1.0  # No particle needs it.

    def add_fluid(self, solid, fluid):
        is_auto = isinstance(fluid, str) and fluid == "auto"
        if solid is not None and fluid is not None:
            raise InvalidArgument("solid and fluid both tell which particles are fluid. Leave one of them out.")
        if solid is not None:
            self.names["fluid"], self.request["fluid_value"] = self.add("solid", self.marks(solid)), 0
        elif fluid is not None and not is_auto:
            parts = fluid.rpartition("=")[::2] if isinstance(fluid, str) else next(iter(fluid.items())) if isinstance(
                fluid, Mapping) and len(fluid) == 1 else fluid
            if not isinstance(parts, (tuple, list)) or len(parts) != 2 or np.ndim(parts[0]) == 0 and not (
                    isinstance(parts[0], str) and parts[0]):
                raise InvalidArgument(f'fluid is {fluid!r}; it must be ("NAME", VALUE), (array, VALUE), "NAME=VALUE", or "auto".')
            name, self.request["fluid_value"] = parts[0], convert(float, "value of fluid", parts[1])
            self.names["fluid"] = self.add(name, self.take("fluid", name)) if isinstance(name, str) else self.add(
                "fluid", self.marks(name, "fluid"))
        self.request["find_fluid"] = 2 * is_auto
        self.looks = "fluid" not in self.names and (self.source is not None or is_auto)
        for name in self.others if self.looks else ():
            if name_priority(name, "particle_type") >= 0:
                array = np.ascontiguousarray(self.array_of(name))
                self.add(name, array.astype(array.dtype.newbyteorder("="), copy=False))

    def add_choice(self, within, only):
        if within is not None:
            sides = np.ravel(contiguous(within, "list of numbers of within")).tolist()
            if len(sides) != 6 or not all(low <= high for low, high in zip(sides[::2], sides[1::2])):
                raise InvalidArgument(f"within is {within!r}; it must be {BOUNDS}, the lower ones first.")
            self.request["within"] = sides if any(sides) else [-5e-324, *sides[1:]]  # For the core zeros mean no choice.
        if isinstance(only, (Mapping, Ranges)):
            for name, wanted in only.items() if isinstance(only, Mapping) else only:
                array = self.take("only", name, "fiubUSO" if isinstance(wanted, str) else "fiub")
                if array.dtype.kind in "USO":
                    self.add_marks(f"{name}={wanted}", array.astype(str) == wanted)
                    continue
                ends = [wanted, wanted] if isinstance(wanted, str) or np.ndim(wanted) == 0 else list(wanted)
                ends = [convert(float, f"value of '{name}' in only", end) for end in ends]
                if len(ends) != 2 or not ends[0] <= ends[1]:
                    raise InvalidArgument(f"only['{name}'] is {wanted!r}; it must be a number, or the lowest and the highest one, the lower "
                                          "value first.")
                self.ranges.append((self.add(name, array), *ends))
        elif only is not None:
            only = as_array(only, "array of only")
            if only.dtype != bool or only.shape != (self.count,):
                raise InvalidArgument(f"only is {{name: value}}, or True or False for each of {self.count} particles, not an "
                                      f"array of {only.dtype} of the shape {only.shape}.")
            self.add_marks("only", only)

    def add_marks(self, name, marks):
        self.texts.append(self.add(name, marks))
        self.ranges.append((self.texts[-1], 1, 1))

    def complete(self, wants, options, nothing):
        """Sets the input and the options. If there is no fluid, warns in the words of `nothing`; raises an error if `nothing` is None."""
        self.find(self.named, ["sizes", *wants, *["fluid"] * self.looks], self.names, self.values, self.ranges, **self.request)
        if self.error:
            raise InvalidArgument(say("LENGTH_MISSING") if self.error.code == "NO_SMOOTHING_LENGTH" else self.error)
        warn(self.unused)
        warn(self.unused_type)
        why = self.text("no_fluid")
        for name in self.texts:  # The core's sentence has name=value.
            why = why.replace(f"{name}=1", name)
        self.set_options(options)
        if why and self.count:
            if nothing is None:
                raise InvalidData(say("NOTHING_WITHOUT_FLUID", why, "nothing to compute"))
            warn(say("NOTHING_WITHOUT_FLUID", why, nothing))
            self.input.count = 0
        self.sum_over_neighbours(self.ratio)


def _list_outputs(words, options):
    """Returns the names in outputs, which must be among the function's options."""
    outputs, known = words["outputs"], [name for name in OUTPUTS if name in options]
    outputs = [] if outputs is None else list(outputs) if np.iterable(outputs) and not isinstance(outputs, str) else [outputs]
    for name in outputs:
        if name not in known:
            raise InvalidArgument(f"outputs names {name!r}.{did_you_mean(name, known)} Outputs are {', '.join(known)}.")
        if words.get(name) is False:
            raise InvalidArgument(f"outputs names '{name}', but {name} is False. Leave one of them out.")
    return outputs


def warn_of_missing(missing):
    for name, particle in missing.items():
        warn(say("ARRAY_LEFT_OUT", name, particle, "the result"))


@contextlib.contextmanager
def called(function, kind, arguments, *more):
    """Yields the result of a function of the core, and frees it at the end. Widens smoothing lengths first if the options want it. Calls
    warn_of_particles(), except for a surface and for a widening: their callers give the warnings."""
    if arguments.options.widen != 1 and kind is not c.mcor_widening:
        of_surface = kind is c.mcor_surface
        arguments.widening = arguments.widening or widen(arguments, of_surface)
        arguments.set_widening(*arguments.widening[:2], of_surface)
    context = arguments.context
    own = context is None
    if not own and not isinstance(context, Context):
        raise InvalidArgument(f"The context is a {type(context).__name__}; it must be a Context.")
    context, result = default_context(arguments.device) if own else context, kind()
    try:
        try:
            context.run(lambda handle: function(handle, ctypes.byref(arguments.input), ctypes.byref(arguments.options),
                                                *more, ctypes.byref(result)), arguments.options, arguments.progress)
        finally:
            if own:
                context.release_memory()
        if kind is c.mcor_surface and arguments.widening:
            lib.mcor_add_widening(ctypes.byref(result.statistics), ctypes.byref(arguments.widening[2]))
        if kind not in (c.mcor_surface, c.mcor_widening):
            warn_of_particles(arguments, result.statistics)
        yield result
    finally:
        getattr(lib, kind.__name__.replace("mcor_", "mcor_free_"))(ctypes.byref(result))


def widen(arguments, of_surface):
    """Returns the factors of the smoothing lengths, the volumes if they are computed, and the statistics. of_surface: whether the
    factors are for the surface of these options; else they are for the free surface."""
    options = arguments.options
    if not of_surface:
        arguments.options = c.mcor_options.from_buffer_copy(options)
        arguments.options.field = c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
    try:
        with called(lib.mcor_widen, c.mcor_widening, arguments) as found:
            return (take(found.factor, (found.count,)), take(found.volume, (found.count,)) if found.volume else None,
                    c.mcor_statistics.from_buffer_copy(found.statistics))
    finally:
        arguments.options = options
