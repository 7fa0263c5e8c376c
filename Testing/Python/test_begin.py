# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Filters choose what nobody has set: places, resolutions, arrays and colours. If an input is missing, filters say so."""
import unittest

import numpy

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHComponents, vtkSPHDerivatives, vtkSPHGauge, vtkSPHResample
from vtk_test import SPACING, blocks_of, lattice, particles_of, points_of, run, values_of


def block(points=None, **arrays):
    """Returns particles with smoothing lengths, and a velocity whose curl is (0, 0, 2)."""
    x = lattice(20, 12, 8) if points is None else points
    h = numpy.full(len(x), 1.3 * SPACING)
    return particles_of(x, h=h, Velocity=numpy.stack((-x[:, 1], x[:, 0], 0 * x[:, 0]), 1), Height=x[:, 2] + 2, **arrays)


def active(data):
    scalars = data.GetPointData().GetScalars()
    return scalars.GetName() if scalars else None


class TestPlaces(unittest.TestCase):
    def test_far_particles(self):
        """A few particles far away do not change the bounds that filters fit to the fluid."""
        near = lattice(20, 12, 8)
        for far in ([], [[1e5, 0, 0]], [[0, 0, -3e4], [50, 60, 70]]):
            particles = block(numpy.concatenate([near, numpy.array(far).reshape(-1, 3)]))
            gauge = vtkSPHGauge()
            gauge.SetInputData(particles)
            self.assertTrue(numpy.allclose(gauge.GetNextBounds(), [0, 1.9, 0, 1.1, 0, 0.7]), gauge.GetNextBounds())
            cut, _ = run(vtkSPHResample(), particles, Resolution=100)
            self.assertLess(max(abs(b) for b in cut.GetBounds()), 2.1)
        # A splash is close to the fluid, so it counts in the bounds.
        gauge.SetInputData(block(numpy.concatenate([near, [[0, 0, 2.5]]])))
        self.assertAlmostEqual(gauge.GetNextBounds()[5], 2.5)

    def test_densest(self):
        """The default line of a gauge goes through the densest fluid: along x and y through the pool, along z through the
        tower in a corner, not through air or walls."""
        pool, tower = lattice(40, 40, 4), lattice(4, 4, 20) + [3.6, 0, 0]
        walls = numpy.concatenate([lattice(4, 4, 60)] * 9) + [0, 3.6, 0]
        points = numpy.concatenate([pool, tower, walls])
        gauge = vtkSPHGauge()
        gauge.SetFluidArrayName("Type")
        gauge.SetInputData(block(points, Type=(numpy.arange(len(points)) >= len(points) - len(walls)).astype(float)))
        places = numpy.reshape(gauge.GetNextDensest(), (3, 3))
        for axis, low, high in ((0, (0, 0, 0), (3.9, 3.9, 0.3)), (1, (0, 0, 0), (3.9, 3.9, 0.3)), (2, (3.6, 0, 0), (3.9, 0.3, 1.9))):
            across = [a for a in range(3) if a != axis]
            place, low, high = places[axis][across], numpy.array(low)[across], numpy.array(high)[across]
            self.assertTrue((place > low - 0.1).all() and (place < high + 0.1).all(), (axis, places))

    def test_plane(self):
        """For particles in a plane, a slice is this plane, and a volume has one layer of points."""
        for axis in range(3):
            points = numpy.insert(lattice(20, 12, 1)[:, :2], axis, 0.25, axis=1)
            for fit in (0, 1):
                cut, told = run(vtkSPHResample(), block(points), Resolution=60, FitBounds=fit)
                self.assertEqual(told, [])
                self.assertGreater(cut.GetNumberOfCells(), 500)
                self.assertEqual(set(points_of(cut)[:, axis]), {0.25})
            surface = vtkMarchingCorrectors()
            surface.SetInputData(block(points))
            self.assertEqual(surface.GetNextDimension(), 2)
            image, _ = run(vtkSPHResample(), block(points), Shape=2)
            self.assertEqual(image.GetDimensions()[axis], 1)
            self.assertGreater(values_of(image, "vtkValidPointMask").mean(), 0.5)

    def test_resolution_follows_the_shape(self):
        image, _ = run(vtkSPHResample(), block(), Shape=2)
        spacing = numpy.array(image.GetSpacing())
        self.assertLess(spacing.max() / spacing.min(), 1.03)
        self.assertTrue(0.8e6 < image.GetNumberOfPoints() < 1.3e6, image.GetDimensions())
        image, _ = run(vtkSPHResample(), block(), Shape=2, Dimensions=(10, 0, 0))
        self.assertEqual(image.GetDimensions()[0], 10)


