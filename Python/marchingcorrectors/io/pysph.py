# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads PySPH's .hdf5: all particle arrays become one set, and the names of particle arrays tell walls."""

import numpy as np

from .._find import tells_of_walls
from ._particles import FileError, Particles
from .hdf5 import Part, check_claims, data_set, get, load, names_of


def read_pysph(path):
    import h5py

    with h5py.File(path, "r") as file:
        particles = get(file, "particles")
        places = {name: get(particles, name) for name in particles}
        places = {name: place if get(place, "arrays") is None else get(place, "arrays") for name, place in places.items()}
        check_claims(places.values())
        sets = {}  # {name: (Part of this process's own particles (tag 0), names of arrays of one value each)}
        for name, place in places.items():
            part = Part(path, place.name, data_set(place, "x").size if get(place, "x") is not None else 0)
            names = [each for each in names_of(place, part.count) if get(place, each).ndim == 1]
            sets[name] = part.where(load([part], "tag") == 0) if "tag" in names else part, names
        solver = {name: np.ravel(value)[0].item() for name, value in get(file, "solver_data").attrs.items()
                  if np.asarray(value).dtype.kind in "fiub" and np.size(value) == 1}
    sets = {name: (part, names) for name, (part, names) in sets.items() if part.size()}
    if not sets:
        raise FileError(f"{path.name} has no particles.")
    parts, counts = [part for part, _ in sets.values()], [part.size() for part, _ in sets.values()]
    walls = [tells_of_walls(name) for name in sets]
    fluids = [names for (_, names), wall in zip(sets.values(), walls) if not wall] or [names for _, names in sets.values()]
    names = [name for name in fluids[0] if all(name in each for each in fluids)]
    solid = np.repeat(walls, counts)

    def array(name):
        """Returns one array of all sets; 0 for walls that lack it, because walls take no part in a field."""
        there = [name in each for _, each in sets.values()]
        found = load([part for part, has in zip(parts, there) if has], name)
        if all(there):
            return found
        whole = np.zeros(len(solid), found.dtype)
        whole[np.repeat(there, counts)] = found
        return whole

    arrays = {name: lambda n=name: array(n) for name in names}

    def vector(letters):
        def read():
            whole = np.zeros((len(solid), 3))
            for i, letter in enumerate(letters):
                if letter in names:
                    whole[:, i] = array(letter)
            return whole
        return read

    if {"u", "v"} <= set(names):
        arrays["Velocity"] = vector("uvw")
    flat = "z" not in names or not array("z").any()
    return Particles(path.name, "PySPH", vector("xyz"), arrays, smoothing_length="h" if "h" in names else None,
                     mass="m" if "m" in names else None, density="rho" if "rho" in names else None,
                     solid=solid if solid.any() and not solid.all() else None, time=solver.get("t"),
                     dimension=2 if flat else 3,
                     parameters={**solver, "sets": dict(zip(sets, counts))})
