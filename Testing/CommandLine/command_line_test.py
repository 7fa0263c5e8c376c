# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs of the program marching-correctors, for its tests."""
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

import particle_files as files

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from says import says  # noqa: E402, F401

ISO = ["--scalar", "Radius", "--iso", "0.3"]
FIRST_COMPILATION = ("marching-correctors: the OpenCL driver compiles its programs for the first time, which may take a "
                     "minute\n")
WITH_DISPLAY = pathlib.Path(__file__).resolve().parent.parent / "with-display.sh"


def drop_privileges():
    """For preexec_fn: root keeps its number but none of its powers, so that the files' modes count.
    Another user's number would not do: it may not reach the build tree."""
    if os.geteuid() == 0:
        libc = ctypes.CDLL(None)
        for capability in range(64):
            libc.prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP, which exec then goes by


def read_table(path):
    """Rows by the names of their columns."""
    with open(path, encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


class CommandLineTest(unittest.TestCase):
    """Runs the program in a directory of its own, with a small good input beside it."""

    program = ""
    preload = ""  # misbehave.c

    def setUp(self):
        self.directory = pathlib.Path(tempfile.mkdtemp(prefix="mcor-cli-")).resolve()
        self.addCleanup(shutil.rmtree, self.directory)
        self.input = self.directory / "particles.vtp"
        self.output = self.directory / "surface.vtp"
        self.points, self.arrays = files.lattice()
        files.write_vtp(self.input, self.points, self.arrays)

    def tearDown(self):
        """No temporary file is left, whatever happened."""
        self.assertEqual([p for p in self.directory.rglob("*") if p.name.startswith((".", "core"))], [])

    def run_program(self, *arguments, told=False, display=False, **options):
        """Unless `told`, without the sentence about a driver's first compilation, which any test may cause."""
        defaults = {"cwd": self.directory, "stdin": subprocess.DEVNULL, "capture_output": True,
                    "text": True, "timeout": 1200}
        result = subprocess.run([*[WITH_DISPLAY] * display, self.program, *map(os.fspath, arguments)], **{**defaults, **options})
        if not told and isinstance(result.stderr, str):
            result.stderr = result.stderr.replace(FIRST_COMPILATION, "")
        return result

    def extract(self, *options, source=None, **run_options):
        return self.run_program(source or self.input, self.output, *options, **run_options)

    def run_good(self, *arguments, says="^$", **options):
        """Runs the program, which must succeed, and say what matches on stderr, or nothing."""
        result = self.run_program(*arguments, **options)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, says)
        return result

    def extract_good(self, *options, source=None, **run_options):
        return self.run_good(source or self.input, self.output, *options, **run_options)

    def succeed(self, *options, source=None, told=""):
        """Runs the program, which must succeed, and say what matches on stderr, or nothing; returns its statistics."""
        statistics = self.directory / "statistics.json"
        self.said = self.extract_good(*options, "--stats", statistics, source=source, says=told or "^$").stderr
        self.assertIn("</VTKFile>", self.output.read_text())
        return json.loads(statistics.read_text())

    def refuse(self, result, status, sentence):
        """One line on stderr that matches, nothing else, and no output file of any kind."""
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
        """cases: ([options], sentence) each."""
        for options, sentence in cases:
            with self.subTest(options):
                self.refuse(self.extract(*common, *options, source=source), status, sentence)

    def write_rising_steps(self, count, up, step=0.25, points=None, **arrays):
        """step_0.vtp, ... and steps.pvd, which lists them: the block, or these points, higher by `up` in each."""
        points, arrays = points or self.points, {**self.arrays, **arrays}
        for i in range(count):
            files.write_vtp(self.directory / f"step_{i}.vtp", [(x, y, z + up * i) for x, y, z in points], arrays)
        files.write_pvd(self.directory / "steps.pvd", [(step * i, f"step_{i}.vtp") for i in range(count)])

    def misbehaving(self, **variables):
        """The environment for a run with misbehave.c, and its variables MCOR_..."""
        named = {"MCOR_" + name.upper(): str(value) for name, value in variables.items()}
        return {**os.environ, "LD_PRELOAD": self.preload,
                "MCOR_FAILING_FOLDER": str(self.directory), **named}


def main():
    """TEST.py PROGRAM PRELOAD [unittest arguments]"""
    CommandLineTest.program = os.path.abspath(sys.argv.pop(1))
    CommandLineTest.preload = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
