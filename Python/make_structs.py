# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes what the Python package must know of the C sources, so that only the C sources have to be edited.

    make_structs.py mcor_parts.h mcor.h mcor_find.h FOLDER

_structs.py: the structures and enumerations of mcor.h for ctypes; the shapes of arrays, from its comments; the rows of
mcor_statistics.def and mcor_options.def, beside mcor.h, with the options' types; the codes of mcor_says.def; and the
options of the program marching-correctors. check_structs.c: checks that the C compiler has the same layout.
exports.map, .def, .txt: the functions that the library exports, for the linkers of Linux, Windows and macOS.
"""
import ctypes
import re
import sys
from pathlib import Path

NUMBERS = {
    "int": "c_int", "unsigned": "c_uint", "double": "c_double", "float": "c_float", "char": "c_char",
    "size_t": "c_size_t", "int64_t": "c_int64", "uint64_t": "c_uint64", "int32_t": "c_int32", "uint8_t": "c_uint8",
}

PROGRAM = Path(__file__).resolve().parents[1] / "Examples" / "CommandLine" / "options"


def fail(sentence):
    sys.exit(f"make_structs.py: {sentence}")


class Header:
    """The enumerations, structures and functions of a header as simple as mcor.h."""

    def __init__(self, text):
        self.constants = {name: int(value) for name, value in
                          re.findall(r"#define (\w+) \(?(-?\d+)\)?", text)}
        self.version = re.search(r'#define MCOR_VERSION "([^"]+)"', text).group(1)
        self.text = re.sub(r"^[ \t]*#(?:.*\\\n)*.*$", "", text, flags=re.M)
        code = " ".join(re.findall(r'"[^"]*"|\w+|\S', re.sub(r"/\*.*?\*/", "", self.text, flags=re.S)))  # one blank between all tokens
        self.enums = {name: self.read_enum(body)
                      for body, name in re.findall(r"typedef enum \w+ \{ (.*?) \} (\w+) ;", code)}
        self.structs = {}
        for tag, body, name in re.findall(r"struct (\w+) \{ (.*?) \}(?: (\w+))? ;", code):
            self.structs[name or tag] = [field for each in body.split(" ;") if each.strip() for field in self.read_fields(each.strip())]
        self.functions = {name: [self.parameter_type(each) for each in (result, *parameters.split(" , "))]
                          for result, name, parameters in
                          re.findall(r"(?<=[;{}]) ([\w *]+?) (mcor_\w+) \( (.*?) \) ;", code)}

    def read_enum(self, body):
        values, next_value = {}, 0
        for item in filter(None, (part.strip() for part in body.split(","))):
            name, _, value = (part.strip() for part in item.partition("="))
            next_value = int(value) if value else next_value
            values[name] = self.constants[name] = next_value
            next_value += 1
        return values

    def read_fields(self, declaration):
        """Returns (field, C type, number of stars, array length or None) for each field of a declaration."""
        callback = re.match(r"int \( \* (\w+) \) \(", declaration)
        if callback:
            return [(callback.group(1), "callback", 0, None)]
        base, rest = re.match(r"(?:const )?(\w+)(.*)", declaration).groups()
        fields = []
        for item in rest.split(" ,"):
            match = re.fullmatch(r"((?: \*)*) (\w+)(?: \[ (\w+) \])?", item)
            if not match or base not in {"void", *NUMBERS, *self.enums, *self.structs}:
                fail(f"cannot read '{declaration}'")
            stars, name, length = match.groups()
            if length:
                length = int(length) if length.isdigit() else self.constants[length]
            fields.append((name, base, stars.count("*"), length))
        return fields

    def shapes_of(self, struct):
        """Reads the shapes of a structure's arrays from the comments before their declarations, or behind them on the same line. "[count][3],
        unit L" gives ("count", 3); "[attribute_count] -> [count][components]" gives ("attribute_count", "->", "count", "components")."""
        body, shapes = re.search(rf"struct\s+{struct}\s*\{{(.*?)\}}\s*{struct}\s*;", self.text, re.S).group(1), {}
        told = {name: comment for comment, names in re.findall(r"/\*((?:(?!\*/).)*)\*/\s*\w+([\s*\w,]*);", body, re.S)
                for name in re.findall(r"\w+", names)}
        told.update(re.findall(r"(\w+)\s*;[ \t]*/\*(.*?)\*/", body, re.S))
        for name, _, pointers, _ in self.structs[struct]:
            comment = " ".join(re.sub(r"\n\s*\*", " ", told.get(name, "")).split())
            match = re.search(r"\[\w+\](?:\[\w+\])*(?: -> \[\w+\](?:\[\w+\])*)?", comment)
            if pointers and not match:
                fail(f"the comment on {struct}.{name} does not tell the shape of the array")
            if pointers:
                shapes[name] = tuple(int(part) if part.isdigit() else self.constants.get(part, part)
                                     for part in re.findall(r"->|\w+", match.group()))
        return shapes

    def parameter_type(self, text):
        """Returns the type of a parameter or of a result, as ctype() writes it. A text that the caller must free, or a
        handle, is a c_void_p."""
        base, stars = re.match(r"(?:const )?(\w+)((?: \*)*)", text).groups()
        pointers = stars.count("*") + ("[" in text)
        if (base, pointers) == ("void", 0):
            return "None"
        if base not in {*NUMBERS, *self.enums, *self.structs} or base == "char" and (
                pointers == 2 or text == "char *"):  # A mcor_context is a handle.
            base, pointers = "void", max(pointers, 1)
        return self.ctype(base, pointers, None)

    def ctype(self, base, pointers, length):
        if base == "callback":
            return "Progress"
        if base == "void":
            base, pointers = "ctypes.c_void_p", pointers - 1
        if (base, pointers) == ("char", 1):
            base, pointers = "ctypes.c_char_p", 0
        kind = f"ctypes.{NUMBERS[base]}" if base in NUMBERS else \
            "ctypes.c_int" if base in self.enums else base
        for _ in range(pointers):
            kind = f"ctypes.POINTER({kind})"
        return f"{kind} * {length}" if length else kind


