# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Solvers' own files: read(path) gives particles that the functions take in place of positions.

    marchingcorrectors.isosurface(marchingcorrectors.io.read("snapshot.hdf5"), "Density", 1e-4)
"""
from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Iterator, Sequence, Union

from . import bodies
from ._bytes import read_head
from ._particles import FileError, Particles, choose_step
from .binary import order_of, read_bgeo, read_bi4, read_gadget_binary, read_phantom_dump

HDF5 = (".hdf5", ".h5", ".h5part")
ENDINGS = (*HDF5, ".bi4", ".bgeo", *bodies.ENDINGS)
PathName = Union[str, "os.PathLike[str]"]
__all__ = ["ENDINGS", "FileError", "Particles", "count_steps", "read", "read_steps"]


def read(path: Union[PathName, Sequence[PathName]], *, types: Union[None, str, int, Sequence[Union[str, int]]] = None,
         walls: Sequence[PathName] = (), step: int = 0) -> Particles:
    """Returns the particles of one time.

    path: a file, or a list of files of bodies (VTK's, tables) that are one set.
    types: for GADGET-like files: names, such as "gas", "dark_matter", "stars", or numbers; by default gas.
    walls: the listed files that hold walls; by default their names tell (Wall, Boundary, ...).
    step: the number of a step in a file of several (.vtkhdf, .xyz, .gro, LAMMPS' dumps, H5Part, lists); -1 is the last one. The
        result's `times` are the times of all steps.

    Raises FileError. No code that a file may hold is run.
    """
    if isinstance(path, (str, os.PathLike)):
        paths = [Path(path)]
    else:
        paths = [Path(each) for each in path]
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
    """How many steps a file holds; more than one only in .vtkhdf, .xyz, .gro, dumps of LAMMPS, H5Part, .pvd and .series."""
    reader = bodies.reader_of(Path(path))
    return len(read(path).times or [0]) if (reader and reader[2]) or Path(path).suffix.lower() in HDF5 else 1


def read_steps(path: Union[PathName, Sequence[PathName]], **words: Any) -> Iterator[Particles]:
    """Particles of each time of a film: of one file after the other, and of all steps that a file holds.

    Example: levels = [gauge(particles, lines).last for particles in read_steps("run.pvd")]

    words: those of read().
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
    reader = bodies.reader_of(path)
    is_hdf5, is_gadget = head.startswith(b"\x89HDF\r\n\x1a\n"), order_of(head) is not None
    if reader and (ending == ".vtkhdf" or not is_hdf5 and not is_gadget):
        return bodies.read_bodies(paths, walls, step)
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
