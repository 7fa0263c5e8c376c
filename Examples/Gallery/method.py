#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the picture of the guide's page on the method, by plain sums over a few particles in a plane.

method.py FILE.svg      (needs numpy)
"""
import sys

import numpy as np

H, CUBE, ISO, WIDTH, HEIGHT, UNIT = 1.3, 1.3, 0.2, 7.8, 6.5, 40  # lengths in spacings of particles; pixels for one
PARTICLE, SQUARE, LINE, EXACT = "#9ecae1", "#fdd0a2", "#888888", "#cb181d"


def particles():
    """A lattice, shifted at random, below empty space; values fall from left to right, and wind."""
    x, y = np.meshgrid(np.arange(0.5, WIDTH), np.arange(0.3, 5))
    at = np.stack([x.ravel(), y.ravel()], 1) + np.random.default_rng(3).uniform(-0.18, 0.18, (x.size, 2))
    return at, 0.5 + 0.5 * np.tanh(3 * (3.2 - at[:, 0] + 1.2 * np.sin(1.1 * at[:, 1])))


AT, VALUE = particles()


def sums(point):
    """The weight sum, and the Shepard mean."""
    q = np.hypot(*(AT - point).T) / H
    w = 10 / (7 * np.pi * H * H) * (0.25 * np.maximum(2 - q, 0) ** 3 - np.maximum(1 - q, 0) ** 3)
    return w.sum(), (w * VALUE).sum() / max(w.sum(), 1e-12)


def root(a, b, of, level):
    """Where a quantity has the level, between two points on either side of it."""
    for _ in range(50):
        middle = (a + b) / 2
        a, b = (middle, b) if (of(middle) > level) == (of(a) > level) else (a, middle)
    return a


def march():
    """Used squares; for each its line's ends: by linear interpolation, and where the mean has the iso value."""
    used, linear, exact = [], [], []
    for i in range(round(WIDTH / CUBE)):
        for j in range(round(HEIGHT / CUBE)):
            corners = [np.array([i + u, j + v]) * CUBE for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))]
            found = [sums(corner) for corner in corners]
            if min(weight for weight, _ in found) < 0.1:
                continue
            crossed = [k for k in range(4) if (found[k][1] > ISO) != (found[k - 1][1] > ISO)]
            if len(crossed) == 2:
                used.append(corners[0])
                linear.append([corners[k] + (ISO - found[k][1]) / (found[k - 1][1] - found[k][1]) * (corners[k - 1] - corners[k])
                               for k in crossed])
                exact.append([root(corners[k], corners[k - 1], lambda p: sums(p)[1], ISO) for k in crossed])
    return used, linear, exact


def place(panel, point):
    return panel * (WIDTH + 1.6) * UNIT + point[0] * UNIT + 30, (HEIGHT - point[1]) * UNIT + 12


def circle(panel, point, radius, style):
    return '<circle cx="%.1f" cy="%.1f" r="%g" %s/>' % (*place(panel, point), radius, style)


def stroke(panel, a, b, style):
    return '<line x1="%.1f" y1="%.1f" x2="%.1f" y2="%.1f" %s/>' % (*place(panel, a), *place(panel, b), style)


def square(panel, low, colour):
    x, y = place(panel, low + (0, CUBE))
    return f'<rect x="{x:.1f}" y="{y:.1f}" width="{CUBE * UNIT:g}" height="{CUBE * UNIT:g}" fill="{colour}" stroke="{LINE}"/>'


def draw():
    used, linear, exact = march()
    out = []
    for panel in range(4):
        out += [square(panel, low, SQUARE) for low in used if panel > 0]
        out += [circle(panel, at, 5, f'fill="{PARTICLE}"' if value > ISO else f'fill="none" stroke="{PARTICLE}" stroke-width="2"')
                for at, value in zip(AT, VALUE)]
    for n in CUBE * np.arange(round(WIDTH / CUBE) + 1):
        out.append(stroke(0, (n, 0), (n, HEIGHT), f'stroke="{LINE}" stroke-width="0.6"'))
    for n in CUBE * np.arange(round(HEIGHT / CUBE) + 1):
        out.append(stroke(0, (0, n), (WIDTH, n), f'stroke="{LINE}" stroke-width="0.6"'))
    for before, after in zip(linear, exact):
        out.append(stroke(2, *before, 'stroke="#555" stroke-width="1.5" stroke-dasharray="4 3"'))
        out.append(stroke(2, *after, f'stroke="{EXACT}" stroke-width="2.5"'))
        for a, b in zip(before, after):
            out += [circle(2, a, 3, 'fill="white" stroke="#555"'), circle(2, b, 3.5, f'fill="{EXACT}"')]
        ends, inside = list(after), [sums(p)[0] >= 0.5 for p in after]
        if any(inside):
            cut = root(*ends, lambda p: sums(p)[0], 0.5)
            ends = [p if stays else cut for p, stays in zip(ends, inside)]
            out.append(stroke(3, *ends, f'stroke="{EXACT}" stroke-width="2.5"'))
        if not all(inside):
            out.append(stroke(3, *after, f'stroke="{EXACT}" stroke-width="1" stroke-dasharray="2 3"'))
    for panel, text in enumerate(("1 particles, squares", "2 squares with the line", "3 corrected", "4 trimmed")):
        x, y = place(panel, (0, 0))
        out.append(f'<text x="{x:.0f}" y="{y + 26:.0f}" font-family="sans-serif" font-size="17">{text}</text>')
    width, height = 4 * (WIDTH + 1.6) * UNIT, HEIGHT * UNIT + 56
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}">\n<rect width="100%" height="100%" fill="white"/>\n'
            + "\n".join(out) + "\n</svg>\n")


if __name__ == "__main__":
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write(draw())
