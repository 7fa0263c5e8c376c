# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Has what the functions share: their keywords, particles of files in place of positions, and one call of the core."""
from __future__ import annotations

import contextlib
import ctypes
import functools
import inspect
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Tuple, Union, cast

import numpy as np

from . import _structs as c
from ._arrays import QUANTITIES, SUMMED, Arguments, choose
from ._context import Context, default_context
from ._find import Found, as_bytes, choose_volumes, describe_unused
from ._library import InvalidArgument, InvalidData, lib, say, word_by
from ._options import Function, Options, check_names, did_you_mean, show
from ._warnings import warn, warn_of_particles

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Protocol

    from .io import Particles

    class Frame(Protocol):
        """Whether this is a table of columns, as of pandas."""

        @property
        def columns(self) -> Any: ...

        def __getitem__(self, name: Any, /) -> Any: ...

    Positions = Union[ArrayLike, Particles]
    Progress = Union[bool, Callable[[float, str], Any]]
    Attributes = Union[Mapping[str, ArrayLike], Frame, Sequence[str]]
    Only = Union[Mapping[str, Union[float, Tuple[float, float]]], ArrayLike]

# These arguments may name an array if the particles come from a file.
ARRAYS = ("scalar", "scalar_dot", "velocity", "weighted_by", "solid", *QUANTITIES)


class Shared(Options, total=False):
    """Has the keywords of all functions, and of PyVista's methods."""

    smoothing_length: Optional[ArrayLike]
    volume: Optional[ArrayLike]
    mass: Optional[ArrayLike]
    density: Optional[ArrayLike]
    within: Optional[ArrayLike]
    only: Optional[Only]
    context: Optional[Context]
    device: Union[None, str, int]
    progress: Optional[Progress]


class Keywords(Shared, total=False):
    solid: Optional[ArrayLike]


def own_keywords(kind: Any) -> dict[str, Any]:
    """Returns {name: type} of a class of keywords, without the options."""
    return {name: each for name, each in kind.__annotations__.items() if name not in Options.__annotations__}


def of_particles(options: Sequence[str], masses: bool = False) -> Callable[[Function], Function]:
    """Decorator: the function takes Keywords, and these options; all stand in its signature and its text.

    Particles of io.read() may stand in place of positions. An array's name is then an array, and what the file says of
    h, mass, walls, kernel and period is taken, unless it is given. masses: masses and densities also beside volumes.
    """
    def decorate(function: Function) -> Function:
        signature = inspect.signature(function)

        @functools.wraps(function)
        def call(positions: Any, *arguments: Any, **words: Any) -> Any:
            check_names(call, words, options)
            if hasattr(positions, "words"):
                given = signature.bind(positions, *arguments, **words).arguments
                more = given.pop("words", {})
                return function(**_words_of_file(given.pop("positions"), {**given, **more}, masses))
            return function(positions, *arguments, **words)

        show(call, own_keywords(Keywords), options)
        return cast(Function, call)

    return decorate


def _words_of_file(particles, given, masses):
    words, only = dict(given), given.get("only")
    for name in ARRAYS:
        text = words.get(name)
        if isinstance(text, str) and (name, text) != ("volume", "computed") and not (
                (name, text) == ("scalar", SUMMED) and SUMMED not in particles):
            words[name] = particles.array(text)
    words = particles.words(words, beside=masses)
    if words.get("smoothing_length") is None and not words.get("estimate_smoothing_length") and len(particles):
        raise InvalidArgument(f"{particles.file} tells no smoothing length. Give smoothing_length=, an array's name or a value, or "
                              "estimate_smoothing_length=True (in a shell --smoothing-length NAME, VALUE or estimate). Arrays: "
                              f"{', '.join(particles.arrays) or 'none'}.")
    for name in ("mass", "density") if masses else ():
        words[name] = particles.quantity(name) if words.get(name) is None else words[name]
    if isinstance(only, Mapping):
        words["only"] = choose(only, particles.array)
    if words.get("solid") is None and only is None:
        _warn_of_unused_type(particles)
    return {**words, "positions": particles.positions}


