# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests files as users have them: test_real_files.py PROGRAM PRELOAD."""
import json
import math
import re
import struct

import particle_files as files
from command_line_test import CommandLineTest, main, read_table, says

FREE = ["--free-surface", "--quiet"]
H = ["--smoothing-length", "0.13"]


def block(sides, spacing=0.1, origin=(0, 0, 0)):
    return [tuple(o + (i + 0.5) * spacing for o, i in zip(origin, place))
            for place in ((i, j, k) for k in range(sides[2]) for j in range(sides[1]) for i in range(sides[0]))]


def write_csv(path, points, arrays):
    """Writes a table as text, which may hold nan and inf. VTK cannot read these from a .vtp file of text."""
    columns = [[p[a] for p in points] for a in range(3)] + list(arrays.values())
    path.write_text(",".join(["x", "y", "z", *arrays]) + "\n" +
                    "\n".join(",".join(map(repr, row)) for row in zip(*columns)) + "\n")


class RealFiles(CommandLineTest):
    def refuse(self, result, status, sentence):
        """Tests that the run is refused with this status and sentence. The surface of an earlier run may be there."""
        self.one_sentence(result, status, sentence)

    def volume(self, source, *options, words=""):
        """Returns the volume, or in a plane the area, within the free surface. stderr must match `words`, or be empty
        if there are none."""
        self.statistics = self.succeed(*FREE, *options, source=source, told=words)["statistics"]
        return self.statistics.get("volume", self.statistics.get("area"))

    def levels(self, sources, *options, gauge="a=0.25,0.25,-1:0.25,0.25,2", words=None):
        table = self.directory / "levels.csv"
        self.run_good(*sources, table, "--quiet", "--gauge", gauge, *options, says=words or "^$")
        return [(float(row["time"]), row["state"], float(row["z"]) if row["state"] == "wet" else None)
                for row in read_table(table)]

    # ---- particles far from all others ----

    def test_far_particles(self):
        near = block((10, 10, 10))
        file = self.directory / "far.csv"
        write_csv(file, near, {"A": [1000.0] * len(near)})
        in_box = self.volume(file, *H, "--box", "-1,2,-1,2,-1,0.5")
        self.assertGreater(in_box, 0)
        expected = self.volume(file, *H)
        for far in ([(0.5, 0.5, -1e5)], [(3e5 * i, -1e5 * i, 1e6) for i in range(1, 9)]):
            write_csv(file, near + far, {"A": [1000.0] * len(near) + [math.nan] * len(far)})
            self.assertEqual(self.volume(file, *H, words=says(
                "PARTICLE_FAR" if len(far) == 1 else "PARTICLES_FAR", "particle 1000", re.escape(f"({far[0][0]:g},"),
                "--within", "--cube-size")), expected)
            self.assertEqual(self.statistics["fluid_particles"], 1000)
            (time, state, level), = self.levels([file], *H, gauge="a=0.5,0.5,-1:0.5,0.5,3")
            self.assertAlmostEqual(level, 1.0, delta=0.02)
        nine = [(1e6, 0.0, 1e6 + i) for i in range(9)]
        write_csv(file, near + nine, {})
        self.refuse(self.extract(*FREE, *H, source=file), 1, "far away from the rest")
        self.assertEqual(self.volume(file, *H, "--box", "-1,2,-1,2,-1,0.5"), in_box)
        self.assertEqual(self.volume(file, *H, "--within=-1,2,-1,2,-1,2"), expected)
        self.assertEqual(self.volume(file, *H, "--within", "-inf,2,-inf,inf,-inf,inf"), expected)

    def test_choice(self):
        near = block((10, 10, 10))
        file = self.directory / "kinds.csv"
        kinds = {"Kind": [i % 5 if i < 20 else 1 for i in range(1000)] + [7, 8, 3], "Level": [0.5] * 1000 + [9.0, 9.0, math.nan]}
        write_csv(file, near + [(5, 5, 5), (5.1, 5, 5), (math.nan, 0, 0)], kinds)
        self.refuse(self.extract(*FREE, *H, source=file), 1, "position of particle 1002 is not a number")
        expected = self.volume(file, *H, "--only", "Level=0.5")
        self.assertEqual(self.statistics["fluid_particles"], 1000)
        self.assertEqual(self.volume(file, *H, "--only", "Level=0:1"), expected)
        self.assertEqual(self.volume(file, *H, "--only", "Kind=0:2", "--only", "Kind=3:6", "--within", "0,2,0,2,0,2"), expected)
        self.volume(file, *H, "--only", "Kind=0:6", "--only", "Kind=8", "--only", "Level=0:10")
        self.assertEqual(self.statistics["fluid_particles"], 1001)
        components = self.directory / "pieces.csv"
        self.volume(file, *H, "--only", "Level=0:10", "--components", components)
        large, small = [int(row["particles"]) for row in read_table(components)]
        self.assertEqual((large > 900, small), (True, 2))
        self.volume(file, *H, "--only", "Kind=99", words="No particle is left by Kind=99, so there is no fluid")
        self.volume(file, *H, "--within", "0,0,0,0,0,0", words="No particle is within 0,0,0,0,0,0, so there is no fluid")
        words = "".join("O\n" if place[2] < 0.6 else "N\n" for place in near)  # Texts of particles that are vertices.
        file.with_suffix(".vtk").write_bytes(files.legacy(near, cells="VERTICES 1000 2000\n" + "".join(f"1 {i}\n" for i in range(1000))) +
                                             f"POINT_DATA 1000\nFIELD f 1\nspecies 1 1000 string\n{words}".encode())
        self.assertAlmostEqual(self.volume(file.with_suffix(".vtk"), *H, "--only", "species=O"), 0.6, delta=0.06)
        self.refuse_all(2, [(["Kind"], "needs NAME=VALUE or"), (["Kind=2:1"], "lower value first"), (["Kind=1:a"], "finite number")],
                        *FREE, *H, "--only", source=file)
        self.refuse_all(1, [(["Nothing=1"], "no point array 'Nothing' for the choice"), (["Kind=a"], "chooses a text, and the array has numbers")], *FREE, *H, "--only", source=file)

    # ---- films ----

    def write_tank(self, number, layers, time=None, name="TIME"):
        path = self.directory / f"tank_{number}.vtk"
        files.write_legacy(path, block((5, 5, layers)), {}, before="" if time is None else
                           f"FIELD FieldData 1\n{name} 1 1 double\n{time}\n")
        return path

    def test_order_and_times(self):
        for name in ["TIME", "TimeValue", "time"]:
            paths = [self.write_tank(n, 5 + n, 0.05 * n, name) for n in (2, 8, 9, 10, 11)]
            for order in (sorted(paths), paths[::-1]):
                levels = self.levels(order, *H)
                self.assertEqual([round(time, 9) for time, _, _ in levels], [0.1, 0.4, 0.45, 0.5, 0.55])
                heights = [level for _, _, level in levels]
                self.assertEqual(heights, sorted(heights))
                self.assertAlmostEqual(heights[0], 0.7, delta=0.02)
        # --time-step replaces the times in the files. If some files hold no time, a sentence says so.
        self.assertEqual([time for time, _, _ in self.levels(paths, *H, "--time-step", "0.5")], [0, 0.5, 1, 1.5, 2])
        self.write_tank(9, 14)
        self.assertEqual([time for time, _, _ in self.levels(paths, *H, words="missing in some")], [0, 1, 2, 3, 4])

    def test_times_in_xml(self):
        paths = []
        for number, kind in [(3, "ascii"), (12, "binary"), (7, "appended")]:
            path = self.directory / f"run_{number}.vtp"
            files.write_vtp(path, block((5, 5, 5)), {})
            value = {"ascii": f'format="ascii">{0.25 * number}', "appended": f'format="appended" RangeMin="{0.25 * number}" '
                     f'RangeMax="{0.25 * number}" offset="0">',
                     "binary": 'format="binary">CAAAAAAAAAAAAAhA'}[kind]  # These 8 bytes are the number 3.0.
            text = path.read_text().replace("<PolyData>", '<PolyData><FieldData><DataArray type="Float64" Name="TimeValue" '
                                            f'NumberOfTuples="1" {value}</DataArray></FieldData>')
            if kind == "appended":
                text = text.replace("</PolyData>", '</PolyData><AppendedData encoding="base64">_CAAAAAAAAAAAAPw/</AppendedData>')
            path.write_text(text)
            paths.append(path)
        self.assertEqual([time for time, _, _ in self.levels(paths, *H)], [0.75, 1.75, 3.0])

    def test_repeated_times(self):
        old, new, other = (self.directory / f"{name}.vtp" for name in ("old", "new", "other"))
        files.write_vtp(old, block((5, 5, 4)), {})
        files.write_vtp(new, block((5, 5, 6)), {})
        files.write_vtp(other, block((5, 5, 2), origin=(0, 0, 0.6)), {})
        pvd = self.directory / "run.pvd"

        def levels(entries, **options):
            pvd.write_text("<VTKFile><Collection>" + "".join(
                f'<DataSet timestep="{time}" {part} file="{file}"/>' for time, part, file in entries) + "</Collection></VTKFile>")
            return [round(level, 1) for _, _, level in self.levels([pvd], *H, **options)]

        part = ['part="0"', 'part="1"', ""]
        self.assertEqual(levels([(0, part[0], "old.vtp"), (1, part[0], "new.vtp"), (0, part[0], "new.vtp")],
                                words="lists 1 file of a time and a part that it had before, the first at time 0"), [0.6, 0.6])
        self.assertEqual(levels([(0, part[0], "old.vtp"), (0, part[0], "old.vtp"), (2, part[2], "new.vtp"),
                                 (2, part[2], "new.vtp")], words="lists 2 files"), [0.4, 0.6])
        for other_part in part[1:]:
            self.assertEqual(levels([(0, part[0], "new.vtp"), (0, other_part, "other.vtp")]), [0.8])

    def test_series(self):
        series = self.directory / "tank.vtk.series"
        names = {0.25: "tank_9.vtk", 0: "tank_2.vtk", 1e1: 't\u00e4nk "3".vtk'}
        self.write_tank(9, 9), self.write_tank(2, 4), self.write_tank(3, 6).rename(self.directory / 't\u00e4nk "3".vtk')
        series.write_text(json.dumps({"file-series-version": "1.0", "files": [
            {"name": name, "time": time} for time, name in names.items()]}, indent=1))
        self.assertEqual([(time, round(level, 1)) for time, _, level in self.levels([series], *H)], [(0, 0.4), (0.25, 0.9), (10, 0.6)])
        self.run_good(series, self.directory / "film.pvd", *FREE, *H)
        self.assertEqual(re.findall('timestep="(.*?)"', (self.directory / "film.pvd").read_text()), ["0", "0.25", "10"])
        self.refuse(self.run_program(series, series, self.directory / "film.pvd", *FREE, *H), 2, "a .pvd or .series file must be the only")
        self.refuse(self.run_program(self.input, self.directory / "film.series", *FREE, *H), 2, "the output is a")
        for bad in ("{", "[]", '{"files": [{"name": "a.vtk"}]}', '{"files": [{"name": "a.vtk", "time": "x"}]}', '{"files": []}',
                    '{"files": [{"name": "a.vtk", "time": 0}', "[" * 100000, '{"files'):
            series.write_text(bad)
            self.refuse(self.run_program(series, self.directory / "film.pvd", *FREE, *H), 1, "tank.vtk.series cannot be read: it is no series")

    def test_steps_without_fluid(self):
        paths = [self.write_tank(n, layers, 0.1 * n) for n, layers in enumerate([0, 5, 0])]
        self.assertEqual([state for _, state, _ in self.levels(paths, *H)], ["dry", "wet", "dry"])
        numbers = self.directory / "numbers.csv"
        self.run_good(*paths, self.directory / "film.pvd", *FREE, *H, "--numbers", numbers, "--gauge",
                      "a=0.25,0.25,-1:0.25,0.25,2", says=".*")
        self.assertEqual((self.directory / "film.pvd").read_text().count("<DataSet"), 3)
        rows = read_table(numbers)
        self.assertEqual([float(row["volume"]) > 0 for row in rows], [False, True, False])
        self.assertEqual([float(row["volume"]) for row in rows][::2], [0, 0])
        self.assertEqual([float(row["a.depth"]) > 0 for row in rows], [False, True, False])

    # ---- particles among meshes ----

    def test_pieces_of_meshes(self):
        """If any piece of a file has vertices, points of a piece with only other cells are no particles. If no piece has vertices, all
        points are particles. Points of a piece without cells are always particles."""
        tank, corners = block((6, 6, 6)), block((2, 2, 2), 5, (9, 9, 9))
        files.write_vtu(self.directory / "water.vtu", tank, {})
        files.write_vtu(self.directory / "hull.vtu", corners, {}, [(12, range(8))])
        files.write_vtu(self.directory / "spray.vtu", [(3, 3, 3)], {}, [])
        names = {"all.pvtu": ["hull", "water", "spray"], "hull.pvtu": ["hull", "spray"]}
        for name, pieces in names.items():
            files.write_pieces(self.directory / name, [f"{piece}.vtu" for piece in pieces])
        files.write_pvd(self.directory / "all.pvd", [(0, self.directory / f"{piece}.vtu") for piece in names["all.pvtu"]])
        for name, count in (("all.pvtu", 217), ("hull.pvtu", 9), ("hull.vtu", 8)):
            listed = self.run_program("--list-arrays", self.directory / name)
            self.assertRegex(listed.stdout, f"particles         {count}\n")
            self.assertEqual("8 of 8 points of" in listed.stderr, count == 217)
        levels = self.levels([self.directory / "all.pvd"], *H, words="8 of 8 points of")
        self.assertEqual([round(level, 1) for _, _, level in levels], [0.6])

    # ---- vectors of two components ----

    def test_vectors_in_a_plane(self):
        for normal in range(3):
            axes = [a for a in range(3) if a != normal]
            flat = [(0.1 * i, 0.1 * j) for j in range(12) for i in range(12)]
            points = []
            for p in flat:
                x = [0.0] * 3
                x[axes[0]], x[axes[1]], x[normal] = p[0], p[1], 0.5
                points.append(tuple(x))
            file = self.directory / "plane.vtu"
            files.write_vtu(file, points, {"velocity": [(-2 * y, 2 * x) for x, y in flat], "index": list(range(len(flat))),
                                           "particle_spacing": [0.1] * len(flat)})
            low, high = self.succeed("--derive", "velocity", "--scalar", "Vorticity", "--component", str(normal), "--iso", "4",
                                     *H, source=file, told="(?s).*")["statistics"]["scalar_range"]
            for value in (low, high):
                self.assertAlmostEqual(abs(value), 4, delta=1e-5)
            self.assertEqual(low > 0, normal != 1)  # With x and z as axes around y, the sense of rotation is reversed.
            low, high = self.succeed("--derive", "velocity", "--scalar", "Divergence", "--iso", "1", *H, source=file,
                                     told="(?s).*")["statistics"]["scalar_range"]
            self.assertLess(max(abs(low), abs(high)), 1e-5)
        self.assertRegex(self.run_program("--list-arrays", file).stdout, "velocity          velocity\n")
        self.refuse(self.extract("--free-surface", source=file), 1,
                    "By 'particle_spacing', particles are 0.1 apart: 0.13 is usual. ")

    # ---- coordinates that are too coarse, periods that are too short, thresholds ----

    def test_coarse_coordinates(self):
        single = lambda x: struct.unpack("f", struct.pack("f", x))[0]
        file = self.directory / "map.vtp"
        for (x0, y0, z0), spacing, words in (((500000, 5000000, 0), 0.1, "y to steps of 0.5"), ((0, 0, -3e6), 0.1, "z to steps of 0.25"),
                                             ((11.5, 48.1, 300), 2e-6, "z to steps of 3.05.*e-05")):
            points = [(x0 + x, y0 + y, z0 + z) for x, y, z in block((10, 10, 10), spacing)]
            how = ["--smoothing-length", str(1.3 * spacing)]
            files.write_vtp(file, [tuple(map(single, p)) for p in points], {})
            self.volume(file, *how, words="positions are too coarse: .* rounds " + words)
            self.assertNotRegex(self.said, "plane|neither")
            files.write_vtp(file, points, {})
            self.assertGreater(self.volume(file, *how) / (10 * spacing) ** 3, 0.9)

    def test_short_period(self):
        file = self.directory / "long.vtp"
        points = block((20, 10, 10))
        files.write_vtp(file, points, {"A": [p[0] for p in points]})
        self.volume(file, *H, "--periodic", "2,1,1", words="empty")
        self.volume(file, *H, "--periodic", "1.5,0,0", words="extend over 1.9 along x, farther than the period 1.5")
        self.levels([file], *H, "--periodic", "1.5,0,0", words="extend over 1.9 along x", gauge="a=1,0.5,-1:1,0.5,2")
    # ---- tables ----

    def check_table(self, name, text, volume=0.216, **options):
        file = self.directory / name
        file.write_text(text)
        self.assertAlmostEqual(self.volume(file, *H, **options), volume, delta=0.18 * volume)
        return file

    def test_csv(self):
        """Columns of a table become vectors and arrays of whole numbers, which may be contoured and are carried to the surface.
        The test wheel.tables compares the program with Python's reader."""
        paraview = "\n".join(['"Density","Vel:0","Vel:1","Vel:2","Points:0","Points:1","Points:2","Point ID"'] + [
            f"1000,{p[0]},{2 * p[1]},0,{p[0]},{p[1]},{p[2]},{i}" for i, p in enumerate(block((6, 6, 6)))])
        file = self.check_table("paraview.csv", paraview)
        surface = self.output.read_text()
        self.assertIn('Name="Vel" NumberOfComponents="3"', surface)
        self.assertRegex(surface, 'type="Int64"[^>]*Name="Point ID"')
        self.extract_good("--scalar", "Vel", "--component", "0", "--iso", "0.3", *H, "--quiet", source=file)
        for text, sentence in ("x,y,z\nnan,0,0\n", "not a number"), ("x,y,z\r1,2,3\r", "carriage returns alone; save it with line feeds"):
            file.write_bytes(text.encode())
            self.refuse(self.extract(*FREE, *H, source=file), 1, sentence)

    def test_xyz(self):
        points = block((6, 6, 6))
        header = ('Lattice="2 0 0 0 2 0 0 0 2" Properties=species:S:1:pos:R:3:vel:R:3:id:I:1 Time=0.5 pbc="T F F"')
        body = "\n".join(f"H {x} {y} {z} {x} 0 0 {i}" for i, (x, y, z) in enumerate(points))
        file = self.check_table("extended.extxyz", f"216\n{header}\n{body}\n", words="period .0,2,0,0,0,0.")
        self.extract_good("--scalar", "vel", "--component", "0", "--iso", "0.3", *H, "--quiet", "--periodic", "auto",
                          source=file)
        steps = "".join(f"{25 * n}\nTime={0.1 * n}\n" + "".join(f"A {x} {y} {z}\n" for x, y, z in block((5, 5, n)))
                        for n in (4, 6, 9))
        two = self.directory / "two.xyz"  # The file holds water and air, which a column of text tells apart.
        both = [("O", *p) for p in points] + [("N", x, y, z + 3) for x, y, z in points] + [("H", x, y, z + 6) for x, y, z in points]
        two.write_text(f"{len(both)}\n\n" + "".join("%s %r %r %r\n" % row for row in both))
        for words, volume in (("O",), 0.216), (("O", "H"), 0.432), (("X",), None):
            numbers = self.directory / "numbers.csv"
            self.run_good(two, "film.pvd", "--free-surface", *H, "--quiet", "--numbers", numbers, *[w for word in words for w in ("--only", f"species={word}")],
                          says="^$" if volume else "No particle is left")
            row, = read_table(numbers)
            self.assertAlmostEqual(float(row["volume"]), volume or 0, delta=0.06)
        self.assertNotIn('"species"', (self.directory / "film_0000.vtp").read_text())
        self.one_sentence(self.extract("--free-surface", *H, "--only", "x=O", source=file), 1, "no point array 'x'")
        self.one_sentence(self.extract("--free-surface", *H, "--only", "id=O", source=file), 1, "--only id=O chooses a text, and the array has numbers")
        film = self.directory / "film.xyz"
        film.write_text(steps)
        self.assertEqual([(round(t, 9), round(level, 1)) for t, _, level in self.levels([film], *H)],
                         [(0.4, 0.4), (0.6, 0.6), (0.9, 0.9)])
        film.write_text(steps + "25\n")
        self.one_sentence(self.run_program(film, "levels.csv", "--quiet", "--gauge", "a=0.25,0.25,-1:0.25,0.25,2", *H), 1,
                          "film.xyz#3: .*film.xyz cannot be read: it ends before the second line of a step")
        self.assertEqual(len(read_table(self.directory / "levels.csv")), 3)

    def test_lammps(self):
        def step(number, layers):
            points = block((5, 5, layers))
            return (f"ITEM: TIMESTEP\n{number}\nITEM: NUMBER OF ATOMS\n{len(points)}\nITEM: BOX BOUNDS pp ff ff\n-1 1\n0 2\n0 4\n"
                    "ITEM: ATOMS id type x y z vx\n" + "".join(f"{i + 1} 1 {x} {y} {z} {10 * i}\n" for i, (x, y, z) in enumerate(points)))

        self.check_table("one.lammpstrj", step(100, 5), volume=0.125, words="period .-1,1,0,0,0,0.")
        film = self.directory / "film.dump"
        film.write_text("".join(step(100 * n, n) for n in (4, 6, 9)))
        self.assertEqual([(t, round(level, 1)) for t, _, level in self.levels([film], *H)],
                         [(400, 0.4), (600, 0.6), (900, 0.9)])
        begun = film.read_text()
        for cut in ("ITEM: TIMESTEP\n", "ITEM: TIMESTEP\n9", step(1200, 2).split("ITEM: BOX")[0], step(1200, 2)[:110],
                    step(1200, 2).split("pp")[0] + "\n", "nonsense"):
            film.write_text(begun + cut)
            result = self.run_program(film, "levels.csv", "--quiet", "--gauge", "a=0.25,0.25,-1:0.25,0.25,2", *H)
            self.one_sentence(result, 1, r"film.dump#3: .*film.dump cannot be read: (it ends before|line \d+ is no item)")
            self.assertEqual([float(row["time"]) for row in read_table(self.directory / "levels.csv")], [400, 600, 900])
        result = self.run_program(film, "film.pvd", *FREE, *H, "--periodic", "0,0,0")
        self.one_sentence(result, 1, r"film_0003.vtp \(time 1200\): .*film.dump cannot be read: line \d+ is no item")
        self.assertTrue((self.directory / "film_0002.vtp").exists())


if __name__ == "__main__":
    main()
