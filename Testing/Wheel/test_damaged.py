# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""marchingcorrectors.io: a damaged, empty or hostile file gives one error message and nothing else, and no code in it is run."""
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
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from marchingcorrectors import io
from test_files import DENSITY, X, Case, write_bgeo, write_bi4, write_gadget, write_phantom, write_pysph


def write_vtk(path, kind="", version=0):
    """Writes a file with VTK. If there is a version, it is a .vtk file of an unstructured grid, as SPlisHSPlasH writes it: as text if kind
    is "text", else binary. Else, if there is a kind, it is a .vtp file, and kind is its compressor; its data are base64 for LZ4, else raw
    bytes. Else path's ending counts."""
    body = pyvista.PolyData(X.astype(np.float32))
    body["Density"], body["Velocity"] = DENSITY, X
    if version:
        body, writer = body.cast_to_unstructured_grid(), vtkUnstructuredGridWriter()
        writer.SetFileVersion(version)
        writer.SetFileType(1 if kind == "text" else 2)
    elif kind:
        writer = vtkXMLPolyDataWriter()
        getattr(writer, f"SetCompressorTypeTo{kind}")()
        writer.SetEncodeAppendedData(kind == "LZ4")
    else:
        (body if path.suffix != ".vtu" else body.cast_to_unstructured_grid()).save(path)
        return
    writer.SetFileName(str(path))
    writer.SetInputData(body)
    writer.Write()


