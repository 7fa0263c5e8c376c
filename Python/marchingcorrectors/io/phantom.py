# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads files of Phantom: HDF5, and native dumps by sarracen. Accreted particles (h <= 0) are left out; gas that is
inactive in a step (itype -1) counts as gas."""
import numpy as np

from ._particles import FileError, Particles


def make_phantom(path, is_alive, array, positions, names, values):
    if not is_alive:
        raise FileError(f"{path.name} has no gas that is alive.")
    factor, mass = float(values.get("hfact", [1.2])[0]), float(values["massoftype"][0])

    def density():
        with np.errstate(over="ignore", divide="ignore"):  # In damaged files these are infinite.
            ratio = factor / array("h").astype(float)
            return mass * (ratio * ratio * ratio)

    arrays = {name: lambda n=name: array(n) for name in names if name != "itype"}  # The particles that are left are gas.
    arrays.setdefault("density", density)
    return Particles(path.name, "Phantom", positions, arrays, smoothing_length="h", mass=mass,
                     density="density", time=float(values["time"][0]) if "time" in values else None,
                     parameters={name: value.tolist() for name, value in values.items()})


def read_native(path):
    try:
        import sarracen
    except ImportError:  # The package scikit-learn, which sarracen does not require, is imported by another name.
        raise FileError(f"{path.name} is a dump of Phantom's own format, which the packages sarracen and scikit-learn read: "
                        "pip install sarracen scikit-learn.") from None

    frames = sarracen.read_phantom(str(path), separate_types=None)
    frame = frames[frames["itype"].abs() == 1] if "itype" in frames else frames
    frame = frame[(frame["h"] > 0)].dropna(subset=["x", "y", "z"])
    values = {name: np.ravel(value) for name, value in frames.params.items() if np.isscalar(value) or np.size(value) == 1}
    names = [name for name in frame if name not in ("x", "y", "z", "mass") and frame[name].dtype.kind in "fiub"]
    return make_phantom(path, len(frame) > 0, lambda name: frame[name].to_numpy(),
                lambda: np.ascontiguousarray(frame[["x", "y", "z"]].to_numpy(float)), names,
                {name: value for name, value in values.items() if value.dtype.kind in "fiub"})
