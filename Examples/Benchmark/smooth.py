# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Measures how smooth surfaces are, and what smoothing costs.

There are two scenes: a tank at rest; and a crown, which is a splash with a sheet of one layer, threads at its rim and 40 lone
drops. All particles but the drops have a spacing of about 1, and are moved at random, with a standard deviation below 0.2.
"""
import statistics

import numpy as np
from measure import (compete, has_splashsurf, make_particles, points_of, processor_seconds, read, smoothed_by_splashsurf,
                     vtk_to_numpy)

DROPS, RADIUS, HEIGHT = 40, 13, 13  # The crown's lone drops, the radius and height of its sheet.
WAYS = {"as it is": [], "--compact": ["--compact"], "--widen 2": ["--widen", "2"], "--smooth": ["--smooth"],
        "--smooth --iso 0.55": ["--smooth", "--iso", "0.55"]}
SPLASHSURF = {"splashsurf, cubes 0.5 r": 0.5, "splashsurf, cubes 1.0 r": 1.0}  # It runs with its recommended smoothing.


def lattice(nx, ny, nz):
    return np.stack(np.meshgrid(np.arange(nx), np.arange(ny), np.arange(nz), indexing="ij"), -1).reshape(-1, 3) + 0.5


def tank(jitter, random):
    x = lattice(36, 36, 9)
    return x + random.normal(0, jitter, x.shape)


def radius_at(z):
    return RADIUS + 3 * (z / HEIGHT) ** 2


def crown(jitter, random):
    """Returns the positions of the crown's particles; the drops come last."""
    parts = [lattice(52, 52, 5) - (26, 26, 5)]
    z, row = 0.5, 0
    while z < HEIGHT:
        spacing = 1 + 0.2 * z / HEIGHT
        count = int(2 * np.pi * radius_at(z) / spacing)
        angle = (np.arange(count) + 0.5 * (row % 2)) * 2 * np.pi / count
        parts.append(np.stack([radius_at(z) * np.cos(angle), radius_at(z) * np.sin(angle), np.full(count, z)], 1))
        z, row = z + 0.9 * spacing, row + 1
    for angle in np.arange(12) * np.pi / 6:
        r = radius_at(HEIGHT) + 0.35 * np.arange(1, 6)
        parts.append(np.stack([r * np.cos(angle), r * np.sin(angle), HEIGHT - 0.6 + 0.95 * np.arange(1, 6)], 1))
    x = np.concatenate(parts)
    k = np.arange(DROPS)
    angle = 2 * np.pi * k / DROPS + 0.05
    r = 20 + 2 * (k % 3)
    drops = np.stack([r * np.cos(angle), r * np.sin(angle), 8 + 1.7 * (k % 7)], 1)
    return np.concatenate([x + random.normal(0, jitter, x.shape), drops])


SCENES = {"tank, jitter 0.12": (tank, 0.12), "tank, jitter 0.18": (tank, 0.18), "crown, jitter 0.10": (crown, 0.10)}


def tilt(normals, wanted):
    """Returns the root mean square of the angle between `normals`, whose lengths are areas, and `wanted`, in degrees, weighted by area.
    Opposite directions count as equal. Returns NaN without normals."""
    area = np.linalg.norm(normals, axis=1)
    cosine = np.abs((normals * wanted).sum(1)) / np.maximum(area * np.linalg.norm(wanted, axis=-1), 1e-300)
    return np.sqrt(np.average(np.degrees(np.arccos(np.clip(cosine, -1, 1))) ** 2, weights=area)) if len(area) else np.nan


def measure(scene, x, points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals, middle = np.cross(b - a, c - a), (a + b + c) / 3
    least = np.min([np.degrees(np.arctan2(np.linalg.norm(np.cross(v - u, w - u), axis=1), ((v - u) * (w - u)).sum(1)))
                    for u, v, w in ((a, b, c), (b, c, a), (c, a, b))], 0)
    if scene is tank:
        top = (np.abs(middle[:, :2] - 18) < 13).all(1) & (middle[:, 2] > 7)
        off, drops = tilt(normals[top], np.array([0.0, 0, 1])), "-"
    else:
        r, z = np.hypot(middle[:, 0], middle[:, 1]), middle[:, 2]
        sheet = (np.abs(r - radius_at(z)) < 1.5) & (z > 3) & (z < HEIGHT - 2.5)
        outwards = np.stack([middle[:, 0] / r, middle[:, 1] / r, -6 * z / HEIGHT ** 2], 1)
        off = tilt(normals[sheet], outwards[sheet])
        drops = int((np.linalg.norm(points[:, None, :] - x[None, -DROPS:], axis=2).min(0) < 1.2).sum())
    return [f"{off:.1f}", drops, len(triangles), f"{100 * np.mean(least < 20):.2f} %",
            f"{abs((a * np.cross(b, c)).sum()) / 6 / len(x):.3f}"]


def times(benchmark):
    """Writes a table of the processor seconds of whole runs: for each row the median, and its ratio to the median of the row "as it is"."""
    path, taken = benchmark.files[0], {}
    for _ in range(benchmark.runs):
        for name in ("as it is", "--compact", "--smooth"):
            options = ["--free-surface", "--no-attributes", *WAYS[name], *benchmark.more]
            taken.setdefault(name, []).append(benchmark.program.start(path, options, 0)[2])
        before = processor_seconds()
        if "left_out" not in compete("splashsurf, smooth", path, 0, 1, benchmark.limit):
            taken.setdefault("splashsurf, cubes 0.5 r", []).append(processor_seconds() - before)
    seconds = {name: statistics.median(each) for name, each in taken.items()}
    benchmark.report.table(["", "s of a processor", "times"],
                           [[name, f"{each:.2f}", f"{each / seconds['as it is']:.2f}"] for name, each in seconds.items()])


def smooth(benchmark):
    """Measures, for each surface: the tilt of its triangles against the true surface (root of the mean square, degrees), how many
    of the crown's lone drops it has, the number of triangles, the share of triangles with an angle below 20 degrees, and the enclosed
    volume divided by the particles' own. With given particles, measures only processor seconds of whole runs, see times()."""
    if benchmark.files:
        return times(benchmark)
    random, path = np.random.default_rng(benchmark.arguments.seed), benchmark.folder / "scene.vtp"
    for title, (scene, jitter) in SCENES.items():
        x, rows = scene(jitter, random), []
        make_particles.write(path, make_particles.poly_data(x, {}))
        for name, options in WAYS.items():
            benchmark.program.start(path, ["--free-surface", "--no-attributes", *options,
                                           *(benchmark.more or ["--smoothing-length", 1])], 0)
            made = read(benchmark.program.surface)
            triangles = vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            rows.append([name, *measure(scene, x, points_of(made), triangles)])
        for name, cube in SPLASHSURF.items() if has_splashsurf() else ():
            made = smoothed_by_splashsurf(x, 1, cube).mesh
            rows.append([name, *measure(scene, x, np.asarray(made.vertices, float), np.asarray(made.triangles, int))])
        benchmark.report.table([f"{title}: {len(x)} particles", "tilt", "drops", "triangles", "angles < 20", "volume / N V"], rows)