class TestColours(unittest.TestCase):
    def test_not_what_is_contoured(self):
        """On an isosurface of the speed, the speed shows only noise, even as an array of its own, so another array gives the colours."""
        particles = block()
        speed = numpy.linalg.norm(values_of(particles, "Velocity"), axis=1)
        particles = block(Speed=speed)
        surface = vtkMarchingCorrectors()
        surface.SetInputArrayToProcess(0, 0, 0, 0, "Velocity")
        one, _ = run(surface, particles, Value=(0, 1.0))
        self.assertEqual(active(one), "Height")
        several, _ = run(surface, particles, Value=(1, 1.5))
        self.assertEqual(active(several), "Velocity")
        component, _ = run(surface, particles, NumberOfContours=1, ScalarComponent=0, Value=(0, -0.5))
        self.assertEqual(active(component), "Velocity")

    def test_vorticity(self):
        derived, _ = run(vtkSPHDerivatives(), block())
        self.assertEqual(active(derived), "Vorticity")

    def test_pieces(self):
        surface, _ = run(vtkMarchingCorrectors(), block(), FreeSurface=1)
        particles = block()
        for inputs in ((surface, particles), (particles, surface)):  # The inputs are given in both orders.
            pieces = vtkSPHComponents()
            pieces.SetInputData(1, inputs[1])
            found, told = run(pieces, inputs[0])
            # There is only one piece, so colours by the piece's number would all be alike.
            self.assertEqual((told, active(found)), ([], "Velocity"))
            self.assertEqual(pieces.GetTable().GetColumnByName("particles").GetValue(0), 1912)


    def ranges(self, filter_):
        lines = [line.split(" ", 2) for line in filter_.GetColorRanges().splitlines()]
        return {name: (float(low), float(high)) for low, high, name in lines}

    def test_ranges(self):
        """The ranges of colours are not widened by a hot drop, a sharp edge, or walls."""
        water, drop = lattice(20, 20, 20), lattice(2, 2, 2) + [0, 0, 5]
        heat = numpy.concatenate([water[:, 0], numpy.linspace(400, 600, 8)])
        particles = block(numpy.concatenate([water, drop]), Heat=heat)
        surface = vtkMarchingCorrectors()
        self.assertEqual(surface.GetColorRanges(), "")
        output, _ = run(surface, particles, FreeSurface=1, ComputeCurvature=1)
        self.assertGreater(values_of(output, "Heat").max(), 400)
        found = self.ranges(surface)
        low, high = found["Heat"]
        self.assertTrue(-0.01 < low < 0.1 and 1.8 < high < 2, found)
        curvature = values_of(output, "MeanCurvature")
        self.assertLess(found["MeanCurvature"][1] - found["MeanCurvature"][0], 0.8 * (curvature.max() - curvature.min()))
        several = vtkMarchingCorrectors()
        several.SetInputArrayToProcess(0, 0, 0, 0, "Heat")
        for i, value in enumerate((0.5, 1.5, 500)):
            several.SetValue(i, value)
        run(several, particles, FreeSurface=0)
        self.assertEqual(self.ranges(several)["Heat"], (0.5, 500))
        volume = vtkSPHResample()
        self.assertEqual(volume.GetColorRanges(), "")
        run(volume, block(water), Shape=2, Dimensions=(9, 9, 9))
        self.assertIn("Height", self.ranges(volume))
        walls = (water[:, 2] < 0.25).astype(float)
        derive = vtkSPHDerivatives()
        run(derive, block(water, Type=walls), FluidArrayName="Type")
        # The vorticity is 0 at walls, and 2 in all of the fluid.
        self.assertTrue(numpy.allclose(self.ranges(derive)["Vorticity"], 2, atol=1e-3), self.ranges(derive)["Vorticity"])


