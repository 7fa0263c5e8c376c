#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles whose size goes with the distance from the middle: a deterministic set for adaptive cubes.

  make_graded.py N out.vtp [--ratio r]     largest smoothing length / smallest one, 1000 if not given

Jittered shells around a small hole, a wedge of them left out: the free surface goes from the hole, where
particles are smallest, along the wedge to the outside. Arrays: SmoothingLength, Volume, Sphere (0 on a sphere that
passes beside the hole, in units of the distance from there).
"""
import argparse
import math
import numpy as np
import particle_file


def shells(step, ratio):
    return 1 + int(math.log(ratio) / math.log(1 + 0.9 * step))


def step_for(count, ratio):
    """Spacing per distance from the middle that gives about so many particles; the wedge takes 0.3."""
    low, high = 1e-3, 1.0
    for _ in range(60):
        step = (low + high) / 2
        more = 0.7 * shells(step, ratio) * 4 * math.pi / step**2 > count
        low, high = (step, high) if more else (low, step)
    return high


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("n", type=int)
parser.add_argument("out")
parser.add_argument("--ratio", type=float, default=1000)
args = parser.parse_args()

rng = np.random.default_rng(11)
step = step_for(args.n, args.ratio)
of_shell = int(4 * math.pi / step**2)
i = np.arange(of_shell)
z = 1 - (2 * i + 1.0) / of_shell
turn = 2.399963 * i
directions = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], -1)
radii = (1 + 0.9 * step) ** np.arange(shells(step, args.ratio))
p = (radii[:, None, None] * (directions + step * rng.uniform(-0.1, 0.1, (len(radii), of_shell, 3)))).reshape(-1, 3)
p = p[p[:, 0] < 0.4 * np.linalg.norm(p, axis=1)]
r = np.linalg.norm(p, axis=1)
middle = np.array([0, 0, 0.7 * args.ratio])
arrays = {
    "SmoothingLength": 1.2 * step * r,
    "Volume": 0.9 * (step * r) ** 3,
    "Sphere": (np.linalg.norm(p - middle, axis=1) - (0.7 * args.ratio - 2)) / r,
}
particle_file.write(args.out, particle_file.poly_data(p, arrays))
h = arrays["SmoothingLength"]
print(f"{args.out}: {len(p)} particles, h {h.min():.6g} .. {h.max():.6g}")
