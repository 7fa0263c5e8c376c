# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests which device is found: the built-in one without any driver, program or home directory; a driver's device by its name. Each case runs in its own
process. The class Whole needs a wheel with all kernels. The class Arrays tests arrays on a CUDA device, as CuPy, PyTorch and others give them.
A fake (fake_libcuda.c), which uses the host's memory, replaces CUDA's driver, so Arrays tests what the package asks of a driver, not a card."""
import ctypes
import gc
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import marchingcorrectors as mc
from test_numpy import H, V, lattice

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

# Code for `before` in RUN: prints a hash for every kernel and precision, and ends the process.
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
        """Runs RUN, and returns the lines that it prints. system: whether the system's drivers are found. before, after: more code in RUN."""
        variables = {**os.environ, **environment}
        if not system:
            variables["OCL_ICD_VENDORS"] = self.folder.name  # There is no driver in this folder.
        done = subprocess.run([sys.executable, "-c", RUN.format(before=before, after=after, device=device)],
                              env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout.splitlines()


class Whole(Case):
    def test_all_kernels_are_built_in(self):
        """The built-in device has all kernels and gives the same bits as PoCL."""
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
        """The package works if its folder is not on Python's path, as in ParaView, which loads the plugin by the name of its file."""
        before = "import sys; sys.path = [p for p in sys.path if not p.endswith('site-packages')]"
        self.assertIn("built in: this CPU", self.run_it(system=False, before=before)[1])


POSITIONS, DISTANCE = lattice(np.float32)


class OnCuda:
    """An array that has the interface of CuPy's arrays. Like them, it does not become a NumPy array by itself."""

    def __init__(self, array, strides=False, stream=None):
        self.array, self.shape, self.ndim = array, array.shape, array.ndim
        self.__cuda_array_interface__ = {
            "shape": array.shape, "typestr": array.dtype.str, "data": (array.ctypes.data, False), "version": 3,
            "strides": array.strides if strides else None, "stream": stream}

    def __len__(self):
        return len(self.array)

    def __array__(self, *_, **__):
        raise TypeError("Implicit conversion to a NumPy array is not allowed.")


class OnlyDlpack:
    """An array that has only DLPack's methods and says that it is on a CUDA device. The tensor in its capsule, which NumPy makes, is in
    fact on the host."""

    def __init__(self, array):
        self.array, self.streams = array, []

    def __len__(self):
        return len(self.array)

    def __dlpack_device__(self):
        return (2, 0)

    def __dlpack__(self, *, stream=None):
        self.streams.append(stream)
        return self.array.__dlpack__()


class Hidden:
    """An array that raises an error, as PyTorch's tensors do while they need a gradient."""

    @property
    def __cuda_array_interface__(self):
        raise RuntimeError("Can't get __cuda_array_interface__ on Variable that requires grad.")


def sphere(wrap=lambda array: array, **more):
    words = {"smoothing_length": np.full(len(POSITIONS), H, "f4"), "volume": np.full(len(POSITIONS), V), "attributes": {"a": 2 * POSITIONS},
             "solid": np.zeros(len(POSITIONS), bool), **more}
    words = {name: {"a": wrap(array["a"])} if name == "attributes" else wrap(array) for name, array in words.items()}
    return mc.isosurface(wrap(POSITIONS), wrap(DISTANCE), 0.4, **words)


class Arrays(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            ctypes.CDLL("libcuda.so.1")
        except OSError:
            pass
        else:
            raise unittest.SkipTest("there is a driver of CUDA, in place of which no fake can be loaded")
        with cls().assertRaisesRegex(mc.DeviceError, "scalar is on a CUDA device, but CUDA's driver cannot be used: .*Copy it to the host first"):
            mc.isosurface(POSITIONS, OnCuda(DISTANCE), 0.4, smoothing_length=H, volume=V)
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        path = os.path.join(folder.name, "libcuda.so.1")
        subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-o", path, "-Wl,-soname,libcuda.so.1",
                        str(Path(__file__).with_name("fake_libcuda.c"))], check=True)
        cls.fake = ctypes.CDLL(path)  # The loader then finds it by this name.
        cls.expected = sphere()

    def number(self, name):
        return ctypes.c_int.in_dll(self.fake, "fake_" + name)

    def copied(self, function):
        """Calls the function. Returns its result, the number of copies that it caused, and their bytes."""
        bytes_of = ctypes.c_size_t.in_dll(self.fake, "fake_bytes")
        copies, before = self.number("copies").value, bytes_of.value
        result = function()
        return result, self.number("copies").value - copies, bytes_of.value - before

    def test_every_array(self):
        """Each array is copied once and whole. A second surface locks no more memory."""
        found, copies, size = self.copied(lambda: sphere(OnCuda))
        self.assertEqual(found, self.expected)
        self.assertEqual(copies, 6)
        self.assertEqual(size, len(POSITIONS) * (12 + 4 + 4 + 8 + 12 + 1))  # positions, scalar, h, volume, attribute, marks
        gc.collect()
        locks = self.number("locks").value
        self.assertTrue(0 < locks <= 6)
        self.assertEqual(sphere(OnCuda), self.expected)
        gc.collect()
        self.assertEqual(self.number("locks").value, locks)

    def test_dlpack(self):
        made = []
        found, copies, _ = self.copied(lambda: sphere(lambda array: made.append(OnlyDlpack(array)) or made[-1]))
        self.assertEqual(found, self.expected)
        self.assertEqual((copies, [one.streams for one in made]), (6, [[1]] * 6))
        column, words = OnlyDlpack(np.stack([DISTANCE, POSITIONS[:, 0]], axis=1)[:, 0]), {"smoothing_length": H, "volume": V}
        self.assertEqual(mc.isosurface(POSITIONS, column, 0.4, **words), mc.isosurface(POSITIONS, DISTANCE, 0.4, **words))

    def test_strides(self):
        """Columns of a table, and reversed and transposed arrays, give the same result as on the host."""
        table = np.concatenate([DISTANCE[:, None], POSITIONS, POSITIONS[:, :1]], axis=1)
        words = {"smoothing_length": H, "volume": V}
        found = mc.isosurface(OnCuda(table[:, 1:4], True), OnCuda(table[:, 0], True), 0.4, **words)
        self.assertEqual(found, mc.isosurface(POSITIONS, DISTANCE, 0.4, **words))
        found = mc.isosurface(OnCuda(np.asfortranarray(POSITIONS)[::-1], True), OnCuda(DISTANCE[::-1], True), 0.4, **words)
        self.assertEqual(found, mc.isosurface(POSITIONS[::-1], DISTANCE[::-1], 0.4, **words))

    def test_streams_pools_and_nothing(self):
        """The package waits for the array's stream. Memory of a pool, which belongs to no context, works. Arrays without particles are not
        copied."""
        sphere(lambda array: OnCuda(array, stream=7))
        self.assertEqual(self.number("synchronized").value, 7)
        self.number("of_pool").value = 1
        self.addCleanup(setattr, self.number("of_pool"), "value", 0)
        self.assertEqual(sphere(OnCuda), self.expected)
        found, copies, _ = self.copied(lambda: mc.isosurface(OnCuda(POSITIONS[:0]), OnCuda(DISTANCE[:0]), 0.4, smoothing_length=H))
        self.assertEqual((len(found.points), copies), (0, 0))

    def test_refused(self):
        words = {"smoothing_length": H, "volume": V}
        with self.assertRaisesRegex(mc.InvalidArgument, "does not hold numbers, but"):
            mc.isosurface(POSITIONS, OnCuda(DISTANCE.view("V4")), 0.4, **words)
        with self.assertRaisesRegex(mc.InvalidArgument, "scalar is not an array .* requires grad"):
            mc.isosurface(POSITIONS, Hidden(), 0.4, **words)
        self.number("fails").value = 1
        self.addCleanup(setattr, self.number("fails"), "value", 0)
        with self.assertRaisesRegex(mc.DeviceError, r"cuPointerGetAttribute failed: invalid argument \(1\)"):
            mc.isosurface(POSITIONS, OnCuda(DISTANCE), 0.4, **words)


if __name__ == "__main__":
    unittest.main()
