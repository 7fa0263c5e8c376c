#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the guide's plots, and pictures that show our surfaces beside other software's.

plots.py DIRECTORY [NAME...]     (without a display: Testing/with-display.sh python3 plots.py ...)

Names are those of the files, which are listed at the end of this script; all of them if none is given. Needs the wheel
marchingcorrectors, PyVista and Matplotlib, and for smooth.png pysplashsurf.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pyvista
import vtk

import marchingcorrectors as mc

EXAMPLES = Path(__file__).resolve().parent.parent
DATA = EXAMPLES / "Data"
sys.path.insert(0, str(EXAMPLES / "Benchmark"))
from measure import interpolator, smoothed_by_splashsurf  # noqa: E402
FLUID = ("ParticleType", 0)


def dam_break():
    return pyvista.read(DATA / "dam_break_45k.vtp")


def plotter_of(size, **more):
    plotter = pyvista.Plotter(off_screen=True, window_size=size, **more)
    plotter.background_color = "white"
    return plotter


def shot(plotter, camera=((0.2, 2.0, 3.6), (1.62, 0.35, 0.0), (0, 1, 0)), zoom=0.95):
    plotter.camera_position = camera
    plotter.camera.zoom(zoom)
    return plotter.screenshot(return_img=True)


def legend_of(title):
    return {"title": title + "\n", "color": "black", "position_x": 0.25, "position_y": 0.03}


def flux():
    """Plots the dam break with a section, and fluxes along the tank."""
    particles, place = dam_break(), 1.0
    section = pyvista.Plane(center=(place, 0.3, 0), direction=(1, 0, 0), i_size=1.0, j_size=0.8, i_resolution=400,
                            j_resolution=400)
    section = particles.sph.probe(section, fluid=FLUID, attributes=["Velocity"]).threshold(0.5, scalars="WeightSum")
    section["v_x"] = section["Velocity"][:, 0]
    plotter = plotter_of((1100, 620))
    plotter.add_mesh(particles.sph.free_surface(fluid=FLUID), color="#9cc4e8", opacity=0.25)
    plotter.add_mesh(section, scalars="v_x", cmap="coolwarm", clim=(-3, 3), lighting=False,
                     scalar_bar_args=legend_of("velocity along the tank in m/s"))
    places = np.linspace(0.02, 3.2, 160)
    # The sections lie across the tank; their normals point along the tank.
    walls = {f"{x:.3f}": np.array([[x, -0.1, -0.6], [x, 1.3, -0.6], [x, -0.1, 0.6]]) for x in places}
    found = particles.sph.flux(walls, fluid=FLUID)
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 7.6), height_ratios=(1.5, 1), layout="constrained")
    above.imshow(shot(plotter))
    above.axis("off")
    below.plot(places, found.volume_flux, color="#1f4e8c", label="volume flux in m³/s")
    below.plot(places, found.area, color="#e08030", label="area in fluid in m²")
    below.axhline(0, color="black", linewidth=0.6)
    below.axvline(place, color="gray", linestyle=":")
    below.set_xlabel("section's place along the tank in m")
    below.legend(frameon=False)
    print(f"at x = {place}: {np.interp(place, places, found.volume_flux):.4f} m^3/s through "
          f"{np.interp(place, places, found.area):.4f} m^2")
    return figure


def curvature():
    plotter = plotter_of((1100, 620))
    plotter.add_mesh(dam_break().sph.free_surface(fluid=FLUID, mean_curvature=True), scalars="MeanCurvature", cmap="coolwarm",
                     clim=(-60, 60), scalar_bar_args=legend_of("mean curvature in 1/m"))
    return shot(plotter)


SPACING, DEPTH, LENGTH, HEIGHT = 0.02, 0.4, 1.0, 0.03  # The tank has a standing wave; lengths are in m.
WAVE = np.pi / LENGTH
PERIOD = 2 * np.pi / np.sqrt(9.81 * WAVE * np.tanh(WAVE * DEPTH))


def level(time):
    """Moves particles as the linear theory of a standing wave moves water. Returns the time and three levels near the
    tank's end: by the gauge, by the theory, and of the highest particle nearby."""
    axes = [np.arange(SPACING / 2, extent, SPACING) for extent in (LENGTH, 0.2, DEPTH)]
    x, y, z = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3).T
    phase = np.cos(2 * np.pi * time / PERIOD)
    amplitude = HEIGHT * phase / np.sinh(WAVE * DEPTH)
    places = np.stack([x - amplitude * np.sin(WAVE * x) * np.cosh(WAVE * z), y,
                       z + amplitude * np.cos(WAVE * x) * np.sinh(WAVE * z)], -1)
    gauge = mc.gauge(places, ((0.05, 0.1, 0), (0.05, 0.1, 0.6)), smoothing_length=1.3 * SPACING, volume=SPACING ** 3)
    near = np.hypot(places[:, 0] - 0.05, places[:, 1] - 0.1) < 1.5 * SPACING
    return time, gauge.last[0], DEPTH + HEIGHT * phase * np.cos(WAVE * 0.05), places[near, 2].max()


