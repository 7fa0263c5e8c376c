# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Results of the functions: a surface, samples, derivatives, an image, gauges, fluxes."""
from __future__ import annotations

import contextlib
import csv
import errno
import io
import os
import re
import shutil
from dataclasses import dataclass, field as dataclass_field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Union

import numpy as np

from ._options import camel
from ._library import InvalidArgument, warn

if TYPE_CHECKING:
    import meshio
    import pyvista
    import trimesh


def _same(one, other):
    """Whether two values are equal. Arrays must have the same type, shape and bits, so NaN equals NaN; dictionaries must have equal entries."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return type(one) is type(other) and one.shape == other.shape and one.dtype == other.dtype \
            and one.tobytes() == other.tobytes()
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_same(one[name], other[name]) for name in one)
    return one == other


class Result:
    """Base of all results: has a short repr(), and a == that compares all but the statistics, which hold seconds."""

    __hash__ = None  # type: ignore[assignment]  # arrays can be changed

    def __eq__(self, other):
        if type(self) is not type(other):
            return NotImplemented
        return all(_same(getattr(self, f.name), getattr(other, f.name)) for f in fields(self)
                   if f.name != "statistics")

    def _names(self, left_out=()):
        """Returns a text with the names of the arrays that exist, for repr()."""
        names = []
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, np.ndarray) and f.name not in left_out:
                names.append(f.name)
            elif isinstance(value, dict) and value and f.name in ("attributes", "values", "gradients"):
                names.append(f"{f.name} of {', '.join(value)}")
        return "; ".join(names) or "none"


@contextlib.contextmanager
def writing(path, mesh=None):
    """Lets the system's errors name the file that the block writes. mesh: a mesh that VTK writes. On a full disk, VTK may end the process,
    so free space is checked before the block; or VTK may write a part without an error, so some more bytes are written as a test."""
    try:
        total, _, free = shutil.disk_usage(os.path.dirname(os.path.abspath(path)))  # A mounted share may not tell: total is 0.
        if mesh is not None and free < min(total, 1024 * mesh.actual_memory_size):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        yield
        if mesh is not None and os.path.isfile(path):
            with open(path, "r+b") as file:
                size = file.seek(0, os.SEEK_END)
                file.write(bytes(1 << 17))
                file.truncate(size)
    except OSError as error:
        raise OSError(error.errno or errno.EIO, error.strerror or "VTK cannot write it", os.fspath(path)) from None


def save_npz(path, **arrays):
    """Lets NumPy write to memory, and then writes the file. On a full disk, NumPy would close its file twice, with a traceback."""
    held = io.BytesIO()
    np.savez_compressed(held, **arrays)
    with writing(path):
        Path(path).write_bytes(held.getbuffer())


def write_csv(path, head, rows):
    """Writes a table; NaN becomes an empty cell."""
    with writing(path), open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([head, *([cell if cell == cell else "" for cell in row] for row in rows)])


CELLS = ("points", "triangles", "triangle_keys", "line_points", "line_offsets", "band_value")


@dataclass(eq=False, repr=False)
class Surface(Result):
    """A triangle mesh, or, in two dimensions, lines, which may be filled. Arrays that were not asked for are None. All arrays own
    their memory."""

    points: np.ndarray  #: (points, 3), float32 or float64 as the positions, in their unit (L)
    triangles: np.ndarray  #: (triangles, 3) int32; the right-hand normal points to lower values
    normals: Optional[np.ndarray] = None  #: (points, 3) float32, unit length
    gradients: Optional[np.ndarray] = None  #: (points, 3) float64, scalar unit / L
    weight_sum: Optional[np.ndarray] = None  #: (points,) float32, the trimming weight
    boundary_eigenvalue: Optional[np.ndarray] = None  #: (points,) float32
    correction_length: Optional[np.ndarray] = None  #: (points,) float32, L
    residual: Optional[np.ndarray] = None  #: (points,) float32, field minus iso value, scalar unit
    boundary_flag: Optional[np.ndarray] = None  #: (points,) uint8, see isosurface()
    nearest_particle: Optional[np.ndarray] = None  #: (points,) int64, index of a fluid particle
    mean_curvature: Optional[np.ndarray] = None  #: (points,) float64, 1 / L; 1 / R for a drop of radius R
    gauss_curvature: Optional[np.ndarray] = None  #: (points,) float64, 1 / L^2; not in two dimensions
    point_keys: Optional[np.ndarray] = None  #: (points, 3) uint64
    widening: Optional[np.ndarray] = None  #: (points,) float64, the factor of smoothing lengths, with widen
    iso_value: Optional[np.ndarray] = None  #: (points,) float64, scalar unit
    triangle_keys: Optional[np.ndarray] = None  #: (triangles, 2) uint64
    line_points: Optional[np.ndarray] = None  #: two dimensions: int32, points of one line after the other
    line_offsets: Optional[np.ndarray] = None  #: (lines + 1,) int64: where each line begins in line_points
    band_value: Optional[np.ndarray] = None  #: filled: (triangles,) float64, the iso value with which the band begins
    #: {name: (points,) or (points, components)}. An array of floating-point numbers has its SPH mean at each point; any
    #: other array has the value of the nearest particle. Each array keeps its type.
    attributes: Dict[str, np.ndarray] = dataclass_field(default_factory=dict)
    #: {name: particle}: attributes that are left out, because they are NaN or infinite at this particle
    left_out: Dict[str, int] = dataclass_field(default_factory=dict)
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)  #: as mcor_statistics of mcor.h
    iso_value_name: str = "IsoValue"  #: of the array iso_value in files

    @property
    def lines(self) -> List[np.ndarray]:
        """In two dimensions, the indices of the points of each polyline. Values are greater on the polyline's left. A closed polyline
        ends with its first point."""
        if self.line_offsets is None:
            return []
        return np.split(self.line_points, self.line_offsets[1:-1]) if len(self.line_offsets) > 1 else []

    def line_values(self) -> np.ndarray:
        """Returns the iso value of each line. The array iso_value must have been asked for."""
        return self.iso_value[self.line_points[self.line_offsets[:-1]]]

    def __repr__(self):
        cells = [f"{len(self.lines)} lines"] if self.line_offsets is not None else []
        cells = ", ".join(cells + [f"{len(self.triangles)} triangles"] if len(self.triangles) or not cells else cells)
        return (f"<Surface: {len(self.points)} points, {cells}; "
                f"arrays: {self._names(CELLS)}>")

    def point_arrays(self) -> Dict[str, np.ndarray]:
        """Returns {name: array} of all that points carry, under the names that VTK's filter gives them."""
        own = {self.iso_value_name if f.name == "iso_value" else camel(f.name): getattr(self, f.name) for f in fields(self)
               if isinstance(getattr(self, f.name), np.ndarray) and f.name not in CELLS}
        return {**{name: array for name, array in self.attributes.items() if name not in own}, **own}

    def to_pyvista(self) -> pyvista.PolyData:
        """Returns a pyvista.PolyData with all arrays of the surface."""
        import pyvista

        from ._vtk import build_mesh

        mesh, arrays = pyvista.PolyData(), self.point_arrays()
        build_mesh(mesh, self, {name: array for name, array in arrays.items() if array.dtype.kind in "fiuU" or not len(array)
                                and array.dtype.kind == "b"})
        for name, array in arrays.items():
            if name not in mesh.point_data and len(array):
                mesh.point_data[name] = array  # The flags are true or false.
        mesh.set_active_scalars(None)  # The user chooses the colours.
        return mesh

    def to_trimesh(self) -> trimesh.Trimesh:
        """Returns a trimesh.Trimesh with all arrays of the points as vertex_attributes."""
        import trimesh

        arrays = {name: array for name, array in self.point_arrays().items() if name != "Normals"}
        normals = self.normals if len(self.points) else None
        return trimesh.Trimesh(self.points, self.triangles, vertex_normals=normals, vertex_attributes=arrays,
                               process=False)

    def to_meshio(self) -> meshio.Mesh:
        """Returns a meshio.Mesh with all arrays of the points that hold numbers."""
        import meshio

        arrays = {name: array.astype(np.uint8) if array.dtype == bool else array
                  for name, array in self.point_arrays().items() if array.dtype.kind in "fiub"}
        cells = [("triangle", self.triangles)]
        if self.line_offsets is not None:
            lines = ("line", np.concatenate([np.empty((0, 2), np.int32)] + [
                np.stack([line[:-1], line[1:]], axis=1) for line in self.lines]))
            cells = [lines] + (cells if len(self.triangles) else [])
        if self.band_value is None or len(cells) == 1:
            return meshio.Mesh(self.points, cells, point_data=arrays)
        of_lines = np.repeat(self.line_values(), np.diff(self.line_offsets) - 1)
        return meshio.Mesh(self.points, cells, point_data=arrays, cell_data={"BandValue": [of_lines, self.band_value]})

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes a file. The end of its name tells the format.

        .npz: NumPy's, all arrays by their names, read by numpy.load(). .ply: with all arrays of
        numbers as properties of the points, as the program writes them. .csv: for particles in
        a plane, the points of the lines, with their arrays as columns. .vtp, .vtk, .stl, .obj: by
        PyVista. .usdc, .usda, .usd: by usd-core, with all arrays. All others: by meshio. Formats that hold no arrays get the triangles alone; a warning says so.
        """
        path = Path(os.path.expanduser(path))
        ending = path.suffix.lower()
        if ending in (".stl", ".obj", ".off") and not len(self.triangles) and (ending != ".obj" or not self.lines):
            raise InvalidArgument(f"{path.name} was not written, because the surface has no triangles, and files {ending} "
                                  "hold nothing else. Formats that can be empty are .npz, .ply and .vtp.")
        if self.lines and not len(self.triangles) and ending == ".ply":
            raise InvalidArgument(f"{path.name} was not written, because .ply holds no lines, which particles in a plane give. "
                                  "Formats that do are .vtp, .csv, .obj and .npz.")
        if ending == ".npz":
            arrays = {f.name: getattr(self, f.name) for f in fields(self)
                      if isinstance(getattr(self, f.name), np.ndarray)}
            save_npz(path, **arrays, **{f"attributes/{k}": v for k, v in self.attributes.items()})
        elif ending == ".ply":
            _save_ply(path, self)
        elif ending == ".csv":
            _save_csv(path, self)
        elif ending in (".usdc", ".usda", ".usd"):
            from ._usd import Film

            with Film(path) as film:
                film.add(self)
        elif ending in (".vtp", ".vtk", ".stl", ".obj"):
            has_lines = ending[1] == "v" or not len(self.triangles)
            surface = self if has_lines else replace(self, line_offsets=None, line_points=None, band_value=None)
            mesh = surface.to_pyvista()
            with writing(path, mesh):
                mesh.save(path)
        elif ending:
            import meshio

            try:
                with writing(path):
                    self.to_meshio().write(path)
            except meshio.ReadError:
                raise InvalidArgument(f"{path.name} was not written, because no format of that ending is known. Formats that hold "
                                      "all arrays are .npz, .ply and .vtp.") from None
        else:
            raise InvalidArgument(f"The file name '{path}' has no ending that tells the format, as .npz, .ply, .vtp.")
        lost = sorted(set(self.point_arrays()) - {"Normals"})
        if lost and ending in (".stl", ".obj", ".off"):
            warn(f"A file {ending} holds no arrays: {', '.join(lost)} {'is' if len(lost) == 1 else 'are'} not in "
                 f"{path.name}. Formats that hold them are .ply, .vtp and .npz.")


PLY_TYPES = {"f8": "double", "f4": "float", "i4": "int", "i2": "short", "i1": "char", "u4": "uint", "u2": "ushort",
             "u1": "uchar"}


def _save_csv(path, surface):
    """Writes a row for each point of each line, with the columns that the program writes."""
    if surface.line_offsets is None and len(surface.triangles):
        raise InvalidArgument(f"{path.name} was not written: .csv holds the points of lines, which particles in a plane give, but this "
                              "is a surface. Formats that hold all arrays are .npz, .ply and .vtp.")
    taken = np.empty(0, int) if surface.line_offsets is None else surface.line_points
    counts = [] if surface.line_offsets is None else np.diff(surface.line_offsets)
    arrays = {name: array.reshape(len(array), int(np.prod(array.shape[1:]))) for name, array in surface.point_arrays().items()}
    wide = [(f"{name}:{i}", array[:, i]) for name, array in arrays.items() if array.shape[1] > 1 for i in range(array.shape[1])]
    columns = {"Line": np.repeat(np.arange(len(counts)), counts).tolist()}
    for name, values in [*zip("XYZ", surface.points.T), *wide, *((name, array[:, 0]) for name, array in arrays.items()
                                                                   if array.shape[1] == 1)]:
        while name in columns:
            name += "_"
        values = (values.astype(np.uint8) if values.dtype == bool else values)[taken]
        columns[name] = (values + 0.0 if values.dtype.kind == "f" else values).tolist()  # -0.0 becomes 0.0.
    head = ["'" + name if name.startswith(("=", "+", "-", "@")) else name for name in columns]  # Spreadsheets must not take a name for a formula.
    write_csv(path, head, zip(*columns.values()))


def _save_ply(path, surface):
    """Writes the bytes that the program writes. A vector has the properties NAME_x, NAME_y and NAME_z."""
    arrays, columns = surface.point_arrays(), {}  # {property: values} of the points
    normals = arrays.pop("Normals", None)
    named = [(["x", "y", "z"], surface.points), (["nx", "ny", "nz"], normals)]
    for name, array in arrays.items():
        width = int(np.prod(array.shape[1:]))
        named.append(([name] if width == 1 else [f"{name}_{'xyz'[i] if width < 4 else i}" for i in range(width)], array))
    for names, array in named:
        if array is not None and array.dtype.kind in "fiub":
            array = array.astype(np.uint8) if array.dtype == bool else array
            array = array if array.dtype.str[1:] in PLY_TYPES else array.astype(np.float64)  # PLY has no int64.
            for name, column in zip(names, array.reshape(len(array), len(names)).T):
                name = re.sub("[\0- ]", "_", name)
                while name in columns:
                    name += "_"
                columns[name] = column
    lines = ["ply", "format binary_little_endian 1.0", "comment by marching-correctors", f"element vertex {len(surface.points)}",
             *(f"property {PLY_TYPES[column.dtype.str[1:]]} {name}" for name, column in columns.items()),
             f"element face {len(surface.triangles)}", "property list uchar uint vertex_indices", "end_header", ""]
    points = np.rec.fromarrays(list(columns.values()), [(name, "<" + column.dtype.str[1:]) for name, column in columns.items()])
    faces = np.zeros(len(surface.triangles), [("count", "u1"), ("corners", "<u4", 3)])
    faces["count"], faces["corners"] = 3, surface.triangles
    with writing(path), open(path, "wb") as file:
        for part in ("\n".join(lines).encode(errors="replace"), points.tobytes(), faces.tobytes()):
            file.write(part)


@dataclass(eq=False, repr=False)
class Samples(Result):
    """The field at points, in arrays of the shape (...) that the points (..., 3) had. Values are NaN at points that are not valid."""

    weight_sum: np.ndarray  #: (...) float64, of fluid particles
    valid: np.ndarray  #: (...) bool: the weight sum is not below node_threshold
    values: Dict[str, np.ndarray]  #: {name: (...) or (..., components)}, float32 or float64 as the attribute
    gradients: Dict[str, np.ndarray]  #: {name: (..., 3) or (..., components, 3)}, per L
    weight_gradient: Optional[np.ndarray] = None  #: (..., 3), 1 / L
    left_out: Dict[str, int] = dataclass_field(default_factory=dict)
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    def __repr__(self):
        return (f"<Samples: {self.valid.size} points, {int(self.valid.sum())} of them valid; "
                f"arrays: {self._names(('valid',))}>")

    def _point_arrays(self):
        """Returns all arrays under the names that VTK's filter gives them."""
        return {**self.values, **{name + "_Gradient": values for name, values in self.gradients.items()},
                "WeightSum": self.weight_sum, "vtkValidPointMask": self.valid.astype(np.uint8)}


