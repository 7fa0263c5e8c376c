# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The particles of a VTK data set as arguments of the core, which finds their arrays."""
import ctypes
from typing import NamedTuple

from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkCommonDataModel import vtkDataObject

from . import _structs as c
from ._arrays import QUANTITIES, Arguments, place_period
from ._find import ROLES, Found, as_bytes, list_named
from ._library import lib
from ._options import camel

GHOSTS = "vtkGhostType"
WALL_BLOCK = "WallBlock"  # In blocks that are one set, this array says whether the block's name tells walls.


class Unusable(Exception):
    """Says what is missing or wrong. particles: what was found nevertheless."""

    def __init__(self, sentence, particles=None):
        super().__init__(sentence)
        self.particles = particles


class NoNumbers:
    """The shape of an array that has no numbers, such as an array of text."""

    def __init__(self, array):
        self.shape = array.GetNumberOfTuples(), array.GetNumberOfComponents()


def name_of(array):
    return (array.GetName() if array is not None else None) or ""


def abstract_arrays_of(data):
    return [data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays())]


def is_single(array):
    return array.GetDataTypeAsString() == "float"


def to_numpy(array):
    """Returns the array's values without a copy, or a copy if they do not lie in one piece."""
    if not array.HasStandardMemoryLayout() or array.GetDataTypeAsString() == "bit":
        copy = vtkDataArray.CreateDataArray(3 if array.GetDataTypeAsString() == "bit" else array.GetDataType())
        copy.DeepCopy(array)
        array = copy
    return vtk_to_numpy(array)


def named(data):
    """Returns (name, values) of all arrays, for the core."""
    return [(array.GetName(), to_numpy(array) if isinstance(array, vtkDataArray) else NoNumbers(array))
            for array in abstract_arrays_of(data)]


def choose_array(arrays):
    """Returns the most suitable array to show if the user has chosen none, or None."""
    best = lib.mcor_choose_view(*list_named([(array.GetName(), to_numpy(array)) for array in arrays]), -1, None)
    return None if best < 0 else arrays[best]


def varies(array, on_surface):
    """Whether the array varies on the surface by more than noise. Vectors count by their magnitudes."""
    if on_surface is None or on_surface.GetNumberOfTuples() == 0:
        return False
    kind = -1 if array.GetNumberOfComponents() > 1 else 0
    (low, high), (least, most) = on_surface.GetRange(kind), array.GetRange(kind)
    return high - low > 0.03 * (most - least)


def find_period(points):
    """Returns the six bounds in the field data, or None; and the nine numbers of a tilted cell, or None."""
    found, period, cell = [], (ctypes.c_double * 6)(), None
    for array in abstract_arrays_of(points.GetFieldData()):
        name = as_bytes(name_of(array))
        if isinstance(array, vtkDataArray) and lib.mcor_tells_of_period(name):
            numbers = to_numpy(array).ravel()
            cell = numbers.tolist() if len(numbers) == 9 else cell
            values = (ctypes.c_double * max(len(numbers), 1))(*numbers[:9])
            found.append(c.mcor_field_data(name=name, values=values, count=len(numbers)))
    count = lib.mcor_find_period((c.mcor_field_data * max(len(found), 1))(*found), len(found), period, None)
    bounds = place_period(period[:3], points.GetBounds()) if count == 3 else list(period) if count else None
    return bounds, None if bounds else cell


class Request(NamedTuple):
    """The point array to contour: its name, or the index of the active array. on_points: whether points have it."""
    name: str = ""
    on_points: bool = True
    active: int = -1


def request_of(algorithm, index, points):
    """Returns the request that the user has made by SetInputArrayToProcess()."""
    info, kind, data = algorithm.GetInputArrayInformation(index), vtkDataObject.FIELD_ATTRIBUTE_TYPE(), points.GetPointData()
    name = info.Get(vtkDataObject.FIELD_NAME()) or ""
    is_chosen, is_active = name not in ("", "(automatic)"), not name and info.Has(kind)
    if not is_chosen and not is_active:
        return Request()
    # Arrays of cells may have become the particles' arrays, see take_vertices().
    on_points = bool(is_chosen and data.HasArray(name)) or info.Get(vtkDataObject.FIELD_ASSOCIATION()) in (
        vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataObject.FIELD_ASSOCIATION_POINTS_THEN_CELLS)
    array = data.GetAbstractAttribute(info.Get(kind)) if on_points and is_active else None
    active = next((i for i, each in enumerate(abstract_arrays_of(data)) if each is array), -1)
    return Request(name if is_chosen else "", on_points, active)