def volumes_of(surface):
    """Returns, for each triangle, the volume of its piece in cm^3; and, for each piece, its first triangle."""
    piece = surface.connectivity().cell_data["RegionId"]
    a, b, c = (surface.points.astype(float)[surface.faces.reshape(-1, 4)[:, i]] for i in (1, 2, 3))
    return 1e6 * np.bincount(piece, (a * np.cross(b, c)).sum(1) / 6)[piece], np.unique(piece, return_index=True)[1]


def numbers():
    """Plots a wave gauge over time, and drops by their volume."""
    time, gauge, theory, highest = np.array([level(time) for time in np.linspace(0, 2 * PERIOD, 41)]).T
    print(f"gauge: off the theory by {np.abs(gauge - theory).max() / SPACING:.3f} spacings at most; the highest particle by "
          f"{np.abs(highest - theory).max() / SPACING:.3f}")
    figure, axes = plt.subplot_mosaic([["level", "drops"], ["shot", "drops"]], figsize=(14, 8), width_ratios=(1.6, 1),
                                      layout="constrained")
    axes["level"].plot(time, highest, "o", color="#aaaaaa", label="highest particle")
    axes["level"].plot(time, theory, color="#f08c3c", label="linear theory")
    axes["level"].plot(time, gauge, "o", color="#1450a0", label="gauge")
    axes["level"].set(xlabel="time in s", ylabel="level in m, x = 0.05", ylim=(0.35, 0.47))
    axes["level"].legend(loc="upper right")
    surface = dam_break().sph.free_surface(fluid=FLUID)
    volumes, first = volumes_of(surface)
    drops = np.sort(volumes[first])[:-1]
    print(f"pieces: {len(first)}; largest but one {drops[-1]:.0f} cm^3")
    surface.cell_data["volume"] = np.log10(np.maximum(volumes, 1))
    plotter = plotter_of((1100, 520))
    plotter.add_mesh(surface, scalars="volume", cmap="autumn", clim=(0.5, 2.8), above_color="#5999d9", show_scalar_bar=False)
    axes["shot"].imshow(shot(plotter, ((2.6, 2.3, 3.4), (1.6, 0.45, 0), (0, 1, 0)), 0.95))
    axes["shot"].axis("off")
    axes["drops"].hist(drops[drops > 0], np.geomspace(1, 1000, 16), rwidth=0.85, color="#dc7828", edgecolor="black")
    axes["drops"].set(xscale="log", xlabel="volume in cm³", ylabel="drops")
    return figure


def projection(count=60000, size=480, decades=3.5):
    """Plots a disc galaxy, with gas in two spiral arms, from above and from the side: on the left the column
    density, on the right the number of particles in each pixel."""
    random = np.random.default_rng(5)
    radius = 0.22 * random.gamma(2, size=count)
    angle = random.uniform(0, 2 * np.pi, count)
    angle -= 0.42 * np.sin(2 * (angle - 4 * np.log(radius + 0.05)))
    places = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.03 * (0.4 + radius) * random.normal(size=count)], -1)
    figure, axes = plt.subplots(2, 2, figsize=(9.68, 6.32), height_ratios=(10, 3), gridspec_kw={"hspace": 0.02, "wspace": 0.02})
    figure.subplots_adjust(0, 0, 1, 1)
    highest = None
    for row, direction, y, high in ((0, "z", 1, 1.0), (1, (0, 1, 0), 2, 0.3)):
        found = mc.project(places, mass=np.full(count, 1 / count), estimate_smoothing_length="neighbours", direction=direction,
                           resolution=size, box=(-1, 1, -1, 1, -high, high)).values
        highest = highest or found.max()
        counted, _, _ = np.histogram2d(places[:, y], places[:, 0], found.shape, [[-high, high], [-1, 1]])
        for axis, values in zip(axes[row], (found, counted * (size / 2) ** 2 / count)):
            with np.errstate(divide="ignore"):
                shown = np.maximum(np.log10(values / highest), -decades)
            axis.imshow(shown, cmap="inferno", vmin=-decades, vmax=0, origin="lower", aspect="auto", interpolation="none")
            axis.axis("off")
    return figure


