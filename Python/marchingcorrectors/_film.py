# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Films in one USD file, of particles (the command surface) or of surfaces that the program wrote (the command convert)."""
import argparse
import dataclasses
import re
import sys
from functools import partial
from pathlib import Path

import numpy as np

from . import io
from ._arrays import values_of
from ._call import prepare
from ._functions import probe
from ._library import Error, InvalidArgument, in_shell, warn
from ._options import PROBE
from ._surface import CELLS, Surface
from ._usd import Film, Spray, find_velocity, is_usd
from .io._particles import TIMES, NoPoints, Particles, usual
from .io.convert import convert
from .io.vtk_files import XmlFile, list_pieces, list_times

# Options of films: name, name of the value, type, and meaning.
OPTIONS = (("--fps", "N", float, "frames of a second of film (24)"),
           ("--slow", "S", float, "seconds of film that a unit of time takes (1)"),
           ("--up", "y|z", str, "the axis that points up (z; y for SPlisHSPlasH's .bgeo)"),
           ("--meters-per-unit", "M", float, "how many metres a unit of length is (1)"),
           ("--velocity", "NAME", str, "the array that is the velocity, for motion blur (one of a usual name)"),
           ("--time-step", "DT", float, "time between files (theirs, or 1)"))


class Once(argparse.Action):
    """Refuses an option that is given twice, as the program does."""

    def __call__(self, parser, given, value, option_string=None):
        if getattr(given, self.dest) is not None:
            parser.error(f"{option_string} is given twice")
        setattr(given, self.dest, value)


def add_options(parser):
    for word, metavar, kind, text in OPTIONS:
        parser.add_argument(word, metavar=metavar, type=kind, action=Once, help="a film: " + text)


def refuse_options(given):
    """Refuses options of films if the output is a single surface, not a USD file."""
    for word in (*(option[0] for option in OPTIONS), "--spray", "--times"):
        if getattr(given, word[2:].replace("-", "_"), None) is not None:
            raise InvalidArgument(f"{word} is for films: give an output that ends in .usdc, .usda or .usd.")


def in_order(paths):
    """Sorts files by the numbers in their names, as the program does: drop_9 before drop_10."""
    return sorted(paths, key=lambda path: [(0, int(part), "") if part.isdigit() else (1, 0, part)
                                           for part in re.split(r"(\d+)", str(path))])


def run(given, inputs, steps, add):
    """Writes a film. steps: pairs (label, function); the function returns the step's particles or surface, and its time. add(film, particles
    or surface, time): adds one step, and returns a text to print. A step that fails is reported, and left out. Returns how many steps
    the film has, as text. Raises InvalidArgument at the end if a step failed, although the film of the other steps was written."""
    failed, words = 0, {name: getattr(given, name) for name in ("fps", "slow", "meters_per_unit", "velocity")}
    with Film(given.output, inputs, **{name: value for name, value in words.items() if value is not None}) as film:
        for i, (label, load) in enumerate(steps):
            try:
                said = add(film, *load())
                if not getattr(given, "quiet", False):
                    print(f"{given.output}: {label}, {said}", flush=True)
            except (Error, OSError) as error:
                failed += 1
                print(f"marchingcorrectors: step {i} ({label}): {in_shell(error)}", file=sys.stderr)
        made = film.steps
        if not made:
            raise InvalidArgument(f"{given.output} was not written, because none of its steps could be made.")
    if failed:
        raise InvalidArgument(f"{given.output} lacks {failed} of {made + failed} steps, which failed.")
    return f"{made} step{'s' * (made > 1)}"


def tell(surface, time):
    return f"time {time:g}: {len(surface.points)} points, {len(surface.triangles)} triangles"


# -- films of particles --

