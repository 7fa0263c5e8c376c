# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The plugin's XML against the wrapped filter, without ParaView: commands, defaults, values."""
import os
import pathlib
import re
import unittest
import xml.etree.ElementTree

from marchingcorrectors import vtkMarchingCorrectors, vtkSPHAlgorithm

XML = pathlib.Path(os.environ["MCOR_PLUGIN_XML"]) / "MarchingCorrectors.xml"
TYPES = {"IntVectorProperty": int, "DoubleVectorProperty": float, "StringVectorProperty": str}
NO_NAMES = ("(automatic)", "(none)")  # the filter's empty array name
# Setters of more or less than one value.
NOT_SCALAR = ("SetInputConnection", "SetInputArrayToProcess", "SetValue", "AddExcludedArray",
              "SetPanelBoxPosition", "SetPanelBoxLength", "SetPeriodicBounds", "SetWithin", "ReleaseDeviceMemory")

# Defaults that are not the filter's, and what those are: a panel shows what was found.
DIFFERENT = {"DetectFluid": "0"}

COMMAND_KEYS = ("command", "set_number_command", "clean_command")

# Setters without a property, and why.
NOT_IN_XML = {
    "SetController": "ParaView's processes have one, which is the default",
    "SetBox": "set by SetPanelBoxPosition and SetPanelBoxLength",
    "SetDetectArrays": "(automatic) in the panel's lists of arrays",
    "SetNumberOfFreeSurfaceValues": "SetFreeSurfaceValue makes it 1",
    "SetScalarComponent": "set by SetPanelComponent",
}


def get(extract, command):
    """What the setter `command` has set."""
    if command == "SetPanelComponent":
        component = extract.GetScalarComponent()
        return 3 if component == vtkMarchingCorrectors.MAGNITUDE else component
    return getattr(extract, "Get" + command[len("Set"):])()


def domain_values(element):
    """Texts of all values that the property's domains name."""
    for domain in element:
        if domain.tag == "BooleanDomain":
            yield from ("0", "1")
        elif domain.tag == "EnumerationDomain":
            yield from (entry.get("value") for entry in domain)
        elif domain.tag.endswith("RangeDomain"):
            yield from (domain.get(key) for key in ("min", "max") if domain.get(key))


