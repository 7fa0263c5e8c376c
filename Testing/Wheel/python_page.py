# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Goes through the guide's page "In Python": runs its blocks as they stand (PyVista's blocks only if PyVista is installed), and
checks what the page says of the functions for NumPy. test_systems.py runs this script under wine.

    python_page.py GUIDE/python.md
"""
import importlib.util
import multiprocessing
import os
import re
import struct
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path

import numpy as np

import marchingcorrectors as mc
from marchingcorrectors import io

H = {"smoothing_length": 0.05}


def ball():
    x = np.random.default_rng(0).random((20000, 3))
    return x, np.linalg.norm(x - 0.5, axis=1)


def count_triangles(queue):
    x, r = ball()
    queue.put(len(mc.isosurface(x, r, 0.3, **H).triangles))


def refused(kind, function, *arguments, **words):
    try:
        function(*arguments, **words)
    except kind as error:
        assert str(error) and "\n" not in str(error), error
        return str(error)
    raise AssertionError("was not refused")


def run_blocks(page):
    blocks = re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)
    scope = {}
    for text in blocks:
        if "pyvista" not in text:
            exec(text.replace("/tmp/", ""), scope)
        elif importlib.util.find_spec("pyvista"):
            exec(text.replace("Examples/", f"{page.parents[2].as_posix()}/Examples/"), scope)
            wanted = re.search(r"# (\d+) triangles", text)
            assert scope["surface"].n_cells == int(wanted[1]), scope["surface"]
            print("PyVista", scope["pyvista"].__version__)
    assert len(scope["surface"].triangles) > 1000 and os.path.getsize("ball.ply") > 10000
    return scope["surface"]


def go_through_calls():
    """Tests that names of files, callbacks and exceptions pass between Python and the library."""
    x, r = ball()
    surface = mc.isosurface(x, r, 0.3, **H)
    surface.save("ball.npz")
    assert np.array_equal(np.load("ball.npz")["points"], surface.points)
    refused(mc.Error, mc.isosurface, x[:, :2], r, 0.3, **H)
    refused(mc.Error, mc.Context, "no such device")
    seen = []
    assert len(mc.isosurface(x, r, 0.3, progress=lambda *now: seen.append(now), **H).triangles) and seen
    refused(mc.Cancelled, mc.isosurface, x, r, 0.3, progress=lambda *_: False, **H)
    refused(ZeroDivisionError, mc.isosurface, x, r, 0.3, progress=lambda *_: 1 / 0, **H)


def go_through_threads():
    x, r = ball()
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks.append(1)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    mc.isosurface(np.concatenate([x, x + 1, x + 2]), np.tile(r, 3), 0.3, **H)
    done.set()
    thread.join()
    assert ticks or time.perf_counter() - begin < 0.02
    context = multiprocessing.get_context("spawn")
    queue = context.Queue()
    child = context.Process(target=count_triangles, args=(queue,))
    child.start()
    assert queue.get(timeout=200) == len(mc.isosurface(x, r, 0.3, **H).triangles)
    child.join()


def go_through_files():
    x, _ = ball()
    table = np.zeros(len(x), [("p", ">f4", 4), ("id", ">i4")])
    table["p"][:, :3], table["id"] = x, np.arange(len(x))
    with open("fluid.bgeo", "wb") as file:
        file.write(b"BgeoV" + struct.pack(">9i", 5, len(x), 0, 0, 0, 1, 0, 0, 0) + struct.pack(">H2sHii", 2, b"id", 1, 1, 0)
                   + table.tobytes())
    with open("fluid.vtk", "wb") as file:
        file.write(b"# vtk DataFile Version 4.1\nt\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS %d float\n" % len(x)
                   + x.astype(">f4").tobytes() + b"\nCELLS 0 0\nCELL_TYPES 0\n")
    for name in ("fluid.bgeo", "fluid.vtk"):
        surface = mc.free_surface(io.read(name), volume=1 / len(x), **H)
        assert surface == mc.free_surface(x.astype(np.float32), volume=1 / len(x), **H), name
    assert os.path.isfile(os.path.join(mc.__path__[0], "MarchingCorrectorsFilter.py"))


def main():
    page = Path(sys.argv[1]).resolve()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        before = os.getcwd()
        os.chdir(folder)
        try:
            for step in (lambda: run_blocks(page), go_through_calls, go_through_threads, go_through_files):
                step()
        finally:
            os.chdir(before)  # Windows cannot remove a folder that is in use.
    print("the page's words hold")


if __name__ == "__main__":
    main()
