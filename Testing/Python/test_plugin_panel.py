#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the filter's panel in ParaView's real window. ParaView's own player of events uses the panel as a person does.

    test_plugin_panel.py PARAVIEW

Lists of events say what the player does to widgets, and what it must find in them. States that it saves in between show the effect.
"""
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

SECONDS = 600
WINDOW = "pqClientMainWindow"
PANEL = f"{WINDOW}/propertiesDock/propertiesPanel"
FILTER = f"{PANEL}/scrollArea/qt_scrollarea_viewport/scrollAreaWidgetContents/PropertiesFrame/ProxyPanel"
PAUSE = (WINDOW, "pause", "600")  # longer than the panel waits before it looks ahead
FILTERS = (f"{WINDOW}/menubar/menuFilters/Alphabetical", "activate", "MarchingCorrectors")
GAUGE = (FILTERS[0], "activate", "SPHGauge")
ADVANCED = (f"{PANEL}/SearchBox/AdvancedButton", "set_boolean", "true")  # Widgets that are not shown do not become grey.
APPLY = (f"{PANEL}/Accept", "activate", "")
DELETE = (f"{PANEL}/Delete", "activate", "")
COLOUR = f"{WINDOW}/variableToolbar/displayColor/Variables"
UNDO = (f"{WINDOW}/menubar/menu_Edit", "activate", "actionEditUndo")
REDO = (f"{WINDOW}/menubar/menu_Edit", "activate", "actionEditRedo")
OF_SCALARS = ("SelectInputScalars", "ContourValues", "DotProductWith", "ShepardNormalization", "Trim", "NodeThreshold",
              "BoundaryDetection", "VertexThreshold")
WIDENING = "Widening/DoubleRangeWidget/DoubleLineEdit"
CHECK = "check"  # This stands in the place of a command: a property of the widget must have this value.


def shown(widget, prop, value):
    return (f"{FILTER}/{widget}", CHECK, prop, value)


def usable(*widgets):
    return [shown(widget, "enabled", "true") for widget in widgets]


def greyed(*widgets):
    return [shown(widget, "enabled", "false") for widget in widgets]


def change(widget, command, value):
    return (f"{FILTER}/{widget}", command, value)


def save_state(path):
    return [(f"{WINDOW}/menubar/menu_File", "activate", "actionFileSaveServerState"),
            (f"{WINDOW}/FileSaveServerStateDialog", "filesSelected", path)]


def write_events(events, path):
    root = xml.Element("pqevents")
    for event in events:
        if event[1] == CHECK:
            xml.SubElement(root, "pqcheck", object=event[0], property=event[2], arguments=event[3])
        else:
            xml.SubElement(root, "pqevent", object=event[0], command=event[1], arguments=event[2])
    xml.ElementTree(root).write(path, xml_declaration=True)


def run(paraview, events, folder):
    script = os.path.join(folder, "events.xml")
    write_events(events, script)
    plugin = os.environ["MCOR_TEST_PLUGIN"]
    command = [paraview, "-dr", "--plugin-search-paths=" + os.path.dirname(plugin), "--plugins=MarchingCorrectors",
               "--data=" + os.path.join(os.environ["MCOR_TEST_DATA"], "dam_break_45k.vtp"),
               "--test-script=" + script, "--test-directory=" + folder, "--exit"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=SECONDS, check=False)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode}\n{done.stdout[-4000:]}\n{done.stderr[-8000:]}")


def first_apply(folder):
    """Before Apply the panel shows the effect of choices: the box, the number of cells, the red warning."""
    return [
        FILTERS, ADVANCED, PAUSE,
        *greyed("ContourValues", "Filled"),  # Walls are detected, so the water is shown first.
        change("Smooth/CheckBox", "set_boolean", "true"), *greyed("Widening", "Compact", "Filled"),
        shown(WIDENING, "text", "2"), shown("Compact/CheckBox", "checked", "true"),
        change("Smooth/CheckBox", "set_boolean", "false"), *usable("Widening", "Compact"),
        shown(WIDENING, "text", "1"), shown("Compact/CheckBox", "checked", "false"),
        change("FreeSurface/CheckBox", "set_boolean", "false"), PAUSE,
        shown("SelectInputScalars/ComboBox", "currentText", "Velocity"),
        shown("sph_in_use/Values", "visible", "false"),
        change("sph_in_use/Show", "set_boolean", "true"),
        shown("sph_in_use/Values", "visible", "true"),
        shown("sph_in_use/Values/NextFluid", "text", "ParticleType = 0"),
        *usable(*OF_SCALARS, "DetectFluid", "CubeLevelLimit"), *greyed("FreeSurfaceValue", "FluidValue", "Capping"),
        change("FreeSurface/CheckBox", "set_boolean", "true"),
        change("FluidArray/ComboBox", "set_string", "ParticleType"),
        change("CubeSizeMode/ComboBox", "set_string", "Uniform"), PAUSE,
        *greyed(*OF_SCALARS, "DetectFluid", "CubeLevelLimit"), *usable("FreeSurfaceValue", "FluidValue"),
        shown("sph_in_use/Values/NextCells", "text", "163423"),
        shown("InteractiveBox", "visible", "false"),
        change("UseBox/CheckBox", "set_boolean", "true"),
        shown("InteractiveBox", "visible", "true"), *usable("Capping"),
        change("InteractiveBox/translateX", "set_string", "0.75"),
        change("InteractiveBox/scaleX", "set_string", "1.5"), PAUSE,
        shown("sph_in_use/Values/NextCells", "text", "75211.7"),
        change("CubeSize/DoubleLineEdit0", "set_string", "0.0003"), PAUSE,
        shown("sph_in_use/Values/NextCells", "text", "4.57686e+09"),
        shown("CubeSizeFactor/Warning", "visible", "true"),
        change("CubeSize/DoubleLineEdit0", "set_string", "0"), PAUSE, shown("CubeSize/DoubleLineEdit0", "text", ""),
        shown("sph_in_use/Values/NextCells", "text", "75211.7"), shown("CubeSizeFactor/Warning", "visible", "false"),
        APPLY, *save_state(f"{folder}/applied.pvsm"),
    ]


def empty_first(folder):
    """If the first output is empty, the panel tells it, and the first output that is not empty gets the colours in its place."""
    value = "FreeSurfaceValue/DoubleRangeWidget/DoubleLineEdit"
    return [
        APPLY, FILTERS, PAUSE, change("FreeSurface/CheckBox", "set_boolean", "true"),
        change(value, "set_string", "1000"), PAUSE, APPLY, PAUSE, (COLOUR, CHECK, "currentText", "Solid Color"),
        shown("sph_in_use/Show", "text", "The output is empty: what was found, and what is used"),
        change(value, "set_string", "0.5"), PAUSE, APPLY, PAUSE, (COLOUR, CHECK, "currentText", "Velocity"),
        # The array that gives the colours follows the mode until the user chooses another one.
        change("FreeSurface/CheckBox", "set_boolean", "false"), PAUSE, APPLY, PAUSE, (COLOUR, CHECK, "currentText", "Vorticity"),
        *save_state(f"{folder}/legend.pvsm"),
        change("FreeSurface/CheckBox", "set_boolean", "true"), PAUSE, APPLY, PAUSE, (COLOUR, CHECK, "currentText", "Velocity"),
        (COLOUR, "set_string", "Pressure"), PAUSE,
        change("FreeSurface/CheckBox", "set_boolean", "false"), PAUSE, APPLY, PAUSE, (COLOUR, CHECK, "currentText", "Pressure"),
        FILTERS, PAUSE, *save_state(f"{folder}/second.pvsm"), DELETE, PAUSE, DELETE, PAUSE,
    ]


def later_applies(folder):
    """Undoes and redoes an Apply with several changes; chooses a second array and gives it up again; types iso values."""
    return [
        change("CubeSizeFactor/DoubleRangeWidget/DoubleLineEdit", "set_string", "1"),
        change("CubeSizeMode/ComboBox", "set_string", "Adaptive"),
        change("InteractiveBox/translateX", "set_string", "0.5"),
        APPLY, *save_state(f"{folder}/changed.pvsm"),
        UNDO, shown("CubeSizeFactor/DoubleRangeWidget/DoubleLineEdit", "text", "0.5"),
        shown("CubeSizeMode/ComboBox", "currentText", "Uniform"),
        shown("InteractiveBox/translateX", "text", "0.75"), *save_state(f"{folder}/undone.pvsm"),
        REDO, shown("CubeSizeFactor/DoubleRangeWidget/DoubleLineEdit", "text", "1"), *save_state(f"{folder}/redone.pvsm"),
        change("FreeSurface/CheckBox", "set_boolean", "false"),
        change("SelectInputScalars/ComboBox", "set_string", "Velocity"),
        change("DotProductWith/ComboBox", "set_string", "Vorticity"), PAUSE,
        APPLY, *save_state(f"{folder}/dot.pvsm"),
        change("DotProductWith/ComboBox", "set_string", "(none)"), PAUSE,
        APPLY, *save_state(f"{folder}/none.pvsm"),
        change("ContourValues/ScalarValueList/Add", "activate", ""),
        change("DotProductWith/ComboBox", "set_string", "Vorticity"), PAUSE,
        APPLY, *save_state(f"{folder}/touched.pvsm"),
    ]


def plot_over_time(folder):
    """The panel's button draws the level of a gauge at all times, and nothing else."""
    return [DELETE, PAUSE, GAUGE, PAUSE, APPLY, PAUSE, change("sph_in_use/Plot", "activate", ""), PAUSE, *save_state(f"{folder}/chart.pvsm")]


