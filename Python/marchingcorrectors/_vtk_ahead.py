# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What an update of the VTK filter would find, without it."""
import ctypes

from vtkmodules.vtkCommonCore import vtkTimeStamp
from vtkmodules.vtkCommonDataModel import vtkDataObjectTree, vtkPointSet

from ._library import lib
from ._vtk_particles import Particles, Request, Unusable, choose_array, join_velocity, name_of
from ._vtk_summary import estimate_cells


def list_point_sets(data):
    """The data set itself, or the blocks, that are point sets with points."""
    found = [data]
    if isinstance(data, vtkDataObjectTree):
        iterator = data.NewTreeIterator()
        iterator.InitTraversal()
        while not iterator.IsDoneWithTraversal():
            found.append(iterator.GetCurrentDataObject())
            iterator.GoToNextItem()
    return [each for each in found if isinstance(each, vtkPointSet) and each.GetNumberOfPoints() > 0]


class Ahead:
    """With the properties and the input as they are now: the part of the filter that looks ahead."""

    def forget_ahead(self):
        self._ahead, self._look_time = None, vtkTimeStamp()

    def _look_ahead(self):
        data = self.GetInputDataObject(0, 0) if self.GetNumberOfInputConnections(0) else None
        if data is not None and max(self.GetMTime(), data.GetMTime()) < self._look_time.GetMTime():
            return self._ahead
        ahead = self._ahead = {"ScalarRange": (0.0, 0.0), "IsoValue": float("nan"), "Components": 0, "Cells": 0.0,
                               "Dimension": 0, "Fluid": "", "Array": ""}
        for points in list_point_sets(self._take_particles(data)):
            self._look_at(points, ahead)
        self._look_time.Modified()
        return self._ahead

    def _look_at(self, points, ahead):
        """What is known does not wait for the rest: the range needs no smoothing length, the cells no scalar."""
        joined = join_velocity(points.GetPointData(), points.GetNumberOfPoints())
        fittest = choose_array(points.GetPointData()) if joined is None else joined
        ahead["Array"] = ahead["Array"] or name_of(fittest)
        choice = self._choice()
        choice.InterpolateAttributes = False
        particles = Particles(choice, points)
        try:
            particles.collect_solids()
            ahead["Fluid"] = particles.describe_fluid()
            found = None
            if not choice.FreeSurface:
                particles.collect_scalar(Request(self, 0, points), Request(self, 1, points))
                found = particles.find_iso_value()
            if found:
                before = [ahead["ScalarRange"]] if ahead["IsoValue"] == ahead["IsoValue"] else []
                ranges = [*before, found[0]]
                ahead["ScalarRange"] = min(low for low, _ in ranges), max(high for _, high in ranges)
                ahead["IsoValue"] = ahead["IsoValue"] if before else found[1]
                ahead["Components"] = 1 if particles.dot is not None else particles.scalar.GetNumberOfComponents()
        except Unusable:
            pass
        choice = self._choice()
        choice.FreeSurface, choice.InterpolateAttributes = True, False
        particles = Particles(choice, points)
        try:
            particles.collect((None, None), [])
            given = particles.arguments()
            ahead["Dimension"] = lib.mcor_find_dimension(ctypes.byref(given.input), None, choice.Dimension)
            ahead["Cells"] += estimate_cells(given, self._options(choice))
        except Unusable:
            pass
