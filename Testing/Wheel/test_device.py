# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Which device is found: the system's first, else the extra's PoCL, without a compiler or linker; what is
said where there is none; folders that cannot be written. Each case in a process of its own."""
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

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


class Test(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.compiled = tempfile.TemporaryDirectory()  # what one case compiled serves the next
        cls.addClassCleanup(cls.compiled.cleanup)

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # a second process may write yet
        self.addCleanup(self.folder.cleanup)
        (Path(self.folder.name) / "empty").mkdir()

    def run_it(self, system=True, before="", after="", device=None, second=False, **environment):
        """Lines of the output. system: with the system's drivers; second: with the second process."""
        variables = {**os.environ, **environment}
        if not second:
            variables["MCOR_COMPILER"] = ""
        if not system:
            variables["OCL_ICD_VENDORS"] = f"{self.folder.name}/empty"
            if "POCL_CACHE_DIR" not in environment:
                variables["POCL_CACHE_DIR"] = self.compiled.name
        done = subprocess.run([sys.executable, "-c", RUN.format(before=before, after=after, device=device)],
                              env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout.splitlines()

    def test_second_process(self):
        """It is started, and compiles for the extra's PoCL."""
        if (os.cpu_count() or 1) < 2:
            self.skipTest("it takes two processors")
        cache, other = Path(self.folder.name) / "pocl", Path(self.folder.name) / "other"
        *_, package, driver = self.run_it(
            system=False, second=True, POCL_CACHE_DIR=str(cache),
            after="import os; print(_library.__file__, os.environ['MCOR_OPENCL_DRIVER'], sep='\\n')")
        self.assertTrue(list(cache.glob("marching-correctors-*.ready")))
        other.mkdir()
        folder = Path(package).parent
        variables = {**os.environ, "OCL_ICD_VENDORS": f"{self.folder.name}/empty", "POCL_CACHE_DIR": str(other),
                     "MCOR_OPENCL_DRIVER": driver, "PATH": f"{folder / 'linker'}:/nonexistent"}
        with subprocess.Popen([folder / "marching-correctors-compile"], stdin=subprocess.PIPE,
                              env=variables) as process:
            process.stdin.write(b"0\n0 2 0 0\n0 1 0 mcor_march_bits\n")
            process.stdin.flush()
            for _ in range(1200):
                if list(other.rglob("mcor_march_bits.so")):
                    break
                time.sleep(0.1)
            self.assertTrue(list(other.rglob("mcor_march_bits.so")))
            process.stdin.close()

    def test_extra_where_the_system_has_none(self):
        """With no program on the PATH, above all no linker; then a system's device gives the same bits."""
        cache = f"{self.folder.name}/pocl"
        bits, name, *_ = self.run_it(system=False, PATH="/nonexistent", POCL_CACHE_DIR=cache)
        self.assertIn("Portable Computing Language", name)
        kernels = list(Path(cache).rglob("*.so"))
        self.assertGreater(len(kernels), 5)
        for kernel in kernels:  # of the wheel's linker, which writes no sections
            self.assertEqual(kernel.read_bytes()[60:62], b"\0\0", kernel)
        again = self.run_it(system=False, PATH="/nonexistent", POCL_CACHE_DIR=cache)
        self.assertEqual(bits, again[0])
        here = self.run_it()
        if here[1].startswith("Portable Computing Language"):
            self.assertEqual(bits, here[0])
            self.assertNotEqual(here[1], "DeviceError")

    def test_other_linking_is_handed_on(self):
        """Our linker stands in front of the PATH, where other programs of the process find it, too."""
        marker = Path(self.folder.name) / "bin"
        marker.mkdir()
        (marker / "ld").write_text("#!/bin/sh\necho the next one: $@\n")
        (marker / "ld").chmod(0o755)
        after = "import subprocess; print(subprocess.run(['ld', '-o', 'a', 'b.o'], stdout=-1, text=True).stdout)"
        lines = self.run_it(system=False, after=after, PATH=f"{marker}:/usr/bin:/bin")
        self.assertIn("the next one: -o a b.o", lines)

    def test_system_goes_first(self):
        lines = self.run_it(after="import os; print('linker' in os.environ['PATH'])")
        if lines[0] == "DeviceError" or "pthread-Intel(R) Xeon(R)" in lines[1] and len(lines) < 3:
            self.skipTest("no driver on this system")
        plain = subprocess.run([sys.executable, "-c",
                                "from marchingcorrectors import _library as l; l._ready_in = 0; print(l._list())"],
                               stdout=subprocess.PIPE, text=True).stdout
        if not plain.strip():
            self.skipTest("no driver on this system")
        self.assertEqual(lines[2].split(";"), [line.split(": ", 1)[1] for line in plain.strip().splitlines()])
        self.assertIn("False", lines[-1])

    def test_none(self):
        lines = self.run_it(system=False, before="_library.pocl_library = lambda: None")
        self.assertEqual(lines[0], "DeviceError")
        self.assertIn('pip install "marching-correctors[pocl]"', lines[1])
        self.assertEqual(len(lines), 3)

    def test_by_name(self):
        lines = self.run_it(system=False, device="pocl")
        self.assertIn("Portable Computing Language", lines[1])
        self.assertIn('"nonsuch"', self.run_it(system=False, device="nonsuch")[1])

    def test_extra_off_the_path(self):
        """As in ParaView, which loads the plugin's file from a folder where it looks for no package."""
        before = "import sys; sys.path = [p for p in sys.path if not p.endswith('site-packages')]"
        lines = self.run_it(system=False, before=before)
        self.assertIn("Portable Computing Language", lines[1])

    def test_home_that_cannot_be_written(self):
        """The cache then ends with the process."""
        environment = {"HOME": "/proc", "POCL_CACHE_DIR": "", "XDG_CACHE_HOME": "", "TMPDIR": self.folder.name}
        lines = self.run_it(system=False, second=True, after="import os; print(os.environ['POCL_CACHE_DIR'])",
                            **environment)
        self.assertIn("Portable Computing Language", lines[1])
        self.assertTrue(lines[-1].startswith(self.folder.name), lines)
        self.assertFalse(Path(lines[-1]).exists())


if __name__ == "__main__":
    unittest.main()