class TestForgotten(unittest.TestCase):
    def test_pieces(self):
        """If the surface is missing, one message tells of it; if the particles' input is missing, none does."""
        surface, _ = run(vtkMarchingCorrectors(), block(), FreeSurface=1)
        pieces = vtkSPHComponents()
        _, told = run(pieces, surface)
        table = pieces.GetTable()
        names = [table.GetColumnName(i) for i in range(table.GetNumberOfColumns())]
        self.assertEqual((told, names[-1], table.GetNumberOfRows()), ([], "diameter", 1))
        lost = vtkMarchingCorrectors()
        _, told = run(lost, block(), FreeSurface=1, Device="no such device")
        self.assertEqual((len(told), lost.GetMessageCount()), (1, 1))
        run(lost, block(), Device="")
        self.assertEqual(lost.GetMessageCount(), 0)
        _, told = run(vtkSPHComponents(), block())
        self.assertEqual(len(told), 1)
        self.assertRegex(told[0], "SPH Contour")

    def test_smoothing_length(self):
        """The message about a missing smoothing length names the remedy in the words of the panel."""
        bare = particles_of(lattice(10, 10, 10))
        surface = vtkMarchingCorrectors()
        _, told = run(surface, bare, FreeSurface=1)
        self.assertRegex(told[0], "no smoothing length: .*Estimate Smoothing Length finds one")
        self.assertEqual(surface.GetNextEstimate(), 1)
        surface.SetInputData(block())
        self.assertEqual(surface.GetNextEstimate(), 0)


class TestChoices(unittest.TestCase):
    def test_blocks_are_fluid(self):
        """A block that is chosen by its name is the fluid, and the particles of other blocks are not."""
        x = lattice(20, 12, 8)
        wall = x[:, 2] < 0.25
        blocks = blocks_of(water=block(x[~wall]), bed=block(x[wall]))
        surface = vtkMarchingCorrectors()
        surface.SetInputData(blocks)
        self.assertEqual(surface.GetNextBlocks().split(), ["Block:", "water", "Block:", "bed"])
        counts = []
        for choice in ("", "Block: water", "Block: bed", "Block: water"):
            _, told = run(surface, None, FreeSurface=1, FluidArrayName=choice)
            self.assertEqual(told, [])
            counts.append(surface.GetRunStatistics().GetArray("FluidParticles").GetValue(0))
        self.assertEqual(counts, [1920, (~wall).sum(), wall.sum(), (~wall).sum()])
        gauge, _ = run(vtkSPHGauge(), blocks, FluidArrayName="Block: water", Point1=(1, 0.5, -1), Point2=(1, 0.5, 2))
        self.assertTrue(abs(gauge.GetColumnByName("depth").GetValue(0) - 0.5) < 0.1)

    def test_velocity_of_three_arrays(self):
        particles = block()
        velocity = values_of(particles, "Velocity")
        apart = particles_of(lattice(20, 12, 8), h=numpy.full(1920, 0.13), rho=numpy.arange(1920.0),
                             **{name: velocity[:, a].copy() for a, name in enumerate(("vx", "vy", "vz"))})
        surface = vtkMarchingCorrectors()
        surface.SetInputData(apart)
        self.assertEqual((surface.GetNextArray(), surface.GetNextComponents(), surface.GetNextDimension()), ("Velocity", 3, 3))
        derived, told = run(vtkSPHDerivatives(), apart)
        self.assertEqual(told, [])
        self.assertTrue(numpy.allclose(values_of(derived, "Vorticity"), [0, 0, 2], atol=1e-4))


if __name__ == "__main__":
    unittest.main()
