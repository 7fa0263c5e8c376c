#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the guide's tables of how near the results for a known flow or body are to the truth.

    accuracy.py [walls] [volumes] [curvature] [attributes]

Particles are one apart, with volumes of 1 and the cubic kernel unless a table says otherwise. Needs the Python package.
"""
import sys
import warnings

import marchingcorrectors as mc
import numpy as np

LENGTHS = (1.0, 1.3, 1.7)  # smoothing lengths, in spacings


def lattice(*ranges):
    """Particles in the middles of the cubes between whole numbers."""
    return np.stack(np.meshgrid(*[np.arange(*r) + 0.5 for r in ranges], indexing="ij"), -1).reshape(-1, 3)


def print_table(title, columns, rows):
    print(f"\n{title}\n\n| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")


def walls():
    """A channel between walls of three layers at y = 0 and y = 12, in which all moves with (1, 1, 0); and a tank's floor."""
    x = lattice((-8, 8), (-3, 15), (-8, 8))
    solid = (x[:, 1] < 0) | (x[:, 1] > 12)
    x[~solid] += np.random.default_rng(1).normal(0, 0.2, (np.count_nonzero(~solid), 3))
    x[~solid, 1] = x[~solid, 1].clip(0.5, 11.5)
    velocity = np.where(solid[:, np.newaxis], 0.0, [[1.0, 1.0, 0.0]])
    sections = {"across, from wall to wall": (((0, 0, -4), (0, 12, -4), (0, 0, 4)), 96),
                "across, from inside of both walls": (((0, -2, -4), (0, 14, -4), (0, -2, 4)), 96),
                "along a wall, one spacing before it": (((-4, 1, -4), (-4, 1, 4), (4, 1, -4)), 64),
                "along a wall, half a spacing before it": (((-4, 0.5, -4), (-4, 0.5, 4), (4, 0.5, -4)), 64),
                "along a wall, on its face": (((-4, 0, -4), (-4, 0, 4), (4, 0, -4)), 64)}
    found = {(h, ignored): mc.flux(x, velocity, {name: where for name, (where, _) in sections.items()}, smoothing_length=h,
                                   volume=1.0, solid=solid, ignore_solids=ignored).volume_flux
             for h in LENGTHS for ignored in (True, False)}
    rows = [[name, *[" / ".join(f"{100 * (found[h, ignored][i] / truth - 1) + 0.0:+.1f}" for ignored in (True, False))
                     for h in LENGTHS]] for i, (name, (_, truth)) in enumerate(sections.items())]
    print_table("Error of the flux in %: without the solids / with them", ["section", *[f"h = {h} spacings" for h in LENGTHS]], rows)
    x = x[:, [0, 2, 1]]  # the wall at 0 is the floor, under water that is 10 deep
    kept = x[:, 2] < 10
    x, solid = x[kept], solid[kept]
    masts = np.stack(np.meshgrid(np.linspace(-4, 4, 9), np.linspace(-4, 4, 9)), -1).reshape(-1, 2)
    rows = []
    for name, start in (("on the floor", 0), ("inside the floor", -2)):
        lines = [((*at, start), (*at, 9)) for at in masts]
        row = [f"81 gauges that begin {name} and end under water"]
        for h in LENGTHS:
            errors = [mc.gauge(x, lines, smoothing_length=h, volume=1.0, solid=solid, ignore_solids=ignored).depth - 9
                      for ignored in (True, False)]
            row.append(" / ".join(f"{np.mean(error):+.2f}, {np.abs(error).max():.2f}" for error in errors))
        rows.append(row)
    print_table("Error of the depth in spacings, mean and greatest: without the solids / with them",
                ["gauge", *[f"h = {h} spacings" for h in LENGTHS]], rows)


