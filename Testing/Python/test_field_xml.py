# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The XML of SPH Derivatives, SPH Flux, SPH Gauge, SPH Probe, SPH Projection and SPH Resample against the wrapped filters,
without ParaView."""
import os
import pathlib
import unittest
import xml.etree.ElementTree

from marchingcorrectors import (vtkSPHAlgorithm, vtkSPHComponents, vtkSPHDerivatives, vtkSPHFlux, vtkSPHGauge,
                                vtkSPHMeter, vtkSPHProbe, vtkSPHProjection, vtkSPHResample)

PLUGIN = pathlib.Path(os.environ["MCOR_PLUGIN_XML"])
TYPES = {"IntVectorProperty": int, "DoubleVectorProperty": float, "StringVectorProperty": str}
INPUTS = {"SetInputConnection", "SetSourceConnection"}
NOT_SCALAR = INPUTS | {"SetInputArrayToProcess", "AddExcludedArray", "SetPeriodicBounds", "SetWithin", "ReleaseDeviceMemory",
                       "SetOrigin", "SetNormal", "SetRadius", "SetPoint1", "SetPoint2", "SetBounds", "SetDimensions",
                       "SetDirection", "SetBox"}
# Setters without a property: (automatic) in the panel's lists stands for the first. A probe's particles are one set.
NOT_IN_XML = {"SetController", "SetDetectArrays"}
PROBES = NOT_IN_XML | {"SetBlocks"}
# Defaults that are not the filter's, and what those are: a panel shows what was found.
DIFFERENT = {"DetectFluid": "0", "NaNOutside": "0"}


class TestFieldXml(unittest.TestCase):
    def for_each(self, check):
        for filter_class in (vtkSPHDerivatives, vtkSPHFlux, vtkSPHGauge, vtkSPHProbe, vtkSPHProjection, vtkSPHResample):
            name = filter_class.__name__[3:]
            proxy = xml.etree.ElementTree.parse(PLUGIN / f"{name}.xml").find(".//SourceProxy")
            self.assertEqual((proxy.get("name"), proxy.get("class")), (name, filter_class.__name__))
            elements = [e for e in proxy if e.tag.endswith("Property") and not e.get("information_only")]
            with self.subTest(name):
                check(filter_class, proxy, elements)

    def for_each_value(self, check):
        """check(class, command, type, element) for the properties of one value."""
        def run(filter_class, proxy, elements):
            for element in elements:
                if element.get("command") not in NOT_SCALAR:
                    with self.subTest(element.get("name")):
                        check(filter_class, element.get("command"), TYPES[element.tag], element)
        self.for_each(run)

    def test_commands_are_methods(self):
        def check(filter_class, proxy, elements):
            for element in elements:
                for key in ("command", "clean_command"):
                    if element.get(key):
                        self.assertTrue(callable(getattr(filter_class, element.get(key), None)))
        self.for_each(check)

    def test_setters_have_properties(self):
        def check(filter_class, proxy, elements):
            own = {**vars(vtkSPHAlgorithm), **vars(filter_class),
                   **(vars(vtkSPHProbe) if filter_class is vtkSPHResample else {}),
                   **(vars(vtkSPHMeter) if issubclass(filter_class, vtkSPHMeter) else {})}
            setters = {name for name in own if name.startswith("Set") and "G" + name[1:] in own}
            self.assertEqual(setters - {e.get("command") for e in elements},
                             NOT_IN_XML if filter_class is vtkSPHDerivatives else PROBES)
        self.for_each(check)

    def test_defaults_and_values(self):
        def check(filter_class, command, kind, element):
            made = filter_class()
            get = getattr(made, "Get" + command[len("Set"):])
            text = element.get("default_values")
            if filter_class is not vtkSPHResample or element.get("name") != "NaNOutside":
                text = DIFFERENT.get(element.get("name"), text)
            self.assertIs(type(get()), kind)
            self.assertEqual(get(), kind("" if text in ("(automatic)", "(none)", "(density)") else text))
            for domain in element:
                values = [entry.get("value") for entry in domain if domain.tag == "EnumerationDomain"]
                values += ["0", "1"] if domain.tag == "BooleanDomain" else []
                values += [domain.get(k) for k in ("min", "max") if domain.get(k)]
                for value in values:
                    getattr(made, command)(kind(value))
                    self.assertEqual(get(), kind(value))
        self.for_each_value(check)

    def test_documentation(self):
        def check(filter_class, proxy, elements):
            self.assertGreater(len(proxy.findtext("Documentation")), 200)
            for element in elements:
                text = element.findtext("Documentation", "")
                self.assertRegex(text, "." if element.get("command") in INPUTS else "Default:")
            if filter_class is vtkSPHResample:
                return  # not in the menu itself
            menu = proxy.find("Hints/ShowInMenu")
            self.assertEqual(menu.get("category"), "Point Interpolation")
        self.for_each(check)

    def test_components(self):
        """No filter of particles: the surface comes first."""
        proxy = xml.etree.ElementTree.parse(PLUGIN / "SPHComponents.xml").find(".//SourceProxy")
        made = vtkSPHComponents()
        elements = [e for e in proxy if e.tag.endswith("Property")]
        setters = {name for name in vars(vtkSPHComponents) if name.startswith("Set") and "G" + name[1:] in
                   vars(vtkSPHComponents)} - {"SetController"}
        self.assertEqual(setters, {e.get("command") for e in elements if e.tag != "InputProperty"})
        self.assertEqual([port.get("index") for port in proxy.findall("OutputPort")], ["0", "1"])
        for element in elements:
            command = element.get("command")
            self.assertIn(element.tag, {"InputProperty", *TYPES})  # ParaView's panel leaves out others
            self.assertTrue(callable(getattr(made, command)))
            self.assertRegex(element.findtext("Documentation"), "." if element.tag == "InputProperty" else "Default:")
            if element.get("number_of_elements") == "1":
                value = getattr(made, "G" + command[1:])()
                text = DIFFERENT.get(element.get("name"), element.get("default_values").replace("(automatic)", ""))
                self.assertEqual(value, type(value)(text))

    def test_places(self):
        """ParaView fits what nobody has set to the particles' bounds, and takes a value for that which equals the
        default: where there is none, every value is a wish."""
        found = 0
        for path in sorted(PLUGIN.glob("*.xml")):
            for element in xml.etree.ElementTree.parse(path).iter("DoubleVectorProperty"):
                if element.find("BoundsDomain") is not None:
                    self.assertEqual(element.get("default_values"), "none", element.get("name"))
                    found += 1
        self.assertEqual(found, 9)

    def test_shapes(self):
        """SPH Slice, SPH Line and SPH Volume: the same filter with its shape chosen, where the panel says."""
        root = xml.etree.ElementTree.parse(PLUGIN / "SPHResample.xml")
        for shape, name in enumerate(("SPHSlice", "SPHLine", "SPHVolume")):
            proxy = root.find(f".//ProxyGroup[@name='filters']/SourceProxy[@name='{name}']")
            self.assertEqual(proxy.get("base_proxyname"), "SPHResample")
            defaults = {e.get("name"): e.get("default_values") for e in proxy if e.get("override")}
            self.assertEqual(defaults, {"Shape": str(shape), "NaNOutside" if name == "SPHVolume" else "FitBounds": "0"})
            self.assertEqual(proxy.find("Hints/ShowInMenu").get("category"), "Point Interpolation")


if __name__ == "__main__":
    unittest.main()
