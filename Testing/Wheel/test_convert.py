# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests which files python -m marchingcorrectors convert writes, and which it leaves alone."""
import os
import signal
import stat
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as xml

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from marchingcorrectors import InputWarning
from marchingcorrectors.io import FileError, Particles
from marchingcorrectors.io.convert import to_vtk, vtp_bytes
from test_files import Case

NAME = 'a<b>&"c\' d'


def particles(count=3, name="made", **arrays):
    positions = np.arange(3.0 * count).reshape(count, 3)
    return Particles(name, "made", lambda: positions, {key: lambda v=values: v for key, values in arrays.items()})


class Convert(Case):
    def setUp(self):
        super().setUp()
        for i in range(2):
            self.at(f"run_{i:04d}.vtp").write_bytes(vtp_bytes(particles(100 + i, Noise=np.random.default_rng(i).random((100 + i, 20)))))
        self.before = {path.name: path.read_bytes() for path in self.folder.iterdir()}

    def run_program(self, *names, command="convert", **more):
        return subprocess.run([sys.executable, "-m", "marchingcorrectors", command, *names], cwd=self.folder,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, timeout=300,
                              **more)

    def good(self, *names):
        done = self.run_program(*names)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def refuse(self, done, sentence, left=()):
        """Checks that the command failed with one line on stderr, and that the folder is as before, except for the
        files in `left`, which hold "old"."""
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, "^marchingcorrectors: .*" + sentence + ".*\n$")
        self.assertEqual({p.name: p.read_bytes() for p in self.folder.iterdir() if p.is_file()},
                         {**self.before, **{name: b"old" for name in left}})

    def read(self, name):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(self.at(name)))
        reader.Update()
        return reader.GetOutput()

    def test_inputs_stay(self):
        inputs = ["run_0001.vtp", "run_0000.vtp"]
        self.refuse(self.run_program(*inputs, "run.pvd"), "run_0000.vtp would overwrite the input")
        self.refuse(self.run_program(*inputs, "run_0001.vtp"), "run_0001.vtp would overwrite the input")
        os.link(self.at("run_0001.vtp"), self.at("hard_0001.vtp"))
        self.at("soft.vtp").symlink_to("run_0000.vtp")
        self.at("soft_0001.vtp").symlink_to("soft.vtp")
        self.at("folder").symlink_to(".")
        self.before = {path.name: path.read_bytes() for path in self.folder.iterdir() if path.is_file()}
        for output in ("hard.pvd", "soft.pvd", "soft.vtp", "hard_0001.vtp", "folder/run.pvd"):
            with self.subTest(output):
                self.refuse(self.run_program(*inputs, output), "would overwrite the input")

    def test_steps_replace_steps_alone(self):
        for _ in range(2):
            self.good("run_0000.vtp", "run_0001.vtp", "film.pvd")
        self.assertEqual([self.read(f"film_{i:04d}.vtp").GetNumberOfPoints() for i in range(2)], [100, 101])
        for path in self.folder.glob("film*"):
            path.unlink()
        self.at("film_0001.vtp").write_text("old")
        self.refuse(self.run_program("run_0000.vtp", "run_0001.vtp", "film.pvd"), "film_0001.vtp already exists",
                    ["film_0001.vtp"])
        self.at("film_0001.vtp").unlink()
        self.at("film_0000.vtp").symlink_to("film_0001.vtp")
        self.refuse(self.run_program("run_0000.vtp", "run_0001.vtp", "film.pvd"), "film_000[01].vtp would be written twice")

    def test_all_or_none(self):
        self.at("film.pvd").write_text("old")
        self.at("broken.vtp").write_text("old")
        self.refuse(self.run_program("run_0000.vtp", "broken.vtp", "film.pvd"), "broken.vtp", ["film.pvd", "broken.vtp"])

    def limited(self, name):
        import resource

        self.at(name).write_text("old")
        return self.run_program("run_0000.vtp", name,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024)))

    @unittest.skipIf(os.name == "nt", "Windows has neither limits nor modes")
    def test_limit(self):
        for name in ("old.vtp", "old.pvd"):
            self.refuse(self.limited(name), "could not be written: File too large", [name])
            self.at(name).unlink()

    @unittest.skipUnless(sys.platform == "linux", "needs a file system of its own")
    def test_full_disk(self):
        script = ('mount -t tmpfs -o $0 none full || exit 77; file=full/$1; shift; printf old >$file; "$@" $file; status=$?; ls -A full; '
                  'cat $file; exit $status')
        self.at("full").mkdir()
        make = ["surface", "--smoothing-length", "5"]
        for name, size, why, words in (
                ("o.vtp", "size=8k", "", ["convert"]), *((f"o.{ending}", "size=8k", "", make) for ending in ("npz", "obj", "vtp")),
                ("o.usdc", "nr_inodes=3", "Unable to create temporary file in '.*': ", [*make, "--time-step", "1"])):
            done = subprocess.run(["unshare", "--mount"] + (["--map-root-user"] if os.geteuid() else []) + [
                "sh", "-c", script, size, name, sys.executable, "-m", "marchingcorrectors", *words, "run_0000.vtp"], cwd=self.folder,
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
            if "unshare" in done.stderr or done.returncode == 77:
                self.skipTest("no file system can be mounted here")
            self.assertEqual(done.stdout, f"{name}\nold")
            self.refuse(done, f"{name} could not be written: {why}No space left on device")

    @unittest.skipIf(os.name == "nt", "Windows has neither limits nor modes")
    def test_links_and_modes(self):
        self.at("target.vtp").write_text("old")
        self.at("target.vtp").chmod(0o640)
        self.at("o.vtp").symlink_to("target.vtp")
        os.link(self.at("target.vtp"), self.at("other"))
        self.good("run_0000.vtp", "o.vtp")
        self.assertEqual(os.readlink(self.at("o.vtp")), "target.vtp")
        self.assertEqual(self.read("target.vtp").GetNumberOfPoints(), 100)
        self.assertEqual(stat.S_IMODE(self.at("target.vtp").stat().st_mode), 0o640)
        self.assertEqual(self.at("other").read_text(), "old")
        self.good("run_0000.vtp", "new.vtp")
        mask = os.umask(0)
        os.umask(mask)
        self.assertEqual(stat.S_IMODE(self.at("new.vtp").stat().st_mode), 0o666 & ~mask)
        self.assertFalse([p for p in self.folder.iterdir() if p.name.startswith(".")])

    def test_commands(self):
        """The other commands follow the same rules for outputs as convert."""
        os.rename(self.at("run_0000.vtp"), self.at("in.vtp"))
        self.at("link.npz").symlink_to("in.vtp")
        self.at("old.csv").write_text("old")
        self.before = {path.name: path.read_bytes() for path in self.folder.iterdir()}
        words = ["--smoothing-length", "300", "--gauge", "up=0,0,0:0,0,900"]
        done = self.run_program("in.vtp", "link.npz", *words[:2], command="surface")
        self.refuse(done, "link.npz would overwrite the input")
        for name, status in (("nowhere/a.csv", 1), ("old.txt", 1), ("old.csv", 0)):
            done = self.run_program("in.vtp", name, *words, command="gauge")
            self.assertEqual(done.returncode, status, done.stderr)
            if status:
                self.refuse(done, "could not be written" if "nowhere" in name else "is a .csv file, not")
        self.assertTrue(self.at("old.csv").read_text().startswith("time,gauge,state"))
        self.assertFalse([p for p in self.folder.iterdir() if p.name.startswith(".")])

    @unittest.skipIf(os.name == "nt", "Windows has no such signals")
    def test_signals(self):
        self.at("large.vtp").write_bytes(vtp_bytes(particles(400000)))
        run = subprocess.Popen([sys.executable, "-m", "marchingcorrectors", "convert", "run_0000.vtp", "large.vtp",
                                "film.pvd"], cwd=self.folder, stderr=subprocess.PIPE)
        while run.poll() is None and not any(p.name.startswith(".film_0000") for p in self.folder.iterdir()):
            time.sleep(0.005)
        run.send_signal(signal.SIGTERM)
        self.assertEqual((run.communicate()[1], run.returncode), (b"", 128 + signal.SIGTERM))
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), sorted([*self.before, "large.vtp"]))

    def test_names(self):
        name = "a&b'c" if os.name == "nt" else NAME
        os.rename(self.at("run_0000.vtp"), self.at(name + ".vtp"))
        self.good(name + ".vtp", "run_0001.vtp", name + "2.pvd")
        listed = [each.get("file") for each in xml.parse(self.at(name + "2.pvd")).iter("DataSet")]
        self.assertEqual(listed, [f"{name}2_{i:04d}.vtp" for i in range(2)])
        self.assertEqual(self.read(listed[1]).GetNumberOfPoints(), 101)
        self.at("names.vtp").write_bytes(vtp_bytes(particles(2, **{NAME: np.array([1.0, 2.0]), "\u6c34": np.ones(2)})))
        arrays = self.read("names.vtp").GetPointData()
        self.assertEqual(vtk_to_numpy(arrays.GetArray(NAME)).tolist(), [1, 2])
        self.assertTrue(arrays.HasArray("\u6c34"))

    def test_types(self):
        big = np.array([1, 2, 2 ** 60 + 1], ">i8")
        arrays = {"half": np.array([1, 2.5, 3], np.float16), "long": np.array([1, 2.5, 3], np.longdouble), "big": big,
                  "flags": np.array([True, False, True]), "two": np.array([[1, 2], [3, 4], [5, 6]], np.float16),
                  "none": np.zeros((3, 0))}
        data = to_vtk(particles(**arrays)).GetPointData()
        for name, values in arrays.items():
            if name == "none":
                self.assertFalse(data.HasArray(name))
            else:
                self.assertEqual(vtk_to_numpy(data.GetArray(name)).tolist(), values.astype(values.dtype.newbyteorder("="))
                                 .tolist() if name == "big" else values.astype(float).tolist())
        for name, values in (("bytes", np.array([b"a", b"b", b"c"])), ("complex", np.ones(3, complex))):
            with self.subTest(name), self.assertWarnsRegex(InputWarning, f"the array '{name}' .* is left out"):
                self.assertFalse(to_vtk(particles(**{name: values})).GetPointData().HasArray(name))
        for kind in (np.float16, np.longdouble, ">f4", int):
            made = Particles("a.x", "test", lambda kind=kind: np.arange(9).reshape(3, 3).astype(kind), {})
            self.assertEqual(vtk_to_numpy(to_vtk(made).GetPoints().GetData()).ravel().tolist(), list(range(9)))

    def test_smoothing_lengths(self):
        made = particles(h=np.array([1.0, 2, 3]), wide=np.ones((3, 2)))
        made.smoothing_length = "h"
        self.assertEqual(vtk_to_numpy(to_vtk(made).GetPointData().GetArray("SmoothingLength")).tolist(), [1, 2, 3])
        made.smoothing_length = "wide"
        with self.assertRaisesRegex(FileError, r"'wide' has the shape \(3, 2\), where .* for each of 3"):
            to_vtk(made)


if __name__ == "__main__":
    unittest.main()
