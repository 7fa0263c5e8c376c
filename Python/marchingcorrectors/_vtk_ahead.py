# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What an update of the VTK filter would find, without it."""
from vtkmodules.vtkCommonCore import vtkTimeStamp
from vtkmodules.vtkCommonDataModel import vtkDataObjectTree, vtkPointSet

from ._vtk_particles import Particles, Request, Unusable
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

    def GetNextScalarRange(self):
        return self._look_ahead()[0]

    def GetNextCells(self):
        return self._look_ahead()[1]

    def _look_ahead(self):
        data = self.GetInputDataObject(0, 0) if self.GetNumberOfInputConnections(0) else None
        if data is not None and max(self.GetMTime(), data.GetMTime()) < self._look_time.GetMTime():
            return self._ahead
        limits, cells = [], 0.0
        for points in list_point_sets(data):
            for free_surface in (self.FreeSurface, True):  # without a scalar the number of cells is known all the same
                choice = self._choice()
                choice.FreeSurface, choice.InterpolateAttributes = free_surface, False
                particles = Particles(choice, points)
                try:
                    particles.collect((Request(self, 0, points), Request(self, 1, points)), [])
                except Unusable:
                    continue
                values = [] if free_surface else particles.fluid_values()
                limits += [float(values.min()), float(values.max())] if len(values) else []
                cells += estimate_cells(particles, self._options(choice))
                break
        self._ahead = ((min(limits), max(limits)) if limits else (0.0, 0.0)), cells
        self._look_time.Modified()
        return self._ahead
