# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""python -m marchingcorrectors surface, gauge, slice, line: the functions for files, with the options of the program
marching-correctors, except for its options for pieces, pictures and several processes."""
import argparse
import ctypes
import os
import re
from functools import partial

import numpy as np

from . import _film, _structs as c, io
from ._arrays import Found
from ._call import Keywords, Ranges, own_keywords
from ._functions import free_surface, gauge, isosurface, probe
from ._library import InvalidArgument, lib, say, warn
from .io.convert import Outputs
from ._options import FREE_SURFACE, GAUGE, ISOSURFACE, PROBE, did_you_mean, words_of
from ._surface import save_npz, write_csv, writing
from ._usd import is_usd


def quantity(text):
    """Reads a number, or an array's name."""
    try:
        return float(text)
    except ValueError:
        return text


def numbers(text):
    return [float(part) for part in text.split(",")]


def named_line(text):
    name, _, ends = text.rpartition("=")
    begin, end = map(numbers, ends.split(":"))
    if not name or len(begin) != 3 or len(end) != 3:
        raise ValueError(text)
    return name, (begin, end)


def chosen(text):
    """Reads NAME=VALUE, NAME=WORD or NAME=LOW:HIGH."""
    name, _, ends = text.rpartition("=")
    ends = [quantity(end) for end in ends.split(":")]
    if not name or len(ends) > 2 or len(ends) == 2 and str in map(type, ends):
        raise ValueError(text)
    return name, ends[0] if len(ends) == 1 else tuple(ends)


def plane(text):
    axis, _, place = text.partition("=")
    if not np.isfinite(float(place)):
        raise ValueError(text)
    return "xyz".index(axis), float(place)


def whole_from(least, text):
    if not re.fullmatch(r"[0-9]+", text) or int(text) < least:
        raise argparse.ArgumentTypeError(f"it must be a whole number from {least}, not '{text}'")
    return int(text)


# These options have their own readers; for others, the value's name in the program's help tells how to read it.
READERS = {"--smoothing-length": quantity, "--volume": quantity, "--mass": quantity, "--density": quantity, "--fluid": str, "--only": chosen,
           "--wall-share": quantity, "--component": lambda text: -1 if text == "magnitude" else int(text), "--periodic": lambda text: text if text == "auto" else numbers(text),
           "--gauge": named_line, "--slice": plane,
           "--times": _film.to_times, "--attributes": lambda text: text.split(","), "--device": str,
           "--threads": partial(whole_from, 1), "--memory-limit": partial(whole_from, 1), "--resolution": partial(whole_from, 2)}
WORDS = {"--kernel": words_of("sph_kernel"), "--dimension": {"auto": 0, "2": 2, "3": 3}, "--boundary": {
    "weight_sum": "weight_sum", "weight": "weight_sum", "eigenvalue": "eigenvalue"}}
COMMANDS = {
    "surface": (ISOSURFACE, "the free surface, or with --scalar the surface of an array; of several steps a film",
                ".ply, .vtp, .stl, .obj, .npz, ...; for a film .usdc, .usda or .usd"),
    "gauge": (GAUGE, "water levels along lines", ".csv"),
    "slice": (PROBE, "the field on a plane", ".vti or .npz"),
    "line": (PROBE, "the field on a line", ".vtp, .csv or .npz")}
# The options that are not keywords of the functions. OWN: options that all commands have. OF: for each command, its further
# options.
OWN = {"--dp", "--coefh", "--walls", "--solids", "--threads", "--quiet"}
OF = {"surface": {"--scalar", "--iso", "--free-surface", "--curvature", "--cubes", "--times", "--attributes", "--no-attributes"},
      "gauge": {"--iso", "--free-surface", "--gauge"}, "slice": {"--slice", "--resolution", "--attributes", "--no-attributes"},
      "line": {"--line", "--resolution", "--attributes", "--no-attributes"}}


def keyword_of(option):
    return c.PROGRAM[option][3] or option[2:].replace("-", "_")


