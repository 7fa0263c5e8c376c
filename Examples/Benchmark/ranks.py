#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What processes exchange that share a surface, and what they would on larger data.

    ranks.py PROGRAM PARTICLES [--ranks 2,4,8] [--options "--free-surface"]

Runs the program under mpirun and prints per rank: particles owned, copies of others', bytes sent, nodes
evaluated, triangles. Then a model, fitted to these runs: a box of n particles has copies in a shell, so
many deep (d particles' distances): copies = (n^(1/3) + 2 d)^3 - n. Bytes sent are those of n + copies,
when all particles leave their place. Surface work goes with n^(2/3) where the surface is as smooth as the
box is wide; the model takes it from the runs.
"""

import argparse
import json
import os
import shlex
import subprocess
import tempfile

ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


def run(program, particles, options, ranks):
    with tempfile.TemporaryDirectory() as folder:
        statistics = os.path.join(folder, "s.json")
        subprocess.run(["mpirun", "-n", str(ranks), program, particles, os.path.join(folder, "o.pvtp"), "--quiet",
                        "--stats", statistics, *options], env={**os.environ, **ENVIRONMENT}, check=True,
                       timeout=900)
        with open(statistics, encoding="utf-8") as stream:
            return json.load(stream)["statistics"]


def depth_of(owned, copies):
    """How deep the shell is that has so many copies, in distances of particles."""
    return ((owned + copies) ** (1 / 3) - owned ** (1 / 3)) / 2


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("particles")
    parser.add_argument("--ranks", default="2,4,8")
    parser.add_argument("--options", default="--free-surface")
    arguments = parser.parse_args()
    depths, bytes_each, shares = [], 0, []
    print("| ranks | particles per rank | copies per rank | MB sent, most | nodes: most / mean | triangles: most / mean |")
    print("|---|---|---|---|---|---|")
    for ranks in (int(word) for word in arguments.ranks.split(",")):
        found = run(arguments.program, arguments.particles, shlex.split(arguments.options), ranks)
        owned, copies = found["rank_particles"], found["rank_copies"]
        nodes, triangles = found["rank_nodes_evaluated"], found["rank_triangles"]
        print(f"| {ranks} | {min(owned)} to {max(owned)} | {min(copies)} to {max(copies)} | "
              f"{max(found['rank_bytes_sent']) / 1e6:.1f} | {max(nodes) * ranks / sum(nodes):.2f} | "
              f"{max(triangles) * ranks / max(sum(triangles), 1):.2f} |")
        depths += [depth_of(o, c) for o, c in zip(owned, copies) if o > 0]
        # One file: the first rank sends nearly all; 24 bytes a point are keys and numbers.
        bytes_each = max(bytes_each, max(found["rank_bytes_sent"]) / (sum(owned) * (ranks - 1) / ranks))
        shares.append(max(nodes) * ranks / sum(nodes))
    # Boxes at the surface have fewer neighbours than those within: the deepest shell is that of the latter.
    depth = max(depths)
    print(f"\nshell {depth:.2f} distances deep, at most {bytes_each:.0f} bytes a particle, "
          f"nodes of the busiest rank up to {max(shares):.2f} times the mean\n")
    print("| particles | ranks | per rank | copies per rank | copies / particles | MB sent per rank |")
    print("|---|---|---|---|---|---|")
    for total in (10**7, 10**9):
        for ranks in (1, 8, 64, 512, 1024):
            each = total / ranks
            copies = (each ** (1 / 3) + 2 * depth) ** 3 - each if ranks > 1 else 0
            sent = (each + copies) * bytes_each / 1e6 if ranks > 1 else 0
            print(f"| {total:.0e} | {ranks} | {each:.3g} | {copies:.3g} | {copies / each:.2f} | {sent:.3g} |")


if __name__ == "__main__":
    main()
