# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads HDF5 of GADGET-2/4, GIZMO, AREPO and SWIFT: PartType0, ..., in one file or several."""
import re

import numpy as np

from ._particles import FileError, Particles, find_kernel
from .hdf5 import Part, get, is_numbers, load, names_of

TYPES = {"gas": 0, "dark_matter": 1, "disk": 2, "bulge": 3, "stars": 4, "black_holes": 5, "boundary": 5, "sinks": 3,
         "neutrinos": 6}


def number(attributes, name, default=None):
    """Returns an attribute's first number."""
    try:
        value = np.ravel(attributes[name])[0]
        return value.item() if isinstance(value, np.generic) and value.dtype.kind in "fiub" else float(value)
    except (KeyError, IndexError, TypeError, ValueError):
        return default


def text(value):
    value = np.ravel(value)[0] if np.size(value) else ""
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def files_of(path, count):
    """Lists all files of a snapshot that has several, NAME.0.hdf5, ..., or NAME.0, ..."""
    found = re.fullmatch(r"(.*)\.(\d+)(\.h(?:df)?5|)", path.name)
    if count <= 1 or not found:  # Some whole files say 0.
        return [path]
    if count > 65536:
        raise FileError(f"{path.name} claims to be one of {count} files.")
    files = [path.with_name(f"{found[1]}.{i}{found[3]}") for i in range(count)]
    missing = [file.name for file in files if not file.is_file()]
    if missing:
        raise FileError(f"{path.name} is one of {count} files of a snapshot; {missing[0]} is missing.")
    return files


def numbers_of(types):
    chosen = [types] if isinstance(types, (str, int)) else list(types)
    numbers = []
    for kind in chosen:
        if isinstance(kind, str) and kind not in TYPES:
            raise FileError(f"There is no type '{kind}': {', '.join(TYPES)}, or a number.")
        numbers.append(TYPES[kind] if isinstance(kind, str) else int(kind))
    return numbers


def describe_header(file):
    header = dict(attributes(file, "Header"))
    found = {"time": number(header, "Time"), "redshift": number(header, "Redshift"),
             "hubble_parameter": number(header, "HubbleParam"), "units": {}}
    box = np.ravel(header.get("BoxSize", []))
    found["box_size"] = [float(side) for side in (box if len(box) == 3 else box[:1].repeat(3))] if len(box) else None
    for source in (header, attributes(file, "Units")):
        for name, value in source.items():
            if name.startswith("Unit") and np.size(value) == 1:
                found["units"][name] = number({name: value}, name)
    found["scale_factor"] = number(attributes(file, "Cosmology"), "Scale-factor")
    if found["scale_factor"] is None and found["redshift"]:
        found["scale_factor"] = 1 / (1 + found["redshift"])
    return header, found


def attributes(file, name):
    group = get(file, name)
    return {} if group is None else group.attrs


def period_of(file, box):
    """Returns the period if the file says that the run is periodic: open runs have a BoxSize, too. AREPO is periodic along the
    axes that its Config does not make REFLECTIVE. The box is BoxSize times LONG_X (AREPO), or over 2^LONG_X_BITS (GADGET-4)."""
    parameters, config = attributes(file, "Parameters"), attributes(file, "Config")
    periodic = number(parameters, "InitialConditions:periodic", 0) == 1 or "PERIODIC" in config \
        or len(config) and "PeriodicBoundariesOn" in parameters
    if not periodic or box is None:
        return None
    box = [side * number(config, f"LONG_{axis}", 1) * 0.5 ** number(config, f"LONG_{axis}_BITS", 0)
           for side, axis in zip(box, "XYZ")]
    if not all(np.isfinite(side) and side > 0 for side in box):
        return None
    ends = [0.0 if f"REFLECTIVE_{axis}" in config else side for side, axis in zip(box, "XYZ")]
    return [bound for end in ends for bound in (0.0, end)] if any(ends) else None


# These are GIZMO's numbers of the kernels that exist here.
GIZMO_KERNELS = {3: "cubic", 4: "quartic", 5: "quintic", 6: "Wendland C2", 7: "Wendland C4", 9: "Wendland C6"}


def kernel_of(file, header):
    """Finds the kernel: by SWIFT's name, GIZMO's number, or GADGET-4's macro; None if the file does not tell."""
    scheme = attributes(file, "HydroScheme")
    if "Kernel function" in scheme:
        return text(scheme["Kernel function"])
    identity = number(header, "Kernel_Function_ID")
    if identity is not None:
        return GIZMO_KERNELS.get(int(identity), f"GIZMO's number {identity}")
    macros = [name for name in attributes(file, "Config") if name.endswith("_KERNEL")]
    return next(filter(find_kernel, macros), None)


def read_gadget(path, types):
    import h5py

    wanted = numbers_of(0 if types is None else types)
    with h5py.File(path, "r") as file:
        header, parameters = describe_header(file)
        files = files_of(path, int(number(header, "NumFilesPerSnapshot", 1)))
        period = period_of(file, parameters["box_size"])
        gamma = number(attributes(file, "HydroScheme"), "Kernel gamma")
        kernel = kernel_of(file, header)
        dimension = 2 if "TWODIMS" in attributes(file, "Config") else number(header, "Dimension", 3)
    parts, names = [], None
    for kind in wanted:
        found, own = find_parts(files, f"PartType{kind}")
        parts += found
        names = own if names is None or not found else [name for name in names if name in own]
    if not parts:
        raise FileError(f"{path.name} has no particles of type {', '.join(map(str, wanted))}.")

    arrays = {name: lambda n=name: load(parts, n) for name in names if name != "Coordinates"}
    h = next((name for name in ("SmoothingLengths", "SmoothingLength") if name in arrays), None)
    swift = h == "SmoothingLengths"
    if swift and gamma is None:
        raise FileError(f"{path.name} is SWIFT's, but HydroScheme does not tell 'Kernel gamma', without which its "
                        "smoothing lengths mean nothing.")
    if "Masses" not in arrays:
        table = np.ravel(header.get("MassTable", []))

        def masses():
            kinds = [int(part.group[len("PartType"):]) for part in parts]
            for kind in kinds:
                if kind >= len(table) or not table[kind] > 0:
                    raise FileError(f"{path.name} has no masses of type {kind}, neither Masses nor in MassTable.")
            return np.repeat([float(table[kind]) for kind in kinds], [part.count for part in parts])

        arrays["Masses"] = masses
    density = next((name for name in ("Densities", "Density") if name in arrays), None)
    parameters["types"] = wanted
    return Particles(
        path.name, "SWIFT" if swift else "GADGET", lambda: load(parts, "Coordinates"), arrays, smoothing_length=h,
        support_radius=True, h_factor=gamma if swift else 1.0, mass="Masses", density=density, kernel=kernel,
        dimension=int(dimension), period=period, time=parameters["time"], parameters=parameters)


def find_parts(files, group):
    """Returns where the particles are, and the names of the arrays of numbers that all files have."""
    import h5py

    parts, names = [], None
    for path in files:
        with h5py.File(path, "r") as file:
            kind = get(file, group)
            positions = None if kind is None else get(kind, "Coordinates")
            if positions is None or not is_numbers(positions) or not positions.shape or not positions.shape[0]:
                continue
            parts.append(Part(path, group, positions.shape[0]))
            own = names_of(kind, positions.shape[0])
            names = own if names is None else [name for name in names if name in own]
    return parts, names or []
