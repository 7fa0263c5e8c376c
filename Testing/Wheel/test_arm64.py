# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The wheel for Linux on arm64 in Debian's Python for arm64, under qemu, gives the bytes that the wheel for x86-64 gives.

    test_arm64.py FOLDER_OF_THE_ENVIRONMENT

MCOR_ARM64_WHEEL: one that is built; else Python/build-wheels builds it. Status 77: there is no qemu, or no debootstrap, which
needs root, or a network out of reach.
"""
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCES, HERE = Path(os.environ["MCOR_TEST_SOURCES"]), Path(__file__).parent
SKIPPED = 77
PYTHON = "usr/bin/python3.11"


def skip(sentence):
    print(f"Skipped: {sentence}")
    sys.exit(SKIPPED)


def make_root(root):
    """Debian's packages of arm64, unpacked: none of their scripts runs."""
    done = subprocess.run(["debootstrap", "--arch=arm64", "--foreign", "--variant=minbase", "--include=python3-numpy",
                           "bookworm", root], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        print(done.stdout[-2000:])
        skip("debootstrap did not get Debian's packages of arm64.")
    for package in sorted((root / "var/cache/apt/archives").glob("*.deb")):
        subprocess.run(["dpkg", "-x", package, root], check=True)


def run(*command, **environment):
    done = subprocess.run([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          env={**os.environ, **environment})
    print(done.stderr[-3000:])
    assert done.returncode == 0, (done.returncode, done.stdout[-3000:])
    return done.stdout.splitlines()


def main():
    if not (shutil.which("qemu-aarch64") and shutil.which("debootstrap") and os.getuid() == 0):
        skip("there is no qemu-aarch64 or no debootstrap (Debian: apt install qemu-user debootstrap), or no root.")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        root, packages = folder / "root", folder / "packages"
        make_root(root)
        wheel = os.environ.get("MCOR_ARM64_WHEEL")
        if not wheel:
            subprocess.run([sys.executable, SOURCES / "Python" / "build-wheels", "--only", "linux-arm64", "--kernels", "usual",
                            folder / "dist"], check=True)
            wheel, = (folder / "dist").glob("*_aarch64.whl")
        subprocess.run([sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-q", "--no-deps", "--no-compile",
                        "--target", packages, "--platform", "manylinux_2_28_aarch64", "--only-binary=:all:", wheel], check=True)
        here = run(Path(sys.argv[1]) / "venv" / "bin" / "python", HERE / "surface_hashes.py")
        libraries = root / "usr/lib/aarch64-linux-gnu"
        words = {"LD_LIBRARY_PATH": f"{libraries}/blas:{libraries}/lapack", "PYTHONHOME": f"{root}/usr",
                 "PYTHONPATH": f"{packages}:{root}/usr/lib/python3/dist-packages"}
        there = run("qemu-aarch64", "-L", root, *(word for pair in words.items() for word in ("-E", "=".join(pair))),
                    root / PYTHON, HERE / "surface_hashes.py")
        print("\n".join(there))
        assert len(here) == 11 and there == here, "\n".join(["on x86-64:", *here])


if __name__ == "__main__":
    main()
