# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Films by the program marching-correctors: test_film.py PROGRAM PRELOAD."""
import json
import pathlib
import re
import signal
import struct
import subprocess
import time
import xml.etree.ElementTree

import particle_files as files
from command_line_test import CommandLineTest, main

FREE = ["--free-surface"]
HERE = pathlib.Path(__file__).resolve().parent


def box_of(path):
    """Smallest and largest coordinates of an ASCII .obj file."""
    points = [tuple(map(float, line.split()[1:4])) for line in path.read_text().splitlines()
              if line.startswith("v ")]
    return [(min(p[c] for p in points), max(p[c] for p in points)) for c in range(3)]


class Film(CommandLineTest):
    """Many steps: one surface for each, and a list of them."""

    def setUp(self):
        super().setUp()
        self.film = self.directory / "film.pvd"

    def write_steps(self, count, step=0.1, **changes):
        """drop_0.vtp, ... and steps.pvd, which lists them at 0, `step`, ..."""
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
        result = self.make(*arguments, "--stats", statistics)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return json.loads(statistics.read_text())

    def listed(self):
        """[(time, path)] of the film."""
        root = xml.etree.ElementTree.parse(self.film).getroot()
        self.assertEqual(root.get("type"), "Collection")
        return [(float(e.get("timestep")), self.directory / e.get("file"))
                for e in root.iter("DataSet")]

    def surfaces(self):
        return sorted(p.name for p in self.directory.glob("film_*"))

    def without_mark(self, path):
        return re.sub("\n<!--.*?-->", "", path.read_text(), count=1)

    # Films

    def test_ten_steps_by_one_command(self):
        """Five of them interpolated."""
        self.write_steps(6)
        times = [0.05 * i for i in range(10)]  # 0.30000000000000004, too
        result = self.make("steps.pvd", "--times", ",".join(map(repr, times)), "--stats", "s.json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
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
        self.assertEqual(builds[1:], [0] * 9)  # one program for all
        for step in steps:
            self.assertGreater(step["statistics"]["triangles"], 1000)
            self.assertGreater(step["wall_seconds"], 0)

    def test_steps_are_as_surfaces_alone(self):
        """Buffers that live on change no byte; files are in the order of their numbers."""
        paths = self.write_steps(3)
        self.good(*paths[::-1])
        self.assertEqual([t for t, _ in self.listed()], [0, 1, 2])
        for path, (_, surface) in zip(paths, self.listed()):
            self.assertEqual(self.extract(*FREE, source=path).returncode, 0)
            self.assertEqual(self.output.read_bytes().decode(), self.without_mark(surface))

    def test_time_step(self):
        paths = self.write_steps(3)
        result = self.make(*paths, "--times", "0.5")
        self.assertEqual(result.returncode, 0)
        self.assertRegex(result.stderr, "warning: .*film_0000.vtp .*moved 0.10.* times as far as 'Velocity'"
                         ".*use --time-step")
        files.write_pvd(self.directory / "steps.pvd", enumerate(path.name for path in paths))
        self.assertRegex(self.make("steps.pvd", "--times", "0.5").stderr, r"moved 0.10.*change those in the \.pvd file")
        self.good(*paths, "--time-step", "0.1", "--times", "0.05,0.2")
        self.assertEqual([t for t, _ in self.listed()], [0.05, 0.2])

    def test_one_step(self):
        self.good(self.input)
        self.assertEqual([p.name for _, p in self.listed()], ["film_0000.vtp"])

    def test_numbers_by_another_name(self):
        paths = self.write_steps(2)
        self.good("steps.pvd", "--times", "0.03")
        expected = self.without_mark(self.listed()[0][1]).replace("Idp", "Tag")
        for i, path in enumerate(paths):
            points, arrays = files.drop_at(0.1 * i)
            arrays = {"Tag" if name == "Idp" else name: values for name, values in arrays.items()}
            files.write_vtp(path, points, arrays)
        result = self.make("steps.pvd", "--times", "0.03")
        self.one_sentence(result, 1, r"no point array has one of the usual names.*Name the array of ids \(--ids NAME\)")
        self.good("steps.pvd", "--times", "0.03", "--ids", "Tag")
        self.assertEqual(self.without_mark(self.listed()[0][1]), expected)
        self.one_sentence(self.make("steps.pvd", "--ids", "Tag"), 2, "only --times asks for; leave out --ids")

    def test_no_numbers(self):
        points, arrays = files.drop_at(0.1)
        del arrays["Idp"]
        paths = self.write_steps(2)
        files.write_vtp(paths[1], points, arrays)
        self.good("steps.pvd")
        result = self.make("steps.pvd", "--times", "0,0.05", "--quiet")
        self.one_sentence(result, 1, r"film_0001.vtp \(time 0.05\): There is no point array 'Idp'")

    def test_parts(self):
        """Several files of one time are parts of one set of particles."""
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
        """With the step's number in the name: no list, and files of one's own are replaced."""
        self.write_steps(3)
        for ending, begin in ((".ply", b"ply\n"), (".obj", b"# by"), (".stl", b"binary"), (".vtp", b"<?xml")):
            with self.subTest(ending):
                (self.directory / f"drop_01{ending}").write_text("old")
                self.run_good("steps.pvd", f"drop_%02d{ending}", *FREE, "--no-attributes", "--quiet")
                for i in range(3):
                    self.assertTrue((self.directory / f"drop_{i:02}{ending}").read_bytes().startswith(begin))
        self.assertFalse(self.film.exists())
        result = self.run_program("steps.pvd", "drop_%03d.vtp", *FREE)  # these are the steps themselves
        self.one_sentence(result, 2, "drop_000.vtp would overwrite the input")

    def test_pictures(self):
        """One of each step."""
        self.write_steps(2)
        self.run_good("steps.pvd", self.film, *FREE, "--quiet", "--screenshot", "frame_%d.png", "--color-by", "Velocity", "--up",
                      "z", display=True)
        pictures = [(self.directory / f"frame_{i}.png").read_bytes() for i in range(2)]
        self.assertNotEqual(*pictures)
        for picture in pictures:
            self.assertEqual(picture[:8], b"\x89PNG\r\n\x1a\n")
            self.assertGreater(len(picture), 20000)

    # Failures

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

    def test_damaged_steps(self):
        """Two of the files would crash VTK's reader, if they came as far; each costs its own step alone."""
        points, arrays = files.drop_at(0.1, n=3)
        crash = self.directory / "crash.vtk"
        files.write_legacy(crash, points, {n: v for n, v in arrays.items() if n != "Velocity"})
        crash.write_text(crash.read_text().replace("POINT_DATA 27", "POINT_DATA 27000000"))
        paths = self.write_steps(4)
        paths[1:1] = [crash]
        result = self.make(*paths, crash, "--stats", "s.json", "--quiet")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 2, result.stderr)
        self.assertRegex(result.stderr, r"film_0001.vtp \(time 1\): .*crash.vtk cannot be read: .*\n"
                                        r"marching-correctors: 1 more step: .*crash.vtk cannot be read: ")
        self.assertEqual([t for t, _ in self.listed()], [0, 2, 3, 4])
        steps = json.loads((self.directory / "s.json").read_text())["steps"]
        self.assertEqual([s["time"] for s in steps], [0, 1, 2, 3, 4, 5])
        self.assertEqual(["error" in s for s in steps], [False, True, False, False, False, True])

    def test_crash_of_the_reader(self):
        """A sentence that names the file; what was made before is listed."""
        paths = self.write_steps(3)
        result = self.make(*paths, "--quiet", env=self.misbehaving(reader="fault", reader_call=2))
        if result.returncode == 0:
            self.skipTest("this VTK has an XML library of its own")
        self.one_sentence(result, 1, "the reader of VTK failed on .*drop_001.vtp: the program crashed there")
        self.assertEqual([p.name for _, p in self.listed()], ["film_0000.vtp"])

    def test_all_fail(self):
        paths = self.write_steps(2)
        result = self.run_program(*paths, self.film, "--scalar", "Nothing", "--iso", "1", "--quiet")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (1, 2))
        self.assertRegex(result.stderr, r"film_0000.vtp \(time 0\): .*'Nothing'.*\n.*: 1 more step: .*'Nothing'")
        self.assertFalse(self.film.exists())
        self.assertEqual(self.surfaces(), [])

    def test_signal(self):
        """Steps that were done stay, and are listed; a second run goes over them."""
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

    # Whose files are whose

    def test_no_file_of_others_is_lost(self):
        paths = self.write_steps(2)
        self.good("steps.pvd")
        self.good("steps.pvd")  # over its own
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
        """The list names what XML and shells know how to quote."""
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
            ([pvd, pvd, "film.pvd"], "a .pvd file must be the only INPUT"),
            ([paths[0], pvd, "film.pvd"], "a .pvd file must be the only INPUT"),
            ([self.input, "surface.vtp", "--times", "1"], "not a film, .*; leave out --times"),
            ([self.input, "surface.vtp", "--time-step", "2"], "not a film, .*; leave out --time-step"),
            ([pvd, "film.pvd", "--time-step", "2"], "a .pvd file has times of its own"),
            ([*paths, "film.pvd", "--time-step", "0"], "--time-step must be greater than 0"),
            ([pvd, "film.pvd", "--times", "0.05,x"], "--times needs a finite number, not 'x'"),
            ([pvd, "film.pvd", "--times", "0.05,0.3"], "0.3 is outside the times of the steps, 0 to 0.1"),
            ([pvd, "film.pvd", "--times=-0.1"], "-0.1 is outside"),
            ([pvd, "film.pvd", "--repeat", "2"], "--repeat is for one surface"),
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
        """100 steps, of which 50 are interpolated, take no more than the first 20 do."""
        self.write_steps(51, step=0.01, n=16)
        steps = self.good("steps.pvd", "--times", ",".join(repr(0.005 * i) for i in range(100)))["steps"]
        self.assertEqual(len(steps), 100)
        peaks = [s["peak_resident_bytes"] for s in steps]
        self.assertLess(peaks[-1], 1.05 * peaks[19])


