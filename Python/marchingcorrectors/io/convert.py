# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes particles as VTK's poly data: .vtp, and .pvd for several times. All outputs of the package follow the program's rules: each is written
beside its target; at the end, all of them replace their targets."""
import base64
import contextlib
import os
import secrets
import shutil
import stat
import sys
import zlib
from pathlib import Path

import numpy as np

from . import FileError, count_steps, read
from .._library import lib, say, warn
from .._options import words_of
from ._particles import find_kernel
from .vtk_files import KINDS

XML_NAMES = {numpy: name for name, numpy in KINDS.items()}
BLOCK = 1 << 20  # bytes that are packed at a time
STEP_MARK = b"<!-- a step of a film by marching-correctors -->"


def plain(values):
    """Returns the array in one piece, in a type that VTK has."""
    return np.ascontiguousarray(values, np.uint8 if values.dtype.kind == "b" else values.dtype.newbyteorder("="))


def describe(particles):
    """Returns positions, arrays as in the file, and field data. Adds arrays that the file tells in another way: Mass, ParticleType (0
    fluid, 1 wall), and SmoothingLength as this package means it (half of the support radius; a third for the quintic spline, 2/5 for the
    quartic), which replaces the file's own array. Leaves out arrays that VTK cannot hold, with a warning if their type is the reason."""
    positions, arrays = particles.positions, {name: particles.arrays[name] for name in particles.arrays}
    h = particles.quantity("smoothing_length")
    if h is not None:
        if isinstance(particles.smoothing_length, str):
            arrays.pop(particles.smoothing_length)
        kernel = find_kernel(particles.kernel)
        radius = lib.mcor_support_factor(words_of("sph_kernel")[kernel]) if kernel else 2.0  # as most kernels have
        factor = radius if particles.support_radius else 1
        arrays["SmoothingLength"] = np.broadcast_to(np.asarray(h, float) / factor, len(positions))
    if isinstance(particles.mass, float):
        arrays.setdefault("Mass", np.full(len(positions), particles.mass))
    if particles.solid is not None and "Type" not in arrays:
        arrays["ParticleType"] = particles.solid.astype(np.uint8)
    held = {}
    for name, values in arrays.items():
        if values.ndim in (1, 2) and len(values) == len(positions) and values.size >= len(values):
            if values.dtype.kind in "biuf" or (values.dtype.kind == "U" and values.ndim == 1):
                held[name] = values if values.dtype.kind == "U" else plain(values)
            else:
                warn(f"{particles.file}: the array '{name}' ({values.dtype}) is left out, as VTK has no such type.")
    field = {"TimeValue": None if particles.time is None else [float(particles.time)],
             "PeriodicBounds": particles.cell or particles.period}
    return (plain(positions if positions.dtype.kind == "f" else positions.astype(float)), held,
            {name: np.asarray(values, float) for name, values in field.items() if values is not None})


def to_vtk(particles):
    """Returns poly data with a vertex for each particle, because ParaView draws no points without cells."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    from .._vtk import add, build_cells

    positions, arrays, field = describe(particles)
    data, numbers = vtkPolyData(), np.arange(len(positions) + 1)
    data.SetPoints(vtkPoints())
    data.GetPoints().SetData(numpy_to_vtk(positions, deep=True))
    data.SetVerts(build_cells(numbers, numbers[:-1]))
    for to, held in ((data.GetPointData(), arrays), (data.GetFieldData(), field)):
        for name, values in held.items():
            add(to, name, values)
    return data


def quoted(text):
    from xml.sax.saxutils import quoteattr  # not above: it loads urllib.request, 15 to 20 ms of the start of each command

    return quoteattr(text)


def xml_array(name, values, more=""):
    """Returns the text of an array: the sizes of packed blocks, then the blocks, both in base64."""
    if values.dtype.kind == "U":
        kind, data = "String", "".join(value + "\0" for value in values.tolist()).encode()
    else:
        kind, data = XML_NAMES[values.dtype.str[1:]], np.ascontiguousarray(values).tobytes()
    blocks = [zlib.compress(data[i:i + BLOCK], 1) for i in range(0, len(data), BLOCK)]
    sizes = np.array([len(blocks), BLOCK, len(data) % BLOCK, *map(len, blocks)], np.uint64)
    text = (base64.b64encode(sizes.tobytes()) + base64.b64encode(b"".join(blocks))).decode()
    columns = values.shape[1] if values.ndim == 2 else 1
    return (f'<DataArray type="{kind}" Name={quoted(name)} NumberOfComponents="{columns}"{more} format="binary">\n{text}\n'
            "</DataArray>\n")


def vtp_bytes(particles, mark=b""):
    """Returns the bytes of a .vtp file with the data of to_vtk(), made without VTK."""
    positions, arrays, field = describe(particles)
    count, numbers = len(positions), np.arange(len(positions) + 1)
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    inside = {"PointData": arrays, "Points": {"Points": positions}, "Verts": {"connectivity": numbers[:-1], "offsets": numbers[1:]}}
    piece = "".join(f"<{part}>\n{''.join(xml_array(name, values) for name, values in held.items())}</{part}>\n"
                    for part, held in inside.items())
    fields = "".join(xml_array(name, values, f' NumberOfTuples="{len(values)}"') for name, values in field.items())
    return (f'<?xml version="1.0"?>\n{mark.decode()}<VTKFile type="PolyData" version="1.0" byte_order="{order}" header_type="UInt64" '
            f'compressor="vtkZLibDataCompressor">\n<PolyData>\n<FieldData>\n{fields}</FieldData>\n'
            f'<Piece NumberOfPoints="{count}" NumberOfVerts="{count}" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">\n{piece}'
            "</Piece>\n</PolyData>\n</VTKFile>\n").encode()


def convert(inputs, output):
    """Writes files as one .vtp, with the first step, or as a .pvd with one .vtp for each step, at the files' times (else 0, 1, ...)."""
    output = Path(output)
    if output.suffix.lower() not in (".vtp", ".pvd"):
        raise FileError(f"'{output}' must end in .vtp or .pvd.")
    if output.suffix.lower() == ".vtp":
        with Outputs(inputs, [output]) as files:
            particles = read(inputs[0] if len(inputs) == 1 else inputs)
            files.write(output, vtp_bytes(particles))
        if len(particles.times or ()) > 1:
            warn(f"{particles.file} has {len(particles.times)} steps, and {output.name} the first: a .pvd file holds all.")
        return
    sources = [(each, i) for each in inputs for i in range(count_steps(each))]
    steps = [output.with_name(f"{output.stem}_{i:04d}.vtp") for i in range(len(sources))]
    lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "<Collection>"]
    with Outputs(inputs, [output], steps) as files:
        for i, ((each, number), step) in enumerate(zip(sources, steps)):
            particles = read(each, step=number)
            files.write(step, vtp_bytes(particles, STEP_MARK))
            time = float(i if particles.time is None else particles.time)
            lines.append(f'<DataSet timestep="{time!r}" part="0" file={quoted(step.name)}/>')
        files.write(output, "\n".join(lines + ["</Collection>", "</VTKFile>", ""]).encode())


