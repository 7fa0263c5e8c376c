# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The particles of a VTK data set as arguments of the core, as vtkSPHParticles finds them in C++."""
import ctypes

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkDoubleArray, vtkFloatArray
from vtkmodules.vtkCommonDataModel import vtkDataObject

from . import _structs as c
from ._arrays import Arguments
from ._library import lib
from ._vtk_period import NO_PERIOD, find_period
from ._warnings import describe_unused_type

lib.mcor_find_layout.restype, lib.mcor_find_layout.argtypes = ctypes.c_char_p, [ctypes.c_char_p]

GHOSTS = "vtkGhostType"
QUANTITIES = ("smoothing_length", "volume", "mass", "density")
WALL_BLOCK = "WallBlock"  # of blocks that are one set: whether its name tells of walls


class Unusable(Exception):
    """The sentence that says what is missing or wrong."""


def real_name(name):
    """What lists of arrays show in place of an array, as in ParaView's panel, is no name."""
    return "" if name in ("(automatic)", "(none)") else name


def name_of(array):
    return (array.GetName() if array is not None else None) or ""


def is_real(array):
    return array.GetDataTypeAsString() in ("float", "double")


def to_numpy(array):
    """float and double arrays where they lie, all others as a copy in double."""
    if not isinstance(array, (vtkFloatArray, vtkDoubleArray)):
        copy = vtkDoubleArray()
        copy.DeepCopy(array)
        array = copy
    values = vtk_to_numpy(array)
    return values.reshape(array.GetNumberOfTuples(), array.GetNumberOfComponents())


def detect(data, count, quantity):
    """The point array with the most usual name for a quantity. The core has the names."""
    number = c.ENUMS["mcor_quantity"]["MCOR_" + quantity.upper()]
    best = None
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        if array is None or array.GetNumberOfComponents() != 1 or array.GetNumberOfTuples() != count:
            continue
        rank = lib.mcor_name_priority(number, name_of(array).encode())
        if rank >= 0 and (best is None or rank < best[0]):
            best = (rank, array)
    return best[1] if best else None


def join_velocity(data, count):
    """The point arrays vx, vy and vz as one vector, "Velocity", of float only where all are; None where they
    are not there, or such an array is."""
    parts = [data.GetArray(name) for name in ("vx", "vy", "vz")]
    if data.HasArray("Velocity") or not all(
            part is not None and is_real(part) and part.GetNumberOfComponents() == 1
            and part.GetNumberOfTuples() == count for part in parts):
        return None
    joined = (vtkFloatArray if all(part.GetDataTypeAsString() == "float" for part in parts) else vtkDoubleArray)()
    joined.SetName("Velocity")
    joined.SetNumberOfComponents(3)
    joined.SetNumberOfTuples(count)
    for component, part in enumerate(parts):
        joined.CopyComponent(component, part, 0)
    return joined


def describe_missing_length(data):
    """What to do where no smoothing length is found."""
    names = "\n".join(name_of(data.GetAbstractArray(i)) for i in range(data.GetNumberOfArrays()))
    dual = lib.mcor_find_layout(names.encode(errors="replace")) == b"DualSPHysics"
    return "DualSPHysics does not store it: it is coefh x sqrt(3) x dp. " * dual


def rank_of(array):
    """How fit it is to be looked at where nobody has chosen an array; -1: not."""
    varies = any(low < high for low, high in map(array.GetRange, range(array.GetNumberOfComponents())))
    return lib.mcor_view_priority(name_of(array).encode(), array.GetNumberOfComponents(), is_real(array), varies)


def choose_array(data, names=None):
    """The fittest one; None where none is."""
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())] if names is None else \
        [data.GetArray(name) for name in names]
    ranks = [(rank_of(array), i) for i, array in enumerate(arrays) if array is not None]
    best = min(((rank, i) for rank, i in ranks if rank >= 0), default=None)
    return arrays[best[1]] if best else None


def list_types(data):
    """Arrays that tell kinds of particles apart, by their names, the most usual first."""
    number = c.ENUMS["mcor_quantity"]["MCOR_PARTICLE_TYPE"]
    arrays = [data.GetArray(i) for i in range(data.GetNumberOfArrays())]
    ranks = [(lib.mcor_name_priority(number, name_of(array).encode()), i) for i, array in enumerate(arrays)
             if array is not None and array.GetNumberOfComponents() == 1]
    return [arrays[i] for rank, i in sorted(ranks) if rank >= 0]


