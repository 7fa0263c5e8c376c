# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads H5Part, as SPH-EXA writes it: a group Step#N for each step, with x, y, z and arrays of one value per particle."""
import re

import numpy as np

from ._particles import FileError, Particles, choose_step, usual
from .gadget import number
from .hdf5 import Part, data_set, get, load, names_of


def is_h5part(names):
    return any(re.fullmatch("Step#[0-9]+", name) for name in names)


def period_of(attributes):
    """Returns the period from SPH-EXA's box, x0, x1, y0, ..., and boundaryType: 0 open, 1 periodic, 2 fixed."""
    box, kinds = np.ravel(attributes.get("box", ())), np.ravel(attributes.get("boundaryType", ()))
    if len(box) != 6 or len(kinds) != 3 or not np.isfinite(box.astype(float)).all():
        return None
    bounds = [float(side) if int(kinds[i // 2]) == 1 else 0.0 for i, side in enumerate(box)]
    return bounds if any(bounds) else None


def read_h5part(path, step):
    import h5py

    with h5py.File(path, "r") as file:
        steps = sorted((int(name[5:]), name) for name in file if is_h5part([name]))
        found = [number(get(file, name).attrs, "time") for _, name in steps]
        times = [float(i) for i, _ in steps] if None in found else found
        name = steps[choose_step(path.name, step, times)][1]
        group = get(file, name)
        axes = [axis for axis in "xyz" if get(group, axis) is not None]
        if len(axes) < 3:
            raise FileError(f"{path.name}: of x, y and z of its positions {name} has {', '.join(axes) or 'none'}.")
        part = Part(path, group.name, data_set(group, "x").size)
        names = [each for each in names_of(group, part.count) if get(group, each).ndim == 1]
        period = period_of(dict(group.attrs))
    arrays = {each: lambda n=each: load([part], n) for each in names if each not in axes}
    if {"vx", "vy", "vz"} <= set(arrays) and "Velocity" not in arrays:
        arrays["Velocity"] = lambda: np.stack([load([part], "v" + axis) for axis in "xyz"], axis=1)
    return Particles(path.name, "H5Part", lambda: np.stack([load([part], axis) for axis in "xyz"], axis=1), arrays,
                     **{each: usual(list(arrays), each) for each in ("smoothing_length", "volume", "mass", "density")},
                     time=times[choose_step(path.name, step, times)], times=times, period=period)
