# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The filter vtkMarchingCorrectors for a VTK without our C++ class. This filter has the same properties, and gives the same results.

This file is a plugin for any ParaView, too: Tools > Manage Plugins > Load New.
"""
import ctypes
import inspect
import re
import sys
from contextlib import contextmanager, suppress
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

# The package's folder. ParaView may load a link to this file. If the link's folder lacks the panel's XML, the link is
# followed. A build's folder also holds links, but has the XML, so they are not followed.
FOLDER = Path(__file__).absolute().parent
if not (FOLDER / "MarchingCorrectors.xml").exists():
    FOLDER = Path(__file__).resolve().parent

if __package__ in (None, "") and "marchingcorrectors" not in sys.modules:
    # ParaView loads this file without its package, so the package is loaded here. Nothing else in the folder becomes
    # importable.
    _spec = spec_from_file_location("marchingcorrectors", FOLDER / "__init__.py", submodule_search_locations=[str(FOLDER)])
    sys.modules["marchingcorrectors"] = module_from_spec(_spec)
    _spec.loader.exec_module(sys.modules["marchingcorrectors"])

import numpy as np
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkObject, vtkOutputWindow, vtkTimeStamp
from vtkmodules.vtkCommonDataModel import (vtkDataObject, vtkDataObjectTree, vtkDataSetAttributes, vtkFieldData,
                                           vtkPointSet, vtkPolyData)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkCommonMisc import vtkContourValues

from marchingcorrectors import Cancelled, Context, DeviceError, Error, InvalidArgument
from marchingcorrectors import _structs as c
from marchingcorrectors._arrays import QUANTITIES, find_iso_value, tells_of_walls
from marchingcorrectors._call import called
from marchingcorrectors._functions import take_surface
from marchingcorrectors._library import Sentence, describe_warnings, devices, lib, say, take_sentence, take_text
from marchingcorrectors._options import BOUNDS, OUTPUTS, camel
from marchingcorrectors._vtk import (Particles, abstract_arrays_of, add_iso_values, add_nearest, add_run, build_mesh, choose_array, copy_of,
                                     describe_lost, describe_mesh, find_period, is_single, join_blocks, leaves_of, list_all, name_of,
                                     request_of, sets_of, take_vertices, varies)

BIG = 2147483647
KERNELS = [name[len("MCOR_"):] for name in c.ENUMS["mcor_sph_kernel"] if not name.endswith("_COUNT")]
CONVERT = {"IntVectorProperty": int, "DoubleVectorProperty": float, "StringVectorProperty": lambda text: text or ""}
# These properties of the panel are left out, because the class has methods of its own for them.
OTHERS = "PanelComponent", "FreeSurfaceValue"


def read_panel():
    return ElementTree.parse(FOLDER / "MarchingCorrectors.xml").getroot()


def read_properties():
    """Returns the panel's properties that have one value, {name: (default, conversion, whether it has NameOn and NameOff, limits)}."""
    found = {"ScalarComponent": (-1, int, False, (-BIG, BIG)), "DetectArrays": (1, int, True, ())}  # These are not in the panel.
    for each in read_panel().find(".//SourceProxy[@class='vtkMarchingCorrectors']"):
        name = each.get("command", "")[len("Set"):]
        if each.get("number_of_elements") != "1" or each.get("information_only") or name in OTHERS:
            continue
        # Ranges of real numbers in the XML are only for the panel's sliders, so they set no limits here. The core refuses
        # illegal values.
        limits = [int(entry.get("value")) for entry in each.findall("EnumerationDomain/Entry")]
        for domain in each.findall("IntRangeDomain"):
            limits = int(domain.get("min", -BIG)), int(domain.get("max", BIG))
        convert, text = CONVERT[each.tag], each.get("default_values").replace("(automatic)", "")
        found[name] = convert(text), convert, each.find("BooleanDomain") is not None, limits
    return {**found, "DetectFluid": (0, int, True, ())}  # Only the panel begins with 1.


