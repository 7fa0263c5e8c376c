# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads HDF5 by h5py: GADGET-2/4, GIZMO, AREPO and SWIFT (PartType0, ..., in one file or several), Phantom, PySPH, H5Part (as SPH-EXA
writes it) and VTK's .vtkhdf. Only data sets in the file itself are read."""
import math
import os
import re
from typing import NamedTuple, Optional

import h5py
import numpy as np

from .._arrays import tells_of_walls
from ._particles import Body, FileError, Particles, check_claim, add_velocity, choose_step, find_kernel, usual_quantities
from .binary import files_of, make_phantom, no_particles, numbers_of

KEEP_SIZE = (2, 3)  # These filters of HDF5 do not pack: they shuffle bytes, or add a checksum.


def get(group, place):
    """Returns a member of a group by its path, or None. Raises FileError for a link, and for data that lie in other files,
    because a file of an attacker could name any file that the user may read."""
    file = os.path.basename(group.file.filename)
    for name in place.strip("/").split("/"):
        link = group.get(name, getlink=True) if isinstance(group, h5py.Group) else None
        if link is None:
            return None
        if not isinstance(link, h5py.HardLink):
            raise FileError(f"{file}: '{name}' is a link, which is not followed.")
        group = group[name]
    if isinstance(group, h5py.Dataset) and (group.is_virtual or group.external):
        raise FileError(f"{file}: '{place}' lies in other files, which are not opened. Give these files themselves.")
    return group


def is_numbers(thing):
    return isinstance(thing, h5py.Dataset) and thing.shape is not None and thing.dtype.kind in "fiub" and \
        thing.dtype.subdtype is None


def data_set(group, place):
    """Opens a data set of numbers."""
    data = get(group, place)
    if data is None or not is_numbers(data):
        raise FileError(f"{os.path.basename(group.file.filename)}: '{place}' is missing, or does not hold numbers.")
    check_storage(data)
    return data


def check_storage(data):
    """Refuses sizes that the file cannot hold: HDF5 makes room for the data set, and for a chunk, which may be larger. A
    chunk that is packed twice is refused, because it could grow to any size."""
    path, properties = data.file.filename, data.id.get_create_plist()
    name, there = os.path.basename(path), os.path.getsize(path)
    chunk = math.prod(data.chunks or ()) * data.dtype.itemsize
    check_claim(name, f"'{data.name}'", max(data.nbytes, chunk), there)
    packing = [properties.get_filter(i)[0] for i in range(properties.get_nfilters())]
    if sum(code not in KEEP_SIZE for code in packing) > 1:
        raise FileError(f"{name}: '{data.name}' is packed more than once, which is not read.")


class Part(NamedTuple):
    """The particles of one group of one file for which `keep` is true (None: all)."""
    file: os.PathLike
    group: str
    count: int
    keep: Optional[np.ndarray] = None

    def size(self):
        return self.count if self.keep is None else int(np.count_nonzero(self.keep))

    def where(self, mask):
        return self if mask.all() else self._replace(keep=mask)


def load(parts, name):
    """Returns the array `name` of all parts, one part after the other. Parts whose `keep` is None are read straight into the result."""
    result, begin = None, 0
    for part in parts:
        with h5py.File(part.file, "r") as file:
            data = data_set(file, f"{part.group}/{name}")
            if data.shape[:1] != (part.count,):
                raise FileError(f"{os.path.basename(part.file)}: '{data.name}' has the shape {data.shape} for {part.count} "
                                "particles.")
            if result is None:
                shape = (sum(each.size() for each in parts),) + data.shape[1:]
                result = np.empty(shape, data.dtype.newbyteorder("="))
            end = begin + part.size()
            if part.keep is not None:
                result[begin:end] = data[()][part.keep]
            elif part.count:
                data.read_direct(result, dest_sel=np.s_[begin:end])
            begin = end
    return result


