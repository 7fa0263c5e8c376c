# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Solvers' own files: read(path) gives particles that the functions take in place of positions.

    marchingcorrectors.isosurface(marchingcorrectors.io.read("snapshot.hdf5"), "Density", 1e-4)
"""
from __future__ import annotations

import os
import re
from importlib import import_module
from pathlib import Path
from typing import Any, Iterator, Sequence, Union

import numpy as np

from .._arrays import tells_of_walls
from ._particles import (FileError, NoPoints, Particles, add_velocity, choose_step, ending_of, join, join_bodies, read_head, shared_arrays,
                         usual_quantities)
from .binary import order_of, read_bgeo, read_bi4, read_gadget_binary, read_phantom_dump
from .vtk_files import list_pieces, list_series, list_times, read_xml

TABLES = (".csv", ".tsv", ".txt", ".dat", ".asc", ".ascii")
XYZ = (".xyz", ".extxyz", ".exyz")
LISTS = (".pvtp", ".pvtu", ".pvd", ".series")
DUMPS = (".dump", ".lammpstrj")
PACKED = (*TABLES, *XYZ, *DUMPS, ".gro", ".data", ".ply")  # These endings may be followed by .gz.
# For each ending: the module (none: this one) and the function that read a file, and whether the file may hold several steps.
READERS = {**{ending: ("tables", "read_table", False) for ending in TABLES}, **{ending: ("molecules", "read_xyz", True) for ending in XYZ},
           **{ending: ("molecules", "read_lammps", True) for ending in DUMPS}, ".gro": ("molecules", "read_gro", True),
           ".data": ("molecules", "read_data", False), ".ply": ("tables", "read_ply", False), ".npz": ("tables", "read_arrays", False),
           ".npy": ("tables", "read_arrays", False), ".vtp": ("vtk_files", "read_xml", False), ".vtu": ("vtk_files", "read_xml", False),
           ".vtk": ("vtk_files", "read_legacy", False), ".vtkhdf": ("hdf5", "read_vtkhdf", True), ".pvtp": ("", "read_pieces", False),
           ".pvtu": ("", "read_pieces", False), ".pvd": ("", "read_list", True), ".series": ("", "read_list", True)}
HDF5 = (".hdf5", ".h5", ".h5part")
ENDINGS = (*HDF5, ".bi4", ".bgeo", *READERS, ".gz")
PathName = Union[str, "os.PathLike[str]"]
__all__ = ["ENDINGS", "FileError", "Particles", "count_steps", "read", "read_steps"]


def read(path: Union[PathName, Sequence[PathName]], *, types: Union[None, str, int, Sequence[Union[str, int]]] = None,
         walls: Sequence[PathName] = (), step: int = 0) -> Particles:
    """Returns the particles of one time.

    path: a file, or a list of files that together are one set of particles, such as a file for each body (VTK's files, tables).
    types: the types of particles in GADGET-like files: names, such as "gas", "dark_matter", "stars", or numbers; by default gas.
    walls: the files that hold walls; `path` may list them, too. By default, if there are several files, those with names such
        as Wall or Boundary hold walls.
    step: the number of the step, if the file holds several steps (.vtkhdf, .xyz, .gro, LAMMPS' dumps, H5Part) or lists them (.pvd,
        .series); -1 is the last step. The result's `times` are the times of all steps.

    Raises FileError. No code that a file may hold is run.
    """
    paths = [Path(each) for each in ([path] if isinstance(path, (str, os.PathLike)) else path)]
    if not paths:
        raise FileError("No file was given.")
    try:
        return _read(paths, types, [Path(each) for each in walls], step)
    except FileError:
        raise
    except ImportError as error:
        package = "vtk" if str(error.name).startswith("vtk") else str(error.name).partition(".")[0]
        if package == "marchingcorrectors":  # A script of the same name may hide a module of Python's.
            raise
        of_debian = " (of Debian's Python: apt install python3-h5py)" if package == "h5py" else ""
        raise FileError(f"{paths[0].name} needs the package {package}: pip install {package}{of_debian}.") from None
    except MemoryError:
        raise FileError(f"{paths[0].name} asks for more memory than there is: it is damaged, or too large.") from None
    except Exception as error:  # For damaged files each library has its own exceptions.
        raise FileError(f"{paths[0].name} cannot be read: {' '.join(str(error).split())[:200]}") from None


def count_steps(path: PathName) -> int:
    """Returns how many steps a file holds. Only .vtkhdf, .xyz, .gro, dumps of LAMMPS, H5Part, .pvd and .series may hold more than one."""
    reader = reader_of(Path(path))
    if not (reader and reader[2]) and Path(path).suffix.lower() not in HDF5:
        return 1
    try:
        return len(read(path).times or [0])
    except FileError:  # A damaged first step says nothing of the other steps.
        return len(read(path, step=-1).times or [0])


def read_steps(path: Union[PathName, Sequence[PathName]], **words: Any) -> Iterator[Particles]:
    """Yields the particles of each time of a film: all steps of the first file, then those of the next file.

    Example: levels = [gauge(particles, lines).last for particles in read_steps("run.pvd")]

    words: the keywords of read().
    """
    for each in [path] if isinstance(path, (str, os.PathLike)) else path:
        for step in range(count_steps(each)):
            yield read(each, step=step, **words)


def _read(paths, types, walls, step):
    for path in paths + walls:
        if not path.is_file():
            raise FileError(f"There is no file '{path}'.")
        if path.stat().st_size == 0:
            raise FileError(f"{path.name} is empty.")
    path, ending = paths[0], paths[0].suffix.lower()
    with open(path, "rb") as file:
        head = file.read(64)
    reader = reader_of(path)
    is_hdf5, is_gadget = head.startswith(b"\x89HDF\r\n\x1a\n"), order_of(head) is not None
    if reader and (ending == ".vtkhdf" or not is_hdf5 and not is_gadget):
        return read_bodies(paths, walls, step)
    if len(paths) > 1 or walls:
        raise FileError("Several files are one set only where they are bodies: VTK's, or tables.")
    if is_hdf5:
        from .hdf5 import read_hdf5
        return read_hdf5(path, types, step)
    choose_step(path.name, step, [0.0])
    if ending in (".pkl", ".pickle"):
        raise FileError(f"{path.name} is not opened: pickles can run code. Let the solver write HDF5 (PySPH: install h5py).")
    if is_gadget:
        return read_gadget_binary(path, types)
    if head.startswith(b"#FileJBD "):
        return read_bi4(path)
    if read_head(path).startswith(b"BgeoV"):
        return read_bgeo(path)
    if head[4:8] in (b"\x61\xed\0\0", b"\0\0\xed\x61") or head[4:12] == b"\x61\xed\0\0\0\0\0\0":
        return read_phantom_dump(path)
    raise FileError(f"{path.name} is in no format that is known here (HDF5, .bi4, .bgeo, VTK, .csv, .txt, .xyz, .ply, "
                    ".npz, .gro, LAMMPS, dumps of Phantom, GADGET; of .gz text alone), or its beginning is damaged.")


# -- Files of one body each: tables, and VTK's files (SPHinXsys, PartVTK, SPlisHSPlasH). They are joined to one set with marked walls. --

def read_list(path, step):
    """Reads one step of a .pvd or .series file, which lists files of several times."""
    times = (list_times if ending_of(path) == ".pvd" else list_series)(path)
    time = list(times)[choose_step(path.name, step, times)]
    body = join_bodies([load(each, 0) for each in check_parts(path, times[time])])
    return body._replace(time=time, times=list(times))


def read_pieces(path):
    return join_bodies([read_xml(piece) for piece in check_parts(path, list_pieces(path))])


def reader_of(path):
    """Returns the file's entry of READERS, or None. The ending of the file's name decides, with two exceptions: a file that begins
    like a dump of LAMMPS is a dump, and a .xyz file without a count is a table."""
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
    load_it = getattr(import_module("." + module, __name__), name) if module else globals()[name]
    if has_steps:
        return load_it(path, step)
    choose_step(path.name, step, [0.0])
    return load_it(path)


def column(name, bodies, fluids):
    """Returns the array `name` of all bodies, joined. Walls without the array get the fluid's median: walls take part in no
    field, so only their smoothing lengths, and the arrays that give volumes, matter."""
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
        raise NoPoints(f"{paths[0].name} has no points.")
    marked = [path in walls or not walls and len(every) > 1 and tells_of_walls(path.stem) for path in every]
    counts = [len(body.points) for body in bodies]
    fluids = [body for body, wall in zip(bodies, marked) if not wall] or bodies
    fluids = [body for body in fluids if len(body.points)] or fluids
    common = shared_arrays(fluids)
    arrays = {name: lambda n=name: column(n, bodies, fluids) for name in common}
    single = [name for name in common if fluids[0].arrays[name].ndim == 1 and fluids[0].arrays[name].dtype.kind in "fiub"]
    add_velocity(arrays, single)
    solid = np.repeat(marked, counts)
    if "Type" in common and ("Rhop" in common or "Idp" in common):
        solid |= arrays["Type"]() != 3  # PartVTK's number for fluid
    return Particles(paths[0].name, "VTK", lambda: join([body.points for body in bodies]), arrays,
                     **usual_quantities(single), solid=solid if solid.any() else None, time=bodies[0].time, **{"cell" if len(fluids[0].period or ()) == 9 else "period": fluids[0].period},
                     times=bodies[0].times, parameters={"bodies": dict(zip([path.name for path in every], counts))})
