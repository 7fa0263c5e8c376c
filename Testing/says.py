# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The core's sentences by their codes, so that tests do not repeat the words."""
import re
from pathlib import Path

TEXTS = dict(re.findall(r'^SAYS\((\w+), "(.*)"\)$', (
    Path(__file__).parents[1] / "vtkMarchingCorrectors/core/mcor_says.def").read_text(encoding="utf-8"), re.M))
_PART = re.compile(r"%[-+0-9.]*(?:ll|z)?[a-z]|\{[a-z_]+[^}]*\}")


def says(code, *found):
    """A regular expression for the sentence in the words of any interface. found: regular expressions that must
    occur in it, in this order."""
    words = "".join(f"(?=.*?{'.*?'.join(found)})" if found else "")
    return f"(?s:{words}" + ".*?".join(re.escape(part) for part in _PART.split(TEXTS[code])) + ")"