PROPERTIES = read_properties()
SIDES = {"Box": (0.0, 1.0) * 3, "PeriodicBounds": (0.0,) * 6, "Within": (0.0,) * 6}
# For each of these properties, the words for its values 0, 1, ... A word is part of a method's name, such as
# SetSeedModeToPairs(), and of a constant's name.
WORDS = {"Kernel": list(map(camel, KERNELS)), "SeedMode": ("Complete", "Pairs"), "Topology": ("Table", "Field"),
         "Blocks": ("Together", "Apart"), "CubeSizeMode": ("Uniform", "Adaptive"), "BoundaryDetection": ("WeightSum", "Eigenvalue")}
# What the panel shows before a run has found anything.
NOTHING = {"FluidScalarRange": (0.0, 0.0), "UsedIsoValues": "", "IsoValueArrayName": "", "UsedSmoothingLength": "",
           "UsedVolume": "", "UsedCubeSize": 0.0, "EstimatedCells": 0.0, "SurfaceMeasures": "", "UsedNames": {}, "UsedFluid": ""}
# The filter keeps four things of its last run: a mark of the particles and a mark of the scalar, which tell whether the data on the
# device can be used again; the options that the factors of smoothing lengths depend on; and these factors. NO_RUN: there was no run.
NO_RUN = None, None, None, None


