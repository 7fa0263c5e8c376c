# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a test in the environment that build_wheel.py made, away from the sources.

    in_environment.py FOLDER [--with "PACKAGE PACKAGE ..."] TEST [ARGUMENT]...
--with: packages that only this test needs; they are installed into their own folder.
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"
SKIPPED = 77

folder, words = Path(sys.argv[1]), sys.argv[2:]
python = folder / "venv" / "bin" / "python"
if not list(folder.glob("dist/*.whl")):
    print("Skipped: no wheel was built; wheel.build tells why.")
    sys.exit(SKIPPED)
with tempfile.TemporaryDirectory() as more:
    if words[0] == "--with":
        if os.path.exists(CERTIFICATES):
            os.environ.setdefault("PIP_CERT", CERTIFICATES)
        pip = [python, "-m", "pip", "--disable-pip-version-check", "install", "-q", "--target", more]
        if subprocess.run([*pip, *words[1].split()]).returncode:
            print("Skipped: the packages cannot be installed.")
            sys.exit(SKIPPED)
        os.environ["PYTHONPATH"], words = more, words[2:]
    sys.exit(subprocess.run([python, *words], cwd=folder).returncode)
