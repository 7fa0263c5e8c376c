# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The particle sets of the benchmark, made by the scripts in Examples/Data when they are needed."""
import dataclasses
import hashlib
import pathlib
import subprocess
import sys

GENERATORS = pathlib.Path(__file__).resolve().parent.parent / "Data"


def count_of(text):
    """670k -> 670000, 3M -> 3000000"""
    factor = {"k": 1000, "m": 1000000}.get(text[-1:].lower(), 1)
    return round(float(text[:-1] if factor > 1 else text) * factor)


def text_of(count):
    """670000 -> 670k, 3000000 -> 3M"""
    for unit, letter in ((1000000, "M"), (1000, "k")):
        if count >= unit:
            return f"{count / unit:g}{letter}"
    return str(count)


@dataclasses.dataclass(frozen=True)
class Set:
    """A generator with its arguments, and what marching-correctors is to be told of its result."""
    name: str
    script: str
    arguments: tuple
    options: tuple


def tank(count):
    """Wavy tank, 70 neighbours, constant h: the set of the comparisons with other software."""
    return Set(f"tank-{text_of(count)}", "make_tank.py", (count, "OUT"), ())


def dense_tank(count):
    """Wavy tank, 200 neighbours, constant h, quadratic kernel: stands for the paper's tsunami."""
    return Set(f"dense-tank-{text_of(count)}", "make_tank.py", (count, "OUT", "--ratio", 1.814),
               ("--kernel", "quadratic"))


def dam_break(count):
    """Dam break, 70 neighbours, variable h: stands for the paper's dam break."""
    return Set(f"dam-break-{text_of(count)}", "make_dam_break.py", (count, "OUT"), ())


def vortex_rings(count):
    """Colliding vortex rings on a full lattice, M'4: stands for the paper's vortex rings. There is
    no free surface, so nothing is trimmed: with a shortened kernel, weights between the particles
    of a lattice are low."""
    return Set(f"vortex-rings-{text_of(count)}", "make_vortex_rings.py",
               ("OUT", "-n", count, "--keep-all"),
               ("--kernel", "mprime4", "--node-threshold", 0, "--vertex-threshold", 0))


def version_of(which):
    """Changes with the generator and its arguments."""
    made_by = (GENERATORS / which.script).read_bytes() + repr(which.arguments).encode()
    return hashlib.sha1(made_by).hexdigest()[:8]


class Folder:
    """Where the sets lie. A set that is already there, made in the same way, is not made again."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.path.mkdir(parents=True, exist_ok=True)

    def get(self, which):
        path = self.path / f"{which.name}-{version_of(which)}.vtp"
        if not path.exists():
            print(f"making {path.name}", file=sys.stderr)
            part = path.with_suffix(".part.vtp")
            arguments = [str(part) if a == "OUT" else str(a) for a in which.arguments]
            subprocess.run([sys.executable, GENERATORS / which.script, *arguments], check=True,
                           stdout=subprocess.DEVNULL)
            part.rename(path)
        return path

    def get_with_one_array(self, which, array):
        """The same particles with one array alone, and the options that say what the others said:
        smoothing length, mass and density must be the same for all particles."""
        whole = self.get(which)
        path = whole.with_name(f"{whole.stem}-{array}.vtp")
        particles = read(whole)
        data = particles.GetPointData()
        options = []
        for name, option in (("SmoothingLength", "--smoothing-length"), ("Mass", "--mass"),
                             ("Density", "--density")):
            low, high = data.GetArray(name).GetRange()
            if low != high:
                raise ValueError(f"{which.name}: {name} differs from particle to particle")
            options += [option, repr(high)]
        if not path.exists():
            for name in [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]:
                if name != array:
                    data.RemoveArray(name)
            write(particles, path)
        return path, options


def read(path):
    import vtk
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def write(particles, path):
    import vtk
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(particles)
    writer.SetDataModeToBinary()  # appended data cannot be read by every ParaView
    writer.Write()
