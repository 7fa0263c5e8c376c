# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads VTK's files, such as those of SPHinXsys, PartVTK and SPlisHSPlasH, and tables. Several bodies become one set, with walls
marked."""
import re
from importlib import import_module

import numpy as np

from .._find import tells_of_walls
from ._bytes import ending_of, read_head
from ._particles import FileError, Particles, add_velocity, choose_step, join, join_bodies, usual_quantities

TABLES = (".csv", ".tsv", ".txt", ".dat", ".asc", ".ascii")
XYZ = (".xyz", ".extxyz", ".exyz")
LISTS = (".pvtp", ".pvtu", ".pvd", ".series")
DUMPS = (".dump", ".lammpstrj")
PACKED = (*TABLES, *XYZ, *DUMPS, ".gro", ".data", ".ply")  # These endings may be followed by .gz.


def read_list(path, step):
    """Reads one step of a .pvd or .series file, which lists files of several times."""
    from .vtk_files import list_series, list_times
    times = (list_times if ending_of(path) == ".pvd" else list_series)(path)
    time = list(times)[choose_step(path.name, step, times)]
    body = join_bodies([load(each, 0) for each in check_parts(path, times[time])])
    return body._replace(time=time, times=list(times))


def read_pieces(path):
    from .vtk_files import list_pieces, read_xml
    return join_bodies([read_xml(piece) for piece in check_parts(path, list_pieces(path))])


# The module and the function that read a file, and whether it may hold several steps.
READERS = {**{ending: ("tables", "read_table", False) for ending in TABLES}, **{ending: ("molecules", "read_xyz", True) for ending in XYZ},
           **{ending: ("molecules", "read_lammps", True) for ending in DUMPS}, ".gro": ("molecules", "read_gro", True),
           ".data": ("molecules", "read_data", False), ".ply": ("tables", "read_ply", False), ".npz": ("tables", "read_arrays", False),
           ".npy": ("tables", "read_arrays", False), ".vtp": ("vtk_files", "read_xml", False), ".vtu": ("vtk_files", "read_xml", False),
           ".vtk": ("vtk_files", "read_legacy", False), ".vtkhdf": ("hdf5", "read_vtkhdf", True), ".pvtp": ("bodies", "read_pieces", False),
           ".pvtu": ("bodies", "read_pieces", False), ".pvd": ("bodies", "read_list", True), ".series": ("bodies", "read_list", True)}
ENDINGS = (*READERS, ".gz")


def reader_of(path):
    """Finds the format by the name's ending, except for files that begin like a dump, and .xyz files without a count, which are tables."""
    ending = ending_of(path)
    head = read_head(path) if path.is_file() and (ending in PACKED or ending not in READERS) else b""
    if head.startswith(b"ITEM:"):
        return READERS[".dump"]
    if ending in XYZ and not re.match(rb"\s*[0-9]+\s*\n", head):
        return READERS[".txt"]
    if path.suffix.lower() == ".gz" and ending not in PACKED:
        return None
    return READERS.get(ending)


def check_parts(path, parts):
    for part in parts:
        if ending_of(part) in (".pvd", ".series") or ending_of(part) not in READERS:
            raise FileError(f"{path.name} lists {part.name}, which is no file of particles that are bodies.")
        if not part.is_file():
            raise FileError(f"{path.name} lists '{part}', and there is no such file.")
    return parts


def load(path, step):
    module, name, has_steps = reader_of(path)
    read = getattr(import_module("." + module, __package__), name)
    if has_steps:
        return read(path, step)
    choose_step(path.name, step, [0.0])
    return read(path)


def column(name, bodies, fluids):
    """Returns one array of all bodies. Walls that lack it get the fluid's median: they take part in no field, so only their
    smoothing lengths, and the arrays that give volumes, matter."""
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
    if not any(len(body.points) or body.times or body.time is not None for body in bodies):  # A step of a film may be empty.
        raise FileError(f"{paths[0].name} has no points.")
    marked = [path in walls or not walls and len(every) > 1 and tells_of_walls(path.stem) for path in every]
    counts = [len(body.points) for body in bodies]
    fluids = [body for body, wall in zip(bodies, marked) if not wall] or bodies
    common = [name for name in fluids[0].arrays if all(
        name in body.arrays and body.arrays[name].shape[1:] == fluids[0].arrays[name].shape[1:] for body in fluids)]
    arrays = {name: lambda n=name: column(n, bodies, fluids) for name in common}
    single = [name for name in common if fluids[0].arrays[name].ndim == 1 and fluids[0].arrays[name].dtype.kind in "fiub"]
    add_velocity(arrays, single)
    solid = np.repeat(marked, counts)
    if "Type" in common and ("Rhop" in common or "Idp" in common):
        solid |= arrays["Type"]() != 3  # PartVTK's number for fluid
    return Particles(paths[0].name, "VTK", lambda: join([body.points for body in bodies]), arrays,
                     **usual_quantities(single), solid=solid if solid.any() else None, time=bodies[0].time, **{"cell" if len(fluids[0].period or ()) == 9 else "period": fluids[0].period},
                     times=bodies[0].times, parameters={"bodies": dict(zip([path.name for path in every], counts))})
