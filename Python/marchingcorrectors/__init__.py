# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Isosurfaces of SPH particles, exact with respect to the SPH field.

    surface = marchingcorrectors.isosurface(positions, speed, 1.0, smoothing_length=h, volume=V)
    surface.points, surface.triangles, surface.normals

With PyVista: particles.sph.isosurface("Velocity", 1.0). With VTK: vtkMarchingCorrectors.
"""
from pkgutil import extend_path as _extend_path

from ._context import Context
from ._functions import derivatives, flow, free_surface, isosurface, probe
from ._gauge import Gauges, gauge
from ._library import (Cancelled, DeviceError, Error, InvalidArgument, InvalidData, OutOfCapacity,
                       devices)
from ._structs import VERSION as __version__
from ._surface import Derivatives, Samples, Surface
from ._warnings import InputWarning

__all__ = ["Cancelled", "Context", "Derivatives", "DeviceError", "Error", "Gauges", "InputWarning", "InvalidArgument",
           "InvalidData", "OutOfCapacity", "Samples", "Surface", "derivatives", "devices", "flow",
           "free_surface", "gauge", "isosurface", "probe", "read_pyvista"]

# The C++ filter lies in a folder of the same name, where CMake installed it.
__path__ = _extend_path(__path__, __name__)


def read_pyvista(path, **words):
    """A solver's file as pyvista.PolyData, for particles.sph; words are those of io.read()."""
    import pyvista

    from .io import read
    from .io.convert import to_vtk

    return pyvista.wrap(to_vtk(read(path, **words)))


def __getattr__(name):
    """VTK's classes, and io, when they are asked for: NumPy users need no VTK."""
    if name == "io":
        from importlib import import_module

        return import_module(".io", __name__)
    if name == "vtkMarchingCorrectors" or name.startswith("vtkSPH"):
        from ._vtk import find_class

        return find_class(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