def run_particles(given, surface_of):
    """Makes a film of particles. surface_of(particles, more): returns the surface, and the keywords that made it. more: names of
    arrays that the surface must have, even if the user does not want them."""
    if given.spray is not None and (given.scalar is not None or given.spray < 1):
        raise InvalidArgument("--spray needs a number of particles from 1 on." if given.scalar is None else
                              "--spray is for the free surface: leave --scalar out.")
    paths = in_order(given.input)

    def load(path, step, time):
        try:
            particles = io.read(path, step=step, walls=given.walls)
        except NoPoints:
            particles = Particles(Path(path).name, "VTK", lambda: np.empty((0, 3)), {})
        return particles, time if particles.time is None or given.time_step is not None else particles.time

    def add(film, particles, time):
        film.up = given.up or film.up if film.steps else given.up or particles.up
        arrays = particles.arrays if len(particles) else {}
        velocity = find_velocity(arrays, film.velocity) if arrays else None
        surface, words = surface_of(particles, [velocity] if velocity else [])
        spray = None
        if given.spray is not None and len(particles):
            surface, spray = take_spray(surface, particles, words, min(given.iso or [0.5]), given.spray, velocity)
        wanted = set(arrays if given.attributes is None else given.attributes)
        velocities = surface.attributes.get(velocity)
        surface.attributes = {name: array for name, array in surface.attributes.items() if name in wanted}
        film.add(surface, time, velocities, spray)
        return tell(surface, time) + ("" if spray is None else f", {len(spray.positions)} particles beside them")

    stored = [(path, step) for path in paths for step in range(io.count_steps(path))]
    unit = 1.0 if given.time_step is None else given.time_step
    steps = [(Path(path).name, partial(load, path, step, i * unit)) for i, (path, step) in enumerate(stored)]
    if given.times or given.slow is not None:
        steps = between_steps(steps, given.times, (given.fps or 24.0) * (given.slow or 1.0), given.velocity)
    return run(given, [*paths, *given.walls], steps, add)


def between_steps(steps, times, rate, velocity):
    """Yields (label, function that returns particles and their time) for each of `times` or, without times, for each frame from the first
    step on. rate: frames per unit of time. The function raises an error for a step that cannot be read, and for a time outside of the
    steps. At most two steps are in memory."""
    before, number, label = None, 0, ""
    for label, load in steps:
        try:
            after = load()
        except (Error, OSError) as error:
            yield label, partial(fail, error)
            continue
        begin = after[1] if before is None else begin
        while True:
            time = float(f"{begin + number / rate:.15g}") if not times else times[number] if number < len(times) else np.inf
            if time > after[1]:
                break
            number += 1
            if time == after[1]:
                yield label, lambda: after
            elif before is None:
                yield label, partial(fail, InvalidArgument(f"The time {time:g} lies before the first step, which is at {begin:g}."))
            else:
                yield label, lambda: (between(before[0], after[0], before[1], after[1], time, velocity), time)
        before = after
    for time in (times or [])[number:]:
        yield label, partial(fail, InvalidArgument(f"The time {time:g} lies beyond the last step."))


def between(before, after, first, last, time, velocity=None):
    """Returns the particles at a time between two steps, which are at the times first and last.

    Particles are matched by their ids. Positions follow the cubic curve that has the velocities of both steps. They are linear in
    time if there are no velocities, or, with a warning, if particles move less than half or more than twice as far as the velocities
    say. Other real numbers are linear in time. Integers, and arrays that the other step lacks, are those of the nearer step. A particle that
    is in only one step exists in the half of the interval next to this step, where it moves straight on with its velocity, if both steps
    have velocities. Raises InvalidArgument if ids are missing or not unique.
    """
    share, span = (time - first) / (last - first), last - first
    near, ids = (before, after)[share >= 0.5], []
    for particles in (before, after):
        name = usual([each for each in particles.arrays if particles.arrays[each].ndim == 1], "particle_id")
        ids.append(particles.arrays[name] if name is not None else np.zeros(0, int) if not len(particles) else None)
        if ids[-1] is None or len(np.unique(ids[-1])) < len(ids[-1]):
            raise InvalidArgument(f"{particles.file} has no ids of particles (Idp, ParticleId, id, ...), or one twice, so the time "
                                  f"{time:g} between steps cannot be made. Choose times of steps, or leave --times out.")
    _, *both = np.intersect1d(*ids, return_indices=True)
    own = both[share >= 0.5]  # These particles of the nearer step are in the other one, too.
    alone = np.setdiff1d(np.arange(len(near)), own)
    name = find_velocity(near.arrays, velocity)
    name = name if all(name in each.arrays for each in (before, after)) else None

    def mix(values, own_values):
        made = np.array(own_values, copy=True)
        if made.dtype.kind == "f":
            made[own] = (1 - share) * values[0][both[0]] + share * values[1][both[1]]
        return made

    def positions():
        made = mix([before.positions, after.positions], near.positions.astype(float))
        if name is not None:
            a, b, u, v = (getattr(each, "positions")[one].astype(float) if kind else each.arrays[name][one].astype(float)
                          for kind in (True, False) for each, one in zip((before, after), both))
            moved, told = (np.linalg.norm(each, axis=1).sum() for each in (b - a, span * (u + v) / 2))
            if told / 2 <= moved <= told * 2:
                s = share
                made[own] = ((1 + 2 * s) * (1 - s) ** 2 * a + s * s * (3 - 2 * s) * b + span * s * (1 - s) * ((1 - s) * u - s * v))
            elif moved > 0:
                warn(f"From {before.file} to {after.file} particles move {moved / max(told, 1e-300):.3g} times as far as their "
                     "velocities say, so positions between are linear. Perhaps the times are in another unit.")
            made[alone] += (time - (first, last)[share >= 0.5]) * near.arrays[name][alone]
        return made.astype(near.positions.dtype)

    arrays = {each: lambda each=each: mix([before.arrays[each], after.arrays[each]], near.arrays[each])
              if each in before.arrays and each in after.arrays else near.arrays[each] for each in near.arrays}
    more = ("smoothing_length", "mass", "volume", "density", "kernel", "rho0", "support_radius", "h_factor", "solid", "period",
            "dimension", "up")
    return Particles(near.file, near.layout, positions, arrays, time=time, **{each: getattr(near, each) for each in more})


