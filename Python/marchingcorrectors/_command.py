# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""python -m marchingcorrectors surface, gauge, slice, line: the functions for files, with the words of the program
marching-correctors, whose options for pieces, pictures and several processes are not here."""
import argparse
import csv
import os
import re
import sys
import warnings
from functools import partial
from typing import Literal

import numpy as np

from . import _film, _structs as c, io
from ._arrays import choose
from ._functions import free_surface, isosurface, probe
from ._library import InvalidArgument, say
from ._meters import gauge
from .io._outputs import Outputs
from ._options import FREE_SURFACE, GAUGE, ISOSURFACE, PROBE, WORDS, Options, words_of
from ._usd import is_usd


def quantity(text):
    """Reads a number, or an array's name."""
    try:
        return float(text)
    except ValueError:
        return text


def numbers(text):
    return [float(part) for part in text.split(",")]


def period(text):
    """LX,LY,LZ|BOUNDS|auto"""
    return text if text == "auto" else numbers(text)


def named_line(text):
    """NAME=X,Y,Z:X,Y,Z"""
    name, _, ends = text.rpartition("=")
    begin, end = map(numbers, ends.split(":"))
    if not name or len(begin) != 3 or len(end) != 3:
        raise ValueError(text)
    return name, (begin, end)


def named_value(text):
    """NAME=VALUE"""
    name, _, value = text.rpartition("=")
    if not name:
        raise ValueError(text)
    return name, float(value)


def named_range(text):
    """NAME=VALUE[:VALUE]"""
    name, _, ends = text.rpartition("=")
    ends = [float(end) for end in ends.split(":")]
    if not name or len(ends) > 2:
        raise ValueError(text)
    return name, (ends[0], ends[-1])


def plane(text):
    """AXIS=PLACE"""
    axis, _, place = text.partition("=")
    return "xyz".index(axis), float(place)


for function in (period, named_line, named_value, named_range, plane):
    function.__name__ = function.__doc__  # argparse names this function where a value is wrong.

# The program's words for options and values are the names in Python, or stand here.
OTHER_WORDS = {"scalar_component": "component", "smoothing_length_is_support_radius": "support-radius", "sph_kernel": "kernel",
               "cube_size_factor": "cube-factor", "level_limit": "max-level", "boundary_detection": "boundary"}
OTHER_VALUES = {"periodic": period, "dimension": {"auto": 0, "2": 2, "3": 3}, "field": {"shepard": "shepard", "sum": "sum"},
                "boundary_detection": {"weight_sum": "weight_sum", "weight": "weight_sum", "eigenvalue": "eigenvalue"}}


def value_of(name):
    """Returns None for a flag, a dictionary for words, else the function that reads a value."""
    words, kind = words_of(name), Options.__annotations__[name]
    if words:
        return {word: word for word in words} if kind == Literal[tuple(words)] else quantity
    return None if kind is bool else kind if kind in (int, float) else numbers


OPTIONS = {"--" + OTHER_WORDS.get(name, name.replace("_", "-")): (name, OTHER_VALUES.get(name, value_of(name)))
           for name in ("scalar_component", "smoothing_length_is_support_radius", "weight_sum", "boundary_eigenvalue",
                        "gradients", *c.OPTIONS) if name not in ("memory_limit", "triangle_normals")}
COMMANDS = {
    "surface": (ISOSURFACE, "the free surface, or with --scalar and --iso an isosurface; of several steps a film",
                ".ply, .vtp, .stl, .obj, .npz, ...; for a film .usdc, .usda or .usd"),
    "gauge": (GAUGE, "where lines cross the free surface", ".csv"),
    "slice": (PROBE, "the field on a plane", ".vti or .npz"),
    "line": (PROBE, "the field on a line", ".vtp, .csv or .npz")}


