# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Writes films as one USD file (.usdc, .usda, .usd): a mesh, lines and balls that change from step to step, with velocities. Uses
Pixar's package usd-core."""
from __future__ import annotations

import os
from typing import Any, Dict, NamedTuple, Optional, Sequence

import numpy as np

from ._library import InvalidArgument, warn
from ._options import did_you_mean
from ._surface import Surface
from .io.convert import Outputs
from .io._particles import FileError, usual

ENDINGS = (".usdc", ".usda", ".usd")
UNSAVED = 2 ** 25  # Steps that wait to be written have at most this many bytes.


def is_usd(path: Any) -> bool:
    return os.path.splitext(path)[1].lower() in ENDINGS


def find_velocity(arrays: Any, name: Optional[str] = None) -> Optional[str]:
    """Returns the name of the velocity's array: `name`, or a usual one, or None."""
    if name is not None and name not in arrays:
        raise InvalidArgument(f"There is no array '{name}' to be the velocity.{did_you_mean(name, arrays)} Arrays: "
                              f"{', '.join(arrays) or 'none'}.")
    found = name or usual([each for each in arrays if arrays[each].shape[1:] == (3,)], "velocity")
    if found is not None and arrays[found].shape[1:] != (3,):
        raise InvalidArgument(f"The array '{found}' cannot be the velocity, as it has the shape {arrays[found].shape}; a velocity "
                              "has three components.")
    return found


class Spray(NamedTuple):
    """Particles that are drawn as balls."""

    positions: np.ndarray  #: (particles, 3), L
    widths: np.ndarray  #: (particles,), L: diameters
    velocities: Optional[np.ndarray] = None  #: (particles, 3), L per unit of time
    ids: Optional[np.ndarray] = None  #: (particles,), integers


