# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Loads the VTK classes: the C++ classes if they were built, else the filter in Python."""
from importlib import import_module
from pathlib import Path


def _is_from_pypi(vtkmodules):
    """Returns whether VTK comes from a wheel. Wheels bring no headers, so no C++ class can have
    been built against one, and a class built against another VTK must not be loaded beside it."""
    folder = Path(vtkmodules.__file__).resolve().parent.parent
    return any(folder.glob("vtk-*.dist-info"))


def find_class(name):
    try:
        import vtkmodules
    except ImportError:
        raise ImportError("VTK was not found: pip install vtk, or pip install pyvista.") from None
    package, module = import_module(__package__), None
    built = any(list(Path(folder).glob("vtkMarchingCorrectors*.so")) for folder in package.__path__)
    if built and not _is_from_pypi(vtkmodules):
        try:
            import vtkmodules.vtkCommonExecutionModel  # noqa: F401  superclasses come first

            module = import_module(".vtkMarchingCorrectors", __package__)
        except ImportError:
            pass  # The class was built for another Python, or its VTK is gone.
    if module is None and name == "vtkMarchingCorrectors":
        module = import_module(".MarchingCorrectorsFilter", __package__)
    if module is None or not hasattr(module, name):
        raise ImportError(f"{name} is there in C++ only: build the sources with CMake for this VTK.")
    found = getattr(module, name)
    # This replaces the module of the same name, which the import has put into the package.
    setattr(package, name, found)
    return found
