# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a test with packages that only this test needs; they are installed into their own folder.

    with_packages.py "PACKAGE PACKAGE ..." TEST [ARGUMENT]...
"""
import os
import subprocess
import sys
import tempfile

CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"
SKIPPED = 77

if os.path.exists(CERTIFICATES):
    os.environ.setdefault("PIP_CERT", CERTIFICATES)
with tempfile.TemporaryDirectory() as folder:
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-q"]
    if subprocess.run([*pip, "--target", folder, *sys.argv[1].split()]).returncode:
        print("Skipped: the packages cannot be installed.")
        sys.exit(SKIPPED)
    sys.exit(subprocess.run([sys.executable, *sys.argv[2:]], env={**os.environ, "PYTHONPATH": folder}).returncode)