def names_of(group, count, most=9):
    """Lists the names of the arrays of numbers with `count` rows and at most `most` dimensions."""
    check_claims([group])
    arrays = {name: get(group, name) for name in group if is_numbers(get(group, name))}
    return [name for name, array in arrays.items() if array.shape[:1] == (count,) and array.ndim <= most]


def check_claims(groups):
    """Raises FileError if all arrays of these groups together have more bytes than the file can hold: each array alone may be small
    enough, but many names may mean the same data."""
    claimed = sum(get(group, name).nbytes for group in groups for name in group if is_numbers(get(group, name)))
    for group in groups:
        path = group.file.filename
        check_claim(os.path.basename(path), f"'{group.name}'", claimed, os.path.getsize(path))


def number(attributes, name, default=None):
    """Returns an attribute's first number, or `default`."""
    try:
        value = np.ravel(attributes[name])[0]
        return value.item() if isinstance(value, np.generic) and value.dtype.kind in "fiub" else float(value)
    except (KeyError, IndexError, TypeError, ValueError):
        return default


def text(value):
    value = np.ravel(value)[0] if np.size(value) else ""
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def read_hdf5(path, types, step):
    """Reads a file. The names of its groups tell the layout."""
    with h5py.File(path, "r") as file:
        names = set(file)
        if is_h5part(names) and types is None:
            return read_h5part(path, file, step)
        choose_step(path.name, step, [0.0])
        if any(name.startswith("PartType") for name in names):
            return read_gadget(path, file, types)
        if types is not None:
            raise FileError(f"{path.name} is no snapshot of GADGET's layout: it has no types to choose.")
        if {"header", "particles"} <= names:
            return read_phantom(path, file)
        if {"solver_data", "particles"} <= names:
            return read_pysph(path, file)
    raise FileError(f"{path.name} is HDF5, but no layout that is known here: GADGET, GIZMO, AREPO and SWIFT have "
                    "PartType0, Phantom has header and particles, PySPH has solver_data and particles, "
                    "H5Part Step#0.")


# -- GADGET --

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
    """Returns the six bounds of the period. Returns None if the file does not say that the run is periodic: open runs have a BoxSize, too.
    AREPO is periodic along the axes that its Config does not make REFLECTIVE. The box is BoxSize times LONG_X (AREPO), or
    divided by 2^LONG_X_BITS (GADGET-4)."""
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


def read_gadget(path, file, types):
    wanted = numbers_of(types)
    header, parameters = describe_header(file)
    parts, names = find_parts(files_of(path, int(number(header, "NumFilesPerSnapshot", 1))), wanted)
    if not parts:
        raise no_particles(path, wanted)
    arrays = {name: lambda n=name: load(parts, n) for name in names if name != "Coordinates"}
    h = next((name for name in ("SmoothingLengths", "SmoothingLength") if name in arrays), None)
    swift, gamma = h == "SmoothingLengths", number(attributes(file, "HydroScheme"), "Kernel gamma")
    if swift and gamma is None:
        raise FileError(f"{path.name} is SWIFT's, but HydroScheme does not tell 'Kernel gamma', without which its "
                        "smoothing lengths mean nothing.")
    table = np.ravel(header.get("MassTable", []))

    def masses():
        kinds = [int(part.group[len("PartType"):]) for part in parts]
        for kind in kinds:
            if kind >= len(table) or not table[kind] > 0:
                raise FileError(f"{path.name} has no masses of type {kind}, neither Masses nor in MassTable.")
        return np.repeat([float(table[kind]) for kind in kinds], [part.count for part in parts])

    arrays.setdefault("Masses", masses)
    parameters["types"] = wanted
    return Particles(
        path.name, "SWIFT" if swift else "GADGET", lambda: load(parts, "Coordinates"), arrays, smoothing_length=h,
        support_radius=True, h_factor=gamma if swift else 1.0, mass="Masses", kernel=kernel_of(file, header),
        density=next((name for name in ("Densities", "Density") if name in arrays), None),
        dimension=2 if "TWODIMS" in attributes(file, "Config") else int(number(header, "Dimension", 3)),
        period=period_of(file, parameters["box_size"]), time=parameters["time"], parameters=parameters)


