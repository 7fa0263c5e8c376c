# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Holds the core's sentences by their codes, so that tests do not repeat the words."""
import re
from pathlib import Path

_CORE = Path(__file__).parents[1] / "vtkMarchingCorrectors" / "core"
_SAYS, _OPTIONS = ((_CORE / f"mcor_{name}.def").read_text(encoding="utf-8") for name in ("says", "options"))
TEXTS = {code: text.replace('\\"', '"') for code, text in re.findall(r'^SAYS\((\w+), "(.*)"\)$', _SAYS, re.M)}
# {name: the panel's word that replaces {name} in a sentence}
SLOTS = {**{member: re.sub(r"(?<=.)(?=[A-Z])", " ", name) for member, name in
            re.findall(r'^(?:OPTION|BOUNDS)\((\w+), .*"(\w*)"\)$', _OPTIONS, re.M)},
         **dict(re.findall(r'^SLOT\("([^"]+)", "([^"]+)"\)', _SAYS, re.M))}
_PART = re.compile(r"%[-+0-9.]*(?:ll|z)?[a-z]|\{[a-z_]+[^}]*\}")


def fill(text, word):
    """Returns the text with word(name, value) in place of each slot."""
    return re.sub(r"\{([a-z_]+)(?: ([^{}]+))?\}", lambda slot: word(slot[1], slot[2] or ""), text)


def says(code, *found):
    """Returns a regular expression for the sentence with this code, in the words of any interface. found: regular expressions that must
    occur in the sentence, in this order."""
    words = f"(?=.*?{'.*?'.join(found)})" if found else ""
    return f"(?s:{words}" + ".*?".join(re.escape(part) for part in _PART.split(TEXTS[code])) + ")"
