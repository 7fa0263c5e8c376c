# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""isosurface, free_surface, probe, derivatives, widening, project, gauge, flux, flow: one call of the core each."""
from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Dict, Optional, Sequence, Union

import numpy as np

from . import _structs as c
from ._arrays import (SUMMED, as_bytes, as_named, as_points, contiguous, find_iso_value, left_out, number, set_option, statistics, take, take_all,
                      take_each, take_rows)
from ._call import called, of_particles, prepare, warn_of_missing
from ._library import ERRORS, InvalidArgument, describe_warnings, lib, say, warn, warn_of_particles
from ._options import DERIVATIVES, FREE_SURFACE, GAUGE, ISOSURFACE, PROBE, PROJECT, WIDENING
from ._surface import STATES, Derivatives, Fluxes, Gauges, Projection, Samples, Surface
from ._units import scalar_and_iso, without_unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Literal, Unpack

    from ._call import Attributes, Keywords, Positions


@of_particles(ISOSURFACE)
def isosurface(positions: Positions, scalar: Optional[ArrayLike], iso: Union[None, float, Sequence[float]] = None, *,
               attributes: Optional[Attributes] = None,
               scalar_dot: Optional[ArrayLike] = None,
               **words: Unpack[Keywords]) -> Surface:
    """The isosurface of a quantity that particles carry.

    Example: surface = isosurface(x, speed, 1.0, smoothing_length=h, mass=m, density=rho, attributes={"speed": speed})

    Returns a Surface: points, triangles, normals, attributes, statistics, and the arrays that were asked for; lines in two
    dimensions. Points are float32 if the positions are; each attribute of the surface is float32 if the given attribute is.

    positions: (particles, 3), length unit L. Or particles of io.read(): scalar is then an array's name, and attributes is a
        list of names. All arguments that are arrays may also be lists, data frames, or arrays that support DLPack. Arrays of
        float32 and float64 in C order are not copied.
    scalar: (particles,), or (particles, components), whose magnitude is taken, or one component
        (scalar_component=0, 1, ...), or the dot product with scalar_dot.
    iso: the value of the scalar on the surface, or a list of values; by default a value near the median.
    smoothing_length: (particles,) or one value, L, greater than 0; with
        smoothing_length_is_support_radius=True it is the radius at which the kernel ends; with
        estimate_smoothing_length=True it is not needed.
    volume, or mass and density, or mass alone: (particles,) or one value, greater than 0, of units
        that give L^3; without them, and with volume="computed", volumes follow from the particles'
        distances, so that drops of few particles and sheets have a surface, too.
    attributes: {name: array}, or a data frame, to be carried to the surface: real ones as the mean of
        the particles around, integers and bools from the nearest particle.
    scalar_dot: a second vector for each particle; the scalar is then the dot product.
    solid: (particles,), True or not 0 for walls. Walls take no part in the field.
    fluid: ("Type", 0) or "Type=0": particles with any other value in this array of the file or of the attributes are solid.
        (array, 0) gives the array itself. "auto": an array with a usual name tells the fluid, if it does so clearly.
    outputs: further arrays of the surface, by their names below: outputs="residual", or ("residual", "gradients"); each is
        also a keyword: residual=True.
    within: six bounds, as in box, L: particles outside are left out, whatever their values are; sides may be infinite.
    only: {"Type": 1}, {"Type": (1, 3)} or {"Species": "O"}: only particles with this value, or with a value from the lowest
        to the highest one, in this array of the file or of the attributes are taken. If there are several names, a particle
        must satisfy all of them. Instead, an array (particles,) may mark the particles that are taken by True.
    context: a Context, to keep particles on the device between calls; by default the package
        has a context for each device, which keeps only compiled programs.
    device: a number or part of a name as in devices(), if no context is given.
    progress: True shows a bar; or a function, called with a fraction from 0 to 1 and the name of the
        phase, which ends the run by returning False, or by an exception.

    {options}

    Arrays with units, of pint, unyt or astropy: lengths are converted to the unit of the positions;
    volumes, or mass / density, to this unit cubed; iso to the scalar's unit. Results are plain numbers
    in these units.
    A call refuses arrays with units together with arrays without units.

    Raises an Error (InvalidArgument, InvalidData, OutOfCapacity, DeviceError, Cancelled). Input that
    is legal, but probably a mistake, gives an InputWarning. Other threads run during the call; Ctrl-C ends it.
    """
    return _extract(positions, iso, attributes, words, scalar, scalar_dot)