def interpolate(particles, square):
    """Returns the pressure on an image of the plane as VTK interpolates it; 0 where no particle reaches."""
    bounds = particles.bounds
    image = pyvista.ImageData(
        origin=(bounds[0] - 4 * square, 0, bounds[4] - 4 * square), spacing=(square, square, square),
        dimensions=(int((bounds[1] - bounds[0]) / square) + 9, 1, int((bounds[5] - bounds[4]) / square) + 9))
    field = interpolator(particles, image, particles["SmoothingLength"][0], 2, "Pressure", "Mass", "Density")
    field.SetShepardNormalization(False)
    field.Update()
    return pyvista.wrap(field.GetOutput()).extract_surface(algorithm=None)


def plane_bands(values=(-1, 1000, 2000, 3000)):
    """Plots bands of pressure in a flume and, below, the bands of vtkSPHInterpolator on squares of the same size."""
    with tempfile.TemporaryDirectory() as folder:
        flume = Path(folder) / "flume.vtp"
        subprocess.run([sys.executable, DATA / "make_particles.py", "wave", "20000", flume], check=True, stdout=subprocess.DEVNULL)
        particles = pyvista.read(flume)
    ours = particles.sph.isosurface("Pressure", list(values), fluid=("Type", 0), filled=True)
    fluid = particles.extract_points(particles["Type"] == 0).extract_surface(algorithm=None)
    field = interpolate(fluid, 0.5 * fluid["SmoothingLength"][0])
    bands = vtk.vtkBandedPolyDataContourFilter()
    bands.SetInputData(field)
    bands.SetInputArrayToProcess(0, 0, 0, 0, "Pressure")
    bands.SetScalarModeToValue()
    for i, value in enumerate([*values, 1e9]):
        bands.SetValue(i, value)
    bands.GenerateContourEdgesOn()
    bands.ClippingOn()
    bands.Update()
    theirs, edges = (pyvista.wrap(bands.GetOutput(i)) for i in (0, 1))
    plotter = plotter_of((1100, 660), shape=(2, 1), border=False)
    for row, (mesh, lines, array) in enumerate(((ours, ours, "BandValue"), (theirs, edges, "Scalars"))):
        plotter.subplot(row, 0)
        plotter.add_mesh(mesh, scalars=array, cmap=["#93d3ff", "#78ffd7", "#deff5e", "#ff9145"], clim=(0, values[-1]),
                         lighting=False, show_scalar_bar=False)
        plotter.add_mesh(pyvista.PolyData(lines.points - (0, 0.01, 0), lines=lines.lines), color="#1a1a1a", lighting=False,
                         line_width=1.5)
        middle = np.array(fluid.center)
        plotter.camera_position = [middle - (0, 5, 0), middle, (0, 0, 1)]
        plotter.enable_parallel_projection()
        plotter.camera.parallel_scale = 0.162 * (fluid.bounds[1] - fluid.bounds[0])
    plotter.enable_anti_aliasing("msaa", multi_samples=8)
    return plotter.screenshot(return_img=True)


def smooth():
    """Plots three surfaces: the free surface, the smooth free surface, and the one of splashsurf, with cubes of half a particle radius."""
    particles = dam_break()
    water = particles.extract_points(particles["ParticleType"] == 0)
    made = smoothed_by_splashsurf(water.points, float(np.median(water["Mass"] / water["Density"])) ** (1 / 3))
    theirs = pyvista.PolyData.from_regular_faces(np.asarray(made.mesh.vertices), np.asarray(made.mesh.triangles))
    theirs.point_data.active_normals = np.asarray(made.point_attributes["normals"])
    meshes = {"as it is": particles.sph.free_surface(fluid=FLUID),
              "--smooth": particles.sph.free_surface(fluid=FLUID, smooth=True), "splashsurf": theirs}
    x, y, z = np.reshape(meshes["as it is"].bounds, (3, 2))
    size, focus = x[1] - x[0], np.array([0.3 * x[0] + 0.7 * x[1], 0.6 * y[0] + 0.4 * y[1], z.mean()])
    plotter = plotter_of((1680, 520), shape=(1, 3), border=False)
    for column, (name, mesh) in enumerate(meshes.items()):
        plotter.subplot(0, column)
        plotter.add_mesh(mesh, color=(0.36, 0.60, 0.85), specular=0.4, specular_power=40, smooth_shading=True)
        plotter.add_text(f"{name}: {mesh.n_cells:,} triangles", position=(12, 10), font_size=11, color="black")
        plotter.camera_position = [focus + size * np.array([-0.25, 0.35, 0.8]), focus, (0, 1, 0)]
        plotter.camera.view_angle = 20
    plotter.enable_anti_aliasing("fxaa")
    return plotter.screenshot(return_img=True)


