#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes sets of any number of particles, always the same, for trials and for timing.

  make_particles.py SET N OUT.vtp [--ratio R] [--keep-all] [--steps K]

Makes about N particles of one of the sets below. With --steps K, writes K steps of a film, OUT_%04d.vtk (or .vtp). Needs numpy and vtk.
"""
import argparse
import math

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

GRAVITY = 9.81
INTERVALS = {"splash": 0.02, "wave": 0.05}  # The steps are this many seconds apart.


def tank(count, ratio=1.28):
    """Makes a wavy tank with a free surface. ratio: h / spacing; 1.28 gives 70 neighbours inside 2 h, 1.814 gives 200.

    A jittered lattice fills a tank of 3 x 1.5 m up to the free surface at z = 0.55 m + waves. z points up. Arrays:
    SmoothingLength (constant), Density (1000), Mass, Pressure (hydrostatic, Pa), Swirl (smooth, -1.5 .. 1.5; iso 0 is a
    gyroid-like surface through the whole tank).
    """
    random = np.random.default_rng(477)
    dx = (3 * 1.5 * 0.55 / count) ** (1 / 3)
    axes = [np.arange(dx / 2, extent, dx) for extent in (3.0, 1.5, 1.0)]
    p = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    p += random.uniform(-0.15, 0.15, p.shape) * dx
    x, y, z = p.T
    top = 0.55 + 0.12 * np.sin(4.1 * x + 0.7) * np.cos(2.9 * y) + 0.05 * np.sin(11 * x) * np.sin(9 * y)
    p, top = p[z < top], top[z < top]
    x, y, z = 14.0 * p.T
    return p, {"SmoothingLength": np.full(len(p), ratio * dx), "Density": np.full(len(p), 1000.0),
               "Mass": np.full(len(p), 1000.0 * dx**3), "Pressure": 9810.0 * (top - p[:, 2]),
               "Swirl": np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)}


def dam_break(count, ratio=1.28):
    """Makes a collapsing water column. The largest smoothing length is 1.5 times the smallest. ratio: h / V^(1/3).

    The column was 1.228 x 1.0 x 0.55 m; the dam at x = 1.228 broke 0.3 s ago. z points up. The depth is Ritter's solution for a
    dry bed. The particles are a jittered lattice, finest at the front, at the bottom and at y = 1, coarse far from these. A particle's
    volume V is the volume of its lattice cell. Arrays: SmoothingLength, Density (1000), Mass = 1000 V, and Lambda2 (1/s^2) of a
    periodic flow made of vortices. Lambda2 is negative in the vortices' cores; try the iso value -140.
    """
    length, width, height, time = 1.228, 1.0, 0.55, 0.3
    wave = np.sqrt(GRAVITY * height)

    def axis(extent, spacing, grading=0.5):
        """Returns coordinates and spacings of lattice planes. The spacings fall linearly along the axis, from (1 + grading) spacing to spacing."""
        planes = extent / spacing * np.log(1 + grading) / grading
        u = (np.arange(int(planes)) + 0.5) * spacing
        x = extent * (1 + 1 / grading - (1 + grading) / grading * np.exp(-grading * u / extent))
        return x, spacing * (1 + grading * (1 - x / extent))

    def lattice(spacing):
        """Returns positions and spacings of the lattice points in the water. By Ritter (1892), a rarefaction runs back into the column, and a
        tongue of water runs out of it."""
        (x, dx), (y, dy), (z, dz) = (axis(extent, spacing) for extent in (length + 2 * time * wave, width, height))
        z, dz = height - z[::-1], dz[::-1]  # The lattice is finest at the bottom.
        depth = (2 * wave - np.clip((x - length) / time, -wave, 2 * wave)) ** 2 / (9 * GRAVITY)
        wet = np.nonzero(np.broadcast_to((z < depth[:, None])[:, None, :], (len(x), len(y), len(z))))
        return np.stack([x[wet[0]], y[wet[1]], z[wet[2]]], 1), np.stack([dx[wet[0]], dy[wet[1]], dz[wet[2]]], 1)

    spacing = 0.02
    for _ in range(5):  # The count goes with 1 / spacing^3, apart from whole planes.
        spacing *= (len(lattice(spacing)[0]) / count) ** (1 / 3)
    positions, spacings = lattice(spacing)
    volumes = spacings.prod(1)
    # Particles move by up to 0.06 spacings. The sum of V W at particles deep inside then varies by 1.4 %; in dam_break_45k.vtp, which was
    # simulated, it varies by 1.5 % (standard deviations).
    positions += np.random.default_rng(477).uniform(-0.06, 0.06, positions.shape) * spacings
    return positions, {"SmoothingLength": ratio * np.cbrt(volumes), "Density": np.full(len(positions), 1000.0),
                       "Mass": 1000.0 * volumes, "Lambda2": lambda2(positions, 2 * np.pi / 1.1, 2.3)}


def lambda2(positions, wave_number, speed):
    """Returns the middle eigenvalue of S^2 + W^2 for the flow u = speed (sin kz + cos ky, sin kx + cos kz, sin ky + cos
    kx) (Arnold, Beltrami, Childress). S and W are the symmetric and the antisymmetric part of the velocity gradient."""
    result = np.empty(len(positions))
    for first in range(0, len(positions), 1 << 18):  # all matrices at once would need much memory
        p = wave_number * positions[first:first + (1 << 18)]
        s, c = np.sin(p), np.cos(p)
        gradient = np.zeros((len(p), 3, 3))
        for a in range(3):
            before, after = (a - 1) % 3, (a + 1) % 3
            gradient[:, a, before] = c[:, before]
            gradient[:, a, after] = -s[:, after]
        square = gradient @ gradient
        symmetric = 0.5 * (square + square.transpose(0, 2, 1))
        result[first:first + len(p)] = np.linalg.eigvalsh(symmetric)[:, 1]
    return (speed * wave_number) ** 2 * result


def graded(count, ratio=1000):
    """Makes particles whose size grows with the distance from the middle, for adaptive cubes. ratio: largest h / smallest h.

    The particles are jittered shells around a small hole. A cone is left out. The free surface goes from the hole, where
    particles are smallest, along the cone to the outside. Arrays: SmoothingLength, Volume, Sphere (the distance from a sphere that passes
    beside the hole, divided by the distance from the middle).
    """
    def shells(step):
        return 1 + int(math.log(ratio) / math.log(1 + 0.9 * step))

    low, step = 1e-3, 1.0  # spacing over distance from the middle, for about `count` particles; the cone takes 0.3
    for _ in range(60):
        middle = (low + step) / 2
        more = 0.7 * shells(middle) * 4 * math.pi / middle**2 > count
        low, step = (middle, step) if more else (low, middle)
    random, of_shell = np.random.default_rng(11), int(4 * math.pi / step**2)
    i = np.arange(of_shell)
    z = 1 - (2 * i + 1.0) / of_shell
    turn = 2.399963 * i
    directions = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], -1)
    radii = (1 + 0.9 * step) ** np.arange(shells(step))
    p = (radii[:, None, None] * (directions + step * random.uniform(-0.1, 0.1, (len(radii), of_shell, 3)))).reshape(-1, 3)
    p = p[p[:, 0] < 0.4 * np.linalg.norm(p, axis=1)]
    r, beside = np.linalg.norm(p, axis=1), np.array([0, 0, 0.7 * ratio])
    return p, {"SmoothingLength": 1.2 * step * r, "Volume": 0.9 * (step * r) ** 3,
               "Sphere": (np.linalg.norm(p - beside, axis=1) - (0.7 * ratio - 2)) / r}


def wave(count, ratio=1.3, time=0.0):
    """Makes a wave in a flume, in two dimensions (y = 0), for lines. ratio: h / spacing.

    Fluid and walls are a lattice, jittered in the fluid. The flume is 3 m long, with a cylinder. The surface has a steep wave, and a few drops
    fly before its crest. With --steps the wave moves along the flume, by 0.05 s from step to step. Masses are per metre of width.
    Arrays: SmoothingLength (constant), Density (1000), Mass, Type (0 fluid, 1 wall), Pressure (hydrostatic, Pa), Velocity (of a
    solitary wave, m/s).
    """
    length, depth, height, cylinder = 3.0, 0.4, 0.22, (2.15, 0.17, 0.09)
    drops = ((1.62, 0.66, 0.025), (1.69, 0.61, 0.016), (1.75, 0.66, 0.012))
    celerity = np.sqrt(GRAVITY * (depth + height))
    crest = 1.3 + celerity * time

    def top(x):
        """Returns the height of the surface at x. The wave is steeper on the side to which it travels."""
        s = (x - crest) * np.where(x > crest, 7.0, 3.2)
        return depth + height / np.cosh(np.clip(s, -20, 20)) ** 2 + 0.006 * np.sin(21 * x)

    dx = (length * (depth + 0.08) / count) ** 0.5
    layers = 3 * dx
    x, z = (c.ravel() for c in np.meshgrid(np.arange(dx / 2 - layers, length + layers, dx), np.arange(dx / 2 - layers, 1.0, dx)))
    walls = (x < 0) | (x > length) | (z < 0)
    from_cylinder = np.hypot(x - cylinder[0], z - cylinder[1])
    inside = from_cylinder < cylinder[2]
    walls |= inside & (from_cylinder > cylinder[2] - layers)
    drop = np.any([np.hypot(x - a - crest + 1.3, z - b) < r for a, b, r in drops], axis=0)
    fluid = ~walls & ~inside & ((z < top(x)) | drop)
    kept = fluid | (walls & (z < 0.75))
    jitter = np.random.default_rng(477).uniform(-0.12, 0.12, (2, len(x))) * dx
    x, z = (np.where(fluid, c + j, c)[kept] for c, j in zip((x, z), jitter))
    fluid = fluid[kept]
    speed = celerity * (top(x) - depth) / (depth + height)
    rise = -speed * np.tanh((x - crest) * 4) * z / depth
    velocity = np.stack([speed * (0.6 + 0.8 * z / depth), np.zeros_like(x), -rise], -1) * fluid[:, None]
    return np.stack([x, np.zeros_like(x), z], -1), {
        "SmoothingLength": np.full(len(x), ratio * dx), "Density": np.full(len(x), 1000.0),
        "Mass": np.full(len(x), 1000.0 * dx ** 2), "Pressure": 1000 * GRAVITY * np.maximum(top(x) - z, 0) * fluid,
        "Velocity": velocity, "Type": (~fluid).astype(np.int32)}


def splash(count, ratio=1.3, time=0.1):
    """Makes a crown that rises from a pool and falls apart into drops. ratio: h / spacing.

    z points up; lengths are in metres. The sheet of the crown is thrown up at time 0 along a ring of radius 0.3, and each of
    its particles flies freely. With --steps the steps are 0.02 s apart. Arrays: SmoothingLength (constant),
    Density (1000), Mass, Velocity, Id.
    """
    radius, depth, layers, fingers = 0.8, 0.15, 3, 14
    dx = (math.pi * radius ** 2 * depth / (0.8 * count)) ** (1 / 3)
    side = np.arange(-radius + dx / 2, radius, dx)
    pool = np.stack(np.meshgrid(side, side, np.arange(dx / 2, depth, dx) - depth), -1).reshape(-1, 3)
    pool = pool[np.hypot(pool[:, 0], pool[:, 1]) < radius]
    random = np.random.default_rng(477)
    pool += random.uniform(-0.12, 0.12, pool.shape) * dx
    around = int(2 * math.pi * 0.3 / dx)
    rows = max(int(0.2 * count / (around * layers)), 1)
    layer, row, turn = (c.ravel() for c in np.meshgrid(np.arange(layers), np.arange(rows), np.arange(around), indexing="ij"))
    angle = 2 * math.pi * (turn + 0.5 * (row % 2)) / around
    late = row / rows  # Particles with 0 are thrown first, and fastest.
    start = 0.3 + (layer - (layers - 1) / 2) * dx
    out = 0.9 * (1 - 0.5 * late)
    up = 2.3 * (1 - late) * (1 + 0.12 * np.cos(fingers * angle) * (1 - late)) + 0.05
    outwards, flown = np.stack([np.cos(angle), np.sin(angle)], -1), np.minimum(time, 2 * up / GRAVITY)
    height = up * flown - GRAVITY * flown ** 2 / 2
    crown = np.concatenate([(start + out * flown)[:, None] * outwards, height[:, None]], 1)
    crown += random.uniform(-0.1, 0.1, crown.shape) * dx
    flies = (flown >= time)[:, None]
    speed = np.concatenate([out[:, None] * outwards, (up - GRAVITY * flown)[:, None]], 1) * flies
    p = np.concatenate([pool, crown])
    return p, {"SmoothingLength": np.full(len(p), ratio * dx), "Density": np.full(len(p), 1000.0),
               "Mass": np.full(len(p), 1000.0 * dx ** 3), "Velocity": np.concatenate([0 * pool, speed]),
               "Id": np.arange(len(p), dtype=np.int32)}


def plane(count, jitter=0.15):
    """Makes a jittered lattice of spacing 1 in the plane z = 0. Arrays: Swirl, whose isolines wind; Mass and Density, which are 1."""
    side = round(count ** 0.5)
    j, i = np.mgrid[0:side, 0:side]
    places = np.stack([i.ravel(), j.ravel()]) + np.random.default_rng(1).uniform(-jitter, jitter, (2, side * side))
    u, v = places / side
    swirl = np.sin(6 * np.pi * u) * np.sin(4 * np.pi * v) + 0.2 * np.sin(20 * u + 13 * v)
    return np.stack([*places, 0 * u], -1), {"Swirl": swirl, "Mass": np.ones(side * side), "Density": np.ones(side * side)}


def tangents(p):
    """Returns the line element at each node of a closed polygon: half the vector from the previous to the next
    node."""
    return 0.5 * (np.roll(p, -1, 0) - np.roll(p, 1, 0))


def moving_rings(sigma=0.1, z0=0.6, amplitude=0.012, time=3.5, dt=0.03, nodes=384):
    """Returns the rings' centre lines at `time`, and their core radii. After a time of about 4 the thin-filament model
    breaks down."""
    t, rings = np.arange(nodes) * (2.0 * np.pi / nodes), []
    for sign in (1.0, -1.0):
        radius, height = np.ones(nodes), np.zeros(nodes)
        for k, m in enumerate((2, 3, 5, 8, 12)):
            phase = 2.0 * np.pi * ((0.6180339887 * (k + 1) * (1 if sign > 0 else 2)) % 1.0)
            radius += amplitude * np.cos(m * t + phase)
            height += amplitude * np.sin(m * t + 1.7 * phase)
        p = np.stack([radius * np.cos(t), radius * np.sin(t), sign * (z0 + height)], 1)
        rings.append(p if sign < 0 else p[::-1])  # the ring above moves down, the ring below moves up

    def length(p):
        return np.linalg.norm(np.roll(p, -1, 0) - p, axis=1).sum()

    start = [length(p) for p in rings]

    def core(rings):
        return [sigma * np.sqrt(before / length(p)) for p, before in zip(rings, start)]

    def velocity(rings):
        source, dl = np.concatenate(rings), np.concatenate([tangents(p) for p in rings])
        s2 = np.concatenate([np.full(len(p), s * s) for p, s in zip(rings, core(rings))])
        out = np.empty_like(source)
        for a in range(0, len(source), 256):
            d = source[a:a + 256, None, :] - source[None, :, :]
            w = (np.einsum('ijk,ijk->ij', d, d) + s2[None, :]) ** -1.5
            out[a:a + 256] = np.einsum('ij,ijk->ik', w, np.cross(dl[None, :, :], d))
        out *= 1 / (4.0 * np.pi)
        return [out[:nodes], out[nodes:]]

    steps = int(np.ceil(time / dt))
    for _ in range(steps):
        h = time / steps
        k1 = velocity(rings)
        k2 = velocity([p + 0.5 * h * k for p, k in zip(rings, k1)])
        k3 = velocity([p + 0.5 * h * k for p, k in zip(rings, k2)])
        k4 = velocity([p + h * k for p, k in zip(rings, k3)])
        rings = [p + h / 6.0 * (a + 2 * b + 2 * c + d) for p, a, b, c, d in zip(rings, k1, k2, k3, k4)]
    return rings, core(rings)


def deposit(rings, sigmas, origin, dims, dx, cut=4.0):
    """Returns the vorticity on the lattice, as array [nz, ny, nx, 3] float32."""
    w = np.zeros((dims[2], dims[1], dims[0], 3), np.float32)
    axes = [origin[k] + dx * np.arange(dims[k]) for k in range(3)]
    for p, s in zip(rings, sigmas):
        norm = 1 / (np.pi ** 1.5 * s ** 3)
        for x, t in zip(p, tangents(p)):
            g, at = [], []
            for k in range(3):
                a = max(0, int(np.ceil((x[k] - cut * s - origin[k]) / dx)))
                b = min(dims[k], int(np.floor((x[k] + cut * s - origin[k]) / dx)) + 1)
                at.append(slice(a, b))
                g.append(np.exp(-((axes[k][a:b] - x[k]) / s) ** 2))
            e = (norm * (g[2][:, None, None] * g[1][None, :, None] * g[0][None, None, :])).astype(np.float32)
            for k in range(3):
                w[at[2], at[1], at[0], k] += np.float32(t[k]) * e
    return w


def vortex_rings(count, keep_all=False, threshold=1e-3):
    """Makes two vortex rings in head-on collision, on a lattice with h = dx, as remeshing in a vortex particle method does.

    The kernel for these particles is M'4 (Monaghan 1985) with support 2 h. Two coaxial rings of radius 1 and circulation 1 and
    -1, perturbed by azimuthal waves, move by the Rosenhead-Moore (regularised Biot-Savart) law, RK4. They meet at z = 0,
    grow in radius and become thin. The vorticity at a lattice point is the line integral of a 3D Gaussian of core radius sigma;
    sigma^2 * length is kept constant while a ring stretches. Arrays: Vorticity, VorticityMagnitude, SmoothingLength, Volume.
    Particles of negligible vorticity are dropped, unless all are kept.
    """
    rings, sigmas = moving_rings()
    nodes, margin = np.concatenate(rings), 4.0 * max(sigmas)
    low, high = nodes.min(0) - margin, nodes.max(0) + margin
    size = high - low

    def lattice(dx):
        """Returns the first point of a lattice that is centred on the box, and its numbers of points."""
        dims = np.ceil(size / dx).astype(int) + 1
        return 0.5 * (low + high) - 0.5 * dx * (dims - 1), dims

    fraction = 1.0
    if not keep_all:
        probe = (size.prod() / 4.0e5) ** (1.0 / 3.0)
        origin, dims = lattice(probe)
        m = np.linalg.norm(deposit(rings, sigmas, origin, dims, probe), axis=3)
        fraction = np.count_nonzero(m >= threshold * m.max()) / m.size * (dims * probe).prod() / size.prod()
    dx = (size.prod() * fraction / count) ** (1.0 / 3.0)
    origin, dims = lattice(dx)
    w = deposit(rings, sigmas, origin, dims, dx).reshape(-1, 3)
    magnitude = np.linalg.norm(w, axis=1)
    keep = np.arange(len(w)) if keep_all else np.flatnonzero(magnitude >= threshold * magnitude.max())
    places = np.stack([keep % dims[0], (keep // dims[0]) % dims[1], keep // (dims[0] * dims[1])], 1)
    return origin + dx * places, {"Vorticity": w[keep], "VorticityMagnitude": magnitude[keep],
                                  "SmoothingLength": np.full(len(keep), dx), "Volume": np.full(len(keep), dx ** 3)}


def poly_data(positions, arrays):
    """Returns vtkPolyData. positions: [n, 3]; arrays: {name: n values, or n vectors}. Types stay as they are."""
    particles = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(positions, deep=1))
    particles.SetPoints(points)
    vertices = vtk.vtkCellArray()  # Without these ParaView shows nothing.
    vertices.SetData(1, numpy_to_vtkIdTypeArray(np.arange(len(positions)), deep=1))
    particles.SetVerts(vertices)
    for name, values in arrays.items():
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name)
        particles.GetPointData().AddArray(array)
    return particles


def write(path, particles):
    is_legacy = str(path).endswith(".vtk")
    writer = vtk.vtkPolyDataWriter() if is_legacy else vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(particles)
    if is_legacy:
        writer.SetFileTypeToBinary()
    else:
        writer.SetDataModeToBinary()  # appended data cannot be read by every ParaView, see README.md
        writer.SetHeaderTypeToUInt64()
    writer.Write()


def main():
    sets = {make.__name__: make for make in (tank, dam_break, graded, wave, splash, plane, vortex_rings)}
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog="\n\n".join(f"{name}: {make.__doc__}" for name, make in sets.items()))
    parser.add_argument("set", choices=sets)
    parser.add_argument("count", type=lambda text: int(float(text)), metavar="N", help="wanted number of particles, about")
    parser.add_argument("out", metavar="OUT.vtp|.vtk")
    parser.add_argument("--ratio", type=float, default=argparse.SUPPRESS, help="what it is, and its default, depends on the set")
    parser.add_argument("--keep-all", action="store_true", default=argparse.SUPPRESS,
                        help="vortex_rings: particles of negligible vorticity, too")
    parser.add_argument("--steps", type=int, default=0, metavar="K", help="splash, wave: so many steps, OUT_%%04d.vtp or .vtk")
    given = vars(parser.parse_args())
    steps = given.pop("steps")
    chosen, count, out = (given.pop(name) for name in ("set", "count", "out"))
    if "ratio" in given and chosen in ("plane", "vortex_rings") or "keep_all" in given and chosen != "vortex_rings":
        parser.error(f"{chosen} has no such option")
    if steps and (chosen not in INTERVALS or "%" not in out) or not steps and "%" in out:
        parser.error(f"--steps K goes with OUT_%04d.vtp, of {' or '.join(INTERVALS)}")
    for step in range(steps or 1):
        if steps:
            given["time"] = step * INTERVALS[chosen]
        positions, arrays = sets[chosen](count, **given)
        if chosen != "graded":  # Its sizes and places span three decades.
            positions = positions.astype(np.float32)
            arrays = {name: values.astype(np.float32) if values.dtype.kind == "f" else values for name, values in arrays.items()}
        particles = poly_data(positions, arrays)
        if steps:
            time = numpy_to_vtk(np.array([given["time"]]), deep=1)
            time.SetName("TimeValue")
            particles.GetFieldData().AddArray(time)
        write(out % step if steps else out, particles)
    h = arrays.get("SmoothingLength")
    print(f"{out}: {len(positions)} particles" + ("" if h is None else f", h {h.min():.6g} .. {h.max():.6g}"))


if __name__ == "__main__":
    main()