def find_fluid(data):
    """The array and its value that clearly tell which particles are fluid; None where none does."""
    for array in list_types(data):
        values, fluid = np.unique(to_numpy(array)), ctypes.c_double()
        if 0 < len(values) <= 8 and (values == np.floor(values)).all() and lib.mcor_find_fluid_value(
                name_of(array).encode(), values[0], values[-1], ctypes.byref(fluid)):
            return name_of(array), fluid.value
    return None


def describe_unused_types(data):
    """(A sentence about the first array that does, although all particles count as fluid, its name); or None."""
    for array in list_types(data):
        sentence = describe_unused_type(name_of(array), to_numpy(array)[:, 0])
        if sentence:
            return sentence, name_of(array)
    return None


def period_of(points):
    """Six bounds that the field data tell of; raises Unusable where they tell of none."""
    period = find_period(points)
    if not period:
        raise Unusable(NO_PERIOD + " Set the periodic bounds, and turn their detection off.")
    return period


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
        self.interpolated, self.from_nearest = [], []
        self.solid = None

    def collect(self, requests, taken):
        if not self.choice.FreeSurface:
            self.collect_scalar(*requests)
        self.collect_quantities()
        self.collect_solids()
        self.name_scalar(taken)
        if self.choice.InterpolateAttributes:
            self.collect_attributes(taken + [self.iso_value_name] * bool(self.choice.ComputeScalars))

    # -- arrays --

    def list_point_arrays(self):
        names = [name_of(self.data.GetAbstractArray(i)) for i in range(self.data.GetNumberOfArrays())]
        return f"Point arrays: {', '.join(names)}." if names else "The input has no point arrays."

    def check(self, role, name, array):
        if array is None:
            raise Unusable(f"There is no point array '{name}' for the {role}. {self.list_point_arrays()}")
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
                           + self.list_point_arrays())
        if not scalar.on_points or not dot.on_points:
            raise Unusable(f"The scalar '{dot.name if scalar.on_points else scalar.name}' is not a point array; "
                           f"SPH particles are points. {self.list_point_arrays()}")
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
        if not choice.EstimateSmoothingLength:
            self.collect_quantity("smoothing_length", choice.SmoothingLengthArrayName, choice.SmoothingLength)
            if "smoothing_length" not in self.values:
                raise Unusable("The particles have no smoothing length: no point array has one of its usual names "
                               "(SmoothingLength, hsml, h, ...). Name the array, give a constant, or ask for an "
                               f"estimate. {describe_missing_length(self.data)}{self.list_point_arrays()}")
        mass_or_density_set = (real_name(choice.MassArrayName) or real_name(choice.DensityArrayName)
                               or choice.Mass or choice.Density)
        self.collect_quantity("volume", choice.VolumeArrayName, 0.0, may_detect=not mass_or_density_set)
        if "volume" in self.values:
            return
        self.collect_quantity("mass", choice.MassArrayName, choice.Mass)
        self.collect_quantity("density", choice.DensityArrayName, choice.Density)
        if "mass" not in self.values:  # a density alone says nothing of volumes
            self.values.pop("density", None)
            self.used["density"] = None

    def collect_quantity(self, quantity, set_name, constant, may_detect=True):
        """A constant goes before a name, a name before the usual names."""
        name = real_name(set_name)
        if constant:
            self.values[quantity] = constant
            return
        if name:
            self.used[quantity] = self.find(quantity.replace("_", " "), name)
        elif self.choice.DetectArrays and may_detect:
            self.used[quantity] = detect(self.data, self.count, quantity)
        if self.used[quantity] is not None:
            self.values[quantity] = self.used[quantity]

    def collect_solids(self):
        name = real_name(self.choice.FluidArrayName)
        if name:
            self.fluid = self.find("fluid", name)
            self.solid = to_numpy(self.fluid)[:, 0] != self.choice.FluidValue

    def name_scalar(self, taken):
        """Computed arrays keep their names, which users look for."""
        if self.choice.FreeSurface:
            return
        self.scalar_name = name_of(self.scalar)
        component = self.choice.ScalarComponent
        if self.dot is not None:
            self.scalar_name += "_Dot_" + name_of(self.dot)
        elif self.scalar.GetNumberOfComponents() > 1:
            label = self.scalar.GetComponentName(component) if component >= 0 else "Magnitude"
            label = label or ("XYZ"[component] if self.scalar.GetNumberOfComponents() <= 3 else str(component))
            self.scalar_name += "_" + label
        if self.scalar_name and self.scalar_name not in taken:
            self.iso_value_name = self.scalar_name

    def collect_attributes(self, taken):
        left = set(taken) | set(self.choice.ExcludedArrays) | {"", GHOSTS, WALL_BLOCK}
        arrays = [self.data.GetAbstractArray(i) for i in range(self.data.GetNumberOfArrays())]
        velocity = join_velocity(self.data, self.count)
        for array in arrays + ([] if velocity is None else [velocity]):
            if name_of(array) not in left and array.GetNumberOfTuples() == self.count:
                real = isinstance(array, vtkDataArray) and is_real(array)
                (self.interpolated if real else self.from_nearest).append(array)

    def describe_unused_type(self):
        """A sentence where no fluid was chosen and yet an array tells kinds of particles apart; else ""."""
        found = None if self.fluid is not None else describe_unused_types(self.data)
        return found[0] if found else ""

    # -- for the core --

    def arguments(self):
        result = Arguments(to_numpy(self.positions))
        result.set_solid(self.solid)
        for quantity, value in self.values.items():
            view = c.mcor_array(constant=value) if isinstance(value, float) else self.view(result, value)
            setattr(result.input, quantity, view)
        if self.scalar is not None:
            result.input.scalar = self.view(result, self.scalar)
            several = self.scalar.GetNumberOfComponents() > 1
            result.input.scalar_component = self.choice.ScalarComponent if several else 0
        if self.dot is not None:
            result.input.scalar_dot = self.view(result, self.dot)
        views = [self.view(result, array) for array in self.interpolated]
        array = (c.mcor_array * max(len(views), 1))(*views)
        result.kept.append(array)
        result.input.attributes, result.input.attribute_count = array, len(views)
        result.input.smoothing_length_is_support_radius = bool(self.choice.SmoothingLengthIsSupportRadius)
        result.input.estimate_smoothing_length = bool(self.choice.EstimateSmoothingLength)
        result.input.ignore_solids = bool(self.choice.IgnoreSolids)
        return result

    @staticmethod
    def view(arguments, array):
        return arguments.view(to_numpy(array), name_of(array))

    def signatures(self):
        """What tells one state of particles and scalar from another. The data set's own time is part
        of it: users change arrays in place and tell the data set."""

        def sign(thing):
            return None if thing is None else (thing.__this__, thing.GetMTime())

        choice = self.choice
        particles = [sign(thing) for thing in (self.points, self.positions, self.fluid, *self.used.values())]
        particles += [choice.FluidValue, choice.SmoothingLength, choice.Mass, choice.Density, choice.Kernel,
                      choice.SmoothingLengthIsSupportRadius, choice.EstimateSmoothingLength, choice.IgnoreSolids]
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
        attribute = info.Get(vtkDataObject.FIELD_ATTRIBUTE_TYPE()) if info.Has(
            vtkDataObject.FIELD_ATTRIBUTE_TYPE()) else None
        if not self.name and (name or attribute is None):
            self._take_fittest(index, points)
            return
        association = info.Get(vtkDataObject.FIELD_ASSOCIATION())
        self.on_points = association in (vtkDataObject.FIELD_ASSOCIATION_POINTS,
                                         vtkDataObject.FIELD_ASSOCIATION_POINTS_THEN_CELLS)
        if self.on_points:
            data = points.GetPointData()
            self.array = data.GetAbstractArray(self.name) if self.name else data.GetAbstractAttribute(attribute)
        if not self.name and (self.array is None or not isinstance(self.array, vtkDataArray) or rank_of(self.array) < 0):
            self._take_fittest(index, points)

    def _take_fittest(self, index, points):
        """Nobody has chosen the active scalars of a file: they are taken if they are fit."""
        velocity = join_velocity(points.GetPointData(), points.GetNumberOfPoints()) if index == 0 else None
        best = velocity if velocity is not None else choose_array(points.GetPointData()) if index == 0 else None
        self.array = best if best is not None else self.array
