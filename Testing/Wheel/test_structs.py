# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""make_structs.py reads the core's headers in the same way however their lines are broken.

    test_structs.py SOURCES
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sources = Path(sys.argv[1])
core = sources / "vtkMarchingCorrectors" / "core"
NAMES = "mcor_parts.h", "mcor.h", "mcor_find.h"


def made_of(texts, folder):
    """Returns the contents of all files that make_structs.py writes, by name."""
    folder.mkdir()
    (folder / "grid").mkdir()
    for name in ("mcor_statistics.def", "mcor_options.def", "mcor_says.def", "grid/mcor_sph_kernel.h"):
        shutil.copy(core / name, folder / name)
    for name, text in zip(NAMES, texts):
        (folder / name).write_text(text, encoding="utf-8")
    subprocess.run([sys.executable, sources / "Python" / "make_structs.py", *(folder / name for name in NAMES),
                    folder / "made"], check=True)
    return {file.name: file.read_text(encoding="utf-8") for file in (folder / "made").iterdir()}


def with_other_lines(text):
    """Returns the text with each word on a line of its own. Comments and lines of the preprocessor stay as they are."""
    parts = re.split(r"(/\*.*?\*/|^[ \t]*#[^\n]*)", text, flags=re.M | re.S)
    return "".join(part if i % 2 else re.sub(r"\s+(?=\S)", "\n", part) for i, part in enumerate(parts))


def formatted(text, columns):
    style = (sources / ".clang-format").read_text(encoding="utf-8").replace("ColumnLimit: 100", f"ColumnLimit: {columns}")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / ".clang-format").write_text(style, encoding="utf-8")
        return subprocess.run(["clang-format", "--assume-filename", str(Path(folder) / "header.h")], input=text,
                              stdout=subprocess.PIPE, check=True, encoding="utf-8").stdout


def rows_lack(folder):
    """Returns the members of mcor_options and mcor_statistics that have no row in the .def files, although they need one."""
    scope = {}
    exec((folder / "_structs.py").read_text(encoding="utf-8"), scope)  # This is the file that was just written.
    rows = {*scope["OPTIONS"], *(member for _, _, member, _ in scope["STATISTICS"])}
    members = {name for kind in ("mcor_options", "mcor_statistics") for name, _ in scope[kind]._fields_}
    return members - rows - {"iso_values", "iso_count", "globals", "ranks", "outputs", "progress", "progress_user",
                             "device", "platform"}


texts = [(core / name).read_text(encoding="utf-8") for name in NAMES]
with tempfile.TemporaryDirectory() as scratch:
    expected = made_of(texts, Path(scratch) / "0")
    lacking = rows_lack(Path(scratch) / "0" / "made")
    assert not lacking, f"no row of mcor_options.def or mcor_statistics.def: {', '.join(sorted(lacking))}"
    others = [[with_other_lines(text) for text in texts]]
    if shutil.which("clang-format"):
        others += [[formatted(text, columns) for text in texts] for columns in (60, 180)]
    for i, other in enumerate(others, 1):
        assert other != texts, i
        found = made_of(other, Path(scratch) / str(i))
        assert found == expected, [name for name in expected if found[name] != expected[name]]
