# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests --walls, walls in files of their own: test_walls.py PROGRAM PRELOAD."""
import particle_files as files
from command_line_test import CommandLineTest, main

HOW = ["--scalar", "Radius", "--iso", "0.3", "--no-attributes"]
WRITERS = {".vtp": files.write_vtp, ".vtu": files.write_vtu, ".vtk": files.write_legacy}


class Walls(CommandLineTest):
    """Compares surfaces: fluid (Kind 0) and walls (Kind 1) are in separate files, or in one file with --fluid."""

    def setUp(self):
        super().setUp()
        self.fluid = self.write("WaterBody_3.vtp", lambda kind, point: kind == 0)
        self.wall = self.write("WallBoundary_0.vtp", lambda kind, point: kind == 1)

    def write(self, name, chosen, without=()):
        path = self.directory / name
        points, arrays = self.chosen(lambda i: chosen(self.arrays["Kind"][i], self.points[i]))
        WRITERS[path.suffix](path, points, {array: values for array, values in arrays.items() if array not in without})
        return path

    def surface(self, *options, source=None):
        self.succeed(*options, source=source)
        return self.output.read_bytes()

    def test_surfaces(self):
        alone = self.surface(*HOW, source=self.fluid)
        for how, more in ((HOW, []), (HOW, ["--solids", "weight"]), (HOW, ["--gradients"]),
                          (HOW[:4], ["--solids", "wall", "--derive", "Velocity", "--attributes", "Divergence"])):
            wanted = self.surface(*how, *more, "--fluid", "Kind=0")
            found = self.surface(*how, *more, "--walls", self.wall, source=self.fluid)
            self.assertEqual(found, wanted, more)
            self.assertNotEqual(found, alone)
        free = ["--free-surface", "--no-attributes"]
        self.assertEqual(self.surface(*free, "--walls", self.wall, source=self.fluid),
                         self.surface(*free, "--fluid", "Kind=0"))

    def test_several_bodies(self):
        """Walls may come in several formats and in any order. Arrays that walls lack get the fluid's median. Of these arrays only the
        smoothing length, the mass and the density matter here, and each is the same for all particles."""
        wanted = self.surface(*HOW, "--fluid", "Kind=0")
        lacking = ["Density", "Velocity", "SmoothingLength", "Mass", "Radius"]
        low = self.write("Left.vtu", lambda kind, point: kind == 1 and point[1] < 0, lacking[:2])
        high = self.write("Right.vtk", lambda kind, point: kind == 1 and point[1] >= 0, lacking)
        for order in ((low, high), (high, low)):
            walls = [word for path in order for word in ("--walls", path)]
            self.assertEqual(self.surface(*HOW, *walls, source=self.fluid), wanted)

    def test_attributes_and_statistics(self):
        statistics = self.succeed(*HOW[:4], "--walls", self.wall, source=self.fluid)
        self.assertEqual(statistics["walls"], [str(self.wall)])
        self.assertEqual((statistics["statistics"]["fluid_particles"], statistics["statistics"]["solid_particles"]),
                         (self.arrays["Kind"].count(0), self.arrays["Kind"].count(1)))
        text = self.output.read_text()
        self.assertIn('Name="Velocity"', text)
        self.assertNotIn("IsWall", text)

    def test_film(self):
        """Each body counts its particles from 0, so walls and fluid have the same ids. Steps are interpolated all the same."""
        numbers = {0: 0, 1: 0}
        self.arrays["Idp"] = []
        for kind in self.arrays["Kind"]:
            self.arrays["Idp"].append(float(numbers[kind]))
            numbers[kind] += 1
        still = ["Velocity"]
        self.fluid = self.write(self.fluid.name, lambda kind, point: kind == 0, still)
        self.wall = self.write(self.wall.name, lambda kind, point: kind == 1, still)
        frame = [self.directory / f"surface_{i:04d}.vtp" for i in range(3)]
        wanted = self.surface(*HOW, "--fluid", "Kind=0")
        self.run_good(self.fluid, self.fluid, self.directory / "surface_%04d.vtp", *HOW, "--walls", self.wall,
                      "--times", "0,0.5,1")
        self.assertEqual([path.read_bytes() for path in frame], [wanted] * 3)

    def test_walls_of_each_step(self):
        """The walls of each step are found by the number in the file's name, or by a list. Walls in a single file stand still."""
        steps, wanted = (0, 12), []
        still = self.write("Still.vtp", lambda kind, point: kind == 1 and point[1] < 0)
        for step, fluid in zip(steps, ("Fluid_0000.vtp", "Fluid_0012.vtp")):
            self.write(fluid, lambda kind, point: kind == 0)
            self.write(f"Paddle_{step}.vtp", lambda kind, point: kind == 1 and point[1] >= (0 if step == 0 else 0.15))
            options = [word for path in (still, self.directory / f"Paddle_{step}.vtp") for word in ("--walls", path)]
            wanted.append(self.surface(*HOW, *options, source=self.fluid))
        self.assertNotEqual(*wanted)
        films = {name: self.directory / f"{name}.pvd" for name in ("fluid", "paddle", "late")}
        for name, path in films.items():
            files.write_pvd(path, [(0.5 * i + (name == "late"), f"Fluid_{step:04d}.vtp" if name == "fluid" else
                                           f"Paddle_{step}.vtp") for i, step in enumerate(steps)])
        fluids = [self.directory / f"Fluid_{step:04d}.vtp" for step in steps]
        numbered = self.directory / "Paddle_%d.vtp"
        frames = [self.directory / f"surface_{i:04d}.vtp" for i in range(2)]
        film = self.directory / "surface_%04d.vtp"
        for inputs, walls in ((fluids, numbered), (fluids, films["late"]), ([films["fluid"]], numbered),
                              ([films["fluid"]], films["paddle"])):
            self.run_good(*inputs, film, *HOW, "--walls", still, "--walls", walls)
            self.assertEqual([path.read_bytes() for path in frames], wanted)
        for path in (self.output, *frames):
            path.unlink()
        cases = ((1, "late.pvd has no walls at the time of .*Fluid_0000", [films["fluid"], film], films["late"]),
                 (1, "paddle.pvd lists 2 times, and there are 1 steps", [self.fluid, film], films["paddle"]),
                 (1, "needs the number of each step, but the name .*none", [self.write("Fluid.vtp", lambda kind, point: True), film],
                  numbered),
                 (1, "Paddle_3.vtp cannot be read", [self.fluid, film], numbered),
                 (2, "0.25 is between two steps, where walls", [films["fluid"], film, "--times", "0,0.25"], numbered),
                 (2, "Paddle_0.vtp would overwrite the input", [*fluids, self.directory / "Paddle_%d.vtp"], films["paddle"]),
                 (2, "has walls for each step", [self.fluid, self.output], numbered))
        for status, sentence, places, walls in cases:
            self.refuse(self.run_program(*places, *HOW, "--walls", walls), status, sentence)

    def test_slice_and_gauge(self):
        for name, options in (("surface.vti", ["--slice", "z=0.01", "--resolution", "40"]),
                              ("surface.csv", ["--gauge", "a=0.31,0,-1:0.31,0,1"])):
            output, found = self.directory / name, []
            for source, walls in ((self.input, ["--fluid", "Kind=0"]), (self.fluid, ["--walls", self.wall]),
                                  (self.input, [])):
                self.run_good(source, output, *options, *walls, "--quiet", "--no-attributes"
                              if name.endswith("i") else "--quiet")
                found.append(output.read_bytes().replace(bytes(source.name, "ascii"), b""))
            self.assertEqual(found[0], found[1])
            self.assertNotEqual(found[0], found[2])

    def test_mistakes(self):
        there = list(self.directory.iterdir())
        self.refuse(self.extract(*HOW, "--walls", "nowhere.vtp", source=self.fluid), 1, "nowhere.vtp cannot be read: No such file")
        self.refuse(self.extract(*HOW, "--walls", source=self.fluid), 2, "--walls needs")
        self.refuse(self.run_program(self.fluid, self.wall, *HOW, "--walls", self.wall), 2,
                    r"WallBoundary_0.vtp would overwrite the input")
        self.arrays["IsWall"] = self.arrays["Kind"]
        files.write_vtp(self.input, self.points, self.arrays)
        self.refuse(self.extract(*HOW, "--walls", self.wall), 1, "have an array 'IsWall'")
        self.assertEqual(sorted(self.directory.iterdir()), sorted(there))


if __name__ == "__main__":
    main()