class Film:
    """A USD file to which surfaces are added, a step at a time, in the order of their times.

    Example: with Film("film.usdc", fps=24) as film: film.add(surface, time)

    The film is written to a file beside `path`, which gets the name `path` at the end of the with block, also if Ctrl-C or
    SystemExit ends the block after a step. Any other exception, or a block without a step, leaves no file. Steps are written to
    the disk during the block, and leave memory; the text of .usda is made from all steps at the end.

    path: .usdc (binary), .usda (text) or .usd. It cannot be one of the inputs.
    fps: frames of a second of film; a step's time code is time x fps x slow.
    slow: how many seconds of film a unit of time takes; velocities are divided by `slow`, to be per second of film.
    up: "y" or "z"; it may be set until the first step is added.
    meters_per_unit: how many metres a unit of length is.
    velocity: the name of the array that is the velocity; by default an array with a usual name.
    """

    def __init__(self, path: Any, inputs: Sequence[Any] = (), *, fps: float = 24.0, slow: float = 1.0, up: str = "z",
                 meters_per_unit: float = 1.0, velocity: Optional[str] = None) -> None:
        for name, value in (("fps", fps), ("slow", slow), ("meters_per_unit", meters_per_unit)):
            if not 0 < value < np.inf:
                raise InvalidArgument(f"{name} is {value}; it must be a number greater than 0.")
        try:
            import pxr.UsdGeom  # noqa: F401
        except ImportError:
            raise FileError(f"{os.path.basename(path)} needs the package usd-core, the extra [usd] of this one: pip install "
                            "usd-core.") from None
        self.path, self.fps, self.slow, self.up, self.meters_per_unit = os.fspath(path), fps, slow, up, meters_per_unit
        self.velocity, self.steps = velocity, 0
        self._first = self._last = None  # These are time codes.
        self._parts: Dict[str, _Part] = {}
        self._outputs, self._unsaved, self._left_out = Outputs(inputs, [path]), 0, set()

    def __enter__(self) -> Film:
        from pxr import Sdf, Tf, Usd, UsdGeom

        self._beside = self._outputs.beside(self.path)
        written = os.path.splitext(self._beside)[0] + ".usdc" if self.path.lower().endswith(".usda") else self._beside
        try:
            self._layer = Sdf.Layer.CreateNew(written)
        except Tf.ErrorException as error:
            self._outputs.__exit__(Tf.ErrorException)
            raise self._failure(error) from None
        self._layer.comment = "by marching-correctors"
        self._stage = Usd.Stage.Open(self._layer)
        self._stage.SetDefaultPrim(UsdGeom.Xform.Define(self._stage, "/film").GetPrim())
        return self

    def add(self, surface: Surface, time: float = 0.0, velocities: Optional[np.ndarray] = None,
            spray: Optional[Spray] = None) -> None:
        """Adds the surface of one time, which must be later than the times of the surfaces before.

        velocities: (points, 3); by default the surface's array that is the velocity.
        spray: particles beside the surface.
        """
        from pxr import UsdGeom

        code = round(float(time) * self.fps * self.slow, 6)  # Without the rounding, a whole frame could be off by a bit.
        if not np.isfinite(code) or self._last is not None and code <= self._last:
            raise InvalidArgument(f"The time {time:g} does not come after that of the step before. Put the steps in order, or give the "
                                  "time between them (in a shell --time-step).")
        arrays = {name: array for name, array in surface.point_arrays().items() if name != "Normals"}
        name = find_velocity(arrays, self.velocity) if velocities is None and len(surface.points) else None
        velocities = arrays[name] if name else velocities
        wanted = {}
        if surface.line_offsets is not None:
            wanted["lines"] = self._lines_of(surface, arrays, velocities)
        if len(surface.triangles) or "lines" not in {*wanted, *self._parts}:
            wanted["surface"] = self._mesh_of(surface, arrays, velocities)
        if spray is not None:
            wanted["spray"] = "Points", {
                "points": ("Point3f", spray.positions), "widths": ("Float", spray.widths), **self._common({}, spray.velocities),
                "extent": ("Float3", _extent(spray.positions, np.max(spray.widths, initial=0.0) / 2)),
                **({} if spray.ids is None else {"ids": ("Int64", spray.ids)})}
        try:
            if self._first is None:
                if self.up not in ("y", "z"):
                    raise InvalidArgument(f"up is '{self.up}'; USD knows y and z.")
                self._first = code
                UsdGeom.SetStageUpAxis(self._stage, self.up.upper())
                UsdGeom.SetStageMetersPerUnit(self._stage, self.meters_per_unit)
                self._stage.SetFramesPerSecond(self.fps)
                self._stage.SetTimeCodesPerSecond(self.fps)
                self._stage.SetStartTimeCode(code)
            for name, (kind, _) in wanted.items():
                if name not in self._parts:
                    self._parts[name] = _Part(self._stage, kind, name)
            for name, part in self._parts.items():
                self._unsaved += part.write(code, wanted[name][1] if name in wanted else {}, self._first)
        except BaseException:  # A step is written whole or not at all.
            for part in self._parts.values():
                part.clear(code)
            raise
        self._last = code
        self._stage.SetEndTimeCode(code)
        self.steps += 1
        if self._unsaved > UNSAVED:
            self._save()

    def _common(self, arrays, velocities, of_points=lambda array: array):
        """Returns {name: (type, values)} of the velocities, and of a primvar for each array. of_points(array): the values at the prim's points."""
        values = {}
        if velocities is not None:
            values["velocities"] = ("Vector3f", of_points(velocities) / self.slow)
        for name, array in arrays.items():
            if array.dtype.kind in "iu" and array.size and (array.min() < -2 ** 31 or array.max() >= 2 ** 31):
                if name not in self._left_out:
                    warn(f"The array '{name}' is left out of {os.path.basename(self.path)}, whose integers have 32 bits.")
                self._left_out.add(name)
            # Blender takes an array "velocity" for the velocities, so the array is left out if `slow` changes the
            # velocities.
            elif array.dtype.kind in "fiub" and (name != "velocity" or self.slow == 1 or velocities is None):
                width = int(np.prod(array.shape[1:]))
                kind = "Float" if array.dtype.kind == "f" else "Int"
                values["primvars:" + name] = (f"{kind}{width}" if 1 < width < 5 else kind, of_points(array))
        return values

    def _mesh_of(self, surface, arrays, velocities):
        return "Mesh", {"points": ("Point3f", surface.points), "extent": ("Float3", _extent(surface.points)),
                        "faceVertexCounts": ("Int", np.full(len(surface.triangles), 3)),
                        "faceVertexIndices": ("Int", surface.triangles.ravel()),
                        **({} if surface.normals is None else {"normals": ("Normal3f", surface.normals)}),
                        **self._common(arrays, velocities)}

    def _lines_of(self, surface, arrays, velocities):
        """Makes curves. Their width is half the median length of their segments."""
        at = surface.line_points
        points, counts = surface.points[at], np.diff(surface.line_offsets)
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)[np.setdiff1d(
            np.arange(max(len(points) - 1, 0)), surface.line_offsets[1:] - 1)]
        width = 0.5 * np.median(lengths) if len(lengths) else 0.0
        return "BasisCurves", {"points": ("Point3f", points), "extent": ("Float3", _extent(points, width / 2)),
                               "curveVertexCounts": ("Int", counts), "widths": ("Float", np.full(len(points), width)),
                               **self._common(arrays, velocities, lambda array: array[at])}

    def _save(self):
        from pxr import Tf

        try:
            if not self._layer.Save():
                raise self._failure("it could not be saved")
        except Tf.ErrorException as error:
            raise self._failure(error) from None
        self._unsaved = 0

    def _failure(self, error):
        words = f"{error}\n".partition(" : '")[2].partition("'\n")[0] or str(error)  # of the first of USD's errors
        return FileError(f"{self.path} could not be written: {' '.join(words.split())[:200]}")

    def __exit__(self, kind: Any, *_: Any) -> None:
        ended = kind is not None and issubclass(kind, (KeyboardInterrupt, SystemExit))
        is_whole = self.steps > 0 and (kind is None or ended)
        try:
            if is_whole:
                self._save()
                if self._layer.realPath != os.path.realpath(self._beside):
                    self._layer.Export(self._beside)
        except BaseException:
            is_whole = False
            raise
        finally:
            self._parts, self._stage, self._layer = {}, None, None  # This closes the file.
            self._outputs.__exit__(None if is_whole else Exception)


