# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests vtkSPHGauge, vtkSPHFlux and vtkSPHComponents: odd input first; then levels against brute force, uniform flow, and pieces against VTK's own
filters and shapes of known volume."""
import math
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkMassProperties, vtkPolyDataConnectivityFilter, vtkReverseSense
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkLineSource, vtkPlaneSource, vtkSphereSource

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHComponents, vtkSPHFlux, vtkSPHGauge
from vtk_test import COUNT, blocks_of, cube, lattice, particles_of, points_of, run, says, sums_at, values_of


def made_by(source, **settings):
    for name, value in settings.items():
        getattr(source, "Set" + name)(*(value if isinstance(value, tuple) else (value,)))
    source.Update()
    return source.GetOutput()


def named(data, *names):
    """Gives each cell of the data a name, and returns the data."""
    array = vtkStringArray()
    array.SetName("Name")
    for name in names:
        array.InsertNextValue(name)
    data.GetCellData().AddArray(array)
    return data


def timed(data):
    data.GetInformation().Set(data.DATA_TIME_STEP(), 0.75)
    return data


class MeterTest(unittest.TestCase):
    def measured(self, meter, data=None, **settings):
        """Returns the rows of a run that prints nothing, each a dictionary from column name to value."""
        table, told = run(meter, data, **settings)
        self.assertEqual((told, meter.GetErrorMessage()), ([], ""))
        return self.rows(table)

    def rows(self, table):
        return [{table.GetColumnName(c): value.ToString() if value.IsString() else value.ToDouble()
                 for c in range(table.GetNumberOfColumns()) for value in [table.GetValue(r, c)]}
                for r in range(table.GetNumberOfRows())]

    def refuse(self, meter, words, data, **settings):
        table, told = run(meter, data, **settings)
        self.assertEqual((table.GetNumberOfRows(), len(told)), (0, 1))
        self.assertRegex(meter.GetErrorMessage(), words)


class TestGauge(MeterTest):
    MAST = ("mast", 0.02, 0.1, -2, 0.02, 0.1, 2)

    def gauge(self, *lines):
        gauge = vtkSPHGauge()
        for line in lines:
            gauge.AddGauge(*line)
        return gauge

    def check_row(self, row, level=0.5):
        """Tests the row of an upright line, which is in fluid from the cube's lower side to the upper side."""
        weight = sums_at(cube(), values_of(cube(), "Radius"), [[row[axis] for axis in "xyz"]])[0][0]
        self.assertEqual((row["state"], row["crossings"], row["first"]), ("wet", 2, row["last"]))
        self.assertTrue(0.9 < row["z"] < 1.2)
        self.assertAlmostEqual(weight, level, delta=1e-4)
        self.assertAlmostEqual(row["last"], row["z"] + 2, 9)
        self.assertAlmostEqual(row["depth"], 2 * row["z"], delta=0.05)

    def test_weird(self):
        row, = self.measured(vtkSPHGauge(), vtkPolyData())
        self.assertEqual((row["state"], math.isnan(row["last"])), ("dry", True))
        for lines, words in (([("mast", 0, 0, 0, 0, 0, 0)], says("GAUGE_WITHOUT_LENGTH", "'mast'")),
                             ([("mast", 0, 0, 0, 0, 0, math.nan)], says("GAUGE_NOT_FINITE")),
                             ([("mast", 0, 0, 0, 0, 0, 1), ("mast", 0, 0, 0, 1, 0, 1)], "Two gauges have the name 'mast'")):
            self.refuse(self.gauge(*lines), words, cube())
        table, told = run(self.gauge(("far", 1e6, 0, 0, 1e6, 0, 1), ("near", 0, 0, 0, 0, 0, 1.5)), cube())
        self.assertEqual((len(told), self.rows(table)[0]["state"]), (1, "dry"))

    def test_levels(self):
        gauge = self.gauge(self.MAST, ("inside", 0, 0, 0, 0, 0, 0.5))
        for level in (0.5, 0.2, 0.8):
            mast, inside = self.measured(gauge, timed(cube()), Level=level)
            self.assertEqual((len(mast), mast["gauge"], mast["time"]), (10, "mast", 0.75))
            self.check_row(mast, level)
            self.assertEqual((inside["state"], inside["last"]), ("full", 0.5))

    def test_lines(self):
        """Lines come from the second input, with and without names. A gauge without this input has a line between two
        points."""
        line = made_by(vtkLineSource(), Point1=(0.3, 0.1, -2), Point2=(0.3, 0.1, 2), Resolution=7)  # This is one line, so one gauge.
        gauge = self.gauge(self.MAST)
        rows = self.measured(gauge, cube(), LinesData=line)
        self.assertEqual(tuple(row["gauge"] for row in rows), ("mast", "line 0"))
        for row in rows:
            self.check_row(row)
        self.assertAlmostEqual(rows[1]["x"], 0.3, 6)
        gauge.ClearGauges()
        row, = self.measured(gauge, LinesData=named(line, "bow"))
        self.assertEqual(row["gauge"], "bow")
        alone, = self.measured(vtkSPHGauge(), cube(), Point1=(0.3, 0.1, -2), Point2=(0.3, 0.1, 2))
        self.assertAlmostEqual(alone["last"], row["last"], delta=1e-5)

    def test_blocks_and_solids(self):
        gauge = self.gauge(self.MAST)
        row, = self.measured(gauge, blocks_of(cube(Kind=(points_of(cube())[:, 2] > 0.45).astype(float))))
        self.check_row(row)
        row, = self.measured(gauge, FluidArrayName="Kind", FluidValue=0)
        self.assertAlmostEqual(row["z"], 0.45, delta=0.04)


