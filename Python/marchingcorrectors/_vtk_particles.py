# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The particles of a VTK data set as arguments of the core, as vtkSPHParticles finds them in C++."""
import ctypes

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkDoubleArray, vtkFloatArray
from vtkmodules.vtkCommonDataModel import vtkDataObject

from . import _structs as c
from ._arrays import QUANTITIES, SUMMED, Arguments, camel, place_period
from ._library import lib
from ._warnings import describe_unused_type

GHOSTS = "vtkGhostType"
WALL_BLOCK = "WallBlock"  # of blocks that are one set: whether its name tells of walls


class Unusable(Exception):
    """The sentence that says what is missing or wrong."""


def real_name(name):
    """The name, but for words that lists show in place of an array, as in ParaView's panel."""
    return "" if name in ("(automatic)", "(none)") else name


def name_of(array):
    return (array.GetName() if array is not None else None) or ""


def names_of(data):
    return [name_of(data.GetAbstractArray(i)) for i in range(data.GetNumberOfArrays())]


def arrays_of(data):
    """The arrays that hold numbers."""
    return [array for array in map(data.GetArray, range(data.GetNumberOfArrays())) if array is not None]


def is_single(array):
    return array.GetDataTypeAsString() == "float"


def is_real(array):
    return array.GetDataTypeAsString() in ("float", "double")


def to_numpy(array):
    """float and double arrays where they lie, all others as a copy in double."""
    if not isinstance(array, (vtkFloatArray, vtkDoubleArray)):
        copy = vtkDoubleArray()
        copy.DeepCopy(array)
        array = copy
    return vtk_to_numpy(array)


def rank(data, quantity, count=None, components=1):
    """Point arrays of so many components with usual names for a quantity, the most usual first. The core has the names."""
    number = c.ENUMS["mcor_quantity"]["MCOR_" + quantity.upper()]
    ranks = [(lib.mcor_name_priority(number, name_of(array).encode(errors="replace")), array) for array in arrays_of(data)
             if array.GetNumberOfComponents() == components and count in (None, array.GetNumberOfTuples())]
    return [array for place, array in sorted(ranks, key=lambda pair: pair[0]) if place >= 0]


def detect(data, count, quantity, components=1):
    return next(iter(rank(data, quantity, count, components)), None)


def join_velocity(data, count):
    """The point arrays vx, vy and vz as one vector, "Velocity", of float only where all are; None where they
    are not there, or such an array is."""
    parts = [data.GetArray(name) for name in ("vx", "vy", "vz")]
    if data.HasArray("Velocity") or not all(
            part is not None and is_real(part) and part.GetNumberOfComponents() == 1
            and part.GetNumberOfTuples() == count for part in parts):
        return None
    kind = np.float32 if all(map(is_single, parts)) else np.float64
    joined = numpy_to_vtk(np.stack(list(map(to_numpy, parts)), axis=1).astype(kind), deep=True)
    joined.SetName("Velocity")
    return joined


def list_names(data):
    return f"Point arrays: {', '.join(names_of(data))}." if data.GetNumberOfArrays() else "The input has no point arrays."


def describe_missing_length(data, remedy):
    """data: point data. remedy: what to do, without the full stop."""
    text = (f"The particles have no smoothing length. {remedy}; no point array has one of its usual names "
            "(SmoothingLength, hsml, h, ...). ")
    if lib.mcor_find_layout("\n".join(names_of(data)).encode(errors="replace")) == b"DualSPHysics":
        text += "DualSPHysics does not store it: it is coefh x sqrt(3) x dp. "
    spacing = detect(data, None, "spacing")
    low, high = (0.0, -1.0) if spacing is None else spacing.GetRange()
    if 0 < low == high:
        text += f"By '{name_of(spacing)}', particles are {low:g} apart: {1.3 * low:g} is usual. "
    return text + list_names(data)


