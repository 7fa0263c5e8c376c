# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Fluxes by the program marching-correctors: test_flux.py PROGRAM PRELOAD."""
import math

import particle_files as files
from command_line_test import CommandLineTest, main, read_table

COLUMNS = ["time", "section", "area", "volume_flux", "mass_flux", "velocity", "volume", "mass"]
WALL = "wall=0.1,-.2,-.2:0.1,.2,-.2:0.1,-.2,.3"
CUBE = [(-.2, -.2, -.2), (.2, -.2, -.2), (.2, .2, -.2), (-.2, .2, -.2),
        (-.2, -.2, .2), (.2, -.2, .2), (.2, .2, .2), (-.2, .2, .2)]
SIDES = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6), (0, 5, 1), (0, 4, 5), (1, 6, 2), (1, 5, 6), (2, 7, 3), (2, 6, 7),
         (3, 4, 0), (3, 7, 4)]  # normals inwards, which are turned


class Flux(CommandLineTest):
    """A block of particles with the sides 1 around the origin, which moves by (1, -2, 3) and as one."""

    def setUp(self):
        super().setUp()
        self.table = self.directory / "flux.csv"
        self.write("moving.vtp")

    def write(self, name, **more):
        files.write_vtp(self.directory / name, self.points, {**self.arrays, "Velocity": [(1.0, -2.0, 3.0)] * 1000, **more})

    def rows(self, *options, source="moving.vtp"):
        self.run_good(source, self.table, *options)
        rows = read_table(self.table)
        self.assertEqual(list(rows[0]), COLUMNS)
        return [{name: value if name == "section" else float(value or "nan") for name, value in row.items()} for row in rows]

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
        """The velocity is the position: 3 times the volume flows out of a closed file, whatever its triangles' normals."""
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
        """The volume of fluid in a box, as of the capped surface, grows by what flows in through its sides."""
        self.write_rising_steps(3, 0.06, step=0.2, Velocity=[(0.0, 0.0, 0.3)] * 1000, Id=list(range(1000)))
        rows = self.rows("--flux", "box=box:-1,1,-1,1,.3,1", "--flux", WALL, source="steps.pvd")
        self.assertEqual([(row["time"], row["section"]) for row in rows],
                         [(0.2 * i, name) for i in range(3) for name in ("box", "wall")])
        box = rows[::2]
        self.assertEqual((box[0]["volume"], box[0]["mass"]), (0, 0))
        self.assertAlmostEqual(box[1]["volume"], 0.1 * (box[0]["volume_flux"] + box[1]["volume_flux"]), delta=1e-12)
        volumes = []
        for i in range(3):
            run = self.succeed("--free-surface", "--box=-1,1,-1,1,.3,1", "--capping", "--cube-size", "0.02", source=f"step_{i}.vtp")
            volumes.append(run["statistics"]["volume"])
        for i in (1, 2):
            self.assertAlmostEqual(-box[i]["volume"] / (volumes[i] - volumes[0]), 1, delta=0.01)
            self.assertAlmostEqual(box[i]["mass"], 1000 * box[i]["volume"], delta=1e-3)
        times = self.rows("--flux", "box=box:-1,1,-1,1,.3,1", "--times", "0,0.1,0.4", source="steps.pvd")
        self.assertEqual([row["time"] for row in times], [0, 0.1, 0.4])

    def test_plane(self):
        points = [(0.1 * i, 0.1 * j, 0.0) for i in range(12) for j in range(12)]
        files.write_vtp(self.directory / "plane.vtp", points, {
            "SmoothingLength": [0.13] * 144, "Volume": [0.01] * 144, "Velocity": [(1.0, -2.0, 0.0)] * 144})
        rows = self.rows("--flux", "up=.5,.3,0:.5,.7,0", "--flux", "box=box:.3,.7,.4,.6,-1,1", source="plane.vtp")
        for row, area, flux in zip(rows, (0.4, 1.2), (0.4, 0)):
            self.assertAlmostEqual(row["area"], area, delta=1e-6)
            self.assertAlmostEqual(row["volume_flux"], flux, delta=1e-6)

    def test_outside(self):
        result = self.run_program("moving.vtp", self.table, "--flux", WALL, "--flux", "far=9,0,0:9,1,0:9,0,1")
        self.one_sentence(result, 0, "warning: .*'far' is outside of all fluid")

    def test_wrong_usage(self):
        self.table.write_text("as it was")
        form = "--flux needs a section with a name, NAME=X,Y,Z:X,Y,Z:X,Y,Z, NAME=disc:.* not "
        usage = [(["--flux", "wall=0,0,0:0,0"], form + "'wall=0,0,0:0,0'"), (["--flux", "wall"], form), (["--flux", "=box:1"], form),
                 (["--flux", "a=disc:0,0,0:0,0,1"], form), (["--flux", "a=box:0,1,0,1"], form), (["--flux", "a=0,0,nan:0,0,1:1,1,1"], form),
                 (["--flux", WALL, "--flux", WALL], "two sections have the name 'wall'"),
                 (["--flux", "+a=box:0,1,0,1,0,1"], "'.a' begins with '.', so that spreadsheets"),
                 (["--flux", WALL, "--scalar", "Radius"], "leave out --scalar"),
                 (["--flux", WALL, "--gauge", "a=0,0,0:0,0,1"], "leave out --gauge"),
                 (["--flux", WALL, "--iso", "0.2,0.5"], "all but one --iso value"),
                 (["--flux", WALL, "--iso", "0"], "--iso value above 0"),
                 (["--flux", WALL, "--solids", "wall"], "leave out --solids wall"),
                 (["--flux", WALL, "--times", "1"], "--times: 1 is outside")]
        failures = [(["--fluxes", "none.txt"], "the sections' file none.txt cannot be read"),
                    (["--fluxes", "/dev/zero"], "/dev/zero is larger than 64 MiB"),
                    (["--flux", "a=none.stl"], "none.stl"), (["--flux", "a=moving.vtp"], "Section 'a' has 0 points|no triangles"),
                    (["--flux", "a=0,0,0:1e30,0,0:0,1,0"], "Section 'a' needs .* cells"),
                    (["--flux", WALL, "--velocity", "Drift"], "There is no point array 'Drift' for the velocity")]
        for status, cases in ((2, usage), (1, failures)):
            for options, sentence in cases:
                with self.subTest(options=options):
                    self.one_sentence(self.run_program("moving.vtp", self.table, *options), status, sentence)
        self.one_sentence(self.run_program("moving.vtp", "flux.vtp", "--flux", WALL), 2, "the output of --flux is a .csv file")
        self.assertEqual(self.table.read_text(), "as it was")
        del self.arrays["Velocity"]
        files.write_vtp(self.directory / "still.vtp", self.points, self.arrays)
        self.one_sentence(self.run_program("still.vtp", self.table, "--flux", WALL), 1, "no velocity.*--velocity")


if __name__ == "__main__":
    main()
