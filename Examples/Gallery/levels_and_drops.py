#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the picture of the guide's page on numbers: a wave gauge over time, drops by their volume.

levels_and_drops.py DIRECTORY      (without a display: Testing/with-display.sh python3 levels_and_drops.py ...)

PYTHONPATH must name the directory of the package marchingcorrectors. Writes DIRECTORY/numbers.png.
"""
import math
import os
import sys

import numpy as np
import vtkmodules.vtkRenderingContextOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkChartsCore import vtkAxis, vtkChart, vtkChartXY
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkTable
from vtkmodules.vtkRenderingContext2D import vtkContextActor
from vtkmodules.vtkRenderingCore import vtkActor

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
# pylint: disable=wrong-import-position
from marchingcorrectors import vtkMarchingCorrectors, vtkSPHComponents, vtkSPHGauge  # noqa: E402
from pictures import mesh_actor, panel, poly_data, read, save  # noqa: E402

SPACING, DEPTH, LENGTH, HEIGHT = 0.02, 0.4, 1.0, 0.03  # m, of a tank with a standing wave
WAVE = math.pi / LENGTH
PERIOD = 2 * math.pi / math.sqrt(9.81 * WAVE * math.tanh(WAVE * DEPTH))


def tank(time):
    """A lattice of particles, moved as the linear theory of a standing wave moves water."""
    axes = [np.arange(SPACING / 2, extent, SPACING) for extent in (LENGTH, 0.2, DEPTH)]
    x, y, z = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3).T
    amplitude = HEIGHT * math.cos(2 * math.pi * time / PERIOD) / math.sinh(WAVE * DEPTH)
    return poly_data(np.stack([x - amplitude * np.sin(WAVE * x) * np.cosh(WAVE * z), y,
                               z + amplitude * np.cos(WAVE * x) * np.sinh(WAVE * z)], -1), Volume=np.full(len(x), SPACING ** 3))


def levels(times):
    """At the tank's end, over time: the gauge's, the theory's, and the highest particle's nearby."""
    gauge = vtkSPHGauge()
    gauge.AddGauge("end", 0.05, 0.1, 0, 0.05, 0.1, 0.6)
    gauge.SetSmoothingLength(1.3 * SPACING)
    rows = []
    for time in times:
        particles = tank(time)
        gauge.SetInputData(particles)
        gauge.Update()
        places = vtk_to_numpy(particles.GetPoints().GetData())
        near = np.hypot(places[:, 0] - 0.05, places[:, 1] - 0.1) < 1.5 * SPACING
        theory = DEPTH + HEIGHT * math.cos(2 * math.pi * time / PERIOD) * math.cos(WAVE * 0.05)
        rows.append((time, gauge.GetOutput().GetValueByName(0, "z").ToDouble(), theory, places[near, 2].max()))
    return np.array(rows)


def table_of(names, columns):
    table = vtkTable()
    for name, column in zip(names, columns):
        array = numpy_to_vtk(np.ascontiguousarray(column), deep=True)
        array.SetName(name)
        table.AddColumn(array)
    return table


def set_axes(chart, bottom, left):
    for number, title in ((vtkAxis.BOTTOM, bottom), (vtkAxis.LEFT, left)):
        axis = chart.GetAxis(number)
        axis.SetTitle(title)
        axis.GetTitleProperties().SetFontSize(18)
        axis.GetLabelProperties().SetFontSize(15)
        axis.SetLabelOffset(10)


def level_chart(rows):
    chart = vtkChartXY()
    table = table_of(("time", "gauge", "linear theory", "highest particle"), rows.T)
    for column, color, kind, width in ((3, (170, 170, 170), vtkChart.POINTS, 1), (2, (240, 140, 60), vtkChart.LINE, 2),
                                       (1, (20, 80, 160), vtkChart.POINTS, 1)):
        plot = chart.AddPlot(kind)
        plot.SetInputData(table, 0, column)
        plot.SetColor(*color, 255)
        plot.SetWidth(width)
        if kind == vtkChart.POINTS:
            plot.SetMarkerStyle(4)
            plot.SetMarkerSize(8)
    chart.SetShowLegend(True)
    chart.GetAxis(vtkAxis.LEFT).SetBehavior(vtkAxis.FIXED)
    chart.GetAxis(vtkAxis.LEFT).SetRange(0.35, 0.46)  # the legend lies above the data
    chart.GetLegend().GetLabelProperties().SetFontSize(15)
    set_axes(chart, "time in s", "level in m, x = 0.05")
    return chart


def pieces_of_dam_break():
    reader = read()
    surface = vtkMarchingCorrectors()
    surface.SetInputConnection(reader.GetOutputPort())
    surface.SetFluidArrayName("ParticleType")
    surface.FreeSurfaceOn()
    pieces = vtkSPHComponents()
    pieces.SetInputConnection(surface.GetOutputPort())
    pieces.SetParticlesConnection(reader.GetOutputPort())
    pieces.SetFluidArrayName("ParticleType")
    pieces.Update()
    return pieces


def drops_of(table):
    """Volumes, in cm^3, of all closed pieces, 0 for others."""
    volume = vtk_to_numpy(table.GetColumnByName("volume"))
    return np.where(volume > 0, volume * 1e6, 0)


def colored_by_volume(pieces):
    mesh = vtkPolyData()
    mesh.ShallowCopy(pieces.GetOutput())
    volumes = drops_of(pieces.GetTable())
    of_cell = volumes[vtk_to_numpy(mesh.GetCellData().GetArray("ComponentId"))]
    array = numpy_to_vtk(np.log10(np.maximum(of_cell, 1)), deep=True)
    array.SetName("log10 volume")
    mesh.GetCellData().SetScalars(array)
    table = vtkLookupTable()
    table.SetHueRange(0.0, 0.16)
    table.SetTableRange(0.5, 2.8)
    table.SetAboveRangeColor(0.35, 0.6, 0.85, 1)
    table.UseAboveRangeColorOn()
    table.Build()
    actor = mesh_actor(mesh)
    actor.GetMapper().SetScalarModeToUseCellData()
    actor.GetMapper().SetLookupTable(table)
    actor.GetMapper().UseLookupTableScalarRangeOn()
    return actor


def histogram_chart(table):
    drops = drops_of(table)[1:]
    drops = drops[drops > 0]
    edges = np.geomspace(1, 1000, 16)
    counts, _ = np.histogram(drops, edges)
    chart = vtkChartXY()
    plot = chart.AddPlot(vtkChart.BAR)
    plot.SetInputData(table_of(("log", "drops"), (np.log10(edges[:-1]) + 0.1, counts.astype(float))), 0, 1)
    plot.SetColor(220, 120, 40, 255)
    chart.SetHiddenAxisBorder(70)
    set_axes(chart, "log10 of the volume in cm^3", "drops")
    chart.GetAxis(vtkAxis.LEFT).SetRange(0, counts.max() + 4.0)
    chart.GetAxis(vtkAxis.LEFT).SetBehavior(vtkAxis.FIXED)
    return chart


def panel_of(viewport, content):
    if isinstance(content, vtkActor):
        renderer = panel(viewport, content)
        camera = renderer.GetActiveCamera()
        camera.SetPosition(2.6, 2.3, 3.4)
        camera.SetFocalPoint(1.6, 0.45, 0)
        camera.SetViewUp(0, 1, 0)
        renderer.ResetCamera()
        camera.Zoom(1.5)
        return renderer
    actor = vtkContextActor()
    actor.GetScene().AddItem(content)
    renderer = panel(viewport, actor)
    actor.GetScene().SetRenderer(renderer)
    return renderer


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rows = levels(np.linspace(0, 2 * PERIOD, 41))
    pieces = pieces_of_dam_break()
    save([panel_of((0, 0.52, 0.62, 1), level_chart(rows)), panel_of((0, 0, 0.62, 0.52), colored_by_volume(pieces)),
          panel_of((0.62, 0, 1, 1), histogram_chart(pieces.GetTable()))], (1400, 800),
         os.path.join(sys.argv[1], "numbers.png"), samples=8)
    off = np.abs(rows[:, 1] - rows[:, 2]).max()
    drops = drops_of(pieces.GetTable())
    print(f"gauge: off the theory by {off / SPACING:.3f} spacings at most; the highest particle by "
          f"{np.abs(rows[:, 3] - rows[:, 2]).max() / SPACING:.3f}")
    print(f"pieces: {len(drops)}; closed with fluid inside: {(drops > 0).sum()}; largest but one {drops[1]:.0f} cm^3")


if __name__ == "__main__":
    main()