def _extract(positions, iso, attributes, words, scalar=None, scalar_dot=None):
    attributes = as_named(attributes)
    real = {name: array for name, array in attributes.items() if array.dtype.kind == "f"}
    scalar, scalar_dot, iso = scalar_and_iso(scalar, scalar_dot, iso)
    is_free = number("field", "mcor_field", words.get("field", "shepard")) == c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
    if scalar is None and not is_free:
        raise InvalidArgument('Give the scalar to contour, or call free_surface().')
    if isinstance(scalar, str) and scalar != SUMMED:
        raise InvalidArgument(f"The scalar is '{scalar}'; it must be an array of numbers, or \"{SUMMED}\", summed from masses.")
    if is_free and scalar is not None:
        warn('The scalar is not used, because field is "weight_sum", which is the free surface. Leave one of them out.')
    roles = {} if is_free else {"wants": ["scalar"], "scalar": scalar, "scalar_dot": scalar_dot}
    arguments = prepare(positions, words, real, attributes, **roles)
    arguments.input.scalar.name = None  # Then the core says "the scalar".
    if iso is None:
        found = ((), 0.5) if is_free else find_iso_value(arguments.input)
        iso = [found[1]] if found else []
    arguments.set_iso_values(iso)
    wanted = bool(arguments.options.nearest_particle)
    from_nearest = [name for name in attributes if name not in real]
    for name in from_nearest:
        arguments.options.nearest_particle = 1
        if attributes[name].ndim == 0 or len(attributes[name]) != arguments.count:
            raise InvalidArgument(f"The attribute '{name}' has the shape {attributes[name].shape} for "
                                  f"{arguments.count} particles.")
    with called(lib.mcor_extract, c.mcor_surface, arguments) as surface:
        found = take_surface(surface, arguments)
        sentences = describe_warnings(arguments, surface)
    found.points = found.points.astype(arguments.positions.dtype, copy=False)
    for name in from_nearest:
        found.attributes[name] = attributes[name][[] if found.nearest_particle is None else found.nearest_particle]
    found.attributes = {name: found.attributes[name] for name in attributes if name in found.attributes}
    if not wanted:
        found.nearest_particle = None
    warn_of_missing(found.left_out)
    for sentence in list(sentences.values()) or [_describe_empty(arguments, found)]:
        warn(sentence)
    return found


def _describe_empty(arguments, found):
    """Returns a sentence about an empty surface that the core does not explain; "" if the surface is not empty, if there is no
    fluid, or if a box is given, because the box may lie elsewhere."""
    values, options, n = arguments.options.iso_values, arguments.options, found.statistics
    if len(found.points) or not arguments.input.count or any(options.box):
        return ""
    if not options.iso_count:
        return "There is no surface: the list of iso values is empty."
    if n["cube_size"] > 2 * n["smoothing_length_max"]:
        return (f"There is no surface: cubes of {n['cube_size']:.6g} may be too large for smoothing lengths of up to "
                f"{n['smoothing_length_max']:.6g}. Give a smaller cube_size or cube_size_factor.")
    iso = ", ".join(f"{values[i]:.6g}" for i in range(options.iso_count))
    if options.field == c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]:
        return (f"There is no surface: the sum of the weights crosses {iso} nowhere. It is about 1 in the fluid and falls to "
                "0 outside, so an iso value of 0.5 is usual. A periodic box full of fluid has no free surface.")
    if n["scalar_min"] == n["scalar_max"]:
        return f"There is no surface: the scalar is {n['scalar_min']:.6g} at all fluid particles."
    return (f"There is no surface: the field crosses {iso} nowhere, although the scalar goes from {n['scalar_min']:.6g} to "
            f"{n['scalar_max']:.6g}. Perhaps the particles there are too few or too far apart for the node threshold.")


def take_surface(surface, arguments):
    """Makes a Surface from the core's mcor_surface."""
    count, arrays = surface.point_count, take_all(surface)
    for name, kind in (("points", np.float64), ("triangles", np.int32)):
        arrays[name] = np.empty((0, 3), kind) if arrays[name] is None else arrays[name]
    missing, attributes = left_out(surface, arguments), take_each(surface.attributes, arguments, (count,))
    if arguments.input.widening.data and surface.attributes:
        arrays["widening"] = take(surface.attributes[len(arguments.kinds)], (count,))
    return Surface(**arrays, attributes={name: attributes[name] for name in attributes if name not in missing},
                   left_out=missing, statistics=statistics(surface.statistics))


