# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""isosurface, free_surface, probe, derivatives: one call of the core each."""
from __future__ import annotations

import contextlib
import ctypes
import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Dict, Optional, Sequence, Tuple, Union, cast

import numpy as np

from . import _structs as c
from ._arrays import (SUMMED, Arguments, as_bytes, as_named, as_points, choose, contiguous, is_real, left_out, number, statistics,
                      take, take_all, take_each, take_lines)
from ._context import Context, default_context
from ._library import ERRORS, InvalidArgument, InvalidData, lib
from ._options import (DERIVATIVES, FREE_SURFACE, ISOSURFACE, PROBE, WIDENING, Function, check_names, did_you_mean,
                       with_options)
from ._surface import Derivatives, Samples, Surface
from ._units import Units, scalar_and_iso, without_unit
from ._warnings import describe_unused_type, describe_warnings, warn, warn_of_particles

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Literal, Protocol, Unpack

    from ._options import Options
    from .io import Particles

    class Frame(Protocol):
        """A table of columns, as of pandas."""

        @property
        def columns(self) -> Any: ...

        def __getitem__(self, name: Any, /) -> Any: ...

    Positions = Union[ArrayLike, Particles]
    Progress = Union[bool, Callable[[float, str], Any]]
    Attributes = Union[Mapping[str, ArrayLike], Frame, Sequence[str]]
    Only = Union[Mapping[str, Union[float, Tuple[float, float]]], ArrayLike]

QUANTITIES = ("smoothing_length", "volume", "mass", "density")


def prepare(units, attributes, given, options):
    """given: the arguments of the function that was called."""
    if isinstance(given["volume"], str) and given["volume"] == "computed":
        given = {**given, "volume": None, "mass": None, "density": None}
    _warn_of_ignored(given, options)
    arguments = Arguments(units.positions)
    arguments.set_quantities(units.quantities(given))
    only = given["only"]
    if isinstance(only, Mapping):
        only = choose(only, functools.partial(_attribute, as_named(given.get("attributes"))))
    present = arguments.find_present(units.lengths(given["within"], "within"), only)
    if present is not None and arguments.count and not present.any():
        names = " and ".join(name for name in ("within", "only") if given[name] is not None)
        raise InvalidData(f"None of the {arguments.count} particles is left by {names}. Give wider bounds or other values.")
    arguments.set_solid(given["solid"], present)
    names = arguments.set_attributes(attributes)
    estimate = options.get("estimate_smoothing_length")
    if isinstance(estimate, str):
        options = {**options, "estimate_smoothing_length": False}
    arguments.set_options(units.options(options))
    if isinstance(estimate, str):
        arguments.estimate_by_neighbours(estimate)
    return arguments, names


def _attribute(attributes, name):
    if name not in attributes:
        raise InvalidArgument(f"only names '{name}', which is not among the attributes.{did_you_mean(name, attributes)} "
                              f"Attributes: {', '.join(attributes) or 'none'}.")
    return attributes[name]


def _warn_of_ignored(given, options):
    """What was given, but has no effect beside something else."""
    has = {name for name in QUANTITIES if given[name] is not None}
    if options.get("estimate_smoothing_length") and "smoothing_length" in has:
        warn("smoothing_length is not used, because estimate_smoothing_length takes its place. Leave one of them out.")
    if "volume" in has and has & {"mass", "density"}:
        unused = " and ".join(name for name in ("mass", "density") if name in has)
        warn(f"{unused} {'are' if 'and' in unused else 'is'} not used, because volume is given. Leave volume out to use "
             "mass / density.")
    elif "density" in has and "mass" not in has:
        warn("density is not used, because volumes are mass / density, and there is no mass. Give mass, too.")
    versions = [name for name in options if name.endswith("_version") and options[name]]
    if versions and given["context"] is None:
        warn(f"{versions[0]} is not used without a context, which keeps particles between calls. Give context=Context().")


