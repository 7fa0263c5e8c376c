# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the program marching-correctors: test_command_line.py PROGRAM PRELOAD [unittest arguments].

Other tests check what the program computes. This test checks files, options, messages and exit statuses.
"""
import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree

import particle_files as files
from command_line_test import FIRST_COMPILATION, ISO, CommandLineTest, main, says


def read_png(path):
    """Returns the width, the height and the rows of (r, g, b) of a PNG file."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(height, width, 3)  # The lowest row is first.
    return width, height, [[tuple(pixel) for pixel in row] for row in pixels[::-1].tolist()]


class Usage(CommandLineTest):
    """Tests help, modes and the exit status 2 of wrong usage."""

    def test_help(self):
        """--help lists the usual options, --help all lists every option, and --help MODE lists the options that act in this mode
        (test_modes.py compares these lists with what options do). Lines fill the terminal's width."""
        few, everything = (self.run_good("--help", *words).stdout for words in ([], ["all"]))
        self.assertEqual(self.run_program("-h").stdout, few)
        listed = re.findall(r"(?m)^  (--[\w-]+)", few)
        self.assertTrue(15 <= len(listed) <= 20 and set(listed) < set(re.findall(r"(?m)^  (--[\w-]+)", everything)), listed)
        self.assertEqual(self.run_good("slice", "--help").stdout, self.run_good("--help", "slice").stdout)
        for width in (60, 80, 132):
            text = self.run_good("--help", "all", env={**os.environ, "COLUMNS": str(width)}).stdout
            self.assertTrue(width - 12 < max(len(line) for line in text.splitlines() if not line.startswith("  --")) <= width)
        self.refuse(self.run_program("--help", "slices"), 2, "there is no help on 'slices', but on all, surface, .* and project")

    def test_closed_pipe(self):
        """A pipe that the reader closes early, as in `--help | head`, is no error."""
        for arguments in (["--help", "all"], [self.input, self.output, *ISO]):
            reader, writer = os.pipe()
            os.close(reader)
            result = self.run_program(*arguments, capture_output=False, stdout=writer, stderr=subprocess.PIPE)
            os.close(writer)
            self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_modes_as_first_words(self):
        """A mode as the first word changes no output. If the command line lacks what the mode needs, an error says what. Without a scalar,
        the mode `surface` makes the free surface."""
        self.run_good(self.input, "a.vti", "--slice", "z=0", "--resolution", "9")
        self.run_good("slice", self.input, "b.vti", "--slice", "z=0", "--resolution", "9")
        self.assertEqual(*((self.directory / name).read_bytes() for name in ("a.vti", "b.vti")))
        self.extract_good("--free-surface")
        self.run_good("surface", self.input, "free.vtp")
        self.assertEqual(self.output.read_bytes(), (self.directory / "free.vtp").read_bytes())
        self.output.unlink()
        for arguments, sentence in [
            (["slice", self.input, "surface.vti", *ISO], "slice needs --slice AXIS=PLACE, but this is a command line for surfaces"),
            (["film", self.input, self.output], "film needs an OUTPUT.pvd, or %04d in the name of OUTPUT, but .* for surfaces"),
            (["surface", self.input, self.output, "--line", "0,0,0,1,0,0"], "surface needs one INPUT and one OUTPUT, but .* for lines")]:
            self.refuse(self.run_program(*arguments), 2, sentence)

    def test_options_that_do_not_fit(self):
        """Options that do not fit together are refused. test_modes.py tests the rules in Options.def; this test has others."""
        free = ["--free-surface"]
        self.refuse_all(2, [
            *(([*how, "--derive", "Velocity", *more], "what --derive makes is neither the --scalar nor among")
              for how in (free, ISO) for more in (["--no-attributes"], ["--attributes", "Kind"])),
            ([*free, "--wall-share", "0.5", "--fluid", "Kind=0"], "add --solids wall, or leave out --wall-share"),
            ([*ISO, "--wall-share", "0.5", "--fluid", "Kind=0", "--solids", "ignore"], "add --solids wall"),
            ([*ISO, "--smoothing-length", "estimate", "--support-radius"], "not for an estimate; leave out --support-radius"),
            ([*ISO, "--smoothing-length", "neighbours=1.2", "--support-radius"], "not for an estimate"),
            ([*ISO, "--cubes", "uniform", "--max-level", "1"], "for adaptive cubes; leave out --max-level, or --cubes uniform")])
        self.refuse_all(1, [([*ISO, "--component", "0"], "'Radius' has one component; leave out --component")])

    def test_questions(self):
        self.assertRegex(self.run_good("--version").stdout, r"^marching-correctors \d+\.\d+\.\d+ \(VTK \d+\.\d+\.\d+\)\n$")
        self.assertRegex(self.run_good("--list-devices").stdout, r"^0: built in: this CPU")

    def test_values_of_the_wrong_form(self):
        """A number or a word that an option cannot take is refused with an error that names the option."""
        text = self.run_good("--help", "all", env={**os.environ, "COLUMNS": "300"}).stdout
        tried = 0
        for option, form in re.findall(r"(?m)^  (--[\w-]+) (\S+) ", text):
            numbers = re.fullmatch(r"[A-Z]{1,2}(\[.*|\|BEGIN.*)?|MIB", form)
            values = ("x", "1x", " 1", "", "nan", "1e999", "0x1p3", "+-1") if numbers else ()
            values += ("nonesuch",) if re.fullmatch("[-a-z_|0-9]+", form) else ()
            values += ("-1",) if numbers and option not in ("--iso", "--times") else ("-2", "0") if form.startswith("NAME|VALUE") else ()
            for value in values:
                with self.subTest(option, value=value):
                    tried += 1
                    self.refuse(self.run_program(self.input, self.output, f"{option}={value}"), 2, f"{option} (needs (?!--)|must be)")
        self.assertGreater(tried, 100)

    def test_wrong_usage(self):
        good = [self.input, self.output]
        for arguments, sentence in [
            ([], "INPUT or OUTPUT is missing"), ([self.input], "INPUT or OUTPUT is missing"),
            ([self.input, "film.usdc", *ISO], "marchingcorrectors surface INPUT... film.usdc .*convert FILM.pvd film.usdc"),
            ([self.input, "surface.png", *ISO],
             "output is a .vtp, .stl, .ply, .obj or .csv file, or .pvd for a film, not 'surface.png'"),
            ([*good, *ISO, "--stats", "a.png", "--screenshot", "a.png"], "written twice"),
            ([*good], "give --scalar NAME, or --free-surface"),
            (["--list-arrays"], "--list-arrays needs FILE"),
            (["--list-arrays", *good], "--list-arrays FILE stands alone"),
            ([self.input, "--list-arrays=" + str(self.input)], "--list-arrays FILE stands alone"),
            (["--list-arrays", "Part_0001.bi4"], "is read by the Python package"),
            ([*good, *ISO, "--qwerty"], r"unknown option --qwerty \("), ([*good, *ISO, "--smoth"], "--smoth; did you mean --smooth[?]"),
            ([*good, *ISO, "--cubesize=1"], "unknown option --cubesize; did you mean --cube-size[?]"),
            ([*good, *ISO, "--kernel", "Wendland"], "not 'Wendland'; did you mean wendland[?]"),
            ([*good, *ISO, "--kernel", "wendland_c2"], "not 'wendland_c2'; did you mean wendland[?]"),
            ([*good, *ISO, "--preview=1"], "--preview takes no value"),
            ([*good, "--scalar", "--iso", "0.3"], "--scalar needs NAME"),
            ([*good, *ISO, "--wall-share", "1"], "--wall-share needs a number above 0 and below 1"),
            ([*good, "--scalar", "Radius", "--iso", "1,x"], "--iso needs a finite number, not 'x'"),
            ([*good, "--scalar", "Radius", "--iso", "1,"], "--iso needs a finite number, not ''"),
            ([*good, *ISO, "--component", "-2"], "--component needs a whole number from 0"),
            ([*good, *ISO, "--component", "2147483648"], "whole number up to 2147483647, not '21"),
            ([*good, "-iso", "1"], "unknown option -iso; did you mean --iso[?]"),
            ([*good, *ISO, "-q"], r"unknown option -q \("),
            ([self.input, "-surface.vtp", *ISO], "unknown option -surface.vtp"),
            ([self.input, "-", *ISO], "'-' is not the name of a file"),
            ([self.input, "", *ISO], "'' is not the name of a file"),
            ([*good, *ISO, "--iso", "0.4"], "--iso is given twice"),
            ([*good, *ISO, "--stats", "-h"], "--stats needs FILE.json"),
            ([*good, *ISO, "--stats"], "--stats needs FILE.json"),
            ([*good, *ISO, "--stats", ""], "--stats needs FILE.json"),
            ([*good, *ISO, "--memory-limit", "0"], "--memory-limit needs a whole number from 1"),
            ([*good, *ISO, "--h-scale", "0"], "--h-scale must be greater than 0"),
            ([*good, *ISO, "--", "--quiet"], "output of several steps is a .pvd file, or .* not '--quiet'"),
            ([*good, *ISO, "--periodic", "1,2"], "--periodic needs three lengths, or six bounds"),
            ([*good, *ISO, "--periodic", "1,2,-1"], "--periodic needs a period of 0 or more along z"),
            ([*good, *ISO, "--periodic", "0,1,1,0,0,1"],
             "--periodic needs a period of 0 or more along y"),
            ([*good, *ISO, "--fluid", "Kind"], "--fluid needs NAME=VALUE"),
            ([*good, *ISO, "--box", "0,1,0,1"], "--box needs six numbers, x0,x1,y0,y1,z0,z1"),
            ([*good, *ISO, "--box", "0,1,0,1,2,1"], "--box needs the lower number first along z"),
            ([*good, *ISO, "--box", "0,1,inf,inf,0,1"], "--box needs the lower number first along y"),
            ([*good, *ISO, "--box", "0,1,0,nan,0,1"], "--box needs a finite number, not 'nan'"),
            ([*good, *ISO, "--fluid", "Kind=x"], "--fluid needs a finite number, not 'x'"),
            ([*good, *ISO, "--screenshot", "a.jpg"], "--screenshot writes a .png file"),
            ([*good, *ISO, "--screenshot", "a.png", "--view", "0,0,0"], "--view needs three numbers, not all 0"),
            ([*good, *ISO, "--screenshot", "a.png", "--color-range", "2,1"], "the lower one first"),
            ([*good, *ISO, "--screenshot", "a.png", "--color-range", "1,2"], "--color-range needs --color-by NAME"),
            ([*good, "--slice", "0.1"], "--slice needs an axis and a position, such as z=0.1"),
            ([*good, "--slice", "z=0.1"], "the output of --slice is a .vti or .vtk file, not '.*surface.vtp'"),
            ([*good, "--line", "0,0,0,0,0,0"], "--line needs two different points"),
            ([*good, "--line", "0,0,0,1,0,0", "--slice=x=0"], "--line is for lines, not for slices; leave it out"),
            ([*good, "--line", "0,0,0,1,0,0", "--resolution", "1"], "--resolution needs a whole number from 2"),
        ]:
            with self.subTest(sentence):
                self.refuse(self.run_program(*arguments), 2, sentence)