@of_particles(FREE_SURFACE)
def free_surface(positions: Positions, iso: Union[float, Sequence[float]] = 0.5, *,
                 attributes: Optional[Attributes] = None,
                 **words: Unpack[Keywords]) -> Surface:
    """The surface of the fluid: where the sum of the particles' weights is `iso`.

    Example: free_surface(x, smoothing_length=h, mass=m, density=rho).save("water.ply")

    Returns a Surface, as isosurface() does.

    The sum has no unit: it is about 1 inside the fluid and falls to 0 outside. The arguments are as in isosurface();
    most people need only some of the first ones.

    fluid: ("Type", 0): particles with any other value in this array are solid.
    smoothing_length: (particles,) or one value, L, unless a file has it.
    outputs: further arrays of the surface, by their names below: outputs=("residual", "gradients").

    {options}
    """
    return _extract(positions, iso, attributes, {**words, "field": "weight_sum"})


@of_particles(PROBE)
def probe(positions: Positions, points: ArrayLike, *,
          attributes: Optional[Attributes] = None,
          **words: Unpack[Keywords]) -> Samples:
    """The field of the attributes, and with gradients=True its gradients, at any points.

    Example: probe(x, grid, smoothing_length=h, attributes={"speed": speed}).values["speed"]

    Returns Samples: values, gradients, weight_sum and valid, in the shape (...) of the points. Where a point is not valid,
    because there is no fluid, values are NaN.

    points: (..., 3), L; a point that is not finite is not valid.
    attributes: {name: (particles,) or (particles, components)}, or a data frame.

    The other arguments are those of isosurface().

    {options}
    """
    arguments = prepare(positions, words, as_named(attributes), nothing="no point is valid")
    where = contiguous(arguments.units.lengths(points, "array of points"), "array of points")
    is_whole = where.shape[-1:] == (3,)
    shape = where.shape[:-1] if is_whole else (0,)
    where = as_points(where.reshape(-1, 3) if is_whole else where, "points", "(..., 3)")
    view = arguments.view(where, "points")
    with called(lib.mcor_probe, c.mcor_samples, arguments, ctypes.byref(view), len(where)) as samples:
        arrays = take_all(samples)
        valid = _or_zeros(arrays["valid"], len(where)).astype(bool).reshape(shape)
        result = Samples(
            weight_sum=_or_zeros(arrays["weight_sum"], len(where)).reshape(shape), valid=valid,
            values=take_each(samples.values, arguments, shape),
            gradients=take_each(samples.gradients, arguments, shape, (3,)),
            weight_gradient=None if arrays["weight_gradient"] is None else arrays["weight_gradient"].reshape(*shape, 3),
            left_out=left_out(samples, arguments),
            statistics=statistics(samples.statistics))
    for values in [*result.values.values(), *result.gradients.values()]:
        values[~valid] = np.nan
    warn_of_missing(result.left_out)
    return result


def _or_zeros(array, count):
    return np.zeros(count) if array is None else array


@of_particles(DERIVATIVES)
def derivatives(positions: Positions, attributes: Attributes, *, form: Literal["corrected", "standard"] = "corrected",
                **words: Unpack[Keywords]) -> Derivatives:
    """SPH gradients of the attributes at the particles themselves.

    Example: flow(derivatives(x, {"v": velocity}, smoothing_length=h).gradients["v"])["vorticity"]

    Returns Derivatives: gradients, {name: (particles, 3) or (particles, components, 3)}, and at which particles they are corrected.

    attributes: {name: (particles,) or (particles, components)}, or a data frame.
    form: "corrected" (exact for linear attributes) or "standard".

    The other arguments are those of isosurface(). flow() makes divergence, vorticity
    and the like from the gradients of a velocity.

    {options}
    """
    arguments = prepare(positions, words, as_named(attributes), nothing=None)
    chosen = number("form", "mcor_gradient", form)
    with called(lib.mcor_derive, c.mcor_derivatives, arguments, chosen) as result:
        found = Derivatives(
            gradients=take_each(result.gradients, arguments, (result.count,), (3,)),
            corrected=_or_zeros(take_all(result)["corrected"], arguments.count).astype(bool), left_out=left_out(result, arguments),
            statistics=statistics(result.statistics))
    warn_of_missing(found.left_out)
    return found