def fail(error):
    raise error


def to_times(text):
    """Returns the sorted times of a list of times and ranges BEGIN:END:STEP. Times of a range have 15 digits, so that 3 x 0.05 gives 0.15."""
    found = set()
    for part in text.split(","):
        begin, *ends = [float(each) for each in part.split(":")]
        if len(ends) not in (0, 2) or not np.isfinite([begin, *ends]).all() or ends and not (
                ends[1] and 0 <= (ends[0] - begin) / ends[1] < 1e6):
            raise ValueError(text)
        if ends:
            count = int(np.floor((ends[0] - begin) / ends[1] + 1e-9)) + 1
            found.update(float(f"{begin + i * ends[1]:.15g}") for i in range(count))
        else:
            found.add(begin)
    return sorted(found)


# -- spray: particles in small drops, or alone; a film shows them as balls, and the other particles by their surface --

SPRAY_WORDS = ("smoothing_length", "volume", "mass", "density", "solid", "fluid", "within", "only", "device")


def take_spray(surface, particles, words, iso, least, velocity=None):
    """Returns the surface without its small pieces, see small_pieces(), and the spray. Spray is the fluid particles of the small
    pieces, and fluid particles where the sum of the weights is below `iso`. If a particle is the nearest one to a point of a remaining
    piece, it is no spray, even if its sum is below `iso`, as at the tip of a piece.

    words: the keywords of the call of free_surface() that made the surface, with nearest_particle=True. least: pieces with fewer particles
    are small. velocity: the name of the array of velocities, or None.
    """
    if surface.line_offsets is not None:
        raise InvalidArgument("Spray is for three dimensions; leave --spray out.")
    kept = {name: value for name, value in words.items() if name in PROBE or name in SPRAY_WORDS}
    every, found = particles.positions, particles.words(kept)
    arguments = prepare(found.pop("positions"), found)
    given, count = arguments.input, arguments.count
    fluid = np.flatnonzero(np.ctypeslib.as_array(given.solid, (count,)) == 0) if given.solid else np.arange(count)
    volume, mass, density = (values_of(each, count) for each in (given.volume, given.mass, given.density))
    if volume is None:
        volume = mass / density if mass is not None and density is not None else (surface.statistics["smoothing_length_max"] / 1.3) ** 3
    widths = np.broadcast_to(np.cbrt(6 / np.pi * np.asarray(volume, float)), count)  # These are diameters of balls with the volumes.
    is_spray = probe(particles, every[fluid], **kept).weight_sum < iso
    label = label_pieces(surface.triangles, len(surface.points))
    small = small_pieces(surface, label, every, fluid, least)
    is_small = np.isin(label, [piece for piece, _ in small])
    is_spray &= ~np.isin(fluid, surface.nearest_particle[~is_small])
    is_spray |= np.isin(fluid, np.concatenate([np.zeros(0, int), *(own for _, own in small)]))
    surface = dataclasses.replace(surface, nearest_particle=None)
    chosen = fluid[is_spray]
    ids = usual([name for name in particles.arrays if particles.arrays[name].dtype.kind in "iu"], "particle_id")
    return without_points(surface, is_small), Spray(
        every[chosen], widths[chosen],
        None if velocity is None else particles.arrays[velocity][chosen], None if ids is None else particles.arrays[ids][chosen])