def snake(name):
    """Returns the name that VTK 9.4 and later give a property in Python: CubeSize becomes cube_size."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def look_at(*arguments, **more):
    """Returns Particles, with what is found of them, and whether nothing is missing."""
    try:
        return Particles(*arguments, **more), True
    except InvalidArgument as error:
        return error.particles, False


def with_properties(kind):
    """Adds methods, properties and constants, such as SetX, GetX, XOn, XOff, X and x for each X of PROPERTIES. Returns the class."""
    def define(name, get, put=None):
        setattr(kind, "Get" + name, get)
        setattr(kind, snake(name), property(get, put))
        if put:
            setattr(kind, "Set" + name, put)
            setattr(kind, name, property(get, put))

    for name, (_, convert, is_flag, limits) in PROPERTIES.items():
        def set_it(self, value, name=name, convert=convert, limits=limits):
            value = convert(value)
            self._put(name, min(max(value, min(limits)), max(limits)) if limits else value)

        define(name, lambda self, name=name: self._values[name], set_it)
        if is_flag:
            setattr(kind, name + "On", lambda self, set_it=set_it: set_it(self, 1))
            setattr(kind, name + "Off", lambda self, set_it=set_it: set_it(self, 0))
    for name in SIDES:
        define(name, lambda self, name=name: self._values[name], lambda self, *sides, name=name: self._set_sides(name, sides))
    for name in ("Only", "ExcludedArrays"):
        setattr(kind, name, property(lambda self, name=name: self._values[name], lambda self, value, name=name: self._put(name, list(value))))
    for name in (*NOTHING, "ErrorMessage", "MessageCount", "RunStatistics"):
        define(name, lambda self, name=name: getattr(self, name))
    for name in ("ScalarRange", "IsoValue", "Components", "Dimension", "FreeSurface", "Cells", "Fluid", "Array", "Warning"):
        setattr(kind, "GetNext" + name, lambda self, name=name: self._look_ahead()[name])
    for quantity in map(camel, QUANTITIES):
        setattr(kind, f"GetUsed{quantity}ArrayName", lambda self, q=quantity: self.UsedNames.get(q, ""))
    for number, name in enumerate(KERNELS):
        setattr(kind, name, number)
    words = [(name, word, value) for name in WORDS for value, word in enumerate(WORDS[name])]
    for name, word, value in [*words, ("ScalarComponent", "Magnitude", -1)]:
        setattr(kind, f"Set{name}To{word}", lambda self, n=name, v=value: getattr(self, "Set" + n)(v))
        if name != "Kernel":
            setattr(kind, ("TOPOLOGY_" if name == "Topology" else "") + snake(word).upper(), value)
    for values, called_here in (("ContourValues", "NumberOfContours"), ("FreeSurfaceValues", "NumberOfFreeSurfaceValues")):
        setattr(kind, "Get" + called_here, lambda self, values=values: getattr(self, values).GetNumberOfContours())
        setattr(kind, "Set" + called_here, lambda self, n, values=values: self._change(values, "SetNumberOfContours", n))
    for method in ("SetValue", "GenerateValues"):
        setattr(kind, method, lambda self, *a, method=method: self._change("ContourValues", method, *a))
    kind.SetInputData, kind.GetOutput = kind.SetInputDataObject, lambda self, port=0: self.GetOutputDataObject(port)
    kind.free_surface_value = property(kind.GetFreeSurfaceValue, kind.SetFreeSurfaceValue)
    return kind


@with_properties
class vtkMarchingCorrectors(VTKPythonAlgorithmBase):
    """An isosurface directly from SPH particles; see vtkMarchingCorrectors.h of the sources."""

    FREE_SURFACE_AUTO = -1
    SOLIDS_WEIGHT, SOLIDS_IGNORE, SOLIDS_WALL, SOLIDS_AUTO = range(4)
    ESTIMATE_SPACING, ESTIMATE_NEIGHBORS = range(2)
    DIMENSION_AUTO, DIMENSION_2, DIMENSION_3 = 0, 2, 3

    def __init__(self, **properties):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=1, nOutputPorts=1, outputType="vtkDataObject")
        self._values = {**SIDES, **{name: default for name, (default, *_) in PROPERTIES.items()}, "ExcludedArrays": [], "Only": []}
        vars(self).update(NOTHING)
        self.ContourValues, self.FreeSurfaceValues = vtkContourValues(), vtkContourValues()
        self.ContourValues.SetNumberOfContours(0)
        self.FreeSurfaceValues.SetValue(0, 0.5)
        self._kept, self._made = {}, {}  # These are data sets made of the input, and arrays of sums over neighbours.
        self.ErrorMessage, self.BlockName, self.MessageCount = "", "", 0
        self.RunStatistics = vtkFieldData()
        self._context, self._context_device = None, None
        self._in_run = self._release = False
        self._versions, self._last = [0, 0], NO_RUN
        self._ahead, self._look_time = None, vtkTimeStamp()
        self.SetInputArrayToProcess(
            0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes.SCALARS)
        for name, value in properties.items():
            if not inspect.isdatadescriptor(getattr(type(self), name, None)):  # as VTK's own properties are
                raise AttributeError(f"vtkMarchingCorrectors has no property '{name}'")
            setattr(self, name, value)

    # -- methods that every poly data algorithm has --

    def GetInput(self, port=0):
        return self.GetInputDataObject(port, 0) if self.GetNumberOfInputConnections(port) else None

    def FillInputPortInformation(self, port, info):
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet")
        info.Append(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree")
        return 1

    def RequestDataObject(self, request, inInfo, outInfo):
        """Makes the output: a vtkPolyData, or, if each block gets its own surface, a data set of the input's class."""
        data = self.GetInputData(inInfo, 0, 0)
        info = outInfo.GetInformationObject(0)
        blocks = isinstance(data, vtkDataObjectTree) and self.Blocks == self.APART
        output = info.Get(vtkDataObject.DATA_OBJECT())
        if output is None or not output.IsA(data.GetClassName() if blocks else "vtkPolyData"):
            info.Set(vtkDataObject.DATA_OBJECT(), data.NewInstance() if blocks else vtkPolyData())
        return 1

    # -- properties that are more than a value --

    def _put(self, name, value):
        if self._values[name] != value:
            self._values[name] = value
            self.Modified()

    def _change(self, name, method, *arguments):
        values = getattr(self, name)
        before = values.GetMTime()
        getattr(values, method)(*arguments)
        if before != values.GetMTime():
            self.Modified()

    def GetValue(self, i):
        return self.ContourValues.GetValue(i) if self.GetNumberOfContours() > 0 else 0.0

    def GetValues(self, into=None):
        values = tuple(self.ContourValues.GetValue(i) for i in range(self.GetNumberOfContours()))
        if into is None:
            return values
        into[:len(values)] = values

    def _levels(self, name):
        """Lists the values of a property such as ContourValues. Leaves out NaN, which stands for an empty row of the panel's list."""
        values = getattr(self, name)
        values = [values.GetValue(i) for i in range(values.GetNumberOfContours())]
        return [value for value in values if value == value]

    def SetFreeSurfaceValue(self, *arguments):
        if len(arguments) == 1:
            self.SetNumberOfFreeSurfaceValues(1)
        self._change("FreeSurfaceValues", "SetValue", *((0,) * (len(arguments) == 1) + arguments))

    def GetFreeSurfaceValue(self, i=0):
        return self.FreeSurfaceValues.GetValue(i) if self.GetNumberOfFreeSurfaceValues() > 0 else 0.5

    def _set_sides(self, name, sides):
        sides = tuple(float(side) for side in (sides[0] if len(sides) == 1 else sides))
        if len(sides) != 6:
            raise TypeError(f"{name} is {BOUNDS}")
        self._put(name, sides)

    def SetPanelBoxPosition(self, *corner):
        b = self.Box
        self.SetBox([side for axis, low in enumerate(corner) for side in (low, low + b[2 * axis + 1] - b[2 * axis])])

    def SetPanelBoxLength(self, *lengths):
        b = self.Box
        self.SetBox([side for axis, length in enumerate(lengths) for side in (b[2 * axis], b[2 * axis] + length)])

    def SetPanelComponent(self, component):
        """Sets ScalarComponent by its number in ParaView's panel, where 3 stands for the magnitude."""
        self.SetScalarComponent(-1 if component >= 3 else component)

    def SetKernelByName(self, name):
        kernel = lib.mcor_find_sph_kernel((name or "").encode())
        if kernel >= 0:
            self.SetKernel(kernel)
        return kernel >= 0

    def GetKernelName(self):
        return lib.mcor_sph_kernel_name(self.Kernel).decode()

    def AddExcludedArray(self, name):
        self._put("ExcludedArrays", [*self._values["ExcludedArrays"], name])

    def ClearExcludedArrays(self):
        self._put("ExcludedArrays", [])

    def AddOnly(self, name, low, high):
        self._put("Only", [*self._values["Only"], (name, low, high)])

    def ClearOnly(self):
        self._put("Only", [])

    def GetNumberOfExcludedArrays(self):
        return len(self._values["ExcludedArrays"])

    def GetExcludedArray(self, i):
        return dict(enumerate(self._values["ExcludedArrays"])).get(i)

    def GetStatistics(self):
        """Returns a line "Name: values" for each array."""
        return "".join(f"{array.GetName()}: {', '.join(array.GetVariantValue(i).ToString() for i in range(array.GetNumberOfValues()))}\n"
                       for array in abstract_arrays_of(self.RunStatistics))

    @staticmethod
    def ListDevices():
        return "".join(f"{i}: {device}\n" for i, device in enumerate(devices()))

    def ReleaseDeviceMemory(self):
        """Releases the memory on the device, or, if a run uses it, asks the run to release it at its end."""
        if self._in_run:
            self._release = True
        elif self._context:
            self._context.release_memory()

    def __str__(self):
        lines = [str(super().__str__()).rstrip()]
        for name in PROPERTIES:
            words = "".join(" " + letter if letter.isupper() else letter for letter in name).strip()
            lines.append(f"  {words}: {getattr(self, name)}")
        return "\n".join(lines) + "\n"

    # -- what an update would find --

    def _look_ahead(self):
        data = self.GetInput()
        if data is not None and max(self.GetMTime(), data.GetMTime()) < self._look_time.GetMTime():
            return self._ahead
        self._ahead = {"ScalarRange": (0.0, 0.0), "IsoValue": float("nan"), "Components": 0, "Cells": 0.0, "Dimension": 0,
                       "FreeSurface": 0, "Fluid": "", "Array": ""}
        for each in sets_of(self._join(self._keep(take_vertices, data))):
            self._look_at(each, self._ahead)
        self._ahead["Warning"] = in_panel(take_sentence(lib.mcor_describe_estimate(self._ahead["Cells"])))
        self._look_time.Modified()
        return self._ahead

    def _settle(self, choice, points):
        """Sets choice.FreeSurface if it is automatic: 1 if no array and no iso value is chosen, and the particles have a free
        surface; else 0."""
        if choice.FreeSurface >= 0:
            return
        choice.FreeSurface = int(not request_of(self, 0, points).name and not self._levels("ContourValues"))
        if choice.FreeSurface:
            with suppress(Error):  # The run reports the error.
                choice.FreeSurface = Particles(choice, points, ["fluid", "sizes"], options=self._options(choice)).has_free_surface()

    def _look_at(self, points, ahead):
        """Adds to `ahead` what these points tell. Each value needs only some of the arrays: the scalar's range is found without
        smoothing lengths, and the number of cells without a scalar."""
        choice = self._choice()
        self._settle(choice, points)
        with suppress(Error):
            ahead["Array"] = ahead["Array"] or name_of(look_at(choice, points, ["fluid", "array"])[0].scalar)
        with suppress(Error):
            particles = self._find(choice, points, ["fluid", "scalar"])
            if not choice.FreeSurface:
                ends, value = find_iso_value(particles.input) or ((), 0.0)
                if ends:
                    before = ahead["ScalarRange"] if ahead["IsoValue"] == ahead["IsoValue"] else ()
                    ahead["ScalarRange"] = min(*ends, *before), max(*ends, *before)
                    ahead["IsoValue"] = ahead["IsoValue"] if before else value
                    ahead["Components"] = 1 if particles.dot is not None else particles.scalar.GetNumberOfComponents()
        with suppress(Error):
            sizes, is_usable = look_at(choice, points, ["fluid", "sizes"], options=self._options(choice))
            ahead["Fluid"] = sizes.describe_fluid()
            if is_usable:
                ahead["FreeSurface"] |= sizes.has_free_surface()
                ahead["Dimension"] = lib.mcor_find_dimension(ctypes.byref(sizes.input), None, choice.Dimension)
                ahead["Cells"] += sizes.estimate_cells()

    def _find(self, choice, points, wants, **more):
        if choice.FreeSurface:
            return Particles(choice, points, [want for want in wants if want != "scalar"], **more)
        return Particles(choice, points, wants, [request_of(self, i, points) for i in range(2)], **more)

    # -- a run --

    def RequestData(self, request, inInfo, outInfo):
        data, output = self.GetInputData(inInfo, 0, 0), self.GetOutputData(outInfo, 0)
        self.ErrorMessage, self.BlockName, self._warned, self.MessageCount = "", "", set(), 0
        self.RunStatistics = vtkFieldData()
        taken = self._keep(take_vertices, data)
        self._warn_once("mesh", describe_mesh(data, taken))
        if isinstance(taken, vtkDataObjectTree) and self.Blocks == self.APART:
            self._process_blocks(taken, output)
            return 1
        particles = self._join(taken)
        self._warn_once("lost arrays", describe_lost(taken, particles))
        if particles is not data:
            output.GetFieldData().PassData(particles.GetFieldData())
        self._process(particles, output)
        return 1

    def _keep(self, make, data):
        """Returns make(data), which is kept while the data stay the same."""
        state = data, [each.GetMTime() for each in list_all(data) if each]
        if self._kept.get(make, (None,))[0] != state:
            self._kept[make] = state, make(data)
        return self._kept[make][1]

    def _join(self, data):
        """Returns all blocks joined into one set if they get one surface together, else the data."""
        is_one = not isinstance(data, vtkDataObjectTree) or self.Blocks == self.APART
        return data if is_one else self._keep(join_blocks, data)

    def _process_blocks(self, given, output):
        """Extracts the surface of each block. If a block fails, its surface is empty, and the next block follows."""
        data = copy_of(given)  # An observer of the progress may remove blocks from the input, or change them.
        output.CopyStructure(data)
        names = ["Block " + (f"'{name}', " if name else "") + f"index {index}" for _, name, index, _ in leaves_of(data)]
        blocks = [copy_of(block) if i else block for i, (block, *_) in enumerate(leaves_of(data))]  # Data kept on the device are the first block's.
        walls = [name for name in names if tells_of_walls(name)]
        if walls and len(walls) < len(names):
            self._warn_once("walls", say("WALLS_IN_BLOCK", walls[0], len(names)))
        for i, ((*_, at), name, block) in enumerate(zip(leaves_of(data), names, blocks)):
            self.SetProgressShiftScale(i / len(names), 1 / len(names))
            self.BlockName = name + ": "
            made = vtkPolyData()
            made.GetFieldData().PassData(block.GetFieldData())
            self._process(block, made)
            output.SetDataSetFrom(at, made)
        self.SetProgressShiftScale(0.0, 1.0)
        if self._is_aborted():
            output.CopyStructure(data)  # A surface with only some of the blocks is not returned.

    def _process(self, data, output):
        if data is not None and not isinstance(data, vtkPointSet):
            self._say(say("NO_POINTS", data.GetClassName(), "surface"), "Warning")
            return
        vars(self).update(NOTHING)
        if data is None or data.GetNumberOfPoints() == 0 or self._is_aborted():
            return
        choice = self._choice()
        self._settle(choice, data)
        options = self._options(choice)
        try:
            period, cell = find_period(data) if choice.DetectPeriod else (None, None)
            if period:
                options.periodic[:] = period
            particles = self._find(
                choice, data, ["fluid", "sizes", "scalar", *["attributes"] * bool(choice.InterpolateAttributes)], options=options,
                taken=[camel(name) for name in OUTPUTS if getattr(options, name) and name != "iso_value"])
            self._note(particles)
            why = particles.text("no_fluid")
            if why:
                self._say(say("NOTHING_WITHOUT_FLUID", why, "no surface"), "Warning")
                return
            self._warn_once("type", particles.unused_type)
            self._warn_once("unused", particles.unused)
            if choice.DetectPeriod and not period:
                raise InvalidArgument(say("CELL_TILTED" if cell else "NO_PERIOD"))
            self._extract(particles, output)
        except Cancelled:
            pass
        except Error as error:
            if hasattr(error, "particles"):
                self._note(error.particles)
            self._fail(error.args[0])

    def _note(self, particles):
        self.UsedNames = {camel(quantity): name_of(array) for quantity, array in particles.used.items()}
        self.UsedFluid = particles.describe_fluid()

    def _choice(self):
        return SimpleNamespace(Made=self._made, IgnoreSolids=int(self.Solids == self.SOLIDS_IGNORE), **self._values)

    @staticmethod
    def _options(choice):
        """Returns the core's options. Some options depend on several properties."""
        options, fields = c.mcor_options(), c.ENUMS["mcor_field"]
        lib.mcor_set_default_options(ctypes.byref(options))
        for member, (_, _, name) in c.OPTIONS.items():
            if name and isinstance(getattr(options, member), ctypes.Array):
                getattr(options, member)[:] = getattr(choice, name) if name != "Box" or choice.UseBox else [0] * 6
            elif name:
                setattr(options, member, getattr(choice, name))
        for name in OUTPUTS:
            setattr(options, name, getattr(choice, "Compute" + camel(name), 0))
        options.mean_curvature = options.gauss_curvature = choice.ComputeCurvature
        options.iso_value = choice.ComputeScalars
        options.field = fields["MCOR_WEIGHT_SUM" if choice.FreeSurface else
                               "MCOR_SHEPARD" if choice.ShepardNormalization else "MCOR_SUM"]
        if choice.FreeSurface:
            options.seeds = 0
        if not choice.Trim:
            options.boundary_detection, options.vertex_threshold = 0, 0.0
        if not choice.CubeSizeMode:  # uniform
            options.level_limit = 0
        if choice.UseBox and not any(choice.Box):
            options.box[0] = -5e-324  # The core refuses this, as for the C++ filter, but would take zeros for no box.
        options.capping = (2 if choice.UseBox else 1) if choice.Capping else 0  # MCOR_CAP_BOX, MCOR_CAP_PERIOD
        ends = (choice.Trim or choice.FreeSurface) and (choice.Solids == 2 or (
            choice.Solids == 3 and not choice.FreeSurface))  # SOLIDS_WALL, SOLIDS_AUTO
        if not ends:
            options.wall_share = 0.0
        options.memory_limit = choice.DeviceMemoryLimit << 20
        lib.mcor_spell_out(ctypes.byref(options))
        return options

    def _extract(self, particles, output):
        choice, options = particles.choice, particles.options
        iso = self._levels("FreeSurfaceValues" if choice.FreeSurface else "ContourValues")
        if not iso:
            found = (None, 0.5) if choice.FreeSurface else find_iso_value(particles.input)
            iso = [found[1]] if found else []
        particles.set_iso_values(iso)
        options.nearest_particle = bool(particles.from_nearest)
        self.UsedVolume = take_text(lib.mcor_describe_volume(ctypes.byref(particles.input)))
        self.EstimatedCells = particles.estimate_cells()
        self._warn_once("cells of " + self.BlockName, take_sentence(lib.mcor_describe_estimate(self.EstimatedCells)))
        with self._called(particles) as surface:
            found, used = take_surface(surface, particles), ctypes.byref(surface.statistics)
            if particles.scalar is not None:
                self.FluidScalarRange = (surface.statistics.scalar_min, surface.statistics.scalar_max)
            self.UsedIsoValues = ", ".join(f"{value:g}" for value in iso)
            self.IsoValueArrayName = particles.iso_value_name if options.iso_value else ""
            self.UsedSmoothingLength = take_text(lib.mcor_describe_smoothing_length(ctypes.byref(particles.input), used))
            self.UsedCubeSize = surface.statistics.cube_size
            self.SurfaceMeasures = take_text(lib.mcor_describe_measures(used))
            for name, particle in found.left_out.items():
                self._say(say("ARRAY_LEFT_OUT", name, particle, "the surface"), "Warning")
            for kind, sentence in describe_warnings(particles, surface).items():
                self._warn_once(kind, sentence)
        add_iso_values(output.GetFieldData(), options)
        add_run(self.RunStatistics, found, particles)
        self._build(found, particles, output)

    @contextmanager
    def _called(self, particles):
        choice = particles.choice
        self._in_run, self._release = True, not choice.KeepDeviceData
        try:
            if self._context is None or self._context_device != choice.Device:
                self._last = NO_RUN
                self._context, self._context_device = Context(choice.Device or None), choice.Device
            signatures = particles.signatures()
            if choice.KeepDeviceData:  # The kept scalar is in the order of the particles, so new particles need a new scalar.
                self._versions[0] += self._last[0] != signatures[0]
                self._versions[1] += self._last[:2] != signatures[:2]
                particles.input.particles_version, particles.input.scalar_version = self._versions
                if (self._last[0], self._last[2]) == (signatures[0], signatures[2]):
                    particles.widening = self._last[3]
            particles.context, particles.progress = self._context, self._report
            with called(lib.mcor_extract, c.mcor_surface, particles) as surface:
                factors = particles.widening
                if factors is not None:  # The next run does not tell the seconds that they took.
                    factors = *factors[:2], c.mcor_statistics.from_buffer_copy(factors[2])
                    factors[2].seconds[:], factors[2].build_seconds = [0.0] * len(factors[2].seconds), 0.0
                self._last = (*signatures, factors) if choice.KeepDeviceData else NO_RUN
                yield surface
        except BaseException as failure:
            self._last = NO_RUN
            if isinstance(failure, DeviceError):
                self._context = None
            raise
        finally:
            self._in_run = False
            if self._release:
                self.ReleaseDeviceMemory()

    def _build(self, found, particles, output):
        precision, data, arrays = particles.choice.OutputPointsPrecision, output.GetPointData(), found.point_arrays()
        if precision == vtkAlgorithm.SINGLE_PRECISION or (
                precision == vtkAlgorithm.DEFAULT_PRECISION and particles.positions.dtype == np.float32):
            self._warn_once("single points", take_sentence(lib.mcor_describe_single_points(
                np.abs(found.points).max(initial=0.0), self.UsedCubeSize)))
            found.points = found.points.astype(np.float32)
        nearest, iso = arrays.pop("NearestParticle", None), arrays.pop("IsoValue", None)
        arrays.update({name: found.attributes[name] for name in ("NearestParticle", "IsoValue") if name in found.attributes})
        if iso is not None:
            single = particles.scalar is not None and is_single(particles.scalar)
            arrays[particles.iso_value_name] = iso.astype(np.float32 if single else np.float64)
        build_mesh(output, found, arrays)
        for name, array in particles.interpolated.items():
            if name in arrays:
                data.GetArray(name).CopyComponentNames(array)
        for name, array in particles.from_nearest.items() if nearest is not None else ():
            add_nearest(data, name, array, nearest)
        names = [name for name, array in particles.interpolated.items() if varies(array, data.GetArray(name))
                 and not (particles.options.iso_count == 1 and not particles.options.filled and name == particles.contoured)]
        best = choose_array([data.GetArray(name) for name in (*names, particles.iso_value_name) if data.HasArray(name)])
        if best is not None:
            data.SetActiveScalars(name_of(best))

    def _report(self, fraction, phase):
        self.SetProgressText(phase)
        self.UpdateProgress(fraction)
        return not self._is_aborted()

    def _is_aborted(self):
        return bool(self.CheckAbort() if hasattr(self, "CheckAbort") else self.GetAbortExecute())

    def _warn_once(self, kind, sentence):
        """Warns once in a run for each kind, because other blocks would give the same warning."""
        if sentence and kind not in self._warned:
            self._warned.add(kind)
            self._say(sentence, "Warning")

    def _fail(self, sentence):
        """Adds the sentence to ErrorMessage, on a line of its own if other blocks have failed before, and reports the sentence."""
        self.ErrorMessage += "\n" * bool(self.ErrorMessage) + self.BlockName + in_panel(sentence)
        self._say(sentence, "Error")

    def _say(self, sentence, kind):
        self.MessageCount += 1
        if not vtkObject.GetGlobalWarningDisplay():
            return
        sentence = in_panel(sentence)
        if self.HasObserver(kind + "Event"):
            self.InvokeEvent(kind + "Event", self.BlockName + sentence)
        else:
            show = getattr(vtkOutputWindow.GetInstance(), f"Display{kind}Text")
            show(f"{kind.upper()}: vtkMarchingCorrectors: {self.BlockName}{sentence}\n\n")