def _describe_empty(arguments, found):
    """A sentence for a surface of nothing that the core does not explain; "" where a box may just be elsewhere."""
    values, options, n = arguments.options.iso_values, arguments.options, found.statistics
    if len(found.points) or not arguments.count or any(options.box):
        return ""
    iso = ", ".join(f"{values[i]:.6g}" for i in range(options.iso_count))
    if options.field == c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]:
        return (f"There is no surface: the sum of the weights crosses {iso} nowhere. It is about 1 in the fluid and falls to "
                "0 outside, so an iso value of 0.5 is usual. A periodic box full of fluid has no free surface.")
    if n["scalar_min"] == n["scalar_max"]:
        return f"There is no surface: the scalar is {n['scalar_min']:.6g} at all fluid particles."
    return (f"There is no surface: the field crosses {iso} nowhere, although the scalar goes from {n['scalar_min']:.6g} to "
            f"{n['scalar_max']:.6g}. Perhaps the particles there are too few or too far apart for the node threshold.")


def _warn_of(missing):
    for name, particle in missing.items():
        warn(f"The attribute '{name}' is NaN or infinite at particle {particle} and was left out. "
             "Correct its values, or do not ask for it.")


@contextlib.contextmanager
def called(function, kind, arguments, given, *more):
    """What a function of the core returns, which is freed at the end. given: the arguments of the function that was
    called, of which context, device and progress are read."""
    context = given["context"]
    own = context is None
    if not own and not isinstance(context, Context):
        raise InvalidArgument(f"The context is a {type(context).__name__}; it must be a Context.")
    context, result = default_context(given["device"]) if own else context, kind()
    try:
        try:
            context.run(lambda handle: function(handle, ctypes.byref(arguments.input), ctypes.byref(arguments.options),
                                                *more, ctypes.byref(result)), arguments.options, given["progress"])
        finally:
            if own:
                context.release_memory()
        if kind is not c.mcor_surface:
            warn_of_particles(arguments, result.statistics)
        yield result
    finally:
        getattr(lib, kind.__name__.replace("mcor_", "mcor_free_"))(ctypes.byref(result))


def _warn_of_unused_type(particles):
    for name in particles.arrays:
        if lib.mcor_name_priority(c.ENUMS["mcor_quantity"]["MCOR_PARTICLE_TYPE"], as_bytes(name)) >= 0:
            sentence = describe_unused_type(name, particles.arrays[name])
            if sentence:
                warn(sentence.replace("select it together with the value of the fluid", f"say solid=particles['{name}'] != "
                                      f"VALUE (in a shell --fluid {name}=VALUE)"))
                return


def of_files(function: Function) -> Function:
    """Decorator: particles of io.read() may stand in place of positions. An array's name is then an array, and what the
    file says of h, mass, walls, kernel and period is taken, unless it is given."""
    @functools.wraps(function)
    def call(positions: Any, *arguments: Any, **words: Any) -> Any:
        if not hasattr(positions, "words"):
            return function(positions, *arguments, **words)
        if function.__name__ == "derivatives" and arguments:
            words["attributes"], arguments = arguments[0], arguments[1:]

        def array_of(name, thing):
            stays = not isinstance(thing, str) or (name, thing) == ("volume", "computed") or (
                (name, thing) == ("scalar", SUMMED) and SUMMED not in positions)
            return thing if stays else positions.array(thing)

        given = [array_of("scalar", thing) for thing in arguments]
        named = ("scalar", "scalar_dot", "weighted_by", "solid", *QUANTITIES)
        words = {name: array_of(name, thing) if name in named else thing for name, thing in words.items()}
        words, only = positions.words(words), words.get("only")
        if function.__name__ == "project":  # which sees masses even where volumes are others'
            for name in ("mass", "density"):
                words[name] = positions.quantity(name) if words.get(name) is None else words[name]
        if isinstance(only, Mapping):
            words["only"] = choose(only, positions.array)
        if words.get("solid") is None and only is None:
            _warn_of_unused_type(positions)
        return function(positions.positions, *given, **words)

    return cast(Function, call)