class BadData(CommandLineTest):
    """Tests bad data, files and devices, which have exit status 1 and an error message of their own."""

    def refuse_with(self, sentence, *options, **extract_options):
        self.refuse(self.extract(*(options or ISO), **extract_options), 1, sentence)

    def test_sentences(self):
        """In the program, messages of the filters name the program's options. test_input.py tests these messages."""
        self.refuse_all(1, [
            (["--scalar", "Temperature", "--iso", "1"], says("NO_SUCH_ARRAY", "'Temperature'", "Radius")),
            (["--derive", "Nonsense", *ISO], says("NO_SUCH_ARRAY", "'Nonsense'", "Radius")), ([*ISO, "--attributes", "Kind,Colour"], "'Colour'"),
            ([*ISO, "--cube-size", "1e-5"], says("BLOCKS_TOO_MANY", "--cube-size")),
            ([*ISO, "--box", "0,0,0,0,0,0"], says("BOX_ILLEGAL", "--box along y are 0 and 0")),
            ([*ISO, "--device", "nonesuch"], says("NO_SUCH_DEVICE", "nonesuch")), ([*ISO, "--device", "99"], says("NO_SUCH_DEVICE", "99"))])
        del self.arrays["SmoothingLength"]
        files.write_vtp(self.input, self.points, self.arrays)
        self.refuse_with(says("NO_SMOOTHING_LENGTH", "--smoothing-length estimate finds", "--smoothing-length names"))
        files.write_vtp(self.input, [], {})
        self.refuse_with("particles.vtp holds no points")

    def test_no_home(self):
        """If HOME names no folder, PoCL cannot keep its compiled programs. Runs work all the same, and leave no files behind."""
        temporary = self.directory / "temporary"
        temporary.mkdir()
        environment = {k: v for k, v in os.environ.items()
                       if k not in ("POCL_CACHE_DIR", "XDG_CACHE_HOME", "MCOR_DEVICE")}
        environment.update({"HOME": str(self.input), "TMPDIR": str(temporary)})
        self.run_good("--list-devices", env=environment)
        self.extract_good("--free-surface", env=environment)
        self.assertEqual(list(temporary.iterdir()), [])

    def test_no_driver(self):
        """If OCL_ICD_VENDORS names no folder, Debian's ICD loader finds no driver. The built-in device needs neither a driver nor a
        home directory."""
        environment = {**os.environ, "OCL_ICD_VENDORS": str(self.directory / "nowhere"), "HOME": "/nonexistent"}
        environment.pop("MCOR_DEVICE", None)
        self.refuse_with(says("NO_KERNELS", "--precision single"), *ISO, "--precision", "double", env=environment)
        listed = self.run_program("--list-devices", env=environment)
        self.assertRegex(listed.stdout, r"^0: built in: this CPU.*\n$")

    def test_unreadable_files(self):
        self.refuse_with("nothing.vtp cannot be read: No such file",
                       source=self.directory / "nothing.vtp")
        self.refuse_with("cannot be read: it is a directory", source=self.directory)
        table = self.directory / "table.doc"
        table.write_text("x,y,z\n")
        self.refuse_with("table.doc is not a .vtp, .vtu, .pvtp, .pvtu, .vtkhdf, .vtk, .csv, .*file", source=table)
        fifo = self.directory / "fifo.vtp"
        os.mkfifo(fifo)
        self.refuse_with("fifo.vtp cannot be read: it is not a regular file", source=fifo)

    def test_files_of_solvers(self):
        for name in ("s.bgeo", "s.bi4", "s.hdf5", "s.npz", "s.gro", "s.data", "s.xyz.gz", "s.h5"):
            self.refuse(self.run_program(self.directory / name, "o.vtp", *ISO), 2,
                        f"{name} is read by the Python package: 'python -m marchingcorrectors convert .*{name} particles.vtp'")

    def test_no_vtk_files(self):
        for name in ("text.vtp", "text.vtu", "text.vtk"):
            path = self.directory / name
            for text in ("", "hello\n", "<VTKFile></VTKFile>\n"):
                with self.subTest(name, text=text):
                    path.write_text(text)
                    self.refuse_with(f"{name} (cannot be read|is not|holds)", source=path)

    def test_not_particles(self):
        image = self.directory / "image.vtk"
        files.write_image(image, "2 2 2")
        self.refuse_with("image.vtk holds a vtk.*, not particles", source=image)

    def test_unwritable_files(self):
        nowhere = self.directory / "nowhere"
        self.refuse(self.run_program(self.input, nowhere / "surface.vtp", *ISO), 1,
                  r"surface.vtp could not be written: no file can be created in .*nowhere \(No such file or dir")
        for option, name in (("--stats", "s.json"), ("--screenshot", "s.png")):
            self.refuse_with(f"{name} could not be written: no file can be created", *ISO, option, nowhere / name)
        directory = self.directory / "directory.vtp"
        directory.mkdir()
        self.refuse(self.run_program(self.input, directory, *ISO), 1, "it is a directory")


