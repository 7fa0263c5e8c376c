#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The figures of the paper with the data of this project.

gallery.py DIRECTORY [NUMBER...]     (without a display: Testing/with-display.sh python3 gallery.py ...)

Draws the figures 1, 4 to 9, or those named, into DIRECTORY. PYTHONPATH must name the directory of the
package marchingcorrectors. README.md beside this file shows them.
"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
# pylint: disable=wrong-import-position
from pictures import read, save  # noqa: E402
from readme_pictures import need_surface, panel, surface_filter  # noqa: E402
from vtkmodules.vtkCommonCore import vtkLookupTable  # noqa: E402
from marchingcorrectors import vtkSPHDerivatives  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkActor, vtkDataSetMapper  # noqa: E402

RED, YELLOW, GREEN = (0.85, 0.15, 0.1), (0.95, 0.8, 0.15), (0.2, 0.65, 0.25)
WATER, ORANGE, LINE = (0.45, 0.68, 0.9), (0.90, 0.45, 0.20), (0.1, 0.2, 0.5)
LEFT, RIGHT, WHOLE = (0, 0, 0.5, 1), (0.5, 0, 1, 1), (0, 0, 1, 1)
THIRDS = [(i / 3, 0, (i + 1) / 3, 1) for i in range(3)]
WIDE = (1100, 400)


def surface(reader, array=None, value=None):
    """The filter for an isosurface, or the free surface."""
    extract = surface_filter(reader)
    if array:
        extract.SetInputArrayToProcess(0, 0, 0, 0, array)
        extract.SetValue(0, value)
    else:
        extract.FreeSurfaceOn()
    return extract


def velocity_derivatives(reader):
    """Vorticity and Lambda2 of the water, in place of those that the file brings."""
    derivatives = vtkSPHDerivatives()
    derivatives.SetInputConnection(reader.GetOutputPort())
    derivatives.SetInputArrayToProcess(0, 0, 0, 0, "Velocity")
    derivatives.SetFluidArrayName("ParticleType")
    derivatives.SetFluidValue(0)
    return derivatives


def actor_of(extract, color, opacity=1.0):
    need_surface(extract)
    mapper = vtkDataSetMapper()
    mapper.SetInputConnection(extract.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*color)
    actor.GetProperty().SetOpacity(opacity)
    actor.GetProperty().SetSpecular(0.25)
    actor.GetProperty().SetSpecularPower(30)
    return actor


def colored_by_weight(extract):
    """Green where the sum of the kernels is 1, red where it is 0.5 or less."""
    extract.ComputeWeightSumOn()
    actor = actor_of(extract, GREEN)
    table = vtkLookupTable()
    table.SetTableRange(0.5, 1.0)
    table.SetHueRange(0.0, 0.33)
    table.SetSaturationRange(0.85, 0.85)
    table.SetValueRange(0.9, 0.75)
    mapper = actor.GetMapper()
    mapper.ScalarVisibilityOn()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("WeightSum")
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    return actor


def wireframe(extract):
    actor = actor_of(extract, LINE)
    actor.GetProperty().SetRepresentationToWireframe()
    actor.GetProperty().LightingOff()
    return actor


def look(renderer, position, focus, angle):
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*position)
    camera.SetFocalPoint(*focus)
    camera.SetViewAngle(angle)
    renderer.ResetCameraClippingRange()
    return renderer


def show(reader, actors, caption, viewport, near=False):
    """The whole tank, or the water behind the obstacle from nearby."""
    renderer = panel(reader, actors, caption, viewport)
    for text in (prop for prop in renderer.GetViewProps() if prop.IsA("vtkTextActor")):
        text.GetTextProperty().SetFontSize(18)
        text.SetPosition(12, WIDE[1] - 30)
    if near:
        return look(renderer, (1.2, 1.1, 1.7), (2.75, 0.3, -0.1), 26)
    angle = 27 if viewport is WHOLE else 52 if viewport in THIRDS else 38
    return look(renderer, (-0.1, 2.4, 4.1), (1.62, 0.42, 0.0), angle)


def figure_1(reader):
    levels = ((500.0, RED), (1500.0, YELLOW), (3000.0, GREEN))
    actors = [actor_of(surface(reader, "Pressure", value), color) for value, color in levels]
    return [show(reader, [*actors, actor_of(surface(reader), WATER, 0.25)],
                 "pressure 500, 1500, 3000 Pa in the free surface", WHOLE)]


def figure_4(reader):
    renderers = []
    for trim, viewport, caption in ((0, LEFT, "not trimmed"), (1, RIGHT, "trimmed")):
        extract = surface(reader, "Velocity", 1.0)
        extract.SetTrim(trim)
        renderers.append(look(show(reader, [wireframe(extract)], caption, viewport), (0.3, 0.75, 0.4),
                              (0.82, 0.44, 0.12), 22))
    return renderers


def scaled(reader, scale, value=1500.0):
    extract = surface(reader, "Pressure", value)
    extract.SetHScaleFactor(scale)
    return extract


def figure_5(reader):
    return [show(reader, [colored_by_weight(scaled(reader, scale))], caption, viewport)
            for scale, caption, viewport in zip((1.0, 0.75, 0.5), ("pressure 1500 Pa, h", "0.75 h", "0.5 h"), THIRDS)]


def figure_6(reader):
    vorticity = velocity_derivatives(reader)
    return [show(reader, [actor_of(surface(vorticity, "Vorticity", 5.0), ORANGE)], "vorticity 5 / s", WHOLE)]


def figure_7(reader):
    lambda2, water = velocity_derivatives(reader), surface(reader)
    return [show(reader, [actor_of(surface(lambda2, "Lambda2", value), RED), actor_of(water, WATER, 0.15)],
                 f"lambda2 {value:g} / s^2", viewport) for value, viewport in ((-150.0, LEFT), (-50.0, RIGHT))]


def figure_8(reader):
    vorticity = velocity_derivatives(reader)
    return [show(reader, [actor_of(surface(vorticity, "Vorticity", value), ORANGE, 0.35)], f"vorticity {value:g} / s",
                 viewport) for value, viewport in zip((10.0, 1.0, 0.1), THIRDS)]


def figure_9(reader):
    return [show(reader, [actor_of(scaled(reader, scale), YELLOW)], caption, viewport, near=True)
            for scale, caption, viewport in ((1.0, "pressure 1500 Pa, h", LEFT), (0.5, "0.5 h: noise", RIGHT))]


FIGURES = {"1": figure_1, "4": figure_4, "5": figure_5, "6": figure_6, "7": figure_7, "8": figure_8, "9": figure_9}


def main(directory, numbers):
    reader = read()
    for number in numbers or FIGURES:
        if number not in FIGURES:
            sys.exit(f"there is no figure {number}; there are {', '.join(FIGURES)}")
        save(FIGURES[number](reader), WIDE, os.path.join(directory, f"figure_{number}.png"))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
