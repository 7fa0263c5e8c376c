# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests names that hold any bytes: test_text.py PROGRAM PRELOAD."""
import json
import os
import re
import xml.etree.ElementTree

import particle_files as files
from command_line_test import ISO, CommandLineTest, main

# Characters that act on a terminal: control characters (some take two UTF-8 bytes), line separators, and marks that change the direction of
# writing.
UNSAFE = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]")


class Text(CommandLineTest):
    """Tests that printed text cannot steer a terminal, and that every written file is valid."""

    def printed(self, result):
        """Returns standard error and standard output as text, which must be UTF-8 without characters that act on a
        terminal."""
        text = (result.stderr + result.stdout).decode("utf-8")
        self.assertIsNone(UNSAFE.search(text), ascii(text))
        return text

    def extract_bytes(self, *options, **run_options):
        return self.extract(*options, text=False, **run_options)

    def test_every_byte_in_file_names(self):
        for first in range(1, 256, 16):
            name = bytes(b for b in range(first, first + 16) if 0 < b < 256 and b != ord("/"))
            with self.subTest(first=hex(first)):
                source = os.fsencode(self.directory) + b"/" + name + b".vtp"
                os.rename(self.input, source)
                result = self.extract_bytes(*ISO, "--stats", b"s-" + name, source=source)
                self.assertEqual((result.returncode, result.stderr), (0, b""))
                data = (os.fsencode(self.directory) + b"/s-" + name)
                with open(data, "rb") as stream:
                    text = stream.read().decode("utf-8")
                self.assertIsNone(UNSAFE.search(text), ascii(text))
                expected = source.decode("utf-8", "replace")
                found = json.loads(text)["input"]
                if all(b < 128 for b in name):
                    self.assertEqual(found, expected)
                else:
                    self.assertEqual(set(found) - set(expected), set())
                os.remove(source)
                missing = self.extract_bytes(*ISO, source=source)
                self.assertEqual(missing.returncode, 1)
                self.assertIn("cannot be read: No such file", self.printed(missing))
                self.assertEqual(missing.stderr.count(b"\n"), 1)
                files.write_vtp(self.input, self.points, self.arrays)

    def test_valid_text_stays(self):
        name = "Größe 水 \U0001f30a"
        self.arrays[name] = self.arrays["Radius"]
        files.write_vtp(self.directory / (name + ".vtp"), self.points, self.arrays)
        found = self.succeed("--scalar", name, "--iso", "0.3", source=self.directory / (name + ".vtp"))
        self.assertEqual(found["arrays"]["scalar"], name)
        self.assertTrue(found["input"].endswith(name + ".vtp"))
        self.assertIn(f"'{name}x'", self.extract("--scalar", name + "x", "--iso", "1").stderr)

    def test_usage(self):
        for word in (b"\x1b[31m", b"\xff\xfe", b"\xc2\x9b31m", b"a\nb", "\u202e".encode(), b"\xed\xa0\x80",
                     b"\xc0\x80", b"\xf4\x90\x80\x80", b"\xe2\x82"):
            with self.subTest(word):
                for arguments in ([b"--" + word], [b"--kernel=" + word], [b"--h-scale", word], [word, word]):
                    result = self.extract_bytes(*ISO, *arguments)
                    self.assertEqual(result.returncode, 2)
                    self.assertEqual(self.printed(result).count("\n"), 1)
        self.assertIn(r"'\x1b[31m\xff\x0a'", self.printed(self.run_program(b"\x1b[31m\xff\n", b"\x1b[31m\xff\n",
                                                                      b"\x1b[31m\xff\n", text=False)))

    def test_array_names(self):
        for encoded, shown in ((b"%1b[31mred%07%0a", r"\x1b[31mred\x07\x0a"), (b"T\xe9mp", r"T\xe9mp"),
                               (b"%22%3c%26%3e'", "\"<&>'"), (b"%c2%9b31m", r"\x9b31m")):
            with self.subTest(encoded):
                source = self.directory / "named.vtk"  # VTK decodes %1b in names of a legacy file.
                files.write_legacy(source, self.points, {name: self.arrays[name] for name in ("SmoothingLength", "Radius")})
                source.write_bytes(source.read_bytes().replace(b"Radius", encoded))
                result = self.extract_bytes(*ISO, source=source)
                self.assertEqual(result.returncode, 1)
                self.assertIn(shown, self.printed(result))
                # An option accepts the array's name as the program prints it, and the outputs can be read.
                for name in {shown.encode(), *([b"T\xe9mp"] if b"\xe9" in encoded else [])}:
                    result = self.extract_bytes("--scalar", name, "--iso", "0.3", "--stats", "s.json",
                                                source=source)
                    self.assertEqual((result.returncode, result.stderr), (0, b""))
                    self.assertIn(shown, self.printed(result))
                    stats = json.loads((self.directory / "s.json").read_text())
                    self.assertEqual(stats["arrays"]["scalar"], shown)
                    xml.etree.ElementTree.parse(self.output)

    def test_messages_of_vtk(self):
        path = self.directory / "bad.vtk"
        path.write_bytes(b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET \x1b[31mPOLY\x07\xff\nPOINTS 0 float\n")
        result = self.extract_bytes(*ISO, source=path)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(self.printed(result).count("\n"), 1)


if __name__ == "__main__":
    main()