class Particles(Found):
    """The quantities that the core finds among the point arrays. Raises Unusable if something is missing.

    choice: a copy of the filter's properties; wants: names of mcor_want; requests: of the scalar and of the second vector;
    options: the core's options for sums over neighbours.
    """

    def __init__(self, choice, points, wants, requests=(Request(), Request()), taken=(), options=None):
        (scalar, dot), data, component = requests, points.GetPointData(), choice.ScalarComponent
        self.choice, self.points, self.positions, self._arrays = choice, points, points.GetPoints().GetData(), abstract_arrays_of(data)
        names = {name: getattr(choice, camel(name) + "ArrayName") for name in (*QUANTITIES, "fluid")}
        chosen = data.GetAbstractArray(scalar.name) if scalar.name else None if scalar.active < 0 else self._arrays[scalar.active]
        label = chosen.GetComponentName(component) if chosen is not None and component >= 0 else None
        super().__init__(
            to_numpy(self.positions), named(data), wants, {**names, "scalar": scalar.name, "scalar_dot": dot.name},
            {name: getattr(choice, camel(name)) for name in ("smoothing_length", "mass", "density")},
            only=choice.Only, taken=taken, excluded=choice.ExcludedArrays, find=choice.DetectArrays, active=scalar.active,
            lengths_by_neighbours=choice.SmoothingLengthEstimate, find_fluid=choice.DetectFluid, has_iso_values=choice.ComputeScalars,
            **{name: getattr(choice, camel(name)) for name in (
                "compute_volumes", "particle_volume", "estimate_smoothing_length", "smoothing_length_is_support_radius", "fluid_value",
                "ignore_solids", "free_surface", "scalar_component", "within", "filled")},
            label=None if label is None else as_bytes(label),
            not_on_points=(not scalar.on_points) << ROLES["scalar"] | (not dot.on_points) << ROLES["scalar_dot"])
        self.input, self._summed, self.interpolated = self.found.input, {}, {}
        self._made = [self._wrap(*self.made(i)) if self.found.made[i].name else None for i in range(2)]
        if self.error:
            raise Unusable(self.error, self)
        if self.found.needs_lengths:
            self._sum(options, "SmoothingLength", lib.mcor_find_smoothing_lengths, lib.mcor_take_lengths, choice.NeighborRatio)
        if self.found.needs_densities:
            self._sum(options, "Density", lib.mcor_sum_densities, lib.mcor_take_densities)
        self.scalar = self._summed.get("Density") or self.array_for("scalar")
        self.dot = self.array_for("scalar_dot")
        self.interpolated = {name_of(array): array for array in map(self._array, self.attributes())}
        self.from_nearest = {name_of(array): array for array in map(self._array, self.nearest())}
        self.scalar_name, self.iso_value_name = self.text("scalar_name"), self.text("iso_value_name")
        whole = self.scalar is not None and self.dot is None and (self.scalar.GetNumberOfComponents() == 1 or component < 0)
        # This is the name of the array that equals the iso value on the surface, if there is one.
        self.contoured = name_of(self.scalar) if whole else None

    @staticmethod
    def _wrap(name, values):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        return array

    def _array(self, index):
        return self._arrays[index] if index < len(self._arrays) else self._made[index - len(self._arrays)]

    def array_for(self, role):
        index = self.which(role)
        return None if index is None else self._array(index)

    @property
    def fluid(self):
        return self.array_for("fluid")

    @property
    def used(self):
        """Returns {quantity: array}."""
        found = {name: self.array_for(name) for name in QUANTITIES}
        if "SmoothingLength" in self._summed:
            found["smoothing_length"] = self._summed["SmoothingLength"]
        if "Density" in self._summed and self.input.density.data == self.input.scalar.data:
            found["density"] = self._summed["Density"]
        return found

    def describe_fluid(self):
        return "" if self.fluid is None else f"{name_of(self.fluid)} = {self.found.fluid_value:g}"

    def _sum(self, options, name, function, take, *more):
        """Returns the array of this name with sums over neighbours. Takes the last run's array if that run had the same
        particles."""
        given = self.arguments()
        given.options = options
        key = (*self.signatures()[0], options.sph_kernel, options.dimension, *options.periodic, *more)
        made = self.choice.Made.get(name, (None, None))
        if made[0] != key:
            made = self.choice.Made[name] = key, self._wrap(name, given.per_neighbours(self, function, *more))
        self._summed[name] = made[1]
        take(ctypes.byref(self.found), to_numpy(made[1]).ctypes.data_as(ctypes.POINTER(ctypes.c_double)))

    def arguments(self):
        result = Arguments(to_numpy(self.positions))
        result.kept.append(self)
        result.input = self.input
        result.kinds = {name: ((array.GetNumberOfComponents(),) if array.GetNumberOfComponents() > 1 else (),
                               c.ENUMS["mcor_type"]["MCOR_FLOAT32" if is_single(array) else "MCOR_FLOAT64"])
                        for name, array in self.interpolated.items()}
        return result

    def has_free_surface(self):
        """Whether the free surface is what a user sees first. A density is a sign of a liquid, even if volumes are not made of
        it."""
        given = c.mcor_input.from_buffer_copy(self.arguments().input)
        given.density = self.found.views[ROLES["density"]]
        return lib.mcor_has_free_surface(ctypes.byref(given), None)

    @staticmethod
    def estimate_cells(arguments, options):
        given = ctypes.byref(arguments.input)
        return lib.mcor_estimate_cells(given, ctypes.byref(options), lib.mcor_least_smoothing_length(given))

    def signatures(self):
        """Returns marks that differ if the particles, or the scalar, differ. The data set's own time counts, too: users change
        arrays in place, and call only its Modified()."""

        def sign(thing):
            return None if thing is None else (thing.__this__, thing.GetMTime())

        choice, given = self.choice, self.input
        particles = [sign(thing) for thing in (self.points, self.positions, self.fluid, *self.used.values())]
        particles += [self.found.fluid_value, choice.Kernel, *(getattr(given, name).constant for name in QUANTITIES),
                      given.smoothing_length_is_support_radius, given.estimate_smoothing_length, given.ignore_solids,
                      tuple(choice.Within), *choice.Only]
        scalars = getattr(self, "scalar", None), getattr(self, "dot", None)
        return particles, [*map(sign, scalars), given.scalar_component]
