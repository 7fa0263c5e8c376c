# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads particles from text, one in each line: .csv (commas, semicolons or tabs), columns between blanks with comments
behind #, .xyz and extended XYZ, dumps of LAMMPS. Columns whose names end in :0, _x, .x, [0], X, ... form one array."""
import csv
import re

import numpy as np

from .._find import as_bytes
from .._library import lib, say
from ._bytes import ending_of, read_bytes
from ._particles import Body, FileError, choose_step, usual

MOST_COLUMNS = 10000
COMPONENT = re.compile(r"(.+?)(?:[:_.]([0-8xyzXYZ])|[\[(]([0-8])[\])]|(?<=[a-z])([XYZ]))")
NUMBER = re.compile(r"[-+]?(([0-9]+[.,]?[0-9]*|[.,][0-9]+)([eEdD][-+]?[0-9]+)?|nan|inf|infinity)", re.I)


def lines_of(path):
    data = read_bytes(path)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):  # Excel calls this "Unicode text".
        data = data.decode("utf-16", errors="replace").encode()
    if b"\0" in data:
        raise FileError(f"{path.name} is no text.")
    text = data.decode("utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    return (text[:-1] if text.endswith("\n") else text).split("\n")


def to_number(cell):
    """Reads a number as tables have it, also with Fortran's D or a decimal comma; an empty cell is NaN. None: no number."""
    cell = cell.strip()
    if not NUMBER.fullmatch(cell):
        return None if cell else np.nan
    return float(re.sub("[dD](?=[-+0-9])", "e", cell.replace(",", ".")))


def split(line, separator):
    if separator is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=separator != "\t"))]


def check_width(file, count):
    if not 0 < count <= MOST_COLUMNS:
        raise FileError(f"{file} has {count} columns; 1 to {MOST_COLUMNS} are read.")


def columns_of(file, lines, names, separator=None):
    """Returns {name: array} of rows of values."""
    try:
        if any("_" in line for line in lines):  # Python would accept "_" inside a number.
            raise ValueError
        values = np.loadtxt(lines, delimiter=separator, comments=None, ndmin=2).T if lines else np.empty((len(names), 0))
        if values.shape != (len(names), len(lines)):
            raise ValueError
    except ValueError:  # The rows have words, gaps, commas, or different lengths.
        rows = [split(line, separator) for line in lines]
        odd = next((i for i, row in enumerate(rows) if len(row) != len(names)), None)
        if odd is not None:
            raise FileError(f"{file}: row {odd + 1} has {len(rows[odd])} values for {len(names)} columns.") from None
        values = [numbers_or_words(file, [row[i] for row in rows], separator) for i in range(len(names))]
    found = {}
    for i, (name, column) in enumerate(zip(names, values)):
        is_identifier = lib.mcor_tells_apart(as_bytes(name))
        if column.dtype.kind == "f" and (is_identifier or (np.abs(column) >= 2 ** 53).any()):
            column = as_integers(column, lambda: [split(line, separator)[i] for line in lines])
            if is_identifier and column.dtype.kind == "f" and (np.abs(column) >= 2 ** 53).any():
                raise FileError(f"{file}: its column {name} has numbers from 2^53 on, where some of it are not whole or are 2^63 "
                                "and more: different ones would become equal.")
        found[name] = column
    return found


def numbers_or_words(file, cells, separator):
    numbers = [to_number(cell) for cell in cells]
    odd = next((cell for cell in cells if "," in cell and re.fullmatch(r"[-+.,0-9eEdD ]+", cell)), None)
    if separator == "," and odd is not None and (numbers[0] is not None or cells[0] == odd):
        raise FileError(f"{file} has '{odd}' in a table with commas between columns: write it without a comma, or semicolons "
                        "between columns, where a comma is that of decimals.")
    if numbers and numbers[0] is None:
        return np.array([cell[:64] for cell in cells])
    return np.array([np.nan if number is None else number for number in numbers], float)


def as_integers(values, cells):
    """Reads integers from their own digits, because doubles lose digits from 2^53 on. Returns `values` itself if a cell is no integer."""
    if (np.abs(values) < 2 ** 53).all():
        return values.astype(np.int64) if (values == np.floor(values)).all() else values
    words = cells()
    if all(re.fullmatch(r"-?[0-9]+", word) and abs(int(word[:20])) < 2 ** 63 for word in words):
        return np.array([int(word) for word in words], np.int64)
    return values


