# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests projections of the program: test_project.py PROGRAM PRELOAD."""
import math
import re

import particle_files as files
from command_line_test import CommandLineTest, main, says
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader


class Project(CommandLineTest):
    """Tests images of a block of particles with sides of 1 around the origin and a mass of 1000."""

    def setUp(self):
        super().setUp()
        self.image = self.directory / "surface.vti"  # refuse() looks for files whose names begin like this.

    def project(self, *options, source=None):
        """Returns the array's name, the size, the spacing and the values of the image."""
        self.run_good(source or self.input, self.image, *options)
        return self.read(self.image)

    def read(self, path):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        image, data = reader.GetOutput(), reader.GetOutput().GetPointData()
        self.assertEqual((data.GetNumberOfArrays(), data.GetArray(0).GetDataTypeAsString()), (1, "double"))
        return data.GetArrayName(0), list(image.GetDimensions()), image.GetSpacing(), vtk_to_numpy(data.GetArray(0)).tolist()

    def test_image(self):
        name, size, spacing, values = self.project("--project", "y", "--resolution", "20")
        self.assertEqual((name, size), ("ColumnDensity", [20, 1, 20]))
        self.assertAlmostEqual(spacing[0], (0.9 + 4 * 0.13) / 20)
        middle = values[10 * 20 + 10]
        self.assertAlmostEqual(middle, 1000, delta=20)  # The line of sight goes through the middle of 1 m of water.
        self.assertEqual(values[0], 0)
        self.assertAlmostEqual(sum(values) * spacing[0] * spacing[2], 1000, delta=1e-3)
        name, size, _, values = self.project("--project", "z", "--scalar", "Velocity", "--component", "0", "--resolution", "9")
        self.assertEqual((name, size), ("Velocity", [9, 9, 1]))
        self.assertAlmostEqual(values[4 * 9 + 4], 0, delta=1e-9)
        self.assertAlmostEqual(values[4 * 9 + 1], -values[4 * 9 + 7], delta=1e-9)
        self.assertLess(values[4 * 9 + 2], -0.1)

    def test_plane(self):
        """If particles lie in a plane, the image shows the field itself, not a sum along a line of sight."""
        points, arrays = self.in_plane()
        files.write_vtp(self.directory / "plane.vtp", points, {**arrays, "Mass": [10.0] * 100})
        name, size, _, values = self.project("--project", "z", "--resolution", "15", source="plane.vtp")
        self.assertEqual((name, size), ("ColumnDensity", [15, 15, 1]))
        self.assertAlmostEqual(values[7 * 15 + 7], 1000, delta=10)
        self.image.unlink()
        self.refuse(self.run_program("plane.vtp", self.image, "--project", "x"), 1, "plane of constant z")

    def test_picture(self):
        for direction in ("y", "1,1,1"):
            self.run_good(self.input, self.image, "--project", direction, "--resolution", "64", "--screenshot", "image.png",
                          display=True)
            self.assertGreater((self.directory / "image.png").stat().st_size, 3000)

    def test_film(self):
        """A film has one image for each step, in a list or with the step's number in its name. Each image has the bytes that a single run
        writes. A step that fails does not end the film."""
        options = ["--project", "z", "--resolution", "9", "--box=-1,1,-1,1,-1,1"]
        self.project(*options)
        expected = self.image.read_bytes()
        files.write_vtp(self.directory / "half.vtp", *self.chosen(lambda i: i < 500))
        files.write_vtp(self.directory / "bare.vtp", self.points, {"Mass": self.arrays["Mass"]})
        done = self.run_program(self.input, "bare.vtp", "half.vtp", "film.pvd", *options)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"film_0001.vti \(time 1\): " + says("NO_SMOOTHING_LENGTH"))
        self.assertEqual([(time, path.name) for time, path in self.listed("film.pvd")], [(0, "film_0000.vti"), (2, "film_0002.vti")])
        text = (self.directory / "film_0000.vti").read_bytes()
        self.assertEqual(re.sub(b"\n<!-- .* -->", b"", text), expected)
        self.run_good(self.input, "half.vtp", "column_%04d.vti", *options)
        self.assertEqual((self.directory / "column_0000.vti").read_bytes(), expected)
        self.project(*options, source="half.vtp")
        self.assertEqual((self.directory / "column_0001.vti").read_bytes(), self.image.read_bytes())

    def test_given_in_vain(self):
        for more in ([], ["--scalar", "Kind"]):
            told = self.run_good(self.input, self.image, "--project", "z", "--volume", "Density", "--mass", "9", *more, says=".*").stderr
            code, size = ("SIZE_BESIDE_VOLUME", "mass is") if more else ("SIZE_BESIDE_MASS", "volume is")
            self.assertRegex(told, says(code, size))

    def test_steps_without_fluid(self):
        """The image of a step without particles has the pixels (number and size) of the nearest step with particles. The values are 0, or
        NaN if the image shows a mean."""
        files.write_vtp(self.directory / "none.vtp", [], {})
        options = ["--project", "z", "--resolution", "9", "--scalar", "Kind"]
        for more, empty in (([], lambda value: value == 0), (["--weighted-by", "Mass"], math.isnan)):
            name, size, spacing, _ = self.project(*options, *more)
            self.run_good("none.vtp", "none.vtp", self.input, "none.vtp", "film.pvd", *options, *more)
            for step in (0, 1, 3):
                source = self.directory / f"film_000{step}.vti"
                self.assertEqual(self.read(source)[:3], (name, size, spacing))
                self.assertTrue(all(map(empty, self.read(source)[3])))
            self.assertEqual([path.name for _, path in self.listed("film.pvd")], [f"film_000{step}.vti" for step in range(4)])
        result = self.run_program("none.vtp", "none.vtp", "nothing.pvd", *options)
        self.one_sentence(result, 1, "no particle is seen")
        told = self.run_program(self.input, self.image, *options, "--within", "7,8,7,8,7,8").stderr
        self.assertRegex(told, says("NOTHING_WITHOUT_FLUID", "No particle is within", "nothing is seen") + "\n.*no particle is seen")
        self.run_good(self.input, self.image, *options, "--quiet", "--volume", "Density", "--mass", "9", "--box", "5,6,5,6,5,6",
                      says=says("SIZE_BESIDE_VOLUME", "mass is") + "\n.*warning: the image .* 0; check --box and --scalar$")

    def test_wrong_usage(self):
        self.output = self.image
        self.refuse_all(2, [(["w"], "--project needs an axis, x, y or z, or a direction X,Y,Z, not 'w'"),
                            (["0,0,0"], "0,0,0"), (["1,2"], "1,2"),
                            (["z", "--derive", "Velocity"], "--derive needs a --scalar that it makes"),
                            (["z", "--derive", "Velocity", "--scalar", "Kind"], "--derive needs a --scalar that it makes"),
                            (["z", "--resolution", "1"], "--resolution"), (["z", "--times", "1"], "--times, --fps and --time-step need a film")], "--project")
        self.refuse_all(1, [(["--scalar", "Nope"], "no point array 'Nope' for the projection"),
                            (["--scalar", "Velocity", "--component", "3"], "no component 3"),
                            (["--weighted-by", "Velocity"], "3 components"), (["--weighted-by", "Nope"], "'Nope' for the weight"),
                            (["--smoothing-length", "Nope"], "Nope"), (["--box", "0,0,0,1,0,1"], says("BOX_ILLEGAL", "--box along x")),
                            (["--box", "0,0,0,0,0,0"], says("BOX_ILLEGAL", "--box along y"))],
                        "--project", "z")
        self.refuse(self.run_program(self.input, "surface.vtp", "--project", "z"), 2, r"\.vti or \.vtk file, or .pvd for a film, not 'surface.vtp'")
        self.refuse(self.run_program(self.input, self.input, "surface.vti", "--project", "z"), 2, "%04d in its name, unlike 'surface.vti'")


if __name__ == "__main__":
    main()
