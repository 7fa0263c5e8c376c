#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A wave in a flume, in two dimensions: a deterministic particle set for lines, and for timing.

  make_wave.py N out.vtp [--ratio r]     r = h / spacing (default 1.3)

About N particles of fluid and walls in the plane y = 0: a jittered lattice in a flume 3 m long, under a surface
with a steep wave and a few drops before its crest, around a cylinder. Masses are per metre of width. Arrays:
SmoothingLength (constant), Density (1000), Mass, Type (0 fluid, 1 wall), Pressure (hydrostatic, Pa), Velocity
(of a solitary wave, m/s).
"""
import argparse

import numpy as np
import particle_file

LENGTH, DEPTH, HEIGHT, GRAVITY = 3.0, 0.4, 0.22, 9.81
CYLINDER = (2.15, 0.17, 0.09)
DROPS = ((1.62, 0.66, 0.025), (1.69, 0.61, 0.016), (1.75, 0.66, 0.012))

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("n", type=int)
parser.add_argument("out")
parser.add_argument("--ratio", type=float, default=1.3)
args = parser.parse_args()


def top(x):
    """Steeper on the side that the wave goes to."""
    s = (x - 1.3) * np.where(x > 1.3, 7.0, 3.2)
    return DEPTH + HEIGHT / np.cosh(np.clip(s, -20, 20)) ** 2 + 0.006 * np.sin(21 * x)


rng = np.random.default_rng(477)
dx = (LENGTH * (DEPTH + 0.08) / args.n) ** 0.5
layers = 3 * dx
x, z = (c.ravel() for c in np.meshgrid(np.arange(dx / 2 - layers, LENGTH + layers, dx),
                                       np.arange(dx / 2 - layers, 1.0, dx)))
wall = (x < 0) | (x > LENGTH) | (z < 0)
from_cylinder = np.hypot(x - CYLINDER[0], z - CYLINDER[1])
wall |= (from_cylinder < CYLINDER[2]) & (from_cylinder > CYLINDER[2] - layers)
inside = from_cylinder < CYLINDER[2]
drop = np.any([np.hypot(x - a, z - b) < r for a, b, r in DROPS], axis=0)
fluid = ~wall & ~inside & ((z < top(x)) | drop)
kept = fluid | (wall & (z < 0.75))
jitter = rng.uniform(-0.12, 0.12, (2, len(x))) * dx
x, z = (np.where(fluid, c + j, c)[kept] for c, j in zip((x, z), jitter))
fluid = fluid[kept]
speed = np.sqrt(GRAVITY * (DEPTH + HEIGHT)) * (top(x) - DEPTH) / (DEPTH + HEIGHT)
rise = -speed * np.tanh((x - 1.3) * 4) * z / DEPTH
velocity = np.stack([speed * (0.6 + 0.8 * z / DEPTH), np.zeros_like(x), -rise], -1) * fluid[:, None]
arrays = {
    "SmoothingLength": np.full(len(x), args.ratio * dx),
    "Density": np.full(len(x), 1000.0),
    "Mass": np.full(len(x), 1000.0 * dx ** 2),
    "Pressure": 1000 * GRAVITY * np.maximum(top(x) - z, 0) * fluid,
    "Velocity": velocity,
}
single = {name: values.astype(np.float32) for name, values in arrays.items()}
single["Type"] = (~fluid).astype(np.int32)
points = np.stack([x, np.zeros_like(x), z], -1)
particle_file.write(args.out, particle_file.poly_data(points.astype(np.float32), single))
print(f"{args.out}: {fluid.sum()} particles of fluid, {(~fluid).sum()} of walls, spacing {dx:.6g}")
