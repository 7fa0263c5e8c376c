# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""PySPH's .hdf5: all arrays of particles as one set, walls marked by the names of arrays."""
import re

import numpy as np

from ._particles import FileError, Particles, join
from .hdf5 import check, get, is_numbers

WALL = re.compile(r"solid|bound|wall|tank|obstacle", re.I)


def read_pysph(path):
    import h5py

    with h5py.File(path, "r") as file:
        sets = {name: load_set(file["particles"][name]) for name in file["particles"]}
        solver = {name: np.ravel(value)[0].item() for name, value in file["solver_data"].attrs.items()
                  if np.asarray(value).dtype.kind in "fiub" and np.size(value) == 1}
    sets = {name: arrays for name, arrays in sets.items() if len(arrays.get("x", ()))}
    if not sets:
        raise FileError(f"{path.name} has no particles.")
    walls = {name for name in sets if WALL.search(name)}
    fluids = [arrays for name, arrays in sets.items() if name not in walls] or list(sets.values())
    names = [name for name in fluids[0] if all(name in arrays for arrays in fluids)]
    counts = [len(arrays["x"]) for arrays in sets.values()]
    solid = np.repeat([name in walls for name in sets], counts)

    def array(name):
        """Walls take no part in a field: where they have no such array, it is 0 there."""
        kind = fluids[0][name].dtype
        return join([each.get(name, np.zeros(len(each["x"]), kind)) for each in sets.values()])

    arrays = {name: lambda n=name: array(n) for name in names}

    def vector(parts):
        return lambda: np.stack([arrays[part]() if part in arrays else np.zeros(sum(counts)) for part in parts], 1)

    if {"u", "v"} <= set(names):
        arrays["Velocity"] = vector("uvw")
    flat = "z" not in names or not np.any(arrays["z"]())
    return Particles(path.name, "PySPH", vector("xyz"), arrays, smoothing_length="h" if "h" in names else None,
                     mass="m" if "m" in names else None, density="rho" if "rho" in names else None,
                     solid=solid if solid.any() and not solid.all() else None, time=solver.get("t"),
                     dimension=2 if flat else 3,
                     parameters={**solver, "sets": dict(zip(sets, counts))})


def load_set(group):
    """{name: values} of particles that are this process's own (tag 0)."""
    place = get(group, "arrays")
    place = group if place is None else place
    data = {name: check(get(place, name))[()] for name in place if is_numbers(get(place, name))}
    count = len(data.get("x", ()))
    data = {name: values for name, values in data.items() if values.shape == (count,)}
    own = data["tag"] == 0 if "tag" in data else np.ones(count, bool)
    return {name: values if own.all() else values[own] for name, values in data.items()}