@dataclass(eq=False, repr=False)
class Derivatives(Result):
    """Gradients at the particles."""

    gradients: Dict[str, np.ndarray]  #: {name: (particles, 3) or (particles, components, 3)}, per L
    corrected: np.ndarray  #: (particles,) bool: where the corrected form was taken
    left_out: Dict[str, int] = dataclass_field(default_factory=dict)
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    def __repr__(self):
        return (f"<Derivatives: {len(self.corrected)} particles, {int(self.corrected.sum())} of them corrected; "
                f"arrays: {self._names(('corrected',))}>")


@dataclass(eq=False, repr=False)
class Projection(Result):
    """An image of integrals along lines of sight; lengths have the unit of the positions (L)."""

    values: np.ndarray  #: (rows, columns) float64: means over pixels, scalar unit x L; the first row is the lowest
    extent: np.ndarray  #: (4,): left, right, lower and upper side, along the axes; as of matplotlib's imshow
    axes: np.ndarray  #: (3, 3): unit vectors along a row, from row to row, and the line of sight
    depth: float  #: where what is seen begins, along the line of sight
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    @property
    def pixel_area(self) -> float:
        """The area of a pixel, L^2. If the values are column densities, values.sum() * pixel_area is the mass in the image."""
        left, right, lower, upper = self.extent
        return float((right - left) * (upper - lower) / max(self.values.size, 1))

    def __repr__(self):
        rows, columns = self.values.shape
        return f"<Projection: {columns} x {rows} pixels>"