def check_chart(file):
    state = xml.parse(file)
    series = [e.get("value") for e in state.findall(".//Proxy[@type='XYChartRepresentation']/Property[@name='SeriesVisibility']/Element")]
    drawn = {name for name, visible in zip(series[::2], series[1::2]) if visible == "1"}
    assert len(series) > 10 and len(drawn) == 1 and drawn.pop().startswith("last"), series
    gauge = {p.get("name"): [float(e.get("value")) for e in p.findall("Element")] for p in
             state.findall(".//Proxy[@type='SPHGauge']/Property") if p.get("name") in ("Point1", "Point2")}
    # The gauge is upright and stands in the water, which fills one side of the tank.
    assert gauge["Point1"][::2] == gauge["Point2"][::2] and gauge["Point1"][1] < 0 < gauge["Point2"][1], gauge


def check_colours(file):
    """The range of colours covers the speeds of most of the surface in the box, though drops have speeds from 0.1 to
    4."""
    state = xml.parse(file)
    colours = state.find(".//ProxyCollection[@name='lookup_tables']/Item[@name='Velocity.PVLookupTable']").get("id")
    points = [float(e.get("value")) for e in state.findall(f".//Proxy[@id='{colours}']/Property[@name='RGBPoints']/Element")]
    assert abs(points[0] - 0.748) < 0.01 and abs(points[-4] - 2.185) < 0.01, points


