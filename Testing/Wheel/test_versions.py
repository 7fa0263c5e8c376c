# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the functions for NumPy in each version of Python that pyproject.toml names and this machine has.

    test_versions.py FOLDER_OF_THE_ENVIRONMENT

Status 77: there is only the version that runs this.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCES = Path(os.environ["MCOR_TEST_SOURCES"])
SKIPPED = 77


def versions():
    text = (SOURCES / "pyproject.toml").read_text()
    return re.findall(r'"Programming Language :: Python :: (3\.\d+)"', text)


def find(version):
    """Returns a Python of this version from the PATH or from pyenv. A Python that cannot make environments does not
    count."""
    candidates = [shutil.which("python" + version)]
    candidates += sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin/python"))
    for python in filter(None, candidates):
        asked = subprocess.run([python, "-c", "import sys, venv, ensurepip; print('%d.%d' % sys.version_info[:2])"],
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        if asked.stdout.strip() == version:
            return python
    return None


def main():
    wheel, = Path(sys.argv[1]).glob("dist/*.whl")
    others = {version: find(version) for version in versions() if version != "%d.%d" % sys.version_info[:2]}
    assert others  # pyproject.toml names versions.
    tried, failed = [], []
    for version, python in others.items():
        if python is None:
            continue
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([python, "-m", "venv", folder], check=True)
            own = Path(folder) / "bin" / "python"
            subprocess.run([own, "-m", "pip", "-q", "--disable-pip-version-check", "install", wheel], check=True)
            done = subprocess.run([own, "-W", "error::DeprecationWarning", Path(__file__).with_name("test_numpy.py")])
        tried.append(version)
        failed += [version] if done.returncode else []
    print(f"tried: {', '.join(tried) or 'none'}; not here: {', '.join(v for v in others if v not in tried) or 'none'}")
    sys.exit(1 if failed else 0 if tried else SKIPPED)


if __name__ == "__main__":
    main()