def rank_of(array):
    """How fit it is to be looked at where nobody has chosen an array; -1: not."""
    varies = any(low < high for low, high in map(array.GetRange, range(array.GetNumberOfComponents())))
    return lib.mcor_view_priority(name_of(array).encode(), array.GetNumberOfComponents(), is_real(array), varies)


def choose_array(arrays):
    """The fittest one; None where none is."""
    ranks = [(place, i) for i, place in enumerate(map(rank_of, arrays)) if place >= 0]
    return arrays[min(ranks)[1]] if ranks else None


def find_fittest(points):
    joined = join_velocity(points.GetPointData(), points.GetNumberOfPoints())
    return choose_array(arrays_of(points.GetPointData())) if joined is None else joined


def varies(array, on_surface):
    """Whether there is more of it than the noise of what is contoured. Colours are those of magnitudes."""
    if on_surface is None or on_surface.GetNumberOfTuples() == 0:
        return False
    kind = -1 if array.GetNumberOfComponents() > 1 else 0
    (low, high), (least, most) = on_surface.GetRange(kind), array.GetRange(kind)
    return high - low > 0.03 * (most - least)


def find_fluid(data):
    """The array and its value that clearly tell which particles are fluid; None where none does."""
    for array in rank(data, "particle_type"):
        values, fluid = np.unique(to_numpy(array)), ctypes.c_double()
        if 0 < len(values) <= 8 and (values == np.floor(values)).all() and lib.mcor_find_fluid_value(
                name_of(array).encode(), values[0], values[-1], ctypes.byref(fluid)):
            return name_of(array), fluid.value
    return None


def describe_unused_types(data):
    """A sentence about the first array that does, although all particles count as fluid; or ""."""
    sentences = (describe_unused_type(name_of(array), to_numpy(array)) for array in rank(data, "particle_type"))
    return next(filter(None, sentences), "")


def find_period(points):
    """Six bounds that the field data tell of; None where they tell of none."""
    found, period = [], (ctypes.c_double * 6)()
    for array in arrays_of(points.GetFieldData()):
        name, count = name_of(array).encode(errors="replace"), array.GetNumberOfValues()
        if lib.mcor_tells_of_period(name) and count <= 6:
            values = (ctypes.c_double * max(count, 1))(*to_numpy(array).ravel())
            found.append(c.mcor_field_data(name=name, values=values, count=count))
    count = lib.mcor_find_period((c.mcor_field_data * max(len(found), 1))(*found), len(found), period, None)
    if count == 3:
        return place_period(period[:3], points.GetBounds())
    return list(period) if count else None