def make_parser(command):
    names, text, endings = COMMANDS[command]
    parser = argparse.ArgumentParser(prog=f"python -m marchingcorrectors {command}", description=text, allow_abbrev=False)
    add = parser.add_argument
    add("input", nargs="+", metavar="IN", help="a solver's file, or files of bodies that are one set; for a film its steps, or "
        "what holds several" if command == "surface" else "a solver's file, or files of bodies that are one set")
    add("output", metavar="OUT", help=endings)
    add("--smoothing-length", metavar="NAME|VALUE|estimate|neighbours[=ETA]", type=quantity,
        help="an array, one value, an estimate of one, or of each by its neighbours")
    add("--dp", metavar="D", type=float, help="DualSPHysics: the initial particle distance; h is coefh x sqrt(3) x D (sqrt(2) "
        "in 2-D), and volumes are D^3 (D^2) where mass and density do not tell")
    add("--coefh", metavar="C", type=float, default=1.0, help="DualSPHysics: the coefficient in --dp (default 1)")
    add("--volume", metavar="NAME|VALUE|computed", type=quantity, help="an array, one value, or by the particles' distances")
    for name in ("mass", "density"):
        add("--" + name, metavar="NAME|VALUE", type=quantity, help="an array, or one value")
    add("--fluid", metavar="NAME=VALUE", type=named_value, help="where this array has another value, particles are solid")
    add("--within", metavar="X0,X1,Y0,Y1,Z0,Z1", type=numbers,
        help="leave out particles that are not in these bounds, whose sides may be inf or -inf")
    add("--only", metavar="NAME=VALUE[:VALUE]", action="append", default=[], type=named_range, help="leave out particles whose "
        "value in this array is another one, or not in this range; of several ranges of one array any counts, of several "
        "arrays all do")
    add("--walls", metavar="FILE", action="append", default=[], help="the particles of this file are walls, too")
    if command == "surface":
        add("--scalar", metavar="NAME", help="array to contour")
        add("--free-surface", action="store_true", help="contour the sum of the weights, as without --scalar")
        add("--cubes", choices=("uniform", "adaptive"), help="cubes of one size, or larger ones where h is (default)")
        add("--curvature", action="store_true", help="the mean and the Gaussian curvature at the points")
        _film.add_options(parser)
        add("--times", metavar="T[,T...]|BEGIN:END:STEP", type=_film.to_times, help="a film: at these times, which may lie between "
            "two steps, where particles have ids")
        add("--spray", metavar="N", nargs="?", const=8, type=int, help="a film: particles of drops of fewer than N (8), and lone ones, "
            "are balls beside the surface")
        add("--solids", choices=("auto", "weight", "ignore", "wall"), help="what solids do where they meet the surface")
    if command in ("surface", "gauge"):
        add("--iso", metavar="V[,V...]", type=numbers, help="values of the scalar, or of the sum of the weights (0.5)")
    if command != "gauge":
        add("--attributes", metavar="NAME[,NAME...]", type=lambda text: text.split(","), help="these arrays (default all)")
        add("--no-attributes", dest="attributes", action="store_const", const=[], help="no arrays")
    if command == "gauge":
        add("--gauge", metavar="NAME=X,Y,Z:X,Y,Z", action="append", type=named_line, required=True, help="a line")
    if command == "slice":
        add("--slice", metavar="AXIS=PLACE", type=plane, required=True, help="as z=0.1")
    if command == "line":
        add("--line", metavar="X,Y,Z,X,Y,Z", type=numbers, required=True, help="from one point to another")
    if command in ("slice", "line"):
        add("--resolution", metavar="N", type=int, default=512, help="points on the line or the longest side (512)")
    for word, (name, kind) in OPTIONS.items():
        if name in names:
            about = WORDS[name].replace("%", "%%")
            if kind is None:
                add(word, dest=name, action="store_true", default=None, help=about)
            elif isinstance(kind, dict):
                add(word, dest=name, choices=kind, help=about)
            else:
                add(word, dest=name, type=kind, help=about)
    add("--memory-limit", metavar="MIB", type=int, help="most device memory")
    add("--device", metavar="N|NAME", help="a device, by number or part of its name")
    add("--threads", metavar="N", type=int, help="most threads of the built-in device")
    add("--quiet", action="store_true", help="errors and warnings only")
    return parser


