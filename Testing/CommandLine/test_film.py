# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests films of the program marching-correctors: test_film.py PROGRAM PRELOAD."""
import json
import re
import signal
import subprocess
import time

import particle_files as files
from command_line_test import CommandLineTest, column, main, read_table, says

FREE = ["--free-surface"]


class Film(CommandLineTest):
    """Tests films: one surface for each of many steps, and a list of the surfaces."""

    def setUp(self):
        super().setUp()
        self.film = self.directory / "film.pvd"

    def write_steps(self, count, step=0.1, **changes):
        """Writes drop_000.vtp, ... and steps.pvd, which lists these files at the times 0, `step`, .... Returns the files' paths."""
        entries = []
        for i in range(count):
            path = self.directory / f"drop_{i:03}.vtp"
            files.write_vtp(path, *files.drop_at(step * i, **changes))
            entries.append((repr(round(step * i, 9)), path.name))
        files.write_pvd(self.directory / "steps.pvd", entries)
        return [self.directory / name for _, name in entries]

    def make(self, *arguments, **options):
        return self.run_program(*arguments, self.film, *FREE, **options)

    def good(self, *arguments):
        statistics = self.directory / "statistics.json"
        self.run_good(*arguments, self.film, *FREE, "--stats", statistics)
        return json.loads(statistics.read_text())

    def listed(self, name=None):
        return super().listed(name or self.film)

    def surfaces(self):
        return sorted(p.name for p in self.directory.glob("film_*"))

    def without_mark(self, path):
        return re.sub("\n<!--.*?-->", "", path.read_text(), count=1)

    # Films

    def test_ten_steps_by_one_command(self):
        """Five of the ten times lie between two stored steps. The particles at these times are interpolated."""
        self.write_steps(6)
        times = [0.05 * i for i in range(10)]  # One of these times is 0.30000000000000004.
        result = self.run_good("steps.pvd", self.film, *FREE, "--times", ",".join(map(repr, times)), "--stats", "s.json")
        self.assertEqual(result.stdout.count("\n"), 10)
        self.assertRegex(result.stdout, r"(?m)^.*film_0003\.vtp \(time 0\.15\): \d+ points, \d+ triangles")
        self.assertEqual([(round(t, 9), p.name) for t, p in self.listed()],
                         [(round(t, 9), f"film_{i:04}.vtp") for i, t in enumerate(times)])
        self.assertEqual(self.listed()[6][0], 0.3)
        statistics = json.loads((self.directory / "s.json").read_text())
        steps = statistics["steps"]
        self.assertEqual([s["time"] for s in steps], [t for t, _ in self.listed()])
        self.assertEqual([len(s["inputs"]) for s in steps], [1, 2] * 5)
        builds = [s["seconds"]["program_build"] for s in steps]
        self.assertGreater(builds[0], 0)
        self.assertEqual(builds[1:], [0] * 9)  # All steps use the program that the first one built.
        for step in steps:
            self.assertGreater(step["statistics"]["triangles"], 1000)
            self.assertGreater(step["wall_seconds"], 0)

    def test_steps_are_as_surfaces_alone(self):
        """A film of several files has the same bytes as runs for single files, though buffers are reused. Files are taken in the order of
        the numbers in their names."""
        paths = self.write_steps(3)
        self.good(*paths[::-1])
        self.assertEqual([t for t, _ in self.listed()], [0, 1, 2])
        for path, (_, surface) in zip(paths, self.listed()):
            self.extract_good(*FREE, source=path)
            self.assertEqual(self.output.read_bytes().decode(), self.without_mark(surface))

    def test_time_step(self):
        paths = self.write_steps(3)
        self.run_good(*paths, self.film, *FREE, "--times", "0.5",
                      says="warning: .*film_0000.vtp .*" + says("STEP_MOVED", "--time-step 0.1,", "moved 0.10", "'Velocity'"))
        files.write_pvd(self.directory / "steps.pvd", enumerate(path.name for path in paths))
        self.assertRegex(self.make("steps.pvd", "--times", "0.5").stderr, says("STEP_MOVED", "moved 0.10"))
        self.good(*paths, "--time-step", "0.1", "--times", "0.05,0.2")
        self.assertEqual([t for t, _ in self.listed()], [0.05, 0.2])

    def test_numbers_by_another_name(self):
        paths = self.write_steps(2)
        self.good("steps.pvd", "--times", "0.03")
        expected = self.without_mark(self.listed()[0][1]).replace("Idp", "Tag")
        for i, path in enumerate(paths):
            points, arrays = files.drop_at(0.1 * i)
            arrays = {"Tag" if name == "Idp" else name: values for name, values in arrays.items()}
            files.write_vtp(path, points, arrays)
        result = self.make("steps.pvd", "--times", "0.03")
        self.one_sentence(result, 1, says("NO_IDS", "--ids"))
        self.good("steps.pvd", "--times", "0.03", "--ids", "Tag")
        self.assertEqual(self.without_mark(self.listed()[0][1]), expected)

    def test_ranges_of_times(self):
        """--times BEGIN:END:STEP means times from BEGIN to END, STEP apart. With --fps, the times and --slow decide the number of
        frames."""
        paths = self.write_steps(3)
        film = [*paths, self.film, *FREE, "--quiet", "--time-step", "0.1"]
        for options, times in ((["--times", "0:0.2:0.05"], [0, 0.05, 0.1, 0.15, 0.2]), (["--times", "0.2,0:0.1:0.04"], [0, 0.04, 0.08, 0.2]),
                               (["--fps", "10"], [0, 0.1, 0.2]), (["--fps", "10", "--slow", "2"], [0, 0.05, 0.1, 0.15, 0.2]),
                               (["--fps", "12"], [0, 1 / 12, 2 / 12])):
            self.run_good(*film, *options)
            self.assertEqual([round(time, 9) for time, _ in self.listed()], [round(time, 9) for time in times])
        for options, sentence in ((["--times", "0:0.2"], "times, or BEGIN:END:STEP"), (["--times", "0:0.2:0"], "must be greater than 0"),
                                  (["--times", "0.2:0:0.1"], "a range with 1 to"), (["--times", "0:1:1e-9"], "a range with 1 to"),
                                  (["--fps", "1e9"], "more than a million frames"), (["--slow", "2"], "--fps"),
                                  (["--fps", "2", "--times", "0"], "--times")):
            self.one_sentence(self.run_program(*film, *options), 2, sentence)
        stored = [0, 1e-13, 1]  # No stored step is taken for the one before it.
        files.write_pvd(self.directory / "steps.pvd", zip(stored, (path.name for path in paths)))
        self.good("steps.pvd")
        self.assertEqual([time for time, _ in self.listed()], stored)

    def test_points_over_time(self):
        """With several steps and a .csv output, --probe writes a row for each step and point; cells are empty where there is no fluid."""
        paths = self.write_steps(3)
        (self.directory / "points.csv").write_text("x,y,z,name\n0,0,0,middle\n0.2,0.1,0,side\n9,0,0,far\n")
        table = self.directory / "table.csv"

        def rows(*arguments):
            self.run_good(*arguments, "--probe", "points.csv", "--quiet")
            return read_table(table)
        found = rows(*paths, table, "--time-step", "0.1", "--times", "0:0.2:0.05")
        self.assertEqual([(float(row["time"]), row["point"], row["name"], row["valid"]) for row in found],
                         [(0.05 * i if i != 3 else 0.15, str(k), name, str(int(k < 2))) for i in range(5) for k, name in enumerate(("middle", "side", "far"))])
        self.assertEqual({row["Density"] for row in found if row["valid"] == "0"}, {""})
        for row in found:
            if row["name"] == "side":
                self.assertAlmostEqual(float(row["Velocity:0"]), -0.2, delta=0.02)  # The drop turns around z with 2 / s.
                self.assertAlmostEqual(float(row["Velocity:2"]), -float(row["time"]), delta=0.01)
        alone = rows(paths[1], table)
        for one, row in zip(alone, found[6:9]):
            self.assertEqual({**one, "time": ""}, {**row, "time": ""})
        self.one_sentence(self.run_program(*paths, "o.vtp", "--probe", "points.csv"), 2, ".csv")

    def test_color_names(self):
        """A wrong array name is reported before a surface is made, and a name that differs only in case is offered as a correction."""
        files.write_vtp(self.input, *files.drop_at(0.0))
        picture = ("--screenshot", "p.png")
        for outputs in ((self.input, "film_%04d.ply", "--free-surface"), ("o.vti", "--slice", "z=0", *picture),
                        ("o.vti", "--project", "z", "--scalar", "Velocity", *picture)):
            for name, sentence in (("velocity", "no array 'velocity' to colour by; did you mean Velocity[?]"), ("Nope", "there are .*Velocity")):
                result = self.run_program(self.input, *outputs, "--color-by", name)
                self.assertRegex(result.stderr, sentence)
                self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.run_good(self.input, "o.vti", "--slice", "z=0", *picture, "--color-by", "WeightSum", display=True)
        points = files.drop_at(0.0)[0]
        atoms = "".join("O {} {} {}\n".format(*point) for point in points)
        (self.directory / "atoms.xyz").write_text(f"{len(points)}\nProperties=species:S:1:pos:R:3\n{atoms}")
        result = self.run_program("atoms.xyz", "o.vtp", "--free-surface", "--smoothing-length", "estimate", *picture, "--color-by", "species", display=True)
        self.one_sentence(result, 1, "species.*texts")

    def test_period_between_steps(self):
        """If particles cross a side of the periodic box between two steps, their path is interpolated beyond the side, not
        back through the box."""
        points, arrays = files.lattice(6)
        for i, x in enumerate((0.6, 0.8)):
            moved = [((p[0] + x) % 1, p[1] + 0.5, p[2] + 0.5) for p in points]
            files.write_vtp(self.directory / f"step_{i}.vtp", moved,
                            {**arrays, "Id": list(range(216)), "Velocity": [(2.0, 0.0, 0.0)] * 216})
        files.write_pvd(self.directory / "steps.pvd", [(0.1 * i, f"step_{i}.vtp") for i in range(2)])
        numbers = self.directory / "numbers.csv"
        film = ["steps.pvd", self.film, *FREE, "--times", "0,0.03,0.05,0.1", "--numbers", numbers, "--components", "pieces.csv", "--quiet"]
        for period in ("1,1,1", "0,1,0,1,0,1"):
            self.run_good(*film, "--periodic", period)
            rows = read_table(numbers)
            self.assertEqual(column(rows, "pieces"), ["1"] * 4)
            for row in rows:
                self.assertAlmostEqual(float(row["area"]) / float(rows[0]["area"]), 1, delta=0.01)
        said = self.run_program(*film).stderr
        self.assertRegex(said, says("STEP_MOVED", "'Velocity'", "--periodic"))

    def test_no_numbers(self):
        points, arrays = files.drop_at(0.1)
        del arrays["Idp"]
        paths = self.write_steps(2)
        files.write_vtp(paths[1], points, arrays)
        self.good("steps.pvd")
        result = self.make("steps.pvd", "--times", "0,0.05", "--quiet")
        self.one_sentence(result, 1, r"film_0001.vtp \(time 0.05\): There is no point array 'Idp'")

    def test_parts(self):
        """Several files of the same time are parts of one set of particles."""
        self.write_steps(1)
        self.good("steps.pvd")
        whole = self.listed()[0][1].read_bytes()
        for i in range(2):
            files.write_vtp(self.directory / f"part{i}.vtp",
                            *files.drop_at(0.0, numbers=list(range(500 * i, 500 * i + 500))))
        files.write_pvd(self.directory / "steps.pvd", [(0, "part0.vtp"), (0, "part1.vtp")])
        step = self.good("steps.pvd")["steps"][0]
        self.assertEqual(step["statistics"]["fluid_particles"], 1000)
        self.assertEqual(self.listed()[0][1].read_bytes(), whole)

    def test_other_formats(self):
        """If the output name has the step's number, no list of files is written, and files with the
        outputs' names are replaced."""
        self.write_steps(3)
        for ending, begin in ((".ply", b"ply\n"), (".obj", b"# by"), (".stl", b"binary"), (".vtp", b"<?xml")):
            with self.subTest(ending):
                (self.directory / f"drop_01{ending}").write_text("old")
                self.run_good("steps.pvd", f"drop_%02d{ending}", *FREE, "--no-attributes", "--quiet")
                for i in range(3):
                    self.assertTrue((self.directory / f"drop_{i:02}{ending}").read_bytes().startswith(begin))
        self.assertFalse(self.film.exists())
        result = self.run_program("steps.pvd", "drop_%03d.vtp", *FREE)  # This pattern names the steps themselves.
        self.one_sentence(result, 2, "drop_000.vtp would overwrite the input")

    def test_pictures(self):
        """--screenshot makes one picture of each step."""
        self.write_steps(2)
        self.run_good("steps.pvd", self.film, *FREE, "--quiet", "--screenshot", "frame_%d.png", "--color-by", "Velocity", "--up",
                      "z", display=True)
        self.run_good("steps.pvd", self.directory / "other.pvd", *FREE, "--quiet", "--screenshot", "normals_%d.png", "--color-by", "Normals",
                      "--numbers", "n.csv", "--gauge", "g=0,0,-1:0,0,1", display=True)  # A gauge has no such array.
        pictures = [(self.directory / f"frame_{i}.png").read_bytes() for i in range(2)]
        self.assertNotEqual(*pictures)
        for picture in pictures:
            self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
            self.assertGreater(len(picture), 20000)

    # Failures

    def test_step_without_points(self):
        """A step without particles, as VTK writes it, gives an empty surface."""
        path = self.write_steps(3)[1]
        files.write_vtp(path, [], {})
        text = path.read_text()
        path.write_text(text[:text.index("<Points>")] + "<Points>" + text[text.index("</Points>"):])
        result = self.make("steps.pvd")
        self.assertEqual((result.returncode, len(self.listed())), (0, 3), result.stderr)
        self.assertRegex(result.stderr, r"^marching-correctors: warning: \S*film_0001.vtp .*empty\n$")

    def test_failing_step(self):
        paths = self.write_steps(5)
        paths[2].write_text(paths[2].read_text()[:3000])
        result = self.make("steps.pvd", "--stats", "s.json", "--quiet")
        self.one_sentence(result, 1, r"film_0002.vtp \(time 0.2\): .*drop_002.vtp is not a complete")
        self.assertEqual([p.name for _, p in self.listed()],
                         [f"film_000{i}.vtp" for i in (0, 1, 3, 4)])
        steps = json.loads((self.directory / "s.json").read_text())["steps"]
        self.assertEqual(["error" in s for s in steps], [False, False, True, False, False])
        result = self.make("steps.pvd", "--times", "0.1,0.15,0.25,0.3,0.35", "--quiet")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 2), result.stderr)
        self.assertEqual([t for t, _ in self.listed()], [0.1, 0.3, 0.35])

    def test_crash_of_the_reader(self):
        """If a step fails, the error names its file, and the surfaces of earlier steps are listed."""
        paths = self.write_steps(3)
        result = self.make(*paths, "--quiet", env=self.misbehaving(reader="fault", reader_call=2))
        if result.returncode == 0:
            self.skipTest("this VTK has an XML library of its own")
        self.one_sentence(result, 1, "reading .*drop_001.vtp failed: the program crashed there")
        self.assertEqual([p.name for _, p in self.listed()], ["film_0000.vtp"])

    def test_all_fail(self):
        paths = self.write_steps(2)
        result = self.run_program(*paths, self.film, "--scalar", "Nothing", "--iso", "1", "--quiet")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 2))
        self.assertRegex(result.stderr, r"film_0000.vtp \(time 0\): .*'Nothing'.*\n.*: 1 more step: .*'Nothing'")
        self.assertFalse(self.film.exists())
        self.assertEqual(self.surfaces(), [])

    def test_signal(self):
        """After an interrupted run the finished steps stay and are listed, and a second run overwrites them."""
        self.write_steps(3)
        run = subprocess.Popen([self.program, "steps.pvd", self.film, *FREE, "--quiet"],
                               cwd=self.directory, env=self.misbehaving(
                                   rename_seconds=1000, failing_folder=self.directory / "film_0002"))
        self.addCleanup(run.kill)
        while not self.film.exists():
            self.assertIsNone(run.poll())
            time.sleep(0.05)
        run.send_signal(signal.SIGTERM)
        self.assertEqual(run.wait(), -signal.SIGTERM)
        self.assertGreaterEqual(len(self.surfaces()), len(self.listed()))
        self.assertLess(len(self.listed()), 3)
        self.good("steps.pvd")
        self.assertEqual(len(self.listed()), 3)

    # ---- Files that a film may replace ----

    def test_no_file_of_others_is_lost(self):
        paths = self.write_steps(2)
        self.good("steps.pvd")
        self.good("steps.pvd")  # The film replaces its own files.
        mine = self.directory / "film_0001.vtp"
        for content in ("precious", self.without_mark(mine)):
            mine.write_text(content)
            self.one_sentence(self.make("steps.pvd"), 2, "film_0001.vtp already exists and is not a step")
            self.assertEqual(mine.read_text(), content)
        mine.unlink()
        mine.symlink_to("nowhere")
        self.one_sentence(self.make("steps.pvd"), 2, "film_0001.vtp already exists")
        mine.unlink()
        self.one_sentence(self.make("steps.pvd", "--stats", self.film), 2, "written twice")
        paths[0].rename(self.directory / "film_0000.vtp")
        files.write_pvd(self.directory / "steps.pvd", [(0, "film_0000.vtp"), (1, paths[1].name)])
        self.one_sentence(self.make("steps.pvd"), 2, "film_0000.vtp would overwrite the input")
        result = self.run_program("steps.pvd", "steps.pvd", *FREE)
        self.one_sentence(result, 2, "steps.pvd would overwrite the input")

    def test_names(self):
        """The list holds names with quotes, <, & and umlauts. A name with a control character is refused."""
        folder = self.directory / 'a "b" & <c> ü'
        folder.mkdir()
        self.film = folder / 'd "e" & <f> ö.pvd'
        self.directory, parent = folder, self.directory
        self.run_good(self.input, self.film, *FREE, "--quiet")
        self.assertEqual([p.name for _, p in self.listed()], ['d "e" & <f> ö_0000.vtp'])
        self.assertTrue(self.listed()[0][1].exists())
        result = self.run_program(self.input, parent / "a\x1bb.pvd", *FREE)
        self.one_sentence(result, 2, "characters in its name that a .pvd file cannot hold")

    def test_usage(self):
        pvd = self.directory / "steps.pvd"
        paths = self.write_steps(2)
        for arguments, sentence in [
            ([*paths, "film.vtp"], "output of several steps is a .pvd file, or .* with %04d in its name, not 'film.vtp'"),
            ([pvd, "film.vtp"], "output of several steps is a .pvd file"),
            ([pvd, pvd, "film.pvd"], "a .pvd or .series file must be the only INPUT"),
            ([paths[0], pvd, "film.pvd"], "a .pvd or .series file must be the only INPUT"),
            ([self.input, "surface.vtp", "--times", "1"], "--times is for films, .*; leave it out, or make a film"),
            ([self.input, "film.pvd", "--time-step", "2"], "--time-step is the time between one INPUT and the next, and there is one"),
            ([pvd, "film.pvd", "--time-step", "2"], "a .pvd or .series file has times of its own"),
            ([*paths, "film.pvd", "--time-step", "0"], "--time-step must be greater than 0"),
            ([pvd, "film.pvd", "--times", "0.05,0.3"], "0.3 is outside the times of the steps, 0 to 0.1"),
            ([pvd, "film.pvd", "--times=-0.1"], "-0.1 is outside"),
            ([pvd, "film.pvd", "--screenshot", "a.png"], "a film has a picture of each step: --screenshot frame_%04d.png"),
        ]:
            with self.subTest(sentence):
                self.one_sentence(self.run_program(*arguments, *FREE), 2, sentence)
                self.assertEqual(self.surfaces(), [])

    def test_bad_lists(self):
        for text, sentence in [
            ("", "it is not XML, or damaged|no element found"),
            ("<VTKFile><Collection>", "no element found|damaged"),
            ("<VTKFile/>", "it has no element Collection"),
            ("<VTKFile><Collection/></VTKFile>", "it lists no files"),
            ("<VTKFile><Collection><DataSet timestep='0'/></Collection></VTKFile>", "entry 0 names no file"),
            ("<VTKFile><Collection><DataSet timestep='x' file='a.vtp'/></Collection></VTKFile>",
             "the time of a.vtp is 'x', not a number"),
        ]:
            with self.subTest(sentence):
                (self.directory / "steps.pvd").write_text(text)
                self.one_sentence(self.make("steps.pvd"), 1, "steps.pvd cannot be read: .*" + f"({sentence})")
        self.one_sentence(self.make("nothing.pvd"), 1, "nothing.pvd cannot be read: No such file")
        files.write_pvd(self.directory / "steps.pvd", [(0, "nothing.vtp")])
        self.one_sentence(self.make("steps.pvd"), 1, "nothing.vtp cannot be read: No such file")

    # Costs

    def test_memory_is_flat(self):
        """A film of 100 steps, half of them interpolated, needs no more memory at its end than after 20 steps."""
        self.write_steps(51, step=0.01, n=16)
        steps = self.good("steps.pvd", "--times", ",".join(repr(0.005 * i) for i in range(100)))["steps"]
        self.assertEqual(len(steps), 100)
        peaks = [s["peak_resident_bytes"] for s in steps]
        self.assertLess(peaks[-1], 1.05 * peaks[19])


if __name__ == "__main__":
    main()