class Hostile(Case):
    def test_pickles(self):
        class Canary:
            def __reduce__(self):
                return os.mkdir, (str(Path(tempfile.gettempdir()) / "canary"),)

        np.savez(self.at("run.npz"), particles=np.array([Canary()], object))
        self.assert_refused("pickles", self.at("run.npz"))
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
        with h5py.File(self.at("snap.hdf5"), "a") as file:  # This link leads to the link to the other file.
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
        """Files that claim larger sizes than they can have are refused."""
        with h5py.File(self.at("snap.hdf5"), "w") as file:
            file.create_dataset("PartType0/Coordinates", (10 ** 12, 3), "f8", chunks=(1024, 3))
        self.assert_refused("claims", self.at("snap.hdf5"))
        write_gadget(self.at("snap.hdf5"))
        with h5py.File(self.at("snap.hdf5"), "a") as file:  # Memory is reserved for whole chunks.
            file["PartType0"].create_dataset("Large", (len(X),), "f8", maxshape=(None,), chunks=(2 ** 27,), compression=9)
        self.assert_refused("claims 1073741824 bytes", self.at("snap.hdf5"))
        write_gadget(self.at("snap.hdf5"))
        with h5py.File(self.at("snap.hdf5"), "a") as file:  # One dataset has many names.
            for i in range(20000):
                file[f"PartType0/{i}"] = file["PartType0/Density"]
        with h5py.File(self.at("few.hdf5"), "w", libver="latest") as file:
            file.create_dataset("PartType0/Coordinates", (2 ** 18, 3), "f4")
            for i in range(20):
                file[f"PartType0/{i}"] = file["PartType0/Coordinates"]
        self.assert_refused("'/PartType0' claims", self.at("few.hdf5"))
        with h5py.File(self.at("sets.hdf5"), "w", libver="latest") as file:
            file.create_group("solver_data")
            for name, kind in (("x", "f4"), ("tag", "u1")):
                file.create_dataset(f"particles/fluid/arrays/{name}", (2 ** 20,), kind, fillvalue=1)
            for i in range(20):
                file[f"particles/fluid{i}"] = file["particles/fluid"]
        self.assert_refused("claims", self.at("sets.hdf5"))
        write_gadget(self.at("snap.hdf5"))
        with h5py.File(self.at("snap.hdf5"), "a") as file:
            twice = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            twice.set_chunk((len(X),))
            twice.set_deflate(9)
            twice.set_deflate(9)
            h5py.h5d.create(file["PartType0"].id, b"Twice", h5py.h5t.NATIVE_DOUBLE, h5py.h5s.create_simple((len(X),)), twice)
        self.assert_refused("more than once", self.at("snap.hdf5"))
        write_vtk(self.at("body.vtp"))
        whole = self.at("body.vtp").read_bytes()
        self.at("body.vtp").write_bytes(whole.replace(b'NumberOfPoints="%d"' % len(X), b'NumberOfPoints="1000000000"'))
        self.assert_refused("claims", self.at("body.vtp"))
        write_bgeo(self.at("bomb.bgeo"), lambda data: gzip.compress(data[:9] + b"\x7f" + data[10:]))
        self.assert_refused("too short", self.at("bomb.bgeo"))

    def test_little_memory(self):
        """A long word among many short ones must not cost much memory, though NumPy's arrays of words are as wide as the longest word."""
        self.at("text.vtk").write_text("# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 30000 double\n"
                                       + "1" * 14000 + " 2" * 89999 + "\n")
        lines = ("import resource, sys", "from marchingcorrectors import io",
                 "resource.setrlimit(resource.RLIMIT_AS, (2 ** 30, 2 ** 30))", "print(len(io.read(sys.argv[1]).positions))")
        done = subprocess.run([sys.executable, "-c", "\n".join(lines), str(self.at("text.vtk"))], stdout=subprocess.PIPE,
                              env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        self.assertEqual((done.returncode, done.stdout), (0, b"30000\n"))

    def test_written_anew(self):
        """A running solver may shorten a file after it was opened: this gives an error. No file stays open."""
        write_bi4(self.at("Part_0001.bi4"))
        particles = io.read(self.at("Part_0001.bi4"))
        self.at("Part_0001.bi4").write_bytes(self.at("Part_0001.bi4").read_bytes()[:1000])
        with self.assertRaisesRegex(io.FileError, "written anew"):
            particles.arrays["Vel"]
        write_bi4(self.at("Part_0001.bi4"))
        before = len(os.listdir("/dev/fd"))
        kept = [io.read(self.at("Part_0001.bi4")) for _ in range(20)]
        self.assertEqual(len(os.listdir("/dev/fd")), before)
        self.assertEqual(len(kept[0].positions), len(X))

    def test_cut_off(self):
        """A file of each kind that lacks its end gives one line on stderr, and no output file."""
        for name, make in (("Part_0001.bi4", write_bi4), ("fluid.bgeo", write_bgeo), ("body.vtp", write_vtk),
                           ("body.vtu", write_vtk), ("body.vtk", write_vtk), ("grid.vtk", lambda path: write_vtk(path, version=42)),
                           ("text.vtk", lambda path: write_vtk(path, "text", 42)), ("snap.hdf5", write_gadget)):
            make(self.at(name))
            self.at(name).write_bytes(self.at(name).read_bytes()[:-2000])
            done = subprocess.run([sys.executable, "-m", "marchingcorrectors", "convert", str(self.at(name)),
                                   str(self.at("out.vtp"))], stderr=subprocess.PIPE, text=True)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(name, done.stderr)
            self.assertFalse(self.at("out.vtp").exists())

    def test_cells(self):
        """A damaged list of cells must not lead the reader beyond the data, as it leads VTK's own reader."""
        write_vtk(self.at("grid.vtk"), version=42)
        whole = self.at("grid.vtk").read_bytes()
        wanted = io.read(self.at("grid.vtk"))
        at = whole.index(b"\n", whole.index(b"\nCELLS ") + 1) + 1 + 8 * 2000  # This number says how many points the 2000th cell has.
        self.at("grid.vtk").write_bytes(whole[:at] + b"\2\0\0\1" + whole[at + 4:])
        found = io.read(self.at("grid.vtk"))
        self.assertEqual(found.positions.tobytes(), wanted.positions.tobytes())
        self.assertEqual(found.arrays["Density"].tobytes(), wanted.arrays["Density"].tobytes())

    def test_fuzz(self):
        makers = {"snap.hdf5": write_gadget, "dump.h5": write_phantom, "run.hdf5": write_pysph,
                  "Part_0001.bi4": write_bi4, "fluid.bgeo": write_bgeo, "body.vtp": write_vtk, "body.vtu": write_vtk,
                  "body.vtk": write_vtk, "grid.vtk": lambda path: write_vtk(path, version=42),
                  "text.vtk": lambda path: write_vtk(path, "text", 42),
                  **{f"{kind}.vtp": lambda path, kind=kind: write_vtk(path, kind) for kind in ("ZLib", "LZ4", "LZMA")}}
        self.fuzz({name: lambda path, _, make=make: make(path) for name, make in makers.items()}, 400, 120)


if __name__ == "__main__":
    unittest.main()
