# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""vtkMarchingCorrectors for VTK without our C++ class: the same properties, the same results.

This file is a plugin for any ParaView, too: Tools > Manage Plugins > Load New.
"""
import ctypes
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

if __package__ in (None, "") and "marchingcorrectors" not in sys.modules:
    # Loaded by ParaView, which knows no package. What else lies beside it must not be found with it.
    _folder = Path(__file__).resolve().parent
    _spec = spec_from_file_location("marchingcorrectors", _folder / "__init__.py",
                                    submodule_search_locations=[str(_folder)])
    sys.modules["marchingcorrectors"] = module_from_spec(_spec)
    _spec.loader.exec_module(sys.modules["marchingcorrectors"])

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkObject, vtkOutputWindow
from vtkmodules.vtkCommonDataModel import (vtkDataObject, vtkDataObjectTree, vtkDataSetAttributes, vtkFieldData,
                                           vtkPointSet, vtkPolyData)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkCommonMisc import vtkContourValues

from marchingcorrectors import Cancelled, Context, DeviceError, Error
from marchingcorrectors import _structs as c
from marchingcorrectors._library import lib
from marchingcorrectors._library import devices as list_devices
from marchingcorrectors._vtk_ahead import Ahead
from marchingcorrectors._vtk_particles import Particles, Request, Unusable, name_of, period_of
from marchingcorrectors._vtk_summary import Box, Summary, estimate_cells
from marchingcorrectors._vtk_blocks import find_walls, join_blocks, list_all, name_blocks
from marchingcorrectors._vtk_surface import (add_iso_values, add_run, build_mesh, computed_arrays, describe,
                                             left_out)
from marchingcorrectors._warnings import describe_warnings, take_text

BIG = 2147483647
KERNELS = [name[len("MCOR_"):] for name in c.ENUMS["mcor_sph_kernel"] if not name.endswith("_COUNT")]
CONVERT = {"IntVectorProperty": int, "DoubleVectorProperty": float, "StringVectorProperty": lambda text: text or ""}
# Of the panel: two that the class sets by methods of its own, and one that means nothing in one process.
OTHERS = "PanelComponent", "FreeSurfaceValue", "Partition"


def read_panel():
    return ElementTree.parse(Path(__file__).resolve().with_name("MarchingCorrectors.xml")).getroot()


def read_properties():
    """The panel's properties of one value. name: (default, conversion, whether it has NameOn and NameOff, limits)"""
    found = {"ScalarComponent": (-1, int, False, (-BIG, BIG)), "DetectArrays": (1, int, True, ())}  # not in the panel
    for each in read_panel().find(".//SourceProxy[@class='vtkMarchingCorrectors']"):
        name = each.get("command", "")[len("Set"):]
        if each.get("number_of_elements") != "1" or each.get("information_only") or name in OTHERS:
            continue
        # Ranges of real numbers are those of sliders: other values are for the core to refuse.
        limits = [int(entry.get("value")) for entry in each.findall("EnumerationDomain/Entry")]
        for domain in each.findall("IntRangeDomain"):
            limits = int(domain.get("min", -BIG)), int(domain.get("max", BIG))
        convert, text = CONVERT[each.tag], each.get("default_values").replace("(automatic)", "")
        found[name] = convert(text), convert, each.find("BooleanDomain") is not None, limits
    return {**found, "DetectFluid": (0, int, True, ())}  # the panel alone begins with 1


PROPERTIES = read_properties()


