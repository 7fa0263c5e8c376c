# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""marchingcorrectors.io: what is damaged, empty or hostile gives one sentence and nothing else, and no code of it is run."""
import gzip
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np
import pyvista
from vtkmodules.vtkIOLegacy import vtkUnstructuredGridWriter

from marchingcorrectors import io
from test_files import DENSITY, X, Case, quietly, write_bgeo, write_bi4, write_gadget, write_phantom, write_pysph


def write_vtk(path):
    body = pyvista.PolyData(X.astype(np.float32))
    body["Density"], body["Velocity"] = DENSITY, X
    (body if path.suffix != ".vtu" else body.cast_to_unstructured_grid()).save(path)


def write_grid(path, text=False):
    """As SPlisHSPlasH does."""
    body = pyvista.PolyData(X.astype(np.float32))
    body["Density"], body["Velocity"] = DENSITY, X
    writer = vtkUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(body.cast_to_unstructured_grid())
    writer.SetFileVersion(42)
    writer.SetFileType(1 if text else 2)
    writer.Write()


class Hostile(Case):
    def test_pickles(self):
        class Canary:
            def __reduce__(self):
                return os.mkdir, (str(Path(tempfile.gettempdir()) / "canary"),)

        np.savez(self.at("run.npz"), particles=np.array([Canary()], object))
        self.assert_refused("pickles, which can run code", self.at("run.npz"))
        self.assertFalse((Path(tempfile.gettempdir()) / "canary").exists())

    def test_no_particles(self):
        for name in ("a.hdf5", "a.bi4", "a.bgeo", "a.vtp", "a.vtk"):
            self.assert_refused("There is no file", self.at(name))
            self.at(name).touch()
            self.assert_refused("is empty", self.at(name))
            self.at(name).write_bytes(b"nonsense" * 20)
            self.assert_refused("", self.at(name))

    def test_links_to_other_files(self):
        write_gadget(self.at("other.hdf5"))
        with h5py.File(self.at("snap.hdf5"), "w") as file:
            file["PartType0"] = h5py.ExternalLink(str(self.at("other.hdf5")), "PartType0")
        self.assert_refused("is a link", self.at("snap.hdf5"))
        with h5py.File(self.at("snap.hdf5"), "a") as file:  # a link inside of the file to that
            file["elsewhere"] = h5py.ExternalLink(str(self.at("other.hdf5")), "PartType0")
            del file["PartType0"]
            file["PartType0"] = h5py.SoftLink("/elsewhere")
        self.assert_refused("is a link", self.at("snap.hdf5"))

    def test_data_in_other_files(self):
        self.at("secret").write_bytes(bytes(800))
        write_gadget(self.at("other.hdf5"))
        for make in (write_gadget, write_phantom, write_pysph):
            make(self.at("snap.hdf5"))
            with h5py.File(self.at("snap.hdf5"), "a") as file:
                place = {write_gadget: "PartType0", write_phantom: "particles", write_pysph: "particles/fluid/arrays"}[make]
                file[place].create_dataset("Secret", (len(X),), "u1", external=[(str(self.at("secret")), 0, len(X))])
            self.assert_refused("lies in other files", self.at("snap.hdf5"))
        write_gadget(self.at("snap.hdf5"))
        source = h5py.VirtualSource(str(self.at("other.hdf5")), "PartType0/Density", (len(X),))
        layout = h5py.VirtualLayout((len(X),), "f8")
        layout[:] = source
        with h5py.File(self.at("snap.hdf5"), "a") as file:
            del file["PartType0/Density"]
            file["PartType0"].create_virtual_dataset("Density", layout)
        self.assert_refused("lies in other files", self.at("snap.hdf5"))

    def test_claims(self):
        """Sizes that a file cannot have."""
        with h5py.File(self.at("snap.hdf5"), "w") as file:
            file.create_dataset("PartType0/Coordinates", (10 ** 12, 3), "f8", chunks=(1024, 3))
        self.assert_refused("claims", self.at("snap.hdf5"))
        write_bgeo(self.at("bomb.bgeo"), lambda data: gzip.compress(data[:9] + b"\x7f" + data[10:]))
        self.assert_refused("too short", self.at("bomb.bgeo"))

    def test_cut_off(self):
        """A file of each kind without its end: one line on stderr, and no file."""
        for name, make in (("Part_0001.bi4", write_bi4), ("fluid.bgeo", write_bgeo), ("body.vtp", write_vtk),
                           ("body.vtu", write_vtk), ("body.vtk", write_vtk), ("grid.vtk", write_grid),
                           ("text.vtk", lambda path: write_grid(path, True)), ("snap.hdf5", write_gadget)):
            make(self.at(name))
            self.at(name).write_bytes(self.at(name).read_bytes()[:-2000])
            done = subprocess.run([sys.executable, "-m", "marchingcorrectors", "convert", str(self.at(name)),
                                   str(self.at("out.vtp"))], stderr=subprocess.PIPE, text=True)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(name, done.stderr)
            self.assertFalse(self.at("out.vtp").exists())

    def test_cells(self):
        """VTK's own reader would read where a damaged list of cells points to."""
        write_grid(self.at("grid.vtk"))
        whole = self.at("grid.vtk").read_bytes()
        wanted = io.read(self.at("grid.vtk"))
        at = whole.index(b"\n", whole.index(b"\nCELLS ") + 1) + 1 + 8 * 2000  # how many points the 2000th cell has
        self.at("grid.vtk").write_bytes(whole[:at] + b"\2\0\0\1" + whole[at + 4:])
        found = io.read(self.at("grid.vtk"))
        self.assertEqual(found.positions.tobytes(), wanted.positions.tobytes())
        self.assertEqual(found.arrays["Density"].tobytes(), wanted.arrays["Density"].tobytes())

    def test_fuzz(self):
        """Truncated, and with bits turned: a FileError of one line, or particles."""
        random, refused = np.random.default_rng(34), 0
        makers = {"snap.hdf5": write_gadget, "dump.h5": write_phantom, "run.hdf5": write_pysph,
                  "Part_0001.bi4": write_bi4, "fluid.bgeo": write_bgeo, "body.vtp": write_vtk, "body.vtu": write_vtk,
                  "body.vtk": write_vtk, "grid.vtk": write_grid}
        for name, make in makers.items():
            make(self.at(name))
            whole = self.at(name).read_bytes()
            for i in range(120):
                data = bytearray(whole[:random.integers(1, len(whole))] if i % 3 == 0 else whole)
                for _ in range(0 if i % 3 == 0 else random.integers(1, 9)):
                    at = random.integers(min(len(data), 4000 if i % 3 == 1 else len(data)))
                    data[at] ^= 1 << random.integers(8)
                self.at(name).write_bytes(data)
                try:
                    particles = quietly(io.read, self.at(name))
                    particles.positions, dict(particles.arrays), len(particles)
                except io.FileError as error:
                    refused += 1
                    self.assertNotIn("\n", str(error))
                    self.assertLess(len(str(error)), 400)
        self.assertGreater(refused, 400)


if __name__ == "__main__":
    unittest.main()
