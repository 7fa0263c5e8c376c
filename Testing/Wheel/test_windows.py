# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The wheel for Windows in a Windows CPython under wine gives the bytes that the wheel for Linux gives, and does what the
guide's page for Python says, with PyVista, too.

    test_windows.py FOLDER_OF_THE_ENVIRONMENT

MCOR_WINDOWS_WHEEL: one that is built; else Python/build-wheels builds it. Status 77: there is no wine, or PyPI is
out of reach. Where CPython's own site is not: its library and extension modules are taken from a wheel that has
them (panda3d), its modules in Python from a CPython of the same version here.
"""
import compileall
import glob
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
PACKAGES = ("panda3d==1.10.16", "numpy==1.26.4", "pip==24.0")  # NumPy 2 wants functions that wine 8 has not
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


def make_python(folder):
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


def run(*command, **more):
    done = subprocess.run([*map(str, command)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, errors="replace", **more)
    print(done.stderr[-3000:])
    assert done.returncode == 0, (done.returncode, done.stdout[-3000:])
    return [line.strip() for line in done.stdout.splitlines() if line.strip()]


def install(python, wheels, environment, *packages):
    begin = time.monotonic()
    run("wine", python, "-m", "pip", "--disable-pip-version-check", "--no-cache-dir", "install", "--no-index",
        "--find-links", wheels, "--no-compile", "--no-warn-script-location", *packages, env=environment)
    print(f"pip install {Path(packages[0]).name}: {time.monotonic() - begin:.1f} s")


def add_intel(wheels, folder, environment):
    """A driver for wine: OpenCL.dll in place of wine's own, and its name in the registry."""
    for wheel in (*wheels.glob("intel_opencl_rt-*.whl"), *wheels.glob("tbb-*.whl")):
        with zipfile.ZipFile(wheel) as archive:
            for name in archive.namelist():
                if "/Library/bin/" in name and not name.endswith("/"):
                    (folder / Path(name).name).write_bytes(archive.read(name))
    system = Path(environment["WINEPREFIX"]) / "drive_c" / "windows" / "system32"
    shutil.copy(folder / "OpenCL.dll", system / "opencl.dll")
    run("wine", "reg", "add", r"HKLM\SOFTWARE\Khronos\OpenCL\Vendors", "/v", f"Z:{folder / 'intelocl64.dll'}".replace("/", "\\"),
        "/t", "REG_DWORD", "/d", "0", "/f", env=environment)


def main():
    if not (shutil.which("wine") and shutil.which("x86_64-w64-mingw32-gcc")):
        skip("there is no wine, or no gcc for Windows (Debian: apt install wine64 wine gcc-mingw-w64-x86-64).")
    if sys.version_info[:2] != VERSION:
        skip("the modules of CPython %d.%d are wanted, and this is %d.%d." % (*VERSION, *sys.version_info[:2]))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        wheel = os.environ.get("MCOR_WINDOWS_WHEEL")
        if not wheel:
            subprocess.run([sys.executable, SOURCES / "Python" / "build-wheels", "--only", "windows", "--kernels", "usual",
                            folder / "dist"], check=True)
            wheel, = glob.glob(f"{folder}/dist/*-win_amd64.whl")
        python = make_python(folder)
        # wine reads names of files by the locale
        environment = {**os.environ, "WINEPREFIX": str(folder / "wine"), "WINEDEBUG": "-all", "LC_ALL": "C.UTF-8",
                       "PYTHONIOENCODING": "utf-8"}
        environment.pop("PYTHONPATH", None)
        try:
            install(python, folder / "wheels", environment, wheel)
            here = run(Path(sys.argv[1]) / "venv" / "bin" / "python", HERE / "surface_hashes.py")
            for threads in ("1", "3"):
                windows = run("wine", python, HERE / "surface_hashes.py", env={**environment, "MCOR_THREADS": threads})
                print("\n".join(windows))
                assert len(here) == 11 and windows == here, "\n".join(["on Linux:", *here])
            install(python, folder / "wheels", environment, *PYVISTA)
            page = run("wine", python, HERE / "python_page.py", SOURCES / "Documentation" / "Guide" / "python.md",
                       env=environment)
            assert page == ["PyVista 0.49.1", "the page's words hold"], page
            (folder / "intel").mkdir()
            add_intel(folder / "wheels", folder / "intel", environment)
            intel = run("wine", python, HERE / "intel_device.py", env={**environment, "WINEDLLOVERRIDES": "opencl=n"})
            assert intel == ["Intel's runtime: the same"], intel
        finally:
            subprocess.run(["wineserver", "-k"], env=environment)


if __name__ == "__main__":
    main()