def _warn_of_unused_type(particles):
    type_of_particles = c.ENUMS["mcor_quantity"]["MCOR_PARTICLE_TYPE"]
    arrays = {name: np.ascontiguousarray(particles.arrays[name]) for name in particles.arrays
              if lib.mcor_name_priority(type_of_particles, as_bytes(name)) >= 0}
    sentence = Found(np.empty((len(particles), 3), np.float32), arrays, ["fluid"]).unused_type
    if sentence:
        warn(sentence.say(word_by(lambda slot, name: particles.remedy.format(name=name) if slot == "fluid" else "")))


def prepare(units, words, attributes=None, named=None, beside=False):
    """The core's arguments. words: Keywords. named: what `only` may name, where that is more than the attributes. beside:
    masses and densities are wanted beside volumes."""
    options, attributes = dict(words), attributes or {}
    given = {name: options.pop(name, None) for name in own_keywords(Keywords)}
    _drop_unused(given, options, warns=not beside)
    arguments = Arguments(units.positions)
    arguments.context, arguments.device, arguments.progress = given["context"], given["device"], given["progress"]
    arguments.set_quantities(units.quantities(given))
    only = given["only"]
    if isinstance(only, Mapping):
        only = choose(only, functools.partial(_attribute, attributes if named is None else named))
    present = arguments.find_present(units.lengths(given["within"], "within"), only)
    if present is not None and arguments.count and not present.any():
        names = " and ".join(name for name in ("within", "only") if given[name] is not None)
        raise InvalidData(f"None of the {arguments.count} particles is left by {names}. Give wider bounds or other values.")
    arguments.set_solid(given["solid"], present)
    arguments.set_attributes(attributes)
    estimate = options.get("estimate_smoothing_length")
    if isinstance(estimate, str):
        options["estimate_smoothing_length"] = False
    arguments.set_options(units.options(options))
    if isinstance(estimate, str):
        arguments.estimate_by_neighbours(estimate)
    return arguments


def _attribute(attributes, name):
    if name not in attributes:
        raise InvalidArgument(f"only names '{name}', which is not among the attributes.{did_you_mean(name, attributes)} "
                              f"Attributes: {', '.join(attributes) or 'none'}.")
    return attributes[name]


def _drop_unused(given, options, warns):
    """Keeps of volume, mass and density what makes the volumes, and warns of arguments that have no effect beside others."""
    words = {"compute_volumes": isinstance(given["volume"], str),
             "estimate_smoothing_length": bool(options.get("estimate_smoothing_length"))}
    if words["compute_volumes"]:
        given["volume"] = None
    has = {name for name in QUANTITIES if given[name] is not None}
    used = choose_volumes(has, has, **words)
    unused = describe_unused(has, used, **words) if warns else ""
    if unused:
        warn(unused)
    given.update(dict.fromkeys({"volume", "mass", "density"} - used))
    for name, other in (("cube_size_factor", "cube_size"), ("tolerance", "preview"), ("iteration_limit", "preview"),
                        ("smoothing_length_is_support_radius", "estimate_smoothing_length")):
        if options.get(name) and options.get(other):
            warn(f"{name} is not used, because {other} is given. Leave one of them out.")
    versions = [name for name in options if name.endswith("_version") and options[name]]
    if versions and given["context"] is None:
        warn(f"{versions[0]} is not used without a context, which keeps particles between calls. Give context=Context().")


def warn_of_missing(missing):
    for name, particle in missing.items():
        warn(say("ARRAY_LEFT_OUT", name, particle, "the result"))


@contextlib.contextmanager
def called(function, kind, arguments, *more):
    """Yields what a function of the core returns, and frees it at the end."""
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
        if kind not in (c.mcor_surface, c.mcor_widening):
            warn_of_particles(arguments, result.statistics)
        yield result
    finally:
        getattr(lib, kind.__name__.replace("mcor_", "mcor_free_"))(ctypes.byref(result))


@contextlib.contextmanager
def extracted(arguments):
    """Yields the core's surface, with widened smoothing lengths if the options ask for that."""
    found = None
    if arguments.options.widen != 1:
        with called(lib.mcor_widen, c.mcor_widening, arguments) as widening:
            arguments.set_widening(widening)
            found = c.mcor_statistics.from_buffer_copy(widening.statistics)
    with called(lib.mcor_extract, c.mcor_surface, arguments) as surface:
        if found:
            lib.mcor_add_widening(ctypes.byref(surface.statistics), ctypes.byref(found))
        yield surface
