#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""How smooth surfaces are, and what that costs: smooth.py PROGRAM [--seed N] [--smoothing-length 1.3] [--time PARTICLES.vtp].

Two scenes with particles one apart, moved at random by a share of that: a tank at rest; and a crown, a splash with a sheet of one
layer, threads at its rim and 40 lone drops. For each surface the tilt of its triangles against the true surface (root of the mean
square, degrees), drops and pieces, triangles, how many have an angle below 20 degrees, the volume over N V, and seconds. With
--time only the processor's seconds of whole runs, in turn, and their medians. Needs numpy and vtk; splashsurf is compared where
pysplashsurf can be imported.
"""
import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
import vtk

DROPS, RADIUS, HEIGHT = 40, 13, 13  # of the crown
WAYS = {"as it is": [], "--compact": ["--compact"], "--widen 2": ["--widen", "2"], "--smooth": ["--smooth"],
        "--smooth --iso 0.55": ["--smooth", "--iso", "0.55"]}
SPLASHSURF = {"splashsurf, cubes 0.5 r": 0.5, "splashsurf, cubes 1.0 r": 1.0}  # with its recommended smoothing


def lattice(nx, ny, nz):
    return np.stack(np.meshgrid(np.arange(nx), np.arange(ny), np.arange(nz), indexing="ij"), -1).reshape(-1, 3) + 0.5


def tank(jitter, random):
    x = lattice(36, 36, 9)
    return x + random.normal(0, jitter, x.shape)


def radius_at(z):
    return RADIUS + 3 * (z / HEIGHT) ** 2


def crown(jitter, random):
    """Particles, the drops last."""
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


def write_particles(path, x):
    data, points = vtk.vtkPolyData(), vtk.vtkPoints()
    points.SetData(numpy_to_vtk(x, deep=1))
    data.SetPoints(points)
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.SetDataModeToBinary()
    writer.Write()


def read_surface(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    return vtk_to_numpy(mesh.GetPoints().GetData()).astype(float), \
        vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def pieces_of(points, triangles):
    """The number of the piece of each triangle."""
    label = np.arange(len(points))
    while True:
        least = label[triangles].min(1)
        new = label.copy()
        for corner in range(3):
            np.minimum.at(new, triangles[:, corner], least)
        new = new[new]
        if (new == label).all():
            return np.unique(label[triangles[:, 0]], return_inverse=True)[1]
        label = new


def tilt(normals, wanted):
    """Degrees, weighted by area."""
    area = np.linalg.norm(normals, axis=1)
    cosine = np.abs((normals * wanted).sum(1)) / np.maximum(area * np.linalg.norm(wanted, axis=-1), 1e-300)
    return np.sqrt(np.average(np.degrees(np.arccos(np.clip(cosine, -1, 1))) ** 2, weights=area)) if len(area) else np.nan


def measure(scene, x, points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals, middle = np.cross(b - a, c - a), (a + b + c) / 3
    volumes = np.bincount(pieces_of(points, triangles), (a * np.cross(b, c)).sum(1) / 6)
    least = np.min([np.degrees(np.arctan2(np.linalg.norm(np.cross(v - u, w - u), axis=1), ((v - u) * (w - u)).sum(1)))
                    for u, v, w in ((a, b, c), (b, c, a), (c, a, b))], 0)
    row = {"triangles": len(triangles), "pieces": len(volumes), "angles": 100 * np.mean(least < 20),
           "volume": abs(volumes.sum()) / len(x)}
    if scene == "tank":
        top = (np.abs(middle[:, :2] - 18) < 13).all(1) & (middle[:, 2] > 7)
        row["tilt"] = tilt(normals[top], np.array([0.0, 0, 1]))
        return row
    r, z = np.hypot(middle[:, 0], middle[:, 1]), middle[:, 2]
    sheet = (np.abs(r - radius_at(z)) < 1.5) & (z > 3) & (z < HEIGHT - 2.5)
    slope = 6 * z / HEIGHT ** 2
    outwards = np.stack([middle[:, 0] / r, middle[:, 1] / r, -slope], 1)
    row["tilt"] = tilt(normals[sheet], outwards[sheet])
    near = np.linalg.norm(points[:, None, :] - x[None, -DROPS:], axis=2).min(0) < 1.2
    row["drops"] = int(near.sum())
    return row


def run_program(program, folder, x, length, words):
    output, statistics = folder / "surface.vtp", folder / "statistics.json"
    write_particles(folder / "particles.vtp", x)
    done = subprocess.run([program, folder / "particles.vtp", output, "--free-surface", "--smoothing-length", str(length),
                           *words, "--stats", statistics, "--repeat", "2", "--no-attributes", "--quiet"], capture_output=True, text=True)
    if done.returncode:
        return None
    told = json.loads(statistics.read_text())
    return (*read_surface(output), told["runs"][-1]["wall_seconds"], told["statistics"]["residual_max"])


def time_runs(program, particles, rounds=5):
    """Each run is a process of its own, so that what it takes can be told."""
    with tempfile.TemporaryDirectory() as folder:
        plain = [program, particles, pathlib.Path(folder) / "surface.vtp", "--free-surface", "--no-attributes", "--quiet"]
        runs = {"as it is": plain, "--compact": [*plain, "--compact"], "--smooth": [*plain, "--smooth"],
                "splashsurf, cubes 0.5 r": [sys.executable, __file__, "-", "--splashsurf", particles]}
        seconds = {name: [] for name in runs}
        for _ in range(rounds):
            for name, command in runs.items():
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                subprocess.run(command, check=True)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                seconds[name].append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    plain = statistics.median(seconds["as it is"])
    for name, taken in seconds.items():
        print(f"| {name} | {statistics.median(taken):.2f} s | {statistics.median(taken) / plain:.2f} |")


def read_spaced(path):
    """Positions, with particles one apart."""
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    mass, density = (vtk_to_numpy(data.GetPointData().GetArray(name)) for name in ("Mass", "Density"))
    return vtk_to_numpy(data.GetPoints().GetData()) / np.median(mass / density) ** (1 / 3)


def run_splashsurf(x, cube):
    import pysplashsurf

    begin = time.time()
    mesh, _ = pysplashsurf.reconstruction_pipeline(
        x.astype(np.float32), particle_radius=0.5, smoothing_length=2.0, cube_size=cube, iso_surface_threshold=0.6,
        mesh_smoothing_weights=True, mesh_smoothing_weights_normalization=13.0, mesh_smoothing_iters=25, normals_smoothing_iters=10,
        mesh_cleanup=True, compute_normals=True, subdomain_grid=True)
    seconds = time.time() - begin
    mesh = getattr(mesh, "mesh", mesh)
    return np.asarray(mesh.vertices, float), np.asarray(mesh.triangles, int), seconds, np.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--seed", type=int, default=45)
    parser.add_argument("--smoothing-length", type=float, default=1.0)
    parser.add_argument("--time", metavar="PARTICLES.vtp")
    parser.add_argument("--splashsurf", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.time:
        time_runs(given.program, given.time)
        return
    if given.splashsurf:
        run_splashsurf(read_spaced(given.splashsurf), 0.5)
        return
    random = np.random.default_rng(given.seed)
    scenes = [("tank", "tank, jitter 0.12", tank(0.12, random)), ("tank", "tank, jitter 0.18", tank(0.18, random)),
              ("crown", "crown, jitter 0.10", crown(0.10, random))]
    try:
        import pysplashsurf  # noqa: F401
        competitors = SPLASHSURF
    except ImportError:
        competitors = {}
    for scene, title, x in scenes:
        print(f"\n| {title}: {len(x)} particles | tilt | drops | pieces | triangles | angles < 20 | volume / N V | residual | s |\n"
              "|---|---|---|---|---|---|---|---|---|")
        for name, way in {**WAYS, **competitors}.items():
            with tempfile.TemporaryDirectory() as folder:
                found = run_program(given.program, pathlib.Path(folder), x, given.smoothing_length, way) if isinstance(way, list) \
                    else run_splashsurf(x, way)
            if found is None:
                print(f"| {name} | not in this program |")
                continue
            points, triangles, seconds, residual = found
            row = measure(scene, x, points, triangles)
            print(f"| {name} | {row['tilt']:.1f} | {row.get('drops', '-')} | {row['pieces']} | {row['triangles']} | "
                  f"{row['angles']:.2f} % | {row['volume']:.3f} | {residual:.1e} | {seconds:.2f} |", flush=True)


if __name__ == "__main__":
    main()
