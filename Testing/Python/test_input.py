# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests input of all kinds. Odd input comes first: it gives an empty output and one message, and the filter works again afterwards. Then come arrays
and point sets of any kind, and what the filter finds if nothing is named."""
import math
import unittest

import numpy
from vtkmodules.vtkCommonCore import vtkBitArray, vtkFloatArray, vtkPoints, vtkSOADataArrayTemplate, vtkStringArray, vtkVariantArray
from vtkmodules.vtkCommonDataModel import (
    VTK_HEXAHEDRON, VTK_VERTEX, vtkCellArray, vtkDataObject, vtkPolyData, vtkStructuredGrid, vtkUnstructuredGrid)

from marchingcorrectors import vtkMarchingCorrectors
from vtk_test import (
    COUNT, H, POINTS, SPACING, add, blocks_of, cube, lattice, particles_of, points_of, run, says, sphere, statistics_of, surface_of,
    take_step, values_of)

ONES = numpy.ones((COUNT, 3))
BARE = {"InterpolateAttributes": 0, "ComputeScalars": 0}


def bare(data=None, *scalar, **settings):
    """Returns the points and triangles of a surface without interpolated arrays, to compare inputs."""
    extract = sphere(data, *scalar)
    surface, told = run(extract, **BARE, **settings)
    assert told == [] and surface.GetNumberOfCells() > 100, told
    return surface_of(surface)


class TestWeird(unittest.TestCase):
    def test_refused(self):
        text, short = vtkStringArray(), vtkFloatArray()
        text.SetNumberOfTuples(COUNT)
        short.InsertNextValue(1)

        def changed(name, i, value):
            data = cube()
            data.GetPointData().GetArray(name).SetComponent(i, 0, value)
            return data

        def without(*names):
            data = cube()
            for name in names:
                data.GetPointData().RemoveArray(name)
            return data

        moved = cube()
        moved.GetPoints().SetPoint(20, 0, math.nan, 0)
        scalar = {name: {"InputArrayToProcess": (0, 0, 0, POINTS, name)} for name in ("NoSuch", "Text", "Short", "Vector", "")}
        cells = (0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "NoSuch")
        for sentence, data, settings in (
                (says("NO_SCALAR", "Volume"), without("Radius"), scalar[""]),  # No other array varies.
                (says("NO_SUCH_ARRAY", "'NoSuch'", "scalar", "Radius"), cube(), scalar["NoSuch"]),
                (says("SCALAR_NOT_ON_POINTS", "'NoSuch'"), cube(), {"InputArrayToProcess": cells}),
                (says("ARRAY_WITHOUT_NUMBERS", "'Text'"), cube(Text=text), scalar["Text"]),
                (says("ARRAY_TOO_SHORT", "'Short'", "9261"), cube(Short=short), scalar["Short"]),
                (says("NO_SUCH_COMPONENT", "'Vector'", "7"), cube(Vector=ONES), {**scalar["Vector"], "ScalarComponent": 7}),
                (says("DOT_OF_DIFFERENT_VECTORS", "'Vector'"), cube(Vector=ONES), {"InputArrayToProcess": (1, 0, 0, POINTS, "Vector")}),
                (says("ARRAY_OF_VECTORS", "'Pair'", "2"), cube(Pair=ONES[:, :2]), {"FluidArrayName": "Pair"}),
                (says("NO_SMOOTHING_LENGTH", "'Spacing', .* 0.1 apart: 0.13 is"), cube(Spacing=numpy.full(COUNT, 0.1)), {"DetectArrays": 0}),
                *((says("NO_SUCH_ARRAY", "'NoSuch'", role), cube(), {name + "ArrayName": "NoSuch"}) for name, role in (
                    ("SmoothingLength", "smoothing length"), ("Volume", "volume"), ("Mass", "mass"), ("Density", "density"),
                    ("Fluid", "fluid"))),
                # Messages of the core reach the user; core_input tests more of them.
                (says("ARRAY_VALUE", "SmoothingLength", "17"), changed("SmoothingLength", 17, math.nan), {}),
                (says("POSITION_NOT_FINITE", "20") + "|" + says("ARRAY_VALUE", "20"), moved, {}),
                (says("BLOCKS_TOO_MANY"), cube(), {"CubeSize": 1e-4}), (says("NO_SUCH_DEVICE", "NoSuchDevice"), cube(), {"Device": "NoSuchDevice"})):
            with self.subTest(sentence):
                extract = sphere(data)
                surface, told = run(extract, **settings)
                self.assertEqual((surface.GetNumberOfPoints(), surface.GetNumberOfCells()), (0, 0))
                self.assertIn(extract.GetErrorMessage(), told[-1])  # The last sentence is the error; for such small cubes a warning comes before it.
                self.assertRegex(extract.GetErrorMessage(), sentence)
                self.assertNotIn("\n", extract.GetErrorMessage())

    def test_legal(self):
        """No particles, a single particle, two particles at one place, and an iso value without a surface are no errors."""
        empty, one = vtkPolyData(), particles_of([[1.0, 2.0, 3.0]])
        nothing = particles_of(numpy.empty((0, 3)))
        single = {"SmoothingLength": 0.1, "FreeSurface": 1}
        for data, settings, there in ((empty, {}, False), (nothing, {"FreeSurface": 1}, False), (one, single, True),
                                      (particles_of([[1.0, 2.0, 3.0]] * 2), single, None)):
            extract = sphere(data)
            surface, _ = run(extract, **settings)
            self.assertEqual(extract.GetErrorMessage(), "")
            self.assertIn(surface.GetNumberOfPoints() > 0, (there, there is None or there))

        def leave_none(extract):
            extract.SetWithin(9, 10, 9, 10, 9, 10)
            extract.AddOnly("Radius", 7, 8)

        for step, sentence in (({"Value": (0, 99)}, says("ISO_OUTSIDE", "99")),
                               ({"FluidArrayName": "Radius", "FluidValue": -5}, says("NOTHING_WITHOUT_FLUID", "Radius = -5")),
                               (leave_none, says("NOTHING_WITHOUT_FLUID", "9,10,9,10,9,10 and left by Radius=7:8"))):
            extract = sphere()
            take_step(step, extract)
            surface, told = run(extract)
            self.assertEqual((surface.GetNumberOfPoints(), len(told), extract.GetErrorMessage()), (0, 1, ""))
            self.assertRegex(told[0], sentence)

    def test_recovery(self):
        extract = sphere()
        run(extract, HScaleFactor=-1)
        self.assertNotEqual(extract.GetErrorMessage(), "")
        surface, told = run(extract, HScaleFactor=1)
        self.assertEqual((told, extract.GetErrorMessage()), ([], ""))
        self.assertGreater(surface.GetNumberOfCells(), 100)


class TestKinds(unittest.TestCase):
    def apart(self, kind, values):
        """Returns an array that stores each component separately."""
        array = vtkSOADataArrayTemplate[kind]()
        array.SetNumberOfComponents(values.shape[1])
        array.SetNumberOfTuples(len(values))
        for (i, c), value in numpy.ndenumerate(values):
            array.SetComponent(i, c, value)
        return array

    def test_scalars(self):
        """Arrays of all types give the same surface. The values are whole numbers, which every type can hold."""
        values = numpy.floor(100 * values_of(cube(), "Radius"))
        expected = bare(cube(Count=values), "Count", 60.5)
        for kind in ("f4", "i4", "i2", "i8", "u1"):
            self.assertTrue(bare(cube(Count=values.astype(kind)), "Count", 60.5) == expected, kind)
        for kind in ("float32", "float64"):
            self.assertTrue(bare(cube(Count=self.apart(kind, values[:, None])), "Count", 60.5) == expected, kind)

    def test_vectors(self):
        """Magnitude, one component and the dot product of two arrays give the same as an array that was computed beforehand."""
        x = points_of(cube())
        data = cube(Vector=x, Apart=self.apart("float64", x), Third=x[:, 2], Square=(x ** 2).sum(axis=1))
        self.assertTrue(bare(data, "Vector") == bare(data, "Apart"))
        self.assertTrue(bare(data, "Vector", 0.03, ScalarComponent=2) == bare(data, "Third", 0.03))
        dot = bare(data, "Vector", 0.36, InputArrayToProcess=(1, 0, 0, POINTS, "Apart"))
        self.assertEqual(*(len(each["corners"]) for each in (dot, bare(data, "Square", 0.36))))
        named = sphere(data, "Vector", 0.1)
        self.assertTrue(run(named, ScalarComponent=1)[0].GetPointData().HasArray("Vector_Y"))

    def test_rare_arrays(self):
        """Arrays of rare types work as scalar, and are carried to the surface. One array may have several roles. Arrays without values or
        name do no harm."""
        data, bits, variants, none = cube(), vtkBitArray(), vtkVariantArray(), vtkFloatArray()
        inside = (values_of(data, "Radius") < 0.6).astype(numpy.uint8)
        for i, value in enumerate(inside):
            bits.InsertNextValue(value)
            variants.InsertNextValue(i)
        add(data, Byte=inside, Bit=bits, Variant=variants, hsml=none)
        data.GetPointData().AddArray(vtkFloatArray())
        data.GetPoints().GetData().SetName("Position")
        data.GetPointData().AddArray(data.GetPoints().GetData())  # This is the points' own array.
        self.assertEqual(*(bare(data, name, 0.5)["points"] for name in ("Byte", "Bit")))
        surface, _ = run(sphere(data))
        arrays, count = surface.GetPointData(), surface.GetNumberOfPoints()
        self.assertTrue(arrays.HasArray("Position") and not arrays.HasArray("hsml"))
        self.assertIsNot(arrays.GetArray("Position"), surface.GetPoints().GetData())
        found = [int(arrays.GetArray("Bit").GetValue(i)) for i in range(count)]
        self.assertEqual(found, values_of(surface, "Byte").tolist())
        self.assertEqual(found, [inside[arrays.GetAbstractArray("Variant").GetValue(i).ToInt()] for i in range(count)])
        self.assertEqual({arrays.GetAbstractArray(i).GetNumberOfTuples() for i in range(arrays.GetNumberOfArrays())}, {count})
        shared = sphere(cube(), "SmoothingLength", H / 2)
        surface, _ = run(shared, FluidArrayName="SmoothingLength", FluidValue=H, MassArrayName="SmoothingLength")
        self.assertEqual((shared.GetErrorMessage(), surface.GetNumberOfPoints()), ("", 0))  # The field is nowhere half the smoothing length.

    def test_points(self):
        """Coordinates may be of an integer type. By default the surface's points have the type of the particles' points."""
        whole, surfaces = vtkPoints(), []
        whole.SetDataTypeToInt()
        for place in numpy.rint(lattice(10, 10, 10) / SPACING):
            whole.InsertNextPoint(place)
        for points in (whole, particles_of(numpy.rint(lattice(10, 10, 10) / SPACING)).GetPoints()):
            data = vtkPolyData()
            data.SetPoints(points)
            surfaces.append(surface_of(run(vtkMarchingCorrectors(), data, SmoothingLength=1.3, FreeSurface=1,
                                           OutputPointsPrecision=1)[0]))
        self.assertTrue(surfaces[0] == surfaces[1] and len(surfaces[0]["points"]) > 0)
        for kind in (numpy.float32, numpy.float64):
            extract = sphere(cube(kind))
            types = [points_of(run(extract, OutputPointsPrecision=precision)[0]).dtype for precision in (2, 1, 0)]
            self.assertEqual(types, [kind, numpy.float64, numpy.float32])

    def test_point_sets(self):
        data = cube()
        expected, sets = bare(data), [vtkUnstructuredGrid(), vtkStructuredGrid(), vtkPolyData()]
        for each in sets:
            each.SetPoints(data.GetPoints())
            each.GetPointData().ShallowCopy(data.GetPointData())
        sets[1].SetDimensions(21, 21, 21)
        vertices = vtkCellArray()
        for i in range(COUNT):
            vertices.InsertNextCell(1, [i])
        sets[2].SetVerts(vertices)
        for each in sets:
            self.assertTrue(bare(each) == expected, each.GetClassName())
        apart, _ = run(sphere(blocks_of(data, sets[0])), BlocksToApart=(), **BARE)
        self.assertTrue(all(surface_of(apart.GetBlock(i)) == expected for i in range(2)))

    def make_mesh(self, particles, arrays):
        """Makes hexahedra with points of their own. If there are particles, a vertex cell for each of them follows. The particles' arrays
        are arrays of cells or of points, as `arrays` ("cells" or "points") says."""
        places = numpy.array([(i & 1, i >> 1 & 1, i >> 2) for i in (0, 1, 3, 2, 4, 5, 7, 6)], float)
        grid, count = vtkUnstructuredGrid(), COUNT if particles else 0
        grid.SetPoints(particles_of(numpy.concatenate([places, points_of(particles)] if particles else [places])).GetPoints())
        for _ in range(2):
            grid.InsertNextCell(VTK_HEXAHEDRON, 8, list(range(8)))
        for i in range(count):
            grid.InsertNextCell(VTK_VERTEX, 1, [8 + i])
        nodes = numpy.full(2 if arrays == "cells" else 8, -1.0)  # No smoothing length may be -1.
        of_all = add(vtkPolyData(), **{name: numpy.concatenate([nodes, values_of(particles, name)])
                                       for name in (("Radius", "SmoothingLength") if particles else ())}).GetPointData()
        (grid.GetCellData() if arrays == "cells" else grid.GetPointData()).ShallowCopy(of_all)
        return grid

    def test_particles_among_meshes(self):
        """If there are vertices beside other cells, the vertices' points are the particles, even if only one of the blocks has vertices."""
        particles, mesh = cube(), self.make_mesh(None, "points")
        particles.GetPointData().RemoveArray("Volume")
        expected = run(sphere(particles))[0].GetNumberOfCells()
        for arrays in ("points", "cells"):
            grid = self.make_mesh(particles, arrays)
            for data in (grid, blocks_of(mesh, grid)):
                extract = sphere(data)
                if arrays == "cells":
                    extract.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_CELLS, "Radius")
                surface, told = run(extract)
                self.assertEqual((extract.GetErrorMessage(), len(told), surface.GetNumberOfCells()), ("", 1, expected))
                self.assertAlmostEqual(values_of(surface, "SmoothingLength")[0], H)
        alone = vtkMarchingCorrectors()  # Without any vertex, all points are particles.
        self.assertGreater(run(alone, mesh, EstimateSmoothingLength=1, FreeSurface=1)[0].GetNumberOfCells(), 0)

    def test_untouched(self):
        data, before = cube(), vtkPolyData()
        before.DeepCopy(data)
        time = data.GetMTime()
        bare(data)
        self.assertEqual(data.GetMTime(), time)
        self.assertTrue(surface_of(before) == surface_of(data))


