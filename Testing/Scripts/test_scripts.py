#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests wrong starts of quickstart.sh, run-tests.sh and CMake, and the functions of their steps. Nothing is installed or built.

test_scripts.py SOURCE SCRATCH [TESTS]
"""
import os
import pathlib
import pty
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

SOURCE, SCRATCH = sys.argv[1:3]


def run(*command, cwd=SOURCE):
    return subprocess.run(command, cwd=cwd, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=600, check=False)


class Sources(unittest.TestCase):
    def test_only_some_files_call_opencl(self):
        core = pathlib.Path(SOURCE, "vtkMarchingCorrectors", "core")
        callers = {file.name for file in core.rglob("*") if file.is_file() and not file.name.startswith("mcor_cl_")
                   and re.search(r"\bcl[A-Z]\w*\s*\(", file.read_text(encoding="utf-8"))}
        self.assertEqual(callers, {"mcor_opencl.h"})

    def test_letters_are_small_in_every_locale(self):
        """No source file uses tolower for names: in a Turkish locale tolower('I') is not 'i', so arrays and blocks would not be found."""
        for file in filter(pathlib.Path.is_file, pathlib.Path(SOURCE, "vtkMarchingCorrectors").rglob("*")):
            self.assertNotRegex(file.read_text(encoding="utf-8"), r"\b(std::)?to(lower|upper)\([^'I]", file)


class ScratchTest(unittest.TestCase):
    """A test that begins with an empty folder."""

    def setUp(self):
        shutil.rmtree(SCRATCH, ignore_errors=True)
        os.makedirs(SCRATCH)


class Arguments(unittest.TestCase):
    def check_refused(self, sentence, *command):
        result = run(*command)
        self.assertNotEqual(result.returncode, 0)
        self.assertEqual(result.stdout.count("\n"), 1, result.stdout)  # Nothing was built or installed.
        self.assertIn(sentence, result.stdout)

    def test_unknown_options_are_refused_at_once(self):
        self.check_refused("unknown option --bogus", "Testing/run-tests.sh", "--bogus")
        self.check_refused("unknown option -x", "Testing/run-tests.sh", "-L", "unit", "-x")
        self.check_refused("unknown option word", "Examples/quickstart.sh", "word")

    def test_missing_values_are_named(self):
        self.check_refused("-L needs a pattern", "Testing/run-tests.sh", "-L")
        self.check_refused("--sdk is vtk or", "Testing/run-tests.sh", "--sdk")
        self.check_refused("not 'qt'", "Examples/quickstart.sh", "--sdk", "qt")

    def test_help(self):
        for script in ("Testing/run-tests.sh", "Examples/quickstart.sh"):
            for option in ("-h", "--help"):
                result = run(script, option)
                self.assertEqual(result.returncode, 0)
                self.assertIn(f"./{script} [--sdk vtk|paraview]", result.stdout)
                self.assertNotIn("set -e", result.stdout)


class Steps(ScratchTest):
    def run_steps(self, commands, interrupt=False):
        """Runs commands in bash with the functions of .ci/steps.sh, and returns the exit status and the output. interrupt: sends SIGINT to
        bash's process group, as Ctrl-C does, as soon as a step has written to the pipe $PIPE."""
        pipe = os.path.join(SCRATCH, "pipe")
        os.mkfifo(pipe)
        with tempfile.TemporaryFile("w+") as output, subprocess.Popen(
                ["bash", "-c", "set -euo pipefail; . .ci/steps.sh; " + commands, "script"], cwd=SOURCE,
                stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, start_new_session=True,
                env={**os.environ, "PIPE": pipe}, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)) as process:
            if interrupt:
                with open(pipe) as begun:
                    begun.read()
                os.killpg(process.pid, signal.SIGINT)
            process.wait(timeout=300)
            output.seek(0)
            return process.returncode, output.read()

    def test_a_good_step_says_one_line(self):
        status, output = self.run_steps("mcor_step Working echo hidden; echo after")
        self.assertEqual((status, output), (0, "Working\nafter\n"))

    def test_a_failed_step_shows_its_output_and_ends_the_script(self):
        status, output = self.run_steps("mcor_step Working sh -c 'echo shown; exit 7'; echo after")
        self.assertEqual(status, 7)
        self.assertIn("shown\n", output)
        self.assertIn("failed: Working", output)
        self.assertNotIn("after", output)

    def test_interrupt_ends_step_and_script(self):
        status, output = self.run_steps("mcor_step Working sh -c 'sleep 1; echo >$PIPE; cat $PIPE'; echo after", interrupt=True)
        self.assertEqual(status, 130)
        self.assertNotIn("after", output)

    def test_what_must_finish_does_and_then_the_script_ends(self):
        done = os.path.join(SCRATCH, "done")
        status, output = self.run_steps(f"mcor_step must-finish Working sh -c 'sleep 1; echo >$PIPE; sleep 1; touch {done}'; "
                                        "echo after", interrupt=True)
        self.assertEqual(status, 130)
        self.assertTrue(os.path.exists(done))
        self.assertIn("finished first", output)
        self.assertNotIn("after", output)

    def test_kernels_of_another_build_are_taken(self):
        """Each of quickstart.sh and run-tests.sh uses the kernels that the other one has compiled."""
        for other, build in (("build", "build-tests"), ("build-tests", "build")):
            kept = os.path.join(SCRATCH, other, "vtkMarchingCorrectors", "core", "ahead")
            os.makedirs(kept)
            status, output = self.run_steps(f"""cd {SCRATCH}; mcor_step() {{ echo "$@"; }}
                mcor_build {build} vtk -DMORE=1; mcor_build {other} vtk""")
            self.assertEqual(status, 0)
            first, _, second, _ = output.splitlines()
            self.assertIn(f" -DMCOR_AHEAD_KEPT={kept} -DMORE=1", first)
            self.assertNotIn("MCOR_AHEAD_KEPT", second)
            shutil.rmtree(SCRATCH)

    def test_a_long_test_is_named_while_it_runs(self):
        status, output = self.run_steps(
            """(echo '    Start  1: quick'; echo '1/2 Test  #1: quick ....   Passed    0.10 sec'
            echo '    Start 20: slow_one'; sleep 2.5; printf '2/2 Test #20: slow_one ....   Pa'; sleep 1.5
            echo 'ssed    8.00 sec'; echo; echo summary; exit 3) | mcor_show_tests 1 || echo "status $?" """)
        self.assertEqual(status, 0)
        self.assertIn("slow_one is running, ", output)
        self.assertNotIn("quick is running", output)
        self.assertTrue(output.endswith(
            "2/2 Test #20: slow_one ....   Passed    8.00 sec\n\nsummary\nstatus 3\n"), output)


