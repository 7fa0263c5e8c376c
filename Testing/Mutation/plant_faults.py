#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Puts the faults of faults.py into a copy of the library, one at a time, and expects the tests
named with each to fail. By hand, and after changes of tests or of what they test:

    Testing/Mutation/plant_faults.py WORK_DIR [--only REGEX] [--list]

WORK_DIR keeps the copy, its build and its kernel caches; a minute or so per fault on two cores.
Exit status 1: some fault was not noticed, or its place was not found (then mend faults.py)."""
import argparse
import datetime
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import faults

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = ("vtkMarchingCorrectors/core", "vtkMarchingCorrectors/kernels")


def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)


def copy_tree(to):
    """The tracked and new files of the tree, as they are now."""
    names = run(["git", "-C", str(ROOT), "ls-files", "-co", "--exclude-standard"]).stdout.split("\n")
    for name in filter(None, names):
        source, target = ROOT / name, to / name
        if source.is_file() and not (target.exists() and target.read_bytes() == source.read_bytes()):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
            shutil.copymode(source, target)
    for folder in SOURCES:
        for file in (to / folder).rglob("*.*"):
            if not (ROOT / file.relative_to(to)).exists():
                file.unlink()


def find(tree, text):
    """Where the text is, whatever the white space: [(file, begin, end)]."""
    pattern = re.compile(r"\s+".join(re.escape(word) for word in text.split()))
    places = []
    for folder in SOURCES:
        for file in sorted((tree / folder).rglob("*.*")):
            if file.suffix in (".c", ".h", ".cl"):
                places += [(file, m.start(), m.end()) for m in pattern.finditer(file.read_text())]
    return places


class Build:
    def __init__(self, work):
        self.log = ""
        self.limit = 3600  # seconds, for tests that hang on a fault
        self.tree, self.build = work / "tree", work / "build"
        # Programs with faults are of no use to anyone else.
        self.environment = dict(os.environ, POCL_CACHE_DIR=str(work / "pocl"),
                                XDG_CACHE_HOME=str(work / "cache"))
        (work / "pocl").mkdir(parents=True, exist_ok=True)
        copy_tree(self.tree)
        self.need(["cmake", "-S", self.tree, "-B", self.build, "-DCMAKE_BUILD_TYPE=Release",
                   "-DMCOR_BUILD_VTK=OFF", "-DMCOR_BUILD_EXAMPLES=OFF", "-DMCOR_BUILD_TESTING=ON"])

    def need(self, command):
        result = run([str(word) for word in command], env=self.environment)
        if result.returncode != 0:
            sys.exit(result.stdout[-4000:])

    def test(self, tests):
        """Builds; the tests that fail, "build" where that does."""
        made = run(["cmake", "--build", str(self.build), "-j", str(os.cpu_count())],
                   env=self.environment)
        if made.returncode != 0:
            self.log = made.stdout[-4000:]
            return ["build"]
        command = ["ctest", "--test-dir", str(self.build), "--no-tests=error", "--stop-on-failure",
                   "-R", "^(%s)$" % "|".join(tests)]
        ctest = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 env=self.environment, start_new_session=True)
        try:
            said = ctest.communicate(timeout=self.limit)[0]
        except subprocess.TimeoutExpired:
            os.killpg(ctest.pid, signal.SIGKILL)
            ctest.communicate()
            return ["no end after %d s" % self.limit]
        failed = re.findall(r"^\s*\d+ - (\S+) \(", said, re.M)
        self.log = said[-4000:]
        if ctest.returncode != 0 and not failed:
            sys.exit(said[-4000:])
        return failed


def plant(build, fault):
    """What noticed it; None: nothing; a sentence where it cannot be planted."""
    places = find(build.tree, fault.old)
    if len(places) != 1:
        return None, "its place was found %d times" % len(places)
    file, begin, end = places[0]
    whole = file.read_text()
    file.write_text(whole[:begin] + fault.new + whole[end:])
    try:
        failed = build.test(fault.tests)
    finally:
        file.write_text(whole)
    if failed == ["build"]:
        return None, "it does not build"
    return failed, "NOT NOTICED by %s" % ", ".join(fault.tests)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--only", default="", help="faults whose name matches this")
    parser.add_argument("--list", action="store_true", help="only see whether each place is found once")
    options = parser.parse_args()
    chosen = [fault for fault in faults.FAULTS if re.search(options.only, fault.name)]
    if options.list:
        lost = [fault.name for fault in chosen if len(find(ROOT, fault.old)) != 1]
        print("\n".join(lost) or "%d faults, each with one place" % len(chosen))
        return 1 if lost else 0
    build = Build(options.work.resolve())
    commit = run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"]).stdout.strip()
    print("%s, commit %s" % (datetime.date.today(), commit))
    begin = time.monotonic()
    failed = build.test(sorted({test for fault in chosen for test in fault.tests}))
    if failed:
        print(build.log)
        sys.exit("without any fault these fail: %s" % " ".join(failed))
    build.limit = 30 + time.monotonic() - begin  # without a fault all of them end in this time
    bad = 0
    for fault in chosen:
        begin = time.monotonic()
        failed, problem = plant(build, fault)
        bad += not failed
        print("%-58s %s (%.0f s)" % (fault.name, ", ".join(failed) if failed else problem,
                                     time.monotonic() - begin), flush=True)
    print("%d faults, %d not noticed" % (len(chosen), bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