class Options(CommandLineTest):
    """Tests effects of options that the statistics or the output show."""

    def test_summary(self):
        result = self.extract_good(*ISO)
        self.assertRegex(result.stdout, r"(?m)^surface     \d+ points, \d+ triangles; area 0\.98\d*, volume -0\.09\d*$")
        self.assertEqual([line.split()[0] for line in result.stdout.splitlines()], ["particles", "contour", "surface", "seconds"])
        self.assertRegex(result.stdout, r"; volume: Mass / Density\ncontour     Radius = 0.3; range [\d.]+ [.][.] [\d.]+\nsurface")
        self.assertRegex(result.stdout, r"(?m)^seconds     \d+[.]\d+$")
        result = self.extract_good(*ISO, "--verbose")
        trimmed = self.extract("--scalar", "Radius", "--iso", "0.55", "--verbose")
        self.assertRegex(trimmed.stdout,
                         r"(?m)^surface     .* triangles \(\d+ before trimming, which cuts some in two\); area [\d.]+$")
        self.assertRegex(result.stdout, r"(?m)^cells       \d+ .* with surface$")
        self.assertRegex(result.stdout, r"(?m)^seconds     .*search grid.*total \d")

    def test_quiet(self):
        self.assertEqual(self.extract_good(*ISO, "--quiet").stdout, "")
        self.assertTrue(self.output.exists())

    def test_statistics(self):
        found = self.succeed(*ISO)
        self.assertGreater(found["statistics"]["triangles"], 100)
        self.assertEqual(found["statistics"]["fluid_particles"], len(self.points))
        self.assertLessEqual({"smoothing_length_array": "SmoothingLength", "mass_array": "Mass"}.items(), found["arrays"].items())
        self.assertEqual((found["parameters"]["iso_values"], found["parameters"]["kernel"]), ([0.3], "cubic"))
        seconds = dict(found["seconds"])
        total = seconds.pop("total")
        self.assertLessEqual({"search_grid", "seeds", "extraction", "correction", "trimming",
                              "output"}, set(seconds))
        self.assertAlmostEqual(total, sum(seconds.values()), places=6)

    def test_chosen_iso_value(self):
        """Without --iso the program chooses a value; core_name tests the choice. A film keeps the first step's value in all its steps."""
        sentence = r"(?m)^iso value   (\S+), chosen for Radius, whose range is (\S+) \.\. (\S+) \("
        statistics = self.directory / "statistics.json"
        result = self.extract_good("--scalar", "Radius")
        value, low, high = map(float, re.search(sentence, result.stdout).groups())
        self.assertTrue(min(self.arrays["Radius"]) - 1e-5 < low < value < high < max(self.arrays["Radius"]) + 1e-5)
        self.assertEqual(self.extract("--scalar", "Radius", "--quiet").stdout, "")
        self.arrays["Radius"] = [2 * r for r in self.arrays["Radius"]]
        files.write_vtp(self.directory / "later.vtp", self.points, self.arrays)
        film = self.run_good(self.input, "later.vtp", "film.pvd", "--scalar", "Radius", "--stats", statistics)
        self.assertEqual(len(re.findall(sentence, film.stdout)), 1)
        self.assertAlmostEqual(json.loads(statistics.read_text())["parameters"]["iso_values"][0], value, places=5)

    def test_list_arrays(self):
        self.arrays["ParticleType"] = self.arrays.pop("Kind")
        self.arrays["Radius"][3] = float("nan")
        files.write_vtp(self.input, self.points, self.arrays)
        result = self.run_good("--list-arrays", self.input)
        radii = [r for r in self.arrays["Radius"] if r == r]
        low, high = re.search(r"(?m)^array             Radius: 1 component, \w+, (\S+) \.\. (\S+)$",
                              result.stdout).groups()
        self.assertAlmostEqual(float(low), min(radii), places=6)
        self.assertAlmostEqual(float(high), max(radii), places=6)
        for line in [f"particles         {len(self.points)}", "smoothing length  SmoothingLength",
                     "volume            Mass / Density", "velocity          Velocity",
                     r"fluid             ParticleType = 0 \(give --fluid ParticleType=0\)", "period            none",
                     "dimension         3", r"array             Velocity: 3 components, \w+, \(\S+, \S+, \S+\) \.\. \(.*\)"]:
            self.assertRegex(result.stdout, f"(?m)^{line}$")
        files.write_vtp(self.input, [(x, y, 0.5) for x, y, _ in self.points], {})
        result = self.run_program("--list-arrays", self.input)
        for line in [r"smoothing length  none \(give .*estimate\)", "volume            computed from the positions",
                     "velocity          none", "fluid             all particles", "dimension         2"]:
            self.assertRegex(result.stdout, f"(?m)^{line}$")
        self.refuse(self.run_program("--list-arrays", "none.vtp"), 1, "none.vtp")

    def test_first_compilation(self):
        """If a driver has no programs in its cache, a message tells that compiling takes time."""
        if "Portable" not in self.run_program("--list-devices").stdout:
            self.skipTest("there is no PoCL")
        environment = {**os.environ, "POCL_CACHE_DIR": str(self.directory / "cache")}
        result = self.extract_good(*ISO, "--device", "Portable", "--verbose", env=environment, told=True, says=".*")
        if float(re.search(r"program build ([\d.]+)", result.stdout)[1]) > 10:
            self.assertEqual(result.stderr, FIRST_COMPILATION)

    def test_long_run(self):
        """A run that computes for seconds must not say that a driver compiles."""
        if "built in" not in self.run_program("--list-devices").stdout:
            self.skipTest("a driver's programs are compiled")
        self.run_good(self.input, self.directory / "levels.vti", "--gauge-grid", "1000,1000:-1,1,-1,1,-1,1",
                      "--threads", "1", "--device", "built in", told=True)

    def test_derive(self):
        """--derive makes arrays from a particle array. The new arrays may be contoured, are carried to the surface, and replace stored arrays
        of the same name."""
        self.arrays["Lambda2"] = [17.0] * len(self.points)
        files.write_vtp(self.input, self.points, self.arrays)
        self.succeed("--derive", "Velocity", *ISO)
        text = self.output.read_text()
        for name in ("Gradients", "Divergence", "Vorticity", "Q-criterion", "Lambda2", "StrainRate"):
            self.assertIn(f'Name="{name}"', text)
        self.assertNotIn('RangeMax="17"', text)
        found = self.succeed("--derive", "Radius", "--scalar", "Gradients", "--iso", "0.8")
        self.assertGreater(found["statistics"]["triangles"], 10)
        self.assertNotIn("Vorticity", self.output.read_text())

    def write_points(self):
        """Writes files of five points on the x axis. In points.vtp and points.vtu one point lies outside the particles."""
        xs = [-5.0, 0.0, 0.1, 0.2, 0.3]
        files.write_vtp(self.directory / "points.vtp", [(x, 0.0, 0.0) for x in xs], {"Own": xs})
        files.write_vtu(self.directory / "points.vtu", [(x, 0.0, 0.0) for x in xs], {"Own": xs})
        files.write_image(self.directory / "points.vti", "0 4 0 0 0 0", "-0.2 0 0", "0.15 1 1")
        files.write_image(self.directory / "points.vtk", "5 1 1", "-0.2 0 0", "0.15 1 1")

    def test_probe(self):
        self.write_points()
        for name, valid in [("points.vtp", 4), ("points.vtu", 4), ("points.vti", 5), ("points.vtk", 5)]:
            with self.subTest(name):
                output = self.directory / ("out" + name[-4:])
                result = self.run_good(self.input, output, "--probe", name, "--derive", "Velocity",
                                       "--attributes", "Radius,Divergence", "--gradients")
                self.assertIn(f"points      5, {valid} of them valid", result.stdout)
                text = output.read_bytes().decode("latin1")
                for array in ("Radius", "WeightSum", "vtkValidPointMask", "Divergence", "Radius_Gradient"):
                    self.assertRegex(text, rf'\b{array}\b')
                self.assertNotIn("Density", text)
        text = (self.directory / "out.vtp").read_text()
        self.assertIn('Name="Own"', text)
        divergence = text[text.index('Name="Divergence"'):]
        self.assertAlmostEqual(float(divergence.split('RangeMax="')[1].split('"')[0]), 3, places=4)

    def test_slice(self):
        """--slice makes a plane through the particles, with the resolution that is asked for."""
        output = self.directory / "slice.vti"
        result = self.run_good(self.input, output, "--slice", "z=0.1", "--resolution", "19", "--derive", "Velocity",
                               "--attributes", "Radius,Divergence")
        self.assertRegex(result.stdout, r"points      361, 361 of them valid")
        image = xml.etree.ElementTree.parse(output).getroot().find("ImageData")
        self.assertEqual(image.get("WholeExtent").split(), ["0", "18", "0", "18", "0", "0"])
        numbers = [float(v) for v in (image.get("Origin") + " " + image.get("Spacing")).split()]
        for found, expected in zip(numbers, [-0.45, -0.45, 0.1, 0.05, 0.05, 0.05]):
            self.assertAlmostEqual(found, expected, places=6)
        for name in ("Radius", "WeightSum", "vtkValidPointMask", "Divergence"):
            self.assertIn(f'Name="{name}"', output.read_text())
        for quiet, told in ([], "points      262144, 0 of them valid"), (["--quiet"], ""):
            result = self.run_good(self.input, self.directory / "slice.vtk", "--slice=x=-7", "--volume=Density", "--mass=9", *quiet,
                                   says=says("SIZE_BESIDE_VOLUME", "mass is") + r"\n.*warning: " + says("POINTS_DRY"))
            self.assertTrue(result.stdout.startswith(told), result.stdout)

    def test_line(self):
        """--line reports as many points, and as many valid ones, as --probe with a file of the same points. The output
        has the distance from the line's start."""
        output = self.directory / "line.vtp"
        result = self.run_good(self.input, output, "--line=-0.6,0,0,0.6,0,0", "--resolution", "13")
        files.write_vtp(self.directory / "points.vtp", [(-0.6 + 0.1 * i, 0.0, 0.0) for i in range(13)], {})
        points = self.run_program(self.input, self.directory / "out.vtp", "--probe", "points.vtp")
        self.assertEqual(result.stdout.split("\n")[0], points.stdout.split("\n")[0])
        text = output.read_text()
        self.assertIn('NumberOfLines="1"', text)
        self.assertRegex(text, r'Name="arc_length"[^>]*RangeMin="0"[^>]*RangeMax="1.2')

    def test_sizes_of_probes(self):
        """Impossible numbers of points are refused at once, and the sentence names the file."""
        for name, extent, sentence in (
                ("image.vti", "0 99999 0 99999 0 99999", "has 1000000000000000 points; at most 2147483647"),
                ("image.vti", "0 -5 0 4 0 4", "cannot be read: (Whole)?Extent is -4; it may be damaged"),
                ("image.vti", "0 -1 0 -1 0 -1", "holds no points"),
                ("image.vtk", "100000 100000 100000", "has 1000000000000000 points"),
                ("image.vtk", "-5 4 4", "cannot be read: dimensions is -5")):
            with self.subTest(extent):
                files.write_image(self.directory / name, extent)
                self.refuse(self.run_program(self.input, "surface" + name[-4:], "--probe", name), 1, f"{name} {sentence}")

    def test_wrong_probes(self):
        self.write_points()
        self.refuse_all(1, [(["nothing.vtp"], "nothing.vtp cannot be read"), (["points.obj"], "points.obj"),
                            (["points.vtp", "--mass", "No"], "array 'No'")], "--probe")
        for output, status, sentence in (("surface.vtu", 1, "for a .vtp or .vtk file, not 'surface.vtu'"),
                                         ("points.vtp", 2, "would overwrite the input")):
            self.refuse(self.run_program(self.input, output, "--probe", "points.vtp"), status, sentence)

    def test_empty_surface(self):
        self.extract_good("--scalar", "Radius", "--iso", "99", says="^marching-correctors: warning: .*99")
        self.assertTrue(self.output.exists())
        self.succeed(*ISO, "--fluid", "Kind=7", told="warning: .*Kind = 7")

    def test_components(self):
        vector = ["--scalar", "Velocity", "--iso", "0.21"]
        magnitude = self.succeed(*vector)["statistics"]
        for name in ("magnitude", "-1"):  # -1 is the filter's number for the magnitude.
            self.assertEqual(magnitude, self.succeed(*vector, "--component", name)["statistics"])
        plane = self.succeed(*vector, "--component", "0")["statistics"]
        self.assertLess(plane["scalar_range"][0], 0)
        self.assertNotEqual(plane["triangles"], magnitude["triangles"])

    def test_suspicious_input(self):
        """Warnings, which core_warning tests, appear on stderr and in the statistics."""
        statistics = self.directory / "statistics.json"
        result = self.extract_good(*ISO, "--vertex-threshold", "5", "--stats", statistics, says="^marching-correctors: warning: .*" + says(
            "ALL_TRIMMED", "5", "--field sum, --node-threshold 0 and --vertex-threshold 0[.]"))
        self.assertEqual(result.stderr.count("warning:"), 1)
        warning, = json.loads(statistics.read_text())["warnings"]
        self.assertIn(warning, result.stderr)
        self.assertEqual(self.succeed(*ISO)["warnings"], [])

    def test_solvers_names(self):
        """Names of arrays in solvers' files are known. The files of DualSPHysics hold no smoothing length, so an option
        must give it."""
        arrays, count = self.arrays, len(self.points)
        dual = {"Idp": list(range(count)), "Rhop": arrays["Density"], "Vel": arrays["Velocity"],
                "Type": [3] * count, "Mass": arrays["Mass"], "Radius": arrays["Radius"]}
        files.write_vtp(self.input, self.points, dual)
        self.assertRegex(self.extract(*ISO).stderr, says("NO_SMOOTHING_LENGTH", "--coefh"))
        found = self.succeed(*ISO, "--dp", "0.1", "--coefh", "1.2")
        self.assertEqual(found["arrays"]["density_array"], "Rhop")
        length = found["statistics"]["smoothing_length_range"][0]
        self.assertAlmostEqual(length, 1.2 * 3 ** 0.5 * 0.1)

    def test_settings(self):
        """Each row has options, and the parameters that the statistics must then show. It may also have other options that must make the
        same surface. test_modes.py tries each option."""
        half, walls = 5 * files.SPACING, ["--fluid", "Kind=0", "--solids"]
        self.arrays["7"] = self.arrays["SmoothingLength"]
        files.write_vtp(self.input, self.points, self.arrays)
        listed = re.search(r"--kernel NAME +(.*)", self.run_program("--help", "all", env={**os.environ, "COLUMNS": "999"}).stdout).group(1)
        kernels = listed.replace(" (default)", "").split(", ")
        self.assertEqual(kernels[:5], ["cubic", "quadratic", "mprime4", "quintic", "wendland"])
        numbers, arrays, of_fluid = "parameters", "arrays", "fluid"
        surfaces = {}
        for arguments, group, expected, same_as in [
            ([], numbers, {"kernel": "cubic", "vertex_threshold": 0.5, "precision": "single"}, None),
            *(((["--kernel", name]), numbers, {"kernel": name}, "" if name == "cubic" else None) for name in kernels),
            (["--boundary", "eigenvalue"], numbers, {"boundary_detection": "eigenvalue", "vertex_threshold": 0.3}, ""),
            (["--boundary=eigenvalue", "--vertex-threshold=0.75"], numbers, {"vertex_threshold": 0.75}, ""),
            (["--box=-1,0.1,-inf,inf,-1,1"], numbers, {"box": [-1, 0.1, None, None, -1, 1]}, None),
            ([f"--periodic={-half!r},{half!r},{-half!r},{half!r},0,0"], numbers,
             {"periodic_bounds": [-half, half, -half, half, 0, 0]}, None),
            (["--periodic", f"{2 * half!r},{2 * half!r},0"], numbers,
             {"periodic_bounds": [-half, half, -half, half, 0, 0]}, f"--periodic={-half!r},{half!r},{-half!r},{half!r},0,0"),
            (["--smoothing-length", "0.13"], arrays, {"smoothing_length_array": ""}, ""),
            # A value that is both an array's name and a number, here 7, means the array.
            (["--smoothing-length", "7"], arrays, {"smoothing_length_array": "7"}, ""),
            (["--smoothing-length", "0.26", "--support-radius"], numbers, {"smoothing_length_is_support_radius": 1}, ""),
            (["--mass", "1", "--density", "1000"], numbers, {"mass": 1, "density": 1000}, ""),
            (["--mass", "Mass", "--density", "Density"], arrays, {"mass_array": "Mass", "density_array": "Density"}, ""),
            ([*walls, "wall", "--wall-share=measured"], of_fluid, {"solids": "wall"}, None),
            ([*walls, "wall"], of_fluid, {"solids": "wall"}, " ".join([*walls, "wall", "--wall-share=measured"])),
            (walls[:2], of_fluid, {}, " ".join([*walls, "wall", "--wall-share=measured"])),
            (["--iso", "0.3,0.2"], numbers, {"iso_values": [0.3, 0.2]}, None),
        ]:
            with self.subTest(arguments):
                found = self.succeed(*(ISO[:2] if "--iso" in arguments else ISO), *arguments)
                self.assertGreater(found["statistics"]["triangles"], 0)
                self.assertEqual({name: found[group][name] for name in expected}, expected)
                surface = self.output.read_bytes()
                others = [other for other, bytes_ in surfaces.items() if bytes_ == surface]
                self.assertEqual(others[:1], [] if same_as is None else [same_as])
                surfaces[" ".join(arguments)] = surface
        self.assertEqual(found["statistics"]["triangles"], sum(
            self.succeed(*ISO[:2], "--iso", value)["statistics"]["triangles"] for value in ("0.3", "0.2")))
        self.assertIn("volume: 1 / 1000\n", self.extract(*ISO, "--mass=1", "--density=1000").stdout)
        source = self.directory / "signs.vtp"
        files.write_vtp(source, self.points, {**self.arrays, "V{x}|[m3]": [1e-3] * len(self.points)})
        self.assertIn("volume: array V{x}|[m3]\n", self.extract(*ISO, "--volume", "V{x}|[m3]", source=source).stdout)
        for arguments, words in ((["--box", "50,51,0,1,0,1"], "in the box"), (["--box=-1,0.1,-1,1,-1,1", "--vertex-threshold", "9"], r"\d+ triangles in the box")):
            self.extract_good(*ISO, *arguments, says="surface is empty: .*" + words)
        self.output.unlink()
        self.refuse(self.extract("--free-surface", "--periodic", "1e-3,0,0"), 1, "period along x")

    def test_output_arrays(self):
        """Each row has options, arrays that the surface must have, and arrays that it must not have."""
        for options, there, missing in (
                ([], "Normals Velocity Kind Radius", "WeightSum BoundaryEigenvalue Gradients"),
                (["--weight-sum", "--boundary-eigenvalue", "--curvature", "--gradients"],
                 "WeightSum BoundaryEigenvalue MeanCurvature GaussCurvature Gradients", ""),
                (["--no-attributes"], "Normals", "Velocity Kind"),
                (["--attributes", "Kind,Density"], "Normals Kind Density", "Velocity Mass")):
            self.succeed(*ISO, *options)
            names = set(re.findall('Name="(.*?)"', self.output.read_text()))
            self.assertLessEqual(set(there.split()), names)
            self.assertFalse(set(missing.split()) & names)

    def test_period_of_field_data(self):
        """A period in the field data is mentioned, and used only with --periodic. core_name tests the forms of such
        data."""
        free, length = ["--free-surface", "--no-attributes"], 10 * files.SPACING
        self.succeed(*free, "--periodic", f"{length!r},{length!r},0")
        expected = self.output.read_bytes()
        self.output.unlink()
        self.refuse(self.extract(*free, "--periodic", "auto"), 1, says("NO_PERIOD"))
        files.add_field(self.input, "BoxSize", [length, length, 0.0])
        self.assertRegex(self.extract(*free).stderr, "warning: .* BoxSize .*--periodic auto")
        self.assertEqual(self.extract(*free, "--periodic", "0,0,0").stderr, "")
        self.succeed(*free, "--periodic", "auto")
        self.assertEqual(self.output.read_bytes(), expected)

    def test_repeat(self):
        found = self.succeed(*ISO, "--repeat", "3")
        written = self.output.read_bytes()
        self.assertEqual([run["statistics"]["triangles"] for run in found["runs"]], [found["statistics"]["triangles"]] * 3)
        self.assertGreater(min(run["seconds"]["total"] for run in found["runs"]), 0)
        self.succeed(*ISO)
        self.assertEqual(self.output.read_bytes(), written)

    def test_device(self):
        first = self.run_program("--list-devices").stdout.splitlines()[0]
        found = self.succeed(*ISO, "--device", "0")
        self.assertIn(found["device"], first)
        self.assertEqual(self.succeed(*ISO, "--device", found["device"])["device"], found["device"])

    def test_dashes(self):
        # After --, file names may begin with a dash. So may values after =, and values that are numbers.
        self.run_good("--free-surface", "--stats=-s.json", "--", self.input, "-o.vtp")
        json.loads((self.directory / "-s.json").read_text())
        self.assertTrue((self.directory / "-o.vtp").exists())
        self.assertIn("value -0.5 (and 2 more)", self.extract("--scalar", "Radius", "--iso", "-.5,-1,-2e3").stderr)