class Rows:
    """The core's lists of statistics and of options. Their columns are explained in mcor_statistics.def and mcor_options.def.

    statistics: a list of (how, when, member, name). options: {member: ({word: number}, scope, property)}. types: {member:
    its type in Python}.
    """

    def __init__(self, folder, header):
        statistics = (folder / "mcor_statistics.def").read_text(encoding="utf-8")
        options = (folder / "mcor_options.def").read_text(encoding="utf-8")
        kernels = (folder / "grid" / "mcor_sph_kernel.h").read_text(encoding="utf-8")
        kinds = {field: base for field, base, *_ in header.structs["mcor_options"]}
        says = (folder / "mcor_says.def").read_text(encoding="utf-8")
        self.slots = sorted({*re.findall(r'^SLOT\("(\w+)', says, re.M)})
        codes = ["NOTHING", *re.findall(r'^SAYS\((\w+), ', says, re.M), "COUNT"]
        header.enums["mcor_says"] = {f"MCOR_SAYS_{code}": number for number, code in enumerate(codes)}
        self.statistics = re.findall(r'^STATISTIC\((\w+), (\w+), (\w+), "(\w*)"\)', statistics, re.M)
        self.options, self.types = {}, {}
        for member, legal, words, scope, name in re.findall(
                r'^OPTION\((\w+), .*, (\w+(?:\([^)]*\))?), "([^"]*)", ([A-Z| ]+), "(\w*)"\)', options, re.M):
            if member == "sph_kernel":
                legal, words = "WORD", "|".join(re.findall(r"ENTRY\(MCOR_\w+, (\w+),", kernels))
            words = words.split("|") if words else []
            literal = f"Literal[{', '.join(map(repr, words))}]"
            kind = "float" if kinds[member] == "double" else "bool" if legal == "FLAG" else "int"
            self.types[member] = literal if legal == "WORD" else f"Union[{kind}, {literal}]" if words else kind
            numbers = {word: i if legal == "WORD" else -1 - i for i, word in enumerate(words)}
            self.options[member] = numbers, scope.split(" | "), name
        for member, scope, name in re.findall(r'^BOUNDS\((\w+), ([A-Z| ]+), "(\w*)"\)', options, re.M):
            self.options[member], self.types[member] = ({}, scope.split(" | "), name), "Optional[Sequence[float]]"
        if len(self.options) != len(re.findall(r"^(?:OPTION|BOUNDS)\(", options, re.M)):
            fail("cannot read all rows of mcor_options.def")
        self.options["capping"][0].clear()  # These are True or False in Python, where the number depends on the box.
        self.types["capping"] = "bool"
        self.types.update((name[len("MCOR_OUT_"):].lower(), "bool") for name in header.enums["mcor_output"])


