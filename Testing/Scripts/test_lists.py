#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the guide and the help name options and statistics as the core's lists do: mcor_options.def and mcor_statistics.def.

test_lists.py SOURCES
"""
import re
import sys
import unittest
from pathlib import Path

SOURCES = Path(sys.argv.pop(1))
CORE = SOURCES / "vtkMarchingCorrectors" / "core"
GUIDE = SOURCES / "Documentation" / "Guide"
# The core's default is auto (-2): 0 for the free surface, else measured (-1). The filters' default is -1, because their property
# Solids says whether the surface ends at walls.
DIFFERENT = {"WallShare": "-1"}


def rows_of(name):
    text = (CORE / f"mcor_{name.lower()}s.def").read_text(encoding="utf-8")
    return [re.findall(r'(\w+\([^()]*\)|[^",]+|"[^"]*")(?:, |$)', row) for row in
            re.findall(rf"^{name}\((.*)\)$", text, re.M)]


class Options(unittest.TestCase):
    def setUp(self):
        levels = int(re.search(r"#define MCOR_CUBE_LEVELS (\d+)", (CORE / "mcor.h").read_text(encoding="utf-8"))[1])
        self.defaults = {}
        for _, usual, legal, words, _, name in rows_of("OPTION"):
            usual = usual.replace("MCOR_CUBE_LEVELS - 1", str(levels - 1))
            self.defaults[name.strip('"')] = (
                "cubic" if "KERNEL" in legal else words.strip('"').split("|")[int(usual)].replace("_", " ")
                if legal == "WORD" else "off" if legal == "FLAG" else usual)
        del self.defaults[""]
        self.defaults.update(DIFFERENT)

    def test_the_guide_and_the_help_say_the_names_and_defaults(self):
        table = (GUIDE / "parameters.md").read_text(encoding="utf-8")
        said = {name: (option, cell) for option, name, cell in
                re.findall(r"^\| [^|(]*\((?:`(--[\w-]+)`; )?(\w+)(?:; `\w+`)?\) \| ([^|]*) \|", table, re.M)}
        source = (SOURCES / "Examples/CommandLine/options/Options.def").read_text(encoding="utf-8")
        helps = {name: " ".join(re.findall('"([^"]*)"', text)) for name, text in
                 re.findall(r'OPTION\("(--[\w-]+)", ((?:"[^"]*",?\s*)+)', source)}
        in_help = 0
        for name, default in self.defaults.items():
            with self.subTest(name):
                self.assertIn(name, said)  # parameters.md has a row for it.
                option, cell = said.pop(name)
                number = re.search(r"-?\d[\d.e-]*", cell)
                if re.match(r"-?\d", default):
                    self.assertEqual(float(number[0]), float(default))
                else:
                    self.assertTrue(cell.startswith(default), f"{cell}, not {default}")
                found = re.search(r"default:? (-?\d[\d.e-]*\d|\d+)", helps[option]) if option else None
                if found:
                    self.assertEqual(float(found[1]), float(default), helps[option])
                    in_help += 1
        self.assertGreater(in_help, 4)

    def test_the_help_has_the_words(self):
        source = (SOURCES / "Examples/CommandLine/options/Options.def").read_text(encoding="utf-8")
        shown = {frozenset(words.split("|")) for words in re.findall(r'OPTION\("--[\w-]+", "([\w|]+)",', source)}
        for member, _, legal, words, _, name in rows_of("OPTION"):
            if legal == "WORD" and name != '""':
                self.assertIn(frozenset(words.strip('"').split("|")), shown, member)

    def test_reuse_is_tried_with_each(self):
        """Every option has a step in test_core_reuse.c, except the options listed here, which make another kind of
        surface."""
        text = (SOURCES / "Testing" / "Core" / "test_core_reuse.c").read_text(encoding="utf-8")
        members = {row[0] for row in rows_of("OPTION")}
        self.assertEqual(members - set(re.findall(r"^STEP\((\w+),", text, re.M)),
                         {"dimension", "level_limit", "capping", "filled"})


class Statistics(unittest.TestCase):
    def test_the_guide_names_the_keys_of_the_file(self):
        """The guide's pages name statistics as --stats does: `scalar_range`, not ScalarRange."""
        properties = {row[-1].strip('"') for row in rows_of("OPTION")}
        names = {name.strip('"') for _, _, _, name in rows_of("STATISTIC")} - properties
        names |= {"SmoothingLengthRange", "ScalarRange"}
        self.assertGreater(len(names), 30)
        keys = {re.sub("(?<!^)([A-Z])", r"_\1", name).lower() for name in names} | {"rank_" + what for what in (
            "particles", "copies", "bytes_sent", "work", "nodes_evaluated", "triangles", "seconds", "neighbors")}
        for page in sorted(GUIDE.glob("*.md")):
            for paragraph in page.read_text(encoding="utf-8").split("\n\n"):
                for name in re.findall(r"`(\w+)`", paragraph):
                    self.assertFalse(name in names and re.match("[A-Z].*[A-Z]", name), f"{page.name}: {name}")
                    if "--stats" in paragraph and re.fullmatch("[a-z]+_[a-z_]+", name):
                        self.assertIn(name, keys, page.name)


if __name__ == "__main__":
    unittest.main()
