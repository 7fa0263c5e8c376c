# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Isosurfaces of SPH particles, exact with respect to the SPH field.

    surface = marchingcorrectors.isosurface(positions, speed, 1.0, smoothing_length=h, volume=V)
    surface.points, surface.triangles, surface.normals

With PyVista: particles.sph.isosurface("Velocity", 1.0). With VTK: vtkMarchingCorrectors.
"""
import sys as _sys
from importlib import import_module as _import_module
from pathlib import Path as _Path
from pkgutil import extend_path as _extend_path
from typing import TYPE_CHECKING, Any, List

from ._functions import derivatives, flow, flux, free_surface, gauge, isosurface, probe, project, widening
from ._library import (Cancelled, Context, DeviceError, Error, InputWarning, InvalidArgument, InvalidData, OutOfCapacity,
                       devices)
from ._structs import VERSION as __version__
from ._surface import Derivatives, Fluxes, Gauges, Projection, Samples, Surface

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
    """Reads a solver's file into a pyvista.PolyData, which has the methods of .sph. words: the keywords of io.read().

    Example: read_pyvista("snapshot.hdf5").sph.isosurface("Density", 1e-4).plot()
    """
    import pyvista

    from .io import read
    from .io.convert import to_vtk

    return pyvista.wrap(to_vtk(read(path, **words)))


def __dir__() -> List[str]:
    return sorted([*__all__, "__version__", "io", "vtkMarchingCorrectors"])


def _find_class(name: str) -> Any:
    """Returns the class `name` in C++ or, if not built, in Python (vtkMarchingCorrectors alone). Raises ImportError if there is neither."""
    try:
        import vtkmodules
    except ImportError:
        raise ImportError("VTK was not found: pip install vtk, or pip install pyvista.") from None
    module: Any = None
    # A VTK from a wheel has no headers, so the C++ class was built against another VTK, and must not be loaded beside the wheel's VTK.
    if any(list(_Path(folder).glob("vtkMarchingCorrectors*.so")) for folder in __path__) and not list(
            _Path(vtkmodules.__file__).resolve().parents[1].glob("vtk-*.dist-info")):
        try:
            import vtkmodules.vtkCommonExecutionModel  # noqa: F401  superclasses come first

            module = _import_module(".vtkMarchingCorrectors", __name__)
        except ImportError:
            pass  # The class was built for another Python, or its VTK is gone.
    if module is None and name == "vtkMarchingCorrectors":
        module = _import_module(".MarchingCorrectorsFilter", __name__)
    if module is None or not hasattr(module, name):
        raise ImportError(f"{name} is there in C++ only: build the sources with CMake for this VTK.")
    globals()[name] = getattr(module, name)  # This replaces the module of the same name, which the import has put into the package.
    return globals()[name]


if not TYPE_CHECKING:  # Type checkers know only the names above.
    def __getattr__(name):
        """Imports VTK's classes, and io, when they are asked for, because NumPy users need no VTK."""
        if name == "io":
            return _import_module(".io", __name__)
        if name == "vtkMarchingCorrectors" or name.startswith("vtkSPH"):
            try:
                return _find_class(name)
            except ImportError as error:
                if _sys._getframe(1).f_globals.get("__name__") == "importlib._bootstrap":
                    raise  # "from marchingcorrectors import ..." shows this sentence.
                raise AttributeError(str(error)) from None
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