@of_files
@with_options(ISOSURFACE)
def isosurface(positions: Positions, scalar: Optional[ArrayLike], iso: Union[float, Sequence[float]], *,
               smoothing_length: Optional[ArrayLike] = None,
               volume: Optional[ArrayLike] = None,
               mass: Optional[ArrayLike] = None,
               density: Optional[ArrayLike] = None,
               attributes: Optional[Attributes] = None,
               scalar_dot: Optional[ArrayLike] = None,
               solid: Optional[ArrayLike] = None,
               within: Optional[ArrayLike] = None,
               only: Optional[Only] = None,
               context: Optional[Context] = None,
               device: Union[None, str, int] = None,
               progress: Optional[Progress] = None,
               **options: Unpack[Options]) -> Surface:
    """The isosurface of a quantity that particles carry.

    Example: surface = isosurface(x, speed, 1.0, smoothing_length=h, mass=m, density=rho, attributes={"speed": speed})

    Returns a Surface: points, triangles, normals, attributes, statistics, and the arrays that were asked for; lines in two
    dimensions. Points and attributes are float32 where positions or attributes are.

    positions: (particles, 3), length unit L. float32 and float64 arrays in C order are used where
        they lie; so are all arrays below. Lists, data frames, and what speaks DLPack will do, too.
        Or particles of io.read(): scalar is then an array's name, attributes a list of names.
    scalar: (particles,), or (particles, components): then its magnitude, or one component
        (scalar_component=0, 1, ...), or its dot product with scalar_dot.
    iso: the value of the scalar on the surface, or a list of values.
    smoothing_length: (particles,) or one value, L, greater than 0; with
        smoothing_length_is_support_radius=True it is the radius at which the kernel ends; with
        estimate_smoothing_length=True it is not needed.
    volume, or mass and density, or mass alone: (particles,) or one value, greater than 0, of units
        that give L^3; without them, and with volume="computed", volumes follow from the particles'
        distances, so that drops of few particles and sheets have a surface, too.
    attributes: {name: array}, or a data frame, to be carried to the surface: real ones as the mean of
        the particles around, integers and bools from the nearest particle.
    scalar_dot: a second vector for each particle; the scalar is then the dot product.
    solid: (particles,), True or not 0 for walls. They take no part in the field.
    within: (x0, x1, y0, y1, z0, z1), L: particles beyond these bounds are left out, whatever their values
        are; sides may be infinite.
    only: {"Type": 1} or {"Type": (1, 3)}: particles whose value in this array, of the file or of the
        attributes, is another, or not from the lowest to the highest one, are left out likewise. All names
        must agree. Or (particles,), True for those that are taken.
    context: a Context, to keep particles on the device between calls; else one of our own per
        device, which keeps compiled programs alone.
    device: a number or part of a name as in devices(), where no context is given.
    progress: True shows a bar; or a function, called with a fraction from 0 to 1 and the name of the
        phase, which ends the run by returning False, or by an exception.

    {options}

    Arrays with units, of pint, unyt or astropy: lengths are converted to the unit of the positions,
    mass / density with them, and iso to the scalar's unit; results are plain numbers in these units.
    What has a unit beside what has none is refused.

    Raises an Error (InvalidArgument, InvalidData, OutOfCapacity, DeviceError, Cancelled). What is
    legal, but hardly meant, gives an InputWarning. Other threads go on meanwhile; Ctrl-C ends the run.
    """
    check_names(isosurface, options, ISOSURFACE)
    return _extract(locals(), options)


