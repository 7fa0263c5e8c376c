# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Two dimensions by the program marching-correctors: test_plane.py PROGRAM PRELOAD."""
import math
import re

import particle_files as files
from command_line_test import ISO, CommandLineTest, main

SIDE = 20


class Plane(CommandLineTest):
    """A square of particles with the sides 2 around the origin, in y = 0.25."""

    def setUp(self):
        super().setUp()
        step = files.SPACING
        offset = (SIDE - 1) / 2
        self.points = [((i - offset) * step, 0.25, (k - offset) * step) for k in range(SIDE) for i in range(SIDE)]
        count = len(self.points)
        self.arrays = {"SmoothingLength": [1.3 * step] * count, "Mass": [1000 * step ** 2] * count,
                       "Density": [1000.0] * count, "Radius": [math.hypot(x, z) for x, _, z in self.points],
                       "Velocity": [(x, 0.0, z) for x, _, z in self.points]}
        files.write_vtp(self.input, self.points, self.arrays)

    def cells(self, kind):
        return int(re.search(f'NumberOf{kind}="(\\d+)"', self.output.read_text()).group(1))

    def test_free_surface(self):
        statistics = self.succeed("--free-surface")
        run = statistics["statistics"]
        self.assertEqual((self.cells("Lines"), self.cells("Polys")), (1, 0))
        self.assertEqual((run["dimension"], run["lines"]), (2, 1))
        self.assertAlmostEqual(run["length"], 8, delta=0.3)
        self.assertAlmostEqual(run["area"], 4, delta=0.1)
        self.assertEqual(run["lattice_cells"][1], 1)

    def test_line_of_a_scalar(self):
        result = self.extract(*ISO)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"lines +\d+ points, 1 lines; length 1\.[89]")

    def test_dimension(self):
        self.succeed("--free-surface", "--dimension", "2")
        self.assertEqual(self.cells("Lines"), 1)
        result = self.extract("--free-surface", "--iso", "0.1", "--dimension", "3")
        self.assertRegex(result.stderr, "lie in a plane")
        self.assertEqual(self.cells("Lines"), 0)
        self.output.unlink()
        files.write_vtp(self.input, *files.lattice())
        self.refuse(self.extract(*ISO, "--dimension", "2"), 1, "do not share one coordinate exactly")
        self.refuse(self.extract(*ISO, "--dimension", "4"), 2, "auto, 2 or 3|auto.*2.*3")

    def test_what_has_no_lines(self):
        stl = self.directory / "surface.stl"
        self.refuse(self.run_program(self.input, stl, "--free-surface", "--no-attributes"), 1, "cannot hold lines")
        self.refuse(self.extract(*ISO, "--components", self.directory / "surface.csv"), 1, "have lines")

    def test_particle_distance(self):
        """Of DualSPHysics, whose smoothing length is that of the dimension."""
        del self.arrays["SmoothingLength"]
        files.write_vtp(self.input, self.points, self.arrays)
        lengths = self.succeed("--free-surface", "--dp", "0.1")["statistics"]["smoothing_length_range"]
        self.assertAlmostEqual(lengths[0], 0.1 * math.sqrt(2), delta=1e-12)

    def test_derivatives(self):
        result = self.extract("--derive", "Velocity", "--scalar", "Divergence", "--iso", "1.5")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertNotIn("Lambda2", self.output.read_text())
        self.assertIn("Q-criterion", self.output.read_text())


if __name__ == "__main__":
    main()
