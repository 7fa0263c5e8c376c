# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Solvers' own files: read(path) gives particles that the functions take in place of positions.

    marchingcorrectors.isosurface(marchingcorrectors.io.read("snapshot.hdf5"), "Density", 1e-4)
"""
from __future__ import annotations

import os
from pathlib import Path
from typing import Optional, Sequence, Union

from ._particles import FileError, Particles

ENDINGS = (".hdf5", ".h5", ".bi4", ".bgeo", ".vtp", ".vtu", ".vtk")
PathName = Union[str, "os.PathLike[str]"]
__all__ = ["ENDINGS", "FileError", "Particles", "read"]


def read(path: Union[PathName, Sequence[PathName]], *, types: Optional[Sequence[Union[str, int]]] = None,
         walls: Sequence[PathName] = ()) -> Particles:
    """Particles of one time.

    path: a file, or a list of files of bodies (.vtp, .vtu, .vtk) that are one set.
    types: of GADGET-like files, names as "gas", "dark_matter", "stars", or numbers; by default gas.
    walls: those of the listed files that hold walls; by default names tell (Wall, Boundary, ...).

    Raises FileError. No code that a file may hold is run.
    """
    if isinstance(path, (str, os.PathLike)):
        paths = [Path(path)]
    else:
        paths = [Path(each) for each in path]
    if not paths:
        raise FileError("No file was given.")
    try:
        return _read(paths, types, [Path(each) for each in walls])
    except FileError:
        raise
    except ImportError as error:
        package = "vtk" if str(error.name).startswith("vtk") else str(error.name).partition(".")[0]
        raise FileError(f"{paths[0].name} needs the package {package}: pip install {package}.") from None
    except MemoryError:
        raise FileError(f"{paths[0].name} asks for more memory than there is: it is damaged, or too large.") from None
    except Exception as error:  # of a damaged file each library has its own kinds
        raise FileError(f"{paths[0].name} cannot be read: {' '.join(str(error).split())[:200]}") from None


def _read(paths, types, walls):
    for path in paths + walls:
        if not path.is_file():
            raise FileError(f"There is no file '{path}'.")
        if path.stat().st_size == 0:
            raise FileError(f"{path.name} is empty.")
    path, ending = paths[0], paths[0].suffix.lower()
    if ending in (".vtp", ".vtu", ".vtk"):
        from .bodies import read_bodies
        return read_bodies(paths, walls)
    if len(paths) > 1 or walls:
        raise FileError("Several files are one set only where they are bodies: .vtp, .vtu or .vtk.")
    if ending in (".npz", ".npy", ".pkl", ".pickle"):
        raise FileError(f"{path.name} is not opened: such files of solvers hold pickles, which can run code. Let the "
                        "solver write HDF5 (PySPH: install h5py).")
    with open(path, "rb") as file:
        head = file.read(64)
    if head.startswith(b"\x89HDF\r\n\x1a\n"):
        from .snapshot import read_snapshot
        return read_snapshot(path, types)
    if head.startswith(b"#FileJBD "):
        from .bi4 import read_bi4
        return read_bi4(path)
    if head.startswith((b"BgeoV", b"\x1f\x8b")) and ending != ".npz":
        from .bgeo import read_bgeo
        return read_bgeo(path)
    if head[4:8] in (b"\x61\xed\0\0", b"\0\0\xed\x61") or head[4:12] == b"\x61\xed\0\0\0\0\0\0":
        from .phantom import read_native
        return read_native(path)
    raise FileError(f"{path.name} is in no format that is known here (HDF5, .bi4, .bgeo, VTK, Phantom's dumps), or its "
                    "beginning is damaged.")