def find_words(given, names, particles):
    """Returns keywords of the functions; the file completes them."""
    words = {}
    for word, (name, kind) in OPTIONS.items():
        value = getattr(given, name, None)
        if value is not None and name not in names:
            raise InvalidArgument(f"{word} is not for the free surface: leave it out, or give --scalar and --iso.")
        if value is not None:
            words[name] = kind[value] if isinstance(kind, dict) else value
    words.update((name, getattr(given, name)) for name in ("volume", "mass", "density") if getattr(given, name) is not None)
    length = given.smoothing_length
    if isinstance(length, str) and length.partition("=")[0] in ("estimate", "neighbours", "neighbors"):
        words["estimate_smoothing_length"] = True if length == "estimate" else length
    elif length is not None:
        words["smoothing_length"] = length
    if given.dp is not None:
        if length is not None:
            raise InvalidArgument("--dp and --smoothing-length both give the smoothing length; leave one of them out.")
        dimension = 2 if (np.ptp(particles.positions, axis=0) == 0).sum() == 1 else 3
        words["smoothing_length"] = given.coefh * dimension ** 0.5 * given.dp
        mass_and_density = [words.get(name, getattr(particles, name)) for name in ("mass", "density")]
        if "volume" not in words and particles.volume is None and any(each is None for each in mass_and_density):
            words = {name: value for name, value in words.items() if name not in ("mass", "density")}
            words["volume"] = given.dp ** dimension
    if given.within is not None:
        words["within"] = given.within
    words["only"] = choose(given.only, particles.array)
    if given.fluid is not None:
        words["solid"] = particles.array(given.fluid[0]) != given.fluid[1]
    if getattr(given, "cubes", None) == "uniform":
        words["level_limit"] = 0
    solids = getattr(given, "solids", None)
    if solids == "ignore":
        words["ignore_solids"] = True
    elif solids == "wall":
        words.setdefault("wall_share", "measured")
    if solids in ("weight", "ignore"):
        words["wall_share"] = 0.0
    if words.get("periodic") == "auto":
        if particles.cell is not None:
            raise InvalidArgument(f"{particles.file}: {say('CELL_TILTED')} Leave out --periodic.")
        if particles.period is None:
            raise InvalidArgument(f"{particles.file} tells no period. Give --periodic LX,LY,LZ.")
        del words["periodic"]  # This one is taken.
    if getattr(given, "curvature", None):
        words.update(mean_curvature=True, gauss_curvature=True)
    if given.memory_limit is not None:
        words["memory_limit"] = given.memory_limit << 20
    return {**words, "device": given.device}


def attributes_of(given, particles, more=()):
    names = list(particles.arrays) if given.attributes is None else [*given.attributes, *more]
    return [name for name in dict.fromkeys(names) if particles.array(name).dtype.kind in "fiub"]


def surface_of(given, particles, more=()):
    """Returns the surface, and the words that made it."""
    names = FREE_SURFACE if given.scalar is None else ISOSURFACE
    words = {**find_words(given, names, particles), "attributes": attributes_of(given, particles, more)}
    words.setdefault("iso_value", len(given.iso or ()) > 1)
    words.update({"nearest_particle": True} if given.spray is not None else {})
    if given.scalar is None:
        return free_surface(particles, given.iso or 0.5, **words), words
    if given.iso is None or given.free_surface:
        raise InvalidArgument("With --scalar give --iso, and leave --free-surface out.")
    return isosurface(particles, given.scalar, given.iso, **words), words


def run_surface(given, particles):
    surface, _ = surface_of(given, particles)
    surface.save(given.output)
    return f"{len(surface.points)} points, {len(surface.triangles)} triangles"


def run_gauge(given, particles):
    """Measures all steps of a file, as the program does."""
    rows, is_film = [], len(given.input) == 1
    for step, each in enumerate(io.read_steps(given.input[0], walls=given.walls) if is_film else [particles]):
        found = gauge(each, dict(given.gauge), (given.iso or [0.5])[0], **find_words(given, GAUGE, each))
        time = float(step if each.time is None else each.time)
        rows += [[time, name, found.state[i], found.first[i], found.last[i], found.depth[i], len(found.crossings[name]),
                  *found.place[i]] for i, name in enumerate(found.names)]
    write_table(given.output, ["time", "gauge", "state", "first", "last", "depth", "crossings", "x", "y", "z"], rows)
    return f"{len(given.gauge)} gauge{'s' * (len(given.gauge) != 1)}, {step + 1} step{'s' * (step > 0)}"