def _extract(given, options):
    """given: the arguments of isosurface()."""
    attributes, units = as_named(given["attributes"]), Units(given["positions"])
    real = {name: array for name, array in attributes.items() if is_real(array)}
    scalar, scalar_dot, iso = scalar_and_iso(given["scalar"], given["scalar_dot"], given["iso"])
    arguments, names = prepare(units, real, given, options)
    free_surface_wanted = arguments.options.field == c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
    _set_scalar(arguments, scalar, scalar_dot, free_surface_wanted)
    if iso is None:
        raise InvalidArgument("Give the iso value: a number, or a list of them.")
    arguments.set_iso_values(iso)
    wanted = bool(arguments.options.nearest_particle)
    from_nearest = _from_nearest(attributes, real, arguments)
    with called(lib.mcor_extract, c.mcor_surface, arguments, given) as surface:
        found = take_surface(surface, arguments, names)
        sentences = describe_warnings(arguments, surface)
    found.points = found.points.astype(arguments.positions.dtype, copy=False)
    for name in from_nearest:
        found.attributes[name] = attributes[name][[] if found.nearest_particle is None else found.nearest_particle]
    found.attributes = {name: found.attributes[name] for name in attributes if name in found.attributes}
    if not wanted:
        found.nearest_particle = None
    _warn_of(found.left_out)
    for sentence in list(sentences.values()) or [_describe_empty(arguments, found)]:
        if sentence:
            warn(sentence)
    return found


def _set_scalar(arguments, scalar, scalar_dot, free_surface_wanted):
    if free_surface_wanted:
        return
    if scalar is None:
        raise InvalidArgument('Give the scalar to contour, or call free_surface().')
    if isinstance(scalar, str):
        scalar = arguments.sum_densities(scalar)
    arguments.input.scalar = arguments.per_particle(scalar, "scalar")
    arguments.input.scalar.name = None  # the core then says "the scalar"
    if arguments.input.scalar.components == 1:
        arguments.input.scalar_component = 0
    if scalar_dot is not None:
        arguments.input.scalar_dot = arguments.per_particle(scalar_dot, "scalar_dot")


def _from_nearest(attributes, real, arguments):
    names = [name for name in attributes if name not in real]
    for name in names:
        if attributes[name].ndim == 0 or len(attributes[name]) != arguments.count:
            raise InvalidArgument(f"The attribute '{name}' has the shape {attributes[name].shape} for "
                                  f"{arguments.count} particles.")
    if names:
        arguments.options.nearest_particle = 1
    return names


def take_surface(surface, arguments, names):
    """A Surface of the core's, with the attributes of these names."""
    count = surface.point_count
    arrays = take_all("mcor_surface", surface,
                      {"point_count": count, "triangle_count": surface.triangle_count})
    if arrays["points"] is None:
        arrays["points"] = np.empty((0, 3))
    if arrays["triangles"] is None:
        arrays["triangles"] = np.empty((0, 3), np.int32)
    return Surface(**arrays, **take_lines(surface), attributes=take_each(surface.attributes, names, arguments.kinds, (count,)),
                   left_out=left_out(surface, names), statistics=statistics(surface.statistics))


@of_files
@with_options(FREE_SURFACE)
def free_surface(positions: Positions, iso: Union[float, Sequence[float]] = 0.5, *,
                 smoothing_length: Optional[ArrayLike] = None,
                 volume: Optional[ArrayLike] = None,
                 mass: Optional[ArrayLike] = None,
                 density: Optional[ArrayLike] = None,
                 attributes: Optional[Attributes] = None,
                 solid: Optional[ArrayLike] = None,
                 within: Optional[ArrayLike] = None,
                 only: Optional[Only] = None,
                 context: Optional[Context] = None,
                 device: Union[None, str, int] = None,
                 progress: Optional[Progress] = None,
                 **options: Unpack[Options]) -> Surface:
    """The surface of the fluid: where the sum of the particles' weights is `iso`.

    Example: free_surface(x, smoothing_length=h, mass=m, density=rho).save("water.ply")

    Returns a Surface, as isosurface() does.

    The sum has no unit: it is about 1 inside the fluid and falls to 0 outside. The arguments that
    are not listed here are those of isosurface().

    {options}
    """
    check_names(free_surface, options, FREE_SURFACE)
    return _extract({**locals(), "scalar": None, "scalar_dot": None}, {**options, "field": "weight_sum"})