def with_properties(kind):
    """SetX, GetX, XOn, XOff."""
    for name, (_, convert, is_flag, limits) in PROPERTIES.items():
        def set_it(self, value, name=name, convert=convert, limits=limits):
            value = convert(value)
            if limits:
                value = min(max(value, min(limits)), max(limits))
            if getattr(self, name) != value:
                setattr(self, name, value)
                self.Modified()

        setattr(kind, "Set" + name, set_it)
        setattr(kind, "Get" + name, lambda self, name=name: getattr(self, name))
        if is_flag:
            setattr(kind, name + "On", lambda self, set_it=set_it: set_it(self, 1))
            setattr(kind, name + "Off", lambda self, set_it=set_it: set_it(self, 0))
    for name in ("FluidScalarRange", "UsedIsoValues", "IsoValueArrayName", "UsedSmoothingLength", "UsedVolume",
                 "UsedCubeSize", "SurfaceMeasures", "EstimatedCells", "Box", "PeriodicBounds", "ErrorMessage",
                 "RunStatistics", "UsedFluid"):
        setattr(kind, "Get" + name, lambda self, name=name: getattr(self, name))
    for name in ("ScalarRange", "IsoValue", "Components", "Dimension", "Cells", "Fluid", "Array"):
        setattr(kind, "GetNext" + name, lambda self, name=name: self._look_ahead()[name])
    for quantity in ("SmoothingLength", "Volume", "Mass", "Density"):
        setattr(kind, f"GetUsed{quantity}ArrayName", lambda self, q=quantity: self.UsedNames.get(q, ""))
    for number, name in enumerate(KERNELS):
        setattr(kind, name, number)
    values = {"Kernel": ["".join(part.capitalize() for part in name.split("_")) for name in KERNELS],
              "SeedMode": ("Complete", "Pairs"), "Topology": ("Table", "Field"), "Blocks": ("Together", "Apart"),
              "CubeSizeMode": ("Uniform", "Adaptive"), "BoundaryDetection": ("WeightSum", "Eigenvalue")}
    for name, words in values.items():
        for value, word in enumerate(words):
            setattr(kind, f"Set{name}To{word}", lambda self, n=name, v=value: getattr(self, "Set" + n)(v))
    return kind


