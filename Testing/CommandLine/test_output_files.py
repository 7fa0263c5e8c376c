# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests how the program marching-correctors writes files: test_output_files.py PROGRAM PRELOAD."""
import json
import os
import pathlib
import signal
import stat
import subprocess
import threading
import time
import unittest
import xml.etree.ElementTree

import particle_files as files
from command_line_test import WITH_DISPLAY, CommandLineTest, drop_privileges, main

QUOTE = '"'
FREE = ["--free-surface", "--quiet"]


def mode_of(path):
    return stat.S_IMODE(path.stat().st_mode)


class OutputFiles(CommandLineTest):
    """Tests that every output is whole or untouched, and that devices, pipes and links stay what they are."""

    def good(self, *options, **run_options):
        return self.extract_good(*FREE, *options, **run_options)

    def whole(self, path):
        text = path.read_text()
        self.assertTrue(text.startswith("<?xml") and text.rstrip().endswith("</VTKFile>"))
        return text

    # ---- Outputs that are not regular files ----

    def device(self, name, minor):
        """Returns a device file. If the user may make device files, the test makes its own, because a fault of the program would destroy
        the machine's file."""
        path = self.directory / name
        try:
            os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, minor))
            path.open("wb").close()
        except PermissionError:
            path = pathlib.Path("/dev") / name  # A user who may not make devices cannot replace this one either.
        return path

    def test_device(self):
        null = self.device("null", 3)
        self.good("--stats", null)
        self.assertTrue(stat.S_ISCHR(null.stat().st_mode))

    def test_fifo(self):
        fifo = self.directory / "fifo"
        os.mkfifo(fifo)
        texts = []
        reader = threading.Thread(target=lambda: texts.append(fifo.read_text()))
        reader.start()
        result = self.extract(*FREE, "--stats", fifo)
        if not stat.S_ISFIFO(fifo.stat().st_mode):  # Without this check, the reader would wait for ever on a replaced pipe.
            os.kill(os.getpid(), signal.SIGKILL)
        reader.join()
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(json.loads(texts[0])["output"], str(self.output))

    def test_standard_output(self):
        for name in ("/dev/fd/1", "/proc/self/fd/1"):  # /dev/stdout is a link to the first of these.
            with self.subTest(name):
                link = self.directory / "link"
                link.symlink_to(name)
                self.assertIn("statistics", json.loads(self.good("--stats", link).stdout))
                self.assertTrue(link.is_symlink())
                link.unlink()

    def test_standard_output_in_a_file(self):
        log = self.directory / "log"
        with log.open("w") as stream:
            self.extract("--free-surface", "--stats", "/dev/fd/1", capture_output=False, stdout=stream)
        text = log.read_text()
        self.assertTrue(text.startswith("particles "), text)  # The text that the file had before is still there.
        self.assertIn("statistics", json.loads(text[text.index("{"):]))

    def test_closed_standard_output(self):
        # If standard output is closed, no file that the program opens may take its descriptor.
        result = subprocess.run(["sh", "-c", '"$@" >&-', "sh", self.program, self.input, self.output,
                                 "--free-surface", "--stats", "s.json"], cwd=self.directory,
                                capture_output=True, text=True, timeout=1200)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.whole(self.output)
        json.loads((self.directory / "s.json").read_text())

    def test_full_standard_output(self):
        with open("/dev/full", "w") as full:
            result = self.extract("--free-surface", capture_output=False, stdout=full,
                                  stderr=subprocess.PIPE)
        self.one_sentence(result, 1, "standard output could not be written")
        self.whole(self.output)
        self.one_sentence(self.extract(*FREE, "--stats", self.device("full", 7)), 1,
                          "/full could not be written: No space left on device")

    # ---- Links and modes ----

    def test_symbolic_link(self):
        (self.directory / "a").mkdir()
        (self.directory / "b").mkdir()
        target = self.directory / "b" / "target.vtp"
        link = self.directory / "a" / "link.vtp"
        link.symlink_to("../b/other.vtp")
        (self.directory / "b" / "other.vtp").symlink_to("target.vtp")
        for old in (None, "old"):  # In the first round the links lead nowhere.
            with self.subTest(old=old):
                if old:
                    target.write_text(old)
                self.output = link
                self.good()
                self.whole(target)
                self.assertFalse(target.is_symlink())
                self.assertEqual(os.readlink(link), "../b/other.vtp")
                self.assertEqual(os.readlink(self.directory / "b" / "other.vtp"), "target.vtp")
        self.output = self.directory / "circle.vtp"
        self.output.symlink_to(self.output)
        self.one_sentence(self.extract(*FREE), 1, "circle.vtp could not be written: Too many levels")

    def test_mode(self):
        for name, mode in ("surface.vtp", 0o600), ("s.json", 0o646), ("s.json", 0o4755):
            with self.subTest(name, mode=oct(mode)):
                path = self.directory / name
                path.write_text("old")
                path.chmod(mode)
                self.good("--stats", "s.json")
                self.assertEqual(mode_of(path), mode)
                self.assertNotEqual(path.read_text(), "old")

    def test_mode_of_new_file(self):
        for mask in (0o022, 0o027, 0o077, 0o002):
            self.output.unlink(missing_ok=True)
            self.good(preexec_fn=lambda mask=mask: os.umask(mask))
            self.assertEqual(oct(mode_of(self.output)), oct(0o666 & ~mask))

    @unittest.skipUnless(os.geteuid() == 0, "only root can give files to others")
    def test_owner(self):
        self.output.write_text("old")
        os.chown(self.output, 12345, 54321)
        self.output.chmod(0o666)
        self.good()
        status = self.output.stat()
        self.assertEqual((status.st_uid, status.st_gid, mode_of(self.output)), (12345, 54321, 0o666))
        # A user who cannot keep the old owner and group must not give the old group's rights to the new group.
        self.good(preexec_fn=drop_privileges)
        self.assertEqual((self.output.stat().st_uid, oct(mode_of(self.output))), (0, oct(0o606)))

    def test_hard_link(self):
        other = self.directory / "other"
        other.write_text("old")
        os.link(other, self.output)
        self.good()
        self.whole(self.output)
        self.assertEqual(other.read_text(), "old")

    # ---- One file named twice ----

    def test_same_file(self):
        hard = self.directory / "hard.vtp"
        os.link(self.input, hard)
        soft = self.directory / "soft.vtp"
        soft.symlink_to(self.input.name)
        (self.directory / "folder").symlink_to(self.directory)
        before = self.input.read_text()
        for output in self.input, hard, soft, self.directory / "folder" / "particles.vtp":
            with self.subTest(output):
                self.one_sentence(self.run_program(self.input, output, *FREE), 2,
                                  "would overwrite the input")
        (self.directory / "later").symlink_to("surface.vtp")  # The link is made before its target exists.
        for name in "folder/surface.vtp", "later", "./surface.vtp":
            with self.subTest(name):
                self.one_sentence(self.extract(*FREE, "--stats", name), 2, "would be written twice")
        self.assertEqual(self.input.read_text(), before)
        with (self.directory / "log.json").open("w") as log:
            result = self.extract("--free-surface", "--stats", "log.json", capture_output=False,
                                  stdout=log, stderr=subprocess.PIPE)
        self.one_sentence(result, 2, "log.json would be written twice: standard output goes there, too")

    def test_no_output_replaces_an_input(self):
        """Tries each option that names an output with each way to name an input. The input is refused as output and stays as it was."""
        at = self.directory
        files.write_gadget(at / "snap.0", self.points, self.arrays, range(500), count=2)
        files.write_gadget(at / "snap.1", self.points, self.arrays, range(500, 1000), count=2)
        files.write_pieces(at / "all.pvtp", ["particles.vtp"])
        files.write_pieces(at / "steps.pvtp", ["particles.vtp#0"])
        files.write_pvd(at / "plain.pvd", [(0, "particles.vtp")])
        files.write_pvd(at / "marked.pvd", [(0, "particles.vtp#0")])
        files.write_pvd(at / "pieces.pvd", [(0, "all.pvtp#0")])
        (at / "many.xyz").write_text("1\n\n0 0 0\n1\n\n0 0 0\n")
        (at / "gauges.txt").write_text("mast=0,0,-1:0,0,1\n")
        (at / "sections.txt").write_text("side=particles.vtp\n")
        (at / "link").symlink_to("particles.vtp")
        gauge = ["--gauge", "a=0,0,-1:0,0,1"]
        sources = [(name, "particles.vtp", []) for name in
                   ("particles.vtp", "./particles.vtp#0", "particles.vtp#3", "link#0", "all.pvtp", "all.pvtp#0", "steps.pvtp", "plain.pvd",
                    "marked.pvd", "pieces.pvd")]
        sources += [("many.xyz#1", "many.xyz", []), ("snap.0", "snap.1", []), ("snap.0#0", "snap.1", []), ("marked.pvd", "marked.pvd", [])]
        sources += [("other.vtp", read, [option, name]) for option, name, read in
                    (("--walls", "particles.vtp", "particles.vtp"), ("--walls", "particles.vtp#0", "particles.vtp"), ("--walls", "snap.0#0", "snap.1"),
                     ("--probe", "particles.vtp", "particles.vtp"), ("--gauges", "gauges.txt", "gauges.txt"),
                     ("--fluxes", "sections.txt", "sections.txt"), ("--fluxes", "sections.txt", "particles.vtp"),
                     ("--flux", "a=particles.vtp", "particles.vtp"))]
        files.write_vtp(at / "other.vtp", self.points, self.arrays)
        film = ["film.pvd", *FREE]
        surfaces = [(".vtp", ["OUT", *FREE]), (".json", ["s.vtp", *FREE, "--stats", "OUT"]), (".csv", ["s.vtp", *FREE, "--components", "OUT"]),
                    (".vtp", ["s.vtp", *FREE, "--widen", "2", "--widening", "OUT"]), (".png", ["s.vtp", *FREE, "--screenshot", "OUT"])]
        films = [(".pvd", ["OUT", *FREE]), ("_0000.vtp", film), ("_0000.ply", ["film_%04d.ply", *FREE]), (".csv", [*film, "--numbers", "OUT"]),
                 (".csv", [*film, "--components", "OUT"]), (".json", [*film, "--stats", "OUT"]), ("_0000.png", [*film, "--screenshot", "film_%04d.png"]),
                 (".pvd", ["OUT", "--project", "z"])]
        fields = [(".vti", ["OUT", "--slice", "z=0"]), (".vtp", ["OUT", "--line", "0,0,0,1,0,0"]), (".vti", ["OUT", "--project", "z"]),
                  (".png", ["o.vti", "--project", "z", "--screenshot", "OUT"])]
        tables = [(".csv", ["OUT", *gauge]), (".vti", ["OUT", "--gauge-grid", "2,2:0,1,0,1,0,1"]), (".csv", ["OUT", "--flux", "a=0,0,0:1,0,0:0,1,0"])]
        own = {"--probe": [(".vtp", ["OUT"])], "--gauges": [(".csv", ["OUT"]), (".csv", [*film, "--numbers", "OUT"]),
                                                          (".csv", [*film, "--numbers", "n.csv", "--components", "OUT"]),
                                                          (".json", [*film, "--numbers", "n.csv", "--stats", "OUT"])],
               "--fluxes": [(".csv", ["OUT"])], "--flux": [(".csv", ["OUT"])]}
        number = 0
        for source, read, more in sources:
            is_list = source.endswith(".pvd")
            outputs = own.get(more[0] if more else "", (films if is_list else surfaces + films + fields) + tables)
            before = (at / read).read_bytes()
            for ending, command in outputs:
                with self.subTest(source, read=read, more=more, command=command):
                    number += 1
                    out = at / f"out{number}{ending}" if "OUT" in command else at / f"film{ending}"
                    out.symlink_to(read)
                    arguments = [str(out) if word == "OUT" else word for word in command]
                    result = self.run_program(source, *arguments, *more)
                    self.assertIn(f"{out.name} would overwrite", result.stderr)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertEqual((at / read).read_bytes(), before)
                    out.unlink()

    def test_names_for_xml(self):
        """Unusual names of files, arrays and field data are read back as they were."""
        name = "a<b>&\"c' d"
        points = self.directory / f"{name}.vtp"
        field = f'<FieldData>{files.xml_array(name.replace("&", "&amp;").replace("<", "&lt;").replace(QUOTE, "&quot;"), [1.0])}</FieldData>'
        files.write_vtp(points, self.points[:5], {})
        points.write_text(points.read_text().replace("<PolyData>", "<PolyData>" + field))
        self.run_good(self.input, "o.vtp", "--probe", points)
        root = xml.etree.ElementTree.parse(self.directory / "o.vtp").getroot()
        self.assertTrue(any(each.get("Name") == name for each in root.iter("DataArray")))
        self.run_good(self.input, self.input, f"{name}2.pvd", *FREE)
        listed = xml.etree.ElementTree.parse(self.directory / f"{name}2.pvd").getroot().iter("DataSet")
        names = [each.get("file") for each in listed]
        self.assertEqual(names, [f"{name}2_{i:04d}.vtp" for i in range(2)])
        self.run_good(f"{name}2.pvd", "again.pvd", *FREE, "--smoothing-length", "0.3", says=".*")

    # ---- Whole or untouched ----

    def test_what_may_not_be_written(self):
        """A user without root's rights names an output file that is read-only, or lies in a read-only folder. The run fails,
        and the file stays as it was."""
        self.output.write_text("old")
        self.output.chmod(0o444)
        refused = self.extract(*FREE, preexec_fn=drop_privileges)
        self.one_sentence(refused, 1, "surface.vtp could not be written: Permission denied")
        self.assertEqual((self.output.read_text(), mode_of(self.output)), ("old", 0o444))
        folder = self.directory / "folder"
        folder.mkdir()
        self.output = folder / "surface.vtp"
        self.output.write_text("old")
        folder.chmod(0o555)
        try:
            refused = self.extract(*FREE, preexec_fn=drop_privileges)
        finally:
            folder.chmod(0o755)
        self.one_sentence(refused, 1, r"no file can be created in the folder .*folder \(Permission denied")
        self.assertEqual(self.output.read_text(), "old")

    def test_unreadable_input(self):
        self.input.chmod(0)
        self.refuse(self.extract(*FREE, preexec_fn=drop_privileges), 1,
                    "particles.vtp cannot be read: Permission denied")

    def test_long_names(self):
        self.output = self.directory / ("a" * 251 + ".vtp")
        self.good()
        self.whole(self.output)
        self.output = self.directory / ("a" * 252 + ".vtp")
        self.one_sentence(self.extract(*FREE), 1, "could not be written: File name too long")
        self.output = pathlib.Path("a/" * 3000 + "a.vtp")
        self.one_sentence(self.extract(*FREE), 1, "could not be written: File name too long")
        self.one_sentence(self.extract(*FREE, source="a/" * 3000 + "a.vtp"), 1, "File name too long")

    def test_full_disk(self):
        """Writes an output on a disk that is too small: a file system of `pages` pages, one of which holds an older output."""
        script = """mount -t tmpfs -o size=$1 none full || exit 77
            echo old >full/$2; shift 2; "$@"; status=$?; ls -A full; cat full/*; exit $status"""
        unshare = ["unshare", "--mount"] + (["--map-root-user"] if os.geteuid() else [])
        (self.directory / "full").mkdir()
        for name, pages, option in ("surface.vtp", 8, []), ("s.json", 1, ["--stats", "full/s.json"]), \
                ("p.png", 2, ["--screenshot", "full/p.png"]):
            with self.subTest(name):
                output = "full/surface.vtp" if name == "surface.vtp" else self.output
                command = [self.program, self.input, output, *FREE, *option]
                if name == "p.png":
                    command.insert(0, WITH_DISPLAY)
                result = subprocess.run(
                    [*unshare, "sh", "-c", script, "sh", f"{4 * pages}k", name, *command],
                    cwd=self.directory, capture_output=True, text=True, timeout=1200)
                if "unshare" in result.stderr or result.returncode == 77:
                    self.skipTest("no file system can be mounted here")
                self.one_sentence(result, 1, f"{name} could not be written: No space left on device")
                self.assertEqual(result.stdout, f"{name}\nold\n")

    def test_failing_calls(self):
        for call in ("fsync", "close", "rename"):
            with self.subTest(call):
                self.output.write_text("old")
                result = self.extract(*FREE, env=self.misbehaving(failing_call=call))
                self.one_sentence(result, 1, "surface.vtp could not be written: Input/output error")
                self.assertEqual(self.output.read_text(), "old")

    def test_two_at_once(self):
        expected = set()
        for weight in ("0.3", "0.6"):
            self.good("--iso", weight)
            expected.add(self.whole(self.output))
        self.assertEqual(len(expected), 2)
        runs = [subprocess.Popen([self.program, self.input, self.output, *FREE, "--iso", weight],
                                 env=self.misbehaving(rename_seconds=1), stderr=subprocess.PIPE)
                for weight in ("0.3", "0.6")]
        self.assertEqual([(run.communicate()[1], run.returncode) for run in runs], [(b"", 0)] * 2)
        self.assertIn(self.whole(self.output), expected)

    def start_and_wait_for_writing(self, **options):
        run = subprocess.Popen([self.program, self.input, self.output, *FREE], text=True,
                               env=self.misbehaving(rename_seconds=1000, takes_hangups=1),
                               stderr=subprocess.PIPE, **options)
        self.addCleanup(run.kill)
        while not any(p.name.startswith(".") and p.stat().st_size > 0
                      for p in self.directory.iterdir()):
            self.assertIsNone(run.poll())
            time.sleep(0.05)
        return run

    def test_signals(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number):
                self.output.write_text("old")
                # The program gets the default signal handlers, even if the tests run under nohup or in a script's
                # background.
                run = self.start_and_wait_for_writing(
                    start_new_session=True, preexec_fn=lambda number=number: signal.signal(number, signal.SIG_DFL))
                os.killpg(run.pid, number)  # This is what a terminal does on Ctrl-C.
                self.assertEqual((run.communicate()[1], run.returncode), ("", -number))
                self.assertEqual(self.output.read_text(), "old")
                self.tearDown()

    def test_nohup(self):
        run = self.start_and_wait_for_writing(
            preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        run.send_signal(signal.SIGHUP)
        run.terminate()
        self.assertEqual((run.communicate()[1], run.returncode), ("", -signal.SIGTERM))  # SIGTERM ended the run, not the hangup.
        self.assertFalse(self.output.exists())


if __name__ == "__main__":
    main()
