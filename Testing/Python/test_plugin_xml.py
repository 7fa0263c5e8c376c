# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the plugin's XML with the wrapped filters, without ParaView: commands, defaults, values."""
import os
import pathlib
import re
import unittest
import xml.etree.ElementTree

import marchingcorrectors

FOLDER = pathlib.Path(os.environ["MCOR_PLUGIN_XML"])
FILTERS = ("vtkMarchingCorrectors", "vtkSPHComponents", "vtkSPHDerivatives", "vtkSPHFlux", "vtkSPHGauge", "vtkSPHProbe",
           "vtkSPHProjection", "vtkSPHResample", "vtkSPHTemporalInterpolator")
TYPES = {"IntVectorProperty": int, "DoubleVectorProperty": float, "StringVectorProperty": str}
NO_NAMES = ("(automatic)", "(none)", "(density)")  # These texts stand for an empty array name.
# scalars() leaves out these setters: they do not set one value, or their property has no default.
NOT_SCALAR = ("SetInputArrayToProcess", "SetValue", "AddExcludedArray", "SetPanelBoxPosition", "SetPanelBoxLength",
              "SetPeriodicBounds", "SetWithin", "ReleaseDeviceMemory", "SetOrigin", "SetNormal", "SetRadius", "SetPoint1",
              "SetPoint2", "SetBounds", "SetDimensions", "SetDirection", "SetBox")
# {property: the filters' default}, where the plugin has another default.
DIFFERENT = {"DetectFluid": "0", "NaNOutside": "0"}
# Setters without a property, and why.
NOT_IN_XML = {
    "SetController": "ParaView's processes have one, which is the default",
    "SetDetectArrays": "(automatic) in the panel's lists of arrays",
    "SetBlocks": "a probe's particles are one set",
    "SetBox": "set by SetPanelBoxPosition and SetPanelBoxLength",
    "SetNumberOfFreeSurfaceValues": "SetFreeSurfaceValue makes it 1",
    "SetScalarComponent": "set by SetPanelComponent",
}


def get(made, command):
    """Returns the value that the setter `command` has set."""
    if command == "SetPanelComponent":
        component = made.GetScalarComponent()
        return 3 if component == made.MAGNITUDE else component
    return getattr(made, "Get" + command[len("Set"):])()


def domain_values(element):
    """Yields all values that the property's domains name, as texts."""
    for domain in element:
        if domain.tag == "BooleanDomain":
            yield from ("0", "1")
        elif domain.tag == "EnumerationDomain":
            yield from (entry.get("value") for entry in domain)
        elif domain.tag.endswith("RangeDomain"):
            yield from (domain.get(key) for key in ("min", "max") if domain.get(key))


