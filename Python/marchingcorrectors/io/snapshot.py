# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""HDF5: which solver's layout it is."""
from . import gadget, phantom, pysph
from ._particles import FileError


def read_snapshot(path, types):
    import h5py

    with h5py.File(path, "r") as file:
        names = set(file)
    if any(name.startswith("PartType") for name in names):
        return gadget.read_gadget(path, types)
    if types is not None:
        raise FileError(f"{path.name} is no snapshot of GADGET's layout: it has no types to choose.")
    if {"header", "particles"} <= names:
        return phantom.read_hdf5_dump(path)
    if {"solver_data", "particles"} <= names:
        return pysph.read_pysph(path)
    raise FileError(f"{path.name} is HDF5, but no layout that is known here: GADGET, GIZMO, AREPO and SWIFT have "
                    "PartType0, Phantom has header and particles, PySPH has solver_data and particles.")