@with_properties
class vtkMarchingCorrectors(Summary, Ahead, Box, VTKPythonAlgorithmBase):
    """An isosurface directly from SPH particles; see vtkMarchingCorrectors.h of the sources."""

    COMPLETE, PAIRS = range(2)
    UNIFORM, ADAPTIVE = range(2)
    TOPOLOGY_TABLE, TOPOLOGY_FIELD = range(2)
    WEIGHT_SUM, EIGENVALUE = range(2)
    SOLIDS_WEIGHT, SOLIDS_IGNORE, SOLIDS_WALL, SOLIDS_AUTO = range(4)
    TOGETHER, APART = range(2)
    MAGNITUDE = -1

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=1, nOutputPorts=1, outputType="vtkDataObject")
        for name, (default, *_) in PROPERTIES.items():
            setattr(self, name, default)
        self.ContourValues, self.FreeSurfaceValues = vtkContourValues(), vtkContourValues()
        self.ContourValues.SetNumberOfContours(0)
        self.FreeSurfaceValues.SetValue(0, 0.5)
        self._joined = None, None, 0
        self.clear_summary()
        self.ExcludedArrays, self.UsedNames, self.UsedFluid = [], {}, ""
        self.ErrorMessage, self.BlockName = "", ""
        self.RunStatistics = vtkFieldData()
        self._context, self._context_device = None, None
        self._signatures, self._versions = (None, None), [0, 0]
        self.forget_ahead()
        self.SetInputArrayToProcess(
            0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes.SCALARS)

    # -- as every poly data algorithm --

    def SetInputData(self, *arguments):
        self.SetInputDataObject(*arguments)

    def GetInput(self, port=0):
        return self.GetInputDataObject(port, 0) if self.GetNumberOfInputConnections(port) else None

    def GetOutput(self, port=0):
        return self.GetOutputDataObject(port)

    def FillInputPortInformation(self, port, info):
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet")
        info.Append(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree")
        return 1

    def RequestDataObject(self, request, inInfo, outInfo):
        """A poly data, or blocks of them as the input has."""
        data = self.GetInputData(inInfo, 0, 0)
        info = outInfo.GetInformationObject(0)
        blocks = isinstance(data, vtkDataObjectTree) and self.Blocks == self.APART
        output = info.Get(vtkDataObject.DATA_OBJECT())
        if output is None or not output.IsA(data.GetClassName() if blocks else "vtkPolyData"):
            info.Set(vtkDataObject.DATA_OBJECT(), data.NewInstance() if blocks else vtkPolyData())
        return 1

    # -- properties that are more than a value --

    def SetValue(self, i, value):
        self._contours(self.ContourValues.SetValue, i, value)

    def GetValue(self, i):
        return self.ContourValues.GetValue(i) if self.GetNumberOfContours() > 0 else 0.0

    def GetValues(self, into=None):
        values = [self.ContourValues.GetValue(i) for i in range(self.GetNumberOfContours())]
        if into is None:
            return tuple(values)
        into[:len(values)] = values
        return None

    def SetNumberOfContours(self, number):
        self._contours(self.ContourValues.SetNumberOfContours, number)

    def GetNumberOfContours(self):
        return self.ContourValues.GetNumberOfContours()

    def GenerateValues(self, number, *ends):
        first, last = ends if len(ends) == 2 else ends[0]
        self._contours(self.ContourValues.GenerateValues, number, first, last)

    def SetFreeSurfaceValue(self, *arguments):
        if len(arguments) == 1:
            self._contours(self.FreeSurfaceValues.SetNumberOfContours, 1)
        self._contours(self.FreeSurfaceValues.SetValue, *((0,) * (len(arguments) == 1) + arguments))

    def GetFreeSurfaceValue(self, i=0):
        return self.FreeSurfaceValues.GetValue(i) if self.GetNumberOfFreeSurfaceValues() > 0 else 0.5

    def SetNumberOfFreeSurfaceValues(self, number):
        self._contours(self.FreeSurfaceValues.SetNumberOfContours, number)

    def GetNumberOfFreeSurfaceValues(self):
        return self.FreeSurfaceValues.GetNumberOfContours()

    def _contours(self, change, *arguments):
        before = self.ContourValues.GetMTime(), self.FreeSurfaceValues.GetMTime()
        change(*arguments)
        if before != (self.ContourValues.GetMTime(), self.FreeSurfaceValues.GetMTime()):
            self.Modified()

    def SetScalarComponentToMagnitude(self):
        self.SetScalarComponent(self.MAGNITUDE)

    def SetPanelComponent(self, component):
        """ScalarComponent for ParaView's panel, where 3 stands for the magnitude."""
        self.SetScalarComponent(-1 if component >= 3 else component)

    def SetKernelByName(self, name):
        kernel = lib.mcor_find_sph_kernel((name or "").encode())
        if kernel >= 0:
            self.SetKernel(kernel)
        return kernel >= 0

    def GetKernelName(self):
        return lib.mcor_sph_kernel_name(self.Kernel).decode()

    def AddExcludedArray(self, name):
        self.ExcludedArrays.append(name)
        self.Modified()

    def ClearExcludedArrays(self):
        self.ExcludedArrays.clear()
        self.Modified()

    def GetNumberOfExcludedArrays(self):
        return len(self.ExcludedArrays)

    def GetExcludedArray(self, i):
        return self.ExcludedArrays[i] if 0 <= i < len(self.ExcludedArrays) else None

    def GetStatistics(self):
        return describe(self.RunStatistics)

    @staticmethod
    def ListDevices():
        return "".join(f"{i}: {device}\n" for i, device in enumerate(list_devices()))

    def ReleaseDeviceMemory(self):
        if self._context:
            self._context.release_memory()

    def __str__(self):
        lines = [str(super().__str__()).rstrip()]
        for name in PROPERTIES:
            words = "".join(" " + letter if letter.isupper() else letter for letter in name).strip()
            lines.append(f"  {words}: {getattr(self, name)}")
        return "\n".join(lines) + "\n"

    # -- a run --

    def RequestData(self, request, inInfo, outInfo):
        data, output = self.GetInputData(inInfo, 0, 0), self.GetOutputData(outInfo, 0)
        self.ErrorMessage, self.BlockName, self._warned = "", "", set()
        self.RunStatistics = vtkFieldData()
        if isinstance(data, vtkDataObjectTree) and self.Blocks == self.APART:
            self._process_blocks(data, output)
            return 1
        particles = self._take_particles(data)
        if particles is not data:
            output.GetFieldData().PassData(particles.GetFieldData())
        self._process(particles, output)
        return 1

    def _take_particles(self, data):
        """The data, or all blocks together, which are kept as long as they are the same."""
        if not isinstance(data, vtkDataObjectTree) or self.Blocks == self.APART:
            return data
        times = [each.GetMTime() for each in list_all(data)]
        if self._joined[:2] != (data, times):
            self._joined = data, times, join_blocks(data)
        return self._joined[2]

    def _process_blocks(self, data, output):
        """A block that fails leaves its place empty, and the others as they are."""
        output.CopyStructure(data)
        names, iterator = name_blocks(data), data.NewTreeIterator()
        iterator.InitTraversal()
        self._warn_once("walls", find_walls(names))
        for i, name in enumerate(names):
            self.SetProgressShiftScale(i / len(names), 1 / len(names))
            self.BlockName = name + ": "
            block, made = iterator.GetCurrentDataObject(), vtkPolyData()
            made.GetFieldData().PassData(block.GetFieldData())
            self._process(block, made)
            output.SetDataSetFrom(iterator, made)
            iterator.GoToNextItem()
        self.SetProgressShiftScale(0.0, 1.0)
        if self._is_aborted():
            output.CopyStructure(data)  # not some blocks of a surface

    def _process(self, data, output):
        if data is not None and not isinstance(data, vtkPointSet):
            self._say(f"A {data.GetClassName()} has no points of its own, and so no surface.", "Warning")
            return
        self.UsedNames, self.UsedFluid = {}, ""
        self.clear_summary()
        if data is None or data.GetNumberOfPoints() == 0 or self._is_aborted():
            return
        choice = self._choice()
        options = self._options(choice)
        particles = Particles(choice, data)
        try:
            if choice.DetectPeriod:
                options.periodic[:] = period_of(data)
            particles.collect((Request(self, 0, data), Request(self, 1, data)), computed_arrays(options))
        except Unusable as sentence:
            self._fail(str(sentence))
            return
        finally:
            self.UsedNames = {"".join(part.capitalize() for part in quantity.split("_")): name_of(array)
                              for quantity, array in particles.used.items()}
            self.UsedFluid = particles.describe_fluid()
        self._warn_once("type", particles.describe_unused_type())
        if particles.solid is not None and particles.solid.all():
            self._say(f"No particle has {choice.FluidArrayName} = {choice.FluidValue:g}, so there is no fluid and "
                      "no surface.", "Warning")
            return
        self._extract(particles, options, output)

    def _choice(self):
        return SimpleNamespace(ExcludedArrays=list(self.ExcludedArrays), Box=self.Box,
                               PeriodicBounds=self.PeriodicBounds,
                               IgnoreSolids=int(self.Solids == self.SOLIDS_IGNORE),
                               **{name: getattr(self, name) for name in PROPERTIES})

    @staticmethod
    def _options(choice):
        options, fields = c.mcor_options(), c.ENUMS["mcor_field"]
        lib.mcor_set_default_options(ctypes.byref(options))
        options.sph_kernel, options.h_scale = choice.Kernel, choice.HScaleFactor
        options.dimension = choice.Dimension
        options.field = fields["MCOR_WEIGHT_SUM" if choice.FreeSurface else
                               "MCOR_SHEPARD" if choice.ShepardNormalization else "MCOR_SUM"]
        options.seeds = 0 if choice.FreeSurface else choice.SeedMode
        options.topology = choice.Topology
        options.boundary_detection = choice.BoundaryDetection if choice.Trim else 0
        options.cube_size_factor, options.cube_size = choice.CubeSizeFactor, choice.CubeSize
        options.level_limit = choice.CubeLevelLimit if choice.CubeSizeMode else 0  # adaptive
        if choice.UseBox:
            options.box[:] = choice.Box if any(choice.Box) else (5e-324, 0, 0, 0, 0, 0)  # refused, see the C++ filter
        options.periodic[:] = choice.PeriodicBounds
        options.capping = (2 if choice.UseBox else 1) if choice.Capping else 0  # MCOR_CAP_BOX, MCOR_CAP_PERIOD
        options.filled = choice.Filled
        options.node_threshold = choice.NodeThreshold
        options.vertex_threshold = choice.VertexThreshold if choice.Trim else 0.0
        ends = (choice.Trim or choice.FreeSurface) and (choice.Solids == 2 or (
            choice.Solids == 3 and not choice.FreeSurface))  # SOLIDS_WALL, SOLIDS_AUTO
        options.wall_share = choice.WallShare if ends else 0.0
        options.preview, options.tolerance = choice.Preview, choice.Tolerance
        options.iteration_limit = choice.IterationLimit
        options.memory_limit = choice.DeviceMemoryLimit << 20
        options.precision = choice.Precision
        options.normals, options.gradients = choice.ComputeNormals, choice.ComputeGradients
        options.weight_sum = choice.ComputeWeightSum
        options.boundary_eigenvalue = choice.ComputeBoundaryEigenvalue
        options.correction_length, options.residual = choice.ComputeCorrectionLength, choice.ComputeResidual
        options.boundary_flag, options.iso_value = choice.ComputeBoundaryFlag, choice.ComputeScalars
        return options

    def _extract(self, particles, options, output):
        choice, surface = particles.choice, c.mcor_surface()
        arguments = particles.arguments()
        arguments.options = options
        values = self.FreeSurfaceValues if choice.FreeSurface else self.ContourValues
        iso = [values.GetValue(i) for i in range(values.GetNumberOfContours())]
        iso = [value for value in iso if value == value]  # an empty row of a panel's list is none
        if not iso:
            found = None if choice.FreeSurface else particles.find_iso_value()
            iso = [0.5 if choice.FreeSurface else found[1] if found else 0.0]
        arguments.set_iso_values(iso)
        options.nearest_particle = bool(particles.from_nearest)
        self.EstimatedCells = estimate_cells(arguments, options)
        huge = take_text(lib.mcor_describe_estimate(self.EstimatedCells))
        if huge:
            self._say(huge, "Warning")
        try:
            self._call_core(particles, arguments, surface)
            self.summarize(arguments, particles.iso_value_name, surface)
            for sentence in left_out(surface, particles):
                self._say(sentence, "Warning")
            for kind, sentence in describe_warnings(arguments, surface).items():
                self._warn_once(kind, sentence)
            add_iso_values(output.GetFieldData(), arguments.options)
            add_run(self.RunStatistics, surface, particles, arguments)
            single = particles.positions.GetDataTypeAsString() == "float"
            precision = choice.OutputPointsPrecision
            build_mesh(surface, particles, output, as_float=precision == vtkAlgorithm.SINGLE_PRECISION
                       or (precision == vtkAlgorithm.DEFAULT_PRECISION and single),
                       iso_count=arguments.options.iso_count)
        except Cancelled:
            pass
        except Error as sentence:
            self._fail(str(sentence))
        finally:
            lib.mcor_free_surface(ctypes.byref(surface))

    def _call_core(self, particles, arguments, surface):
        choice = particles.choice
        try:
            if self._context is None or self._context_device != choice.Device:
                self._signatures = (None, None)
                self._context, self._context_device = Context(choice.Device or None), choice.Device
            if choice.KeepDeviceData:
                self._set_versions(particles, arguments)
            self._context.run(lambda handle: lib.mcor_extract(
                handle, ctypes.byref(arguments.input), ctypes.byref(arguments.options), ctypes.byref(surface)),
                arguments.options, self._report)
        except BaseException as failure:
            self._signatures = (None, None)
            if isinstance(failure, DeviceError):
                self._context = None
            raise
        finally:
            if self._context and not choice.KeepDeviceData:
                self._context.release_memory()

    def _set_versions(self, particles, arguments):
        """The scalar is kept in the order of the particles: new particles make a new scalar."""
        before, now = self._signatures, particles.signatures()
        self._versions[0] += before[0] != now[0]
        self._versions[1] += before != now
        self._signatures = now
        arguments.input.particles_version, arguments.input.scalar_version = self._versions

    def _report(self, fraction, phase):
        self.SetProgressText(phase)
        self.UpdateProgress(fraction)
        return not self._is_aborted()

    def _is_aborted(self):
        return bool(self.CheckAbort() if hasattr(self, "CheckAbort") else self.GetAbortExecute())

    def _warn_once(self, kind, sentence):
        """Of several blocks the first one tells, as the others will have the same."""
        if sentence and kind not in self._warned:
            self._warned.add(kind)
            self._say(sentence, "Warning")

    def _fail(self, sentence):
        """The sentences of all blocks are kept, one a line."""
        self.ErrorMessage += "\n" * bool(self.ErrorMessage) + self.BlockName + sentence
        self._say(sentence, "Error")

    def _say(self, sentence, kind):
        if not vtkObject.GetGlobalWarningDisplay():
            return
        if self.HasObserver(kind + "Event"):
            self.InvokeEvent(kind + "Event", self.BlockName + sentence)
        else:
            show = getattr(vtkOutputWindow.GetInstance(), f"Display{kind}Text")
            show(f"{kind.upper()}: vtkMarchingCorrectors: {self.BlockName}{sentence}\n\n")


def paraview_plugin(kind):
    """The panel is that of the C++ plugin: its XML, with the class put in place."""
    root = read_panel()
    group = root.find("ProxyGroup[@name='filters']")
    for other in list(root):
        if other is not group:
            root.remove(other)
    for proxy in list(group):
        if proxy.get("class") != "vtkMarchingCorrectors":
            group.remove(proxy)
            continue
        proxy.set("class", f"{Path(__file__).stem}.vtkMarchingCorrectors")
        proxy.set("si_class", "vtkSIPythonSourceProxy")
        lacking = {thing.get("name") for thing in proxy if "command" in thing.attrib
                   and not hasattr(kind, thing.get("command"))}
        for parent in proxy.iter():
            for thing in list(parent):
                if thing.get("name") in lacking and (parent is proxy or thing.tag == "Property"):
                    parent.remove(thing)
    kind._pvsm_proxy_xml = ElementTree.tostring(root, encoding="unicode")


paraview_plugin_name = "MarchingCorrectorsPython"
if __name__ == Path(__file__).stem:  # not as a part of the package
    paraview_plugin(vtkMarchingCorrectors)
    from marchingcorrectors._vtk_reader import SPHParticleReader  # noqa: F401
