#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Prints, for each OpenCL program that the driver of a GPU compiles, the number of its kernels, and the number of lines of the PTX code that
clang and LLVM's back end for NVIDIA's cards make of the program. LATTICE and FIELD are whole programs; all others are parts of these two.

  programs.py [VERSION]     of clang, opt and llc; default: 14. Debian: apt install clang-14 llvm-14
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FOLDER = Path(__file__).parents[2] / "vtkMarchingCorrectors"
KERNEL = ("-DMCOR_W=mcor_w_cubic -DMCOR_DW=mcor_dw_cubic -DMCOR_DDW=mcor_ddw_cubic -DMCOR_NORM=0.318309886f -DMCOR_SUPPORT=2.0f "
          "-DMCOR_TENSOR=0 -DMCOR_FIELD=0 -DMCOR_SOLIDS=0").split()


def list_programs():
    """Returns {program: (its value of MCOR_PROGRAM, its source files)} for the form of the kernels that GPUs run."""
    rows = [(source, words.split()) for source, words in
            re.findall(r'^  "(\S+) +([^"]*)"', (FOLDER / "kernels/programs.cmake").read_text(), re.M)]
    words = [word for _, words in rows for word in words]
    programs = {}
    for number, whole in enumerate(("LATTICE", "FIELD")):
        parts = {part for word in words if word.startswith(whole + ":") for part in word.partition(":")[2].split(",")}
        programs.update((part, (number, [])) for part in [whole, *sorted(parts)])
        for source, each in rows:
            for word in each if "lanes" not in each else ():
                if word.partition(":")[0] == whole:
                    named = word.partition(":")[2]
                    for part in {whole, *(named.split(",") if named else parts)}:
                        programs[part][1].append(source)
    return programs


def compile_program(number, sources, folder, version):
    """Returns the kernels' names, and their code as PTX text."""
    text, made = folder / "program.cl", [folder / name for name in ("all.bc", "kernels.bc", "best.bc", "program.ptx")]
    text.write_text("".join(f'#include "{FOLDER / source}"\n' for source in sources))
    clang = [f"clang-{version}", "-x", "cl", "-cl-std=CL1.2", "-D__OPENCL_VERSION__=120", f"-DMCOR_PROGRAM={number}", "-DMCOR_LANES=1",
             "-DMCOR_DOUBLE=0", *(KERNEL if number else ()), "-w", text]
    shown = subprocess.run([*clang, "-E", "-P"], check=True, stdout=subprocess.PIPE, text=True).stdout
    kernels = re.findall(r"__kernel [^;{]*?void\s+(mcor_\w+)\(", shown)
    for command in (
            [*clang, "--target=nvptx64-nvidia-cuda", "-Xclang", "-finclude-default-header", "-O3", "-Xclang", "-disable-llvm-passes",
             "-emit-llvm", "-c", "-o", made[0]],
            [f"opt-{version}", "-internalize", f"-internalize-public-api-list={','.join(kernels)}", made[0], "-o", made[1]],
            [f"opt-{version}", "-O3", made[1], "-o", made[2]],
            [f"llc-{version}", "-O3", "-mcpu=sm_70", made[2], "-o", made[3]]):
        subprocess.run(command, check=True)
    return kernels, made[3].read_text()


def main():
    version = sys.argv[1] if len(sys.argv) > 1 else "14"
    print("| program | kernels | lines of PTX |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, (number, sources) in list_programs().items():
            kernels, code = compile_program(number, sources, Path(folder), version)
            print(f"| {name} | {len(kernels)} | {code.count(chr(10)):,} |", flush=True)


if __name__ == "__main__":
    main()
