#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the guide's tables of errors: how far the results for known flows and bodies are from the truth.

    accuracy.py [walls] [volumes] [curvature] [attributes] [corrected]

The spacing and the volume of the particles are 1, and the kernel is cubic, unless a table says otherwise. Needs the Python
package; the last table needs SciPy, too, and is run in the repository's root.
"""
import sys
import warnings

import marchingcorrectors as mc
import numpy as np

LENGTHS = (1.0, 1.3, 1.7)  # Smoothing lengths in spacings.


def lattice(*ranges):
    """Returns the centres of cubes with edges of 1. Each range has the first and the last coordinate along one axis."""
    return np.stack(np.meshgrid(*[np.arange(*r) + 0.5 for r in ranges], indexing="ij"), -1).reshape(-1, 3)


def print_table(title, columns, rows):
    print(f"\n{title}\n\n| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")


def walls():
    """Prints errors of fluxes in a channel: its walls at y = 0 and y = 12 have three layers, and the fluid moves with (1, 1, 0).
    Also prints errors of gauges in a tank with a floor."""
    x = lattice((-8, 8), (-3, 15), (-8, 8))
    solid = (x[:, 1] < 0) | (x[:, 1] > 12)
    in_place = x.copy()  # Here the layer beside each wall stays half a spacing away from the wall.
    x[~solid] += np.random.default_rng(1).normal(0, 0.2, (np.count_nonzero(~solid), 3))
    x[~solid, 1] = x[~solid, 1].clip(0.5, 11.5)
    layer = ~solid & ((in_place[:, 1] < 1) | (in_place[:, 1] > 11))
    in_place[~solid] = x[~solid]
    in_place[layer, 1] = np.where(in_place[layer, 1] < 6, 0.5, 11.5)
    print(f"The first layer is {x[layer, 1][x[layer, 1] < 6].mean():.2f} spacings away from its wall.")
    velocity = np.where(solid[:, np.newaxis], 0.0, [[1.0, 1.0, 0.0]])
    sections = {"across, from wall to wall": (((0, 0, -4), (0, 12, -4), (0, 0, 4)), 96),
                "across, from inside of both walls": (((0, -2, -4), (0, 14, -4), (0, -2, 4)), 96),
                "along a wall, one spacing before it": (((-4, 1, -4), (-4, 1, 4), (4, 1, -4)), 64),
                "along a wall, half a spacing before it": (((-4, 0.5, -4), (-4, 0.5, 4), (4, 0.5, -4)), 64),
                "along a wall, on its face": (((-4, 0, -4), (-4, 0, 4), (4, 0, -4)), 64)}
    for title, places in (("", x), (", first layer in place", in_place)):
        found = {(h, ignored): mc.flux(places, velocity, {name: where for name, (where, _) in sections.items()}, smoothing_length=h,
                                       volume=1.0, solid=solid, ignore_solids=ignored).volume_flux
                 for h in LENGTHS for ignored in (True, False)}
        rows = [[name, *[" / ".join(f"{100 * (found[h, ignored][i] / truth - 1) + 0.0:+.1f}" for ignored in (True, False))
                         for h in LENGTHS]] for i, (name, (_, truth)) in enumerate(sections.items())]
        print_table(f"Error of the flux in %{title}: without the solids / with them", ["section", *[f"h = {h} spacings" for h in LENGTHS]], rows)
    x = x[:, [0, 2, 1]]  # The wall at 0 is the floor, under water that is 10 deep.
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
    """Prints how much larger, in %, the volume inside the free surface is than the particles' own volume: for sheets, threads and drops
    of few particles, with computed volumes, and with a given volume of 1 for each particle."""
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
    """Prints how far the mean curvature times the radius is from 1, in %, for balls of particles on a lattice. The surface is the
    contour of a scalar that is 0 on the sphere, or the free surface, or the smooth free surface."""
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
    """Compares values at the free surface of a spinning ball, and of still water, with the flow's true values."""
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