def join_vectors(columns):
    """Joins columns that are components of one array, as their names say."""
    groups = {}
    for name in columns:
        found = COMPONENT.fullmatch(name)
        if found and columns[name].dtype.kind in "fi" and columns[name].ndim == 1:
            letter = found[2] or found[3] or found[4]
            groups.setdefault(found[1], {})[int(letter) if letter.isdigit() else "xyz".index(letter.lower())] = name
    groups = {base: [parts[i] for i in range(len(parts))] for base, parts in groups.items()
              if len(parts) in (2, 3, 6, 9) and max(parts) == len(parts) - 1 and base not in columns}
    of = {name: base for base, names in groups.items() for name in names}
    joined = {}
    for name in columns:
        if name not in of:
            joined[name] = columns[name]
        elif of[name] not in joined:
            joined[of[name]] = np.stack([columns[part] for part in groups[of[name]]], axis=1)
    return joined


class NoPositions(FileError):
    """The error for a table in which no name tells positions."""


def axes_of(columns, behind=""):
    """Returns the names of the columns x, y and z, with these letters behind, as far as they exist."""
    found = [next((name for name in columns if name.lower() == axis + behind), None) for axis in "xyz"]
    return [name for name in found if name is not None]


def body_of(file, columns, positions=(), **more):
    """Makes a Body of a table. positions: the names of the columns of positions; if empty, usual names tell them."""
    arrays, points = join_vectors({name: column for name, column in columns.items() if name not in positions}), None
    if not positions:
        at = usual([name for name in arrays if arrays[name].ndim == 2 and arrays[name].shape[1] <= 3], "position")
        positions = axes_of(columns)
        points = None if at is None else arrays.pop(at)
        count = len(positions) if points is None else points.shape[1]
        if count == 0:
            raise NoPositions(f"{file} has no columns of positions, which are called x, y and z, or Points:0, Points:1 and "
                              f"Points:2; there are {', '.join(columns)}.")
        if count != 3 and count != len(columns):
            found = positions if at is None else [f"{at}:{i}" for i in range(count)]
            raise FileError(f"{file}: of the three columns of positions only {' and '.join(found)} is found; there are "
                            f"{', '.join(columns)}. For particles in a plane add the third one, of zeros.")
    if points is None:
        points = np.stack([columns[name] for name in positions], axis=1)
        arrays = {name: array for name, array in arrays.items() if name not in positions}
    if points.dtype.kind not in "fi":
        raise FileError(f"{file}: its positions are no numbers: '{next((value for value in points.flat if to_number(str(value)) is None), points.dtype)}'.")
    points = np.pad(points.astype(float), ((0, 0), (0, 3 - points.shape[1])))
    return Body(points, arrays, **more)


def name_columns(file, cells):
    """Returns names without units in brackets, each different."""
    check_width(file, len(cells))
    names = {}
    for i, cell in enumerate(cells):
        name = re.sub(r" (\[|\((?![0-8xyzXYZ]\)$)).*", "", cell).strip(' "') or f"Column{i + 1}"
        while name in names:
            name += "_"
        names[name] = i
    return list(names)


def number_columns(count):
    return [*"xyz"[:count], *(f"Column{i + 1}" for i in range(3, count))]


def read_table(path):
    """Reads rows of values below a row of names, which may be a comment."""
    comment, rows = "", []
    for line in lines_of(path):
        start = line.lstrip()[:1]
        if start and start in "#%!":
            comment = line.strip("#%! \t") if not rows else comment
        elif start:
            rows.append(line)
    if not rows:
        raise FileError(f"{path.name} has no row of values.")
    separator = next((letter for letter in ";\t," if letter in rows[0]), None)
    if separator == "\t" and ending_of(path) not in (".csv", ".tsv"):
        separator = None
    if separator is None:
        rows = [row.partition("#")[0] if "#" in row else row for row in rows]
    first = split(rows[0], separator)
    check_width(path.name, len(first))
    if any(to_number(cell) is None for cell in first):
        names, rows = name_columns(path.name, first), rows[1:]
    else:
        numbered = [part.partition("]")[0].split(None, 1)[-1:] for part in comment.split("[")[1:]]  # [01 x] [02 y]
        words = [word.strip() for part in numbered for word in part] if len(numbered) == len(first) else \
            split(comment, "," if "," in comment else None)
        told = len(words) == len(first) and any(to_number(word) is None for word in words)
        names = name_columns(path.name, words) if told else number_columns(len(first))
    if not rows:
        raise FileError(f"{path.name} has no row of values.")
    columns = columns_of(path.name, rows, names, separator)
    try:
        return body_of(path.name, columns)
    except NoPositions:
        if separator is not None or any(columns[name].dtype.kind not in "fi" for name in names[:3]):
            raise
        return body_of(path.name, columns, names[:3])


