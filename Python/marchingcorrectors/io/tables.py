# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads particles from tables: text with one particle in each line; commas, semicolons, tabs or blanks between columns; comments behind #.
Reads .ply, because VTK's own reader leaves out properties, and NumPy's .npz and .npy of plain arrays. Arrays of objects hold pickles,
and are refused. Columns whose names end in :0, _x, .x, [0], X, ... form one array."""
import csv
import io
import re
import zipfile

import numpy as np

from .._arrays import as_bytes
from .._library import lib, say, warn
from ._particles import TIMES, Body, FileError, check_claim, ending_of, period_of_field, read_bytes, usual

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
    """Reads a number as tables have it, also with Fortran's D or a decimal comma. An empty cell is NaN. Returns None if the cell holds no number."""
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
    """Returns {name: array}: an array for each column of the lines."""
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
        is_large = column.dtype.kind == "f" and (np.abs(column) >= 2 ** 53).any()
        if is_large:  # Doubles lose digits from 2^53 on, so integers are read from their own digits.
            words = [split(line, separator)[i] for line in lines]
            if all(re.fullmatch(r"-?[0-9]+", word) and abs(int(word[:20])) < 2 ** 63 for word in words):
                column = np.array([int(word) for word in words], np.int64)
            elif is_identifier:
                raise FileError(f"{file}: its column {name} has numbers from 2^53 on, where some of it are not whole or are 2^63 "
                                "and more: different ones would become equal.")
        elif is_identifier and column.dtype.kind == "f" and (column == np.floor(column)).all():
            column = column.astype(np.int64)
        found[name] = column
    return found


def numbers_or_words(file, cells, separator):
    try:
        if not any("_" in cell for cell in cells):
            return np.array(cells, float)
    except ValueError:  # A cell is a word, is empty, or has a comma.
        pass
    numbers = [to_number(cell) for cell in cells]
    odd = next((cell for cell in cells if "," in cell and re.fullmatch(r"[-+.,0-9eEdD ]+", cell)), None)
    if separator == "," and odd is not None and (numbers[0] is not None or cells[0] == odd):
        raise FileError(f"{file} has '{odd}' in a table with commas between columns: write it without a comma, or semicolons "
                        "between columns, where a comma is that of decimals.")
    if numbers and numbers[0] is None:
        return np.array([cell[:64] for cell in cells])
    return np.array([np.nan if number is None else number for number in numbers], float)


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


def axes_of(columns, behind=""):
    """Returns the names of the columns x, y and z, as far as they exist. behind: letters behind x, y and z, such as "u" in xu."""
    found = [next((name for name in columns if name.lower() == axis + behind), None) for axis in "xyz"]
    return [name for name in found if name is not None]


def body_of(file, columns, positions=(), unnamed=(), **more):
    """Makes a Body of a table. positions: the names of the columns of positions. If `positions` is empty, the columns with usual
    names are taken; if no column has a usual name, the columns `unnamed`."""
    arrays, points = join_vectors({name: column for name, column in columns.items() if name not in positions}), None
    if not positions:
        at = usual([name for name in arrays if arrays[name].ndim == 2 and arrays[name].shape[1] <= 3], "position")
        positions = axes_of(columns)
        points = None if at is None else arrays.pop(at)
        count = len(positions) if points is None else points.shape[1]
        if count == 0 and unnamed:
            return body_of(file, columns, unnamed, **more)
        if count == 0:
            raise FileError(f"{file} has no columns of positions, which are called x, y and z, or Points:0, Points:1 and "
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
    """Returns the columns' names, without units in brackets. A name that occurs again gets a "_" at its end."""
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
    """Reads rows of values below a row of names, which may be a comment. Without names, the columns are x, y, z, Column4, ..."""
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
        numbered = [part.partition("]")[0].split(None, 1) for part in comment.split("[")[1:]]  # [01 x] [02 y [m]]
        words = [part[1].strip() for part in numbered if len(part) == 2 and to_number(part[0]) is not None] or split(
            comment, "," if "," in comment else None)
        told = len(words) == len(first) and any(to_number(word) is None for word in words)
        names = name_columns(path.name, words) if told else number_columns(len(first))
    if not rows:
        raise FileError(f"{path.name} has no row of values.")
    columns = columns_of(path.name, rows, names, separator)
    is_plain = separator is None and all(columns[name].dtype.kind in "fi" for name in names[:3])
    return body_of(path.name, columns, unnamed=names[:3] if is_plain else ())


PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8",
         "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
         "float64": "f8"}
PLY_ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}