def find_parts(files, kinds):
    """Returns the parts that hold particles, and the names of the arrays of numbers that all parts have."""
    parts, names = [], None
    for kind in kinds:
        for path in files:
            with h5py.File(path, "r") as file:
                group = get(file, f"PartType{kind}")
                positions = None if group is None else get(group, "Coordinates")
                if positions is None or not is_numbers(positions) or not positions.shape or not positions.shape[0]:
                    continue
                parts.append(Part(path, group.name.strip("/"), positions.shape[0]))
                own = names_of(group, positions.shape[0])
                names = own if names is None else [name for name in names if name in own]
    return parts, names


# -- Phantom, PySPH, H5Part, VTK --

def read_phantom(path, file):
    header, gas = get(file, "header"), get(file, "particles")
    part = Part(path, "particles", len(data_set(gas, "xyz")))
    names = [name for name in names_of(gas, part.count) if name != "xyz"]
    values = {name: np.ravel(get(header, name)[()]) for name in header
              if is_numbers(get(header, name)) and get(header, name).size <= 64}
    alive = load([part], "h") > 0
    if "itype" in names:
        alive &= np.abs(load([part], "itype")) == 1
    there = [part.where(alive)]
    return make_phantom(path, alive.any(), lambda name: load(there, name), lambda: load(there, "xyz"), names, values)


def read_pysph(path, file):
    """Joins all of PySPH's particle arrays to one set. The names of the particle arrays tell which ones are walls."""
    particles = get(file, "particles")
    places = {name: get(particles, name) for name in particles}
    places = {name: place if get(place, "arrays") is None else get(place, "arrays") for name, place in places.items()}
    check_claims(places.values())
    sets = {}  # {name: (Part of this process's own particles (tag 0), names of arrays of one value each)}
    for name, place in places.items():
        part = Part(path, place.name, data_set(place, "x").size if get(place, "x") is not None else 0)
        names = names_of(place, part.count, 1)
        part = part.where(load([part], "tag") == 0) if "tag" in names else part
        if part.size():
            sets[name] = part, names
    if not sets:
        raise FileError(f"{path.name} has no particles.")
    solver = get(file, "solver_data").attrs
    solver = {name: number(solver, name) for name, value in solver.items() if np.asarray(value).dtype.kind in "fiub" and np.size(value) == 1}
    parts, counts = [part for part, _ in sets.values()], [part.size() for part, _ in sets.values()]
    walls = [tells_of_walls(name) for name in sets]
    fluids = [names for (_, names), wall in zip(sets.values(), walls) if not wall] or [names for _, names in sets.values()]
    names = [name for name in fluids[0] if all(name in each for each in fluids)]
    solid = np.repeat(walls, counts)

    def array(name):
        """Returns one array of all sets; 0 for walls that lack the array, because walls take no part in a field."""
        there = [name in each for _, each in sets.values()]
        found = load([part for part, has in zip(parts, there) if has], name)
        if all(there):
            return found
        whole = np.zeros(len(solid), found.dtype)
        whole[np.repeat(there, counts)] = found
        return whole

    def vector(letters):
        return np.stack([array(letter) if letter in names else np.zeros(len(solid)) for letter in letters], axis=1).astype(float, copy=False)

    arrays = {name: lambda n=name: array(n) for name in names}
    if {"u", "v"} <= set(names):
        arrays["Velocity"] = lambda: vector("uvw")
    flat = "z" not in names or not array("z").any()
    return Particles(path.name, "PySPH", lambda: vector("xyz"), arrays, smoothing_length="h" if "h" in names else None,
                     mass="m" if "m" in names else None, density="rho" if "rho" in names else None,
                     solid=solid if solid.any() and not solid.all() else None, time=solver.get("t"),
                     dimension=2 if flat else 3,
                     parameters={**solver, "sets": dict(zip(sets, counts))})


def is_h5part(names):
    return any(re.fullmatch("Step#[0-9]+", name) for name in names)