CUBE, ISO, WIDE, HIGH = 1.3, 0.2, 7.8, 6.5  # These are for the method's picture; lengths are in spacings of particles.


def method():
    """Plots the method's four steps, by plain sums over a few particles in a plane."""
    x, y = np.meshgrid(np.arange(0.5, WIDE), np.arange(0.3, 5))  # a lattice, moved at random, below empty space
    at = np.stack([x.ravel(), y.ravel()], 1) + np.random.default_rng(3).uniform(-0.18, 0.18, (x.size, 2))
    value = 0.5 + 0.5 * np.tanh(3 * (3.2 - at[:, 0] + 1.2 * np.sin(1.1 * at[:, 1])))

    def sums(point, h=1.3):
        """Returns the weight sum, and the Shepard mean, at a point."""
        q = np.hypot(*(at - point).T) / h
        w = 10 / (7 * np.pi * h * h) * (0.25 * np.maximum(2 - q, 0) ** 3 - np.maximum(1 - q, 0) ** 3)
        return w.sum(), (w * value).sum() / max(w.sum(), 1e-12)

    def root(a, b, which, wanted):
        """Returns a point between a and b where the weight sum (which: 0) or the Shepard mean (1) has the wanted value."""
        for _ in range(50):
            middle = (a + b) / 2
            a, b = (middle, b) if (sums(middle)[which] > wanted) == (sums(a)[which] > wanted) else (a, middle)
        return a

    figure, panels = plt.subplots(1, 4, figsize=(15, 3.4), layout="constrained")
    for panel, text in zip(panels, ("1 particles, squares", "2 squares with the line", "3 corrected", "4 trimmed")):
        for filled in (True, False):
            chosen = at[(value > ISO) == filled]
            panel.plot(*chosen.T, "o", color="#9ecae1", markersize=8, fillstyle="full" if filled else "none", markeredgewidth=1.6)
        panel.set(xlim=(-0.1, WIDE + 0.1), ylim=(-0.9, HIGH + 0.1), aspect="equal")
        panel.axis("off")
        panel.text(0, -0.7, text, fontsize=13)
    for n in CUBE * np.arange(round(WIDE / CUBE) + 1):
        panels[0].plot([n, n], [0, HIGH], "#888888", linewidth=0.6)
    for n in CUBE * np.arange(round(HIGH / CUBE) + 1):
        panels[0].plot([0, WIDE], [n, n], "#888888", linewidth=0.6)
    for low in CUBE * np.stack(np.meshgrid(range(round(WIDE / CUBE)), range(round(HIGH / CUBE))), -1).reshape(-1, 2):
        corners = [low + CUBE * np.array(corner) for corner in ((0, 0), (1, 0), (1, 1), (0, 1))]
        found = [sums(corner) for corner in corners]
        crossed = [k for k in range(4) if (found[k][1] > ISO) != (found[k - 1][1] > ISO)]
        if min(weight for weight, _ in found) < 0.1 or len(crossed) != 2:
            continue
        for panel in panels[1:]:
            panel.add_patch(plt.Rectangle(low, CUBE, CUBE, facecolor="#fdd0a2", edgecolor="#888888", zorder=0))
        linear = np.array([corners[k] + (ISO - found[k][1]) / (found[k - 1][1] - found[k][1]) * (corners[k - 1] - corners[k])
                           for k in crossed])
        exact = np.array([root(corners[k], corners[k - 1], 1, ISO) for k in crossed])
        panels[2].plot(*linear.T, "o--", color="#555555", markerfacecolor="white", markersize=5, linewidth=1.2)
        panels[2].plot(*exact.T, "o-", color="#cb181d", markersize=5, linewidth=2)
        inside = np.array([sums(point)[0] >= 0.5 for point in exact])
        if not inside.all():
            panels[3].plot(*exact.T, ":", color="#cb181d", linewidth=1)
        if inside.any():
            cut = root(*exact, 0, 0.5)
            panels[3].plot(*np.where(inside[:, None], exact, cut).T, color="#cb181d", linewidth=2)
    return figure


PICTURES = {"curvature.png": curvature, "flux.png": flux, "method.png": method, "numbers.png": numbers,
            "plane_bands.png": plane_bands, "projection.png": projection, "smooth.png": smooth}


def main(folder, names):
    for name in names or PICTURES:
        if name not in PICTURES:
            sys.exit(f"plots.py: there is no picture {name}; there are {', '.join(PICTURES)}")
        drawn, path = PICTURES[name](), Path(folder) / name
        if isinstance(drawn, np.ndarray):
            plt.imsave(path, drawn)
        else:
            drawn.savefig(path, dpi=110 if name == "flux.png" else 100)
        print(path)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
