# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""isosurface, free_surface, probe, derivatives: one call of the core each."""
from __future__ import annotations

import ctypes
import inspect
import textwrap
import warnings
from dataclasses import dataclass, field as dataclass_field
from typing import TYPE_CHECKING, Any, Callable, Dict, Mapping, Optional, Sequence, Union

import numpy as np

from . import _structs as c
from ._arrays import (Arguments, as_named, as_points, contiguous, is_real, left_out, statistics, take, take_all, take_each)
from ._context import Context, default_context
from ._library import ERRORS, InvalidArgument, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from ._structs import Options

    Progress = Callable[[float, str], Any]
    Attributes = Mapping[str, ArrayLike]


@dataclass
class Surface:
    """A triangle mesh. Arrays that were not asked for are None; all own their memory."""

    points: np.ndarray  #: (points, 3) float64, unit of the positions (L)
    triangles: np.ndarray  #: (triangles, 3) int32; the right-hand normal points to lower values
    normals: Optional[np.ndarray] = None  #: (points, 3) float32, unit length
    gradients: Optional[np.ndarray] = None  #: (points, 3) float64, scalar unit / L
    weight_sum: Optional[np.ndarray] = None  #: (points,) float32, the trimming weight
    boundary_eigenvalue: Optional[np.ndarray] = None  #: (points,) float32
    correction_length: Optional[np.ndarray] = None  #: (points,) float32, L
    residual: Optional[np.ndarray] = None  #: (points,) float32, field minus iso value, scalar unit
    boundary_flag: Optional[np.ndarray] = None  #: (points,) uint8, see mcor.h
    iso_value: Optional[np.ndarray] = None  #: (points,) float64, scalar unit
    nearest_particle: Optional[np.ndarray] = None  #: (points,) int64, index of a fluid particle
    #: {name: (points,) or (points, components)}: float64 means of real arrays, others as they are
    attributes: Dict[str, np.ndarray] = dataclass_field(default_factory=dict)
    #: {name: particle} of the attributes that are left out, being NaN or infinite there
    left_out: Dict[str, int] = dataclass_field(default_factory=dict)
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)  #: mcor_statistics

    def to_pyvista(self):
        """A pyvista.PolyData with all arrays of the surface."""
        import pyvista

        faces = np.insert(self.triangles.astype(np.int64), 0, 3, axis=1).ravel()
        mesh = pyvista.PolyData(self.points, faces) if len(faces) else pyvista.PolyData(self.points)
        for name, array in self.attributes.items():
            mesh.point_data[name] = array
        for name in c.SHAPES["mcor_surface"]:
            array = getattr(self, name, None)
            if name not in ("points", "triangles", "attributes") and isinstance(array, np.ndarray):
                mesh.point_data["".join(part.capitalize() for part in name.split("_"))] = array
        if self.normals is not None:
            mesh.point_data.active_normals_name = "Normals"
        mesh.set_active_scalars(None)  # colours are for the user to choose
        return mesh


@dataclass
class Samples:
    """The field at points. Values are 0 where the field is not valid."""

    weight_sum: np.ndarray  #: (points,) float64, of fluid particles
    valid: np.ndarray  #: (points,) bool: the weight sum is not below node_threshold
    values: Dict[str, np.ndarray]  #: {name: (points,) or (points, components)} float64
    gradients: Dict[str, np.ndarray]  #: {name: (points, 3) or (points, components, 3)}, per L
    weight_gradient: Optional[np.ndarray] = None  #: (points, 3), 1 / L
    left_out: Dict[str, int] = dataclass_field(default_factory=dict)
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)


@dataclass
class Derivatives:
    """Gradients at the particles."""

    gradients: Dict[str, np.ndarray]  #: {name: (particles, 3) or (particles, components, 3)}, per L
    corrected: np.ndarray  #: (particles,) bool: where the corrected form was taken
    left_out: Dict[str, int] = dataclass_field(default_factory=dict)
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)


def _prepare(positions, attributes, solid, quantities, options):
    arguments = Arguments(positions)
    arguments.set_quantities(quantities)
    arguments.set_solid(solid)
    names = arguments.set_attributes(attributes)
    arguments.set_options(options)
    return arguments, names


