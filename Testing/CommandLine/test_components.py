# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests --components of the program, a table of a surface's pieces: test_components.py PROGRAM PRELOAD."""
import particle_files as files
from command_line_test import CommandLineTest, column, main, read_table

COLUMNS = ("component iso parent closed area volume x y z xmin xmax ymin ymax zmin zmax diameter particles mass "
           "vx vy vz").split()
FREE = ["--free-surface"]


class Components(CommandLineTest):
    """Tests pieces of two blocks of particles: one with sides of 1 around the origin, one with sides of 0.5 around (2,
    0, 0)."""

    def setUp(self):
        super().setUp()
        points, arrays = files.lattice(5)
        self.all_points = self.points + [(x + 2, y, z) for x, y, z in points]
        self.all_arrays = {name: values + arrays[name] for name, values in self.arrays.items()}
        self.all_arrays["Velocity"] = [(1.0, 2.0, 3.0)] * 1000 + [(4.0, 5.0, 6.0)] * 125
        files.write_vtp(self.input, self.all_points, self.all_arrays)
        self.table = self.directory / "pieces.csv"

    def pieces(self, *options):
        self.extract_good(*FREE, "--components", self.table, *options)
        return self.rows(COLUMNS)

    def rows(self, columns):
        rows = read_table(self.table)
        self.assertEqual(list(rows[0]), columns)
        return rows

    def test_two_blocks(self):
        large, small = self.pieces()
        self.assertEqual([large["component"], small["component"]], ["0", "1"])
        self.assertEqual([large["parent"], large["closed"], small["closed"]], ["-1", "1", "1"])
        for row, side in ((large, 1.0), (small, 0.5)):
            self.assertAlmostEqual(float(row["volume"]), side ** 3, delta=0.1 * side ** 2)
        # The 8 particles at the corners of each block are not counted. They lie outside the surface, because less than
        # half of the space around them is filled.
        self.assertEqual([large["particles"], small["particles"]], ["992", "117"])
        self.assertAlmostEqual(float(large["mass"]), 992, delta=1e-6)
        self.assertEqual([round(float(small[v]), 9) for v in ("vx", "vy", "vz")], [4, 5, 6])
        text = self.output.read_text()
        self.assertEqual([text.count(f'Name="{name}"') for name in ("ComponentId", "ComponentVolume")], [2, 1])

    def test_small_pieces_are_left_out(self):
        whole = len(self.pieces())
        before = self.output.read_bytes()
        for option in (["--least-volume", "0.3"], ["--least-particles", "118"]):
            row, = self.pieces(*option)
            self.assertEqual((whole, row["component"], row["particles"]), (2, "0", "992"))
            self.assertLess(len(self.output.read_bytes()), len(before))
        self.assertEqual(len(self.pieces("--least-particles", "117", "--least-volume", "0.05")), 2)
        self.assertEqual(self.output.read_bytes(), before)
        told = self.run_good(self.input, self.output, "--free-surface", "--components", self.table, "--least-volume", "99", says=".*").stderr
        self.assertRegex(told, "empty: --least-volume")

    def test_film(self):
        """Several files give one table with a column of times."""
        files.write_vtp(self.directory / "later.vtp", self.points, self.arrays)
        self.run_good(self.input, "later.vtp", "film.pvd", *FREE, "--components", self.table,
                      "--time-step", "0.5")
        self.assertEqual([(row["time"], row["component"]) for row in self.rows(["time", *COLUMNS])],
                         [("0", "0"), ("0", "1"), ("0.5", "0")])

    def test_numbers_of_a_film(self):
        """The table of --numbers has a row for each step, also for interpolated steps, and the columns of gauges. With --components it has
        the number of pieces; pieces that are left out do not count in any column."""
        moving = {**self.all_arrays, "Id": list(range(1125)), "Velocity": [(0.0, 0.0, 0.4)] * 1125}
        self.write_rising_steps(2, 0.1, points=self.all_points, **moving)
        numbers = self.directory / "numbers.csv"
        film = ["steps.pvd", "film.pvd", *FREE, "--times", "0,0.1,0.25", "--numbers", numbers, "--gauge",
                "mast=0,0,-1:0,0,1"]
        rows = []
        for options in ([], ["--components", self.table], ["--components", self.table, "--least-volume", "0.3"]):
            self.run_good(*film, *options)
            rows.append(read_table(numbers))
        names = ["time", "iso", "triangles", "area", "volume", "pieces", "mast.last", "mast.depth", "mast.crossings"]
        self.assertEqual([list(table[0]) for table in rows], [names[:5] + names[6:], names, names])
        self.assertEqual(column(rows[0], "time"), ["0", "0.1", "0.25"])
        for i, (plain, both, one) in enumerate(zip(*rows)):
            for name in plain:
                self.assertEqual(plain[name], both[name])
            self.assertEqual([both["pieces"], one["pieces"]], ["2", "1"])
            self.assertAlmostEqual(float(both["volume"]), 1.1, delta=0.1)
            self.assertAlmostEqual(float(one["volume"]), 1.0, delta=0.1)
            self.assertAlmostEqual(float(one["area"]), 6, delta=0.9)
            self.assertAlmostEqual(float(plain["mast.last"]), 1.5 + (0, 0.04, 0.1)[i], delta=0.01)
            self.assertLess(int(one["triangles"]), int(both["triangles"]))

    def test_iso_values(self):
        """Each iso value has its own rows, the same as in a run with this value alone."""
        files.write_vtp(self.input, self.points, {**self.arrays, "Height": [0.6 - r for r in self.arrays["Radius"]]})
        numbers = self.directory / "numbers.csv"

        def tables(iso):
            self.run_good(self.input, "film.pvd", "--scalar", "Height", "--iso", iso, "--numbers", numbers, "--components", self.table)
            return read_table(numbers), read_table(self.table)

        (first, second), pieces = tables("0.4,0.3")
        self.assertEqual([first["iso"], second["iso"]], ["0.3", "0.4"])
        for row in (first, second):
            (alone,), own = tables(row["iso"])
            self.assertEqual(alone["triangles"], row["triangles"])
            for name in ("area", "volume"):
                self.assertAlmostEqual(float(alone[name]) / float(row[name]), 1, delta=1e-5)
            for name in ("particles", "mass", "iso", "parent", "closed"):
                self.assertEqual([own[0][name]], [piece[name] for piece in pieces if piece["iso"] == row["iso"]])
        self.assertAlmostEqual(float(first["between"]), float(first["volume"]) - float(second["volume"]), delta=1e-12)
        self.assertEqual(second["between"], second["volume"])

    def test_period(self):
        """A block that crosses a side of the periodic box counts as one piece."""
        files.write_vtp(self.input, [((x + 1.5) % 2, y, z) for x, y, z in self.points], self.arrays)
        block, = self.pieces("--periodic", "0,2,0,0,0,0")
        self.assertEqual((block["closed"], block["particles"]), ("1", "992"))
        self.assertAlmostEqual(float(block["xmax"]) - float(block["xmin"]), 1, delta=0.02)

    def test_wrong_usage(self):
        self.refuse_all(2, [(["--components", "pieces.txt"], "writes a .csv file"), (["--components", self.output], "a .csv file"),
                            (["--numbers", "numbers.csv"], "--numbers is for films, not for surfaces")], *FREE)
        self.refuse_all(1, [(["--components", "nowhere/pieces.csv"], "could not be written")], *FREE)


if __name__ == "__main__":
    main()