def label_pieces(triangles, count):
    """Returns a label for each point: the lowest number of a point in its piece. Triangles that share points are one piece."""
    label = np.arange(count)
    edges = np.concatenate([triangles[:, :2], triangles[:, 1:]]).astype(np.int64)
    while True:
        ends = label[edges]
        lowest = ends.min(axis=1)
        if (ends == lowest[:, None]).all():
            return label
        np.minimum.at(label, ends.ravel(), np.repeat(lowest, 2))
        while (label[label] != label).any():
            label = label[label]


def small_pieces(surface, label, positions, fluid, least):
    """Returns (piece, its particles) for each small piece: closed, with fewer than `least` particles. Particles belong to a piece if the
    piece encloses them, or if they are nearest to one of its points. Also lists a cavity if its bounds lie in those of a small piece."""
    piece = label[surface.triangles[:, 0]]
    corners = surface.points[surface.triangles].astype(float)
    volume = np.bincount(piece, np.linalg.det(corners), len(label))
    nearest = np.unique(np.stack([label, surface.nearest_particle], axis=1), axis=0)
    begins = np.searchsorted(nearest[:, 0], np.arange(len(label) + 1))
    order, along = np.argsort(piece, kind="stable"), fluid[np.argsort(positions[fluid, 0], kind="stable")]
    ends = np.searchsorted(piece[order], np.arange(len(label) + 1))
    found, x = [], positions[along, 0]
    for each in np.flatnonzero((np.diff(begins) > 0) & (np.diff(begins) < least) & (np.diff(ends) > 0)):
        own = order[ends[each]:ends[each + 1]]
        low, high = corners[own].min(axis=(0, 1)), corners[own].max(axis=(0, 1))
        near = along[np.searchsorted(x, low[0]):np.searchsorted(x, high[0], "right")]
        near = near[((positions[near] >= low) & (positions[near] <= high)).all(axis=1)]
        if is_closed(surface.triangles[own]):
            inside = near[encloses(corners[own], positions[near].astype(float))]
            found.append((each, np.union1d(inside, nearest[begins[each]:begins[each + 1], 1]), low, high))
    small = [one for one in found if volume[one[0]] > 0 and len(one[1]) < least]
    small += [one for one in found if volume[one[0]] <= 0 and any(
        (one[2] >= other[2]).all() and (one[3] <= other[3]).all() for other in small)]
    return [one[:2] for one in small]