class Particles:
    """Finds the arrays; raises Unusable. choice: the filter's properties, copied."""

    def __init__(self, choice, points):
        self.choice, self.points = choice, points
        found = find_fluid(points.GetPointData()) if choice.DetectFluid and not real_name(choice.FluidArrayName) else None
        if found:
            choice.FluidArrayName, choice.FluidValue = found
        self.data, self.count = points.GetPointData(), points.GetNumberOfPoints()
        self.positions = points.GetPoints().GetData()
        self.scalar = self.dot = self.fluid = None
        self.used = dict.fromkeys(QUANTITIES)  # arrays
        self.values = {}  # arrays or constants for the core, by quantity
        self.scalar_name, self.iso_value_name = "", "IsoValue"
        self.contoured = None  # the name of the array that is the iso value on the surface, if one is
        # {name: array}: an observer of the progress may call the array by another name.
        self.interpolated, self.from_nearest = {}, {}
        self.solid = self.present = None

    def collect(self, requests, taken, options=None):
        """options: the core's, by which densities are summed where there is no array of them."""
        wanted = requests[0]
        is_summed = options and not self.choice.FreeSurface and wanted.name == SUMMED and wanted.array is None
        if not self.choice.FreeSurface and not is_summed:
            self.collect_scalar(*requests)
        self.collect_quantities()
        self.collect_solids()
        if is_summed:
            wanted.array = self.sum_densities(options)
            self.collect_scalar(*requests)
        self.name_scalar(taken)
        if self.choice.InterpolateAttributes:
            self.collect_attributes(taken + [self.iso_value_name] * bool(self.choice.ComputeScalars))

    # -- arrays --

    def check(self, role, name, array):
        if array is None:
            raise Unusable(f"There is no point array '{name}' for the {role}. {list_names(self.data)}")
        if not isinstance(array, vtkDataArray):
            raise Unusable(f"The {role} array '{name_of(array)}' does not hold numbers.")
        if array.GetNumberOfTuples() != self.count or array.GetNumberOfComponents() < 1:
            raise Unusable(f"The {role} array '{name_of(array)}' has {array.GetNumberOfTuples()} values for "
                           f"{self.count} points.")
        return array

    def find(self, role, name):
        array = self.check(role, name, self.data.GetAbstractArray(name))
        if array.GetNumberOfComponents() != 1:
            raise Unusable(f"The {role} array '{name_of(array)}' has {array.GetNumberOfComponents()} components; "
                           "it must have one.")
        return array

    def collect_scalar(self, scalar, dot):
        if not scalar.name and scalar.array is None:
            raise Unusable("No scalar to contour was chosen: choose a point array, or turn the free surface on. "
                           + list_names(self.data))
        if not scalar.on_points or not dot.on_points:
            raise Unusable(f"The scalar '{dot.name if scalar.on_points else scalar.name}' is not a point array; "
                           f"SPH particles are points. {list_names(self.data)}")
        if scalar.name == "Velocity" and scalar.array is None:
            scalar.array = join_velocity(self.data, self.count)
        self.scalar = self.check("scalar", scalar.name, scalar.array)
        components, component = self.scalar.GetNumberOfComponents(), self.choice.ScalarComponent
        if real_name(dot.name):
            self.dot = self.check("second vector of the dot product", dot.name, dot.array)
            if self.dot.GetNumberOfComponents() != components:
                raise Unusable("The dot product needs two arrays with the same number of components; "
                               f"'{name_of(self.scalar)}' has {components}, '{name_of(self.dot)}' has "
                               f"{self.dot.GetNumberOfComponents()}.")
        elif components > 1 and component != -1 and not 0 <= component < components:
            raise Unusable(f"The scalar '{name_of(self.scalar)}' has no component {component}; choose 0 to "
                           f"{components - 1}, or -1 for the magnitude.")

    def collect_quantities(self):
        choice = self.choice
        if not choice.EstimateSmoothingLength and not self.collect_quantity("smoothing_length"):
            raise Unusable(describe_missing_length(
                self.data, "Turn Estimate Smoothing Length on, or choose Smoothing Length Array"))
        is_set = (real_name(choice.MassArrayName) or real_name(choice.DensityArrayName) or choice.Mass or choice.Density)
        if not self.collect_quantity("volume", may_detect=not is_set):
            has = self.collect_quantity("mass"), self.collect_quantity("density")
            by_constant = choice.ParticleVolume > 0 and not all(has)
            # A density alone says nothing of volumes.
            for quantity in ("mass", "density") if by_constant else () if has[0] else ("density",):
                self.values.pop(quantity, None)
                self.used[quantity] = None
            if by_constant:
                self.values["volume"] = choice.ParticleVolume

    def collect_quantity(self, quantity, may_detect=True):
        """A constant goes before a name, a name before the usual names. Whether there is one."""
        word = camel(quantity)
        name, value = real_name(getattr(self.choice, word + "ArrayName")), getattr(self.choice, word, 0.0)
        if not value and name:
            self.used[quantity] = value = self.find(quantity.replace("_", " "), name)
        elif not value and self.choice.DetectArrays and may_detect:
            self.used[quantity] = value = detect(self.data, self.count, quantity)
        if value is None or isinstance(value, float) and not value:
            return False
        self.values[quantity] = value
        return True

    def collect_solids(self):
        name = real_name(self.choice.FluidArrayName)
        if name:
            self.fluid = self.find("fluid", name)
            self.solid = to_numpy(self.fluid) != self.choice.FluidValue
        self.present = self.find_present()

    def find_present(self):
        """Which particles Within and Only leave; None: all. Of several ranges of one array, any may hold."""
        bounds, present = self.choice.Within, np.ones(self.count, bool)
        if not any(bounds) and not self.choice.Only:
            return None
        if any(bounds):
            x = to_numpy(self.positions)
            present = ((x >= bounds[::2]) & (x <= bounds[1::2])).all(axis=1)
        for name in {name for name, *_ in self.choice.Only}:
            values = to_numpy(self.find("choice of particles", name))
            present &= np.any([(values >= low) & (values <= high) for each, low, high in self.choice.Only if each == name],
                              axis=0)
        return present

    def describe_no_fluid(self):
        """Why no particle is fluid; "" where some are."""
        choice, fluid, present = self.choice, None if self.solid is None else ~self.solid, self.present
        if present is not None:
            fluid = present if fluid is None else fluid & present
        if fluid is None or fluid.any():
            return ""
        if present is None or present.any():
            return f"No particle has {choice.FluidArrayName} = {choice.FluidValue:g}"
        words = ["within " + ",".join(f"{side:g}" for side in choice.Within)] if any(choice.Within) else []
        for i, (name, low, high) in enumerate(choice.Only):
            words.append("left by " * (i == 0) + f"{name}={low:g}" + f":{high:g}" * (low != high))
        return "No particle is " + " and ".join(words)

    def name_scalar(self, taken):
        """Computed arrays keep their names, which users look for."""
        if self.scalar is None:
            return
        self.scalar_name, component = name_of(self.scalar), self.choice.ScalarComponent
        several = self.scalar.GetNumberOfComponents() > 1
        if self.dot is None and not (several and component >= 0):
            self.contoured = self.scalar_name
        if self.dot is not None:
            self.scalar_name += "_Dot_" + name_of(self.dot)
        elif several:
            label = self.scalar.GetComponentName(component) if component >= 0 else "Magnitude"
            few = self.scalar.GetNumberOfComponents() <= 3
            self.scalar_name += "_" + (label or ("XYZ"[component] if few else str(component)))
        if self.scalar_name and self.scalar_name not in taken and not self.choice.Filled:
            self.iso_value_name = self.scalar_name

    def collect_attributes(self, taken):
        left = set(taken) | set(self.choice.ExcludedArrays) | {"", GHOSTS, WALL_BLOCK}
        arrays = [self.data.GetAbstractArray(i) for i in range(self.data.GetNumberOfArrays())]
        velocity = join_velocity(self.data, self.count)
        for array in arrays + ([] if velocity is None else [velocity]):
            if name_of(array) not in left and array.GetNumberOfTuples() == self.count:
                real = isinstance(array, vtkDataArray) and is_real(array)
                (self.interpolated if real else self.from_nearest)[name_of(array)] = array

    # -- for the core --

    def arguments(self):
        result = Arguments(to_numpy(self.positions))

        def view(array):
            return result.view(to_numpy(array), name_of(array))

        result.set_solid(self.solid, self.present)
        for quantity, value in self.values.items():
            setattr(result.input, quantity, c.mcor_array(constant=value) if isinstance(value, float) else view(value))
        if self.scalar is not None:
            result.input.scalar = view(self.scalar)
            several = self.scalar.GetNumberOfComponents() > 1
            result.input.scalar_component = self.choice.ScalarComponent if several else 0
        if self.dot is not None:
            result.input.scalar_dot = view(self.dot)
        result.set_attributes({name: to_numpy(array) for name, array in self.interpolated.items()})
        for name in ("smoothing_length_is_support_radius", "estimate_smoothing_length", "ignore_solids"):
            setattr(result.input, name, bool(getattr(self.choice, camel(name))))
        return result

    def estimate_by_neighbours(self, options):
        """Smoothing lengths as an array, in place of the estimate of one, where that is asked for."""
        if self.choice.EstimateSmoothingLength and self.choice.SmoothingLengthEstimate:
            self.values["smoothing_length"] = self.per_neighbours(
                options, "SmoothingLength", lib.mcor_find_smoothing_lengths, self.choice.NeighborRatio)
            self.choice.EstimateSmoothingLength = self.choice.SmoothingLengthIsSupportRadius = 0

    def sum_densities(self, options):
        """As an array; volumes follow from it, too, where there is none."""
        self.estimate_by_neighbours(options)
        array = self.per_neighbours(options, SUMMED, lib.mcor_sum_densities)
        if "mass" in self.values:
            self.values.setdefault("density", array)
        return array

    def per_neighbours(self, options, name, function, *more):
        """An array of this name; that of the last run of the same particles, if there is one."""
        given = self.arguments()
        given.options = options
        key = (*self.signatures()[0], options.sph_kernel, options.dimension, *options.periodic, *more)
        made = self.choice.Made.get(name, (None, None))
        if made[0] != key:
            array = numpy_to_vtk(given.per_neighbours(function, *more), deep=True)
            array.SetName(name)
            made = self.choice.Made[name] = key, array
        return made[1]

    @staticmethod
    def estimate_cells(arguments, options):
        given = ctypes.byref(arguments.input)
        return lib.mcor_estimate_cells(given, ctypes.byref(options), lib.mcor_least_smoothing_length(given))

    def signatures(self):
        """Tells one state of particles and scalar from another. The data set's own time is part
        of it: users change arrays in place and tell the data set."""

        def sign(thing):
            return None if thing is None else (thing.__this__, thing.GetMTime())

        choice = self.choice
        particles = [sign(thing) for thing in (self.points, self.positions, self.fluid, *self.used.values())]
        particles += [choice.FluidValue, choice.SmoothingLength, choice.Mass, choice.Density, choice.Kernel,
                      choice.SmoothingLengthIsSupportRadius, choice.EstimateSmoothingLength, choice.IgnoreSolids,
                      tuple(choice.Within), *choice.Only]
        return particles, [sign(self.scalar), sign(self.dot), choice.ScalarComponent]

    def describe_fluid(self):
        return f"{name_of(self.fluid)} = {self.choice.FluidValue:g}" if self.fluid is not None else ""

    def find_iso_value(self):
        """The range of the scalar at fluid particles, and an iso value for those who gave none; None where no
        value is finite. Scalar and solids alone must have been collected."""
        given, ends, value = self.arguments(), (ctypes.c_double * 2)(), ctypes.c_double()  # it holds the arrays
        found = lib.mcor_find_iso_value(ctypes.byref(given.input), None, ends, ctypes.byref(value))
        return (tuple(ends), value.value) if found else None