class Configuration(ScratchTest):
    def configure(self, *options, source=SOURCE):
        return run("cmake", "-Wno-dev", "-S", source, "-B", os.path.join(SCRATCH, "configured"), *options)

    def check_stops(self, result, *words):
        self.assertNotEqual(result.returncode, 0)
        for word in words:
            self.assertIn(word, " ".join(result.stdout.split()))

    def test_a_path_that_the_wrapper_cannot_take(self):
        folder = os.path.join(SCRATCH, "copy (1)")
        shutil.copytree(os.path.join(SOURCE, ".ci"), os.path.join(folder, ".ci"))
        for name in ("CMakeLists.txt", "Examples/quickstart.sh", "Testing/run-tests.sh"):
            os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
            shutil.copy(os.path.join(SOURCE, name), os.path.join(folder, name))
        self.check_stops(self.configure(source=folder), "in a folder with '('")
        for script in ("Examples/quickstart.sh", "Testing/run-tests.sh"):
            self.check_stops(run(os.path.join(folder, script)), "work in a folder")

    def test_unit_tests_do_not_vanish(self):
        result = self.configure("-DMCOR_BUILD_VTK=OFF", "-DMCOR_BUILD_EXAMPLES=OFF", "-DMCOR_WERROR=ON",
                                "-DCMAKE_DISABLE_FIND_PACKAGE_cmocka=ON")
        self.check_stops(result, "cmocka (Debian: libcmocka-dev) was not found")

    def test_the_sdk_is_told_before_anything_is_installed(self):
        """If neither SDK is installed, a user at a terminal is asked which one to install; without a terminal VTK
        is taken, and a message names the option for ParaView."""
        def choose(stdin):
            return subprocess.run(["bash", "-c", ". .ci/packages.sh; mcor_is_installed() { false; }; mcor_choose_sdk ''"],
                                  cwd=SOURCE, text=True, check=True, stdin=stdin, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, timeout=600)
        told = choose(subprocess.DEVNULL)
        self.assertEqual(told.stdout, "vtk\n")
        self.assertIn("exclude each other", told.stderr)
        self.assertIn("--sdk paraview", told.stderr)
        for answer, sdk in ((b"paraview\n", "paraview\n"), (b"\n", "vtk\n")):
            terminal, end = pty.openpty()
            os.write(terminal, answer)
            self.assertEqual(choose(end).stdout, sdk)
            os.close(end)
            os.close(terminal)

    def test_a_folder_of_another_sdk(self):
        result = self.configure("-DMCOR_SDK=Another 1.0", "-DMCOR_BUILD_TESTING=OFF",
                                "-DPython3_EXECUTABLE=/usr/bin/python3")
        self.check_stops(result, "made for Another 1.0", "--fresh")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
