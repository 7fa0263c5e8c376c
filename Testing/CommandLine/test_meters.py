# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests gauges and fluxes of the program, and the volumes of particles that they show: test_meters.py PROGRAM PRELOAD GROUP."""
import math
import os
import subprocess
import time
import xml.etree.ElementTree

import particle_files as files
from command_line_test import CommandLineTest, column, main, read_table, says

UP = "mast=0,0,-1:0,0,1"
WALL = "wall=0.1,-.2,-.2:0.1,.2,-.2:0.1,-.2,.3"
CUBE = [(-.2, -.2, -.2), (.2, -.2, -.2), (.2, .2, -.2), (-.2, .2, -.2),
        (-.2, -.2, .2), (.2, -.2, .2), (.2, .2, .2), (-.2, .2, .2)]
SIDES = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6), (0, 5, 1), (0, 4, 5), (1, 6, 2), (1, 5, 6), (2, 7, 3), (2, 6, 7),
         (3, 4, 0), (3, 7, 4)]  # The normals point inwards, so the program turns them.

DX = files.SPACING


class Meter(CommandLineTest):
    """The tests that gauges and fluxes share."""

    def setUp(self):
        super().setUp()
        self.table = self.directory / "table.csv"

    def measure(self, *options, source=None):
        return self.run_program(source or self.source, self.table, *options)

    def read_rows(self):
        rows = read_table(self.table)
        self.assertEqual(list(rows[0]), self.columns)
        return rows

    def test_outside(self):
        result = self.measure(*self.one, self.one[0], "far=9,0,0:9,0,1:9,1,0"[:None if self.one[0] == "--flux" else 15])
        self.one_sentence(result, 0, "warning: .*" + says("PLACE_DRY", "(gauge|section) 'far'"))
        self.assertEqual(len(self.read_rows()), 2)
        many = [word for i in range(300) for word in (self.one[0], f"far{i}=9,0,{i}:9,0,{i + 1}" + f":9,1,{i}" * (self.one[0] == "--flux"))]
        result = self.run_program(self.source, self.source, self.table, *many, *self.one, "--time-step", "1")
        lines = result.stderr.splitlines()
        self.assertRegex(lines[0], says("PLACES_DRY", "300 of 301", "'far0'"))
        self.assertRegex(lines[1], "1 more step: warning: places are")
        self.assertEqual(len(lines), 2)

    def test_times(self):
        """A file's time is used, also if there is only one file. If several files have no times, the steps are dt apart if all files store
        the same dt, else 1 apart. A warning names dt, or the times."""
        for step in range(3):
            for name in ("step", "timed"):
                files.write_vtp(self.directory / f"{name}_{step}.vtp", *files.drop_at(0.05 * step))
            files.add_field(self.directory / f"timed_{step}.vtp", "TimeValue", [0.5 + 0.05 * step])
        steps, timed = ([f"{name}_{i}.vtp" for i in range(3)] for name in ("step", "timed"))
        untold = "^marching-correctors: warning: the files tell no times, so the steps are at 0, 1, 2, .*--time-step, which is about 0.05.* by 'Velocity'\n$"
        for source, says, times in ((steps, untold, [0, 1, 2]), (timed, "^$", [0.5, 0.55, 0.6]), (timed[1:2], "^$", [0.55]),
                                    (["timed_1.vtp#0"], "^$", [0.55]), (steps[:1], "^$", [0])):
            self.run_good(*source, self.table, *self.one, says=says)
            self.assertEqual([round(float(row["time"]), 9) for row in read_table(self.table)], times)
        self.run_good(*steps, self.table, *self.one, "--time-step", "0.05")
        stored = [f"stored_{i}.vtp" for i in range(6)]
        for i, name in enumerate(stored):
            files.write_vtp(self.directory / name, *files.drop_at(0.05 * (i % 2)))
            files.add_field(self.directory / name, "dt", [0.05 if i < 2 else 0.2] * (2 if i > 3 else 1))
        for name in stored[4:]:  # The tag has no single finite number, as that of an array of NaN, which VTK writes.
            path = self.directory / name
            path.write_text(path.read_text().replace('Name="dt"', 'Name="dt" RangeMin="1e+299" RangeMax="-1e+299"'))
        for source, end, times in ((stored[:2], r"'dt' says, 0.05; give .* with --time-step\n$", [0, 0.05]),
                                   (stored[2:4], r"'dt' says, 0.2; give .* with --time-step, which is about 0.05.* by 'Velocity'\n$", [0, 0.2]),
                                   (stored[1:3], "at 0, 1, 2", [0, 1]),  # In these files the time differs.
                                   (stored[4:], "at 0, 1, 2", [0, 1])):
            self.run_good(*source, self.table, *self.one, says=end)
            self.assertEqual([float(row["time"]) for row in read_table(self.table)], times)

    def test_steps_without_fluid(self):
        """A step without particles, or without particles of the fluid's type, gives rows like other steps. The same holds in a plane."""
        z = self.points[0][2]
        for flat in (False, True):
            points, arrays = self.in_plane() if flat else (self.points, dict(self.arrays))
            arrays["Mass"] = [(10 if flat else 1) * mass for mass in arrays["Mass"]]
            one = [self.one[0], f"wall=0.1,-1,{z}:0.1,1,{z}"] if flat or self.one[0] == "--gauge" else self.one
            files.write_vtp(self.directory / "wet.vtp", points, {**arrays, "Kind": [1.0] * len(points)})
            files.write_vtp(self.directory / "other.vtp", points, {**arrays, "Kind": [0.0] * len(points)})
            files.write_vtp(self.directory / "none.vtp", [], {})
            steps = ["wet.vtp", "other.vtp", "none.vtp", "wet.vtp"]
            files.write_pvd(self.directory / "steps.pvd", enumerate(steps))
            for source in ("steps.pvd", "other.vtp"):
                self.run_good(source, self.table, *one, "--fluid", "Kind=1", says="warning: other.vtp: .* Kind = 1")
                rows = read_table(self.table)
                states = [row.get("state") or ("dry" if float(row["area"]) == 0 else "wet") for row in rows]
                self.assertEqual(states, ["dry" if name != "wet.vtp" else "wet" for name in (steps if source == "steps.pvd" else [source])])
                if "volume" in rows[0]:
                    self.assertEqual([row["mass_flux"] for row in rows if float(row["area"]) == 0], ["0"] * states.count("dry"))
                    self.assertEqual([row["mass"] == "" for row in rows], [False] * len(rows))

    def refuse_measuring(self, usage, failures):
        """Checks that the command lines `usage` (status 2), the inputs `failures` (status 1), and faults common to gauges and fluxes are
        refused. The table must stay as it was."""
        many = self.one[0] + ("es" if self.one[0] == "--flux" else "s")
        usage = [(self.one * 2, "two (gauges|sections) have the name"), *(([*self.one, *more], sentence) for more, sentence in (
            (["--iso", "0.2,0.5"], "all but one --iso value"), (["--iso", "0"], "--iso value above 0"),
            (["--times", "1"], "--times: 1 is outside the times of the steps, 0 to 0"))), *usage]
        os.mkfifo(self.directory / "fifo")
        failures = [([many, "none.txt"], "none.txt cannot be read"), ([many, "."], "cannot be read: it is a directory"),
                    *[([many, name], f"{name} cannot be read: it is not a regular file") for name in ("/dev/zero", "fifo")], *failures]
        self.table.write_text("as it was")
        for status, cases in ((2, usage), (1, failures)):
            for options, sentence in cases:
                with self.subTest(options=options):
                    self.one_sentence(self.measure(*options), status, sentence)
        self.one_sentence(self.run_program(self.source, "table.vtp", *self.one), 2, "the output of gauges and fluxes is a .csv file")
        self.one_sentence(self.run_program(self.source, "nowhere/t.csv", *self.one), 1, "nowhere/t.csv could not be written")
        self.assertEqual(self.table.read_text(), "as it was")


