# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""marchingcorrectors.io: files in the layout of each solver, written here, give the same surface as the arrays in them. test_damaged.py has damaged
files."""
import gzip
import importlib.util
import itertools
import re
import struct
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import h5py
import numpy as np
import pyvista
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter, vtkUnstructuredGridWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

import marchingcorrectors as mc
from marchingcorrectors import io
from marchingcorrectors.io._particles import find_kernel
from solver_files import DENSITY, MASS, WALL, X, H, write_bgeo, write_bi4
from test_numpy import quietly, says


def write_gadget(path, part=slice(None), files=1, table=False, swift=False, periodic=False):
    with h5py.File(path, "w") as file:
        header, gas = file.create_group("Header"), file.create_group("PartType0")
        header.attrs.update({"Time": 0.25, "NumFilesPerSnapshot": files, "BoxSize": 4.0, "Redshift": 3.0,
                             "HubbleParam": 0.7, "MassTable": [0.001 if table else 0.0, 2.0, 0, 0, 0, 0]})
        gas["Coordinates"], gas["Densities" if swift else "Density"] = X[part], DENSITY[part]
        gas["Velocities"], gas["ParticleIDs"] = X[part], np.arange(len(X))[part]
        if not table:
            gas["Masses"] = MASS[part]
        gas["SmoothingLengths" if swift else "SmoothingLength"] = np.full(len(X[part]), 2 * H / (1.825742 if swift else 1))
        file.create_group("PartType1")["Coordinates"] = X[part][:5]
        if swift:
            file.create_group("HydroScheme").attrs.update({"Kernel gamma": [1.825742],
                                                          "Kernel function": b"Cubic spline (M4)"})
        if periodic:
            file.create_group("Parameters").attrs["InitialConditions:periodic"] = b"1"


def complete_swift(path):
    """Adds to a snapshot of SWIFT all attributes that swiftsimio needs."""
    counts, one, zero = np.array([len(X), 5, 0, 0, 0, 0, 0]), [1.0], [0.0]
    units = {f"Unit {name} in cgs (U_{letter})": one for name, letter in (
        ("mass", "M"), ("length", "L"), ("time", "t"), ("current", "I"), ("temperature", "T"))}
    exponents = {f"{name} exponent": zero for name in ("U_M", "U_t", "U_I", "U_T", "a-scale", "h-scale")}
    more = {
        "Units": units, "InternalCodeUnits": units, "SubgridScheme": {"NamedColumns": b""},
        "Code": {"Code": b"SWIFT", "Git Revision": b"x"}, "HydroScheme": {"Scheme": b"SPHENIX", "Hydro gamma": [5 / 3]},
        "Cosmology": {"Cosmological run": [0], "Scale-factor": one, "Redshift": zero},
        "Header": {"NumPart_ThisFile": counts, "NumPart_Total": counts, "NumPart_Total_HighWord": 0 * counts, "Time": [0.25],
                   "BoxSize": [4.0, 4.0, 4.0], "Dimension": [3], "Scale-factor": one, "Redshift": zero, "Code": b"SWIFT",
                   "NumFilesPerSnapshot": [1], "OutputType": b"FullVolume", "NumPartTypes": [7], "Virtual": [0],
                   "SnapshotDate": b"2026-11-24 00:00:00", "RunName": b"test", "SystemName": b"test", "ThisFile": [0]}}
    with h5py.File(path, "a") as file:
        for group, attributes in more.items():
            file.require_group(group).attrs.update(attributes)
        for data in (data for kind in ("PartType0", "PartType1") for data in file[kind].values()):
            data.attrs.update({
                **exponents, "U_L exponent": one, "Description": b"-", "Expression for physical CGS units": b"-",
                "Conversion factor to CGS (not including cosmological corrections)": one,
                "Conversion factor to physical CGS (including cosmological corrections)": one})


def write_phantom(path):
    with h5py.File(path, "w") as file:
        header, gas = file.create_group("header"), file.create_group("particles")
        header["massoftype"], header["hfact"], header["time"] = [0.001] + [0.0] * 6, 1.2, 7.0
        h = 1.2 * (0.001 / DENSITY) ** (1 / 3)
        gas["xyz"], gas["h"] = X, np.where(np.arange(len(X)) == 7, -h, h)
        gas["itype"] = np.where(X[:, 0] < 0, -1, 1).astype(np.int8)
        gas["vxyz"] = X


def write_native(path):
    """Writes a dump in Phantom's own format: the parts that sarracen reads, each with its length before and after it, as Fortran writes them."""
    def block(data):
        return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))

    h = (1.2 * (0.001 / DENSITY) ** (1 / 3))
    h[7] = -h[7]
    out = block(struct.pack("<idiii", 60769, 60878.0, 60878, 1, 690706)) + block(b"FT:Phantom".ljust(100))
    numbers = {0: (b"nparttot", struct.pack("<i", len(X)))}
    for kind in range(8):
        if kind in numbers:
            out += block(struct.pack("<i", 1)) + block(numbers[kind][0].ljust(16)) + block(numbers[kind][1])
        elif kind == 5:
            values = {b"massoftype": 0.001, b"hfact": 1.2, b"time": 7.0}
            out += block(struct.pack("<i", 3)) + block(b"".join(name.ljust(16) for name in values))
            out += block(struct.pack("<3d", *values.values()))
        else:
            out += block(struct.pack("<i", 0))
    out += block(struct.pack("<i", 1)) + block(struct.pack("<q8i", len(X), 0, 0, 0, 0, 0, 4, 0, 0))
    for name, values in zip((b"x", b"y", b"z", b"h"), (*X.T, h)):
        out += block(name.ljust(16)) + block(values.astype("<f8").tobytes())
    Path(path).write_bytes(out)
    return h