def is_closed(triangles):
    """Returns whether each edge has a triangle on both sides."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    there, back = (np.sort(edges[:, i] << 32 | edges[:, 1 - i]) for i in range(2))
    return np.array_equal(there, back)


def encloses(corners, points):
    """Returns, for each point, whether the triangles surround it: their solid angles add up to a full sphere."""
    a, b, c = np.moveaxis(corners[None] - points[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(each, axis=-1) for each in (a, b, c))
    dot = lambda one, other: np.einsum("...i,...i", one, other)  # noqa: E731
    angle = np.arctan2(dot(a, np.cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    return np.abs(angle.sum(axis=1)) > np.pi


def without_points(surface, left_out):
    """Returns the surface without some pieces. left_out: whether each point is left out; all points of a piece have the same value."""
    if not left_out.any():
        return surface
    number = np.cumsum(~left_out) - 1
    kept = ~left_out[surface.triangles[:, 0]]
    arrays = {f.name: getattr(surface, f.name)[~left_out] for f in dataclasses.fields(surface)
              if isinstance(getattr(surface, f.name), np.ndarray) and (f.name == "points" or f.name not in CELLS)}
    return dataclasses.replace(
        surface, **arrays, triangles=number[surface.triangles[kept]].astype(surface.triangles.dtype),
        triangle_keys=None if surface.triangle_keys is None else surface.triangle_keys[kept],
        attributes={name: array[~left_out] for name, array in surface.attributes.items()})


# -- films of surfaces --

def run_convert(arguments):
    """python -m marchingcorrectors convert: particles to .vtp and .pvd, surfaces to USD."""
    parser = argparse.ArgumentParser(prog="python -m marchingcorrectors convert", allow_abbrev=False)
    parser.add_argument("input", nargs="+", metavar="IN", help="particles in any format, or, for a film, .vtp files of surfaces, or "
                        "a .pvd file of them")
    parser.add_argument("output", metavar="OUT", help=".vtp or .pvd of particles; for a film of surfaces .usdc, .usda or .usd")
    add_options(parser)
    given = parser.parse_args(arguments)
    if not is_usd(given.output):
        refuse_options(given)
        convert(given.input, given.output)
        return
    paths = [Path(path) for path in in_order(given.input)]
    stored = [(time, files) for path in paths for time, files in (
        list_times(path) if path.suffix.lower() == ".pvd" else {None: [path]}).items()]

    def load(time, files, other):
        found, surface = read_surface(files)
        known = found if time is None else time
        return surface, other if known is None or given.time_step is not None else known

    def add(film, surface, time):
        film.up = given.up or film.up
        film.add(surface, time)
        return tell(surface, time)

    unit = 1.0 if given.time_step is None else given.time_step
    steps = [(files[0].name, partial(load, time, files, i * unit)) for i, (time, files) in enumerate(stored)]
    print(f"{given.output}: {run(given, [*paths, *(path for _, files in stored for path in files)], steps, add)}")


def read_surface(paths):
    """Reads .vtp files, or .pvtp lists of such files, that are pieces of one surface. Returns two values: their time, None if
    they have none; and the whole surface."""
    time, points, triangles, line_points, lengths, arrays, count = None, [], [], [], [], {}, 0
    for path in [piece for path in paths for piece in (list_pieces(path) if path.suffix.lower() == ".pvtp" else [path])]:
        if path.suffix.lower() != ".vtp" or not path.is_file():
            raise io.FileError(f"'{path}' is no .vtp file of a surface." if path.is_file() else f"There is no file '{path}'.")
        try:
            file = XmlFile(path)
            for array in file.field:
                time = float(file.values(array).ravel()[0]) if array.name in TIMES and array.count else time
            for piece in file.pieces:
                cells = {}
                for name in ("Polys", "Lines"):
                    own = {array.name: array for array in piece[name]}
                    ends, corners = file.cells(own) if piece["counts"][name] else (np.zeros(0, int),) * 2
                    cells[name] = ends, corners + count
                ends, corners = cells["Polys"]
                if len(ends) and (np.diff(ends, prepend=0) != 3).any():
                    raise ValueError("it has faces that are no triangles")
                if piece["count"] and not len(ends) and not len(cells["Lines"][0]):
                    raise ValueError("it has points, but no triangles and no lines; of particles, make surfaces: python -m "
                                     "marchingcorrectors surface")
                if piece["count"]:
                    points.append(file.values(piece["Points"][0]))
                    for array in piece["PointData"]:
                        arrays.setdefault(array.name, []).append(file.values(array))
                triangles.append(corners.reshape(-1, 3))
                lengths.append(np.diff(cells["Lines"][0], prepend=0))
                line_points.append(cells["Lines"][1])
                count += piece["count"]
            for corners in (*triangles, *line_points):
                if corners.size and not 0 <= corners.min() <= corners.max() < count:
                    raise ValueError("a cell names a point that is not there")
        except (io.FileError, ImportError, MemoryError):
            raise
        except Exception as error:
            raise io.FileError(f"{path.name} is no surface, or damaged: {error}.") from None
    arrays = {name: np.concatenate(parts) for name, parts in arrays.items() if len(parts) == len(points)}
    lengths = np.concatenate([[0], *lengths]).astype(int)
    normals = arrays.pop("Normals", None)
    is_plane = len(lengths) > 1
    return time, Surface(
        points=np.concatenate(points) if points else np.empty((0, 3), np.float32), triangles=np.concatenate(triangles),
        normals=normals, attributes=arrays, line_offsets=np.cumsum(lengths) if is_plane else None,
        line_points=np.concatenate(line_points) if is_plane else None)