class Picture(CommandLineTest):
    """Tests --screenshot, with and without a display."""

    def picture(self, *arguments):
        """Returns the width, the height and the rows of (r, g, b) of the picture that the program draws."""
        path = self.directory / "p.png"
        self.run_good(self.input, *arguments, "--screenshot", path, "--quiet", display=True)
        return read_png(path)

    def test_fit(self):
        """From every side the whole outline is in the picture: the picture's border is white, and drawn pixels are near the border."""
        for arguments in ([], ["--up", "z"], ["--up", "-x", "--view", "3,1,1"], ["--view", "0,1,0"],
                          ["--color-by", "Radius"]):
            with self.subTest(arguments):
                width, height, rows = self.picture("s.vtp", *ISO, *arguments)
                self.assertEqual((width, height), (1280, 800))
                white = (255, 255, 255)
                border = rows[0] + rows[-1] + [row[0] for row in rows] + [row[-1] for row in rows]
                self.assertEqual(set(border), {white})
                drawn = [y for y, row in enumerate(rows) if any(pixel != white for pixel in row[:1000])]
                columns = [x for x in range(1000) if any(row[x] != white for row in rows)]
                self.assertTrue(drawn[0] < 60 or columns[0] < 60, (drawn[0], columns[0]))

    def test_colors(self):
        """With --color-by, or with several iso values, a picture has many colours and a colour bar. A plain surface has shades of one
        blue."""
        def hues(rows, columns):
            return {(r > b, g > b, g > r) for row in rows for r, g, b in row[columns] if max(r, g, b) - min(r, g, b) > 60}
        plain = self.picture("s.vtp", *ISO)[2]
        self.assertEqual(len(hues(plain, slice(0, 1280))), 1)
        colored = self.picture("s.vtp", "--free-surface", "--color-by", "Velocity")[2]
        self.assertGreater(len(hues(colored, slice(0, 1100))), 2)
        self.assertGreater(len(hues(colored, slice(1130, 1165))), 2)
        several = self.picture("s.vtp", "--scalar", "Radius", "--iso", "0.15,0.25", "--node-threshold", "0.9",
                               "--box", "0,9,-9,9,-9,9")[2]  # The box cuts the surfaces into halves, so that both can be seen.
        self.assertGreater(len(hues(several, slice(0, 1100))), 1)
        self.assertGreater(len(hues(several, slice(1130, 1165))), 2)

    def test_bands(self):
        """The legend of bands has one step for each band, the lowest first. If particles are DualSPHysics', z is upwards in the picture."""
        points, arrays = self.in_plane()
        files.write_vtp(self.input, points, {name: arrays[name] for name in ("Radius", "SmoothingLength")})
        rows = self.picture("s.vtp", "--scalar", "Radius", "--iso=-1,0.2,0.3,0.6", "--filled")[2]
        steps = list(dict.fromkeys(row[1168] for row in rows if max(row[1168]) - min(row[1168]) > 40))
        self.assertEqual(len(steps), 4)
        self.assertEqual(sorted(steps, key=lambda color: color[1]), steps)
        self.assertGreaterEqual(len(set(steps) & {pixel for row in rows for pixel in row[:1100]}), 2)  # The bands have these colours.
        files.write_vtp(self.input, self.points, {**self.arrays, "Idp": list(range(len(self.points)))})
        self.assertEqual(self.picture("s.vtp", "--free-surface"), self.picture("s.vtp", "--free-surface", "--up", "z"))

    def test_slice(self):
        """A slice is seen straight on: large values are yellow, small ones blue, and places without fluid white."""
        rows = self.picture("s.vti", "--slice", "z=0", "--color-by", "Radius", "--resolution", "101")[2]
        self.assertGreater(rows[400][556][2], rows[400][556][0])  # The middle is blue.
        drawn = [x for x in range(1100) if max(rows[400][x]) - min(rows[400][x]) > 60]
        self.assertGreater(rows[400][drawn[-1] - 3][1], rows[400][556][1] + 60)
        self.assertEqual(rows[5][556], (255, 255, 255))

    def test_no_display(self):
        environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
        for display in ({}, {"DISPLAY": ":4711"}):
            self.output.unlink(missing_ok=True)
            result = self.extract(*ISO, "--screenshot", "p.png", env={**environment, **display})
            self.assertTrue(self.output.exists())
            if result.returncode == 0:
                # This VTK renders without X, through EGL or in memory.
                self.assertTrue((self.directory / "p.png").exists())
                continue
            self.one_sentence(result, 1, "p.png could not be written: .*xvfb-run -a -s -noreset")


if __name__ == "__main__":
    main(display="Picture" in sys.argv)
