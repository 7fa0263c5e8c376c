# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Particles that lack volumes, smoothing lengths, densities. test_volumes.py PROGRAM PRELOAD"""
import particle_files as files
from command_line_test import CommandLineTest, main, read_table

DX = files.SPACING


class Volumes(CommandLineTest):
    """A block of 10 x 10 x 10 particles around the origin, half a spacing beyond which its surface is."""

    def level(self, *options, arrays=(), points=None):
        """In spacings above the uppermost particles, and what was said of volumes."""
        given = points or self.points
        files.write_vtp(self.input, given, {name: self.arrays[name][:len(given)] for name in arrays})
        table = self.directory / "levels.csv"
        result = self.run_good(self.input, table, "--gauge", "up=0.02,0,-.1:0.02,0,1", *options, says=".*")
        row, = read_table(table)
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

    def test_smoothing_lengths_by_neighbours(self):
        files.write_vtp(self.input, self.points, {"Mass": [1.0] * len(self.points)})
        ranges = {word: self.succeed("--free-surface", "--smoothing-length", word)["statistics"]["smoothing_length_range"]
                  for word in ("neighbours", "neighbors", "neighbours=1.3", "neighbours=1.1")}
        self.assertEqual(len(set(map(tuple, ranges.values()))), 2)
        low, high = ranges["neighbours"]
        self.assertAlmostEqual(low, 1.3 * DX, delta=0.03 * DX)  # inside
        self.assertGreater(high, 1.2 * low)  # at corners
        self.assertLess(ranges["neighbours=1.1"][0], 0.9 * low)
        summed = self.succeed("--scalar", "Density", "--iso", "900", "--field", "sum", "--smoothing-length", "neighbours")
        self.assertAlmostEqual(summed["statistics"]["scalar_range"][1], 1000, delta=50)  # where it is not there
        self.output.unlink()
        free = "--free-surface", "--smoothing-length"
        self.refuse_all(2, [(["neighbours=0"], "--smoothing-length")], *free)
        self.refuse_all(1, [(["neighbours=0.5"], "ETA is 0.5; it must be above 0.683")], *free)


if __name__ == "__main__":
    main()