@of_files
@with_options(PROBE)
def probe(positions: Positions, points: ArrayLike, *,
          smoothing_length: Optional[ArrayLike] = None,
          volume: Optional[ArrayLike] = None,
          mass: Optional[ArrayLike] = None,
          density: Optional[ArrayLike] = None,
          attributes: Optional[Attributes] = None,
          solid: Optional[ArrayLike] = None,
          within: Optional[ArrayLike] = None,
          only: Optional[Only] = None,
          context: Optional[Context] = None,
          device: Union[None, str, int] = None,
          progress: Optional[Progress] = None,
          **options: Unpack[Options]) -> Samples:
    """The field of the attributes, and with gradients=True its gradients, at any points.

    Example: probe(x, grid, smoothing_length=h, attributes={"speed": speed}).values["speed"]

    Returns Samples: values, gradients, weight_sum and valid, in the shape (...) of the points. Where a point is not valid,
    because there is no fluid, values are NaN.

    points: (..., 3), L; one that is not finite is not valid.
    attributes: {name: (particles,) or (particles, components)}, or a data frame.

    The other arguments are those of isosurface().

    {options}
    """
    check_names(probe, options, PROBE)
    given, attributes, units = locals(), as_named(attributes), Units(positions)
    arguments, names = prepare(units, attributes, given, options)
    where = contiguous(units.lengths(points, "array of points"), "array of points")
    is_whole = where.shape[-1:] == (3,)
    shape = where.shape[:-1] if is_whole else (0,)
    where = as_points(where.reshape(-1, 3) if is_whole else where, "points", "(..., 3)")
    view = arguments.view(where, "points")
    with called(lib.mcor_probe, c.mcor_samples, arguments, given, ctypes.byref(view), len(where)) as samples:
        arrays = take_all("mcor_samples", samples, {"count": samples.count})
        valid = _or_zeros(arrays["valid"], len(where)).astype(bool).reshape(shape)
        result = Samples(
            weight_sum=_or_zeros(arrays["weight_sum"], len(where)).reshape(shape), valid=valid,
            values=take_each(samples.values, names, arguments.kinds, shape),
            gradients=take_each(samples.gradients, names, arguments.kinds, shape, (3,)),
            weight_gradient=None if arrays["weight_gradient"] is None else arrays["weight_gradient"].reshape(*shape, 3),
            left_out=left_out(samples, names),
            statistics=statistics(samples.statistics))
    for values in [*result.values.values(), *result.gradients.values()]:
        values[~valid] = np.nan
    _warn_of(result.left_out)
    return result


def _or_zeros(array, count):
    return np.zeros(count) if array is None else array