@of_particles(WIDENING)
def widening(positions: Positions, iso: Optional[float] = 0.5, *, widen: float = 2,
             return_volume: bool = False,
             **words: Unpack[Keywords]) -> Any:
    """The factors by which isosurface() and free_surface() multiply smoothing lengths if widen is above 1.

    Example: s = widening(x, smoothing_length=h, volume=v, widen=2)

    Returns s, (particles,) float64, from 1 to widen. With return_volume=True, returns s and the volumes, which are
    computed from the smoothing lengths h themselves, or s and None if volumes are given. A surface made with s * h
    and these volumes is, bit for bit, the surface made with widen, for the same cube_size and level_limit=0.

    iso: the greatest iso value of the free surface; None: the factors are for the surface of a scalar.
    return_volume: whether the volumes are returned, too.

    The other arguments are those of isosurface().

    {options}
    """
    arguments = prepare(positions, {**words, "widen": widen}, nothing=None)
    if iso is not None:
        arguments.options.field = c.ENUMS["mcor_field"]["MCOR_WEIGHT_SUM"]
        arguments.set_iso_values(iso)
    with called(lib.mcor_widen, c.mcor_widening, arguments) as result:
        warn_of_particles(arguments, result.statistics)
        factors = take(result.factor, (result.count,))
        return (factors, take(result.volume, (result.count,))) if return_volume else factors


@of_particles(PROJECT)
def project(positions: Positions, scalar: Optional[ArrayLike] = None, *,
            direction: Union[None, str, Sequence[float]] = None,
            resolution: int = 512,
            weighted_by: Optional[ArrayLike] = None,
            box: Optional[Sequence[float]] = None,
            **words: Unpack[Keywords]) -> Projection:
    """Column densities, or integrals of another scalar along lines of sight, as an image.

    Example: image = project(x, smoothing_length=h, mass=m, direction="z"); plt.imshow(image.values, origin="lower", extent=image.extent)

    Returns a Projection: values and extent of the image, exact means over pixels, so that no mass is lost.

    scalar: what is integrated: (particles,), or (particles, components), whose magnitude is taken, or one component.
        By default the density: the image is then the mass per area, which needs masses, or densities.
    direction: the direction of the lines of sight: "x", "y", "z", or any three numbers; by default the constant axis of particles in
        a plane, else z.
    resolution: pixels along the longer side of the image.
    weighted_by: (particles,): the image is the scalar's mean with these weights, such as the masses. NaN where there is
        nothing.
    box: (x0, x1, y0, y1, z0, z1): what is seen; sides may be infinite. By default the period, or
        all that particles reach. A particle counts, with its whole kernel, if its position is in the box; if the lines of
        sight are along x, y or z, only the position along this axis must be in the box.

    The other arguments are those of isosurface().

    {options}
    """
    if isinstance(scalar, str) and scalar == SUMMED:  # If this array is missing, the sum of the particles' masses is used.
        scalar = None
    arguments = prepare(positions, words, wants=["column"], nothing="nothing is seen", scalar=without_unit(scalar))
    if isinstance(direction, str):
        along = [float(direction == axis) for axis in "xyz"]
    else:
        along = [0.0] * 3 if direction is None else np.ravel(contiguous(direction, "direction")).tolist()
    if len(along) != 3 or direction is not None and not any(along):
        raise InvalidArgument(f"direction is {direction!r}; it must be \"x\", \"y\", \"z\" or three numbers that are not all 0.")
    view = c.mcor_view()
    view.direction[:] = along
    set_option(view, "box", "double[6]", arguments.units.lengths(box, "box"))
    view.resolution = number("resolution", "int", resolution)
    if weighted_by is not None:
        view.weight = arguments.per_particle(without_unit(weighted_by), "weight")
    with called(lib.mcor_project, c.mcor_projection, arguments, ctypes.byref(view)) as found:
        columns, rows = found.size
        values = take(found.values, (rows, columns))
        low, pixel = found.low, found.pixel
        return Projection(
            values=np.zeros((0, 0)) if values is None else values, axes=np.array(found.axes).reshape(3, 3), depth=low[2],
            extent=np.array([low[0], low[0] + columns * pixel[0], low[1], low[1] + rows * pixel[1]]),
            statistics=statistics(found.statistics))


