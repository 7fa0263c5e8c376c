# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tries every option of the program in every mode: the option changes the outputs, or one error message refuses it.

test_modes.py PROGRAM PRELOAD [unittest arguments]; writes options_in_modes.csv, a row for each option and a column for each
mode, to the folder that it runs in.
"""
import collections
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import re

import particle_files as files
from command_line_test import CommandLineTest, main

OPTIONS = pathlib.Path(__file__).parents[2] / "Examples" / "CommandLine" / "options"
BOX = "-0.15,0.15,-0.4,0.4,-0.4,0.02"
# For each mode: input files, an output file, and the options that a plain command line needs.
MODES = {
    "surface": (["step_0.vtp"], "out.vtp", {"--scalar": "Radius", "--iso": "0.3"}),
    "film": (["step_0.vtp", "step_1.vtp"], "out.pvd", {"--scalar": "Radius", "--iso": "0.3"}),
    "gauge": (["step_0.vtp", "step_1.vtp"], "out.csv", {"--gauge": ["a=-1,0.01,0:1,0.01,0"]}),
    "flux": (["step_0.vtp", "step_1.vtp"], "out.csv", {"--flux": ["a=disc:0.17,0,0:1,0,0:0.6"]}),
    "slice": (["step_0.vtp"], "out.vti", {"--slice": "z=0.01", "--resolution": "20"}),
    "line": (["step_0.vtp"], "out.vtp", {"--line": "-0.5,0.1,0,0.5,0,0", "--resolution": "20"}),
    "probe": (["step_0.vtp"], "out.vtp", {"--probe": "points.vtp"}),
    "project": (["step_0.vtp"], "out.vti", {"--project": "z", "--resolution": "20"})}
FREE = {"--scalar": None, "--iso": None, "--free-surface": ""}
SOLIDS, NOISE = {"--fluid": "Kind=0"}, {"--scalar": "Noise", "--iso": "0.1", "--cube-factor": "1"}
PIECES, STEPS = {"--components": "pieces.csv"}, ["step_0.vtp", "step_1.vtp"]
PICTURE = {"--screenshot": "p.png"}


class Trial(collections.namedtuple("Trial", "value context extra output inputs", defaults=("", {}, {}, None, None))):
    """How an option is tried. value: the option's value. context: {other option: value} of both runs, with the option and without. extra:
    {other option: value} of the run with the option; None takes the other option away. output, inputs: files in place of the mode's."""