class TestFlux(MeterTest):
    WALL = ("wall", (0.1, -0.3, -0.3), (0.1, 0.3, -0.3), (0.1, -0.3, 0.4))

    def moving(self, **arrays):
        return cube(Velocity=numpy.tile([1.0, -2, 3], (COUNT, 1)), **arrays)

    def check_row(self, row, name, area, volume_flux):
        self.assertEqual(row["section"], name)
        self.assertAlmostEqual(row["area"], area, delta=1e-6 * area)
        self.assertAlmostEqual(row["volume_flux"], volume_flux, delta=4e-6 * area)
        self.assertAlmostEqual(row["velocity"], volume_flux / area, delta=4e-6)

    def test_weird(self):
        row, = self.measured(vtkSPHFlux(), vtkPolyData())
        self.assertEqual((row["area"], math.isnan(row["velocity"])), (0, True))
        for data, radius, twice, velocity, words in (
                (cube(), 0.3, False, "", says("NO_VELOCITY")),
                (self.moving(), 0, False, "", says("SECTION_WITHOUT_AREA", "'a'")),
                (self.moving(), 0.3, True, "", "Two sections have the name 'a'"),
                (self.moving(), 0.3, False, "Drift", says("NO_SUCH_ARRAY", "'Drift'"))):
            flux = vtkSPHFlux()
            flux.AddDisc("a", (0, 0, 0.1), (0, 0, -3), radius)
            if twice:
                flux.AddBox("a", (-0.3, 0.2, -0.2, 0.3, -0.4, 0.1))
            self.refuse(flux, words, data, VelocityArrayName=velocity)

    def test_sections(self):
        """Sections are added by methods, or come from the second input with their names, closed or not. A disc alone works, too."""
        flux = vtkSPHFlux()
        flux.AddRectangle(*self.WALL)
        flux.AddDisc("disc", (0, 0, 0.1), (0, 0, -3), 0.5)
        flux.AddBox("box", (-0.3, 0.2, -0.2, 0.3, -0.4, 0.1))
        flux.AddSurface("sides", made_by(vtkCubeSource(), XLength=0.6))
        plane = made_by(vtkPlaneSource(), Origin=(-0.2, -0.2, 0.1), Point1=(0.2, -0.2, 0.1), Point2=(-0.2, 0.2, 0.1),
                        Resolution=(3, 2))
        rows = self.measured(flux, timed(self.moving()), SectionsData=plane)
        self.assertEqual((len(rows[0]), rows[0]["time"]), (6, 0.75))
        for row, expected in zip(rows, (("wall", 0.42, 0.42), ("disc", 0.25 * math.pi, -0.75 * math.pi), ("box", 1.5, 0),
                                        ("sides", 4.4, 0), ("section", 0.16, 0.48)), strict=True):
            self.check_row(row, *expected)
        flux.ClearSections()
        low, high = self.measured(flux, SectionsData=named(plane, *["low"] * 3, *["high"] * 3))
        self.check_row(low, "low", 0.08, 0.24)
        self.check_row(high, "high", 0.08, 0.24)
        alone = vtkSPHFlux()
        row, = self.measured(alone, self.moving(), Radius=0.4)
        self.check_row(row, "section", 0.16 * math.pi, 0.16 * math.pi)
        table, told = run(alone, Origin=(1e6, 0, 0))
        self.assertEqual((len(told), self.rows(table)[0]["area"]), (1, 0))


