# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests which device is found: the built-in one without any driver, program or home; a driver's device by name. Each case runs in its own process.
With "whole" the wheel has all kernels."""
import os
import subprocess
import sys
import tempfile
import unittest

RUN = """
import numpy as np, marchingcorrectors as mc
from marchingcorrectors import _library
g = np.stack(np.meshgrid(*[np.arange(9.0)] * 3), -1).reshape(-1, 3)
{before}
try:
    s = mc.isosurface(g, np.linalg.norm(g - 4, axis=1), iso=2.5, smoothing_length=1.3, volume=1.0, device={device!r})
    import hashlib
    print(hashlib.sha256(s.points.tobytes() + s.triangles.tobytes() + s.normals.tobytes()).hexdigest())
    print(s.statistics["platform"], s.statistics["device"])
except mc.Error as error:
    print(type(error).__name__)
    print(error)
print(*mc.devices(), sep=";")
{after}
"""

# This replaces the function `run` in RUN.
ALL = """
import hashlib
from marchingcorrectors._options import words_of
for kernel in words_of("sph_kernel"):
    for precision in ("single", "double"):
        s = mc.isosurface(g, np.linalg.norm(g - 4, axis=1), iso=2.5, smoothing_length=1.3, volume=1.0, device={device!r},
                          sph_kernel=kernel, precision=precision, gradients=True, boundary_detection="eigenvalue")
        arrays = s.points, s.triangles, s.normals, s.gradients
        print(kernel, precision, hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest())
raise SystemExit
"""


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.addCleanup(self.folder.cleanup)

    def run_it(self, system=True, before="", after="", device=None, **environment):
        """Returns the lines of the output. system: whether the system's drivers are found."""
        variables = {**os.environ, **environment}
        if not system:
            variables["OCL_ICD_VENDORS"] = self.folder.name  # There is no driver in this folder.
        done = subprocess.run([sys.executable, "-c", RUN.format(before=before, after=after, device=device)],
                              env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout.splitlines()


class Whole(Case):
    def test_all_kernels_are_built_in(self):
        """The built-in device gives PoCL's bits."""
        built, here = self.run_it(system=False, before=ALL.format(device=None)), self.run_it(device="pocl")
        self.assertEqual(len(set(built)), 18)
        if here[0] != "DeviceError":
            self.assertEqual(self.run_it(before=ALL.format(device="pocl")), built)


class Usual(Case):
    def test_no_driver_program_or_home(self):
        bits, name, devices = self.run_it(system=False, PATH="/nonexistent", HOME="/nonexistent", XDG_CACHE_HOME="")
        self.assertIn("built in: this CPU", name)
        self.assertEqual(len(devices.split(";")), 1)
        here = self.run_it(device="pocl")
        if here[0] != "DeviceError":
            self.assertIn("Portable Computing Language", here[1])
            self.assertEqual(bits, here[0])

    def test_by_name(self):
        self.assertIn("built in: this CPU", self.run_it(device="built in")[1])
        error, sentence, _ = self.run_it(system=False, device="nonsuch")
        self.assertEqual(error, "DeviceError")
        self.assertIn('"nonsuch"', sentence)
        self.assertIn("built in: this CPU", sentence)

    def test_off_the_path(self):
        """ParaView loads the plugin's file from a folder where Python does not look for packages."""
        before = "import sys; sys.path = [p for p in sys.path if not p.endswith('site-packages')]"
        self.assertIn("built in: this CPU", self.run_it(system=False, before=before)[1])


if __name__ == "__main__":
    unittest.main()
