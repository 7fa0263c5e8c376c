# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Finds spray: particles in small drops, or alone. A film shows them as balls beside the surface of the other particles."""
import dataclasses

import numpy as np

from ._arrays import values_of
from ._call import prepare, words_of_file
from ._functions import probe
from ._library import InvalidArgument
from ._options import PROBE
from ._surface import CELLS
from ._units import Units
from ._usd import Spray
from .io._particles import usual

KEYWORDS = ("smoothing_length", "volume", "mass", "density", "solid", "fluid", "within", "only", "device")


def fluid_and_volume(words):
    """Returns which particles are fluid, and their volumes, or None if volumes are computed. words: keywords of a function."""
    words = dict(words)
    arguments = prepare(Units(words.pop("positions")), words)
    given, count = arguments.input, arguments.count
    volume, mass, density = (values_of(each, count) for each in (given.volume, given.mass, given.density))
    volume = mass / density if volume is None and mass is not None and density is not None else volume
    return np.ctypeslib.as_array(given.solid, (count,)) == 0 if given.solid else np.ones(count, bool), volume


def take_spray(surface, particles, words, iso, least, velocity=None):
    """Returns the surface without the closed pieces that enclose fewer than `least` fluid particles, and the spray: the
    particles in these pieces, and particles where the sum of the weights is below `iso`. A particle that is nearest to a
    point of another piece, as at its tip, is no spray.

    words: keywords of free_surface(), which made the surface, with nearest_particle. velocity: the name of its array.
    """
    if surface.line_offsets is not None:
        raise InvalidArgument("Spray is for three dimensions; leave --spray out.")
    kept = {name: value for name, value in words.items() if name in PROBE or name in KEYWORDS}
    every = particles.positions
    is_fluid, volume = fluid_and_volume(words_of_file(particles, kept))
    fluid = np.flatnonzero(is_fluid)
    is_spray = probe(particles, every[fluid], **kept).weight_sum < iso
    label = label_pieces(surface.triangles, len(surface.points))
    small = small_pieces(surface, label, every, fluid, least)
    is_small = np.isin(label, [piece for piece, _ in small])
    is_spray &= ~np.isin(fluid, surface.nearest_particle[~is_small])
    is_spray |= np.isin(fluid, np.concatenate([np.zeros(0, int), *(own for _, own in small)]))
    surface = dataclasses.replace(surface, nearest_particle=None)
    chosen = fluid[is_spray]
    ids = usual([name for name in particles.arrays if particles.arrays[name].dtype.kind in "iu"], "particle_id")
    return without_points(surface, is_small), Spray(
        every[chosen], find_widths(surface, volume, len(every))[chosen],
        None if velocity is None else particles.arrays[velocity][chosen], None if ids is None else particles.arrays[ids][chosen])


def label_pieces(triangles, count):
    """Returns the lowest point of each point's piece; triangles that share points are one piece."""
    label = np.arange(count)
    edges = np.concatenate([triangles[:, :2], triangles[:, 1:]]).astype(np.int64)
    while True:
        ends = label[edges]
        lowest = ends.min(axis=1)
        if (ends == lowest[:, None]).all():
            return label
        np.minimum.at(label, ends.ravel(), np.repeat(lowest, 2))
        while (label[label] != label).any():
            label = label[label]


def small_pieces(surface, label, positions, fluid, least):
    """Returns (piece, its particles) for each closed piece with fewer than `least` particles. A piece's particles are enclosed by it, or nearest
    to its points. Cavities are not listed; a cavity is left out with the piece around it."""
    piece = label[surface.triangles[:, 0]]
    corners = surface.points[surface.triangles].astype(float)
    volume = np.bincount(piece, np.linalg.det(corners), len(label))
    nearest = np.unique(np.stack([label, surface.nearest_particle], axis=1), axis=0)
    begins = np.searchsorted(nearest[:, 0], np.arange(len(label) + 1))
    order, along = np.argsort(piece, kind="stable"), fluid[np.argsort(positions[fluid, 0], kind="stable")]
    ends = np.searchsorted(piece[order], np.arange(len(label) + 1))
    found, x = [], positions[along, 0]
    for each in np.flatnonzero((np.diff(begins) > 0) & (np.diff(begins) < least) & (np.diff(ends) > 0)):
        own = order[ends[each]:ends[each + 1]]
        low, high = corners[own].min(axis=(0, 1)), corners[own].max(axis=(0, 1))
        near = along[np.searchsorted(x, low[0]):np.searchsorted(x, high[0], "right")]
        near = near[((positions[near] >= low) & (positions[near] <= high)).all(axis=1)]
        if is_closed(surface.triangles[own]):
            inside = near[encloses(corners[own], positions[near].astype(float))]
            found.append((each, np.union1d(inside, nearest[begins[each]:begins[each + 1], 1]), low, high))
    small = [one for one in found if volume[one[0]] > 0 and len(one[1]) < least]
    small += [one for one in found if volume[one[0]] <= 0 and any(
        (one[2] >= other[2]).all() and (one[3] <= other[3]).all() for other in small)]
    return [one[:2] for one in small]


def is_closed(triangles):
    """Returns whether each edge has a triangle on both sides."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    there, back = (np.sort(edges[:, i] << 32 | edges[:, 1 - i]) for i in range(2))
    return np.array_equal(there, back)


def encloses(corners, points):
    """Returns, for each point, whether the triangles surround it: their solid angles add up to a full sphere."""
    a, b, c = np.moveaxis(corners[None] - points[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(each, axis=-1) for each in (a, b, c))
    dot = lambda one, other: np.einsum("...i,...i", one, other)  # noqa: E731
    angle = np.arctan2(dot(a, np.cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    return np.abs(angle.sum(axis=1)) > np.pi


def without_points(surface, left_out):
    """Returns the surface without these points, and without triangles that have one."""
    if not left_out.any():
        return surface
    number = np.cumsum(~left_out) - 1
    kept = ~left_out[surface.triangles[:, 0]]
    arrays = {f.name: getattr(surface, f.name)[~left_out] for f in dataclasses.fields(surface)
              if isinstance(getattr(surface, f.name), np.ndarray) and (f.name == "points" or f.name not in CELLS)}
    return dataclasses.replace(
        surface, **arrays, triangles=number[surface.triangles[kept]].astype(surface.triangles.dtype),
        triangle_keys=None if surface.triangle_keys is None else surface.triangle_keys[kept],
        attributes={name: array[~left_out] for name, array in surface.attributes.items()})


def find_widths(surface, volume, count):
    """Returns diameters of balls with the particles' volumes. volume: None means (h / 1.3)^3."""
    volume = (surface.statistics["smoothing_length_max"] / 1.3) ** 3 if volume is None else volume
    return np.broadcast_to(np.cbrt(6 / np.pi * np.asarray(volume, float)), count)