def _warn(missing):
    for name, particle in missing.items():
        warnings.warn(f"The attribute '{name}' is NaN or infinite at particle {particle} and was left out. "
                      "Correct its values, or do not ask for it.", stacklevel=3)


def _run(arguments, context, device, progress, call, free):
    own = context is None
    if not own and not isinstance(context, Context):
        raise InvalidArgument(f"The context is a {type(context).__name__}; it must be a Context.")
    context = default_context(device) if own else context
    try:
        context.run(call, arguments.options, progress, free)
    finally:
        if own:
            context.release_memory()


def isosurface(positions: ArrayLike, scalar: Optional[ArrayLike] = None, *,
               iso: Union[None, float, Sequence[float]] = None,
               smoothing_length: Optional[ArrayLike] = None,
               volume: Optional[ArrayLike] = None,
               mass: Optional[ArrayLike] = None,
               density: Optional[ArrayLike] = None,
               attributes: Optional[Attributes] = None,
               scalar_dot: Optional[ArrayLike] = None,
               solid: Optional[ArrayLike] = None,
               context: Optional[Context] = None,
               device: Union[None, str, int] = None,
               progress: Optional[Progress] = None,
               **options: Unpack[Options]) -> Surface:
    """The isosurface of a quantity that particles carry.

    positions: (particles, 3), length unit L. float32 and float64 arrays in C order are used where
        they lie; so are all arrays below.
    scalar: (particles,), or (particles, components): then its magnitude, or one component
        (scalar_component=0, 1, ...), or its dot product with scalar_dot.
    iso: the value of the scalar on the surface, or several. `iso_values` is another name.
    smoothing_length: (particles,) or one value, L, > 0; with smoothing_length_is_support_radius=True
        it is the kernel's support radius; with estimate_smoothing_length=True it is not needed.
    volume, or mass and density, or mass alone: (particles,) or one value, > 0, of units that give
        L^3; without them volumes follow from the particles' distances.
    attributes: {name: array} to be carried to the surface: real ones as the mean of the particles
        around, integers and bools from the nearest particle.
    solid: (particles,), nonzero for walls. They take no part in the field.
    context: a Context, to keep particles on the device between calls; else one of our own per
        device, which keeps compiled programs alone.
    device: a number or part of a name as in devices(), where no context is given.
    progress: called with a fraction from 0 to 1 and the phase; a true result ends the run.

    Further options, as mcor.h names them:

    {options}
    Raises an Error (InvalidArgument, InvalidData, OutOfCapacity, DeviceError, Cancelled). Other
    threads go on meanwhile; Ctrl-C ends the run.
    """
    words = dict(options)
    iso = words.pop("iso_values", iso)
    attributes = as_named(attributes)
    real = {name: array for name, array in attributes.items() if is_real(array)}
    arguments, names = _prepare(positions, real, solid, {
        "smoothing_length": smoothing_length, "volume": volume, "mass": mass, "density": density}, words)
    free_surface_wanted = arguments.options.field == c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
    _set_scalar(arguments, scalar, scalar_dot, free_surface_wanted)
    if iso is None:
        raise InvalidArgument("Give the iso value: iso=1.0, or several of them.")
    arguments.set_iso_values(iso)
    wanted = bool(arguments.options.nearest_particle)
    from_nearest = _from_nearest(attributes, real, arguments)
    surface = c.mcor_surface()

    def free():
        lib.mcor_free_surface(ctypes.byref(surface))

    _run(arguments, context, device, progress, lambda handle: lib.mcor_extract(
        handle, ctypes.byref(arguments.input), ctypes.byref(arguments.options), ctypes.byref(surface)), free)
    try:
        return _surface(surface, arguments, names, attributes, from_nearest, wanted)
    finally:
        free()


def _set_scalar(arguments, scalar, scalar_dot, free_surface_wanted):
    if free_surface_wanted:
        return
    if scalar is None:
        raise InvalidArgument('Give the scalar to contour, or call free_surface().')
    arguments.input.scalar = arguments.per_particle(scalar, "scalar")
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


