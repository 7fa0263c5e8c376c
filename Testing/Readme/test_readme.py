#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the snippets of a section of README.md, or of another page, as they stand there.

test_readme.py SOURCE BUILD SCRATCH PAGE SECTION [PAGE SECTION]   "-": what stands before the first section
test_readme.py SOURCE --links          all links between pages lead somewhere

SCRATCH becomes what the page calls "this folder": it shows the source tree's files and, as "build", the build tree.
The program that was built is on the PATH. Fenced blocks with a file name behind the language are written to that file; then the
blocks of language sh are run. They must succeed, leave every .vtp and .png that the section names, and
print every "N triangles" that stands in a comment. Git must ignore the files that they write. The files of a second
section are written, too, but its blocks are not run.
"""
import os
import re
import shutil
import subprocess
import sys

FENCE = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMENT = re.compile(r"(?:#|//|/\*) *([0-9][0-9,]*) triangles")


def section_of(page, title):
    if title == "-":  # "-" means what stands before the first section.
        return FENCE.findall(page.split("\n## ")[0])
    match = re.search(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL)
    if not match:
        sys.exit(f"the page has no section '{title}'")
    return FENCE.findall(match[1])


def make_scratch(source, build, scratch):
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    for name in ("Examples", "Testing", "vtkMarchingCorrectors"):
        os.symlink(os.path.join(source, name), os.path.join(scratch, name))
    os.symlink(build, os.path.join(scratch, "build"))


def write_files(blocks, scratch):
    for _, name, text in blocks:
        if name:
            path = os.path.join(scratch, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)


def run(blocks, scratch):
    """Runs the shell blocks in their order, and returns the text that they print."""
    commands = "".join(text for language, name, text in blocks if language == "sh" and not name)
    if not commands:
        sys.exit("the section has no shell commands")
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "PYTHONPATH")}
    environment["PATH"] = os.path.join(scratch, "build", "bin") + os.pathsep + environment["PATH"]
    result = subprocess.run(["bash", "-euxo", "pipefail", "-c", commands], cwd=scratch, env=environment,
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, text=True, check=False)
    print(result.stdout)
    if result.returncode:
        sys.exit(f"exit status {result.returncode}")
    return result.stdout


def faults(blocks, scratch, output):
    text = "".join(text for _, _, text in blocks)
    for count in COMMENT.findall(text):
        if not re.search(rf"\b{count.replace(',', '')} triangles", output):
            yield f"the page says {count} triangles"
    for name in sorted(set(re.findall(r"[\w/]+\.(?:vtp|png)\b", text))):
        path = os.path.join(scratch, name)
        if not (os.path.isfile(path) and os.path.getsize(path)):
            yield f"{name} is not there"


def not_ignored(source, scratch):
    """Yields a fault for each file of the scratch folder, links left out, that "git status" would show in the source
    tree."""
    written = [entry.name + "/" * entry.is_dir() for entry in os.scandir(scratch) if not entry.is_symlink()]
    ignored = subprocess.run(["git", "-C", source, "check-ignore", "--no-index", *written], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, text=True, check=False)
    if ignored.returncode in (0, 1):  # Otherwise these sources are no clone.
        yield from (f"git status would show {name}" for name in written if name not in ignored.stdout.split("\n"))


def pages(source):
    """Yields all .md files outside of build trees."""
    for folder, folders, names in os.walk(source):
        folders[:] = sorted(name for name in folders if not re.match(r"build|install|\.", name))
        yield from (os.path.join(folder, name) for name in sorted(names) if name.endswith(".md"))


def dead_links(source):
    """Yields the links and pictures of the pages that name no file of the tree."""
    for path in pages(source):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r"^```.*?^```$", "", file.read(), flags=re.MULTILINE | re.DOTALL)
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            name = target.split("#")[0]
            if name and "://" not in name and not os.path.exists(os.path.join(os.path.dirname(path), name)):
                yield f"{os.path.relpath(path, source)}: {target}"


def main(source, build, scratch, *sections):
    make_scratch(source, build, scratch)
    written = []
    for page, title in zip(sections[::2], sections[1::2]):
        with open(os.path.join(source, page), encoding="utf-8") as file:
            written.append(section_of(file.read(), title))
        write_files(written[-1], scratch)
    blocks = written[0]
    found = [*faults(blocks, scratch, run(blocks, scratch)), *not_ignored(source, scratch)]
    sys.exit("\n".join(found) if found else 0)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[2] == "--links":
        sys.exit("\n".join(dead_links(sys.argv[1])) or 0)
    if len(sys.argv) not in (6, 8):
        sys.exit(__doc__)
    main(*sys.argv[1:])