def mean_and_corrected(x, values, h, volume, points):
    """Returns four arrays, with values at each point: the Shepard mean; the value of a moving least squares fit of first order; and the
    least and the greatest value of the particles that reach the point."""
    from scipy.spatial import cKDTree
    near = cKDTree(x).query_ball_point(points, 2 * np.max(h))
    i, j = np.repeat(np.arange(len(points)), [len(some) for some in near]), np.concatenate([np.array(some, int) for some in near])
    q = np.linalg.norm(x[j] - points[i], axis=1) / h[j]
    i, j, q = i[q < 2], j[q < 2], q[q < 2]
    weight = volume[j] / h[j] ** 3 * np.where(q < 1, 1 - 1.5 * q ** 2 + 0.75 * q ** 3, 0.25 * (2 - q) ** 3)
    base = np.concatenate([np.ones((len(i), 1)), (x[j] - points[i]) / h[j, np.newaxis]], axis=1)
    matrix, right = np.zeros((len(points), 4, 4)), np.zeros((len(points), 4, values.shape[1]))
    np.add.at(matrix, i, weight[:, np.newaxis, np.newaxis] * base[:, :, np.newaxis] * base[:, np.newaxis])
    np.add.at(right, i, weight[:, np.newaxis, np.newaxis] * base[:, :, np.newaxis] * values[j][:, np.newaxis])
    low, high = np.full((2, len(points), values.shape[1]), [[[np.inf]], [[-np.inf]]])
    np.minimum.at(low, i, values[j])
    np.maximum.at(high, i, values[j])
    corrected = np.linalg.solve(matrix + 1e-14 * np.eye(4), right)[:, 0]
    return right[:, 0] / matrix[:, :1, 0], corrected, low, high


def corrected():
    """Prints how values with a first-order correction would differ from the Shepard mean: for white noise on disordered
    water, and for the dam break's velocities. Needs SciPy."""
    from marchingcorrectors import io
    random = np.random.default_rng(0)
    x = lattice((-6, 6), (-6, 6), (0, 10))
    x = x + random.normal(0, 0.15, x.shape)
    surface = mc.free_surface(x, smoothing_length=1.3, volume=1.0).points
    points = surface[(np.abs(surface[:, :2]).max(axis=1) < 3) & (surface[:, 2] > 7)]
    ones = np.ones(len(x))
    noise = mean_and_corrected(x, random.normal(0, 1, (len(x), 1)), 1.3 * ones, ones, points)
    particles = io.read("Examples/Data/dam_break_45k.vtp")
    arrays = {name: np.asarray(particles.arrays[name], float)
              for name in ("ParticleType", "SmoothingLength", "Mass", "Density", "Velocity")}
    fluid = arrays["ParticleType"] == 0
    x, h, velocity = np.asarray(particles.positions, float)[fluid], arrays["SmoothingLength"][fluid], arrays["Velocity"][fluid]
    volume = (arrays["Mass"] / arrays["Density"])[fluid]
    points = mc.free_surface(x, smoothing_length=h, volume=volume).points
    points = points[random.choice(len(points), 6000, replace=False)]
    mean, fit, low, high = mean_and_corrected(x, velocity, h, volume, points)
    beyond = np.maximum(low - fit, fit - high).max(axis=1) / np.maximum((high - low).max(axis=1), 1e-300)
    fastest = [np.linalg.norm(some, axis=1).max() for some in (velocity, mean, fit)]
    print_table("First-order corrected values", ["", "mean", "corrected"], [
        ["white noise of deviation 1 on water, h = 1.3 spacings", f"{noise[0].std():.2f}", f"{noise[1].std():.2f}"],
        ["dam break: points beyond the range of particles around", "0 %", f"{100 * np.mean(beyond > 0):.0f} %"],
        ["by more than half of that range", "0 %", f"{100 * np.mean(beyond > 0.5):.0f} %"],
        [f"greatest speed (particles: {fastest[0]:.1f})", f"{fastest[1]:.1f}", f"{fastest[2]:.1f}"]])


TABLES = {"walls": walls, "volumes": volumes, "curvature": curvature, "attributes": attributes, "corrected": corrected}

if __name__ == "__main__":
    warnings.simplefilter("ignore", mc.InputWarning)  # These unusual lengths are meant.
    for chosen in sys.argv[1:] or TABLES:
        TABLES[chosen]()