def in_panel(sentence):
    """Returns a sentence with the panel's words for properties."""
    return sentence.say(lib.mcor_label_word) if isinstance(sentence, Sentence) else sentence


def paraview_plugin(kind):
    """Sets the XML that gives ParaView the filter and its panel: the XML of the C++ plugin, with the class `kind` in it."""
    root = read_panel()
    group = root.find("ProxyGroup[@name='filters']")
    root[:], group[:] = [group], group.findall("SourceProxy[@class='vtkMarchingCorrectors']")
    for proxy in group:
        proxy.set("class", f"{Path(__file__).stem}.vtkMarchingCorrectors")
        proxy.set("si_class", "vtkSIPythonSourceProxy")
        lacking = {thing.get("name") for thing in proxy if "command" in thing.attrib and not hasattr(kind, thing.get("command"))}
        for parent in proxy.iter():
            parent[:] = [thing for thing in parent if thing.get("name") not in lacking or parent is not proxy and thing.tag != "Property"]
    kind._pvsm_proxy_xml = ElementTree.tostring(root, encoding="unicode")


paraview_plugin_name = "MarchingCorrectorsPython"
if __name__ == Path(__file__).stem:  # The file was loaded alone, not as a part of the package.
    paraview_plugin(vtkMarchingCorrectors)
    from marchingcorrectors._vtk_reader import SPHParticleReader  # noqa: F401