@of_files
@with_options(DERIVATIVES)
def derivatives(positions: Positions, attributes: Attributes, *, form: Literal["corrected", "standard"] = "corrected",
                smoothing_length: Optional[ArrayLike] = None,
                volume: Optional[ArrayLike] = None,
                mass: Optional[ArrayLike] = None,
                density: Optional[ArrayLike] = None,
                solid: Optional[ArrayLike] = None,
                within: Optional[ArrayLike] = None,
                only: Optional[Only] = None,
                context: Optional[Context] = None,
                device: Union[None, str, int] = None,
                progress: Optional[Progress] = None,
                **options: Unpack[Options]) -> Derivatives:
    """SPH gradients of the attributes at the particles themselves.

    Example: flow(derivatives(x, {"v": velocity}, smoothing_length=h).gradients["v"])["vorticity"]

    Returns Derivatives: gradients, (particles, 3) or (particles, components, 3) by name, and where they are corrected.

    attributes: {name: (particles,) or (particles, components)}, or a data frame.
    form: "corrected" (exact for linear attributes) or "standard".

    The other arguments are those of isosurface(). For divergence, vorticity and the like give the
    gradients of a velocity to flow().

    {options}
    """
    check_names(derivatives, options, DERIVATIVES)
    given = locals()
    arguments, names = prepare(Units(positions), as_named(attributes), given, options)
    chosen = number("form", "mcor_gradient", form)
    with called(lib.mcor_derive, c.mcor_derivatives, arguments, given, chosen) as result:
        corrected = take(result.corrected, (result.count,))
        found = Derivatives(
            gradients=take_each(result.gradients, names, arguments.kinds, (result.count,), (3,)),
            corrected=_or_zeros(corrected, arguments.count).astype(bool), left_out=left_out(result, names),
            statistics=statistics(result.statistics))
    _warn_of(found.left_out)
    return found


@of_files
@with_options(WIDENING)
def widening(positions: Positions, iso: Optional[float] = 0.5, *, widen: float = 2,
             smoothing_length: Optional[ArrayLike] = None,
             volume: Optional[ArrayLike] = None,
             mass: Optional[ArrayLike] = None,
             density: Optional[ArrayLike] = None,
             solid: Optional[ArrayLike] = None,
             within: Optional[ArrayLike] = None,
             only: Optional[Only] = None,
             return_volume: bool = False,
             context: Optional[Context] = None,
             device: Union[None, str, int] = None,
             progress: Optional[Progress] = None,
             **options: Unpack[Options]) -> Any:
    """The factors of smoothing lengths with which isosurface() and free_surface() contour where widen is above 1.

    Example: s = widening(x, smoothing_length=h, volume=v, widen=2)

    Returns s, (particles,) float64, from 1 to widen; or with return_volume=True s and the volumes, computed from the
    smoothing lengths h themselves, or None where they are given. The surface of s * h with these volumes, the same
    cube_size and cubes of one size (level_limit=0) is that of widen, bit for bit.

    iso: the greatest iso value of the free surface; None: for the surface of a scalar.
    return_volume: True: the volumes, too.

    The other arguments are those of isosurface().

    {options}
    """
    check_names(widening, options, WIDENING)
    given = locals()
    arguments, _ = prepare(Units(positions), {}, given, {**options, "widen": widen})
    if iso is not None:
        arguments.options.field = c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
        arguments.set_iso_values(iso)
    with called(lib.mcor_widen, c.mcor_widening, arguments, given) as result:
        factors = take(result.factor, (result.count,))
        return (factors, take(result.volume, (result.count,))) if return_volume else factors


def flow(gradients: ArrayLike) -> Dict[str, np.ndarray]:
    """What velocity gradients J say of a flow.

    Example: flow(gradients)["vorticity"]

    Returns {name: array}: "divergence" (tr J), "vorticity" (the curl, (particles, 3)), "q_criterion", "lambda2" and
    "strain_rate" ((particles, 3, 3)), in the unit of J or its square.

    gradients: (particles, 3, 3), d component / d axis, as of derivatives().
    """
    matrices = contiguous(without_unit(gradients), "array of velocity gradients").astype(np.float64)
    if matrices.ndim != 3 or matrices.shape[1:] != (3, 3):
        raise InvalidArgument(f"Velocity gradients have the shape (particles, 3, 3), not {matrices.shape}.")
    wanted, arrays = c.mcor_flow(), {}
    for name, shape in c.SHAPES["mcor_flow"].items():
        arrays[name] = np.zeros((len(matrices),) + shape[1:])
        setattr(wanted, name, arrays[name].ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
    status = lib.mcor_decompose_gradients(
        matrices.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), len(matrices), ctypes.byref(wanted))
    if status:
        raise ERRORS[status]("The velocity gradients could not be decomposed.")
    return arrays