def check_legend(file):
    """Only the legend of the array that gives the colours is shown, though another array gave the colours before."""
    bars = [{p.get("name"): [e.get("value") for e in p.findall("Element")] for p in bar.findall("Property")}
            for bar in xml.parse(file).findall(".//Proxy[@type='ScalarBarWidgetRepresentation']")]
    titles = [bar["Title"] for bar in bars if bar["Visibility"] == ["1"]]
    assert titles == [["Vorticity"]], titles


# Beginnings of the names of properties that the panel only shows.
SHOWN = ("Next", "Used", "Estimated", "ColorRanges", "MessageCount", "FluidScalarRange", "Statistics", "SurfaceMeasures")


def properties(file):
    """Returns the properties in a saved state that a user may set, each with a list of values."""
    proxy = xml.parse(file).find(".//Proxy[@type='MarchingCorrectors']")
    return {p.get("name"): [e.get("value") for e in p.findall("Element")] for p in proxy.findall("Property")
            if not p.get("name").startswith(SHOWN)}


def differing(states, one, other):
    return {name for name in states[one] if states[one][name] != states[other][name]}


def check_states(states):
    applied = states["applied"]
    wanted = {"FreeSurface": ["1"], "FluidArray": ["ParticleType"], "CubeSizeMode": ["0"], "CubeSize": ["0"], "UseBox": ["1"]}
    assert {name: applied[name] for name in wanted} == wanted, applied
    # The box had the particles' bounds before it was changed.
    assert applied["BoxPosition"] == ["0.75", "0", "-0.5"] and applied["BoxLength"][0] == "1.5", applied
    assert abs(float(applied["BoxLength"][1]) - 1.2) < 1e-6, applied
    # A new filter contours an array at its median in the fluid.
    assert applied["SelectInputScalars"][4] == "Velocity", applied
    assert [abs(float(value) - 1.06648) < 1e-5 for value in applied["ContourValues"]] == [True], applied
    changes = {"CubeSizeFactor", "CubeSizeMode", "BoxPosition"}
    assert differing(states, "applied", "changed") == changes, differing(states, "applied", "changed")
    assert not differing(states, "applied", "undone") and not differing(states, "changed", "redone")
    assert states["dot"]["DotProductWith"][4] == "Vorticity" and states["dot"]["SelectInputScalars"][4] == "Velocity"
    # The iso value follows the chosen array until the user changes it.
    assert differing(states, "dot", "none") == {"DotProductWith", "ContourValues"}, differing(states, "dot", "none")
    assert states["none"]["DotProductWith"][4] == "(none)" and states["none"]["ContourValues"] == applied["ContourValues"]
    assert states["touched"]["ContourValues"] == 2 * applied["ContourValues"], states["touched"]["ContourValues"]


def main(paraview):
    with tempfile.TemporaryDirectory() as folder:
        run(paraview, empty_first(folder) + first_apply(folder) + later_applies(folder) + plot_over_time(folder), folder)
        check_chart(f"{folder}/chart.pvsm")
        check_colours(f"{folder}/applied.pvsm")
        check_legend(f"{folder}/legend.pvsm")
        second = xml.parse(os.path.join(folder, "second.pvsm"))
        names = [item.get("name") for item in second.findall(".//ProxyCollection[@name='sources']/Item")]
        assert sorted(name for name in names if "SPH" in name) == ["SPHContour1", "SPHContour2"], names
        check_states({name[:-5]: properties(os.path.join(folder, name))
                      for name in os.listdir(folder) if name.endswith(".pvsm") and "chart" not in name})
    print("the panel works")


if __name__ == "__main__":
    main(sys.argv[1])