def whole_number(file, lines, i):
    if i >= len(lines) or not re.fullmatch(r"\s*\d{1,18}\s*", lines[i][:40]):
        raise FileError(say("STEP_WITHOUT_COUNT", file, f"line {i + 1}"))
    return int(lines[i])


def rows_of(file, lines, begin, count):
    if begin + count > len(lines):
        raise FileError(f"{file} ends too early: its step at line {begin} claims {count} particles.")
    return lines[begin:begin + count]


def take_step(file, step, steps):
    """Returns what the chosen step holds, and the words of Body for its time. steps: pairs (time, or None for its number; what it holds)."""
    times = [float(i) if time is None else time for i, (time, _) in enumerate(steps)]
    i = choose_step(file, step, times)
    return steps[i][1], {"time": times[i], "times": times}


def value_of(comment, key):
    """Returns the text behind KEY= in the second line of extended XYZ, with or without quotes."""
    found = re.search(rf'(?:^|\s){key}=(?:"([^"]*)"|(\S*))', comment, re.I)
    return (found[1] if found[1] is not None else found[2]) if found else ""


def numbers_of(text):
    numbers = [to_number(word) for word in text.split()]
    return [] if None in numbers else numbers


def read_xyz(path, step):
    lines, at, steps = lines_of(path), 0, []
    while at < len(lines):
        if lines[at].strip():
            if steps and len(lines[at].split()) == len(lines[at - 1].split()) > 1:
                raise FileError(f"{path.name}: line {at + 1} is one more than the {count} particles that the step says it "
                                "has; correct that number.")
            count = whole_number(path.name, lines, at)
            rows_of(path.name, lines, at + 2, count)
            time = value_of(lines[at + 1], "time")
            steps.append((to_number(time) if time else None, at))
            at += 1 + count
        at += 1
    begin, times = take_step(path.name, step, steps)
    count, comment, properties = whole_number(path.name, lines, begin), lines[begin + 1], []
    parts = value_of(comment, "properties").split(":")
    for name, width in zip(parts[0::3], parts[2::3]):
        if not width.isdigit() or not 0 < int(width) <= 100:
            raise FileError(f"{path.name}: its Properties give '{name}' {width} columns.")
        properties += [name] if width == "1" else [f"{name}:{i}" for i in range(int(width))]
        check_width(path.name, len(properties))
    rows = rows_of(path.name, lines, begin + 2, count)
    if not properties:
        width = len(rows[0].split()) if rows else 3
        check_width(path.name, width)
        properties = ["species", *number_columns(width - 1)] if width > 3 else number_columns(width)
    told = {"lattice": numbers_of(value_of(comment, "lattice")), "pbc": value_of(comment, "pbc").split(),
            "origin": numbers_of(value_of(comment, "origin"))}
    for key, values in told.items():
        if value_of(comment, key) and len(values) != (9 if key == "lattice" else 3):
            raise FileError(f"{path.name}: line {begin + 2} has {len(values)} values as its {key}, which are "
                            f"{9 if key == 'lattice' else 3}.")
    period = period_of(np.reshape(told["lattice"], (-1, 3)), told["origin"] or [0.0] * 3,
                       [flag not in ("F", "0", "False") for flag in told["pbc"] or "TTT"])
    return body_of(path.name, columns_of(path.name, rows, properties), period=period, **times)


def period_of(cell, origin, is_periodic):
    """Returns six bounds, 0 for axes without a period; or the cell's sides, nine numbers, if a side with a period is tilted."""
    bounds = [0.0] * 6
    for a, side in enumerate(cell):
        if is_periodic[a] and any(side[b] for b in range(3) if b != a):
            return np.ravel(cell).tolist()
        if is_periodic[a] and side[a] > 0 and np.isfinite([origin[a], side[a]]).all():
            bounds[2 * a:2 * a + 2] = origin[a], origin[a] + side[a]
    return bounds if any(bounds) else None