def volumes():
    """Sheets, threads and drops of few particles, alone: the volume inside the free surface, against one for each particle."""
    ball = lattice((-4, 4), (-4, 4), (-4, 4))
    bodies = {"one layer": (lattice((0, 12), (0, 12), (0, 1)), (12, 12, 0)),
              "two layers": (lattice((0, 12), (0, 12), (0, 2)), (12, 12, 0)),
              "four layers": (lattice((0, 12), (0, 12), (0, 4)), (12, 12, 0)),
              "a thread": (lattice((0, 12), (0, 1), (0, 1)), (12, 0, 0)),
              "a thread of 2 x 2": (lattice((0, 12), (0, 2), (0, 2)), (12, 0, 0)),
              "a lone particle": (np.zeros((1, 3)), (0, 0, 0)),
              "a drop of 8": (lattice((0, 2), (0, 2), (0, 2)), (0, 0, 0)),
              "a drop of 32": (ball[np.linalg.norm(ball, axis=1) < 2.3], (0, 0, 0)),
              "a drop of 136": (ball[np.linalg.norm(ball, axis=1) < 3.2], (0, 0, 0))}
    rows = []
    for name, (x, periods) in bodies.items():
        row = [name]
        for h in LENGTHS:
            both = []
            for given in ({}, {"volume": 1.0}):
                surface = mc.free_surface(x, smoothing_length=h, dimension=3, capping=any(periods),
                                          periodic=periods if any(periods) else None, **given)
                both.append(f"{100 * (surface.statistics['volume'] / len(x) - 1):+.0f}" if len(surface.points) else "none")
            row.append(" / ".join(both))
        rows.append(row)
    print_table("Volume inside the free surface, more than the particles' own, in %: computed volumes / given ones",
                ["body", *[f"h = {h} spacings" for h in LENGTHS]], rows)


def curvature():
    """Balls on a lattice: curvature of the contour of a scalar that is 0 at the radius, and of the free surface, times the radius."""
    lengths, rows = (1.0, 1.3, 1.7, 2.4), []
    for radius in (3, 4, 6, 10):
        x = lattice(*[(-radius - 8, radius + 8)] * 3)
        r = np.linalg.norm(x, axis=1)
        ways = {"a scalar": lambda h: mc.isosurface(x, radius ** 2 - r ** 2, 0.0, smoothing_length=h, volume=1.0, mean_curvature=True),
                "the free surface": lambda h: mc.free_surface(x[r < radius], smoothing_length=h, volume=1.0, mean_curvature=True),
                "with `--smooth`": lambda h: mc.free_surface(x[r < radius], smoothing_length=h, volume=1.0, mean_curvature=True,
                                                             smooth=True)}
        for name, make in ways.items():
            row = [f"{radius} spacings, {name}"]
            for h in lengths:
                surface = make(h)
                error = np.abs(surface.mean_curvature * np.linalg.norm(surface.points, axis=1) - 1)
                row.append(f"{100 * np.median(error):.2g} / {100 * np.quantile(error, 0.95):.2g}")
            rows.append(row)
    print_table("Error of the mean curvature times the radius, in %: median / 95 of 100 points",
                ["R", *[f"h = {h} spacings" for h in lengths]], rows)


def attributes():
    """A ball that spins, and still water: values at the free surface against those of the flow."""
    spinning = lattice((-10, 10), (-10, 10), (-10, 10))
    spinning = spinning[np.linalg.norm(spinning, axis=1) < 9]
    water = lattice((0, 12), (0, 12), (0, 10))
    rows = []
    for h in LENGTHS:
        ball = mc.free_surface(spinning, smoothing_length=h, volume=1.0,
                               attributes={"v": np.cross((0, 0, 1), spinning)})
        distance = np.hypot(*ball.points[:, :2].T)
        speed = np.linalg.norm(ball.attributes["v"], axis=1)[distance > 7] / distance[distance > 7]
        still = mc.free_surface(water, smoothing_length=h, volume=1.0, periodic=(12, 12, 0), attributes={"p": 10 - water[:, 2]})
        pressure = still.attributes["p"][still.points[:, 2] > 5]
        rows.append([f"h = {h} spacings", f"{100 * (np.mean(speed) - 1):+.1f} %", f"{np.mean(pressure):.2f}"])
    print_table("Attributes on the free surface", ["", "speed at the rim of a ball of 9 spacings that spins",
                                                   "pressure on still water, in rho g times the spacing (0)"], rows)


TABLES = {"walls": walls, "volumes": volumes, "curvature": curvature, "attributes": attributes}

if __name__ == "__main__":
    warnings.simplefilter("ignore", mc.InputWarning)  # the unusual lengths are meant
    for chosen in sys.argv[1:] or TABLES:
        TABLES[chosen]()
