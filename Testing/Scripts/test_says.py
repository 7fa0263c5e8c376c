#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the core's sentences in mcor_says.def: each is used, interfaces have words for its slots {...}, and compilers check its formats.

test_says.py SOURCES OUTPUT COMPILER

OUTPUT gets all sentences as each interface says them, to be read by people.
"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

COMPILER, OUTPUT, SOURCES = sys.argv.pop(), Path(sys.argv.pop()), Path(sys.argv.pop())
CORE = SOURCES / "vtkMarchingCorrectors" / "core"
sys.path.insert(0, str(SOURCES / "Testing"))
from says import SLOTS, TEXTS, fill  # noqa: E402

SAID = [file for folder, endings in (("vtkMarchingCorrectors", (".c", ".h", ".cxx")), ("Examples/CommandLine", (".cxx",)),
                                     ("Python", (".py",)))
        for file in sorted((SOURCES / folder).rglob("*")) if file.suffix in endings and "Testing" not in file.parts]
# Settings that the program has no option for. The program never prints the messages about them.
NOT_IN_PROGRAM = {"blocks"}


def words_of_program():
    """Returns {member of a struct of the core: the program's option that sets it}, from the rows of Options.def."""
    rows = (SOURCES / "Examples/CommandLine/options/Options.def").read_text(encoding="utf-8").split('\nOPTION("--')[1:]
    words = {"estimate_smoothing_length": "--smoothing-length estimate"}  # OptionWord does the same.
    for row in rows:
        members = [word for word in re.findall(r'"(\w+)"', row.split("DO(")[0]) if word in SLOTS]
        words.update({members[-1]: "--" + row.split('"')[0]} if members else {})
    return words


class Says(unittest.TestCase):
    def test_each_is_used_once_or_more(self):
        text = "\n".join(file.read_text(encoding="utf-8") for file in SAID)
        used = {*re.findall(r"MCOR_SAY\((\w+)\)", text), *re.findall(r"MCOR_SAYS_(\w+)", text),
                *re.findall(r'\bsay\("(\w+)"', text)}
        self.assertEqual(sorted(set(TEXTS) - used), [], "nobody says these")

    def test_each_slot_has_words(self):
        """Every interface has a word for each slot {...} in the texts, and in strings of the C code that become parts of texts."""
        parts = {code: re.findall(r"\{[a-z_%][^{}]*\}", text) for code, text in TEXTS.items()}
        for file in SAID:
            if CORE in file.parents:
                parts[file.name] = re.findall(r'"[^"\n]*?(\{[a-z_]+(?: [\w.]+)?\})[^"\n]*"', file.read_text(encoding="utf-8"))
        program, found = words_of_program(), 0
        for where, slots in parts.items():
            for slot in slots:
                name = slot[1:-1].split(" ")[0]
                if name == "%s":  # This stands for any option of mcor_options.def.
                    continue
                found += 1
                self.assertIn(name, SLOTS, where)
                self.assertNotEqual(SLOTS.get(slot[1:-1]) or SLOTS[name], "", (where, slot))
                self.assertTrue(name in program or name in NOT_IN_PROGRAM, (where, slot))
        self.assertGreater(found, 50)

    def test_print_all(self):
        """Writes all messages to OUTPUT. A message that differs between interfaces has a line for each interface."""
        program, lines = words_of_program(), []
        for code, text in TEXTS.items():
            said = {"C, Python": fill(text, lambda name, value: name + (value and "=" + value)),
                    "panel": fill(text, lambda name, value: SLOTS.get(f"{name} {value}") or f"{SLOTS[name]} {value}".strip()),
                    "program": fill(text, lambda name, value: f"{program.get(name, name)} {value}".strip())}
            same = len(set(said.values())) == 1
            lines += [f"{code}: {said['panel']}"] if same else [f"{code}, {who}: {sentence}" for who, sentence in said.items()]
            self.assertRegex(text, r"([.?]|%s)$", f"{code} is no sentence")
            self.assertLess(len(text), 600, code)
        OUTPUT.parent.mkdir(parents=True, exist_ok=True)
        OUTPUT.write_text("\n".join(lines) + "\n", encoding="utf-8")

    def test_compiler_checks_formats(self):
        with tempfile.TemporaryDirectory() as folder:
            for argument, good in (("1", True), ("1.5", False), ('"one"', False)):
                source = Path(folder) / "say.c"
                source.write_text(f'#include "mcor_say.h"\nmcor_message said(void);\n'
                                  f"mcor_message said(void) {{ return mcor_say(MCOR_SAY(ISO_NOT_FINITE), {argument}); }}\n")
                done = subprocess.run([COMPILER, "-std=c11", "-Wall", "-Werror", f"-I{CORE}", "-fsyntax-only", source],
                                      stderr=subprocess.PIPE, text=True)
                self.assertEqual(done.returncode == 0, good, done.stderr)
                self.assertTrue(good or "format" in done.stderr, done.stderr)


if __name__ == "__main__":
    unittest.main()
