# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What particles lack: volumes, smoothing lengths, densities. test_volumes.py PROGRAM PRELOAD"""
import csv
import math

import particle_files as files
from command_line_test import CommandLineTest, main

DX = files.SPACING


def shape(q):
    """Of the cubic spline, whose norm is 1 / pi."""
    return 1 - 1.5 * q * q + 0.75 * q ** 3 if q < 1 else 0.25 * (2 - q) ** 3 if q < 2 else 0.0


class Volumes(CommandLineTest):
    """A block of 10 x 10 x 10 particles around the origin, half a spacing beyond which its surface is."""

    def level(self, *options, arrays=(), points=None):
        """In spacings above the uppermost particles, and what was said of volumes."""
        given = points or self.points
        files.write_vtp(self.input, given, {name: self.arrays[name][:len(given)] for name in arrays})
        table = self.directory / "levels.csv"
        result = self.run_program(self.input, table, "--gauge", "up=0.02,0,-.1:0.02,0,1", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        with table.open() as file:
            row, = csv.DictReader(file)
        return float(row["z"]) / DX - 4.5, result.stdout

    def test_still_water(self):
        """Whatever tells volumes; gauges say what did."""
        for options, arrays, told in (
                (("--smoothing-length", "0.13"), (), "computed from the positions"),
                (("--smoothing-length", "0.13"), ("Mass",), "array Mass / density summed from it"),
                (("--smoothing-length", "0.13"), ("Mass", "Density"), "array Mass / array Density"),
                (("--dp", "0.1"), (), "0.001"), (("--dp", "0.1"), ("Mass",), "0.001"), (("--dp", "0.1"), ("Density",), "0.001"),
                (("--dp", "0.1"), ("Mass", "Density"), "array Mass / array Density"),
                (("--dp", "0.1", "--mass", "1"), ("Density",), "1 / array Density")):
            with self.subTest(options, arrays=arrays):
                level, said = self.level(*options, arrays=arrays)
                self.assertAlmostEqual(level, 0.5, delta=0.05)
                self.assertEqual(said, f"1 gauge, 1 step; volumes: {told}\n")

    def test_still_water_of_a_plane(self):
        plane = [(x, 0.0, z) for x, y, z in self.points if y > 4.4 * DX]
        for options, told in ((("--smoothing-length", "0.13"), "computed from the positions"), (("--dp", "0.1"), "0.01")):
            level, said = self.level(*options, points=plane)
            self.assertAlmostEqual(level, 0.5, delta=0.05)
            self.assertEqual(said, f"1 gauge, 1 step; volumes: {told}\n")

    def test_statistics_tell_the_volume(self):
        files.write_vtp(self.input, self.points, {})
        self.assertAlmostEqual(self.succeed("--free-surface", "--dp", "0.1")["parameters"]["particle_volume"], 0.001)

    def lengths(self, ratio):
        """By halving, of all pairs."""
        apart = [[math.dist(a, b) for b in self.points] for a in self.points]
        found = []
        for distances in apart:
            low, high = 0.01, 1.0
            while high - low > 1e-7:
                h = 0.5 * (low + high)
                low, high = (h, high) if sum(shape(r / h) for r in distances) / math.pi < ratio ** 3 else (low, h)
            found.append(low)
        return apart, found

    def test_smoothing_lengths_by_neighbours(self):
        self.points = self.points[:250]
        files.write_vtp(self.input, self.points, {})
        for word, ratio in (("neighbours", 1.3), ("neighbours=1.1", 1.1), ("neighbors", 1.3)):
            with self.subTest(word):
                low, high = self.succeed("--free-surface", "--smoothing-length", word)["statistics"]["smoothing_length_range"]
                lengths = self.lengths(ratio)[1]
                self.assertAlmostEqual(low, min(lengths), delta=1e-5 * low)
                self.assertAlmostEqual(high, max(lengths), delta=1e-5 * high)
        self.output.unlink()
        self.refuse(self.extract("--free-surface", "--smoothing-length", "neighbours=0"), 2, "--smoothing-length")
        self.refuse(self.extract("--free-surface", "--smoothing-length", "neighbours=0.5"), 1, "ETA is 0.5; it must be above 0.683")

    def test_summed_densities(self):
        """Asked for, and not there."""
        self.points = self.points[:250]
        masses = [1.0 + i % 3 for i in range(250)]
        files.write_vtp(self.input, self.points, {"Mass": masses})
        apart, lengths = self.lengths(1.3)
        expected = [sum(m * shape(r / h) for m, r in zip(masses, distances)) / (math.pi * h ** 3)
                    for distances, h in zip(apart, lengths)]
        found = self.succeed("--scalar", "Density", "--iso", str(sum(expected) / 250), "--field", "sum",
                             "--smoothing-length", "neighbours", "--node-threshold", "0")
        low, high = found["statistics"]["scalar_range"]
        self.assertAlmostEqual(low, min(expected), delta=1e-4 * low)
        self.assertAlmostEqual(high, max(expected), delta=1e-4 * high)
        self.assertGreater(found["statistics"]["triangles"], 100)


if __name__ == "__main__":
    main()
