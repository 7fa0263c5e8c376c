# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles at times between two stored steps, as vtkSPHTemporalInterpolator makes them."""
import numpy as np

from ._library import InvalidArgument, warn
from ._usd import find_velocity
from .io._particles import Particles, usual


def frames(begin, end, step):
    """Returns times from begin to end, as numbers of 15 digits: 3 x 0.05 is 0.15."""
    return [float(f"{begin + i * step:.15g}") for i in range(int(np.floor((end - begin) / step + 1e-9)) + 1)]


def between(before, after, first, last, time, velocity=None):
    """Returns the particles at a time between two steps, which are at the times first and last.

    Particles are matched by their ids. Positions follow the cubic curve with both velocities; without velocities they
    are linear in time, as other numbers are; integers are the nearer step's. A particle that only one step has is there
    in the half of the interval beside this step.
    """
    share, span = (time - first) / (last - first), last - first
    near, ids = (before, after)[share >= 0.5], []
    for particles in (before, after):
        name = usual([each for each in particles.arrays if particles.arrays[each].ndim == 1], "particle_id")
        ids.append(particles.arrays[name] if name is not None else np.zeros(0, int) if not len(particles) else None)
        if ids[-1] is None or len(np.unique(ids[-1])) < len(ids[-1]):
            raise InvalidArgument(f"{particles.file} has no ids of particles (Idp, ParticleId, id, ...), or one twice, so the time "
                                  f"{time:g} between steps cannot be made. Choose times of steps, or leave --times out.")
    _, *both = np.intersect1d(*ids, return_indices=True)
    own = both[share >= 0.5]  # These particles of the nearer step are in the other one, too.
    alone = np.setdiff1d(np.arange(len(near)), own)
    name = find_velocity(near.arrays, velocity)
    name = name if all(name in each.arrays for each in (before, after)) else None

    def mix(values, own_values):
        made = np.array(own_values, copy=True)
        if made.dtype.kind == "f":
            made[own] = (1 - share) * values[0][both[0]] + share * values[1][both[1]]
        return made

    def positions():
        made = mix([before.positions, after.positions], near.positions.astype(float))
        if name is not None:
            a, b, u, v = (getattr(each, "positions")[one].astype(float) if kind else each.arrays[name][one].astype(float)
                          for kind in (True, False) for each, one in zip((before, after), both))
            moved, told = (np.linalg.norm(each, axis=1).sum() for each in (b - a, span * (u + v) / 2))
            if told / 2 <= moved <= told * 2:
                s = share
                made[own] = ((1 + 2 * s) * (1 - s) ** 2 * a + s * s * (3 - 2 * s) * b + span * s * (1 - s) * ((1 - s) * u - s * v))
            elif moved:
                warn(f"From {before.file} to {after.file} particles move {moved / max(told, 1e-300):.3g} times as far as their "
                     "velocities say, so positions between are linear. Perhaps the times are in another unit.")
            made[alone] += (time - (first, last)[share >= 0.5]) * near.arrays[name][alone]
        return made.astype(near.positions.dtype)

    arrays = {each: lambda each=each: mix([before.arrays[each], after.arrays[each]], near.arrays[each])
              if each in before.arrays and each in after.arrays else near.arrays[each] for each in near.arrays}
    more = ("smoothing_length", "mass", "volume", "density", "kernel", "rho0", "support_radius", "h_factor", "solid", "period",
            "dimension", "up")
    return Particles(near.file, near.layout, positions, arrays, time=time, **{each: getattr(near, each) for each in more})
