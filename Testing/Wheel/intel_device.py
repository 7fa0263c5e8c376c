# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a surface on Intel's OpenCL driver with the built-in device's. test_systems.py runs it under wine."""
import warnings

import numpy as np

import marchingcorrectors as mc

warnings.simplefilter("ignore")
x = np.random.default_rng(34).random((5000, 3))
devices = mc.devices()
assert any("Intel(R) OpenCL" in str(device) for device in devices), devices
ours = mc.isosurface(x, x[:, 0], 0.5, smoothing_length=0.08, device="built in")
theirs = mc.isosurface(x, x[:, 0], 0.5, smoothing_length=0.08, device="intel")
assert "built in" not in theirs.statistics["device"], theirs.statistics["device"]
assert ours == theirs and len(ours.triangles) > 300
print("Intel's runtime: the same")