class Request:
    """A point array asked for by SetInputArrayToProcess, and the name asked for."""

    def __init__(self, algorithm, index, points):
        self.array, self.name, self.on_points = None, "", True
        requests = algorithm.GetInformation().Get(algorithm.INPUT_ARRAYS_TO_PROCESS())
        if requests is None or index >= requests.GetNumberOfInformationObjects():
            return
        info = requests.GetInformationObject(index)
        name = info.Get(vtkDataObject.FIELD_NAME()) or ""
        self.name = "" if name == "(automatic)" else name
        kind, data = vtkDataObject.FIELD_ATTRIBUTE_TYPE(), points.GetPointData()
        if self.name or not name and info.Has(kind):
            # Arrays of cells may be those of the particles now, see take_vertices().
            self.on_points = bool(self.name and data.HasArray(self.name)) or info.Get(vtkDataObject.FIELD_ASSOCIATION()) in (
                vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataObject.FIELD_ASSOCIATION_POINTS_THEN_CELLS)
            if self.on_points:
                self.array = data.GetAbstractArray(self.name) if self.name else data.GetAbstractAttribute(info.Get(kind))
        is_fit = isinstance(self.array, vtkDataArray) and rank_of(self.array) >= 0
        if index == 0 and not self.name and not is_fit:  # nobody has chosen the active scalars of a file
            best = find_fittest(points)
            self.array = self.array if best is None else best
