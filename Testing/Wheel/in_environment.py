# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a test in the environment that build_wheel.py made, away from the sources.

    in_environment.py FOLDER TEST [ARGUMENT]...
"""
import subprocess
import sys
from pathlib import Path

python = Path(sys.argv[1]) / "venv" / "bin" / "python"
if not list((Path(sys.argv[1])).glob("dist/*.whl")):
    print("Skipped: no wheel was built; wheel.build tells why.")
    sys.exit(77)
sys.exit(subprocess.run([python, *sys.argv[2:]], cwd=sys.argv[1]).returncode)
