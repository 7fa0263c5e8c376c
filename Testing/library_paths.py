# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Fails if a program or library in FOLDER would look for its libraries in the current folder.

    library_paths.py FOLDER...

An empty or relative path in RUNPATH or RPATH is relative to the folder in which a program is started. Whoever may
write there could replace the program's libraries.
"""
import os
import re
import subprocess
import sys


def binaries(folder):
    for place, _, names in os.walk(folder):
        for path in (os.path.join(place, name) for name in names):
            if os.path.isfile(path):
                with open(path, "rb") as file:
                    if file.read(4) == b"\x7fELF":
                        yield path


def main():
    count = 0
    wrong = []
    for path in (path for folder in sys.argv[1:] for path in binaries(folder)):
        told = subprocess.run(["readelf", "-d", path], stdout=subprocess.PIPE, text=True, check=True).stdout
        for elements in re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", told):
            if not all(element.startswith(("/", "$ORIGIN")) for element in elements.split(":")):
                wrong.append(f"{path}: [{elements}]")
        count += 1
    assert count  # A program or a library was found.
    print(f"{count} programs and libraries", *wrong, sep="\n")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