def _extent(points, more=0.0):
    if not len(points):
        return np.zeros((2, 3))
    return np.array([points.min(axis=0) - more, points.max(axis=0) + more])


class _Part:
    """A prim with attributes that all have a value at each time code. An attribute that a step lacks is blocked at the step's time, or is
    empty if the step has no points of this prim; otherwise the previous step's value would stay."""

    def __init__(self, stage, kind, name):
        from pxr import UsdGeom

        self.prim = getattr(UsdGeom, kind).Define(stage, f"/film/{name}").GetPrim()
        if kind == "Mesh":
            UsdGeom.Mesh(self.prim).CreateSubdivisionSchemeAttr("none")
            UsdGeom.Mesh(self.prim).SetNormalsInterpolation("vertex")
        elif kind == "BasisCurves":
            UsdGeom.BasisCurves(self.prim).CreateTypeAttr("linear")
            UsdGeom.BasisCurves(self.prim).CreateWrapAttr("nonperiodic")
        self.attributes, self.names = {}, set()  # {our name: (attribute, USD's type of array)}

    def write(self, code, values, first):
        """Sets values: {name: (type, array)}; first: the film's first time code. Returns about how many bytes the values have."""
        from pxr import Sdf

        has_points, is_new, size = bool(values) and len(values["points"][1]) > 0, not self.attributes, 0
        for name, (usd, array) in values.items():
            if name not in self.attributes:
                self.attributes[name] = self.make(name, usd, array), usd
                if code > first:
                    self.attributes[name][0].Set(_nothing(name, usd) if is_new else Sdf.ValueBlock(), first)
            attribute, usd = self.attributes[name]
            attribute.Set(_to_usd(usd, array), code)
            size += 4 * array.size
        for name, (attribute, usd) in self.attributes.items():
            if name not in values:
                attribute.Set(Sdf.ValueBlock() if has_points else _nothing(name, usd), code)
        return size

    def make(self, name, usd, array):
        from pxr import Sdf, Tf, UsdGeom

        if not name.startswith("primvars:"):
            return self.prim.GetAttribute(name)
        valid = name[len("primvars:"):]
        valid = Tf.MakeValidIdentifier("_" * valid[:1].isdigit() + valid)
        while valid in self.names:
            valid += "_"
        self.names.add(valid)
        primvar = UsdGeom.PrimvarsAPI(self.prim).CreatePrimvar(valid, getattr(Sdf.ValueTypeNames, usd + "Array"), "vertex")
        width = int(np.prod(array.shape[1:]))
        if width > 4:
            primvar.SetElementSize(width)
        return primvar.GetAttr()

    def clear(self, code):
        for attribute, _ in self.attributes.values():
            attribute.ClearAtTime(code)


def _nothing(name, usd):
    return _to_usd(usd, np.zeros((2, 3)) if name == "extent" else np.empty(0))


def _to_usd(usd, array):
    from pxr import Sdf

    empty = getattr(Sdf.ValueTypeNames, usd + "Array").defaultValue
    plain = np.asarray(empty)
    return type(empty).FromNumpy(np.ascontiguousarray(array, plain.dtype).reshape(-1, *plain.shape[1:])) if array.size else empty