def program_options(folder):
    """Returns {option: (argument, help, modes, member)} of Options.def. A mode is a word such as "surface"; the word "usual" marks
    the options that most people need. member: the core's name of the option, or ""."""
    words = {}
    for name, value in re.findall(r"^  ([A-Z]+) = ([\w| ]*\w)", (folder / "Job.h").read_text(encoding="utf-8"), re.M):
        words[name] = [name.lower()] if value.isdigit() else [word for each in value.split(" | ") for word in words[each]]
    text, found = (folder / "Options.def").read_text(encoding="utf-8"), {}
    for option, argument, about, modes, member in re.findall(
            r'^OPTION\("(--[\w-]+)", "([^"]*)",\s+((?:"[^"]*"\s*)+|\w+\(\)),\s+([A-Z |]+),\s+"[^"]*",\s+"(\w*)",', text, re.M):
        modes = [word for each in modes.split(" | ") for word in words[each]]
        found[option] = argument, "".join(re.findall('"([^"]*)"', about)), modes, member
    if len(found) != text.count("\nOPTION("):
        fail("cannot read all rows of Options.def")
    return found


def python_module(header, rows):
    lines = ['"""Made by make_structs.py from mcor.h; not to be edited."""',
             "import ctypes", "from typing import Literal, Optional, Sequence, TypedDict, Union", "", f"VERSION = {header.version!r}", "",
             "Progress = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_char_p)",
             "Word = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_void_p, ctypes.c_size_t)",
             ""]
    for struct, fields in header.structs.items():
        lines += ["", f"class {struct}(ctypes.Structure):", "    _fields_ = ["]
        lines += [f'        ("{name}", {header.ctype(base, pointers, length)}),'
                  for name, base, pointers, length in fields]
        lines += ["    ]", ""]
    results = {struct: header.shapes_of(struct) for struct in ("mcor_surface", "mcor_samples", "mcor_derivatives", "mcor_flow")}
    kinds = {struct: {name: f"{base}[{length}]" if length else base
                      for name, base, pointers, length in header.structs[struct] if not pointers}
             for struct in ("mcor_options", "mcor_input")}
    lines += ["", "class CoreOptions(TypedDict, total=False):",
              *(f"    {name}: {kind}" for name, kind in rows.types.items()), ""]
    for label, value in (("ENUMS", header.enums), ("SHAPES", results), ("KINDS", kinds),
                         ("STATISTICS", rows.statistics), ("OPTIONS", rows.options), ("SLOTS", rows.slots),
                         ("PROGRAM", program_options(PROGRAM))):
        lines += ["", f"{label} = {value!r}"]
    lines += ["", "# {name: (type of the result, types of the parameters)}", "FUNCTIONS = {",
              *(f"    {name!r}: ({result}, [{', '.join(parameters)}])," for name, (result, *parameters) in
                sorted(header.functions.items())), "}"]
    return "\n".join(lines) + "\n"


def c_checks(module, header):
    """Returns a C file that compiles only if the compiler gives the structures the sizes and offsets that ctypes gives them."""
    scope = {}
    exec(compile(module, "_structs.py", "exec"), scope)  # This is the file that was just written.
    lines = ["/* Made by make_structs.py: Python's layout of the structures is the compiler's. */",
             '#include "mcor_find.h"', "#include <stddef.h>", ""]
    for struct, fields in header.structs.items():
        lines.append(f'_Static_assert(sizeof({struct}) == {ctypes.sizeof(scope[struct])}, "{struct}");')
        for name, *_ in fields:
            offset = getattr(scope[struct], name).offset
            lines.append(f'_Static_assert(offsetof({struct}, {name}) == {offset}, "{struct}.{name}");')
    return "\n".join(lines) + "\n"


def main():
    header = Header("".join(Path(name).read_text(encoding="utf-8") for name in sys.argv[1:-1]))
    folder = Path(sys.argv[-1])
    folder.mkdir(parents=True, exist_ok=True)
    module = python_module(header, Rows(Path(sys.argv[1]).parent, header))
    (folder / "_structs.py").write_text(module, encoding="utf-8")
    (folder / "check_structs.c").write_text(c_checks(module, header), encoding="utf-8")
    exports = sorted(header.functions)
    (folder / "exports.map").write_text(
        "{ global: " + "; ".join(exports) + "; local: *; };\n", encoding="utf-8")
    (folder / "exports.def").write_text("\n".join(["EXPORTS", *exports, ""]), encoding="utf-8")
    (folder / "exports.txt").write_text("".join(f"_{name}\n" for name in exports), encoding="utf-8")


if __name__ == "__main__":
    main()
