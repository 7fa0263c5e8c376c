#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the pictures of the guide's page on flux and of its section on curvature.

flux_and_curvature.py DIRECTORY     (needs the wheel marchingcorrectors, PyVista and Matplotlib)

Writes DIRECTORY/flux.png and DIRECTORY/curvature.png.
"""
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pyvista

import marchingcorrectors as mc

DATA = Path(__file__).resolve().parent.parent / "Data" / "dam_break_45k.vtp"
FLUID = ("ParticleType", 0)
PLACE = 1.0  # of the section that is shown, m along the tank
CAMERA = [(0.2, 2.0, 3.6), (1.62, 0.35, 0.0), (0, 1, 0)]


def wall(x):
    """Across the tank; the normal is along it."""
    return np.array([[x, -0.1, -0.6], [x, 1.3, -0.6], [x, -0.1, 0.6]])


def shot(plotter):
    plotter.camera_position = CAMERA
    plotter.camera.zoom(0.95)
    return plotter.screenshot(return_img=True)


def flux(particles, surface, to):
    section = pyvista.Plane(center=(PLACE, 0.3, 0), direction=(1, 0, 0), i_size=1.0, j_size=0.8, i_resolution=400,
                            j_resolution=400)
    section = particles.sph.probe(section, fluid=FLUID, attributes=["Velocity"]).threshold(0.5, scalars="WeightSum")
    section["v_x"] = section["Velocity"][:, 0]
    plotter = pyvista.Plotter(off_screen=True, window_size=(1100, 620))
    plotter.background_color = "white"
    plotter.add_mesh(surface, color="#9cc4e8", opacity=0.25)
    plotter.add_mesh(section, scalars="v_x", cmap="coolwarm", clim=(-3, 3), lighting=False, scalar_bar_args={
        "title": "velocity along the tank in m/s", "color": "black", "position_x": 0.25, "position_y": 0.03})
    picture = shot(plotter)
    places = np.linspace(0.02, 3.2, 160)
    fluid = particles["ParticleType"] == 0
    found = mc.flux(particles.points, particles["Velocity"], {f"{x:.3f}": wall(x) for x in places},
                    smoothing_length=particles["SmoothingLength"], mass=particles["Mass"], density=particles["Density"],
                    solid=~fluid)
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 7.6), height_ratios=(1.5, 1), layout="constrained")
    above.imshow(picture)
    above.axis("off")
    below.plot(places, found.volume_flux, color="#1f4e8c", label="volume flux in m³/s")
    below.plot(places, found.area, color="#e08030", label="area in fluid in m²")
    below.axhline(0, color="black", linewidth=0.6)
    below.axvline(PLACE, color="gray", linestyle=":")
    below.set_xlabel("section's place along the tank in m")
    below.legend(frameon=False)
    figure.savefig(to / "flux.png", dpi=110)
    print(f"at x = {PLACE}: {np.interp(PLACE, places, found.volume_flux):.4f} m^3/s through "
          f"{np.interp(PLACE, places, found.area):.4f} m^2")


def curvature(surface, to):
    plotter = pyvista.Plotter(off_screen=True, window_size=(1100, 620))
    plotter.background_color = "white"
    plotter.add_mesh(surface, scalars="MeanCurvature", cmap="coolwarm", clim=(-60, 60), scalar_bar_args={
        "title": "mean curvature in 1/m", "color": "black", "position_x": 0.25, "position_y": 0.03})
    plt.imsave(to / "curvature.png", shot(plotter))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    to = Path(sys.argv[1])
    particles = pyvista.read(DATA)
    surface = particles.sph.free_surface(fluid=FLUID, mean_curvature=True)
    flux(particles, surface, to)
    curvature(surface, to)


if __name__ == "__main__":
    main()