def _surface(surface, arguments, names, attributes, from_nearest, nearest_wanted):
    count = surface.point_count
    arrays = take_all("mcor_surface", surface,
                      {"point_count": count, "triangle_count": surface.triangle_count})
    if arrays["points"] is None:
        arrays["points"], arrays["triangles"] = np.empty((0, 3)), np.empty((0, 3), np.int32)
    means = take_each(surface.attributes, names, arguments.components, count)
    carried = {}
    for name in attributes:
        if name in means:
            carried[name] = means[name]
        elif name in from_nearest and arrays["nearest_particle"] is not None:
            carried[name] = attributes[name][arrays["nearest_particle"]]
        elif name in from_nearest:
            carried[name] = attributes[name][:0]
    if not nearest_wanted:
        arrays["nearest_particle"] = None
    known = {name: array for name, array in arrays.items() if name in Surface.__dataclass_fields__}
    result = Surface(**known, attributes=carried, left_out=left_out(surface, names),
                     statistics=statistics(surface.statistics))
    for name in arrays.keys() - known.keys():  # what a newer core adds
        setattr(result, name, arrays[name])
    _warn(result.left_out)
    return result


def free_surface(positions: ArrayLike, *, iso: Union[float, Sequence[float]] = 0.5,
                 smoothing_length: Optional[ArrayLike] = None,
                 volume: Optional[ArrayLike] = None,
                 mass: Optional[ArrayLike] = None,
                 density: Optional[ArrayLike] = None,
                 attributes: Optional[Attributes] = None,
                 solid: Optional[ArrayLike] = None,
                 context: Optional[Context] = None,
                 device: Union[None, str, int] = None,
                 progress: Optional[Progress] = None,
                 **options: Unpack[Options]) -> Surface:
    """The surface of the fluid: where the sum of the particles' weights is `iso`.

    The sum has no unit: it is about 1 inside the fluid and falls to 0 outside. Arguments are those
    of isosurface().
    """
    return isosurface(positions, None, iso=iso, smoothing_length=smoothing_length, volume=volume,
                      mass=mass, density=density, attributes=attributes, solid=solid, context=context,
                      device=device, progress=progress, **{**options, "field": "weight_sum"})


def probe(positions: ArrayLike, points: ArrayLike, *,
          smoothing_length: Optional[ArrayLike] = None,
          volume: Optional[ArrayLike] = None,
          mass: Optional[ArrayLike] = None,
          density: Optional[ArrayLike] = None,
          attributes: Optional[Attributes] = None,
          solid: Optional[ArrayLike] = None,
          context: Optional[Context] = None,
          device: Union[None, str, int] = None,
          progress: Optional[Progress] = None,
          **options: Unpack[Options]) -> Samples:
    """The field of the attributes, and with gradients=True its gradients, at any points.

    points: (points, 3), L; one that is not finite is not valid. attributes: {name: (particles,) or
    (particles, components)}. field="sum" gives the plain sum in place of Shepard's mean. The other
    arguments are those of isosurface().
    """
    attributes = as_named(attributes)
    arguments, names = _prepare(positions, attributes, solid, {
        "smoothing_length": smoothing_length, "volume": volume, "mass": mass, "density": density}, options)
    where = as_points(points, "points", "(points, 3)")
    view, samples = arguments.view(where, "points"), c.mcor_samples()

    def free():
        lib.mcor_free_samples(ctypes.byref(samples))

    _run(arguments, context, device, progress, lambda handle: lib.mcor_probe(
        handle, ctypes.byref(arguments.input), ctypes.byref(arguments.options), ctypes.byref(view),
        len(where), ctypes.byref(samples)), free)
    try:
        arrays = take_all("mcor_samples", samples, {"count": samples.count})
        n = len(where)
        result = Samples(
            weight_sum=_or_zeros(arrays["weight_sum"], n), valid=_or_zeros(arrays["valid"], n).astype(bool),
            values=take_each(samples.values, names, arguments.components, samples.count),
            gradients=take_each(samples.gradients, names, arguments.components, samples.count, (3,)),
            weight_gradient=arrays["weight_gradient"], left_out=left_out(samples, names),
            statistics=statistics(samples.statistics))
    finally:
        free()
    _warn(result.left_out)
    return result


