# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads files of molecular dynamics: .xyz and extended XYZ, dumps of LAMMPS, and GROMACS' .gro, with many steps; and LAMMPS' .data."""
import re

import numpy as np

from .._library import say
from ._particles import Body, FileError, choose_step
from .tables import axes_of, body_of, check_width, columns_of, lines_of, name_columns, number_columns, to_number

def whole_number(file, lines, i):
    if i >= len(lines) or not re.fullmatch(r"\s*\d{1,18}\s*", lines[i][:40]):
        raise FileError(say("STEP_WITHOUT_COUNT", file, f"line {i + 1}"))
    return int(lines[i])


def rows_of(file, lines, begin, count):
    if begin + count > len(lines):
        raise FileError(f"{file} ends too early: its step at line {begin} claims {count} particles.")
    return lines[begin:begin + count]


def take_step(file, step, steps):
    """Returns the content of the chosen step, and the keywords of Body that tell its time and all times. steps: pairs (time, content). If
    a time is None, the number of the step takes its place."""
    times = [float(i) if time is None else time for i, (time, _) in enumerate(steps)]
    i = choose_step(file, step, times)
    return steps[i][1], {"time": times[i], "times": times}


def value_of(comment, key):
    """Returns the text behind KEY= in the second line of extended XYZ, with or without quotes; "" if there is none."""
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
            time = to_number(value_of(lines[at + 1], "time"))  # This is NaN where the line has no time.
            steps.append((None if time is None or time != time else time, at))
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
    """Returns six bounds, 0 for axes without a period; or the cell's sides, nine numbers, if a side with a period is tilted; or None if
    there is no period."""
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
    """Reads the items of a dump. An item is a line with its name, then lines with its content. A step's time is in the item
    TIME, else in TIMESTEP."""
    lines, at, steps, head = lines_of(path), 0, [], {}
    while at < len(lines):
        words, at = lines[at].split(), at + 1
        if not words:
            continue
        if words[0] != "ITEM:" or len(words) < 2:
            raise FileError(f"{path.name}: line {at} is no item of a dump of LAMMPS that is known here.")
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
            raise FileError(f"{path.name}: line {at} is no item of a dump of LAMMPS that is known here.")
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


# The columns of an atom in .data, by the style of the atoms. Three more columns may follow: by how many periods the atom has moved.
STYLES = {"atomic": "id type x y z", **dict.fromkeys(("bond", "angle", "molecular"), "id molecule type x y z"), "charge": "id type q x y z",
          "full": "id molecule type q x y z", "dipole": "id type q x y z mux muy muz",
          **dict.fromkeys(("sphere", "granular"), "id type diameter density x y z"), "sph": "id type rho esph cv x y z",
          "meso": "id type rho e cv x y z", "dpd": "id type theta x y z", "mdpd": "id type rho x y z", "edpd": "id type temperature cv x y z",
          "peri": "id type volume density x y z", "rheo": "id type status rho x y z", "rheo/thermal": "id type status rho energy x y z",
          "smd": "id type molecule volume mass kradius cradius x0 y0 z0 x y z"}


