# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads files of molecular dynamics: GROMACS' .gro, with many steps, and LAMMPS' .data."""
import re

import numpy as np

from ._particles import Body, FileError
from .tables import columns_of, lines_of, numbers_of, period_of, rows_of, take_step, to_number, whole_number

# The columns of an atom in .data, by its style; images may follow.
STYLES = {"atomic": "id type x y z", **dict.fromkeys(("bond", "angle", "molecular"), "id molecule type x y z"), "charge": "id type q x y z",
          "full": "id molecule type q x y z", "dipole": "id type q x y z mux muy muz",
          **dict.fromkeys(("sphere", "granular"), "id type diameter density x y z"), "sph": "id type rho esph cv x y z",
          "meso": "id type rho e cv x y z", "dpd": "id type theta x y z", "mdpd": "id type rho x y z", "edpd": "id type temperature cv x y z",
          "peri": "id type volume density x y z", "rheo": "id type status rho x y z", "rheo/thermal": "id type status rho energy x y z",
          "smd": "id type molecule volume mass kradius cradius x0 y0 z0 x y z"}


def read_gro(path, step):
    """Reads columns of fixed width: the distance between two decimal points is the width of a number."""
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


def sections_of(path, lines):
    """Returns the head, {word: numbers before it}, and {section: (its style, its first line)}."""
    head, sections = {}, {}
    for i, line in enumerate(lines[1:], 1):
        text, _, remark = line.partition("#")
        words = text.split()
        if words and words[0][0].isalpha():
            sections[" ".join(words)] = remark.strip(), i + 1
        elif not sections and words:
            numbers = [word for word in words if not word[0].isalpha()]
            head[" ".join(words[len(numbers):])] = numbers_of(" ".join(numbers))
    return head, sections


def rows_in(path, lines, begin, count):
    rows = [line.partition("#")[0] for line in lines[begin:] if line.partition("#")[0].strip()][:count]
    if len(rows) < count:
        raise FileError(f"{path.name} ends too early: it claims {count} atoms.")
    return rows


def read_data(path):
    lines = lines_of(path)
    head, sections = sections_of(path, lines)
    count = int(head["atoms"][0]) if len(head.get("atoms", ())) == 1 and head["atoms"][0] >= 0 else -1
    if count < 0 or "Atoms" not in sections:
        raise FileError(f"{path.name} is no data file of LAMMPS: it has no line 'N atoms', or no section Atoms.")
    style, begin = sections["Atoms"]
    rows = rows_in(path, lines, begin, count)
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
        found = columns_of(path.name, rows_in(path, lines, sections["Velocities"][1], count), ["id", "vx", "vy", "vz"])
        if sorted(found["id"].tolist()) != sorted(order):
            raise FileError(f"{path.name}: its section Velocities has other atoms than its section Atoms.")
        columns["Velocity"] = np.empty((count, 3))
        columns["Velocity"][[order[number] for number in found["id"].tolist()]] = np.stack([found["v" + axis] for axis in "xyz"], 1)
    if "Masses" in sections and "mass" not in columns:
        masses = columns_of(path.name, rows_in(path, lines, sections["Masses"][1], int(head.get("atom types", [0])[0])), ["type", "mass"])
        of_type = dict(zip(masses["type"].tolist(), masses["mass"].tolist()))
        columns["mass"] = np.array([of_type.get(kind, np.nan) for kind in columns["type"].tolist()], float)
    return Body(points, columns)