def _warn_of_dry(arguments, noun, names, outside):
    """Warns of places that no particle reaches. If there is no fluid, another warning says so."""
    dry = [name for name, is_dry in zip(names, outside) if is_dry and arguments.input.count]
    if dry:
        warn(say("PLACE_DRY", noun, dry[0]) if len(dry) == 1 else say("PLACES_DRY", len(dry), len(names), noun, dry[0]))


@of_particles(GAUGE)
def gauge(positions: Positions, lines: Any, iso: float = 0.5, **words: Unpack[Keywords]) -> Gauges:
    """Water levels: all places where straight lines cross the free surface.

    Example: gauge(x, {"mast": ((0.5, 0, 0), (0.5, 1, 0))}, smoothing_length=h, mass=m, density=rho).last

    Returns Gauges: state, first, last, depth and place of each line, and all crossings by name.

    lines: (lines, 2, 3), L: the beginning and the end of each; or one line, (2, 3); or {name: (from, to)}.
    iso: the sum of the weights at which the fluid ends, as in free_surface(); it must be above 0.

    Solids count in the sum of the weights, and the fluid ends where solids weigh more than fluid (wall_share). The
    other arguments are those of isosurface().

    {options}
    """
    arguments = prepare(positions, words, nothing="all gauges are dry")
    names = [str(name) for name in lines] if isinstance(lines, Mapping) else None
    given = list(lines.values()) if isinstance(lines, Mapping) else lines
    array = contiguous(arguments.units.lengths(given, "array of lines"), "array of lines").astype(np.float64)
    if array.size == 0:
        array = array.reshape(0, 2, 3)
    if array.ndim == 2 and names is None:
        array = array[np.newaxis]
    if array.ndim != 3 or array.shape[1:] != (2, 3):
        raise InvalidArgument(f"Lines have the shape (lines, 2, 3), from and to each, not {array.shape}.")
    names = names or [str(i) for i in range(len(array))]
    arguments.set_iso_values(iso)
    structures = (c.mcor_gauge_line * max(len(array), 1))()
    for line, name, ends in zip(structures, names, array):
        getattr(line, "from")[:], line.to[:], line.name = ends[0], ends[1], as_bytes(name)
    with called(lib.mcor_gauge, c.mcor_gauges, arguments, structures, len(array)) as found:
        rows, crossings = take_rows(found.readings, found.count), take_rows(found.crossings, found.crossing_count)
        columns = {name: rows[name].copy() for name in ("first", "last", "depth", "place")}
        _warn_of_dry(arguments, "gauge", names, rows["outside"])
        return Gauges(
            names=names, state=STATES[rows["state"]], outside=rows["outside"].astype(bool), **columns,
            crossings={name: crossings[row["first_crossing"]:][:row["crossing_count"]].copy() for name, row in zip(names, rows)},
            statistics=statistics(found.statistics))


FORMS = ('(3, 3): a rectangle\'s corner and two ends; ("disc", centre, normal, radius); '
         '("box", six bounds); (n, 3, 3): triangles; (2, 3) or (n, 2, 3): lines in two dimensions')


def _as_section(section, name, units):
    """Returns a section's shape (a number of mcor_section_shape); its points, (n, 3), or a disc's centre and normal; and a disc's radius, or 0."""
    def numbers(values, shape):
        array = contiguous(values, "section").astype(np.float64)
        if array.shape != shape:
            raise InvalidArgument(f"Section '{name}' has an array of the shape {array.shape} where it is {shape}. A section is "
                                  f"{FORMS}.")
        return array

    kinds = c.ENUMS["mcor_section_shape"]
    if isinstance(section, (tuple, list)) and len(section) and isinstance(section[0], str):
        lengths = [units.lengths(each, "section") for each in section[1:2] + section[3:]]
        if section[0] == "disc" and len(section) == 4:
            points = [numbers(lengths[0], (3,)), numbers(without_unit(section[2]), (3,))]
            return kinds["MCOR_SECTION_DISC"], np.stack(points), float(numbers(lengths[1], (1,))[0])
        if section[0] == "box" and len(section) == 2:
            return kinds["MCOR_SECTION_BOX"], np.ascontiguousarray(numbers(lengths[0], (6,)).reshape(3, 2).T), 0.0
        raise InvalidArgument(f"Section '{name}' begins with '{section[0]}'. A section is {FORMS}.")
    array = contiguous(units.lengths(section, "section"), "section").astype(np.float64)
    shape = {(3, 3): "RECTANGLE", (2, 3): "LINES"}.get(array.shape)
    if array.ndim == 3 and array.shape[1:] in ((3, 3), (2, 3)):
        shape = "TRIANGLES" if array.shape[1] == 3 else "LINES"
    if shape is None:
        raise InvalidArgument(f"Section '{name}' has the shape {array.shape}. A section is {FORMS}.")
    return kinds["MCOR_SECTION_" + shape], array.reshape(-1, 3), 0.0


