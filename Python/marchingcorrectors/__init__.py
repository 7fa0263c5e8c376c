# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Isosurfaces of SPH particles, exact with respect to the SPH field.

    surface = marchingcorrectors.isosurface(positions, speed, 1.0, smoothing_length=h, volume=V)
    surface.points, surface.triangles, surface.normals

With PyVista: particles.sph.isosurface("Velocity", 1.0). With VTK: vtkMarchingCorrectors.
"""
import sys as _sys
from pkgutil import extend_path as _extend_path
from typing import TYPE_CHECKING, Any, List

from ._context import Context
from ._functions import derivatives, flow, free_surface, isosurface, probe, project, widening
from ._library import (Cancelled, DeviceError, Error, InputWarning, InvalidArgument, InvalidData, OutOfCapacity,
                       devices)
from ._meters import Fluxes, Gauges, flux, gauge
from ._structs import VERSION as __version__
from ._surface import Derivatives, Projection, Samples, Surface

if TYPE_CHECKING:
    import pyvista

    from . import io as io

    vtkMarchingCorrectors: Any
    vtkSPHComponents: Any
    vtkSPHDerivatives: Any
    vtkSPHFlux: Any
    vtkSPHGauge: Any
    vtkSPHProbe: Any
    vtkSPHProjection: Any
    vtkSPHResample: Any
    vtkSPHTemporalInterpolator: Any

__all__ = ["Cancelled", "Context", "Derivatives", "DeviceError", "Error", "Fluxes", "Gauges", "InputWarning", "InvalidArgument",
           "InvalidData", "OutOfCapacity", "Projection", "Samples", "Surface", "derivatives", "devices", "flow",
           "flux", "free_surface", "gauge", "isosurface", "probe", "project", "read_pyvista", "widening"]

# CMake may have installed the C++ filter in another folder of the same name.
__path__ = _extend_path(__path__, __name__)


def read_pyvista(path: Any, **words: Any) -> "pyvista.PolyData":
    """A solver's file as pyvista.PolyData, for particles.sph. words: the keywords of io.read().

    Example: read_pyvista("snapshot.hdf5").sph.isosurface("Density", 1e-4).plot()
    """
    import pyvista

    from .io import read
    from .io.convert import to_vtk

    return pyvista.wrap(to_vtk(read(path, **words)))


def __dir__() -> List[str]:
    return sorted([*__all__, "__version__", "io", "vtkMarchingCorrectors"])


if not TYPE_CHECKING:  # Type checkers know only the names above.
    def __getattr__(name):
        """Imports VTK's classes, and io, when they are asked for, because NumPy users need no VTK."""
        if name == "io":
            from importlib import import_module

            return import_module(".io", __name__)
        if name == "vtkMarchingCorrectors" or name.startswith("vtkSPH"):
            from ._vtk import find_class

            try:
                return find_class(name)
            except ImportError as error:
                if _sys._getframe(1).f_globals.get("__name__") == "importlib._bootstrap":
                    raise  # "from marchingcorrectors import ..." shows this sentence.
                raise AttributeError(str(error)) from None
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
