# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests two-dimensional particles in the program: test_plane.py PROGRAM PRELOAD."""
import csv
import math
import re

import particle_files as files
from command_line_test import ISO, CommandLineTest, column, main, read_table, says
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

SIDE = 20


class Plane(CommandLineTest):
    """Tests a square of particles with sides of 2 around the origin, in the plane y = 0.25."""

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
        self.assertRegex(self.extract_good(*ISO).stdout, r"lines +\d+ points, 1 lines; length 1\.[89]")

    def test_dimension(self):
        self.succeed("--free-surface", "--dimension", "2")
        self.extract("--free-surface", "--iso", "0.1", "--dimension", "3")
        self.assertEqual(self.cells("Lines"), 0)
        self.output.unlink()
        self.refuse(self.extract(*ISO, "--dimension", "4"), 2, "auto, 2 or 3|auto.*2.*3")

    def test_filled(self):
        run = self.succeed("--free-surface", "--filled")["statistics"]
        self.assertEqual((self.cells("Lines"), self.cells("Polys")), (1, run["triangles"]))
        self.assertIn('Name="BandValue"', self.output.read_text())
        stl = self.directory / "surface.stl"
        self.run_good(self.input, stl, "--free-surface", "--filled", "--no-attributes")
        self.assertEqual(stl.stat().st_size, 84 + 50 * run["triangles"])

    def test_columns_of_a_table(self):
        """Tables keep arrays whose names equal other columns' names or look like formulas, and integers too large for a double."""
        big = 2 ** 60 + 1
        arrays = {**self.arrays, **{name: [7.5] * len(self.points) for name in ("X", "Line", "Velocity:0", "=1+1")}}
        files.write_vtp(self.input, self.points, arrays, files.xml_array("Id", [big] * len(self.points), "Int64") +
                        files.xml_array("Code", [2 ** 64 - 1] * len(self.points), "UInt64"))
        table = self.directory / "table.csv"
        self.assertEqual(self.run_program(self.input, table, *ISO).stderr, "")
        with open(table, encoding="utf-8", newline="") as stream:
            names, *rows = csv.reader(stream)
        self.assertEqual(len(names), len(set(names)))
        for row in rows:
            row = dict(zip(names, row))
            self.assertEqual(row["Line"], "0")
            self.assertAlmostEqual(math.hypot(float(row["X"]), float(row["Z"])), float(row["Radius"]), delta=0.02)
            self.assertAlmostEqual(float(row["Velocity:0"]), float(row["X"]), delta=0.02)
            self.assertEqual([row[name] for name in ("X_", "Line_", "Velocity:0_", "'=1+1")], ["7.5"] * 4)
            self.assertEqual((row["Id"], row["Code"]), (str(big), str(2 ** 64 - 1)))

    def test_table_without_fluid(self):
        for output in ("none.csv", "none_%04d.csv"):
            self.run_good(self.input, output, *ISO, "--fluid", "Radius=99", says="empty: .* Radius = 99")
            self.assertEqual((self.directory / output.replace("%04d", "0000")).read_text(), "Line\n")

    def test_points_as_a_table(self):
        """In a table two lines stand one after the other, and a closed line ends with its first point."""
        table = self.directory / "surface.csv"
        self.run_good(self.input, table, "--scalar", "Radius", "--iso", "0.3,0.6")
        rows = read_table(table)
        self.assertEqual(set(column(rows, "Line")), {"0", "1"})
        for row in rows:
            self.assertAlmostEqual(math.hypot(float(row["X"]), float(row["Z"])), float(row["Radius"]), delta=0.02)
            self.assertEqual(float(row["Y"]), 0.25)
            self.assertAlmostEqual(float(row["Velocity:2"]), float(row["Z"]), delta=0.02)
        for line in "0", "1":
            of_line = [row for row in rows if row["Line"] == line]
            self.assertEqual(of_line[0], of_line[-1])
        # The table and the .vtp file have the same numbers, to the last bit.
        self.extract("--scalar", "Radius", "--iso", "0.3,0.6", "--gradients")
        self.run_program(self.input, table, "--scalar", "Radius", "--iso", "0.3,0.6", "--gradients")
        rows = read_table(table)
        for names, array in (("X", "Y", "Z"), "Points"), (("Radius",), "Radius"), ([f"Gradients:{a}" for a in range(3)], "Gradients"):
            values = iter(self.point_values(array))
            self.assertEqual({tuple(float(row[name]) for name in names) for row in rows}, set(zip(*[values] * len(names))))
        self.output.unlink()
        table.unlink()
        files.write_vtp(self.input, *files.lattice())
        self.refuse(self.run_program(self.input, table, *ISO), 1, "holds the points of lines")

    def point_values(self, name):
        reader = vtkXMLPolyDataReader()
        self.assertRegex(self.output.read_text(), 'compressor="vtkLZ4DataCompressor"(.|\n)*format="binary"')
        reader.SetFileName(str(self.output))
        reader.Update()
        surface = reader.GetOutput()
        return vtk_to_numpy(surface.GetPoints().GetData() if name == "Points" else surface.GetPointData().GetArray(name)).ravel().tolist()

    def test_what_is_refused(self):
        """Tests cases that are refused. The last one is refused before lines are made: one particle with a small smoothing length makes all
        squares small."""
        stl = self.directory / "surface.stl"
        self.refuse(self.run_program(self.input, stl, "--free-surface", "--no-attributes"), 1, "cannot hold lines")
        self.arrays["SmoothingLength"][0] *= 5e-4
        files.write_vtp(self.directory / "small.vtp", self.points, self.arrays)
        free = ["--free-surface", "--filled"]
        for options, source, sentence in (([*ISO, "--components", "surface.csv"], self.input, "give lines"),
                                          ([*free, "--capping", "--box=-1,1,0,1,-1,1"], self.input, says("CAPPING_WITH_FILLED", "--capping", "--filled")),
                                          (free, "small.vtp", "too many to be filled")):
            self.refuse(self.extract(*options, source=source), 1, sentence)

    def test_obj(self):
        """The lines of an .obj file lead through the points of the .csv table, in the table's order."""
        files_of = {ending: self.directory / f"lines{ending}" for ending in (".csv", ".obj")}
        for file in files_of.values():
            self.run_good(self.input, file, "--free-surface", "--no-attributes", "--quiet")
        words = [line.split() for line in files_of[".obj"].read_text().splitlines()]
        points = [tuple(map(float, row[1:])) for row in words if row[0] == "v"]
        found = [(i, *points[int(number) - 1]) for i, row in enumerate(row[1:] for row in words if row[0] == "l") for number in row]
        rows = [(int(row["Line"]), *(float(row[axis]) for axis in "XYZ")) for row in read_table(files_of[".csv"])]
        self.assertGreater(len(rows), 50)
        self.assertEqual(len(found), len(rows))
        for a, b in zip(found, rows):
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y, delta=1e-6)

    def test_particle_distance(self):
        """--dp gives DualSPHysics' smoothing length, which depends on the number of dimensions."""
        del self.arrays["SmoothingLength"]
        files.write_vtp(self.input, self.points, self.arrays)
        lengths = self.succeed("--free-surface", "--dp", "0.1")["statistics"]["smoothing_length_range"]
        self.assertAlmostEqual(lengths[0], 0.1 * math.sqrt(2), delta=1e-12)
        self.arrays["Kind"] = [int(z < -0.8) for _, _, z in self.points]  # These walls lie in another plane.
        self.points = [(x, 0.5 if z < -0.8 else y, z) for x, y, z in self.points]
        files.write_vtp(self.input, self.points, self.arrays)
        lengths = self.succeed("--free-surface", "--dp", "0.1", "--fluid", "Kind=0", "--solids",
                               "ignore")["statistics"]["smoothing_length_range"]
        self.assertAlmostEqual(lengths[0], 0.1 * math.sqrt(2), delta=1e-12)

    def test_derivatives(self):
        self.extract_good("--derive", "Velocity", "--scalar", "Divergence", "--iso", "1.5", says=".*")
        self.assertNotIn("Lambda2", self.output.read_text())
        self.assertIn("Q-criterion", self.output.read_text())
        self.output.unlink()
        self.refuse(self.extract("--derive", "Velocity", "--scalar", "Lambda2", "--iso", "-1"), 1,
                    "There is no Lambda2 in two dimensions.*use Q-criterion")


if __name__ == "__main__":
    main()