def _or_zeros(array, count):
    return np.zeros(count) if array is None else array


def derivatives(positions: ArrayLike, attributes: Attributes, *, form: Union[str, int] = "corrected",
                smoothing_length: Optional[ArrayLike] = None,
                volume: Optional[ArrayLike] = None,
                mass: Optional[ArrayLike] = None,
                density: Optional[ArrayLike] = None,
                solid: Optional[ArrayLike] = None,
                context: Optional[Context] = None,
                device: Union[None, str, int] = None,
                progress: Optional[Progress] = None,
                **options: Unpack[Options]) -> Derivatives:
    """SPH gradients of the attributes at the particles themselves.

    attributes: {name: (particles,) or (particles, components)}. form: "corrected" (exact for linear
    attributes) or "standard". The other arguments are those of isosurface(). For divergence,
    vorticity and the like give the gradients of a velocity to flow().
    """
    attributes = as_named(attributes)
    arguments, names = _prepare(positions, attributes, solid, {
        "smoothing_length": smoothing_length, "volume": volume, "mass": mass, "density": density}, options)
    from ._arrays import number

    chosen, result = number("form", "mcor_gradient", form), c.mcor_derivatives()

    def free():
        lib.mcor_free_derivatives(ctypes.byref(result))

    _run(arguments, context, device, progress, lambda handle: lib.mcor_derive(
        handle, ctypes.byref(arguments.input), ctypes.byref(arguments.options), chosen,
        ctypes.byref(result)), free)
    try:
        corrected = take(result.corrected, (result.count,))
        found = Derivatives(
            gradients=take_each(result.gradients, names, arguments.components, result.count, (3,)),
            corrected=_or_zeros(corrected, arguments.count).astype(bool), left_out=left_out(result, names),
            statistics=statistics(result.statistics))
    finally:
        free()
    _warn(found.left_out)
    return found


def flow(gradients: ArrayLike) -> Dict[str, np.ndarray]:
    """What velocity gradients J say of a flow.

    gradients: (particles, 3, 3), d component / d axis, as of derivatives(). Returns "divergence" (tr
    J), "vorticity" (the curl, (particles, 3)), "q_criterion", "lambda2" and "strain_rate"
    ((particles, 3, 3)), in the unit of J or its square.
    """
    matrices = contiguous(gradients, "array of velocity gradients").astype(np.float64)
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


def _describe_options():
    """The header's own words."""
    lines = []
    for name in c.Options.__annotations__:
        struct = "mcor_options" if name in c.KINDS["mcor_options"] else "mcor_input"
        kind = c.KINDS[struct][name]
        words = ""
        if kind in c.ENUMS:
            from ._arrays import _words

            words = " | ".join(f'"{word}"' for word in _words(
                [k for k in c.ENUMS[kind] if not k.endswith("_COUNT")])) + ". "
        words += c.COMMENTS[struct][name] or c.COMMENTS["mcor_surface"].get(name) or "see above" * (not words)
        lines += textwrap.wrap(f"{name}: {words}", 96, subsequent_indent="    ")
    return "\n    ".join(lines)


def _show_options(function):
    """Each option as a keyword in help() and in editors, with its default."""
    defaults = c.mcor_options()
    lib.mcor_set_default_options(ctypes.byref(defaults))
    signature = inspect.signature(function)
    named = [p for p in signature.parameters.values() if p.kind != p.VAR_KEYWORD]

    def default(name):
        value = -1 if name == "scalar_component" else getattr(defaults, name, 0)
        return None if isinstance(value, ctypes.Array) else value

    more = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=default(name))
            for name, kind in c.Options.__annotations__.items() if name not in signature.parameters]
    function.__signature__ = signature.replace(parameters=named + more)


for _function in (isosurface, free_surface, probe, derivatives):
    _show_options(_function)
isosurface.__doc__ = (isosurface.__doc__ or "").replace("{options}", _describe_options() + "\n")