def read_h5part(path, file, step):
    """Reads one step: a group Step#N with x, y, z and arrays of one value per particle."""
    steps = sorted((int(name[5:]), name) for name in file if is_h5part([name]))
    found = [number(get(file, name).attrs, "time") for _, name in steps]
    times = [float(i) for i, _ in steps] if None in found else found
    i = choose_step(path.name, step, times)
    name = steps[i][1]
    group = get(file, name)
    axes = [axis for axis in "xyz" if get(group, axis) is not None]
    if len(axes) < 3:
        raise FileError(f"{path.name}: of x, y and z of its positions {name} has {', '.join(axes) or 'none'}.")
    part = Part(path, group.name, data_set(group, "x").size)
    arrays = {each: lambda n=each: load([part], n) for each in names_of(group, part.count, 1) if each not in axes}
    add_velocity(arrays, arrays)
    # SPH-EXA's attribute box is x0, x1, y0, ..., and its attribute boundaryType is 0 for open, 1 for periodic, 2 for fixed sides.
    box, kinds = np.ravel(group.attrs.get("box", ())), np.ravel(group.attrs.get("boundaryType", ()))
    is_box = len(box) == 6 and len(kinds) == 3 and np.isfinite(box.astype(float)).all()
    period = [float(side) if int(kinds[i // 2]) == 1 else 0.0 for i, side in enumerate(box)] if is_box else [0.0]
    return Particles(path.name, "H5Part", lambda: np.stack([load([part], axis) for axis in "xyz"], axis=1), arrays,
                     **usual_quantities(list(arrays)), time=times[i], times=times, period=period if any(period) else None)


def integers(group, place):
    data = data_set(group, place)
    if data.dtype.kind not in "iu":
        raise FileError(f"'{place}' does not hold whole numbers.")
    return np.ravel(data[()]).tolist()


def read_vtkhdf(path, step):
    """Reads one step of poly data or an unstructured grid: the points and their arrays. An array holds all steps, one after the other. The
    group Steps tells where each step begins: its parts (PartOffsets, NumberOfParts), its points (PointOffsets), and arrays that begin
    elsewhere (PointDataOffsets)."""
    with h5py.File(path, "r") as file:
        root = get(file, "VTKHDF")
        kind = text(root.attrs.get("Type", ""))
        if kind not in ("PolyData", "UnstructuredGrid"):
            raise FileError(f"{path.name} holds data of the type '{kind}', not particles (PolyData or UnstructuredGrid).")
        parts, offset, times = integers(root, "NumberOfPoints"), 0, None
        steps, arrays = get(root, "Steps"), get(root, "PointData")

        def of_step(name):
            found = integers(steps, name)
            if i >= len(found):
                raise FileError(f"{path.name} has no step {i} in 'Steps/{name}'.")
            return found[i]

        if steps is not None:
            times = [float(time) for time in np.ravel(data_set(steps, "Values")[()])]
            i = choose_step(path.name, step, times)
            first, offset = of_step("PartOffsets"), of_step("PointOffsets")
            count = of_step("NumberOfParts") if get(steps, "NumberOfParts") is not None else 1
            if min(first, count, offset) < 0 or first + count > len(parts):
                raise FileError(f"{path.name} has no parts {first} to {first + count} of step {i}.")
            parts = parts[first:first + count]
        total, found = sum(parts), {}

        def values(data, begin):
            if min(parts, default=0) < 0 or begin < 0 or begin + total > data.shape[0]:
                raise FileError(f"{path.name}: '{data.name}' has {data.shape[0]} values, not {total} from {begin} on.")
            return data[begin:begin + total]

        points = values(data_set(root, "Points"), offset)
        names = [name for name in arrays or () if is_numbers(get(arrays, name)) and get(arrays, name).ndim in (1, 2)]
        check_claims([arrays] if names else [])
        for name in names:
            own = f"PointDataOffsets/{name}"
            begin = of_step(own) if steps is not None and get(steps, own) is not None else offset
            found[name] = values(data_set(arrays, name), begin)
    return Body(points, found, None if times is None else times[i], times=times)
