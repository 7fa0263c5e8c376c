# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests damaged files, at which VTK's readers may crash: test_damaged_files.py PROGRAM PRELOAD.

MCOR_MUTATIONS=N in the environment tries N damaged files (default 150), MCOR_FIRST_MUTATION=K begins
with file K (default 0). File K is the same in every run.
"""
import os
import random
import re
import shutil

import particle_files as files
from command_line_test import CommandLineTest, main

COUNT = int(os.environ.get("MCOR_MUTATIONS", "150"))
FIRST = int(os.environ.get("MCOR_FIRST_MUTATION", "0"))
NUMBERS = [b"0", b"-1", b"1", b"3", b"26", b"28", b"1000000", b"2147483647", b"2147483648",
           b"4294967295", b"100000000000", b"9223372036854775807", b"-9223372036854775808", b"1e300",
           b"nan", b""]


def mutated(data, rng):
    """Returns the data with one random change: another number or word, a lost, doubled or replaced tag or line, a changed byte, or lost bytes."""
    def replaced(match, by):
        return data[:match.start()] + by + data[match.end():]

    head = min(len(data), rng.choice([300, 600, len(data)]))
    kind = rng.randrange(6)
    if kind < 3:
        matches = list(re.finditer(rb"(?<=[\" ,\n])-?\d+" if kind < 2 else rb"[A-Za-z]+", data[:head]))
        by = rng.choice(NUMBERS) if kind < 2 else rng.choice(matches).group()
        return replaced(rng.choice(matches), by)
    if kind == 3:
        matches = list(re.finditer(rb"<[^>]*>|[^\n]*\n", data))
        match = rng.choice(matches)
        return replaced(match, rng.choice([b"", 2 * match.group(), rng.choice(matches).group()]))
    at = rng.randrange(head)
    lost = 1 if kind == 4 else rng.randrange(1, 40)
    return data[:at] + (bytes([rng.randrange(256)]) if kind == 4 else b"") + data[at + lost:]


class DamagedFiles(CommandLineTest):
    """Tests that a damaged file is read or refused: the exit status is 0 or 1, and there is at most one message."""

    def setUp(self):
        super().setUp()
        points, arrays = files.lattice(3)
        self.forms = files.all_forms(points, arrays)

    def run_with(self, name, data, extract=None):
        path = self.directory / name
        path.write_bytes(data)
        return (extract or self.extract)("--free-surface", "--quiet", source=path)

    def cannot_read(self, result, name, why):
        self.refuse(result, 1, f"^marching-correctors: .*{name} cannot be read: .*{why}")

    def test_undamaged(self):
        sizes = set()
        for name, data in self.forms.items():
            with self.subTest(name):
                self.run_with(name, data, self.extract_good)
                sizes.add(self.output.stat().st_size)
        self.assertEqual(len(sizes), 1)

    def test_mutations(self):
        names = sorted(self.forms)
        statuses = set()
        for seed in range(FIRST, FIRST + COUNT):
            rng = random.Random(seed)
            name = names[seed % len(names)]
            data = self.forms[name]
            for _ in range(rng.choice([1, 1, 1, 2, 3])):
                data = mutated(data, rng)
            with self.subTest(seed=seed, form=name):
                self.output.unlink(missing_ok=True)
                path = self.directory / ("damaged" + name)
                path.write_bytes(data)
                result = self.extract("--scalar", "Nothing", "--iso", "1", source=path, timeout=300)
                if "no point array 'Nothing'" in result.stderr:  # The file could be read, so the next run asks for a real surface.
                    result = self.extract("--free-surface", "--quiet", source=path, timeout=300)
                statuses.add(result.returncode)
                if result.returncode == 0:
                    self.assertRegex(result.stderr, r"\A(marching-correctors: warning: [^\n]*\n)*\Z")
                    self.assertTrue(self.output.read_text().rstrip().endswith("</VTKFile>"))
                else:
                    self.refuse(result, 1, "[a-z]")
        self.assertLessEqual({0, 1}, statuses)

    def test_counts_that_are_wrong(self):
        """A damaged count is refused, so that VTK's readers do not crash. No more memory is used than a file of some kilobytes can need."""
        huge = "more than a file of its size can hold; it may be damaged$"
        for name, good, bad, why in (
                ("inline.vtp", b'NumberOfPoints="27"', b'NumberOfPoints="-1"', "NumberOfPoints is -1; it may be damaged"),
                ("appended.vtu", b'NumberOfPoints="27"', b'NumberOfPoints = "-1"', "NumberOfPoints is -1; it may be damaged"),
                ("inline.vtp", b'Components="1"', b'Components="2147483647"', huge),
                ("inline.vtu", b'NumberOfPoints="27"', b'NumberOfPoints="4000000000"', huge),
                ("binary.vtk", b"POINT_DATA 27", b"POINT_DATA 2700000", "point_data is 2700000, " + huge),
                ("binary.vtk", b"Density 1 27", b"Density 2147483647 27", huge),
                ("ascii.vtk", b"POINTS 27", b"POINTS 2000000000", huge), ("ascii.vtk", b"POINTS 27", b"POINTS 26", "")):
            with self.subTest(name, bad=bad):
                self.assertIn(good, self.forms[name])
                self.cannot_read(self.run_with(name, self.forms[name].replace(good, bad)), name, why)
        data = (b"# vtk DataFile Version 3.0\ntitle 1 2 words\nASCII\nDATASET POLYDATA\nFIELD FieldData 1\nTIME 1 1 double\n0.5\n"
                b"POINTS 2 float\n0 0 0 1 0 0\nVERTICES 2 4\n1 0 1 1\n")
        self.run_with("small.vtk", data, lambda *_, source: self.run_good("--list-arrays", source))
        for name in (b"Field", b"Lines", b"Normals", b"points"):  # The arrays of a field may have any names.
            self.run_with("small.vtk", data.replace(b"TIME 1 1 double", name + b" 1 1 double"),
                          lambda *_, source: self.run_good("--list-arrays", source))
        for good, bad, why in ((b"1 double", b"1 dble", "its array 'time' has .* '1 1 dble'"), (b"1 double", b"1{ double", "'1 1{ double'"),
                               (b"1 0 1 1", b"1 0.5 1 1", "its vertices are no whole numbers"), (b"FieldData 1", b"FieldData 1x", "its FIELD"),
                               (b"VERTICES 2 4", b"VERTICES 20 40", "vertices is 40, more"), (b"POINTS 2", b"POINTS 20", "points is 20, more")):
            self.cannot_read(self.run_with("small.vtk", data.replace(good, bad)), "small.vtk", why)

    def test_crash_of_the_reader(self):
        """If VTK's XML library crashes, the program reports it and ends. Here a library that aborts, faults or recurses replaces VTK's."""
        for reader, why in (("abort", "Aborted"), ("fault", "Segmentation fault"),
                            ("recursion", "Segmentation fault")):
            with self.subTest(reader):
                result = self.extract("--free-surface", env=self.misbehaving(reader=reader))
                if result.returncode == 0:
                    self.skipTest("this VTK has an XML library of its own")
                self.refuse(result, 1, "reading .*particles.vtp failed: the program crashed there "
                            rf"\({why}\); the file may be damaged$")

    def test_crash_of_a_driver(self):
        """A driver may crash in every run, as PoCL does if a file in its cache is damaged. The error message names the cache's folder."""
        drivers, kept = self.directory / "drivers", self.directory / "kept"
        drivers.mkdir()
        kept.mkdir()
        (drivers / "mad.icd").write_text(self.preload + "\n")
        environment = {**os.environ, "OCL_ICD_VENDORS": str(drivers), "MCOR_DRIVER": "abort", "POCL_CACHE_DIR": str(kept)}
        result = self.extract("--free-surface", "--quiet", "--device", "mad", env=environment)
        self.refuse(result, 1, r"the run failed: the program crashed there \(Aborted\); the OpenCL driver may be at fault, "
                               rf"files that PoCL keeps may be damaged \(remove the folder {kept}\), or memory ran out$")
        environment.pop("MCOR_DEVICE", None)
        self.extract_good("--free-surface", env=environment)  # A run on the built-in device loads no driver.

    def test_damaged_kernels(self):
        """Files in PoCL's cache are cut off, emptied or overwritten. The run fails, and its last message names the folder or POCL_CACHE_DIR."""
        whole, kept = self.directory / "whole", self.directory / "kept"
        whole.mkdir()
        if self.extract("--free-surface", "--device", "pocl", env={**os.environ, "POCL_CACHE_DIR": str(whole)}).returncode:
            self.skipTest("there is no PoCL")
        for kind, damage in (("*.so", lambda data: data[:len(data) // 2]), ("*.so", lambda _: b""),
                             ("*.so", lambda data: b"x" * len(data)), ("*.bc", lambda data: data[:len(data) // 2]),
                             ("*.[bs][co]", lambda _: b"")):
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(whole, kept)
            damaged = list(kept.rglob(kind))
            self.assertTrue(damaged)
            for file in damaged:
                file.write_bytes(damage(file.read_bytes()))
            with self.subTest(kind):
                result = self.extract("--free-surface", "--device", "pocl", "--quiet",
                                      env={**os.environ, "POCL_CACHE_DIR": str(kept)})
                self.assertEqual(result.returncode, 1)
                self.assertRegex(result.stderr.splitlines()[-1], rf"^marching-correctors: .*(remove the folder {kept}|set POCL_CACHE_DIR)")


if __name__ == "__main__":
    main()