def write_pysph(path):
    with h5py.File(path, "w") as file:
        file.create_group("solver_data").attrs.update({"t": 0.5, "dt": 1e-3, "count": 9})
        for name, chosen in (("fluid", ~WALL), ("boundary", WALL)):
            arrays = file.create_group(f"particles/{name}/arrays")
            for axis, letter in enumerate("xyz"):
                arrays[letter] = X[chosen, axis]
            arrays["h"], arrays["m"] = np.full(chosen.sum(), H), MASS[chosen]
            arrays["rho"] = DENSITY[chosen]
            arrays["tag"] = np.arange(chosen.sum()) == 0  # One particle belongs to another process.
            if name == "fluid":
                arrays["u"], arrays["v"], arrays["w"] = X[chosen].T


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def at(self, name):
        return self.folder / name

    def assert_refused(self, words, path, **more):
        with self.assertRaises(io.FileError) as caught:
            particles = io.read(path, **more)
            particles.positions, dict(particles.arrays)
        self.assertIn(words, f"{caught.exception.code}: {caught.exception}")
        self.assertNotIn("\n", str(caught.exception))

    def fuzz(self, makers, least, tries, readings=({},), in_numbers=False):
        """Reads each file with its end cut off, with bits flipped in its head, or with bits flipped anywhere (in_numbers: with numbers in
        its head replaced). Each reading gives particles, or a FileError of one line. More than `least` files must give a FileError.
        makers: {name: function(path, random)}. tries: damaged files of each maker. readings: keywords of io.read() for each reading."""
        random, refused = np.random.default_rng(44), 0
        for name, make in makers.items():
            make(self.at(name), random)
            whole = self.at(name).read_bytes()
            for i in range(tries):
                data = bytearray(whole[:random.integers(1, len(whole))] if i % 3 == 0 else whole)
                for _ in range(0 if i % 3 == 0 else random.integers(1, 9)):
                    numbers = list(re.finditer(rb"\d+", bytes(data[:4000]))) if in_numbers and i % 3 == 2 else []
                    if numbers:
                        found = numbers[random.integers(len(numbers))]
                        other = random.choice([b"-1", b"99999999999", b"1e300", b"nan", b"0"])
                        data[found.start():found.end()] = other.ljust(found.end() - found.start())
                    else:
                        data[random.integers(min(len(data), 4000 if in_numbers or i % 3 == 1 else len(data)))] ^= 1 << random.integers(8)
                self.at(name).write_bytes(data)
                try:
                    for words in readings:
                        particles = quietly(io.read, self.at(name), **words)
                        particles.positions, dict(particles.arrays), len(particles)
                except io.FileError as error:
                    refused += 1
                    self.assertNotIn("\n", str(error))
                    self.assertLess(len(str(error)), 400)
        self.assertGreater(refused, least)