# How each option is tried. In each mode, options of `context` that do not act in the mode are left out.
TRIALS = {
    "--scalar": Trial("Noise"), "--component": Trial("0", {"--scalar": "Velocity", "--iso": "0.02"}), "--iso": Trial("0.25"),
    "--free-surface": Trial("", {}, FREE), "--derive": Trial("Velocity"), "--field": Trial("sum"), "--probe": Trial("others.vtp"),
    "--slice": Trial("z=0.1"), "--line": Trial("-0.5,0,0.1,0.5,0,0"), "--resolution": Trial("9"), "--project": Trial("x"),
    "--weighted-by": Trial("Noise", {"--scalar": "Radius"}), "--gauge": Trial("b=0.1,0,-1:0.1,0,1", {"--numbers": "n.csv"}),
    "--gauges": Trial("gauges.txt", {"--numbers": "n.csv"}), "--flux": Trial("b=disc:0,0,0:1,0,0:0.2"),
    "--gauge-grid": Trial("3,3:-1,1,-1,1,-1,1", {}, {"--gauge": None}), "--fluxes": Trial("sections.txt"),
    "--velocity": Trial("Spin"), "--smoothing-length": Trial("0.2"), "--dp": Trial("0.08"), "--coefh": Trial("1.3", {"--dp": "0.1"}),
    "--support-radius": Trial(), "--volume": Trial("Space"), "--mass": Trial("0.5"), "--density": Trial("2000"),
    "--fluid": Trial("Kind=0"), "--within": Trial("-0.2,1,-1,1,-1,1"), "--only": Trial("Kind=0"), "--walls": Trial("walls.vtp"),
    "--solids": Trial("ignore", SOLIDS), "--wall-share": Trial("0.7", SOLIDS), "--kernel": Trial("wendland"),
    "--dimension": Trial("2"), "--h-scale": Trial("0.8"), "--cube-factor": Trial("0.7"), "--cube-size": Trial("0.05"),
    "--cubes": Trial("uniform"), "--max-level": Trial("0"), "--box": Trial(BOX), "--periodic": Trial("1,1,1"),
    "--capping": Trial("", {"--box": BOX}), "--filled": Trial(""), "--seeds": Trial("pairs", {"--cubes": "uniform", "--stats": "s.json", **NOISE}),
    "--smooth": Trial(), "--widen": Trial("2"), "--widening": Trial("w.vtp", {"--widen": "2"}), "--compact": Trial(),
    "--topology": Trial("field", NOISE), "--tolerance": Trial("0.1"), "--iteration-limit": Trial("1", NOISE), "--preview": Trial(),
    "--node-threshold": Trial("0.9"), "--boundary": Trial("eigenvalue", {"--iso": "0.4"}), "--vertex-threshold": Trial("0.95"),
    "--precision": Trial("double"), "--weight-sum": Trial(), "--boundary-eigenvalue": Trial(), "--curvature": Trial(),
    "--gradients": Trial(), "--attributes": Trial("Kind"), "--no-attributes": Trial(), "--output-precision": Trial("single"),
    "--components": Trial("pieces.csv"), "--least-volume": Trial("100", {**FREE, **PIECES}),
    "--least-particles": Trial("100000", {**FREE, **PIECES}),
    "--numbers": Trial("n.csv"), "--times": Trial("0,0.5"), "--ids": Trial("Tag", {"--times": "0.5"}), "--time-step": Trial("0.5"),
    "--fps": Trial("4"), "--slow": Trial("2", {"--fps": "2"}), "--verbose": Trial(), "--stats": Trial("s.json"), "--repeat": Trial("2"), "--quiet": Trial(), "--screenshot": Trial("p.png"),
    "--color-by": Trial("Noise", PICTURE), "--color-range": Trial("0.1,0.2", {**PICTURE, "--color-by": "Noise"}),
    "--up": Trial("x", PICTURE), "--view": Trial("1,2,3", PICTURE), "--device": Trial("nonesuch"), "--threads": Trial("1"),
    "--memory-limit": Trial("1", {"--cube-size": "0.01"})}
FILM_PICTURE = {"--screenshot": "p_%04d.png"}
# Trials for each (option, mode) in which the option's trial in TRIALS would not work.
OTHER_TRIALS = {
    ("--gauge-grid", "gauge"): TRIALS["--gauge-grid"]._replace(output="out.vti", inputs=["step_0.vtp"]),
    ("--derive", "project"): Trial("Velocity", {}, {"--scalar": "Divergence"}),
    ("--filled", "surface"): Trial("", inputs=["flat.vtp"]), ("--filled", "film"): Trial("", inputs=["flat.vtp"]),
    ("--walls", "flux"): Trial("walls.vtp", {"--flux": ["a=disc:0.33,0,0:1,0,0:0.6"]}),
    ("--screenshot", "film"): Trial("p_%04d.png"),
    **{(option, "film"): TRIALS[option]._replace(context={**TRIALS[option].context, **FILM_PICTURE})
       for option in ("--color-by", "--color-range", "--up", "--view")},
    ("--color-by", "project"): Trial("WeightSum", {"--scalar": "Radius", **PICTURE}),
    ("--color-range", "project"): Trial("0.1,0.2", PICTURE), ("--iteration-limit", "slice"): Trial("1"),
    ("--memory-limit", "gauge"): TRIALS["--gauge-grid"]._replace(
        value="1", extra={"--gauge-grid": "300,300:-1,1,-1,1,-1,1", "--gauge": None}, output="out.vti", inputs=["step_0.vtp"]),
    ("--memory-limit", "slice"): Trial("1", {}, {"--resolution": "300"}), ("--memory-limit", "line"): Trial("1", {}, {"--resolution": "32000"}),
    ("--memory-limit", "probe"): Trial("1", {}, {"--probe": "many.vti"}, "out.vti"),
    ("--memory-limit", "project"): Trial("1", {"--scalar": "SmoothingLength"}, inputs=["many.vtp"]),
    ("--precision", "project"): Trial("double", {"--scalar": "Radius"}, inputs=["bare.vtp"]),
    ("--volume", "project"): Trial("Space", {"--scalar": "Radius"}), ("--density", "project"): Trial("Space", {"--scalar": "Radius"}),
    **{(option, mode): TRIALS[option]._replace(inputs=["bare.vtp"], context={**TRIALS[option].context, **(
        {"--scalar": "Radius"} if mode == "project" else {})}) for option in ("--walls", "--solids")
       for mode in ("slice", "line", "probe", "project")},
    **{(option, mode): TRIALS[option]._replace(inputs=STEPS, output=output)
       for option in ("--times", "--ids", "--time-step", "--fps", "--slow")
       for mode, output in (("project", "out.pvd"), ("probe", "out.csv"))}}
