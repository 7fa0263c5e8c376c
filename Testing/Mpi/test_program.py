#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the program under mpirun: what processes make together, and what they say if one process fails.

    test_program.py PROGRAM MPIRUN FOLDER_OF_DATA RANKS PRELOAD

PRELOAD is the library made of ../CommandLine/misbehave.c.
"""

import filecmp
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
from particle_pieces import add, arrays_of, difference, read, take, write, write_pieces
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

sys.path.insert(0, str(Path(__file__).parents[1]))
from says import says  # noqa: E402

PROGRAM, MPIRUN, DATA, RANKS, PRELOAD = sys.argv[1:6]
PARTICLES = os.path.join(DATA, "double_dam_break_small.vtp")
BOUND = 240  # No job may take longer than this many seconds.


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def text(self, name):
        return Path(self.path(name)).read_text(encoding="utf-8")

    def run_alone(self, *arguments):
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=BOUND, check=False)

    def run_ranks(self, *arguments, first="", **environment):
        """Runs the program under mpirun. first: a shell's command that each process runs first; $rank is the process's number."""
        script = 'rank=${OMPI_COMM_WORLD_RANK:-$PMI_RANK}; ' + first + ' exec "$@"'
        return subprocess.run([MPIRUN, "-n", RANKS, "sh", "-c", script, "-", PROGRAM, *arguments], env={**os.environ, **environment},
                              capture_output=True, text=True, timeout=BOUND, check=False)

    def good(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def sentences(self, done):
        """Returns the program's sentences, without the one about a driver's first compilation."""
        return [line for line in done.stderr.splitlines()
                if line.startswith("marching-correctors:") and "for the first time" not in line]

    def check_fails(self, done, *words):
        self.assertNotEqual(done.returncode, 0, done.stderr)
        sentences = self.sentences(done)
        self.assertEqual(len(sentences), 1, done.stderr)
        for word in words:
            self.assertIn(word, sentences[0])

    def check_equal(self, alone, ranks):
        """Fails unless both data sets have the same points, triangles, lines and arrays of points."""
        pairs = [(array, ranks.GetPointData().GetArray(array.GetName())) for array in arrays_of(alone)]
        for get in (lambda p: p.GetPoints().GetData(), lambda p: p.GetLines().GetConnectivityArray(),
                    lambda p: p.GetLines().GetOffsetsArray(), lambda p: p.GetPolys().GetConnectivityArray()):
            pairs.append((get(alone), get(ranks)))
        for one, other in pairs:
            np.testing.assert_array_equal(vtk_to_numpy(one), vtk_to_numpy(other), one.GetName())

    def check_surfaces(self, particles, pieces, *how):
        """Fails unless processes that read pieces write one file with the same points, triangles and arrays as one process."""
        done = [self.good(self.run_alone(particles, self.path("alone.vtp"), *how)),
                self.good(self.run_ranks(pieces, self.path("ranks.vtp"), *how))]
        alone, ranks = read(self.path("alone.vtp")), read(self.path("ranks.vtp"))
        self.assertGreater(alone.GetNumberOfPolys(), 1000)
        self.check_equal(alone, ranks)
        return done

    def test_one_file(self):
        how = ["--scalar", "Speed", "--iso", "2", "--stats", self.path("s.json")]
        _, done = self.check_surfaces(PARTICLES, PARTICLES, *how)
        self.assertIn("rank_particles", self.text("s.json"))
        self.assertEqual(done.stdout.count("surface "), 1, done.stdout)

    def write_plane(self):
        """Writes the particles, moved into the plane z = 0.5, with smoothing lengths from 0.04 to 0.16."""
        plane = read(PARTICLES)
        at = vtk_to_numpy(plane.GetPoints().GetData())
        at[:, 2] = 0.5
        low, high = at[:, 0].min(), at[:, 0].max()
        length = 0.04 * 4 ** ((at[:, 0].astype(float) - low) / (high - low))
        write(add(plane, PlaneLength=length, PlaneArea=length ** 2), self.path("plane.vtp"))
        return self.path("plane.vtp")

    def check_same(self, name, particles, pieces, *how):
        """Fails unless processes write the same bytes as one process. pieces: number of files that they read; 0: one. Returns both runs."""
        source = write_pieces(particles, self.folder.name, pieces) if pieces else particles
        alone = self.good(self.run_alone(particles, self.path("alone_" + name), *how))
        done = self.good(self.run_ranks(source, self.path(name), *how))
        self.assertTrue(filecmp.cmp(self.path("alone_" + name), self.path(name), shallow=False), how)
        return alone, done

    def test_in_a_plane(self):
        """Compares filled regions and their lines, in one file and in pieces; test_ranks.py compares more surfaces."""
        how = ["--smoothing-length", "PlaneLength", "--volume", "PlaneArea", "--scalar", "Speed", "--iso", "1,2", "--filled", "--weight-sum", "--gradients",
               "--box=-1,0.6,-inf,inf,-inf,inf", "--periodic", "0,1.3,0"]
        self.check_same("out.vtp", self.write_plane(), 3, *how)
        self.good(self.run_ranks(self.path("pieces.pvtp"), self.path("out.pvtp"), *how, "--quiet"))
        alone, ranks = read(self.path("out.vtp")), read(self.path("out.pvtp"))
        self.assertGreater(alone.GetNumberOfPolys(), 0)
        self.check_equal(alone, ranks)

    def test_same_file(self):
        """Several processes write the same bytes as one. The surfaces are trimmed at two iso values, with a period, a box, caps or walls.
        The first process reads the files of walls. Walls here lie at places of fluid particles."""
        write_pieces(PARTICLES, self.folder.name, 4)
        walls = [word for i in (1, 3) for word in ("--walls", self.path(f"piece_{i}.vtp"))]
        trimmed = ["--scalar", "Speed", "--iso", "1,2", "--no-attributes"]
        for how in ([*trimmed, "--topology", "field"], [*trimmed, "--periodic", "0,0,3.1", "--box=-1,inf,-inf,inf,-0.5,inf"],
                    ["--free-surface", "--capping", "--box=-1,0.9,-inf,0.4,-inf,0.5"],
                    [*trimmed, "--capping", "--periodic=-1,1,-0.5,1.1,-1.05,1.05", "--cube-size", "0.04"],
                    [*trimmed, "--solids", "wall", *walls]):
            self.check_same("out.ply", PARTICLES, 0, *how)
            self.assertGreater(os.path.getsize(self.path("out.ply")), 50000)

    def test_tables_and_images(self):
        """Compares gauges, fluxes, an image of levels and projections; core_gauge_ranks and core_project test their sums over ranks."""
        gauges = ["--gauge", "a=0,-0.1,0:0,1.2,0", "--gauge", "b=-2,0.1,-1:2,0.3,1", "--periodic", "0,0,3.1"]
        fluxes = ["--flux", "a=box:-1,0.1,-0.1,0.2,-1,0.5", "--flux", "b=disc:0,0.1,0:1,0.2,0:1.4", "--periodic", "0,0,3.1"]
        view = ["--resolution", "150", "--project"]
        walls = ["--gauge", "a=0.8,0,-0.1:0.8,0,1", "--gauge", "b=-1,0.1,0.05:4,0.1,0.05", "--fluid", "ParticleType=0", "--periodic", "0,0,1"]
        for name, file, how in (
                ("gauges.csv", PARTICLES, gauges), ("fluxes.csv", PARTICLES, fluxes), ("walls.csv", os.path.join(DATA, "dam_break_45k.vtp"), walls),
                ("levels.vti", PARTICLES, ["--gauge-grid", "13,7:-1.5,1.5,-0.1,0.9,-1.6,1.6"]),
                ("view.vti", PARTICLES, [*view, "1,2,3", "--periodic", "0,0,3.1", "--smoothing-length", "estimate"]),
                ("view.vti", PARTICLES, [*view, "y", "--scalar", "Velocity", "--weighted-by", "Mass"])):
            alone, done = self.check_same(name, file, 5, *how)
            if name == "gauges.csv":
                self.assertEqual(done.stdout, alone.stdout)
        for name, time in ("gauges.csv", "0,"), ("walls.csv", "0.9"):  # The pieces have the time of their file.
            rows = self.text(name).splitlines()[1:]
            self.assertTrue(all(row.startswith(time) for row in rows) and any(",wet," in row for row in rows), rows)
        self.check_fails(self.run_ranks(PARTICLES, self.path("o.csv"), "--gauge", "a=0,0,0:0,0,1", "--smoothing-length", "Nope"), "Nope")
        self.check_fails(self.run_ranks(PARTICLES, self.path("no/o.csv"), "--gauge", "a=0,0,0:0,0,1"), "no/o.csv")

    def test_types_of_pieces(self):
        """An array that is int8 in one piece and float64 in the others gets the same values, whichever process reads the int8 piece."""
        whole = read(PARTICLES)
        steps = np.floor(vtk_to_numpy(whole.GetPointData().GetArray("Speed")))
        write(add(whole, Steps=steps), self.path("whole.vtp"))
        how = ["--scalar", "Steps", "--iso", "1.5", "--quiet"]
        self.good(self.run_alone(self.path("whole.vtp"), self.path("alone.vtp"), *how))
        alone = read(self.path("alone.vtp"))
        self.assertGreater(alone.GetNumberOfPolys(), 1000)
        for odd in range(3):
            pieces = write_pieces(self.path("whole.vtp"), self.folder.name, 3)
            part = read(self.path(f"piece_{odd}.vtp"))
            small = vtk_to_numpy(part.GetPointData().GetArray("Steps")).astype(np.int8)
            write(add(part, Steps=small), self.path(f"piece_{odd}.vtp"))
            for run in self.run_alone, self.run_ranks:
                self.good(run(pieces, self.path("ranks.vtp"), *how))
                found = read(self.path("ranks.vtp"))
                self.check_equal(alone, found)
                self.good(run(pieces, self.path("ranks.vtp"), "--scalar", "Speed", "--iso", "2", "--quiet"))
                kind = read(self.path("ranks.vtp")).GetPointData().GetArray("Steps")
                self.assertEqual(kind and kind.GetDataTypeAsString(), "double")

    def test_arrays_of_some_pieces(self):
        """An array that some pieces lack is named once, although each process has such pieces."""
        pieces = write_pieces(PARTICLES, self.folder.name, 6)
        for piece in range(0, 6, 2):
            part = read(self.path(f"piece_{piece}.vtp"))
            part.GetPointData().RemoveArray("Speed")
            write(part, self.path(f"piece_{piece}.vtp"))
        for run in self.run_alone, self.run_ranks:
            done = self.good(run(pieces, self.path("o.vtp"), "--free-surface", "--quiet"))
            self.assertRegex(done.stderr, "note: " + says("ARRAYS_NOT_SHARED", "Speed"))
            self.assertEqual(done.stderr.count("note: "), 1, done.stderr)

    def test_warnings(self):
        """A warning of the core appears once, as with one process."""
        tilted = read(PARTICLES)
        at = vtk_to_numpy(tilted.GetPoints().GetData())
        at[:, 2] = 0.75 * at[:, 0]
        write(tilted, self.path("tilted.vtp"))
        pieces = write_pieces(self.path("tilted.vtp"), self.folder.name, 3)
        for file, alone, words, how in ((PARTICLES, PARTICLES, "outside the range of Speed", ["--scalar", "Speed", "--iso", "99"]),
                                        (pieces, self.path("tilted.vtp"), "tilted in space", ["--free-surface", "--iso", "0.1"])):
            said = [[line.split("warning: ")[1] for line in done.stderr.splitlines() if words in line]
                    for done in (self.run_alone(alone, self.path("s.vtp"), *how), self.run_ranks(file, self.path("s.vtp"), *how))]
            self.assertEqual(len(said[0]), 1)
            self.assertEqual(said[0], said[1])

    def test_particle_distance(self):
        """The particles of all processes together decide the dimension. First the particles lie in two planes; then the
        particles in the second plane are walls, which are ignored."""
        plane = read(self.write_plane())
        at = vtk_to_numpy(plane.GetPoints().GetData())
        at[:, 2] = np.where(np.arange(len(at)) < len(at) // 2, 0.5, 0.6)
        write(plane, self.path("two.vtp"))
        pieces = write_pieces(self.path("two.vtp"), self.folder.name, 2)
        write(add(plane, Wall=(at[:, 2] > 0.55).astype(float)), self.path("wall.vtp"))
        for file, how, dimension in ((pieces, [], 3),
                                     (self.path("wall.vtp"), ["--fluid", "Wall=0", "--solids", "ignore"], 2)):
            self.good(self.run_ranks(file, self.path("s.vtp"), "--free-surface", "--dp", "0.03", "--stats", self.path("s.json"), *how))
            length = json.loads(self.text("s.json"))["statistics"]["smoothing_length_range"]
            self.assertEqual(length, [0.03 * math.sqrt(dimension)] * 2)

    def test_period_of_data(self):
        """The field data give the period, even if only one piece has it. Different periods in two pieces are refused."""
        pieces = write_pieces(PARTICLES, self.folder.name, int(RANKS) + 1)
        how = ["--scalar", "Speed", "--iso", "2", "--no-attributes", "--periodic"]
        self.check_fails(self.run_ranks(pieces, self.path("o.ply"), *how, "auto"), "give no period")
        self.set_box_size("piece_0.vtp", 1, 0, 0, 0.5, 1, 0, 0, 0, 1)
        self.check_fails(self.run_ranks(pieces, self.path("o.ply"), *how, "auto"), "cell of the particles is tilted")
        write_pieces(PARTICLES, self.folder.name, int(RANKS) + 1)
        self.set_box_size("piece_2.vtp", 0, 0, 3.1)
        for output, run, period in ("alone.ply", self.run_alone, "0,0,3.1"), ("ranks.ply", self.run_ranks, "auto"):
            self.good(run(PARTICLES if run == self.run_alone else pieces, self.path(output), *how, period))
        self.assertTrue(filecmp.cmp(self.path("alone.ply"), self.path("ranks.ply"), shallow=False))
        self.set_box_size("piece_0.vtp", 0, 0, 3.2)
        self.check_fails(self.run_ranks(pieces, self.path("o.ply"), *how, "auto"), "different periods: BoxSize 0,0,3.2 on rank 0, "
                         "BoxSize 0,0,3.1 on rank 1")

    def set_box_size(self, piece, *size):
        part = read(self.path(piece))
        array = numpy_to_vtk(np.array(size, float), deep=True)
        array.SetName("BoxSize")
        part.GetFieldData().AddArray(array)
        write(part, self.path(piece))

    def test_empty(self):
        """A surface without points has the same arrays as one process writes, in one file and in pieces."""
        def forms(file):
            surface = read(self.path(file))
            self.assertEqual(surface.GetNumberOfPoints(), 0)
            return {(array.GetName(), array.GetDataType(), array.GetNumberOfTuples(),
                     *map(array.GetComponentName, range(array.GetNumberOfComponents())))
                    for data in (surface.GetPointData(), surface.GetCellData())
                    for array in map(data.GetArray, range(data.GetNumberOfArrays())) if not array.GetName().startswith("Global")}

        for particles, how in ((PARTICLES, ["--scalar", "Speed", "--iso", "99", "--gradients"]),
                               (PARTICLES, ["--free-surface", "--iso", "50,60"]),
                               (self.write_plane(), ["--scalar", "Speed", "--iso", "99", "--filled"])):
            self.good(self.run_alone(particles, self.path("alone.vtp"), *how, "--quiet"))
            alone = forms("alone.vtp")
            self.assertGreater(len(alone), 5)
            for file, part in ("ranks.vtp", "ranks.vtp"), ("out.pvtp", "out_1.vtp"):
                self.good(self.run_ranks(particles, self.path(file), *how, "--quiet"))
                self.assertEqual(forms(part), alone)

    def test_pieces(self):
        """Processes read and write pieces. There are more pieces than processes."""
        pieces = write_pieces(PARTICLES, self.folder.name, 5)
        self.good(self.run_alone(PARTICLES, self.path("alone.vtp"), "--free-surface"))
        self.good(self.run_ranks(pieces, self.path("out.pvtp"), "--free-surface"))
        alone, ranks = read(self.path("alone.vtp")), read(self.path("out.pvtp"))
        self.assertEqual(difference(ranks, alone), "")
        self.assertEqual(ranks.GetPointData().GetNormals().GetName(), "Normals")
        self.assertEqual(ranks.GetPointData().GetGlobalIds().GetName(), "GlobalPointIds")
        self.assertEqual(ranks.GetCellData().GetGlobalIds().GetName(), "GlobalCellIds")

    def test_probe(self):
        """Probes points of one file in particles of several pieces. The arrays equal one process's to the last byte."""
        image = vtkImageData()
        low, high = np.reshape(read(PARTICLES).GetBounds(), (3, 2)).T
        image.SetOrigin(*low)
        image.SetDimensions(33, 17, 19)
        image.SetSpacing(*((high - low) / (32, 16, 18)))
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(self.path("points.vti"))
        writer.SetInputData(image)
        writer.Write()
        how = ["--probe", self.path("points.vti"), "--derive", "Velocity", "--gradients"]
        alone, done = self.check_same("ranks.vti", PARTICLES, 5, *how)
        self.assertEqual(done.stdout.count("points "), 1, done.stdout)
        self.assertEqual(done.stdout.splitlines()[0], alone.stdout.splitlines()[0])
        self.assertIn("Lambda2_Gradient", self.image_arrays(self.path("ranks.vti")))
        self.check_fails(self.run_ranks(PARTICLES, self.path("o.vti"), "--probe", self.path("points.vti"),
                                        "--smoothing-length", "Nope"), "Nope")
        self.assertFalse(os.path.exists(self.path("o.vti")))

    def test_factors(self):
        """With --widening, the first process writes all particles in the order of the pieces, with the same arrays as a run of one
        process. One particle is so far away that it is left out."""
        particles = read(PARTICLES)
        particles.GetPoints().SetPoint(7, 3e5, -1e5, 1e6)
        for how in ([], ["--smoothing-length", "estimate", "--periodic", "0,0,3", "--no-attributes"]):
            for name in ("Mass", "Density", "Volume") if how else ():  # Without these, volumes are computed.
                particles.GetPointData().RemoveArray(name)
            write(particles, self.path("in.vtp"))
            pieces = write_pieces(self.path("in.vtp"), self.folder.name, 5)
            for name, run in (("alone", self.run_alone), ("ranks", self.run_ranks)):
                done = self.good(run(pieces, self.path(name + "_surface.vtp"), "--free-surface", "--smooth", *how,
                                     "--widening", self.path(name + ".vtp")))
                self.assertRegex(done.stderr, says("PARTICLE_FAR"))
            for file in ("_surface.vtp", ".vtp"):
                alone, ranks = read(self.path("alone" + file)), read(self.path("ranks" + file))
                self.assertGreater(alone.GetPointData().GetArray("Widening").GetRange()[1], 1.5)
                self.assertEqual(*([data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]
                                   for data in (alone.GetPointData(), ranks.GetPointData())))
                self.check_equal(alone, ranks)
            self.assertEqual(alone.GetPointData().HasArray("WideningVolume"), bool(how))

    def test_names_of_factors(self):
        """Arrays of the particles may have the names of arrays that widening makes. Such arrays are contoured and interpolated as usual."""
        particles = read(PARTICLES)
        x = vtk_to_numpy(particles.GetPoints().GetData())[:, 0]
        write(add(particles, Widening=x, WideningVolume=x), self.path("in.vtp"))
        self.check_surfaces(self.path("in.vtp"), write_pieces(self.path("in.vtp"), self.folder.name, 3),
                            "--scalar", "Widening", "--iso", str(particles.GetCenter()[0]), "--widen", "2")
        alone, ranks = read(self.path("alone.vtp")).GetPointData(), read(self.path("ranks.vtp")).GetPointData()
        self.assertGreater(alone.GetArray("Widening").GetRange()[1], 1.5)
        self.assertTrue(alone.HasArray("WideningVolume") and alone.HasArray("IsoValue"))
        self.assertEqual(*([data.GetArrayName(i) for i in range(data.GetNumberOfArrays())] for data in (alone, ranks)))

    def write_series(self):
        """Writes three steps with ids and velocities: the first in pieces, the second in one file, the third damaged."""
        particles = read(PARTICLES)
        count = particles.GetNumberOfPoints()
        write(add(particles, ParticleId=np.arange(count, dtype=np.int32)), self.path("first.vtp"))
        write_pieces(self.path("first.vtp"), self.folder.name, 5)
        velocity = vtk_to_numpy(particles.GetPointData().GetArray("Velocity"))
        moved = take(particles, np.random.default_rng(3).permutation(count))
        places = vtk_to_numpy(moved.GetPoints().GetData())
        places += 0.02 * velocity[vtk_to_numpy(moved.GetPointData().GetArray("ParticleId"))]
        write(moved, self.path("second.vtp"))
        Path(self.path("third.vtp")).write_text('<?xml version="1.0"?><VTKFile type="PolyData">', encoding="ascii")
        files = enumerate(("pieces.pvtp", "second.vtp", "third.vtp"))
        steps = "".join(f'<DataSet timestep="{0.02 * i}" file="{name}"/>' for i, name in files)
        Path(self.path("steps.pvd")).write_text(
            f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{steps}</Collection></VTKFile>', encoding="ascii")
        return self.path("steps.pvd")

    def check_same_files(self, names):
        for name in names:
            self.assertGreater(os.path.getsize(self.path("alone/" + name)), 20)
            self.assertTrue(filecmp.cmp(self.path("alone/" + name), self.path("ranks/" + name), shallow=False), name)

    def test_film(self):
        """Processes write the same bytes as one process: a film at stored times and between them, its tables, gauges, and values at
        points. A step that fails is named once, and all other steps are made."""
        steps = self.write_series()
        gauges = ["--gauge", "a=0,-0.1,0:0,1.2,0", "--gauge", "b=-2,0.1,-1:2,0.3,1"]
        points = self.path("points.csv")
        Path(points).write_text("x,y,z\n0,0.1,0\n-0.5,0.1,0.2\n9,9,9\n", encoding="ascii")
        for name, run in (("alone", self.run_alone), ("ranks", self.run_ranks)):
            os.mkdir(self.path(name))
            how = ["--free-surface", "--iso", "0.5,0.3", *gauges, "--components", self.path(name + "/pieces.csv"), "--least-particles", "2",
                   "--numbers", self.path(name + "/numbers.csv"), "--periodic", "0,0,3.1"]
            done = self.good(run(steps, self.path(name + "/film_%04d.ply"), *how, "--times", "0,0.007,0.02"))
            self.assertEqual(done.stdout.count(" triangles, "), 3, done.stdout)
            done = run(steps, self.path(name + "/list.pvd"), "--free-surface")
            self.check_fails(done, "third.vtp", "list_0002.vtp")
            self.assertEqual(done.stdout.count(" triangles, "), 2, done.stdout)
            self.good(run(steps, self.path(name + "/levels.csv"), *gauges, "--times", "0.007,0.02"))
            self.good(run(steps, self.path(name + "/values.csv"), "--probe", points, "--times", "0:0.02:0.01"))
        self.check_same_files(["film_0000.ply", "film_0001.ply", "film_0002.ply", "pieces.csv", "numbers.csv", "list.pvd",
                               "levels.csv", "values.csv"])
        alone, ranks = (read(self.path(name + "/list_0001.vtp")) for name in ("alone", "ranks"))
        np.testing.assert_array_equal(vtk_to_numpy(alone.GetPoints().GetData()), vtk_to_numpy(ranks.GetPoints().GetData()))
        self.assertEqual(len(set(self.text("ranks/numbers.csv").splitlines())), 7)
        picture = self.run_ranks(steps, self.path("o.pvd"), "--free-surface", "--screenshot", self.path("o_%04d.png"))
        self.check_fails(picture, "--screenshot")

    def test_components(self):
        """The table of pieces, and the surface with the pieces' numbers, have the same bytes as one process makes."""
        walls = ["--fluid", "ParticleType=0", "--solids", "wall", "--wall-share", "0.4", "--capping", "--periodic", "0,0,0.67"]
        for particles, how in ((PARTICLES, ["--free-surface", "--least-particles", "3"]),
                               (os.path.join(DATA, "dam_break_45k.vtp"), ["--free-surface", *walls]),
                               (PARTICLES, ["--free-surface", "--capping", "--periodic", "5,8.1,0,0,0,0"]),
                               (PARTICLES, ["--scalar", "Speed", "--iso", "2", "--periodic=-1,1,0,0,-1,0.5"])):
            table = ["--components", self.path("alone.csv"), *how]
            alone = self.good(self.run_alone(particles, self.path("alone.vtp"), *table))
            whole = read(self.path("alone.vtp"))
            self.assertGreater(whole.GetPointData().GetArray("ComponentId").GetRange()[1], 1)
            line = next(line for line in alone.stdout.splitlines() if line.startswith("surface"))
            self.assertIn(" pieces of area ", line)
            pieces = write_pieces(particles, self.folder.name, 5)
            table[1] = self.path("ranks.csv")
            self.assertIn(line, self.good(self.run_ranks(pieces, self.path("ranks.vtp"), *table)).stdout.splitlines())
            self.assertTrue(filecmp.cmp(self.path("alone.csv"), self.path("ranks.csv"), shallow=False))
            self.assertTrue(filecmp.cmp(self.path("alone.vtp"), self.path("ranks.vtp"), shallow=False))
            self.good(self.run_ranks(pieces, self.path("out.pvtp"), *table))
            self.assertTrue(filecmp.cmp(self.path("alone.csv"), self.path("ranks.csv"), shallow=False))
            self.assertEqual(difference(read(self.path("out.pvtp")), whole), "")

    def image_arrays(self, file):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(file)
        reader.Update()
        data = reader.GetOutput().GetPointData()
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    def test_damaged_piece(self):
        pieces = write_pieces(PARTICLES, self.folder.name, 3)
        with open(self.path("piece_1.vtp"), "r+", encoding="latin-1") as stream:
            stream.truncate(3000)
        done = self.run_ranks(pieces, self.path("out.pvtp"), "--free-surface")
        self.check_fails(done, "piece_1.vtp", "end is missing")
        self.assertFalse(os.path.exists(self.path("out.pvtp")))

    def test_full_disk(self):
        """If one process cannot write its piece, as on a full disk, all files stay as they were, and nothing is left behind."""
        how = [PARTICLES, self.path("out.pvtp"), "--free-surface", "--stats", self.path("s.json")]
        names = ["out.pvtp", "s.json", *(f"out_{i}.vtp" for i in range(int(RANKS)))]
        self.good(self.run_ranks(*how))
        self.assertEqual(sorted(os.listdir(self.folder.name)), sorted(names))
        for old in (True, False):
            for name in names:
                os.remove(self.path(name))
            for name in names if old else []:
                Path(self.path(name)).write_text("old", encoding="ascii")
            done = self.run_ranks(*how, first=f'test $rank != 1 || export LD_PRELOAD="{PRELOAD}" MCOR_FAILING_CALL=fsync;',
                                  MCOR_FAILING_FOLDER=self.folder.name)
            self.check_fails(done, "out_1.vtp could not be written")
            self.assertEqual(sorted(os.listdir(self.folder.name)), sorted(names) if old else [])
            for name in names if old else []:
                self.assertEqual(self.text(name), "old", name)

    def test_own_disks(self):
        """Each process but the first looks only at the files that it writes, because processes may have disks of their own."""
        enter = f"mkdir {self.folder.name}/$rank; cd {self.folder.name}/$rank; test $rank = 0 || mkdir out_0.vtp;"
        self.good(self.run_ranks(os.path.abspath(PARTICLES), "out.pvtp", "--free-surface", first=enter))
        self.assertTrue(os.path.isfile(self.path("1/out_1.vtp")))

    def test_files_of_others(self):
        """A run is refused if an output would overwrite a piece of the particles or another output. No file changes."""
        pieces = write_pieces(PARTICLES, self.folder.name, 2)
        before = {name: os.path.getsize(self.path(name)) for name in os.listdir(self.folder.name)}
        self.assertIn("piece_1.vtp", before)
        how = ["--free-surface"]
        first, second = self.path("piece_0.vtp"), self.path("piece_1.vtp")
        for source, arguments, words in [
            (pieces, [self.path("piece.pvtp")], "piece_0.vtp would overwrite the input"),
            (pieces, [self.path("o.pvtp"), "--stats", second], "piece_1.vtp would overwrite the input"),
            (second + "#0", [self.path("piece.pvtp")], "piece_1.vtp would overwrite the input"),
            (first, [self.path("o.vtp"), "--walls", second + "#0", "--stats", second], "piece_1.vtp would overwrite the input"),
            (pieces, [self.path("o.pvtp"), "--stats", self.path("o_1.vtp")], "o_1.vtp would be written twice"),
            (pieces, [self.path("o.vti"), "--slice", "z=0", "--stats", self.path("o.vti")], "--stats is for surfaces and films, not for slices"),
        ]:
            done = self.run_ranks(source, *arguments, *([] if "--slice" in arguments else how))
            self.check_fails(done, words)
            self.assertEqual({name: os.path.getsize(self.path(name)) for name in os.listdir(self.folder.name)}, before)

    def test_usage(self):
        """A mistake on the command line is reported once, even if the first process is the last to see it."""
        done = self.run_ranks(PARTICLES, self.path("o.vtp"), "--nope", first="test $rank != 0 || sleep 1;")
        self.check_fails(done, "--nope")

    def test_first_without_particles(self):
        """Messages about the particles, the active array, and the bounds of a slice do not depend on which process has the particles."""
        particles = read(PARTICLES)
        write(add(particles, Type=(np.arange(particles.GetNumberOfPoints()) % 5 == 0).astype(np.int32)), self.path("in.vtp"))
        pieces = write_pieces(self.path("in.vtp"), self.folder.name, 3)
        write(take(particles, []), self.path("piece_0.vtp"))
        for name, *how in (("s.vti", "--slice", "z=0", "--resolution", "64"), ("s.vtp", "--free-surface")):
            said = [self.sentences(self.good(run(pieces, self.path(who + name), *how)))
                    for who, run in (("alone", self.run_alone), ("ranks", self.run_ranks))]
            self.assertIn("Type", said[0][0])
            self.assertEqual(said[0], said[1])
            self.assertTrue(filecmp.cmp(self.path("alone" + name), self.path("ranks" + name), shallow=False), name)
        self.assertGreater(np.count_nonzero(self.image_arrays(self.path("rankss.vti"))["vtkValidPointMask"]), 100)

    def test_bad_value(self):
        """A NaN in one piece fails the run on all processes, with one sentence."""
        pieces = write_pieces(PARTICLES, self.folder.name, 2)
        part = read(self.path("piece_1.vtp"))
        part.GetPoints().SetPoint(5, float("nan"), 0, 0)
        write(part, self.path("piece_1.vtp"))
        self.check_fails(self.run_ranks(pieces, self.path("o.vtp"), "--free-surface"), "Rank 1", "particle 5")

    def test_killed(self):
        """If a process is killed, the job ends."""
        job = subprocess.Popen([MPIRUN, "-n", RANKS, PROGRAM, os.path.join(DATA, "dam_break_45k.vtp"),
                                self.path("o.vtp"), "--free-surface", "--cube-factor", "0.2"],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
        try:
            victim = None
            end = time.monotonic() + 60
            while victim is None and time.monotonic() < end:
                time.sleep(0.2)
                found = subprocess.run(["ps", "--ppid", str(job.pid), "-o", "pid="], capture_output=True,
                                       text=True, check=False).stdout.split()
                victim = int(found[-1]) if len(found) == int(RANKS) else None
            self.assertIsNotNone(victim)
            time.sleep(0.5)
            os.kill(victim, signal.SIGKILL)
            job.communicate(timeout=60)
            self.assertNotEqual(job.returncode, 0)
        finally:
            if job.poll() is None:
                os.killpg(job.pid, signal.SIGKILL)
                job.communicate()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[6:], verbosity=2)
