# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program marching-correctors for its tests."""
import csv
import ctypes
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import particle_files as files

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from says import says  # noqa: E402, F401

ISO = ["--scalar", "Radius", "--iso", "0.3"]
FIRST_COMPILATION = ("marching-correctors: the OpenCL driver compiles its programs for the first time, which may take a "
                     "minute\n")
WITH_DISPLAY = pathlib.Path(__file__).resolve().parent.parent / "with-display.sh"


def drop_privileges():
    """Drops root's rights in a new process (as preexec_fn), so that file permissions count. The user stays root, because another user
    may not reach the build tree."""
    if os.geteuid() == 0:
        libc = ctypes.CDLL(None)
        for capability in range(64):
            libc.prctl(24, capability, 0, 0, 0)  # This is PR_CAPBSET_DROP; exec then gives the dropped capabilities to nobody.


def read_table(path):
    """Returns the rows of a table, each a dictionary from column name to text."""
    with open(path, encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def column(rows, name):
    return [row[name] for row in rows]


class CommandLineTest(unittest.TestCase):
    """Runs the program in a temporary directory of each test's own, which holds a small good input."""

    program = ""
    preload = ""  # This is the library made of misbehave.c.

    def setUp(self):
        self.directory = pathlib.Path(tempfile.mkdtemp(prefix="mcor-cli-")).resolve()
        self.addCleanup(shutil.rmtree, self.directory)
        self.input = self.directory / "particles.vtp"
        self.output = self.directory / "surface.vtp"
        self.points, self.arrays = files.lattice()
        files.write_vtp(self.input, self.points, self.arrays)

    def tearDown(self):
        """Fails if any run has left a temporary file or a core dump."""
        self.assertEqual([p for p in self.directory.rglob("*") if p.name.startswith((".", "core"))], [])

    def run_program(self, *arguments, told=False, display=False, **options):
        """Runs the program and returns the result. Unless `told` is true, stderr lacks the line about a driver's first compilation, which
        may appear in any test."""
        defaults = {"cwd": self.directory, "stdin": subprocess.DEVNULL, "capture_output": True,
                    "text": True, "timeout": 1200}
        result = subprocess.run([*[WITH_DISPLAY] * display, self.program, *map(os.fspath, arguments)], **{**defaults, **options})
        if not told and isinstance(result.stderr, str):
            result.stderr = result.stderr.replace(FIRST_COMPILATION, "")
        return result

    def extract(self, *options, source=None, **run_options):
        return self.run_program(source or self.input, self.output, *options, **run_options)

    def run_good(self, *arguments, says="^$", **options):
        """Runs the program, which must succeed. Its stderr must match `says`, by default nothing."""
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, says)
        return result

    def extract_good(self, *options, source=None, **run_options):
        return self.run_good(source or self.input, self.output, *options, **run_options)

    def succeed(self, *options, source=None, told=""):
        """Runs the program, which must succeed, and returns its statistics. Its stderr must match `told`, or be empty."""
        statistics = self.directory / "statistics.json"
        self.said = self.extract_good(*options, "--stats", statistics, source=source, says=told or "^$").stderr
        self.assertIn("</VTKFile>", self.output.read_text())
        return json.loads(statistics.read_text())

    def refuse(self, result, status, sentence):
        """Checks that the run failed with this status, wrote one line to stderr, which matches `sentence`, and left no
        output file."""
        self.one_sentence(result, status, sentence)
        left = [p.name for p in self.directory.iterdir() if p.name.startswith("surface")]
        self.assertEqual(left, [])

    def one_sentence(self, result, status, sentence):
        self.assertRegex(result.stderr, sentence)
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertTrue(result.stderr.startswith("marching-correctors: "), result.stderr)
        self.assertNotRegex(result.stderr, r"ERROR|\(0x|\.cxx|\.c:")

    def refuse_all(self, status, cases, *common, source=None):
        """Tests that runs are refused with this status. cases: pairs of a run's options and the sentence that its error must match."""
        for options, sentence in cases:
            with self.subTest(options):
                self.refuse(self.extract(*common, *options, source=source), status, sentence)

    def write_rising_steps(self, count, up, step=0.25, points=None, **arrays):
        """Writes step_0.vtp, ... and steps.pvd, which lists these files. The points (by default self.points) rise by `up` from step
        to step."""
        points, arrays = points or self.points, {**self.arrays, **arrays}
        for i in range(count):
            files.write_vtp(self.directory / f"step_{i}.vtp", [(x, y, z + up * i) for x, y, z in points], arrays)
        files.write_pvd(self.directory / "steps.pvd", [(step * i, f"step_{i}.vtp") for i in range(count)])

    def chosen(self, keep):
        """Returns the points and the arrays of the particles i for which keep(i) is true."""
        picked = list(filter(keep, range(len(self.points))))
        return [self.points[i] for i in picked], {name: [values[i] for i in picked] for name, values in self.arrays.items()}

    def in_plane(self):
        """Returns the points and the arrays of the lowest layer of particles."""
        return self.chosen(lambda i: self.points[i][2] == self.points[0][2])

    def listed(self, name):
        """Returns [(time, path)] as a .pvd file lists them."""
        root = xml.etree.ElementTree.parse(self.directory / name).getroot()
        self.assertEqual(root.get("type"), "Collection")
        return [(float(e.get("timestep")), self.directory / e.get("file")) for e in root.iter("DataSet")]

    def misbehaving(self, **variables):
        """Returns the environment for a run with misbehave.c. Each keyword name=value sets the variable MCOR_NAME of misbehave.c."""
        named = {"MCOR_" + name.upper(): str(value) for name, value in variables.items()}
        return {**os.environ, "LD_PRELOAD": self.preload,
                "MCOR_FAILING_FOLDER": str(self.directory), **named}


def main(display=False):
    """Runs the tests of a file that is called as TEST.py PROGRAM PRELOAD [unittest arguments]. display: whether to start a
    display for all pictures, if there is none."""
    if display and not os.environ.get("DISPLAY"):
        os.execv(WITH_DISPLAY, [WITH_DISPLAY, sys.executable, *sys.argv])
    CommandLineTest.program = os.path.abspath(sys.argv.pop(1))
    CommandLineTest.preload = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
