# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the particles among the cells of a mesh: the points of its vertices."""
import numpy as np

from .._library import say, warn

VERTICES = (1, 2)  # VTK's types of cells that are points


def offsets_of(cells, count):
    """cells: each cell's number of points, then its points. Returns where cells begin, and the list without these numbers."""
    width = len(cells) // count if count else 0
    if count and width * count == len(cells) and (cells[::width] == width - 1).all():
        return np.arange(count + 1) * (width - 1), cells.reshape(count, width)[:, 1:].ravel()
    begins, at = [], 0
    while at < len(cells):
        begins.append(at)
        at += 1 + max(int(cells[at]), 0)
    begins = np.array(begins + [len(cells)], int)
    if at != len(cells) or len(begins) != count + 1:
        raise ValueError("a list of cells is damaged")
    return begins - np.arange(count + 1), np.delete(cells, begins[:-1])


def find_vertices(types, offsets, points, count):
    """Returns, for each point, the first vertex that uses it, or -1."""
    cells = np.repeat(np.arange(len(types)), np.diff(offsets))
    used = np.isin(types, VERTICES)[cells] & (points >= 0) & (points < count)
    found = np.full(count, -1)
    found[points[used][::-1]] = cells[used][::-1]  # If several vertices use a point, the first counts.
    return found


def take_vertices(file, body, lists, cell_arrays):
    """Takes only the vertices' points if there are other cells, too: other points are a mesh's. Arrays of cells become
    arrays of these points, unless points have one of that name; also where each point has a vertex.

    lists: pairs of cells' types, and a function that returns where the points of each cell end, and these points; cell_arrays: {name: function}
    """
    types, count = np.concatenate([np.zeros(0, int), *(types for types, _ in lists)]), len(body.points)
    is_vertex = np.isin(types, VERTICES)
    body = body._replace(is_mesh=not is_vertex.any()) if len(types) else body
    if not is_vertex.any() or is_vertex.all() and not cell_arrays:
        return body
    offsets, points = [np.zeros(1, int)], []
    for _, load in lists:
        ends, own = load()
        offsets.append(offsets[-1][-1] + ends)
        points.append(own)
    cell_of = find_vertices(types, np.concatenate(offsets), np.concatenate(points), count)
    if is_vertex.all() and (cell_of < 0).any():
        return body
    if not is_vertex.all():
        warn(say("MESH_NODES", count - np.count_nonzero(cell_of >= 0), count, " of ", file))
    taken, of_cells = np.flatnonzero(cell_of >= 0), {name: load() for name, load in cell_arrays.items()}
    of_cells = {name: array[cell_of[taken]] for name, array in of_cells.items() if len(array) == len(types)}
    return body._replace(points=body.points[taken],
                         arrays={**of_cells, **{name: array[taken] for name, array in body.arrays.items()}})