class TestPluginXml(unittest.TestCase):
    def setUp(self):
        self.proxies = [proxy for path in sorted(FOLDER.glob("*.xml"))
                        for proxy in xml.etree.ElementTree.parse(path).iter("SourceProxy")]
        self.main = next(proxy for proxy in self.proxies if proxy.get("name") == "MarchingCorrectors")

    def filters(self):
        """Yields each filter's class, its proxy, and the properties that a user sets."""
        found = {proxy.get("class"): proxy for proxy in self.proxies if not proxy.get("base_proxyname")}
        self.assertEqual(sorted(found), sorted(FILTERS))
        for name, proxy in found.items():
            yield getattr(marchingcorrectors, name), proxy, [
                e for e in proxy if e.tag.endswith("Property") and not e.get("information_only")]

    def scalars(self):
        """Yields, for each property with one value, the class, the setter, its type and the XML element."""
        for kind, _, elements in self.filters():
            for element in elements:
                if element.tag in TYPES and element.get("command") not in NOT_SCALAR:
                    yield kind, element.get("command"), TYPES[element.tag], element

    def test_commands_are_methods(self):
        for kind, proxy, elements in self.filters():
            self.assertIn(proxy.get("name"), (kind.__name__, kind.__name__[len("vtk"):]))
            for element in elements:
                self.assertIn(element.tag, {"InputProperty", "Property", "ProxyProperty", *TYPES})  # Panels leave out other elements.
                for command in filter(None, map(element.get, ("command", "set_number_command", "clean_command"))):
                    self.assertTrue(callable(getattr(kind, command, None)), command)

    def test_setters_have_properties(self):
        for kind, _, elements in self.filters():
            own = {name for each in kind.__mro__ if each.__module__.startswith("marchingcorrectors") for name in vars(each)}
            setters = {name for name in own if name.startswith("Set") and "G" + name[1:] in own}
            lacking = setters - {e.get(key) for e in elements for key in ("command", "set_number_command")}
            is_main = kind.__name__ == "vtkMarchingCorrectors"
            allowed = set(NOT_IN_XML) - ({"SetBlocks"} if is_main else {"SetBox", "SetNumberOfFreeSurfaceValues", "SetScalarComponent"})
            self.assertLessEqual(lacking, allowed, kind)
            if is_main:
                self.assertEqual(lacking, allowed)

    def test_label_is_found(self):
        """ParaView's quick search looks only at labels, so the label must have these words."""
        label = self.main.get("label").lower()
        for word in ("sph", "isosurface", "free surface", "contour"):
            self.assertIn(word, label)
        # Quick search takes the first label, in alphabetical order, that begins with the typed text. For "sph" it must find this filter,
        # not ParaView's SPH Dataset Interpolator or another filter of the plugin.
        labels = [proxy.get("label").lower() for proxy in self.proxies]
        self.assertGreater(len(labels), 8)
        self.assertEqual(min(each for each in labels + ["sph dataset interpolator"] if each.startswith("sph")), label)

    def test_guide_names_it(self):
        """In ParaView's traces the filter's name is the letters and digits of its label. The guide must use this
        name."""
        guide = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "Guide" / "paraview.md"
        self.assertIn("`" + re.sub("[^A-Za-z0-9]", "", self.main.get("label")) + "`", guide.read_text(encoding="utf-8"))

    def test_everything_is_documented(self):
        for proxy in self.proxies:
            self.assertTrue(proxy.findtext("Documentation").strip())
            for element in proxy:
                is_about_times = element.get("name") in ("TimestepValues", "TimeRange")
                if element.tag.endswith("Property") and not element.get("override") and not is_about_times:
                    with self.subTest(proxy=proxy.get("name"), name=element.get("name")):
                        text = element.findtext("Documentation", "")
                        self.assertRegex(text, "." if element.tag == "InputProperty" else "Default:")

    def test_menus(self):
        """SPH Slice, SPH Line and SPH Volume are SPHResample with a chosen shape. SPHResample itself is in no menu."""
        proxies = {proxy.get("name"): proxy for proxy in self.proxies}
        for shape, name in enumerate(("SPHSlice", "SPHLine", "SPHVolume")):
            self.assertEqual(proxies[name].get("base_proxyname"), "SPHResample")
            defaults = {e.get("name"): e.get("default_values") for e in proxies[name] if e.get("override")}
            self.assertEqual(defaults, {"Shape": str(shape), "NaNOutside" if name == "SPHVolume" else "FitBounds": "0"})
        for name in ("SPHDerivatives", "SPHFlux", "SPHGauge", "SPHProbe", "SPHProjection", "SPHSlice", "SPHLine", "SPHVolume"):
            self.assertEqual(proxies[name].find("Hints/ShowInMenu").get("category"), "Point Interpolation", name)
        self.assertEqual([port.get("index") for port in proxies["SPHComponents"].findall("OutputPort")], ["0", "1"])

    def test_information(self):
        """Properties that only show values have the types and sizes of their getters."""
        empty = marchingcorrectors.vtkMarchingCorrectors()
        information = [e for e in self.main if e.get("information_only")]
        self.assertEqual(len(information), 22)
        for element in information:
            with self.subTest(element.get("name")):
                self.assertEqual(element.get("command"), "Get" + element.get("name"))
                found = getattr(empty, element.get("command"))()
                found = found if isinstance(found, tuple) else (found,)
                self.assertEqual(len(found), int(element.get("number_of_elements")))
                self.assertIs(type(found[0]), TYPES[element.tag])

    def test_defaults_and_values(self):
        for kind, command, number, element in self.scalars():
            where = kind.__name__, element.get("name")
            self.assertEqual(element.get("number_of_elements"), "1", where)
            if kind.__name__ == "vtkMarchingCorrectors":
                name = element.get("name").replace("ScalarComponent", "PanelComponent")
                self.assertIn(command, (f"Set{name}", f"Set{name}Name"), where)
            made, text = kind(), element.get("default_values")
            if kind.__name__ != "vtkSPHResample" or element.get("name") != "NaNOutside":
                text = DIFFERENT.get(element.get("name"), text)
            self.assertIs(type(get(made, command)), number, where)
            self.assertEqual(get(made, command), number("" if text in NO_NAMES else text), where)
            values = [number(value) for value in domain_values(element)]
            for value in values or [{int: 3, float: 2.5, str: "Other"}[number]]:
                getattr(made, command)(value)
                self.assertEqual(get(made, command), value, where)

    def test_limits(self):
        """Enumerations and integer ranges in the XML end where the filters clamp values. The Python package takes its limits from the XML."""
        for kind, command, number, element in self.scalars():
            if number is not int or element.find("BooleanDomain") is not None:
                continue
            ends = [int(text) for text in domain_values(element)]
            beyond = [(min(ends) - 1, min(ends))] if not command.endswith("Component") else []
            beyond += [(max(ends) + 1, max(ends))] if len(ends) > 1 else []  # With a lower end alone, all greater values are legal.
            for value, legal in beyond:
                made = kind()
                getattr(made, command)(value)
                self.assertEqual(get(made, command), legal, element.get("name"))

    def test_box(self):
        """The box widget's position is the lower corner, and its scale the lengths. Either may be set first."""
        group = self.main.find("PropertyGroup[@panel_widget='InteractiveBox']")
        functions = {e.get("function"): e.get("name") for e in group.findall("Property")}
        self.assertEqual(functions, {"Position": "BoxPosition", "Scale": "BoxLength"})
        commands = {e.get("name"): e.get("command") for e in self.main}
        for order in (("Position", "Scale"), ("Scale", "Position")):
            extract = marchingcorrectors.vtkMarchingCorrectors()
            for function in order:
                values = (1.0, 2.0, 3.0) if function == "Position" else (0.5, 0.25, 4.0)
                getattr(extract, commands[functions[function]])(*values)
            self.assertEqual(extract.GetBox(), (1.0, 1.5, 2.0, 2.25, 3.0, 7.0))

    def test_list_of_names(self):
        """To set a property with any number of names, ParaView clears the list and adds the names one by one."""
        extract = marchingcorrectors.vtkMarchingCorrectors()
        element, = [e for e in self.main if e.get("clean_command")]
        self.assertEqual(element.get("name"), "ExcludedArrays")
        for _ in range(2):
            getattr(extract, element.get("clean_command"))()
            for name in ("Density", "Id"):
                getattr(extract, element.get("command"))(name)
        self.assertEqual([extract.GetExcludedArray(i) for i in range(extract.GetNumberOfExcludedArrays())], ["Density", "Id"])

    def test_places(self):
        """ParaView fits a property with a BoundsDomain to the particles' bounds as long as the property equals its default. So these
        properties have no default; then every value that a user sets is kept."""
        fitted = [e for proxy in self.proxies for e in proxy.iter("DoubleVectorProperty") if e.find("BoundsDomain") is not None]
        self.assertEqual({e.get("default_values") for e in fitted}, {"none"})
        self.assertEqual(len(fitted), 9)


if __name__ == "__main__":
    unittest.main()