def read_box(file, words, lines, at):
    """Returns the cell's sides as vectors, where the cell begins, and which sides are periods. A dump has a cell along the axes; or a tilted cell
    (xy xz yz), where the first two numbers of a line are the bounds of the box around it; or vectors with their origin (abc origin)."""
    flags = words[-3:] if len(words) >= 3 and all(re.fullmatch("[pfsm]{2}", word) for word in words[-3:]) else []
    kind = " ".join(words[:len(words) - len(flags)])
    if kind not in ("", "xy xz yz", "abc origin"):
        raise FileError(f"{file}: line {at} begins a box of a kind that is not known here.")
    sides = [numbers_of(line) for line in rows_of(file, lines, at, 3)]
    count = {"": 2, "xy xz yz": 3, "abc origin": 4}[kind]
    odd = next((i for i, side in enumerate(sides) if len(side) != count), None)
    if odd is not None:
        raise FileError(f"{file}: line {at + odd + 1} has {len(sides[odd])} numbers, where a side of its box has {count}.")
    sides, periodic = np.array(sides), [flag == "pp" for flag in flags] or [False] * 3
    if kind == "abc origin":
        return sides[:, :3], sides[:, 3], periodic
    low, high, (xy, xz, yz) = sides[:, 0].copy(), sides[:, 1].copy(), sides[:, 2] if kind else (0.0, 0.0, 0.0)
    low[:2] -= min(0.0, xy, xz, xy + xz), min(0.0, yz)
    high[:2] -= max(0.0, xy, xz, xy + xz), max(0.0, yz)
    return np.array([[high[0] - low[0], 0, 0], [xy, high[1] - low[1], 0], [xz, yz, high[2] - low[2]]]), low, periodic


def read_lammps(path, step):
    """Reads the items of a dump: a line with the name, then lines with the content. TIME is in the run's unit, TIMESTEP is a number."""
    lines, at, steps, head = lines_of(path), 0, [], {}
    while at < len(lines):
        words, at = lines[at].split(), at + 1
        if not words:
            continue
        if words[0] != "ITEM:" or len(words) < 2:
            raise FileError(f"{path.name}: line {at} is none of a dump of LAMMPS.")
        if words[1] in ("TIMESTEP", "TIME"):
            time = to_number(lines[at]) if at < len(lines) else None
            if time is None:
                raise FileError(f"{path.name}: line {at + 1} is no time.")
            head[words[1]] = time
        elif words[1:3] == ["NUMBER", "OF"]:
            head["count"] = whole_number(path.name, lines, at)
        elif words[1:3] == ["BOX", "BOUNDS"]:
            head["box"] = read_box(path.name, words[3:], lines, at)
            at += 2
        elif words[1] == "ATOMS":
            rows_of(path.name, lines, at, head.get("count", 0))
            steps.append((head.get("TIME", head.get("TIMESTEP")), (at, words[2:], head)))
            at, head = at + head.get("count", 0) - 1, {}
        elif words[1:] != ["UNITS"]:
            raise FileError(f"{path.name}: line {at} is none of a dump of LAMMPS that is known here.")
        at += 1
    if not steps:
        raise FileError(f"{path.name} has no particles.")
    (begin, words, head), times = take_step(path.name, step, steps)
    names = name_columns(path.name, words)
    columns = columns_of(path.name, rows_of(path.name, lines, begin, head.get("count", 0)), names)
    cell, origin, periodic = head.get("box", (np.empty((0, 3)), None, None))
    found = [axes_of(columns, kind) for kind in ("", "u", "s", "su")]  # Positions may be plain, unwrapped, or shares of the cell's sides.
    positions = next((each for each in found if len(each) == 3), ())
    if positions in found[2:]:
        if origin is None:
            raise FileError(f"{path.name}: its positions are shares of a box (xs, ys, zs), and it has no box.")
        shares = [columns[name] for name in positions]
        for a, name in enumerate(positions):
            columns[name] = origin[a] + sum(share * side[a] for share, side in zip(shares, cell))
    period = period_of(cell, origin, periodic)
    return body_of(path.name, columns, positions, period=period, **times)
