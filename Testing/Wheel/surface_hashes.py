# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the SHA-256 sums of results, one per line. The sums must be the same on every system, because the script uses NumPy alone, and operations
that round alike everywhere. The sums must also be the same on DEVICE as on the built-in device.

    surface_hashes.py [DEVICE]
"""
import hashlib
import os
import sys
import tempfile
import time
import warnings

begin = time.monotonic()
import numpy as np  # noqa: E402  (the time of imports counts)

import marchingcorrectors as mc  # noqa: E402


def show(name, *arrays):
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    print(name, len(arrays[0]), digest.hexdigest(), flush=True)


warnings.simplefilter("ignore")
x = np.random.default_rng(34).random((20000, 3))
d = x - 0.5
radius = np.sqrt(d[:, 0] * d[:, 0] + d[:, 1] * d[:, 1] + d[:, 2] * d[:, 2])
words = {"smoothing_length": 0.05, "volume": 1 / len(x)}
for kernel in ("cubic", "quintic", "wendland", "mprime4", "quadratic"):
    surface = mc.isosurface(x, radius, 0.3, sph_kernel=kernel, **words)
    if kernel == "cubic":
        print(f"import and first surface: {time.monotonic() - begin:.1f} s", file=sys.stderr)
    show(kernel, surface.points, surface.triangles, surface.normals)
surface = mc.isosurface(x.astype(np.float32), radius.astype(np.float32), [0.2, 0.4], attributes={"r": radius}, **words)
show("values", surface.points, surface.triangles, surface.attributes["r"])
surface = mc.isosurface(x, radius, 0.3, estimate_smoothing_length=True)
show("estimated", surface.points, surface.triangles)
surface = mc.free_surface(x, **words)
show("free", surface.points, surface.triangles)
samples = mc.probe(x, x[:1000], attributes={"r": radius}, **words)
show("probe", samples.values["r"], samples.weight_sum)
gauges = mc.gauge(x, {"a": ([0.5, 0.4, -1], [0.5, 0.4, 2]), "b": ([0.1, 0.2, 0.5], [1.5, 1.3, 0.7])}, 0.3, **words)
show("gauges", gauges.last, gauges.depth, gauges.place, *gauges.crossings.values())

with tempfile.TemporaryDirectory() as folder:  # No code page with one byte per character has these names.
    folder = os.path.join(folder, "été 測試")
    os.mkdir(folder)
    name = os.path.join(folder, "surface 測.ply")
    surface.save(name)
    with open(name, "rb") as file:
        show("ply", np.frombuffer(file.read(), np.uint8))
print(mc.devices(), file=sys.stderr)
for device in sys.argv[1:]:
    ours, theirs = (mc.isosurface(x[:5000], x[:5000, 0], 0.5, smoothing_length=0.08, device=each) for each in ("built in", device))
    assert "built in" not in theirs.statistics["device"] and ours == theirs and len(ours.triangles) > 300, theirs.statistics["device"]
