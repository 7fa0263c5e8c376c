# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests that the wheels of other systems give the bytes that the wheel for Linux on x86-64 gives.

    test_systems.py windows|arm64 FOLDER_OF_THE_ENVIRONMENT

windows: in a Windows CPython under wine. The test also goes through the guide's page for Python, with PyVista. Nothing
comes from python.org: CPython's library and extension modules come from a wheel that has them (panda3d), and its modules
in Python come from a CPython of the same version on this machine. arm64: in Debian's Python for arm64, under qemu.

MCOR_WINDOWS_WHEEL, MCOR_ARM64_WHEEL: the path of a wheel; without it, Python/build-wheels builds the wheel. Status 77: there
is no wine or qemu, or PyPI or Debian is out of reach.
"""
import compileall
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from pathlib import Path

SOURCES, HERE = Path(os.environ["MCOR_TEST_SOURCES"]), Path(__file__).parent
PACKAGES = ("panda3d==1.10.16", "numpy==1.26.4", "pip==24.0")  # NumPy 2 needs functions that wine 8 lacks.
INTEL = ("intel-opencl-rt==2026.2.0", "tbb==2023.2.0")
PYVISTA = ("pyvista==0.49.1", "vtk==9.3.1", PACKAGES[1])
VERSION = (3, 11)
SKIPPED = 77
WIDE_MAIN = """#define WIN32_LEAN_AND_MEAN
#include <windows.h>
int wmain(int count, wchar_t** words)
{
  HMODULE library = LoadLibraryW(L"python311.dll");
  int (*python)(int, wchar_t**) = library ? (int (*)(int, wchar_t**))(void*)GetProcAddress(library, "Py_Main") : 0;
  return python ? python(count, words) : 99;
}
"""


def skip(sentence):
    print(f"Skipped: {sentence}")
    sys.exit(SKIPPED)


def run(*command, **environment):
    """Returns the lines that a command prints, without blanks around them."""
    done = subprocess.run([*map(str, command)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, errors="replace", env={**os.environ, **environment})
    print(done.stderr[-3000:])
    assert done.returncode == 0, (done.returncode, done.stdout[-3000:])
    return [line.strip() for line in done.stdout.splitlines() if line.strip()]


def wheel_for(system, variable, folder):
    if variable in os.environ:
        return os.environ[variable]
    subprocess.run([sys.executable, SOURCES / "Python" / "build-wheels", "--only", system, "--kernels", "usual", folder / "dist"],
                   check=True)
    wheel, = (folder / "dist").glob("*.whl")
    return wheel


def check_hashes(here, there):
    print("\n".join(there))
    assert len(here) == 11 and there == here, "\n".join(["on this system:", *here])


def make_windows_python(folder):
    for more in (["--no-deps", *PACKAGES, *INTEL], PYVISTA):
        if subprocess.run([sys.executable, "-m", "pip", "--disable-pip-version-check", "download", "-q",
                           "--only-binary=:all:", "--platform", "win_amd64", "--python-version", "%d.%d" % VERSION,
                           "-d", folder / "wheels", *more]).returncode:
            skip("the Python package index is out of reach.")
    python = folder / "été 測試" / "python"
    shutil.copytree(sysconfig.get_path("stdlib"), python / "Lib",
                    ignore=shutil.ignore_patterns("*-packages", "lib-dynload", "test", "config-*", "EXTERNALLY-MANAGED"))
    with zipfile.ZipFile(next((folder / "wheels").glob("panda3d-*.whl"))) as archive:
        for name in archive.namelist():
            if name.startswith("deploy_libs/") and name.endswith((".dll", ".pyd")) and "api-ms-win" not in name:
                (python / Path(name).name).write_bytes(archive.read(name))
    packages = python / "Lib" / "site-packages"
    with zipfile.ZipFile(next((folder / "wheels").glob("pip-*.whl"))) as archive:
        archive.extractall(packages)
    compileall.compile_dir(packages, quiet=1)
    (folder / "main.c").write_text(WIDE_MAIN)
    subprocess.run(["x86_64-w64-mingw32-gcc", "-municode", "-O1", folder / "main.c", "-o", python / "python.exe"], check=True)
    return python / "python.exe"


def install(python, wheels, environment, *packages):
    begin = time.monotonic()
    run("wine", python, "-m", "pip", "--disable-pip-version-check", "--no-cache-dir", "install", "--no-index",
        "--find-links", wheels, "--no-compile", "--no-warn-script-location", *packages, **environment)
    print(f"pip install {Path(packages[0]).name}: {time.monotonic() - begin:.1f} s")


def add_intel(wheels, folder, environment):
    """Installs Intel's OpenCL driver under wine: OpenCL.dll in place of wine's own, and the driver's name in the
    registry."""
    folder.mkdir()
    for wheel in (*wheels.glob("intel_opencl_rt-*.whl"), *wheels.glob("tbb-*.whl")):
        with zipfile.ZipFile(wheel) as archive:
            for name in archive.namelist():
                if "/Library/bin/" in name and not name.endswith("/"):
                    (folder / Path(name).name).write_bytes(archive.read(name))
    system = Path(environment["WINEPREFIX"]) / "drive_c" / "windows" / "system32"
    shutil.copy(folder / "OpenCL.dll", system / "opencl.dll")
    run("wine", "reg", "add", r"HKLM\SOFTWARE\Khronos\OpenCL\Vendors", "/v", f"Z:{folder / 'intelocl64.dll'}".replace("/", "\\"),
        "/t", "REG_DWORD", "/d", "0", "/f", **environment)


def check_windows(folder, here):
    if not (shutil.which("wine") and shutil.which("x86_64-w64-mingw32-gcc")):
        skip("there is no wine, or no gcc for Windows (Debian: apt install wine64 wine gcc-mingw-w64-x86-64).")
    if sys.version_info[:2] != VERSION:
        skip("the modules of CPython %d.%d are wanted, and this is %d.%d." % (*VERSION, *sys.version_info[:2]))
    wheel = wheel_for("windows", "MCOR_WINDOWS_WHEEL", folder)
    python = make_windows_python(folder)
    # wine reads names of files in the locale's encoding.
    environment = {"WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all", "LC_ALL": "C.UTF-8", "PYTHONIOENCODING": "utf-8"}
    os.environ.pop("PYTHONPATH", None)
    try:
        install(python, folder / "wheels", environment, wheel)
        expected = here()
        for threads in ("1", "3"):
            check_hashes(expected, run("wine", python, HERE / "surface_hashes.py", **environment, MCOR_THREADS=threads))
        install(python, folder / "wheels", environment, *PYVISTA)
        page = run("wine", python, HERE / "python_page.py", SOURCES / "Documentation" / "Guide" / "python.md", **environment)
        assert page == ["PyVista 0.49.1", "the page's words hold"], page
        add_intel(folder / "wheels", folder / "intel", environment)
        check_hashes(expected, run("wine", python, HERE / "surface_hashes.py", "intel", **environment, WINEDLLOVERRIDES="opencl=n"))
    finally:
        subprocess.run(["wineserver", "-k"], env={**os.environ, **environment})


def make_arm64_root(root):
    """Unpacks Debian's packages for arm64 without running their scripts."""
    done = subprocess.run(["debootstrap", "--arch=arm64", "--foreign", "--variant=minbase", "--include=python3-numpy",
                           "bookworm", root], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        print(done.stdout[-2000:])
        skip("debootstrap did not get Debian's packages of arm64.")
    for package in sorted((root / "var/cache/apt/archives").glob("*.deb")):
        subprocess.run(["dpkg", "-x", package, root], check=True)


def check_arm64(folder, here):
    if not (shutil.which("qemu-aarch64") and shutil.which("debootstrap") and os.getuid() == 0):
        skip("there is no qemu-aarch64 or no debootstrap (Debian: apt install qemu-user debootstrap), or no root.")
    root, packages = folder / "root", folder / "packages"
    make_arm64_root(root)
    wheel = wheel_for("linux-arm64", "MCOR_ARM64_WHEEL", folder)
    subprocess.run([sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-q", "--no-deps", "--no-compile",
                    "--target", packages, "--platform", "manylinux_2_28_aarch64", "--only-binary=:all:", wheel], check=True)
    libraries = root / "usr/lib/aarch64-linux-gnu"
    words = {"LD_LIBRARY_PATH": f"{libraries}/blas:{libraries}/lapack", "PYTHONHOME": f"{root}/usr",
             "PYTHONPATH": f"{packages}:{root}/usr/lib/python3/dist-packages"}
    check_hashes(here(), run("qemu-aarch64", "-L", root, *(word for pair in words.items() for word in ("-E", "=".join(pair))),
                             root / "usr/bin/python3.11", HERE / "surface_hashes.py"))


def main():
    own = Path(sys.argv[2]) / "venv" / "bin" / "python"
    with tempfile.TemporaryDirectory() as folder:
        {"windows": check_windows, "arm64": check_arm64}[sys.argv[1]](Path(folder), lambda: run(own, HERE / "surface_hashes.py"))


if __name__ == "__main__":
    main()