def read_ply(path):
    data = read_bytes(path)
    head = re.match(rb"ply\r?\n(.*?)end_header\r?\n", data[:1 << 20], re.DOTALL)
    if not head:
        raise FileError(f"{path.name} is no .ply file, or its beginning is damaged.")
    form, elements = None, []  # [name, count, [(property, type, or None of a list)]]
    for line in head[1].decode(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["format"] and len(words) > 1 and words[1] in PLY_ORDERS:
            form = words[1]
        elif words[:1] == ["element"] and len(words) == 3 and re.fullmatch("[0-9]{1,15}", words[2]):
            elements.append([words[1], int(words[2]), []])
        elif words[:1] == ["property"] and elements and (len(words) == 3 and words[1] in PLY_TYPES or words[1:2] == ["list"]):
            elements[-1][2].append((words[-1], PLY_TYPES.get(words[1])))
        elif words and words[0] not in ("comment", "obj_info"):
            raise FileError(say("PLY_HEAD", path.name, line))
    if form is None:
        raise FileError(f"{path.name} does not tell its format: ascii or binary.")
    at = head.end()
    for name, count, properties in elements:
        if not count and name != "vertex":
            continue
        if any(kind is None for _, kind in properties):
            raise FileError(say("PLY_LISTS", path.name, name))
        check_width(path.name, len(properties))
        if form == "ascii":
            end = at
            for _ in range(min(count, len(data)) if name != "vertex" else 0):
                end = data.find(b"\n", end) + 1 or len(data)
        else:
            kind = np.dtype([(str(i), PLY_ORDERS[form] + kind) for i, (_, kind) in enumerate(properties)])
            end = at + count * kind.itemsize
        if name == "vertex":
            break
        at = end
    else:
        raise FileError(f"{path.name} has no vertices.")
    names = [name for name, _ in properties]
    if len(set(names)) < len(names):
        raise FileError(say("PLY_NAMES", path.name))
    if form == "ascii":
        rows = [row for row in data[at:].decode(errors="replace").split("\n") if row.strip()][:count]
        columns = columns_of(path.name, rows, names)
    elif end <= len(data):
        rows = np.frombuffer(data, kind, count, at)
        columns = {name: rows[str(i)].astype(rows.dtype[i].newbyteorder("=")) for i, name in enumerate(names)}
    if form != "ascii" and end > len(data) or len(rows) < count:
        raise FileError(f"{path.name} ends too early: it claims {count} vertices.")
    return body_of(path.name, columns, is_mesh=True if any(name == "face" and many for name, many, _ in elements) else None)


def array_of(file, name, data):
    """Reads an array from the bytes of a .npy file."""
    stream = io.BytesIO(data)
    version = np.lib.format.read_magic(stream)
    read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}[version]
    shape, by_columns, kind = read(stream)
    if kind.hasobject:
        raise FileError(f"{file} is not opened: its array '{name}' holds Python's objects, which are pickles, which can run code. Let "
                        "the solver write HDF5 (PySPH: install h5py), or plain arrays.")
    count = int(np.prod(shape, dtype=object))
    if min(shape, default=0) < 0 or count * kind.itemsize > len(data) - stream.tell() or kind.itemsize == 0:
        raise FileError(f"{file}: its array '{name}' claims {shape} values, for which it is too short.")
    values = np.frombuffer(data, kind, count, stream.tell())
    return values.reshape(shape[::-1]).T if by_columns else values.reshape(shape)


def read_arrays(path):
    if path.suffix.lower() == ".npy":
        found = {"positions": array_of(path.name, path.stem, path.read_bytes())}
        if found["positions"].dtype.names:
            found = {name: found["positions"][name] for name in found["positions"].dtype.names}
    else:
        with zipfile.ZipFile(path) as packed:
            members = packed.infolist()
            check_claim(path.name, "its arrays together", sum(each.file_size for each in members), path.stat().st_size)
            found = {each.filename[:-4]: array_of(path.name, each.filename[:-4], packed.read(each)) for each in members
                     if each.filename.endswith(".npy")}
    places = [usual([name for name in found if found[name].ndim == 2], "position"), *(name for name in axes_of(found) if found[name].ndim == 1)]
    place = next((name for name in places if name is not None), None)
    count = -1 if place is None else len(found[place])
    plain = {name: np.ascontiguousarray(values, values.dtype.newbyteorder("=")) for name, values in found.items()
             if values.ndim in (1, 2) and len(values) == count}
    if place is not None and found[place].ndim == 2 and found[place].shape[1] == 2:
        plain[place] = np.pad(plain[place], ((0, 0), (0, 1)))  # The positions lie in a plane.
    body = body_of(path.name, {name: np.empty(0) for name in found} if place is None else plain)
    alone = {name: values for name, values in found.items() if name not in plain}
    time = next((values for name, values in alone.items() if name.lower() in ("t", *(each.lower() for each in TIMES))
                 and values.size == 1 and values.dtype.kind in "fiu"), None)
    others = [name for name, values in alone.items() if values is not time and name != "PeriodicBounds"]
    if others:
        warn(f"{path.name}: no value for each of {count} particles have {', '.join(others)[:200]}, which are left out.")
    return body._replace(time=None if time is None else float(np.ravel(time)[0]), period=period_of_field(alone))
