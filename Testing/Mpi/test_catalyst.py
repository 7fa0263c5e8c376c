#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the Catalyst script beside the stand-in simulation: several processes must write what one process writes.

    test_catalyst.py MPIRUN EXAMPLES RANKS      (PYTHONPATH: as the simulation needs it)
"""
import os
import subprocess
import sys
import tempfile

from particle_pieces import difference, read

MPIRUN, EXAMPLES, RANKS = sys.argv[1:4]
STEPS = 4
SECONDS = 400


def run(folder, *launcher):
    os.mkdir(folder)
    command = [*launcher, sys.executable, os.path.join(EXAMPLES, "simulation.py"),
               os.path.join(EXAMPLES, "extract_surfaces.py"), str(STEPS)]
    done = subprocess.run(command, env={**os.environ, "MCOR_EXTRACTS": folder, "MCOR_PLUGIN": os.environ["MCOR_TEST_PLUGIN"]},
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=SECONDS, check=False)
    print(done.stdout, done.stderr)
    assert done.returncode == 0, done.returncode
    return sorted(name for name in os.listdir(folder) if name.endswith(".pvtp"))


def main():
    with tempfile.TemporaryDirectory() as folder:
        alone, ranks = os.path.join(folder, "alone"), os.path.join(folder, "ranks")
        names = run(alone)
        assert names == ["surface_0000.pvtp", "surface_0002.pvtp"], names
        assert run(ranks, MPIRUN, "-n", RANKS) == names
        sizes = set()
        for name in names:
            one, union = read(os.path.join(alone, name)), read(os.path.join(ranks, name))
            sizes.add(one.GetNumberOfPolys())
            assert one.GetNumberOfPolys() > 5000, one.GetNumberOfPolys()
            assert len(os.listdir(os.path.join(ranks, name[:-5]))) == int(RANKS)
            problem = difference(union, one)
            assert not problem, (name, problem)
        assert len(sizes) == len(names)  # The particles move.


main()