def _as_sections(sections, units):
    """Returns the sections' names, the core's structures, and the arrays that must stay alive as long as the structures."""
    is_one = isinstance(sections, np.ndarray) or (
        isinstance(sections, (tuple, list)) and len(sections) > 0 and (isinstance(sections[0], str) or np.ndim(sections) == 2))
    if not is_one and not isinstance(sections, (Mapping, tuple, list)):
        raise InvalidArgument(f"The sections are of the type {type(sections).__name__}; they must be one section, a list of them or "
                              f"{{name: section}}. A section is {FORMS}.")
    given = [sections] if is_one else list(sections.values()) if isinstance(sections, Mapping) else list(sections)
    names = [str(name) for name in sections] if isinstance(sections, Mapping) else [str(i) for i in range(len(given))]
    made, kept = (c.mcor_section * max(len(given), 1))(), []
    for structure, section, name in zip(made, given, names):
        structure.shape, points, structure.radius = _as_section(section, name, units)
        kept.append(points)
        structure.points = points.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        structure.point_count, structure.name = len(points), as_bytes(name)
    return names, made, kept


@of_particles(GAUGE)
def flux(positions: Positions, velocity: ArrayLike, sections: Any, iso: float = 0.5, **words: Unpack[Keywords]) -> Fluxes:
    """Fluxes through sections, with errors of up to 1e-5 of the largest flux that the velocities at the section allow.

    Example: flux(x, v, {"gate": ("disc", (1, 0, 0), (1, 0, 0), 0.2)}, smoothing_length=h, mass=m, density=rho).mass_flux

    Returns Fluxes: area, volume_flux, mass_flux and velocity of each section.

    velocity: (particles, 3), L per unit of time; in two dimensions (particles, 2) will do.
    sections: one, a list of them, or {name: section}. A section is (3, 3): a rectangle's corner and two
        ends, whose cross product is the normal; ("disc", centre, normal, radius); ("box", six bounds): its
        sides, with normals outwards; (n, 3, 3): triangles, with normals by the right-hand rule,
        or outwards if they are a closed surface; in two dimensions (2, 3) or (n, 2, 3): lines, with normals
        to their right.
    iso: the sum of the weights at which the fluid ends, as in free_surface(); it must be above 0.
    density: (particles,) or one value, for mass fluxes; or mass and volume, which give it.

    Solids count in the sum of the weights, and the fluid ends where solids weigh more than fluid (wall_share). Velocity and
    density at a point are means over fluid particles only. The other arguments are those of isosurface().

    {options}
    """
    arguments = prepare(positions, words, wants=["flow"], nothing="nothing flows", velocity=velocity)
    names, array, _kept = _as_sections(sections, arguments.units)
    arguments.set_iso_values(iso)
    with called(lib.mcor_flux, c.mcor_fluxes, arguments, array, len(names)) as found:
        rows = take_rows(found.readings, found.count)
        columns = {name: rows[name].copy() for name in ("area", "volume_flux", "mass_flux", "velocity")}
        _warn_of_dry(arguments, "section", names, rows["outside"])
        return Fluxes(names=names, outside=rows["outside"].astype(bool), **columns, statistics=statistics(found.statistics))


def flow(gradients: ArrayLike) -> Dict[str, np.ndarray]:
    """Divergence, vorticity and more of a flow, by its velocity gradients J.

    Example: flow(gradients)["vorticity"]

    Returns {name: array}: "divergence" (tr J), "vorticity" (the curl, (particles, 3)), "q_criterion", "lambda2" and
    "strain_rate" ((particles, 3, 3)), in the unit of J or its square.

    gradients: (particles, 3, 3), d component / d axis, as in derivatives().
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