STATES = np.array(["dry", "wet", "full"])


@dataclass(eq=False, repr=False)
class Gauges(Result):
    """What gauges read along lines. first, last and crossings are distances from the line's beginning. All lengths have the positions'
    unit (L). On dry lines, first, last and place are NaN."""

    names: List[str]  #: of the lines; "0", "1", ... where none were given
    state: np.ndarray  #: (lines,) "dry": no fluid; "full": fluid at the line's end; "wet": else
    first: np.ndarray  #: (lines,) float64: where fluid first ends
    last: np.ndarray  #: (lines,) float64: where it last ends; at the line's end where full
    depth: np.ndarray  #: (lines,) float64: length in fluid
    place: np.ndarray  #: (lines, 3) float64: of `last`
    outside: np.ndarray  #: (lines,) bool: no particle reaches the line
    crossings: Dict[str, np.ndarray]  #: {name: float64}: where each line goes through the surface
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    def __repr__(self):
        counts = ", ".join(f"{int((self.state == state).sum())} {state}" for state in STATES)
        return f"<Gauges: {len(self.names)} lines, {counts}>"


@dataclass(eq=False, repr=False)
class Fluxes(Result):
    """Fluxes through the part of each section that is in fluid; units of positions (L), velocities and densities."""

    names: List[str]  #: of the sections; "0", "1", ... where none were given
    area: np.ndarray  #: (sections,) float64: of that part, L^2; in two dimensions a length
    volume_flux: np.ndarray  #: (sections,) float64: the integral of v . n
    mass_flux: np.ndarray  #: (sections,) float64: of rho v . n; NaN without densities
    velocity: np.ndarray  #: (sections,) float64: volume_flux / area; NaN where the area is 0
    outside: np.ndarray  #: (sections,) bool: no particle reaches the section
    statistics: Dict[str, Any] = dataclass_field(default_factory=dict)

    def __repr__(self):
        return f"<Fluxes: {len(self.names)} sections, {int((self.area > 0).sum())} in fluid>"
