# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests file formats of the program marching-correctors: test_formats.py PROGRAM PRELOAD."""
import pathlib
import re
import struct

import particle_files as files
from command_line_test import CommandLineTest, main

HERE = pathlib.Path(__file__).resolve().parent


class Formats(CommandLineTest):
    """Tests surfaces as .stl, .ply and .obj, and particles from .pvtp, .pvtu and .vtkhdf."""

    def extract_as(self, ending, *options):
        self.output = self.directory / ("surface" + ending)
        self.extract_good("--free-surface", "--quiet", *options, says=".*")
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

    def read_ply(self, *options):
        """Makes a .ply file and tests its triangles. Returns its points, each a dictionary from property to value."""
        head, body = self.extract_as(".ply", *options).split(b"end_header\n", 1)
        points, triangles = map(int, re.findall(rb"element \w+ (\d+)", head))
        properties = [line.split()[1:] for line in head.decode().split("element face")[0].splitlines() if line[:8] == "property"]
        row = struct.Struct("<" + "".join({"float": "f", "double": "d", "uchar": "B"}[kind] for kind, _ in properties))
        self.assertEqual(len(body), row.size * points + 13 * triangles)
        cells = list(struct.iter_unpack("<B3i", body[row.size * points:]))
        self.assertTrue(all(n == 3 and len(set(corners)) == 3 and min(corners) >= 0 and max(corners) < points for n, *corners in cells))
        self.assertGreater(points, 100)
        return [{name: value for (_, name), value in zip(properties, values)} for values in row.iter_unpack(body[:row.size * points])]

    def test_ply(self):
        points, _ = self.counts()
        found = self.read_ply("--output-precision", "single", "--no-attributes")
        self.assertEqual(len(found), points)
        for point in found:
            self.assertEqual(list(point), ["x", "y", "z", "nx", "ny", "nz"])
            self.assertAlmostEqual(sum(point["n" + axis] ** 2 for axis in "xyz"), 1, delta=1e-5)
            self.assertGreater(sum(point[axis] * point["n" + axis] for axis in "xyz"), 0)

    def test_ply_arrays(self):
        """Properties in a .ply file have the types of the arrays in a .vtp file. If an array's name is already used, the property gets
        another name."""
        self.arrays.update({"x": [1.5] * len(self.points), "a b": list(range(len(self.points)))})
        files.write_vtp(self.input, self.points, self.arrays)
        for point in self.read_ply():
            self.assertEqual(list(point)[:6], ["x", "y", "z", "nx", "ny", "nz"])
            self.assertTrue({"Velocity_x", "Velocity_y", "Velocity_z", "x_", "a_b"} < set(point), point)
            self.assertNotIn("IsoValue", point)
            self.assertAlmostEqual(point["x_"], 1.5)
            for axis in "xyz":  # The velocity equals the position; at the surface the mean has particles on one side only.
                self.assertAlmostEqual(point["Velocity_" + axis], point[axis], delta=0.1)
        self.assertIn(b"property double IsoValue\n", self.extract_as(".ply", "--iso", "0.4,0.5").split(b"end_header")[0])

    def test_obj(self):
        points, triangles = self.counts()
        lines = self.extract_as(".obj").decode().splitlines()
        kinds = [line.split(" ", 1)[0] for line in lines]
        self.assertEqual([kinds.count(k) for k in ("v", "vn", "f")], [points, points, triangles])
        self.assertTrue(all(re.fullmatch(r"f (\d+)//\1 (\d+)//\2 (\d+)//\3", x) for x in lines if x[0] == "f"))
        xs = [float(line.split()[1]) for line in lines if line[:2] == "v "]
        self.assertLess(abs(min(xs) + max(xs)), 1e-3)

    def test_obj_digits(self):
        """An .obj file has nine digits, so that every float is read back exactly."""
        self.points = [(1e-3 * x + 1.0, y, z) for x, y, z in self.points]
        files.write_vtp(self.input, self.points, self.arrays)
        self.extract_as(".obj", "--output-precision", "single")
        found = [tuple(map(float, line.split()[1:])) for line in self.output.read_text().splitlines() if line[:2] == "v "]
        points = self.read_ply("--output-precision", "single", "--no-attributes")
        single = struct.Struct("3f")
        self.assertEqual([single.unpack(single.pack(*place)) for place in found], [(p["x"], p["y"], p["z"]) for p in points])

    def test_colors(self):
        """In a .ply file the array of --color-by gives the points' colours. For formats without arrays, a warning names the
        arrays that are left out."""
        points = self.read_ply("--color-by", "Velocity", "--color-range", "0.46,0.7", "--attributes", "Velocity", "--output-precision", "single")
        self.assertGreater(set(points[0]), {"red", "green", "blue"})
        # The speed is nearly the distance from the centre, and the colours' green grows with the speed.
        speeds = sorted((p["x"] ** 2 + p["y"] ** 2 + p["z"] ** 2, p["green"]) for p in points)
        self.assertLess(speeds[0][1], 100)
        self.assertEqual(speeds[-1][1], 247)  # Values beyond the range have the last colour.
        for ending, hint in ((".obj", "--no-attributes"), (".stl", ".vtp keeps all, .ply those of numbers")):
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
        """Writes particles.p<kind> and its three pieces, the last one empty. ghosts: the first has ghosts, too. Returns the paths."""
        pieces = []
        for i, numbers in enumerate((range(0, 600 if ghosts else 500), range(500, 1000), [])):
            path = self.directory / f"piece{i}.{kind}"
            points, arrays = files.drop_at(0, numbers=list(numbers))
            if ghosts:
                arrays["vtkGhostType"] = [int(n >= 500 and i == 0) for n in numbers]
            write(path, points, arrays)
            path.write_text(path.read_text().replace('"Float64" Name="vtkGhostType"', '"UInt8" Name="vtkGhostType"'))
            pieces.append(path)
        path = self.directory / f"particles.p{kind}"
        files.write_pieces(path, [piece.name for piece in pieces])
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
        """If one piece stores an array as float, and the other as double, the surface has as many triangles as if
        both store doubles."""
        path, pieces = self.write_pieces("vtp", files.write_vtp)
        expected = self.succeed("--scalar", "Radius", "--iso", "0.25", source=path)["statistics"]["triangles"]
        text = pieces[1].read_text()
        self.assertIn('"Float64" Name="Radius"', text)
        pieces[1].write_text(text.replace('"Float64" Name="Radius"', '"Float32" Name="Radius"'))
        found = self.succeed("--scalar", "Radius", "--iso", "0.25", source=path)["statistics"]["triangles"]
        self.assertEqual(found, expected)

    def test_range_that_vtk_cannot_read(self):
        """VTK writes inf as the range of an array that holds inf, but cannot read it back. The program ignores this range and reads the numbers."""
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
        """Tests GADGET's two binary formats in both byte orders. Several files are one snapshot. Only gas is read, and h is half of the
        length in GADGET's file."""
        points, arrays = files.lattice(4)
        files.write_vtp(self.input, points, {name: arrays[name] for name in ("SmoothingLength", "Mass", "Density")})
        self.succeed("--free-surface", "--no-attributes")
        expected = re.search('Name="Points".*?</DataArray>', self.output.read_text(), re.DOTALL)[0]

        def write(name, *how):
            files.write_gadget(self.directory / name, points, arrays, *how)
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
            return {name: text for name, text in found if name != "Kind"}  # Kind has another integer type in the grid's file.
        self.assertGreater(set(made(self.input)), {"Points", "Normals", "Velocity", "connectivity"})
        self.assertEqual(made(grid), made(self.input))  # Both surfaces have the same bits.
        self.output.unlink()
        self.assertEqual(made(HERE / "lattice_poly.vtkhdf"), made(self.input))
        film = self.directory / "film.pvd"
        self.run_good(HERE / "film.vtkhdf", film, "--free-surface", says=".*")
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
        table = self.directory / "table.csv"
        table.write_text("x,y,z\n1,2,3\n")
        for source in (HERE / "film.vtkhdf", HERE / "lattice.vtkhdf", HERE / "lattice_poly.vtkhdf", self.input, table):
            self.refuse(self.extract("--free-surface", source=f"{source}#3"), 1, "it has no step 3")
        damaged = self.directory / "damaged.vtkhdf"
        self.output.unlink(missing_ok=True)
        data = grid.read_bytes()
        for bad in (data[:2000], data[:2002] + b"\xf5" + data[2003:]):  # With the second file HDF5 prints more when the program ends.
            damaged.write_bytes(bad)
            self.refuse(self.extract("--free-surface", source=damaged), 1, "damaged.vtkhdf cannot be read: ")
        size = struct.pack("<BBB5xQQ", 1, 1, 1, 3, 3)  # of a data set of three values; the file's last one has offsets of an array's steps
        data = (HERE / "film.vtkhdf").read_bytes()
        at = data.rindex(size)
        damaged.write_bytes(data[:at] + struct.pack("<BBB5xQQ", 1, 1, 1, 1, 3) + data[at + len(size):])
        self.refuse(self.extract("--free-surface", source=f"{damaged}#2"), 1, "it has no step 2 in 'Steps/PointDataOffsets/")
        for name in ("link", "storage", "virtual"):  # The file is refused whether or not the file that it points to exists.
            self.refuse(self.extract("--free-surface", source=HERE / f"{name}.vtkhdf"), 1,
                        "its 'VTKHDF/PointData/Secret' lies in another file, which is not opened")


if __name__ == "__main__":
    main()