class Formats(CommandLineTest):
    """Surfaces as .stl, .ply and .obj; particles from .pvtp, .pvtu and .vtkhdf."""

    def extract_as(self, ending, *options):
        self.output = self.directory / ("surface" + ending)
        result = self.extract("--free-surface", "--quiet", *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return self.output.read_bytes()

    def counts(self):
        statistics = self.succeed("--free-surface")["statistics"]
        return statistics["points"], statistics["triangles"]

    def test_stl(self):
        points, triangles = self.counts()
        data = self.extract_as(".stl")
        self.assertEqual(len(data), 84 + 50 * triangles)
        self.assertEqual(struct.unpack_from("<I", data, 80)[0], triangles)
        numbers = struct.unpack_from("<12f", data, 84)
        self.assertAlmostEqual(sum(n * n for n in numbers[:3]), 1, delta=1e-5)
        self.assertGreater(sum(a * b for a, b in zip(numbers[:3], numbers[3:6])), 0)  # outwards
        self.assertGreater(points, 0)

    def test_ply(self):
        points, triangles = self.counts()
        data = self.extract_as(".ply")
        head, body = data.split(b"end_header\n", 1)
        self.assertIn(f"element vertex {points}\n".encode(), head)
        self.assertIn(f"element face {triangles}\n".encode(), head)
        self.assertEqual(len(body), 24 * points + 13 * triangles)
        for i in range(points):
            values = struct.unpack_from("=6f", body, 24 * i)
            self.assertAlmostEqual(sum(n * n for n in values[3:]), 1, delta=1e-5)
            self.assertGreater(sum(x * n for x, n in zip(values[:3], values[3:])), 0)
        for i in range(triangles):
            n, *corners = struct.unpack_from("=B3i", body, 24 * points + 13 * i)
            self.assertEqual(n, 3)
            self.assertTrue(all(0 <= c < points for c in corners) and len(set(corners)) == 3)

    def test_obj(self):
        points, triangles = self.counts()
        lines = self.extract_as(".obj").decode().splitlines()
        kinds = [line.split(" ", 1)[0] for line in lines]
        self.assertEqual([kinds.count(k) for k in ("v", "vn", "f")], [points, points, triangles])
        self.assertTrue(all(re.fullmatch(r"f (\d+)//\1 (\d+)//\2 (\d+)//\3", x) for x in lines if x[0] == "f"))
        self.assertLess(abs(box_of(self.output)[0][0] + box_of(self.output)[0][1]), 1e-3)

    def test_obj_digits(self):
        """Nine: every float comes back."""
        self.points = [(1e-3 * x + 1.0, y, z) for x, y, z in self.points]
        files.write_vtp(self.input, self.points, self.arrays)
        self.extract_as(".obj", "--output-precision", "single")
        found = [tuple(map(float, line.split()[1:])) for line in self.output.read_text().splitlines() if line[:2] == "v "]
        data = self.extract_as(".ply", "--output-precision", "single")
        start = data.index(b"end_header\n") + len(b"end_header\n")
        self.assertGreater(len(found), 100)
        for i, place in enumerate(found):
            self.assertEqual(struct.pack("=3f", *place), data[start + 24 * i:start + 24 * i + 12])

    def test_colors(self):
        """The array of --color-by is in a .ply file as colours; what others leave out is said."""
        points, triangles = self.counts()
        self.output = self.directory / "surface.ply"
        self.extract_good("--free-surface", "--quiet", "--color-by", "Velocity", "--color-range", "0.46,0.7")
        head, body = self.output.read_bytes().split(b"end_header\n", 1)
        self.assertIn(b"property uchar red\nproperty uchar green\nproperty uchar blue\n", head)
        self.assertEqual(len(body), 27 * points + 13 * triangles)
        speeds = []
        for i in range(points):
            x, y, z, *_, red, green, blue = struct.unpack_from("=6f3B", body, 27 * i)
            speeds.append(((x * x + y * y + z * z) ** 0.5, green))
        speeds.sort()  # the speed is about the distance from the centre; the colours grow in green with it
        self.assertLess(speeds[0][1], 60)
        self.assertEqual(speeds[-1][1], 231)  # the last colour, beyond the range
        for ending, hint in ((".ply", "--color-by NAME makes colours of one"), (".obj", "--no-attributes"),
                             (".stl", ".vtp keeps all")):
            self.output = self.directory / ("surface" + ending)
            self.one_sentence(self.extract("--free-surface", "--quiet"), 0,
                              f"warning: {ending} files hold no arrays, so these are left out: .*Velocity.*{hint}")
            self.extract_good("--free-surface", "--quiet", "--no-attributes")
        self.output = self.directory / "surface2.ply"
        result = self.extract("--free-surface", "--quiet", "--color-by", "Nothing")
        self.one_sentence(result, 1, "no array 'Nothing' to colour by; there are .*Velocity")
        self.assertFalse(self.output.exists())

    def test_empty(self):
        for ending in (".stl", ".ply", ".obj"):
            self.extract_as(ending, "--iso", "5")
            self.assertTrue(self.output.exists())

    # Inputs

    def write_pieces(self, kind, write, ghosts=False):
        """particles.p<kind> with two pieces and an empty one."""
        pieces = []
        for i, numbers in enumerate((range(0, 600 if ghosts else 500), range(500, 1000), [])):
            path = self.directory / f"piece{i}.{kind}"
            points, arrays = files.drop_at(0, numbers=list(numbers))
            if ghosts:
                marks = [int(n >= 500 and i == 0) for n in numbers]
                arrays["vtkGhostType"] = marks
            write(path, points, arrays)
            if ghosts:
                path.write_text(path.read_text().replace('"Float64" Name="vtkGhostType"',
                                                         '"UInt8" Name="vtkGhostType"'))
            pieces.append(path)
        name = {"vtp": "PolyData", "vtu": "UnstructuredGrid"}[kind]
        path = self.directory / f"particles.p{kind}"
        path.write_text(f'<?xml version="1.0"?><VTKFile type="P{name}"><P{name} GhostLevel="0">' +
                        "".join(f'<Piece Source="{p.name}"/>' for p in pieces) +
                        f"</P{name}></VTKFile>")
        return path, pieces

    def test_pieces(self):
        whole = self.directory / "whole.vtp"
        files.write_vtp(whole, *files.drop_at(0))
        expected = self.succeed("--free-surface", source=whole)["statistics"]["triangles"]
        for kind, write in (("vtp", files.write_vtp), ("vtu", files.write_vtu)):
            for ghosts in (False, True):
                with self.subTest(kind, ghosts=ghosts):
                    path, _ = self.write_pieces(kind, write, ghosts)
                    found = self.succeed("--free-surface", source=path)["statistics"]
                    self.assertEqual(found["fluid_particles"], 1000)
                    self.assertEqual(found["triangles"], expected)

    def test_pieces_of_several_types(self):
        """An array in one piece as float, in another as double, with numbers that both hold."""
        path, pieces = self.write_pieces("vtp", files.write_vtp)
        expected = self.succeed("--scalar", "Radius", "--iso", "0.25", source=path)["statistics"]["triangles"]
        text = pieces[1].read_text()
        self.assertIn('"Float64" Name="Radius"', text)
        pieces[1].write_text(text.replace('"Float64" Name="Radius"', '"Float32" Name="Radius"'))
        found = self.succeed("--scalar", "Radius", "--iso", "0.25", source=path)["statistics"]["triangles"]
        self.assertEqual(found, expected)

    def test_range_that_vtk_cannot_read(self):
        """VTK writes inf as an array's range, if it is, and cannot read it; the numbers count."""
        files.write_vtp(self.input, *files.drop_at(0))
        text = self.input.read_text()
        key = ('<InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="2"><Value index="0">0</Value>'
               '<Value index="1">inf</Value></InformationKey></DataArray>')
        self.assertIn("</DataArray>", text)
        expected = self.succeed("--free-surface")["statistics"]["triangles"]
        self.input.write_text(text.replace("</DataArray>", key))
        self.assertEqual(self.succeed("--free-surface")["statistics"]["triangles"], expected)

    def test_damaged_pieces(self):
        path, pieces = self.write_pieces("vtp", files.write_vtp)
        pieces[1].write_text(pieces[1].read_text()[:2000])
        self.output.unlink(missing_ok=True)
        self.refuse(self.extract("--free-surface", source=path), 1, "piece1.vtp is not a complete")
        pieces[1].unlink()
        self.refuse(self.extract("--free-surface", source=path), 1, "piece1.vtp cannot be read: No such")
        path.write_text(path.read_text().replace("piece1.vtp", "particles.pvtp"))
        self.refuse(self.extract("--free-surface", source=path), 1, "is a list itself")
        path.write_text("<VTKFile><PPolyData/></VTKFile>")
        self.refuse(self.extract("--free-surface", source=path), 1, "it lists no pieces")

    def test_gadget(self):
        """Both binary formats, in both orders of bytes; several files are one snapshot. Gas alone, h half of GADGET's."""
        points, arrays = files.lattice(4)
        files.write_vtp(self.input, points, {name: arrays[name] for name in ("SmoothingLength", "Mass", "Density")})
        self.succeed("--free-surface", "--no-attributes")
        expected = re.search('Name="Points".*?</DataArray>', self.output.read_text(), re.DOTALL)[0]

        def write(name, chosen, order, named, count):
            def record(data):
                return struct.pack(order + "I", len(data)) + data + struct.pack(order + "I", len(data))

            def reals(values):
                return struct.pack(f"{order}{len(values)}d", *values)

            n, stars = len(chosen), 3
            header = struct.pack(order + "6i6d2d2i6I2i4d", n, 0, 0, 0, stars, 0, *[0] * 6, 0.25, 3, 0, 0, n, 0, 0, 0, stars, 0, 0,
                                 count, 8, 0.3, 0.7, 0.7)
            blocks = [("HEAD", header.ljust(256, b"\0")),
                      ("POS", reals([x for i in chosen for x in points[i]] + [9.0] * 3 * stars)),
                      ("VEL", reals([0.0] * 3 * (n + stars))), ("ID", struct.pack(f"{order}{n + stars}I", *range(n + stars))),
                      ("MASS", reals([arrays["Mass"][i] for i in chosen] + [1.0] * stars)), ("U", reals([1.0] * n)),
                      ("RHO", reals([arrays["Density"][i] for i in chosen])),
                      ("HSML", reals([2 * arrays["SmoothingLength"][i] for i in chosen]))]
            data = b""
            for label, block in blocks:
                data += record(label.ljust(4).encode() + struct.pack(order + "I", len(block) + 8)) if named else b""
                data += record(block)
            (self.directory / name).write_bytes(data)
            return self.directory / name

        whole = range(len(points))
        for order, named in (("<", False), (">", True), ("<", True), (">", False)):
            single = write("snapshot_003", whole, order, named, 1)
            write("snapshot_004.1", whole[40:], order, named, 2)
            for source in (single, write("snapshot_004.0", whole[:40], order, named, 2)):
                self.succeed("--free-surface", "--no-attributes", source=source)
                self.assertIn(expected, self.output.read_text())
        self.output.unlink()
        data = single.read_bytes()
        for size in (3, 7, 200, 500, 2000, len(data) - 1):
            single.write_bytes(data[:size])
            self.refuse(self.extract("--free-surface", source=single), 1, "snapshot_003")

    def test_vtkhdf(self):
        grid = HERE / "lattice.vtkhdf"
        result = self.extract("--free-surface", source=grid)
        if "without its reader" in result.stderr:
            self.skipTest("this VTK has no reader for it")
        points, arrays = files.lattice(3)
        files.write_vtp(self.input, points, arrays)

        def made(source):
            self.succeed("--free-surface", source=source)
            found = re.findall(r'<DataArray [^>]*Name="(\w+)"[^>]*>\s*(.*?)\s*</DataArray>', self.output.read_text(), re.DOTALL)
            return {name: text for name, text in found if name != "Kind"}  # of another type of integers there
        self.assertGreater(set(made(self.input)), {"Points", "Normals", "Velocity", "connectivity"})
        self.assertEqual(made(grid), made(self.input))  # to the last bit
        self.output.unlink()
        self.assertEqual(made(HERE / "lattice_poly.vtkhdf"), made(self.input))
        film = self.directory / "film.pvd"
        result = self.run_program(HERE / "film.vtkhdf", film, "--free-surface")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(re.findall('timestep="(.*?)"', film.read_text()), ["0", "0.5", "2"])
        for step, side in enumerate((3, 0, 2)):
            points, arrays = files.lattice(side) if side else ([], {})
            made_alone = ""
            if side:
                files.write_vtp(self.input, points, arrays)
                self.succeed("--free-surface", source=self.input)
                made_alone = re.search('Name="Points".*?</DataArray>', self.output.read_text(), re.DOTALL)[0]
            found = (self.directory / f"film_{step:04d}.vtp").read_text()
            self.assertIn(made_alone, found)
            self.assertEqual('NumberOfPoints="0"' in found, side == 0)
        self.output.unlink()
        self.refuse(self.extract("--free-surface", source=f"{HERE / 'film.vtkhdf'}#3"), 1, "it has no step 3")
        damaged = self.directory / "damaged.vtkhdf"
        self.output.unlink(missing_ok=True)
        data = grid.read_bytes()
        for bad in (data[:2000], data[:2002] + b"\xf5" + data[2003:]):  # HDF5 says more of the second when it ends
            damaged.write_bytes(bad)
            self.refuse(self.extract("--free-surface", source=damaged), 1, "damaged.vtkhdf cannot be read: ")
        for name in ("link", "storage", "virtual"):  # whether or not there is such a file
            self.refuse(self.extract("--free-surface", source=HERE / f"{name}.vtkhdf"), 1,
                        "its 'VTKHDF/PointData/Secret' lies in another file, which is not opened")


if __name__ == "__main__":
    main()