class Layouts(Case):
    def assert_surface(self, found, positions=X, **words):
        wanted = quietly(mc.isosurface, positions, words.pop("scalar", DENSITY), words.pop("iso", 1.5), **words)
        self.assertGreater(len(wanted.triangles), 300)
        self.assertEqual(found.points.tobytes(), wanted.points.tobytes())
        self.assertEqual(found.triangles.tobytes(), wanted.triangles.tobytes())

    def test_gadget(self):
        write_gadget(self.at("snap.hdf5"))
        particles = io.read(self.at("snap.hdf5"))
        surface = quietly(mc.isosurface, particles, "Density", 1.5, attributes=["Velocities"])
        self.assert_surface(surface, smoothing_length=H, mass=MASS, density=DENSITY)
        self.assertEqual(surface.attributes["Velocities"].shape, surface.points.shape)
        self.assertEqual((particles.time, particles.period, particles.parameters["box_size"]), (0.25, None, [4.0] * 3))
        self.assertAlmostEqual(particles.parameters["scale_factor"], 0.25)
        self.assertEqual(len(io.read(self.at("snap.hdf5"), types="dark_matter")), 5)
        self.assertEqual(len(io.read(self.at("snap.hdf5"), types=[0, 1])), len(X) + 5)
        self.assertEqual(set(io.read(self.at("snap.hdf5"), types=["stars", "gas"])), set(io.read(self.at("snap.hdf5"))))
        self.assertTrue((io.read(self.at("snap.hdf5"), types=1).arrays["Masses"] == 2).all())
        self.assert_refused("no type 'water'", self.at("snap.hdf5"), types="water")
        with self.assertRaisesRegex(io.FileError, "Did you mean 'Density'"):
            mc.isosurface(particles, "Densty", 1.5)

    def test_gadget_in_several_files(self):
        write_gadget(self.at("snap.0.hdf5"), slice(0, 1000), files=3)
        write_gadget(self.at("snap.1.hdf5"), slice(1000, 1000), files=3)
        self.assert_refused("snap.2.hdf5 is missing", self.at("snap.0.hdf5"))
        write_gadget(self.at("snap.2.hdf5"), slice(1000, None), files=3)
        particles = io.read(self.at("snap.1.hdf5"))
        self.assertEqual(particles.positions.tobytes(), X.tobytes())
        self.assertEqual(particles.arrays["ParticleIDs"].tolist(), list(range(len(X))))

    def test_mass_table(self):
        write_gadget(self.at("snap.hdf5"), table=True)
        self.assertTrue((io.read(self.at("snap.hdf5")).quantity("mass") == 0.001).all())

    def test_period(self):
        """The period follows from the configuration that GADGET-4 and AREPO store in a file."""
        def period(**config):
            write_gadget(self.at("snap.hdf5"))
            with h5py.File(self.at("snap.hdf5"), "a") as file:
                file.create_group("Config").attrs.update(config)
                if "DOUBLEPRECISION" in config:
                    file.create_group("Parameters").attrs["PeriodicBoundariesOn"] = np.int32(1)
            particles = io.read(self.at("snap.hdf5"))
            return particles.period, particles.dimension

        self.assertEqual(period(), (None, 3))
        self.assertEqual(period(PERIODIC=b""), ([0, 4] * 3, 3))
        self.assertEqual(period(PERIODIC=b"", LONG_Y_BITS=2.0), ([0, 4, 0, 1, 0, 4], 3))
        self.assertEqual(period(DOUBLEPRECISION=1.0, LONG_X=2.5, REFLECTIVE_Y=1.0, TWODIMS=b""), ([0, 10, 0, 0, 0, 4], 2))
        self.assertEqual(period(DOUBLEPRECISION=1.0, REFLECTIVE_X=2.0, REFLECTIVE_Y=2.0, REFLECTIVE_Z=2.0), (None, 3))
        self.assertIsNone(period(PERIODIC=b"", LONG_X=float("nan"))[0])

    def test_swift(self):
        write_gadget(self.at("swift.hdf5"), swift=True, periodic=True)
        particles = io.read(self.at("swift.hdf5"))
        self.assertEqual((particles.layout, particles.kernel, particles.period),
                         ("SWIFT", "Cubic spline (M4)", [0.0, 4.0] * 3))
        self.assertLess(np.abs(particles.quantity("smoothing_length") - 2 * H).max(), 1e-12)

    def test_swiftsimio(self):
        """swiftsimio, SWIFT's own reader, reads the same particles from a file as io.read()."""
        if not importlib.util.find_spec("swiftsimio"):
            self.skipTest("swiftsimio, which wheel.swift installs, is not here")
        import swiftsimio

        write_gadget(self.at("swift.hdf5"), swift=True, periodic=True)
        complete_swift(self.at("swift.hdf5"))
        theirs, ours = swiftsimio.load(str(self.at("swift.hdf5"))), io.read(self.at("swift.hdf5"))
        gamma = theirs.metadata.hydro_scheme["Kernel gamma"][0]
        for wanted, found in ((theirs.gas.coordinates, ours.positions), (theirs.gas.densities, ours.quantity("density")),
                              (theirs.gas.smoothing_lengths * gamma, ours.quantity("smoothing_length")),
                              (theirs.gas.masses, ours.quantity("mass"))):
            self.assertEqual(np.asarray(wanted).tolist(), found.tolist())
        self.assertEqual((float(theirs.metadata.time), ours.time), (0.25, 0.25))
        self.assertEqual([float(side) for side in theirs.metadata.boxsize], ours.parameters["box_size"])
        self.assertEqual(theirs.metadata.hydro_scheme["Kernel function"], ours.kernel)

    def test_phantom(self):
        write_phantom(self.at("dump.h5"))
        particles = io.read(self.at("dump.h5"))
        alive = np.arange(len(X)) != 7
        self.assertEqual(particles.positions.tobytes(), X[alive].tobytes())
        self.assertLess(np.abs(particles.arrays["density"] / DENSITY[alive] - 1).max(), 1e-12)
        self.assertNotIn("itype", particles.arrays)  # -1 marks no wall here.
        self.assertEqual(particles.time, 7.0)

    def test_packages(self):
        """If a package is missing, the error names it as pip does."""
        write_native(self.at("dump"))
        write_gadget(self.at("snap.hdf5"))
        for missing, name, packages in (("sarracen", "dump", "sarracen scikit-learn"), ("h5py", "snap.hdf5", "h5py")):
            with unittest.mock.patch.dict(sys.modules, {missing: None}):
                self.assert_refused(f"pip install {packages}", self.at(name))

    def test_phantom_native(self):
        if not all(importlib.util.find_spec(name) for name in ("sarracen", "sklearn")):
            self.skipTest("sarracen and scikit-learn, which wheel.phantom installs, are not here")
        h = write_native(self.at("dump_00000"))
        particles = quietly(io.read, self.at("dump_00000"))
        self.assertEqual(particles.positions.tobytes(), X[h > 0].tobytes())
        self.assertEqual(particles.quantity("smoothing_length").tobytes(), h[h > 0].tobytes())
        self.assertLess(np.abs(particles.arrays["density"] / DENSITY[h > 0] - 1).max(), 1e-12)

    def test_pysph(self):
        write_pysph(self.at("run_9.hdf5"))
        particles = io.read(self.at("run_9.hdf5"))
        own = np.concatenate([X[WALL][1:], X[~WALL][1:]])  # Sets come in the order of their names.
        self.assertEqual(particles.positions.tobytes(), own.tobytes())
        self.assertEqual(particles.solid.tolist(), [True] * (WALL.sum() - 1) + [False] * ((~WALL).sum() - 1))
        self.assertEqual((particles.time, particles.dimension), (0.5, 3))
        velocity = particles.arrays["Velocity"]
        self.assertEqual(velocity[~particles.solid].tobytes(), X[~WALL][1:].tobytes())
        self.assertFalse(velocity[particles.solid].any())
        joined = [np.concatenate([a[WALL][1:], a[~WALL][1:]]) for a in (DENSITY, MASS)]
        self.assert_surface(quietly(mc.isosurface, particles, "rho", 1.5), own, scalar=joined[0], smoothing_length=H,
                            mass=joined[1], density=joined[0], solid=particles.solid)

    def test_bi4(self):
        for order in "<>":
            for wide in (False, True):
                for double in (False, True):
                    write_bi4(self.at("Part_0003.bi4"), order, wide, double, period=3)
                    particles = io.read(self.at("Part_0003.bi4"))
                    self.assertEqual(particles.positions.tobytes(),
                                     X.astype(np.float64 if double else np.float32).tobytes())
                    self.assertEqual(particles.solid.tolist(), WALL.tolist())
                    self.assertEqual((particles.time, particles.smoothing_length, particles.mass, particles.rho0,
                                      particles.support_radius), (0.75, H, 1.0, 1000.0, False))
                    self.assertEqual(particles.period, [-2, 2, -2, 2, 0, 0])
                    self.assertEqual(particles.parameters["AppName"], "été")
        write_bi4(self.at("Part_0003.bi4"))
        rho = (1000 * DENSITY).astype(np.float32)
        self.assert_surface(quietly(mc.isosurface, io.read(self.at("Part_0003.bi4")), "Rhop", 1500.0), scalar=rho,
                            iso=1500.0, smoothing_length=H, mass=1.0, density=rho, solid=WALL, sph_kernel="wendland")

    def test_bgeo(self):
        for pack in (bytes, gzip.compress):
            write_bgeo(self.at("fluid.bgeo"), pack)
            particles = io.read(self.at("fluid.bgeo"))
            self.assertEqual(particles.positions.tobytes(), X.astype(np.float32).tobytes())
            self.assertEqual(particles.arrays["velocity"].tobytes(), X.astype(np.float32).tobytes())
            self.assertEqual(particles.arrays["id"].tolist(), list(range(len(X))))

    def test_bodies(self):
        for name, chosen in (("WaterBody_1.vtp", ~WALL), ("WallBoundary_1.vtp", WALL)):
            body = pyvista.PolyData(X[chosen])
            body["Density"] = DENSITY[chosen]
            if name.startswith("Water"):  # SPHinXsys writes it like this.
                body["Pressure"], body["Velocity"] = DENSITY[chosen] + 1, X[chosen]
                body.field_data["TimeValue"] = [0.25]
            body.save(self.at(name))
        both = [self.at("WaterBody_1.vtp"), self.at("WallBoundary_1.vtp")]
        for particles in (io.read(both), io.read(both[0], walls=both[1:])):
            self.assertEqual(particles.positions.tobytes(), np.concatenate([X[~WALL], X[WALL]]).tobytes())
            self.assertEqual(particles.solid.sum(), WALL.sum())
            self.assertTrue(particles.solid[-1])
            self.assertEqual(particles.time, 0.25)
            pressure, velocity = particles.arrays["Pressure"], particles.arrays["Velocity"]
            self.assertEqual(pressure[~particles.solid].tolist(), (DENSITY[~WALL] + 1).tolist())
            self.assertEqual(set(pressure[particles.solid]), {np.sort(DENSITY[~WALL] + 1)[((~WALL).sum() - 1) // 2]})
            self.assertEqual(velocity.shape, (len(X), 3))
            self.assertTrue(np.array_equal(particles.arrays["Density"], np.concatenate([DENSITY[~WALL], DENSITY[WALL]])))

    def test_sphinxsys(self):
        """Reads files like those of SPHinXsys' own writer. Such files are text, and their attribute Vectors names an array that is not there."""
        def write(name, chosen, arrays):
            def array(name, values, more=""):
                kind = "Int32" if values.dtype.kind == "i" else "Float32"
                return (f'    <DataArray Name="{name}" type="{kind}" {more} Format="ascii">\n'
                        + " ".join(f"{value:.9f}" if kind == "Float32" else str(value) for value in values.ravel())
                        + "\n    </DataArray>\n")

            count, three = int(chosen.sum()), 'NumberOfComponents="3"'
            self.at(name).write_text(
                '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">\n <PolyData>\n'
                f'  <Piece Name ="{name}" NumberOfPoints="{count}" NumberOfVerts="{count}">\n   <Points>\n'
                + array("Position", X[chosen], three) + '   </Points>\n   <PointData  Vectors="vector">\n'
                + array("SortedParticle_ID", np.arange(count))
                + "".join(array(key, values[chosen], three if values.ndim == 2 else "") for key, values in arrays.items())
                + "   </PointData>\n   <Verts>\n" + array("connectivity", np.arange(count))
                + array("offsets", np.arange(count) + 1)
                + "   </Verts>\n  </Piece>\n </PolyData>\n</VTKFile>\n")

        write("WaterBody_0000521845.vtp", ~WALL, {"Density": DENSITY, "Velocity": X, "VolumetricMeasure": MASS / DENSITY})
        write("Wall_0000000000.vtp", WALL, {"NormalDirection": X})
        particles = io.read([self.at("WaterBody_0000521845.vtp"), self.at("Wall_0000000000.vtp")])
        self.assertEqual(particles.solid.tolist(), [False] * (~WALL).sum() + [True] * WALL.sum())
        self.assertLess(np.abs(particles.positions[~particles.solid] - X[~WALL]).max(), 1e-6)
        self.assertEqual(list(particles.arrays), ["SortedParticle_ID", "Density", "Velocity", "VolumetricMeasure"])
        self.assertLess(np.abs(particles.arrays["Velocity"][~particles.solid] - X[~WALL]).max(), 1e-6)

    def test_walls_by_names(self):
        for wall in ("rb_particle_data_0_1.vtk", "Obstacle.vtp", "PartBound_0000.vtk", "WallBoundary_0.vtp", "Rigid.vtu"):
            for name, chosen in (("ParticleData_Fluid_1.vtk", ~WALL), (wall, WALL)):
                body = pyvista.PolyData(X[chosen])
                (body.cast_to_unstructured_grid() if name.endswith("u") else body).save(self.at(name))
            particles = io.read([self.at("ParticleData_Fluid_1.vtk"), self.at(wall)])
            self.assertEqual(particles.solid.tolist(), [False] * (~WALL).sum() + [True] * WALL.sum(), wall)

    def test_partvtk(self):
        """Particles' types say which are walls, in one file and in several, whatever names the files have."""
        kinds = np.where(WALL, 1, 3).astype(np.uint8)
        for name, chosen in (("PartAll_0001.vtk", X[:, 0] < 9), ("PartFluid_0001.vtk", ~WALL), ("PartMoving_0001.vtk", WALL)):
            body = pyvista.PolyData(X[chosen].astype(np.float32))
            body["Idp"], body["Rhop"], body["Type"] = np.flatnonzero(chosen).astype(np.uint32), DENSITY[chosen], kinds[chosen]
            body.save(self.at(name))
        self.assertEqual(io.read(self.at("PartAll_0001.vtk")).solid.tolist(), WALL.tolist())
        parts = io.read([self.at("PartFluid_0001.vtk"), self.at("PartMoving_0001.vtk")])
        self.assertEqual(parts.solid.tolist(), [False] * (~WALL).sum() + [True] * WALL.sum())
        self.assertIsNone(io.read(self.at("PartFluid_0001.vtk")).solid)

    def test_legacy_of_all_kinds(self):
        """.vtk files of versions 4.2 and 5.1, of PolyData and of unstructured grids, as text and binary, with arrays of points and of cells,
        are read as VTK reads them."""
        for version, text, grid in itertools.product((42, 51), (False, True), (False, True)):
            body = pyvista.PolyData(X.astype(np.float32) if grid else X)
            body["an id"], body["Velocity"], body["t"] = np.arange(len(X)), X.astype(np.float32), np.tile(DENSITY[:, None], 9)
            body.cell_data["Mass"], body.field_data["TimeValue"] = MASS, [0.75]
            writer = vtkUnstructuredGridWriter() if grid else vtkPolyDataWriter()
            writer.SetFileName(str(self.at("body.vtk")))
            writer.SetInputData(body.cast_to_unstructured_grid() if grid else body)
            writer.SetFileVersion(version)
            writer.SetFileType(1 if text else 2)
            writer.Write()
            found, wanted = io.read(self.at("body.vtk")), pyvista.read(self.at("body.vtk"))
            self.assertTrue(np.array_equal(found.positions, wanted.points))
            self.assertEqual(sorted(found.arrays), ["Mass", "Velocity", "an id", "t"])
            for name in found.arrays:
                self.assertTrue(np.array_equal(found.arrays[name], wanted[name]), (version, text, grid, name))
            self.assertEqual(found.time, 0.75)

    def test_xml_of_all_kinds(self):
        """.vtp and .vtu files as text, base64 and binary, compressed or not, in both byte orders and both sizes of headers, are read as VTK
        reads them."""
        random = np.random.default_rng(43)
        for mode, packed, order, header in itertools.product(
                ("Ascii", "Binary", "Appended", "bytes"), ("None", "ZLib", "LZ4", "LZMA"), (0, 1), (32, 64)):
            body = pyvista.PolyData(random.normal(size=(random.integers(1, 2000), 3)).astype(random.choice(["f4", "f8"])))
            for kind in ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"):
                limits = np.iinfo(kind)
                body[f"an {kind}"] = random.integers(limits.min // 2, limits.max // 2, body.n_points).astype(kind)
            body["Velocity"], body["t"] = body.points, random.normal(size=(body.n_points, 9))
            body["gaps"] = np.where(np.arange(body.n_points) % 2, np.nan, np.inf)
            body.cell_data["Mass"], body.field_data["TimeValue"] = np.arange(body.n_points), [0.75]
            body.field_data["words"] = ["a", "b"]
            grid = random.integers(2)
            path = self.at("grid.vtu" if grid else "body.vtp")
            writer = vtkXMLUnstructuredGridWriter() if grid else vtkXMLPolyDataWriter()
            writer.SetFileName(str(path))
            writer.SetInputData(body.cast_to_unstructured_grid() if grid else body)
            getattr(writer, f"SetDataModeTo{mode.replace('bytes', 'Appended')}")()
            writer.SetEncodeAppendedData(mode == "Appended")
            writer.SetCompressor(None) if packed == "None" else getattr(writer, f"SetCompressorTypeTo{packed}")()
            writer.SetByteOrder(order)
            writer.SetHeaderType(header)
            writer.SetBlockSize(4096)
            writer.Write()
            found, wanted = io.read(path), pyvista.read(path)
            self.assertEqual((found.positions.dtype, found.positions.tolist()), (wanted.points.dtype, wanted.points.tolist()))
            self.assertEqual(sorted(found.arrays), sorted([*wanted.point_data, "Mass"]))  # Mass is the array of the vertices.
            for name in found.arrays:
                values = np.asarray(wanted[name])
                self.assertEqual(found.arrays[name].dtype, values.dtype)
                self.assertTrue(np.array_equal(found.arrays[name], values, equal_nan=True), (mode, packed, order, header, name))
            self.assertEqual(found.time, 0.75)

    def test_vertices_in_a_mesh(self):
        """In a file with vertices, points that no vertex uses belong to a mesh and are left out. Arrays of the vertex cells become the
        particles'. VTK's writer made the files."""
        box = pyvista.ImageData(dimensions=(4, 4, 4)).cast_to_unstructured_grid()
        order = np.random.default_rng(44).permutation(len(X))
        cells = np.concatenate([box.cells, np.column_stack([np.ones(len(X), int), box.n_points + order]).ravel()])
        types = np.concatenate([box.celltypes, np.ones(len(X), np.uint8)])
        grid = pyvista.UnstructuredGrid(cells, types, np.concatenate([box.points, X]))
        grid["Velocity"] = grid.points * 2
        grid.cell_data["rho"] = np.concatenate([np.zeros(box.n_cells), DENSITY[order]])
        body = pyvista.PolyData(grid.points, verts=np.column_stack([np.ones(len(X), int), box.n_points + order]).ravel(),
                                faces=np.array([4, 0, 1, 5, 4]))
        body["Velocity"], body.cell_data["rho"] = grid.points * 2, np.append(DENSITY[order], 0)
        for name, data in (("grid.vtu", grid), ("body.vtp", body), ("body.vtk", body), ("old.vtk", grid), ("new.vtk", grid)):
            data = data.copy()
            with self.assertWarnsRegex(mc.InputWarning, says("MESH_NODES", "64 of 3033 points are")):  # PyVista gives this warning, too.
                taken = data.sph._particles
            self.assertTrue(np.array_equal(taken.points, X) and np.array_equal(taken["Velocity"], X * 2))
            self.assertTrue(np.array_equal(taken["rho"], DENSITY))
            if name in ("old.vtk", "new.vtk"):
                writer = vtkUnstructuredGridWriter()
                writer.SetFileName(str(self.at(name)))
                writer.SetInputData(data)
                writer.SetFileVersion(42 if name == "old.vtk" else 51)
                writer.SetFileTypeToBinary()
                writer.Write()
            else:
                data.save(self.at(name))
            with self.assertWarnsRegex(mc.InputWarning, says("MESH_NODES", f"64 of 3033 points of {name} are")):
                particles = io.read(self.at(name))
            self.assertTrue(np.array_equal(particles.positions, X), name)
            self.assertTrue(np.array_equal(particles.arrays["Velocity"], X * 2), name)
            self.assertTrue(np.array_equal(particles.arrays["rho"], DENSITY), name)
            self.assertEqual(particles.density, "rho")
        box.save(self.at("box.vtu"))
        for names, count in ((("box.vtu", "grid.vtu"), len(X)), (("box.vtu", "box.vtu"), 128)):  # Pieces as VTK reads them.
            self.at("p.pvtu").write_text('<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid>' + "".join(
                f'<Piece Source="{name}"/>' for name in names) + "</PUnstructuredGrid></VTKFile>")
            self.assertEqual(len(quietly(io.read, self.at("p.pvtu"))), count)

    def test_xml_in_pieces(self):
        """The pieces of a file are joined one after the other. Only arrays that all pieces have are kept."""
        def piece(numbers, more=""):
            return (f'<Piece NumberOfPoints="{len(numbers)}"><PointData><DataArray type="Float64" Name="h" format="ascii">'
                    f'{" ".join(map(str, numbers))}</DataArray>{more}</PointData><Points><DataArray type="Float32" '
                    f'NumberOfComponents="3">{" ".join(f"{n} 0 0" for n in numbers)}</DataArray></Points></Piece>')

        more = '<DataArray type="Int8" Name="a &lt; b" format="ascii">7</DataArray>'
        self.at("body.vtp").write_text('<VTKFile type="PolyData" byte_order="LittleEndian"><PolyData>' + piece([1, 2]) + piece([])
                                       + piece([3], more) + "</PolyData></VTKFile>")
        particles = io.read(self.at("body.vtp"))
        self.assertEqual(particles.positions.tolist(), [[1, 0, 0], [2, 0, 0], [3, 0, 0]])
        self.assertEqual({name: array.tolist() for name, array in particles.arrays.items()}, {"h": [1, 2, 3]})
        self.at("one.vtp").write_text('<VTKFile type="PolyData"><PolyData>' + piece([3], more) + "</PolyData></VTKFile>")
        self.assertEqual(sorted(io.read(self.at("one.vtp")).arrays), ["a < b", "h"])

    def test_lists(self):
        """The pieces that a list names are read as one set. If a piece has copies of another piece's particles, the copies are left out. If
        a list names two files for the same part and time, the later file counts."""
        def write(name, numbers, ghosts=()):
            text = " ".join(map(str, numbers))
            self.at(name).write_text(
                f'<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="{len(numbers)}"><PointData>'
                f'<DataArray type="Int32" Name="n" format="ascii">{text}</DataArray><DataArray type="UInt8" Name="vtkGhostType" '
                f'format="ascii">{" ".join(str(int(n in ghosts)) for n in numbers)}</DataArray></PointData><Points><DataArray '
                f'type="Float32" NumberOfComponents="3">{" ".join(f"{n} 0 0" for n in numbers)}</DataArray></Points></Piece>'
                '</PolyData></VTKFile>')

        def write_list(name, kind, entries):
            self.at(name).write_text(f'<VTKFile type="{kind}"><{kind}>{"".join(f"<{entry}/>" for entry in entries)}</{kind}></VTKFile>')

        write("a.vtp", [1, 2, 3], ghosts=[3])
        write("b.vtp", [3, 4], ghosts=[])
        write("none.vtp", [])
        write_list("all.pvtp", "PPolyData", ['Piece Source="a.vtp"', 'Piece Source="none.vtp"', 'Piece Source="b.vtp"'])
        self.assertEqual(io.read(self.at("all.pvtp"))["n"].tolist(), [1, 2, 3, 4])
        entry = 'DataSet timestep="{}" part="{}" file="{}"'.format
        write_list("run.pvd", "Collection", [entry(0.5, 0, "b.vtp"), entry(0.5, 1, "all.pvtp"), entry(0, 0, "a.vtp"),
                                             entry(0, 0, "b.vtp"), entry(2, 0, "none.vtp")])
        with self.assertWarnsRegex(mc.InputWarning, says("LISTED_TWICE", "run.pvd lists 1 file", "time 0;")):
            first = io.read(self.at("run.pvd"))
        self.assertEqual((first["n"].tolist(), first.time, first.times), ([3, 4], 0, [0, 0.5, 2]))
        self.assertEqual(quietly(io.read, self.at("run.pvd"), step=1)["n"].tolist(), [3, 4, 1, 2, 3, 4])
        self.assertEqual(len(quietly(io.read, self.at("run.pvd"), step=-1)), 0)
        self.at("other.vtp").write_text(self.at("b.vtp").read_text().replace('"n"', '"m"'))
        with self.assertWarnsRegex(mc.InputWarning, says("ARRAYS_NOT_SHARED", "m, n")):
            self.assertEqual(dict(io.read([self.at("b.vtp"), self.at("other.vtp")]).arrays), {})
        self.assertEqual(io.read([self.at("none.vtp"), self.at("b.vtp")])["n"].tolist(), [3, 4])
        for kind, tag, sentence in (
                ("x.pvtp", "a", "lists no pieces"), ("x.pvtp", 'Piece Source="all.pvtp"', "is no .vtp file"),
                ("x.pvd", "a", "lists no files"), ("x.pvd", entry("late", 0, "a.vtp"), "time 'late' is no number"),
                ("x.pvd", entry("inf", 0, "a.vtp"), "time 'inf' is no number"),
                ("x.pvd", entry(0, 0, "run.pvd"), "lists run.pvd, which is no file"),
                ("x.pvtp", 'Piece Source="gone.vtp"', "there is no such file")):
            write_list(kind, "PPolyData" if kind == "x.pvtp" else "Collection", [tag])
            with self.assertRaisesRegex(io.FileError, sentence):
                io.read(self.at(kind))

    def test_quantities(self):
        """Arguments of a call replace quantities of the file, and nothing else. The arguments have the core's names."""
        body = pyvista.PolyData(X)
        body["Rhop"], body["hsml"], body["m1"], body["Velocity"] = DENSITY, np.full(len(X), H), MASS, X
        body.save(self.at("body.vtp"))
        particles = io.read(self.at("body.vtp"))
        self.assertEqual((particles.density, particles.smoothing_length, particles.mass), ("Rhop", "hsml", None))
        wanted = quietly(mc.free_surface, X, smoothing_length=H, mass=0.001, density=DENSITY)
        for words in ({"mass": 0.001}, {"mass": 0.001, "density": "Rhop", "smoothing_length": "hsml"}):
            found = quietly(mc.free_surface, particles, **words)
            self.assertEqual(found.points.tobytes(), wanted.points.tobytes())
        self.assertEqual(quietly(mc.gauge, particles, ((0, 0, 0), (0, 0, 2)), mass=0.001).last.tolist(), quietly(
            mc.gauge, X, ((0, 0, 0), (0, 0, 2)), smoothing_length=H, mass=0.001, density=DENSITY).last.tolist())
        wanted = quietly(mc.free_surface, X, smoothing_length=H, mass=MASS, density=DENSITY)
        for attributes in ("Velocity", ["Velocity"], {"Velocity": X}):
            found = quietly(mc.derivatives, particles, attributes, mass="m1").gradients["Velocity"]
            self.assertLess(np.abs(found - np.eye(3)).max(), 1e-5)
        self.assertEqual(quietly(mc.free_surface, particles, mass="m1").points.tobytes(), wanted.points.tobytes())
        with self.assertRaisesRegex(io.FileError, "the array 'Velocity' has the shape"):
            particles.smoothing_length = "Velocity"
            particles.quantity("smoothing_length")

    def test_types_of_numbers(self):
        write_gadget(self.at("snap.hdf5"))
        with h5py.File(self.at("snap.hdf5"), "a") as file:
            file["PartType0/Half"], file["PartType0/Long"] = DENSITY.astype(np.float16), DENSITY.astype(np.longdouble)
            file["PartType0/Big"] = DENSITY.astype(">f4")
        arrays = io.read(self.at("snap.hdf5")).arrays
        self.assertEqual([arrays[name].dtype for name in ("Half", "Long", "Big")], [np.float32, np.float64, np.float32])
        self.assertTrue(np.array_equal(arrays["Long"], DENSITY))
        data = mc.read_pyvista(self.at("snap.hdf5"))
        self.assertTrue(np.array_equal(data["Half"], DENSITY.astype(np.float16).astype(np.float32)))

    def test_named_twice(self):
        text = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOINT_DATA 1\n"
        self.at("body.vtk").write_text(text + "FIELD f 2\nh 1 1 float\n1\nh 1 1 float\n2\n")
        with self.assertWarnsRegex(mc.InputWarning, "body.vtk has several arrays 'h'"):
            self.assertEqual(io.read(self.at("body.vtk")).arrays["h"].tolist(), [2])

    def test_one_of_no_files(self):
        write_gadget(self.at("snap.0.hdf5"), files=0)
        self.assertEqual(len(io.read(self.at("snap.0.hdf5"))), len(X))

    def test_legacy_strings(self):
        """Texts in field data, beside numbers, are read from text and binary files."""
        for binary in (False, True):
            body = pyvista.PolyData(X)
            body.field_data["constants"], body.field_data["TIME"] = ["h:0.025", "", "m 0.56", "x" * 300], [0.5]
            body["Density"], body["words"] = DENSITY, [str(i) for i in range(len(X))]
            body["Marks"] = X[:, 0] < 0
            body.save(self.at("body.vtk"), binary=binary)
            particles = io.read(self.at("body.vtk"))
            self.assertEqual(particles.time, 0.5)
            self.assertEqual(sorted(particles.arrays), ["Density", "Marks"])
            self.assertLess(np.abs(particles.arrays["Density"] - DENSITY).max(), 1e-9)
            self.assertEqual(particles.arrays["Marks"].tolist(), (X[:, 0] < 0).tolist())

    def test_lazy(self):
        """No array is read before it is used."""
        write_gadget(self.at("snap.hdf5"))
        particles = io.read(self.at("snap.hdf5"))
        self.assertEqual((particles._positions._kept, particles.arrays._kept), ({}, {}))
        particles.positions
        self.assertEqual((list(particles._positions._kept), particles.arrays._kept), ([""], {}))

    def test_kernels(self):
        """Each solver's kernel name gives the surface that sph_kernel gives with the file's support radii. read_pyvista() gives h: the
        support radius divided by the kernel's own factor (2, 2.5 or 3)."""
        swift = {"Cubic spline (M4)": "cubic", "Quartic spline (M5)": "quartic", "Quintic spline (M6)": "quintic",
                 "Wendland C2": "wendland", "Wendland C4": "wendland_c4", "Wendland C6": "wendland_c6"}
        gizmo = {3: "cubic", 4: "quartic", 5: "quintic", 6: "wendland", 7: "wendland_c4", 9: "wendland_c6"}
        gadget = {"CUBIC_SPLINE_KERNEL": "cubic", "WENDLAND_C2_KERNEL": "wendland", "WENDLAND_C4_KERNEL": "wendland_c4",
                  "WENDLAND_C6_KERNEL": "wendland_c6"}
        for group, names in (("HydroScheme", swift), ("Header", gizmo), ("Config", gadget)):
            write_gadget(self.at("snap.hdf5"), swift=group == "HydroScheme")
            density = "Densities" if group == "HydroScheme" else "Density"
            for name, word in names.items():
                with self.subTest(name):
                    with h5py.File(self.at("snap.hdf5"), "a") as file:
                        attributes = file.require_group(group).attrs
                        if group == "Config":
                            attributes.clear()
                        attributes.update({"HydroScheme": {"Kernel function": np.bytes_(str(name))},
                                           "Header": {"Kernel_Function_ID": name}, "Config": {str(name): 1}}[group])
                    particles = io.read(self.at("snap.hdf5"))
                    self.assert_surface(
                        quietly(mc.isosurface, particles, density, 1.5), sph_kernel=word, mass=MASS, density=DENSITY,
                        smoothing_length=particles.quantity("smoothing_length"), smoothing_length_is_support_radius=True)
                    factor = {"quartic": 2.5, "quintic": 3}.get(word, 2)
                    h = np.ravel(mc.read_pyvista(self.at("snap.hdf5"))["SmoothingLength"])
                    self.assertLess(np.abs(h * factor - 2 * H).max(), 1e-12)
        pysph = {"WendlandQuintic": "wendland", "WendlandQuinticC4": "wendland_c4", "WendlandQuinticC6": "wendland_c6",
                 "WendlandQuinticC2_1D": None, "SuperGaussian": None}
        self.assertEqual({name: find_kernel(name) for name in [*pysph, "sinc_6"]}, {**pysph, "sinc_6": "sinc6"})

    def test_unknown_kernel_is_said(self):
        write_gadget(self.at("swift.hdf5"), swift=True)
        with h5py.File(self.at("swift.hdf5"), "a") as file:
            file["HydroScheme"].attrs["Kernel function"] = b"Super-Gaussian"
        with self.assertWarnsRegex(mc.InputWarning, "Super-Gaussian"):
            mc.isosurface(io.read(self.at("swift.hdf5")), "Densities", 1.5)


class Conversion(Case):
    def test_blocks(self):
        """All blocks are one set of particles. Blocks whose names mean walls are walls."""
        blocks = pyvista.MultiBlock()
        for name, chosen in (("water", ~WALL), ("wall", WALL)):
            blocks[name] = pyvista.PolyData(X[chosen])
            blocks[name]["h"], blocks[name]["m"], blocks[name]["rho"] = np.full(chosen.sum(), H), MASS[chosen], DENSITY[chosen]
        order = np.concatenate([np.flatnonzero(~WALL), np.flatnonzero(WALL)])
        wanted = quietly(mc.free_surface, X[order], smoothing_length=H, mass=MASS[order], density=DENSITY[order],
                         solid=WALL[order])
        self.assertTrue(np.array_equal(quietly(blocks.sph.free_surface).points, wanted.points))

    def test_pyvista(self):
        write_bi4(self.at("Part_0003.bi4"), period=3)
        data = mc.read_pyvista(self.at("Part_0003.bi4"))
        self.assertAlmostEqual(float(np.ravel(data["SmoothingLength"])[0]), H)
        self.assertEqual(data.field_data["TimeValue"][0], 0.75)
        self.assertEqual(data.field_data["PeriodicBounds"].tolist(), [-2, 2, -2, 2, 0, 0])
        surface = quietly(data.sph.isosurface, "Rhop", 1500.0, fluid=("Type", 3), sph_kernel="wendland")
        direct = quietly(mc.isosurface, io.read(self.at("Part_0003.bi4")), "Rhop", 1500.0, periodic=None)
        self.assertEqual(surface.n_cells, len(direct.triangles))

    def test_support_radius(self):
        write_gadget(self.at("swift.hdf5"), swift=True)
        data = mc.read_pyvista(self.at("swift.hdf5"))
        self.assertNotIn("SmoothingLengths", data.point_data)
        self.assertLess(np.abs(data["SmoothingLength"] - H).max(), 1e-12)


if __name__ == "__main__":
    unittest.main()