QUESTIONS = {"--list-devices", "--list-arrays", "--help", "--version"}  # these need no mode
# (option, mode) whose outputs must be the same with and without the option: the option's effect is there anyway, or
# the option changes nothing but the time.
HOLDS = {("--free-surface", "gauge"), *(("--weight-sum", mode) for mode in ("slice", "line", "probe")),
         *(("--threads", mode) for mode in MODES)}


def numbers_of(report):
    """Returns the statistics of a --stats report. If the report has steps, returns a list of each step's statistics."""
    if isinstance(report, list):
        return [numbers_of(each) for each in report]
    return report.get("statistics") or numbers_of(report.get("steps", []))


def parameters_of(report):
    """Returns {parameter: value} of all groups of a report."""
    return {name: value for group in ("parameters", "arrays", "fluid") for name, value in (report.get(group) or {}).items()}


def is_shown(option, value, report, base):
    """Returns whether the report shows the option. A parameter with a name like the option's must have changed. If the option's value is a
    word, the parameter must now have this value; if it is a number, this value or a text, such as an array's name. Returns True if there
    is no such parameter, or if the reports are equal."""
    found, before = parameters_of(report), parameters_of(base)
    changed = {name for name in {**found, **before} if found.get(name) != before.get(name)}
    mine = {name for name in {**found, **before} if any(part.startswith(option[2:].split("-")[0][:5]) for part in name.split("_"))}
    values = [each for name in changed & mine for each in (found[name] if isinstance(found.get(name), list) else [found.get(name)])]
    number = re.fullmatch(r"[\d.]+", value)
    if not mine or not changed or not number and not re.fullmatch("[a-z_]+", value):
        return not mine or bool(values) or not changed
    return any(each == value or number and (isinstance(each, str) or each == float(value)) for each in values)


