# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""VTK's files, of SPHinXsys, PartVTK, SPlisHSPlasH, and tables: several bodies as one set, walls marked."""
import re

import numpy as np

from ._particles import WALL, FileError, Particles, choose_step, join, join_bodies, usual

TABLES = (".csv", ".tsv", ".txt", ".dat", ".asc", ".ascii")
XYZ = (".xyz", ".extxyz", ".exyz")
LISTS = (".pvtp", ".pvtu", ".pvd")
ENDINGS = (".vtp", ".vtu", ".vtk", ".vtkhdf", *LISTS, *TABLES, *XYZ, ".dump", ".lammpstrj")


def is_dump(path):
    with open(path, "rb") as file:
        return file.read(5) == b"ITEM:"


def has_count(path):
    """Whether an .xyz file has steps, each behind its number of particles; else it is a table of positions."""
    with open(path, "rb") as file:
        return re.fullmatch(rb"\s*[0-9]+\s*", file.readline(100)) is not None


def may_hold_steps(path):
    return path.suffix.lower() in (".vtkhdf", ".pvd", *XYZ) or path.is_file() and is_dump(path)


def check_parts(path, parts):
    for part in parts:
        if part.suffix.lower() == ".pvd" or part.suffix.lower() not in ENDINGS:
            raise FileError(f"{path.name} lists {part.name}, which is no file of particles that are bodies.")
        if not part.is_file():
            raise FileError(f"{path.name} lists '{part}', and there is no such file.")
    return parts


def load(path, step):
    ending = path.suffix.lower()
    if is_dump(path):
        from .tables import read_lammps
        return read_lammps(path, step)
    if ending in XYZ and has_count(path):
        from .tables import read_xyz
        return read_xyz(path, step)
    if ending == ".vtkhdf":
        from .vtkhdf import read_vtkhdf
        return read_vtkhdf(path, step)
    if ending == ".pvd":
        from .vtk_xml import list_times
        times = list_times(path)
        time = list(times)[choose_step(path.name, step, times)]
        body = join_bodies([load(each, 0) for each in check_parts(path, times[time])])
        return body._replace(time=time, times=list(times))
    choose_step(path.name, step, [0.0])
    if ending in LISTS:
        from .vtk_xml import list_pieces, read_xml
        return join_bodies([read_xml(piece) for piece in check_parts(path, list_pieces(path))])
    if ending == ".vtk":
        from .legacy import read_legacy
        return read_legacy(path)
    if ending in (".vtp", ".vtu"):
        from .vtk_xml import read_xml
        return read_xml(path)
    from .tables import read_table
    return read_table(path)


def column(name, bodies, fluids):
    """One array of all bodies. Walls without it have the fluid's median there: they take part in no field, so only
    smoothing lengths, and what volumes are made of, count."""
    shape = fluids[0].arrays[name].shape[1:]
    parts = [body.arrays.get(name) for body in bodies]
    parts = [part if part is not None and part.shape[1:] == shape else None for part in parts]
    if any(part is None for part in parts):
        values = join([body.arrays[name] for body in fluids])
        middle = (len(values) - 1) // 2
        median = np.partition(values, middle, axis=0)[middle]
        parts = [np.broadcast_to(median, (len(body.points), *shape)) if part is None else part
                 for part, body in zip(parts, bodies)]
    return join(parts)


def read_bodies(paths, walls, step):
    every = paths + [path for path in walls if path not in paths]
    bodies = [load(path, step) for path in every]
    if not any(len(body.points) or body.times for body in bodies):  # a step of a film may be empty
        raise FileError(f"{paths[0].name} has no points.")
    marked = [path in walls or not walls and len(every) > 1 and bool(WALL.search(path.stem)) for path in every]
    counts = [len(body.points) for body in bodies]
    fluids = [body for body, wall in zip(bodies, marked) if not wall] or bodies
    common = [name for name in fluids[0].arrays if all(
        name in body.arrays and body.arrays[name].shape[1:] == fluids[0].arrays[name].shape[1:] for body in fluids)]
    arrays = {name: lambda n=name: column(n, bodies, fluids) for name in common}
    single = [name for name in common if fluids[0].arrays[name].ndim == 1 and fluids[0].arrays[name].dtype.kind in "fiub"]
    if {"vx", "vy", "vz"} <= set(single) and "Velocity" not in common:
        arrays["Velocity"] = lambda: np.stack([arrays[name]() for name in ("vx", "vy", "vz")], axis=1)
    solid = np.repeat(marked, counts)
    if "Type" in common and ("Rhop" in common or "Idp" in common):
        solid |= arrays["Type"]() != 3  # PartVTK's
    return Particles(paths[0].name, "VTK", lambda: join([body.points for body in bodies]), arrays,
                     **{name: usual(single, name) for name in ("smoothing_length", "volume", "mass", "density")},
                     solid=solid if solid.any() else None, time=bodies[0].time, **{"cell" if len(fluids[0].period or ()) == 9 else "period": fluids[0].period},
                     times=bodies[0].times, parameters={"bodies": dict(zip([path.name for path in every], counts))})