class TestPluginXml(unittest.TestCase):
    def setUp(self):
        self.root = xml.etree.ElementTree.parse(XML)
        self.proxy = self.root.find(".//SourceProxy[@name='MarchingCorrectors']")
        properties = [e for e in self.proxy if e.tag.endswith("Property")]
        self.information = [e for e in properties if e.get("information_only")]
        self.elements = [e for e in properties if e not in self.information]

    def for_each_scalar(self, check):
        """check(setter, type, XML element) for all properties of one value."""
        for element in self.elements:
            if element.get("command") not in NOT_SCALAR:
                with self.subTest(element.get("name")):
                    self.assertEqual(element.get("number_of_elements"), "1")
                    check(element.get("command"), TYPES[element.tag], element)

    def commands(self):
        return [e.get(key) for e in self.elements for key in COMMAND_KEYS if e.get(key)]

    def test_commands_are_methods(self):
        self.assertEqual(self.proxy.get("class"), vtkMarchingCorrectors.__name__)
        for command in self.commands():
            with self.subTest(command):
                self.assertTrue(callable(getattr(vtkMarchingCorrectors, command, None)))

    def test_label_is_found(self):
        """ParaView's quick search looks at labels only."""
        label = self.proxy.get("label").lower()
        for word in ("sph", "isosurface", "free surface", "contour"):
            self.assertIn(word, label)
        # Of labels that begin with what was typed the first one is taken: of ParaView's SPH Dataset Interpolator,
        # and of all that the plugin has.
        labels = [p.get("label").lower() for file in XML.parent.glob("*.xml")
                  for p in xml.etree.ElementTree.parse(file).iter("SourceProxy")]
        self.assertGreater(len(labels), 8)
        self.assertEqual(min(each for each in labels + ["sph dataset interpolator"] if each.startswith("sph")), label)

    def test_guide_names_it(self):
        """As ParaView's traces do: the letters and digits of the label."""
        guide = pathlib.Path(__file__).resolve().parents[2] / "Documentation" / "Guide" / "paraview.md"
        self.assertIn("`" + re.sub("[^A-Za-z0-9]", "", self.proxy.get("label")) + "`", guide.read_text(encoding="utf-8"))

    def test_everything_is_documented(self):
        for proxy in self.root.iter("SourceProxy"):
            self.assertTrue(proxy.find("Documentation").text.strip())
            for element in proxy:
                if element.tag.endswith("Property"):
                    with self.subTest(proxy=proxy.get("name"), name=element.get("name")):
                        text = element.findtext("Documentation", "")
                        self.assertRegex(text, "Default:" if element.get("name") != "Input" else ".")

    def test_information(self):
        """What the panel shows of the last update has the type and size of its getter."""
        empty = vtkMarchingCorrectors()
        self.assertEqual(len(self.information), 18)
        for element in self.information:
            with self.subTest(element.get("name")):
                self.assertEqual(element.get("command"), "Get" + element.get("name"))
                found = getattr(empty, element.get("command"))()
                found = found if isinstance(found, tuple) else (found,)
                self.assertEqual(len(found), int(element.get("number_of_elements")))
                self.assertIs(type(found[0]), TYPES[element.tag])

    def test_setters_have_properties(self):
        own = {**vars(vtkSPHAlgorithm), **vars(vtkMarchingCorrectors)}
        setters = {name for name in own if name.startswith("Set") and "G" + name[1:] in own}
        self.assertEqual(setters - set(self.commands()), set(NOT_IN_XML))

    def test_names(self):
        def check(command, kind, element):
            name = element.get("name").replace("ScalarComponent", "PanelComponent")
            self.assertIn(command, (f"Set{name}", f"Set{name}Name"))
        self.for_each_scalar(check)

    def test_defaults(self):
        def check(command, kind, element):
            text = DIFFERENT.get(element.get("name"), element.get("default_values"))
            found = get(vtkMarchingCorrectors(), command)
            self.assertIs(type(found), kind)
            self.assertEqual(found, kind("" if text in NO_NAMES else text))
        self.for_each_scalar(check)

    def test_box(self):
        """The widget's position is the lower corner, its scale the lengths, in any order."""
        group = self.proxy.find("PropertyGroup[@panel_widget='InteractiveBox']")
        functions = {e.get("function"): e.get("name") for e in group.findall("Property")}
        self.assertEqual(functions, {"Position": "BoxPosition", "Scale": "BoxLength"})
        commands = {e.get("name"): e.get("command") for e in self.elements}
        for order in (("Position", "Scale"), ("Scale", "Position")):
            extract = vtkMarchingCorrectors()
            for function in order:
                values = (1.0, 2.0, 3.0) if function == "Position" else (0.5, 0.25, 4.0)
                getattr(extract, commands[functions[function]])(*values)
            self.assertEqual(extract.GetBox(), (1.0, 1.5, 2.0, 2.25, 3.0, 7.0))

    def test_list_of_names(self):
        """A property of any number of names: cleared, then added one by one."""
        extract = vtkMarchingCorrectors()
        lists = [e for e in self.elements if e.get("clean_command")]
        self.assertEqual([e.get("name") for e in lists], ["ExcludedArrays"])
        for _ in range(2):
            getattr(extract, lists[0].get("clean_command"))()
            for name in ("Density", "Id"):
                getattr(extract, lists[0].get("command"))(name)
        found = [extract.GetExcludedArray(i) for i in range(extract.GetNumberOfExcludedArrays())]
        self.assertEqual(found, ["Density", "Id"])

    def test_values_are_accepted(self):
        def check(command, kind, element):
            extract = vtkMarchingCorrectors()
            for text in domain_values(element):
                getattr(extract, command)(kind(text))
                self.assertEqual(get(extract, command), kind(text))
        self.for_each_scalar(check)

    def test_limits(self):
        """Enumerations and ranges end where the filter clamps; the filter in Python has its limits from here."""
        def check(command, kind, element):
            if kind is not int or element.find("BooleanDomain") is not None:
                return
            ends = [int(text) for text in domain_values(element)]
            beyond = [(min(ends) - 1, min(ends))] if command != "SetPanelComponent" else []
            beyond += [(max(ends) + 1, max(ends))] if len(ends) > 1 else []  # or all greater ones are legal
            for value, legal in beyond:
                extract = vtkMarchingCorrectors()
                getattr(extract, command)(value)
                self.assertEqual(get(extract, command), legal)
        self.for_each_scalar(check)


if __name__ == "__main__":
    unittest.main()