def write_table(output, head, rows):
    """Writes a number; NaN becomes an empty cell."""
    if not output.lower().endswith(".csv"):
        raise InvalidArgument(f"The output is a .csv file, not '{output}'.")
    with open(output, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(
            [head, *([cell if cell == cell else "" for cell in row] for row in rows)])


def run_probe(given, particles, points, make):
    """Calls make(pyvista), which returns the data set of these points (points, 3)."""
    found = probe(particles, points, attributes=attributes_of(given, particles), **find_words(given, PROBE, particles))
    arrays = found._point_arrays()
    ending = os.path.splitext(given.output)[1].lower()
    if ending == ".npz":
        np.savez_compressed(given.output, points=points, **arrays)
    elif ending == ".csv":
        columns = {}
        for name, values in {"": points, **arrays}.items():
            flat = values.reshape(len(points), -1)
            columns.update((name if values.ndim == 1 else "xyz"[i] if not name else f"{name}:{i}", flat[:, i].tolist())
                           for i in range(flat.shape[1]))
        write_table(given.output, list(columns), zip(*columns.values()))
    else:
        import pyvista

        mesh = make(pyvista)
        for name, values in arrays.items():
            mesh.point_data[name] = values.reshape(len(points), -1) if values.ndim > 2 else values
        mesh.save(given.output)
    return f"{len(points)} points, {int(found.valid.sum())} of them in the fluid"


def run_slice(given, particles):
    axis, place = given.slice
    low, high = particles.positions.min(axis=0).astype(float), particles.positions.max(axis=0).astype(float)
    spacing = np.delete(high - low, axis).max() / (max(given.resolution, 2) - 1) or 1.0
    lines = [low[a] + spacing * np.arange(int(np.ceil((high[a] - low[a]) / spacing - 1e-9)) + 1) for a in range(3)]
    lines[axis] = np.array([place])
    points = np.stack(np.meshgrid(*lines[::-1], indexing="ij")[::-1], -1).reshape(-1, 3)  # x runs fastest
    return run_probe(given, particles, points, lambda pyvista: pyvista.ImageData(
        dimensions=[len(line) for line in lines], spacing=[spacing] * 3, origin=[line[0] for line in lines]))


def run_line(given, particles):
    if len(given.line) != 6:
        raise InvalidArgument("--line takes six numbers, X,Y,Z,X,Y,Z.")
    begin, end = np.array(given.line[:3]), np.array(given.line[3:])
    points = begin + np.linspace(0, 1, max(given.resolution, 2))[:, None] * (end - begin)
    return run_probe(given, particles, points, lambda pyvista: pyvista.lines_from_points(points))


def run(arguments):
    """Runs a command. arguments: the command's name, and the words behind it."""
    joined = []
    for word in arguments[1:]:  # argparse would take a list that begins with a negative number for an option.
        if joined and joined[-1].startswith("--") and re.match(r"-(inf|[\d.])", word):
            joined[-1] += "=" + word
        else:
            joined.append(word)
    given = make_parser(arguments[0]).parse_args(joined)
    if given.threads is not None:
        os.environ["MCOR_THREADS"] = str(given.threads)
    output = given.output
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_: print(f"marchingcorrectors: warning: {message}", file=sys.stderr)
        if arguments[0] == "surface" and is_usd(output):
            said = _film.run_particles(given, partial(surface_of, given))
        else:
            _film.refuse_options(given)
            with Outputs([*given.input, *given.walls], [output]) as files:
                particles = io.read(given.input[0] if len(given.input) == 1 else given.input, walls=given.walls)
                given.output = files.beside(output)
                said = {"surface": run_surface, "gauge": run_gauge, "slice": run_slice, "line": run_line}[arguments[0]](
                    given, particles)
    if not given.quiet:
        print(f"{output}: {said}")