class Modes(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.points, self.arrays = files.lattice(8)
        count = len(self.points)
        self.arrays.update({
            "SmoothingLength": [0.13 if p[0] < 0.1 else 0.27 for p in self.points], "Idp": list(range(count)),
            "Velocity": [tuple(0.1 * x for x in p) for p in self.points], "Spin": [(p[1] - 1, 0.0, 0.5) for p in self.points],
            "Tag": list(range(count - 1, -1, -1)), "Space": [0.0008] * count,
            "Noise": [math.sin(12.9898 * i * i + 78.233 * i) for i in range(count)]})
        for step in range(2):
            self.arrays["Tag"].reverse()
            files.write_vtp(self.directory / f"step_{step}.vtp",
                            [tuple(x + 0.1 * x * step for x in p) for p in self.points], self.arrays)
        # Without masses and densities, volumes are computed.
        bare = {name: values for name, values in self.arrays.items() if name not in ("Mass", "Density")}
        files.write_vtp(self.directory / "bare.vtp", self.points, bare)
        files.write_image(self.directory / "many.vti", "0 99 0 99 0 9", "-0.5 -0.5 -0.5", "0.01 0.01 0.1")
        many = files.lattice(36)[0]
        (self.directory / "many.vtp").write_bytes(files.xml(many, {"SmoothingLength": [0.13] * len(many)}, form="inline"))
        flat, arrays = self.in_plane()
        del arrays["Mass"]
        files.write_vtp(self.directory / "flat.vtp", [(x, y, 0.0) for x, y, _ in flat], arrays)
        beside = [(x + 0.8, y, z) for x, y, z in self.points if x < -0.1]
        files.write_vtp(self.directory / "walls.vtp", beside, {
            "SmoothingLength": [0.13] * len(beside), "Mass": [1.0] * len(beside), "Density": [1000.0] * len(beside)})
        files.write_vtp(self.directory / "points.vtp", [(0.04 * i - 0.3, 0.02, 0.03) for i in range(20)], {})
        files.write_vtp(self.directory / "others.vtp", [(0.04 * i - 0.3, 0.1, 0.03) for i in range(20)], {})
        (self.directory / "gauges.txt").write_text("c=0,0.1,-1:0,0.1,1\n")
        (self.directory / "sections.txt").write_text("c=disc:0,0.1,0:1,0,0:0.1\n")
        self.runs = {}

    def run_once(self, key):
        """Runs the program for a key (inputs, output, options). Returns the exit status, standard error, all that the
        run writes and prints except times, and the report's parameters."""
        inputs, output, options = key
        folder = self.directory / f"run_{len(os.listdir(self.directory))}_{abs(hash(key))}"
        folder.mkdir()
        for name in os.listdir(self.directory):
            if "." in name:
                (folder / name).symlink_to(self.directory / name)
        words = [word for option, value in options for word in ([option, value] if value else [option])]
        result = self.run_program(*inputs, output, *words, cwd=folder)
        # The parameters in a report differ even if an option has no effect, so only the statistics are compared.
        written = {path.name: path.read_bytes() for path in folder.iterdir() if not path.is_symlink() and path.suffix != ".json"}
        reports = {path.name: json.loads(path.read_text()) for path in folder.glob("*.json")}
        written.update((name, numbers_of(report)) for name, report in reports.items() if name != "parameters.json")
        told = "\n".join(line.split(" ")[0] if re.match("seconds|device|memory|program", line) else re.sub(r"[\d.]+ s$", "", line)
                         for line in result.stdout.splitlines())
        return result.returncode, result.stderr, (written, told), reports.get("parameters.json", {})

    def acting(self):
        """Returns {mode: options}, as --help lists them."""
        names = {mode: re.findall(r"(?m)^  (--[\w-]+)", self.run_good("--help", mode).stdout) for mode in (*MODES, "all")}
        self.assertEqual(set(names["all"]), set(TRIALS) | QUESTIONS)
        return {mode: set(names[mode]) for mode in MODES}

    def key(self, mode, trial, option=None):
        """Returns the key of the run with the option, or without it."""
        inputs, output, base = MODES[mode]
        report = {"--stats": "parameters.json"} if mode == "surface" else {}
        options = {**report, **base, **{name: value for name, value in trial.context.items() if name in self.help[mode]}}
        if option:
            options.update(trial.extra if option in self.help[mode] else {})
            options[option] = [*options.get(option, []), trial.value] if option in ("--gauge", "--flux") else trial.value
        flat = [(name, each) for name, value in options.items() if value is not None
                for each in (value if isinstance(value, list) else [value])]
        is_other = option or not trial.extra
        return (tuple(trial.inputs or inputs) if is_other else tuple(inputs), trial.output or output if is_other else output,
                tuple(flat))

    @staticmethod
    def makes_mode(option):
        return option == "--numbers" or any(option in base and option not in ("--scalar", "--iso", "--resolution")
                                            for _, _, base in MODES.values()) or option in ("--gauges", "--gauge-grid", "--fluxes")

    def judge(self, option, mode, trial):
        """Judges an option in a mode. Returns two texts: what the option does, and what is wrong with it."""
        status, said, written, report = self.runs[self.key(mode, trial, option)]
        base_status, base_said, base, base_report = self.runs[self.key(mode, trial)]
        if base_status != 0:
            return "?", f"fails without it: {base_said}"
        if option not in self.help[mode]:
            sentence = rf"^marching-correctors: {option} is for [\w, ]+, not for \w+; leave it out.*\n$"
            if self.makes_mode(option):  # The option chooses another mode, in which options of this one do not act.
                sentence = r"^marching-correctors: .*\n$"
            good = status == 2 and re.match(sentence, said) and not written[0]
            return "refused", "" if good else f"is not in --help {mode}, but {status} {said}"
        if status == 0 and not is_shown(option, trial.value, report, base_report):
            return "acts", "but the report has another parameter than the option's"
        if status == 0 and ((option, mode) in HOLDS) == (written == base):
            return "holds" if written == base else "acts", ""
        if status == 1 and all(line.startswith("marching-correctors: ") for line in said.splitlines()):
            return "acts (" + said.splitlines()[0].partition(": ")[2] + ")", ""
        return "?", said or "does nothing"

    def test_the_guide_says_it(self):
        """The table in parameters.md has a mark for an option and a mode exactly where --help MODE lists the option."""
        acting = self.acting()
        page = (pathlib.Path(__file__).parents[2] / "Documentation" / "Guide" / "parameters.md").read_text(encoding="utf-8")
        rows = re.findall(r"(?m)^\| (`--.*?) \|((?: [x ]? ?\|){8})$", page)
        said = {option: [cell.strip() for cell in cells.split("|")[:-1]] for names, cells in rows for option in re.findall("--[\\w-]+", names)}
        listed = {option: ["x" * (option in acting[mode]) for mode in MODES] for option in TRIALS}
        self.assertEqual(said, listed)

    def test_options_that_exclude_each_other(self):
        """If two options have a row in Exclusions (Job.cxx), the program refuses them together, and its error names both,
        whichever comes first on the command line."""
        pairs = re.findall(r'\n  \{ "(--[\w-]+)", "(--[\w-]+)", ', (OPTIONS / "Job.cxx").read_text(encoding="utf-8"))
        self.assertGreater(len(pairs), 9)
        for first, second in pairs:
            words = [f"{option}={TRIALS[option].value}".rstrip("=") for option in (first, second)]
            for order in (words, words[::-1]):
                with self.subTest(order):
                    self.one_sentence(self.run_program(*STEPS, "out.pvd", *order), 2, f"{first} and {second} exclude each other: .*; leave out one")

    def test_what_options_need(self):
        """If the command line lacks what an option needs (see the option's row in Options.def), the error names what is missing."""
        text = (OPTIONS / "Options.def").read_text(encoding="utf-8")
        rows = re.findall(r'\nOPTION\("(--[\w-]+)",\s*"[^"]*",\s*(?:"[^"]*"\s*)+,\s*([A-Z_ |]+),\s*"([^"]+)",', text)
        self.assertGreater(len(rows), 15)
        for option, modes, needs in rows:
            with self.subTest(option):
                words = [word for word in (option, TRIALS[option].value) if word]
                result = self.run_program(*STEPS[:1 + ("SERIES" in modes)], "out.pvd" if "SERIES" in modes else "out.vtp", "--free-surface", *words)
                self.one_sentence(result, 2, rf"{option} needs {needs.replace('|', ' or ')}; add .*, or leave out {option}")

    def test_every_option_in_every_mode(self):
        self.help = self.acting()
        trials = {(option, mode): OTHER_TRIALS.get((option, mode), trial) for option, trial in TRIALS.items() for mode in MODES}
        keys = {self.key(mode, trial, each) for (option, mode), trial in trials.items() for each in (None, option)}
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            self.runs = dict(zip(keys, pool.map(self.run_once, keys)))
        found = {cell: self.judge(*cell, trial) for cell, trial in trials.items()}
        with open("options_in_modes.csv", "w", newline="", encoding="utf-8") as table:
            csv.writer(table).writerows([["option", *MODES], *([option, *(" ".join(filter(None, found[option, mode])) for mode in MODES)]
                                                               for option in TRIALS)])
        for (option, mode), (_, wrong) in found.items():
            with self.subTest(option, mode=mode):
                self.assertEqual(wrong, "")


if __name__ == "__main__":
    main(display=True)
