# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""VTK's files (.vtp, .vtu, .vtk) of SPHinXsys, PartVTK, SPlisHSPlasH: several bodies as one set, walls marked."""
import numpy as np

from ._particles import WALL, Particles, join, usual
from .legacy import read_legacy
from .vtk_xml import read_xml


def column(name, bodies, fluids):
    """One array of all bodies. Walls without it have the fluid's median there: they take part in no field, so only
    smoothing lengths, and what volumes are made of, count."""
    shape = fluids[0][1][name].shape[1:]
    parts = [arrays.get(name) for _, arrays, _ in bodies]
    parts = [part if part is not None and part.shape[1:] == shape else None for part in parts]
    if any(part is None for part in parts):
        values = join([arrays[name] for _, arrays, _ in fluids])
        middle = (len(values) - 1) // 2
        median = np.partition(values, middle, axis=0)[middle]
        parts = [np.broadcast_to(median, (len(points), *shape)) if part is None else part
                 for part, (points, _, _) in zip(parts, bodies)]
    return join(parts)


def read_bodies(paths, walls):
    every = paths + [path for path in walls if path not in paths]
    bodies = [read_legacy(path) if path.suffix.lower() == ".vtk" else read_xml(path) for path in every]
    marked = [path in walls or not walls and len(every) > 1 and bool(WALL.search(path.stem)) for path in every]
    counts = [len(points) for points, _, _ in bodies]
    fluids = [body for body, wall in zip(bodies, marked) if not wall] or bodies
    common = [name for name in fluids[0][1] if all(
        name in arrays and arrays[name].shape[1:] == fluids[0][1][name].shape[1:] for _, arrays, _ in fluids)]
    arrays = {name: lambda n=name: column(n, bodies, fluids) for name in common}
    single = [name for name in common if fluids[0][1][name].ndim == 1]
    solid = np.repeat(marked, counts)
    if "Type" in common and ("Rhop" in common or "Idp" in common):
        solid |= arrays["Type"]() != 3  # PartVTK's
    return Particles(paths[0].name, "VTK", lambda: join([points for points, _, _ in bodies]), arrays,
                     **{name: usual(single, name) for name in ("smoothing_length", "volume", "mass", "density")},
                     solid=solid if solid.any() else None, time=bodies[0][2],
                     parameters={"bodies": dict(zip([path.name for path in every], counts))})