# -- outputs --

def _identity(path):
    """Returns an identity that is the same for all names of one file. A file that does not exist yet is identified by its folder and its name."""
    try:
        status = os.stat(path)
        return status.st_dev, status.st_ino
    except FileNotFoundError:
        folder, name = os.path.split(os.path.realpath(path))
        status = os.stat(folder)
        return status.st_dev, status.st_ino, name


class Outputs:
    """Replaces all files at the end of the with block, or none if the block raises.

    Checks first that no output is an input or another output, by whatever link. If an output is a symbolic link, the file
    behind it is replaced, and its mode stays; other hard links of that file keep the old contents. steps: outputs that the user
    has not named; they replace only steps of an older film.
    """

    def __init__(self, inputs, outputs, steps=()):
        self._written = []  # Each entry is (where the file is, where it goes).
        read = {_identity(path) for path in inputs if os.path.exists(path)}
        found = set()
        for path in (*outputs, *steps):
            with _sentences(path):
                identity = _identity(path)
            if os.path.isdir(path):
                raise FileError(f"{path} could not be written: it is a directory.")
            if identity in read:
                raise FileError(f"{path} would overwrite the input; choose another name for the output.")
            if identity in found:
                raise FileError(f"{path} would be written twice; choose another name for the output.")
            found.add(identity)
        for path in filter(os.path.lexists, steps):
            is_step = False
            with contextlib.suppress(OSError), open(path, "rb") as file:
                is_step = STEP_MARK in file.read(256)
            if not is_step:
                raise FileError(say("FILM_STEP_TAKEN", path))

    def write(self, path, data):
        """Writes one file at once, so that its bytes need not stay in memory."""
        with _sentences(path), open(self.beside(path), "wb") as file:
            file.write(data)
            file.flush()
            if os.path.isfile(file.name):
                os.fsync(file.fileno())

    def beside(self, path):
        """Returns the path to write to: the name of `path` in a new folder beside the target; for a device or a pipe, `path` itself."""
        with _sentences(path):
            target = os.path.realpath(path)
            if os.path.exists(target):
                if not os.path.isfile(target):
                    return str(path)
                with open(target, "r+b"):  # This asks the system, which may forbid it.
                    pass
            folder, name = os.path.dirname(target), os.path.basename(path)
            own = os.path.join(folder, f".{name[:50]}.{secrets.token_hex(4)}")
            self._written.append((os.path.join(own, name), target))  # This comes first, because a signal may end the program anywhere.
            os.mkdir(own, 0o700)
            return self._written[-1][0]

    def __enter__(self):
        return self

    def __exit__(self, kind, error=None, *_):
        try:
            for beside, target in self._written:
                with _sentences(target):
                    if kind is None:
                        if os.path.exists(target):
                            _copy_mode(target, beside)
                        os.replace(beside, target)
                    elif getattr(error, "filename", None) == beside:
                        raise error
        finally:
            self._clear()

    def _clear(self):
        try:
            while self._written:
                shutil.rmtree(os.path.dirname(self._written[-1][0]), ignore_errors=True)
                self._written.pop()
        finally:
            if self._written:  # A signal came.
                self._clear()


def _copy_mode(old, new):
    """Copies the mode, and owner and group if that is allowed."""
    status = os.stat(old)
    mode = stat.S_IMODE(status.st_mode)
    if hasattr(os, "chown"):
        try:
            os.chown(new, status.st_uid, status.st_gid)
        except OSError:
            mode &= 0o707  # Another group must not gain what the old one was allowed.
    os.chmod(new, mode)


@contextlib.contextmanager
def _sentences(path):
    """Turns the system's errors into sentences with the file's name."""
    try:
        yield
    except OSError as error:
        raise FileError(f"{path} could not be written: {error.strerror}.") from None