class Gauge(Meter):
    """Tests gauges in a block of particles with sides of 1 around the origin."""

    one = ["--gauge", UP]
    columns = ["time", "gauge", "state", "first", "last", "depth", "crossings", "x", "y", "z"]

    def setUp(self):
        super().setUp()
        self.source = self.input

    def good(self, *options, source=None):
        self.run_good(source or self.input, self.table, *options)
        return self.read_rows()

    def test_what_gauges_read(self):
        rows = self.good("--gauge", UP, "--gauge=half=0,0,0:0,0,2", "--gauge", "inside=0,0,-.1:0,0,.1",
                         "--gauge", 'a "dry", one=0.8,0,-1:0.6,0,1')
        self.assertEqual(column(rows, "gauge"), ["mast", "half", "inside", 'a "dry", one'])
        self.assertEqual(column(rows, "state"), ["wet", "wet", "full", "dry"])
        self.assertEqual(column(rows, "crossings"), ["2", "1", "0", "0"])
        mast, _, inside, dry = rows
        self.assertAlmostEqual(float(mast["z"]), 0.5, delta=0.05 * files.SPACING)
        self.assertEqual([float(inside[name]) for name in ("first", "last", "depth", "z")], [0.2, 0.2, 0.2, 0.1])
        self.assertEqual([dry[name] for name in self.columns[3:]], ["", "", "0", "0", "", "", ""])

    def test_file_of_gauges(self):
        (self.directory / "gauges.txt").write_text("# masts\n\n  one=0,0,-1:0,0,1  \ntwo=0.1,0,-1:0.1,0,1\n")
        rows = self.good("--gauge", UP, "--gauges", "gauges.txt")
        self.assertEqual(column(rows, "gauge"), ["mast", "one", "two"])

    def test_steps(self):
        """Several files, or the files of a .pvd file, are measured at their times."""
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
        """The table has the rows of measured steps before the run ends."""
        program = subprocess.Popen([self.program, *[self.input] * 1000, self.table, "--gauge", UP], cwd=self.directory,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        end = time.monotonic() + 300
        while not self.table.exists() and time.monotonic() < end:
            time.sleep(0.01)
        program.kill()
        program.communicate()
        text = self.table.read_text()
        self.assertTrue(text.endswith("\n"))
        times = column(self.read_rows(), "time")
        self.assertEqual(times, [str(i) for i in range(len(times))])
        self.assertLess(len(times), 1000)
        for part in self.directory.glob(".*"):
            part.unlink()

    def test_a_step_that_fails(self):
        """If one file cannot be read, the table has the rows of all other files."""
        result = self.run_program(self.input, "missing.vtp", self.input, self.table, "--gauge", UP, "--time-step", "1")
        self.one_sentence(result, 1, "marching-correctors: missing.vtp cannot be read: ")
        self.assertEqual(column(self.read_rows(), "time"), ["0", "2"])

    def test_grid(self):
        image = self.directory / "levels.vti"
        self.run_good(self.input, image, "--gauge-grid", "4,2:-0.6,0.3,0,0.1,-1,1")
        root = xml.etree.ElementTree.parse(image).getroot()
        self.assertEqual(root.find("ImageData").get("WholeExtent"), "0 3 0 1 0 0")
        names = {array.get("Name") for array in root.iter("DataArray")}
        self.assertEqual(names, {"Level", "Depth", "Crossings"})

    def test_wrong_usage(self):
        self.refuse_measuring(
            [(["--gauge", "mast=0,0,0:0,0,0"], "'mast' has no length"),
             (["--gauge", "mast=0,0,nan:0,0,1"], "NAME=X,Y,Z:X,Y,Z, not 'mast=0,0,nan:0,0,1'"),
             (["--gauge", "mast=0,0:0,0,1"], "needs a name and two places"),
             (["--gauge", "=1+1=0,0,0:0,0,1"], "'=1.1' begins with '=', so that spreadsheets"),
             (["--gauge-grid", "3000,3000:0,1,0,1,0,1"], "more than a million gauges, which take minutes"),
             (["--gauge-grid", "1,1:0,1,0,1,0,1"], "the output of --gauge-grid is a .vti file")],
            [(["--gauge", "far=0,0,0:0,0,1e30"], says("GAUGE_SAMPLES", "'far'", "4e.15"))])
        for text in ("0,1:0,1,0,1,0,1", "1.5,1:0,1,0,1,0,1", "2,2:0,1,0,1,1,0", "2,2"):
            self.one_sentence(self.run_program(self.input, "l.vti", "--gauge-grid", text), 2, "--gauge-grid needs")


class Flux(Meter):
    """Tests fluxes of a block with sides of 1 around the origin. All its particles move with the velocity (1, -2,
    3)."""

    one = ["--flux", WALL]
    columns = ["time", "section", "area", "volume_flux", "mass_flux", "velocity", "volume", "mass"]

    def setUp(self):
        super().setUp()
        self.source = self.directory / "moving.vtp"
        self.write("moving.vtp")

    def write(self, name, **more):
        files.write_vtp(self.directory / name, self.points, {**self.arrays, "Velocity": [(1.0, -2.0, 3.0)] * 1000, **more})

    def rows(self, *options, source="moving.vtp"):
        self.run_good(source, self.table, *options)
        return [{name: value if name == "section" else float(value or "nan") for name, value in row.items()}
                for row in self.read_rows()]

    def test_sections(self):
        (self.directory / "cube.stl").write_text("solid cube\n" + "".join(
            "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % CUBE[i] for i in side)
            + "endloop\nendfacet\n" for side in SIDES) + "endsolid cube\n")
        rows = self.rows("--flux", WALL, "--flux=disc=disc:0,0,0:0,0,-2:0.3", "--flux", "box=box:-.2,.2,-.1,.3,-.2,.1",
                         "--flux", "cube=cube.stl", "--flux", "up=-.2,-.2,.1:.2,-.2,.1:-.2,.2,.1")
        expected = [("wall", 0.2, 0.2), ("disc", math.pi * 0.09, -3 * math.pi * 0.09), ("box", 0.8, 0), ("cube", 0.96, 0),
                    ("up", 0.16, 0.48)]
        for row, (name, area, flux) in zip(rows, expected):
            self.assertEqual((row["section"], row["volume"], row["mass"]), (name, 0, 0))
            self.assertAlmostEqual(row["area"], area, delta=1e-6 * area)
            self.assertAlmostEqual(row["volume_flux"], flux, delta=4e-6 * area)
            self.assertAlmostEqual(row["mass_flux"], 1000 * flux, delta=4e-3 * area)
            self.assertAlmostEqual(row["velocity"], flux / area, delta=4e-6)
        (self.directory / "sections.txt").write_text("# all\n\n disc=disc:0,0,0:0,0,-2:0.3 \nup=-.2,-.2,.1:.2,-.2,.1:-.2,.2,.1\n")
        self.assertEqual(self.rows("--fluxes", "sections.txt", "--flux", WALL), [rows[0], rows[1], rows[4]])

    def test_outwards(self):
        """If each particle's velocity is its position, the flux out of a closed mesh is 3 times its volume, whichever way the triangles
        face."""
        for turned in (False, True):
            faces = "".join(f"3 {a + 0} {b if turned else d} {d if turned else b}\n" for a, b, d in SIDES)
            (self.directory / "cube.vtk").write_text(
                "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET POLYDATA\nPOINTS 8 double\n"
                + "".join("%g %g %g\n" % x for x in CUBE) + f"POLYGONS 12 48\n{faces}")
            row, = self.rows("--flux", "cube=cube.vtk", source=self.input)
            self.assertAlmostEqual(row["volume_flux"], 3 * 0.064, delta=0.002)

    def test_velocity_and_density(self):
        self.write("named.vtp", Drift=[(2.0, 0.0, 0.0)] * 1000)
        row, = self.rows("--flux", WALL, "--velocity", "Drift", source="named.vtp")
        self.assertAlmostEqual(row["velocity"], 2, delta=1e-6)
        files.write_vtp(self.directory / "bare.vtp", self.points, {name: self.arrays[name] for name in ("SmoothingLength", "Velocity")})
        row, = self.rows("--flux", WALL, source="bare.vtp")
        self.assertTrue(math.isnan(row["mass_flux"]) and math.isnan(row["mass"]) and row["volume"] == 0)
        row, = self.rows("--flux", WALL, "--density", "10", source="bare.vtp")
        self.assertAlmostEqual(row["mass_flux"], 10 * row["volume_flux"], delta=1e-6)

    def test_volume_that_has_passed(self):
        """The column `volume` grows between two steps by the mean of their fluxes times the time between them."""
        self.write_rising_steps(3, 0.06, step=0.2, Velocity=[(0.0, 0.0, 0.3)] * 1000, Id=list(range(1000)))
        rows = self.rows("--flux", "box=box:-1,1,-1,1,.3,1", "--flux", WALL, source="steps.pvd")
        self.assertEqual([(row["time"], row["section"]) for row in rows],
                         [(0.2 * i, name) for i in range(3) for name in ("box", "wall")])
        box = rows[::2]
        self.assertEqual((box[0]["volume"], box[0]["mass"]), (0, 0))
        self.assertAlmostEqual(box[1]["volume"], 0.1 * (box[0]["volume_flux"] + box[1]["volume_flux"]), delta=1e-12)
        self.assertAlmostEqual(box[2]["volume"], box[1]["volume"] + 0.1 * (box[1]["volume_flux"] + box[2]["volume_flux"]), delta=1e-12)
        for row in box[1:]:
            self.assertLess(row["volume"], -0.01)
            self.assertAlmostEqual(row["mass"], 1000 * row["volume"], delta=1e-3)
        times = self.rows("--flux", "box=box:-1,1,-1,1,.3,1", "--times", "0,0.1,0.4", source="steps.pvd")
        self.assertEqual([row["time"] for row in times], [0, 0.1, 0.4])
        later = self.rows("--flux", "box=box:-1,1,-1,1,.3,1", "--times", "0.1,0.4", source="steps.pvd")
        self.assertEqual((later[0]["time"], later[0]["volume"], later[0]["mass"]), (0.1, 0, 0))

    def test_wrong_usage(self):
        (self.directory / "vertices.vtk").write_text(
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nVERTICES 1 2\n1 0\n")
        form = "--flux needs a section with a name, NAME=X,Y,Z:X,Y,Z:X,Y,Z, NAME=disc:.* not "
        self.refuse_measuring(
            [(["--flux", "wall=0,0,0:0,0"], form + "'wall=0,0,0:0,0'"),
             *((["--flux", text], form) for text in ("wall", "=box:1", "a=disc:0,0,0:0,0,1", "a=box:0,1,0,1", "a=0,0,nan:0,0,1:1,1,1")),
             (["--flux", "+a=box:0,1,0,1,0,1"], "'.a' begins with '.', so that spreadsheets")],
            [(["--flux", "a=none.stl"], "none.stl"),
             (["--flux", "a=moving.vtp"], says("SECTION_POINTS", "'a' has 0 ")),
             (["--flux", "a=vertices.vtk"], says("SECTION_POINTS")),
             (["--flux", "a=0,0,0:1e30,0,0:0,1,0"], says("SECTION_CELLS_ALONG", "'a'")),
             ([*self.one, "--velocity", "Drift"], says("NO_SUCH_ARRAY", "'Drift'"))])
        del self.arrays["Velocity"]
        files.write_vtp(self.directory / "still.vtp", self.points, self.arrays)
        self.one_sentence(self.measure(*self.one, source="still.vtp"), 1, says("NO_VELOCITY", "--velocity"))


class Volumes(CommandLineTest):
    """Tests what gives the particles' volumes. With right volumes, the surface of a block of 10 x 10 x 10 particles around the origin
    is half a spacing beyond the particles."""

    def level(self, *options, arrays=()):
        """Returns the level, in spacings above the uppermost particles, and what the program prints."""
        files.write_vtp(self.input, self.points, {name: self.arrays[name] for name in arrays})
        table = self.directory / "levels.csv"
        result = self.run_good(self.input, table, "--gauge", "up=0.02,0,-.1:0.02,0,1", *options, says=".*")
        row, = read_table(table)
        return float(row["z"]) / DX - 4.5, result.stdout

    def test_still_water(self):
        """The level is the same whichever arrays or options give the volumes. The program tells what it used."""
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

    def test_spray(self):
        """A lone particle has a surface only if its volume is computed or large, or the iso value is low. A run tells how many particles
        would have no surface if each were alone."""
        points, table = [*self.points, (0.0, 0.0, 2.0)], self.directory / "pieces.csv"
        files.write_vtp(self.input, points, {"Volume": [DX ** 3] * len(points), "One": [DX ** 3] * (len(points) - 1) + [10 * DX ** 3]})
        given = ("--smoothing-length", "0.13")
        for options, pieces, alone in ((given, 1, "1001"), (("--dp", "0.1"), 1, "1001"), ((*given, "--volume", "computed"), 2, ""),
                                       ((*given, "--volume", "computed", "--smooth"), 2, ""), ((*given, "--volume", "One"), 2, "1000"),
                                       ((*given, "--iso", "0.1"), 2, "")):
            with self.subTest(options):
                said = self.run_good(self.input, self.output, "--free-surface", "--components", table, *options, says=".*").stdout
                self.assertEqual(len(read_table(table)), pieces)
                self.assertEqual((f"({alone} of 1001)" in said, "\nspray " in said), (bool(alone), bool(alone)), said)

    def test_smoothing_lengths_by_neighbours(self):
        files.write_vtp(self.input, self.points, {"Mass": [1.0] * len(self.points)})
        lows = [self.succeed("--free-surface", "--smoothing-length", word)["statistics"]["smoothing_length_range"][0]
                for word in ("neighbours", "neighbors", "neighbours=1.3", "neighbours=1.1")]
        self.assertTrue(lows[0] == lows[1] == lows[2] > lows[3])
        self.output.unlink()
        free = "--free-surface", "--smoothing-length"
        self.refuse_all(2, [(["neighbours=0"], "--smoothing-length")], *free)
        self.refuse_all(1, [(["neighbours=0.5"], says("ETA_ILLEGAL", "0.5"))], *free)


if __name__ == "__main__":
    main()