class TestComponents(MeterTest):
    def measured(self, split, surface=None, particles=None, **settings):
        if particles is not None:
            split.SetParticlesData(particles)
        told = run(split, surface, **settings)[1]
        self.assertEqual(told, [])
        return self.rows(split.GetTable())

    def sphere(self, radius, x=0.0, y=0.0, inwards=False):
        """Makes a sphere. inwards: its triangles face inwards, as a cavity's do."""
        reverse = vtkReverseSense()
        reverse.SetInputData(made_by(vtkSphereSource(), Radius=radius, Center=(x, y, 0.0), ThetaResolution=60, PhiResolution=40,
                                     OutputPointsPrecision=1))
        return made_by(reverse, ReverseCells=inwards)

    def together(self, *parts):
        append = vtkAppendPolyData()
        for part in parts:
            append.AddInputData(part)
        return made_by(append, OutputPointsPrecision=1)

    def particles(self, *places, **arrays):
        """Makes particles of mass 2 whose velocities are twice their places."""
        places = numpy.array(places, float)
        return particles_of(places, Mass=numpy.full(len(places), 2.0), Velocity=2 * places, **arrays)

    def test_weird(self):
        split = vtkSPHComponents()
        self.assertEqual(self.measured(split, vtkPolyData(), vtkPolyData()), [])
        self.assertEqual((split.GetTable().GetNumberOfColumns(), split.GetOutput().GetNumberOfPoints()), (21, 0))
        self.assertEqual(len(run(vtkSPHComponents(), made_by(vtkPlaneSource()))[1]), 1)  # a quad

    def test_parents(self):
        """Checks pieces that contain each other: a shell with a cavity, in which a drop with a bubble flies; another ball; and an open
        ball."""
        opened = self.sphere(0.4, 0, 8)
        opened.GetPolys().ReplaceCellAtId(7, 3, [0, 0, 0])
        surface = self.together(self.sphere(0.5, 5), self.sphere(2), self.sphere(0.6, 0.1), self.sphere(0.3, 0.1, inwards=True),
                                self.sphere(1.5, inwards=True), opened)
        split = vtkSPHComponents()
        rows = self.measured(split, surface, self.particles(
            (0, 1.7, 0), (0, -1.7, 0.1), (0.1, 0.5, 0), (0.1, 0, 0), (0, 1.2, 0), (9, 9, 9), (5, 0, 0), (0, 8, 0)))
        for i, (row, (r, parent, held)) in enumerate(zip(rows, (
                (2, None, 2), (1.5, 0, None), (0.6, None, 1), (0.5, None, 1), (0.4, None, None), (0.3, 2, None)), strict=True)):
            closed, sign = r != 0.4, -1 if parent is not None else 1
            self.assertEqual((row["component"], row["closed"]), (i, closed))
            self.assertAlmostEqual(row["area"] / (4 * math.pi * r * r), 1, delta=0.01)
            self.assertEqual(row["parent"], -1 if parent is None else parent)
            for name, value in (("particles", held), ("mass", held and 2 * held)):
                self.assertTrue(math.isnan(row[name]) if value is None else row[name] == value, (i, name))
            if closed:
                self.assertAlmostEqual(row["volume"] / (sign * 4 / 3 * math.pi * r ** 3), 1, delta=0.01)
                self.assertAlmostEqual(row["diameter"] / (2 * r), 1, delta=0.005)
            else:
                self.assertTrue(math.isnan(row["volume"]))
        for i, name, value, delta in ((0, "vy", 0, 1e-12), (0, "vz", 0.1, 1e-12), (3, "vx", 10, 0), (3, "x", 5, 1e-9),
                                      (3, "xmax", 5.5, 0.01), (3, "zmin", -0.5, 0.01)):
            self.assertAlmostEqual(rows[i][name], value, delta=delta)
        # With LeastParticles = 2 the drop is left out together with its bubble, and so is the ball of one particle.
        rows = self.measured(split, LeastParticles=2)
        self.assertEqual([(row["component"], row["closed"]) for row in rows], [(0, 1), (1, 1), (2, 0)])
        rows = self.measured(split, LeastParticles=0, LeastVolume=4 / 3 * math.pi * 0.55 ** 3)
        ids = values_of(split.GetOutput(), "ComponentId")
        self.assertEqual((len(rows), len(ids), ids.max()), (4, split.GetOutput().GetNumberOfPoints(), 3))

    def test_fluid(self):
        """Walls that are detected do not count as a piece's particles. Blocks of particles are one set, and their names may mean walls."""
        surface, places = self.together(self.sphere(2), self.sphere(0.5, 5)), ((0, 1.7, 0), (0, -1, 0.1), (5, 0, 0))
        whole = self.particles(*places, ParticleType=numpy.array([0, 1, 0]))
        blocks = blocks_of(self.particles(places[0]), self.particles(places[2]), Walls=self.particles(places[1]))
        for data, cases in ((whole, (({"FluidArrayName": "(automatic)"}, [2, 1]), ({"DetectFluid": 1}, [1, 1]),
                                     ({"FluidArrayName": "ParticleType", "FluidValue": 1}, [1, 0]))),  # This is how a panel sets the array.
                            (blocks, (({}, [2, 1]), ({"DetectFluid": 1}, [1, 1])))):
            split = vtkSPHComponents()
            for settings, counts in cases:
                rows = self.measured(split, surface, data, **settings)
                self.assertEqual([row["particles"] for row in rows], counts)

    def test_against_vtk(self):
        """Compares the pieces of a noisy surface, one by one, with VTK's filters."""
        particles, extract, split = cube(), vtkMarchingCorrectors(), vtkSPHComponents()
        wave = numpy.sin(points_of(particles) * [7, 8, 6]).prod(axis=1)
        surface, _ = run(extract, cube(Wave=wave), InputArrayToProcess=(0, 0, 0, 0, "Wave"), Value=(0, 0.3), OutputPointsPrecision=1)
        rows, output = self.measured(split, surface, particles), split.GetOutput()
        of_point, of_cell = values_of(output, "ComponentId"), vtk_to_numpy(output.GetCellData().GetArray("ComponentId"))
        corners = vtk_to_numpy(output.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        self.assertEqual(len(corners), surface.GetNumberOfCells())
        self.assertTrue((of_point[corners] == of_cell[:, None]).all())
        volumes = vtk_to_numpy(output.GetCellData().GetArray("ComponentVolume"))
        self.assertTrue(numpy.array_equal(volumes, numpy.array([row["volume"] for row in rows])[of_cell], equal_nan=True))
        self.assertIsNotNone(output.GetPointData().GetNormals())
        connectivity = vtkPolyDataConnectivityFilter()
        connectivity.SetInputData(output)
        made_by(connectivity, ExtractionModeToAllRegions=())
        self.assertTrue(connectivity.GetNumberOfExtractedRegions() == len(rows) > 30)
        areas, closed = [row["area"] for row in rows], 0
        self.assertEqual(sorted(areas, reverse=True), areas)
        for i, row in enumerate(rows):
            piece = vtkPolyData()
            piece.SetPoints(output.GetPoints())
            piece.Allocate(1)
            for triangle in corners[of_cell == i]:
                piece.InsertNextCell(5, 3, triangle.tolist())
            masses = vtkMassProperties()
            masses.SetInputData(piece)
            masses.Update()
            self.assertAlmostEqual(row["area"] / masses.GetSurfaceArea(), 1, delta=1e-5)
            if row["closed"]:
                closed += 1
                self.assertAlmostEqual(abs(row["volume"]) / masses.GetVolume(), 1, delta=1e-5)
        self.assertGreater(closed, 10)

    def pieces_of(self, shift, wanted, period, **settings):
        """Makes particles at places that `wanted` chooses from a lattice of spacing 0.1 in the period 2, and moves them by `shift`. Returns
        the rows of their surface's pieces, and the places before the move."""
        way = numpy.remainder(lattice(20, 20, 20) + 1, 2) - 1
        chosen = way[wanted(way)]
        particles = self.particles(*(chosen + shift))
        surface, _ = run(vtkMarchingCorrectors(), particles, SmoothingLength=0.1, FreeSurface=1, CubeSize=0.05,
                         PeriodicBounds=period, **settings)
        return self.measured(vtkSPHComponents(), surface, particles, PeriodicBounds=period), chosen

    def test_sides(self):
        """The period may begin anywhere: the sides of the period, where the surface ends, need not be planes of the lattice."""
        def wanted(way):
            return (numpy.linalg.norm(way, axis=1) < 0.45) | (numpy.linalg.norm(way - 0.8, axis=1) < 0.3)

        first = None
        for begin in (0.0, -1.0, -0.33, 0.77, -7.12):
            period = (begin, begin + 2, begin + 0.1, begin + 2.1, begin, begin + 2)
            rows, _ = self.pieces_of([0.01, 0.02, 0.03], wanted, period)
            first = first or rows
            self.assertEqual([row["closed"] for row in rows], [1, 1])
            for row, expected in zip(rows, first):
                for name in ("area", "volume", "particles", "mass"):
                    self.assertAlmostEqual(row[name] / expected[name], 1, delta=1e-5)
                self.assertLess(row["xmax"] - row["xmin"], 1.3)
                for a, axis in enumerate("xyz"):
                    self.assertLess(abs(math.remainder(row[axis] - expected[axis], 2)), 1e-5)
                    self.assertTrue(period[2 * a] - 1e-3 < row[axis] < period[2 * a + 1] + 1e-3)

    def test_caps(self):
        """Caps end pieces at the sides of a periodic box. The pieces of a ball together hold as much as the ball, also if the ball lies
        outside the box."""
        def wanted(way):
            return numpy.linalg.norm(way, axis=1) < 0.65

        shift = [0.01, 0.02, 0.03]
        for begin, count in ((-1.0, 1), (1.0, 1), (0.22, 8), (-5.78, 8), (0.62, 4), (2.46, 7)):
            period = 3 * (begin, begin + 2)
            ball, = self.pieces_of(shift, wanted, period)[0]
            rows = self.pieces_of(shift, wanted, period, Capping=1)[0]
            self.assertEqual(len(rows), count)
            for name, delta in (("volume", 0.005), ("particles", 0), ("mass", 1e-12)):
                self.assertAlmostEqual(sum(row[name] for row in rows) / ball[name], 1, delta=delta)
            self.assertLess(sum(row["closed"] == 0 or row["volume"] <= 0 for row in rows), 1)
            for axis in "xyz":
                self.assertTrue(all(begin - 1e-3 < row[axis] < begin + 2 + 1e-3 for row in rows))
                momentum = sum(row["mass"] * row["v" + axis] for row in rows if row["mass"] > 0)
                self.assertAlmostEqual(momentum / ball["mass"], ball["v" + axis], delta=1e-9)

    def test_drops_in_bubbles(self):
        """A drop is in a bubble, and the bubble is in a ball or in an endless layer. Each piece has all its particles, wherever the sides
        of the period cut it."""
        for is_layer in (False, True):
            def wanted(way, is_layer=is_layer):
                r = numpy.linalg.norm(way, axis=1)
                return (r < 0.16) | ((r > 0.42) & (abs(way[:, 2]) < 0.75 if is_layer else r < 0.75))

            for shift in ((1, 1, 1), (0, 1, 1), (0.5, 0.1, 1), (0.4, 1.8, 1)):
                rows, way = self.pieces_of(shift, wanted, (0, 2, 0, 2, 0, 0 if is_layer else 2))
                dropped = (numpy.linalg.norm(way, axis=1) < 0.16).sum()
                bubble, = (row for row in rows if row["volume"] < 0)
                drop, = (row for row in rows if 0 < row["volume"] < 0.1)
                self.assertEqual((len(rows), drop["particles"]), (4 if is_layer else 3, dropped))
                self.assertEqual(math.isnan(rows[int(bubble["parent"])]["volume"]), is_layer)
                for row in rows:
                    if row["volume"] > 0.1:
                        self.assertEqual(row["particles"], len(way) - dropped)


if __name__ == "__main__":
    unittest.main()
