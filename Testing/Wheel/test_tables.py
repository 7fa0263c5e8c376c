# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests marchingcorrectors.io with tables and other formats, most of them text. What is read from random files is compared with NumPy's reading, with
the numbers written, or with what the program reads. Damaged files must give an error message."""
import gzip
import os
import re
import struct
import subprocess
import sys
import unittest

import h5py
import numpy as np
import pyvista

import marchingcorrectors as mc
from marchingcorrectors import io
from marchingcorrectors.io.convert import convert
from test_files import Case, quietly, says

WORDS = ("O", "H2", "Ar")


def random_rows(random, columns):
    """Returns rows of random numbers as text. All numbers have one format, chosen from those that programs write."""
    count = random.integers(1, 60)
    form = random.choice(["%.17g", "%.6e", "%12.5f"])
    values = random.normal(scale=10.0 ** random.integers(-3, 4), size=(count, columns))
    return [[form % value for value in row] for row in values]


def write_csv(path, random):
    """Writes a .csv file as ParaView, DualSPHysics or other programs do. Returns the columns' names, the columns of the positions, {vector:
    columns} and the separator."""
    names, positions, vectors, separator = (
        (["Vel:0", "Vel:1", "Vel:2", "id", "Points:0", "Points:1", "Points:2", "Rhop"], (4, 5, 6), {"Vel": (0, 1, 2)}, ","),
        (["Pos.x [m]", "Pos.y [m]", "Pos.z [m]", "Idp", "Vel.x [m/s]", "Vel.y [m/s]", "Vel.z [m/s]"], (0, 1, 2),
         {"Vel": (4, 5, 6)}, ";"),
        (["x", "y", "z", "h", "particle_id"], (0, 1, 2), {}, ","),
        (["Points_0", "Points_1", "Points_2", "F_0", "F_1"], (0, 1, 2), {"F": (3, 4)}, "\t"))[random.integers(4)]
    rows = random_rows(random, len(names))
    for i, name in enumerate(names):
        for row in rows if name.lower() in ("id", "idp", "particle_id") else ():
            row[i] = str(random.integers(2 ** 62))
    quote = '"' if random.integers(2) else ""
    end = "\r\n" if random.integers(2) else "\n"
    text = end.join([separator.join(quote + name + quote for name in names), *(separator.join(row) for row in rows)])
    path.write_bytes((text + end * random.integers(2)).encode())
    return names, positions, vectors, separator


def write_columns(path, random):
    names = ["x", "y", "z", "rho", "h"]
    rows = random_rows(random, 5)
    kind = random.integers(3)
    head = ["# made by a program\n# x y z rho h\n", "# [01 x] [02 y] [03 z] [04 rho] [05 h]\n", "# no names\n\n"][kind]
    lines = [" ".join(row) + ("  # a remark" if random.integers(9) == 0 else "") for row in rows]
    path.write_text(head + "\n".join(lines) + "\n")
    return names if kind < 2 else ["x", "y", "z", "Column4", "Column5"]


def write_xyz(path, random, steps, extended):
    text = ""
    for i in range(steps):
        rows = random_rows(random, 7)
        if extended:
            text += f'{len(rows)}\nLattice="2 0 0 0 3 0 0 0 4" Properties=species:S:1:pos:R:3:velo:R:3:h:R:1 '
            text += f'Time={i / 4} pbc="T F T"\n'
        else:
            text += f"{len(rows)}\na remark\n"
        for row in rows:
            text += " ".join([random.choice(WORDS), *(row if extended else row[:3])]) + "\n"
    path.write_text(text)


def write_lammps(path, random, steps, scaled):
    text = ""
    for i in range(steps):
        rows = random_rows(random, 5)
        text += f"ITEM: TIMESTEP\n{100 * i}\nITEM: NUMBER OF ATOMS\n{len(rows)}\n"
        text += "ITEM: BOX BOUNDS pp ff pp\n-1 3\n0 2\n0.5 4.5\n"
        text += "ITEM: ATOMS id type " + ("xs ys zs" if scaled else "x y z") + " vx c_rho[1]\n"
        text += "".join(f"{k + 1} {k % 3} " + " ".join(row) + "\n" for k, row in enumerate(rows))
    path.write_text(text)


def write_gadget_binary(path, random, named=False, order="<", double=False, files=1):
    """Writes a snapshot as GADGET-2 does: gas, dark matter and stars. The mass of dark matter is in the header. Returns the numbers of
    particles of the six types, and {label: values}."""
    counts = [int(random.integers(5, 40)), int(random.integers(1, 9)), 0, 0, int(random.integers(1, 9)), 0]
    table = [0, 2.5, 0, 0, 0, 0]
    total, real = sum(counts), order + ("f8" if double else "f4")
    arrays = {"POS": random.normal(size=(total, 3)).astype(real), "VEL": random.normal(size=(total, 3)).astype(real),
              "ID": np.arange(total, dtype=order + ("u8" if double else "u4")),
              "MASS": random.random(counts[0] + counts[4]).astype(real),
              **{name: random.random(counts[0]).astype(real) for name in ("U", "RHO", "HSML")}}
    header = struct.pack(order + "6i6d2d2i6I2i4d", *counts, *table, 0.25, 3.0, 0, 0, *counts, 0, files, 8.0, 0.3, 0.7, 0.7)

    def record(data):
        return struct.pack(order + "I", len(data)) + data + struct.pack(order + "I", len(data))

    data = b""
    for label, block in (("HEAD", header.ljust(256, b"\0")), *((label, array.tobytes()) for label, array in arrays.items())):
        data += record(label.ljust(4).encode() + struct.pack(order + "I", len(block) + 8)) if named else b""
        data += record(block)
    path.write_bytes(data)
    return counts, arrays


def write_ply(path, random, form, faces=False):
    """Writes a .ply file as splashsurf, Houdini and MeshLab do. Returns {property: values}, in the order of the file."""
    count = int(random.integers(2, 60))
    kinds = {"x": "f4", "y": "f4", "z": "f4", "vx": "f8", "vy": "f8", "vz": "f8", "id": "i4", "kind": "u1", "h": "f4"}
    names = {"f4": "float", "f8": "double", "i4": "int", "u1": "uchar"}
    values = {name: random.integers(0, 200, count).astype(kind) if kind[0] in "iu" else random.normal(size=count).astype(kind)
              for name, kind in kinds.items()}
    head = [f"ply\nformat {form} 1.0\ncomment made here\nelement camera 1\nproperty float x\nelement vertex {count}",
            *(f"property {names[kind]} {name}" for name, kind in kinds.items())]
    head += [f"element face {int(faces)}\nproperty list uchar int vertex_indices"] * faces + ["end_header\n"]
    if form == "ascii":
        body = "7\n" + "".join(" ".join(repr(values[name][i].item()) for name in kinds) + "\n" for i in range(count))
        body = (body + "3 0 1 1\n" * faces).encode()
    else:
        order = "<" if "little" in form else ">"
        rows = np.zeros(count, [(name, order + kind) for name, kind in kinds.items()])
        for name in kinds:
            rows[name] = values[name]
        body = np.array([7], order + "f4").tobytes() + rows.tobytes()
        body += (b"\3" + np.array([0, 1, 1], order + "i4").tobytes()) * faces
    path.write_bytes("\n".join(head).encode() + body)
    return values


def write_npz(path, random, pack=np.savez):
    count = int(random.integers(2, 60))
    values = {"velocity": random.normal(size=(count, 3)), "positions": random.normal(size=(count, 3)).astype(np.float32),
              "h": np.full(count, 0.25), "ids": random.integers(0, 2 ** 62, count), "time": np.array(0.5)}
    pack(path, **values)
    return values


def write_gro(path, random, steps, velocities=True):
    """Writes a .gro file as GROMACS does. Returns (positions, velocities, box) of each step."""
    text, made = "", []
    for step in range(steps):
        count = int(random.integers(1, 30))
        x, v, box = (np.round(random.uniform(-99, 99, (count, 3)), 3), np.round(random.normal(size=(count, 3)), 4),
                     np.round(random.uniform(1, 9, 3), 5))
        text += f"Water in a box, t= {step / 4:9.5f} step= {step}\n{count:5d}\n"
        for i in range(count):
            text += f"{i // 3 + 1:5d}{'SOL':<5s}{'OW':>5s}{i + 1:5d}" + "".join(f"{each:8.3f}" for each in x[i])
            text += "".join(f"{each:8.4f}" for each in v[i]) * velocities + "\n"
        text += "".join(f"{each:10.5f}" for each in box) + "\n"
        made.append((x, v, box))
    path.write_text(text)
    return made


def write_data(path, random, style="atomic"):
    """Writes a file as LAMMPS' write_data does. Returns positions, velocities and masses in the order of the file's atoms."""
    count = int(random.integers(1, 40))
    x, v, kinds = random.normal(size=(count, 3)), random.normal(size=(count, 3)), random.integers(1, 3, count)
    ids, more = random.permutation(count) + 1, {"atomic": "", "full": "{0} -0.5 ", "sph": "1000 2.5 1 "}[style]
    rows = [f"{ids[i]} " + ("7 " if style == "full" else "") + f"{kinds[i]} " + more.replace("{0} ", "") +
            " ".join(map(repr, x[i].tolist())) + " 0 0 -1" for i in range(count)]
    order = random.permutation(count)
    path.write_text(f"LAMMPS data file\n\n{count} atoms\n2 atom types\n\n0 20 xlo xhi\n0 20 ylo yhi\n0 20 zlo zhi\n4 2 3 xy xz yz\n\n"
                    f"Masses\n\n1 2.5 # water\n2 7\n\nAtoms # {style}\n\n" + "\n".join(rows) + "\n\nVelocities\n\n" +
                    "\n".join(f"{ids[i]} " + " ".join(map(repr, v[i].tolist())) for i in order) + "\n")
    return x, v, np.array([0, 2.5, 7])[kinds]


def write_h5part(path, random, steps):
    """Writes an H5Part file as SPH-EXA does. With more than ten steps, the alphabetical order of the names is not the order of the steps.
    Returns the columns of each step."""
    made = []
    with h5py.File(path, "w") as file:
        for step in range(steps):
            count = int(random.integers(1, 60))
            group = file.create_group(f"Step#{step}")
            group.attrs.update({"time": [step / 8], "box": [-1.0, 1, -2, 2, -3, 3], "boundaryType": np.array([1, 0, 2], np.int8)})
            made.append({name: random.normal(size=count) for name in ("x", "y", "z", "h", "m", "vx", "vy", "vz", "temp")})
            for name, values in made[-1].items():
                group[name] = values
    return made


def write_series(path, random):
    """Writes a .series file as ParaView does, and the two tables that it lists."""
    write_csv(path.with_name("a.csv"), random)
    write_columns(path.with_name("b.txt"), random)
    path.write_text('{"file-series-version": "1.0", "files": [{"name": "b.txt", "time": 0.5}, {"name": "a.csv", "time": 0}]}')


def write_vtkhdf(path, random, steps):
    counts = random.integers(1, 50, max(steps, 1))
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", 8))
        root["NumberOfPoints"], root["Points"] = counts, random.normal(size=(counts.sum(), 3))
        root["PointData/Density"] = random.random(counts.sum())
        root["PointData/Constant"] = random.random(counts.max()) if steps else random.random(counts.sum())
        if steps:
            begins = np.cumsum(counts) - counts
            root["Steps/Values"], root["Steps/PartOffsets"] = np.arange(steps) / 4, np.arange(steps)
            root["Steps/NumberOfParts"], root["Steps/PointOffsets"] = np.ones(steps, int), begins
            root["Steps/PointDataOffsets/Density"], root["Steps/PointDataOffsets/Constant"] = begins, np.zeros(steps, int)
    return counts


FORMS = ("ascii", "binary_little_endian", "binary_big_endian")
TRIES, ENDS = int(os.environ.get("MCOR_MUTATIONS", "90")), ({"step": 0}, {"step": -1})


class AgainstNumPy(Case):
    """Compares 40 random files of each kind with NumPy's reading of the same bytes."""

    def randoms(self, count=40):
        return (np.random.default_rng([44, seed]) for seed in range(count))

    def assert_same(self, found, wanted):
        self.assertEqual(np.shape(found), np.shape(wanted))
        self.assertTrue(np.array_equal(found, wanted))

    def test_csv(self):
        for random in self.randoms():
            names, positions, vectors, separator = write_csv(self.at("p.csv"), random)
            particles = io.read(self.at("p.csv"))
            wanted = np.genfromtxt(self.at("p.csv"), delimiter=separator, skip_header=1, ndmin=2)
            self.assert_same(particles.positions, wanted[:, list(positions)])
            for name, columns in vectors.items():
                self.assert_same(particles.arrays[name], wanted[:, list(columns)])
            for i, name in enumerate(names):
                if name in particles.arrays:
                    ids = name.lower() in ("id", "idp", "particle_id")
                    text = np.genfromtxt(self.at("p.csv"), str, delimiter=separator, skip_header=1, ndmin=2)[:, i]
                    self.assert_same(particles.arrays[name], np.array([int(word) for word in text]) if ids else wanted[:, i])

    def test_columns(self):
        for random in self.randoms():
            names = write_columns(self.at("p.txt"), random)
            particles, wanted = io.read(self.at("p.txt")), np.loadtxt(self.at("p.txt"), ndmin=2)
            self.assert_same(particles.positions, wanted[:, :3])
            self.assertEqual(list(particles.arrays), names[3:])
            for i in (3, 4):
                self.assert_same(particles.arrays[names[i]], wanted[:, i])

    def test_xyz(self):
        for random in self.randoms():
            steps, extended = int(random.integers(1, 4)), bool(random.integers(2))
            write_xyz(self.at("p.xyz"), random, steps, extended)
            lines, at = self.at("p.xyz").read_text().split("\n"), 0
            for step in range(steps):
                particles, count = io.read(self.at("p.xyz"), step=step), int(lines[at])
                wanted = np.loadtxt(lines[at + 2:at + 2 + count], usecols=range(1, 8 if extended else 4), ndmin=2)
                self.assert_same(particles.positions, wanted[:, :3])
                species = [line.split()[0] for line in lines[at + 2:at + 2 + count]]
                self.assertEqual(particles.arrays["species"].tolist(), species)
                self.assertEqual(len(particles.times), steps)
                if extended:
                    self.assert_same(particles.arrays["velo"], wanted[:, 3:6])
                    self.assert_same(particles.arrays["h"], wanted[:, 6])
                    self.assertEqual((particles.smoothing_length, particles.time), ("h", step / 4))
                    self.assertEqual(list(particles.period), [0, 2, 0, 0, 0, 4])
                at += 2 + count
            self.assert_same(io.read(self.at("p.xyz"), step=-1).positions, particles.positions)
            self.assert_refused(f"has no step {steps}", self.at("p.xyz"), step=steps)
        self.at("p.xyz").write_text('1\ntime=" "\nO 0 0 0\n1\ntime=2\nO 0 0 0\n')
        self.assertEqual(list(io.read(self.at("p.xyz")).times), [0, 2])  # A step without a time has its number.

    def test_lammps(self):
        for random in self.randoms():
            steps, scaled = int(random.integers(1, 4)), bool(random.integers(2))
            write_lammps(self.at("p.dump"), random, steps, scaled)
            frames = self.at("p.dump").read_text().split("ITEM: TIMESTEP\n")[1:]
            for step, frame in enumerate(frames):
                particles = io.read(self.at("p.dump"), step=step)
                wanted = np.loadtxt(frame.split("\n")[8:], ndmin=2)
                low, size = np.array([-1, 0, 0.5]), np.array([4, 2, 4])
                self.assert_same(particles.positions, low + wanted[:, 2:5] * size if scaled else wanted[:, 2:5])
                self.assertEqual(list(particles.period), [-1, 3, 0, 0, 0.5, 4.5])
                self.assertEqual((particles.time, list(particles.times)), (100 * step, [100.0 * i for i in range(steps)]))
                self.assert_same(particles.arrays["id"], wanted[:, 0])
                self.assertEqual(particles.arrays["id"].dtype.kind, "i")
                self.assert_same(particles.arrays["c_rho[1]"], wanted[:, 6])

    def test_gadget(self):
        for i, random in enumerate(self.randoms()):
            path = self.at("snapshot_000")
            counts, arrays = write_gadget_binary(path, random, named=i % 2, order="<>"[i // 2 % 2], double=i // 4 % 2)
            raw = path.read_bytes()
            for kind, begin in ((0, 0), (1, counts[0]), (4, counts[0] + counts[1])):
                chosen = slice(begin, begin + counts[kind])
                particles = io.read(path, types=kind)
                at = raw.index(arrays["POS"].tobytes())
                wanted = np.frombuffer(raw, arrays["POS"].dtype, 3 * sum(counts), at).reshape(-1, 3)
                self.assert_same(particles.positions, wanted[chosen])
                self.assert_same(particles.arrays["Velocities"], arrays["VEL"][chosen])
                self.assert_same(particles.arrays["ParticleIDs"], arrays["ID"][chosen])
                masses = {0: arrays["MASS"][:counts[0]], 1: np.full(counts[1], 2.5), 4: arrays["MASS"][counts[0]:]}
                self.assert_same(particles.arrays["Masses"], masses[kind])
            gas = io.read(path)
            for label, name in (("U", "InternalEnergy"), ("RHO", "Density"), ("HSML", "SmoothingLength")):
                self.assert_same(gas.arrays[name], arrays[label])
            self.assertEqual((gas.time, gas.parameters["box_size"], gas.support_radius), (0.25, [8.0] * 3, True))

    def test_vtkhdf(self):
        for random in self.randoms():
            steps = int(random.integers(0, 5))
            counts = write_vtkhdf(self.at("p.vtkhdf"), random, steps)
            with h5py.File(self.at("p.vtkhdf"), "r") as file:
                for step in range(max(steps, 1)):
                    begin, count = counts[:step].sum(), counts[step]
                    particles = io.read(self.at("p.vtkhdf"), step=step)
                    self.assert_same(particles.positions, file["VTKHDF/Points"][begin:begin + count])
                    self.assert_same(particles.arrays["Density"], file["VTKHDF/PointData/Density"][begin:begin + count])
                    self.assert_same(particles.arrays["Constant"], file["VTKHDF/PointData/Constant"][:count])
                    self.assertEqual(particles.time, step / 4 if steps else None)


BOX = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS "
ROWS = "ITEM: ATOMS id type xs ys zs\n1 1 0.25 0.5 0.75\n2 1 0.5 0.5 0.5\n"
TILTED = "0 26 4\n0 23 2\n0 20 3\n"  # This is a cell of 20 x 20 x 20 in a box of 26 x 23 x 20.
VECTORS = "20 0 0 1\n4 20 0 2\n2 3 20 3\n"
XYZ = 'Properties=species:S:1:pos:R:3 Lattice="{}" pbc="{}"'
TWO = 'A 1 2 3\nB 4 5 6\n'

# Each case has a file's name, its text, and words of the sentence with which the program and Python's reader must refuse the
# file (the program's|Python's, if they differ). None: both must read the same from it, with the period in PERIODS.
CASES = {
    "columns": ("a.csv", "x,y,z,Rhop,Vel:0,Vel:1,Vel:2\n1,2,3,1000,1,2,3\n4,5,6,1001,4,5,6\n", None),
    "names that stand twice": ("a.csv", "x,y,z,a,a,a_\n1,2,3,4,5,6\n4,5,6,7,8,9\n", None),
    "positions that stand twice": ("a.csv", "X,y,z,x\n1,2,3,4\n4,5,6,7\n", None),
    "no third position": ("a.csv", "x,y,a\n1,2,3\n4,5,6\n", "positions only x and y is found; there are x, y, a"),
    "a vector of two": ("a.csv", "Points:0,Points:1,Ponits:2\n1,2,3\n", "positions only Points:0 and Points:1 is found"),
    "no third position in columns": ("a.txt", "# x y zz\n1 2 3\n", "positions only x and y is found; there are x, y, zz"),
    "two columns": ("a.csv", "x,y\n1,2\n3,4\n", None),
    "thousands": ("a.csv", 'x,y,z,a\n1,2,3,"1,234"\n', "has '1,234' in a table with commas between columns"),
    "millions": ("a.csv", 'x,y,z,a\n1,2,3,5\n"1,234,567.5",2,3,4\n', "has '1,234,567.5' in a table"),
    "spaces and line ends": ("a.csv", "x, y , z, rho\r\n1, 2, 3, 1e3\r\n", None),
    "units of columns": ("a.csv", "x (m),y (m),z (m),v (x),v (y)\n1,2,3,4,5\n", None),
    "another separator": ("a.csv", "x|y|z\n1|2|3\n", "no columns of positions, which"),
    "no positions": ("a.csv", "a,b\n1,2\n", "called x, y and z, or Points:0, Points:1 and Points:2; there are a, b"),
    "no rows": ("a.csv", "", "no row of values|is empty"), "a header alone": ("a.csv", "x,y,z\n", "a.csv holds no points|has no row of values"),
    "names alone": ("a.txt", "# x y z\n", "has no row of values"),
    "a short row": ("a.csv", "x,y,z\n1,2\n", "2 values for 3 columns"),
    "no text": ("a.csv", "x\0y,z\n1,2,3\n", "is no text"),
    "bare tabs": ("a.tsv", "1\t2\t3\n4\t5\t6\n", None), "bare commas": ("a.txt", "1, 2, 3\n4, 5, 6\n", None), "two bare columns": ("a.txt", "1 2\n3 4\n", None),
    "a header above": ("a.txt", "# a header\n# x y z rho id\n 1.5E+00  2e1\t+3.5 1.0D3 7\n1 2 3 4 8\n# the end\n", None),
    "numbered names": ("a.dat", "# [01  x] [02  y] [03  z] [04 rho] [05 id]\n1 2 3 4 5\n", None),
    "units in numbers": ("a.dat", "# [ 1 x [m]] [ 2 y [m]] [ 3 z [m]] [ 4 rho [kg]] [ 5 id]\n1 2 3 4 5\n", None),
    "quoted text": ("a.csv", 'x,y,z,who\n1,2,3,"a, b"\n', None),
    "decimal commas": ("a.csv", "x;y;z;a\n1,5;2,25;3;1,234\n", None),
    "a byte order mark": ("a.csv", "\ufeffPos.x [m];Pos.y [m];Pos.z [m]\n,5;2,25;3\n", None),
    "large identifiers": ("a.csv", "x,y,z,id\n1,2,3,9007199254740993\n1,2,4,9007199254740992\n", None),
    "large numbers of any name": ("a.csv", "x,y,z,n\n1,2,3,9007199254740993\n1,2,4,5\n", None),
    "identifiers beyond 2^63": ("a.csv", "x,y,z,id\n1,2,3,18446744073709551615\n", "different ones would become equal"),
    "an underscore": ("a.csv", "x,y,z,a\n1,2,3,4\n1,2,3,1_0.3\n", None),
    "an underscore in a position": ("a.csv", "x,y,z\n1,2,1_0.3\n", "its positions are no numbers: '1_0.3'"),
    "mixed positions": ("a.dump", BOX + "pp pp pp\n0 1\n0 1\n0 1\nITEM: ATOMS x ys z\n1 2 3\n4 5 6\n",
                        "positions only x and z is found; there are x, ys, z"),
    "a box": ("a.dump", BOX + "pp ff pp\n-1 1\n0 2\n0 4\n" + ROWS, None),
    "a box without flags": ("a.dump", BOX.strip() + "\n-1 1\n0 2\n0 4\n" + ROWS, None),
    "a tilted box": ("a.dump", BOX + "xy xz yz pp pp pp\n" + TILTED + ROWS, None),
    "a tilted box of one period": ("a.dump", BOX + "xy xz yz pp ff fs\n" + TILTED + ROWS, None),
    "a box tilted backwards": ("a.dump", BOX + "xy xz yz ff ff ff\n-6 20 -4\n-3 20 -2\n0 20 -3\n" + ROWS, None),
    "vectors": ("a.dump", BOX + "abc origin pp pp pp\n" + VECTORS + ROWS, None),
    "another box": ("a.dump", BOX + "abc pp pp pp\n" + VECTORS + ROWS, "line 5 begins a box of a kind that is not known"),
    "a short box": ("a.dump", BOX + "xy xz yz pp pp pp\n0 26 4\n0 23\n0 20 3\n" + ROWS, "line 7 has 2 numbers, where a side of its box has 3"),
    "no box": ("a.dump", BOX.rpartition("ITEM")[0] + ROWS, "shares of a box (xs, ys, zs), and it has no box"),
    "an unknown item": ("a.dump", BOX + "pp pp pp\n0 1\n0 1\n0 1\nITEM: FRAME\n1\n" + ROWS, "is no item of a dump of LAMMPS that is known here"),
    "units": ("a.dump", "ITEM: UNITS\nlj\n" + BOX + "pp pp pp\n0 1\n0 1\n0 1\n" + ROWS, None),
    "a lattice": ("a.xyz", "2\n" + XYZ.format("2 0 0 0 3 0 0 0 4", "T F T") + "\n" + TWO, None),
    "a tilted lattice": ("a.xyz", "2\n" + XYZ.format("2 0 0 1 3 0 0 0 4", "T T T") + "\n" + TWO, None),
    "a short lattice": ("a.xyz", "2\n" + XYZ.format("2 0 0 0 3 0", "T T T") + "\n" + TWO, "line 2 has 6 values as its lattice"),
    "one row more": ("a.xyz", "1\n\n" + TWO, "line 4 is one more than the 1 particles"),
    "fewer rows": ("a.xyz", "5\nx\nA 1 2 3\n", "it ends before all particles|claims 5 particles"),
    "no properties": ("a.xyz", "1\nProperties=pos:R:x\nA 1 2 3\n", "Properties give pos x columns|Properties give 'pos' x columns"),
    "no count": ("a.xyz", "1 2 3\n4 5 6\n", None),
    "a huge count": ("a.xyz", "99999999999999\n\nO 1 2 3\n", "it ends before all particles|claims 99999999999999 particles"),
    "a word": ("a.xyz", "water\n", "no columns of positions, which|has no row of values"),
    "a word after a step": ("a.xyz", "1\n\nO 1 2 3\n\nwater\n", "line 5 is one more than|line 5 does not say how many"),
    "fewer atoms": ("a.dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n9\nITEM: ATOMS x y z\n1 2 3\n", "it ends before all|claims 9 particles"),
    "no time": ("a.dump", "ITEM: TIMESTEP\n", "it ends before the number|is no time"),
}
PERIODS = {"a box": [-1, 1, 0, 0, 0, 4], "a tilted box": "none, as its cell is tilted", "vectors": "none, as its cell is tilted",
           "a tilted box of one period": [0, 20, 0, 0, 0, 0], "a lattice": [0, 2, 0, 0, 0, 4], "units": [0, 1, 0, 1, 0, 1],
           "a tilted lattice": "none, as its cell is tilted"}


class Others(Case):
    """Tests more formats, most of which only Python reads: what is read from random files equals the numbers written to them."""

    def randoms(self):
        return (np.random.default_rng([57, seed]) for seed in range(12))

    def assert_same(self, found, wanted):
        self.assertEqual(np.asarray(found).tolist(), np.asarray(wanted).tolist())

    def test_ply(self):
        for random in self.randoms():
            for form in FORMS:
                values = write_ply(self.at("p.ply"), random, form, bool(random.integers(2)))
                particles = io.read(self.at("p.ply"))
                self.assert_same(particles.positions, np.stack([values[axis] for axis in "xyz"], axis=1))
                self.assert_same(particles.arrays["Velocity"], np.stack([values["v" + axis] for axis in "xyz"], axis=1))
                for name in ("id", "kind", "h"):
                    self.assert_same(particles.arrays[name], values[name])
                self.assertEqual((particles.smoothing_length, len(particles.arrays)), ("h", 7))

    def test_npz(self):
        for random in self.randoms():
            for pack in (np.savez, np.savez_compressed):
                values = write_npz(self.at("p.npz"), random, pack)
                particles = io.read(self.at("p.npz"))
                self.assert_same(particles.positions, values["positions"])
                self.assertEqual(list(particles.arrays), ["velocity", "h", "ids"])
                for name in particles.arrays:
                    self.assert_same(particles.arrays[name], values[name])
                self.assertEqual((particles.time, particles.smoothing_length), (0.5, "h"))
            np.save(self.at("p.npy"), np.asfortranarray(values["positions"]))
            self.assert_same(io.read(self.at("p.npy")).positions, values["positions"])
        np.savez(self.at("p.npz"), positions=np.ones((4, 2)), triangles=np.zeros((9, 3), int))
        with self.assertWarnsRegex(mc.InputWarning, "for each of 4 particles"):
            self.assert_same(io.read(self.at("p.npz")).positions, [[1, 1, 0]] * 4)
        np.savez(self.at("p.npz"), where=np.ones((4, 3)))
        self.assert_refused("no columns of positions", self.at("p.npz"))

    def test_gro(self):
        for random in self.randoms():
            velocities = bool(random.integers(2))
            made = write_gro(self.at("p.gro"), random, 3, velocities)
            for step, (x, v, box) in enumerate(made):
                particles = io.read(self.at("p.gro"), step=step)
                self.assert_same(particles.positions, x)
                self.assertEqual(list(particles.arrays), ["residue", "species"] + ["velocity"] * velocities)
                if velocities:
                    self.assert_same(particles.arrays["velocity"], v)
                self.assertEqual(set(particles.arrays["species"].tolist()), {"OW"})
                self.assertEqual(list(particles.period), [0, box[0], 0, box[1], 0, box[2]])
                self.assertEqual((particles.time, list(particles.times)), (step / 4, [0, 0.25, 0.5]))
        text = self.at("p.gro").read_text().splitlines()
        self.at("p.gro").write_text("\n".join([*text[:-1], "2 3 4 0 0 1 0 0 0"]))
        self.assertEqual(list(io.read(self.at("p.gro"), step=-1).cell), [2, 0, 0, 1, 3, 0, 0, 0, 4])

    def test_data(self):
        for random in self.randoms():
            for style in ("atomic", "full", "sph"):
                x, v, masses = write_data(self.at("p.data"), random, style)
                particles = io.read(self.at("p.data"))
                self.assert_same(particles.positions, x)
                self.assert_same(particles.arrays["Velocity"], v)
                self.assert_same(particles.arrays["mass"], masses)
                self.assertEqual("rho" in particles.arrays, style == "sph")
                self.assertEqual((particles.mass, particles.period), ("mass", None))
        text = self.at("p.data").read_text()
        for bad, words in ((text.replace("# sph", "# odd"), "the style of its section Atoms is 'odd'"),
                           (text.replace("# sph", ""), "the style of its section Atoms is ''"),
                           (text.replace("# sph", "# atomic"), "an atom has 11 values, where the style atomic has 5"),
                           (text.replace("Atoms", "Bonds"), "is no data file of LAMMPS")):
            self.at("p.data").write_text(bad)
            self.assert_refused(words, self.at("p.data"))

    def test_h5part(self):
        for random in self.randoms():
            made = write_h5part(self.at("p.h5"), random, 11)
            for step in (0, 2, 10):
                particles, wanted = io.read(self.at("p.h5"), step=step), made[step]
                self.assert_same(particles.positions, np.stack([wanted[axis] for axis in "xyz"], axis=1))
                self.assert_same(particles.arrays["Velocity"], np.stack([wanted["v" + axis] for axis in "xyz"], axis=1))
                self.assert_same(particles.arrays["temp"], wanted["temp"])
                self.assertEqual((particles.smoothing_length, particles.mass, particles.time), ("h", "m", step / 8))
                self.assertEqual(list(particles.period), [-1, 1, 0, 0, 0, 0])
            self.assertEqual(io.count_steps(self.at("p.h5")), 11)
            self.assert_refused("has no step 11", self.at("p.h5"), step=11)
        with h5py.File(self.at("p.h5"), "a") as file:
            del file["Step#0/z"]
        self.assert_refused("Step#0 has x, y.", self.at("p.h5"))

    def test_series(self):
        write_series(self.at("p.vtk.series"), np.random.default_rng(1))
        for step, name in enumerate(("a.csv", "b.txt")):
            particles = io.read(self.at("p.vtk.series"), step=step)
            self.assert_same(particles.positions, io.read(self.at(name)).positions)
            self.assertEqual((particles.time, list(particles.times)), (step / 2, [0, 0.5]))
        for bad in ("{", "[]", '{"files": [{"name": "a.csv"}]}', '{"files": [{"name": "a.csv", "time": "x"}]}', "[" * 100000):
            self.at("p.vtk.series").write_text(bad)
            self.assert_refused("NO_SERIES", self.at("p.vtk.series"))

    def test_packed(self):
        """Text files may be compressed by gzip, in one part or several."""
        writers = {"a.csv": write_csv, "a.txt": write_columns, "a.xyz": lambda path, r: write_xyz(path, r, 2, True),
                   "a.dump": lambda path, r: write_lammps(path, r, 2, True), "a.gro": lambda path, r: write_gro(path, r, 2),
                   "a.data": write_data, "a.ply": lambda path, r: write_ply(path, r, "ascii")}
        for name, write in writers.items():
            write(self.at(name), np.random.default_rng(2))
            data = self.at(name).read_bytes()
            for parts in ([data], [data[:50], data[50:]]):
                self.at(name + ".gz").write_bytes(b"".join(map(gzip.compress, parts)))
                self.assert_same(io.read(self.at(name + ".gz"), step=-1).positions, io.read(self.at(name), step=-1).positions)
                self.assertEqual(io.count_steps(self.at(name + ".gz")), io.count_steps(self.at(name)))
        self.at("a.csv.gz").write_bytes(gzip.compress(data)[:-9])
        self.assert_refused("ends too early", self.at("a.csv.gz"))
        self.at("a.vtk.gz").write_bytes(gzip.compress(b"# vtk DataFile Version 3.0\n"))
        self.assert_refused("of .gz text alone", self.at("a.vtk.gz"))

    def test_fuzz(self):
        self.fuzz({"a.ply": lambda path, r: write_ply(path, r, "ascii", True), "b.ply": lambda path, r: write_ply(path, r, "binary_big_endian"),
                    "a.npz": write_npz, "b.npz": lambda path, r: write_npz(path, r, np.savez_compressed),
                    "a.npy": lambda path, r: np.save(path, r.normal(size=(20, 3))), "a.gro": lambda path, r: write_gro(path, r, 2),
                    "a.data": write_data, "b.data": lambda path, r: write_data(path, r, "full"),
                    "a.h5": lambda path, r: write_h5part(path, r, 2), "a.vtk.series": write_series,
                    "a.csv.gz": lambda path, r: (write_csv(path, r), path.write_bytes(gzip.compress(path.read_bytes())))}, 250, TRIES, ENDS, True)


@unittest.skipUnless(os.environ.get("MCOR_TEST_PROGRAM"), "the program was not built")
class AsTheProgram(Case):
    """Tests that the program and Python read the same from a file, or both refuse it."""

    def list_arrays(self, path):
        return subprocess.run([os.environ["MCOR_TEST_PROGRAM"], "--list-arrays", str(path)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)

    def describe(self, particles):
        """Returns what --list-arrays shows: {name: (components, lowest and highest values)}; texts have no values."""
        found = {"positions": particles.positions, **{name: particles.arrays[name] for name in particles.arrays}}
        if "vx" in found:
            found.pop("Velocity", None)  # In the file these are three arrays.
        return {name: (values[0].size, [] if values.dtype.kind == "U" else
                       [float(f"{each:.9g}") for end in (np.nanmin, np.nanmax) for each in np.ravel(end(values, axis=0))])
                for name, values in found.items()}

    def described(self, text):
        found = {}
        for line in text.splitlines():
            word, rest = line[:18].strip(), line[18:]
            name, _, about = rest.partition(": ") if word == "array" else (word, "", "3 components, double, " + rest)
            if word in ("array", "positions"):
                components, _, values = about.split(", ", 2)
                ends = re.sub(r"[^-+.e0-9]+", " ", values.replace(" .. ", " ")) if values != "not numbers" else ""
                found[name] = int(components.split()[0]), [float(word) for word in ends.split()]
        return found, re.search(r"^period +(.*?)(?: \(field.*)?$", text, re.M)[1]

    def compare(self, path, period=None):
        done = self.list_arrays(path)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        found, told = self.described(done.stdout)
        particles = io.read(path)
        self.assertEqual(found, self.describe(particles))
        mine = "none" if particles.period is None else list(particles.period)
        mine = "none, as its cell is tilted" if particles.cell is not None else mine
        self.assertEqual(told if told.startswith("none") else [float(word) for word in told.split(",")], mine)
        self.assertEqual(mine, period or "none")
        return particles

    def test_cases(self):
        for case, (name, text, words) in CASES.items():
            with self.subTest(case):
                self.at(name).write_text(text)
                if words is None:
                    self.compare(self.at(name), PERIODS.get(case))
                    continue
                done = self.list_arrays(self.at(name))
                self.assertEqual(done.returncode, 1)
                theirs, _, mine = words.partition("|")
                self.assertIn(theirs, done.stderr)
                self.assert_refused(mine or theirs, self.at(name))
        self.at("a.csv").write_text(CASES["large identifiers"][1])
        self.assertEqual(io.read(self.at("a.csv")).arrays["id"].tolist(), [2 ** 53 + 1, 2 ** 53])

    def test_tilted_cells(self):
        """Positions in tilted cells equal positions worked out by hand. Commands refuse a tilted period; functions warn of it."""
        for case in ("a tilted box", "a tilted box of one period", "vectors"):
            self.at("a.dump").write_text(CASES[case][1])
            low = np.array([1.0, 2, 3]) if case == "vectors" else np.zeros(3)
            wanted = [[0.25 * 20 + 0.5 * 4 + 0.75 * 2, 0.5 * 20 + 0.75 * 3, 0.75 * 20], [13, 11.5, 10]]
            self.assertEqual(io.read(self.at("a.dump")).positions.tolist(), (low + wanted).tolist())
        self.at("a.dump").write_text(CASES["a tilted box"][1])
        convert([self.at("a.dump")], self.at("b.vtp"))
        for name in ("a.dump", "b.vtp"):
            words = [str(self.at(name)), str(self.at("o.vtp")), "--free-surface", "--smoothing-length", "9", "--periodic", "auto"]
            for command in ([os.environ["MCOR_TEST_PROGRAM"]], [sys.executable, "-m", "marchingcorrectors", "surface"]):
                done = subprocess.run(command + words, stderr=subprocess.PIPE, text=True)
                self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
                self.assertRegex(done.stderr, says("CELL_TILTED"))
            with self.assertWarnsRegex(mc.InputWarning, says("CELL_TILTED")):
                mc.free_surface(io.read(self.at(name)), smoothing_length=9.0)

    def test_no_circle(self):
        """If the program cannot read a file, its error names the command that converts the file, and this command can read the whole file."""
        random = np.random.default_rng(3)
        writers = {"a.npz": write_npz, "a.npy": lambda path, r: np.save(path, r.normal(size=(20, 3))),
                   "a.gro": lambda path, r: write_gro(path, r, 2), "a.data": write_data,
                   "a.h5": lambda path, r: write_h5part(path, r, 2), "a.csv.gz":
                   lambda path, r: (write_csv(path, r), path.write_bytes(gzip.compress(path.read_bytes())))}
        for name, write in writers.items():
            with self.subTest(name):
                write(self.at(name), random)
                said = self.list_arrays(self.at(name))
                self.assertEqual(said.returncode, 2)
                command = re.search(r"'python (-m marchingcorrectors convert .*) particles.vtp' \(particles.pvd", said.stderr)[1]
                words = [sys.executable, *command.split(), str(self.at("b.vtp"))]
                done = subprocess.run(words, stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                steps = io.count_steps(self.at(name))
                self.assertEqual(f"has {steps} steps, and b.vtp the first" in done.stderr, steps > 1)
                self.assertEqual(self.list_arrays(self.at("b.vtp")).stdout.split()[:2], ["particles", str(len(io.read(self.at(name))))])
                subprocess.run([*words[:-1], str(self.at("b.pvd"))], check=True)
                self.assertEqual(io.count_steps(self.at("b.pvd")), steps)

    def test_damaged_properties(self):
        write_ply(self.at("a.ply"), np.random.default_rng(1), FORMS[1])
        whole = self.at("a.ply").read_bytes()
        for old, new, words, mine in (
                (b"float z", b"float w", "positions only x and y is found", ""), (b"little", b"mixed_", "format", ""),
                (b"float z", b"list uchar float z", "has lists", ""), (b"float z", b"half z", "of its head", "line 'property half z'"),
                (b"double vx", b"double vy", "have the same name", ""), (b"vertex", b"vortex", "no vertices", ""),
                (b"ply\n", b"play\n", "is no .ply file", ""),
                (b"element camera 1\nproperty float x", b"element camera 999999999999", "has no properties", "has 0 columns"), (whole[-9:], b"", "ends", "too early")):
            with self.subTest(new):
                self.at("a.ply").write_bytes(whole.replace(old, new))
                self.assertIn(words, self.list_arrays(self.at("a.ply")).stderr)
                self.assert_refused(mine or words, self.at("a.ply"))

    def test_random_files(self):
        for seed in range(6):
            random = np.random.default_rng([57, seed])
            for name, write in {"a.csv": write_csv, "a.txt": write_columns, "a.xyz": lambda path, r: write_xyz(path, r, 1, True),
                                "a.dump": lambda path, r: write_lammps(path, r, 1, seed % 2),
                                "a.ply": lambda path, r: write_ply(path, r, FORMS[seed % 3], seed % 2)}.items():
                write(self.at(name), random)
                self.compare(self.at(name), {"a.xyz": [0, 2, 0, 0, 0, 4], "a.dump": [-1, 3, 0, 0, 0.5, 4.5]}.get(name))


class Tables(Case):
    def test_names(self):
        self.at("p.csv").write_text("X;Y;Z;VelX;VelY;VelZ;rho;Type\n1,5;2;0;1;2;3;1000;0\n2,5;3;0;4;5;6;;3\n")
        particles = io.read(self.at("p.csv"))
        self.assertEqual(particles.positions.tolist(), [[1.5, 2, 0], [2.5, 3, 0]])
        self.assertEqual(particles.arrays["Vel"].tolist(), [[1, 2, 3], [4, 5, 6]])
        self.assertEqual((particles.density, particles.arrays["rho"][0]), ("rho", 1000))
        self.assertTrue(np.isnan(particles.arrays["rho"][1]))
        self.assertEqual(particles.arrays["Type"].tolist(), [0, 3])
        self.at("p.dat").write_text("1.5D+00 0 0\n-2d0 1 1\n")
        self.assertEqual(io.read(self.at("p.dat")).positions.tolist(), [[1.5, 0, 0], [-2, 1, 1]])
        self.at("p.txt").write_text("x y z vx vy vz\n1 2 3 4 5 6\n")
        self.assertEqual(io.read(self.at("p.txt")).arrays["Velocity"].tolist(), [[4, 5, 6]])
        self.at("p.csv").write_text("x (m),y (m),z (m),v (x)\n1,2,3,4\n")
        self.assertEqual(list(io.read(self.at("p.csv")).arrays), ["v (x)"])
        for data in (b"x,y,z\r1,2,3\r", "x,y,z\n1,2,3\n".encode("utf-16"), "x,y,z\r\n1,2,3".encode("utf-8-sig")):
            self.at("p.csv").write_bytes(data)
            self.assertEqual(io.read(self.at("p.csv")).positions.tolist(), [[1, 2, 3]])

    def test_surface(self):
        """A surface made from a file alone equals the surface made from arrays. Walls may be in a file of their own."""
        line = np.arange(-4, 5) * 0.1
        x = np.stack(np.meshgrid(line, line, line), -1).reshape(-1, 3)
        np.savetxt(self.at("water.csv"), np.column_stack([x, np.full(len(x), 0.13), np.full(len(x), 1e-3)]), "%.17g", ",",
                   header="x,y,z,h,volume", comments="")
        wanted = quietly(mc.free_surface, x, smoothing_length=0.13, volume=1e-3)
        self.assertEqual(quietly(mc.free_surface, io.read(self.at("water.csv"))).points.tobytes(), wanted.points.tobytes())
        self.at("wall.csv").write_text("x,y,z\n9,9,9\n")
        both = io.read([self.at("water.csv"), self.at("wall.csv")])
        self.assertEqual(both.solid.tolist(), [False] * len(x) + [True])

    def test_film(self):
        """convert() converts all steps of a file, with their times."""
        write_xyz(self.at("p.xyz"), np.random.default_rng(5), 3, True)
        write_gadget_binary(self.at("snap"), np.random.default_rng(5))
        convert([self.at("p.xyz"), self.at("snap")], self.at("film.pvd"))
        reader = pyvista.get_reader(self.at("film.pvd"))
        self.assertEqual(reader.time_values, [0, 0.25, 0.5])  # The snapshot's time is 0.25, too.
        for i in range(3):
            step = pyvista.read(self.at(f"film_{i:04d}.vtp"))
            self.assertTrue(np.array_equal(step.points, io.read(self.at("p.xyz"), step=i).positions))
            self.assertEqual(step["species"].tolist(), io.read(self.at("p.xyz"), step=i).arrays["species"].tolist())
        self.assertEqual(pyvista.read(self.at("film_0003.vtp")).n_points, len(io.read(self.at("snap"))))
        read = [(each.time, len(each)) for each in io.read_steps([self.at("p.xyz"), self.at("snap")])]
        self.assertEqual(read, [(0.25 * i, len(io.read(self.at("p.xyz"), step=i))) for i in range(3)]
                         + [(0.25, len(io.read(self.at("snap"))))])

    def test_gadget_in_several_files(self):
        random = np.random.default_rng(1)
        made = [write_gadget_binary(self.at(f"snap.{i}"), random, files=2)[1] for i in range(2)]
        gas = io.read(self.at("snap.1"))
        self.assertEqual(gas.arrays["Density"].tolist(), np.concatenate([arrays["RHO"] for arrays in made]).tolist())
        self.at("snap.1").unlink()
        self.assert_refused("snap.1 is missing", self.at("snap.0"))

    def test_fuzz(self):
        """Files with flipped bits or other numbers are read or refused, see Case.fuzz."""
        self.fuzz({"a.csv": write_csv, "a.txt": write_columns, "a.xyz": lambda path, r: write_xyz(path, r, 3, True),
                   "b.xyz": lambda path, r: write_xyz(path, r, 2, False), "a.dump": lambda path, r: write_lammps(path, r, 2, True),
                   "a.gadget": write_gadget_binary, "b.gadget": lambda path, r: write_gadget_binary(path, r, True, ">", True),
                   "a.vtkhdf": lambda path, r: write_vtkhdf(path, r, 3), "b.vtkhdf": lambda path, r: write_vtkhdf(path, r, 0)}, 200, TRIES, ENDS, True)


if __name__ == "__main__":
    unittest.main()
