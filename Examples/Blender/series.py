# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the steps of particle files, and makes the surface of one step, without Blender."""
from typing import NamedTuple

import numpy as np

import marchingcorrectors as mc
from marchingcorrectors import Error
from marchingcorrectors._film import in_order, label_pieces, small_pieces, without_points
from marchingcorrectors._usd import Film, find_velocity
from marchingcorrectors.io import ENDINGS, count_steps, read

__all__ = ["ENDINGS", "Error", "Step", "end", "find_velocity", "list_arrays", "list_steps", "make_surface", "read", "write_usd"]
_context = None  # The context has a device, and keeps data there from call to call.


class Step(NamedTuple):
    path: str
    number: int  # The number counts the steps in the file.
    time: float


def list_steps(names, time_step):
    """Returns all steps of the files, in order. Times come from the files if every step has a time, and the times ascend; otherwise the times
    are multiples of time_step."""
    steps = [(name, number) for name in in_order(names) for number in range(count_steps(name))]
    times = []
    for name, number in steps:
        times.append(read(name, step=number).time)
        if times[-1] is None or len(times) > 1 and times[-1] <= times[-2]:
            times = [i * time_step for i in range(len(steps))]
            break
    return [Step(name, number, time) for (name, number), time in zip(steps, times)]


def list_arrays(particles):
    """Returns the names of floating-point arrays with one number or a vector for each particle; mesh attributes can hold these arrays."""
    return [name for name, array in particles.arrays.items() if array.dtype.kind == "f" and array.shape[1:] in ((), (3,))]


def make_surface(path, number, smoothing_length="", fluid="", scalar="", iso=0.5, smooth=True, cube_size_factor=0.5,
                 least_particles=0, arrays=()):
    """Returns the surface of step `number` of a file, with the attributes `arrays`. Leaves out pieces of fewer than least_particles particles."""
    global _context
    if _context is None:
        _context = mc.Context()
    particles = read(path, step=number)
    words = {"smooth": smooth, "cube_size_factor": cube_size_factor, "nearest_particle": least_particles > 0, "context": _context,
             "attributes": [name for name in arrays if name in particles]}
    if smoothing_length in ("estimate", "neighbours", "neighbors"):
        words["estimate_smoothing_length"] = True if smoothing_length == "estimate" else smoothing_length
    elif smoothing_length:
        words["smoothing_length"] = _number(smoothing_length) or particles[smoothing_length]
    if fluid:
        name, _, value = fluid.rpartition("=")
        if _number(value) is None:
            raise mc.InvalidArgument(f"Fluid is '{fluid}'; it must be an array's name and the value of fluid, as Type=0.")
        words["solid"] = particles[name] != _number(value)
    surface = mc.isosurface(particles, scalar, iso, **words) if scalar else mc.free_surface(particles, iso, **words)
    if least_particles and len(surface.triangles):
        label, solid = label_pieces(surface.triangles, len(surface.points)), words.get("solid", particles.solid)
        fluid = np.arange(len(particles)) if solid is None else np.flatnonzero(np.asarray(solid) == 0)
        small = small_pieces(surface, label, particles.positions, fluid, least_particles)
        surface = without_points(surface, np.isin(label, [piece for piece, _ in small]))
    surface.nearest_particle = None
    return surface


def _number(text):
    try:
        return float(text)
    except ValueError:
        return None


def write_usd(path, steps, fps, speed, up, words):
    """Writes one USD file with the surfaces of all steps. speed: seconds of the simulation in one second of the film."""
    with Film(path, [step.path for step in steps], fps=fps, slow=1 / speed, up=up) as film:
        for step in steps:
            film.add(make_surface(step.path, step.number, **words), step.time)


def end():
    """Closes the context, which ends the device's threads."""
    global _context
    if _context is not None:
        _context.close()
    _context = None