def options_of(command):
    """Lists the program's options that this command has."""
    names = {*COMMANDS[command][0], *own_keywords(Keywords)}
    return [option for option, (_, _, modes, _) in c.PROGRAM.items() if {command, "film" if command == "surface" else command} & {*modes}
            and (option in OWN or option in OF[command] or keyword_of(option) in names)]


def reader_of(option, argument):
    """Returns the function that reads the option's value; its error says what the value must be. argument: the value's name in the
    program's help."""
    letters = len(re.sub("[^A-Z]", "", argument))
    read = READERS.get(option, int if argument in ("N", "MIB") else numbers if "," in argument else float if letters < 3 else str)
    wanted = {int: "a whole number", float: "a number"}.get(read, argument)

    def take(text):
        try:
            return read(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"it must be {wanted}, not '{text}'") from None

    return take


def add_option(parser, option, is_required):
    """Adds an option of the shell program, described as in the program's help."""
    argument, about, _, _ = c.PROGRAM[option]
    words = {"help": (about or ", ".join(WORDS[option])).replace("%", "%%"), "dest": option[2:].replace("-", "_"), "default": None}
    if option == "--no-attributes":
        words.update(dest="attributes", action="store_const", const=[])
    elif not argument:
        words.update(action="store_true")
    else:
        choices = WORDS.get(option) or (argument.split("|") if re.fullmatch(r"[a-z_]+(\|[a-z_]+)+", argument) else None)
        words.update(choices=choices, metavar=None if choices else argument, required=is_required, action=_film.Once,
                     type=None if choices else reader_of(option, argument))
        if option in ("--only", "--walls", "--gauge"):
            words.update(action="append", default=None if is_required else [])
    parser.add_argument(option, **words)


def make_parser(command):
    _, text, endings = COMMANDS[command]
    parser = argparse.ArgumentParser(prog=f"python -m marchingcorrectors {command}", description=text, allow_abbrev=False, usage="%(prog)s IN... OUT [OPTIONS]")
    several = "a solver's file, or files of bodies that are one set"
    parser.add_argument("input", nargs="+", metavar="IN", help=several + "; for a film its steps" * (command == "surface"))
    parser.add_argument("output", metavar="OUT", help=endings)
    arrays = parser.add_mutually_exclusive_group()
    for option in options_of(command):
        add_option(arrays if option.endswith("attributes") else parser, option, option == "--" + command)
    if command == "surface":
        _film.add_options(parser)
        parser.add_argument("--spray", metavar="N", nargs="?", const=8, type=int, action=_film.Once, help="a film: "
                            "particles of drops of fewer than N (8), and lone ones, are balls beside the surface")
    return parser


def find_words(given, names, particles, command):
    """Returns {keyword: value} for a function, from the command's options. names: the function's own keywords. With --dp, finds
    the dimension from the particles, and takes the volume from --dp unless the particles have volumes, or masses and densities."""
    words = {}
    for option in options_of(command):
        keyword, value = keyword_of(option), getattr(given, option[2:].replace("-", "_"), None)
        if option in OF[command] or option in OWN or value is None:
            continue
        if keyword not in names and keyword not in own_keywords(Keywords):
            raise InvalidArgument(f"{option} is not for the free surface: leave it out, or give --scalar.")
        words[keyword] = WORDS[option][value] if option in WORDS else value
    words["only"] = Ranges(given.only) if given.only else None
    length = given.smoothing_length
    if isinstance(length, str) and length.partition("=")[0] in ("estimate", "neighbours", "neighbors"):
        words["estimate_smoothing_length"] = True if length == "estimate" else words["smoothing_length"]
        del words["smoothing_length"]
    if given.coefh is not None and given.dp is None:
        raise InvalidArgument("--coefh needs --dp; add it, or leave out --coefh.")
    if given.solids in ("weight", "ignore") and "wall_share" in words:
        raise InvalidArgument(say("WALL_SHARE_IN_VAIN", "add --solids wall"))
    if given.dp is not None:
        if length is not None:
            raise InvalidArgument("--dp and --smoothing-length both give the smoothing length; leave one of them out.")
        dimension = lib.mcor_find_dimension(ctypes.byref(Found(particles.positions).find([], ["list"]).found.input), None, words.get("dimension", 0))
        words["smoothing_length"] = (given.coefh or 1.0) * dimension ** 0.5 * given.dp
        mass_and_density = [words.get(name, getattr(particles, name)) for name in ("mass", "density")]
        if "volume" not in words and particles.volume is None and any(each is None for each in mass_and_density):
            words = {name: value for name, value in words.items() if name not in ("mass", "density")}
            words["volume"] = given.dp ** dimension
    if getattr(given, "cubes", None) == "uniform":
        words["level_limit"] = 0
    if given.solids == "ignore":
        words["ignore_solids"] = True
    if command == "surface" and given.solids in ("weight", "ignore"):
        words["wall_share"] = 0.0
    elif command == "surface" and given.solids == "wall":
        words.setdefault("wall_share", "measured")
    if getattr(given, "curvature", None):
        words.update(mean_curvature=True, gauss_curvature=True)
    if "memory_limit" in words:
        words["memory_limit"] <<= 20
    return words