class TestFound(unittest.TestCase):
    """Tests that settings reach the core. core_find tests what the core finds, and wheel.both compares the
    interfaces."""

    def test_named(self):
        """Fluid that is detected gives the same surface as fluid that is named. A named array has precedence."""
        particles = cube(ParticleType=(points_of(cube())[:, 2] < -0.45).astype(numpy.int32))
        named, found = sphere(particles), sphere(particles)
        surfaces = [surface_of(run(named, FluidArrayName="ParticleType")[0]),
                    surface_of(run(found, DetectFluid=1, FluidArrayName="(automatic)")[0])]  # This is the text of ParaView's panel.
        self.assertTrue(surfaces[0] == surfaces[1])
        self.assertEqual(statistics_of(named), statistics_of(found))
        self.assertEqual((found.GetUsedFluid(), found.GetNextFluid()), ("ParticleType = 0",) * 2)
        run(named, FluidValue=1, DetectFluid=1)
        self.assertEqual(named.GetUsedFluid(), "ParticleType = 1")

    def test_scalar(self):
        """The active array is contoured if it fits. An array that equals the iso value everywhere does not become
        active on the surface."""
        data, x = cube(Idp=numpy.arange(COUNT), Height=points_of(cube())[:, 2]), points_of(cube())
        data.GetPointData().RemoveArray("Radius")
        extract = vtkMarchingCorrectors()
        extract.SetInputData(data)
        for wanted, array, more, active in (("Idp", "Height", {}, ""), ("Idp", "velocity", {"velocity": x[:, ::-1]}, "Height"), ("Height", "velocity", {}, "velocity")):
            add(data, **more)
            data.GetPointData().SetActiveScalars(wanted)
            data.Modified()
            self.assertEqual(extract.GetNextArray(), array)
            surface, _ = run(extract)
            scalars = surface.GetPointData().GetScalars()
            self.assertEqual((surface.GetNumberOfCells() > 0, scalars.GetName() if scalars else ""), (True, active))
        self.assertEqual(len(set(values_of(surface, "Height"))), 1)

    def test_before_there_is_a_smoothing_length(self):
        data = cube(Velocity=points_of(cube()))
        data.GetPointData().RemoveArray("SmoothingLength")
        extract = sphere(data, "Velocity")
        extract.SetScalarComponent(1)
        low, high = extract.GetNextScalarRange()
        self.assertTrue(low < -0.9 and high > 0.9 and abs(extract.GetNextIsoValue()) < 0.1)
        self.assertEqual(extract.GetNextCells(), 0)


if __name__ == "__main__":
    unittest.main()
