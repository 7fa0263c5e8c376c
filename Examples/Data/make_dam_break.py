#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Collapsing water column with particles of different sizes: deterministic, for timing.

  make_dam_break.py N out.vtp        70 neighbours inside 2 h, smoothing lengths differ by 1.5 : 1

The column, 1.228 x 1.0 x 0.55 m, 0.3 s after the dam at x = 1.228 broke: z up, depth by Ritter's
solution for a dry bed. Particles are a jittered lattice, finest at the front and at the bottom,
coarse far from both: a particle's volume V follows from its lattice cell, and h = 1.28 V^(1/3).
Arrays: SmoothingLength, Density (1000), Mass = 1000 V, Lambda2 (1/s^2) of a periodic flow made of
vortices; below 0 in their cores, try -140.
"""
import argparse

import numpy as np
import particle_file

LENGTH, WIDTH, DEPTH = 1.228, 1.0, 0.55
TIME = 0.3
GRAVITY = 9.81
RATIO = 1.28  # smoothing length / V^(1/3)
WAVE_NUMBER = 2 * np.pi / 1.1
SPEED = 2.3
GRADING = (0.5, 0.5, 0.5)  # along an axis, spacing falls from 1 + grading to 1
# A share of the spacing, either way. The sum of V W at particles deep inside then varies by 1.4 %;
# in dam_break_45k.vtp, which was simulated, it varies by 1.5 % (standard deviations).
JITTER = 0.06


def depth(x):
    """Ritter (1892): a rarefaction runs back into the column, a tongue forth from it."""
    wave = np.sqrt(GRAVITY * DEPTH)
    s = np.clip((x - LENGTH) / TIME, -wave, 2 * wave)
    return (2 * wave - s) ** 2 / (9 * GRAVITY)


def axis(extent, spacing, grading):
    """Coordinates and spacings of lattice planes; the spacing falls linearly along the axis."""
    planes = extent / spacing * np.log(1 + grading) / grading
    u = (np.arange(int(planes)) + 0.5) * spacing
    x = extent * (1 + 1 / grading - (1 + grading) / grading * np.exp(-grading * u / extent))
    return x, spacing * (1 + grading * (1 - x / extent))


def lattice(spacing):
    """Positions and volumes of the lattice points in the water."""
    front = LENGTH + 2 * TIME * np.sqrt(GRAVITY * DEPTH)
    x, dx = axis(front, spacing, GRADING[0])
    y, dy = axis(WIDTH, spacing, GRADING[1])
    z, dz = axis(DEPTH, spacing, GRADING[2])
    z, dz = DEPTH - z[::-1], dz[::-1]  # finest at the bottom
    wet = np.nonzero(np.broadcast_to((z < depth(x)[:, None])[:, None, :], (len(x), len(y), len(z))))
    positions = np.stack([x[wet[0]], y[wet[1]], z[wet[2]]], 1)
    return positions, np.stack([dx[wet[0]], dy[wet[1]], dz[wet[2]]], 1)


def lambda2(positions):
    """Middle eigenvalue of S^2 + W^2, S and W the parts of the velocity gradient, of the flow
    u = SPEED (sin kz + cos ky, sin kx + cos kz, sin ky + cos kx) (Arnold, Beltrami, Childress)."""
    result = np.empty(len(positions))
    for first in range(0, len(positions), 1 << 18):  # all matrices at once would need much memory
        p = WAVE_NUMBER * positions[first:first + (1 << 18)]
        s, c = np.sin(p), np.cos(p)
        gradient = np.zeros((len(p), 3, 3))
        for a in range(3):
            before, after = (a - 1) % 3, (a + 1) % 3
            gradient[:, a, before] = c[:, before]
            gradient[:, a, after] = -s[:, after]
        square = gradient @ gradient
        symmetric = 0.5 * (square + square.transpose(0, 2, 1))
        result[first:first + len(p)] = np.linalg.eigvalsh(symmetric)[:, 1]
    return (SPEED * WAVE_NUMBER) ** 2 * result


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("n", type=int, help="wanted number of particles, about")
    parser.add_argument("out")
    arguments = parser.parse_args()

    spacing = 0.02
    for _ in range(5):  # the count goes with 1 / spacing^3, but for whole planes
        spacing *= (len(lattice(spacing)[0]) / arguments.n) ** (1 / 3)
    positions, spacings = lattice(spacing)
    volumes = spacings.prod(1)
    positions += np.random.default_rng(477).uniform(-JITTER, JITTER, positions.shape) * spacings
    arrays = {
        "SmoothingLength": RATIO * np.cbrt(volumes),
        "Density": np.full(len(positions), 1000.0),
        "Mass": 1000.0 * volumes,
        "Lambda2": lambda2(positions),
    }
    single = {name: values.astype(np.float32) for name, values in arrays.items()}
    particle_file.write(arguments.out, particle_file.poly_data(positions.astype(np.float32), single))
    h = arrays["SmoothingLength"]
    print(f"{arguments.out}: {len(positions)} particles, h {h.min():.6g} .. {h.max():.6g}")


if __name__ == "__main__":
    main()