def attributes_of(given, particles, more=()):
    names = list(particles.arrays) if given.attributes is None else [*given.attributes, *more]
    return [name for name in dict.fromkeys(names) if particles.array(name).dtype.kind in "fiub"]


def surface_of(given, particles, more=()):
    """Returns the surface, and the keywords that made it."""
    names = FREE_SURFACE if given.scalar is None else ISOSURFACE
    words = {**find_words(given, names, particles, "surface"), "attributes": attributes_of(given, particles, more)}
    words.setdefault("iso_value", len(given.iso or ()) > 1 or given.scalar is not None and given.iso is None)
    words.update({"nearest_particle": True} if given.spray is not None else {})
    if given.scalar is None:
        return free_surface(particles, given.iso or 0.5, **words), words
    if given.free_surface:
        raise InvalidArgument("--free-surface and --scalar exclude each other; leave one of them out.")
    surface = isosurface(particles, given.scalar, given.iso, **words)
    if surface.iso_value is not None and given.scalar in particles:
        scalar = particles.array(given.scalar)
        surface.iso_value_name = Found(particles.positions).find(
            {given.scalar: scalar}, ["scalar"], {"scalar": given.scalar}, filled=bool(given.filled),
            scalar_component=words.get("scalar_component", -1)).text("iso_value_name")
        surface.iso_value = surface.iso_value.astype(np.float32 if scalar.dtype == np.float32 else np.float64)
    return surface, words


def run_surface(given, particles):
    surface, _ = surface_of(given, particles)
    chosen_here = given.scalar is not None and given.iso is None and len(surface.points)
    iso = f", iso value {surface.iso_value[0]:g}" if chosen_here else ""
    surface.iso_value = None if chosen_here else surface.iso_value
    surface.save(given.output)
    return f"{len(surface.points)} points, {len(surface.triangles)} triangles{iso}"


def run_gauge(given, particles):
    """Measures the gauges at all steps of a file, or in one set of particles, and writes a row for each step and gauge."""
    if not given.output.lower().endswith(".csv"):
        raise InvalidArgument(f"The output is a .csv file, not '{os.path.basename(given.output)}'.")
    rows, is_film, names = [], len(given.input) == 1, [name for name, _ in given.gauge]
    for name in names:
        if names.count(name) > 1:
            raise InvalidArgument(f"Two gauges are called '{name}': their names must differ.")
    for step, each in enumerate(io.read_steps(given.input[0], walls=given.walls) if is_film else [particles]):
        found = gauge(each, dict(given.gauge), (given.iso or [0.5])[0], **find_words(given, GAUGE, each, "gauge"))
        time = float(step if each.time is None else each.time)
        rows += [[time, name, found.state[i], found.first[i], found.last[i], found.depth[i], len(found.crossings[name]),
                  *found.place[i]] for i, name in enumerate(found.names)]
    write_csv(given.output, ["time", "gauge", "state", "first", "last", "depth", "crossings", "x", "y", "z"], rows)
    return f"{len(given.gauge)} gauge{'s' * (len(given.gauge) != 1)}, {step + 1} step{'s' * (step > 0)}"


