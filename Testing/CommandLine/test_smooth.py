# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests smoother surfaces: --widen, --widening and --compact."""
import pathlib
import random
import re

import particle_files as files
from command_line_test import CommandLineTest, main, read_table, says


class Smooth(CommandLineTest):
    def setUp(self):
        super().setUp()
        random.seed(45)
        self.points = [tuple(x + random.gauss(0, 0.08) * 0.1 for x in point) for point in self.points]

    def test_factors_in_a_file(self):
        """Smoothing lengths that are multiplied by the factors of --widening give the same surface as --widen, if volumes and cubes stay
        the same."""
        for computed in (True, False):
            arrays = {name: array for name, array in self.arrays.items() if not computed or name not in (
                "Mass", "Density", "Volume")}
            files.write_vtp(self.input, self.points, arrays)
            wide, plain, factors = (self.directory / name for name in ("wide.stl", "plain.stl", "factors.vtp"))
            cube = ["--free-surface", "--cube-size", "0.05", "--no-attributes"]
            self.run_good(self.input, wide, *cube, "--widen", "2", "--widening", factors)
            volumes = ["--volume", "WideningVolume"] if computed else []
            self.run_good(factors, plain, *cube, "--smoothing-length", "WidenedSmoothingLength", "--cubes", "uniform", *volumes,
                          says=".*")  # This run warns of too many neighbours.
            self.assertEqual(wide.read_bytes(), plain.read_bytes())
            self.assertGreater(len(wide.read_bytes()), 10000)

    def test_gauges_read_the_widened_field(self):
        """Gauges and probes use the widened field. A probe of the surface's points gives 0.5. A gauge reads the same level with
        one step and with several. The file's volumes and computed volumes are tried."""
        files.write_vtp(self.directory / "bare.vtp", self.points, {"SmoothingLength": self.arrays["SmoothingLength"]})
        for source in (self.input, "bare.vtp"):
            levels = []
            for options in ([], ["--widen", "2"], ["--smooth", "--smoothing-length", "0.26", "--support-radius"]):
                self.run_good(source, "levels.csv", "--gauge", "a=0,0,-1:0,0,1", *options)
                level = float(read_table(self.directory / "levels.csv")[0]["last"])
                self.run_good(source, source, "film.pvd", "--time-step", "1", "--free-surface", "--numbers", "n.csv", "--gauge", "a=0,0,-1:0,0,1", *options)
                self.assertEqual(float(read_table(self.directory / "n.csv")[1]["a.last"]), level)
                self.run_good(source, "s.vtp", "--free-surface", "--no-attributes", "--box=-0.2,0.2,-0.2,0.2,0,1", *options)
                self.run_good(source, "p.vtp", "--probe", "s.vtp", "--attributes", "SmoothingLength", *options)
                low, high = re.search('Name="WeightSum"[^>]*RangeMin="(.*?)"[^>]*RangeMax="(.*?)"', (self.directory / "p.vtp").read_text()).groups()
                self.assertAlmostEqual(float(low), 0.5, places=4)
                self.assertAlmostEqual(float(high), 0.5, places=4)
                levels.append(level)
            self.assertEqual(len({round(level, 6) for level in levels}), 2, levels)

    def test_pieces(self):
        """--smooth keeps threads at the rims of sheets connected, so the number of pieces stays."""
        table = self.directory / "pieces.csv"
        for options in ([], ["--smooth"]):
            self.extract_good("--free-surface", "--components", table, *options, source=pathlib.Path(__file__).parents[2] / "Examples"
                              / "Data" / "double_dam_break_small.vtp")
            self.assertEqual(len(table.read_text().splitlines()), 1 + 9)

    def test_empty(self):
        """If the field never reaches the iso value, the surface is empty, with and without smoothing."""
        for field in (["--free-surface"], ["--scalar", "Density"]):
            for options in ([], ["--compact"], ["--smooth"]):
                self.run_good(self.input, self.directory / "empty.vtp", *field, "--iso", "5000", *options,
                              says="surface is empty")

    def test_refused(self):
        self.refuse_all(1, [(["--compact", "--filled"], says("FILLED_WITH_COMPACT", "--compact"))], "--free-surface")
        self.refuse_all(2, [(["--widening", "f.vtp"], "--widening needs --widen or --smooth"), (["--widen", "9"], "from 1 to 4, not '9'"),
                            (["--widen", "2", "--widening", "f.csv"], ".vtp file, not 'f.csv'")], "--free-surface")


if __name__ == "__main__":
    main()
