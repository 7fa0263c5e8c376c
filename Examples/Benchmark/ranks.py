#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What processes exchange that share a surface, and what they would on larger data.

    ranks.py PROGRAM FOLDER [--sets tank:50k,tank:200k] [--ranks 2,4,8] [--options "--free-surface"]

Makes the sets in the folder, runs the program under mpirun and prints per rank: particles owned, copies of
others', bytes sent, nodes evaluated, of boxes with as many particles each, and of boxes with as much expected
work. Then a model, fitted to the first ones: the particles fill a box, which is halved across its longest side
until each rank has one. Copies lie in shells, so many particle distances deep, on all sides of a rank's box
that are not the whole's. Surface work is the area that a box has of the whole's surface. Bytes are those of
the particles that travel, all but one in as many as there are ranks, and of their copies.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
import tempfile

import sets

ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
               "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}


def run(program, particles, options, ranks):
    with tempfile.TemporaryDirectory() as folder:
        statistics = os.path.join(folder, "s.json")
        subprocess.run(["mpirun", "-n", str(ranks), program, particles, os.path.join(folder, "o.pvtp"), "--quiet",
                        "--stats", statistics, *options], env={**os.environ, **ENVIRONMENT}, check=True,
                       timeout=900, stderr=subprocess.DEVNULL)
        with open(statistics, encoding="utf-8") as stream:
            return json.load(stream)["statistics"]


def excess(values):
    """Of the busiest rank, over the mean."""
    return max(values) * len(values) / max(sum(values), 1)


class Model:
    """Particles in a box of these side lengths, halved across its longest side; lengths are distances of
    particles."""

    def __init__(self, count, shape, ranks):
        scale = (count / (shape[0] * shape[1] * shape[2])) ** (1 / 3)
        self.whole = [scale * side for side in shape]
        self.sides, self.parts, self.ranks = list(self.whole), [1, 1, 1], ranks
        while self.parts[0] * self.parts[1] * self.parts[2] < ranks:
            longest = max(range(3), key=lambda a: self.sides[a])
            self.sides[longest] /= 2
            self.parts[longest] *= 2
        self.each = count / ranks

    def copies(self, depth):
        """Mean: a side along an axis cut into p parts has neighbours with 1 - 1/p of probability."""
        grown = 1
        for side, parts in zip(self.sides, self.parts):
            grown *= side + 2 * depth * (1 - 1 / parts)
        return grown - self.each

    def most_copies(self, depth):
        grown = 1
        for side, parts in zip(self.sides, self.parts):
            grown *= side + depth * min(parts - 1, 2)
        return grown - self.each

    @staticmethod
    def area(sides):
        return sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0]

    def surface(self):
        """Mean of a rank, and that of a box in a corner."""
        corner = 0
        for a in range(3):
            corner += self.sides[a - 1] * self.sides[a - 2] * (2 if self.parts[a] == 1 else 1)
        return 2 * self.area(self.whole) / self.ranks, corner


def fit_depth(runs):
    """The depth whose copies are, over all runs, those that were measured."""
    low, high = 0.0, 100.0
    measured = sum(sum(found["rank_copies"]) for _, found in runs)
    for _ in range(60):
        middle = (low + high) / 2
        copies = sum(model.copies(middle) * model.ranks for model, _ in runs)
        low, high = (middle, high) if copies < measured else (low, middle)
    return low


def travelling(model, found):
    """Particles that were sent: from one file, all that the first rank does not own, and all copies."""
    return sum(found["rank_particles"]) * (1 - 1 / model.ranks) + sum(found["rank_copies"])


def measure(arguments):
    folder = sets.Folder(arguments.folder)
    options, runs = shlex.split(arguments.options), []
    print("| particles | ranks | copies per rank | most | model | MB sent, all | nodes, busiest / mean | by work |")
    print("|---|---|---|---|---|---|---|---|")
    rows = []
    for word in arguments.sets.split(","):
        kind, size = word.split(":")
        which = getattr(sets, kind)(sets.count_of(size))
        path = str(folder.get(which))
        bounds = sets.read(path).GetBounds()
        shape = [bounds[2 * a + 1] - bounds[2 * a] for a in range(3)]
        for ranks in (int(number) for number in arguments.ranks.split(",")):
            found = run(arguments.program, path, [*which.options, *options, "--partition", "particles"], ranks)
            by_work = run(arguments.program, path, [*which.options, *options], ranks)
            runs.append((Model(sum(found["rank_particles"]), shape, ranks), found))
            rows.append((ranks, found, by_work))
            print(word, ranks, file=sys.stderr)
    depth = fit_depth(runs)
    for (ranks, found, by_work), (model, _) in zip(rows, runs):
        copies = found["rank_copies"]
        print(f"| {sum(found['rank_particles'])} | {ranks} | {sum(copies) / ranks:.0f} | {max(copies)} | "
              f"{model.copies(depth):.0f} | {sum(found['rank_bytes_sent']) / 1e6:.1f} | "
              f"{excess(found['rank_nodes_evaluated']):.2f} | {excess(by_work['rank_nodes_evaluated']):.2f} |")
    return runs, depth, shape


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--sets", default="tank:50k,tank:200k")
    parser.add_argument("--ranks", default="2,4,8")
    parser.add_argument("--options", default="--free-surface")
    arguments = parser.parse_args()
    runs, depth, shape = measure(arguments)
    sent = sum(sum(found["rank_bytes_sent"]) for _, found in runs) / sum(travelling(*pair) for pair in runs)
    nodes = (sum(sum(found["rank_nodes_evaluated"]) for _, found in runs) /
             sum(model.surface()[0] * model.ranks for model, _ in runs))
    print(f"\nshells {depth:.2f} distances deep, {sent:.0f} bytes for each particle that travels, {nodes:.1f} nodes on "
          "each square distance of surface\n")
    print("| particles | ranks | per rank | copies per rank | most | copies / particles | MB sent per rank | nodes per rank | "
          "busiest / mean |")
    print("|---|---|---|---|---|---|---|---|---|")
    for total in (10**7, 10**9):
        for ranks in (1, 8, 64, 512, 1024):
            model = Model(total, shape, ranks)
            copies = model.copies(depth) if ranks > 1 else 0
            mean, most = model.surface()
            moved = model.each * (1 - 1 / ranks) + copies  # none lies where it belongs
            print(f"| {sets.text_of(total)} | {ranks} | {model.each:.3g} | {copies:.3g} | {model.most_copies(depth) if ranks > 1 else 0:.3g} | "
                  f"{copies / model.each:.2f} | {moved * sent / 1e6:.3g} | {mean * nodes:.3g} | {most / mean:.1f} |")


if __name__ == "__main__":
    main()
