# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Gauges by the program marching-correctors: test_gauge.py PROGRAM PRELOAD."""
import subprocess
import time
import xml.etree.ElementTree

import particle_files as files
from command_line_test import CommandLineTest, main, read_table

COLUMNS = ["time", "gauge", "state", "first", "last", "depth", "crossings", "x", "y", "z"]
UP = "mast=0,0,-1:0,0,1"


class Gauge(CommandLineTest):
    """A block of particles with the sides 1 around the origin, on gauges."""

    def setUp(self):
        super().setUp()
        self.table = self.directory / "levels.csv"

    def measure(self, *options, source=None):
        return self.run_program(source or self.input, self.table, *options)

    def rows(self):
        rows = read_table(self.table)
        self.assertEqual(list(rows[0]), COLUMNS)
        return rows

    def good(self, *options, source=None):
        self.run_good(source or self.input, self.table, *options)
        return self.rows()

    def test_what_gauges_read(self):
        rows = self.good("--gauge", UP, "--gauge=half=0,0,0:0,0,2", "--gauge", "inside=0,0,-.1:0,0,.1",
                         "--gauge", 'a "dry", one=0.8,0,-1:0.6,0,1')
        self.assertEqual([row["gauge"] for row in rows], ["mast", "half", "inside", 'a "dry", one'])
        self.assertEqual([row["state"] for row in rows], ["wet", "wet", "full", "dry"])
        self.assertEqual([row["crossings"] for row in rows], ["2", "1", "0", "0"])
        mast, half, inside, dry = rows
        level = float(mast["z"])
        self.assertAlmostEqual(level, 0.5, delta=0.05 * files.SPACING)
        self.assertAlmostEqual(float(mast["depth"]), 2 * level, delta=1e-6)
        self.assertAlmostEqual(float(mast["last"]), 1 + level, delta=1e-9)
        self.assertAlmostEqual(float(half["last"]), level, delta=1e-6)
        self.assertEqual([float(inside[name]) for name in ("first", "last", "depth", "z")], [0.2, 0.2, 0.2, 0.1])
        self.assertEqual([dry[name] for name in COLUMNS[3:]], ["", "", "0", "0", "", "", ""])

    def test_level(self):
        half, = self.good("--gauge", UP)
        row, = self.good("--gauge", UP, "--iso", "0.2")
        self.assertGreater(float(row["z"]), float(half["z"]) + 0.1 * files.SPACING)

    def test_file_of_gauges(self):
        (self.directory / "gauges.txt").write_text("# masts\n\n  one=0,0,-1:0,0,1  \ntwo=0.1,0,-1:0.1,0,1\n")
        rows = self.good("--gauge", UP, "--gauges", "gauges.txt")
        self.assertEqual([row["gauge"] for row in rows], ["mast", "one", "two"])

    def test_steps(self):
        """Several files, or those of a .pvd file, at their times."""
        self.write_rising_steps(3, 0.1)
        rows = self.good("--gauge", UP, "--gauge", "other=0.1,0,-1:0.1,0,1", source="steps.pvd")
        self.assertEqual([(float(row["time"]), row["gauge"]) for row in rows],
                         [(0.25 * i, name) for i in range(3) for name in ("mast", "other")])
        for i, row in enumerate(rows):
            self.assertAlmostEqual(float(row["z"]), 0.5 + 0.1 * (i // 2), delta=0.05 * files.SPACING)
        before = self.table.read_text()
        self.run_good("step_0.vtp", "step_1.vtp", "step_2.vtp", self.table, "--gauge", UP, "--gauge",
                      "other=0.1,0,-1:0.1,0,1", "--time-step", "0.25")
        self.assertEqual(self.table.read_text(), before)

    def test_a_table_that_grows(self):
        """Steps that were measured are in the table before the others are."""
        program = subprocess.Popen([self.program, *[self.input] * 1000, self.table, "--gauge", UP], cwd=self.directory,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        end = time.monotonic() + 300
        while not self.table.exists() and time.monotonic() < end:
            time.sleep(0.01)
        program.kill()
        program.communicate()
        text = self.table.read_text()
        self.assertTrue(text.endswith("\n"))
        times = [row["time"] for row in self.rows()]
        self.assertEqual(times, [str(i) for i in range(len(times))])
        self.assertLess(len(times), 1000)
        for part in self.directory.glob(".*"):
            part.unlink()

    def test_a_step_that_fails(self):
        """The others are in the table."""
        result = self.run_program(self.input, "missing.vtp", self.input, self.table, "--gauge", UP)
        self.one_sentence(result, 1, "missing.vtp")
        self.assertEqual([row["time"] for row in self.rows()], ["0", "2"])

    def test_grid(self):
        image = self.directory / "levels.vti"
        self.run_good(self.input, image, "--gauge-grid", "4,2:-0.6,0.3,0,0.1,-1,1")
        root = xml.etree.ElementTree.parse(image).getroot()
        self.assertEqual(root.find("ImageData").get("WholeExtent"), "0 3 0 1 0 0")
        self.assertEqual({array.get("Name") for array in root.iter("DataArray")}, {"Level", "Depth", "Crossings"})

    def test_outside(self):
        result = self.measure("--gauge", UP, "--gauge", "far=9,0,0:9,0,1")
        self.one_sentence(result, 0, "warning: .*'far' is outside of all fluid")
        self.assertEqual([row["state"] for row in self.rows()], ["wet", "dry"])

    def test_wrong_usage(self):
        self.table.write_text("as it was")
        cases = [(["--gauge", "mast=0,0,0:0,0,0"], "'mast' has no length"),
                 (["--gauge", "mast=0,0,nan:0,0,1"], "NAME=X,Y,Z:X,Y,Z, not 'mast=0,0,nan:0,0,1'"),
                 (["--gauge", "mast=0,0:0,0,1"], "needs a name and two places"),
                 (["--gauge", UP, "--gauge", UP], "two gauges have the name 'mast'"),
                 (["--gauge", UP, "--scalar", "Radius"], "leave out --scalar"),
                 (["--gauge", UP, "--iso", "0.2,0.5"], "all but one --iso value"),
                 (["--gauge", UP, "--iso", "0"], "--iso value above 0"),
                 (["--gauge", UP, "--times", "1"], "--times: 1 is outside the times of the steps, 0 to 0"),
                 (["--gauge", UP, "--solids", "wall"], "leave out --solids wall"),
                 (["--gauge", "=1+1=0,0,0:0,0,1"], "'=1.1' begins with '=', so that spreadsheets"),
                 (["--gauge-grid", "3000,3000:0,1,0,1,0,1"], "more than a million gauges, which take minutes"),
                 (["--gauge-grid", "1,1:0,1,0,1,0,1"], "the output of --gauge-grid is a .vti file")]
        for options, sentence in cases:
            self.one_sentence(self.measure(*options), 2, sentence)
        self.one_sentence(self.measure("--gauges", "none.txt"), 1, "none.txt cannot be read")
        self.one_sentence(self.measure("--gauges", "."), 1, "cannot be read")
        self.one_sentence(self.measure("--gauges", "/dev/zero"), 1, "/dev/zero is larger than 64 MiB")
        self.one_sentence(self.measure("--gauge", "far=0,0,0:0,0,1e30"), 1,
                          "Gauge 'far' needs .*e.* sample points.*; the limit is 4e.15")
        for text in ("0,1:0,1,0,1,0,1", "1.5,1:0,1,0,1,0,1", "2,2:0,1,0,1,1,0", "2,2"):
            self.one_sentence(self.run_program(self.input, "l.vti", "--gauge-grid", text), 2, "--gauge-grid needs")
        self.assertEqual(self.table.read_text(), "as it was")

    def test_table_that_cannot_be_written(self):
        self.one_sentence(self.run_program(self.input, "nowhere/levels.csv", "--gauge", UP), 1,
                          "nowhere/levels.csv could not be written")


if __name__ == "__main__":
    main()