def run_probe(given, particles, points, make, command):
    """Probes points (points, 3) and writes the result. make(pyvista): returns the points as a data set."""
    found = probe(particles, points, attributes=attributes_of(given, particles), **find_words(given, PROBE, particles, command))
    arrays = found._point_arrays()
    ending = os.path.splitext(given.output)[1].lower()
    if ending == ".npz":
        save_npz(given.output, points=points, **arrays)
    elif ending == ".csv":
        columns = {}
        for name, values in {"": points, **arrays}.items():
            flat = values.reshape(len(points), -1)
            columns.update((name if values.ndim == 1 else "xyz"[i] if not name else f"{name}:{i}", flat[:, i].tolist())
                           for i in range(flat.shape[1]))
        write_csv(given.output, list(columns), zip(*columns.values()))
    else:
        import pyvista

        mesh = make(pyvista)
        for name, values in arrays.items():
            mesh.point_data[name] = values.reshape(len(points), -1) if values.ndim > 2 else values
        try:
            with writing(given.output, mesh):
                mesh.save(given.output)
        except ValueError:  # PyVista does not know the ending.
            raise InvalidArgument(f"The output is a {COMMANDS[command][2]} file, not '{os.path.basename(given.output)}'.") from None
    if found.statistics["fluid_particles"] and not found.valid.any():
        warn(say("POINTS_DRY"))
    return f"{len(points)} points, {int(found.valid.sum())} of them in the fluid"


def run_slice(given, particles):
    axis, place = given.slice
    low, high = particles.positions.min(axis=0).astype(float), particles.positions.max(axis=0).astype(float)
    spacing = np.delete(high - low, axis).max() / (max(given.resolution or 512, 2) - 1) or 1.0
    lines = [low[a] + spacing * np.arange(int(np.ceil((high[a] - low[a]) / spacing - 1e-9)) + 1) for a in range(3)]
    lines[axis] = np.array([place])
    points = np.stack(np.meshgrid(*lines[::-1], indexing="ij")[::-1], -1).reshape(-1, 3)  # x runs fastest
    return run_probe(given, particles, points, lambda pyvista: pyvista.ImageData(
        dimensions=[len(line) for line in lines], spacing=[spacing] * 3, origin=[line[0] for line in lines]), "slice")


def run_line(given, particles):
    if len(given.line) != 6 or given.line[:3] == given.line[3:]:
        raise InvalidArgument(f"--line takes the six numbers of two different points, not {given.line}.")
    begin, end = np.array(given.line[:3]), np.array(given.line[3:])
    points = begin + np.linspace(0, 1, max(given.resolution or 512, 2))[:, None] * (end - begin)
    return run_probe(given, particles, points, lambda pyvista: pyvista.lines_from_points(points), "line")


def run(arguments):
    """Runs a command. arguments: the command's name, and the words behind it."""
    joined = []
    for word in arguments[1:]:  # argparse would take a list that begins with a negative number for an option.
        if joined and joined[-1].startswith("--") and re.match(r"-(inf|[\d.])", word):
            joined[-1] += "=" + word
        else:
            joined.append(word)
    parser = make_parser(arguments[0])
    given, unknown = parser.parse_known_args(joined)
    if unknown:
        word = unknown[0].partition("=")[0]
        if word not in c.PROGRAM:
            parser.error(f"there is no option {word}.{did_you_mean(word, options_of(arguments[0]))}")
        others = " and ".join(other for other in COMMANDS if word in options_of(other))
        parser.error(f"{word} is for {others or 'the program marching-correctors'}, not for {arguments[0]}; leave it out")
    if given.threads is not None:
        os.environ["MCOR_THREADS"] = str(given.threads)
    output = given.output
    if arguments[0] == "surface" and is_usd(output):
        said = _film.run_particles(given, partial(surface_of, given))
    else:
        _film.refuse_options(given)
        with Outputs([*given.input, *given.walls], [output]) as files:
            particles = io.read(given.input[0] if len(given.input) == 1 else given.input, walls=given.walls)
            given.output = files.beside(output)
            said = {"surface": run_surface, "gauge": run_gauge, "slice": run_slice, "line": run_line}[arguments[0]](given, particles)
    if not given.quiet:
        print(f"{output}: {said}")