def read_gro(path, step):
    """Reads a .gro file, whose columns have fixed widths. The width of a number is the distance between two decimal points."""
    lines, at, steps = lines_of(path), 0, []
    while at < len(lines):
        if not lines[at].strip() and all(not line.strip() for line in lines[at:]):
            break
        count = whole_number(path.name, lines, at + 1)
        rows_of(path.name, lines, at + 2, count + 1)  # The box is a line, too.
        time = re.search(r"\bt=\s*(\S+)", lines[at])
        steps.append((to_number(time[1]) if time else None, at))
        at += count + 3
    at, times = take_step(path.name, step, steps)
    count = int(lines[at + 1])
    rows = rows_of(path.name, lines, at + 2, count)
    points = [found.start() for found in re.finditer(r"\.", rows[0][20:])] if rows else [0, 8]
    width = points[1] - points[0] if len(points) > 1 else 0
    columns = (len(rows[0].rstrip()) - 20) // width if width and rows else 3
    values = [numbers_of(" ".join(row[20 + i * width:20 + (i + 1) * width] for i in range(columns))) for row in rows]
    odd = next((i for i, row in enumerate(values) if len(row) != columns), None)
    if columns not in (3, 6) or odd is not None:
        raise FileError(f"{path.name}: line {at + 3 + (odd or 0)} has no three positions in columns of {width} characters.")
    values = np.array(values, float).reshape(count, columns)
    box = numbers_of(lines[at + 2 + count])
    if len(box) not in (3, 9):
        raise FileError(f"{path.name}: line {at + 3 + count} has {len(box)} numbers for its box, which are 3 or 9.")
    cell = np.diag(box[:3])
    if len(box) == 9:
        cell[0, 1], cell[0, 2], cell[1, 0], cell[1, 2], cell[2, 0], cell[2, 1] = box[3:]
    arrays = {name: np.array([row[begin:begin + 5].strip() for row in rows])
              for name, begin in (("residue", 5), ("species", 10)) if rows}
    arrays.update({"velocity": values[:, 3:]} if columns == 6 else {})
    return Body(values[:, :3], arrays, period=period_of(cell, [0.0] * 3, [True] * 3), **times)


def read_data(path):
    lines, head, sections = lines_of(path), {}, {}  # head: {word: numbers before it}; sections: {name: (style, first line)}
    for i, line in enumerate(lines[1:], 1):
        text, _, remark = line.partition("#")
        words = text.split()
        if words and words[0][0].isalpha():
            sections[" ".join(words)] = remark.strip(), i + 1
        elif not sections and words:
            numbers = [word for word in words if not word[0].isalpha()]
            head[" ".join(words[len(numbers):])] = numbers_of(" ".join(numbers))

    def rows_of_section(name, count):
        rows = [row for row in (line.partition("#")[0] for line in lines[sections[name][1]:]) if row.strip()][:count]
        if len(rows) < count:
            raise FileError(f"{path.name} ends too early: it claims {count} atoms.")
        return rows

    count = int(head["atoms"][0]) if len(head.get("atoms", ())) == 1 and head["atoms"][0] >= 0 else -1
    if count < 0 or "Atoms" not in sections:
        raise FileError(f"{path.name} is no data file of LAMMPS: it has no line 'N atoms', or no section Atoms.")
    style, rows = sections["Atoms"][0], rows_of_section("Atoms", count)
    width = len(rows[0].split()) if rows else 5
    style = style or ("atomic" if width == 5 else "")
    if style not in STYLES:
        raise FileError(f"{path.name}: the style of its section Atoms is '{style}'; write 'Atoms # STYLE', one of "
                        f"{', '.join(STYLES)}.")
    names = STYLES[style].split()
    if width not in (len(names), len(names) + 3):
        raise FileError(f"{path.name}: an atom has {width} values, where the style {style} has {len(names)}, or three more.")
    columns = columns_of(path.name, rows, names + ["ix", "iy", "iz"][:width - len(names)])
    points = np.stack([columns.pop(axis) for axis in "xyz"], axis=1)
    if points.dtype.kind != "f":
        raise FileError(f"{path.name}: its positions are no numbers.")
    order = {number: i for i, number in enumerate(columns["id"].tolist())}
    if "Velocities" in sections:
        found = columns_of(path.name, rows_of_section("Velocities", count), ["id", "vx", "vy", "vz"])
        if sorted(found["id"].tolist()) != sorted(order):
            raise FileError(f"{path.name}: its section Velocities has other atoms than its section Atoms.")
        columns["Velocity"] = np.empty((count, 3))
        columns["Velocity"][[order[number] for number in found["id"].tolist()]] = np.stack([found["v" + axis] for axis in "xyz"], 1)
    if "Masses" in sections and "mass" not in columns:
        masses = columns_of(path.name, rows_of_section("Masses", int(head.get("atom types", [0])[0])), ["type", "mass"])
        of_type = dict(zip(masses["type"].tolist(), masses["mass"].tolist()))
        columns["mass"] = np.array([of_type.get(kind, np.nan) for kind in columns["type"].tolist()], float)
    return Body(points, columns)
